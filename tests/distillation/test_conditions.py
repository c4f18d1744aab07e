"""Hard conditions of training images, and the parts of the loss that belong to them and to whole objects."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from urbanverse_mjx.distillation.perception_model import classes, conditions
from urbanverse_mjx.distillation.perception_model.augment import blur, recolour
from urbanverse_mjx.distillation.perception_model.network import Seen
from urbanverse_mjx.distillation.perception_model.targets import (
    _SLOTS,
    GroundTruth,
    _at,
    _object_loss,
    _object_means,
    loss,
    without,
)

CAR = classes.names().index("car")


@pytest.fixture(scope="module")
def scene() -> np.ndarray:
    rng = np.random.default_rng(0)
    smooth = jax.image.resize(rng.random((4, 6, 3)).astype(np.float32), (64, 96, 3), "cubic")
    return np.asarray(jnp.clip(smooth, 0.0, 1.0) * 255).astype(np.uint8)


def test_every_condition_gives_an_image_of_the_same_street(scene: np.ndarray):
    x = jnp.asarray(scene, jnp.float32) / 255.0
    for name in ("shadows", "light", "style", "night", "haze", "rain", "flare", "shake", "grey"):
        change = getattr(conditions, f"_{name}")
        other = np.asarray(jnp.clip(change(jax.random.key(1), x), 0.0, 1.0))
        assert np.isfinite(other).all()
        assert np.abs(other - np.asarray(x)).mean() > 0.002, name
        assert np.corrcoef(other.mean(-1).ravel(), scene.mean(-1).ravel())[0, 1] > 0.35, name
    grey = np.asarray(conditions._grey(jax.random.key(2), x))
    assert np.ptp(grey, axis=-1).max() < 1e-6
    assert np.asarray(conditions._night(jax.random.key(2), x)).mean() < 0.7 * np.asarray(x).mean()


def test_a_soft_image_has_less_detail_and_the_same_mean():
    x = jnp.asarray(np.random.default_rng(3).random((64, 96, 3)), jnp.float32)
    soft = np.asarray(conditions._soft(jax.random.key(1), x))
    assert soft.std() < 0.7 * np.asarray(x).std()
    assert soft.mean() == pytest.approx(float(x.mean()), abs=0.01)


def test_rain_falls_in_streaks():
    """On a black image only streaks are seen, and they are longer than wide."""
    x = jnp.zeros((64, 96, 3))
    streaks = np.asarray(conditions._rain(jax.random.key(4), x))[..., 0] > 0.0
    assert 0.005 < streaks.mean() < 0.2
    along = (streaks[1:] & streaks[:-1]).sum()
    across = (streaks[:, 1:] & streaks[:, :-1]).sum()
    assert along > 1.5 * across


@pytest.mark.extended
def test_a_bonnet_hides_the_lower_border_and_half_of_the_images_stay_as_they_are(scene: np.ndarray):
    keys = jax.random.split(jax.random.key(0), 64)
    images, hidden = jax.jit(jax.vmap(conditions.vary, (0, None)))(keys, jnp.asarray(scene))
    images, hidden = np.asarray(images), np.asarray(hidden)
    assert images.min() >= 0.0
    assert images.max() <= 1.0
    same = (np.abs(images - scene / np.float32(255.0)).max((1, 2, 3)) < 1e-6).mean()
    assert 0.3 < same < 0.8
    present = hidden.any((1, 2))
    assert 0.0 < present.mean() < 0.3
    assert not hidden[:, :40].any()
    assert hidden[present][:, -1].mean() > 0.5


def test_blur_keeps_the_light_and_spreads_along_its_axis():
    point = jnp.zeros((21, 31, 3)).at[10, 15].set(1.0)
    spread = np.asarray(blur(point, jnp.array([2.0, 0.2])))[..., 0]
    assert spread.sum() == pytest.approx(1.0, abs=1e-4)
    assert spread[:, 15].sum() == pytest.approx(1.0, abs=1e-3)
    assert spread[8, 15] == pytest.approx(spread[12, 15])
    assert spread[10, 15] < 0.3


def test_some_regions_lose_their_contrast_and_none_gains():
    rng = np.random.default_rng(0)
    image = jnp.asarray(rng.integers(90, 160, (20, 40, 3)), jnp.uint8)
    region = jnp.asarray(np.repeat(np.arange(40), 20).reshape(40, 20).T)
    table = []
    for seed in range(4):
        dyed = np.asarray(recolour(jax.random.key(seed), image, region, 40)).astype(float)
        # Brightness alone: hue and saturation change too.
        table.append(dyed.mean(-1).std(0) / dyed.mean(-1).mean(0))
    before = np.asarray(image).astype(float).mean(-1)
    ratio = np.concatenate(table) / np.tile(before.std(0) / before.mean(0), 4)
    assert 0.2 < (ratio < 0.9).mean() < 0.7
    assert (ratio < 0.1).any()


def _frame(owner: np.ndarray) -> GroundTruth:
    shape = owner.shape
    kinds = np.where(owner >= 0, CAR, 1)
    ones, none = np.ones(shape, np.float32), np.zeros(shape, bool)
    parts = (kinds, np.full(shape, -1), ones, owner, 0 * ones, ones, np.zeros((*shape, 2)), none, 0 * ones, none)
    return GroundTruth(*(jnp.asarray(x)[None] for x in parts))


def test_the_mean_over_objects_counts_a_small_one_as_much_as_a_large_one():
    owner = np.full((20, 40), -1)
    owner[2:18, 2:20], owner[5:9, 30:34] = 0, 1
    wanted = _frame(owner)

    def cost(wrong: int) -> float:
        right = jnp.where(wanted.owner == wrong, 0.1, 0.9)
        return float(
            _object_loss(jnp.log(_spread(right, wanted.classes)), wanted, jnp.ones(1), jnp.ones(len(classes.names())))
        )

    expected = -(np.log(0.1) + np.log(0.9)) / 2.0
    assert cost(0) == pytest.approx(expected, abs=1e-4)
    assert cost(1) == pytest.approx(expected, abs=1e-4)


def test_means_of_objects_and_their_gradient_are_those_of_floats_without_a_scatter_of_floats():
    """A scatter of floats in the loss or its gradient makes XLA sort where it has to be deterministic."""
    rng = np.random.default_rng(3)
    number = jnp.asarray(rng.choice([0, 1, 5, _SLOTS], 4000, p=[0.6, 0.01, 0.2, 0.19]), jnp.int32)
    p, kinds = jnp.asarray(rng.random(4000), jnp.float32), jnp.asarray(rng.integers(0, 7, 4000))
    size = jnp.asarray(np.bincount(number, minlength=_SLOTS + 1)[:-1], jnp.float32)

    def floats(x: jax.Array) -> jax.Array:
        return jax.ops.segment_sum(x, number, _SLOTS + 1)[:-1] / jnp.maximum(size, 1.0)

    def cost(means, x: jax.Array) -> jax.Array:
        return -jnp.log(jnp.maximum(means(x), 0.3)).sum()

    found, slope = jax.value_and_grad(lambda x: cost(lambda y: _object_means(y, number, size), x))(p)
    wanted, true_slope = jax.value_and_grad(lambda x: cost(floats, x))(p)
    assert found == pytest.approx(float(wanted), rel=1e-4)
    np.testing.assert_allclose(slope, true_slope, rtol=1e-3)
    values = jnp.asarray(rng.normal(size=(4000, 7)), jnp.float32)
    np.testing.assert_array_equal(_at(values, kinds), np.asarray(values)[np.arange(4000), kinds])

    def both(x: jax.Array) -> jax.Array:
        return cost(lambda y: _object_means(y, number, size), jax.nn.sigmoid(_at(x, kinds)))

    text = jax.jit(jax.grad(both)).lower(values).as_text()
    scatters = [line for line in text.splitlines() if "stablehlo.scatter" in line]
    assert len(scatters) == 1
    assert text.count("stablehlo.add") >= 1
    assert "tensor<1025xi32>" in text


def _spread(right: jax.Array, kinds: jax.Array) -> jax.Array:
    """(..., C) probabilities with `right` for the class of `kinds`, the rest spread over all others."""
    count = len(classes.names())
    mine = jax.nn.one_hot(kinds, count)
    return mine * right[..., None] + (1.0 - mine) * (1.0 - right[..., None]) / (count - 1)


def test_hidden_pixels_have_no_part_in_the_loss():
    owner = np.full((20, 40), -1)
    owner[10:18, 4:20] = 0
    hidden = jnp.asarray(np.arange(20)[:, None] >= 8)[None] & jnp.ones((1, 20, 40), bool)
    wanted = without(_frame(owner)._replace(has_depth=jnp.ones((1, 20, 40), bool)), hidden)
    rng = np.random.default_rng(0)

    def cost(noise: np.ndarray) -> dict[str, float]:
        at = jnp.asarray(np.where(np.asarray(hidden)[..., None], noise, 0.0))
        logits = at * jnp.arange(len(classes.names()))
        leaves = at[:, ::2, ::2] * jnp.arange(len(classes.leaves()))
        seen = Seen(logits, at[..., 0], jnp.tile(at, 2), at[..., 0], leaves)
        return {name: float(x) for name, x in loss(seen, wanted, jnp.ones(1))[1].items()}

    quiet, loud = cost(np.zeros((1, 20, 40, 1))), cost(rng.normal(size=(1, 20, 40, 1)))
    assert loud == pytest.approx(quiet)
