"""One of several processes that train a student together; `tests/training/test_devices.py` starts them."""

import json
import pathlib
import sys

import jax


def main() -> None:
    """Arguments: bank file, run folder, and for several processes also coordinator, their number and this one's."""
    bank, folder, *together = sys.argv[1:]
    if together:
        from urbanverse_mjx.training.run import join_processes

        join_processes(together[0], int(together[1]), int(together[2]))
    from ml_collections import ConfigDict

    from tests.support.train_student_on_devices import SAME, towards_goal
    from tests.training.test_student import LAYERS, seeing_env
    from urbanverse_mjx.datatypes import SceneBank
    from urbanverse_mjx.envs.navigation.ppo import ppo_config
    from urbanverse_mjx.training.imitation import distil

    env = seeing_env(SceneBank.load(bank))
    config = ConfigDict(ppo_config("quick").to_dict())
    config.update({**SAME, "num_checkpoints": 2, "warm_up": 64, "teacher_share": 0.5})
    config.network.update({"layers": LAYERS, "hidden": 16, "memory": 8})
    found = {"process": jax.process_index(), "devices": jax.device_count(), "policies": []}
    for iterations in (2, 4):  # the second continues the first, from a state of all processes
        config.num_timesteps = iterations * 32
        result = distil("CocoNav", env, config, pathlib.Path(folder), towards_goal, iterations > 2, True)
        found["policies"].append(None if result.policy is None else result.policy.name)
    print(json.dumps(found))


if __name__ == "__main__":
    main()
