"""Published dimensions and masses of real objects with their web pages, and the errors of the records against them.

In `assets_index/published.csv`, an empty cell is a figure that the page does not state. If several pages have figures
of a leaf, their median is the leaf's reference value. Excluded figures are in `published_set_aside.csv` with the
reason: the page measures something other than the box of the leaf's object.
"""

import dataclasses
import functools
import statistics
from collections.abc import Mapping, Sequence

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.settings import asset_root

from . import ontology
from .materials import number, read_rows, sources

QUANTITIES = ("length", "width", "height", "mass")


@dataclasses.dataclass(frozen=True)
class Published:
    """One object of a leaf with the figures of a page in m and kg; None if the page does not state one.

    Attributes:
      leaf: exact leaf name.
      item: the object of the page.
      source: key of sources.csv, one that has an address.
    """

    leaf: str
    item: str
    length: float | None
    width: float | None
    height: float | None
    mass: float | None
    source: str


@dataclasses.dataclass(frozen=True)
class SetAside:
    """Excluded figures of a page (m and kg by quantity), its address and the reason."""

    leaf: str
    item: str
    figures: Mapping[str, float]
    title: str
    address: str
    reason: str


@functools.cache
def published() -> tuple[Published, ...]:
    """All rows that are used.

    Raises:
      ValidationError: a row without any figure, or whose source is no page; a leaf that does not exist.
    """
    rows = []
    for where, row in read_rows(asset_root() / "published.csv", ("leaf", "thing", *QUANTITIES, "source")):
        figures = _figures(row, where)
        if row["source"] not in sources() or not sources()[row["source"]].address:
            raise ValidationError(
                f"{where}: found the source {row['source']!r}, needed the key of a page in sources.csv."
            )
        values = {quantity: figures.get(quantity) for quantity in QUANTITIES}
        rows.append(Published(row["leaf"], row["thing"], **values, source=row["source"]))
    return tuple(rows)


@functools.cache
def set_aside() -> tuple[SetAside, ...]:
    """The excluded figures.

    Raises:
      ValidationError: a row without any figure, address or reason; a leaf that does not exist.
    """
    columns = ("leaf", "thing", *QUANTITIES, "title", "address", "reason")
    rows = []
    for where, row in read_rows(asset_root() / "published_set_aside.csv", columns):
        figures = _figures(row, where)
        if not row["address"].startswith("http") or not row["reason"]:
            raise ValidationError(f"{where}: found no address or no reason, needed both.")
        rows.append(SetAside(row["leaf"], row["thing"], figures, row["title"], row["address"], row["reason"]))
    return tuple(rows)


def _figures(row: Mapping[str, str], where: str) -> dict[str, float]:
    """quantity -> figure, of the cells that hold one."""
    ontology.category_of(row["leaf"])
    figures = {k: number(row[k], f"{where} {k}", 1e-6) for k in QUANTITIES if row[k]}
    if not figures:
        raise ValidationError(f"{where}: found no figure, needed a length, width, height or mass.")
    return figures


def ground_truths(rows: Sequence[Published]) -> dict[str, dict[str, float]]:
    """leaf -> quantity -> median of the pages' figures."""
    found: dict[str, dict[str, list[float]]] = {}
    for row in rows:
        for quantity in QUANTITIES:
            page = getattr(row, quantity)
            if page is not None:
                found.setdefault(row.leaf, {}).setdefault(quantity, []).append(page)
    return {
        leaf: {quantity: statistics.median(pages) for quantity, pages in quantities.items()}
        for leaf, quantities in found.items()
    }


def errors(rows: Sequence[Published], medians: Mapping[str, Mapping[str, float]]) -> dict[str, dict[str, float]]:
    """quantity -> leaf -> absolute relative error of the medians (leaf -> quantity -> m or kg) against the pages."""
    found: dict[str, dict[str, float]] = {quantity: {} for quantity in QUANTITIES}
    for leaf, quantities in ground_truths(rows).items():
        for quantity, page in quantities.items():
            found[quantity][leaf] = abs(medians[leaf][quantity] / page - 1.0)
    return found
