"""Padded seats and beds: armchairs, sofas, loungers, cushions, mattresses. The sitter looks along +x."""

import numpy as np

from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, shade
from ....meshes.recipe import recipe
from ....meshes.shapes import Point3
from ...shared.forms import pouch, soft
from ...shared.sizes import made


def legs(b: MeshBuilder, half_x: float, half_y: float, height: float, color: Color, radius: float = 0.022) -> None:
    """Four tapered legs that splay a little."""
    for sx in (-1, 1):
        for sy in (-1, 1):
            foot = (sx * (half_x + 0.02), sy * (half_y + 0.02), 0.0)
            b.tube([foot, (sx * half_x, sy * half_y, height + 0.02)], [radius * 0.6, radius], color, sides=6)


def settee(
    b: MeshBuilder,
    depth: float,
    width: float,
    height: float,
    seats: int,
    color: Color,
    foot: Color,
    arm: float = 0.16,
    square: float = 6.0,
) -> None:
    """A seat with arms and a back: base, `seats` cushions, as many back cushions, arms, short legs."""
    legs(b, depth / 2 - 0.1, width / 2 - 0.1, 0.1, foot)
    seat, inner = height * 0.5, width - 2 * arm
    soft(b, (depth - 0.04, width - 0.06, seat - 0.2), (0, 0, 0.09), color, plan=12, side=8, segments=16, rings=6)
    soft(b, (0.24, width - 0.1, height - 0.12), (-depth / 2 + 0.14, 0, 0.1), color, (0, -4, 0), 10, 6, 16, 8)
    for side in (-1, 1):
        soft(
            b,
            (depth * 0.94, arm, height * 0.62),
            (0.01, side * (width - arm) / 2, 0.09),
            shade(color, 0.95),
            plan=square,
            side=5,
        )
    wide = inner / seats
    for k in range(seats):
        y = (k - (seats - 1) / 2) * wide
        soft(b, (depth - 0.26, wide - 0.01, 0.17), (0.1, y, seat - 0.14), shade(color, 1.08), plan=8, side=3)
        soft(
            b,
            (0.19, wide - 0.015, height - seat - 0.0),
            (-depth / 2 + 0.28, y, seat - 0.02),
            shade(color, 1.05),
            (0, -12, 0),
            6,
            3,
        )


@recipe("armchair", 3, name="upholstery.armchair")
def armchair(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A padded club chair, a wing chair with high sides, a wooden-armed lounge chair."""
    b = MeshBuilder(roughness=0.85)
    if variant % 3 == 0:
        settee(b, 0.82, 0.8, 0.88, 1, "teal", "dark wood", 0.17)
    elif variant % 3 == 1:
        settee(b, 0.78, 0.74, 0.8, 1, "dark red", "dark wood", 0.14)
        soft(b, (0.2, 0.66, 0.72), (-0.29, 0, 0.4), "dark red", (0, -6, 0), 7, 4)
        for side in (-1, 1):
            soft(
                b,
                (0.34, 0.09, 0.52),
                (-0.2, side * 0.32, 0.52),
                shade("dark red", 0.92),
                (side * -8, 0, side * -18),
                4,
                4,
            )
    else:
        for side in (-1, 1):
            b.tube(
                [(0.32, side * 0.33, 0), (0.28, side * 0.33, 0.56), (-0.3, side * 0.33, 0.5), (-0.4, side * 0.33, 0)],
                0.022,
                "light wood",
                sides=8,
            )
            b.box((0.62, 0.07, 0.03), (0.0, side * 0.33, 0.54), "light wood", turn_deg=(0, -5, 0), bevel=0.01)
        for x in (0.25, -0.25):
            b.rod((x, -0.33, 0.3), (x, 0.33, 0.3), 0.018, "light wood")
        soft(b, (0.62, 0.58, 0.16), (0.02, 0, 0.3), "#c9a13b", (0, -7, 0), 7)
        soft(b, (0.15, 0.58, 0.62), (-0.3, 0, 0.38), "#c9a13b", (0, -20, 0), 7)
    return made(b, "an armchair", ((0.82, 0.8, 0.88), (0.86, 0.78, 1.08), (0.84, 0.7, 0.92))[variant % 3])


@recipe("sofa", 3, name="upholstery.sofa")
def sofa(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """In grey or olive, brick or teal cloth, and in brown leather."""
    cloths = ("#6f7d8c", "#8a8f7a")[int(rng.integers(2))], ("#b5533c", "#35606b")[int(rng.integers(2))], "#5d3a26"
    return _settee_with_cushions(variant, cloths[variant % 3], ("amber", "cream", "beige")[variant % 3])


@recipe("couch", 3, name="upholstery.couch")
def couch(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """In navy, mustard or sage cloth, and in black leather."""
    cloths = "#2f4467", ("#c79a3b", "#7f9a7d")[int(rng.integers(2))], "#2b2a2a"
    return _settee_with_cushions(variant, cloths[variant % 3], ("cream", "teal", "#8f2f2a")[variant % 3])


def _settee_with_cushions(variant: int, cloth: Color, spot: Color) -> BuiltAsset:
    """Seats between arms with thrown cushions: three seats, a loveseat on tall legs, a wide leather one."""
    b = MeshBuilder(roughness=0.8)
    (d, w, h), seats = (((0.94, 2.04, 0.83), 3), ((0.88, 1.55, 0.8), 2), ((1.02, 2.35, 0.78), 3))[variant % 3]
    settee(b, d, w, h, seats, cloth, "charcoal" if variant % 3 == 2 else "wood", 0.2 if variant % 3 == 2 else 0.15)
    for side, tilt in ((-1, 24), (1, -16)):
        with b.frame((-0.02, side * (w / 2 - 0.36), h * 0.52), (0, 68, tilt)):
            pouch(b, (0.4, 0.4, 0.15), (-0.2, 0, 0), spot)
    return made(b, f"a {w:.1f} m sofa of {seats} seats", (d, w, h), seats=seats)


@recipe("lounge", 3, name="upholstery.lounge")
def lounge(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A corner suite, an outdoor set of rattan with pale cushions, a rounded modular one."""
    b = MeshBuilder(roughness=0.85)
    color, pad = (("#7a8288", "#878f95"), ("#4a3b30", "cream"), ("#a8795a", "#b88867"))[variant % 3]
    d, w, h, long = ((1.15, 2.0, 0.8, 1.1), (1.6, 2.4, 0.72, 1.5), (1.3, 2.9, 0.76, 1.2))[variant % 3]
    deep = 0.78
    back = -d / 2
    soft(b, (deep, w, 0.3), (back + deep / 2, 0, 0.06), color, plan=14, side=8)
    soft(b, (long, deep, 0.3), (back + long / 2, w / 2 - deep / 2, 0.06), color, plan=14, side=8)
    soft(b, (0.2, w, h - 0.06), (back + 0.1, 0, 0.06), color, plan=12, side=5)
    soft(b, (0.2 if variant % 3 else 0.7, 0.18, h * 0.75), (back + 0.35, -w / 2 + 0.09, 0.06), color, plan=6, side=5)
    if variant % 3:
        soft(b, (long * 0.96, 0.18, h - 0.06), (back + long / 2, w / 2 - 0.09, 0.06), color, plan=8, side=5)
    count = 2 if w < 2.3 else 3
    wide = (w - deep) / count
    for k in range(count):
        y = -w / 2 + wide * (k + 0.5) + (0.09 if k == 0 else 0.0)
        soft(b, (deep - 0.16, wide - 0.02, 0.15), (back + deep / 2 + 0.09, y, 0.33), pad, plan=8, side=3, segments=16)
        soft(b, (0.18, wide - 0.04, h - 0.4), (back + 0.26, y, 0.42), pad, (0, -12, 0), 6, 3, 16)
    soft(
        b, (long - 0.18, deep - 0.08, 0.15), (back + long / 2 + 0.1, w / 2 - deep / 2 - 0.02, 0.33), pad, plan=8, side=3
    )
    soft(b, (0.18, deep - 0.2, h - 0.4), (back + 0.26, w / 2 - deep / 2 - 0.03, 0.42), pad, (0, -12, 0), 6, 3, 16)
    return made(b, "a corner lounge suite", (d, w, h))


@recipe("chaise", 2, name="upholstery.chaise")
def chaise(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A long chair with a scrolled head and one arm, a low modern one with a raised back; the head at -x."""
    b = MeshBuilder(roughness=0.8)
    color = ("purple", "light grey")[variant % 2]
    legs(b, 0.7, 0.28, 0.2 if variant % 2 == 0 else 0.12, "dark wood" if variant % 2 == 0 else "charcoal", 0.03)
    soft(b, (1.62, 0.7, 0.2), (0, 0, 0.16), shade(color, 0.85), plan=10, side=5)
    soft(b, (1.45, 0.68, 0.16), (0.1, 0, 0.28), color, plan=8, side=3)
    if variant % 2 == 0:
        soft(b, (0.2, 0.7, 0.5), (-0.7, 0, 0.3), color, (0, -18, 0), 6, 4)
        b.cylinder(0.11, 0.72, (-0.84, 0.36, 0.74), shade(color, 1.1), turn_deg=(90, 0, 0), segments=20)
        soft(b, (0.85, 0.14, 0.34), (-0.32, 0.3, 0.34), shade(color, 0.92), (0, 8, 0), 5, 3)
        with b.frame((-0.45, -0.05, 0.42), (0, -18, 90)):
            b.capsule(0.09, 0.5, (-0.0, 0, 0.0), "gold", turn_deg=(90, 0, 0))
    else:
        soft(b, (0.18, 0.7, 0.62), (-0.58, 0, 0.34), color, (0, -38, 0), 8, 4)
        with b.frame((-0.72, 0, 0.62), (0, 52, 0)):
            pouch(b, (0.3, 0.6, 0.12), (0, 0, 0.05), "white")
    return made(b, "a chaise longue", ((1.66, 0.76, 0.83), (1.75, 0.72, 0.86))[variant % 2])


@recipe("ottoman", 3, name="upholstery.ottoman")
def ottoman(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A square tufted stool on legs, a round knitted pouffe, a long bench with a lid."""
    b = MeshBuilder(roughness=0.9)
    if variant % 3 == 1:
        soft(b, (0.5, 0.5, 0.38), (0, 0, 0), "#c46b4e", plan=2, side=2.8, segments=24, rings=10)
        for k in range(12):
            a = np.pi * 2 * k / 12
            b.tube(
                [
                    (0.25 * np.cos(a) * c, 0.25 * np.sin(a) * c, z)
                    for c, z in ((0.8, 0.02), (0.99, 0.12), (0.99, 0.26), (0.75, 0.36), (0.3, 0.385))
                ],
                0.012,
                "#a85a40",
                5,
            )
        return made(b, "a round pouffe", (0.52, 0.52, 0.38), style="pouffe")
    d, w, h, color = ((0.54, 0.6, 0.43, "dark green"), (0.48, 1.1, 0.46, "#7d6a58"))[variant // 2]
    legs(b, d / 2 - 0.07, w / 2 - 0.07, 0.12, "wood")
    soft(b, (d, w, 0.2), (0, 0, 0.1), shade(color, 0.85), plan=12, side=8)
    soft(b, (d, w, 0.17), (0, 0, 0.26), color, plan=8, side=3)
    for x in (-0.12, 0.12):
        for y in np.linspace(-w / 2 + 0.17, w / 2 - 0.17, 2 if w < 1 else 4):
            b.ball((0.016, 0.016, 0.008), (x, float(y), 0.428), shade(color, 0.6), segments=10, rings=5)
    return made(b, "an upholstered stool", (d, w, h), style="tufted")


@recipe("recliner", 2, name="upholstery.recliner")
def recliner(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A leather armchair with a lever; upright, and leaning back with its footrest out."""
    b = MeshBuilder(roughness=0.5)
    color = ("#6b3f28", "charcoal")[variant % 2]
    out = variant % 2 == 1
    soft(b, (0.8, 0.8, 0.3), (0, 0, 0.05), shade(color, 0.8), plan=12, side=8)
    soft(b, (0.62, 0.52, 0.18), (0.08, 0, 0.34), shade(color, 1.1), plan=7, side=3)
    for side in (-1, 1):
        soft(b, (0.82, 0.18, 0.5), (0, side * 0.34, 0.06), color, plan=6, side=4)
        soft(b, (0.7, 0.2, 0.14), (0.02, side * 0.34, 0.5), shade(color, 1.1), plan=5, side=2.5)
    with b.frame((-0.26, 0, 0.36), (0, -42 if out else -12, 0)):
        for k, tall in ((0, 0.26), (1, 0.24), (2, 0.24)):
            soft(b, (0.22, 0.56 - 0.03 * k, tall), (0, 0, 0.22 * k), shade(color, 1.08), plan=5, side=2.6)
    with b.frame((0.42, 0, 0.3), (0, -8 if out else 80, 0)):
        soft(b, (0.42, 0.52, 0.13), (0.2, 0, 0), shade(color, 1.1), plan=6, side=3)
        if out:
            b.beam((-0.15, 0, -0.05), (0.25, 0, 0.02), 0.3, 0.03, "dark grey")
    b.rod((0.2, -0.44, 0.3), (0.32, -0.46, 0.38), 0.014, "wood", sides=8)
    return made(
        b,
        "a recliner leaning back" if out else "a recliner",
        ((0.98, 0.86, 1.04), (1.6, 0.9, 0.93))[variant % 2],
        out=out,
    )


@recipe("cushion", 3, name="upholstery.cushion")
def cushion(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A square scatter cushion with a button, a round one, a striped oblong one."""
    b = MeshBuilder(roughness=0.95)
    color, size = (("amber", (0.44, 0.46, 0.14)), ("dark red", (0.42, 0.42, 0.12)), ("teal", (0.32, 0.56, 0.15)))[
        variant % 3
    ]
    pouch(b, size, (0, 0, 0), color, plan=(6, 2, 6)[variant % 3])
    x, y, h = size
    if variant % 3 < 2:
        b.ball((0.016, 0.016, 0.008), (0, 0, h), shade(color, 0.6), segments=12, rings=6)
        t = np.linspace(0, 2 * np.pi, 33)[:-1]
        p = 6.0 if variant % 3 == 0 else 2.0
        r = 1 / (np.abs(np.cos(t)) ** p + np.abs(np.sin(t)) ** p) ** (1 / p)
        b.tube(
            np.column_stack([x / 2 * r * np.cos(t), y / 2 * r * np.sin(t), np.full(32, h / 2)]),
            0.006,
            shade(color, 0.7),
            5,
            closed=True,
        )
    else:
        for k in (-2, -1, 0, 1, 2):
            v = k * 0.085
            top = h / 2 + h / 2 * (1 - abs(v / (y / 2)) ** 2) ** 0.6
            u = np.linspace(-0.92, 0.92, 13)
            b.tube(
                [(x / 2 * s, v, h / 2 + (top - h / 2) * (1 - abs(s) ** 2.4) ** 0.62 + 0.001) for s in u],
                0.009,
                "cream",
                6,
            )
    return made(b, f"a {color} cushion", (x, y, h)) if variant % 3 else made(b, f"a {color} cushion", (0.46, 0.44, h))


@recipe("pillow", 2, name="upholstery.pillow")
def pillow(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A white bed pillow, a square one in a coloured cover with a flap."""
    b = MeshBuilder(roughness=0.95)
    size = ((0.62, 0.44, 0.15), (0.74, 0.72, 0.2))[variant % 2]
    color = ("white", "light blue")[variant % 2]
    pouch(b, size, (0, 0, 0), color, plan=7)
    if variant % 2 == 0:
        pouch(b, (0.6, 0.42, 0.02), (0, 0, 0.065), "light grey", plan=7)
    else:
        pouch(b, (0.76, 0.74, 0.016), (0, 0, 0.092), "white", plan=9)
        for k in (-1, 0, 1):
            b.cylinder(0.012, 0.004, (0.2 * k, 0, 0.198 - 0.025 * abs(k)), "white", segments=12)
    return made(b, "a pillow", size)


def _pad(b: MeshBuilder, size: Point3, at: Point3, color: Color) -> None:
    """A mattress with piping round its two edges."""
    soft(b, size, at, color, plan=14, side=9, segments=24, rings=6)
    t = np.linspace(0, 2 * np.pi, 29)[:-1]
    r = 1 / (np.abs(np.cos(t)) ** 14 + np.abs(np.sin(t)) ** 14) ** (1 / 14)
    for share in (0.08, 0.92):
        ring = np.column_stack(
            [
                size[0] / 2 * 0.985 * r * np.cos(t),
                size[1] / 2 * 0.985 * r * np.sin(t),
                np.full(28, at[2] + size[2] * share),
            ]
        )
        b.tube(ring + np.array([at[0], at[1], 0.0]), 0.008, shade(color, 0.8), 5, closed=True)


@recipe("mattress", 3, name="upholstery.mattress")
def mattress(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A double with a quilted top, a thin striped single, a bare stained one; lying flat."""
    b = MeshBuilder(roughness=0.95)
    size, color = (((2.0, 1.3, 0.2), "white"), ((1.95, 0.85, 0.13), "light blue"), ((2.0, 1.45, 0.24), "beige"))[
        variant % 3
    ]
    _pad(b, size, (0, 0, 0), color)
    for x in np.linspace(-0.8, 0.8, 6):
        for y in np.linspace(-0.38, 0.38, 3):
            b.ball(
                (0.025, 0.025, 0.006), (float(x), float(y) * size[1], size[2]), shade(color, 0.75), segments=8, rings=4
            )
    if variant % 3 == 1:
        for y in np.linspace(-0.34, 0.34, 5):
            b.box((1.9, 0.035, 0.004), (0, float(y), size[2] - 0.002), "signal blue")
    for side in (-1, 1):
        for x in (-0.5, 0.5):
            b.box((0.18, 0.012, 0.03), (x, side * size[1] / 2, size[2] / 2), shade(color, 0.6), bevel=0.005)
    return made(b, "a mattress", size)


@recipe("bed", 3, name="upholstery.bed")
def bed(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A double with a wooden headboard, an iron single, an upholstered king-size; the head at -x."""
    b = MeshBuilder(roughness=0.85)
    width, length = ((1.5, 2.08), (0.95, 2.0), (1.9, 2.2))[variant % 3]
    frame, sheet, blanket = (
        ("wood", "white", "signal blue"),
        ("charcoal", "off white", "dark red"),
        ("#8c8378", "white", "#5a6b62"),
    )[variant % 3]
    back, h = -length / 2, (0.98, 1.05, 1.15)[variant % 3]
    if variant % 3 == 1:
        for x, top in ((back + 0.03, h), (length / 2 - 0.03, 0.75)):
            for s in (-1, 1):
                b.cylinder(0.022, top, (x, s * (width / 2 - 0.03), 0), frame, segments=10)
                b.ball(0.035, (x, s * (width / 2 - 0.03), top), "brass", segments=10)
            b.rod((x, -width / 2 + 0.03, top - 0.05), (x, width / 2 - 0.03, top - 0.05), 0.015, frame)
            b.rod((x, -width / 2 + 0.03, 0.35), (x, width / 2 - 0.03, 0.35), 0.015, frame)
            for y in np.linspace(-width / 2 + 0.15, width / 2 - 0.15, 6):
                b.rod((x, float(y), 0.35), (x, float(y), top - 0.05), 0.009, frame, sides=6)
    else:
        _boards(b, back, length, width, h, frame, variant % 3 == 2)
    for s in (-1, 1):
        b.box((length - 0.08, 0.035, 0.16), (0, s * (width / 2 - 0.02), 0.22), frame, bevel=0.008)
    soft(b, (length - 0.1, width - 0.06, 0.22), (0.02, 0, 0.3), sheet)
    soft(b, (length * 0.66, width + 0.02, 0.2), (length * 0.16, 0, 0.36), blanket, plan=16, side=6, segments=24)
    soft(b, (0.18, width + 0.03, 0.205), (-length * 0.14, 0, 0.36), sheet, plan=12, side=6)
    count = 1 if width < 1.2 else 2
    for k in range(count):
        with b.frame((back + 0.32, (k - (count - 1) / 2) * width * 0.46, 0.5), (0, -14, 0)):
            pouch(b, (0.42, min(width * 0.42, 0.66), 0.16), (0, 0, 0), "white", plan=6)
    return made(b, ("a double bed", "an iron bed", "an upholstered bed")[variant % 3], (length, width, h))


def _boards(b: MeshBuilder, back: float, length: float, width: float, h: float, frame: Color, padded: bool) -> None:
    """Head and foot of a bed."""
    if padded:
        for k in range(4):
            soft(
                b,
                (0.14, width / 4, h - 0.1),
                (back + 0.07, (k - 1.5) * width / 4, 0.1),
                frame,
                plan=6,
                side=6,
                segments=14,
                rings=6,
            )
        b.box((0.06, width, 0.32), (length / 2 - 0.03, 0, 0.08), frame, bevel=0.02)
    else:
        b.box((0.05, width - 0.1, h - 0.35), (back + 0.03, 0, 0.3), frame, bevel=0.015)
        b.box((0.08, width, 0.06), (back + 0.04, 0, h - 0.06), frame, bevel=0.015)
        b.box((0.04, width - 0.1, 0.25), (length / 2 - 0.03, 0, 0.22), frame, bevel=0.012)
    for x, top in ((back + 0.04, h - 0.05), (length / 2 - 0.03, 0.5 if not padded else 0.1)):
        for s in (-1, 1):
            b.box((0.07, 0.07, top), (x, s * (width / 2 - 0.035), 0), frame if not padded else "wood", bevel=0.012)
