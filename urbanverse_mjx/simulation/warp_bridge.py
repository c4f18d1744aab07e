"""Calls from jitted JAX code into Warp, per world, with and without (nested) `jax.vmap`.

A registry maps a number to each callee, and compiled code contains only that number. JAX and Warp keep compiled
functions forever; with the registry, a deleted renderer still releases its memory.
"""

import collections
import inspect
import itertools
import math
import threading
import weakref
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import warp as wp

#: Batches of other sizes that are kept before the oldest is dropped (training, evaluation, a single env, ...).
KEPT_BATCHES = 8

_numbers = itertools.count(1)
_registry: "weakref.WeakValueDictionary[int, Any]" = weakref.WeakValueDictionary()
_lock = threading.Lock()
_device_locks: collections.defaultdict[str, threading.RLock] = collections.defaultdict(threading.RLock)


def register(owner: Any) -> int:
    """A number under which `owner` is found while a reference to it exists."""
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
            "found a call into a renderer or an engine that was deleted; needed one that is alive; keep a reference to "
            "it as long as functions compiled with it are used"
        )
    return owner


def jax_callable(
    name: str,
    run: Callable[[Any, Sequence[wp.array], Sequence[wp.array]], None],
    inputs: Mapping[str, Any],
    outputs: Mapping[str, Any],
) -> Any:
    """A call from JAX into Warp: (number of the owner, arrays, output_dims=shapes by name) -> outputs in their order.

    Warp reads inputs and outputs from a function's signature, which is generated here from the two tables. JAX keeps
    every call for ever, so each kind is to be made once.

    Args:
      name: stands in compiled programs, made unique by Warp.
      run: (owner, input arrays, output arrays), called with Warp's device set.
      inputs, outputs: name -> Warp array type.
    """

    def call(owner: int, *arrays: wp.array) -> None:
        run(registered(owner), arrays[: len(inputs)], arrays[len(inputs) :])

    types: dict[str, Any] = {"owner": int, **inputs, **outputs}
    kind = inspect.Parameter.POSITIONAL_OR_KEYWORD
    signature = inspect.Signature([inspect.Parameter(argument, kind) for argument in types])
    call.__qualname__, call.__annotations__ = name, types
    setattr(call, "__signature__", signature)  # noqa: B010 (no attribute of functions in their own type)
    # Owners make their batches when a call first runs, which a graph capture around it would not allow.
    return wp.jax_callable(call, num_outputs=len(outputs), graph_mode=wp.JaxCallableGraphMode.NONE)


def device_lock(device: Any) -> threading.RLock:
    """Held while one thread launches on a Warp device.

    Under `jax.pmap` every JAX device calls from a thread of its own, and the devices that XLA cuts a CPU into are one
    device to Warp.
    """
    with _lock:
        return _device_locks[str(device)]


class RecentBatches[Batch](collections.OrderedDict[Any, Batch]):
    """The `KEPT_BATCHES` batches of one Warp device used last."""

    def __init__(self, device: Any) -> None:
        super().__init__()
        self.device = device

    def get_or_make(self, key: Any, make: Callable[[], Batch]) -> Batch:
        """The batch of a key, made where it is not kept."""
        if key not in self:
            self[key] = make()
            while len(self) > KEPT_BATCHES:
                # Earlier launches may still run on it.
                wp.synchronize_device(self.device)
                self.popitem(last=False)
        self.move_to_end(key)
        return self[key]


class DeviceStore[Shared, Batch](dict[str, tuple[Shared, RecentBatches[Batch]]]):
    """Data on each Warp device, by its name: those shared by all batches, and the batches used last."""

    def get_or_make(self, device: Any, make: Callable[[], Shared]) -> tuple[Shared, RecentBatches[Batch]]:
        """The device's own, made where the device is new."""
        name = str(device)
        if name not in self:
            self[name] = make(), RecentBatches(device)
        return self[name]

    @property
    def num_batches(self) -> int:
        """Batches that are kept on all devices."""
        return sum(len(batches) for _, batches in self.values())


def batched_call(batch: Callable[..., Any]) -> Callable[..., Any]:
    """Makes a per-world function of one that takes exactly one leading world axis.

    Args:
      batch: (arrays with a leading axis n) -> pytree with a leading axis n. Its first argument is a scalar per world.

    Returns:
      A pure function for one world, jitted; under (nested) `jax.vmap` all axes are flattened into one call of `batch`.
      Tracing it, for shapes alone or for a vmap, launches no kernel.
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
