"""Which scenes of a bank a training reads."""

import dataclasses
import pathlib

import pytest

from urbanverse_mjx.datatypes import BankShards, SceneBank, ValidationError
from urbanverse_mjx.pipeline.training_run import bank_of


@pytest.fixture
def folder(small_bank: SceneBank, tmp_path: pathlib.Path) -> pathlib.Path:
    """One scene of each of the splits train, other and test, in this order."""
    bank = dataclasses.replace(small_bank, meta={**small_bank.meta, "splits": ["train", "other", "test"]})
    bank.save(tmp_path / "streets.bank")
    bank.save(tmp_path / "streets.npz")
    return tmp_path / "streets.bank"


def test_of_a_folder_only_the_scenes_of_a_training_are_read(folder: pathlib.Path, small_bank: SceneBank) -> None:
    one, two, three = small_bank.scene_ids
    for scenes, wanted in (("train", (one, three)), ("other", (two, three)), ([two, one], (one, two, three))):
        assert bank_of("CocoNav", path=folder, scenes=scenes).scene_ids == wanted
    assert bank_of("CocoNav", path=folder).scene_ids == small_bank.scene_ids
    assert bank_of("CocoNav", path=folder.with_suffix(".npz"), scenes="train").scene_ids == small_bank.scene_ids
    with pytest.raises(ValidationError, match="names no scene"):
        bank_of("CocoNav", path=folder, scenes="nowhere")


def test_damage_elsewhere_does_not_stop_a_training(folder: pathlib.Path, small_bank: SceneBank) -> None:
    (file,) = folder.glob("shard-*")
    body, own = bytearray(file.read_bytes()), small_bank.episode_waypoints[1, :4].tobytes()
    assert body.count(own) == 1
    body[body.index(own)] ^= 1
    file.write_bytes(body)
    assert bank_of("CocoNav", path=folder, scenes="train").num_scenes == 2
    with pytest.raises(ValidationError, match="damaged bytes"):
        bank_of("CocoNav", path=folder, scenes="other")


def test_the_variable_may_name_a_folder(folder: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("URBANVERSE_BANK", str(folder))
    ids = BankShards(folder).scene_ids
    assert bank_of("CocoNav", preset="quick", scenes="train").scene_ids == (ids[0], ids[2])
    assert bank_of("CocoNav").scene_ids == ids
