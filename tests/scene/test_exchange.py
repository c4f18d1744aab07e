"""CraftBench-Nav's files: maps and routes, written here and as their own code writes them."""

import dataclasses
import json
import pathlib

import numpy as np
import pytest

from tests.support.box_bank import street_regions
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.datatypes.ground import KIND_INDEX
from urbanverse_mjx.scene import maps
from urbanverse_mjx.scene.exchange import ExchangeMap, load_map, save_map
from urbanverse_mjx.scene.exchange_routes import (
    load_annotations,
    load_planned,
    plan_all,
    save_annotations,
    save_planned,
)
from urbanverse_mjx.scene.geometry import SceneMap
from urbanverse_mjx.scene.planner import NAVBENCH, ROBOTS, GoalField, free_space
from urbanverse_mjx.scene.routes import NoRoute, Route, RoutePlanner, Wanted

KINDS = ["none", "road", "road_marking", "crosswalk", "sidewalk", "ground"]
WALL = np.array([(x, y, z) for x in (-0.1, 0.1) for y in (-1.4, 1.4) for z in (0.0, 2.5)])


@pytest.fixture(scope="module")
def street() -> ExchangeMap:
    """A street of 60 m with a crossing at x 28-32, and a wall that leaves 1.2 m of the left pavement at x = 15."""
    m = maps.ground_map(street_regions())
    walls = [WALL], np.eye(3)[None], np.array([(15.0, 5.4, 0.15)])
    return ExchangeMap("toy", maps.with_clearance(m, *walls), maps.tops(m, *walls), {"street_level": 0.15})


def their_files(folder: pathlib.Path) -> None:
    """A map as navbench writes one: images whose first row is the farthest, 10 cm cells, stripes as crosswalk."""
    folder.mkdir()
    ground = np.full((100, 200), 0.0, np.float32)
    kind = np.full(ground.shape, KINDS.index("road"), np.uint8)
    for rows in (slice(0, 30), slice(70, 100)):
        ground[rows], kind[rows] = 0.12, KINDS.index("sidewalk")
    for x in range(80, 120, 10):
        kind[30:70, x : x + 5] = KINDS.index("crosswalk")
    ground[:3, :40], kind[:3, :40] = np.nan, 0
    clearance = np.full(ground.shape, 9.99, np.float32)
    clearance[75:85, 150:160] = 0.0
    top = ground.copy()
    top[75:85, 150:160] = 1.5
    np.savez_compressed(folder / "layers.npz", ground=ground, clearance=clearance, top=top, kind=kind)
    grid = {"x_min": -739.440369, "y_max": 596.46344, "res": 0.1, "width": 200, "height": 100}
    (folder / "map.json").write_text(json.dumps({"scene": "s", "grid": grid, "kinds": KINDS, "level": 1.1}, indent=1))


def test_our_map_comes_back_the_same(street: ExchangeMap, tmp_path: pathlib.Path) -> None:
    save_map(tmp_path / "toy", street)
    again = load_map(tmp_path / "toy")
    for name in ("height", "kind", "clearance"):
        np.testing.assert_array_equal(getattr(again.map, name), getattr(street.map, name))
    np.testing.assert_array_equal(again.top, street.top)
    np.testing.assert_allclose(again.map.origin, street.map.origin, atol=1e-9)
    assert (again.scene, again.info, again.map.resolution) == ("toy", street.info, 0.05)
    body = json.loads((tmp_path / "toy" / "map.json").read_text())
    assert body["kinds"] == KINDS
    assert list(body["grid"]) == ["x_min", "y_max", "res", "width", "height"]
    assert body.keys() == {"scene", "grid", "kinds", *street.info}
    with np.load(tmp_path / "toy" / "layers.npz") as layers:
        assert {n: (layers[n].dtype.name, layers[n].shape) for n in layers.files} == {
            "ground": ("float32", (again.grid["height"], again.grid["width"])),
            "clearance": ("float32", (again.grid["height"], again.grid["width"])),
            "top": ("float32", (again.grid["height"], again.grid["width"])),
            "kind": ("uint8", (again.grid["height"], again.grid["width"])),
        }
        # Column 0 at x_min, row 0 at y_max: the wall's middle, by their rule.
        col = int((15.0 - again.grid["x_min"]) / 0.05)
        row = int((again.grid["y_max"] - 5.5) / 0.05)
        assert layers["clearance"][row, col] == 0.0
        assert layers["top"][row, col] == pytest.approx(2.65)
        assert layers["clearance"][row, col + 20] == pytest.approx(9.99)


def test_their_map_loads_in_the_right_place(tmp_path: pathlib.Path) -> None:
    their_files(tmp_path / "s")
    theirs = load_map(tmp_path / "s")
    assert theirs.info == {"level": 1.1}
    assert theirs.map.kind.shape == (200, 100)
    x, y = -739.440369 + 15.55, 596.46344 - 8.05  # inside the car on the near pavement
    i, j = np.floor((np.array([x, y]) - theirs.map.origin) / 0.1).astype(int)
    assert theirs.map.clearance[i, j] == 0.0
    assert theirs.map.kind[i, j] == KIND_INDEX["sidewalk"]
    assert theirs.map.kind[5, 99] == 0
    save_map(tmp_path / "again", theirs)
    assert json.loads((tmp_path / "again" / "map.json").read_text()) == json.loads(
        (tmp_path / "s" / "map.json").read_text()
    )
    with np.load(tmp_path / "s" / "layers.npz") as a, np.load(tmp_path / "again" / "layers.npz") as b:
        for name in a.files:
            np.testing.assert_array_equal(a[name], b[name])


def test_ways_over_their_stripes_are_straight(tmp_path: pathlib.Path) -> None:
    """Stripes of 0.5 m with gaps of 0.5 m are one crosswalk: a path over them costs as much as over a whole one."""
    their_files(tmp_path / "s")
    theirs = load_map(tmp_path / "s")
    x, y = theirs.map.origin
    planner = RoutePlanner(theirs.map)
    (route,) = planner.plan([Wanted("r001", (x + 8.7, y + 1.0), (x + 8.7, y + 9.0))])
    assert isinstance(route, Route)
    assert route.facts["length_m"] < 8.2
    assert (route.facts["curbs"], route.facts["road_crossings"]) == (2, 1)
    i, j = planner.space.cell(np.array([x + 8.7, y + 5.0]))
    assert theirs.map.kind[i, j] == KIND_INDEX["road"]
    assert planner.space.price is not None
    assert planner.space.price[i, j] == pytest.approx(1.5)


def test_routes_keep_to_the_authors_prices(street: ExchangeMap) -> None:
    """Across the street: over the crossing where that is near, straight over the road where it is far and one may
    climb; a wheelchair may not."""
    far = Wanted("far", (3.0, 6.0), (3.0, -6.0))
    near = Wanted("near", (25.0, 6.0), (25.0, -6.0))
    via = Wanted("via", (25.0, 6.0), (25.0, -6.0), via=((20.0, 0.0),))
    a, b, c = RoutePlanner(street.map).plan([far, near, via])
    assert isinstance(a, Route)
    assert isinstance(b, Route)
    assert isinstance(c, Route)
    assert (a.facts["curbs"], a.facts["road_crossings"]) == (2, 1)
    assert a.facts["length_m"] == pytest.approx(12.0, abs=0.2)
    assert a.facts["by_kind_m"]["road"] == pytest.approx(8.0, abs=0.2)
    assert b.facts["curbs"] == 0
    assert b.facts["by_kind_m"]["crosswalk"] == pytest.approx(8.0, abs=1.0)
    assert "road" not in b.facts["by_kind_m"]
    assert np.linalg.norm(c.waypoints[:, :2] - [20.0, 0.0], axis=1).min() < 0.3
    (chair,) = RoutePlanner(street.map, "wheelchair").plan([far])
    assert isinstance(chair, Route)
    assert chair.facts["curbs"] == 0
    assert chair.facts["length_m"] > 50


def test_routes_go_through_the_gap_beside_the_wall(street: ExchangeMap) -> None:
    along = Wanted("r001", (5.0, 5.0), (25.0, 5.0))
    for robot in ROBOTS:
        (route,) = RoutePlanner(street.map, robot).plan([along])
        assert isinstance(route, Route)
        space = free_space(street.map, ROBOTS[robot], NAVBENCH)
        assert space.distance[space.cell(route.waypoints[:, :2])].min() >= ROBOTS[robot].radius - 0.02
        assert route.facts["by_kind_m"].keys() == {"sidewalk"}
        assert route.facts["length_m"] < 21.5
    wider = dataclasses.replace(ROBOTS["delivery"], radius=0.6)
    (around,) = RoutePlanner(street.map, "wide", wider).plan([along])
    assert isinstance(around, Route)
    assert around.facts["road_crossings"] >= 1


def test_points_on_blocked_ground_are_moved_or_refused(street: ExchangeMap) -> None:
    planner = RoutePlanner(street.map)
    inside, outside, same = planner.plan(
        [
            Wanted("a", (15.0, 4.3), (25.0, 6.0)),
            Wanted("b", (-30.0, 0.0), (25.0, 6.0)),
            Wanted("c", (25.0, 6.0), (25.0, 6.0)),
        ]
    )
    assert isinstance(inside, Route)
    assert 0.1 < np.hypot(inside.points[0][0] - 15.0, inside.points[0][1] - 4.3) <= 1.0
    assert isinstance(outside, NoRoute)
    assert "the start (-30.00, 0.00)" in outside.error
    assert isinstance(same, NoRoute)
    huge = RoutePlanner(street.map, "huge", dataclasses.replace(ROBOTS["delivery"], radius=3.5))
    (blocked,) = huge.plan([Wanted("d", (15.0, 6.0), (25.0, 6.0))])
    assert isinstance(blocked, NoRoute)
    assert "blocked for the huge robot or off the map, and so is all within 1 m" in blocked.error


def test_chosen_routes_reach_both_ends(street: ExchangeMap) -> None:
    planner = RoutePlanner(street.map)
    wanted = planner.choose()
    assert wanted == RoutePlanner(street.map).choose()
    assert wanted != planner.choose(seed=1)
    planned = planner.plan(wanted)
    lengths = [r.facts["length_m"] for r in planned if isinstance(r, Route)]
    assert len(lengths) == 12
    assert max(lengths) > 56.0
    assert min(lengths) < 20.0
    nowhere = dataclasses.replace(street.map, clearance=np.zeros_like(street.map.clearance))
    assert RoutePlanner(nowhere).choose() == []


@pytest.mark.parametrize("seed", [0, 1])
def test_chosen_routes_have_the_costs_that_are_asked_for(street: ExchangeMap, seed: int) -> None:
    """By Dijkstra's algorithm cell by cell: one end is the farthest place from the other, the third goal half-way, and
    the starts cost the shares of the dearest place, where such places exist."""
    planner = RoutePlanner(street.map)
    places = [tuple(cell) for cell in planner._places().tolist()]
    wanted = planner.choose(seed)
    assert len(wanted) == 12
    cell_of = {planner._point(cell): cell for cell in places}
    assert len(cell_of) == len(places)

    def costs(goal: tuple[int, int]) -> dict[tuple[int, int], float]:
        table = GoalField(planner.space, np.array(goal)).cost
        return {(i, j): float(table[i, j]) for i, j in places}

    goals = [cell_of[w.goal] for w in wanted[::4]]
    shares = ((1.0, 0.75, 0.5, 0.25), (0.9, 0.65, 0.4, 0.2), (1.0, 0.7, 0.45, 0.2))
    for k, goal in enumerate(goals):
        found = costs(goal)
        most = max(found.values())
        for share, route in zip(shares[k], wanted[4 * k : 4 * k + 4], strict=True):
            assert cell_of[route.goal] == goal
            off = abs(found[cell_of[route.start]] - share * most)
            assert off <= max(0.03 * most, min(abs(cost - share * most) for cost in found.values())) + 1e-6
    from_first, from_corner = costs(goals[0]), costs(places[0])
    assert from_corner[goals[0]] == max(from_corner.values())
    assert from_first[goals[1]] == max(from_first.values())
    half = max(from_first.values()) / 2
    assert abs(from_first[goals[2]] - half) == min(abs(cost - half) for cost in from_first.values())


@pytest.mark.parametrize("number", [0, 1, 2, 5])
def test_routes_are_chosen_wherever_there_are_two_places(street: ExchangeMap, number: int) -> None:
    planner = RoutePlanner(street.map)
    few = planner._places()[:: len(planner._places()) // 5][:number]
    planner._places = lambda: few  # type: ignore[method-assign]
    wanted = planner.choose()
    points = {planner._point(cell) for cell in few}
    assert {p for w in wanted for p in (w.start, w.goal)} <= points
    assert all(w.start != w.goal for w in wanted)
    assert (len(wanted) >= 3) == (number >= 2)


def test_route_files_come_back_the_same(street: ExchangeMap, tmp_path: pathlib.Path) -> None:
    wanted = [
        Wanted("r001", (3.0, 6.0), (55.0, -6.0), note="along"),
        Wanted("r002", (3.0, 6.0), (400.0, 6.0)),
        Wanted("r003", (25.0, 6.0), (25.0, -6.0), ((30.0, 0.0),)),
    ]
    save_annotations(tmp_path / "toy.json", "toy", wanted)
    assert load_annotations(tmp_path / "toy.json") == ("toy", wanted)
    planned = plan_all(RoutePlanner(street.map, "quadruped"), "toy", street.grid, wanted)
    folder = tmp_path / "toy"
    folder.mkdir()
    np.save(folder / "mine.npy", np.zeros((2, 4)))
    first = next(r for r in planned.planned if r.id == "r001")
    save_planned(folder, dataclasses.replace(planned, routes=(dataclasses.replace(first, id="r009"),)))
    assert (folder / "r009.npy").is_file()
    save_planned(folder, planned)
    names = ["mine.npy", "r001.npy", "r003.npy", "routes.json", "routes.txt"]
    assert sorted(p.name for p in folder.iterdir()) == names, "of what was there the route no longer wanted went"
    again = load_planned(folder)
    assert (again.scene, again.robot, again.grid) == ("toy", "quadruped", street.grid)
    assert again.size == ROBOTS["quadruped"]
    assert again.routes[1] == planned.routes[1]
    for a, b in zip(again.planned, planned.planned, strict=True):
        np.testing.assert_array_equal(a.waypoints, b.waypoints)
        np.testing.assert_allclose(a.path, b.path, atol=5e-4)
        assert (a.id, a.note, a.points, a.facts) == (b.id, b.note, b.points, b.facts)
    lines = (folder / "routes.txt").read_text().splitlines()
    assert len(lines) == 3
    assert {len(line.split("\t")) for line in lines} == {15}
    save_planned(tmp_path / "twice", again)
    assert (tmp_path / "twice" / "routes.txt").read_bytes() == (folder / "routes.txt").read_bytes()


def test_their_planned_routes_load_unchanged(tmp_path: pathlib.Path) -> None:
    """The example of their documentation, with a route that could not be planned."""
    rows = np.array([[-610.19044, 442.8134, 1.105, -1.9513], [-657.8904, 478.5134, 1.105, -1.9513]])
    np.save(tmp_path / "r002.npy", rows)
    route = {
        "id": "r002",
        "note": "example: across a street",
        "start": {"x": -610.1904, "y": 442.8134, "z": 1.105, "yaw": -1.9513},
        "goal": {"x": -657.8904, "y": 478.5134, "z": 1.105},
        "points": [[-610.19, 442.813], [-657.89, 478.513]],
        "path": [[-610.19, 442.813], [-657.89, 478.513]],
        "waypoints": "r002.npy",
        "facts": {"length_m": 59.58, "by_kind_m": {"sidewalk": 59.58}},
    }
    body = {
        "format": 1,
        "scene": "scene_10_cbd_cross_intersection_diverse_obstacles",
        "frame": "scene world, meters, Z up; yaw in radians from +X",
        "robot": {"name": "delivery", "radius": 0.35, "height": 1.0, "step": 0.22},
        "map": {"folder": "scene_10", "x_min": -739.44, "y_max": 596.46, "res": 0.05, "width": 3960, "height": 3890},
        "routes": [route, {"id": "r004", "note": "", "error": "the goal cannot be reached"}],
    }
    (tmp_path / "routes.json").write_text(json.dumps(body))
    planned = load_planned(tmp_path)
    (loaded,) = planned.planned
    np.testing.assert_array_equal(loaded.waypoints, rows)
    assert loaded.facts == route["facts"]
    assert planned.routes[1] == NoRoute("r004", "", "the goal cannot be reached")


def _break(path: pathlib.Path, **changes: object) -> None:
    path.write_text(json.dumps({**json.loads(path.read_text()), **changes}))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"format": 2}, "at most 1"),
        ({"robot": {"name": "x"}}, "radius"),
        ({"routes": [{"id": "../../etc", "error": "x"}]}, "ASCII letters"),
        ({"surprise": 1}, "unknown field"),
    ],
)
def test_damaged_routes_are_refused(change, message, street: ExchangeMap, tmp_path: pathlib.Path) -> None:
    wanted = [Wanted("r001", (3.0, 6.0), (55.0, -6.0))]
    save_planned(tmp_path, plan_all(RoutePlanner(street.map), "toy", street.grid, wanted))
    _break(tmp_path / "routes.json", **change)
    with pytest.raises(ValidationError, match=message):
        load_planned(tmp_path)


def test_waypoints_come_from_beside_the_file_alone(street: ExchangeMap, tmp_path: pathlib.Path) -> None:
    wanted = [Wanted("r001", (3.0, 6.0), (55.0, -6.0))]
    save_planned(tmp_path / "toy", plan_all(RoutePlanner(street.map), "toy", street.grid, wanted))
    path = tmp_path / "toy" / "routes.json"
    body = json.loads(path.read_text())
    np.save(tmp_path / "other.npy", np.zeros((2, 4)))
    for name, message in (("../other.npy", "beside"), ("gone.npy", "no such file")):
        body["routes"][0]["waypoints"] = name
        path.write_text(json.dumps(body))
        with pytest.raises(ValidationError, match=message):
            load_planned(tmp_path / "toy")


@pytest.mark.parametrize("fault", ["no layers", "shape", "kind", "no zip", "grid"])
def test_damaged_maps_are_refused(fault: str, tmp_path: pathlib.Path) -> None:
    folder = tmp_path / "s"
    their_files(folder)
    if fault == "no layers":
        (folder / "layers.npz").unlink()
    elif fault == "no zip":
        (folder / "layers.npz").write_bytes(b"nothing")
    elif fault == "grid":
        _break(folder / "map.json", grid={"x_min": 0})
    else:
        with np.load(folder / "layers.npz") as file:
            layers = dict(file)
        layers["kind"] = layers["kind"][:5] if fault == "shape" else layers["kind"] + 7
        np.savez_compressed(folder / "layers.npz", allow_pickle=False, **layers)
    with pytest.raises(ValidationError, match="found"):
        load_map(folder)


def test_tops_are_the_highest_object() -> None:
    m = maps.ground_map(street_regions())
    high = maps.tops(m, [WALL, WALL], np.eye(3)[None].repeat(2, 0), np.array([(15.0, 5.5, 0.15), (15.0, 5.5, 2.0)]))
    i, j = np.floor((np.array([15.0, 5.5]) - m.origin) / 0.05).astype(int)
    assert high[i, j] == pytest.approx(4.5)
    assert high[i + 20, j] == pytest.approx(0.15)
    assert np.isnan(high[0, 0])


def test_their_map_may_have_other_kinds_order(tmp_path: pathlib.Path) -> None:
    their_files(tmp_path / "s")
    before = load_map(tmp_path / "s").map
    with np.load(tmp_path / "s" / "layers.npz") as file:
        layers = dict(file)
    layers["kind"] = np.uint8(5) - layers["kind"]
    np.savez_compressed(tmp_path / "s" / "layers.npz", allow_pickle=False, **layers)
    _break(tmp_path / "s" / "map.json", kinds=KINDS[::-1])
    after = load_map(tmp_path / "s").map
    assert isinstance(after, SceneMap)
    np.testing.assert_array_equal(before.kind, after.kind)
