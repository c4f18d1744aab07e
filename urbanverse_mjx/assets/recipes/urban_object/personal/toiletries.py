"""Personal care: shampoo, lotion, perfume, soap, lipstick, toothbrushes and paste, plasters, nappies. Labels at +x."""

import numpy as np

from ....meshes import shapes
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, mix, shade
from ....meshes.recipe import recipe
from ...shared.forms import painted, pillow, stadium
from ...shared.sizes import varied_cm
from ...shared.skins import label, patch
from ..food.bottles import tinted


def flat_bottle(b: MeshBuilder, wide: float, deep: float, tall: float, color: Color, words: str, ink: Color) -> None:
    """An oval bottle, its long side to the front, with its label."""
    b.add(pillow((deep, wide, tall), 0.75, 0.2, 24, 12), color)
    image = label(words, mix(color, "white", 0.75), ink, (48, 64), band=ink)
    b.panel(image, (deep / 2 + 0.06, 0, tall * 0.46), wide * 0.52, tall * 0.56)


def pump(b: MeshBuilder, z: float, color: Color) -> None:
    """A pump head on a collar, its nozzle to the front."""
    b.cylinder(1.5, 1.6, (0, 0, z), color, segments=18)
    b.cylinder(0.45, 2.2, (0, 0, z + 1.5), "white", segments=10)
    b.tube(
        [(-1.0, 0, z + 3.9), (1.2, 0, z + 4.1), (3.2, 0, z + 3.9), (3.9, 0, z + 3.2)],
        [0.75, 0.7, 0.5, 0.4],
        color,
        sides=8,
    )


def flip_cap(b: MeshBuilder, z: float, radius: float, height: float, color: Color) -> None:
    b.cylinder(radius, height, (0, 0, z), color, segments=20)
    b.cylinder(radius * 1.01, 0.12, (0, 0, z + height * 0.62), shade(color, 0.7), segments=20)


@recipe("shampoo", 3, name="toiletries.shampoo")
def shampoo(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """An oval bottle with its cap, one with a pump, one standing on its lid."""
    b = MeshBuilder(roughness=0.35)
    style = ("capped", "pump", "upside-down")[variant % 3]
    color: Color = ("#3f8fb8", "#e8e2d4", "#7a4a9a")[variant % 3]
    if style == "upside-down":
        b.add(pillow((4.2, 5.2, 2.6), 0.7, 0.2, 22, 6), "white")
        with b.frame((0, 0, 2.3)):
            flat_bottle(b, 7.2, 4.4, 17, color, "SHAMPOO", "#4a2a6a")
    else:
        flat_bottle(b, 7.4, 4.5, 16.4, color, "SHAMPOO", ("#1f4f7a", "#3f6a4a")[variant % 3])
        if style == "capped":
            flip_cap(b, 16.2, 2.0, 3.2, "white")
        else:
            pump(b, 16.3, "#3f6a4a")
    size = ((4.5, 7.4, 19.5), (5.6, 8.2, 22.5), (4.2, 6.8, 18.6))[variant % 3]
    return varied_cm(b, f"a {style} bottle of shampoo", size, rng, {"style": style})


@recipe("lotion", 3, name="toiletries.lotion")
def lotion(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A pump bottle, a jar of cream, a tube standing on its cap."""
    b = MeshBuilder(roughness=0.4)
    style = ("pump bottle", "jar", "tube")[variant % 3]
    if style == "pump bottle":
        b.extrude(stadium(4.8, 6.0, 1.6), 11, color="#f3ece2", crease_deg=50)
        b.panel(label("BODY\nLOTION", "#f3ece2", "#b0607a", (40, 56)), (2.46, 0, 5.4), 3.9, 7.6)
        pump(b, 10.8, "#d8a8b4")
    elif style == "jar":
        b.lathe([(0, 0), (4.0, 0), (4.3, 0.5), (4.3, 3.6), (3.9, 4.0), (0, 4.0)], color="#dfe8ee", segments=28)
        patch(b, label("CREAM", "#2f5f9a", "white", (64, 24)), 4.36, 0.9, 3.2, 130)
        b.lathe([(0, 3.9), (4.35, 3.9), (4.4, 5.4), (4.1, 5.8), (0, 5.8)], color="#2f5f9a", segments=28)
        for k in range(28):
            a = 2 * np.pi * k / 28
            b.box(
                (0.14, 0.3, 1.1),
                (4.38 * np.cos(a), 4.38 * np.sin(a), 4.2),
                "#244a7a",
                turn_deg=(0, 0, float(np.degrees(a))),
            )
    else:
        flip_cap(b, 0, 2.1, 2.6, "white")
        rows, ring = [], np.arange(20) * np.pi / 10
        for s in np.linspace(0, 1, 7):
            y, x = 2.4 + 0.9 * s, 2.2 * (1 - s) + 0.12
            rows.append(np.column_stack([x * np.cos(ring), y * np.sin(ring), np.full(20, 2.4 + 12.6 * s)]))
        b.loft(rows, "#e8a050", crease_deg=60)
        b.panel(label("SUN\n30", "#e8a050", "white", (40, 40), bold=0.05), (1.9, 0, 8), 3.2, 4.6, tilt_deg=9)
    size = ((5.0, 6.2, 15), (8.6, 8.8, 5.8), (4.4, 6.4, 15.6))[variant % 3]
    return varied_cm(b, f"lotion: a {style}", size, rng, {"style": style})


@recipe("perfume", 3, name="toiletries.perfume")
def perfume(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A square flacon with a gold cap, a round one with a faceted stopper, a tall slim spray."""
    b = MeshBuilder(roughness=0.15)
    style = ("square", "round", "slim")[variant % 3]
    juice: Color = ("#e8c07a", "#e8a8b8", "#8fb8c8")[variant % 3]
    if style == "round":
        flat = shapes.ellipsoid((1.8, 3.4, 3.4), 26, 14)
        b.add(painted(flat), image=tinted("#e6ecee", (juice, 5.0), 6.8), at=(0, 0, 3.4), crease_deg=80)
        b.cylinder(0.9, 0.9, (0, 0, 6.6), "gold", segments=16)
        b.lathe([(0.7, 7.4), (1.6, 8.4), (1.4, 9.6), (0.7, 10.2), (0, 10.2)], color="#dfeaf2", segments=8, crease_deg=5)
        b.cylinder(1.7, 0.1, (1.65, 0, 3.4), "gold", turn_deg=(0, 90, 0), segments=18)
    else:
        wide, tall = (5.6, 6.4) if style == "square" else (3.0, 10.5)
        deep = 3.4 if style == "square" else 2.6
        b.box((deep, wide, tall), color="#e2eaec", bevel=0.35)
        b.box((deep + 0.04, wide * 0.86, tall * 0.72), (0, 0, tall * 0.1), juice, bevel=0.1)
        b.box((deep * 0.8, wide + 0.04, tall * 0.72), (0, 0, tall * 0.1), juice, bevel=0.1)
        b.panel(
            label("No 7" if style == "square" else "EAU", "cream", "black", (32, 24)),
            (deep / 2 + 0.05, 0, tall * 0.45),
            wide * 0.55,
            tall * 0.3,
        )
        b.cylinder(0.75, 0.7, (0, 0, tall), "gold", segments=14)
        if style == "square":
            b.box((1.9, 2.3, 2.4), (0, 0, tall + 0.6), "gold", bevel=0.2)
        else:
            b.cylinder(1.1, 3.2, (0, 0, tall + 0.5), "black", segments=18)
    size = ((3.8, 5.5, 10), (4.2, 7.4, 11), (2.7, 3.3, 13.6))[variant % 3]
    return varied_cm(b, f"a {style} bottle of perfume", size, rng, {"style": style})


@recipe("soap", 3, name="toiletries.soap")
def soap(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A pressed bar, a bar with bubbles on its dish, a liquid dispenser."""
    b = MeshBuilder(roughness=0.4)
    style = ("bar", "bar on a dish", "dispenser")[variant % 3]
    if style == "dispenser":
        b.extrude(stadium(5.8, 6.6, 2.4, 6), 11.4, color="#a8d0c0", crease_deg=50)
        b.panel(label("HAND\nSOAP", "white", "#2f7a5f", (40, 48)), (2.96, 0, 5.6), 3.6, 6)
        pump(b, 11.2, "white")
    else:
        color: Color = ("#f0d8c4", "#8fc0a8")[variant % 3]
        lift = 0.0 if style == "bar" else 0.9
        b.add(pillow((8.3, 5.4, 3.0), 0.55, 0.5, 28, 12), color, (0, 0, lift))
        rim = [(3.1 * np.cos(t), 1.75 * np.sin(t), lift + 2.95) for t in np.linspace(0, 2 * np.pi, 25)[:-1]]
        b.tube(rim, 0.14, shade(color, 0.86), sides=5, closed=True)
        b.box((3.4, 0.3, 0.12), (0, 0.5, lift + 2.94), shade(color, 0.84))
        b.box((2.4, 0.3, 0.12), (0, -0.5, lift + 2.94), shade(color, 0.84))
        if style != "bar":
            b.lathe([(0, 0), (3.4, 0), (4.9, 1.4), (4.7, 1.5), (3.2, 0.8), (0, 0.8)], color="#e8e4da", segments=26)
            for k in range(16):
                a, r = 2.4 * k, float(rng.uniform(0.25, 0.6))
                b.ball(
                    r, (3.6 * np.cos(a), 2.5 * np.sin(a), 2.0 + 1.6 * ((k * 5) % 7) / 7), "#f4f8fa", segments=8, rings=5
                )
    size = ((8.3, 5.4, 3.0), (10.4, 7.2, 4.0), (6.2, 6.8, 16.4))[variant % 3]
    return varied_cm(b, f"soap: a {style}", size, rng, {"style": style})


@recipe("lipstick", 3, name="toiletries.lipstick")
def lipstick(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Turned out, without its cap: red in gold, pink in black, a dark square-shouldered one."""
    b = MeshBuilder(roughness=0.25)
    color, case, band = (
        ("#b8182c", "black", "gold"),
        ("#d8608a", "#e8e2d8", "#b8bcc0"),
        ("#6a1f2c", "#7a1f2a", "gold"),
    )[variant % 3]
    b.lathe([(0, 0), (0.95, 0), (0.98, 0.1), (0.98, 3.2), (0.9, 3.3), (0, 3.3)], color=case, segments=24)
    b.lathe([(0, 3.2), (0.82, 3.2), (0.82, 5.2), (0.72, 5.3), (0, 5.3)], color=band, segments=24)
    ring = np.arange(20) * np.pi / 10
    rows = [np.column_stack([0.62 * np.cos(ring), 0.62 * np.sin(ring), np.full(20, z)]) for z in (5.2, 6.1)]
    slant = 6.75 - 0.6 * np.cos(ring)
    rows += [
        np.column_stack([0.62 * np.cos(ring), 0.62 * np.sin(ring), slant]),
        np.column_stack([0.4 * np.cos(ring), 0.4 * np.sin(ring), 7.0 - 0.5 * np.cos(ring)]),
    ]
    b.loft(rows, color, crease_deg=50)
    b.ring(0.98, 0.06, (0, 0, 3.0), band, segments=24, sides=5)
    size = ((1.95, 1.95, 7.4), (1.8, 1.8, 6.8), (2.2, 2.2, 8.0))[variant % 3]
    return varied_cm(b, "a lipstick", size, rng, {"color": color})


@recipe("toothbrush", 3, name="toiletries.toothbrush")
def toothbrush(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Blue and white, bamboo, an electric one; lying, bristles up at the front."""
    b = MeshBuilder(roughness=0.4)
    style = ("manual", "bamboo", "electric")[variant % 3]
    color: Color = ("#2f7ab8", "light wood", "#e8eaec")[variant % 3]
    if style == "electric":
        b.tube(
            [(-12, 0, 1.5), (-11, 0, 1.5), (-4, 0, 1.5), (1.0, 0, 1.5), (2.2, 0, 1.5)],
            [1.1, 1.4, 1.5, 1.25, 0.7],
            color,
            sides=14,
        )
        b.tube([(2.0, 0, 1.5), (7, 0, 1.4), (10.2, 0, 1.4)], [0.6, 0.42, 0.4], "white", sides=10)
        b.add(pillow((2.4, 0.9, 0.3), 0.6, 0.8, 12, 4), "#2f7ab8", (-4.5, 0, 2.85))
        b.cylinder(0.75, 0.6, (10.6, 0, 1.5), "white", segments=16)
        for k in range(13):
            r, a = (0.0, 0.0) if k == 0 else ((0.3, k * np.pi / 2) if k < 5 else (0.58, k * np.pi / 4))
            b.cylinder(0.13, 0.9, (10.6 + r * np.cos(a), r * np.sin(a), 2.1), ("white", "#7ab0d8")[k % 2], segments=5)
    else:
        b.tube(
            [(-9.5, 0, 0.55), (-8.8, 0, 0.55), (-5, 0, 0.55), (-1, 0, 0.5), (3.4, 0, 0.55), (6.6, 0, 0.6)],
            [0.3, 0.52, 0.55, 0.42, 0.3, 0.34],
            color,
            sides=10,
        )
        b.add(pillow((3.2, 1.2, 0.6), 0.5, 0.6, 18, 6), color, (7.9, 0, 0.3))
        if style == "manual":
            for x in (-7, -6, -5, -4):
                b.box((0.5, 0.8, 0.2), (x, 0, 1.0), "white", bevel=0.05)
        for i in range(6):
            for j in range(3):
                tall = 1.0 + (0.18 if i in (0, 5) else 0.0)
                b.cylinder(
                    0.16,
                    tall,
                    (6.8 + 0.44 * i, -0.36 + 0.36 * j, 0.8),
                    ("white", "#4a9ad0")[j % 2] if style == "manual" else "#efe8d8",
                    segments=6,
                )
    size = ((19, 1.4, 1.7), (18, 1.5, 1.6), (23.5, 2.9, 3.1))[variant % 3]
    return varied_cm(b, f"a {style} toothbrush", size, rng, {"style": style})


@recipe("toothpaste", 3, name="toiletries.toothpaste")
def toothpaste(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A lying tube, round at its cap, flat at its crimp: blue on white, green, one rolled up and used."""
    b = MeshBuilder(roughness=0.35)
    style = ("full", "herbal", "rolled up")[variant % 3]
    color: Color = ("#f2f4f5", "#3f9a5f", "#f4e4e4")[variant % 3]
    ink: Color = ("#1f5fa8", "white", "#c8283a")[variant % 3]
    start = -12.0 if style != "rolled up" else -7.0
    ring = np.arange(20) * np.pi / 10
    rows = []
    for s in np.linspace(0, 1, 8):
        half_y, half_z = 2.5 - 0.7 * s, 0.1 + 1.75 * np.sin(np.pi / 2 * s)
        rows.append(
            np.column_stack(
                [
                    np.full(20, start + (3.0 - start) * s),
                    half_y * np.cos(ring),
                    1.85 + half_z * np.sin(ring) - 0.5 * (1 - s),
                ]
            )
        )
    b.loft([*rows, rows[-1] * [1, 0.5, 0.5] + [0.9, 0, 0.92]], color, crease_deg=50)
    b.cylinder(0.75, 0.8, (3.7, 0, 1.85), "white", turn_deg=(0, 90, 0), segments=14)
    b.cylinder(
        1.35,
        2.0,
        (4.3, 0, 1.85),
        ink if style != "herbal" else "white",
        turn_deg=(0, 90, 0),
        top_radius=1.1,
        segments=14,
    )
    top = np.array(
        [[(x, y, z + 0.04) for y in (1.4, -1.4)] for x, z in ((start + 2.0, 2.4), (start + 6.2, 3.2), (1.2, 3.66))]
    )
    image = np.rot90(np.asarray(label("MINT\nFRESH", ink, color, (72, 32), bold=0.04)), -1)
    b.sheet(np.swapaxes(top, 0, 1)[::-1], image=np.rot90(image, 1))
    if style == "rolled up":
        for k in range(2):
            b.cylinder(
                1.0 - 0.35 * k,
                5.02 + 0.1 * k,
                (start, 2.51 + 0.05 * k, 1.3),
                shade(color, 0.95 - 0.15 * k),
                turn_deg=(90, 0, 0),
                segments=16,
            )
        b.tube([(6.2, 0, 1.6), (7.2, 0.3, 0.7), (8.2, -0.4, 0.5)], [0.3, 0.5, 0.35], "#f6fafa", sides=7)
    else:
        b.box((0.9, 5.1, 0.35), (start - 0.2, 0, 1.18), shade(color, 0.9))
    size = ((17.2, 5.0, 3.7), (19, 5.5, 4.1), (14, 4.8, 3.4))[variant % 3]
    return varied_cm(b, f"a {style} tube of toothpaste", size, rng, {"style": style})


@recipe("band-aid", 2, name="toiletries.band_aid")
def band_aid(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A strip with its perforated pad, two strips crossed."""
    b = MeshBuilder(roughness=0.8)
    color: Color = ("#d9a878", "#e8b98c")[variant % 2]
    for k, yaw in enumerate((0,) if variant % 2 == 0 else (38, -38)):
        with b.frame((0, 0, 0.12 * k), (0, 0, yaw)):
            strip = stadium(7.2, 2.2, 1.05, 7)
            b.extrude(strip, 0.12, color=color)
            b.add(pillow((2.3, 2.0, 0.22), 0.3, 0.4, 16, 4), shade(color, 1.12), (0, 0, 0.08))
            for x in (*np.linspace(-3.0, -1.6, 4), *np.linspace(1.6, 3.0, 4)):
                for y in (-0.55, 0.0, 0.55):
                    b.cylinder(0.09, 0.02, (x, y, 0.12), shade(color, 0.6), segments=5)
            for x in (-0.6, 0.0, 0.6):
                for y in (-0.5, 0.0, 0.5):
                    b.cylinder(0.08, 0.02, (x, y, 0.29), shade(color, 0.7), segments=5)
    size = ((6.8, 2.2, 0.3), (7.0, 5.6, 0.42))[variant % 2]
    return varied_cm(b, "a plaster" if variant % 2 == 0 else "two plasters, crossed", size, rng, {"kind": variant % 2})


@recipe("diaper", 2, name="toiletries.diaper")
def diaper(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Laid out flat with wings and tapes, folded up as if worn."""
    b = MeshBuilder(roughness=0.9)
    if variant % 2 == 0:
        outline = [
            (-14, -9.5),
            (-9, -9.5),
            (-6, -6),
            (-2, -5),
            (4, -5),
            (8, -6.4),
            (10, -9.5),
            (14, -9.5),
            (14, 9.5),
            (10, 9.5),
            (8, 6.4),
            (4, 5),
            (-2, 5),
            (-6, 6),
            (-9, 9.5),
            (-14, 9.5),
        ]
        b.extrude(outline, 0.9, color="#f4f6f7")
        b.add(pillow((24, 7.6, 2.4), 0.4, 0.6, 24, 8), "#ffffff", (0, 0, 0.3))
        for side in (-1, 1):
            rim = [
                (x, side * y, 1.2 + 0.4 * np.cos(3 * x))
                for x, y in ((-8.6, 8.4), (-6, 5.8), (-2, 4.8), (2, 4.8), (6, 5.5), (9.4, 8.2))
            ]
            b.tube(rim, 0.65, "#d8ecf6", sides=7)
            b.box((2.6, 3.0, 0.4), (-11.4, side * 9.6, 0.6), "#7ab8dc", bevel=0.15)
        b.box((3.4, 13, 0.2), (11.6, 0, 0.85), "#bfe0f0")
        for k in range(4):
            b.ball((0.7, 0.7, 0.12), (11.6, -4.5 + 3 * k, 1.05), ("#f0a0b0", "#f0d060")[k % 2], segments=8, rings=4)
        return varied_cm(b, "a diaper laid out", (28, 19, 3.5), rng, {"style": "flat"})
    ring = np.arange(28) * 2 * np.pi / 28
    rows = []
    for z, x, y, dip in (
        (0, 3.0, 4.5, 0),
        (2.0, 6.5, 7.5, 0),
        (5.5, 8.2, 10.2, 2.4),
        (9.0, 8.0, 11.0, 1.2),
        (13, 7.6, 10.6, 0),
    ):
        legs = dip * np.abs(np.sin(ring)) ** 6
        rows.append(np.column_stack([x * np.cos(ring), y * np.sin(ring), z + legs]))
    inner = [np.column_stack([r[:, 0] * 0.9, r[:, 1] * 0.92, np.maximum(r[:, 2], 3.0)]) for r in rows[::-1][:3]]
    b.loft([*rows, *inner], "#f4f6f7", crease_deg=70)
    for side in (-1, 1):
        hole = [
            (4.4 * np.cos(t), side * (8.4 + 0.9 * np.sin(t)), 4.2 + 3.0 * np.sin(t))
            for t in np.linspace(0, 2 * np.pi, 17)[:-1]
        ]
        b.tube(hole, 0.6, "#d8ecf6", sides=6, closed=True)
        b.box((0.4, 3.4, 2.2), (7.55, side * 5.2, 9.6), "#7ab8dc", turn_deg=(0, 0, side * 32), bevel=0.15)
    b.panel(label("*", "#bfe0f0", "#f0a0b0", (32, 12)), (8.1, 0, 10.2), 6.4, 2.4)
    rim = np.column_stack([7.3 * np.cos(ring), 10.2 * np.sin(ring), np.full(28, 13.0)])
    b.tube(rim, 0.5, "#d8ecf6", sides=6, closed=True)
    return varied_cm(b, "a diaper folded as worn", (21, 26.5, 15), rng, {"style": "worn"})
