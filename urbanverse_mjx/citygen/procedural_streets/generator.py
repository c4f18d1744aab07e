"""Procedural scenes, the baseline for cousins of real layouts.

The generator follows URBAN-SIM's (docs/sources/reference_systems.md a.2, e.2): five hard-coded street templates with
random sizes, filled zone by zone from fixed lists of objects, each drawn independently and placed at a random free
position. It models no city and deliberately omits groups, rows and blocked pavements.
"""

import math
import random

import shapely
from shapely.geometry.base import BaseGeometry

from ...datatypes import GraphObject, SceneGraph, Source
from ...datatypes import validation as v
from .. import catalogue, clearance
from ..composer import JOINT
from ..section import KERB_HEIGHT
from .ground import Arm, Ground, lay
from .templates import TEMPLATES, Plan

#: Scenes of the set (paper: as many as UrbanVerse-160).
COUNT = 160
#: Labels for each zone of a pavement; every draw is uniform over the list.
ZONES: dict[str, tuple[str, ...]] = {
    "kerb": (
        "tree",
        "street light",
        "lamppost",
        "trash bin",
        "bollard",
        "fire hydrant",
        "mailbox",
        "parking meter",
        "stop sign",
        "bicycle parking",
        "street cabinet",
        "newspaper stand",
    ),
    "clear": (
        "pedestrian adult",
        "pedestrian child",
        "scooter",
        "bicycle",
        "traffic cone",
        "garbage bag",
        "storage box",
        "stroller",
        "dog",
        "advertising board",
        "delivery robot",
    ),
    "front": ("bench", "potted plant", "plant pot", "chair", "table", "vending machine", "shrub", "advertising board"),
    "road": ("sedan", "hatchback car", "suv", "van", "taxi", "pickup truck", "motorcycle"),
    "plaza": ("tree", "bench", "potted plant", "street food stall", "picnic table", "pedestrian adult", "sculpture"),
}
HOUSES = (
    "apartment building",
    "house",
    "office building",
    "hotel",
    "cafe",
    "restaurant",
    "bakery",
    "convenience store",
    "pharmacy",
    "bank",
    "supermarket",
)
#: Range of objects per 10 m of one pavement; for the plaza per 100 m².
DENSITY = {"kerb": (1.0, 2.0), "clear": (0.3, 0.9), "front": (0.4, 1.0), "road": (0.2, 0.8), "plaza": (1.0, 2.0)}
#: m, distances from the kerb at which the kerb's zone begins and ends, and depth of the zone before the houses.
KERB_ZONE, FRONT_ZONE = (0.25, 1.35), 1.0
#: m, least gap between two objects, and length kept free on either side of a crosswalk's middle.
MIN_GAP, MOUTH_CLEARANCE = 0.3, 3.0
CAMERA_HEIGHT = 1.6
_TRIES = 30


def template_of(index: int) -> str:
    """Returns the name of the template of scene `index`; the templates are used in turn."""
    return list(TEMPLATES)[index % len(TEMPLATES)]


def build(index: int) -> SceneGraph:
    """Returns the graph of procedural scene `index` of `COUNT`; it is identical on every machine.

    Raises:
      ValidationError: the index is out of range.
    """
    v.integer(index, "procedural scene", 0, COUNT - 1)
    rng = random.Random(f"procedural-{index}")
    half, pavement = rng.choice((3.0, 3.5, 4.0, 5.0)), rng.choice((4.0, 4.5, 5.0, 6.0))
    name = template_of(index)
    plan = TEMPLATES[name](rng, half, pavement)
    scene = _Scene(plan, lay(plan.arms, half, pavement, plan.plaza), rng)
    scene.fill()
    source = Source(f"procedural {name}", "Apache-2.0", "none", "none")
    path = _trajectory(plan.arms[0], half + pavement / 2)
    return SceneGraph(f"procedural_{name}_{index:03d}", source, tuple(scene.objects), scene.ground.regions, None, path)


def _trajectory(arm: Arm, offset: float) -> tuple[tuple[float, float, float, float], ...]:
    """Returns a walk at eye level along the right pavement of an arm, a point every 5 m."""
    path = []
    for k in range(int((arm.free[1] - arm.free[0]) // 5) + 1):
        (x, y), (u, w) = arm.frame(arm.free[0] + 5.0 * k)
        heading = round(math.atan2(w, u), 3)
        path.append((round(x + w * offset, 3), round(y - u * offset, 3), KERB_HEIGHT + CAMERA_HEIGHT, heading))
    return tuple(path)


class _Scene:
    """A scene being filled."""

    def __init__(self, plan: Plan, ground: Ground, rng: random.Random) -> None:
        self.plan, self.ground, self.rng = plan, ground, rng
        self.objects: list[GraphObject] = []
        self._counts: dict[str, int] = {}
        self._taken: list[BaseGeometry] = []
        self._fronts: list[BaseGeometry] = []
        self._built = shapely.union_all([ground.walk, ground.road]).buffer(-0.02)
        self._middle = ground.walk.buffer(-0.1, join_style="mitre")

    def fill(self) -> None:
        self._houses()
        for zone in ("kerb", "front", "clear", "road"):
            for arm in self.plan.arms:
                for side in (1, -1):
                    per_10_m = self.rng.uniform(*DENSITY[zone])
                    for _ in range(round(per_10_m * (arm.free[1] - arm.free[0]) / 10.0)):
                        self._put_in_zone(zone, arm, side)
        if self.plan.plaza is not None:
            self._fill_plaza(self.plan.plaza)

    def _houses(self) -> None:
        """Places houses without gaps along both sides of each arm and across its closed ends. A house that would stand
        on a street or in another house is left out; one beside a plaza stands behind it."""
        front, plaza = self.plan.half + self.plan.pavement, self.plan.plaza
        for arm in self.plan.arms:
            for side in (1, -1):
                s = arm.free[0]
                while s < arm.free[1]:
                    label, size = self._some_house()
                    depth, width, _ = size
                    (x, y), (u, w) = arm.frame(min(s + width / 2, arm.line.length))
                    out = (-w * side, u * side)
                    reach = front + depth / 2 + JOINT
                    if plaza is not None and plaza.intersects(shapely.Point(x + out[0] * reach, y + out[1] * reach)):
                        reach += plaza.bounds[3] - front
                    self._house(label, x + out[0] * reach, y + out[1] * reach, (-out[0], -out[1]), size)
                    s += width + JOINT
            for at_end in (False, True):
                if arm.closed[at_end]:
                    self._close(arm, at_end, front)

    def _close(self, arm: Arm, at_end: bool, front: float) -> None:
        """Places houses across an end of an arm, facing along it."""
        (x, y), (u, w) = arm.frame(arm.line.length if at_end else 0.0)
        facing = (-u, -w) if at_end else (u, w)
        t = -front
        while t < front:
            label, size = self._some_house()
            middle, away = t + size[1] / 2, size[0] / 2 + JOINT
            self._house(label, x - w * middle - facing[0] * away, y + u * middle - facing[1] * away, facing, size)
            t += size[1] + JOINT

    def _some_house(self) -> tuple[str, catalogue.Size]:
        label = self.rng.choice(HOUSES)
        return label, self.rng.choice(catalogue.SIZES[label])

    def _house(self, label: str, x: float, y: float, facing: tuple[float, float], size: catalogue.Size) -> None:
        obj = self._make(label, x, y, math.atan2(facing[1], facing[0]), size)
        shape = clearance.footprint(obj)
        if not shape.intersects(self._built) and not any(shape.intersects(t) for t in self._fronts):
            self._fronts.append(shape)
            self._add(obj)

    def _put_in_zone(self, zone: str, arm: Arm, side: int) -> None:
        label = self.rng.choice(ZONES[zone])
        size = self._size_of(label)
        for _ in range(_TRIES):
            s = self.rng.uniform(*arm.free)
            if min((abs(s - c) for c in arm.crosswalks), default=math.inf) < MOUTH_CLEARANCE + size[0] / 2 * (
                zone == "road"
            ):
                continue
            (x, y), (u, w) = arm.frame(s)
            out, along = (-w * side, u * side), math.atan2(w, u)
            yaw = self._yaw(zone, along, math.atan2(out[1], out[0]), side)
            trial = self._make(label, 0.0, 0.0, yaw, size)
            offset = self._offset(zone, trial, out)
            if offset is None:
                continue
            offset += self.plan.half
            if self._try(self._make(label, x + out[0] * offset, y + out[1] * offset, yaw, size), zone):
                return

    def _yaw(self, zone: str, along: float, out: float, side: int) -> float:
        if zone == "road":  # headed with the traffic of its side, which drives on the right
            return along + (math.pi if side > 0 else 0.0) + self.rng.uniform(-0.03, 0.03)
        if zone == "front":
            return out + math.pi
        return self.rng.uniform(-math.pi, math.pi) if zone == "clear" else out + math.pi * self.rng.randint(0, 1)

    def _offset(self, zone: str, trial: GraphObject, out: tuple[float, float]) -> float | None:
        """Returns a distance (m) from the kerb to an object's middle that keeps it in its zone, or None if it does not
        fit."""
        reach = max(abs(x * out[0] + y * out[1]) for x, y in clearance.footprint(trial).exterior.coords)
        width = self.plan.pavement
        bounds = {
            "kerb": KERB_ZONE,
            "front": (width - FRONT_ZONE, width - 0.05),
            "clear": (KERB_ZONE[1] + MIN_GAP, width - FRONT_ZONE - MIN_GAP),
            "road": (-0.4 - 2 * reach, -0.2),
        }
        low, high = bounds[zone][0] + reach, bounds[zone][1] - reach
        if low > high:
            return None
        if zone == "clear":  # to one edge of its zone, so that a robot can pass on the other
            if high - low < clearance.CLEARANCE:
                return None
            return low if self.rng.random() < 0.5 else high
        return self.rng.uniform(low, high)

    def _try(self, obj: GraphObject, zone: str) -> bool:
        shape = clearance.footprint(obj)
        if not (self.ground.road if zone == "road" else self._middle).contains(shape):
            return False
        # A robot must be able to pass between two objects on one pavement, unless they stand in line along its edges.
        reach = clearance.CLEARANCE if zone == "clear" else MIN_GAP
        if shape.buffer(reach).intersects(self._close_by(shape, reach)):
            return False
        self._taken.append(shape)
        self._add(obj)
        return True

    def _close_by(self, shape: BaseGeometry, reach: float) -> BaseGeometry:
        return shapely.union_all([t for t in self._taken if t.distance(shape) <= reach])

    def _fill_plaza(self, plaza: shapely.Polygon) -> None:
        x0, y0, x1, y1 = plaza.bounds
        fountain = self._make("fountain", (x0 + x1) / 2, (y0 + y1) / 2, 0.0, self._size_of("fountain"))
        self._taken.append(clearance.footprint(fountain))
        self._add(fountain)
        for _ in range(round(self.rng.uniform(*DENSITY["plaza"]) * plaza.area / 100.0)):
            label = self.rng.choice(ZONES["plaza"])
            size = self._size_of(label)
            for _ in range(_TRIES):
                place = self.rng.uniform(x0 + 2.5, x1 - 2.5), self.rng.uniform(y0 + 2.5, y1 - 2.5)
                if self._try(self._make(label, *place, self.rng.uniform(-math.pi, math.pi), size), "clear"):
                    break

    def _size_of(self, label: str) -> catalogue.Size:
        if label == "tree":
            return self.rng.choice(list(catalogue.TREES.values()))
        return self.rng.choice(catalogue.SIZES[label])

    def _make(self, label: str, x: float, y: float, yaw: float, size: tuple[float, float, float]) -> GraphObject:
        """Returns an object with its stem, or its middle where it has none, at (x, y)."""
        ground = 0.0 if self.ground.road.contains(shapely.Point(x, y)) else KERB_HEIGHT
        stem = catalogue.STEMS.get(label)
        if stem:
            ahead = stem.offset * size[0] / 2
            x, y = x - ahead * math.cos(yaw), y - ahead * math.sin(yaw)
        name = f"{label.replace(' ', '_')}_{self._counts.get(label, 0):02d}"
        centre = (round(x, 3), round(y, 3), round(ground + size[2] / 2, 4))
        return GraphObject(name, label, centre, size, round(math.remainder(yaw, math.tau), 3))

    def _add(self, obj: GraphObject) -> None:
        self._counts[obj.label] = self._counts.get(obj.label, 0) + 1
        self.objects.append(obj)
