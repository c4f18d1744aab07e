"""`urbanverse evaluate`: a trained policy and its comparisons over fixed episodes; the result as one JSON line."""

import dataclasses
import json
import pathlib
import sys
from collections.abc import Sequence
from typing import Annotated

import tyro


@dataclasses.dataclass(frozen=True)
class EvaluateArgs:
    """Evaluate a policy on fixed episodes: one JSON line, and report.md, report.json and episodes.csv in a folder."""

    policy: Annotated[pathlib.Path, tyro.conf.Positional]
    """A policy folder, or a run folder (its most trained policy is taken)."""
    scenes: str = "test"
    """test, train, all, or scene ids separated by commas."""
    dynamic: bool = False
    """Streets with people and vehicles that move, and how near the robot came to them; else as it was trained."""
    env_name: str | None = None
    """Whose robot the policy drives, e.g. Go2Nav; default: the one it was trained with."""
    num_episodes: int = 100
    seed: int = 0
    out: pathlib.Path | None = None
    """Where the report goes; default: beside the policy."""
    video: bool = True
    quiet: bool = False


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse evaluate`."""
    args = tyro.cli(EvaluateArgs, args=list(argv), prog="urbanverse evaluate")
    from ..pipeline import ensure_default_bank
    from ..pipeline.evaluation import evaluate_policy
    from ..training.policy import latest_policy

    policy = latest_policy(args.policy)
    out = args.out or policy / "evaluation"
    bank = ensure_default_bank(quiet=args.quiet)
    options = (args.num_episodes, args.seed, args.video, args.quiet, args.scenes, args.dynamic, args.env_name)
    summary = evaluate_policy(policy, bank, out, *options)
    if not args.quiet:
        print(f"report: {out / 'report.md'}", file=sys.stderr)
    print(json.dumps({**summary, "folder": str(out)}))
    return 0
