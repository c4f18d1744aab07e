"""The paper's networks for Brax PPO: convolutions of 16/32/64 channels on the image, an MLP on the goal, 3 x 128 ELU.

Pixels are uint8 and are scaled only here. On a CPU, convolutions are computed by space-to-depth and matrix products,
because the gradients of XLA's CPU convolutions are 13-20 times slower inside `lax.scan`, where Brax runs SGD
(docs/sources/brax_over_warp.md, Q2). The results equal those of `flax.linen.Conv` with the same parameters.
"""

import functools
from collections.abc import Callable, Sequence
from typing import Any

import jax
import jax.numpy as jnp
from brax.training import distribution, networks, types
from brax.training.agents.ppo import networks as ppo_networks
from flax import linen as nn

from ..datatypes import ValidationError

PIXELS = "pixels/front"
Convolution = Callable[[jax.Array, jax.Array, jax.Array, int], jax.Array]


def _space_to_depth(x: jax.Array, block: int) -> jax.Array:
    """(n, H, W, C) -> (n, H/b, W/b, b*b*C); rows and columns beyond a whole block are cut."""
    n, height, width, channels = x.shape
    h, w = height // block, width // block
    x = x[:, : h * block, : w * block].reshape(n, h, block, w, block, channels)
    return x.transpose(0, 1, 3, 2, 4, 5).reshape(n, h, w, block * block * channels)


def _in_blocks(kernel: jax.Array, stride: int) -> jax.Array:
    """The kernel (k, k, C, D) of a convolution as that of the same one on `_space_to_depth`: (k/s, k/s, s*s*C, D)."""
    k, _, channels, depth = kernel.shape
    taps = k // stride
    w = kernel.reshape(taps, stride, taps, stride, channels, depth)
    return w.transpose(0, 2, 1, 3, 4, 5).reshape(taps, taps, stride * stride * channels, depth)


def conv_by_matmul(x: jax.Array, kernel: jax.Array, bias: jax.Array, stride: int) -> jax.Array:
    """VALID convolution of (n, H, W, C) with (k, k, C, D); k must be a multiple of the stride.

    Equal to `lax.conv_general_dilated` up to rounding.
    """
    x, w = _space_to_depth(x, stride), _in_blocks(kernel, stride)
    taps = w.shape[0]
    rows, columns = x.shape[1] - taps + 1, x.shape[2] - taps + 1
    patches = [x[:, i : i + rows, j : j + columns] for i in range(taps) for j in range(taps)]
    stacked = jnp.concatenate(patches, axis=-1) if taps > 1 else x
    return stacked @ w.reshape(-1, kernel.shape[-1]) + bias


def conv_by_blocks(x: jax.Array, kernel: jax.Array, bias: jax.Array, stride: int) -> jax.Array:
    """The same convolution by XLA's own with stride 1 on blocks of pixels.

    cuDNN is slow with three channels and large strides: an update of the paper's two networks takes 0.4 times as long
    in this form (docs/performance.md).
    """
    return conv_by_xla(_space_to_depth(x, stride), _in_blocks(kernel, stride), bias, 1)


def conv_by_xla(x: jax.Array, kernel: jax.Array, bias: jax.Array, stride: int) -> jax.Array:
    """The same convolution by XLA, which uses cuDNN on a GPU."""
    # The other forms cut incomplete blocks, which a VALID convolution never reads.
    numbers = ("NHWC", "HWIO", "NHWC")
    return jax.lax.conv_general_dilated(x, kernel, (stride, stride), "VALID", dimension_numbers=numbers) + bias


_FORMS: dict[str, Convolution] = {"matmul": conv_by_matmul, "blocks": conv_by_blocks, "xla": conv_by_xla}
CONVOLUTIONS = ("auto", *_FORMS)


def convolution_of(name: str) -> Convolution:
    """ "matmul", "blocks", "xla", or "auto": matmul on the CPU, blocks elsewhere."""
    if name not in CONVOLUTIONS:
        raise ValidationError(f"ppo.network.convolution: found {name!r}, needed one of {CONVOLUTIONS}.")
    if name == "auto":
        name = "matmul" if jax.default_backend() == "cpu" else "blocks"
    return _FORMS[name]


class Encoder(nn.Module):
    """Conv layers with ReLU, flattened, without pooling, to keep the positions of objects.

    Attributes:
      layers: (depth, kernel, stride) of each layer; kernel is a multiple of stride.
      dtype: of the arithmetic; parameters are float32.
      convolution: see `convolution_of`; all compute the same.
    """

    layers: Sequence[tuple[int, int, int]]
    dtype: Any = jnp.float32
    convolution: str = "auto"

    @nn.compact
    def __call__(self, pixels: jax.Array) -> jax.Array:
        """(..., H, W, C) uint8 -> (..., n) float32.

        Raises:
          ValidationError: an image that is too small for the layers.
        """
        lead = pixels.shape[:-3]
        x = pixels.reshape((-1, *pixels.shape[-3:])).astype(self.dtype) / 255.0 - 0.5
        convolve = convolution_of(self.convolution)
        for i, (depth, k, stride) in enumerate(self.layers):
            init = nn.initializers.lecun_uniform()
            kernel = self.param(f"kernel_{i}", init, (k, k, x.shape[-1], depth))
            bias = self.param(f"bias_{i}", nn.initializers.zeros_init(), (depth,))
            x = nn.relu(convolve(x, kernel.astype(self.dtype), bias.astype(self.dtype), stride))
            if 0 in x.shape[1:3]:
                height, width, _ = pixels.shape[-3:]
                raise ValidationError(
                    f"network.layers: found an image of {height} x {width} pixels, of which layer {i + 1} of "
                    f"{len(self.layers)} leaves nothing, needed a larger one, or fewer layers or smaller strides."
                )
        return x.reshape((*lead, -1)).astype(jnp.float32)


def goal_features(goal: jax.Array) -> jax.Array:
    """Features (..., 5) of a goal (..., 2) m in the heading frame: the goal in units of 10 m, its direction, and its
    nearness at a scale of 1 m; a vector of another size, such as that of a phrase, as it is."""
    if goal.shape[-1] != 2:
        return goal
    # `jnp.linalg.norm` by operations that ONNX supports.
    distance = jnp.sqrt((goal * goal).sum(-1, keepdims=True))
    direction = goal / jnp.maximum(distance, 1e-3)
    return jnp.concatenate([goal / 10.0, direction, jnp.exp(-distance)], axis=-1)


class Trunk(nn.Module):
    """Pixels and goal to features: conv encoder and goal MLP, then 3 x 128 ELU."""

    layers: Sequence[tuple[int, int, int]]
    hidden: Sequence[int] = (128, 128, 128)
    goal_hidden: int = 32
    dtype: Any = jnp.float32
    convolution: str = "auto"

    @nn.compact
    def __call__(self, pixels: jax.Array | None, goal: jax.Array) -> jax.Array:
        x = nn.elu(nn.Dense(self.goal_hidden, name="goal")(goal_features(goal)))
        if pixels is not None:
            seen = Encoder(self.layers, self.dtype, self.convolution, name="encoder")(pixels)
            x = jnp.concatenate([nn.Dense(self.hidden[0], name="seen")(seen), x], axis=-1)
        for i, size in enumerate(self.hidden):
            x = nn.elu(nn.Dense(size, name=f"hidden_{i}")(x))
        return x


class Actor(nn.Module):
    """Mean by the trunk, and a separate standard deviation per action (paper: constant, initialised at 0)."""

    trunk: Trunk
    action_size: int

    @nn.compact
    def __call__(self, pixels: jax.Array | None, goal: jax.Array) -> jax.Array:
        x = self.trunk(pixels, goal)
        mean = nn.Dense(
            self.action_size, name="mean", kernel_init=nn.initializers.variance_scaling(0.01, "fan_in", "normal")
        )(x)
        std = self.param("std", nn.initializers.zeros_init(), (self.action_size,))
        return jnp.concatenate([mean, jnp.broadcast_to(std, mean.shape)], axis=-1)


class Critic(nn.Module):
    """Value of a state; from the actor's observations, and privileged values if given."""

    trunk: Trunk
    privileged: bool

    @nn.compact
    def __call__(self, pixels: jax.Array | None, goal: jax.Array, privileged: jax.Array) -> jax.Array:
        x = self.trunk(pixels, goal)
        if self.privileged:
            # Scales metres to about one; the other values are of order one.
            y = jnp.concatenate([privileged[..., :6] / 10.0, privileged[..., 6:]], axis=-1)
            x = jnp.concatenate([x, nn.elu(nn.Dense(64, name="privileged")(y))], axis=-1)
            x = nn.elu(nn.Dense(128, name="joint")(x))
        return nn.Dense(1, name="value")(x)[..., 0]


def make_networks(
    observation_size: types.ObservationSize,
    action_size: int,
    preprocess_observations_fn: types.PreprocessObservationFn = types.identity_observation_preprocessor,
    layers: Sequence[tuple[int, int, int]] = ((16, 8, 4), (32, 4, 2), (64, 4, 2)),
    critic_sees: str = "pixels",
    bfloat16: bool = False,
    convolution: str = "auto",
) -> ppo_networks.PPONetworks:
    """Brax's network factory for `NavEnv`.

    Args:
      observation_size: shapes by name.
      action_size: 2, or the number of actuators with action_mode="joint".
      preprocess_observations_fn: unused, because goals and pixels have fixed scales.
      layers: (depth, kernel, stride) of the conv layers.
      critic_sees: "pixels" (as the actor, like the paper) or "privileged" (without a second CNN).
      bfloat16: whether convolutions compute in bfloat16; heads always use float32.
      convolution: see `convolution_of`.
    """
    del preprocess_observations_fn
    sizes = dict(observation_size)  # type: ignore[arg-type]
    dtype = jnp.bfloat16 if bfloat16 else jnp.float32
    has_pixels = PIXELS in sizes

    def pixels_of(obs: Any) -> Any:
        return obs[PIXELS] if has_pixels else None

    trunk = functools.partial(Trunk, layers=tuple(layers), dtype=dtype, convolution=convolution)
    actor = Actor(trunk(), action_size)
    critic = Critic(trunk(), critic_sees == "privileged")
    critic_pixels = pixels_of if critic_sees == "pixels" else (lambda obs: None)
    dummy = {k: jnp.zeros((1, *s), jnp.uint8 if k.startswith("pixels/") else jnp.float32) for k, s in sizes.items()}
    policy = networks.FeedForwardNetwork(
        init=lambda key: actor.init(key, pixels_of(dummy), dummy["goal"]),
        apply=lambda _, params, obs: actor.apply(params, pixels_of(obs), obs["goal"]),
    )
    value = networks.FeedForwardNetwork(
        init=lambda key: critic.init(key, critic_pixels(dummy), dummy["goal"], dummy["privileged"]),
        apply=lambda _, params, obs: critic.apply(params, critic_pixels(obs), obs["goal"], obs["privileged"]),
    )
    return ppo_networks.PPONetworks(
        policy_network=policy,
        value_network=value,
        parametric_action_distribution=distribution.NormalTanhDistribution(event_size=action_size),
    )
