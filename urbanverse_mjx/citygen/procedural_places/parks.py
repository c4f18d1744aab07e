"""Templates: park and parking lot."""

import itertools
import math
import random

import shapely
from shapely.geometry.base import BaseGeometry

from ..canvas.ground_layers import rectangle, strip
from . import groups, stock
from .outlines import Corner, corners, inside, ring
from .site import Site

#: m, depth of a parking bay, and of two rows of bays with a walkway between them.
BAY_DEPTH, DOUBLE_BAY_DEPTH = 5.2, 12.4


def park(scene_id: str, rng: random.Random) -> Site:
    """Builds lawns with a ring path and straight, diagonal and curved paths across, with hedges, fences with gaps, and
    play equipment."""
    site = Site(scene_id, rng)
    long, wide = rng.uniform(48.0, 72.0), rng.uniform(36.0, 54.0)
    outline = shapely.box(0.0, 0.0, round(long, 1), round(wide, 1))
    site.enclose(outline, 0.0)
    site.canvas.ground("lawn", "ground", rectangle(*outline.bounds))
    margin, ring_wide = rng.uniform(3.0, 7.0), rng.uniform(2.0, 3.0)
    x0, y0, x1, y1 = margin, margin, outline.bounds[2] - margin, outline.bounds[3] - margin
    bends = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    paths: list[tuple[list[Corner], float]] = []
    for a, b in itertools.pairwise([*bends, bends[0]]):
        paths.append(([a, b], ring_wide))
    middle = (rng.uniform(0.4, 0.6) * (x0 + x1), rng.uniform(0.4, 0.6) * (y0 + y1))
    for goal in rng.sample(bends, rng.randint(1, 3)):  # diagonals
        paths.append(([goal, middle], rng.uniform(2.0, 3.0)))
    paths.append(([(rng.uniform(x0 + 6, x1 - 6), y0), middle], rng.uniform(2.0, 2.6)))
    paths.append((_bow((x0, rng.uniform(y0 + 6, y1 - 6)), middle, rng.uniform(-0.4, 0.4)), rng.uniform(2.0, 2.8)))
    paths.append((_bow(middle, (x1, rng.uniform(y0 + 6, y1 - 6)), rng.uniform(-0.4, 0.4)), rng.uniform(2.0, 2.8)))
    square = rng.uniform(5.0, 9.0)
    for k, (points, width) in enumerate(paths):
        ends = (points[0], points[-1])
        far = [_beyond(points[1], ends[0], width / 2), *points[1:-1], _beyond(points[-2], ends[1], width / 2)]
        site.canvas.ground(f"path_{k}", "sidewalk", strip(far, width))
    plaza = shapely.Point(middle).buffer(round(square / 2, 2), cap_style="square")
    site.canvas.ground("middle", "sidewalk", rectangle(*plaza.bounds))
    site.canvas.wear("ground", rng.choice(("grass", "grass", "grass_dry")))
    site.canvas.wear(middle, "sidewalk/" + rng.choice(("hoggin-leaves", "asphalt_fine", "resin_bound", "flags_mixed")))
    for points, width in paths:
        site.lane(points, reach=max(0.0, width / 2 - 0.65))
    _park_objects(site, outline, paths, plaza)
    return site


def _park_objects(
    site: Site, outline: shapely.Polygon, paths: list[tuple[list[Corner], float]], plaza: shapely.Polygon
) -> None:
    rng, zone = site.rng, inside(outline, 0.1)
    site.houses()
    pave = shapely.union_all([shapely.LineString(p).buffer(w / 2) for p, w in paths])
    lawn = zone.difference(pave.buffer(0.3)).difference(plaza)
    x, y = plaza.centroid.x, plaza.centroid.y
    off = site.uniform(0.8, 1.4) * rng.choice((-1, 1))
    site.put(
        rng.choice(("fountain", "sculpture", "obelisk", "water well", "street clock")), x + off, y + 1.6, 0.0, zone
    )
    for points, width in paths[4:] + paths[:4]:
        line = shapely.LineString(points)
        for side in (1, -1):
            edge = corners(line.offset_curve(side * (width / 2 + 0.15), join_style="mitre"))
            edge = edge if side > 0 else edge[::-1]
            kind = rng.choice(("hedge", "fence", "open", "benches", "benches"))
            if kind == "hedge":
                groups.hedge(site, [_beside(p, edge, 0.5) for p in edge], lawn, site.uniform(0.05, 0.35))
            elif kind == "fence" and len(edge) == 2:
                site.row("fence", edge[0], edge[1], 2.75, zone, skip=site.uniform(0.1, 0.3))
            elif kind == "benches":
                site.lean([*edge][::-1], ("bench", "bench", "trash bin", "lamppost", "flower"), (2.0, 7.0), zone, -0.7)
    for mix, per in (("sports", 0.6), ("lawn", 6.0), ("people", 1.8), ("animals", 0.9), ("clutter", 0.8)):
        site.scatter(lawn, mix, per)
    for _ in range(rng.randint(1, 4)):
        px, py = rng.uniform(zone.bounds[0], zone.bounds[2]), rng.uniform(zone.bounds[1], zone.bounds[3])
        groups.heap(site, px, py, lawn, stock.MIXES["people"], rng.randint(3, 7))
    site.scatter(zone.intersection(pave), "people", 2.5)
    site.scatter(plaza, "middle", 4.0)


def _beside(point: Corner, line: list[Corner], by: float) -> Corner:
    """Returns a point moved to the left of the straight line from a line's first to its last point."""
    (ax, ay), (bx, by_) = line[0], line[-1]
    length = math.dist(line[0], line[-1])
    return point[0] - (by_ - ay) / length * by, point[1] + (bx - ax) / length * by


def _bow(a: Corner, b: Corner, bulge: float) -> list[Corner]:
    """Returns a curve from a to b in five pieces; `bulge`: its height divided by its length."""
    points = []
    for k in range(6):
        t = k / 5
        h = bulge * 4 * t * (1 - t)
        points.append((round(a[0] + (b[0] - a[0]) * t - (b[1] - a[1]) * h, 2),
                       round(a[1] + (b[1] - a[1]) * t + (b[0] - a[0]) * h, 2)))  # fmt: skip
    return points


def _beyond(before: Corner, end: Corner, by: float) -> Corner:
    length = math.dist(before, end)
    return end[0] + (end[0] - before[0]) / length * by, end[1] + (end[1] - before[1]) / length * by


def parking(scene_id: str, rng: random.Random) -> Site:
    """Builds rows of cars with islands at their ends, trolleys, a walk along the shop front, and hedges or fences
    around them."""
    site = Site(scene_id, rng)
    aisle, pitch = rng.uniform(4.2, 6.5), rng.uniform(2.55, 2.9)
    blocks, cars = rng.randint(2, 3), rng.randint(9, 15)
    walk = rng.uniform(2.5, 4.5)
    long = round(cars * pitch + 2 * aisle + 2.0, 1)
    wide = round(walk + blocks * (DOUBLE_BAY_DEPTH + aisle) + aisle, 1)
    outline = shapely.box(0.0, 0.0, long, wide)
    site.enclose(outline, 0.0, rng.sample(stock.SHEDS, 5))
    site.canvas.ground("lot_floor", "sidewalk", ring(outline)[:-1])
    islands = _islands(site, long, walk, blocks, aisle)
    site.canvas.wear(
        (0.4, 0.4), "sidewalk/" + rng.choice(("asphalt_fine", "asphalt_grey-cracked", "asphalt_fine-puddled"))
    )
    site.houses()
    zone = inside(outline).difference(shapely.union_all([i.buffer(0.12, join_style="mitre") for i in islands]))
    across = [walk / 2, *(walk + aisle / 2 + k * (DOUBLE_BAY_DEPTH + aisle) for k in range(blocks + 1))]
    for y in across:
        site.lane([(aisle / 2, y), (long - aisle / 2, y)], reach=(aisle / 2 if y > walk else walk / 2) - 0.75)
    for x in (aisle / 2, long - aisle / 2):
        site.lane([(x, across[0]), *((x, y) for y in across[1:])], reach=0.8)
    for y0, y1 in itertools.pairwise(across[1:]):
        if rng.random() < 0.7:
            x = rng.uniform(aisle + 4, long - aisle - 4)
            site.lane([(x, y0), (x, y1)], reach=0.1)
    _cars(site, zone, long, aisle, pitch, blocks, walk)
    for island in islands:
        top = island.buffer(-0.05)
        for _ in range(rng.randint(1, 3)):
            x, y = rng.uniform(*top.bounds[::2]), rng.uniform(*top.bounds[1::2])
            site.put(
                rng.choice(("tree", "shrub", "lamppost", "flower", "rock", "bollard", "street light")), x, y, 0.0, top
            )
    walls = ring(outline)
    site.lean(walls[:2], "wall", (0.4, 3.0), zone)
    site.lean(walls[1:], ("bench", "shrub", "flower", "fence", "trash bin", "waste station", "lamppost", "guard rail",
                         "bicycle parking", "dumpster", "shrub", "stone block", "tree"), (0.2, 2.5), zone)  # fmt: skip
    for mix, per in (("lot", 2.2), ("people", 2.2), ("clutter", 0.8), ("dumped", 0.3), ("animals", 0.2)):
        site.scatter(zone, mix, per)
    return site


def _islands(site: Site, long: float, walk: float, blocks: int, aisle: float) -> list[shapely.Polygon]:
    """Adds kerbed islands at the ends of the rows."""
    found = []
    for k in range(blocks):
        y = walk + aisle + k * (DOUBLE_BAY_DEPTH + aisle) + DOUBLE_BAY_DEPTH / 2
        for name, x in (("a", aisle + 0.2), ("b", long - aisle - 1.4)):
            if site.rng.random() < 0.75:
                half = site.uniform(2.0, DOUBLE_BAY_DEPTH / 2 - 1.0)
                shape = shapely.box(round(x, 2), round(y - half, 2), round(x + 1.2, 2), round(y + half, 2))
                site.canvas.ground(f"island_{k}{name}", "sidewalk", ring(shape)[:-1], 0.15)
                found.append(shape)
    return found


def _cars(site: Site, zone: BaseGeometry, long: float, aisle: float, pitch: float, blocks: int, walk: float) -> None:
    full = site.uniform(0.45, 0.95)
    for k in range(blocks):
        for half in (0, 1):
            y = walk + aisle + k * (DOUBLE_BAY_DEPTH + aisle) + BAY_DEPTH / 2 + half * (DOUBLE_BAY_DEPTH - BAY_DEPTH)
            x = aisle + 1.6 + pitch / 2
            while x < long - aisle - 1.6 - pitch / 2 + 0.01:
                if site.rng.random() < full:
                    label = site.rng.choice(stock.MIXES["cars"])
                    degrees = site.rng.choice((90.0, -90.0)) + site.uniform(-4.0, 4.0)
                    site.put(label, x + site.uniform(-0.12, 0.12), y + site.uniform(-0.3, 0.3), degrees, zone)
                x += pitch
