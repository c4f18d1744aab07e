"""Rotations as unit quaternions (wxyz) and as matrices, for numpy and JAX arrays.

Each function uses the library of its argument, so that modules that build scenes do not load JAX.
"""

from typing import Any

import numpy as np


def matrix(quaternion: Any) -> Any:
    """Returns (..., 3, 3) rotation matrices of unit quaternions (..., 4)."""
    xp = quaternion.__array_namespace__()
    w, x, y, z = xp.moveaxis(quaternion, -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return xp.stack([xp.stack(row, -1) for row in rows], -2)


def matrix_f64(quaternion: np.ndarray) -> np.ndarray:
    """Returns (..., 3, 3) f64 rotation matrices of quaternions (..., 4) of any length but zero; quaternions stored in
    single precision are not exactly unit quaternions."""
    return matrix(unit(np.asarray(quaternion, np.float64)))


def unit(quaternion: Any) -> Any:
    """Normalises quaternions (..., 4) of any length but zero."""
    xp = quaternion.__array_namespace__()
    return quaternion / xp.linalg.norm(quaternion, axis=-1, keepdims=True)


def product(p: Any, q: Any) -> Any:
    """Returns the products (..., 4) of quaternions p q: q rotates first, then p."""
    xp = p.__array_namespace__()
    w, x, y, z = xp.moveaxis(p, -1, 0)
    a, b, c, d = xp.moveaxis(q, -1, 0)
    parts = (
        w * a - x * b - y * c - z * d,
        w * b + x * a + y * d - z * c,
        w * c - x * d + y * a + z * b,
        w * d + x * c - y * b + z * a,
    )
    return xp.stack(parts, -1)


def rotate(quaternion: Any, vector: Any) -> Any:
    """Rotates vectors (..., 3) by unit quaternions (..., 4)."""
    xp = quaternion.__array_namespace__()
    w, u = quaternion[..., :1], quaternion[..., 1:]
    twice = 2.0 * xp.cross(u, vector)
    return vector + w * twice + xp.cross(u, twice)


def yaw_of(quaternion: Any) -> Any:
    """Returns the heading (...) rad of bodies rotated by unit quaternions (..., 4)."""
    xp = quaternion.__array_namespace__()
    w, x, y, z = xp.moveaxis(quaternion, -1, 0)
    return xp.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def up_of(quaternion: Any) -> Any:
    """Returns the world z component (...) of the up axis of bodies rotated by unit quaternions (..., 4); 1 =
    upright."""
    x, y = quaternion[..., 1], quaternion[..., 2]
    return 1.0 - 2.0 * (x * x + y * y)


def from_yaw(yaw: Any) -> Any:
    """Returns the quaternions (..., 4) of rotations by (...) rad about z; a number or a list gives a numpy array."""
    xp = yaw.__array_namespace__() if hasattr(yaw, "__array_namespace__") else np
    half = 0.5 * xp.asarray(yaw)
    zero = xp.zeros_like(half)
    return xp.stack([xp.cos(half), zero, zero, xp.sin(half)], -1)


def from_rotation_vector(vector: Any) -> Any:
    """Returns the quaternions (..., 4) of rotation vectors (..., 3): rotations about their directions by their lengths
    (rad)."""
    xp = vector.__array_namespace__()
    half = 0.5 * xp.linalg.norm(vector, axis=-1, keepdims=True)
    # numpy's sinc(x) is sin(pi x) / (pi x); sin(h) / (2 h) tends to 1/2.
    return xp.concatenate([xp.cos(half), 0.5 * xp.sinc(half / np.pi) * vector], -1)


def wrapped(angle: np.ndarray) -> np.ndarray:
    """Returns the same angles (rad, NumPy) in [-pi, pi)."""
    return np.remainder(angle + np.pi, 2 * np.pi) - np.pi


def about_z(yaw: float) -> np.ndarray:
    """Returns the rotation matrix (3, 3) f64 by an angle (rad) about z, counter-clockwise seen from above."""
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
