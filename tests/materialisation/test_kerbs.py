"""Kerbs are added only where a graph has none; supports of objects."""

import math

import pytest
import shapely

from urbanverse_mjx.datatypes import GraphObject, GroundRegion, SceneGraph, Source
from urbanverse_mjx.materialisation import kerbs, overlap, standing

SOURCE = Source("hand", "Apache-2.0", "none", "none")


def region(name: str, kind: str, y0: float, y1: float, plane=(0.0, 0.0, 0.0), x0: float = 0.0, x1: float = 20.0):
    return GroundRegion(name, kind, ((x0, y0), (x1, y0), (x1, y1), (x0, y1)), plane)


def graph(*regions: GroundRegion, objects=()) -> SceneGraph:
    return SceneGraph("g", SOURCE, tuple(objects), regions)


ROAD = region("road", "road", -4, 4)


def post(y: float, foot: float, height: float = 1.0) -> GraphObject:
    return GraphObject("post", "bollard", (5.0, y, foot + height / 2), (0.2, 0.2, height), 0.0)


def test_flush_sidewalks_rise_with_all_that_stands_on_them():
    flat = graph(ROAD, region("walk", "sidewalk", 4, 8, (0.0, 0.0, 0.02)), objects=[post(6.0, 0.02)])
    done, raised = kerbs.raise_sidewalks(flat)
    assert raised == ("walk",)
    assert done.ground[0] == ROAD
    assert done.ground[1].plane == pytest.approx((0.0, 0.0, kerbs.KERB))
    assert done.objects[0].center[2] - 0.5 == pytest.approx(kerbs.KERB)


def test_a_tilted_street_keeps_its_slope():
    slope = (0.03, 0.0, 0.0)
    done, _ = kerbs.raise_sidewalks(
        graph(region("road", "road", -4, 4, slope), region("walk", "sidewalk", 4, 8, slope))
    )
    assert done.ground[1].plane == pytest.approx((0.03, 0.0, 0.15))


def test_the_median_step_along_a_border_becomes_a_kerb():
    """Steps of 0.1 to 3.9 cm along 20 m, at every metre: the sidewalk rises by 15 cm less 2 cm."""
    done, raised = kerbs.raise_sidewalks(graph(ROAD, region("walk", "sidewalk", 4, 8, (0.002, 0.0, 0.0))))
    assert raised == ("walk",)
    assert done.ground[1].plane == pytest.approx((0.002, 0.0, kerbs.KERB - 0.02), abs=2e-3)


@pytest.mark.parametrize("step", [0.06, 0.12, 0.21])
def test_a_kerb_that_was_seen_stays_with_its_dropped_ends(step):
    walk = region("walk", "sidewalk", 4, 8, (0.0, 0.0, step), x1=15.0)
    ramp = region("ramp", "sidewalk", 4, 8, (0.0, step / 4, -step), x0=15.0)
    given = graph(ROAD, walk, ramp)
    assert kerbs.raise_sidewalks(given) == (given, ())


def test_pieces_are_judged_each_for_itself():
    left, right = region("left", "sidewalk", 4, 8, (0, 0, 0.15)), region("right", "sidewalk", -8, -4)
    assert kerbs.raise_sidewalks(graph(ROAD, left, right))[1] == ("right",)


def test_without_a_road_nothing_rises():
    given = graph(region("walk", "sidewalk", 4, 8))
    assert kerbs.raise_sidewalks(given) == (given, ())


SUPPORT = overlap.Support([(shapely.box(0, 0, 20, 20), "sidewalk", (0.0, 0.0, 0.15))])


def box(label: str, foot: float, height: float, x: float = 5.0) -> GraphObject:
    return GraphObject("it", label, (x, 5.0, foot + height / 2), (0.5, 0.5, height), 0.0)


def test_feet_near_the_ground_are_put_onto_it():
    assert standing.place_on_support(box("bollard", 0.35, 0.9), "bollard", SUPPORT) == standing.Placement(0.15, 0.9)
    assert standing.place_on_support(box("bollard", -1.0, 0.9), "bollard", SUPPORT).z == pytest.approx(0.15)


def test_a_hidden_lower_part_is_filled_in_and_what_hangs_stays():
    """A tree seen over a hedge reaches down; a sconce on a wall does not; a person never flies."""
    tree = standing.place_on_support(box("tree", 1.65, 4.0), "tree", SUPPORT)
    assert tree.z == pytest.approx(0.15)
    assert tree.height == pytest.approx(5.5)
    assert standing.place_on_support(box("sconce", 2.4, 0.4), "sconce", SUPPORT).z == pytest.approx(2.4)
    assert standing.place_on_support(box("pedestrian adult", 3.0, 1.7), "pedestrian adult", SUPPORT).z == pytest.approx(
        0.15
    )


def test_a_pot_stands_on_a_table():
    table = standing.Top("table", shapely.box(4, 4, 6, 6), 0.9)
    assert standing.place_on_support(box("plant pot", 0.85, 0.3), "plant pot", SUPPORT, [table]).on == "table"
    beside = standing.place_on_support(box("plant pot", 0.85, 0.3, x=9.0), "plant pot", SUPPORT, [table])
    assert beside.on is None


def test_house_fronts_behind_the_pavement_take_its_height():
    house = box("house", 0.2, 8.0, x=24.0)
    assert standing.place_on_support(house, "house", SUPPORT).z == pytest.approx(0.15)
    far = box("house", 0.2, 8.0, x=24.0 + 2 * standing.GROUND_DISTANCE)
    assert standing.place_on_support(far, "house", SUPPORT).z == pytest.approx(0.2)
    assert math.isfinite(far.center[0])
