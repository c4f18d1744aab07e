"""Draws the objects of a street from records of the catalogue, so that every box has a matching asset."""

import dataclasses
import functools
import json
import math
import random

import numpy as np

from ...assets.appearances import appearance_search
from ...assets.appearances.ground_materials import build_material, material_ids
from ...assets.meshes import instances
from ...assets.meshes.base_shapes import shape_of
from ...assets.meshes.tints import is_free
from ...assets.records.index import load_index
from ...assets.selection import descriptors
from ...assets.selection.search import library
from ...datatypes import ValidationError
from ...datatypes import validation as v
from .profile import Mix

#: Growth forms of trees: base shapes of the leaf "tree", in the order of the index.
GROWTHS = {"broad": 0, "round": 0, "wide": 1, "slim": 2, "blossom": 3, "street": 4, "autumn": 5, "fir": 6, "palm": 7}


@dataclasses.dataclass(frozen=True)
class Item:
    """Box (along the heading, across, up; m) and appearance of a record."""

    label: str
    size: tuple[float, float, float]
    descriptor: tuple[int, ...]


@dataclasses.dataclass(frozen=True)
class _Leaf:
    """Rows of one leaf: extents (n, 3) m, number of the base shape (n,), descriptors (n, 61) u8."""

    extents: np.ndarray
    base: np.ndarray
    descriptors: np.ndarray


@functools.cache
def _leaf(name: str) -> _Leaf:
    index, objects = load_index(), library()
    records = index.by_leaf(name)
    if not records:
        raise ValidationError(
            f"stock: found no shape of {name!r}, needed a leaf of the asset index; try `urbanverse assets search`."
        )
    shapes = [shape_of(r) for r in records]
    place = {shape.uid: k for k, shape in enumerate(shapes)}
    table = objects.table.take(objects.rows_of(name))
    whole = {"tint": (0.0, 1.0, 1.0), "scale": (1.0, 1.0, 1.0)}
    rows = [
        json.loads(params).get(instances.KEY, {"base": uid, **whole})
        for uid, params in zip(table["uid"].to_pylist(), table["params"].to_pylist(), strict=True)
    ]
    base = np.array([place[r["base"]] for r in rows])
    tint, scale = (np.array([r[key] for r in rows]) for key in ("tint", "scale"))
    found = descriptors.of_records(np.full(len(base), is_free(name)), shapes, base, tint, scale)
    numbers = np.concatenate([found.colors, found.layouts[:, 0], found.aspects[:, :1]], axis=1)
    return _Leaf(
        np.array(table["extent_xyz"].to_pylist()), base, np.round(np.clip(numbers, 0, 1) * 255).astype(np.uint8)
    )


def pick(options: Mix, rng: random.Random) -> str:
    """Draws a name from a mix."""
    at = rng.random() * sum(share for _, share in options)
    for name, share in options:
        at -= share
        if at < 0:
            return name
    return options[-1][0]


def draw(name: str, rng: random.Random, near: tuple[float | None, float | None, float | None] | None = None) -> Item:
    """Draws a record of a leaf.

    Args:
      name: the leaf, or "leaf#2" for its third base shape; "tree#palm" by growth.
      rng: only `random()` is called, which is stable over Python versions.
      near: desired (along, across, up) m, with None for a free dimension; one of the five nearest records is drawn.

    Raises:
      ValidationError: the leaf has no such shape.
    """
    leaf, _, variant = name.partition("#")
    rows = _leaf(leaf)
    chosen = np.arange(len(rows.base))
    if variant:
        number = GROWTHS[variant] if variant in GROWTHS else int(variant)
        chosen = chosen[rows.base == number % (int(rows.base.max()) + 1)]
    if near is not None:
        wanted = [(k, x) for k, x in enumerate(near) if x is not None]
        away = sum(np.abs(np.log(rows.extents[chosen, k] / x)) for k, x in wanted)
        chosen = chosen[np.argsort(away, kind="stable")[:5]]
    row = chosen[int(rng.random() * len(chosen))]
    size = tuple(round(float(x), 3) for x in rows.extents[row])
    return Item(leaf, size, tuple(int(x) for x in rows.descriptors[row]))  # type: ignore[arg-type]


def ground_descriptor(kind: str, material: str) -> tuple[int, ...]:
    """Returns the descriptor of a ground material by name.

    Raises:
      ValidationError: no material of this kind has the name.
    """
    if kind in ("road", "sidewalk"):
        return appearance_search.own_ground_descriptor(f"{kind}/{material}")
    v.choice(material, f"material of {kind!r}", material_ids(kind))
    return appearance_search.ground_descriptor(build_material(material).texture)


def around(value: float, spread: float, rng: random.Random) -> float:
    """Returns a value times a random factor between e^-spread and e^spread."""
    return value * math.exp(spread * (2 * rng.random() - 1))
