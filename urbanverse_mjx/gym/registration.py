"""Registers the environments with Gymnasium."""

import gymnasium

from ..envs import registry


def env_id(name: str) -> str:
    """Returns the Gymnasium id of a registered environment."""
    return f"urbanverse/{name}-v0"


def register(name: str) -> None:
    """Registers an environment with Gymnasium, without a `TimeLimit` because it has its own."""
    gymnasium.register(
        env_id(name),
        entry_point="urbanverse_mjx.gym.single:UrbanEnv",
        vector_entry_point="urbanverse_mjx.gym.vector:UrbanVectorEnv",
        kwargs={"name": name},
    )


def register_all() -> None:
    """Registers every environment of `envs.registry`, including those registered there later."""
    registry.on_registration(register)
