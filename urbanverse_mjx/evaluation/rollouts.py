"""Seeded rollouts over fixed episodes: every agent drives the same rows of the same scenes."""

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ..datatypes import RESULTS, EpisodeResult, NounError
from ..envs import NavEnv, NavState
from .agents import Agent


@dataclasses.dataclass(frozen=True)
class EpisodeSet:
    """Fixed episodes.

    Attributes:
      scenes: (n,) i32 rows of the bank; episodes: (n,) i32 rows of the episode tables.
      seed: for agents that draw.
    """

    scenes: np.ndarray
    episodes: np.ndarray
    seed: int = 0

    def __len__(self) -> int:
        return len(self.scenes)


def fixed_episodes(env: NavEnv, count: int, seed: int = 0) -> EpisodeSet:
    """`count` episodes spread evenly over the env's scenes and over each scene's table, the same on every machine.

    Raises:
      NounError: the tables hold fewer.
    """
    per_scene = -(-count // len(env.scenes))
    scenes, rows = [], []
    for scene in env.scenes:
        available = int(env.bank.num_episodes[scene])
        if available < per_scene:
            raise NounError(f"episodes: found {available} in {env.bank.scene_ids[scene]}, needed {per_scene}.")
        rows.append(np.linspace(0, available - 1, per_scene).round().astype(np.int32))
        scenes.append(np.full(per_scene, scene, np.int32))
    # Interleaved, so that a count that does not divide still takes from every scene alike.
    order = np.argsort(np.tile(np.arange(per_scene), len(env.scenes)), kind="stable")[:count]
    return EpisodeSet(np.concatenate(scenes)[order], np.concatenate(rows)[order], seed)


class _Tally(NamedTuple):
    """What is counted along the way, per env."""

    hit_time: Any
    path_length: Any
    slot_overflow: Any
    key: Any


class Rollout:
    """Runs agents over episodes of one env, `chunk` steps a call so that it can stop when all have ended.

    With the same env several agents share one compilation of the simulation each.
    """

    def __init__(self, env: NavEnv, chunk: int = 20):
        self.env = env
        self._chunk = chunk
        self._begin = jax.jit(jax.vmap(env.begin_at))
        self._root = env.mj_model.body(env.robot.root_body).id

    def run(
        self,
        name: str,
        agent: Agent,
        episodes: EpisodeSet,
        on_step: Callable[[NavState], None] | None = None,
        on_progress: Callable[[int, int], None] | None = None,
    ) -> list[EpisodeResult]:
        """Every episode once, all at the same time.

        Args:
          name: recorded as the agent.
          agent: see `agents`.
          episodes: what to drive.
          on_step: called with the batched state at the start of each chunk (chunk=1 sees every step).
          on_progress: called with (ended, total).
        """
        n = len(episodes)
        keys = jax.random.split(jax.random.key(episodes.seed), n)
        nav = self._begin(keys, jnp.asarray(episodes.scenes), jnp.asarray(episodes.episodes))
        tally = _Tally(jnp.zeros(n), jnp.zeros(n), jnp.zeros(n, jnp.int32), keys)
        chunk = self._chunk_of(agent)
        for _ in range(-(-self.env.config.episode_length // self._chunk)):
            if on_step is not None:
                on_step(nav)
            nav, tally = chunk(nav, tally)
            ended = int((np.asarray(nav.result) != 0).sum())
            if on_progress is not None:
                on_progress(ended, n)
            if ended == n:
                break
        if on_step is not None:
            on_step(nav)
        return self._results(name, nav, tally, episodes)

    def _chunk_of(self, agent: Agent) -> Callable[..., Any]:
        env, root = self.env, self._root

        def one(nav: NavState, tally: _Tally, obs: Mapping[str, Any]) -> tuple[NavState, _Tally]:
            key, key_act = jax.random.split(tally.key)
            new, _, _, metrics = env.advance(nav, agent(obs, key_act))
            running = nav.result == 0
            moved = jnp.linalg.norm(new.sim.xpos[root, :2] - nav.sim.xpos[root, :2])
            new_tally = _Tally(
                tally.hit_time + metrics["hit_time_per_step"],
                tally.path_length + jnp.nan_to_num(moved),
                tally.slot_overflow + new.sim.slot_overflow,
                key,
            )
            # An ended episode stands still as it ended.
            return jax.tree.map(lambda a, b: jnp.where(running, a, b), (new, new_tally), (nav, tally))

        def step(carry: Any, _: None) -> tuple[Any, None]:
            nav, tally = carry
            obs = jax.vmap(env.observe)(nav)
            return jax.vmap(one)(nav, tally, obs), None

        def chunk(nav: NavState, tally: _Tally) -> tuple[NavState, _Tally]:
            return jax.lax.scan(step, (nav, tally), None, length=self._chunk)[0]

        return jax.jit(chunk)

    def _results(self, name: str, nav: NavState, tally: _Tally, episodes: EpisodeSet) -> list[EpisodeResult]:
        get = np.asarray
        steps, result = get(nav.steps), get(nav.result)
        length = get(nav.route_length)
        out = []
        for i in range(len(episodes)):
            out.append(
                EpisodeResult(
                    agent=name,
                    scene=self.env.bank.scene_ids[int(episodes.scenes[i])],
                    episode=int(episodes.episodes[i]),
                    seed=episodes.seed,
                    result=RESULTS[int(result[i]) - 1],
                    steps=int(steps[i]),
                    duration=float(steps[i] * self.env.dt),
                    route_completion=float(np.clip(get(nav.route_done)[i] / max(length[i], 1e-6), 0.0, 1.0)),
                    distance_to_goal=float(get(nav.goal_distance)[i]),
                    hit_time=float(np.clip(get(tally.hit_time)[i] / steps[i], 0.0, 1.0)),
                    path_length=float(get(tally.path_length)[i]),
                    route_length=float(length[i]),
                    slot_overflow=int(get(tally.slot_overflow)[i]),
                )
            )
        return out


def result_counts(results: Sequence[EpisodeResult]) -> dict[str, int]:
    """How many episodes ended how."""
    return {name: sum(r.result == name for r in results) for name in RESULTS}
