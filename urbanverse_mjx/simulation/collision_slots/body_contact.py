"""Contacts of movable bodies with the ground, static hulls and each other: surface points against convex hulls.

In:   W bodies, `Slots` near each of them, the hull tables.
Out:  `BodyContacts`, a fixed number a body.
When: every physics step, per env, inside jit.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from .hull_contact import HullTable
from .static_slots import Slots, both_surfaces

#: Contacts of a body with the ground, and with anything else.
GROUND_CONTACTS, OTHER_CONTACTS = 8, 4
#: m below the top of the ground up to which a point is pushed upwards; at a seam of two prisms the hidden side face may
#: be nearer than the top.
LIFT = 0.02
#: rad, first direction of the ground contacts; not a multiple of 45°, so that the corners of a box are not tied.
FIRST_DIRECTION = 0.1
_ANGLES = FIRST_DIRECTION + 2.0 * np.pi * np.arange(GROUND_CONTACTS) / GROUND_CONTACTS
#: (8, 2) unit vectors, directions from the centre of mass in which the outermost point that touches the ground is a
#: contact.
DIRECTIONS = np.stack([np.cos(_ANGLES), np.sin(_ANGLES)], -1).astype(np.float32)


class BodyContacts(NamedTuple):
    """n contacts of bodies.

    Attributes:
      body: (n,) i32, whose point it is.
      other: (n,) i32, body that it touches, -1 = what does not move.
      distance: (n,) m, negative where they overlap, else infinite.
      normal: (n, 3) unit, towards `body`.
      position: (n, 3) m, half-way between the surfaces; world frame.
      friction: (n,).
    """

    body: Any
    other: Any
    distance: Any
    normal: Any
    position: Any
    friction: Any


def ground_contacts(
    places: Any, centre: Any, prisms: Slots, planes: Any, friction: Any, least: bool = False
) -> BodyContacts:
    """Contacts of all bodies with the ground.

    Args:
      places: (W, P, 3) m, points in the world.
      centre: (W, 3) m, of mass.
      prisms: Q prisms near each body, leading axis W.
      planes: (T, 4, F) of the hull table, in the prisms' frames, which are not turned.
      friction: (W,) of the bodies.
      least: see `both_surfaces`.
    """
    local = places[:, :, None] - prisms.position[:, None]
    own = planes[prisms.hull]
    height = jnp.einsum("wpqi,wqif->wpqf", local, own[:, :, :3]) - own[:, None, :, 3]
    top = jnp.argmax(own[:, :, 2], axis=-1)
    above = jnp.take_along_axis(height, top[:, None, :, None], axis=-1)[..., 0]
    side = jnp.argmax(height, axis=-1)
    outside = jnp.take_along_axis(height, side[..., None], axis=-1)[..., 0]
    lifted = above > -LIFT
    face = jnp.where(lifted, top[:, None], side)
    inside = (outside < 0.0) & prisms.valid[:, None]
    depth = jnp.where(inside, jnp.where(lifted, above, outside), jnp.inf)
    prism = jnp.argmin(depth, axis=-1)
    depth = jnp.take_along_axis(depth, prism[..., None], axis=-1)[..., 0]
    face = jnp.take_along_axis(face, prism[..., None], axis=-1)[..., 0]
    out = (places - centre[:, None])[..., :2] @ DIRECTIONS.T
    out = jnp.where(jnp.isfinite(depth)[..., None], out, -jnp.inf)
    best = jnp.argmax(out, axis=1)
    again = (best[:, :, None] == best[:, None]) & jnp.tril(jnp.ones((GROUND_CONTACTS,) * 2, bool), -1)
    bodies = jnp.arange(len(places))[:, None]
    prism, face = prism[bodies, best], face[bodies, best]
    normal = jnp.moveaxis(own, 2, 3)[bodies, prism, face, :3]
    distance = jnp.where(again.any(-1), jnp.inf, depth[bodies, best])
    return _contacts(
        jnp.broadcast_to(bodies, best.shape),
        jnp.full(best.shape, -1),
        distance,
        normal,
        places[bodies, best],
        both_surfaces(least, friction[:, None], prisms.friction[bodies, prism]),
    )


def other_contacts(
    places: Any, targets: Slots, other: Any, table: HullTable, box: Any, friction: Any, least: bool = False
) -> BodyContacts:
    """Contacts of all bodies with static hulls and with each other's hulls.

    Args:
      places: (W, P, 3) m.
      targets: T hulls for each body, leading axis W.
      other: (W, T) i32, the body whose hull it is, -1 = static.
      box: (hulls, 2, 3) m, boxes around the table's hulls.
      friction: (W,) of the bodies.
      least: see `both_surfaces`.
    """
    number = targets.hull.shape[1]
    local = jnp.einsum("wtij,wpti->wptj", targets.rotation, places[:, :, None] - targets.position[:, None])
    around = box[targets.hull]
    bound = jnp.max(jnp.abs(local - around[:, None, :, 0]) - around[:, None, :, 1], axis=-1)
    bound = jnp.where(targets.valid[:, None], bound, jnp.inf).reshape(len(places), -1)
    _, pair = jax.lax.top_k(-bound, 3 * OTHER_CONTACTS)
    point, target = pair // number, pair % number
    bodies = jnp.arange(len(places))[:, None]
    planes = table.planes[targets.hull[bodies, target]]
    height = jnp.einsum("wki,wkif->wkf", local[bodies, point, target], planes[:, :, :3]) - planes[:, :, 3]
    depth = jnp.where(jnp.isfinite(bound[bodies, pair]), height.max(-1), jnp.inf)
    depth = jnp.where(depth < 0.0, depth, jnp.inf)
    negative, pick = jax.lax.top_k(-depth, OTHER_CONTACTS)
    point, target, face = point[bodies, pick], target[bodies, pick], height.argmax(-1)[bodies, pick]
    normal = jnp.moveaxis(planes, 2, 3)[bodies, pick, face, :3]
    return _contacts(
        jnp.broadcast_to(bodies, pick.shape),
        other[bodies, target],
        -negative,
        jnp.einsum("wkij,wkj->wki", targets.rotation[bodies, target], normal),
        places[bodies, point],
        both_surfaces(least, friction[:, None], targets.friction[bodies, target]),
    )


def _contacts(body: Any, other: Any, distance: Any, normal: Any, point: Any, friction: Any) -> BodyContacts:
    depth = jnp.where(distance < 0.0, distance, 0.0)
    position = point - 0.5 * depth[..., None] * normal
    distance = jnp.where(distance < 0.0, distance, jnp.inf)
    found = BodyContacts(body, other, distance, normal, position, friction)
    return BodyContacts(*(x.reshape(-1, *x.shape[2:]) for x in found))


def join(first: BodyContacts, second: BodyContacts) -> BodyContacts:
    return BodyContacts(*(jnp.concatenate([a, b]) for a, b in zip(first, second, strict=True)))
