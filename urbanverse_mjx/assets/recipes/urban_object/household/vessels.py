"""Turned and blown objects: barrels, buckets, cans, ashtrays, vases, candles, balloons."""

import numpy as np

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, rgb, shade
from ....meshes.recipe import recipe
from ....meshes.shapes import Point2
from ...shared.forms import hollow
from ...shared.outlines import arc
from ...shared.sizes import made


@recipe("barrel or bucket", 3, name="vessels.barrel")
def barrel(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A steel drum with rolling hoops, a wooden cask with iron bands, a bucket with its bail."""
    b = MeshBuilder(roughness=0.5)
    if variant % 3 == 0:
        color = ("signal blue", "dark red")[int(rng.integers(2))]
        shell: list[Point2] = [(0.27, 0.0), (0.28, 0.015), (0.28, 0.04), (0.27, 0.05)]
        for z in (0.28, 0.56):
            shell += [(0.27, z - 0.02), (0.282, z), (0.27, z + 0.02)]
        b.lathe(
            [*shell, (0.27, 0.8), (0.28, 0.81), (0.28, 0.84), (0.265, 0.84), (0.262, 0.825)], color=color, segments=28
        )
        for x, r in ((0.17, 0.035), (-0.18, 0.022)):
            b.cylinder(r, 0.02, (x, 0, 0.825), "charcoal", segments=14)
        return made(b, f"a {color} steel drum", (0.56, 0.56, 0.84), style="drum")
    if variant % 3 == 1:
        z = np.linspace(0, 0.92, 9)
        r = 0.25 + 0.07 * (1 - (2 * z / 0.92 - 1) ** 2)
        with b.solid():
            b.lathe([*zip(r, z, strict=True), (r[-1] - 0.025, 0.92), (r[-1] - 0.025, 0.89)], color="wood", segments=24)
        for k in range(12):
            a = np.radians(30 * k + 8)
            b.tube(
                [(1.004 * p * np.cos(a), 1.004 * p * np.sin(a), h) for p, h in zip(r, z, strict=True)],
                0.004,
                "dark wood",
                4,
            )
        for level in (0.06, 0.2, 0.32, 0.6, 0.72, 0.86):
            p = float(np.interp(level, z, r)) + 0.006
            b.lathe([(p, level - 0.02), (p, level + 0.02)], color="cast iron", segments=24)
        b.cylinder(0.025, 0.03, (0.31, 0, 0.46), "light wood", turn_deg=(0, 90, 0), segments=12)
        return made(b, "a wooden cask", (0.64, 0.64, 0.92), style="cask")
    hollow(
        b,
        [(0.11, 0), (0.112, 0.01), (0.142, 0.26), (0.15, 0.262), (0.15, 0.28)],
        0.006,
        "galvanised",
        segments=26,
        floor=0.02,
    )
    b.lathe([(0.128, 0.13), (0.134, 0.14), (0.13, 0.15)], color="galvanised", segments=26)
    b.tube([(0, y, z) for y, z in arc(0.152, 0, 180, 13, (0, 0.24))], 0.004, "charcoal", sides=6)
    b.cylinder(0.013, 0.09, (0, -0.045, 0.393), "wood", turn_deg=(-90, 0, 0), segments=10)
    for side in (-1, 1):
        b.cylinder(0.018, 0.012, (0, side * 0.145, 0.24), "dark grey", turn_deg=(-90 * side, 0, 0), segments=10)
    return made(b, "a zinc bucket", (0.3, 0.31, 0.41), style="bucket")


def _label(words: str, back: Color, ink: Color) -> np.ndarray:
    image, draw = paint.canvas((192, 120), back)
    draw.polygon([(0, 78), (192, 48), (192, 66), (0, 96)], fill=rgb(ink))
    for x in (8, 104):
        paint.text(draw, words, (x, 10, x + 80, 52), ink, bold=0.05)
    return np.asarray(paint.shrunk(image, (96, 60)))


@recipe("discarded can", 3, name="vessels.discarded_can")
def discarded_can(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """An upright dented drinks can, one crushed in the middle and lying, an open food tin with its lid bent up."""
    b = MeshBuilder(roughness=0.35, metallic=0.3)
    label = (_label("COLA", "red", "white"), _label("LIME", "green", "white"), _label("SOUP", "cream", "red"))[
        variant % 3
    ]
    radius, height = (0.033, 0.1) if variant % 3 < 2 else (0.037, 0.09)
    dent_at, dent = float(rng.uniform(0, 2 * np.pi)), (0.28, 0.6, 0.0)[variant % 3]
    turn = (0, 0, 0) if variant % 3 != 1 else (0, 90, 25)
    with b.frame((0, 0, 0), turn):
        u, v = np.linspace(0, 2 * np.pi, 21), np.linspace(0, 1, 9)
        rows = []
        for s in v:
            pinch = 1 - dent * np.exp(-(((s - 0.55) / 0.22) ** 2)) * np.maximum(0, np.cos(u - dent_at)) ** 1.5
            rows.append(
                np.column_stack(
                    [radius * pinch * np.cos(u), radius * pinch * np.sin(u), 0.006 + (height - 0.014) * np.full(21, s)]
                )
            )
        b.sheet(np.array(rows), image=label)
        b.lathe(
            [(radius * 0.75, 0), (radius * 0.8, 0.0), (radius, 0.0062), (0.0, 0.0065)], color="aluminium", segments=20
        )
        if variant % 3 < 2:
            top = height - 0.008
            b.lathe(
                [
                    (radius, top - 0.0005),
                    (radius * 0.82, height),
                    (radius * 0.77, height),
                    (radius * 0.75, height - 0.004),
                ],
                color="aluminium",
                segments=20,
            )
            b.ball((0.009, 0.007, 0.0015), (0.012, 0, height - 0.0035), "black", segments=10, rings=4)
            b.ring(0.006, 0.0015, (-0.008, 0, height - 0.002), "light grey", segments=10, sides=4)
        else:
            hollow(b, [(radius * 0.97, 0.01), (radius, height)], 0.001, "galvanised", segments=20)
            for z in (0.0, height):
                b.ring(radius, 0.0016, (0, 0, z + 0.001), "galvanised", segments=20, sides=5)
            b.cylinder(
                radius * 0.95, 0.0015, (-radius * 1.1, 0, height + 0.03), "galvanised", turn_deg=(0, 65, 0), segments=18
            )
    size = ((0.068, 0.064, 0.1), (0.105, 0.07, None), (0.09, 0.075, 0.13))[variant % 3]
    return made(
        b, ("a dented drinks can", "a crushed drinks can", "an open food tin")[variant % 3], size, 0.8, dent=dent
    )


@recipe("ashtray", 3, name="vessels.ashtray")
def ashtray(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A glass bowl with notches and stubs, a round ceramic one, a street column with a sand tray."""
    b = MeshBuilder(roughness=0.3)
    if variant % 3 == 2:
        b.lathe([(0.17, 0), (0.17, 0.02), (0.1, 0.03)], color="charcoal", segments=20)
        b.cylinder(0.09, 0.78, (0, 0, 0.02), "aluminium", segments=20)
        hollow(b, [(0.09, 0.78), (0.16, 0.8), (0.16, 0.88)], 0.012, "charcoal", segments=22, floor=0.84)
        b.cylinder(0.147, 0.012, (0, 0, 0.84), "beige", segments=20)
        top, radius, size = 0.855, 0.09, (0.34, 0.34, 0.9)
    else:
        color = ("glass", "teal")[variant % 3]
        segments = 8 if variant % 3 == 0 else 24
        hollow(
            b,
            [(0.055, 0), (0.066, 0.004), (0.07, 0.05)],
            0.014 if segments == 8 else 0.008,
            color,
            (0, 0, 0),
            segments,
            0.012,
        )
        for k in range(4):
            with b.frame(turn_deg=(0, 0, 90 * k)):
                b.box((0.018, 0.012, 0.006), (0.064, 0, 0.046), shade(color, 0.6))
        b.cylinder(0.045, 0.003, (0, 0, 0.012), "dark grey", segments=18)
        top, radius, size = 0.015, 0.03, ((0.14, 0.14, 0.055), (0.13, 0.13, 0.05))[variant % 3]
    for _ in range(5):
        x, y = rng.uniform(-radius, radius, 2)
        with b.frame((float(x), float(y), top), (float(rng.uniform(55, 80)), 0, float(rng.uniform(0, 360)))):
            scale = 2.0 if variant % 3 == 2 else 1.0
            b.cylinder(0.0045 * scale, 0.016 * scale, color="white", segments=8)
            b.cylinder(0.0047 * scale, 0.012 * scale, (0, 0, 0.016 * scale), "orange", segments=8)
    if variant % 3 < 2:
        with b.frame((0.064, 0, 0.054), (0, -78, 0)):
            b.cylinder(0.004, 0.05, (0, 0, -0.022), "white", segments=8)
            b.cylinder(0.0042, 0.018, (0, 0, -0.04), "orange", segments=8)
    size = (None, *size[1:]) if variant % 3 == 2 else size
    return made(b, "an ashtray with stubs", size, style=("glass", "ceramic", "column")[variant % 3])


@recipe("vase", 3, name="vessels.vase")
def vase(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A blue-and-white baluster, a two-handled clay amphora, a tall fluted glass."""
    b = MeshBuilder(roughness=0.35)
    if variant % 3 == 0:
        outside = [
            (0.05, 0),
            (0.055, 0.01),
            (0.045, 0.03),
            (0.07, 0.1),
            (0.09, 0.18),
            (0.08, 0.24),
            (0.04, 0.28),
            (0.035, 0.3),
            (0.05, 0.32),
        ]
        hollow(b, outside, 0.006, "white", segments=26, floor=0.02)
        for level, r in ((0.02, 0.053), (0.11, 0.074), (0.225, 0.086), (0.29, 0.038)):
            b.lathe([(r, level), (r + 0.001, level + 0.006)], color="signal blue", segments=26)
        for k in range(7):
            a = 2 * np.pi * k / 7
            b.ball(
                (0.018, 0.018, 0.024), (0.074 * np.cos(a), 0.074 * np.sin(a), 0.165), "signal blue", segments=8, rings=6
            )
        size = (0.18, 0.18, 0.32)
    elif variant % 3 == 1:
        outside = [
            (0.06, 0),
            (0.065, 0.015),
            (0.05, 0.03),
            (0.1, 0.15),
            (0.13, 0.28),
            (0.11, 0.37),
            (0.05, 0.43),
            (0.045, 0.5),
            (0.07, 0.53),
        ]
        hollow(b, outside, 0.008, "terracotta", segments=24, floor=0.03)
        for side in (-1, 1):
            b.tube(
                [(0, side * 0.11, 0.36), (0, side * 0.15, 0.42), (0, side * 0.12, 0.5), (0, side * 0.05, 0.5)],
                0.012,
                "terracotta",
            )
        for level, r in ((0.2, 0.112), (0.32, 0.126)):
            b.lathe([(r, level), (r + 0.002, level + 0.012)], color="dark wood", segments=24)
        size = (0.26, 0.29, 0.53)
    else:
        hollow(
            b,
            [(0.07, 0), (0.07, 0.02), (0.045, 0.05), (0.05, 0.2), (0.075, 0.4), (0.1, 0.44)],
            0.006,
            "#7fb7b0",
            segments=10,
            floor=0.04,
        )
        for k in range(5):
            a = 2.4 * k
            tip = (0.09 * np.cos(a), 0.09 * np.sin(a), 0.68 + 0.03 * (k % 3))
            b.tube([(0.01, 0, 0.06), (tip[0] * 0.4, tip[1] * 0.4, 0.42), tip], 0.005, "leaf", sides=5)
            b.lathe(
                [(0.01, -0.02), (0.035, 0.01), (0.03, 0.05), (0.01, 0.06)],
                tip,
                ("red", "pink", "signal yellow")[k % 3],
                segments=8,
            )
        size = (0.25, 0.25, 0.75)
    return made(b, ("a blue-and-white vase", "a clay amphora", "a glass vase with tulips")[variant % 3], size)


@recipe("candle", 2, name="vessels.candle")
def candle(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A pillar candle with runs of wax, a taper in a brass holder with a ring; both burn."""
    b = MeshBuilder(roughness=0.6)
    if variant % 2 == 0:
        color, r, top = "cream", 0.03, 0.115
        b.lathe([(r, 0), (r, top), (r * 0.93, top + 0.004), (r * 0.5, top - 0.006)], color=color, segments=24)
        for k in range(5):
            a, low = 1.3 * k, float(rng.uniform(0.05, 0.09))
            b.tube(
                [(r * np.cos(a), r * np.sin(a), top), (r * 1.02 * np.cos(a), r * 1.02 * np.sin(a), low)],
                [0.003, 0.005],
                color,
                sides=7,
            )
    else:
        color, r, top = "signal red", 0.011, 0.23
        hollow(b, [(0.035, 0), (0.05, 0.005), (0.055, 0.02)], 0.004, "brass", segments=22)
        b.lathe([(0.014, 0.004), (0.014, 0.03), (0.02, 0.035)], color="brass", segments=16)
        b.ring(0.018, 0.004, (0, 0.068, 0.012), "brass", (0, 90, 0), 16, 6)
        b.cylinder(r, top - 0.02, (0, 0, 0.02), color, top_radius=r * 0.8, segments=14)
    b.rod((0, 0, top - 0.008), (0.001, 0, top + 0.01), 0.0015, "black", sides=5)
    b.lathe([(0.002, 0), (0.007, 0.01), (0.005, 0.02), (0, 0.034)], (0, 0, top + 0.002), "amber", segments=10)
    size = (0.065, 0.065, 0.14) if variant % 2 == 0 else (0.105, 0.12, 0.26)
    return made(b, "a burning candle", size, color=color)


@recipe("balloon", 3, name="vessels.balloon")
def balloon(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """One balloon with its knot and string, a bunch of seven, a heart of foil."""
    b = MeshBuilder(roughness=0.2)
    profile = [
        (0.004, -0.18),
        (0.012, -0.185),
        (0.008, -0.165),
        (0.05, -0.12),
        (0.11, -0.03),
        (0.143, 0.06),
        (0.135, 0.12),
        (0.09, 0.165),
        (0, 0.18),
    ]
    inks = ("signal red", "signal yellow", "signal blue", "green", "orange", "pink", "purple")
    if variant % 3 == 0:
        b.lathe(profile, (0, 0, 0), "signal red", segments=22, crease_deg=60)
        b.ball((0.02, 0.012, 0.035), (0.1, 0.06, 0.09), "light red", (0, -30, 30), 8, 6)
        size: tuple[float, float, float] = (0.29, 0.285, 0.36)
    elif variant % 3 == 1:
        for k, color in enumerate(inks):
            a = 2 * np.pi * k / 6
            at = (0.24 * np.cos(a), 0.24 * np.sin(a), 0.02 * (-1) ** k) if k < 6 else (0.0, 0.0, 0.25)
            b.lathe(
                [(r, z * 0.95) for r, z in profile],
                at,
                color,
                (-20 * np.sin(a) * (k < 6), 20 * np.cos(a) * (k < 6), 0),
                16,
                60,
            )
            b.rod((at[0] * 0.8, at[1] * 0.8, at[2] - 0.16), (0, 0, -1.1), 0.003, "white", sides=4)
        b.box((0.06, 0.06, 0.06), (0, 0, -1.15), "charcoal", bevel=0.01)
        size = (0.72, 0.72, 1.6)
    else:
        t = np.linspace(0, 2 * np.pi, 33)[:-1]
        heart = np.column_stack([0.16 * np.sin(t) ** 3, 0.13 * np.cos(t) - 0.05 * np.cos(2 * t) - 0.02 * np.cos(3 * t)])
        rows = [
            np.column_stack([np.full(32, x), heart * s])
            for x, s in (
                (-0.07, 0.3),
                (-0.055, 0.7),
                (-0.025, 0.95),
                (0, 1.02),
                (0.025, 0.95),
                (0.055, 0.7),
                (0.07, 0.3),
            )
        ]
        b.loft([r[::-1] for r in rows], "pink", crease_deg=70)
        b.tube([(0, 0, -0.19), (0.01, 0.01, -0.4), (0, -0.01, -0.6), (0, 0, -0.75)], 0.003, "white", sides=4)
        size = (0.34, 0.2, 0.95)
        return made(b, "a heart-shaped foil balloon", (0.2, 0.34, 0.95), count=1)
    return made(b, "a balloon" if variant % 3 == 0 else "a bunch of balloons", size, count=1 if variant % 3 == 0 else 7)
