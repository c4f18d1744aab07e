"""Scores of a suite belong to the conditions with which its benchmarks were frozen."""

import dataclasses
import pathlib
import types

import pytest
from ml_collections import ConfigDict

from tests.support.box_bank import box_bank
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.datatypes.validation import ValidationError
from urbanverse_mjx.evaluation.frozen import freeze
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


def test_a_suite_takes_the_friction_of_its_frozen_lists(
    small_bank: SceneBank, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("URBANVERSE_PROTOCOL_ROOT", str(tmp_path))
    hashes = {name: f"{k}" * 64 for k, name in enumerate(small_bank.scene_ids)}
    bank = dataclasses.replace(small_bank, meta={**small_bank.meta, "hashes": hashes})
    for name, friction in (("before", "uniform"), ("other", "uniform"), ("today", "materials")):
        conditions = {"vision_config.light": "direct", "friction": friction}
        dataclasses.replace(freeze(name, bank, 8, seed=0), conditions=conditions).save(tmp_path / f"{name}.json")
    assert Suite.of(bank, {}, 0, ["before", "other"]).friction == "uniform"
    assert Suite.of(bank, {}, 0, ["today"]).friction == "materials"
    assert Suite.of(bank, {"held": bank.scene_ids[:1]}, 4, []).friction is None
    with pytest.raises(ValidationError, match="friction of before: uniform, today: materials, needed one for all"):
        Suite.of(bank, {}, 0, ["before", "today"])
