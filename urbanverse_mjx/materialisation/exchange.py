"""Exchanges objects that a place does not have (`exchange.toml`), and leaves out houses that would hang in the air.

An option of the regional look (`exchange` of a set in `scenes/library.json`), because it changes layouts.
"""

import dataclasses
import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import shapely

from ..assets import AssetIndex
from ..assets.selection.search import library
from ..datatypes import AssetRecord, HullSet, PlacedObject, SceneLayout
from ..datatypes.toml_table import table
from . import choice, overlap
from .facades import KINDS
from .shortlists import LeftOut

#: m above the ground from which on a house hangs in the air.
HANGING = 1.5
IN_THE_AIR = "it is a house that would hang in the air"
#: Records tried in the place of one, nearest in size first.
TRIED = 24


def row_of(record: AssetRecord, country: str) -> dict[str, Any] | None:
    """The row of `exchange.toml` that replaces a record in a country; None for what may stay."""
    for row in table(__file__)["rows"]:
        applies = country in row["foreign"] if "foreign" in row else country not in row["native"]
        if row["recipe"] == record.recipe and record.params.get("variant") in row["variants"] and applies:
            return row
    return None


def native(placed: PlacedObject, record: AssetRecord, country: str) -> Iterator[tuple[PlacedObject, AssetRecord]]:
    """Objects that may stand in the place of one that its country does not have, nearest in size first; none for what
    may stay."""
    row = row_of(record, country)
    if row is None:
        return
    size = [e * s for e, s in zip(record.extent_xyz, placed.scale, strict=True)]
    objects = library()
    uids = [uid for uid in objects.get_uids_all() if uid.startswith(f"{record.leaf}/")]
    found = [r for r in objects.records(uids) if r.recipe == row["recipe"] and r.params["variant"] == row["instead"]]
    found.sort(
        key=lambda r: (round(sum(abs(math.log(a / b)) for a, b in zip(size, r.extent_xyz, strict=True)), 3), r.uid)
    )
    for new in found[:TRIED]:
        scale = choice.scale_to((size[0], size[1], size[2]), new)
        mass = round(max(new.mass * math.prod(scale), 1e-3), 3)
        changed = dataclasses.replace(
            placed,
            asset_uid=new.uid,
            category=new.leaf,
            scale=scale,
            mass=mass,
            friction=new.friction_coefficient,
            movable=new.movable,
        )
        yield changed, new


def exchanged(
    layout: SceneLayout, country: str, index: AssetIndex, hulls_of: Callable[[AssetRecord], HullSet]
) -> SceneLayout:
    """The layout with what its country has; an object stays if no other fits without entering a third one deeper."""

    def body(placed: PlacedObject, record: AssetRecord) -> overlap.Body:
        return overlap.Body(placed, record, overlap.prisms_of(placed, hulls_of(record)))

    objects = list(layout.objects)
    foreign = [k for k, p in enumerate(objects) if row_of(index.get(p.asset_uid), country) is not None]
    if not foreign:
        return layout
    bodies = [body(p, index.get(p.asset_uid)) for p in objects]
    for k in foreign:
        old, others = bodies[k], [*bodies[:k], *bodies[k + 1 :]]
        for new in (body(*one) for one in native(old.placed, old.record, country)):
            if all(overlap.penetration(new, b) <= overlap.penetration(old, b) for b in others):
                bodies[k], objects[k] = new, new.placed
                break
    return dataclasses.replace(layout, objects=tuple(objects))


def hanging(layout: SceneLayout) -> list[LeftOut]:
    """The houses and shops of a layout that begin more than `HANGING` m above the nearest ground."""
    shapes = [shapely.Polygon(r.polygon) for r in layout.ground]
    tree = shapely.STRtree(shapes)
    found = []
    for placed in layout.objects:
        if placed.category not in KINDS:
            continue
        point = shapely.Point(placed.position[:2])
        k = int(tree.nearest(point))
        near = shapely.get_coordinates(shapely.shortest_line(shapes[k], point))[0]
        a, b, c = layout.ground[k].plane
        if placed.position[2] - float(np.dot((a, b), near) + c) > HANGING:
            found.append(LeftOut(placed.id, placed.label, IN_THE_AIR))
    return found
