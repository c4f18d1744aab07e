"""Random choice among fitting assets, and scaling of an asset to a box: pure functions of their arguments and a
seed."""

import hashlib
import math
from collections.abc import Callable, Sequence

from ..datatypes import AssetRecord

Vector = tuple[float, float, float]

#: Number of cousins that are drawn together, and of ranking entries per cousin among which a seed chooses.
BATCH, POOL_PER_COUSIN = 5, 2
#: Limits of an asset's uniform scale, and of one axis relative to the others, beyond which people and chairs look
#: distorted.
SCALE = (0.8, 1.25)
STRETCH = (0.92, 1.09)
#: The limits for house fronts and fences, which exist in any size.
SCALE_OF_FRONTS = (0.4, 2.5)
FRONTS = ("fence", "guard rail", "wall", "awning")


def pick(options: int, *key: object) -> int:
    """A pseudo-random number in [0, options) that depends on the key only and is the same on every machine."""
    digest = hashlib.sha256("\x1f".join(str(k) for k in key).encode("utf-8")).digest()
    return int.from_bytes(digest[:8], "big") % options


def one_each[T](ranking: Sequence[T], ranked: bool, count: int, draw: Callable[[T], int]) -> list[T]:
    """Selects one entry for each of `count` cousins, all different as long as there are enough.

    The entry of a cousin does not depend on `count`: cousins are drawn in batches of `BATCH`; the first batch chooses
    among the best entries, the next among as many more, and so on.

    Args:
      ranking: at least one entry, best first.
      ranked: whether the order is by fit; if so, the first cousin gets the best entry. Otherwise all fit equally well,
        and any may be drawn.
      draw: function that returns a number for an entry; entries with the smallest numbers are drawn first.
    """
    drawn = [0] if ranked else []
    for first in range(0, count, BATCH):
        among = range(min(POOL_PER_COUSIN * (first + BATCH), len(ranking)) if ranked else len(ranking))
        free = sorted(set(among) - set(drawn), key=lambda place: (draw(ranking[place]), place))
        drawn += free[: first + BATCH - len(drawn)]
    return [ranking[drawn[k % len(drawn)]] for k in range(count)]


def is_front(record: AssetRecord) -> bool:
    """Whether the asset is a house front or a fence, which may be stretched along any axis."""
    house = record.category[0] == "building" and record.width >= 3.0
    return house or record.leaf in FRONTS


def scale_to(size: Vector, record: AssetRecord) -> Vector:
    """Scale factors along the asset's axes that fit it to the box, within the limits that preserve its appearance."""
    ratios = [want / have for want, have in zip(size, record.extent_xyz, strict=True)]
    if is_front(record):
        low, high = SCALE_OF_FRONTS
        return tuple(round(min(max(r, low), high), 4) for r in ratios)  # type: ignore[return-value]
    whole = min(max(math.prod(ratios) ** (1 / 3), SCALE[0]), SCALE[1])
    parts = (whole * min(max(r / whole, STRETCH[0]), STRETCH[1]) for r in ratios)
    return tuple(round(min(max(p, SCALE[0]), SCALE[1]), 4) for p in parts)  # type: ignore[return-value]
