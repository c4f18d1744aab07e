"""Ground of a straight street as a few convex regions that tile the plane: road, crosswalks, pavements, kerb ramps.

Scene frame: the street runs along +x, its middle at y = 0, the road's top at z = 0 and the pavement's at
z = `KERB_HEIGHT`. Neighbours share corners exactly, so no gap can catch a wheel.
"""

import dataclasses
from typing import Literal

from ..datatypes import GroundRegion

KERB_HEIGHT = 0.15  # m, of the six hand-made streets
RAMP_LENGTH = 1.5  # m: 1:10, gentler than the 1:8 that a dropped kerb may have
RAMP_HALF_WIDTH = 1.0  # m
FLARE_LENGTH = 1.0  # m, length of the tapered kerb on each side of a ramp
CROSSWALK_HALF_WIDTH = RAMP_HALF_WIDTH + FLARE_LENGTH
LOT_DEPTH = 3.0  # m, depth of the ground under the houses; less than any house's, so that no path leads behind them
CROSS_ROAD_LENGTH = 10.5  # m that a cross road continues beyond the house fronts
COURT_DEPTH = 4.0  # m of pavement across the end of a closed street
CROSS_ROAD_WIDTH = 6.0  # m, width of the road that a street meets at a junction
FAR_PAVEMENT_WIDTH = 2.5  # m, pavement on the other side of that road

Plane = tuple[float, float, float]
Corner = tuple[float, float]
End = Literal["court", "junction"]

ROAD_PLANE: Plane = (0.0, 0.0, 0.0)
PAVEMENT_PLANE: Plane = (0.0, 0.0, KERB_HEIGHT)


@dataclasses.dataclass(frozen=True)
class StreetSection:
    """Cross-section and length of a street.

    Attributes:
      length: m, from x = 0 to x = length, without the ground at the closed ends.
      carriageway: m, width of the road between the kerbs.
      left, right: m, widths of the pavements at y > 0 and y < 0.
      crosswalks: x of the crosswalks' middles, ascending.
      start, end: kind of the ends at x = 0 and x = length: a paved court closed by houses, or a cross road.
      left_park, right_park: m of open ground between a pavement and the house fronts.
      yards: whether the strip that the house fronts stand on is open ground (front yards) or paved.
    """

    length: float
    carriageway: float
    left: float
    right: float
    crosswalks: tuple[float, ...]
    start: End = "court"
    end: End = "court"
    left_park: float = 0.0
    right_park: float = 0.0
    yards: bool = False

    @property
    def half(self) -> float:
        return self.carriageway / 2.0

    @property
    def lot_kind(self) -> str:
        return "ground" if self.yards else "sidewalk"

    def width(self, side: int) -> float:
        """Returns the pavement width (m) on side +1 (left, y > 0) or -1 (right)."""
        return self.left if side > 0 else self.right

    def front(self, side: int) -> float:
        """Returns the distance (m) from y = 0 to the house fronts of a side."""
        return self.half + self.width(side) + (self.left_park if side > 0 else self.right_park)

    def span(self) -> tuple[float, float]:
        """Returns the range of x in which house fronts line the sides."""
        return (
            -COURT_DEPTH if self.start == "court" else 0.0,
            self.length + (COURT_DEPTH if self.end == "court" else 0.0),
        )

    def closing_x(self, at_end: bool) -> float:
        """Returns x of the house fronts that close the view at one end."""
        depth = (
            COURT_DEPTH if (self.end if at_end else self.start) == "court" else CROSS_ROAD_WIDTH + FAR_PAVEMENT_WIDTH
        )
        return self.length + depth if at_end else -depth


def _region(name: str, kind: str, corners: list[Corner], plane: Plane) -> GroundRegion:
    ring = tuple((round(x, 3), round(y, 3)) for x, y in corners)
    return GroundRegion(name, kind, ring, tuple(round(p, 9) for p in plane))  # type: ignore[arg-type]


def _box(name: str, kind: str, x0: float, x1: float, y0: float, y1: float, plane: Plane) -> GroundRegion:
    y0, y1 = min(y0, y1), max(y0, y1)
    return _region(name, kind, [(x0, y0), (x1, y0), (x1, y1), (x0, y1)], plane)


def _road(section: StreetSection) -> list[GroundRegion]:
    """Returns the road pieces between the crosswalks, and the crosswalks, all at z = 0."""
    half, regions, x = section.half, [], 0.0
    for i, middle in enumerate(section.crosswalks):
        a, b = middle - CROSSWALK_HALF_WIDTH, middle + CROSSWALK_HALF_WIDTH
        regions.append(_box(f"road_{i}", "road", x, a, -half, half, ROAD_PLANE))
        regions.append(_box(f"crosswalk_{i}", "crosswalk", a, b, -half, half, ROAD_PLANE))
        x = b
    regions.append(_box(f"road_{len(section.crosswalks)}", "road", x, section.length, -half, half, ROAD_PLANE))
    return regions


def _ramp(section: StreetSection, side: int, i: int, middle: float) -> list[GroundRegion]:
    """Returns a dropped kerb with its two flares and the flat pavement behind it.

    The flares rise along the kerb from the ramp's foot to the pavement; their planes meet the ramp's
    and the pavement's along whole edges, so only the kerb itself is a step.
    """
    kerb = side * section.half
    top, back = side * (section.half + RAMP_LENGTH), side * (section.half + section.width(side))
    a, b = middle - RAMP_HALF_WIDTH, middle + RAMP_HALF_WIDTH
    name = f"{'left' if side > 0 else 'right'}_ramp_{i}"
    rise = side * KERB_HEIGHT / RAMP_LENGTH
    slope = KERB_HEIGHT / FLARE_LENGTH
    c = -rise * kerb
    return [
        _box(name, "sidewalk", a, b, kerb, top, (0.0, rise, c)),
        _region(
            f"{name}_flare_a",
            "sidewalk",
            [(a - FLARE_LENGTH, kerb), (a, kerb), (a, top)],
            (-slope, rise, c + slope * a),
        ),
        _region(
            f"{name}_flare_b", "sidewalk", [(b, kerb), (b + FLARE_LENGTH, kerb), (b, top)], (slope, rise, c - slope * b)
        ),
        _box(f"{name}_top", "sidewalk", a, b, top, back, PAVEMENT_PLANE),
    ]


def _pavement(section: StreetSection, side: int) -> list[GroundRegion]:
    """Returns one side's pavement: pieces with cut corners between the ramps."""
    kerb = side * section.half
    top, back = side * (section.half + RAMP_LENGTH), side * (section.half + section.width(side))
    name = "left" if side > 0 else "right"
    regions: list[GroundRegion] = []
    opening: list[Corner] = [(0.0, back), (0.0, kerb)]
    for i, middle in enumerate((*section.crosswalks, None)):
        if middle is None:
            closing = [(section.length, kerb), (section.length, back)]
        else:
            a = middle - RAMP_HALF_WIDTH
            closing = [(a - FLARE_LENGTH, kerb), (a, top), (a, back)]
        regions.append(_region(f"{name}_pavement_{i}", "sidewalk", [*opening, *closing], PAVEMENT_PLANE))
        if middle is not None:
            regions += _ramp(section, side, i, middle)
            b = middle + RAMP_HALF_WIDTH
            opening = [(b, back), (b, top), (b + FLARE_LENGTH, kerb)]
    return regions


def _end(section: StreetSection, at_end: bool) -> list[GroundRegion]:
    """Returns the ground across one end: a court, or a cross road with its far pavement, and the lot of the houses
    behind."""
    kind = section.end if at_end else section.start
    name = "end" if at_end else "start"
    right, left = -section.front(-1), section.front(1)
    edge, sign = (section.length, 1.0) if at_end else (0.0, -1.0)

    def strip(part: str, ground: str, near: float, far: float, y0: float, y1: float, plane: Plane) -> GroundRegion:
        x0, x1 = sorted((edge + sign * near, edge + sign * far))
        return _box(f"{name}_{part}", ground, x0, x1, y0, y1, plane)

    if kind == "court":
        return [
            strip("court", "sidewalk", 0.0, COURT_DEPTH, right, left, PAVEMENT_PLANE),
            strip("lot", section.lot_kind, COURT_DEPTH, COURT_DEPTH + LOT_DEPTH, right, left, PAVEMENT_PLANE),
        ]
    right, left = right - CROSS_ROAD_LENGTH, left + CROSS_ROAD_LENGTH
    far = CROSS_ROAD_WIDTH + FAR_PAVEMENT_WIDTH
    return [
        strip("right_corner", section.lot_kind, 0.0, far, right - LOT_DEPTH, right, PAVEMENT_PLANE),
        strip("left_corner", section.lot_kind, 0.0, far, left, left + LOT_DEPTH, PAVEMENT_PLANE),
        strip("cross_road", "road", 0.0, CROSS_ROAD_WIDTH, right, left, ROAD_PLANE),
        strip("far_pavement", "sidewalk", CROSS_ROAD_WIDTH, far, right, left, PAVEMENT_PLANE),
        strip("lot", section.lot_kind, far, far + LOT_DEPTH, right, left, PAVEMENT_PLANE),
    ]


def ground_regions(section: StreetSection) -> list[GroundRegion]:
    """Returns all regions of a street; those that are not paint tile one connected area without overlap."""
    regions = _road(section) + _pavement(section, 1) + _pavement(section, -1)
    regions += _end(section, False) + _end(section, True)
    x0, x1 = section.span()
    for side, name, park in ((1, "left", section.left_park), (-1, "right", section.right_park)):
        back, front = side * (section.half + section.width(side)), side * section.front(side)
        if park > 0.0:
            regions.append(_box(f"{name}_park", "ground", 0.0, section.length, back, front, PAVEMENT_PLANE))
        lot = front + side * LOT_DEPTH
        regions.append(_box(f"{name}_lot", section.lot_kind, x0, x1, front, lot, PAVEMENT_PLANE))
    return regions


def dashes(name: str, x0: float, x1: float, y: float, dash: float = 3.0, gap: float = 4.5) -> list[GroundRegion]:
    """Returns a dashed white line along x, 12 cm wide."""
    regions, x = [], x0
    while x + dash <= x1 + 1e-9:
        regions.append(_box(f"{name}_{len(regions)}", "road_marking", x, x + dash, y - 0.06, y + 0.06, ROAD_PLANE))
        x += dash + gap
    return regions


def line(name: str, x0: float, x1: float, y0: float, y1: float) -> GroundRegion:
    """Returns a painted rectangle on the road, for stop lines, edge lines and bay lines."""
    return _box(name, "road_marking", x0, x1, y0, y1, ROAD_PLANE)
