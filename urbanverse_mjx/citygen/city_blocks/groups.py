"""Groups of objects: a cafe's tables, a row of stalls, a road work, a cluster of scooters."""

from collections.abc import Callable

from . import stock
from .filling import Filler

Group = Callable[[Filler, int, float], None]


def _v(filler: Filler, side: int, share: float) -> float:
    """Returns v at a share of the pavement behind the verge."""
    verge = filler.plan.verge(side)
    return verge + share * (filler.plan.width(side) - verge)


def _put(filler: Filler, name: str, s: float, side: int, v: float, facing: str | float = "street") -> bool:
    return filler.put(stock.draw(name, filler.rng), s, side, v, facing)


def cafe(filler: Filler, side: int, s: float) -> None:
    """Places three to five tables with chairs along the fronts, a menu board, and sunshades on wide pavements."""
    width = filler.plan.width(side)
    v = width - 0.6
    for k in range(3 + int(filler.uniform(0, 3))):
        at = s + 2.1 * k
        if not _put(filler, "table#1", at, side, v):
            continue
        _put(filler, "chair", at - 0.72, side, v, "+")
        _put(filler, "chair", at + 0.72, side, v, "-")
        if width > 3.6:
            _put(filler, "sunshade#0", at, side, v - 0.75)
    _put(filler, "advertising board#0", s - 1.3, side, max(v - 0.4, 0.4), "+")


def terrace(filler: Filler, side: int, s: float) -> None:
    """Places low stools and tables of a street kitchen at the kerb and the fronts, with a stall between them."""
    width = filler.plan.width(side)
    _put(filler, "street food stall", s, side, width - 1.3, "street")
    for k in range(4):
        at = s + 1.9 + 1.4 * k
        for v in (0.6, width - 0.5):
            if _put(filler, "table#0", at, side, v):
                _put(filler, "stool", at - 0.6, side, v)
                _put(filler, "stool", at + 0.6, side, v)


def stalls(filler: Filler, side: int, s: float) -> None:
    """Places three stalls at the kerb with boxes, and people before them."""
    for k in range(3):
        at = s + 3.6 * k
        _put(filler, "street food stall" if filler.chance(0.7) else "kiosk#1", at, side, 1.3, "wall")
        for name in ("storage box", "barrel or bucket", "storage box"):
            _put(filler, name, at + filler.uniform(1.3, 2.1), side, filler.uniform(0.5, 1.4), filler.uniform(-90, 90))
        _put(filler, "pedestrian adult", at + filler.uniform(-0.5, 0.5), side, 2.9, "street")


def vendors(filler: Filler, side: int, s: float) -> None:
    """Places goods on the ground and on carts under umbrellas."""
    for k in range(5):
        at, v = s + 2.0 * k, _v(filler, side, filler.uniform(0.1, 0.9))
        name = stock.pick(
            (("handcart#1", 2), ("sunshade", 2), ("table#2", 2), ("storage box", 3), ("barrow", 1)), filler.rng
        )
        if _put(filler, name, at, side, v, filler.uniform(-30, 30)):
            for other in ("storage box", "barrel or bucket", "grocery bag"):
                _put(
                    filler,
                    other,
                    at + filler.uniform(0.5, 1.1),
                    side,
                    v + filler.uniform(-0.5, 0.5),
                    filler.uniform(0, 90),
                )
            _put(filler, "pedestrian adult", at - 0.8, side, v + 0.2, filler.uniform(-180, 180))


def works(filler: Filler, side: int, s: float) -> None:
    """Places road works at the kerb: fences, cones, sand, a barrow and a worker, and a barrier on the road."""
    for k in range(4):
        _put(filler, "fence#0", s + 1.4 + 2.75 * k, side, 1.45, "wall")
        _put(filler, "jersey barrier", s + 1.2 + 2.2 * k, side, -0.5, "street")
        _put(filler, "traffic cone", s + 0.3 + 2.9 * k, side, -1.2)
    _put(filler, "traffic barricade", s - 0.7, side, 0.7, "-")
    _put(filler, "traffic barricade", s + 12.2, side, 0.7, "+")
    _put(filler, "debris", s + 2.5, side, 0.7, 20.0)
    _put(filler, "barrow", s + 5.0, side, 0.6, "+")
    _put(filler, "construction worker", s + 7.0, side, 0.6, 40.0)
    _put(filler, "rock", s + 9.0, side, 0.7, 70.0)
    _put(filler, "road work detour ahead sign", s - 2.0, side, 0.6, "-")


def rubbish(filler: Filler, side: int, s: float) -> None:
    """Places a bin with a heap of bags and boxes."""
    edge = filler.chance(0.6)
    v = 0.55 if edge else filler.plan.width(side) - 0.6
    _put(filler, "trash bin", s, side, v)
    for k in range(3 + int(filler.uniform(0, 4))):
        name = stock.pick((("garbage bag", 5), ("storage box", 2), ("parcels", 1)), filler.rng)
        _put(filler, name, s + 0.75 + 0.62 * k, side, v + filler.uniform(-0.3, 0.35), filler.uniform(-180, 180))


def skip(filler: Filler, side: int, s: float) -> None:
    """Places a dumpster on the road with bags beside it."""
    _put(filler, "dumpster#2", s + 1.5, side, -1.1, "+")
    for k in range(3):
        _put(filler, "garbage bag", s + 3.6 + 0.6 * k, side, -0.5, filler.uniform(-180, 180))


def display(filler: Filler, side: int, s: float) -> None:
    """Places a shop's goods outside: boxes, pots, a board."""
    v = filler.plan.width(side) - 0.45
    for k in range(6):
        name = stock.pick(
            (("storage box", 4), ("potted plant#0", 1), ("plant pot", 1), ("barrel or bucket", 1)), filler.rng
        )
        _put(filler, name, s + 0.8 * k, side, v, filler.uniform(-8, 8) - 90 * side)
    _put(filler, "advertising board#1", s - 1.0, side, v - 0.5, "-")


def bus_stop(filler: Filler, side: int, s: float) -> None:
    """Places a shelter with waiting people, a bin and a timetable."""
    _put(
        filler,
        "bus shelter",
        s + 2.0,
        side,
        1.2 if filler.plan.width(side) > 3.2 else filler.plan.width(side) - 0.95,
        "wall",
    )
    _put(filler, "information point#1", s + 5.0, side, 0.5)
    for k in range(3):
        _put(filler, "pedestrian adult", s + 4.6 + 0.9 * k, side, filler.uniform(0.6, 1.4), filler.uniform(-180, 180))
    _put(filler, "trash bin", s - 1.0, side, 0.5, "wall")


def planters(filler: Filler, side: int, s: float) -> None:
    """Places pots and shrubs along the fronts."""
    for k in range(5):
        name = stock.pick((("potted plant", 3), ("plant pot#1", 1), ("flower", 2), ("shrub#3", 1)), filler.rng)
        _put(filler, name, s + 1.3 * k, side, filler.plan.width(side) - 0.42)


def delivery(filler: Filler, side: int, s: float) -> None:
    """Places a van with two wheels on the pavement, parcels and a hand cart."""
    _put(filler, "van", s + 2.6, side, 0.3, "+")
    for k in range(3):
        _put(filler, "parcels", s + 5.8 + 0.5 * k, side, filler.uniform(0.4, 1.2), filler.uniform(0, 90))
    _put(filler, "handcart#0", s + 6.6, side, 1.6, 30.0)
    _put(filler, "delivery worker", s + 7.4, side, 1.5, 150.0)


def seats(filler: Filler, side: int, s: float) -> None:
    """Places two benches, a bin and a lamp."""
    _put(filler, "bench", s, side, 0.75, "wall")
    _put(filler, "bench", s + 2.4, side, 0.75, "wall")
    _put(filler, "trash bin", s + 4.2, side, 0.5, "wall")
    _put(filler, "lamppost", s + 5.2, side, 0.5)


def row(filler: Filler, name: str, side: int, s: float) -> None:
    """Places eight copies of an object along the kerb at equal distances."""
    size = stock.draw(name, filler.rng).size
    step = max(1.5, 1.15 * max(size[:2]) if name.partition("#")[0] in ("fence", "guard rail") else 1.7)
    item = stock.draw(name, filler.rng)
    for k in range(8):
        filler.put(item, s + step * k, side, 0.18 + min(item.size[:2]) / 2, "wall")


def cluster(filler: Filler, name: str, side: int, s: float) -> None:
    """Places three to seven copies of an object side by side, at the kerb or at the fronts, each slightly rotated."""
    at_wall = filler.chance(0.4)
    deep, wide = stock.draw(name, filler.rng).size[:2]
    lean = filler.uniform(-25, 25)
    side_on = filler.plan.width(side) < deep + filler.plan.profile.lane + 0.5  # too narrow to stand across
    if side_on:
        deep, wide, lean = wide, deep, lean / 4 + 90.0 * side
    v = filler.plan.width(side) - deep / 2 - 0.1 if at_wall else deep / 2 + 0.12
    for k in range(3 + int(filler.uniform(0, 5))):
        facing = (-90.0 if at_wall else 90.0) * side + lean + filler.uniform(-8, 8)
        _put(filler, name, s + (wide + 0.2) * k, side, v, facing)


def spread(filler: Filler, name: str, side: int, s: float) -> None:
    """Places an object every twenty to thirty metres along the kerb of both sides, like lamps and masts."""
    item = stock.draw(name, filler.rng)
    step = filler.uniform(20.0, 28.0)
    for which in filler.sides():
        at = 3.0 + filler.uniform(0, step / 2)
        while at < filler.line.length - 2:
            for nudge in (0.0, 1.2, -1.2, 2.4):
                if filler.put(item, at + nudge, which, 0.38, "street"):
                    break
            at += step


GROUPS: dict[str, tuple[Group, float]] = {
    # name: (builder, m of street that the group occupies)
    "cafe": (cafe, 10.0),
    "terrace": (terrace, 8.0),
    "stalls": (stalls, 11.0),
    "vendors": (vendors, 10.0),
    "works": (works, 13.0),
    "rubbish": (rubbish, 4.0),
    "skip": (skip, 5.5),
    "display": (display, 5.0),
    "bus stop": (bus_stop, 7.5),
    "planters": (planters, 6.0),
    "delivery": (delivery, 8.0),
    "seats": (seats, 5.5),
}
_OF_AN_OBJECT = {"row": (row, 13.0), "cluster": (cluster, 4.0), "spread": (spread, 5.0)}


def place(filler: Filler, name: str, count: int) -> None:
    """Places `count` groups of a kind; "row X", "cluster X" and "spread X" repeat objects of the leaf X."""
    first, _, leaf = name.partition(" ")
    for _ in range(count):
        side = filler.sides()[int(filler.rng.random() * len(filler.sides()))]
        if name in GROUPS:
            build, length = GROUPS[name]
            build(filler, side, filler.stretch(side, length))
        else:
            build_of, length = _OF_AN_OBJECT[first]
            build_of(filler, leaf, side, filler.stretch(side, length))
