"""Compatibility fixes of Brax 0.14.2 for newer JAX.

JAX 0.10 removed `jax.device_put_replicated`, which Brax's PPO calls. The replacement uses `jax.pmap`, so that its
result has the sharding that pmap returns; with any other sharding the training epoch would be compiled twice
(docs/sources/brax_over_warp.md, Q7).

The `pmap` of newer JAX returns one array over all hosts, and indexing `x[0]` is a computation in which all processes
must take part. Brax reads the parameters in the first process only, which would block a training over several hosts;
with this fix, each process reads its own copy.

The tables of a bank would be constants of the compiled program, hundreds of megabytes that XLA copies and hashes. On
one device Brax gets `table_arguments.jit` of `vmap` in place of `pmap`, so that they are arguments.

Brax stores the observation before and after each step, although its loss uses only the one after an unroll's last step.
A critic with a CNN keeps both alive, so that each frame is held twice, and twice again when the batch is shuffled. Here
the second of them is kept after the last step alone.

Brax transposes a rollout and copies it, shuffled, in each epoch of SGD, so that all its frames are held twice. Here it
transposes and shuffles the numbers of the rows, with the same keys, and each minibatch copies its own rows alone.

Brax indexes the metrics of completed episodes with JAX, which compiles ten programs for each number of episodes that
end in a rollout and keeps them; here NumPy does it.
"""

import importlib.metadata
from collections.abc import Callable, Sequence
from types import ModuleType, SimpleNamespace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from .. import table_arguments

#: The version of Brax whose PPO does nothing to the numbers of rows but what it does to all arrays of a rollout.
_BRAX = "0.14.2"


def device_put_replicated(tree: Any, devices: Sequence[Any]) -> Any:
    """A copy of `tree` on each device, with a new leading axis of len(devices)."""
    place = jax.pmap(lambda _, t: t, in_axes=(0, None), devices=list(devices), axis_name="i")
    return place(jnp.arange(len(devices)), tree)


def own_copy(tree: Any) -> Any:
    """This process's copy of a replicated result of `jax.pmap`, without the leading axis of devices."""
    return jax.tree.map(lambda x: x.addressable_data(0)[0], tree)


def one_device_pmap(
    function: Callable[..., Any],
    axis_name: Any = None,
    in_axes: Any = 0,
    donate_argnums: Any = (),
    devices: Sequence[Any] | None = None,
    **_: Any,
) -> Any:
    """Replacement of `jax.pmap` for one device by `table_arguments.jit` and `vmap`."""
    del devices
    return table_arguments.jit(jax.vmap(function, in_axes=in_axes, axis_name=axis_name), donate_argnums)


class _Rollout:
    """A rollout as a tree whose single leaf is the numbers of its rows, which Brax rearranges in place of its arrays.

    Row k * num_envs + n is environment n in unroll k. Attributes are those of Brax's `Transition` after Brax has
    transposed it, (rows, unroll_length, ...), and cost a copy where they are used.
    """

    def __init__(self, numbers: Any, stacked: Any) -> None:
        """`stacked` is a `Transition` whose arrays are (unrolls, unroll_length, num_envs, ...)."""
        self.numbers = numbers
        self.stacked = stacked

    @classmethod
    def of(cls, stacked: Any) -> "_Rollout":
        """All rows: (unrolls, 1, num_envs), because Brax transposes the two last axes and merges the first two then."""
        unrolls, _, num_envs = stacked.discount.shape
        return cls(jnp.arange(unrolls * num_envs).reshape(unrolls, 1, num_envs), stacked)

    def rows(self, numbers: jax.Array) -> Any:
        """A `Transition` (n, unroll_length, ...) of the rows `numbers` (n, 1)."""
        num_envs = self.stacked.discount.shape[2]
        unroll, env = jnp.divmod(numbers[:, 0], num_envs)

        def of(x: jax.Array) -> jax.Array:
            # By one index into merged axes, because XLA transposes, and so copies, all of an array of which it gathers
            # by two axes that are not the first. In Brax's order (n, unroll_length), because XLA rounds otherwise in
            # another.
            length = x.shape[1]
            index = (unroll[:, None] * length + jnp.arange(length)) * num_envs + env[:, None]
            return x.reshape(-1, *x.shape[3:]).at[index].get(mode="promise_in_bounds")

        return jax.tree.map(of, self.stacked)

    def __getattr__(self, name: str) -> Any:
        field = getattr(self.stacked, name)
        return jax.tree.map(lambda x: jnp.swapaxes(x, 1, 2).reshape(-1, x.shape[1], *x.shape[3:]), field)


jax.tree_util.register_pytree_node(
    _Rollout, lambda rollout: ((rollout.numbers,), rollout.stacked), lambda stacked, leaf: _Rollout(*leaf, stacked)
)


class _Lax(ModuleType):
    """Replacement of the module `jax.lax` in Brax's PPO, with another `scan`."""

    @staticmethod
    def scan(f: Any, init: Any, xs: Any, length: int) -> tuple[Any, Any]:
        """JAX's, but stacked `Transition`s are returned as a `_Rollout`, of which each step of a scan gets its rows."""
        from brax.training.types import Transition

        if isinstance(xs, _Rollout):
            return jax.lax.scan(lambda carry, numbers: f(carry, xs.rows(numbers)), init, xs.numbers, length)
        end, ys = jax.lax.scan(f, init, xs, length)
        return end, _Rollout.of(ys) if isinstance(ys, Transition) else ys

    def __getattr__(self, name: str) -> Any:
        return getattr(jax.lax, name)


class _Jax(ModuleType):
    """Replacement of the module `jax` in Brax's PPO, with another `lax.scan` if its version is known."""

    lax = _Lax("jax.lax") if importlib.metadata.version("brax") == _BRAX else jax.lax

    def __getattr__(self, name: str) -> Any:
        return getattr(jax, name)


class _JaxOnOneDevice(_Jax):
    """The same with another `pmap`, `jit` and `device_put_replicated`."""

    pmap = staticmethod(one_device_pmap)

    @staticmethod
    def jit(function: Callable[..., Any], donate_argnums: Any = (), keep_unused: bool = False) -> Any:
        """`table_arguments.jit`, for resets."""
        del keep_unused
        return table_arguments.jit(function, donate_argnums)

    @staticmethod
    def device_put_replicated(tree: Any, devices: Sequence[Any]) -> Any:
        """A copy of `tree` with a new leading axis of 1."""
        del devices
        return one_device_pmap(lambda _, t: t, in_axes=(0, None))(jnp.arange(1), tree)


def _metric_logger() -> Any:
    """Replacement of the module `brax.training.logger` in Brax's PPO."""
    from brax.training import logger

    class EpisodeMetricsLogger(logger.EpisodeMetricsLogger):
        """Brax's, on arrays of NumPy."""

        def update_episode_metrics(self, *arrays: Any) -> None:
            """Adds a rollout; see Brax for the arguments."""
            super().update_episode_metrics(*jax.tree.map(np.asarray, arrays))

    return SimpleNamespace(EpisodeMetricsLogger=EpisodeMetricsLogger)


def generate_unroll(
    env: Any, env_state: Any, policy: Any, key: jax.Array, unroll_length: int, extra_fields: Sequence[str] = ()
) -> tuple[Any, Any]:
    """Brax's, but `next_observation` is the last one alone: (1, num_envs, ...), not (unroll_length, num_envs, ...).

    The loss takes the last along the first axis, so a training's parameters are the same to the bit.
    """
    from brax.training import acting

    end, data = acting.generate_unroll(env, env_state, policy, key, unroll_length, extra_fields)
    return end, data._replace(next_observation=jax.tree.map(lambda x: x[None], end.obs))


def _acting() -> Any:
    """Replacement of the module `brax.training.acting` in Brax's PPO."""
    from brax.training import acting

    return SimpleNamespace(generate_unroll=generate_unroll, Evaluator=acting.Evaluator)


def load_ppo() -> ModuleType:
    """Returns `brax.training.agents.ppo.train` with the compatibility fixes."""
    if not hasattr(jax, "device_put_replicated"):
        jax.device_put_replicated = device_put_replicated
    from brax.training.agents.ppo import train

    train._unpmap = own_copy
    train.metric_logger = _metric_logger()
    train.acting = _acting()
    train.jax = (_JaxOnOneDevice if jax.device_count() == 1 else _Jax)("jax")
    return train
