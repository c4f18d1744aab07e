"""`jit` for functions that close over large tables, such as those of a bank's streets.

JAX writes the arrays that a function closes over into the compiled program, where the compiler copies them several
times and hashes them for its cache: a planner with the fields of twelve streets (2.8 GB) took 20 GB of memory. Here
they are arguments of the program, held once.
"""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jax.extend.core import jaxpr_as_fun

#: Bytes from which on an array becomes an argument; smaller ones stay constants.
MIN_ELEMENTS = 1 << 16


def jit(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compiles a function of pytrees of arrays, once for each structure, shapes and dtypes of its arguments."""
    programs: dict[Any, Callable[..., Any]] = {}

    def call(*arguments: Any) -> Any:
        leaves, structure = jax.tree.flatten(arguments)
        kind = structure, tuple(jax.typeof(leaf) for leaf in leaves)
        if kind not in programs:
            programs[kind] = _Program(function, arguments)
        return programs[kind](leaves)

    return call


class _Program:
    """The compiled function for arguments of these shapes: leaves of the arguments -> what the function returns.

    Attributes:
      tables: the arrays that are arguments of it.
    """

    def __init__(self, function: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
        closed, shapes = jax.make_jaxpr(function, return_shape=True)(*arguments)
        structure = jax.tree.structure(shapes)
        large = [k for k, x in enumerate(closed.consts) if getattr(x, "nbytes", 0) >= MIN_ELEMENTS]
        small = {k: x for k, x in enumerate(closed.consts) if k not in large}
        self.tables = [jnp.asarray(closed.consts[k]) for k in large]

        def run(tables: list[jax.Array], leaves: list[Any]) -> Any:
            consts = small | dict(zip(large, tables, strict=True))
            whole = closed.replace(consts=[consts[k] for k in range(len(closed.consts))])
            return jax.tree.unflatten(structure, jaxpr_as_fun(whole)(*leaves))

        self._run = jax.jit(run)

    def __call__(self, leaves: list[Any]) -> Any:
        return self._run(self.tables, leaves)
