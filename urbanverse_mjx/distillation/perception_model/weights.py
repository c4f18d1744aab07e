"""Stores the perception model's weights and classes in one file, with kernels as 8-bit integers and a scale per output
channel.

A kernel k is stored as q = round(k / s), s = max |k| over its output channel / 127 (symmetric quantisation per channel,
Krishnamoorthi 2018, "Quantizing deep convolutional networks for efficient inference"); all other arrays have 16 bits.
The quantisation only reduces the file; computation is in floating point.
"""

import json
import os
import pathlib
from collections.abc import Sequence
from typing import Any

import jax
import numpy as np
from flax import traverse_util

from ...datatypes import ValidationError, array_file
from ...datatypes import validation as v
from . import classes
from .network import BLOCKS, PerceptionNetwork

SCHEMA = "urbanverse.eye/3"
_META = "meta"
#: Suffix of the name of the array that holds a kernel's scales.
_SCALE = "/scale8"
_MAX_LEVEL = 127
_MIN_SCALE = 2.0**-24  # the least number of 16 bits above 0


def shipped() -> pathlib.Path:
    """Path of the weights that ship with the package."""
    return pathlib.Path(__file__).with_name("weights.npz")


def save(path: str | os.PathLike[str], variables: Any, record: dict[str, Any]) -> pathlib.Path:
    """Writes parameters and running statistics; `record` describes their training."""
    flat = traverse_util.flatten_dict(jax.device_get(dict(variables)), sep="/")
    body: dict[str, Any] = {}
    for name, x in flat.items():
        body |= _packed(name, np.asarray(x))
    meta = {"schema": SCHEMA, "classes": _told_apart(), "record": record}
    body[_META] = np.frombuffer(json.dumps(meta).encode("utf-8"), np.uint8)
    return array_file.save(path, body)


def load(path: str | os.PathLike[str] | None = None) -> tuple[Any, dict[str, Any]]:
    """Variables of `PerceptionNetwork` as float32, and the record of their training.

    Raises:
      ValidationError: the file does not exist, is damaged, or holds weights for other classes or another network.
    """
    path = pathlib.Path(path or shipped())
    if not path.is_file():
        raise ValidationError(
            f"{path}: found no weights of the perception model, needed them; train them with "
            "`python -m urbanverse_mjx.distillation.train_perception`."
        )
    body = array_file.load(path, "weights of the perception model", "copy it again from where it is whole")
    meta = v.parse_json(body.pop(_META, np.zeros(0, np.uint8)).tobytes(), f"{path}: meta")
    if meta.get("schema") != SCHEMA or meta.get("classes") != _told_apart():
        raise ValidationError(f"{path}: found weights for other classes, needed this version's; train them again.")
    return traverse_util.unflatten_dict(_unpacked(body), sep="/"), meta["record"]


def _told_apart() -> list[str]:
    return [*classes.names(), *classes.leaves()]


def network(dtype: Any = np.float32, blocks: Sequence[int] = BLOCKS, scanned: bool = False) -> PerceptionNetwork:
    """The network that the weights belong to; `blocks` may be those of older weights, see `blocks_of`; `scanned`: see
    `PerceptionNetwork`."""
    numbers = len(classes.names()), len(classes.leaves())
    return PerceptionNetwork(*numbers, blocks=tuple(blocks), dtype=dtype, scanned=scanned)


def _packed(name: str, x: np.ndarray) -> dict[str, np.ndarray]:
    """A kernel (..., output channels) as 8-bit numbers and scales; anything else as 16-bit numbers."""
    if not (name.endswith("kernel") and x.ndim >= 2):
        return {name: x.astype(np.float16)}
    largest = np.abs(x).max(axis=tuple(range(x.ndim - 1)))
    # The scale is rounded before quantisation, so that the integers match the stored scale.
    scale = np.maximum(largest / _MAX_LEVEL, _MIN_SCALE).astype(np.float16)
    levels = np.clip(np.round(x / scale.astype(np.float32)), -_MAX_LEVEL, _MAX_LEVEL)
    return {name: levels.astype(np.int8), name + _SCALE: scale}


def _unpacked(body: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """name -> float32 array."""
    scales = {name.removesuffix(_SCALE): x.astype(np.float32) for name, x in body.items() if name.endswith(_SCALE)}
    return {
        name: x.astype(np.float32) * scales.get(name, np.float32(1.0))
        for name, x in body.items()
        if not name.endswith(_SCALE)
    }
