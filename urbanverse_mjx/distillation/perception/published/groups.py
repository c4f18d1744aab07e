"""Maps classes of COCO to the groups of the perception model, and joins riders with their bicycles."""

import functools

import numpy as np

from ...perception_model import classes
from ..foundation.boxes import Boxes

#: Number of a class in COCO's order of 80 -> group. Classes that the labelled photographs lack are left out, because
#: nothing is known of how often they are right on streets.
COCO = {
    0: "pedestrian adult",
    1: "bicycle",
    2: "car",
    3: "motorcycle",
    5: "bus",
    7: "truck",
    9: "traffic light",
    11: "traffic sign",
}
#: Groups that a detected group confirms: COCO's car includes vans.
_ALSO = {"car": ("car", "van")}
#: Groups that detectors and the perception model mistake for one another, and whose pixels are therefore taken for a
#: box of any of them.
_FAMILIES = (
    ("car", "van", "truck", "bus"),
    ("bicycle", "motorcycle", "scooter"),
    ("pedestrian adult", "wheelchair", "stroller"),
    ("traffic light", "traffic sign"),
)
_RIDER = ("pedestrian adult", "bicycle", "cyclist", "motorcycle", "scooter")
#: Groups that stand on the ground; the others hang above it.
HANGING = ("traffic light", "traffic sign")
#: Groups whose outline is nearly their box.
BOXES = ("truck", "bus", "traffic light", "traffic sign")
#: Share of a rider's width that is above the bicycle, and of a rider's height by which the feet are above its wheels.
_ABOVE, _FEET = 0.5, 0.03


@functools.cache
def confirmed(group: str) -> np.ndarray:
    """(classes,) bool, the classes that a box of a group confirms."""
    return np.isin(classes.names(), _ALSO.get(group, (group,)))


@functools.cache
def related(group: str) -> np.ndarray:
    """(classes,) bool, the classes of the same family."""
    family = next((f for f in _FAMILIES if group in f), (group,))
    return np.isin(classes.names(), _RIDER if group == "cyclist" else family)


@functools.cache
def compact() -> np.ndarray:
    """(classes,) bool, the classes of all families, of which an object is about as near as its lower edge."""
    return np.isin(classes.names(), (*sum(_FAMILIES, ()), "cyclist"))


def to_groups(found: Boxes) -> Boxes:
    """Boxes with the numbers of the perception model's classes in place of COCO's; others are left out. A person on a
    bicycle or motorcycle becomes one cyclist, as in the perception model's classes."""
    rows = [k for k in range(len(found.box)) if int(found.label[k]) in COCO]
    known = found.take(rows)
    label = np.array([classes.names().index(COCO[int(k)]) for k in known.label], int)
    return _with_riders(Boxes(known.box, label, known.score))


def _with_riders(found: Boxes) -> Boxes:
    """A rider's feet are above the ground on which the wheels stand; the pair with the largest shared width first."""
    person, bicycle, cyclist, motorcycle = (
        classes.names().index(n) for n in ("pedestrian adult", "bicycle", "cyclist", "motorcycle")
    )
    pairs = []
    for i in np.flatnonzero(found.label == person):
        left, top, right, bottom = found.box[i]
        for j in np.flatnonzero(np.isin(found.label, (bicycle, motorcycle))):
            low, upper, high, ground = found.box[j]
            above = (min(right, high) - max(left, low)) / (right - left)
            sits = top < upper < bottom < ground - _FEET * (bottom - top)
            if above >= _ABOVE and sits:
                pairs.append((-above, tuple(found.box[i]), tuple(found.box[j]), int(i), int(j)))
    box, label, score = found.box.copy(), found.label.copy(), found.score.copy()
    gone: set[int] = set()
    for *_, i, j in sorted(pairs):
        if i not in gone and j not in gone and label[i] == person:
            box[i] = [*np.minimum(box[i, :2], box[j, :2]), *np.maximum(box[i, 2:], box[j, 2:])]
            label[i], score[i] = cyclist, min(score[i], score[j])
            gone.add(j)
    kept = [k for k in range(len(label)) if k not in gone]
    return Boxes(box, label, score).take(kept)
