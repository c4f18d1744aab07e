"""Groups of objects on a pavement or road."""

from collections.abc import Sequence

from . import section
from .composer import StreetComposer


def cafe_set(
    street: StreetComposer, x: float, side: int, from_kerb: float, chairs: int = 2, shade: bool = False
) -> None:
    """Places a table with chairs along the street, and optionally a sunshade over it."""
    street.put("table", x, side, from_kerb)
    away = 0.72
    seats = ((-away, 0.0, "+x"), (away, 0.0, "-x"), (0.0, away, "street"), (0.0, -away, "wall"))
    for dx, dd, facing in seats[:chairs]:
        street.put("chair", x + dx + street.uniform(-0.05, 0.05), side, from_kerb + dd, facing)
    if shade:
        street.put("sunshade", x, side, from_kerb - 0.85)


def rubbish(street: StreetComposer, x: float, side: int, from_kerb: float, bags: int = 2) -> None:
    """Places a bin with bags beside it."""
    street.put("trash bin", x, side, from_kerb, "street")
    spots = ((0.74, 0.05), (-0.76, -0.1), (0.3, -0.75), (1.5, 0.1))
    for dx, dd in spots[:bags]:
        turn = street.uniform(-180.0, 180.0)
        street.put("garbage bag", x + dx, side, from_kerb + dd, turn)


def parked(street: StreetComposer, cars: Sequence[tuple[str, float]], side: int, from_kerb: float = -1.12) -> None:
    """Places cars at the kerb, headed with the traffic of their side (driving on the right) and slightly rotated."""
    ahead = 180.0 if side > 0 else 0.0
    for label, x in cars:
        street.put(label, x, side, from_kerb, ahead + street.uniform(-1.5, 1.5))


def bay_lines(street: StreetComposer, xs: Sequence[float], side: int, depth: float = 2.1) -> None:
    """Adds short white lines between parking bays."""
    inner, outer = street.y_at(side, -depth), street.y_at(side, 0.0)
    name = "left" if side > 0 else "right"
    street.paint(
        section.line(f"{name}_bay_{i}", x - 0.05, x + 0.05, min(inner, outer), max(inner, outer))
        for i, x in enumerate(xs)
    )


def lane_paint(street: StreetComposer, y: float = 0.0) -> None:
    """Adds a dashed middle line between the crosswalks, and a stop line before each of them for both directions."""
    cut, x = section.CROSSWALK_HALF_WIDTH + 2.2, 1.5
    stops = []
    for i, middle in enumerate((*street.section.crosswalks, None)):
        end = street.section.length - 1.5 if middle is None else middle - cut
        street.paint(section.dashes(f"middle_line_{i}", x, end, y))
        if middle is not None:
            x = middle + cut
            half = street.section.half
            a, b = middle - section.CROSSWALK_HALF_WIDTH, middle + section.CROSSWALK_HALF_WIDTH
            stops.append(section.line(f"stop_line_{i}_a", a - 1.3, a - 0.9, -half + 0.2, y - 0.15))
            stops.append(section.line(f"stop_line_{i}_b", b + 0.9, b + 1.3, y + 0.15, half - 0.2))
    street.paint(stops)
