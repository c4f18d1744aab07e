"""Models of a made-up street as COLMAP makes them, each in a unit and axes of its own."""

import numpy as np
from scipy.spatial.transform import Rotation

from urbanverse_mjx.capture.path import camera_poses
from urbanverse_mjx.datatypes import GROUND_KINDS, Camera
from urbanverse_mjx.distillation.perception.structure import Structure

CAMERA = Camera(320, 180, 210.0, 210.0, 160.0, 90.0)
HEIGHT = 1.5  # m
SIDEWALK = GROUND_KINDS.index("sidewalk")
OUT = 36  # frames of the outward path


def _street() -> tuple[np.ndarray, np.ndarray]:
    """(p, 3) m points of two rows of houses that stand forward and back, poles and ground; (p,) whether ground."""
    rng = np.random.default_rng(3)
    x = rng.uniform(0.0, 44.0, 5000)
    side = rng.integers(0, 2, len(x))
    front = rng.uniform(0.0, 1.5, (2, 8))[side, (x / 5.5).astype(int)]
    walls = np.c_[x, (2 * side - 1) * (6.0 + front), rng.uniform(0.0, 5.0, len(x))]
    poles = np.c_[rng.uniform([0.0, -5.0], [44.0, 5.0], (25, 2)), np.zeros(25)]
    poles = np.repeat(poles, 30, 0) + rng.uniform(0.0, [0.2, 0.2, 3.0], (750, 3))
    ground = np.c_[rng.uniform([0.0, -5.0], [44.0, 5.0], (4000, 2)), rng.normal(0.0, 0.01, 4000)]
    points = np.concatenate([walls, poles, ground])
    return points, np.arange(len(points)) >= len(walls) + len(poles)


POINTS, GROUND = _street()


def _trajectory() -> np.ndarray:
    """(2 OUT, 4, 4): along one side, half a turn from one frame to the next, and back along the other."""
    there = np.c_[5.0 + 0.9 * np.arange(OUT), np.full(OUT, -1.2), np.full(OUT, HEIGHT)]
    back = there[::-1] + [0.2, 0.8, 0.0]
    yaw = np.r_[0.25 * np.sin(np.arange(OUT) / 3), np.pi + 0.25 * np.sin(np.arange(OUT) / 3)]
    return camera_poses(np.concatenate([there, back]), yaw)


TRAJECTORY = _trajectory()


def model_of(
    rows: np.ndarray, seed: int, unit: float, points: np.ndarray = POINTS, trajectory: np.ndarray = TRAJECTORY
) -> dict[str, np.ndarray]:
    """Points within 14 m of the frames of some rows, in the model's own unit and axes."""
    own = np.eye(4)
    own[:3, :3] = Rotation.random(random_state=seed).as_matrix()
    own[:3, 3] = 3.0 * seed
    ahead = points[None] - trajectory[rows, None, :3, 3]
    seen = (np.linalg.norm(ahead, axis=-1) < 14.0) & (np.einsum("mpi,mi->mp", ahead, trajectory[rows, :3, 2]) > 1.0)
    frame, point = np.nonzero(seen)
    poses = own @ trajectory[rows]
    poses[:, :3, 3] *= unit
    moved = unit * (points @ own[:3, :3].T + own[:3, 3])
    return {"rows": rows, "poses": poses, "points": moved, "frame": frame, "point": point}


def structure_of(models: list[dict[str, np.ndarray]]) -> tuple[Structure, np.ndarray]:
    """The models as one structure, and the codes of what its observations show."""
    first = np.cumsum([0, *(len(m["rows"]) for m in models)])
    below = np.cumsum([0, *(len(m["points"]) for m in models)])
    point = np.concatenate([m["point"] + n for m, n in zip(models, below, strict=False)])
    whole = Structure(
        CAMERA,
        0.0,
        np.concatenate([m["rows"] for m in models]).astype(np.int32),
        np.concatenate([m["poses"] for m in models]),
        np.concatenate([m["points"] for m in models]),
        np.concatenate([m["frame"] + n for m, n in zip(models, first, strict=False)]).astype(np.int32),
        point.astype(np.int32),
        np.zeros((len(point), 2), np.float32),
        0.0,
        np.repeat(np.arange(len(models)), np.diff(first)).astype(np.int32),
    )
    on_ground = np.concatenate([GROUND[m["point"] % len(POINTS)] & m.get("ground", True) for m in models])
    return whole, np.where(on_ground, SIDEWALK, 0).astype(np.uint8)
