"""Published dimensions and masses of real things, each with the page it was read on, and how far the priors are off.

`assets_index/published.csv`: an empty cell is a figure that the page does not give.
"""

import dataclasses
import functools
from collections.abc import Sequence

from urbanverse_mjx.datatypes import NounError
from urbanverse_mjx.settings import asset_root

from . import ontology
from .materials import number, read_rows, sources
from .priors import prior

QUANTITIES = ("length", "width", "height", "mass")


@dataclasses.dataclass(frozen=True)
class Published:
    """One thing of a leaf as a page describes it: m and kg, None where the page is silent.

    Attributes:
      leaf: exact leaf name; thing: what the page speaks of.
      source: key of sources.csv, one that has an address.
    """

    leaf: str
    thing: str
    length: float | None
    width: float | None
    height: float | None
    mass: float | None
    source: str


@functools.cache
def published() -> tuple[Published, ...]:
    """All rows.

    Raises:
      NounError: a row without any figure, or whose source is no page; a leaf that does not exist.
    """
    rows = []
    for where, row in read_rows(asset_root() / "published.csv", ("leaf", "thing", *QUANTITIES, "source")):
        ontology.category_of(row["leaf"])
        values = {k: number(row[k], f"{where} {k}", 1e-6) if row[k] else None for k in QUANTITIES}
        if all(value is None for value in values.values()):
            raise NounError(f"{where}: found no figure, needed a length, width, height or mass.")
        if row["source"] not in sources() or not sources()[row["source"]].address:
            raise NounError(f"{where}: found the source {row['source']!r}, needed the key of a page in sources.csv.")
        rows.append(Published(row["leaf"], row["thing"], **values, source=row["source"]))
    return tuple(rows)


def errors(rows: Sequence[Published]) -> dict[str, list[float]]:
    """quantity -> relative errors of the leaves' medians against the rows that give it."""
    found: dict[str, list[float]] = {quantity: [] for quantity in QUANTITIES}
    for row in rows:
        for quantity in QUANTITIES:
            page = getattr(row, quantity)
            if page is not None:
                found[quantity].append(abs(getattr(prior(row.leaf), quantity)[1] / page - 1.0))
    return found
