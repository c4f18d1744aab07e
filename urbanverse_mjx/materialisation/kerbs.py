"""Raises the sidewalks of graphs without kerbs (paper: by 15 cm)."""

import dataclasses
import itertools
from collections.abc import Sequence

import numpy as np
import shapely

from ..datatypes import GraphObject, GroundRegion, SceneGraph
from ..datatypes.ground import height_at

#: m, height of a kerb of unknown height (paper, section on scene creation).
KERB = 0.15
#: m, least step at a border that counts as a kerb of the graph; fitted planes differ by less without a kerb.
MIN_OBSERVED_STEP = 0.05
#: m, largest distance between neighbouring regions, and spacing of the border points at which heights are compared.
GAP, SPACING = 0.3, 1.0
WALKED, DRIVEN = ("sidewalk", "ground"), ("road", "crosswalk")


def raise_sidewalks(graph: SceneGraph, kerb: float = KERB) -> tuple[SceneGraph, tuple[str, ...]]:
    """Adds kerbs to a graph; returns it and the ids of the regions that were raised.

    Touching regions of sidewalk and ground form a group. If any step from a group to the road is `MIN_OBSERVED_STEP`
    or more, its kerbs, including dropped ones, are kept. Otherwise the group is raised with the objects on it until the
    median step is `kerb`. A graph without road is not changed.
    """
    walked = [r for r in graph.ground if r.kind in WALKED]
    driven = [r for r in graph.ground if r.kind in DRIVEN]
    lift: dict[str, float] = {}
    for piece in _pieces(walked):
        steps = [s for a, b in itertools.product(piece, driven) for s in _steps(a, b)]
        if steps and max(steps) < MIN_OBSERVED_STEP and any(r.kind == "sidewalk" for r in piece):
            lift |= dict.fromkeys((r.id for r in piece), kerb - float(np.median(steps)))
    if not lift:
        return graph, ()
    ground = tuple(_lifted(r, lift.get(r.id, 0.0)) for r in graph.ground)
    raised = [(shapely.Polygon(r.polygon), lift[r.id]) for r in walked if r.id in lift]
    objects = tuple(_with_ground(o, raised) for o in graph.objects)
    return dataclasses.replace(graph, ground=ground, objects=objects), tuple(lift)


def _pieces(regions: Sequence[GroundRegion]) -> list[list[GroundRegion]]:
    """Groups of regions that touch each other."""
    shapes = [shapely.Polygon(r.polygon).buffer(GAP / 2, join_style="mitre") for r in regions]
    parts = shapely.get_parts(shapely.union_all(shapes)) if shapes else []
    groups = [
        [r for r, s in zip(regions, shapes, strict=True) if part.covers(s.representative_point())] for part in parts
    ]
    return [g for g in groups if g]


def _steps(walked: GroundRegion, driven: GroundRegion) -> list[float]:
    """Heights (m) of a region above its neighbour along their common border; empty without a common border."""
    border = shapely.Polygon(walked.polygon).exterior.intersection(shapely.Polygon(driven.polygon).buffer(GAP))
    if border.length < GAP:
        return []
    points = [border.interpolate(at) for at in np.arange(SPACING / 2, max(border.length, SPACING), SPACING)]
    return [height_at(walked.plane, p.x, p.y) - height_at(driven.plane, p.x, p.y) for p in points]


def _lifted(region: GroundRegion, by: float) -> GroundRegion:
    a, b, c = region.plane
    return dataclasses.replace(region, plane=(a, b, c + by)) if by else region


def _with_ground(obj: GraphObject, raised: Sequence[tuple[shapely.Polygon, float]]) -> GraphObject:
    """Raises an object with the ground under its centre."""
    x, y, z = obj.center
    by = next((lift for polygon, lift in raised if polygon.covers(shapely.Point(x, y))), 0.0)
    return dataclasses.replace(obj, center=(x, y, z + by)) if by else obj
