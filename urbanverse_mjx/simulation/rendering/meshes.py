"""Triangles of compiled models, in the frames in which their meshes were authored."""

import dataclasses
from collections.abc import Sequence

import mujoco
import numpy as np

from ...geometry import rotations


@dataclasses.dataclass(frozen=True)
class RenderMeshes:
    """Triangles of M meshes in the frames in which they were authored (the compiler moves each to its inertial frame).

    Attributes:
      vertices (ΣV, 3) m, normals (ΣVn, 3), uv (ΣVt, 2): f32.
      count: (M,) triangles of each mesh.
      face, face_normal, face_uv: (ΣF, 3) i32, rows of these tables; -1 in face_uv where a mesh has no UV.
    """

    vertices: np.ndarray
    normals: np.ndarray
    uv: np.ndarray
    count: np.ndarray
    face: np.ndarray
    face_normal: np.ndarray
    face_uv: np.ndarray

    @staticmethod
    def of(model: mujoco.MjModel) -> "RenderMeshes":
        """All meshes of a compiled model."""
        mesh, textured = np.repeat(np.arange(model.nmesh), model.mesh_facenum), model.mesh_texcoordadr >= 0
        return RenderMeshes(
            *_authored(model),
            model.mesh_texcoord.copy(),
            model.mesh_facenum.copy(),
            model.mesh_face + model.mesh_vertadr[mesh, None],
            model.mesh_facenormal + model.mesh_normaladr[mesh, None],
            np.where(textured[mesh, None], model.mesh_facetexcoord + model.mesh_texcoordadr[mesh, None], -1),
        )

    @staticmethod
    def joined(parts: Sequence["RenderMeshes"]) -> "RenderMeshes":
        """The meshes of several tables, in order."""
        names = [field.name for field in dataclasses.fields(RenderMeshes)]
        tables = {name: np.concatenate([getattr(p, name) for p in parts]) for name in names}
        for name, rows in (("face", "vertices"), ("face_normal", "normals"), ("face_uv", "uv")):
            # In place: of 200 streets each of these tables has hundreds of megabytes.
            first = before = 0
            for part in parts:
                found = tables[name][first : first + len(getattr(part, name))]
                absent = found < 0
                found += before
                found[absent] = -1
                first, before = first + len(found), before + len(getattr(part, rows))
        return RenderMeshes(**tables)


def _authored(model: mujoco.MjModel) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and normals of all meshes in the frames they were authored in."""
    vertices, normals = model.mesh_vert.copy(), model.mesh_normal.copy()
    turns = rotations.matrix_f64(model.mesh_quat) if model.nmesh else np.zeros((0, 3, 3))
    for i, rotation in enumerate(turns):
        corners = slice(model.mesh_vertadr[i], model.mesh_vertadr[i] + model.mesh_vertnum[i])
        arrows = slice(model.mesh_normaladr[i], model.mesh_normaladr[i] + model.mesh_normalnum[i])
        vertices[corners] = vertices[corners].astype(np.float64) @ rotation.T + model.mesh_pos[i]
        normals[arrows] = normals[arrows].astype(np.float64) @ rotation.T
    return vertices, normals
