"""Camera and LiDAR in driven episodes, drawn in batches across episodes."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import jax
import jax.numpy as jnp
import numpy as np

from ...datasets.features import IMAGE_AXES, Feature
from ...geometry import rotations
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
#: Largest number of an image of 16 bits.
MOST = 65535
_MILLIMETRES = 1000.0
#: Pixels of a batch on a GPU.
_PIXELS = 2**24
#: Outputs of the T steps of an episode by name, in parts (t, H, W, ...) whose lengths add up to T.
Drawn = dict[str, list[np.ndarray]]


def camera_features(height: int, width: int, sensors: Sequence[str], lidar: LidarOptions) -> dict[str, Feature]:
    """The features of the images."""
    found = {FRONT: Feature("video", (height, width, 3), IMAGE_AXES, {"is_depth_map": False})}
    for sensor in sensors:
        depth = {"is_depth_map": True, "depth_unit": "mm"} if sensor == "depth" else None
        channels = 3 if sensor == "normal" else 1
        feature = Feature("image", (height, width, channels), IMAGE_AXES, depth)
        found[SENSORS[sensor][0]] = lidar.feature if sensor == "lidar" else feature
    return found


def numbered(image: np.ndarray, offset: int) -> np.ndarray:
    """(H, W) u16 of an image of metres (in mm, at most 65,535, 0 where nothing is) or of labels: those of the renderer
    below zero become 0 (sky), 1 (robot), 2 (all agents); the others follow from `offset` on."""
    if image.dtype.kind == "f":
        return np.rint(np.clip(image * _MILLIMETRES, 0, MOST)).astype(np.uint16)
    return np.where(image < 0, np.minimum(-1 - image, 2), np.minimum(image + offset, MOST)).astype(np.uint16)


def as_colours(normals: np.ndarray) -> np.ndarray:
    """(H, W, 3) u8 of unit normals: 128 + 127 n, rounded; 128 in all channels is no surface."""
    return np.rint(128.0 + 127.0 * normals).astype(np.uint8)


class Camera:
    """The robot's camera as the environment's config has it, but for size and outputs.

    Args:
      env: whose episodes are drawn.
      height, width: pixels.
      sensors: of `SENSORS`, besides colour.
      lidar: casts that sensor's scans; None without it.
      labels: whether "object" and "coverage" are drawn whatever the sensors are.
    """

    def __init__(
        self,
        env: "NavEnv",
        height: int,
        width: int,
        sensors: Sequence[str],
        lidar: Lidar | None = None,
        labels: bool = False,
    ) -> None:
        from ...simulation.rendering.renderer import Renderer

        view = env.config.vision_config
        renderer = Renderer(
            env.bank,
            env.robot,
            height,
            width,
            outputs=(
                "rgb",
                *(SENSORS[s][1] for s in sensors if s != "lidar"),
                *(["object", "coverage"] if labels else []),
            ),
            shadows=view.shadows,
            sky=view.sky,
            shading=view.shading,
            appearance=env.config.randomization.appearance,
            agents=env.agent_appearances,
            bodies=env.num_bodies,
            light=view.get("light", "direct"),
        )
        self._lidar = lidar
        assert renderer.camera is not None
        self._fixed = renderer.camera.body, renderer.camera.quaternion
        self._renderer = renderer
        self._draw = jax.jit(jax.vmap(self._sensed))
        #: Frames that are drawn at once.
        self.batch = 32 if jax.default_backend() == "cpu" else max(1, min(512, _PIXELS // (height * width)))

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

    def draw(self, episodes: Sequence[Driven]) -> Iterator[tuple[Driven, Drawn]]:
        """The outputs of every step of every episode, in their order. While a batch is taken from the device, the next
        one is drawn."""
        lengths = [len(e.steps.running) for e in episodes]
        ends = np.cumsum(lengths)
        parts: list[dict[str, np.ndarray]] = []
        number = 0
        for start, images in self._batches(episodes):
            stop = min(start + self.batch, int(ends[-1]))
            at = start
            while at < stop:
                upto = min(stop, int(ends[number]))
                parts.append({name: x[at - start : upto - start] for name, x in images.items()})
                at = upto
                if at == ends[number]:
                    yield episodes[number], {name: [part[name] for part in parts] for name in images}
                    parts, number = [], number + 1

    def _batches(self, episodes: Sequence[Driven]) -> Iterator[tuple[int, dict[str, np.ndarray]]]:
        """(first frame, outputs) of batches of one size, so that one program draws all."""
        inputs = [
            (np.full(len(e.steps.running), e.scene), e.steps.xpos, e.steps.xquat, e.steps.appearance_seed)
            + (e.steps.agents, e.steps.bodies)
            for e in episodes
        ]
        columns = jax.tree.map(lambda *parts: np.concatenate(parts), *inputs)
        count, drawn = len(columns[0]), None
        for start in range(0, count, self.batch):
            rows = np.minimum(np.arange(start, start + self.batch), count - 1)
            following = self._draw(*jax.tree.map(lambda x, rows=rows: x[rows], columns))
            if drawn is not None:
                yield start - self.batch, {name: np.asarray(x) for name, x in drawn.items()}
            drawn = following
        if drawn is not None:
            yield (count - 1) // self.batch * self.batch, {name: np.asarray(x) for name, x in drawn.items()}
