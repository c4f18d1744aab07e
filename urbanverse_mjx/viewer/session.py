"""Runs robots of one environment through episodes of one scene step by step and keeps every state.

In: an environment, its policy, a scene and rows of its episode table. Out:  `Frame`s: the states, as
stepping the environment gives them. When: while a page shows them; this module does not depend on the page.
"""

import dataclasses
import threading
from collections.abc import Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from .. import table_arguments
from ..datatypes import RESULTS, AgentMotion, ValidationError, outcome_of
from ..envs import NavEnv, NavState
from ..evaluation.agents import Agent, BatchAgent, Beginning, Privileged, Recurrent, agent_action, episode_data
from ..evaluation.planner import Planner, waypoint_of
from ..evaluation.rollouts import EpisodeSet
from .teleop import Command

IMAGE = "pixels/front"


@dataclasses.dataclass(frozen=True)
class NamedPolicy:
    """A policy and how to call it.

    Attributes:
      name: shown to people.
      agent: called inside jit, see `evaluation.agents`; a `BatchAgent` where `outside`.
      outside: whether it is called outside jit, as an ONNX file is.
      loaded: name of the policy folder or file that was loaded; None for a scripted policy.
      sha256: of its content, 64 hexadecimal digits; None for a scripted policy.
    """

    name: str
    agent: Agent | Privileged | Recurrent | BatchAgent
    outside: bool = False
    loaded: str | None = None
    sha256: str | None = None


class Frame(NamedTuple):
    """States of n robots at one time.

    Attributes:
      nav: their states, leading axis n.
      action: (n, A) that led to this frame; 0 in the first one.
      by_hand: (n,) bool, whether a person chose it.
      reward: (n,) of the step that led to this frame; 0 in the first one.
    """

    nav: NavState
    action: np.ndarray
    by_hand: np.ndarray
    reward: np.ndarray


class Machine:
    """An environment and a policy, compiled once for any number of sessions.

    Args:
      env: the environment.
      policy: the policy.
    """

    def __init__(self, env: NavEnv, policy: NamedPolicy) -> None:
        self.env, self.policy = env, policy
        self.begin = table_arguments.jit(jax.vmap(env.begin_at))
        self.observe = table_arguments.jit(jax.vmap(env.observe))
        self.act = table_arguments.jit(jax.vmap(self._act))
        self.advance = table_arguments.jit(jax.vmap(self._advance))
        # Without pixels, so that a request for the image of one robot does not render the others.
        self._image = table_arguments.jit(lambda nav: env.observe(nav)[IMAGE])
        self.agents = table_arguments.jit(jax.vmap(self._agents))
        #: Held while a session compiles, so that two threads do not compile the same program.
        self.compiling = threading.Lock()

    def camera_image(self, nav: NavState) -> np.ndarray | None:
        """(H, W, 3) u8 of the camera of one robot, or None without a renderer; nav: its state."""
        if self.env.renderer is None:
            return None
        return np.asarray(self._image(nav))[..., :3]

    def action_of(self, command: Command) -> np.ndarray:
        """Returns the action (2,) in [-1, 1] that follows a person's command as closely as possible.

        Raises:
          ValidationError: actions of this environment are commands of joints.
        """
        robot, mode = self.env.robot, self.env.config.action_mode
        if mode == "waypoint":
            speed, turn = command.speed * robot.max_speed, command.turn * robot.max_yaw_rate
            return np.array(waypoint_of(speed, turn, robot.max_speed, self.env.dt), np.float32)
        if mode == "velocity":
            return np.array([2.0 * command.speed - 1.0, command.turn], np.float32)
        raise ValidationError(
            f"config.action_mode: found {mode!r}, needed 'waypoint' or 'velocity' for a robot that is driven by hand."
        )

    def _act(self, nav: NavState, memory: Any, known: Any, key: jax.Array) -> tuple[jax.Array, Any, jax.Array]:
        """Returns the action of one robot, its memory and its next key; keys are derived as in `Rollout`."""
        key, now = jax.random.split(key)
        agent = self.policy.agent
        action, memory = agent_action(agent, nav, self.env.observe(nav), known, memory, now)  # type: ignore[arg-type]
        return action, memory, key

    def _advance(self, nav: NavState, action: jax.Array) -> tuple[NavState, jax.Array]:
        """Runs one control step; returns its reward. An ended episode keeps its state."""
        new, reward, _, _ = self.env.advance(nav, action)
        running = nav.result == 0
        return jax.tree.map(lambda a, b: jnp.where(running, a, b), new, nav), jnp.where(running, reward, 0.0)

    def _agents(self, nav: NavState) -> AgentMotion | None:
        if self.env.dynamic is None or nav.crowd is None:
            return None
        return self.env.dynamic.places(nav.crowd, nav.sim.scene)


class Session:
    """Running episodes of one scene with one policy.

    Args:
      machine: the environment and its policy.
      scene: row of the bank.
      rows: (n,) of the scene's episode table, one for each robot; robots do not interact.
      seed: of random policies and streets.
      keys: (n,) of the episodes in its place, as `EpisodeSet.keys`.
      known: (n, ...) result of `evaluation.agents.episode_data` for the episodes, if computed before.

    Raises:
      ValidationError: no such scene or row, or no robot.
    """

    def __init__(
        self,
        machine: Machine,
        scene: int,
        rows: Sequence[int],
        seed: int = 0,
        keys: jax.Array | None = None,
        known: Any = None,
    ) -> None:
        bank = machine.env.bank
        if not 0 <= scene < bank.num_scenes:
            raise ValidationError(f"scene: found {scene}, needed one of the bank's {bank.num_scenes}.")
        number = int(bank.num_episodes[scene])
        if not rows or not all(0 <= row < number for row in rows):
            raise ValidationError(f"episodes: found {list(rows)}, needed some of 0 to {number - 1} of this scene.")
        self.machine, self.scene, self.rows = machine, scene, tuple(rows)
        count = len(rows)
        scenes = np.full(count, scene, np.int32)
        episodes = EpisodeSet(scenes, np.asarray(rows, np.int32), seed)
        self._key = episodes.keys() if keys is None else keys
        nav = machine.begin(self._key, jnp.asarray(scenes), jnp.asarray(episodes.episodes))
        self._memory, self._known = (), ()
        self._compiled = False
        agent: Any = machine.policy.agent
        if machine.policy.outside:
            if isinstance(agent, Beginning):
                agent.begin(count)
        else:
            self._known = known
            if known is None:
                self._known = episode_data(agent, scenes, episodes.episodes)
                if isinstance(agent, Planner):
                    # Else the planner is compiled again with every episode's window.
                    self._known = agent.widened(self._known)
            first = agent.first_memory() if isinstance(agent, Recurrent) else ()
            self._memory = jax.tree.map(lambda x: jnp.broadcast_to(x, (count, *x.shape)), first)
        nothing = np.zeros((count, machine.env.action_size), np.float32)
        self.frames: list[Frame] = []
        self._root_positions: list[np.ndarray] = []
        self._keep(Frame(nav, nothing, np.zeros(count, bool), np.zeros(count, np.float32)))

    def __len__(self) -> int:
        return len(self.frames)

    @property
    def num_robots(self) -> int:
        return len(self.rows)

    @property
    def over(self) -> bool:
        """Returns whether every robot's episode has ended."""
        return bool((np.asarray(self.frames[-1].nav.result) != 0).all())

    def compile(self) -> None:
        """Compiles a step unless a session of this machine has done so; no state changes. Of several threads that call
        it for one machine, each waits for the one before. A second call does nothing."""
        nav = self.frames[0].nav
        with self.machine.compiling:
            if self._compiled:
                return
            # The simulation first: it takes longer than most policies.
            self.machine.advance(nav, jnp.zeros((self.num_robots, self.machine.env.action_size)))
            if not self.machine.policy.outside:
                self.machine.act(nav, self._memory, self._known, self._key)
            self._compiled = True

    def step(self, by_hand: dict[int, np.ndarray] | None = None) -> Frame:
        """Runs one control step of all robots; ended ones stand still.

        Args:
          by_hand: robot -> its action (A,) from a person, instead of the policy's; the policy is still called, so that
            its memory is current when it takes over again.

        Raises:
          ValidationError: the policy's actions are not finite or have another shape.
        """
        nav = self.frames[-1].nav
        action = self._answers(nav)
        chosen = np.zeros(self.num_robots, bool)
        for robot, value in (by_hand or {}).items():
            action[robot], chosen[robot] = value, True
        new, reward = self.machine.advance(nav, jnp.asarray(action))
        frame = Frame(new, action, chosen, np.asarray(reward))
        self._keep(frame)
        return frame

    def _keep(self, frame: Frame) -> None:
        env = self.machine.env
        root = env.mj_model.body(env.robot.root_body).id
        self.frames.append(frame)
        self._root_positions.append(np.asarray(frame.nav.sim.xpos)[:, root])

    def _answers(self, nav: NavState) -> np.ndarray:
        machine = self.machine
        if machine.policy.outside:
            agent: Any = machine.policy.agent
            action = np.array(agent(jax.tree.map(np.asarray, machine.observe(nav))), np.float32)
        else:
            answers, self._memory, self._key = machine.act(nav, self._memory, self._known, self._key)
            action = np.array(answers, np.float32)
        wanted = (self.num_robots, machine.env.action_size)
        if action.shape != wanted or not np.isfinite(action).all():
            raise ValidationError(
                f"policy {machine.policy.name!r}: found actions of shape {action.shape}"
                f"{'' if np.isfinite(action).all() else ' with NaN'}, needed finite ones of shape {wanted}."
            )
        return action

    def camera_image(self, index: int, robot: int = 0) -> np.ndarray | None:
        """(H, W, 3) u8: image of a robot's camera in a frame; None without a renderer."""
        return self.machine.camera_image(jax.tree.map(lambda x: x[robot], self.frames[index].nav))

    def agents(self, index: int, robot: int = 0) -> AgentMotion | None:
        """Returns the poses of the moving agents around a robot in a frame, fields (A, ...), or None without agents."""
        found = self.machine.agents(self.frames[index].nav)
        return None if found is None else AgentMotion(*(np.asarray(x)[robot] for x in found))

    def by_hand(self, index: int, robot: int = 0) -> np.ndarray:
        """Returns (index,) bool, the steps up to a frame that a person drove."""
        return np.array([frame.by_hand[robot] for frame in self.frames[1 : index + 1]], bool)

    def path(self, index: int, robot: int = 0) -> np.ndarray:
        """Returns (index + 1, 3) m, the positions of a robot up to a frame."""
        return np.array([positions[robot] for positions in self._root_positions[: index + 1]])

    def outcome(self, index: int, robot: int = 0) -> str | None:
        """Returns how a robot's episode ended by a frame, of `datatypes.OUTCOMES`, or None while it continues."""
        nav = self.frames[index].nav
        result = int(np.asarray(nav.result)[robot])
        only_ground = bool(np.asarray(nav.sim.contacts.only_ground)[robot])
        return outcome_of(RESULTS[result - 1], only_ground) if result else None
