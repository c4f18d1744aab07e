"""Other engines in the same street: they drive as C MuJoCo drives, rows are kept and continued, and become the page."""

import dataclasses
import json
import os
import pathlib
import subprocess
import sys
from types import SimpleNamespace
from typing import Any

import mujoco
import numpy as np
import pytest
from PIL import Image

from benchmarks import peers
from benchmarks.lib import memory
from benchmarks.lib.peers import page, plan, timed
from benchmarks.lib.peers.c_peer import Processes, Rollout
from benchmarks.lib.peers.plan import Case
from benchmarks.lib.peers.street import Cut, Drive, commands, hulls_of, make_drive, street_spec, with_robot
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.robots import make_coco

ROBOT = make_coco()
SUBSTEPS = 10


def box(name: str, size: tuple[float, float, float], place: str, group: int) -> tuple[str, str]:
    """Mesh and geom of a box that stands on its place."""
    corners = [(x * size[0] / 2, y * size[1] / 2, z * size[2]) for x in (-1, 1) for y in (-1, 1) for z in (0, 1)]
    vertices = " ".join(f"{c:g}" for corner in corners for c in corner)
    passes = 'contype="0" conaffinity="0"' if group == 2 else ""
    mesh = f'<mesh name="{name}" vertex="{vertices}" inertia="convex"/>'
    return mesh, f'<geom name="{name}" type="mesh" mesh="{name}" group="{group}" pos="{place}" mass="0" {passes}/>'


def street(folder: pathlib.Path, wall: float, bins: int = 0) -> pathlib.Path:
    """A compiled street as far as peers read it: ground at z 0, a wall across at x = `wall` m that is also seen, and
    bins far behind. The robots start at x = 0 and look at the wall."""
    ground = box("ground/road/0", (40.0, 8.0, 0.5), "0 0 -0.5", 3)
    bodies = [("wall", box("wall/hull_0", (0.4, 6.0, 1.0), "0 0 0", 3), box("seen", (0.4, 6.0, 1.0), "0 0 0", 2))]
    bodies += [(f"bin_{i}", box(f"bin_{i}/hull_0", (0.3, 0.3, 0.5), "0 0 0", 3)) for i in range(bins)]
    places = [f"{wall} 0 0", *(f"-15 {i} 0" for i in range(bins))]
    geoms = ground[1] + "".join(
        f'<body name="{name}" pos="{place}">{"".join(geom for _, geom in boxes)}</body>'
        for (name, *boxes), place in zip(bodies, places, strict=True)
    )
    meshes = ground[0] + "".join(mesh for _, *boxes in bodies for mesh, _ in boxes)
    folder.mkdir(parents=True)
    (folder / "scene.xml").write_text(
        f'<mujoco><compiler angle="radian"/><asset>{meshes}</asset><worldbody>{geoms}</worldbody></mujoco>'
    )
    np.savez(folder / "episodes.npz", start=np.array([[0.0, 0.0, 0.0, 0.0], [-2.0, 1.0, 0.0, 0.3]]))
    return folder


@pytest.fixture(scope="module")
def streets(tmp_path_factory: pytest.TempPathFactory) -> list[pathlib.Path]:
    """The wall 2 m ahead, and 4 m ahead with more hulls."""
    root = tmp_path_factory.mktemp("scenes")
    return [street(root / "a", 2.0), street(root / "b", 4.0, bins=3)]


def drive_in(folders: list[pathlib.Path], count: int = 4, episode: int = 4) -> Drive:
    return make_drive(folders, ROBOT, count, substeps=SUBSTEPS, control=0.1, episode=episode, steps=5)


def stepped(folders: list[pathlib.Path], drive: Drive, steps: int) -> np.ndarray:
    """(n, nq) positions by `mj_step` alone, env by env: the reference."""
    models = [with_robot(street_spec(folder, seen=False), ROBOT, drive.timestep) for folder in folders]
    found = []
    for env in range(drive.count):
        model = models[drive.scene[env]]
        data = mujoco.MjData(model)
        data.qpos[:] = drive.qpos[env]
        for step in range(steps):
            if (env + step) % drive.episode == 0:
                mujoco.mj_resetData(model, data)
                data.qpos[:] = drive.qpos[env]
            data.ctrl[:] = drive.ctrl[step % len(drive.ctrl), env]
            mujoco.mj_step(model, data, drive.substeps)
        found.append(data.qpos.copy())
    return np.array(found)


def test_a_street_is_one_model_with_one_moving_body(streets: list[pathlib.Path]) -> None:
    model = with_robot(street_spec(streets[1], seen=False), ROBOT, 0.01)
    assert hulls_of(model) == 5  # ground, wall and three bins
    assert not model.geom_bodyid[:5].any()  # objects are no bodies
    own = mujoco.MjModel.from_xml_string(ROBOT.mjcf)
    assert (model.nq, model.nv, model.nu) == (own.nq, own.nv, own.nu)
    assert model.nmesh == own.nmesh + 5  # not the wall that is seen
    assert with_robot(street_spec(streets[1], seen=True), ROBOT, 0.01).nmesh == own.nmesh + 6
    cut = street_spec(streets[1], seen=False, cut=Cut(np.array([0.0, 0.0]), hulls=1, prisms=1))
    assert {geom.name for geom in cut.geoms} == {"ground/road/0", "wall/hull_0"}
    with pytest.raises(ValidationError, match="found no scene that MuJoCo reads"):
        street_spec(streets[0].parent, seen=False)


def test_the_drive_starts_at_the_episodes_of_each_street(streets: list[pathlib.Path]) -> None:
    drive = drive_in(streets, count=5)
    assert drive.scene.tolist() == [0, 1, 0, 1, 0]
    assert drive.qpos[:, 0].tolist() == [0.0, 0.0, -2.0, -2.0, 0.0]
    assert drive.qpos[0, 2] == ROBOT.spawn_height
    assert drive.qpos[2, 6] == pytest.approx(np.sin(0.15))
    assert [np.flatnonzero(drive.begins(step)).tolist() for step in range(4)] == [[0, 4], [3], [2], [1]]
    assert np.array_equal(drive.commands(7), drive.ctrl[2])
    with pytest.raises(ValidationError, match=r"found no episodes\.npz"):
        drive_in([streets[0].parent])


def test_rollout_drives_as_mj_step(streets: list[pathlib.Path]) -> None:
    """Into the wall and with new beginnings; in two calls, so that the state is kept between them."""
    drive = dataclasses.replace(drive_in(streets[:1], episode=14), ctrl=np.full((1, 4, 4), 18.0, np.float32))
    peer = Rollout(streets[0], ROBOT, drive, 2)
    peer.run(3)
    peer.run(22)
    reference = stepped(streets[:1], drive, 25)
    # It begins each control step without the last accelerations, so the solver ends elsewhere within its tolerance.
    assert np.abs(peer.qpos() - reference)[:, :3].max() < 1e-4
    assert 1.3 < reference[0, 0] < 1.8  # at the wall, after a new beginning; its face is at 1.8 m
    peer.close()


def test_processes_have_a_street_of_its_own_for_each_env(streets: list[pathlib.Path]) -> None:
    drive = dataclasses.replace(drive_in(streets, count=3, episode=30), ctrl=np.full((1, 3, 4), 18.0, np.float32))
    peer = Processes(streets, ROBOT, drive, None, 2, "egl")
    try:
        peer.run(25)
        assert np.abs(peer.qpos() - stepped(streets, drive, 25)).max() < 1e-9
        assert peer.qpos()[0, 0] < 1.8 < peer.qpos()[1, 0] < 3.8  # each is held by its own wall
        assert peer.hulls == 5
    finally:
        peer.close()


def test_a_process_that_fails_says_why(streets: list[pathlib.Path]) -> None:
    wrong = dataclasses.replace(drive_in(streets[:1], count=1), ctrl=np.zeros((1, 1, 9), np.float32))
    peer = Processes(streets[:1], ROBOT, wrong, None, 1, "egl")
    with pytest.raises(RuntimeError, match="broadcast"):
        peer.run(1)
    peer.close()


@pytest.mark.slow
@pytest.mark.parametrize("calls", ["control", "mjlab"])
@pytest.mark.parametrize("number", [1, 2])
def test_mujoco_warp_drives_as_mj_step(streets: list[pathlib.Path], calls: str, number: int) -> None:
    from benchmarks.lib.peers.warp_peer import MujocoWarp

    drive = drive_in(streets[:number], episode=9)
    drive = dataclasses.replace(drive, ctrl=np.full((1, 4, 4), 18.0, np.float32))
    peer = MujocoWarp(streets[:number], ROBOT, drive, None, calls)
    peer.run(12)
    assert np.abs(peer.qpos() - stepped(streets[:number], drive, 12))[:, :3].max() < 1e-3
    assert peer.hulls == (2 if number == 1 else 5)


@pytest.mark.slow
def test_mujoco_warp_draws_what_the_robot_sees(streets: list[pathlib.Path]) -> None:
    """The wall fills the middle of the image; the images of envs at other places differ."""
    from benchmarks.lib.peers.warp_peer import MujocoWarp

    drive = drive_in(streets[:1], count=2)
    peer = MujocoWarp(streets[:1], ROBOT, drive, (12, 16), "control")
    peer.run(1)
    first, second = (peer.image(env).reshape(12, 16, 3) for env in range(2))
    assert first[6, 8].max() > 0
    assert (first != second).any()


@pytest.mark.slow
def test_c_mujoco_draws_what_the_robot_sees(streets: list[pathlib.Path]) -> None:
    """The wall is larger in the image of the env that begins nearer to it, and where there is no OpenGL it says so."""
    drive = drive_in(streets[:1], count=2)
    try:
        peer = Processes(streets[:1], ROBOT, drive, (24, 32), 1, "egl")
    except RuntimeError as error:
        pytest.skip(f"no OpenGL: {error}")
    try:
        peer.run(1)
        near, far = ((peer.image(env).max(-1) > 20).mean() for env in range(2))
        assert 0.02 < far < near < 0.9
    finally:
        peer.close()


@pytest.mark.slow
def test_stock_mjx_drives_as_mj_step(streets: list[pathlib.Path]) -> None:
    from benchmarks.lib.peers.jax_peer import stock_mjx

    drive = drive_in(streets[:1], count=2, episode=9)
    peer = stock_mjx(streets[:1], ROBOT, drive, 12)
    peer.run(6)
    assert np.abs(peer.qpos() - stepped(streets[:1], drive, 6))[:, :3].max() < 1e-3


def test_commands_are_the_robots_own() -> None:
    found = commands(ROBOT, 3, 2, 0.2, seed=1)
    waypoint = np.random.default_rng(1).uniform(-1, 1, (3, 2, 2))[2, 1] * (0.5, 1.0) + (0.5, 0.0)
    expected = ROBOT.command(np.stack(ROBOT.waypoint_to_velocity(waypoint, 0.2)))
    assert np.allclose(found[2, 1], expected, atol=1e-4)


class Counted:
    """A peer whose control steps take 2 s by the clock that it puts forward."""

    does, hulls, clock = "counts", 7, 0.0

    def __init__(self) -> None:
        self.runs: list[int] = []
        type(self).clock += 5.0  # compilation

    def run(self, steps: int) -> None:
        self.runs.append(steps)
        type(self).clock += 2.0 * steps + (1.0 if len(self.runs) == 4 else 0.0)

    def qpos(self) -> np.ndarray:
        return np.array([[3.0 * len(self.runs), 0.0, 0.3], [0.0, 0.0, 0.3 - 9.0 * len(self.runs)]])

    def image(self, env: int) -> np.ndarray:
        raise NotImplementedError

    def close(self) -> None:
        pass


def test_the_rate_is_that_of_the_median_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(timed, "time", SimpleNamespace(perf_counter=lambda: Counted.clock))
    peer, row = timed.timed(Counted, 2, repeats=3, seconds=8.0, most=20)
    assert isinstance(peer, Counted)
    assert peer.runs == [1, 1, 4, 4, 4]  # 4 steps of 2 s are the 8 s that were asked for
    assert row["env_steps_per_s"] == 2 * 4 / 8.0
    assert row["env_steps_per_s_spread"] == 1.0 / 8.0
    assert row["compile_s"] == 5.0 + 2.0
    assert row["driven_m"] == 15.0  # of the env that is still on the street
    assert row["lost_share"] == 0.5


@pytest.mark.parametrize(("each", "expected"), [(0.5, 2), (100.0, 1), (1e-9, 20), (0.0, 20)])
def test_steps_fill_the_time_of_a_run(each: float, expected: int) -> None:
    assert timed.steps_for(each, 1.0, 20) == expected


def row(peer: str, count: int = 64, rate: float | None = 100.0, **more: Any) -> dict[str, Any]:
    same = {"benchmark": "peers", "peer": peer, "num_envs": count, "streets": 1, "pixels": "none"}
    found = (
        {"error": "no end within 5 s"} if rate is None else {"env_steps_per_s": rate, "env_steps_per_s_spread": 0.05}
    )
    made = {"compile_s": 3.2, "gpu_mib": 2048.0, "hulls": 797} if rate is not None else {}
    return {**same, **found, **made, "machine": {"device": "cpu", "cores": 2}, **more}


def test_done_cases_are_not_measured_again(tmp_path: pathlib.Path) -> None:
    cases = [Case("warp", 64, 1, "none"), Case("mjx", 64, 1, "none"), Case("warp", 128, 1, "none")]
    path = tmp_path / "rows.jsonl"
    assert peers.left(cases, peers.read_rows(path), again=False) == cases
    rows = [row("mjx", rate=None), row("warp", rate=1.0), row("warp", rate=2.0)]
    path.write_text("\n".join(json.dumps(one) for one in rows) + '\n{"peer": "wa')  # killed in writing
    found = peers.read_rows(path)
    assert [one.get("env_steps_per_s") for one in found] == [None, 2.0]  # of each case the last row
    assert peers.left(cases, found, again=False) == cases[2:]
    assert peers.left(cases, found, again=True) == cases[1:]
    path.write_text('{"peer": 1}\n{}\n')
    with pytest.raises(ValidationError, match="line 1: found no row"):
        peers.read_rows(path)


def test_cases_of_one_process_differ_in_envs_alone() -> None:
    groups = plan.same_process([Case("a", 9, 1, "none"), Case("b", 1, 1, "none"), Case("a", 3, 1, "none")])
    assert [[(case.peer, case.num_envs) for case in group] for group in groups] == [[("a", 3), ("a", 9)], [("b", 1)]]
    assert sorted(case for group in plan.same_process(plan.PLAN) for case in map(repr, group)) == sorted(
        map(repr, plan.PLAN)
    )
    for case in plan.PLAN:  # nothing is planned that an engine cannot do
        case.check()
    assert len(set(plan.PLAN)) == len(plan.PLAN)


@pytest.mark.parametrize(
    ("case", "said"),
    [
        (Case("isaac", 1, 1, "none"), "--peers: found 'isaac', needed some of warp-fused"),
        (Case("warp", 0, 1, "none"), "--num-envs: found 0"),
        (Case("warp", 1, 1, "36"), "needed HEIGHTxWIDTH"),
        (Case("mjx", 1, 2, "none"), "one street for all envs"),
        (Case("mjx", 1, 1, "8x12"), "has no renderer"),
        (Case("mujoco-warp", 1, 2, "8x12"), "images of several streets are not built"),
    ],
)
def test_what_cannot_be_measured_is_a_sentence(case: Case, said: str) -> None:
    with pytest.raises(ValidationError, match=said):
        case.check()


def options(*more: str) -> Any:
    return peers.parse(["--bank", "b", "--scenes", "s", "--rows", "r.jsonl", *more])


def test_streets_are_the_first_by_name(streets: list[pathlib.Path]) -> None:
    args = options("--scenes", str(streets[0].parent))
    assert peers.folders_of(args, 1) == streets[:1]
    with pytest.raises(ValidationError, match="found 2 compiled scenes, needed 9"):
        peers.folders_of(args, 9)


def test_every_combination_is_a_case(capsys: pytest.CaptureFixture[str]) -> None:
    assert peers.cases_of(options()) == list(plan.PLAN)
    found = peers.cases_of(options("--peers", "warp,mjx", "--num-envs", "1,2", "--pixels", "none,8x12"))
    assert len(set(found)) == 8
    assert peers.main(["--bank", "b", "--scenes", "s", "--rows", "r", "--peers", "warp", "--num-envs", "a"]) == 2
    assert "error: --num-envs: found 'a', needed a comma list of numbers." in capsys.readouterr().err
    assert peers.main(["--bank", "b", "--scenes", "s", "--rows", "r", "--peers", "isaac"]) == 2


def test_a_case_that_ends_its_process_is_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    """Workers print what Warp prints, a row, and then die in the second case; the third gets a process of its own that
    hangs, and the fourth one that works."""
    cases = [Case("warp", n, 1, "none") for n in (1, 2, 3, 4)]

    def print_row(n: int) -> str:
        return f"print('Module x load'); print({json.dumps(row('warp', n))!r}, flush=True);"

    codes = [print_row(1) + "raise SystemExit(7)", "import time; time.sleep(60)", print_row(4)]
    asked = []

    def start(_: Any, rest: Any) -> Any:
        asked.append([case.num_envs for case in rest])
        command = [sys.executable, "-c", codes[len(asked) - 1]]
        return subprocess.Popen(command, stdout=subprocess.PIPE, text=True, start_new_session=True)

    monkeypatch.setattr(peers, "_start", start)
    rows = list(peers.isolated(options("--limit", "1.5"), cases, {"device": "cpu"}, float("inf")))
    assert asked == [[1, 2, 3, 4], [3, 4], [4]]
    assert [one["num_envs"] for one in rows] == [1, 2, 3, 4]
    assert [one.get("error", "") for one in rows] == [
        "",
        "the process ended with status 7; see its messages",
        "no end within 1.5 s",
        "",
    ]
    assert rows[2]["machine"] == {"device": "cpu"}


@pytest.mark.extended
def test_a_real_case_becomes_a_row_and_the_next_run_leaves_it_out(
    streets: list[pathlib.Path], tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The command as on a GPU, with C MuJoCo."""
    rows = tmp_path / "rows.jsonl"
    common = ["--bank", "none.npz", "--scenes", str(streets[0].parent), "--rows", str(rows), "--repeats", "2"]
    command = [*common, "--peers", "c-mujoco", "--num-envs", "2", "--seconds", "0.01"]
    assert peers.main(command) == 0
    (first,) = peers.read_rows(rows)
    assert first["env_steps_per_s"] > 0
    assert first["driven_m"] > 0.05
    assert first["lost_share"] == 0.0
    assert first["hulls"] == 2
    capsys.readouterr()
    before = rows.read_text()
    assert peers.main(command) == 0
    assert rows.read_text() == before
    assert peers.main([*command, "--save-baseline", str(tmp_path / "base.json")]) == 0
    assert peers.main([*command, "--compare", str(tmp_path / "base.json")]) == 0
    slower = {**first, "env_steps_per_s": 0.5 * first["env_steps_per_s"]}
    rows.write_text(before + json.dumps(slower) + "\n")
    assert peers.main([*command, "--compare", str(tmp_path / "base.json")]) == 1
    assert "SLOWER 0.500" in capsys.readouterr().err


def test_rows_become_the_page(tmp_path: pathlib.Path) -> None:
    (tmp_path / page.TABLE).write_text(",".join(page.COLUMNS) + "\n")
    assert page.text(page.read(tmp_path)).startswith("Not run yet: `python -m benchmarks.peers")
    rows = [row("warp", 64, 1234.0), row("warp", 1024, 56789.0, gpu_mib=4096.0), row("mjx", rate=None), row("c-mujoco")]
    for _ in range(2):  # replaces its own rows
        assert page.add([*rows, row("warp", 64, 9000.0, pixels="36x64")], tmp_path) == 5
    kept = page.read(tmp_path)
    assert len(kept) == 5
    text = page.text(kept)
    assert "| ours, `warp` | 1 | 797 | 1,234 (5 %) | 56,789 (5 %) | 3 s | 4.0 GiB |" in text
    assert "| stock MJX | 1 |  | none |  |  |  |" in text
    assert "No figure: stock MJX, no images, 64 envs: no end within 5 s." in text
    assert text.index("no images, env-steps/s") < text.index("images of 36x64")
    assert "MuJoCo Warp, 12 streets, no images (1,024 envs)" in text.split("Not run yet: ")[1]
    assert "C MuJoCo, no images (1,024 and 4,096 envs)" in text  # the one with 64 is there
    figure = tmp_path / "peers.png"
    page.draw(kept, figure)
    assert figure.stat().st_size < 60_000
    with Image.open(figure) as image:
        assert image.size[0] > 500
    page.draw([], figure)
    assert not figure.exists()


def test_the_page_is_that_of_the_kept_rows() -> None:
    text = page.PAGE.read_text(encoding="utf-8")
    begin, end = page.MARKS
    assert text.split(begin)[1].split(end)[0].strip() == page.text(page.read()).strip()
    assert page.FIGURE.exists() == bool([one for one in page.read() if not one["error"]])


@pytest.mark.parametrize(("visible", "asked"), [("", []), ("1", ["-i", "1"]), ("GPU-5f, 0", ["-i", "GPU-5f"])])
def test_memory_is_that_of_the_gpu_in_use(visible, asked, tmp_path, monkeypatch) -> None:
    program = tmp_path / "nvidia-smi"
    program.write_text(f'#!/bin/sh\necho "$@" > {tmp_path}/asked\necho 1234\necho 9\n')
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    monkeypatch.setenv("CUDA_VISIBLE_DEVICES", visible)
    assert memory.device_mib() == 1234.0
    assert (tmp_path / "asked").read_text().split()[: len(asked) + 1] == [*asked, "--query-gpu=memory.used"]
