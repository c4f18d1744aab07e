"""Names of the registered environments in Gymnasium's registry."""

import gymnasium

from ..envs import registry


def env_id(name: str) -> str:
    """Gymnasium's id of a registered environment."""
    return f"urbanverse/{name}-v0"


def register(name: str) -> None:
    """Makes an environment known to Gymnasium; one that keeps its own time, so without a `TimeLimit`."""
    gymnasium.register(
        env_id(name),
        entry_point="urbanverse_mjx.gym.single:UrbanEnv",
        vector_entry_point="urbanverse_mjx.gym.vector:UrbanVectorEnv",
        kwargs={"name": name},
    )


def register_all() -> None:
    """Registers every environment of `envs.registry`, and those to come when they come."""
    registry.on_registration(register)
