"""Dynamics of free rigid bodies in the JAX engine: inertia, contacts as constraint rows, integration.

In: `Awake`, the static hulls and prisms near them. Out:  `Awake` after one physics step. When: every physics step, per
env, inside jit.

Velocities are those of the centre of mass and of the spin, both in the world's frame, 6 a body behind the robot's own.
"""

from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np

from ...datatypes import SceneBank
from ...geometry import rotations
from ..collision_slots import body_contact, static_slots
from ..collision_slots.body_slots import Awake, BodyConstants
from ..collision_slots.hull_contact import HullTable
from .constraint import Pushed, Rows, pyramid_rows, tangents

#: MuJoCo's defaults for every geom of a scene.
_SOLREF, _SOLIMP = (0.02, 1.0), (0.9, 0.95, 0.001, 0.5, 2.0)
_GRAVITY = -9.81
#: Mass (kg) and moments (kg m^2) of an empty slot, on which no force acts.
_EMPTY_SLOT_MASS = 1.0


class Scenery(NamedTuple):
    """Static geometry near W bodies in one control step.

    Attributes:
      prisms: Q ground prisms, hulls: S static hulls near each, leading axis W.
      planes: (T, 4, F) of the prisms' rows of the hull table.
      box: (T, 2, 3) m, boxes around the table's hulls.
      table: see `HullTable`.
    """

    prisms: static_slots.Slots
    hulls: static_slots.Slots
    planes: Any
    box: Any
    table: HullTable


class Matter(NamedTuple):
    """W bodies' constants: mass (W,) kg, moments (W, 3, 3) kg m^2 in the object's frame, friction (W,), points
    (W, P, 3) and centre (W, 3) m, hull (W, H) i32; see `BodyTable`."""

    mass: Any
    moments: Any
    friction: Any
    points: Any
    centre: Any
    hull: Any


def prism_planes(bank: SceneBank, table: HullTable) -> Any:
    """(T, 4, F) planes of the hull table with no more columns than the ground prisms need."""
    used = np.unique(bank.prism_hull[bank.prism_hull >= 0])
    planes = np.asarray(table.planes)
    distinct = [len(np.unique(planes[t], axis=1).T) for t in used]
    # Padding repeats the first plane, so no plane is lost.
    return table.planes[:, :, : max([1, *distinct])]


def matter(table: BodyConstants, awake: Awake) -> Matter:
    row = jnp.maximum(awake.row, 0)
    shape, there = table.shape[row], awake.row >= 0
    mass = jnp.where(there, table.mass[row], _EMPTY_SLOT_MASS)
    axes = table.axes[shape]
    moments = jnp.einsum("wik,wk,wjk->wij", axes, table.inertia[shape], axes) * mass[:, None, None]
    moments = jnp.where(there[:, None, None], moments, _EMPTY_SLOT_MASS * jnp.eye(3))
    hull = jnp.where(there[:, None], table.hull[shape], -1)
    return Matter(mass, moments, table.friction[row], table.points[shape], table.centre[shape], hull)


def hull_slots(awake: Awake, own: Matter) -> static_slots.Slots:
    """The (W H,) hulls of the bodies where they are now."""
    number, hulls = own.hull.shape
    turn = rotations.matrix(awake.quaternion)
    position = awake.place - jnp.einsum("wij,wj->wi", turn, own.centre)

    def each(x: Any) -> Any:
        return jnp.repeat(x, hulls, axis=0, total_repeat_length=number * hulls)

    return static_slots.Slots(
        hull=jnp.maximum(own.hull, 0).reshape(-1),
        owner=each(awake.object_index),
        valid=(own.hull >= 0).reshape(-1),
        position=each(position),
        rotation=each(turn),
        friction=each(own.friction),
    )


def find_contacts(
    awake: Awake, own: Matter, hulls: static_slots.Slots, scenery: Scenery, least: bool = False
) -> body_contact.BodyContacts:
    """Contacts of the bodies with all but the robot; hulls: of `hull_slots`, least: of `static_slots.both_surfaces`."""
    turn = rotations.matrix(awake.quaternion)
    places = awake.place[:, None] + jnp.einsum("wij,wpj->wpi", turn, own.points)
    there = awake.row >= 0
    # An empty slot has no contacts.
    places = jnp.where(there[:, None, None], places, jnp.inf)
    prisms = scenery.prisms._replace(valid=scenery.prisms.valid & there[:, None])
    number, per_body = own.hull.shape
    whose = jnp.repeat(jnp.arange(number), per_body, total_repeat_length=number * per_body)
    others = static_slots.Slots(*(jnp.broadcast_to(x, (number, *x.shape)) for x in hulls))
    others = others._replace(valid=others.valid & (whose != jnp.arange(number)[:, None]) & there[:, None])
    targets = static_slots.Slots(*(jnp.concatenate([a, b], axis=1) for a, b in zip(scenery.hulls, others, strict=True)))
    still = jnp.full(scenery.hulls.hull.shape, -1)
    other = jnp.concatenate([still, jnp.broadcast_to(whose, (number, len(whose)))], axis=1)
    safe = jnp.where(there[:, None, None], places, 1e6)
    ground = body_contact.ground_contacts(safe, awake.place, prisms, scenery.planes, own.friction, least)
    rest = body_contact.other_contacts(safe, targets, other, scenery.table, scenery.box, own.friction, least)
    return body_contact.join(ground, rest)


def contact_rows(found: body_contact.BodyContacts, awake: Awake, own: Matter, qvel: Any, timestep: float) -> Rows:
    """Four rows per contact; qvel: (nv + 6 W,), the robot's first."""
    acts = found.distance < 0
    depth = jnp.where(acts, found.distance, 0.0)
    axes = jnp.stack([found.normal, *tangents(found.normal)], axis=1)
    inverse = 1.0 / own.mass
    first, second = Pushed(found.body, awake.place, inverse), Pushed(found.other, awake.place, inverse)
    relative = first.columns(axes, found.position) - second.columns(axes, found.position)
    robot = jnp.zeros((*relative.shape[:2], qvel.shape[0] - relative.shape[2]))
    count = len(depth)
    return pyramid_rows(
        jnp.concatenate([robot, relative], axis=-1),
        found.friction[:, None],
        jnp.zeros(count, bool),
        acts,
        depth,
        jnp.broadcast_to(jnp.array(_SOLREF), (count, 2)),
        jnp.broadcast_to(jnp.array(_SOLIMP), (count, 5)),
        first.weight() + second.weight(),
        qvel,
        timestep,
    )


def pushed(slot: Any, awake: Awake, own: Matter) -> Pushed:
    """Effect of the robot's contacts on the bodies; slot: (n,) i32 of `hull_slots`; other slots belong to no body."""
    number, hulls = own.hull.shape
    body = jnp.where((slot >= 0) & (slot < number * hulls), slot // hulls, -1)
    return Pushed(body, awake.place, 1.0 / own.mass)


def joint_mass(robot: Any, awake: Awake, own: Matter) -> Any:
    """(nv + 6 W,) squared: the robot's mass matrix (nv, nv) with the bodies' blocks behind it."""
    first, bodies = robot.shape[0], len(own.mass)
    turn = rotations.matrix(awake.quaternion)
    moments = jnp.einsum("wij,wjk,wlk->wil", turn, own.moments, turn)
    whole = jnp.zeros((first + 6 * bodies,) * 2).at[:first, :first].set(robot)
    for w in range(bodies):
        k = first + 6 * w
        whole = whole.at[k : k + 3, k : k + 3].set(own.mass[w] * jnp.eye(3))
        whole = whole.at[k + 3 : k + 6, k + 3 : k + 6].set(moments[w])
    return whole


def free_acceleration(awake: Awake, own: Matter) -> Any:
    """(6 W,), acceleration of bodies without contacts: gravity and Euler's equations."""
    turn = rotations.matrix(awake.quaternion)
    moments = jnp.einsum("wij,wjk,wlk->wil", turn, own.moments, turn)
    momentum = jnp.einsum("wij,wj->wi", moments, awake.spin)
    change = -jnp.linalg.solve(moments, jnp.cross(awake.spin, momentum)[..., None])[..., 0]
    fall = jnp.where((awake.row >= 0)[:, None], jnp.array([0.0, 0.0, _GRAVITY]), 0.0)
    return jnp.concatenate([fall, change], axis=-1).reshape(-1)


def velocities(awake: Awake) -> Any:
    """(6 W,), velocities of the bodies."""
    return jnp.concatenate([awake.velocity, awake.spin], axis=-1).reshape(-1)


def moved(awake: Awake, acceleration: Any, timestep: float) -> Awake:
    """The bodies one physics step later; acceleration: (6 W,). Velocities first, as MuJoCo's Euler does."""
    warm = acceleration.reshape(-1, 6)
    velocity, spin = awake.velocity + timestep * warm[:, :3], awake.spin + timestep * warm[:, 3:]
    angle = jnp.linalg.norm(spin, axis=-1, keepdims=True) * timestep
    half = 0.5 * angle
    turn = jnp.concatenate([jnp.cos(half), 0.5 * timestep * jnp.sinc(half / jnp.pi) * spin], axis=-1)
    quaternion = rotations.unit(rotations.product(turn, awake.quaternion))
    return awake._replace(
        place=awake.place + timestep * velocity, quaternion=quaternion, velocity=velocity, spin=spin, warm=warm
    )
