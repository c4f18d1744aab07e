"""The perception model's network: an encoder of residual blocks, a pyramid back up to half size, and small heads.

The outputs follow Panoptic-DeepLab (Cheng et al., CVPR 2020): classes per pixel, a map of instance centres, and for
every pixel of an object the offset to its centre. A further output is depth in a canonical camera, as in Metric3D (Yin
et al., ICCV 2023): depth times `CANONICAL_FOCAL` over the image's focal length, which depends on the image alone. The
last output is the leaf within each class at a quarter of the size; all pixels of an object vote for it.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from flax import linen as nn
from flax import traverse_util

from ...datatypes import ValidationError

#: Sides of an image are multiples of this: the encoder halves five times.
STRIDE = 32
#: Image pixels per output pixel along each side.
OUTPUT_STRIDE = 2
#: Output pixels per pixel of the leaf output along each side.
LEAF_STRIDE = 2
#: Size that the perception model was trained at: height, width.
SIZE = (576, 1024)
CANONICAL_FOCAL = 300.0  # pixels; about the middle of the lenses it was trained with
#: Unit of the offset to the centre in output pixels, and unit of depth in m.
OFFSET_UNIT = 16.0
DEPTH_UNIT = 8.0
WIDTHS, BLOCKS = (32, 48, 96, 128, 160), (1, 3, 6, 6, 5)
_PYRAMID = (96, 96, 64, 64)


#: The network's outputs are JAX arrays; decoding uses NumPy arrays.
type Array = jax.Array | np.ndarray


class Seen(NamedTuple):
    """Outputs at half the image's size, h x w.

    classes: (n, h, w, C) logits; centre: (n, h, w) in about [0, 1]; offset: (n, h, w, 2) rows and columns to the
    centre, in `OFFSET_UNIT` output pixels; log_depth: (n, h, w) log of canonical depth over `DEPTH_UNIT`; leaves:
    (n, h / `LEAF_STRIDE`, w / `LEAF_STRIDE`, L) logits, comparable within a class alone.
    """

    classes: Array
    centre: Array
    offset: Array
    log_depth: Array
    leaves: Array


class _Conv(nn.Module):
    """Convolution, batch normalisation and, by default, ReLU."""

    features: int
    kernel: int = 3
    stride: int = 1
    activate: bool = True
    dtype: Any = jnp.float32
    scale_init: Any = nn.initializers.ones

    @nn.compact
    def __call__(self, x: jax.Array, train: bool) -> jax.Array:
        k, s = self.kernel, self.stride
        x = nn.Conv(self.features, (k, k), (s, s), "SAME", use_bias=False, dtype=self.dtype)(x)
        x = nn.BatchNorm(use_running_average=not train, momentum=0.98, dtype=self.dtype, scale_init=self.scale_init)(x)
        return nn.relu(x) if self.activate else x


class _Block(nn.Module):
    """Basic residual block (He et al., 2016), halving the size where `stride` is 2. It begins as the identity, which
    helps deep networks (Goyal et al., 2017) and lets a trained network grow, see `grown`."""

    features: int
    stride: int = 1
    dtype: Any = jnp.float32

    @nn.compact
    def __call__(self, x: jax.Array, train: bool) -> jax.Array:
        y = _Conv(self.features, stride=self.stride, dtype=self.dtype)(x, train)
        y = _Conv(self.features, activate=False, dtype=self.dtype, scale_init=nn.initializers.zeros)(y, train)
        if self.stride > 1 or x.shape[-1] != self.features:
            x = _Conv(self.features, 1, self.stride, activate=False, dtype=self.dtype)(x, train)
        return nn.relu(x + y)


class _Repeated(nn.Module):
    """A residual block as the body of a scan over blocks of equal size."""

    features: int
    train: bool
    dtype: Any = jnp.float32

    @nn.compact
    def __call__(self, x: jax.Array, _: None) -> tuple[jax.Array, None]:
        return _Block(self.features, dtype=self.dtype, name=_BLOCK)(x, self.train), None


#: Name of the block in `_Repeated`, and beginnings of the names of single blocks (by number) and of scans (by level).
_BLOCK, _SINGLE, _SCAN = "block", "_Block_", "_Blocks_"


def _double(x: jax.Array) -> jax.Array:
    """(n, h, w, c) -> (n, 2h, 2w, c), bilinear."""
    n, h, w, c = x.shape
    return jax.image.resize(x, (n, 2 * h, 2 * w, c), "bilinear")


class PerceptionNetwork(nn.Module):
    """The network: images to `Seen`.

    Attributes:
      classes, leaves: number of classes and of leaves.
      widths, blocks: channels and residual blocks at 1/2, 1/4, ... of the size.
      dtype: of the arithmetic; parameters and outputs are float32.
      scanned: whether a scan runs over the equal blocks of a level, whose variables are then `stacked`; the outputs are
        the same. A training step compiles faster.
    """

    classes: int
    leaves: int
    widths: Sequence[int] = WIDTHS
    blocks: Sequence[int] = BLOCKS
    dtype: Any = jnp.float32
    scanned: bool = False

    @nn.compact
    def __call__(self, images: jax.Array, train: bool = False) -> Seen:
        """(n, H, W, 3) float in [0, 1], H and W multiples of `STRIDE`."""
        x = ((images - 0.5) / 0.25).astype(self.dtype)
        levels: list[jax.Array] = []
        number = 0
        for level, (width, blocks) in enumerate(zip(self.widths, self.blocks, strict=True)):
            if level == 0:
                x = _Conv(width, 5, 2, dtype=self.dtype)(x, train)
            for i in range(1 if self.scanned else blocks):
                stride = 2 if level > 0 and i == 0 else 1
                x = _Block(width, stride, dtype=self.dtype, name=f"{_SINGLE}{number + i}")(x, train)
            if self.scanned and blocks > 1:
                over: dict[Any, Any] = {"params": 0, "batch_stats": 0}
                scan = nn.scan(_Repeated, variable_axes=over, split_rngs={"params": True}, length=blocks - 1)
                x, _ = scan(width, train, dtype=self.dtype, name=f"{_SCAN}{level}")(x, None)
            number += blocks
            levels.append(x)
        # Global image features distinguish a wall beside the camera from one across the street.
        whole = nn.relu(nn.Dense(self.widths[-1], dtype=self.dtype)(x.mean((1, 2))))
        x = x + whole[:, None, None]
        for width, skip in zip(_PYRAMID, levels[-2::-1], strict=True):
            side = _Conv(width, 1, activate=False, dtype=self.dtype)(skip, train)
            x = nn.relu(_double(_Conv(width, 1, activate=False, dtype=self.dtype)(x, train)) + side)
            x = _Conv(width, dtype=self.dtype)(x, train)
        what = _Conv(_PYRAMID[-1], dtype=self.dtype)(x, train)
        where = _Conv(32, dtype=self.dtype)(_Conv(48, dtype=self.dtype)(x, train), train)
        classes = nn.Conv(self.classes, (1, 1), dtype=self.dtype)(what).astype(jnp.float32)
        rest = nn.Conv(4, (1, 1), dtype=self.dtype)(where).astype(jnp.float32)
        n, h, w, c = what.shape
        coarse = what.reshape(n, h // LEAF_STRIDE, LEAF_STRIDE, w // LEAF_STRIDE, LEAF_STRIDE, c).mean((2, 4))
        leaves = nn.Conv(self.leaves, (1, 1), dtype=self.dtype)(coarse).astype(jnp.float32)
        return Seen(classes, rest[..., 0], rest[..., 1:3], rest[..., 3], leaves)


def flat_variables(variables: Any) -> dict[tuple[str, ...], Any]:
    """Arrays of variables by their path."""
    flat: Any = traverse_util.flatten_dict(dict(variables))
    return flat


def blocks_of(variables: Any) -> tuple[int, ...]:
    """Residual blocks a level of the network that variables belong to."""
    return tuple(len(level) for level in _block_levels(flat_variables(variables)))


def grown(variables: Any, fresh: Any) -> Any:
    """Variables of today's network from those of one with fewer residual blocks a level, and the same outputs.

    Additional blocks come last in their level and are the identity.

    Args:
      variables: of a network that differs in `BLOCKS` alone.
      fresh: newly initialised variables of today's network.

    Raises:
      ValidationError: the networks differ in more.
    """
    old, new = flat_variables(variables), flat_variables(fresh)
    before, after = (_block_levels(x) for x in (old, new))
    found = blocks_of(variables)
    if len(found) != len(BLOCKS) or any(a > b for a, b in zip(found, BLOCKS, strict=True)):
        raise ValidationError(f"weights: found residual blocks {list(found)}, needed at most {list(BLOCKS)} a level.")
    renamed = {a: b for olds, news in zip(before, after, strict=True) for a, b in zip(olds, news, strict=False)}
    out = dict(new)
    for path, x in old.items():
        to = (path[0], renamed.get(path[1], path[1]), *path[2:])
        if to not in new or np.shape(new[to]) != np.shape(x):
            raise ValidationError(f"weights: found {'/'.join(path)} {np.shape(x)}, needed a part of today's network.")
        out[to] = x
    return traverse_util.unflatten_dict(out)


def stacked(variables: Any) -> Any:
    """Variables of the same network with `scanned`: those of the equal blocks of a level along a new first axis."""
    flat = flat_variables(variables)
    scans = {name: (k, i) for k, names in enumerate(_block_levels(flat)) for i, name in enumerate(names[1:])}
    out: dict[tuple[str, ...], Any] = {}
    parts: dict[tuple[str, ...], dict[int, Any]] = {}
    for path, x in flat.items():
        if path[1] in scans:
            level, place = scans[path[1]]
            parts.setdefault((path[0], f"{_SCAN}{level}", _BLOCK, *path[2:]), {})[place] = x
        else:
            out[path] = x
    joined = {path: jnp.stack([x[i] for i in range(len(x))]) for path, x in parts.items()}
    return traverse_util.unflatten_dict({**out, **joined})


def unstacked(variables: Any) -> Any:
    """The inverse of `stacked`."""
    flat = flat_variables(variables)
    lengths = {int(path[1].removeprefix(_SCAN)): len(x) for path, x in flat.items() if path[1].startswith(_SCAN)}
    singles = sorted({int(p[1].removeprefix(_SINGLE)) for p in flat if p[1].startswith(_SINGLE)})
    out: dict[tuple[str, ...], Any] = {}
    for path, x in flat.items():
        if path[1].startswith(_SCAN):
            first = singles[int(path[1].removeprefix(_SCAN))]
            for i in range(lengths[int(path[1].removeprefix(_SCAN))]):
                out[(path[0], f"{_SINGLE}{first + 1 + i}", *path[3:])] = x[i]
        else:
            out[path] = x
    return traverse_util.unflatten_dict(out)


def _block_levels(flat: Any) -> list[list[str]]:
    """Names of the residual blocks by level; all but the first level begin with a block that halves the size."""
    names = {path[1] for path in flat if path[0] == "params" and path[1].startswith(_SINGLE)}
    levels: list[list[str]] = [[]]
    for name in sorted(names, key=lambda x: int(x.rsplit("_", 1)[1])):
        if ("params", name, "_Conv_2", "Conv_0", "kernel") in flat:
            levels.append([])
        levels[-1].append(name)
    return levels
