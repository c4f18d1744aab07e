"""A smoke training of Go2Joystick on two cores: minutes, not a gait."""

import json
import pathlib

import numpy as np
import pytest

from urbanverse_mjx.envs import registry
from urbanverse_mjx.scene.terrain import pack_regions, region_scene, terrain_regions
from urbanverse_mjx.training.config import default_ppo_config
from urbanverse_mjx.training.run import train


@pytest.mark.slow
def test_its_return_improves(tmp_path: pathlib.Path) -> None:
    """The preset `cpu` as it is, but for the bank: level ground alone, which is all it uses."""
    bank = pack_regions([region_scene("flat-0", terrain_regions("flat", 0))])
    env = registry.load("Go2Joystick", config_overrides={"preset": "cpu"}, bank=bank)
    train("Go2Joystick", env, default_ppo_config("cpu", "Go2Joystick"), tmp_path, quiet=True)
    rows = [json.loads(line) for line in (tmp_path / "log.jsonl").read_text().splitlines()]
    rows = [r for r in rows if "episode/sum_reward" in r]
    returns, falls = (np.array([r[f"episode/{name}"] for r in rows]) for name in ("sum_reward", "fall"))
    # The first episodes to end are those that fell at once: from a tenth of the run on the averages include all
    # lengths.
    begin, end = slice(len(rows) // 10, len(rows) // 4), slice(-len(rows) // 10, None)
    assert returns[end].mean() > returns[begin].mean() + 1.0
    assert falls[end].mean() < 0.5 * falls[begin].mean()
