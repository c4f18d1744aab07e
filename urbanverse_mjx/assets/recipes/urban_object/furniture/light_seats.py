"""Framed seats and children's furniture: deck chairs, office chairs, rockers, hammocks, cots. The sitter looks along +x
(in a hammock, a cradle or a cot a person lies along y)."""

import numpy as np

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, shade
from ....meshes.recipe import recipe
from ...shared.forms import pouch, soft
from ...shared.outlines import arc, pairs
from ...shared.sizes import made


@recipe("beach chair", 3, name="light_seats.beach_chair")
def beach_chair(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A folding deck chair with striped cloth, a white plastic lounger, a low aluminium chair with webbing."""
    b = MeshBuilder(roughness=0.8)
    if variant % 3 == 1:
        for s in (-1, 1):
            b.beam((-0.35, s * 0.3, 0.32), (0.95, s * 0.3, 0.32), 0.04, 0.05, "white", bevel=0.008)
            for x in (-0.25, 0.8):
                b.beam((x, s * 0.3, 0.32), (x - 0.05, s * 0.3, 0), 0.04, 0.04, "white", bevel=0.008)
            b.beam((-0.35, s * 0.28, 0.34), (-0.9, s * 0.28, 0.8), 0.04, 0.04, "white", bevel=0.008)
            b.cylinder(0.07, 0.04, (-0.3, s * 0.34 + 0.02, 0.07), "light grey", turn_deg=(90, 0, 0))
        for k in range(11):
            b.box((0.09, 0.56, 0.02), (-0.28 + 0.12 * k, 0, 0.34), "white", bevel=0.006)
        for k in range(5):
            b.box((0.09, 0.52, 0.02), (-0.42 - 0.105 * k, 0, 0.41 + 0.088 * k), "white", (0, 40, 0), bevel=0.006)
        soft(b, (1.2, 0.52, 0.06), (0.3, 0, 0.36), "signal blue", plan=14)
        return made(b, "a sun lounger", (1.85, 0.68, 0.82), style="lounger")
    if variant % 3 == 0:
        for s in (-1, 1):
            b.beam((0.55, s * 0.27, 0), (-0.58, s * 0.27, 0.98), 0.03, 0.05, "light wood", bevel=0.005)
            b.beam((-0.5, s * 0.24, 0), (0.55, s * 0.24, 0.52), 0.03, 0.05, "light wood", bevel=0.005)
            b.beam((-0.55, s * 0.3, 0.04), (-0.2, s * 0.3, 0.64), 0.025, 0.04, "light wood", bevel=0.005)
        for x, z in ((-0.57, 0.97), (0.54, 0.51), (-0.48, 0.02), (0.5, 0.05)):
            b.rod((x, -0.3, z), (x, 0.3, z), 0.018, "light wood", sides=8)
        t = np.linspace(0, 1, 11)
        cloth = paint.stripes((64, 32), ("signal blue", "white", "signal yellow", "white"), 9)
        grid = [
            [(-0.56 + 1.1 * s, y, 0.97 - 0.46 * s - 0.62 * np.sin(np.pi * s**0.85) * 0.62) for s in t]
            for y in (-0.22, 0.22)
        ]
        b.sheet(np.swapaxes(np.array(grid), 0, 1)[::-1], image=cloth, both_sides=True)
        return made(b, "a deck chair", (1.25, 0.62, 0.86), 0.3, style="deck chair")
    for s in (-1, 1):
        b.tube(
            [(0.3, s * 0.27, 0), (0.26, s * 0.27, 0.22), (-0.26, s * 0.27, 0.18), (-0.5, s * 0.27, 0.72)],
            0.013,
            "aluminium",
        )
        b.tube(
            [(-0.32, s * 0.27, 0), (-0.1, s * 0.27, 0.42), (0.28, s * 0.27, 0.42), (0.3, s * 0.27, 0.22)],
            0.013,
            "aluminium",
        )
        b.box((0.4, 0.06, 0.02), (0.08, s * 0.27, 0.43), "wood", bevel=0.006)
    b.rod((-0.5, -0.27, 0.72), (-0.5, 0.27, 0.72), 0.013, "aluminium")
    for x in (0.3, -0.32):
        b.rod((x, -0.27, 0.01), (x, 0.27, 0.01), 0.012, "aluminium")
    for k in range(6):
        b.box((0.065, 0.54, 0.006), (-0.22 + 0.088 * k, 0, 0.19), ("teal", "white")[k % 2])
        b.box((0.006, 0.54, 0.075), (-0.29 - 0.038 * k, 0, 0.24 + 0.083 * k), ("teal", "white")[k % 2], (0, -24, 0))
    return made(b, "a low beach chair", (0.82, 0.6, 0.74), 0.3, style="low")


@recipe("swivel chair", 3, name="light_seats.swivel_chair")
def swivel_chair(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A task chair with a mesh back, a high leather chair, a bucket shell; on a five-star foot with castors."""
    b = MeshBuilder(roughness=0.6)
    metal, pad, high = (("charcoal", "dark blue", 1.05), ("aluminium", "black", 1.22), ("aluminium", "orange", 0.86))[
        variant % 3
    ]
    for k in range(5):
        a = np.radians(72 * k + 10)
        c, s = float(np.cos(a)), float(np.sin(a))
        b.beam((0, 0, 0.13), (0.3 * c, 0.3 * s, 0.085), 0.045, 0.035, metal, bevel=0.008)
        for e in (-0.014, 0.014):
            b.cylinder(
                0.03,
                0.018,
                (0.3 * c - s * e, 0.3 * s + c * e, 0.03),
                "black",
                turn_deg=(90, 0, float(np.degrees(a))),
                segments=12,
            )
    b.cylinder(0.035, 0.2, (0, 0, 0.1), "charcoal")
    b.cylinder(0.02, 0.16, (0, 0, 0.28), "aluminium", segments=12)
    b.box((0.24, 0.2, 0.05), (0, 0, 0.42), "charcoal", bevel=0.01)
    if variant % 3 == 2:
        t = np.radians(np.linspace(100, 260, 13))
        low = np.array([(0.22 * np.cos(a), 0.24 * np.sin(a), 0.47) for a in t])
        top = np.array(
            [(0.27 * np.cos(a) - 0.02, 0.27 * np.sin(a), 0.62 + 0.24 * max(0.0, -np.cos(a)) ** 0.8) for a in t]
        )
        b.sheet(np.stack([low, top]), pad, both_sides=True)
        b.tube(top, 0.012, shade(pad, 0.9))
        soft(b, (0.46, 0.48, 0.08), (0.01, 0, 0.45), pad, plan=3, side=3)
    else:
        soft(b, (0.48, 0.5, 0.1), (0.02, 0, 0.46), pad, plan=5, side=3)
        with b.frame((-0.23, 0, 0.6), (0, -8, 0)):
            soft(b, (0.07 if variant % 3 == 0 else 0.12, 0.46, high - 0.62), (0, 0, 0.02), pad, plan=8, side=4)
            if variant % 3 == 1:
                soft(b, (0.09, 0.34, 0.16), (0.05, 0, high - 0.8), shade(pad, 1.4), plan=5, side=3)
        b.tube([(-0.08, 0, 0.43), (-0.27, 0, 0.44), (-0.29, 0, 0.75)], 0.022, metal)
        for s in (-1, 1):
            b.tube([(0.0, s * 0.22, 0.44), (0.0, s * 0.3, 0.46), (0.0, s * 0.3, 0.66)], 0.017, metal)
            soft(b, (0.26, 0.07, 0.035), (0.01, s * 0.3, 0.66), "black", plan=4, segments=12, rings=6)
    b.rod((0.05, -0.1, 0.42), (0.08, -0.28, 0.41), 0.008, "black", sides=6)
    return made(b, "a swivel chair", ((0.66, 0.64, 1.05), (0.72, 0.7, 1.22), (0.62, 0.62, 0.86))[variant % 3])


@recipe("rocking chair", 2, name="light_seats.rocking_chair")
def rocking_chair(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Turned wood with a slatted back, painted with broad slats and a cushion; on two curved runners."""
    b = MeshBuilder(roughness=0.6)
    wood = ("dark wood", "white")[variant % 2]
    run = [(x, 0.02 + z) for x, z in [(0.5 * s, 0.13 * s * s) for s in np.linspace(-1, 0.9, 11)]]
    for s in (-1, 1):
        y = s * 0.25
        b.tube([(x, y, z) for x, z in run], 0.022, wood, sides=6)
        b.rod((0.2, y, 0.03), (0.2, y, 0.66), 0.019, wood)
        b.rod((-0.2, y, 0.03), (-0.24, y, 0.44), 0.019, wood)
        b.tube([(-0.24, y, 0.4), (-0.28, y, 0.7), (-0.38, y, 1.08)], 0.02, wood)
        b.box((0.52, 0.08, 0.025), (-0.03, s * 0.27, 0.65), wood, (0, -3, 0), bevel=0.008)
        b.ball(0.03, (-0.385, y, 1.1), wood, segments=8, rings=6)
    soft(b, (0.5, 0.52, 0.045), (0, 0, 0.4), wood, (0, -4, 0), plan=6, side=4)
    for x, z in ((0.2, 0.22), (-0.21, 0.22)):
        b.rod((x, -0.25, z), (x, 0.25, z), 0.012, wood, sides=6)
    for z, x, tall in ((1.0, -0.37, 0.14), (0.52, -0.26, 0.06)):
        b.box((0.025, 0.48, tall), (x, 0, z), wood, (0, -14, 0), bevel=0.008)
    for k in range(7 if variant % 2 == 0 else 4):
        y = np.linspace(-0.19, 0.19, 7 if variant % 2 == 0 else 4)[k]
        b.beam((-0.25, y, 0.55), (-0.37, y, 1.02), 0.025 if variant % 2 == 0 else 0.08, 0.014, wood, bevel=0.004)
    if variant % 2:
        pouch(b, (0.44, 0.46, 0.09), (0.02, 0, 0.43), "dark red")
    return made(b, "a rocking chair", ((0.92, 0.64, 1.06), (0.98, 0.68, 1.12))[variant % 2])


@recipe("high chair", 2, name="light_seats.high_chair")
def high_chair(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A child's chair with tray: splayed wooden legs with a footrest, a padded one on a steel frame."""
    b = MeshBuilder(roughness=0.55)
    wood, pad = (("light wood", "off white"), ("light grey", "green"))[variant % 2]
    for sx in (-1, 1):
        for sy in (-1, 1):
            b.tube([(sx * 0.26, sy * 0.25, 0), (sx * 0.13, sy * 0.15, 0.56)], [0.014, 0.02], wood)
    for z, e in ((0.2, 0.215), (0.34, 0.175)):
        for s in (-1, 1):
            b.rod((s * (e + 0.01), -e, z), (s * (e + 0.01), e, z), 0.01, wood, sides=6)
    b.box((0.14, 0.32, 0.02), (0.21, 0, 0.27), wood, bevel=0.006)
    soft(b, (0.34, 0.34, 0.06), (0, 0, 0.54), pad, plan=5)
    soft(b, (0.06, 0.34, 0.4), (-0.15, 0, 0.57), pad, (0, -8, 0), plan=6, side=4)
    for s in (-1, 1):
        b.tube([(-0.16, s * 0.18, 0.74), (0.12, s * 0.19, 0.74), (0.14, s * 0.18, 0.57)], 0.014, wood)
    soft(b, (0.3, 0.46, 0.035), (0.24, 0, 0.75), "white" if variant % 2 == 0 else "lime", plan=4, side=4)
    b.box((0.03, 0.035, 0.17), (0.1, 0, 0.58), "charcoal", bevel=0.008)
    for s in (-1, 1):
        b.beam((-0.11, s * 0.06, 0.9), (-0.02, s * 0.07, 0.6), 0.025, 0.004, "charcoal")
    b.lathe([(0.03, 0), (0.05, 0.03)], (0.24, 0.1, 0.785), "signal red", segments=14)
    return made(b, "a high chair", ((0.58, 0.54, 0.97), (0.66, 0.56, 1.02))[variant % 2])


@recipe("hammock", 3, name="light_seats.hammock")
def hammock(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Cloth hung in a steel stand, in an arched wooden stand, a net on a frame; along y."""
    b = MeshBuilder(roughness=0.85)
    cloth = (
        ("signal red", "signal yellow", "orange"),
        ("signal blue", "white", "teal"),
        ("off white", "beige", "cream"),
    )[variant % 3]
    frame = ("charcoal", "wood", "dark green")[variant % 3]
    for s in (-1, 1):
        if variant % 3 == 1:
            continue
        b.tube([(0, 0, 0.1), (0, s * 0.9, 0.1), (0, s * 1.5, 0.98)], 0.03, frame)
        b.rod((-0.5, s * 0.75, 0.03), (0.5, s * 0.75, 0.03), 0.028, frame)
        b.rod((0, s * 0.75, 0.03), (0, s * 0.75, 0.1), 0.028, frame)
    if variant % 3 == 1:
        b.tube([(0, y, z) for y, z in [(1.6 * t, 0.1 + 1.05 * t * t) for t in np.linspace(-1, 1, 17)]], 0.045, frame)
        for s in (-1, 1):
            b.box((1.05, 0.09, 0.07), (0, s * 0.6, 0.04), frame, bevel=0.01)
    v, u = np.linspace(-1, 1, 15), np.linspace(-1, 1, 9)
    rows = []
    for t in v:
        half = 0.5 * (1 - abs(t) ** 3 * 0.88) if variant % 3 != 1 else 0.46
        sag = 0.42 + 0.38 * t * t
        rows.append([(half * s, 1.1 * t, sag + 0.16 * (1 - abs(t)) * abs(s) ** 1.6) for s in u])
    b.sheet(np.array(rows), image=paint.stripes((64, 32), cloth, 12), both_sides=True)
    end = (0.0, 1.48, 0.96) if variant % 3 != 1 else (0.0, 1.58, 1.12)
    for s in (-1, 1):
        edge = rows[-1] if s > 0 else rows[0]
        if variant % 3 == 1:
            b.rod((-0.48, s * 1.1, 0.8), (0.48, s * 1.1, 0.8), 0.02, "light wood")
        for p in edge[::2]:
            b.rod(p, (0, s * end[1], end[2]), 0.006, "beige", sides=4)
    return made(b, "a hammock on its stand", ((1.15, 3.0, 0.95), (1.1, 3.3, 1.15), (1.0, 2.8, 0.9))[variant % 3], 0.25)


def _bars(
    b: MeshBuilder,
    start: tuple[float, float],
    end: tuple[float, float],
    low: float,
    high: float,
    count: int,
    color: Color,
) -> None:
    """A railing between two ground points: two rails and bars."""
    (x0, y0), (x1, y1) = start, end
    for z in (low, high):
        b.beam((x0, y0, z), (x1, y1, z), 0.03, 0.035, color, bevel=0.005)
    for k in range(count):
        s = (k + 1) / (count + 1)
        b.rod(
            (x0 + (x1 - x0) * s, y0 + (y1 - y0) * s, low),
            (x0 + (x1 - x0) * s, y0 + (y1 - y0) * s, high),
            0.009,
            color,
            sides=5,
        )


@recipe("infant bed", 2, name="light_seats.infant_bed")
def infant_bed(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A cot with barred sides, its mattress and a teddy; a white one with solid ends and a lower drawer."""
    b = MeshBuilder(roughness=0.6)
    wood = ("light wood", "white")[variant % 2]
    hx, hy, h = 0.33, 0.62, 0.9
    for sx in (-1, 1):
        for sy in (-1, 1):
            b.box((0.045, 0.045, h), (sx * hx, sy * hy, 0.0), wood, bevel=0.008)
            b.ball(0.028, (sx * hx, sy * hy, h + 0.005), wood, segments=10, rings=6)
        _bars(b, (sx * hx, -hy), (sx * hx, hy), 0.3, h - 0.04, 13, wood)
    for sy in (-1, 1):
        if variant % 2 == 0:
            _bars(b, (-hx, sy * hy), (hx, sy * hy), 0.3, h - 0.04, 6, wood)
        else:
            b.box((2 * hx, 0.025, h - 0.2), (0, sy * hy, 0.16), wood, bevel=0.008)
    soft(b, (0.6, 1.18, 0.12), (0, 0, 0.32), "off white", plan=12)
    soft(b, (0.61, 0.7, 0.1), (0, -0.2, 0.37), ("light blue", "pink")[variant % 2], plan=10)
    pouch(b, (0.3, 0.26, 0.08), (0, 0.42, 0.43), "white")
    for at, r in (
        ((0.12, 0.2, 0.5), 0.07),
        ((0.12, 0.2, 0.61), 0.055),
        ((0.12, 0.16, 0.66), 0.02),
        ((0.12, 0.24, 0.66), 0.02),
    ):
        b.ball(r, at, "brown", segments=10, rings=6)
    if variant % 2:
        b.box((0.6, 1.15, 0.16), (0.02, 0, 0.08), wood, bevel=0.01)
        for y in (-0.3, 0.3):
            b.ball(0.018, (0.325, y, 0.16), "aluminium", segments=8, rings=6)
    return made(b, "a cot", ((0.7, 1.28, 0.92), (0.74, 1.34, 1.0))[variant % 2])


@recipe("cradle", 2, name="light_seats.cradle")
def cradle(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A wooden cradle on rockers with a hood, a swinging barred one between two stands; along y."""
    b = MeshBuilder(roughness=0.7)
    wood = ("wood", "white")[variant % 2]
    low, z = (0.16, 0.14) if variant % 2 == 0 else (0.2, 0.32)
    tall = 0.3
    for s in (-1, 1):
        if variant % 2 == 0:
            b.convex(
                [
                    (s * x, y, zz)
                    for y in (-0.4, 0.4)
                    for x, zz in ((low, z), (low + 0.02, z), (low + 0.09, z + tall), (low + 0.07, z + tall))
                ],
                wood,
            )
            b.tube(
                [(x, s * 0.34, 0.02 + 0.3 * x * x) for x in np.linspace(-0.27, 0.27, 9)],
                0.028,
                shade(wood, 0.8),
                sides=6,
            )
            b.box((0.06, 0.05, 0.16), (0, s * 0.34, 0.02), wood)
            tops = [(-low - 0.09, 0), (low + 0.09, 0)]
        else:
            _bars(b, (s * 0.24, -0.4), (s * 0.24, 0.4), z, z + tall, 9, wood)
            b.box((0.5, 0.035, 0.035), (0, s * 0.45, 0), wood, bevel=0.008)
            b.beam((-0.18, s * 0.45, 0.02), (0, s * 0.45, 0.8), 0.035, 0.035, wood, bevel=0.006)
            b.beam((0.18, s * 0.45, 0.02), (0, s * 0.45, 0.8), 0.035, 0.035, wood, bevel=0.006)
            b.cylinder(0.025, 0.08, (0, s * 0.43 + 0.04, z + tall + 0.03), "brass", turn_deg=(90, 0, 0), segments=10)
            tops = [(-0.25, 0), (0.25, 0)]
        end = [
            (-low - (0.02 if variant % 2 == 0 else 0.04), 0),
            (low + (0.02 if variant % 2 == 0 else 0.04), 0),
            (tops[1][0], tall),
            *pairs(arc(tops[1][0], 0, 180, 9, (0, tall), 0.4))[1:-1],
            (tops[0][0], tall),
        ]
        b.extrude(end, 0.03, (0, s * 0.4 + 0.015, z), wood, turn_deg=(90, 0, 0))
    b.box((2 * low, 0.8, 0.02), (0, 0, z), wood)
    soft(b, (2 * low + 0.06, 0.76, 0.12), (0, 0, z + 0.02), "white", plan=10)
    soft(b, (2 * low + 0.09, 0.5, 0.12), (0, -0.12, z + 0.08), ("light blue", "pink")[variant % 2], plan=9)
    pouch(b, (0.26, 0.2, 0.08), (0, 0.27, z + 0.13), "off white")
    if variant % 2 == 0:
        hood = [[(x, y, z + tall + 0.02 + e) for x, e in arc(low + 0.1, 0, 180, 11, squash=0.95)] for y in (0.42, 0.12)]
        b.sheet(np.array(hood), "cream", both_sides=True)
        b.tube(hood[1], 0.012, "white", sides=6)
        return made(b, "a cradle on rockers", (0.54, 0.92, 0.82), 0.5, style="rockers")
    b.rod((0, 0.45, 0.8), (0, 0.45, 0.98), 0.012, wood)
    b.tube([(0, 0.45, 0.96), (0, 0.3, 1.04), (0, 0.1, 1.0)], 0.008, wood, sides=6)
    for k in range(3):
        b.ball(
            0.028,
            (0.06 * (k - 1), 0.1, 0.9 - 0.03 * (k % 2)),
            ("signal red", "signal yellow", "signal blue")[k],
            segments=8,
            rings=6,
        )
        b.rod((0.06 * (k - 1), 0.1, 0.9), (0, 0.1, 1.0), 0.002, "charcoal", sides=4)
    return made(b, "a swinging cradle", (0.56, 1.0, 1.05), 0.5, style="swinging")
