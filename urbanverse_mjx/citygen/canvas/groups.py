"""Small groups of objects: a table with chairs, bicycles at a rail."""

import math
from collections.abc import Sequence

from .canvas import Canvas, Edge

#: m from a table's middle to a chair's.
SEAT = 0.78
#: m from a bicycle rail's middle to the middle of a bicycle with its front wheel in the rail, and the gap between them.
RAIL = 1.06


def laid_table(
    canvas: Canvas, x: float, y: float, degrees: float, seats: Sequence[float] = (0.0, 180.0), shade: int | None = None
) -> None:
    """Places a table with chairs that face it, at bearings (degrees) from its own heading, and optionally a sunshade of
    a variant beside it."""
    canvas.put("table", x, y, degrees, 1)
    for bearing in seats:
        angle = math.radians(degrees + bearing)
        canvas.put("chair", x + SEAT * math.cos(angle), y + SEAT * math.sin(angle), degrees + bearing + 180.0)
    if shade is not None:
        angle = math.radians(degrees + 45.0)
        canvas.put("sunshade", x + 1.05 * math.cos(angle), y + 1.05 * math.sin(angle), degrees, shade)


def railed_bicycles(canvas: Canvas, line: Edge, s: float, d: float, at: Sequence[float], towards: str = "wall") -> None:
    """Places a rail of 2 m along an edge, and bicycles at positions along it (m from its middle), front wheels to the
    rail."""
    canvas.put("bicycle parking", *line.at(s, d), line.facing("street"), 1)
    away = -RAIL if towards == "wall" else RAIL
    for offset in at:
        canvas.put("bicycle", *line.at(s + offset, d + away), line.facing(towards), 1)
