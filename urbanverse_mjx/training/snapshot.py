"""Saves and loads the complete state of a training in one file, for bit-equal resumption.

The file has a pytree's leaves, including random keys, in the order of JAX's flattening; the algorithm provides the
structure.
"""

import pathlib
from typing import Any

import jax
import numpy as np
from jax.experimental import multihost_utils

from ..datatypes import ValidationError, array_file
from ..datatypes import validation as v


def _is_key(leaf: Any) -> bool:
    return jax.numpy.issubdtype(leaf.dtype, jax.dtypes.prng_key)


def _whole(leaf: jax.Array) -> np.ndarray:
    """A leaf of all processes that train together."""
    alone = not isinstance(leaf, jax.Array) or leaf.is_fully_addressable
    read = jax.random.key_data if alone else jax.jit(jax.random.key_data)
    data = read(leaf) if _is_key(leaf) else leaf
    if alone or data.is_fully_replicated:
        return np.asarray(data)
    return np.asarray(multihost_utils.process_allgather(data, tiled=True))


def save_state(path: pathlib.Path, state: Any) -> pathlib.Path:
    """Writes all arrays of a pytree atomically; of several processes, all of which call this, the first writes."""
    leaves = [_whole(x) for x in jax.tree.leaves(state)]
    if jax.process_index() > 0:
        return path

    def write(temporary: pathlib.Path) -> None:
        with temporary.open("wb") as file:
            np.savez(file, **{f"leaf_{k:05d}": leaf for k, leaf in enumerate(leaves)})  # type: ignore[arg-type]

    return v.write_atomically(path, write)


def load_state(path: pathlib.Path, like: Any) -> Any:
    """Reads a state that `save_state` wrote.

    Args:
      like: a state of the same training, such as the initial one; its values are not used.

    Raises:
      ValidationError: the file does not exist, is damaged, or belongs to a training with other shapes.
    """
    if not path.is_file():
        raise ValidationError(f"training state: found no file {path}, needed one that a training wrote.")
    leaves, structure = jax.tree.flatten(like)
    arrays_by_name = array_file.load(path, "a training state", "begin a new run with --start-from")
    found = [arrays_by_name[name] for name in sorted(arrays_by_name)]
    keys = [_is_key(leaf) for leaf in leaves]
    needed = [jax.eval_shape(jax.random.key_data, x) if k else x for x, k in zip(leaves, keys, strict=True)]
    if [(x.shape, x.dtype) for x in found] != [(x.shape, np.dtype(x.dtype)) for x in needed]:
        raise ValidationError(
            f"training state: found arrays of other shapes in {path}, needed those of this training; "
            "take the environment and options that it was written with."
        )
    arrays = [jax.random.wrap_key_data(x) if k else jax.numpy.asarray(x) for x, k in zip(found, keys, strict=True)]
    return jax.tree.unflatten(structure, arrays)
