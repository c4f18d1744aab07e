"""Lines through points on the ground plane, in host memory."""

import numpy as np


def arc_lengths(line: np.ndarray) -> np.ndarray:
    """Returns (n,) m from the first point of a line (n, 2) m to each of its points, along it."""
    return np.append(0.0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1)))


def points_at(line: np.ndarray, lengths: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Returns the points (m, 2) m of a line (n, 2) m with its `arc_lengths` (n,) m at places (m,) m along it."""
    return np.column_stack([np.interp(places, lengths, line[:, k]) for k in (0, 1)])
