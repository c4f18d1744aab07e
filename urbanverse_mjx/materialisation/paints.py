"""Colours of vehicles, clothes and furniture, and species of trees, as a city has them (`paints.toml`)."""

import bisect
import dataclasses
import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from ..assets.meshes.repaint import OWN
from ..assets.meshes.tints import is_free
from ..datatypes import AssetRecord, PlacedObject
from ..datatypes import validation as v
from ..datatypes.toml_table import table
from . import choice

_TABLE: dict[str, Any] = table(__file__)
_KIND_OF: Mapping[str, str] = {leaf: kind for kind, leaves in _TABLE["leaves"].items() for leaf in leaves}
_TREE = "vegetation.tree"
#: Kinds of [leaves].
KINDS = ("cars", "vans", "two_wheels", "taxis", "buses", "rickshaws", "people")
#: Limits of the scale that gives another tree the height of the one before.
_STRETCH = (0.8, 1.3)


def colours() -> Mapping[str, tuple[str, ...]]:
    """The shades ("#rrggbb") of each colour by name."""
    return _TABLE["colours"]


def _of_place(name: str, place: tuple[str, str]) -> Any:
    """The entry of a city, else of its country, else of the world."""
    rows = _TABLE[name]
    return next((rows[key] for key in (*place, "world") if key in rows), None)


def _listed(name: str, place: tuple[str, str]) -> str:
    """The heading under which a city or country stands in a table of lists; "world" without one."""
    return next((heading for key in place for heading, names in _TABLE[name].items() if key in names), "world")


def _drawn(shares: Mapping[str, float], *key: object) -> str:
    """A shade of a colour drawn by its share."""
    names, bounds = list(shares), list(itertools.accumulate(shares.values()))
    at = choice.pick(10**6, "paint", *key) / 10**6 * bounds[-1]
    shades = _TABLE["colours"][names[bisect.bisect_right(bounds, at)]]
    return shades[choice.pick(len(shades), "shade", *key)]


def paint_of(placed: PlacedObject, leaf: str, place: tuple[str, str], *key: object) -> tuple[str, ...]:
    """The colours of an object's painted parts, or () to leave them as they are.

    Args:
      leaf: of its record.
      place: (city, country).
      key: what distinguishes this choice from others.

    Raises:
      ValidationError: `paints.toml` names an unknown kind.
    """
    match _KIND_OF.get(leaf):
        case None:
            return (OWN,) if is_free(leaf) else ()
        case "cars":
            return (_drawn(_TABLE["cars"][_listed("continents", place)], *key, placed.id),)
        case ("vans" | "two_wheels") as kind:
            return (_drawn(_TABLE[kind], *key, placed.id),)
        case ("taxis" | "buses" | "rickshaws") as kind:
            return tuple(_of_place(kind, place))
        case "people":
            return tuple(_drawn(_TABLE[part], *key, placed.id, part) for part in ("upper", "lower"))
        case kind:
            raise v.fail(f"kind of the leaf {leaf!r}", v.show(kind), ", ".join(KINDS), "correct paints.toml")


def painted(placed: PlacedObject, record: AssetRecord, place: tuple[str, str], *key: object) -> PlacedObject:
    """The object in the colours of its place."""
    return dataclasses.replace(placed, paint=paint_of(placed, record.leaf, place, *key))


def species(place: tuple[str, str], sky: str) -> frozenset[int]:
    """Variants of `vegetation.tree` that stand in the streets of a place at the season of a sky."""
    plants = _TABLE["plants"]
    names = plants[_listed("climates", place)]
    seasonal = plants["seasons"]
    return frozenset(_TABLE["species"][n] for n in names if n not in seasonal or sky.startswith(seasonal[n]))


def replanted(
    placed: PlacedObject,
    record: AssetRecord,
    allowed: frozenset[int],
    trees: Callable[[], Sequence[AssetRecord]],
    *key: object,
) -> Iterator[tuple[PlacedObject, AssetRecord]]:
    """Trees of allowed species in the place of one of another, most like it in height first; none for what may stay.

    Args:
      trees: function that returns the records of trees.
    """
    if record.recipe != _TREE or record.params["variant"] in allowed:
        return
    height = record.height * placed.scale[2]
    fits = [r for r in trees() if r.recipe == _TREE and r.params["variant"] in allowed]
    fits.sort(
        key=lambda r: (round(abs(math.log(height / r.height)), 1), choice.pick(10**6, "tree", *key, placed.id, r.uid))
    )
    low, high = _STRETCH
    for new in fits:
        scale = round(min(max(height / new.height, low), high), 4)
        changed = dataclasses.replace(
            placed,
            asset_uid=new.uid,
            scale=(scale, scale, scale),
            mass=round(new.mass * scale**3, 3),
            friction=new.friction_coefficient,
            movable=False,
        )
        yield changed, new
