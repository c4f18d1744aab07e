"""Vegetables of leaves, stems and florets: cabbages, lettuce, artichoke, asparagus, broccoli; mushrooms."""

import numpy as np

from ....meshes import shapes
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, mix, shade
from ....meshes.recipe import recipe
from ....meshes.shapes import Shape
from ...shared.forms import lumpy, painted, pillow, softened
from ...shared.sizes import varied_cm
from ...shared.skins import skin


def cupped_leaf(
    radius: float, width_deg: float, low_deg: float, high_deg: float, curl: float, ruffle: float, waves: int = 5
) -> Shape:
    """A leaf lying on a ball about the origin, its edge curled outwards and ruffled; middle towards +x, two skins."""
    rows, columns = 5, 7
    up = np.radians(np.linspace(low_deg, high_deg, rows))[:, None]
    side = np.linspace(-1, 1, columns)[None, :]
    half = np.radians(width_deg / 2) * np.sin(np.pi * (0.28 + 0.6 * np.linspace(0, 1, rows)))[:, None]
    edge = np.maximum(np.abs(side) ** 3, (np.linspace(0, 1, rows)[:, None]) ** 4)
    wave = np.sin(waves * np.pi * side + 3 * up)
    reach = radius * (1 + curl * edge + ruffle * edge * wave)
    outer = np.stack(
        [
            reach * np.cos(up) * np.cos(half * side),
            reach * np.cos(up) * np.sin(half * side),
            reach * np.sin(up) + 0 * side,
        ],
        -1,
    )
    inner = outer * 0.965
    ring = [*range(columns), *range(2 * columns - 1, columns - 1, -1)]
    sections = [np.concatenate([outer[r], inner[r]])[ring] for r in range(rows)]
    return shapes.loft(sections)


def leafy_head(
    b: MeshBuilder,
    rng: np.random.Generator,
    core: Color,
    leaves: Color,
    rows: tuple[tuple[int, float, float, float, float], ...],
    ruffle: float,
) -> None:
    """A ball of packed leaves with looser ones round it; rows of (count, radius, from, to degrees, curl)."""
    ball = lumpy(shapes.ellipsoid((8.4, 8.4, 8), 16, 10), 0.03, rng)
    b.add(painted(ball), image=skin(rng, [shade(core, 0.85), core, shade(core, 1.06)], noise=5), crease_deg=80)
    for k, (count, radius, low, high, curl) in enumerate(rows):
        for n in range(count):
            yaw = 360 * n / count + 37 * k + float(rng.uniform(-8, 8))
            leaf = painted(cupped_leaf(radius, 360 / count * 1.55, low, high, curl, ruffle))
            tone = shade(leaves, 1.12 - 0.14 * k + 0.06 * (n % 2))
            vein = skin(rng, [mix(core, tone, 0.3), tone, tone], None, 4)
            b.add(leaf, image=vein, turn_deg=(0, 0, yaw), crease_deg=80)
    b.cylinder(2.2, 2.0, (0, 0, -9.2), "#e2e0c4", segments=10)


@recipe("cabbage", 3, name="greens.cabbage")
def cabbage(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """White cabbage, a pointed one, a dark savoy with ruffled leaves."""
    b = MeshBuilder(roughness=0.6)
    style = ("white", "pointed", "savoy")[variant % 3]
    core: Color = ("#b9cf8a", "#a9c878", "#8fae5c")[variant % 3]
    outer: Color = ("#a5c272", "#8fb65c", "#5f8a42")[variant % 3]
    rows = ((4, 8.7, -70, 58, 0.02), (5, 9.2, -70, 30, 0.16 if style != "pointed" else 0.05))
    leafy_head(b, rng, core, outer, rows, 0.09 if style == "savoy" else 0.02)
    size = ((18.5, 18.5, 16.5), (15.5, 15.5, 21), (22, 22, 16.5))[variant % 3]
    return varied_cm(b, f"a {style} cabbage", size, rng, {"style": style})


@recipe("red cabbage", 2, name="greens.red_cabbage")
def red_cabbage(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Violet-red with pale veins: whole, cut in half with its white pattern towards +x."""
    b = MeshBuilder(roughness=0.5)
    if variant % 2 == 0:
        leafy_head(b, rng, "#7a2f5c", "#6b2a52", ((4, 8.7, -70, 55, 0.02), (4, 9.1, -70, 28, 0.12)), 0.02)
        return varied_cm(b, "a red cabbage", (16.8, 16.8, 15.5), rng, {"style": "whole"})
    body = lumpy(pillow((16.6, 17, 15.4), 0.95, 0.95, 24, 14), 0.02, rng)
    flat = np.column_stack([np.minimum(body.vertices[:, 0], 0.0), body.vertices[:, 1:]])
    b.add(painted(Shape(flat, body.faces)), image=skin(rng, ["#5f2448", "#7a2f5c"], noise=5), crease_deg=60)
    for k, (share, color) in enumerate(
        (
            (0.97, "#6b2a52"),
            (0.9, "#e6d3dd"),
            (0.83, "#7a2f5c"),
            (0.66, "#e6d3dd"),
            (0.6, "#7a2f5c"),
            (0.42, "#e6d3dd"),
            (0.36, "#8a3a6a"),
        )
    ):
        y, z = share * np.array([8.5, 7.7])
        ring = np.linspace(0, 2 * np.pi, 25)[:-1]
        wave = 1 + 0.05 * np.sin(7 * ring + k)
        b.extrude(
            list(zip((y * wave * np.cos(ring)).tolist(), (z * wave * np.sin(ring)).tolist(), strict=True)),
            0.1,
            (-0.02 + 0.04 * k, 0, 7.5 - 0.1 * k),
            color,
            turn_deg=(90, 0, 90),
        )
    b.convex([(x, y, z) for x in (0.3, 0.42) for y, z in ((-1.6, 0.1), (1.6, 0.1), (0.4, 7), (-0.4, 7))], "#efe4e0")
    return varied_cm(b, "half a red cabbage", (12.6, 18, 17), rng, {"style": "half"})


@recipe("lettuce", 3, name="greens.lettuce")
def lettuce(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Butterhead, frilly red-edged, tall romaine."""
    b = MeshBuilder(roughness=0.7)
    style = ("butterhead", "red frilly", "romaine")[variant % 3]
    core: Color = ("#b5d272", "#9cbb58", "#a9c96a")[variant % 3]
    outer: Color = ("#8fbb4a", "#96304e", "#6b9e3e")[variant % 3]
    rows = {
        "butterhead": ((5, 8.3, -65, 65, 0.12), (6, 8.9, -65, 45, 0.28), (6, 9.6, -60, 22, 0.34)),
        "red frilly": ((5, 8.2, -65, 72, 0.22), (6, 8.9, -65, 50, 0.36), (7, 9.6, -60, 28, 0.42)),
        "romaine": ((5, 8.2, -70, 74, 0.06), (6, 8.8, -70, 60, 0.14), (6, 9.4, -70, 40, 0.2)),
    }[style]
    leafy_head(b, rng, core, outer, rows, {"butterhead": 0.07, "red frilly": 0.16, "romaine": 0.05}[style])
    size = ((21.5, 21.5, 17), (26, 26, 18), (15.5, 15.5, 23.5))[variant % 3]
    return varied_cm(b, f"a {style} lettuce", size, rng, {"style": style})


@recipe("artichoke", 2, name="greens.artichoke")
def artichoke(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A globe of overlapping scales on its stalk: green, violet."""
    b = MeshBuilder(roughness=0.7)
    color: Color = ("#6f8f4a", "#7a6a78")[variant % 2]
    b.lathe(
        softened([(0, 0), (3, 0.4), (4.6, 2.8), (4.4, 5.6), (2.6, 8.6), (0, 9.6)], 9),
        color=shade(color, 0.7),
        segments=16,
    )
    for row, (radius, z, lean, count, size) in enumerate(
        (
            (3.4, 0.6, 50, 8, 3.2),
            (4.6, 2.0, 24, 9, 3.4),
            (4.6, 3.8, 4, 9, 3.4),
            (3.9, 5.5, -14, 8, 3.2),
            (2.7, 7.0, -28, 6, 3.0),
            (1.3, 8.0, -30, 4, 2.6),
        )
    ):
        for k in range(count):
            with b.frame((0, 0, 0), (0, 0, 360 * k / count + 20 * row)), b.frame((radius, 0, z), (0, lean, 0)):
                w = size * 0.5
                b.convex(
                    [
                        (0, -w * 0.8, 0),
                        (0, w * 0.8, 0),
                        (0.3, -w, size * 0.4),
                        (0.3, w, size * 0.4),
                        (0.6, 0, size * 0.45),
                        (0.1, 0, size * 1.05),
                        (-0.3, 0, size * 0.4),
                    ],
                    shade(color, 0.82 + 0.07 * row + 0.08 * (k % 2)),
                )
    b.cylinder(1.3, 3.0, (0, 0, -2.6), shade(color, 1.15), segments=10)
    size_cm = ((10, 10, 11.5), (11.5, 11.5, 13.5))[variant % 2]
    return varied_cm(b, "an artichoke", size_cm, rng, {"color": str(color)})


@recipe("asparagus", 3, name="greens.asparagus")
def asparagus(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A bundle of green spears with bands, white ones, a single spear; tips to the front."""
    b = MeshBuilder(roughness=0.6)
    style = ("green bundle", "white bundle", "spear")[variant % 3]
    stem, tip = (("#7fa04a", "#4f7040"), ("#ece2c8", "#c9b0b4"), ("#86a650", "#56683e"))[variant % 3]
    places = [(0.0, 0.0)]
    if style != "spear":
        places = [
            (r * np.cos(a), r * np.sin(a))
            for r, n in ((0.01, 1), (1.75, 6), (3.3, 6))
            for a in np.arange(n) * 2 * np.pi / n
        ]
    for y, z in places:
        x = float(rng.uniform(-0.7, 0.7))
        b.tube(
            [(x, y, z), (x + 14, y, z), (x + 17, y, z), (x + 19.5, y, z), (x + 21.5, y, z)],
            [0.85, 0.75, 0.7, 0.82, 0.15],
            stem,
            sides=7,
        )
        b.ball((2.3, 0.84, 0.84), (x + 19.2, y, z), tip, segments=6, rings=4)
        for k in range(5 if style == "spear" else 0):
            with b.frame((x + 3 + 3.2 * k, y, z), (137 * k, 0, 0)):
                b.convex([(0, -0.4, 0.6), (0, 0.4, 0.6), (1.6, 0, 0.75), (0.5, 0, 1.0)], tip)
    if style != "spear":
        for x in (4, 12):
            b.cylinder(4.25, 1.0, (x, 0, 0), ("#3a5aa8", "#b8423a")[variant % 2], turn_deg=(0, 90, 0), segments=18)
    size = ((22, 6.0, 5.5), (24, 8.5, 7.8), (20, 1.3, 1.3))[variant % 3]
    return varied_cm(b, f"asparagus: a {style}", size, rng, {"style": style})


@recipe("broccoli", 3, name="greens.broccoli")
def broccoli(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A head of florets on a thick stem, a flatter one, a violet one."""
    b = MeshBuilder(roughness=0.9)
    color: Color = ("#3f6a2c", "#4f7d34", "#5a4a68")[variant % 3]
    b.tube([(0, 0, 0), (0, 0, 4), (0, 0, 7)], [1.9, 1.7, 2.6], "#9cb86a", sides=10)
    floret = skin(
        rng, [shade(color, 0.7), color, shade(color, 1.2)], noise=20, flecks=(shade(color, 1.5), 160), size=(32, 32)
    )
    for ring, count, radius, z, fat in ((0, 1, 0.0, 12.2, 2.9), (1, 5, 3.2, 11.0, 2.6), (2, 8, 5.2, 8.8, 2.3)):
        for k in range(count):
            a = 2 * np.pi * k / count + 0.4 * ring
            at = np.array([radius * np.cos(a), radius * np.sin(a), z])
            b.tube([(0, 0, 5), tuple(at * [0.6, 0.6, 0.8])], [1.1, 0.9], "#9cb86a", sides=5)
            ball = painted(lumpy(shapes.ellipsoid((fat, fat, fat * 0.85), 10, 7), 0.14, rng, 4))
            b.add(ball, image=floret, at=tuple(at), crease_deg=60)
    size = ((14.5, 14.5, 15), (17.5, 17.5, 14), (12.5, 12.5, 13))[variant % 3]
    return varied_cm(b, "a head of broccoli", size, rng, {"color": str(color)})


@recipe("mushroom", 3, name="greens.mushroom")
def mushroom(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A white champignon, a brown bolete with its fat stem, a red one with white spots."""
    b = MeshBuilder(roughness=0.7)
    style = ("champignon", "bolete", "fly agaric")[variant % 3]
    cap: Color = ("#ece4d4", "#8a552c", "#c4261c")[variant % 3]
    stem = (
        [(0, 0), (1.2, 0.1), (1.15, 2.2), (1.3, 4.2), (0, 4.2)],
        [(0, 0), (2.2, 0.3), (2.4, 2.0), (1.6, 5.0), (0, 5.0)],
        [(0, 0), (1.5, 0.2), (1.0, 1.6), (0.8, 6.6), (0, 6.6)],
    )[variant % 3]
    b.add(
        painted(shapes.lathe(softened(stem, 10), 18)), image=skin(rng, ["#d8c8a8", "#efe6d2"], noise=6), crease_deg=80
    )
    top = stem[-1][1]
    head = [
        (0.9, top - 0.6),
        (2.6, top - 0.9),
        (3.3, top - 0.6),
        (3.3, top),
        (2.6, top + 1.5),
        (1.3, top + 2.3),
        (0, top + 2.5),
    ]
    b.add(
        painted(lumpy(shapes.lathe(softened(head, 12), 24), 0.015, rng)),
        image=skin(rng, [shade(cap, 0.8), cap, shade(cap, 1.08)], noise=6),
        crease_deg=80,
    )
    b.lathe(
        [(0.8, top - 0.75), (3.0, top - 0.95), (3.0, top - 0.7), (0.8, top - 0.6)],
        color=("#8a6a5a", "#d0b86a", "#f0e8d4")[variant % 3],
        segments=24,
    )
    if style == "fly agaric":
        b.lathe([(0.9, 5.2), (1.7, 4.7), (1.7, 4.9), (0.9, 5.6)], color="#f0e8d4", segments=16)
        for k in range(12):
            a, s = 2.4 * k, 0.25 + 0.65 * k / 12
            z = float(np.interp(s * 3.3, [0, 1.3, 2.6, 3.3], [top + 2.5, top + 2.3, top + 1.5, top]))
            b.ball(
                (0.38, 0.38, 0.22), (3.3 * s * np.cos(a), 3.3 * s * np.sin(a), z + 0.02), "#f6f0e2", segments=7, rings=4
            )
    size = ((6.5, 6.5, 6.6), (9.5, 9.5, 10.5), (12, 12, 14))[variant % 3]
    return varied_cm(b, f"a {style}", size, rng, {"style": style})
