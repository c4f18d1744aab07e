"""Straight street with a carriageway: its ground, lanes, traffic, and the objects along it."""

import dataclasses
import math
from collections.abc import Sequence

import shapely

from ..canvas.ground_layers import rectangle
from ..section import RAMP_LENGTH
from . import stock
from .outlines import joined, ring
from .site import LANE, Site

END_PAVEMENT_DEPTH = 4.0  # m of pavement across the closed end of a street


@dataclasses.dataclass(frozen=True)
class Street:
    """A straight street along +x from 0 to `length`, everything in metres.

    Attributes:
      half: half the width of the carriageway. left, right: ground between kerb and fronts at +y and -y. kerb: height.
      crossings: x of the crosswalks. yards: depth of the front yards on the left and right, part of that ground.
    """

    length: float
    half: float
    left: float
    right: float
    kerb: float
    crossings: tuple[float, ...]
    yards: tuple[float, float] = (0.0, 0.0)

    @property
    def outline(self) -> shapely.Polygon:
        return shapely.box(
            -END_PAVEMENT_DEPTH, -self.half - self.right, self.length + END_PAVEMENT_DEPTH, self.half + self.left
        )

    def width(self, side: int) -> float:
        return self.left if side > 0 else self.right

    def path(self, side: int) -> float:
        """Returns the width of the pavement without front yards."""
        return self.width(side) - self.yards[0 if side > 0 else 1]

    def y(self, side: int, d: float) -> float:
        """Returns y at d metres behind the kerb of a side."""
        return side * (self.half + d)

    def walk(self, side: int) -> shapely.Polygon:
        """Returns the area of a pavement on which objects may stand."""
        a, b = self.y(side, 0.08), self.y(side, self.width(side) - 0.03)
        return shapely.box(-END_PAVEMENT_DEPTH + 0.05, min(a, b), self.length + END_PAVEMENT_DEPTH - 0.05, max(a, b))

    @property
    def road(self) -> shapely.Polygon:
        return shapely.box(0.2, -self.half + 0.1, self.length - 0.2, self.half - 0.1)


def lay(
    site: Site,
    street: Street,
    strips: Sequence[tuple[int, float, float, float]] = (),
    side_street: float = 0.0,
    labels: Sequence[str] = (),
) -> shapely.Polygon:
    """Lays the ground of a street: pavements and paved ends, road, crosswalks, walkable strips (side, from x, to x,
    width) beside the kerb, and dropped kerbs; returns the outline.

    Args:
      side_street: x of one that joins from the left, or 0. labels: labels of the houses; if empty, twelve random ones.
    """
    c, half, length = site.canvas, street.half, street.length
    outline = street.outline
    reach = 0.0
    if side_street:
        reach = round(site.uniform(16.0, 24.0), 1)
        edge = 3.0 + 2.4
        branch = shapely.box(side_street - edge, 0.0, side_street + edge, half + street.left + reach)
        outline = joined([outline, branch])
    site.enclose(outline, street.kerb, labels)
    c.ground("pavement", "sidewalk", ring(outline)[:-1], street.kerb)
    c.ground("road", "road", rectangle(0.0, -half, length, half), 0.0)
    if side_street:
        y1 = half + street.left + reach
        c.ground("side_road", "road", rectangle(side_street - 3.0, half, side_street + 3.0, y1 - 3.0), 0.0)
        y = half + street.left + 2.5
        c.ground("side_crossing", "crosswalk", rectangle(side_street - 3.0, y - 1.6, side_street + 3.0, y + 1.6), 0.0)
        for k, (x, degrees) in enumerate(((side_street - 3.0, 180.0), (side_street + 3.0, 0.0))):
            c.ramp(f"side_ramp_{k}", (x, y), degrees, half_width=0.9, run=1.2, flare=0.6, parted=False)
            site.keep(shapely.box(x - 1.9, y - 1.4, x + 1.9, y + 1.4))
        site.keep(shapely.box(side_street - 3.1, half, side_street + 3.1, y1 - 2.9))
    for k, x in enumerate(street.crossings):
        c.ground(f"crosswalk_{k}", "crosswalk", rectangle(x - 1.6, -half, x + 1.6, half), 0.0)
    for k, (side, a, b, wide) in enumerate(strips):
        y0, y1 = street.y(side, -wide), street.y(side, 0.0)
        c.ground(f"strip_{k}", "crosswalk", rectangle(a, min(y0, y1), b, max(y0, y1)), 0.0)
        for e, x in enumerate((a + 1.2, b - 1.2)):
            dropped(site, street, side, x, f"strip_ramp_{k}{e}")
    for k, x in enumerate(street.crossings):
        for side in (1, -1):
            dropped(site, street, side, x, f"ramp_{k}{'l' if side > 0 else 'r'}")
    return outline


def dropped(site: Site, street: Street, side: int, x: float, name: str) -> None:
    run = min(RAMP_LENGTH, max(0.5, round(street.kerb * 9.0, 2)), street.path(side) - 0.3)
    site.canvas.ramp(name, (x, street.y(side, 0.0)), 90.0 * side, half_width=1.0, run=run, flare=0.6)
    y0, y1 = street.y(side, 0.0), street.y(side, run + 0.1)
    site.keep(shapely.box(x - 1.7, min(y0, y1), x + 1.7, max(y0, y1)))


def walks(site: Site, street: Street, shut: Sequence[tuple[int, float, float]] = (), reach: float = 9.0) -> None:
    """Adds lanes along both pavements except closed stretches (side, from x, to x), over the crosswalks and around both
    ends."""
    length = street.length
    for side in (1, -1):
        wide = street.path(side)
        y = street.y(side, wide / 2)
        cuts = sorted((a, b) for s, a, b in shut if s == side)
        x = -END_PAVEMENT_DEPTH / 2
        for a, b in (*cuts, (length + END_PAVEMENT_DEPTH / 2, length + END_PAVEMENT_DEPTH / 2)):
            if a - x > 1.0:
                site.lane([(x, y), (a, y)], reach=min(reach, max(0.0, wide / 2 - LANE / 2 - 0.04)))
            x = b
    for x in (-END_PAVEMENT_DEPTH / 2, length + END_PAVEMENT_DEPTH / 2):
        site.lane([(x, street.y(1, street.path(1) / 2)), (x, street.y(-1, street.path(-1) / 2))], reach=0.6)
    for x in street.crossings:
        site.lane([(x, street.y(1, street.path(1) / 2)), (x, street.y(-1, street.path(-1) / 2))], width=2.0)


def side_walks(site: Site, street: Street, turn: float, top: float) -> None:
    """Adds lanes at a side street on the left: along its pavements and over its crosswalk."""
    y, back = street.y(1, street.path(1) / 2), top - 1.5
    over = street.half + street.left + 2.5
    walks(site, street, shut=[(1, turn - 4.2, turn + 4.2)], reach=0.4)
    for side in (-1, 1):
        x = turn + side * 4.2
        site.lane([(x, y), (x, over), (x, back)], reach=0.3)
    site.lane([(turn - 4.2, over), (turn + 4.2, over)], width=1.6)
    site.lane([(turn - 4.2, back), (turn + 4.2, back)], reach=0.3)
    for x0, x1 in ((turn - 5.35, turn - 3.1), (turn + 3.1, turn + 5.35)):
        zone = shapely.box(x0, street.half + street.left + 0.2, x1, top - 0.05)
        for mix, per in (("people", 5.0), ("clutter", 5.0), ("kerb", 4.0), ("wall", 5.0), ("dumped", 3.0)):
            site.scatter(zone, mix, per)


def traffic(site: Site, street: Street, share: float, parked: float, off: float = 0.35, apart: float = 3.2) -> None:
    """Adds cars at the kerbs (`off` metres from them) and on the road; crosswalks stay free for `apart` metres each
    way."""
    clear = shapely.union_all([shapely.box(x - apart, -street.half, x + apart, street.half) for x in street.crossings])
    zone = street.road.difference(clear)
    for side in (1, -1):
        x = site.uniform(1.0, 6.0)
        while x < street.length - 3.0:
            mix = "long" if site.rng.random() < 0.06 else "cars"
            label = site.rng.choice(stock.MIXES[mix])
            size = site.size_of(label)
            if site.rng.random() < parked:
                turn = site.uniform(-2.0, 2.0)
                y = street.y(side, -off - size[1] / 2 - size[0] / 2 * math.sin(math.radians(abs(turn))))
                site.put(label, x + size[0] / 2, y, (180.0 if side > 0 else 0.0) + turn, zone, size)
            elif site.rng.random() < share:
                y = street.y(side, -street.half + size[1] / 2 + 0.4)
                site.put(label, x + size[0] / 2, y, (180.0 if side > 0 else 0.0) + site.uniform(-2, 2), zone, size)
            x += size[0] + site.uniform(0.6, 6.0)


def furnish(site: Site, street: Street, side: int, kerb: float, wall: float, strewn: float) -> None:
    """Adds objects along the kerb and the fronts of a pavement and scattered on it; `kerb`, `wall`: gaps (m) at full
    density."""
    zone = street.walk(side)
    ends = (0.5, street.length - 0.5)
    a, b = ends if side > 0 else ends[::-1]
    y = street.y(side, 0.1)
    site.lean([(a, y), (b, y)], "kerb", (kerb, 3.0 * kerb), zone, 0.12)
    far = street.y(side, street.width(side))
    site.lean([(b, far), (a, far)], "wall", (wall, 3.0 * wall), zone)
    for mix, per in (("people", 4.0), ("clutter", 4.0), ("terrace", 1.0), ("dumped", 1.0), ("animals", 0.6)):
        site.scatter(zone, mix, per * strewn)
