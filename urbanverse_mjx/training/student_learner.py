"""Shared by the algorithms that step envs with a camera student and query a teacher in each visited state.

`dagger.Dagger` imitates the teacher, `finetune.Finetune` continues by PPO. The observations of half of the envs are
mirrored (`sequences`).
"""

import abc
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import optax
from ml_collections import ConfigDict

from .devices import EQUAL, SPREAD, Devices
from .student import SEEN, Student

#: A teacher: function (parameters, `State` of n envs, key) -> actions (n, action_size). A network uses the observations
#: only, a planner also the robot's pose.
Teacher = Callable[[Any, Any, jax.Array], jax.Array]

#: Ends of an episode, by the names of the env's metrics.
ENDS = ("success", "hit", "off_traversable", "timeout")


class LearnerState(NamedTuple):
    """The training state between iterations.

    Attributes:
      params: of all networks that are trained.
      optimizer: of these parameters.
      env: `State` of all envs.
      memory: (n, memory) of the student.
      begins: (n,) bool, whether the current observation is the first of an episode.
      mirrored: (n,) bool.
      key: typed.
      steps: () i32 iterations done.
    """

    params: Any
    optimizer: Any
    env: Any
    memory: jax.Array
    begins: jax.Array
    mirrored: jax.Array
    key: jax.Array
    steps: jax.Array


#: Placement of a state on several devices, see `devices`.
_PLACEMENT = LearnerState._make((EQUAL, EQUAL, SPREAD, SPREAD, SPREAD, SPREAD, EQUAL, EQUAL))


class StudentLearner(abc.ABC):
    """An algorithm over a wrapped env (`wrap_for_training`); a subclass gives parameters and an iteration.

    Args:
      env: batched, auto-resetting environment whose observations include `SEEN`, `privileged_map` and those of the
        teacher.
      teacher: function (parameters, state of the envs, key) -> actions.
      student: the network.
      optimizer: of all parameters; its update is multiplied by the learning rate, which depends on the progress.
      config: with `num_envs`, `unroll_length`, `mirror` and `seed`.
      teacher_params: parameters of the teacher; may be set later with the same shapes.
      devices: over which the envs are spread; default: all of JAX.

    Raises:
      ValidationError: the envs do not divide into equal shares of minibatches, or episodes are drawn by their success
        rates, which every device would count by itself.
    """

    #: Where a training's config has that of the algorithm, for errors.
    SECTION = "ppo"

    def __init__(
        self,
        env: Any,
        teacher: Teacher,
        student: Student,
        optimizer: optax.GradientTransformation,
        config: ConfigDict,
        teacher_params: Any = None,
        devices: Devices | None = None,
    ) -> None:
        self.env, self.teacher, self.config = env, teacher, config
        self.devices = devices or Devices.every()
        self.devices.check_shares(int(config.num_envs), {f"{self.SECTION}.minibatches": int(config.minibatches)})
        self.devices.check_draws(env.learns_episodes)
        held = getattr(env, "held", None)
        self.devices.check_places(held)
        self.teacher_params = teacher_params
        self.student, self._optimizer = student, optimizer
        self.steps_per_iteration = int(config.num_envs) * int(config.unroll_length)
        self._reset = self.devices.run(env.reset, (SPREAD,), SPREAD, held=held)
        self._gone_reset = self.devices.run(self._reset_gone, (_PLACEMENT, EQUAL), _PLACEMENT, donate=0, held=held)
        # The teacher's parameters are an argument, so that the compiled function does not depend on them.
        self._compiled: Any = self.devices.run(
            self._iterate, (_PLACEMENT, EQUAL, EQUAL), (_PLACEMENT, EQUAL), donate=0, held=held
        )  # fmt: skip

    @property
    def teacher_params(self) -> Any:
        """Parameters of the teacher, on the devices."""
        return self._teacher_params

    @teacher_params.setter
    def teacher_params(self, params: Any) -> None:
        self._teacher_params = self.devices.place(params, EQUAL)

    def compile(self, student: Any = None) -> None:
        """Compiles an iteration ahead of the first one, from shapes alone; student: as for `begin`, or shapes."""
        state = jax.eval_shape(self.begin, student)
        self._compiled = self._compiled.lower(state, self.teacher_params, jnp.float32(0.0)).compile()

    def iterate(self, state: LearnerState, progress: jax.Array) -> tuple[LearnerState, dict[str, jax.Array]]:
        """Runs one iteration; donates the buffers of `state`. Returns the new state and metrics.

        Args:
          progress: () in [0, 1], progress of the whole training, which determines the learning rate.
        """
        return self._compiled(state, self.teacher_params, self.devices.place(progress, EQUAL))

    def reset_gone(self, state: LearnerState, gone: jax.Array) -> LearnerState:
        """The state in which the envs whose scene has gone (Z,) begin new episodes; donates the buffers of `state`."""
        return self._gone_reset(state, gone)

    def _reset_gone(self, state: LearnerState, gone: jax.Array) -> LearnerState:
        env, begins = self.env.reset_gone(state.env, gone)
        return state._replace(env=env, begins=state.begins | begins)

    def begin(self, student: Any = None) -> LearnerState:
        """The state before the first iteration; student: parameters of the initial student, by default random ones."""
        return self.devices.create(lambda: self._first_state(student), _PLACEMENT)

    def placed(self, state: LearnerState) -> LearnerState:
        """A state of a file, on the devices."""
        return self.devices.place(state, _PLACEMENT)

    def _first_state(self, student: Any) -> LearnerState:
        n = int(self.config.num_envs)
        key, key_env, key_net = jax.random.split(jax.random.key(int(self.config.seed)), 3)
        env = self._reset(jax.random.split(key_env, n))
        memory, begins = self.student.first_memory(n), jnp.ones(n, bool)
        if student is None:
            one = {name: env.obs[name][None, :1] for name in SEEN}
            student = jax.jit(self.student.init)(key_net, one, memory[:1], begins[None, :1])
        else:
            # Copies, because the state is donated and the caller's arrays must stay valid.
            student = jax.tree.map(jnp.array, student)
        params = self._parameters(student, env.obs, key_net)
        mirrored = (jnp.arange(n) % 2 == 1) & bool(self.config.mirror)
        optimizer = self._optimizer.init(params)
        return LearnerState(params, optimizer, env, memory, begins, mirrored, key, jnp.zeros((), jnp.int32))

    def actor(self, state: LearnerState) -> Any:
        """The parameters of the student in a state, on one device."""
        return self.devices.local_copy(state.params)

    @abc.abstractmethod
    def _parameters(self, student: Any, obs: Any, key: jax.Array) -> Any:
        """All parameters before the first iteration, given those of the student and the observations of n envs."""

    @abc.abstractmethod
    def _iterate(
        self, state: LearnerState, teacher: Any, progress: jax.Array
    ) -> tuple[LearnerState, dict[str, jax.Array]]:
        """An iteration, traced on each device with its share of the envs; teacher: its parameters. Returns the new
        state and metrics, which are equal on all devices."""
