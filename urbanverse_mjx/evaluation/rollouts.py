"""Seeded rollouts over fixed episodes: every agent drives the same rows of the same scenes."""

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ..datatypes import RESULTS, AgentMotion, EpisodeResult, NounError
from ..envs import NavEnv, NavState
from .agents import Agent
from .people import counted, no_people, people_fields


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
    """What is counted along the way, per env; people: `PeopleTally`, None where there are none."""

    hit_time: Any
    path_length: Any
    slot_overflow: Any
    key: Any
    people: Any


@dataclasses.dataclass(frozen=True)
class Trajectory:
    """Poses of every evaluated env before each control step.

    Attributes:
      xpos: (T, n, nbody, 3) m, xquat: (T, n, nbody, 4) wxyz of the robot's bodies.
      running: (T, n) bool, the episode had not ended.
      agents: places of moving agents, fields (T, n, A, ...); None where there are none.
    """

    xpos: np.ndarray
    xquat: np.ndarray
    running: np.ndarray
    agents: AgentMotion | None


class Rollout:
    """Runs agents over the same episodes at the same time, `chunk` steps a call so that it can stop early.

    All agents share one batch and one compilation; each env asks every agent and follows its own.
    """

    def __init__(self, env: NavEnv, chunk: int = 20):
        self.env = env
        self._chunk = chunk
        self._begin = jax.jit(jax.vmap(env.begin_at))
        self._root = env.mj_model.body(env.robot.root_body).id

    def run(
        self,
        agents: Mapping[str, Agent],
        episodes: EpisodeSet,
        on_progress: Callable[[int, int], None] | None = None,
    ) -> tuple[list[EpisodeResult], Trajectory]:
        """Every episode once by every agent; results ordered by agent, then episode.

        Args:
          agents: name -> agent, see `agents`.
          episodes: what to drive; equal keys for all agents.
          on_progress: called with (ended, total) after each chunk.
        """
        n, count = len(episodes), len(agents)
        keys = jnp.tile(jax.random.split(jax.random.key(episodes.seed), n), count)
        scenes, rows = np.tile(episodes.scenes, count), np.tile(episodes.episodes, count)
        who = jnp.repeat(jnp.arange(count), n)
        nav = self._begin(keys, jnp.asarray(scenes), jnp.asarray(rows))
        zero = jnp.zeros(n * count)
        people = None if self.env.living is None else no_people(n * count)
        tally = _Tally(zero, zero, zero.astype(jnp.int32), keys, people)
        chunk = self._chunk_of(list(agents.values()))
        seen = []
        for _ in range(-(-self.env.config.episode_length // self._chunk)):
            (nav, tally), poses = chunk(nav, tally, who)
            seen.append(jax.tree.map(np.asarray, poses))
            ended = int((np.asarray(nav.result) != 0).sum())
            if on_progress is not None:
                on_progress(ended, n * count)
            if ended == n * count:
                break
        trajectory = Trajectory(*jax.tree.map(lambda *part: np.concatenate(part), *seen))
        results = []
        for i, name in enumerate(agents):
            part = slice(i * n, (i + 1) * n)
            own_nav, own_tally = jax.tree.map(lambda x, part=part: x[part], (nav, tally))
            results += self._results(name, own_nav, own_tally, episodes)
        return results, trajectory

    def _chunk_of(self, agents: Sequence[Agent]) -> Callable[..., Any]:
        env, root = self.env, self._root

        def one(nav: NavState, tally: _Tally, obs: Mapping[str, Any], who: jax.Array) -> tuple[NavState, _Tally]:
            key, key_act = jax.random.split(tally.key)
            action = jnp.stack([agent(obs, key_act) for agent in agents])[who]
            new, _, _, metrics = env.advance(nav, action)
            running = nav.result == 0
            moved = jnp.linalg.norm(new.sim.xpos[root, :2] - nav.sim.xpos[root, :2])
            new_tally = _Tally(
                tally.hit_time + metrics["hit_time_per_step"],
                tally.path_length + jnp.nan_to_num(moved),
                tally.slot_overflow + new.sim.slot_overflow,
                key,
                None if tally.people is None else counted(tally.people, metrics),
            )
            # An ended episode stands still as it ended.
            return jax.tree.map(lambda a, b: jnp.where(running, a, b), (new, new_tally), (nav, tally))

        def chunk(nav: NavState, tally: _Tally, who: jax.Array) -> Any:
            def step(carry: Any, _: None) -> tuple[Any, Any]:
                nav, tally = carry
                obs = jax.vmap(env.observe)(nav)
                agents = None
                if env.living is not None:
                    agents = jax.vmap(env.living.places)(nav.crowd, nav.sim.scene)
                return jax.vmap(one)(nav, tally, obs, who), (nav.sim.xpos, nav.sim.xquat, nav.result == 0, agents)

            return jax.lax.scan(step, (nav, tally), None, length=self._chunk)

        return jax.jit(chunk)

    def _results(self, name: str, nav: NavState, tally: _Tally, episodes: EpisodeSet) -> list[EpisodeResult]:
        steps, result, length = np.asarray(nav.steps), np.asarray(nav.result), np.asarray(nav.route_length)
        done = np.clip(np.asarray(nav.route_done) / np.maximum(length, 1e-6), 0.0, 1.0)
        hit_time = np.clip(np.asarray(tally.hit_time) / steps, 0.0, 1.0)
        goal_distance, path = np.asarray(nav.goal_distance), np.asarray(tally.path_length)
        return [
            EpisodeResult(
                agent=name,
                scene=self.env.bank.scene_ids[int(episodes.scenes[i])],
                episode=int(episodes.episodes[i]),
                seed=episodes.seed,
                result=RESULTS[int(result[i]) - 1],
                steps=int(steps[i]),
                duration=float(steps[i] * self.env.dt),
                route_completion=float(done[i]),
                distance_to_goal=float(goal_distance[i]),
                hit_time=float(hit_time[i]),
                path_length=float(path[i]),
                route_length=float(length[i]),
                slot_overflow=int(tally.slot_overflow[i]),
                **({} if tally.people is None else people_fields(tally.people, steps, i)),
            )
            for i in range(len(episodes))
        ]


def result_counts(results: Sequence[EpisodeResult]) -> dict[str, int]:
    """How many episodes ended how."""
    return {name: sum(r.result == name for r in results) for name in RESULTS}
