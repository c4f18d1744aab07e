"""`distil`: converts a recording to a scene graph with its evidence."""

import dataclasses
import pathlib
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import shapely

from ..datatypes import GraphObject, LabelPrior, Recording, SceneGraph, ValidationError
from ..geometry.polygons import rectangle
from . import bearings, crops, fronts, fusion, ground, ground_regions, placement
from .boxes import Box
from .depth_scale import DepthScale, depth_scale
from .drift import close_loops
from .ground_completion import completed
from .lifting import GroundPoints, Views, lift
from .objects import Fused, FusedObject, objects_of, shows_shapes, without_fragments
from .options import DistilOptions
from .separation import Separation, separate

#: Similarity of two labels without a common word, because detectors confuse some labels (van, truck). Chosen manually.
_UNRELATED_SIMILARITY = 0.35


@dataclasses.dataclass(frozen=True)
class Describe:
    """Functions that compute descriptors from crops, see `crops.Descriptor`; None for no descriptors."""

    object: crops.Descriptor | None = None
    ground: crops.Descriptor | None = None
    sky: crops.Descriptor | None = None

    def given(self) -> dict[str, crops.Descriptor]:
        fields = {f.name: getattr(self, f.name) for f in dataclasses.fields(self)}
        return {name: x for name, x in fields.items() if x is not None}


@dataclasses.dataclass(frozen=True)
class Evidence:
    """Evidence of an object.

    Attributes:
      id: id of the object in the graph.
      views: how many frames show it.
      first, last: numbers of the first and last of them in the recording.
      sigma: m, standard error of its centre.
      completed: which of its sizes (along the heading, across, up) come from the label's prior.
      moved: m, displacement by a placement prior.
      tracks: the detector's tracks that were fused into the object.
      front: log odds of the heading from lamps and the side of the road (see `fronts`); 0 where they say nothing.
    """

    id: str
    views: int
    first: int
    last: int
    sigma: float
    completed: tuple[bool, bool, bool]
    moved: float
    tracks: tuple[int, ...]
    front: float = 0.0

    def to_json(self) -> dict[str, Any]:
        return {**dataclasses.asdict(self), "completed": list(self.completed), "tracks": list(self.tracks)}


@dataclasses.dataclass(frozen=True)
class Distillation:
    """A scene graph and the intermediate results from which it was made.

    Attributes:
      graph: the scene graph.
      evidence: one entry per object of the graph, in its order.
      kerbs: steps found between kinds of ground.
      depth: each registered frame's depth scale, and the noise that remains.
      poses: (m, 4, 4) T_world_camera of the registered frames after loops were closed.
      views: how many views were fused.
      left_out: how many objects had too little confidence.
      separation: buildings that were cut or removed because they overlap, and what stood inside them.
    """

    graph: SceneGraph
    evidence: tuple[Evidence, ...]
    kerbs: tuple[ground.Kerb, ...]
    depth: DepthScale
    poses: np.ndarray
    views: int
    left_out: int
    separation: Separation


def word_similarity(one: str, other: str) -> float:
    """1 for the same label, less for shared words, `_UNRELATED_SIMILARITY` for none."""
    a, b = (set(re.findall(r"[a-z0-9]+", x.lower())) for x in (one, other))
    share = len(a & b) / len(a | b) if a | b else 0.0
    return _UNRELATED_SIMILARITY + (1.0 - _UNRELATED_SIMILARITY) * share


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
      prior_of: function that returns the prior of a label.
      similarity: of two labels, in [0, 1].
      describe: descriptors of crops.
      crop_folder: where the crops go.
      options: see `DistilOptions`.
      progress: called with (frames read, frames in all).

    Raises:
      ValidationError: there is no registered frame, or no ground is visible.
    """
    options = options or DistilOptions()
    fused, seen = fuse(recording, prior_of, similarity, options, progress)
    ground_grid = ground.ground_map(seen, fused.poses, fused.depth.scale, fused.depth.noise)
    if ground_grid is None:
        raise _no_ground(recording)
    objects = without_fragments(objects_of(fused, prior_of), fused)
    kept = [t for t in objects if t.score >= options.min_score]
    regions = ground_regions.regions(completed(ground_grid, [_footprint(t.box) for t in kept if t.prior.faces_road]))
    if not regions:
        raise _no_ground(recording)
    kept, front = _with_fronts(kept, fused, regions, recording)
    pulled, floor = placement.place_on_ground([t.box for t in kept], [t.prior for t in kept], regions, fused.exact)
    if not options.place:
        pulled = np.zeros_like(pulled)
    left_out = len(objects) - len(kept)
    laid = _Laid(kept, front, pulled, floor)
    return _graph(recording, fused, laid, regions, ground.kerbs(ground_grid), describe, crop_folder, left_out)


def fuse(
    recording: Recording,
    prior_of: Callable[[str], LabelPrior],
    similarity: Callable[[str, str], float] = word_similarity,
    options: DistilOptions | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[Fused, GroundPoints]:
    """The views of a recording, grouped by object, with corrected poses; and its points of the ground.

    Args and errors: see `distil`.
    """
    options = options or DistilOptions()
    poses = recording.poses()
    if not len(poses):
        raise ValidationError(
            f"recording {recording.id!r}: found no frame with a pose, needed at least one; estimate poses."
        )
    lifted = lift(recording, options.min_pixels, options.max_range, lambda label: _reach(prior_of(label)), progress)
    views, seen = lifted.views, lifted.ground
    depth = depth_scale(seen, poses)
    if not options.depth_scale:
        depth = DepthScale(np.ones(len(poses)), depth.noise)
    alike = np.array([[similarity(a, b) for b in views.labels] for a in views.labels]).reshape([len(views.labels)] * 2)
    placed, object_of_view = _associated(views, poses, depth, alike)
    if options.depth_scale and not options.single_view:
        error = bearings.depth_error(views, object_of_view, poses, depth.scale)
        if error > depth.noise:
            depth = dataclasses.replace(depth, noise=error)
            placed, object_of_view = _associated(views, poses, depth, alike)
    if options.close_loops and not options.single_view:
        poses, placed, object_of_view = _fixed(views, placed, object_of_view, poses, depth, alike)
    from_above = bearings.measure(views, poses, depth.scale, 1.0 / recording.camera.fx)
    single = options.single_view
    fused = Fused(
        recording.camera, views, object_of_view, alike, lifted.coarse, placed, from_above, poses, depth, single
    )
    return fused, seen


def _with_fronts(
    kept: list[FusedObject], fused: Fused, regions: tuple, recording: Recording
) -> tuple[list[FusedObject], np.ndarray]:
    """The objects with vehicles turned round where lamps and the side of the road say so, and (n,) the log odds that
    these give to the final headings."""
    views, sharp = fused.views, shows_shapes(fused.depth)
    rows = [k for k, obj in enumerate(kept) if "road" in obj.prior.stands_on]
    vehicles = [
        fronts.Vehicle(
            obj.box.center[:2],
            obj.box.yaw,
            sharp and bool(obj.prior.shapes),
            views.origin[obj.rows],
            fused.placed.viewpoint[obj.rows, :2],
            views.pixels[obj.rows],
        )
        for obj in (kept[k] for k in rows)
    ]
    odds, cues = fronts.log_odds(vehicles, regions, recording)
    out, front = list(kept), np.zeros(len(kept))
    for k, total, cue in zip(rows, odds, cues, strict=True):
        front[k] = cue if total >= 0 else -cue
        if total < 0:
            yaw = float(np.remainder(kept[k].box.yaw + 2 * np.pi, 2 * np.pi) - np.pi)
            out[k] = dataclasses.replace(kept[k], box=dataclasses.replace(kept[k].box, yaw=yaw))
    return out, front


def _associated(
    views: Views, poses: np.ndarray, depth: DepthScale, alike: np.ndarray
) -> tuple[fusion.Placed, np.ndarray]:
    """World positions of the views, and (n,) the object that each shows."""
    placed = fusion.place(views, poses, depth.scale, depth.noise)
    return placed, fusion.associate(views, placed, alike)


def _fixed(
    views: Views,
    placed: fusion.Placed,
    object_of_view: np.ndarray,
    poses: np.ndarray,
    depth: DepthScale,
    alike: np.ndarray,
) -> tuple[np.ndarray, fusion.Placed, np.ndarray]:
    """(m, 4, 4) poses after loop closure and the adjustment to all objects' views, with the derived data; the input
    poses where neither helps."""
    closed = close_loops(views, placed, object_of_view, poses, alike)
    if closed is not None:
        poses = closed
        placed, object_of_view = _associated(views, poses, depth, alike)
    adjusted = bearings.adjust(views, object_of_view, poses, depth)
    if adjusted is not None:
        poses = adjusted
        placed, object_of_view = _associated(views, poses, depth, alike)
    return poses, placed, object_of_view


def _no_ground(recording: Recording) -> ValidationError:
    return ValidationError(
        f"recording {recording.id!r}: found no ground, needed surfaces with depth in some registered frame."
    )


def _footprint(box: Box) -> shapely.Polygon:
    return rectangle(float(box.size[0]), float(box.size[1]), box.yaw, float(box.center[0]), float(box.center[1]))


def _reach(prior: LabelPrior) -> float:
    """m, largest distance from an object's centre to its surface: a quarter more than that of any known object of the
    label."""
    return 1.25 * float(np.linalg.norm(prior.extents[:, :2], axis=1).max()) if len(prior.extents) else np.inf


@dataclasses.dataclass(frozen=True)
class _Laid:
    """The n objects that are kept; front (n,) log odds, see `Evidence`; pulled (n, 2) m, movement to their ground;
    floor (n,) m, its height."""

    objects: list[FusedObject]
    front: np.ndarray
    pulled: np.ndarray
    floor: np.ndarray


def _graph(
    recording: Recording,
    fused: Fused,
    laid: _Laid,
    regions: tuple,
    kerbs: tuple,
    describe: Describe | None,
    crop_folder: pathlib.Path | None,
    left_out: int,
) -> Distillation:
    """The graph of the objects that are kept."""
    kept, pulled = laid.objects, laid.pulled
    names = _names(kept)
    describers = describe.given() if describe else {}
    descriptors = crops.Descriptors({}, {}, None)
    if describers or crop_folder is not None:
        by_number = {t.number: n for t, n in zip(kept, names, strict=True)}
        descriptors = crops.collect(recording, fused.views, fused.object_of_view, by_number, describers, crop_folder)
    objects, evidence = [], []
    for i, (obj, name) in enumerate(zip(kept, names, strict=True)):
        box = dataclasses.replace(obj.box, center=obj.box.center + [*pulled[i], 0.0])
        center, size = placement.stand(box, laid.floor[i], obj.prior)
        objects.append(
            GraphObject(
                id=name,
                label=obj.label,
                center=_rounded(center),
                size=_rounded(np.maximum(size, 0.001)),
                yaw=round(box.yaw, 4),
                score=round(obj.score, 4),
                descriptor=descriptors.objects.get(obj.number),
            )
        )
        numbers = fused.views.origin[obj.rows, 0]
        tracks = np.unique(fused.views.track[obj.rows])
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
                front=round(float(laid.front[i]), 3),
            )
        )
    priors = {obj.label: obj.prior for obj in kept}
    separation = separate(
        objects,
        lambda label: priors[label].faces_road,
        lambda label: not priors[label].on_ground,
        fused.poses[:, :2, 3],
        {entry.id: entry.views * obj.score for entry, obj in zip(evidence, objects, strict=True)},
    )
    removed = {entry.id for entry in separation.removed}
    graph = SceneGraph(
        id=recording.id,
        source=recording.source,
        objects=separation.objects,
        ground=tuple(dataclasses.replace(r, descriptor=descriptors.ground.get(r.kind)) for r in regions),
        sky_descriptor=descriptors.sky,
        camera_path=_path(fused.poses),
    )
    views = len(fused.views)
    stay = tuple(entry for entry in evidence if entry.id not in removed)
    return Distillation(graph, stay, kerbs, fused.depth, fused.poses, views, left_out, separation)


def _names(kept: list[FusedObject]) -> list[str]:
    """Ids of label and number, in the order of first detection."""
    counts: dict[str, int] = {}
    names = []
    for obj in kept:
        slug = re.sub(r"[^a-z0-9]+", "_", obj.label.lower()).strip("_") or "thing"
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
