"""Imports optional packages and loads weights, with one-sentence errors if they are missing."""

import importlib
from collections.abc import Callable
from typing import Any

from . import validation as v


def package(name: str, where: str, extra: str, instead: str = "") -> Any:
    """Imports a package of an optional extra.

    Args:
      where: the requesting option.
      instead: the alternative.

    Raises:
      ValidationError: the package or one that it needs is not installed or cannot be imported.
    """
    try:
        return importlib.import_module(name)
    except ImportError as error:
        found = f"a package {name!r} that cannot be imported ({error})"
        if isinstance(error, ModuleNotFoundError):
            found = f"no package {(error.name or name)!r}"
        hint = f'install `pip install "urbanverse_mjx[{extra}]"`' + (f", or {instead}" if instead else "")
        raise v.fail(where, found, "it", hint) from error


def weights[Model](load: Callable[[], Model], where: str, name: str, needed: str) -> Model:
    """Calls `load` for the weights of a name or folder.

    Raises:
      ValidationError: the weights do not exist.
    """
    try:
        return load()
    except (OSError, ValueError) as error:
        reason = str(error).splitlines()[0][:100]
        raise v.fail(where, f"no weights under {name!r} ({reason})", f"the network once or {needed}") from error
