"""Somebody walked or drove where the camera went: nothing solid may stand there, whatever a detector made of it."""

from collections.abc import Sequence

import numpy as np
import shapely

from . import overlap

#: m to both sides of the camera's way that were free: a person's shoulders, a delivery robot's half width and a hand.
HALF_WIDTH = 0.45
#: m over the ground between which things are in a walker's way: over a low kerb, under branches and awnings.
_LOW, _HIGH = 0.25, 1.3
#: m; two places of the tour farther apart (a cut, a lost stretch) are not joined.
_LONGEST_STEP = 5.0


def walked(way: np.ndarray) -> shapely.Geometry:
    """The strip that a tour (n, 2 or more) m passed over; empty without one."""
    steps = np.linalg.norm(np.diff(way[:, :2], axis=0), axis=1)
    parts = np.split(way[:, :2], np.flatnonzero(steps > _LONGEST_STEP) + 1)
    lines = [shapely.LineString(p) if len(p) > 1 else shapely.Point(p[0]) for p in parts if len(p)]
    return shapely.union_all([line.buffer(HALF_WIDTH) for line in lines])


def blocks(body: overlap.Body, strip: shapely.Geometry, ground: float) -> bool:
    """Whether some part of a thing at a walker's height reaches into the strip over ground of that height (m)."""
    if strip.is_empty or not strip.intersects(shapely.box(*body.bounds)):
        return False
    shift = np.array(body.offset)
    reach = [p for p in body.prisms if p.low < ground + _HIGH and p.high > ground + _LOW]
    return any(strip.intersects(shapely.Polygon(p.corners + shift)) for p in reach)


def in_the_way(
    bodies: Sequence[overlap.Body], strip: shapely.Geometry, floors: Sequence[float] | None = None
) -> list[int]:
    """Numbers of the things that stand where the camera went.

    Args:
      floors: m, height of the ground below each; None: each stands on the ground that its foot is on, nothing hangs.
    """
    heights = [body.placed.position[2] for body in bodies] if floors is None else floors
    return [k for k, body in enumerate(bodies) if blocks(body, strip, heights[k])]
