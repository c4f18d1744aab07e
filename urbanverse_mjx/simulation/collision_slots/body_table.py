"""Physics data of the movable objects of a bank: masses, hulls, and surface points.

In:   `SceneBank`.
Out:  `BodyTable`, numpy.
When: once, at construction of an engine.

A body collides with the robot's spheres by its hulls, and with everything else (ground, static hulls, other bodies) by
points of its surface: its corners first, then evenly distributed points. Contacts of points with planes are cheap and
the same in all engines, in contrast to contacts between hulls (docs/decisions/movable.md).
"""

from typing import Any, NamedTuple

import mujoco
import numpy as np

from ...datatypes import SceneBank
from ...geometry import rotations

#: Points of a body's surface: COCO's largest neighbours, chairs of four hulls, have some 60 corners.
NUM_POINTS = 64
#: m; closer corners are merged, and points deeper than this inside another hull are dropped.
_MERGE_DISTANCE = 0.01
#: m by which a body may be larger around than the bank's grids reach (a scooter's handlebar is 1.1 m from its middle);
#: ground that begins out there may be missed.
_GRID_OVERHANG = 0.3
#: s of simulation of a shape alone on flat ground in C MuJoCo, and rad, largest tilt. An object that falls by itself (a
#: scooter whose stand ends above the ground) would fall as soon as a robot comes near, and is not made a body.
_STABILITY_TIME, _MAX_TIPPING = 1.5, np.radians(15.0)
#: m between the surface points from which the even ones are picked.
_SURFACE_SPACING = 0.04


class BodyTable(NamedTuple):
    """B movable objects in all scenes, of S shapes; H hulls and P points a shape, in the frame of the object.

    Attributes:
      row: (Z, N) i32, which of the B an object (visual slot) is; -1 = it stands still for ever.
      shape: (B,) i32.
      mass: (B,) kg.
      friction: (B,).
      home: (B, 3) m, home_quaternion: (B, 4): where the scene has it.
      centre: (S, 3) m, of mass.
      inertia: (S, 3) m^2, principal moments of 1 kg about it.
      axes: (S, 3, 3), their axes as columns.
      radius: (S,) m, of the ball around the centre of mass that holds the shape.
      hull: (S, H) i32, rows of the hull table, -1 = none.
      points: (S, P, 3) m from the centre of mass.
    """

    row: np.ndarray
    shape: np.ndarray
    mass: np.ndarray
    friction: np.ndarray
    home: np.ndarray
    home_quaternion: np.ndarray
    centre: np.ndarray
    inertia: np.ndarray
    axes: np.ndarray
    radius: np.ndarray
    hull: np.ndarray
    points: np.ndarray


def solid_moments(corners: np.ndarray, triangles: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    """Volume (m^3), its first (3,) and second (3, 3) moments about the origin of a closed surface of triangles (f, 3).

    Sums over tetrahedra from the origin (Tonon, J. Math. Stat. 1 (2005) 8).
    """
    a, b, c = np.moveaxis(corners[triangles].astype(np.float64), 1, 0)
    volume = np.einsum("fi,fi->f", a, np.cross(b, c)) / 6.0
    total = a + b + c
    first = (volume[:, None] * total).sum(0) / 4.0
    outer = sum(np.einsum("f,fi,fj->ij", volume, x, x) for x in (a, b, c, total))
    return float(volume.sum()), first, np.asarray(outer) / 20.0


def _inside(points: np.ndarray, planes: np.ndarray) -> np.ndarray:
    """(n,) m, how far points (n, 3) are outside the plane farthest out; negative inside."""
    return (points @ planes[:, :3].T - planes[:, 3]).max(1)


def _spread(points: np.ndarray, chosen: list[np.ndarray], number: int, least: float) -> list[np.ndarray]:
    """`chosen` and those of points (n, 3) that lie farthest from them, one by one, at least `least` apart."""
    distance = np.full(len(points), np.inf)
    for p in chosen:
        distance = np.minimum(distance, np.linalg.norm(points - p, axis=1))
    while len(chosen) < number and len(points):
        # The first point is the lowest one, on which the body stands.
        i = int(points[:, 2].argmin()) if not chosen else int(distance.argmax())
        if distance[i] < least:
            break
        chosen.append(points[i])
        distance = np.minimum(distance, np.linalg.norm(points - points[i], axis=1))
    return chosen


def _surface(corners: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(n, 3) points on triangles (f, 3), about `_SURFACE_SPACING` apart."""
    found = []
    for a, b, c in corners[triangles].astype(np.float64):
        number = int(
            np.ceil(max(np.linalg.norm(b - a), np.linalg.norm(c - a), np.linalg.norm(c - b)) / _SURFACE_SPACING)
        )
        u, v = (x.ravel() / max(number, 1) for x in np.meshgrid(np.arange(number + 1), np.arange(number + 1)))
        keep = u + v <= 1.0 + 1e-9
        found.append(a + u[keep, None] * (b - a) + v[keep, None] * (c - a))
    return np.concatenate(found)


def surface_points(bank: SceneBank, hulls: tuple[int, ...], number: int = NUM_POINTS) -> np.ndarray:
    """(number, 3) m: points of the surface of a body of these hulls; the first is repeated where there are fewer."""
    corners, surface = [], []
    for t in hulls:
        own = bank.hull_vertices[t, : bank.hull_num_vertices[t]].astype(np.float64)
        both = own, _surface(own, bank.hull_triangles[t, : bank.hull_num_triangles[t]])
        for out, points in zip((corners, surface), both, strict=True):
            outside = np.ones(len(points), bool)
            for other in hulls:
                if other != t:
                    planes = bank.hull_planes[other, : bank.hull_num_triangles[other]].astype(np.float64)
                    outside &= _inside(points, planes) > -_MERGE_DISTANCE
            out.append(points[outside])
    chosen = _spread(np.concatenate(corners), [], number, _MERGE_DISTANCE)
    chosen = _spread(np.concatenate(surface), chosen, number, _MERGE_DISTANCE)
    return np.array(chosen + [chosen[0]] * (number - len(chosen)))


def _shape(bank: SceneBank, hulls: tuple[int, ...]) -> tuple[Any, ...]:
    """centre, inertia, axes, radius and points of a shape, see `BodyTable`, and whether it stands."""
    volume, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    for t in hulls:
        corners = bank.hull_vertices[t, : bank.hull_num_vertices[t]]
        v, f, s = solid_moments(corners, bank.hull_triangles[t, : bank.hull_num_triangles[t]])
        volume, first, second = volume + v, first + f, second + s
    centre = first / volume
    spread = second / volume - np.outer(centre, centre)
    moments, axes = np.linalg.eigh(np.trace(spread) * np.eye(3) - spread)
    axes[:, 2] *= np.sign(np.linalg.det(axes))
    corners = np.concatenate([bank.hull_vertices[t, : bank.hull_num_vertices[t]] for t in hulls])
    radius = np.linalg.norm(corners - centre, axis=1).max()
    return centre, moments, axes, radius, surface_points(bank, hulls) - centre, stands(bank, hulls)


def stands(bank: SceneBank, hulls: tuple[int, ...]) -> bool:
    """Whether an object of these hulls stays upright on flat ground, simulated in C MuJoCo."""
    spec = mujoco.MjSpec()
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[10.0, 10.0, 1.0])
    corners = [bank.hull_vertices[t, : bank.hull_num_vertices[t]] for t in hulls]
    body = spec.worldbody.add_body(name="object", pos=[0.0, 0.0, -float(min(c[:, 2].min() for c in corners))])
    body.add_freejoint()
    for t, own in zip(hulls, corners, strict=True):
        spec.add_mesh(name=str(t), uservert=own.ravel(), inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX)
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=str(t), density=100.0)
    model = spec.compile()
    model.opt.timestep = 0.005
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, round(_STABILITY_TIME / model.opt.timestep))
    return bool(rotations.up_of(data.qpos[3:7]) > np.cos(_MAX_TIPPING))


def body_table(bank: SceneBank, num_hulls: int = 4) -> BodyTable:
    """Selects the objects that can be bodies: movable, with mass, of at most `num_hulls` hulls, stable by themselves,
    and not much larger than the reach of the bank's grids (`grid_reach`)."""
    reach = float(bank.meta["grid_reach"]) + _GRID_OVERHANG
    row = np.full(bank.slot_mesh.shape, -1, np.int32)
    shapes: dict[tuple[int, ...], int] = {}
    found: list[tuple[np.ndarray, ...]] = []
    objects: list[tuple[int, float, float, np.ndarray, np.ndarray]] = []
    for z in range(bank.num_scenes):
        order = np.argsort(bank.inst_object[z], kind="stable")
        owner = bank.inst_object[z, order]
        for slot in np.flatnonzero((bank.slot_movable[z] > 0) & (bank.slot_mass[z] > 0)):
            rows = order[np.searchsorted(owner, slot) : np.searchsorted(owner, slot, "right")]
            rows = rows[bank.inst_hull[z, rows] >= 0]
            if not 1 <= len(rows) <= num_hulls:
                continue
            key = tuple(int(t) for t in bank.inst_hull[z, rows])
            if key not in shapes:
                shapes[key] = len(found)
                found.append(_shape(bank, key))
            if found[shapes[key]][3] > reach or not found[shapes[key]][5]:
                continue
            row[z, slot] = len(objects)
            place = bank.slot_position[z, slot], bank.slot_quaternion[z, slot]
            objects.append(
                (shapes[key], float(bank.slot_mass[z, slot]), float(bank.inst_friction[z, rows].max()), *place)
            )
    columns = [np.array(c) for c in zip(*objects, strict=True)] if objects else [np.zeros((0, *s)) for s in _EMPTY]
    moments = [np.array(c) for c in zip(*found, strict=True)] if found else [np.zeros((0, *s)) for s in _EMPTY_SHAPE]
    hull = np.full((len(shapes), num_hulls), -1, np.int32)
    for key, s in shapes.items():
        hull[s, : len(key)] = key
    shape, mass, friction, home, home_quaternion = columns
    centre, inertia, axes, radius, points, _ = moments
    kinds = shape.astype(np.int32)
    seen = centre, inertia, axes, radius, hull, points
    return BodyTable(row, kinds, mass, friction, home, home_quaternion, *seen)


_EMPTY = ((), (), (), (3,), (4,))
_EMPTY_SHAPE = ((3,), (3,), (3, 3), (), (NUM_POINTS, 3), ())
