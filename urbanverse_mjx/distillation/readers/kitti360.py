"""KITTI-360 (Liao, Xie, Geiger, "KITTI-360", PAMI 2022) in the folders it is distributed in -> `Recording`.

    calibration/{perspective.txt, calib_cam_to_pose.txt, calib_cam_to_velo.txt}
    data_poses/<sequence>/poses.txt                                  frame, then 3 x 4 T_world_imu
    data_2d_raw/<sequence>/image_00/data_rect/<frame, ten digits>.png
    data_2d_semantics/train/<sequence>/image_00/{semantic, instance}/<frame>.png
    data_3d_bboxes/train/<sequence>.xml
    data_3d_raw/<sequence>/velodyne_points/data/<frame>.bin          float32 x, y, z, reflectance

Only frames with a pose and an image are used. The world is shifted to the first camera; its z axis is up already.
"""

import dataclasses
import os
import pathlib
from collections.abc import Callable, Sequence

import numpy as np
from PIL import Image

from ...datatypes import Camera, Detection, Recording, RecordingWriter, Source
from ...datatypes import validation as v
from ...datatypes.recording import SKY, UNREADABLE
from .kitti360_boxes import Kitti360Box, read_boxes
from .kitti360_depth import boxes_depth, scan_depth
from .kitti360_labels import BY_ID, INSTANCES, object_id

#: Hz, frame rate of the cameras (documentation of the data set).
RATE = 10.0
SOURCE = Source("KITTI-360", "CC BY-NC-SA 3.0", "Karlsruhe", "Germany")
GROUND_TRUTH = "boxes.json"


@dataclasses.dataclass(frozen=True)
class Kitti360Options:
    """Selection of the data to read.

    Attributes:
      sequence: such as "2013_05_28_drive_0000_sync".
      first, last: first and last frame, both included.
      step: distance from one frame to the next.
      depth: "scan" uses the laser's points, "boxes" the annotated boxes and the road's level, "auto" the laser if its
        scans exist.
      camera: 0 or 1, camera of the perspective pair.
    """

    sequence: str
    first: int = 0
    last: int = 10_000_000
    step: int = 1
    depth: str = "auto"
    camera: int = 0

    def __post_init__(self) -> None:
        v.choice(self.depth, "depth", ("auto", "scan", "boxes"))
        v.integer(self.camera, "camera", 0, 1)
        v.integer(self.step, "step", 1)


def read_kitti360(
    root: str | os.PathLike[str],
    folder: str | os.PathLike[str],
    options: Kitti360Options,
    progress: Callable[[int, int], None] | None = None,
) -> Recording:
    """Converts a section of a sequence to a recording, and writes the static objects near it to `boxes.json`.

    Raises:
      ValidationError: a file is missing or not in KITTI-360's format; nothing is written before all files are read.
    """
    root, name = pathlib.Path(root), options.sequence
    camera, T_imu_camera = _calibration(root / "calibration", options.camera)
    poses = _poses(root / "data_poses" / name / "poses.txt")
    image = f"image_{options.camera:02d}"
    images = root / "data_2d_raw" / name / image / "data_rect"
    wanted = [
        f for f in sorted(poses) if options.first <= f <= options.last and (f - options.first) % options.step == 0
    ]
    frames = [f for f in wanted if (images / f"{f:010d}.png").is_file()]
    if not frames:
        found = f"{len(wanted)} frames with a pose there and no image of them"
        raise v.fail(str(images), found, "at least one frame with both", "check the sequence and its frames")
    boxes = read_boxes(_split(root / "data_3d_bboxes", f"{name}.xml"))
    labels = _split(root / "data_2d_semantics", name) / image
    scans = root / "data_3d_raw" / name / "velodyne_points" / "data"
    scanned = options.depth == "scan" or (options.depth == "auto" and scans.is_dir())
    T_camera_scan = np.linalg.inv(_rigid(root / "calibration" / "calib_cam_to_velo.txt")) if scanned else np.eye(4)
    origin = (poses[frames[0]] @ T_imu_camera)[:3, 3]
    writer = RecordingWriter(folder, f"{name}_{frames[0]:010d}", SOURCE, camera, lossless=False)
    for number, frame in enumerate(frames):
        T = poses[frame] @ T_imu_camera
        T[:3, 3] -= origin
        semantic = _image(labels / "semantic" / f"{frame:010d}.png", camera, np.uint8)
        instance = _image(labels / "instance" / f"{frame:010d}.png", camera, np.int32)
        masks, detections = _objects(instance)
        surfaces = _surfaces(semantic)
        if scanned:
            depth = scan_depth(scans / f"{frame:010d}.bin", T_camera_scan, camera)
        else:
            depth = boxes_depth(masks, detections, surfaces, _at(boxes, frame), origin, T, camera)
        rgb = _image(images / f"{frame:010d}.png", camera, np.uint8, "RGB")
        writer.add((frame - frames[0]) / RATE, rgb, depth, masks, surfaces, T, detections)
        if progress is not None:
            progress(number + 1, len(frames))
    recording = writer.close()
    near = _near(boxes, origin, recording.poses()[:, :3, 3])
    v.write_json(recording.folder / GROUND_TRUTH, [obj.to_json() for obj in near])
    return recording


def _near(boxes: Sequence[Kitti360Box], origin: np.ndarray, positions: np.ndarray) -> tuple:
    """Static objects with a label of the ontology within 60 m of the path."""
    kept = {}
    for box in boxes:
        if box.timestamp < 0 and box.kind.label is not None and box.instance > 0:
            middle = box.corners.mean(0) - origin
            if np.linalg.norm(positions - middle, axis=1).min() < 60.0:
                kept[box.id] = box.upright(origin)
    return tuple(kept.values())


def _at(boxes: Sequence[Kitti360Box], frame: int) -> dict[str, Kitti360Box]:
    """id -> the box that is valid at a frame."""
    return {box.id: box for box in boxes if box.timestamp in (-1, frame)}


def _split(folder: pathlib.Path, name: str) -> pathlib.Path:
    """`folder`/{train, test, train_full}/`name`, the first that exists."""
    for path in sorted(folder.glob(f"*/{name}"), key=lambda p: p.parent.name != "train"):
        return path
    raise v.fail(str(folder), f"no {name} in it", "KITTI-360's labels of this sequence", "download them")


def _lines(path: pathlib.Path) -> list[str]:
    try:
        return path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise v.fail(str(path), f"no readable file ({error})", "a file of KITTI-360", "check the root") from error


def _numbers(words: Sequence[str], count: int, where: str) -> np.ndarray:
    try:
        values = np.array(words, np.float64)
    except ValueError as error:
        raise v.fail(where, " ".join(words[:4]), f"{count} numbers", "download it again") from error
    if values.size != count or not np.isfinite(values).all():
        raise v.fail(where, f"{values.size} numbers", f"{count} finite numbers", "download it again")
    return values


def _rows(numbers: np.ndarray) -> np.ndarray:
    """(4, 4) matrix from 12 numbers, row by row."""
    return np.vstack([numbers.reshape(3, 4), [0.0, 0.0, 0.0, 1.0]])


def _poses(path: pathlib.Path) -> dict[int, np.ndarray]:
    """frame -> (4, 4) T_world_imu."""
    out = {}
    for i, line in enumerate(_lines(path), 1):
        if words := line.split():
            frame = _numbers(words[:1], 1, f"{path}:{i}")
            out[int(frame[0])] = _rows(_numbers(words[1:], 12, f"{path}:{i}"))
    return out


def _rigid(path: pathlib.Path) -> np.ndarray:
    """(4, 4) transform from a file that holds one."""
    return _rows(_numbers(" ".join(_lines(path)).split(), 12, str(path)))


def _calibration(folder: pathlib.Path, camera: int) -> tuple[Camera, np.ndarray]:
    """The rectified camera and T_imu_camera (4, 4), which includes the rotation of the rectification."""
    values = {}
    for path in (folder / "perspective.txt", folder / "calib_cam_to_pose.txt"):
        for line in _lines(path):
            key, _, rest = line.partition(":")
            values[key.strip()] = (rest.split(), f"{path}: {key.strip()}")

    def numbers(key: str, count: int) -> np.ndarray:
        if key not in values:
            raise v.fail(str(folder), f"no {key}", f"a line {key!r}", "download the calibration again")
        words, where = values[key]
        return _numbers(words, count, where)

    P = numbers(f"P_rect_{camera:02d}", 12).reshape(3, 4)
    width, height = (int(x) for x in numbers(f"S_rect_{camera:02d}", 2))
    turn = np.eye(4)
    turn[:3, :3] = numbers(f"R_rect_{camera:02d}", 9).reshape(3, 3)
    mounted = _rows(numbers(f"image_{camera:02d}", 12))
    # The origin of pixel coordinates is the centre of the first pixel in P, and its corner here.
    lens = Camera(width, height, P[0, 0], P[1, 1], P[0, 2] + 0.5, P[1, 2] + 0.5)
    return lens, mounted @ np.linalg.inv(turn)


def _image(path: pathlib.Path, camera: Camera, dtype: type, mode: str | None = None) -> np.ndarray:
    try:
        with Image.open(path) as image:
            pixels = np.asarray(image.convert(mode) if mode else image).astype(dtype)
    except UNREADABLE as error:
        raise v.fail(str(path), f"no readable image ({error})", "one of KITTI-360", "download it again") from error
    if pixels.shape[:2] != (camera.height, camera.width):
        found = f"{pixels.shape[1]}x{pixels.shape[0]} pixels"
        raise v.fail(str(path), found, f"the calibration's {camera.width}x{camera.height}", "use data_rect")
    return pixels


def _surfaces(semantic: np.ndarray) -> np.ndarray:
    codes = np.zeros(256, np.uint8)
    for kind in BY_ID.values():
        codes[kind.id] = kind.surface
    assert codes[23] == SKY
    return codes[semantic]


def _objects(instance: np.ndarray) -> tuple[np.ndarray, list[Detection]]:
    """(H, W) row of the detections, -1 = none; and one detection per instance of a class with a label of the
    ontology."""
    numbers, where = np.unique(instance, return_inverse=True)
    rows = np.full(len(numbers), -1)
    detections = []
    for k, number in enumerate(numbers.tolist()):
        kind = BY_ID.get(number // INSTANCES)
        if kind is not None and kind.label is not None and number % INSTANCES:
            rows[k] = len(detections)
            detections.append(Detection(kind.label, 1.0, object_id(kind, number % INSTANCES)))
    return rows[where.reshape(instance.shape)], detections
