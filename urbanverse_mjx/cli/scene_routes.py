"""`urbanverse scene routes`: writes maps and planned routes as files of CraftBench-Nav."""

import dataclasses
import json
import pathlib
import sys
from typing import Annotated

import tyro

from .. import pipeline
from ..datatypes import validation as v


@dataclasses.dataclass(frozen=True)
class RoutesArgs:
    """Plan routes on maps for a robot and write them in the format of CraftBench-Nav; prints one JSON line per
    scene."""

    scenes: Annotated[tuple[pathlib.Path, ...], tyro.conf.Positional]
    """Folders with map.json and layers.npz: compiled scenes, or maps that the authors' tools made."""
    out: pathlib.Path
    """Folder to write: maps/<scene>/, routes/<scene>.json and routes/<scene>/ of every scene."""
    robot: Annotated[str, tyro.conf.arg(metavar="NAME")] = "delivery"
    """Kind of robot for the routes: delivery, quadruped or wheelchair."""
    annotations: pathlib.Path | None = None
    """Folder of <scene>.json files with starts and goals; none: twelve routes are chosen."""
    seed: int = 0
    """Seed of the choice among equally good starts."""


def main(args: RoutesArgs) -> int:
    """Runs `urbanverse scene routes`; status 1 if a route could not be planned."""
    from ..scene.planner import ROBOTS
    from ..scene.routes import NoRoute

    v.choice(args.robot, "--robot", ROBOTS)
    if not args.scenes:
        raise v.fail("scenes", "none", "at least one folder with a map.json", "name a compiled scene")
    failed = 0
    for folder in args.scenes:
        planned = pipeline.plan_routes(folder, args.out, args.robot, args.annotations, args.seed)
        refused = [route for route in planned.routes if isinstance(route, NoRoute)]
        for route in refused:
            sys.stderr.write(f"{planned.scene} {route.id}: {route.error}\n")
        lengths = [r.facts["length_m"] for r in planned.planned]
        summary = {"scene": planned.scene, "robot": args.robot, "routes": len(lengths), "failed": len(refused)}
        print(json.dumps({**summary, "longest_m": max(lengths, default=0.0)}))
        failed += len(refused)
    return int(failed > 0)
