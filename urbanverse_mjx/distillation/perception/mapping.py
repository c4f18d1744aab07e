"""Structure from motion by COLMAP: camera poses and some thousand points, up to a similarity.

Schönberger and Frahm, "Structure-from-Motion Revisited", CVPR 2016: SIFT, matches between frames near in time,
incremental mapping with bundle adjustment of one shared camera. The focal length is estimated beforehand from the
fundamental matrices of all pairs. Where no match connects one frame to the next, the structure is split into several
models; so it is where matches of similar objects link frames that see different places (`links`). Breaks are mapped
again by themselves (`bridges`); `pieces` joins what is left once it is metric.
"""

import dataclasses
import functools
import pathlib
from collections.abc import Callable, Iterator
from typing import Any

import cv2
import numpy as np

from ... import settings
from ...datatypes import Camera, ValidationError
from ...work_folder import work_folder
from . import links
from .bridges import bridged
from .frames import Frames
from .parallax import check_parallax
from .pieces import cut
from .structure import Structure

#: Fewest frames with a pose that form a trajectory.
MIN_FRAMES = 3


@dataclasses.dataclass(frozen=True)
class MappingOptions:
    """Limits for COLMAP.

    Chosen on twelve rendered captures and a corridor of nine frames (docs/decisions/gen_perception.md).

    Attributes:
      focal: initial focal length over the longer side: a phone's main lens (26 mm on film 36 mm wide).
      min_focal: least focal length of a street camera: an action camera, 120° wide.
      max_focal: largest focal length: a phone's second lens.
      max_distortion: k1; no camera lens has more, so a larger result means that the structure collapsed.
      min_model: frames; smaller models next to a larger one cannot be located reliably.
      min_shared_points: models that share a frame are merged if both contain at least this many points visible in it.
      contrast: SIFT's least contrast, COLMAP's own. With less, matches on the bricks of a near wall outnumber all
        others, and matches on a single plane fit two poses: on three of twelve captures the trajectory then bent by 50
        to 90° before a wall.
      pair_error: pixels, largest error of matches between two frames. COLMAP's defaults (4, 12, 4) are for images of
        several thousand pixels and accept the wrong one of the two poses that fit a wall.
      pose_error: pixels, largest error of matches of a new frame.
      point_error: pixels, largest reprojection error of points.
      short_clip: clips with fewer frames use `short_pair_error`. The focal length is estimated from all pairs, and with
        2 pixels it was 50 % too long for nine blurred frames of a corridor.
      short_pair_error: pixels, `pair_error` for short clips.
      first_errors: pixels, largest error of the two frames with which a model begins. COLMAP prefers to begin at walls,
        which have most matches. If the trajectory breaks, the structure is built again with the next of these values,
        and the one with the smallest break is kept.
      focal_digits: decimals to which the initial focal length (pixels) of the mapping is rounded.
    """

    focal: float = 0.72
    min_focal: float = 0.25
    max_focal: float = 2.2
    max_distortion: float = 0.5
    min_model: int = 6
    min_shared_points: int = 8
    contrast: float = 0.0067
    pair_error: float = 2.0
    pose_error: float = 6.0
    point_error: float = 2.0
    short_clip: int = 30
    short_pair_error: float = 4.0
    first_errors: tuple[float, ...] = (1.0, 4.0)
    focal_digits: int = 3


_OPTIONS = MappingOptions()


@dataclasses.dataclass(frozen=True)
class StructureOptions:
    """Options of the reconstruction.

    Attributes:
      features: largest number per frame; 3,000 cover half a megapixel.
      overlap: number of following frames with which each frame is matched. Later frames are not matched, because most
        matches over 16 frames or more connected two similar houses, windows or signs.
      focal: focal length in pixels of the frames, if known; None to estimate it.
      exact: whether `focal` is kept; otherwise the mapping starts from it and refines it.
    """

    features: int = 3000
    overlap: int = 8
    focal: float | None = None
    exact: bool = True


def reconstruct(
    frames: Frames,
    options: StructureOptions | None = None,
    progress: Callable[[int, int], None] | None = None,
    body: np.ndarray | None = None,
) -> Structure:
    """Estimates poses, one shared camera and points.

    Args:
      body: (H, W) bool, pixels of the own vehicle (`own_vehicle`), whose features move with the camera and are left
        out; None for none.
      progress: called with (steps done, steps in all); a step is a frame extracted, matched or registered.

    Raises:
      ValidationError: the frames show no parallax, or COLMAP registers fewer than `MIN_FRAMES` of them.
    """
    options = options or StructureOptions()

    def rebuild(focal: float, low: int, high: int) -> Structure | None:
        part = slice(low, high + 1)
        some = dataclasses.replace(frames, names=frames.names[part], time_s=frames.time_s[part])
        known = dataclasses.replace(options, focal=focal, exact=True)
        try:
            found = _best(some, known, lambda done, total: None, body, lambda one: one)
        except ValidationError:
            return None
        return dataclasses.replace(found, registered=found.registered + low)

    def bridge(structure: Structure) -> Structure:
        return bridged(structure, functools.partial(rebuild, structure.camera.fx))

    return _best(frames, options, progress or (lambda done, total: None), body, bridge)


def _best(
    frames: Frames,
    options: StructureOptions,
    progress: Callable[[int, int], None],
    body: np.ndarray | None,
    bridge: Callable[[Structure], Structure],
) -> Structure:
    """The structure of the attempt with fewest breaks after `bridge`; for the other arguments see `reconstruct`."""
    most, best, best_score = 0, None, (np.inf, 0)
    with work_folder("urbanverse-structure-") as work:
        for found in _maps(frames, options, work, progress, body):
            models = sorted(filter(_has_a_possible_lens, found), key=lambda model: -model.num_reg_images())
            count = models[0].num_reg_images() if models else 0
            most = max(most, count)
            if count < MIN_FRAMES:
                continue
            structure = bridge(_structure(models, frames, options.overlap))
            breaks = len(cut(structure.model, structure.registered, structure.poses)) - len(np.unique(structure.model))
            score = breaks, -len(structure.registered)
            if score < best_score:
                best, best_score = structure, score
            # Short clips need every frame, and another attempt is cheap.
            if breaks <= 0 and (len(frames) >= _OPTIONS.short_clip or len(structure.registered) == len(frames)):
                break
    if best is None:
        raise ValidationError(
            f"{frames.folder}: found poses for {most} of {len(frames)} frames, needed {MIN_FRAMES}; film while "
            "walking, in light that shows texture, or take more frames a second by --rate."
        )
    return best


def _has_a_possible_lens(model: Any) -> bool:
    """Whether the cameras of a model are within the limits of `_mapping`; COLMAP itself checks only models of 20 frames
    or more."""
    for camera in model.cameras.values():
        focal, distortion = camera.params[0], camera.params[3]
        if not _OPTIONS.min_focal <= focal / max(camera.width, camera.height) <= _OPTIONS.max_focal:
            return False
        if abs(distortion) > _OPTIONS.max_distortion:
            return False
    return True


def _maps(
    frames: Frames,
    options: StructureOptions,
    work: pathlib.Path,
    progress: Callable[[int, int], None],
    body: np.ndarray | None,
) -> Iterator[list[Any]]:
    """Yields COLMAP's models for each of `first_errors` in turn, and for a short clip finally without distortion.

    A few frames hardly distinguish a long focal length with distortion from a short one without.
    """
    import pycolmap

    check_parallax(frames)
    # COLMAP otherwise writes long logs to standard error.
    pycolmap.logging.minloglevel = pycolmap.logging.Level.FATAL.value
    # Features do not depend on the number of threads; the later steps do.
    database, threads, steps = work / "database.db", settings.num_threads(), 3 * len(frames)
    extraction = pycolmap.FeatureExtractionOptions(num_threads=threads)
    extraction.sift.max_num_features = options.features
    extraction.sift.peak_threshold = _OPTIONS.contrast
    reader = pycolmap.ImageReaderOptions(camera_model="SIMPLE_RADIAL", default_focal_length_factor=_OPTIONS.focal)
    if body is not None:
        # COLMAP leaves out pixels that are 0.
        cv2.imwrite(str(work / "mask.png"), np.where(body, 0, 255).astype(np.uint8))
        reader.camera_mask_path = work / "mask.png"
    if options.focal is not None:
        reader.camera_params = f"{options.focal},{frames.width / 2},{frames.height / 2},0"
    # With several threads, COLMAP's approximate search is not deterministic.
    matching = pycolmap.FeatureMatchingOptions(num_threads=1)
    pairing = pycolmap.SequentialPairingOptions(overlap=options.overlap, quadratic_overlap=False)
    verification = pycolmap.TwoViewGeometryOptions()
    verification.ransac.random_seed = 0
    verification.ransac.max_error = (
        _OPTIONS.short_pair_error if len(frames) < _OPTIONS.short_clip else _OPTIONS.pair_error
    )
    mapping = _mapping(pycolmap, options.focal is None or not options.exact)
    registered = 2 * len(frames)

    def one_more() -> None:
        nonlocal registered
        registered = min(registered + 1, steps)
        progress(registered, steps)

    try:
        cameras = pycolmap.CameraMode.SINGLE
        # Images are registered in order beforehand, because the extraction numbers new images in the order in which its
        # threads finish.
        pycolmap.Database.open(database).close()
        pycolmap.import_images(database, frames.folder, cameras, list(frames.names), reader)
        pycolmap.extract_features(database, frames.folder, list(frames.names), cameras, reader, extraction)
        progress(len(frames), steps)
        pycolmap.match_sequential(database, matching, pairing, verification)
        if options.focal is None:
            calibration = pycolmap.ViewGraphCalibrationOptions(random_seed=0)
            # Without an estimate the focal length keeps its initial value.
            pycolmap.calibrate_view_graph(database, calibration)
            _round_focal_length(database)
        progress(2 * len(frames), steps)
        attempts = [(error, True) for error in _OPTIONS.first_errors]
        if len(frames) < _OPTIONS.short_clip:
            attempts.append((_OPTIONS.first_errors[0], False))
        for mapping.mapper.init_max_error, bent in attempts:
            mapping.ba_refine_extra_params = mapping.mapper.abs_pose_refine_extra_params = bent
            models = pycolmap.incremental_mapping(
                database, frames.folder, work, mapping, next_image_callback=one_more
            )  # fmt: skip
            progress(steps, steps)
            yield list(models.values())
    except (RuntimeError, ValueError) as error:
        raise ValidationError(
            f"{frames.folder}: found that COLMAP fails ({str(error).strip().splitlines()[-1]}), needed poses; "
            "try other frames."
        ) from error


def _round_focal_length(database: pathlib.Path) -> None:
    """Drops the last digits: they depend on the order in which the solver's threads, one per core, add up."""
    import pycolmap

    with pycolmap.Database.open(database) as opened:
        for camera in opened.read_all_cameras():
            camera.focal_length = round(camera.focal_length, _OPTIONS.focal_digits)
            opened.update_camera(camera)


def _mapping(pycolmap: Any, refine_focal: bool) -> Any:
    """Mapping options for a camera carried on foot: small steps, small angles, and a bundle adjustment that stops
    early.

    One thread, because RANSAC seeds each of its threads differently, and sums over threads differ in their last bits.
    Either changes the inliers and, a few frames later, the structure.
    """
    mapping = pycolmap.IncrementalPipelineOptions(num_threads=1, extract_colors=False, random_seed=0)
    mapping.min_model_size = MIN_FRAMES
    mapping.ba_refine_focal_length = refine_focal
    for limited in (mapping, mapping.mapper, mapping.triangulation):
        limited.min_focal_length_ratio, limited.max_focal_length_ratio = _OPTIONS.min_focal, _OPTIONS.max_focal
        limited.max_extra_param = _OPTIONS.max_distortion
    mapping.ba_global_max_num_iterations = 30
    mapping.ba_local_max_num_iterations = 15
    mapping.mapper.init_min_tri_angle = 8.0
    mapping.mapper.abs_pose_min_num_inliers = 20
    mapping.mapper.abs_pose_max_error = _OPTIONS.pose_error
    mapping.mapper.filter_max_reproj_error = _OPTIONS.point_error
    mapping.mapper.abs_pose_refine_focal_length = refine_focal
    mapping.mapper.filter_min_tri_angle = 1.0
    mapping.triangulation.min_angle = 1.0
    return mapping


def _structure(models: list[Any], frames: Frames, overlap: int) -> Structure:
    """Combines COLMAP's models, the largest first; a frame belongs to the first model that contains it. Models that
    share frames are merged, and wrong links split (`links`; for overlap see `StructureOptions`)."""
    number = {name: k for k, name in enumerate(frames.names)}
    group = _laid_on_each_other(models)
    lens = next(iter(models[0].cameras.values()))
    focal, cx, cy, distortion = lens.params
    taken: set[str] = set()
    poses, registered, owner, points = [], [], [], []
    frame, point, straight = [], [], []
    for k, model in enumerate(models):
        images = [i for i in model.images.values() if i.has_pose and i.name not in taken]
        if k > 0 and len(images) < _OPTIONS.min_model:
            continue
        taken.update(i.name for i in images)
        own = next(iter(model.cameras.values()))
        identifiers = sorted(model.points3D)
        row = {identifier: sum(map(len, points)) + n for n, identifier in enumerate(identifiers)}
        points.append(np.array([model.points3D[i].xyz for i in identifiers]).reshape(-1, 3))
        for image in images:
            pose = np.eye(4)
            pose[:3] = image.cam_from_world().inverse().matrix()
            seen = image.get_observation_points2D()
            frame.append(np.full(len(seen), len(poses), np.int32))
            point.append(np.array([row[p.point3D_id] for p in seen], np.int32))
            bent = np.array([p.xy for p in seen]).reshape(-1, 2)
            straight.append(own.cam_from_img(bent) * focal + [cx, cy])
            poses.append(pose)
            registered.append(number[image.name])
            owner.append(k)
    unsorted = Structure(
        camera=Camera(frames.width, frames.height, focal, focal, cx, cy),
        distortion=float(distortion),
        registered=np.array(registered, np.int32),
        poses=np.array(poses),
        points=np.concatenate(points),
        frame=np.concatenate(frame),
        point=np.concatenate(point),
        pixel=np.concatenate(straight).astype(np.float32),
        error=float(models[0].compute_mean_reprojection_error()),
        model=np.array(group, np.int32)[owner],
    )
    order = np.argsort(registered)
    return links.split(unsorted.only(order), np.array(owner)[order], overlap)


def _laid_on_each_other(models: list[Any]) -> list[int]:
    """Transforms models that share frames into a common unit and axes; returns for each model the number of the model
    whose unit and axes it has."""
    import pycolmap

    group = list(range(len(models)))
    for k, model in enumerate(models):
        shared = [
            (depths, j)
            for j in range(k)
            if len((depths := _shared_depths(model, models[j]))[1]) >= _OPTIONS.min_shared_points
        ]
        if not shared:
            continue
        (name, depths), j = max(shared, key=lambda found: len(found[0][1]))
        # In a frame of both models, the depths of common points differ by the factor `scale`.
        scale = float(np.exp(np.median(np.log(depths[:, 1] / depths[:, 0]))))
        own, other = (m.find_image_with_name(name).cam_from_world() for m in (model, models[j]))
        back = other.inverse()
        shift = back.rotation * (scale * own.translation) + back.translation
        model.transform(pycolmap.Sim3d(scale, back.rotation * own.rotation, shift))
        group[k] = group[j]
    return group


def _shared_depths(a: Any, b: Any) -> tuple[str, np.ndarray]:
    """The frame in which two models share most points, and the depths (n, 2) of these points in both units."""
    names = {i.name for i in a.images.values() if i.has_pose} & {i.name for i in b.images.values() if i.has_pose}
    best = "", np.zeros((0, 2))
    for name in sorted(names):
        images = [model.find_image_with_name(name) for model in (a, b)]
        pairs = [
            (a.points3D[p.point3D_id].xyz, b.points3D[q.point3D_id].xyz)
            for p, q in zip(images[0].points2D, images[1].points2D, strict=True)
            if p.has_point3D() and q.has_point3D()
        ]
        if len(pairs) > len(best[1]):
            points = np.array(pairs)
            depths = [(i.cam_from_world() * points[:, n])[:, 2] for n, i in enumerate(images)]
            best = name, np.stack(depths, -1)
    return best
