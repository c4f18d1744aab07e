"""External policies: their observations, their actions, and errors of one sentence."""

import dataclasses
import pathlib
from typing import Any

import numpy as np
import pytest

from tests.support.onnx_bytes import linear_policy
from tests.support.unicycle import unicycle_env
from urbanverse_mjx.datatypes import BenchmarkReport, SceneBank, ValidationError
from urbanverse_mjx.envs import registry
from urbanverse_mjx.evaluation import Rollout, fixed_episodes, go_to_goal
from urbanverse_mjx.evaluation.external import load_callable
from urbanverse_mjx.evaluation.frozen import freeze
from urbanverse_mjx.evaluation.onnx_policy import load_onnx
from urbanverse_mjx.pipeline import BenchmarkOptions, benchmark


class Remembering:
    """Heads for the goal, and counts how often it was asked."""

    observations = ("goal",)

    def __init__(self) -> None:
        self.asked = 0
        self.begun: list[int] = []

    def begin(self, count: int) -> None:
        self.begun.append(count)

    def __call__(self, obs: dict[str, np.ndarray]) -> np.ndarray:
        assert self.begun
        self.asked += 1
        return obs["goal"] / np.maximum(np.linalg.norm(obs["goal"], axis=1, keepdims=True), 1e-6)


def wrong_shape(obs: dict[str, np.ndarray]) -> np.ndarray:
    return np.zeros(2)


NUMBER = 3


class Asking:
    """Stands still, and records its inputs."""

    def __init__(self) -> None:
        self.given: set[tuple[str, ...]] = set()

    def __call__(self, obs: dict[str, np.ndarray]) -> np.ndarray:
        self.given.add(tuple(sorted(obs)))
        return np.zeros((len(obs["goal"]), 2), np.float32)


class AskingForTheGoal(Asking):
    observations = ("goal",)


class AskingForMore(Asking):
    observations = ("goal", "privileged")


class AskingForWhatIsNotThere(Asking):
    observations = ("goal", "lidar")


@pytest.mark.extended
def test_a_callable_drives_as_the_same_rule_inside_jax(small_bank: SceneBank) -> None:
    env = unicycle_env(small_bank, {"terminate_off_traversable": False, "episode_length": 120})
    episodes = fixed_episodes(env, 6)
    policy = load_callable(f"{__name__}:Remembering")
    assert not policy.sees
    outside, routes = Rollout(env).run_batch("rule", policy, episodes)
    inside, _ = Rollout(env).run({"rule": go_to_goal}, episodes)
    for a, b in zip(outside, inside, strict=True):
        assert (a.result, a.steps, a.touches) == (b.result, b.steps, b.touches)
        assert a.path_length == pytest.approx(b.path_length, abs=0.02)
    assert policy.agent.begun == [6]  # type: ignore[attr-defined]
    assert policy.agent.asked == len(routes.xpos) == max(r.steps for r in outside)  # type: ignore[attr-defined]


def test_what_is_no_callable_is_refused(small_bank: SceneBank) -> None:
    with pytest.raises(ValidationError, match=r"found no module 'nowhere\.at_all'"):
        load_callable("nowhere.at_all:act")
    with pytest.raises(ValidationError, match="found no 'absent' in"):
        load_callable(f"{__name__}:absent")
    with pytest.raises(ValidationError, match="to be a int, needed something to call"):
        load_callable(f"{__name__}:NUMBER")
    env = unicycle_env(small_bank, vision=True)
    with pytest.raises(ValidationError, match=r"found actions of shape \(2,\), needed finite ones of shape \(3, 2\)"):
        Rollout(env).run_batch("bad", load_callable(f"{__name__}:wrong_shape"), fixed_episodes(env, 3))
    blind = unicycle_env(small_bank)
    with pytest.raises(ValidationError, match="found no observation 'pixels/front' in the environment"):
        Rollout(blind).run_batch("bad", load_callable(f"{__name__}:wrong_shape"), fixed_episodes(blind, 3))


@pytest.mark.parametrize(
    ("policy", "given", "privileged"),
    [
        ("Asking", ("goal", "pixels/front"), False),
        ("AskingForTheGoal", ("goal",), False),
        ("AskingForMore", ("goal", "privileged"), True),
    ],
)
def test_a_callable_is_given_exactly_the_observations_that_it_declares(
    policy: str, given: tuple[str, ...], privileged: bool, small_bank: SceneBank
) -> None:
    env = unicycle_env(small_bank, {"terminate_off_traversable": False, "episode_length": 3}, vision=True)
    found = load_callable(f"{__name__}:{policy}")
    Rollout(env).run_batch("asking", found, fixed_episodes(env, 3))
    assert found.agent.given == {given}  # type: ignore[attr-defined]
    assert (found.privileged, found.sees) == (privileged, "pixels/front" in given)


def test_an_observation_that_no_environment_has_is_refused() -> None:
    with pytest.raises(ValidationError, match=r"found the observation 'lidar' .* needed some of pixels/front, goal"):
        load_callable(f"{__name__}:AskingForWhatIsNotThere")


@pytest.mark.parametrize("policy", [f"{__name__}:AskingForTheGoal", f"{__name__}:AskingForMore"])
def test_the_report_says_where_a_policy_was_told_more_than_its_sensors_measure(
    policy: str, small_bank: SceneBank, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    hashes = {name: f"{i}" * 64 for i, name in enumerate(small_bank.scene_ids)}
    bank = dataclasses.replace(small_bank, meta={**small_bank.meta, "hashes": hashes})
    protocol, scenes = tmp_path / "boxes.json", tmp_path / "bank.npz"
    freeze("boxes", bank, 5, seed=0).save(protocol)
    bank.save(scenes)

    def kinematic(name: str, config: Any, bank: SceneBank) -> Any:
        return unicycle_env(bank, {"episode_length": 3, "scenes": config.scenes})

    monkeypatch.setattr(registry, "load", kinematic)
    options = BenchmarkOptions(policy=policy, contact="ends", pictures=False)
    page = benchmark(str(protocol), tmp_path, options, scenes).page
    record = BenchmarkReport.load(tmp_path / "ends" / "report.json").record
    asked = policy.endswith("ForMore")
    assert record["policy"]["privileged"] is asked  # type: ignore[index]
    assert ("privileged: true" in page) is asked


def test_an_onnx_file_answers_as_its_weights_say(tmp_path: pathlib.Path) -> None:
    weights = np.array([[0.5, 0.1], [0.0, -1.0]])
    goal = np.random.default_rng(0).normal(size=(4, 2)).astype(np.float32)
    for batch in ("n", 1):
        path = tmp_path / f"policy_{batch}.onnx"
        path.write_bytes(linear_policy(weights, batch))
        policy = load_onnx(path)
        assert not policy.sees
        np.testing.assert_allclose(policy.agent({"goal": goal}), goal @ weights, rtol=1e-5, atol=1e-6)
    with pytest.raises(ValidationError, match="found no file"):
        load_onnx(tmp_path / "absent.onnx")
    path.write_bytes(b"no model")
    with pytest.raises(ValidationError, match="that onnxruntime cannot load"):
        load_onnx(path)


def test_an_onnx_file_sees_images_as_it_wants_them(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "seeing.onnx"
    path.write_bytes(linear_policy(np.zeros((2, 2)), image=("n", 3, 12, 16)))
    policy = load_onnx(path)
    assert (policy.sees, policy.size) == (True, (12, 16))
    images = np.random.default_rng(0).integers(0, 256, (2, 12, 16, 3), dtype=np.uint8)
    found = policy.agent({"goal": np.zeros((2, 2), np.float32), "pixels/front": images})
    expected = images.reshape(2, -1).mean(1) / 255
    np.testing.assert_allclose(found, np.stack([expected, expected], 1), rtol=1e-4)
