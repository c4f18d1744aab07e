"""Computes label, confidence and box of each object from its views."""

import dataclasses
import functools
from collections.abc import Callable, Sequence

import numpy as np

from ..datatypes import Camera, LabelPrior
from . import bearings, boxes, fusion
from .depth_scale import DepthScale
from .lifting import COARSE_BLOCK_SIDE, Views
from .perception_model import classes, naming


@dataclasses.dataclass(frozen=True)
class ObjectOptions:
    """Options for computing labels, confidences and street axes from the views of objects.

    Chosen manually; `benchmarks.fidelity` measures their effect (docs/decisions/generation.md).

    Attributes:
      missed_odds: factor on an object's odds for every frame that should show it and does not. Detectors miss a quarter
        to a half of the visible objects, and leaves and railings hide more than one ray indicates.
      size_penalty: decrease of the log odds per e-fold by which an object's size differs from every known one, beyond
        `size_spread`.
      size_spread: spread (log ratio) of the sizes of partly hidden objects.
      min_kinship: least similarity of labels that may denote the same object.
      min_similarity: least similarity of labels that are treated as one.
      fragment_share: a box is a fragment of another if more than this share of it is inside.
      fragment_frames: and if at most this share of the frames that show it show both.
      min_axis_length: m; only longer objects indicate the direction of a street.
      min_axis_ratio: least ratio of length to width of these objects.
      axis_radius: m; radius around an object within which the axes of others are used.
      min_axis_weight: least sum of their weights (1 = one object at the same position).
      min_axis_agreement: least agreement of their directions (1 = identical).
      vehicle_weight: weight of another large object's direction relative to that of a building; vehicles stand less
        exactly along the street.
      facade_spread: rad, deviation from the common direction at which the weight of an object's direction is halved;
        houses of side streets and at bends deviate.
      axis_rounds: rounds of this weighting.
      max_sharp_noise: relative depth noise below which an object's own points determine its heading.
      sectors: number of directions from which views of one object are taken.
      views_per_sector: largest number of views from each direction.
      max_views: largest number of views used for one box, the nearest first; more take time and do not improve it.
      height_views: number of views, the most accurate, that determine the height by which an object is named.
    """

    missed_odds: float = 0.7
    size_penalty: float = 1.5
    size_spread: float = 0.5
    min_kinship: float = 0.5
    min_similarity: float = 0.9
    fragment_share: float = 0.7
    fragment_frames: float = 0.5
    min_axis_length: float = 4.0
    min_axis_ratio: float = 1.25
    axis_radius: float = 25.0
    min_axis_weight: float = 0.3
    min_axis_agreement: float = 0.5
    vehicle_weight: float = 0.25
    facade_spread: float = np.radians(6.0)
    axis_rounds: int = 3
    max_sharp_noise: float = 0.01
    sectors: int = 8
    views_per_sector: int = 4
    max_views: int = 24
    height_views: int = 8


_OPTIONS = ObjectOptions()


@dataclasses.dataclass(frozen=True)
class Fused:
    """All views, grouped by object.

    Attributes:
      camera: intrinsics of every frame.
      views: the views; object_of_view (n,) i32, object of each; alike (L, L), similarity of their labels.
      coarse: (m, H / COARSE, W / COARSE) m, depth of the frames.
      placed, seen: where the views are in the world, and from above.
      poses: (m, 4, 4) T_world_camera.
      depth: each frame's scale and the noise that remains.
      single_view: use only one view of each object.
    """

    camera: Camera
    views: Views
    object_of_view: np.ndarray
    alike: np.ndarray
    coarse: np.ndarray
    placed: fusion.Placed
    seen: bearings.Bearings
    poses: np.ndarray
    depth: DepthScale
    single_view: bool

    @functools.cached_property
    def leaves(self) -> list[int] | None:
        """Numbers of the labels among those of the perception model; None if one is of another detector."""
        number = {leaf: k for k, leaf in enumerate(classes.leaves())}
        found = [number.get(label) for label in self.views.labels]
        return None if None in found else [k for k in found if k is not None]

    @functools.cached_property
    def exact(self) -> bool:
        """Whether depth and masks can be trusted to the pixel: the depth agrees, and all views are certain of their
        labels, as annotations are and detections are not. Single views are taken as they are."""
        return self.single_view or (shows_shapes(self.depth) and bool((self.views.belief.max(1) == 1.0).all()))

    @functools.cached_property
    def votes(self) -> np.ndarray:
        """(n, L), see `fusion.directions`."""
        return fusion.directions(self.views, self.alike)


@dataclasses.dataclass(frozen=True)
class FusedObject:
    """A fused object: its number in `object_of_view`, label, confidence, box, the label's prior, rows of its views."""

    number: int
    label: str
    score: float
    box: boxes.Box
    prior: LabelPrior
    rows: np.ndarray


def views_of_objects(object_of_view: np.ndarray) -> list[np.ndarray]:
    """Views of each object, in the order of its first view."""
    order = np.argsort(object_of_view, kind="stable")
    groups = np.split(order, np.flatnonzero(np.diff(object_of_view[order])) + 1) if len(order) else []
    return sorted(groups, key=lambda rows: int(rows[0]))


def objects_of(fused: Fused, prior_of: Callable[[str], LabelPrior]) -> list[FusedObject]:
    """Computes the objects of all views, in the order in which they were first seen.

    Where depth is blurred, the direction of the street comes first, from the sides of large objects; most objects are
    parallel or perpendicular to it.
    """
    groups = views_of_objects(fused.object_of_view)
    label = [_label(fused, rows) for rows in groups]
    street = None
    if not (fused.single_view or shows_shapes(fused.depth)):
        street = _street(fused, groups, label, prior_of)
    return [_object(fused, rows, k, prior_of, street) for rows, k in zip(groups, label, strict=True)]


def _street(
    fused: Fused, groups: list[np.ndarray], label: list[int], prior_of: Callable[[str], LabelPrior]
) -> "Street":
    """The directions of the objects that may be long, by their own points."""
    found, houses = [], []
    for rows, k in zip(groups, label, strict=True):
        prior = prior_of(fused.views.labels[k])
        if not len(prior.extents) or prior.extents[:, :2].max() > _OPTIONS.min_axis_length:
            bare = dataclasses.replace(prior, extents=np.zeros((0, 3)), shapes=())
            box = _object(fused, rows, k, lambda _, bare=bare: bare).box
            if shows_street(box):
                found.append(box)
                houses.append(prior.faces_road)
    return Street.of(found, houses)


def shows_shapes(depth: DepthScale) -> bool:
    """Whether depth is exact enough that an object's own points determine its heading."""
    return depth.noise < _OPTIONS.max_sharp_noise


def shows_street(box: boxes.Box) -> bool:
    """Whether an object is large and its visible part has a long side, like the front of a house."""
    longer, shorter = box.seen[:2].max(), box.seen[:2].min()
    return bool(longer > max(_OPTIONS.min_axis_length, _OPTIONS.min_axis_ratio * shorter))


@dataclasses.dataclass(frozen=True)
class Street:
    """Directions of large objects: center (n, 2) m; turn (n,), their headings as exp(4 i yaw); weight (n,)."""

    center: np.ndarray
    turn: np.ndarray
    weight: np.ndarray

    @classmethod
    def of(cls, objects: Sequence[boxes.Box], houses: Sequence[bool]) -> "Street":
        """Makes the directions from the boxes of objects for which `shows_street` holds, weighted by the inverse square
        of the error of their headings. houses: which are buildings."""
        center = np.array([t.center[:2] for t in objects]).reshape(-1, 2)
        error = np.array([boxes.heading_error(t.seen, t.blur) for t in objects])
        weight = np.where(np.asarray(houses, bool), 1.0, _OPTIONS.vehicle_weight) / error**2
        return cls(center, np.exp(4j * np.array([t.yaw for t in objects])), weight)

    def axis(self, place: np.ndarray) -> float | None:
        """rad modulo a quarter turn, direction of the large objects near (2,) m; None if there are none or they
        disagree."""
        near = 1.0 / (1.0 + (np.linalg.norm(self.center - place, axis=1) / _OPTIONS.axis_radius) ** 2) ** 2
        weight = near * self.weight
        agreed = (weight * self.turn).sum() / max(weight.sum(), 1e-9)
        if near.sum() <= _OPTIONS.min_axis_weight or abs(agreed) <= _OPTIONS.min_axis_agreement:
            return None
        for _ in range(_OPTIONS.axis_rounds):
            off = np.angle(self.turn * np.conj(agreed)) / 4
            agreed = (weight * self.turn / (1.0 + (off / _OPTIONS.facade_spread) ** 2)).sum()
        return float(np.angle(agreed) / 4)


def _label(fused: Fused, rows: np.ndarray) -> int:
    """The label of an object: that which its views believe most, or, where they are those of the perception model, the
    most probable by `naming`."""
    views, belief = fused.views, mean_belief(fused, rows)
    leaves = fused.leaves
    if leaves is None or (views.belief[rows] == 1.0).any(1).all():
        return int(belief.argmax())
    among = np.zeros(len(classes.leaves()))
    among[leaves] = belief
    name = classes.leaves()[naming.shipped().leaf(among, height(fused, rows))]
    return views.labels.index(name) if name in views.labels else int(belief.argmax())


def mean_belief(fused: Fused, rows: np.ndarray) -> np.ndarray:
    """(L,) mean belief of views, the near ones weighted more than the far ones."""
    return np.average(fused.views.belief[rows], axis=0, weights=fused.views.score[rows] / fused.placed.sigma[rows])


def height(fused: Fused, rows: np.ndarray) -> float:
    """m, height of the visible part of an object in its best views."""
    best = rows[np.argsort(fused.placed.sigma[rows], kind="stable")[: _OPTIONS.height_views]]
    low, high = (np.quantile(z[best, 2], q) for z, q in ((fused.placed.low, 0.2), (fused.placed.high, 0.8)))
    return float(high - low)


def _object(
    fused: Fused, rows: np.ndarray, label: int, prior_of: Callable[[str], LabelPrior], street: Street | None = None
) -> FusedObject:
    """Computes one object from its views; `street` gives the directions of objects around it, used if its own depth
    does not determine its heading."""
    views, placed = fused.views, fused.placed
    # Views with a dissimilar label may show another object. They are compared with what the views believe, because what
    # the network confuses can have a dissimilar name.
    believed = int(mean_belief(fused, rows).argmax())
    kin = fused.votes[rows] @ fused.alike[:, believed] >= _OPTIONS.min_kinship
    own = rows[kin] if kin.any() else rows
    if fused.single_view:
        own = chosen = rows[np.argsort(views.pixels[rows], kind="stable")][[len(rows) // 2]]
        label = int(views.belief[chosen[0]].argmax())
    else:
        chosen = _chosen(own, placed, views.clipped)
    prior = prior_of(views.labels[label])
    points = fusion.world_points(views, fused.poses, fused.depth.scale, chosen)
    viewpoints = placed.viewpoint[chosen]
    noise = fused.depth.noise
    points, sigma = boxes.consensus(points, viewpoints, placed.sigma[chosen], noise)
    top = _top(own if len(chosen) > 1 else chosen, views, placed)
    whole = own[~views.clipped[own, :2].any(1)]
    axis = None if street is None else street.axis(np.median(placed.center[own, :2], axis=0))
    seen = fused.seen.of(whole)
    box = boxes.fit(points.reshape(-1, 3), placed.viewpoint[own], prior, noise, top, sigma, seen, axis, fused.exact)
    name = views.labels[label]
    return FusedObject(int(fused.object_of_view[rows[0]]), name, _confidence(fused, rows, box, prior), box, prior, rows)


def without_fragments(objects: list[FusedObject], fused: Fused) -> list[FusedObject]:
    """Removes fragments, which lie in the box of an object of the same label that was seen more often: the top of a
    house above a roof, the end of a car behind another."""
    if len(objects) < 2:
        return objects
    views, placed, alike = fused.views, fused.placed, fused.alike
    row = {label: i for i, label in enumerate(views.labels)}
    centers = np.array([t.box.center for t in objects])
    # The visible part of each, without completed sides.
    spans = [(np.median(placed.low[t.rows], axis=0), np.median(placed.high[t.rows], axis=0)) for t in objects]
    frames = [set(views.frame[t.rows].tolist()) for t in objects]
    share = np.array([np.average(fused.votes[t.rows], axis=0, weights=views.score[t.rows]) for t in objects])
    kept = set(range(len(objects)))
    for i in sorted(kept, key=lambda k: len(objects[k].rows)):
        small = objects[i]
        near = np.linalg.norm(centers[:, :2] - centers[i, :2], axis=1)
        for j in np.argsort(near):
            large = objects[j]
            if near[j] > 0.6 * np.linalg.norm(large.box.size[:2]) + 1.0 and near[j] > 15.0:
                break
            rarer = 2 * len(small.rows) <= len(large.rows)
            similarity = max(alike[row[small.label], row[large.label]], float(share[i] @ alike @ share[j]))
            if i == j or j not in kept or not rarer or similarity < _OPTIONS.min_similarity:
                continue
            inside = boxes.share_inside(*spans[i], large.box, small.box.blur)
            shared = len(frames[i] & frames[j])
            if inside > _OPTIONS.fragment_share and shared <= _OPTIONS.fragment_frames * len(frames[i]):
                kept.discard(i)
                break
    return [objects[i] for i in sorted(kept)]


def _chosen(rows: np.ndarray, placed: fusion.Placed, clipped: np.ndarray) -> np.ndarray:
    """At most `ObjectOptions.max_views` views: the best from every direction."""
    if len(rows) <= _OPTIONS.max_views:
        return rows
    # The cost of a view cut off by the image border is that of one from three times the distance.
    cost = placed.sigma[rows] * np.where(clipped[rows].any(1), 3.0, 1.0)
    middle = np.median(placed.center[rows], axis=0)
    side = placed.viewpoint[rows] - middle
    turn = np.arctan2(side[:, 1], side[:, 0]) / (2 * np.pi) + 0.5
    sector = np.floor(turn * _OPTIONS.sectors).astype(int) % _OPTIONS.sectors
    order = np.lexsort((cost, sector))
    ends = np.r_[0, np.flatnonzero(np.diff(sector[order])) + 1]
    rank = np.arange(len(rows)) - np.repeat(ends, np.diff(np.r_[ends, len(rows)]))
    picked = order[rank < _OPTIONS.views_per_sector]
    return rows[picked[np.argsort(cost[picked], kind="stable")][: _OPTIONS.max_views]]


def _top(rows: np.ndarray, views: Views, placed: fusion.Placed) -> float | None:
    """m, height of an object's top, from its best views that the upper image border does not cut off; None if there is
    none.

    Other objects may hide the top in some views, and depth errors may raise it in others; the 80th percentile balances
    both.
    """
    whole = rows[~views.clipped[rows, 2]]
    if not len(whole):
        return None
    best = whole[np.argsort(placed.sigma[whole], kind="stable")[:8]]
    return float(np.quantile(placed.high[best, 2], 0.8))


def _confidence(fused: Fused, rows: np.ndarray, box: boxes.Box, prior: LabelPrior) -> float:
    """Probability that an object exists. Every view multiplies the odds by those of its score; every frame that should
    show the object and does not multiplies them by `missed_odds`.

    A frame should show it if its centre is in the image, no farther than in its farthest view, and not occluded.
    """
    camera, frames = fused.camera, np.unique(fused.views.frame[rows])
    offset = box.center - fused.poses[:, :3, 3]
    local = np.einsum("mji,mj->mi", fused.poses[:, :3, :3], offset)
    farthest = np.linalg.norm(box.center - fused.placed.viewpoint[rows], axis=1).max()
    z = np.maximum(local[:, 2], 0.5)
    u, w = (camera.fx * local[:, 0] / z + camera.cx), (camera.fy * local[:, 1] / z + camera.cy)
    inside = (local[:, 2] > 0.5) & (np.linalg.norm(offset, axis=1) <= farthest)
    inside &= (u > 0) & (u < camera.width) & (w > 0) & (w < camera.height)
    inside[frames] = False
    missing = np.flatnonzero(inside)
    i = np.minimum(w[missing] / COARSE_BLOCK_SIDE, fused.coarse.shape[1] - 1).astype(int)
    j = np.minimum(u[missing] / COARSE_BLOCK_SIDE, fused.coarse.shape[2] - 1).astype(int)
    depth = fused.coarse[missing, i, j] * fused.depth.scale[missing]
    slack = 0.5 * float(np.linalg.norm(box.size[:2])) + 2 * fused.depth.noise * local[missing, 2] + 0.3
    free = (depth == 0) | (depth > local[missing, 2] - slack)
    score = np.clip(fused.views.score[rows], 0.02, 0.98)
    odds = float(np.log(score / (1 - score)).sum() + free.sum() * np.log(_OPTIONS.missed_odds))
    if len(prior.extents):
        odds -= _OPTIONS.size_penalty * max(0.0, boxes.misfit(box.size, prior) - _OPTIONS.size_spread)
    return float(1.0 / (1.0 + np.exp(-np.clip(odds, -30, 30))))
