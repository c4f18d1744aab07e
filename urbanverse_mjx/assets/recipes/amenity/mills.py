"""Mills and fairgrounds: what turns beside a street. Sails and entrances at +x; Ferris wheels turn about y."""

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import recipe
from ..shared.facade_images import door, sign, wall, window
from ..shared.outlines import arc, pairs
from ..shared.sizes import made
from .leisure_places import SIDES, windowed

CARS: tuple[Color, ...] = ("signal red", "signal yellow", "signal blue", "green", "orange", "purple")


@recipe("windmill", 3, name="mills.windmill")
def windmill(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A brick tower mill with a gallery, a white one with a conical cap, a wooden post mill; four sails at +x."""
    b = MeshBuilder(roughness=0.85)
    if variant % 3 == 2:
        for k in range(4):
            with b.frame(turn_deg=(0, 0, 45 + 90 * k)):
                b.beam((3.0, 0, 0), (0.3, 0, 3.2), 0.4, 0.4, "dark wood")
        b.cylinder(0.5, 4.0, color="dark wood", segments=10)
        image = windowed("boards", "grey wood", (5, 6), 1, 2, "grid", rng, 96)
        b.box((5.0, 4.6, 6.0), (0, 0, 3.4), "grey wood", skins=dict.fromkeys(SIDES, image))
        b.convex(
            [(x, y, 9.4) for x in (-2.8, 2.8) for y in (-2.6, 2.6)] + [(x, 0, 11.6) for x in (-2.6, 2.6)], "dark grey"
        )
        b.beam((-2.4, 0, 3.6), (-6.0, 0, 0.6), 0.9, 0.2, "wood")
        hub, x, reach, size = 8.8, 2.9, 5.6, (10, 8.6, 14.4)
    else:
        color, cap = (("brick", "dark grey"), ("white", "dark wood"))[variant % 3]
        b.lathe(
            [(3.1, 0), (2.9, 1.0), (2.2, 8.4), (2.15, 8.6)],
            color="#8f4c38" if color == "brick" else color,
            segments=18 if color != "brick" else 8,
            crease_deg=30,
        )
        b.lathe([(2.45, 8.5), (2.4, 8.9), (1.9, 10.2), (0.9, 11.3), (0, 11.6)], color=cap, segments=16)
        if variant % 3 == 0:
            b.lathe([(3.6, 3.2), (3.6, 3.35)], color="wood", segments=16)
            for k in range(16):
                a = 2 * np.pi * k / 16
                b.rod(
                    (3.5 * np.cos(a), 3.5 * np.sin(a), 3.3),
                    (3.5 * np.cos(a), 3.5 * np.sin(a), 4.2),
                    0.05,
                    "white",
                    sides=4,
                )
                b.rod(
                    (3.4 * np.cos(a), 3.4 * np.sin(a), 3.2),
                    (2.7 * np.cos(a), 2.7 * np.sin(a), 2.0),
                    0.06,
                    "wood",
                    sides=4,
                )
            b.ring(3.5, 0.06, (0, 0, 4.2), "white", segments=16, sides=4)
        b.panel(door("dark green", "panel"), (3.1, 0, 1.05), 1.1, 2.1, tilt_deg=6.0)
        for z, r in ((4.9, 2.62), (7.0, 2.4)):
            b.panel(window("grid", "white", rng, (24, 30)), (r + 0.02, 0, z), 0.7, 0.9, tilt_deg=6.0)
        hub, x, reach, size = 9.4, 2.6, 5.8, ((11, 8.5, 15), (9.5, 8.2, 14))[variant % 3]
    b.cylinder(0.35, 1.6, (x - 0.9, 0, hub), "dark wood", turn_deg=(0, 84, 0), segments=12)
    turn = float(rng.uniform(40, 50))
    for k in range(4):
        with b.frame((x + 0.5, 0, hub), (turn + 90 * k, 0, 0)):
            b.beam((0, 0, 0), (0, 0, reach), 0.18, 0.18, "white" if variant % 3 else "dark wood")
            for j in range(9):
                z = 1.3 + (reach - 1.4) * j / 8
                b.beam((0, 0, z), (0.1, 1.25, z), 0.06, 0.06, "wood")
            for y in (0.65, 1.25):
                b.beam((0.05, y, 1.3), (0.05, y, reach), 0.06, 0.06, "wood")
            b.quad(
                [(0.04, 0.1, 1.4), (0.08, 1.2, 1.4), (0.08, 1.2, reach - 0.1), (0.04, 0.1, reach - 0.1)],
                "cream",
                both_sides=True,
            )
    return made(b, "a windmill", size, 0.5, style=("tower", "white tower", "post mill")[variant % 3])


@recipe("watermill", 3, name="mills.watermill")
def watermill(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A mill house with a paddle wheel at its gable over a strip of water; stone, half-timbered, boarded."""
    b = MeshBuilder(roughness=0.9)
    kind, color, roof, size = (
        ("ashlar", "#b0a58e", "terracotta", (7.2, 9.5, 8.0)),
        ("plaster", "cream", "dark red", (6.4, 9.0, 9.2)),
        ("boards", "#8b4a3a", "dark grey", (6.6, 10.5, 7.2)),
    )[variant % 3]
    d, w, h = 5.6, 5.8, 5.0
    image = windowed(kind, color, (w, h), 3, 2, "grid", rng, 144)
    b.box((d, w, h), (0, -1.4, 0), color, skins=dict.fromkeys(SIDES, image))
    b.box((d + 0.2, w + 0.2, 0.9), (0, -1.4, 0), "granite")
    b.box((0.1, 1.1, 2.1), (d / 2 + 0.06, -1.4, 0.2), "dark wood", skins={"+x": door("dark wood", "panel")})
    if variant % 3 == 1:
        for y in np.linspace(-4.25, 1.45, 5):
            b.box((0.12, 0.22, 4.1), (d / 2, float(y), 0.9), "dark wood")
        for z in (0.9, 2.7, 4.8):
            b.box((0.12, w, 0.22), (d / 2, -1.4, z), "dark wood")
    y0, y1 = -1.4 - w / 2, -1.4 + w / 2
    for s in (-1, 1):
        b.convex(
            [
                (s * x, y, z)
                for y in (y0 - 0.4, y1 + 0.4)
                for x, z in ((0, h + 2.9), (0, h + 2.7), (d / 2 + 0.5, h - 0.35), (d / 2 + 0.5, h - 0.15))
            ],
            roof,
        )
    for y in (y0 + 0.06, y1 - 0.06):
        b.convex(
            [(x, y + t, z) for t in (-0.05, 0.05) for x, z in ((-d / 2, h), (d / 2, h), (0, h + 2.6))],
            shade(color, 0.95),
        )
    b.box((0.7, 0.7, 2.2), (-1.2, -3.2, h + 1.2), "brick")
    y, r = y1 + 0.85, 2.3
    b.cylinder(0.16, 1.8, (0, y + 0.9, 2.2), "dark wood", turn_deg=(90, 0, 0), segments=10)
    for side in (-0.5, 0.5):
        b.ring(r, 0.09, (0, y + side, 2.2), "wood", (90, 0, 0), 24, 5)
        b.ring(r * 0.8, 0.06, (0, y + side, 2.2), "wood", (90, 0, 0), 24, 4)
        for k in range(4):
            a = np.pi * k / 4
            dx, dz = r * np.cos(a), r * np.sin(a)
            b.rod((-dx, y + side, 2.2 - dz), (dx, y + side, 2.2 + dz), 0.07, "dark wood", sides=5)
    for k in range(16):
        a = 2 * np.pi * k / 16
        b.box(
            (0.5, 1.05, 0.05),
            (r * 0.92 * np.cos(a), y, 2.2 + r * 0.92 * np.sin(a) - 0.02),
            "dark wood",
            (0, float(-np.degrees(a)), 0),
        )
    b.box((d + 1.2, 1.7, 0.12), (0, y, -0.2), "water")
    for side in (-1.0, 0.95):
        b.box((d + 1.2, 0.25, 0.5), (0, y + side, -0.2), "granite")
    b.beam((-3.2, y, 4.9), (-0.3, y, 4.55), 0.7, 0.2, "wood")
    b.box((0.2, 0.2, 4.6), (-3.0, y, 0.1), "wood")
    return made(b, f"a watermill with {kind} walls", size, 0.6, wall=kind)


def big_wheel(
    b: MeshBuilder, radius: float, cars: int, axle: float, color: Color, half: float, segments: int = 28
) -> None:
    """A wheel about an axle along y at height `axle`, with cars that hang level, on two A-frames `half` wide."""
    for side in (-half * 0.4, half * 0.4):
        b.ring(radius, radius * 0.012, (0, side, axle), color, (90, 0, 0), segments, 4)
        b.ring(radius * 0.86, radius * 0.008, (0, side, axle), color, (90, 0, 0), segments, 3)
        for k in range(cars):
            a = 2 * np.pi * k / cars
            b.rod(
                (0, side * 0.5, axle),
                (radius * np.cos(a), side, axle + radius * np.sin(a)),
                radius * 0.007,
                "light grey",
                sides=3,
            )
    b.cylinder(radius * 0.06, half * 2, (0, half, axle), "charcoal", turn_deg=(90, 0, 0), segments=12)
    for k in range(cars):
        a = 2 * np.pi * k / cars
        x, z = radius * np.cos(a), axle + radius * np.sin(a)
        s = radius * 0.14
        b.rod((x, -half * 0.42, z), (x, half * 0.42, z), radius * 0.012, "charcoal", sides=4)
        b.box((s, half * 0.55, s * 0.5), (x, 0, z - s * 1.1), CARS[k % 6])
        b.box((s * 1.1, half * 0.6, s * 0.12), (x, 0, z - s * 0.15), shade(CARS[k % 6], 0.8))
        for e in (-1, 1):
            b.box((s * 0.08, half * 0.5, s * 0.5), (x + e * s * 0.44, 0, z - s * 0.62), "glass")
    for side in (-1, 1):
        for e in (-1, 1):
            b.rod(
                (e * radius * 0.62, side * half * 1.1, 0),
                (0, side * half * 0.8, axle),
                radius * 0.022,
                "white",
                sides=6,
            )
        b.rod(
            (-radius * 0.33, side * half * 0.97, axle * 0.45),
            (radius * 0.33, side * half * 0.97, axle * 0.45),
            radius * 0.014,
            "white",
            sides=5,
        )


@recipe("ferris wheel", 3, name="mills.ferris_wheel")
def ferris_wheel(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Travelling wheels of 12 to 20 cars on their platform with a ticket booth."""
    b = MeshBuilder(roughness=0.5)
    radius, cars, color, size = (
        (15.5, 16, "white", (34, 11, 36)),
        (22.0, 20, "signal blue", (48, 15, 50)),
        (9.5, 12, "signal red", (21, 8, 22.5)),
    )[variant % 3]
    axle = radius * 1.16
    half = radius * 0.26
    big_wheel(b, radius, cars, axle, color, half)
    b.box((radius * 1.9, half * 2.6, radius * 0.05), color="dark grey", bevel=0.1)
    b.box((radius * 0.5, half * 0.6, radius * 0.03), (0, half * 0.4, radius * 0.05), "aluminium")
    with b.frame((radius * 0.7, -half * 0.6, radius * 0.05)):
        b.box((2.4, 2.0, 2.4), color="signal yellow", skins={"-y": sign("TICKETS", "signal red", "white", (64, 40))})
        b.convex([(sx * 1.5, sy * 1.3, 2.4) for sx in (-1, 1) for sy in (-1, 1)] + [(0, 0, 3.6)], "signal red")
    return made(b, f"a Ferris wheel of {cars} cars", size, 0.3, cars=cars)


def carousel(b: MeshBuilder, at: tuple[float, float], radius: float, color: Color) -> None:
    """A roundabout under a striped tent roof with horses on poles."""
    with b.frame((at[0], at[1], 0)):
        b.cylinder(radius, radius * 0.08, color="wood", segments=20)
        b.cylinder(radius * 0.3, radius * 0.7, color="cream", segments=12)
        for k in range(12):
            a0, a1 = 2 * np.pi * k / 12, 2 * np.pi * (k + 1) / 12
            rim = [(1.1 * radius * np.cos(a), 1.1 * radius * np.sin(a), radius * 0.72) for a in (a0, a1)]
            drop = [(x, y, radius * 0.6) for x, y, _ in rim]
            tone = color if k % 2 else "white"
            b.sheet(np.array([rim, [(0, 0, radius * 1.15)] * 2]), tone, both_sides=True)
            b.sheet(np.array([drop, rim]), "gold", both_sides=True)
        b.cone(radius * 0.07, radius * 0.25, (0, 0, radius * 1.12), "gold", segments=8)
        for k in range(6):
            a = 2 * np.pi * k / 6
            x, y = 0.75 * radius * np.cos(a), 0.75 * radius * np.sin(a)
            b.rod((x, y, 0), (x, y, radius * 0.7), radius * 0.012, "gold", sides=4)
            with b.frame((x, y, radius * (0.25 + 0.06 * (k % 2))), (0, 0, float(np.degrees(a)) + 90), radius * 0.1):
                b.box((1.6, 0.5, 0.7), color=("white", "brown", "charcoal")[k % 3])
                b.beam((0.7, 0, 0.5), (1.2, 0, 1.3), 0.35, 0.4, ("white", "brown", "charcoal")[k % 3])


def coaster(
    b: MeshBuilder, at: tuple[float, float], size: tuple[float, float], height: float, color: Color, loop: bool
) -> None:
    """A closed track of hills on supports, with a train of four cars; one hill may be a loop."""
    t = np.linspace(0, 2 * np.pi, 33)[:-1]
    x = at[0] + size[0] / 2 * np.cos(t)
    y = at[1] + size[1] / 2 * np.sin(t)
    z = height * (
        0.16 + 0.84 * np.clip(0.5 + 0.5 * np.sin(3 * t + 0.5), 0, 1) ** 1.4 * (0.55 + 0.45 * np.cos(t / 2) ** 2)
    )
    for side in (0.97, 1.03):
        path = np.column_stack([at[0] + (x - at[0]) * side, at[1] + (y - at[1]) * side, z])
        b.tube(path, height * 0.016, color, 3, closed=True)
    for k in range(0, 32, 3):
        b.rod((x[k], y[k], 0), (x[k], y[k], z[k]), height * 0.014, "white", sides=4)
    if loop:
        ring = [
            (
                at[0] + size[0] * 0.1 * np.sin(2 * a) * 0.4,
                at[1] - size[1] / 2 + height * 0.42 * np.sin(a),
                height * (0.5 - 0.42 * np.cos(a)),
            )
            for a in np.linspace(0, 2 * np.pi, 25)
        ]
        b.tube(ring, height * 0.022, color, 5)
    for k in range(4):
        i = 6 + k
        yaw = float(np.degrees(np.arctan2(y[i + 1] - y[i], x[i + 1] - x[i])))
        b.box(
            (height * 0.16, height * 0.11, height * 0.09),
            (x[i], y[i], z[i] + height * 0.02),
            CARS[k],
            (0, 0, yaw),
            bevel=height * 0.015,
        )


def gate(b: MeshBuilder, x: float, width: float, height: float, words: str, color: Color) -> None:
    """Two turrets with a lettered arch between them."""
    for s in (-1, 1):
        b.cylinder(height * 0.2, height * 0.75, (x, s * width / 2, 0), "cream", segments=10)
        b.cone(height * 0.27, height * 0.5, (x, s * width / 2, height * 0.75), color, segments=10)
    b.box(
        (height * 0.1, width, height * 0.28),
        (x, 0, height * 0.52),
        color,
        skins={"+x": sign(words, color, "white", (128, 20)), "-x": sign(words, color, "white", (128, 20))},
    )


@recipe("amusement park", 2, name="mills.amusement_park")
def amusement_park(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A wheel, a roller coaster, a carousel, a swing tower and stalls behind a gate on one ground."""
    b = MeshBuilder(roughness=0.7)
    flip = 1 if variant % 2 == 0 else -1
    b.box((65, 90, 0.3), color=("dark concrete", "sandstone")[variant % 2])
    with b.frame((-16, 26 * flip, 0.3), (0, 0, 70 * flip)):
        big_wheel(b, 7.6, 8, 8.6, ("white", "signal yellow")[variant % 2], 2.2, 14)
    coaster(b, (-8, -20 * flip), (42, 40), 15.0, ("signal red", "purple")[variant % 2], True)
    carousel(b, (16, 20 * flip), 6.0, ("signal red", "signal blue")[variant % 2])
    for k in range(3):
        with b.frame((24, (-26 + 9 * k) * flip, 0.3)):
            b.box(
                (3.5, 4, 2.6),
                color=CARS[k],
                skins={"+x": sign(("FOOD", "GAMES", "SWEETS")[k], "white", CARS[k], (48, 32))},
            )
            b.convex([(sx * 2.3, sy * 2.6, 2.6) for sx in (-1, 1) for sy in (-1, 1)] + [(0, 0, 4.6)], CARS[k + 2])
    gate(b, 29, 14, 6.5, "LUNA PARK" if flip > 0 else "FUN FAIR", "signal blue")
    return made(b, "an amusement park", ((65, 90, 18), (55, 78, 17))[variant % 2], 0.15, rides=4)


@recipe("theme park", 2, name="mills.theme_park")
def theme_park(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A fairy-tale castle above a lake with a coaster round a mountain, a pirate ship, a carousel and a gate."""
    b = MeshBuilder(roughness=0.7)
    flip = 1 if variant % 2 == 0 else -1
    roof = ("signal blue", "pink")[variant % 2]
    b.box((85, 110, 0.3), color="grass")
    b.box((50, 8, 0.1), (16, 0, 0.3), "beige")
    b.cylinder(13, 0.15, (-2, 24 * flip, 0.3), "water", segments=24)
    with b.frame((-22, 0, 0.3)):
        b.box((14, 18, 8), color="off white", skins={"+x": wall("ashlar", (18, 8), "off white", rng, 72)})
        arch = [(-2, 0), (2, 0), *pairs(arc(2, 0, 180, 9, (0, 4)))]
        b.extrude(arch, 0.3, (6.9, 0, 0), "dark wood", turn_deg=(90, 0, 90))
        for x, y, r, top in ((6, -9, 2, 11), (6, 9, 2, 11), (-4, -7, 1.7, 14), (-4, 7, 1.7, 14), (-2, 0, 2.6, 16)):
            b.cylinder(r, top, (x, y, 0), "off white", segments=10)
            b.cone(r * 1.35, r * 2.4, (x, y, top), roof, segments=10)
    with b.frame((-14, -34 * flip, 0.3)):
        b.lathe([(12, 0), (8.5, 5), (5.5, 8), (3, 13), (0, 15)], color="brick", segments=9, crease_deg=10)
        b.lathe([(2.6, 13), (0.9, 15.2), (0, 15.6)], color="orange", segments=9, crease_deg=10)
    coaster(b, (-14, -34 * flip), (34, 32), 12.0, "signal red", False)
    with b.frame((-2, 24 * flip, 0.3), (0, 0, 30 * flip)):
        hull = [
            np.array([(x, y * s, z) for y, z in ((-2, 0), (2, 0), (2.6, 2.4), (-2.6, 2.4))])
            for x, s in ((-7, 0.5), (-3, 1), (4, 1), (8, 0.12))
        ]
        b.loft(hull, "dark wood", crease_deg=20)
        for x in (-3, 2.5):
            b.rod((x, 0, 2), (x, 0, 12), 0.2, "wood", sides=5)
            b.sheet(
                np.array(
                    [[(x + 0.8 * np.sin(np.pi * s), y, 4 + 6.5 * s) for y in (-3, 3)] for s in np.linspace(0, 1, 5)]
                ),
                "white",
                both_sides=True,
            )
    carousel(b, (24, -18 * flip), 6.0, roof)
    gate(b, 40, 18, 8.0, "WONDERLAND" if flip > 0 else "DREAM WORLD", roof)
    for _ in range(10):
        x, y = (float(v) for v in rng.uniform((2, -50), (40, 50)))
        if abs(y) > 8:
            b.cylinder(0.3, 2.0, (x, y, 0.3), "bark", segments=5)
            b.ball((1.8, 1.8, 2.2), (x, y, 3.6), "leaf", segments=6, rings=4)
    return made(b, "a theme park", ((85, 110, 22), (72, 95, 21))[variant % 2], 0.15, rides=4)
