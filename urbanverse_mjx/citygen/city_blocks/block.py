"""`block`: builds the ground-truth scene graph of about 200 m of street from a city's profile."""

import math
import random

import numpy as np

from ... import versions
from ...assets.appearances import appearance_search
from ...datatypes import GroundRegion, SceneGraph, Source
from . import fronts, groups, stock
from .filling import END_CLEARANCE, Filler
from .ground import BAY, CROSSWALK_HALF, END_RAMP, Plan, SideStreet, ground
from .line import StreetLine
from .profile import CityProfile

LENGTH = 200.0
#: Part of the block's seed; recorded in its source.
VERSION = str(versions.CODE["blocks"].version)
#: m, height of a trajectory's camera above the ground, and distance between its points.
CAMERA_HEIGHT, STRIDE = 1.55, 2.4
#: m, no crosswalk or side street begins closer than this to a bend, a crosswalk or an end.
_JUNCTION_CLEARANCE = 4.5
_TWO_WHEELED = frozenset({"motorcycle", "scooter", "bicycle"})


def block(profile: CityProfile, seed: int, name: str | None = None, length: float = LENGTH) -> SceneGraph:
    """Returns the graph of a block: all its objects with descriptors of their appearance, deterministic for a seed.

    Its camera path follows both pavements, or both lanes of the road for a driving profile.
    """
    rng = random.Random(f"{profile.name}/{seed}/{VERSION}")
    plan = plan_of(profile, rng, length)
    filler = Filler(plan, rng)
    _block_lanes(filler)
    filler.close_zones()
    fronts.build(filler)
    _trees(filler)
    for group, count in profile.groups:
        groups.place(filler, group, round(count))
    _parked(filler)
    _traffic(filler)
    _furnish(filler)
    fronts.hang(filler)
    regions = [_dressed(r, profile, rng_of(profile, seed, "ground")) for r in [*ground(plan), *_paint(plan)]]
    sky = appearance_search.own_sky_descriptor(stock.pick(profile.skies, rng_of(profile, seed, "sky")))
    source = Source(f"synthetic block after {profile.city}", "Apache-2.0", profile.city, profile.country)
    return SceneGraph(name or profile.name, source, tuple(filler.objects), tuple(regions), sky, _trajectory(filler))


def rng_of(profile: CityProfile, seed: int, what: str) -> random.Random:
    """Returns a separate random stream for each kind of choice, so that one choice does not shift the others."""
    return random.Random(f"{profile.name}/{seed}/{VERSION}/{what}")


def plan_of(profile: CityProfile, rng: random.Random, length: float) -> Plan:
    """Returns the plan: crosswalks and side streets spread over the length, clear of bends, ends and each other."""
    line = StreetLine(length, profile.bends)
    taken = [
        (0.0, _JUNCTION_CLEARANCE),
        (length - _JUNCTION_CLEARANCE, length),
        *((j - _JUNCTION_CLEARANCE, j + _JUNCTION_CLEARANCE) for j in line.joints),
    ]

    def find(wanted: float, half: float) -> float | None:
        for k in range(60):
            s = wanted + (-1) ** k * (k / 2)
            if half < s < length - half and all(s + half < a or s - half > b for a, b in taken):
                return s
        return None

    crosswalks = []
    for k in range(profile.crosswalks):
        s = find((k + 0.35 + 0.3 * rng.random()) * length / profile.crosswalks, CROSSWALK_HALF)
        if s is not None:
            crosswalks.append(round(s, 2))
            taken.append((s - CROSSWALK_HALF - 1.0, s + CROSSWALK_HALF + 1.0))
    mouths = []
    for k in range(profile.side_streets):
        half = 2.2 + 1.3 * rng.random()
        s = find((k + 0.2 + 0.6 * rng.random()) * length / profile.side_streets, half + END_RAMP)
        if s is not None:
            mouths.append(SideStreet(1 if rng.random() < 0.5 else -1, round(s - half, 2), round(s + half, 2)))
            taken.append((s - half - END_RAMP - 1.0, s + half + END_RAMP + 1.0))
    return Plan(line, profile, tuple(sorted(crosswalks)), tuple(sorted(mouths, key=lambda m: m.begin)))


def _block_lanes(filler: Filler) -> None:
    """Blocks a pavement's lane for some metres between two crosswalks, at most one pavement at a time."""
    plan = filler.plan
    gaps = list(zip(plan.crosswalks[:-1], plan.crosswalks[1:], strict=True))
    for side in filler.sides():
        for _ in range(min(plan.profile.blocked, len(gaps))):
            a, b = gaps.pop(int(filler.rng.random() * len(gaps)))
            at = filler.uniform(a + 8.0, max(a + 8.0, b - 14.0))
            filler.blocked[side].append((at, at + 6.0))


def _trees(filler: Filler) -> None:
    profile, plan = filler.plan.profile, filler.plan
    if not profile.trees or not profile.spacing:
        return
    for side in filler.sides():
        at = filler.uniform(1.0, profile.spacing)
        growth = stock.pick(profile.trees, filler.rng)
        while at < filler.line.length - 1.0:
            if len(profile.trees) > 1 and filler.chance(0.25):
                growth = stock.pick(profile.trees, filler.rng)
            tree = stock.draw(f"tree#{growth}", filler.rng)
            v = plan.verge(side) / 2 if plan.verge(side) > 0.5 else 0.55
            filler.put(tree, at, side, v, filler.uniform(-180, 180))
            at += stock.around(profile.spacing, 0.15, filler.rng)


def _ahead(filler: Filler, side: int) -> float:
    """Returns the heading (degrees relative to the street) of the traffic on a side of the road."""
    with_street = (side < 0) == (filler.plan.profile.drives == "right")
    return 0.0 if with_street else 180.0


def _parked(filler: Filler) -> None:
    profile = filler.plan.profile
    for side, share in ((1, profile.parked_left), (-1, profile.parked_right)):
        at = END_CLEARANCE
        while at < filler.line.length - END_CLEARANCE - 4.0:
            item = stock.draw(stock.pick(profile.parked, filler.rng), filler.rng)
            if not filler.chance(share):
                at += filler.uniform(3.0, 6.5)
                continue
            along, across, _ = item.size
            if item.label in _TWO_WHEELED:
                filler.put(item, at + across / 2, side, -along / 2 - 0.1, 90.0 * side + filler.uniform(10, 40))
                at += across + 0.18
                continue
            turn = 180.0 * filler.chance(0.08) + filler.uniform(-2, 2)
            filler.put(item, at + along / 2, side, -across / 2 - filler.uniform(0.05, 0.3), _ahead(filler, side) + turn)
            at += along + filler.uniform(0.5, 1.4)
    for k in range(round(profile.on_pavement)):
        side = filler.sides()[k % len(filler.sides())]
        for _ in range(12):
            item = stock.draw(stock.pick(profile.parked, filler.rng), filler.rng)
            v = filler.uniform(0.1, max(0.2, filler.plan.width(side) - item.size[1] / 2))
            s = filler.stretch(side, item.size[0]) + item.size[0] / 2
            if filler.put(item, s, side, v, _ahead(filler, side) + filler.uniform(-12, 12)):
                break
    for side, places in filler.blocked.items():
        for a, b in places:
            item = stock.draw(stock.pick(profile.parked, filler.rng), filler.rng)
            v = filler.plan.width(side) / 2
            filler.put(item, (a + b) / 2, side, v, _ahead(filler, side) + filler.uniform(-25, 25))


def _traffic(filler: Filler) -> None:
    profile, length = filler.plan.profile, filler.line.length
    for k in range(round(profile.moving * length / 100)):
        item = stock.draw(stock.pick(profile.traffic, filler.rng), filler.rng)
        side = 1 if k % 2 else -1
        offset = profile.road / 4 if profile.road > 6.0 else filler.uniform(0.2, 0.6)
        for _ in range(8):
            s = filler.uniform(END_CLEARANCE + 8.0, length - END_CLEARANCE - 8.0)
            v = offset - profile.road / 2 + filler.uniform(-0.3, 0.3)
            if filler.put(item, s, side, v, _ahead(filler, side) + filler.uniform(-2, 2)):
                break


def _furnish(filler: Filler) -> None:
    profile, length = filler.plan.profile, filler.line.length
    bands = (
        (profile.kerbside, profile.furniture, "kerb", None),
        (profile.wallside, profile.clutter, "wall", None),
        (profile.people, profile.crowd, "any", None),
    )
    for mix, density, band, facing in bands:
        for side in filler.sides():
            for _ in range(round(density * length / 100)):
                filler.somewhere(mix, side, band, facing)
    if profile.yard > 1.5:
        _yards(filler)


def _yards(filler: Filler) -> None:
    """Places shrubs, flowers and trees in front gardens, and hedges and fences before some of them."""
    plan = filler.plan
    for side in (1, -1):
        base, deep = plan.width(side), plan.profile.yard
        for _ in range(round(0.22 * filler.line.length)):
            name = stock.pick((("shrub", 4), ("flower", 3), ("tree", 1.5), ("grass patch", 1)), filler.rng)
            if name == "tree" and plan.profile.trees:
                name = f"tree#{stock.pick(plan.profile.trees, filler.rng)}"
            s, v = filler.uniform(2, filler.line.length - 2), base + filler.uniform(0.6, deep - 0.7)
            filler.put(stock.draw(name, filler.rng), s, side, v, filler.uniform(-180, 180))
        at = 2.0
        while at < filler.line.length - 3.0:
            item = stock.draw("shrub#1" if filler.chance(0.5) else "fence#1", filler.rng)
            if filler.chance(0.45):
                filler.put(item, at, side, base + 0.3, "street")
            at += item.size[1] + 0.05


def _paint(plan: Plan) -> list[GroundRegion]:
    """Returns the dashed middle line of wider roads and the lines of parking bays."""
    if plan.profile.road < 6.5:
        return []
    regions: list[GroundRegion] = []

    def bar(s0: float, s1: float, t: float, half: float = 0.06) -> None:
        piece = plan.line.piece_at((s0 + s1) / 2)
        if s0 < piece.begin or s1 > piece.end or any(abs(c - (s0 + s1) / 2) < 5.0 for c in plan.crosswalks):
            return
        ring = [
            plan.line.place(s, u, piece) for s, u in ((s0, t - half), (s1, t - half), (s1, t + half), (s0, t + half))
        ]
        regions.append(GroundRegion(f"road_marking_{len(regions):03d}", "road_marking", tuple(ring), (0.0, 0.0, 0.0)))

    s = 2.0
    while s < plan.line.length - 5.0:
        bar(s, s + 3.0, 0.0)
        s += 7.5
    for side, share in ((1, plan.profile.parked_left), (-1, plan.profile.parked_right)):
        s = 6.0
        while 0.2 < share < 0.95 and plan.profile.road > 7.5 and s < plan.line.length - 6.0:
            bar(s - 0.05, s + 0.05, side * (plan.half - BAY / 2), BAY / 2)
            s += 11.0
    return regions


def _dressed(region: GroundRegion, profile: CityProfile, rng: random.Random) -> GroundRegion:
    """Returns the region with its material's descriptor; the block has one material per kind."""
    if region.kind == "road":
        material = stock.pick(profile.asphalt, rng)
    elif region.kind == "sidewalk":
        material = stock.pick(profile.paving, rng)
    elif region.kind == "ground":
        material = profile.open_ground
    else:
        return region
    descriptor = stock.ground_descriptor(region.kind, material)
    return GroundRegion(region.id, region.kind, region.polygon, region.plane, descriptor)


def _trajectory(filler: Filler) -> tuple[tuple[float, float, float, float], ...]:
    """Returns x, y, z (m) and yaw (rad) every 2.4 m, along one side and back along the other."""
    plan, length = filler.plan, filler.line.length
    stations: list[tuple[float, int, float]] = []
    drives = plan.profile.travel == "drive"
    sides = (-1, 1) if drives or len(filler.sides()) == 2 else (filler.sides()[0],) * 2
    with_street = -1 if plan.profile.drives == "right" or not drives else 1
    order = (with_street, -with_street) if len(set(sides)) == 2 else sides
    for side, back in zip(order, (False, True), strict=True):
        at, v = np.array(filler.lanes.get(side) or [(0.0, plan.width(side) / 2)]).T
        s = np.arange(STRIDE, length - 1.0, STRIDE)
        # The recording car drives in the middle of the road, where there is no traffic.
        run = [
            (float(a), side, 0.3 - plan.half if drives else float(b))
            for a, b in zip(s, np.interp(s, at, v), strict=True)
        ]
        stations += run[::-1] if back else run
    points = []
    for k, (s, side, v) in enumerate(stations):
        x, y = filler.at(s, side, v)
        ahead = math.pi if k >= len(stations) // 2 else 0.0
        z = (0.0 if drives else plan.profile.kerb) + CAMERA_HEIGHT
        points.append((round(x, 3), round(y, 3), z, round(math.remainder(filler.line.yaw(s) + ahead, math.tau), 4)))
    return tuple(points)
