"""Episodes driven side by side by one policy, every step kept with what is needed to draw it.

Nothing is drawn here but what the policy sees itself: the camera is drawn afterwards from the kept poses, in the size
and with the outputs that the recording asks for.
"""

import dataclasses
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ... import table_arguments
from ...datatypes import RESULTS, SceneBank
from ...datatypes import validation as v
from ...evaluation.agents import Beginning, Privileged, Recurrent, agent_action, episode_data
from ...evaluation.rollouts import EpisodeSet, checked_actions
from .action_noise import ActionNoise, disturbed

if TYPE_CHECKING:
    from ...envs import NavState
    from ...viewer.session import Machine

#: Steps in one compiled call on a CPU, where steps of episodes that have ended meanwhile cost most, and elsewhere,
#: where what is done between two calls does.
_STEPS_PER_CALL, _STEPS_PER_DEVICE_CALL = 5, 20
#: Episodes whose data a privileged policy receives together: its data (the planner's are 0.6 MB an episode) have one
#: shape for those, and the program is compiled for it.
_EPISODES_PER_BLOCK = 256


class Steps(NamedTuple):
    """Steps of envs, fields (T, n, ...); before the action but where said otherwise.

    Attributes:
      running: bool, the episode had not ended.
      goal: (2,) m as the policy observes it.
      proprio: (3 + A,), see `NavEnv`.
      action: (A,) as applied.
      answer: (A,) of the policy, in [-1, 1]; the same but for noise that was added to it.
      reward: of the step.
      result: () i32 after the step, see `Result`.
      hit: bool, the robot touched something during the step. xpos (nbody, 3), xquat (nbody, 4), agents, bodies,
        appearance_seed: what the renderer takes.
      qvel: (nv,) speeds of the joints.
      contacts: during the step, see `Contacts`.
      route_share: () share of the route done after the step.
    """

    running: Any
    goal: Any
    proprio: Any
    action: Any
    answer: Any
    reward: Any
    result: Any
    hit: Any
    xpos: Any
    xquat: Any
    agents: Any
    bodies: Any
    appearance_seed: Any
    route_share: Any
    qvel: Any
    contacts: Any


class _State(NamedTuple):
    """What is carried from step to step, leading axis of envs; known: of a `Privileged` policy; noise: a `NoiseState`,
    or () without noise."""

    nav: Any
    memory: Any
    keys: jax.Array
    known: Any
    noise: Any


@dataclasses.dataclass(frozen=True)
class Driven:
    """One episode.

    Attributes:
      scene, row: of the bank and of the scene's episode table.
      seed: of the episode.
      steps: fields (T, ...) of its T steps.
      result: how it ended, of `datatypes.RESULTS`.
      route_completion: share of the route.
      by_hand: (T,) bool, which steps a person drove; None where nobody could.
    """

    scene: int
    row: int
    seed: int
    steps: Steps
    result: str
    route_completion: float
    by_hand: np.ndarray | None = None


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


class _Slots:
    """Which episode each env drives, its steps so far, and ended episodes that wait for earlier ones.

    Args:
      count: of episodes.
      envs: as many or fewer; those for which no episode is left are idle.
      first: episode; those before it are left out.
    """

    def __init__(self, count: int, envs: int, first: int = 0) -> None:
        episodes = first + np.arange(envs)
        self.episode = np.where(episodes < count, episodes, -1)
        self.parts: list[list[Steps]] = [[] for _ in range(envs)]
        self.ended: dict[int, Steps] = {}
        self._count, self._next, self._given = count, min(first + envs, count), first

    @property
    def idle(self) -> np.ndarray:
        """(envs,) bool: whose episode has ended."""
        return self.episode < 0

    def take(self, steps: Steps) -> None:
        """Adds steps (T, envs, ...) of all envs; those of an ended episode are left out."""
        for env, episode in enumerate(self.episode.tolist()):
            length = int(steps.running[:, env].sum())
            if episode >= 0 and length:
                self.parts[env].append(jax.tree.map(lambda x, env=env, length=length: x[:length, env], steps))
            if episode >= 0 and self.parts[env][-1].result[-1] != 0:
                self.ended[episode] = jax.tree.map(lambda *part: np.concatenate(part), *self.parts[env])
                self.parts[env], self.episode[env] = [], -1

    def in_order(self) -> Iterator[tuple[int, Steps]]:
        """Ended episodes that follow those given before without a gap."""
        while self._given in self.ended:
            yield self._given, self.ended.pop(self._given)
            self._given += 1

    def refill(self) -> np.ndarray:
        """Gives idle envs the next episodes; returns these envs."""
        envs = np.flatnonzero(self.idle)[: self._count - self._next]
        self.episode[envs] = self._next + np.arange(len(envs))
        self._next += len(envs)
        return envs


class BatchDrive:
    """Drives episodes side by side; an env whose episode ends begins the next one.

    Args:
      machine: the environment and its policy.
      noise: added to the actions that drive.
    """

    def __init__(self, machine: "Machine", noise: ActionNoise | None = None) -> None:
        self._env, self._policy = machine.env, machine.policy
        self._noise = noise if noise is not None and noise.deviation else None
        self._begin = table_arguments.jit(jax.vmap(self._env.begin_at))
        self._observe = table_arguments.jit(jax.vmap(self._env.observe))
        self._step = table_arguments.jit(jax.vmap(self._advance))
        self._chunk = table_arguments.jit(self._scan)
        self._replace = jax.jit(_replaced)
        self._next_noise = jax.jit(self._noise_after)

    def run(
        self, episodes: EpisodeSet, num_envs: int, on_compiled: Callable[[], None] | None = None, first: int = 0
    ) -> Iterator[list[Driven]]:
        """Drives every episode once, `num_envs` at a time.

        Args:
          on_compiled: called once, after the first steps.
          first: episode that is driven; those before it are left out, which changes nothing in the others.

        Yields:
          ended episodes in their order, as soon as those before them have ended; a list, which may be empty, for each
          call of the driving program.

        Raises:
          ValidationError: a policy outside JAX answers with something else than finite actions (num_envs, A).
        """
        size = _EPISODES_PER_BLOCK if isinstance(self._policy.agent, Privileged) else len(episodes)
        for start in range(first // size * size, len(episodes), size):
            block = episodes.part(np.arange(start, min(start + size, len(episodes))))
            yield from self._run_block(block, min(num_envs, len(block)), on_compiled, max(first - start, 0))
            on_compiled = None

    def _run_block(
        self, episodes: EpisodeSet, num_envs: int, on_compiled: Callable[[], None] | None, first: int
    ) -> Iterator[list[Driven]]:
        """Drives the episodes of a block from `first` on."""
        agent: Any = self._policy.agent
        known = () if self._policy.outside else episode_data(agent, episodes.scenes, episodes.episodes)
        known = jax.tree.map(np.asarray, known)
        # A policy outside JAX drives whole batches, as it does from the beginning.
        slots = _Slots(len(episodes), num_envs, first // num_envs * num_envs if self._policy.outside else first)
        state = self._started(episodes, known, np.maximum(slots.episode, 0))
        while not slots.idle.all():
            state, steps = self._outside(state) if self._policy.outside else self._inside(state)
            if on_compiled is not None:
                on_compiled()
                on_compiled = None
            slots.take(steps)
            yield [self._driven(steps, episodes, i) for i, steps in slots.in_order() if i >= first]
            # A policy outside JAX is reset only for all its episodes together.
            if (not self._policy.outside or slots.idle.all()) and len(envs := slots.refill()):
                fresh = self._started(episodes, known, np.maximum(slots.episode, 0))
                state = self._replace(np.isin(np.arange(num_envs), envs), fresh, state)

    def _started(self, episodes: EpisodeSet, known: Any, rows: np.ndarray) -> "_State":
        """First states of the episodes `rows`, one for each env."""
        agent: Any = self._policy.agent
        episodes = episodes.part(rows)
        if self._policy.outside and isinstance(agent, Beginning):
            agent.begin(len(rows))
        memory = agent.first_memory() if isinstance(agent, Recurrent) and not self._policy.outside else ()
        keys = episodes.keys()
        return _State(
            self._begin(keys, jnp.asarray(episodes.scenes), jnp.asarray(episodes.episodes)),
            jax.tree.map(lambda x: jnp.broadcast_to(x, (len(rows), *x.shape)), memory),
            keys,
            jax.tree.map(lambda x: jnp.asarray(x[rows]), known),
            self._first_noise(keys),
        )

    def _driven(self, steps: Steps, episodes: EpisodeSet, i: int) -> Driven:
        assert episodes.seeds is not None
        return Driven(
            scene=int(episodes.scenes[i]),
            row=int(episodes.episodes[i]),
            seed=int(episodes.seeds[i]),
            steps=steps,
            result=RESULTS[int(steps.result[-1]) - 1],
            route_completion=float(np.clip(steps.route_share[-1], 0.0, 1.0)),
        )

    def _inside(self, state: "_State") -> tuple["_State", Steps]:
        state, steps = self._chunk(state)
        return state, jax.tree.map(np.asarray, steps)

    def _outside(self, state: "_State") -> tuple["_State", Steps]:
        agent: Any = self._policy.agent
        obs = self._observe(state.nav)
        shape = (state.nav.result.shape[0], self._env.action_size)
        action = checked_actions(self._policy.name, agent, obs, shape)
        nav, steps = self._step(state.nav, obs, jnp.asarray(action, jnp.float32), state.noise)
        noise = self._next_noise(state.noise)
        return state._replace(nav=nav, noise=noise), jax.tree.map(lambda x: np.asarray(x)[None], steps)

    def _scan(self, state: "_State") -> tuple["_State", Steps]:
        agent: Any = self._policy.agent

        def act(nav: "NavState", obs: Any, memory: Any, key: jax.Array, known: Any) -> tuple[Any, Any, jax.Array]:
            key, now = jax.random.split(key)
            action, memory = agent_action(agent, nav, obs, known, memory, now)
            return action, memory, key

        def step(state: _State, _: None) -> tuple[_State, Steps]:
            obs = jax.vmap(self._env.observe)(state.nav)
            action, memory, keys = jax.vmap(act)(state.nav, obs, state.memory, state.keys, state.known)
            nav, steps = jax.vmap(self._advance)(state.nav, obs, action, state.noise)
            return _State(nav, memory, keys, state.known, self._noise_after(state.noise)), steps

        length = _STEPS_PER_CALL if jax.default_backend() == "cpu" else _STEPS_PER_DEVICE_CALL
        return jax.lax.scan(step, state, None, length=length)

    def _first_noise(self, keys: jax.Array) -> Any:
        """Of episodes with these keys."""
        own, size = self._noise, self._env.action_size
        return () if own is None else jax.vmap(lambda key: own.begin(key, size))(keys)

    def _noise_after(self, noise: Any) -> Any:
        """That of the next step, with a leading axis of envs."""
        dt, own = self._env.dt, self._noise
        return noise if own is None else jax.vmap(lambda state: own.next(state, dt))(noise)

    def _advance(self, nav: "NavState", obs: Any, action: jax.Array, noise: Any) -> tuple["NavState", Steps]:
        """One env one step on; an ended episode stands still as it ended."""
        env = self._env
        new, reward, _, _ = env.advance(nav, action if self._noise is None else disturbed(action, noise.value))
        running = nav.result == 0
        steps = Steps(
            running=running,
            goal=obs["goal"],
            proprio=env.named_observations(nav, obs)["state"][2:],
            action=new.last_action,
            answer=new.last_action if self._noise is None else jnp.clip(action, -1.0, 1.0),
            reward=reward,
            result=new.result,
            hit=new.sim.contacts.hit,
            xpos=nav.sim.xpos,
            xquat=nav.sim.xquat,
            agents=env.agents_of(nav),
            bodies=nav.sim.bodies,
            appearance_seed=nav.appearance_seed,
            route_share=new.route_done / jnp.maximum(new.route_length, 1e-6),
            qvel=nav.sim.qvel,
            contacts=new.sim.contacts,
        )
        return jax.tree.map(lambda a, b: jnp.where(running, a, b), new, nav), steps


def _replaced(mask: jax.Array, new: _State, old: _State) -> _State:
    """`new` in the envs of the mask (n,)."""
    return jax.tree.map(lambda a, b: jnp.where(mask.reshape(-1, *[1] * (jnp.ndim(b) - 1)), a, b), new, old)
