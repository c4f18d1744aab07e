"""Converts permitted velocities to motions that pedestrians and vehicles can execute.

In: half-planes, preferred velocities, the current motion and the limits of each body. Out:  velocities of walkers;
accelerations and turn rates of vehicles. When: every crowd step, inside jit.

Pedestrians use the velocity of the published program within their limits of acceleration. Vehicles choose among
executable controls: a grid of accelerations and turn rates, each evaluated against the same half-planes by the mean
velocity of its arc. This is the choice of controls of Wilkie, van den Berg and Manocha ("Generalized Velocity
Obstacles", 2009) on the half-planes of ORCA. The alternatives NH-ORCA and B-ORCA (Alonso-Mora et al. 2010 and 2012)
solve the program for a disc enlarged by a tracking error and then track the result; for a car at 8 m/s, whose tracking
error may only be some centimetres, no velocity remains. Evaluating executable controls needs no such bound; its only
error is that an arc is represented by its chord (`horizon`).
"""

import dataclasses
from typing import Any

import jax.numpy as jnp
import numpy as np

from .bodies import Bodies, PreferredVelocity, Traits
from .linear_program import HalfPlanes


@dataclasses.dataclass(frozen=True)
class MotionOptions:
    """Sampled controls of a vehicle, and their costs; chosen manually.

    A deviation of one m/s from the preferred velocity costs at most twice the speed (17 m²/s² for a car), so that
    priorities are walls, then other bodies, then the preferred velocity.

    Attributes:
      horizon: s, length of the evaluated arcs. The chord of 1 s at the largest lateral acceleration (2.5 m/s²) is at
        most 2.5 / 8 = 0.31 m from the arc, and a step uses a tenth or fifth of it.
      turn_shares: candidate turn rates as shares of the largest.
      acceleration_shares: candidate accelerations as shares of the braking (negative) and of the acceleration
        (positive).
      neighbour_cost: m²/s², cost of one m/s of violation of a neighbour's half-plane.
      wall_cost: m²/s², cost of one m/s of violation of a wall's half-plane.
      min_turn_speed: m/s, speed below which a pedestrian does not turn to its direction of motion.
      effort_cost: m²/s², cost of the largest turn rate and of full braking, so that ties are resolved in favour of the
        smaller control.
      heading_weight: weight of the vehicle's final heading.
    """

    horizon: float = 1.0
    turn_shares: tuple[float, ...] = (-1.0, -0.6, -0.3, -0.12, 0.0, 0.12, 0.3, 0.6, 1.0)
    acceleration_shares: tuple[float, ...] = (-1.0, -0.5, -0.2, 0.0, 1.0)
    neighbour_cost: float = 100.0
    wall_cost: float = 400.0
    min_turn_speed: float = 0.35
    effort_cost: float = 0.02
    heading_weight: float = 0.2


_OPTIONS = MotionOptions()


def walk(chosen: tuple[Any, Any], bodies: Bodies, traits: Traits, walls: HalfPlanes, dt: float) -> tuple[Any, Any]:
    """Velocities of pedestrians after one step, m/s: towards the chosen ones within the limits of acceleration.

    The limits are ignored if they would lead into a wall within two steps, so that pedestrians stop at walls.

    Args:
      chosen: (A, E) m/s.
      bodies, traits: (A, E). walls: (M, A, E), with which `chosen` complies.
      dt: s.
    """
    dx, dy = chosen[0] - bodies.vx, chosen[1] - bodies.vy
    change = jnp.sqrt(dx * dx + dy * dy)
    # The limit is that of braking for slowing down and turning, and that of acceleration for speeding up.
    gains = chosen[0] * chosen[0] + chosen[1] * chosen[1] > bodies.vx * bodies.vx + bodies.vy * bodies.vy
    along = dx * bodies.vx + dy * bodies.vy > 0.0
    push = jnp.where(gains & along, traits.acceleration, traits.braking)
    part = jnp.minimum(1.0, push * dt / jnp.maximum(change, 1e-6))
    # Offsets are (minus the free space) / horizon; for two steps they are larger by this factor.
    sooner = traits.wall_horizon / jnp.minimum(2.0 * dt, traits.wall_horizon)
    now = walls.offset * sooner - walls.x * bodies.vx - walls.y * bodies.vy
    gain = walls.x * dx + walls.y * dy
    needed = jnp.where((now > 0.0) & (gain > 1e-6), now / jnp.maximum(gain, 1e-6), 0.0)
    part = jnp.clip(jnp.maximum(part, jnp.max(needed, axis=0, initial=0.0)), 0.0, 1.0)
    return bodies.vx + part * dx, bodies.vy + part * dy


def step_on(velocity: tuple[Any, Any], face: Any, bodies: Bodies, traits: Traits, dt: float) -> Bodies:
    """Pedestrians after a step with a velocity (m/s); they face their direction of motion, or their desired heading
    when they stand.

    Args:
      velocity, face: (A, E) m/s and rad.
      bodies, traits: (A, E).
      dt: s.
    """
    vx, vy = velocity
    speed = jnp.sqrt(vx * vx + vy * vy)
    # Slow side and back steps do not change the heading.
    going = speed > _OPTIONS.min_turn_speed
    turn = wrapped(jnp.where(going, jnp.arctan2(vy, vx), face) - bodies.heading)
    most = traits.turn_rate * dt * jnp.where(going, jnp.minimum(speed, 1.0), 0.5)
    heading = wrapped(bodies.heading + jnp.clip(turn, -most, most))
    return Bodies(bodies.x + vx * dt, bodies.y + vy * dt, vx, vy, heading)


def wrapped(angle: Any) -> Any:
    """The same angle in [-π, π)."""
    return jnp.mod(angle + jnp.pi, 2.0 * jnp.pi) - jnp.pi


def _speeds(speed: Any, push: Any, low: Any, limit: Any, time: float) -> tuple[Any, Any]:
    """Mean over `time` s of a speed that changes at `push` m/s² until it reaches a limit, and the final speed."""
    end = jnp.clip(speed + push * time, jnp.minimum(low, speed), jnp.maximum(limit, speed))
    moving = jnp.abs(push) > 1e-6
    ramp = jnp.where(moving, (end - speed) / jnp.where(moving, push, 1.0), 0.0) / time
    return 0.5 * (speed + end) * ramp + end * (1.0 - ramp), end


def backs_up(preferred_velocity: PreferredVelocity) -> Any:
    """Whether a vehicle drives backwards, because its preferred velocity points away from its heading."""
    forward = preferred_velocity.x * jnp.cos(preferred_velocity.face) + preferred_velocity.y * jnp.sin(
        preferred_velocity.face
    )
    return forward * jnp.abs(forward) < -0.5 * (
        preferred_velocity.x * preferred_velocity.x + preferred_velocity.y * preferred_velocity.y
    )


def turn_limit(speed: Any, traits: Traits) -> Any:
    """rad/s, largest turn rate of a vehicle at a speed (m/s)."""
    speed = jnp.abs(speed)
    steering = jnp.maximum(speed / traits.turn_radius, traits.pivot)
    return jnp.minimum(jnp.minimum(steering, traits.lateral / jnp.maximum(speed, 1e-3)), traits.turn_rate)


def drive(
    lines: HalfPlanes,
    place: Any,
    walls: tuple[HalfPlanes, HalfPlanes],
    preferred_velocity: PreferredVelocity,
    bodies: Bodies,
    traits: Traits,
) -> tuple[Any, Any]:
    """Selects the best control of each vehicle.

    Args:
      lines: (K, A, E) half-planes of neighbours.
      place: (K, A, E), position on the vehicle's axis that is nearest to each neighbour.
      walls: (M, A, E) each, for the front and the rear disc of its capsule.
      preferred_velocity, bodies, traits: (A, E).

    Returns:
      (A, E) acceleration m/s² and turn rate rad/s.
    """
    cos, sin = jnp.cos(bodies.heading), jnp.sin(bodies.heading)
    speed = bodies.vx * cos + bodies.vy * sin
    ahead, left = (
        preferred_velocity.x * cos + preferred_velocity.y * sin,
        preferred_velocity.y * cos - preferred_velocity.x * sin,
    )
    preferred_speed = jnp.sqrt(ahead * ahead + left * left)
    back = backs_up(preferred_velocity)
    error = jnp.where(
        preferred_speed > 1e-3,
        jnp.where(back, wrapped(preferred_velocity.face - bodies.heading), jnp.arctan2(left, ahead)),
        0.0,
    )
    # The candidates include the control for the preferred velocity: an arc whose chord points along it.
    own_speed = jnp.where(back, -preferred_speed, preferred_speed * jnp.maximum(jnp.cos(error), 0.0))
    own_push = jnp.clip(own_speed - speed, -traits.braking, traits.acceleration)
    pushes = jnp.stack(
        [*(s * (traits.acceleration if s > 0 else traits.braking) for s in _OPTIONS.acceleration_shares), own_push]
    )
    mean, _ = _speeds(speed, pushes, jnp.where(back, -preferred_speed, 0.0), traits.limit, _OPTIONS.horizon)
    # The least radius limits the arc at its mean speed, so that a vehicle at rest may start in a curve.
    most = turn_limit(mean, traits)
    shares = jnp.asarray(np.array(_OPTIONS.turn_shares, np.float32)).reshape(-1, 1, 1, 1)
    own_turn = jnp.clip(2.0 * error / _OPTIONS.horizon, -most, most)
    turns = jnp.concatenate([shares * most, own_turn[None]])
    pushes = jnp.broadcast_to(pushes, turns.shape)
    half = 0.5 * turns * _OPTIONS.horizon
    chord = mean * jnp.sinc(half / jnp.pi)
    # In the vehicle's frame: the displacement of its centre, and that of its ends relative to the centre.
    along, across = chord * jnp.cos(half), chord * jnp.sin(half)
    swing_along = traits.half_length / _OPTIONS.horizon * (jnp.cos(2.0 * half) - 1.0)
    swing_across = traits.half_length / _OPTIONS.horizon * jnp.sin(2.0 * half)

    def deepest(rows: HalfPlanes, ends: Any) -> Any:
        worst = jnp.zeros_like(along)
        for n in range(rows.offset.shape[0]):
            # The normal in the vehicle's frame, and the velocity of the point to which the line refers.
            nx, ny = rows.x[n] * cos + rows.y[n] * sin, rows.y[n] * cos - rows.x[n] * sin
            u, w = along + ends[n] * swing_along, across + ends[n] * swing_across
            worst = jnp.maximum(worst, rows.offset[n] - nx * u - ny * w)
        return worst

    flats = walls[0].offset.shape[0]
    hard = jnp.maximum(deepest(walls[0], [1.0] * flats), deepest(walls[1], [-1.0] * flats))
    soft = deepest(lines, place)
    effort = jnp.abs(turns) / traits.turn_rate + jnp.abs(pushes / traits.braking)
    # A vehicle that cannot follow its preferred velocity yet still turns towards it.
    aim = preferred_speed * preferred_speed * (1.0 - jnp.cos(error - 2.0 * half))
    cost = (along - ahead) ** 2 + (across - left) ** 2 + _OPTIONS.effort_cost * effort + _OPTIONS.heading_weight * aim
    cost += _OPTIONS.neighbour_cost * soft + _OPTIONS.wall_cost * hard
    flat = cost.reshape(-1, *cost.shape[2:])
    best = jnp.argmin(flat, axis=0)[None]
    turn = jnp.take_along_axis(turns.reshape(flat.shape), best, axis=0)[0]
    push = jnp.take_along_axis(pushes.reshape(flat.shape), best, axis=0)[0]
    return push, turn


def roll(
    push: Any, turn: Any, preferred_velocity: PreferredVelocity, bodies: Bodies, traits: Traits, dt: float
) -> Bodies:
    """Vehicles after one step with an acceleration (m/s²) and a turn rate (rad/s), all (A, E)."""
    cos, sin = jnp.cos(bodies.heading), jnp.sin(bodies.heading)
    speed = bodies.vx * cos + bodies.vy * sin
    preferred_speed = jnp.sqrt(
        preferred_velocity.x * preferred_velocity.x + preferred_velocity.y * preferred_velocity.y
    )
    mean, end = _speeds(speed, push, jnp.where(backs_up(preferred_velocity), -preferred_speed, 0.0), traits.limit, dt)
    most = turn_limit(mean, traits)
    half = 0.5 * jnp.clip(turn, -most, most) * dt
    middle, heading = bodies.heading + half, bodies.heading + 2.0 * half
    step = mean * dt * jnp.sinc(half / jnp.pi)
    return Bodies(
        x=bodies.x + step * jnp.cos(middle),
        y=bodies.y + step * jnp.sin(middle),
        vx=end * jnp.cos(heading),
        vy=end * jnp.sin(heading),
        heading=wrapped(heading),
    )
