"""`urbanverse deploy`: drives a robot with a policy's ONNX file, or replays a log of it."""

import dataclasses
import json
import pathlib
import sys
from collections.abc import Sequence
from typing import Annotated

import tyro

from .. import pipeline
from ..datatypes import ValidationError
from ..pipeline.deploying import DeployOptions
from ._options import parse


@dataclasses.dataclass(frozen=True, kw_only=True)
class DeployArgs(DeployOptions):
    """Drive a robot to goals with a policy's ONNX file, and stand when anything is wrong; prints one JSON line."""

    policy: Annotated[pathlib.Path | None, tyro.conf.Positional] = None
    """File of `urbanverse export-onnx`; with --replay only if it is no longer where it was."""
    replay: pathlib.Path | None = None
    """Log of an earlier run: compute every decision and action again, and say whether they are the same to the bit."""
    quiet: bool = False
    """Do not say on standard error why the robot stands or drives."""


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse deploy`; 1 if the policy's process was lost or a replay differs, 130 if interrupted."""
    args = parse(DeployArgs, argv, "urbanverse deploy")
    if args.replay is not None:
        found = pipeline.replay(args.replay, args.policy)
        print(json.dumps(found))
        return 0 if found["identical"] else 1
    if args.policy is None:
        raise ValidationError("deploy: found no policy, needed a file of `urbanverse export-onnx`, or --replay LOG.")
    say = None if args.quiet else lambda reason: print(f"deploy: {reason}", file=sys.stderr, flush=True)
    done = pipeline.deploy(args.policy, args, say)
    print(json.dumps(done))
    return {"policy lost": 1, "interrupted": 130}.get(done["result"], 0)
