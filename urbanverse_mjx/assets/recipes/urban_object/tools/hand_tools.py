"""Tools that work by hand. Hafted and jawed ones lie on their side, the head towards +x; long ones stand."""

from collections.abc import Sequence

import numpy as np

from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, shade
from ....meshes.recipe import recipe
from ....meshes.shapes import Point2, Points3
from ...shared.outlines import curve, ellipse, mirrored, pairs, rounded
from ...shared.sizes import varied


def haft(b: MeshBuilder, path: Points3, widths: Sequence[float], depth: float, color: Color) -> None:
    """An oval handle along a path near the x axis; `widths` across y at each point, `depth` along z."""
    a = np.arange(10) * (2 * np.pi / 10)
    points = np.asarray(path, float)
    b.loft(
        [
            p + np.stack([np.zeros(10), w / 2 * np.cos(a), depth / 2 * np.sin(a)], 1)
            for p, w in zip(points, widths, strict=True)
        ],
        color,
    )


@recipe("axe", 3, name="hand_tools.axe")
def axe(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Felling axe with a curved haft, red-headed hatchet, double-bitted axe; lying, the head at +x."""
    b = MeshBuilder(roughness=0.5)
    style = ("felling axe", "hatchet", "double-bitted axe")[variant]
    length = (0.62, 0.3, 0.75)[variant]
    wood: Color = ("wood", "light wood", "dark wood")[variant]
    sway = 0.012 if variant < 2 else 0.0
    xs = np.linspace(-length, 0.035, 9)
    path = [(x, sway * np.sin(2 * np.pi * (x / length)), 0) for x in xs]
    haft(b, path, [0.03, 0.044, 0.034, 0.03, 0.03, 0.031, 0.032, 0.034, 0.03], 0.024, wood)
    poll = [(-0.028, 0.03), (0.03, 0.03), (0.03, -0.02), (0.034, -0.05), (0.062, -0.115)]
    edge = [(0.052, -0.13), (0.02, -0.14), (-0.02, -0.138), (-0.058, -0.12), (-0.034, -0.05), (-0.028, -0.02)]
    steel: Color = ("charcoal", "signal red", "dark grey")[variant]
    half = [*poll, *edge]
    if style == "double-bitted axe":
        bit = [(0.03, -0.02), (0.034, -0.05), (0.062, -0.115), *edge]
        half = [*bit, *[(x, -y) for x, y in reversed(bit)]]
    b.extrude(half, 0.03, (0, 0, -0.015), steel)
    for s in (-1, 1) if style == "double-bitted axe" else (1,):
        blade = [
            (0.056, -0.1),
            (0.064, -0.118),
            (0.052, -0.133),
            (0.02, -0.144),
            (-0.02, -0.142),
            (-0.06, -0.123),
            (-0.05, -0.1),
            (0, -0.115),
        ]
        b.extrude([(x, s * y) for x, y in blade], 0.032, (0, 0, -0.016), "aluminium")
    b.box((0.012, 0.022, 0.01), (0.033, 0, -0.005), "light wood")
    size = ((0.66, 0.185, 0.036), (0.36, 0.15, 0.03), (0.8, 0.28, 0.04))[variant]
    return varied(b, rng, size, f"a {style}", style)


@recipe("hammer", 3, name="hand_tools.hammer")
def hammer(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Claw hammer, sledge hammer, rubber mallet; lying, the head at +x."""
    b = MeshBuilder(roughness=0.45)
    style = ("claw hammer", "sledge hammer", "rubber mallet")[variant]
    length = (0.3, 0.8, 0.3)[variant]
    grip: Color = ("wood", "light wood", "signal yellow")[variant]
    xs = np.linspace(-length, 0.012, 6)
    haft(b, [(x, 0, 0) for x in xs], [0.03, 0.034, 0.026, 0.024, 0.022, 0.022], 0.024, grip)
    if style == "claw hammer":
        haft(b, [(-0.3, 0, 0), (-0.29, 0, 0), (-0.19, 0, 0), (-0.18, 0, 0)], [0.034, 0.038, 0.034, 0.028], 0.03, "blue")
        b.box((0.03, 0.05, 0.028), (0, 0, -0.014), "dark grey", bevel=0.006)
        b.cylinder(0.011, 0.02, (0, -0.02, 0), "dark grey", (90, 0, 0), segments=12)
        b.lathe(
            [(0.013, 0), (0.0155, 0.004), (0.0155, 0.018), (0.013, 0.02)],
            (0, -0.036, 0),
            "aluminium",
            (90, 0, 0),
            segments=14,
        )
        side = curve([(0.014, 0.02), (0.012, 0.045), (-0.004, 0.072), (-0.03, 0.09)], 3)
        other = curve([(-0.034, 0.084), (-0.018, 0.06), (-0.012, 0.04), (-0.014, 0.02)], 3)
        for s in (-1, 1):
            b.extrude(pairs(np.vstack([side, other])), 0.009, (0, 0, 0.0075 * s - 0.0045), "dark grey")
    elif style == "sledge hammer":
        b.lathe(
            [
                (0.03, -0.09),
                (0.036, -0.08),
                (0.036, -0.03),
                (0.03, -0.02),
                (0.03, 0.02),
                (0.036, 0.03),
                (0.036, 0.08),
                (0.03, 0.09),
            ],
            color="charcoal",
            turn_deg=(-90, 0, 22.5),
            segments=8,
        )
    else:
        b.lathe(
            [(0.03, -0.065), (0.036, -0.06), (0.036, 0.06), (0.03, 0.065)],
            color="black",
            turn_deg=(-90, 0, 0),
            segments=18,
        )
        haft(
            b, [(-0.3, 0, 0), (-0.29, 0, 0), (-0.18, 0, 0), (-0.17, 0, 0)], [0.034, 0.038, 0.034, 0.028], 0.03, "black"
        )
    size = ((0.325, 0.127, 0.032), (0.86, 0.19, 0.068), (0.34, 0.13, 0.062))[variant]
    return varied(b, rng, size, f"a {style}", style)


@recipe("bottle opener", 2, hulls=1, name="hand_tools.bottle_opener")
def bottle_opener(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Flat steel one with its eye; wing corkscrew with levers and screw. Both lie, the working end at +x."""
    b = MeshBuilder(roughness=0.25, metallic=0.4)
    style = ("flat", "winged corkscrew")[variant]
    if style == "flat":
        half = [
            (-0.058, 0.0),
            (-0.055, 0.009),
            (-0.01, 0.01),
            (0.012, 0.012),
            (0.025, 0.02),
            (0.045, 0.021),
            (0.057, 0.012),
            (0.058, 0.0),
        ]
        eye = [
            (0.018, 0.004),
            (0.026, 0.013),
            (0.044, 0.013),
            (0.05, 0.005),
            (0.05, -0.005),
            (0.044, -0.013),
            (0.026, -0.013),
            (0.018, -0.004),
            (0.026, -0.006),
            (0.03, 0.0),
            (0.026, 0.006),
        ]
        outline = [*half[:1], *[(x, -y) for x, y in half[1:-1]], half[-1], *reversed(half[1:-1])]
        b.extrude(outline, 0.003, color="aluminium", holes=[eye, ellipse(0.004, 0.004, 12, (-0.048, 0))])
        b.extrude(rounded(0.042, 0.016, 0.007), 0.004, (-0.02, 0, 0.0), "signal red")
        b.ring(0.009, 0.001, (-0.053, 0, 0.003), "aluminium", (0, 40, 0), segments=14, sides=5)
    else:
        b.ring(0.014, 0.003, (0.06, 0, 0.012), "aluminium", (0, 90, 0), segments=16, sides=6)
        lever = pairs(
            curve([(-0.02, 0.01), (-0.015, 0.022), (0.03, 0.036), (0.055, 0.036), (0.055, 0.028), (0.03, 0.027)], 2)
        )
        for s in (-1, 1):
            b.rod((0.06, 0.013 * s, 0.012), (-0.02, 0.011 * s, 0.012), 0.003, "aluminium", sides=6)
            b.cylinder(0.011, 0.006, (-0.02, 0.016 * s, 0.009), "grey", segments=12)
            b.extrude([(x, s * y) for x, y in lever], 0.005, (0, 0, 0.0095), "aluminium")
        b.rod((-0.07, 0, 0.012), (0.0, 0, 0.012), 0.004, "dark grey", sides=8)
        a = np.linspace(0, 10 * np.pi, 50)
        b.tube(np.stack([0.055 * a / a[-1], 0.005 * np.cos(a), 0.012 + 0.005 * np.sin(a)], 1), 0.0016, "grey", sides=4)
        grip = [(-0.105, -0.014), (-0.072, -0.008), (-0.072, 0.008), (-0.105, 0.014), (-0.11, 0.0)]
        b.extrude(grip, 0.006, (0, 0, 0.009), "aluminium", holes=[ellipse(0.008, 0.006, 12, (-0.094, 0))])
    size = ((0.115, 0.042, 0.0142), (0.172, 0.067, 0.027))[variant]
    return varied(b, rng, size, f"a {style} bottle opener", style)


_JAW: list[Point2] = [
    (0.018, 0.0),
    (0.088, 0.0),
    (0.088, 0.008),
    (0.05, 0.022),
    (0.01, 0.024),
    (-0.012, 0.016),
    (-0.012, 0.0),
]


@recipe("pliers", 3, hulls=1, name="hand_tools.pliers")
def pliers(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Combination, long-nosed and water-pump pliers with coloured grips; lying, the jaws at +x."""
    b = MeshBuilder(roughness=0.4)
    style = ("combination", "long-nosed", "water-pump")[variant]
    grip: Color = ("signal red", "blue", "signal yellow")[variant]
    nose = (0.055, 0.085, 0.05)[variant]
    for s in (-1, 1):
        with b.frame((0, 0, 0.0012 * s), scale=(1, s, 1)):
            tip = 0.01 if variant != 1 else 0.003
            jaw = [
                (0.012, 0.001),
                (nose, 0.0015),
                (nose, tip),
                (nose * 0.5, 0.013),
                (0.01, 0.017),
                (-0.015, 0.012),
                (-0.012, -0.008),
                (0, -0.01),
            ]
            b.extrude(jaw, 0.011, (0, 0, 0.0045), "galvanised" if variant < 2 else "charcoal")
            path = curve(
                [(-0.012, -0.004, 0.01), (-0.04, -0.016, 0.01), (-0.09, -0.026, 0.01), (-0.125, -0.022, 0.01)], 3
            )
            b.tube(path[:4], 0.0055, "galvanised" if variant < 2 else "charcoal", sides=8)
            b.tube(
                path[2:], [0.0065, 0.0075, 0.008, 0.0085, 0.0085, 0.0085, 0.008, 0.0065][: len(path) - 2], grip, sides=8
            )
            for k in range(5):
                b.box((0.0016, 0.004, 0.0114), (0.018 + 0.006 * k, 0.0025, 0.0043), "dark grey")
    b.cylinder(0.009, 0.0165, (0, 0, 0.0022), "aluminium", segments=16)
    size = ((0.178, 0.056, 0.02), (0.2, 0.052, 0.016), (0.25, 0.062, 0.02))[variant]
    return varied(b, rng, size, f"a pair of {style} pliers", style)


@recipe("scissors", 3, hulls=1, name="hand_tools.scissors")
def scissors(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Half-open household scissors with orange loops, all-steel ones, small blunt green ones; the points at +x."""
    b = MeshBuilder(roughness=0.3, metallic=0.2)
    style = ("household", "steel", "small blunt")[variant]
    loop: Color = ("orange", "aluminium", "green")[variant]
    tip = 0.004 if variant < 2 else 0.008
    for s in (-1, 1):
        with b.frame((0, 0, 0.0018 * s), (0, 0, 9.0 * s), (1, s, 1)):
            blade = [
                (-0.03, -0.012),
                (0.0, -0.006),
                (0.105, -0.003),
                (0.11, 0.0),
                (0.105, tip),
                (0.02, 0.009),
                (-0.03, -0.001),
            ]
            b.extrude(blade, 0.0022, (0, 0, 0.004), "grey")
            ring = ellipse(0.033, 0.02, 18, (-0.062, -0.012))
            b.extrude(ring, 0.009, (0, 0, 0.0005), loop, holes=[ellipse(0.025, 0.0125, 16, (-0.063, -0.0125))])
            b.extrude(
                [(-0.04, -0.024), (-0.022, -0.012), (-0.022, 0.0), (-0.034, 0.002), (-0.042, -0.004)],
                0.009,
                (0, 0, 0.0005),
                loop,
            )
    b.cylinder(0.005, 0.0095, (0, 0, 0.0005), "dark grey", segments=12)
    size = ((0.195, 0.079, 0.012), (0.24, 0.1, 0.012), (0.13, 0.064, 0.01))[variant]
    return varied(b, rng, size, f"{style} scissors", style)


@recipe("screwdriver", 3, hulls=1, name="hand_tools.screwdriver")
def screwdriver(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Red and black slotted one, yellow cross-headed one, old one with a wooden handle; the tip at +x."""
    b = MeshBuilder(roughness=0.4)
    style = ("slotted", "cross-headed", "wooden-handled")[variant]
    main, band = (("signal red", "black"), ("signal yellow", "charcoal"), ("wood", "brass"))[variant]
    with b.frame(turn_deg=(0, 90, 0)):
        body = [
            (0.008, -0.105),
            (0.0135, -0.1),
            (0.0155, -0.085),
            (0.0155, -0.05),
            (0.0125, -0.035),
            (0.0105, -0.022),
            (0.0125, -0.008),
            (0.009, 0.0),
        ]
        b.lathe(body, color=main, segments=8 if variant < 2 else 14, crease_deg=30.0)
        for k in range(6 if variant < 2 else 0):
            a = np.radians(60 * k)
            b.box((0.003, 0.004, 0.05), (0.0145 * np.cos(a), 0.0145 * np.sin(a), -0.093), band, (0, 0, 60 * k))
        b.cylinder(0.0095, 0.006, (0, 0, -0.002), band, segments=12)
        b.cylinder(0.0036, 0.1, (0, 0, 0), "aluminium", segments=10)
        if variant == 1:
            b.cylinder(0.0036, 0.01, (0, 0, 0.1), "grey", top_radius=0.001, segments=8)
            for turn in (0, 90):
                b.box((0.0015, 0.007, 0.008), (0, 0, 0.098), "dark grey", (0, 0, turn))
        else:
            b.box((0.0035, 0.0085, 0.012), (0, 0, 0.098), "grey", taper=(0.25, 0.8))
    size = ((0.215, 0.031, 0.031), (0.26, 0.036, 0.036), (0.18, 0.028, 0.028))[variant]
    return varied(b, rng, size, f"a {style} screwdriver", style, jitter=0.0)


def _open_jaw(radius: float, gap: float, at: Point2, turn: float, count: int = 14) -> list[Point2]:
    """A spanner's open end: a disc with a slot of `gap` towards `turn` degrees."""
    half = np.degrees(np.arcsin(gap / 2 / radius))
    rim = ellipse(radius, radius, count, (0, 0), half + 2, 360 - half - 2)
    slot = [(radius * 0.1, -gap / 2), (-radius * 0.12, 0.0), (radius * 0.1, gap / 2)]
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    return [(at[0] + c * x - s * y, at[1] + s * x + c * y) for x, y in (*rim, *slot)]


@recipe("wrench", 3, hulls=1, name="hand_tools.wrench")
def wrench(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Combination spanner, adjustable wrench, red pipe wrench; lying, the jaw at +x."""
    b = MeshBuilder(roughness=0.3, metallic=0.4)
    style = ("combination spanner", "adjustable wrench", "pipe wrench")[variant]
    if style == "combination spanner":
        b.extrude(_open_jaw(0.0215, 0.019, (0.085, 0), 15), 0.0085, (0, 0, 0.0012), "white")
        b.extrude(mirrored([(-0.088, 0.0075), (0.066, 0.009)]), 0.006, (0, 0, 0.0025), "galvanised")
        b.extrude([(-0.07, -0.003), (0.05, -0.003), (0.05, 0.003), (-0.07, 0.003)], 0.008, (0, 0, 0.0015), "light grey")
        b.extrude(
            ellipse(0.0165, 0.0165, 20, (-0.1, 0)),
            0.011,
            (0, 0, 0),
            "aluminium",
            holes=[ellipse(0.0098, 0.0098, 12, (-0.1, 0))],
        )
    else:
        pipe = style == "pipe wrench"
        color: Color = "signal red" if pipe else "galvanised"
        half = [(-0.14, 0.0), (-0.138, 0.012), (-0.05, 0.009), (0.01, 0.013)]
        b.extrude(
            [
                *half,
                (0.03, 0.028),
                (0.045, 0.028),
                (0.045, 0.008),
                (0.055, -0.006),
                (0.09, -0.008),
                (0.088, -0.022),
                (0.03, -0.03),
                (0.01, -0.016),
                *[(x, -y) for x, y in reversed(half[1:3])],
            ],
            0.013,
            color=color,
            holes=[ellipse(0.006, 0.006, 12, (-0.125, 0))],
        )
        jaw = [(0.03, 0.026), (0.085, 0.024), (0.082, 0.012), (0.05, 0.01), (0.03, 0.016)]
        b.extrude(jaw, 0.015, (0, 0, -0.001), "dark grey" if pipe else "aluminium")
        b.cylinder(0.0075, 0.02, (0.02, 0.006, 0.0065), "charcoal", (-90, 0, 0), segments=12)
        for k in range(4):
            b.ring(0.0076, 0.0012, (0.02, 0.009 + 0.005 * k, 0.0065), "grey", (90, 0, 0), segments=12, sides=3)
        if pipe:
            b.box((0.07, 0.008, 0.015), (-0.06, 0, -0.001), shade(color, 0.8))
        else:
            b.extrude(
                rounded(0.1, 0.029, 0.012),
                0.019,
                (-0.085, 0, -0.003),
                "orange",
                holes=[ellipse(0.007, 0.007, 12, (-0.038, 0))],
            )
    size = ((0.215, 0.046, 0.011), (0.25, 0.07, 0.018), (0.45, 0.095, 0.029))[variant]
    return varied(b, rng, size, f"a {style}", style)
