"""Common parts of learning from sequences of camera images: mirroring, photometric augmentation, and minibatch epochs.

The observations of half of the envs are mirrored: image, goal, speeds and labels are flipped left to right, and the
student's action is flipped back. Streets and their mirror images are equally likely, so this doubles the data.
"""

import time
from collections.abc import Callable, Mapping
from typing import Any, Protocol

import jax
import jax.numpy as jnp
import optax

from ..envs.navigation.camera_noise import blurred
from .devices import ALONE, Devices
from .map_networks import MAP_SHAPE
from .networks import PIXELS
from .student import predicted_target

#: Components of the action (x, y) whose sign changes when mirrored.
LATERAL_ACTION = (1,)
#: Loss function (params, minibatch (T, rows, ...), memory (rows, memory), key) -> (loss, metrics).
Loss = Callable[[Any, Any, jax.Array, jax.Array], tuple[jax.Array, Any]]


def mirror_lateral(values: jax.Array, mirrored: jax.Array, lateral: tuple[int, ...]) -> jax.Array:
    """Negates the components `lateral` of values (n, k) for the envs `mirrored` (n,)."""
    sign = jnp.ones(values.shape[-1]).at[jnp.array(lateral)].set(-1.0)
    return jnp.where(mirrored[:, None], values * sign, values)


def mirrored_view(obs: Mapping[str, jax.Array], mirrored: jax.Array) -> dict[str, jax.Array]:
    """`SEEN` of n envs as the student's inputs; proprio is (forward, lateral, yaw rate, action x, action y)."""
    wide = mirrored[:, None, None, None]
    return {
        PIXELS: jnp.where(wide, obs[PIXELS][:, :, ::-1], obs[PIXELS]),
        # The vector of a phrase is the same in a mirror.
        "goal": mirror_lateral(obs["goal"], mirrored, (1,)) if obs["goal"].shape[-1] == 2 else obs["goal"],
        "proprio": mirror_lateral(obs["proprio"], mirrored, (1, 2, 4)),
    }


def relit(pixels: jax.Array, key: jax.Array, light: float, noise: float, blur: float = 0.0) -> jax.Array:
    """Augments images (T, n, H, W, 3) u8 by random exposure, contrast, colour and sharpness for each of the n
    sequences.

    Args:
      light: largest relative change of brightness and colour.
      noise: standard deviation of each pixel as a share of the full range.
      blur: largest strength of `camera_noise.blurred`.
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
    """Map to predict (n, *PREDICTED) from `privileged_map` (n, 640) u8, flipped for the envs `mirrored`."""
    cells = distances.reshape(-1, *MAP_SHAPE)
    # The second axis of the map is lateral.
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
    devices: Devices = ALONE,
) -> tuple[tuple[Any, Any], Any]:
    """Trains for several epochs over the sequences of a rollout, each split at random into minibatches of whole
    sequences.

    Args:
      start: (parameters, optimizer state).
      batch: a pytree of (T, n, ...).
      memory: (n, memory) at its first step.
      rate: factor of the optimizer's update: a number, or a prefix pytree of the parameters.
      count: number of epochs.
      parts: number of minibatches per epoch; must divide n.
      devices: that do this with their sequences at the same time; a minibatch is of all of them.

    Returns:
      (parameters, optimizer state), and the mean of the loss's metrics.
    """
    n = memory.shape[0]

    def epoch(carry: Any, key: jax.Array) -> Any:
        key_order, key_loss = jax.random.split(devices.own_key(key))
        rows = jax.random.permutation(key_order, n).reshape(parts, -1)

        def update(carry: Any, inputs: Any) -> Any:
            params, state = carry
            chosen, key = inputs
            part = jax.tree.map(lambda x: jnp.take(x, chosen, axis=1), batch)
            grads, reported = jax.grad(loss, has_aux=True)(params, part, memory[chosen], key)
            change, state = optimizer.update(devices.mean(grads), state, params)
            change = jax.tree.map(lambda r, part: jax.tree.map(lambda x: -r * x, part), rate, change)
            return (optax.apply_updates(params, change), state), reported

        return jax.lax.scan(update, carry, (rows, jax.random.split(key_loss, parts)))

    end, reported = jax.lax.scan(epoch, start, jax.random.split(key, count))
    return end, devices.mean(jax.tree.map(jnp.mean, reported))


class Learner(Protocol):
    """Interface of iterative algorithms: `dagger.Dagger`, `finetune.Finetune`."""

    def iterate(self, state: Any, progress: jax.Array) -> tuple[Any, dict[str, jax.Array]]:
        """Runs an iteration; donates the buffers of the state. Returns the new state and metrics."""
        ...


def run(
    learner: Learner,
    iterations: int,
    seconds: float,
    on_iteration: Callable[[int, Any, dict[str, float]], None],
    state: Any,
    before: Callable[[int, Any], Any] | None = None,
) -> Any:
    """Runs iterations until `iterations` are done or `seconds` of wall time have passed, with a callback after each.

    Args:
      state: initial state of the learner, whose `steps` count towards `iterations`.
      before: function (number of the iteration that comes, state) -> state with which it begins; None = that state.

    If the time limit is reached, the learning rate depends on the clock, and runs are not reproducible.
    """
    begin = time.monotonic()
    for number in range(int(state.steps) + 1, iterations + 1):
        progress = max((number - 1) / iterations, (time.monotonic() - begin) / seconds)
        if progress >= 1.0:
            break
        if before is not None:
            state = before(number, state)
        state, reported = learner.iterate(state, jnp.float32(progress))
        on_iteration(number, state, {name: float(x) for name, x in reported.items()})
    return state
