"""How far the perception model's objects are to be trusted."""

import pathlib

import numpy as np
import pytest

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.distillation import fit_trust
from urbanverse_mjx.distillation.perception_model.decode import Decoded, FoundObject
from urbanverse_mjx.distillation.train_perception import Frame

CAR, PERSON = 7, 9


def test_the_coefficients_that_made_the_answers_are_found_again():
    rng = np.random.default_rng(0)
    true = np.array([-1.0, 2.0, -0.5])
    evidence = np.column_stack([np.ones(20_000), rng.normal(size=(20_000, 2))])
    is_right = rng.random(20_000) < 1.0 / (1.0 + np.exp(-evidence @ true))
    np.testing.assert_allclose(fit_trust.fit(evidence, is_right), true, atol=0.1)


def test_evidence_that_settles_everything_keeps_coefficients_finite():
    evidence = np.column_stack([np.ones(40), np.linspace(-1, 1, 40)])
    found = fit_trust.fit(evidence, evidence[:, 1] > 0)
    assert np.isfinite(found).all()
    assert found[1] > 1.0


def test_a_object_is_right_by_half_of_its_mask_and_its_class():
    owner, kinds = np.full((20, 30), -1), np.zeros((20, 30), int)
    owner[:10, :10], owner[:10, 15:25], owner[12:18, :10] = 0, 1, 2
    kinds[owner >= 0] = CAR
    masks = np.full((20, 30), -1)
    masks[:8, :10] = 0  # four fifths of a car
    masks[:10, 15:18] = 1  # a third of one
    masks[12:18, :10] = 2  # all of one, called a person
    masks[12:18, 20:25] = 3  # nothing there
    objects = (
        FoundObject(CAR, 1.0, 0),
        FoundObject(CAR, 1.0, 0),
        FoundObject(PERSON, 1.0, 0),
        FoundObject(CAR, 1.0, 0),
    )
    seen = Decoded(kinds, masks, objects, np.ones(kinds.shape))
    np.testing.assert_array_equal(fit_trust.right(seen, kinds, owner), [True, False, False, False])


def test_calibrations_of_both_scales_and_of_their_agreement_are_fitted():
    """An object is right where its peak is high; at half size it is right, too, where the full size agrees."""
    rng = np.random.default_rng(1)
    frames = []
    for _ in range(60):
        owner, kinds = np.full((20, 80), -1), np.zeros((20, 80), int)
        masks, fine, coarse = np.full((20, 80), -1), [], []
        for k in range(8):
            place = np.s_[2:12, 10 * k : 10 * k + 8]
            high, is_car = rng.normal(), rng.random() < 0.5
            if rng.random() < 1.0 / (1.0 + np.exp(-2.0 * high)):
                owner[place], kinds[place] = k, CAR if is_car else PERSON
            masks[place] = k
            kind = CAR if is_car else PERSON
            fine.append(FoundObject(kind, 0.5, 0, (1.0, float(high))))
            same = rng.random() < 0.5
            coarse.append(FoundObject(kind if same else CAR + PERSON - kind, 0.5, 0, (1.0, float(rng.normal()))))
        seen = (Decoded(kinds, masks, tuple(x), np.ones(kinds.shape)) for x in (fine, coarse))
        frames.append(tuple(Frame(s, kinds, owner, np.ones(kinds.shape), kinds) for s in seen))
    table = fit_trust.calibration(frames, pathlib.Path("streets.npz"))
    assert table["fine objects"][0] == table["coarse objects"][0] == 480
    assert table["fine trust"][1] == pytest.approx(2.0, abs=0.6)
    assert abs(table["coarse trust"][1]) < 0.4
    # What the full size is sure of helps the half, if it is the same class and not otherwise.
    same, other = table["coarse merged"][4], table["coarse merged"][6]
    assert same > 0.5 > other


def test_a_scale_without_objects_is_refused():
    nothing = Decoded(np.zeros((4, 4), int), np.full((4, 4), -1), (), np.ones((4, 4)))
    frame = Frame(nothing, nothing.kinds, nothing.masks, nothing.depth, nothing.kinds)
    with pytest.raises(ValidationError, match="found no objects in 1 frames"):
        fit_trust.calibration([(frame, frame)], pathlib.Path("streets.npz"))
