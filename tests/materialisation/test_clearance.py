"""The camera's path is free of solid objects; crowns above and kerbs below it do not count."""

import dataclasses

import numpy as np
import pytest
import shapely

from urbanverse_mjx.assets import load_index
from urbanverse_mjx.datatypes import GraphObject, HullSet, PlacedObject
from urbanverse_mjx.materialisation import clearance, materialise_cousins, overlap

from .catalogue_part import few_objects
from .test_cousins import obj, street

RECORD = load_index().by_label("bench")[0]


def body(x: float, y: float, low: float, high: float, side: float = 1.0, ground: float = 0.15) -> overlap.Body:
    """A block with a square of `side` m seen from above, from `low` to `high` m over the ground it stands on."""
    corners = np.array([[a, b, c] for a in (-0.5, 0.5) for b in (-0.5, 0.5) for c in (0.0, 1.0)])
    hull = corners * [side, side, high - low] + [0, 0, low]
    placed = PlacedObject(
        "a", "bench", "bench", RECORD.uid, (x, y, ground), 0.3, (1.0, 1.0, 1.0), mass=1.0, friction=0.5, movable=False
    )
    return overlap.Body(placed, RECORD, overlap.prisms_of(placed, HullSet((hull.astype(np.float32),))))


STRIP = clearance.walked(np.array([[0.0, 0, 1.5, 0], [4, 0, 1.5, 0], [8, 0, 1.5, 0], [40, 0, 1.5, 0], [44, 0, 1.5, 0]]))


@pytest.mark.parametrize(
    ("block", "obstructs"),
    [
        (body(5, 0, 0, 1), True),
        (body(5, 1.2, 0, 1), False),  # half its diagonal and the strip reach 1.16 m
        (body(5, 1.0, 0, 1), True),
        (body(5, 0, 2.2, 5), False),  # a crown
        (body(5, 0, 0, 0.2), False),  # a manhole's rim
        (body(25, 0, 0, 1), False),  # the trajectory jumped: the path in between is unknown
        (body(42, 0, 0, 1), True),
    ],
)
def test_what_blocks_the_way(block: overlap.Body, obstructs: bool) -> None:
    assert (clearance.obstructing([block], STRIP) == [0]) is obstructs


def test_a_moved_object_counts_where_it_is_and_no_tour_blocks_nothing() -> None:
    block = body(5, 0, 0, 1)
    assert clearance.obstructing([dataclasses.replace(block, offset=(0.0, 2.0))], STRIP) == []
    assert clearance.obstructing([block], clearance.walked(np.zeros((0, 4)))) == []
    assert clearance.walked(np.array([[1.0, 1, 0, 0]])).contains(shapely.Point(1.2, 1.2))


def test_cousins_leave_out_what_the_camera_went_through() -> None:
    graph = street(
        obj("here", "bench", 0, 5),
        obj("beside", "bench", 0, 7.3),
        camera_path=((-9.0, 5.0, 1.6, 0.0), (-5.0, 5.0, 1.6, 0.0), (-1.0, 5.0, 1.6, 0.0), (3.0, 5.0, 1.6, 0.0)),
    )
    filmed = dataclasses.replace(graph, source=dataclasses.replace(graph.source, video="walk.mp4"))
    (cousin,) = materialise_cousins(filmed, 1, objects=few_objects())
    assert [p.id for p in cousin.layout.objects] == ["beside"]
    assert [(gone.id, "camera went through" in gone.reason) for gone in cousin.left_out] == [("here", True)]
    (cousin,) = materialise_cousins(graph, 1, objects=few_objects())
    assert [p.id for p in cousin.layout.objects] == ["here", "beside"]


def test_a_building_is_cut_back_from_the_way_on_its_cheapest_side() -> None:
    """A house of 10 x 8 m, its front (+y) 0.5 m beyond the strip's near edge: that half metre goes, the back stays."""
    strip = clearance.walked(np.array([[float(x), 0.0, 1.5, 0.0] for x in range(-12, 13, 3)]))
    house = GraphObject("h", "house", (0.0, -4.0 - 0.45 + 0.5, 4.0), (10.0, 8.0, 8.0), 0.0)
    cut = clearance.cut_back(house, strip)
    np.testing.assert_allclose(cut.size, (10.0, 7.5, 8.0), atol=1e-6)
    np.testing.assert_allclose(cut.center, (0.0, -0.45 - 3.75, 4.0), atol=1e-6)
    turned = dataclasses.replace(house, size=(8.0, 10.0, 8.0), yaw=np.pi / 2)
    again = clearance.cut_back(turned, strip)
    np.testing.assert_allclose(again.center, cut.center, atol=1e-6)
    np.testing.assert_allclose(again.size, (7.5, 10.0, 8.0), atol=1e-6)
    astride = dataclasses.replace(house, center=(0.0, 0.0, 4.0))
    assert clearance.cut_back(astride, strip) == astride
    away = dataclasses.replace(house, center=(0.0, -10.0, 4.0))
    assert clearance.cut_back(away, strip) == away
