"""Computes the ground that an object occupies and the free space left for a robot."""

import math
from collections.abc import Iterable

import shapely
from shapely.geometry.base import BaseGeometry

from ..datatypes import TRAVERSABLE_KINDS, GraphObject, GroundRegion
from ..geometry.polygons import rectangle
from . import catalogue

#: Free width (m) that must remain: a robot of 0.35 m radius with 20 cm of clearance on each side.
CLEARANCE = 1.1


def footprint(obj: GraphObject) -> shapely.Polygon:
    """Returns the oriented rectangle (m, scene frame) that an object occupies at walking height."""
    stem = catalogue.STEMS.get(obj.label)
    along, across = (stem.side, stem.side) if stem else obj.size[:2]
    ahead = stem.offset * obj.size[0] / 2 if stem else 0.0
    return rectangle(along, across, obj.yaw, *obj.center[:2], ahead)


def is_obstacle(obj: GraphObject) -> bool:
    return obj.label not in catalogue.FLAT


def walkable(ground: Iterable[GroundRegion]) -> BaseGeometry:
    """Returns the union of the regions that a pavement robot may be on."""
    pieces = [shapely.Polygon(r.polygon) for r in ground if r.kind in TRAVERSABLE_KINDS]
    return shapely.union_all(pieces, grid_size=1e-3)  # skewed seams part by less than a millimetre


def free_space(
    ground: Iterable[GroundRegion], objects: Iterable[GraphObject], clearance: float = CLEARANCE
) -> BaseGeometry:
    """Returns the area in which the middle of a disc of diameter `clearance` may be: on walkable ground, clear of kerbs
    and objects."""
    reach = clearance / 2
    taken = [footprint(o).buffer(reach, quad_segs=4) for o in objects if is_obstacle(o)]
    return walkable(ground).buffer(-reach, join_style="mitre").difference(shapely.union_all(taken))


def reach_along(space: BaseGeometry, y0: float, y1: float) -> float:
    """Returns the longest extent in x (m) of a connected piece of `space` between two values of y."""
    band = space.intersection(shapely.box(-1e3, min(y0, y1), 1e3, max(y0, y1)))
    parts = shapely.get_parts(band)
    spans = [p.bounds[2] - p.bounds[0] for p in parts if isinstance(p, shapely.Polygon) and p.area > 0.0]
    return max(spans, default=0.0)


def heading(degrees: float) -> float:
    """Returns degrees as radians in (-pi, pi], rounded to 1 mrad."""
    angle = math.remainder(math.radians(degrees), math.tau)
    return round(angle, 3)
