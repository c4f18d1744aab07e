"""Replaces the collision shapes of a robot's MJCF by spheres.

In: an `MjSpec` with colliding boxes, capsules, cylinders, ellipsoids or meshes. Out: the spec with spheres instead, and
the fits: `Fit`. When: once, at construction.
"""

import dataclasses
import re
from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from ..datatypes import validation as v
from .sphere_fit import Cover, FitOptions, cover, wheel

_TYPES = {
    mujoco.mjtGeom.mjGEOM_BOX: "box",
    mujoco.mjtGeom.mjGEOM_CAPSULE: "capsule",
    mujoco.mjtGeom.mjGEOM_CYLINDER: "cylinder",
    mujoco.mjtGeom.mjGEOM_ELLIPSOID: "ellipsoid",
    mujoco.mjtGeom.mjGEOM_MESH: "mesh",
}
#: Corners of the circles of cylinders and capsules; 48 corners approximate a circle of 0.2 m within 0.4 mm.
_CORNERS = 48
#: Groups of geoms: visual, and collision only.
_VISUAL_GROUP, _COLLISION_GROUP = 2, 3


@dataclasses.dataclass(frozen=True)
class Fit:
    """The spheres that replace a geom.

    Attributes:
      geom, body: names.
      shape: "box", "capsule", "cylinder", "ellipsoid" or "mesh".
      points: (n, 3) m, corners of the shape in its body's frame.
      rolls: a wheel, see `sphere_fit.wheel`.
      spheres: names of the geoms in its place.
      cover: those spheres in the body's frame, and their error.
      options: of the fit.
    """

    geom: str
    body: str
    shape: str
    points: np.ndarray
    rolls: bool
    spheres: tuple[str, ...]
    cover: Cover
    options: FitOptions

    @property
    def misses(self) -> bool:
        """Whether the error of a shape that is no wheel is above the tolerance."""
        return not self.rolls and self.cover.error > self.options.tolerance


def replace_by_spheres(
    spec: mujoco.MjSpec, model: mujoco.MjModel, feet: Sequence[str], options: FitOptions, where: str
) -> tuple[tuple[str, ...], tuple[Fit, ...]]:
    """Replaces every colliding geom of `spec` other than spheres.

    A foot on a body that turns about a hinge is a wheel and is replaced by one with the same rolling radius, as is a
    foot that is a cylinder or capsule, about its own axis. Other feet keep their lowest height. The shapes no longer
    collide; if the MJCF has no visual geoms, they become the visual ones.

    Args:
      model: the compiled `spec`.
      feet: names of the geoms that may touch the ground.
      where: prefix of error messages.

    Returns:
      the names of the feet, with replaced ones as their spheres; the fits.

    Raises:
      ValidationError: a shape has no interior, such as a plane or a height field.
    """
    solid = [g for g in spec.geoms if g.contype or g.conaffinity]
    others = [g for g in solid if g.type != mujoco.mjtGeom.mjGEOM_SPHERE]
    seen = any(g.group == _VISUAL_GROUP for g in spec.geoms)
    # Ids change when a geom is added, so everything is read before.
    fits: list[Fit] = []
    for geom in others:
        where_geom = f"{where}.mjcf: geom {geom.name!r}"
        if geom.type not in _TYPES:
            kind = geom.type.name.removeprefix("mjGEOM_").lower()
            raise v.fail(where_geom, f"a {kind} that collides", "a sphere, " + ", ".join(_TYPES.values()))
        points = _points(model, geom.id)
        own, axle = _local(model, geom.id), _axle(model, geom.id) if geom.name in feet else None
        made = wheel(points, *axle) if axle else _moved(cover(_into(points, own), options), own)
        if geom.name in feet and not axle:
            made = _standing(made, points, model, int(model.geom_bodyid[geom.id]))
        names = tuple(_sphere_name(geom.name or f"shape_{len(fits)}", i) for i in range(len(made.radius)))
        kind = _TYPES[geom.type]
        fits.append(Fit(geom.name, geom.parent.name, kind, points, axle is not None, names, made, options))
    for geom, fit in zip(others, fits, strict=True):
        _put(geom, fit)
        geom.contype = geom.conaffinity = 0
        geom.group = geom.group if seen else _VISUAL_GROUP
    named = {fit.geom: fit.spheres for fit in fits}
    return tuple(name for foot in feet for name in named.get(foot, (foot,))), tuple(fits)


def _sphere_name(shape: str, number: int) -> str:
    return f"{shape}_sphere_{number}"


def is_fitted_sphere(name: str) -> bool:
    """Whether a geom of this name is one of the spheres in place of another shape, which keeps its name."""
    return re.search(r"_sphere_\d+$", name) is not None


def _put(geom: Any, fit: Fit) -> None:
    """Adds the spheres of a fit to its geom's body, with the geom's friction and contact parameters."""
    for name, centre, radius in zip(fit.spheres, fit.cover.centre, fit.cover.radius, strict=True):
        sphere = geom.parent.add_geom(name=name, type=mujoco.mjtGeom.mjGEOM_SPHERE, pos=centre, size=[radius, 0, 0])
        for key in ("contype", "conaffinity", "condim", "priority", "friction", "solmix", "solref", "solimp"):
            setattr(sphere, key, getattr(geom, key))
        sphere.margin, sphere.gap, sphere.group, sphere.mass = geom.margin, geom.gap, _COLLISION_GROUP, 0.0


def _local(model: mujoco.MjModel, geom: int) -> tuple[np.ndarray, np.ndarray]:
    """Rotation (3, 3) and origin (3,) m of a geom in its body."""
    return Rotation.from_quat(model.geom_quat[geom], scalar_first=True).as_matrix(), model.geom_pos[geom].copy()


def _into(points: np.ndarray, frame: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    return (points - frame[1]) @ frame[0]


def _moved(made: Cover, frame: tuple[np.ndarray, np.ndarray]) -> Cover:
    return dataclasses.replace(made, centre=made.centre @ frame[0].T + frame[1])


def _axle(model: mujoco.MjModel, geom: int) -> tuple[np.ndarray, np.ndarray] | None:
    """Axis (3,) and anchor (3,) m of a wheel in the body's frame: the single hinge of its body, or the own axis of a
    cylinder or capsule; None for other feet."""
    body = int(model.geom_bodyid[geom])
    joints = range(model.body_jntadr[body], model.body_jntadr[body] + model.body_jntnum[body])
    if len(joints) == 1 and model.jnt_type[joints[0]] == mujoco.mjtJoint.mjJNT_HINGE:
        return model.jnt_axis[joints[0]].copy(), model.jnt_pos[joints[0]].copy()
    kind = model.geom_type[geom]
    if kind == mujoco.mjtGeom.mjGEOM_CYLINDER or kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
        rotation, origin = _local(model, geom)
        return rotation[:, 2], origin
    return None


def _standing(made: Cover, points: np.ndarray, model: mujoco.MjModel, body: int) -> Cover:
    """Moves a foot's cover so that its lowest point is that of the foot in the robot's initial pose."""
    data = mujoco.MjData(model)
    data.qpos[:] = model.key_qpos[0] if model.nkey else model.qpos0
    mujoco.mj_kinematics(model, data)
    up = data.xmat[body].reshape(3, 3)[2]
    lift = (points @ up).min() - (made.centre @ up - made.radius).min()
    errors = made.protrudes + abs(lift), made.falls_short + abs(lift)
    return Cover(made.centre + lift * up, made.radius, *errors)


def _points(model: mujoco.MjModel, geom: int) -> np.ndarray:
    """(n, 3) m, in the body's frame: points whose convex hull is the geom's shape."""
    rotation, origin = _local(model, geom)
    return _corners(model, geom) @ rotation.T + origin


def _corners(model: mujoco.MjModel, geom: int) -> np.ndarray:
    kind, size = model.geom_type[geom], model.geom_size[geom]
    if kind == mujoco.mjtGeom.mjGEOM_MESH:
        mesh = int(model.geom_dataid[geom])
        first = model.mesh_vertadr[mesh]
        return model.mesh_vert[first : first + model.mesh_vertnum[mesh]].astype(np.float64)
    if kind == mujoco.mjtGeom.mjGEOM_BOX:
        return np.stack(np.meshgrid(*([-s, s] for s in size), indexing="ij"), -1).reshape(-1, 3)
    turn = 2 * np.pi * np.arange(_CORNERS) / _CORNERS
    ring = np.stack([np.cos(turn), np.sin(turn), 0 * turn], -1)
    if kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
        return np.concatenate([ring * size[0] + [0, 0, z] for z in (-size[1], size[1])])
    tilt = np.linspace(0, np.pi, _CORNERS // 2 + 1)
    ball = np.concatenate([ring * np.sin(t) + [0, 0, np.cos(t)] for t in tilt])
    if kind == mujoco.mjtGeom.mjGEOM_ELLIPSOID:
        return ball * size
    return np.concatenate([ball * size[0] + [0, 0, z] for z in (-size[1], size[1])])
