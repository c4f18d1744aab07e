"""Networks: every form of the convolution is flax's convolution, and the factory fits Brax."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from flax import linen as nn

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.training.networks import CONVOLUTIONS, Encoder, convolution_of, goal_features, make_networks

SIZES = {"pixels/front": (27, 48, 3), "goal": (2,), "privileged": (13,)}
LAYERS = ((16, 4, 4), (32, 2, 2), (64, 2, 1))


@pytest.mark.parametrize(("kernel", "stride"), [(8, 4), (4, 2), (4, 4), (3, 1), (2, 1), (1, 1)])
@pytest.mark.parametrize("shape", [(27, 48), (36, 64), (17, 19)])
@pytest.mark.parametrize("form", CONVOLUTIONS)
def test_every_convolution_equals_flax(form: str, kernel: int, stride: int, shape: tuple[int, int]) -> None:
    x = jax.random.normal(jax.random.key(0), (2, *shape, 3))
    conv = nn.Conv(5, (kernel, kernel), (stride, stride), padding="VALID")
    params: Any = conv.init(jax.random.key(1), x)
    w, b = params["params"]["kernel"], params["params"]["bias"] + 0.3
    wanted: Any = conv.apply({"params": {"kernel": w, "bias": b}}, x)
    got = convolution_of(form)(x, w, b, stride)
    assert got.shape == wanted.shape
    np.testing.assert_allclose(got, wanted, atol=2e-5)


@pytest.mark.parametrize(("device", "form"), [("cpu", "matmul"), ("gpu", "blocks")])
def test_automatic_convolution_is_the_faster_one(device: str, form: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """As measured in benchmarks/convolutions.py."""
    monkeypatch.setattr(jax, "default_backend", lambda: device)
    assert convolution_of("auto") is convolution_of(form)


@pytest.mark.parametrize("form", CONVOLUTIONS)
def test_gradients_equal_flax(form: str) -> None:
    x = jax.random.normal(jax.random.key(0), (2, 27, 48, 3))
    w = jax.random.normal(jax.random.key(1), (8, 8, 3, 4))

    def ours(w: jax.Array) -> jax.Array:
        return (convolution_of(form)(x, w, jnp.zeros(4), 4) ** 2).mean()

    def flax(w: jax.Array) -> jax.Array:
        dims = jax.lax.conv_dimension_numbers(x.shape, w.shape, ("NHWC", "HWIO", "NHWC"))
        return (jax.lax.conv_general_dilated(x, w, (4, 4), "VALID", dimension_numbers=dims) ** 2).mean()

    np.testing.assert_allclose(jax.grad(ours)(w), jax.grad(flax)(w), rtol=1e-3, atol=1e-4)


@pytest.mark.parametrize("critic_sees", ["pixels", "privileged"])
@pytest.mark.parametrize("lead", [(), (3,), (4, 3)])
def test_factory_takes_any_leading_axes(critic_sees: str, lead: tuple[int, ...]) -> None:
    nets = make_networks(SIZES, 2, layers=LAYERS, critic_sees=critic_sees)
    policy = jax.eval_shape(nets.policy_network.init, jax.random.key(0))
    value = jax.eval_shape(nets.value_network.init, jax.random.key(1))
    obs = {k: jnp.ones((*lead, *s), jnp.uint8 if k.startswith("pixels") else jnp.float32) for k, s in SIZES.items()}
    assert jax.eval_shape(nets.policy_network.apply, None, policy, obs).shape == (*lead, 4)
    assert jax.eval_shape(nets.value_network.apply, None, value, obs).shape == lead


def test_policy_sees_pixels_and_where_they_are() -> None:
    nets = make_networks(SIZES, 2, layers=LAYERS)
    params = jax.jit(nets.policy_network.init)(jax.random.key(0))
    obs = {
        "pixels/front": jnp.zeros((27, 48, 3), jnp.uint8),
        "goal": jnp.array([10.0, 0.0]),
        "privileged": jnp.zeros(13),
    }
    left = obs["pixels/front"].at[8:16, 4:12].set(255)
    right = obs["pixels/front"].at[8:16, 36:44].set(255)
    apply = jax.jit(nets.policy_network.apply)
    outs = [apply(None, params, {**obs, "pixels/front": p}) for p in (left, right)]
    # A pooled network could not tell the same blob on the left from one on the right.
    assert float(jnp.abs(outs[0] - outs[1]).max()) > 1e-6


def test_asymmetric_critic_has_no_cnn_and_the_policy_no_privileges() -> None:
    nets = make_networks(SIZES, 2, layers=LAYERS, critic_sees="privileged")
    names = {
        jax.tree_util.keystr(path)
        for path, _ in jax.tree_util.tree_leaves_with_path(jax.eval_shape(nets.value_network.init, jax.random.key(0)))
    }
    assert not any("encoder" in name for name in names)
    names = {
        jax.tree_util.keystr(path)
        for path, _ in jax.tree_util.tree_leaves_with_path(jax.eval_shape(nets.policy_network.init, jax.random.key(0)))
    }
    assert not any("privileged" in name for name in names)


def test_goal_features_are_finite_at_the_goal_with_finite_gradients() -> None:
    grad = jax.grad(lambda g: goal_features(g).sum())(jnp.zeros(2))
    assert np.isfinite(np.asarray(goal_features(jnp.zeros(2)))).all()
    del grad  # the goal is an observation: no gradient is taken with respect to it


def test_both_convolutions_give_the_same_network() -> None:
    """A policy trained on a GPU acts the same on a CPU."""
    obs = {
        "pixels/front": jax.random.randint(jax.random.key(2), (3, 27, 48, 3), 0, 256).astype(jnp.uint8),
        "goal": jnp.array([[10.0, 0.0], [3.0, -2.0], [0.1, 0.2]]),
    }
    params = jax.jit(make_networks(SIZES, 2, layers=LAYERS).policy_network.init)(jax.random.key(0))
    outputs = [
        jax.jit(make_networks(SIZES, 2, layers=LAYERS, convolution=name).policy_network.apply)(None, params, obs)
        for name in ("matmul", "xla")
    ]
    np.testing.assert_allclose(*outputs, atol=1e-5)
    with pytest.raises(ValidationError, match="convolution"):
        make_networks(SIZES, 2, convolution="winograd").policy_network.init(jax.random.key(0))


def test_an_image_too_small_for_its_layers_is_refused() -> None:
    """Otherwise the policy would be trained without its camera, and could not be saved."""
    make = lambda height, width: jax.eval_shape(  # noqa: E731
        Encoder(((8, 4, 2), (8, 4, 2), (8, 4, 2))).init, jax.random.key(0), jnp.zeros((1, height, width, 3), jnp.uint8)
    )
    make(22, 22)
    with pytest.raises(
        ValidationError, match=r"found an image of 18 x 32 pixels, of which layer 3 of 3 leaves nothing"
    ):
        make(18, 32)
