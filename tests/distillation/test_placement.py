"""Buildings whose lower end no view shows stand at the height of the ground before them."""

import numpy as np
import pytest

from urbanverse_mjx.datatypes import GroundRegion, LabelPrior
from urbanverse_mjx.distillation import placement
from urbanverse_mjx.distillation.boxes import Box

PAVEMENT = GroundRegion(
    "pavement", "sidewalk", ((0.0, -20.0), (3.0, -20.0), (3.0, 20.0), (0.0, 20.0)), (0.03, 0.02, 0.1)
)
HOUSE = LabelPrior(np.array([[8.0, 10.0, 7.0]]), faces_road=True)


def _box(x: float) -> Box:
    """A house along y whose front is at `x`, seen from 0.5 m to 7 m above zero."""
    center, size = np.array([x - 4.0, 5.0, 3.75]), np.array([8.0, 10.0, 6.5])
    return Box(center, size, 0.0, 0.1, 0.05, (True, False, False), size)


@pytest.mark.parametrize("gap", [0.2, 4.5])
def test_a_building_without_ground_below_stands_at_the_height_of_the_nearest(gap: float) -> None:
    box = _box(-gap)
    _, floor = placement.place_on_ground([box], [HOUSE], (PAVEMENT,), exact=False)
    # The plane at the point of the pavement that is nearest to the house's middle.
    assert floor[0] == pytest.approx(0.1 + 0.02 * 5.0)
    center, size = placement.stand(box, floor[0], HOUSE)
    assert center[2] - size[2] / 2 == pytest.approx(0.2)
    assert center[2] + size[2] / 2 == pytest.approx(7.0)


def test_distant_ground_exact_masks_and_other_objects_leave_the_height_open() -> None:
    post = LabelPrior(np.array([[8.0, 10.0, 7.0]]))
    assert np.isnan(placement.place_on_ground([_box(-5.5)], [HOUSE], (PAVEMENT,), exact=False)[1][0])
    assert np.isnan(placement.place_on_ground([_box(-0.2)], [HOUSE], (PAVEMENT,), exact=True)[1][0])
    assert np.isnan(placement.place_on_ground([_box(-0.2)], [post], (PAVEMENT,), exact=False)[1][0])
