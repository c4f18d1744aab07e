"""Ground that nobody saw, where a street has it: before fronts, in holes; what was seen through slits is left out."""

import numpy as np
import pytest
import scipy.ndimage
import shapely

from urbanverse_mjx.datatypes import KIND_INDEX
from urbanverse_mjx.datatypes.ground import height_at
from urbanverse_mjx.distillation.ground import CELL, GroundMap
from urbanverse_mjx.distillation.ground_completion import completed
from urbanverse_mjx.distillation.ground_regions import regions
from urbanverse_mjx.geometry.polygons import MAX_OVERLAP
from urbanverse_mjx.scene.ground import check_regions, ground_prisms

ROAD, PAVEMENT = KIND_INDEX["road"], KIND_INDEX["sidewalk"]
#: 40 m of street along x: road from y = 0 to 6, pavement to y = 8.
STREET = (0.0, 0.0, 40.0, 8.0)


def grid(*known: tuple[int, float, tuple[float, float, float, float]]) -> GroundMap:
    """Boxes of a kind and height, the later over the earlier; kind 0 clears."""
    kind, height = np.zeros((200, 80), np.uint8), np.full((200, 80), np.nan)
    for k, z, (x0, y0, x1, y1) in known:
        where = np.s_[round((x0 + 5) / CELL) : round((x1 + 5) / CELL), round((y0 + 5) / CELL) : round((y1 + 5) / CELL)]
        kind[where], height[where] = k, z if k else np.nan
    return GroundMap(np.array([-5.0, -5.0]), kind, height, (kind > 0).astype(np.int64))


def street(*more: tuple[int, float, tuple[float, float, float, float]]) -> GroundMap:
    return grid((ROAD, 0.0, (0.0, 0.0, 40.0, 6.0)), (PAVEMENT, 0.12, (0.0, 6.0, 40.0, 8.0)), *more)


def kind_at(seen: GroundMap, x: float, y: float) -> int:
    return int(seen.at(np.array([[x, y]]))[0][0])


def test_the_strip_before_a_front_is_pavement_and_ends_below_the_house() -> None:
    done = completed(street(), [shapely.box(10.0, 11.0, 30.0, 20.0)])
    assert [kind_at(done, 20.0, y) for y in (8.1, 10.9, 11.3)] == [PAVEMENT] * 3
    assert kind_at(done, 20.0, 11.9) == 0
    assert kind_at(done, 5.0, 9.0) == 0
    assert done.at(np.array([[20.0, 10.0]]))[1][0] == pytest.approx(0.12)
    # It was not seen, so borders through it are free to be straight.
    i, j = np.floor((np.array([20.0, 10.0]) - done.origin) / CELL).astype(int)
    assert done.count[i, j] == 0


def test_a_front_farther_than_the_limit_stands_alone() -> None:
    done = completed(street(), [shapely.box(10.0, 13.5, 30.0, 20.0)])
    assert kind_at(done, 20.0, 9.0) == 0


def test_pavement_goes_on_before_a_front_where_a_car_hid_it() -> None:
    done = completed(street((0, 0.0, (18.0, 5.0, 22.0, 8.0))), [shapely.box(0.0, 8.5, 40.0, 20.0)])
    assert kind_at(done, 20.0, 7.5) == PAVEMENT


def test_pavement_goes_on_where_a_bus_hid_it_up_to_the_front() -> None:
    hidden = (0, 0.0, (17.0, 4.5, 23.0, 12.0))
    done = completed(street((PAVEMENT, 0.12, (0.0, 8.0, 40.0, 12.0)), hidden), [shapely.box(0.0, 12.3, 40.0, 20.0)])
    assert [kind_at(done, 20.0, y) for y in (5.0, 8.5, 10.5)] == [ROAD, PAVEMENT, PAVEMENT]


def test_the_road_goes_on_across_a_hole_as_wide_as_it_is() -> None:
    """Of the middle of the hole the pavements are nearer than the road."""
    seen = street((PAVEMENT, 0.12, (0.0, -2.0, 40.0, 0.0)), (0, 0.0, (14.0, 0.0, 23.0, 6.0)))
    made = [(r.kind, shapely.Polygon(r.polygon)) for r in regions(completed(seen, []))]
    (road,) = [p for kind, p in made if kind == "road"]
    assert road.symmetric_difference(shapely.box(0.0, 0.0, 40.0, 6.0)).area < 2.0
    assert sum(p.area for _, p in made) == pytest.approx(40.0 * 10.0, rel=0.005)


def test_nothing_goes_round_a_house() -> None:
    done = completed(street(), [shapely.box(10.0, 9.0, 30.0, 12.0)])
    assert kind_at(done, 20.0, 12.5) == 0
    assert kind_at(done, 9.0, 11.5) == 0


def test_holes_are_closed_but_not_a_house_that_stands_in_one() -> None:
    hole = (0, 0.0, (10.0, 1.0, 14.0, 5.0))
    assert kind_at(completed(street(hole), []), 12.0, 3.0) == ROAD
    assert kind_at(completed(street(hole), [shapely.box(10.2, 1.2, 13.8, 4.8)]), 12.0, 3.0) == 0
    large = grid((ROAD, 0.0, (0.0, 0.0, 40.0, 14.0)), (0, 0.0, (5.0, 1.0, 25.0, 13.0)))
    assert kind_at(completed(large, []), 15.0, 7.0) == 0


def test_a_stub_is_cut_off_and_a_path_is_not() -> None:
    done = completed(street((PAVEMENT, 0.12, (20.0, 8.0, 20.5, 12.0)), (PAVEMENT, 0.12, (30.0, 8.0, 31.5, 12.0))), [])
    assert kind_at(done, 20.2, 11.0) == 0
    assert kind_at(done, 30.7, 11.0) == PAVEMENT


@pytest.mark.extended
def test_regions_share_their_corners_and_make_few_prisms() -> None:
    rng = np.random.default_rng(0)
    kind, height = np.zeros((480, 120), np.uint8), np.full((480, 120), np.nan)
    x, y = ((np.indices(kind.shape) + 0.5) * CELL).reshape(2, *kind.shape)
    left = y - 15.0 - 0.05 * x + 0.2 * scipy.ndimage.gaussian_filter(rng.normal(size=kind.shape), 1.0)
    kind[abs(left) < 7.0] = PAVEMENT
    kind[abs(left) < 4.0] = ROAD
    # A hump that one plane does not fit: the road is cut, its neighbours are not.
    height[kind > 0] = np.where(kind == PAVEMENT, 0.12, 0.5 * np.cos(x / 12.0))[kind > 0]
    made = regions(GroundMap(np.zeros(2), kind, height, np.ones(kind.shape, np.int64)))
    check_regions(made)
    polygons = [shapely.Polygon(r.polygon) for r in made]
    assert sum(r.kind == "road" for r in made) > 2
    for i, a in enumerate(polygons):
        assert all(a.intersection(b).area < MAX_OVERLAP / 100 for b in polygons[i + 1 :])
    assert shapely.coverage_is_valid(polygons)
    assert shapely.union_all(polygons).area == pytest.approx(14.0 * 120.0, rel=0.01)
    assert len(ground_prisms(made)) < 50


def test_a_road_that_all_but_reaches_a_wall_reaches_it() -> None:
    """A side street has no pavement of one cell along its walls."""
    done = completed(street(), [shapely.box(10.0, -9.0, 30.0, -0.6)])
    assert kind_at(done, 20.0, -0.3) == ROAD
    done = completed(street((PAVEMENT, 0.12, (0.0, 0.0, 8.0, 2.0))), [shapely.box(10.0, -9.0, 14.0, -1.6)])
    assert kind_at(done, 12.0, -1.0) == PAVEMENT


@pytest.mark.parametrize(("dropped", "slope"), [(True, 0.0), (True, 0.0263), (False, 0.0263)])
def test_a_kerb_is_dropped_where_its_heights_are(dropped: bool, slope: float) -> None:
    """A crossing of 4 m at x = 18 to 22; the pavement behind it rises over 1.5 m from the road, or stands over it."""
    seen = street()
    x, y = (np.indices(seen.kind.shape) + 0.5) * CELL + seen.origin[:, None, None]
    along, left = x + slope * y - 20.0, y - slope * x
    seen.kind[:] = np.select([(left < 0.0) | (left > 8.0) | (x < 0.0) | (x > 40.0), left > 6.0], [0, PAVEMENT], ROAD)
    seen.kind[(seen.kind == ROAD) & (abs(along) < 2.0)] = KIND_INDEX["crosswalk"]
    seen.height[:] = np.where(seen.kind == PAVEMENT, 0.12, 0.0)
    ramp = (abs(along) < 1.5) & (left > 6.0) & (left < 7.5)
    if dropped:
        seen.height[ramp] = 0.08 * (left[ramp] - 6.0)
    made = regions(seen)
    check_regions(made)
    assert sum(shapely.Polygon(r.polygon).area for r in made) == pytest.approx(40.0 * 8.0, rel=0.005)
    walked = [(r, shapely.Polygon(r.polygon)) for r in made if r.kind == "sidewalk"]
    up = slope * 20.0
    ((under, _),) = [w for w in walked if w[1].contains(shapely.Point(19.8, 6.1 + up))]
    ((beside, _),) = [w for w in walked if w[1].contains(shapely.Point(16.0, 6.1 + up))]
    assert height_at(under.plane, 19.8, 6.0 + up) == pytest.approx(0.0 if dropped else 0.12, abs=0.015)
    assert height_at(under.plane, 19.8, 7.4 + up) == pytest.approx(0.112 if dropped else 0.12, abs=0.015)
    assert height_at(beside.plane, 16.0, 6.1 + up) == pytest.approx(0.12, abs=0.01)
    if dropped:
        assert shapely.Polygon(under.polygon).area == pytest.approx(3.0 * 1.45, rel=0.15)


@pytest.mark.parametrize("seed", range(4))
def test_regions_lose_nothing_of_what_is_known(seed: int) -> None:
    rng = np.random.default_rng(seed)
    fields = [scipy.ndimage.gaussian_filter(rng.normal(size=(120, 120)), 8.0) for _ in range(3)]
    kind = np.array([ROAD, PAVEMENT, KIND_INDEX["crosswalk"]], np.uint8)[np.argmax(fields, 0)]
    height = scipy.ndimage.gaussian_filter(rng.normal(size=kind.shape), 10.0) * 5.0 + 0.15 * (kind == PAVEMENT)
    made = regions(GroundMap(np.zeros(2), kind, height, np.ones(kind.shape, np.int64)))
    check_regions(made)
    assert sum(shapely.Polygon(r.polygon).area for r in made) == pytest.approx(30.0**2, rel=0.01)
    # Humps are cut, and neighbours of cut pieces have the corners of the cuts.
    assert shapely.coverage_is_valid([shapely.Polygon(r.polygon) for r in made])
