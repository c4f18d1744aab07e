"""Spheres against convex hulls: a cheap lower bound for all pairs, the exact distance for the few that matter.

In:   sphere centres and radii, `Slots`, the hull table.
Out:  `SphereContacts`, a fixed number of contacts.
When: every physics step, per env, inside jit.

The bound is the distance to the hull's outline along 13 fixed axes of its frame (faces, edges and corners of a cube):
never more than the true distance, so no touching pair ranks behind one that is surely apart.
"""

import itertools
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ..datatypes import SceneBank
from .slots import Slots

_AXES = np.array([a for a in itertools.product((-1, 0, 1), repeat=3) if a > (0, 0, 0)], np.float64)
#: (13, 3) unit axes, one of each opposite pair.
AXES = _AXES / np.linalg.norm(_AXES, axis=1, keepdims=True)
#: Barycentric coordinates must exceed this for the foot of the perpendicular to count as inside a triangle; on its
#: edges the edge itself gives the same answer without trusting the coordinates of slivers.
_INSIDE = 1e-6
#: m; a centre nearer to the surface has no direction of its own, and the face's normal is taken.
_ON_SURFACE = 1e-6


class HullTable(NamedTuple):
    """T hulls in their own frames.

    Attributes:
      low, high: (T, 13) m, the hull's extent along `AXES`.
      faces: (T, 13, F) f32 per triangle: corner a, edges b - a and c - a, unit normal, offset; padded by repetition.
    """

    low: Any
    high: Any
    faces: Any


class SphereContacts(NamedTuple):
    """The contacts of one robot, `num_contacts` of them.

    Attributes:
      sphere: (n,) i32; slot: (n,) i32.
      distance: (n,) m, negative where they overlap; infinite for an empty slot.
      normal: (n, 3) unit, from the hull to the sphere, world frame.
      position: (n, 3) m, half-way between the surfaces, world frame.
      missed: () i32, pairs that may touch and were not looked at.
    """

    sphere: Any
    slot: Any
    distance: Any
    normal: Any
    position: Any
    missed: Any


def hull_table(bank: SceneBank) -> HullTable:
    """The bank's hulls prepared for distances."""
    along = np.einsum("tvi,ki->tvk", bank.hull_vertices.astype(np.float64), AXES)
    width = int(bank.hull_num_triangles.max())
    a, b, c = (
        np.take_along_axis(bank.hull_vertices, bank.hull_triangles[:, :width, i, None], axis=1) for i in range(3)
    )
    planes = bank.hull_planes[:, :width]
    faces = np.concatenate([a, b - a, c - a, planes], axis=-1).transpose(0, 2, 1)
    return HullTable(*(jnp.asarray(x, jnp.float32) for x in (along.min(1), along.max(1), faces)))


def distance_bound(centres: Any, radii: Any, slots: Slots, table: HullTable) -> Any:
    """(S, C) m: for every sphere and slot a number that is at most their distance."""
    offset = centres[:, None, :] - slots.position
    local = jnp.einsum("cij,sci->scj", slots.rotation, offset)
    low, high = table.low[slots.hull], table.high[slots.hull]
    bound = jnp.full(local.shape[:2], -jnp.inf)
    for k, axis in enumerate(AXES):
        along = sum(float(a) * local[..., i] for i, a in enumerate(axis) if a)
        bound = jnp.maximum(bound, jnp.maximum(low[:, k] - along, along - high[:, k]))
    return jnp.where(slots.valid, bound - radii[:, None], jnp.inf)


def closest_point(point: Any, faces: Any) -> tuple[Any, Any]:
    """Signed distance () from a point (3,) to a hull and the outward direction (3,), in the hull's frame.

    Inside, the distance is that to the nearest face plane, negative: the least way out.
    """
    a, ab, ac, normal, offset = faces[0:3], faces[3:6], faces[6:9], faces[9:12], faces[12]

    def dot(u: Any, w: Any) -> Any:
        return u[0] * w[0] + u[1] * w[1] + u[2] * w[2]

    ap = point[:, None] - a
    height = dot(normal, jnp.broadcast_to(point[:, None], normal.shape)) - offset
    d1, d2 = dot(ab, ap), dot(ac, ap)
    g11, g12, g22 = dot(ab, ab), dot(ab, ac), dot(ac, ac)
    inverse = 1.0 / jnp.maximum(g11 * g22 - g12 * g12, 1e-20)
    beta, gamma = (g22 * d1 - g12 * d2) * inverse, (g11 * d2 - g12 * d1) * inverse
    inside = (beta > _INSIDE) & (gamma > _INSIDE) & (beta + gamma < 1.0 - _INSIDE) & (height > 0)
    # Vectors from the nearest point to the sphere's centre, for the three edges; differences before squares, because
    # ground prisms are tens of metres long.
    best = height * normal
    length = jnp.where(inside, height * height, jnp.inf)
    bc = ac - ab
    g33 = g11 - 2 * g12 + g22
    for start, edge, along, square in ((ap, ab, d1, g11), (ap, ac, d2, g22), (ap - ab, bc, dot(bc, ap - ab), g33)):
        way = start - jnp.clip(along / jnp.maximum(square, 1e-20), 0.0, 1.0) * edge
        candidate = dot(way, way)
        best = jnp.where(candidate < length, way, best)
        length = jnp.minimum(length, candidate)
    nearest, face = jnp.argmin(length), jnp.argmax(height)
    deepest = height[face]
    distance = jnp.sqrt(length[nearest])
    outside = (deepest > 0) & (distance > _ON_SURFACE)
    direction = jnp.where(outside, best[:, nearest] / jnp.maximum(distance, _ON_SURFACE), normal[:, face])
    return jnp.where(outside, distance, jnp.minimum(deepest, distance)), direction


def find_contacts(centres: Any, radii: Any, slots: Slots, table: HullTable, num_contacts: int) -> SphereContacts:
    """The `num_contacts` pairs of a sphere and a hull that lie nearest to each other.

    Args:
      centres: (S, 3) m, world frame. radii: (S,) m.
      slots: C hulls; S * C must be at least `num_contacts`.
    """
    bound = distance_bound(centres, radii, slots, table).ravel()
    negative, pair = jax.lax.top_k(-bound, num_contacts)
    missed = jnp.maximum(jnp.sum(bound < 0) - num_contacts, 0).astype(jnp.int32)
    sphere, slot = pair // slots.hull.shape[0], pair % slots.hull.shape[0]
    rotation, centre, radius = slots.rotation[slot], centres[sphere], radii[sphere]
    local = jnp.einsum("nij,ni->nj", rotation, centre - slots.position[slot])
    gap, direction = jax.vmap(closest_point)(local, table.faces[slots.hull[slot]])
    distance = jnp.where(jnp.isfinite(negative), gap - radius, jnp.inf)
    normal = jnp.einsum("nij,nj->ni", rotation, direction)
    touch = jnp.where(jnp.isfinite(distance), radius + 0.5 * distance, radius)
    return SphereContacts(sphere, slot, distance, normal, centre - normal * touch[:, None], missed)
