"""Fills ground that objects hid from the camera, such as the road below parked cars.

A free body would fall through such a hole. Holes, and missing ground under standing objects, are added to the adjacent
ground.
"""

import dataclasses
from collections.abc import Mapping, Sequence

import shapely
from shapely.geometry.base import BaseGeometry

from ..assets.categories.ontology import category_of
from ..assets.categories.priors import prior
from ..datatypes import PAINT_KINDS, GraphObject, GroundRegion, SceneGraph, ValidationError
from ..datatypes.ground import check_polygon
from ..geometry.polygons import MAX_OVERLAP
from . import overlap

#: m², largest hole to fill; larger ones are courtyards or unobserved areas. Largest share of a hole that houses cover;
#: otherwise it belongs to the houses.
MAX_HOLE_AREA, MAX_HOUSE_SHARE = 400.0, 0.2
#: m around an object that gets ground; m, largest height difference of its foot and the adjacent ground; m, largest
#: distance to that ground.
MARGIN, MAX_FOOT_DIFFERENCE, REACH = 0.3, 0.5, 3.0
#: m²; smaller missing pieces are due to the rounding of outlines. m, largest gap between two pieces of ground that is
#: closed.
MIN_AREA, MAX_SEAM = 0.02, 0.02
#: m; corners of outlines are rounded to whole millimetres, as in graphs.
GRID = 1e-3
#: m, of outlines whose corners would otherwise coincide for `check_polygon`.
FINE_GRID = 2e-6
#: Kinds that are extended under objects only if no other kind borders on the hole.
LAST = frozenset({"crosswalk"})


def fill(graph: SceneGraph, leaves: Mapping[str, str]) -> SceneGraph:
    """Adds ground to a graph where objects hid it.

    Args:
      leaves: label -> leaf; objects of other labels are ignored.
    """
    carrying = [r for r in graph.ground if r.kind not in PAINT_KINDS]
    shapes = {r.id: shapely.Polygon(r.polygon) for r in carrying}
    ground = shapely.union_all(list(shapes.values()), grid_size=GRID)
    closed = ground.buffer(MAX_SEAM, join_style="mitre").buffer(-MAX_SEAM, join_style="mitre")
    graph_objects = [obj for obj in graph.objects if obj.label in leaves]
    houses = shapely.union_all([overlap.ground_box(t) for t in graph_objects if _is_house(leaves[t.label])])
    missing = shapely.union_all([*_holes(closed, houses), *_under(graph_objects, leaves, closed, houses, carrying)])
    for part in shapely.get_parts(shapely.difference(missing, ground, grid_size=GRID)):
        if part.area > MIN_AREA and isinstance(part, shapely.Polygon):
            _give(part, carrying, shapes)
    grown = {
        r.id: dataclasses.replace(r, polygon=_ring(shapes[r.id]))
        for r in carrying
        if not shapes[r.id].equals(shapely.Polygon(r.polygon))
    }
    return dataclasses.replace(graph, ground=tuple(grown.get(r.id, r) for r in graph.ground)) if grown else graph


def _ring(shape: shapely.Polygon) -> tuple[tuple[float, ...], ...]:
    """Corners of an outline. Where the removal of an overlap left corners nanometres apart, or a spike as thin as that,
    it is rounded to micrometres."""
    corners = tuple(shape.exterior.coords[:-1])
    try:
        check_polygon(corners, "ground")
    except ValidationError:
        parts = shapely.get_parts(shapely.set_precision(shape, FINE_GRID))
        corners = tuple(max(parts, key=shapely.area).exterior.coords[:-1])
    return corners


def _is_house(leaf: str) -> bool:
    return category_of(leaf)[0] == "building"


def _holes(ground: BaseGeometry, houses: BaseGeometry) -> list[shapely.Polygon]:
    rings = [ring for part in shapely.get_parts(ground) for ring in shapely.get_rings(part)[1:]]
    holes = [shapely.Polygon(ring) for ring in rings]
    return [h for h in holes if h.area <= MAX_HOLE_AREA and h.intersection(houses).area <= MAX_HOUSE_SHARE * h.area]


def _under(
    graph_objects: Sequence[GraphObject],
    leaves: Mapping[str, str],
    ground: BaseGeometry,
    houses: BaseGeometry,
    carrying: Sequence[GroundRegion],
) -> list[BaseGeometry]:
    """Missing ground under objects that stand at the height of the adjacent ground."""
    support = overlap.Support.of(carrying)
    found = []
    for obj in graph_objects:
        leaf = leaves[obj.label]
        box = overlap.ground_box(obj)
        if _is_house(leaf) or prior(leaf).rest == "hangs" or ground.covers(box):
            continue
        foot = obj.center[2] - obj.size[2] / 2
        beside = support.under(obj) or support.near(obj, REACH)
        if any(abs(z - foot) <= MAX_FOOT_DIFFERENCE for z in beside):
            found.append(box.buffer(MARGIN, join_style="mitre").difference(houses))
    return found


def _give(part: shapely.Polygon, regions: Sequence[GroundRegion], shapes: dict[str, shapely.Polygon]) -> None:
    """Merges a piece into the region with the longest common border if the result is a simple polygon."""
    near = part.buffer(MAX_SEAM)
    borders = {r.id: shapes[r.id].exterior.intersection(near).length for r in regions if r.id in shapes}
    order = sorted(regions, key=lambda r: (r.kind in LAST, -borders[r.id], r.id))
    for region in order:
        if borders[region.id] <= 2 * MAX_SEAM:
            continue
        both = _beside_others(region.id, shapely.union_all([shapes[region.id], part], grid_size=GRID), shapes)
        if isinstance(both, shapely.Polygon) and not both.interiors:
            shapes[region.id] = both
            return


def _beside_others(own: str, grown: BaseGeometry, shapes: Mapping[str, shapely.Polygon]) -> BaseGeometry:
    """Removes the overlap of an extended region with others. Corners of hand-made streets are off the raster, and
    rounding them by half a millimetre makes long edges overlap the neighbour."""
    near = [p for name, p in shapes.items() if name != own and p.intersects(grown)]
    over = [p for p in near if p.intersection(grown).area > MAX_OVERLAP]
    return grown.difference(shapely.union_all(over)) if over else grown
