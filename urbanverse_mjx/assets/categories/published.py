"""Published dimensions and masses of real objects with their web pages, and the errors of the records against them.

In `assets_index/published.csv`, an empty cell is a figure that the page does not state. If several pages have figures
of a leaf, their median is the leaf's reference value. Excluded figures are in `published_set_aside.csv` with the
reason: the page measures something other than the box of the leaf's object. `held_out_masses.csv` has objects that no
prior was fitted to, which test the masses.
"""

import dataclasses
import functools
import statistics
from collections.abc import Mapping, Sequence

import numpy as np

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.settings import asset_root

from . import ontology
from .materials import number, read_rows, sources
from .physical import Measured, medians, sample
from .priors import prior

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


@dataclasses.dataclass(frozen=True)
class HeldOut:
    """One object that no prior was fitted to: its box (m; None where the page does not state a side) and mass (kg).

    Attributes:
      leaf: exact leaf name.
      item: the object of the page.
      make: main material of a leaf with several makes, or "water" where it is full; empty for the most common make.
      address: the page.
    """

    leaf: str
    item: str
    length: float | None
    width: float | None
    height: float | None
    mass: float
    make: str
    address: str


@functools.cache
def held_out() -> tuple[HeldOut, ...]:
    """Objects of `assets_index/held_out_masses.csv`, which test the masses and must never change a prior.

    Raises:
      ValidationError: a row without mass or address, an object that is used in `published.csv`, or a leaf that does not
        exist.
    """
    rows = []
    used = {(row.leaf, row.item) for row in published()}
    for where, row in read_rows(
        asset_root() / "held_out_masses.csv", ("leaf", "object", *QUANTITIES, "make", "address")
    ):
        figures = _figures(row, where)
        if "mass" not in figures or not row["address"].startswith("http"):
            raise ValidationError(f"{where}: found no mass or no address, needed both.")
        if (row["leaf"], row["object"]) in used:
            raise ValidationError(f"{where}: found an object of published.csv, needed one that no prior was fitted to.")
        length, width, height = (figures.get(side) for side in ("length", "width", "height"))
        box_and_mass = length, width, height, figures["mass"]
        rows.append(HeldOut(row["leaf"], row["object"], *box_and_mass, row["make"], row["address"]))
    return tuple(rows)


def mass_in_box(row: HeldOut) -> float:
    """kg, the prior's mass of an object with this box and make; sides that are not stated are the leaf's median.

    Raises:
      ValidationError: the leaf has no such make.
    """
    of = prior(row.leaf)
    makes = [k for k, make in enumerate(of.makes) if row.make in make.shares]
    if row.make and not makes:
        raise ValidationError(f"{row.leaf}: found no make of {row.make!r}, needed a material of one of its makes.")
    # The make with the largest share of the material; a full object is the one with water.
    make = max(makes, key=lambda k: of.makes[k].shares[row.make]) if row.make else 0
    stated = (row.length, row.width, row.height)
    length, width, height = (
        side or span[1] for side, span in zip(stated, (of.length, of.width, of.height), strict=True)
    )
    extent = np.array([[width, length, height] if of.front == "side" else [length, width, height]])
    measured = Measured(extent, np.array([length * width * height * of.bulk]), np.array([make]))
    return float(sample(of, medians(), measured).mass[0])


def held_out_errors() -> dict[tuple[str, str], float]:
    """(leaf, object) -> computed mass over published mass, minus 1."""
    return {(row.leaf, row.item): mass_in_box(row) / row.mass - 1.0 for row in held_out()}
