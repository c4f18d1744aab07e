"""Courts, fields and stadiums: flat grounds with their lines, nets, goals and stands. The length lies along x."""

import numpy as np

from ...meshes import shapes
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import recipe
from ..road.roads import Surface
from ..shared.sizes import fitted_as, size_of

Point3 = tuple[float, float, float]


def _outline(s: Surface, x0: float, y0: float, x1: float, y1: float, width: float, color: Color = "white") -> None:
    for x in (x0, x1):
        s.bar(x, (y0 + y1) / 2, width, abs(y1 - y0) + width, color)
    for y in (y0, y1):
        s.bar((x0 + x1) / 2, y, abs(x1 - x0) + width, width, color)


def mesh_fence(
    b: MeshBuilder, a: Point3, c: Point3, height: float, color: Color = "dark green", posts: int = 8
) -> None:
    """Posts and rails between two points on the ground."""
    start, end = np.asarray(a), np.asarray(c)
    up = np.array([0.0, 0.0, 1.0])
    for k in range(posts + 1):
        p = start + (end - start) * k / posts
        b.rod(tuple(p), tuple(p + up * height), 0.04, color, 5)
    for h in np.linspace(0.1, 1.0, 5) * height:
        b.rod(tuple(start + up * h), tuple(end + up * h), 0.025, color, 4)


def net(b: MeshBuilder, half: float, height: float, color: Color = "black") -> None:
    """A net across y between two posts."""
    for s in (-1, 1):
        b.cylinder(0.06, 1.05 * height, (0, s * half, 0), "dark green", segments=8)
    b.box((0.05, 2 * half, 0.07), (0, 0, height - 0.07), "white")
    for k in range(6):
        b.box((0.02, 2 * half, 0.02), (0, 0, height * (0.08 + 0.14 * k)), color)
    for y in np.linspace(-half, half, 25):
        b.box((0.02, 0.025, height - 0.05), (0, float(y), 0), color)


def _hoop(b: MeshBuilder, x: float, height: float, sense: float, color: Color) -> None:
    """Post, board with its square, ring and net; `sense` 1 looks along +x."""
    board = height - 0.55
    b.cylinder(0.09, height - 0.3, (x, 0, 0), color, segments=8)
    b.beam((x, 0, height - 0.4), (x + sense * 1.1, 0, height - 0.4), 0.1, 0.1, color)
    b.box((0.05, 1.8, 1.05), (x + sense * 1.15, 0, board - 0.5), "white")
    b.box((0.07, 0.62, 0.06), (x + sense * 1.15, 0, board + 0.05), "signal red")
    for y in (-0.28, 0.28):
        b.box((0.07, 0.06, 0.45), (x + sense * 1.15, y, board - 0.38), "signal red")
    ring = (x + sense * 1.42, 0, board - 0.4)
    b.ring(0.23, 0.025, ring, "orange", segments=12, sides=4)
    for k in range(8):
        a = 2 * np.pi * k / 8
        top = (ring[0] + 0.23 * np.cos(a), 0.23 * np.sin(a), ring[2])
        b.rod(top, (ring[0] + 0.13 * np.cos(a), 0.13 * np.sin(a), ring[2] - 0.4), 0.012, "white", 3)


@recipe("basketball court", 3, hulls=6, name="sports_grounds.basketball_court")
def basketball_court(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A whole court in two colours with both baskets; a smaller one; a street court behind wire."""
    size, b = size_of("basketball court", variant), MeshBuilder(roughness=0.8)
    x, y, z = size
    ground, key = (("#b5603c", "#2f5f8a"), ("#3f7a5a", "#a8423a"), ("#5a6068", "#c98a2c"))[variant]
    s = Surface(x, y, ground, rng, 300)
    w, hx, hy = 0.012 * y, 0.48 * x, 0.46 * y
    for side in (-1, 1):
        s.bar(side * (hx - 0.1 * x), 0, 0.2 * x, 0.33 * y, key)
        s.disc(side * (hx - 0.2 * x), 0, 0.12 * y, key)
        _outline(s, side * hx, -0.165 * y, side * (hx - 0.2 * x), 0.165 * y, w)
        s.ring(side * (hx - 0.2 * x), 0, 0.12 * y, w)
        s.ring(side * (hx - 0.05 * x), 0, 0.45 * y, w)
    s.bar(0, 0, w, 2 * hy)
    s.disc(0, 0, 0.12 * y, key)
    s.ring(0, 0, 0.12 * y, w)
    for side in (-1, 1):  # the three-point rings end at the base lines
        s.bar(side * (hx + 0.012 * x), 0, 0.024 * x, y, shade(ground, 0.85))
    _outline(s, -hx, -hy, hx, hy, w)
    b.box((x, y, 0.12), (0, 0, 0), shade(ground, 0.7))
    s.lay(b, 0.125)
    for side in (-1, 1):
        _hoop(b, -side * (hx + 0.005 * x), z - 0.12, side, ("charcoal", "signal blue", "galvanised")[variant])
    if variant == 2:
        for side in (-1, 1):
            mesh_fence(
                b,
                (-x / 2 + 0.05, side * (y / 2 - 0.05), 0.1),
                (x / 2 - 0.05, side * (y / 2 - 0.05), 0.1),
                0.6 * z,
                "dark grey",
                10,
            )
    else:
        b.box((0.35 * x, 0.35, 0.45), (0, -0.485 * y, 0.12), "wood")
    names = ("orange and blue basketball court", "small green basketball court", "fenced street basketball court")
    return fitted_as(b.build(names[variant]), "basketball court", size)


@recipe("football field", 2, hulls=6, name="sports_grounds.football_field")
def football_field(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Mown stripes, white lines, two goals, corner flags; the second on artificial turf with dugouts."""
    size, b = size_of("football field", variant), MeshBuilder(roughness=0.95)
    x, y, z = size
    tones = (("#5f9a40", "#528a38"), ("#3f8a4a", "#3a8044"))[variant]
    s = Surface(x, y, tones[0], rng, 340)
    for k in range(0, 18, 2):
        s.bar((k + 0.5) * x / 18 - x / 2, 0, x / 18, y, tones[1])
    w, hx, hy = 0.007 * x, 0.475 * x, 0.465 * y
    for side in (-1, 1):
        s.ring(side * (hx - 0.105 * x), 0, 0.087 * x, w)
        s.bar(side * (hx - 0.0785 * x), 0, 0.157 * x, 0.59 * y, tones[0])
        _outline(s, side * hx, -0.295 * y, side * (hx - 0.157 * x), 0.295 * y, w)
        _outline(s, side * hx, -0.135 * y, side * (hx - 0.052 * x), 0.135 * y, w)
        s.disc(side * (hx - 0.105 * x), 0, 0.7 * w, "white")
    _outline(s, -hx, -hy, hx, hy, w)
    s.bar(0, 0, w, 2 * hy)
    s.ring(0, 0, 0.087 * x, w)
    s.disc(0, 0, w, "white")
    b.box((x, y, 0.12), (0, 0, 0), shade(tones[0], 0.7))
    s.lay(b, 0.125)
    half, high = 3.66 * x / 105, z - 0.14
    for side in (-1, 1):
        px, back = side * hx, side * (hx + 0.018 * x)
        for sy in (-half, half):
            b.rod((px, sy, 0.12), (px, sy, 0.12 + high), 0.09, "white", 8)
            b.rod((px, sy, 0.1 + high), (back, sy, 0.12), 0.05, "white", 5)
        b.rod((px, -half, 0.06 + high), (px, half, 0.06 + high), 0.09, "white", 8)
        for k in np.linspace(-1, 1, 17):
            b.rod((px, k * half, 0.1 + high), (back, k * half, 0.12), 0.02, "light grey", 3)
        for k in np.linspace(0.15, 1, 6):
            at = (px + (back - px) * k, 0.12 + high * (1 - k))
            b.rod((at[0], -half, at[1]), (at[0], half, at[1]), 0.02, "light grey", 3)
        for sy in (-hy, hy):
            b.rod((px, sy, 0.1), (px, sy, 1.6), 0.05, "signal yellow", 5)
            b.quad(
                [(px, sy, 1.2), (px + 0.6, sy, 1.2), (px + 0.6, sy, 1.6), (px, sy, 1.6)], "signal red", both_sides=True
            )
    for k in (-0.1, 0.1) if variant else ():
        b.box((0.1 * x, 0.02 * y, 1.6), (k * x, -0.485 * y, 0.12), "signal blue")
    names = ("football field of mown grass", "football field of artificial turf with dugouts")
    return fitted_as(b.build(names[variant]), "football field", size)


@recipe("tennis court", 3, hulls=6, name="sports_grounds.tennis_court")
def tennis_court(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Clay, green hard court or grass, with the net and an umpire's chair."""
    size, b = size_of("tennis court", variant), MeshBuilder(roughness=0.85)
    x, y, z = size
    outer, inner = (("#3f7050", "#b5603c"), ("#2f5f8a", "#3f86b0"), ("#5f9a40", "#74ab4c"))[variant]
    s = Surface(x, y, outer, rng, 300)
    hx, hy, w = 0.35 * x, 0.323 * y, 0.008 * y
    s.bar(0, 0, 2 * hx, 2 * hy, inner)
    _outline(s, -hx, -hy, hx, hy, w)
    for side in (-1, 1):
        s.bar(0, side * 0.75 * hy, 2 * hx, w)
        s.bar(side * 0.538 * hx, 0, w, 1.5 * hy)
    s.bar(0, 0, 1.076 * hx, w)
    b.box((x, y, 0.1), (0, 0, 0), shade(outer, 0.7))
    s.lay(b, 0.105)
    with b.frame((0, 0, 0.1)):
        net(b, hy + 0.06 * y, z - 0.16)
    chair = (0, -hy - 0.1 * y, 0.1)
    for sx in (-0.3, 0.3):
        for sy in (-0.3, 0.3):
            b.rod((sx, chair[1] + sy, 0.1), (0.6 * sx, chair[1] + 0.6 * sy, 0.62 * z), 0.04, "dark green", 5)
    b.box((0.5, 0.5, 0.06), (0, chair[1], 0.6 * z), "dark green")
    b.box((0.5, 0.06, 0.28 * z), (0, chair[1] - 0.24, 0.62 * z), "dark green")
    for side in (-1, 1):
        b.box((0.4, 0.1 * y, 0.3), (side * 0.2 * x, -hy - 0.1 * y, 0.1), "wood")
    names = ("clay tennis court", "blue hard tennis court", "grass tennis court")
    return fitted_as(b.build(names[variant]), "tennis court", size)


@recipe("paddle court", 2, hulls=8, name="sports_grounds.paddle_court")
def paddle_court(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A blue or green court inside glass and wire mesh, with a net and lamps; its length lies along y."""
    size, b = size_of("paddle court", variant), MeshBuilder(roughness=0.5)
    length, width, z = size[1], size[0], size[2]
    color, steel = (("#2f6fb5", "black"), ("#3f8a4a", "dark green"))[variant]
    with b.frame((0, 0, 0), (0, 0, 90)):
        s = Surface(length, width, color, rng, 220)
        _outline(s, -0.35 * length, -width / 2, 0.35 * length, width / 2, 0.08)
        s.bar(0, 0, 0.7 * length, 0.08)
        b.box((length, width, 0.1), (0, 0, 0), "dark concrete")
        s.lay(b, 0.105)
        with b.frame((0, 0, 0.1)):
            net(b, width / 2 - 0.1, 0.9)
        high = 3.0
        hx, hy = length / 2 - 0.08, width / 2 - 0.08
        for side in (-1, 1):
            for k in range(7):  # posts of the glass back wall; the panes are bands of pale glass low and high
                b.box((0.08, 0.08, high), (side * hx, (k - 3) * hy / 3, 0.1), steel)
            for h, tall in ((0.12, 0.25), (high - 0.2, 0.25)):
                b.box((0.04, 2 * hy, tall), (side * hx, 0, h), "glass")
            mesh_fence(b, (side * hx, -hy, high), (side * hx, hy, high), 1.0, steel, 6)
            mesh_fence(b, (-hx, side * hy, 0.1), (hx, side * hy, 0.1), high, steel, 12)
            for px in (-0.42, -0.3, 0.3, 0.42):
                b.box((0.1 * length, 0.04, 0.25), (px * length, side * hy, 0.12), "glass")
            for px in (-0.3, 0.3):
                lamp = (px * length, side * hy, 0.1)
                b.cylinder(0.06, max(z - 0.3, high), lamp, steel, segments=6)
                b.box((0.5, 0.3, 0.12), (lamp[0], side * (hy - 0.2), max(z - 0.2, high)), "lamp")
    return fitted_as(
        b.build(("blue padel court in glass", "green padel court in glass")[variant]), "paddle court", size
    )


@recipe("stadium", 2, hulls=12, name="sports_grounds.stadium")
def stadium(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """An oval of stepped stands in coloured seats round a pitch, under a ring of roof or between light masts."""
    size, b = size_of("stadium", variant), MeshBuilder(roughness=0.8)
    x, y, z = size
    s = Surface(0.56 * x, 0.46 * y, "#5a9440", rng, 160)
    for k in range(0, 12, 2):
        s.bar((k + 0.5) * 0.56 * x / 12 - 0.28 * x, 0, 0.56 * x / 12, 0.46 * y, "#528a38")
    w = 0.008 * x
    _outline(s, -0.26 * x, -0.21 * y, 0.26 * x, 0.21 * y, w)
    s.bar(0, 0, w, 0.42 * y)
    s.ring(0, 0, 0.06 * x, w)
    for side in (-1, 1):
        _outline(s, side * 0.26 * x, -0.12 * y, side * 0.17 * x, 0.12 * y, w)
    b.box((0.9 * x, 0.9 * y, 0.02 * z), (0, 0, 0), "dark concrete")
    s.lay(b, 0.022 * z)
    a = np.arange(32) * 2 * np.pi / 32
    # A rounded rectangle: the power 2.6 makes an ellipse squarer, as stands follow the pitch.
    c, d = np.cos(a), np.sin(a)
    oval = np.stack([np.sign(c) * abs(c) ** 0.77, np.sign(d) * abs(d) ** 0.77], 1)

    def ring(share_x: float, share_y: float, height: float) -> np.ndarray:
        return np.column_stack([oval * [share_x * x / 2, share_y * y / 2], np.full(32, height * z)])

    rise = 0.74 if variant == 0 else 0.8
    seats: tuple[Color, ...] = (("#2f5fa8", "white", "#2f5fa8"), ("#b5322c", "#e0c040", "#b5322c"))[variant]
    inner = np.array([(0.6, 0.52, 0.05), (0.72, 0.68, 0.28), (0.75, 0.72, 0.34), (0.95, 0.94, rise)])
    outer = np.stack([ring(0.98, 0.98, 0.0), ring(1.0, 1.0, 0.5 * rise), ring(0.95, 0.94, rise)])
    for sector in range(8):  # each a solid of its own, so that the collision hulls leave the pitch free
        columns = np.arange(4 * sector, 4 * sector + 5) % 32
        with b.solid():
            for k, color in enumerate(seats):
                rows = np.stack([ring(*inner[k]), ring(*inner[k + 1])])[:, columns]
                b.sheet(rows[:, ::-1], color)
            b.sheet(outer[:, columns], ("#d8dadb", "#b9a88c")[variant])
    for k in range(32):
        p, q = outer[0, k], outer[2, k]
        b.beam(tuple(p), tuple(q), 0.008 * x, 0.012 * x, ("white", "#8f7a60")[variant])
    if variant == 0:
        roof = np.stack([ring(0.97, 0.97, 0.86), ring(0.66, 0.6, 0.98), ring(0.66, 0.6, 1.0), ring(0.97, 0.97, 0.88)])
        b.add(shapes.loft(list(roof), caps=False, closed=True), "white")
        for k in range(0, 32, 2):
            b.rod(tuple(ring(0.95, 0.94, rise)[k]), tuple(roof[0, k]), 0.006 * z + 0.3, "galvanised", 5)
    else:
        for sx in (-1, 1):
            for sy in (-1, 1):
                at = (sx * 0.4 * x, sy * 0.42 * y, 0.0)
                b.cylinder(0.006 * x, 0.9 * z, at, "galvanised", segments=6)
                b.box((0.05 * x, 0.012 * x, 0.1 * z), (at[0], at[1], 0.9 * z), "lamp", (0, 0, -45 * sx * sy))
    b.box((0.02 * x, 0.14 * y, 0.12 * z), (-0.36 * x, 0, 0.6 * z), "black")
    names = ("roofed football stadium with blue seats", "open stadium with four light masts")
    return fitted_as(b.build(names[variant]), "stadium", size)
