"""Records of the 98 road and 190 sidewalk materials, available without generating their maps."""

import dataclasses
import functools

from urbanverse_mjx.datatypes import validation as v

from ...categories.materials import material
from .roads import ROADS
from .sidewalks import SIDEWALKS
from .variants import Variant
from .weathering import CONDITIONS

KINDS = ("road", "sidewalk")


@dataclasses.dataclass(frozen=True)
class GroundRecord:
    """One material.

    Attributes:
      uid: "road/..." or "sidewalk/...".
      kind: "road" or "sidewalk".
      description: one sentence.
      family: asphalt, concrete, slabs, brick, blocks, stone, setts, tiles, tactile, gravel or wood.
      matter: row of the table of materials.
      colour: of the dry surface, in words.
      condition: name of the condition.
      condition_group: the wider word (dry, worn, cracked, patched, wet, snowy, icy, leaf-strewn, sandy, overgrown,
        painted).
      tile_size_m: m covered by one tile.
      unit_m: spacing of bricks, slabs ... along u and v, m; None without units or where lengths vary.
      friction: static, of a dry hard sole or tyre on the surface as it is.
      friction_reason: how it was got.
    """

    uid: str
    kind: str
    description: str
    family: str
    matter: str
    colour: str
    condition: str
    condition_group: str
    tile_size_m: float
    unit_m: tuple[float, float] | None
    friction: float
    friction_reason: str


def _records(kind: str, variants: tuple[Variant, ...]) -> dict[str, tuple[GroundRecord, Variant]]:
    table = {}
    for variant in variants:
        dry = material(variant.matter).friction
        for name in variant.conditions:
            condition = CONDITIONS[name]
            record = GroundRecord(
                uid=f"{kind}/{variant.name}" + ("" if name == "dry" else f"-{name}"),
                kind=kind,
                description=f"{variant.words[0].upper()}{variant.words[1:]}, {condition.words}",
                family=variant.family,
                matter=variant.matter,
                colour=variant.colour,
                condition=name,
                condition_group=condition.group,
                tile_size_m=variant.tile_m,
                unit_m=variant.unit_m,
                friction=round(condition.friction(dry), 3),
                friction_reason=f"{variant.matter}: {condition.reason}",
            )
            table[record.uid] = (record, variant)
    return table


@functools.cache
def _table() -> dict[str, tuple[GroundRecord, Variant]]:
    return _records("road", ROADS) | _records("sidewalk", SIDEWALKS)


def ground_records(kind: str | None = None) -> tuple[GroundRecord, ...]:
    """All materials, or those of "road" or "sidewalk", in a fixed order.

    Raises:
      ValidationError: no such kind.
    """
    if kind is not None:
        v.choice(kind, "kind of ground", KINDS)
    return tuple(record for record, _ in _table().values() if kind in (None, record.kind))


def find_ground(uid: str) -> tuple[GroundRecord, Variant]:
    """A record and the variant that paints it.

    Raises:
      ValidationError: no such material.
    """
    if uid not in _table():
        near = [known for known in _table() if known.split("-")[0] == str(uid).split("-")[0]] or list(_table())[:8]
        raise v.fail("ground material", repr(uid), "a uid such as " + ", ".join(near[:8]))
    return _table()[uid]
