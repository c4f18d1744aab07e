"""Primitive geoms as meshes, so that the renderer handles only triangles.

Analytic rays against MuJoCo's primitives doubled the registers of the drawing kernel (115 instead of 58 for CUDA's
sm_90), although few pixels show a robot's own wheels.
"""

import mujoco
import numpy as np

from ...datatypes import ValidationError

#: Straight pieces of a full circle: the error at a radius of 0.15 m is 0.05 mm (MuJoCo's own images have 28).
SLICES = 128


def _revolve(profile: np.ndarray, normals: np.ndarray, slices: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A surface around z from strips of its outline.

    Args:
      profile: (strips, n, 2) radius and height, upwards.
      normals: the same, of the surface there.
      slices: straight pieces around.

    Returns:
      (V, 3) vertices, (V, 3) normals, (F, 3) faces that point outwards.
    """
    angle = np.arange(slices + 1) * (2 * np.pi / slices)
    around = np.stack([np.cos(angle), np.sin(angle)], -1)

    def turned(outline: np.ndarray) -> np.ndarray:
        """(strips, n, slices + 1, 3)"""
        ring = outline[..., None, :1] * around
        height = np.broadcast_to(outline[..., None, 1:], (*ring.shape[:-1], 1))
        return np.concatenate([ring, height], -1)

    vertices = turned(profile)
    number = np.arange(vertices[..., 0].size).reshape(vertices.shape[:-1])
    a, b, c, d = number[:, :-1, :-1], number[:, :-1, 1:], number[:, 1:, 1:], number[:, 1:, :-1]
    faces = np.concatenate([np.stack(x, -1).reshape(-1, 3) for x in ((a, b, c), (a, c, d))])
    vertices, normals = vertices.reshape(-1, 3), turned(normals).reshape(-1, 3)
    corners = vertices[faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return vertices, normals, faces[area > 1e-12 * area.max()]


def _box(half: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    vertices, normals = [], []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            n = np.zeros(3)
            n[axis] = sign
            right, up = np.roll(n, 1) * sign, np.roll(n, 2) * sign
            # Counter-clockwise as seen from outside.
            up, right = (up, right) if np.cross(right, up) @ n > 0 else (right, up)
            vertices += [(n + x * right + y * up) * half for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
            normals += [n] * 4
    faces = np.arange(24).reshape(6, 4)
    return np.array(vertices), np.array(normals), np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])


def primitive_mesh(kind: int, size: np.ndarray, slices: int = SLICES) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(V, 3) vertices, m, (V, 3) normals and (F, 3) faces of a geom in its own frame.

    Args:
      kind: mujoco.mjtGeom.
      size: (3,) as in `MjModel.geom_size`.
      slices: straight pieces of a full circle, a multiple of 4.

    Raises:
      ValidationError: a kind without a surface of its own, such as a plane.
    """
    name, size = mujoco.mjtGeom(kind), np.asarray(size, np.float64)
    half_turn = np.linspace(-np.pi / 2, np.pi / 2, slices // 2 + 1)
    arc = np.stack([np.cos(half_turn), np.sin(half_turn)], -1)
    if name == mujoco.mjtGeom.mjGEOM_BOX:
        return _box(size)
    if name in (mujoco.mjtGeom.mjGEOM_SPHERE, mujoco.mjtGeom.mjGEOM_ELLIPSOID):
        radii = size if name == mujoco.mjtGeom.mjGEOM_ELLIPSOID else np.full(3, size[0])
        vertices, normals, faces = _revolve(arc[None], arc[None], slices)
        normals = normals / radii
        return vertices * radii, normals / np.linalg.norm(normals, axis=1, keepdims=True), faces
    radius, half = size[:2]
    if name == mujoco.mjtGeom.mjGEOM_CAPSULE:
        middle = len(arc) // 2
        low, high = arc[: middle + 1] * radius - [0.0, half], arc[middle:] * radius + [0.0, half]
        normals = np.concatenate([arc[: middle + 1], arc[middle:]])
        return _revolve(np.concatenate([low, high])[None], normals[None], slices)
    if name == mujoco.mjtGeom.mjGEOM_CYLINDER:
        outline = np.array([[0.0, -half], [radius, -half], [radius, half], [0.0, half]])
        profile = np.stack([outline[:2], outline[1:3], outline[2:]])
        normals = np.repeat([[[0.0, -1.0]], [[1.0, 0.0]], [[0.0, 1.0]]], 2, axis=1)
        return _revolve(profile, normals, slices)
    raise ValidationError(
        f"robot's visual geom: found {name.name}; needed a mesh, box, sphere, ellipsoid, capsule or cylinder; "
        "move it to another group than 2, or replace it by a mesh"
    )
