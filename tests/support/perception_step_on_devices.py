"""Prints by how much a training step of the perception model on two devices differs from two halves on one.

Run with two CPU devices: `XLA_FLAGS=--xla_force_host_platform_device_count=2`.
"""

import json
import sys
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from urbanverse_mjx.distillation import train_perception
from urbanverse_mjx.distillation.perception_model import classes, network, weights
from urbanverse_mjx.distillation.perception_model.targets import GroundTruth

_HEIGHT, _WIDTH, _BATCH = 32, 64, 4


class _Views:
    """Random images, and targets that depend on the key alone."""

    balance = None

    def __call__(self, keys: jax.Array) -> tuple[jax.Array, GroundTruth, jax.Array]:
        return jax.vmap(self._one)(keys)

    @staticmethod
    def _one(key: jax.Array) -> tuple[jax.Array, GroundTruth, jax.Array]:
        image = jax.random.randint(key, (_HEIGHT, _WIDTH, 3), 0, 256).astype(jnp.uint8)
        size = (_HEIGHT // network.OUTPUT_STRIDE, _WIDTH // network.OUTPUT_STRIDE)
        flat, number = jax.random.uniform(key, size), jax.random.randint(key, size, 0, 3)
        owner = jnp.where(number > 0, number, -1)
        kinds = jnp.where(number > 0, classes.FIRST_OBJECT + number, 1)
        offset = jnp.stack([flat, -flat], -1)
        leaf = jnp.full(size, -1)
        wanted = GroundTruth(kinds, leaf, 1 + flat, owner, flat, 1 + flat, offset, number > 0, flat, number < 2)
        return image, wanted, jnp.ones(())


def _gradients(batch: int, devices: list[Any], keys: tuple[jax.Array, jax.Array], variables: object) -> object:
    """Gradient of a step's programs for keys (batch,) of the views and of the conditions."""
    model = weights.network(blocks=(1, 1, 1, 1, 1), scanned=True)
    step = train_perception.Step(model, _Views(), batch, devices=devices)  # pyright: ignore[reportArgumentType]
    images, wanted, counts = step._programs["draw"](keys[0])
    inputs, wanted = step._programs["vary"](keys[1], images, wanted)
    slopes, _, _ = step._programs["slopes"](variables, inputs, wanted, counts, None)
    return jax.tree.map(np.asarray, slopes)


def main() -> int:
    devices = jax.devices()
    model = weights.network(blocks=(1, 1, 1, 1, 1), scanned=True)
    variables = model.init(jax.random.key(0), jnp.zeros((1, _HEIGHT, _WIDTH, 3)))
    keys = jax.random.split(jax.random.key(1), _BATCH), jax.random.split(jax.random.key(2), _BATCH)
    both = _gradients(_BATCH, devices, keys, variables)
    halves = [
        _gradients(_BATCH // 2, devices[:1], (keys[0][part], keys[1][part]), variables)
        for part in (slice(0, _BATCH // 2), slice(_BATCH // 2, None))
    ]
    mean = jax.tree.map(lambda a, b: (a + b) / 2, *halves)

    def apart(x: object, y: object) -> float:
        squares = [
            (float(((a - b) ** 2).sum()), float((b**2).sum()))
            for a, b in zip(jax.tree.leaves(x), jax.tree.leaves(y), strict=True)
        ]
        return (sum(a for a, _ in squares) / sum(b for _, b in squares)) ** 0.5

    print(
        json.dumps({"devices": len(devices), "apart": apart(both, mean), "halves_apart": apart(halves[0], halves[1])})
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
