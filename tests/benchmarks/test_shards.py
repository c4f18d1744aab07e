"""`benchmarks.shards`: copies of streets share nothing, or all; a line tells what some of them take."""

import json
import pathlib

import numpy as np
import pytest

from benchmarks import places
from benchmarks import shards as script
from urbanverse_mjx.datatypes import SceneBank


@pytest.fixture
def path(small_bank: SceneBank, tmp_path: pathlib.Path) -> pathlib.Path:
    small_bank.save(tmp_path / "bank.npz")
    return tmp_path / "bank.npz"


def test_copies_share_no_hull_mesh_or_texture(path: pathlib.Path, small_bank: SceneBank) -> None:
    banks = list(script.copies([path], 8, shared=False))
    assert [bank.num_scenes for bank in banks] == [3, 3, 2]
    assert len({name for bank in banks for name in bank.scene_ids}) == 8
    for first, second in ((banks[0], banks[1]), (banks[1], banks[2])):
        for table in ("hull_vertices", "mesh_vertices"):
            rows = [{row.tobytes() for row in getattr(bank, table)} for bank in (first, second)]
            assert not rows[0] & rows[1]
        pixels = [{bank.texture(i).tobytes() for i in range(len(bank.texture_shape))} for bank in (first, second)]
        assert not pixels[0] & pixels[1]
    np.testing.assert_array_equal(banks[1].inst_position, small_bank.inst_position)


def test_a_line_for_each_number_of_scenes(path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    options = ["--banks", str(path), "--take", "2", "--num-envs", "0", "--work", str(path.parent)]
    assert script.main([*options, "--scenes", "3,9"]) == 0
    assert script.main([*options, "--scenes", "9", "--shared"]) == 0
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [row["scenes"] for row in rows] == [3, 9, 9]
    assert [row["take"]["scenes"] for row in rows] == [2, 2, 2]
    assert rows[1]["hulls"] == 3 * rows[0]["hulls"]
    assert rows[1]["meshes"] == 3 * rows[0]["meshes"]
    assert rows[2]["hulls"] == rows[0]["hulls"]
    assert rows[2]["disk_mib"] < rows[1]["disk_mib"]
    assert [entry.name for entry in path.parent.iterdir()] == ["bank.npz"], "the folders are removed"


@pytest.mark.extended
def test_a_training_on_places_says_what_exchanges_cost(
    path: pathlib.Path, small_bank: SceneBank, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = path.parent / "streets.bank"
    small_bank.save(folder)
    options = ["--num-envs", "4", "--height", "16", "--width", "24", "--steps", "512", "--exchange-steps", "64"]
    assert places.main(["--folder", str(folder), "--places", "2", *options, "--work", str(path.parent)]) == 0
    row = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert (row["scenes"], row["places"], row["compiled"]) == (3, 2, 0)
    assert row["exchanges"] > 0
    assert sum(row["spent"].values()) == pytest.approx(row["stalled"] * row["seconds"], rel=0.05, abs=0.01)
    assert all(size > 0 for size in row["place_mib"].values())
    assert sorted(entry.name for entry in path.parent.iterdir()) == ["bank.npz", "streets.bank"]
