"""Seeded rollouts over fixed episodes, which are the same for every agent."""

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from .. import table_arguments
from ..datatypes import RESULTS, AgentMotion, EpisodeResult, ValidationError
from ..envs import NavEnv, NavState
from .agents import Agent, BatchAgent, Beginning, Privileged, Recurrent, SeesGoal, agent_action, episode_data
from .goal_images import goal_images
from .people import counted, no_people, people_fields


@dataclasses.dataclass(frozen=True)
class EpisodeSet:
    """Fixed episodes.

    Attributes:
      scenes: (n,) i32 rows of the bank.
      episodes: (n,) i32 rows of the episode tables.
      seed: seed of random agents and streets.
      seeds: (n,) seed of each episode; None to derive all from `seed`.
    """

    scenes: np.ndarray
    episodes: np.ndarray
    seed: int = 0
    seeds: np.ndarray | None = None

    def __len__(self) -> int:
        return len(self.scenes)

    def keys(self) -> jax.Array:
        """(n,) typed keys of the episodes."""
        if self.seeds is None:
            return jax.random.split(jax.random.key(self.seed), len(self))
        return jax.vmap(jax.random.key)(jnp.asarray(self.seeds, jnp.uint32))

    def part(self, rows: np.ndarray) -> "EpisodeSet":
        """A subset of the episodes by row."""
        seeds = None if self.seeds is None else self.seeds[rows]
        return dataclasses.replace(self, scenes=self.scenes[rows], episodes=self.episodes[rows], seeds=seeds)


def fixed_episodes(env: NavEnv, count: int, seed: int = 0) -> EpisodeSet:
    """`count` episodes evenly distributed over the env's scenes and over each scene's table, deterministic.

    Raises:
      ValidationError: the tables have fewer episodes, or the number is no multiple of the robots of a street.
    """
    # Robots of one street are consecutive episodes.
    group = 1 if env.fleet is None else env.fleet.size
    if count % group:
        raise ValidationError(f"episodes: found {count}, needed a multiple of {group}, the robots of a street.")
    per_scene = -(-count // (group * len(env.scenes))) * group
    scenes, rows = [], []
    for scene in env.scenes:
        available = int(env.bank.num_episodes[scene])
        if available < per_scene:
            raise ValidationError(f"episodes: found {available} in {env.bank.scene_ids[scene]}, needed {per_scene}.")
        rows.append(np.linspace(0, available - 1, per_scene).round().astype(np.int32))
        scenes.append(np.full(per_scene, scene, np.int32))
    # Interleaved, so that any count uses scenes equally.
    order = np.argsort(np.tile(np.arange(per_scene) // group, len(env.scenes)), kind="stable")[:count]
    return EpisodeSet(np.concatenate(scenes)[order], np.concatenate(rows)[order], seed)


class _Tally(NamedTuple):
    """Counts during the episode per env; touches: number of contacts; people: `PeopleTally` or None; memory: memory of
    each agent, or ().
    """

    hit_time: Any
    touches: Any
    slot_overflow: Any
    key: Any
    people: Any
    memory: Any = ()


@dataclasses.dataclass(frozen=True)
class Trajectory:
    """Poses of every evaluated env before each control step.

    Attributes:
      xpos: (T, n, nbody, 3) m, xquat: (T, n, nbody, 4) wxyz of the robot's bodies.
      running: (T, n) bool, whether the episode had not ended.
      agents: poses of moving agents, fields (T, n, A, ...); None if there are none.
      goals: (T, n, 3) m, which move in some tasks; None in trajectories from elsewhere.
      shown: (T, n) values of the task for captions by name, see `Task.shown`; None in trajectories from elsewhere.
    """

    xpos: np.ndarray
    xquat: np.ndarray
    running: np.ndarray
    agents: AgentMotion | None
    goals: np.ndarray | None = None
    shown: Mapping[str, np.ndarray] | None = None


def checked_actions(name: str, agent: BatchAgent, obs: Any, shape: tuple[int, int]) -> np.ndarray:
    """Calls an agent outside JAX for a batch of observations; returns actions (n, action_size).

    Raises:
      ValidationError: the actions are not finite or have another shape.
    """
    action = np.asarray(agent(jax.tree.map(np.asarray, obs)))
    finite = bool(np.isfinite(action).all())
    if action.shape != shape or not finite:
        with_nan = "" if finite else " with NaN"
        raise ValidationError(
            f"policy {name!r}: found actions of shape {action.shape}{with_nan}, needed finite ones of shape {shape}."
        )
    return action


class Rollout:
    """Runs agents over the same episodes in parallel, `chunk` steps per call, so that it can stop early.

    All agents share one batch and one compilation; each env evaluates every agent and uses its own.

    Args:
      chunk: number of agent calls in one compiled call.
      hold: control steps for which an action is held, so that agents act at their rate in an env with shorter control
        steps for smooth videos.
    """

    def __init__(self, env: NavEnv, chunk: int = 20, hold: int = 1):
        self.env = env
        self._chunk, self._hold = chunk, hold
        self._begin = table_arguments.jit(jax.vmap(env.begin_at))

    def run(
        self,
        agents: Mapping[str, Agent | Privileged | Recurrent],
        episodes: EpisodeSet,
        on_progress: Callable[[int, int], None] | None = None,
    ) -> tuple[list[EpisodeResult], Trajectory]:
        """Runs every agent on every episode; results are ordered by agent, then episode.

        Args:
          agents: name -> agent, see `agents`.
          episodes: the episodes; all agents have the same random keys.
          on_progress: called with (ended, total) after each chunk.
        """
        n, count = len(episodes), len(agents)
        who = jnp.repeat(jnp.arange(count), n)
        nav, tally = self._start(episodes, count, list(agents.values()))
        known = tuple(episode_data(agent, episodes.scenes, episodes.episodes, count) for agent in agents.values())
        chunk = self._chunk_of(list(agents.values()))
        seen = []
        for _ in range(-(-self.env.config.episode_length // (self._chunk * self._hold))):
            (nav, tally), poses = chunk(nav, tally, who, known)
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

    def run_batch(
        self,
        name: str,
        agent: BatchAgent,
        episodes: EpisodeSet,
        on_progress: Callable[[int, int], None] | None = None,
    ) -> tuple[list[EpisodeResult], Trajectory]:
        """Runs an agent outside JAX on every episode; it is called for all of them together at each step.

        Raises:
          ValidationError: its actions are not finite or not (n, 2).
        """
        nav, tally = self._start(episodes, 1)
        observe, places = table_arguments.jit(jax.vmap(self.env.observe)), table_arguments.jit(self._places)
        advance = table_arguments.jit(jax.vmap(self._advance))
        seen = []
        if isinstance(agent, SeesGoal) and agent.sees_goal:
            agent.see_goal(goal_images(self.env, nav))
        if isinstance(agent, Beginning):
            agent.begin(len(episodes))
        for step in range(self.env.config.episode_length):
            action = checked_actions(name, agent, observe(nav), (len(episodes), self.env.action_size))
            seen.append(jax.tree.map(np.asarray, places(nav)))
            nav, tally = advance(nav, tally, jnp.asarray(action, jnp.float32))
            ended = int((np.asarray(nav.result) != 0).sum())
            if on_progress is not None and step % self._chunk == 0:
                on_progress(ended, len(episodes))
            if ended == len(episodes):
                break
        trajectory = Trajectory(*jax.tree.map(lambda *part: np.stack(part), *seen))
        return self._results(name, nav, tally, episodes), trajectory

    def _start(self, episodes: EpisodeSet, count: int, agents: Sequence[Any] = ()) -> tuple[NavState, _Tally]:
        """The initial states of `count` times all episodes, and the initial memories of `agents`."""
        number = len(episodes) * count
        keys = jnp.tile(episodes.keys(), count)
        scenes, rows = np.tile(episodes.scenes, count), np.tile(episodes.episodes, count)
        nav = self._begin(keys, jnp.asarray(scenes), jnp.asarray(rows))
        hit_time, none = jnp.zeros(number), jnp.zeros(number, jnp.int32)
        people = None if self.env.dynamic is None else no_people(number)
        first = tuple(agent.first_memory() if isinstance(agent, Recurrent) else () for agent in agents)
        memory = jax.tree.map(lambda x: jnp.broadcast_to(x, (number, *x.shape)), first)
        return nav, _Tally(hit_time, none, none, keys, people, memory)

    def _places(self, nav: NavState) -> tuple[Any, Any, Any, Any, Any, Any]:
        """One step of all envs in a `Trajectory`."""
        agents = None
        if self.env.dynamic is not None and nav.crowd is not None:
            agents = jax.vmap(self.env.dynamic.places)(nav.crowd, nav.sim.scene)
        shown = jax.vmap(self.env.task.shown)(nav)
        return nav.sim.xpos, nav.sim.xquat, nav.result == 0, agents, nav.goal, shown

    def _advance(self, nav: NavState, tally: _Tally, action: jax.Array) -> tuple[NavState, _Tally]:
        """Advances one env by a step; the state of an ended episode does not change."""
        new, _, _, metrics = self.env.advance(nav, action)
        running = nav.result == 0
        new_tally = tally._replace(
            hit_time=tally.hit_time + metrics["hit_time_per_step"],
            touches=tally.touches + (new.sim.contacts.hit & ~nav.sim.contacts.hit).astype(jnp.int32),
            slot_overflow=tally.slot_overflow + new.sim.slot_overflow,
            people=None if tally.people is None else counted(tally.people, metrics),
        )
        return jax.tree.map(lambda a, b: jnp.where(running, a, b), (new, new_tally), (nav, tally))

    def _chunk_of(self, agents: Sequence[Agent | Privileged | Recurrent]) -> Callable[..., Any]:
        env = self.env

        def one(
            nav: NavState, tally: _Tally, obs: Mapping[str, Any], who: jax.Array, known: Any
        ) -> tuple[jax.Array, _Tally]:
            key, key_act = jax.random.split(tally.key)
            answers = [
                agent_action(agent, nav, obs, own, memory, key_act)
                for agent, own, memory in zip(agents, known, tally.memory, strict=True)
            ]
            action = jnp.stack([action for action, _ in answers])[who]
            return action, tally._replace(key=key, memory=tuple(memory for _, memory in answers))

        def chunk(nav: NavState, tally: _Tally, who: jax.Array, known: Any) -> Any:
            def step(carry: Any, _: None) -> tuple[Any, Any]:
                nav, tally = carry
                obs = jax.vmap(env.observe)(nav)
                action, tally = jax.vmap(one)(nav, tally, obs, who, known)

                def held(carry: Any, _: None) -> tuple[Any, Any]:
                    nav, tally = carry
                    return jax.vmap(self._advance)(nav, tally, action), self._places(nav)

                return jax.lax.scan(held, (nav, tally), None, length=self._hold)

            carry, poses = jax.lax.scan(step, (nav, tally), None, length=self._chunk)
            return carry, jax.tree.map(lambda x: x.reshape(-1, *x.shape[2:]), poses)

        return table_arguments.jit(chunk)

    def _results(self, name: str, nav: NavState, tally: _Tally, episodes: EpisodeSet) -> list[EpisodeResult]:
        steps, result, length = np.asarray(nav.steps), np.asarray(nav.result), np.asarray(nav.route_length)
        done = np.clip(np.asarray(nav.route_done) / np.maximum(length, 1e-6), 0.0, 1.0)
        hit_time = np.clip(np.asarray(tally.hit_time) / steps, 0.0, 1.0)
        goal_distance, path = np.asarray(nav.goal_distance), np.asarray(nav.driven)
        only_ground = np.asarray(nav.sim.contacts.only_ground)
        of_task = jax.tree.map(np.asarray, jax.vmap(self.env.task.scores)(nav))
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
                touches=int(tally.touches[i]),
                hit_ground=bool(only_ground[i]),
                task_scores={k: float(x[i]) for k, x in of_task.items()} or None,
                **({} if tally.people is None else people_fields(tally.people, steps, i)),
            )
            for i in range(len(episodes))
        ]


def result_counts(results: Sequence[EpisodeResult]) -> dict[str, int]:
    """Number of episodes by result."""
    return {name: sum(r.result == name for r in results) for name in RESULTS}
