"""Draws the robots with legs from their own numbers: visual geoms of their MJCF.

In: `LeggedRow`. Out: `Looks`. When: once, at construction.

The shapes are drawn for recognition, not after the makers' meshes. Geoms neither collide nor weigh anything.
"""

import dataclasses
import itertools
from collections.abc import Callable, Mapping, Sequence

from .. import go2_appearance
from .rows import LeggedRow

_Point = Sequence[float]


@dataclasses.dataclass(frozen=True)
class Looks:
    """MJCF text of materials, of the geoms of the base and of a wheel, and for the side (1 left, -1 right) of a leg
    those of its links by name."""

    materials: str
    base: str
    leg: Callable[[float], Mapping[str, str]]
    wheel: str = ""


def looks(row: LeggedRow) -> Looks:
    """How a robot is drawn."""
    return {"go2": _go2, "quadruped": _quadruped, "biped": _biped}[row.style](row)


def _geom(kind: str, material: str, size: _Point, rest: str) -> str:
    return f'<geom class="visual" type="{kind}" size="{_text(*size)}" material="{material}" {rest}/>'


def _box(material: str, at: _Point, half: _Point, pitch: float = 0.0) -> str:
    turned = f' euler="0 {pitch:.5g} 0"' if pitch else ""
    return _geom("box", material, half, f'pos="{_text(*at)}"{turned}')


def _ball(material: str, at: _Point, half: _Point) -> str:
    return _geom("ellipsoid", material, half, f'pos="{_text(*at)}"')


def _disc(material: str, at: _Point, radius: float, half: float, axis: str = "0 1 0") -> str:
    return _geom("cylinder", material, (radius, half), f'pos="{_text(*at)}" zaxis="{axis}"')


def _tube(material: str, radius: float, *points: _Point) -> str:
    ends = (f'fromto="{_text(*a)} {_text(*b)}"' for a, b in itertools.pairwise(points))
    return "".join(_geom("capsule", material, (radius,), rest) for rest in ends)


def _materials(row: LeggedRow) -> str:
    paint = f'<material name="paint" rgba="{_text(*row.paint)} 1" specular="0.4" shininess="0.4"/>'
    return f"{go2_appearance.materials()}\n    {paint}"


def _go2(row: LeggedRow) -> Looks:
    materials, base = go2_appearance.materials(), go2_appearance.base_appearance()
    if row.wheel is None:
        return Looks(materials, base, go2_appearance.leg_appearance)
    wheel, x = row.wheel, row.wheel.at[2]

    def leg(left: float) -> Mapping[str, str]:
        shapes = go2_appearance.leg_appearance(left)
        hub = _disc("joint", (0.0, 0.012 * left, x), 0.045, 0.02)
        lower = _tube("joint", 0.013, (0.004, 0, -0.01), (0.016, 0, -0.11), (0.004, 0, x))
        return {**shapes, "calf": lower + hub}

    r, half = wheel.radius, 0.5 * wheel.width
    tyre = _disc("rubber", (0, 0, 0), r, half) + _disc("shell", (0, 0, 0), 0.62 * r, half + 0.003)
    spokes = _box("joint", (0, 0, 0), (0.5 * r, half + 0.005, 0.09 * r))
    return Looks(materials, base, leg, tyre + spokes)


def _quadruped(row: LeggedRow) -> Looks:
    """A trunk between its hips, a head with a camera, motors at hips and thighs, tapered legs."""
    hip, thigh, calf = row.links
    x, y = row.mount[0], row.mount[1]
    knee, toe = calf.at, row.foot.at[0] if row.foot else (0.0, 0.0, 0.0)
    unit, foot = -knee[2], row.foot.radius if row.foot else 0.0
    wide, high = y + 0.16 * unit, 0.22 * unit
    base = "".join(
        (
            _box("paint", (0, 0, 0.1 * high), (0.86 * x, wide, 0.8 * high)),
            _box("joint", (0, 0, -0.75 * high), (0.8 * x, 0.85 * wide, 0.25 * high)),
            _ball("paint", (0, 0, 0.85 * high), (0.85 * x, 0.9 * wide, 0.45 * high)),
            *(_tube("joint", 0.18 * unit, (end, -y, 0), (end, y, 0)) for end in (x, -x)),
            _box("joint", (x + 0.22 * unit, 0, 0.1 * high), (0.13 * unit, 0.24 * unit, 0.6 * high)),
            _box("rubber", (x + 0.345 * unit, 0, 0.2 * high), (0.01, 0.2 * unit, 0.35 * high)),
            *(
                _disc("light", (x + 0.35 * unit, side * 0.14 * unit, 0.2 * high), 0.035 * unit, 0.01, "1 0 0")
                for side in (1, -1)
            ),
            _box("joint", (-x - 0.2 * unit, 0, 0.1 * high), (0.06 * unit, 0.22 * unit, 0.5 * high)),
        )
    )
    # The dome of a lidar, where a sphere of the base stands above the trunk.
    tall = [s for s in row.base.spheres if s[2] > high]
    base += "".join(
        _disc("rubber", (s[0], s[1], s[2] - 0.25 * s[3]), 0.75 * s[3], 0.5 * s[3], "0 0 1")
        + _ball("joint", (s[0], s[1], s[2] + 0.25 * s[3]), (0.72 * s[3], 0.72 * s[3], 0.45 * s[3]))
        for s in tall
    )
    out = thigh.at[1]

    def leg(left: float) -> Mapping[str, str]:
        side = left * out
        return {
            hip.name: _tube("joint", 0.17 * unit, (0, 0, 0), (0, 0.7 * side, 0))
            + _disc("paint", (0, 0.8 * side, 0), 0.22 * unit, 0.25 * out),
            thigh.name: _disc("joint", (0, 0.06 * unit * left, 0), 0.21 * unit, 0.08 * unit)
            + _tube("paint", 0.13 * unit, (0, 0, -0.15 * unit), (-0.06 * unit, 0, -0.5 * unit))
            + _tube("paint", 0.095 * unit, (-0.06 * unit, 0, -0.5 * unit), (0, 0, -0.95 * unit))
            + _disc("joint", knee, 0.11 * unit, 0.085 * unit),
            calf.name: _tube("joint", 0.06 * unit, (0, 0, 0), (0.09 * unit, 0, -0.5 * unit), toe)
            + _geom("sphere", "rubber", (foot,), f'pos="{_text(*toe)}"'),
        }

    return Looks(_materials(row), base, leg)


def _biped(row: LeggedRow) -> Looks:
    """A pelvis, a torso with shoulders, a head with a dark visor, arms bent at the elbow, legs and feet."""
    neck, shoulder = 0.37, 0.15
    arms = "".join(
        _tube("joint", 0.045, (0, side * 0.09, 0.29), (0, side * shoulder, 0.29))
        + _tube("paint", 0.042, (0, side * shoulder, 0.27), (0.0, side * shoulder, 0.14))
        + _disc("joint", (0.005, side * shoulder, 0.11), 0.042, 0.035)
        + _tube("paint", 0.033, (0.03, side * shoulder, 0.105), (0.17, side * shoulder, 0.095))
        + _ball("rubber", (0.22, side * shoulder, 0.09), (0.05, 0.022, 0.038))
        for side in (1, -1)
    )
    base = "".join(
        (
            _box("joint", (0, 0, -0.04), (0.06, 0.075, 0.05)),
            _disc("joint", (0, 0, 0.05), 0.065, 0.05, "0 0 1"),
            _ball("paint", (0.005, 0, 0.14), (0.095, 0.105, 0.09)),
            _ball("paint", (0.005, 0, 0.25), (0.11, 0.135, 0.11)),
            _box("joint", (0.105, 0, 0.24), (0.012, 0.05, 0.045)),
            _disc("joint", (0, 0, neck), 0.035, 0.03, "0 0 1"),
            _ball("paint", (0.01, 0, 0.45), (0.085, 0.075, 0.10)),
            _ball("rubber", (0.035, 0, 0.45), (0.072, 0.062, 0.082)),
            _tube("light", 0.006, (0.085, -0.05, 0.475), (0.103, 0.0, 0.48), (0.085, 0.05, 0.475)),
            arms,
        )
    )
    hip_pitch, hip_roll, hip_yaw, knee, ankle_pitch, ankle_roll = (link.name for link in row.links)

    def leg(left: float) -> Mapping[str, str]:
        mirrored = [(x, left * y, z) for x, y, z in (link.at for link in row.links)]
        soles = row.foot.at if row.foot else ()
        toe, heel = max(x for x, _, _ in soles), min(x for x, _, _ in soles)
        return {
            hip_pitch: _disc("joint", (0, 0.03 * left, 0), 0.052, 0.035)
            + _tube("joint", 0.04, (0, 0.03 * left, 0), mirrored[1]),
            hip_roll: _tube("paint", 0.055, (0.0, 0, -0.01), mirrored[2]),
            hip_yaw: _tube("paint", 0.06, (-0.01, 0, -0.03), (-0.055, 0, -0.13))
            + _disc("joint", mirrored[3], 0.055, 0.05),
            knee: _tube("paint", 0.046, (0.005, 0, -0.04), (0.012, 0, -0.12))
            + _tube("paint", 0.036, (0.012, 0, -0.12), (0, 0, -0.27)),
            ankle_pitch: _disc("joint", (0, 0, 0), 0.03, 0.032),
            ankle_roll: _box("rubber", (0.5 * (toe + heel), 0, -0.024), (0.5 * (toe - heel) + 0.01, 0.034, 0.011))
            + _tube("joint", 0.022, (-0.03, 0, -0.008), (0.05, 0, -0.012)),
        }

    return Looks(_materials(row), base, leg)


def _text(*values: float) -> str:
    return " ".join(f"{value + 0.0:.5g}" for value in values)
