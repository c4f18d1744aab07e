"""Messages of the bridge between a robot and `urbanverse deploy`.

A message is a ZeroMQ multipart message: its kind (ASCII), a header (a JSON object in UTF-8 of `SCHEMAS`), and for an
image its pixels. Stamps are nanoseconds of the robot's clock, which may begin anywhere and never goes back; the other
side only returns them, so the two clocks need not agree.

In:   parts of a message. Out: `Odometry`, `Image`, `Command`; or a `ValidationError`, and the receiver ignores it.
"""

import dataclasses
import json
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..datatypes import validation as v

#: Ports on the robot, if none is given: it publishes odometry and images on the first and takes commands on the second.
SENSOR_PORT, COMMAND_PORT = 5601, 5602
MAX_SIDE = 4096  # pixels
#: Longest part of a message (bytes); receivers drop longer ones unread.
MAX_PART = 64 * 2**20
MAX_HEADER = 4096  # bytes
_MAX_STAMP = 2**63 - 1
#: Allowed difference of a quaternion's length from 1.
_UNIT = 0.01
_NUMBER, _STAMP = {"type": "number"}, {"type": "integer", "minimum": 0, "maximum": _MAX_STAMP}


def _vector(length: int) -> dict[str, Any]:
    return {"type": "array", "items": _NUMBER, "minItems": length, "maxItems": length}


def _schema(title: str, description: str, properties: dict[str, Any]) -> dict[str, Any]:
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": title,
        "description": description,
        "type": "object",
        "properties": properties,
        "required": list(properties),
        "additionalProperties": False,
    }


#: Kind of message -> JSON Schema of its header.
SCHEMAS: dict[str, dict[str, Any]] = {
    "odometry": _schema(
        "odometry",
        "Pose and velocity of the robot's body, from the robot, at 20 Hz or more.",
        {
            "stamp_ns": {**_STAMP, "description": "of the robot's clock, later than that of the message before"},
            "position_m": {**_vector(3), "description": "x, y, z in the odometry frame, z up"},
            "orientation_wxyz": {
                **_vector(4),
                "description": "unit quaternion, body frame (x ahead, y left) to odometry",
            },
            "velocity_mps": {**_vector(2), "description": "ahead and to the left in the heading frame"},
            "yaw_rate_radps": {**_NUMBER, "description": "positive to the left"},
        },
    ),
    "image": _schema(
        "image",
        "Image of the front camera, from the robot, at twice the policy's rate or more. Its pixels are the third part: "
        "height * width * 3 bytes, sRGB red, green, blue, row by row from the top left.",
        {
            "stamp_ns": {**_STAMP, "description": "when it was exposed, by the robot's clock"},
            "height": {"type": "integer", "minimum": 1, "maximum": MAX_SIDE},
            "width": {"type": "integer", "minimum": 1, "maximum": MAX_SIDE},
            "fovy_rad": {
                **_NUMBER,
                "minimum": 0,
                "maximum": 3.1,
                "description": "vertical field of view; 0: the whole image is what the policy should see",
            },
        },
    ),
    "command": _schema(
        "command",
        "Body velocity, to the robot, after every odometry message. The robot stands still from `expires_ns` on.",
        {
            "session": {"type": "string", "pattern": "^[0-9a-f]{16}$", "description": "drawn anew by every process"},
            "sequence": {**_STAMP, "description": "larger than that of the session's command before"},
            "speed_mps": {**_NUMBER, "minimum": 0},
            "yaw_rate_radps": _NUMBER,
            "expires_ns": {**_STAMP, "description": "of the robot's clock"},
            "reason": {"type": "string", "description": "driving, or why the velocity is 0"},
        },
    ),
}


@dataclasses.dataclass(frozen=True)
class Odometry:
    """Header of an `odometry` message."""

    stamp_ns: int
    position_m: tuple[float, ...]
    orientation_wxyz: tuple[float, ...]
    velocity_mps: tuple[float, ...]
    yaw_rate_radps: float

    def __post_init__(self) -> None:
        _stamp(self.stamp_ns, "odometry.stamp_ns")
        bounds = {"minimum": -1e7, "maximum": 1e7}
        v.vector(self.position_m, "odometry.position_m", 3, **bounds)
        quaternion = v.vector(self.orientation_wxyz, "odometry.orientation_wxyz", 4, minimum=-1.1, maximum=1.1)
        length = float(np.linalg.norm(quaternion))
        if abs(length - 1.0) > _UNIT:
            raise v.fail("odometry.orientation_wxyz", f"the length {length:g}", "a unit quaternion")
        v.vector(self.velocity_mps, "odometry.velocity_mps", 2, minimum=-100.0, maximum=100.0)
        v.number(self.yaw_rate_radps, "odometry.yaw_rate_radps", minimum=-1000.0, maximum=1000.0)

    def parts(self) -> list[bytes]:
        return _parts("odometry", dataclasses.asdict(self))


@dataclasses.dataclass(frozen=True)
class Image:
    """An `image` message; pixels: (height, width, 3) u8."""

    stamp_ns: int
    fovy_rad: float
    pixels: np.ndarray

    def __post_init__(self) -> None:
        _stamp(self.stamp_ns, "image.stamp_ns")
        v.number(self.fovy_rad, "image.fovy_rad", minimum=0.0, maximum=3.1)
        shape = self.pixels.shape
        if self.pixels.dtype != np.uint8 or len(shape) != 3 or shape[2] != 3 or not 0 < min(shape) <= max(shape):
            raise v.fail(
                "image", f"pixels of shape {shape} and type {self.pixels.dtype}", "(height, width, 3) of uint8"
            )

    def parts(self) -> list[bytes]:
        height, width = self.pixels.shape[:2]
        header = {"stamp_ns": self.stamp_ns, "height": height, "width": width, "fovy_rad": self.fovy_rad}
        return [*_parts("image", header), np.ascontiguousarray(self.pixels).tobytes()]


@dataclasses.dataclass(frozen=True)
class Command:
    """Header of a `command` message."""

    session: str
    sequence: int
    speed_mps: float
    yaw_rate_radps: float
    expires_ns: int
    reason: str

    def __post_init__(self) -> None:
        session = v.text(self.session, "command.session")
        if len(session) != 16 or any(c not in "0123456789abcdef" for c in session):
            raise v.fail("command.session", v.show(session), "16 hexadecimal digits")
        _stamp(self.sequence, "command.sequence")
        v.number(self.speed_mps, "command.speed_mps", minimum=0.0, maximum=100.0)
        v.number(self.yaw_rate_radps, "command.yaw_rate_radps", minimum=-1000.0, maximum=1000.0)
        _stamp(self.expires_ns, "command.expires_ns")
        v.text(self.reason, "command.reason")

    def parts(self) -> list[bytes]:
        return _parts("command", dataclasses.asdict(self))


Message = Odometry | Image | Command


def _stamp(value: Any, where: str) -> int:
    return v.integer(value, where, 0, _MAX_STAMP)


def _parts(kind: str, header: dict[str, Any]) -> list[bytes]:
    return [kind.encode(), json.dumps(header, separators=(",", ":")).encode()]


def decode(parts: Sequence[bytes]) -> Message:
    """The message in the parts of a multipart message.

    Raises:
      ValidationError: another number of parts, an unknown kind, a header that is not of its schema, a number that is
        not finite, or pixels of another size.
    """
    if len(parts) < 2 or len(parts[0]) > 16 or len(parts[1]) > MAX_HEADER:
        raise v.fail("message", f"{len(parts)} parts of {[len(p) for p in parts[:4]]} bytes", "a kind and a header")
    kind = v.choice(parts[0].decode("ascii", "replace"), "message", SCHEMAS)
    needed = 3 if kind == "image" else 2
    if len(parts) != needed:
        raise v.fail(kind, f"{len(parts)} parts", f"{needed}")
    header = v.mapping(v.parse_json(parts[1], kind), kind, SCHEMAS[kind]["properties"])
    if kind == "command":
        return Command(**header)
    if kind == "odometry":
        fixed: dict[str, Any] = {k: tuple(x) if isinstance(x, list) else x for k, x in header.items()}
        return Odometry(**fixed)
    height, width = (v.integer(header[k], f"image.{k}", 1, MAX_SIDE) for k in ("height", "width"))
    if len(parts[2]) != height * width * 3:
        raise v.fail("image", f"{len(parts[2])} bytes of pixels", f"{height * width * 3}")
    pixels = np.frombuffer(parts[2], np.uint8).reshape(height, width, 3)
    return Image(header["stamp_ns"], header["fovy_rad"], pixels)
