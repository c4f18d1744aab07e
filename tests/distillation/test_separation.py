"""Buildings of a graph stand beside each other, and nothing stands inside them."""

import itertools
import math
import pathlib

import numpy as np
import pytest
import shapely
from shapely import affinity

from urbanverse_mjx.datatypes import GraphObject, SceneGraph
from urbanverse_mjx.distillation.separation import penetration, separate

HOUSES = ("house", "library", "office building")
PATH = np.array([[float(x), 0.0] for x in range(-30, 31, 5)])


def house(
    name: str,
    x: float,
    y: float,
    size: tuple[float, ...] = (10.0, 8.0, 9.0),
    yaw: float = math.pi / 2,
    label: str = "house",
    score: float = 1.0,
) -> GraphObject:
    """A building; the heading, its first axis, points along +y by default."""
    along, across, up = size
    return GraphObject(name, label, (x, y, up / 2), (along, across, up), yaw, score)


def tree(name: str, x: float, y: float, z: float = 0.0) -> GraphObject:
    return GraphObject(name, "tree", (x, y, z + 3.0), (4.0, 4.0, 6.0), 0.0)


def outline(obj: GraphObject) -> shapely.Polygon:
    """The footprint, without the code under test."""
    flat = shapely.box(-obj.size[0] / 2, -obj.size[1] / 2, obj.size[0] / 2, obj.size[1] / 2)
    return affinity.translate(affinity.rotate(flat, obj.yaw, origin=(0, 0), use_radians=True), *obj.center[:2])


def run(*objects: GraphObject, path: np.ndarray = PATH, evidence: dict[str, float] | None = None):
    return separate(objects, HOUSES.__contains__, {"sign": True}.__contains__, path, evidence)


def test_penetration_is_the_shortest_way_apart() -> None:
    a = house("a", 0, 10)
    assert penetration(a, house("b", 7.5, 10)) == pytest.approx(0.5)
    assert penetration(a, house("b", 8.0, 10)) == pytest.approx(0.0, abs=1e-9)
    assert penetration(a, house("b", 7.5, 12.0)) == pytest.approx(0.5)
    assert penetration(a, house("b", 4 + 4 * math.sqrt(2) - 0.25, 10, (8.0, 8.0, 9.0), math.pi / 4)) == pytest.approx(
        0.25
    )
    high = GraphObject("b", "house", (0, 10, 20), (10, 8, 9), 0.0)
    assert penetration(a, high) == 0.0


def test_neighbours_are_cut_at_their_common_wall_and_keep_their_fronts() -> None:
    done = run(house("a", 0, 10), house("b", 7.4, 10))
    a, b = done.objects
    assert done.removed == ()
    assert sum(length for _, length in done.cut) == pytest.approx(0.6)
    assert outline(a).union(outline(b)).bounds == pytest.approx((-4.0, 5.0, 11.4, 15.0), abs=1e-3)
    assert outline(a).intersection(outline(b)).area < 1e-6


def test_the_back_of_a_building_is_cut_rather_than_the_front_of_another() -> None:
    """One behind the other: 2 m of the near one's completed depth and of the far one's front share the ground."""
    near, far = house("near", 0, 10), house("far", 0, 18)
    done = run(near, far)
    assert [name for name, _ in done.cut] == ["near"]
    assert outline(done.objects[0]).bounds == pytest.approx((-4, 5, 4, 13), abs=1e-3)
    assert done.objects[1] == far


def test_a_wrong_building_over_several_others_goes() -> None:
    """A library of 24 x 35 m seen six times over four houses seen often."""
    row = [house(f"house_{k}", 8.1 * k - 12, 10) for k in range(4)]
    wrong = house("library_0", 0, 14, (24.0, 35.0, 12.0), label="library")
    often = {obj.id: 40.0 for obj in row} | {"library_0": 6.0}
    done = run(*row, wrong, evidence=often)
    assert done.objects == tuple(row)
    assert [(gone.id, "shares its ground with 'house_" in gone.reason) for gone in done.removed] == [
        ("library_0", True)
    ]
    # The same evidence for all: what covers several others is wrong.
    assert run(*row, wrong).objects == tuple(row)


@pytest.mark.parametrize("seed", range(6))
def test_any_buildings_are_apart_afterwards_and_none_grows(seed: int) -> None:
    rng = np.random.default_rng(seed)
    crowd = [
        house(
            f"h{k}",
            rng.uniform(-20, 20),
            rng.uniform(-20, 20),
            tuple(rng.uniform(4, 15, 3)),
            rng.uniform(-np.pi, np.pi),
            label=HOUSES[k % 3],
            score=rng.uniform(0.3, 1),
        )
        for k in range(25)
    ]
    trees = [tree(f"t{k}", rng.uniform(-20, 20), rng.uniform(-20, 20)) for k in range(25)]
    done = run(*crowd, *trees)
    kept = [obj for obj in done.objects if obj.label != "tree"]
    assert len(kept) >= 4
    assert len(done.objects) + len(done.removed) == 50
    for a, b in itertools.combinations(kept, 2):
        assert penetration(a, b) <= 0.05 + 1e-6
    before = {obj.id: outline(obj) for obj in crowd}
    for obj in kept:
        assert before[obj.id].buffer(2e-3).covers(outline(obj))
        assert outline(obj).area >= 0.24 * before[obj.id].area
    solid = shapely.union_all([outline(obj) for obj in kept])
    for obj in done.objects:
        if obj.label == "tree":
            assert not solid.contains(shapely.Point(obj.center[:2])), obj.id
    for name, _ in done.moved:
        (stem,) = (shapely.Point(obj.center[:2]) for obj in done.objects if obj.id == name)
        assert solid.distance(stem) > 0.29
    assert separate(done.objects, HOUSES.__contains__, lambda _: False, PATH).objects == done.objects


def test_what_stands_inside_is_moved_out_or_removed_and_what_hangs_stays() -> None:
    sign = GraphObject("sign", "sign", (0.0, 5.2, 4.0), (0.2, 1.0, 1.0), 0.0)
    roof = tree("roof", 0, 10, 9.2)
    done = run(house("a", 0, 10), tree("edge", 0, 5.5), tree("middle", 1, 10), tree("free", 0, 3), sign, roof)
    assert [obj.id for obj in done.objects] == ["a", "edge", "free", "sign", "roof"]
    assert done.objects[1].center == pytest.approx((0.0, 4.7, 3.0))  # 0.3 m off the front
    assert done.moved == (("edge", 0.8),)
    assert [(gone.id, gone.reason) for gone in done.removed] == [("middle", "it stands 3.3 m inside 'a' (house)")]


def test_a_building_among_objects_with_more_evidence_is_removed() -> None:
    """A house that views of several others make up, on the road; the second, of which there is more evidence than of
    the tree inside it, stays."""
    objects = (house("a", 0, 10), tree("left", -1, 10), tree("right", 1, 10), house("b", 30, 10), tree("lost", 30, 10))
    evidence = {"a": 9.0, "left": 5.0, "right": 5.0, "b": 9.0, "lost": 5.0}
    done = run(*objects, evidence=evidence)
    assert [obj.id for obj in done.objects] == ["left", "right", "b"]
    assert [(gone.id, gone.reason) for gone in done.removed] == [
        ("a", "of the objects inside it there is more evidence"),
        ("lost", "it stands 4.3 m inside 'b' (house)"),
    ]
    assert done.objects[0] == objects[1]
    # What hangs on it and what can be moved out are no evidence against it.
    sign = GraphObject("sign", "sign", (0.0, 10.0, 4.0), (0.2, 1.0, 1.0), 0.0)
    kept = run(house("a", 0, 10), sign, tree("edge", 0, 5.5), evidence={"a": 1.0, "sign": 50.0, "edge": 50.0})
    assert [obj.id for obj in kept.objects] == ["a", "sign", "edge"]
    # Without evidence, as in a graph, the scores do not decide.
    assert [obj.id for obj in run(*objects).objects] == ["a", "b"]


def test_streets_without_overlap_are_left_as_they_are() -> None:
    scenes = pathlib.Path(__file__).parents[2] / "scenes"
    graph = SceneGraph.load(scenes / "residential_bins" / "graph.json")
    path = np.array(graph.camera_path).reshape(-1, 4)[:, :2]
    done = separate(graph.objects, HOUSES.__contains__, lambda _: False, path)
    assert done.objects == graph.objects
    assert (done.removed, done.cut, done.moved) == ((), (), ())
