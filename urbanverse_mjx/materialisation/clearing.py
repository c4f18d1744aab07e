"""Removes overlap of objects: duplicates go, then objects move slightly; those without a free place are left out and
listed."""

import dataclasses
from collections.abc import Mapping, Sequence

import numpy as np
import shapely

from ..datatypes import GraphObject, PlacedObject
from . import overlap
from .shortlists import LeftOut

#: Share of the smaller one's ground that two objects of one label share when they are one object detected twice.
SAME_PLACE = 0.5


@dataclasses.dataclass(frozen=True)
class Cleared:
    """The placed objects and the changes made; see `cousins.Cousin`.

    Attributes:
      no_room: (id of an object that was left out for lack of space, id of the one that overlaps it).
    """

    placed: tuple[PlacedObject, ...]
    left_out: tuple[LeftOut, ...]
    moved: tuple[tuple[str, float], ...]
    unresolved: tuple[tuple[str, str], ...]
    no_room: tuple[tuple[str, str], ...]

    @property
    def crowded(self) -> tuple[str, ...]:
        """Ids of the objects that found no room, and of those in their way."""
        return tuple(dict.fromkeys(name for pair in (*self.unresolved, *self.no_room) for name in pair))


def clear(
    bodies: Sequence[overlap.Body], support: overlap.Support, graph_objects: Mapping[str, GraphObject]
) -> Cleared:
    """Ends penetrations.

    Objects are moved by at most `overlap.LIMIT`. Of a remaining pair, the movable one is left out, because contact
    forces would throw it off; two fixed objects may overlap a little. An object sunk in a pavement without a free place
    next to it is put on it.
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
        reason = f"there is no free place within {overlap.LIMIT:g} m of {other.id!r} ({other.category})"
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
    """The less certain ones of objects of one label whose boxes share most of the smaller one's ground."""
    boxes = np.array([overlap.ground_box(obj) for obj in graph_objects], dtype=object)
    doubles: dict[int, LeftOut] = {}
    for i, j in sorted((int(i), int(j)) for i, j in shapely.STRtree(boxes).query(boxes, "intersects").T if i < j):
        a, b = graph_objects[i], graph_objects[j]
        apart = abs(a.center[2] - b.center[2]) >= (a.size[2] + b.size[2]) / 2
        if a.label != b.label or apart or i in doubles or j in doubles:
            continue
        shared = boxes[i].intersection(boxes[j]).area / min(boxes[i].area, boxes[j].area)
        if shared > SAME_PLACE:
            k, kept = (i, b) if (a.score, b.id) < (b.score, a.id) else (j, a)
            reason = f"it shares {100 * shared:.0f} % of its ground with {kept.id!r}, which is the same object"
            doubles[k] = LeftOut(graph_objects[k].id, graph_objects[k].label, reason)
    return list(doubles.values())
