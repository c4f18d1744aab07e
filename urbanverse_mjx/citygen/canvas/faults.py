"""Finds faults of a composed scene: floating or overlapping objects, gaps in the ground, a blocked path."""

from collections.abc import Sequence

import numpy as np
import shapely
import shapely.ops

from ...datatypes import GraphObject
from ...datatypes.ground import PAINT_KINDS
from .. import clearance
from ..stage import Stage
from . import ground_layers

#: Free width (m) that a trajectory must have: a robot of 0.45 m radius, plus the planner's cells of 20 cm.
CLEARANCE = 1.2
#: An object whose foot is at most this far (m) over the ground should stand on it.
FLOATING_HEIGHT = 0.3
#: Largest area (m²) by which two objects may overlap seen from above.
MAX_OVERLAP_AREA = 0.02
#: An object stands over a kerb if the ground under it differs by at least this much (m).
KERB_DIFFERENCE = 0.035
#: A free position must exist within this distance (m) of every point of the trajectory.
FREE_POSITION_DISTANCE = 1.0


def problems(stage: Stage, trajectory: Sequence[tuple[float, float]], width: float = CLEARANCE) -> list[str]:
    """Returns the faults, one sentence each: floating or overlapping objects, objects half over a kerb, gaps in the
    ground, and a blocked trajectory."""
    found = ground_layers.seams([r for r in stage.regions if r.kind not in PAINT_KINDS])
    standing = [o for o in stage.objects if clearance.is_obstacle(o) and foot(stage, o) < FLOATING_HEIGHT]
    for obj in standing:
        if abs(foot(stage, obj)) > 2e-3:
            found.append(f"{obj.id} stands {foot(stage, obj):.2f} m off the ground")
        if not _carried(stage, obj):
            found.append(f"{obj.id} stands outside the ground")
        elif _astride(stage, obj):
            found.append(f"{obj.id} stands across a kerb")
    return found + _touching(standing) + _blocked(stage, standing, trajectory, width)


def foot(stage: Stage, obj: GraphObject) -> float:
    """Returns the height (m) of the bottom of an object's box above the ground."""
    spot = clearance.footprint(obj).centroid
    return obj.center[2] - obj.size[2] / 2 - stage.ground_height(spot.x, spot.y)


def is_house(stage: Stage, obj: GraphObject) -> bool:
    """Returns whether an object is as large as a house; the back of a house needs no ground."""
    return stage.sizes[obj.label][0][0] >= 5.0 and obj.size[2] >= 3.2 and obj.size[1] >= 4.0


def _carried(stage: Stage, obj: GraphObject) -> bool:
    shape = clearance.footprint(obj)
    spot = shape if is_house(stage, obj) else shape.centroid
    return stage.on_ground(spot)


def _astride(stage: Stage, obj: GraphObject) -> bool:
    if is_house(stage, obj):
        return False
    corners = shapely.get_coordinates(clearance.footprint(obj).exterior)[:-1]
    heights = [stage.ground_height(x, y) for x, y in corners]
    return max(heights) - min(heights) > KERB_DIFFERENCE


def _touching(standing: Sequence[GraphObject]) -> list[str]:
    shapes = [clearance.footprint(o) for o in standing]
    boxes = np.array(shapes, dtype=object)
    found = []
    for i, j in shapely.STRtree(boxes).query(boxes, predicate="intersects").T:
        share = shapes[i].intersection(shapes[j]).area if i < j else 0.0
        if share > MAX_OVERLAP_AREA:
            found.append(f"{standing[i].id} and {standing[j].id} share {share:.2f} m²")
    return found


def _blocked(
    stage: Stage, standing: Sequence[GraphObject], trajectory: Sequence[tuple[float, float]], width: float
) -> list[str]:
    space = clearance.free_space(stage.regions, standing, width)
    pieces = [p for p in shapely.get_parts(space) if isinstance(p, shapely.Polygon)]
    homes = []
    for x, y in trajectory:
        point = shapely.Point(x, y)
        near = max(
            (k for k, p in enumerate(pieces) if p.distance(point) <= FREE_POSITION_DISTANCE),
            key=lambda k: pieces[k].area,
            default=-1,
        )
        if near < 0:
            return [
                f"the trajectory's point ({x:g}, {y:g}) is more than {FREE_POSITION_DISTANCE:g} m from any free place"
            ]
        homes.append(near)
    found = []
    for i in (i for i in range(len(homes) - 1) if homes[i] != homes[i + 1]):
        near, far = shapely.ops.nearest_points(pieces[homes[i]], pieces[homes[i + 1]])
        where = f"where ({near.x:.1f}, {near.y:.1f}) and ({far.x:.1f}, {far.y:.1f}) do not meet"
        found.append(f"the trajectory is blocked from {trajectory[i]} to {trajectory[i + 1]}, {where}")
    return found
