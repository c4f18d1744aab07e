"""Draws the robots of the table from their own numbers: visual geoms of their MJCF.

In: `Row`, the height of its root. Out: MJCF text. When: once, at construction.

The shapes are drawn for recognition, not after the makers' meshes.
"""

import itertools
import math
from collections.abc import Callable, Sequence

from .rows import Box, Row

_COLOURS = {
    "tyre": "0.05 0.05 0.05",
    "hub": "0.62 0.64 0.66",
    "dark": "0.13 0.13 0.14",
    "metal": "0.55 0.57 0.60",
    "white": "0.93 0.93 0.93",
    "seat": "0.08 0.08 0.09",
    "lamp": "1.0 0.95 0.7",
    "red": "0.80 0.06 0.05",
    "orange": "1.0 0.45 0.05",
    "blue": "0.15 0.35 0.85",
    "glass": "0.05 0.10 0.16",
    "coat": "0.25 0.36 0.52",
    "trousers": "0.22 0.21 0.20",
    "skin": "0.80 0.62 0.50",
    "hair": "0.35 0.30 0.27",
}
MATERIALS = "".join(f'<material name="{name}" rgba="{rgb} 1"/>' for name, rgb in _COLOURS.items())
_Point = Sequence[float]


class _Sketch:
    """Collects visual geoms; heights are given above the ground."""

    def __init__(self, row: Row, root: float) -> None:
        self.row, self.root = row, root
        self.lines: list[str] = []
        self.meshes: list[str] = []

    def _add(self, kind: str, material: str, rest: str) -> None:
        self.lines.append(f'<geom class="visual" type="{kind}" material="{material}" {rest}/>')

    def box(self, material: str, at: _Point, half: _Point, turn: _Point = (0.0, 0.0, 0.0)) -> None:
        """A box with its centre and half sizes (m), turned about x, y, z (rad)."""
        euler = f' euler="{_text(*turn)}"' if any(turn) else ""
        self._add("box", material, f'pos="{self._at(at)}" size="{_text(*half)}"{euler}')

    def ball(self, material: str, at: _Point, half: _Point) -> None:
        """An ellipsoid."""
        self._add("ellipsoid", material, f'pos="{self._at(at)}" size="{_text(*half)}"')

    def disc(self, material: str, at: _Point, radius: float, half: float, axis: str = "0 0 1") -> None:
        """A cylinder."""
        self._add("cylinder", material, f'pos="{self._at(at)}" size="{_text(radius, half)}" zaxis="{axis}"')

    def tube(self, material: str, radius: float, *points: _Point) -> None:
        """Capsules along a line."""
        for a, b in itertools.pairwise(points):
            if math.dist(a, b) < 1e-3:
                continue
            ends = f"{self._at(a)} {self._at(b)}"
            self._add("capsule", material, f'fromto="{ends}" size="{_text(radius)}"')

    def both(self, material: str, radius: float, *points: _Point) -> None:
        """Capsules along a line and along its mirror image on the other side."""
        self.tube(material, radius, *points)
        self.tube(material, radius, *((x, -y, z) for x, y, z in points))

    def bullet(self, material: str, rings: Sequence[tuple[float, float, float]], corners: int = 32) -> None:
        """A convex body through ellipses (height, half length, half width)."""
        turn = [2.0 * math.pi * k / corners for k in range(corners)]
        points = [(x * math.cos(a), y * math.sin(a), z - self.root) for z, x, y in rings for a in turn]
        name = f"mesh_{len(self.meshes)}"
        self.meshes.append(f'<mesh name="{name}" vertex="{" ".join(_text(*point) for point in points)}"/>')
        self.lines.append(f'<geom class="visual" type="mesh" mesh="{name}" material="{material}"/>')

    def shell(self, material: str, box: Box, edge: float) -> None:
        """A box whose upright edges and whose upper rim are rounded by `edge` m."""
        (x0, x1), y, (z0, z1) = box.x, box.y, box.z
        edge = min(edge, 0.49 * (x1 - x0), 0.49 * 2 * y, 0.9 * (z1 - z0))
        middle, low, top = 0.5 * (x0 + x1), 0.5 * (z0 + z1 - edge), z1 - edge
        half = 0.5 * (x1 - x0)
        self.box(material, (middle, 0, low), (half - edge, y, low - z0))
        self.box(material, (middle, 0, low), (half, y - edge, low - z0))
        self.box(material, (middle, 0, 0.5 * (z0 + z1)), (half - edge, y - edge, 0.5 * (z1 - z0)))
        for side in (-1, 1):
            for end in (x0 + edge, x1 - edge):
                self.tube(material, edge, (end, side * (y - edge), z0 + edge), (end, side * (y - edge), top))
            self.tube(material, edge, (x0 + edge, side * (y - edge), top), (x1 - edge, side * (y - edge), top))
        for end in (x0 + edge, x1 - edge):
            self.tube(material, edge, (end, edge - y, top), (end, y - edge, top))

    def mast(self, camera: _Point) -> None:
        """A mast below a camera that is higher than the body, and the camera itself."""
        x, y, z = camera
        top = max(box.z[1] for box in self.row.body)
        x -= 0.05
        if z > top + 0.02 and not y:
            foot = min(x, self.row.body[0].x[1] - 0.03)
            self.tube("dark", 0.012, (foot, 0, top - 0.01), (foot, 0, z - 0.015), (x, 0, z - 0.015))
        self.box("dark", (x, y, z), (0.018, 0.045, 0.016))
        self.disc("glass", (x + 0.02, y, z), 0.011, 0.004, "1 0 0")

    def person(self, x: float, seat: float) -> None:
        """A person on a seat, with the hands before the body."""
        legs = ((x - 0.02, 0.09, seat + 0.06), (x + 0.34, 0.10, seat + 0.05), (x + 0.38, 0.10, seat - 0.30))
        self.both("trousers", 0.065, *legs)
        self.both("seat", 0.04, (x + 0.38, 0.10, seat - 0.34), (x + 0.46, 0.10, seat - 0.35))
        self.ball("coat", (x - 0.04, 0, seat + 0.32), (0.13, 0.19, 0.31))
        self.tube("coat", 0.07, (x - 0.05, 0.14, seat + 0.53), (x - 0.05, -0.14, seat + 0.53))
        self.both("coat", 0.045, (x - 0.04, 0.21, seat + 0.50), (x + 0.06, 0.23, seat + 0.24))
        self.both("coat", 0.038, (x + 0.06, 0.23, seat + 0.24), (x + 0.28, 0.18, seat + 0.26))
        self.both("skin", 0.035, (x + 0.30, 0.17, seat + 0.26), (x + 0.32, 0.17, seat + 0.26))
        self.tube("skin", 0.045, (x - 0.04, 0, seat + 0.58), (x - 0.03, 0, seat + 0.66))
        self.ball("skin", (x - 0.01, 0, seat + 0.74), (0.09, 0.078, 0.115))
        self.ball("hair", (x - 0.035, 0, seat + 0.77), (0.092, 0.084, 0.10))

    def seat(self, x: float, height: float, back: float) -> None:
        """A seat with a back and arm rests."""
        self.box("seat", (x, 0, height - 0.04), (0.22, 0.21, 0.035))
        self.box("seat", (x - 0.21, 0, height + back / 2), (0.03, 0.20, back / 2), (0, -0.12, 0))
        for y in (0.24, -0.24):
            self.box("seat", (x, y, height + 0.19), (0.15, 0.028, 0.018))
            self.tube("dark", 0.012, (x - 0.10, y, height + 0.18), (x - 0.10, 0.9 * y, height - 0.04))

    def _at(self, point: _Point) -> str:
        return _text(point[0], point[1], point[2] - self.root)


def draw(row: Row, root: float, camera: _Point) -> tuple[list[str], list[str]]:
    """Visual geoms of a robot, and the meshes that they need.

    Args:
      root: m, height of the root body's origin above the ground.
      camera: (3,) m of its camera, z above the ground.
    """
    sketch = _Sketch(row, root)
    _STYLES[row.style](sketch)
    for wheel in row.wheels:
        for _, y in wheel.sides() if wheel.caster else ():
            centre = (wheel.x, y, wheel.radius + wheel.lift)
            sketch.disc("tyre", centre, wheel.radius, wheel.width / 2, "0 1 0")
            sketch.disc("hub", centre, 0.5 * wheel.radius, wheel.width / 2 + 0.003, "0 1 0")
            sketch.box("dark", (wheel.x, y, 2.0 * wheel.radius), (0.4 * wheel.radius, wheel.width / 2 + 0.008, 0.01))
    sketch.mast(camera)
    if row.rider is not None:
        sketch.person(*row.rider)
    return sketch.lines, sketch.meshes


def _rover(s: _Sketch) -> None:
    box = s.row.body[0]
    (x0, x1), (z0, z1), middle = box.x, box.z, 0.5 * sum(box.x)
    lower = z0 + 0.45 * (z1 - z0)
    s.box("dark", (middle, 0, 0.5 * (z0 + lower)), (0.5 * (x1 - x0) - 0.02, box.y - 0.01, 0.5 * (lower - z0)))
    s.shell("paint", Box((x0 + 0.02, x1 - 0.02), box.y, (lower, z1 - 0.02)), 0.03)
    s.box("dark", (middle, 0, z1 - 0.01), (0.36 * (x1 - x0), 0.8 * box.y, 0.01))
    wide = s.row.driven[0].y
    for wheel in s.row.wheels:  # axles
        s.disc("metal", (wheel.x, 0, wheel.radius), 0.12 * wheel.radius, wide, "0 1 0")
    for end in (x0, x1):
        s.tube("dark", 0.018, (end, -0.9 * wide, z0 + 0.03), (end, 0.9 * wide, z0 + 0.03))
        s.box("dark", (0.5 * (end + middle) + 0.5 * (end - middle) * 0.9, 0, z0 + 0.03), (0.03, 0.06, 0.012))
    for y in (-0.7 * box.y, 0.7 * box.y):
        s.box("lamp", (x1 - 0.015, y, 0.5 * (lower + z1)), (0.008, 0.025, 0.015))
        s.box("red", (x0 + 0.015, y, 0.5 * (lower + z1)), (0.008, 0.025, 0.015))


def _courier(s: _Sketch) -> None:
    box = s.row.body[0]
    (x0, x1), (z0, z1) = box.x, box.z
    lid = z1 - 0.13
    s.shell("paint", Box(box.x, box.y, (z0 + 0.05, lid)), 0.09)
    s.box("dark", (0, 0, z0 + 0.03), (0.5 * (x1 - x0) - 0.03, box.y + 0.01, 0.03))
    s.box("dark", (0, 0, lid - 0.05), (0.5 * (x1 - x0) - 0.055, box.y + 0.004, 0.012))
    s.shell("white", Box((x0 + 0.02, x1 - 0.02), box.y - 0.015, (lid - 0.08, z1)), 0.08)
    s.box("glass", (x1 - 0.005, 0, lid - 0.11), (0.012, 0.12, 0.035))
    for y in (-0.14, 0.14):
        s.box("lamp", (x1 - 0.01, y, z0 + 0.10), (0.012, 0.03, 0.012))
        s.box("red", (x0 + 0.01, y, z0 + 0.10), (0.012, 0.03, 0.012))
    s.tube("dark", 0.006, (x0 + 0.05, 0.15, lid), (x0 + 0.05, 0.15, 1.15))
    s.box("orange", (x0 - 0.02, 0.15, 1.09), (0.07, 0.003, 0.055))
    for y in (-0.19, 0.19):
        s.tube("dark", 0.014, (s.row.wheels[0].x, y, 0.10), (0.10, y, 0.20), (0.0, y, 0.10))
        s.tube("dark", 0.014, (s.row.wheels[2].x, y, 0.10), (-0.14, y, 0.20))


def _racecar(s: _Sketch) -> None:
    box = s.row.body[0]
    (x0, x1), z0 = box.x, box.z[0]
    s.box("dark", (0, 0, z0 + 0.01), (0.5 * (x1 - x0), 0.75 * box.y, 0.01))
    s.box("paint", (0.0, 0, z0 + 0.045), (0.5 * (x1 - x0) - 0.03, box.y - 0.01, 0.025))
    s.box("paint", (x1 - 0.09, 0, z0 + 0.05), (0.10, 0.55 * box.y, 0.018), (0, 0.12, 0))
    s.box("glass", (-0.03, 0, z0 + 0.085), (0.10, 0.72 * box.y, 0.02))
    s.box("dark", (x1 - 0.01, 0, z0 + 0.012), (0.03, 0.145, 0.006))
    for y in (-0.10, 0.10):
        s.box("dark", (x0 + 0.02, y, z0 + 0.10), (0.03, 0.004, 0.045))
    s.box("paint", (x0 + 0.02, 0, z0 + 0.145), (0.045, 0.12, 0.005), (0, -0.15, 0))
    s.disc("dark", (0.06, 0, z0 + 0.12), 0.03, 0.022)
    for wheel in s.row.wheels:
        s.disc("metal", (wheel.x, 0, wheel.radius), 0.007, wheel.y, "0 1 0")


def _cart(s: _Sketch) -> None:
    box = s.row.body[0]
    (x0, x1), (z0, z1), middle = box.x, box.z, 0.5 * sum(box.x)
    half = 0.5 * (x1 - x0)
    s.box("dark", (middle, 0, z0 + 0.25 * (z1 - z0)), (half - 0.03, box.y - 0.015, 0.25 * (z1 - z0)))
    s.shell("paint", Box(box.x, box.y, (z0 + 0.3 * (z1 - z0), z1 - 0.012)), min(0.05, 0.3 * (z1 - z0)))
    s.box("dark", (middle, 0, z1 - 0.006), (half - 0.05, 0.85 * box.y, 0.006))
    strip = z0 + 0.55 * (z1 - z0)
    for x in (x0, x1):
        s.box("glass", (x, 0, strip), (0.004, 0.7 * box.y, 0.018))
    for y in (-box.y, box.y):
        s.box("blue", (middle, y, strip), (0.7 * half, 0.003, 0.008))
    s.disc("dark", (x1 - 0.08, 0, z1 + 0.015), 0.035, 0.02)
    if box.y < 0.8 * s.row.driven[0].y:  # a narrow body between its wheels
        for wheel in s.row.wheels:
            s.tube("metal", 0.02, (wheel.x, -wheel.y, z0 + 0.03), (wheel.x, wheel.y, z0 + 0.03))
            for _, y in wheel.sides() if wheel.steer else ():
                s.disc("metal", (wheel.x, y, 2 * wheel.radius + 0.03), 0.05, 0.03)


def _round(s: _Sketch) -> None:
    box = s.row.body[0]
    radius, (z0, z1) = box.y, box.z
    s.disc("dark", (0, 0, z0 + 0.04), radius - 0.01, 0.04)
    s.disc("paint", (0, 0, 0.5 * (z0 + 0.08 + z1 - 0.05)), radius, 0.5 * (z1 - z0 - 0.13))
    s.disc("dark", (0, 0, z1 - 0.045), radius - 0.01, 0.008)
    s.disc("paint", (0, 0, z1 - 0.02), radius - 0.02, 0.02)
    s.disc("metal", (0, 0, z1 + 0.004), 0.12, 0.006)
    s.box("glass", (radius - 0.012, 0, z0 + 0.12), (0.015, 0.10, 0.02))


def _powerchair(s: _Sketch) -> None:
    assert s.row.rider is not None
    x, seat = s.row.rider
    s.seat(x, seat, 0.46)
    for y in (-0.20, 0.20):  # the arch of the frame on both sides
        frame = ((-0.32, y, 0.16), (-0.26, y, 0.40), (x + 0.16, y, seat - 0.06), (0.30, y, 0.17))
        s.tube("paint", 0.028, *frame)
        s.tube("paint", 0.028, frame[0], frame[-1])
        s.tube("paint", 0.022, (x, y * 1.2, seat - 0.03), (x + 0.15, y * 1.25, seat + 0.16))
    s.box("dark", (-0.10, 0, 0.24), (0.18, 0.15, 0.09))
    s.box("dark", (0.36, 0, 0.10), (0.10, 0.15, 0.012))
    for y in (-0.245, 0.245):  # rollers of the omni wheels
        for k in range(8):
            a = k * math.pi / 4
            s.disc("white", (0.30 + 0.105 * math.cos(a), y, 0.1325 + 0.105 * math.sin(a)), 0.014, 0.034, "0 1 0")


def _rollator(s: _Sketch) -> None:
    for y in (-0.25, 0.25):
        s.tube("paint", 0.014, (-0.22, y, 0.12), (-0.10, y, 0.50), (-0.16, y, 0.84), (-0.30, y, 0.86))
        s.tube("paint", 0.014, (0.24, 0.95 * y, 0.20), (0.10, 0.95 * y, 0.56), (-0.13, y, 0.66))
        s.tube("seat", 0.021, (-0.22, y, 0.855), (-0.33, y, 0.865))
        s.tube("dark", 0.006, (-0.30, 0.9 * y, 0.80), (-0.20, 0.95 * y, 0.80))
    s.tube("paint", 0.012, (-0.11, -0.25, 0.60), (-0.11, 0.25, 0.60))
    s.tube("paint", 0.012, (0.18, -0.24, 0.36), (0.18, 0.24, 0.36))
    s.tube("seat", 0.025, (-0.19, -0.20, 0.80), (-0.19, 0.20, 0.80))
    s.box("seat", (0.02, 0, 0.585), (0.11, 0.20, 0.015))
    s.box("dark", (0.20, 0, 0.40), (0.09, 0.17, 0.008))
    for y in (-0.17, 0.17):
        s.box("metal", (0.20, y, 0.49), (0.09, 0.004, 0.08))
    for x in (0.11, 0.29):
        s.box("metal", (x, 0, 0.49), (0.004, 0.17, 0.08))
    s.box("dark", (-0.02, 0, 0.28), (0.12, 0.17, 0.06))
    s.box("dark", (-0.20, 0, 0.12), (0.04, 0.22, 0.035))
    s.box("glass", (0.30, 0, 0.32), (0.02, 0.08, 0.03))


def _guard(s: _Sketch) -> None:
    low, top = s.row.body[0], s.row.body[-1].z[1]
    z0, half, wide = low.z[0], low.x[1], low.y
    share = (
        (0.0, 0.92),
        (0.05, 1.0),
        (0.30, 0.97),
        (0.55, 0.84),
        (0.75, 0.68),
        (0.88, 0.52),
        (0.96, 0.34),
        (1.0, 0.10),
    )
    s.bullet("paint", [(z0 + z * (top - z0), half * r, wide * r) for z, r in share])
    s.box("dark", (0, 0, z0), (0.33, 0.26, 0.03))
    for z, r in ((0.62, 0.80), (0.80, 0.635)):
        at = z0 + z * (top - z0)
        s.bullet(
            "glass",
            [
                (at, half * r + 0.006, wide * r + 0.006),
                (at + 0.05, half * (r - 0.03) + 0.006, wide * (r - 0.03) + 0.006),
            ],
        )
    s.bullet("blue", [(0.30, half * 1.0, wide * 1.0), (0.325, half * 1.0, wide * 1.0)])
    s.box("glass", (0.352, 0, 0.74), (0.02, 0.09, 0.11), (0, -0.22, 0))
    for y in (-0.09, 0.09):
        s.disc("glass", (0.225, y, 1.30), 0.03, 0.02, "1 0 0.3")


def _balancer(s: _Sketch) -> None:
    base, head = s.row.body
    wheel = s.row.wheels[0]
    s.disc("metal", (0, 0, wheel.radius), 0.05, wheel.y, "0 1 0")
    s.shell("dark", Box((-0.19, 0.19), 0.20, (base.z[0] + 0.02, base.z[1])), 0.05)
    s.box("tyre", (0, 0, base.z[1] + 0.005), (0.17, 0.17, 0.006))
    for x in (-0.10, 0.10):
        s.both("metal", 0.014, (x, 0.13, base.z[1]), (x, 0.10, head.z[0] + 0.02))
    s.shell("white", Box((-0.12, 0.12), 0.12, (head.z[0], head.z[1] - 0.03)), 0.03)
    s.disc("blue", (0.0, 0, head.z[1] - 0.015), 0.06, 0.012)
    s.box("glass", (0.12, 0, 0.5 * sum(head.z)), (0.004, 0.09, 0.06))
    for y in (-1, 1):
        for x, turn in ((-0.14, -0.6), (0.0, 0.0), (0.14, 0.6)):
            z = wheel.radius + math.sqrt((wheel.radius + 0.02) ** 2 - x * x)
            s.box("dark", (x, y * (wheel.y - 0.01), z), (0.085, 0.055, 0.007), (0, turn, 0))


def _tracked(s: _Sketch) -> None:
    box, wheels = s.row.body[0], s.row.wheels
    first, last, radius, y = wheels[0].x, wheels[-1].x, wheels[0].radius, wheels[0].y
    half = wheels[0].width / 2
    for side in (-y, y):
        for z in (0.006, 2 * radius - 0.006):
            s.box("tyre", (0.5 * (first + last), side, z), (0.5 * (first - last), half, 0.008))
        for x in (first, last):
            s.disc("tyre", (x, side, radius), radius + 0.002, half - 0.002, "0 1 0")
        for k in range(9):  # cleats
            x = last + (first - last) * k / 8
            for z in (0.004, 2 * radius + 0.004):
                s.box("dark", (x, side, z), (0.006, half + 0.002, 0.006))
        outer = side + math.copysign(0.055, side)
        tip = (first + 0.13, outer, radius + 0.075)
        for z in (-0.032, 0.032):
            s.tube("tyre", 0.009, (first - 0.02, outer, radius + 1.7 * z), (tip[0], outer, tip[2] + z))
        s.disc("tyre", tip, 0.04, 0.016, "0 1 0")
        s.box("dark", (first + 0.06, outer, radius + 0.037), (0.075, 0.008, 0.03), (0, -0.5, 0))
    s.shell("paint", box, 0.02)
    s.box("metal", (0, 0, box.z[1] + 0.006), (0.12, 0.08, 0.006))
    s.tube("orange", 0.008, (-0.15, -0.07, 0.18), (-0.15, -0.07, 0.24), (-0.15, 0.07, 0.24), (-0.15, 0.07, 0.18))
    for side in (-0.06, 0.06):
        s.box("lamp", (box.x[1], side, 0.13), (0.004, 0.02, 0.012))


def _kickscooter(s: _Sketch) -> None:
    s.box("dark", (-0.04, 0, 0.14), (0.38, 0.085, 0.035))
    s.box("tyre", (-0.04, 0, 0.178), (0.34, 0.075, 0.004))
    s.box("paint", (-0.04, 0.086, 0.14), (0.36, 0.004, 0.02))
    s.box("paint", (-0.04, -0.086, 0.14), (0.36, 0.004, 0.02))
    for y in (-0.045, 0.045):
        s.tube("dark", 0.015, (-0.38, y, 0.14), (-0.45, y, 0.127))
    s.box("dark", (-0.47, 0, 0.275), (0.12, 0.035, 0.008), (0, 0.35, 0))
    s.tube("dark", 0.03, (0.30, 0, 0.14), (0.40, 0, 0.26))
    s.tube("metal", 0.022, (0.42, -0.12, 0.15), (0.40, 0, 0.26), (0.42, 0.12, 0.15))
    s.tube("paint", 0.030, (0.40, 0, 0.28), (0.34, 0, 0.75))
    s.tube("dark", 0.024, (0.34, 0, 0.75), (0.30, 0, 1.18))
    s.tube("dark", 0.016, (0.30, -0.20, 1.18), (0.30, 0.20, 1.18))
    s.both("seat", 0.022, (0.29, 0.19, 1.18), (0.27, 0.28, 1.18))
    s.box("glass", (0.31, 0, 1.21), (0.04, 0.05, 0.025))
    s.disc("lamp", (0.375, 0, 1.02), 0.03, 0.02, "1 0 0")
    s.box("red", (-0.565, 0, 0.235), (0.006, 0.03, 0.015))
    for y in (-0.15, 0.15):
        s.box("dark", (0.43, y, 0.272), (0.10, 0.034, 0.007))


def _mobility(s: _Sketch) -> None:
    assert s.row.rider is not None
    x, seat = s.row.rider
    s.shell("paint", Box((-0.42, -0.02), 0.20, (0.13, 0.30)), 0.06)
    s.box("dark", (0.08, 0, 0.125), (0.26, 0.19, 0.018))
    s.shell("paint", Box((0.24, 0.42), 0.16, (0.13, 0.36)), 0.05)
    for wheel in s.row.wheels:
        for y in (-wheel.y, wheel.y):
            s.box("paint", (wheel.x, y, 2 * wheel.radius + 0.025), (0.11, 0.045, 0.012))
    s.tube("dark", 0.035, (x, 0, 0.28), (x, 0, seat - 0.07))
    s.seat(x, seat, 0.46)
    s.tube("dark", 0.025, (0.33, 0, 0.34), (0.20, 0, 0.84))
    s.box("paint", (0.19, 0, 0.88), (0.05, 0.09, 0.04), (0, -0.5, 0))
    s.tube("dark", 0.014, (0.18, -0.20, 0.84), (0.19, 0, 0.88), (0.18, 0.20, 0.84))
    s.tube("seat", 0.02, (0.15, -0.20, 0.83), (0.18, -0.20, 0.84))
    s.tube("seat", 0.02, (0.15, 0.20, 0.83), (0.18, 0.20, 0.84))
    s.disc("lamp", (0.425, 0, 0.30), 0.035, 0.012, "1 0 0")
    for z in (0.50, 0.66):  # a basket of wire
        rim = ((0.34, -0.15, z), (0.50, -0.15, z), (0.50, 0.15, z), (0.34, 0.15, z), (0.34, -0.15, z))
        s.tube("metal", 0.006, *rim)
    for k in range(6):
        y = -0.15 + 0.06 * k
        s.tube("metal", 0.004, (0.50, y, 0.66), (0.50, y, 0.50), (0.34, y, 0.50))
    for k in range(3):
        s.both("metal", 0.004, (0.36 + 0.06 * k, 0.15, 0.50), (0.36 + 0.06 * k, 0.15, 0.66))
    for y in (-0.13, 0.13):
        s.box("red", (-0.425, y, 0.24), (0.006, 0.03, 0.018))


_STYLES: dict[str, Callable[[_Sketch], None]] = {
    "rover": _rover,
    "courier": _courier,
    "racecar": _racecar,
    "cart": _cart,
    "disc": _round,
    "powerchair": _powerchair,
    "rollator": _rollator,
    "guard": _guard,
    "balancer": _balancer,
    "tracked": _tracked,
    "kickscooter": _kickscooter,
    "mobility": _mobility,
}


def _text(*values: float) -> str:
    return " ".join(f"{value:.5g}" for value in values)
