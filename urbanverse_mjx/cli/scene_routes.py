"""`urbanverse scene routes`: maps and planned routes as CraftBench-Nav's files, from our scenes or from theirs."""

import dataclasses
import json
import pathlib
import sys
from typing import TYPE_CHECKING, Annotated

import tyro

from ..datatypes import validation as v

if TYPE_CHECKING:
    from ..scene.exchange import ExchangeMap
    from ..scene.routes import Wanted


@dataclasses.dataclass(frozen=True)
class RoutesArgs:
    """Plan routes over maps for a robot and write them as CraftBench-Nav does; prints one JSON line per scene."""

    scenes: Annotated[tuple[pathlib.Path, ...], tyro.conf.Positional]
    """Folders with map.json and layers.npz: compiled scenes, or maps that the authors' tools made."""
    out: pathlib.Path
    """Folder to write: maps/<scene>/, routes/<scene>.json and routes/<scene>/ of every scene."""
    robot: str = "delivery"
    """Whom the routes are for: delivery, quadruped or wheelchair."""
    annotations: pathlib.Path | None = None
    """Folder of <scene>.json files, starts and goals to plan; none: twelve routes are chosen."""
    seed: int = 0
    """Chooses among equally good starts."""


def main(args: RoutesArgs) -> int:
    """Runs `urbanverse scene routes`; status 1 where a route could not be planned."""
    from ..scene.exchange import load_map, save_map
    from ..scene.exchange_routes import plan_all, save_annotations, save_planned
    from ..scene.planner import ROBOTS
    from ..scene.routes import NoRoute, RoutePlanner

    v.choice(args.robot, "--robot", ROBOTS)
    if not args.scenes:
        raise v.fail("scenes", "none", "at least one folder with a map.json", "name a compiled scene")
    failed = False
    for folder in args.scenes:
        exchange = load_map(folder)
        name = v.identifier(exchange.scene, f"{folder}: scene")
        planner = RoutePlanner(exchange.map, args.robot)
        wanted = planner.choose(args.seed) if args.annotations is None else _annotated(args.annotations, exchange)
        planned = plan_all(planner, name, exchange.grid, wanted)
        save_map(args.out / "maps" / name, exchange)
        save_annotations(args.out / "routes" / f"{name}.json", name, wanted)
        save_planned(args.out / "routes" / name, planned)
        for route in planned.routes:
            if isinstance(route, NoRoute):
                failed = True
                sys.stderr.write(f"{name} {route.id}: {route.error}\n")
        lengths = [r.facts["length_m"] for r in planned.planned]
        told = {"scene": name, "robot": args.robot, "routes": len(lengths), "failed": len(wanted) - len(lengths)}
        print(json.dumps({**told, "longest_m": max(lengths, default=0.0)}))
    return int(failed)


def _annotated(folder: pathlib.Path, exchange: "ExchangeMap") -> "list[Wanted]":
    from ..scene.exchange_routes import load_annotations

    path = folder / f"{exchange.scene}.json"
    scene, wanted = load_annotations(path)
    if scene != exchange.scene:
        raise v.fail(str(path), f"routes of {scene!r}", f"routes of {exchange.scene!r}", "rename the file")
    return wanted
