"""`urbanverse evaluate`: evaluates a trained or scripted policy on fixed episodes."""

import dataclasses
import json
import pathlib
import re
import sys
import zlib
from collections.abc import Sequence
from typing import Annotated

import tyro

from ..datatypes import ValidationError
from ..datatypes import validation as v
from ._options import Dynamic, EnvOverrides, parse


@dataclasses.dataclass(frozen=True)
class EvaluateArgs:
    """Evaluate a policy on fixed episodes: one JSON line, and report.md, report.json and episodes.csv in a folder."""

    policy: Annotated[str, tyro.conf.Positional]
    """A policy folder, a run folder (for its policy with the most steps), or zero, random, go_to_goal, keep_distance
    (behind the person of CocoFollowPerson) or planner. A trained one is compared with three others: untrained,
    go_to_goal, and itself with its camera covered."""
    scenes: str = "test"
    """test, train, all, or scene ids separated by commas."""
    dynamic: Dynamic = False
    """Streets with moving people and vehicles, with metrics of the robot's distance to them; default: as in
    training."""
    env_name: str | None = None
    """Environment whose robot is driven, e.g. Go2Nav; default: that of the training, CocoNav for scripted policies."""
    preset: str = "paper"
    """Preset of the environment, for scripted policies; trained ones bring theirs."""
    bank: pathlib.Path | None = None
    """Scene bank; default: that of the preset of the training (`quick`: eight held-out streets, others: the two shipped
    ones), or that of URBANVERSE_BANK."""
    env_overrides: EnvOverrides = dataclasses.field(default_factory=dict)
    """JSON of flat dotted env config keys, e.g. '{"robot": "/robots/tug", "sim_dt": 0.005}'."""
    num_episodes: int = 100
    """Number of fixed episodes."""
    seed: int = 0
    """Draws the episodes, and what is random in them."""
    out: pathlib.Path | None = None
    """Folder of the report; default: evaluation in the policy's folder, for a run runs/RUN/checkpoints/STEPS/evaluation
    (training writes runs/RUN/evaluation), runs/evaluate-NAME for scripted policies, with the settings that differ from
    the defaults, such as evaluation-dynamic. An older report there is replaced."""
    video: bool = True
    """Write an mp4 of three episodes drawn at random with --seed, with their results."""
    quiet: bool = False
    """No progress bars, and no line about the report."""


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse evaluate`."""
    args = parse(EvaluateArgs, argv, "urbanverse evaluate")
    from ..pipeline.evaluation import SCRIPTED, evaluate_policy
    from ..pipeline.training_run import bank_of
    from ..training.policy import PolicySpec, latest_policy

    v.integer(args.num_episodes, "--num-episodes", 1)
    if args.policy in SCRIPTED:
        policy, out = args.policy, pathlib.Path("runs") / f"evaluate-{args.policy}{_settings(args)}"
        environment, preset = args.env_name or "CocoNav", args.preset
    elif pathlib.Path(args.policy).is_dir():
        policy = latest_policy(pathlib.Path(args.policy))
        out = policy / f"evaluation{_settings(args)}"
        spec = PolicySpec.load(policy)
        environment, preset = args.env_name or spec.environment, spec.env_config.get("preset")
    else:
        raise ValidationError(
            f"policy: found {args.policy!r}, needed a policy or run folder, or one of {', '.join(SCRIPTED)}; ONNX "
            "files are scored by `urbanverse benchmark`."
        )
    out = args.out or out
    bank = bank_of(environment, args.quiet, preset, args.bank, args.scenes)
    options = (args.num_episodes, args.seed, args.video, args.quiet, args.scenes, args.dynamic, args.env_name)
    summary = evaluate_policy(policy, bank, out, *options, preset=args.preset, env_overrides=args.env_overrides)
    if not args.quiet:
        print(f"report: {out / 'report.md'}", file=sys.stderr)
    print(json.dumps({**summary, "folder": str(out)}))
    return 0


def _settings(args: EvaluateArgs) -> str:
    """Names the settings that differ from the defaults, for the folder, so that reports of other settings stay."""
    chosen = [args.env_name, args.bank and args.bank.stem, args.scenes if args.scenes != "test" else None]
    chosen += [args.preset if args.preset != "paper" else None, f"seed{args.seed}" if args.seed else None]
    if args.env_overrides:
        text = json.dumps(dict(args.env_overrides), sort_keys=True)
        chosen.append(f"overrides{zlib.crc32(text.encode()):08x}")
    chosen.append("dynamic" if args.dynamic else None)
    words = "".join(f"-{word}" for word in chosen if word)
    return re.sub(r"[^\w.-]+", "_", words)[:120]
