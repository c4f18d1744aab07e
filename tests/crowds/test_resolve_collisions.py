"""Resolution of collisions: no pair's overlap grows, whatever was asked for; what walls and the ground allow."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from urbanverse_mjx.crowds import KINDS, Bodies, HalfPlanes, Traits, num_long, resolve_collisions, traits_of
from urbanverse_mjx.crowds.free_space import CELL, FreeSpace
from urbanverse_mjx.crowds.open_ground import is_open, make_open_ground
from urbanverse_mjx.crowds.traversability import Traversability

NAMES = ("pedestrian",) * 5 + ("wheelchair", "scooter", "scooter", "cyclist", "cyclist", "car", "car")
AGENTS = len(NAMES)
CALL = jax.jit(resolve_collisions.make_resolve_collisions(num_long([KINDS[n] for n in NAMES])))
PEOPLE = resolve_collisions.make_resolve_collisions(0)


def traits_with_robot(present: np.ndarray) -> Traits:
    """Traits of the agents and, behind them, of a disc of 0.45 m."""
    one = jax.tree.map(lambda a: a[:, 0], traits_of([KINDS[n] for n in NAMES]))
    robot = Traits(*(jnp.ones(1) for _ in Traits._fields))._replace(
        present=jnp.ones(1, bool), radius=jnp.array([0.45]), half_length=jnp.zeros(1)
    )
    joined = Traits(*(jnp.concatenate(columns) for columns in zip(one, robot, strict=True)))
    return joined._replace(present=jnp.asarray(np.append(present, True)))


def distances(bodies: Bodies, half: np.ndarray, crossed: bool) -> np.ndarray:
    """(B, B) m in float64 between axes: from the ends to the other axis; 0 for axes that cross, where `crossed`."""
    x, y, heading = (np.asarray(a, np.float64) for a in (bodies.x, bodies.y, bodies.heading))
    axis = half[:, None] * np.stack([np.cos(heading), np.sin(heading)], -1)
    centre = np.stack([x, y], -1)
    found = np.full((len(x), len(x)), np.inf)
    for end in (-1.0, 1.0):
        route = (centre + end * axis)[:, None] - centre
        along = np.clip((route * axis).sum(-1) / np.maximum((axis**2).sum(-1), 1e-12), -1.0, 1.0)
        found = np.minimum(found, np.linalg.norm(route - along[..., None] * axis, axis=-1))
    found = np.minimum(found, found.T)
    if crossed:
        route = centre[None] - centre[:, None]
        cross = axis[:, None, 0] * axis[None, :, 1] - axis[:, None, 1] * axis[None, :, 0]
        safe = np.where(np.abs(cross) > 1e-12, cross, np.inf)
        own = (route[..., 0] * axis[None, :, 1] - route[..., 1] * axis[None, :, 0]) / safe
        their = (route[..., 0] * axis[:, None, 1] - route[..., 1] * axis[:, None, 0]) / safe
        found = np.where((np.abs(own) < 1.0) & (np.abs(their) < 1.0) & np.isfinite(safe), 0.0, found)
    return found


def crowd(rng: np.random.Generator, side: float, reach: float) -> tuple[Bodies, Bodies, np.ndarray, np.ndarray]:
    """Random bodies (agents and the robot), their desired positions, and flags of presence and permission."""
    now = [rng.uniform(0, side, AGENTS + 1), rng.uniform(0, side, AGENTS + 1)]
    velocity = [rng.normal(0, 1, AGENTS + 1) for _ in range(2)]
    heading = rng.uniform(-np.pi, np.pi, AGENTS + 1)
    step = reach * rng.uniform(0, 1, AGENTS)
    route = rng.uniform(-np.pi, np.pi, AGENTS)
    turned = heading[:AGENTS] + rng.uniform(-0.3, 0.3, AGENTS)
    later = [
        now[0][:AGENTS] + step * np.cos(route),
        now[1][:AGENTS] + step * np.sin(route),
        *(v[:AGENTS] for v in velocity),
    ]
    bodies, after = (
        Bodies(*(jnp.asarray(c, jnp.float32) for c in columns))
        for columns in ((*now, *velocity, heading), (*later, turned))
    )
    return bodies, after, rng.uniform(size=AGENTS) < 0.9, rng.uniform(size=AGENTS) < 0.9


@pytest.mark.extended
@settings(max_examples=300, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(1.0, 25.0), st.floats(0.0, 0.9))
def test_no_overlap_grows(seed: int, side: float, reach: float) -> None:
    bodies, after, present, may = crowd(np.random.default_rng(seed), side, reach)
    traits = traits_with_robot(present)
    found = CALL(bodies, after, traits, jnp.asarray(may))
    half, radius = (np.asarray(a, np.float64) for a in (traits.half_length, traits.radius))
    there = np.append(present, True)
    pairs = there & there[:, None] & ~np.eye(AGENTS + 1, dtype=bool)
    need = radius + radius[:, None]
    later = Bodies(*(jnp.append(a, b[-1]) for a, b in zip(found, bodies, strict=True)))
    was, now = (distances(b, half, crossed=False) for b in (bodies, later))
    assert (now >= np.minimum(need - 1e-4, was) - 2e-5)[pairs].all()
    # Bodies without overlap have none afterwards, by a distance that handles crossing axes.
    was, now = (distances(b, half, crossed=True) for b in (bodies, later))
    assert (now >= need - 1.2e-4)[pairs & (was >= need)].all()
    # Every body takes the whole step or none; a body without permission holds.
    went = np.asarray(found.x == after.x) & np.asarray(found.y == after.y) & np.asarray(found.heading == after.heading)
    stays = np.asarray(found.x == bodies.x[:-1]) & np.asarray(found.y == bodies.y[:-1])
    rest = (np.asarray(found.vx) == 0.0) & (np.asarray(found.vy) == 0.0)
    assert (went | (stays & rest)).all()
    moved = np.hypot(after.x - bodies.x[:-1], after.y - bodies.y[:-1]) > 1e-3
    assert not (went & present & ~may & moved).any()
    long = half[:-1] > 0.0
    assert (went | (np.asarray(found.heading) == np.asarray(bodies.heading[:-1])) | ~long).all()
    # A body whose step is clear of all places and steps is never held.
    ends = Bodies(*(jnp.append(a, b[-1]) for a, b in zip(after, bodies, strict=True)))
    both = Bodies(*(jnp.concatenate([a, b]) for a, b in zip(ends, bodies, strict=True)))
    apart = distances(both, np.tile(half, 2), crossed=False)[: AGENTS + 1]
    clear = np.minimum(apart[:, : AGENTS + 1], apart[:, AGENTS + 1 :]) >= need + 1e-4
    assert went[(clear | ~pairs)[:-1].all(1) & may].all()


def test_holding_is_always_allowed() -> None:
    bodies, _, present, _ = crowd(np.random.default_rng(3), 2.0, 0.0)
    here = Bodies(*(a[:-1] for a in bodies))
    for may in (jnp.ones(AGENTS, bool), jnp.zeros(AGENTS, bool)):
        found = CALL(bodies, here, traits_with_robot(present), may)
        for name in ("x", "y", "heading"):
            np.testing.assert_array_equal(getattr(found, name), getattr(here, name))


@pytest.mark.parametrize("leader", [0, 1, 2])
def test_one_may_follow_into_the_place_that_another_leaves(leader: int) -> None:
    """Three people in contact in a row all move by 0.1 m, whatever their order in the arrays."""
    row = (np.arange(3) + leader) % 3
    x = -0.54 * row.astype(np.float64)
    zero = jnp.zeros(3)
    bodies = Bodies(jnp.asarray(x, jnp.float32), zero, zero, zero, zero)
    traits = jax.tree.map(lambda a: a[:, 0], traits_of([KINDS["pedestrian"]] * 3))
    after = bodies._replace(x=bodies.x + 0.1, vx=zero + 1.0)
    found = PEOPLE(bodies, after, traits, jnp.ones(3, bool))
    np.testing.assert_array_equal(found.x, after.x)
    # Where the first may not go, no one can.
    stopped = PEOPLE(bodies, after, traits, jnp.asarray(row != 0))
    np.testing.assert_array_equal(stopped.x, bodies.x)


def test_of_two_who_clash_the_first_goes() -> None:
    zero = jnp.zeros(2)
    bodies = Bodies(jnp.array([0.0, 0.7]), zero, zero, zero, zero)
    traits = jax.tree.map(lambda a: a[:, 0], traits_of([KINDS["pedestrian"]] * 2))
    after = bodies._replace(x=jnp.array([0.1, 0.6]))
    np.testing.assert_allclose(PEOPLE(bodies, after, traits, jnp.ones(2, bool)).x, [0.1, 0.7], atol=1e-6)
    np.testing.assert_allclose(PEOPLE(bodies, after, traits, jnp.array([False, True])).x, [0.0, 0.6], atol=1e-6)


def test_many_envs_are_settled_as_one() -> None:
    rng = np.random.default_rng(7)
    states = [crowd(rng, 4.0, 0.5) for _ in range(6)]
    traits = traits_with_robot(states[0][2])
    stacked = [jax.tree.map(lambda *a: jnp.stack(a), *(s[k] for s in states)) for k in (0, 1)]
    may = jnp.asarray(np.stack([s[3] for s in states]))
    found = jax.jit(jax.vmap(CALL, in_axes=(0, 0, None, 0)))(*stacked, traits, may)
    for e, (bodies, after, _, may_e) in enumerate(states):
        alone = CALL(bodies, after, traits, jnp.asarray(may_e))
        np.testing.assert_allclose(np.stack([np.asarray(a[e]) for a in found]), np.stack(list(alone)), atol=1e-6)


def test_a_body_keeps_off_a_flat_with_both_ends() -> None:
    """A car along x at 0, a flat at y = 1: it may turn as far as its front or rear disc touches."""
    car = KINDS["car"]
    traits = jax.tree.map(lambda a: a[:, 0], traits_of([KINDS["pedestrian"], car]))
    zero = jnp.zeros(2)
    before = Bodies(zero, zero, zero, zero, zero)
    away = -(1.0 - np.array([KINDS["pedestrian"].radius, car.radius])) / np.asarray(traits.wall_horizon)
    walls = HalfPlanes(jnp.zeros((1, 2)), -jnp.ones((1, 2)), jnp.asarray(away[None], jnp.float32))
    rear = HalfPlanes(*(a[:, 1:] for a in walls))
    most = float(np.arcsin((1.0 - car.radius) / car.half_length))
    for turn, fits in ((0.95 * most, True), (1.05 * most, False), (-0.95 * most, True), (-1.05 * most, False)):
        after = before._replace(heading=jnp.array([turn, turn]))
        np.testing.assert_array_equal(resolve_collisions.keeps_off(walls, rear, before, after, traits), [True, fits])
    for route, fits in ((0.72, [True, False]), (0.11, [True, True]), (0.74, [False, False]), (-5.0, [True, True])):
        after = before._replace(y=zero + route)
        np.testing.assert_array_equal(resolve_collisions.keeps_off(walls, rear, before, after, traits), fits)


def test_open_ground_is_the_map() -> None:
    rng = np.random.default_rng(2)
    spaces = [
        FreeSpace(np.array([x0, -3.0]), rng.uniform(size=shape) < 0.5, np.zeros(shape, np.uint8))
        for x0, shape in ((0.0, (40, 61)), (-7.0, (35, 48)))
    ]
    ground = make_open_ground(spaces)
    for z, space in enumerate(spaces):
        cells = np.stack([rng.integers(-3, n + 3, 500) for n in space.free.shape], -1)
        inside = ((cells >= 0) & (cells < space.free.shape)).all(1)
        expected = np.where(inside, space.free[tuple(np.clip(cells, 0, np.array(space.free.shape) - 1).T)], False)
        at = space.centres(cells) + rng.uniform(-0.4, 0.4, (500, 2)) * CELL
        np.testing.assert_array_equal(is_open(ground, jnp.int32(z), *at.T.astype(np.float32)), expected)


def test_no_end_of_a_body_leaves_free_ground() -> None:
    """A walker and a cyclist beside a post and in it."""
    free = np.ones((100, 100), bool)
    free[60:63, 50:53] = False
    space = FreeSpace(np.zeros(2), free, np.zeros(free.shape, np.uint8))
    kinds = [KINDS["pedestrian"], KINDS["cyclist"]]
    traits = jax.tree.map(lambda a: a[:, 0], traits_of(kinds))
    traversability = Traversability({}, {name: make_open_ground([space]) for name in ("foot", "road")}, kinds, traits)

    def stays(x: float, later: float, heading: float = 0.0) -> list[bool]:
        zero = jnp.zeros(2)
        before = Bodies(zero + x, zero + 5.15, zero, zero, zero)
        after = before._replace(x=zero + later, heading=zero + heading)
        return np.asarray(traversability.stays(before, after, jnp.int32(0))).tolist()

    assert stays(5.3, 5.4) == [True, True]
    assert stays(5.3, 5.6) == [True, False]
    assert stays(6.9, 6.7) == [True, False], "its rear end"
    assert stays(5.9, 6.1) == [False, False], "its ends are beside it, its middle comes to stand there"
    assert stays(6.1, 6.2) == [True, True], "who is on no free ground may go anywhere"
