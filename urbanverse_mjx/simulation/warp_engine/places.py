"""Hulls of scenes that come and go: what a scene brings, and where it stands in the engine's tables.

In:   a bank of one scene, in any process; then its arrays. Out: `contact.Hulls` and `kernels.Tables` with the scene in
a place. When: at an exchange. Kernels and their arguments are those of banks that stay.

Every place has rows of the hull table of its own, as many as a scene can have, one more for the end of the last hull,
and segments of the tables of planes and edges as long as its scene needs.
"""

from collections.abc import Callable, Generator, Mapping
from typing import Any

import numpy as np
import warp as wp

from ...datatypes import SceneBank
from ..collision_slots import static_slots
from ..collision_slots.hull_contact import planes_and_edges
from ..segments import SegmentTables, put, put_row
from . import contact

_KINDS = ("objects", "prisms")


def hulls_in_a_place(bank: SceneBank) -> int:
    """Rows of the hull table of a place."""
    return bank.inst_hull.shape[1] + bank.prism_hull.shape[1] + 1


def empty_instances(table: static_slots.InstanceTable) -> static_slots.InstanceTable:
    """A table of as many instances, of which no grid lists one."""
    empty = static_slots.InstanceTable(*map(np.zeros_like, table))
    return empty._replace(grid=np.full_like(table.grid, -1))


def scene_tables(bank: SceneBank, materials: bool) -> dict[str, Any]:
    """What the engine needs of the one scene of a bank: instances by their kind, planes and edges of its hulls."""
    parts = [
        planes_and_edges(bank.hull_vertices[t], bank.hull_triangles[t, :n], bank.hull_planes[t, :n])
        for t, n in enumerate(bank.hull_num_triangles)
    ]
    planes, edges = (np.concatenate(arrays).astype(np.float32) for arrays in zip(*parts, strict=True))
    starts = [np.cumsum([0, *(len(part[i]) for part in parts)]).astype(np.int32) for i in range(2)]
    instances = static_slots.instance_tables(bank, materials)
    return {
        **{kind: table._asdict() for kind, table in zip(_KINDS, instances, strict=True)},
        "plane_start": starts[0],
        "edge_start": starts[1],
        "normal": planes[:, :3],
        "offset": planes[:, 3],
        "start": edges[:, :3],
        "edge": edges[:, 3:],
        "box": bank.hull_box,
        "origin": bank.grid_origin,
    }


class PlacedHulls:
    """The hulls of N places on Warp's current device.

    Args:
      bank: with a row for each place.

    Attributes:
      hulls: for kernels; its arrays may be others after `stage`.
    """

    def __init__(self, bank: SceneBank) -> None:
        self._each = hulls_in_a_place(bank)
        number = bank.num_scenes * self._each
        self._planes = SegmentTables({"normal": (wp.vec3, 1), "offset": (wp.float32, 1)})
        self._edges = SegmentTables({"start": (wp.vec3, 1), "edge": (wp.vec3, 1)})
        self._held: dict[int, tuple[int, int]] = {}
        self.hulls = contact.Hulls()
        self.hulls.plane_start, self.hulls.edge_start = (wp.zeros(number + 1, dtype=int) for _ in range(2))
        self.hulls.centre, self.hulls.half = (wp.zeros(number, dtype=wp.vec3) for _ in range(2))
        self._tell()

    def num_bytes(self, tables: Any) -> int:
        """Of all places on the device; tables: the `kernels.Tables` beside the hulls."""
        fixed = [getattr(self.hulls, name) for name in ("plane_start", "edge_start", "centre", "half")]
        fixed += [
            getattr(getattr(tables, kind), name) for kind in _KINDS for name in static_slots.InstanceTable._fields
        ]
        return self._planes.num_bytes + self._edges.num_bytes + sum(array.capacity for array in fixed)

    def _tell(self) -> None:
        for tables in (self._planes, self._edges):
            for name, array in tables.tables.items():
                setattr(self.hulls, name, array)

    def stage(self, place: int, scene: Mapping[str, Any], tables: Any) -> Generator[None, None, Callable[[], None]]:
        """Copies planes and edges to rows that nobody reads; returns a function that puts the scene in its place, also
        in the `kernels.Tables` given."""
        planes, edges = self._planes.take(len(scene["offset"])), self._edges.take(len(scene["start"]))
        self._tell()
        for segments, first, names in (
            (self._planes, planes, ("normal", "offset")),
            (self._edges, edges, ("start", "edge")),
        ):
            for name in names:
                yield from segments.write(name, first, scene[name])

        def commit() -> None:
            row = place * self._each
            put(self.hulls.plane_start, row, scene["plane_start"] + np.int32(planes))
            put(self.hulls.edge_start, row, scene["edge_start"] + np.int32(edges))
            put(self.hulls.centre, row, scene["box"][:, 0])
            put(self.hulls.half, row, scene["box"][:, 1])
            for kind in _KINDS:
                table = getattr(tables, kind)
                for name, values in scene[kind].items():
                    if name == "hull":
                        values = np.where(values >= 0, values + np.int32(row), values)
                    put_row(getattr(table, name), place, values[0])
            put(tables.origin, place, scene["origin"])
            for segments, first in zip((self._planes, self._edges), self._held.pop(place, ()), strict=False):
                segments.segments.give_back(first)
            self._held[place] = planes, edges

        return commit
