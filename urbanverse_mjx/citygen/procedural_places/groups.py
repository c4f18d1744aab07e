"""Groups of objects: a table with chairs, a stall with its goods, bicycles at a rail, a heap, a queue, works."""

import itertools
import math
from collections.abc import Sequence

from shapely.geometry.base import BaseGeometry

from .. import catalogue
from . import stock
from .outlines import Corner
from .site import Site


def at(x: float, y: float, degrees: float, ahead: float, left: float) -> Corner:
    """Returns the point `ahead` and `left` (m) of a pose."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return x + ahead * c - left * s, y + ahead * s + left * c


def table(site: Site, x: float, y: float, zone: BaseGeometry | None) -> bool:
    """Places a table with up to four seats at varying distances, sometimes with a sunshade over it."""
    turn = site.uniform(-180.0, 180.0)
    size = site.size_of("table")
    if not site.put("table", x, y, turn, zone, size):
        return False
    seat = site.rng.choice(("chair", "chair", "chair", "stool", "armchair"))
    for k in range(site.rng.randint(1, 4)):
        bearing = turn + 90.0 * k
        away = (size[0] if k % 2 == 0 else size[1]) / 2 + site.uniform(0.38, 0.7)
        place = at(x, y, bearing, away, site.uniform(-0.1, 0.1))
        site.put(seat, *place, bearing + 180.0 + site.uniform(-25.0, 25.0), zone, gap=0.02)
    if site.uniform(0.0, 1.0) < 0.3:
        site.put("sunshade", *at(x, y, turn, 0.9, 0.9), turn, zone, gap=0.02)
    return True


def cafe(site: Site, a: Corner, b: Corner, deep: float, zone: BaseGeometry | None) -> None:
    """Places a terrace along a front from a to b, `deep` metres to its left: tables at random positions, a fence or
    pots at its ends."""
    length = math.dist(a, b)
    degrees = math.degrees(math.atan2(b[1] - a[1], b[0] - a[0]))
    s = 0.8
    while s < length - 0.6:
        for d in (0.75, 2.4, 4.0):
            if d + 0.6 < deep:
                table(site, *at(*a, degrees, s + site.uniform(-0.3, 0.3), d + site.uniform(-0.15, 0.3)), zone)
        s += site.uniform(1.8, 2.8)
    for end in (0.0, length):
        for d in (0.4, 1.3):
            label = site.rng.choice(("plant pot", "potted plant", "flower", "blackboard", "advertising board"))
            if d < deep:
                site.put(label, *at(*a, degrees, end, d), degrees + 90.0 + site.uniform(-20, 20), zone)


def stall(site: Site, x: float, y: float, degrees: float, zone: BaseGeometry | None) -> bool:
    """Places a stall, its keeper, and goods around it."""
    label = site.rng.choice(("street food stall", "street food stall", "canopy", "table", "table", "counter"))
    size = site.size_of(label)
    if not site.put(label, x, y, degrees, zone, size):
        return False
    for _ in range(site.rng.randint(1, 5)):
        ahead, left = site.uniform(-0.5, 0.5) * (size[0] + 1.4), site.uniform(-0.5, 0.5) * (size[1] + 1.4)
        goods = site.rng.choice(("storage box", "parcels", "barrel or bucket", "pumpkin", "parcels", "handcart",
                                 "stool", "flower", "blackboard", "garbage bag", "suitcase", "vase"))  # fmt: skip
        site.put(goods, *at(x, y, degrees, ahead, left), degrees + site.uniform(-40, 40), zone)
    behind = at(x, y, degrees, -size[0] / 2 - 0.5, site.uniform(-0.6, 0.6))
    site.put("pedestrian adult", *behind, degrees + site.uniform(-30, 30), zone)
    return True


def bicycles(site: Site, x: float, y: float, degrees: float, count: int, zone: BaseGeometry | None) -> None:
    """Places two-wheelers side by side, slightly rotated; occasionally one has fallen over."""
    label = site.rng.choice(("bicycle", "bicycle", "scooter", "motorcycle", "dirt bike"))
    for k in range(count):
        size = site.size_of(label)
        place = at(x, y, degrees, site.uniform(-0.15, 0.15), k * (size[1] + site.uniform(0.1, 0.35)))
        site.put(label, *place, degrees + site.uniform(-12, 12) + 180.0 * site.rng.randint(0, 1), zone, size, 0.03)


def heap(site: Site, x: float, y: float, zone: BaseGeometry | None, mix: Sequence[str], count: int) -> None:
    """Places objects of a mix within about a metre of a point."""
    for _ in range(count):
        away, bearing = site.uniform(0.0, 1.3), site.uniform(-180.0, 180.0)
        site.put(site.rng.choice(mix), *at(x, y, bearing, away, 0.0), site.uniform(-180.0, 180.0), zone, gap=0.02)


def queue(site: Site, x: float, y: float, degrees: float, count: int, zone: BaseGeometry | None) -> None:
    """Places people in a queue with a bend."""
    who = ("pedestrian adult", "pedestrian adult", "elderly person", "pedestrian child", "stroller", "suitcase")
    turn = degrees
    for _ in range(count):
        site.put(site.rng.choice(who), x, y, turn + 180.0 + site.uniform(-35, 35), zone)
        turn += site.uniform(-14.0, 14.0)
        x, y = at(x, y, turn, site.uniform(0.8, 1.15), 0.0)


def hedge(site: Site, points: Sequence[Corner], zone: BaseGeometry | None, skip: float) -> None:
    """Places a clipped hedge along a line with some pieces missing."""
    across = catalogue.HEDGE[1]
    for a, b in itertools.pairwise(points):
        length = math.dist(a, b)
        degrees = math.degrees(math.atan2(b[1] - a[1], b[0] - a[0]))
        s = across / 2
        while s < length - across / 2 + 0.1:
            if site.uniform(0.0, 1.0) >= skip:
                site.put("shrub", *at(*a, degrees, s, 0.0), degrees + 90.0, zone, catalogue.HEDGE, 0.0)
            s += across + 0.03


def works(site: Site, x0: float, x1: float, y0: float, y1: float, zone: BaseGeometry | None) -> None:
    """Places a closed-off area: barriers around a box (m), machines and material inside."""
    label = site.rng.choice(("traffic barricade", "fence", "jersey barrier", "guard rail", "traffic cone"))
    wide = site.size_of(label)[1] + (0.12 if label != "traffic cone" else 1.0)
    for a, b in (((x0, y0), (x1, y0)), ((x1, y1), (x0, y1)), ((x0, y1), (x0, y0)), ((x1, y0), (x1, y1))):
        if math.dist(a, b) >= wide:
            site.row(label, *_inset(a, b, wide / 2), wide, zone)
    for _ in range(site.rng.randint(1, 2)):
        machine = site.rng.choice(("excavator", "road roller", "forklift", "dumpster", "barrow", "container"))
        size = min(site.canvas.sizes[machine], key=lambda box: box[0])
        site.put(machine, site.uniform(x0, x1), (y0 + y1) / 2, 180.0 * site.rng.randint(0, 1), zone, size)
    for _ in range(round(abs((x1 - x0) * (y1 - y0)) * site.uniform(0.3, 0.7))):
        place = site.uniform(x0, x1), site.uniform(min(y0, y1), max(y0, y1))
        site.put(site.rng.choice(stock.MIXES["works"]), *place, site.uniform(-180, 180), zone)


def _inset(a: Corner, b: Corner, by: float) -> tuple[Corner, Corner]:
    length = math.dist(a, b)
    u, w = (b[0] - a[0]) / length * by, (b[1] - a[1]) / length * by
    return (a[0] + u, a[1] + w), (b[0] - u, b[1] - w)
