"""Writes maps and planned routes as files of CraftBench-Nav."""

import os
import pathlib
from typing import TYPE_CHECKING

from ..datatypes import validation as v

if TYPE_CHECKING:
    from ..scene.exchange import ExchangeMap
    from ..scene.exchange_routes import PlannedRoutes
    from ..scene.routes import Wanted


def plan_routes(
    scene: str | os.PathLike[str],
    out: str | os.PathLike[str],
    robot: str = "delivery",
    annotations: str | os.PathLike[str] | None = None,
    seed: int = 0,
) -> "PlannedRoutes":
    """Plans routes on a scene's map for a robot and writes them in the format of CraftBench-Nav.

    Args:
      scene: folder with map.json and layers.npz: a compiled scene, or a map of the authors' tools.
      out: folder to write: maps/<scene>/, routes/<scene>.json and routes/<scene>/.
      robot: kind of robot for the routes: delivery, quadruped or wheelchair.
      annotations: folder of <scene>.json files with starts and goals; None to choose twelve routes.
      seed: seed of the choice among equally good starts.

    Returns: the routes; one that could not be planned has the reason.

    Raises:
      ValidationError: the robot is unknown, the folder has no map, or the annotations are of another scene.
    """
    from ..scene.exchange import load_map, save_map
    from ..scene.exchange_routes import plan_all, save_annotations, save_planned
    from ..scene.planner import ROBOTS
    from ..scene.routes import RoutePlanner

    v.choice(robot, "--robot", ROBOTS)
    out = pathlib.Path(out)
    exchange = load_map(pathlib.Path(scene))
    name = v.identifier(exchange.scene, f"{scene}: scene")
    planner = RoutePlanner(exchange.map, robot)
    wanted = planner.choose(seed) if annotations is None else _annotated(pathlib.Path(annotations), exchange)
    planned = plan_all(planner, name, exchange.grid, wanted)
    save_map(out / "maps" / name, exchange)
    save_annotations(out / "routes" / f"{name}.json", name, wanted)
    save_planned(out / "routes" / name, planned)
    return planned


def _annotated(folder: pathlib.Path, exchange: "ExchangeMap") -> "list[Wanted]":
    from ..scene.exchange_routes import load_annotations

    path = folder / f"{exchange.scene}.json"
    scene, wanted = load_annotations(path)
    if scene != exchange.scene:
        raise v.fail(str(path), f"routes of {scene!r}", f"routes of {exchange.scene!r}", "rename the file")
    return wanted
