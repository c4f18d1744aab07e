"""Keeps the camera's path free, because solid objects detected where the camera passed are errors."""

import dataclasses
from collections.abc import Sequence

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from ..datatypes import GraphObject
from . import overlap

#: m to both sides of the camera's path that are free: half the width of a person or a delivery robot, plus 10 cm.
HALF_WIDTH = 0.45


@dataclasses.dataclass(frozen=True)
class ClearanceOptions:
    """Dimensions of the camera's free path; chosen manually.

    Attributes:
      min_height: m above the ground; lower objects (kerbs) do not block a person.
      max_height: m above the ground; higher objects (branches, awnings) do not block a person.
      max_step: m; points of the trajectory farther apart (a cut, lost tracking) are not connected.
      min_kept_share: least share of its footprint that a building keeps when it is cut back from the path; otherwise it
        is not cut.
    """

    min_height: float = 0.25
    max_height: float = 1.3
    max_step: float = 5.0
    min_kept_share: float = 0.5


_OPTIONS = ClearanceOptions()


def walked(path: np.ndarray) -> BaseGeometry:
    """The strip around a trajectory (n, 2 or more) m; empty without a trajectory."""
    steps = np.linalg.norm(np.diff(path[:, :2], axis=0), axis=1)
    parts = np.split(path[:, :2], np.flatnonzero(steps > _OPTIONS.max_step) + 1)
    lines = [shapely.LineString(p) if len(p) > 1 else shapely.Point(p[0]) for p in parts if len(p)]
    return shapely.union_all([line.buffer(HALF_WIDTH) for line in lines])


def blocks(body: overlap.Body, strip: BaseGeometry, ground: float) -> bool:
    """Whether a part of an object at a person's height above the ground (m) extends into the strip."""
    if strip.is_empty or not strip.intersects(shapely.box(*body.bounds)):
        return False
    shift = np.array(body.offset)
    reach = [p for p in body.prisms if p.low < ground + _OPTIONS.max_height and p.high > ground + _OPTIONS.min_height]
    return any(strip.intersects(shapely.Polygon(p.corners + shift)) for p in reach)


def obstructing(
    bodies: Sequence[overlap.Body], strip: BaseGeometry, floors: Sequence[float] | None = None
) -> list[int]:
    """Indices of the objects that stand on the camera's path.

    Args:
      floors: m, height of the ground below each object; None if every object stands on the ground.
    """
    heights = [body.placed.position[2] for body in bodies] if floors is None else floors
    return [k for k, body in enumerate(bodies) if blocks(body, strip, heights[k])]


def cut_back(building: GraphObject, strip: BaseGeometry) -> GraphObject:
    """Cuts back a building whose box overlaps the strip by moving the side that removes least of the box. Depth errors
    move fronts outwards, and hidden parts of a house are estimates."""
    crossed = overlap.ground_box(building).intersection(strip)
    if crossed.is_empty:
        return building
    c, s = np.cos(building.yaw), np.sin(building.yaw)
    turn = np.array([[c, s], [-s, c]])
    corners = (shapely.get_coordinates(crossed) - building.center[:2]) @ turn.T
    low, high = corners.min(0), corners.max(0)
    half = np.array(building.size[:2]) / 2
    sides = [(axis, sign) for axis in (0, 1) for sign in (-1.0, 1.0)]
    kept = [(half[a] + low[a] if sign > 0 else half[a] - high[a]) / (2 * half[a]) for a, sign in sides]
    best = int(np.argmax(kept))
    axis, sign = sides[best]
    if kept[best] < _OPTIONS.min_kept_share:
        return building
    size, shift = list(building.size), np.zeros(2)
    size[axis] = float(kept[best] * size[axis])
    shift[axis] = -sign * (half[axis] - size[axis] / 2)
    x, y = np.array(building.center[:2]) + turn.T @ shift
    return dataclasses.replace(building, center=(float(x), float(y), building.center[2]), size=tuple(size))
