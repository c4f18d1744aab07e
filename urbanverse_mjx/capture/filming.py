"""`film_scene`: renders a scene along a camera path to a `Recording` with ground truth."""

import dataclasses
import os
import pathlib
from collections.abc import Callable, Iterator

import jax
import jax.numpy as jnp
import numpy as np
from scipy.spatial.transform import Rotation

from ..datatypes import KIND_INDEX, Camera, Detection, Recording, RecordingWriter, SceneBank, ValidationError
from ..datatypes.recording import SKY
from ..simulation.rendering.settings import SKY_LABEL
from .ground_truth import SOURCE, object_id, object_slots, true_graph
from .path import CameraPath, PathOptions, walk
from .street import GROUND_PREFIX

GROUND_TRUTH_FILE = "truth.json"
_BATCH = 8
#: From the renderer's camera axes (view along -z, +y up) to OpenCV's (view along +z, +y down).
_FLIP = np.diag([1.0, -1.0, -1.0])


@dataclasses.dataclass(frozen=True)
class FilmOptions:
    """Options of a capture.

    Attributes:
      width, height: pixels.
      fovy: rad, vertical field of view (50° and 16:9 see 79° wide, as an action camera does).
      samples: rays per pixel and side of the RGB image; depth and masks use the centre of each pixel.
      shadows: whether the sun casts shadows.
      rgb: whether to render the images; if False they are black, and only geometry is recorded.
      min_pixels: objects that cover fewer pixels of a frame are not in its masks.
    """

    width: int = 640
    height: int = 360
    fovy: float = np.radians(50.0)
    samples: int = 2
    shadows: bool = True
    rgb: bool = True
    min_pixels: int = 12

    def __post_init__(self) -> None:
        if not 0.1 < self.fovy < 2.6:
            raise ValidationError(f"film_scene: fovy: found {self.fovy:g} rad, needed 0.1 to 2.6.")


def film_scene(
    bank: SceneBank,
    scene: int,
    folder: str | os.PathLike[str],
    path: CameraPath | PathOptions | None = None,
    options: FilmOptions | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Recording:
    """Films one scene; `truth.json` in the recording's folder holds the true graph of its objects and ground.

    Args:
      bank, scene: bank, and number of the scene in it.
      folder: folder of the recording.
      path: camera path, or options of `walk`.
      options: size, field of view and quality.
      progress: called with (frames done, frames in all).

    Returns:
      the recording: RGB, planar depth, masks with true labels and the objects' ids as tracks, ground kinds, poses.

    Raises:
      ValidationError: the bank does not have the scene, or the folder cannot be written.
    """
    if not 0 <= scene < bank.num_scenes:
        raise ValidationError(f"scene: found {scene}, needed 0 to {bank.num_scenes - 1}, the scenes of the bank.")
    options = options or FilmOptions()
    path = path if isinstance(path, CameraPath) else walk(bank, scene, path)
    camera = Camera.from_fov(options.width, options.height, options.fovy)
    writer = RecordingWriter(folder, bank.scene_ids[scene], SOURCE, camera)
    labels = _Labels(bank, scene)
    for i, (rgb, depth, obj, category) in enumerate(_render(bank, scene, path, options)):
        masks, found = labels.masks(obj, options.min_pixels)
        surfaces = labels.surface[category]
        writer.add(float(path.time_s[i]), rgb, depth, masks, surfaces, path.T_world_camera[i], found)
        if progress is not None:
            progress(i + 1, len(path.time_s))
    true_graph(bank, scene, path).save(pathlib.Path(folder) / GROUND_TRUTH_FILE)
    return writer.close()


class _Labels:
    """Converts the renderer's slots and categories to detections and ground kinds."""

    def __init__(self, bank: SceneBank, scene: int) -> None:
        categories = bank.meta["categories"]
        # The additional last row is the sky, whose index is -1.
        self.surface = np.zeros(len(categories) + 1, np.uint8)
        for row, name in enumerate(categories):
            if name.startswith(GROUND_PREFIX):
                self.surface[row] = KIND_INDEX[name.removeprefix(GROUND_PREFIX)]
        self.surface[SKY_LABEL] = SKY
        self._objects = {
            int(slot): Detection(categories[bank.slot_category[scene, slot]], 1.0, object_id(bank, scene, slot))
            for slot in object_slots(bank, scene)
        }

    def masks(self, slots: np.ndarray, min_pixels: int) -> tuple[np.ndarray, list[Detection]]:
        """(H, W) index of a detection or -1, and the detections, of an image of visual slots."""
        seen, inverse, counts = np.unique(slots, return_inverse=True, return_counts=True)
        number, found = np.full(len(seen), -1), []
        for k, slot in enumerate(seen.tolist()):
            if slot in self._objects and counts[k] >= min_pixels:
                number[k] = len(found)
                found.append(self._objects[slot])
        return number[inverse].reshape(slots.shape), found


def _render(bank: SceneBank, scene: int, path: CameraPath, options: FilmOptions) -> Iterator[tuple[np.ndarray, ...]]:
    """RGB (H, W, 3) u8, depth (H, W) m, slot and category (H, W) of every frame."""
    # Importing Warp takes a second, so it is imported on first use.
    from ..simulation.rendering.renderer import Renderer

    size = options.height, options.width
    ground_truth = Renderer(bank, None, *size, outputs=("depth", "object", "category"), shading="matte", sky=False)
    film = Renderer(bank, None, *size, shadows=options.shadows, samples=options.samples) if options.rgb else None
    camera_positions = path.T_world_camera[:, :3, 3].astype(np.float32)
    rotations = Rotation.from_matrix(path.T_world_camera[:, :3, :3] @ _FLIP)
    turns = rotations.as_quat(scalar_first=True).astype(np.float32)

    def batch(renderer: Renderer) -> Callable[..., dict[str, jax.Array]]:
        return jax.jit(
            jax.vmap(lambda camera_position, turn: renderer.view(scene, camera_position, turn, options.fovy))
        )

    see, film_it = batch(ground_truth), batch(film) if film else None
    black = np.zeros((*size, 3), np.uint8)
    for start in range(0, len(camera_positions), _BATCH):
        rows = np.minimum(np.arange(start, start + _BATCH), len(camera_positions) - 1)
        cameras = jnp.asarray(camera_positions[rows]), jnp.asarray(turns[rows])
        out = {name: np.asarray(x) for name, x in see(*cameras).items()}
        rgb = np.asarray(film_it(*cameras)["rgb"]) if film_it else None
        for k in range(min(_BATCH, len(camera_positions) - start)):
            image = black if rgb is None else rgb[k]
            yield image, out["depth"][k], out["object"][k], out["category"][k]
