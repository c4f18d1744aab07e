"""Fuses a detector's boxes with the objects that the perception model found in one image.

A box and an object that overlap by half are one object: the box confirms its class and raises its probability, or
corrects the class where the box is surer. A box without an object becomes one if its probability suffices. Its mask are
the pixels inside the box that the perception model gives to related classes if they fill it, else the ellipse in the
box, with bulging sides for buses and others that fill their boxes. Its depth is the model's, for an ellipse that of the
ground below it. Results do not depend on the order of boxes.
"""

import dataclasses

import numpy as np
from scipy.special import expit, logit

from ...perception_model import classes
from ...perception_model.decode import Decoded, FoundObject
from ..foundation.boxes import Boxes, area_of, overlap
from . import groups


@dataclasses.dataclass(frozen=True)
class FusionOptions:
    """Options of the fusion.

    Attributes:
      trust: coefficients of the evidence (see `evidence`) in the log odds that a box is right (its class, and half of
        its area), fitted by `benchmarks.second_opinion` to photographs that no table reports.
      least: smallest probability of a new object, the one from which the perception model reports objects.
      same: intersection over union from which a box and an object are one.
      repeated: intersection over union from which two related objects of different sources are one, the surer.
      filled: least share of a box that pixels of related classes fill, if they are to be its mask.
      min_pixels: smaller objects are left out, as by the perception model.
    """

    trust: tuple[float, ...] = (-2.02, 2.99, 1.19, 1.99, -0.42, 3.81)
    least: float = 0.5
    same: float = 0.5
    repeated: float = 0.4
    filled: float = 0.4
    min_pixels: int = 12


OPTIONS = FusionOptions()


@dataclasses.dataclass(frozen=True)
class Candidate:
    """A box beside what the perception model found: class, box (4,) in pixels of its outputs, features, and the number
    of the object that it overlaps by half, -1 = none."""

    kind: int
    box: np.ndarray
    evidence: tuple[float, ...]
    partner: int


def candidates(seen: Decoded, found: Boxes, size: tuple[int, int], options: FusionOptions = OPTIONS) -> list[Candidate]:
    """The boxes in a fixed order, each with its evidence and at most one object.

    Args:
      found: boxes in pixels of the image, labels are numbers of classes.
      size: height and width of the image.
    """
    scale = np.array([seen.masks.shape[1] / size[1], seen.masks.shape[0] / size[0]] * 2)
    order = np.lexsort((*found.box.T, found.label, -found.score))
    found = found.take(order.tolist())
    box = found.box * scale
    partner = _partners(seen, box, found.label, options.same)
    return [
        Candidate(int(k), b, evidence(seen, int(k), float(s), b, int(p)), int(p))
        for k, s, b, p in zip(found.label, found.score, box, partner, strict=True)
    ]


def evidence(seen: Decoded, kind: int, score: float, box: np.ndarray, partner: int) -> tuple[float, ...]:
    """Features of a box: 1; log odds of the detector's score; share of its pixels that the perception model gives to
    the class; probability of the object of that class that it overlaps by half, 0 without one; the logarithm of its
    side in shares of the image's; and whether it is a sign, because COCO has stop signs alone, so that the scores of
    others are low."""
    agreed = groups.confirmed(classes.names()[kind])
    rows, columns = _span(box, seen.kinds.shape)
    share = float(agreed[seen.kinds[rows, columns]].mean())
    same = partner >= 0 and agreed[seen.objects[partner].kind]
    prior = seen.objects[partner].score if same else 0.0
    side = float(np.log(max(area_of(box), 1.0) / seen.kinds.size) / 2.0)
    sign = float(classes.names()[kind] == "traffic sign")
    return 1.0, float(logit(np.clip(score, 0.01, 0.99))), share, prior, side, sign


def fuse(seen: Decoded, found: Boxes, size: tuple[int, int], options: FusionOptions = OPTIONS) -> Decoded:
    """The perception model's outputs with a detector's boxes.

    Args:
      seen: all objects, whatever their score.
      found: boxes in pixels of the image; labels are numbers of the perception model's classes.
      size: height and width of the image.
    """
    objects = list(seen.objects)
    new: list[tuple[float, Candidate]] = []
    for one in candidates(seen, found, size, options):
        score = float(expit(np.dot(options.trust, one.evidence)))
        if one.partner < 0:
            if score >= options.least:
                new.append((score, one))
            continue
        old = objects[one.partner]
        if groups.confirmed(classes.names()[one.kind])[old.kind]:
            objects[one.partner] = dataclasses.replace(old, score=max(score, old.score))
        elif score > old.score:
            objects[one.partner] = _generic(one.kind, score)
    fused = _relabelled(dataclasses.replace(seen, objects=tuple(objects)), seen)
    return _with_new(fused, _not_repeated(fused, new, options), options)


def _generic(kind: int, score: float) -> FoundObject:
    """An object of which no more than the class is known: certainty 0 gives it its group's label."""
    return FoundObject(kind, score, int(np.flatnonzero(classes.leaf_classes() == kind)[0]), (), 0.0)


def _relabelled(fused: Decoded, before: Decoded) -> Decoded:
    """The image of classes with those of objects whose class was corrected."""
    kinds = fused.kinds.copy()
    for number, (now, old) in enumerate(zip(fused.objects, before.objects, strict=True)):
        if now.kind != old.kind:
            kinds[fused.masks == number] = now.kind
    return dataclasses.replace(fused, kinds=kinds)


def _partners(seen: Decoded, box: np.ndarray, label: np.ndarray, same: float) -> np.ndarray:
    """(k,) number of the object that each box overlaps by `same`, -1 = none; pairs of the same class first, then those
    that overlap most."""
    out = np.full(len(box), -1)
    if not len(box) or not seen.objects:
        return out
    own = object_boxes(seen)
    shared = overlap(box, own)
    agree = np.stack([groups.confirmed(classes.names()[int(k)]) for k in label])[:, [o.kind for o in seen.objects]]
    rows, columns = np.nonzero(shared >= same)
    order = np.lexsort((columns, rows, -shared[rows, columns], ~agree[rows, columns]))
    free = np.ones(len(own), bool)
    for i, j in zip(rows[order], columns[order], strict=True):
        if out[i] < 0 and free[j]:
            out[i], free[j] = j, False
    return out


def object_boxes(seen: Decoded) -> np.ndarray:
    """(n, 4) left, top, right, bottom of the objects' masks; zeros for those without a pixel."""
    out = np.zeros((len(seen.objects), 4))
    rows, columns = np.nonzero(seen.masks >= 0)
    owner = seen.masks[rows, columns]
    for number in np.unique(owner):
        r, c = rows[owner == number], columns[owner == number]
        out[number] = c.min(), r.min(), c.max() + 1, r.max() + 1
    return out


def _not_repeated(
    fused: Decoded, new: list[tuple[float, Candidate]], options: FusionOptions
) -> list[tuple[float, Candidate]]:
    """The new objects without those that a surer object of a related class covers, be it new or the model's."""
    own = object_boxes(fused)
    kept: list[tuple[float, Candidate]] = []
    for score, one in sorted(new, key=lambda x: (-x[0], x[1].kind, *x[1].box)):
        related = groups.related(classes.names()[one.kind])
        surer = [own[k] for k, o in enumerate(fused.objects) if related[o.kind] and o.score >= score]
        surer += [other.box for _, other in kept if related[other.kind]]
        if not surer or overlap(one.box[None], np.array(surer)).max() < options.repeated:
            kept.append((score, one))
    return kept


def _with_new(fused: Decoded, new: list[tuple[float, Candidate]], options: FusionOptions) -> Decoded:
    """Draws new objects, those whose lower edge is lower later because they are nearer; what hangs is drawn last. Sure
    objects of the model whose lower edge is lower keep their pixels, except houses, trees and the like, which reach far
    along a street. An object of the model that loses half of its pixels was the same or none and is left out."""
    masks, kinds, depth = fused.masks.copy(), fused.kinds.copy(), fused.depth.copy()
    objects = list(fused.objects)
    bottom = object_boxes(fused)[:, 3]
    sure = np.array([o.score >= options.least and groups.compact()[o.kind] for o in objects], bool)
    for score, one in sorted(new, key=lambda x: (_nearness(x[1]), x[1].kind, *x[1].box)):
        mask, drawn = _mask(fused, one, options)
        front = np.flatnonzero(sure & (bottom > _nearness(one)))
        mask &= ~np.isin(fused.masks, front)
        if mask.sum() < options.min_pixels:
            continue
        masks[mask], kinds[mask] = len(objects), one.kind
        if drawn:
            depth[mask] = _depth(fused, one, mask)
        objects.append(_generic(one.kind, score))
    before, after = (np.bincount(m[m >= 0], minlength=len(objects)) for m in (fused.masks, masks))
    count = len(fused.objects)
    keep = [k for k in range(len(objects)) if after[k] and (k >= count or 2 * after[k] >= before[k])]
    number = np.full(len(objects) + 1, -1, np.int32)
    number[keep] = np.arange(len(keep))
    return Decoded(kinds, number[masks], tuple(objects[k] for k in keep), depth)


def _nearness(one: Candidate) -> float:
    """Row of the lower edge; what hangs has none on the ground and is in front of what it covers."""
    return float("inf") if classes.names()[one.kind] in groups.HANGING else float(one.box[3])


def _mask(seen: Decoded, one: Candidate, options: FusionOptions) -> tuple[np.ndarray, bool]:
    """(h, w) bool mask, and whether it is an ellipse because too few pixels have a related class."""
    out = np.zeros(seen.kinds.shape, bool)
    rows, columns = _span(one.box, seen.kinds.shape)
    inside = groups.related(classes.names()[one.kind])[seen.kinds[rows, columns]]
    if inside.mean() >= options.filled:
        r, c = np.nonzero(inside)
        covered = np.array([[c.min(), r.min(), c.max() + 1, r.max() + 1]], float)
        if overlap(covered, np.array([[0, 0, inside.shape[1], inside.shape[0]]], float))[0, 0] >= options.same:
            out[rows, columns] = inside
            return out, False
    y, x = np.mgrid[rows, columns] + 0.5
    left, top, right, bottom = one.box
    y, x = (2.0 * y - top - bottom) / (bottom - top), (2.0 * x - left - right) / (right - left)
    power = 6 if classes.names()[one.kind] in groups.BOXES else 2
    out[rows, columns] = np.abs(x) ** power + np.abs(y) ** power <= 1.0
    # An ellipse touches the box's sides only between pixels; its axes keep the mask as long and wide as the box.
    middle_row, middle_column = (rows.start + rows.stop) // 2, (columns.start + columns.stop) // 2
    out[middle_row, columns] = out[rows, middle_column] = True
    return out, True


def _depth(seen: Decoded, one: Candidate, mask: np.ndarray) -> float:
    """m, the depth of the ground just below the middle half of a box; without ground there, as for what hangs or
    reaches the image's lower edge, the median of the model's depth in the mask."""
    left, _, right, bottom = one.box
    quarter = (right - left) / 4.0
    rows = slice(min(int(np.ceil(bottom)), seen.kinds.shape[0]), int(np.ceil(bottom)) + 3)
    columns = slice(int(left + quarter), max(int(np.ceil(right - quarter)), int(left + quarter) + 1))
    kinds = seen.kinds[rows, columns]
    ground = (kinds > classes.SKY_CLASS) & (kinds < classes.FIRST_OBJECT)
    if classes.names()[one.kind] in groups.HANGING or not ground.any():
        return float(np.median(seen.depth[mask]))
    return float(np.median(seen.depth[rows, columns][ground]))


def _span(box: np.ndarray, shape: tuple[int, ...]) -> tuple[slice, slice]:
    """The pixels whose centres are in a box, at least one in each direction."""
    out = []
    for low, high, length in ((box[1], box[3], shape[0]), (box[0], box[2], shape[1])):
        first = int(np.clip(np.ceil(low - 0.5), 0, length - 1))
        last = int(np.clip(np.ceil(high - 0.5), first + 1, length))
        out.append(slice(first, last))
    return out[0], out[1]
