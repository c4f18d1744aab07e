"""The one place that fixes Brax 0.14.2 for newer JAX.

`jax.device_put_replicated` left JAX with 0.10, and Brax's PPO still calls it. The replacement goes through
`jax.pmap`, so that its result has the very sharding that pmap returns: with any other the training epoch would
be compiled twice (docs/sources/brax_over_warp.md, Q7).

Newer JAX's `pmap` returns one array over all hosts, and `x[0]` of it is a computation that all processes must join.
Brax takes the parameters out in the first process alone, and training over several hosts stands still: each process now
takes its own copy.

The streets of a bank are constants of what is compiled: hundreds of megabytes in the program's text, which XLA copies
and hashes. JAX can make arguments of them, but `pmap` refuses such functions, so on one accelerator Brax gets `jit` of
`vmap`.
"""

from collections.abc import Callable, Sequence
from types import ModuleType
from typing import Any

import jax
import jax.numpy as jnp

_AS_ARGUMENTS = "jax_use_simplified_jaxpr_constants"


def device_put_replicated(tree: Any, devices: Sequence[Any]) -> Any:
    """A copy of `tree` on each device, with a new leading axis of len(devices)."""
    place = jax.pmap(lambda _, t: t, in_axes=(0, None), devices=list(devices), axis_name="i")
    return place(jnp.arange(len(devices)), tree)


def own_copy(tree: Any) -> Any:
    """This process's copy of what `jax.pmap` returned the same on all devices: without the leading axis of devices."""
    return jax.tree.map(lambda x: x.addressable_data(0)[0], tree)


def tables_as_arguments() -> bool:
    """Makes the tables of environments arguments of what is compiled from now on; returns whether it did: on one
    accelerator. On a CPU and with several devices nothing changes."""
    if jax.default_backend() == "cpu" or jax.device_count() > 1 or not hasattr(jax.config, _AS_ARGUMENTS):
        return False
    jax.config.update(_AS_ARGUMENTS, True)
    return True


def one_device_pmap(
    function: Callable[..., Any],
    axis_name: Any = None,
    in_axes: Any = 0,
    donate_argnums: Any = (),
    devices: Sequence[Any] | None = None,
    **_: Any,
) -> Any:
    """`jax.pmap` on one device by `jit` and `vmap`."""
    del devices
    return jax.jit(jax.vmap(function, in_axes=in_axes, axis_name=axis_name), donate_argnums=donate_argnums)


class _JaxOnOneDevice(ModuleType):
    """`jax` as Brax's PPO sees it: with another `pmap` and what is built on it."""

    pmap = staticmethod(one_device_pmap)

    @staticmethod
    def device_put_replicated(tree: Any, devices: Sequence[Any]) -> Any:
        """A copy of `tree` with a new leading axis of 1."""
        del devices
        return one_device_pmap(lambda _, t: t, in_axes=(0, None))(jnp.arange(1), tree)

    def __getattr__(self, name: str) -> Any:
        return getattr(jax, name)


def load_ppo() -> ModuleType:
    """`brax.training.agents.ppo.train`, working on this JAX."""
    if not hasattr(jax, "device_put_replicated"):
        jax.device_put_replicated = device_put_replicated
    from brax.training.agents.ppo import train

    train._unpmap = own_copy
    train.jax = _JaxOnOneDevice("jax") if getattr(jax.config, _AS_ARGUMENTS, False) else jax
    return train
