"""Training targets of the network for a rendered frame, and the loss. Runs inside jit."""

import dataclasses
from typing import NamedTuple

import jax
import jax.numpy as jnp

from . import classes
from .network import CANONICAL_FOCAL, DEPTH_UNIT, LEAF_STRIDE, OFFSET_UNIT, OUTPUT_STRIDE, Seen

#: Standard deviation of a centre's Gaussian, output pixels: half the 8 full-size pixels of Panoptic-DeepLab; half of
#: that for objects with fewer output pixels than `small_object`, so that adjacent ones have separate peaks.
SIGMA, SIGMA_SMALL = 4.0, 2.0
#: Instances with fewer output pixels have no centre, because they cannot be recognised.
MIN_PIXELS = 12
MIN_DEPTH, MAX_DEPTH = 0.2, 120.0  # m, depths that count


@dataclasses.dataclass(frozen=True)
class LossOptions:
    """Weights of pixels and of the parts of the loss.

    Panoptic-DeepLab's weights are 1 (classes), 200 (centres) and 0.01 per pixel of the full image (offsets; 0.32 in our
    unit). With about thirty objects per image, a centre weight of 200 would dominate the gradient. The offset's weight
    is doubled because half of the objects touch another. The other values are chosen manually;
    docs/decisions/gen_perception.md has the scores.

    Attributes:
      small_object: output pixels; smaller objects have the narrow Gaussian.
      reference_side: output pixels; the weight of an object's pixel is that of the ground times this over the square
        root of the object's area. Otherwise near objects and houses dominate the loss.
      min_weight: lower bound of that ratio.
      max_weight: upper bound of that ratio.
      narrow_weight: factor on errors near the narrow Gaussian, which has a quarter of the wide one's area.
      centre: weight of the centre map.
      offset: weight of the offset to the centre.
      depth: weight of the logarithm of depth.
      leaf: weight of the leaves.
      objects: weight of the mean over objects, which counts every object once, whatever its size, or by the weight of
        its class.
    """

    small_object: float = 200.0
    reference_side: float = 120.0
    min_weight: float = 1.0
    max_weight: float = 8.0
    narrow_weight: float = 3.0
    centre: float = 50.0
    offset: float = 0.64
    depth: float = 0.5
    leaf: float = 0.3
    objects: float = 0.6


_OPTIONS = LossOptions()


class GroundTruth(NamedTuple):
    """Targets at output size h x w: class (h, w) i32; leaf (h, w) i32, its number in `classes.leaves()`, -1 = none;
    weight (h, w) of a pixel; owner (h, w) i32, the object's slot, -1 = no object; centre (h, w) and its weights; offset
    (h, w, 2) and the pixels where it applies; log_depth (h, w) and the pixels where it applies."""

    classes: jax.Array
    leaf: jax.Array
    weight: jax.Array
    owner: jax.Array
    centre: jax.Array
    centre_weight: jax.Array
    offset: jax.Array
    has_centre: jax.Array
    log_depth: jax.Array
    has_depth: jax.Array


def ground_truth(
    category: jax.Array, slot: jax.Array, depth: jax.Array, focal: jax.Array, table: jax.Array, slots: int
) -> GroundTruth:
    """Computes the targets of one frame.

    Args:
      category, slot: (H, W) i32 as rendered, -1 = sky.
      depth: (H, W) m.
      focal: () pixels of the full image.
      table: `classes.class_table` of the bank.
      slots: how many visual slots its scenes have.
    """
    # Of the four pixels of an output pixel the lower right one, whose first ray is nearest to their centre.
    category, slot, depth = (x[1::OUTPUT_STRIDE, 1::OUTPUT_STRIDE] for x in (category, slot, depth))
    kind, leaf = table[category, 0], table[category, 1]
    obj = kind >= classes.FIRST_OBJECT
    owner = jnp.where(obj, slot, slots)
    h, w = kind.shape
    rows, columns = jnp.mgrid[:h, :w].astype(jnp.float32)
    count = jax.ops.segment_sum(jnp.ones(h * w), owner.ravel(), slots + 1)
    middle = jnp.stack(
        [jax.ops.segment_sum(x.ravel(), owner.ravel(), slots + 1) / jnp.maximum(count, 1.0) for x in (rows, columns)],
        -1,
    )
    big = (count >= MIN_PIXELS) & (jnp.arange(slots + 1) < slots)
    to_middle = middle[owner] - jnp.stack([rows, columns], -1)
    valid = (depth > MIN_DEPTH) & (depth < MAX_DEPTH)
    small = count < _OPTIONS.small_object
    narrow = _bumps(middle, big & small, h, w, SIGMA_SMALL)
    heavier = jnp.clip(
        _OPTIONS.reference_side / jnp.sqrt(jnp.maximum(count[owner], 1.0)), _OPTIONS.min_weight, _OPTIONS.max_weight
    )
    canonical = jnp.clip(depth, MIN_DEPTH, MAX_DEPTH) * CANONICAL_FOCAL / focal
    return GroundTruth(
        classes=kind,
        leaf=leaf,
        weight=jnp.where(obj, heavier, 1.0),
        owner=jnp.where(obj, slot, -1),
        centre=jnp.maximum(narrow, _bumps(middle, big & ~small, h, w, SIGMA)),
        centre_weight=1.0 + _OPTIONS.narrow_weight * jnp.sqrt(narrow),
        offset=to_middle / OFFSET_UNIT,
        has_centre=obj & big[owner],
        log_depth=jnp.log(canonical / DEPTH_UNIT),
        has_depth=valid & (kind != classes.SKY_CLASS),
    )


def without(wanted: GroundTruth, hidden: jax.Array) -> GroundTruth:
    """The targets without the pixels `hidden` (..., h, w) bool, which then have no part in the loss."""
    shown = (~hidden).astype(wanted.weight.dtype)
    return wanted._replace(
        weight=wanted.weight * shown,
        centre_weight=wanted.centre_weight * shown,
        has_centre=wanted.has_centre & ~hidden,
        has_depth=wanted.has_depth & ~hidden,
    )


def _bumps(middle: jax.Array, valid: jax.Array, h: int, w: int, sigma: float) -> jax.Array:
    """(h, w), Gaussian of the distance to the nearest centre, 1 at every centre."""
    far, reach = 1e6, round(3 * sigma)
    at = jnp.round(middle).astype(jnp.int32)
    distance = jnp.full((h, w), far).at[at[:, 0], at[:, 1]].min(jnp.where(valid, 0.0, far), mode="drop")
    # Squared distance to the nearest centre, computed one axis after the other.
    for axis in (0, 1):
        padded = jnp.pad(distance, [(reach, reach) if a == axis else (0, 0) for a in (0, 1)], constant_values=far)
        size = distance.shape[axis]

        def nearer(i: jax.Array, best: jax.Array, padded=padded, size=size, axis=axis) -> jax.Array:
            shifted = jax.lax.dynamic_slice_in_dim(padded, i, size, axis=axis)
            return jnp.minimum(best, shifted + jnp.square(i - reach).astype(jnp.float32))

        distance = jax.lax.fori_loop(0, 2 * reach + 1, nearer, jnp.full((h, w), far + reach**2))
    return jnp.exp(-distance / (2.0 * sigma**2))


def loss(
    seen: Seen, wanted: GroundTruth, counts: jax.Array, balance: jax.Array | None = None
) -> tuple[jax.Array, dict[str, jax.Array]]:
    """Loss () of a batch, and its parts.

    Args:
      seen, wanted: with a leading axis n.
      counts: (n,) 0 for frames without objects, such as a wall's inside.
      balance: (C,) weight of an object by class; None: 1.
    """
    balance = jnp.ones(seen.classes.shape[-1]) if balance is None else balance
    weight = counts[:, None, None] * jnp.ones_like(seen.centre)
    total = jnp.maximum(weight.sum(), 1.0)
    log_p = jax.nn.log_softmax(seen.classes)
    miss = -_at(log_p, wanted.classes)
    heavier = wanted.weight * weight
    # Focal weighting (Lin et al., 2017) with exponent 1 reduces the weight of large uniform areas.
    focal = jax.lax.stop_gradient(1.0 - jnp.exp(-miss))
    parts = {
        "classes": (heavier * focal * miss).sum() / total,
        "centre": _OPTIONS.centre * (weight * wanted.centre_weight * (seen.centre - wanted.centre) ** 2).sum() / total,
        "offset": _OPTIONS.offset * _mean(jnp.abs(seen.offset - wanted.offset).sum(-1), wanted.has_centre * heavier),
        "depth": _OPTIONS.depth * _mean(jnp.abs(seen.log_depth - wanted.log_depth), wanted.has_depth * weight),
    }
    parts["objects"] = _OPTIONS.objects * _object_loss(log_p, wanted, counts, balance)
    parts["leaves"] = _OPTIONS.leaf * _leaf_loss(jnp.asarray(seen.leaves), wanted, weight)
    return sum(parts.values(), jnp.zeros(())), parts


#: Slots of objects that `_object_loss` distinguishes; the numbers of others are taken modulo it.
_SLOTS = 1024
#: Integers per unit of probability in `_object_means`: sums over an image of 65,000 output pixels are below 2^31.
_LEVELS = 2**15


def _at(values: jax.Array, number: jax.Array) -> jax.Array:
    """(...), of values (..., C) those at the numbers (...) i32 in [0, C).

    A sum over C: the gradient of an index is a scatter of floats, which compiles to a sort where XLA has to choose
    convolutions without trials (`train_perception`).
    """
    return jnp.where(number[..., None] == jnp.arange(values.shape[-1]), values, 0.0).sum(-1)


@jax.custom_vjp
def _object_means(p: jax.Array, number: jax.Array, size: jax.Array) -> jax.Array:
    """(_SLOTS,) mean of probabilities p (N,) over the pixels of each object.

    Args:
      number: (N,) i32 object of each pixel, `_SLOTS` for none.
      size: (_SLOTS,) number of pixels.
    """
    # Integers have the same sum in any order, see `_at`; rounding changes a mean by less than 1 / (2 `_LEVELS`).
    total = jax.ops.segment_sum(jnp.round(p * _LEVELS).astype(jnp.int32), number, _SLOTS + 1)[:-1]
    return total / (_LEVELS * jnp.maximum(size, 1.0))


def _object_means_forward(
    p: jax.Array, number: jax.Array, size: jax.Array
) -> tuple[jax.Array, tuple[jax.Array, jax.Array]]:
    return _object_means(p, number, size), (number, size)


def _object_means_backward(kept: tuple[jax.Array, jax.Array], slope: jax.Array) -> tuple[jax.Array, None, None]:
    number, size = kept
    return jnp.append(slope / jnp.maximum(size, 1.0), 0.0)[number], None, None


_object_means.defvjp(_object_means_forward, _object_means_backward)


def _object_loss(log_p: jax.Array, wanted: GroundTruth, counts: jax.Array, balance: jax.Array) -> jax.Array:
    """(), mean over objects, weighted by class, of -log of the mean probability of the right class over the object's
    pixels: objects are decoded by that mean."""
    right = jnp.exp(_at(log_p, wanted.classes))

    def one(p: jax.Array, owner: jax.Array, kinds: jax.Array, applies: jax.Array) -> tuple[jax.Array, jax.Array]:
        number = jnp.where((owner >= 0) & applies, owner % _SLOTS, _SLOTS).ravel()
        size = jax.ops.segment_sum(jnp.ones_like(number), number, _SLOTS + 1)[:-1].astype(p.dtype)
        mean = _object_means(p.ravel(), number, size)
        # The largest class number of its pixels: all pixels of an object have the same.
        kind = jnp.maximum(jax.ops.segment_max(kinds.ravel(), number, _SLOTS + 1)[:-1], 0)
        counted = (size >= MIN_PIXELS) * balance[kind]
        return -(jnp.log(jnp.maximum(mean, 1e-3)) * counted).sum(), counted.sum()

    misses, objects = jax.vmap(one)(right, wanted.owner, wanted.classes, wanted.weight > 0)
    return (misses * counts).sum() / jnp.maximum((objects * counts).sum(), 1.0)


def _leaf_loss(logits: jax.Array, wanted: GroundTruth, weight: jax.Array) -> jax.Array:
    """(), cross-entropy of the right leaf among those of the right class, over pixels that have one."""
    leaf, kind, weight = (
        x[:, ::LEAF_STRIDE, ::LEAF_STRIDE] for x in (wanted.leaf, wanted.classes, weight * wanted.weight)
    )
    of_class = jnp.asarray(classes.leaf_classes()) == kind[..., None]
    log_p = jax.nn.log_softmax(jnp.where(of_class, logits, -30.0))
    miss = -_at(log_p, jnp.maximum(leaf, 0))
    return _mean(miss, weight * (leaf >= 0))


def _mean(x: jax.Array, weight: jax.Array) -> jax.Array:
    return (x * weight).sum() / jnp.maximum(weight.sum(), 1.0)
