"""Porcelain, enamel and taps: bidets, sinks, baths, showers; the user stands at +x."""

import numpy as np

from ....meshes import shapes
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, shade
from ....meshes.recipe import recipe
from ...shared.forms import soft
from ...shared.sizes import made

Loop = list[tuple[float, float]]


def egg(half_length: float, half_width: float, square: float = 2.3, count: int = 24, blunt: float = 0.0) -> Loop:
    """An oval outline, m; `square` > 2 squares it, `blunt` cuts its back (-x) off flatter."""
    t = np.arange(count) * 2 * np.pi / count
    c, s = np.cos(t), np.sin(t)
    x = half_length * np.sign(c) * np.abs(c) ** (2 / square)
    x = np.where(x < 0, x * (1 - blunt), x)
    return list(zip(x.tolist(), (half_width * np.sign(s) * np.abs(s) ** (2 / square)).tolist(), strict=True))


def basin(
    b: MeshBuilder,
    outline: Loop,
    rim: float,
    depth: float,
    z: float,
    color: Color,
    foot: float = 0.6,
    at: shapes.Point2 = (0, 0),
) -> None:
    """A bowl with a rim: the outline at height z, its outer skin drawn in to `foot` of it `depth` lower, open above."""
    loop = np.asarray(outline)
    inward = 1 - rim / np.abs(loop).max(0)
    steps = [
        (np.array([foot, foot]), z - depth),
        (np.array([0.5 + foot / 2] * 2), z - depth * 0.7),
        (np.array([1.0, 1.0]), z - depth * 0.12),
    ]
    steps += [
        (np.array([1.0, 1.0]), z),
        (inward, z),
        (inward * 0.9, z - depth * 0.45),
        (inward * 0.5, z - depth * 0.85),
    ]
    rows = [np.column_stack([loop * s, np.full(len(loop), level)]) for s, level in steps]
    b.loft(rows, color, at=(at[0], at[1], 0), crease_deg=50)


def tap(
    b: MeshBuilder,
    at: tuple[float, float, float],
    reach: float,
    height: float,
    metal: Color = "aluminium",
    lever: bool = True,
) -> None:
    """A mixer whose spout bends towards +x from `at`."""
    with b.frame(at):
        r = 0.12 * reach + 0.004
        b.lathe([(r * 1.5, 0), (r * 1.5, 0.008), (r, 0.012), (r, height * 0.55)], color=metal, segments=14)
        path = [
            (0, 0, height * 0.5),
            (0.02 * reach, 0, height * 0.85),
            (0.25 * reach, 0, height),
            (0.7 * reach, 0, height * 0.98),
            (reach, 0, height * 0.86),
            (reach, 0, height * 0.68),
        ]
        b.tube(path, r * 0.75, metal, sides=10)
        if lever:
            b.tube(
                [(0, 0, height * 0.5), (-0.05 * reach, r * 1.2, height * 0.62), (0.0, 0.42 * reach, height * 0.85)],
                [r * 0.6, r * 0.5, r * 0.4],
                metal,
                sides=8,
            )


@recipe("bidet", 2, name="sanitary.bidet")
def bidet(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A ceramic bowl on its foot with a mixer, rounded and squared."""
    b = MeshBuilder(roughness=0.25)
    square = (2.3, 4.0)[variant % 2]
    color = ("white", "cream")[variant % 2]
    loop = egg(0.27, 0.18, square, 24)
    b.loft(
        [
            np.column_stack([np.array(egg(0.2, 0.12, 3)), np.full(24, 0.0)]),
            np.column_stack([np.array(egg(0.16, 0.1, 3)), np.full(24, 0.12)]),
            np.column_stack([np.array(loop) * 0.8, np.full(24, 0.26)]),
        ],
        color,
        crease_deg=60,
    )
    basin(b, loop, 0.05, 0.13, 0.36, color, 0.8)
    b.cylinder(0.025, 0.004, (0.02, 0, 0.252), "aluminium", segments=14)
    tap(b, (-0.235, 0, 0.36), 0.11, 0.075)
    return made(b, "a bidet", ((0.56, 0.365, 0.4), (0.54, 0.38, 0.42))[variant % 2], squared=variant % 2 == 1)


@recipe("sink", 3, name="sanitary.sink")
def sink(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A ceramic wash basin with its tap, a steel kitchen sink with a drainer, a basin on a pedestal."""
    b = MeshBuilder(roughness=0.25)
    if variant % 3 == 1:
        b.extrude(
            [(-0.25, -0.48), (0.25, -0.48), (0.25, 0.48), (-0.25, 0.48)],
            0.012,
            (0, 0, 0.17),
            "aluminium",
            holes=[[(x, y + 0.22) for x, y in egg(0.19, 0.2, 8, 24)]],
        )
        basin(b, egg(0.2, 0.21, 8), 0.015, 0.18, 0.18, "aluminium", 0.9, (0, 0.22))
        for k in range(7):
            b.box((0.4, 0.014, 0.006), (0, -0.42 + 0.055 * k, 0.182), "light grey", bevel=0.002)
        b.cylinder(0.035, 0.004, (0, 0.22, 0.03), "dark grey", segments=16)
        tap(b, (-0.215, 0.22, 0.18), 0.17, 0.2)
        return made(b, "a steel kitchen sink", (0.5, 0.95, 0.38), style="kitchen")
    color = "white" if variant % 3 == 0 else "off white"
    loop = egg(0.21, 0.28, 3.0)
    high = 0.16 if variant % 3 == 0 else 0.82
    basin(b, loop, 0.045, 0.15, high, color, 0.55, (0.02, 0))
    b.box((0.12, 0.46, 0.08), (-0.17, 0, high - 0.075), color, bevel=0.02)
    b.cylinder(0.025, 0.004, (0.02, 0, high - 0.126), "aluminium", segments=14)
    tap(b, (-0.165, 0, high), 0.13, 0.09 if variant % 3 == 0 else 0.1)
    if variant % 3 == 2:
        b.lathe([(0.11, 0), (0.11, 0.03), (0.075, 0.1), (0.07, 0.5), (0.1, 0.7)], (-0.02, 0, 0), color, segments=18)
        return made(b, "a basin on a pedestal", (0.45, 0.56, 0.9), style="pedestal")
    return made(b, "a wash basin", (0.47, 0.58, 0.225), style="basin")


@recipe("faucet", 3, name="sanitary.faucet")
def faucet(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A lever mixer, a tall kitchen arch, a brass garden tap with a cross handle; the spout at +x."""
    b = MeshBuilder(roughness=0.2, metallic=0.6)
    if variant % 3 == 2:
        b.cylinder(0.022, 0.012, (-0.06, 0, 0.06), "brass", turn_deg=(0, 90, 0), segments=14)
        b.tube(
            [(-0.05, 0, 0.06), (0.0, 0, 0.06), (0.04, 0, 0.06), (0.06, 0, 0.045), (0.06, 0, 0.01)],
            [0.013, 0.016, 0.013, 0.013, 0.013],
            "brass",
            sides=12,
        )
        b.ring(0.014, 0.003, (0.06, 0, 0.012), "brass", segments=14, sides=5)
        b.cylinder(0.013, 0.045, (0.005, 0, 0.06), "brass", top_radius=0.009, segments=12)
        b.rod((0.005, -0.03, 0.11), (0.005, 0.03, 0.11), 0.006, "signal red", sides=8)
        b.rod((-0.025, 0, 0.11), (0.035, 0, 0.11), 0.006, "signal red", sides=8)
        return made(b, "a brass garden tap", (0.13, 0.06, 0.12), style="garden")
    if variant % 3 == 0:
        b.lathe(
            [(0.028, 0), (0.028, 0.006), (0.023, 0.01), (0.022, 0.13), (0.018, 0.145)], color="aluminium", segments=20
        )
        b.tube(
            [(0, 0, 0.1), (0.05, 0, 0.125), (0.12, 0, 0.13), (0.155, 0, 0.115), (0.158, 0, 0.095)],
            [0.017, 0.015, 0.013, 0.012, 0.012],
            "aluminium",
            sides=14,
        )
        b.lathe([(0.021, 0.148), (0.022, 0.165), (0.012, 0.18)], color="aluminium", segments=18)
        b.tube([(0, 0, 0.172), (0.03, 0, 0.185), (0.1, 0, 0.2)], [0.009, 0.008, 0.006], "aluminium", sides=10)
        return made(b, "a basin mixer", (0.19, 0.06, 0.2), style="mixer")
    tap(b, (0, 0, 0), 0.2, 0.42, "charcoal", lever=False)
    b.tube([(0, 0.02, 0.1), (0.0, 0.06, 0.11), (0.02, 0.12, 0.14)], [0.012, 0.009, 0.007], "charcoal", sides=10)
    return made(b, "a kitchen mixer", (0.25, 0.16, 0.43), style="kitchen")


@recipe("shower head", 2, name="sanitary.shower_head")
def shower_head(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A hand shower with its handle, a square rain head on a wall arm; towards +x and down."""
    b = MeshBuilder(roughness=0.25, metallic=0.4)
    if variant % 2 == 0:
        b.tube([(-0.1, 0, 0.0), (-0.06, 0, 0.04), (0.0, 0, 0.1)], [0.012, 0.015, 0.018], "aluminium", sides=14)
        with b.frame((0.03, 0, 0.1), (0, 140, 0)):
            b.lathe([(0.03, -0.02), (0.06, 0), (0.068, 0.02), (0.064, 0.028)], color="aluminium", segments=24)
            for r, n in ((0.015, 6), (0.032, 10), (0.05, 16)):
                for k in range(n):
                    a = 2 * np.pi * k / n
                    b.cylinder(0.004, 0.004, (r * np.cos(a), r * np.sin(a), 0.027), "charcoal", segments=6)
        return made(b, "a hand shower", (0.18, 0.14, 0.14), style="hand")
    b.cylinder(0.03, 0.01, (-0.14, 0, 0.1), "aluminium", turn_deg=(0, 90, 0), segments=18)
    b.tube([(-0.13, 0, 0.1), (-0.05, 0, 0.12), (0.03, 0, 0.1), (0.04, 0, 0.03)], 0.011, "aluminium", sides=12)
    b.box((0.2, 0.2, 0.015), (0.04, 0, 0.005), "aluminium", bevel=0.005)
    for k in range(36):
        b.cylinder(0.005, 0.006, (-0.035 + 0.03 * (k % 6), -0.075 + 0.03 * (k // 6), 0.0), "charcoal", segments=6)
    return made(b, "a rain shower head", (0.3, 0.22, 0.13), style="rain")


@recipe("bathtub", 2, name="sanitary.bathtub")
def bathtub(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A free-standing oval tub on claw feet, a built-in one with panels; the taps at one end of y."""
    b = MeshBuilder(roughness=0.25)
    if variant % 2 == 0:
        basin(b, egg(0.36, 0.84, 2.6, 28), 0.05, 0.46, 0.58, "white", 0.72)
        b.tube(
            [(0.35 * x / 0.36, 0.83 * y / 0.84, 0.575) for x, y in egg(0.36, 0.84, 2.6, 28)],
            0.022,
            "white",
            sides=8,
            closed=True,
        )
        for sx in (-1, 1):
            for sy in (-1, 1):
                b.tube(
                    [
                        (sx * 0.2, sy * 0.45, 0.18),
                        (sx * 0.27, sy * 0.5, 0.1),
                        (sx * 0.25, sy * 0.5, 0.03),
                        (sx * 0.29, sy * 0.53, 0.0),
                    ],
                    [0.03, 0.03, 0.022, 0.03],
                    "gold",
                )
    else:
        b.extrude(
            [(-0.4, -0.85), (0.4, -0.85), (0.4, 0.85), (-0.4, 0.85)],
            0.52,
            (0, 0, 0),
            "white",
            holes=[egg(0.3, 0.74, 5, 24)],
        )
        b.box((0.02, 1.66, 0.44), (0.4, 0, 0.03), "light grey", bevel=0.008)
        b.extrude(egg(0.31, 0.75, 5, 24), 0.02, (0, 0, 0.12), "off white")
        b.cylinder(0.03, 0.004, (0, -0.6, 0.14), "aluminium", segments=14)
    z = 0.575 if variant % 2 == 0 else 0.52
    with b.frame((0, -0.8 if variant % 2 else -0.815, z), (0, 0, 90)):
        tap(b, (0, 0, 0), 0.13, 0.14 if variant % 2 else 0.06, "brass" if variant % 2 == 0 else "aluminium")
    return made(
        b,
        ("a claw-foot bathtub", "a built-in bathtub")[variant % 2],
        ((0.76, 1.68, 0.6), (0.8, 1.75, 0.66))[variant % 2],
        0.8,
    )


@recipe("jacuzzi", 2, name="sanitary.jacuzzi")
def jacuzzi(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A square acrylic spa in a timber skirt, a round wooden tub; filled, with jets, pillows and a step."""
    b = MeshBuilder(roughness=0.4)
    if variant % 2 == 0:
        for k in range(9):
            for turn in range(4):
                with b.frame(turn_deg=(0, 0, 90 * turn)):
                    b.box(
                        (0.03, 0.205, 0.78),
                        (0.98, -0.86 + 0.215 * k, 0.02),
                        shade("wood", float(rng.uniform(0.85, 1.1))),
                    )
        rim = [(x, y) for x, y in egg(1.04, 1.02, 9, 28)]
        b.extrude(rim, 0.12, (0, 0, 0.78), "light grey", holes=[egg(0.85, 0.83, 6, 24)])
        top, radius = 0.8, 0.84
        b.extrude(egg(0.86, 0.84, 6, 24), 0.76, (0, 0, 0.02), "#5fb6cf")
        for sx in (-1, 1):
            for sy in (-1, 1):
                with b.frame((sx * 0.72, sy * 0.7, 0.78), (0, 0, float(np.degrees(np.arctan2(sy, sx))))):
                    soft(b, (0.12, 0.36, 0.13), (0.02, 0, 0), "charcoal", plan=4, segments=14, rings=6)
        size = (2.05, 2.1, 0.88)
    else:
        for k in range(24):
            a = 360 / 24 * k
            with b.frame(turn_deg=(0, 0, a)):
                b.box((0.06, 0.245, 0.95), (0.92, 0, 0), shade("dark wood", float(rng.uniform(0.9, 1.25))))
        for z in (0.2, 0.7):
            b.lathe([(0.965, z), (0.965, z + 0.05)], color="galvanised", segments=24)
        ring = egg(0.97, 0.97, 2.0, 24)
        b.extrude(ring, 0.06, (0, 0, 0.93), "wood", holes=[[(x * 0.85, y * 0.85) for x, y in ring]])
        top, radius = 0.86, 0.8
        b.cylinder(0.9, top - 0.03, (0, 0, 0.03), "#5fb6cf", segments=24)
        size = (1.95, 2.1, 0.98)
    for _ in range(22):
        x, y = rng.uniform(-0.62, 0.62, 2) * radius
        b.ball((0.07, 0.07, 0.02), (float(x), float(y), top - 0.02), "white", segments=7, rings=4)
    if variant % 2:
        b.box((0.3, 0.7, 0.2), (1.1, 0.0, 0.0), "wood", bevel=0.01)
    return made(
        b,
        ("a square whirlpool", "a round wooden hot tub")[variant % 2],
        size if variant % 2 == 0 else (2.2, 1.98, 0.98),
    )
