"""Joint adjustment of poses and object positions from the directions in which frames see the objects.

If odometry turns slightly too far with every step, the lines of sight to one object do not intersect. The adjustment
therefore solves for poses (shifts and turns at control points, see `control_points`) and object positions together and
minimises the errors of every view's direction and distance: a bundle adjustment (Triggs et al., "Bundle Adjustment - A
Modern Synthesis", 2000) whose points are whole objects. The visible surface is nearer to the camera than the object's
centre; this offset is estimated for each object, because ignoring it would shrink the path. Outliers (views of another
object, half-hidden objects) are down-weighted as in `drift`.
"""

import dataclasses

import numpy as np

from ..geometry import rotations
from . import control_points
from .depth_scale import DepthScale
from .fusion import MIN_POSITION_ERROR, world_points
from .lifting import Views


@dataclasses.dataclass(frozen=True)
class BearingOptions:
    """Weights of directions and distances of views, and the condition for adjusting poses.

    Chosen manually; `benchmarks.fidelity` measures their effect (docs/decisions/generation.md).

    Attributes:
      max_size: m; larger objects are not used, because their apparent centre depends on the visible side.
      min_views: fewest views of an object that is used to adjust poses.
      min_objects: fewest such objects.
      middle_error: error of a view's centre relative to the object's centre, as a share of the view's width.
      direction_sigma: rad, standard error of a direction.
      front_share: distance from the visible surface to the object's centre as a share of the view's width, and its
        standard error.
      gates: residual, in standard errors, above which a view is down-weighted; one for each round.
      round_steps: Gauss-Newton steps of each round.
      max_misfit_ratio: the adjusted poses are used only if the median squared misfit of directions falls below this
        share of its former value.
      loose_noise: relative noise of depth large enough that depth hardly constrains a position.
      min_depth_views: fewest views to locate an object by directions.
      max_place_error: positions from directions with at most this error, as a share of the distance, are used to
        estimate the depth error.
      min_judging_views: fewest views of such objects for an estimate of the depth error.
      min_depth_error: relative; distances differ by less even with perfect depth (0.8 % measured).
      depth_share: share of the difference of distances that is due to depth. With an injected depth error of 5 % and
        drifting poses the difference measures 8.8 %; the estimate from the ground is 4.2 %.
    """

    max_size: float = 2.5
    min_views: int = 8
    min_objects: int = 8
    middle_error: float = 0.15
    direction_sigma: float = np.radians(0.3)
    front_share: float = 0.3
    gates: tuple[float, ...] = (6.0, 6.0, 4.0, 3.0, 3.0, 3.0)
    round_steps: int = 2
    max_misfit_ratio: float = 0.7
    loose_noise: float = 0.3
    min_depth_views: int = 4
    max_place_error: float = 0.03
    min_judging_views: int = 30
    min_depth_error: float = 0.02
    depth_share: float = 0.45


_OPTIONS = BearingOptions()


@dataclasses.dataclass(frozen=True)
class Bearings:
    """Directions from views to objects, in the ground plane: frame (n,), viewpoint (n, 2) m, direction (n,) rad in the
    world, half (n,) rad, half the visible width; reach (n,) m from the viewpoint to its centre."""

    frame: np.ndarray
    viewpoint: np.ndarray
    direction: np.ndarray
    half: np.ndarray
    reach: np.ndarray

    def of(self, rows: np.ndarray) -> "Bearings":
        return Bearings(*(getattr(self, f.name)[rows] for f in dataclasses.fields(self)))

    @property
    def width(self) -> np.ndarray:
        """(n,) m, visible width of each view at its distance."""
        return 2.0 * self.half * self.reach


def measure(views: Views, poses: np.ndarray, scale: np.ndarray, pixel: float | None = None) -> Bearings:
    """Projects the views to the ground plane; depth affects `reach` only.

    Args:
      pixel: rad, width of a pixel. With it, a view is as wide as its outermost points and the halves of their pixels;
        without, the outermost point on either side is left out, as it may be an outlier.
    """
    skipped, rim = (1, 0.0) if pixel is None else (0, pixel / 2)
    n = len(views)
    direction, half, reach = np.zeros(n), np.zeros(n), np.zeros(n)
    for start in range(0, n, 512):
        rows = slice(start, start + 512)
        away = (world_points(views, poses, scale, rows) - poses[views.frame[rows], None, :3, 3])[..., :2]
        middle = away.mean(1)
        base = np.arctan2(middle[:, 1], middle[:, 0])
        turn = np.sort(rotations.wrapped(np.arctan2(away[..., 1], away[..., 0]) - base[:, None]), axis=1)
        low, high = turn[:, skipped] - rim, turn[:, -1 - skipped] + rim
        direction[rows], half[rows] = base + (low + high) / 2, (high - low) / 2
        reach[rows] = np.median(np.linalg.norm(away, axis=-1), axis=1)
    return Bearings(views.frame, poses[views.frame, :2, 3], direction, half, np.maximum(reach, 0.5))


def adjust(views: Views, object_of_view: np.ndarray, poses: np.ndarray, depth: DepthScale) -> np.ndarray | None:
    """(m, 4, 4) adjusted poses, or None if the adjustment does not improve the agreement of the views.

    Args:
      views: of the trajectory. object: (n,) of each view.
      poses: (m, 4, 4) T_world_camera.
      depth: each frame's scale, and the noise that remains.
    """
    problem = _whole_objects(views, object_of_view, poses, depth, _OPTIONS.min_views)
    if problem is None:
        return None
    still, moved = problem.solve(free=False), problem.solve(free=True)
    if moved.misfit > _OPTIONS.max_misfit_ratio * still.misfit:
        return None
    return control_points.corrected(poses, problem.at @ moved.correction)


def depth_error(views: Views, object_of_view: np.ndarray, poses: np.ndarray, scale: np.ndarray) -> float:
    """The relative error of the depth of objects, or 0 if too few objects are seen from several positions.

    The estimate from the ground (`depth_scale`) holds for objects only if the depth of both has the same source, not if
    a network predicts one and geometry gives the other. This function therefore locates objects by directions alone and
    compares the distances with the depth.
    """
    problem = _whole_objects(
        views, object_of_view, poses, DepthScale(scale, _OPTIONS.loose_noise), _OPTIONS.min_depth_views
    )
    if problem is None:
        return 0.0
    solved, seen, which = problem.solve(free=False), problem.seen, problem.which
    away = solved.objects[which, :2] - seen.viewpoint
    far = np.linalg.norm(away, axis=1)
    unit = away / far[:, None]
    spread = np.sqrt(np.einsum("ni,nij,nj->n", unit, np.linalg.inv(solved.information)[which, :2, :2], unit))
    settled = spread < _OPTIONS.max_place_error * far
    if settled.sum() < _OPTIONS.min_judging_views:
        return 0.0
    ratio = np.maximum(far - solved.objects[which, 2], 0.1) / seen.reach
    error = 1.4826 * float(np.median(np.abs(np.log(ratio[settled]))))
    return _OPTIONS.depth_share * error if error > _OPTIONS.min_depth_error else 0.0


def _whole_objects(
    views: Views, object_of_view: np.ndarray, poses: np.ndarray, depth: DepthScale, least: int
) -> "_Problem | None":
    """Views of small, fully visible objects that have at least `least` views each; None if there are too few."""
    seen = measure(views, poses, depth.scale)
    whole = ~views.clipped[:, :2].any(1) & (seen.width < _OPTIONS.max_size)
    counts = np.bincount(object_of_view[whole], minlength=int(object_of_view.max(initial=-1)) + 1)
    rows = np.flatnonzero(whole & (counts[object_of_view] >= least))
    _, which = np.unique(object_of_view[rows], return_inverse=True)
    if not len(rows) or which.max() + 1 < _OPTIONS.min_objects:
        return None
    return _Problem(seen.of(rows), which, poses, depth.noise)


@dataclasses.dataclass(frozen=True)
class _Solution:
    """correction (k, 4) m and rad at the control points; misfit: median squared one of directions, in standard errors;
    objects (t, 3) and their information (t, 3, 3), see `_Problem`."""

    correction: np.ndarray
    misfit: float
    objects: np.ndarray
    information: np.ndarray


class _Problem:
    """The least-squares problem, solved by Gauss-Newton with Geman-McClure weights; objects are eliminated by the Schur
    complement. Unknowns are the correction at the control points and, for every object, its position (x, y) and its
    extent behind the visible surface (m)."""

    def __init__(self, seen: Bearings, which: np.ndarray, poses: np.ndarray, noise: float) -> None:
        self.seen, self.which, self.poses = seen, which, poses
        self.at = control_points.weights(len(poses))
        self.blend = self.at[seen.frame]
        # A view depends on two control points only, however many there are.
        before, share = control_points.between(len(poses))
        self.before, self.shares = before[seen.frame], np.stack([1.0 - share, share], -1)[seen.frame]
        self.across = np.hypot(
            _OPTIONS.direction_sigma, (MIN_POSITION_ERROR + _OPTIONS.middle_error * seen.width) / seen.reach
        )
        self.along = noise * seen.reach + MIN_POSITION_ERROR
        self.behind = _OPTIONS.front_share * np.bincount(which, seen.width) / np.bincount(which)
        self.held = 1.0 / (MIN_POSITION_ERROR + self.behind) ** 2

    def solve(self, free: bool) -> _Solution:
        """Solves for the objects with fixed poses, or for poses too where `free`."""
        objects, correction = self._start(), np.zeros((self.at.shape[1], 4))
        misfit, H = np.zeros((len(self.which), 2)), np.zeros((len(objects), 3, 3))
        for gate in np.repeat(_OPTIONS.gates, _OPTIONS.round_steps):
            misfit, slope, bend = self._linear(objects, correction)
            trust = 1.0 / (1.0 + (misfit / gate) ** 2) ** 2
            H = self._summed(np.einsum("nri,nr,nrj->nij", slope, trust, slope))
            H += np.diag([1e-6, 1e-6, 0.0])
            H[:, 2, 2] += self.held
            g = -self._summed(np.einsum("nri,nr->ni", slope, trust * misfit))
            g[:, 2] += self.held * (self.behind - objects[:, 2])
            if free:
                step = self._control_points(misfit, slope, bend, trust, H, g, correction)
                correction = correction + step
                g -= self._summed(np.einsum("nri,nr,nrj,nj->ni", slope, trust, bend, self.blend @ step, optimize=True))
            objects = objects + np.linalg.solve(H, g[..., None])[..., 0]
        return _Solution(correction, float(np.median(misfit[:, 0] ** 2)), objects, H)

    def _start(self) -> np.ndarray:
        """(t, 3) initial positions of the objects: weighted means of their views, with more weight for near views."""
        seen = self.seen
        place = seen.viewpoint + seen.reach[:, None] * np.stack([np.cos(seen.direction), np.sin(seen.direction)], -1)
        weight = 1.0 / seen.reach**2
        total = np.bincount(self.which, weight)
        middle = [np.bincount(self.which, weight * place[:, k]) / total for k in range(2)]
        return np.stack([*middle, self.behind], -1)

    def _linear(self, objects: np.ndarray, correction: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(n, 2) misfits of direction and distance in standard errors, and their slopes: (n, 2, 3) over the object,
        (n, 2, 4) over the correction of the view's pose."""
        change = self.blend @ correction
        away = objects[self.which, :2] - self.seen.viewpoint - change[:, :2]
        far = np.maximum(np.linalg.norm(away, axis=1), 0.3)
        unit = away / far[:, None]
        side = np.stack([-unit[:, 1], unit[:, 0]], -1)
        turn = rotations.wrapped(np.arctan2(away[:, 1], away[:, 0]) - self.seen.direction - change[:, 3])
        misfit = np.stack([turn / self.across, (far - objects[self.which, 2] - self.seen.reach) / self.along], -1)
        slope, bend = np.zeros((len(far), 2, 3)), np.zeros((len(far), 2, 4))
        slope[:, 0, :2] = side / (far * self.across)[:, None]
        slope[:, 1, :2] = unit / self.along[:, None]
        slope[:, 1, 2] = -1.0 / self.along
        bend[:, :, :2] = -slope[:, :, :2]
        bend[:, 0, 3] = -1.0 / self.across
        return misfit, slope, bend

    def _summed(self, values: np.ndarray) -> np.ndarray:
        """(t, ...) sums of (n, ...) over the views of each object."""
        flat = values.reshape(len(values), -1)
        return np.stack([np.bincount(self.which, column) for column in flat.T], -1).reshape(-1, *values.shape[1:])

    def _control_points(
        self,
        misfit: np.ndarray,
        slope: np.ndarray,
        bend: np.ndarray,
        trust: np.ndarray,
        H: np.ndarray,
        g: np.ndarray,
        correction: np.ndarray,
    ) -> np.ndarray:
        """(k, 4) Gauss-Newton step of the control points."""
        count = len(correction)
        own = np.einsum("nri,nr,nrj->nij", bend, trust, bend)
        mixed = np.einsum("nri,nr,nrj->nij", bend, trust, slope)
        pull = -np.einsum("nri,nr->ni", bend, trust * misfit)
        normal, right = np.zeros((count, count, 4, 4)), np.zeros((count, 4))
        cross = np.zeros((len(H), count, 4, 3))
        for a in (0, 1):
            at, share = self.before + a, self.shares[:, a, None, None]
            np.add.at(right, at, share[..., 0] * pull)
            np.add.at(cross, (self.which, at), share * mixed)
            for b in (0, 1):
                np.add.at(normal, (at, self.before + b), share * self.shares[:, b, None, None] * own)
        normal = normal.transpose(0, 2, 1, 3).reshape(4 * count, 4 * count)
        right, cross = right.ravel(), cross.reshape(len(H), 4 * count, 3)
        normal -= np.einsum("tai,tij,tbj->ab", cross, np.linalg.inv(H), cross, optimize=True)
        right -= np.einsum("tai,ti->a", cross, np.linalg.solve(H, g[..., None])[..., 0], optimize=True)
        for block, value in (
            control_points.odometry(correction, self.at, self.poses),
            control_points.anchor(correction),
        ):
            normal += block.T @ block
            right += block.T @ value
        return np.linalg.solve(normal, right).reshape(count, 4)
