"""PPO fine-tuning of a student with a camera after imitation.

A privileged teacher with exact distances drives close to objects; a student with images needs larger margins, which it
can only learn from its own failures. The critic uses the teacher's observations and is trained alone at first, the
steps of the actor are small, and the teacher's labels stay in the loss with a decreasing weight. Algorithm: Schulman et
al., "Proximal Policy Optimization Algorithms", 2017, over whole sequences, so that a memory is trained through time;
the anchor: Schmitt et al., "Kickstarting Deep Reinforcement Learning", 2018.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import optax
from ml_collections import ConfigDict

from ..envs.navigation.ppo import finetune_config
from .dagger import make_student
from .devices import Devices
from .map_networks import MAP, VECTOR, MapCritic, MapTrunk
from .networks import PIXELS
from .sequences import LATERAL_ACTION, epochs, mirror_lateral, mirrored_target, mirrored_view, relit
from .student_learner import ENDS, LearnerState, StudentLearner, Teacher


def default_finetune_config() -> ConfigDict:
    """Returns a new configuration.

    Fields:
      num_envs, unroll_length: envs, and control steps of an iteration.
      epochs, minibatches: passes over an iteration's states, and parts (of envs) that a pass is cut into.
      learning_rate, final_learning_rate: of the actor, from the end of `critic_only` to the end of the training.
      critic_learning_rate: constant. critic_only: env-steps in which the actor does not change.
      noise: standard deviation of the actions around the student's; it does not learn.
      imitation, final_imitation: weight of the teacher's labels in the loss, at the begin and at the end.
        reward_scaling: factor of the rewards for the critic.
      auxiliary, mirror, light, pixel_noise, blur: as in `dagger.default_dagger_config`.
      map_layers, critic_hidden: of the critic.
    """
    return finetune_config()


class Batch(NamedTuple):
    """The data of an iteration; all (T, n, ...).

    Attributes:
      obs: `SEEN`, mirrored where the env is.
      privileged: the critic's observation, never mirrored.
      action: action of the student, not clipped.
      mean: mean of the distribution from which it was drawn.
      label: the teacher's action.
      target: map that the auxiliary output predicts.
      begins: bool.
      advantage, returns: f32, in scaled rewards.
    """

    obs: Any
    privileged: Any
    action: jax.Array
    mean: jax.Array
    label: jax.Array
    target: jax.Array
    begins: jax.Array
    advantage: jax.Array
    returns: jax.Array


def advantages(
    reward: jax.Array, done: jax.Array, value: jax.Array, last: jax.Array, discount: float, trace: float
) -> jax.Array:
    """Generalized advantage estimates (Schulman et al., 2016, equation 16).

    Args:
      reward, done, value: (T, n), of the step taken in each state.
      last: (n,) value of the state after them.
      discount, trace: gamma and lambda.

    Returns:
      (T, n). Time-outs count as ends too, because the critic observes the time left.
    """

    def back(carry: tuple[jax.Array, jax.Array], step: tuple[jax.Array, ...]) -> tuple[Any, jax.Array]:
        after, next_value = carry
        reward, done, value = step
        going = 1.0 - done
        after = reward + discount * going * next_value - value + discount * trace * going * after
        return (after, value), after

    start = jnp.zeros_like(last), last
    return jax.lax.scan(back, start, (reward, done, value), reverse=True)[1]


def clipped_gain(ratio: jax.Array, advantage: jax.Array, clip: float) -> jax.Array:
    """PPO's objective of each action (Schulman et al., "Proximal policy optimization", 2017, equation 7).

    Args:
      ratio: likelihood of the action now, divided by that when it was taken.
      clip: ratios farther from 1 than this gain nothing more.
    """
    return jnp.minimum(ratio * advantage, jnp.clip(ratio, 1.0 - clip, 1.0 + clip) * advantage)


def log_ratio(action: jax.Array, new: jax.Array, old: jax.Array, noise: float) -> jax.Array:
    """log p_new(action) - log p_old(action) of two normal distributions (..., k) with the same standard deviation."""
    return ((jnp.square(action - old) - jnp.square(action - new)) / (2.0 * noise**2)).sum(-1)


class Finetune(StudentLearner):
    """The algorithm; `params` of its state are {"actor": of the student, "critic"}.

    Args:
      env: see `StudentLearner`; its observations also include the critic's (`map_networks.VECTOR`).
      teacher, teacher_params: see `StudentLearner`.
      dagger_config: config of the student's training, with its network.
      config: see `default_finetune_config`.
      devices: see `StudentLearner`.
    """

    SECTION = "ppo.finetune"

    def __init__(
        self,
        env: Any,
        teacher: Teacher,
        dagger_config: ConfigDict,
        config: ConfigDict,
        teacher_params: Any = None,
        devices: Devices | None = None,
    ) -> None:
        adam = optax.chain(optax.clip_by_global_norm(config.max_grad_norm), optax.scale_by_adam())
        parts = {"actor": "actor", "critic": "critic"}
        optimizer = optax.multi_transform({"actor": adam, "critic": adam}, parts)
        student = make_student(dagger_config, env.action_size)
        super().__init__(env, teacher, student, optimizer, config, teacher_params, devices)
        layers = tuple(tuple(int(x) for x in layer) for layer in config.map_layers)
        self._critic = MapCritic(MapTrunk(layers, tuple(int(n) for n in config.critic_hidden)))  # type: ignore[arg-type]

    def actor(self, state: LearnerState) -> Any:
        return self.devices.local_copy(state.params["actor"])

    def _parameters(self, student: Any, obs: Any, key: jax.Array) -> Any:
        return {"actor": student, "critic": self._critic.init(key, obs[MAP][:1], obs[VECTOR][:1])}

    def _value(self, critic: Any, privileged: Any) -> jax.Array:
        return self._critic.apply(critic, privileged[MAP], privileged[VECTOR])  # type: ignore[return-value]

    def _rollout(
        self, state: LearnerState, teacher: Any, key: jax.Array
    ) -> tuple[LearnerState, Batch, dict[str, jax.Array]]:
        config = self.config

        def step(carry: Any, key: jax.Array) -> Any:
            env, memory, begins = carry
            key_teacher, key_noise, key_light = jax.random.split(key, 3)
            key_teacher, key_light = (self.devices.own_key(k) for k in (key_teacher, key_light))
            label = mirror_lateral(self.teacher(teacher, env, key_teacher), state.mirrored, LATERAL_ACTION)
            seen = mirrored_view(env.obs, state.mirrored)
            # Augmented here and not in the loss, because the actions' probabilities belong to these observations.
            seen[PIXELS] = relit(
                seen[PIXELS][None], key_light, config.light, config.pixel_noise, config.get("blur", 0.0)
            )[0]
            one = {name: x[None] for name, x in seen.items()}
            mean, memory, _ = self.student.apply(state.params["actor"], one, memory, begins[None])  # type: ignore[misc]
            noise = jax.random.normal(key_noise, (int(config.num_envs), mean.shape[-1]))
            action = mean[0] + config.noise * self.devices.rows(noise)
            privileged = {MAP: env.obs[MAP], VECTOR: env.obs[VECTOR]}
            target = mirrored_target(env.obs[MAP], state.mirrored)
            new = self.env.step(env, mirror_lateral(jnp.clip(action, -1.0, 1.0), state.mirrored, LATERAL_ACTION))
            value = self._value(state.params["critic"], privileged)
            reward = config.reward_scaling * new.reward
            # Advantages and returns are computed after the last step.
            kept = Batch(seen, privileged, action, mean[0], label, target, begins, reward, reward)
            counts = {name: new.metrics[name].sum() for name in (*ENDS, "slot_overflow")} | {"reward": new.reward.sum()}
            return (new, memory, new.done > 0), (kept, reward, new.done, value, counts)

        keys = jax.random.split(key, int(config.unroll_length))
        carry, (kept, reward, done, value, counts) = jax.lax.scan(step, (state.env, state.memory, state.begins), keys)
        env, memory, begins = carry
        last = self._value(state.params["critic"], {MAP: env.obs[MAP], VECTOR: env.obs[VECTOR]})
        gained = advantages(reward, done, value, last, config.discounting, config.gae_lambda)
        normal = (gained - self.devices.mean(gained.mean())) / (self.devices.std(gained) + 1e-6)
        batch = kept._replace(advantage=normal, returns=gained + value)
        variance = self.devices.variance
        explained = 1.0 - variance(gained) / jnp.maximum(variance(batch.returns), 1e-9)
        counts = self.devices.sum(jax.tree.map(lambda x: x.sum(), counts)) | {"explained": explained}
        return state._replace(env=env, memory=memory, begins=begins), batch, counts

    def _loss(self, params: Any, batch: Batch, memory: jax.Array, anchor: jax.Array) -> Any:
        config = self.config
        mean, _, predicted = self.student.apply(params["actor"], batch.obs, memory, batch.begins)  # type: ignore[misc]
        moved = log_ratio(batch.action, mean, batch.mean, config.noise)
        ratio = jnp.exp(jnp.clip(moved, -20.0, 20.0))
        actor = -clipped_gain(ratio, batch.advantage, config.clip).mean()
        critic = jnp.square(self._value(params["critic"], batch.privileged) - batch.returns).mean()
        imitation = optax.huber_loss(mean, batch.label, delta=0.5).sum(-1).mean()
        auxiliary = jnp.square(predicted - batch.target).mean()
        loss = actor + critic + anchor * imitation + config.auxiliary * auxiliary
        divergence = (jnp.square(mean - batch.mean) / (2.0 * config.noise**2)).sum(-1).mean()
        return loss, {"critic": critic, "imitation": imitation, "auxiliary": auxiliary, "kl": divergence}

    def _iterate(
        self, state: LearnerState, teacher: Any, progress: jax.Array
    ) -> tuple[LearnerState, dict[str, jax.Array]]:
        config = self.config
        key, key_roll, key_learn = jax.random.split(state.key, 3)
        memory = state.memory
        state, batch, counts = self._rollout(state, teacher, key_roll)
        cosine = 0.5 * (1.0 + jnp.cos(jnp.pi * progress))
        rate = config.final_learning_rate + (config.learning_rate - config.final_learning_rate) * cosine
        frozen = state.steps * self.steps_per_iteration < config.critic_only
        rates = {"actor": jnp.where(frozen, 0.0, rate), "critic": jnp.float32(config.critic_learning_rate)}
        anchor = config.imitation + (config.final_imitation - config.imitation) * progress

        def loss(params: Any, batch: Any, memory: jax.Array, key: jax.Array) -> tuple[jax.Array, Any]:
            del key
            return self._loss(params, batch, memory, anchor)

        start = state.params, state.optimizer
        (params, optimizer), reported = epochs(
            loss, self._optimizer, start, batch, memory, key_learn, rates, int(config.epochs), int(config.minibatches),
            self.devices,
        )  # fmt: skip
        state = state._replace(params=params, optimizer=optimizer, key=key, steps=state.steps + 1)
        ended = sum((counts[name] for name in ENDS), jnp.float32(0.0))
        shares = {name: counts[name] / jnp.maximum(ended, 1.0) for name in ENDS}
        per_step = {name: counts[name] / self.steps_per_iteration for name in ("reward", "slot_overflow")}
        return state, {**shares, **per_step, "ended": ended, "explained": counts["explained"], **reported}
