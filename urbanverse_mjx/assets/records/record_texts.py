"""Makes the texts of a record: description, main colours, class-specific attributes."""

import dataclasses
import json
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from urbanverse_mjx.datatypes import AssetRecord

from ..categories.physical import Physical
from ..categories.priors import Make, Prior
from ..meshes.base_shapes import BaseShape
from ..meshes.tints import BASIC, color_names, is_free, tinted

LEAST_COLOR = 0.08  # share of the visible surface below which a colour is not a main one
MOST_COLORS = 4
# Parameters of recipes that a tint or a scale invalidates.
_UNSTABLE = ("color", "colour", "roof", "length", "width", "height", "size", "side", "shoulder_height", "variant")


@dataclasses.dataclass(frozen=True)
class Shown:
    """The appearance of a record: record and measures of its base shape, scale and tint (None for the base shape
    itself)."""

    record: AssetRecord
    shape: BaseShape
    scale: NDArray[np.float64] | None
    tint: NDArray[np.float64] | None


def main_colors(leaf: str, shown: Sequence[Shown]) -> tuple[list[list[str]], list[list[float]]]:
    """For each record, the basic names of its main colours in descending order, and their shares, which sum to 1."""
    free, names = is_free(leaf), list(BASIC)
    total = np.zeros((len(shown), len(names)))
    rows_of: dict[str, list[int]] = {}
    for k, one in enumerate(shown):
        rows_of.setdefault(one.shape.uid, []).append(k)
    for rows in rows_of.values():
        shape = shown[rows[0]].shape
        still = np.array([0.0, 1.0, 1.0])
        tint = np.array([still if (t := shown[k].tint) is None else t for k in rows])
        found = color_names(np.rint(tinted(shape.colors, tint[:, None], free, shape.paint)))
        for color, share in enumerate(shape.share):
            np.add.at(total, (np.array(rows), found[:, color]), share)
    colors, shares = [], []
    for row in total:
        order = [k for k in np.argsort(-np.round(row, 6), kind="stable")[:MOST_COLORS] if row[k] >= LEAST_COLOR]
        order = order or [int(row.argmax())]
        share = [round(float(row[k] / row[order].sum()), 3) for k in order]
        share[0] = round(1.0 - sum(share[1:]), 3)
        colors.append([names[k] for k in order])
        shares.append(share)
    return colors, shares


def attributes(record: AssetRecord) -> str:
    """The class-specific attributes as JSON: `attribute_<name>` from the parameters of the recipe's variant."""
    stable = {f"attribute_{k}": str(v) for k, v in record.params.items() if k not in _UNSTABLE}
    return json.dumps(stable, sort_keys=True)


def descriptions(
    row: Prior, makes: Sequence[Make], values: Physical, colors: Sequence[Sequence[str] | None]
) -> list[str]:
    """One sentence per record, without its full stop."""
    texts = []
    sizes = zip(makes, values.length, values.width, values.height, values.mass, colors, strict=True)
    for make, length, width, height, mass, seen in sizes:
        matter = [name for name, share in make.shares.items() if share >= 0.15 and name not in row.leaf][:2]
        of = f" of {' and '.join(matter)}" if matter and row.rest != "alive" else ""
        unit, scale = ("m", 1.0) if max(length, height) >= 1.0 else ("cm", 100.0)
        sides = [f"{_digits(scale * side)} {unit}" for side in (length, width, height)]
        words = f"{' and '.join(seen[:2])} " if seen else ""
        texts.append(f"{words}{row.leaf}{of}, {sides[0]} long, {sides[1]} wide and {sides[2]} high, {_weight(mass)}")
    return texts


def _weight(mass: float) -> str:
    if mass >= 2000.0:
        return f"{_digits(mass / 1000.0)} t"
    return f"{_digits(mass)} kg" if mass >= 1.0 else f"{_digits(1000.0 * mass)} g"


def _digits(value: float) -> str:
    """Three digits and no exponent: 7190, 45.3, 0.137."""
    return f"{float(f'{value:.3g}'):.10g}"
