"""Long missions: routes of the promised length over crossings, the supervisor's reasons, and deploy's loop."""

import dataclasses
import itertools
import json
import math
import pathlib
from typing import Any

import numpy as np
import pytest

from benchmarks import missions, results, transfer
from benchmarks.lib import mission_streets as streets
from benchmarks.lib import shifts as s
from benchmarks.lib.mission_drive import (
    BODIES,
    CAUSES,
    RADIUS,
    SPACING,
    Deployed,
    Supervisor,
    Surroundings,
    Watch,
    contract_of,
    drive_mission,
)
from benchmarks.lib.street_world import World
from tests.support.standing_objects import CUBE, scene_of
from urbanverse_mjx.datatypes import AgentMotion, AgentShapes, ValidationError
from urbanverse_mjx.scene import maps
from urbanverse_mjx.scene.geometry import SceneGeometry
from urbanverse_mjx.scene.terrain import region_scene, strips_regions

HEAD = (
    "policy,robot,blocks,block,mission,end,metres,seconds,waypoints,of,supervised,"
    "stuck,near object,near person,leaving the pavement,contact"
)
CALM = s.Shifts().draw((0,))
FLAT = region_scene("flat", strips_regions(iter([(60.0, 0.0, 0.0)]), 60.0))


@pytest.mark.extended
@pytest.mark.parametrize("number", [0, 7])
def test_a_street_has_no_faults_and_its_missions_are_as_long_as_promised(number: int) -> None:
    size = streets.Size()
    canvas = streets.street(number, size)
    assert canvas.problems() == []
    graph = canvas.graph()
    assert graph.content_hash() == streets.street(number, size).graph().content_hash()
    assert len(graph.objects) > 100
    assert len({o.label for o in graph.objects}) > 20
    near = Surroundings(maps.ground_map(list(graph.ground)), 1.0)
    for k in (number, number + streets.STREETS):
        told = streets.mission(k, size)
        assert told == streets.mission(k, size)
        assert told.street == number
        waypoints = near.waypoints(told.via)
        apart = np.linalg.norm(np.diff(waypoints, axis=0), axis=1)
        assert 300.0 <= apart.sum() <= 400.0
        # Ten metres along the route, less across a corner.
        assert apart[:-1].max() <= SPACING + 1e-6
        assert np.median(apart) == pytest.approx(SPACING, abs=0.5)
        fine = np.concatenate([np.linspace(a, b, 40) for a, b in itertools.pairwise(waypoints)])
        assert near.is_open(fine).mean() > 0.98
        kinds = {r.kind for r in graph.ground if "zebra" in r.id}
        assert kinds == {"crosswalk"}
        # Two streets on each side and the road.
        middles = [(s0, side) for (_, s0), side in zip(size.block_spans()[:-1] * 2, (1, 1, -1, -1), strict=True)]
        for x, side in middles:
            assert (np.hypot(fine[:, 0] - x - 3.0, fine[:, 1] - side * 5.6) < 2.0).any()


def test_missions_of_one_street_differ_and_all_have_numbers() -> None:
    size = streets.Size()
    all_of_one = [streets.mission(k, size) for k in range(3, missions.total(), streets.STREETS)]
    assert missions.total() == 50
    assert len({m.via for m in all_of_one}) == len(all_of_one) == streets.EACH
    via = np.array([streets.mission(k, size).via for k in range(missions.total())])
    assert 0.3 < (via[:, 0, 1] > 0).mean() < 0.7


class _GoTo(transfer.GoToGoal):
    def begin(self, count: int) -> None:
        self.begun = getattr(self, "begun", 0) + count


class _Still(_GoTo):
    def __call__(self, obs):
        return np.zeros((1, 2), np.float32)


def _mission(*via: tuple[float, float]) -> streets.Mission:
    return streets.Mission(0, via, 0)


def _driven(scene, agent, via, people=None, horizon: float = 120.0, **more) -> dict:
    world = World(scene, "coco", s.Shifts(), **more)
    contract = contract_of(None, ("goal",), world.robot, "test")
    near = Surroundings(scene.map, world.robot.planner_height)
    return drive_mission(world, near, _mission(*via), agent, contract, people, horizon=horizon)


def test_deploy_drives_a_free_route_without_help() -> None:
    agent = _GoTo()
    done = _driven(FLAT, agent, ((-20.0, 0.0), (15.0, 0.0), (15.0, 12.0)))
    assert done["end"] == "arrived"
    assert done["interventions"] == dict.fromkeys(CAUSES, 0)
    assert done["waypoints"] == done["of"] == 5
    # Waypoints at 10, 20 and 30 m, 5 m after the corner and at the end, which counts as reached 1.5 m before it.
    assert done["metres"] == pytest.approx(30.0 + math.hypot(5.0, 5.0) + 7.0 - RADIUS, abs=1.0)
    assert done["faults"] == {}
    assert done["supervised"] == 0.0
    # Its policy began once: nothing stopped the loop.
    assert agent.begun == 1


@pytest.mark.extended
def test_a_robot_that_stands_is_carried_on_and_counts_as_stuck() -> None:
    done = _driven(FLAT, _Still(), ((-6.0, 0.0), (6.0, 0.0)))
    assert done["end"] == "arrived"
    # 12 m, of which each intervention drives 3.
    assert 3 <= done["interventions"]["stuck"] <= 4
    assert sum(done["interventions"].values()) == done["interventions"]["stuck"]
    # 20 s of standing before each of them.
    assert done["seconds"] > 60.0
    assert 0.1 < done["supervised"] / done["seconds"] < 0.4


def _with_cube() -> SceneGeometry:
    """A street with a cube on its pavement, which its map knows."""
    scene = scene_of(CUBE, movable=False)
    x, y, _ = scene.object_position[0]
    clearance = scene.map.clearance.copy()
    (i0, j0), (i1, j1) = scene.map.grid.cell(np.array([[x - 0.2, y - 0.2], [x + 0.2, y + 0.2]]))
    clearance[i0 : i1 + 1, j0 : j1 + 1] = 0.0
    return dataclasses.replace(scene, map=dataclasses.replace(scene.map, clearance=clearance))


@pytest.mark.extended
def test_what_stands_before_the_robot_is_avoided_by_the_supervisor() -> None:
    scene = _with_cube()
    x, y, _ = scene.object_position[0]
    done = _driven(scene, _GoTo(), ((x - 6.0, y), (x + 6.0, y)))
    # The goal lies straight behind the cube, and the policy does not see it.
    assert done["interventions"]["near object"] >= 1
    assert done["interventions"]["contact"] == 0
    assert done["end"] == "arrived"


@pytest.mark.extended
def test_a_policy_that_heads_for_the_road_is_stopped() -> None:
    scene = scene_of(CUBE, movable=False)
    _, y, _ = scene.object_position[0]

    class Right(_GoTo):
        def __call__(self, obs):
            return np.array([[0.5, -0.5]], np.float32)

    done = _driven(scene, Right(), ((44.0, y), (56.0, y)), horizon=40.0)
    assert done["interventions"]["leaving the pavement"] >= 1
    assert done["interventions"]["contact"] == 0


class _Crossing:
    """One person who stands in the robot's path for some seconds and then is gone."""

    shapes = AgentShapes(np.array([0.3], np.float32), np.zeros(1, np.float32), np.array([1.7], np.float32))

    def __init__(self, place: tuple[float, float], until: float) -> None:
        self.place, self.until = place, until

    def begin(self, seed, pose):
        self.seen = 0
        return self._motion()

    def step(self, number, pose, velocity):
        self.seen = number
        return self._motion()

    def _motion(self) -> AgentMotion:
        present = np.array([self.seen * 0.02 < self.until])
        fields: list[Any] = [np.array([[*self.place, 0.0]]), np.zeros(1), np.zeros((1, 3)), np.zeros(1), present]
        self.now = AgentMotion(*fields)
        return self.now

    def gaps(self, points):
        if not self.now.present[0]:
            return np.full(points.shape[:-1], np.inf)
        return np.linalg.norm(points - np.array(self.place), axis=-1) - 0.3


@pytest.mark.extended
def test_the_supervisor_waits_for_a_person_and_nobody_is_touched() -> None:
    person = _Crossing((0.0, 0.0), 25.0)
    done = _driven(FLAT, _GoTo(), ((-8.0, 0.0), (8.0, 0.0)), person, agents=person.shapes)
    assert done["interventions"]["near person"] == 1
    assert done["interventions"]["contact"] == 0
    assert done["end"] == "arrived"
    assert done["seconds"] > 25.0
    # The same mission again.
    person = _Crossing((0.0, 0.0), 25.0)
    assert _driven(FLAT, _GoTo(), ((-8.0, 0.0), (8.0, 0.0)), person, agents=person.shapes) == done


def test_touching_a_person_is_a_contact() -> None:
    world = World(FLAT, "coco", s.Shifts(), agents=_Crossing.shapes)
    world.begin(np.array([-2.0, 0.0, 0.0, 0.0]), CALM)
    person = _Crossing((0.0, 0.0), 99.0)
    world.place_agents(person.begin(0, world.pose))
    for _ in range(150):
        world.drive((1.0, 0.0))
        if world.hit:
            break
    assert world.hit == "agent_0"
    # The shell's front is 0.35 m ahead, the person's radius 0.3 m.
    assert -world.pose[0] == pytest.approx(0.65, abs=0.05)
    world.begin(np.array([-2.0, 0.0, 0.0, 0.0]), CALM)
    for _ in range(200):
        world.drive((1.0, 0.0))
    assert world.hit is None


def test_the_supervisor_sees_ahead_what_the_robot_does() -> None:
    world = World(FLAT, "coco", s.Shifts())
    world.begin(np.array([0.0, 0.0, 0.0, 0.5]), CALM)
    supervisor = Supervisor(
        world, Surroundings(FLAT.map, 1.0), lambda p: np.full(p.shape[:-1], np.inf), np.zeros((1, 2))
    )
    speed, turn = 1.5, 0.8
    x, y, yaw = supervisor.ahead((speed, turn))[-1]
    time, radius = Watch().ahead, speed / turn
    assert yaw == pytest.approx(0.5 + turn * time)
    assert (x, y) == pytest.approx(
        (radius * (math.sin(yaw) - math.sin(0.5)), radius * (math.cos(0.5) - math.cos(yaw))), abs=1e-9
    )


def test_a_dead_policy_stops_the_robot_and_the_loop_says_so() -> None:
    class Broken(_GoTo):
        def __call__(self, obs):
            return np.full((1, 2), np.nan, np.float32)

    world = World(FLAT, "coco", s.Shifts())
    contract = contract_of(None, ("goal",), world.robot, "test")
    near = Surroundings(FLAT.map, 1.0)
    done = drive_mission(world, near, _mission((-6.0, 0.0), (6.0, 0.0)), Broken(), contract, None, horizon=15.0)
    assert done["end"] == "time"
    assert done["metres"] < 0.1
    assert Deployed(_GoTo(), contract, np.zeros((1, 2))).controller.reason == "no odometry"


@pytest.mark.parametrize("robot", sorted(BODIES))
def test_two_discs_cover_the_body_of_a_robot(robot: str) -> None:
    world = World(FLAT, robot, s.Shifts())
    world.begin(np.array([0.0, 0.0, 0.0, 0.0]), CALM)
    model, data = world.model, world.data
    length, width = BODIES[robot]
    for g in range(model.ngeom):
        if model.geom(g).name.startswith("robot/") and model.geom_conaffinity[g]:
            place, reach = data.geom_xpos[g][:2] - world.pose[:2], model.geom_rbound[g]
            if model.geom_type[g] == 2:  # spheres, whose bound is exact
                assert abs(place[0]) + reach <= length + 0.03, model.geom(g).name
                assert abs(place[1]) + reach <= width + 0.07, model.geom(g).name


def _outcome(number: int, taken: int, metres: float, end: str = "arrived") -> dict:
    causes = dict.fromkeys(CAUSES, 0) | {"stuck": taken}
    return {
        "mission": number, "end": end, "metres": metres, "seconds": 300.0, "waypoints": 30, "of": 36,
        "interventions": causes, "supervised": 6.0, "faults": {},
    }  # fmt: skip


def test_rates_are_sums_over_kilometres() -> None:
    said = missions.summary([_outcome(0, 2, 400.0), _outcome(1, 0, 100.0, "fall")])
    assert said["interventions_per_km"][0] == pytest.approx(4.0)
    assert said["interventions_per_km"][1:] == [0.0, 5.0]
    assert said["arrived"][0] == 50.0
    assert (said["km"], said["minutes"], said["supervised_percent"]) == (0.5, 5.0, 2.0)
    assert said["causes"]["stuck"] == 2


def test_missions_are_added_once_and_the_page_counts_them(tmp_path: pathlib.Path) -> None:
    (tmp_path / "missions.csv").write_text(HEAD + "\n", encoding="utf-8")
    tested, size = transfer.TestedPolicy("coco_best", "", "coco"), streets.Size()
    for k in range(3):
        file = missions.mission_file(tmp_path, tested, size, k)
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(json.dumps(_outcome(k, k, 400.0)), encoding="utf-8")
    assert missions.add(tmp_path, tmp_path) == missions.add(tmp_path, tmp_path) == 3
    missions.mission_file(tmp_path, tested, size, 0).unlink()  # as in the folder of another machine
    assert missions.add(tmp_path, tmp_path) == 2
    text = missions.page_text(tmp_path)
    assert "| coco_best | COCO | 3 x 56 m | 3 | 1.20 | 100 [44, 100] | 2.5 | 3 / 0 / 0 / 0 / 0 | 5.0 | 2.0 |" in text
    assert "Not run yet, of 50 missions: 47 of coco_best (coco), 50 of go2_best (go2)" in text


def _compiled_streets(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, numbers: range) -> list[str]:
    """Pretends that streets are compiled, and counts what is driven in them; each mission takes a second."""
    driven: list[str] = []
    there = [tmp_path / streets.street_id(number, streets.Size()) for number in numbers]

    def drive(tested, number, size, folder, file, film, until) -> bool:
        if len(driven) >= until:
            return False
        driven.append(f"{tested.robot} {number} {folder.name}")
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(json.dumps(_outcome(number, 1, 400.0)), encoding="utf-8")
        return True

    monkeypatch.setattr(missions, "drive", drive)
    monkeypatch.setattr(missions.time, "time", lambda: 0.0)
    monkeypatch.setattr(missions.os, "environ", {})
    monkeypatch.setattr("urbanverse_mjx.scene.folders.scene_folders", lambda places: there)
    return driven


def test_missions_of_a_street_are_driven_together_until_the_time_is_over(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    driven = _compiled_streets(tmp_path, monkeypatch, range(10))
    words = ["--out", str(tmp_path), "--policy", "go_to_goal", "--scenes", str(tmp_path), "--workers", "1"]
    words += ["--missions", "1", "2", "11", "12", "21"]
    assert missions.main([*words, "--seconds", "4"]) == 0
    street = [streets.street_id(number, streets.Size()) for number in (1, 2)]
    assert driven == [f"coco {k} {street[0]}" for k in (1, 11, 21)] + [f"coco 2 {street[1]}"]
    found = json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))
    assert found["go_to_goal (coco)"]["missions"] == 4
    assert missions.main(words) == 0
    assert driven[4:] == [f"coco 12 {street[1]}"]
    nothing = tmp_path / "other"
    assert missions.main(["--out", str(nothing), *words[2:], "--seconds", "0"]) == 0
    assert json.loads((nothing / "result.json").read_text(encoding="utf-8")) == {}


def test_a_street_that_is_not_among_the_compiled_ones_is_named(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    driven = _compiled_streets(tmp_path, monkeypatch, range(2))
    words = ["--out", str(tmp_path), "--policy", "go_to_goal", "--scenes", str(tmp_path), "--missions", "1", "3"]
    assert missions.main(words) == 2
    assert streets.street_id(3, streets.Size()) in capsys.readouterr().err
    assert driven == []


def test_the_page_is_that_of_the_rows() -> None:
    page = results.PAGE.read_text(encoding="utf-8")
    assert results.with_table(page, missions.page_text(), missions.MARKS) == page, "run make results"
    assert (results.SCORES / "missions.csv").read_text(encoding="utf-8").splitlines()[0] == HEAD
    assert missions._CAUSES == CAUSES


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--policy", "go_to_goal", "--missions", "50"], "--missions"),
        (["--policy", "go_to_goal", "--blocks", "0"], "--blocks"),
        (["--policy", "go_to_goal", "--block", "3"], "--block"),
        (["--policy", "nobody"], "found 'nobody'"),
    ],
)
def test_bad_options_are_one_sentence(
    words: list[str], said: str, tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str], monkeypatch
) -> None:
    monkeypatch.setattr(missions.os, "environ", {})
    assert missions.main(["--out", str(tmp_path), *words]) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ")
    assert said in error
    assert error.count("\n") == 1


def test_a_mission_off_the_pavement_is_refused() -> None:
    near = Surroundings(FLAT.map, 1.0)
    with pytest.raises(ValidationError, match="off its corner"):
        near.waypoints(((0.0, 0.0), (90.0, 0.0)))
    assert RADIUS < SPACING / 2
