"""Reads `robots.toml`, the table of robots on wheels.

In: that file, or one of the same form. Out: `Row`. When: once, at import.
"""

import dataclasses
import functools
import math
import os
import pathlib
import tomllib
from collections.abc import Callable, Mapping
from typing import Any

from ...datatypes import validation as v

FILE = pathlib.Path(__file__).with_name("robots.toml")
#: m/s, largest speed of commands: COCO's (design, section 4). Faster robots drive no faster on a pavement.
PAVEMENT_SPEED = 2.0
#: differential: two sides of wheels and casters; skid: two sides of wheels that slide in turns; ackermann: steered
#: front wheels; swerve: all wheels steered and driven; balance: two wheels and a controller that keeps it upright.
DRIVES = ("differential", "skid", "ackermann", "swerve", "balance")
STYLES = (
    *("rover", "courier", "racecar", "cart", "disc", "powerchair", "rollator", "guard", "balancer", "tracked"),
    *("kickscooter", "mobility"),
)
_REQUIRED = (
    *("title", "kind", "drive", "style", "paint", "size", "body", "mass", "centre", "top_speed", "max_yaw_rate"),
    *("wheels", "source", "typical"),
)
_OPTIONAL = ("axle", "rider", "lateral", "camera")


@dataclasses.dataclass(frozen=True)
class Box:
    """Part of the body: from x[0] to x[1] and z[0] to z[1] (m, z above the ground), and y m to both sides."""

    x: tuple[float, float]
    y: float
    z: tuple[float, float]


@dataclasses.dataclass(frozen=True)
class WheelRow:
    """A wheel, or one on each side.

    Attributes:
      x, y: m ahead of the middle and to both sides; y 0 is a single wheel.
      radius, width: m. mass: kg.
      driven: it has a motor.
      steer: rad, largest angle to both sides; 0 = not steered.
      caster: a sphere that slides without friction in place of a swivelling wheel or a wheel of rollers.
      lift: m above level ground.
    """

    x: float
    y: float
    radius: float
    width: float
    mass: float = 0.0
    driven: bool = False
    steer: float = 0.0
    caster: bool = False
    lift: float = 0.0

    def sides(self) -> tuple[tuple[str, float], ...]:
        """Names and y of its wheels."""
        return (("left", self.y), ("right", -self.y)) if self.y else (("middle", 0.0),)


@dataclasses.dataclass(frozen=True)
class Row:
    """A robot of the table; lengths in m, x ahead of its middle, z above the ground.

    Attributes:
      name: for `robots.load`.
      title, kind: what it is.
      drive: one of `DRIVES`. style: how it is drawn, one of `STYLES`. paint: (3,) colour in [0, 1].
      size: length, width, height of the robot itself.
      body: parts that collide. rider: x and height of the seat of a person who rides on it; None for nobody.
      mass: kg of everything. centre: x and z of its centre of mass.
      axle: x of the axle that is not steered.
      camera: x, y, z of its camera; None for one in front of the first part of the body.
      top_speed: m/s of the real robot, at most `PAVEMENT_SPEED` of it is used. max_yaw_rate: rad/s.
      lateral: m/s², largest sideways acceleration, above which it slows down in bends.
      wheels: see `WheelRow`.
      source: where which numbers are published. typical: the others, and why they are what they are.
      acceleration: m/s², the largest of a robot on soft legs (`robots.legged`) with skid steering; 0 for a rigid one.
    """

    name: str
    title: str
    kind: str
    drive: str
    style: str
    paint: tuple[float, ...]
    size: tuple[float, ...]
    body: tuple[Box, ...]
    mass: float
    centre: tuple[float, ...]
    top_speed: float
    max_yaw_rate: float
    wheels: tuple[WheelRow, ...]
    source: str
    typical: str
    axle: float = 0.0
    rider: tuple[float, ...] | None = None
    lateral: float = math.inf
    camera: tuple[float, ...] | None = None
    acceleration: float = 0.0

    @property
    def max_speed(self) -> float:
        """m/s, of commands."""
        return min(self.top_speed, PAVEMENT_SPEED)

    @property
    def driven(self) -> tuple[WheelRow, ...]:
        """Rows of wheels with motors."""
        return tuple(wheel for wheel in self.wheels if wheel.driven)


def read_rows(path: str | os.PathLike[str]) -> dict[str, Row]:
    """The robots of a file by name.

    Raises:
      ValidationError: the file is no TOML, or a row is incomplete or invalid.
    """
    return rows_by(_row, path)


def rows_by[T](make: Callable[[str, Any], T], path: str | os.PathLike[str]) -> dict[str, T]:
    """What `make` makes of the name and the table of each robot of a TOML file, by name.

    Raises:
      ValidationError: the file is no TOML, a name is none, or `make` refuses a table.
    """
    text = pathlib.Path(path).read_text(encoding="utf-8")
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise v.fail(str(path), f"no TOML ({error})", "a table for each robot") from error
    return {name: make(v.identifier(name, f"{path}: robot"), table) for name, table in tables.items()}


def environment_name(name: str) -> str:
    """Name of a robot's environment: HuskyNav for husky."""
    return f"{name.title().replace('_', '')}Nav"


def _row(name: str, table: Any) -> Row:
    where = f"robot {name!r}"
    m = v.mapping(table, where, _REQUIRED, _OPTIONAL)

    def vector(key: str, count: int) -> tuple[float, ...]:
        return v.vector(m[key], f"{where}.{key}", count)

    made = Row(
        name=name,
        title=v.text(m["title"], f"{where}.title"),
        kind=v.text(m["kind"], f"{where}.kind"),
        source=v.text(m["source"], f"{where}.source"),
        typical=v.text(m["typical"], f"{where}.typical"),
        drive=v.choice(m["drive"], f"{where}.drive", DRIVES),
        style=v.choice(m["style"], f"{where}.style", STYLES),
        paint=vector("paint", 3),
        size=vector("size", 3),
        body=tuple(_box(b, f"{where}.body[{i}]") for i, b in enumerate(v.items(m["body"], f"{where}.body", 1))),
        centre=vector("centre", 2),
        mass=v.number(m["mass"], f"{where}.mass", above=0.0),
        top_speed=v.number(m["top_speed"], f"{where}.top_speed", above=0.0),
        max_yaw_rate=v.number(m["max_yaw_rate"], f"{where}.max_yaw_rate", above=0.0),
        wheels=tuple(
            _wheel(w, f"{where}.wheels[{i}]") for i, w in enumerate(v.items(m["wheels"], f"{where}.wheels", 1))
        ),
        axle=v.number(m.get("axle", 0.0), f"{where}.axle"),
        camera=vector("camera", 3) if "camera" in m else None,
        rider=vector("rider", 2) if "rider" in m else None,
        lateral=v.number(m["lateral"], f"{where}.lateral", above=0.0) if "lateral" in m else math.inf,
    )
    _check(made, where)
    return made


def _check(made: Row, where: str) -> None:
    if not any(not wheel.lift for wheel in made.driven):
        raise v.fail(f"{where}.wheels", "none on the ground that is driven", "at least one with driven = true")
    steered = [wheel for wheel in made.wheels if wheel.steer]
    if bool(steered) != (made.drive in ("ackermann", "swerve")):
        found = f"{len(steered)} rows of steered wheels for the drive {made.drive!r}"
        raise v.fail(f"{where}.wheels", found, "steered wheels for ackermann and swerve, and only for these")
    if made.drive == "balance" and (len(made.wheels) != 1 or made.wheels[0].y == 0.0):
        raise v.fail(f"{where}.wheels", f"{len(made.wheels)} rows", "one pair of wheels for the drive 'balance'")
    on_wheels = sum(wheel.mass * len(wheel.sides()) for wheel in made.wheels)
    if on_wheels >= made.mass:
        raise v.fail(
            f"{where}.mass", f"{made.mass:g} kg, of which {on_wheels:g} kg are wheels", "a body that is heavier"
        )
    low = min(box.z[0] for box in made.body)
    if low <= 0.0:
        raise v.fail(f"{where}.body", f"a part {low:g} m above the ground", "parts above it; only wheels touch it")


def _box(table: Any, where: str) -> Box:
    m = v.mapping(table, where, ("x", "y", "z"))
    (x0, x1), (z0, z1) = v.vector(m["x"], f"{where}.x", 2), v.vector(m["z"], f"{where}.z", 2)
    if not (x0 < x1 and z0 < z1):
        raise v.fail(where, f"x from {x0:g} to {x1:g} and z from {z0:g} to {z1:g}", "growing pairs")
    return Box((x0, x1), v.number(m["y"], f"{where}.y", above=0.0), (z0, z1))


def _wheel(table: Any, where: str) -> WheelRow:
    m = v.mapping(table, where, ("x", "y", "radius", "width"), ("mass", "driven", "steer", "caster", "lift"))
    numbers = {key: v.number(m[key], f"{where}.{key}") for key in ("x", "y", "mass", "steer", "lift") if key in m}
    sizes = {key: v.number(m[key], f"{where}.{key}", above=0.0) for key in ("radius", "width")}
    flags = {key: v.boolean(m[key], f"{where}.{key}") for key in ("driven", "caster") if key in m}
    made = WheelRow(**numbers, **sizes, **flags)
    if made.y < 0.0 or made.lift < 0.0 or not 0.0 <= made.steer <= math.pi:
        found = f"y {made.y:g}, lift {made.lift:g}, steer {made.steer:g}"
        raise v.fail(where, found, "no negative number, and at most pi of steer")
    if made.caster == (made.mass > 0.0) or (made.caster and (made.driven or made.steer)):
        raise v.fail(where, f"caster {made.caster}, mass {made.mass:g}", "a caster, or a wheel with a mass in kg")
    return made


@functools.cache
def _rows() -> Mapping[str, Row]:
    return read_rows(FILE)


NAMES = tuple(_rows())


def row(name: str) -> Row:
    """The robot of that name, one of `NAMES`."""
    return _rows()[v.choice(name, "robot", NAMES)]
