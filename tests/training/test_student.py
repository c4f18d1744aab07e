"""The student's network, its mirror and an iteration of DAgger."""

import pathlib
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from ml_collections import ConfigDict

from tests.support.unicycle import unicycle_env
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs import NavEnv, State, wrap_for_training
from urbanverse_mjx.envs.navigation.env import MAP_PROBES
from urbanverse_mjx.envs.staged import observed_size
from urbanverse_mjx.evaluation import Rollout, fixed_episodes
from urbanverse_mjx.training import dagger, sequences, snapshot
from urbanverse_mjx.training.map_networks import MAP_SHAPE
from urbanverse_mjx.training.networks import PIXELS
from urbanverse_mjx.training.policy import PolicySpec, load_policy, save_student, untrained_policy
from urbanverse_mjx.training.student import PREDICTED, Student, initial_student, predicted_target
from urbanverse_mjx.training.student_learner import LearnerState

LAYERS = ((4, 4, 4), (4, 2, 2))
SHAPES = {PIXELS: (16, 24, 3), "goal": (2,), "proprio": (5,)}
OVERRIDES = {
    "scenes": "all",
    "episode_length": 40,
    "vision_config.height": 16,
    "vision_config.width": 24,
    "observations.proprio": True,
    "observations.privileged_map": True,
}


def seeing_env(bank: SceneBank) -> NavEnv:
    return unicycle_env(bank, OVERRIDES, vision=True)


def applied(network: Student, *inputs: Any) -> Any:
    return jax.jit(network.apply)(*inputs)


def some_observations(steps: int, n: int) -> dict[str, jax.Array]:
    rng = np.random.default_rng(0)
    pixels = rng.integers(0, 256, (steps, n, *SHAPES[PIXELS]), np.uint8)
    vectors = {k: jnp.asarray(rng.normal(size=(steps, n, *SHAPES[k])), jnp.float32) for k in ("goal", "proprio")}
    return {PIXELS: jnp.asarray(pixels), **vectors}


@pytest.mark.extended
def test_a_student_without_proprioception_acts_on_image_and_goal_alone() -> None:
    obs = some_observations(2, 3)
    begins = jnp.zeros((2, 3), bool)
    for proprio in (True, False):
        network = Student(LAYERS, 2, hidden=16, memory=8, proprio=proprio)
        params = initial_student(network, SHAPES, 0)
        memory = network.first_memory(3)
        whole, *_ = applied(network, params, obs, memory, begins)
        for name in obs:
            other, *_ = applied(network, params, obs | {name: obs[name][:, ::-1]}, memory, begins)
            assert (np.abs(np.asarray(other - whole)).max() > 1e-6) == (proprio or name != "proprio"), name


@pytest.mark.extended
def test_a_student_without_its_last_action_sees_the_speeds() -> None:
    obs, begins = some_observations(2, 3), jnp.zeros((2, 3), bool)
    config = dagger.default_dagger_config()
    config.network.update({"layers": LAYERS, "hidden": 16, "memory": 8, "last_action": False, "bfloat16": False})
    network = dagger.make_student(config, 2)
    params, memory = initial_student(network, SHAPES, 0), network.first_memory(3)
    whole, *_ = applied(network, params, obs, memory, begins)
    for k in range(5):
        other, *_ = applied(network, params, obs | {"proprio": obs["proprio"].at[..., k].add(3.0)}, memory, begins)
        assert (np.abs(np.asarray(other - whole)).max() > 1e-6) == (k < 3), k


@pytest.mark.parametrize("name", ["proprio", "last_action"])
def test_a_policy_from_before_the_choice_sees_proprioception(name: str) -> None:
    config = dagger.default_dagger_config()
    for chosen in (True, False):
        config.network[name] = chosen
        assert getattr(dagger.make_student(config, 2), name) == chosen
    with config.unlocked():
        del config.network[name]
    assert getattr(dagger.make_student(config, 2), name)


@pytest.mark.extended
def test_a_sequence_at_once_is_the_sequence_step_by_step_and_forgets_at_a_begin() -> None:
    network = Student(LAYERS, 2, hidden=16, memory=8)
    params = initial_student(network, SHAPES, 0)
    obs = some_observations(4, 3)
    begins = jnp.zeros((4, 3), bool).at[2, 1].set(True)
    memory = jax.random.normal(jax.random.key(1), (3, 8))
    whole, last, predicted = applied(network, params, obs, memory, begins)
    assert predicted.shape == (4, 3, *PREDICTED)
    each = []
    kept = memory
    for t in range(4):
        one = {k: x[t : t + 1] for k, x in obs.items()}
        action, kept, _ = applied(network, params, one, kept, begins[t : t + 1])
        each.append(action[0])
    np.testing.assert_allclose(whole, jnp.stack(each), atol=1e-5)
    np.testing.assert_allclose(last, kept, atol=1e-5)
    # The memory of env 1 is reset at step 2, that of the others is not.
    other, forgot, _ = applied(network, params, obs, -memory, begins)
    changed = np.abs(np.asarray(other - whole)).max(-1) > 1e-7
    assert changed[:2].all()
    assert not changed[2:, 1].any()
    assert changed[2:, [0, 2]].all()
    np.testing.assert_allclose(forgot[1], last[1], atol=1e-6)


def test_the_map_to_predict_is_the_mean_of_two_by_two_cells() -> None:
    cells = np.random.default_rng(0).integers(0, 256, (5, *MAP_SHAPE)).astype(np.uint8)
    target = np.asarray(predicted_target(jnp.asarray(cells)))
    assert target.shape == (5, *PREDICTED)
    for x, y in ((0, 0), (3, 7), (9, 2)):
        block = cells[:, 2 * x : 2 * x + 2, 2 * y : 2 * y + 2].astype(float)
        np.testing.assert_allclose(target[:, x, y], block.mean((1, 2)) / 255.0, rtol=1e-5)


def test_proprioception_and_the_map_tell_speeds_last_action_and_distances(small_bank: SceneBank) -> None:
    env = seeing_env(small_bank)
    nav = jax.jit(env.begin)(jax.random.key(3))
    nav = jax.jit(env.advance)(nav, jnp.array([0.8, -0.3]))[0]
    obs = jax.jit(env.observe)(nav)
    privileged = np.asarray(obs["privileged"])
    np.testing.assert_allclose(obs["proprio"], [*privileged[6:9], 0.8, -0.3], atol=1e-6)
    assert abs(privileged[6]) > 0.1
    position, quaternion = np.asarray(nav.sim.xpos[1]), np.asarray(nav.sim.xquat[1])
    yaw = 2.0 * np.arctan2(quaternion[3], quaternion[0])
    turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    cells = np.asarray(obs["privileged_map"]).reshape(MAP_SHAPE)
    for x, y in ((0, 0), (12, 3), (19, 15)):
        place = position[:2] + turn @ MAP_PROBES[x, y]
        metres = env._surroundings.distances(nav.sim.scene, jnp.asarray(place))
        np.testing.assert_allclose(cells[x, y] / 100.0, metres, atol=0.0051)
    np.testing.assert_allclose(MAP_PROBES[:, ::-1, 1], -MAP_PROBES[..., 1], atol=1e-6)
    plain = unicycle_env(small_bank, {"scenes": "all"})
    assert set(observed_size(plain)) == {"goal", "privileged"}


def test_seen_in_a_mirror_twice_is_seen_as_it_is() -> None:
    obs = {k: x[0] for k, x in some_observations(1, 4).items()}
    mirrored = jnp.array([True, False, True, False])
    once = sequences.mirrored_view(obs, mirrored)
    np.testing.assert_array_equal(once[PIXELS][0], obs[PIXELS][0, :, ::-1])
    np.testing.assert_array_equal(once["goal"][0], obs["goal"][0] * jnp.array([1, -1]))
    np.testing.assert_array_equal(once["proprio"][0], obs["proprio"][0] * jnp.array([1, -1, -1, 1, -1]))
    for name, twice in sequences.mirrored_view(once, mirrored).items():
        np.testing.assert_array_equal(twice, obs[name])
        np.testing.assert_array_equal(once[name][1], obs[name][1])


def teach(params: None, state: State[Any], key: jax.Array) -> jax.Array:
    """Straight to the goal, with some noise."""
    del params
    goal = state.obs["goal"]
    towards = goal / jnp.maximum(jnp.linalg.norm(goal, axis=-1, keepdims=True), 1e-6)
    return towards + 0.02 * jax.random.normal(key, goal.shape)


@pytest.fixture(scope="module")
def learning(small_bank: SceneBank) -> tuple[NavEnv, ConfigDict, dagger.Dagger]:
    """An env, a config and a compiled training with them."""
    env = seeing_env(small_bank)
    config = dagger.default_dagger_config()
    config.update({"num_envs": 8, "unroll_length": 8, "minibatches": 2, "learning_rate": 3e-3, "warm_up": 320})
    config.network.update({"layers": LAYERS, "hidden": 32, "memory": 8, "bfloat16": False})
    learner = dagger.Dagger(wrap_for_training(env, env.config.episode_length), teach, config)
    learner.compile()
    return env, config, learner


@pytest.mark.extended
def test_a_student_learns_what_its_teacher_does_and_is_loaded_as_saved(
    learning: tuple[NavEnv, ConfigDict, dagger.Dagger], tmp_path: pathlib.Path
) -> None:
    """The teacher drives straight to the goal, which the student observes: a few iterations bring it near."""
    env, config, learner = learning
    losses = []
    state = sequences.run(
        learner, 60, float("inf"), lambda number, state, said: losses.append(said["imitation"]), learner.begin()
    )
    assert np.mean(losses[-5:]) < 0.3 * np.mean(losses[:3])

    spec = PolicySpec.of("CocoNav", env, config, 60 * learner.steps_per_iteration)
    folder = save_student(tmp_path, state.params, spec)
    policy, found = load_policy(folder)
    assert found.steps == 60 * 64
    agents = {"trained": policy, "untrained": untrained_policy(spec)}
    results, _ = Rollout(env).run(agents, fixed_episodes(env, 6))
    distance = {name: np.mean([r.distance_to_goal for r in results if r.agent == name]) for name in agents}
    assert distance["trained"] < 0.8 * distance["untrained"]


def test_a_rollout_keeps_what_each_agent_remembers(small_bank: SceneBank) -> None:
    """An agent that drives for three steps and then stands, which needs a step counter in its memory."""

    class Counts:
        def first_memory(self) -> jax.Array:
            return jnp.zeros((), jnp.int32)

        def act(self, obs: dict, memory: jax.Array, key: jax.Array) -> tuple[jax.Array, jax.Array]:
            return jnp.where(memory < 3, 1.0, 0.0) * jnp.array([1.0, 0.0]), memory + 1

    env = unicycle_env(small_bank, {"scenes": "all", "episode_length": 20})
    agents = {"counts": Counts(), "goes": lambda obs, key: jnp.array([1.0, 0.0])}
    _, poses = Rollout(env, chunk=5).run(agents, fixed_episodes(env, 3))
    moved = np.linalg.norm(np.diff(poses.xpos[:, :, 1, :2], axis=0), axis=-1)
    assert (moved[:3, :3] > 0.05).all()
    assert (moved[4:, :3] < 1e-6).all()
    assert (moved[3, 3:] > 0.05).any()


@pytest.mark.extended
def test_a_training_cut_in_two_ends_with_the_digits_of_one(
    learning: tuple[NavEnv, ConfigDict, dagger.Dagger], tmp_path: pathlib.Path
) -> None:
    """Cut while the teacher still drives: after three of its five iterations."""
    env, config, learner = learning
    kept: list[pathlib.Path] = []

    def on_iteration(number: int, state: LearnerState, reported: dict[str, float]) -> None:
        if number == 3:
            kept.append(snapshot.save_state(tmp_path / "state.npz", state))

    whole = sequences.run(learner, 7, float("inf"), on_iteration, learner.begin())
    state = snapshot.load_state(kept[0], jax.eval_shape(learner.begin))
    assert int(state.steps) == 3
    again = sequences.run(learner, 7, float("inf"), lambda *_: None, state)
    a, b = (snapshot.save_state(tmp_path / f"{k}.npz", x) for k, x in enumerate((whole, again)))
    assert a.read_bytes() == b.read_bytes()

    start = learner.begin().params
    learner.iterate(learner.begin(start), jnp.float32(0.0))
    assert not any(leaf.is_deleted() for leaf in jax.tree.leaves(start)), "only the state's buffers are donated"

    wider = ConfigDict(config.to_dict())
    wider.network.hidden = 24
    other = dagger.Dagger(wrap_for_training(env, env.config.episode_length), teach, wider)
    with pytest.raises(ValidationError, match="other shapes"):
        snapshot.load_state(a, jax.eval_shape(other.begin))
    with pytest.raises(ValidationError, match="found no file"):
        snapshot.load_state(tmp_path / "none.npz", whole)


def test_blurred_sequences_have_softer_edges() -> None:
    images = np.random.default_rng(0).uniform(0, 255, (2, 3, 7, 9, 3))
    pixels = jnp.asarray(images, jnp.uint8)
    key = jax.random.key(0)
    sharp, unsharp = (np.asarray(sequences.relit(pixels, key, 0.2, 0.0, blur), np.float64) for blur in (0.0, 1.0))
    steps = [np.abs(np.diff(x, axis=3)).mean((0, 2, 3, 4)) for x in (sharp, unsharp)]
    assert (steps[1] < 0.98 * steps[0]).all(), "softer edges in every sequence"
    assert len(np.unique((steps[1] / steps[0]).round(3))) == 3, "not alike"


def test_images_are_relit_within_the_asked_share_and_as_often_darker_as_brighter() -> None:
    """Colour by 20 % and brightness by 20 %, each alike in a whole image; noise as a share of the full range."""
    pixels = jnp.full((3, 2000, 2, 2, 3), 100, jnp.uint8)
    found = np.asarray(sequences.relit(pixels, jax.random.key(0), 0.2, 0.0), np.float64)
    assert found.min() >= 63
    assert found.max() <= 145
    assert found.min() < 68
    assert found.max() > 138
    assert found.mean() == pytest.approx(100.0, abs=1.0)
    one = found[:1, :, :1, :1]
    np.testing.assert_array_equal(found, np.broadcast_to(one, found.shape), err_msg="over time and the image")
    ratio = found[0, :, 0, 0, 0] / found[0, :, 0, 0, 1]
    assert ratio.max() > 1.35, "colours change too"
    assert np.median(ratio) == pytest.approx(1.0, abs=0.02)
    grey = np.asarray(sequences.relit(pixels[:1, :50], jax.random.key(1), 0.0, 0.05), np.float64)
    assert grey.std() == pytest.approx(0.05 * 255, rel=0.1)
    assert grey.mean() == pytest.approx(100.0, abs=1.5)
    np.testing.assert_array_equal(sequences.relit(pixels[:1, :2], jax.random.key(1), 0.0, 0.0), pixels[:1, :2])
