"""Selects ground materials and skies for k cousins, by pixel-wise error and HSV histograms if a graph has
descriptors."""

import dataclasses
import functools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely

from ..assets.appearances import appearance_search
from ..assets.appearances.ground_materials import build_material, material_ids
from ..assets.appearances.grounds import ground_records
from ..assets.appearances.sky_maps import sky_records
from ..datatypes import GroundRegion, PlacedGround, SceneGraph
from .choice import one_each, pick

#: Kinds for which the large collection has materials; the others have a few materials of their own.
COLLECTED = ("road", "sidewalk")
#: Conditions of the ground that fit a street without descriptors, and times of the sky.
PLAIN_CONDITIONS = frozenset({"dry", "worn", "cracked", "patched"})
DAYTIMES = frozenset({"morning", "noon", "afternoon", "evening"})
#: Hellinger distance of HSV histograms from which a sky matches no stored one (1: disjoint).
MAX_SKY_DISTANCE = 0.9
#: m; regions of a kind within this distance form one piece with one material.
GAP = 0.05


@dataclasses.dataclass(frozen=True)
class RankedAppearance:
    """A material or a sky, and its distance from the descriptor (None without a descriptor)."""

    uid: str
    distance: float | None


@dataclasses.dataclass(frozen=True)
class Ground:
    """One piece of ground and its materials, one for each cousin."""

    kind: str
    regions: tuple[str, ...]
    materials: tuple[RankedAppearance, ...]


def grounds(graph: SceneGraph, count: int, seed: int) -> list[Ground]:
    """Selects materials of every piece of ground for `count` cousins.

    Regions of a kind that touch form one piece. All roads of a street have one material, pavements may differ. If a
    graph names materials (see `_parted`), regions get the named ones.
    """
    found = []
    for kind in dict.fromkeys(r.kind for r in graph.ground):
        regions = [r for r in graph.ground if r.kind == kind]
        pieces = _pieces(regions) if kind == "sidewalk" else [regions]
        for number, piece in enumerate(part for whole in pieces for part in _parted(kind, whole)):
            ranked = _ranked(kind, _seen(piece))
            drawn = _one_each(ranked, count, seed, f"{graph.id}/{kind}/{number}")
            found.append(Ground(kind, tuple(r.id for r in piece), tuple(drawn)))
    return found


def _pieces(regions: Sequence[GroundRegion]) -> list[list[GroundRegion]]:
    shapes = [shapely.Polygon(r.polygon) for r in regions]
    joined = shapely.union_all([s.buffer(GAP, join_style="mitre") for s in shapes])
    parts = sorted(shapely.get_parts(joined), key=lambda p: p.bounds)
    groups: list[list[GroundRegion]] = [[] for _ in parts]
    for region, shape in zip(regions, shapes, strict=True):
        inside = shape.representative_point()
        groups[next(i for i, part in enumerate(parts) if part.covers(inside))].append(region)
    return [g for g in groups if g]


def _parted(kind: str, piece: Sequence[GroundRegion]) -> list[list[GroundRegion]]:
    """The piece, or its parts if several materials are named for it; regions without a named material join the first
    part.

    A descriptor equal to a material's in every number selects it; one from a camera image is never equal.
    """
    named = {r.id: uid for r in piece if r.descriptor is not None and (uid := _named(kind, r.descriptor)) is not None}
    parts: dict[str, list[GroundRegion]] = {uid: [] for uid in named.values()}
    if len(parts) < 2:
        return [list(piece)]
    first = next(iter(parts))
    for region in piece:
        parts[named.get(region.id, first)].append(region)
    return list(parts.values())


@functools.lru_cache(maxsize=512)
def _named(kind: str, descriptor: tuple[int, ...]) -> str | None:
    best = _ranked(kind, np.array(descriptor, np.float64))[0]
    return best.uid if best.distance == 0.0 else None


def _seen(piece: Sequence[GroundRegion]) -> np.ndarray | None:
    """(64,) mean descriptor of the regions that have one, by area."""
    seen = [(r.descriptor, shapely.Polygon(r.polygon).area) for r in piece if r.descriptor is not None]
    if not seen:
        return None
    numbers, areas = (np.array(x, np.float64) for x in zip(*seen, strict=True))
    return areas @ numbers / areas.sum()


def _ranked(kind: str, descriptor: np.ndarray | None) -> list[RankedAppearance]:
    """All candidate materials, best first if there is a descriptor."""
    if kind not in COLLECTED:
        own = list(material_ids(kind))
        if descriptor is None:
            return [RankedAppearance(uid, None) for uid in own]
        errors = appearance_search.ground_errors(descriptor, _own_descriptors(kind))
        return [RankedAppearance(own[i], float(errors[i])) for i in np.argsort(errors, kind="stable")]
    if descriptor is not None:
        return [
            RankedAppearance(uid, error) for uid, error in appearance_search.rank_ground_descriptors(descriptor, kind)
        ]
    plain = [r.uid for r in ground_records(kind) if r.condition_group in PLAIN_CONDITIONS]
    return [RankedAppearance(uid, None) for uid in plain]


@functools.cache
def _own_descriptors(kind: str) -> np.ndarray:
    return np.array([appearance_search.ground_descriptor(build_material(uid).texture) for uid in material_ids(kind)])


def skies(graph: SceneGraph, count: int, seed: int) -> list[RankedAppearance]:
    """Selects a sky for each of `count` cousins: the nearest ones by HSV histogram; any daytime sky if there is no
    descriptor or it matches no sky (walls taken for sky, black frames)."""
    ranked: list[RankedAppearance] = []
    if graph.sky_descriptor is not None:
        found = appearance_search.rank_skies(graph.sky_descriptor)
        ranked = [RankedAppearance(uid, distance) for uid, distance in found if distance < MAX_SKY_DISTANCE]
    by_day = [RankedAppearance(r.uid, None) for r in sky_records() if r.time in DAYTIMES and not r.snow]
    return _one_each(ranked or by_day, count, seed, f"{graph.id}/sky")


def _one_each(ranked: Sequence[RankedAppearance], count: int, seed: int, key: str) -> list[RankedAppearance]:
    """Like `shortlists.one_each`: the first cousin gets the best entry if there is a descriptor, the others are drawn
    among the next ones."""
    known = ranked[0].distance is not None
    return one_each(ranked, known, count, lambda appearance: pick(2**62, "look", seed, key, appearance.uid))


def identity(graph: SceneGraph, cousin: int, seed: int) -> dict[str, Any]:
    """The fields of a layout with its graph, seed and cousin, and the rotation of its sky."""
    return {
        "id": graph.id if cousin == 0 else f"{graph.id}_cousin{cousin}",
        "graph_id": graph.id,
        "graph_hash": graph.content_hash(),
        "seed": seed,
        "cousin": cousin,
        "sky_yaw": _sky_yaw(graph, cousin, seed),
    }


def _sky_yaw(graph: SceneGraph, cousin: int, seed: int) -> float:
    """rad, the sky's rotation about z."""
    return round(pick(6283, "sky yaw", seed, cousin, graph.id) / 1000.0 - math.pi, 3)


def placed_ground(graph: SceneGraph, pieces: Sequence[Ground], cousin: int) -> tuple[PlacedGround, ...]:
    """The regions with the materials of one cousin, in the graph's order."""
    material = {name: piece.materials[cousin].uid for piece in pieces for name in piece.regions}
    return tuple(PlacedGround(r.id, r.kind, r.polygon, r.plane, material[r.id]) for r in graph.ground)
