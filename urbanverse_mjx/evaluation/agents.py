"""Baseline agents and interfaces of agents; an agent returns an action (2,) in [-1, 1] for one env."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol, runtime_checkable

import jax
import jax.numpy as jnp
import numpy as np

from ..datatypes import ValidationError
from ..envs import NavState

#: Function (obs, key) -> action, called inside jit.
Agent = Callable[[Mapping[str, Any], jax.Array], jax.Array]
#: Function from observations of n envs (name -> (n, ...)) to actions (n, 2), in NumPy, called outside jit.
BatchAgent = Callable[[Mapping[str, np.ndarray]], np.ndarray]


@runtime_checkable
class Privileged(Protocol):
    """An agent with more information than a robot's sensors provide; called inside jit like `Agent`."""

    def prepare(self, scenes: np.ndarray, rows: np.ndarray) -> Any:
        """Computes privileged data of n episodes as arrays with a leading axis n; scenes, rows: (n,) of the bank."""
        ...

    def act(self, nav: NavState, known: Any, /) -> jax.Array:
        """The action in a state; known: data of `prepare` for its episode."""
        ...


@runtime_checkable
class Recurrent(Protocol):
    """A recurrent agent; called inside jit like `Agent`."""

    def first_memory(self) -> Any:
        """Its memory at the beginning of an episode."""
        ...

    def act(self, obs: Mapping[str, Any], memory: Any, key: jax.Array, /) -> tuple[jax.Array, Any]:
        """The action, and the new memory."""
        ...


@runtime_checkable
class Beginning(Protocol):
    """A `BatchAgent` that is notified when episodes begin, so that it can reset its memory."""

    def begin(self, count: int) -> None:
        """Notifies that `count` episodes begin."""
        ...

    def __call__(self, obs: Mapping[str, np.ndarray], /) -> np.ndarray:
        """Actions (n, 2)."""
        ...


@runtime_checkable
class SeesGoal(Protocol):
    """A `BatchAgent` that takes camera images at the goals, if `sees_goal`."""

    @property
    def sees_goal(self) -> bool:
        """Whether it takes them."""
        ...

    def see_goal(self, images: np.ndarray) -> None:
        """Takes (n, H, W, 3) u8 for the episodes that begin next; called before `begin`."""
        ...

    def __call__(self, obs: Mapping[str, np.ndarray], /) -> np.ndarray:
        """Actions (n, 2)."""
        ...


def agent_action(
    agent: Agent | Privileged | Recurrent,
    nav: NavState,
    obs: Mapping[str, Any],
    known: Any,
    memory: Any,
    key: jax.Array,
) -> tuple[jax.Array, Any]:
    """Computes an agent's action in a state of one env, and its new memory.

    Args:
      known: privileged data of the env's episode, see `episode_data`.
      memory: memory of a `Recurrent` agent; () for others.
    """
    if isinstance(agent, Recurrent):
        return agent.act(obs, memory, key)
    return agent.act(nav, known) if isinstance(agent, Privileged) else agent(obs, key), ()


def episode_data(agent: Agent | Privileged | Recurrent, scenes: np.ndarray, rows: np.ndarray, count: int = 1) -> Any:
    """Privileged data of `count` times n episodes with a leading axis count * n; () for agents that are not
    `Privileged`."""
    if not isinstance(agent, Privileged):
        return ()
    return jax.tree.map(lambda x: jnp.concatenate([x] * count), agent.prepare(scenes, rows))


def zero(obs: Mapping[str, Any], key: jax.Array) -> jax.Array:
    """Agent that stands still."""
    del obs, key
    return jnp.zeros(2)


def random(obs: Mapping[str, Any], key: jax.Array) -> jax.Array:
    """Agent that draws uniform waypoints."""
    del obs
    return jax.random.uniform(key, (2,), minval=-1.0, maxval=1.0)


def _goal_offset(obs: Mapping[str, Any], agent: str) -> jax.Array:
    """(2,) m, the way to the goal.

    Raises:
      ValidationError: the goal is given otherwise.
    """
    goal = obs["goal"]
    if goal.shape != (2,):
        raise ValidationError(
            f"policy {agent!r}: found a goal of {goal.size} numbers, such as a phrase's, needed the way to it (ahead, "
            "left); take 'planner', or a policy trained for this environment."
        )
    return goal


def go_to_goal(obs: Mapping[str, Any], key: jax.Array) -> jax.Array:
    """Agent that drives straight to the goal without images: a waypoint one metre ahead in the goal's direction."""
    del key
    goal = _goal_offset(obs, "go_to_goal")
    return goal / jnp.maximum(jnp.linalg.norm(goal), 1e-6)


#: m to the goal at which `keep_distance` stops, and from which on it drives at full speed.
KEPT_DISTANCE, FULL_SPEED_DISTANCE = 2.0, 3.0


def keep_distance(obs: Mapping[str, Any], key: jax.Array) -> jax.Array:
    """Agent that drives straight towards the goal without images, and stops and faces it at `KEPT_DISTANCE`: a
    follower of a person."""
    del key
    goal = _goal_offset(obs, "keep_distance")
    distance = jnp.linalg.norm(goal)
    share = jnp.clip((distance - KEPT_DISTANCE) / (FULL_SPEED_DISTANCE - KEPT_DISTANCE), 0.02, 1.0)
    return share * goal / jnp.maximum(distance, 1e-6)


class _Cover:
    """Sets all pixels of observations to 0, and adds black images of the given shapes if there are none."""

    def __init__(self, images: Mapping[str, Sequence[int]]) -> None:
        self._shapes = {name: tuple(shape) for name, shape in images.items()}

    def __call__(self, obs: Mapping[str, Any]) -> dict[str, Any]:
        black = {name: jnp.zeros(shape, jnp.uint8) for name, shape in self._shapes.items()}
        return {**black, **{k: jnp.zeros_like(x) if k.startswith("pixels/") else x for k, x in obs.items()}}


class _BlankRecurrent:
    """A recurrent agent with black images."""

    def __init__(self, agent: Recurrent, cover: _Cover) -> None:
        self._agent, self._cover = agent, cover

    def first_memory(self) -> Any:
        return self._agent.first_memory()

    def act(self, obs: Mapping[str, Any], memory: Any, key: jax.Array) -> tuple[jax.Array, Any]:
        return self._agent.act(self._cover(obs), memory, key)


def blank_image(agent: Any, images: Mapping[str, Sequence[int]] | None = None) -> Any:
    """The same agent with black images, an ablation of the camera.

    Args:
      images: shapes of its image observations, for an environment without images.
    """
    cover = _Cover(images or {})
    if isinstance(agent, Recurrent):
        return _BlankRecurrent(agent, cover)
    return lambda obs, key: agent(cover(obs), key)


BASELINES: dict[str, Agent] = {"zero": zero, "random": random, "go_to_goal": go_to_goal, "keep_distance": keep_distance}
