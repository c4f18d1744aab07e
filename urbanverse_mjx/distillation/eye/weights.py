"""The eye's weights: one file of 16-bit numbers, with the classes they were trained for."""

import json
import os
import pathlib
from typing import Any

import jax
import numpy as np
from flax import traverse_util

from ...datatypes import NounError
from ...datatypes.validation import write_atomically
from . import classes
from .network import EyeNetwork

SCHEMA = "urbanverse.eye/1"
_META = "meta"


def shipped() -> pathlib.Path:
    """The weights that come with the package."""
    return pathlib.Path(__file__).with_name("weights.npz")


def save(path: str | os.PathLike[str], variables: Any, record: dict[str, Any]) -> pathlib.Path:
    """Writes parameters and running statistics; `record` says how they were trained."""
    flat = traverse_util.flatten_dict(jax.device_get(dict(variables)), sep="/")
    body: dict[str, Any] = {name: np.asarray(x, np.float16) for name, x in flat.items()}
    meta = {"schema": SCHEMA, "classes": list(classes.names()), "record": record}
    body[_META] = np.frombuffer(json.dumps(meta).encode("utf-8"), np.uint8)
    return write_atomically(path, lambda temporary: np.savez_compressed(temporary, allow_pickle=False, **body))


def load(path: str | os.PathLike[str] | None = None) -> tuple[Any, dict[str, Any]]:
    """Variables of `EyeNetwork` as float32, and the record of their training.

    Raises:
      NounError: no such file, or weights for other classes or another network.
    """
    path = pathlib.Path(path or shipped())
    if not path.is_file():
        raise NounError(
            f"{path}: found no weights of the eye, needed them; train them with "
            "`python -m urbanverse_mjx.distillation.train_eye`."
        )
    try:
        with np.load(path, allow_pickle=False) as file:
            body = {name: file[name] for name in file.files}
        meta = json.loads(body.pop(_META).tobytes().decode("utf-8"))
    except (OSError, ValueError, KeyError) as error:
        raise NounError(f"{path}: found an unreadable file ({error}), needed weights of the eye.") from error
    if meta.get("schema") != SCHEMA or tuple(meta.get("classes", ())) != classes.names():
        raise NounError(f"{path}: found weights for other classes, needed this version's; train them again.")
    return traverse_util.unflatten_dict({k: x.astype(np.float32) for k, x in body.items()}, sep="/"), meta["record"]


def network(dtype: Any = np.float32) -> EyeNetwork:
    """The network that the weights belong to."""
    return EyeNetwork(len(classes.names()), dtype=dtype)
