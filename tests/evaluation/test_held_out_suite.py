"""Scores of a suite belong to the conditions with which its benchmarks were frozen."""

import types

import pytest
from ml_collections import ConfigDict

from tests.support.box_bank import box_bank
from urbanverse_mjx.datatypes.validation import ValidationError
from urbanverse_mjx.evaluation.held_out import Suite


def _env(**config: str) -> types.SimpleNamespace:
    return types.SimpleNamespace(config=ConfigDict(config))


@pytest.mark.parametrize(
    ("frozen", "config", "fits"),
    [
        ("uniform", {"friction": "uniform"}, True),
        ("uniform", {}, True),  # configs saved before the key existed
        ("uniform", {"friction": "materials"}, False),
        ("materials", {"friction": "materials"}, True),
        ("materials", {}, False),
        (None, {"friction": "materials"}, True),
        (None, {}, True),
    ],
)
def test_scores_on_other_ground_than_the_frozen_one_are_refused(
    frozen: str | None, config: dict[str, str], fits: bool
) -> None:
    suite = Suite(box_bank(1), {}, {}, frozen)
    if fits:
        suite.check(_env(**config))
        return
    with pytest.raises(ValidationError, match=f"needed '{frozen}', with which the benchmarks were frozen"):
        suite.check(_env(**config))
    with pytest.raises(ValidationError, match=f'pass the environment option friction="{frozen}"'):
        suite.score(_env(**config), "agent", None)
