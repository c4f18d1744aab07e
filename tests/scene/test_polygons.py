import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from urbanverse_mjx.scene.polygons import convex_parts, triangulate, without_straight_corners

SQUARE = [(0, 0), (4, 0), (4, 4), (0, 4)]
ELL = [(0, 0), (4, 0), (4, 2), (2, 2), (2, 4), (0, 4)]
PLUS = [(1, 0), (2, 0), (2, 1), (3, 1), (3, 2), (2, 2), (2, 3), (1, 3), (1, 2), (0, 2), (0, 1), (1, 1)]
COMB = [(0, 0), (7, 0), (7, 3), (6, 3), (6, 1), (4, 1), (4, 3), (3, 3), (3, 1), (1, 1), (1, 3), (0, 3)]


def _circle(n: int) -> list[tuple[float, float]]:
    angle = 2 * np.pi * np.arange(n) / n
    return list(zip(np.cos(angle), np.sin(angle), strict=True))


@pytest.mark.parametrize(
    ("polygon", "parts"),
    [(SQUARE, 1), (ELL, 2), (PLUS, 3), (COMB, 4), (_circle(8), 1), (_circle(9), 2), (_circle(14), 2), (_circle(15), 3)],
)
def test_number_of_parts_is_the_least_possible(polygon: list[tuple[float, float]], parts: int) -> None:
    assert len(convex_parts(np.array(polygon, float))) == parts


def test_straight_corners_cost_nothing() -> None:
    ring = np.array([(0, 0), (1, 0), (2, 0), (4, 0), (4, 3), (4, 4), (0, 4), (0, 1)], float)
    assert len(without_straight_corners(ring)) == 4
    assert len(convex_parts(ring, max_corners=4)) == 1


@settings(max_examples=60, deadline=None)
@given(st.lists(st.floats(0.3, 5.0), min_size=4, max_size=24), st.integers(3, 8), st.floats(-100, 100))
def test_parts_cover_exactly_without_overlap(radii: list[float], most: int, shift: float) -> None:
    angle = 2 * np.pi * np.arange(len(radii)) / len(radii)
    ring = np.column_stack([np.cos(angle), np.sin(angle)]) * np.array(radii)[:, None] + shift
    whole = shapely.Polygon(ring)
    parts = [shapely.Polygon(p) for p in convex_parts(ring, most)]
    assert sum(p.area for p in parts) == pytest.approx(whole.area, rel=1e-9)
    assert shapely.union_all(parts).symmetric_difference(whole).area < 1e-9 * whole.area
    for part in parts:
        assert len(part.exterior.coords) - 1 <= most
        assert part.exterior.is_ccw
        assert part.convex_hull.area == pytest.approx(part.area, rel=1e-9)


def test_triangles_cover_and_turn_left() -> None:
    ring = np.array(COMB, float)
    corners = ring[triangulate(ring)]
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas = (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2
    assert (areas > 0).all()
    assert areas.sum() == pytest.approx(shapely.Polygon(ring).area)


def test_corners_in_one_line_leave_no_part_without_area() -> None:
    """A pavement with four ramps whose tops lie in one line: parts cover it exactly and each has an area."""
    ring = [(0.0, -12.0), (96.0, -12.0), (96.0, -7.0)]
    for x in (72.0, 58.2, 17.8, 4.3):
        ring += [(round(x + dx, 3), y) for dx, y in ((1.9, -7.0), (1.0, -8.5), (-1.0, -8.5), (-1.9, -7.0))]
    ring += [(0.0, -7.0)]
    parts = convex_parts(np.array(ring))
    shapes = [shapely.Polygon(part) for part in parts]
    assert min(s.area for s in shapes) > 1e-6
    assert shapely.union_all(shapes).symmetric_difference(shapely.Polygon(ring)).area < 1e-9
