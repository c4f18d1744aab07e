"""Measures what the exchange of scenes costs a training, and a place on the device.

    python -m benchmarks.places --folder streets.bank --places 8 --exchange-steps 16384 --steps 262144
    python -m benchmarks.places --folder streets.bank --places 64 --num-envs 1024 --steps 20000000   # on a GPU

Trains the preset `quick` (imitation of a scripted controller) on scenes of a folder that come and go, without a final
evaluation, and prints a JSON line: env-steps/s after the first iterations, exchanges, the share of the time in which
the training waited for them (and for what, s), seconds that the preparation of a scene took, events of compilation
after the second iteration, MiB of a place on the device by their kinds, and peak resident memory of the training and of
the process that prepares scenes (which includes mapped files that the system may reclaim).

`python -m benchmarks.shards --places 8` makes folders for it.
"""

import argparse
import json
import pathlib
import resource
import sys
import time
from typing import Any

import jax
from jax import monitoring
from ml_collections import ConfigDict

from benchmarks.lib.caching import keep_compiled
from benchmarks.lib.memory import peak_device_mib, peak_rss_mib, rss_mib
from urbanverse_mjx.datatypes import BankShards, PlacedBank
from urbanverse_mjx.envs import registry, wrap_for_training
from urbanverse_mjx.envs.navigation.places import ScenePlaces, spread_steps
from urbanverse_mjx.envs.navigation.scenarios import select_scenes
from urbanverse_mjx.evaluation.route_follower import RouteFollower
from urbanverse_mjx.training import sequences
from urbanverse_mjx.training.dagger import Dagger
from urbanverse_mjx.work_folder import work_folder

#: Iterations that do not count: programs compile, the first scenes are prepared.
_WARM_UP = 2


def main(argv: list[str] | None = None) -> int:
    cli = argparse.ArgumentParser(prog="python -m benchmarks.places", description=__doc__)
    cli.formatter_class = argparse.RawDescriptionHelpFormatter
    cli.add_argument("--folder", type=pathlib.Path, required=True)
    cli.add_argument("--scenes", default="all", help="as of config.scenes")
    cli.add_argument("--places", type=int, default=8)
    cli.add_argument("--exchange-steps", type=int, default=0, help="default: every scene comes once")
    cli.add_argument("--steps", type=int, default=131_072)
    cli.add_argument("--num-envs", type=int, default=64)
    cli.add_argument("--height", type=int, default=36)
    cli.add_argument("--width", type=int, default=64)
    cli.add_argument("--work", type=pathlib.Path, help="for files of prepared scenes")
    args = cli.parse_args(argv)
    keep_compiled()
    print(json.dumps(measure(args)), flush=True)
    return 0


def measure(args: argparse.Namespace) -> dict[str, Any]:
    """A training; what it cost."""
    begin = time.monotonic()
    shards = BankShards(args.folder)
    bank = PlacedBank.open(shards, select_scenes(shards, args.scenes), args.places, seed=0)
    overrides = {"vision_config.height": args.height, "vision_config.width": args.width, "scenes": "all"}
    env = registry.load("CocoNav", config_overrides={"preset": "quick", **overrides}, bank=bank)
    config = ConfigDict(registry.get_ppo_config("CocoNav", "quick").to_dict())
    config.num_envs = args.num_envs
    each = int(config.num_envs) * int(config.unroll_length)
    steps = args.exchange_steps or spread_steps(bank, args.steps, each)
    compiled: list[str] = []

    def note(event: str, duration_secs: float, **kwargs: str | int) -> None:
        del duration_secs, kwargs
        if "/compile/" in event:
            compiled.append(event)

    with work_folder("urbanverse-places-", args.work) as work, ScenePlaces(env, steps, work) as places:
        follower = RouteFollower(env)
        learner = learner_of(env, follower, config)
        places.begin(0, each)
        first = {"seconds": round(time.monotonic() - begin, 1), "rss_mib": round(rss_mib())}
        state = learner.begin()
        clock: list[float] = []

        def before(number: int, state: Any) -> Any:
            if number == _WARM_UP + 1:
                monitoring.register_event_duration_secs_listener(note)
                clock.append(time.monotonic())
                places.restart_clock()
            return places.before((number - 1) * each, state, learner.reset_gone)

        iterations = max(args.steps // each, _WARM_UP + 1)
        sequences.run(learner, iterations, float("inf"), lambda *_: None, state, before)
        seconds = time.monotonic() - clock[0]
        monitoring.unregister_event_duration_listener(note)
        spent = {name: round(x, 3) for name, x in places.spent.items()}
        held = {name: round(x / args.places / 2**20, 2) for name, x in places.num_bytes().items()}
        row = {
            "scenes": len(bank.rows),
            "places": args.places,
            "num_envs": args.num_envs,
            "exchange_steps": steps,
            "filled": first,
            "seconds": round(seconds, 1),
            "env_steps_per_second": round((iterations - _WARM_UP) * each / seconds, 1),
            "exchanges": places.exchanges,
            "stalled": round(places.reported()["places/stalled"], 5),
            "spent": spent,
            "prepare_seconds": round(sum(places.prepared) / max(len(places.prepared), 1), 2),
            "compiled": len(compiled),
            "place_mib": {**held, "all": round(sum(held.values()), 2)},
            "peak_rss_mib": round(peak_rss_mib()),
        }
        device = peak_device_mib()
    # Of the processes that have ended: the one that prepares scenes.
    other = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 2**10
    return row | {"preparer_peak_rss_mib": round(other)} | ({"peak_device_mib": round(device)} if device else {})


def learner_of(env: Any, follower: RouteFollower, config: ConfigDict) -> Dagger:
    """The learner of the preset `quick`."""
    wrapped = wrap_for_training(env, env.config.episode_length)
    return Dagger(wrapped, lambda _, state, key: jax.vmap(follower.act)(state.data), config)


if __name__ == "__main__":
    sys.exit(main())
