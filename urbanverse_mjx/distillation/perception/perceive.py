"""Converts frames to a `Recording`: poses, metric scale, objects and surfaces of each frame, and depth."""

import dataclasses
import pathlib
import re
from collections.abc import Callable
from typing import Any

import numpy as np

from ...datatypes import Recording, RecordingWriter, Source
from ...datatypes import validation as v
from . import densify
from .frames import Frames
from .mapping import StructureOptions, reconstruct
from .metric import Metric, to_metric
from .observation import FrameObservation, Predictor
from .own_vehicle import own_vehicle
from .structure import Structure

FILE = "perception.json"
_STRUCTURE = StructureOptions()
FindsStructure = Callable[[Frames, Callable[[int, int], None] | None], Structure]


@dataclasses.dataclass(frozen=True)
class Perception:
    """The models and values that perception uses.

    Attributes:
      predictor: finds objects, surfaces and, if supported, depth.
      poses: finds poses and points; None for COLMAP with the options of `structure`.
      camera_height: m above the ground that the camera's carrier walks on, which a video does not determine. 1.5 is a
        camera held at chest height.
      structure: options of the reconstruction by COLMAP.
    """

    predictor: Predictor
    poses: FindsStructure | None = None
    camera_height: float = 1.5
    structure: StructureOptions = _STRUCTURE

    def __post_init__(self) -> None:
        v.number(self.camera_height, "camera height (m)", 0.1, 10.0)


def perceive(
    frames: Frames,
    folder: pathlib.Path,
    perception: Perception,
    source: Source,
    name: str = "tour",
    progress: Callable[[int, int], None] | None = None,
) -> Recording:
    """Makes a recording from frames, and writes `perception.json` with the counts of each step.

    Args:
      folder: of the recording.
      source: source of the video for the recording.
      name: becomes the recording's id; characters that an id cannot hold become "_".
      progress: called with (steps done, steps in all): three for a frame's pose, one for its perception, one for
        writing it.

    Raises:
      ValidationError: too few frames with a pose, too little ground, no write access.
    """
    count = len(frames)
    say = progress or (lambda done, total: None)
    body = own_vehicle(frames)
    find = perception.poses or (lambda frames, progress: reconstruct(frames, perception.structure, progress, body))
    structure = find(frames, lambda done, total: say(round(done / max(total, 1) * 3 * count), 5 * count))
    if body is not None:
        body = structure.straighten(np.repeat(body[..., None].astype(np.uint8) * 255, 3, -1))[..., 0] > 127
    observations: list[FrameObservation] = []
    for k, number in enumerate(structure.registered):
        rgb = structure.straighten(frames.rgb(int(number)))
        observations.append(_without(body, perception.predictor(rgb, structure.camera.fx)))
        say(3 * count + k + 1, 5 * count)
    codes = _codes(structure, observations)
    metric = to_metric(structure, codes, perception.camera_height, np.array(frames.time_s))
    structure, observations = structure.only(metric.kept), [observations[k] for k in metric.kept]
    writer = RecordingWriter(folder, identifier(name), source, structure.camera)
    ground = densify.levels(metric)
    row_of = {int(number): row for row, number in enumerate(structure.registered)}
    for number in range(count):
        rgb, row = structure.straighten(frames.rgb(number)), row_of.get(number)
        if row is None:
            writer.add(frames.time_s[number], rgb)
        else:
            observation = observations[row]
            depth = densify.dense_depth(row, observation, structure, metric, ground)
            depth = depth if body is None else np.where(body, np.float32(0.0), depth)
            writer.add(
                frames.time_s[number],
                rgb,
                depth,
                observation.masks,
                observation.surfaces,
                metric.poses[row],
                observation.detections,
            )
        say(4 * count + number + 1, 5 * count)
    recording = writer.close()
    record = _record(frames, structure, metric, observations)
    share = 0.0 if body is None else float(body.mean())
    v.write_json(folder / FILE, record | {"own_vehicle_percent": round(100.0 * share, 1)})
    return recording


def _without(body: np.ndarray | None, observation: FrameObservation) -> FrameObservation:
    """An observation without ground and objects on the own vehicle (H, W); an object that is mostly there goes."""
    if body is None:
        return observation
    masks = np.where(body, -1, observation.masks)
    left, all_ = (np.bincount(m[m >= 0], minlength=len(observation.detections)) for m in (masks, observation.masks))
    mostly = np.flatnonzero(2 * left < all_)
    masks[np.isin(masks, mostly)] = -1
    return dataclasses.replace(
        observation, masks=masks, surfaces=np.where(body, 0, observation.surfaces).astype(np.uint8)
    )


def _codes(structure: Structure, observations: list[FrameObservation]) -> np.ndarray:
    """(o,) u8 surface code of the pixel of every observation; 0 outside the straightened frame."""
    pixel = np.floor(structure.pixel).astype(int)
    inside = (pixel >= 0).all(1) & (pixel < [structure.camera.width, structure.camera.height]).all(1)
    out = np.zeros(len(pixel), np.uint8)
    for row, observation in enumerate(observations):
        mine = np.flatnonzero(inside & (structure.frame == row))
        out[mine] = observation.surfaces[pixel[mine, 1], pixel[mine, 0]]
    return out


def _record(
    frames: Frames, structure: Structure, metric: Metric, observations: list[FrameObservation]
) -> dict[str, Any]:
    length = np.linalg.norm(np.diff(metric.poses[:, :3, 3], axis=0), axis=1).sum()
    return {
        "schema": "urbanverse.perception/1",
        "frames": {"kept": len(frames), "dropped": [list(d) for d in frames.dropped], "blurred_by": frames.blur},
        "registered": len(structure.registered),
        "focal_pixels": round(structure.camera.fx, 3),
        "distortion": round(structure.distortion, 6),
        "points": len(structure.points),
        "ground_points": int((metric.ground > 0).sum()),
        "reprojection_error_pixels": round(structure.error, 3),
        "bridges": structure.bridges,
        "pieces": metric.pieces,
        "way_m": round(float(length), 2),
        "detections": sum(len(s.detections) for s in observations),
    }


def identifier(name: str) -> str:
    """A name as a recording's id: invalid characters become "_"."""
    return re.sub(r"[^A-Za-z0-9_-]+", "_", name)[:80] or "tour"
