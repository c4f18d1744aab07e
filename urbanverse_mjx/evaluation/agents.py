"""Baseline agents and the interfaces of agents: each gives an action (2,) in [-1, 1] for one env."""

from collections.abc import Callable, Mapping, Sequence
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
    """An agent with more information than a robot's sensors give; inside jit like `Agent`."""

    def prepare(self, scenes: np.ndarray, rows: np.ndarray) -> Any:
        """Its privileged data of n episodes, as arrays with a leading axis n; scenes, rows: (n,) of the bank."""
        ...

    def act(self, nav: NavState, known: Any, /) -> jax.Array:
        """The action in a state; known: what `prepare` found for its episode."""
        ...


@runtime_checkable
class Recurrent(Protocol):
    """An agent that remembers; inside jit like `Agent`."""

    def first_memory(self) -> Any:
        """Its memory at the beginning of an episode."""
        ...

    def act(self, obs: Mapping[str, Any], memory: Any, key: jax.Array, /) -> tuple[jax.Array, Any]:
        """The action, and what to remember."""
        ...


@runtime_checkable
class Beginning(Protocol):
    """A `BatchAgent` that is notified when episodes begin, to reset its memory."""

    def begin(self, count: int) -> None:
        """`count` episodes begin together."""
        ...

    def __call__(self, obs: Mapping[str, np.ndarray], /) -> np.ndarray:
        """Actions (n, 2)."""
        ...


def answer(
    agent: Agent | Privileged | Recurrent,
    nav: NavState,
    obs: Mapping[str, Any],
    known: Any,
    memory: Any,
    key: jax.Array,
) -> tuple[jax.Array, Any]:
    """An agent's action in a state of one env, and its new memory.

    Args:
      known: result of `told` for the env's episode.
      memory: of a `Recurrent`; () of the others.
    """
    if isinstance(agent, Recurrent):
        return agent.act(obs, memory, key)
    return agent.act(nav, known) if isinstance(agent, Privileged) else agent(obs, key), ()


def told(agent: Agent | Privileged | Recurrent, scenes: np.ndarray, rows: np.ndarray, count: int = 1) -> Any:
    """Privileged data of `count` times n episodes, leading axis count * n; () for the others."""
    if not isinstance(agent, Privileged):
        return ()
    return jax.tree.map(lambda x: jnp.concatenate([x] * count), agent.prepare(scenes, rows))


def zero(obs: Mapping[str, Any], key: jax.Array) -> jax.Array:
    """Stands still."""
    del obs, key
    return jnp.zeros(2)


def random(obs: Mapping[str, Any], key: jax.Array) -> jax.Array:
    """Uniform waypoints."""
    del obs
    return jax.random.uniform(key, (2,), minval=-1.0, maxval=1.0)


def go_to_goal(obs: Mapping[str, Any], key: jax.Array) -> jax.Array:
    """Drives straight to the goal without images: a waypoint one metre ahead in the goal's direction."""
    del key
    goal = obs["goal"]
    return goal / jnp.maximum(jnp.linalg.norm(goal), 1e-6)


class _Cover:
    """Observations with all pixels 0, and black images of the given shapes where there are none."""

    def __init__(self, images: Mapping[str, Sequence[int]]) -> None:
        self._shapes = {name: tuple(shape) for name, shape in images.items()}

    def __call__(self, obs: Mapping[str, Any]) -> dict[str, Any]:
        black = {name: jnp.zeros(shape, jnp.uint8) for name, shape in self._shapes.items()}
        return {**black, **{k: jnp.zeros_like(x) if k.startswith("pixels/") else x for k, x in obs.items()}}


class _BlankRecurrent:
    """An agent that remembers, with its camera covered."""

    def __init__(self, agent: Recurrent, cover: _Cover) -> None:
        self._agent, self._cover = agent, cover

    def first_memory(self) -> Any:
        return self._agent.first_memory()

    def act(self, obs: Mapping[str, Any], memory: Any, key: jax.Array) -> tuple[jax.Array, Any]:
        return self._agent.act(self._cover(obs), memory, key)


def blank_image(agent: Any, images: Mapping[str, Sequence[int]] | None = None) -> Any:
    """The same agent with its camera covered (all pixels 0).

    Args:
      images: shapes of its image observations, for an environment that draws none.
    """
    cover = _Cover(images or {})
    if isinstance(agent, Recurrent):
        return _BlankRecurrent(agent, cover)
    return lambda obs, key: agent(cover(obs), key)


BASELINES: dict[str, Agent] = {"zero": zero, "random": random, "go_to_goal": go_to_goal}
