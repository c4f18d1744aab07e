"""Domain randomisation of each episode: friction, mass, appearance, latency, and the camera's mount and noise."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int, Key
from ml_collections import ConfigDict

from ...datatypes import CameraMount, SimState, ValidationError
from ...geometry import rotations
from .camera_noise import CameraNoise

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
    "latency": (0.0, 0.0),
    "exposure": 0.0,
    "white_balance": 0.0,
    "blur": 0.0,
    "pixel_noise": 0.0,
}
#: Numbers folded into a key, so that these draws do not change any others.
_FRICTION, _MASS, _APPEARANCE, _WET, _LATENCY, _CAMERA, _PIXELS = 101, 102, 103, 104, 105, 106, 107
#: Fields of `config.randomization` of the camera's noise -> largest value.
CAMERA_NOISE = {"exposure": 8.0, "white_balance": 0.9, "blur": 1.0, "pixel_noise": 1.0}
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
    * exposure: EV, largest difference of the exposure in either direction; white_balance: largest relative change of
      each colour channel's light; blur: strongest blur, 1 = a binomial blur over 3 x 3 pixels; pixel_noise: largest
      standard deviation of the noise of each pixel, as a share of the full range. All are uniform and constant within
      an episode; the noise itself is another in every image. See `camera_noise.through_camera`.
    * latency: (least, greatest) s, of at most a control step, from an image to the moment at which the command that
      follows from it is obeyed; until then the one before it is. Uniform and constant within an episode. The engine
      gets one command a control step: the mean of both, weighted by their times.
    * clutter: number of movable objects beside the route, see `clutter.Clutter`.
    * wet: share of the episodes in rain, in which the friction of all contacts is multiplied by `WET_FRICTION` besides;
      the image does not change.
    * starts: share of the episodes that begin at a random position along or beside the route, see
      `starts.RandomStarts`.

    Raises:
      ValidationError: a range is not (least, greatest) above 0, a share is outside [0, 1), a distance or angle is
        negative, or the latency is longer than a control step.
    """

    def __init__(self, config: ConfigDict, control_step: float = float("inf")) -> None:
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
        self._noise = {name: float(config.get(name, 0.0)) for name in CAMERA_NOISE}
        for name, limit in CAMERA_NOISE.items():
            if not 0.0 <= self._noise[name] <= limit:
                raise ValidationError(
                    f"config.randomization.{name}: found {self._noise[name]}, needed 0 (off) to {limit:g}."
                )
        self.varies_images = any(self._noise.values())
        self._latency = tuple(float(x) for x in config.get("latency", (0.0, 0.0)))
        if not 0.0 <= self._latency[0] <= self._latency[1] <= control_step:
            raise ValidationError(
                f"config.randomization.latency: found {self._latency} s, needed (least, greatest) from 0 to a control "
                f"step of {control_step:g} s."
            )
        self.varies_latency = self._latency[1] > 0.0
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
        """() i32 above 0, seed of an episode's appearance, camera and latency; 0 if none of them varies."""
        if not (self.varies_appearance or self.varies_camera or self.varies_images or self.varies_latency):
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

    def camera_noise(self, appearance_seed: Int[Array, ""]) -> CameraNoise | None:
        """The noise of an episode's camera; None if it has none."""
        if not self.varies_images:
            return None
        key = jax.random.fold_in(jax.random.key(appearance_seed), _CAMERA)
        draws = jax.random.uniform(key, (6,), jnp.float32)
        both = 2.0 * draws[:4] - 1.0
        return CameraNoise(
            exposure=self._noise["exposure"] * both[0],
            white_balance=1.0 + self._noise["white_balance"] * both[1:],
            blur=self._noise["blur"] * draws[4],
            noise=self._noise["pixel_noise"] * draws[5],
        )

    @staticmethod
    def image_key(appearance_seed: Int[Array, ""], step: Int[Array, ""]) -> Key[Array, ""]:
        """Key of the noise of the image of a control step."""
        return jax.random.fold_in(jax.random.fold_in(jax.random.key(appearance_seed), _PIXELS), step)

    def latency(self, appearance_seed: Int[Array, ""]) -> Float[Array, ""] | None:
        """() s, latency of an episode; None if there is none."""
        if not self.varies_latency:
            return None
        key = jax.random.fold_in(jax.random.key(appearance_seed), _LATENCY)
        low, high = self._latency
        return jax.random.uniform(key, (), jnp.float32, low, high)
