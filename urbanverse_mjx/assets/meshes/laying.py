"""Turns meshes and hulls of upright assets into a pose at rest, see `assets.collision.lying`."""

from typing import Any

import numpy as np

from urbanverse_mjx.geometry import rotations

#: Key of `AssetRecord.params` that makes a record a lying one: "turn", a quaternion (wxyz), and then "shift", m.
KEY = "laid"


def laid_down(down: np.ndarray, vertices: np.ndarray, corners: np.ndarray) -> dict[str, list[float]]:
    """The least turn that makes `down` (3,) point downwards, and the shift that puts the lowest of `corners` (n, 3) m,
    the hulls', on the ground and the middle of the box of `vertices` (v, 3) m, the mesh's, above the origin."""
    axis, cosine = np.cross(down, (0.0, 0.0, -1.0)), -float(down[2])
    quaternion = np.array([1.0 + cosine, *axis])
    if cosine < -1.0 + 1e-9:
        quaternion = np.array([0.0, 1.0, 0.0, 0.0])
    turn = [round(float(q), 6) for q in rotations.unit(quaternion)]
    box = turned(vertices, {"turn": turn, "shift": [0.0, 0.0, 0.0]})
    low = turned(corners, {"turn": turn, "shift": [0.0, 0.0, 0.0]})[:, 2].min()
    x, y = (box[:, :2].min(0) + box[:, :2].max(0)) / 2
    return {"turn": turn, "shift": [round(-float(s), 4) for s in (x, y, low)]}


def turned(points: np.ndarray, laid: dict[str, Any]) -> np.ndarray:
    """Points (n, 3) m of the upright asset in the frame of the lying one, f64."""
    rotation = rotations.matrix_f64(np.array(laid["turn"]))
    return np.asarray(points, np.float64) @ rotation.T + np.array(laid["shift"])
