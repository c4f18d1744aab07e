"""Draws a map of a scene with the paths of robots, coloured by their results."""

from collections.abc import Sequence

import numpy as np
from PIL import Image, ImageDraw

from ..datatypes import GROUND_KINDS, SceneBank
from ..geometry.grids import cell_of
from ..geometry.raster import outline
from .graphs import GROUND_COLOURS

#: Share of white in the ground's colours, which makes paths and objects stand out; sRGB of objects and of the results
#: of episodes.
_WHITE_SHARE = 0.55
OBJECT, OVERHEAD = (92, 88, 92), (180, 190, 172)
ENDS = {
    "goal": (24, 140, 60),
    "hit": (206, 32, 38),
    "hit_agent": (160, 30, 150),
    "timeout": (222, 130, 0),
    "off_traversable": (30, 90, 200),
    "fall": (110, 60, 20),
    "lost": (0, 150, 160),
    "stopped": (120, 120, 120),
    "dropped": (190, 150, 60),
    "non_finite": (0, 0, 0),
}
#: m above the ground; a hull that begins below is an obstacle.
_OBSTACLE_HEIGHT = 1.0
#: Largest number of pixels of the longer side, and per metre.
_MAX_SIDE, _MAX_RESOLUTION = 1800, 24.0
_LEGEND = 26


def route_image(
    bank: SceneBank, scene: int, trajectories: Sequence[np.ndarray], ends: Sequence[str], goals: np.ndarray
) -> np.ndarray:
    """Returns the map (H, W, 3) uint8, north (y) up.

    Args:
      trajectories: (T, 2) m each.
      ends: result of each.
      goals: (n, 2) m, drawn as rings of the success radius.
    """
    low, high = _extent(bank, scene, trajectories)
    scale = min(_MAX_RESOLUTION, _MAX_SIDE / float((high - low).max()))
    width, height = (int(np.ceil(n * scale)) for n in high - low)
    # Drawn at twice the size, then halved, for smooth edges.
    fine = 2.0 * scale

    def pixels(points: np.ndarray) -> list[tuple[float, float]]:
        xy = (np.asarray(points, float)[:, :2] - low) * fine
        return [(float(x), float(2 * height - y)) for x, y in xy]

    image = _ground(bank, scene, low, fine, (2 * width, 2 * height))
    draw = ImageDraw.Draw(image)
    for ring, colour in _outlines(bank, scene):
        draw.polygon(pixels(ring), fill=colour)
    order = sorted(range(len(trajectories)), key=lambda i: ends[i] != "goal")
    for i in order:
        colour = ENDS[ends[i]]
        goal = pixels(goals[i : i + 1])[0]
        draw.ellipse([goal[0] - fine, goal[1] - fine, goal[0] + fine, goal[1] + fine], outline=colour, width=2)
        if len(trajectories[i]) > 1:
            draw.line(pixels(trajectories[i]), fill=colour, width=max(3, round(0.12 * fine)), joint="curve")
        r = 0.25 * fine
        x, y = pixels(trajectories[i][:1])[0]
        draw.ellipse([x - r, y - r, x + r, y + r], fill=colour)
        x, y = pixels(trajectories[i][-1:])[0]
        if ends[i] != "goal":
            draw.line([(x - r, y - r), (x + r, y + r)], fill=(0, 0, 0), width=4)
            draw.line([(x - r, y + r), (x + r, y - r)], fill=(0, 0, 0), width=4)
    small = image.resize((width, height), Image.Resampling.LANCZOS)
    return np.asarray(_with_legend(small, ends))


def _extent(bank: SceneBank, scene: int, trajectories: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Returns the bounds (2,), (2,) m of the scene's walkable and drivable ground and of all paths."""
    cells = np.argwhere(bank.map_kind[scene] > 0)
    resolution = float(bank.map_resolution)
    points = np.concatenate([bank.map_origin[scene] + (cells + 0.5) * resolution, *trajectories])
    return points.min(0) - 1.0, points.max(0) + 1.0


def _ground(bank: SceneBank, scene: int, low: np.ndarray, fine: float, size: tuple[int, int]) -> Image.Image:
    x = low[0] + (np.arange(size[0]) + 0.5) / fine
    y = low[1] + (size[1] - np.arange(size[1]) - 0.5) / fine
    resolution, origin = float(bank.map_resolution), bank.map_origin[scene]
    kind = bank.map_kind[scene]
    i, j = (cell_of(a, o, resolution) for a, o in zip((x, y), origin, strict=True))
    seen = kind[np.clip(i, 0, kind.shape[0] - 1)[None, :], np.clip(j, 0, kind.shape[1] - 1)[:, None]]
    colours = np.array([GROUND_COLOURS[name] for name in GROUND_KINDS])
    return Image.fromarray((_WHITE_SHARE * 255 + (1.0 - _WHITE_SHARE) * colours).astype(np.uint8)[seen])


def _outlines(bank: SceneBank, scene: int) -> list[tuple[np.ndarray, tuple[int, int, int]]]:
    """Returns the outlines (n, 2) m of the hulls from above, overhead ones first, and their colours."""
    number = int(bank.num_episodes[scene])
    ground = float(np.median(bank.episode_start[scene, :number, 2]))
    found = []
    for corners in bank.standing_hulls(scene):
        ring = outline(corners[:, :2])
        found.append((ring, OVERHEAD if corners[:, 2].min() > ground + _OBSTACLE_HEIGHT else OBJECT))
    return sorted(found, key=lambda entry: entry[1] == OBJECT)


def _with_legend(image: Image.Image, ends: Sequence[str]) -> Image.Image:
    """Returns the image with a line below it that gives the number of episodes of each result."""
    whole = Image.new("RGB", (image.width, image.height + _LEGEND), (255, 255, 255))
    whole.paste(image, (0, 0))
    draw, x = ImageDraw.Draw(whole), 8
    for name, colour in ENDS.items():
        count = sum(e == name for e in ends)
        if count:
            draw.rectangle([x, image.height + 8, x + 18, image.height + 18], fill=colour)
            text = f"{name} {count}"
            draw.text((x + 24, image.height + 7), text, fill=(0, 0, 0))
            x += 40 + round(draw.textlength(text))
    return whole
