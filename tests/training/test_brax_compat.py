"""What replaces parts of JAX and Brax in Brax's PPO."""

import math
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from brax.envs.base import Env, State
from brax.envs.wrappers.training import VmapWrapper
from brax.training import acting
from brax.training.agents.ppo import train as ppo
from brax.training.agents.ppo.networks import PPONetworks
from brax.training.distribution import NormalTanhDistribution
from brax.training.logger import EpisodeMetricsLogger
from brax.training.networks import FeedForwardNetwork
from brax.training.types import Transition

from tests.support.stablehlo import largest_constant
from urbanverse_mjx import table_arguments
from urbanverse_mjx.training import brax_compat


def test_one_device_pmap_is_pmap_on_one_device() -> None:
    """With an axis name, arguments without the axis, and a function that closes over a table."""
    table = jnp.arange(5.0)

    def function(x: jax.Array, y: jax.Array) -> tuple[jax.Array, jax.Array]:
        return jax.lax.psum(x @ table, "i"), jax.lax.pmean(y, "i") + x

    x, y = jnp.arange(10.0).reshape(1, 2, 5), jnp.ones(5)
    one = jax.devices()[:1]
    wanted = jax.pmap(function, axis_name="i", in_axes=(0, None), devices=one)(x, y)
    found = brax_compat.one_device_pmap(function, axis_name="i", in_axes=(0, None), devices=one)(x, y)
    for a, b in zip(found, wanted, strict=True):
        assert a.shape == b.shape
        np.testing.assert_allclose(a, b, rtol=1e-6)


def test_it_is_for_one_device_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    assert brax_compat.load_ppo().jax.pmap is brax_compat.one_device_pmap
    monkeypatch.setattr(jax, "device_count", lambda: 2)
    assert brax_compat.load_ppo().jax.pmap is jax.pmap
    monkeypatch.undo()
    brax_compat.load_ppo()


def test_brax_sees_all_else_of_jax() -> None:
    seen = brax_compat._JaxOnOneDevice("jax")
    assert seen.vmap is jax.vmap
    assert seen.lax.pmean is jax.lax.pmean
    assert seen.pmap is brax_compat.one_device_pmap
    tree = {"a": jnp.arange(3), "b": (jnp.ones((2, 2)),)}
    placed = seen.device_put_replicated(tree, jax.devices()[:1])
    np.testing.assert_array_equal(placed["a"], jnp.arange(3)[None])
    assert placed["b"][0].shape == (1, 2, 2)


def test_metrics_are_braxs_and_another_number_of_ended_episodes_compiles_nothing(
    caplog: pytest.LogCaptureFixture,
) -> None:
    rng = np.random.default_rng(0)
    ours, theirs = list[dict[str, float]](), list[dict[str, float]]()
    loggers = (
        brax_compat.load_ppo().metric_logger.EpisodeMetricsLogger(100, 1, lambda _, found: ours.append(found)),
        EpisodeMetricsLogger(100, 1, lambda _, found: theirs.append(found)),
    )

    def rollout(ended: int) -> tuple[dict[str, jax.Array], jax.Array, dict[str, jax.Array]]:
        dones = np.zeros(5 * 7, np.float32)
        dones[rng.choice(len(dones), ended, replace=False)] = 1.0
        draw = lambda: jnp.asarray(rng.uniform(1.0, 9.0, (5, 7)), jnp.float32)  # noqa: E731
        metrics = {"length": draw(), "reward": draw(), "hit_per_step": draw()}
        return metrics, jnp.asarray(dones.reshape(5, 7)), {"loss": jnp.asarray(rng.uniform(size=3), jnp.float32)}

    for ended in (0, 3, 17, 35):
        for logger, arrays in zip(loggers, [rollout(ended)] * 2, strict=True):
            logger.update_episode_metrics(*arrays)
    assert len(ours) == len(theirs) == 4
    for one, other in zip(ours, theirs, strict=True):
        assert one.pop("episode/sps") > 0.0
        other.pop("episode/sps")
        assert one.keys() == other.keys()
        assert one == pytest.approx(other, rel=1e-6)
    more = [rollout(ended) for ended in (1, 2, 5, 8, 13, 21, 34)]
    with jax.log_compiles():
        for logger, compiled in zip(loggers, (False, True), strict=True):
            caplog.clear()
            for arrays in more:
                logger.update_episode_metrics(*arrays)
            assert ("Finished XLA compilation" in caplog.text) is compiled, "Brax's own does: else this is not needed"


class _Camera(Env):
    """Observations are noise of their step, the same along each row of an image; episodes end at random."""

    shape = (24, 32, 3)

    def reset(self, rng: jax.Array) -> State:
        zero = jnp.zeros(())
        return State(rng, self._observe(rng), zero, zero, {}, {"truncation": zero, "time_out": zero})

    def step(self, state: State, action: jax.Array) -> State:
        key = jax.random.fold_in(state.pipeline_state, 1)
        done = (jax.random.uniform(key) < 0.2).astype(jnp.float32)
        return state.replace(pipeline_state=key, obs=self._observe(key), reward=action.sum(), done=done)

    def _observe(self, key: jax.Array) -> dict[str, jax.Array]:
        rows = jax.random.randint(key, (self.shape[0], 1, 1), 0, 256).astype(jnp.uint8)
        return {"pixels/front": jnp.broadcast_to(rows, self.shape), "goal": jax.random.normal(key, (3,))}

    observation_size = property(lambda self: {"pixels/front": self.shape, "goal": (3,)})
    action_size = property(lambda _: 2)
    backend = property(lambda _: "none")


def test_an_unroll_keeps_the_last_next_observation_alone() -> None:
    """The same final state, and all that the loss reads."""
    env, n, steps = VmapWrapper(_Camera()), 3, 5
    start = env.reset(jax.random.split(jax.random.PRNGKey(0), n))

    def policy(obs: dict[str, jax.Array], key: jax.Array) -> tuple[jax.Array, dict[str, jax.Array]]:
        action = jax.random.normal(key, (n, 2)) + obs["goal"][:, :2]
        return action, {"log_prob": action[:, 0]}

    arguments = (env, start, policy, jax.random.key(1), steps, ("truncation",))
    end, theirs = acting.generate_unroll(*arguments)
    found, ours = brax_compat.load_ppo().acting.generate_unroll(*arguments)
    assert {x.shape[:2] for x in jax.tree.leaves(ours.next_observation)} == {(1, n)}
    theirs = theirs._replace(next_observation=jax.tree.map(lambda x: x[-1:], theirs.next_observation))
    for a, b in zip(jax.tree.leaves((found, ours)), jax.tree.leaves((end, theirs)), strict=True):
        np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize(
    ("module", "options"),
    [
        (brax_compat._JaxOnOneDevice, {}),
        # Brax computes with all arrays before it shuffles them.
        pytest.param(
            brax_compat._Jax, {"bootstrap_on_timeout": True, "augment_pixels": True}, marks=pytest.mark.extended
        ),
    ],
    ids=("rows", "arrays"),
)
def test_rows_are_shuffled_as_brax_shuffles_arrays(
    module: Any, options: dict[str, bool], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two rollouts of two unrolls, two epochs of four minibatches: the same parameters to the bit."""
    train, found = brax_compat.load_ppo(), []
    for lax in (module.lax, jax.lax):
        monkeypatch.setattr(module, "lax", lax)
        monkeypatch.setattr(train, "jax", module("jax"))
        _, params, _ = _train(num_timesteps=128, num_envs=8, batch_size=4, num_updates_per_batch=2, **options)
        found.append(jax.tree.leaves(params))
    assert module.lax is jax.lax
    for a, b in zip(*found, strict=True):
        np.testing.assert_array_equal(a, b)
    start = jax.tree.leaves(_train(num_timesteps=0, num_envs=8, batch_size=4)[1])
    assert any((a != b).any() for a, b in zip(found[0], start, strict=True)), "nothing was learnt"


def test_training_with_a_camera_holds_its_frames_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Brax holds those after each step too, where the critic has images, and with convolutions all of them twice."""
    frames = 4 * 64 * math.prod(_Camera.shape)
    monkeypatch.setattr(brax_compat.load_ppo(), "jax", _Measured("jax"))
    with pytest.raises(_Compiled) as found:
        _train(num_timesteps=1024, num_envs=4, unroll_length=64, batch_size=1, num_updates_per_batch=4)
    assert 1.0 < found.value.args[0] / frames < 1.5, found.value.args[0] / frames


def test_rows_of_a_rollout_are_those_that_brax_transposes() -> None:
    shapes = {"observation": (2, 5, 3, 4), "reward": (2, 5, 3), "next_observation": (2, 1, 3, 4)}
    arrays = {name: jnp.arange(math.prod(shape)).reshape(shape) for name, shape in shapes.items()}
    stacked = Transition(action=(), discount=arrays["reward"], extras={}, **arrays)

    def transpose(tree: Any) -> Any:
        return jax.tree.map(lambda x: jnp.swapaxes(x, 1, 2).reshape(-1, x.shape[1], *x.shape[3:]), tree)

    rollout, wanted = transpose(brax_compat._Rollout.of(stacked)), transpose(stacked)
    np.testing.assert_array_equal(rollout.numbers, np.arange(6)[:, None])
    chosen = np.array([4, 0, 5, 1])
    for name in shapes:
        np.testing.assert_array_equal(getattr(rollout, name), getattr(wanted, name))
        np.testing.assert_array_equal(getattr(rollout.rows(chosen[:, None]), name), getattr(wanted, name)[chosen])


def _train(**options: Any) -> Any:
    """Brax's training on `_Camera`."""
    sizes = {"unroll_length": 4, "num_minibatches": 4, "episode_length": 20} | options
    nothing = {"num_evals": 1, "run_evals": False, "num_eval_envs": sizes["num_envs"]}
    return ppo.train(environment=_Camera(), network_factory=_averages, **nothing, **sizes)


class _LookedUp(_Camera):
    """Rewards are values of a table."""

    table = jnp.asarray(np.random.default_rng(0).normal(size=(70, 1000)).astype(np.float32))

    def step(self, state: State, action: jax.Array) -> State:
        place = jax.random.randint(state.pipeline_state, (2,), 0, 70)
        return super().step(state, action).replace(reward=self.table[place[0], place[1]])


def test_a_table_of_the_environment_is_no_part_of_the_programs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither of Brax's reset nor of its training."""
    train = brax_compat.load_ppo()
    programs = list[table_arguments.Program]()
    make = table_arguments.Program.__init__

    def recorded(program: table_arguments.Program, *given: Any) -> None:
        make(program, *given)
        programs.append(program)

    monkeypatch.setattr(table_arguments.Program, "__init__", recorded)
    train.train(
        environment=_LookedUp(), num_timesteps=64, episode_length=20, num_envs=4, unroll_length=4, batch_size=4,
        num_minibatches=1, num_updates_per_batch=1, num_evals=1, run_evals=False, num_eval_envs=4, seed=0,
        network_factory=_averages,
    )  # fmt: skip
    assert max(largest_constant(program.lowered().as_text()) for program in programs) < _LookedUp.table.size
    tables = [program.tables for program in programs if program.tables]
    assert len(tables) >= 1
    assert all(found[0] is _LookedUp.table for found in tables)


class _Compiled(Exception):
    """A training was compiled; its argument is the size in bytes of what it holds besides its arguments and results."""


class _Measured(brax_compat._JaxOnOneDevice):
    """Replacement of the module `jax` in Brax's PPO which raises `_Compiled` in place of training."""

    @staticmethod
    def pmap(function: Any, *arguments: Any, **options: Any) -> Any:
        compiled = brax_compat.one_device_pmap(function, *arguments, **options)

        def call(*given: Any) -> Any:
            if function.__name__ == "training_epoch":
                raise _Compiled(compiled.lower(*given).lowered().compile().memory_analysis().temp_size_in_bytes)
            return compiled(*given)

        return call


def _averages(sizes: Any, action_size: int, preprocess_observations_fn: Any = None) -> PPONetworks:
    """Networks whose actor and critic see the mean of each row of the image."""
    del preprocess_observations_fn
    distribution = NormalTanhDistribution(event_size=action_size)

    def network(outputs: int) -> FeedForwardNetwork:
        def apply(_: Any, params: jax.Array, obs: dict[str, jax.Array]) -> jax.Array:
            return obs["pixels/front"].mean((-3, -1)) @ params

        return FeedForwardNetwork(lambda key: jax.random.normal(key, (sizes["pixels/front"][1], outputs)), apply)

    critic = network(1)
    value = FeedForwardNetwork(critic.init, lambda *given: critic.apply(*given)[..., 0])
    return PPONetworks(network(distribution.param_size), value, distribution)
