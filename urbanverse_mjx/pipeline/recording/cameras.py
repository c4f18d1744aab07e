"""The robot's camera in driven episodes: drawn in batches across episodes, encoded while the next ones are drawn."""

import collections
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import cv2
import jax
import numpy as np

from ...datasets.features import IMAGE_AXES, Feature
from ...datasets.statistics import PixelCounts, Stats
from ...datasets.video import Encoder
from .driving import Driven

if TYPE_CHECKING:
    from ...envs import NavEnv

FRONT = "observation.images.front"
#: What `--with` takes -> (feature, the renderer's output, number that makes its labels non-negative).
SENSORS = {
    "depth": ("observation.images.depth", "depth", 0),
    "semantic": ("observation.images.semantic", "category", 2),
    "instance": ("observation.images.instance", "object", 3),
}
#: What several of them are called together.
GROUPS = {"segmentation": ("semantic", "instance")}
_MILLIMETRES, _MOST = 1000.0, 65535
#: Images of which pixels are counted for the statistics: every fourth.
_COUNTED = 4
#: Encoders that may still be at work when the next episode is drawn.
_WAITING = 4


def camera_features(height: int, width: int, sensors: Sequence[str]) -> dict[str, Feature]:
    """The features of the camera's images."""
    found = {FRONT: Feature("video", (height, width, 3), IMAGE_AXES, {"is_depth_map": False})}
    for sensor in sensors:
        depth = {"is_depth_map": True, "depth_unit": "mm"} if sensor == "depth" else None
        found[SENSORS[sensor][0]] = Feature("image", (height, width, 1), IMAGE_AXES, depth)
    return found


class _Images:
    """Images of one episode under way."""

    def __init__(self, height: int, width: int, rate: int, sensors: Sequence[str]) -> None:
        self.encoder = Encoder(height, width, rate)
        self.stored: dict[str, list[bytes]] = {SENSORS[s][0]: [] for s in sensors}
        self._sensors, self._number = sensors, 0
        self._counts = {FRONT: PixelCounts(3, 256)} | {SENSORS[s][0]: PixelCounts(1, _MOST + 1) for s in sensors}

    def add(self, frame: Mapping[str, np.ndarray]) -> None:
        """Takes the renderer's outputs of one step."""
        counted = self._number % _COUNTED == 0
        self._number += 1
        self.encoder.write(frame["rgb"])
        if counted:
            self._counts[FRONT].add(frame["rgb"])
        for sensor in self._sensors:
            name, output, offset = SENSORS[sensor]
            image = numbered(frame[output], offset)
            done, body = cv2.imencode(".png", image)
            assert done
            self.stored[name].append(body.tobytes())
            if counted:
                self._counts[name].add(image[..., None])

    def stats(self) -> dict[str, Stats]:
        """As LeRobot has them: colours and labels divided by 255, distances as they are."""
        depth = SENSORS["depth"][0]
        return {name: counts.stats(1.0 if name == depth else 255.0) for name, counts in self._counts.items()}


def numbered(image: np.ndarray, offset: int) -> np.ndarray:
    """(H, W) u16 of an image of metres (in mm, at most 65,535, 0 where nothing is) or of labels (plus `offset`)."""
    if image.dtype.kind == "f":
        return np.rint(np.clip(image * _MILLIMETRES, 0, _MOST)).astype(np.uint16)
    return np.clip(image + offset, 0, _MOST).astype(np.uint16)


class Camera:
    """The robot's camera as the environment's config has it, but for size and outputs.

    Args:
      env: whose episodes are drawn.
      height, width: pixels.
      sensors: of `SENSORS`, besides colour.
    """

    def __init__(self, env: "NavEnv", height: int, width: int, sensors: Sequence[str]) -> None:
        from ...simulation.rendering.renderer import Renderer

        view = env.config.vision_config
        self._size, self._sensors, self._rate = (height, width), tuple(sensors), round(1.0 / env.dt)
        renderer = Renderer(
            env.bank,
            env.robot,
            height,
            width,
            outputs=("rgb", *(SENSORS[s][1] for s in sensors)),
            shadows=view.shadows,
            sky=view.sky,
            shading=view.shading,
            appearance=env.config.randomization.appearance,
            agents=env.agent_appearances,
            bodies=env.num_bodies,
        )
        self._draw = jax.jit(jax.vmap(renderer.__call__))
        self._batch = 32 if jax.default_backend() == "cpu" else 512

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

    def film(
        self, episodes: Sequence[Driven]
    ) -> Iterator[tuple[Driven, bytes, dict[str, list[bytes]], dict[str, Stats]]]:
        """Of every episode, in their order: H.264 bytes, PNG files by feature, and statistics by feature."""
        waiting: collections.deque[tuple[int, _Images]] = collections.deque()
        try:
            for number, frame in self._frames(episodes):
                if not waiting or waiting[-1][0] != number:
                    if waiting:
                        waiting[-1][1].encoder.close()
                    waiting.append((number, _Images(*self._size, self._rate, self._sensors)))
                while len(waiting) > _WAITING:
                    yield self._filmed(episodes, *waiting.popleft())
                waiting[-1][1].add(frame)
            if waiting:
                waiting[-1][1].encoder.close()
            while waiting:
                yield self._filmed(episodes, *waiting.popleft())
        finally:
            for _, images in waiting:
                images.encoder.stop()

    @staticmethod
    def _filmed(episodes: Sequence[Driven], number: int, images: _Images) -> Any:
        return episodes[number], images.encoder.result(), images.stored, images.stats()
