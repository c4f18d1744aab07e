"""Limits the speed of vehicles so that they can stop for obstacles in their lane.

In:   preferred velocities, bodies.
Out:  preferred velocities.
When: every crowd step, before `orca`, inside jit.

A half-plane may require only a lateral velocity, which wheeled bodies cannot execute; braking then has no benefit in
`orca`. Without this module, a car may drive into another one that turns across its lane without braking.
"""

import jax.numpy as jnp

from .bodies import Bodies, PreferredVelocity, Traits

#: m between a standing vehicle and its obstacle.
BUMPER_DISTANCE = 0.4


def stop_in_time(
    preferred_velocity: PreferredVelocity, bodies: Bodies, traits: Traits, first: int
) -> PreferredVelocity:
    """Preferred velocities (A,); those of vehicles (agents from `first`) are limited to the speed from which they can
    stop.

    A vehicle may follow another one at that one's speed. Obstacles behind a vehicle are not checked.

    Args:
      bodies, traits: (B,), the agents, followed by other bodies.
    """
    agents = preferred_velocity.x.shape[0]
    if first == agents:
        return preferred_velocity
    own = slice(first, agents)
    heading = bodies.heading[own, None]
    cos, sin = jnp.cos(heading), jnp.sin(heading)
    others = traits.present & (jnp.arange(len(bodies.x)) != jnp.arange(first, agents)[:, None])
    reach = traits.radius[own, None] + traits.radius
    ahead = jnp.maximum(bodies.vx * cos + bodies.vy * sin, 0.0)
    most = jnp.full(agents - first, jnp.inf)
    for end in (-1.0, 0.0, 1.0):
        dx = bodies.x + end * traits.half_length * jnp.cos(bodies.heading) - bodies.x[own, None]
        dy = bodies.y + end * traits.half_length * jnp.sin(bodies.heading) - bodies.y[own, None]
        along = dx * cos + dy * sin - traits.half_length[own, None]
        in_lane = others & (along > 0.0) & (jnp.abs(dy * cos - dx * sin) < reach)
        gap = jnp.maximum(along - reach - BUMPER_DISTANCE, 0.0)
        safe = jnp.sqrt(2.0 * traits.braking[own, None] * gap) + ahead
        most = jnp.minimum(most, jnp.where(in_lane, safe, jnp.inf).min(-1))
    x, y = preferred_velocity.x[own], preferred_velocity.y[own]
    forwards = x * cos[:, 0] + y * sin[:, 0] > 0.0
    part = jnp.where(forwards, jnp.minimum(1.0, most / jnp.maximum(jnp.sqrt(x * x + y * y), 1e-6)), 1.0)
    return preferred_velocity._replace(
        x=preferred_velocity.x.at[own].multiply(part), y=preferred_velocity.y.at[own].multiply(part)
    )
