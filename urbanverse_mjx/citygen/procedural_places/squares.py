"""Templates: courtyard or plaza, and market street."""

import itertools
import math
import random

import shapely
from shapely.geometry.base import BaseGeometry

from ..canvas.ground_layers import rectangle
from . import groups, stock
from .outlines import Corner, inside, joined, ring, steps
from .site import Site


def courtyard(scene_id: str, rng: random.Random) -> Site:
    """Builds a square enclosed by houses, with passages out of it, planters in rows, benches, a central object, and
    sometimes a raised floor with ramps."""
    site = Site(scene_id, rng)
    long, wide = round(rng.uniform(26.0, 42.0), 1), round(rng.uniform(22.0, 34.0), 1)
    parts = [shapely.box(0.0, 0.0, long, wide)]
    if rng.random() < 0.5:  # an L
        parts.append(shapely.box(long - 0.5, 0.0, long + round(rng.uniform(10, 18), 1), round(wide * 0.55, 1)))
    gates: list[tuple[Corner, Corner]] = []
    for side in rng.sample((0, 1, 2), 2):
        gate, across = round(rng.uniform(2.0, 3.6), 2), round(rng.uniform(9.0, 16.0), 1)
        at = round(rng.uniform(4.0, (wide if side == 0 else long) - 7.0), 2)
        box = {0: (-across, at, 0.1, at + gate), 1: (at, wide - 0.1, at + gate, wide + across),
               2: (at, -across, at + gate, 0.1)}[side]  # fmt: skip
        parts.append(shapely.box(*box))
        middle = at + gate / 2
        gates.append({0: ((-across + 1, middle), (1.5, middle)), 1: ((middle, wide + across - 1), (middle, wide - 1.5)),
                      2: ((middle, -across + 1), (middle, 1.5))}[side])  # fmt: skip
    outline = joined(parts)
    site.enclose(outline, 0.0)
    site.canvas.ground("court", "sidewalk", ring(outline)[:-1])
    zone = inside(outline)
    deck = None
    if rng.random() < 0.6:
        deck = _deck(site, long, wide)
        zone = zone.difference(shapely.box(*deck).buffer(0.15, join_style="mitre"))
    site.canvas.wear((0.5, 0.5), "sidewalk/" + rng.choice(stock.SIDEWALKS))
    site.houses()
    margin = rng.uniform(2.0, 4.0)
    bends = [(margin, margin), (long - margin, margin), (long - margin, wide - margin), (margin, wide - margin)]
    for a, b in itertools.pairwise([*bends, bends[0]]):
        site.lane([a, b], reach=min(1.2, margin - 1.0))
    for outer, inner in gates:
        near = min(bends, key=lambda c: math.dist(c, inner))
        site.lane([outer, inner, near], reach=0.25)
    if len(parts) > 3:
        x1 = parts[1].bounds[2]
        site.lane([bends[1], (x1 - 2.0, wide * 0.27)], reach=1.0)
    for _ in range(rng.randint(1, 3)):
        a, b = rng.sample(bends, 2)
        if deck is None:
            site.lane([a, (rng.uniform(5, long - 5), rng.uniform(5, wide - 5)), b], reach=1.0)
    if deck is None:
        label = rng.choice(("fountain", "sculpture", "obelisk", "tree", "water well", "christmas tree", "stage"))
        site.put(label, long / 2 + rng.uniform(-3, 3), wide / 2 + rng.uniform(-3, 3), rng.uniform(-180, 180), zone)
    _court_objects(site, outline, zone, long, wide)
    return site


def _deck(site: Site, long: float, wide: float) -> tuple[float, float, float, float]:
    """Adds a floor 0.15 to 0.4 m high in the middle with ramps of 1:10 on two sides; returns the whole occupied
    area."""
    high = round(site.uniform(0.15, 0.36), 2)
    run, half = round(high * 10.0, 2), round(site.uniform(0.8, 1.4), 2)
    x0, x1 = round(long / 2 - site.uniform(3.0, 4.5), 2), round(long / 2 + site.uniform(3.0, 4.5), 2)
    y0, y1 = round(wide / 2 - site.uniform(2.5, 4.0), 2), round(wide / 2 + site.uniform(2.5, 4.0), 2)
    site.canvas.ground("deck", "sidewalk", rectangle(x0, y0, x1, y1), high)
    y = round(site.uniform(y0 + half, y1 - half), 2)
    for name, foot, top in (("up", x0 - run, x0), ("down", x1 + run, x1)):
        ring = rectangle(min(foot, top), y - half, max(foot, top), y + half)
        site.canvas.slope(f"ramp_{name}", "sidewalk", ring, [(foot, y, 0.0), (top, y, high), (top, y + half, high)])
    site.keep(shapely.box(x0 - run - 1.3, y - half, x1 + run + 1.3, y + half))
    site.lane([(2.0, 2.0), (max(2.0, x0 - run - 1.0), y), (x0, y), (x1, y), (min(long - 2.0, x1 + run + 1.0), y)])
    site.lane([(min(long - 2.0, x1 + run + 1.0), y), (long - 2.0, wide - 2.0)])
    top_zone = shapely.box(x0 + 0.1, y0 + 0.1, x1 - 0.1, y1 - 0.1)
    site.scatter(top_zone, "middle", 8.0)
    site.scatter(top_zone, "people", 8.0)
    return x0 - run, y0, x1 + run, y1


def _court_objects(site: Site, outline: shapely.Polygon, zone: BaseGeometry, long: float, wide: float) -> None:
    rng = site.rng
    for _ in range(rng.randint(1, 4)):  # rows of planters and benches, along either axis or askew
        x, y, degrees = rng.uniform(4, long - 4), rng.uniform(4, wide - 4), rng.choice((0, 90, rng.uniform(-180, 180)))
        end = groups.at(x, y, degrees, rng.uniform(5.0, 12.0), 0.0)
        label = rng.choice(stock.MIXES["planters"])
        site.row(label, (x, y), end, rng.uniform(1.6, 3.0), zone, skip=0.1)
    for _ in range(rng.randint(0, 2)):
        x, y = rng.uniform(4, long - 4), rng.uniform(4, wide - 4)
        groups.hedge(site, [(x, y), (x + rng.uniform(4, 9), y), (x + 9, y + rng.uniform(3, 6))], zone, 0.2)
    walls = ring(outline)
    for a, b in itertools.pairwise(walls):
        length = math.dist(a, b)
        if length > 7.0 and rng.random() < 0.45:
            s = rng.uniform(0.5, length - 6.0)
            degrees = math.degrees(math.atan2(b[1] - a[1], b[0] - a[0]))
            start, end = groups.at(*a, degrees, s, 0.0), groups.at(*a, degrees, s + rng.uniform(4.0, 6.0), 0.0)
            groups.cafe(site, start, end, rng.uniform(1.5, 4.5), zone)
    site.lean(walls, "wall", (0.4, 3.5), zone)
    for _ in range(rng.randint(0, 3)):
        groups.bicycles(site, rng.uniform(2, long - 2), rng.uniform(2, wide - 2), rng.choice((0, 90, 45)), 5, zone)
    for mix, per in (("middle", 2.5), ("people", 4.0), ("clutter", 3.5), ("animals", 0.7), ("dumped", 1.5)):
        site.scatter(zone, mix, per)


def market(scene_id: str, rng: random.Random) -> Site:
    """Builds a street with two or three rows of stalls, aisles between them, shoppers and unloaded goods."""
    site = Site(scene_id, rng)
    rows = rng.choice((2, 2, 3))
    aisle = rng.uniform(2.0, 3.0)
    deep = 2.4
    wide = round(rows * deep + (rows + 1) * aisle, 2)
    long = round(rng.uniform(50.0, 74.0), 1)
    outline = shapely.box(0.0, 0.0, long, wide)
    if rng.random() < 0.6:  # a side street
        x = round(rng.uniform(long * 0.3, long * 0.6), 1)
        side = shapely.box(x, wide - 0.1, x + round(rng.uniform(3.0, 6.0), 1), wide + round(rng.uniform(9.0, 16.0), 1))
        outline = joined([outline, side])
    site.enclose(outline, 0.0)
    site.canvas.ground("street", "sidewalk", ring(outline)[:-1])
    site.canvas.wear((1.0, 1.0), "sidewalk/" + rng.choice(stock.SIDEWALKS))
    site.houses()
    zone = inside(outline)
    aisles = [aisle / 2 + k * (deep + aisle) for k in range(rows + 1)]
    for y in aisles:
        site.lane([(1.0, y), (long - 1.0, y)], reach=max(0.0, aisle / 2 - 0.68))
    gaps = [1.2, *(x for x in steps(rng, 9.0, 18.0, long - 6.0)), long - 1.2]
    for x in gaps:
        for k in range(rows):
            if x in (gaps[0], gaps[-1]) or rng.random() < 0.75:
                site.lane([(x, aisles[k]), (x + rng.uniform(-0.5, 0.5), aisles[k + 1])], reach=0.2)
    if outline.bounds[3] > wide:
        middle = side.centroid.x
        site.lane([(middle, outline.bounds[3] - 1.0), (middle, wide), (middle, aisles[-1])], reach=0.5)
    for k in range(rows):
        y, facing = aisle + deep / 2 + k * (deep + aisle), rng.choice((90.0, -90.0))
        x = rng.uniform(1.5, 4.0)
        while x < long - 2.0:
            groups.stall(site, x, y + rng.uniform(-0.2, 0.2), facing + rng.uniform(-6, 6), zone)
            x += rng.uniform(2.7, 4.2) / (0.6 + 0.4 * site.density)
    site.lean(ring(outline), "goods", (0.3, 2.5), zone)
    for mix, per in (("goods", 7.0), ("people", 11.0), ("clutter", 2.0), ("animals", 0.8)):
        site.scatter(zone, mix, per)
    return site
