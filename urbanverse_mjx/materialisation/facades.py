"""Gives a cousin the façades of its city: replaces its houses by buildings of the region's tradition.

The step comes after materialisation and changes nothing else: positions, boxes, labels and categories stay, the new
front stands in the plane of the old one.
"""

import dataclasses
import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from scipy.spatial import ConvexHull

from ..assets import hull_loader, load_hulls
from ..assets.categories.priors import is_held
from ..assets.records import regional
from ..assets.records.index import AssetIndex
from ..datatypes import AssetRecord, HullSet, PlacedObject, SceneGraph
from ..datatypes.toml_table import table
from . import choice, overlap
from . import standing as standing_on
from .cousins import Cousin, index_of
from .shortlists import LeftOut

#: Leaf -> kind of shop (`recipes.building.regional.styles.TRADES`), "" for a house; other buildings are kept.
KINDS: Mapping[str, str] = {
    leaf: "" if kind == "house" else kind for kind, leaves in table(__file__).items() for leaf in leaves
}
#: Least and greatest stretch of height and depth; the width always fits, so that rows stay closed.
STRETCH = (0.88, 1.16)
#: Weights, in the unit of |log| of a side: another kind of shop, a house instead of a shop, and each earlier use in the
#: scene; and the greatest share of chance, which tells cousins apart.
OTHER_KIND, OTHER_USE, USED, CHANCE = 0.08, 0.3, 0.1, 0.25
#: |log| of height within which a house of a hand-made graph becomes a house, not a shop: its labels are exact.
HOME = 0.3
#: Leaves that hang on façades, and the m within which they are left out: regional façades have their own.
HUNG = frozenset({"awning", "banner", "air conditioner"})
HUNG_WITHIN = 2.0
WITH_FACADE = "the façade of the region has its own"


@dataclasses.dataclass(frozen=True)
class Block:
    """Plane of the front, middle across, width and depth of a house without what stands out, m in the asset frame."""

    front: float
    middle: float
    width: float
    depth: float

    def scaled(self, scale: Sequence[float]) -> "Block":
        x, y, _ = scale
        return Block(self.front * x, self.middle * y, self.width * y, self.depth * x)


def dress(
    cousin: Cousin,
    graph: SceneGraph,
    index: AssetIndex | None = None,
    hulls_of: Callable[[AssetRecord], HullSet] | None = None,
    standing: bool = False,
) -> Cousin:
    """A cousin with houses of the tradition of its graph's city; the same cousin if no tradition serves the city.

    Args:
      cousin: a cousin of the graph.
      graph: its source names the city.
      index: records of the cousin's assets; default: from the catalogue.
      hulls_of: function that returns the collision hulls of a record; default: those that the layout asks for.
      standing: whether objects that nothing holds and that a new house penetrates are moved to the nearest free
        position, or left out; otherwise only movable ones are left out.
    """
    name = regional.tradition_of(graph.source.city, graph.source.country)
    if name is None:
        return cousin
    index, whole = index or index_of(cousin.layout), hulls_of or load_hulls
    hulls_of = hulls_of or hull_loader(cousin.layout.hulls)
    houses = {p.id: p for p in cousin.layout.objects if _is_house(p, index)}
    exact = graph.source.video == "hand"
    # Closer hulls cut the block of a house where its front recedes.
    records, placed = _replaced(cousin, houses, regional.of_tradition(name), index, whole, exact)
    kept, gone = _without_hung(cousin, placed, index)
    support = overlap.Support.of(cousin.layout.ground) if standing else None
    objects, crowded, overlapping = _fitting(kept, placed, records, index, hulls_of, support)
    layout = dataclasses.replace(
        cousin.layout, objects=objects, hashes={**cousin.layout.hashes, "facades": regional.regional_hash()}
    )
    unresolved = tuple(p for p in cousin.unresolved if not set(p) & (placed.keys() | {g.id for g in gone}))
    return dataclasses.replace(
        cousin,
        layout=layout,
        left_out=(*cousin.left_out, *gone, *crowded),
        unresolved=(*unresolved, *overlapping),
        chosen={key: c for key, c in cousin.chosen.items() if key not in placed},
    )


def _is_house(placed: PlacedObject, index: AssetIndex) -> bool:
    record = index.get(placed.asset_uid)
    return placed.category in KINDS and record.extent_xyz[1] * placed.scale[1] >= 3.0


def block_of(hulls: HullSet) -> Block:
    """The block of a house: the box of its largest hull."""
    largest = max(hulls.hulls, key=lambda h: ConvexHull(np.asarray(h, float)).volume)
    low, high = largest.min(0), largest.max(0)
    return Block(float(high[0]), float(low[1] + high[1]) / 2, float(high[1] - low[1]), float(high[0] - low[0]))


def _replaced(
    cousin: Cousin,
    houses: Mapping[str, PlacedObject],
    candidates: Sequence[AssetRecord],
    index: AssetIndex,
    hulls_of: Callable[[AssetRecord], HullSet],
    exact: bool,
) -> tuple[dict[str, AssetRecord], dict[str, PlacedObject]]:
    """The record and the placed object of every house's successor; exact: see `HOME`."""
    used: dict[str, int] = {}
    records, placed = {}, {}
    for key in sorted(houses):
        old = houses[key]
        record = index.get(old.asset_uid)
        block = block_of(hulls_of(record)).scaled(old.scale)
        height = record.height * old.scale[2]
        seed = (cousin.layout.graph_id, cousin.layout.seed, cousin.layout.cousin, key)

        def cost(new: AssetRecord, old=old, block=block, height=height, seed=seed) -> float:
            chance = choice.pick(10**6, "facade", *seed, new.uid) / 10**6
            return _misfit(new, block, height, KINDS[old.category]) + USED * used.get(new.uid, 0) + CHANCE * chance

        homes = [r for r in candidates if r.params["trade"] == "" and abs(math.log(height / r.height)) < HOME]
        at_home = exact and homes and KINDS[old.category] == ""
        new = min(homes if at_home else candidates, key=lambda r: (cost(r), r.uid))
        for other in candidates:  # its other dressings count half
            if other.params["block"] == new.params["block"] and other.extent_xyz == new.extent_xyz:
                used[other.uid] = used.get(other.uid, 0) + (2 if other is new else 1)
        records[key], placed[key] = new, _placed(old, new, block, height)
    return records, placed


def _misfit(new: AssetRecord, block: Block, height: float, kind: str) -> float:
    _, _, width, _ = new.params["block"]
    tall = abs(math.log(height / new.height))
    wide = abs(math.log(block.width / width))
    is_shop = new.params["trade"] != ""
    wrong = OTHER_USE if is_shop != (kind != "") else OTHER_KIND * (is_shop and new.params["trade"] != kind)
    return 1.3 * wide + tall + wrong


def _placed(old: PlacedObject, new: AssetRecord, block: Block, height: float) -> PlacedObject:
    """The new house with its front in the plane of the old one's, as wide as that."""
    own = Block(*new.params["block"])
    low, high = STRETCH
    scale = (
        round(min(max(block.depth / own.depth, low), high), 4),
        round(block.width / own.width, 4),
        round(min(max(height / new.height, low), high), 4),
    )
    own = own.scaled(scale)
    along, across = block.front - own.front, block.middle - own.middle
    c, s = math.cos(old.yaw), math.sin(old.yaw)
    x, y, z = old.position
    return dataclasses.replace(
        old,
        asset_uid=new.uid,
        position=(round(x + c * along - s * across, 4), round(y + s * along + c * across, 4), z),
        scale=scale,
        mass=round(new.mass * math.prod(scale), 3),
        friction=new.friction_coefficient,
        movable=False,
    )


def _without_hung(
    cousin: Cousin, houses: Mapping[str, PlacedObject], index: AssetIndex
) -> tuple[list[PlacedObject], list[LeftOut]]:
    """The objects other than houses, without those that hung on the former façades."""
    kept, gone = [], []
    for placed in cousin.layout.objects:
        if placed.id in houses:
            continue
        record = index.get(placed.asset_uid)
        if record.leaf in HUNG and any(_reach(placed, house) < HUNG_WITHIN for house in houses.values()):
            gone.append(LeftOut(placed.id, placed.label, WITH_FACADE))
        else:
            kept.append(placed)
    return kept, gone


def _reach(placed: PlacedObject, house: PlacedObject) -> float:
    """m from an object's origin to the box of a house."""
    record = regional.load_regional().get(house.asset_uid)
    c, s = math.cos(house.yaw), math.sin(house.yaw)
    dx, dy = placed.position[0] - house.position[0], placed.position[1] - house.position[1]
    x, y = abs(c * dx + s * dy), abs(c * dy - s * dx)
    half = [e * f / 2 for e, f in zip(record.extent_xyz[:2], house.scale[:2], strict=True)]
    return math.hypot(max(x - half[0], 0.0), max(y - half[1], 0.0))


def _fitting(
    kept: Sequence[PlacedObject],
    houses: Mapping[str, PlacedObject],
    records: Mapping[str, AssetRecord],
    index: AssetIndex,
    hulls_of: Callable[[AssetRecord], HullSet],
    support: overlap.Support | None,
) -> tuple[tuple[PlacedObject, ...], list[LeftOut], list[tuple[str, str]]]:
    """All objects without the movable ones that a new house penetrates, these, and fixed pairs that overlap.

    Args:
      support: ground on which loose objects are moved away from new houses; None to leave out movable ones.
    """
    bodies = [overlap.Body(h, records[k], overlap.prisms_of(h, hulls_of(records[k]))) for k, h in houses.items()]
    found, crowded, overlapping = list(houses.values()), list[LeftOut](), list[tuple[str, str]]()
    others = []
    for placed in kept:
        record = index.get(placed.asset_uid)
        others.append(overlap.Body(placed, record, overlap.prisms_of(placed, hulls_of(record))))
    for body in others:
        placed = body.placed
        touched = [b.placed.id for b in bodies if overlap.penetration(b, body) > 0.0]
        loose = support is not None and not is_held(body.record.leaf) and _on_ground(body, support)
        if touched and support is not None and loose:
            offset = overlap.free_offset(body, [*bodies, *others], support, kerbs=True)
            if offset is not None:
                body.offset = offset
                found.append(overlap.moved(body))
                continue
        if touched and (placed.movable or loose):
            reason = f"it stands where the house {touched[0]!r} now has a step or a sign"
            crowded.append(LeftOut(placed.id, placed.label, reason))
            continue
        overlapping += [(placed.id, name) for name in touched]
        found.append(placed)
    order = sorted(found, key=lambda p: p.id)
    return tuple(order), crowded, overlapping


def _on_ground(body: overlap.Body, support: overlap.Support) -> bool:
    """Whether an object stands at the height of the nearest ground; boards on fronts have no free place in the air."""
    x, y, z = body.placed.position
    near = support.near_point(x, y, standing_on.GROUND_DISTANCE)
    return any(abs(z - height) <= standing_on.SUPPORT_DISTANCE for height in near)
