"""Reads and writes route files of CraftBench-Nav, format 1 (docs/sources/reference_systems.md b.2).

`<scene>.json` holds the annotations; the folder `<scene>/` the routes planned from them for one robot: `routes.json`,
`<id>.npy` (N x 4 float64: x, y, z, yaw) and `routes.txt`.
"""

import dataclasses
import os
import pathlib
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..datatypes import validation as v
from ..datatypes.ground import LIMIT
from .planner import RobotSize
from .routes import NoRoute, Point, Route, RoutePlanner, Wanted

FORMAT = 1
FRAME = "scene world, meters, Z up; yaw in radians from +X"
COLUMNS = (
    "id start_x start_y start_z start_yaw goal_x goal_y goal_z "
    "length_m straight_m road_crossings curbs min_clearance_m waypoints note"
).split()
_WITHIN = {"minimum": -LIMIT, "maximum": LIMIT}


@dataclasses.dataclass(frozen=True)
class PlannedRoutes:
    """Contents of a folder of planned routes.

    Attributes:
      scene: id of the scene.
      robot: name of the robot.
      size: size of the robot.
      grid: position of the map, as in `map.json`.
      routes: planned ones and failures, in the file's order.
    """

    scene: str
    robot: str
    size: RobotSize
    grid: dict[str, Any]
    routes: tuple[Route | NoRoute, ...]

    @property
    def planned(self) -> list[Route]:
        """The routes that could be planned."""
        return [r for r in self.routes if isinstance(r, Route)]


def plan_all(planner: RoutePlanner, scene: str, grid: dict[str, Any], wanted: Sequence[Wanted]) -> PlannedRoutes:
    """Plans every wanted route of a scene."""
    return PlannedRoutes(scene, planner.robot, planner.size, grid, tuple(planner.plan(wanted)))


def save_annotations(path: str | os.PathLike[str], scene: str, wanted: Sequence[Wanted]) -> None:
    """Writes `<scene>.json` with points rounded to millimetres."""
    routes = [
        {"id": w.id, "start": _mm(w.start), "via": [_mm(p) for p in w.via], "goal": _mm(w.goal), "note": w.note}
        for w in wanted
    ]
    v.write_json(path, {"format": FORMAT, "scene": scene, "routes": routes})


def load_annotations(path: str | os.PathLike[str]) -> tuple[str, list[Wanted]]:
    """The scene's id and its annotated routes.

    Raises:
      ValidationError: the file has another or a newer format.
    """
    body = _checked(path, "routes", ("format", "scene", "routes"), ("saved",))
    wanted = []
    for i, entry in enumerate(v.items(body["routes"], f"{path}: routes")):
        where = v.named(entry, f"{path}: routes[{i}]", "route")
        m = v.mapping(entry, where, ("id", "start", "goal"), ("via", "note"))
        via = v.items(m.get("via", ()), f"{where}.via")
        wanted.append(
            Wanted(
                v.identifier(m["id"], f"{where}.id"),
                _point(m["start"], f"{where}.start"),
                _point(m["goal"], f"{where}.goal"),
                tuple(_point(p, f"{where}.via[{k}]") for k, p in enumerate(via)),
                v.text(m.get("note", ""), f"{where}.note", allow_empty=True),
            )
        )
    v.unique((w.id for w in wanted), str(path))
    return v.identifier(body["scene"], f"{path}: scene"), wanted


def save_planned(folder: str | os.PathLike[str], planned: PlannedRoutes) -> None:
    """Writes `routes.json`, `routes.txt` and the waypoints to the scene's folder, and removes the waypoints of an
    earlier `routes.json`."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    stale = _waypoint_files(folder)
    for route in planned.planned:
        v.write_atomically(
            folder / f"{route.id}.npy",
            lambda p, w=route.waypoints: np.save(p, w.astype(np.float64), allow_pickle=False),
        )
    body = {
        "format": FORMAT,
        "scene": planned.scene,
        "frame": FRAME,
        "robot": {
            "name": planned.robot,
            "radius": planned.size.radius,
            "height": planned.size.height,
            "step": planned.size.step,
        },
        "map": {"folder": planned.scene, **planned.grid},
        "routes": [_entry(r) for r in planned.routes],
    }
    v.write_json(folder / "routes.json", body)
    lines = ["\t".join(COLUMNS), *("\t".join(_cells(r)) for r in planned.planned)]
    v.write_atomically(folder / "routes.txt", lambda p: p.write_text("\n".join(lines) + "\n", encoding="utf-8"))
    for name in stale - {f"{r.id}.npy" for r in planned.planned}:
        (folder / name).unlink(missing_ok=True)


def _waypoint_files(folder: pathlib.Path) -> set[str]:
    """Names of the waypoint files that a folder's `routes.json` lists; empty if it cannot be read."""
    try:
        return {f"{route.id}.npy" for route in load_planned(folder).planned}
    except v.ValidationError:
        return set()


def load_planned(folder: str | os.PathLike[str]) -> PlannedRoutes:
    """Reads a scene's folder of planned routes, of this package or of CraftBench-Nav.

    Raises:
      ValidationError: a file is missing, damaged or of a newer format.
    """
    folder = pathlib.Path(folder)
    path = folder / "routes.json"
    body = _checked(path, "planned routes", ("format", "scene", "robot", "routes"), ("frame", "map"))
    where = f"{path}: robot"
    robot = v.mapping(body["robot"], where, ("name", "radius", "height", "step"))
    numbers = [v.number(robot[k], f"{where}.{k}", 0.0, 100.0) for k in ("radius", "height", "step")]
    size = RobotSize(radius=numbers[0], margin=0.0, height=numbers[1], step=numbers[2])
    entries = v.items(body["routes"], f"{path}: routes")
    routes = tuple(_route(entry, folder, f"{path}: routes[{i}]") for i, entry in enumerate(entries))
    grid = {k: x for k, x in dict(body.get("map", {})).items() if k != "folder"}
    name = v.text(robot["name"], f"{where}.name")
    return PlannedRoutes(v.identifier(body["scene"], f"{path}: scene"), name, size, grid, routes)


def _checked(path: Any, kind: str, required: Sequence[str], optional: Sequence[str]) -> Any:
    body = v.mapping(v.read_json(path, kind), str(path), required, optional)
    if v.integer(body["format"], f"{path}: format", 1) > FORMAT:
        raise v.fail(str(path), f"format {body['format']}", f"at most {FORMAT}", "export it in the older format")
    return body


def _mm(point: Point) -> list[float]:
    return [round(c, 3) for c in point]


def _point(value: Any, where: str) -> Point:
    x, y = v.vector(value, where, 2, **_WITHIN)
    return x, y


def _entry(route: Route | NoRoute) -> dict[str, Any]:
    if isinstance(route, NoRoute):
        return {"id": route.id, "note": route.note, "error": route.error}
    start, goal = (row.tolist() for row in route.waypoints[[0, -1]])
    return {
        "id": route.id,
        "note": route.note,
        "start": dict(zip(("x", "y", "z", "yaw"), start, strict=True)),
        "goal": dict(zip("xyz", goal[:3], strict=True)),
        "points": [list(p) for p in route.points],
        "path": np.round(route.path, 3).tolist(),
        "waypoints": f"{route.id}.npy",
        "facts": route.facts,
    }


def _cells(route: Route) -> list[str]:
    """One line of `routes.txt`."""
    places = [*route.waypoints[0], *route.waypoints[-1, :3]]
    facts = [route.facts[k] for k in ("length_m", "straight_m", "road_crossings", "curbs", "min_clearance_m")]
    return [route.id, *(f"{c:.3f}" for c in places), *map(str, facts), str(len(route.waypoints)), route.note]


def _route(entry: Any, folder: pathlib.Path, where: str) -> Route | NoRoute:
    where = v.named(entry, where, "route")
    if isinstance(entry, dict) and "error" in entry:
        m = v.mapping(entry, where, ("id", "error"), ("note",))
        return NoRoute(v.identifier(m["id"], f"{where}.id"), m.get("note", ""), v.text(m["error"], f"{where}.error"))
    keys = ("id", "start", "goal", "points", "path", "waypoints", "facts")
    m = v.mapping(entry, where, keys, ("note",))
    points = [_point(p, f"{where}.points[{i}]") for i, p in enumerate(v.items(m["points"], f"{where}.points", 2))]
    path = [_point(p, f"{where}.path[{i}]") for i, p in enumerate(v.items(m["path"], f"{where}.path", 2))]
    if not isinstance(m["facts"], dict):
        raise v.fail(f"{where}.facts", v.show(m["facts"]), "a JSON object")
    note = v.text(m.get("note", ""), f"{where}.note", allow_empty=True)
    waypoints = _waypoints(folder, v.text(m["waypoints"], f"{where}.waypoints"))
    return Route(v.identifier(m["id"], f"{where}.id"), note, tuple(points), np.array(path), waypoints, dict(m["facts"]))


def _waypoints(folder: pathlib.Path, name: str) -> np.ndarray:
    path = folder / name
    if pathlib.PurePath(name).name != name:
        raise v.fail(str(path), "a path", "the name of a file beside routes.json")
    if not path.is_file():
        raise v.fail(str(path), "no such file", "waypoints of a route", "plan the routes again")
    try:
        rows = np.load(path, allow_pickle=False)
    except (OSError, ValueError) as error:
        raise v.fail(str(path), f"a file that cannot be read ({error})", "an array of N x 4 numbers") from error
    if rows.dtype.kind != "f" or rows.ndim != 2 or rows.shape[1] != 4 or len(rows) < 2 or not np.isfinite(rows).all():
        raise v.fail(str(path), f"{rows.dtype} {rows.shape}", "N x 4 finite numbers, N at least 2")
    return rows.astype(np.float64)
