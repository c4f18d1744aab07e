"""Playgrounds, mazes, beer gardens, water parks and stools."""

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import recipe
from ..nature.foliage import small_leaves
from ..nature.terrain import ripples
from ..shared import facade_images as images
from ..shared.sizes import fitted_as, size_of
from . import masonry as m

Point3 = tuple[float, float, float]


@recipe("stool", 3, hulls=4, name="public_places.stool")
def stool(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A bar stool on one foot, a wooden stool on four legs, a round metal stool with rungs."""
    size, b = size_of("stool", variant), MeshBuilder(roughness=0.5)
    d, z = size[0], size[2]
    r = 0.45 * d
    if variant == 0:
        b.cylinder(0.5 * d, 0.03 * z, (0, 0, 0), "aluminium", segments=20)
        b.lathe([(0.3 * d, 0.03 * z), (0.07 * d, 0.07 * z), (0.06 * d, 0.86 * z)], (0, 0, 0), "aluminium", segments=12)
        b.ring(0.32 * d, 0.03 * d, (0, 0, 0.34 * z), "aluminium", segments=18, sides=6)
        for a in (0, 90):
            b.box((0.62 * d, 0.04 * d, 0.03 * z), (0, 0, 0.325 * z), "aluminium", (0, 0, a))
        b.lathe(
            [(0.8 * r, 0), (r, 0.03 * z), (r, 0.1 * z), (0.85 * r, 0.14 * z), (0, 0.15 * z)],
            (0, 0, 0.85 * z),
            "dark red",
            segments=20,
        )
    else:
        color: Color = ("", "light wood", "charcoal")[variant]
        top: Color = ("", "wood", "charcoal")[variant]
        for k in range(4):
            a = np.pi / 4 + k * np.pi / 2
            foot = (0.47 * d * np.cos(a) * 1.05, 0.47 * d * np.sin(a) * 1.05, 0.0)
            b.rod(foot, (0.3 * d * np.cos(a), 0.3 * d * np.sin(a), 0.92 * z), 0.045 * d, color, 8)
            c = a + np.pi / 2
            t = 0.62 if variant == 1 else 0.3 + 0.2 * (k % 2)
            p = [(0.49 * d - (0.19 * d) * t) * np.array([np.cos(u), np.sin(u)]) for u in (a, c)]
            b.rod((*p[0], t * 0.92 * z), (*p[1], t * 0.92 * z), 0.028 * d, color, 6)
        if variant == 1:
            b.box((0.86 * d, 0.86 * d, 0.09 * z), (0, 0, 0.91 * z), top, bevel=0.03 * d)
        else:
            b.lathe([(r, 0), (1.04 * r, 0.03 * z), (r, 0.06 * z), (0.0, 0.05 * z)], (0, 0, 0.92 * z), top, segments=20)
            b.ring(0.12 * d, 0.01 * d, (0, 0, 0.972 * z), "light grey", segments=12, sides=4)
    names = ("red bar stool on one foot", "square wooden stool", "round metal stool")
    return fitted_as(b.build(names[variant]), "stool", size)


def _slide(b: MeshBuilder, x: float, y: float, top: float, reach: float, color: Color) -> None:
    """A chute that runs down along +x from (x, y, top)."""
    path = [(x, top), (x + 0.15 * reach, top), (x + 0.8 * reach, 0.14 * top), (x + reach, 0.1 * top)]
    rows = np.array(
        [[(px, y + s, pz + (0.28 if abs(s) > 0.3 else 0.0)) for s in (-0.34, -0.28, 0.28, 0.34)] for px, pz in path]
    )
    b.sheet(rows, color, both_sides=True)
    for s in (-0.36, 0.36):
        b.tube([(px, y + s, pz + 0.28) for px, pz in path], 0.04, shade(color, 0.8), 6)


@recipe("playground", 3, hulls=10, name="public_places.playground")
def playground(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A tower with a roof, ladder and slide, and swings beside it; a climbing net; a see-saw in front."""
    size, b = size_of("playground", variant), MeshBuilder(roughness=0.6)
    x, y, z = size
    post, roof, slide = (
        ("wood", "signal red", "signal yellow"),
        ("signal blue", "signal yellow", "signal red"),
        ("lime", "purple", "orange"),
    )[variant]
    b.box((x, y, 0.06), (0, 0, 0), ("sandstone", "#6f8a5a", "#a8604a")[variant])
    deck, ty = 0.44 * z, -0.26 * y
    for sx in (-0.7, 0.7):
        for sy in (-0.7, 0.7):
            b.cylinder(0.07, 0.74 * z, (-0.16 * x + sx, ty + sy, 0), post, segments=8)
    b.box((1.6, 1.6, 0.1), (-0.16 * x, ty, deck), "light wood")
    if variant == 1:
        m.dome(b, (-0.16 * x, ty, 0.74 * z), 1.15, roof, 0.26 * z / 1.15, sides=12)
    else:
        b.cylinder(1.35, 0.26 * z, (-0.16 * x, ty, 0.74 * z), roof, (0, 0, 45), 0.03, 4)
    for sy in (-0.7, 0.7):
        b.box((1.4, 0.06, 0.5), (-0.16 * x, ty + sy, deck + 0.1), roof)
    _slide(b, -0.16 * x + 0.75, ty, deck + 0.08, 0.66 * x - 0.8, slide)
    for k in range(6):
        b.rod(
            (-0.16 * x - 0.75 - 0.1 * (6 - k), ty - 0.35, 0.06 + k * deck / 6),
            (-0.16 * x - 0.75 - 0.1 * (6 - k), ty + 0.35, 0.06 + k * deck / 6),
            0.035,
            post,
            6,
        )
    for s in (-0.38, 0.38):
        b.rod((-0.16 * x - 1.4, ty + s, 0), (-0.16 * x - 0.7, ty + s, deck + 0.1), 0.045, post, 6)
    beam = 0.72 * z
    for py in (0.02 * y, 0.46 * y):
        for s in (-1, 1):
            b.rod((-0.05 * x + s * 0.16 * x, py, 0), (-0.05 * x, py, beam), 0.06, post, 8)
    b.rod((-0.05 * x, 0.0, beam), (-0.05 * x, 0.48 * y, beam), 0.06, post, 8)
    for k in range(2):
        py = (0.15 + 0.17 * k) * y
        swing = (0.1, -0.06)[k] * x
        for s in (-0.22, 0.22):
            b.rod((-0.05 * x, py + s, beam), (-0.05 * x + swing, py + s, 0.2 * z), 0.018, "galvanised", 4)
        b.box((0.2, 0.5, 0.06), (-0.05 * x + swing, py, 0.18 * z), slide)
    b.beam((0.36 * x, 0.05 * y, 0.14 * z), (0.36 * x, 0.42 * y, 0.26 * z), 0.2, 0.08, roof)
    b.convex(
        [
            (0.36 * x + u, 0.235 * y + v, w)
            for u, v, w in ((-0.2, -0.25, 0), (0.2, -0.25, 0), (-0.2, 0.25, 0), (0.2, 0.25, 0), (0, 0, 0.2 * z))
        ],
        post,
    )
    names = ("wooden playground with slide and swings", "blue playground with a domed tower", "colourful playground")
    return fitted_as(b.build(names[variant]), "playground", size)


_MAZE = (
    "#############",
    "#...#.....#.#",
    "#.#.#.###.#.#",
    "#.#...#.#...#",
    "#.#####.###.#",
    "#...#.....#.#",
    "###.#.###.#.#",
    "#.....#G#....",
    "#.#####.###.#",
    "#.#.....#...#",
    "#.#.###.#.###",
    "#...#.......#",
    "#############",
)


@recipe("maze", 2, hulls=16, name="public_places.maze")
def maze(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Clipped hedges, or low walls, on gravel with a goal in the middle."""
    size, b = size_of("maze", variant), MeshBuilder(roughness=0.95)
    x, y, z = size
    b.box((x, y, 0.08), (0, 0, 0), ("#cbb78e", "#b9b2a2")[variant])
    image = small_leaves(("#4f7f3a", "#2f5f3a")[variant], rng)
    rows = len(_MAZE)
    sx, sy = x / rows, y / rows
    grid = [list(row) for row in _MAZE] if variant == 0 else [list(c) for c in zip(*_MAZE, strict=True)]
    for i in range(rows):  # runs of hedge along y, then what stands alone along x
        j = 0
        while j < rows:
            run = 0
            while j + run < rows and grid[i][j + run] == "#":
                run += 1
            if run:
                at = ((rows / 2 - i - 0.5) * sx, (rows / 2 - j - run / 2) * sy, 0.08)
                top = z - 0.08
                b.box(
                    (0.92 * sx, run * sy, top),
                    at,
                    "#3f6f34",
                    skins=dict.fromkeys(("+x", "-x", "+y", "-y", "+z"), image),
                )
            j += max(run, 1)
    b.cylinder(0.5 * sx, 0.5, ((rows / 2 - 7.5) * sx, (rows / 2 - 7.5) * sy, 0.08), "granite", segments=12)
    b.lathe(
        [(0.2, 0.5), (0.12, 0.8), (0.35, 1.1), (0.02, 0.9 * z)],
        ((rows / 2 - 7.5) * sx, (rows / 2 - 7.5) * sy, 0.0),
        "marble",
        segments=10,
    )
    return fitted_as(b.build(("hedge maze", "dark yew maze")[variant]), "maze", size)


@recipe("beer garden", 3, hulls=12, name="public_places.beer_garden")
def beer_garden(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Long tables and benches under a light roof with strings of lamps, a counter with barrels and a sign."""
    size, b = size_of("beer garden", variant), MeshBuilder(roughness=0.85)
    x, y, z = size
    roof: Color = ("dark green", "#8a4a34", "cream")[variant]
    b.box((x, y, 0.06), (0, 0, 0), "#b9a684")
    for px in np.linspace(-0.47, 0.47, 4) * x:
        for s in (-1, 1):
            b.box((0.16, 0.16, 0.68 * z), (px, s * 0.46 * y, 0), "wood")
    if variant == 1:
        m.hip_roof(b, (0.97 * x, y, 0.32 * z), (0, 0, 0.68 * z), roof, 0.6)
    else:
        for k in range(5):  # a canvas roof in bays
            with b.frame((0, (k - 2) * 0.2 * y, 0.68 * z), (0, 0, 90)):
                b.profile([(-0.1 * y, 0), (0.1 * y, 0), (0, 0.26 * z)], 0.95 * x, color=roof if k % 2 == 0 else "white")
    for k in range(4):
        y0 = (k - 1.5) * 0.2 * y + 0.08 * y
        for px in (-0.2 * x, 0.22 * x):
            b.box((0.3 * x, 0.7, 0.06), (px, y0, 0.75), "orange" if variant != 2 else "light wood")
            for s in (-1, 1):
                b.box((0.3 * x, 0.26, 0.05), (px, y0 + 0.62 * s, 0.44), "wood")
                b.box((0.06, 1.4, 0.43), (px + s * 0.12 * x, y0, 0), "dark grey")
                b.box((0.06, 0.5, 0.74), (px + s * 0.12 * x, y0, 0), "dark grey")
            for j in range(2):
                b.cylinder(0.08, 0.2, (px + (0.06 - 0.12 * j) * x, y0 + 0.15, 0.81), "amber", segments=8)
                b.cylinder(0.085, 0.06, (px + (0.06 - 0.12 * j) * x, y0 + 0.15, 1.01), "white", segments=8)
    b.box((0.5 * x, 0.6, 1.1), (0, -0.43 * y, 0), "dark wood")
    for k in range(3):
        b.cylinder(0.32, 0.7, ((k - 1) * 0.13 * x, -0.43 * y + 0.3, 1.45), "wood", (90, 0, 0), segments=12)
    sign = np.asarray(
        images.sign(("BIERGARTEN", "BEER GARDEN", "BIERGARTEN")[variant], "signal blue", "white", (160, 28))
    )
    b.box((0.12, 0.56 * y, 0.2 * z), (0.492 * x, 0, 0.62 * z), "signal blue", skins={"+x": sign})
    for s in (-0.44, 0.44):
        for k in range(9):
            b.ball(
                0.09, ((k - 4) * 0.11 * x, s * y, 0.62 * z - 0.1 * (1 - abs(k - 4) / 4)), "lamp", segments=6, rings=4
            )
    names = (
        "beer garden under a green and white roof",
        "beer garden under a wooden roof",
        "beer garden under a cream roof",
    )
    return fitted_as(b.build(names[variant]), "beer garden", size)


@recipe("water park", 2, hulls=12, name="public_places.water_park")
def water_park(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Blue pools with winding tube slides from a tower, a mushroom fountain, palms and sun shades."""
    size, b = size_of("water park", variant), MeshBuilder(roughness=0.4)
    x, y, z = size
    b.box((x, y, 0.03 * z), (0, 0, 0), "#dccba4")
    water = ripples("#2f9fd0", rng, 96, 0.0, 0.5)
    for at, dims in (((0.2 * x, 0.2 * y), (0.46 * x, 0.48 * y)), ((0.26 * x, -0.26 * y), (0.38 * x, 0.34 * y))):
        b.box((dims[0] * 1.06, dims[1] * 1.05, 0.05 * z), (*at, 0), "white")
        b.box((*dims, 0.055 * z), (*at, 0), "water", skins={"+z": water})
    tower = (-0.3 * x, -0.05 * y)
    for sx in (-1, 1):
        for sy in (-1, 1):
            b.cylinder(0.02 * x, 0.82 * z, (tower[0] + sx * 0.07 * x, tower[1] + sy * 0.07 * x, 0), "white", segments=8)
    for k in range(3):
        b.box((0.18 * x, 0.18 * x, 0.02 * z), (*tower, (0.28 + 0.25 * k) * z), "light wood")
    b.cylinder(0.15 * x, 0.18 * z, (*tower, 0.82 * z), ("signal red", "signal blue")[variant], (0, 0, 45), 0.1, 4)
    for k, (color, turns, end) in enumerate(
        (("signal yellow", 1.6, (0.05, 0.22)), ("orange", 1.1, (0.08, -0.24)), ("lime", 0.7, (0.0, 0.05)))
    ):
        t = np.linspace(0, 1, 22)
        top, radius = (0.78, 0.53, 0.53)[k] * z, 0.16 * x * (1 - 0.3 * k)
        angle = 6.283 * turns * t + k * 2.0
        base_x, base_y = tower[0] + (end[0] * x - tower[0]) * t, tower[1] + (end[1] * y - tower[1]) * t
        swing = radius * np.sin(np.pi * t)
        path = np.stack([base_x + swing * np.cos(angle), base_y + swing * np.sin(angle), top + (0.1 * z - top) * t], 1)
        b.tube(path, 0.022 * x, color, 8)
        for j in (5, 10, 15):
            b.rod((path[j][0], path[j][1], 0), tuple(path[j]), 0.006 * x, "white", 5)
    mushroom = (0.3 * x, 0.24 * y)
    b.cylinder(0.012 * x, 0.36 * z, (*mushroom, 0), "white", segments=8)
    m.dome(b, (*mushroom, 0.36 * z), 0.07 * x, "signal red", 0.6, sides=14)
    for k in range(5):
        at = ((0.42 - 0.2 * k) * x, (-0.46, 0.46)[k % 2] * y)
        b.cylinder(0.006 * x, 0.3 * z, (*at, 0), "white", segments=6)
        b.cone(
            0.055 * x,
            0.1 * z,
            (*at, 0.28 * z),
            ("signal red", "signal yellow", "signal blue", "white", "orange")[k],
            segments=8,
        )
    m.board(b, "WATER PARK", (0.48 * x, -0.1 * y, 0.24 * z), 0.42 * y, 0.16 * z, "signal blue", "signal yellow")
    for s in (-1, 1):
        b.cylinder(0.01 * x, 0.4 * z, (0.47 * x, -0.1 * y + s * 0.2 * y, 0), "signal blue", segments=8)
    return fitted_as(
        b.build(("water park with slides and pools", "water park with a blue tower")[variant]), "water park", size
    )
