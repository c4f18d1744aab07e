"""Small boats: motorboat, rowing boat, canoe, kayak, gondola, jet ski, raft."""

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import recipe
from ...meshes.shapes import Shape, sheet
from ..shared.sizes import fitted

Station = tuple[float, float, float, float, float]


def hull(
    b: MeshBuilder, stations: list[Station], color: Color, inside: Color | None, wall: float = 0.04, bottom: float = 0.5
) -> None:
    """A hull through stations (x, half width at the rail, half width at the chine, z of the keel, z of the rail).

    inside: colour of an open hull's inner skin, or None for a closed deck; bottom: share of the depth of its floor.
    """

    def section(row: Station, shrink: float, raise_keel: float) -> np.ndarray:
        x, rail, chine, keel, top = row
        low = keel + (top - keel) * raise_keel
        side = keel + (top - keel) * max(0.35, raise_keel + 0.02)
        rail, chine = max(rail - shrink, 0.005), max(chine - shrink, 0.004)
        half = [(chine * 0.4, low), (chine, side), (rail, top)]
        points = [(y, z) for y, z in half] + [(-y, z) for y, z in reversed(half)]
        return np.array([(x, y, z) for y, z in points])

    outer = [section(row, 0.0, 0.0) for row in stations]
    if inside is None:
        b.loft(outer, color, crease_deg=40)
        return
    inner = [section(row, wall, bottom) for row in stations]
    with b.solid():
        b.add(_open_skin(outer), color, crease_deg=40)
        b.add(_open_skin(inner).flipped(), inside, crease_deg=30)
        for side in (2, 3):  # the rail closes the gap between both skins
            rail = np.array([[inner[k][side], outer[k][side]] for k in range(len(stations))])
            b.sheet(rail if side == 2 else rail[:, ::-1], shade(color, 0.8))
        for k in (0, -1):
            cap = np.array([outer[k], inner[k]])
            b.sheet(cap if k == 0 else cap[::-1], shade(color, 0.9))


def _open_skin(sections: list[np.ndarray]) -> Shape:
    surface = sheet(np.stack(sections))
    return Shape(surface.vertices, surface.faces)


def paddle(
    b: MeshBuilder, start: tuple[float, float, float], end: tuple[float, float, float], color: Color, double: bool
) -> None:
    b.rod(start, end, 0.016, "light wood", sides=6)
    a, c = np.array(start), np.array(end)
    for p, q in ((c, a), (a, c))[: 2 if double else 1]:
        axis = (p - q) / np.linalg.norm(p - q)
        b.beam(tuple(p - axis * 0.02), tuple(p + axis * 0.40), 0.16, 0.02, color, bevel=0.008)


@recipe("canoe", 3, name="small_craft.canoe")
def canoe(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.5)
    color, inside = (("signal red", "#8a2020"), ("#9a6a3a", "light wood"), ("#2f6f44", "#254f36"))[variant]
    xs = np.linspace(-2.42, 2.42, 11)
    rows = []
    for x in xs:
        t = abs(x) / 2.42
        half = 0.45 * max(1 - t**2.4, 0.015)
        rows.append((float(x), half, half * 0.92, 0.02 + 0.06 * t**4, 0.33 + 0.11 * t**3))
    hull(b, rows, color, inside, 0.022, 0.12)
    for x, w in ((-1.35, 0.34), (1.15, 0.36)):
        b.box((0.24, 2 * w, 0.03), (x, 0, 0.27), "light wood")
    b.box((0.05, 0.86, 0.03), (0, 0, 0.31), "light wood")
    paddle(b, (-0.9, 0.12, 0.30), (0.6, 0.20, 0.33), "light wood" if variant != 1 else "signal red", False)
    names = ("A red canoe with a paddle", "A wooden canoe", "A green canoe")
    return fitted(
        b.build(names[variant], {"seats": 2}), ((4.85, 0.90, 0.43), (5.2, 0.92, 0.46), (4.3, 0.86, 0.40))[variant]
    )


def _kayak(b: MeshBuilder, variant: int, color: Color, deck: Color) -> None:
    """A kayak 3.5 m long with one or two cockpits and its paddle across the deck."""
    sections = []
    for x in np.linspace(-1.75, 1.75, 13):
        t = abs(x) / 1.75
        half, high = 0.35 * max(1 - t**2.2, 0.03), 0.155 * (1 - 0.35 * t**2)
        a = np.arange(10) * 2 * np.pi / 10
        z = 0.16 + 0.05 * t**3 + high * np.sin(a)
        sections.append(np.stack([np.full(10, x), half * np.cos(a), z], 1))
    b.loft(sections, color, crease_deg=60)
    for x in (-0.1,) if variant < 2 else (0.6, -0.7):
        k = 1.0 if variant < 2 else 0.8
        rim = [(x + 0.42 * k * np.cos(a), 0.23 * np.sin(a), 0.305) for a in np.arange(14) * 2 * np.pi / 14]
        b.extrude([(p[0], p[1]) for p in rim], 0.012, (0, 0, 0.297), "black")
        b.tube(rim, 0.022, shade(color, 0.6), sides=5, closed=True)
        b.box((0.05, 0.32, 0.09), (x - 0.34 * k, 0, 0.28), "black", (0, -12, 0), bevel=0.02)
    for x in (0.85, 1.0, -0.95, -1.1) if variant < 2 else (1.35, -1.35):
        w = 0.30 * (1 - (abs(x) / 1.75) ** 2.2)
        b.rod((x, -w, 0.27), (x, w, 0.27), 0.008, "black", sides=4)
    if variant == 2:
        b.box((2.6, 0.06, 0.01), (0, 0, 0.312), deck)
    paddle(b, (-0.75, 0.16, 0.335), (0.95, 0.02, 0.335), "black", True)


@recipe("kayak", 3, name="small_craft.kayak")
def kayak(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.4)
    color, deck = (("safety orange", "#f08a30"), ("signal yellow", "signal yellow"), ("signal blue", "white"))[variant]
    stretch = ((1.0, 1.0, 1.0), (1.4, 0.86, 1.0), (1.2, 1.17, 1.1))[variant]
    with b.frame(scale=stretch):
        _kayak(b, variant, color, deck)
    names = ("An orange kayak with its paddle", "A yellow sea kayak", "A blue two-seat kayak")
    return fitted(
        b.build(names[variant], {"seats": 1 + (variant == 2)}),
        ((3.5, 0.70, 0.355), (4.9, 0.60, 0.36), (4.2, 0.82, 0.40))[variant],
    )


@recipe("gondola", 2, name="small_craft.gondola")
def gondola(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.3)
    black: Color = ("#17171a", "#1c2238")[variant]
    rows = []
    for x in np.linspace(-5.2, 5.2, 15):
        t = abs(x) / 5.2
        half = 0.70 * max(1 - t**2.6, 0.03)
        lift = 0.75 * t**3.2
        rows.append((float(x), half, half * 0.75, 0.02 + lift * 0.85, 0.55 + lift * (1.0 if x > 0 else 1.1)))
    hull(b, rows, black, "#5a2a20", 0.05, 0.25)
    b.box((2.2, 0.5, 0.03), (3.4, 0, 0.68), black, (0, -6, 0))
    b.box((2.0, 0.5, 0.03), (-3.5, 0, 0.70), black, (0, 7, 0))
    # The ferro at the bow: an iron blade with six teeth; the rowlock and the oar astern.
    iron = [(5.0, 0.7), (5.35, 1.0), (5.45, 1.75), (5.30, 2.0), (5.05, 2.02), (5.22, 1.85), (5.22, 1.2), (4.95, 0.95)]
    b.profile(iron, 0.05, (0, 0, 0), "aluminium")
    for k in range(6):
        b.box((0.22, 0.04, 0.045), (5.48, 0, 1.1 + 0.09 * k), "aluminium")
    b.profile([(-5.1, 0.9), (-5.35, 1.6), (-5.25, 1.62), (-4.95, 1.0)], 0.05, (0, 0, 0), "aluminium")
    b.tube([(-2.6, -0.6, 0.65), (-2.6, -0.66, 0.95), (-2.5, -0.62, 1.1)], [0.05, 0.05, 0.03], "wood", sides=6)
    paddle(b, (-4.2, -0.30, 1.45), (0.9, -0.72, 0.45), "light wood", False)
    red = ("#a01f2a", "#c79a3a")[variant]
    b.box((0.7, 0.95, 0.25), (-0.2, 0, 0.28), red, bevel=0.08)
    b.box((0.18, 1.0, 0.65), (-0.62, 0, 0.35), red, (0, -12, 0), bevel=0.08)
    for side in (-1, 1):
        b.box((0.4, 0.35, 0.3), (1.0, side * 0.35, 0.25), black, bevel=0.05)
        b.ball((0.10, 0.05, 0.10), (0.3, side * 0.66, 0.68), "gold", segments=8, rings=6)
    names = ("A black Venetian gondola with red cushions", "A dark blue gondola with gold cushions")
    return fitted(b.build(names[variant], {"cushions": red}), ((10.85, 1.42, 1.55), (11.0, 1.46, 1.7))[variant])


@recipe("boat", 3, name="small_craft.boat")
def boat(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.4)
    color, inside = (("white", "#d9d4c4"), ("#3a6f8f", "light wood"), ("signal red", "light grey"))[variant]
    rows = []
    for x in np.linspace(-2.4, 2.4, 9):
        t = max((x + 0.4) / 2.8, 0.0)
        half = 0.90 * max(1 - t**2.3, 0.02)
        rows.append((float(x), half, half * 0.86, 0.02 + 0.35 * t**3, 0.75 + 0.22 * t**2))
    hull(b, rows, color, inside, 0.06, 0.35)
    if variant == 1:  # a rowing boat: thwarts and oars
        for x in (-1.5, -0.3, 0.9):
            b.box((0.28, 1.6 if x < 0.5 else 1.35, 0.04), (x, 0, 0.58), "wood")
        for side in (-1, 1):
            paddle(b, (-1.0, side * 0.25, 0.92), (0.5, side * 0.74, 0.90), "light wood", False)
            b.cylinder(0.03, 0.12, (-0.1, side * 0.84, 0.74), "brass", segments=7)
        for k in range(3):
            b.tube(
                [(x, y * 1.005, z - 0.12 - 0.13 * k) for x, y, _, _, z in rows[:-1]], 0.012, shade(color, 0.7), sides=4
            )
            b.tube(
                [(x, -y * 1.005, z - 0.12 - 0.13 * k) for x, y, _, _, z in rows[:-1]], 0.012, shade(color, 0.7), sides=4
            )
    else:  # a runabout: foredeck, windscreen, seats, outboard
        deck = [(x, y * 0.98, z + 0.01) for x, y, _, _, z in rows if x > 0.3]
        b.convex([*deck, *[(x, -y, z) for x, y, z in deck], (0.6, 0, 1.02)], color)
        screen = [(0.75, 0.7, 0.95), (0.75, -0.7, 0.95), (0.35, -0.66, 1.35), (0.35, 0.66, 1.35)]
        b.quad(screen[::-1], "glass", both_sides=True)
        b.tube([screen[0], screen[3], screen[2], screen[1]], 0.025, "aluminium", sides=5)
        for side in (-1, 1):
            b.box(
                (0.45, 0.45, 0.12),
                (-0.55, side * 0.38, 0.62),
                "signal blue" if variant == 0 else "charcoal",
                bevel=0.04,
            )
            b.box(
                (0.10, 0.45, 0.45),
                (-0.78, side * 0.38, 0.66),
                "signal blue" if variant == 0 else "charcoal",
                bevel=0.04,
            )
        b.box((0.5, 1.5, 0.35), (-1.7, 0, 0.35), inside, bevel=0.05)
        b.ring(0.16, 0.018, (0.25, 0.38, 0.98), "black", (0, 60, 0), 12, 5)
        b.tube(
            [(x, y * 1.005, z - 0.10) for x, y, _, _, z in rows], 0.035, ("signal blue", "white")[variant // 2], sides=5
        )
        b.tube(
            [(x, -y * 1.005, z - 0.10) for x, y, _, _, z in rows],
            0.035,
            ("signal blue", "white")[variant // 2],
            sides=5,
        )
        b.box((0.42, 0.34, 0.5), (-2.62, 0, 0.82), "charcoal", bevel=0.10)
        b.box((0.16, 0.14, 0.75), (-2.62, 0, 0.08), "black")
        b.ring(0.10, 0.03, (-2.72, 0, 0.15), "black", (0, 90, 0), 10, 5)
    names = ("A white motorboat with a blue band", "A blue rowing boat with oars", "A red motorboat")
    size = ((4.9, 1.85, 1.40), (4.4, 1.78, 0.96), (5.6, 2.1, 1.55))[variant]
    return fitted(b.build(names[variant], {"oars": variant == 1}), size)


@recipe("jet ski", 2, name="small_craft.jet_ski")
def jet_ski(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.35)
    color, accent = (("#2a8fc0", "white"), ("signal red", "black"))[variant]
    rows = []
    for x in np.linspace(-1.55, 1.55, 9):
        t = max((x + 0.2) / 1.75, 0.0)
        half = 0.55 * max(1 - t**2.2, 0.04)
        rows.append((float(x), half, half * 0.9, 0.02 + 0.22 * t**2.5, 0.45 + 0.10 * t))
    hull(b, rows, accent, None)
    body = [
        (1.45, 0.10, 0.40, 0.56),
        (1.0, 0.34, 0.38, 0.76),
        (0.5, 0.40, 0.38, 0.92),
        (0.15, 0.30, 0.38, 0.84),
        (-0.2, 0.22, 0.38, 0.62),
        (-1.4, 0.24, 0.38, 0.60),
    ]
    a = np.arange(10) * 2 * np.pi / 10
    sections = [
        np.stack([np.full(10, x), w * np.cos(a), (lo + hi) / 2 + (hi - lo) / 2 * np.sin(a)], 1)
        for x, w, lo, hi in reversed(body)
    ]
    b.loft(sections, color, crease_deg=60)
    b.profile(
        [(-1.35, 0.58), (0.05, 0.60), (0.0, 0.78), (-0.55, 0.80), (-0.65, 0.72), (-1.3, 0.78)],
        0.34,
        (0, 0, 0),
        "charcoal",
    )
    b.rod((0.42, 0, 0.85), (0.22, 0, 1.02), 0.05, "black", sides=6)
    b.tube(
        [(0.12, 0.36, 1.03), (0.22, 0.15, 1.05), (0.22, -0.15, 1.05), (0.12, -0.36, 1.03)],
        [0.024, 0.016, 0.016, 0.024],
        "black",
        sides=6,
    )
    for side in (-1, 1):
        b.box((1.2, 0.20, 0.03), (-0.7, side * 0.38, 0.46), "charcoal")
        b.box((0.10, 0.05, 0.08), (0.62, side * 0.42, 0.88), "black", bevel=0.02)
        b.box((1.1, 0.02, 0.08), (0.2, side * 0.56, 0.33), color)
    b.cylinder(0.10, 0.18, (-1.70, 0, 0.24), "black", (0, 90, 0), segments=10)
    names = ("A blue and white jet ski", "A red and black jet ski")
    return fitted(b.build(names[variant], {"color": color}), ((3.2, 1.15, 1.08), (3.3, 1.22, 1.12))[variant])


@recipe("raft", 3, name="small_craft.raft")
def raft(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.7)
    if variant == 1:  # logs under lashed poles
        for k in range(7):
            y = -0.84 + 0.28 * k
            b.cylinder(
                0.145,
                3.2 + 0.12 * (k % 3),
                (-1.6 - 0.06 * (k % 3), y, 0.145),
                ("wood", "bark", "brown")[k % 3],
                (0, 90, 0),
                segments=9,
            )
        for x in (-1.2, 0.0, 1.2):
            b.rod((x, -1.0, 0.32), (x, 1.0, 0.32), 0.05, "light wood", sides=6)
            for k in range(7):
                b.box((0.12, 0.05, 0.08), (x, -0.84 + 0.28 * k, 0.29), "beige")
        paddle(b, (-1.0, 0.2, 0.42), (0.9, 0.4, 0.42), "light wood", False)
        return fitted(b.build("A raft of lashed logs", {"kind": "logs"}), (3.3, 2.0, 0.46))
    color, accent = (("safety orange", "charcoal"), ("", ""), ("#3a6f8f", "light grey"))[variant]
    half, wide, r = 1.35, 0.72, 0.25
    loop = [
        (half, -wide + 0.25),
        (half + 0.25, -0.25),
        (half + 0.25, 0.25),
        (half, wide - 0.25),
        (half - 0.5, wide),
        (-half + 0.4, wide),
        (-half, wide - 0.25),
        (-half - 0.1, 0.2),
        (-half - 0.1, -0.2),
        (-half, -wide + 0.25),
        (-half + 0.4, -wide),
        (half - 0.5, -wide),
    ]
    path = [(x, y, r + 0.02 + (0.10 if x > half - 0.1 else 0.0)) for x, y in loop]
    b.tube(path, r, color, sides=10, closed=True)
    b.tube(
        [(x * 1.02, y * (1 + 0.36 / max(abs(y), 0.4) * 0.7), z) for x, y, z in path],
        0.018,
        "black",
        sides=4,
        closed=True,
    )
    b.extrude([(x, y) for x, y in loop], 0.05, (0, 0, 0.10), accent)
    for x in (-0.6, 0.45):
        b.cylinder(0.17, 1.2, (x, 0.6, 0.36), shade(color, 0.85), (90, 0, 0), segments=10)
    for side in (-1, 1):
        paddle(b, (-0.5, side * 0.55, 0.56), (0.7, side * 0.78, 0.58), "signal yellow", False)
    names = ("An orange inflatable raft with paddles", "", "A blue inflatable dinghy")
    return fitted(
        b.build(names[variant], {"kind": "inflatable"}), ((3.2, 1.95, 0.52), (0, 0, 0), (2.7, 1.7, 0.48))[variant]
    )
