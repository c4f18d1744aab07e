"""Half-planes against the published ones, and neighbours against sorting."""

import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.crowds import reference
from urbanverse_mjx.crowds import KINDS, Bodies, Options, Traits, half_planes, neighbours, orca, traits_of
from urbanverse_mjx.crowds.linear_program import NO_LIMIT
from urbanverse_mjx.datatypes import ValidationError


def met_within(apart: np.ndarray, velocity: np.ndarray, reach: np.ndarray, time: np.ndarray) -> np.ndarray:
    """(n,) bool: whether two agents (2, n) m apart come into contact at a relative velocity of (2, n) m/s.

    Those in reach already: whether they still are at the end of the time.
    """
    nearest = np.clip((apart * velocity).sum(0) / (velocity**2).sum(0), 0.0, time)
    nearest = np.where(np.hypot(*apart) < reach, time, nearest)
    return np.hypot(*(apart - nearest * velocity)) < reach


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_towards_discs_they_are_the_published_ones(dtype: type) -> None:
    rng = np.random.default_rng(0)
    count = 4000
    apart, velocity, other = rng.normal(0, 1.2, (2, count)), rng.normal(0, 1, (2, count)), rng.normal(0, 1, (2, count))
    reach, horizon, share = rng.uniform(0.3, 1.2, count), rng.uniform(1, 5, count), rng.uniform(0, 1, count)
    spare = rng.uniform(0, 1, count)
    # All three kinds of half-plane: bodies that touch, the closing disc, the legs.
    assert 0.1 < (np.hypot(*apart) < reach).mean() < 0.4
    with jax.enable_x64(dtype == np.float64):
        a, v, o, r, s, p, h = (jnp.asarray(q, dtype) for q in (apart, velocity, other, reach, share, spare, horizon))
        rows = half_planes.towards_neighbours(
            (a[:1], a[1:]), (v[0], v[1]), (o[:1], o[1:]), r[None], s[None], p[None], 1.0, True, h, 0.1
        )
    found = np.stack([np.asarray(row)[0] for row in rows])
    places, own, theirs = ((x + 1j * y).tolist() for x, y in (apart, velocity, other))
    # On a collision course the velocity changes by the agent's share; otherwise it may approach by the other share.
    meets = met_within(apart, velocity - other, reach, np.where(np.hypot(*apart) < reach, 0.1, horizon))
    assert 0.1 < meets.mean() < 0.9
    part = np.where(meets, share, spare)
    columns = zip(own, places, theirs, reach.tolist(), horizon.tolist(), part.tolist(), strict=True)
    lines = [reference.agent_line(0j, v, 0.0, p, o, r, h, 0.1, s) for v, p, o, r, h, s in columns]
    normal = np.array([complex(-line.direction.imag, line.direction.real) for line in lines], np.complex128)
    offset = [reference.cross(line.direction, line.point) for line in lines]
    expected = np.stack([normal.real, normal.imag, offset])
    np.testing.assert_allclose(found, expected, atol=1e-12 if dtype == np.float64 else 2e-5)


def test_who_stand_on_each_other_part() -> None:
    zero = jnp.zeros(1)
    normals = []
    for side in (1.0, -1.0):
        rows = half_planes.towards_neighbours(
            (zero[None], zero[None]),
            (zero, zero),
            (zero[None], zero[None]),
            zero[None] + 0.6,
            0.5,
            0.5,
            side,
            True,
            3.0,
            0.1,
        )
        assert all(np.isfinite(np.asarray(r)).all() for r in rows)
        normals.append(float(rows.x[0, 0]))
        assert float(rows.offset[0, 0]) == pytest.approx(0.5 * 0.6 / 0.1)
    assert normals == [1.0, -1.0]


@pytest.mark.extended
def test_capsules_are_as_near_as_their_nearest_discs() -> None:
    rng = np.random.default_rng(1)
    count = 2000
    apart = rng.normal(0, 4, (2, count))
    axes = [rng.uniform(0, 1.5, count) * np.stack([np.cos(a), np.sin(a)]) for a in rng.uniform(-4, 4, (2, count))]
    f = jnp.asarray
    dx, dy, place = half_planes.nearest_places(
        (f(apart[:1]), f(apart[1:])), (f(axes[0][0]), f(axes[0][1])), (f(axes[1][:1]), f(axes[1][1:]))
    )
    along = np.linspace(-1, 1, 101)
    own, other = along[:, None, None] * axes[0], apart + along[:, None, None] * axes[1]
    distance = np.linalg.norm(other[None] - own[:, None], axis=2).min((0, 1))
    crossing = distance < 0.05
    found = np.hypot(np.asarray(dx)[0], np.asarray(dy)[0])
    assert crossing.mean() < 0.2
    # The displacement starts at the returned position on the own axis.
    away = apart - np.asarray(place) * axes[0] - np.stack([np.asarray(dx)[0], np.asarray(dy)[0]])
    along = (away * axes[1]).sum(0) / (axes[1] ** 2).sum(0)
    np.testing.assert_allclose(away, along * axes[1], atol=1e-4)
    assert np.abs(along).max() < 1 + 1e-4
    np.testing.assert_allclose(found[~crossing], distance[~crossing], atol=0.02)


def test_walls_leave_the_free_space_per_horizon() -> None:
    # 0.8 m to the flat, 0.3 m of them body: 0.5 m in 2 s; the second is touched, the third is not there.
    space = jnp.array([[0.8], [0.2], [jnp.inf]])
    unit = jnp.array([[1.0], [0.0], [0.0]]), jnp.array([[0.0], [1.0], [1.0]])
    zero = jnp.zeros(1)
    walls = half_planes.towards_walls(unit, space, zero + 0.3, zero + 2.0)
    np.testing.assert_allclose(walls.offset[:, 0], [-0.25, 0.0, NO_LIMIT], atol=1e-7)
    np.testing.assert_allclose(walls.x[:, 0], [-1.0, 0.0, 0.0])


def scattered(bodies: int, envs: int, side: float, seed: int = 0) -> tuple[jax.Array, ...]:
    rng = np.random.default_rng(seed)
    x, y = (jnp.asarray(rng.uniform(-side / 2, side / 2, (bodies, envs)), jnp.float32) for _ in range(2))
    size = jnp.asarray(rng.uniform(0.2, 2.0, (bodies, envs)), jnp.float32)
    return x, y, size, jnp.asarray(rng.uniform(size=(bodies, envs)) < 0.8)


def gaps(x: jax.Array, y: jax.Array, size: jax.Array, present: jax.Array) -> np.ndarray:
    """(B, A, E) m from each agent (second axis) to the others' discs; inf for itself and the absent."""
    px, py, radius = (np.asarray(a, np.float64) for a in (x, y, size))
    gap = np.hypot(px[:, None] - px[None], py[:, None] - py[None]) - radius[:, None]
    gap[np.arange(len(px)), np.arange(len(px))] = np.inf
    return np.where(np.asarray(present)[:, None], gap, np.inf)


@pytest.mark.parametrize(("count", "number"), [(17, 8), (20, 40)])
def test_neighbours_are_the_nearest_in_order(count: int, number: int) -> None:
    """Also where the last index alone needs another bit."""
    bodies, agents = scattered(count, 30, 20.0), count - 2
    found = neighbours.all_pairs(*bodies, agents=agents, number=number)
    expected = np.sort(gaps(*bodies)[:, :agents], axis=0)[: min(number, count - 1)]
    np.testing.assert_array_equal(np.asarray(found.valid), np.isfinite(expected))
    reached = np.take_along_axis(gaps(*bodies)[:, :agents], np.asarray(found.index), axis=0)
    valid = np.isfinite(expected)
    np.testing.assert_allclose(reached[valid], expected[valid], atol=1e-4)
    index = np.where(np.asarray(found.valid), np.asarray(found.index), -1 - np.arange(len(expected))[:, None, None])
    assert all(len(set(column)) == len(column) for column in index.reshape(len(index), -1).T)


def test_the_grid_finds_all_within_a_cell() -> None:
    x, y, size, present = scattered(150, 4, 40.0, seed=3)
    size = jnp.full_like(size, 0.3)
    found = neighbours.in_grid(x, y, size, present, agents=150, number=8, cell=4.0, cells=12, depth=16)
    assert int(found.missed.max()) == 0
    gap = gaps(x, y, size, present)
    expected = np.sort(gap, axis=0)[:8]
    reached = np.where(np.asarray(found.valid), np.take_along_axis(gap, np.asarray(found.index), axis=0), np.inf)
    near = expected < 4.0 - 0.3
    assert near.mean() > 0.3
    np.testing.assert_allclose(reached[near], expected[near], atol=1e-4)


def test_the_grid_says_what_it_missed() -> None:
    x = jnp.zeros((10, 1))
    found = neighbours.in_grid(x, x, x + 0.3, x == 0, agents=10, number=4, cell=4.0, cells=4, depth=3)
    assert np.asarray(found.missed).tolist() == [[7]] * 10


def two(kinds: tuple[str, str], apart: float, speeds: tuple[float, float]) -> tuple[Bodies, Traits]:
    """Two bodies on the x axis that come towards each other."""
    f = lambda *v: jnp.array(v, jnp.float32)[:, None]  # noqa: E731
    bodies = Bodies(f(0.0, apart), f(0.0, 0.0), f(speeds[0], -speeds[1]), f(0.0, 0.0), f(0.0, math.pi))
    return bodies, traits_of([KINDS[k] for k in kinds])


def test_a_pair_shares_the_change_it_needs() -> None:
    # If both stop at their own lines the relative velocity is just outside what would collide.
    bodies, traits = two(("pedestrian", "pedestrian"), 3.0, (1.3, 1.3))
    for yields in ((1.0, 1.0), (1.0, 0.0), (0.2, 0.6)):
        traits = traits._replace(yielding=jnp.array(yields)[:, None])
        options = Options(discs_only=True)
        near = orca.look_around(bodies, traits, 2, options)
        lines, _ = orca.permitted(bodies, traits, 2, near, options)
        velocity = np.stack([bodies.vx[:, 0], bodies.vy[:, 0]])
        normal, offset = np.stack([lines.x[0, :, 0], lines.y[0, :, 0]]), np.asarray(lines.offset[0, :, 0])
        np.testing.assert_allclose(normal[:, 0], -normal[:, 1], atol=1e-5)
        moved = velocity + normal * (offset - (normal * velocity).sum(0))
        relative = moved[:, 0] - moved[:, 1]
        reach = 2 * (KINDS["pedestrian"].radius + KINDS["pedestrian"].margin)
        times = np.linspace(0, 3.0, 3001)[:, None]
        nearest = np.linalg.norm(np.array([3.0, 0.0]) - times * relative, axis=1).min()
        assert nearest == pytest.approx(reach, abs=2e-3)
        share = np.abs(moved - velocity).sum(0)
        assert share[0] * yields[1] == pytest.approx(share[1] * yields[0], abs=1e-5)


@pytest.mark.parametrize(("towards", "able"), [(1.3, 0.05), (-1.3, 1.0)])
def test_a_walker_steps_aside_for_a_standing_scooter_but_leaves_it_its_space(towards: float, able: float) -> None:
    """On the way into it the walker takes nearly all of the change; away from it, space is shared as among people."""
    bodies, traits = two(("pedestrian", "scooter"), 3.0, (towards, 0.0))
    traits = traits._replace(yielding=jnp.array([0.5, 0.8])[:, None])
    options = Options(discs_only=True, num_wheeled=1)
    near = orca.look_around(bodies, traits, 2, options)
    lines, _ = orca.permitted(bodies, traits, 2, near, options)
    velocity = np.stack([bodies.vx[:, 0], bodies.vy[:, 0]])
    normal, offset = np.stack([lines.x[0, :, 0], lines.y[0, :, 0]]), np.asarray(lines.offset[0, :, 0])
    change = offset - (normal * velocity).sum(0)
    assert (np.sign(change) == np.sign(towards)).all()
    assert change[0] * 0.8 * able == pytest.approx(change[1] * 0.5, abs=1e-5)


def test_walkers_come_before_vehicles() -> None:
    kinds = [KINDS[name] for name in ("pedestrian", "car", "scooter")]
    with pytest.raises(ValidationError, match="found a scooter after a car, needed walkers before wheeled kinds"):
        traits_of(kinds)
