"""Gives a bank's grids a longer reach, for robots that are larger than those for which it was packed.

In:   `SceneBank`, a reach. Out: the bank with longer lists. When: at construction of an engine (a third of a second a
scene), and only for such a robot.

A cell lists the boxes within the reach of any of its points. A box farther away by at most the side of a cell is within
the reach of a point of one of the eight cells around, so the lists of all nine hold it.
"""

import dataclasses

import numpy as np

from . import validation as v
from .reach_count import Boxes, object_boxes, prism_boxes
from .scene_bank import SceneBank


def with_reach(bank: SceneBank, reach: float) -> SceneBank:
    """The bank itself if its grids reach as far, else one whose grids do.

    Args:
      reach: m.

    Raises:
      ValidationError: the reach is longer by more than the side of a cell.
    """
    has, side = float(bank.meta["grid_reach"]), float(bank.grid_cell)
    if reach <= has + 1e-6:
        return bank
    if reach > has + side:
        needed = f"at most {has + side:g} m, that of the bank's grids and the side of a cell"
        raise v.fail(
            "robot's reach", f"{reach:g} m", needed, "take a smaller or slower robot, or a shorter control step"
        )
    scenes = range(bank.num_scenes)
    hulls = [_wider(bank.hull_grid[z], object_boxes(bank, z), bank.grid_origin[z], side, reach) for z in scenes]
    prisms = [_wider(bank.prism_grid[z], prism_boxes(bank, z), bank.grid_origin[z], side, reach) for z in scenes]
    meta = {**bank.meta, "grid_reach": reach}
    return dataclasses.replace(bank, hull_grid=_stacked(hulls), prism_grid=_stacked(prisms), meta=meta)


def _wider(grid: np.ndarray, boxes: Boxes, origin: np.ndarray, side: float, reach: float) -> np.ndarray:
    """(X, Y, L') numbers of the boxes within reach, nearest to a cell's centre first, then -1."""
    x, y, length = grid.shape
    around = np.pad(grid, ((1, 1), (1, 1), (0, 0)), constant_values=-1)
    near = [around[i : i + x, j : j + y] for i in range(3) for j in range(3)]
    listed = np.sort(np.concatenate(near, -1).reshape(x * y, 9 * length), axis=1)
    listed[:, 1:][listed[:, 1:] == listed[:, :-1]] = -1
    cells = np.stack(np.meshgrid(np.arange(x), np.arange(y), indexing="ij"), -1).reshape(-1, 2)
    distance = boxes.distance(origin.astype(np.float64) + (cells + 0.5) * side, listed)
    listed[distance > reach + side * np.sqrt(0.5)] = -1
    order = np.argsort(np.where(listed < 0, np.inf, distance), axis=1, kind="stable")
    longest = max(int((listed >= 0).sum(1).max(initial=0)), 1)
    return np.take_along_axis(listed, order, 1)[:, :longest].reshape(x, y, longest)


def _stacked(grids: list[np.ndarray]) -> np.ndarray:
    """(Z, X, Y, L) of grids whose lists differ in length."""
    longest = max(grid.shape[-1] for grid in grids)
    widths = ((0, 0), (0, 0))
    return np.stack([np.pad(g, (*widths, (0, longest - g.shape[-1])), constant_values=-1) for g in grids])
