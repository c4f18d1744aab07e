"""`urbanverse simulate-robot`: plays an environment as a robot for `urbanverse deploy`."""

import dataclasses
import json
import pathlib
from collections.abc import Sequence
from typing import Annotated

import tyro

from .. import pipeline
from ..pipeline.robot_simulation import SimulationOptions
from ._options import parse


@dataclasses.dataclass(frozen=True, kw_only=True)
class SimulateRobotArgs(SimulationOptions):
    """Play one episode in real time as a robot on the bridge of `deploy`; prints where its goal is, and the end."""

    policy: Annotated[pathlib.Path, tyro.conf.Positional]
    """File of `urbanverse export-onnx`, whose robot and camera are simulated."""


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse simulate-robot`."""
    args = parse(SimulateRobotArgs, argv, "urbanverse simulate-robot")
    print(json.dumps(pipeline.simulate_robot(args.policy, args, lambda where: print(json.dumps(where), flush=True))))
    return 0
