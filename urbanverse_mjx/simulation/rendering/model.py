"""The render model: the meshes of a bank with MuJoCo's normals, and an MjModel of the surfaces that move.

All geoms belong to the world body, so the model has no joint and no dynamics: the renderer writes the geoms' poses.
Hulls are not in it, because the renderer builds a search tree for every mesh it is given.

MuJoCo compiles the bank's meshes, a few at a time: its compiler needs some 800 bytes a triangle, ten gigabytes for 200
streets at once.
"""

import dataclasses
import itertools
from collections.abc import Iterator, Sequence

import mujoco
import numpy as np

from ...datatypes import RobotSpec, SceneBank, ValidationError
from ...geometry import rotations
from .meshes import RenderMeshes
from .settings import AGENT_LABEL, ROBOT_LABEL
from .shapes import primitive_mesh

#: MJCF geom group of a robot's visual geoms (its collision spheres are in group 3, as in MuJoCo Menagerie).
VISUAL_GROUP = 2
#: m; beyond it the sky is drawn. The longest designed street has 200 m, its skyline twice that.
FAR_PLANE = 1000.0
NEAR_PLANE = 0.01
SLOT_GROUP = 0
#: MuJoCo's default colour: a geom of this colour shows its material's colour instead.
_INHERIT = (0.5, 0.5, 0.5, 1.0)
#: m^2, product of a part's two shorter half sizes; thinner parts do not make the shade of a robot wider or taller.
_MIN_CROSS_SECTION = 0.002
#: Triangles of the meshes that are compiled together, at least.
_MIN_TRIANGLES_TOGETHER = 1 << 17


@dataclasses.dataclass(frozen=True)
class RobotCamera:
    """A camera fixed to a robot's body.

    Attributes:
      body: number of the body in the robot's model.
      position (3,) m, quaternion (4,) wxyz: T_body_camera; the camera looks along its -z, +y is up in the image.
      fovy: vertical field of view, rad.
    """

    body: int
    position: np.ndarray
    quaternion: np.ndarray
    fovy: float


@dataclasses.dataclass(frozen=True)
class RenderModel:
    """The render model.

    Attributes:
      model: compiled; its R geoms are those that move: the robot's visual geoms, then one geom for each agent; all are
        meshes. Where the model is whole, they stand behind `num_slots` geoms, one for each slot of the bank.
      meshes: the bank's, then those of `model`; of a whole model, which holds them all in that order, these alone.
      num_slots: see above, else 0. robot_body (R,) i32, robot_position (R, 3)
        f32, robot_rotation (R, 3, 3) f32: T_body_geom. robot_half (R, 2, 3) f32: centre and half size of the box around
        each robot geom in the geom's frame. labels (R, 2) i32: "object" and "category" of the moving geoms.
      num_bodies: bodies of the robot's model, the world included (1 without a robot), and behind them the agents.
      num_agents: how many of the bodies are agents.
      shade_body (S,) i32, shade_box (S, 2, 3) m: the robot and the agents as boxes that shade what is around them:
        centre and half size in the frame of a body.
      cameras: the robot's cameras by name.
    """

    model: mujoco.MjModel
    meshes: RenderMeshes
    num_slots: int
    robot_body: np.ndarray
    robot_position: np.ndarray
    robot_rotation: np.ndarray
    robot_half: np.ndarray
    labels: np.ndarray
    num_bodies: int
    num_agents: int
    shade_body: np.ndarray
    shade_box: np.ndarray
    cameras: dict[str, RobotCamera]


def _add_material(spec: mujoco.MjSpec, bank: SceneBank, number: int) -> str:
    """Adds a material of the bank with its texture, where it is not there yet; returns its name."""
    name, texture = f"bank/{number}", int(bank.material_texture[number])
    if spec.material(name) is not None:
        return name
    material = spec.add_material(
        name=name,
        rgba=bank.material_rgba[number],
        roughness=float(bank.material_roughness[number]),
        metallic=float(bank.material_metallic[number]),
    )
    if texture >= 0:
        label = f"bank/{texture}"
        if spec.texture(label) is None:
            _add_texture(spec, bank, texture, label)
        material.textures[int(mujoco.mjtTextureRole.mjTEXROLE_RGB)] = label
    return name


def _add_texture(spec: mujoco.MjSpec, bank: SceneBank, number: int, name: str) -> None:
    height, width, channels = (int(n) for n in bank.texture_shape[number])
    texture = spec.add_texture(
        name=name,
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        width=width,
        height=height,
        nchannel=channels,
        colorspace=mujoco.mjtColorSpace.mjCOLORSPACE_SRGB,
    )
    texture.data = bank.texture(number).tobytes()


def _add_mesh(spec: mujoco.MjSpec, bank: SceneBank, number: int) -> str:
    """Adds a mesh of the bank, where it is not there yet; returns its name."""
    name = f"bank/{number}"
    if spec.mesh(name) is not None:
        return name
    corners = slice(bank.mesh_vertex_start[number], bank.mesh_vertex_start[number + 1])
    faces = bank.mesh_faces[bank.mesh_face_start[number] : bank.mesh_face_start[number + 1]]
    # The bank's UV start at the lower left corner of a texture, MuJoCo's at the upper left.
    uv = bank.mesh_uv[corners] * [1.0, -1.0] + [0.0, 1.0]
    # Inertia of the surface: flat ground has no volume.
    spec.add_mesh(
        name=name,
        uservert=bank.mesh_vertices[corners].ravel(),
        userface=faces.ravel(),
        usertexcoord=uv.ravel(),
        inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
    )
    return name


def _add_bank(spec: mujoco.MjSpec, bank: SceneBank) -> None:
    """Adds the bank's textures, materials, meshes and one geom per slot; numbers stay those of the bank."""
    for i in range(len(bank.texture_shape)):
        _add_texture(spec, bank, i, f"bank/{i}")
    for i in range(len(bank.material_rgba)):
        _add_material(spec, bank, i)
    for i in range(bank.num_meshes):
        _add_mesh(spec, bank, i)
    for _ in range(bank.slot_mesh.shape[1]):
        spec.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_MESH,
            meshname="bank/0",
            material="absent",
            contype=0,
            conaffinity=0,
            group=SLOT_GROUP,
            rgba=_INHERIT,
        )


def _bank_meshes(bank: SceneBank) -> Iterator[RenderMeshes]:
    """The bank's meshes as MuJoCo compiles them, some at a time."""
    first = 0
    while first < bank.num_meshes:
        spec, triangles, last = mujoco.MjSpec(), 0, first
        while last < bank.num_meshes and triangles < _MIN_TRIANGLES_TOGETHER:
            _add_mesh(spec, bank, last)
            triangles += int(bank.mesh_face_start[last + 1] - bank.mesh_face_start[last])
            last += 1
        yield RenderMeshes.of(spec.compile())
        first = last


def images(model: mujoco.MjModel) -> Iterator[np.ndarray]:
    """(H, W, channels) u8: every texture of a model."""
    for height, width, channels, start in zip(
        model.tex_height.tolist(),
        model.tex_width.tolist(),
        model.tex_nchannel.tolist(),
        model.tex_adr.tolist(),
        strict=True,
    ):
        yield model.tex_data[start : start + height * width * channels].reshape(height, width, channels)


def _geom_box(model: mujoco.MjModel, geom: int) -> tuple[np.ndarray, np.ndarray]:
    """Centre and half size of the box around a geom, in the geom's frame."""
    return model.geom_aabb[geom, :3].astype(np.float64), model.geom_aabb[geom, 3:].astype(np.float64)


def _add_robot(spec: mujoco.MjSpec, robot: mujoco.MjModel) -> list[int]:
    """Adds the robot's visual geoms (group 2) and what they need; returns their numbers in the robot's model."""
    geoms = [int(g) for g in np.flatnonzero(robot.geom_group == VISUAL_GROUP)]
    for g in geoms:
        appearances: dict = {"rgba": robot.geom_rgba[g]}
        material = int(robot.geom_matid[g])
        if material >= 0:
            name = f"robot/{material}"
            if spec.material(name) is None:
                _add_robot_material(spec, robot, material, name)
            appearances["material"] = name
        kind = int(robot.geom_type[g])
        if kind == int(mujoco.mjtGeom.mjGEOM_MESH):
            name = f"robot/{int(robot.geom_dataid[g])}"
            if spec.mesh(name) is None:
                _add_robot_mesh(spec, robot, int(robot.geom_dataid[g]), name)
        else:
            name = f"shape/{g}"
            vertices, normals, faces = primitive_mesh(kind, robot.geom_size[g])
            spec.add_mesh(
                name=name,
                uservert=vertices.ravel(),
                usernormal=normals.ravel(),
                userface=faces.ravel(),
                inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
            )
        kind = mujoco.mjtGeom.mjGEOM_MESH
        spec.worldbody.add_geom(type=kind, meshname=name, contype=0, conaffinity=0, group=SLOT_GROUP, **appearances)
    return geoms


def _add_robot_material(spec: mujoco.MjSpec, robot: mujoco.MjModel, material: int, name: str) -> None:
    added = spec.add_material(
        name=name,
        rgba=robot.mat_rgba[material],
        roughness=float(robot.mat_roughness[material]),
        metallic=float(robot.mat_metallic[material]),
        shininess=float(robot.mat_shininess[material]),
        specular=float(robot.mat_specular[material]),
        emission=float(robot.mat_emission[material]),
    )
    role = int(mujoco.mjtTextureRole.mjTEXROLE_RGB)
    texture = int(robot.mat_texid[material, role])
    if texture < 0 or robot.tex_type[texture] != mujoco.mjtTexture.mjTEXTURE_2D:
        return
    label = f"robot/{texture}"
    if spec.texture(label) is None:
        shape = (int(robot.tex_height[texture]), int(robot.tex_width[texture]), int(robot.tex_nchannel[texture]))
        start = int(robot.tex_adr[texture])
        image = spec.add_texture(
            name=label,
            type=mujoco.mjtTexture.mjTEXTURE_2D,
            height=shape[0],
            width=shape[1],
            nchannel=shape[2],
            colorspace=mujoco.mjtColorSpace.mjCOLORSPACE_SRGB,
        )
        image.data = robot.tex_data[start : start + int(np.prod(shape))].tobytes()
    added.textures[role] = label


def _add_robot_mesh(spec: mujoco.MjSpec, robot: mujoco.MjModel, mesh: int, name: str) -> None:
    """Adds a mesh in the frame the robot's geoms use, corners split so that UVs go with vertices."""
    corners = slice(robot.mesh_vertadr[mesh], robot.mesh_vertadr[mesh] + robot.mesh_vertnum[mesh])
    faces = slice(robot.mesh_faceadr[mesh], robot.mesh_faceadr[mesh] + robot.mesh_facenum[mesh])
    extra: dict = {}
    if robot.mesh_texcoordadr[mesh] >= 0:
        start = int(robot.mesh_texcoordadr[mesh])
        stop = start + int(robot.mesh_texcoordnum[mesh])
        extra = {
            "usertexcoord": robot.mesh_texcoord[start:stop].ravel(),
            "userfacetexcoord": robot.mesh_facetexcoord[faces].ravel(),
        }
    spec.add_mesh(
        name=name,
        uservert=robot.mesh_vert[corners].ravel(),
        userface=robot.mesh_face[faces].ravel(),
        inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
        **extra,
    )


def _cameras(robot: mujoco.MjModel) -> dict[str, RobotCamera]:
    return {
        robot.camera(i).name: RobotCamera(
            body=int(robot.cam_bodyid[i]),
            position=robot.cam_pos[i].astype(np.float32),
            quaternion=robot.cam_quat[i].astype(np.float32),
            fovy=float(np.radians(robot.cam_fovy[i])),
        )
        for i in range(robot.ncam)
    }


def _robot_box(model: mujoco.MjModel, geoms: list[int]) -> tuple[int, np.ndarray]:
    """The robot's first body, and centre and half size (2, 3) of the box around all visual geoms in its frame, as the
    robot stands in its description."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    corners = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
    ends, thin = [], []
    for g in geoms:
        centre, half = _geom_box(model, g)
        points = (centre + corners * half) @ data.geom_xmat[g].reshape(3, 3).T + data.geom_xpos[g]
        local = (points - data.xpos[1]) @ data.xmat[1].reshape(3, 3)
        ends.append((local.min(0), local.max(0)))
        thin.append(np.prod(np.sort(half)[:2]) < _MIN_CROSS_SECTION)
    low, high = np.moveaxis(np.array(ends), 1, 0)
    # The mast of a flag makes no robot taller.
    thick = ~np.array(thin) if not all(thin) else np.ones(len(geoms), bool)
    bottom, low, high = low[:, 2].min(), low[thick].min(0), high[thick].max(0)
    low[2] = min(bottom, low[2])
    return 1, np.stack([(low + high) / 2, (high - low) / 2])


def _add_agents(spec: mujoco.MjSpec, bank: SceneBank, appearances: Sequence[int]) -> np.ndarray:
    """Adds a geom for each agent, with the mesh of row `appearances[i]` of the bank's agents; (A, 2, 3) their boxes."""
    boxes, known = [], len(bank.agents["mesh"])
    for appearance in appearances:
        if not 0 <= appearance < known:
            raise ValidationError(
                f"renderer agents: found appearance {appearance}; needed one of the bank's {known}; build it again"
            )
        mesh = bank.agents["mesh"][appearance]
        spec.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_MESH,
            meshname=_add_mesh(spec, bank, mesh),
            material=_add_material(spec, bank, int(bank.mesh_material[mesh])),
            contype=0,
            conaffinity=0,
            group=SLOT_GROUP,
            rgba=_INHERIT,
        )
        corners = bank.mesh_vertices[bank.mesh_vertex_start[mesh] : bank.mesh_vertex_start[mesh + 1]]
        low, high = corners.min(0), corners.max(0)
        boxes.append([(low + high) / 2, (high - low) / 2])
    return np.array(boxes, np.float64).reshape(-1, 2, 3)


def build_render_model(
    bank: SceneBank,
    robot: RobotSpec | None,
    appearances: Sequence[int] = (),
    whole: bool = False,
    streets: bool = True,
) -> RenderModel:
    """Builds the render model of a bank and, if given, a robot and agents.

    Args:
      appearances: row of the bank's agents for each agent.
      whole: whether the model itself holds the bank's meshes, materials, textures and slots, as MuJoCo's own renderers
        need them.
      streets: whether `RenderModel.meshes` are the bank's too, or only those of what moves.

    Raises:
      ValidationError: the bank has no visual mesh, the robot has a visual geom without a surface, or the bank has no
        such appearance.
    """
    if streets and (bank.num_meshes == 0 or bank.slot_mesh.size == 0):
        raise ValidationError("bank.slot_mesh: found no visual slot or no mesh; needed at least one; rebuild the bank")
    spec = mujoco.MjSpec()
    spec.stat.extent = 1.0
    # `visual.map` holds the far and near planes, in extents of the model (here 1 m).
    spec.visual.map.znear, spec.visual.map.zfar = NEAR_PLANE, FAR_PLANE
    spec.visual.headlight.active = 0
    if whole:
        _add_bank(spec, bank)
    spec.add_material(name="absent", rgba=(0.0, 0.0, 0.0, 0.0))
    robot_model = None if robot is None else mujoco.MjModel.from_xml_string(robot.mjcf)
    geoms = [] if robot_model is None else _add_robot(spec, robot_model)
    agent_boxes = _add_agents(spec, bank, appearances)
    spec.worldbody.add_camera(name="eye")
    spec.worldbody.add_light(name="sun", type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL, castshadow=True, dir=(0, 0, -1))
    model = spec.compile()
    own = [RenderMeshes.of(model)]
    body, position, quaternion, boxes = np.zeros(0, np.int32), np.zeros((0, 3)), np.zeros((0, 4)), []
    if robot_model is not None:
        body = robot_model.geom_bodyid[geoms].astype(np.int32)
        position, quaternion = robot_model.geom_pos[geoms], robot_model.geom_quat[geoms]
        boxes = [_geom_box(robot_model, g) for g in geoms]
    bodies, number = 1 if robot_model is None else robot_model.nbody, len(appearances)
    shades = [] if robot_model is None or not geoms else [_robot_box(robot_model, geoms)]
    shades += [(bodies + i, box) for i, box in enumerate(agent_boxes)]
    labels = [[ROBOT_LABEL, ROBOT_LABEL]] * len(geoms) + [
        [AGENT_LABEL - k, bank.agents["category"][i]] for k, i in enumerate(appearances)
    ]
    rotation = np.concatenate([rotations.matrix_f64(quaternion.reshape(-1, 4)), np.tile(np.eye(3), (number, 1, 1))])
    return RenderModel(
        model=model,
        meshes=RenderMeshes.joined(own if whole or not streets else [*_bank_meshes(bank), *own]),
        num_slots=bank.slot_mesh.shape[1] if whole else 0,
        robot_body=np.concatenate([body, bodies + np.arange(number)]).astype(np.int32),
        robot_position=np.concatenate([position.reshape(-1, 3), np.zeros((number, 3))]).astype(np.float32),
        robot_rotation=rotation.astype(np.float32),
        robot_half=np.concatenate([np.array(boxes).reshape(-1, 2, 3), agent_boxes]).astype(np.float32),
        labels=np.array(labels, np.int32).reshape(-1, 2),
        num_bodies=bodies + number,
        num_agents=number,
        shade_body=np.array([body for body, _ in shades], np.int32),
        shade_box=np.array([box for _, box in shades], np.float64).reshape(-1, 2, 3),
        cameras={} if robot_model is None else _cameras(robot_model),
    )
