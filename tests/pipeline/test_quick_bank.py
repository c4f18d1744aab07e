"""The bank of the preset `quick`: shipped and procedural streets for training and evaluation."""

import dataclasses
import pathlib
from collections.abc import Sequence

import pytest

from tests.support.box_bank import box_bank
from urbanverse_mjx.citygen import procedural_streets
from urbanverse_mjx.datatypes import SceneBank, SceneGraph
from urbanverse_mjx.pipeline import banks, quick_bank
from urbanverse_mjx.scene import library


def test_it_joins_the_shipped_streets_with_scenes_that_are_held_out_and_ones_that_are_not(
    small_bank: SceneBank, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    built: list[tuple[str, str]] = []

    def build_bank(graphs: Sequence[pathlib.Path], splits: Sequence[str], quiet: bool) -> SceneBank:
        for path, split in zip(graphs, splits, strict=True):
            graph = SceneGraph.load(path)
            built.append((graph.id, split))
            assert graph.content_hash() == library.shipped_hashes("procedural")[graph.id]["graph"]
        return box_bank(2, seed=5)

    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path))
    monkeypatch.setattr(quick_bank, "QUICK_TRAIN", ("procedural_003",))
    monkeypatch.setattr(quick_bank, "QUICK_TEST", ("procedural_145",))
    monkeypatch.setattr(banks, "build_bank", build_bank)
    monkeypatch.setattr(banks, "ensure_default_bank", lambda quiet=False: renamed(small_bank))
    bank = quick_bank.ensure_quick_bank(quiet=True)
    assert built == [("procedural_003", "train"), ("procedural_145", "test")]
    assert bank.num_scenes == small_bank.num_scenes + 2
    again = quick_bank.ensure_quick_bank(quiet=True)
    assert len(built) == 2, "the second time it comes from the cache"
    assert again.scene_ids == bank.scene_ids
    monkeypatch.setattr(quick_bank, "QUICK_TEST", ("procedural_146",))
    quick_bank.ensure_quick_bank(quiet=True)
    assert built[2:] == [("procedural_003", "train"), ("procedural_146", "test")], "other scenes are another bank"


def renamed(bank: SceneBank) -> SceneBank:
    return dataclasses.replace(bank, meta={**bank.meta, "scene_ids": [f"shipped_{k}" for k in range(bank.num_scenes)]})


def test_what_it_judges_by_is_held_out_of_the_library() -> None:
    held = library.scene_set("procedural").validation
    assert set(quick_bank.QUICK_TEST) <= set(held)
    assert not set(quick_bank.QUICK_TRAIN) & set(held)
    assert len(quick_bank.QUICK_TEST) + 2 == 8
    assert max(int(name[-3:]) for name in quick_bank.QUICK_TRAIN) < procedural_streets.COUNT
