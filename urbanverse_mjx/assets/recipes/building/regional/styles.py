"""Appearance of a region's buildings: `traditions.toml` as frozen records."""

import dataclasses
import functools
import pathlib
import tomllib
from collections.abc import Mapping
from typing import Any

from ....meshes.palette import Color

Colors = tuple[Color, ...]
#: Kinds of shops that signs and shop windows distinguish, in the order in which variants take them.
TRADES = ("cafe", "food", "general", "wear", "health", "hair", "stay", "bank")
#: Variants of each size: the same geometry in other colours, with other shops.
DRESSINGS = 3


@dataclasses.dataclass(frozen=True)
class Form:
    """One kind of building, in several sizes. Tuples of colours hold one for each dressing, repeated as needed.

    Attributes:
      sizes: (width in m, number of floors) of each size.
      ground_height, storey, depth, attic: m; `attic` is the wall above the last floor.
      wall: kind of wall (`facade_images.wall`, or "corrugated", "tiles").
      colors, trim, base: of the wall, of sills and cornices, and of the ground floor.
      window: style of the panes (`panes.pane`); frame: their colours.
      window_size, sill, spacing: m; height of the sill above the floor; distance of the bays.
      hood: above windows: "", "lintel", "slab", "pediment" or "arch".
      grille: in front of windows: "", "bars" or "cage".
      shutters: colours of open leaves, none without.
      balcony: kind (`balconies.KINDS`) or "".
      balcony_at: floors "all", "upper", "second" or "ends" (second and last), then bays "all", "odd", "middle" or
        "sides".
      rail: colours of railings.
      ground: kind of ground floor (`ground_floors.KINDS`).
      unit: m, width of a shop.
      arcade: m, depth of an arcade in front of the ground floor; arched: whether its openings are round.
      boards: (back, ink) of signs.
      awning: colours of the cloth, none without.
      roof: kind (`roofs.KINDS`); roof_colors; rise: m.
      course: whether string courses mark the floors.
      extras: names (`extras.KINDS`), each with an optional share or number.
      leaf: leaf of its records.
    """

    sizes: tuple[tuple[float, int], ...]
    ground_height: float = 3.6
    storey: float = 3.0
    depth: float = 7.0
    attic: float = 0.35
    wall: str = "plaster"
    colors: Colors = ("off white",)
    trim: Colors = ("off white",)
    base: Colors = ("off white",)
    window: str = "casement"
    frame: Colors = ("white",)
    window_size: tuple[float, float] = (1.1, 1.6)
    sill: float = 0.8
    spacing: float = 2.3
    hood: str = ""
    grille: str = ""
    shutters: Colors = ()
    balcony: str = ""
    balcony_at: str = "all all"
    rail: Colors = ("black",)
    ground: str = "shutters"
    unit: float = 4.0
    arcade: float = 0.0
    arched: bool = False
    boards: tuple[tuple[Color, Color], ...] = (("white", "black"),)
    sign: str = "fascia"
    awning: Colors = ()
    roof: str = "flat"
    roof_colors: Colors = ("dark concrete",)
    rise: float = 2.0
    course: bool = False
    extras: tuple[str, ...] = ()
    leaf: str = "retail"

    def __post_init__(self) -> None:
        for name, colors in (("colors", self.colors), ("trim", self.trim), ("base", self.base), ("frame", self.frame)):
            if not colors:
                raise ValueError(f"form: found no {name}, needed at least one colour.")

    @property
    def variants(self) -> int:
        return DRESSINGS * len(self.sizes)


@dataclasses.dataclass(frozen=True)
class Tradition:
    """The buildings of a region.

    Attributes:
      name: part of the uids of its records.
      language: of its signs (`words.toml`).
      places: cities and countries whose graphs it serves; a city goes before a country.
      forms: kinds of buildings.
    """

    name: str
    language: str
    places: tuple[str, ...]
    forms: tuple[Form, ...]


@functools.cache
def traditions() -> Mapping[str, Tradition]:
    """All traditions, by name."""
    found: dict[str, Tradition] = {}
    for path in sorted(pathlib.Path(__file__).parent.glob("traditions/*.toml")):
        for name, row in tomllib.loads(path.read_text(encoding="utf-8")).items():
            forms = tuple(Form(**_fixed(form)) for form in row["forms"])
            found[name] = Tradition(name, row["language"], tuple(row["places"]), forms)
    return found


def _fixed(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _fixed(inner) for key, inner in value.items()}
    return tuple(map(_fixed, value)) if isinstance(value, list) else value


def nth(colors: tuple[Any, ...], number: int) -> Any:
    """The entry of a dressing."""
    return colors[number % len(colors)]
