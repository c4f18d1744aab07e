"""`jit` for functions that close over large tables, such as those of a bank's streets.

JAX writes the arrays that a function closes over into the compiled program, where the compiler copies them several
times and hashes them for its cache: a planner with the fields of twelve streets (2.8 GB) took 20 GB of memory, and JAX
could not keep the compiled training of a task in 46 streets (2.2 GB). Here they are arguments of the program, held
once.

JAX's own setting for this, `jax_use_simplified_jaxpr_constants`, is experimental, and has no effect once JAX is
imported.

Tables whose content changes while programs are in use are `Held`: they are arguments that are read anew at each call.
"""

import contextlib
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import jax
import jax.numpy as jnp
from jax.extend.core import jaxpr_as_fun

#: Bytes from which on an array becomes an argument; smaller ones stay constants.
MIN_BYTES = 1 << 16


class Held:
    """Tables that other ones of the same shapes may replace without compilation.

    Args:
      places: objects and the names of their attributes, each a pytree of arrays. Functions given to `jit` read them
        there; other programs, such as those of `jax.jit`, would keep the arrays of the moment. Within such a function,
        none that `jax.jit` compiles may read them.
    """

    def __init__(self, *places: tuple[Any, str]) -> None:
        self._places = places

    @property
    def tables(self) -> tuple[Any, ...]:
        """Those of now."""
        return tuple(getattr(owner, name) for owner, name in self._places)

    def replace(self, tables: tuple[Any, ...]) -> None:
        """Puts others of the same shapes in their place."""
        for (owner, name), table in zip(self._places, tables, strict=True):
            setattr(owner, name, table)

    @contextlib.contextmanager
    def bound(self, tables: tuple[Any, ...]) -> Iterator[None]:
        """Others in their place, within."""
        before = self.tables
        self.replace(tables)
        try:
            yield
        finally:
            self.replace(before)


class Program:
    """The program of a function for arguments of certain structure, shapes and dtypes.

    Attributes:
      tables: the arrays that are arguments of it.
    """

    def __init__(
        self,
        function: Callable[..., Any],
        arguments: tuple[Any, ...],
        donated: tuple[int, ...],
        held: Held | None = None,
    ) -> None:
        self._held = Held() if held is None else held

        def bound(tables: tuple[Any, ...], *arguments: Any) -> Any:
            with self._held.bound(tables):
                return function(*arguments)

        arguments = (_shapes(self._held.tables), *arguments)
        closed, shapes = jax.make_jaxpr(bound, return_shape=True)(*arguments)
        structure = jax.tree.structure(shapes)
        large = [k for k, x in enumerate(closed.consts) if getattr(x, "nbytes", 0) >= MIN_BYTES]
        small = {k: x for k, x in enumerate(closed.consts) if k not in large}
        self.tables = [jnp.asarray(closed.consts[k]) for k in large]
        self._arguments = arguments

        def run(tables: list[jax.Array], *arguments: Any) -> Any:
            consts = small | dict(zip(large, tables, strict=True))
            whole = closed.replace(consts=[consts[k] for k in range(len(closed.consts))])
            return jax.tree.unflatten(structure, jaxpr_as_fun(whole)(*jax.tree.leaves(arguments)))

        self._run = jax.jit(run, donate_argnums=tuple(k + 2 for k in donated))

    def __call__(self, *arguments: Any) -> Any:
        return self._run(self.tables, self._held.tables, *arguments)

    def lowered(self) -> Any:
        """The `jax.stages.Lowered` of tables and arguments."""
        return self._run.lower(self.tables, *self._arguments)

    def compile(self) -> Callable[..., Any]:
        """The compiled function of the arguments."""
        compiled = self.lowered().compile()

        def call(*arguments: Any) -> Any:
            return compiled(self.tables, self._held.tables, *arguments)

        return call


class Jitted:
    """See `jit`."""

    def __init__(self, function: Callable[..., Any], donated: tuple[int, ...], held: Held | None = None) -> None:
        self._function, self._donated, self._held = function, donated, held
        self._programs: dict[Any, Program] = {}

    def __call__(self, *arguments: Any) -> Any:
        leaves, structure = jax.tree.flatten(arguments)
        kind = structure, tuple(jax.typeof(leaf) for leaf in leaves)
        if kind not in self._programs:
            self._programs[kind] = Program(self._function, _shapes(arguments), self._donated, self._held)
        return self._programs[kind](*arguments)

    def lower(self, *arguments: Any) -> Program:
        """The program for arguments or their shapes, of which `compile` returns the compiled one."""
        return Program(self._function, _shapes(arguments), self._donated, self._held)


def jit(function: Callable[..., Any], donate_argnums: int | Sequence[int] = (), held: Held | None = None) -> Jitted:
    """Compiles a function of pytrees of arrays, once for each structure, shapes and dtypes of its arguments.

    Args:
      function: what it closes over is read when it is traced, as with `jax.jit`.
      donate_argnums: numbers of the arguments whose buffers are reused.
      held: tables that it reads which may be replaced by others; None = none.
    """
    donated = (donate_argnums,) if isinstance(donate_argnums, int) else tuple(donate_argnums)
    return Jitted(function, donated, held)


def _shapes(arguments: tuple[Any, ...]) -> tuple[Any, ...]:
    """Shapes in place of arrays, which a program does not keep alive."""
    return jax.eval_shape(lambda *given: given, *arguments)
