"""Randomisation of each episode, besides the street: friction, mass and appearance."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Int, Key
from ml_collections import ConfigDict

from ...datatypes import SimState, ValidationError

#: Values of `config.randomization` without any effect.
OFF = {"friction_scale": (1.0, 1.0), "mass_scale": (1.0, 1.0), "appearance": 0.0}
#: Numbers that a key is folded with, so that these draws do not change any others.
_FRICTION, _MASS, _APPEARANCE = 101, 102, 103


class Randomization:
    """Draws at the begin of each episode, by `config.randomization` of an environment.

    * friction_scale, mass_scale: (least, greatest) factor on the friction of the robot's contacts, and on the mass and
      inertia of its bodies; uniform.
    * appearance: 0, or by what share colours and light differ, see `Renderer`; every object of every episode by
      another factor.

    Raises:
      ValidationError: a range that is not (least, greatest) above 0, or a share outside [0, 1).
    """

    def __init__(self, config: ConfigDict) -> None:
        for name in ("friction_scale", "mass_scale"):
            low, high = config[name]
            if not 0.0 < low <= high:
                raise ValidationError(
                    f"config.randomization.{name}: found {config[name]}, needed (least, greatest), both above 0."
                )
        if not 0.0 <= config.appearance < 1.0:
            raise ValidationError(
                f"config.randomization.appearance: found {config.appearance}, needed 0 (off) to below 1."
            )
        self._friction, self._mass = tuple(config.friction_scale), tuple(config.mass_scale)
        self.varies_appearance = config.appearance > 0.0

    def scaled(self, key: Key[Array, ""], sim: SimState) -> SimState:
        """The first state of an episode with the grip and the mass drawn for it; `key` is typed and not used up."""
        draws = {"friction_scale": (_FRICTION, self._friction), "mass_scale": (_MASS, self._mass)}
        new = {
            name: jax.random.uniform(jax.random.fold_in(key, number), (), jnp.float32, low, high)
            for name, (number, (low, high)) in draws.items()
            if (low, high) != (1.0, 1.0)
        }
        return sim._replace(**new)

    def appearance_seed(self, key: Key[Array, ""]) -> Int[Array, ""]:
        """() i32 above 0 that stands for the appearance of an episode; 0 where it does not vary."""
        if not self.varies_appearance:
            return jnp.int32(0)
        return jax.random.randint(jax.random.fold_in(key, _APPEARANCE), (), 1, 2**30, jnp.int32)
