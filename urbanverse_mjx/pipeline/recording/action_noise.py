"""Noise on the actions that a recorded policy drives with, while its own answers are what is recorded.

A policy that drives well never shows how it comes back from where an imitating student strays to. With noise it does:
it answers in the states that the noise leads to. (Laskey et al., "DART: Noise Injection for Robust Imitation Learning",
2017; correlated in time, so that it moves the robot instead of shaking it: Codevilla et al., "End-to-end Driving via
Conditional Imitation Learning", 2018.)
"""

import dataclasses
import math
from typing import NamedTuple

import jax
import jax.numpy as jnp

from ...datatypes import validation as v

#: Folded into an episode's key, whose other draws stay what they are without noise.
_FOLD = 0x0D15


@dataclasses.dataclass(frozen=True)
class ActionNoise:
    """How much noise there is, and how long it lasts."""

    deviation: float = 0.0
    """Standard deviation of the noise on each component of the driven action, whose range is [-1, 1]; 0 = none."""
    seconds: float = 0.5
    """Time in which the noise loses its correlation (to 1/e); 0 = independent in every control step."""

    def check(self) -> None:
        """Raises ValidationError where a number is out of range."""
        v.number(self.deviation, "--noise.deviation", 0.0, 2.0)
        v.number(self.seconds, "--noise.seconds", 0.0, 60.0)

    def described(self) -> dict[str, float]:
        """For the dataset's record."""
        return {"deviation": float(self.deviation), "seconds": float(self.seconds)}

    def begin(self, key: jax.Array, size: int) -> "NoiseState":
        """The noise (size,) of the first step of the episode with this key."""
        key, now = jax.random.split(jax.random.fold_in(key, _FOLD))
        return NoiseState(key, self.deviation * jax.random.normal(now, (size,)))

    def next(self, state: "NoiseState", dt: float) -> "NoiseState":
        """That of the step `dt` s later: an Ornstein-Uhlenbeck process, whose deviation is the same at all times."""
        kept = math.exp(-dt / self.seconds) if self.seconds else 0.0
        key, now = jax.random.split(state.key)
        fresh = self.deviation * jax.random.normal(now, state.value.shape)
        return NoiseState(key, kept * state.value + math.sqrt(1.0 - kept**2) * fresh)


class NoiseState(NamedTuple):
    """key: typed, of the following steps. value: (A,) noise of this step."""

    key: jax.Array
    value: jax.Array


def disturbed(action: jax.Array, noise: jax.Array) -> jax.Array:
    """(..., A) in [-1, 1]: the action as driven."""
    return jnp.clip(jnp.clip(action, -1.0, 1.0) + noise, -1.0, 1.0)
