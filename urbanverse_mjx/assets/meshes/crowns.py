"""Crowns of leaves: sprays that stand out in all directions instead of closed lumps, with the same triangles."""

import dataclasses
import zlib

import numpy as np

from urbanverse_mjx.datatypes import AssetMesh

#: Share of the facets of a lump that become sprays; the others stay and hide what is behind.
_SPRAYS = 0.6
#: Size of a spray over its facet, its greatest tilt (rad), and how far it moves outwards over the facet's size.
_SIZE, _TILT, _OUT = (1.05, 1.6), 1.15, (0.0, 0.45)


def with_sprays(mesh: AssetMesh, name: str) -> AssetMesh:
    """A plant whose facets of leaves are turned into sprays.

    Facets of leaves are triangles that share no corner and show a piece of an image.

    Args:
      name: decides which facets, and how they turn.
    """
    corners = mesh.uv[mesh.faces]
    used = np.bincount(mesh.faces.ravel(), minlength=len(mesh.vertices))
    leaves = np.flatnonzero(~(corners == corners[:, :1]).all((1, 2)) & (used[mesh.faces] == 1).all(1))
    if not len(leaves):
        return mesh
    rng = np.random.default_rng(zlib.crc32(name.encode()))
    leaves = leaves[rng.random(len(leaves)) < _SPRAYS]
    vertices = mesh.vertices.astype(np.float64).copy()
    triangles = vertices[mesh.faces[leaves]]
    middle = triangles.mean(1, keepdims=True)
    arms = triangles - middle
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    area = np.linalg.norm(normal, axis=1, keepdims=True)
    normal /= np.maximum(area, 1e-12)
    size = np.sqrt(area / 2)[:, None]
    # Turned about an axis in the facet's plane (Rodrigues), so that its edges stand out of the lump.
    axis = arms[np.arange(len(arms)), rng.integers(0, 3, len(arms))]
    axis /= np.maximum(np.linalg.norm(axis, axis=1, keepdims=True), 1e-12)
    angle = (rng.uniform(0.25, 1.0, len(arms)) * _TILT * rng.choice((-1.0, 1.0), len(arms)))[:, None, None]
    axis = axis[:, None]
    arms = (
        arms * np.cos(angle)
        + np.cross(np.broadcast_to(axis, arms.shape), arms) * np.sin(angle)
        + axis * (arms * axis).sum(-1, keepdims=True) * (1 - np.cos(angle))
    )
    arms *= rng.uniform(*_SIZE, (len(arms), 1, 1))
    out = normal[:, None] * size * rng.uniform(*_OUT, (len(arms), 1, 1))
    moved = middle + arms + out
    moved[..., 2] = np.maximum(moved[..., 2], float(vertices[:, 2].min()))
    vertices[mesh.faces[leaves]] = moved
    return dataclasses.replace(mesh, vertices=vertices)
