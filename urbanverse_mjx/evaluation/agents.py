"""Agents to compare with, and what else may drive: each gives an action (2,) in [-1, 1] for one env."""

from collections.abc import Callable, Mapping
from typing import Any, Protocol, runtime_checkable

import jax
import jax.numpy as jnp
import numpy as np

from ..envs import NavState

#: (obs, key) -> action, inside jit.
Agent = Callable[[Mapping[str, Any], jax.Array], jax.Array]
#: Observations of n envs (name -> (n, ...)) -> actions (n, 2), in NumPy, outside jit.
BatchAgent = Callable[[Mapping[str, np.ndarray]], np.ndarray]


@runtime_checkable
class Privileged(Protocol):
    """An agent that is told more than any robot sees; inside jit like `Agent`."""

    def prepare(self, scenes: np.ndarray, rows: np.ndarray) -> Any:
        """What it wants to know of n episodes, as arrays with a leading axis n; scenes, rows: (n,) of the bank."""
        ...

    def act(self, nav: NavState, known: Any, /) -> jax.Array:
        """The action in a state; known: what `prepare` found for its episode."""
        ...


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
