"""Estimates an object's heading and the sides of its footprint from its angular width in several views.

The directions to an object's left and right edge do not depend on its depth. In each view they are tangents of the
object's footprint: for the outward normal n of a tangent through the viewpoint e, c . n + h(n) = e . n, with c its
position and h the support function of its outline (Prince and Willsky, "Reconstructing Convex Sets from Support Line
Measurements", 1990). The rotated and scaled outlines of a label's known shapes are fitted to the tangents of all views;
position and scale follow by linear least squares for every heading. The sides follow for one heading: an outline
stretched by a and b along its axes has the support function h((a n_x, b n_y)), with h homogeneous.
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
      size_sigma, ratio_sigma: spread (log) of the sizes of a label's objects about each known one, and of the ratio of
        their sides: what the images do not show comes from the known sizes.
      max_views: largest number of views, evenly over all, from which headings and sides are estimated.
      step: difference of the stretches (log) over which slopes are taken.
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
    size_sigma: float = 0.4
    ratio_sigma: float = 0.3
    max_views: int = 40
    step: float = 0.02
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


def thinned(seen: Bearings) -> Bearings:
    """At most `max_views` of the views of an object, evenly over all."""
    if not len(seen.frame):
        return seen
    return seen.of(np.unique(np.linspace(0, len(seen.frame) - 1, _OPTIONS.max_views).round().astype(int)))


def face(seen: Bearings, prior: LabelPrior) -> Fit | None:
    """Misfit of every heading to the views of an object; None if there are too few views.

    Args:
      seen: views of the object whose sides the image does not cut off.
      prior: of its label.
    """
    if len(seen.frame) < _OPTIONS.min_views or not len(prior.extents):
        return None
    outward, normal, right, error = _tangents(seen)
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


@dataclasses.dataclass(frozen=True)
class Sides:
    """A footprint: center (2,) m; size (2,) m along the heading and across; error (2,), standard error of the size's
    logarithm without what the label's known sizes say."""

    center: np.ndarray
    size: np.ndarray
    error: np.ndarray


def sides(seen: Bearings, prior: LabelPrior, yaw: float, center: np.ndarray, sigma: float) -> Sides | None:
    """The footprint of an object with a known heading; None if there are too few views.

    The two tangents of a view give two equations: their sum, the width, depends on the distance of the centre alone,
    and their difference on its direction. They are weighted apart, so that poses that drift do not change the size.

    Args:
      seen: views of the object whose sides the image does not cut off.
      prior: of its label.
      yaw: rad.
      center: (2,) m, from depth. sigma: m, its standard error.
    """
    if len(seen.frame) < _OPTIONS.min_views or not len(prior.extents):
        return None
    outward, normal, right, error = _tangents(thinned(seen))
    own = np.stack([np.cos(outward - yaw), np.sin(outward - yaw)], -1)
    error = error[::2, None]
    away = right - normal @ center
    # What depth and the known sizes say: rows of a least-squares problem in (x, y, log a, log b).
    held = np.zeros((4, 4))
    held[0, 0] = held[1, 1] = 1.0 / sigma
    held[2, 2:] = 0.5 / _OPTIONS.size_sigma
    held[3, 2:] = np.array([1.0, -1.0]) / _OPTIONS.ratio_sigma
    best, least = None, np.inf
    for support, extent in zip(supports(prior), prior.extents, strict=True):
        x, shown, off = np.zeros(4), np.zeros((4, 4)), np.zeros_like(away)
        for _ in range(2 * _OPTIONS.rounds):
            reach = _stretched(support, own, x[2:])
            slopes = [(_stretched(support, own, x[2:] + d) - reach) / _OPTIONS.step for d in _OPTIONS.step * np.eye(2)]
            off = _sum_and_difference(normal @ x[:2] + reach - away) / error
            J = np.stack([*(_sum_and_difference(normal[..., k]) / error for k in range(2))], -1)
            J = np.concatenate([J, np.stack([_sum_and_difference(slope) / error for slope in slopes], -1)], -1)
            trust = 1.0 / (1.0 + (off / 2.0) ** 2) ** 2
            shown = np.einsum("nri,nr,nrj->ij", J, trust, J)
            pull = np.einsum("nri,nr->i", J, trust * off)
            change = np.linalg.solve(shown + held.T @ held, -pull - held.T @ (held @ x))
            x = x + np.clip(change, -0.5, 0.5)
        cost = float((off**2 / (1.0 + (off / 2.0) ** 2)).sum() + ((held @ x) ** 2).sum())
        if cost < least:
            alone = shown + np.diag([sigma**-2.0, sigma**-2.0, 1e-6, 1e-6])
            spread = np.sqrt(np.diag(np.linalg.inv(alone))[2:])
            best, least = Sides(center + x[:2], extent[:2] * np.exp(x[2:]), spread), cost
    return best


def _sum_and_difference(pairs: np.ndarray) -> np.ndarray:
    """(n, 2) of the right and left tangents, turned by 45°."""
    return np.stack([pairs[:, 0] + pairs[:, 1], pairs[:, 0] - pairs[:, 1]], -1) / np.sqrt(2.0)


def _stretched(support: np.ndarray, normal: np.ndarray, stretch: np.ndarray) -> np.ndarray:
    """(n, 2) m, support function of an outline, stretched by exp(stretch) along its axes, in the directions of normals
    (n, 2, 2)."""
    u = normal * np.exp(stretch)
    at = np.arctan2(u[..., 1], u[..., 0]) / (2 * np.pi / _OPTIONS.normals)
    before = np.floor(at).astype(int)
    share = at - before
    values = (1.0 - share) * support[before % _OPTIONS.normals] + share * support[(before + 1) % _OPTIONS.normals]
    return np.linalg.norm(u, axis=-1) * values


def _tangents(seen: Bearings) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Tangents of an outline through n viewpoints: outward (n, 2) rad and normal (n, 2, 2), their outward normals at
    the right and the left edge; right (n, 2) m, normal . viewpoint; error (2 n,) m."""
    rim = np.stack([seen.direction - seen.half, seen.direction + seen.half], -1)
    outward = rim + np.array([-np.pi / 2, np.pi / 2])
    normal = np.stack([np.cos(outward), np.sin(outward)], -1)
    error = np.sqrt(
        _OPTIONS.rim_sigma**2 + (_OPTIONS.direction_sigma * seen.reach) ** 2 + (_OPTIONS.width_error * seen.width) ** 2
    )
    return outward, normal, np.einsum("nri,ni->nr", normal, seen.viewpoint), np.repeat(error, 2)
