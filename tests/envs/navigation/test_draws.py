"""Friction, mass and appearance of episodes: within their ranges, different every time, and without other effects."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from ml_collections import ConfigDict

from tests.support.unicycle import unicycle_env
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs import default_config, registry
from urbanverse_mjx.envs.navigation.draws import OFF, WET_FRICTION, Randomization

RANGES = {
    "randomization.friction_scale": (0.5, 0.9),
    "randomization.mass_scale": (1.1, 1.6),
    "randomization.appearance": 0.3,
}


def begun(bank: SceneBank, overrides: dict[str, Any]) -> Any:
    env = unicycle_env(bank, overrides)
    return env, jax.jit(jax.vmap(env.begin))(jax.random.split(jax.random.key(0), 500))


def test_values_fill_their_ranges_and_leave_the_rest_alone(small_bank: SceneBank) -> None:
    _, plain = begun(small_bank, {"randomization": OFF})
    env, drawn = begun(small_bank, RANGES)
    for values, (low, high) in ((drawn.sim.friction_scale, (0.5, 0.9)), (drawn.sim.mass_scale, (1.1, 1.6))):
        assert low <= values.min() < low + 0.02
        assert high - 0.02 < values.max() <= high
    assert abs(np.corrcoef(drawn.sim.friction_scale, drawn.sim.mass_scale)[0, 1]) < 0.15
    assert len(np.unique(drawn.appearance_seed)) == 500
    assert drawn.appearance_seed.min() > 0
    off = plain.sim
    assert (off.friction_scale == 1).all()
    assert (off.mass_scale == 1).all()
    assert (plain.appearance_seed == 0).all()
    for name in ("episode", "start", "goal", "route_length"):
        np.testing.assert_array_equal(getattr(plain, name), getattr(drawn, name))
    np.testing.assert_array_equal(off.qpos, drawn.sim.qpos)
    after = jax.jit(jax.vmap(env.reset_episode))(drawn)
    assert (after.sim.mass_scale != drawn.sim.mass_scale).all()
    assert (after.appearance_seed != drawn.appearance_seed).all()


@pytest.mark.extended
def test_wet_streets_have_less_friction(small_bank: SceneBank) -> None:
    """A share of the episodes, beside the friction that each draws."""
    _, plain = begun(small_bank, RANGES)
    _, drawn = begun(small_bank, {**RANGES, "randomization.wet": 0.25})
    ratio = np.asarray(drawn.sim.friction_scale / plain.sim.friction_scale)
    wet = np.isclose(ratio, WET_FRICTION)
    assert (wet | np.isclose(ratio, 1.0)).all()
    assert 0.18 < wet.mean() < 0.32
    _, rain = begun(small_bank, {"randomization": OFF, "randomization.wet": 1.0})
    np.testing.assert_allclose(rain.sim.friction_scale, WET_FRICTION)


def test_the_paper_has_it_and_the_laptop_has_not() -> None:
    assert registry.get_default_config("CocoNav", "paper").randomization.appearance > 0
    for preset in ("cpu", "urbansim_v0_1"):
        assert registry.get_default_config("CocoNav", preset).randomization.to_dict() == OFF


def test_cameras_and_latencies_are_drawn_within_their_ranges_and_apart() -> None:
    """Of 2,000 episodes: each value fills its range evenly and tells nothing about another one; the same seed gives the
    same camera."""
    config = default_config().randomization.copy_and_resolve_references()
    config.update(camera_position=0.05, camera_angle=4.0, camera_fovy=0.1, latency=(0.05, 0.25))
    config.update(exposure=1.5, white_balance=0.2, blur=1.0, pixel_noise=0.05)
    draws, seeds = Randomization(config), jnp.arange(1, 2001, dtype=jnp.int32)

    @jax.jit
    @jax.vmap
    def drawn(seed: Any) -> Any:
        return draws.camera_mount(seed), draws.camera_noise(seed), draws.latency(seed)

    mount, noise, latency = drawn(seeds)
    angles = np.degrees(2.0 * np.asarray(mount.rotation)[:, 1:])  # small angles about the three axes
    parts = [mount.offset, angles, mount.fovy_scale[:, None], noise.exposure[:, None], noise.white_balance]
    parts += [noise.blur[:, None], noise.noise[:, None], latency[:, None]]
    ranges = [*[(-0.05, 0.05)] * 3, *[(-4.0, 4.0)] * 3, (0.9, 1.1), (-1.5, 1.5), *[(0.8, 1.2)] * 3]
    ranges += [(0.0, 1.0), (0.0, 0.05), (0.05, 0.25)]
    columns = np.concatenate([np.asarray(part) for part in parts], axis=1).T
    assert columns.shape == (14, 2000)
    for values, (low, high) in zip(columns, ranges, strict=True):
        shares = np.histogram((values - low) / (high - low), 5, (-1e-3, 1.001))[0] / len(values)
        assert shares == pytest.approx([0.2] * 5, abs=0.04)
    assert np.abs(np.corrcoef(columns) - np.identity(14)).max() < 0.1, "drawn independently"
    np.testing.assert_array_equal(jax.jit(draws.latency)(seeds[6]), latency[6])
    off = Randomization(ConfigDict(OFF))
    assert (off.camera_mount(seeds[0]), off.camera_noise(seeds[0]), off.latency(seeds[0])) == (None, None, None)


@pytest.mark.extended
def test_each_episode_has_its_camera_mount_and_keeps_it(small_bank: SceneBank) -> None:
    limits = {"camera_position": 0.05, "camera_angle": 4.0, "camera_fovy": 0.1}
    env, drawn = begun(small_bank, {f"randomization.{name}": x for name, x in limits.items()})
    _, plain = begun(small_bank, {"randomization": OFF})
    mounts = jax.jit(jax.vmap(env._randomization.camera_mount))(drawn.appearance_seed)
    angles = np.degrees(2.0 * np.asarray(mounts.rotation)[:, 1:])  # small angles about the three axes
    for values, limit in ((mounts.offset, 0.05), (angles, 4.0), (mounts.fovy_scale[:, None] - 1.0, 0.1)):
        assert (np.abs(values).max(0) <= limit * 1.001).all()
        assert (values.max(0) > 0.97 * limit).all()
        assert (values.min(0) < -0.97 * limit).all()
    together = np.concatenate([mounts.offset, angles, mounts.fovy_scale[:, None]], axis=1)
    assert np.abs(np.corrcoef(together.T) - np.identity(7)).max() < 0.2, "drawn independently"
    np.testing.assert_array_equal(drawn.sim.qpos, plain.sim.qpos)
    step = jax.jit(jax.vmap(lambda nav: env.advance(nav, np.zeros(2, np.float32))[0]))
    np.testing.assert_array_equal(step(drawn).appearance_seed, drawn.appearance_seed)
    assert Randomization(ConfigDict(OFF)).camera_mount(jnp.int32(3)) is None
    older = ConfigDict({name: x for name, x in OFF.items() if not name.startswith("camera")})
    assert not Randomization(older).varies_camera, "policies from before this load"


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("friction_scale", (0.0, 1.0)),
        ("mass_scale", (1.2, 1.1)),
        ("appearance", 1.0),
        ("camera_position", -0.1),
        ("camera_angle", 90.0),
        ("camera_fovy", 1.0),
    ],
)
def test_bad_values_are_refused(small_bank: SceneBank, name: str, value: Any) -> None:
    with pytest.raises(ValidationError, match=name):
        unicycle_env(small_bank, {f"randomization.{name}": value})
