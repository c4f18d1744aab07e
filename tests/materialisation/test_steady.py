"""Loose objects of sets with `standing`: they stand or lie, and none is inside another."""

import dataclasses
import functools
import math

import numpy as np
import pyarrow as pa
import pytest

from urbanverse_mjx.assets import load_hulls, load_index
from urbanverse_mjx.assets.collision.lying import is_lying
from urbanverse_mjx.assets.records.catalogue import build_leaf
from urbanverse_mjx.assets.selection.search import ObjectLibrary
from urbanverse_mjx.citygen import craftbench
from urbanverse_mjx.datatypes import SceneGraph
from urbanverse_mjx.materialisation import Cousin, index_of, materialise_cousins, overlap
from urbanverse_mjx.scene.compiler import scene_geometry
from urbanverse_mjx.scene.stability_trial import StabilityTrial, let_go

from .test_cousins import obj, street

#: Label -> m (along, across, up), and how many records: as in CraftBench, where one of each fell.
KINDS = {
    "shovel": ((0.2, 0.24, 1.3), 20),
    "umbrella": ((0.9, 0.9, 0.85), 20),
    "kite": ((0.1, 1.0, 1.1), 13),
    "unicycle": ((0.6, 0.3, 0.95), 20),
    "football": ((0.22, 0.22, 0.22), 20),
    "backpack": ((0.2, 0.31, 0.5), 20),
    "luggage": ((0.3, 0.6, 0.4), 21),
    "lawn mower": ((1.3, 0.5, 1.1), 8),
}


@functools.cache
def few(*leaves: str) -> ObjectLibrary:
    counts = {leaf: KINDS[leaf][1] if leaf in KINDS else 3 for leaf in leaves}
    return ObjectLibrary(pa.concat_tables([build_leaf(leaf, load_index(), n) for leaf, n in counts.items()]))


def made(graph: SceneGraph, objects: ObjectLibrary, standing: bool, count: int = 1) -> list[Cousin]:
    return materialise_cousins(graph, count, objects=objects, standing=standing)


def released(cousin: Cousin, objects: ObjectLibrary) -> StabilityTrial:
    return let_go(scene_geometry(cousin.layout, index_of(cousin.layout, objects)))


@pytest.fixture(scope="module")
def street_of_kinds() -> SceneGraph:
    placed = [obj(label, label, 4.0 * k - 14, 4.0, size=size) for k, (label, (size, _)) in enumerate(KINDS.items())]
    return street(*placed)


@pytest.fixture(scope="module")
def steady(street_of_kinds: SceneGraph) -> list[Cousin]:
    return made(street_of_kinds, few(*KINDS), True, 2)


@pytest.mark.extended
def test_what_falls_is_replaced_or_lies(street_of_kinds: SceneGraph, steady: list[Cousin]) -> None:
    before = [m.id for m in released(made(street_of_kinds, few(*KINDS), False)[0], few(*KINDS)).moved]
    assert {"shovel", "umbrella", "unicycle"} <= set(before)
    for cousin in steady:
        trial = released(cousin, few(*KINDS))
        assert trial.standing == len(KINDS)
        assert trial.moved == ()
        lie = {p.id for p in cousin.layout.objects if is_lying(p.asset_uid)}
        assert {"shovel", "umbrella", "unicycle", "football"} <= lie
        assert not lie & {"backpack", "luggage", "lawn mower"}, "others of their kind stand"


def test_a_cousin_is_the_same_alone_and_among_others(street_of_kinds: SceneGraph, steady: list[Cousin]) -> None:
    assert made(street_of_kinds, few(*KINDS), True)[0].layout == steady[0].layout


def test_what_stands_already_stays_the_same() -> None:
    graph, objects = street(obj("bench", "bench", 0, 5), obj("car", "sedan", 5, -4, 0.0)), few("bench", "sedan")
    plain, steady = (made(graph, objects, on)[0] for on in (False, True))
    assert plain.layout == steady.layout


def test_what_hangs_is_not_laid_down() -> None:
    """An umbrella two metres above the ground hangs from something that the graph does not show."""
    graph, objects = street(obj("umbrella", "umbrella", 0, 5, 2.2, size=KINDS["umbrella"][0])), few("umbrella")
    assert not is_lying(made(graph, objects, True)[0].layout.objects[0].asset_uid)


def barriers(in_city: bool) -> SceneGraph:
    graph = craftbench.build("10_cbd_cross_intersection_diverse_obstacles", in_city)
    row = tuple(o for o in graph.objects if o.label == "jersey barrier")
    return dataclasses.replace(graph, objects=row)


@pytest.mark.extended
def test_the_row_of_barriers_in_version_2_is_as_long_as_its_place() -> None:
    objects = ObjectLibrary(build_leaf("jersey barrier", load_index()))
    old, new = (made(barriers(on), objects, on)[0] for on in (False, True))
    assert old.unresolved
    assert len(new.layout.objects) == 10
    assert new.unresolved == new.left_out == new.moved == ()
    index = index_of(new.layout, objects)
    bodies = [
        overlap.Body(p, index.get(p.asset_uid), overlap.prisms_of(p, load_hulls(index.get(p.asset_uid))))
        for p in new.layout.objects
    ]
    assert overlap.penetrating_pairs(bodies) == []
    assert not released(new, objects).moved
    assert released(old, objects).moved


def test_a_lying_asset_has_its_own_box_and_mass(steady: list[Cousin]) -> None:
    layout = steady[0].layout
    index = index_of(layout, few(*KINDS))
    shovel = next(p for p in layout.objects if p.id == "shovel")
    record = index.get(shovel.asset_uid)
    assert shovel.scale == (1.0, 1.0, 1.0)
    assert shovel.mass == pytest.approx(record.mass, abs=1e-3)
    assert shovel.position[2] == pytest.approx(0.15)
    assert record.height < 0.2
    low = min(float(h[:, 2].min()) for h in load_hulls(record).hulls)
    assert math.isclose(low, 0.0, abs_tol=2e-4)
    assert np.ptp(np.concatenate(load_hulls(record).hulls), axis=0).max() > 1.0
