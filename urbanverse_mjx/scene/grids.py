"""Per-scene grids that list the hulls and prisms near each position."""

import numpy as np

from ..geometry.grids import Grid

#: Side of a cell, m.
CELL = 1.0
#: A robot's circumradius (0.55 m holds COCO with its front axle turned, robots/coco.py) plus the distance of one
#: control step at the task's 2.0 m/s and 5 Hz: hulls farther away cannot be touched before the next look-up.
REACH = 0.55 + 2.0 * 0.2
#: Largest height of a robot's parts above the highest ground, m (planner height 1.0 m and as much again).
HEADROOM = 2.0


def box_distance(points: np.ndarray, centre: np.ndarray, rotation: np.ndarray, half: np.ndarray) -> np.ndarray:
    """Distance (m) in the ground plane from points (n, 2) to a box that is rotated about z only."""
    local = (points - centre[:2]) @ rotation[:2, :2]
    return np.linalg.norm(np.maximum(np.abs(local) - half[:2], 0.0), axis=-1)


def build_grid(
    origin: np.ndarray,
    shape: tuple[int, int],
    centres: np.ndarray,
    rotations: np.ndarray,
    halves: np.ndarray,
    reach: float = REACH,
    ceiling: float = np.inf,
) -> list[list[list[int]]]:
    """Lists for every cell the numbers of the boxes within `reach` of any of its points, nearest to the centre first.

    Args:
      origin: (2,) m.
      shape: cells in x and y.
      centres: (n, 3) world centres.
      rotations: (n, 3, 3) about z only.
      halves: (n, 3) m.
      reach: m.
      ceiling: boxes whose lower side is above it are left out.
    """
    grid, limit = Grid(origin, CELL, shape), reach + CELL * np.sqrt(0.5)
    found: list[list[list[tuple[float, int]]]] = [[[] for _ in range(shape[1])] for _ in range(shape[0])]
    for number, (centre, rotation, half) in enumerate(zip(centres, rotations, halves, strict=True)):
        if centre[2] - half[2] > ceiling:
            continue
        span = np.abs(rotation[:2, :2]) @ half[:2] + limit
        i, j = (a.ravel() for a in np.mgrid[grid.window(centre[:2] - span, centre[:2] + span)])
        distance = box_distance(grid.centres(np.stack([i, j], -1)), centre, rotation, half)
        for a, b, d in zip(i, j, distance, strict=True):
            if d <= limit:
                found[a][b].append((float(d), number))
    return [[[number for _, number in sorted(cell)] for cell in row] for row in found]
