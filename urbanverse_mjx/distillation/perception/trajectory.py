"""Errors of estimated poses after alignment of the two trajectories."""

import dataclasses

import numpy as np


@dataclasses.dataclass(frozen=True)
class TrajectoryError:
    """Errors over the m poses that both trajectories have.

    Attributes:
      T: (4, 4) rigid transform from estimated to true positions.
      rmse, worst: m.
      turn: degrees, median error of the direction.
      scale: true length over estimated length in the best similarity transform; 1 for the correct metric scale.
    """

    T: np.ndarray
    rmse: float
    worst: float
    turn: float
    scale: float


def trajectory_error(estimated: np.ndarray, true: np.ndarray) -> TrajectoryError:
    """Aligns (m, 4, 4) estimated with (m, 4, 4) true poses by the rigid transform that minimises the squared distances.

    If the positions lie on a line, the cameras' directions determine the rotation about it; otherwise their weight, a
    thousandth of that of the positions, has hardly any effect. Source: Umeyama, "Least-squares estimation of
    transformation parameters between two point patterns", 1991.
    """
    a, b = estimated[:, :3, 3], true[:, :3, 3]
    a0, b0 = a - a.mean(0), b - b.mean(0)
    places, directions = b0.T @ a0, np.einsum("mij,mkj->ik", true[:, :3, :3], estimated[:, :3, :3])
    u, _, vt = np.linalg.svd(places + 1e-3 * np.trace(a0.T @ a0) / len(a) * directions)
    sign = np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ vt))])
    turn = u @ sign @ vt
    T = np.eye(4)
    T[:3, :3] = turn
    T[:3, 3] = b.mean(0) - T[:3, :3] @ a.mean(0)
    off = np.linalg.norm(a @ T[:3, :3].T + T[:3, 3] - b, axis=1)
    apart = np.swapaxes(T[:3, :3] @ estimated[:, :3, :3], 1, 2) @ true[:, :3, :3]
    angle = np.degrees(np.arccos(np.clip((np.trace(apart, axis1=1, axis2=2) - 1) / 2, -1, 1)))
    length = max(float((a0**2).sum()), 1e-12)
    return TrajectoryError(
        T,
        float(np.sqrt((off**2).mean())),
        float(off.max()),
        float(np.median(angle)),
        float(np.trace(turn.T @ places)) / length,
    )
