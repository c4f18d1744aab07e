"""Rules for people and vehicles that block each other against the same rules written one agent at a time, and what they
promise: speeds that are kept, sides, times."""

import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from urbanverse_mjx.crowds import deadlock, orca
from urbanverse_mjx.crowds.bodies import PreferredVelocity
from urbanverse_mjx.crowds.linear_program import NO_LIMIT

NUMBER = 400
DT = 0.1


def drawn(seed: int, largest: float = 1.8) -> tuple[PreferredVelocity, np.ndarray, np.ndarray]:
    """Preferred velocities of up to `largest` m/s, velocities (2, NUMBER) m/s and blocked shares (NUMBER,)."""
    rng = np.random.default_rng(seed)
    speed, angle = rng.uniform(0.0, largest, NUMBER), rng.uniform(-np.pi, np.pi, NUMBER)
    face = jnp.asarray(rng.uniform(-np.pi, np.pi, NUMBER), jnp.float32)
    x, y = (jnp.asarray(speed * f(angle), jnp.float32) for f in (np.cos, np.sin))
    wanted = PreferredVelocity(x, y, face)
    return wanted, rng.normal(0.0, 0.8, (2, NUMBER)).astype(np.float32), rng.uniform(0.0, 1.0, NUMBER)


@pytest.mark.parametrize("dt", [DT, 3.0])
def test_the_missing_share_follows_the_progress_towards_what_is_wanted(dt: float) -> None:
    """A first-order low-pass filter of 1.5 s; who wants less than 0.3 m/s is not blocked by anybody."""
    wanted, velocity, blocked = drawn(0)
    found = np.asarray(deadlock.held_up(jnp.asarray(blocked, jnp.float32), wanted, tuple(velocity), dt))
    wants = np.stack([wanted.x, wanted.y], -1).astype(float)
    for k, want in enumerate(wants):
        missing = 0.0
        if np.linalg.norm(want) > 0.3:
            missing = 1.0 - min(max(float(want @ velocity[:, k]) / float(want @ want), 0.0), 1.0)
        weight = min(1.0, dt / 1.5)
        assert found[k] == pytest.approx((1.0 - weight) * blocked[k] + weight * missing, abs=1e-5)
    slow = np.hypot(wanted.x, wanted.y) <= 0.3
    assert 20 < slow.sum() < NUMBER - 20


def test_who_is_blocked_turns_aside_and_keeps_the_speed() -> None:
    wanted, _, blocked = drawn(1)
    for side in (-1.0, 0.0, 1.0):
        aside = deadlock.step_aside(wanted, jnp.asarray(blocked, jnp.float32), side)
        before, after = (np.asarray(v.x) + 1j * np.asarray(v.y) for v in (wanted, aside))
        np.testing.assert_allclose(np.abs(after), np.abs(before), atol=1e-5)
        turned = np.angle(after / before)
        share = np.interp(blocked, [0.35, 0.8], [0.0, 1.0])
        np.testing.assert_allclose(turned, side * 1.3 * share, atol=2e-4)
        np.testing.assert_array_equal(aside.face, wanted.face)
        assert np.abs(turned).max() < math.pi / 2, "nobody walks back"


def test_who_stepped_aside_in_vain_tries_the_other_side_after_three_seconds() -> None:
    """In the mean; the others never."""
    side = jnp.where(jnp.arange(NUMBER) % 3 == 0, 1.0, -1.0)
    blocked = jnp.where(jnp.arange(NUMBER) % 2 == 0, 0.9, 0.7)
    times = []
    for seed in range(50):
        new = deadlock.reconsider(side, blocked, jax.random.key(seed), DT)
        assert set(np.unique(np.asarray(new / side))) <= {1.0, -1.0}
        times.append(np.asarray(new != side))
    changed = np.stack(times)
    assert not changed[:, 1::2].any()
    assert changed[:, ::2].mean() == pytest.approx(DT / 3.0, rel=0.08)
    assert (np.asarray(deadlock.reconsider(side, blocked, jax.random.key(0), 10.0) == -side) == (blocked > 0.8)).all()


@pytest.mark.parametrize("right", [0.0, 0.8, 1.0])
def test_people_have_habitual_sides(right: float) -> None:
    side = np.asarray(deadlock.habitual_side(jax.random.key(0), 20_000, right))
    assert set(side.tolist()) <= {-1.0, 1.0}
    assert (side == -1.0).mean() == pytest.approx(right, abs=0.01)


def test_a_vehicle_backs_up_against_its_heading() -> None:
    wanted, _, _ = drawn(2)
    heading = jnp.asarray(np.random.default_rng(3).uniform(-np.pi, np.pi, NUMBER), jnp.float32)
    backing = jnp.where(jnp.arange(NUMBER) % 2 == 0, 1.0, 0.0)
    found = deadlock.back_up(wanted, backing, heading)
    for a, b in zip(found, wanted, strict=True):
        np.testing.assert_array_equal(a[1::2], b[1::2])
    velocity, ahead = (np.asarray(found.x) + 1j * np.asarray(found.y))[::2], np.exp(1j * np.asarray(heading))[::2]
    np.testing.assert_allclose(velocity, -0.8 * ahead, atol=1e-5)
    # The heading turns towards the desired one, by at most 0.7 rad.
    turn = np.angle(np.exp(1j * np.asarray(found.face[::2])) / ahead)
    expected = np.clip(np.angle(np.exp(1j * np.asarray(wanted.face))[::2] / ahead), -0.7, 0.7)
    np.testing.assert_allclose(turn, expected, atol=1e-4)


def test_pedestrians_who_want_to_walk_retreat_by_at_most_that_against_what_they_face() -> None:
    """Half-planes of permitted velocities, asked with random velocities."""
    limit = 0.3
    wanted, velocity, _ = drawn(4, largest=0.7)
    planes = orca.stand(wanted)
    inside = planes.x[0] * velocity[0] + planes.y[0] * velocity[1] >= planes.offset[0]
    retreat = -(np.cos(wanted.face) * velocity[0] + np.sin(wanted.face) * velocity[1])
    walks = np.hypot(wanted.x, wanted.y) > limit
    np.testing.assert_array_equal(inside, ~walks | (retreat <= limit))
    assert (np.asarray(planes.offset[0])[~walks] == NO_LIMIT).all()
    assert 50 < (~np.asarray(inside)).sum()


def test_a_disturbance_is_at_most_twice_a_millimetre_per_second_and_to_the_side() -> None:
    wanted, _, _ = drawn(5)
    before = np.asarray(wanted.x) + 1j * np.asarray(wanted.y)
    for side in (-1.0, 0.0, 1.0):
        found = orca.disturbed(wanted, jax.random.key(0), side)
        away = (np.asarray(found.x) + 1j * np.asarray(found.y)) - before
        np.testing.assert_array_equal(found.face, wanted.face)
        # Without the part to the side, which is 1 mm/s for all who walk.
        fast = np.abs(before) > 0.01
        rest = (away - side * 1e-3j * before / np.abs(before))[fast]
        assert np.abs(rest).max() <= 1e-3 + 1e-6
        assert np.abs(rest).max() > 0.9e-3
        assert abs(rest.mean()) < 1e-4, "in all directions"
