"""Cloth that is printed on both sides: its two sides apart, so that a renderer without culling does not mix them."""

import dataclasses

import numpy as np

from urbanverse_mjx.datatypes import AssetMesh

#: Leaves with such cloth (`MeshBuilder.sheet` with `lettered`).
LETTERED = frozenset({"banner", "flag"})
#: m between the two sides, more than the depth buffers and rays of the renderers resolve at 30 m.
APART = 0.008


def with_sides_apart(mesh: AssetMesh) -> AssetMesh:
    """A mesh whose faces that lie on each other, back to back, move apart along their normals by half of `APART` each.

    Returns:
      the same mesh if it has no such faces.
    """
    keys = np.unique(np.round(mesh.vertices.astype(np.float64) / 1e-5).astype(np.int64), axis=0, return_inverse=True)[1]
    corners = np.sort(keys.reshape(-1)[mesh.faces], axis=1)
    _, which, count = np.unique(corners, axis=0, return_inverse=True, return_counts=True)
    faces = mesh.faces[count[which.reshape(-1)] == 2]
    if not len(faces):
        return mesh
    triangles = mesh.vertices.astype(np.float64)[faces]
    normal = np.zeros(mesh.vertices.shape)
    for k in range(3):
        np.add.at(normal, faces[:, k], np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]))
    length = np.sqrt((normal**2).sum(1, keepdims=True))
    moved = mesh.vertices + normal / np.maximum(length, 1e-12) * APART / 2
    return dataclasses.replace(mesh, vertices=moved.astype(mesh.vertices.dtype))
