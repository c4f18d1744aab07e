"""Gaits of robots with legs: shipping one, and the command line of the campaign's jobs."""

import json
import pathlib

import numpy as np
import pytest

from benchmarks import gaits
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.robots import gait_of, legged, load
from urbanverse_mjx.robots.gait import Gait


def _result(folder: pathlib.Path, robot: str, of: str) -> pathlib.Path:
    row = legged.row(of)
    joints = len(row.joint_names)
    layers = [(9 + 3 * joints, 8), (8, joints)]
    kernels, biases = (
        tuple(np.full(x, 0.1, np.float32) for x in layers),
        tuple(np.zeros(x[1], np.float32) for x in layers),
    )
    Gait(kernels, biases, np.array(row.stand_pose), np.ones(joints), 1, 0.02, {"robot": of}).save(folder / gaits.GAIT)
    found = {"robot": robot, "seed": 0, "preset": "fast", "steps": 1, "train_seconds": 1.0, "judged": {}}
    (folder / gaits.RESULT).write_text(json.dumps(found), encoding="utf-8")
    return folder / gaits.RESULT


def test_a_shipped_gait_is_the_robots_own(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    places = {name: tmp_path / f"{name}_gait.npz" for name in legged.NAMES}
    monkeypatch.setattr(legged, "gait_path", places.__getitem__)
    assert gaits.main(["ship", str(_result(tmp_path, "b2", "b2"))]) == 0
    assert capsys.readouterr().out.strip() == str(places["b2"])
    np.testing.assert_allclose(gait_of(load("b2")).stand, legged.row("b2").stand_pose)
    with pytest.raises(ValidationError, match="no shipped gait"):
        gait_of(load("g1"))
    # Another robot's gait with as many joints is refused, and nothing is written.
    assert gaits.main(["ship", str(_result(tmp_path, "g1", "b2"))]) == 2
    assert "found a gait of 'b2', needed one of 'g1'" in capsys.readouterr().err
    assert not places["g1"].exists()


def test_options_are_values_of_json_or_words() -> None:
    args = gaits.arguments(
        [
            "train",
            "--robot",
            "g1",
            "--out",
            "x",
            "--env",
            'impl="warp-fused"',
            "noise.scale=0",
            "a=b",
            "--ppo",
            "seed=3",
        ]
    )
    assert args.env == [("impl", "warp-fused"), ("noise.scale", 0), ("a", "b")]
    assert args.ppo == [("seed", 3)]
    with pytest.raises(SystemExit):
        gaits.arguments(["train", "--robot", "g1", "--out", "x", "--env", "impl"])
    with pytest.raises(SystemExit):
        gaits.arguments(["train", "--robot", "go2w", "--out", "x"])
