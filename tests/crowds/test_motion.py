"""Vehicles roll along the arcs of a bicycle, and routes are looked up between their nodes, against closed forms."""

import math

import jax.numpy as jnp
import numpy as np
import pytest

from urbanverse_mjx.crowds import KINDS, Bodies, goal_fields, motion, traits_of
from urbanverse_mjx.crowds.bodies import PreferredVelocity


def rolling(heading: float, speed: float) -> Bodies:
    f = lambda x: jnp.full((1, 1), x, jnp.float32)  # noqa: E731
    return Bodies(f(2.0), f(-1.0), f(speed * math.cos(heading)), f(speed * math.sin(heading)), f(heading))


def to(x: float, y: float, face: float) -> PreferredVelocity:
    return PreferredVelocity(*(jnp.full((1, 1), v, jnp.float32) for v in (x, y, face)))


@pytest.mark.parametrize("turn", [0.3, -0.2, 0.0])
def test_a_vehicle_rolls_along_its_arc(turn: float) -> None:
    heading, speed, dt = 0.7, 6.0, 0.5
    bodies, traits = rolling(heading, speed), traits_of([KINDS["car"]])
    preferred_velocity = to(speed * math.cos(heading), speed * math.sin(heading), heading)
    after = motion.roll(jnp.zeros((1, 1)), jnp.full((1, 1), turn), preferred_velocity, bodies, traits, dt)
    angles = heading + turn * np.linspace(0.0, dt, 20_001)
    offset = speed * dt * np.array([np.cos(angles).mean(), np.sin(angles).mean()])
    np.testing.assert_allclose([after.x[0, 0] - 2.0, after.y[0, 0] + 1.0], offset, atol=1e-4)
    assert float(after.heading[0, 0]) == pytest.approx(heading + turn * dt, abs=1e-5)
    assert float(jnp.arctan2(after.vy, after.vx)[0, 0]) == pytest.approx(heading + turn * dt, abs=1e-5)


def test_a_vehicle_backs_up_as_fast_as_it_wants_in_any_direction() -> None:
    traits = traits_of([KINDS["car"]])
    for heading in (0.0, math.pi / 2, 2.4):
        preferred_velocity = to(-0.8 * math.cos(heading), -0.8 * math.sin(heading), heading)
        bodies = rolling(heading, -0.7)
        for _ in range(5):
            bodies = motion.roll(jnp.full((1, 1), -1.0), jnp.zeros((1, 1)), preferred_velocity, bodies, traits, 0.2)
        speed = bodies.vx * math.cos(heading) + bodies.vy * math.sin(heading)
        assert float(speed[0, 0]) == pytest.approx(-0.8, abs=1e-4)


def test_directions_are_interpolated_between_the_nodes_of_a_route() -> None:
    """Also before the first and behind the last node, and straight to the goal near it."""
    turns = np.array([[0, 16, 32], [48, 64, 80], [96, 112, 128], [10, 20, 30]], np.uint8)
    routes = goal_fields.GoalRoutes(
        direction=jnp.asarray(turns[None, None]),
        origin=jnp.array([[5.0, -3.0]]),
        goal=jnp.array([[[50.0, 40.0]]]),
        num_goals=jnp.array([1]),
        place=jnp.zeros((1, 1, 2)),
        place_goal=jnp.zeros((1, 1), jnp.int32),
    )
    node, unit = 0.5, 2.0 * np.pi / 256

    def found(x: float, y: float) -> float:
        at = jnp.array([x], jnp.float32), jnp.array([y], jnp.float32)
        return float(goal_fields.heading_at(routes, node, 0, jnp.zeros(1, jnp.int32), *at)[0])

    for i in range(4):
        for j in range(3):
            x, y = 5.0 + (i + 0.5) * node, -3.0 + (j + 0.5) * node
            assert np.cos(found(x, y) - turns[i, j] * unit) == pytest.approx(1.0, abs=1e-5), (i, j)
    middle = found(5.0 + 1.0 * node, -3.0 + 1.0 * node)
    around = np.exp(1j * unit * turns[:2, :2].astype(float)).sum()
    assert middle == pytest.approx(np.angle(around), abs=1e-4)
    assert np.cos(found(1.0, -2.75) - turns[0, 0] * unit) == pytest.approx(1.0, abs=1e-5)
    assert np.cos(found(60.0, -1.75) - turns[3, 2] * unit) == pytest.approx(1.0, abs=1e-5)
    assert found(50.4, 40.3) == pytest.approx(np.arctan2(-0.3, -0.4), abs=1e-4)
