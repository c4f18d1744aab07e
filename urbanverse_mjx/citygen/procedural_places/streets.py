"""Templates of streets with cars: road works, narrow residential street, bus stops and a crossing."""

import random

import shapely

from ..canvas.ground_layers import rectangle
from . import groups, stock
from .section import Street, furnish, lay, side_walks, traffic, walks
from .site import Site


def works(scene_id: str, rng: random.Random) -> Site:
    """Builds a street whose pavements are closed in places by works, scaffolds, vans or scooters; the detour is a strip
    on the road or the other pavement."""
    site = Site(scene_id, rng)
    length, half = round(rng.uniform(84.0, 116.0), 1), round(rng.uniform(3.4, 4.6), 2)
    left, right, kerb = round(rng.uniform(2.0, 3.6), 2), round(rng.uniform(2.0, 3.6), 2), rng.choice((0.06, 0.1, 0.15))
    crossings = tuple(round(length * (k + rng.uniform(0.35, 0.65)) / 3, 1) for k in range(3))
    shut: list[tuple[int, float, float]] = []
    for side in (1, -1):
        x = rng.uniform(5.0, 12.0)
        while x < length - 14.0:
            end = x + rng.uniform(6.0, 13.0)
            if all(abs(c - p) > 4.5 and not x < c < end for c in crossings for p in (x, end)):
                shut.append((side, round(x, 1), round(end, 1)))
                x = end + rng.uniform(12.0, 20.0)
            x += 2.0
    strips = []
    for k, (side, a, b) in enumerate(shut):
        free = all(s * side > 0 or abs(a - c) > 0 for s, c, _, _ in strips)
        if free and (k % 2 == 0 or rng.random() < 0.5):
            strips.append((side, round(a - 2.6, 1), round(b + 2.6, 1), round(rng.uniform(1.5, 2.0), 2)))
    street = Street(length, half, left, right, kerb, crossings)
    lay(site, street, strips)
    site.houses()
    walks(site, street, shut)
    for side, a, b, wide in strips:
        y, back = street.y(side, -wide / 2), street.y(side, street.path(side) / 2)
        site.lane([(a + 1.2, back), (a + 1.2, y), (b - 1.2, y), (b - 1.2, back)], width=1.3)
        edge = street.y(side, -wide - 0.35)
        label = rng.choice(("jersey barrier", "traffic cone", "traffic barricade", "fence"))
        pitch = site.size_of(label)[1] + (1.2 if label == "traffic cone" else 0.15)
        site.row(label, (a + 0.5, edge), (b - 0.5, edge), pitch, street.road, skip=0.05)
    for side, a, b in shut:
        _shut(site, street, side, a, b)
    traffic(site, street, share=0.12, parked=0.25)
    for side in (1, -1):
        furnish(site, street, side, 1.5, 0.6, 1.8)
    return site


def _shut(site: Site, street: Street, side: int, a: float, b: float) -> None:
    """Places barriers that close a pavement from one x to another."""
    rng, zone, wide = site.rng, street.walk(side), street.width(side)
    y0, y1 = street.y(side, 0.12), street.y(side, wide - 0.12)
    kind = rng.choice(("works", "works", "vans", "scooters", "dumped", "scaffold"))
    if kind == "works":
        groups.works(site, a + 0.3, b - 0.3, y0 + side * 0.4, y1 - side * 0.5, zone)
    elif kind == "vans":
        x = a + 0.4
        while x < b - 4.0:
            label = rng.choice(("van", "van", "minivan", "hatchback car", "truck", "pickup truck"))
            size = site.size_of(label)
            site.put(
                label,
                x + size[0] / 2,
                street.y(side, wide / 2),
                rng.choice((0.0, 180.0)) + rng.uniform(-4, 4),
                zone,
                size,
            )
            x += size[0] + rng.uniform(0.4, 1.5)
        groups.heap(site, (a + b) / 2, street.y(side, wide / 2), zone, ("parcels", "storage box", "handcart"), 6)
    elif kind == "scooters":
        groups.bicycles(site, a + 0.5, street.y(side, wide * 0.4), 90.0, 4, zone)
        for _ in range(12):
            place = rng.uniform(a, b), rng.uniform(min(y0, y1), max(y0, y1))
            site.put(rng.choice(("scooter", "scooter", "bicycle")), *place, rng.uniform(-180, 180), zone)
        site.row("bicycle parking", (a + 1.0, (y0 + y1) / 2), (b - 1.0, (y0 + y1) / 2), 2.6, zone, 90.0)
    elif kind == "dumped":
        for k in range(3):
            x = a + (b - a) * (k + 0.5) / 3
            groups.heap(site, x, street.y(side, wide / 2), zone, stock.MIXES["dumped"], 9)
    else:  # poles of a scaffold, boards across its ends
        for x in (a + 0.2, b - 0.2):
            site.row("fence", (x, min(y0, y1) + 1.35), (x, max(y0, y1)), 2.75, zone)
        for d in (0.35, wide - 0.35):
            site.row("pole", (a + 0.6, street.y(side, d)), (b - 0.6, street.y(side, d)), 2.0, zone)
        groups.heap(site, (a + b) / 2, street.y(side, wide / 2), zone, stock.MIXES["works"], 8)


def residential(scene_id: str, rng: random.Random) -> Site:
    """Builds a narrow street with pavements down to 1.35 m: bins and bags before the doors, poles, cars half on the
    pavement, sometimes front gardens behind hedges on one side."""
    site = Site(scene_id, rng)
    length, half = round(rng.uniform(84.0, 120.0), 1), round(rng.uniform(2.3, 3.2), 2)
    left, right = rng.sample((round(rng.uniform(1.4, 1.9), 2), round(rng.uniform(1.8, 2.5), 2)), 2)
    yards = [round(rng.uniform(1.0, 3.0), 2) if rng.random() < 0.5 else 0.0 for _ in range(2)]
    kerb = rng.choice((0.06, 0.08, 0.12))
    crossings = tuple(round(length * (k + rng.uniform(0.3, 0.7)) / 2, 1) for k in range(2))
    street = Street(length, half, left + yards[0], right + yards[1], kerb, crossings, (yards[0], yards[1]))
    turn = round(rng.uniform(length * 0.42, length * 0.58), 1)
    far = all(abs(turn - x) > 9.0 for x in crossings)
    homes = rng.sample(stock.HOMES, 6)
    outline = lay(site, street, side_street=turn if far and rng.random() < 0.6 else 0.0, labels=homes)
    site.houses()
    if outline.bounds[3] > half + street.left + 1.0:
        side_walks(site, street, turn, outline.bounds[3])
    else:
        walks(site, street)
    clear = shapely.union_all([shapely.box(x - 3.5, -9, x + 3.5, 9) for x in crossings])
    if kerb < 0.1:  # a low kerb: cars park half on the pavement where it is wide enough
        for side in (1, -1):
            x = rng.uniform(4.0, 12.0)
            while x < length - 8.0:
                label = rng.choice(("hatchback car", "sedan", "van", "electric car", "motorcycle"))
                size = site.size_of(label)
                y = street.y(side, rng.uniform(-0.3, 0.6) - size[1] / 2)
                zone = shapely.box(0, -half - street.right, length, half + street.left).difference(clear)
                up = kerb if abs(y) < half else 0.0
                site.put(label, x, y, rng.choice((0.0, 180.0)) + rng.uniform(-2, 2), zone, size, above=up)
                x += size[0] + rng.uniform(2.0, 14.0)
    traffic(site, street, share=0.05, parked=rng.uniform(0.25, 0.75), off=0.12)
    for side in (1, -1):
        if street.width(side) > street.path(side):
            _yards(site, street, side)
        zone, far_y = street.walk(side), street.y(side, street.width(side))
        ends = (length - 0.5, 0.5) if side > 0 else (0.5, length - 0.5)
        for _ in range(rng.randint(3, 9)):
            x = rng.uniform(2, length - 2)
            mix = rng.choice((("trash bin", "garbage bag", "garbage bag"), stock.MIXES["dumped"]))
            groups.heap(site, x, far_y - side * 0.4, zone, mix, rng.randint(2, 6))
        site.lean([(ends[0], far_y), (ends[1], far_y)], "doors", (0.4, 3.0), zone, turn=90.0)
        furnish(site, street, side, 1.5, 0.8, 3.0)
    return site


def _yards(site: Site, street: Street, side: int) -> None:
    """Places front yards: a hedge, fence, wall or no border towards the pavement, with a gap before each door."""
    rng, zone = site.rng, street.walk(side)
    y = street.y(side, street.path(side) + 0.4)
    x = 1.0
    while x < street.length - 6.0:
        end = x + rng.uniform(4.0, 9.0)
        kind = rng.choice(("hedge", "fence", "wall", "open", "pots"))
        if kind == "hedge":
            groups.hedge(site, [(x, y), (end, y)], zone, 0.1)
        elif kind == "fence":
            site.row("fence", (x + 1.4, y), (end - 1.3, y), 2.85, zone)
        elif kind == "wall":
            size = (0.25, round(end - x, 2), round(rng.uniform(0.6, 1.4), 2))
            site.put("wall", (x + end) / 2, y, -90.0 * side, zone, size)
        elif kind == "pots":
            site.row(rng.choice(("plant pot", "flower", "shrub", "guard stone")), (x + 0.6, y), (end, y), 1.5, zone)
        x = end + rng.uniform(1.1, 1.8)
    y0, y1 = street.y(side, street.path(side) + 0.1), street.y(side, street.width(side) - 0.03)
    inner = shapely.box(0.5, min(y0, y1), street.length - 0.5, max(y0, y1))
    for mix, per in (("planters", 8.0), ("wall", 6.0), ("dumped", 3.0), ("animals", 1.5), ("lawn", 2.0)):
        site.scatter(inner, mix, per)


def crossing(scene_id: str, rng: random.Random) -> Site:
    """Builds a broad street with bus stops, queues and crowds, islands beside its crosswalks, rails and bollards at the
    kerbs, and a side street."""
    site = Site(scene_id, rng)
    length, half = round(rng.uniform(64.0, 88.0), 1), round(rng.uniform(4.5, 6.5), 2)
    left, right = round(rng.uniform(3.4, 6.0), 2), round(rng.uniform(3.0, 6.0), 2)
    crossings = (round(length * rng.uniform(0.16, 0.26), 1), round(length * rng.uniform(0.76, 0.84), 1))
    street = Street(length, half, left, right, rng.choice((0.1, 0.12, 0.15)), crossings)
    turn = round(length * rng.uniform(0.47, 0.53), 1)
    outline = lay(site, street, side_street=turn if rng.random() < 0.7 else 0.0)
    islands = []
    for k, x in enumerate(crossings):  # an island in the road on both sides of the crosswalk
        for name, a, b in (("a", x - 4.4, x - 1.7), ("b", x + 1.7, x + 4.4)):
            islands.append(shapely.box(a, -0.8, b, 0.8))
            site.canvas.ground(f"island_{k}{name}", "sidewalk", rectangle(a, -0.8, b, 0.8), street.kerb)
    site.houses()
    if outline.bounds[3] > half + left:
        side_walks(site, street, turn, outline.bounds[3])
    else:
        walks(site, street)
    for island in islands:
        top = island.buffer(-0.06)
        for label in ("bollard", rng.choice(("traffic light", "do not enter sign", "guard stone", "pole"))):
            site.put(label, rng.uniform(*top.bounds[::2]), rng.uniform(*top.bounds[1::2]), rng.choice((0, 90)), top)
    for side in (1, -1):
        _stop(site, street, side)
    traffic(site, street, share=0.3, parked=0.1, apart=4.6)
    for side in (1, -1):
        furnish(site, street, side, 1.8, 1.2, 1.3)
        for x in crossings:  # people waiting to cross
            for _ in range(rng.randint(2, 9)):
                place = x + rng.uniform(-4.5, 4.5), street.y(side, rng.uniform(0.4, min(3.5, street.width(side))))
                site.put(rng.choice(stock.MIXES["people"]), *place, rng.uniform(-180, 180), street.walk(side))
    return site


def _stop(site: Site, street: Street, side: int) -> None:
    """Places a bus stop with waiting people and sometimes a bus, and rails or bollards along the rest of the kerb."""
    rng, zone = site.rng, street.walk(side)
    for _ in range(rng.randint(1, 3)):
        x = rng.uniform(6.0, street.length - 6.0)
        if all(abs(x - c) > 7.0 for c in street.crossings):
            y = street.y(side, rng.choice((1.3, street.width(side) - 1.2)))
            facing = -90.0 * side
            site.put("bus shelter", x, y, facing, zone)
            groups.queue(
                site, x + 2.6, street.y(side, rng.uniform(0.6, 1.4)), rng.choice((0.0, 180.0)), rng.randint(3, 10), zone
            )
            groups.heap(site, x, street.y(side, 1.0), zone, stock.MIXES["people"], rng.randint(3, 9))
            if rng.random() < 0.5:
                road = street.road.difference(
                    shapely.union_all([shapely.box(c - 4.6, -99, c + 4.6, 99) for c in street.crossings])
                )
                site.put(
                    rng.choice(("bus", "trolleybus", "school bus")),
                    x,
                    street.y(side, -1.75),
                    180.0 if side > 0 else 0.0,
                    road,
                )
    label, apart = rng.choice((("bollard", 1.6), ("guard rail", 3.1), ("guard stone", 1.8), ("bollard", 1.9)))
    y = street.y(side, 0.35)
    site.row(label, (2.0, y), (street.length - 2.0, y), apart, zone, skip=rng.uniform(0.05, 0.4))
