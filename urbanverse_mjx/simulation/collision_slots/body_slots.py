"""Body slots: selects which movable objects of an env are simulated in a control step, and converts their states.

In:   `SimState.bodies`, the robot's place.
Out:  `Awake` bodies for the physics; `Bodies` again.
When: once per control step, per env, inside jit; the same for both engines.

An object sleeps, i.e. is static, until the robot or a moving body comes near it.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ...datatypes import Bodies, SceneBank
from ...datatypes import validation as v
from ...geometry import rotations
from .body_table import BodyTable, body_table

#: m/s and rad/s below which a body does not move.
REST_SPEED, REST_SPIN = 0.02, 0.1
#: Ground prisms and static hulls looked at around a body that is awake.
PRISMS, HULLS = 6, 4
#: m/s, assumed largest speed of a body in the search for objects near it; COCO pushes at 2 m/s.
MAX_BODY_SPEED = 2.0
#: m between bounding spheres within which a moving body wakes another one.
_WAKE_DISTANCE = 0.1


class Sizes(NamedTuple):
    """Attributes:
    bodies: M, objects of an env that can be pushed. awake: W, how many of them can move at once. hulls: H, most hulls a
    object may have to be one.
    """

    bodies: int
    awake: int = 3
    hulls: int = 4


class BodyConstants(NamedTuple):
    """`BodyTable` for JAX, with 1 / (kg m^2) and per shape what JAX gathers."""

    row: Any
    shape: Any
    mass: Any
    friction: Any
    home: Any
    home_quaternion: Any
    centre: Any
    inertia: Any
    axes: Any
    radius: Any
    hull: Any
    points: Any


class Awake(NamedTuple):
    """W bodies that move, in the terms of the physics.

    Attributes:
      row: (W,) i32 of the body table, -1 = empty.
      object_index: (W,) i32, object, -1 = none.
      place: (W, 3) m, of the centre of mass.
      quaternion: (W, 4): T_world_object.
      velocity, spin, warm: see `Bodies`.
    """

    row: Any
    object_index: Any
    place: Any
    quaternion: Any
    velocity: Any
    spin: Any
    warm: Any


def checked_sizes(sizes: Sizes | None) -> Sizes | None:
    """The sizes, None where there are no bodies.

    Raises:
      ValidationError: less than one body awake or hull.
    """
    if sizes is None or sizes.bodies == 0:
        return None
    bodies = v.integer(sizes.bodies, "engine.movable.bodies", 1)
    return Sizes(
        bodies, v.integer(sizes.awake, "engine.movable.awake", 1, bodies), v.integer(sizes.hulls, "engine.hulls", 1, 16)
    )


def constants(bank: SceneBank, sizes: Sizes) -> tuple[BodyTable, BodyConstants]:
    """The bank's movable objects on the host and on the device; one row of zeros where there is none."""
    table = body_table(bank, sizes.hulls)
    columns = {}
    for name, array in table._asdict().items():
        padded = array if len(array) else np.zeros((1, *array.shape[1:]), array.dtype)
        columns[name] = jnp.asarray(padded, jnp.int32 if array.dtype.kind == "i" else jnp.float32)
    return table, BodyConstants(**columns)


def begin(table: BodyConstants, scene: Any, objects: Any) -> Bodies:
    """Objects (M,) i32 of a scene at rest where the bank has them; what cannot be a body becomes -1."""
    known = table.row[scene, jnp.maximum(objects, 0)]
    there = (objects >= 0) & (known >= 0)
    row, zero = jnp.maximum(known, 0), jnp.zeros((objects.shape[0], 3))
    quaternion = rotations.unit(table.home_quaternion[row])
    one = jnp.array([1.0, 0.0, 0.0, 0.0])
    return Bodies(
        jnp.where(there, objects, -1).astype(jnp.int32),
        jnp.where(there[:, None], table.home[row], 0.0),
        jnp.where(there[:, None], quaternion, one),
        zero,
        zero,
        jnp.zeros((objects.shape[0], 6)),
    )


def rows(table: BodyConstants, scene: Any, bodies: Bodies) -> Any:
    """(M,) i32 rows of the body table, -1 = none."""
    return jnp.where(bodies.object_index >= 0, table.row[scene, jnp.maximum(bodies.object_index, 0)], -1)


def centres(table: BodyConstants, row: Any, position: Any, quaternion: Any) -> Any:
    """(n, 3) m, centres of mass of bodies (n,) whose objects stand at T_world_object."""
    local = table.centre[table.shape[jnp.maximum(row, 0)]]
    return position + jnp.einsum("nij,nj->ni", rotations.matrix(quaternion), local)


def wake(table: BodyConstants, scene: Any, bodies: Bodies, robot: Any, reach: float, number: int) -> Any:
    """Selects the bodies that are simulated in this control step.

    Args:
      robot: (3,) m.
      reach: m around it within which it may touch something.

    Returns:
      slots (W,) i32 of `bodies`, the `Awake` in them, and () i32, how many should move and may not.
    """
    row = rows(table, scene, bodies)
    there = row >= 0
    radius = table.radius[table.shape[jnp.maximum(row, 0)]]
    place = centres(table, row, bodies.position, bodies.quaternion)
    far = jnp.linalg.norm(place - robot, axis=-1) - radius
    moving = jnp.linalg.norm(bodies.velocity, axis=-1) > REST_SPEED
    moving = there & (moving | (jnp.linalg.norm(bodies.spin, axis=-1) > REST_SPIN))
    gap = jnp.linalg.norm(place[:, None] - place, axis=-1) - radius[:, None] - radius
    beside = jnp.any((gap < _WAKE_DISTANCE) & moving, axis=1)
    wanted = there & (moving | beside | (far < reach))
    # Bodies in motion have priority.
    order = jnp.where(wanted, jnp.where(moving, far - 1e3, far), jnp.inf)
    negative, slot = jax.lax.top_k(-order, number)
    chosen = jnp.isfinite(negative)
    awake = Awake(
        jnp.where(chosen, row[slot], -1),
        jnp.where(chosen, bodies.object_index[slot], -1),
        *(x[slot] for x in (place, bodies.quaternion, bodies.velocity, bodies.spin, bodies.warm)),
    )
    return slot, awake, jnp.maximum(wanted.sum() - number, 0).astype(jnp.int32)


def reach(table: BodyConstants, awake: Awake, control_dt: float) -> Any:
    """(W,) m around the bodies' centres of mass within which they may touch something in a control step."""
    return table.radius[table.shape[jnp.maximum(awake.row, 0)]] + MAX_BODY_SPEED * control_dt


def put_back(table: BodyConstants, bodies: Bodies, slot: Any, awake: Awake) -> Bodies:
    """Writes the states of simulated bodies back; sleeping bodies are at rest."""
    fine = jnp.isfinite(jnp.concatenate([*awake[2:]], axis=-1)).all(-1)
    # Bodies with non-finite states keep their previous pose.
    kept = (awake.row >= 0) & fine
    local = table.centre[table.shape[jnp.maximum(awake.row, 0)]]
    position = awake.place - jnp.einsum("nij,nj->ni", rotations.matrix(awake.quaternion), local)
    new = (position, awake.quaternion, awake.velocity, awake.spin, awake.warm)
    # A moving body without a slot keeps its velocity and continues later.
    moving = jnp.linalg.norm(bodies.velocity, axis=-1) > REST_SPEED
    moving |= jnp.linalg.norm(bodies.spin, axis=-1) > REST_SPIN
    old = [*bodies[1:3], *(jnp.where(moving[:, None], x, 0.0) for x in bodies[3:])]
    done = [o.at[slot].set(jnp.where(kept[:, None], n, o[slot])) for o, n in zip(old, new, strict=True)]
    return Bodies(bodies.object_index, *done)
