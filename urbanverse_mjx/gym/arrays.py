"""Converts JAX arrays to NumPy or PyTorch and back, with DLPack, so that PyTorch shares JAX's memory."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ..datatypes import ValidationError

OUTPUTS = ("numpy", "torch", "jax")


def exporter(output: str) -> Callable[[Any], Any]:
    """Returns a function that converts a pytree of JAX arrays to another library's arrays.

    Args:
      output: "numpy" (writable copies), "torch" (on JAX's device with shared memory; do not write to it) or "jax".

    Raises:
      ValidationError: the name is unknown, or PyTorch is not installed.
    """
    if output == "jax":
        return lambda tree: tree
    if output == "numpy":
        return lambda tree: jax.tree.map(np.array, jax.device_get(tree))
    if output != "torch":
        raise ValidationError(f"output: found {output!r}, needed one of {', '.join(OUTPUTS)}.")
    try:
        import torch  # pyright: ignore[reportMissingImports]
    except ImportError as error:
        raise ValidationError("output: found 'torch', needed PyTorch to be installed; `pip install torch`.") from error
    return lambda tree: jax.tree.map(torch.from_dlpack, tree)


def to_jax(array: Any) -> jax.Array:
    """Converts an array of NumPy, PyTorch or JAX to a float32 JAX array."""
    if hasattr(array, "detach"):
        array = jnp.from_dlpack(array.detach().contiguous())
    return jnp.asarray(array, jnp.float32)
