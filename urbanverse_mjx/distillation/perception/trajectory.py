"""How far estimated poses are off true ones, after the two trajectories were laid on each other."""

import dataclasses

import numpy as np


@dataclasses.dataclass(frozen=True)
class TrajectoryError:
    """Of m poses that both trajectories have.

    Attributes:
      T: (4, 4) that takes estimated places to true ones, rigid.
      rmse, worst: m.
      turn: degrees, middle error of the direction.
      scale: true length over estimated length, as the best similarity has it; 1 where the metric scale is right.
    """

    T: np.ndarray
    rmse: float
    worst: float
    turn: float
    scale: float


def trajectory_error(estimated: np.ndarray, true: np.ndarray) -> TrajectoryError:
    """Lays (m, 4, 4) estimated on (m, 4, 4) true poses by a rigid motion that minimises the squared distances.

    Where the places lie on a line, the cameras' directions determine the rotation of the trajectory about it; elsewhere
    their weight, a thousandth of the places', hardly counts. Source: Umeyama, "Least-squares estimation of
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
