"""The box of a thing from all its views: where lines of sight meet, which way its sides run, how far they reach."""

import dataclasses

import numpy as np

from ..datatypes import LabelPrior

#: Views used for one box, the nearest first; more add nothing but time.
MAX_VIEWS = 24
_COARSE, _FINE = np.radians(np.arange(0.0, 90.0, 1.5)), np.radians(np.arange(-1.5, 1.51, 0.15))
#: Extents farther apart than this factor settle which of two sides is the heading.
_CLEAR = 1.12
#: An unseen side shorter than this share of what is known of the label is completed.
_SHORT = 0.7
_MIN_SIDE = 0.01  # m
_BINS = 128
#: Points that a direction is taken from.
_FLAT_POINTS = 800
#: Sine of the flattest angle at which a face is looked at rather than along (12°).
_GRAZING = 0.2


@dataclasses.dataclass(frozen=True)
class Box:
    """center (3,), size (3,) m along the heading, across, up; yaw rad; sigma m of the centre; blur m, error of the
    depth in its nearest view; completed: which of the three sizes were taken from what is known of the label."""

    center: np.ndarray
    size: np.ndarray
    yaw: float
    sigma: float
    blur: float
    completed: tuple[bool, bool, bool]


def consensus(points: np.ndarray, eyes: np.ndarray, sigma: np.ndarray, noise: float) -> tuple[np.ndarray, float]:
    """Views of one thing, each shifted along its lines of sight to where all views together put the thing.

    A view's depth is off by a common factor (`noise`), its direction hardly: so a centre seen from several places is
    where the lines of sight meet. Information of a view: 1 / sigma^2 along the line, 1 / across^2 across it.

    Args:
      points: (v, P, 3) m, world. eyes: (v, 3) m. sigma: (v,) m along the line of sight.
      noise: relative error of depth.

    Returns:
      (v, P, 3) m corrected points, and the standard error (m) of the centre.
    """
    low, high = np.quantile(points, 0.05, axis=1), np.quantile(points, 0.95, axis=1)
    middle = (low + high) / 2
    offset = middle - eyes
    reach = np.linalg.norm(offset, axis=1)
    line = offset / reach[:, None]
    # Different sides are seen from different places: the middles of views differ by a share of the thing's size.
    across = 0.03 + 0.15 * np.linalg.norm(high - low, axis=1)
    along = np.hypot(sigma, across)
    project = line[:, :, None] * line[:, None, :]
    information = project / along[:, None, None] ** 2 + (np.eye(3) - project) / across[:, None, None] ** 2
    weight = np.ones(len(points))
    center = middle[0]
    for _ in range(3):
        total = (weight[:, None, None] * information).sum(0)
        center = np.linalg.solve(total, np.einsum("v,vij,vj->i", weight, information, middle))
        apart = middle - center
        distance = np.sqrt(np.einsum("vi,vij,vj->v", apart, information, apart))
        weight = 1.0 / np.maximum(1.0, distance / 2.0) ** 2  # Huber-like beyond two standard deviations
    total = (weight[:, None, None] * information).sum(0)
    error = float(np.sqrt(np.trace(np.linalg.inv(total)) / 3))
    # How far along its line each view should have been; at most three sigma of its noise.
    factor = np.einsum("vi,vi->v", center - eyes, line) / reach
    trust = (noise * reach) ** 2 / ((noise * reach) ** 2 + across**2)
    factor = 1.0 + trust * np.clip(factor - 1.0, -3 * noise, 3 * noise)
    kept = distance < 4.0
    return ((points - eyes[:, None]) * factor[:, None, None] + eyes[:, None])[
        kept if kept.any() else slice(None)
    ], error


def direction(flat: np.ndarray, blur: float) -> float:
    """rad in [0, π/2): along which the sides of (n, 2) m points run.

    Upright faces are lines from above: projected along them their points fall on one spot. So the best direction has
    the least log area of the rectangle, less what share of pairs of points fall into one bin of its two projections.
    (Weights and bins were chosen on one tour: 3.0° mean error, 0.4° for buildings; the least rectangle alone has 6.9°
    and 6.8°, the closeness criterion of Zhang et al. 2017 5.5° and 4.9°.)

    Args:
      blur: m, how far a face's points scatter.
    """

    def cost(angles: np.ndarray) -> np.ndarray:
        c, s = np.cos(angles)[:, None], np.sin(angles)[:, None]
        projected = (c * flat[:, 0] + s * flat[:, 1], -s * flat[:, 0] + c * flat[:, 1])
        bounds = [np.quantile(p, (0.01, 0.99), axis=1, method="nearest") for p in projected]
        area = np.prod([high - low + _MIN_SIDE for low, high in bounds], axis=0)
        width = np.maximum(0.05, 0.02 * np.sqrt(area))[:, None] + blur
        total = 0.5 * np.log(area)
        for p in projected:
            bins = np.minimum(((p - p.min(1, keepdims=True)) / width).astype(np.int64), _BINS - 1)
            rows = np.arange(len(angles))[:, None] * _BINS
            counts = np.bincount((bins + rows).ravel(), minlength=len(angles) * _BINS).reshape(-1, _BINS)
            total -= 2.0 * ((counts / len(flat)) ** 2).sum(1)
        return total

    best = _COARSE[np.argmin(cost(_COARSE))]
    fine = best + _FINE
    return float(np.remainder(fine[np.argmin(cost(fine))], np.pi / 2))


def fit(points: np.ndarray, eyes: np.ndarray, prior: LabelPrior, noise: float, top: float | None, sigma: float) -> Box:
    """The box around corrected points.

    Args:
      points: (p, 3) m. eyes: (v, 3) m, from where it was seen. prior: of its label.
      noise: relative error of depth.
      top: m, height of its top where some view was not cut off there; None hides the top.
      sigma: m, standard error of the centre.
    """
    nearest = float(np.linalg.norm(eyes - points.mean(0), axis=1).min())
    blur = noise * nearest
    yaw = direction(points[:: max(1, len(points) // _FLAT_POINTS), :2], 0.5 * blur)
    c, s = np.cos(yaw), np.sin(yaw)
    turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])  # world to box axes
    local, seen_from = points @ turn.T, eyes @ turn.T
    trim = min(0.002 + 0.4 * noise, 0.03)
    low, high = np.quantile(local, (trim, 1 - trim), axis=0)
    high[2] = max(high[2], low[2] if top is None else top)
    high = np.maximum(high, low + _MIN_SIDE)
    quarter = _heading(high - low, (low + high) / 2, seen_from, prior)
    yaw, low, high, seen_from = _turned(yaw, low, high, seen_from, quarter)
    low, high, completed = _complete(low, high, seen_from, prior, top is None)
    c, s = np.cos(yaw), np.sin(yaw)
    back = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    yaw = float(np.remainder(yaw + np.pi, 2 * np.pi) - np.pi)
    return Box(back @ ((low + high) / 2), high - low, yaw, sigma, blur, completed)


def _turned(yaw: float, low: np.ndarray, high: np.ndarray, eyes: np.ndarray, quarter: int) -> tuple:
    """The same box with its axes turned by quarters."""
    for _ in range(quarter):
        # The new x is the old y, the new y the old -x.
        low, high = np.array([low[1], -high[0], low[2]]), np.array([high[1], -low[0], high[2]])
        eyes = np.stack([eyes[:, 1], -eyes[:, 0], eyes[:, 2]], -1)
        yaw += np.pi / 2
    return yaw, low, high, eyes


def _heading(size: np.ndarray, middle: np.ndarray, eyes: np.ndarray, prior: LabelPrior) -> int:
    """Quarter turns from the box's first axis to the thing's heading.

    Known sizes say which axis it is; where both fit, and for the end of the axis, the side that was looked at: fronts
    of houses, signs and benches are what one walks past.
    """
    towards = (eyes - middle)[:, :2]
    near = 1.0 / np.maximum(np.linalg.norm(towards, axis=1), 1.0) ** 2
    towards = (towards * near[:, None]).sum(0)
    facing = [towards[0], towards[1], -towards[0], -towards[1]]
    axis = int(np.argmax(np.abs(towards)))
    if len(prior.extents):
        misfit = [_misfit(size[[0, 1, 2]], prior), _misfit(size[[1, 0, 2]], prior)]
        if abs(misfit[0] - misfit[1]) > np.log(_CLEAR):
            axis = int(np.argmin(misfit))
    return axis if facing[axis] >= 0 else axis + 2


def _misfit(size: np.ndarray, prior: LabelPrior) -> float:
    """Sum of the log ratios to the nearest known size; an unseen part makes a side shorter, hardly ever longer."""
    ratio = np.log(prior.extents / size)
    return float(np.where(ratio > 0, 0.7 * ratio, -1.3 * ratio).sum(1).min())


def _complete(
    low: np.ndarray, high: np.ndarray, eyes: np.ndarray, prior: LabelPrior, topless: bool
) -> tuple[np.ndarray, np.ndarray, tuple[bool, bool, bool]]:
    """Sides that no view could show, as long as those of the nearest known size.

    A side is completed only if no camera ever stood beyond its far end (or every view was cut off there), and what was
    seen of it is clearly shorter than anything of this label that fits the sides that were seen.
    """
    completed = [False, False, False]
    size = high - low
    hidden = np.zeros((3, 2), bool)  # the low and high end of each axis
    for axis in (0, 1):
        away = np.linalg.norm(eyes[:, :2] - ((low + high) / 2)[:2], axis=1)
        hidden[axis, 0] = not (low[axis] - eyes[:, axis] > _GRAZING * away).any()
        hidden[axis, 1] = not (eyes[:, axis] - high[axis] > _GRAZING * away).any()
    hidden[2, 1] = topless
    open_axes = hidden.any(1)
    if not len(prior.extents) or not open_axes.any():
        return low, high, (False, False, False)
    trusted = ~open_axes
    if not trusted.any():
        trusted[1] = True
    ratio = np.abs(np.log(prior.extents / size))
    known = prior.extents[np.argmin(ratio[:, trusted].sum(1) + 0.05 * ratio[:, ~trusted].sum(1))]
    low, high = low.copy(), high.copy()
    for axis in np.flatnonzero(open_axes):
        if size[axis] < _SHORT * known[axis]:
            completed[axis] = True
            missing = known[axis] - size[axis]
            ends = hidden[axis] / hidden[axis].sum()
            low[axis] -= missing * ends[0]
            high[axis] += missing * ends[1]
    return low, high, (completed[0], completed[1], completed[2])
