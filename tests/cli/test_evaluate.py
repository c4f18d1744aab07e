"""`urbanverse evaluate` and the evaluation after `urbanverse train`, each to its report."""

import dataclasses
import json
import pathlib
import shutil
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest
from brax.training.acme import running_statistics, specs

from tests.support.agent_appearances import with_box_agents
from tests.support.unicycle import GoalImage, UnicycleEngine, unicycle_env, unicycle_robot
from urbanverse_mjx.cli.evaluate import main as evaluate
from urbanverse_mjx.cli.train import main as train
from urbanverse_mjx.datatypes import BenchmarkReport, Bodies, SceneBank, SimState, ValidationError
from urbanverse_mjx.envs import NavEnv, registry
from urbanverse_mjx.pipeline import banks, evaluation, quick_bank, training_run
from urbanverse_mjx.pipeline.evaluation import NUM_SHOWN, evaluate_policy
from urbanverse_mjx.pipeline.rollout_video import random_draw
from urbanverse_mjx.simulation.collision_slots.body_slots import Sizes
from urbanverse_mjx.simulation.collision_slots.body_table import body_table
from urbanverse_mjx.training.config import default_ppo_config
from urbanverse_mjx.training.policy import PolicySpec, initial_params, save_policy
from urbanverse_mjx.viz import video

SMALL_PPO = {
    "num_envs": 2,
    "num_timesteps": 8,
    "num_checkpoints": 1,
    "unroll_length": 4,
    "minibatch": 4,
    "num_updates_per_batch": 1,
    "network.layers": ((8, 4, 4), (8, 2, 2)),
}
#: One pedestrian and one movable object.
SMALL_STREET = {
    **{f"crowd.slots.{kind}": 0 for kind in ("wheelchair", "scooter", "cyclist", "car")},
    "crowd.slots.pedestrian": 1,
    "movable.bodies": 1,
    "movable.awake": 1,
    "movable.hulls": 1,
    "episode_length": 4,
    "vision_config.height": 20,
    "vision_config.width": 20,
}


class MovableEngine(UnicycleEngine):
    """The kinematic engine with movable objects that stay at rest."""

    def __init__(self, bank: SceneBank, sizes: Sizes, *args: Any) -> None:
        super().__init__(*args)
        self._rows, self._number = body_table(bank).row, sizes.bodies

    @property
    def body_rows(self) -> np.ndarray:
        return self._rows

    @property
    def num_bodies(self) -> int:
        return self._number

    def init(self, scene: Any, qpos: Any, qvel: Any, objects: Any = None) -> SimState:
        zero = jnp.zeros((self._number, 3))
        bodies = Bodies(objects, zero, jnp.zeros((self._number, 4)), zero, zero, zero)
        return super().init(scene, qpos, qvel)._replace(bodies=bodies)

    def step(self, state: SimState, ctrl: Any, agents: Any = None) -> SimState:
        return super().step(state, ctrl, agents)._replace(bodies=state.bodies)


class BodyImage(GoalImage):
    """A renderer that needs the poses of movable objects."""

    def check(self, bodies: Bodies | None) -> None:
        assert bodies is not None
        assert bodies.position.shape[-1] == 3


def kinematic(name: str, config: Any, bank: SceneBank) -> NavEnv:
    """The environment of `registry.load`, on the kinematic engine."""
    assert name == "CocoNav"
    robot = unicycle_robot()
    sizes = Sizes(**config.movable.to_dict())
    engine = MovableEngine(bank, sizes, robot, config.ctrl_dt, jnp.inf, config.scenario == "dynamic")
    return NavEnv(config, bank, robot, engine, BodyImage())


@pytest.fixture(scope="module")
def untrained(small_bank: SceneBank, tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """A policy folder whose networks saw no training, made for the kinematic engine."""
    config = registry.with_overrides(registry.get_default_config("CocoNav", "cpu"), SMALL_STREET)
    env = kinematic("CocoNav", config, small_bank)
    ppo = registry.with_overrides(default_ppo_config("cpu"), SMALL_PPO)
    spec = PolicySpec.of("CocoNav", env, ppo, 0)
    shapes = {name: tuple(shape) for name, shape in spec.observations.items()}
    _, actor, critic = initial_params(shapes, spec.action_size, ppo, 1)
    # Brax writes the state of its normaliser, too, which our networks do not use.
    normaliser = running_statistics.init_state(specs.Array((2,), jnp.dtype("float32")))
    return save_policy(tmp_path_factory.mktemp("policy"), (normaliser, actor, critic), spec)


@pytest.fixture
def policy(untrained: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> pathlib.Path:
    """The same, where `registry.load` gives the kinematic engine."""
    monkeypatch.setattr(registry, "load", kinematic)
    return untrained


@pytest.mark.extended
@pytest.mark.parametrize("dynamic", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_a_policy_that_knows_movable_objects_is_evaluated_to_its_report(
    policy: pathlib.Path, small_bank: SceneBank, tmp_path: pathlib.Path, dynamic: bool
) -> None:
    summary = evaluate_policy(policy, small_bank, tmp_path, 2, 0, False, True, "all", dynamic)
    assert set(summary) == {"untrained", "trained", "go_to_goal", "trained_blank_image"}
    report = BenchmarkReport.load(tmp_path / "report.json")
    assert len(report.episodes) == 8
    assert report.title.endswith("2 fixed episodes"), "streets that it was trained on are not called unseen"
    assert (report.episodes[0].people_distance is not None) == dynamic


@pytest.mark.slow
def test_training_among_people_and_movable_objects_ends_in_its_report(
    small_bank: SceneBank, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Both commands on the real engine and renderer: `train` with scenario=dynamic, then `evaluate --dynamic`."""
    bank = tmp_path / "bank.npz"
    with_box_agents(small_bank).save(bank)
    monkeypatch.setenv("URBANVERSE_BANK", str(bank))
    overrides = json.dumps({"scenario": "dynamic", **SMALL_STREET})
    run = ["--preset", "cpu", "--playground-config-overrides", overrides, "--ppo-overrides", json.dumps(SMALL_PPO)]
    common = ["--num-episodes", "2", "--quiet"]
    assert train([*run, *common, "--logdir", str(tmp_path), "--suffix", "dynamic"]) == 0
    result = json.loads(capsys.readouterr().out.splitlines()[-1])
    folder = pathlib.Path(result["folder"])
    assert result["trained"]["people_distance"]["mean"] >= 0.0
    assert (folder / "evaluation" / "rollout.mp4").stat().st_size > 0
    assert evaluate([str(folder), "--dynamic", *common, "--no-video", "--out", str(tmp_path / "again")]) == 0
    again = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert again["trained"] == result["trained"], "the same episodes, and the same on a CPU to the bit"


@pytest.mark.extended
@pytest.mark.parametrize("name", ["go_to_goal", "planner"])
def test_a_scripted_policy_is_evaluated_by_its_name(
    name: str,
    small_bank: SceneBank,
    tmp_path: pathlib.Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    short = registry.with_overrides(registry.get_default_config("CocoNav"), {"episode_length": 3})
    monkeypatch.setattr(registry, "get_default_config", lambda *_: short)
    monkeypatch.setattr(registry, "load", lambda _, config, bank: unicycle_env(bank, {"episode_length": 3}))
    monkeypatch.setattr(banks, "ensure_default_bank", lambda *_, **__: small_bank)
    assert evaluate([name, "--num-episodes", "3", "--no-video", "--quiet", "--out", str(tmp_path)]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said[name]["n"] == 3
    report = BenchmarkReport.load(tmp_path / "report.json")
    assert {r.agent for r in report.episodes} == {name}
    assert report.record["privileged"] is (name == "planner")
    assert report.title.endswith("3 fixed episodes on unseen streets")


@pytest.mark.parametrize("preset", ["quick", "cpu"])
def test_a_policy_is_evaluated_on_the_streets_of_its_preset(
    preset: str, untrained: pathlib.Path, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As the evaluation at the end of its training."""
    folder = tmp_path / "policy"
    shutil.copytree(untrained, folder)
    spec = PolicySpec.load(folder)
    dataclasses.replace(spec, env_config={**spec.env_config, "preset": preset}).save(folder)
    monkeypatch.setattr(quick_bank, "ensure_quick_bank", lambda *_, **__: "quick streets")
    monkeypatch.setattr(banks, "ensure_default_bank", lambda *_, **__: "shipped streets")
    used: list[Any] = []
    monkeypatch.setattr(evaluation, "evaluate_policy", lambda _, bank, *__, **___: used.append(bank) or {})
    assert evaluate([str(folder), "--quiet"]) == 0
    assert used == ["quick streets" if preset == "quick" else "shipped streets"]


def test_reports_of_other_settings_stay(
    untrained: pathlib.Path, small_bank: SceneBank, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`evaluate RUN --dynamic` after `evaluate RUN`: both reports are needed for the comparison."""
    monkeypatch.setattr(training_run, "bank_of", lambda *_: small_bank)
    folders: list[pathlib.Path] = []
    monkeypatch.setattr(evaluation, "evaluate_policy", lambda _, __, folder, *___, **____: folders.append(folder) or {})
    run = str(untrained)
    for options in ([], ["--dynamic"], ["--env-name", "Go2Nav"], ["--scenes", "all,x"], ["--bank", "a/mine.npz"]):
        assert evaluate([run, *options, "--quiet"]) == 0
        assert evaluate(["planner", *options, "--quiet"]) == 0
    assert folders[:4] == [
        untrained / "evaluation",
        pathlib.Path("runs/evaluate-planner"),
        untrained / "evaluation-dynamic",
        pathlib.Path("runs/evaluate-planner-dynamic"),
    ]
    for value in ("1", "2"):
        evaluate(["planner", "--playground-config-overrides", f'{{"episode_length": {value}}}', "--quiet"])
    evaluate(["planner", "--seed", "3", "--quiet"])
    evaluate(["planner", "--preset", "cpu", "--quiet"])
    assert len(set(folders)) == len(folders)
    assert all(folder.name.startswith(("evaluation", "evaluate-planner")) for folder in folders)


def test_what_is_neither_a_folder_nor_a_rule_is_refused() -> None:
    with pytest.raises(
        ValidationError, match="found 'go_to_gaol', needed a policy or run folder, or one of zero, random"
    ):
        evaluate(["go_to_gaol"])
    with pytest.raises(ValidationError, match="ONNX files are scored by `urbanverse benchmark`"):
        evaluate(["student.onnx"])


@pytest.mark.extended
def test_the_video_shows_a_random_draw_with_how_each_episode_ended(
    policy: pathlib.Path, small_bank: SceneBank, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The draw is the same whatever the episodes' outcomes, and the outcomes handed to the image are the report's."""
    shown: dict[str, Any] = {}
    monkeypatch.setattr(video, "write_rollout_video", lambda *_, **given: shown.update(given))
    evaluate_policy(policy, small_bank, tmp_path, 9, 5, True, True, "all")
    own = [r for r in BenchmarkReport.load(tmp_path / "report.json").episodes if r.agent == "trained"]
    assert not any(r.success for r in own), "nobody arrives within four steps"
    drawn = random_draw(range(9), NUM_SHOWN, 5)
    assert len(drawn) == NUM_SHOWN
    assert shown["columns"] == [9 + i for i in drawn], "`trained` is the second agent of its batch"
    assert shown["outcomes"] == [own[i].outcome for i in drawn]
    assert {tuple(random_draw(range(9), NUM_SHOWN, seed)) for seed in range(9)} - {(0, 1, 2)}
