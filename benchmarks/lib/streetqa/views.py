"""Cameras on the streets of a bank and what they show: an RGB image, and per pixel its object and depth.

Files of a view in the folder of a data set: images/NAME.png, and labels/NAME.npz with the visual slot (H, W) i16 of
each pixel (-1 the sky), planar depth (H, W) f32 m, coverage (N,) i32 (pixels that each slot would have alone), position
(3,) m of the camera, its ground's height, yaw and pitch (rad), scene id and split.
"""

import dataclasses
import math
import pathlib
import zlib
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import jax
import numpy as np
from PIL import Image

from urbanverse_mjx.datatypes import SceneBank, array_file, content_hash
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.simulation.rendering.cameras import look_at
from urbanverse_mjx.simulation.rendering.renderer import Renderer

HEIGHT, WIDTH = 320, 480
#: rad, vertical angle of view; 3:2 images are 72° wide.
FOVY = 0.9
#: m above the ground, and rad downwards: a person's hand or a tall delivery robot.
CAMERA_HEIGHT, PITCH = 1.3, -0.12
#: rad, standard deviation of the heading about the route's; m between cameras of one scene.
HEADING_SPREAD, APART = 0.7, 3.0
#: A view is used if at least so many objects have `CLEAR` pixels, no object covers a larger share, and the median
#: pixel is at least so many metres away.
LEAST_OBJECTS, CLEAR, LARGEST_SHARE, LEAST_MEDIAN = 5, 150, 0.45, 3.0
#: Candidates drawn per view that is wanted.
CANDIDATES = 3
_BATCH = 4


@dataclasses.dataclass(frozen=True)
class View:
    """A camera and its label images.

    Attributes:
      name: of its files; unique in a data set.
      scene, split: id and split of its scene.
      position: (3,) m; ground: m, height of the ground below it; yaw, pitch: rad, upwards positive.
      slots: (H, W) i16, visual slot of each pixel, -1 the sky.
      depth: (H, W) f32 m along the camera's axis, 0 where nothing is.
      coverage: (N,) i32, pixels of each slot if nothing else were there.
    """

    name: str
    scene: str
    split: str
    position: np.ndarray
    ground: float
    yaw: float
    pitch: float
    slots: np.ndarray
    depth: np.ndarray
    coverage: np.ndarray

    @property
    def focal(self) -> float:
        """Pixels."""
        return self.slots.shape[0] / 2 / math.tan(FOVY / 2)

    @property
    def axes(self) -> np.ndarray:
        """(3, 3): rows are the camera's right, down and forward in the world."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        cp, sp = math.cos(self.pitch), math.sin(self.pitch)
        forward = np.array([c * cp, s * cp, sp])
        right = np.array([s, -c, 0.0])
        return np.stack([right, np.cross(forward, right), forward])

    def project(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pixels (n, 2) as row, column, and depth (n,) m, of points (n, 3) m; pixels of points behind are not valid."""
        local = (points - self.position) @ self.axes.T
        depth = np.maximum(local[:, 2], 1e-6)
        h, w = self.slots.shape
        column = self.focal * local[:, 0] / depth + w / 2
        row = self.focal * local[:, 1] / depth + h / 2
        return np.stack([row, column], -1), local[:, 2]

    def points(self) -> np.ndarray:
        """(H, W, 3) m: the point of the world that each pixel's centre shows; the camera's position for the sky."""
        h, w = self.slots.shape
        x = (np.arange(w) + 0.5 - w / 2) / self.focal
        y = (np.arange(h) + 0.5 - h / 2) / self.focal
        rays = np.stack([*np.meshgrid(x, y), np.ones((h, w))], -1)
        return self.position + (rays * self.depth[..., None]) @ self.axes

    def save(self, folder: pathlib.Path) -> None:
        """Writes NAME.npz."""
        place = np.array([*self.position, self.ground, self.yaw, self.pitch])
        text = np.frombuffer(f"{self.scene}\n{self.split}".encode(), np.uint8)
        arrays = {"slots": self.slots, "depth": self.depth, "coverage": self.coverage, "place": place, "text": text}
        array_file.save(folder / f"{self.name}.npz", arrays)

    @staticmethod
    def load(path: pathlib.Path) -> "View":
        """Reads NAME.npz.

        Raises:
          ValidationError: no such file, or a damaged one.
        """
        if not path.is_file():
            raise v.fail(str(path), "no such file", "the labels of a view", "make the data set again")
        a = array_file.load(path, "a view's labels", "delete its folder of views and make the data set again")
        if set(a) != {"slots", "depth", "coverage", "place", "text"}:
            raise v.fail(str(path), f"arrays {sorted(a)}", "the labels of a view", "make the data set again")
        scene, split = a["text"].tobytes().decode().split("\n")
        place = a["place"]
        ground, yaw, pitch = (float(x) for x in place[3:])
        labels = a["slots"], a["depth"], a["coverage"]
        return View(path.stem, scene, split, place[:3], ground, yaw, pitch, *labels)


def candidate_cameras(bank: SceneBank, scene: int, count: int, seed: int) -> list[tuple[np.ndarray, float, float]]:
    """At most `count` cameras along the routes of a scene's episodes: (3,) m, height of the ground, m, and yaw, rad.

    They depend on the scene's id and the seed only, and stand at least `APART` m from each other.
    """
    rng = np.random.default_rng([seed, zlib.crc32(bank.scene_ids[scene].encode())])
    found: list[tuple[np.ndarray, float, float]] = []
    for _ in range(40 * count):
        if len(found) == count:
            break
        row = int(rng.integers(bank.num_episodes[scene]))
        number = int(bank.episode_num_waypoints[scene, row])
        route = np.concatenate([bank.episode_start[scene, row, None, :3], bank.episode_waypoints[scene, row, :number]])
        leg = int(rng.integers(len(route) - 1))
        share, turn = float(rng.random()), float(rng.normal(0.0, HEADING_SPREAD))
        at = (1 - share) * route[leg] + share * route[leg + 1]
        along = route[leg + 1, :2] - route[leg, :2]
        if np.linalg.norm(along) < 0.2 or any(np.linalg.norm(at[:2] - p[:2]) < APART for p, _, _ in found):
            continue
        ground = float(at[2])
        yaw = math.atan2(along[1], along[0]) + turn
        found.append((np.array([at[0], at[1], ground + CAMERA_HEIGHT], np.float64), ground, yaw))
    return found


def worth_asking(slots: np.ndarray, depth: np.ndarray, grounds: np.ndarray) -> bool:
    """Whether a view shows enough: see `LEAST_OBJECTS`.

    Args:
      slots, depth: (H, W) as of a `View`.
      grounds: (N,) bool, which slots are ground.
    """
    solid = (slots >= 0) & ~grounds[np.maximum(slots, 0)]
    pixels = np.bincount(slots[solid].astype(int), minlength=len(grounds))
    shown = depth[slots != -1]
    return bool(
        (pixels >= CLEAR).sum() >= LEAST_OBJECTS
        and pixels.max(initial=0) <= LARGEST_SHARE * slots.size
        and shown.size
        and np.median(shown) >= LEAST_MEDIAN
    )


def is_ground(bank: SceneBank, scene: int) -> np.ndarray:
    """(N,) bool: slots of a scene that are ground."""
    ground = np.array([name.startswith("ground:") for name in bank.meta["categories"]])
    return (bank.slot_mesh[scene] >= 0) & ground[bank.slot_category[scene]]


def make_views(
    bank: SceneBank,
    scenes: Sequence[int],
    split: str,
    per_scene: int,
    seed: int,
    folder: pathlib.Path,
    progress: Callable[[str], None] = lambda _: None,
) -> Iterator[View]:
    """Renders and writes up to `per_scene` views of each scene; those whose files exist are read instead.

    Not so where they are of another seed, or of another bank that numbers the scene's objects otherwise.

    Args:
      folder: of the data set, for the files `images/NAME.png` and `labels/NAME.npz`; made if missing.
      progress: called with the name of each view.
    """
    images_folder, labels_folder = folder / "images", folder / "labels"
    for made in (images_folder, labels_folder):
        made.mkdir(parents=True, exist_ok=True)
    drawers: list[Callable[..., dict[str, np.ndarray]]] = []
    for scene in scenes:
        name = bank.scene_ids[scene]
        state = labels_folder / f"{name}.json"
        key = {"seed": seed, "objects": _objects_key(bank, scene)}
        used, number = _progress_of(state, key)
        number = min(number, per_scene)
        for k in range(number):
            yield dataclasses.replace(View.load(labels_folder / f"{view_name(name, k)}.npz"), split=split)
        cameras = candidate_cameras(bank, scene, CANDIDATES * per_scene, seed)
        while number < per_scene and used < len(cameras):
            if not drawers:
                drawers = [_drawer(bank, ("depth", "object", "coverage"), 1), _drawer(bank, ("rgb",), 2)]
            found = _worthy(bank, scene, split, cameras[used : used + _BATCH], number, drawers[0])
            used, found = used + _BATCH, found[: per_scene - number]
            if found:
                colours = drawers[1](scene, [(view.position, view.ground, view.yaw) for view in found])["rgb"]
                for view, rgb in zip(found, colours, strict=False):
                    Image.fromarray(rgb).save(images_folder / f"{view.name}.png")
                    view.save(labels_folder)
                    progress(view.name)
                number += len(found)
                if number == per_scene:
                    # The next candidate is the one after the last view's, so that more views continue these.
                    last = found[-1].position
                    used = next(k + 1 for k, (at, _, _) in enumerate(cameras) if np.array_equal(at, last))
                yield from found
            v.write_json(state, {**key, "used": used, "views": number})


def _objects_key(bank: SceneBank, scene: int) -> str:
    """Hash of what the numbers in label images mean: the categories, places and meshes of a scene's slots."""
    slots = np.flatnonzero(bank.slot_mesh[scene] >= 0)
    mesh = bank.slot_mesh[scene, slots]
    return content_hash(
        {
            "slots": slots,
            "categories": [bank.meta["categories"][k] for k in bank.slot_category[scene, slots]],
            "positions": bank.slot_position[scene, slots],
            "quaternions": bank.slot_quaternion[scene, slots],
            "corners": bank.mesh_vertex_start[mesh + 1] - bank.mesh_vertex_start[mesh],
        }
    )


def _progress_of(state: pathlib.Path, key: dict[str, Any]) -> tuple[int, int]:
    """Numbers of candidates tried and of views written for a scene, 0 for another key."""
    if not state.is_file():
        return 0, 0
    body = v.mapping(v.read_json(state, "state of views"), str(state), ("seed", "used", "views"), ("objects",))
    return (int(body["used"]), int(body["views"])) if {name: body.get(name) for name in key} == key else (0, 0)


def _worthy(
    bank: SceneBank,
    scene: int,
    split: str,
    cameras: Sequence[tuple[np.ndarray, float, float]],
    first: int,
    labels: Callable[..., dict[str, np.ndarray]],
) -> list[View]:
    """Views of those cameras that show enough, numbered from `first` on."""
    name, grounds, found = bank.scene_ids[scene], is_ground(bank, scene), []
    images = labels(scene, cameras)
    for k, (at, ground, yaw) in enumerate(cameras):
        slots, depth = images["object"][k].astype(np.int16), images["depth"][k].astype(np.float32)
        if worth_asking(slots, depth, grounds):
            coverage = images["coverage"][k][: len(grounds)].astype(np.int32)
            number = view_name(name, first + len(found))
            found.append(View(number, name, split, at, ground, yaw, PITCH, slots, depth, coverage))
    return found


def view_name(scene: str, number: int) -> str:
    """Name of a scene's view, of letters, digits, _ and -."""
    return f"{scene}_{number:02d}"


def _drawer(bank: SceneBank, outputs: Sequence[str], samples: int) -> Callable[..., dict[str, np.ndarray]]:
    """A function (scene, cameras) -> images, of at most `_BATCH` cameras, which compiles once."""
    shading = "pbr" if "rgb" in outputs else "matte"
    renderer = Renderer(bank, None, HEIGHT, WIDTH, outputs, samples=samples, shading=shading)
    compiled = jax.jit(jax.vmap(lambda scene, at, turn: renderer.view(scene, at, turn, FOVY)))

    def draw(scene: int, cameras: Sequence[tuple[np.ndarray, float, float]]) -> dict[str, np.ndarray]:
        padded = [*cameras, *[cameras[-1]] * (_BATCH - len(cameras))]
        places = np.array([at for at, _, _ in padded], np.float32)
        turns = np.array([_turn(at, yaw) for at, _, yaw in padded], np.float32)
        images = compiled(np.full(_BATCH, scene, np.int32), places, turns)
        return {name: np.asarray(x) for name, x in images.items()}

    return draw


def _turn(at: np.ndarray, yaw: float) -> np.ndarray:
    ahead = np.array([math.cos(yaw) * math.cos(PITCH), math.sin(yaw) * math.cos(PITCH), math.sin(PITCH)])
    return look_at(at, at + ahead)
