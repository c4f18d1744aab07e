"""Sees an image at two scales and merges the objects: small ones need the full size, large ones the view of the whole.

At half the size a building is as large as in a distant view, and its parts are not taken for objects. An object found
at both scales is one; how sure it is depends on both. docs/decisions/gen_perception.md has the scores.
"""

import dataclasses
from collections.abc import Callable

import jax
import numpy as np
from scipy.special import expit, logit

from .decode import COARSE, FINE, Decoded, FoundObject, decode
from .network import Seen


@dataclasses.dataclass(frozen=True)
class MergeOptions:
    """How the objects of two scales become those of an image.

    Attributes:
      fine, coarse: coefficients of `agreement` in the log odds that an object of the scale is right, fitted by
        `fit_trust` to the 1,955 and 1,440 objects in 96 frames of held-out streets.
      same: intersection over union of masks from which objects are one.
      most_covered: share of an object's pixels that surer objects may cover; chosen manually.
      min_pixels: output pixels that have to be left; smaller objects are dropped.
    """

    fine: tuple[float, ...] = (-0.03, 0.78, -0.67, 0.82, 0.29, -0.19, -0.01)
    coarse: tuple[float, ...] = (-0.67, 0.73, -0.97, 1.21, 0.41, -0.24, -0.47)
    same: float = 0.5
    most_covered: float = 0.6
    min_pixels: int = 12


_OPTIONS = MergeOptions()


def halved(images: jax.Array) -> jax.Array:
    """Images (n, H, W, 3) of half the size, each pixel from those that it covers."""
    n, height, width, channels = images.shape
    return jax.image.resize(images, (n, height // 2, width // 2, channels), "linear")


def outputs(apply: Callable[[jax.Array], Seen], images: jax.Array) -> tuple[Seen, Seen]:
    """A network's outputs for images (n, H, W, 3) in [0, 1] and for the same of half the size.

    Args:
      apply: the network; H and W are multiples of twice its stride.
    """
    return apply(images), apply(halved(images))


def decoded(fine: Seen, coarse: Seen, focal: float) -> Decoded:
    """Decodes and merges the outputs for one image; the surfaces and the depth are those of the full size.

    Args:
      fine, coarse: arrays of one image at full and half size, without the leading axis.
      focal: focal length at full size, pixels.
    """
    return merged(decode(fine, focal, FINE), decode(coarse, focal / 2.0, COARSE))


def merged(fine: Decoded, coarse: Decoded) -> Decoded:
    """One set of objects, the surest first; of an object found twice the surer detection stays, and overlapping
    objects share no pixels."""
    coarse = enlarged(coarse, *fine.masks.shape)
    candidates: list[tuple[FoundObject, np.ndarray]] = []
    for one, other, weights in ((fine, coarse, _OPTIONS.fine), (coarse, fine, _OPTIONS.coarse)):
        for number, (obj, features) in enumerate(zip(one.objects, agreement(one, other), strict=True)):
            sure = dataclasses.replace(obj, score=float(expit(np.dot(weights, features))))
            candidates.append((sure, one.masks == number))
    masks = np.full(fine.masks.shape, -1, np.int32)
    objects: list[FoundObject] = []
    for obj, mask in sorted(candidates, key=lambda x: -x[0].score):
        free = mask & (masks < 0)
        left, area = int(free.sum()), int(mask.sum())
        if left < max(_OPTIONS.min_pixels, (1.0 - _OPTIONS.most_covered) * area) or _is_double(masks, mask, area):
            continue
        masks[free] = len(objects)
        objects.append(obj)
    return dataclasses.replace(fine, masks=masks, objects=tuple(objects))


def _is_double(masks: np.ndarray, mask: np.ndarray, area: int) -> bool:
    """Whether a mask (h, w) of `area` pixels is one of the objects in `masks`."""
    inside = masks[mask]
    shared = np.bincount(inside[inside >= 0])
    if not len(shared):
        return False
    most = int(shared.argmax())
    return bool(shared[most] > _OPTIONS.same * (area + int((masks == most).sum()) - shared[most]))


def agreement(one: Decoded, other: Decoded) -> np.ndarray:
    """(n, 7) features of the objects of one scale: 1; log odds of the score; whether the other scale has no such
    object; whether it has one of the same class, and its log odds; and the same for another class.

    Args:
      other: at the same size.
    """
    n, m = len(one.objects), len(other.objects)
    out = np.zeros((n, 7))
    if not n:
        return out
    both = (one.masks >= 0) & (other.masks >= 0)
    shared = np.zeros((n, m))
    np.add.at(shared, (one.masks[both], other.masks[both]), 1.0)
    areas = [np.bincount(x.masks[x.masks >= 0], minlength=len(x.objects)) for x in (one, other)]
    iou = shared / np.maximum(areas[0][:, None] + areas[1] - shared, 1.0)
    odds, others = ([float(logit(np.clip(t.score, 1e-3, 1.0 - 1e-3))) for t in x.objects] for x in (one, other))
    for row, obj in enumerate(one.objects):
        best = int(iou[row].argmax()) if m else -1
        out[row, :2] = 1.0, odds[row]
        if best < 0 or iou[row, best] <= _OPTIONS.same:
            out[row, 2] = 1.0
        elif other.objects[best].kind == obj.kind:
            out[row, 3:5] = 1.0, others[best]
        else:
            out[row, 5:7] = 1.0, others[best]
    return out


def enlarged(seen: Decoded, height: int, width: int) -> Decoded:
    """The same at another size: every pixel takes the value at its place."""
    old_height, old_width = seen.masks.shape
    rows = np.minimum(((np.arange(height) + 0.5) * old_height / height).astype(int), old_height - 1)
    columns = np.minimum(((np.arange(width) + 0.5) * old_width / width).astype(int), old_width - 1)
    at = np.ix_(rows, columns)
    return dataclasses.replace(seen, kinds=seen.kinds[at], masks=seen.masks[at], depth=seen.depth[at])
