"""`distil`: a recording becomes a scene graph, and says on what evidence."""

import dataclasses
import pathlib
import re
from collections.abc import Callable
from typing import Any

import numpy as np

from ..datatypes import GraphObject, LabelPrior, NounError, Recording, SceneGraph
from . import boxes, crops, fusion, ground, placement
from .depth_scale import DepthScale, depth_scale
from .drift import close_loops
from .lifting import COARSE, Views, lift

#: Two labels without a word in common are still this alike: detectors mistake a van for a truck.
_STRANGERS = 0.35
#: How much less likely a thing is for every frame that should show it and does not: detectors miss a quarter to a half
#: of what they could find, and leaves and railings hide more than one ray tells.
_MISSED = 0.7
#: A thing is this much less likely (log odds) for every e-fold by which its size differs from any known one, beyond a
#: spread that partly hidden things have.
_ODD_SIZE, _SIZE_SPREAD = 1.5, 0.5
#: Labels from this similarity on may mean one thing.
_KIN = 0.5
#: Labels from this similarity on are one; a box is a fragment of another if more than this share of it is inside.
_ALIKE, _INSIDE = 0.9, 0.7
#: Views of one thing are taken from this many directions, so many of each at most.
_SECTORS, _PER_SECTOR = 8, 4


@dataclasses.dataclass(frozen=True)
class DistilOptions:
    """How a graph is made.

    Attributes:
      min_pixels: smaller views are not used; 24 is a bollard of 5 x 5 pixels.
      max_range: m, what is farther is not used.
      min_score: things of less confidence are left out.
      depth_scale: whether depth is made consistent over frames from the ground.
      close_loops: whether poses are made consistent where the tour comes by again.
      single_view: take each thing from one view alone, that of median size (to measure what fusion is worth).
      place: whether things are pulled to where their kind can stand.
    """

    min_pixels: int = 24
    max_range: float = 60.0
    min_score: float = 0.3
    depth_scale: bool = True
    close_loops: bool = True
    single_view: bool = False
    place: bool = True


@dataclasses.dataclass(frozen=True)
class Describe:
    """What turns crops into descriptors; see `crops.Descriptor`. None leaves them out."""

    object: crops.Descriptor | None = None
    ground: crops.Descriptor | None = None
    sky: crops.Descriptor | None = None

    def given(self) -> dict[str, crops.Descriptor]:
        fields = {f.name: getattr(self, f.name) for f in dataclasses.fields(self)}
        return {name: x for name, x in fields.items() if x is not None}


@dataclasses.dataclass(frozen=True)
class Evidence:
    """On what a thing rests.

    Attributes:
      id: of the graph's object.
      views: how many frames show it; first, last: numbers of the first and last of them in the recording.
      sigma: m, standard error of its centre.
      completed: which of its sizes (along the heading, across, up) come from what is known of the label.
      moved: m, how far a placement prior pulled it.
      tracks: the detector's own tracks that it holds.
    """

    id: str
    views: int
    first: int
    last: int
    sigma: float
    completed: tuple[bool, bool, bool]
    moved: float
    tracks: tuple[int, ...]

    def to_json(self) -> dict[str, Any]:
        return {**dataclasses.asdict(self), "completed": list(self.completed), "tracks": list(self.tracks)}


@dataclasses.dataclass(frozen=True)
class Distillation:
    """The graph and how it came about.

    Attributes:
      graph: the scene graph.
      evidence: one entry per object of the graph, in its order.
      kerbs: steps found between kinds of ground.
      depth: each registered frame's depth scale, and the noise that remains.
      poses: (m, 4, 4) T_world_camera of the registered frames after loops were closed.
      views: how many views were fused; left_out: how many things had too little confidence.
    """

    graph: SceneGraph
    evidence: tuple[Evidence, ...]
    kerbs: tuple[ground.Kerb, ...]
    depth: DepthScale
    poses: np.ndarray
    views: int
    left_out: int


def word_similarity(one: str, other: str) -> float:
    """1 for the same label, less for shared words, `_STRANGERS` for none."""
    a, b = (set(re.findall(r"[a-z0-9]+", x.lower())) for x in (one, other))
    share = len(a & b) / len(a | b) if a | b else 0.0
    return _STRANGERS + (1.0 - _STRANGERS) * share


def distil(
    recording: Recording,
    prior_of: Callable[[str], LabelPrior],
    similarity: Callable[[str, str], float] = word_similarity,
    describe: Describe | None = None,
    crop_folder: pathlib.Path | None = None,
    options: DistilOptions | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Distillation:
    """Makes the graph.

    Args:
      recording: with depth, and masks and surfaces as far as known, in world coordinates with z up.
      prior_of: what is known of a label.
      similarity: of two labels, in [0, 1].
      describe: descriptors of crops; crop_folder: where the crops go.
      options: see there.
      progress: called with (frames read, frames in all).

    Raises:
      NounError: no registered frame, or no ground in sight.
    """
    options = options or DistilOptions()
    poses = recording.poses()
    if not len(poses):
        raise NounError(f"recording {recording.id!r}: found no frame with a pose, needed at least one; estimate poses.")
    lifted = lift(recording, options.min_pixels, options.max_range, lambda label: _reach(prior_of(label)), progress)
    views, seen = lifted.views, lifted.ground
    depth = depth_scale(seen, poses)
    if not options.depth_scale:
        depth = DepthScale(np.ones(len(poses)), depth.noise)
    alike = np.array([[similarity(a, b) for b in views.labels] for a in views.labels]).reshape([len(views.labels)] * 2)
    placed = fusion.place(views, poses, depth.scale, depth.noise)
    thing = fusion.associate(views, placed, alike)
    if options.close_loops and not options.single_view:
        closed = close_loops(views, placed, thing, poses, alike)
        if closed is not None:
            poses = closed
            placed = fusion.place(views, poses, depth.scale, depth.noise)
            thing = fusion.associate(views, placed, alike)
    ground_grid = ground.ground_map(seen, poses, depth.scale, depth.noise)
    regions = () if ground_grid is None else ground.regions(ground_grid)
    if ground_grid is None or not regions:
        raise NounError(
            f"recording {recording.id!r}: found no ground, needed surfaces with depth in some registered frame."
        )
    state = _State(recording, views, lifted.coarse, thing, alike, placed, poses, depth, options)
    things = [t for t in (_thing(state, rows, prior_of) for rows in _groups(thing)) if t is not None]
    things = _absorbed(things, views, placed, alike)
    kept = [t for t in things if t.score >= options.min_score]
    return _graph(state, kept, regions, ground.kerbs(ground_grid), describe, crop_folder, len(things) - len(kept))


@dataclasses.dataclass(frozen=True)
class _State:
    recording: Recording
    views: Views
    coarse: np.ndarray
    thing: np.ndarray
    alike: np.ndarray
    placed: fusion.Placed
    poses: np.ndarray
    depth: DepthScale
    options: DistilOptions


@dataclasses.dataclass(frozen=True)
class _Thing:
    number: int
    label: str
    score: float
    box: boxes.Box
    prior: LabelPrior
    rows: np.ndarray


def _groups(thing: np.ndarray) -> list[np.ndarray]:
    """Views of each thing, in the order of its first view."""
    order = np.argsort(thing, kind="stable")
    groups = np.split(order, np.flatnonzero(np.diff(thing[order])) + 1) if len(order) else []
    return sorted(groups, key=lambda rows: int(rows[0]))


def _thing(state: _State, rows: np.ndarray, prior_of: Callable[[str], LabelPrior]) -> _Thing | None:
    """One thing from its views, or None where they contradict each other."""
    views, placed = state.views, state.placed
    votes = np.bincount(views.label[rows], views.score[rows] / placed.sigma[rows], len(views.labels))
    label = views.labels[int(votes.argmax())]
    prior = prior_of(label)
    # Views that called it something else may show something else.
    own = rows[state.alike[views.label[rows], int(votes.argmax())] >= _KIN]
    if state.options.single_view:
        own = chosen = rows[np.argsort(views.pixels[rows], kind="stable")][[len(rows) // 2]]
        label = views.labels[int(views.label[chosen[0]])]
        prior = prior_of(label)
    else:
        chosen = _chosen(own, placed, views.clipped)
    points = fusion.world_points(views, state.poses, state.depth.scale, chosen)
    eyes = placed.eye[chosen]
    noise = state.depth.noise
    points, sigma = boxes.consensus(points, eyes, placed.sigma[chosen], noise)
    top = _top(own if len(chosen) > 1 else chosen, views, placed)
    box = boxes.fit(points.reshape(-1, 3), placed.eye[own], prior, noise, top, sigma)
    if not np.isfinite(box.center).all():
        return None
    return _Thing(int(state.thing[rows[0]]), label, _confidence(state, rows, box, prior), box, prior, rows)


def _reach(prior: LabelPrior) -> float:
    """m: how far things of a label reach to both sides of their middle, a quarter more than any that is known."""
    return 1.25 * float(np.linalg.norm(prior.extents[:, :2], axis=1).max()) if len(prior.extents) else np.inf


def _absorbed(things: list[_Thing], views: Views, placed: fusion.Placed, alike: np.ndarray) -> list[_Thing]:
    """Things without the fragments that turn out to lie in the box of a thing of their label seen more often: the top
    of a house over a roof, the end of a car behind another."""
    if len(things) < 2:
        return things
    row = {label: i for i, label in enumerate(views.labels)}
    centers = np.array([t.box.center for t in things])
    # What was seen of each, without what was completed.
    spans = [(np.median(placed.low[t.rows], axis=0), np.median(placed.high[t.rows], axis=0)) for t in things]
    frames = [set(views.frame[t.rows].tolist()) for t in things]
    kept = set(range(len(things)))
    for i in sorted(kept, key=lambda k: len(things[k].rows)):
        small = things[i]
        near = np.linalg.norm(centers[:, :2] - centers[i, :2], axis=1)
        for j in np.argsort(near):
            large = things[j]
            if near[j] > 0.6 * np.linalg.norm(large.box.size[:2]) + 1.0 and near[j] > 15.0:
                break
            rarer = 2 * len(small.rows) <= len(large.rows)
            if i == j or j not in kept or not rarer or alike[row[small.label], row[large.label]] < _ALIKE:
                continue
            inside = boxes.share_inside(*spans[i], large.box, small.box.blur)
            if inside > _INSIDE and len(frames[i] & frames[j]) <= len(frames[i]) // 4:
                kept.discard(i)
                break
    return [things[i] for i in sorted(kept)]


def _chosen(rows: np.ndarray, placed: fusion.Placed, clipped: np.ndarray) -> np.ndarray:
    """At most `boxes.MAX_VIEWS` views: the best from every direction."""
    if len(rows) <= boxes.MAX_VIEWS:
        return rows
    # A view cut off by the picture's rim is worth one from three times as far.
    cost = placed.sigma[rows] * np.where(clipped[rows].any(1), 3.0, 1.0)
    middle = np.median(placed.center[rows], axis=0)
    side = placed.eye[rows] - middle
    sector = np.floor((np.arctan2(side[:, 1], side[:, 0]) / (2 * np.pi) + 0.5) * _SECTORS).astype(int) % _SECTORS
    order = np.lexsort((cost, sector))
    ends = np.r_[0, np.flatnonzero(np.diff(sector[order])) + 1]
    rank = np.arange(len(rows)) - np.repeat(ends, np.diff(np.r_[ends, len(rows)]))
    picked = order[rank < _PER_SECTOR]
    return rows[picked[np.argsort(cost[picked], kind="stable")][: boxes.MAX_VIEWS]]


def _top(rows: np.ndarray, views: Views, placed: fusion.Placed) -> float | None:
    """m: the height of a thing's top, from its best views that the picture's upper rim did not cut; None without any.

    Other things may hide the top in some of them, depth may raise it in others: the 80th percentile is between.
    """
    whole = rows[~views.clipped[rows, 2]]
    if not len(whole):
        return None
    best = whole[np.argsort(placed.sigma[whole], kind="stable")[:8]]
    return float(np.quantile(placed.high[best, 2], 0.8))


def _confidence(state: _State, rows: np.ndarray, box: boxes.Box, prior: LabelPrior) -> float:
    """Probability that a thing is there: every view speaks for it by the odds of its score, every frame that should
    have shown it and did not speaks against it by the odds of `_MISSED`.

    A frame should have shown it if its middle is in the picture, no farther than in its farthest view, and nothing
    stands before it.
    """
    camera, frames = state.recording.camera, np.unique(state.views.frame[rows])
    offset = box.center - state.poses[:, :3, 3]
    local = np.einsum("mji,mj->mi", state.poses[:, :3, :3], offset)
    farthest = np.linalg.norm(box.center - state.placed.eye[rows], axis=1).max()
    z = np.maximum(local[:, 2], 0.5)
    u, w = (camera.fx * local[:, 0] / z + camera.cx), (camera.fy * local[:, 1] / z + camera.cy)
    inside = (local[:, 2] > 0.5) & (np.linalg.norm(offset, axis=1) <= farthest)
    inside &= (u > 0) & (u < camera.width) & (w > 0) & (w < camera.height)
    inside[frames] = False
    missing = np.flatnonzero(inside)
    i = np.minimum(w[missing] / COARSE, state.coarse.shape[1] - 1).astype(int)
    j = np.minimum(u[missing] / COARSE, state.coarse.shape[2] - 1).astype(int)
    depth = state.coarse[missing, i, j] * state.depth.scale[missing]
    slack = 0.5 * float(np.linalg.norm(box.size[:2])) + 2 * state.depth.noise * local[missing, 2] + 0.3
    free = (depth == 0) | (depth > local[missing, 2] - slack)
    score = np.clip(state.views.score[rows], 0.02, 0.98)
    odds = float(np.log(score / (1 - score)).sum() + free.sum() * np.log(_MISSED))
    if len(prior.extents):
        odds -= _ODD_SIZE * max(0.0, boxes.misfit(box.size, prior) - _SIZE_SPREAD)
    return float(1.0 / (1.0 + np.exp(-np.clip(odds, -30, 30))))


def _graph(
    state: _State,
    kept: list[_Thing],
    regions: tuple,
    kerbs: tuple,
    describe: Describe | None,
    crop_folder: pathlib.Path | None,
    left_out: int,
) -> Distillation:
    recording = state.recording
    pulled, floor = placement.settle([t.box for t in kept], [t.prior for t in kept], regions)
    if not state.options.place:
        pulled = np.zeros_like(pulled)
    names = _names(kept)
    describers = describe.given() if describe else {}
    looks = crops.Looks({}, {}, None)
    if describers or crop_folder is not None:
        by_number = {t.number: n for t, n in zip(kept, names, strict=True)}
        looks = crops.collect(recording, state.views, state.thing, by_number, describers, crop_folder)
    objects, evidence = [], []
    for i, (thing, name) in enumerate(zip(kept, names, strict=True)):
        box = dataclasses.replace(thing.box, center=thing.box.center + [*pulled[i], 0.0])
        center, size = placement.stand(box, floor[i], thing.prior)
        objects.append(
            GraphObject(
                id=name,
                label=thing.label,
                center=_rounded(center),
                size=_rounded(np.maximum(size, 0.001)),
                yaw=round(box.yaw, 4),
                score=round(thing.score, 4),
                descriptor=looks.things.get(thing.number),
            )
        )
        numbers = state.views.origin[thing.rows, 0]
        tracks = np.unique(state.views.track[thing.rows])
        evidence.append(
            Evidence(
                id=name,
                views=len(np.unique(numbers)),
                first=int(numbers.min()),
                last=int(numbers.max()),
                sigma=round(box.sigma, 4),
                completed=box.completed,
                moved=round(float(np.linalg.norm(pulled[i])), 3),
                tracks=tuple(int(t) for t in tracks if t >= 0),
            )
        )
    graph = SceneGraph(
        id=recording.id,
        source=recording.source,
        objects=tuple(objects),
        ground=tuple(dataclasses.replace(r, descriptor=looks.ground.get(r.kind)) for r in regions),
        sky_descriptor=looks.sky,
        camera_path=_path(state.poses),
    )
    views = len(state.views)
    return Distillation(graph, tuple(evidence), kerbs, state.depth, state.poses, views, left_out)


def _names(kept: list[_Thing]) -> list[str]:
    """Ids that say the label and count in the order in which things were first seen."""
    counts: dict[str, int] = {}
    names = []
    for thing in kept:
        slug = re.sub(r"[^a-z0-9]+", "_", thing.label.lower()).strip("_") or "thing"
        names.append(f"{slug}_{counts.setdefault(slug, 0):03d}")
        counts[slug] += 1
    return names


def _rounded(values: np.ndarray) -> tuple[float, float, float]:
    x, y, z = (round(float(v), 4) for v in values)
    return x, y, z


def _path(poses: np.ndarray) -> tuple[tuple[float, float, float, float], ...]:
    forward = poses[:, :3, 2]
    yaw = np.arctan2(forward[:, 1], forward[:, 0])
    return tuple((*_rounded(p[:3, 3]), round(float(a), 4)) for p, a in zip(poses, yaw, strict=True))
