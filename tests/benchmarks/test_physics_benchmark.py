"""The benchmark of the physics: one tiny run of two engines, and the kernels that they launch."""

import json
import pathlib

import pytest

from benchmarks import physics
from tests.support.box_bank import box_bank


@pytest.fixture
def bank(tmp_path: pathlib.Path) -> str:
    box_bank(2).save(tmp_path / "bank.npz")
    return str(tmp_path / "bank.npz")


def test_engines_are_timed_on_the_same_states(bank: str, capsys: pytest.CaptureFixture[str]) -> None:
    quick = ["--num-envs", "4", "--steps", "1", "--repeats", "2", "--drive", "1", "--json"]
    assert physics.main(["--bank", bank, "--scenes", "1", *quick]) == 0
    (row,) = (json.loads(line) for line in capsys.readouterr().out.splitlines())
    assert row["num_envs"] == 4
    assert row["scenes"] == 1
    general, fused = row["engines"]["warp"], row["engines"]["warp-fused"]
    for figures in (general, fused):
        rate = 4 * 20 / (1e-3 * figures["control_step_ms"])
        assert figures["physics_steps_per_s"] == pytest.approx(rate, rel=0.01)
        assert figures["processor_ms"] > 0
    between = row["warp-fused against warp"]
    assert between["times_as_fast"] == pytest.approx(general["control_step_ms"] / fused["control_step_ms"], abs=0.01)
    assert between["apart_mm_max"] < 0.2
    assert between["hits_differ"] == 0


def test_launches_of_a_physics_step_are_counted(bank: str, capsys: pytest.CaptureFixture[str]) -> None:
    """The step in one launch adds none for a further physics step; MuJoCo Warp's contains this package's own two."""
    assert physics.main(["--bank", bank, "--num-envs", "2", "--launches", "--json"]) == 0
    engines = json.loads(capsys.readouterr().out)["engines"]
    assert engines["warp-fused"]["launches_per_physics_step"] == 0
    by_name = engines["warp"]["by_name"]
    assert by_name["find_contacts"] == by_name["note"] == 1
    assert engines["warp"]["launches_per_physics_step"] == sum(by_name.values()) > 50


def test_a_missing_bank_is_one_sentence(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert physics.main(["--bank", str(tmp_path / "none.npz")]) == 2
    assert "no such file" in capsys.readouterr().err
