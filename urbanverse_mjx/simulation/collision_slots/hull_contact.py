"""Contacts of spheres with convex hulls: a cheap lower bound for all pairs, the exact distance for the nearest ones.

In:   sphere centres and radii, `Slots`, the hull table.
Out:  `SphereContacts`, a fixed number of contacts.
When: every physics step, per env, inside jit.

Three passes, each for fewer pairs:
1. All pairs: the distance to the hull's outline along 13 fixed axes of its frame (faces, edges and corners of a cube).
   It is never more than the true distance, so no touching pair ranks behind one that is surely apart.
2. The nearest of them, twice as many as there are contacts: the face plane farthest out. The distance to a convex body
   is at least that to each of its planes, so a face can only hold the nearest point if it is this one, and the point's
   foot on it lies in the body.
3. The nearest of these become contacts; where the foot lies outside, the nearest point is on an edge.
"""

import itertools
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ...datatypes import SceneBank
from .static_slots import Slots

_AXES = np.array([a for a in itertools.product((-1, 0, 1), repeat=3) if a > (0, 0, 0)], np.float64)
#: (13, 3) unit axes, one of each opposite pair.
AXES = _AXES / np.linalg.norm(_AXES, axis=1, keepdims=True)
#: m, tolerance of the test whether the projection of a point lies on a face (float32 over tens of metres).
_FOOT_TOLERANCE = 1e-5
#: m; within this distance of an edge the direction is undefined, and the face's normal is used.
_EDGE_TOLERANCE = 1e-6


class HullTable(NamedTuple):
    """T hulls in their own frames.

    Attributes:
      low, high: (T, 13) m, the hull's extent along `AXES`.
      planes: (T, 4, F) outward unit normal and offset of each distinct face plane, padded by repetition.
      edges: (T, 6, E) start and direction of each edge between two planes, padded by repetition.
    """

    low: Any
    high: Any
    planes: Any
    edges: Any


class SphereContacts(NamedTuple):
    """The contacts of one robot, `num_contacts` of them.

    Attributes:
      sphere: (n,) i32.
      slot: (n,) i32.
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


def planes_and_edges(corners: np.ndarray, triangles: np.ndarray, planes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distinct planes (f, 4) and the edges (e, 6) that are not inside a flat face."""
    distinct, plane = np.unique(planes, axis=0, return_inverse=True)
    edge = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    side = np.repeat(plane.ravel(), 3)
    pairs, which = np.unique(edge, axis=0, return_inverse=True)
    low, high = np.full(len(pairs), len(distinct)), np.full(len(pairs), -1)
    np.minimum.at(low, which.ravel(), side)
    np.maximum.at(high, which.ravel(), side)
    number = np.bincount(which.ravel(), minlength=len(pairs))
    sharp = pairs[(low != high) | (number == 1)]
    start = corners[sharp[:, 0]]
    return distinct, np.concatenate([start, corners[sharp[:, 1]] - start], axis=1)


def _pad(rows: list[np.ndarray]) -> np.ndarray:
    """Rows (n_t, k) as (T, k, max n), padded by repeating the first."""
    width = max(len(r) for r in rows)
    return np.stack([np.concatenate([r, np.repeat(r[:1], width - len(r), axis=0)]).T for r in rows])


def hull_table(bank: SceneBank) -> HullTable:
    """The bank's hulls prepared for distances."""
    along = np.einsum("tvi,ki->tvk", bank.hull_vertices.astype(np.float64), AXES)
    parts = [
        planes_and_edges(bank.hull_vertices[t], bank.hull_triangles[t, :n], bank.hull_planes[t, :n])
        for t, n in enumerate(bank.hull_num_triangles)
    ]
    arrays = (along.min(1), along.max(1), _pad([p for p, _ in parts]), _pad([e for _, e in parts]))
    return HullTable(*(jnp.asarray(a, jnp.float32) for a in arrays))


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


def _dot(u: Any, w: Any) -> Any:
    return u[0] * w[0] + u[1] * w[1] + u[2] * w[2]


def face_distance(point: Any, planes: Any) -> tuple[Any, Any, Any]:
    """Distance () from a point (3,) to the plane farthest out, its normal (3,), and whether it holds the nearest point.

    Inside the hull the distance is negative: that to the nearest way out.
    """
    height = _dot(planes, point[:, None]) - planes[3]
    face = jnp.argmax(height)
    normal, distance = planes[:3, face], height[face]
    foot = point - distance * normal
    outside = jnp.max(_dot(planes, foot[:, None]) - planes[3])
    return distance, normal, (distance <= 0) | (outside <= _FOOT_TOLERANCE)


def edge_distance(point: Any, edges: Any, normal: Any) -> tuple[Any, Any]:
    """Distance () from a point (3,) to the nearest edge and the direction (3,) from there; `normal` if it is on it."""
    # Differences before squares, because ground prisms are tens of metres long.
    start, edge = point[:, None] - edges[:3], edges[3:]
    share = jnp.clip(_dot(start, edge) / _dot(edge, edge), 0.0, 1.0)
    to_edge = start - share * edge
    square = _dot(to_edge, to_edge)
    nearest = jnp.argmin(square)
    distance = jnp.sqrt(square[nearest])
    return distance, jnp.where(
        distance > _EDGE_TOLERANCE, to_edge[:, nearest] / jnp.maximum(distance, _EDGE_TOLERANCE), normal
    )


def _with_edges(
    local: Any, hull: Any, gap: Any, normal: Any, open_: Any, edges: Any, number: int
) -> tuple[Any, Any, Any]:
    """Replaces gap (n,) and normal (n, 3) of the `number` smallest entries of open_ (n,) by those to the edges.

    Returns both and () i32, how many entries with open_ < 0 were left.
    """
    negative, pick = jax.lax.top_k(-open_, number)
    distance, direction = jax.vmap(edge_distance)(local[pick], edges[hull[pick]], normal[pick])
    # A product with zeros and ones is faster than a scatter.
    chosen = (pick[:, None] == jnp.arange(len(gap))) & (negative > 0)[:, None]
    found = chosen.any(0)
    gap = jnp.where(found, jnp.sum(jnp.where(chosen, distance[:, None], 0.0), 0), gap)
    normal = jnp.where(found[:, None], jnp.sum(jnp.where(chosen[..., None], direction[:, None], 0.0), 0), normal)
    return gap, normal, jnp.maximum(jnp.sum(open_ < 0) - number, 0)


def _to_local(centre: Any, slots: Slots, slot: Any) -> Any:
    """Points (n, 3) in the frames of the hulls in slot (n,)."""
    return jnp.einsum("nij,ni->nj", slots.rotation[slot], centre - slots.position[slot])


def find_contacts(
    centres: Any, radii: Any, slots: Slots, table: HullTable, num_contacts: int, spare: int = 0
) -> SphereContacts:
    """The `num_contacts` pairs of a sphere and a hull that lie nearest to each other.

    Without spare ones at most two thirds of them may touch at an edge. Distances that are positive may be too small,
    never too large.

    Args:
      centres: (S, 3) m, world frame.
      radii: (S,) m.
      slots: C hulls; S * C must be at least `num_contacts` and the spare ones.
      spare: pairs of the third pass beyond the contacts, for grounds of small pieces: beside a corner of one, a sphere
        is nearer to its planes than to itself.
    """
    bound = distance_bound(centres, radii, slots, table).ravel()
    exact = num_contacts + spare
    candidates = min(2 * exact, bound.size)
    negative, pair = jax.lax.top_k(-bound, candidates)
    sphere, slot = pair // slots.hull.shape[0], pair % slots.hull.shape[0]
    planes = table.planes[slots.hull[slot]]
    plane, direction, on_face = jax.vmap(face_distance)(_to_local(centres[sphere], slots, slot), planes)
    if spare:
        plane = jnp.where(on_face, plane, jnp.maximum(plane, radii[sphere] - negative))
    distance = jnp.where(jnp.isfinite(negative), plane - radii[sphere], jnp.inf)
    missed = jnp.maximum(jnp.sum(bound < 0) - candidates, 0) + jnp.maximum(jnp.sum(distance < 0) - exact, 0)

    negative, pick = jax.lax.top_k(-distance, exact)
    sphere, slot, gap, direction, on_face = (x[pick] for x in (sphere, slot, plane, direction, on_face))
    centre, radius, distance = centres[sphere], radii[sphere], -negative
    open_ = jnp.where((distance < 0) & ~on_face, distance, jnp.inf)
    local, hull = _to_local(centre, slots, slot), slots.hull[slot]
    number = exact if spare else -(-2 * num_contacts // 3)
    gap, direction, skipped = _with_edges(local, hull, gap, direction, open_, table.edges, number)
    distance = jnp.where(jnp.isfinite(distance), gap - radius, jnp.inf)
    normal = jnp.einsum("nij,nj->ni", slots.rotation[slot], direction)
    touch = jnp.where(jnp.isfinite(distance), radius + 0.5 * distance, radius)
    position = centre - normal * touch[:, None]
    found = SphereContacts(sphere, slot, distance, normal, position, (missed + skipped).astype(jnp.int32))
    return _deepest(found, num_contacts) if spare else found


def _deepest(contacts: SphereContacts, number: int) -> SphereContacts:
    """The `number` contacts with the least distance; those that touch and are left out count as missed."""
    _, pick = jax.lax.top_k(-contacts.distance, number)
    left_out = jnp.maximum(jnp.sum(contacts.distance < 0) - number, 0)
    kept = {name: getattr(contacts, name)[pick] for name in contacts._fields if name != "missed"}
    return SphereContacts(**kept, missed=contacts.missed + left_out.astype(jnp.int32))
