"""Trains the gaits of robots with legs, exports each as one file and judges it in C MuJoCo.

    python -m benchmarks.gaits train --robot b2 --steps 300000000 --seed 0 --out runs/gait-b2
    python -m benchmarks.gaits ship runs/gait-b2/result.json

`train` trains the robot's joystick environment by PPO (the Go2's settings, a smaller network), exports the newest
policy to OUT/gait.npz with its weights in half precision, runs the trials of `benchmarks.go2_gait` in small numbers and
writes OUT/result.json. `ship` copies a gait into the package, where `robots.gait_of` finds it and the robot's
navigation environment is registered (B2Nav). benchmarks.campaign runs `train` for all robots: `--rows "gait-*"`.
"""

import argparse
import json
import pathlib
import sys
import time
from collections.abc import Sequence
from typing import Any

from benchmarks import go2_gait
from urbanverse_mjx import pipeline
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.pipeline.training_run import TrainOptions
from urbanverse_mjx.robots import legged
from urbanverse_mjx.robots.gait import Gait
from urbanverse_mjx.training.export_gait import export_gait
from urbanverse_mjx.training.record import RunRequest

#: Robots that practise: those with a `walk` in their row.
ROBOTS = tuple(name for name in legged.NAMES if legged.row(name).walk is not None)
RESULT, GAIT = "result.json", "gait.npz"
#: Layers of an exported gait: 0.07 MB for 12 joints.
ACTOR = (128, 64)


def train(args: argparse.Namespace) -> dict[str, Any]:
    """Trains, exports and judges a gait; returns what result.json holds."""
    begin = time.monotonic()
    actor = {"network.actor_hidden": tuple(args.actor)}
    request = RunRequest(
        environment=legged.joystick_name(args.robot),
        preset=args.preset,
        env_overrides=dict(args.env),
        ppo_overrides={**actor, **dict(args.ppo)},
        num_timesteps=args.steps,
        num_envs=args.num_envs,
        seed=args.seed,
    )
    summary = pipeline.train(request, TrainOptions(logdir=args.out, num_episodes=0, video=False), args.quiet)
    seconds = round(time.monotonic() - begin, 1)
    # Rounded before the trials, so that they judge what is shipped.
    gait = export_gait(pathlib.Path(summary["folder"]), {"wall_seconds": seconds}).in_half_precision()
    gait.save(args.out / GAIT)
    words = ["--robot", args.robot, "--gait", str(args.out / GAIT), "--episodes", args.trials, "--trials", args.trials]
    words += ["--seconds", args.seconds, "--processes", args.processes, "--seed", args.seed]
    words += ["--kerbs", *args.kerbs, "--slopes", *args.slopes]
    judged = go2_gait.judge_all(go2_gait.parse([str(word) for word in words]))
    found = {"robot": args.robot, "seed": args.seed, "preset": args.preset, "steps": gait.meta["steps"]}
    return found | {"train_seconds": seconds, "judged": judged}


def ship(path: pathlib.Path) -> pathlib.Path:
    """Copies the gait beside a result.json into the package; returns its new place.

    Raises:
      ValidationError: the file is no result of `train`, or the gait is of another robot.
    """
    found = v.mapping(
        v.read_json(path, "result of benchmarks.gaits"),
        str(path),
        ("robot", "seed", "preset", "steps", "train_seconds", "judged"),
    )
    robot = v.choice(found["robot"], f"{path}: robot", ROBOTS)
    gait = Gait.load(path.parent / GAIT)
    if gait.meta.get("robot") != robot:
        raise v.fail(str(path.parent / GAIT), f"a gait of {gait.meta.get('robot')!r}", f"one of {robot!r}")
    gait.save(legged.gait_path(robot))
    return legged.gait_path(robot)


def _pair(text: str) -> tuple[str, Any]:
    key, found, value = text.partition("=")
    if not found:
        raise argparse.ArgumentTypeError(f"found {text!r}, needed KEY=VALUE")
    try:
        return key, json.loads(value)
    except json.JSONDecodeError:
        return key, value


def arguments(argv: Sequence[str] | None = None) -> argparse.Namespace:
    cli = argparse.ArgumentParser(prog="python -m benchmarks.gaits", description=__doc__)
    cli.formatter_class = argparse.RawDescriptionHelpFormatter
    commands = cli.add_subparsers(dest="command", required=True)
    one = commands.add_parser("train")
    one.add_argument("--robot", choices=ROBOTS, required=True)
    one.add_argument("--out", type=pathlib.Path, required=True)
    one.add_argument("--preset", default="fast")
    one.add_argument("--steps", type=int, help="env-steps; default: the preset's")
    one.add_argument("--num-envs", type=int)
    one.add_argument("--seed", type=int, default=0)
    one.add_argument("--actor", type=int, nargs="+", default=ACTOR, help="sizes of hidden layers")
    one.add_argument("--env", type=_pair, nargs="*", default=[], metavar="KEY=VALUE", help="environment options")
    one.add_argument("--ppo", type=_pair, nargs="*", default=[], metavar="KEY=VALUE", help="options of PPO")
    one.add_argument("--trials", type=int, default=100)
    one.add_argument("--seconds", type=float, default=20.0, help="of an episode on level ground")
    one.add_argument("--kerbs", type=float, nargs="*", default=(0.05, 0.10, 0.15), help="heights, m")
    one.add_argument("--slopes", type=float, nargs="*", default=(0.125, 0.3))
    one.add_argument("--processes", type=int, default=1)
    one.add_argument("--quiet", action="store_true")
    two = commands.add_parser("ship")
    two.add_argument("result", type=pathlib.Path)
    return cli.parse_args(argv)


def main(argv: Sequence[str] | None = None) -> int:
    args = arguments(argv)
    try:
        if args.command == "ship":
            print(ship(args.result))
            return 0
        args.out.mkdir(parents=True, exist_ok=True)
        found = train(args)
    except ValidationError as error:
        print(error, file=sys.stderr)
        return 2
    text = json.dumps(found)
    v.write_atomically(args.out / RESULT, lambda path: path.write_text(text + "\n", encoding="utf-8"))
    print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
