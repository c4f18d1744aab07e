"""The five hard-coded street templates of procedural scenes, with random lengths, radii and turns."""

import dataclasses
import math
import random
from collections.abc import Callable

import shapely

from .ground import Arm


@dataclasses.dataclass(frozen=True)
class Plan:
    """Layout of the streets of a scene.

    Attributes:
      arms: stretches of street.
      half: m, half a carriageway.
      pavement: m, width of the pavements.
      plaza: open ground beside a street, or None.
    """

    arms: tuple[Arm, ...]
    half: float
    pavement: float
    plaza: shapely.Polygon | None = None


def _straight(rng: random.Random, half: float, pavement: float) -> Plan:
    length = round(rng.uniform(150.0, 190.0), 1)
    crossings = tuple(round(length * share, 1) for share in (0.3, 0.7))
    return Plan((Arm(((0.0, 0.0), (length, 0.0)), (0.0, length), crossings),), half, pavement)


def _curve(rng: random.Random, half: float, pavement: float) -> Plan:
    """Returns a straight leg, an arc in steps of 10 degrees, and another leg."""
    leg, radius, turn = rng.uniform(55.0, 75.0), rng.uniform(18.0, 30.0), rng.choice((-1, 1)) * rng.randint(4, 9)
    side = 1 if turn > 0 else -1
    points = [(0.0, 0.0), (leg, 0.0)]
    for k in range(1, abs(turn) + 1):
        angle = math.radians(10.0 * k)
        points.append((leg + radius * math.sin(angle), side * radius * (1 - math.cos(angle))))
    end, angle = points[-1], math.radians(10.0 * turn)
    points.append((end[0] + leg * math.cos(angle), end[1] + leg * math.sin(angle)))
    ring = tuple((round(x, 3), round(y, 3)) for x, y in points)
    length = shapely.LineString(ring).length
    return Plan((Arm(ring, (0.0, length), (round(leg * 0.4, 1),)),), half, pavement)


def _tee(rng: random.Random, half: float, pavement: float) -> Plan:
    """Returns a main street and one that ends on it from the left."""
    arm, stem = round(rng.uniform(60.0, 75.0), 1), round(rng.uniform(50.0, 65.0), 1)
    edge = half + pavement
    main = [Arm(((0.0, 0.0), (side * arm, 0.0)), (edge, arm), (edge + 3.0,), (False, True)) for side in (-1, 1)]
    return Plan((*main, Arm(((0.0, 0.0), (0.0, stem)), (edge, stem), (edge + 3.0,), (False, True))), half, pavement)


def _crossing(rng: random.Random, half: float, pavement: float) -> Plan:
    edge = half + pavement
    arms = []
    for x, y in ((1, 0), (0, 1), (-1, 0), (0, -1)):
        length = round(rng.uniform(45.0, 60.0), 1)
        arms.append(Arm(((0.0, 0.0), (x * length, y * length)), (edge, length), (edge + 3.0,), (False, True)))
    return Plan(tuple(arms), half, pavement)


def _square(rng: random.Random, half: float, pavement: float) -> Plan:
    """Returns a street with a plaza on its left."""
    plan = _straight(rng, half, pavement)
    length = plan.arms[0].free[1]
    width, depth = round(rng.uniform(30.0, 45.0), 1), round(rng.uniform(22.0, 32.0), 1)
    x, y = round((length - width) / 2, 1), half + pavement
    return dataclasses.replace(plan, plaza=shapely.box(x, y - 1.0, x + width, y + depth))


TEMPLATES: dict[str, Callable[[random.Random, float, float], Plan]] = {
    "straight": _straight,
    "curve": _curve,
    "tee": _tee,
    "crossing": _crossing,
    "plaza": _square,
}
