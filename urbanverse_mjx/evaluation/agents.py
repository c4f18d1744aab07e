"""Agents to compare with: each is (obs, key) -> action (2,) in [-1, 1], for one env."""

from collections.abc import Callable, Mapping
from typing import Any

import jax
import jax.numpy as jnp

Agent = Callable[[Mapping[str, Any], jax.Array], jax.Array]


def zero(obs: Mapping[str, Any], key: jax.Array) -> jax.Array:
    """Stands still."""
    del obs, key
    return jnp.zeros(2)


def random(obs: Mapping[str, Any], key: jax.Array) -> jax.Array:
    """Uniform waypoints."""
    del obs
    return jax.random.uniform(key, (2,), minval=-1.0, maxval=1.0)


def go_to_goal(obs: Mapping[str, Any], key: jax.Array) -> jax.Array:
    """Heads straight for the goal and sees nothing: a waypoint one metre ahead in the goal's direction."""
    del key
    goal = obs["goal"]
    return goal / jnp.maximum(jnp.linalg.norm(goal), 1e-6)


def blank_image(agent: Agent) -> Agent:
    """The same agent with its camera covered (all pixels 0): what it does without seeing."""

    def act(obs: Mapping[str, Any], key: jax.Array) -> jax.Array:
        covered = {k: jnp.zeros_like(x) if k.startswith("pixels/") else x for k, x in obs.items()}
        return agent(covered, key)

    return act


BASELINES: dict[str, Agent] = {"zero": zero, "random": random, "go_to_goal": go_to_goal}
