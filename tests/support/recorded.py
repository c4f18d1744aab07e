"""Small episodes for datasets, made without driving."""

import pathlib

import cv2
import numpy as np

from urbanverse_mjx.datasets import DatasetWriter, Episode, Feature
from urbanverse_mjx.datasets.features import IMAGE_AXES
from urbanverse_mjx.datasets.statistics import PixelCounts
from urbanverse_mjx.datasets.video import encode

HEIGHT, WIDTH, RATE = 33, 48, 5
FRONT, DEPTH = "observation.images.front", "observation.images.depth"
FEATURES = {
    FRONT: Feature("video", (HEIGHT, WIDTH, 3), IMAGE_AXES, {"is_depth_map": False}),
    DEPTH: Feature("image", (HEIGHT, WIDTH, 1), IMAGE_AXES, {"is_depth_map": True, "depth_unit": "mm"}),
    "observation.state": Feature("float32", (3,), ("a", "b", "c")),
    "action": Feature("float32", (2,), ("x", "y")),
    "next.reward": Feature("float32", (1,)),
    "next.done": Feature("bool", (1,)),
}


def level(number: int, step: int) -> int:
    """Grey level of the image of an episode's step."""
    return 40 + (37 * number + 11 * step) % 180


def depth_image(number: int, step: int) -> np.ndarray:
    """(H, W) mm."""
    return (np.arange(HEIGHT * WIDTH).reshape(HEIGHT, WIDTH) * 7 + 1000 * number + step).astype(np.uint16)


def episode(number: int, length: int = 4, task: str = "go") -> Episode:
    """Episode `number`: the same at every call."""
    draw = np.random.default_rng(number)
    images, colours, distances, files = [], PixelCounts(3, 256), PixelCounts(1, 65536), []
    for step in range(length):
        image = np.full((HEIGHT, WIDTH, 3), level(number, step), np.uint8)
        images.append(image)
        colours.add(image)
        distances.add(depth_image(number, step)[..., None])
        files.append(cv2.imencode(".png", depth_image(number, step))[1].tobytes())
    columns = {
        "observation.state": draw.normal(size=(length, 3)),
        "action": draw.uniform(-1, 1, (length, 2)),
        "next.reward": draw.normal(size=length),
        "next.done": np.arange(length) == length - 1,
    }
    stats = {FRONT: colours.stats(255.0), DEPTH: distances.stats(1.0)}
    metadata = {"scene": f"street_{number % 2}", "result": "goal" if number % 3 else "hit", "seed": number}
    return Episode(task, columns, {DEPTH: files}, {FRONT: encode(images, HEIGHT, WIDTH, RATE)}, stats, metadata)


def write_dataset(folder: pathlib.Path, count: int = 3) -> pathlib.Path:
    """A dataset of `count` episodes of 4, 5, ... steps."""
    with DatasetWriter(folder, FEATURES, RATE, "box", {"policy": "none"}) as writer:
        for number in range(count):
            writer.add(episode(number, 4 + number))
    return folder
