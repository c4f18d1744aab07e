"""Computes the paper's columns: a graph against the true graph of the same capture."""

import dataclasses
from collections.abc import Iterable, Mapping, Sequence

import numpy as np
import scipy.optimize

from urbanverse_mjx.datatypes import GraphObject, Recording
from urbanverse_mjx.materialisation.overlap import ground_box

GATE = 5.0  # m
SMALL = 50.0  # m^3: Scale and mAP25 leave buildings out
IOU = 0.25
#: Least share of an image that an object covers in some frame to count as seen (0.15 %: 11 x 11 pixels of 384 x 216).
SEEN_SHARE = 0.0015
#: A footprint whose least and greatest bounding rectangle differ by less than this has no heading.
_ROUND = 1.12
#: Sides with a ratio nearer to 1 than this do not distinguish length and width.
_SQUARE = 1.15


@dataclasses.dataclass(frozen=True)
class Scores:
    """Scores of one capture; the raw numbers, so that captures can be pooled.

    right: per match, whether the label is right. distance: m. heading: rad of matches that have a heading, modulo half
    a turn. front: whether the heading is within 90° of the true one, with its sign. volume: m^3 differences of small
    matches. size (p, 2): log ratio of the found to the true height and longer side of the footprint, of small matches
    with the right label. truths: how many objects were seen; found: how many the graph holds.
    detections: label -> rows of (score, true positive); positives: label -> how many there are.
    pairs: (id in the graph, true id) of the matches.
    """

    right: np.ndarray
    distance: np.ndarray
    small: np.ndarray
    heading: np.ndarray
    front: np.ndarray
    volume: np.ndarray
    size: np.ndarray
    ground_truths: int
    found: int
    detections: dict[str, np.ndarray]
    positives: dict[str, int]
    pairs: list[tuple[str, str]]


def seen_objects(recording: Recording, objects: Iterable[GraphObject], share: float = SEEN_SHARE) -> list[GraphObject]:
    """Returns the true objects that cover enough of some frame of a capture, by its tracks."""
    camera = recording.camera
    needed = share * camera.width * camera.height
    seen: set[str] = set()
    for i, frame in enumerate(recording.frames):
        masks = recording.masks(i)
        if masks is None or not frame.detections:
            continue
        counts = np.bincount(masks[masks >= 0], minlength=len(frame.detections))
        seen |= {d.track for d, n in zip(frame.detections, counts, strict=True) if d.track and n >= needed}
    return [t for t in objects if t.id in seen]


def alignment(poses: np.ndarray, true_poses: np.ndarray) -> np.ndarray:
    """(4, 4) rigid T_true_found, no scale: least squares over camera centres and points 5 m along each camera's axes,
    which determine the turn about a straight path."""

    def marks(p: np.ndarray) -> np.ndarray:
        arms = 5.0 * np.concatenate([np.zeros((1, 3)), np.eye(3)])
        return (np.einsum("mij,kj->mki", p[:, :3, :3], arms) + p[:, None, :3, 3]).reshape(-1, 3)

    a, b = marks(poses), marks(true_poses)
    u, _, vt = np.linalg.svd((b - b.mean(0)).T @ (a - a.mean(0)))
    rotation = u @ np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ vt))]) @ vt
    out = np.eye(4)
    out[:3, :3], out[:3, 3] = rotation, b.mean(0) - rotation @ a.mean(0)
    return out


def moved(objects: Sequence[GraphObject], T: np.ndarray) -> list[GraphObject]:
    """Returns objects under a nearly level rigid transform."""
    turn = float(np.arctan2(T[1, 0], T[0, 0]))
    return [
        dataclasses.replace(
            t, center=tuple((T[:3, :3] @ np.array(t.center) + T[:3, 3]).tolist()), yaw=_wrapped(t.yaw + turn)
        )
        for t in objects
    ]


def _wrapped(angle: float) -> float:
    return float(np.remainder(angle + np.pi, 2 * np.pi) - np.pi)


def score(
    found: Sequence[GraphObject],
    ground_truth: Sequence[GraphObject],
    others: Sequence[GraphObject],
    turnable: Mapping[str, bool],
) -> Scores:
    """Scores aligned objects.

    Args:
      found: of the graph.
      ground_truth: seen objects.
      others: the true objects that were hardly visible; detecting them is neither right nor wrong.
      turnable: true id -> whether its heading is defined.
    """
    found = [f for f in found if not _is_one_of(f, others, ground_truth)]
    a = np.array([t.center for t in found]).reshape(-1, 3)
    b = np.array([t.center for t in ground_truth]).reshape(-1, 3)
    distance = np.linalg.norm(a[:, None] - b[None], axis=-1)
    rows, columns = scipy.optimize.linear_sum_assignment(np.where(distance <= GATE, distance, 1e3))
    near = distance[rows, columns] <= GATE
    rows, columns = rows[near], columns[near]
    pairs = [(found[i], ground_truth[j]) for i, j in zip(rows, columns, strict=True)]
    small = np.array([np.prod(t.size) < SMALL for _, t in pairs], bool)
    turns = np.array([abs(_wrapped(f.yaw - t.yaw)) for f, t in pairs])
    valid = np.array([turnable[t.id] for _, t in pairs], bool)
    sizes = np.log([[f.size[2] / t.size[2], max(f.size[:2]) / max(t.size[:2])] for f, t in pairs]).reshape(-1, 2)
    right = np.array([f.label == t.label for f, t in pairs], bool)
    volumes = np.array([abs(float(np.prod(f.size) - np.prod(t.size))) for f, t in pairs])
    detections, positives = _detections(found, ground_truth)
    return Scores(
        right=right,
        distance=distance[rows, columns],
        small=small,
        heading=np.minimum(turns, np.pi - turns)[valid] if len(pairs) else np.zeros(0),
        front=(turns < np.pi / 2)[valid] if len(pairs) else np.zeros(0, bool),
        volume=volumes[small] if len(pairs) else np.zeros(0),
        size=sizes[small & right],
        ground_truths=len(ground_truth),
        found=len(found),
        detections=detections,
        positives=positives,
        pairs=[(f.id, t.id) for f, t in pairs],
    )


def _is_one_of(obj: GraphObject, others: Sequence[GraphObject], ground_truth: Sequence[GraphObject]) -> bool:
    """Whether an object is nearer to a hardly visible object than to any visible one, and within half its size or 0.5
    m."""

    def nearest(objects: Sequence[GraphObject]) -> tuple[float, float]:
        away = [(float(np.linalg.norm(np.subtract(t.center, obj.center))), max(t.size)) for t in objects]
        return min(away, default=(np.inf, 0.0))

    away, size = nearest(others)
    return away < nearest(ground_truth)[0] and away <= max(0.5, size / 2)


def is_turnable(corners: np.ndarray) -> bool:
    """Whether an object's footprint (n, 2) m in its own axes has a heading: neither round nor as long as wide."""
    sides = np.sort(np.ptp(corners, axis=0))
    angles = np.radians(np.arange(0, 90, 3))
    u = np.cos(angles)[:, None] * corners[:, 0] + np.sin(angles)[:, None] * corners[:, 1]
    w = -np.sin(angles)[:, None] * corners[:, 0] + np.cos(angles)[:, None] * corners[:, 1]
    areas = np.ptp(u, axis=1) * np.ptp(w, axis=1)
    return bool(areas.max() > _ROUND * areas.min() and sides[1] > _SQUARE * sides[0])


def iou(a: GraphObject, b: GraphObject) -> float:
    """Share of two upright boxes' common volume in their joint volume."""
    low = max(a.center[2] - a.size[2] / 2, b.center[2] - b.size[2] / 2)
    high = min(a.center[2] + a.size[2] / 2, b.center[2] + b.size[2] / 2)
    if high <= low:
        return 0.0
    shared = ground_box(a).intersection(ground_box(b)).area * (high - low)
    return float(shared / (np.prod(a.size) + np.prod(b.size) - shared))


def _detections(
    found: Sequence[GraphObject], ground_truth: Sequence[GraphObject]
) -> tuple[dict[str, np.ndarray], dict[str, int]]:
    """Per label the small found objects as (score, true positive), best score first, each ground truth found
    once."""
    positives: dict[str, int] = {}
    for t in ground_truth:
        if np.prod(t.size) < SMALL:
            positives[t.label] = positives.get(t.label, 0) + 1
    large = [t for t in ground_truth if np.prod(t.size) >= SMALL]
    rows: dict[str, list[tuple[float, bool]]] = {}
    taken: set[str] = set()
    for f in sorted(found, key=lambda x: -x.score):
        near = [t for t in ground_truth if t.label == f.label and np.hypot(*np.subtract(t.center, f.center)[:2]) < 12.0]
        overlap = [(iou(f, t), t) for t in near if t.id not in taken and np.prod(t.size) < SMALL]
        best = max(overlap, key=lambda x: x[0], default=(0.0, None))
        if best[0] >= IOU and best[1] is not None:
            taken.add(best[1].id)
            rows.setdefault(f.label, []).append((f.score, True))
        elif np.prod(f.size) < SMALL and not any(iou(f, t) >= IOU for t in near if t in large):
            rows.setdefault(f.label, []).append((f.score, False))
    return {k: np.array(v, float) for k, v in rows.items()}, positives


def average_precision(rows: np.ndarray, positives: int) -> float:
    """Area under precision over recall, precision made falling (as PASCAL VOC 2010 and KITTI-360 do).

    rows (n, 2): score, true positive.
    """
    if not len(rows):
        return 0.0
    hits = rows[np.argsort(-rows[:, 0], kind="stable"), 1]
    recall, precision = np.cumsum(hits) / positives, np.cumsum(hits) / np.arange(1, len(hits) + 1)
    envelope = np.maximum.accumulate(precision[::-1])[::-1]
    return float((np.diff(np.r_[0.0, recall]) * envelope).sum())


def table_row(captures: Sequence[Scores]) -> dict[str, float | int | None]:
    """The columns over all captures: means over matches, recall and precision over objects, mAP25 over labels."""

    def joined(name: str) -> np.ndarray:
        return np.concatenate([getattr(t, name) for t in captures])

    def mean(values: np.ndarray, factor: float = 1.0, digits: int = 3) -> float | None:
        return round(factor * float(values.mean()), digits) if len(values) else None

    labels = sorted({k for t in captures for k in t.positives})
    aps = []
    for label in labels:
        rows = [t.detections[label] for t in captures if label in t.detections]
        positives = sum(t.positives.get(label, 0) for t in captures)
        aps.append(average_precision(np.concatenate(rows) if rows else np.zeros((0, 2)), positives))
    distance, small, size = joined("distance"), joined("small"), np.abs(joined("size"))
    ground_truths, found = sum(t.ground_truths for t in captures), sum(t.found for t in captures)
    return {
        "cat_percent": mean(joined("right"), 100.0, 1),
        "dist_m": mean(distance),
        "dist_small_m": mean(distance[small]),
        "dist_median_m": round(float(np.median(distance)), 3) if len(distance) else None,
        "ori_deg": mean(np.degrees(joined("heading")), 1.0, 2),
        "with_heading": len(joined("heading")),
        "front_percent": mean(joined("front"), 100.0, 1),
        "scale_m3": mean(joined("volume")),
        "height_percent": round(100.0 * float(np.expm1(np.median(size[:, 0]))), 1) if len(size) else None,
        "side_percent": round(100.0 * float(np.expm1(np.median(size[:, 1]))), 1) if len(size) else None,
        "map25": round(100 * float(np.mean(aps)), 1) if aps else None,
        "recall_percent": round(100 * len(distance) / max(ground_truths, 1), 1),
        "precision_percent": round(100 * len(distance) / max(found, 1), 1),
        "objects": ground_truths,
        "found": found,
        "labels": len(labels),
    }
