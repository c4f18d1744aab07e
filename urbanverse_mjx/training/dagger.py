"""Imitation of a privileged teacher by a student with a camera: DAgger, the student drives and the teacher labels.

Every iteration steps all envs for a few control steps, mostly by the student and in some envs by the teacher, asks the
teacher what it would have done in each visited state, and fits the student to these answers; nothing older is kept.
(Ross et al., "A Reduction of Imitation Learning and Structured Prediction to No-Regret Online Learning", 2011.)

Half of the envs are seen in a mirror: picture, goal, speeds and labels are flipped left to right, and the student's
action is flipped back before it drives. Streets and their mirror images are equally likely, so this doubles them.
"""

import time
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import optax
from ml_collections import ConfigDict

from .map_networks import MAP_SHAPE
from .networks import PIXELS
from .student import SEEN, Student, predicted_target

#: (observations of n envs, key) -> actions (n, action_size): a teacher.
Teacher = Callable[[Mapping[str, jax.Array], jax.Array], jax.Array]


def default_dagger_config() -> ConfigDict:
    """A fresh configuration.

    Fields:
      algorithm: "dagger", by which a saved policy says what it is.
      num_envs, unroll_length: envs, and control steps of an iteration.
      epochs, minibatches: passes over an iteration's states, and parts (of envs) that a pass is cut into.
      teacher_share: of the envs that the teacher drives; `warm_up` env-steps long it falls from 1 to that.
      noise: standard deviation of what is added to the student's actions.
      auxiliary: weight of the predicted map in the loss.
      mirror: half of the envs are seen in a mirror.
      light, pixel_noise: share by which brightness, contrast and colour of a sequence differ, and standard deviation
        of each pixel, both of the full range.
    """
    return ConfigDict(
        {
            "algorithm": "dagger",
            "num_envs": 4096,
            "unroll_length": 16,
            "epochs": 2,
            "minibatches": 8,
            "learning_rate": 5e-4,
            "final_learning_rate": 3e-5,
            "max_grad_norm": 1.0,
            "teacher_share": 0.2,
            "warm_up": 2_000_000,
            "noise": 0.1,
            "auxiliary": 0.5,
            "mirror": True,
            "light": 0.2,
            "pixel_noise": 0.01,
            "seed": 0,
            "network": {
                "layers": ((32, 4, 2), (64, 4, 2), (64, 4, 2)),
                "hidden": 256,
                "memory": 256,
                "bfloat16": True,
                "convolution": "auto",
            },
        }
    )


def make_student(config: ConfigDict, action_size: int) -> Student:
    """The network that `config.network` describes."""
    network = config.network
    layers = tuple((int(a), int(b), int(c)) for a, b, c in network.layers)
    dtype = jnp.bfloat16 if network.bfloat16 else jnp.float32
    return Student(layers, action_size, int(network.hidden), int(network.memory), dtype, network.convolution)


class DaggerState(NamedTuple):
    """What training carries from one iteration to the next.

    Attributes:
      params, optimizer: of the student. env: `State` of all envs.
      memory: (n, memory). begins: (n,) bool, the present observation is the first of an episode.
      mirrored: (n,) bool. key: typed. steps: () i32 iterations done.
    """

    params: Any
    optimizer: Any
    env: Any
    memory: jax.Array
    begins: jax.Array
    mirrored: jax.Array
    key: jax.Array
    steps: jax.Array


class Batch(NamedTuple):
    """What an iteration learns from; all (T, n, ...).

    Attributes:
      obs: `SEEN`. label: the teacher's actions. target: the map to predict. begins: bool.
    """

    obs: Any
    label: jax.Array
    target: jax.Array
    begins: jax.Array


def mirror_lateral(values: jax.Array, mirrored: jax.Array, lateral: tuple[int, ...]) -> jax.Array:
    """Values (n, k) with the components `lateral` of the envs `mirrored` (n,) negated."""
    sign = jnp.ones(values.shape[-1]).at[jnp.array(lateral)].set(-1.0)
    return jnp.where(mirrored[:, None], values * sign, values)


def _mirrored_view(obs: Mapping[str, jax.Array], mirrored: jax.Array) -> dict[str, jax.Array]:
    """`SEEN` of n envs as the student sees them; proprio is (forward, lateral, yaw rate, action x, action y)."""
    wide = mirrored[:, None, None, None]
    return {
        PIXELS: jnp.where(wide, obs[PIXELS][:, :, ::-1], obs[PIXELS]),
        "goal": mirror_lateral(obs["goal"], mirrored, (1,)),
        "proprio": mirror_lateral(obs["proprio"], mirrored, (1, 2, 4)),
    }


def relit(pixels: jax.Array, key: jax.Array, light: float, noise: float) -> jax.Array:
    """Pictures (T, n, H, W, 3) u8 with another exposure, contrast and colour for each of the n sequences."""
    if light == 0.0 and noise == 0.0:
        return pixels
    n = pixels.shape[1]
    keys = jax.random.split(key, 3)
    gain = 1.0 + light * jax.random.uniform(keys[0], (n, 1, 1, 3), minval=-1.0, maxval=1.0)
    gain = gain * (1.0 + light * jax.random.uniform(keys[1], (n, 1, 1, 1), minval=-1.0, maxval=1.0))
    x = pixels.astype(jnp.bfloat16) * gain.astype(jnp.bfloat16)
    x = x + (255.0 * noise) * jax.random.normal(keys[2], pixels.shape, jnp.bfloat16)
    return jnp.clip(x, 0.0, 255.0).astype(jnp.uint8)


class Dagger:
    """The algorithm over a wrapped env (`wrap_for_training`).

    Args:
      env: batched and auto-resetting; its observations hold `SEEN`, `privileged_map` and what the teacher sees.
      teacher: (observations, key) -> actions.
      config: see `default_dagger_config`.
    """

    def __init__(self, env: Any, teacher: Teacher, config: ConfigDict) -> None:
        self.env, self.teacher, self.config = env, teacher, config
        self.student = make_student(config, env.action_size)
        self._rate = optax.cosine_decay_schedule(
            config.learning_rate, 1, config.final_learning_rate / config.learning_rate
        )
        # Times the learning rate, which follows the progress of the training.
        self._optimizer = optax.chain(optax.clip_by_global_norm(config.max_grad_norm), optax.scale_by_adam())
        self.steps_per_iteration = int(config.num_envs) * int(config.unroll_length)
        self.iterate = jax.jit(self._iterate, donate_argnums=0)

    def begin(self, params: Any = None) -> DaggerState:
        """The state before the first iteration; params: of a student to go on from."""
        n = int(self.config.num_envs)
        key, key_env, key_net = jax.random.split(jax.random.key(int(self.config.seed)), 3)
        env = jax.jit(self.env.reset)(jax.random.split(key_env, n))
        memory = self.student.first_memory(n)
        begins = jnp.ones(n, bool)
        if params is None:
            one = {name: env.obs[name][None, :1] for name in SEEN}
            params = jax.jit(self.student.init)(key_net, one, memory[:1], begins[None, :1])
        mirrored = (jnp.arange(n) % 2 == 1) & bool(self.config.mirror)
        return DaggerState(
            params, self._optimizer.init(params), env, memory, begins, mirrored, key, jnp.zeros((), jnp.int32)
        )

    def _share(self, iterations: jax.Array) -> jax.Array:
        """Of the envs that the teacher drives."""
        done = iterations * self.steps_per_iteration / max(int(self.config.warm_up), 1)
        return jnp.maximum(1.0 - done, 0.0) * (1.0 - self.config.teacher_share) + self.config.teacher_share

    def _rollout(self, state: DaggerState, key: jax.Array) -> tuple[DaggerState, Batch, dict[str, jax.Array]]:
        key_share, key_steps = jax.random.split(key)
        n = int(self.config.num_envs)
        taught = jax.random.uniform(key_share, (n,)) < self._share(state.steps)

        def step(carry: Any, key: jax.Array) -> Any:
            env, memory, begins = carry
            key_teacher, key_noise = jax.random.split(key)
            label = self.teacher(env.obs, key_teacher)
            seen = _mirrored_view(env.obs, state.mirrored)
            one = {name: x[None] for name, x in seen.items()}
            own, memory, _ = self.student.apply(state.params, one, memory, begins[None])  # type: ignore[misc]
            own = mirror_lateral(own[0], state.mirrored, (1,))
            own = own + self.config.noise * jax.random.normal(key_noise, own.shape)
            action = jnp.clip(jnp.where(taught[:, None], label, own), -1.0, 1.0)
            distances = env.obs["privileged_map"].reshape(-1, *MAP_SHAPE)
            # The second axis of the map runs from right to left.
            distances = jnp.where(state.mirrored[:, None, None, None], distances[:, :, ::-1], distances)
            label = mirror_lateral(label, state.mirrored, (1,))
            out = Batch(seen, label, predicted_target(distances), begins)
            new = self.env.step(env, action)
            ended = {name: new.metrics[name] * ~taught for name in ("success", "hit", "off_traversable", "timeout")}
            counts = {**{k: x.sum() for k, x in ended.items()}, "slot_overflow": new.metrics["slot_overflow"].sum()}
            return (new, memory, new.done > 0), (out, counts)

        carry = state.env, state.memory, state.begins
        keys = jax.random.split(key_steps, int(self.config.unroll_length))
        (env, memory, begins), (batch, counts) = jax.lax.scan(step, carry, keys)
        counts = jax.tree.map(lambda x: x.sum(), counts)
        return state._replace(env=env, memory=memory, begins=begins), batch, counts

    def _loss(self, params: Any, batch: Batch, memory: jax.Array, key: jax.Array) -> tuple[jax.Array, Any]:
        pixels = relit(batch.obs[PIXELS], key, self.config.light, self.config.pixel_noise)
        own, _, predicted = self.student.apply(params, {**batch.obs, PIXELS: pixels}, memory, batch.begins)  # type: ignore[misc]
        imitation = optax.huber_loss(own, batch.label, delta=0.5).sum(-1).mean()
        auxiliary = jnp.square(predicted - batch.target).mean()
        return imitation + self.config.auxiliary * auxiliary, (imitation, auxiliary)

    def _learn(self, state: DaggerState, batch: Batch, memory: jax.Array, key: jax.Array, rate: jax.Array) -> Any:
        """Epochs over an iteration's sequences; memory: (n, memory) at their begin; rate: () learning rate."""
        n, parts = int(self.config.num_envs), int(self.config.minibatches)

        def epoch(carry: Any, key: jax.Array) -> Any:
            key_order, key_light = jax.random.split(key)
            rows = jax.random.permutation(key_order, n).reshape(parts, -1)

            def update(carry: Any, inputs: Any) -> Any:
                params, optimizer = carry
                chosen, key = inputs
                part = jax.tree.map(lambda x: jnp.take(x, chosen, axis=1), batch)
                grads, said = jax.grad(self._loss, has_aux=True)(params, part, memory[chosen], key)
                change, optimizer = self._optimizer.update(grads, optimizer, params)
                change = jax.tree.map(lambda x: -rate * x, change)
                return (optax.apply_updates(params, change), optimizer), said

            return jax.lax.scan(update, carry, (rows, jax.random.split(key_light, parts)))

        keys = jax.random.split(key, int(self.config.epochs))
        (params, optimizer), said = jax.lax.scan(epoch, (state.params, state.optimizer), keys)
        return params, optimizer, jax.tree.map(jnp.mean, said)

    def _iterate(self, state: DaggerState, progress: jax.Array) -> tuple[DaggerState, dict[str, jax.Array]]:
        """One iteration; returns what happened in it. progress: () in [0, 1], of the whole training."""
        key, key_roll, key_learn = jax.random.split(state.key, 3)
        memory = state.memory
        state, batch, counts = self._rollout(state, key_roll)
        params, optimizer, (imitation, auxiliary) = self._learn(state, batch, memory, key_learn, self._rate(progress))
        state = state._replace(params=params, optimizer=optimizer, key=key, steps=state.steps + 1)
        ended = counts["success"] + counts["hit"] + counts["off_traversable"] + counts["timeout"]
        shares = {k: counts[k] / jnp.maximum(ended, 1.0) for k in ("success", "hit", "off_traversable", "timeout")}
        overflow = counts["slot_overflow"] / self.steps_per_iteration
        return state, {**shares, "ended": ended, "imitation": imitation, "auxiliary": auxiliary, "overflow": overflow}


def run(
    dagger: Dagger,
    iterations: int,
    seconds: float,
    on_iteration: Callable[[int, DaggerState, dict[str, float]], None],
    params: Any = None,
) -> DaggerState:
    """Iterates until `iterations` are done or `seconds` of wall time are over; calls back after each.

    With a limit of seconds that is reached, the learning rate follows the clock, and no two runs are the same.
    """
    begin = time.monotonic()
    state = dagger.begin(params)
    for number in range(1, iterations + 1):
        progress = max((number - 1) / iterations, (time.monotonic() - begin) / seconds)
        if progress >= 1.0:
            break
        state, said = dagger.iterate(state, jnp.float32(progress))
        on_iteration(number, state, {name: float(x) for name, x in said.items()})
    return state
