"""Cuts convex hulls into smaller ones: the same solid with more collision shapes."""

from collections.abc import Iterator, Sequence

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.datatypes.asset import MAX_HULL_VERTICES
from urbanverse_mjx.scene.hulls import ConvexPart, convex_part

#: Relative positions of cuts between a hull's ends, the middle first.
_SHARES = (0.5, 0.4, 0.6, 0.3, 0.7)


def _planes(part: ConvexPart) -> Iterator[tuple[int, float]]:
    """Axis and coordinate (m) of planes to cut along, the best first."""
    centre, half = part.box
    for share in _SHARES:
        for axis in np.argsort(-half, kind="stable"):
            yield int(axis), float(centre[axis] + (2 * share - 1) * half[axis])


def _section(low: np.ndarray, high: np.ndarray, axis: int, at: float) -> np.ndarray:
    """(n, 3) corners, in order, of a hull's section between its corners below and above a plane.

    The section of a convex hull is the hull of where the lines between corners of both sides meet the plane.
    """
    a, b = at - low[:, None, axis, None], high[None, :, axis, None] - at
    points = ((low[:, None] * b + high[None] * a) / (a + b)).reshape(-1, 3)
    return points[ConvexHull(np.delete(points, axis, 1).astype(np.float64)).vertices]


def _thinned(ring: np.ndarray, most: int) -> np.ndarray:
    """At most `most` corners of a convex ring: those left out cut off the least area."""
    while len(ring) > most:
        before, after = np.roll(ring, 1, 0) - ring, np.roll(ring, -1, 0) - ring
        ring = np.delete(ring, np.linalg.norm(np.cross(before, after), axis=1).argmin(), 0)
    return ring


def halves(part: ConvexPart, exact: bool = True) -> tuple[ConvexPart, ConvexPart] | None:
    """Cuts a hull into two hulls of at most 32 corners, across its longest side and in the middle if possible.

    Args:
      exact: whether the two must fill the hull; else they may miss slivers along the cut, where it has many corners.

    Returns:
      The two pieces, or None where no plane gives such.
    """
    for axis, at in _planes(part):
        below = part.corners[:, axis] < at
        sides = part.corners[below], part.corners[~below]
        room = [MAX_HULL_VERTICES - len(side) for side in sides]
        if min(room) < 4 or max(room) == MAX_HULL_VERTICES:
            continue
        try:
            ring = _section(*sides, axis, at)
            if exact and len(ring) > min(room):
                continue
            low, high = (
                convex_part(np.concatenate([side, _thinned(ring, most)]))
                for side, most in zip(sides, room, strict=True)
            )
            return low, high
        except (ValidationError, QhullError):  # a piece or a section that is flat
            continue
    return halves(part, exact=False) if exact else None


def cut(hulls: Sequence[np.ndarray], number: int) -> tuple[np.ndarray, ...]:
    """Returns the same solid as `number` hulls by repeatedly cutting the largest piece in two.

    Args:
      hulls: (n, 3) float32 corners each, m.
      number: desired number; fewer are returned if no hull can be cut further, more if there were more.
    """
    whole = [convex_part(h) for h in hulls]
    done: list[ConvexPart] = []
    while whole and len(whole) + len(done) < number:
        part = whole.pop(max(range(len(whole)), key=lambda i: whole[i].volume))
        pieces = halves(part)
        if pieces is None:
            done.append(part)
        else:
            whole += pieces
    return tuple(p.corners for p in (*done, *whole))
