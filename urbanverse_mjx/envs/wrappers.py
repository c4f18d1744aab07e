"""Training wrapper: a batch of envs with auto-reset to new scenes, and one rendered frame per step.

Brax's AutoResetWrapper restores each env's first state (scene, start and goal) at every reset. For new episodes, pass
`wrap_for_training` to `brax.training.agents.ppo.train` as `wrap_env_fn`.
"""

import dataclasses
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Key, PRNGKeyArray, UInt32

from ..datatypes import ValidationError
from ..table_arguments import Held
from .navigation import NavEnv
from .staged import observed_size
from .types import StagedEnv, State

#: Key in `State.info` of the success rate of each episode, for `config.schedule.learnable`.
SUCCESS = "episode_success"


class AutoResetEnv[C]:
    """A batch of staged envs: advances, resets envs that are done (replacing all carried state), then observes once.

    `reset(keys)` and `step(state, actions)` take a leading batch axis. In addition to the env's info, the state holds
    the entries that Brax reads: steps, truncation, time_out, episode_done, episode_metrics (sums over the running
    episode). After a done step, `obs` is the first observation of the next episode, while reward, metrics and info
    belong to the step that ended; Brax's GAE does not bootstrap across `done`. With `config.schedule.learnable`,
    info["episode_success"] is (Z, E) for the whole batch: the success rates by which episodes are drawn
    (`navigation.learnability`).
    """

    def __init__(self, env: StagedEnv[C], episode_length: int):
        if episode_length != env.config.episode_length:
            raise ValidationError(
                f"episode_length: found {episode_length}, needed the environment's {env.config.episode_length}; "
                "set config.episode_length instead."
            )
        self.env = env
        self._learnability = env.learnability if isinstance(env, NavEnv) else None

    @property
    def learns_episodes(self) -> bool:
        """Whether episodes are drawn by their success rates (`config.schedule.learnable`), counted in the batch."""
        return self._learnability is not None

    @property
    def action_size(self) -> int:
        return self.env.action_size

    @property
    def observation_size(self) -> dict[str, tuple[int, ...]]:
        return observed_size(self.env)

    @property
    def backend(self) -> str:
        return self.env.backend

    @property
    def unwrapped(self) -> StagedEnv[C]:
        return self.env

    def reset(self, keys: Key[Array, " n"] | UInt32[Array, "n 2"]) -> State[C]:
        """First states for (n,) keys."""

        def first(key: PRNGKeyArray) -> State[C]:
            nav = self.env.begin(key)
            metrics, zero = self.env.zero_metrics(), jnp.float32(0.0)
            sums = {**metrics, "sum_reward": zero, "length": zero}
            info = {**self.env.info_of(nav), "episode_done": zero, "episode_metrics": sums}
            return State(nav, self.env.observe(nav), zero, zero, metrics, info)

        state = jax.vmap(first)(keys)
        if self._learnability is None:
            return state
        return dataclasses.replace(state, info={**state.info, SUCCESS: self._learnability.first()})

    @property
    def held(self) -> Held | None:
        """Tables of the env that other scenes replace (`NavEnv.held`); None where its scenes stay."""
        return self.env.held if isinstance(self.env, NavEnv) else None

    def reset_gone(self, state: State[C], gone: Bool[Array, " Z"]) -> tuple[State[C], Bool[Array, " n"]]:
        """Begins new episodes in the envs whose scene has gone, and observes them; the episodes that end are truncated.
        All of the other envs' states stays as it is.

        Args:
          gone: whether the scene of each row of the bank is another one than in `state`.

        Returns:
          the state, and which of the n envs begin.
        """

        def fresh(state: State[C]) -> tuple[State[C], jax.Array]:
            begins = gone[self.env.info_of(state.data)["scene"]]

            def chosen(new: Any, old: Any) -> Any:
                return jax.tree.map(lambda a, b: jnp.where(begins, a, b), new, old)

            nav = self.env.reset_episode(state.data)
            ended = {name: jnp.ones_like(state.info[name]) for name in ("truncation", "time_out", "episode_done")}
            new = dataclasses.replace(
                state,
                data=nav,
                obs=self.env.observe(nav),
                done=jnp.ones_like(state.done),
                info={**state.info, **ended},
            )
            return chosen(new, state), begins

        return jax.vmap(fresh)(state)

    def step(self, state: State[C], action: Float[Array, "n nu"]) -> State[C]:
        """One control step of every env."""
        if self._learnability is None:
            return self._step(state, action, self.env.reset_episode)
        env, learnability = self.env, self._learnability
        info = dict(state.info)
        success = info.pop(SUCCESS)
        bounds = learnability.bounds(success)
        state = dataclasses.replace(state, info=info)
        new = self._step(state, action, lambda nav: env.reset_episode(nav, bounds))  # type: ignore[call-arg]
        success = learnability.updated(success, new.info["scene"], new.info["episode"], new.info["result"])
        return dataclasses.replace(new, info={**new.info, SUCCESS: success})

    def _step(self, state: State[C], action: jax.Array, reset_episode: Callable[[C], C]) -> State[C]:
        def advance(state: State[C], action: jax.Array) -> State[C]:
            nav, reward, done, metrics = self.env.advance(state.data, action)
            alive = 1.0 - state.done
            old = state.info["episode_metrics"]
            new = {**metrics, "sum_reward": reward, "length": jnp.float32(1.0)}
            sums = {name: old[name] * alive + new[name] for name in new}
            info = {**self.env.info_of(nav), "episode_done": done, "episode_metrics": sums}
            fresh = reset_episode(nav)
            nav = jax.tree.map(lambda a, b: jnp.where(done > 0, a, b), fresh, nav)
            return State(nav, state.obs, reward, done, metrics, info)

        state = jax.vmap(advance)(state, action)
        return dataclasses.replace(state, obs=jax.vmap(self.env.observe)(state.data))


def wrap_for_training[C](
    env: StagedEnv[C],
    episode_length: int,
    action_repeat: int = 1,
    randomization_fn: Callable[..., Any] | None = None,
) -> AutoResetEnv[C]:
    """The `wrap_env_fn` for Brax's trainers.

    Raises:
      ValidationError: action_repeat is not 1 (the env's control step is the policy's step), or a Brax randomiser is
        given.
    """
    if action_repeat != 1:
        raise ValidationError(f"action_repeat: found {action_repeat}, needed 1; set config.ctrl_dt instead.")
    if randomization_fn is not None:
        raise ValidationError("randomization_fn: found a function, needed None; scenes differ per env already.")
    return AutoResetEnv(env, episode_length)
