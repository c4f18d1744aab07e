"""The transfer stand-in: places without faults, episodes as in the environment, commands late by the latency, resumed
runs, and tables of the rows."""

import json
import math
import pathlib
import shutil
import types

import numpy as np
import pytest

from benchmarks import results, transfer, transfer_page
from benchmarks.lib import shifts as s
from benchmarks.lib.street_world import TICK, World, make_robot
from benchmarks.lib.transfer_places import DIRECT, FILMED
from tests.support.standing_objects import CUBE, scene_of
from urbanverse_mjx.citygen import craftbench, validation_streets
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.scene.terrain import region_scene, strips_regions

HEAD = "policy,robot,shift,place,episodes,goal,hit,off_traversable,fall,timeout,metres,seconds,left"


@pytest.mark.parametrize("place", [*DIRECT, *FILMED])
def test_nothing_in_a_place_floats_overlaps_or_blocks_its_walk(place: str) -> None:
    canvas = (DIRECT | FILMED)[place]()
    assert canvas.problems() == []
    graph = canvas.graph()
    x, y = np.array([p[:2] for p in graph.camera_path]).T
    # The paper's routes are 24.6 m long on average.
    assert 20.0 <= np.hypot(np.diff(x), np.diff(y)).sum() <= 70.0
    assert len(graph.objects) >= 16


def test_places_are_those_of_the_paper_s_list_and_no_scene_of_ours() -> None:
    numbers = sorted(int(place[1:3]) for place in (*DIRECT, *FILMED))
    assert numbers == list(range(1, 17))
    assert len(DIRECT) == len(FILMED) == 8
    assert not {*DIRECT, *FILMED} & {*craftbench.BUILDERS, *validation_streets.BUILDERS}
    known = {place for place in transfer.place_names() if place not in DIRECT}
    assert known == set(FILMED)
    for place in known:
        graph = transfer.place_graph(place)
        # Distilled, not composed: other objects, each with a score of the network.
        assert graph.id == place
        assert graph.content_hash() != FILMED[place]().graph().content_hash()
        assert 0.0 < np.mean([o.score for o in graph.objects]) < 1.0


FLAT = region_scene("flat", strips_regions(iter([(80.0, 0.0, 0.0)]), 80.0))


class _Scripted:
    """An agent whose actions are a fixed sequence."""

    observations = ("goal",)

    def __init__(self, actions: np.ndarray) -> None:
        self.actions, self.seen = actions, []

    def begin(self, count: int) -> None:
        self.number = 0

    def __call__(self, obs: dict[str, np.ndarray]) -> np.ndarray:
        self.seen.append({k: x.copy() for k, x in obs.items()})
        self.number += 1
        return self.actions[(self.number - 1) % len(self.actions)][None]


def _task(agent: object, **fields: object) -> transfer.Task:
    return transfer.Task(
        **{
            "agent": agent,
            "size": None,
            "vision": {},
            "period": 0.2,
            "action_mode": "velocity",
            "goal_limit": 0.0,
            **fields,
        }
    )  # type: ignore[arg-type]


@pytest.mark.parametrize("latency", [0.0, 0.06, 0.25, 0.4])
def test_the_base_obeys_the_same_commands_late_by_the_latency(latency: float, monkeypatch: pytest.MonkeyPatch) -> None:
    actions = np.random.default_rng(3).uniform(-1.0, 1.0, (50, 2)).astype(np.float32)
    world = World(FLAT, "coco", s.Shifts())
    obeyed: list[tuple[float, float]] = []
    original = World.drive
    monkeypatch.setattr(World, "drive", lambda self, v: (obeyed.append(v), original(self, v)))
    monkeypatch.setattr(transfer, "HORIZON", 4.0)
    conditions = s.Shifts(latency=(latency, latency)).draw((1,))
    task = _task(_Scripted(actions))
    transfer.drive(world, task, np.zeros(4), np.array([35.0, 0.0]), conditions)
    told = [transfer.velocity_of(task, world.robot, a) for a in actions[:20]]
    late = math.ceil(latency / TICK - 1e-9)
    assert len(obeyed) == 200
    assert obeyed[:late] == [(0.0, 0.0)] * late
    assert obeyed[late:] == [v for v in told for _ in range(10)][: 200 - late]


def test_an_episode_ends_as_in_the_environment() -> None:
    world = World(FLAT, "coco", s.Shifts())
    calm = s.Shifts().draw((1,))
    straight = _task(_GoTo(), action_mode="waypoint")
    done = transfer.drive(world, straight, np.array([0.0, 0.0, 0.0, 0.4]), np.array([12.0, 2.0, 0.0]), calm)
    assert done["end"] == "goal"
    assert done["left"] < transfer.RADIUS
    assert done["hit"] is None
    assert 11.0 < done["metres"] < 13.0
    assert 5.6 < done["seconds"] < 7.0
    still = _task(_Scripted(np.array([[-1.0, 0.0]], np.float32)))
    stood = transfer.drive(world, still, np.zeros(4), np.array([12.0, 0.0]), calm)
    assert (stood["end"], stood["seconds"]) == ("timeout", transfer.HORIZON)
    assert stood["metres"] < 0.1
    scene = scene_of(CUBE, movable=False)
    x, y, z = scene.object_position[0]
    boxed = World(scene, "coco", s.Shifts())
    hit = transfer.drive(boxed, straight, np.array([x - 3.0, y, z, 0.0]), np.array([x + 9.0, y]), calm)
    assert (hit["end"], hit["hit"]) == ("hit", scene.object_ids[0])
    off = transfer.drive(boxed, straight, np.array([x - 3.0, y, z, -math.pi / 2]), np.array([x - 3.0, 0.0]), calm)
    assert off["end"] == "off_traversable"


class _GoTo(transfer.GoToGoal):
    def begin(self, count: int) -> None:
        pass


def test_a_policy_is_told_the_goal_by_drifting_odometry_and_its_last_action() -> None:
    world, agent = World(FLAT, "coco", s.Shifts(drift=1.0)), _Scripted(np.array([[0.0, 0.1], [0.2, -0.1]], np.float32))
    conditions = s.Conditions(0.0, 0.0, (0.0, 0.0, -1.0), 1.0, 1.0, 1.1, 0.0, (1,))
    done = transfer.drive(world, _task(agent), np.zeros(4), np.array([20.0, 0.0]), conditions)
    assert done["end"] == "goal"
    first, last = agent.seen[0], agent.seen[-1]
    np.testing.assert_allclose(first["goal"], [[20.0, 0.0]], atol=1e-6)
    np.testing.assert_allclose(first["proprio"], np.zeros((1, 5)), atol=1e-6)
    np.testing.assert_allclose(agent.seen[1]["proprio"][0, 3:], [0.0, 0.1], atol=1e-6)
    # Odometry that counts a tenth too much has passed the goal when the robot is near it.
    assert np.linalg.norm(last["goal"]) < 2.5
    assert last["goal"][0, 0] < 20.0 - 1.1 * 17.0


def test_a_limit_shortens_the_goal_vector() -> None:
    world, agent = World(FLAT, "coco", s.Shifts()), _Scripted(np.array([[1.0, 0.0]], np.float32))
    transfer.drive(world, _task(agent, goal_limit=5.0), np.zeros(4), np.array([12.0, 9.0]), s.Shifts().draw((1,)))
    np.testing.assert_allclose(agent.seen[0]["goal"], [[4.0, 3.0]], atol=1e-5)


def _fake_places(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Counts what is driven, without MuJoCo."""
    driven: list[str] = []

    def drive_place(tested, shifts, folder, episodes, file, until) -> bool:
        driven.append(f"{tested.name} {folder.name}")
        ends = [
            {"episode": k, "end": "goal", "hit": None, "seconds": 1.0, "metres": 9.0, "left": 0.5}
            for k in range(episodes)
        ]
        body = {"place": folder.name, "shifts": transfer.dataclasses.asdict(shifts), "episodes": ends}
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(json.dumps(body), encoding="utf-8")
        return True

    monkeypatch.setattr(transfer, "drive_place", drive_place)
    return driven


def test_a_run_continues_and_drives_again_what_has_changed(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    driven = _fake_places(tmp_path, monkeypatch)
    tested, folders = transfer.TestedPolicy("mine", "mine.onnx", "coco"), [tmp_path / "a", tmp_path / "b"]
    latency = s.Shifts(latency=(0.1, 0.1))
    transfer.run([(tested, "own", latency)], folders[:1], tmp_path, 3, 1)
    transfer.run([(tested, "own", latency)], folders, tmp_path, 3, 1)
    assert driven == ["mine a", "mine b"]
    transfer.run([(tested, "own", s.Shifts(latency=(0.2, 0.2)))], folders[:1], tmp_path, 3, 1)
    transfer.run([(tested, "own", s.Shifts(latency=(0.2, 0.2)))], folders[:1], tmp_path, 4, 1)
    assert driven == ["mine a", "mine b", "mine a", "mine a"]
    rows = transfer.rows_of(tmp_path, tested, "own", ["a", "b", "c"])
    assert [(r["place"], r["episodes"], r["goal"], r["metres"]) for r in rows] == [("a", 4, 4, 36.0), ("b", 3, 3, 27.0)]


def _fake_world(monkeypatch: pytest.MonkeyPatch, count: int) -> list[float]:
    """Counts the starts from which a scene's episodes are driven, without MuJoCo; each takes a second of the clock."""
    driven: list[float] = []

    class Table:
        start, goal = np.arange(count), np.zeros((count, 3))

        def __len__(self) -> int:
            return count

    def drive(world, task, start, goal, conditions) -> dict:
        driven.append(int(start))
        return {"end": "goal", "hit": None, "seconds": 1.0, "metres": 9.0, "left": 0.5}

    world = types.SimpleNamespace(geometry=types.SimpleNamespace(episodes=Table()))
    monkeypatch.setattr(transfer, "load_task", lambda tested: types.SimpleNamespace(size=None, vision={}))
    monkeypatch.setattr(transfer, "_world", lambda *args: world)
    monkeypatch.setattr(transfer, "drive", drive)
    monkeypatch.setattr(transfer.time, "time", lambda: float(len(driven)))
    return driven


def test_a_run_out_of_time_loses_no_episode(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    driven = _fake_world(monkeypatch, 11)
    tested, folder, file = (
        transfer.TestedPolicy("mine", "mine.onnx", "coco"),
        tmp_path / "a",
        tmp_path / "out" / "a.json",
    )
    assert not transfer.drive_place(tested, s.Shifts(), folder, 6, file, 4.0)
    assert driven == [0, 2, 4, 6]
    assert not file.exists()
    assert transfer.rows_of(tmp_path, tested, "none", ["a"]) == []
    # Elsewhere, from a copy of that folder.
    copy = tmp_path / "copy"
    shutil.copytree(file.parent, copy)
    assert transfer.drive_place(tested, s.Shifts(), folder, 6, copy / "a.json")
    assert driven == [0, 2, 4, 6, 8, 10]
    done = json.loads((copy / "a.json").read_text(encoding="utf-8"))
    assert [e["episode"] for e in done["episodes"]] == [0, 2, 4, 6, 8, 10]
    assert [p.name for p in copy.iterdir()] == ["a.json"]
    # Episodes of another number or of other shifts do not count.
    assert transfer.drive_place(tested, s.Shifts(), folder, 3, file)
    assert driven[6:] == [0, 5, 10]
    file.unlink()
    assert not transfer.drive_place(tested, s.Shifts(), folder, 6, file, 11.0)
    assert transfer.drive_place(tested, s.Shifts(dropped=0.1), folder, 6, file)
    assert driven[9:] == [0, 2, 0, 2, 4, 6, 8, 10]


def test_a_run_out_of_time_says_what_is_there(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    driven = _fake_world(monkeypatch, 4)
    monkeypatch.setattr(transfer.os, "environ", {})
    monkeypatch.setattr("urbanverse_mjx.scene.folders.scene_folders", lambda places: [tmp_path / "a", tmp_path / "b"])
    words = ["--out", str(tmp_path), "--policy", "go_to_goal", "--scenes", ".", "--workers", "1", "--episodes", "4"]
    words += ["--shifts", "none", "slope"]
    assert transfer.main([*words, "--seconds", "6"]) == 0
    assert driven == [0, 1, 2, 3, 0, 1]
    found = json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))["go_to_goal (coco)"]
    assert {shift: row["episodes"] for shift, row in found.items()} == {"none": 4}
    assert "0/4" not in capsys.readouterr().err
    assert transfer.main(words) == 0
    assert driven[6:] == [2, 3, *range(4), *range(4)]


def test_the_table_of_all_policies_comes_first(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(transfer, "find_policy", lambda policy, robot, out: transfer.TestedPolicy(policy, "", robot))
    rows = transfer._rows(transfer.arguments(["--out", str(tmp_path)]))
    assert [(tested.name, tested.robot) for tested, _, _ in rows[:5]] == list(transfer.POLICIES)
    assert [shift for _, shift, _ in rows] == ["all"] * 5 + [name for name in s.ALONE for _ in transfer.SINGLE]


@pytest.mark.parametrize("name", ["coco", "go2"])
def test_the_compiled_conversion_of_a_waypoint_is_the_robot_s(name: str) -> None:
    robot, task = make_robot(name)[0], _task(None, action_mode="waypoint")
    for action in np.random.default_rng(5).uniform(-1.0, 1.0, (50, 2)).astype(np.float32):
        told = [float(x) for x in robot.waypoint_to_velocity(action, task.period)]
        np.testing.assert_allclose(transfer.velocity_of(task, robot, action), told, rtol=0.0, atol=1e-6)


def test_a_place_without_space_is_left_out_and_named(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("urbanverse_mjx.assets.records.store.ensure_store", lambda: None)
    monkeypatch.setattr(transfer, "build_place", lambda place, folder: "no space" if place == "b" else "")
    assert transfer.build_places(["a", "b", "c"], tmp_path, 1) == [tmp_path / "a", tmp_path / "c"]
    assert json.loads((tmp_path / "left_out.json").read_text(encoding="utf-8")) == {"b": "no space"}
    assert "b left out: no space" in capsys.readouterr().err
    with pytest.raises(ValidationError, match="no space"):
        transfer.build_places(["b"], tmp_path, 1)


def test_rows_are_written_once_and_the_page_counts_them(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    _fake_places(tmp_path, monkeypatch)
    (tmp_path / "transfer.csv").write_text(HEAD + "\n", encoding="utf-8")
    folders = [tmp_path / place for place in transfer.place_names()]
    rows = [
        (transfer.TestedPolicy("coco_best", "", "coco"), name, shifts) for name, shifts in transfer.all_shifts().items()
    ]
    transfer.run(rows[:2], folders, tmp_path, 5, 1)
    assert transfer.add(tmp_path, tmp_path) == transfer.add(tmp_path, tmp_path) == 2 * len(folders)
    found = transfer_page.read(tmp_path)
    assert {key: len(x) for key, x in found.items()} == {
        ("coco_best", "coco", "all"): len(folders), ("coco_best", "coco", "none"): len(folders)
    }  # fmt: skip
    text = transfer_page.text(found)
    assert f"| coco_best | COCO | {len(folders)} | {5 * len(folders)} | 100.0 [100.0, 100.0] |" in text
    assert "latency, dropped images," in text
    assert "all: go_to_goal (COCO), coco_paper (COCO), go_to_goal (Go2), go2_best (Go2)" in text


def test_failures_are_per_metre_driven_and_intervals_draw_places() -> None:
    ends = {"hit": 0, "off_traversable": 0, "fall": 0, "timeout": 0}
    rows = [{"episodes": 20, "goal": g, "metres": m, **ends} for g, m in ((20, 500.0), (10, 250.0), (0, 50.0))]
    said = transfer.summary(rows)
    assert said["SR"][0] == 50.0
    assert said["failures_per_100m"][0] == pytest.approx(100 * 30 / 800, abs=1e-3)
    assert said["SR"][1:] == [0.0, 100.0]
    alike = transfer.summary([{"episodes": 20, "goal": 10, "metres": 300.0, **ends}] * 3)
    assert alike["SR"] == [50.0, 50.0, 50.0]


def test_the_page_is_that_of_the_rows() -> None:
    page = results.PAGE.read_text(encoding="utf-8")
    text = transfer_page.text(transfer_page.read(results.SCORES))
    assert results.with_table(page, text, transfer_page.MARKS) == page, "run make results"
    assert (results.SCORES / "transfer.csv").read_text(encoding="utf-8").splitlines()[0] == HEAD


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--policy", "nobody"], "found 'nobody', needed go_to_goal, a policy folder or one of coco_best"),
        (["--policy", "zoo:vint"], "found 'zoo:vint'"),
        (["--policy", "go_to_goal", "--shifts", "fog"], "--shifts: found 'fog'"),
        (["--policy", "go_to_goal", "--set", "fog=1"], "--set: found 'fog'"),
        (["--policy", "go_to_goal", "--set", "latency=[0.5,"], "--set latency"),
        (["--policy", "go_to_goal", "--set", "latency=[0.5, 0.1]"], r"latency[1]"),
        (["--policy", "go_to_goal", "--places", "moon"], "--places: found 'moon'"),
        (["--policy", "go_to_goal", "--episodes", "0"], "--episodes"),
        (["--policy", "go_to_goal", "--seconds", "nan"], "--seconds"),
        (["--policy", "go_to_goal", "--scenes", "nowhere"], "nowhere"),
    ],
)
def test_bad_options_are_one_sentence(
    words: list[str], said: str, tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str], monkeypatch
) -> None:
    monkeypatch.setattr(transfer.os, "environ", {})
    assert transfer.main(["--out", str(tmp_path), *words]) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ")
    assert said in error
    assert error.count("\n") == 1
    assert not list(tmp_path.rglob("*.json"))


def test_a_policy_that_needs_what_no_sensor_gives_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    found = types.SimpleNamespace(privileged=True, sees_goal=False, record=None, sees=False, size=None)
    monkeypatch.setattr("urbanverse_mjx.evaluation.external.load_callable", lambda name: found)
    with pytest.raises(ValidationError, match="no sensor gives"):
        transfer.load_task(transfer.TestedPolicy("x", "pkg:privileged", "coco"))
