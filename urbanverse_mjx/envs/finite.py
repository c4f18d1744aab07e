"""Guards against NaN and infinity: inputs and intermediate values of a step may contain them, its outputs must not."""

from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool

#: Larger numbers count as infinite, because their squares and cubes may overflow.
MAX_MAGNITUDE = 1e9


def _is_float(leaf: Any) -> bool:
    return jnp.issubdtype(jnp.asarray(leaf).dtype, jnp.floating)


def is_sound(tree: Any) -> Bool[Array, ""]:
    """() bool: whether all floats of a pytree are numbers of at most `MAX_MAGNITUDE`."""
    sound = [(jnp.abs(leaf) <= MAX_MAGNITUDE).all() for leaf in jax.tree.leaves(tree) if _is_float(leaf)]
    return jnp.array(sound).all()


def repaired[T](tree: T) -> tuple[T, Bool[Array, ""]]:
    """Replaces every float of a pytree that is NaN or too large by 0; also returns `is_sound` of the input."""

    def repair(leaf: Any) -> Any:
        return jnp.where(jnp.abs(leaf) <= MAX_MAGNITUDE, leaf, 0.0).astype(leaf.dtype) if _is_float(leaf) else leaf

    return jax.tree.map(repair, tree), is_sound(tree)


def choose[T](condition: Bool[Array, ""], new: T, old: T) -> T:
    """Selects one of two pytrees."""
    return jax.tree.map(lambda a, b: jnp.where(condition, a, b), new, old)
