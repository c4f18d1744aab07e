"""Common parts of learning from sequences of camera images: mirroring, lighting, and epochs over minibatches.

Half of the envs are seen in a mirror: image, goal, speeds and labels are flipped left to right, and the student's
action is flipped back before it drives. Streets and their mirror images are equally likely, so this doubles them.
"""

import time
from collections.abc import Callable, Mapping
from typing import Any, Protocol

import jax
import jax.numpy as jnp
import optax

from .map_networks import MAP_SHAPE
from .networks import PIXELS
from .student import predicted_target

#: The action (x, y) of a navigating robot changes the sign of its second component in a mirror.
LATERAL_ACTION = (1,)
#: (params, minibatch (T, rows, ...), memory (rows, memory), key) -> (loss, what to report).
Loss = Callable[[Any, Any, jax.Array, jax.Array], tuple[jax.Array, Any]]


def mirror_lateral(values: jax.Array, mirrored: jax.Array, lateral: tuple[int, ...]) -> jax.Array:
    """Values (n, k) with the components `lateral` of the envs `mirrored` (n,) negated."""
    sign = jnp.ones(values.shape[-1]).at[jnp.array(lateral)].set(-1.0)
    return jnp.where(mirrored[:, None], values * sign, values)


def mirrored_view(obs: Mapping[str, jax.Array], mirrored: jax.Array) -> dict[str, jax.Array]:
    """`SEEN` of n envs as the student's inputs; proprio is (forward, lateral, yaw rate, action x, action y)."""
    wide = mirrored[:, None, None, None]
    return {
        PIXELS: jnp.where(wide, obs[PIXELS][:, :, ::-1], obs[PIXELS]),
        "goal": mirror_lateral(obs["goal"], mirrored, (1,)),
        "proprio": mirror_lateral(obs["proprio"], mirrored, (1, 2, 4)),
    }


def blurred(x: jax.Array, strength: jax.Array) -> jax.Array:
    """Images (T, n, H, W, 3) of a float type, mixed with their binomial blur over 3 x 3 pixels; strength: (n,) in
    [0, 1], 1 = the blurred image alone."""
    soft = x
    for axis in (2, 3):
        first, last = jnp.take(soft, jnp.array([0]), axis), jnp.take(soft, jnp.array([-1]), axis)
        wide = jnp.concatenate([first, soft, last], axis)
        size = soft.shape[axis]
        parts = [jax.lax.slice_in_dim(wide, k, k + size, axis=axis) for k in range(3)]
        soft = 0.25 * parts[0] + 0.5 * parts[1] + 0.25 * parts[2]
    share = strength.astype(x.dtype)[:, None, None, None]
    return x + share * (soft - x)


def relit(pixels: jax.Array, key: jax.Array, light: float, noise: float, blur: float = 0.0) -> jax.Array:
    """Images (T, n, H, W, 3) u8 with another exposure, contrast, colour and sharpness for each of the n sequences.

    Args:
      light: share by which brightness and colour differ at most.
      noise: standard deviation of each pixel, of the full range.
      blur: the strongest `blurred`.
    """
    if light == 0.0 and noise == 0.0 and blur == 0.0:
        return pixels
    n = pixels.shape[1]
    keys = jax.random.split(key, 3)
    gain = 1.0 + light * jax.random.uniform(keys[0], (n, 1, 1, 3), minval=-1.0, maxval=1.0)
    gain = gain * (1.0 + light * jax.random.uniform(keys[1], (n, 1, 1, 1), minval=-1.0, maxval=1.0))
    x = pixels.astype(jnp.bfloat16) * gain.astype(jnp.bfloat16)
    if blur:
        x = blurred(x, blur * jax.random.uniform(jax.random.fold_in(key, 3), (n,)))
    x = x + (255.0 * noise) * jax.random.normal(keys[2], pixels.shape, jnp.bfloat16)
    return jnp.clip(x, 0.0, 255.0).astype(jnp.uint8)


def mirrored_target(distances: jax.Array, mirrored: jax.Array) -> jax.Array:
    """`privileged_map` (n, 640) u8 of n envs -> the map to predict (n, *PREDICTED), flipped for the envs `mirrored`."""
    cells = distances.reshape(-1, *MAP_SHAPE)
    # The second axis of the map runs from right to left.
    return predicted_target(jnp.where(mirrored[:, None, None, None], cells[:, :, ::-1], cells))


def epochs(
    loss: Loss,
    optimizer: optax.GradientTransformation,
    start: tuple[Any, Any],
    batch: Any,
    memory: jax.Array,
    key: jax.Array,
    rate: Any,
    count: int,
    parts: int,
) -> tuple[tuple[Any, Any], Any]:
    """Passes over the sequences of a rollout, each cut at random into minibatches of whole sequences.

    Args:
      start: (parameters, optimizer state).
      batch: a pytree of (T, n, ...).
      memory: (n, memory) at its first step.
      rate: factor of the optimizer's update: a number, or a prefix pytree of the parameters.
      count: passes.
      parts: minibatches of a pass; divides n.

    Returns:
      (parameters, optimizer state), and the mean of the loss's metrics.
    """
    n = memory.shape[0]

    def epoch(carry: Any, key: jax.Array) -> Any:
        key_order, key_loss = jax.random.split(key)
        rows = jax.random.permutation(key_order, n).reshape(parts, -1)

        def update(carry: Any, inputs: Any) -> Any:
            params, state = carry
            chosen, key = inputs
            part = jax.tree.map(lambda x: jnp.take(x, chosen, axis=1), batch)
            grads, reported = jax.grad(loss, has_aux=True)(params, part, memory[chosen], key)
            change, state = optimizer.update(grads, state, params)
            change = jax.tree.map(lambda r, part: jax.tree.map(lambda x: -r * x, part), rate, change)
            return (optax.apply_updates(params, change), state), reported

        return jax.lax.scan(update, carry, (rows, jax.random.split(key_loss, parts)))

    end, reported = jax.lax.scan(epoch, start, jax.random.split(key, count))
    return end, jax.tree.map(jnp.mean, reported)


class Learner(Protocol):
    """An algorithm that iterates: `dagger.Dagger`, `finetune.Finetune`."""

    def iterate(self, state: Any, progress: jax.Array) -> tuple[Any, dict[str, jax.Array]]:
        """The state after another iteration, whose buffers the old one gives up, and what happened in it."""
        ...


def run(
    learner: Learner,
    iterations: int,
    seconds: float,
    on_iteration: Callable[[int, Any, dict[str, float]], None],
    state: Any,
) -> Any:
    """Iterates until `iterations` are done or `seconds` of wall time are over; calls back after each.

    Args:
      state: the learner's initial one. Its `steps` count towards `iterations`.

    With a limit of seconds that is reached, the learning rate follows the clock, and no two runs are the same.
    """
    begin = time.monotonic()
    for number in range(int(state.steps) + 1, iterations + 1):
        progress = max((number - 1) / iterations, (time.monotonic() - begin) / seconds)
        if progress >= 1.0:
            break
        state, reported = learner.iterate(state, jnp.float32(progress))
        on_iteration(number, state, {name: float(x) for name, x in reported.items()})
    return state
