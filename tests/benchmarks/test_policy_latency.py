"""The time of an action: rows for files, and what they are measured with."""

import json
import os
import pathlib
import time
from collections.abc import Mapping

import numpy as np
import pytest

from benchmarks import policy_latency
from tests.support.robot_policy import SIZE, robot_policy
from urbanverse_mjx.policies.onnx_agent import OnnxAgent


def test_a_row_holds_the_time_of_each_action(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    cores, given = os.sched_getaffinity(0), []
    call = OnnxAgent.__call__

    def slower(agent: OnnxAgent, obs: Mapping[str, np.ndarray]) -> np.ndarray:
        given.append((len(os.sched_getaffinity(0)), obs["pixels/front"].shape))
        time.sleep(0.003)
        return call(agent, obs)

    monkeypatch.setattr(OnnxAgent, "__call__", slower)
    try:
        policy = robot_policy(tmp_path / "policy.onnx")
        assert policy_latency.main([str(policy), "--actions", "30", "--json"]) == 0
    finally:
        os.sched_setaffinity(0, cores)
    row = json.loads(capsys.readouterr().out)
    assert (row["policy"], row["image"], row["actions"]) == ("policy.onnx", list(SIZE), 30)
    assert 3.0 <= row["minimum"] <= row["median"] <= row["p99"]
    assert set(given) == {(1, (1, *SIZE, 3))}
    assert len(given) == 50
