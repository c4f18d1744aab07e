"""`urbanverse play`: runs one agent on some episodes and writes a video."""

import argparse
import dataclasses
import json
import pathlib
import sys
from collections.abc import Sequence

import tyro

from .. import pipeline
from ..datatypes import validation as v
from ..pipeline.playing import PlayOptions
from ._options import Dynamic, EnvOverrides, ImageSize, parse


@dataclasses.dataclass(frozen=True, kw_only=True)
class PlayArgs(PlayOptions):
    """Run episodes and write them as an mp4; prints one JSON line with their results."""

    policy: str | None = None
    """zero, random, go_to_goal, planner (with full knowledge of the scene), or a policy or run folder; default:
    go_to_goal."""
    agent: tyro.conf.Suppress[str | None] = None
    scenes: str = "test"
    """train, test, validation, all, or scene ids separated by commas."""
    size: ImageSize = (180, 320)
    """Size of each of the two images in pixels."""
    out: pathlib.Path = pathlib.Path("rollout.mp4")
    """The video; an existing file is replaced."""
    dynamic: Dynamic = False
    """With moving people and vehicles."""
    env_overrides: EnvOverrides = dataclasses.field(default_factory=dict)
    """JSON of flat dotted env config keys, e.g. '{"robot": "/robots/tug", "sim_dt": 0.005}'."""


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse play`."""
    # A former option that still works; tyro knows no option that its help does not list.
    former = argparse.ArgumentParser(prog="urbanverse play", add_help=False, allow_abbrev=False)
    former.add_argument("--agent")
    agent, words = former.parse_known_args(list(argv))
    args = parse(PlayArgs, words, "urbanverse play")
    args = dataclasses.replace(args, agent=agent.agent)
    done = pipeline.play(args.out, args)
    ground, number = sum(bool(r["hit_ground"]) for r in done["results"]), len(done["results"])
    if ground and not args.quiet:
        print(
            f"{ground} of {v.counted(number, 'episodes')} ended because a part of the robot other than a foot touched "
            "the ground; `urbanverse robot` reports the clearance of a robot of your own and whether it tips over.",
            file=sys.stderr,
        )
    print(json.dumps(done))
    return 0
