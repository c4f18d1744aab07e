"""`StagedBase`: common base class of staged environments."""

import abc
from collections.abc import Callable, Sequence
from typing import Any, Self, no_type_check

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
from jaxtyping import Array, Float, Int, Key, PRNGKeyArray
from ml_collections import ConfigDict

from ..datatypes import AgentMotion, SceneBank, ValidationError
from .playground import ModelNames, register_with_playground
from .rendering import StateRenderer
from .types import Result, StagedEnv, State


def typed_key(key: PRNGKeyArray) -> Key[Array, ""]:
    """Accepts raw uint32 and typed keys; returns a typed one."""
    return key if jnp.issubdtype(key.dtype, jax.dtypes.prng_key) else jax.random.wrap_key_data(key)


class StagedBase[C](ModelNames, abc.ABC):
    """Implements Playground's interface by `begin`, `advance` and `observe`, which subclasses define (see
    `StagedEnv`)."""

    bank: SceneBank
    _config: ConfigDict
    #: Largest number of objects that are moved from their poses in the bank, see `Bodies`.
    num_bodies: int = 0
    _state_renderers: dict[tuple[int, int, str | None], StateRenderer]

    @no_type_check  # beartype does not support Self in a single method
    def __new__(cls, *args: Any, **kwargs: Any) -> Self:
        # Not at import, which must load neither Playground nor its imports (Brax, Warp).
        register_with_playground(StagedBase)
        env = super().__new__(cls)
        env._state_renderers = {}
        return env

    @abc.abstractmethod
    def begin(self, key: PRNGKeyArray) -> C: ...
    @abc.abstractmethod
    def reset_episode(self, carried: C, /) -> C: ...
    @abc.abstractmethod
    def advance(
        self, carried: C, action: Float[Array, " nu"], /
    ) -> tuple[C, Float[Array, ""], Float[Array, ""], dict[str, Float[Array, ""]]]: ...
    @abc.abstractmethod
    def observe(self, carried: C, /) -> dict[str, Array]: ...
    @abc.abstractmethod
    def zero_metrics(self) -> dict[str, Float[Array, ""]]: ...
    @abc.abstractmethod
    def info_of(self, carried: C, /) -> dict[str, Array]: ...
    @property
    @abc.abstractmethod
    def action_size(self) -> int: ...

    def named_observations(self, carried: C, obs: dict[str, Array]) -> dict[str, Array]:
        """Additional observations of `reset` and `step` under the names of Playground's PPO configs: `state` for a
        policy without a camera and `privileged_state` for a critic, if the environment has them."""
        return {}

    @property
    def agent_appearances(self) -> tuple[int, ...]:
        """Row of the bank's agents for each moving agent's appearance."""
        return ()

    def agents_of(self, carried: C, /) -> AgentMotion | None:
        """Poses of the moving agents of a state for rendering; None if there are none."""
        return None

    @property
    def config(self) -> ConfigDict:
        return self._config

    @property
    def observation_size(self) -> dict[str, tuple[int, ...]]:
        shapes = jax.eval_shape(self.reset, jax.random.key(0)).obs
        return {name: tuple(x.shape) for name, x in shapes.items()}

    @property
    def dt(self) -> float:
        """Control step (s)."""
        return float(self._config.ctrl_dt)

    @property
    def sim_dt(self) -> float:
        """Physics step (s)."""
        return float(self._config.sim_dt)

    @property
    def n_substeps(self) -> int:
        return round(self.dt / self.sim_dt)

    @property
    def backend(self) -> str:
        return "mjx"

    @property
    def unwrapped(self) -> "StagedBase[C]":
        return self

    @staticmethod
    def episode_info(
        scene: Int[Array, ""], episode: Int[Array, ""], result: Int[Array, ""], steps: Int[Array, ""]
    ) -> dict[str, Array]:
        """Result of `info_of`: scene, row and result of the env's episode, () each."""
        timeout = (result == Result.TIMEOUT).astype(jnp.float32)
        return {
            "scene": scene,
            "episode": episode,
            "result": result,
            "steps": steps.astype(jnp.float32),
            "truncation": timeout,
            "time_out": timeout,
        }

    def reset(self, key: PRNGKeyArray) -> State[C]:
        """First state of a random episode. Works with and without vmap, and with raw and typed keys."""
        carried = self.begin(key)
        zero = jnp.float32(0.0)
        return State(carried, self._all_of(carried), zero, zero, self.zero_metrics(), self.info_of(carried))

    def step(self, state: State[C], action: Float[Array, " nu"]) -> State[C]:
        """One control step without auto-reset.

        Entries of wrappers in `info` and `metrics` are kept. If Brax's `EpisodeWrapper` counts the steps (`info` has
        its `episode_done`), only the wrapper applies the time limit, as a truncation.
        """
        carried, reward, done, metrics = self.advance(state.data, action)
        info = self.info_of(carried)
        if "episode_done" in state.info:
            done = done * (1.0 - info["time_out"])
            info = {name: x for name, x in info.items() if name not in ("steps", "truncation")}
        obs = self._all_of(carried)
        return State(carried, obs, reward, done, {**state.metrics, **metrics}, {**state.info, **info})

    def render(
        self,
        trajectory: Sequence[State[C]] | State[C],
        height: int = 240,
        width: int = 320,
        camera: str | None = None,
        scene_option: mujoco.MjvOption | None = None,
        modify_scene_fns: Sequence[Callable[[mujoco.MjvScene], None]] | None = None,
    ) -> list[np.ndarray] | np.ndarray:
        """Renders states with this package's renderer.

        Args:
          trajectory: states of one env, as `reset` and `step` return them, or one state.
          height, width: pixels.
          camera: a camera of the robot by its name in the MJCF; None follows the robot from behind.
          scene_option: option of MuJoCo's visualiser; ignored.
          modify_scene_fns: must be None.

        Returns:
          (height, width, 3) uint8 for each state, or for the one state.

        Raises:
          ValidationError: states are batched, the camera is unknown, or `modify_scene_fns` is given.
        """
        del scene_option
        if modify_scene_fns is not None:
            raise ValidationError(
                "modify_scene_fns: found functions for MuJoCo's visualiser, needed None; draw on the returned images."
            )
        shape = height, width, camera
        if shape not in self._state_renderers:
            self._state_renderers[shape] = StateRenderer(self, height, width, camera)
        draw = self._state_renderers[shape]
        return draw([trajectory])[0] if isinstance(trajectory, State) else draw(trajectory)

    def _all_of(self, carried: C) -> dict[str, Array]:
        obs = self.observe(carried)
        return {**obs, **self.named_observations(carried, obs)}


def observed_size(env: StagedEnv[Any]) -> dict[str, tuple[int, ...]]:
    """Shapes of the outputs of `observe` by name, for the trainers of this package."""
    shapes = jax.eval_shape(lambda key: env.observe(env.begin(key)), jax.random.key(0))
    return {name: tuple(x.shape) for name, x in shapes.items()}
