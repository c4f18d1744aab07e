"""From the permitted velocities to a motion that legs or wheels can make.

In:   half-planes, wishes, the present motion and the limits of each body.
Out:  velocities of walkers; accelerations and turn rates of vehicles.
When: every crowd step, inside jit.

Walkers take the velocity of the published program, no farther from the present one than their legs allow.

Vehicles choose among controls they can execute: a fan of accelerations and turn rates, each judged by the mean velocity
of the arc it makes, against the same half-planes. That is the choice of controls of Wilkie, van den Berg and Manocha
("Generalized Velocity Obstacles", 2009) on the half-planes of ORCA. The other published way, NH-ORCA and B-ORCA
(Alonso-Mora et al. 2010 and 2012), solves the program for a disc grown by a tracking error and then tracks the
result; its bound is worked out per robot for a fixed range of speeds, and a car at 8 m/s that may track nothing but
what lies within centimetres of its lane has no velocity left there. Judging what can be driven needs no such bound:
where the wheels go is what was judged, and the only error is that an arc counts as its chord (`_LOOK`).
"""

from typing import Any

import jax.numpy as jnp
import numpy as np

from .bodies import Bodies, Traits
from .linear_program import HalfPlanes

#: s, length of the arcs that are judged; the chord of 1 s at the largest lateral acceleration (2.5 m/s²) lies at most
#: 2.5 / 8 = 0.31 m beside the arc at its middle, and the step that follows uses a tenth or fifth of it.
_LOOK = 1.0
#: Turn rates that are tried, as shares of the largest.
_TURNS = (-1.0, -0.6, -0.3, -0.12, 0.0, 0.12, 0.3, 0.6, 1.0)
#: Accelerations that are tried: shares of the braking (negative) and of the acceleration (positive).
_PUSHES = (-1.0, -0.5, -0.2, 0.0, 1.0)
#: Cost of one m/s of violation in m/s off the wish: others, and walls, which are never traded for anything.
_NEIGHBOUR_COST, _WALL_COST = 8.0, 40.0
#: m/s, speed below which a walker does not turn to where it goes.
_SHUFFLE = 0.35
#: Cost of the largest turn rate and of full braking, m²/s²: ties go to the calmer control.
_CALM = 0.02


def walk(chosen: tuple[Any, Any], bodies: Bodies, traits: Traits, walls: HalfPlanes, dt: float) -> tuple[Any, Any]:
    """Velocities of walkers after one step, m/s: towards the chosen ones, as fast as legs allow.

    Where keeping to that would run into a wall within two steps, it is given up: one stops against a wall.

    Args:
      chosen: (A, E) m/s. bodies, traits: (A, E). walls: (M, A, E), which `chosen` keeps. dt: s.
    """
    dx, dy = chosen[0] - bodies.vx, chosen[1] - bodies.vy
    change = jnp.sqrt(dx * dx + dy * dy)
    part = jnp.minimum(1.0, traits.acceleration * dt / jnp.maximum(change, 1e-6))
    # Offsets are (minus the free space) / horizon; within two steps they are this much wider.
    sooner = traits.wall_horizon / jnp.minimum(2.0 * dt, traits.wall_horizon)
    now = walls.offset * sooner - walls.x * bodies.vx - walls.y * bodies.vy
    gain = walls.x * dx + walls.y * dy
    needed = jnp.where((now > 0.0) & (gain > 1e-6), now / jnp.maximum(gain, 1e-6), 0.0)
    part = jnp.clip(jnp.maximum(part, jnp.max(needed, axis=0, initial=0.0)), 0.0, 1.0)
    return bodies.vx + part * dx, bodies.vy + part * dy


def step_on(velocity: tuple[Any, Any], face: Any, bodies: Bodies, traits: Traits, dt: float) -> Bodies:
    """Walkers after a step with a velocity (m/s); they look where they go, and where they want to when they stand.

    Args:
      velocity, face: (A, E) m/s and rad. bodies, traits: (A, E). dt: s.
    """
    vx, vy = velocity
    speed = jnp.sqrt(vx * vx + vy * vy)
    # Below a slow shuffle one steps aside or back without turning.
    going = speed > _SHUFFLE
    turn = wrapped(jnp.where(going, jnp.arctan2(vy, vx), face) - bodies.heading)
    most = traits.turn_rate * dt * jnp.where(going, jnp.minimum(speed, 1.0), 0.5)
    heading = wrapped(bodies.heading + jnp.clip(turn, -most, most))
    return Bodies(bodies.x + vx * dt, bodies.y + vy * dt, vx, vy, heading)


def wrapped(angle: Any) -> Any:
    """The same angle in [-π, π)."""
    return jnp.mod(angle + jnp.pi, 2.0 * jnp.pi) - jnp.pi


def _mean_speed(speed: Any, push: Any, limit: Any, time: float) -> Any:
    """Mean over `time` s of a speed that changes at `push` m/s² until it reaches 0 or the limit."""
    end = jnp.clip(speed + push * time, 0.0, jnp.maximum(limit, speed))
    moving = jnp.abs(push) > 1e-6
    ramp = jnp.where(moving, (end - speed) / jnp.where(moving, push, 1.0), 0.0) / time
    return 0.5 * (speed + end) * ramp + end * (1.0 - ramp)


def turn_limit(speed: Any, traits: Traits) -> Any:
    """rad/s, how fast a vehicle can turn at a speed: its steering, its tyres, its motor."""
    steering = jnp.where(traits.turn_radius > 0.0, speed / jnp.maximum(traits.turn_radius, 1e-6), jnp.inf)
    return jnp.minimum(jnp.minimum(steering, traits.lateral / jnp.maximum(speed, 1e-3)), traits.turn_rate)


def drive(lines: HalfPlanes, num_hard: int, wish: tuple[Any, Any], bodies: Bodies, traits: Traits) -> tuple[Any, Any]:
    """The best control of each vehicle.

    Args:
      lines: (N, A, E), the first `num_hard` towards walls. wish: (A, E) m/s. bodies, traits: (A, E).

    Returns:
      (A, E) acceleration m/s² and turn rate rad/s.
    """
    cos, sin = jnp.cos(bodies.heading), jnp.sin(bodies.heading)
    speed = jnp.maximum(bodies.vx * cos + bodies.vy * sin, 0.0)
    ahead, left = wish[0] * cos + wish[1] * sin, wish[1] * cos - wish[0] * sin
    wished = jnp.sqrt(ahead * ahead + left * left)
    error = jnp.where(wished > 1e-3, jnp.arctan2(left, ahead), 0.0)
    # What the wish itself asks for stands among the controls: an arc whose chord points along it.
    own_push = jnp.clip(wished * jnp.maximum(jnp.cos(error), 0.0) - speed, -traits.braking, traits.acceleration)
    pushes = jnp.stack([*(s * (traits.acceleration if s > 0 else traits.braking) for s in _PUSHES), own_push])
    mean = _mean_speed(speed, pushes, traits.limit, _LOOK)
    # The least radius bounds the arc at its mean speed, so that a vehicle at rest may pull out in a curve.
    most = turn_limit(mean, traits)
    shares = jnp.asarray(np.array(_TURNS, np.float32)).reshape(-1, 1, 1, 1)
    own_turn = jnp.clip(2.0 * error / _LOOK, -most, most)
    turns = jnp.concatenate([shares * most, own_turn[None]])
    half = 0.5 * turns * _LOOK
    chord = mean * jnp.sinc(half / jnp.pi)
    turned_cos, turned_sin = jnp.cos(half), jnp.sin(half)
    ux, uy = chord * (turned_cos * cos - turned_sin * sin), chord * (turned_sin * cos + turned_cos * sin)
    hard, soft = jnp.zeros_like(ux), jnp.zeros_like(ux)
    for n in range(lines.offset.shape[0]):
        depth = lines.offset[n] - lines.x[n] * ux - lines.y[n] * uy
        hard, soft = (jnp.maximum(hard, depth), soft) if n < num_hard else (hard, jnp.maximum(soft, depth))
    effort = jnp.abs(turns) / traits.turn_rate + jnp.abs(pushes / traits.braking)
    cost = (ux - wish[0]) ** 2 + (uy - wish[1]) ** 2 + _CALM * effort
    cost += _NEIGHBOUR_COST * soft * (1.0 + soft) + _WALL_COST * hard * (1.0 + hard)
    shape = cost.shape
    flat = cost.reshape(shape[0] * shape[1], *shape[2:])
    best = jnp.argmin(flat, axis=0)[None]
    turn = jnp.take_along_axis(turns.reshape(flat.shape), best, axis=0)[0]
    push = jnp.take_along_axis(jnp.broadcast_to(pushes, shape).reshape(flat.shape), best, axis=0)[0]
    return push, turn


def roll(push: Any, turn: Any, bodies: Bodies, traits: Traits, dt: float) -> Bodies:
    """Vehicles after one step of an acceleration (m/s²) and a turn rate (rad/s), all (A, E)."""
    cos, sin = jnp.cos(bodies.heading), jnp.sin(bodies.heading)
    speed = jnp.maximum(bodies.vx * cos + bodies.vy * sin, 0.0)
    mean = _mean_speed(speed, push, traits.limit, dt)
    end = jnp.clip(speed + push * dt, 0.0, jnp.maximum(traits.limit, speed))
    most = turn_limit(mean, traits)
    half = 0.5 * jnp.clip(turn, -most, most) * dt
    middle, heading = bodies.heading + half, bodies.heading + 2.0 * half
    way = mean * dt * jnp.sinc(half / jnp.pi)
    return Bodies(
        x=bodies.x + way * jnp.cos(middle),
        y=bodies.y + way * jnp.sin(middle),
        vx=end * jnp.cos(heading),
        vy=end * jnp.sin(heading),
        heading=wrapped(heading),
    )
