"""The common interface of all collections of the index: objects, skies, roads, sidewalks.

    from urbanverse_mjx.assets.selection.libraries import library

    skies = library("sky")
    uids = skies.get_uids_conditioned(seasons=["winter"], snow=True)

The names are those of the official toolkit. To add a collection, add a line to `MODULES` and a function `library` that
returns an object with these methods.
"""

import importlib
from collections.abc import Mapping, Sequence
from typing import Any, Protocol, runtime_checkable

import numpy as np

from urbanverse_mjx.datatypes import ValidationError


@runtime_checkable
class Library(Protocol):
    """One collection, addressed by uid."""

    def get_uids_all(self) -> list[str]:
        """Every uid, in a fixed order."""
        ...

    def categories(self, level: int = 1) -> list[str]:
        """The names of a level of its classes; level 1 is the most general."""
        ...

    def filters(self) -> list[str]:
        """The names that `get_uids_conditioned` takes."""
        ...

    def get_uids_conditioned(self, *, query: str | None = None, top_k: int = 100, **conditions: Any) -> list[str]:
        """The uids that meet all conditions; with a query the `top_k` nearest, best first."""
        ...

    def load_annotations(self, uids: Sequence[str]) -> dict[str, dict[str, Any]]:
        """uid -> field -> value, official names, SI units."""
        ...

    def load_thumbnails(self, uids: Sequence[str]) -> dict[str, np.ndarray]:
        """uid -> (H, W, 3) uint8."""
        ...

    def explain_annotation(self, field: str) -> str:
        """Meaning, unit and source of a field."""
        ...

    def check_integrity(self) -> list[str]:
        """One sentence per missing or damaged file; empty if there is none."""
        ...

    def repair(self) -> list[str]:
        """Repairs the faults that `check_integrity` finds; returns the remaining ones."""
        ...


_APPEARANCES = "appearances.appearance_search"
#: name of a collection -> module of `assets` with a function `library`.
MODULES: Mapping[str, str] = {
    "object": "selection.search",
    "sky": _APPEARANCES,
    "road": _APPEARANCES,
    "sidewalk": _APPEARANCES,
}


def library(name: str) -> Library:
    """Returns a collection by name; if a module has several, its `library` takes the name.

    Raises:
      ValidationError: no such collection.
    """
    if name not in MODULES:
        raise ValidationError(f"library: found {name!r}, needed one of {', '.join(MODULES)}.")
    module = importlib.import_module(f"urbanverse_mjx.assets.{MODULES[name]}")
    several = list(MODULES.values()).count(MODULES[name]) > 1
    return module.library(name) if several else module.library()
