"""`urbanverse record`: a policy drives episodes, which are written as a dataset; the result as one JSON line."""

import dataclasses
import json
import pathlib
import sys
from collections.abc import Sequence
from typing import Annotated

import tyro
from tyro.constructors import PrimitiveConstructorSpec

from .. import pipeline
from ..pipeline.recording.record import RecordOptions
from ._options import Crowded, EnvOverrides, ImageSize, parse

_Sensors = Annotated[
    tuple[str, ...],
    tyro.conf.arg(name="with"),
    PrimitiveConstructorSpec(
        nargs=1,
        metavar="NAME,NAME",
        instance_from_str=lambda words: tuple(name for name in words[0].split(",") if name),
        is_instance=lambda value: isinstance(value, tuple),
        str_from_instance=lambda value: [",".join(value)],
    ),
]


@dataclasses.dataclass(frozen=True, kw_only=True)
class RecordArgs(RecordOptions):
    """Record episodes of a policy as a dataset in a new folder; prints one JSON line with how they ended."""

    out: pathlib.Path
    """New or empty folder, or with --resume that of a recording."""
    size: ImageSize = (135, 240)
    """Of the images, in pixels, whatever the policy sees."""
    sensors: _Sensors = ()
    """Besides colour, separated by commas: depth, normal, semantic, instance, lidar, imu, odometry, camera_pose,
    contacts, boxes; segmentation for semantic and instance, all for everything."""
    people: Crowded = False
    """Streets full of people and vehicles that move."""
    env_overrides: EnvOverrides = dataclasses.field(default_factory=dict)
    """JSON of flat dotted env config keys, e.g. '{"robot": "/robots/tug", "sim_dt": 0.005}'."""


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse record`."""
    args = parse(RecordArgs, argv, "urbanverse record")
    said = pipeline.record(args.out, args, lambda address: print(f"open {address}", file=sys.stderr, flush=True))
    print(json.dumps(said))
    return 0
