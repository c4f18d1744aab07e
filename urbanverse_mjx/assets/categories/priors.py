"""Priors of each leaf, independent of meshes: sizes, materials, mass, support and affordances.

One reviewed row per leaf (`assets_index/priors.csv`), each with a reason. The columns `length`, `width`, `height` (m)
and `mass` (kg) hold three numbers: least, median, greatest. `fill` is the solid share of the bounding box, and for the
median

    mass = length * width * height * fill * density of the materials.

Some leaves have several makes (a bench of wood, steel or concrete): `materials` and `fill` then hold several entries
separated by slashes, the most common first.
"""

import dataclasses
import functools
from collections.abc import Mapping
from typing import Any

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.settings import asset_root

from . import ontology
from .materials import material, number, read_rows, sources

#: Kinds of support of objects that are held where they are, see `is_held`.
HELD = frozenset({"fixed", "alive", "hangs"})
#: Share of its bounding box that a form's outer surface encloses; geometry, or measured on our recipes' meshes where
#: no formula exists (saloon cars 0.43-0.45, vans 0.54, lorries 0.70, people 0.2 to 0.4).
FORMS: Mapping[str, float] = {
    "block": 0.95,
    "slab": 0.95,
    "cylinder": 0.785,  # pi / 4
    "rod": 0.75,
    "building": 0.7,
    "van body": 0.7,
    "board": 0.65,
    "arch": 0.65,
    "boulder": 0.62,
    "body": 0.6,
    "casing": 0.6,
    "sack": 0.6,
    "taper": 0.55,
    "dome": 0.55,
    "ball": 0.5236,  # pi / 6
    "ellipsoid": 0.5236,
    "cup": 0.5,
    "car body": 0.45,
    "hull": 0.45,
    "figure": 0.45,
    "tower": 0.45,
    "dense frame": 0.4,
    "goblet": 0.4,
    "mound": 0.4,
    "statue": 0.4,
    "bowl": 0.35,
    "cone": 0.32,
    "plant": 0.3,
    "roof": 0.2,
    "frame": 0.15,
    "panel on post": 0.12,
    "aircraft": 0.12,
}
#: free: three sizes of their own; round: as wide as long; lying: as high as wide; wheel: as high as long; ball: both.
SECTIONS = ("free", "round", "lying", "wheel", "ball")
#: Support of an object: fixed to the ground, hanging on a wall or ceiling, standing by its weight, on free wheels, on
#: braked wheels or tracks, or on its own feet.
RESTS = ("fixed", "hangs", "stands", "rolls", "parked", "alive")
#: Position of the front (+x): none, at an end of the length (a car), or along the long side (a bench).
FRONTS = ("none", "end", "side")
TRAVERSABILITY = ("pass through", "push through", "obstacle")
COMPOSITIONS = ("single", "group", "scene")
#: published: the note begins with the key of a page in sources.csv; standard: the numbers follow the document that the
#: note names, from memory; typical: an estimate, with its reason in the note.
BASES = ("standard", "published", "typical")

#: Quantity to which a record's mass is proportional: its bounding box; its height squared (people, posts); its front or
#: ground face (sheets, screens, tables); its length; or none (a tripod weighs the same folded), and then the mass is
#: drawn from the row's range.
GROWTHS = ("box", "height", "face", "ground", "length", "nothing")

Range = tuple[float, float, float]


@dataclasses.dataclass(frozen=True)
class Make:
    """A construction (make) of a leaf's objects.

    Attributes:
      shares: material -> share of the solid volume, sums to 1; the first one is the visible surface.
      fill: solid share of the bounding box at median size.
    """

    shares: Mapping[str, float]
    fill: float

    @property
    def density(self) -> float:
        """kg/m^3 of the solid mix."""
        return sum(share * material(name).density for name, share in self.shares.items())

    @property
    def surface(self) -> str:
        """The material of the visible surface."""
        return next(iter(self.shares))


@dataclasses.dataclass(frozen=True)
class Prior:
    """The prior of one leaf; sizes in m, mass in kg, ranges as (least, median, greatest)."""

    leaf: str
    length: Range
    width: Range
    height: Range
    section: str
    form: str
    makes: tuple[Make, ...]
    mass: Range
    grows_with: str
    contact: str
    rest: str
    front: str
    receptacle: bool
    support_surface: bool
    walkable: bool
    enterable: bool
    traversability: str
    affordances: tuple[str, ...]
    interactive_parts: tuple[str, ...]
    composition_type: str
    basis: str
    note: str

    @property
    def bulk(self) -> float:
        """Share of the bounding box inside the outer surface, whether hollow or solid."""
        return FORMS[self.form]

    @property
    def box_volume(self) -> float:
        """m^3 of the median's bounding box."""
        return self.length[1] * self.width[1] * self.height[1]

    def median_mass(self, make: int = 0) -> float:
        """kg of the median-sized object in one of its makes."""
        return self.box_volume * self.makes[make].fill * self.makes[make].density


_COLUMNS = (
    *("middle", "leaf", "length", "width", "height", "section", "form", "materials", "fill", "mass", "grows_with"),
    *("contact", "rest", "front", "receptacle", "support_surface", "walkable", "enterable", "traversability"),
    *("affordances", "interactive_parts", "composition_type", "basis", "note"),
)
_CHOICES = {
    "section": SECTIONS,
    "form": tuple(FORMS),
    "grows_with": GROWTHS,
    "rest": RESTS,
    "front": FRONTS,
    "traversability": TRAVERSABILITY,
    "composition_type": COMPOSITIONS,
    "basis": BASES,
}
_FLAGS = ("receptacle", "support_surface", "walkable", "enterable")


def _range(text: str, where: str) -> Range:
    parts = text.split()
    values = tuple(number(part, where, 1e-4, 1e10) for part in parts)
    if len(values) != 3 or not values[0] <= values[1] <= values[2]:
        raise ValidationError(f"{where}: found {text!r}, needed three rising numbers: least, median, greatest.")
    return values


def _make(text: str, fill: str, where: str) -> Make:
    shares: dict[str, float] = {}
    for part in text.split(", "):
        name, _, percent = part.rpartition(" ")
        material(name)
        shares[name] = number(percent, f"{where} share of {name}", 0.1, 100.0) / 100.0
    if abs(sum(shares.values()) - 1.0) > 1e-9:
        raise ValidationError(f"{where}: found shares that sum to {100 * sum(shares.values()):g}, needed 100.")
    return Make(shares, number(fill, f"{where} fill", 1e-7, 1.0))


def _words(text: str) -> tuple[str, ...]:
    return tuple(text.split(", ")) if text else ()


def _prior(row: dict[str, str], where: str) -> Prior:
    leaf = row["leaf"]
    if ontology.category_of(leaf)[1] != row["middle"]:
        raise ValidationError(
            f"{where}: found {row['middle']!r} above {leaf!r}, needed {ontology.category_of(leaf)[1]!r}."
        )
    for key, options in _CHOICES.items():
        if row[key] not in options:
            raise ValidationError(f"{where} {key}: found {row[key]!r}, needed one of {', '.join(options)}.")
    for key in _FLAGS:
        if row[key] not in ("yes", "no"):
            raise ValidationError(f"{where} {key}: found {row[key]!r}, needed yes or no.")
    mixes, fills = row["materials"].split(" / "), row["fill"].split(" / ")
    if len(mixes) != len(fills):
        raise ValidationError(f"{where}: found {len(mixes)} makes and {len(fills)} fills, needed one fill for each.")
    sizes = {key: _range(row[key], f"{where} {key}") for key in ("length", "width", "height", "mass")}
    if sizes["length"][1] < sizes["width"][1]:
        raise ValidationError(f"{where}: found a median width above the length, needed length >= width.")
    if not row["note"]:
        raise ValidationError(f"{where}: found no note, needed the reason of the row.")
    key = row["note"].partition(":")[0]
    if row["basis"] == "published" and not (key in sources() and sources()[key].address):
        raise ValidationError(f"{where}: found {key!r} as its source, needed the key of a page in sources.csv.")
    values: dict[str, Any] = {
        **sizes,
        **{key: row[key] for key in (*_CHOICES, "note")},
        **{key: row[key] == "yes" for key in _FLAGS},
    }
    return Prior(
        leaf=leaf,
        makes=tuple(_make(mix, fill, where) for mix, fill in zip(mixes, fills, strict=True)),
        contact=material(row["contact"]).name,
        affordances=_words(row["affordances"]),
        interactive_parts=_words(row["interactive_parts"]),
        **values,
    )


@functools.cache
def priors() -> dict[str, Prior]:
    """leaf -> prior, all leaves of the ontology in its order.

    Raises:
      ValidationError: a row is not valid, a leaf occurs twice, or a leaf has no row.
    """
    table: dict[str, Prior] = {}
    for where, row in read_rows(asset_root() / "priors.csv", _COLUMNS):
        if row["leaf"] in table:
            raise ValidationError(f"{where}: found {row['leaf']!r} twice, needed one row per leaf.")
        table[row["leaf"]] = _prior(row, where)
    missing = [leaf for leaf in ontology.categories() if leaf not in table]
    if missing:
        raise ValidationError(f"priors.csv: found no row for {', '.join(missing[:5])}, needed one for every leaf.")
    return table


def prior(leaf: str) -> Prior:
    """The row of a leaf.

    Raises:
      UnknownLabelError: the ontology has no such leaf.
    """
    ontology.category_of(leaf)
    return priors()[leaf]


def is_held(leaf: str) -> bool:
    """Whether objects of a leaf are held where they are in reality: hanging ones (awnings, signs, air conditioners),
    anchored ones (trees, lamps, bollards), people and animals, which balance actively, and buildings.

    Raises:
      UnknownLabelError: the ontology has no such leaf.
    """
    return prior(leaf).rest in HELD or ontology.category_of(leaf)[0] == "building"
