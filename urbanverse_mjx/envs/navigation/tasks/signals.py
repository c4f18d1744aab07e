"""Signals of pedestrians at crosswalks: a cycle of walk, clearance and don't walk.

In:   times, lengths of crosswalks. Out: phases and times to changes. When: every control step, inside jit, per env.

* Manual on Uniform Traffic Control Devices for Streets and Highways (FHWA, 2009), section 4E.06: a walk interval of at
  least 7 s, then a clearance time in which nobody begins to cross, long enough to cross at 3.5 ft/s.
* NACTO, Urban Street Design Guide (2013), "Signal cycle lengths": 60 to 90 s in urban areas.
* SAE J2735 (2016): phase and time to its end are what a signal's message SPaT tells road users.
"""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from ....crowds.crossings import CLEAR, STOP, WALK
from ....datatypes import ValidationError

#: s, least walk interval, and m/s, walking speed of the clearance time.
MIN_WALK, CLEARANCE_SPEED = 7.0, 1.07


class Cycle(NamedTuple):
    """Timing of all signals: one begins to walk at its offset and every `length` s after it.

    Attributes:
      length: s. walk: s of it in which people may begin to cross.
    """

    length: float
    walk: float

    def check(self, widest: float) -> "Cycle":
        """Returns it.

        Args:
          widest: m, the longest crosswalk.

        Raises:
          ValidationError: the walk interval is too short, or vehicles never go.
        """
        if not self.walk >= MIN_WALK:
            raise ValidationError(
                f"config.task.walk: found {self.walk:g} s, needed at least {MIN_WALK:g} s (MUTCD, section 4E.06)."
            )
        least = self.walk + widest / CLEARANCE_SPEED
        if not self.length > least:
            raise ValidationError(
                f"config.task.cycle: found {self.length:g} s, needed more than the {least:.1f} s of walking and "
                f"clearing a crosswalk of {widest:.1f} m, so that vehicles go, too."
            )
        return self

    def phase(self, time: Float[Array, " C"], crossing: Float[Array, " C"]) -> Int[Array, " C"]:
        """(C,) i32, `WALK`, `CLEAR` or `STOP`.

        Args:
          time: (C,) s since walking began last or would have begun; any number of cycles.
          crossing: (C,) m, lengths of the crosswalks.
        """
        at = jnp.mod(time, self.length)
        clears = at < self.walk + crossing / CLEARANCE_SPEED
        return jnp.where(at < self.walk, WALK, jnp.where(clears, CLEAR, STOP)).astype(jnp.int32)

    def to_walk(self, time: Float[Array, " C"]) -> Float[Array, " C"]:
        """(C,) s until people may begin to cross; 0 while they may."""
        at = jnp.mod(time, self.length)
        return jnp.where(at < self.walk, 0.0, self.length - at)

    def walk_left(self, time: Float[Array, " C"]) -> Float[Array, " C"]:
        """(C,) s for which people may still begin to cross; 0 in the other phases."""
        return jnp.maximum(self.walk - jnp.mod(time, self.length), 0.0)
