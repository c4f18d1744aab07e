"""Calls from jitted JAX code into Warp: one world's call that works alone and under any nesting of `jax.vmap`.

Whoever is called stands in a registry under a small number, and compiled code carries that number alone: JAX and Warp
keep compiled functions for ever, and so a deleted renderer can give its memory back.
"""

import itertools
import math
import threading
import weakref
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp

_numbers = itertools.count(1)
_registry: "weakref.WeakValueDictionary[int, Any]" = weakref.WeakValueDictionary()
_lock = threading.Lock()


def register(owner: Any) -> int:
    """A number under which `owner` is found for as long as somebody holds it."""
    with _lock:
        number = next(_numbers)
        _registry[number] = owner
    return number


def registered(number: int) -> Any:
    """The owner of a number.

    Raises:
      RuntimeError: it was deleted; a function compiled with it was called all the same.
    """
    owner = _registry.get(number)
    if owner is None:
        raise RuntimeError(
            "found a call into a renderer that was deleted; needed one that is alive; keep a reference to it as long "
            "as functions compiled with it are used"
        )
    return owner


def batched_call(batch: Callable[..., Any]) -> Callable[..., Any]:
    """Makes a per-world function of one that takes exactly one leading world axis.

    Args:
      batch: (arrays with a leading axis n) -> pytree with a leading axis n. Its first argument is a scalar per world.

    Returns:
      A pure function for one world, jitted; under (nested) `jax.vmap` all axes are flattened into one call of `batch`.
      Tracing it, for shapes alone or for a vmap, runs nothing.
    """

    @jax.custom_batching.custom_vmap
    def call(first: jax.Array, *rest: jax.Array) -> Any:
        # The first argument is a scalar per world, so its shape is the shape of the batch.
        lead = first.shape
        number = math.prod(lead)
        flat = [x.reshape((number, *x.shape[len(lead) :])) for x in (first, *rest)]
        return jax.tree.map(lambda x: x.reshape(lead + x.shape[1:]), batch(*flat))

    @call.def_vmap
    def _rule(size: int, batched: list[bool], *args: jax.Array) -> tuple[Any, Any]:
        whole = [x if b else jnp.broadcast_to(x, (size, *x.shape)) for x, b in zip(args, batched, strict=True)]
        out = call(*whole)
        return out, jax.tree.map(lambda _: True, out)

    # Without a jit of its own an eager caller would trace the call into Warp every time.
    return jax.jit(call)
