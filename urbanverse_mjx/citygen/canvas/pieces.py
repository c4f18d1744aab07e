"""Small groups of objects that are placed together: a table with chairs, parked bicycles, a queue."""

import itertools
import math
from collections.abc import Sequence

import shapely

from .. import catalogue
from . import object_sizes
from .canvas import Canvas, Edge
from .ground_layers import Corner

#: Sizes of objects of the last six CraftBench scenes: first the sizes of the streets, so that a table without a variant
#: is a small one, then the variants that only hand-made scenes use.
SIZES: dict[str, tuple[catalogue.Size, ...]] = (
    object_sizes.SIZES
    | catalogue.SIZES
    | {
        "scooter": object_sizes.SIZES["scooter"],
        "bench": (*catalogue.SIZES["bench"], (0.48, 1.52, 0.45), (0.5, 1.98, 0.44)),
        "fence": (*catalogue.SIZES["fence"], (0.13, 2.51, 1.8), (0.6, 2.36, 1.96)),
    }
)

JOINT = 0.08  # m at either end of a row of fence, so that rows may meet at a corner
SEAT = 0.72  # m from the middle of a small table to that of a chair drawn up to it
BICYCLE_SPACING = 0.62  # m between bicycles that share a stand


def blank(scene_id: str) -> Canvas:
    """Returns a canvas with this module's sizes."""
    canvas = Canvas(scene_id)
    canvas.sizes = SIZES
    return canvas


def table(
    canvas: Canvas,
    x: float,
    y: float,
    seats: Sequence[float] = (0.0, 180.0),
    variant: int | None = None,
    seat: str = "chair",
    away: float = SEAT,
) -> None:
    """Places a table with a seat in each of the directions (degrees from +x), facing it."""
    canvas.put("table", x, y, seats[0] if seats else 0.0, variant)
    for degrees in seats:
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        canvas.put(seat, x + away * c, y + away * s, degrees + 180.0)


def tables(
    canvas: Canvas, line: Edge, at: Sequence[tuple[float, float]], seats: Sequence[float] = (0.0, 180.0)
) -> None:
    """Places tables with seats at positions (s, d) along an edge; seat directions are relative to the edge."""
    for s, d in at:
        table(canvas, *line.at(s, d), [line.degrees + turn for turn in seats])


def barrel(canvas: Canvas, x: float, y: float, seats: Sequence[float]) -> None:
    """Places a barrel that serves as a table, with stools."""
    canvas.put("barrel or bucket", x, y, 0.0, 0)
    for degrees in seats:
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        canvas.put("stool", x + 0.66 * c, y + 0.66 * s, degrees)


def bicycles(canvas: Canvas, x: float, y: float, degrees: float, turned: Sequence[bool], rack: bool = True) -> None:
    """Places bicycles side by side around (x, y), each headed along `degrees` or in the opposite direction."""
    across = math.radians(degrees + 90.0)
    if rack:
        canvas.put("bicycle parking", x + 1.15 * math.cos(across - math.pi / 2), y, degrees, 1)
    for i, back in enumerate(turned):
        off = (i - (len(turned) - 1) / 2) * BICYCLE_SPACING
        place = x + off * math.cos(across), y + off * math.sin(across)
        canvas.put("bicycle", *place, degrees + (180.0 if back else 0.0))


def people(canvas: Canvas, who: Sequence[tuple[str, float, float, float]]) -> None:
    """Places people, each given as label, x, y and heading."""
    for label, x, y, degrees in who:
        canvas.put(label, x, y, degrees)


def chain(canvas: Canvas, label: str, points: Sequence[Corner], variant: int = 0, stretch: float = 1.0) -> None:
    """Places pieces of fence, wall or barrier end to end along a polyline, facing to its left.

    Args:
      stretch: how much longer than the label's size a piece may be made to fill its stretch; 1 keeps the size and
        spreads the remaining length between the pieces.
    """
    thick, along, high = canvas.sizes[label][variant]
    for (x0, y0), (x1, y1) in itertools.pairwise(points):
        length = math.dist((x0, y0), (x1, y1)) - 2 * JOINT
        fits = length / (along * stretch)
        count = max(1, math.ceil(fits) if stretch > 1.0 else math.floor(fits + 1e-6))
        size = (thick, round(length / count - JOINT, 3), high) if stretch > 1.0 else None
        heading = math.degrees(math.atan2(y1 - y0, x1 - x0))
        for i in range(count):
            share = (JOINT + length * (i + 0.5) / count) / (length + 2 * JOINT)
            place = x0 + (x1 - x0) * share, y0 + (y1 - y0) * share
            canvas.put(label, *place, heading + 90.0, None if size else variant, size)


def apron(canvas: Canvas, name: str, corners: Sequence[Corner], z: float, width: float = 2.4) -> None:
    """Adds ground under the fronts around an outline; it is less deep than any house, so that no path leads behind
    them."""
    wider = shapely.Polygon(corners).buffer(width, join_style="mitre")
    canvas.ground(name, "sidewalk", [(x, y) for x, y in wider.exterior.coords[:-1]], z)
