"""`dataset_page`: one episode of a dataset as a page of its own, without server or network: images, numbers, boxes and
the driven path, to scrub through."""

import base64
import json
import pathlib
from typing import Any

import cv2
import numpy as np

from ..datatypes import validation as v
from ..geometry import rotations
from . import features as f
from . import video
from .reading import StoredDataset, read_table

#: Distance (mm) that is shown brightest.
_FAR = 20_000.0
#: Most frames that a page holds.
_FRAMES = 2000


def dataset_page(folder: str | pathlib.Path, episode: int = 0) -> str:
    """The page of an episode of a LeRobotDataset v3 as HTML.

    Raises:
      ValidationError: no dataset, no such episode, or one too long for a page.
    """
    dataset = StoredDataset.open(folder)
    known = len(dataset.episodes)
    if not 0 <= episode < known:
        raise v.fail(
            "--episode", str(episode), f"0 to {known - 1}" if known else "a complete episode, of which none is"
        )
    row = dataset.episodes[episode]
    length, first = row["length"], row["dataset_from_index"]
    if length > _FRAMES:
        raise v.fail("--episode", f"{length:,} frames", f"at most {_FRAMES:,} in a page", "take a shorter episode")
    offset = first - min(e["dataset_from_index"] for e in dataset.episodes if _same_file(e, row))
    table = read_table(dataset.data_path(row)).slice(offset, length)
    numbers = {
        name: np.array(table[name].to_pylist(), np.float64).reshape(length, -1)
        for name, feature in dataset.features.items()
        if not feature.is_image and name not in f.INDEX_FEATURES
    }
    for name, column in numbers.items():
        if not np.isfinite(column).all():
            raise v.fail(f"{dataset.folder}: {name}", "a number that is not finite", "finite ones", "see dataset check")
    body = {
        "title": f"{dataset.folder.name}: episode {episode} of {known}, {row.get('scene', '')} {row.get('result', '')}",
        "rate": dataset.rate,
        "length": length,
        "images": _images(dataset, row, table),
        "numbers": {name: np.round(x, 4).tolist() for name, x in numbers.items() if x.shape[1] <= 12},
        **_path(numbers, length),
        **_annotations(dataset, row, offset),
    }
    front = next((x for x in dataset.features.values() if x.is_image), None)
    body |= {"height": front.shape[0], "width": front.shape[1]} if front else {"height": 1, "width": 1}
    # "</script>" in a name would end the data.
    text = json.dumps(body, ensure_ascii=False).replace("<", "\\u003c")
    return (pathlib.Path(__file__).parent / "page.html").read_text(encoding="utf-8").replace("__DATA__", text)


def _same_file(one: dict[str, Any], other: dict[str, Any]) -> bool:
    return all(one[f"data/{key}"] == other[f"data/{key}"] for key in ("chunk_index", "file_index"))


def _path(numbers: dict[str, np.ndarray], length: int) -> dict[str, Any]:
    """x, y, yaw of the robot, and x, y of its goal in the scene."""
    if "pose" not in numbers:
        return {"path": [[0.0, 0.0, 0.0]] * length, "goal": []}
    pose = numbers["pose"]
    yaw = rotations.yaw_of(pose[:, 3:])
    goal = numbers.get("observation.environment_state", np.zeros((length, 0)))
    c, s = np.cos(yaw), np.sin(yaw)
    goals = []
    if goal.shape[1] == 2:
        ahead, left = goal.T
        goals = np.stack([pose[:, 0] + c * ahead - s * left, pose[:, 1] + s * ahead + c * left], -1).round(3).tolist()
    return {"path": np.column_stack([pose[:, :2], yaw]).round(4).tolist(), "goal": goals}


def _annotations(dataset: StoredDataset, row: dict[str, Any], offset: int) -> dict[str, Any]:
    place = {key: row[f"data/{key}"] for key in ("chunk_index", "file_index")}
    path = dataset.folder / f.ANNOTATIONS_PATH.format(**place)
    if not path.is_file():
        return {"objects": [], "captions": []}
    frames = read_table(path).slice(offset, row["length"]).to_pylist()
    objects = [
        [{"box": o["box"], "category": o["category"], "place": o["position_world"][:2]} for o in frame["objects"]]
        for frame in frames
    ]
    return {"objects": objects, "captions": [frame["caption"] for frame in frames]}


def _images(dataset: StoredDataset, row: dict[str, Any], table: Any) -> dict[str, list[str]]:
    """Camera -> data addresses of its frames."""
    found = {}
    for name, feature in dataset.features.items():
        if feature.dtype == "video":
            first = round(row[f"videos/{name}/from_timestamp"] * dataset.rate)
            frames = video.read_frames(dataset.video_path(row, name), first + row["length"], *feature.shape[:2])[first:]
            found[name] = [_address(frame[..., ::-1]) for frame in frames]
        elif feature.dtype == "image":
            stored = [cell["bytes"] for cell in table[name].to_pylist()]
            found[name] = [_address(_visible(body, feature)) for body in stored]
    return found


def _visible(body: bytes, feature: f.Feature) -> np.ndarray:
    """(H, W, 3) u8 BGR: distances by a colour map, labels by colours of their own, other images as they are."""
    image = cv2.imdecode(np.frombuffer(body, np.uint8), cv2.IMREAD_UNCHANGED)
    assert image is not None
    if image.ndim == 3:
        return image[..., :3]
    if feature.is_depth:
        near = np.clip(255.0 * (1.0 - image / _FAR), 0, 255).astype(np.uint8)
        return np.where((image > 0)[..., None], cv2.applyColorMap(near, cv2.COLORMAP_TURBO), 0).astype(np.uint8)
    hues = np.random.default_rng(0).integers(40, 256, (1024, 3), np.uint8)
    return np.where((image > 0)[..., None], hues[image.astype(np.int64) % 1024], 0).astype(np.uint8)


def _address(image: np.ndarray) -> str:
    done, body = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, 88])
    assert done
    return "data:image/jpeg;base64," + base64.b64encode(body.tobytes()).decode()
