"""A kinematic robot under Gymnasium's interface."""

from collections.abc import Iterator

import gymnasium
import pytest

import urbanverse_mjx.gym
from tests.support.unicycle import unicycle_env
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.envs import registry

#: Steps of its episodes.
LENGTH = 4


@pytest.fixture(scope="session")
def unicycle_id(small_bank: SceneBank) -> Iterator[str]:
    """Gymnasium's id of a robot whose episodes end after four steps, registered as a user would."""
    registry.register_environment(
        "UnicycleNav",
        lambda config, bank: unicycle_env(
            bank, {"episode_length": config.episode_length, "success_after_step": 0}, vision=True
        ),
        lambda preset: registry.with_overrides(
            registry.get_default_config("CocoNav", preset), {"episode_length": LENGTH}
        ),
        lambda: small_bank,
    )
    yield urbanverse_mjx.gym.env_id("UnicycleNav")
    del registry._REGISTRY["UnicycleNav"], gymnasium.registry[urbanverse_mjx.gym.env_id("UnicycleNav")]
