"""How XLA compiles in tests: quickly (`tests/conftest.py`), but for what computes much longer than it compiles."""

import contextlib
from collections.abc import Iterator

import jax

NAME = "jax_disable_most_optimizations"


@contextlib.contextmanager
def optimized() -> Iterator[None]:
    """Enables all of LLVM's optimizations for code compiled within."""
    before = jax.config.values[NAME]
    jax.config.update(NAME, False)
    try:
        yield
    finally:
        jax.config.update(NAME, before)
