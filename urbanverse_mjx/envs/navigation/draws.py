"""Randomisation of each episode, besides the street: friction, mass, appearance and the camera's mount."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Int, Key
from ml_collections import ConfigDict

from ...datatypes import CameraMount, SimState, ValidationError
from ...geometry import rotations

#: Values of `config.randomization` without any effect.
OFF = {
    "friction_scale": (1.0, 1.0),
    "mass_scale": (1.0, 1.0),
    "appearance": 0.0,
    "camera_position": 0.0,
    "camera_angle": 0.0,
    "camera_fovy": 0.0,
    "clutter": 0,
    "starts": 0.0,
}
#: Numbers that a key is folded with, so that these draws do not change any others.
_FRICTION, _MASS, _APPEARANCE = 101, 102, 103


class Randomization:
    """Draws at the begin of each episode, by `config.randomization` of an environment.

    * friction_scale, mass_scale: (least, greatest) factor on the friction of the robot's contacts, and on the mass and
      inertia of its bodies; uniform.
    * appearance: 0, or by what share colours and light differ, see `Renderer`; every object of every episode by
      another factor.
    * camera_position: m by which the camera is off its place along each axis, at most; camera_angle: degrees by which
      it is turned about each of its axes; camera_fovy: share by which its field of view is wider or narrower. All
      uniform, the same for a whole episode, as if every episode had a robot of its own.
    * clutter: number of movable objects beside the route, see `clutter.Clutter`.
    * starts: share of the episodes that begin somewhere along the route or beside it, see `starts.RandomStarts`.

    Raises:
      ValidationError: a range that is not (least, greatest) above 0, a share outside [0, 1), or a negative distance or
        angle.
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
        # Configurations of policies from before the camera could vary do not have these.
        self._camera = tuple(float(config.get(f"camera_{name}", 0.0)) for name in ("position", "angle", "fovy"))
        for name, value, limit in zip(("position", "angle", "fovy"), self._camera, (1.0, 45.0, 1.0), strict=True):
            if not 0.0 <= value < limit:
                raise ValidationError(
                    f"config.randomization.camera_{name}: found {value}, needed 0 (off) to below {limit:g}."
                )
        self.varies_camera = any(self._camera)
        #: Share of episodes with a start drawn anew.
        self.starts = float(config.get("starts", 0.0))
        if not 0.0 <= self.starts <= 1.0:
            raise ValidationError(
                f"config.randomization.starts: found {self.starts}, needed a share from 0 (off) to 1."
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
        """() i32 above 0 that stands for an episode's appearance and camera mount; 0 where neither varies."""
        if not (self.varies_appearance or self.varies_camera):
            return jnp.int32(0)
        return jax.random.randint(jax.random.fold_in(key, _APPEARANCE), (), 1, 2**30, jnp.int32)

    def camera_mount(self, appearance_seed: Int[Array, ""]) -> CameraMount | None:
        """The mount of an episode's camera; None where it does not vary."""
        if not self.varies_camera:
            return None
        position, angle, fovy = self._camera
        draws = jax.random.uniform(jax.random.key(appearance_seed), (7,), jnp.float32, -1.0, 1.0)
        rotation = rotations.from_rotation_vector(jnp.deg2rad(angle) * draws[3:6])
        return CameraMount(position * draws[:3], rotation, 1.0 + fovy * draws[6])
