"""Requirements on every manually composed scene, checked on its graph."""

import math

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from urbanverse_mjx.assets import load_index
from urbanverse_mjx.datatypes import AssetRecord, SceneGraph
from urbanverse_mjx.scene.ground import check_regions, ground_prisms

#: Ground prisms in an engine's slots, and their range around a robot's middle (scene.grids), m.
PRISMS, REACH = 8, 0.55 + 2.0 * 0.2


def distortion(size: tuple[float, float, float], record: AssetRecord) -> float:
    """Root of the summed squared log ratios of the sorted ground sides and of the height; 0 = the record's own size."""
    pairs = ((max(size[:2]), record.length), (min(size[:2]), record.width), (size[2], record.height))
    return math.sqrt(sum(math.log(a / b) ** 2 for a, b in pairs))


def walkable(graph: SceneGraph) -> BaseGeometry:
    """Union of the ground that pavement robots may be on."""
    walked = [shapely.Polygon(r.polygon) for r in graph.ground if r.kind in ("sidewalk", "crosswalk", "ground")]
    area: BaseGeometry = shapely.union_all(walked, grid_size=1e-3)
    return area


def most_prisms_near(graph: SceneGraph) -> tuple[int, tuple[float, float]]:
    """The most ground prisms whose boxes along the axes lie within reach of a walkable place, and that place (m)."""
    check_regions(graph.ground)
    boxes = []
    for prism in ground_prisms(graph.ground):
        corners = prism.position[:2] + prism.corners[:, :2]
        boxes.append(shapely.box(*corners.min(0), *corners.max(0)))
    area = walkable(graph)
    x0, y0, x1, y1 = area.bounds
    x, y = (a.ravel() for a in np.meshgrid(np.arange(x0, x1, 0.5), np.arange(y0, y1, 0.5)))
    points = np.array(shapely.points(x, y), dtype=object)
    points = points[shapely.contains(area, points)]
    near, _ = shapely.STRtree(boxes).query(points, predicate="dwithin", distance=REACH)
    counts = np.bincount(near, minlength=len(points))
    worst = points[counts.argmax()]
    return int(counts.max()), (worst.x, worst.y)


def stretched(graph: SceneGraph) -> list[str]:
    """Ids of the objects but house fronts, hedges and fences that no asset of their label fits within 20 %."""
    index = load_index()
    found = []
    for obj in graph.objects:
        records = index.by_label(obj.label)
        assert records, obj.label
        if records[0].category[0] == "building" or obj.label in ("shrub", "fence", "wall", "gate", "guard rail"):
            continue
        if min(distortion(obj.size, r) for r in records) >= 0.2:
            found.append(obj.id)
    return found


def shared_labels(a: SceneGraph, b: SceneGraph) -> float:
    """Share of the objects of the larger of two scenes that the other has too, by labels alone."""
    counts = []
    for graph in (a, b):
        labels = [o.label for o in graph.objects]
        counts.append({name: labels.count(name) for name in set(labels)})
    common = sum(min(n, counts[1].get(name, 0)) for name, n in counts[0].items())
    return common / max(len(a.objects), len(b.objects))
