"""Small groups that belong together wherever they stand: a laid table, bicycles pushed into a rail."""

import math
from collections.abc import Sequence

from .canvas import Canvas, Edge

#: m from a table's middle to a chair's.
SEAT = 0.78
#: m from a bicycle rail's middle to the middle of a bicycle whose front wheel is in it, and the free gap between them.
RAIL = 1.06


def laid_table(
    canvas: Canvas, x: float, y: float, degrees: float, seats: Sequence[float] = (0.0, 180.0), shade: int | None = None
) -> None:
    """A table with chairs that face it, at bearings (degrees) from its own heading; a sunshade of a variant beside
    it."""
    canvas.put("table", x, y, degrees, 1)
    for bearing in seats:
        angle = math.radians(degrees + bearing)
        canvas.put("chair", x + SEAT * math.cos(angle), y + SEAT * math.sin(angle), degrees + bearing + 180.0)
    if shade is not None:
        angle = math.radians(degrees + 45.0)
        canvas.put("sunshade", x + 1.05 * math.cos(angle), y + 1.05 * math.sin(angle), degrees, shade)


def railed_bicycles(canvas: Canvas, line: Edge, s: float, d: float, at: Sequence[float], towards: str = "wall") -> None:
    """A rail of 2 m along an edge, and bicycles at places along it (m from its middle), their front wheels to it."""
    canvas.put("bicycle parking", *line.at(s, d), line.facing("street"), 1)
    away = -RAIL if towards == "wall" else RAIL
    for offset in at:
        canvas.put("bicycle", *line.at(s + offset, d + away), line.facing(towards), 1)
