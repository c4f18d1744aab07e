"""Vehicles roll along the arcs of a bicycle, walkers accelerate within their limits, and routes are looked up between
their nodes, against closed forms."""

import dataclasses
import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from urbanverse_mjx.crowds import KINDS, Bodies, deadlock, goal_fields, motion, traits_of
from urbanverse_mjx.crowds.bodies import PreferredVelocity
from urbanverse_mjx.crowds.linear_program import HalfPlanes


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


def planes(*rows: tuple[float, float, float]) -> HalfPlanes:
    """Velocities v with x v_x + y v_y >= offset."""
    columns = np.array(rows, np.float32).reshape(-1, 3).T
    return HalfPlanes(*(jnp.asarray(column)[:, None, None] for column in columns))


def chosen_control(
    preferred_velocity: PreferredVelocity,
    bodies: Bodies,
    lines: HalfPlanes | None = None,
    place: float = 0.0,
    front: HalfPlanes | None = None,
    rear: HalfPlanes | None = None,
) -> tuple[float, float, np.ndarray]:
    """Acceleration (m/s²) and turn rate (rad/s) of a car, and how far (m) it comes in a second."""
    traits, none = traits_of([KINDS["car"]]), planes()
    some = none if lines is None else lines
    # As many walls for the front as for the rear.
    walls = front or none, rear or planes(*[(1.0, 0.0, -99.0)] * (front.offset.shape[0] if front else 0))
    if front is None and rear is not None:
        walls = planes(*[(1.0, 0.0, -99.0)] * rear.offset.shape[0]), rear
    push, turn = motion.drive(some, jnp.full(some.offset.shape, place), walls, preferred_velocity, bodies, traits)
    at, dt = bodies, 0.01
    for _ in range(100):
        at = motion.roll(push, turn, preferred_velocity, at, traits, dt)
    moved = np.array([float((at.x - bodies.x)[0, 0]), float((at.y - bodies.y)[0, 0])])
    return float(push[0, 0]), float(turn[0, 0]), moved


@pytest.mark.parametrize("error", [-0.09, 0.0, 0.05, 0.09])
@pytest.mark.parametrize("heading", [0.0, 2.1])
def test_a_car_alone_takes_the_arc_whose_end_lies_where_it_wants_to_go(heading: float, error: float) -> None:
    speed = 6.0
    wanted = to(speed * math.cos(heading + error), speed * math.sin(heading + error), heading)
    push, turn, moved = chosen_control(wanted, rolling(heading, speed))
    assert abs(push) < 0.1
    assert turn == pytest.approx(2 * error, abs=0.01)
    np.testing.assert_allclose(moved, [wanted.x[0, 0], wanted.y[0, 0]], atol=0.1)


def test_a_car_speeds_up_and_brakes_within_its_limits() -> None:
    traits = traits_of([KINDS["car"]])
    faster, slower = (chosen_control(to(v, 0.0, 0.0), rolling(0.0, 5.0)) for v in (8.0, 0.0))
    assert faster[:2] == pytest.approx((float(np.ravel(traits.acceleration)[0]), 0.0), abs=1e-4)
    assert slower[0] == pytest.approx(-float(np.ravel(traits.braking)[0]), abs=1e-4)
    assert slower[2][0] < 5.0 < faster[2][0]


def test_a_car_keeps_to_what_its_neighbours_and_walls_permit() -> None:
    """Where a control does: slower than 3 m/s ahead; to the left of a neighbour; off a wall on its left."""
    wanted, bodies = to(6.0, 0.0, 0.0), rolling(0.0, 6.0)
    push, turn, moved = chosen_control(wanted, bodies, planes((-1.0, 0.0, -3.0)))
    assert push < -2.0
    assert moved[0] < 5.0
    _, turn, moved = chosen_control(wanted, bodies, planes((0.0, 1.0, 0.5)))
    assert turn > 0.1
    assert moved[1] > 0.3
    left = to(6.0 * math.cos(0.2), 6.0 * math.sin(0.2), 0.0)
    _, free, _ = chosen_control(left, bodies)
    _, turn, moved = chosen_control(left, bodies, front=planes((0.0, -1.0, -0.3)))
    assert turn < 0.5 * free
    assert moved[1] < 0.5


def test_the_front_and_the_rear_of_a_turning_car_swing_to_opposite_sides() -> None:
    """Turning left, its front moves to the left more than its middle does, and its rear to the right."""
    slow = KINDS["car"].turn_radius
    speed = 2.0
    left, bodies = to(speed * math.cos(0.25), speed * math.sin(0.25), 0.0), rolling(0.0, speed)
    _, free, moved = chosen_control(left, bodies)
    assert 0.0 < free <= speed / slow + 1e-3
    right_wall = planes((0.0, 1.0, -0.05))  # velocities to the right of at most 5 cm/s
    assert chosen_control(left, bodies, front=right_wall)[1] == pytest.approx(free, abs=1e-4)
    assert chosen_control(left, bodies, rear=right_wall)[1] < free - 0.02
    left_wall = planes((0.0, -1.0, -moved[1] - 0.1))  # the middle may, the front may not
    assert chosen_control(left, bodies, rear=left_wall)[1] == pytest.approx(free, abs=1e-4)
    assert chosen_control(left, bodies, front=left_wall)[1] < free - 0.02
    # A neighbour beside its front, its middle or its rear.
    assert chosen_control(left, bodies, left_wall, place=1.0)[1] < free - 0.02
    assert chosen_control(left, bodies, left_wall, place=0.0)[1] == pytest.approx(free, abs=1e-4)
    assert chosen_control(left, bodies, right_wall, place=-1.0)[1] < free - 0.02


WALKER = dataclasses.replace(KINDS["pedestrian"], acceleration=2.0, braking=3.0, wall_horizon=0.8)
NO_WALLS = HalfPlanes(*(jnp.zeros((0, 1, 1)),) * 3)


@pytest.mark.parametrize(
    ("now", "chosen", "after"),
    [
        ((0.0, 0.0), (0.6, -0.8), (0.36, -0.48)),  # from rest any direction is a turn: 3 m/s² for 0.2 s of 1 m/s
        ((0.3, 0.4), (0.9, 1.2), (0.54, 0.72)),  # faster along its heading: 2 m/s²
        ((0.9, -1.2), (0.0, 0.0), (0.54, -0.72)),  # slower: 3 m/s²
        ((1.0, 0.0), (0.0, 1.0), (1.0 - 0.6 / 2**0.5, 0.6 / 2**0.5)),  # a turn: 3 m/s²
        ((1.0, 0.5), (1.1, 0.3), (1.1, 0.3)),  # within reach
        ((1.0, 0.5), (0.0, 1.3), (1.0 - 0.6 / 1.64**0.5, 0.5 + 0.48 / 1.64**0.5)),  # faster, but a turn all the same
    ],
)
def test_a_walker_changes_its_velocity_within_its_limits(now: tuple, chosen: tuple, after: tuple) -> None:
    f = lambda x: jnp.full((1, 1), x, jnp.float32)  # noqa: E731
    bodies = Bodies(f(0.0), f(0.0), f(now[0]), f(now[1]), f(0.0))
    found = motion.walk((f(chosen[0]), f(chosen[1])), bodies, traits_of([WALKER]), NO_WALLS, 0.2)
    np.testing.assert_allclose(np.ravel(found), after, atol=1e-6)


def test_a_walker_stops_at_a_wall_faster_than_it_likes_to() -> None:
    """It walks at 2 m/s along (0.8, 0.6) and is to stand; it may not reach a wall at x = 0.2 m within two steps."""
    f = lambda x: jnp.full((1, 1), x, jnp.float32)  # noqa: E731
    bodies, dt = Bodies(f(0.0), f(0.0), f(1.6), f(1.2), f(0.0)), 0.2
    wall = HalfPlanes(*(jnp.full((1, 1, 1), x, jnp.float32) for x in (-1.0, 0.0, -0.2 / WALKER.wall_horizon)))
    vx, vy = motion.walk((f(0.0), f(0.0)), bodies, traits_of([WALKER]), wall, dt)
    np.testing.assert_allclose([vx[0, 0], vy[0, 0]], [0.5, 0.375], atol=1e-6)
    far = wall._replace(offset=wall.offset * 3.0)
    vx, vy = motion.walk((f(0.0), f(0.0)), bodies, traits_of([WALKER]), far, dt)
    np.testing.assert_allclose([vx[0, 0], vy[0, 0]], [1.6 * 0.7, 1.2 * 0.7], atol=1e-6)


def test_a_vehicle_that_is_stuck_backs_up_for_some_seconds_after_a_while() -> None:
    number, dt = 4000, 0.2

    def after(backing: float, still: float) -> np.ndarray:
        times = jnp.full(number, backing), jnp.full(number, still)
        return np.asarray(deadlock.backing_time(*times, jax.random.key(0), dt))

    np.testing.assert_allclose(after(1.0, 0.0), 0.8, atol=1e-6)
    np.testing.assert_allclose(after(1.0, 9.0), 0.8, atol=1e-6)
    assert (after(0.1, 9.0) == 0.0).all()
    assert (after(0.0, deadlock.STUCK_TIME - 0.1) == 0.0).all()
    begun = after(0.0, deadlock.STUCK_TIME + 0.1)
    assert set(begun.tolist()) == {0.0, deadlock.BACK_TIME}
    assert (begun > 0.0).mean() == pytest.approx(dt, abs=0.03), "after a second on average"


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
