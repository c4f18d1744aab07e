"""The gait benchmark: a robot that only stands gets the expected scores, and errors equal those computed by hand."""

import dataclasses
import json
import pathlib

import numpy as np
import pytest

from benchmarks.go2_gait import goals, main
from benchmarks.lib import gait_trials as trials
from benchmarks.lib.gait_published import published_table
from tests.support.gaits import make_gait
from urbanverse_mjx.evaluation.gait_walks import Walk


def _walk(velocity: np.ndarray, command: np.ndarray, fell: bool = False) -> Walk:
    """One robot with the given velocities and commands (T, 3)."""
    fields = {f.name: np.zeros((1, len(velocity))) for f in dataclasses.fields(Walk)}
    fields |= {"velocity": velocity[None], "command": command[None], "fell": np.array([fell])}
    return Walk(**fields)


@pytest.mark.extended
def test_a_robot_that_stands(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    make_gait().save(tmp_path / "stands.npz")
    arguments = ["--gait", str(tmp_path / "stands.npz"), "--episodes", "3", "--trials", "1", "--seconds", "2", "--json"]
    status = main([*arguments, "--kerbs", "0.12", "--slopes", "0.125", "--processes", "1"])
    found = json.loads(capsys.readouterr().out)
    assert status == 1
    flat = found["flat"]
    commands = np.random.default_rng([0, 1]).uniform(-trials.RANGE, trials.RANGE, (3, 2, 3))[:, 0]
    assert flat["error_linear_m_s"] == pytest.approx(np.linalg.norm(commands[:, :2], axis=1).mean(), abs=0.03)
    assert flat["error_angular_rad_s"] == pytest.approx(np.abs(commands[:, 2]).mean(), abs=0.03)
    assert flat["falls_percent"] == flat["touch_percent"] == 0.0
    # It carries 15 kg on bent knees: the torques are far below the limits and far above 0.
    assert 0.05 < flat["torque_share_p99"] < 0.5
    assert flat["beyond_range_max_rad"] == 0.0
    assert found["pushes"]["survived_percent"] == 100.0
    assert [row["passed_percent"] for row in found["kerbs"] + found["ramps"]] == [0.0, 0.0, 0.0]
    assert found["goals"]["kicks_survived"]
    assert not found["goals"]["kerb_0.12_up"]
    assert not found["goals"]["error_linear_m_s"]
    assert found["straight"]["speed_m_s"] == pytest.approx(0.0, abs=0.03)
    (tmp_path / "found.json").write_text(json.dumps(found))
    assert main(["--show", str(tmp_path / "found.json")]) == 1
    page = capsys.readouterr().out
    assert "| falls, % | 1 | 0 |" in page
    assert "| kerb of 12 cm up, % of 1 | 90 | 0 |" in page
    # Without a training record and climbs, its own column is empty in these rows.
    assert "| env-steps/s with PPO | not tried | 476 k |" in page
    assert "| highest step, cm | not tried | 16 |" in page


def test_what_is_published_stands_beside_the_same_of_ours() -> None:
    kerbs = [(0.15, "up", 100.0), (0.15, "down", 92.0), (0.18, "up", 89.0), (0.18, "down", 100.0)]
    found = {
        "meta": {"steps": 60_000_000, "wall_seconds": [100, 20], "device": "a GPU"},
        "straight": {"episodes": 1, "told_m_s": 1.0, "speed_m_s": 0.987},
        "kerbs": [{"height_m": h, "way": route, "episodes": 9, "passed_percent": p} for h, route, p in kerbs],
        "ramps": [{"slope": 0.125, "episodes": 9, "passed_percent": 100.0}],
    }
    table = published_table(found)
    for cells in (
        "speed when told 1.0 m/s ahead, m/s | 0.99 | 0.9",
        "training | 60 M in 2.0 min, a GPU | 200 M env-steps in 7 min",
        "env-steps/s with PPO | 500 k, compilation included | 476 k",
        "highest step, cm | 15 in at least 90 % | 16",
        "steepest slope, degrees | 7, always | 40",
    ):
        assert f"| {cells} |" in table


def test_no_gait(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--gait", str(tmp_path / "none.npz")]) == 2
    assert "export-gait" in capsys.readouterr().err


def test_errors_count_a_second_after_a_command() -> None:
    """Twice 5 s: at once wrong by 1 m/s for 0.9 s after each new command, then by 0.1 m/s and 0.2 rad/s."""
    late = np.arange(500) % 250 < 45
    command = np.tile([0.5, 0.0, 0.3], (500, 1))
    velocity = command + np.where(late[:, None], [1.0, 0.0, 1.0], [0.0, 0.1, -0.2])
    linear, angular = trials.settled_errors(_walk(velocity, command), 0.02)
    np.testing.assert_allclose(linear, 0.1, atol=1e-9)
    np.testing.assert_allclose(angular, 0.2, atol=1e-9)
    # Oscillations faster than the window do not count, constant errors do.
    shake = command + 0.5 * np.sin(2 * np.pi * 4.0 * 0.02 * np.arange(500))[:, None] * [1.0, 0.0, 0.0]
    assert trials.settled_errors(_walk(shake, command), 0.02)[0].max() < 0.02


def test_goals_hold_where_they_are_reached() -> None:
    good = {"error_linear_m_s": 0.09, "error_angular_rad_s": 0.1, "falls_percent": 0.0}
    found = {
        "flat": good,
        "pushes": {"survived_percent": 96.0},
        "kerbs": [
            {"height_m": 0.12, "way": "up", "passed_percent": 91.0},
            {"height_m": 0.15, "way": "down", "passed_percent": 60.0},
            {"height_m": 0.20, "way": "up", "passed_percent": 0.0},
        ],
        "ramps": [{"slope": 0.125, "passed_percent": 99.0}],
    }
    reached = goals(found)
    assert [name for name, holds in reached.items() if not holds] == ["kerb_0.15_down", "ramp_0.125"]
    assert "kerb_0.2_up" not in reached
