"""Benches, picnic tables and sunshades of pavements and parks."""

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color
from ...meshes.recipe import Physics, recipe

BENCH = Physics(
    ("wood", "cast iron"),
    800.0,
    (35.0, 420.0),
    0.6,
    False,
    "park benches weigh 40-90 kg, concrete ones 300-400 kg; bolted",
)


def slats(
    b: MeshBuilder,
    count: int,
    start: tuple[float, float],
    end: tuple[float, float],
    size: tuple[float, float],
    length: float,
    color: Color,
    tilt: float,
) -> None:
    """Boards along y from (x, z) start to end; size = (width, thickness), tilt about y in degrees."""
    for k in range(count):
        s = k / max(count - 1, 1)
        x, z = (a + (c - a) * s for a, c in zip(start, end, strict=True))
        b.box((size[0], length, size[1]), (x, 0, z), color, turn_deg=(0, tilt, 0), centered=True)


@recipe("bench", 4, BENCH, hulls=6, name="seating.bench")
def bench(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Slatted with iron arms, backless timber, bent steel bars, concrete with timber top. Sitters face +x."""
    b = MeshBuilder(roughness=0.7)
    style = ("slatted iron", "backless timber", "steel", "concrete and timber")[variant % 4]
    length = float(rng.uniform(1.5, 2.0))
    if style == "slatted iron":
        slats(b, 4, (-0.14, 0.435), (0.24, 0.445), (0.1, 0.035), length, "wood", 0)
        slats(b, 4, (-0.2, 0.54), (-0.3, 0.84), (0.035, 0.085), length, "wood", -15)
        for y in (-length / 2 + 0.15, length / 2 - 0.15):
            b.tube([(0.26, y, 0.0), (0.22, y, 0.2), (0.24, y, 0.42)], 0.025, "cast iron", sides=6)
            b.tube([(-0.32, y, 0.0), (-0.2, y, 0.22), (-0.18, y, 0.42), (-0.3, y, 0.88)], 0.025, "cast iron", sides=6)
            b.tube([(-0.18, y, 0.41), (0.24, y, 0.41)], 0.022, "cast iron", sides=6)
            b.tube([(-0.23, y, 0.64), (0.1, y, 0.66), (0.24, y, 0.6), (0.24, y, 0.42)], 0.022, "cast iron", sides=6)
    elif style == "backless timber":
        slats(b, 5, (-0.2, 0.43), (0.2, 0.43), (0.085, 0.045), length, "light wood", 0)
        for y in (-length / 2 + 0.25, length / 2 - 0.25):
            b.box((0.46, 0.06, 0.03), (0, y, 0.378), "charcoal")
            b.box((0.34, 0.08, 0.38), (0, y, 0.0), "charcoal", taper=(1.3, 1.0))
            b.box((0.44, 0.12, 0.02), (0, y, 0.0), "charcoal")
    elif style == "steel":
        curve = [(0.26, 0.42), (0.2, 0.45), (-0.12, 0.42), (-0.2, 0.47), (-0.3, 0.85), (-0.33, 0.86)]
        for k in range(12):
            y = -length / 2 + 0.06 + k * (length - 0.12) / 11
            b.tube([(x, y, z) for x, z in curve], 0.016, "dark green", sides=5)
        for x, z in (curve[1], curve[2], curve[4]):
            b.rod((x, -length / 2, z), (x, length / 2, z), 0.022, "dark green", sides=6)
        for y in (-length / 2 + 0.04, length / 2 - 0.04):
            b.tube([(0.28, y, 0), (0.22, y, 0.44), (0.15, y, 0.64), (-0.24, y, 0.64)], 0.024, "dark green", sides=6)
            b.tube([(-0.34, y, 0), (-0.13, y, 0.42)], 0.024, "dark green", sides=6)
    else:
        b.box((0.5, length, 0.4), color="concrete", bevel=0.025)
        slats(b, 4, (-0.17, 0.42), (0.17, 0.42), (0.1, 0.04), length * 0.94, "wood", 0)
    return b.build(f"a {style} bench {length:.1f} m long", {"style": style, "length": round(length, 3)})


PICNIC = Physics(
    ("wood",), 550.0, (55.0, 120.0), 0.6, False, "timber picnic tables weigh 60-110 kg; two people carry one"
)


@recipe("picnic table", 3, PICNIC, hulls=6, name="seating.picnic_table")
def picnic_table(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A-frame timber, round steel with four seats, recycled plastic; benches along y."""
    b = MeshBuilder(roughness=0.8)
    style = ("A-frame", "round", "plastic plank")[variant % 3]
    if style != "round":
        color, leg = (("wood", "dark wood"), ("brown", "charcoal"))[variant // 2 % 2]
        length = float(rng.uniform(1.6, 1.9))
        for k in range(5):
            b.box((0.14, length, 0.04), (-0.3 + 0.15 * k, 0, 0.71), color)
        for side in (-1, 1):
            for k in range(2):
                b.box((0.13, length, 0.04), (side * (0.62 + 0.14 * k), 0, 0.41), color)
        for y in (-length / 2 + 0.28, length / 2 - 0.28):
            for side in (-1, 1):
                b.beam((side * 0.6, y, 0), (side * 0.2, y, 0.72), 0.045, 0.1, leg)
            b.beam((-0.78, y + 0.05, 0.37), (0.78, y + 0.05, 0.37), 0.045, 0.1, leg)
            b.beam((-0.34, y + 0.05, 0.67), (0.34, y + 0.05, 0.67), 0.045, 0.08, leg)
    else:
        b.cylinder(0.5, 0.04, (0, 0, 0.71), "teal", segments=24)
        b.cylinder(0.06, 0.72, color="charcoal", segments=12)
        b.cylinder(0.3, 0.02, color="charcoal", segments=18)
        for k in range(4):
            with b.frame(turn_deg=(0, 0, 45 + 90 * k)):
                b.cylinder(0.18, 0.03, (0.85, 0, 0.43), "teal", segments=16)
                b.tube([(0.05, 0, 0.2), (0.75, 0, 0.2), (0.85, 0, 0.28), (0.85, 0, 0.44)], 0.028, "charcoal", sides=6)
    return b.build(f"a {style} picnic table", {"style": style})


SHADE = Physics(("fabric", "aluminium"), 300.0, (18.0, 90.0), 0.6, False, "frame 8-25 kg plus a 30-60 kg base")


@recipe("sunshade", 4, SHADE, hulls=4, name="seating.sunshade")
def sunshade(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Octagonal parasols in two liveries, a square market shade, a closed one."""
    b = MeshBuilder(roughness=0.9)
    style = ("octagonal", "square", "striped", "closed")[variant % 4]
    color = ("dark green", "beige", "red", "dark blue")[variant % 4]
    h = float(rng.uniform(2.35, 2.6))
    b.cylinder(0.024, h, color="light wood" if variant % 2 == 0 else "aluminium", segments=10)
    b.lathe([(0.3, 0), (0.3, 0.05), (0.08, 0.09), (0.035, 0.11), (0.035, 0.35)], color="dark concrete", segments=18)
    if style == "closed":
        folds = [(0.03, 1.05), (0.09, 1.0), (0.13, 1.35), (0.12, 1.9), (0.06, h - 0.1), (0.03, h)]
        b.lathe(folds, color=color, segments=8, crease_deg=20.0)
        b.ring(0.115, 0.012, (0, 0, 1.6), "cream", segments=12, sides=5)
    else:
        n, r = (4, 1.75) if style == "square" else (8, float(rng.uniform(1.3, 1.55)))
        for k in range(n):
            a, c = (2 * np.pi * (k + s) / n + np.pi / n for s in (0, 1))
            fabric = "cream" if style == "striped" and k % 2 else color
            p, q = ((r * np.cos(t), r * np.sin(t), h - 0.55) for t in (a, c))
            apex = (0.0, 0.0, h)
            # A thin shell with a hanging edge; both sides can be seen from a pavement.
            b.sheet(np.array([[p, q], [apex, apex]]), fabric, both_sides=True)
            drop = np.array([0, 0, -0.16])
            b.quad([p + drop, q + drop, q, p], fabric, both_sides=True)
            b.rod(
                (0.02 * np.cos(a), 0.02 * np.sin(a), h - 0.03),
                (p[0] * 0.98, p[1] * 0.98, p[2] - 0.01),
                0.008,
                "aluminium",
                sides=4,
            )
    b.ball(0.035, (0, 0, h + 0.02), "aluminium", segments=8, rings=5)
    return b.build(f"a {style} {color} sunshade", {"style": style, "color": color})
