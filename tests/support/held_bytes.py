"""How many bytes the arrays take that an object holds on the host and on devices."""

import functools
import gc
import types
from typing import Any

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import warp as wp

#: What is looked into: containers, calls with their arguments, and objects of these packages' classes
#: and structs of Warp's kernels.
_CONTAINERS = (dict, list, tuple, set, frozenset, functools.partial, types.MethodType)
_PACKAGES = ("urbanverse_mjx", "mujoco", "mujoco_warp", "collections")


def held_bytes(*roots: object) -> int:
    """Bytes of all arrays of numpy, JAX and Warp, textures and MuJoCo models that can be reached, each counted once.

    Functions and other packages' objects, such as kernels, are not looked into.
    """
    seen: set[int] = set()
    sizes: dict[object, int] = {}
    kept: list[Any] = []  # whatever is made on the way must live, or its number would be given to another object
    front = list(roots)
    while front:
        found = front.pop()
        if id(found) in seen:
            continue
        seen.add(id(found))
        kept.append(found)
        size = _size(found)
        if size is None:
            kinds = (object, *type(found).__mro__)
            known = any(k.__module__.partition(".")[0] in _PACKAGES for k in kinds)
            if known or kinds[-2].__name__ == "StructInstance" or isinstance(found, _CONTAINERS):
                front.extend(gc.get_referents(found))
        else:
            place, number = size
            sizes[place] = max(number, sizes.get(place, 0))
    return sum(sizes.values())


def _size(found: Any) -> tuple[object, int] | None:
    """Where an array's memory stands and its bytes; None for what is no array."""
    if isinstance(found, np.ndarray):
        while isinstance(found.base, np.ndarray):
            found = found.base
        return found.__array_interface__["data"][0], found.nbytes
    if isinstance(found, jax.Array):
        if jnp.issubdtype(found.dtype, jax.dtypes.prng_key):
            return id(found), 0
        return found.unsafe_buffer_pointer(), found.nbytes
    if isinstance(found, wp.array):
        return found.ptr, found.capacity
    if isinstance(found, wp.Texture2D | wp.Texture3D):
        texels = sum(int(np.prod(shape)) for shape in found._mip_shapes)
        return found.id, texels * found.num_channels * wp.types.type_size_in_bytes(found.dtype)
    if isinstance(found, mujoco.MjModel):
        return id(found), mujoco.mj_sizeModel(found)
    return None
