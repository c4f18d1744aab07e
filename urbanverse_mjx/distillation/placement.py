"""Placement priors: moves an object from ground where its kind cannot stand, within the uncertainty of its position."""

import dataclasses
from collections.abc import Sequence

import numpy as np
import shapely
import shapely.ops
from shapely.geometry.base import BaseGeometry

from ..datatypes import GroundRegion, LabelPrior, ground
from ..geometry.polygons import rectangle
from .boxes import Box
from .ground import allowed_area


@dataclasses.dataclass(frozen=True)
class PlacementOptions:
    """Limits of the movement of an object to ground on which its kind stands.

    Chosen manually; `benchmarks.fidelity` measures their effect (docs/decisions/generation.md).

    Attributes:
      max_sigmas: largest movement in standard errors of the object's depth, in addition to `cell_error`.
      cell_error: m, error of the outlines of ground, which are made from cells.
      max_move: m, largest movement.
      front_distance: m, largest distance from a building to the ground before it.
      snap_distance: m; boxes whose lower end is within this distance of the ground are put on it.
    """

    max_sigmas: float = 3.0
    cell_error: float = 0.1
    max_move: float = 2.0
    front_distance: float = 5.0
    snap_distance: float = 0.35


_OPTIONS = PlacementOptions()


def place_on_ground(
    boxes: Sequence[Box], priors: Sequence[LabelPrior], regions: tuple[GroundRegion, ...], exact: bool = True
) -> tuple[np.ndarray, np.ndarray]:
    """Computes the movement of objects to suitable ground.

    Args:
      boxes, priors: n objects.
      regions: the ground.
      exact: whether masks are exact; otherwise the lower end of a building, of which no ground is seen, is expected at
        the height of the nearest ground.

    Returns:
      (n, 2) m the shift of each centre, (n,) m the height of the ground under it, NaN where there is none.
    """
    shift, floor = np.zeros((len(boxes), 2)), np.full(len(boxes), np.nan)
    solid = [r for r in regions if r.kind not in ground.PAINT_KINDS]
    areas: dict[tuple[str, ...], BaseGeometry] = {}
    outlines = [shapely.Polygon(r.polygon) for r in solid]
    tree = shapely.STRtree(outlines)
    for i, (box, prior) in enumerate(zip(boxes, priors, strict=True)):
        where = shapely.Point(*box.center[:2])
        if prior.stands_on and prior.on_ground:
            if prior.stands_on not in areas:
                areas[prior.stands_on] = allowed_area(solid, prior.stands_on)
            shift[i] = _pull(where, areas[prior.stands_on], box)
            where = shapely.Point(*(box.center[:2] + shift[i]))
        hits = tree.query(where, predicate="intersects")
        if not (len(hits) or exact) and prior.faces_road:
            length, width, _ = box.size.tolist()
            footprint = rectangle(length, width, box.yaw, float(box.center[0]), float(box.center[1]))
            hits = tree.query_nearest(footprint, max_distance=_OPTIONS.front_distance)[:1]
            if len(hits):
                where = shapely.ops.nearest_points(outlines[hits[0]], where)[0]
        if len(hits):
            floor[i] = max(ground.height_at(solid[h].plane, where.x, where.y) for h in hits)
    return shift, floor


def _pull(where: shapely.Point, area: BaseGeometry, box: Box) -> np.ndarray:
    """(2,) m, the shortest movement of the centre into an area, or zero if it exceeds the uncertainty."""
    if area.is_empty or area.intersects(where):
        return np.zeros(2)
    inner = area.buffer(-min(0.5 * float(box.size[:2].min()), 0.3))
    target = shapely.ops.nearest_points(where, area if inner.is_empty else inner)[1]
    move = np.array([target.x - where.x, target.y - where.y])
    reach = float(np.linalg.norm(move))
    limit = min(_OPTIONS.max_sigmas * box.blur + _OPTIONS.cell_error, _OPTIONS.max_move)
    return move if reach <= limit else np.zeros(2)


def stand(box: Box, floor: float, prior: LabelPrior) -> tuple[np.ndarray, np.ndarray]:
    """(3,) centre and (3,) size of a box put on the ground: a hidden lower end is completed, a buried one cut off."""
    if not (prior.on_ground and np.isfinite(floor)):
        return box.center, box.size
    low, high = box.center[2] - box.size[2] / 2, box.center[2] + box.size[2] / 2
    gap = low - floor
    known = prior.extents[:, 2].max() if len(prior.extents) else 0.0
    # A distant lower end is moved to the ground only if the label's known sizes reach that far; a visible gap below the
    # object is kept unless the depth error is as large.
    if (
        0 < gap <= _OPTIONS.snap_distance + 2 * box.blur
        or (gap > 0 and high - floor <= 1.2 * known)
        or 0 > gap >= -2 * box.blur
    ):
        low = floor
    high = max(high, low + 0.01)
    center, size = box.center.copy(), box.size.copy()
    center[2], size[2] = (low + high) / 2, high - low
    return center, size
