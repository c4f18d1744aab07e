"""Corners of a flat panel on the face of a box, or facing a direction."""

import numpy as np

from .shapes import Point3

NORMALS = {"+x": (1, 0, 0), "-x": (-1, 0, 0), "+y": (0, 1, 0), "-y": (0, -1, 0), "+z": (0, 0, 1), "-z": (0, 0, -1)}


def face_size(size: Point3, face: str) -> tuple[float, float]:
    """(across, up) of a box face in the convention of `panel`."""
    x, y, z = (float(s) for s in size)
    return {"x": (y, z), "y": (x, z), "z": (y, x)}[face[1]]


def panel_corners(at: np.ndarray, width: float, height: float, facing: str | float, tilt_deg: float) -> np.ndarray:
    """(4, 3) corners, m, of a panel centred at `at`, counter-clockwise seen from its front."""
    if isinstance(facing, str):
        normal = np.array(NORMALS[facing], float)
    else:
        normal = np.array([np.cos(np.radians(facing)), np.sin(np.radians(facing)), 0.0])
    # The top of horizontal panels is towards +x seen from above, as that of text on the road for traffic along +x.
    up = np.array([0.0, 0.0, 1.0]) if abs(normal[2]) < 0.5 else np.array([1.0, 0.0, 0.0])
    right = np.cross(up, normal)
    lean = np.radians(tilt_deg)
    up = np.cos(lean) * up - np.sin(lean) * normal
    return np.stack(
        [at + sx * right * width / 2 + sy * up * height / 2 for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    )
