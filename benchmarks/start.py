"""Measures time and memory of each stage up to the first step of an environment with a camera.

    python -m benchmarks.start --banks validation/bank.npz craftbench/bank.npz
    python -m benchmarks.start --banks streets.bank --scenes 16    # the first 16 scenes of a folder of any number

Prints a JSON line per stage: seconds, processor seconds, current and peak resident memory (MiB), on a GPU its peak.
This includes memory that is shared or can be reclaimed, such as mapped files. Compiled JAX programs come from its
cache, as in all commands (`settings.use_compilation_cache`).
"""

import argparse
import json
import pathlib
import sys
import time

import jax
import jax.numpy as jnp

from benchmarks.lib.banks import joined
from benchmarks.lib.caching import keep_compiled
from benchmarks.lib.memory import peak_device_mib, peak_rss_mib, rss_mib
from urbanverse_mjx.datatypes import BankShards, SceneBank
from urbanverse_mjx.envs import registry


class Stages:
    """Prints time and memory of each stage."""

    def __init__(self) -> None:
        self._clocks = time.monotonic(), time.process_time()

    def __call__(self, name: str) -> None:
        jax.effects_barrier()
        clocks = time.monotonic(), time.process_time()
        wall, processor = (round(now - before, 1) for now, before in zip(clocks, self._clocks, strict=True))
        now, most = round(rss_mib()), round(peak_rss_mib())
        row = {"stage": name, "seconds": wall, "processor": processor, "rss_mib": now, "peak_rss_mib": most}
        device = peak_device_mib()
        print(json.dumps(row | ({"peak_device_mib": round(device)} if device else {})), flush=True)
        self._clocks = clocks


def _load(path: pathlib.Path, scenes: int | None) -> SceneBank:
    if scenes is None:
        return SceneBank.load(path)
    shards = BankShards(path)
    return SceneBank.take(shards, range(min(scenes, shards.num_scenes)))


def main(argv: list[str] | None = None) -> int:
    cli = argparse.ArgumentParser(prog="python -m benchmarks.start", description=__doc__)
    cli.add_argument("--banks", nargs="+", type=pathlib.Path, required=True, help="joined where there are several")
    cli.add_argument("--scenes", type=int, help="of a folder, only so many scenes")
    cli.add_argument("--num-envs", type=int, default=64)
    cli.add_argument("--impl", default="warp")
    cli.add_argument("--scenario", default="static")
    args = cli.parse_args(argv)
    keep_compiled()
    stage = Stages()
    jax.block_until_ready(jnp.zeros(1))
    stage("empty process")
    parts = [_load(path, args.scenes) for path in args.banks]
    stage("load")
    bank = joined(parts)
    del parts
    stage("join")
    overrides = {
        "preset": "fast",
        "impl": args.impl,
        "scenario": args.scenario,
        "scenes": "all",
        "vision": True,
        "vision_config.height": 54,
        "vision_config.width": 96,
        "observations.privileged_map": True,
        "observations.proprio": True,
    }
    env = registry.load("CocoNav", config_overrides=overrides, bank=bank)
    stage("environment")
    state = jax.block_until_ready(jax.jit(jax.vmap(env.reset))(jax.random.split(jax.random.key(0), args.num_envs)))
    stage("reset")
    jax.block_until_ready(jax.jit(jax.vmap(env.step))(state, jnp.zeros((args.num_envs, env.action_size))))
    stage("step")
    return 0


if __name__ == "__main__":
    sys.exit(main())
