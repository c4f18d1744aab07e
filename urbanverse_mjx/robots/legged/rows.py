"""Reads `legged.toml`, the table of robots with legs.

In: that file, or one of the same form. Out: `LeggedRow`. When: once, at import.
"""

import dataclasses
import functools
import math
import os
import pathlib
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ...datatypes import validation as v
from ...geometry import rotations
from ..catalogue.rows import PAVEMENT_SPEED, environment_name, rows_by

FILE = pathlib.Path(__file__).with_name("legged.toml")
#: gait: a trained gait moves all joints; skid: the legs are held in the standing pose, and a wheel at the end of each
#: drives.
DRIVES = ("gait", "skid")
STYLES = ("go2", "quadruped", "biped")
AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
_REQUIRED = (
    *("title", "kind", "drive", "style", "paint", "size", "camera", "top_speed", "max_yaw_rate", "step", "mount"),
    *("base", "links", "source", "typical"),
)
_OPTIONAL = ("spawn", "foot", "wheel", "walk", "lags")
#: s, lags of the speed and the yaw rate of a gait that is not measured: as the Go2's were.
GAIT_LAGS = (0.2, 0.05)
_LINK = ("name", "axis", "range", "stand", "torque", "speed", "armature", "stiffness", "damping", "mass", "centre")
_LINK_OPTIONAL = ("at", "turn", "rear_range", "rear_stand", "scale", "pose", "mirrored", "spheres")
_Vector = tuple[float, ...]


@dataclasses.dataclass(frozen=True)
class Solid:
    """A rigid part, in its own frame.

    Attributes:
      mass: kg. centre: (3,) m, its centre of mass.
      inertia: (6,) kg m² about that centre: xx, yy, zz, xy, xz, yz.
      spheres: (x, y, z, radius) m, for collision.
    """

    mass: float
    centre: _Vector
    inertia: _Vector
    spheres: tuple[_Vector, ...] = ()


@dataclasses.dataclass(frozen=True)
class Link:
    """A link of a leg with the joint and the motor that move it, as the (front) left leg has it.

    On the other side y changes its sign, and so do angles about x and z.

    Attributes:
      name: of the body; `<leg>_<name>_joint` is its joint.
      solid: see `Solid`.
      at: (3,) m, place of the joint in the parent link. turn: rad about y, the frame's angle there.
      axis: "x", "y" or "z".
      range, rear_range: rad, of a front leg and of a rear one. stand, rear_stand: rad, standing pose.
      torque: N m. speed: rad/s, of the motor at the joint. armature: kg m², inertia of its rotor there.
      stiffness: N m/rad and damping: N m s/rad of the servo.
      scale: rad, deviation from the standing pose for an action of 1. pose: weight of that deviation in training.
      mirrored: rear links mirror the front ones along x.
    """

    name: str
    solid: Solid
    at: _Vector
    turn: float
    axis: str
    range: _Vector
    rear_range: _Vector
    stand: float
    rear_stand: float
    torque: float
    speed: float
    armature: float
    stiffness: float
    damping: float
    scale: float
    pose: float
    mirrored: bool


@dataclasses.dataclass(frozen=True)
class Foot:
    """The foot of a leg, part of its last link: spheres of one radius (m) at places (3,) m, with a friction."""

    radius: float
    friction: float
    at: tuple[_Vector, ...]

    def names(self, leg: str) -> tuple[str, ...]:
        """Of the spheres of a leg's foot."""
        many = len(self.at) > 1
        return tuple(f"{leg}_foot{f'_{i}' if many else ''}" for i in range(len(self.at)))


@dataclasses.dataclass(frozen=True)
class Tyre:
    """A driven wheel at the end of a leg: its middle in the last link (3,) m, radius and width (m), mass (kg),
    principal moments of inertia (3,) kg m², friction, and the largest acceleration of the robot (m/s²)."""

    at: _Vector
    radius: float
    width: float
    mass: float
    inertia: _Vector
    friction: float
    acceleration: float


@dataclasses.dataclass(frozen=True)
class Walk:
    """What a robot practises (`envs.joystick`).

    Attributes:
      height: m, of the trunk above the ground while it walks; lowest: below which it has fallen.
      clearance: m, of a swinging foot.
      forward, aside: m/s, turn: rad/s, ranges of commands.
    """

    height: float
    lowest: float
    clearance: float
    forward: _Vector
    aside: _Vector
    turn: _Vector


@dataclasses.dataclass(frozen=True)
class Camera:
    """A camera in the base: place (3,) m, angle below the horizon (rad), vertical field of view (degrees)."""

    at: _Vector
    pitch: float
    fovy: float


@dataclasses.dataclass(frozen=True)
class LeggedRow:
    """A robot of the table: a base and equal legs, a pair of them or front and rear pairs.

    Attributes:
      name: for `robots.load`.
      title, kind: what it is.
      drive: one of `DRIVES`. style: how it is drawn, one of `STYLES`. paint: (3,) colour in [0, 1].
      size: (3,) m, length, width, height.
      camera: see `Camera`.
      spawn: m, the base's origin above level ground in the standing pose.
      top_speed: m/s, of commands to a gait or of the wheels, at most `PAVEMENT_SPEED` of it is used.
      max_yaw_rate: rad/s.
      step: m, the highest step for which routes are planned.
      mount: (3,) m, of the first joint of the front left leg in the base; x = 0 for a pair of legs.
      base, links: see `Solid`, `Link`.
      foot: of a robot with a gait. wheel: of one that drives.
      walk: see `Walk`; None for a robot that drives, and for the Go2 (`envs.joystick.config` has its task).
      lags: s, of the speed and of the yaw rate behind the commands to its gait, as measured in C MuJoCo
        (tests/evaluation/test_planner.py).
      source: where which numbers are published. typical: the others, and why they are what they are.
    """

    name: str
    title: str
    kind: str
    drive: str
    style: str
    paint: _Vector
    size: _Vector
    camera: Camera
    top_speed: float
    max_yaw_rate: float
    step: float
    mount: _Vector
    base: Solid
    links: tuple[Link, ...]
    foot: Foot | None
    wheel: Tyre | None
    walk: Walk | None
    source: str
    typical: str
    given_spawn: float | None = None
    lags: _Vector = GAIT_LAGS

    @property
    def legs(self) -> dict[str, tuple[float, float]]:
        """Name of a leg -> (+1 front, -1 rear), (+1 left, -1 right)."""
        if not self.mount[0]:
            return {"L": (1.0, 1.0), "R": (1.0, -1.0)}
        return {"FL": (1.0, 1.0), "FR": (1.0, -1.0), "RL": (-1.0, 1.0), "RR": (-1.0, -1.0)}

    @property
    def max_speed(self) -> float:
        """m/s, largest speed of commands."""
        return min(self.top_speed, PAVEMENT_SPEED)

    @property
    def mass(self) -> float:
        """kg of everything."""
        leg = sum(link.solid.mass for link in self.links) + (self.wheel.mass if self.wheel else 0.0)
        return self.base.mass + len(self.legs) * leg

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Of the legs, leg by leg; wheels have others."""
        return tuple(f"{leg}_{link.name}_joint" for leg in self.legs for link in self.links)

    @property
    def foot_names(self) -> tuple[str, ...]:
        """Of the spheres that may touch the ground, leg by leg."""
        if self.foot is None:
            return tuple(f"{leg}_wheel" for leg in self.legs)
        return tuple(name for leg in self.legs for name in self.foot.names(leg))

    @property
    def motor_speeds(self) -> tuple[float, ...]:
        """(J,) rad/s, of the joints' motors."""
        return tuple(link.speed for link in self.links) * len(self.legs)

    @property
    def stand_pose(self) -> tuple[float, ...]:
        """(J,) rad, joint angles in the order of `joint_names`."""
        pose: list[float] = []
        for front, left in self.legs.values():
            for link in self.links:
                angle = link.stand if front > 0 else link.rear_stand
                pose.append(angle if link.axis == "y" else left * angle)
        return tuple(pose)

    @property
    def spawn(self) -> float:
        """m, the base's origin above level ground: as given, or where the lowest foot touches it."""
        if self.given_spawn is not None:
            return self.given_spawn
        radius = self.foot.radius if self.foot else self._tyre.radius
        return round(max(radius - float(place[2]) for place in self.ends()), 4)

    @property
    def _tyre(self) -> Tyre:
        assert self.wheel is not None
        return self.wheel

    def ends(self) -> Iterator[np.ndarray]:
        """(3,) m in the base of every foot's sphere or wheel's middle in the standing pose."""
        angles = iter(self.stand_pose)
        for front, left in self.legs.values():
            mirror = np.array([1.0, left, 1.0])
            place, turn = np.array(self.mount) * (front, left, 1.0), np.identity(3)
            for link in self.links:
                place = place + turn @ (mirror * link.at)
                turn = turn @ _rotation("y", link.turn) @ _rotation(link.axis, next(angles))
            for at in self.foot.at if self.foot else (self._tyre.at,):
                yield place + turn @ (mirror * at)


def _rotation(axis: str, angle: float) -> np.ndarray:
    half = 0.5 * angle
    return rotations.matrix_f64(np.array([math.cos(half), *(math.sin(half) * x for x in AXES[axis])]))


def read_rows(path: str | os.PathLike[str]) -> dict[str, LeggedRow]:
    """The robots of a file by name.

    Raises:
      ValidationError: the file is no TOML, or a row is incomplete or invalid.
    """
    return rows_by(_row, path)


def joystick_name(name: str) -> str:
    """Name of the environment in which a robot learns its gait: B2Joystick for b2."""
    return environment_name(name).removesuffix("Nav") + "Joystick"


def _row(name: str, table: Any) -> LeggedRow:
    where = f"robot {name!r}"
    m = v.mapping(table, where, _REQUIRED, _OPTIONAL)
    drive = v.choice(m["drive"], f"{where}.drive", DRIVES)
    wanted = "foot" if drive == "gait" else "wheel"
    if wanted not in m or {"foot", "wheel"} <= m.keys():
        found = " and ".join(part for part in ("foot", "wheel") if part in m) or "neither foot nor wheel"
        raise v.fail(where, f"{found} for the drive {drive!r}", f"a {wanted} alone")
    links = tuple(_link(x, f"{where}.links[{i}]") for i, x in enumerate(v.items(m["links"], f"{where}.links", 1)))
    camera = v.mapping(m["camera"], f"{where}.camera", ("at", "pitch", "fovy"))
    plain: dict[str, Any] = {key: v.text(m[key], f"{where}.{key}") for key in ("title", "kind", "source", "typical")}
    plain |= {key: v.vector(m[key], f"{where}.{key}", 3) for key in ("paint", "size", "mount")}
    plain |= {key: v.number(m[key], f"{where}.{key}", above=0.0) for key in ("top_speed", "max_yaw_rate", "step")}
    return LeggedRow(
        name=name,
        **plain,
        drive=drive,
        style=v.choice(m["style"], f"{where}.style", STYLES),
        camera=Camera(
            v.vector(camera["at"], f"{where}.camera.at", 3),
            v.number(camera["pitch"], f"{where}.camera.pitch"),
            v.number(camera["fovy"], f"{where}.camera.fovy", above=0.0, maximum=179.0),
        ),
        base=_solid(v.mapping(m["base"], f"{where}.base", ("mass", "centre", "inertia", "spheres")), f"{where}.base"),
        links=links,
        foot=_foot(m["foot"], f"{where}.foot") if "foot" in m else None,
        wheel=_wheel(m["wheel"], f"{where}.wheel") if "wheel" in m else None,
        walk=_walk(m["walk"], f"{where}.walk") if "walk" in m else None,
        given_spawn=v.number(m["spawn"], f"{where}.spawn", above=0.0) if "spawn" in m else None,
        lags=v.vector(m.get("lags", GAIT_LAGS), f"{where}.lags", 2),
    )


def _solid(m: Mapping[str, Any], where: str) -> Solid:
    inertia = v.vector(m["inertia"], f"{where}.inertia", 6)
    xx, yy, zz, xy, xz, yz = inertia
    least, middle, most = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if least <= 0.0 or most > 1.001 * (least + middle):
        found = f"principal moments {least:.3g}, {middle:.3g} and {most:.3g}"
        raise v.fail(f"{where}.inertia", found, "those of a body: positive, none larger than the sum of the others")
    return Solid(
        v.number(m["mass"], f"{where}.mass", above=0.0),
        v.vector(m["centre"], f"{where}.centre", 3),
        inertia,
        tuple(v.vector(x, f"{where}.spheres[{i}]", 4) for i, x in enumerate(m.get("spheres", ()))),
    )


def _link(table: Any, where: str) -> Link:
    m = v.mapping(table, where, (*_LINK, "inertia"), _LINK_OPTIONAL)
    low, high = span = v.vector(m["range"], f"{where}.range", 2)
    stand = v.number(m["stand"], f"{where}.stand")
    rear = v.vector(m.get("rear_range", span), f"{where}.rear_range", 2)
    rear_stand = v.number(m.get("rear_stand", stand), f"{where}.rear_stand")
    for angle, (least, most) in ((stand, (low, high)), (rear_stand, rear)):
        if not least < angle < most:
            raise v.fail(f"{where}.stand", f"{angle:g} rad", f"an angle within the range {least:g} to {most:g}")
    positive = ("torque", "speed", "armature", "stiffness", "damping")
    return Link(
        name=v.identifier(m["name"], f"{where}.name"),
        solid=_solid(m, where),
        at=v.vector(m.get("at", (0.0, 0.0, 0.0)), f"{where}.at", 3),
        turn=v.number(m.get("turn", 0.0), f"{where}.turn"),
        axis=v.choice(m["axis"], f"{where}.axis", AXES),
        range=span,
        rear_range=rear,
        stand=stand,
        rear_stand=rear_stand,
        **{key: v.number(m[key], f"{where}.{key}", above=0.0) for key in positive},
        scale=v.number(m.get("scale", 0.0), f"{where}.scale", minimum=0.0),
        pose=v.number(m.get("pose", 0.0), f"{where}.pose", minimum=0.0),
        mirrored=v.boolean(m.get("mirrored", False), f"{where}.mirrored"),
    )


def _foot(table: Any, where: str) -> Foot:
    m = v.mapping(table, where, ("radius", "friction", "at"))
    places = v.items(m["at"], f"{where}.at", 1)
    return Foot(
        v.number(m["radius"], f"{where}.radius", above=0.0),
        v.number(m["friction"], f"{where}.friction", above=0.0),
        tuple(v.vector(x, f"{where}.at[{i}]", 3) for i, x in enumerate(places)),
    )


def _wheel(table: Any, where: str) -> Tyre:
    m = v.mapping(table, where, ("at", "radius", "width", "mass", "inertia", "friction", "acceleration"))
    positive = ("radius", "width", "mass", "friction", "acceleration")
    parts: dict[str, Any] = {key: v.number(m[key], f"{where}.{key}", above=0.0) for key in positive}
    parts |= {key: v.vector(m[key], f"{where}.{key}", 3) for key in ("at", "inertia")}
    return Tyre(**parts)


def _walk(table: Any, where: str) -> Walk:
    spans = ("forward", "aside", "turn")
    m = v.mapping(table, where, ("height", "lowest", "clearance", *spans))
    parts: dict[str, Any] = {key: v.vector(m[key], f"{where}.{key}", 2) for key in spans}
    parts |= {key: v.number(m[key], f"{where}.{key}", above=0.0) for key in ("height", "lowest", "clearance")}
    return Walk(**parts)


@functools.cache
def _rows() -> Mapping[str, LeggedRow]:
    return read_rows(FILE)


NAMES = tuple(_rows())


def row(name: str) -> LeggedRow:
    """The robot of that name, one of `NAMES`."""
    return _rows()[v.choice(name, "robot", NAMES)]
