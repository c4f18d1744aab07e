"""Resolves overlaps of objects: removes duplicates, moves objects slightly, and leaves out and lists those without a
free position."""

import dataclasses
from collections.abc import Mapping, Sequence

import numpy as np
import shapely

from ..datatypes import GraphObject, PlacedObject
from . import overlap
from .shortlists import LeftOut

#: Overlap, as a share of the smaller footprint, from which two objects of one label are the same object detected twice.
MIN_DUPLICATE_OVERLAP = 0.5


@dataclasses.dataclass(frozen=True)
class Cleared:
    """The placed objects and the changes that were made; see `cousins.Cousin`.

    Attributes:
      no_room: pairs of the id of an object that was left out for lack of space and the id of the object that overlaps
        it.
    """

    placed: tuple[PlacedObject, ...]
    left_out: tuple[LeftOut, ...]
    moved: tuple[tuple[str, float], ...]
    unresolved: tuple[tuple[str, str], ...]
    no_room: tuple[tuple[str, str], ...]

    @property
    def crowded(self) -> tuple[str, ...]:
        """Ids of the objects without a free position, and of those that block them."""
        return tuple(dict.fromkeys(name for pair in (*self.unresolved, *self.no_room) for name in pair))


def clear(
    bodies: Sequence[overlap.Body],
    support: overlap.Support,
    graph_objects: Mapping[str, GraphObject],
) -> Cleared:
    """Resolves penetrations.

    Objects are moved by at most `overlap.LIMIT`. Of a remaining pair, the movable one is left out, because contact
    forces would eject it; two fixed objects may overlap slightly. An object that penetrates a pavement and has no free
    position next to it is put on top.
    """
    found = list(bodies)
    left = overlap.resolve(found, support, kerbs=True)
    gone: dict[int, LeftOut] = {}
    no_room = []
    for i, j in left:
        movable = [k for k in (i, j) if found[k].record.movable and k not in gone]
        if i in gone or j in gone or not movable:
            continue
        k = min(
            movable, key=lambda m: (graph_objects[found[m].placed.id].score, found[m].placed.mass, found[m].placed.id)
        )
        other = found[j if k == i else i].placed
        reason = f"there is no free place within {overlap.MAX_MOVE:g} m of {other.id!r} ({other.category})"
        gone[k] = LeftOut(found[k].placed.id, found[k].placed.label, reason)
        no_room.append((found[k].placed.id, other.id))
    kept = [b for k, b in enumerate(found) if k not in gone]
    return Cleared(
        placed=tuple(overlap.moved(b, support.step_up(b)) for b in kept),
        left_out=tuple(gone.values()),
        moved=tuple((b.placed.id, b.distance) for b in kept if b.distance),
        unresolved=tuple((found[i].placed.id, found[j].placed.id) for i, j in left if i not in gone and j not in gone),
        no_room=tuple(no_room),
    )


def found_twice(graph_objects: Sequence[GraphObject]) -> list[LeftOut]:
    """Of pairs of objects of one label whose footprints overlap by most of the smaller one, those of lower
    confidence."""
    boxes = np.array([overlap.ground_box(obj) for obj in graph_objects], dtype=object)
    doubles: dict[int, LeftOut] = {}
    for i, j in sorted((int(i), int(j)) for i, j in shapely.STRtree(boxes).query(boxes, "intersects").T if i < j):
        a, b = graph_objects[i], graph_objects[j]
        apart = abs(a.center[2] - b.center[2]) >= (a.size[2] + b.size[2]) / 2
        if a.label != b.label or apart or i in doubles or j in doubles:
            continue
        shared = boxes[i].intersection(boxes[j]).area / min(boxes[i].area, boxes[j].area)
        if shared > MIN_DUPLICATE_OVERLAP:
            k, kept = (i, b) if (a.score, b.id) < (b.score, a.id) else (j, a)
            reason = f"it shares {100 * shared:.0f} % of its ground with {kept.id!r}, which is the same object"
            doubles[k] = LeftOut(graph_objects[k].id, graph_objects[k].label, reason)
    return list(doubles.values())
