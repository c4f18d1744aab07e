"""The task's terms against numbers worked out by hand."""

import jax.numpy as jnp
import numpy as np
import pytest

from urbanverse_mjx.envs import Result
from urbanverse_mjx.envs.navigation import terms

START = jnp.array([0.0, 0.0, 0.0])
# An L: 5 m east, then 5 m north; the goal repeats as padding.
ROUTE = jnp.array([[5.0, 0.0, 0.0], [5.0, 5.0, 0.0], [5.0, 5.0, 0.0], [5.0, 5.0, 0.0]])


def test_route_length_ignores_padding() -> None:
    assert float(terms.route_length(START, ROUTE)) == pytest.approx(10.0)


@pytest.mark.parametrize(
    ("point", "arc"),
    [((0, 0), 0.0), ((2, 1), 2.0), ((5, 0), 5.0), ((6, 3), 8.0), ((5, 5), 10.0), ((5, 9), 10.0), ((-3, 0), 0.0)],
)
def test_route_position_is_arc_length(point: tuple[float, float], arc: float) -> None:
    assert float(terms.route_position(jnp.array(point, jnp.float32), START, ROUTE)) == pytest.approx(arc, abs=1e-5)


@pytest.mark.parametrize(
    ("point", "driven", "completed"),
    [
        ((2.0, 0.0), 2.0, 2.0),
        ((5.0, 3.0), 9.0, 8.0),
        ((-3.0, 0.0), 3.0, 0.0),
        # Near the goal but not at it: beyond it, and along the other two sides of the square.
        ((5.0, 9.0), 20.0, 6.0),
        ((1.0, 5.0), 6.0, 6.0),
        ((1.0, 5.0), 30.0, 6.0),
        # Straight across: the second leg is the nearer one after 4 m.
        ((3.2, 2.4), 4.0, 4.0),
    ],
)
def test_no_more_of_a_route_is_completed_than_can_be_true(
    point: tuple[float, float], driven: float, completed: float
) -> None:
    at = jnp.array(point, jnp.float32)
    left = jnp.linalg.norm(ROUTE[-1, :2] - at)
    found = terms.route_completed(at, START, ROUTE, jnp.float32(10.0), left, jnp.float32(driven))
    assert float(found) == pytest.approx(completed, abs=1e-5)


def test_next_waypoint_moves_on_within_two_metres_and_stops_at_the_goal() -> None:
    count = jnp.int32(2)
    assert int(terms.next_waypoint(jnp.array([2.9, 0.0]), jnp.int32(0), ROUTE, count)) == 0
    assert int(terms.next_waypoint(jnp.array([3.1, 0.0]), jnp.int32(0), ROUTE, count)) == 1
    assert int(terms.next_waypoint(jnp.array([5.0, 5.0]), jnp.int32(1), ROUTE, count)) == 1


def test_body_frame_turns_the_world_back() -> None:
    # Heading north, a goal to the north is straight ahead, one to the east is to the right.
    yaw = jnp.asarray(jnp.pi / 2)
    np.testing.assert_allclose(terms.to_body(jnp.array([0.0, 3.0]), yaw), [3.0, 0.0], atol=1e-6)
    np.testing.assert_allclose(terms.to_body(jnp.array([2.0, 0.0]), yaw), [0.0, -2.0], atol=1e-6)


def test_paper_rewards() -> None:
    assert float(terms.reward_position(jnp.float32(0.0), 5.0)) == 1.0
    assert float(terms.reward_position(jnp.float32(5.0), 5.0)) == pytest.approx(1 - np.tanh(1.0))
    velocity, to_goal = jnp.array([0.6, 0.8]), jnp.array([10.0, 0.0])
    assert float(terms.reward_velocity_cosine(velocity, to_goal)) == pytest.approx(0.6)
    assert float(terms.reward_velocity_cosine(5 * velocity, to_goal)) == pytest.approx(0.6)
    assert float(terms.reward_velocity_dot(5 * velocity, to_goal)) == pytest.approx(3.0)
    assert float(terms.reward_velocity_cosine(jnp.zeros(2), to_goal)) == 0.0
    assert float(terms.reward_progress(jnp.float32(7.0), jnp.float32(6.5))) == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("distance", "reward"), [(0.0, 1.0), (0.4, 1.0), (0.7, 0.5), (0.85, 0.25), (1.0, 0.0), (3.0, 0.0)]
)
def test_nearness_of_hulls_grows_from_a_metre_to_forty_centimetres(distance: float, reward: float) -> None:
    assert float(terms.reward_near_object(jnp.float32(distance))) == pytest.approx(reward, abs=1e-6)


def test_terms_of_ends_and_hits_are_one_on_their_step() -> None:
    for result in Result:
        code = jnp.int32(result)
        assert float(terms.reward_arrived(code)) == (result == Result.GOAL)
        assert float(terms.reward_off_traversable(code)) == (result == Result.OFF_TRAVERSABLE)
    assert [float(terms.reward_hit(jnp.bool_(hit))) for hit in (False, True)] == [0.0, 1.0]
    # A standing robot's jitter earns less the slower it is.
    slow = terms.reward_velocity_cosine(jnp.array([0.01, 0.0]), jnp.array([10.0, 0.0]))
    assert float(slow) == pytest.approx(0.2)


@pytest.mark.extended
def test_places_beside_a_route_and_their_distances_to_it() -> None:
    """Along an L that rises by 1 m over its second leg; left of its first leg is north, of its second west."""
    corners = jnp.array([[0.0, 0.0, 0.0], [5.0, 0.0, 0.0], [5.0, 5.0, 1.0]])
    along, aside = jnp.array([0.0, 2.0, 5.0, 7.5, 12.0]), jnp.array([0.0, 1.0, -2.0, 0.5, 0.0])
    points, piece = terms.beside_route(corners, along, aside)
    expected = [[0, 0, 0], [2, 1, 0], [7, 0, 0], [4.5, 2.5, 0.5], [5, 7, 1.4]]
    np.testing.assert_allclose(points, expected, atol=1e-5)
    assert piece.tolist() == [0, 0, 1, 1, 1]
    away = terms.distance_to_route(jnp.asarray(points)[:, :2], corners[:, :2])
    np.testing.assert_allclose(away, [0.0, 1.0, 2.0, 0.5, 2.0], atol=1e-5)
    flat, _ = terms.beside_route(corners[:, :2], along, aside)
    np.testing.assert_allclose(flat, np.array(expected)[:, :2], atol=1e-5)


def test_result_precedence() -> None:
    flags = {
        "finite": True,
        "fallen": False,
        "hit": False,
        "off_traversable": False,
        "at_goal": False,
        "out_of_time": False,
    }

    def code(**changed: bool) -> int:
        return int(terms.result_of(**{k: jnp.bool_(x) for k, x in {**flags, **changed}.items()}))

    assert code() == Result.RUNNING
    assert code(at_goal=True) == Result.GOAL
    assert code(at_goal=True, out_of_time=True) == Result.GOAL
    # Touching something on arrival is no success (paper: "reaches the goal without collision").
    assert code(at_goal=True, hit=True) == Result.HIT
    assert code(off_traversable=True, at_goal=True) == Result.OFF_TRAVERSABLE
    assert code(fallen=True, off_traversable=True) == Result.FALL
    assert code(hit=True, fallen=True) == Result.HIT
    assert code(finite=False, hit=True) == Result.NON_FINITE
    assert code(out_of_time=True) == Result.TIMEOUT
    assert code(hit=True, hit_agent=True, fallen=True) == Result.HIT_AGENT
    # Where hits end no episode, touching a person ends none either.
    assert code(hit_agent=True) == Result.RUNNING
