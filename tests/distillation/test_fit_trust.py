"""How far the perception model's objects are to be trusted."""

import numpy as np

from urbanverse_mjx.distillation import fit_trust
from urbanverse_mjx.distillation.perception_model.decode import Decoded, FoundObject

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
