"""Mass properties of an asset for other simulators: one rigid body of uniform density inside its hulls."""

import dataclasses
import functools
from collections.abc import Sequence

import numpy as np
import trimesh
from scipy.spatial import ConvexHull

from urbanverse_mjx.datatypes import AssetMesh, AssetRecord

from .decompose import is_flush


@dataclasses.dataclass(frozen=True)
class RigidBody:
    """Mass properties in the asset frame.

    Attributes:
      mass: kg, mass of the record.
      centre: (3,) m, centre of mass.
      inertia: (3, 3) kg m^2 about the centre of mass, axes of the asset frame.
    """

    mass: float
    centre: np.ndarray
    inertia: np.ndarray

    @property
    def principal(self) -> tuple[np.ndarray, np.ndarray]:
        """(3,) principal moments, least first, and the rotation (3, 3) whose columns are their axes."""
        moments, axes = np.linalg.eigh(self.inertia)
        if np.linalg.det(axes) < 0:
            axes[:, 2] *= -1
        return moments, axes


def convex_surface(corners: np.ndarray) -> trimesh.Trimesh:
    """The convex hull of (n, 3) corners as a closed surface with outward orientation; cached, so it must not be
    modified."""
    return _convex_surface(np.ascontiguousarray(corners, np.float64).tobytes())


# Cached, because a stage uses every hull twice (collider and mass), and cousins share assets.
@functools.lru_cache(maxsize=4096)
def _convex_surface(content: bytes) -> trimesh.Trimesh:
    hull = ConvexHull(np.frombuffer(content).reshape(-1, 3))
    faces = hull.simplices.copy()
    a, b, c = (hull.points[faces[:, k]] for k in range(3))
    inwards = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0
    faces[inwards] = faces[inwards][:, ::-1]
    used, faces = np.unique(faces, return_inverse=True)
    return trimesh.Trimesh(hull.points[used], faces.reshape(-1, 3), process=False)


def rigid_body(record: AssetRecord, mesh: AssetMesh, hulls: Sequence[np.ndarray]) -> RigidBody:
    """Rigid body with the record's mass distributed uniformly over its hulls, see `even_body`."""
    return even_body(record.mass, mesh, hulls)


def even_body(mass: float, mesh: AssetMesh, hulls: Sequence[np.ndarray]) -> RigidBody:
    """Rigid body with a mass (kg) distributed uniformly over hulls; overlaps count twice.

    The hull of an object flush with the ground is moved below it; such an object is represented by its mesh's box.
    """
    if is_flush(mesh):
        box = np.array([mesh.vertices.min(0), mesh.vertices.max(0)])
        hulls = [np.array([[box[i, 0], box[j, 1], box[k, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])]
    solids = [convex_surface(h) for h in hulls]
    volumes = np.array([s.volume for s in solids])
    centres = np.array([s.center_mass for s in solids])
    density = mass / volumes.sum()
    centre = volumes @ centres / volumes.sum()
    inertia = np.zeros((3, 3))
    for solid, volume, own in zip(solids, volumes, centres, strict=True):
        away = own - centre  # parallel axes: I = I_own + m (d.d 1 - d d^T)
        inertia += density * solid.moment_inertia
        inertia += density * volume * (away @ away * np.eye(3) - np.outer(away, away))
    return RigidBody(mass, centre, (inertia + inertia.T) / 2)
