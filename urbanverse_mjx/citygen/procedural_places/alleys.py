"""Templates: narrow alley and pedestrian precinct."""

import itertools
import math
import random

import shapely
from shapely.geometry.base import BaseGeometry

from . import groups, stock
from .outlines import inside, joined, ring, winding
from .site import LANE, Site


def alley(scene_id: str, rng: random.Random) -> Site:
    """Builds an alley of 1.8 to 4 m between walls, with bends, a side branch, small courts, and tables and bins of
    restaurants."""
    site = Site(scene_id, rng)
    points = winding(rng, rng.randint(4, 6), 14.0, 24.0, 75.0)
    base = rng.uniform(2.0, 3.8)
    widths = [min(4.0, max(1.8, base * rng.uniform(0.8, 1.25))) for _ in points[1:]]
    legs = list(itertools.pairwise(points))
    shapes = [
        shapely.LineString(leg).buffer(w / 2, cap_style="square", join_style="mitre")
        for leg, w in zip(legs, widths, strict=True)
    ]
    lanes = [([a, b], w) for (a, b), w in zip(legs, widths, strict=True)]
    spots = [(points[0], rng.uniform(4.0, 7.0)), (points[-1], rng.uniform(4.0, 7.0))]
    spots += [(p, rng.uniform(4.0, 7.0)) for p in rng.sample(points[1:-1], 1)]
    leg = rng.randrange(1, len(legs) - 1)
    (ax, ay), (bx, by) = legs[leg]
    t, side = rng.uniform(0.35, 0.65), rng.choice((1, -1))
    degrees = math.degrees(math.atan2(by - ay, bx - ax)) + side * rng.uniform(70.0, 110.0)
    start = (ax + (bx - ax) * t, ay + (by - ay) * t)
    end = groups.at(*start, degrees, rng.uniform(12.0, 18.0), 0.0)
    width = rng.uniform(1.9, 3.2)
    shapes.append(shapely.LineString([start, end]).buffer(width / 2, cap_style="flat"))
    lanes.append(([start, end], width))
    spots.append((end, rng.uniform(4.5, 7.5)))
    for (x, y), s in spots:
        turned = shapely.affinity.rotate(shapely.box(x - s / 2, y - s / 2, x + s / 2, y + s / 2), rng.uniform(-45, 45))
        shapes.append(turned)
    outline = joined([joined(shapes).simplify(0.02)])
    site.enclose(outline, 0.0, walls=rng.uniform(0.2, 0.7))
    site.canvas.ground("alley", "sidewalk", ring(outline)[:-1])
    site.canvas.wear(points[1], "sidewalk/" + rng.choice(stock.SIDEWALKS))
    site.houses()
    for path, w in lanes:
        site.lane(path, reach=max(0.0, w / 2 - LANE / 2 - 0.04))
    zone = inside(outline)
    for (x, y), s in spots:
        for _ in range(rng.randint(1, 3)):
            groups.table(site, x + rng.uniform(-s, s) / 2, y + rng.uniform(-s, s) / 2, zone)
    walls = ring(outline)
    for a, b in itertools.pairwise(walls):
        length = math.dist(a, b)
        if length > 6.0 and rng.random() < 0.4:
            s = rng.uniform(0.3, length - 5.5)
            heading = math.degrees(math.atan2(b[1] - a[1], b[0] - a[0]))
            groups.cafe(site, groups.at(*a, heading, s, 0.0), groups.at(*a, heading, s + 5.0, 0.0), 2.2, zone)
        if length > 5.0 and rng.random() < 0.4:
            s = rng.uniform(0.5, length - 4.0)
            heading = math.degrees(math.atan2(b[1] - a[1], b[0] - a[0]))
            groups.bicycles(site, *groups.at(*a, heading, s, 0.35), heading, 3, zone)
    site.lean(walls, "wall", (0.3, 2.2), zone)
    for mix, per in (("dumped", 5.0), ("clutter", 5.0), ("goods", 5.0), ("people", 6.0), ("animals", 1.5)):
        site.scatter(zone, mix, per)
    return site


def precinct(scene_id: str, rng: random.Random) -> Site:
    """Builds a car-free street, 8 to 14 m wide, with a bend: terraces before the fronts, trees, kiosks and planters in
    its middle, bollards across it."""
    site = Site(scene_id, rng)
    wide = rng.uniform(8.0, 14.0)
    points = winding(rng, rng.randint(2, 3), 26.0, 40.0, 45.0)
    band = shapely.LineString(points).buffer(wide / 2, cap_style="flat", join_style="mitre")
    shapes = [band]
    (ax, ay), (bx, by) = points[0], points[1]
    t = rng.uniform(0.35, 0.65)
    start = (ax + (bx - ax) * t, ay + (by - ay) * t)
    degrees = math.degrees(math.atan2(by - ay, bx - ax)) + rng.choice((90.0, -90.0))
    end = groups.at(*start, degrees, wide / 2 + rng.uniform(10.0, 18.0), 0.0)
    narrow = rng.uniform(2.5, 6.0)
    shapes.append(shapely.LineString([start, end]).buffer(narrow / 2, cap_style="flat"))
    outline = joined(shapes)
    site.enclose(outline, 0.0)
    site.canvas.ground("precinct", "sidewalk", ring(outline)[:-1])
    site.canvas.wear(start, "sidewalk/" + rng.choice(stock.SIDEWALKS))
    site.houses()
    zone, line = inside(outline), shapely.LineString(points)
    inner = shapely.LineString([line.interpolate(1.2), *(shapely.Point(p) for p in points[1:-1]),
                                line.interpolate(line.length - 1.2)])  # fmt: skip
    off = wide / 4 + rng.uniform(-0.6, 0.6)
    sides = [[(x, y) for x, y in inner.offset_curve(s * off, join_style="mitre").coords] for s in (1, -1)]
    for path in sides:
        site.lane(path, reach=min(1.0, wide / 4 - 0.9))
    for share in (0.0, *(k / 5 + rng.uniform(-0.05, 0.05) for k in range(1, 5)), 1.0):
        a, b = (shapely.LineString(path).interpolate(share, normalized=True) for path in sides)
        site.lane([(a.x, a.y), (b.x, b.y)])
    near = min((shapely.LineString(p).interpolate(shapely.LineString(p).project(shapely.Point(start))) for p in sides),
               key=lambda p: math.dist((p.x, p.y), end))  # fmt: skip
    site.lane([(near.x, near.y), groups.at(*end, degrees, -1.0, 0.0)], reach=max(0.0, narrow / 2 - 0.7))
    _precinct_objects(site, outline, zone, line, wide)
    return site


def _precinct_objects(
    site: Site, outline: shapely.Polygon, zone: BaseGeometry, line: shapely.LineString, wide: float
) -> None:
    rng = site.rng
    walls = ring(outline)
    for a, b in itertools.pairwise(walls):
        length, s = math.dist(a, b), rng.uniform(1.0, 4.0)
        heading = math.degrees(math.atan2(b[1] - a[1], b[0] - a[0]))
        while length > 10.0 and s < length - 5.0:
            deep, stretch = rng.uniform(1.4, min(4.6, wide / 2 - 0.8)), rng.uniform(4.0, 9.0)
            if rng.random() < 0.3 + 0.5 * site.density:
                start = groups.at(*a, heading, s, 0.0)
                groups.cafe(site, start, groups.at(*a, heading, min(s + stretch, length), 0.0), deep, zone)
            s += stretch + rng.uniform(0.5, 4.0)
    s = 2.0
    while s < line.length - 2.0:  # objects in the middle
        p, q = line.interpolate(s), line.interpolate(s + 0.1)
        heading = math.degrees(math.atan2(q.y - p.y, q.x - p.x))
        label = rng.choice(stock.MIXES["middle"])
        place = groups.at(p.x, p.y, heading, 0.0, rng.uniform(-0.4, 0.4))
        site.put(label, *place, heading + rng.choice((0.0, 90.0, 180.0)) + rng.uniform(-10, 10), zone)
        s += rng.uniform(1.5, 5.0) / (0.4 + 0.6 * site.density)
    for share in rng.sample((0.03, 0.3, 0.5, 0.72, 0.97), rng.randint(1, 3)):
        p, q = (line.interpolate(share * line.length + d) for d in (0.0, 0.1))
        heading = math.degrees(math.atan2(q.y - p.y, q.x - p.x))
        a, b = (groups.at(p.x, p.y, heading, 0.0, side * (wide / 2 - 0.5)) for side in (1, -1))
        site.row(rng.choice(("bollard", "guard stone", "plant pot")), a, b, rng.uniform(1.4, 1.9), zone)
    for _ in range(rng.randint(1, 4)):
        p = line.interpolate(rng.uniform(3, line.length - 3))
        groups.bicycles(site, p.x + rng.uniform(-3, 3), p.y + rng.uniform(-3, 3), rng.uniform(-180, 180), 5, zone)
    site.lean(walls, "wall", (0.5, 4.0), zone)
    for mix, per in (("people", 7.0), ("clutter", 3.5), ("terrace", 2.5), ("kerb", 1.2), ("animals", 0.7)):
        site.scatter(zone, mix, per)
