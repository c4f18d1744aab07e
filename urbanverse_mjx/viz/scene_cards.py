"""Draws the images of a scene card: one from above, two at eye level, and the map with the routes."""

import dataclasses
import io
import pathlib

import numpy as np
from PIL import Image, ImageDraw

from ..datatypes.ground import GROUND_KINDS
from ..datatypes.validation import write_atomically
from ..scene import CompiledScene, pack_bank
from ..scene.exchange_routes import load_planned
from ..scene.planner import path_length, resample
from .graphs import GROUND_COLOURS
from .images import VIEW_HEIGHT, Studio
from .scene_gallery import NAMES

#: Pixels (width, height) of the rendered images, and largest size of a map.
SIZE, MAP_SIZE = (768, 400), (960, 540)
#: rad, camera elevation; steep, because houses hide narrow streets otherwise.
ELEVATION = np.radians(74.0)
SAMPLES = 2
#: Hulls that begin lower than this (m) above the ground are drawn as obstacles, the others as shadows.
_OBSTACLE_HEIGHT = 1.0
_OBSTACLE, _SHADE = (70, 62, 60), 0.82
_ROUTES = ((214, 66, 40), (40, 96, 190), (32, 140, 90), (150, 60, 160), (230, 150, 20), (20, 150, 170))
#: Viewpoint of a person: least distance (m) from any hull, range of distances (m) of the objects in view, and their
#: largest angle (rad) to the side.
_VIEW_CLEARANCE, _VIEW_RANGE, _VIEW_HALF_ANGLE = 1.2, (3.0, 25.0), np.radians(35.0)


@dataclasses.dataclass(frozen=True)
class Viewpoint:
    """(x, y, z) m of a camera, and of its target."""

    camera_position: np.ndarray
    target: np.ndarray


def draw_card(folder: pathlib.Path, out: pathlib.Path) -> dict[str, str]:
    """Draws a compiled scene's images; `NAMES` -> the file's name in `out`."""
    scene = CompiledScene.load(folder)
    bank = pack_bank([folder], ["test"])
    studio = Studio(bank, *SIZE, samples=SAMPLES)
    images = {"map": route_map(scene), "above": studio.birdseye(0, ELEVATION)}
    for k, view in enumerate(viewpoints(scene)):
        images[f"eye_{k}"] = studio.view(0, view.camera_position, view.target)
    return {name: _save(images[name], out / f"{scene.layout.id}_{name}.jpg").name for name in NAMES if name in images}


def viewpoints(scene: CompiledScene) -> list[Viewpoint]:
    """Returns two viewpoints on the longest route, one in either half, with the most objects near and ahead."""
    routes = load_planned(scene.folder).planned
    if not routes:
        return []
    path = max(routes, key=lambda r: path_length(r.path)).path
    walk = np.concatenate([path[:1], resample(path, 1.0)])
    places = scene.geometry.object_position[:, :2]
    ahead = walk[np.minimum(np.arange(len(walk)) + 5, len(walk) - 1)] - walk
    ahead /= np.maximum(np.linalg.norm(ahead, axis=1, keepdims=True), 1e-9)
    to = places[None] - walk[:, None]
    away = np.linalg.norm(to, axis=-1)
    straight = (to * ahead[:, None]).sum(-1) / np.maximum(away, 1e-9) > np.cos(_VIEW_HALF_ANGLE)
    score = (straight & (away > _VIEW_RANGE[0]) & (away < _VIEW_RANGE[1])).sum(1) * (
        away.min(1, initial=np.inf) > _VIEW_CLEARANCE
    )
    score = score[: max(1, len(walk) - 6)]  # the last metres have no view ahead
    found = []
    for part in np.array_split(np.arange(len(score)), 2):
        if len(part):
            row = int(part[score[part].argmax()])
            found.append(_viewpoint(scene, walk[row], ahead[row]))
    return found


def _viewpoint(scene: CompiledScene, place: np.ndarray, ahead: np.ndarray) -> Viewpoint:
    m = scene.geometry.map
    i, j = np.clip(((place - m.origin) / m.resolution).astype(int), 0, np.array(m.kind.shape) - 1)
    camera_position = np.array([*place, float(m.height[i, j]) + VIEW_HEIGHT])
    return Viewpoint(camera_position, camera_position + np.array([*(ahead * 8.0), -0.7]))


def route_map(scene: CompiledScene) -> np.ndarray:
    """Returns the map (H, W, 3) u8: ground by kind, obstacles, and the delivery robot's routes; north up."""
    m = scene.geometry.map
    colours = np.array([GROUND_COLOURS[kind] for kind in GROUND_KINDS], np.float64)
    colour = colours[m.kind]
    colour[m.clearance < 9.0] *= _SHADE
    colour[m.clearance < _OBSTACLE_HEIGHT] = _OBSTACLE
    image = Image.fromarray(colour.astype(np.uint8).transpose(1, 0, 2)[::-1])
    scale = min(MAP_SIZE[0] / image.width, MAP_SIZE[1] / image.height)
    size = max(1, round(image.width * scale)), max(1, round(image.height * scale))
    image = image.resize(size, Image.Resampling.BOX)
    draw = ImageDraw.Draw(image)
    for k, route in enumerate(load_planned(scene.folder).planned):
        cells = (route.path - m.origin) / m.resolution * scale
        line = [(float(x), image.height - float(y)) for x, y in cells]
        colour = _ROUTES[k % len(_ROUTES)]
        draw.line(line, fill=colour, width=2)
        (x, y), r = line[-1], 4
        draw.ellipse((x - r, y - r, x + r, y + r), fill=colour)
    return np.asarray(image)


def _save(image: np.ndarray, path: pathlib.Path) -> pathlib.Path:
    file = io.BytesIO()
    Image.fromarray(image).save(file, "JPEG", quality=82, optimize=True)
    return write_atomically(path, lambda temporary: temporary.write_bytes(file.getvalue()))
