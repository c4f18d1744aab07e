"""An environment's public state (`State`), its carried state (`NavState`) and the ends of episodes (`Result`)."""

import dataclasses
import enum
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple, Protocol, runtime_checkable

import jax
import numpy as np
from jaxtyping import Array, Float, Int, Key, PRNGKeyArray
from ml_collections import ConfigDict

from ..crowds.crowd import Crowd
from ..datatypes import SceneBank, SimState


class Result(enum.IntEnum):
    """How an episode ended, or RUNNING. HIT is contact with an object, or of the body with the ground; LOST is a person
    to follow out of sight; STOPPED is a stop elsewhere than at the object to find; DROPPED is a parcel beside its
    box."""

    RUNNING = 0
    GOAL = 1
    HIT = 2
    OFF_TRAVERSABLE = 3
    FALL = 4
    NON_FINITE = 5
    TIMEOUT = 6
    HIT_AGENT = 7
    LOST = 8
    STOPPED = 9
    DROPPED = 10


@jax.tree_util.register_pytree_with_keys_class
@dataclasses.dataclass(frozen=True)
class State[C]:
    """State of an environment, with the fields of MuJoCo Playground's.

    Attributes:
      data: `NavState`, or what another environment carries.
      obs: dict of observations.
      reward: () f32.
      done: () f32, 1 if the episode ended with this step.
      metrics: dict of () f32, with the same keys after reset and step.
      info: dict of further values: scene, episode, result, steps, truncation, time_out.
    """

    data: C
    obs: dict[str, Array]
    reward: Float[Array, "*batch"]
    done: Float[Array, "*batch"]
    metrics: dict[str, Float[Array, "*batch"]]
    info: dict[str, Any]

    @property
    def pipeline_state(self) -> C:
        """Brax's name of `data`."""
        return self.data

    def replace(self, **changes: Any) -> "State[C]":
        """A copy with some fields changed; `pipeline_state` means `data`."""
        if "pipeline_state" in changes:
            changes["data"] = changes.pop("pipeline_state")
        return dataclasses.replace(self, **changes)

    def tree_replace(self, changes: Mapping[str, Any]) -> "State[C]":
        """A copy with nested fields changed, given by dotted names, e.g. {"data.qpos": qpos, "info.scene": scene}."""
        state = self
        for name, value in changes.items():
            state = _changed(state, name.split("."), value)
        return state

    def tree_flatten_with_keys(self) -> tuple[list[tuple[Any, Any]], None]:
        """For JAX."""
        return [(jax.tree_util.GetAttrKey(f.name), getattr(self, f.name)) for f in dataclasses.fields(self)], None

    @classmethod
    def tree_unflatten(cls, _: None, children: Iterable[Any]) -> "State[C]":
        """For JAX, whose leaves may have any type: without checks."""
        state = object.__new__(cls)
        for field, child in zip(dataclasses.fields(cls), children, strict=True):
            object.__setattr__(state, field.name, child)
        return state


def _changed(tree: Any, names: Sequence[str], value: Any) -> Any:
    """Replaces a nested part of `tree`; parts are keys of mappings or fields."""
    first, *rest = names
    if isinstance(tree, Mapping):
        return {**tree, first: _changed(tree[first], rest, value) if rest else value}
    return tree.replace(**{first: _changed(getattr(tree, first), rest, value) if rest else value})


class Carried:
    """Fields of Playground's `state.data`, for the named tuples that environments carry."""

    __slots__ = ()
    sim: SimState
    _fields: tuple[str, ...]
    _replace: Callable[..., Any]

    @property
    def qpos(self) -> Float[Array, "*batch nq"]:
        """Robot state: m and wxyz of its root, then joints."""
        return self.sim.qpos

    @property
    def qvel(self) -> Float[Array, "*batch nv"]:
        """Robot velocity: m/s in the world frame, rad/s in the body frame, then joints."""
        return self.sim.qvel

    @property
    def xpos(self) -> Float[Array, "*batch nbody 3"]:
        """m, see `SimState`."""
        return self.sim.xpos

    @property
    def xquat(self) -> Float[Array, "*batch nbody 4"]:
        """wxyz, see `SimState`."""
        return self.sim.xquat

    @property
    def mocap_pos(self) -> Float[np.ndarray, "0 3"]:
        """None: the robots have no mocap bodies."""
        return np.zeros((0, 3), np.float32)

    @property
    def mocap_quat(self) -> Float[np.ndarray, "0 4"]:
        """None: the robots have no mocap bodies."""
        return np.zeros((0, 4), np.float32)

    @property
    def xfrc_applied(self) -> Float[np.ndarray, "*batch nbody 6"]:
        """N and N m, always 0."""
        return np.zeros((*self.sim.xpos.shape[:-1], 6), np.float32)

    def replace(self, **changes: Any) -> Any:
        """A copy with some fields changed, including those of `sim` (qpos, qvel, xpos, xquat). As in MJX, the next step
        computes the quantities that depend on a new `qpos`."""
        inner = {name: changes.pop(name) for name in list(changes) if name not in self._fields}
        if inner:
            changes["sim"] = changes.get("sim", self.sim)._replace(**inner)
        return self._replace(**changes)


@runtime_checkable
class StagedEnv[C](Protocol):
    """Interface of environments that `registry.load` returns and `wrap_for_training` needs; C is the type of the
    carried state, a pytree."""

    bank: SceneBank

    @property
    def config(self) -> ConfigDict: ...
    @property
    def action_size(self) -> int: ...
    @property
    def observation_size(self) -> dict[str, tuple[int, ...]]: ...
    @property
    def backend(self) -> str: ...
    def reset(self, key: PRNGKeyArray) -> State[C]:
        """The first state of a random episode."""
        ...

    def step(self, state: State[C], action: Float[Array, " nu"]) -> State[C]:
        """One control step without auto-reset."""
        ...

    def begin(self, key: PRNGKeyArray) -> C:
        """Begins the first episode of an env."""
        ...

    def reset_episode(self, carried: C, /) -> C:
        """Begins the episode after that of `carried`."""
        ...

    def advance(
        self, carried: C, action: Float[Array, " nu"], /
    ) -> tuple[C, Float[Array, ""], Float[Array, ""], dict[str, Float[Array, ""]]]:
        """One control step: next state, reward, done, metrics."""
        ...

    def observe(self, carried: C, /) -> dict[str, Array]: ...
    def zero_metrics(self) -> dict[str, Float[Array, ""]]: ...
    def info_of(self, carried: C, /) -> dict[str, Array]: ...


class _NavFields(NamedTuple):
    """State of one navigation env; replaced when an episode begins.

    Attributes:
      key: typed PRNG key for the next episode.
      sim: the engine's `SimState`.
      episode: () i32, row of the scene's episode table.
      start: (3,) m.
      goal: (3,) m.
      waypoints: (W, 3) m; the last one is the goal, which is repeated as padding.
      num_waypoints: () i32.
      waypoint: () i32, the next waypoint to pass.
      route_length: () f32 m, length of the route through start, waypoints and goal.
      route_done: () f32 m, largest completed length of the route so far, see `terms.route_completed`.
      driven: () f32 m, distance driven on the ground plane.
      goal_distance: () f32 m, distance from robot to goal on the ground plane.
      steps: () i32, control steps of the episode.
      age, episodes: () i32, control steps and ended episodes of this env, the only fields kept over episodes.
      last_action: (action_size,) f32.
      result: () i32, see `Result`.
      appearance_seed: () i32, see `Renderer.__call__`.
      crowd: `Crowd` of the agents in the scenario dynamic, otherwise None.
      task: the task's own part, see `navigation.tasks`; None for point goals.
    """

    key: Key[Array, ""]
    sim: SimState
    episode: Int[Array, ""]
    start: Float[Array, "3"]
    goal: Float[Array, "3"]
    waypoints: Float[Array, "W 3"]
    num_waypoints: Int[Array, ""]
    waypoint: Int[Array, ""]
    route_length: Float[Array, ""]
    route_done: Float[Array, ""]
    driven: Float[Array, ""]
    goal_distance: Float[Array, ""]
    steps: Int[Array, ""]
    age: Int[Array, ""]
    episodes: Int[Array, ""]
    last_action: Float[Array, " nu"]
    result: Int[Array, ""]
    appearance_seed: Int[Array, ""]
    crowd: Crowd | None = None
    task: Any = None


class NavState(Carried, _NavFields):
    __doc__ = _NavFields.__doc__
    __slots__ = ()
