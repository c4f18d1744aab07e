"""What an environment hands out (`State`), carries inside (`NavState`) and how episodes end (`Result`)."""

import enum
from typing import Any, NamedTuple, Protocol

import jax
from flax import struct


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


class StagedEnv(Protocol):
    """What `wrap_for_training` asks of an environment; the carried state is a pytree of the environment's own."""

    @property
    def config(self) -> Any: ...
    @property
    def action_size(self) -> int: ...
    @property
    def observation_size(self) -> Any: ...
    @property
    def backend(self) -> str: ...
    def begin(self, key: jax.Array) -> Any:
        """The first episode of an env."""
        ...

    def renew(self, carried: Any, /) -> Any:
        """The episode after that of `carried`."""
        ...

    def advance(self, carried: Any, action: jax.Array, /) -> tuple[Any, jax.Array, jax.Array, dict[str, jax.Array]]:
        """One control step: next state, reward, done, metrics."""
        ...

    def observe(self, carried: Any, /) -> dict[str, jax.Array]: ...
    def zero_metrics(self) -> dict[str, jax.Array]: ...
    def info_of(self, carried: Any, /) -> dict[str, jax.Array]: ...


class NavState(NamedTuple):
    """Everything one navigation env carries from step to step; replaced when an episode begins.

    Attributes:
      key: typed PRNG key for the next episode.
      sim: the engine's `SimState`.
      episode: () i32, row of the scene's episode table.
      start: (3,) m; goal: (3,) m; waypoints: (W, 3) m, the last real one is the goal, which then repeats.
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
      look: () i32, see `Renderer.__call__`.
      crowd: the agents' `Crowd` in the scenario dynamic, else None.
    """

    key: Any
    sim: Any
    episode: Any
    start: Any
    goal: Any
    waypoints: Any
    num_waypoints: Any
    waypoint: Any
    route_length: Any
    route_done: Any
    driven: Any
    goal_distance: Any
    steps: Any
    age: Any
    episodes: Any
    last_action: Any
    result: Any
    look: Any
    crowd: Any = None


@struct.dataclass
class State:
    """State of an environment, with the fields users of MuJoCo Playground know.

    Attributes:
      data: `NavState`, or what another environment carries.
      obs: dict of observations.
      reward: () f32; done: () f32, 1 when the episode ended with this step.
      metrics: dict of () f32, the same keys from reset on.
      info: dict of further values: scene, episode, result, steps, truncation, time_out.
    """

    data: Any
    obs: dict[str, jax.Array]
    reward: jax.Array
    done: jax.Array
    metrics: dict[str, jax.Array]
    info: dict[str, Any]

    @property
    def pipeline_state(self) -> Any:
        """Brax's name of `data`."""
        return self.data
