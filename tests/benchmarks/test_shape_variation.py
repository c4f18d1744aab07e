"""Deformed and joined training shapes: same box and faces, other parts; colours stay on their triangles."""

import numpy as np
import pytest

from benchmarks.lib.shape_variation import FREE, STRAIGHT, deformed, joined
from urbanverse_mjx.assets import load_index
from urbanverse_mjx.assets.records.index import build_mesh
from urbanverse_mjx.datatypes import AssetMesh


def _mesh(leaf: str, number: int = 0) -> AssetMesh:
    return build_mesh(load_index().by_leaf(leaf)[number])


@pytest.mark.parametrize("leaf", ["bench", "tree", "street light"])
def test_a_deformed_mesh_keeps_its_box_and_its_faces(leaf: str):
    mesh = _mesh(leaf)
    other = deformed(mesh, np.random.default_rng(3), FREE)
    np.testing.assert_allclose(other.vertices.min(0), mesh.vertices.min(0), atol=1e-5)
    np.testing.assert_allclose(other.extent, mesh.extent, rtol=1e-4)
    np.testing.assert_array_equal(other.faces, mesh.faces)
    moved = np.abs(other.vertices - mesh.vertices).max() / mesh.extent.max()
    assert 0.01 < moved < 0.5
    again = deformed(mesh, np.random.default_rng(3), FREE)
    np.testing.assert_array_equal(again.vertices, other.vertices)


def test_a_house_front_stays_upright():
    mesh = _mesh("bakery")
    other = deformed(mesh, np.random.default_rng(0), STRAIGHT)
    for axis in range(3):
        # Vertices at one place along an axis stay at one place, in the same order.
        places, index = np.unique(mesh.vertices[:, axis], return_index=True)
        assert (np.diff(other.vertices[index, axis]) >= -1e-5).all()
        at = np.searchsorted(places, mesh.vertices[:, axis])
        np.testing.assert_allclose(other.vertices[:, axis], other.vertices[index, axis][at], atol=1e-4)


def _colours(mesh: AssetMesh) -> np.ndarray:
    """(F, 3) colour of the texture in the middle of each face."""
    u, v = np.moveaxis(mesh.uv[mesh.faces].mean(1), -1, 0)
    h, w = mesh.texture.shape[:2]
    return mesh.texture[((1.0 - v) * h).astype(int).clip(0, h - 1), (u * w).astype(int).clip(0, w - 1)]


def test_joined_shapes_have_the_lower_and_the_upper_part_in_their_colours():
    a, b = _mesh("bench", 0), _mesh("street light", 0)
    both = joined(a, b, 0.5)
    np.testing.assert_allclose(both.vertices.max(0)[2], a.vertices.max(0)[2], atol=1e-4)
    cut = a.vertices.min(0)[2] + 0.5 * a.extent[2]
    below = a.vertices[a.faces][..., 2].mean(1) < cut
    count = int(below.sum())
    np.testing.assert_allclose(both.vertices[both.faces[:count]], a.vertices[a.faces[below]], atol=1e-6)
    np.testing.assert_array_equal(_colours(both)[:count], _colours(a)[below])
    height = (b.vertices[b.faces][..., 2].mean(1) - b.vertices.min(0)[2]) / b.extent[2]
    clear = np.abs(height - 0.5) > 1e-3
    above = (height >= 0.5) & clear
    assert abs(len(both.faces) - count - int(above.sum())) <= int((~clear).sum())
    assert {tuple(c) for c in _colours(both)[count:]} <= {tuple(c) for c in _colours(b)}


def test_a_part_without_triangles_leaves_the_mesh_as_it_is():
    a, b = _mesh("bench", 0), _mesh("bench", 1)
    assert joined(a, b, 0.0) is a
    assert joined(a, b, 1.5) is a
