"""DAgger: a student with a camera imitates a privileged teacher, which labels the states that the student visits.

Every iteration steps all envs for a few control steps, mostly by the student and in some envs by the teacher, queries
the teacher's action in each visited state, and fits the student to these labels; older data are dropped. (Ross et al.,
"A Reduction of Imitation Learning and Structured Prediction to No-Regret Online Learning", 2011.)
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import optax
from ml_collections import ConfigDict

from ..envs.navigation.ppo import imitation_config
from .devices import Devices
from .map_networks import MAP
from .networks import PIXELS
from .sequences import LATERAL_ACTION, epochs, mirror_lateral, mirrored_target, mirrored_view, relit
from .student import Student
from .student_learner import ENDS, LearnerState, StudentLearner, Teacher


def default_dagger_config() -> ConfigDict:
    """Returns a new configuration.

    Fields:
      algorithm: "dagger", the type tag of a saved policy. num_envs, unroll_length: envs, and control steps of an
        iteration.
      epochs, minibatches: passes over an iteration's states, and parts (of envs) that a pass is cut into.
      teacher_share: of the envs that the teacher drives; `warm_up` env-steps long it falls from 1 to that.
      noise: standard deviation of the noise on the student's actions.
      auxiliary: weight of the predicted map in the loss.
      mirror: half of the envs have mirrored observations. light, pixel_noise: share by which brightness, contrast and
        colour of a sequence differ, and standard deviation of each pixel, both of the full range. blur: the strongest
        blur of a sequence (`camera_noise.blurred`).
    """
    return imitation_config()


def make_student(config: ConfigDict, action_size: int) -> Student:
    """Makes the network of `config.network`."""
    network = config.network
    layers = tuple((int(a), int(b), int(c)) for a, b, c in network.layers)
    dtype = jnp.bfloat16 if network.bfloat16 else jnp.float32
    # Absent from configurations of older policies.
    proprio, last_action = (bool(network.get(name, True)) for name in ("proprio", "last_action"))
    return Student(
        layers, action_size, int(network.hidden), int(network.memory), proprio, dtype, network.convolution,
        last_action=last_action,
    )  # fmt: skip


class Batch(NamedTuple):
    """The data of an iteration; all (T, n, ...).

    Attributes:
      obs: `SEEN`.
      label: the teacher's actions.
      target: map that the auxiliary output predicts.
      begins: bool.
    """

    obs: Any
    label: jax.Array
    target: jax.Array
    begins: jax.Array


class Dagger(StudentLearner):
    """The algorithm; `params` of its state are those of the student.

    Args:
      env, teacher, teacher_params: see `StudentLearner`.
      config: see `default_dagger_config`.
      devices: see `StudentLearner`.
    """

    def __init__(
        self, env: Any, teacher: Teacher, config: ConfigDict, teacher_params: Any = None, devices: Devices | None = None
    ) -> None:
        optimizer = optax.chain(optax.clip_by_global_norm(config.max_grad_norm), optax.scale_by_adam())
        student = make_student(config, env.action_size)
        super().__init__(env, teacher, student, optimizer, config, teacher_params, devices)
        self._rate = optax.cosine_decay_schedule(
            config.learning_rate, 1, config.final_learning_rate / config.learning_rate
        )

    def _parameters(self, student: Any, obs: Any, key: jax.Array) -> Any:
        return student

    def _share(self, iterations: jax.Array) -> jax.Array:
        """Share of the envs that the teacher drives."""
        done = iterations * self.steps_per_iteration / max(int(self.config.warm_up), 1)
        return jnp.maximum(1.0 - done, 0.0) * (1.0 - self.config.teacher_share) + self.config.teacher_share

    def _rollout(
        self, state: LearnerState, teacher: Any, key: jax.Array
    ) -> tuple[LearnerState, Batch, dict[str, jax.Array]]:
        key_share, key_steps = jax.random.split(key)
        n = int(self.config.num_envs)
        taught = self.devices.rows(jax.random.uniform(key_share, (n,))) < self._share(state.steps)

        def step(carry: Any, key: jax.Array) -> Any:
            env, memory, begins = carry
            key_teacher, key_noise = jax.random.split(key)
            label = self.teacher(teacher, env, self.devices.own_key(key_teacher))
            seen = mirrored_view(env.obs, state.mirrored)
            one = {name: x[None] for name, x in seen.items()}
            own, memory, _ = self.student.apply(state.params, one, memory, begins[None])  # type: ignore[misc]
            own = mirror_lateral(own[0], state.mirrored, LATERAL_ACTION)
            own = own + self.config.noise * self.devices.rows(jax.random.normal(key_noise, (n, own.shape[-1])))
            action = jnp.clip(jnp.where(taught[:, None], label, own), -1.0, 1.0)
            label = mirror_lateral(label, state.mirrored, LATERAL_ACTION)
            out = Batch(seen, label, mirrored_target(env.obs[MAP], state.mirrored), begins)
            new = self.env.step(env, action)
            ended = {name: new.metrics[name] * ~taught for name in ENDS}
            counts = {**{k: x.sum() for k, x in ended.items()}, "slot_overflow": new.metrics["slot_overflow"].sum()}
            return (new, memory, new.done > 0), (out, counts)

        carry = state.env, state.memory, state.begins
        keys = jax.random.split(key_steps, int(self.config.unroll_length))
        (env, memory, begins), (batch, counts) = jax.lax.scan(step, carry, keys)
        counts = self.devices.sum(jax.tree.map(lambda x: x.sum(), counts))
        return state._replace(env=env, memory=memory, begins=begins), batch, counts

    def _loss(self, params: Any, batch: Batch, memory: jax.Array, key: jax.Array) -> tuple[jax.Array, Any]:
        pixels = relit(batch.obs[PIXELS], key, self.config.light, self.config.pixel_noise, self.config.get("blur", 0.0))
        own, _, predicted = self.student.apply(params, {**batch.obs, PIXELS: pixels}, memory, batch.begins)  # type: ignore[misc]
        imitation = optax.huber_loss(own, batch.label, delta=0.5).sum(-1).mean()
        auxiliary = jnp.square(predicted - batch.target).mean()
        return imitation + self.config.auxiliary * auxiliary, (imitation, auxiliary)

    def _learn(self, state: LearnerState, batch: Batch, memory: jax.Array, key: jax.Array, rate: jax.Array) -> Any:
        """Trains over an iteration's sequences; memory: (n, memory) at their beginning; rate: () learning rate."""
        return epochs(
            self._loss, self._optimizer, (state.params, state.optimizer), batch, memory, key, rate,
            int(self.config.epochs), int(self.config.minibatches), self.devices,
        )  # fmt: skip

    def _iterate(
        self, state: LearnerState, teacher: Any, progress: jax.Array
    ) -> tuple[LearnerState, dict[str, jax.Array]]:
        key, key_roll, key_learn = jax.random.split(state.key, 3)
        memory = state.memory
        state, batch, counts = self._rollout(state, teacher, key_roll)
        learnt = self._learn(state, batch, memory, key_learn, self._rate(progress))
        (params, optimizer), (imitation, auxiliary) = learnt
        state = state._replace(params=params, optimizer=optimizer, key=key, steps=state.steps + 1)
        ended = sum((counts[name] for name in ENDS), jnp.float32(0.0))
        shares = {name: counts[name] / jnp.maximum(ended, 1.0) for name in ENDS}
        overflow = counts["slot_overflow"] / self.steps_per_iteration
        return state, {**shares, "ended": ended, "imitation": imitation, "auxiliary": auxiliary, "overflow": overflow}
