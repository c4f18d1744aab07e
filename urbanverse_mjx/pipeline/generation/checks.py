"""Checks of a run's graph and cousins, before anything is written that could not be compiled."""

from collections.abc import Sequence

from ...datatypes import SceneGraph
from ...materialisation import Cousin, check_placed, check_plausible
from ...scene.ground import check_regions, check_room
from ...scene.planner import RobotSize
from .compiling import SHORT_ROUTES


def check_graph(graph: SceneGraph) -> None:
    """Checks that a graph can be of a street.

    Raises:
      ValidationError: see `check_plausible` and `check_regions`.
    """
    check_plausible(graph)
    check_regions(graph.ground)


def check_cousins(graph: SceneGraph, cousins: Sequence[Cousin]) -> None:
    """Checks that something was placed, and that the ground, which all cousins share, can be compiled.

    Raises:
      ValidationError: see `check_placed`, `check_regions` and `check_room`.
    """
    check_placed(graph, cousins)
    size = RobotSize()
    ground = cousins[0].layout.ground
    check_regions(ground)
    check_room(ground, size.radius + size.margin, SHORT_ROUTES[0])
