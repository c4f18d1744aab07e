"""Standard scenes of the literature: overlap is at most 2 cm, and all agents get through."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.crowds import scenes
from tests.crowds.scenes import BIKE, CAR, CHAIR, PED, SCOOTER
from urbanverse_mjx.crowds import (
    Bodies,
    Options,
    PreferredVelocity,
    Traits,
    advance,
    deadlock,
    make_step,
    no_walls,
    traits_of,
)

DEEPEST = 0.02


@pytest.mark.parametrize(
    ("one", "other", "apart", "seconds"),
    [
        (PED, PED, 16.0, 14),
        pytest.param(PED, CHAIR, 16.0, 24, marks=pytest.mark.slow),
        (PED, SCOOTER, 30.0, 26),
        pytest.param(PED, CAR, 60.0, 50, marks=pytest.mark.slow),
        (CAR, CAR, 80.0, 24),
    ],
    ids=lambda value: value.name if hasattr(value, "name") else None,
)
def test_head_on(one: object, other: object, apart: float, seconds: float) -> None:
    scene = scenes.head_on(one, apart, other)  # type: ignore[arg-type]
    path = scenes.run(scene, seconds)
    assert path.overlap() <= DEEPEST
    assert path.away(scene).max() < 1.0
    # They avoid each other without a large detour.
    assert np.abs(path.y).max() < 2.0 * (scene.kinds[0].size + scene.kinds[1].size)


@pytest.mark.slow
def test_cyclists_head_on() -> None:
    scene = scenes.head_on(BIKE, 60.0)
    path = scenes.run(scene, 24.0)
    assert path.overlap() <= DEEPEST
    assert path.progress(scene).min() > 45.0


@pytest.mark.extended
def test_circle_of_sixteen_changes_places() -> None:
    scene = scenes.circle(16, 5.0)
    path = scenes.run(scene, 30.0)
    assert path.overlap() <= DEEPEST
    assert path.away(scene).max() < 0.5


@pytest.mark.slow
def test_the_circle_stops_without_the_deadlock_rule(monkeypatch: pytest.MonkeyPatch) -> None:
    # The purpose of `deadlock`: the published program alone never resolves the ring.
    monkeypatch.setattr(deadlock, "MAX_ROTATION", 0.0)
    scene = scenes.circle(16, 5.0)
    path = scenes.run(scene, 20.0)
    assert path.overlap() <= DEEPEST
    assert path.away(scene).min() > 5.0


@pytest.mark.slow
def test_two_groups_pass_in_a_corridor() -> None:
    scene = scenes.corridor(12, 3.0)
    path = scenes.run(scene, 40.0)
    assert path.overlap() <= DEEPEST
    assert path.progress(scene).min() > 14.0
    assert np.abs(path.y).max() <= 1.5 - PED.radius + 0.01


def test_flows_cross() -> None:
    scene = scenes.crossing(16)
    path = scenes.run(scene, 18.0)
    assert path.overlap() <= DEEPEST
    # No agent loses more than a third of the distance that it would cover alone.
    assert (path.progress(scene) > 0.66 * (18.0 - 0.5) * scene.speed).mean() > 0.9
    assert path.progress(scene).min() > 10.0


def test_the_fast_one_overtakes() -> None:
    scene = scenes.overtaking()
    path = scenes.run(scene, 20.0)
    assert path.overlap() <= DEEPEST
    assert path.x[0, 1] < path.x[0, 0] - 2.0
    assert path.x[-1, 1] > path.x[-1, 0] + 2.0
    # The slow one need not run off for it.
    assert np.abs(path.y[:, 0]).max() < 0.4


def random_state(kinds: tuple, seed: int, side: float) -> tuple[Bodies, Traits, PreferredVelocity]:
    rng = np.random.default_rng(seed)
    number = len(kinds)
    x, y = rng.uniform(0, side, (2, number))
    heading, speed = rng.uniform(-3, 3, number), rng.uniform(0, 1.5, number)
    columns = (x, y, speed * np.cos(heading), speed * np.sin(heading), heading)
    aim = rng.uniform(-3, 3, number)
    bodies = Bodies(*(jnp.asarray(c, jnp.float32) for c in columns))
    preferred_velocity = PreferredVelocity(
        *(jnp.asarray(c, jnp.float32) for c in (1.3 * np.cos(aim), 1.3 * np.sin(aim), aim))
    )
    return bodies, Traits(*(a[:, 0] for a in traits_of(kinds))), preferred_velocity


@pytest.mark.extended
def test_alone_mapped_and_nested_are_one_step() -> None:
    kinds = (PED,) * 4 + (BIKE, CAR)
    step = make_step(Options(num_neighbours=3, num_wheeled=2))
    states = [random_state(kinds, seed, 8.0) for seed in range(4)]

    def one(state: tuple[Bodies, Traits, PreferredVelocity]) -> Bodies:
        return step(*state, no_walls(6), no_walls(2))[0]

    alone = jax.jit(one)
    expected = np.stack([np.stack(list(alone(state))) for state in states])
    stacked = jax.tree.map(lambda *a: jnp.stack(a), *states)
    mapped = jax.jit(jax.vmap(one))(stacked)
    np.testing.assert_allclose(np.stack(list(mapped), 1), expected, atol=2e-6)
    nested = jax.jit(jax.vmap(jax.vmap(one)))(jax.tree.map(lambda a: a.reshape(2, 2, *a.shape[1:]), stacked))
    np.testing.assert_allclose(np.stack(list(nested), 2).reshape(expected.shape), expected, atol=2e-6)


@pytest.mark.extended
def test_an_absent_agent_changes_nothing() -> None:
    kinds = (PED,) * 6
    bodies, traits, preferred_velocity = random_state(kinds, 1, 3.0)
    step = jax.jit(make_step(Options(num_neighbours=5, discs_only=True)))
    gone = traits._replace(present=traits.present.at[3].set(False))
    there = jnp.array([0, 1, 2, 4, 5])
    few = jax.jit(make_step(Options(num_neighbours=5, discs_only=True)))(
        *jax.tree.map(lambda a: a[there], (bodies, traits, preferred_velocity)), no_walls(5), no_walls(0)
    )[0]
    found = step(bodies, gone, preferred_velocity, no_walls(6), no_walls(0))[0]
    np.testing.assert_allclose(np.stack(list(found))[:, there], np.stack(list(few)), atol=2e-6)
    np.testing.assert_array_equal(np.stack(list(found))[:, 3], np.stack(list(bodies))[:, 3])


def test_vehicles_keep_their_limits() -> None:
    kinds = (BIKE, BIKE, CAR, CAR)
    dt = 0.1
    options = Options(dt=dt, num_neighbours=3, num_wheeled=4)
    bodies, traits, preferred_velocity = random_state(kinds, 2, 12.0)

    def move(b: Bodies) -> Bodies:
        b, like, aim, front, rear = jax.tree.map(
            lambda a: a[..., None], (b, traits, preferred_velocity, no_walls(4), no_walls(4))
        )
        return advance(b, like, aim, front, rear, options)[0]

    step = jax.jit(move)
    for _ in range(40):
        new = jax.tree.map(lambda a: a[:, 0], step(bodies))
        cos, sin = np.cos(bodies.heading), np.sin(bodies.heading)
        dx, dy = new.x - bodies.x, new.y - bodies.y
        speed, before = np.hypot(new.vx, new.vy), np.hypot(bodies.vx, bodies.vy)
        turn = np.asarray(jnp.mod(new.heading - bodies.heading + np.pi, 2 * np.pi) - np.pi)
        # No sideways motion, no harder push than the kind's, no narrower curve.
        assert np.all(np.abs(dy * cos - dx * sin) <= 0.5 * np.abs(turn) * np.hypot(dx, dy) + 1e-4)
        assert np.all(speed - before <= traits.acceleration * dt + 1e-4)
        assert np.all(before - speed <= traits.braking * dt + 1e-4)
        tightest = np.maximum(np.hypot(dx, dy) / traits.turn_radius, traits.pivot * dt)
        assert np.all(np.abs(turn) <= tightest + 1e-3)
        bodies = new


def test_one_program_serves_changed_numbers() -> None:
    kinds = (PED,) * 5
    traces = []

    def counted(*state: object) -> object:
        traces.append(1)
        return make_step(Options(num_neighbours=4, discs_only=True))(*state, no_walls(5), no_walls(0))[0]  # type: ignore[arg-type]

    compiled = jax.jit(counted)
    for seed in range(3):
        compiled(*random_state(kinds, seed, 4.0))
    assert len(traces) == 1


@pytest.mark.slow
def test_margin_is_kept_where_there_is_room() -> None:
    wide = dataclasses.replace(PED, margin=0.3)
    scene = scenes.head_on(wide, 16.0)
    path = scenes.run(scene, 14.0)
    nearest = np.hypot(path.x[:, 0] - path.x[:, 1], path.y[:, 0] - path.y[:, 1]).min()
    assert nearest > 2 * (wide.radius + wide.margin) - 0.02
