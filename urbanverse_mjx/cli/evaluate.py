"""`urbanverse evaluate`: a trained or scripted policy over fixed episodes; the result as one JSON line."""

import dataclasses
import json
import pathlib
import sys
from collections.abc import Sequence
from typing import Annotated

import tyro

from ..datatypes import ValidationError
from ..datatypes import validation as v
from ._options import EnvOverrides


@dataclasses.dataclass(frozen=True)
class EvaluateArgs:
    """Evaluate a policy on fixed episodes: one JSON line, and report.md, report.json and episodes.csv in a folder."""

    policy: Annotated[str, tyro.conf.Positional]
    """A policy folder, a run folder (its most trained policy is taken), or zero, random, go_to_goal or planner."""
    scenes: str = "test"
    """test, train, all, or scene ids separated by commas."""
    dynamic: bool = False
    """Streets with people and vehicles that move, and how near the robot came to them; else as it was trained."""
    env_name: str | None = None
    """Whose robot the policy drives, e.g. Go2Nav; default: the one it was trained with, for a scripted one CocoNav."""
    preset: str = "paper"
    """Of the environment, for a scripted policy."""
    bank: pathlib.Path | None = None
    """Scene bank; default: that of the preset it was trained with (`quick`: eight unseen streets, others: the shipped
    two), or the one that URBANVERSE_BANK names."""
    env_overrides: EnvOverrides = dataclasses.field(default_factory=dict)
    """JSON of flat dotted env config keys, e.g. '{"robot": "/robots/tug", "sim_dt": 0.005}'."""
    num_episodes: int = 100
    seed: int = 0
    out: pathlib.Path | None = None
    """Where the report goes; default: beside the policy, for a scripted one runs/evaluate-NAME."""
    video: bool = True
    """Write an mp4 of three episodes drawn at random with --seed, each with how it ended."""
    quiet: bool = False


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse evaluate`."""
    args = tyro.cli(EvaluateArgs, args=list(argv), prog="urbanverse evaluate")
    from ..pipeline.evaluation import SCRIPTED, evaluate_policy
    from ..pipeline.training_run import bank_of
    from ..training.policy import PolicySpec, latest_policy

    v.integer(args.num_episodes, "--num-episodes", 1)
    if args.policy in SCRIPTED:
        policy, out = args.policy, pathlib.Path("runs") / f"evaluate-{args.policy}"
        environment, preset = args.env_name or "CocoNav", args.preset
    elif pathlib.Path(args.policy).is_dir():
        policy = latest_policy(pathlib.Path(args.policy))
        out = policy / "evaluation"
        spec = PolicySpec.load(policy)
        environment, preset = args.env_name or spec.environment, spec.env_config.get("preset")
    else:
        raise ValidationError(
            f"policy: found {args.policy!r}, needed a policy or run folder, or one of {', '.join(SCRIPTED)}."
        )
    out = args.out or out
    bank = bank_of(environment, args.quiet, preset, args.bank)
    options = (args.num_episodes, args.seed, args.video, args.quiet, args.scenes, args.dynamic, args.env_name)
    summary = evaluate_policy(policy, bank, out, *options, preset=args.preset, env_overrides=args.env_overrides)
    if not args.quiet:
        print(f"report: {out / 'report.md'}", file=sys.stderr)
    print(json.dumps({**summary, "folder": str(out)}))
    return 0
