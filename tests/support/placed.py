"""Environments on places whose scenes change, at a size that compiles fast."""

from typing import Any

import numpy as np

from urbanverse_mjx.datatypes import BankShards, PlacedBank, SceneBank
from urbanverse_mjx.envs import NavEnv, registry

OVERRIDES: dict[str, Any] = {
    "preset": "quick",
    "impl": "warp-fused",
    "scenes": "all",
    "episode_length": 40,
    "vision_config.height": 16,
    "vision_config.width": 24,
    # Objects' appearances must not depend on the other places.
    "randomization.appearance": 0.2,
}


def placed_env(shards: BankShards, places: int = 2, **overrides: Any) -> NavEnv:
    """An environment with that many of the folder's scenes at a time."""
    own = {f"schedule.{name}": x for name, x in overrides.items()}
    bank = PlacedBank.open(shards, np.arange(shards.num_scenes), places, seed=0)
    return registry.load("CocoNav", config_overrides={**OVERRIDES, **own}, bank=bank)


def env_of(shards: BankShards, row: int) -> NavEnv:
    """An environment that is loaded with one scene alone."""
    return registry.load("CocoNav", config_overrides=OVERRIDES, bank=SceneBank.take(shards, [row]))
