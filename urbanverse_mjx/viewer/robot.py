"""Writes a robot as glTF, one file for each of its visible bodies."""

import mujoco
import numpy as np

from ..datatypes import RobotSpec
from ..geometry import rotations
from ..simulation.rendering.model import VISUAL_GROUP
from ..simulation.rendering.shapes import primitive_mesh
from .gltf import Part, Surface, glb, merged

#: Straight pieces of a full circle: within 0.7 mm at a radius of 0.15 m, with a sixteenth of the triangles that the
#: renderer draws.
_SLICES = 32


def robot_parts(robot: RobotSpec) -> dict[int, list[Part]]:
    """Body of the robot's model -> its visual geoms in the body's frame, one part for each of its surfaces."""
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    surfaces: dict[int | tuple[float, ...], Surface] = {}
    parts: dict[int, list[Part]] = {}
    for geom in np.flatnonzero(model.geom_group == VISUAL_GROUP):
        pose = np.eye(4)
        pose[:3, :3] = rotations.matrix_f64(model.geom_quat[geom])
        pose[:3, 3] = model.geom_pos[geom]
        material = int(model.geom_matid[geom])
        key = material if material >= 0 else tuple(map(float, model.geom_rgba[geom]))
        if key not in surfaces:
            surfaces[key] = _surface(model, int(geom))
        parts.setdefault(int(model.geom_bodyid[geom]), []).append(_geom(model, int(geom), surfaces[key], pose[None]))
    return {body: merged(found) for body, found in parts.items()}


def robot_files(robot: RobotSpec) -> dict[int, bytes]:
    """Body of the robot's model -> its file."""
    return {body: glb(parts) for body, parts in robot_parts(robot).items()}


def _surface(model: mujoco.MjModel, geom: int) -> Surface:
    material = int(model.geom_matid[geom])
    rgba = model.geom_rgba[geom] if material < 0 else model.mat_rgba[material]
    return Surface(
        rgba=tuple(float(x) for x in rgba),  # type: ignore[arg-type]
        texture=_texture(model, material),
        roughness=_given(model.mat_roughness, material, 0.8),
        metallic=_given(model.mat_metallic, material, 0.0),
    )


def _geom(model: mujoco.MjModel, geom: int, surface: Surface, poses: np.ndarray) -> Part:
    if model.geom_type[geom] != mujoco.mjtGeom.mjGEOM_MESH:
        vertices, normals, faces = primitive_mesh(int(model.geom_type[geom]), model.geom_size[geom], _SLICES)
        return Part(vertices, faces, surface, normals=normals, poses=poses)
    mesh = int(model.geom_dataid[geom])
    rows = slice(model.mesh_faceadr[mesh], model.mesh_faceadr[mesh] + model.mesh_facenum[mesh])
    # Corners of their own for each triangle: MuJoCo indexes vertices, normals and texture coordinates separately.
    corners = model.mesh_face[rows].reshape(-1)
    vertices = model.mesh_vert[model.mesh_vertadr[mesh] + corners]
    normals = model.mesh_normal[model.mesh_normaladr[mesh] + model.mesh_facenormal[rows].reshape(-1)]
    uv = None
    if model.mesh_texcoordadr[mesh] >= 0:
        uv = model.mesh_texcoord[model.mesh_texcoordadr[mesh] + model.mesh_facetexcoord[rows].reshape(-1)]
        uv = uv * [1.0, -1.0] + [0.0, 1.0]
    return Part(vertices, np.arange(len(vertices)).reshape(-1, 3), surface, uv, normals, poses)


def _given(values: np.ndarray, material: int, default: float) -> float:
    """Returns a material's value; MuJoCo has -1 for unset values."""
    return float(values[material]) if material >= 0 and values[material] >= 0.0 else default


def _texture(model: mujoco.MjModel, material: int) -> np.ndarray | None:
    if material < 0:
        return None
    texture = int(model.mat_texid[material, int(mujoco.mjtTextureRole.mjTEXROLE_RGB)])
    if texture < 0 or model.tex_type[texture] != mujoco.mjtTexture.mjTEXTURE_2D:
        return None
    shape = int(model.tex_height[texture]), int(model.tex_width[texture]), int(model.tex_nchannel[texture])
    start = int(model.tex_adr[texture])
    return np.ascontiguousarray(model.tex_data[start : start + int(np.prod(shape))].reshape(shape)[..., :3])
