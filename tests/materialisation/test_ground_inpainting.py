"""Ground hidden by objects is filled; objects in a kerb are moved off it."""

import math

import numpy as np
import pytest
import shapely
from shapely.geometry.base import BaseGeometry

from urbanverse_mjx.assets import load_index
from urbanverse_mjx.datatypes import GraphObject, GroundRegion, HullSet, PlacedObject, SceneGraph, Source
from urbanverse_mjx.materialisation import ground_inpainting, overlap
from urbanverse_mjx.scene.ground import check_regions

SOURCE = Source("walk.mp4", "Apache-2.0", "none", "none")
LEAVES = {"car": "sedan", "house": "apartment building", "lamp": "street light"}
#: A road of 20 x 6 m in two halves, around a hole of 4 x 2 m in its middle.
HALVES = (
    GroundRegion(
        "low", "road", ((-10, -3), (10, -3), (10, 0), (2, 0), (2, -1), (-2, -1), (-2, 0), (-10, 0)), (0, 0, 0)
    ),
    GroundRegion("high", "road", ((-10, 0), (-2, 0), (-2, 1), (2, 1), (2, 0), (10, 0), (10, 3), (-10, 3)), (0, 0, 0)),
)


def box(name: str, label: str, x: float, y: float, size=(4.0, 1.8, 1.4), foot: float = 0.0) -> GraphObject:
    return GraphObject(name, label, (x, y, foot + size[2] / 2), size, 0.0)


def filled(*objects: GraphObject, ground=HALVES) -> SceneGraph:
    return ground_inpainting.fill(SceneGraph("street", SOURCE, objects, ground), LEAVES)


def outline(graph: SceneGraph) -> BaseGeometry:
    return shapely.union_all([shapely.Polygon(r.polygon) for r in graph.ground])


def test_a_hole_in_a_road_is_closed_and_nothing_else():
    done = filled()
    check_regions(done.ground)
    assert [r.id for r in done.ground] == ["low", "high"]
    assert outline(done).symmetric_difference(shapely.box(-10, -3, 10, 3)).area < 1e-6


def test_a_courtyard_keeps_its_house():
    graph = filled(box("h", "house", 0, 0, (3.5, 1.8, 9.0)))
    assert graph.ground == HALVES


def test_ground_grows_under_what_stands_half_beside_it():
    car = box("c", "car", 11.0, 1.5)
    done = filled(car)
    check_regions(done.ground)
    grown = shapely.box(9.0, 0.6, 13.0, 2.4).buffer(ground_inpainting.MARGIN, join_style="mitre")
    assert outline(done).symmetric_difference(shapely.box(-10, -3, 10, 3).union(grown)).area < 1e-6


def test_what_grows_stays_off_long_neighbours_whose_corners_lie_between_millimetres():
    """Drawn streets have such corners; half a millimetre along 60 m is more than two regions may share."""
    a, b = (-30.0004, 0.0004), (30.0004, 7.3004)
    strips = [
        GroundRegion(
            name, "road", ((a[0], a[1] + y), (b[0], b[1] + y), (b[0], b[1] + y + 4), (a[0], a[1] + y + 4)), (0, 0, 0)
        )
        for name, y in (("low", -4.0), ("high", 0.0))
    ]
    for car in (box("c", "car", 31.0, 5.3), box("c", "car", 31.0, 9.3)):
        done = filled(car, ground=tuple(strips))
        check_regions(done.ground)
        assert outline(done).area > outline(filled(ground=tuple(strips))).area + 1.0


#: A pavement of Istanbul and the two regions beside its corner, which differ from it by less than a micrometre there.
CORNER = {
    "own": (
        (0.2224588755632136, 5.095145930067474),
        (19.434156176582338, 4.256345111032063),
        (19.565014338678345, 7.253489775777636),
        (0.3533170376592216, 8.092290594813047),
    ),
    "beside": (
        (0.1134104071498736, 2.5975253761128303),
        (17.726630553638028, 1.8285155768619568),
        (17.835679022051366, 4.3261361308166),
        (0.2224588755632136, 5.095145930067474),
    ),
    "road": (
        (-7.595285096714641, -13.481529746272287),
        (-0.6019475456416369, -13.786865457829638),
        (0.6150333618512376, 14.086579924304194),
        (-6.378304189221767, 14.391915635861546),
    ),
}


def test_what_grows_has_no_corners_that_coincide():
    """The difference of regions that share a corner in floating point leaves corners nanometres apart."""
    regions = tuple(GroundRegion(k, "road" if k == "road" else "sidewalk", c, (0, 0, 0)) for k, c in CORNER.items())
    before = outline(filled(ground=regions)).area
    done = filled(box("c", "car", 18.2, 7.3), ground=regions)
    check_regions(done.ground)
    assert outline(done).area > before + 1.0


@pytest.mark.parametrize("obj", [box("c", "car", 11.0, 1.5, foot=3.0), box("h", "house", 13.0, 0.0, (5, 5, 9))])
def test_nothing_grows_under_what_flies_or_is_a_house(obj):
    assert outline(filled(obj)).equals_exact(outline(filled()), 1e-9)


def body(y: float, foot: float, wide: float = 0.6) -> overlap.Body:
    """A block of 2.4 x `wide` x 0.8 m that stands at x = 0."""
    corners = [(x, s * wide / 2, z) for x in (-1.2, 1.2) for s in (-1, 1) for z in (0.0, 0.8)]
    record = load_index().by_leaf("jersey barrier")[0]
    placed = PlacedObject(
        "b", "jersey barrier", "jersey barrier", record.uid, (0.0, y, foot), 0.0, (1.0, 1.0, 1.0), 900.0, 0.7, False
    )
    return overlap.Body(placed, record, overlap.prisms_of(placed, HullSet((np.array(corners, np.float32),))))


SUPPORT = overlap.Support(
    [
        (shapely.box(-30, -8, 30, 0), "road", (0.0, 0.0, 0.0)),
        (shapely.box(-30, 0, 30, 8), "sidewalk", (0.0, 0.0, 0.15)),
    ]
)


@pytest.mark.parametrize("y", [-0.2, 0.05])
def test_what_stands_in_a_kerb_leaves_it_by_the_least_move(y):
    block = body(y, 0.0)
    assert overlap.resolve([block], SUPPORT, kerbs=True) == []
    dx, dy = block.offset
    assert dx == pytest.approx(0.0, abs=1e-9)
    assert y + dy <= -0.3 + 1e-6
    assert y + dy > -0.3 - overlap.STEP - 1e-6


def test_who_cannot_leave_a_kerb_stays_where_it_is():
    block = body(0.0, 0.0, wide=2.2)
    assert overlap.resolve([block], SUPPORT, kerbs=True) == []
    assert block.offset == (0.0, 0.0)


@pytest.mark.parametrize(("y", "lift"), [(-0.4, 0.0), (0.4, 0.15)])
def test_who_cannot_leave_stands_on_what_its_middle_is_over(y, lift):
    block = body(y, 0.0, wide=2.2)
    overlap.resolve([block], SUPPORT, kerbs=True)
    assert overlap.moved(block, SUPPORT.step_up(block)).position == pytest.approx((0.0, y, lift))


def test_what_stands_on_the_pavement_may_reach_over_its_edge():
    block = body(0.1, 0.15)
    assert not SUPPORT.in_kerb(block, block.offset)
    assert math.isclose(block.distance, 0.0)
