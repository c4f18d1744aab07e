"""Drawing among what fits, and scaling an asset to a box: pure functions of their arguments and a seed."""

import hashlib
import math
from collections.abc import Callable, Sequence

from ..datatypes import AssetRecord

Vector = tuple[float, float, float]

#: Cousins that are drawn together, and how many entries of a ranking a seed chooses among for each of them.
BATCH, POOL_PER_COUSIN = 5, 2
#: Limits of an asset's uniform scale, and of one axis relative to the others, beyond which people and chairs look
#: distorted.
SCALE = (0.8, 1.25)
STRETCH = (0.92, 1.09)
#: House fronts and fences come in any size.
SCALE_OF_FRONTS = (0.4, 2.5)
FRONTS = ("fence", "guard rail", "wall", "awning")


def pick(options: int, *key: object) -> int:
    """A number in [0, options) that depends on the key alone: the same on every machine, unrelated between keys."""
    digest = hashlib.sha256("\x1f".join(str(k) for k in key).encode("utf-8")).digest()
    return int.from_bytes(digest[:8], "big") % options


def one_each[T](ranking: Sequence[T], ranked: bool, count: int, draw: Callable[[T], int]) -> list[T]:
    """`count` entries for as many cousins, all different while there are enough.

    The entry of a cousin does not depend on how many are asked for: `BATCH` of them are drawn at a time, of which the
    first batch chooses among the best entries, the next among as many more, and so on.

    Args:
      ranking: at least one entry, best first.
      ranked: whether the order is by fit: then the first cousin gets the best. Otherwise all fit equally well, and any
        may be drawn.
      draw: number of an entry; the smallest are drawn first.
    """
    drawn = [0] if ranked else []
    for first in range(0, count, BATCH):
        among = range(min(POOL_PER_COUSIN * (first + BATCH), len(ranking)) if ranked else len(ranking))
        free = sorted(set(among) - set(drawn), key=lambda place: (draw(ranking[place]), place))
        drawn += free[: first + BATCH - len(drawn)]
    return [ranking[drawn[k % len(drawn)]] for k in range(count)]


def is_front(record: AssetRecord) -> bool:
    """Whether the asset is a house front or a piece of fence, which may be stretched along any axis."""
    house = record.category[0] == "building" and record.width >= 3.0
    return house or record.leaf in FRONTS


def scale_to(size: Vector, record: AssetRecord) -> Vector:
    """Factors along the asset's axes that bring it near the box, within what keeps its appearance."""
    ratios = [want / have for want, have in zip(size, record.extent_xyz, strict=True)]
    if is_front(record):
        low, high = SCALE_OF_FRONTS
        return tuple(round(min(max(r, low), high), 4) for r in ratios)  # type: ignore[return-value]
    whole = min(max(math.prod(ratios) ** (1 / 3), SCALE[0]), SCALE[1])
    parts = (whole * min(max(r / whole, STRETCH[0]), STRETCH[1]) for r in ratios)
    return tuple(round(min(max(p, SCALE[0]), SCALE[1]), 4) for p in parts)  # type: ignore[return-value]
