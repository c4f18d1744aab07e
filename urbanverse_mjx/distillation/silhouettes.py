"""Estimates an object's heading from its angular width in several views.

The directions to an object's left and right edge do not depend on its depth. In each view they are tangents of the
object's footprint: for the outward normal n of a tangent through the viewpoint e, c . n + h(n) = e . n, with c its
position and h the support function of its outline (Prince and Willsky, "Reconstructing Convex Sets from Support Line
Measurements", 1990). The rotated and scaled outlines of a label's known shapes are fitted to the tangents of all views;
position and scale follow by linear least squares for every heading.
"""

import dataclasses

import numpy as np

from ..datatypes import LabelPrior
from .bearings import Bearings

#: rad.
_HEADINGS = np.radians(np.arange(0.0, 360.0, 6.0))


@dataclasses.dataclass(frozen=True)
class SilhouetteOptions:
    """Weights of the directions to the edges of an object.

    Chosen manually; `benchmarks.fidelity` measures their effect (docs/decisions/generation.md).

    Attributes:
      normals: number of directions in which an outline's support function is stored.
      min_views: fewest views from which a heading is estimated.
      rim_sigma: m, standard error of an edge's position.
      direction_sigma: rad, standard error of a direction.
      width_error: error of a mask's width as a share of the width.
      scale_sigma: relative difference of known sizes from an object's size (1 sigma).
      rounds: iterations of least squares with robust weights.
      min_misfit_difference: half the difference of misfits from which one heading is distinguished from most others;
        the mean error is 16° above it and 39° below (four captures).
    """

    normals: int = 180
    min_views: int = 2
    rim_sigma: float = 0.03
    direction_sigma: float = np.radians(0.25)
    width_error: float = 0.08
    scale_sigma: float = 0.15
    rounds: int = 4
    min_misfit_difference: float = 4.0


_OPTIONS = SilhouetteOptions()


@dataclasses.dataclass(frozen=True)
class Fit:
    """Misfit by heading: yaw (h,) rad over the full turn; misfit (h,) robust sum of squared residuals of the edges in
    standard errors."""

    yaw: np.ndarray
    misfit: np.ndarray

    @property
    def clear(self) -> bool:
        """Whether the best heading fits much better than most others."""
        return bool(np.median(self.misfit) - self.misfit.min() > _OPTIONS.min_misfit_difference)

    def tells_front(self, yaw: float) -> bool:
        """Whether a heading, rad, fits much better than the opposite one."""
        return self.at(yaw + np.pi) - self.at(yaw) > _OPTIONS.min_misfit_difference

    @property
    def best(self) -> float:
        """rad."""
        return float(self.yaw[np.argmin(self.misfit)])

    def at(self, yaw: float) -> float:
        """The misfit of the heading nearest to one."""
        return float(self.misfit[np.argmax(np.cos(self.yaw - yaw))])


def supports(prior: LabelPrior) -> np.ndarray:
    """(k, normals) m, support functions of a label's known outlines in their own axes; of boxes if the label has no
    shapes."""
    angle = np.arange(_OPTIONS.normals) * (2 * np.pi / _OPTIONS.normals)
    normal = np.stack([np.cos(angle), np.sin(angle)])
    if prior.shapes:
        return np.stack([(shape[:, :2] @ normal).max(0) for shape in prior.shapes])
    return (prior.extents[:, :2] / 2) @ np.abs(normal)


def face(seen: Bearings, prior: LabelPrior) -> Fit | None:
    """Misfit of every heading to the views of an object; None if there are too few views.

    Args:
      seen: views of the object whose sides the image does not cut off.
      prior: of its label.
    """
    if len(seen.frame) < _OPTIONS.min_views or not len(prior.extents):
        return None
    rim = np.stack([seen.direction - seen.half, seen.direction + seen.half], -1)
    outward = rim + np.array([-np.pi / 2, np.pi / 2])  # (n, 2) rad
    normal = np.stack([np.cos(outward), np.sin(outward)], -1)
    right = np.einsum("nri,ni->nr", normal, seen.viewpoint)
    error = np.repeat(
        np.sqrt(
            _OPTIONS.rim_sigma**2
            + (_OPTIONS.direction_sigma * seen.reach) ** 2
            + (_OPTIONS.width_error * seen.width) ** 2
        ),
        2,
    )
    outline = supports(prior)
    step = 2 * np.pi / _OPTIONS.normals
    own = np.remainder(outward.reshape(-1)[None] - _HEADINGS[:, None], 2 * np.pi) / step  # (h, 2 n)
    support = outline[:, np.round(own).astype(int) % _OPTIONS.normals]  # (k, h, 2 n)
    A = np.concatenate([np.broadcast_to(normal.reshape(-1, 2), (*support.shape, 2)), support[..., None]], -1)
    A = A / error[:, None]
    b = np.broadcast_to(right.reshape(-1) / error, support.shape)
    trust = np.ones(support.shape)
    for _ in range(_OPTIONS.rounds):
        W = trust[..., None] * A
        normal_matrix = np.einsum("khni,khnj->khij", W, A, optimize=True)
        normal_matrix[..., 2, 2] += 1.0 / _OPTIONS.scale_sigma**2
        values = np.einsum("khni,khn->khi", W, b, optimize=True)
        values[..., 2] += 1.0 / _OPTIONS.scale_sigma**2
        x = np.linalg.solve(normal_matrix, values[..., None])[..., 0]
        off = np.einsum("khni,khi->khn", A, x) - b
        trust = 1.0 / (1.0 + (off / 2.0) ** 2) ** 2
    cost = (off**2 / (1.0 + (off / 2.0) ** 2)).sum(-1) + ((x[..., 2] - 1.0) / _OPTIONS.scale_sigma) ** 2
    return Fit(_HEADINGS, cost.min(0))
