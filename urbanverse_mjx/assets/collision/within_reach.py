"""The base shapes of a set of layouts that a robot can touch, for which closer hulls are worth making.

A shape counts if an instance of it stands on or within `REACH` of ground where a robot may be.
"""

import pathlib
from collections.abc import Iterable, Sequence

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import shapely

from urbanverse_mjx.datatypes import AssetRecord, SceneLayout
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.datatypes.ground import TRAVERSABLE_KINDS

from ..recipes.building.regional.styles import DRESSINGS
from ..records import store
from ..records.regional import MARK, records_of

#: m from a robot's middle to what it may touch, beside any ground that is traversable.
REACH = 1.0
#: Name of a layout's file in the folder of a compiled scene.
FILE = "layout.json"


def shape_of(record: AssetRecord) -> tuple[str, str, int]:
    """Recipe, leaf and variant of a record's base shape; dressings of a regional building share it."""
    variant = int(record.params["variant"])
    return record.recipe, record.leaf, variant - variant % DRESSINGS if MARK in record.uid else variant


def layouts_in(folders: Iterable[pathlib.Path]) -> list[SceneLayout]:
    """The layouts in folders of compiled scenes, at any depth.

    Raises:
      ValidationError: a folder holds none, or one is damaged.
    """
    found = []
    for folder in folders:
        paths = sorted(folder.rglob(FILE))
        if not paths:
            raise v.fail(str(folder), f"no {FILE}", "the folder of compiled scenes", "`urbanverse scene library NAME`")
        found += [SceneLayout.load(path) for path in paths]
    return found


def _records(uids: Sequence[str]) -> dict[str, AssetRecord]:
    """The records of uids of the catalogue and of regional buildings; imported and lying assets, which have no closer
    hulls, are left out."""
    table = store.load_store()
    rows = table.filter(pc.is_in(table["uid"], pa.array(uids, pa.string())))  # pyright: ignore[reportAttributeAccessIssue]
    found = [store.record_of(row) for row in rows.to_pylist()]
    return {r.uid: r for r in (*found, *records_of([uid for uid in uids if MARK in uid]))}


def shapes_of(layouts: Iterable[SceneLayout], in_reach: bool = True) -> set[tuple[str, str, int]]:
    """Shapes (see `shape_of`) of the objects of layouts.

    Args:
      in_reach: only those that a robot can touch.
    """
    found = set()
    for layout in layouts:
        ground = [shapely.Polygon(g.polygon) for g in layout.ground if g.kind in TRAVERSABLE_KINDS]
        near = shapely.union_all(ground).buffer(REACH)
        shapely.prepare(near)
        records = _records(sorted({placed.asset_uid for placed in layout.objects}))
        for placed, record in ((p, records[p.asset_uid]) for p in layout.objects if p.asset_uid in records):
            x, y = (extent * scale / 2 for extent, scale in zip(record.extent_xyz[:2], placed.scale[:2], strict=True))
            corners = np.array([(-x, -y), (x, -y), (x, y), (-x, y)])
            c, s = np.cos(placed.yaw), np.sin(placed.yaw)
            plan = corners @ np.array([(c, s), (-s, c)]) + placed.position[:2]
            if not in_reach or shapely.Polygon(plan).intersects(near):
                found.add(shape_of(record))
    return found
