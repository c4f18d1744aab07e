"""`check_env`: checks the contract of this package's environments; users can run it on their own environments."""

import dataclasses
from collections.abc import Mapping
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from .types import StagedEnv
from .wrappers import wrap_for_training


class EnvCheckError(AssertionError):
    """An environment violates its contract; the message names the rule and the observed value."""


def _require(condition: Any, promise: str, seen: object = "") -> None:
    if not bool(condition):
        raise EnvCheckError(f"{promise}; saw {seen}")


def _leaves(tree: Any) -> list[np.ndarray]:
    def plain(x: Any) -> np.ndarray:
        return np.asarray(jax.random.key_data(x) if jnp.issubdtype(x.dtype, jax.dtypes.prng_key) else x)

    return [plain(x) for x in jax.tree.leaves(tree)]


def _same(a: Any, b: Any, tolerance: float = 0.0) -> bool:
    return all(
        x.shape == y.shape and (np.allclose(x, y, rtol=0, atol=tolerance) if x.dtype.kind == "f" else (x == y).all())
        for x, y in zip(_leaves(a), _leaves(b), strict=True)
    )


def _unseen(obs: Any) -> dict[str, Any]:
    """Observations without images."""
    return {name: x for name, x in obs.items() if not name.startswith("pixels/")}


def _frames_close(a: Any, b: Any) -> bool:
    return float(np.abs(np.asarray(a, np.float32) - np.asarray(b, np.float32)).mean()) < 1.0


class _Counted:
    """A jitted function that counts its traces."""

    def __init__(self, function: Any):
        self.traces = 0

        def counted(*args: Any) -> Any:
            self.traces += 1
            return function(*args)

        self.call = jax.jit(counted)


def check_env(
    env: StagedEnv[Any],
    num_envs: int = 6,
    num_steps: int = 12,
    tolerance: float = 1e-4,
    constants: Mapping[str, int] | None = None,
) -> None:
    """Checks an environment with `begin`, `reset_episode`, `advance`, `observe`, `reset`, `step` (see `NavEnv`).

    Args:
      env: the environment without wrappers.
      num_envs, num_steps: size of the random rollout.
      tolerance: largest difference between vmap and loop, in the units of each observation.
      constants: observation -> number of its values that may stay the same in so short a rollout, such as whether the
        robot is on a crosswalk; by default 0.

    Raises:
      EnvCheckError: a rule is violated; the message names it.
    """
    keys = jax.random.split(jax.random.key(0), num_envs)
    reset, step = _Counted(jax.vmap(env.reset)), _Counted(jax.vmap(env.step))
    first = reset.call(keys)
    _require(_same(first, reset.call(keys)), "equal seeds give equal first states")
    other = reset.call(jax.random.split(jax.random.key(1), num_envs))
    _require(not _same(first.obs, other.obs), "different seeds give different first states")
    unseen_of_raw = jax.jit(jax.vmap(lambda key: _unseen(env.reset(key).obs)))
    raw = unseen_of_raw(jax.vmap(jax.random.key_data)(keys))
    _require(_same(_unseen(first.obs), raw, tolerance), "raw and typed keys give the same state")
    _check_spec(env, first)
    states = [first]
    actions = jax.random.uniform(jax.random.key(2), (num_steps, num_envs, env.action_size), minval=-1.0, maxval=1.0)
    for action in actions:
        states.append(step.call(states[-1], action))
        _check_spec(env, states[-1])
        _require(jax.tree.structure(states[-1]) == jax.tree.structure(first), "states keep one structure")
    _require(reset.traces == 1, "reset is traced once", reset.traces)
    _require(step.traces == 1, "step is traced once though scenes differ", step.traces)
    again = first
    for action in actions:
        again = step.call(again, action)
    _require(_same(states[-1], again), "equal actions give equal states")
    _check_no_constant(states, constants or {})
    _check_vmap_is_loop(env, first, states[1], actions[0], tolerance)
    _check_auto_reset(env, step.call, first, keys)


def _check_spec(env: Any, state: Any) -> None:
    size = env.observation_size
    _require(set(size) == set(state.obs), "observations are those of observation_size", sorted(state.obs))
    for name, x in state.obs.items():
        _require(x.shape[1:] == tuple(size[name]), f"observation {name} has its shape {size[name]}", x.shape)
        wanted = jnp.uint8 if name.startswith("pixels/") else jnp.float32
        _require(x.dtype == wanted, f"observation {name} is {jnp.dtype(wanted).name}", x.dtype)
        _require(np.isfinite(np.asarray(x, np.float32)).all(), f"observation {name} is finite")
    for name in ("reward", "done"):
        x = getattr(state, name)
        _require(x.dtype == jnp.float32 and np.isfinite(np.asarray(x)).all(), f"{name} is finite f32", x.dtype)
    for name, x in state.metrics.items():
        _require(np.isfinite(np.asarray(x)).all(), f"metric {name} is finite")


def _check_no_constant(states: list[Any], constants: Mapping[str, int]) -> None:
    for name in states[0].obs:
        if name == "robot":  # size and dynamics, the same at every step
            continue
        stack = np.stack([np.asarray(s.obs[name], np.float32) for s in states])
        spread = stack.reshape(-1, *stack.shape[2:]).std(axis=0)
        share = float((spread == 0).mean())
        # Some pixels may always show the robot itself or the zenith.
        allowed = 0.25 if name.startswith("pixels/") else constants.get(name, 0) / spread.size
        _require(share <= allowed, f"observation {name} holds no constants", f"{share:.0%} constant")


def _check_vmap_is_loop(env: Any, first: Any, second: Any, action: Any, tolerance: float) -> None:
    one = jax.jit(env.step)
    for i in range(min(2, len(action))):
        alone = one(jax.tree.map(lambda x, i=i: x[i], first), action[i])
        batch = jax.tree.map(lambda x, i=i: x[i], second)
        for name in alone.obs:
            close = (
                _frames_close(alone.obs[name], batch.obs[name])
                if name.startswith("pixels/")
                else _same(alone.obs[name], batch.obs[name], tolerance)
            )
            _require(close, f"vmap equals a loop in observation {name}")
        _require(_same(alone.reward, batch.reward, tolerance * 100), "vmap equals a loop in the reward")


def _check_auto_reset(env: Any, step: Any, first: Any, keys: Any) -> None:
    """Checks auto-reset; `step`: compiled batch step of the env; `first`: its first state."""
    wrapped = wrap_for_training(env, env.config.episode_length)
    state = jax.jit(wrapped.reset)(keys)
    # One step before the time limit for the first half of the batch, whose episodes must end now and be reset.
    half = np.arange(len(keys)) < len(keys) // 2
    steps = jnp.where(half, env.config.episode_length - 1, 0).astype(jnp.int32)
    state = dataclasses.replace(state, data=state.data._replace(steps=steps))
    actions = jnp.zeros((len(keys), env.action_size))
    after = jax.jit(wrapped.step)(state, actions)
    done = np.asarray(after.done) > 0
    _require(done[half].all(), "an episode ends when its time is over", done)
    over = step(dataclasses.replace(first, data=state.data), actions).data
    fresh = jax.jit(jax.vmap(env.reset_episode))(over)
    wanted = jax.jit(jax.vmap(env.observe))(fresh)
    for i in np.flatnonzero(done):
        got = jax.tree.map(lambda x, i=i: x[i], after)
        # Two programs may round sums in another order; the difference of poses is up to 3e-8 m.
        same = _same(got.data, jax.tree.map(lambda x, i=i: x[i], fresh), 1e-6)
        _require(same, "auto-reset equals reset_episode in all carried state")
        for name in wanted:
            close = (
                _frames_close(got.obs[name], wanted[name][i])
                if name.startswith("pixels/")
                else _same(got.obs[name], wanted[name][i], 1e-5)
            )
            _require(close, f"auto-reset shows the new episode in {name}")
    _require((np.asarray(after.data.steps)[~done] == 1).all(), "episodes that go on keep their state")
