"""Loads TOML data tables stored beside the modules that use them."""

import os
import pathlib
import tomllib
from typing import Any


def table(module: str | os.PathLike[str]) -> dict[str, Any]:
    """Loads the TOML file beside a module: `table(__file__)` in `trades.py` returns the contents of `trades.toml`, with
    arrays as tuples."""
    return _fixed(tomllib.loads(pathlib.Path(module).with_suffix(".toml").read_text(encoding="utf-8")))


def _fixed(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _fixed(inner) for key, inner in value.items()}
    return tuple(map(_fixed, value)) if isinstance(value, list) else value
