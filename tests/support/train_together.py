"""One of several processes that train together; `tests/training/test_distributed.py` starts them."""

import json
import pathlib
import sys

import jax
import jax.numpy as jnp

from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.envs.registry import with_overrides
from urbanverse_mjx.training.config import default_ppo_config
from urbanverse_mjx.training.run import join_processes, train


def main() -> None:
    """Arguments: bank file, run folder, and for several processes also coordinator, their number and this one's."""
    bank, folder, *together = sys.argv[1:]
    if together:
        join_processes(together[0], int(together[1]), int(together[2]))
    from tests.support.unicycle import unicycle_env  # asks JAX for its devices as it is imported

    env = unicycle_env(SceneBank.load(bank), {"terminate_off_traversable": False, "episode_length": 20})
    small = {"num_envs": 32, "minibatch": 128, "unroll_length": 8, "num_timesteps": 1024, "num_checkpoints": 2}
    result = train("CocoNav", env, with_overrides(default_ppo_config("cpu"), small), pathlib.Path(folder), quiet=True)
    ones = jax.pmap(lambda x: jax.lax.psum(x, "i"), axis_name="i")(jnp.ones(jax.local_device_count()))
    print(
        json.dumps(
            {
                "process": jax.process_index(),
                "devices": jax.device_count(),
                "sum_over_devices": float(ones[0]),
                "steps": result.steps,
                "wrote_policy": result.policy is not None,
            }
        )
    )


if __name__ == "__main__":
    main()
