"""Estimates per-frame depth scale and depth noise from the ground, whose height is the same in neighbouring frames."""

import dataclasses

import numpy as np

from .lifting import GroundPoints

#: Relative noise of perfect depth: a pixel covers 0.2 % of the range (f = 500 pixels).
MIN_NOISE = 0.002


@dataclasses.dataclass(frozen=True)
class DepthScaleOptions:
    """Ground used for the scale of a frame's depth, and its weight.

    Chosen manually; `benchmarks.fidelity` measures their effect (docs/decisions/generation.md).

    Attributes:
      max_range: m from the camera; the viewing angle on nearer ground is steep enough to derive the camera's height.
      window: frames to both sides over which ground of one kind is assumed level.
      min_spread: scales that scatter less are not corrected, because slopes and kerbs cause such scatter.
      limits: least and greatest scale of a frame.
      rounds: iterations that compute heights from scales and scales from heights.
    """

    max_range: float = 15.0
    window: int = 20
    min_spread: float = 0.015
    limits: tuple[float, float] = (0.6, 1.7)
    rounds: int = 3


_OPTIONS = DepthScaleOptions()


@dataclasses.dataclass(frozen=True)
class DepthScale:
    """Depth scale of the frames: scale (m,), factor on each frame's depth; noise, remaining relative error of a point's
    depth (1 sigma)."""

    scale: np.ndarray
    noise: float


def depth_scale(ground: GroundPoints, poses: np.ndarray) -> DepthScale:
    """Computes the scales under which each kind of ground keeps its height from frame to frame.

    For ground of kind k in frame f the drop below the camera is measured as d. Its height Z[k] is the median over the
    neighbouring frames of z_camera - s d; the scale s of a frame is the mean over its ground of (z_camera - Z[k]) / d.

    Args:
      ground: points in camera frames.
      poses: (m, 4, 4) T_world_camera.
    """
    frames = len(poses)
    world = np.einsum("gij,gj->gi", poses[ground.frame, :3, :3], ground.points)
    near = (np.linalg.norm(ground.points, axis=1) < _OPTIONS.max_range) & (world[:, 2] < -0.2)
    frame, kind, drop = ground.frame[near], ground.kind[near].astype(np.int64), -world[near, 2]
    if not len(frame):
        return DepthScale(np.ones(frames), MIN_NOISE)
    cameras = poses[:, 2, 3]
    kinds, kind = np.unique(kind, return_inverse=True)
    drops, counts = _medians(frame, kind, drop, frames, len(kinds))
    scale = np.ones(frames)
    heights = np.full(drops.shape, np.nan)
    for _ in range(_OPTIONS.rounds):
        heights = _windowed(cameras[:, None] - scale[:, None] * drops, counts)
        ratio = (cameras[:, None] - heights) / drops
        scale = _weighted(ratio, counts, scale)
    spread = 1.4826 * np.median(np.abs(scale - np.median(scale)))
    if spread < _OPTIONS.min_spread:
        scale = np.ones(frames)
    expected = (cameras[frame] - heights[frame, kind]) / scale[frame]
    error = drop / expected - 1.0
    # Ramps and slopes are not noise: the common part of a frame's ground of one kind is subtracted.
    shared, _ = _medians(frame, kind, error, frames, len(kinds))
    noise = 1.4826 * np.nanmedian(np.abs(error - shared[frame, kind]))
    return DepthScale(np.clip(scale, *_OPTIONS.limits), float(max(noise, MIN_NOISE)))


def _medians(
    frame: np.ndarray, kind: np.ndarray, value: np.ndarray, frames: int, kinds: int
) -> tuple[np.ndarray, np.ndarray]:
    """(frames, kinds) medians, NaN without a measurement, and counts."""
    cell = frame * kinds + kind
    order = np.lexsort((value, cell))
    counts = np.bincount(cell, minlength=frames * kinds)
    starts = np.r_[0, np.cumsum(counts)[:-1]]
    out = np.full(frames * kinds, np.nan)
    some = counts > 0
    out[some] = value[order[(starts + counts // 2)[some]]]
    return out.reshape(frames, kinds), counts.reshape(frames, kinds)


def _windowed(values: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """Medians over `window` frames to both sides, of frames with enough ground of the kind."""
    solid = np.where(counts >= 10, values, np.nan)
    padded = np.pad(solid, ((_OPTIONS.window, _OPTIONS.window), (0, 0)), constant_values=np.nan)
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * _OPTIONS.window + 1, axis=0)
    out = np.full(values.shape, np.nan)
    some = np.isfinite(windows).any(-1)
    out[some] = np.nanmedian(windows[some], axis=-1)
    return out


def _weighted(ratio: np.ndarray, counts: np.ndarray, fallback: np.ndarray) -> np.ndarray:
    """(m,) mean of each frame's ratios, by the points behind them."""
    weight = np.where(np.isfinite(ratio), counts, 0)
    total = weight.sum(1)
    mean = (np.nan_to_num(ratio) * weight).sum(1) / np.maximum(total, 1)
    return np.where(total > 0, mean, fallback)
