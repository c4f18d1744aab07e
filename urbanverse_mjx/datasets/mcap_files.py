"""MCAP: a file an episode with messages of Foxglove's schemas, which Foxglove and rerun show.

Sources: the schemas of foxglove-schemas-protobuf and the MCAP specification (mcap.dev).
"""

import functools
import importlib
import io
import json
from collections.abc import Callable
from typing import Any

import numpy as np

from ..datatypes import optional
from ..geometry import rotations
from .annotations import SeenObject
from .frame_files import FrameEpisode, FrameFolder

#: JSON Schemas of what Foxglove has no schema for.
_VECTOR = {"type": "object", "properties": {axis: {"type": "number"} for axis in "xyz"}}
IMU_SCHEMA = {
    "title": "urbanverse.Imu",
    "type": "object",
    "properties": {
        "timestamp": {"type": "object", "properties": {"sec": {"type": "integer"}, "nsec": {"type": "integer"}}},
        "frame_id": {"type": "string"},
        "angular_velocity": {**_VECTOR, "description": "rad/s"},
        "linear_acceleration": {**_VECTOR, "description": "specific force, m/s^2"},
    },
}
NUMBERS_SCHEMA = {
    "title": "urbanverse.Numbers",
    "type": "object",
    "properties": {"values": {"type": "array", "items": {"type": "number"}}},
}
_NANO = 1_000_000_000
WORLD, ROBOT, CAMERA, LIDAR = "world", "robot", "camera", "lidar"
#: Columns that become messages of numbers: column -> topic.
NUMBERS = {"action": "/action", "observation.odometry": "/odometry", "next.contact_force": "/contact_force"}


def require_packages() -> None:
    """Raises an error unless the packages are installed.

    Raises:
      ValidationError: see there.
    """
    for name in ("mcap.writer", "mcap_protobuf.schema", "foxglove_schemas_protobuf.CompressedImage_pb2"):
        optional.package(name, "--format mcap", "mcap", "another --format")


@functools.cache
def message(name: str) -> Any:
    """A message class of Foxglove."""
    return getattr(importlib.import_module(f"foxglove_schemas_protobuf.{name}_pb2"), name)


class McapWriter(FrameFolder):
    """Writes episode_000000.mcap, ...; time begins with each episode at 0."""

    image_type = "jpg"

    def files(self, episode: FrameEpisode) -> dict[str, bytes]:
        """The file of an episode."""
        buffer = io.BytesIO()
        log = _Log(buffer)
        for step in range(len(episode)):
            self._step(log, episode, step, round(step * _NANO / self.rig.rate))
        log.finish({key: str(value) for key, value in episode.record.items()})
        return {f"episode_{self.num_episodes:06d}.mcap": buffer.getvalue()}

    def _step(self, log: "_Log", episode: FrameEpisode, step: int, time: int) -> None:
        columns, rig = episode.columns, self.rig
        pose, camera = columns["pose"][step], columns["pose.camera"][step]
        frames = message("FrameTransforms")()
        back = pose[3:] * np.array([1.0, -1.0, -1.0, -1.0])
        mount = rotations.rotate(back, camera[:3] - pose[:3]), rotations.product(back, camera[3:])
        still = np.array([1.0, 0.0, 0.0, 0.0])
        places = (WORLD, ROBOT, pose[:3], pose[3:]), (ROBOT, CAMERA, *mount), (ROBOT, LIDAR, rig.lidar, still)
        for parent, child, position, quaternion in places:
            frame = frames.transforms.add(parent_frame_id=parent, child_frame_id=child)
            _stamp(frame, time)
            _place(frame.translation, frame.rotation, position, quaternion)
        log.add("/tf", frames, time)
        placed = message("PoseInFrame")(frame_id=WORLD)
        _stamp(placed, time)
        _place(placed.pose.position, placed.pose.orientation, pose[:3], pose[3:])
        log.add("/pose", placed, time)
        image = message("CompressedImage")(frame_id=CAMERA, data=episode.colours[step], format="jpeg")
        _stamp(image, time)
        log.add("/camera/image", image, time)
        lens = message("CameraCalibration")(frame_id=CAMERA, width=rig.width, height=rig.height)
        _stamp(lens, time)
        lens.K.extend(rig.matrix.ravel())
        lens.R.extend(np.eye(3).ravel())
        lens.P.extend(np.column_stack([rig.matrix, np.zeros(3)]).ravel())
        log.add("/camera/calibration", lens, time)
        if episode.scans:
            log.add("/lidar", _cloud(episode.scans[step], time), time)
        if episode.annotations:
            seen = episode.annotations[step]
            log.add("/objects", _scene(seen.objects, time), time)
            log.add("/camera/boxes", _boxes(seen.objects, time), time)
            log.add_json("/caption", {"title": "urbanverse.Caption", "type": "object"}, {"text": seen.caption}, time)
        if (imu := columns.get("observation.imu")) is not None:
            body = {"timestamp": {"sec": time // _NANO, "nsec": time % _NANO}, "frame_id": ROBOT}
            for name, part in (("angular_velocity", imu[step, :3]), ("linear_acceleration", imu[step, 3:])):
                body[name] = dict(zip("xyz", map(float, part), strict=True))
            log.add_json("/imu", IMU_SCHEMA, body, time)
        for name, topic in NUMBERS.items():
            if name in columns:
                values = np.atleast_1d(columns[name][step]).astype(float).tolist()
                log.add_json(topic, NUMBERS_SCHEMA, {"values": values}, time)


class _Log:
    """Messages of one file; schemas and channels are registered when first used."""

    def __init__(self, stream: io.BytesIO) -> None:
        self._writer = importlib.import_module("mcap.writer").Writer(stream)
        self._writer.start(profile="", library="urbanverse_mjx")
        self._channels: dict[str, int] = {}
        self._counts: dict[str, int] = {}

    def _send(
        self, topic: str, make: Callable[[], tuple[str, str, bytes]], encoding: str, body: bytes, at: int
    ) -> None:
        if topic not in self._channels:
            name, kind, data = make()
            schema = self._writer.register_schema(name=name, encoding=kind, data=data)
            self._channels[topic] = self._writer.register_channel(
                topic=topic, message_encoding=encoding, schema_id=schema
            )
        count = self._counts[topic] = self._counts.get(topic, -1) + 1
        self._writer.add_message(self._channels[topic], log_time=at, publish_time=at, data=body, sequence=count)

    def add(self, topic: str, value: Any, at: int) -> None:
        """Adds a message of Foxglove at a time in ns."""

        def schema() -> tuple[str, str, bytes]:
            describe = importlib.import_module("mcap_protobuf.schema").build_file_descriptor_set
            return value.DESCRIPTOR.full_name, "protobuf", describe(type(value)).SerializeToString()

        self._send(topic, schema, "protobuf", value.SerializeToString(), at)

    def add_json(self, topic: str, schema: dict[str, Any], body: dict[str, Any], at: int) -> None:
        """Adds a JSON message."""
        described = schema["title"], "jsonschema", json.dumps(schema).encode()
        self._send(topic, lambda: described, "json", json.dumps(body, ensure_ascii=False).encode(), at)

    def finish(self, record: dict[str, str]) -> None:
        """Adds what is known of the episode, and the end of the file."""
        self._writer.add_metadata("episode", record)
        self._writer.finish()


def _stamp(value: Any, time: int) -> None:
    value.timestamp.FromNanoseconds(time)


def _place(position: Any, rotation: Any, point: Any, quaternion: Any) -> None:
    position.x, position.y, position.z = map(float, point)
    rotation.w, rotation.x, rotation.y, rotation.z = map(float, quaternion)


def _cloud(points: np.ndarray, time: int) -> Any:
    cloud = message("PointCloud")(frame_id=LIDAR, point_stride=12, data=points.astype("<f4").tobytes())
    _stamp(cloud, time)
    cloud.pose.orientation.w = 1.0
    kind = message("PackedElementField").NumericType.FLOAT32
    for k, axis in enumerate("xyz"):
        cloud.fields.add(name=axis, offset=4 * k, type=kind)
    return cloud


def _scene(objects: tuple[SeenObject, ...], time: int) -> Any:
    scene = message("SceneUpdate")()
    # What is not seen any more goes away.
    gone = scene.deletions.add(type=message("SceneEntityDeletion").Type.ALL)
    _stamp(gone, time)
    for item in objects:
        entity = scene.entities.add(frame_id=WORLD, id=item.name)
        _stamp(entity, time)
        entity.metadata.add(key="category", value=item.category)
        entity.metadata.add(key="visible", value=f"{item.visible:.4f}")
        cube = entity.cubes.add()
        _place(cube.pose.position, cube.pose.orientation, item.position_world, item.quaternion_world)
        cube.size.x, cube.size.y, cube.size.z = item.size
        cube.color.r, cube.color.g, cube.color.b, cube.color.a = 0.1, 0.6, 0.9, 0.4
    return scene


def _boxes(objects: tuple[SeenObject, ...], time: int) -> Any:
    found = message("ImageAnnotations")()
    for item in objects:
        left, top, right, bottom = item.box
        ring = found.points.add(type=message("PointsAnnotation").Type.LINE_LOOP, thickness=1.0)
        _stamp(ring, time)
        ring.outline_color.g = ring.outline_color.a = 1.0
        for x, y in ((left, top), (right, top), (right, bottom), (left, bottom)):
            ring.points.add(x=x, y=y)
        text = found.texts.add(text=item.category, font_size=8.0)
        _stamp(text, time)
        text.position.x, text.position.y = left, top
        text.text_color.g = text.text_color.a = 1.0
    return found
