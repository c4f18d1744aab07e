"""Places house fronts along a block, across its ends and at the back of side streets, and the objects on them."""

from . import stock
from .filling import Filler
from .ground import ARM, CROSS_ROAD, FAR_PAVEMENT, SIDE_DEPTH, Plan

#: m, greatest depth of a front, and greatest factor by which one is stretched.
MAX_DEPTH, MAX_STRETCH = 9.0, 1.25
#: m, gap between two fronts.
JOINT = 0.02
#: m, a shorter remainder at the end of a row is closed by a wall instead of a stretched house.
MIN_REMAINDER = 4.5


def build(filler: Filler) -> None:
    """Places all fronts of a block."""
    plan = filler.plan
    for side in (1, -1):
        at = 0.0
        for mouth in [*plan.mouths(side), None]:
            end = filler.line.length if mouth is None else mouth.begin
            for piece in filler.line.pieces:
                begin, stop = max(at, piece.begin), min(end, piece.end)
                if begin < stop - 1.0:
                    front = side * plan.front(side)
                    a = begin + filler.line.shift(piece, begin, front) if begin == piece.begin else begin
                    b = stop + filler.line.shift(piece, stop, front) if stop == piece.end else stop
                    _row(filler, side, a, b)
            if mouth is not None:
                at = mouth.end
                width = mouth.end - mouth.begin
                house = _house(filler, width + 3.0)
                v = plan.front(side) - plan.half + SIDE_DEPTH + house.size[0] / 2
                filler.put(house, mouth.begin + width / 2, side, v, "street", free=True)
    for at_end in (False, True):
        _close(filler, plan, at_end)


def _house(filler: Filler, frontage: float) -> stock.Item:
    """Returns a house of the profile's mix, close to a frontage (m) and to the profile's height."""
    profile = filler.plan.profile
    wanted = (MAX_DEPTH, frontage, filler.uniform(*profile.height))
    house = stock.draw(stock.pick(profile.houses, filler.rng), filler.rng, wanted)
    # Fronts may be stretched towards the desired size within plausible limits.
    size = [x * min(max(y / x, 1 / MAX_STRETCH), MAX_STRETCH) for x, y in zip(house.size, wanted, strict=True)]
    size[0] = min(house.size[0], 1.4 * MAX_DEPTH)
    return stock.Item(house.label, tuple(round(x, 3) for x in size), house.descriptor)  # type: ignore[arg-type]


def _row(filler: Filler, side: int, begin: float, end: float) -> None:
    """Places fronts side by side from begin to end; the remaining length becomes small gaps or a wall."""
    profile = filler.plan.profile
    depth = filler.plan.front(side) - filler.plan.half
    at = begin
    while end - at > MIN_REMAINDER:
        left_over = end - at
        wanted = filler.uniform(*profile.frontage)
        if left_over - wanted < MIN_REMAINDER:
            wanted = left_over
        house = _house(filler, min(wanted, left_over))
        along, across, up = house.size
        if across > left_over:
            along, across = along, left_over - JOINT
            house = stock.Item(house.label, (along, round(across, 3), up), house.descriptor)
        filler.put(house, at + across / 2, side, depth + along / 2, "street", free=True)
        at += across + JOINT
        if filler.chance(profile.gaps):
            gap = filler.uniform(2.0, 4.5)
            _wall(filler, side, at, min(at + gap, end))
            at += gap
    _wall(filler, side, at, end)


def _wall(filler: Filler, side: int, begin: float, end: float) -> None:
    """Places a wall or fence between two houses and a tree behind it."""
    width = end - begin
    if width < 0.5:
        return
    wall = stock.draw("wall" if filler.chance(0.6) else "fence#2", filler.rng)
    size = (wall.size[0], round(width - JOINT, 3), wall.size[2])
    depth = filler.plan.front(side) - filler.plan.half
    filler.put(stock.Item(wall.label, size, wall.descriptor), begin + width / 2, side, depth + 0.2, "street", free=True)
    if width > 2.0 and filler.plan.profile.trees:
        growth = stock.pick(filler.plan.profile.trees, filler.rng)
        filler.put(stock.draw(f"tree#{growth}", filler.rng), begin + width / 2, side, depth + 2.0, "street", free=True)


def _close(filler: Filler, plan: Plan, at_end: bool) -> None:
    """Places fronts along the far side of a cross road, and one at the end of each of its arms."""
    profile = plan.profile
    edge, sign, facing = (filler.line.length, 1.0, 180.0) if at_end else (0.0, -1.0, 0.0)
    away = CROSS_ROAD + FAR_PAVEMENT
    at, stop = -plan.front(-1) - ARM, plan.front(1) + ARM
    while stop - at > MIN_REMAINDER:
        house = _house(filler, filler.uniform(*profile.frontage))
        along, across, _ = house.size
        filler.put(house, edge + sign * (away + along / 2), 1, at + across / 2 - plan.half, facing, free=True)
        at += across + JOINT
    for side in (1, -1):
        house = _house(filler, CROSS_ROAD + FAR_PAVEMENT)
        v = plan.front(side) - plan.half + ARM + house.size[0] / 2
        filler.put(house, edge + sign * away / 2, side, v, "street", free=True)


def hang(filler: Filler) -> None:
    """Places awnings, banners, air conditioners and similar objects on the fronts."""
    plan, profile = filler.plan, filler.plan.profile
    for side in (1, -1):
        depth, taken = plan.front(side) - plan.half, list[tuple[float, float]]()
        for _ in range(round(profile.hangings * filler.line.length / 100)):
            item = stock.draw(stock.pick(profile.hung, filler.rng), filler.rng)
            s = filler.uniform(4.0, filler.line.length - 4.0)
            if any(m.begin - 3 < s < m.end + 3 for m in plan.mouths(side)):
                continue
            low, high = (2.3, 2.6) if item.label in ("awning", "lantern") else (2.9, min(9.0, profile.height[0] - 2.0))
            along = item.label == "banner"
            out = (item.size[1] if along else item.size[0]) / 2
            foot = max(0.0, filler.uniform(low, max(low, high)))
            if item.label == "awning":
                if any(a < s + item.size[1] / 2 and s - item.size[1] / 2 < b for a, b in taken):
                    continue
                taken.append((s - item.size[1] / 2, s + item.size[1] / 2))
            if item.label == "awning" and item.size[2] > 2.0:
                foot = 0.0  # stands on its own posts
            filler.put(item, s, side, depth - out - 0.02, "+" if along else "street", foot=foot, free=True)
