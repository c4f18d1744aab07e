"""Domain randomisation of each episode: friction, mass, appearance and the camera's mount."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Int, Key
from ml_collections import ConfigDict

from ...datatypes import CameraMount, SimState, ValidationError
from ...geometry import rotations

#: Values of `config.randomization` that disable it.
OFF = {
    "friction_scale": (1.0, 1.0),
    "mass_scale": (1.0, 1.0),
    "appearance": 0.0,
    "camera_position": 0.0,
    "camera_angle": 0.0,
    "camera_fovy": 0.0,
    "clutter": 0,
    "starts": 0.0,
    "wet": 0.0,
}
#: Numbers folded into a key, so that these draws do not change any others.
_FRICTION, _MASS, _APPEARANCE, _WET = 101, 102, 103, 104
#: Factor of friction on a wet street: that of wet ground materials (`assets/appearances/grounds/weathering.py`).
WET_FRICTION = 0.72


class Randomization:
    """Random draws at the beginning of each episode, by `config.randomization` of an environment.

    * friction_scale, mass_scale: (least, greatest) factor on the friction of the robot's contacts, and on the mass and
      inertia of its bodies; uniformly distributed.
    * appearance: relative variation of colours and light, 0 = off, see `Renderer`; each object of each episode has
      another factor.
    * camera_position: m, largest offset of the camera along each axis; camera_angle: degrees, largest rotation about
      each axis; camera_fovy: largest relative change of its field of view. All are uniform and constant within an
      episode.
    * clutter: number of movable objects beside the route, see `clutter.Clutter`.
    * wet: share of the episodes in rain, in which the friction of all contacts is multiplied by `WET_FRICTION` besides;
      the image does not change.
    * starts: share of the episodes that begin at a random position along or beside the route, see
      `starts.RandomStarts`.

    Raises:
      ValidationError: a range is not (least, greatest) above 0, a share is outside [0, 1), or a distance or angle is
        negative.
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
        # Configurations of older policies do not have these fields.
        self._camera = tuple(float(config.get(f"camera_{name}", 0.0)) for name in ("position", "angle", "fovy"))
        for name, value, limit in zip(("position", "angle", "fovy"), self._camera, (1.0, 45.0, 1.0), strict=True):
            if not 0.0 <= value < limit:
                raise ValidationError(
                    f"config.randomization.camera_{name}: found {value}, needed 0 (off) to below {limit:g}."
                )
        self.varies_camera = any(self._camera)
        #: Share of episodes with a random start.
        self.starts = float(config.get("starts", 0.0))
        if not 0.0 <= self.starts <= 1.0:
            raise ValidationError(
                f"config.randomization.starts: found {self.starts}, needed a share from 0 (off) to 1."
            )
        self._wet = float(config.get("wet", 0.0))
        if not 0.0 <= self._wet <= 1.0:
            raise ValidationError(f"config.randomization.wet: found {self._wet}, needed a share from 0 (off) to 1.")
        self._friction, self._mass = tuple(config.friction_scale), tuple(config.mass_scale)
        self.varies_appearance = config.appearance > 0.0

    def scaled(self, key: Key[Array, ""], sim: SimState) -> SimState:
        """Applies random friction and mass to the first state of an episode; `key` is typed and can be reused."""
        draws = {"friction_scale": (_FRICTION, self._friction), "mass_scale": (_MASS, self._mass)}
        new = {
            name: jax.random.uniform(jax.random.fold_in(key, number), (), jnp.float32, low, high)
            for name, (number, (low, high)) in draws.items()
            if (low, high) != (1.0, 1.0)
        }
        if self._wet > 0.0:
            wet = jax.random.bernoulli(jax.random.fold_in(key, _WET), self._wet)
            new["friction_scale"] = new.get("friction_scale", sim.friction_scale) * jnp.where(wet, WET_FRICTION, 1.0)
        return sim._replace(**new)

    def appearance_seed(self, key: Key[Array, ""]) -> Int[Array, ""]:
        """() i32 above 0, seed of an episode's appearance and camera mount; 0 if neither varies."""
        if not (self.varies_appearance or self.varies_camera):
            return jnp.int32(0)
        return jax.random.randint(jax.random.fold_in(key, _APPEARANCE), (), 1, 2**30, jnp.int32)

    def camera_mount(self, appearance_seed: Int[Array, ""]) -> CameraMount | None:
        """The mount of an episode's camera; None if it does not vary."""
        if not self.varies_camera:
            return None
        position, angle, fovy = self._camera
        draws = jax.random.uniform(jax.random.key(appearance_seed), (7,), jnp.float32, -1.0, 1.0)
        rotation = rotations.from_rotation_vector(jnp.deg2rad(angle) * draws[3:6])
        return CameraMount(position * draws[:3], rotation, 1.0 + fovy * draws[6])
