"""Lifts masks and depth to point sets in the camera's frame, with the same number of points for every view.

A *view* is one detection in one frame. Its points stay in the camera's frame, so that a better pose or depth scale
found later moves them without reading the images again.
"""

import dataclasses
import itertools
from collections.abc import Callable

import numpy as np

from ..datatypes import GROUND_KINDS, PAINT_KINDS, Recording
from ..datatypes.recording import SKY

#: Number of points kept of a view; views with fewer pixels repeat some.
NUM_POINTS = 192
#: Side, in pixels, of the block that one pixel of the coarse depth covers.
COARSE_BLOCK_SIDE = 8


@dataclasses.dataclass(frozen=True)
class LiftOptions:
    """Conditions for keeping pixels of a view.

    Chosen manually; `benchmarks.fidelity` measures their effect (docs/decisions/generation.md).

    Attributes:
      min_group: least share of a view's points that a group apart in depth needs to belong to the object; smaller
        groups are background covered by the mask.
      ground_points: approximate number of ground points per frame, and of all frames together if they are few.
    """

    min_group: float = 0.2
    ground_points: tuple[int, int] = (1500, 45_000)


_OPTIONS = LiftOptions()


@dataclasses.dataclass(frozen=True)
class Views:
    """The n views of objects in the m registered frames.

    frame (n,) i32: row of the registered frames; label (n,) i32: row of `labels`; score (n,) f32.
    track (n,) i32: row of the recording's tracks, -1 = none.
    points (n, NUM_POINTS, 3) f32 m, camera frame.
    pixels (n,) i32. clipped (n, 4) bool: whether it touches the left, right, top or bottom of the image.
    origin: (n, 2) i32: number of the frame in the recording and of the detection in it.
    belief: (n, L) f32 probabilities of `labels`; rows add up to 1. Without it, each view is certain of its label.
    """

    labels: tuple[str, ...]
    frame: np.ndarray
    label: np.ndarray
    score: np.ndarray
    track: np.ndarray
    points: np.ndarray
    pixels: np.ndarray
    clipped: np.ndarray
    origin: np.ndarray
    belief: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros((0, 0), np.float32))

    def __post_init__(self) -> None:
        if self.belief.shape == (0, 0):
            certain = np.zeros((len(self.frame), len(self.labels)), np.float32)
            certain[np.arange(len(self.frame)), self.label] = 1.0
            object.__setattr__(self, "belief", certain)

    def __len__(self) -> int:
        return len(self.frame)


@dataclasses.dataclass(frozen=True)
class GroundPoints:
    """Observed ground points in the camera's frame: frame (g,) i32, kind (g,) u8, points (g, 3) f32 m."""

    frame: np.ndarray
    kind: np.ndarray
    points: np.ndarray


@dataclasses.dataclass(frozen=True)
class Lifted:
    """The data of a recording: views, ground, and depth (m, H / COARSE, W / COARSE) m, 0 = unknown, of the registered
    frames, for occlusion tests."""

    views: Views
    ground: GroundPoints
    coarse: np.ndarray


def lift(
    recording: Recording,
    min_pixels: int,
    max_range: float,
    depth_of: Callable[[str], float] = lambda _: np.inf,
    progress: Callable[[int, int], None] | None = None,
) -> Lifted:
    """Reads every registered frame once and lifts its views and ground points.

    Args:
      min_pixels: views with fewer pixels are left out.
      max_range: m; farther points are left out.
      depth_of: label -> m, largest distance from the centre of such an object to its surface.
      progress: called with (frames done, frames in all).
    """
    rays = recording.camera.rays().astype(np.float32)
    labels: dict[str, int] = {}
    tracks: dict[str, int] = {}
    parts: list[tuple[np.ndarray, ...]] = []
    grounds: list[tuple[np.ndarray, ...]] = []
    registered = recording.registered
    camera = recording.camera
    rows = (
        len(range(COARSE_BLOCK_SIDE // 2, camera.height, COARSE_BLOCK_SIDE)),
        len(range(COARSE_BLOCK_SIDE // 2, camera.width, COARSE_BLOCK_SIDE)),
    )
    coarse = np.zeros((len(registered), *rows), np.float32)
    for row, number in enumerate(registered):
        depth = recording.depth(int(number))
        if depth is not None:
            coarse[row] = depth[
                COARSE_BLOCK_SIDE // 2 :: COARSE_BLOCK_SIDE, COARSE_BLOCK_SIDE // 2 :: COARSE_BLOCK_SIDE
            ]
            depth = np.where(depth <= max_range, depth, 0.0)
            masks, surfaces = recording.masks(int(number)), recording.surfaces(int(number))
            if masks is not None:
                objects = recording.frames[number].detections
                reach = np.array([depth_of(d.label) for d in objects])
                found = _views(masks, depth, rays, min_pixels, reach)
                index = found[0]
                label = [labels.setdefault(objects[i].label, len(labels)) for i in index]
                track = [-1 if (t := objects[i].track) is None else tracks.setdefault(t, len(tracks)) for i in index]
                columns = [np.full(len(index), row), label, [objects[i].score for i in index], track, *found[1:]]
                columns.append(np.stack([np.full(len(index), number), index], -1))
                parts.append(tuple(np.asarray(c) for c in columns))
            if surfaces is not None:
                grounds.append((*_ground(surfaces, depth, rays, row, len(registered)),))
        if progress is not None:
            progress(row + 1, len(registered))
    views = _joined(parts, tuple(labels))
    return Lifted(_with_beliefs(views, recording), _joined_ground(grounds), coarse)


def _with_beliefs(views: Views, recording: Recording) -> Views:
    """The views with the probabilities that the detections have, and the labels that these add."""
    number = {label: k for k, label in enumerate(views.labels)}
    found = [recording.frames[frame].detections[row].beliefs for frame, row in views.origin.tolist()]
    for label, _ in itertools.chain(*found):
        number.setdefault(label, len(number))
    belief = np.pad(views.belief, ((0, 0), (0, len(number) - len(views.labels))))
    for row, beliefs in enumerate(found):
        if beliefs:
            belief[row] = 0.0
            belief[row, [number[label] for label, _ in beliefs]] = [p for _, p in beliefs]
    belief /= np.maximum(belief.sum(1, keepdims=True), 1e-9)
    return dataclasses.replace(views, labels=tuple(number), belief=belief)


def _joined(parts: list[tuple[np.ndarray, ...]], labels: tuple[str, ...]) -> Views:
    empty = ((0,), (0,), (0,), (0,), (0, NUM_POINTS, 3), (0,), (0, 4), (0, 2))
    types = (np.int32, np.int32, np.float32, np.int32, np.float32, np.int32, bool, np.int32)
    columns = [
        np.concatenate([np.zeros(shape, dtype), *(p[k].reshape(-1, *shape[1:]).astype(dtype) for p in parts)])
        for k, (shape, dtype) in enumerate(zip(empty, types, strict=True))
    ]
    return Views(labels, *columns)


def _joined_ground(parts: list[tuple[np.ndarray, ...]]) -> GroundPoints:
    frame = np.concatenate([np.zeros(0, np.int32), *(p[0] for p in parts)])
    kind = np.concatenate([np.zeros(0, np.uint8), *(p[1] for p in parts)])
    return GroundPoints(frame, kind, np.concatenate([np.zeros((0, 3), np.float32), *(p[2] for p in parts)]))


def _views(
    masks: np.ndarray, depth: np.ndarray, rays: np.ndarray, min_pixels: int, reach: np.ndarray
) -> tuple[np.ndarray, ...]:
    """(k,) detections, (k, NUM_POINTS, 3) points, (k,) pixels, (k, 4) clipped; k = detections with enough depth."""
    height, width = masks.shape
    flat = np.flatnonzero((masks >= 0) & (depth > 0))
    which, z = masks.ravel()[flat], depth.ravel()[flat]
    keep = _main_groups(which, z, reach)
    flat, which = flat[keep], which[keep]
    counts = np.bincount(which, minlength=int(masks.max()) + 1 if masks.size else 0)
    index = np.flatnonzero(counts >= min_pixels)
    order = np.argsort(which, kind="stable")
    starts = np.r_[0, np.cumsum(counts)][index]
    # Evenly over the view's pixels in raster order, so over the whole visible part.
    steps = np.floor((np.arange(NUM_POINTS) + 0.5) / NUM_POINTS * counts[index, None]).astype(np.int64)
    pixels = flat[order[starts[:, None] + steps]]
    points = rays.reshape(-1, 3)[pixels] * depth.ravel()[pixels][..., None]
    rim = np.stack([np.zeros(len(counts), bool)] * 4, -1)
    for side, edge in enumerate((masks[:, 0], masks[:, width - 1], masks[0], masks[height - 1])):
        rim[np.unique(edge[edge >= 0]), side] = True
    return index, points, counts[index], rim[index]


def _main_groups(which: np.ndarray, z: np.ndarray, reach: np.ndarray) -> np.ndarray:
    """(p,) bool, pixels whose depth belongs to the main body of their view.

    Sorted by depth, the pixels of a view form groups that are separated by gaps of 0.5 m or 4 % of the range. Groups
    with less than `min_group` of the pixels show what is behind or beside the object.
    """
    order = np.lexsort((z, which))
    w, s = which[order], z[order]
    new = np.r_[True, (w[1:] != w[:-1]) | (s[1:] - s[:-1] > np.maximum(0.5, 0.04 * s[1:]))] if len(w) else w == w
    group = np.cumsum(new) - 1
    sizes = np.bincount(group) if len(w) else np.zeros(0)
    totals = np.bincount(which)
    keep = np.zeros(len(z), bool)
    keep[order] = sizes[group] >= _OPTIONS.min_group * totals[w]
    # Pixels farther from the middle pixel's depth than the object's size belong to other objects.
    middle = np.zeros(len(totals))
    ends = np.cumsum(totals)
    some = totals > 0
    middle[some] = s[(ends - (totals + 1) // 2)[some]]
    return keep & (np.abs(z - middle[which]) <= reach[which] + 0.05 * z)


def _ground(surfaces: np.ndarray, depth: np.ndarray, rays: np.ndarray, row: int, frames: int) -> tuple[np.ndarray, ...]:
    """Frame, kind and points of ground pixels, thinned evenly over the image."""
    paint = [GROUND_KINDS.index(name) for name in PAINT_KINDS]
    usable = (surfaces > 0) & (surfaces != SKY) & (depth > 0) & ~np.isin(surfaces, paint)
    flat = np.flatnonzero(usable)
    each, together = _OPTIONS.ground_points
    flat = flat[:: max(1, len(flat) // max(each, together // frames))]
    points = rays.reshape(-1, 3)[flat] * depth.ravel()[flat][:, None]
    return np.full(len(flat), row, np.int32), surfaces.ravel()[flat], points
