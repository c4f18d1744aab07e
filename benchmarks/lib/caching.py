"""Lets a benchmark keep what JAX compiles, as commands do."""

import os

import jax

from urbanverse_mjx import settings


def keep_compiled() -> None:
    """Compiled programs are kept in the cache folder and read from it, where the environment names no other place."""
    if jax.config.jax_compilation_cache_dir is None:
        jax.config.update("jax_compilation_cache_dir", str(settings.use_compilation_cache()))
        jax.config.update("jax_compilation_cache_max_size", int(os.environ["JAX_COMPILATION_CACHE_MAX_SIZE"]))
