"""`materialise`: a scene graph becomes a layout of one cousin."""

import dataclasses
import math
from collections.abc import Callable, Sequence

import shapely

from ..assets import AssetIndex, UnknownLabelError, load_hulls, nearest_leaves
from ..assets.appearances.ground_materials import material_ids
from ..assets.appearances.skies import sky_ids
from ..datatypes import (
    PAINT_KINDS,
    AssetRecord,
    GraphObject,
    GroundRegion,
    HullSet,
    PlacedGround,
    PlacedObject,
    SceneGraph,
    SceneLayout,
)
from ..datatypes import validation as v
from . import choice, overlap, surroundings

#: Grows whenever the same graph, index and seed would give another layout.
VERSION = "1"
#: m: a box whose foot is this near to the ground is put onto it, one farther off is meant to hang or to be buried.
SNAP = 0.3


@dataclasses.dataclass(frozen=True)
class Materialisation:
    """A layout and what was done to get it.

    Attributes:
      layout: the cousin.
      skipped: (object id, label) of objects left out because no asset is known for their label.
      moved: (object id, m) of objects moved to end a penetration.
      unresolved: pairs of object ids that still penetrate.
    """

    layout: SceneLayout
    skipped: tuple[tuple[str, str], ...]
    moved: tuple[tuple[str, float], ...]
    unresolved: tuple[tuple[str, str], ...]


def _records_for(thing: GraphObject, index: AssetIndex) -> Sequence[AssetRecord]:
    """The index's records for an object's label.

    Raises:
      NounError: no leaf has this name or synonym, or the leaf has no asset; names the three nearest that have.
    """
    try:
        records = index.by_label(thing.label)
    except UnknownLabelError:
        records = ()
    if records:
        return records
    known = set(index.leaves)
    nearest = [leaf for leaf in nearest_leaves(thing.label, count=len(known) + 700) if leaf in known][:3]
    needed = "a label that an asset is known for; the nearest are " + ", ".join(repr(leaf) for leaf in nearest)
    raise v.fail(
        f"object {thing.id!r}.label",
        v.show(thing.label),
        needed,
        "correct the label, or leave such objects out with --skip-unknown",
    )


def _place(thing: GraphObject, chosen: choice.Choice, support: overlap.Support) -> PlacedObject:
    """The asset's origin under the box, on the ground where the box's foot is near it."""
    record, scale = chosen.record, chosen.scale
    x, y, middle = thing.center
    foot = middle - thing.size[2] / 2
    ground = min(support.under(thing), key=lambda height: abs(height - foot), default=foot)
    z = ground if abs(ground - foot) <= SNAP else foot
    return PlacedObject(
        id=thing.id,
        label=thing.label,
        category=record.leaf,
        asset_uid=record.uid,
        position=(x, y, round(z, 4)),
        yaw=thing.yaw,
        scale=scale,
        mass=round(max(record.mass * math.prod(scale), 1e-3), 3),
        friction=record.friction_coefficient,
        movable=record.movable,
    )


def _materials(graph: SceneGraph, seed: int, cousin: int) -> tuple[PlacedGround, ...]:
    """One material per kind, pavements that do not touch may differ; descriptors choose where there are any."""
    if any(r.descriptor is not None for r in graph.ground):
        return surroundings.placed_ground(graph, surroundings.grounds(graph, cousin + 1, seed), cousin)
    pavements = [r for r in graph.ground if r.kind == "sidewalk"]
    joined = shapely.union_all([shapely.Polygon(r.polygon) for r in pavements])
    parts = sorted(shapely.get_parts(joined), key=lambda p: p.bounds) if pavements else []

    def piece(region: GroundRegion) -> int:
        inside = shapely.Polygon(region.polygon).representative_point()
        return next((i for i, part in enumerate(parts) if part.covers(inside)), 0)

    placed = []
    for region in graph.ground:
        options = material_ids(region.kind)
        part = piece(region) if region.kind == "sidewalk" else 0
        material = options[choice.pick(len(options), "ground", seed, cousin, graph.id, region.kind, part)]
        placed.append(PlacedGround(region.id, region.kind, region.polygon, region.plane, material))
    return tuple(placed)


def _sky(graph: SceneGraph, seed: int, cousin: int) -> str:
    if graph.sky_descriptor is not None:
        return surroundings.skies(graph, cousin + 1, seed)[cousin].uid
    skies = sky_ids()
    return skies[choice.pick(len(skies), "sky", seed, cousin, graph.id)]


def materialise(
    graph: SceneGraph,
    index: AssetIndex,
    seed: int,
    cousin: int = 0,
    skip_unknown: bool = False,
    hulls_of: Callable[[AssetRecord], HullSet] = load_hulls,
) -> Materialisation:
    """Chooses assets, materials and a sky for a graph and places them; the same inputs give the same layout.

    Args:
      graph: what the scene holds.
      index: the assets to choose from.
      seed, cousin: choose among equally good assets, materials and skies.
      skip_unknown: leave out objects whose label no asset is known for, instead of refusing the graph.
      hulls_of: collision hulls of a record, for the penetration test.

    Raises:
      NounError: a label without an asset (unless skipped); names the object and the three nearest leaves.
    """
    v.integer(seed, "seed", 0)
    v.integer(cousin, "cousin", 0)
    carrying = [r for r in graph.ground if r.kind not in PAINT_KINDS]
    support = overlap.Support([(shapely.Polygon(r.polygon), r.kind, r.plane) for r in carrying])
    bodies: list[overlap.Body] = []
    skipped: list[tuple[str, str]] = []
    for thing in graph.objects:
        try:
            records = _records_for(thing, index)
        except v.NounError:
            if not skip_unknown:
                raise
            skipped.append((thing.id, thing.label))
            continue
        chosen = choice.choose(thing, records, seed, cousin)
        placed = _place(thing, chosen, support)
        bodies.append(overlap.Body(placed, chosen.record, overlap.prisms_of(placed, hulls_of(chosen.record))))
    left = overlap.resolve(bodies, support)
    layout = SceneLayout(
        **surroundings.identity(graph, cousin, seed),
        objects=tuple(overlap.moved(b) for b in bodies),
        ground=_materials(graph, seed, cousin),
        sky=_sky(graph, seed, cousin),
        hashes={"assets": index.content_hash(), "materialiser": VERSION},
    )
    moved = tuple((b.placed.id, b.distance) for b in bodies if b.distance)
    pairs = tuple((bodies[i].placed.id, bodies[j].placed.id) for i, j in left)
    return Materialisation(layout, tuple(skipped), moved, pairs)
