"""Messages of the bridge: round trips to the bit, schemas that agree with the decoder, and the robot's side."""

import copy
import io
import json
import types
from typing import Any

import jsonschema
import numpy as np
import pytest
from PIL import Image as PillowImage

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.deployment import ros_node
from urbanverse_mjx.deployment.messages import SCHEMAS, Command, Image, Odometry, decode
from urbanverse_mjx.deployment.robot_side import CommandGate, RobotLink

ODOMETRY = Odometry(7, (0.1, -2.0, 1e-9), (0.6, 0.0, 0.0, 0.8), (1 / 3, -0.0), 0.1)
IMAGE = Image(8, 0.75, np.arange(2 * 3 * 3, dtype=np.uint8).reshape(2, 3, 3))
COMMAND = Command("0123456789abcdef", 3, 1.25, -1 / 3, 10**9, "driving")


@pytest.mark.parametrize("message", [ODOMETRY, IMAGE, COMMAND], ids=lambda m: type(m).__name__)
def test_a_message_comes_back_to_the_bit(message: Odometry | Image | Command) -> None:
    parts = message.parts()
    found = decode(parts)
    assert found.parts() == parts
    assert type(found) is type(message)
    kind = parts[0].decode()
    jsonschema.validate(json.loads(parts[1]), SCHEMAS[kind])
    if isinstance(found, Image):
        assert isinstance(message, Image)
        np.testing.assert_array_equal(found.pixels, message.pixels)


WRONG = {
    "odometry": [
        {"stamp_ns": -1},
        {"stamp_ns": 1.5},
        {"stamp_ns": True},
        {"stamp_ns": 2**63},
        {"position_m": [0, 0]},
        {"position_m": "000"},
        {"velocity_mps": [0, None]},
        {"yaw_rate_radps": "0"},
        {"more": 1},
    ],
    "image": [{"height": 0}, {"width": 5000}, {"fovy_rad": -0.1}, {"fovy_rad": 3.2}, {"height": "2"}],
    "command": [{"session": "xyz"}, {"session": 5}, {"speed_mps": -0.1}, {"expires_ns": 0.5}, {"reason": None}],
}


@pytest.mark.parametrize("kind", WRONG)
def test_schema_and_decoder_refuse_the_same(kind: str) -> None:
    good = {"odometry": ODOMETRY, "image": IMAGE, "command": COMMAND}[kind].parts()
    for change in [*WRONG[kind], *({key: ...} for key in SCHEMAS[kind]["required"])]:
        header = {k: x for k, x in {**json.loads(good[1]), **change}.items() if x is not ...}
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(header, SCHEMAS[kind])
        with pytest.raises(ValidationError):
            decode([good[0], json.dumps(header).encode(), *good[2:]])


@pytest.mark.parametrize(
    "change",
    [{"orientation_wxyz": [1, 1, 0, 0]}, {"yaw_rate_radps": float("nan")}, {"velocity_mps": [float("inf"), 0.0]}],
)
def test_what_no_schema_says_is_refused_too(change: dict[str, Any]) -> None:
    parts = ODOMETRY.parts()
    with pytest.raises(ValidationError):
        decode([parts[0], json.dumps({**json.loads(parts[1]), **change}).encode()])
    with pytest.raises(ValidationError, match="17 bytes of pixels, needed 18"):
        decode([*IMAGE.parts()[:2], b"0" * 17])


def test_no_random_message_is_taken_for_one() -> None:
    draw = np.random.default_rng(0)
    good = ODOMETRY.parts()
    for _ in range(2000):
        body = bytearray(good[1])
        for at in draw.integers(0, len(body), 3):
            body[at] = draw.integers(256)
        try:
            found = decode([good[0], bytes(body)])
        except ValidationError:
            continue
        assert isinstance(found, Odometry)
        numbers = [*found.position_m, *found.orientation_wxyz, *found.velocity_mps, found.yaw_rate_radps]
        assert np.isfinite(numbers).all()


def command(sequence: int, expires: int, session: str = "0" * 16, speed: float = 1.0) -> list[bytes]:
    return Command(session, sequence, speed, 0.5, expires, "driving").parts()


def test_a_command_counts_until_it_expires() -> None:
    gate = CommandGate()
    assert gate.velocity(0) == (0.0, 0.0)
    assert gate.receive(command(1, 100), 10)
    assert gate.velocity(99) == (1.0, 0.5)
    assert gate.velocity(100) == (0.0, 0.0)
    # Old, repeated, in force for ever, not a command, no message.
    for parts in (command(1, 500), command(0, 500), command(2, 10**10), ODOMETRY.parts(), [b"", b""]):
        assert not gate.receive(parts, 50)
    assert gate.refused == 5
    assert gate.velocity(99) == (1.0, 0.5)
    assert gate.receive(command(2, 10, speed=0.0), 60)
    assert gate.velocity(61) == (0.0, 0.0)


def test_a_second_process_drives_only_after_the_first_was_silent() -> None:
    gate, other = CommandGate(), "f" * 16
    assert gate.receive(command(1, 10**8), 0)
    assert not gate.receive(command(9, 10**8, other), 10**9)
    assert gate.receive(command(9, 11 * 10**8, other, speed=0.3), 10**9 + 1)
    assert not gate.receive(command(2, 11 * 10**8), 10**9 + 2)
    assert gate.velocity(10**9 + 3) == (0.3, 0.5)


def test_an_address_that_cannot_be_bound_is_one_sentence() -> None:
    link = RobotLink("tcp://127.0.0.1:*", "tcp://127.0.0.1:*")
    try:
        with pytest.raises(ValidationError, match="needed an address to bind"):
            RobotLink(link.endpoints[0], "tcp://127.0.0.1:*")
    finally:
        link.close()


# ROS 2 messages, as objects with their fields -------------------------------------------------------------------------


def ros(**fields: Any) -> Any:
    return types.SimpleNamespace(**fields)


HEADER = ros(stamp=ros(sec=3, nanosec=5))


@pytest.mark.parametrize("encoding", ["rgb8", "bgr8", "rgba8", "bgra8", "mono8"])
def test_a_ros_image_with_padded_rows(encoding: str) -> None:
    colours = np.random.default_rng(0).integers(0, 256, (4, 5, 3), np.uint8)
    if encoding == "mono8":
        colours[:] = colours[..., :1]
    order = colours[..., ::-1] if encoding.startswith("bgr") else colours
    size = {"rgb8": 3, "bgr8": 3, "rgba8": 4, "bgra8": 4, "mono8": 1}[encoding]
    rows = np.full((4, 5, size), 9, np.uint8)
    rows[..., : min(size, 3)] = order[..., : min(size, 3)]
    padded = np.pad(rows.reshape(4, -1), ((0, 0), (0, 7)))
    message = ros(encoding=encoding, height=4, width=5, step=padded.shape[1], data=padded.tobytes(), header=HEADER)
    np.testing.assert_array_equal(ros_node.pixels_of(message), colours)
    for wrong in ({"encoding": "32FC1"}, {"step": 1}, {"data": b"123"}):
        with pytest.raises(ValidationError, match="image: found"):
            ros_node.pixels_of(ros(**{**vars(copy.copy(message)), **wrong}))


def test_a_compressed_ros_image() -> None:
    colours = np.random.default_rng(0).integers(0, 256, (4, 5, 3), np.uint8)
    file = io.BytesIO()
    PillowImage.fromarray(colours).save(file, "PNG")
    np.testing.assert_array_equal(ros_node.pixels_of_compressed(ros(data=file.getvalue())), colours)
    with pytest.raises(ValidationError, match="that are no image"):
        ros_node.pixels_of_compressed(ros(data=b"none"))


def test_ros_odometry() -> None:
    pose = ros(pose=ros(position=ros(x=1.0, y=2.0, z=3.0), orientation=ros(w=0.6, x=0.0, y=0.0, z=0.8)))
    twist = ros(twist=ros(linear=ros(x=0.5, y=-0.25, z=9.0), angular=ros(x=8.0, y=7.0, z=0.125)))
    found = ros_node.odometry_of(ros(header=HEADER, pose=pose, twist=twist), 99)
    assert found == Odometry(3 * 10**9 + 5, (1.0, 2.0, 3.0), (0.6, 0.0, 0.0, 0.8), (0.5, -0.25), 0.125)
    unset = ros(stamp=ros(sec=0, nanosec=0))
    assert ros_node.odometry_of(ros(header=unset, pose=pose, twist=twist), 99).stamp_ns == 99
