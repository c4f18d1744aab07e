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

Brax indexes the metrics of completed episodes with JAX, which compiles ten programs for each number of episodes that
end in a rollout and keeps them; here NumPy does it.
"""

from collections.abc import Callable, Sequence
from types import ModuleType, SimpleNamespace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from .. import table_arguments


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


class _JaxOnOneDevice(ModuleType):
    """Replacement of the module `jax` in Brax's PPO, with another `pmap`, `jit` and `device_put_replicated`."""

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

    def __getattr__(self, name: str) -> Any:
        return getattr(jax, name)


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
    train.jax = _JaxOnOneDevice("jax") if jax.device_count() == 1 else jax
    return train
