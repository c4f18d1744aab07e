"""Which scenes of a bank a training of gaits uses."""

import types

import numpy as np
import pytest

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.envs.joystick import schedule


def test_kinds_without_a_share_are_left_out_whatever_levels_they_have() -> None:
    bank = types.SimpleNamespace(scene_ids=["flat-1", "rough-0", "kerbs-0", "flat-0", "kerbs-1", "street"])
    shares = {"flat": 1.0, "kerbs": 3.0, "rough": 0.0}
    kinds, table, weights = schedule._terrain_table(bank, shares)  # pyright: ignore[reportArgumentType]
    assert kinds == ("flat", "kerbs")
    np.testing.assert_array_equal(table, [[3, 0], [2, 4]])
    np.testing.assert_allclose(weights, [0.25, 0.75])
    with pytest.raises(ValidationError, match="all with the same levels"):
        schedule._terrain_table(bank, {**shares, "rough": 1.0})  # pyright: ignore[reportArgumentType]
