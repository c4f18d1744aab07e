"""Ships: ferry, freighter and sailing ship, yachts."""

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color
from ...meshes.recipe import recipe
from ...meshes.shapes import Points3
from ..shared.sizes import fitted
from .coaches import panes
from .small_craft import hull


def ship_rows(
    length: float, beam: float, depth: float, bow: float, stern: float = 0.85
) -> list[tuple[float, float, float, float, float]]:
    """Stations of a ship's hull: full amidships, fine at the bow, `stern` = width of its transom."""
    rows = []
    for x in np.linspace(-0.5, 0.5, 11):
        t = max((x - 0.1) / 0.4, 0.0)
        s = max((-x - 0.25) / 0.25, 0.0)
        half = beam / 2 * max(1 - t**2.2, 0.015) * (1 - (1 - stern) * s**2)
        rows.append(
            (float(x * length), half, half * (0.9 - 0.5 * t), depth * (0.0 + 0.25 * t**4), depth * (1 + bow * t**2))
        )
    return rows


def decks(
    b: MeshBuilder,
    at: tuple[float, float, float],
    sizes: tuple[tuple[float, float, float], ...],
    color: Color,
    step: float = 0.0,
) -> float:
    """Deckhouses one on another, windows all round; returns the top's z."""
    x, y, z = at
    for k, (length, width, high) in enumerate(sizes):
        side, front = panes(color, max(round(length / 2.2), 2)), panes(color, max(round(width / 2.2), 2))
        b.box((length, width, high), (x + step * k, y, z), color)
        for face, facing in ((1, "+y"), (-1, "-y")):
            b.panel(
                side, (x + step * k, face * (width / 2 + 0.01), z + high * 0.58), length * 0.92, high * 0.42, facing
            )
        for face, facing in ((1, "+x"), (-1, "-x")):
            b.panel(
                front,
                (x + step * k + face * (length / 2 + 0.01), y, z + high * 0.58),
                width * 0.92,
                high * 0.45,
                facing,
            )
        z += high
    return z


@recipe("ferry", 2, name="large_ships.ferry")
def ferry(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.5)
    color, band = (("signal blue", "white"), ("#1f6a4a", "#f0ead8"))[variant]
    rows = []
    for x in np.linspace(-29, 29, 11):  # double-ended
        t = abs(x) / 29
        half = 6.6 * (1 - 0.55 * t**5)
        rows.append((float(x), half, half * 0.85, 0.3 + 1.2 * t**4, 4.2))
    hull(b, rows, color, None)
    b.box((52.0, 13.0, 0.25), (0, 0, 4.2), "dark grey")
    for side in (-1, 1):
        b.box((46.0, 0.6, 3.6), (0, side * 6.2, 4.3), band)
        for k in range(8):
            b.box((3.0, 0.62, 1.6), (-20 + 5.7 * k, side * 6.22, 5.6), "dark glass")
        b.panel(
            paint.lettering("ISLAND FERRIES", band, color, (128, 12)),
            (0, side * 6.53, 5.0),
            22.0,
            1.0,
            "+y" if side > 0 else "-y",
        )
    for k, shade_name in enumerate(("white", "signal red", "grey", "dark blue")):  # cars seen on the open deck
        for end in (-1, 1):
            b.box((4.2, 1.8, 1.4), (end * (24.5 - 0.2 * k), -4.2 + 2.8 * k, 4.45), shade_name, taper=(0.6, 0.85))
    top = decks(b, (0, 0, 7.9), ((42.0, 12.6, 2.6), (24.0, 10.0, 2.4)), band)
    b.box((8.0, 9.0, 0.3), (0, 0, top), color)
    decks(b, (0, 0, top + 0.2), ((5.5, 7.0, 2.3),), band)
    for end in (-1, 1):
        b.box((4.5, 9.0, 0.3), (end * 29.5, 0, 4.0), "galvanised", (0, end * 12, 0))
        b.box((3.0, 0.6, 1.2), (end * 8.0, 3.8, 12.9), "safety orange", bevel=0.25)
        b.box((3.0, 0.6, 1.2), (end * 8.0, -4.4, 12.9), "safety orange", bevel=0.25)
    b.cylinder(1.1, 3.0, (-6.0, 0, top), color, segments=12)
    b.cylinder(1.12, 0.7, (-6.0, 0, top + 1.6), band, segments=12)
    b.rod((2.0, 0, top + 2.4), (2.0, 0, top + 5.6), 0.12, "white", sides=6)
    names = ("A blue and white double-ended car ferry", "A green car ferry")
    return fitted(b.build(names[variant], {"ends": 2}), ((58.0, 13.6, 14.4), (48.0, 12.0, 14.0))[variant])


def sail(b: MeshBuilder, corners: Points3, belly: float, color: Color = "off white") -> None:
    """A sail between four corners (lower fore, lower aft, upper aft, upper fore), filled out by `belly` m."""
    c = np.asarray(corners, float)
    grid = np.array(
        [
            [(1 - v) * ((1 - u) * c[0] + u * c[1]) + v * ((1 - u) * c[3] + u * c[2]) for u in np.linspace(0, 1, 5)]
            for v in np.linspace(0, 1, 5)
        ]
    )
    across = np.cross(c[1] - c[0], c[3] - c[0])
    across /= np.linalg.norm(across)
    u, v = np.meshgrid(np.linspace(0, 1, 5), np.linspace(0, 1, 5))
    b.sheet(grid + across * (belly * 4 * u * (1 - u) * (1 - 0.5 * v))[..., None], color, both_sides=True)


@recipe("ship", 2, name="large_ships.ship")
def ship(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.6)
    if variant == 1:
        return fitted(_tall_ship(b), (62.0, 18.0, 40.0))
    hull(b, ship_rows(76.0, 13.0, 7.0, 0.35), "#a8322a", None)
    hull(
        b,
        [(x, y * 1.004, c * 1.004, k + 2.6, t + 0.05) for x, y, c, k, t in ship_rows(76.0, 13.0, 7.0, 0.35)],
        "#1f3a5c",
        None,
    )
    b.box((50.0, 11.6, 0.4), (4.0, 0, 7.0), "rust")
    colors = ("#a8442c", "#2f5d8f", "#3f7a4c", "#c9a23a", "light grey", "safety orange")
    for i in range(7):
        for j in range(4):
            for k in range(int(rng.integers(1, 4))):
                b.box((5.9, 2.4, 2.55), (-14.0 + 6.3 * i, -3.75 + 2.5 * j, 7.4 + 2.6 * k), colors[int(rng.integers(6))])
    top = decks(b, (-29.5, 0, 7.2), ((11.0, 12.0, 3.2), (9.5, 11.0, 3.0), (8.5, 10.5, 3.0), (7.0, 12.5, 2.8)), "white")
    b.cylinder(1.4, 4.0, (-33.5, 0, top - 2.0), "#1f3a5c", segments=12)
    b.cylinder(1.42, 1.0, (-33.5, 0, top + 0.6), "signal yellow", segments=12)
    b.rod((-29.0, 0, top), (-29.0, 0, top + 5.0), 0.2, "white", sides=6)
    b.rod((34.0, 0, 9.0), (34.0, 0, 16.0), 0.22, "white", sides=6)
    for side in (-1, 1):
        b.panel(
            paint.lettering("NORDHAV", "#1f3a5c", "white", (96, 16)),
            (22.0, side * 6.56, 5.6),
            10.0,
            1.5,
            "+y" if side > 0 else "-y",
        )
    return fitted(b.build("A container ship", {"kind": "freighter"}), (78.0, 15.0, 24.0))


def _tall_ship(b: MeshBuilder) -> BuiltAsset:
    rows = ship_rows(48.0, 10.0, 5.0, 0.45, 0.7)
    hull(b, rows, "#3a2a1e", None)
    for z in (3.2, 4.2):
        for side in (-1, 1):
            b.tube(
                [(x, side * y * 1.01, z + (t - 5.0)) for x, y, _, _, t in rows],
                0.16,
                "gold" if z > 4 else "off white",
                sides=5,
            )
    for k in range(9):
        for side in (-1, 1):
            b.box((0.8, 0.3, 0.7), (-16 + 3.6 * k, side * 4.95, 3.3), "black")
    b.box((10.0, 8.0, 2.4), (-18.5, 0, 5.0), "#4a3526", taper=(0.95, 0.95))
    b.box((0.3, 6.0, 1.2), (-23.9, 0, 5.6), "gold")
    b.rod((22.0, 0, 6.6), (34.0, 0, 10.5), 0.25, "wood", sides=6)
    for x, height in ((12.0, 32.0), (-1.0, 36.0), (-14.0, 28.0)):
        b.tube([(x, 0, 4.0), (x, 0, 4.0 + height)], [0.40, 0.14], "wood", sides=7)
        for k, (low, wide) in enumerate(((0.22, 8.5), (0.48, 7.2), (0.70, 5.6))):
            z0, z1 = 4.0 + height * low, 4.0 + height * (low + 0.22)
            b.rod((x + 0.4, -wide, z1), (x + 0.4, wide, z1), 0.14, "wood", sides=5)
            w0 = wide * 1.12
            sail(
                b,
                [(x + 0.5, -w0, z0), (x + 0.5, w0, z0), (x + 0.5, wide, z1), (x + 0.5, -wide, z1)],
                1.6 - 0.3 * k,
                "cream",
            )
        for side in (-1, 1):
            b.rod((x, 0, 4.0 + height * 0.72), (x - 2.0, side * 4.6, 5.0), 0.06, "black", sides=3)
    for k in range(2):
        jib = [(32.0 - 5 * k, 0, 10.2 - 1.2 * k), (15.0, 0, 10.0), (12.6, 0, 27.0), (12.8, 0, 27.2)]
        sail(b, jib, 0.8, "cream")
    b.box((3.0, 0.05, 1.8), (-25.5, 0, 11.0), "signal red")
    b.rod((-24.0, 0, 7.0), (-24.0, 0, 13.0), 0.08, "wood", sides=5)
    return b.build("An old sailing ship with three masts under sail", {"kind": "tall ship"})


@recipe("yacht", 2, name="large_ships.yacht")
def yacht(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.3)
    if variant == 0:
        hull(b, ship_rows(18.0, 4.6, 2.4, 0.30), "white", None)
        side = [(-5.5, 2.4), (3.6, 2.5), (1.2, 4.2), (-4.8, 4.3)]
        b.profile(side, 3.6, (0, 0, 0), "white")
        b.profile([(-4.9, 2.95), (2.7, 2.95), (1.35, 3.85), (-4.6, 3.85)], 3.66, (0, 0, 0), "dark glass")
        b.profile([(-3.9, 4.3), (0.2, 4.3), (-0.6, 5.3), (-3.6, 5.3)], 2.8, (0, 0, 0), "white")
        b.profile([(-3.6, 4.55), (-0.1, 4.55), (-0.6, 5.1), (-3.5, 5.1)], 2.86, (0, 0, 0), "dark glass")
        b.tube([(-2.6, 1.2, 5.3), (-2.4, 1.0, 6.2), (-2.4, -1.0, 6.2), (-2.6, -1.2, 5.3)], 0.1, "white", sides=6)
        b.ball((0.4, 0.4, 0.3), (-2.4, 0, 6.45), "white", segments=10, rings=6)
        b.rod((-2.6, 0, 6.5), (-2.9, 0, 8.4), 0.05, "white", sides=6)
        b.rod((-2.2, 0.5, 6.2), (-2.4, 0.5, 7.6), 0.03, "white", sides=5)
        b.box((2.0, 3.8, 0.12), (-8.0, 0, 2.3), "light wood")
        for s in (-1, 1):
            b.tube([(8.4, s * 0.3, 3.9), (4.0, s * 1.9, 3.3), (-5.0, s * 2.2, 3.1)], 0.035, "aluminium", sides=5)
            b.box((11.0, 0.03, 0.5), (-1.0, s * 2.295, 1.5), "dark glass")
        return fitted(b.build("A white motor yacht", {"kind": "motor"}), (15.8, 4.6, 9.0))
    hull(b, ship_rows(12.0, 3.9, 1.5, 0.25, 0.75), "white", None)
    b.profile([(-1.0, -1.4), (1.4, -1.4), (1.1, 0.2), (-0.8, 0.2)], 0.25, (0, 0, 0), "dark blue")
    b.profile([(-5.3, -0.9), (-4.8, -0.9), (-4.7, 0.4), (-5.2, 0.4)], 0.12, (0, 0, 0), "dark blue")
    for s in (-1, 1):
        b.tube(
            [(x, s * y * 1.01, t - 0.25) for x, y, _, _, t in ship_rows(12.0, 3.9, 1.5, 0.25, 0.75)],
            0.07,
            "signal blue",
            sides=5,
        )
        b.box((2.8, 0.04, 0.22), (0.2, s * 0.88, 1.72), "dark glass")
    b.box((4.2, 1.9, 0.5), (0.2, 0, 1.5), "white", taper=(0.85, 0.8), bevel=0.08)
    b.box((2.6, 1.8, 0.06), (-3.6, 0, 1.52), "light wood")
    b.ring(0.4, 0.03, (-4.4, 0, 2.0), "black", (0, 75, 0), 16, 5)
    b.tube([(0.9, 0, 1.4), (0.9, 0, 15.5)], [0.11, 0.06], "aluminium", sides=8)
    b.rod((0.9, 0, 2.9), (-4.6, 0, 2.9), 0.08, "aluminium", sides=6)
    sail(b, [(0.7, 0, 3.1), (-4.4, 0, 3.1), (0.6, 0, 15.2), (0.7, 0, 15.2)], 0.5, "white")
    sail(b, [(5.9, 0, 2.2), (1.4, 0, 2.6), (1.0, 0, 13.8), (1.05, 0, 13.8)], 0.5, "white")
    b.rod((5.9, 0, 1.9), (0.95, 0, 14.4), 0.02, "dark grey", sides=4)
    b.rod((-5.9, 0, 1.6), (0.85, 0, 15.4), 0.02, "dark grey", sides=4)
    return fitted(b.build("A white sailing yacht under sail", {"kind": "sail"}), (12.2, 3.9, 16.4))
