"""The canvas: ground cut as drawn, objects where they were put, and every fault that it must name."""

import math

import pytest
import shapely

from urbanverse_mjx.citygen.canvas import ground_layers
from urbanverse_mjx.citygen.canvas.canvas import Canvas, edge
from urbanverse_mjx.citygen.canvas.ground_layers import rectangle
from urbanverse_mjx.citygen.craftbench import write
from urbanverse_mjx.datatypes import SceneGraph, ValidationError
from urbanverse_mjx.datatypes.ground import height_at


def street(kerb: float = 0.12) -> Canvas:
    canvas = Canvas("made_for_a_test")
    canvas.ground("walk", "sidewalk", rectangle(0, -12, 40, 12), kerb)
    canvas.ground("road", "road", rectangle(0, -4, 40, 4))
    canvas.ground("crossing", "crosswalk", rectangle(18, -4, 22, 4))
    canvas.ramp("left", (20, 4), 90)
    canvas.ramp("right", (20, -4), -90)
    canvas.trajectory = [(1, 8), (20, 8), (20, -8), (39, -8)]
    return canvas


def test_what_is_laid_later_is_cut_out_of_what_was_there():
    canvas = street()
    canvas.ground("pit", "ground", rectangle(5, 6, 7, 8), 0.12)
    canvas.lay_ground()
    shapes = {r.id: shapely.Polygon(r.polygon) for r in canvas.regions}
    assert sum(s.area for s in shapes.values()) == pytest.approx(40 * 24, abs=1e-6)
    assert shapely.union_all(list(shapes.values())).area == pytest.approx(40 * 24, abs=1e-6)
    assert shapes["pit"].area == pytest.approx(4.0)
    assert not [name for name, s in shapes.items() if s.interiors]
    assert ground_layers.seams(canvas.regions) == []


def test_a_dropped_kerb_joins_road_and_pavement_in_any_direction():
    for degrees in (0.0, 37.0, 90.0, -120.0):
        angle = math.radians(degrees)
        u, v = (math.cos(angle), math.sin(angle)), (-math.sin(angle), math.cos(angle))

        def at(s: float, t: float, u=u, v=v) -> tuple[float, float]:
            return s * u[0] + t * v[0], s * u[1] + t * v[1]

        canvas = Canvas("turned")
        canvas.ground("walk", "sidewalk", [at(0, -9), at(6, -9), at(6, 9), at(0, 9)], 0.15)
        canvas.ground("road", "road", [at(-6, -9), at(0, -9), at(0, 9), at(-6, 9)])
        canvas.ramp("ramp", (0.0, 0.0), degrees)
        canvas.lay_ground()
        assert canvas.problems() == []
        ramp = next(r for r in canvas.regions if r.id == "ramp")
        assert height_at(ramp.plane, *at(0.0, 0.3)) == pytest.approx(0.0, abs=2e-4)
        assert height_at(ramp.plane, *at(1.5, -0.3)) == pytest.approx(0.15, abs=1e-3)
        for flare in (r for r in canvas.regions if "flare" in r.id):
            heights = sorted(height_at(flare.plane, x, y) for x, y in flare.polygon)
            assert heights == pytest.approx([0.0, 0.15, 0.15], abs=1e-3)


def test_stairs_climb_evenly():
    canvas = Canvas("steps")
    canvas.ground("low", "sidewalk", rectangle(0, 0, 5, 5))
    canvas.ground("high", "sidewalk", rectangle(5, 0, 12, 5), 0.6)
    canvas.stairs("flight", (5, 2.5), 0.0, 3.0, 3)
    canvas.lay_ground()
    tops = [r.plane[2] for r in canvas.regions if r.id.startswith("flight")]
    assert tops == pytest.approx([0.15, 0.3, 0.45])


def test_objects_stand_where_an_edge_says():
    canvas = street()
    left, right = edge((0, 4), (40, 4), 1), edge((0, -4), (40, -4), -1)
    canvas.along(left, [("bench", 10, 1.5, "street"), ("chair", 12, 3.0, 30.0)])
    canvas.along(right, [("bench", 10, 1.5, "wall"), ("scooter", 14, 2.0, "+", 1)])
    a, b, c, d = canvas.objects
    assert (a.center[:2], a.yaw) == ((10.0, 5.5), pytest.approx(-math.pi / 2, abs=1e-3))
    assert (b.center[:2], b.yaw) == ((12.0, 7.0), pytest.approx(math.radians(30), abs=1e-3))
    assert (c.center[:2], c.yaw) == ((10.0, -5.5), pytest.approx(-math.pi / 2, abs=1e-3))
    assert d.size[2] < 0.6, "a scooter on its side"
    assert a.center[2] - a.size[2] / 2 == pytest.approx(0.12)
    assert canvas.problems() == []


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (lambda c: c.put("bench", 10.0, 4.0), "across a kerb"),
        (lambda c: (c.put("sedan", 5.0, 0.0), c.put("sedan", 6.0, 0.0)), "share"),
        (lambda c: c.put("chair", 50.0, 8.0), "outside the ground"),
        (lambda c: c.put("chair", 10.0, 8.0, above=0.1), "off the ground"),
        (lambda c: c.put("wall", 10.0, 8.0, size=(0.3, 7.9, 2.0)), "blocked"),
    ],
)
def test_a_fault_is_named(spoil, said):
    canvas = street()
    assert canvas.problems() == []
    spoil(canvas)
    found = canvas.problems()
    assert found, "nothing was named"
    assert all(said in line for line in found)


def test_an_awning_is_in_nobodys_way():
    canvas = street()
    canvas.put("awning", 10.0, 11.0, -90.0, variant=0, above=2.5)
    assert canvas.problems() == []


def test_named_looks_become_descriptors():
    canvas = street()
    canvas.wear("road", "cobble_grey")
    canvas.wear((10.0, 8.0), "flagstones")
    graph = canvas.graph()
    worn = [r for r in graph.ground if r.descriptor is not None]
    assert {r.kind for r in worn} == {"road", "sidewalk"}
    assert shapely.Polygon(worn[0].polygon if worn[0].kind == "sidewalk" else worn[1].polygon).bounds[1] > 0
    canvas.wear((99.0, 99.0), "flagstones")
    with pytest.raises(ValidationError, match="no ground at"):
        canvas.graph()


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (lambda c: c.ground("bow", "road", [(0, 0), (1, 1), (1, 0), (0, 1)]), "simple ring"),
        (lambda c: c.ramp("far", (400, 0), 90), "found none at"),
        (lambda c: (c.put("chair", 5, 8), c.ground("late", "road", rectangle(0, 0, 1, 1))), "before them"),
        (lambda c: c.along(edge((0, 4), (9, 4), 1), [("chair", 1, 1, "up")]), "facing"),
    ],
)
def test_a_mistake_is_refused_in_one_sentence(wrong, said):
    with pytest.raises(ValidationError, match=said):
        wrong(street())


def test_a_written_graph_is_read_back_the_same(tmp_path):
    canvas = street()
    canvas.put("bench", 10.0, 8.0)
    graph = canvas.graph()
    assert SceneGraph.load(write(graph, tmp_path / "graph.json")) == graph
