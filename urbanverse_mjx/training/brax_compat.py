"""The one place that fixes Brax 0.14.2 for newer JAX.

`jax.device_put_replicated` left JAX with 0.10, and Brax's PPO still calls it. The replacement goes through
`jax.pmap`, so that its result has the very sharding that pmap returns: with any other the training epoch would
be compiled twice (docs/sources/brax_over_warp.md, Q7).

Newer JAX's `pmap` returns one array over all hosts, and `x[0]` of it is a computation that all processes must join.
Brax takes the parameters out in the first process alone, and training over several hosts stands still: each process now
takes its own copy.
"""

from collections.abc import Sequence
from types import ModuleType
from typing import Any

import jax
import jax.numpy as jnp


def device_put_replicated(tree: Any, devices: Sequence[Any]) -> Any:
    """A copy of `tree` on each device, with a new leading axis of len(devices)."""
    place = jax.pmap(lambda _, t: t, in_axes=(0, None), devices=list(devices), axis_name="i")
    return place(jnp.arange(len(devices)), tree)


def own_copy(tree: Any) -> Any:
    """This process's copy of what `jax.pmap` returned the same on all devices: without the leading axis of devices."""
    return jax.tree.map(lambda x: x.addressable_data(0)[0], tree)


def load_ppo() -> ModuleType:
    """`brax.training.agents.ppo.train`, working on this JAX."""
    if not hasattr(jax, "device_put_replicated"):
        jax.device_put_replicated = device_put_replicated
    from brax.training.agents.ppo import train

    train._unpmap = own_copy
    return train
