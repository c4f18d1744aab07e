"""Films of a page as H.264: the recording's frames, the same with masks, and cousins from the frames' cameras."""

import dataclasses
import pathlib
from collections.abc import Callable, Iterable, Sequence

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

from ....datasets.video import encode, write_mp4
from ....datatypes import KIND_INDEX, Recording, SceneBank, ValidationError
from ....datatypes.recording import SKY
from ....simulation.rendering.renderer import Renderer
from ....viz.graphs import GROUND_COLOURS
from .cameras import Shot, Shots

#: Frames per second of the files; the page seeks, so this is not the recording's rate.
RATE = 10
#: Images of cousins rendered for one page, and the least number for one cousin.
COUSIN_IMAGES, LEAST_IMAGES = 120, 12
#: Rays per pixel along each side.
SAMPLES = 2
#: Fewest pixels of a detection of which a box is shown, in the recording's own pixels.
_MIN_PIXELS = 12
_GREY = 96


@dataclasses.dataclass(frozen=True)
class Film:
    """A film: mp4, and the moments (rows of `Shots.shots`) that its frames show."""

    mp4: bytes
    rows: tuple[int, ...]


@dataclasses.dataclass(frozen=True)
class Seen:
    """What a detector found in a frame: box (left, top, right, bottom) in the film's pixels, label, score."""

    box: tuple[float, float, float, float]
    label: str
    score: float


@dataclasses.dataclass(frozen=True)
class FilmedRecording:
    """The films of a recording.

    Attributes:
      frames, masked: its images, and the images with detections and ground tinted.
      seen: the detections of every moment.
      damaged: a sentence for each moment whose image or masks cannot be read; a grey image stands for it.
    """

    frames: Film
    masked: Film | None
    seen: tuple[tuple[Seen, ...], ...]
    damaged: tuple[str, ...]


def film_recording(
    recording: Recording, shots: Shots, colours: dict[str, str], folder: pathlib.Path
) -> FilmedRecording:
    """Reads and encodes the frames of a recording.

    Args:
      colours: label -> CSS colour (#rrggbb).
      folder: for temporary files.

    Raises:
      ValidationError: no ffmpeg.
    """
    size = shots.camera.height, shots.camera.width
    images, masked, seen, damaged = [], [], [], []
    tinted = False
    for shot in shots.shots:
        image, found, codes = np.full((*size, 3), _GREY, np.uint8), (), None
        try:
            image = _resized(recording.rgb(shot.number), size)
            masks, codes = recording.masks(shot.number), recording.surfaces(shot.number)
            labels = [(d.label, d.score) for d in recording.frames[shot.number].detections]
            found = () if masks is None else tuple(_boxes(masks, labels, size))
            shown = _tinted(image, masks, codes, [colours.get(label, "#888888") for label, _ in labels])
            tinted |= masks is not None or codes is not None
        except ValidationError as error:
            damaged.append(str(error))
            shown = image
        images.append(image)
        masked.append(shown)
        seen.append(found)
    rows = range(len(images))
    frames = _film(images, rows, size, folder)
    return FilmedRecording(frames, _film(masked, rows, size, folder) if tinted else None, tuple(seen), tuple(damaged))


def rendered_rows(shots: Shots, cousins: int) -> list[int]:
    """The rows of the moments at which each of so many cousins is rendered: those with a pose, evenly spaced, as many
    as `COUSIN_IMAGES` allows."""
    posed = [row for row, shot in enumerate(shots.shots) if shot.pose is not None]
    if not posed:
        return []
    count = min(len(posed), max(COUSIN_IMAGES // cousins, LEAST_IMAGES))
    return sorted({posed[k] for k in np.linspace(0, len(posed) - 1, count).round().astype(int)})


def film_cousins(
    bank: SceneBank, shots: Shots, folder: pathlib.Path, progress: Callable[[int, int], None]
) -> list[Film]:
    """Renders every scene of a bank from the moments' cameras; empty where no moment has a pose.

    The renderer's principal point is the image's centre; a recording's may lie a few pixels beside it.

    Args:
      progress: called with (images done, images in all).

    Raises:
      ValidationError: no ffmpeg.
    """
    rows = rendered_rows(shots, bank.num_scenes)
    if not rows:
        return []
    camera = shots.camera
    renderer = Renderer(bank, None, camera.height, camera.width, shadows=True, samples=SAMPLES)
    fovy = 2.0 * np.arctan(camera.height / (2.0 * camera.fy))
    films = []
    for scene in range(bank.num_scenes):
        images = []
        for row in rows:
            images.append(_rendered(renderer, scene, shots.shots[row], fovy))
            progress(scene * len(rows) + len(images), bank.num_scenes * len(rows))
        films.append(_film(images, rows, (camera.height, camera.width), folder))
    return films


def _rendered(renderer: Renderer, scene: int, shot: Shot, fovy: float) -> np.ndarray:
    assert shot.pose is not None
    # The renderer looks along -z with y upwards, OpenCV's cameras along z with y downwards.
    turn = Rotation.from_matrix(shot.pose[:3, :3] * [1.0, -1.0, -1.0]).as_quat(scalar_first=True)
    return np.asarray(renderer.view(scene, shot.pose[:3, 3], turn, fovy)["rgb"])


def _film(images: Sequence[np.ndarray], rows: Iterable[int], size: tuple[int, int], folder: pathlib.Path) -> Film:
    path = folder / "film.mp4"
    write_mp4(path, [encode(images, *size, RATE)], RATE)
    body = path.read_bytes()
    path.unlink()
    return Film(body, tuple(rows))


def _resized(image: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    if image.shape[:2] == size:
        return image
    return np.asarray(cv2.resize(image, size[::-1], interpolation=cv2.INTER_AREA))


def _boxes(masks: np.ndarray, labels: Sequence[tuple[str, float]], size: tuple[int, int]) -> Iterable[Seen]:
    scale = size[1] / masks.shape[1], size[0] / masks.shape[0]
    for k, (label, score) in enumerate(labels):
        inside = masks == k
        if np.count_nonzero(inside) < _MIN_PIXELS:
            continue
        rows, columns = np.flatnonzero(inside.any(1)), np.flatnonzero(inside.any(0))
        left, right = columns[0] * scale[0], (columns[-1] + 1) * scale[0]
        top, bottom = rows[0] * scale[1], (rows[-1] + 1) * scale[1]
        yield Seen((float(left), float(top), float(right), float(bottom)), label, score)


def _tinted(
    image: np.ndarray, masks: np.ndarray | None, codes: np.ndarray | None, colours: Sequence[str]
) -> np.ndarray:
    """The image with ground in the colours of maps, detections in those of their labels, and white outlines."""
    size = image.shape[:2]
    shown = image.astype(np.float64)
    if codes is not None:
        table = np.zeros((256, 3))
        for kind, colour in GROUND_COLOURS.items():
            table[KIND_INDEX[kind]] = colour
        codes = _nearest(codes, size)
        ground = (codes > 0) & (codes != SKY)
        shown[ground] = 0.5 * shown[ground] + 0.5 * table[codes[ground]]
    if masks is not None:
        masks = _nearest(masks, size)
        tints = np.array([[int(c[i : i + 2], 16) for i in (1, 3, 5)] for c in (*colours, "#000000")], np.float64)
        inside = masks >= 0
        shown[inside] = 0.45 * shown[inside] + 0.55 * tints[masks[inside]]
        edge = np.zeros(size, bool)
        edge[:-1] |= masks[:-1] != masks[1:]
        edge[:, :-1] |= masks[:, :-1] != masks[:, 1:]
        shown[edge] = 255.0
    return np.clip(shown, 0, 255).astype(np.uint8)


def _nearest(codes: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    rows, columns = ((np.arange(n) + 0.5) * m / n for n, m in zip(size, codes.shape, strict=True))
    return codes[rows.astype(int)][:, columns.astype(int)]
