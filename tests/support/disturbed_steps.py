"""Steps of envs in which states and actions are spoilt: `python -m tests.support.disturbed_steps warp dynamic 0 50000`.

Parts of 50,000 steps, each with a seed of its own, so that a million can be run in pieces. `--envs 5000` makes parts
ten times as long: what a step costs beside the physics is then shared by more envs.
"""

import argparse
import dataclasses
import itertools
import time
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from tests.support.box_bank import box_bank
from tests.support.unsound import NO_NUMBERS, spoil, unsound
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.envs import NavEnv, Result, registry

ENVS, ROUNDS = 500, 100
#: Steps of a part.
PART = ENVS * ROUNDS
#: As few people as have all parts of a crowd, so that JAX compiles the step in minutes: walkers, one vehicle, and one
#: object that they may push.
FEW_PEOPLE = {
    **{f"crowd.slots.{kind}": 0 for kind in ("wheelchair", "scooter", "cyclist")},
    "crowd.slots.pedestrian": 3,
    "crowd.slots.car": 1,
    "movable.bodies": 1,
    "movable.awake": 1,
    "movable.hulls": 1,
}


def env_of(bank: SceneBank, impl: str, scenario: str) -> NavEnv:
    """An env whose states and actions `disturb_part` spoils."""
    overrides: dict[str, Any] = {"preset": "cpu", "scenes": "all", "vision": False, "impl": impl, "scenario": scenario}
    if scenario == "dynamic":
        # The fused step compiles with all kinds of agents in minutes, but has no movable objects.
        overrides |= {"movable.bodies": 0} if impl == "warp-fused" else FEW_PEOPLE
    return registry.load("CocoNav", config_overrides=overrides, bank=bank)


def disturb_part(reset: Any, step: Any, part: int, envs: int = ENVS) -> None:
    """Runs `envs * ROUNDS` steps, with a seed of this part.

    Raises:
      AssertionError: a result is no number, or a spoilt state did not end its episode.
    """
    rng = np.random.default_rng(part)
    state = reset(jax.random.split(jax.random.key(part), envs))
    for k in range(part * ROUNDS, (part + 1) * ROUNDS):
        spoilt = np.flatnonzero(rng.random(envs) < 0.3)
        action = rng.uniform(-2.0, 2.0, (envs, 2)).astype(np.float32)
        pushed = np.flatnonzero(rng.random(envs) < 0.1)
        action[pushed, rng.integers(2, size=len(pushed))] = rng.choice(NO_NUMBERS, len(pushed))
        after = step(dataclasses.replace(state, data=spoil(state.data, rng, spoilt, k)), jnp.asarray(action))
        found = unsound(after)
        assert not found, f"part {part}, round {k}: found no numbers in {found}"
        result = np.asarray(after.info["result"])[spoilt]
        assert (result == Result.NON_FINITE).all(), f"part {part}, round {k}: found results {np.unique(result)}"
        # Half of the steps continue from the result of the last corrupted state.
        state = after if k % 2 else state


def programs(env: NavEnv) -> tuple[Any, Any]:
    """Compiled reset and step of a batch of envs."""
    return jax.jit(jax.vmap(env.reset)), jax.jit(jax.vmap(env.step))


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.support.disturbed_steps", description=__doc__)
    parser.add_argument("impl", choices=("jax", "warp", "warp-fused"))
    parser.add_argument("scenario", choices=("static", "dynamic"))
    parser.add_argument("first", type=int, help="part to begin with")
    parser.add_argument("steps", type=int, help="steps, a multiple of a part's")
    parser.add_argument("--envs", type=int, default=ENVS, help="envs of a batch; a part has 100 steps of each")
    options = parser.parse_args()
    env = env_of(box_bank(3), options.impl, options.scenario)
    reset, step = programs(env)
    for part in itertools.count(options.first):
        steps = options.envs * ROUNDS
        if (part - options.first) * steps >= options.steps:
            return
        begin, worked = time.monotonic(), time.process_time()
        disturb_part(reset, step, part, options.envs)
        seconds, worked = time.monotonic() - begin, time.process_time() - worked
        took = f"{seconds:.0f} s, {worked:.0f} s of processor time"
        print(f"{options.impl} {options.scenario} part {part}: {steps} steps, {took}", flush=True)


if __name__ == "__main__":
    main()
