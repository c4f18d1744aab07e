"""`urbanverse play`: runs one agent on some episodes and writes a video."""

import dataclasses
import json
import pathlib
from collections.abc import Sequence

import tyro

from .. import pipeline
from ..pipeline.playing import PlayOptions
from ._options import EnvOverrides, ImageSize


@dataclasses.dataclass(frozen=True, kw_only=True)
class PlayArgs(PlayOptions):
    """Run episodes and write them as an mp4; prints one JSON line with their results."""

    policy: str | None = None
    """zero, random, go_to_goal, planner (with full knowledge of the scene), or a policy or run folder; default:
    go_to_goal."""
    size: ImageSize = (180, 320)
    """Size of each of the two images in pixels."""
    out: pathlib.Path = pathlib.Path("rollout.mp4")
    env_overrides: EnvOverrides = dataclasses.field(default_factory=dict)
    """JSON of flat dotted env config keys, e.g. '{"robot": "/robots/tug", "sim_dt": 0.005}'."""


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse play`."""
    args = tyro.cli(PlayArgs, args=list(argv), prog="urbanverse play")
    print(json.dumps(pipeline.play(args.out, args)))
    return 0
