"""The appearance of a robot as a mesh of a bank, for robots that other robots see as moving agents."""

import dataclasses

import mujoco
import numpy as np

from ...datatypes import RobotSpec, SceneBank
from .model import VISUAL_GROUP
from .shapes import primitive_mesh

#: Pixels along the side of a colour in the texture, so that no neighbour's colour bleeds into it.
_SIDE = 4


def with_robot_appearance(bank: SceneBank, robot: RobotSpec, kind: str, middle: float) -> SceneBank:
    """The bank with the robot in its initial pose as one more appearance of agents: all visual geoms as one mesh, each
    in the mean colour of its material.

    Args:
      kind: name of the appearance in `SceneBank.agents`.
      middle: m along the heading from the root body's origin to what is the agent's position.
    """
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    data = mujoco.MjData(model)
    data.qpos[:] = model.key_qpos[0] if model.nkey else model.qpos0
    data.qpos[:7] = -middle, 0.0, robot.spawn_height, 1, 0, 0, 0
    mujoco.mj_kinematics(model, data)
    geoms = [int(g) for g in np.flatnonzero(model.geom_group == VISUAL_GROUP)]
    corners, faces, uv, first = [], [], [], 0
    for k, g in enumerate(geoms):
        local, triangles = _surface(model, g)
        turn = data.geom_xmat[g].reshape(3, 3)
        # Corners of their own for each triangle, so that edges stay sharp.
        world = (local @ turn.T + data.geom_xpos[g])[triangles].reshape(-1, 3)
        corners.append(world)
        faces.append(first + np.arange(len(world)).reshape(-1, 3))
        uv.append(np.tile([(k + 0.5) / len(geoms), 0.5], (len(world), 1)))
        first += len(world)
    image = np.repeat(np.array([_colour(model, g) for g in geoms], np.uint8), _SIDE, 0)[None].repeat(_SIDE, 0)
    return _added(bank, np.concatenate(corners), np.concatenate(faces), np.concatenate(uv), image, kind)


def _surface(model: mujoco.MjModel, geom: int) -> tuple[np.ndarray, np.ndarray]:
    """(V, 3) m and (F, 3): the surface of a geom in its own frame."""
    if model.geom_type[geom] != mujoco.mjtGeom.mjGEOM_MESH:
        vertices, _, faces = primitive_mesh(int(model.geom_type[geom]), model.geom_size[geom])
        return vertices, faces
    mesh = int(model.geom_dataid[geom])
    start, first = int(model.mesh_vertadr[mesh]), int(model.mesh_faceadr[mesh])
    vertices = model.mesh_vert[start : start + int(model.mesh_vertnum[mesh])]
    return vertices.astype(np.float64), model.mesh_face[first : first + int(model.mesh_facenum[mesh])]


def _colour(model: mujoco.MjModel, geom: int) -> np.ndarray:
    """(3,) 0-255, sRGB."""
    material = int(model.geom_matid[geom])
    if material < 0:
        return np.rint(255.0 * model.geom_rgba[geom, :3])
    tint = model.mat_rgba[material, :3].astype(np.float64)
    texture = int(model.mat_texid[material, int(mujoco.mjtTextureRole.mjTEXROLE_RGB)])
    if texture < 0:
        return np.rint(255.0 * tint)
    start, channels = int(model.tex_adr[texture]), int(model.tex_nchannel[texture])
    count = int(model.tex_height[texture]) * int(model.tex_width[texture])
    pixels = model.tex_data[start : start + count * channels].reshape(count, channels)
    return np.rint(pixels[:, :3].mean(0) * tint)


def _added(
    bank: SceneBank, corners: np.ndarray, faces: np.ndarray, uv: np.ndarray, image: np.ndarray, kind: str
) -> SceneBank:
    """The bank with one more mesh, material, texture and appearance of agents."""

    def appended(name: str, rows: np.ndarray) -> np.ndarray:
        array = getattr(bank, name)
        return np.concatenate([array, np.asarray(rows, array.dtype)])

    categories, agents = list(bank.meta["categories"]), bank.agents
    name = "delivery robot"
    if name not in categories:
        categories.append(name)
    row = {"kind": kind, "mesh": bank.num_meshes, "category": categories.index(name)}
    return dataclasses.replace(
        bank,
        mesh_vertices=appended("mesh_vertices", corners),
        mesh_uv=appended("mesh_uv", uv),
        mesh_faces=appended("mesh_faces", faces),
        mesh_vertex_start=appended("mesh_vertex_start", np.array([len(bank.mesh_vertices) + len(corners)])),
        mesh_face_start=appended("mesh_face_start", np.array([len(bank.mesh_faces) + len(faces)])),
        mesh_material=appended("mesh_material", np.array([len(bank.material_texture)])),
        material_texture=appended("material_texture", np.array([len(bank.texture_shape)])),
        material_rgba=appended("material_rgba", np.ones((1, 4))),
        material_roughness=appended("material_roughness", np.array([0.6])),
        material_metallic=appended("material_metallic", np.array([0.0])),
        texture_data=appended("texture_data", image.ravel()),
        texture_start=appended("texture_start", np.array([len(bank.texture_data) + image.size])),
        texture_shape=appended("texture_shape", np.array([image.shape])),
        meta={
            **bank.meta,
            "categories": categories,
            "agents": {field: [*agents[field], value] for field, value in row.items()},
        },
    )
