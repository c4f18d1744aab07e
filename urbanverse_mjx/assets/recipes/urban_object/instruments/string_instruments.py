"""Guitars, violins, cellos, harps. What lies shows its strings upwards, the neck along +x."""

import numpy as np

from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, shade
from ....meshes.recipe import recipe
from ....meshes.shapes import Point2
from ...shared.outlines import curve, ellipse, pairs
from ...shared.sizes import varied


def strings(
    b: MeshBuilder, count: int, start: tuple[float, float, float], end: tuple[float, float, float], radius: float
) -> None:
    """Strings fanned between two (x, half width, z) ends."""
    for k in range(count):
        s = 2 * k / (count - 1) - 1
        b.rod((start[0], s * start[1], start[2]), (end[0], s * end[1], end[2]), radius, "light grey", sides=3)


def _body(points: list[Point2], steps: int = 3) -> list[Point2]:
    """A smooth body from the control points of its left half, both ends on the axis."""
    whole = [*points, *[(x, -y) for x, y in reversed(points[1:-1])]]
    return pairs(curve(whole, steps, closed=True))


_CLASSICAL: list[Point2] = [
    (-0.25, 0),
    (-0.235, 0.1),
    (-0.16, 0.18),
    (-0.05, 0.165),
    (0.04, 0.118),
    (0.13, 0.135),
    (0.21, 0.1),
    (0.235, 0),
]
_ELECTRIC: list[Point2] = [
    (-0.2, 0),
    (-0.2, 0.09),
    (-0.13, 0.15),
    (-0.02, 0.11),
    (0.06, 0.105),
    (0.15, 0.13),
    (0.19, 0.1),
    (0.1, 0.04),
    (0.1, 0),
]
# Waists of violins are narrower than those of guitars and end in corners, which the closely set points draw.
_VIOLIN: list[Point2] = [
    (-0.178, 0),
    (-0.17, 0.06),
    (-0.12, 0.103),
    (-0.062, 0.093),
    (-0.05, 0.098),
    (-0.035, 0.068),
    (0.01, 0.055),
    (0.045, 0.066),
    (0.06, 0.088),
    (0.07, 0.078),
    (0.12, 0.083),
    (0.168, 0.05),
    (0.178, 0),
]


_PLATE: list[Point2] = [
    (0.09, -0.03),
    (0.1, -0.07),
    (0.0, -0.1),
    (-0.1, -0.1),
    (-0.06, -0.04),
    (-0.07, 0.04),
    (0.09, 0.05),
]


def _guitar_face(b: MeshBuilder, variant: int, z: float) -> None:
    """Sound hole and bridge of the hollow ones; plate, pickups and knobs of the electric one (variant 1)."""
    if variant != 1:
        b.cylinder(0.052, 0.0012, (0.075, 0, z), "dark red" if variant == 0 else "light wood", segments=24)
        b.cylinder(0.043, 0.002, (0.075, 0, z), "black", segments=24)
        b.box((0.03, 0.16, 0.009), (-0.12, 0, z), "#2a1c14", bevel=0.003)
        b.box((0.004, 0.075, 0.006), (-0.115, 0, z + 0.007), "white")
        if variant == 2:
            b.extrude([(0.03, -0.045), (0.06, -0.1), (-0.01, -0.115), (-0.03, -0.07)], 0.0015, (0, 0, z), "black")
    else:
        b.extrude(
            pairs(curve(_PLATE, 3, closed=True)),
            0.003,
            (0, 0, z - 0.001),
            "white",
        )
        for x in (-0.05, 0.01, 0.065):
            b.box((0.02, 0.075, 0.008), (x, 0, z), "black", bevel=0.004)
        b.box((0.04, 0.075, 0.01), (-0.1, 0, z), "aluminium", bevel=0.002)
        for k in range(3):
            b.cylinder(0.011, 0.012, (-0.04 - 0.035 * k, -0.08 - 0.006 * k, z), "black", segments=12)


def _guitar_head(b: MeshBuilder, nut: float, head: float, z: float, electric: bool, wood: Color) -> None:
    """The head from x = `nut` to x = `head` with its six tuners, three to a side or all in line."""
    wide = 0.03 if electric else 0.034
    b.convex(
        [(nut, s * 0.023, h) for s in (-1, 1) for h in (z - 0.006, z + 0.008)]
        + [(head, s * wide, h) for s in (-1, 1) for h in (z - 0.026, z - 0.012)],
        wood if not electric else "light wood",
    )
    for k in range(6):
        s = -1 if k % 2 else 1
        if electric:
            s, x = 1, nut + 0.02 + 0.02 * k
        else:
            x = nut + 0.03 + 0.045 * (k // 2)
        b.cylinder(0.004, 0.02, (x, s * 0.028, z - 0.012), "aluminium", (-90 * s, 0, 0), segments=6)
        b.box(
            (0.014, 0.012, 0.008),
            (x, s * (0.055 if not electric else 0.05), z - 0.016),
            "white" if not electric else "aluminium",
            bevel=0.003,
        )


@recipe("guitar", 3, name="string_instruments.guitar")
def guitar(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Classical guitar, red electric guitar, dark steel-stringed guitar."""
    b = MeshBuilder(roughness=0.35)
    style = ("classical", "electric", "dark steel-stringed")[variant]
    top, side = (("#d9a55c", "#7a4526"), ("signal red", "dark red"), ("#5b2c1a", "#2c1a12"))[variant]
    electric = style == "electric"
    deep = 0.04 if electric else 0.095
    outline = _body(_ELECTRIC if electric else _CLASSICAL)
    b.extrude(outline, deep, color=side)
    b.extrude([(x * 0.985, y * 0.985) for x, y in outline], 0.004, (0, 0, deep), top)
    neck_start, nut, head = (0.05, 0.46, 0.6) if electric else (0.1, 0.6, 0.76)
    z = deep + 0.004
    b.convex(
        [
            (x, y, h)
            for x, y in ((neck_start, 0.027), (nut, 0.022), (neck_start, -0.027), (nut, -0.022))
            for h in (z, z + 0.01)
        ],
        "#2a1c14",
    )
    root, depth = (0.1, 0.02) if electric else (0.22, 0.045)
    flat = [(x, w, z) for x, half in ((root, 0.026), (nut, 0.022)) for w in (-half, half)]
    b.convex([*flat, (root, 0, z - depth), (nut, 0, z - 0.012)], "light wood" if electric else side)
    for k in range(12):
        x = nut - (nut - neck_start) * 0.98 * (1 - 2 ** (-k / 9.0)) / (1 - 2 ** (-11 / 9.0))
        b.box((0.002, 0.046, 0.0015), (x, 0, z + 0.0095), "light grey")
    _guitar_face(b, variant, z)
    _guitar_head(b, nut, head, z, electric, side)
    bridge = -0.115 if not electric else -0.1
    strings(b, 6, (bridge, 0.028, z + 0.014), (nut, 0.018, z + 0.011), 0.0011)
    size = ((1.02, 0.37, 0.104), (0.98, 0.33, 0.055), (1.05, 0.4, 0.125))[variant]
    return varied(b, rng, size, f"a {style} guitar", style)


def _violin(b: MeshBuilder, varnish: Color, deep: float, bridge: float) -> None:
    """The violin family in a violin's lengths: `deep` ribs and a `bridge` as high as asked, m."""
    outline = _body(_VIOLIN, 2)
    b.extrude([(x * 0.97, y * 0.97) for x, y in outline], deep, color=shade(varnish, 0.75))
    for z in (0.0, deep - 0.003):
        b.extrude(outline, 0.005, (0, 0, z), varnish)
    z = deep + 0.002
    b.loft(
        [
            np.array([(x * s, y * s, h) for x, y in reversed(outline)])
            for s, h in ((0.96, z - 0.001), (0.8, z + 0.005), (0.45, z + 0.01))
        ],
        varnish,
    )
    top = z + 0.011
    b.convex(
        [(0.0, s * 0.02, h) for s in (-1, 1) for h in (top + 0.008, top + 0.014)]
        + [(0.3, s * 0.012, h) for s in (-1, 1) for h in (top, top + 0.006)],
        "black",
    )
    b.convex(
        [
            (0.16, 0.015, z),
            (0.16, -0.015, z),
            (0.31, 0.012, top),
            (0.31, -0.012, top),
            (0.17, 0, z - 0.02),
            (0.31, 0, top - 0.014),
        ],
        shade(varnish, 0.8),
    )
    b.convex(
        [
            (x, s * w, h)
            for s in (-1, 1)
            for x, w, h in (
                (-0.17, 0.01, z + 0.008),
                (-0.17, 0.01, z + 0.014),
                (-0.07, 0.022, top + 0.008),
                (-0.07, 0.022, top + 0.014),
            )
        ],
        "black",
    )
    b.convex(
        [
            (x, s * w, h)
            for s in (-1, 1)
            for x in (-0.024, -0.02)
            for w, h in ((0.021, z + 0.005), (0.017, top + bridge))
        ],
        "light wood",
    )
    for s in (-1, 1):
        hole = curve([(0.035, 0.036 * s), (0.012, 0.043 * s), (-0.035, 0.048 * s), (-0.055, 0.06 * s)], 3)
        b.tube(np.column_stack([hole, np.full(len(hole), z + 0.0055)]), 0.0022, "black", sides=4)
    b.box((0.055, 0.02, 0.016), (0.335, 0, top - 0.01), shade(varnish, 0.8), taper=(1, 0.8))
    spiral = [
        (0.37 + 0.012 * np.cos(a) * (1 - a / 12), 0, top + 0.004 - 0.012 * np.sin(a) * (1 - a / 12))
        for a in np.linspace(-2.5, 6, 9)
    ]
    b.tube(spiral, 0.006, shade(varnish, 0.8), sides=6)
    for k in range(4):
        s = 1 if k % 2 else -1
        b.cylinder(0.003, 0.03, (0.315 + 0.013 * k, 0, top - 0.002), "black", (-90 * s, 0, 0), segments=6)
        b.box((0.009, 0.01, 0.008), (0.315 + 0.013 * k, 0.032 * s, top - 0.006), "black", bevel=0.002)
    strings(b, 4, (-0.07, 0.013, top + 0.013), (-0.022, 0.0155, top + bridge), 0.0009)
    strings(b, 4, (-0.022, 0.0155, top + bridge), (0.305, 0.007, top + 0.006), 0.0009)


@recipe("violin", 2, name="string_instruments.violin")
def violin(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Amber violin with its chin rest; dark one with its bow beside it."""
    b = MeshBuilder(roughness=0.25)
    style = ("amber", "dark with its bow")[variant]
    varnish: Color = ("#b5652a", "#5a2814")[variant]
    _violin(b, varnish, 0.038, 0.024)
    b.extrude(ellipse(0.03, 0.035, 16, (-0.145, 0.05)), 0.012, (0, 0, 0.045), "black")
    if variant == 1:
        stick = curve([(-0.2, -0.115, 0.01), (0.1, -0.112, 0.006), (0.38, -0.115, 0.014)], 4)
        b.tube(stick, 0.004, "#4a2412", sides=6)
        b.rod((-0.18, -0.128, 0.012), (0.375, -0.128, 0.012), 0.0018, "cream", sides=4)
        b.box((0.03, 0.02, 0.012), (-0.175, -0.121, 0.004), "black")
    size = ((0.59, 0.208, 0.09), (0.61, 0.235, 0.1))[variant]
    return varied(b, rng, size, f"a violin, {style}", style)


@recipe("cello", 2, name="string_instruments.cello")
def cello(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Reddish cello, honey-coloured one; lying on its back with its end pin out."""
    b = MeshBuilder(roughness=0.25)
    style = ("reddish", "honey-coloured")[variant]
    _violin(b, ("#8e3f1c", "#c07a32")[variant], 0.062, 0.045)
    b.rod((-0.175, 0, 0.035), (-0.25 + 0.02 * variant, 0, 0.035), 0.003, "aluminium", sides=8)
    b.ball(0.008, (-0.18, 0, 0.035), "black", segments=8, rings=5)
    size = ((1.24, 0.445, 0.27), (1.18, 0.42, 0.25))[variant]
    return varied(b, rng, size, f"a {style} cello", style)


@recipe("harp", 2, name="string_instruments.harp")
def harp(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Gilded pedal harp with its fluted column; small wooden lever harp. The column stands at +x."""
    b = MeshBuilder(roughness=0.35)
    style = ("gilded pedal", "wooden lever")[variant]
    frame, box = (("gold", "#a8702e"), ("wood", "light wood"))[variant]
    low, high = np.array([0.28, 0, 0.1]), np.array([-0.4, 0, 1.32])
    axis = (high - low) / np.linalg.norm(high - low)
    rows = []
    for share, half, thick in ((0.0, 0.2, 0.1), (0.5, 0.13, 0.08), (1.0, 0.06, 0.05)):
        back = np.array([-axis[2], 0, axis[0]]) * thick * 1.6
        at = low + (high - low) * share
        rows.append(
            np.array(
                [
                    at + (0, half, 0),
                    at + back * 0.8 + (0, half * 0.7, 0),
                    at + back,
                    at + back * 0.8 - (0, half * 0.7, 0),
                    at - (0, half, 0),
                ]
            )
        )
    b.loft(rows, box)
    b.box((0.42, 0.46, 0.1), (0.2, 0, 0), frame, bevel=0.03)
    neck = curve(
        [(-0.42, 0, 1.34), (-0.3, 0, 1.36), (-0.1, 0, 1.28), (0.1, 0, 1.36), (0.28, 0, 1.58), (0.4, 0, 1.62)], 4
    )
    b.tube(neck, np.interp(np.arange(len(neck)), [0, 8, len(neck) - 1], [0.05, 0.045, 0.06]).tolist(), frame, sides=8)
    if style == "gilded pedal":
        b.lathe(
            [
                (0.07, 0),
                (0.05, 0.05),
                (0.034, 0.1),
                (0.032, 1.4),
                (0.05, 1.44),
                (0.06, 1.52),
                (0.075, 1.58),
                (0.06, 1.6),
            ],
            (0.4, 0, 0.08),
            frame,
            segments=12,
            crease_deg=20,
        )
        b.ball((0.05, 0.05, 0.035), (0.4, 0, 1.69), frame, segments=12, rings=6)
        for k in range(7):
            b.box((0.07, 0.02, 0.015), (-0.02, -0.15 + 0.05 * k, 0.03), "brass")
    else:
        b.tube([(0.4, 0, 0.08), (0.45, 0, 0.8), (0.4, 0, 1.62)], 0.035, frame, sides=8)
    for k in range(18):
        share = 0.08 + 0.86 * k / 17
        foot = low + (high - low) * share
        tip = neck[round((1 - share) * (len(neck) - 4)) + 1]
        ink = "signal red" if k % 7 == 0 else "dark blue" if k % 7 == 3 else "cream"
        b.rod(foot, (foot[0] * 0.25 + tip[0] * 0.75, 0, tip[2]), 0.0028, ink, sides=3)
    size = ((0.9, 0.5, 1.7), (0.7, 0.38, 1.3))[variant]
    return varied(b, rng, size, f"a {style} harp", style)
