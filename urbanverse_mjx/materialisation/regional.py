"""Gives a cousin the look of its city: houses of the region's tradition, colours of cars and clothes as they are there,
trees of its climate and season, and the place whose roads the compiler draws.

The step comes after materialisation; positions, headings, labels and categories of what stays do not change.
"""

import dataclasses
import itertools
from collections.abc import Callable, Iterable, Sequence

import numpy as np

from ..assets import hull_loader
from ..assets.categories.priors import is_held
from ..assets.records import regional
from ..assets.records.index import AssetIndex
from ..datatypes import AssetRecord, HullSet, PlacedObject, SceneGraph
from ..datatypes import validation as v
from . import exchange as exchange_step
from . import overlap, paints
from .cousins import Cousin, index_of, trees_of
from .facades import dress
from .shortlists import LeftOut

#: Trees tried in the place of one before it is kept.
TRIED = 150


def check_city(graph: SceneGraph) -> None:
    """Checks that a graph's city or country has the regional look.

    Raises:
      ValidationError: it has not.
    """
    if not regional.is_served(graph.source.city, graph.source.country):
        raise v.fail(
            "graph.source.city",
            f"{v.show(graph.source.city)} in {v.show(graph.source.country)}",
            f"one of {', '.join(regional.places())}",
            "correct the city or the country, or leave --regional out",
        )


def localise(
    cousin: Cousin,
    graph: SceneGraph,
    index: AssetIndex | None = None,
    hulls_of: Callable[[AssetRecord], HullSet] | None = None,
    exchange: bool = False,
    standing: bool = False,
) -> Cousin:
    """A cousin with the look of its graph's city; the same cousin if its city has none.

    Where the catalogue's houses are those of the country, they stay.

    Args:
      cousin: a cousin of the graph.
      graph: its source names the city.
      index: records of the cousin's assets; default: from the catalogue.
      hulls_of: function that returns the collision hulls of a record; default: those that the layout asks for.
      exchange: whether objects that its country does not have are exchanged, and houses that would hang in the air left
        out (`materialisation.exchange`).
      standing: see `facades.dress`; an object that nothing holds is left out where it still penetrates another.
    """
    if exchange and regional.is_served(graph.source.city, graph.source.country):
        cousin = _exchanged(cousin, graph, hulls_of)
        index = None
    index = index or index_of(cousin.layout)
    dressed = dress(cousin, graph, index, hulls_of, standing)
    if exchange:
        dressed = _grounded(dressed)
    hulls_of = hulls_of or hull_loader(cousin.layout.hulls)
    layout, place = dressed.layout, (graph.source.city, graph.source.country)
    if not regional.is_served(*place):
        return cousin
    key = (layout.graph_id, layout.seed, layout.cousin)
    allowed = paints.species(place, layout.sky)
    bodies = [_body(p, _record_of(p, index), hulls_of) for p in layout.objects]
    changed, unresolved = set[str](), list(dressed.unresolved)
    for k, old in enumerate(bodies):
        found = paints.replanted(old.placed, old.record, allowed, trees_of, *key)
        new = _fitting(old, (_body(*one, hulls_of) for one in found), [*bodies[:k], *bodies[k + 1 :]])
        if new is None:
            continue
        bodies[k], name = new, new.placed.id
        changed.add(name)
        # It touches only what the tree before touched, and nothing movable touched that.
        unresolved = [pair for pair in unresolved if name not in pair]
        unresolved += [(name, b.placed.id) for b in bodies if b is not new and overlap.penetration(new, b) > 0.0]
    objects = [
        b.placed if regional.MARK in b.record.uid else paints.painted(b.placed, b.record, place, *key) for b in bodies
    ]
    layout = dataclasses.replace(layout, objects=tuple(objects), place=place)
    chosen = {name: c for name, c in dressed.chosen.items() if name not in changed}
    made = dataclasses.replace(dressed, layout=layout, chosen=chosen, unresolved=tuple(unresolved))
    return _parted(made, graph) if standing else made


def _parted(cousin: Cousin, graph: SceneGraph) -> Cousin:
    """Leaves out an object of every pair that still overlaps if nothing holds it (a car), the less certain or else the
    lighter of two: contact forces would throw it out."""
    placed = {p.id: p for p in cousin.layout.objects}
    score = {obj.id: obj.score for obj in graph.objects}
    gone: dict[str, LeftOut] = {}
    for pair in cousin.unresolved:
        loose = [name for name in pair if not is_held(placed[name].category)]
        if not loose or gone.keys() & set(pair):
            continue
        name = min(loose, key=lambda n: (score[n], placed[n].mass, n))
        other = placed[pair[1 - pair.index(name)]]
        reason = f"there is no free place within {overlap.MAX_MOVE:g} m of {other.id!r} ({other.category})"
        gone[name] = LeftOut(name, placed[name].label, reason)
    return _without(cousin, list(gone.values()))


def _exchanged(cousin: Cousin, graph: SceneGraph, hulls_of: Callable[[AssetRecord], HullSet] | None) -> Cousin:
    """The cousin with what its country has."""
    before = cousin.layout
    hulls_of = hulls_of or hull_loader(before.hulls)
    layout = exchange_step.exchanged(before, graph.source.country, index_of(before), hulls_of)
    old = {p.id: p.asset_uid for p in before.objects}
    changed = {p.id for p in layout.objects if old[p.id] != p.asset_uid}
    return dataclasses.replace(
        cousin, layout=layout, chosen={name: c for name, c in cousin.chosen.items() if name not in changed}
    )


def _grounded(cousin: Cousin) -> Cousin:
    """The cousin without houses in the air. After houses have been replaced, so that the others stay the same."""
    return _without(cousin, exchange_step.hanging(cousin.layout))


def _without(cousin: Cousin, gone: Sequence[LeftOut]) -> Cousin:
    """The cousin without some objects."""
    names = {entry.id for entry in gone}
    kept = tuple(p for p in cousin.layout.objects if p.id not in names)
    return dataclasses.replace(
        cousin,
        layout=dataclasses.replace(cousin.layout, objects=kept),
        left_out=(*cousin.left_out, *gone),
        unresolved=tuple(pair for pair in cousin.unresolved if not names & set(pair)),
        chosen={name: c for name, c in cousin.chosen.items() if name not in names},
    )


def _record_of(placed: PlacedObject, index: AssetIndex) -> AssetRecord:
    return (regional.load_regional() if regional.MARK in placed.asset_uid else index).get(placed.asset_uid)


def _body(placed: PlacedObject, record: AssetRecord, hulls_of: Callable[[AssetRecord], HullSet]) -> overlap.Body:
    return overlap.Body(placed, record, overlap.prisms_of(placed, hulls_of(record)))


def _fitting(old: overlap.Body, found: Iterable[overlap.Body], others: Sequence[overlap.Body]) -> overlap.Body | None:
    """The first of `TRIED` trees that enters no other object deeper than the tree before does; None without one."""
    boxes = np.array([b.box for b in others]).reshape(-1, 6)
    for new in itertools.islice(found, TRIED):
        meets = (boxes[:, :3] < new.box[3:]).all(1) & (new.box[:3] < boxes[:, 3:]).all(1)
        near = [others[i] for i in np.flatnonzero(meets).tolist()]
        if all(overlap.penetration(new, b) <= overlap.penetration(old, b) for b in near):
            return new
    return None
