"""Classes of the perception model: the sky, the kinds of ground, and groups of the ontology's leaves (`classes.json`).

A group has the name of a representative leaf, which the asset search accepts. Within a group the perception model
returns the most similar leaf of its training set (`shown.json`), because the known sizes belong to leaves.
"""

import functools
import itertools
import json
import pathlib
from collections.abc import Sequence

import numpy as np

from ...datatypes import ValidationError
from ...datatypes.ground import GROUND_KINDS
from ...datatypes.recording import SKY

SKY_CLASS = 0
#: Classes 1 to 5 are `GROUND_KINDS` of the same number.
FIRST_OBJECT = len(GROUND_KINDS)
#: Class of objects that belong to no group: they are distinguished from the ground, but not reported.
OTHER = "other"
_GROUND_PREFIX = "ground:"


@functools.cache
def groups() -> dict[str, tuple[str, ...]]:
    """Name of each group of objects -> its leaves."""
    return _read("classes.json")


@functools.cache
def _shown() -> dict[str, tuple[str, ...]]:
    """Name of each group -> the leaves that the model distinguishes."""
    return _read("shown.json")


def _read(name: str) -> dict[str, tuple[str, ...]]:
    body = json.loads(pathlib.Path(__file__).with_name(name).read_text(encoding="utf-8"))
    return {group: tuple(leaves) for group, leaves in body.items()}


@functools.cache
def leaves() -> tuple[str, ...]:
    """The leaves that the model distinguishes, by number; those of a group are consecutive."""
    return tuple(itertools.chain(*_shown().values()))


@functools.cache
def leaf_classes() -> np.ndarray:
    """(L,) i32 number of the class of each of `leaves()`."""
    return np.array([class_of_leaf(leaf) for leaf in leaves()], np.int32)


@functools.cache
def names() -> tuple[str, ...]:
    """All classes by number: the sky, the kinds of ground, `OTHER`, and the groups."""
    return ("sky", *GROUND_KINDS[1:], OTHER, *groups())


#: House fronts, which fill most images.
HOUSE = names().index("house")


def class_of_leaf(leaf: str) -> int:
    """Number of the class of a leaf; `OTHER` for a leaf of no group."""
    for number, leaves in enumerate(groups().values(), FIRST_OBJECT + 1):
        if leaf in leaves:
            return number
    return FIRST_OBJECT


def class_table(categories: Sequence[str]) -> np.ndarray:
    """(A + 1, 2) i32, class of each category of a bank and its number in `leaves()`, -1 = none; the last row, index -1,
    is the sky.

    Raises:
      ValidationError: the kind of a ground category is unknown.
    """
    table, number = [], {leaf: i for i, leaf in enumerate(leaves())}
    for category in categories:
        kind = category.removeprefix(_GROUND_PREFIX)
        if kind == category:
            table.append((class_of_leaf(category), number.get(category, -1)))
        elif kind in GROUND_KINDS[1:]:
            table.append((GROUND_KINDS.index(kind), -1))
        else:
            raise ValidationError(
                f"category: found {category!r}, needed ground of {GROUND_KINDS[1:]}; rebuild the bank."
            )
    return np.array([*table, (SKY_CLASS, -1)], np.int32)


def surface_codes() -> np.ndarray:
    """(classes,) u8: code of each class in a `Recording`'s surface image."""
    codes = np.zeros(len(names()), np.uint8)
    codes[SKY_CLASS] = SKY
    codes[1:FIRST_OBJECT] = np.arange(1, FIRST_OBJECT)
    return codes
