"""Floats of a batch of states that are no numbers, one in each env."""

from collections.abc import Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

#: Invalid values that a sensor, a solver or a caller may pass.
NO_NUMBERS = np.array([np.nan, np.inf, -np.inf, 3e38, -3e38], np.float32)


def float_leaves(tree: Any) -> list[str]:
    """Paths of the leaves of a pytree that hold floats, empty ones left out."""
    leaves = jax.tree_util.tree_leaves_with_path(tree)
    return [jax.tree_util.keystr(k) for k, x in leaves if jnp.issubdtype(x.dtype, jnp.floating) and x.size]


def spoil(tree: Any, rng: np.random.Generator, envs: Sequence[int] | np.ndarray, first: int = 0) -> Any:
    """A batch with one of `NO_NUMBERS` in one random float of each env in `envs`.

    Which of the leaves it is goes by the env's number, from the leaf `first` on: a batch of as many envs as there are
    leaves spoils each.
    """
    names = float_leaves(tree)
    counted, chosen = iter(range(len(names))), np.asarray(envs, int)

    def change(path: Any, leaf: Any) -> Any:
        if jax.tree_util.keystr(path) not in names:
            return leaf
        turn, body = next(counted), np.array(leaf)
        rows = body.reshape(len(body), -1)
        for env in chosen[(chosen + first) % len(names) == turn]:
            rows[env, rng.integers(rows.shape[1])] = rng.choice(NO_NUMBERS)
        return jnp.asarray(body)

    return jax.tree_util.tree_map_with_path(change, tree)


def unsound(tree: Any) -> list[str]:
    """Paths of the leaves with a float that is no number."""
    leaves = jax.tree_util.tree_leaves_with_path(tree)
    floats = [(k, x) for k, x in leaves if jnp.issubdtype(x.dtype, jnp.floating)]
    return [jax.tree_util.keystr(k) for k, x in floats if not np.isfinite(np.asarray(x)).all()]
