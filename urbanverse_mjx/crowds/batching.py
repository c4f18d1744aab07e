"""Per-env functions that run as one call over all envs.

In:   a function over arrays whose last axis is the env. Out: the same function over arrays of one env, which `jax.vmap`
converts to a single call of the first. When: at construction.
"""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp


def over_envs(function: Callable[..., Any]) -> Callable[..., Any]:
    """`function` for arrays without its last axis E.

    Under (nested) `jax.vmap`, the envs become the last axis of one call, so that they are contiguous in memory.
    """

    @jax.custom_batching.custom_vmap
    def batch(*arguments: Any) -> Any:
        return function(*arguments)

    @batch.def_vmap
    def _(size: int, batched: Any, *arguments: Any) -> Any:
        def joined(array: Any, is_batched: bool) -> Any:
            array = array if is_batched else jnp.broadcast_to(array, (size, *array.shape))
            return jnp.moveaxis(array, 0, -2).reshape(*array.shape[1:-1], size * array.shape[-1])

        out = batch(*jax.tree.map(joined, arguments, tuple(batched)))
        parted = jax.tree.map(lambda a: jnp.moveaxis(a.reshape(*a.shape[:-1], size, -1), -2, 0), out)
        return parted, jax.tree.map(lambda _: True, parted)

    def one(*arguments: Any) -> Any:
        out = batch(*jax.tree.map(lambda a: jnp.asarray(a)[..., None], arguments))
        return jax.tree.map(lambda a: a[..., 0], out)

    return one
