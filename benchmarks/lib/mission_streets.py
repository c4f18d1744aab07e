"""Streets of several joined blocks for long missions, and the numbered missions on them.

A street has blocks of houses in a row along a road, joined by zebra crossings over the streets between them, with a
pavement on both sides; a crossing over the road ends it. Objects are drawn by the street's number, in the bands along
kerb and walls and, one at a time, in the middle. A mission leads along one pavement over all crossings, over the road
and back along the other pavement.
"""

import dataclasses
from collections.abc import Iterator

import numpy as np

from urbanverse_mjx.citygen.canvas import ground_layers as lay
from urbanverse_mjx.citygen.canvas.canvas import Canvas, Edge, edge
from urbanverse_mjx.citygen.canvas.ground_layers import Corner
from urbanverse_mjx.citygen.canvas.pieces import blank

KERB, HALF, WALK, CROSS = 0.14, 3.5, 4.2, 6.0  # m: kerb, half of the road, pavement, street between two blocks
#: m of a block, and m between the places at which an object may stand in each band.
BLOCK, SPACING = 56.0, {"kerb": 3.4, "wall": 4.0, "middle": 9.0}
#: m from the kerb; share of the places that are taken.
BANDS = {"kerb": (0.7, 0.7), "wall": (WALK - 0.7, 0.6), "middle": (1.9, 0.7)}
STOCK = {
    "kerb": ("bollard", "parking meter", "street light", "fire hydrant", "trash bin", "newspaper stand", "bicycle"),
    "wall": ("potted plant", "plant pot", "chair", "storage box", "advertising board", "garbage bag", "street cabinet"),
    "middle": ("pedestrian adult", "traffic cone", "scooter", "garbage bag", "dog", "parcels", "stroller"),
}
HOUSES = ("apartment building", "house", "bank", "bakery", "hotel", "pharmacy", "office building", "cafe", "bookstore")
#: m at either end of a block, and beside a crossing, that stay free.
MOUTH = 3.0
#: Numbers of streets and of missions on each.
STREETS, EACH = 10, 5


@dataclasses.dataclass(frozen=True)
class Size:
    """Size of a street: number of blocks, m of each."""

    blocks: int = 3
    block: float = BLOCK

    @property
    def length(self) -> float:
        """m from end to end."""
        return self.blocks * self.block + (self.blocks - 1) * CROSS

    def block_spans(self) -> list[tuple[float, float]]:
        """(from, to) m of each block."""
        return [(k * (self.block + CROSS), k * (self.block + CROSS) + self.block) for k in range(self.blocks)]


@dataclasses.dataclass(frozen=True)
class Mission:
    """A numbered mission.

    Attributes:
      number: from 0; the street is number % STREETS.
      via: (n, 2) m, corners of the route.
      seed: of its people.
    """

    number: int
    via: tuple[Corner, ...]
    seed: int

    @property
    def street(self) -> int:
        return self.number % STREETS


def mission(number: int, size: Size) -> Mission:
    """A mission by its number; begin, direction and side differ among those of one street."""
    rng = np.random.default_rng([number, 47])
    end = size.length - 5.0
    side = 1 if rng.random() < 0.5 else -1
    near, far = side * (HALF + WALK / 2), -side * (HALF + WALK / 2)
    begin = float(rng.uniform(3.0, 6.0))
    via = ((begin, near), (end, near), (end, far), (float(rng.uniform(3.0, 6.0)), far))
    return Mission(number, via if rng.random() < 0.5 else via[::-1], number)


def street_id(number: int, size: Size) -> str:
    """Name of a street."""
    return f"mission_{number:02d}_{size.blocks}x{size.block:g}"


def street(number: int, size: Size) -> Canvas:
    """Composes a street; objects that would block a route, overlap or stand across a kerb are left out."""
    c = blank(street_id(number, size))
    rng = np.random.default_rng([number, 46])
    _ground(c, size)
    c.sky(str(rng.choice(["summer_noon-few_cumulus", "spring_morning-few_cumulus", "summer_evening-few_cumulus"])))
    for x0, x1 in size.block_spans():
        for side in (1, -1):
            line = edge((x0, side * HALF), (x1, side * HALF), side)
            wall = edge((x0, side * (HALF + WALK)), (x1, side * (HALF + WALK)), side)
            count = max(1, round((x1 - x0) / 10.5))
            c.houses(wall, [str(h) for h in rng.choice(HOUSES, count)], 0.1, x1 - x0 - 0.1, 0.0)
            for label, s, d, facing in _drawn(rng, x1 - x0):
                _put(c, line, label, s, d, facing, size)
    middle = HALF + WALK / 2
    c.trajectory = [(3.0, middle), (size.length - 5.0, middle), (size.length - 5.0, -middle), (3.0, -middle)]
    return c


def _drawn(rng: np.random.Generator, length: float) -> Iterator[tuple[str, float, float, float]]:
    """Label, m along the kerb, m from the kerb and heading of the objects of one pavement of a block."""
    for band, (d, share) in BANDS.items():
        for s in np.arange(MOUTH, length - MOUTH, SPACING[band]):
            taken, label = rng.random() < share, str(rng.choice(STOCK[band]))
            place = s + rng.uniform(0.0, 1.0), d + (rng.uniform(-0.6, 0.9) if band == "middle" else 0.0)
            turn = float(rng.uniform(-180.0, 180.0)) if band == "middle" else float(rng.choice([0.0, 180.0]))
            if taken:
                yield label, float(place[0]), float(place[1]), turn


def _put(c: Canvas, line: Edge, label: str, s: float, d: float, facing: float, size: Size) -> None:
    """Places an object unless it makes a fault."""
    x, _ = line.at(s, d)
    if x > size.length - 5.0 - 4.0:  # the crossing over the road
        return
    before = len(c.objects)
    c.put(label, *line.at(s, d), line.facing(facing))
    near = [o for o in c.objects[:before] if abs(o.center[0] - c.objects[-1].center[0]) < 9.0]
    if _crowded(c, near):
        c.objects.pop()


def _crowded(c: Canvas, near: list) -> bool:
    """Whether the newest object touches one near it, or leaves less than a robot's width beside it."""
    from urbanverse_mjx.citygen import clearance

    newest = clearance.footprint(c.objects[-1])
    if any(newest.distance(clearance.footprint(o)) < 0.25 for o in near):
        return True
    # Of the pavement's width at this place, 1.5 m must stay free on one side of everything that stands there.
    x0, y0, x1, y1 = newest.bounds
    taken = [(abs(y0), abs(y1)) if y0 > 0 else (abs(y1), abs(y0))]
    for o in near:
        a, b, u, w = clearance.footprint(o).bounds
        if a < x1 + 0.9 and u > x0 - 0.9 and b * y0 > 0 and clearance.is_obstacle(o):
            taken.append((abs(b), abs(w)) if b > 0 else (abs(w), abs(b)))
    at = HALF
    for low, high in sorted(taken):
        if low - at >= 1.5:
            return False
        at = max(at, high)
    return HALF + WALK - at < 1.5


def _ground(c: Canvas, size: Size) -> None:
    end, outer = size.length, HALF + WALK
    c.ground("road", "road", lay.rectangle(0.0, -HALF, end, HALF))
    for side, name in ((1, "north"), (-1, "south")):
        low, high = sorted((side * HALF, side * outer))
        back = sorted((side * outer, side * (outer + 2.4)))
        for k, (x0, x1) in enumerate(size.block_spans()):
            c.ground(f"{name}_lots_{k}", "sidewalk", lay.rectangle(x0, back[0], x1, back[1]), KERB)
            c.ground(f"{name}_{k}", "sidewalk", lay.rectangle(x0, low, x1, high), KERB)
        for k, ((_, x0), (x1, _)) in enumerate(zip(size.block_spans(), size.block_spans()[1:], strict=False)):
            # The street between two blocks, with a zebra in line with the pavement.
            far = sorted((side * outer, side * (outer + 2.4)))
            c.ground(f"{name}_street_{k}", "road", lay.rectangle(x0, low, x1, high))
            c.ground(f"{name}_street_back_{k}", "road", lay.rectangle(x0, far[0], x1, far[1]))
            middle = side * (HALF + WALK / 2)
            c.ground(f"{name}_zebra_{k}", "crosswalk", lay.rectangle(x0, middle - 1.6, x1, middle + 1.6))
            c.ramp(f"{name}_ramp_{k}_a", (x0, middle), 180.0, parted=False, half_width=1.2, flare=0.4)
            c.ramp(f"{name}_ramp_{k}_b", (x1, middle), 0.0, parted=False, half_width=1.2, flare=0.4)
    x = end - 5.0
    c.ground("zebra", "crosswalk", lay.rectangle(x - 2.0, -HALF, x + 2.0, HALF))
    c.ramp("ramp_n", (x, HALF), 90.0, parted=False)
    c.ramp("ramp_s", (x, -HALF), -90.0, parted=False)
    c.wear("road", "road/asphalt_used")
    c.wear("crosswalk", "zebra_new")
