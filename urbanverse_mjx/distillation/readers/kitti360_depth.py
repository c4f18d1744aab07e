"""Computes depth for KITTI-360's frames from the laser's points, or from the annotated boxes and the road's level."""

import pathlib
from collections.abc import Mapping, Sequence

import numpy as np
import scipy.ndimage
from scipy.spatial import ConvexHull, QhullError

from ...datatypes import Camera, Detection
from ...datatypes import validation as v
from ...datatypes.recording import SKY
from .kitti360_boxes import Kitti360Box

#: m, height of the cameras above the road (sensor drawing of the data set).
CAMERA_HEIGHT = 1.55
#: Pixels around a laser point that take its depth; the laser's lines are 6 to 8 pixels apart.
_POINT_SPREAD = 3
#: m; farther away the view of the road is too flat to derive distance from its height.
_ROAD_RANGE = 40.0


def scan_depth(path: pathlib.Path, T_camera_scan: np.ndarray, camera: Camera) -> np.ndarray:
    """(H, W) f32 m, depth of the nearest laser point within `_POINT_SPREAD` pixels, 0 elsewhere.

    Raises:
      ValidationError: the scan does not exist or does not hold four floats per point.
    """
    try:
        raw = path.read_bytes()
    except OSError as error:
        raise v.fail(str(path), f"no readable scan ({error})", "one per frame", "use the boxes for depth") from error
    if len(raw) % 16:
        raise v.fail(str(path), f"{len(raw)} bytes", "four float32 for every point", "download it again")
    points = np.frombuffer(raw, "<f4").reshape(-1, 4)[:, :3] @ T_camera_scan[:3, :3].T + T_camera_scan[:3, 3]
    points = points[points[:, 2] > 0.5]
    u = np.floor(camera.fx * points[:, 0] / points[:, 2] + camera.cx).astype(int)
    w = np.floor(camera.fy * points[:, 1] / points[:, 2] + camera.cy).astype(int)
    inside = (u >= 0) & (u < camera.width) & (w >= 0) & (w < camera.height)
    u, w, z = u[inside], w[inside], points[inside, 2]
    sparse = np.full((camera.height, camera.width), np.inf, np.float32)
    np.minimum.at(sparse, (w, u), z.astype(np.float32))
    if not len(z):
        return np.zeros_like(sparse)
    away, at = scipy.ndimage.distance_transform_edt(np.isinf(sparse), return_indices=True)
    return np.where(away <= _POINT_SPREAD, sparse[tuple(at)], 0.0).astype(np.float32)


def boxes_depth(
    masks: np.ndarray,
    detections: Sequence[Detection],
    surfaces: np.ndarray,
    boxes: Mapping[str, Kitti360Box],
    origin: np.ndarray,
    T_world_camera: np.ndarray,
    camera: Camera,
) -> np.ndarray:
    """(H, W) f32 m, depth of object pixels where their rays enter the box, and of ground pixels where their rays meet
    the road's level.

    Args:
      masks, detections, surfaces: of the frame; tracks are the boxes' ids.
      boxes: boxes valid at the frame.
      origin: (3,) m, origin of the recording's world in that of KITTI-360.
    """
    rays = camera.rays() @ T_world_camera[:3, :3].T
    camera_position = T_world_camera[:3, 3]
    depth = np.zeros(masks.shape, np.float32)
    down = rays[..., 2]
    ground = (surfaces > 0) & (surfaces != SKY) & (down < 0)
    level = np.where(ground, CAMERA_HEIGHT / np.maximum(-down, 1e-6), 0.0)
    depth[:] = np.where(level < _ROAD_RANGE, level, 0.0)
    for k, detection in enumerate(detections):
        box = boxes.get(detection.track or "")
        mine = masks == k
        depth[mine] = 0.0 if box is None else _entry(box.corners - origin - camera_position, rays[mine])
    return depth


def _entry(corners: np.ndarray, rays: np.ndarray) -> np.ndarray:
    """(n,) factor on a ray (n, 3) from the origin at which it enters the hull of (k, 3) corners; 0 if it misses,
    because outlines drawn by hand are a pixel or two too wide."""
    try:
        planes = ConvexHull(corners).equations
    except (QhullError, ValueError):
        return np.zeros(len(rays))
    along, offset = rays @ planes[:, :3].T, planes[:, 3]
    with np.errstate(divide="ignore", invalid="ignore"):
        cross = -offset / along
    enter = np.where(along < 0, cross, -np.inf).max(1)
    leave = np.where(along > 0, cross, np.inf).min(1)
    outside = ((along == 0) & (offset > 0)).any(1)
    return np.where((enter > 0) & (enter <= leave) & ~outside, enter, 0.0)
