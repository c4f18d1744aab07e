"""Checks of a run's graph and cousins, before anything is written that could not be compiled."""

import dataclasses
import json
import pathlib
from collections.abc import Sequence

from ...datatypes import SceneGraph
from ...datatypes import validation as v
from ...materialisation import Cousin, check_extent, check_placed, check_plausible, implausible_objects
from ...scene.ground import check_drivable, check_regions
from ...scene.planner import RobotSize
from .compiling import SHORT_ROUTES


def check_graph(graph: SceneGraph) -> None:
    """Checks that a graph can be of a street.

    Raises:
      ValidationError: see `check_plausible` and `check_regions`.
    """
    check_plausible(graph)
    check_regions(graph.ground)


def check_ground(graph: SceneGraph) -> None:
    """Checks that a graph's ground can be of a street; `leave_out_implausible` checks the objects of a distilled one.

    Raises:
      ValidationError: see `check_extent` and `check_regions`.
    """
    check_extent(graph)
    check_regions(graph.ground)


def leave_out_implausible(folder: pathlib.Path, graph: SceneGraph) -> SceneGraph:
    """Removes objects that cannot be of a street from a distilled graph in a folder with `graph.json` and
    `evidence.json`, which names them: one wrong mask or depth does not make a whole film useless.

    Raises:
      ValidationError: no object is left.
    """
    found = implausible_objects(graph)
    if not found:
        return graph
    if len(found) == len(graph.objects):
        raise next(iter(found.values()))
    kept = dataclasses.replace(graph, objects=tuple(obj for obj in graph.objects if obj.id not in found))
    kept.save(folder / "graph.json")
    body = v.read_json(folder / "evidence.json", "evidence of a graph")
    body["objects"] = [entry for entry in body["objects"] if entry["id"] not in found]
    body["implausible"] = [str(error) for error in found.values()]
    (folder / "evidence.json").write_text(json.dumps(body, indent=1) + "\n", encoding="utf-8")
    return kept


def check_cousins(graph: SceneGraph, cousins: Sequence[Cousin]) -> None:
    """Checks that something was placed, and that the ground, which all cousins share, can be compiled.

    Raises:
      ValidationError: see `check_placed`, `check_regions` and `check_drivable`.
    """
    check_placed(graph, cousins)
    size = RobotSize()
    ground = cousins[0].layout.ground
    check_regions(ground)
    check_drivable(ground, size.radius + size.margin, SHORT_ROUTES[0])
