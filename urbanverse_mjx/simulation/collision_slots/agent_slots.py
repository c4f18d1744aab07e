"""Agent slots: contacts of the robot's spheres with moving people and vehicles.

In:   `AgentShapes` once; `AgentMotion` every control step; sphere centres.
Out:  `SphereContacts` beside those with hulls.
When: every physics step, per env, inside jit.

Agents are kinematic (mocap bodies in MuJoCo's terms): the crowd moves them, and contacts use their poses, not their
velocities. Their shape is an upright prism over a disc swept along the heading, whose distance to a sphere has a closed
form.
"""

from typing import Any

import jax
import jax.numpy as jnp

from ...datatypes import AgentMotion, AgentShapes
from .hull_contact import SphereContacts
from .static_slots import Slots

#: Owner of the first agent in `Slots.owner`; that of agent a is `FIRST_OWNER - a` (objects from 0 on, the ground -1).
FIRST_OWNER = -2
#: MuJoCo's default for geoms, which the reference's cylinders have.
FRICTION = 1.0
#: m from the axis below which the direction of the contact is undefined.
_AXIS_TOLERANCE = 1e-6


def moved(motion: AgentMotion, time: Any) -> AgentMotion:
    """The agents () s later."""
    return motion._replace(
        position=motion.position + time * motion.velocity, heading=motion.heading + time * motion.turn_rate
    )


def prism_distance(offset: Any, heading: Any, shapes: AgentShapes) -> tuple[Any, Any]:
    """Distance (S, A) m from points to prisms and the unit directions (S, A, 3) from there; negative inside.

    Args:
      offset: (S, A, 3) m, from the middles of the prisms' floors to the points, world frame.
      heading: (A,) rad.
    """
    radius, half, height = (jnp.asarray(a, jnp.float32) for a in shapes)
    cos, sin = jnp.cos(heading), jnp.sin(heading)
    along = jnp.clip(cos * offset[..., 0] + sin * offset[..., 1], -half, half)
    x, y = offset[..., 0] - along * cos, offset[..., 1] - along * sin
    rho = jnp.sqrt(x * x + y * y)
    # On the axis, the normal is to the left.
    near = rho < _AXIS_TOLERANCE
    x, y = (jnp.where(near, b, a / jnp.maximum(rho, _AXIS_TOLERANCE)) for a, b in ((x, -sin), (y, cos)))
    up = jnp.where(offset[..., 2] > 0.5 * height, 1.0, -1.0)
    aside = rho - radius
    above = jnp.abs(offset[..., 2] - 0.5 * height) - 0.5 * height
    corner = jnp.sqrt(jnp.maximum(aside, 0.0) ** 2 + jnp.maximum(above, 0.0) ** 2)
    distance = corner + jnp.minimum(jnp.maximum(aside, above), 0.0)
    outside = (aside > 0.0) & (above > 0.0)
    wide = jnp.where(outside, aside / jnp.maximum(corner, _AXIS_TOLERANCE), jnp.where(aside > above, 1.0, 0.0))
    high = jnp.where(outside, above / jnp.maximum(corner, _AXIS_TOLERANCE), jnp.where(aside > above, 0.0, 1.0))
    return distance, jnp.stack([wide * x, wide * y, high * up], -1)


def with_agents(
    found: SphereContacts,
    centres: Any,
    radii: Any,
    motion: AgentMotion,
    shapes: AgentShapes,
    nearby: Slots,
    max_contacts: int,
) -> tuple[SphereContacts, Slots]:
    """Appends contacts and slots of agents; at most `max_contacts` spheres touch an agent at once.

    Args:
      found: with the hulls in `nearby`.
      centres: (S, 3) m, radii: (S,) m.
      motion: at this physics step.
    """
    offset = centres[:, None] - motion.position
    gap, normal = prism_distance(offset, motion.heading, shapes)
    gap = jnp.where(motion.present, gap - radii[:, None], jnp.inf)
    agents = gap.shape[1]
    negative, pair = jax.lax.top_k(-gap.ravel(), max_contacts)
    sphere, agent = pair // agents, pair % agents
    normal = normal.reshape(-1, 3)[pair]
    # As with hulls, half-way between the surfaces.
    touch = jnp.where(negative > 0.0, radii[sphere] - 0.5 * negative, radii[sphere])
    number = nearby.hull.shape[0]
    theirs = SphereContacts(
        sphere=sphere,
        slot=number + agent,
        distance=-negative,
        normal=normal,
        position=centres[sphere] - normal * touch[:, None],
        missed=jnp.maximum(jnp.sum(gap < 0.0) - max_contacts, 0).astype(jnp.int32),
    )
    both = [jnp.concatenate([a, b]) for a, b in zip(found[:-1], theirs[:-1], strict=True)]
    place = jnp.broadcast_to(jnp.eye(3), (agents, 3, 3))
    slots = Slots(
        hull=jnp.zeros(agents, jnp.int32),
        owner=FIRST_OWNER - jnp.arange(agents, dtype=jnp.int32),
        valid=motion.present,
        position=motion.position,
        rotation=place,
        friction=jnp.full(agents, FRICTION),
    )
    joined = Slots(*(jnp.concatenate([a, b]) for a, b in zip(nearby, slots, strict=True)))
    return SphereContacts(*both, missed=found.missed + theirs.missed), joined


def noted(touch: Any, met: Any, owner: Any, force: Any) -> Any:
    """The sums of a control step (fields agent, agent_force) with the touches of one physics step.

    Args:
      met: (n,) bool, contacts with an agent.
      owner: (n,) i32, see `FIRST_OWNER`.
      force: (n,) N.
    """
    strength = jnp.where(met, force, -1.0)
    best = jnp.argmax(strength)
    stronger = met.any() & ((strength[best] > touch.agent_force) | (touch.agent < 0))
    return touch._replace(
        agent=jnp.where(stronger, FIRST_OWNER - owner[best], touch.agent),
        agent_force=jnp.maximum(touch.agent_force, strength[best]),
    )
