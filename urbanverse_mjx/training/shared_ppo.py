"""PPO of one privileged policy that drives several robots.

States of the simulation differ between robots in shape, so each robot has an environment and a compiled rollout of its
own. An iteration rolls out all of them one after another with the same parameters, and updates these from all rollouts
together: no robot's update is undone by the next one's. Advantages are normalised for each robot, so that one whose
rewards vary less counts as much. With one environment this is PPO (Schulman et al., "Proximal Policy Optimization
Algorithms", 2017).
"""

import concurrent.futures
import functools
import pathlib
from collections.abc import Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import optax
from jax.core import Tracer
from ml_collections import ConfigDict

from .. import table_arguments
from ..datatypes import ValidationError
from ..datatypes import validation as v
from ..envs import wrap_for_training
from ..envs.navigation.ppo import ppo_config
from ..simulation.engines import load_kernels
from .devices import ALONE
from .finetune import advantages, clipped_gain
from .imitation import fit
from .map_networks import MAP, ROBOT, VECTOR
from .policy import PolicySpec, network_factory, save_actor_and_critic
from .run import TrainingResult
from .sequences import epochs
from .student_learner import ENDS

#: Learning rates that the adaptation by divergence does not leave, and its factor (Brax's `adaptive_kl_learning_rate`).
_LEAST_RATE, _FACTOR = 1e-5, 1.5


def shared_ppo_config(robots: Sequence[str], told: bool) -> ConfigDict:
    """Returns a new configuration: that of the teacher of the preset `best`, with other sizes.

    Fields besides those of `envs.navigation.ppo`:
      num_envs: of each robot. num_timesteps: of all robots together.
      robots: their names, for the record.
      network.told: whether the policy is told size and dynamics of the robot (the observation `robot`).
    """
    config = ConfigDict(ppo_config("best").teacher.to_dict())
    config.update({"num_envs": 1024, "unroll_length": 16, "seed": 0, "num_checkpoints": 2, "robots": tuple(robots)})
    config.num_timesteps = len(robots) * 1_400_000
    config.network.told = told
    return config


class SharedState(NamedTuple):
    """The training state between iterations.

    Attributes:
      params: {"actor", "critic"}. optimizer: of these.
      rate: () f32 learning rate.
      envs: `State` of all envs of each robot.
      key: typed.
      steps: () i32 iterations done.
    """

    params: Any
    optimizer: Any
    rate: jax.Array
    envs: tuple[Any, ...]
    key: jax.Array
    steps: jax.Array


class Batch(NamedTuple):
    """The rollout of a robot; all (T, n, ...).

    Attributes:
      obs: observations that the networks see.
      action: before the squashing by tanh. log_prob: of it, when it was drawn.
      advantage: f32, normalised. returns: f32, in scaled rewards.
    """

    obs: Any
    action: jax.Array
    log_prob: jax.Array
    advantage: jax.Array
    returns: jax.Array


class SharedPPO:
    """The algorithm; `train_shared` makes it a run folder.

    Args:
      envs: batched, auto-resetting environments (`wrap_for_training`), one for each robot.
      config: see `shared_ppo_config`.

    Raises:
      ValidationError: there is no environment, observations or actions of one have other shapes than those of the
        first, or the envs do not divide into the minibatches.
    """

    def __init__(self, envs: Sequence[Any], config: ConfigDict) -> None:
        v.items(list(envs), "envs", 1)
        ALONE.check_shares(int(config.num_envs), {"ppo.minibatches": int(config.minibatches)})
        self.envs, self.config = tuple(envs), config
        self.names = (
            VECTOR,
            *((MAP,) if config.network.map_layers else ()),
            *((ROBOT,) if config.network.told else ()),
        )
        self._resets: list[Any] = [table_arguments.jit(env.reset) for env in self.envs]
        #: Those that are compiled ahead.
        self._ready: list[Any] = [None for _ in self.envs]
        shapes = [self._shapes(k) for k in range(len(self.envs))]
        for k, found in enumerate(shapes):
            if found != shapes[0]:
                raise ValidationError(
                    f"envs[{k}]: found {found}, needed the observations and actions of the first, {shapes[0]}; take "
                    "environments of one task with the same options."
                )
        networks = network_factory(config)(dict(shapes[0][0]), envs[0].action_size)
        self._actor, self._critic = networks.policy_network, networks.value_network
        self._distribution = networks.parametric_action_distribution
        adam = optax.chain(optax.clip_by_global_norm(config.max_grad_norm), optax.scale_by_adam())
        self._optimizer = optax.multi_transform({"actor": adam, "critic": adam}, {"actor": "actor", "critic": "critic"})
        self.steps_per_iteration = len(envs) * int(config.num_envs) * int(config.unroll_length)
        self._rollouts: list[Any] = [
            table_arguments.jit(functools.partial(self._rollout, env), donate_argnums=1) for env in self.envs
        ]
        self._learn: Any = jax.jit(self._update, donate_argnums=0)

    def _shapes(self, k: int) -> tuple[tuple[tuple[str, tuple[int, ...]], ...], int]:
        # JAX keeps this trace for the compilation.
        obs = jax.eval_shape(self._resets[k], self._keys(jax.random.key(0))).obs
        sizes = {name: x.shape[1:] for name, x in obs.items()}
        missing = [name for name in self.names if name not in sizes]
        if missing:
            raise ValidationError(
                f"ppo.network: found no observation {missing[0]!r}, which the network sees, needed it; set "
                f"observations.{missing[0]}=true."
            )
        return tuple((name, tuple(sizes[name])) for name in self.names), self.envs[k].action_size

    def compile(self, threads: int) -> None:
        """Compiles what each robot needs, several robots at the same time: XLA compiles a program on one core."""
        load_kernels([env.unwrapped.engine for env in self.envs], threads)
        key = jax.random.key(0)
        keys, params = self._keys(key), jax.eval_shape(self._parameters, key)
        with concurrent.futures.ThreadPoolExecutor(threads) as pool:
            # Traced by one thread, because Warp numbers the calls into it without a lock.
            resets, rollouts = [], []
            for reset, rollout in zip(self._resets, self._rollouts, strict=True):
                lowered = rollout.lower(params, jax.eval_shape(reset, keys), key)
                rollouts.append(pool.submit(lowered.compile))
                resets.append(pool.submit(reset.lower(keys).compile))
            self._ready = [job.result() for job in resets]
            self._rollouts = [job.result() for job in rollouts]

    def begin(self) -> SharedState:
        """The state before the first iteration."""
        key, key_net, *keys = jax.random.split(jax.random.key(int(self.config.seed)), 2 + len(self.envs))
        envs = tuple(self._reset(k, self._keys(one)) for k, one in enumerate(keys))
        params = self._parameters(key_net)
        rate = jnp.float32(self.config.learning_rate)
        return SharedState(params, self._optimizer.init(params), rate, envs, key, jnp.zeros((), jnp.int32))

    def iterate(self, state: SharedState, progress: jax.Array) -> tuple[SharedState, dict[str, jax.Array]]:
        """Runs one iteration; donates the buffers of `state`. Returns the new state and metrics: of all robots, and the
        success rate of each."""
        del progress
        key, key_learn, *keys = jax.random.split(state.key, 2 + len(self.envs))
        envs, batches, counts = [], [], []
        for rollout, env, one in zip(self._rollouts, state.envs, keys, strict=True):
            new, batch, count = rollout(state.params, env, one)
            envs.append(new)
            batches.append(batch)
            counts.append(count)
        start = state.params, state.optimizer
        (params, optimizer), rate, reported = self._learn(start, tuple(batches), state.rate, key_learn)
        return SharedState(params, optimizer, rate, tuple(envs), key, state.steps + 1), reported | self._metrics(counts)

    def actor(self, state: SharedState) -> Any:
        """{"actor", "critic"} of a state."""
        return state.params

    def placed(self, state: SharedState) -> SharedState:
        """A state of a file."""
        return state

    def write(self, folder: pathlib.Path, params: Any, spec: PolicySpec) -> pathlib.Path:
        """Writes `actor` of a state as a policy folder under `folder`; returns it."""
        return save_actor_and_critic(folder, params, spec)

    def _reset(self, k: int, keys: jax.Array) -> Any:
        # A compiled program takes no tracers, by which the shapes of a state are found.
        ready = self._ready[k]
        return (self._resets[k] if ready is None or isinstance(keys, Tracer) else ready)(keys)

    def _keys(self, key: jax.Array) -> jax.Array:
        return jax.random.split(key, int(self.config.num_envs))

    def _parameters(self, key: jax.Array) -> Any:
        first, second = jax.random.split(key)
        return {"actor": self._actor.init(first), "critic": self._critic.init(second)}

    def _metrics(self, counts: Sequence[dict[str, jax.Array]]) -> dict[str, jax.Array]:
        total = jax.tree.map(lambda *values: jnp.stack(values).sum(), *counts)
        ended = jnp.maximum(total["ended"], 1.0)
        shares = {name: total[name] / ended for name in ENDS}
        rewards = {"reward": total["reward"] / self.steps_per_iteration, "ended": total["ended"]}
        each = {
            f"robots/{name}": count["success"] / jnp.maximum(count["ended"], 1.0)
            for name, count in zip(self.config.robots, counts, strict=True)
        }
        return shares | rewards | each

    def _rollout(self, env: Any, params: Any, state: Any, key: jax.Array) -> tuple[Any, Batch, dict[str, jax.Array]]:
        config = self.config

        def step(state: Any, key: jax.Array) -> Any:
            obs = {name: state.obs[name] for name in self.names}
            logits = self._actor.apply(None, params["actor"], obs)
            action = self._distribution.sample_no_postprocessing(logits, key)
            log_prob = self._distribution.log_prob(logits, action)
            value = self._critic.apply(None, params["critic"], obs)
            new = env.step(state, self._distribution.postprocess(action))
            counts = {name: new.metrics[name].sum() for name in ENDS}
            counts |= {"ended": new.done.sum(), "reward": new.reward.sum()}
            return new, (obs, action, log_prob, value, config.reward_scaling * new.reward, new.done, counts)

        state, steps = jax.lax.scan(step, state, jax.random.split(key, int(config.unroll_length)))
        obs, action, log_prob, value, reward, done, counts = steps
        last = self._critic.apply(None, params["critic"], {name: state.obs[name] for name in self.names})
        gained = advantages(reward, done, value, last, config.discounting, config.gae_lambda)
        normal = (gained - gained.mean()) / (gained.std() + 1e-6)
        batch = Batch(obs, action, log_prob, normal, gained + value)
        return state, batch, jax.tree.map(lambda x: x.sum(), counts)

    def _loss(self, params: Any, batch: Batch, memory: jax.Array, key: jax.Array) -> tuple[jax.Array, Any]:
        del memory
        logits = self._actor.apply(None, params["actor"], batch.obs)
        moved = self._distribution.log_prob(logits, batch.action) - batch.log_prob
        ratio = jnp.exp(jnp.clip(moved, -20.0, 20.0))
        actor = -clipped_gain(ratio, batch.advantage, self.config.clipping_epsilon).mean()
        critic = jnp.square(self._critic.apply(None, params["critic"], batch.obs) - batch.returns).mean()
        entropy = self._distribution.entropy(logits, key).mean()
        # Schulman's estimate of the divergence from the policy that acted, which is never negative.
        divergence = (ratio - 1.0 - moved).mean()
        loss = actor + critic - self.config.entropy_cost * entropy
        return loss, {"critic": critic, "entropy": entropy, "kl": divergence}

    def _update(
        self, start: tuple[Any, Any], batches: tuple[Batch, ...], rate: jax.Array, key: jax.Array
    ) -> tuple[tuple[Any, Any], jax.Array, dict[str, jax.Array]]:
        config = self.config
        batch: Batch = jax.tree.map(lambda *parts: jnp.concatenate(parts, axis=1), *batches)
        memory = jnp.zeros((batch.advantage.shape[1], 0))
        end, reported = epochs(
            self._loss, self._optimizer, start, batch, memory, key, {"actor": rate, "critic": rate},
            int(config.num_updates_per_batch), int(config.minibatches),
        )  # fmt: skip
        far, near = reported["kl"] > 2.0 * config.desired_kl, reported["kl"] < 0.5 * config.desired_kl
        rate = jnp.where(far, rate / _FACTOR, jnp.where(near, rate * _FACTOR, rate))
        return end, jnp.clip(rate, _LEAST_RATE, config.max_learning_rate), reported | {"rate": rate}


def train_shared(
    environment: str,
    envs: Sequence[Any],
    config: ConfigDict,
    folder: pathlib.Path,
    resume: bool = False,
    quiet: bool = False,
    threads: int = 1,
) -> TrainingResult:
    """Trains one policy in several environments and returns the folder of its policy.

    Args:
      environment: the name the first env is registered under.
      envs: environments without wrappers, with the observations that the network sees.
      config: see `shared_ppo_config`.
      folder, resume, quiet: see `imitation.distil`.
      threads: number of robots whose programs are compiled at the same time.

    Raises:
      ValidationError: see `SharedPPO` and `imitation.distil`.
    """
    learner = SharedPPO([wrap_for_training(env, env.config.episode_length) for env in envs], config)
    if threads > 1:
        learner.compile(threads)
    return fit(environment, envs[0], config, folder, learner, resume, quiet)
