"""Barriers against wheels and pedestrians: cones, barricades, fences, rails, rocks; and manhole covers."""

import numpy as np
from PIL import Image

from ...meshes import paint, shapes
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import rgb, shade
from ...meshes.recipe import Physics, recipe

CONE = Physics(("rubber", "plastic"), 500.0, (1.0, 7.0), 0.7, True, "45-90 cm road cones weigh 1-6 kg")


@recipe("traffic cone", 4, CONE, hulls=2, name="barriers.traffic_cone")
def traffic_cone(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Square-based cones with one or two reflective bands, a tall channeliser, a small one."""
    b = MeshBuilder(roughness=0.6)
    style = ("one band", "two bands", "channeliser", "small")[variant % 4]
    h = {"one band": 0.7, "two bands": 0.9, "channeliser": 1.07, "small": 0.46}[style] * float(rng.uniform(0.95, 1.05))
    color = "safety orange" if variant % 4 != 3 else "signal red"
    low, top = (0.1, 0.05) if style == "channeliser" else (0.155 * h + 0.01, 0.025)
    base = 0.42 * h + 0.05 if style != "channeliser" else 0.4
    dark = "black" if style in ("two bands", "channeliser") else color
    b.box((base, base, 0.035), color=dark, bevel=0.015)

    def radius(z: float) -> float:
        return low + (top - low) * z / h

    b.lathe([(low, 0.03), (top, h), (top * 0.7, h)], color=color, segments=20)
    b.cylinder(top * 0.7, 0.002, (0, 0, h), "black", segments=12)
    bands = {"one band": [(0.5, 0.75)], "two bands": [(0.42, 0.58), (0.68, 0.84)], "small": [(0.5, 0.78)]}
    for a, c in bands.get(style, [(0.35, 0.48), (0.58, 0.71), (0.8, 0.9)]):
        b.cylinder(
            radius(a * h) + 0.003, (c - a) * h, (0, 0, a * h), "white", top_radius=radius(c * h) + 0.003, segments=20
        )
    return b.build(f"a {h * 100:.0f} cm traffic cone, {style}", {"style": style})


BARRICADE = Physics(
    ("plastic", "steel"),
    250.0,
    (10.0, 60.0),
    0.6,
    True,
    "folding barricades weigh 10-20 kg, crowd barriers 15-25 kg, board on feet 40 kg",
)


@recipe("traffic barricade", 4, BARRICADE, hulls=6, name="barriers.traffic_barricade")
def traffic_barricade(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A-frame with striped rails, crowd-control barrier, European board on rubber feet, plastic pedestrian barrier."""
    b = MeshBuilder(roughness=0.55)
    style = ("A-frame", "crowd control", "board", "plastic")[variant % 4]
    w = float(rng.uniform(1.3, 1.6)) if style != "crowd control" else float(rng.uniform(2.0, 2.3))
    striped = paint.stripes((128, 16), ("safety orange", "white"), 10, slant=1.0)
    if style == "A-frame":
        _a_frame(b, w, striped)
    elif style == "crowd control":
        _crowd_barrier(b, w)
    elif style == "board":
        _board_barrier(b, w)
    else:
        _plastic_barrier(b, w, rng)
    return b.build(f"a {style} barricade {w:.1f} m wide", {"style": style, "width": round(w, 3)})


def _a_frame(b: MeshBuilder, w: float, striped: Image.Image) -> None:
    """Two A-frames with striped rails and lamps, w m wide."""
    for y in (-w / 2 + 0.12, w / 2 - 0.12):
        for side in (-1, 1):
            b.beam((side * 0.3, y, 0), (side * 0.03, y, 1.02), 0.05, 0.04, "white")
    for side, z in ((1, 0.88), (1, 0.5), (-1, 0.88)):
        x = side * (0.03 + 0.27 * (1.02 - z) / 1.02 + 0.02)
        b.box(
            (0.025, w, 0.2),
            (x, 0, z),
            "white",
            centered=True,
            turn_deg=(0, -side * 14, 0),
            skins={"+x" if side > 0 else "-x": striped},
        )
    for y in (-w / 2 + 0.12, w / 2 - 0.12):
        b.cylinder(0.085, 0.05, (-0.025, y, 1.12), "amber", turn_deg=(0, 90, 0), segments=14)


def _crowd_barrier(b: MeshBuilder, w: float) -> None:
    """A tube frame with bars and a striped plate, w m wide."""
    frame = [
        (0, -w / 2, 0.15),
        (0, -w / 2, 1.0),
        (0, -w / 2 + 0.1, 1.08),
        (0, w / 2 - 0.1, 1.08),
        (0, w / 2, 1.0),
        (0, w / 2, 0.15),
    ]
    b.tube(frame, 0.02, "galvanised", sides=8)
    b.rod((0, -w / 2, 0.2), (0, w / 2, 0.2), 0.018, "galvanised", sides=6)
    for y in np.linspace(-w / 2 + 0.12, w / 2 - 0.12, 15):
        b.rod((0, y, 0.2), (0, y, 1.08), 0.008, "galvanised", sides=4)
    for y in (-w / 2 + 0.3, w / 2 - 0.3):
        b.tube([(-0.3, y, 0.015), (0, y, 0.1), (0.3, y, 0.015)], 0.02, "galvanised", sides=6)
        b.rod((0, y, 0.1), (0, y, 0.2), 0.02, "galvanised", sides=6)
    plate = paint.stripes((64, 24), ("signal red", "white"), 6, slant=0.8)
    b.box((0.012, 0.8, 0.3), (0.018, 0, 0.62), "white", skins={"+x": plate, "-x": plate})


def _board_barrier(b: MeshBuilder, w: float) -> None:
    """A striped board on posts in rubber feet, with lamps, w m wide."""
    striped = paint.stripes((128, 20), ("signal red", "white"), 8, slant=0.0)
    b.box((0.03, w, 0.25), (0, 0, 0.8), "white", skins={"+x": striped, "-x": striped})
    b.box((0.025, w, 0.12), (0, 0, 0.2), "white", skins={"+x": paint.stripes((128, 10), ("signal red", "white"), 8)})
    for y in (-w / 2 + 0.2, w / 2 - 0.2):
        b.box((0.05, 0.05, 1.1), (-0.04, y, 0.05), "signal red")
        b.box((0.75, 0.38, 0.11), (-0.03, y, 0), "rubber", bevel=0.03)
        b.cylinder(0.09, 0.07, (-0.075, y, 1.22), "amber", turn_deg=(0, 90, 0), segments=14)


def _plastic_barrier(b: MeshBuilder, w: float, rng: np.random.Generator) -> None:
    """A plastic barrier of two rails and slats, w m wide."""
    color = ("safety orange", "signal blue", "lime")[int(rng.integers(3))]
    for z, d in ((0.12, 0.16), (0.82, 0.12)):
        b.box((0.045, w, d), (0, 0, z), color, bevel=0.01)
    for y in np.linspace(-w / 2 + 0.05, w / 2 - 0.05, 7):
        b.box((0.035, 0.05, 0.75), (0, y, 0.15), color)
    board = paint.stripes((96, 12), ("signal red", "white"), 8, slant=0.8)
    b.box((0.02, w * 0.9, 0.14), (0.025, 0, 0.62), "white", skins={"+x": board})
    for y in (-w / 2 + 0.25, w / 2 - 0.25):
        b.box((0.5, 0.1, 0.06), (0, y, 0), "black", bevel=0.02)
        b.box((0.04, 0.08, 0.14), (0, y, 0.03), "black")


JERSEY = Physics(
    ("concrete", "plastic"),
    2350.0,
    (18.0, 2600.0),
    0.7,
    False,
    "concrete of 2,350 kg/m3; a 2 m concrete element weighs over a tonne",
)


@recipe("jersey barrier", 3, JERSEY, hulls=2, name="barriers.jersey_barrier")
def jersey_barrier(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Concrete element, striped concrete, red or white plastic water-filled one; long side along y."""
    b = MeshBuilder(roughness=0.9)
    style = ("concrete", "striped concrete", "water-filled plastic")[variant % 3]
    length = float(rng.uniform(1.9, 2.4))
    half = [(0.3, 0), (0.3, 0.08), (0.17, 0.33), (0.08, 0.81)]
    outline = half + [(-x, z) for x, z in reversed(half)]
    color = ("concrete", "dark concrete", "signal red")[variant % 3]
    if style != "water-filled plastic":
        b.profile(outline, length, color=color)
        for y in (-length / 2 + 0.35, length / 2 - 0.35):
            b.box((0.64, 0.3, 0.09), (0, y, 0), shade(color, 0.7))
        if style == "striped concrete":
            image = paint.stripes((128, 24), ("signal yellow", "black"), 12, slant=0.8)
            lean = float(np.degrees(np.arctan2(0.09, 0.48)))
            b.panel(image, (0.122 + 0.004, 0, 0.6), length * 0.98, 0.26, tilt_deg=lean)
            b.panel(image, (-0.122 - 0.004, 0, 0.6), length * 0.98, 0.26, facing="-x", tilt_deg=lean)
        return b.build(f"a {style} jersey barrier {length:.1f} m long", {"style": style})
    n = 4
    for k in range(n):
        piece = length / n
        y = -length / 2 + piece * (k + 0.5)
        b.profile([(x * (1.0 if k % 2 == 0 else 0.9), z) for x, z in outline], piece, (0, y, 0), color)
    b.box((0.1, length * 0.9, 0.06), (0, 0, 0.79), color, bevel=0.02)
    for y in (-length / 4, length / 4):
        b.cylinder(0.05, 0.03, (0, y, 0.84), "black", segments=12)
    return b.build(f"a {style} jersey barrier {length:.1f} m long", {"style": style}, mass=round(24.0 * length, 1))


FENCE = Physics(
    ("steel", "wood"), 900.0, (15.0, 220.0), 0.5, False, "fence panels weigh 10-40 kg a metre with their footed posts"
)


@recipe("fence", 4, FENCE, hulls=4, name="barriers.fence")
def fence(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Wrought-iron railing, wooden pickets, board fence, construction mesh panel; the panel runs along y."""
    b = MeshBuilder(roughness=0.7)
    style = ("wrought iron", "picket", "board", "mesh panel")[variant % 4]
    w = float(rng.uniform(2.2, 2.8))
    if style == "wrought iron":
        _iron_fence(b, w)
    elif style == "picket":
        _picket_fence(b, w)
    elif style == "board":
        _board_fence(b, w, rng)
    else:
        _mesh_fence(b, w)
    return b.build(f"a {style} fence panel {w:.1f} m long", {"style": style, "width": round(w, 3)})


def _iron_fence(b: MeshBuilder, w: float) -> None:
    """Wrought-iron bars with pointed tips between two posts, w m wide."""
    for y in (-w / 2, w / 2):
        b.box((0.06, 0.06, 1.15), (0, y, 0), "black")
        b.ball(0.045, (0, y, 1.18), "black", segments=8, rings=6)
    for z in (0.15, 0.95):
        b.box((0.03, w, 0.035), (0, 0, z), "black")
    for y in np.linspace(-w / 2 + 0.12, w / 2 - 0.12, round(w / 0.12)):
        b.box((0.016, 0.016, 0.95), (0, y, 0.1), "black")
        b.cone(0.018, 0.09, (0, y, 1.05), "black", segments=5)


def _picket_fence(b: MeshBuilder, w: float) -> None:
    """Pointed pickets on two rails, w m wide."""
    for z in (0.25, 0.75):
        b.box((0.04, w, 0.08), (-0.03, 0, z), "white")
    for y in (-w / 2 + 0.05, w / 2 - 0.05):
        b.box((0.09, 0.09, 1.05), (-0.05, y, 0), "white")
    for y in np.linspace(-w / 2 + 0.06, w / 2 - 0.06, round(w / 0.15)):
        picket = [(-0.04, 0.06), (0.04, 0.06), (0.04, 0.92), (0, 1.0), (-0.04, 0.92)]
        b.extrude(picket, 0.02, (-0.01, y, 0), "white", turn_deg=(90, 0, 90))


def _board_fence(b: MeshBuilder, w: float, rng: np.random.Generator) -> None:
    """Boards in turn before and behind the posts, w m wide."""
    for y in (-w / 2 + 0.05, w / 2 - 0.05):
        b.box((0.1, 0.1, 1.8), (-0.05, y, 0), "dark wood")
    n = round(w / 0.16)
    for k in range(n):
        y = -w / 2 + (k + 0.5) * w / n
        b.box(
            (0.022, w / n * 0.94, 1.7),
            (0.0 if k % 2 else 0.012, y, 0.05),
            shade("wood", float(rng.uniform(0.85, 1.1))),
        )
    b.box((0.06, w, 0.04), (0, 0, 1.74), "dark wood")


def _mesh_fence(b: MeshBuilder, w: float) -> None:
    """A wire mesh in a tube frame on concrete feet, w m wide."""
    frame = [(0, -w / 2, 0.1), (0, -w / 2, 1.95), (0, w / 2, 1.95), (0, w / 2, 0.1)]
    b.tube(frame, 0.02, "galvanised", sides=8, closed=True)
    for y in np.linspace(-w / 2 + 0.1, w / 2 - 0.1, round(w / 0.15)):
        b.rod((0, y, 0.1), (0, y, 1.95), 0.004, "light grey", sides=3)
    for z in np.linspace(0.3, 1.8, 7):
        b.rod((0, -w / 2, z), (0, w / 2, z), 0.004, "light grey", sides=3)
    for y in (-w / 2, w / 2):
        b.box((0.6, 0.22, 0.13), (0, y * 0.96, 0), "concrete", bevel=0.02)


RAIL = Physics(
    ("steel",),
    2600.0,
    (20.0, 260.0),
    0.5,
    False,
    "a W-beam weighs 12 kg/m, its driven posts 20 kg each; tubular rails 8-15 kg/m",
)


@recipe("guard rail", 3, RAIL, hulls=5, name="barriers.guard_rail")
def guard_rail(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """W-beam on posts, tubular pedestrian rail, timber rail; runs along y, its front (+x) faces the traffic."""
    b = MeshBuilder(roughness=0.4, metallic=0.2)
    style = ("W-beam", "tubular", "timber")[variant % 3]
    w = float(rng.uniform(2.6, 3.2)) if style != "tubular" else float(rng.uniform(1.9, 2.2))
    ends = (-w / 2 + 0.35, w / 2 - 0.35)
    if style == "W-beam":
        wave = [
            (0.0, 0.44),
            (0.02, 0.46),
            (0.085, 0.49),
            (0.085, 0.54),
            (0.02, 0.58),
            (0.02, 0.62),
            (0.085, 0.66),
            (0.085, 0.71),
            (0.02, 0.74),
            (0.0, 0.76),
        ]
        back = [(x - 0.012, z) for x, z in reversed(wave)]
        b.profile(wave + back, w, color="galvanised")
        for y in (*ends, 0.0):
            b.box((0.12, 0.06, 0.72), (-0.13, y, 0), "grey")
            b.box((0.08, 0.08, 0.3), (-0.05, y, 0.45), "grey")
            b.box((0.01, 0.05, 0.08), (0.03, y, 0.56), "signal yellow")
    elif style == "tubular":
        color = ("galvanised", "dark green", "signal red")[int(rng.integers(3))]
        hoop = [
            (0, -w / 2, 0),
            (0, -w / 2, 0.95),
            (0, -w / 2 + 0.08, 1.05),
            (0, w / 2 - 0.08, 1.05),
            (0, w / 2, 0.95),
            (0, w / 2, 0),
        ]
        b.tube(hoop, 0.028, color)
        for z in (0.2, 0.62):
            b.rod((0, -w / 2, z), (0, w / 2, z), 0.022, color)
        for y in (-w / 2, w / 2):
            b.cylinder(0.06, 0.012, (0, y, 0), color, segments=12)
    else:
        for z in (0.4, 0.66):
            b.cylinder(0.09, w, (0, -w / 2, z), "wood", turn_deg=(-90, 0, 0), segments=12)
        for y in (*ends, 0.0):
            b.cylinder(0.09, 0.85, (-0.16, y, 0), "dark wood", segments=12)
    return b.build(f"a {style} guard rail {w:.1f} m long", {"style": style, "width": round(w, 3)})


@recipe(
    "rock",
    4,
    Physics(("stone",), 2600.0, (40.0, 4000.0), 0.8, False, "granite of 2,600 kg/m3"),
    hulls=1,
    name="barriers.rock",
)
def rock(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Boulders of a split look: points on a lumpy ellipsoid, cut flat below."""
    b = MeshBuilder(roughness=1.0)
    scale = (0.35, 0.55, 0.8, 0.45)[variant % 4]
    color = ("granite", "sandstone", "dark concrete", "brown")[variant % 4]
    points = rng.normal(size=(44, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    points *= rng.uniform(0.86, 1.08, (44, 1)) * scale * np.array([1.0, float(rng.uniform(0.75, 1.25)), 0.75])
    points[:, 2] = np.maximum(points[:, 2], -0.28 * scale)
    shape = shapes.convex(points)
    b.add(shape, color, crease_deg=12.0)
    return b.build(f"a {color} boulder", {"size": scale})


@recipe(
    "manhole cover",
    3,
    Physics(("cast iron",), 5500.0, (40.0, 160.0), 0.6, False, "ductile iron covers weigh 40-120 kg with their frame"),
    hulls=1,
    name="barriers.manhole_cover",
)
def manhole_cover(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Flat iron lid, 12 mm proud: round with ribs, round with squares, square telecom cover."""
    b = MeshBuilder(roughness=0.6, metallic=0.4)
    style = ("ribbed round", "chequered round", "square")[variant % 3]
    n = 96
    image, draw = paint.canvas((n, n), "cast iron")
    light, dark = rgb(shade("cast iron", 1.7)), rgb(shade("cast iron", 0.55))
    if style == "ribbed round":
        for r in (44, 36, 28, 12):
            draw.ellipse((n / 2 - r, n / 2 - r, n / 2 + r, n / 2 + r), outline=light, width=3)
        for k in range(24):
            a = 2 * np.pi * k / 24
            draw.line(
                (n / 2 + 30 * np.cos(a), n / 2 + 30 * np.sin(a), n / 2 + 42 * np.cos(a), n / 2 + 42 * np.sin(a)),
                fill=dark,
                width=3,
            )
        paint.text(draw, "SEWER", (n / 2 - 20, n / 2 - 8, n / 2 + 20, n / 2 + 8), light, bold=0.03)
    else:
        for i in range(8):
            for k in range(8):
                x, y = 6 + 11 * i, 6 + 11 * k
                draw.rectangle((x, y, x + 7, y + 7), fill=light if (i + k) % 2 else dark)
        if style == "square":
            draw.rectangle((2, 2, n - 3, n - 3), outline=light, width=3)
    side = float(rng.uniform(0.6, 0.7))
    ring = [(side / 2 * np.cos(a), side / 2 * np.sin(a)) for a in np.linspace(0, 2 * np.pi, 32, endpoint=False)]
    outline = (
        ring
        if style != "square"
        else [(-side / 2, -side / 2), (side / 2, -side / 2), (side / 2, side / 2), (-side / 2, side / 2)]
    )
    b.extrude([(x * 1.1, y * 1.1) for x, y in outline], 0.008, color="dark grey")
    with b.frame((0, 0, 0.008), (0, -90, 0)):
        b.plate(outline, 0.004, (0.002, 0, 0), image, "cast iron")
    return b.build(f"a {style} manhole cover", {"style": style})
