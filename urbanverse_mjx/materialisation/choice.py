"""Choosing an asset for a box, and how to scale it: pure functions of the box, the records and a seed."""

import dataclasses
import hashlib
import math
from collections.abc import Sequence

from ..datatypes import AssetRecord, GraphObject

Vector = tuple[float, float, float]

#: Records whose distortion is within this of the best are equally good: the seed chooses among them. A side that is
#: off by 5 % costs 0.05.
NEAR_TIE = 0.05
#: How far an asset is scaled as a whole, and how far one axis may leave the others before people and chairs look wrong.
SCALE = (0.8, 1.25)
STRETCH = (0.92, 1.09)
#: House fronts and fences come in any size.
SCALE_OF_FRONTS = (0.4, 2.5)
FRONTS = ("fence", "guard rail", "wall", "awning")


@dataclasses.dataclass(frozen=True)
class Choice:
    """An asset for an object: scale per asset axis; distortion in log units, 0 = same proportions and size."""

    record: AssetRecord
    scale: Vector
    distortion: float


def pick(options: int, *key: object) -> int:
    """A number in [0, options) that depends on the key alone: the same on every machine, unrelated between keys."""
    digest = hashlib.sha256("\x1f".join(str(k) for k in key).encode("utf-8")).digest()
    return int.from_bytes(digest[:8], "big") % options


def distortion(size: Vector, record: AssetRecord) -> float:
    """Root of the summed squared log ratios of the sorted ground sides and of the height.

    Ground sides are compared longer with longer, because a detector may turn a box by a quarter.
    """
    pairs = ((max(size[:2]), record.length), (min(size[:2]), record.width), (size[2], record.height))
    return math.sqrt(sum(math.log(a / b) ** 2 for a, b in pairs))


def is_front(record: AssetRecord) -> bool:
    """Whether the asset is a house front or a piece of fence, which may be stretched along any axis."""
    house = record.category[0] == "building" and record.width >= 3.0
    return house or record.leaf in FRONTS


def scale_to(size: Vector, record: AssetRecord) -> Vector:
    """Factors along the asset's axes that bring it near the box, within what keeps its looks."""
    ratios = [want / have for want, have in zip(size, record.extent_xyz, strict=True)]
    if is_front(record):
        low, high = SCALE_OF_FRONTS
        return tuple(round(min(max(r, low), high), 4) for r in ratios)  # type: ignore[return-value]
    whole = min(max(math.prod(ratios) ** (1 / 3), SCALE[0]), SCALE[1])
    parts = (whole * min(max(r / whole, STRETCH[0]), STRETCH[1]) for r in ratios)
    return tuple(round(min(max(p, SCALE[0]), SCALE[1]), 4) for p in parts)  # type: ignore[return-value]


def choose(thing: GraphObject, records: Sequence[AssetRecord], seed: int, cousin: int) -> Choice:
    """The record whose box is least distorted; among near ties (and only there) seed and cousin decide."""
    ranked = sorted(((distortion(thing.size, r), r.uid, r) for r in records), key=lambda entry: entry[:2])
    ties = [entry for entry in ranked if entry[0] <= ranked[0][0] + NEAR_TIE]
    value, _, record = ties[pick(len(ties), "asset", seed, cousin, thing.id)]
    return Choice(record, scale_to(thing.size, record), value)
