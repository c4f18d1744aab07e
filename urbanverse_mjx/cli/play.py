"""`urbanverse play`: one agent over a few episodes, as a video. Needs no checkpoint with zero, random or go_to_goal."""

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
    """Drive episodes and write them as an mp4; prints one JSON line with how they ended."""

    size: ImageSize = (180, 320)
    """Of each of the two images, in pixels."""
    out: pathlib.Path = pathlib.Path("rollout.mp4")
    env_overrides: EnvOverrides = dataclasses.field(default_factory=dict)
    """JSON of flat dotted env config keys, e.g. '{"robot": "/robots/tug", "sim_dt": 0.005}'."""


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse play`."""
    args = tyro.cli(PlayArgs, args=list(argv), prog="urbanverse play")
    print(json.dumps(pipeline.play(args.out, args)))
    return 0
