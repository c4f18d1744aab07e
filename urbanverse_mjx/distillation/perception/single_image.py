"""Converts a single photograph to a `Recording` of one frame.

One image has no parallax: depth is that of the perception model, the vertical and the scale come from the plane of the
ground in it and an assumed camera height, and the focal length from the EXIF data, else that of a phone.
"""

import dataclasses
import pathlib

import numpy as np

from ...datatypes import Camera, Recording, RecordingWriter, Source
from ...datatypes import validation as v
from ...datatypes.recording import SKY
from . import densify
from .frames import Frames, focal_pixels
from .metric import MIN_POINTS, to_metric
from .observation import FrameObservation, Predictor
from .perceive import FILE, identifier
from .structure import Structure

#: mm, 35-mm equivalent of a phone's main lens, for photographs that do not state theirs.
USUAL_FOCAL = 26.0
#: Rows and columns between the pixels that become points.
_STEP = 6


@dataclasses.dataclass(frozen=True)
class Photograph:
    """What is known of a photograph.

    Attributes:
      camera_height: m above the ground that it shows in front of the camera.
      focal: pixels; None for `USUAL_FOCAL`.
    """

    camera_height: float = 1.5
    focal: float | None = None

    def __post_init__(self) -> None:
        v.number(self.camera_height, "camera height (m)", 0.1, 10.0)


def perceive_photograph(
    frames: Frames,
    folder: pathlib.Path,
    predictor: Predictor,
    known: Photograph,
    source: Source,
    name: str = "photograph",
) -> Recording:
    """Makes a recording of one frame, and writes `perception.json` with what was assumed.

    Args:
      frames: of one image.
      folder: of the recording.
      predictor: finds objects, surfaces and depth.
      name: becomes the recording's id.

    Raises:
      ValidationError: the predictor gives no depth, or the image shows too little ground.
    """
    focal = known.focal or focal_pixels(USUAL_FOCAL, frames.width, frames.height)
    camera = Camera(frames.width, frames.height, focal, focal, frames.width / 2, frames.height / 2)
    rgb = frames.rgb(0)
    seen = predictor(rgb, focal)
    if seen.depth is None:
        raise v.fail(str(frames.folder), "a perception model without depth", "one with depth", "use the built-in model")
    structure = _structure(camera, seen)
    ground = int(((seen.surfaces > 0) & (seen.surfaces != SKY)).sum() / _STEP**2)
    if ground < MIN_POINTS:
        share = 100.0 * ground * _STEP**2 / seen.surfaces.size
        needed = "ground in the foreground, from which vertical and scale are derived"
        raise v.fail(str(frames.folder), f"ground in {share:.1f} % of the photograph", needed, "photograph the street")
    columns, rows = np.floor(structure.pixel).astype(int).T
    metric = to_metric(structure, seen.surfaces[rows, columns], known.camera_height)
    depth = densify.dense_depth(0, seen, structure, metric, densify.levels(metric))
    writer = RecordingWriter(folder, identifier(name), source, camera)
    writer.add(0.0, rgb, depth, seen.masks, seen.surfaces, metric.poses[0], seen.detections)
    recording = writer.close()
    body = {
        "schema": "urbanverse.perception/1",
        "photograph": True,
        "blurred_by": frames.blur,
        "focal_pixels": round(focal, 3),
        "focal_assumed": known.focal is None,
        "camera_height_assumed_m": known.camera_height,
        "pitch_degrees": round(float(np.degrees(np.arcsin(metric.poses[0][2, 2]))), 2),
        "depth_scale": round(float(metric.scale[0]), 4),
        "ground_points": int((metric.ground > 0).sum()),
        "detections": len(seen.detections),
    }
    v.write_json(folder / FILE, body)
    return recording


def _structure(camera: Camera, seen: FrameObservation) -> Structure:
    """The predicted depth as points, which one frame sees."""
    assert seen.depth is not None
    rows, columns = (x.ravel() for x in np.mgrid[_STEP // 2 : camera.height : _STEP, _STEP // 2 : camera.width : _STEP])
    usable = (seen.surfaces[rows, columns] != SKY) & (seen.depth[rows, columns] > 0)
    rows, columns = rows[usable], columns[usable]
    points = camera.rays()[rows, columns] * seen.depth[rows, columns, None].astype(np.float64)
    count = len(points)
    return Structure(
        camera=camera,
        distortion=0.0,
        registered=np.zeros(1, np.int32),
        poses=np.eye(4)[None],
        points=points,
        frame=np.zeros(count, np.int32),
        point=np.arange(count, dtype=np.int32),
        pixel=np.column_stack([columns, rows]).astype(np.float32) + 0.5,
        error=0.0,
        model=np.zeros(1, np.int32),
    )
