"""Largest numbers of hulls and ground prisms within reach of a robot at any allowed position of a bank.

In:   `SceneBank`, a reach. Out: an upper bound over all poses: the number of slots that an engine needs. When: at
construction of an engine (milliseconds a scene), and for the report of a set of scenes.

Branch and bound: squares of ground are split into four as long as more boxes may be within reach of one of their points
than of the densest point found so far. Only cells of the bank's grids that list more boxes than there are slots are
considered, so that sparse streets cost nothing.
"""

from typing import NamedTuple

import numpy as np

from .ground import traversable
from .scene_bank import SceneBank

#: m; squares of this side are not split. A box counts where it is at most 0.7 sides farther away than the reach.
_FINEST = 1 / 64
#: m, added to the reach: engines measure distances of tens of metres in single precision.
_ROUNDING = 1e-4


class Boxes(NamedTuple):
    """Boxes of one scene seen from above: centre (Q, 2) m, half (Q, 2) m, turn (Q, 2, 2), None where none is turned."""

    centre: np.ndarray
    half: np.ndarray
    turn: np.ndarray | None

    def distance(self, points: np.ndarray, listed: np.ndarray) -> np.ndarray:
        """(n, L) m from points (n, 2) to the boxes listed (n, L) for each; infinite for -1."""
        offset = points[:, None] - self.centre[listed]
        if self.turn is not None:
            offset = np.einsum("nqij,nqi->nqj", self.turn[listed], offset)
        distance = np.linalg.norm(np.maximum(np.abs(offset) - self.half[listed], 0.0), axis=-1)
        return np.where(listed >= 0, distance, np.inf)


class _Squares(NamedTuple):
    """n squares of one side: centre (n, 2) m, and the boxes (n, L) that may come within reach of a point of each."""

    centre: np.ndarray
    listed: np.ndarray

    def split(self, side: float, near: np.ndarray) -> "_Squares":
        """Four of half the `side` (m) in place of each, with those of its boxes for which near (n, L) is true."""
        order = np.argsort(~near, axis=1, kind="stable")[:, : int(near.sum(1).max())]
        listed = np.take_along_axis(np.where(near, self.listed, -1), order, 1)
        corners = np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]]) * side / 4
        return _Squares((self.centre[:, None] + corners).reshape(-1, 2), np.repeat(listed, 4, axis=0))


class _Ground(NamedTuple):
    """A scene's map: kind (X, Y) u8 of cells with sides of `cell` m, from origin (2,) m on."""

    kind: np.ndarray
    origin: np.ndarray
    cell: float

    def touches(self, centres: np.ndarray, side: float) -> np.ndarray:
        """(n,) bool: whether a square of `side` m around each of centres (n, 2) m touches a traversable cell."""
        first = np.floor((centres - side / 2 - self.origin) / self.cell).astype(int)
        cells = first[:, :, None] + np.arange(int(np.ceil(side / self.cell)) + 1 if side else 1)
        shape = np.array(self.kind.shape)[:, None]
        within = (cells >= 0) & (cells < shape)
        i, j = np.moveaxis(np.clip(cells, 0, shape - 1), 1, 0)
        found = traversable(self.kind[i[:, :, None], j[:, None, :]]) & within[:, 0, :, None] & within[:, 1, None, :]
        return found.any((1, 2))


def most_objects_in_reach(bank: SceneBank, scene: int, reach: float, at_least: int = 0) -> int:
    """Largest number of object hulls within reach of a point on a scene's traversable ground.

    Heights are ignored, so the number holds for any slope and posture. Objects are rotated about z only. The reach is
    measured from the robot's centre and is at most the `grid_reach` of the bank.

    Args:
      reach: m.
      at_least: lower bound of the result, which makes the search faster.

    Returns:
      A bound: 1 or 2 more than there are where that many lie within 11 mm beyond the reach.
    """
    return _most(bank, scene, bank.hull_grid[scene], object_boxes(bank, scene), reach, at_least)


def most_prisms_in_reach(bank: SceneBank, scene: int, reach: float, at_least: int = 0) -> int:
    """Like `most_objects_in_reach`, for ground prisms."""
    return _most(bank, scene, bank.prism_grid[scene], prism_boxes(bank, scene), reach, at_least)


def object_boxes(bank: SceneBank, scene: int) -> Boxes:
    """The boxes of a scene's object hulls."""
    hull, turn = bank.inst_hull[scene], bank.inst_rotation[scene].astype(np.float64)
    box = bank.hull_box[np.maximum(hull, 0)].astype(np.float64)
    centre = bank.inst_position[scene] + np.einsum("qij,qj->qi", turn, box[:, 0])
    return Boxes(centre[:, :2], box[:, 1, :2], turn[:, :2, :2])


def prism_boxes(bank: SceneBank, scene: int) -> Boxes:
    """The boxes of a scene's ground prisms."""
    box = bank.hull_box[np.maximum(bank.prism_hull[scene], 0)].astype(np.float64)
    centre = bank.prism_position[scene] + box[:, 0]
    return Boxes(centre[:, :2], box[:, 1, :2], None)


def _most(bank: SceneBank, scene: int, grid: np.ndarray, boxes: Boxes, reach: float, most: int) -> int:
    """The most of `boxes` within reach of a point of the scene's traversable ground, or `most` if that is more.

    Args:
      grid: (X, Y, L) of the boxes; a list ends with its first -1.
    """
    if grid.shape[-1] <= most:
        return most
    side, reach = float(bank.grid_cell), reach + _ROUNDING
    ground = _Ground(bank.map_kind[scene], bank.map_origin[scene].astype(np.float64), float(bank.map_resolution))
    crowded = np.argwhere(grid[:, :, most] >= 0)
    places = bank.grid_origin[scene].astype(np.float64) + (crowded + 0.5) * side
    squares = _Squares(places, grid[crowded[:, 0], crowded[:, 1]])
    while True:
        inside = ground.touches(squares.centre, side)
        squares = _Squares(*(part[inside] for part in squares))
        if not len(squares.centre):
            return most
        distance = boxes.distance(squares.centre, squares.listed)
        middle = ground.touches(squares.centre, 0.0)
        most = max(most, int(np.where(middle, (distance <= reach).sum(1), 0).max()))
        near = distance <= reach + side * np.sqrt(0.5)
        count = near.sum(1)
        if count.max() <= most:
            return most
        if side <= _FINEST:
            return int(count.max())
        squares = _Squares(*(part[count > most] for part in squares)).split(side, near[count > most])
        side /= 2
