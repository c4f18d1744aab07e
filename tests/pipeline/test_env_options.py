"""`--bank` and `--playground-config-overrides` mean the same to every command that drives."""

import dataclasses
import hashlib
import pathlib
import re
import time
import types
from typing import Any

import pytest

from tests.support.heard_progress import noted
from tests.support.unicycle import unicycle_env
from urbanverse_mjx import progress
from urbanverse_mjx.datatypes import BenchmarkReport, SceneBank, ValidationError
from urbanverse_mjx.envs import NavEnv, registry
from urbanverse_mjx.evaluation import BASELINES
from urbanverse_mjx.evaluation.frozen import freeze
from urbanverse_mjx.pipeline import BenchmarkOptions, PlayOptions, benchmark, evaluate_policy, play, rollout_video
from urbanverse_mjx.pipeline.machines import load_machine

OVERRIDES = {"robot": "/robots/tug", "sim_dt": 0.005}


@pytest.fixture
def loads(monkeypatch: pytest.MonkeyPatch) -> list[tuple[Any, SceneBank]]:
    """Environments are kinematic ones; the config and bank that each was asked for."""
    seen = []

    def kinematic(name: str, config: Any, bank: SceneBank) -> NavEnv:
        seen.append((config, bank))
        return unicycle_env(bank, {"episode_length": 3, "scenes": config.scenes})

    monkeypatch.setattr(registry, "load", kinematic)
    return seen


@pytest.fixture
def bank(small_bank: SceneBank, tmp_path: pathlib.Path) -> pathlib.Path:
    hashes = {name: f"{i}" * 64 for i, name in enumerate(small_bank.scene_ids)}
    dataclasses.replace(small_bank, meta={**small_bank.meta, "hashes": hashes}).save(tmp_path / "bank.npz")
    return tmp_path / "bank.npz"


@pytest.mark.parametrize("policy", ["planner", "folder", "file.onnx"])
def test_a_page_and_a_dataset_drive_by_a_changed_config(
    policy: str,
    small_bank: SceneBank,
    loads: list[Any],
    tmp_path: pathlib.Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    trained = registry.get_default_config("CocoNav", "cpu").to_dict()
    spec = types.SimpleNamespace(environment="CocoNav", env_config=trained)
    monkeypatch.setattr("urbanverse_mjx.training.policy.latest_policy", lambda folder: folder)
    monkeypatch.setattr("urbanverse_mjx.training.policy.load_policy", lambda _: (None, spec))
    file = types.SimpleNamespace(record=spec)
    monkeypatch.setattr("urbanverse_mjx.evaluation.onnx_policy.load_onnx", lambda _: file)
    contents = {"folder": tmp_path / "policy.json", "file.onnx": tmp_path / "file.onnx"}
    sha256 = None
    if policy in contents:
        contents[policy].write_bytes(b"{}")
        sha256 = hashlib.sha256(b"{}").hexdigest()
        policy = str(tmp_path if policy == "folder" else contents[policy])
    assert load_machine(policy, small_bank, overrides=OVERRIDES).policy.sha256 == sha256
    load_machine(policy, small_bank)
    (changed, _), (plain, _) = loads
    assert (changed.robot, changed.sim_dt) == ("/robots/tug", 0.005)
    assert (plain.robot, plain.sim_dt) == (trained["robot"], trained["sim_dt"])


@pytest.mark.extended
def test_play_drives_the_policy_that_it_is_given(
    bank: pathlib.Path, loads: list[Any], tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not go_to_goal, its default, without a word; and among people where it is asked to."""
    monkeypatch.setattr(rollout_video, "write_episodes", lambda *_, **__: None)
    spec = types.SimpleNamespace(
        environment="CocoNav", env_config=registry.get_default_config("CocoNav", "cpu").to_dict()
    )
    monkeypatch.setattr("urbanverse_mjx.training.policy.load_policy", lambda _: (BASELINES["zero"], spec))
    options = PlayOptions(policy=tmp_path, bank=bank, scenes="all")
    done = play(tmp_path / "a.mp4", options)
    assert {r["agent"] for r in done["results"]} == {"trained"}
    with pytest.raises(ValidationError, match=r"--policy: found '.*' beside --agent planner, needed one of them"):
        play(tmp_path / "a.mp4", dataclasses.replace(options, agent="planner"))
    with pytest.raises(ValidationError, match="found 'planner' beside --agent zero, needed one of them"):
        play(tmp_path / "a.mp4", PlayOptions(policy="planner", agent="zero"))
    with pytest.raises(
        ValidationError, match=r"--policy: found 'planer', needed one of zero, .*, planner, or a policy"
    ):
        play(tmp_path / "a.mp4", PlayOptions(policy="planer"))
    with pytest.raises(ValidationError, match="--agent: found 'planer', needed trained, "):
        play(tmp_path / "a.mp4", PlayOptions(agent="planer"))
    with pytest.raises(ValidationError, match="--policy: found nothing, needed a policy or run folder"):
        play(tmp_path / "a.mp4", PlayOptions(agent="trained"))
    with pytest.raises(ValidationError, match="needed a policy or run folder; ONNX files are driven by"):
        play(tmp_path / "a.mp4", dataclasses.replace(options, policy=tmp_path / "a.onnx"))
    for chosen in (dataclasses.replace(options, dynamic=True), PlayOptions(bank=bank, scenes="all", dynamic=True)):
        play(tmp_path / "a.mp4", chosen)
    assert [config.scenario for config, _ in loads] == ["static", "dynamic", "dynamic"]


@pytest.mark.extended
@pytest.mark.parametrize(
    ("named", "agent"),
    [({}, "go_to_goal"), ({"policy": "planner"}, "planner"), ({"agent": "zero"}, "zero")],
    ids=["default", "policy", "agent"],
)
def test_play_drives_a_chosen_bank_by_a_changed_config(
    named: dict[str, Any],
    agent: str,
    bank: pathlib.Path,
    loads: list[Any],
    tmp_path: pathlib.Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def film(path: pathlib.Path, *rest: Any, **style: Any) -> None:
        time.sleep(0.2)
        style["on_progress"](1)
        time.sleep(0.2)
        path.write_bytes(b"film")

    monkeypatch.setattr(rollout_video, "write_episodes", film)
    monkeypatch.setattr(progress, "LINE_EVERY", 0.05)
    options = PlayOptions(**named, bank=bank, scenes="all", env_overrides=OVERRIDES)
    done = play(tmp_path / "a.mp4", options)
    ((config, used),) = loads
    assert (config.robot, config.sim_dt) == ("/robots/tug", 0.005)
    assert used.scene_ids == SceneBank.load(bank).scene_ids
    assert [r["agent"] for r in done["results"]] == [agent] * 2
    said = capsys.readouterr().err
    assert re.search(r"^driving: 0/2 episodes, \d+ s, compiling$", said, re.MULTILINE)
    for drawn in range(2):
        assert re.search(rf"^drawing: {drawn}/2 episodes, \d+ s$", said, re.MULTILINE)
    with pytest.raises(ValidationError, match="needed a navigation environment such as CocoNav"):
        play(tmp_path / "b.mp4", PlayOptions(**named, env_name="Go2Joystick", bank=bank))


@pytest.mark.extended
@pytest.mark.usefixtures("loads")
def test_every_drive_says_that_its_program_compiles_and_when_it_is_done(
    bank: pathlib.Path, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`record` does so in a test of its own."""
    notes: list[tuple[str, str | None]] = []
    monkeypatch.setattr(progress.Progress, "task", noted(notes))
    monkeypatch.setattr(rollout_video, "write_episodes", lambda *_, **__: None)
    freeze("boxes", SceneBank.load(bank), 5, seed=0).save(tmp_path / "boxes.json")
    options = BenchmarkOptions(policy="zero", contact="ends", pictures=False)
    for name, drive in (
        ("driving", lambda: play(tmp_path / "a.mp4", PlayOptions(bank=bank, scenes="all", quiet=True))),
        ("evaluating", lambda: evaluate_policy("zero", SceneBank.load(bank), tmp_path, 2, 0, False, True, "all")),
        ("zero", lambda: benchmark(str(tmp_path / "boxes.json"), tmp_path / "out", options, bank)),
    ):
        notes.clear()
        drive()
        assert [note for task, note in notes if task.startswith(name)][:2] == ["compiling", ""]


def test_evaluate_drives_a_changed_config_and_records_it(
    bank: pathlib.Path, loads: list[Any], tmp_path: pathlib.Path
) -> None:
    scenes, out = SceneBank.load(bank), tmp_path / "report"
    evaluate_policy("zero", scenes, out, 4, 0, False, True, "all", env_overrides={"success_radius": 2.5})
    assert loads[0][0].success_radius == 2.5
    assert BenchmarkReport.load(out / "report.json").record["overrides"] == {"success_radius": 2.5}


def test_a_bank_in_place_of_a_benchmark_is_refused_with_how_to_make_one(bank: pathlib.Path) -> None:
    with pytest.raises(ValidationError, match="json file that `python -m benchmarks"):
        benchmark(str(bank), bank.parent / "out")


def test_a_benchmark_names_overrides_and_keeps_what_it_fixes(
    bank: pathlib.Path, loads: list[Any], tmp_path: pathlib.Path
) -> None:
    freeze("boxes", SceneBank.load(bank), 5, seed=0).save(tmp_path / "boxes.json")
    options = BenchmarkOptions(policy="zero", contact="ends", pictures=False, env_overrides={"num_slots": 24})
    done = benchmark(str(tmp_path / "boxes.json"), tmp_path / "out", options, bank)
    assert loads[0][0].num_slots == 24
    assert 'Config overrides: `{"num_slots": 24}`.' in done.page
    fixed = dataclasses.replace(options, env_overrides={"success_radius": 9.0, "num_slots": 24})
    with pytest.raises(ValidationError, match="found success_radius, which the benchmark fixes"):
        benchmark(str(tmp_path / "boxes.json"), tmp_path / "other", fixed, bank)
    assert not (tmp_path / "other").exists()


@pytest.mark.usefixtures("loads")
@pytest.mark.parametrize(
    ("inside", "title"),
    [("mine/checkpoints/000000000064", "mine/000000000064"), ("coco", "coco")],
    ids=["checkpoint", "policy"],
)
def test_a_table_names_the_run_of_a_checkpoint(
    inside: str, title: str, bank: pathlib.Path, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    freeze("boxes", SceneBank.load(bank), 5, seed=0).save(tmp_path / "boxes.json")
    config = registry.get_default_config("CocoNav", "cpu").to_dict()
    spec = types.SimpleNamespace(environment="CocoNav", env_config=config, observations={}, steps=64, versions={})
    (tmp_path / inside).mkdir(parents=True)
    monkeypatch.setattr("urbanverse_mjx.training.policy.latest_policy", lambda _: tmp_path / inside)
    monkeypatch.setattr("urbanverse_mjx.training.policy.load_policy", lambda _: (BASELINES["zero"], spec))
    options = BenchmarkOptions(policy=str(tmp_path / inside), contact="ends", pictures=False)
    done = benchmark(str(tmp_path / "boxes.json"), tmp_path / "out", options, bank)
    assert f"\n| {title} | " in done.page
    assert "The rows of scenes pool the episodes" in done.page


@pytest.mark.extended
@pytest.mark.parametrize("frozen", [None, "direct"])
def test_a_benchmark_is_driven_under_the_conditions_of_its_list(
    frozen: str | None, bank: pathlib.Path, loads: list[Any], tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Old lists name no conditions; a trained policy keeps the light of its training, but not the friction."""
    protocol = freeze("boxes", SceneBank.load(bank), 5, seed=0)
    if frozen:
        protocol = dataclasses.replace(protocol, conditions={"vision_config.light": frozen, "friction": "uniform"})
    protocol.save(tmp_path / "boxes.json")
    old = registry.get_default_config("CocoNav", "cpu").to_dict()
    del old["vision_config"]["light"], old["friction"]
    spec = types.SimpleNamespace(
        environment="CocoNav", env_config=old, observations={"pixels/front": [27, 48, 3]}, steps=0, versions={}
    )
    monkeypatch.setattr("urbanverse_mjx.training.policy.latest_policy", lambda folder: folder)
    monkeypatch.setattr("urbanverse_mjx.training.policy.load_policy", lambda _: (BASELINES["zero"], spec))
    for number, policy in enumerate(("zero", str(tmp_path))):
        options = BenchmarkOptions(policy=policy, contact="ends", pictures=False)
        benchmark(str(tmp_path / "boxes.json"), tmp_path / f"out{number}", options, bank)
    (scripted, _), (trained, _) = loads
    assert scripted.vision_config.light == (frozen or "baked")
    assert "light" not in trained.vision_config
    assert {scripted.friction, trained.friction} == {"uniform" if frozen else "materials"}
