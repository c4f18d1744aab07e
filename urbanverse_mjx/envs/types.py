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
    """How an episode ended; RUNNING while it has not. HIT is a touch of an object or of the ground by the body."""

    RUNNING = 0
    GOAL = 1
    HIT = 2
    OFF_TRAVERSABLE = 3
    FALL = 4
    NON_FINITE = 5
    TIMEOUT = 6
    HIT_AGENT = 7


@jax.tree_util.register_pytree_with_keys_class
@dataclasses.dataclass(frozen=True)
class State[C]:
    """State of an environment, with the fields of MuJoCo Playground's.

    Attributes:
      data: `NavState`, or what another environment carries.
      obs: dict of observations.
      reward: () f32.
      done: () f32, 1 when the episode ended with this step.
      metrics: dict of () f32, the same keys from reset on.
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
        """A copy with some fields changed; `pipeline_state` is `data`."""
        if "pipeline_state" in changes:
            changes["data"] = changes.pop("pipeline_state")
        return dataclasses.replace(self, **changes)

    def tree_replace(self, changes: Mapping[str, Any]) -> "State[C]":
        """A copy with what dotted names stand for changed, e.g. {"data.qpos": qpos, "info.scene": scene}."""
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
    """`tree` with a part of a part replaced; parts are keys of mappings or fields."""
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
        """Of the robot: m and wxyz of its root, then joints."""
        return self.sim.qpos

    @property
    def qvel(self) -> Float[Array, "*batch nv"]:
        """Of the robot: m/s in the world's frame, rad/s in the body's, then joints."""
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
        """N and N m, all 0: only the street acts on the robot."""
        return np.zeros((*self.sim.xpos.shape[:-1], 6), np.float32)

    def replace(self, **changes: Any) -> Any:
        """A copy with some fields changed, of its own or of `sim` (qpos, qvel, xpos, xquat). As in MJX, the next step
        computes the quantities that follow from a new `qpos`."""
        inner = {name: changes.pop(name) for name in list(changes) if name not in self._fields}
        if inner:
            changes["sim"] = changes.get("sim", self.sim)._replace(**inner)
        return self._replace(**changes)


@runtime_checkable
class StagedEnv[C](Protocol):
    """The interface that `registry.load` returns and `wrap_for_training` needs; C is the environment's own carried
    state, a pytree."""

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
        """The first episode of an env."""
        ...

    def reset_episode(self, carried: C, /) -> C:
        """The episode after that of `carried`."""
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
    """Everything one navigation env carries from step to step; replaced when an episode begins.

    Attributes:
      key: typed PRNG key for the next episode.
      sim: the engine's `SimState`.
      episode: () i32, row of the scene's episode table.
      start: (3,) m.
      goal: (3,) m.
      waypoints: (W, 3) m, the last real one is the goal, which then repeats.
      num_waypoints: () i32.
      waypoint: () i32, the next waypoint to pass.
      route_length: () f32 m along start, waypoints, goal.
      route_done: () f32 m, most of the route completed so far, see `terms.route_completed`.
      driven: () f32 m on the ground plane.
      goal_distance: () f32 m, ground distance robot to goal.
      steps: () i32 control steps done.
      age, episodes: () i32, control steps and ended episodes behind this env; they alone outlive an episode.
      last_action: (action_size,) f32.
      result: () i32, see `Result`.
      appearance_seed: () i32, see `Renderer.__call__`.
      crowd: the agents' `Crowd` in the scenario dynamic, else None.
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


class NavState(Carried, _NavFields):
    __doc__ = _NavFields.__doc__
    __slots__ = ()
