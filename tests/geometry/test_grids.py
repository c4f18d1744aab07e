"""Look-up, rasterisation and measurement of cells agree with Shapely."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from urbanverse_mjx.geometry.grids import Grid, cell_of, closed, pooled
from urbanverse_mjx.geometry.polygons import filled, grown_outline, rectangle
from urbanverse_mjx.geometry.raster import nearest, outline, to_outline, touched

GRID = Grid(np.array([-2.0, 1.0]), 0.25, (24, 16))
#: Points of which some lie on corners and edges of cells, as walls laid on a raster do.
COORDINATES = st.integers(-6, 30).map(lambda k: 0.125 * k)
POINTS = st.lists(st.tuples(COORDINATES, COORDINATES), min_size=3, max_size=8, unique=True).map(np.array)


def squares() -> np.ndarray:
    """(X, Y) squares of the grid."""
    corner = GRID.centres(np.moveaxis(np.indices(GRID.shape), 0, -1)) - GRID.side / 2
    return shapely.box(corner[..., 0], corner[..., 1], corner[..., 0] + GRID.side, corner[..., 1] + GRID.side)


def mask(cells: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    found = np.zeros(GRID.shape, bool)
    found[cells] = True
    return found


def test_points_find_their_cells_in_numpy_and_under_jit() -> None:
    points = np.array([(-2.0, 1.0), (-1.76, 1.24), (-1.75, 1.25), (-9.0, 99.0)])
    cells = [(0, 0), (0, 0), (1, 1), (-28, 392)]
    assert cell_of(points, GRID.origin, GRID.side).tolist() == [list(c) for c in cells]
    assert GRID.cell(points).tolist() == [[0, 0], [0, 0], [1, 1], [0, 15]]
    look_up = jax.jit(lambda p: cell_of(p, jnp.asarray(GRID.origin), GRID.side, GRID.shape))
    assert look_up(jnp.asarray(points)).tolist() == GRID.cell(points).tolist()
    assert cell_of(jnp.asarray(points[:, 1]), 1.0, GRID.side).tolist() == [c[1] for c in cells]


def test_values_are_those_of_the_cells_and_outside_of_the_nearest() -> None:
    values = np.arange(12).reshape(3, 4)
    grid = Grid(np.array([1.0, -2.0]), 0.5, (3, 4))
    points = np.array([[[1.1, -1.9], [2.4, -0.1]], [[1.6, -1.4], [9.0, -9.0]]])
    np.testing.assert_array_equal(grid.at(values, points), [[0, 11], [5, 8]])


def test_centres_lie_in_their_cells_and_on_the_axes() -> None:
    cells = np.moveaxis(np.indices(GRID.shape), 0, -1)
    assert (GRID.cell(GRID.centres(cells)) == cells).all()
    x, y = GRID.axes((slice(2, 5), slice(0, 16)))
    np.testing.assert_array_equal(np.stack(np.meshgrid(x, y, indexing="ij"), -1), GRID.centres(cells)[2:5])


@settings(max_examples=60, deadline=None)
@given(POINTS)
def test_touched_cells_are_those_whose_squares_meet_the_outline(points: np.ndarray) -> None:
    hull = shapely.MultiPoint(points).convex_hull
    found = mask(touched(GRID, points))
    if isinstance(hull, shapely.Polygon):
        # Shapes that touch within rounding may be on either side.
        meets, clear = (shapely.intersects(squares(), hull.buffer(d)) for d in (-1e-6, 1e-6))
        assert not (meets & ~found).any()
        assert not (found & ~clear).any()
    else:
        window = np.zeros_like(found)
        window[GRID.window(points.min(0), points.max(0))] = True
        assert (found == window).all()


@settings(max_examples=60, deadline=None)
@given(POINTS, st.sampled_from([0.0, 0.3]))
def test_filled_cells_have_their_centres_inside(points: np.ndarray, reach: float) -> None:
    hull = shapely.MultiPoint(points).convex_hull
    if not isinstance(hull, shapely.Polygon):
        return
    centres = shapely.points(GRID.centres(np.moveaxis(np.indices(GRID.shape), 0, -1)))
    ring = grown_outline(points, reach) if reach else outline(points)
    found = mask(filled(GRID, ring))
    # Arcs around corners are drawn by straight pieces, up to 8 % inside them.
    assert not (shapely.contains(hull.buffer(0.92 * reach - 1e-6), centres) & ~found).any()
    assert not (found & ~shapely.intersects(hull.buffer(reach + 1e-6), centres)).any()


def test_distance_to_an_outline_by_hand() -> None:
    square = np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)])
    found = to_outline(square, np.array([-1.0, 0.5, 3.0, 5.0]), np.array([0.5, 4.0 + 1.0]))
    np.testing.assert_allclose(found[:, 0], [1.0, -0.5, 1.0, 3.0], atol=1e-6)
    assert found[3, 1] == pytest.approx(5.0)


def test_the_nearest_of_several_shapes_counts_up_to_a_distance() -> None:
    rings = [outline(np.array(corners, float)) for corners in ([(0, 2), (1, 2), (1, 3)], [(3, 4), (3, 5), (2, 5)])]
    shapes = [(r.min(0), r.max(0), lambda x, y, r=r: to_outline(r, x, y)) for r in rings]
    found = nearest(GRID, shapes, 1.5)
    at = shapely.points(GRID.centres(np.moveaxis(np.indices(GRID.shape), 0, -1)))
    signed = []
    for solid in map(shapely.Polygon, rings):
        inside = shapely.distance(solid.exterior, at) * shapely.contains(solid, at)
        signed.append(shapely.distance(solid, at) - inside)
    np.testing.assert_allclose(found, np.minimum(np.min(signed, 0), 1.5), atol=1e-5)
    assert (found == 1.5).any()
    assert (found < 0.0).any()


def test_blocks_are_reduced_and_incomplete_ones_left_out() -> None:
    cells = np.arange(35).reshape(5, 7)
    assert pooled(cells, 2, np.max).tolist() == [[8, 10, 12], [22, 24, 26]]
    assert pooled(cells, 3, np.min).tolist() == [[0, 3]]


@pytest.mark.parametrize("reduce", [np.all, np.any, np.max, np.min, np.mean])
def test_pooling_gives_the_digits_of_one_reduction_over_each_block(reduce) -> None:
    values = np.random.default_rng(0).normal(size=(23, 31)).astype(np.float32)
    cells = values > -1.2 if reduce in (np.all, np.any) else values
    for side in (1, 3, 4):
        x, y = 23 // side, 31 // side
        blocks = cells[: x * side, : y * side].reshape(x, side, y, side)
        np.testing.assert_array_equal(pooled(cells, side, reduce), reduce(blocks, axis=(1, 3)))


def test_closing_fills_narrow_gaps_alone() -> None:
    cells = np.zeros((40, 10), bool)
    cells[5:10], cells[14:20], cells[28:] = True, True, True
    found = closed(cells, 0.5, 0.2)
    assert found[10:14, 2:-2].all(), "a gap of 0.8 m"
    assert not found[20:28].any(), "a gap of 1.6 m"
    assert (found & cells == cells).all()
    assert not closed(np.zeros((3, 3), bool), 1.0, 0.1).any()


def test_a_box_from_above_begins_at_its_front_and_turns_about_its_centre() -> None:
    box = rectangle(4.0, 2.0, np.pi / 2, 10.0, 20.0)
    # It heads along +y: its right is +x.
    wanted = [(11, 22), (9, 22), (9, 18), (11, 18)]
    np.testing.assert_allclose(shapely.get_coordinates(box)[:4], wanted, atol=1e-12)
    trunk = rectangle(0.4, 0.4, np.pi / 2, 10.0, 20.0, ahead=-1.5)
    assert (trunk.centroid.x, trunk.centroid.y) == pytest.approx((10.0, 18.5))
