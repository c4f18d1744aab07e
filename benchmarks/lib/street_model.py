"""Builds a stock MuJoCo model of one scene of a bank with the robot."""

import mujoco
import numpy as np

from urbanverse_mjx.datatypes import RobotSpec, SceneBank

#: Names and groups as in a compiled scene's MJCF: visual meshes and collision hulls.
ROBOT, SEEN, HIT = "robot/", 2, 3
#: m, clipping planes of cameras as in the scene's MJCF: far houses are visible, close wheels are not clipped.
_NEAR, _FAR = 0.02, 300.0


def street_model(
    bank: SceneBank,
    scene: int,
    robot: RobotSpec,
    timestep: float,
    near: np.ndarray | None = None,
    hulls: int | None = None,
    prisms: int | None = None,
    seen: bool = False,
    size: tuple[int, int] = (48, 64),
    numeric: dict[str, float] | None = None,
) -> mujoco.MjModel:
    """Hulls and ground prisms as mesh geoms, the robot attached under the prefix `ROBOT`.

    Args:
      timestep: s.
      near: (2,) m; with `hulls` and `prisms` only so many nearest to it are kept, all of them where None.
      seen: visual meshes with their textures, too.
      size: height and width the robot's camera gets.
      numeric: custom numbers, by which MJX takes its limits.
    """
    spec = mujoco.MjSpec()
    spec.visual.map.znear, spec.visual.map.zfar = _NEAR / 100, _FAR / 100
    spec.stat.extent = 100.0  # znear and zfar count in it
    spec.visual.global_.offheight, spec.visual.global_.offwidth = size
    for name, value in (numeric or {}).items():
        spec.add_numeric(name=name, data=[value], size=1)
    made: set[int] = set()
    for row in _nearest(bank, bank.inst_hull[scene], bank.inst_position[scene], near, hulls):
        rotation, friction = bank.inst_rotation[scene, row], bank.inst_friction[scene, row]
        _add_hull(spec, bank, int(bank.inst_hull[scene, row]), made, bank.inst_position[scene, row], rotation, friction)
    for row in _nearest(bank, bank.prism_hull[scene], bank.prism_position[scene], near, prisms):
        position, friction = bank.prism_position[scene, row], bank.prism_friction[scene, row]
        _add_hull(spec, bank, int(bank.prism_hull[scene, row]), made, position, np.eye(3), friction)
    if seen:
        _add_visuals(spec, bank, scene)
    body = mujoco.MjSpec.from_string(robot.mjcf)
    for option in ("integrator", "cone"):
        setattr(spec.option, option, getattr(body.option, option))
    spec.option.timestep = timestep
    spec.attach(body, prefix=ROBOT, frame=spec.worldbody.add_frame())
    return spec.compile()


def _nearest(
    bank: SceneBank, hull: np.ndarray, position: np.ndarray, near: np.ndarray | None, count: int | None
) -> np.ndarray:
    """Rows of present instances, by the distance of their boxes' spheres from a place; the first `count` of them."""
    rows = np.flatnonzero(hull >= 0)
    if near is None:
        return rows[:count]
    size = np.linalg.norm(bank.hull_box[hull[rows], 1, :2], axis=-1)
    away = np.linalg.norm(position[rows, :2] - near, axis=-1) - size
    return rows[np.argsort(away, kind="stable")[:count]]


def _add_hull(
    spec: mujoco.MjSpec,
    bank: SceneBank,
    hull: int,
    made: set[int],
    position: np.ndarray,
    rotation: np.ndarray,
    friction: float,
) -> None:
    name = f"hull_{hull}"
    if hull not in made:
        made.add(hull)
        mesh = spec.add_mesh(name=name, uservert=bank.hull_vertices[hull, : bank.hull_num_vertices[hull]].ravel())
        mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX
    geom = spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, pos=position, group=HIT)
    mujoco.mju_mat2Quat(geom.quat, np.asarray(rotation, np.float64).ravel())
    geom.friction[0] = friction


def _add_visuals(spec: mujoco.MjSpec, bank: SceneBank, scene: int) -> None:
    """Adds visual meshes of a scene with their textures, and a sun."""
    sun = spec.worldbody.add_light(pos=[0, 0, 50], dir=[0.3, 0.4, -0.85])
    sun.type = mujoco.mjtLightType.mjLIGHT_DIRECTIONAL
    slots = np.flatnonzero(bank.slot_mesh[scene] >= 0)
    for mesh in np.unique(bank.slot_mesh[scene, slots]):
        corners = slice(bank.mesh_vertex_start[mesh], bank.mesh_vertex_start[mesh + 1])
        faces = bank.mesh_faces[bank.mesh_face_start[mesh] : bank.mesh_face_start[mesh + 1]]
        # MuJoCo's texture coordinates start at the image's top row, the bank's at the lowest.
        uv = np.column_stack([bank.mesh_uv[corners, 0], 1.0 - bank.mesh_uv[corners, 1]])
        added = spec.add_mesh(
            name=f"seen_{mesh}",
            uservert=bank.mesh_vertices[corners].ravel(),
            userface=faces.ravel(),
            usertexcoord=uv.ravel(),
            userfacetexcoord=faces.ravel(),
        )
        added.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
    for material in np.unique(bank.mesh_material[bank.slot_mesh[scene, slots]]):
        _add_material(spec, bank, int(material))
    for slot in slots:
        mesh = bank.slot_mesh[scene, slot]
        spec.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_MESH,
            meshname=f"seen_{mesh}",
            material=f"seen_{bank.mesh_material[mesh]}",
            pos=bank.slot_position[scene, slot],
            quat=bank.slot_quaternion[scene, slot],
            group=SEEN,
            contype=0,
            conaffinity=0,
        )


def _add_material(spec: mujoco.MjSpec, bank: SceneBank, material: int) -> None:
    added = spec.add_material(name=f"seen_{material}", rgba=bank.material_rgba[material])
    texture = int(bank.material_texture[material])
    if texture < 0:
        return
    name = f"texture_{texture}"
    if spec.texture(name) is None:
        pixels = bank.texture(texture)
        image = spec.add_texture(name=name, type=mujoco.mjtTexture.mjTEXTURE_2D, nchannel=3)
        image.height, image.width = pixels.shape[:2]
        image.data = pixels.tobytes()
    added.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = name
