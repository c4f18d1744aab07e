"""Smooth random deformations of meshes, so that few base shapes give many training shapes.

A mesh keeps its bounding box, its faces and its texture. Inside the box parts move along each axis, the outline tapers
and bulges with height, and the shape twists and leans a little: free-form deformation (Sederberg and Parry, 1986) with
a few global functions after Barr (1984).
"""

import dataclasses

import numpy as np

from urbanverse_mjx.datatypes import AssetMesh, AssetRecord
from urbanverse_mjx.datatypes.hashing import content_hash


@dataclasses.dataclass(frozen=True)
class Variation:
    """Largest values of the deformations; chosen manually.

    Attributes:
      shift: of parts along an axis; 1 would compress one place to nothing.
      taper: of the outline, as a share from the middle to either end.
      bulge: of the outline at half height, as a share.
      lean: of the top against the bottom, as a share of the width.
      twist: rad from the bottom to the top.
    """

    shift: float = 0.45
    taper: float = 0.22
    bulge: float = 0.18
    lean: float = 0.1
    twist: float = 0.25


#: Houses stand side by side and vehicles have straight sides: there only parts move.
STRAIGHT = Variation(0.35, 0.0, 0.0, 0.0, 0.0)
ROLLING = Variation(0.35, 0.08, 0.06, 0.0, 0.0)
FREE = Variation()


def deformed(mesh: AssetMesh, rng: np.random.Generator, most: Variation) -> AssetMesh:
    """A mesh with the same bounding box and faces, deformed by random amounts up to `most`."""
    low, size = mesh.vertices.min(0).astype(np.float64), np.maximum(mesh.extent.astype(np.float64), 1e-6)
    q = (mesh.vertices - low) / size
    for axis in range(3):
        for waves in (1, 2):  # increasing in q, because the amounts sum to less than 1
            amount = rng.uniform(-most.shift, most.shift) / waves
            q[:, axis] += amount * np.sin(2.0 * np.pi * waves * q[:, axis]) / (2.0 * np.pi * waves) / 1.5
    height = q[:, 2] - 0.5
    outline = (q[:, :2] - 0.5) * (1.0 + rng.uniform(-most.taper, most.taper, 2) * 2.0 * height[:, None])
    outline *= 1.0 + rng.uniform(-most.bulge, most.bulge) * np.cos(np.pi * height)[:, None]
    outline += rng.uniform(-most.lean, most.lean, 2) * height[:, None]
    # The twist is a rotation in metres, not in shares of the box.
    metres = outline * size[:2]
    angle = rng.uniform(-most.twist, most.twist) * height
    c, s = np.cos(angle), np.sin(angle)
    metres = np.column_stack([c * metres[:, 0] - s * metres[:, 1], s * metres[:, 0] + c * metres[:, 1]])
    moved = np.column_stack([metres, q[:, 2]])
    span = np.maximum(np.ptp(moved, axis=0), 1e-9)
    vertices = (moved - moved.min(0)) / span * size + low
    return dataclasses.replace(mesh, vertices=vertices.astype(np.float32))


def seeded(record: AssetRecord) -> np.random.Generator:
    """Random numbers that depend on a record's uid alone."""
    return np.random.default_rng(int(content_hash({"shape": record.uid})[:15], 16))


def joined(bottom: AssetMesh, top: AssetMesh, share: float) -> AssetMesh:
    """The lower part of one mesh, up to a share of its height, with the upper part of another, scaled to its box.

    Triangles belong to the side of the cut that holds their middle. Returns `bottom` where a part would have fewer than
    four triangles, or a texture repeats, because both textures become one.
    """
    if any(m.uv.min() < -1e-3 or m.uv.max() > 1.0 + 1e-3 for m in (bottom, top)):
        return bottom
    low, size = bottom.vertices.min(0), np.maximum(bottom.extent, 1e-6)
    fitted = (top.vertices - top.vertices.min(0)) / np.maximum(top.extent, 1e-6) * size + low
    cut = low[2] + share * size[2]
    lower = bottom.vertices[bottom.faces][..., 2].mean(1) < cut
    upper = fitted[top.faces][..., 2].mean(1) >= cut
    if min(lower.sum(), upper.sum()) < 4:
        return bottom
    a, b = bottom.texture, top.texture
    height, width = len(a) + len(b), max(a.shape[1], b.shape[1])
    texture = np.zeros((height, width, 3), np.uint8)
    texture[: len(a), : a.shape[1]], texture[len(a) :, : b.shape[1]] = a, b
    # Rows of a texture go downwards, the second coordinate upwards.
    uv_a = np.column_stack([bottom.uv[:, 0] * a.shape[1] / width, 1.0 - (1.0 - bottom.uv[:, 1]) * len(a) / height])
    uv_b = np.column_stack([top.uv[:, 0] * b.shape[1] / width, top.uv[:, 1] * len(b) / height])
    faces = np.concatenate([bottom.faces[lower], top.faces[upper] + len(bottom.vertices)])
    used, faces = np.unique(faces, return_inverse=True)
    return dataclasses.replace(
        bottom,
        vertices=np.concatenate([bottom.vertices, fitted])[used],
        uv=np.concatenate([uv_a, uv_b])[used].astype(np.float32),
        faces=faces.reshape(-1, 3).astype(np.int32),
        texture=texture,
    )
