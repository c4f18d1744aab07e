"""Structure from motion: where the cameras stood and some thousand points, up to a similarity. Done by COLMAP.

Schönberger and Frahm, "Structure-from-Motion Revisited", CVPR 2016: SIFT, matches between frames near in time,
incremental mapping with bundle adjustment of one shared camera.
"""

import dataclasses
import pathlib
import tempfile
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy import ndimage

from ... import settings
from ...datatypes import Camera, NounError
from .frames import Frames

#: Fewer frames with a pose are no tour.
MIN_FRAMES = 3
#: Lens distortion below so many pixels at the corner is left alone.
_STRAIGHT = 0.3
#: Focal length over the longer side that the search starts from, and the least and most that a street camera has: from
#: an action camera (120° wide) over a phone's main lens (0.72, 26 mm on film 36 mm wide) to its second lens.
_FOCAL, _LEAST_FOCAL, _MOST_FOCAL = 0.72, 0.25, 2.2
#: No lens for filming bends more (k1): what comes out beyond is a structure that collapsed.
_MOST_BENT = 0.5


@dataclasses.dataclass(frozen=True)
class StructureOptions:
    """How much COLMAP does.

    Attributes:
      features: most per frame; 3,000 fill half a megapixel.
      overlap: each frame is matched with so many after it, and with those at 16, 32, ... frames.
      focal: pixels of the frames, where it is known; None to find it.
    """

    features: int = 3000
    overlap: int = 8
    focal: float | None = None


@dataclasses.dataclass(frozen=True)
class Structure:
    """m registered frames, p points and o observations; lengths in an unknown unit.

    Attributes:
      camera: pinhole of the straightened frames. distortion: k1 of COLMAP's SIMPLE_RADIAL.
      registered: (m,) i32 numbers of the frames. poses: (m, 4, 4) f64 T_structure_camera, OpenCV axes.
      points: (p, 3) f64.
      frame, point: (o,) i32 row of `registered` and of `points`; pixel: (o, 2) f32 u, v in the straightened frame.
      error: pixels, mean reprojection error.
    """

    camera: Camera
    distortion: float
    registered: np.ndarray
    poses: np.ndarray
    points: np.ndarray
    frame: np.ndarray
    point: np.ndarray
    pixel: np.ndarray
    error: float

    def depth(self) -> np.ndarray:
        """(o,) f64: depth of every observation along its camera's axis."""
        out = self.points[self.point] - self.poses[self.frame, :3, 3]
        return np.einsum("oi,oi->o", out, self.poses[self.frame, :3, 2])

    def straighten(self, rgb: np.ndarray) -> np.ndarray:
        """A frame (H, W, 3) u8 without the lens's distortion."""
        camera = self.camera
        corner = (camera.cx**2 + camera.cy**2) / camera.fx**2
        if abs(self.distortion) * corner * np.hypot(camera.cx, camera.cy) < _STRAIGHT:
            return rgb
        rays = camera.rays()[..., :2]
        bent = rays * (1.0 + self.distortion * (rays**2).sum(-1, keepdims=True))
        rows, columns = bent[..., 1] * camera.fy + camera.cy - 0.5, bent[..., 0] * camera.fx + camera.cx - 0.5
        parts = [ndimage.map_coordinates(rgb[..., c], [rows, columns], order=1, mode="nearest") for c in range(3)]
        return np.stack(parts, -1)


def reconstruct(
    frames: Frames, options: StructureOptions | None = None, progress: Callable[[int, int], None] | None = None
) -> Structure:
    """Finds poses, one shared camera and points.

    Args:
      progress: called with (steps done, steps in all); a step is a frame extracted, matched or registered.

    Raises:
      NounError: COLMAP finds no place for at least `MIN_FRAMES` frames.
    """
    options = options or StructureOptions()
    with tempfile.TemporaryDirectory() as work:
        models = _map(frames, options, pathlib.Path(work), progress or (lambda done, total: None))
    best = max(models, key=lambda model: model.num_reg_images(), default=None)
    count = 0 if best is None else best.num_reg_images()
    if best is None or count < MIN_FRAMES:
        raise NounError(
            f"{frames.folder}: found poses for {count} of {len(frames)} frames, needed {MIN_FRAMES}; film while "
            "walking, in light that shows texture, or sample more frames a second."
        )
    return _structure(best, frames)


def _map(
    frames: Frames, options: StructureOptions, work: pathlib.Path, progress: Callable[[int, int], None]
) -> list[Any]:
    import pycolmap

    # Without this it writes pages to standard error.
    pycolmap.logging.minloglevel = pycolmap.logging.Level.FATAL.value
    database, threads, steps = work / "database.db", settings.num_threads(), 3 * len(frames)
    extraction = pycolmap.FeatureExtractionOptions(num_threads=threads)
    extraction.sift.max_num_features = options.features
    # Asphalt and plaster have little contrast: COLMAP's own threshold, 0.0067, leaves too little on the ground.
    extraction.sift.peak_threshold = 0.004
    reader = pycolmap.ImageReaderOptions(camera_model="SIMPLE_RADIAL", default_focal_length_factor=_FOCAL)
    if options.focal is not None:
        reader.camera_params = f"{options.focal},{frames.width / 2},{frames.height / 2},0"
    matching = pycolmap.FeatureMatchingOptions(num_threads=threads)
    pairing = pycolmap.SequentialPairingOptions(overlap=options.overlap, quadratic_overlap=True)
    verification = pycolmap.TwoViewGeometryOptions()
    verification.ransac.random_seed = 0
    mapping = _mapping(pycolmap, threads, options.focal is None)
    registered = 2 * len(frames)

    def one_more() -> None:
        nonlocal registered
        registered = min(registered + 1, steps)
        progress(registered, steps)

    try:
        cameras = pycolmap.CameraMode.SINGLE
        pycolmap.extract_features(database, frames.folder, list(frames.names), cameras, reader, extraction)
        progress(len(frames), steps)
        pycolmap.match_sequential(database, matching, pairing, verification)
        progress(2 * len(frames), steps)
        models = pycolmap.incremental_mapping(
            database, frames.folder, work, mapping, next_image_callback=one_more
        )  # fmt: skip
    except (RuntimeError, ValueError) as error:
        raise NounError(
            f"{frames.folder}: found that COLMAP fails ({str(error).strip().splitlines()[-1]}), needed poses; "
            "try other frames."
        ) from error
    progress(steps, steps)
    return list(models.values())


def _mapping(pycolmap: Any, threads: int, refine_focal: bool) -> Any:
    """Options for a tour on foot: small steps and small angles, and a bundle adjustment that stops early."""
    mapping = pycolmap.IncrementalPipelineOptions(num_threads=threads, extract_colors=False, random_seed=0)
    mapping.min_model_size = MIN_FRAMES
    mapping.ba_refine_focal_length = refine_focal
    for limited in (mapping, mapping.mapper, mapping.triangulation):
        limited.min_focal_length_ratio, limited.max_focal_length_ratio = _LEAST_FOCAL, _MOST_FOCAL
        limited.max_extra_param = _MOST_BENT
    mapping.ba_global_max_num_iterations = 30
    mapping.ba_local_max_num_iterations = 15
    mapping.mapper.init_min_tri_angle = 8.0
    mapping.mapper.abs_pose_min_num_inliers = 20
    mapping.mapper.abs_pose_refine_focal_length = refine_focal
    mapping.mapper.filter_min_tri_angle = 1.0
    mapping.triangulation.min_angle = 1.0
    return mapping


def _structure(model: Any, frames: Frames) -> Structure:
    number = {name: k for k, name in enumerate(frames.names)}
    images = sorted((i for i in model.images.values() if i.has_pose), key=lambda i: number[i.name])
    lens = next(iter(model.cameras.values()))
    focal, cx, cy, distortion = lens.params
    camera = Camera(frames.width, frames.height, focal, focal, cx, cy)
    identifiers = sorted(model.points3D)
    row = {identifier: k for k, identifier in enumerate(identifiers)}
    poses, frame, point, bent = [], [], [], []
    for k, image in enumerate(images):
        pose = np.eye(4)
        pose[:3] = image.cam_from_world().inverse().matrix()
        poses.append(pose)
        seen = image.get_observation_points2D()
        frame.append(np.full(len(seen), k, np.int32))
        point.append(np.array([row[p.point3D_id] for p in seen], np.int32))
        bent.append(np.array([p.xy for p in seen]).reshape(-1, 2))
    straight = lens.cam_from_img(np.concatenate(bent)) * focal + [cx, cy]
    return Structure(
        camera=camera,
        distortion=float(distortion),
        registered=np.array([number[i.name] for i in images], np.int32),
        poses=np.array(poses),
        points=np.array([model.points3D[i].xyz for i in identifiers]).reshape(-1, 3),
        frame=np.concatenate(frame),
        point=np.concatenate(point),
        pixel=straight.astype(np.float32),
        error=float(model.compute_mean_reprojection_error()),
    )
