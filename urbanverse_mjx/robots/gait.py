"""A gait: a small network that maps a legged robot's proprioception and a velocity command to joint angles.

In: sensor readings, a command. Out:  joint angles for position servos. When: 50 times a second, inside jit (xp =
jax.numpy) or on the host (xp = numpy).

The locomotion task, the evaluation of gaits, and the navigation task use these functions, so that the observation has
one definition.
"""

import dataclasses
import json
import os
from typing import Any

import numpy as np

from ..datatypes import array_file
from ..datatypes import validation as v

SCHEMA = "urbanverse.gait/1"
#: Units that scale sensor readings to about 1: angular velocity in 4 rad/s, joint speed in 20 rad/s (legged_gym's
#: scales).
RATE_UNIT, JOINT_RATE_UNIT = 0.25, 0.05


def sensor_frame(xp: Any, angular: Any, gravity: Any, bend: Any, joint_speed: Any, command: Any, action: Any) -> Any:
    """(..., 9 + 3 J), one control step of a gait's observation.

    Args:
      xp: numpy or jax.numpy.
      angular: (..., 3) rad/s and gravity: (..., 3) unit, both in the body frame.
      bend: (..., J) rad, joint angles less those of the standing pose.
      joint_speed: (..., J) rad/s.
      command: (..., 3) m/s forward, m/s left, rad/s.
      action: (..., J), the last one.
    """
    parts = [RATE_UNIT * angular, gravity, bend, JOINT_RATE_UNIT * joint_speed, command, action]
    return xp.concatenate(parts, axis=-1)


def felt_gravity(xp: Any, quaternion: Any) -> Any:
    """(..., 3), direction of gravity in the frame of a body with orientation (..., 4) wxyz."""
    w, x, y, z = (quaternion[..., i] for i in range(4))
    return xp.stack([2.0 * (w * y - x * z), -2.0 * (w * x + y * z), 2.0 * (x * x + y * y) - 1.0], -1)


@dataclasses.dataclass(frozen=True)
class Gait:
    """A trained gait.

    Attributes:
      kernels, biases: of its dense layers, (n_in, n_out) and (n_out,) f32; ELU between them, tanh behind the last.
      stand: (J,) rad.
      scale: (J,) rad, offset of a joint from there for an action of 1.
      history: control steps of its observation.
      control_dt: s.
      meta: metadata: robot and training (command, seed, steps, versions).
    """

    kernels: tuple[np.ndarray, ...]
    biases: tuple[np.ndarray, ...]
    stand: np.ndarray
    scale: np.ndarray
    history: int
    control_dt: float
    meta: dict[str, Any]

    def __post_init__(self) -> None:
        width = self.history * (9 + 3 * len(self.stand))
        if self.kernels[0].shape[0] != width or self.kernels[-1].shape[1] != len(self.stand):
            found = f"layers {self.kernels[0].shape[0]} to {self.kernels[-1].shape[1]}"
            raise v.fail("gait", found, f"{width} to {len(self.stand)}", "export it again")

    def action(self, xp: Any, seen: Any) -> Any:
        """(..., J) in [-1, 1] for an observation (..., H * (9 + 3 J)), newest step first."""
        x = seen
        for kernel, bias in zip(self.kernels[:-1], self.biases[:-1], strict=True):
            x = x @ kernel + bias
            x = xp.where(x > 0, x, xp.expm1(xp.minimum(x, 0.0)))
        return xp.tanh(x @ self.kernels[-1] + self.biases[-1])

    def target(self, action: Any) -> Any:
        """(..., J) rad, servo targets for an action."""
        return self.stand + self.scale * action

    def in_half_precision(self) -> "Gait":
        """This gait with the weights of its layers rounded to 11 significant bits, of which a file is half as large.

        Raises:
          ValidationError: a weight is too large for half precision.
        """
        kernels, biases = (tuple(_half(x).astype(np.float32) for x in part) for part in (self.kernels, self.biases))
        if not all(np.isfinite(x).all() for x in (*kernels, *biases)):
            raise v.fail("gait", "a weight beyond 65,504", "smaller ones", "keep its single precision")
        return dataclasses.replace(self, kernels=kernels, biases=biases)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a gait file, without loss: arrays of layers that half precision holds exactly are stored in it."""
        head = {"schema": SCHEMA, "history": self.history, "control_dt": self.control_dt, "meta": self.meta}
        arrays: dict[str, Any] = {"head": np.frombuffer(json.dumps(head).encode("utf-8"), np.uint8)}
        arrays |= {"stand": self.stand, "scale": self.scale}
        for i, (kernel, bias) in enumerate(zip(self.kernels, self.biases, strict=True)):
            arrays |= {f"kernel_{i}": _stored(kernel), f"bias_{i}": _stored(bias)}
        array_file.save(path, arrays)

    @staticmethod
    def load(path: str | os.PathLike[str]) -> "Gait":
        """Reads a gait file.

        Raises:
          ValidationError: the file does not exist, is damaged, or is not a gait.
        """
        if not os.path.isfile(path):
            raise v.fail(str(path), "no such file", "a gait", "export one with `urbanverse export-gait`")
        arrays = array_file.load(path, "a gait", "export it again")
        head = v.parse_json(arrays.pop("head", np.zeros(0, np.uint8)).tobytes(), f"{path}: head")
        v.choice(head.pop("schema", None), f"{path}: schema", (SCHEMA,))
        layers = range(sum(name.startswith("kernel_") for name in arrays))
        kernels, biases = (
            tuple(arrays[f"{part}_{i}"].astype(np.float32, copy=False) for i in layers) for part in ("kernel", "bias")
        )
        return Gait(kernels, biases, arrays["stand"], arrays["scale"], **head)


def _half(x: np.ndarray) -> np.ndarray:
    """An array in half precision; infinite where a value is too large for it."""
    with np.errstate(over="ignore"):
        return x.astype(np.float16)


def _stored(x: np.ndarray) -> np.ndarray:
    """An array in half precision if that is the same to the bit, else as it is."""
    half = _half(x)
    return half if np.array_equal(half.astype(x.dtype), x) else x
