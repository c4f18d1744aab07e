"""Functions of one env that run as one call over all of them.

In:   a function over arrays whose last axis is the env.
Out:  the same over arrays of one env, which `jax.vmap` turns into a single call of the first.
When: at construction.
"""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp


def over_envs(function: Callable[..., Any]) -> Callable[..., Any]:
    """`function` for arrays without its last axis E.

    Under `jax.vmap` the envs become the last axis of one call, however deep the maps are nested: there they lie side by
    side in memory.
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
