"""Imperfect cameras and latency: images against independent formulas, and which episodes get them."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from ml_collections import ConfigDict
from scipy import ndimage

from benchmarks.lib.shifts import exposed
from tests.support.unicycle import unicycle_env
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs import registry
from urbanverse_mjx.envs.navigation import camera_noise
from urbanverse_mjx.envs.navigation.draws import CAMERA_NOISE, OFF, Randomization
from urbanverse_mjx.evaluation.held_out import for_scoring
from urbanverse_mjx.training.networks import PIXELS

STRONGEST = {"exposure": 1.5, "white_balance": 0.2, "blur": 1.0, "pixel_noise": 0.05}
RANDOM = {f"randomization.{name}": x for name, x in STRONGEST.items()}
IDEAL = camera_noise.CameraNoise(jnp.float32(0.0), jnp.ones(3), jnp.float32(0.0), jnp.float32(0.0))


def seen(image: np.ndarray, key: int = 0, **camera: Any) -> np.ndarray:
    camera = {name: jnp.asarray(x, jnp.float32) for name, x in camera.items()}
    taken = jax.jit(camera_noise.through_camera)(jnp.asarray(image), IDEAL._replace(**camera), jax.random.key(key))
    return np.asarray(taken).astype(int)


@pytest.fixture(scope="module")
def image() -> np.ndarray:
    return np.random.default_rng(0).integers(0, 256, (24, 32, 3), np.uint8)


@pytest.mark.parametrize("ev", [-2.0, -0.7, 0.0, 1.3])
def test_exposure_is_that_of_the_transfer_benchmark(image: np.ndarray, ev: float) -> None:
    """Whose formula is written in NumPy and independently of this one."""
    np.testing.assert_allclose(seen(image, exposure=ev), exposed(image, ev, 0.0, np.random.default_rng(0)), atol=1)


def test_an_ideal_camera_changes_nothing(image: np.ndarray) -> None:
    np.testing.assert_array_equal(seen(image), image)


def test_white_balance_scales_the_light_of_a_channel(image: np.ndarray) -> None:
    found = seen(image, white_balance=(0.5, 1.0, 2.0))
    np.testing.assert_array_equal(found[..., 1], image[..., 1])
    for channel, ev in ((0, -1.0), (2, 1.0)):
        np.testing.assert_allclose(found[..., channel], seen(image, exposure=ev)[..., channel], atol=1)


def test_noise_has_its_deviation_and_is_another_in_every_image() -> None:
    grey = np.full((60, 80, 3), 128, np.uint8)
    first, second = (seen(grey, key, noise=0.04) - 128.0 for key in (0, 1))
    for found in (first, second):
        assert abs(found.std() / (255 * 0.04) - 1.0) < 0.03
        assert abs(found.mean()) < 0.5
    assert abs(np.corrcoef(first.ravel(), second.ravel())[0, 1]) < 0.05
    assert abs(np.corrcoef(first[..., 0].ravel(), first[..., 1].ravel())[0, 1]) < 0.05, "each channel has its own"
    assert seen(np.full_like(grey, 255), noise=0.04).min() > 255 * 0.7, "no value wraps around at white"


def test_images_are_blurred_each_by_its_strength() -> None:
    """Against SciPy's filter, with the outermost pixels repeated."""
    images = np.random.default_rng(0).uniform(0, 255, (2, 3, 7, 9, 3)).astype(np.float32)
    strength = np.array([0.0, 0.4, 1.0], np.float32)
    weights = np.array([0.25, 0.5, 0.25])
    soft = ndimage.correlate1d(ndimage.correlate1d(images, weights, 2, mode="nearest"), weights, 3, mode="nearest")
    share = strength[:, None, None, None]
    found = jax.jit(camera_noise.blurred)(jnp.asarray(images), jnp.asarray(strength))
    np.testing.assert_allclose(found, images + share * (soft - images), atol=1e-3)


def test_light_is_blurred_and_not_its_encoding() -> None:
    """A white line on black: half and a quarter of white's light are 188 and 137 in sRGB, not 128 and 64."""
    line = np.zeros((5, 9, 3), np.uint8)
    line[:, 4] = 255
    np.testing.assert_allclose(seen(line, blur=1.0)[:, 3:6, 0], [[137, 188, 137]] * 5, atol=1)
    half = seen(line, blur=1.0, exposure=-1.0)[2, 3:6, 0]
    np.testing.assert_allclose(half, exposed(np.array([137, 188, 137]), -1.0, 0.0, np.random.default_rng(0)), atol=1)


@pytest.mark.extended
def test_each_episode_has_a_camera_and_keeps_it(small_bank: SceneBank) -> None:
    env = unicycle_env(small_bank, {**RANDOM, "randomization.appearance": 0.0}, vision=True)
    drawn = jax.jit(jax.vmap(env.begin))(jax.random.split(jax.random.key(0), 500))
    cameras = jax.jit(jax.vmap(env._randomization.camera_noise))(drawn.appearance_seed)
    ranges = (
        (cameras.exposure[:, None], -1.5, 1.5),
        (cameras.white_balance, 0.8, 1.2),
        (cameras.blur[:, None], 0.0, 1.0),
        (cameras.noise[:, None], 0.0, 0.05),
    )
    for values, low, high in ranges:
        margin = 0.03 * (high - low)
        assert ((values >= low) & (values <= high)).all()
        assert (values.min(0) < low + margin).all()
        assert (values.max(0) > high - margin).all()
    together = np.concatenate([values for values, _, _ in ranges], axis=1)
    assert np.abs(np.corrcoef(together.T) - np.identity(6)).max() < 0.2, "drawn independently"

    step = jax.jit(jax.vmap(lambda nav: env.advance(nav, jnp.zeros(2))[0]))
    first = jax.tree.map(lambda x: x[:8], drawn)
    after = step(first)
    np.testing.assert_array_equal(after.appearance_seed, first.appearance_seed)
    observe = jax.jit(jax.vmap(env.observe))
    a, again, b = (np.asarray(observe(nav)[PIXELS], int) for nav in (first, first, after))
    np.testing.assert_array_equal(a, again, "a state has one image")
    assert (np.abs(a - b).mean((1, 2, 3)) > 0.2).any(), "the noise differs between steps"
    plain = unicycle_env(small_bank, {"randomization": OFF}, vision=True)
    clean = for_scoring(env, small_bank)
    expected = np.asarray(jax.jit(jax.vmap(plain.observe))(first)[PIXELS])
    np.testing.assert_array_equal(jax.jit(jax.vmap(clean.observe))(first)[PIXELS], expected, "not while scoring")
    assert (np.abs(a - expected).mean((1, 2, 3)) > 1.0).mean() > 0.7


def test_a_command_is_obeyed_after_its_latency(small_bank: SceneBank) -> None:
    """The robot of the tests obeys at once, so its path in a step says what it was told."""
    waits = {"randomization": OFF, "randomization.latency": (0.06, 0.06), "action_mode": "velocity"}
    env, plain = (unicycle_env(small_bank, {**waits, **x}) for x in ({}, {"randomization.latency": (0.0, 0.0)}))
    key = jax.random.key(0)
    start = jax.jit(env.begin)(key)
    full = jnp.array([1.0, 0.0])
    path = []
    for one in (env, plain):
        state, advance = start, jax.jit(one.advance)
        for _ in range(3):
            state = advance(state, full)[0]
            path.append(float(state.driven))
    step = plain.dt * plain.robot.max_speed
    np.testing.assert_allclose(path[3:], [step, 2 * step, 3 * step], rtol=1e-4)
    # An action of zero in this mode is half the speed; it holds for the first 0.06 s.
    share = 0.06 / plain.dt
    first = step * (1.0 - 0.5 * share)
    np.testing.assert_allclose(path[:3], [first, first + step, first + 2 * step], rtol=1e-4)

    env, drawn = unicycle_env(small_bank, {"randomization.latency": (0.05, 0.2)}), None
    drawn = jax.jit(jax.vmap(env.begin))(jax.random.split(key, 500)).appearance_seed
    latency = np.asarray(jax.vmap(env._randomization.latency)(drawn))
    assert 0.05 <= latency.min() < 0.06
    assert 0.19 < latency.max() <= 0.2


def test_policies_from_before_this_load() -> None:
    new = {*CAMERA_NOISE, "latency"}
    older = ConfigDict({name: x for name, x in OFF.items() if name not in new})
    drawn = Randomization(older, 0.2)
    assert drawn.camera_noise(jnp.int32(3)) is None
    assert drawn.latency(jnp.int32(3)) is None
    config = registry.get_default_config("CocoNav").to_dict()
    config["randomization"] = older.to_dict()
    changed = registry.with_overrides(ConfigDict(config), {"randomization.pixel_noise": 0.02})
    assert changed.randomization.pixel_noise == 0.02


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("exposure", -1.0),
        ("white_balance", 1.0),
        ("blur", 2.0),
        ("pixel_noise", -0.1),
        ("latency", (0.1, 0.05)),
        ("latency", (0.0, 0.25)),
        ("latency", (-0.1, 0.1)),
    ],
)
def test_bad_values_are_refused(small_bank: SceneBank, name: str, value: Any) -> None:
    with pytest.raises(ValidationError, match=name):
        unicycle_env(small_bank, {f"randomization.{name}": value})
