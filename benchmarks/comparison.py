"""Trains one preset with Brax PPO on the streets of some banks and scores it on AutoBench and CraftBench.

    python -m benchmarks.comparison --train procedural/bank.npz --test craftbench/bank.npz autobench/bank.npz \
        --steps 4000000 --seed 0 --out runs/procedural_0

The same number of steps on other banks, or on one scene of a bank (`--scenes`), gives the rows of the paper's
comparison of training streets. No checkpoint is selected: the final parameters are scored on all episodes of the frozen
protocols, or on evenly spaced ones where a bank has none. An interrupted run continues from its newest checkpoint.
Writes log.jsonl, result.json and the policy to `--out`.
"""

import argparse
import pathlib
import sys
from typing import Any

from benchmarks.lib.options import option, parsed_options
from benchmarks.lib.unseen import Streets, begin, brief, load, named_scenes, save_result
from urbanverse_mjx.envs import registry


def arguments() -> argparse.Namespace:
    cli = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    cli.add_argument("--train", nargs="+", type=pathlib.Path, required=True, help="banks to train on")
    cli.add_argument("--test", nargs="+", type=pathlib.Path, required=True, help="banks to drive")
    cli.add_argument("--scenes", nargs="+", help="ids of the scenes to train on; default: all of the banks to train on")
    cli.add_argument("--out", type=pathlib.Path, required=True)
    cli.add_argument("--environment", default="CocoNav")
    cli.add_argument("--preset", default="paper")
    cli.add_argument("--steps", type=int, required=True, help="env-steps")
    cli.add_argument("--checkpoints", type=int, default=4)
    cli.add_argument("--num-envs", type=int, help="default: the preset's")
    cli.add_argument("--minibatch", type=int, help="steps; default: the preset's")
    cli.add_argument("--episodes", type=int, default=768, help="of a bank to test that has no frozen protocol")
    cli.add_argument(
        "--env", type=option, nargs="*", default=[], help="environment options, such as vision_config.height=54"
    )
    cli.add_argument("--seed", type=int, default=0)
    cli.add_argument("--impl", default="auto")
    return cli.parse_args()


def trained(args: argparse.Namespace, env: Any) -> pathlib.Path:
    """Returns the policy after `--steps` env-steps."""
    from urbanverse_mjx.training import run as training
    from urbanverse_mjx.training.config import default_ppo_config
    from urbanverse_mjx.training.policy import PolicySpec, latest_policy

    config = default_ppo_config(args.preset, args.environment)
    with config.unlocked():
        config.update({"num_timesteps": args.steps, "num_checkpoints": args.checkpoints, "seed": args.seed})
        config.update({k: x for k, x in (("num_envs", args.num_envs), ("minibatch", args.minibatch)) if x is not None})
    folder = args.out / "training"
    resume = (folder / "checkpoints").is_dir() and any((folder / "checkpoints").iterdir())
    if not resume or PolicySpec.load(latest_policy(folder)).steps < args.steps:
        training.train(args.environment, env, config, folder, resume=resume, quiet=True)
    return latest_policy(folder)


def main() -> int:
    args = arguments()
    log = begin(args.out)
    streets: Streets = load(args.train, args.test, [], args.episodes, log)
    chosen = named_scenes(args.scenes, streets.train)
    overrides = {"preset": args.preset, "impl": args.impl, "scenes": ",".join(chosen)}
    overrides |= parsed_options(args.env)
    env = registry.load(args.environment, config_overrides=overrides, bank=streets.bank)
    streets.suite.check(env)
    log(environment=args.preset, scenes=len(chosen))
    folder = trained(args, env)
    log(policy=folder.name)
    from urbanverse_mjx.training.policy import PolicySpec, load_policy

    scores = streets.suite.score(env, args.preset, load_policy(folder)[0])
    log(**{name: brief(x) for name, x in scores.items()})
    result = {"steps": PolicySpec.load(folder).steps, "trained_on": sorted(chosen), args.preset: scores}
    save_result(args.out, result)
    return 0


if __name__ == "__main__":
    sys.exit(main())
