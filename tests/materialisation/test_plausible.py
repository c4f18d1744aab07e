"""Graphs that cannot be of a street are refused by name, and those of streets are not."""

import dataclasses
import pathlib

import pytest

from urbanverse_mjx.datatypes import GroundRegion, SceneGraph, ValidationError
from urbanverse_mjx.materialisation import check_placed, check_plausible, materialise_cousins
from urbanverse_mjx.scene.ground import check_drivable

from .catalogue_part import few_objects
from .test_cousins import ROAD, WALK, obj, street

SCENES = pathlib.Path(__file__).parents[2] / "scenes"
GRAPHS = [
    *(SCENES / name / "graph.json" for name in ("residential_bins", "park_edge")),
    *sorted((SCENES / "urbanverse160").glob("*/graph.json*"))[:3],
]


@pytest.mark.parametrize("path", GRAPHS, ids=lambda path: path.parent.name)
def test_shipped_graphs_are_plausible_and_drivable(path: pathlib.Path) -> None:
    graph = SceneGraph.load(path)
    check_plausible(graph)
    check_drivable(graph.ground, 0.4, 10.0)


@pytest.mark.parametrize(
    ("impossible", "words"),
    [
        (
            obj("car_7", "sedan", 0, -4, 0.0, size=(2000.0, 800.0, 600.0)),
            "'car_7' (sedan): found a size of 2,000 x 800",
        ),
        (obj("car_7", "sedan", 0, -4, 0.0, size=(4.6, 1.8, 40.0)), "found a size of 4.6 x 1.8 x 40 m"),
        (obj("bench_2", "bench", 90_000, 5), "found a place 90 km from all ground"),
        (obj("bench_2", "bench", 0, 260), "found a place 252 m from all ground"),
    ],
)
def test_an_impossible_object_is_named(impossible, words: str) -> None:
    with pytest.raises(ValidationError) as caught:
        check_plausible(street(obj("first", "bench", 0, 5), impossible))
    assert words in str(caught.value)


def test_large_and_unknown_objects_of_real_streets_pass() -> None:
    check_plausible(
        street(
            obj("row", "apartment building", 0, 14, size=(12.0, 60.0, 25.0)),
            obj("hedge", "fence", 0, 7, size=(0.1, 120.0, 1.2)),
            obj("odd", "zqxv", 0, 5, size=(900.0, 1.0, 1.0)),  # left out anyway
            obj("beyond", "tree", 0, 100, size=(6.0, 6.0, 14.0)),
        )
    )


def test_ground_of_another_unit_is_refused_before_its_map_is_made() -> None:
    wide = dataclasses.replace(ROAD, polygon=((-30_000, -8), (30_000, -8), (30_000, 0), (-30_000, 0)))
    with pytest.raises(ValidationError, match="ground: found an extent of 60 km, needed at most 1 km"):
        check_plausible(street(ground=(wide,)))


def test_a_graph_of_which_nothing_is_placed_is_refused_with_the_reason() -> None:
    graph = street(obj("a", "zqxv", 0, 5), obj("b", "zqxv", 2, 5), obj("c", "sidewalk", 4, 5))
    made = materialise_cousins(graph, 1, objects=few_objects())
    with pytest.raises(ValidationError, match=r"'little': found no place for any of 3 objects \(2 because no leaf"):
        check_placed(graph, made)
    for good in (street(), street(obj("a", "zqxv", 0, 5), obj("b", "bench", 2, 5))):
        check_placed(good, materialise_cousins(good, 1, objects=few_objects()))


def strip(name: str, kind: str, x: float, length: float, width: float) -> GroundRegion:
    return GroundRegion(name, kind, ((x, 0), (x + length, 0), (x + length, width), (x, width)), (0.0, 0.0, 0.0))


@pytest.mark.parametrize(
    ("ground", "enough"),
    [
        ((ROAD, WALK), True),
        ((ROAD,), False),
        ((strip("walk", "sidewalk", 0, 20, 0.7),), False),  # the robot needs 0.8 m
        ((strip("walk", "sidewalk", 0, 20, 0.9),), True),
        ((strip("walk", "sidewalk", 0, 4.5, 2),), False),  # 3.7 m for the robot's middle
        ((strip("walk", "sidewalk", 0, 3, 2), strip("over", "crosswalk", 3, 3, 2)), True),  # both are one way
        ((strip("walk", "sidewalk", 0, 3, 2), strip("other", "sidewalk", 8, 3, 2)), False),
    ],
)
def test_ground_on_which_no_route_fits_is_refused(ground: tuple[GroundRegion, ...], enough: bool) -> None:
    if enough:
        check_drivable(ground, 0.4, 4.0)
    else:
        with pytest.raises(ValidationError, match=r"needed a connected area with 4 m for a robot 0\.8 m wide"):
            check_drivable(ground, 0.4, 4.0)
