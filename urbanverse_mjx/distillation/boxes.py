"""Fits the box of an object to all its views: its centre, heading and size."""

import dataclasses

import numpy as np

from ..datatypes import LabelPrior
from ..geometry import rotations
from . import shapes, silhouettes
from .bearings import Bearings

#: rad: coarse search over a quarter turn, and fine search around the best coarse heading.
_COARSE_HEADINGS, _FINE_HEADINGS = np.radians(np.arange(0.0, 90.0, 1.5)), np.radians(np.arange(-1.5, 1.51, 0.15))


@dataclasses.dataclass(frozen=True)
class BoxOptions:
    """Options for fitting the box of an object to its points and to the known sizes of its label.

    Chosen manually; `benchmarks.fidelity` measures their effect (docs/decisions/generation.md).

    Attributes:
      side_ratio: if the known extents differ by more than this factor, they decide which of two sides is the heading.
      shape_blur: depth blur, as a share of the object's footprint, above which its points do not show its shape.
      min_shown_side: m; objects at least this long have usable sides in spite of the blur.
      heading_gain: a heading other than those of the sides is used if its misfit from the known shapes is at most this
        share of theirs.
      max_distance: objects that differ by more (sum of log ratios of the sides) from every known size of their label
        keep the observed size.
      missing_weight: weights of the missing depth, width and height (log) relative to a known size.
      roof_ratio: height of a roof over the height of its edge visible from below.
      side_share: a side is completed if its visible length is less than this share of the known one.
      max_length_ratio: factor by which an object may be longer than every known one of its label.
      direction_points: largest number of points from which a direction is computed.
      grazing_sine: sine of the flattest angle at which a face counts as visible (12°).
      min_side: m, shortest side of a box.
      oblique_misfit_reduction: reduction of the outline misfit that a heading oblique to the surroundings needs; 85 of
        100 objects are within 6° of the surrounding axes.
      center_share: standard error of the middle of an object's visible part, as a share of its longer side.
      max_side_error: relative standard error up to which a side's length comes from the outline and not from the label.
      facade_relief: m, how far the points of a side scatter besides the depth error.
      min_oblique, oblique_errors: a building stands along the street unless its own direction differs by more than
        `min_oblique` rad and by this number of its standard errors.
      inner_points: quantiles of an object's points between which its inner sides lie.
      misfit_floors, cue_weights: of the four cues to which side is the heading (sides of all points and of the inner
        ones, outline, known shapes): what is added to their misfits, and the weights of the logarithms of the ratios.
        A logistic regression over the objects of 12 training streets with true poses and depth, three
        from images alone and four with exact inputs, but for buildings.
      ground_height, ground_share: m and share of an object's height, the lesser of which its footprint leaves out above
        its lowest points, because uncertain masks hold ground.
      outline_share, rim: a point belongs to the object if it lies between the edges, widened by `rim` m, of this share
        of as many views as the points that most views agree on.
      min_body: least share of its points that an object keeps.
      min_outlines: fewest views by whose edges points are left out.
      bins: of the histogram from which the density of points along a direction is computed.
    """

    side_ratio: float = 1.12
    shape_blur: float = 0.04
    min_shown_side: float = 3.0
    heading_gain: float = 0.9
    max_distance: float = 0.5
    missing_weight: tuple[float, float, float] = (0.25, 1.0, 0.25)
    roof_ratio: float = 1.12
    side_share: float = 0.75
    max_length_ratio: float = 1.3
    direction_points: int = 800
    grazing_sine: float = 0.2
    min_side: float = 0.01
    oblique_misfit_reduction: float = 4.0
    bins: int = 128
    center_share: float = 0.1
    max_side_error: float = 0.15
    facade_relief: float = 0.3
    min_oblique: float = np.radians(20.0)
    oblique_errors: float = 4.0
    inner_points: tuple[float, float] = (0.05, 0.95)
    misfit_floors: tuple[float, float, float, float] = (0.1, 0.1, 2.0, 0.01)
    cue_weights: tuple[float, float, float, float] = (1.7, 1.7, 1.9, 2.3)
    ground_height: float = 0.1
    ground_share: float = 0.25
    outline_share: float = 0.75
    rim: float = 0.05
    min_body: float = 0.3
    min_outlines: int = 3


_OPTIONS = BoxOptions()


@dataclasses.dataclass(frozen=True)
class Box:
    """A fitted box: center (3,) m; size (3,) m along the heading, across, up; yaw rad; sigma m of the centre; blur m,
    depth error in its nearest view; completed: which of the three sizes come from the label's prior; seen (3,) m, its
    size without that completion."""

    center: np.ndarray
    size: np.ndarray
    yaw: float
    sigma: float
    blur: float
    completed: tuple[bool, bool, bool]
    seen: np.ndarray


def share_inside(low: np.ndarray, high: np.ndarray, box: Box, blur: float) -> float:
    """Share of a 5 x 5 x 5 grid from `low` to `high` (3,) m that lies within a box enlarged by 0.2 m, `blur` and its
    own blur."""
    grid = np.stack(np.meshgrid(*[np.linspace(0.0, 1.0, 5)] * 3), -1).reshape(-1, 3)
    local = (low + grid * (high - low) - box.center) @ rotations.about_z(-box.yaw).T
    return float((np.abs(local) <= box.size / 2 + 0.2 + blur + box.blur).all(1).mean())


def consensus(points: np.ndarray, viewpoints: np.ndarray, sigma: np.ndarray, noise: float) -> tuple[np.ndarray, float]:
    """Shifts each view of one object along its lines of sight to the position on which all views agree.

    A view's depth has a common relative error (`noise`), while its direction is nearly exact, so a centre seen from
    several positions lies where the lines of sight meet. Information of a view: 1 / sigma^2 along the line, 1 /
    across^2 across it.

    Args:
      points: (v, P, 3) m, world.
      viewpoints: (v, 3) m.
      sigma: (v,) m along the line of sight.
      noise: relative error of depth.

    Returns:
      (v, P, 3) m corrected points, and the standard error (m) of the centre.
    """
    low, high = np.quantile(points, 0.05, axis=1), np.quantile(points, 0.95, axis=1)
    middle = (low + high) / 2
    offset = middle - viewpoints
    reach = np.linalg.norm(offset, axis=1)
    line = offset / reach[:, None]
    # Different viewpoints show different sides, so the centres of views differ by a share of the object's size.
    across = 0.03 + 0.15 * np.linalg.norm(high - low, axis=1)
    along = np.hypot(sigma, across)
    project = line[:, :, None] * line[:, None, :]
    information = project / along[:, None, None] ** 2 + (np.eye(3) - project) / across[:, None, None] ** 2
    center = np.median(middle, axis=0)
    apart = middle - center
    distance = np.zeros(len(points))
    weight = 1.0 / np.maximum(1.0, np.einsum("vi,vij,vj->v", apart, information, apart) / 4.0)
    for _ in range(3):
        total = (weight[:, None, None] * information).sum(0)
        center = np.linalg.solve(total, np.einsum("v,vij,vj->i", weight, information, middle))
        apart = middle - center
        distance = np.sqrt(np.einsum("vi,vij,vj->v", apart, information, apart))
        weight = 1.0 / np.maximum(1.0, distance / 2.0) ** 2  # Huber-like beyond two standard deviations
    total = (weight[:, None, None] * information).sum(0)
    error = float(np.sqrt(np.trace(np.linalg.inv(total)) / 3))
    # Correction of each view's distance along its line, at most three sigma of its noise.
    factor = np.einsum("vi,vi->v", center - viewpoints, line) / reach
    trust = (noise * reach) ** 2 / ((noise * reach) ** 2 + across**2)
    factor = 1.0 + trust * np.clip(factor - 1.0, -3 * noise, 3 * noise)
    kept = np.asarray(distance < 4.0)
    return ((points - viewpoints[:, None]) * factor[:, None, None] + viewpoints[:, None])[
        kept if kept.any() else slice(None)
    ], error


def direction(flat: np.ndarray, blur: float) -> float:
    """rad in [0, π/2), direction of the sides of (n, 2) m points.

    Seen from above, vertical faces are lines, so the points of a face coincide when projected along it. The best
    direction minimises the log area of the rectangle minus the share of pairs of points that fall into one bin of its
    two projections. (Weights and bins were chosen on one capture: 3.0° mean error, 0.4° for buildings; the smallest
    rectangle alone has 6.9° and 6.8°, the closeness criterion of Zhang et al. 2017 5.5° and 4.9°.)

    Args:
      blur: m, how far a face's points scatter.
    """

    def cost(angles: np.ndarray) -> np.ndarray:
        c, s = np.cos(angles)[:, None], np.sin(angles)[:, None]
        projected = (c * flat[:, 0] + s * flat[:, 1], -s * flat[:, 0] + c * flat[:, 1])
        bounds = [np.quantile(p, (0.01, 0.99), axis=1, method="nearest") for p in projected]
        area = np.prod([high - low + _OPTIONS.min_side for low, high in bounds], axis=0)
        width = np.maximum(0.05, 0.02 * np.sqrt(area))[:, None] + blur
        total = 0.5 * np.log(area)
        for p in projected:
            bins = np.minimum(((p - p.min(1, keepdims=True)) / width).astype(np.int64), _OPTIONS.bins - 1)
            rows = np.arange(len(angles))[:, None] * _OPTIONS.bins
            counts = np.bincount((bins + rows).ravel(), minlength=len(angles) * _OPTIONS.bins).reshape(
                -1, _OPTIONS.bins
            )
            total -= 2.0 * ((counts / len(flat)) ** 2).sum(1)
        return total

    best = _COARSE_HEADINGS[np.argmin(cost(_COARSE_HEADINGS))]
    fine = best + _FINE_HEADINGS
    return float(np.remainder(fine[np.argmin(cost(fine))], np.pi / 2))


def fit(
    points: np.ndarray,
    viewpoints: np.ndarray,
    prior: LabelPrior,
    noise: float,
    top: float | None,
    sigma: float,
    seen: Bearings | None = None,
    axis: float | None = None,
    exact: bool = False,
) -> Box:
    """Fits a box to corrected points.

    Args:
      points: (p, 3) m.
      viewpoints: (v, 3) m, camera positions.
      prior: known sizes and shapes of the object's label.
      noise: relative error of depth.
      top: m, height of the object's top if some view shows it; None if every view is cut off there.
      sigma: m, standard error of the centre.
      seen: the object's views that the image's sides do not cut off, in the ground plane; None if there are none.
      axis: rad, direction of the surrounding objects, modulo a quarter turn; None where unknown.
      exact: whether masks and depth are exact; then the sides alone decide which of them is the heading, and all points
        are the object's.
    """
    nearest = float(np.linalg.norm(viewpoints - points.mean(0), axis=1).min())
    blur = noise * nearest
    bottom = np.inf
    if not (exact or prior.faces_road):
        bottom = float(np.quantile(points[:, 2], _trim(noise)))
        points = _body(points, prior, blur, seen)
    footprint = _footprint(points, prior)
    blurred = footprint < _OPTIONS.min_shown_side and blur > _OPTIONS.shape_blur * footprint
    if blurred and axis is not None:
        yaw = axis
    else:
        yaw = direction(points[:: max(1, len(points) // _OPTIONS.direction_points), :2], 0.5 * blur)
        if axis is not None and not (prior.faces_road and _is_oblique(yaw, axis, points, blur)):
            # The side that the points show keeps its middle and its length.
            points = _turned_about_middle(points, _quarter_apart(axis, yaw))
            yaw = axis
    low, high, seen_from = _seen_along(yaw, points, viewpoints, noise, top)
    sides = yaw + np.arange(4) * np.pi / 2
    outlined = None
    if seen is not None and (blurred or not (exact or prior.faces_road)):
        outlined = silhouettes.face(seen if exact else silhouettes.thinned(seen), prior)
    by_outline = outlined is not None and (blurred or axis is not None)
    laid = None
    if prior.shapes and not (exact and by_outline):
        laid = shapes.lay_at(points, prior, sides) if by_outline else shapes.lay(points, prior, sides)
    odds = None if exact else _lengthwise_odds(points, yaw, high - low, prior, outlined, laid)
    quarter = _heading(high - low, (low + high) / 2, seen_from, prior, odds)
    sides = np.roll(sides, -quarter)
    if by_outline and outlined is not None:
        oriented = _outlined(outlined, sides, axis)
    else:
        oriented = _facing(laid, sides, points, blur)
    if oriented is not None:
        yaw, quarter = oriented, 0
        low, high, seen_from = _seen_along(yaw, points, viewpoints, noise, top)
    yaw, low, high, seen_from = _turned(yaw, low, high, seen_from, quarter)
    low[2] = min(low[2], bottom)
    low, high = _bounded(low, high, prior)
    shown = high - low
    outline = None
    if seen is not None and not prior.faces_road and blur > _OPTIONS.shape_blur * footprint:
        turn = rotations.about_z(-yaw)[:2, :2]
        error = float(np.hypot(sigma, _OPTIONS.center_share * shown[:2].max()))
        outline = silhouettes.sides(seen, prior, yaw, (low + high)[:2] / 2 @ turn, error)
        if outline is not None:
            middle = turn @ outline.center
            low[:2], high[:2] = middle - outline.size / 2, middle + outline.size / 2
    low, high, completed = _complete(low, high, seen_from, prior, top is None, outline)
    back = rotations.about_z(-yaw).T
    yaw = float(np.remainder(yaw + np.pi, 2 * np.pi) - np.pi)
    return Box(back @ ((low + high) / 2), high - low, yaw, sigma, blur, completed, shown)


def _trim(noise: float) -> float:
    """Quantile of an object's points that its box leaves out at each end, by the relative error of depth."""
    return min(0.002 + 0.4 * noise, 0.03)


def _body(points: np.ndarray, prior: LabelPrior, blur: float, seen: Bearings | None) -> np.ndarray:
    """(k, 3) m, the points of an object without the ground and the surroundings that its masks hold.

    The ground around an object continues its depth, so that no gap separates them. What one view shows past the
    object's edge is beside the object in views from other directions.
    """
    keep = np.ones(len(points), bool)
    if prior.on_ground:
        low, high = np.quantile(points[:, 2], (0.02, 0.98))
        above = points[:, 2] > low + min(_OPTIONS.ground_height, _OPTIONS.ground_share * (high - low))
        if above.mean() >= _OPTIONS.min_body:
            keep = above
    if seen is not None and len(seen.frame) >= _OPTIONS.min_outlines:
        views = silhouettes.thinned(seen)
        away = points[None, :, :2] - views.viewpoint[:, None]
        turn = np.arctan2(away[..., 1], away[..., 0]) - views.direction[:, None]
        off = np.abs(rotations.wrapped(turn))
        share = (off <= views.half[:, None] + (_OPTIONS.rim + blur) / views.reach[:, None]).mean(0)
        between = keep & (share >= _OPTIONS.outline_share * np.quantile(share, 0.9))
        if between.mean() >= _OPTIONS.min_body:
            keep = between
    return points[keep]


def _seen_along(
    yaw: float, points: np.ndarray, viewpoints: np.ndarray, noise: float, top: float | None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(3,) and (3,) m, the lower and upper bounds of the points along a heading, across it and up; (v, 3) m, the
    viewpoints in these axes."""
    turn = rotations.about_z(-yaw)
    local = points @ turn.T
    trim = _trim(noise)
    low, high = np.quantile(local, (trim, 1 - trim), axis=0)
    high[2] = max(high[2], low[2] if top is None else top)
    return low, np.maximum(high, low + _OPTIONS.min_side), viewpoints @ turn.T


def _footprint(points: np.ndarray, prior: LabelPrior) -> float:
    """m, the longer side of an object's footprint, at most that of the largest known object, because blur spreads the
    points."""
    known = float(prior.extents[:, :2].max()) if len(prior.extents) else np.inf
    return min(known, float(np.ptp(points[:, :2], axis=0).max()))


def _facing(laid: shapes.Laid | None, sides: np.ndarray, points: np.ndarray, blur: float) -> float | None:
    """rad, the heading at which the points fit the known shapes best; None if the shapes do not determine it.

    Args:
      laid: the points on the known shapes; None if the label has none.
      sides: (4,) rad, normals of the sides, beginning with the assumed front. Visible sides are accurate, so another
        direction has to fit much better than theirs, and another front much better than the first.
    """
    if laid is None or blur > _OPTIONS.shape_blur * np.ptp(points[:, :2], axis=0).max():
        return None
    along = np.array([laid.at(side) for side in sides])
    if laid.misfit.min() >= _OPTIONS.heading_gain * along[0]:
        return None
    return float(sides[along.argmin()]) if laid.misfit.min() >= _OPTIONS.heading_gain * along.min() else laid.best


def _outlined(fit: silhouettes.Fit, sides: np.ndarray, axis: float | None) -> float | None:
    """rad, the heading at which the outline's edges fit best; None if they do not determine it.

    Alignment with or square to the surroundings is more likely than any other angle; they decide the front only if it
    is unambiguous.
    """
    best, least = fit.best, float(fit.misfit.min())
    if axis is not None:
        if fit.at(sides[0]) < least + _OPTIONS.oblique_misfit_reduction:
            best = float(sides[0])
    elif not fit.clear:
        return None
    if fit.tells_front(best) or np.cos(best - sides[0]) >= -1e-6:
        return best
    return best + np.pi


def _turned(yaw: float, low: np.ndarray, high: np.ndarray, viewpoints: np.ndarray, quarter: int) -> tuple:
    """Rotates the axes of a box by a number of quarter turns."""
    for _ in range(quarter):
        # The new x is the old y, the new y the old -x.
        low, high = np.array([low[1], -high[0], low[2]]), np.array([high[1], -low[0], high[2]])
        viewpoints = np.stack([viewpoints[:, 1], -viewpoints[:, 0], viewpoints[:, 2]], -1)
        yaw += np.pi / 2
    return yaw, low, high, viewpoints


def heading_error(size: np.ndarray, blur: float) -> float:
    """rad, standard error of the heading of a box: its longer side, whose points scatter by the depth error and by what
    juts out of a facade, is turned by their ratio."""
    return (_OPTIONS.facade_relief + blur) / float(size[:2].max())


def _quarter_apart(a: float, b: float) -> float:
    """rad, direction a minus direction b, modulo a quarter turn."""
    return (a - b + np.pi / 4) % (np.pi / 2) - np.pi / 4


def _turned_about_middle(points: np.ndarray, angle: float) -> np.ndarray:
    """(p, 3) m, points turned about the vertical through their median."""
    middle = np.append(np.median(points[:, :2], axis=0), 0.0)
    return (points - middle) @ rotations.about_z(angle).T + middle


def _is_oblique(own: float, axis: float, points: np.ndarray, blur: float) -> bool:
    """Whether the direction of a building's points contradicts that of the street by more than its error."""
    seen = np.ptp(np.quantile(points @ rotations.about_z(-own).T, (0.02, 0.98), axis=0), axis=0)
    return abs(_quarter_apart(own, axis)) > max(
        _OPTIONS.min_oblique, _OPTIONS.oblique_errors * heading_error(seen, blur)
    )


def _lengthwise_odds(
    points: np.ndarray,
    yaw: float,
    size: np.ndarray,
    prior: LabelPrior,
    outlined: silhouettes.Fit | None,
    laid: shapes.Laid | None,
) -> float | None:
    """Log odds that an object's heading is along `yaw` and not across it; None for houses and labels without known
    sizes.

    The sides of all points and of all but the outermost, the outline's edges and the points on the known shapes each
    have a misfit at both headings. The logarithm of their ratio counts: where neither fits (masks hold parts of the
    ground and of neighbours), a cue says little.
    """
    if prior.faces_road or not len(prior.extents):
        return None
    low, high = np.quantile(points[:, :2] @ rotations.about_z(-yaw)[:2, :2].T, _OPTIONS.inner_points, axis=0)
    inner = np.append(np.maximum(high - low, _OPTIONS.min_side), size[2])
    yaws = yaw + np.array([0.0, np.pi / 2])
    misfits = [[misfit(s[[0, 1, 2]], prior), misfit(s[[1, 0, 2]], prior)] for s in (size, inner)]
    misfits.append([1.0, 1.0] if outlined is None else [min(outlined.at(a), outlined.at(a + np.pi)) for a in yaws])
    misfits.append([1.0, 1.0] if laid is None else [min(laid.at(a), laid.at(a + np.pi)) for a in yaws])
    along, across = np.array(misfits).T + np.array(_OPTIONS.misfit_floors)
    return float(np.array(_OPTIONS.cue_weights) @ np.log(across / along))


def _heading(
    size: np.ndarray, middle: np.ndarray, viewpoints: np.ndarray, prior: LabelPrior, odds: float | None
) -> int:
    """Quarter turns from the box's first axis to the object's heading.

    The odds, for houses the known sizes, select the axis; where both fit, and for the sign of the axis, the visible
    side decides: captures pass fronts of houses, signs and benches.
    """
    towards = (viewpoints - middle)[:, :2]
    near = 1.0 / np.maximum(np.linalg.norm(towards, axis=1), 1.0) ** 2
    towards = (towards * near[:, None]).sum(0)
    facing = [towards[0], towards[1], -towards[0], -towards[1]]
    axis = int(np.argmax(np.abs(towards)))
    if odds is not None:
        axis = 0 if odds > 0 else 1 if odds < 0 else axis
    elif len(prior.extents):
        known = _front_misfit if prior.faces_road else misfit
        fits = [known(size[[0, 1, 2]], prior), known(size[[1, 0, 2]], prior)]
        if abs(fits[0] - fits[1]) > np.log(_OPTIONS.side_ratio):
            axis = int(np.argmin(fits))
    return axis if facing[axis] >= 0 else axis + 2


def misfit(size: np.ndarray, prior: LabelPrior) -> float:
    """Sum of the log ratios to the nearest known size; a hidden part makes the observed side shorter, hardly ever
    longer."""
    ratio = np.log(prior.extents / size)
    return float(np.where(ratio > 0, 0.7 * ratio, -1.3 * ratio).sum(1).min())


def _front_misfit(size: np.ndarray, prior: LabelPrior) -> float:
    """`misfit` of objects that the camera passes at their front: the front is fully visible, the depth behind it hardly
    ever."""
    ratio = np.log(prior.extents / size)
    return float(np.where(ratio > 0, ratio * _OPTIONS.missing_weight, -1.3 * ratio).sum(1).min())


def _bounded(low: np.ndarray, high: np.ndarray, prior: LabelPrior) -> tuple[np.ndarray, np.ndarray]:
    """Limits the sides to little more than the longest known ones, because blurred depth and too large masks lengthen
    boxes. The lower end stays."""
    if not len(prior.extents):
        return low, high
    excess = np.maximum(high - low - _OPTIONS.max_length_ratio * prior.extents.max(0), 0.0)
    return low + excess * [0.5, 0.5, 0.0], high - excess * [0.5, 0.5, 1.0]


def _complete(
    low: np.ndarray,
    high: np.ndarray,
    viewpoints: np.ndarray,
    prior: LabelPrior,
    topless: bool,
    outline: silhouettes.Sides | None = None,
) -> tuple[np.ndarray, np.ndarray, tuple[bool, bool, bool]]:
    """Moves the ends that no view could show outwards to the nearest known size of the label.

    The measured face is the one most visible to the cameras. The far end behind it is hidden unless a camera faced it
    too; the top is hidden if every view was cut off there, or no camera was above it (set-back parts of a roof are
    invisible from the street; such a top rises by `roof_ratio` at most). The other sides select the known size; a
    hidden side may be longer than its visible part, not shorter.

    Args:
      low, high: (3,) m along the heading, across and up, like viewpoints (v, 3).
      topless: whether every view is cut off at the top.
      outline: the footprint by the object's outline, if the sides are its; they stay.
    """
    size = high - low
    offset = viewpoints[:, :2] - ((low + high) / 2)[:2]
    away = np.linalg.norm(offset, axis=1)
    towards = (offset / np.maximum(away, 1.0)[:, None] ** 3).sum(0)
    front = int(np.argmax(np.abs(towards)))
    hidden = np.array([False, False, topless or viewpoints[:, 2].max() < high[2]])
    for axis in (0, 1):
        beyond = low[axis] - viewpoints[:, axis] if towards[axis] > 0 else viewpoints[:, axis] - high[axis]
        hidden[axis] = not (beyond > _OPTIONS.grazing_sine * away).any()
    hidden[:2] &= outline is None
    from_label = np.append([False] * 2 if outline is None else outline.error > _OPTIONS.max_side_error, False)
    if not (len(prior.extents) and hidden.any()):
        return low, high, _flags(from_label)
    ratio = np.log(prior.extents / size)
    hope = np.where(hidden, [0.25, 0.25, 0.05 if topless else 1.0], 1.0)
    lack = np.where(ratio < 0, -1.5 * ratio, ratio * hope)
    best = int(np.argmin(lack.sum(1)))
    known = prior.extents[best]
    longer = hidden & (known > size)
    if lack[best, ~hidden | [False, False, not topless]].sum() > _OPTIONS.max_distance:
        # The size matches no known one, or the box holds several objects; the depth of a house is completed
        # nevertheless.
        if not prior.faces_road:
            return low, high, _flags(from_label)
        known = np.median(prior.extents, axis=0)
        longer = (np.arange(3) == front) & hidden & (known > size)
    # Along the visible face only a large missing length indicates a hidden end.
    longer[1 - front] &= size[1 - front] < _OPTIONS.side_share * known[1 - front]
    if not topless and known[2] > _OPTIONS.roof_ratio * size[2]:
        longer[2] = False
    grow = np.where(longer, known - size, 0.0)
    away_from = np.append(towards > 0, False)
    low, high = low - np.where(away_from, grow, 0.0), high + np.where(away_from, 0.0, grow)
    return low, high, _flags((grow > 0.02 * size) | from_label)


def _flags(values: np.ndarray) -> tuple[bool, bool, bool]:
    x, y, z = values.tolist()
    return x, y, z
