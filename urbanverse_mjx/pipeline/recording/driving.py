"""Episodes driven side by side by one policy, every step kept with what is needed to draw it.

Nothing is drawn here but what the policy sees itself: the camera is drawn afterwards from the kept poses, in the size
and with the outputs that the recording asks for.
"""

import dataclasses
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ...datatypes import RESULTS, SceneBank
from ...datatypes import validation as v
from ...evaluation.agents import Beginning, Recurrent, answer, told
from ...evaluation.rollouts import EpisodeSet, asked

if TYPE_CHECKING:
    from ...envs import NavState
    from ...viewer.session import Machine

#: Steps in one compiled call.
_CHUNK = 20


class Steps(NamedTuple):
    """Steps of envs, fields (T, n, ...); before the action but where said otherwise.

    Attributes:
      running: bool, the episode had not ended. goal: (2,) m as the policy is told. proprio: (3 + A,), see `NavEnv`.
      action: (A,) as applied. reward: of the step. result: () i32 after the step, see `Result`.
      hit: bool, the robot touched something during the step. xpos (nbody, 3), xquat (nbody, 4), agents, bodies,
        appearance_seed: what the renderer takes.
      route_done: () m after the step.
    """

    running: Any
    goal: Any
    proprio: Any
    action: Any
    reward: Any
    result: Any
    hit: Any
    xpos: Any
    xquat: Any
    agents: Any
    bodies: Any
    appearance_seed: Any
    route_done: Any


@dataclasses.dataclass(frozen=True)
class Driven:
    """One episode.

    Attributes:
      scene, row: of the bank and of the scene's episode table. seed: of the episode.
      steps: fields (T, ...) of its T steps.
      result: how it ended, of `datatypes.RESULTS`. route_completion: share of the route.
    """

    scene: int
    row: int
    seed: int
    steps: Steps
    result: str
    route_completion: float


def drawn_episodes(bank: SceneBank, scenes: np.ndarray, count: int, seed: int) -> EpisodeSet:
    """`count` different episodes, from each scene as many as from the others, drawn with `seed`.

    A smaller count gives the first ones of a larger.

    Raises:
      ValidationError: the tables hold fewer.
    """
    per_scene = -(-count // len(scenes))
    drawn = []
    for scene in scenes:
        available = int(bank.num_episodes[scene])
        if available < per_scene:
            most = int(min(bank.num_episodes[s] for s in scenes)) * len(scenes)
            raise v.fail("--num-episodes", str(count), f"at most {most} in {len(scenes)} scenes", "take more scenes")
        drawn.append(np.random.default_rng([seed, int(scene)]).permutation(available)[:per_scene])
    rows = np.stack(drawn, axis=1).ravel()[:count].astype(np.int32)
    seeds = np.random.default_rng(seed).integers(2**32, size=count)
    return EpisodeSet(np.tile(scenes, per_scene)[:count].astype(np.int32), rows, seed, seeds)


class BatchDrive:
    """Drives batches of episodes.

    Args:
      machine: the environment and its policy.
    """

    def __init__(self, machine: "Machine") -> None:
        self._env, self._driver = machine.env, machine.driver
        self._begin = jax.jit(jax.vmap(self._env.begin_at))
        self._observe = jax.jit(jax.vmap(self._env.observe))
        self._step = jax.jit(jax.vmap(self._advance))
        self._chunk = jax.jit(self._scan)

    def run(self, episodes: EpisodeSet) -> list[Driven]:
        """Drives episodes together until all have ended."""
        nav = self._begin(episodes.keys(), jnp.asarray(episodes.scenes), jnp.asarray(episodes.episodes))
        route = np.asarray(nav.route_length)
        parts = list(self._outside(nav) if self._driver.outside else self._inside(nav, episodes))
        steps = jax.tree.map(lambda *part: np.concatenate(part), *parts)
        return [self._driven(steps, episodes, i, float(route[i])) for i in range(len(episodes))]

    def _driven(self, steps: Steps, episodes: EpisodeSet, i: int, route: float) -> Driven:
        length = int(steps.running[:, i].sum())
        own = jax.tree.map(lambda x: x[:length, i], steps)
        assert episodes.seeds is not None
        return Driven(
            scene=int(episodes.scenes[i]),
            row=int(episodes.episodes[i]),
            seed=int(episodes.seeds[i]),
            steps=own,
            result=RESULTS[int(own.result[-1]) - 1],
            route_completion=float(np.clip(own.route_done[-1] / max(route, 1e-6), 0.0, 1.0)),
        )

    def _inside(self, nav: "NavState", episodes: EpisodeSet) -> Iterator[Steps]:
        agent: Any = self._driver.agent
        first = agent.first_memory() if isinstance(agent, Recurrent) else ()
        memory = jax.tree.map(lambda x: jnp.broadcast_to(x, (len(episodes), *x.shape)), first)
        known, keys = told(agent, episodes.scenes, episodes.episodes), episodes.keys()
        while bool((np.asarray(nav.result) == 0).any()):
            (nav, memory, keys), steps = self._chunk(nav, memory, keys, known)
            yield jax.tree.map(np.asarray, steps)

    def _outside(self, nav: "NavState") -> Iterator[Steps]:
        agent: Any = self._driver.agent
        number = nav.result.shape[0]
        if isinstance(agent, Beginning):
            agent.begin(number)
        while bool((np.asarray(nav.result) == 0).any()):
            obs = self._observe(nav)
            action = asked(self._driver.name, agent, obs, (number, self._env.action_size))
            nav, steps = self._step(nav, obs, jnp.asarray(action, jnp.float32))
            yield jax.tree.map(lambda x: np.asarray(x)[None], steps)

    def _scan(self, nav: "NavState", memory: Any, keys: jax.Array, known: Any) -> Any:
        def act(nav: "NavState", obs: Any, memory: Any, key: jax.Array, known: Any) -> tuple[Any, Any, jax.Array]:
            key, now = jax.random.split(key)
            agent: Any = self._driver.agent
            action, memory = answer(agent, nav, obs, known, memory, now)
            return action, memory, key

        def step(carry: Any, _: None) -> tuple[Any, Steps]:
            nav, memory, keys = carry
            obs = jax.vmap(self._env.observe)(nav)
            action, memory, keys = jax.vmap(act)(nav, obs, memory, keys, known)
            nav, steps = jax.vmap(self._advance)(nav, obs, action)
            return (nav, memory, keys), steps

        return jax.lax.scan(step, (nav, memory, keys), None, length=_CHUNK)

    def _advance(self, nav: "NavState", obs: Any, action: jax.Array) -> tuple["NavState", Steps]:
        """One env one step on; an ended episode stands still as it ended."""
        env = self._env
        new, reward, _, _ = env.advance(nav, action)
        running = nav.result == 0
        steps = Steps(
            running=running,
            goal=obs["goal"],
            proprio=env.named_observations(nav, obs)["state"][2:],
            action=new.last_action,
            reward=reward,
            result=new.result,
            hit=new.sim.contacts.hit,
            xpos=nav.sim.xpos,
            xquat=nav.sim.xquat,
            agents=env.agents_of(nav),
            bodies=nav.sim.bodies,
            appearance_seed=nav.appearance_seed,
            route_done=new.route_done,
        )
        return jax.tree.map(lambda a, b: jnp.where(running, a, b), new, nav), steps
