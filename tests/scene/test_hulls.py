import collections

import numpy as np
import pytest
from scipy.spatial import Delaunay

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.scene.hulls import convex_part, hull_table


def _clouds() -> list[np.ndarray]:
    rng = np.random.default_rng(0)
    box = np.array([(x, y, z) for x in (0, 2) for y in (0, 1) for z in (0, 0.3)], float)
    ring = np.array([(np.cos(a), np.sin(a)) for a in np.arange(16) * np.pi / 8])
    drum = np.concatenate([np.column_stack([ring, np.full(16, z)]) for z in (0.0, 1.5)])
    far = box + np.array([80.0, -15.0, 0.15])
    return [box, drum, far, *(rng.normal(size=(n, 3)) * [3, 1, 0.2] for n in (4, 9, 20, 30))]


@pytest.mark.parametrize("points", _clouds())
def test_planes_and_triangles_against_delaunay(points: np.ndarray) -> None:
    part = convex_part(points)
    low, high = points.min(0), points.max(0)
    probes = np.random.default_rng(1).uniform(low - 0.2 * (high - low), high + 0.2 * (high - low), (4000, 3))
    depth = (probes @ part.planes[:, :3].T - part.planes[:, 3]).max(1)
    inside = Delaunay(points - low).find_simplex(probes - low) >= 0
    clear = np.abs(depth) > 1e-4
    assert clear.mean() > 0.9
    assert 0.005 < inside.mean() < 0.98
    np.testing.assert_array_equal(depth[clear] < 0, inside[clear])
    assert np.linalg.norm(part.planes[:, :3], axis=1) == pytest.approx(1.0, abs=1e-6)
    a, b, c = (part.corners[part.triangles[:, k]].astype(float) for k in range(3))
    normal = np.cross(b - a, c - a)
    assert (np.einsum("ij,ij->i", normal, part.planes[:, :3]) > 0).all()
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
    assert volume == pytest.approx(part.volume, rel=1e-3, abs=1e-3)
    edges = collections.Counter((int(t[i]), int(t[(i + 1) % 3])) for t in part.triangles for i in range(3))
    assert all(edges[b, a] == 1 and n == 1 for (a, b), n in edges.items())


def test_inner_points_are_dropped() -> None:
    box = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    part = convex_part(np.concatenate([box, [[0.5, 0.5, 0.5], [0.2, 0.9, 0.4]]]))
    assert len(part.corners) == 8
    np.testing.assert_allclose(part.box, [[0.5] * 3, [0.5] * 3])


def test_flat_and_too_many_corners_are_refused() -> None:
    with pytest.raises(ValidationError, match="without volume"):
        convex_part(np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], float))
    sphere = np.random.default_rng(0).normal(size=(60, 3))
    with pytest.raises(ValidationError, match="at most 32"):
        convex_part(sphere / np.linalg.norm(sphere, axis=1, keepdims=True))


def test_table_pads_with_first_rows() -> None:
    table = hull_table([convex_part(p) for p in _clouds()])
    for row in range(len(_clouds())):
        n, f = table["hull_num_vertices"][row], table["hull_num_triangles"][row]
        assert (table["hull_vertices"][row, n:] == table["hull_vertices"][row, 0]).all()
        assert (table["hull_planes"][row, f:] == table["hull_planes"][row, 0]).all()
        assert (table["hull_triangles"][row, f:] == table["hull_triangles"][row, 0]).all()
