"""A street of upright boxes, drawn by intersecting rays with numpy: recordings whose ground truth is known in closed
form."""

import pathlib
from collections.abc import Sequence

import numpy as np

from urbanverse_mjx.datatypes import (
    KIND_INDEX,
    Camera,
    Detection,
    GraphObject,
    Recording,
    RecordingWriter,
    Source,
)
from urbanverse_mjx.datatypes.recording import SKY

HALF_ROAD, HALF_STREET, KERB, LENGTH = 4.0, 8.0, 0.15, 60.0
CAMERA = Camera.from_fov(192, 108, np.radians(52.0))
SOURCE = Source("synthetic", "CC0-1.0", "none", "none")


def box(name: str, label: str, x: float, y: float, size: tuple[float, float, float], yaw: float = 0.0) -> GraphObject:
    """An object that stands on the ground of the street at (x, y)."""
    floor = KERB if abs(y) > HALF_ROAD else 0.0
    return GraphObject(name, label, (x, y, floor + size[2] / 2), size, yaw)


def street_objects() -> list[GraphObject]:
    """Cars, bins, benches and kiosks on both sides, seen from both ends; two benches close together."""
    return [
        box("car_0", "sedan", 14.0, 3.0, (4.4, 1.8, 1.5), np.pi),
        box("car_1", "sedan", 30.0, -3.0, (4.4, 1.8, 1.5), 0.05),
        box("bench_0", "bench", 20.0, 7.2, (0.6, 1.8, 0.9), -np.pi / 2),
        box("bench_1", "bench", 22.6, 7.2, (0.6, 1.8, 0.9), -np.pi / 2 + 0.1),
        box("bench_2", "bench", 24.0, -7.1, (0.6, 1.8, 0.9), np.pi / 2 - 0.2),
        box("bin_0", "trash bin", 17.0, 4.7, (0.5, 0.7, 1.1), 0.3),
        box("bin_1", "trash bin", 35.0, 4.8, (0.5, 0.7, 1.1), -0.2),
        box("bin_2", "trash bin", 28.0, -4.8, (0.5, 0.7, 1.1), 0.0),
        box("kiosk_0", "kiosk", 28.0, 7.5, (2.0, 2.6, 2.4), -np.pi / 2),
        box("kiosk_1", "kiosk", 38.0, -6.6, (2.0, 2.6, 2.4), np.pi / 2),
    ]


def walk(count: int, y: float = 5.9, x0: float = 4.0, step: float = 1.4, back: bool = False) -> np.ndarray:
    """(n, 4, 4) T_world_camera of a level camera on the pavement, looking ahead and swaying by 30°."""
    poses = np.tile(np.eye(4), (count, 1, 1))
    for i in range(count):
        yaw = np.radians(30.0) * np.sin(i * 0.8) + (np.pi if back else 0.0)
        c, s = np.cos(yaw), np.sin(yaw)
        poses[i, :3, :3] = np.array([[s, 0, c], [-c, 0, s], [0, -1, 0]])
        x = x0 + i * step * (-1 if back else 1)
        poses[i, :3, 3] = x, y, (KERB if abs(y) > HALF_ROAD else 0.0) + 1.5
    return poses


def _hit_box(obj: GraphObject, camera_position: np.ndarray, rays: np.ndarray) -> np.ndarray:
    """(n,) ray parameter of the first hit, inf where there is none: the slab method in the box's own axes."""
    c, s = np.cos(obj.yaw), np.sin(obj.yaw)
    turn = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    start, direction = turn @ (camera_position - obj.center), rays @ turn.T
    half = np.array(obj.size) / 2
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = (-half - start) / direction, (half - start) / direction
    near, far = np.minimum(a, b).max(1), np.maximum(a, b).min(1)
    return np.where((near <= far) & (near > 0.05), near, np.inf)


def draw(objects: Sequence[GraphObject], pose: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Depth (H, W) m (0 = sky), object (H, W) or -1, and surface codes (H, W)."""
    rays = CAMERA.rays().reshape(-1, 3)
    world, camera_position = rays @ pose[:3, :3].T, pose[:3, 3]
    depth, obj = np.full(len(rays), np.inf), np.full(len(rays), -1)
    surface = np.full(len(rays), SKY, np.uint8)
    for height, kind, inside in (
        (0.0, "road", lambda y: np.abs(y) <= HALF_ROAD),
        (KERB, "sidewalk", lambda y: (np.abs(y) > HALF_ROAD) & (np.abs(y) <= HALF_STREET)),
    ):
        with np.errstate(divide="ignore", invalid="ignore"):
            t = (height - camera_position[2]) / world[:, 2]
        place = camera_position + t[:, None] * np.where(np.isfinite(t), 1, 0)[:, None] * world
        good = (t > 0.05) & inside(place[:, 1]) & (place[:, 0] > 0) & (place[:, 0] < LENGTH) & (t < depth)
        depth[good], surface[good] = t[good], KIND_INDEX[kind]
    for i, solid in enumerate(objects):
        t = _hit_box(solid, camera_position, world)
        nearer = t < depth
        depth[nearer], obj[nearer], surface[nearer] = t[nearer], i, 0
    shape = CAMERA.height, CAMERA.width
    return np.where(np.isfinite(depth), depth, 0.0).reshape(shape), obj.reshape(shape), surface.reshape(shape)


def record(folder: pathlib.Path, objects: Sequence[GraphObject], poses: np.ndarray, name: str = "drawn") -> Recording:
    """The street along a camera path, one frame a second, true ids as tracks."""
    writer = RecordingWriter(folder, name, SOURCE, CAMERA)
    colours = np.random.default_rng(0).integers(40, 255, (len(objects) + 1, 3)).astype(np.uint8)
    for i, pose in enumerate(poses):
        depth, obj, surface = draw(objects, pose)
        seen = np.unique(obj[obj >= 0])
        number = np.full(len(objects) + 1, -1)
        number[seen] = np.arange(len(seen))
        found = [Detection(objects[k].label, 1.0, objects[k].id) for k in seen]
        writer.add(float(i), colours[obj], depth, number[obj], surface, pose, found)
    return writer.close()
