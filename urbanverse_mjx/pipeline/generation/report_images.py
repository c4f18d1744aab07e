"""Draws images of a report: frames with masks, thumbnails of matched assets, cousins from eye level and above."""

import pathlib
from collections.abc import Callable, Sequence

import mujoco
import numpy as np
from PIL import Image

from ...assets.appearances import appearance_search
from ...assets.selection.search import library
from ...datatypes import Recording, SceneBank, SceneGraph, ValidationError
from ...viz.images import Studio

#: Number of frames shown, and of views of the cousins along the trajectory.
FRAMES, VIEWS = 4, 3
VIEW_SIZE, ABOVE_SIZE = (640, 360), (1000, 460)
#: Rays per pixel along each side, downward slope of views (m over 8 m), and elevation of views from above (rad).
SAMPLES, LOOK_DOWN, ELEVATION = 2, 0.4, np.radians(78.0)
_QUALITY = 88


def save_jpeg(image: np.ndarray, path: pathlib.Path) -> str:
    """Writes (H, W, 3) uint8 and returns the file's name."""
    Image.fromarray(image).save(path, "JPEG", quality=_QUALITY, optimize=True)
    return path.name


def masked_frames(recording: Recording, colours: dict[str, str], folder: pathlib.Path) -> list[str]:
    """Draws some frames with instances tinted and outlined in the colours of their labels; returns the names of the
    files."""
    chosen = np.unique(np.linspace(0, len(recording) - 1, min(FRAMES, len(recording))).round().astype(int))
    names = []
    for number in chosen.tolist():
        image, masks = recording.rgb(number), recording.masks(number)
        if masks is not None:
            labels = [d.label for d in recording.frames[number].detections]
            image = _overlaid(image, masks, [_rgb(colours.get(label, "#888888")) for label in labels])
        names.append(save_jpeg(image, folder / f"frame_{number:06d}.jpg"))
    return names


def _overlaid(image: np.ndarray, masks: np.ndarray, tints: Sequence[tuple[int, int, int]]) -> np.ndarray:
    table = np.array([*tints, (0, 0, 0)], np.float64)  # -1, no object, picks the last
    tinted = 0.55 * image + 0.45 * table[masks]
    shown = np.where(masks[..., None] >= 0, tinted, 0.8 * image + 40.0)
    edge = np.zeros(masks.shape, bool)
    edge[:-1] |= masks[:-1] != masks[1:]
    edge[:, :-1] |= masks[:, :-1] != masks[:, 1:]
    shown[edge] = 255.0
    return np.clip(shown, 0, 255).astype(np.uint8)


def _rgb(colour: str) -> tuple[int, int, int]:
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)


def asset_thumbnails(uids: Sequence[str], folder: pathlib.Path) -> dict[str, str]:
    """uid -> file; empty without off-screen OpenGL."""
    try:
        found = library().load_thumbnails(list(dict.fromkeys(uids)))
    except (ValidationError, ImportError, OSError, AttributeError, mujoco.FatalError):
        # MuJoCo's renderer raises any of these without a working OpenGL.
        return {}
    return {uid: save_jpeg(image, folder / f"{uid.replace('/', '--')}.jpg") for uid, image in found.items()}


def appearance_thumbnails(uids: Sequence[str], folder: pathlib.Path) -> dict[str, str]:
    """uid -> file, for skies and for grounds of the large collection."""
    names = {}
    for uid in dict.fromkeys(uids):
        name = f"{uid.replace('/', '--')}.jpg"
        for collection in (appearance_search.road, appearance_search.sidewalk, appearance_search.sky):
            if uid in collection.get_uids_all():
                names[uid] = save_jpeg(collection.load_thumbnails([uid])[uid], folder / name)
    return names


def cousin_images(
    bank: SceneBank, graph: SceneGraph, folder: pathlib.Path, report: Callable[[int, int], None]
) -> list[tuple[str, list[str]]]:
    """Draws every scene of the bank from above and along the trajectory; returns the names of the files."""
    street_level, above = (Studio(bank, *size, samples=SAMPLES) for size in (VIEW_SIZE, ABOVE_SIZE))
    views = viewpoints(graph)
    total, images = bank.num_scenes * (1 + len(views)), []
    for scene in range(bank.num_scenes):
        top = save_jpeg(above.birdseye(scene, ELEVATION), folder / f"cousin_{scene}_above.jpg")
        report(scene * (1 + len(views)) + 1, total)
        names = []
        for k, (camera_position, target) in enumerate(views):
            image = street_level.view(scene, camera_position, target)
            names.append(save_jpeg(image, folder / f"cousin_{scene}_view_{k}.jpg"))
            report(scene * (1 + len(views)) + 2 + k, total)
        images.append((top, names))
    return images


def viewpoints(graph: SceneGraph) -> list[tuple[np.ndarray, np.ndarray]]:
    """(camera_position, target) m at some points of the trajectory, looking along it; none without a trajectory."""
    if not graph.camera_path:
        return []
    places = viewpoint_rows(graph)
    found = []
    for x, y, z, yaw in (graph.camera_path[i] for i in places):
        camera_position = np.array([x, y, z])
        found.append((camera_position, camera_position + 8.0 * np.array([np.cos(yaw), np.sin(yaw), -LOOK_DOWN / 8.0])))
    return found


def viewpoint_rows(graph: SceneGraph) -> list[int]:
    """Rows of the trajectory for `viewpoints`: evenly spaced, each shifted to the nearby row whose yaw is most aligned
    with the path."""
    path = np.array(graph.camera_path)
    step = np.gradient(path[:, :2], axis=0) if len(path) > 1 else np.zeros((1, 2))
    ahead = np.cos(path[:, 3]) * step[:, 0] + np.sin(path[:, 3]) * step[:, 1]
    ahead /= np.maximum(np.linalg.norm(step, axis=1), 1e-9)
    reach, last = len(path) // (4 * VIEWS), len(path) - 1
    rows = []
    for k in range(VIEWS):
        middle = round(last * (k + 0.5) / VIEWS)
        low = max(0, middle - reach)
        rows.append(low + int(ahead[low : middle + reach + 1].argmax()))
    return sorted(set(rows))
