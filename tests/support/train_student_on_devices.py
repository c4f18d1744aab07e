"""Trains a student on one and on two devices of this process; `tests/training/test_devices.py` starts it with two."""

import json
import pathlib
import sys
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from tests.training.test_student import LAYERS, seeing_env
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.envs import registry, wrap_for_training
from urbanverse_mjx.training import dagger, finetune, snapshot
from urbanverse_mjx.training.devices import Devices
from urbanverse_mjx.training.student_learner import StudentLearner

#: One minibatch of all sequences, and no augmentation: what is left to chance is drawn for all envs at once.
SAME = {"num_envs": 8, "unroll_length": 4, "epochs": 2, "minibatches": 1, "light": 0.0, "pixel_noise": 0.0}


def warp_env(bank: SceneBank) -> Any:
    """COCO in the engine and the renderer of GPUs, whose custom calls run on each device by itself."""
    small = {"vision_config.height": 16, "vision_config.width": 24, "vision_config.light": "direct"}
    overrides = {"preset": "tune", "impl": "warp", "randomization.appearance": 0.0, "episode_length": 40, **small}
    return registry.load("CocoNav", config_overrides=overrides, bank=bank)


def towards_goal(params: None, state: Any, key: jax.Array) -> jax.Array:
    """A teacher."""
    del params, key
    goal = state.obs["goal"]
    return goal / jnp.maximum(jnp.linalg.norm(goal, axis=-1, keepdims=True), 1e-6)


def learner(env: Any, stage: str, devices: Devices, **options: Any) -> StudentLearner:
    """A student that drives towards the goal, from random weights."""
    imitation = dagger.default_dagger_config()
    imitation.network.update({"layers": LAYERS, "hidden": 16, "memory": 8, "bfloat16": False})
    imitation.update({**SAME, "warm_up": 64, "teacher_share": 0.5, **options})
    wrapped = wrap_for_training(env, env.config.episode_length)

    if stage == "imitation":
        return dagger.Dagger(wrapped, towards_goal, imitation, devices=devices)
    config = finetune.default_finetune_config()
    config.update({**SAME, "critic_only": 0, "map_layers": (), "critic_hidden": (8, 8), "reward_scaling": 1.0})
    config.update({"learning_rate": 1e-3, **options})
    return finetune.Finetune(wrapped, towards_goal, imitation, config, devices=devices)


def trained(made: StudentLearner, iterations: int, start: Any = None) -> tuple[Any, dict[str, float]]:
    """State after some iterations, and the metrics of the last one."""
    state, reported = made.begin() if start is None else start, {}
    for k in range(iterations):
        state, reported = made.iterate(state, jnp.float32(k / iterations))
    return state, {name: float(x) for name, x in reported.items()}


def numbers(tree: Any) -> np.ndarray:
    return np.concatenate([np.asarray(x, np.float64).ravel() for x in jax.tree.leaves(tree)])


def main() -> None:
    """Arguments: bank file, stage, engine (unicycle or warp), and a folder for a state."""
    bank, stage, engine, folder = SceneBank.load(sys.argv[1]), sys.argv[2], sys.argv[3], pathlib.Path(sys.argv[4])
    env = seeing_env(bank) if engine == "unicycle" else warp_env(bank)
    one, two = Devices(tuple(jax.devices()[:1])), Devices.every()
    single, both = learner(env, stage, one), learner(env, stage, two)
    before = numbers(single.begin().params)
    (alone, told), (spread, told_by_both) = trained(single, 3), trained(both, 3)
    # Resumed on both devices from a file.
    halfway, _ = trained(both, 1)
    path = snapshot.save_state(folder / "state.npz", halfway)
    again = both.placed(snapshot.load_state(path, jax.eval_shape(both.begin)))
    for k in (1, 2):
        again, _ = both.iterate(again, jnp.float32(k / 3))
    shuffled = learner(env, stage, two, minibatches=2, light=0.2, pixel_noise=0.01)
    copies = [np.asarray(x.data) for x in jax.tree.leaves(trained(shuffled, 2)[0].params)[0].addressable_shards]
    actor = both.actor(spread)
    print(
        json.dumps(
            {
                "devices": two.count,
                "moved": float(np.abs(numbers(alone.params) - before).max()),
                "apart": float(np.abs(numbers(alone.params) - numbers(spread.params)).max()),
                "metrics_apart": max(abs(told[name] - told_by_both[name]) for name in told),
                "envs_by_device": [s.data.shape[0] for s in spread.begins.addressable_shards],
                "resumed_apart": float(np.abs(numbers(again.params) - numbers(spread.params)).max()),
                "copies_apart": float(np.abs(copies[0] - copies[1]).max()),
                "actor_devices": len(jax.tree.leaves(actor)[0].sharding.device_set),
            }
        )
    )


if __name__ == "__main__":
    main()
