"""Objects of an image at two scales become one set."""

import dataclasses

import jax.numpy as jnp
import numpy as np
import pytest

from urbanverse_mjx.distillation.perception_model import classes, scales
from urbanverse_mjx.distillation.perception_model.decode import Decoded, FoundObject
from urbanverse_mjx.distillation.perception_model.network import (
    CANONICAL_FOCAL,
    DEPTH_UNIT,
    LEAF_STRIDE,
    OFFSET_UNIT,
    Seen,
)

CAR, PERSON = (classes.names().index(n) for n in ("car", "pedestrian adult"))


def _seen(
    boxes: list[tuple[int, float, tuple[slice, slice]]], shape: tuple[int, int] = (40, 60), depth: float = 1.0
) -> Decoded:
    """Objects of a class and a score in boxes; later ones cover earlier ones."""
    masks = np.full(shape, -1, np.int32)
    for number, (_, _, box) in enumerate(boxes):
        masks[box] = number
    objects = tuple(FoundObject(kind, sure, 0) for kind, sure, _ in boxes)
    return Decoded(np.full(shape, 2, np.int32), masks, objects, np.full(shape, depth, np.float32))


def test_an_object_found_at_both_scales_is_one_and_surer():
    box, half = np.s_[10:30, 20:40], np.s_[5:15, 10:20]
    twice = scales.merged(_seen([(CAR, 0.6, box)]), _seen([(CAR, 0.6, half)], (20, 30)))
    once = scales.merged(_seen([(CAR, 0.6, box)]), _seen([], (20, 30)))
    otherwise = scales.merged(_seen([(CAR, 0.6, box)]), _seen([(PERSON, 0.6, half)], (20, 30)))
    for found in (twice, once, otherwise):
        assert len(found.objects) == 1
        assert found.objects[0].kind == CAR
        assert (found.masks == 0).sum() == 400
    assert twice.objects[0].score > max(once.objects[0].score, otherwise.objects[0].score)


def test_objects_of_either_scale_are_kept_where_the_other_has_none():
    found = scales.merged(
        _seen([(PERSON, 0.9, np.s_[10:20, 5:10])], depth=7.0), _seen([(CAR, 0.8, np.s_[5:15, 15:25])], (20, 30), 3.0)
    )
    assert [x.kind for x in found.objects] == [PERSON, CAR]
    assert (found.masks == 1).sum() == 400
    assert (found.masks[10:30, 30:50] == 1).all()
    # Surfaces and depth are those of the full size.
    assert (found.depth == 7.0).all()
    assert found.kinds.shape == (40, 60)


def test_overlapping_objects_share_no_pixels_and_covered_ones_go():
    wall = (CAR, 0.95, np.s_[0:40, 0:40])
    partly = _seen([(PERSON, 0.6, np.s_[5:15, 15:25])], (20, 30))  # columns 30 to 50 of the full size: half is free
    found = scales.merged(_seen([wall]), partly)
    assert [x.kind for x in found.objects] == [CAR, PERSON]
    assert (found.masks == 0).sum() == 1600
    assert (found.masks == 1).sum() == 200
    mostly = _seen([(PERSON, 0.6, np.s_[5:15, 11:21])], (20, 30))  # columns 22 to 42: nine tenths are covered
    assert [x.kind for x in scales.merged(_seen([wall]), mostly).objects] == [CAR]


@pytest.mark.parametrize("kind", [CAR, PERSON])
def test_agreement_tells_alone_from_same_and_from_another(kind: int):
    box = np.s_[0:10, 0:10]
    one, other = _seen([(CAR, 0.8, box), (CAR, 0.5, np.s_[20:30, 0:10])]), _seen([(kind, 0.9, box)])
    first, second = scales.agreement(one, other)
    odds, others = np.log(4.0), np.log(9.0)
    same = [1.0, others, 0.0, 0.0] if kind == CAR else [0.0, 0.0, 1.0, others]
    np.testing.assert_allclose(first, [1.0, odds, 0.0, *same], atol=1e-6)
    np.testing.assert_allclose(second, [1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0], atol=1e-6)
    assert scales.agreement(dataclasses.replace(one, objects=(), masks=other.masks * 0 - 1), other).shape == (0, 7)


def _outputs(shape: tuple[int, int], miss: float) -> Seen:
    """A car whose pixels point past its peak by `miss` output pixels, or nothing where that is infinite."""
    kinds, centre, offset = np.full(shape, 1), np.zeros(shape, np.float32), np.zeros((*shape, 2), np.float32)
    if np.isfinite(miss):
        height, width = shape
        rows, columns = np.mgrid[height // 4 : height // 2, width // 4 : width // 2]
        middle = rows.min() + len(rows) // 2, columns.min() + rows.shape[1] // 2
        kinds[rows, columns], centre[middle] = CAR, 1.0
        offset[rows, columns] = np.stack([middle[0] - rows, middle[1] + miss - columns], -1) / OFFSET_UNIT
    leaves = np.zeros((shape[0] // LEAF_STRIDE, shape[1] // LEAF_STRIDE, len(classes.leaves())), np.float32)
    return Seen(8.0 * np.identity(len(classes.names()))[kinds], centre, offset, np.zeros(shape), leaves)


def test_pixels_may_miss_a_peak_by_as_much_of_the_image_at_both_scales():
    nothing = float("inf")
    large, small = (40, 60), (20, 30)
    for fine, coarse, found in ((20.0, nothing, 1), (28.0, nothing, 0), (nothing, 8.0, 1), (nothing, 20.0, 0)):
        seen = scales.decoded(_outputs(large, fine), _outputs(small, coarse), 2.0 * CANONICAL_FOCAL)
        assert len(seen.objects) == found, (fine, coarse)
        # Of the full size: an image of twice the canonical focal length shows twice the canonical depth.
        np.testing.assert_allclose(seen.depth, 2.0 * DEPTH_UNIT, rtol=1e-6)


def test_half_of_the_size_is_the_mean_of_what_a_pixel_covers():
    rng = np.random.default_rng(0)
    images = rng.random((2, 8, 12, 3)).astype(np.float32)
    small = np.asarray(scales.halved(jnp.asarray(images)))
    assert small.shape == (2, 4, 6, 3)
    np.testing.assert_allclose(small.mean(), images.mean(), atol=0.02)
    stripes = np.tile(np.arange(12) % 2, (1, 8, 1))[..., None].repeat(3, -1).astype(np.float32)
    np.testing.assert_allclose(np.asarray(scales.halved(jnp.asarray(stripes)))[:, :, 1:-1], 0.5, atol=1e-5)
    flat = np.asarray(scales.halved(jnp.full((1, 8, 12, 3), 0.25)))
    np.testing.assert_allclose(flat, 0.25, atol=1e-6)


def test_a_detection_half_as_large_again_is_no_second_object():
    """Its uncovered part would be large enough to stay."""
    found = scales.merged(_seen([(CAR, 0.9, np.s_[10:30, 0:20])]), _seen([(CAR, 0.6, np.s_[5:15, 0:19])], (20, 30)))
    assert len(found.objects) == 1
    assert (found.masks == 0).sum() == 400


def test_the_surer_object_has_the_pixels_that_both_scales_claim():
    fine, coarse = _seen([(PERSON, 0.4, np.s_[0:20, 0:20])]), _seen([(CAR, 0.99, np.s_[0:10, 7:17])], (20, 30))
    found = scales.merged(fine, coarse)
    assert [x.kind for x in found.objects] == [CAR, PERSON]
    assert (found.masks == 0).sum() == 400
    assert (found.masks == 1).sum() == 20 * 14


def test_each_scale_has_its_own_calibration():
    box, half, nothing = np.s_[10:30, 20:40], np.s_[5:15, 10:20], _seen([], (20, 30))
    fine = scales.merged(_seen([(CAR, 0.6, box)]), nothing).objects[0].score
    coarse = scales.merged(_seen([]), _seen([(CAR, 0.6, half)], (20, 30))).objects[0].score
    alone = np.array([1.0, np.log(1.5), 1.0, 0.0, 0.0, 0.0, 0.0])
    options = scales.MergeOptions()
    assert fine == pytest.approx(1.0 / (1.0 + np.exp(-alone @ options.fine)))
    assert coarse == pytest.approx(1.0 / (1.0 + np.exp(-alone @ options.coarse)))
