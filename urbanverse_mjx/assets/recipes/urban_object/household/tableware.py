"""Tableware: bowls, plates, wine glasses, cutlery, blades, chopsticks. Tines, bowls and points to the front (+x)."""

import numpy as np

from ....meshes import shapes
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, shade
from ....meshes.recipe import recipe
from ...shared.forms import pillow, softened, vessel
from ...shared.sizes import varied_cm
from ..food.drinks import GLASS, filled

STEEL = "#bcc2c6"


@recipe("bowl", 3, name="tableware.bowl")
def bowl(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """White with a blue rim, wood, a steel mixing bowl."""
    b = MeshBuilder(roughness=0.4, metallic=0.6 if variant % 3 == 2 else 0.0)
    style = ("ceramic", "wooden", "steel")[variant % 3]
    color: Color = ("#f0ede6", "#a8703c", STEEL)[variant % 3]
    outside = (
        [(3.0, 0), (3.2, 0.5), (5.6, 2.0), (7.4, 4.6), (8.0, 7.4)]
        if style != "steel"
        else [(4.0, 0), (7.0, 1.8), (8.8, 5.0), (9.4, 8.2)]
    )
    b.lathe(vessel(outside, 0.45 if style != "wooden" else 0.8, 1.0), color=color, segments=30)
    if style == "ceramic":
        b.ring(7.8, 0.26, (0, 0, 7.4), "#2f5f9a", segments=30, sides=6)
        b.ring(6.55, 0.2, (0, 0, 3.3), "#2f5f9a", segments=30, sides=6)
    elif style == "wooden":
        for r, z in ((6.4, 3.0), (7.35, 4.3), (7.75, 6.0)):
            b.ring(r, 0.1, (0, 0, z), shade(color, 0.7), segments=30, sides=4)
    else:
        b.ring(9.35, 0.28, (0, 0, 8.2), STEEL, segments=30, sides=6)
    size = ((16, 16, 7.5), (26, 26, 9.5), (21, 21, 10.5))[variant % 3]
    return varied_cm(b, f"a {style} bowl", size, rng, {"style": style})


@recipe("plate", 3, name="tableware.plate")
def plate(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """White with a gold line, blue glazed, a patterned dessert plate."""
    b = MeshBuilder(roughness=0.35)
    color, line = (("#f3f1ec", "gold"), ("#3f6f8f", "#c9a36a"), ("#f0e8d8", "#b83a3a"))[variant % 3]
    b.lathe(
        [
            (0, 0.1),
            (6.6, 0.1),
            (6.8, 0),
            (7.2, 0.2),
            (8.2, 0.9),
            (12, 2.0),
            (12, 2.2),
            (8.0, 1.1),
            (7.2, 0.6),
            (0, 0.5),
        ],
        color=color,
        segments=36,
        crease_deg=30,
    )
    b.ring(11.75, 0.16, (0, 0, 2.12), line, segments=36, sides=6)
    b.ring(8.1, 0.12, (0, 0, 1.08), line, segments=36, sides=6)
    for k in range(12 if variant % 3 == 2 else 0):
        a = np.pi / 6 * k
        b.ball(
            (0.55, 0.85, 0.16),
            (9.9 * np.cos(a), 9.9 * np.sin(a), 1.68),
            ("#b83a3a", "#3f7a4a")[k % 2],
            turn_deg=(0, -16, 30 * k),
            segments=7,
            rings=4,
        )
    size = ((24, 24, 2.2), (28, 28, 2.7), (18, 18, 1.9))[variant % 3]
    return varied_cm(b, "a plate", size, rng, {"color": str(color)})


@recipe("wine glass", 3, name="tableware.wine_glass")
def wine_glass(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Empty tulip, red wine in a balloon, a champagne flute."""
    b = MeshBuilder(roughness=0.15)
    style = ("tulip", "balloon with red wine", "flute with champagne")[variant % 3]
    stem = 8.5 if variant % 3 < 2 else 9.5
    b.lathe(
        [(0, 0), (3.4, 0), (3.4, 0.2), (0.6, 0.7), (0.36, 1.6), (0.34, stem - 0.8), (0.6, stem)],
        color=GLASS,
        segments=24,
    )
    if style == "tulip":
        cup = [(0.4, stem), (2.4, stem + 1.2), (3.7, stem + 4.0), (3.7, stem + 6.4), (2.9, stem + 11.5)]
        b.lathe(vessel(softened(cup, 10), 0.14, stem + 0.4), color=GLASS, segments=26, crease_deg=70)
    elif variant % 3 == 1:
        filled(
            b,
            softened([(0.4, stem), (3.0, stem + 1.0), (4.8, stem + 4.0), (4.7, stem + 7.0), (3.4, stem + 11.0)], 10),
            "#6e1423",
            stem + 4.2,
        )
    else:
        filled(b, [(0.4, stem), (1.7, stem + 1.8), (2.5, stem + 6), (2.3, stem + 12.4)], "#e8cf7a", stem + 9.4)
    size = ((8.0, 8.0, 20.5), (10, 10, 21.5), (6.6, 6.6, 22.5))[variant % 3]
    return varied_cm(b, f"a {style} glass", size, rng, {"style": style})


def cutlery_handle(b: MeshBuilder, color: Color, wide: float = 1.9, wooden: bool = False) -> None:
    """A flat handle along -x from the neck at the origin, arched a little, wider at its end."""
    s = np.linspace(0, 1, 8)
    rows = []
    for t in s[::-1]:
        half = np.interp(t, [0, 0.15, 0.7, 0.95, 1], [0.28, 0.26, wide * 0.42, wide * 0.5, wide * 0.2])
        z = 0.75 + 0.5 * np.sin(np.pi * t) - 0.55 * t
        thick = 0.32 if wooden else 0.14
        rows.append(
            np.array(
                [(-11.5 * t, y, z + dz) for y, dz in ((-half, -thick), (half, -thick), (half, thick), (-half, thick))]
            )
        )
    b.loft(rows, color, crease_deg=50)


@recipe("fork", 3, name="tableware.fork")
def fork(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Four tines of steel, a three-tined one with a wooden handle, a short cake fork; tines to the front."""
    b = MeshBuilder(roughness=0.25, metallic=0.7)
    style = ("table", "wooden-handled", "cake")[variant % 3]
    cutlery_handle(b, STEEL if style != "wooden-handled" else "wood", wooden=style == "wooden-handled")
    tines = 4 if style == "table" else 3
    shoulder = [
        (-0.4, -0.28),
        (1.2, -0.6),
        (2.2, -1.2),
        (3.4, -1.28),
        (3.4, 1.28),
        (2.2, 1.2),
        (1.2, 0.6),
        (-0.4, 0.28),
    ]
    b.extrude(shoulder, 0.3, (0, 0, 0.62), STEEL, turn_deg=(0, 5, 0))
    for k in range(tines):
        y = -1.1 + 2.2 * k / (tines - 1)
        b.tube([(3.0, y, 0.5), (4.6, y, 0.38), (6.2, y, 0.7), (7.4, y, 1.25)], [0.22, 0.22, 0.18, 0.06], STEEL, sides=6)
    if style == "cake":  # its left tine is a blade
        b.extrude([(3.0, 0.8), (3.0, 1.7), (6.4, 1.7), (7.2, 1.0)], 0.25, (0, 0, 0.4), STEEL, turn_deg=(0, -4, 0))
    size = ((19.5, 2.6, 1.8), (21.5, 2.7, 2.0), (14.5, 2.6, 1.5))[variant % 3]
    return varied_cm(b, f"a {style} fork", size, rng, {"style": style})


@recipe("spoon", 3, name="tableware.spoon")
def spoon(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A table spoon, a wooden one, a ladle; bowl to the front."""
    b = MeshBuilder(roughness=0.3, metallic=0.0 if variant % 3 == 1 else 0.7)
    style = ("table", "wooden", "ladle")[variant % 3]
    color: Color = ("#bcc2c6", "light wood", "#bcc2c6")[variant % 3]
    if style == "ladle":
        b.lathe(vessel([(1.4, 0), (3.2, 1.0), (4.0, 3.2), (4.1, 4.0)], 0.25, 0.5), color=color, segments=24)
        b.tube(
            [(-3.8, 0, 3.6), (-6.5, 0, 5.2), (-16, 0, 5.4), (-22, 0, 4.8), (-24, 0, 3.6), (-23, 0, 2.8)],
            [0.6, 0.55, 0.5, 0.6, 0.45, 0.3],
            color,
            sides=8,
        )
    else:
        if style == "wooden":
            b.tube([(0.4, 0, 0.9), (-6, 0, 1.1), (-16, 0, 0.9)], [0.5, 0.55, 0.7], color, sides=8)
        else:
            cutlery_handle(b, color)
        grid = pillow((6.4, 4.0, 2.6), 1.0, 1.0, 24, 12)
        x, y, z = grid.vertices.T
        dished = np.minimum(z, 1.3) - np.where(z > 1.29, 0.85 * np.clip(1 - (x / 3.0) ** 2 - (y / 1.85) ** 2, 0, 1), 0)
        b.add(
            shapes.Shape(np.column_stack([x + 3.0, y * (1 - 0.05 * x), dished]), grid.faces),
            color,
            (0, 0, 0),
            crease_deg=60,
        )
    size = ((18.5, 4.0, 2.2), (29, 6.0, 2.6), (31, 7.8, 5.2))[variant % 3]
    return varied_cm(b, f"a {style} spoon", size, rng, {"style": style})


@recipe("knife or sword", 3, name="tableware.knife_or_sword")
def knife_or_sword(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A cleaver-broad carving knife, a straight sword with its guard, a curved sabre; lying, points to the front."""
    b = MeshBuilder(roughness=0.25, metallic=0.6)
    style = ("short sword", "kitchen knife", "sabre")[variant % 3]
    if style == "kitchen knife":
        b.extrude([(0, -1.6), (0, 1.4), (6, 1.3), (13, 0.4), (17.5, -1.2), (17.6, -1.6)], 0.22, (0, 0, 0.65), STEEL)
        b.extrude([(0, -1.55), (17, -1.55), (13, -0.6), (0, -0.9)], 0.24, (0, 0, 0.64), "#d8dde0")
        b.add(pillow((12, 2.4, 1.5), 0.5, 0.5, 16, 6), "#3a2a20", (-6, 0.1, 0))
        for x in (-9.5, -6, -2.5):
            b.cylinder(0.3, 1.54, (x, 0.1, -0.02), "brass", segments=8)
        return varied_cm(b, "a kitchen knife", (30, 3.2, 1.5), rng, {"style": style})
    bend = 0.0 if style == "short sword" else 1.0
    s = np.linspace(0, 1, 10)
    long = 46.0 if style == "short sword" else 76.0
    rows = []
    for t in s:
        x, y = long * t, 9.0 * bend * t**2 * (1 - 0.2 * t)
        half = np.interp(t, [0, 0.85, 1], [2.2, 1.9, 0.06]) * (1 if not bend else 0.9)
        rows.append(np.array([(x, y - half, 0), (x, y, 0.38), (x, y + half, 0), (x, y, -0.38)])[:, [0, 1, 2]])
    b.loft([r[::-1] for r in rows] if _inward(rows) else rows, "#c9cfd4", crease_deg=10)
    b.tube(
        [(-0.5, -5.0, 0), (0, 0, 0), (-0.5, 5.0, 0)] if not bend else [(-0.3, -4, 0), (0, 3.4, 0)],
        [0.8, 0.9, 0.8] if not bend else [0.8, 0.8],
        "gold",
        sides=7,
    )
    b.tube([(0, 0, 0), (-6, 0, 0), (-12, -1.0 * bend, 0)], [0.95, 1.1, 0.95], "#5a2f1c", sides=8)
    for k in range(6):
        b.ring(1.08, 0.16, (-1.6 - 1.8 * k, -0.06 * k * bend, 0), "brass", turn_deg=(0, 90, 0), segments=10, sides=4)
    b.ball(1.7 if not bend else 1.3, (-13, -1.0 * bend, 0), "gold", segments=12, rings=8)
    if bend:
        b.tube([(0, -4, 0), (-5, -5.4, 0), (-10, -4.6, 0), (-13, -1.4, 0)], [0.6, 0.45, 0.45, 0.5], "gold", sides=6)
    size = ((62, 10, 1.8), (0, 0, 0), (92, 18, 2.6))[variant % 3]
    return varied_cm(b, f"a {style}", size, rng, {"style": style})


def _inward(rows: list[np.ndarray]) -> bool:
    """Whether a loft along +x through these sections would show its inside: they must turn counter-clockwise."""
    y, z = rows[0][:, 1], rows[0][:, 2]
    return float(np.sum(y * np.roll(z, -1) - z * np.roll(y, -1))) < 0


@recipe("chopsticks", 2, name="tableware.chopsticks")
def chopsticks(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A pair, tapering to the front: lacquered red with gold rings on a rest, plain bamboo."""
    b = MeshBuilder(roughness=0.4)
    color, tip = (("#a8281e", "#1f1a18"), ("#d8b878", "#c9a560"))[variant % 2]
    for y, yaw in ((-0.8, 2.2), (0.8, -2.2)):
        with b.frame((0, y, 0.42), (0, 0, yaw)):
            b.tube([(-11.8, 0, 0), (3, 0, 0), (11.8, 0, 0)], [0.42, 0.34, 0.18], color, sides=10)
            b.tube([(-11.85, 0, 0), (-7, 0, 0)], [0.44, 0.41], tip, sides=10)
            for x in (-6.4, -5.8, -5.2):
                b.ring(
                    0.4,
                    0.06,
                    (x, 0, 0),
                    "gold" if variant % 2 == 0 else "#8a6a34",
                    turn_deg=(0, 90, 0),
                    segments=10,
                    sides=4,
                )
    size = ((23.5, 2.4, 0.85), (25, 2.8, 0.8))[variant % 2]
    return varied_cm(b, "a pair of chopsticks", size, rng, {"color": color})
