"""Camera and LiDAR in driven episodes: drawn in batches across episodes, encoded while the next ones are drawn."""

import collections
import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import cv2
import jax
import jax.numpy as jnp
import numpy as np

from ...datasets.annotations import Annotation
from ...datasets.features import IMAGE_AXES, Feature
from ...datasets.statistics import PixelCounts, Stats
from ...datasets.video import Encoder
from ...geometry import rotations
from .boxes import Boxes
from .driving import Driven
from .lidar import LIDAR, Lidar, LidarOptions

if TYPE_CHECKING:
    from ...envs import NavEnv

FRONT = "observation.images.front"
#: What `--with` takes -> (feature, output, number of the labels before those of objects or categories).
SENSORS = {
    "depth": ("observation.images.depth", "depth", 0),
    "semantic": ("observation.images.semantic", "category", 2),
    "instance": ("observation.images.instance", "object", 3),
    "normal": ("observation.images.normal", "normal", 0),
    "lidar": (LIDAR, "lidar", 0),
}
#: What several of them are called together.
GROUPS = {"segmentation": ("semantic", "instance")}
_MILLIMETRES, _MOST = 1000.0, 65535
#: Images of which pixels are counted for the statistics: every fourth.
_COUNTED = 4
#: Encoders that may still be at work when the next episode is drawn.
_WAITING = 4


def camera_features(height: int, width: int, sensors: Sequence[str], lidar: LidarOptions) -> dict[str, Feature]:
    """The features of the images."""
    found = {FRONT: Feature("video", (height, width, 3), IMAGE_AXES, {"is_depth_map": False})}
    for sensor in sensors:
        depth = {"is_depth_map": True, "depth_unit": "mm"} if sensor == "depth" else None
        channels = 3 if sensor == "normal" else 1
        feature = Feature("image", (height, width, channels), IMAGE_AXES, depth)
        found[SENSORS[sensor][0]] = lidar.feature if sensor == "lidar" else feature
    return found


@dataclasses.dataclass(frozen=True)
class Filmed:
    """A driven episode and its images: H.264 bytes, PNG files by feature, statistics by feature, and annotations, one a
    frame, if any. colours: image files of each frame, and scans: points (n, 3) m of each, for formats of single frames,
    which have none of the first three."""

    driven: Driven
    video: bytes
    images: dict[str, list[bytes]]
    stats: dict[str, Stats]
    annotations: list[Annotation]
    colours: list[bytes] = dataclasses.field(default_factory=list)
    scans: list[np.ndarray] = dataclasses.field(default_factory=list)


class ImageFiles:
    """In place of `Encoder`: every frame as a file of its own; kind: png, or jpg of high quality."""

    def __init__(self, kind: str) -> None:
        self._form = (".jpg", [cv2.IMWRITE_JPEG_QUALITY, 95]) if kind == "jpg" else (".png", [])
        self.images: list[bytes] = []

    def write(self, frame: np.ndarray) -> None:
        """Adds a frame (H, W, 3) u8."""
        done, body = cv2.imencode(self._form[0], frame[..., ::-1], self._form[1])
        assert done
        self.images.append(body.tobytes())

    def close(self) -> None:
        """Nothing is under way."""

    def stop(self) -> None:
        """Nothing is under way."""


class _Images:
    """Images of one episode under way."""

    def __init__(self, driven: Driven, encoder: Any, sensors: Sequence[str], lidar: Lidar | None) -> None:
        self.driven = driven
        self.annotations: list[Annotation] = []
        self.encoder, self._lidar = encoder, lidar
        self.scans: list[np.ndarray] = []
        self.stored: dict[str, list[bytes]] = {SENSORS[s][0]: [] for s in sensors}
        self._sensors, self._number = sensors, 0
        self._counts = {FRONT: PixelCounts(3, 256)} | {
            SENSORS[s][0]: PixelCounts(3, 256) if s == "normal" else PixelCounts(1, _MOST + 1) for s in sensors
        }

    def add(self, frame: Mapping[str, np.ndarray]) -> None:
        """Takes the renderer's outputs of one step."""
        if isinstance(self.encoder, ImageFiles):
            self.encoder.write(frame["rgb"])
            if self._lidar is not None:
                self.scans.append(self._lidar.points(frame["lidar"]))
            return
        counted = self._number % _COUNTED == 0
        self._number += 1
        self.encoder.write(frame["rgb"])
        if counted:
            self._counts[FRONT].add(frame["rgb"])
        for sensor in self._sensors:
            name, output, offset = SENSORS[sensor]
            normal = sensor == "normal"
            image = as_colours(frame[output]) if normal else numbered(frame[output], offset)
            done, body = cv2.imencode(".png", image[..., ::-1] if normal else image)
            assert done
            self.stored[name].append(body.tobytes())
            if counted:
                self._counts[name].add(image if normal else image[..., None])

    def result(self) -> Filmed:
        """Waits for the encoder."""
        if isinstance(self.encoder, ImageFiles):
            return Filmed(self.driven, b"", {}, {}, self.annotations, self.encoder.images, self.scans)
        return Filmed(self.driven, self.encoder.result(), self.stored, self.stats(), self.annotations)

    def stats(self) -> dict[str, Stats]:
        """As LeRobot has them: colours and labels divided by 255, distances as they are."""
        depths = SENSORS["depth"][0], LIDAR
        return {name: counts.stats(1.0 if name in depths else 255.0) for name, counts in self._counts.items()}


def numbered(image: np.ndarray, offset: int) -> np.ndarray:
    """(H, W) u16 of an image of metres (in mm, at most 65,535, 0 where nothing is) or of labels: those of the renderer
    below zero become 0 (sky), 1 (robot), 2 (all agents); the others follow from `offset` on."""
    if image.dtype.kind == "f":
        return np.rint(np.clip(image * _MILLIMETRES, 0, _MOST)).astype(np.uint16)
    return np.where(image < 0, np.minimum(-1 - image, 2), np.minimum(image + offset, _MOST)).astype(np.uint16)


def as_colours(normals: np.ndarray) -> np.ndarray:
    """(H, W, 3) u8 of unit normals: 128 + 127 n, rounded; 128 in all channels is no surface."""
    return np.rint(128.0 + 127.0 * normals).astype(np.uint8)


class Camera:
    """The robot's camera as the environment's config has it, but for size and outputs.

    Args:
      env: whose episodes are drawn.
      height, width: pixels.
      sensors: of `SENSORS`, besides colour.
      lidar: of that sensor.
      boxes: annotates every frame; None for no annotations.
      colours: "h264", or "png" or "jpg" for a file a frame.
    """

    def __init__(
        self,
        env: "NavEnv",
        height: int,
        width: int,
        sensors: Sequence[str],
        lidar: LidarOptions | None = None,
        boxes: Boxes | None = None,
        colours: str = "h264",
    ) -> None:
        from ...simulation.rendering.renderer import Renderer

        view = env.config.vision_config
        self._size, self._sensors, self._rate = (height, width), tuple(sensors), round(1.0 / env.dt)
        renderer = Renderer(
            env.bank,
            env.robot,
            height,
            width,
            outputs=("rgb", *(SENSORS[s][1] for s in sensors if s != "lidar"), *(["object"] if boxes else [])),
            shadows=view.shadows,
            sky=view.sky,
            shading=view.shading,
            appearance=env.config.randomization.appearance,
            agents=env.agent_appearances,
            bodies=env.num_bodies,
        )
        self._boxes, self._colours = boxes, colours
        self._lidar = Lidar(env, lidar or LidarOptions()) if "lidar" in sensors else None
        assert renderer.camera is not None
        self._fixed = renderer.camera.body, renderer.camera.quaternion
        self._renderer = renderer
        self._draw = jax.jit(jax.vmap(self._sensed))
        self._batch = 32 if jax.default_backend() == "cpu" else 512

    def _sensed(self, scene: Any, xpos: Any, xquat: Any, seed: Any, agents: Any, bodies: Any) -> dict[str, jax.Array]:
        """The images of one step."""
        found = self._renderer(scene, xpos, xquat, seed, agents, bodies)
        if "normal" in found:
            body, fixed = self._fixed
            back = rotations.product(xquat[body], jnp.asarray(fixed)) * jnp.array([1.0, -1.0, -1.0, -1.0])
            found["normal"] = rotations.rotate(back, found["normal"]) * jnp.array([1.0, -1.0, -1.0])
        if self._lidar is not None:
            found["lidar"] = self._lidar(scene, xpos, xquat, agents, bodies)
        return found

    def _frames(self, episodes: Sequence[Driven]) -> Iterator[tuple[int, dict[str, np.ndarray]]]:
        """(episode, outputs) of every step, in their order; batches have one size, so that one program draws all."""
        inputs = [
            (np.full(len(e.steps.running), e.scene), e.steps.xpos, e.steps.xquat, e.steps.appearance_seed)
            + (e.steps.agents, e.steps.bodies)
            for e in episodes
        ]
        columns = jax.tree.map(lambda *parts: np.concatenate(parts), *inputs)
        owner = np.repeat(np.arange(len(episodes)), [len(e.steps.running) for e in episodes])
        for start in range(0, len(owner), self._batch):
            rows = np.minimum(np.arange(start, start + self._batch), len(owner) - 1)
            drawn = self._draw(*jax.tree.map(lambda x, rows=rows: x[rows], columns))
            images = {name: np.asarray(x) for name, x in drawn.items()}
            for k in range(min(self._batch, len(owner) - start)):
                yield int(owner[start + k]), {name: x[k] for name, x in images.items()}

    def _encoder(self) -> Any:
        return Encoder(*self._size, self._rate) if self._colours == "h264" else ImageFiles(self._colours)

    def film(self, episodes: Sequence[Driven]) -> Iterator[Filmed]:
        """Every episode, in their order."""
        waiting: collections.deque[_Images] = collections.deque()
        try:
            for number, frame in self._frames(episodes):
                if not waiting or waiting[-1].driven is not episodes[number]:
                    if waiting:
                        waiting[-1].encoder.close()
                    waiting.append(_Images(episodes[number], self._encoder(), self._sensors, self._lidar))
                while len(waiting) > _WAITING:
                    yield waiting.popleft().result()
                images = waiting[-1]
                if self._boxes is not None:
                    step = len(images.annotations)
                    images.annotations.append(self._boxes.annotate(images.driven, step, frame["object"]))
                images.add(frame)
            if waiting:
                waiting[-1].encoder.close()
            while waiting:
                yield waiting.popleft().result()
        finally:
            for images in waiting:
                images.encoder.stop()
