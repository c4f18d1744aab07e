"""Runs a million random resets on one device and checks for NaN, growing memory, and recompilation after the first
steps.

    python -m benchmarks.endurance --bank bank160.npz --num-envs 4096 --pixels 36x64 --resets 1000000 --json

Envs take random actions in short episodes, so that every few steps each is reset to a random scene. Prints a log line
per tenth of the run on stderr, and one JSON line; exits with 1 if a check fails. Use fewer resets on a CPU, where it is
slow.
"""

import argparse
import json
import pathlib
import sys
import time
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from benchmarks.lib.cases import Case
from benchmarks.lib.memory import in_use_mib
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs import registry, wrap_for_training

#: MiB, tolerated growth of memory in use after the first steps, because allocators round.
SLACK = 16.0


class Compilations:
    """Counts JAX compilations from its creation on."""

    def __init__(self) -> None:
        self.count = 0
        jax.monitoring.register_event_duration_secs_listener(self._listen)

    def _listen(self, event: str, duration_secs: float, **kwargs: str | int) -> None:
        del duration_secs, kwargs
        self.count += event == "/jax/core/compile/backend_compile_duration"


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Runs the benchmark; counts in the result are totals of the run."""
    case = Case(
        preset=arguments.preset,
        impl=arguments.impl,
        pixels=arguments.pixels,
        overrides={"scenes": "all", "episode_length": arguments.episode_length},
    )
    overrides = case.config_overrides(registry.get_default_config("CocoNav", arguments.preset).ctrl_dt)
    bank = None if arguments.bank is None else SceneBank.load(arguments.bank)
    task = registry.load("CocoNav", config_overrides=overrides, bank=bank)
    env, num_scenes = wrap_for_training(task, arguments.episode_length), task.bank.num_scenes
    n = arguments.num_envs

    def step(carry: Any, _: None) -> tuple[Any, None]:
        state, key, resets, bad, seen = carry
        key, draw = jax.random.split(key)
        state = env.step(state, jax.random.uniform(draw, (n, env.action_size), minval=-1.0, maxval=1.0))
        leaves = jax.tree.leaves((state.data.sim, state.obs, state.reward))
        numbers = [x for x in leaves if jnp.issubdtype(x.dtype, jnp.floating)]
        wrong = sum(((~jnp.isfinite(x)).sum() for x in numbers), jnp.int32(0))
        wrong += state.metrics["non_finite"].sum().astype(jnp.int32)
        seen = seen.at[state.data.sim.scene].add(1)
        return (state, key, resets + state.done.sum().astype(jnp.int32), bad + wrong, seen), None

    @jax.jit
    def steps(carry: Any) -> Any:
        return jax.lax.scan(step, carry, None, length=arguments.steps_per_call)[0]

    state = jax.jit(env.reset)(jax.random.split(jax.random.key(arguments.seed), n))
    zero = jnp.int32(0)
    carry = (state, jax.random.key(arguments.seed + 1), zero, zero, jnp.zeros(num_scenes, jnp.int32))
    carry = jax.block_until_ready(steps(steps(carry)))
    compilations, begin, calls, tenth = Compilations(), time.monotonic(), 0, 0
    memory, log = [in_use_mib()], []
    while int(carry[2]) < arguments.resets:
        carry = jax.block_until_ready(steps(carry))
        calls += 1
        done = int(carry[2])
        if done * 10 // arguments.resets > tenth:
            tenth = done * 10 // arguments.resets
            memory.append(in_use_mib())
            log.append([done, int(carry[3]), compilations.count, round(memory[-1], 1)])
            print(
                f"{done:>10,} resets  {log[-1][1]} not finite  {compilations.count} compilations  "
                f"{memory[-1]:,.1f} MiB",
                file=sys.stderr,
                flush=True,
            )
    seconds = time.monotonic() - begin
    return {
        "device": jax.devices()[0].device_kind,
        "num_envs": n,
        "pixels": arguments.pixels,
        "resets": int(carry[2]),
        "env_steps": calls * arguments.steps_per_call * n,
        "env_steps_per_s": round(calls * arguments.steps_per_call * n / seconds, 1),
        "non_finite": int(carry[3]),
        "compilations": compilations.count,
        "memory_growth_mib": round(max(memory) - memory[0], 1),
        "scenes_begun_in": int((np.asarray(carry[4]) > 0).sum()),
        "num_scenes": num_scenes,
        "log": log,
    }


def parse(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.endurance", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--bank", type=pathlib.Path, help="a bank file (default: the shipped streets)")
    parser.add_argument("--preset", default="paper")
    parser.add_argument("--impl", default="auto")
    parser.add_argument("--num-envs", type=int, default=4096)
    parser.add_argument("--pixels", default="36x64", metavar="HxW", help="of the frame, or none")
    parser.add_argument("--resets", type=int, default=1_000_000)
    parser.add_argument("--episode-length", type=int, default=4, help="control steps")
    parser.add_argument("--steps-per-call", type=int, default=16)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", action="store_true", help="print one JSON line")
    return parser.parse_args(argv)


def main(argv: list[str] | None = None) -> int:
    arguments = parse(argv)
    try:
        result = run(arguments)
    except ValidationError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    for name, value in result.items():
        if not arguments.json:
            print(f"{name}: {value}")
    if arguments.json:
        print(json.dumps(result))
    wrong = result["non_finite"] or result["compilations"] or result["memory_growth_mib"] > SLACK
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
