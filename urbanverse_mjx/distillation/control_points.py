"""A slow correction of poses: a shift and a turn about z at control points along the trajectory, linear in between."""

import dataclasses

import numpy as np
from scipy.spatial.transform import Rotation


@dataclasses.dataclass(frozen=True)
class DriftOptions:
    """Model of odometry drift.

    A drift of 1 % and 0.3° per 10 m is 0.11 m and 0.34° from one control point to the next (8 steps of 1.4 m).

    Attributes:
      spacing: frames from one control point to the next.
      shift_sigma: m, drift of the position from one control point to the next in addition to the effect of the turn.
      turn_sigma: rad, change of the turn from one to the next.
      bend_sigma: rad, change of that change.
    """

    spacing: int = 8
    shift_sigma: float = 0.15
    turn_sigma: float = np.radians(0.6)
    bend_sigma: float = np.radians(0.2)


_OPTIONS = DriftOptions()


def between(frames: int) -> tuple[np.ndarray, np.ndarray]:
    """(frames,) the control point before each frame (never the last), and (frames,) the share of the path to the
    next."""
    count = max(2, int(np.ceil((frames - 1) / _OPTIONS.spacing)) + 1)
    place = np.arange(frames) * ((count - 1) / max(frames - 1, 1))
    before = np.minimum(place.astype(int), count - 2)
    return before, place - before


def weights(frames: int) -> np.ndarray:
    """(frames, k) weights of the control points at every frame: linear in between."""
    before, share = between(frames)
    rows = np.arange(frames)
    out = np.zeros((frames, int(before.max(initial=0)) + 2))
    out[rows, before], out[rows, before + 1] = 1.0 - share, share
    return out


def corrected(poses: np.ndarray, change: np.ndarray) -> np.ndarray:
    """(m, 4, 4) poses, shifted and turned in place by (m, 4) m and rad."""
    out = poses.copy()
    out[:, :3, :3] = Rotation.from_rotvec(change[:, 3:] * [0.0, 0.0, 1.0]).as_matrix() @ poses[:, :3, :3]
    out[:, :3, 3] += change[:, :3]
    return out


def odometry(correction: np.ndarray, at: np.ndarray, poses: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Residuals of the odometry for the correction (k, 4): (r, 4 k) Jacobian and (r,) values."""
    count = len(correction)
    place = np.array([poses[int(column.argmax()), :3, 3] for column in at.T])
    step = np.diff(place, axis=0)
    change = np.diff(np.eye(count), axis=0)
    turn = 0.5 * (correction[1:, 3] + correction[:-1, 3])
    c, s = np.cos(turn), np.sin(turn)
    bent = np.stack([(c - 1) * step[:, 0] - s * step[:, 1], s * step[:, 0] + (c - 1) * step[:, 1], 0 * c], -1)
    slope = np.stack([-s * step[:, 0] - c * step[:, 1], c * step[:, 0] - s * step[:, 1], 0 * c], -1)
    middle = 0.5 * np.abs(change)
    blocks, values = [], []
    for axis, sigma in enumerate((_OPTIONS.shift_sigma, _OPTIONS.shift_sigma, _OPTIONS.shift_sigma / 2)):
        block = np.zeros((count - 1, count, 4))
        block[:, :, axis] = change
        block[:, :, 3] = -slope[:, axis, None] * middle
        blocks.append(block.reshape(-1, count * 4) / sigma)
        values.append(-(change @ correction[:, axis] - bent[:, axis]) / sigma)
    for rows, sigma in ((change, _OPTIONS.turn_sigma), (np.diff(np.eye(count), n=2, axis=0), _OPTIONS.bend_sigma)):
        block = np.zeros((len(rows), count, 4))
        block[:, :, 3] = rows
        blocks.append(block.reshape(-1, count * 4) / sigma)
        values.append(-rows @ correction[:, 3] / sigma)
    return np.concatenate(blocks), np.concatenate(values)


def anchor(correction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Residual rows that keep the first control point in place."""
    block = np.zeros((4, correction.size))
    block[np.arange(4), np.arange(4)] = 1e3
    return block, -block @ correction.ravel()
