"""Ground of a block: strips along the street's middle line, cut at bends, crosswalks and side streets.

The road is at z = 0. Across the street, from the middle, come road, pavement (whose first part may be a green verge),
yard, and the lot under the houses. At both ends a cross road with its far pavement closes the block. Corners are not
rounded, so that strips with different cuts share their edges exactly.
"""

import dataclasses
import itertools

from ...datatypes import GroundRegion
from .. import section
from .line import Piece, Point, StreetLine
from .profile import CityProfile

LOT = section.LOT_DEPTH
CROSSWALK_HALF = section.CROSSWALK_HALF_WIDTH
#: m: run of the ramp down to a side street, depth of a side street behind the fronts, width of cross roads.
END_RAMP, SIDE_DEPTH, CROSS_ROAD, FAR_PAVEMENT, ARM = 1.6, 9.0, 7.0, 3.0, 9.0
#: m, width of a parking lane.
BAY = 2.1


@dataclasses.dataclass(frozen=True)
class SideStreet:
    """A side street (+1 left, -1 right) between two s; the pavement crosses its mouth at road level."""

    side: int
    begin: float
    end: float


@dataclasses.dataclass(frozen=True)
class Plan:
    """Plan of a block: its line and profile, the middles of its crosswalks, and its side streets."""

    line: StreetLine
    profile: CityProfile
    crosswalks: tuple[float, ...]
    side_streets: tuple[SideStreet, ...]

    @property
    def half(self) -> float:
        return self.profile.road / 2

    def width(self, side: int) -> float:
        return self.profile.left if side > 0 else self.profile.right

    def walked(self, side: int) -> bool:
        """Returns whether a side's pavement is wide enough to walk on."""
        return self.width(side) >= max(1.0, self.profile.lane)

    def verge(self, side: int) -> float:
        """Returns the width (m) of the green verge along the kerb of a side."""
        spare = self.width(side) - self.profile.lane - 0.5
        return max(0.0, min(self.profile.verge, spare)) if self.walked(side) else 0.0

    def front(self, side: int) -> float:
        """Returns the distance (m) from the middle line to the house fronts."""
        return self.half + self.width(side) + self.profile.yard

    def mouths(self, side: int) -> list[SideStreet]:
        return [m for m in self.side_streets if m.side == side]


class _Strips:
    """Collects regions given in street coordinates."""

    def __init__(self, plan: Plan) -> None:
        self.plan, self.line = plan, plan.line
        self.regions: list[GroundRegion] = []

    def add(self, kind: str, corners: list[Point], plane: tuple[float, float, float], name: str | None = None) -> None:
        number = len(self.regions)
        self.regions.append(GroundRegion(f"{name or kind}_{number:03d}", kind, tuple(corners), plane))

    def quad(self, kind: str, piece: Piece, s: tuple[float, float], t: tuple[float, float], level: float) -> None:
        """Adds a flat piece of a strip."""
        self.tilted(kind, piece, [(s[0], t[0]), (s[1], t[0]), (s[1], t[1]), (s[0], t[1])], 0.0, 0.0, level)

    def tilted(
        self, kind: str, piece: Piece, corners: list[tuple[float, float]], along: float, across: float, level: float
    ) -> None:
        """Adds a piece whose top rises by `along` per m of s and `across` per m of t, from `level` at the piece's
        origin."""
        points = [self.line.corner(piece, s, t) for s, t in corners]
        self.add(kind, points, piece.plane(along, across, level))

    def strip(self, kind: str, t0: float, t1: float, level: float, cuts: list[float]) -> None:
        """Adds a flat strip over the whole length, cut at `cuts` and at bends, without the parts between pairs of
        cuts."""
        for piece, s0, s1 in self.spans(0.0, self.line.length, cuts):
            self.quad(kind, piece, (s0, s1), (t0, t1), level)

    def spans(self, begin: float, end: float, cuts: list[float]) -> list[tuple[Piece, float, float]]:
        """Returns the pieces of [begin, end] between cuts and bends."""
        inner = [c for c in (*cuts, *self.line.joints) if begin < c < end]
        stops = sorted({begin, end, *inner})
        return [(self.line.piece_at((a + b) / 2), a, b) for a, b in itertools.pairwise(stops)]


def ground(plan: Plan) -> list[GroundRegion]:
    """Returns all regions of a block; they touch and do not overlap."""
    strips = _Strips(plan)
    _road(strips)
    for side in (1, -1):
        _pavement(strips, side)
        _behind(strips, side)
    for at_end in (False, True):
        _close(strips, at_end)
    return strips.regions


def _road(strips: _Strips) -> None:
    half = strips.plan.half
    cuts = [c + d for c in strips.plan.crosswalks for d in (-CROSSWALK_HALF, CROSSWALK_HALF)]
    for piece, s0, s1 in strips.spans(0.0, strips.line.length, cuts):
        crossing = any(s0 < c < s1 for c in strips.plan.crosswalks)
        strips.quad("crosswalk" if crossing else "road", piece, (s0, s1), (-half, half), 0.0)


def _pavement(strips: _Strips, side: int) -> None:
    """Adds the pavement pieces, the dropped kerbs at crosswalks and the ramps down to the mouths of side streets."""
    plan = strips.plan
    high, half, width = plan.profile.kerb, plan.half, plan.width(side)
    back = side * (half + width)
    stops: list[tuple[float, float, str]] = [(c - CROSSWALK_HALF, c + CROSSWALK_HALF, "drop") for c in plan.crosswalks]
    stops += [(m.begin - END_RAMP, m.end + END_RAMP, "mouth") for m in plan.mouths(side)]
    if not plan.walked(side):
        stops = [stop for stop in stops if stop[2] == "mouth"]
    at = 0.0
    for begin, end, what in [*sorted(stops), (strips.line.length, strips.line.length, "")]:
        for piece, s0, s1 in strips.spans(at, begin, []):
            _flat(strips, side, piece, s0, s1)
        at = end
        if what == "drop":
            _dropped(strips, side, (begin + end) / 2)
        elif what == "mouth":
            piece, rise = strips.line.piece_at(begin), high / END_RAMP
            a, b = begin + END_RAMP, end - END_RAMP
            kerb, base = side * half, piece.begin
            down = [(begin, kerb), (a, kerb), (a, back), (begin, back)]
            up = [(b, kerb), (end, kerb), (end, back), (b, back)]
            strips.tilted("sidewalk", piece, down, -rise, 0.0, rise * (a - base))
            strips.quad("crosswalk", piece, (a, b), (kerb, back), 0.0)
            strips.tilted("sidewalk", piece, up, rise, 0.0, -rise * (b - base))


def _flat(strips: _Strips, side: int, piece: Piece, s0: float, s1: float) -> None:
    """Adds a level piece: the verge along the kerb, then the pavement."""
    plan = strips.plan
    kerb, back = side * plan.half, side * (plan.half + plan.width(side))
    inner = side * (plan.half + plan.verge(side))
    if plan.verge(side) > 0:
        strips.quad("ground", piece, (s0, s1), (kerb, inner), plan.profile.kerb)
    kind = "sidewalk" if plan.walked(side) else "ground"
    strips.quad(kind, piece, (s0, s1), (inner, back), plan.profile.kerb)


def _dropped(strips: _Strips, side: int, middle: float) -> None:
    """Adds a kerb ramp with flares, as in `section`, in a piece's own axes."""
    plan, piece = strips.plan, strips.line.piece_at(middle)
    high, half, width = plan.profile.kerb, plan.half, plan.width(side)
    run = min(section.RAMP_LENGTH, width - 0.2)
    kerb, top, back = side * half, side * (half + run), side * (half + width)
    a, b = middle - section.RAMP_HALF_WIDTH, middle + section.RAMP_HALF_WIDTH
    flare = section.FLARE_LENGTH
    rise, slope = side * high / run, high / flare
    level = -rise * kerb
    strips.tilted("sidewalk", piece, [(a, kerb), (b, kerb), (b, top), (a, top)], 0.0, rise, level)
    ramp_a, ramp_b = level + slope * (a - piece.begin), level - slope * (b - piece.begin)
    strips.tilted("sidewalk", piece, [(a - flare, kerb), (a, kerb), (a, top)], -slope, rise, ramp_a)
    strips.tilted("sidewalk", piece, [(b, kerb), (b + flare, kerb), (b, top)], slope, rise, ramp_b)
    # The level parts: the strip behind, and the two corners beside the flares.
    ring = [(a - flare, kerb), (a, top), (b, top), (b + flare, kerb), (b + flare, back), (a - flare, back)]
    strips.tilted("sidewalk", piece, ring, 0.0, 0.0, high)


def _behind(strips: _Strips, side: int) -> None:
    """Adds the yards and the ground under the houses, open at side streets, and the side streets' roads."""
    plan = strips.plan
    back, front = side * (plan.half + plan.width(side)), side * plan.front(side)
    lot = front + side * LOT
    at = 0.0
    for mouth in [*plan.mouths(side), None]:
        end = strips.line.length if mouth is None else mouth.begin
        for piece, s0, s1 in strips.spans(at, end, []):
            if plan.profile.yard > 0:
                strips.quad("ground", piece, (s0, s1), (back, front), plan.profile.kerb)
            strips.quad(
                "ground" if plan.profile.yard > 0 else "sidewalk", piece, (s0, s1), (front, lot), plan.profile.kerb
            )
        if mouth is not None:
            piece, at = strips.line.piece_at(mouth.begin), mouth.end
            strips.quad("road", piece, (mouth.begin, mouth.end), (back, front + side * SIDE_DEPTH), 0.0)


def _close(strips: _Strips, at_end: bool) -> None:
    """Adds a cross road over one end, with two arms, its far pavement and the lot of the houses beyond."""
    plan = strips.plan
    piece = strips.line.pieces[-1 if at_end else 0]
    edge, sign = (strips.line.length, 1.0) if at_end else (0.0, -1.0)
    right, left = -plan.front(-1) - ARM, plan.front(1) + ARM

    def box(kind: str, near: float, far: float, t0: float, t1: float, level: float) -> None:
        s0, s1 = sorted((edge + sign * near, edge + sign * far))
        strips.quad(kind, piece, (s0, s1), (t0, t1), level)

    far = CROSS_ROAD + FAR_PAVEMENT
    box("road", 0.0, CROSS_ROAD, right, left, 0.0)
    box("sidewalk", CROSS_ROAD, far, right, left, plan.profile.kerb)
    box("sidewalk", far, far + LOT, right, left, plan.profile.kerb)
