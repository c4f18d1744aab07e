"""Camera and LiDAR in driven episodes, drawn in batches across episodes."""

import collections
from collections.abc import Iterable, Iterator, Sequence
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

    def draw(self, groups: Iterable[Sequence[Driven]]) -> Iterator[tuple[Driven, Drawn]]:
        """The outputs of every step of every episode, in their order. While a batch is taken from the device, the next
        one is drawn; frames of a group that fill no batch wait for the next group."""
        waiting: collections.deque[Driven] = collections.deque()
        parts: list[dict[str, np.ndarray]] = []
        had = 0
        for images in self._batches(groups, waiting):
            at, stop = 0, len(images["rgb"])
            while at < stop:
                length = len(waiting[0].steps.running)
                upto = min(stop, at + length - had)
                parts.append({name: x[at:upto] for name, x in images.items()})
                at, had = upto, had + upto - at
                if had == length:
                    yield waiting.popleft(), {name: [part[name] for part in parts] for name in images}
                    parts, had = [], 0

    def _batches(
        self, groups: Iterable[Sequence[Driven]], waiting: collections.deque[Driven]
    ) -> Iterator[dict[str, np.ndarray]]:
        """Outputs of batches of one size, so that one program draws all; the last ones without what fills them up.
        Adds the episodes to `waiting`."""
        rest: Any = None
        for group in groups:
            if not group:
                continue
            waiting.extend(group)
            inputs = [_seen(episode) for episode in group]
            columns = jax.tree.map(lambda *x: np.concatenate(x), *([] if rest is None else [rest]), *inputs)
            count = len(columns[0]) // self.batch * self.batch
            drawn = None
            for start in range(0, count, self.batch):
                following = self._draw(*_rows(columns, slice(start, start + self.batch)))
                if drawn is not None:
                    yield _taken(drawn)
                drawn = following
            if drawn is not None:
                yield _taken(drawn)
            rest = _rows(columns, slice(count, None)) if count < len(columns[0]) else None
        if rest is not None:
            count = len(rest[0])
            filled = _rows(rest, np.minimum(np.arange(self.batch), count - 1))
            yield {name: x[:count] for name, x in _taken(self._draw(*filled)).items()}


def _seen(episode: Driven) -> tuple[Any, ...]:
    """What the renderer takes of each step."""
    steps = episode.steps
    scene = np.full(len(steps.running), episode.scene)
    return scene, steps.xpos, steps.xquat, steps.appearance_seed, steps.agents, steps.bodies


def _rows(columns: Any, rows: Any) -> Any:
    return jax.tree.map(lambda x: x[rows], columns)


def _taken(drawn: dict[str, jax.Array]) -> dict[str, np.ndarray]:
    """From the device."""
    return {name: np.asarray(x) for name, x in drawn.items()}
