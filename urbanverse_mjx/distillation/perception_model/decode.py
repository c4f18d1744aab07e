"""Decodes the network's outputs: every peak of the centre map is an object that consists of the pixels pointing to
it."""

import dataclasses

import numpy as np
from scipy import ndimage
from scipy.spatial import cKDTree
from scipy.special import expit, logit

from . import classes
from .network import CANONICAL_FOCAL, DEPTH_UNIT, LEAF_STRIDE, OFFSET_UNIT, Seen


@dataclasses.dataclass(frozen=True)
class DecodeOptions:
    """Options for grouping pixels into objects; lengths in output pixels.

    Height and window of peaks are those of Panoptic-DeepLab (Cheng et al., 2020); numbers of objects and pixels were
    chosen manually.

    Attributes:
      min_peak: least height of a peak.
      peak_window: side of the window of which a peak is the maximum.
      max_objects: largest number of objects in an image, the highest peaks first.
      min_pixels: smaller objects are dropped.
      max_miss: largest distance between the position to which a pixel points and the peak it is assigned to;
        chosen on captures and test streets (docs/decisions/gen_perception.md).
      trust: coefficients of the evidence in the log odds that an object is right (its class and half of its mask),
        fitted by `fit_trust` to what the shipped weights detect in frames of held-out streets.
      min_belief, max_beliefs: least probability of a leaf that an object keeps, and how many it keeps.
    """

    min_peak: float = 0.1
    peak_window: int = 7
    max_objects: int = 200
    min_pixels: int = 12
    max_miss: float = 24.0
    trust: tuple[float, float, float, float, float] = (-3.68, 0.88, 2.34, -4.68, 2.38)
    min_belief: float = 0.02
    max_beliefs: int = 12


#: Options for images of the network's size and of half of it (`scales`).
FINE = DecodeOptions()
COARSE = DecodeOptions(max_miss=12.0, trust=(-5.49, 1.19, 3.04, -3.41, 3.26))


@dataclasses.dataclass(frozen=True)
class FoundObject:
    """One object in one image: number of its class, probability in [0, 1] that it is right, the most similar of
    `classes.leaves()`, the features behind the probability (see `_evidence`), the network's share of belief in that
    leaf among those of the class, and the likely leaves of all classes with their probabilities, likeliest first."""

    kind: int
    score: float
    leaf: int
    evidence: tuple[float, ...] = ()
    certainty: float = 1.0
    beliefs: tuple[tuple[int, float], ...] = ()


@dataclasses.dataclass(frozen=True)
class Decoded:
    """The decoded outputs for one image, at the outputs' size.

    kinds: (h, w) i32 class of every pixel; masks: (h, w) i32 index into `objects`, -1 = none;
    depth: (h, w) f32 m along the camera's axis, the sky included.
    """

    kinds: np.ndarray
    masks: np.ndarray
    objects: tuple[FoundObject, ...]
    depth: np.ndarray

    def surer(self, cut: float) -> "Decoded":
        """Removes the objects whose score is below `cut`."""
        kept = [k for k, obj in enumerate(self.objects) if obj.score >= cut]
        number = np.full(len(self.objects) + 1, -1, np.int32)
        number[kept] = np.arange(len(kept))
        return dataclasses.replace(self, masks=number[self.masks], objects=tuple(self.objects[k] for k in kept))


def decode(seen: Seen, focal: float, options: DecodeOptions = FINE) -> Decoded:
    """Decodes the outputs for one image.

    Args:
      seen: arrays of one image, without the leading axis.
      focal: focal length of the network's input image, pixels.
      options: those of the image's size.
    """
    p = np.exp(seen.classes - seen.classes.max(-1, keepdims=True))
    p /= p.sum(-1, keepdims=True)
    kinds = p.argmax(-1).astype(np.int32)
    masks, objects = _group(kinds, p, seen, _peaks(np.asarray(seen.centre), options), options)
    depth = DEPTH_UNIT * np.exp(np.clip(seen.log_depth, -6.0, 6.0)) * (focal / CANONICAL_FOCAL)
    return Decoded(kinds, masks, objects, depth.astype(np.float32))


def _peaks(centre: np.ndarray, options: DecodeOptions) -> np.ndarray:
    """(k, 2) rows and columns of the highest peaks."""
    top = (centre == ndimage.maximum_filter(centre, options.peak_window)) & (centre > options.min_peak)
    where = np.argwhere(top)
    order = np.argsort(-centre[top], kind="stable")
    return where[order[: options.max_objects]]


def _group(
    kinds: np.ndarray, p: np.ndarray, seen: Seen, peaks: np.ndarray, options: DecodeOptions
) -> tuple[np.ndarray, tuple[FoundObject, ...]]:
    """Groups pixels into masks and objects. A house and an object in front of it are never merged, though they may
    share a centre."""
    masks = np.full(kinds.shape, -1, np.int32)
    rows, columns = np.nonzero(kinds >= classes.FIRST_OBJECT)
    if not len(peaks) or not len(rows):
        return masks, ()
    aim = np.column_stack([rows, columns]) + seen.offset[rows, columns] * OFFSET_UNIT
    miss, owner = cKDTree(peaks).query(aim)
    heights = np.asarray(seen.centre)[peaks[:, 0], peaks[:, 1]]
    found = kinds[rows, columns]
    group = np.where(miss <= options.max_miss, 2 * owner + (found == classes.HOUSE), -1)
    order = np.argsort(group, kind="stable")
    objects: list[FoundObject] = []
    for part in np.split(order, np.flatnonzero(np.diff(group[order])) + 1):
        if group[part[0]] < 0 or len(part) < options.min_pixels:
            continue
        votes = p[rows[part], columns[part]].mean(0)
        is_house = found[part[0]] == classes.HOUSE
        votes[: classes.FIRST_OBJECT] = 0.0
        kind = classes.HOUSE if is_house else int(votes.argmax())
        if kind == classes.FIRST_OBJECT:
            continue
        masks[rows[part], columns[part]] = len(objects)
        likeness = np.asarray(seen.leaves)[rows[part] // LEAF_STRIDE, columns[part] // LEAF_STRIDE].mean(0)
        own = np.where(classes.leaf_classes() == kind, likeness, -np.inf)
        leaf = int(own.argmax())
        certainty = float(1.0 / np.exp(own - own[leaf]).sum())
        evidence = _evidence(votes[kind], float(heights[owner[part[0]]]), rows[part], columns[part], miss[part].mean())
        right = float(expit(np.dot(options.trust, evidence)))
        objects.append(FoundObject(kind, right, leaf, evidence, certainty, _beliefs(votes, likeness, options)))
    return masks, tuple(objects)


def _beliefs(votes: np.ndarray, likeness: np.ndarray, options: DecodeOptions) -> tuple[tuple[int, float], ...]:
    """The likely leaves of an object: the probability of each class among those of objects, times that of the leaf
    within it.

    Args:
      votes: (C,) mean probability of each class.
      likeness: (L,) logits of the leaves.
    """
    kinds = classes.leaf_classes()
    among = votes[kinds] / votes[classes.FIRST_OBJECT + 1 :].sum()
    starts = np.flatnonzero(np.diff(kinds, prepend=-1))
    group = np.repeat(np.arange(len(starts)), np.diff(starts, append=len(kinds)))
    share = np.exp(likeness - np.maximum.reduceat(likeness, starts)[group])
    p = among * share / np.add.reduceat(share, starts)[group]
    order = np.argsort(-p, kind="stable")[: options.max_beliefs]
    return tuple((int(k), float(p[k])) for k in order if p[k] >= options.min_belief)


def _evidence(vote: float, height: float, rows: np.ndarray, columns: np.ndarray, miss: float) -> tuple[float, ...]:
    """Features of an object: 1; log odds of its class; its peak's height; `miss`, the mean distance (output pixels) by
    which its pixels point past the peak, over the side of a square of equal area; and the share of its pixels in the
    largest connected part.

    False regions between two objects point to no centre and are disconnected.
    """
    inside = np.zeros((np.ptp(rows) + 1, np.ptp(columns) + 1), bool)
    inside[rows - rows.min(), columns - columns.min()] = True
    pieces, _ = ndimage.label(inside)
    largest = np.bincount(pieces[inside]).max() / len(rows)
    return 1.0, float(logit(np.clip(vote, 0.001, 0.999))), height, miss / len(rows) ** 0.5, float(largest)
