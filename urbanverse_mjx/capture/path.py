"""Camera path of a pedestrian through a street: along one side, over the road and back along the other."""

import dataclasses

import numpy as np
import scipy.ndimage
import skimage.graph
from scipy.spatial.transform import Rotation

from ..datatypes import SceneBank, ValidationError
from .street import CELL, StreetGrid, street_grid


@dataclasses.dataclass(frozen=True)
class WalkOptions:
    """Clearance and smoothness of the path; chosen manually.

    Attributes:
      min_clearance: m, least distance to objects: half a shoulder's width and a hand.
      comfort_clearance: m; paths nearer than this to objects cost more.
      corner_window: m, window over which corners are rounded.
      lookahead: m, distance along the path to the point that the camera moves towards.
      turn_step: s, time step of the smoothing of turns.
    """

    min_clearance: float = 0.35
    comfort_clearance: float = 1.0
    corner_window: float = 1.5
    lookahead: float = 0.5
    turn_step: float = 0.05


_WALK = WalkOptions()


@dataclasses.dataclass(frozen=True)
class PathOptions:
    """Options of the camera's motion.

    Attributes:
      speed: m/s; 1.4 is a usual walking speed.
      rate: frames per second.
      height: m of the camera above the ground.
      sway: rad, amplitude of the camera's yaw to both sides.
      sway_period: s of one oscillation.
      pitch: rad, upwards.
      turn_time: s over which a change of direction is spread. A person with a camera takes some seconds to turn around
        (60° a second at 3 s).
      frames: exact number of frames, repeating the path if it is too short; None = the path once.
    """

    speed: float = 1.4
    rate: float = 1.0
    height: float = 1.5
    sway: float = np.radians(35.0)
    sway_period: float = 12.0
    pitch: float = np.radians(4.0)
    turn_time: float = 3.0
    frames: int | None = None

    def __post_init__(self) -> None:
        positive = min(self.speed, self.rate, self.height, self.sway_period)
        if positive <= 0 or self.turn_time < 0 or not abs(self.pitch) < 1.2:
            raise ValidationError(
                f"camera path: found {self}, needed positive speed, rate and height, a turn time of at least 0 and a "
                "pitch below 1.2."
            )
        if self.frames is not None and self.frames < 1:
            raise ValidationError(f"camera path: found {self.frames} frames, needed at least 1.")


@dataclasses.dataclass(frozen=True)
class CameraPath:
    """Camera poses over time: time_s (n,) s; T_world_camera (n, 4, 4), OpenCV axes (x right, y down, z forward)."""

    time_s: np.ndarray
    T_world_camera: np.ndarray

    def plan(self) -> np.ndarray:
        """(n, 4) x, y, z (m) and yaw (rad) of the camera, the format of a `SceneGraph`."""
        forward = self.T_world_camera[:, :3, 2]
        return np.c_[self.T_world_camera[:, :3, 3], np.arctan2(forward[:, 1], forward[:, 0])]


def walk(bank: SceneBank, scene: int, options: PathOptions | None = None) -> CameraPath:
    """Plans the path along both sides of a scene's street.

    Raises:
      ValidationError: no ground is wide enough for a pedestrian.
    """
    options = options or PathOptions()
    street = street_grid(bank, scene)
    ring = _smooth(_round_trip(street, bank.scene_ids[scene]))
    lengths = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(ring, axis=0), axis=1))]
    step = options.speed / options.rate
    count = options.frames or max(1, int(lengths[-1] / step))
    # The path is closed, so it can repeat.
    along = (np.arange(count) * step) % lengths[-1]
    place = _at(along, lengths, ring)
    time_s = np.arange(count) / options.rate
    yaw = _heading(ring, lengths, time_s, options) + options.sway * np.sin(2 * np.pi * time_s / options.sway_period)
    height = _floor(street, place) + options.height
    return CameraPath(time_s, camera_poses(np.c_[place, height], yaw, options.pitch))


def _at(along: np.ndarray, lengths: np.ndarray, ring: np.ndarray) -> np.ndarray:
    """(n, 2) m: places after (n,) m of a way whose corners (r, 2) lie at lengths (r,)."""
    return np.stack([np.interp(along, lengths, ring[:, k]) for k in (0, 1)], -1)


def _heading(ring: np.ndarray, lengths: np.ndarray, time_s: np.ndarray, options: PathOptions) -> np.ndarray:
    """(n,) rad, heading of the camera: the path's direction, with each change spread evenly over `turn_time`."""
    half = round(options.turn_time / 2 / _WALK.turn_step)
    ticks = np.arange(-half, round(time_s[-1] / _WALK.turn_step) + half + 1) * _WALK.turn_step
    along = np.clip(ticks, 0.0, time_s[-1]) * options.speed
    towards = _at((along + _WALK.lookahead) % lengths[-1], lengths, ring) - _at(along % lengths[-1], lengths, ring)
    yaw = np.unwrap(np.arctan2(towards[:, 1], towards[:, 0]))
    spread = np.convolve(yaw, np.full(2 * half + 1, 1.0 / (2 * half + 1)), "valid")
    return np.interp(time_s, ticks[half : len(ticks) - half], spread)


def camera_poses(position: np.ndarray, yaw: np.ndarray, pitch: float | np.ndarray = 0.0) -> np.ndarray:
    """(n, 4, 4) T_world_camera, OpenCV axes, of cameras without roll at (n, 3) m with yaw (n,) and pitch upwards."""
    # The columns are the camera's right, down and forward for yaw 0.
    level = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
    turns = np.stack([yaw, -np.broadcast_to(pitch, np.shape(yaw)), np.zeros_like(yaw)], -1)
    poses = np.tile(np.eye(4), (len(yaw), 1, 1))
    poses[:, :3, :3] = Rotation.from_euler("ZYX", turns).as_matrix() @ level
    poses[:, :3, 3] = position
    return poses


def _floor(street: StreetGrid, place: np.ndarray) -> np.ndarray:
    """(n,) m, height of the ground under points, smoothed over kerbs."""
    missing = np.isnan(street.height)
    nearest = scipy.ndimage.distance_transform_edt(missing, return_distances=False, return_indices=True)
    filled = scipy.ndimage.gaussian_filter(street.height[tuple(nearest)], 0.5 / CELL)
    i, j = street.cell(place).T
    return filled[i, j]


def _round_trip(street: StreetGrid, name: str) -> np.ndarray:
    """(n, 2) m, closed path from one end of a side to the other, across the road and back."""
    component, _ = scipy.ndimage.label(street.clearance > _WALK.min_clearance, np.ones((3, 3)))
    sizes = np.bincount(component.ravel())
    if len(sizes) < 2:
        raise ValidationError(
            f"scene {name!r}: found no ground with {_WALK.min_clearance:g} m to every side, needed some to walk on."
        )
    cells = np.argwhere(component == 1 + np.argmax(sizes[1:]))
    points = street.middle(cells)
    centre = points.mean(0)
    _, axes = np.linalg.eigh(np.cov((points - centre).T))
    # First along the street (the longer axis), then across.
    along, across = ((points - centre) @ axes[:, ::-1]).T
    if axes[np.argmax(np.abs(axes[:, 1])), 1] < 0:
        along = -along
    stops = []
    for side, backwards in ((across <= np.median(across), False), (across > np.median(across), True)):
        order = np.flatnonzero(side)
        wide = order[street.clearance[tuple(cells[order].T)] > _WALK.min_clearance]
        low, high = wide[np.argmin(along[wide])], wide[np.argmax(along[wide])]
        stops += [high, low] if backwards else [low, high]
    # The weight 20 of the comfort clearance keeps the path off the edges of objects without closing gaps.
    near = np.clip(_WALK.comfort_clearance - street.clearance, 0.0, None) / _WALK.comfort_clearance
    cost = np.where(street.clearance > _WALK.min_clearance, 1.0 + 20.0 * near**2, np.inf)
    paths = []
    for start, stop in zip(stops, [*stops[1:], stops[0]], strict=True):
        path, _ = skimage.graph.route_through_array(cost, cells[start], cells[stop], geometric=True)
        paths.append(street.middle(np.array(path[:-1])))
    paths.append(street.middle(cells[stops[0]])[None])
    return np.concatenate(paths)


def _smooth(ring: np.ndarray) -> np.ndarray:
    """Rounds the corners of a path, with a point every few centimetres to decimetres; the ends do not move."""
    window = max(3, int(_WALK.corner_window / CELL) | 1)
    half = window // 2
    padded = np.concatenate([np.repeat(ring[:1], half, 0), ring, np.repeat(ring[-1:], half, 0)])
    kernel = np.ones(window) / window
    return np.stack([np.convolve(padded[:, k], kernel, "valid") for k in (0, 1)], -1)
