"""Evaluation on held-out streets: fixed episodes that are driven during and after a training."""

import copy
import dataclasses
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from ml_collections import ConfigDict

from .. import settings, table_arguments
from ..datatypes import SceneBank
from ..datatypes import validation as v
from ..envs.navigation.draws import OFF, Randomization
from ..envs.types import Result
from . import benchmark
from .frozen import Protocol
from .rollouts import EpisodeSet, result_counts
from .scores import over_scenes


def for_scoring(env: Any, bank: SceneBank) -> Any:
    """The same environment with other episode tables of the same scenes and without randomisation."""
    other = copy.copy(env)
    other.bank = bank
    other._randomization, other.clutter = Randomization(ConfigDict(OFF)), None
    names = ("episode_start", "episode_goal", "episode_waypoints", "episode_num_waypoints")
    other._episodes = {name: jnp.asarray(getattr(bank, name)) for name in names}
    return other


def _joined(parts: Sequence[EpisodeSet]) -> EpisodeSet:
    scenes, rows = (np.concatenate([getattr(part, k) for part in parts]) for k in ("scenes", "episodes"))
    return EpisodeSet(scenes, rows, 0, np.concatenate([np.asarray(part.seeds) for part in parts]))


@dataclasses.dataclass(frozen=True)
class Suite:
    """Fixed episodes of several sets of scenes, driven in parallel.

    Attributes:
      bank: all scenes, with the episode tables of frozen benchmarks.
      scenes: scenes of each set by its name.
      episodes: episodes of each set.
      friction: of the ground with which its benchmarks were frozen; None if it has none.
    """

    bank: SceneBank
    scenes: Mapping[str, frozenset[str]]
    episodes: Mapping[str, EpisodeSet]
    friction: str | None = None

    @staticmethod
    def of(bank: SceneBank, held: Mapping[str, Sequence[str]], count: int, frozen: Sequence[str]) -> "Suite":
        """Makes a suite of `count` evenly spaced episodes of each set of scenes `held`, and of benchmarks (protocol
        full).

        Raises:
          ValidationError: the benchmarks were frozen with different friction, so no environment serves them all.
        """
        scenes, episodes, friction = {}, {}, {}
        for name in frozen:
            runs = Protocol.load(settings.protocol_root() / f"{name}.json").on(bank, "full")
            friction[name] = runs.protocol.conditions["friction"]
            bank, scenes[name], episodes[name] = runs.bank, frozenset(runs.scenes), runs.episodes
        for name, ids in held.items():
            rows = np.array([bank.scene_ids.index(k) for k in ids], np.int32)
            each = -(-count // len(rows))
            places = [np.linspace(0, int(bank.num_episodes[r]) - 1, each).round().astype(np.int32) for r in rows]
            seeds = np.arange(each * len(rows), dtype=np.uint32)
            scenes[name] = frozenset(ids)
            episodes[name] = EpisodeSet(np.repeat(rows, each), np.concatenate(places), 0, seeds)
        if len(set(friction.values())) > 1:
            found = ", ".join(f"{name}: {value}" for name, value in friction.items())
            raise v.fail("frozen benchmarks", f"friction of {found}", "one for all", "score them in separate runs")
        return Suite(bank, scenes, episodes, next(iter(friction.values()), None))

    def check(self, env: Any) -> None:
        """Checks that an environment has the friction with which the benchmarks were frozen; `score` does it too.

        Raises:
          ValidationError: it has another, so its scores would be those of another task.
        """
        found = env.config.get("friction", "uniform")
        if self.friction not in (None, found):
            raise v.fail(
                "friction", repr(found), f"{self.friction!r}, with which the benchmarks were frozen",
                f'pass the environment option friction="{self.friction}"',
            )  # fmt: skip

    def score(self, env: Any, name: str, agent: Any) -> dict[str, Any]:
        """The benchmark scores of one agent for each set.

        Raises:
          ValidationError: see `check`.
        """
        self.check(env)
        episodes = _joined(list(self.episodes.values()))
        run = benchmark.drive(for_scoring(env, self.bank), name, agent, episodes, False, len(episodes))
        parts = {k: [r for r in run.results if r.scene in ids] for k, ids in self.scenes.items()}
        return {
            k: {"summary": over_scenes(part), "ends": result_counts(part), "by_scene": benchmark.by_scene(part)}
            for k, part in parts.items()
        }

    def quick(self, env: Any, student: Any, names: Sequence[str], chunk: int = 20) -> Callable[[Any], dict[str, float]]:
        """Makes a function from parameters of a student to the success rate in each of the named sets; compiled once,
        for use during a training."""
        env = for_scoring(env, self.bank)
        chosen = _joined([self.episodes[name] for name in names])
        sizes = [len(self.episodes[name]) for name in names]
        start = table_arguments.jit(
            lambda: jax.vmap(env.begin_at)(chosen.keys(), jnp.asarray(chosen.scenes), jnp.asarray(chosen.episodes))
        )

        @table_arguments.jit
        def drive(params: Any, nav: Any, memory: Any) -> Any:
            def step(carry: Any, _: None) -> Any:
                nav, memory = carry
                obs = jax.vmap(env.observe)(nav)
                seen = {name: x[None] for name, x in obs.items()}
                action, memory, _ = student.apply(params, seen, memory, jnp.zeros((1, len(chosen)), bool))
                new = jax.vmap(lambda n, a: env.advance(n, a)[0])(nav, action[0])
                going = nav.result == Result.RUNNING
                return (jax.tree.map(lambda a, b: _where(going, a, b), new, nav), memory), None

            return jax.lax.scan(step, (nav, memory), None, length=chunk)[0]

        def rates(params: Any) -> dict[str, float]:
            nav, memory = start(), student.first_memory(len(chosen))
            for _ in range(-(-env.config.episode_length // chunk)):
                nav, memory = drive(params, nav, memory)
                if (np.asarray(nav.result) != Result.RUNNING).all():
                    break
            arrived = np.split(np.asarray(nav.result) == Result.GOAL, np.cumsum(sizes)[:-1])
            return {name: float(part.mean()) for name, part in zip(names, arrived, strict=True)}

        return rates


def _where(going: jax.Array, new: jax.Array, old: jax.Array) -> jax.Array:
    """Selects `new` for the envs that are `going`, and `old` for others; keys, which `jnp.where` does not support, are
    always new."""
    if jnp.issubdtype(new.dtype, jax.dtypes.prng_key):
        return new
    return jnp.where(going.reshape(-1, *[1] * (new.ndim - 1)), new, old)
