"""Pieces of water: puddle, pond, lake, canal, sea, dam and waterfall."""

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import recipe
from ..building import masonry as m
from ..road.roads import kerb
from ..shared.sizes import Size, fitted_as, size_of
from .foliage import leafy, small_leaves
from .terrain import blob, boulder, dome_patch, reeds, ripples


@recipe("a shallow pool of water", 3, name="waters.shallow_pool")
def shallow_pool(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A puddle that mirrors the sky, with a dark wet rim; leaves float on it, drops ring it."""
    size, b = size_of("a shallow pool of water", variant), MeshBuilder(roughness=0.08)
    radii = blob(rng, 32, 0.22)
    b.add(dome_patch(size, radii, [(1, 0), (0.97, 0.35), (0.8, 0.4)], 0.0, rng), "#4c5054", crease_deg=60)
    sky = ripples(("#7d9cb4", "#8fa9b8", "#6f8798")[variant], rng, 96, 0.0, 0.35)
    b.add(dome_patch(size, radii * 0.9, [(1, 0), (0.985, 0.75), (0.6, 0.8)], 0.0, rng), image=sky, crease_deg=60)
    z, k = 0.8 * size[2], min(size[0], size[1])
    if variant != 2:
        for j in range(5):
            a = 2.4 * j
            at = (0.3 * size[0] * np.cos(a) * (0.4 + 0.1 * j), 0.3 * size[1] * np.sin(a), z)
            leaf = [(0.05 * k, 0), (0.015 * k, 0.022 * k), (-0.05 * k, 0), (0.015 * k, -0.022 * k)]
            b.extrude(leaf, 0.15 * size[2], at, ("orange", "#a8642a", "yellow")[j % 3], (0, 0, 50 * j))
    if variant != 0:
        for j in range(4):
            at = ((0.2 - 0.13 * j) * size[0], (0.12 * (-1) ** j) * size[1], z)
            for r in (0.05, 0.09):
                b.ring(r * k, 0.1 * size[2], at, "#cfdde6", segments=16, sides=3)
    names = ("puddle with fallen leaves", "puddle with leaves in the rain", "puddle in the rain")
    return fitted_as(b.build(names[variant]), "a shallow pool of water", size)


def _lilies(b: MeshBuilder, x: float, y: float, z: float, size: float, count: int, rng: np.random.Generator) -> None:
    for k in range(count):
        a, r = 2.4 * k, 0.3 + 0.1 * rng.random()
        at = (r * x * np.cos(a), r * y * np.sin(a), z)
        pad = [(size * np.cos(t), size * np.sin(t)) for t in np.linspace(0.35, 6.0, 10)] + [(0.0, 0.0)]
        b.extrude(pad, 0.12 * size, at, ("#4f8a4a", "#6fa052")[k % 2], (0, 0, 70 * k))
        if k % 2 == 0:
            b.cone(0.4 * size, 0.5 * size, (at[0], at[1], z + 0.1 * size), ("pink", "white")[k // 2 % 2], segments=6)


@recipe("pond", 3, hulls=6, name="waters.pond")
def pond(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Water in a ring of stones with lilies and reeds; a formal round basin; a wild pond in grass with ducks."""
    size, b = size_of("pond", variant), MeshBuilder(roughness=0.25)
    x, y, z = size
    water = ripples(("#4f7f74", "#5f93a8", "#5a7d5f")[variant], rng, 96, 0.0, 0.5)
    radii = blob(rng, 32, 0.0 if variant == 1 else 0.12)
    bank = ("#7f9a55", "#b9b2a2", "#6f8f48")[variant]
    b.add(
        dome_patch((x, y, 0.5 * z), radii, [(1, 0), (0.97, 0.6), (0.86, 1.0), (0.6, 1.0)], 0.0, rng),
        bank,
        crease_deg=50,
    )
    b.add(
        dome_patch((0.82 * x, 0.82 * y, 0.52 * z), radii, [(1, 0), (1.0, 1.0), (0.5, 1.0)], 0.0, rng),
        image=water,
        crease_deg=60,
    )
    top = 0.52 * z
    if variant == 1:
        for k in range(28):
            a = 2 * np.pi * k / 28
            at = (0.44 * x * np.cos(a), 0.44 * y * np.sin(a), 0.36 * z)
            b.box(
                (0.1 * y, 0.095 * (x + y) / 2, 0.26 * z),
                at,
                shade("sandstone", 0.92 + 0.08 * (k % 3)),
                (0, 0, np.degrees(a)),
            )
        b.lathe(
            [(0.1 * x, 0), (0.05 * x, 0.2 * z), (0.12 * x, 0.26 * z), (0.02 * x, 0.3 * z), (0.02 * x, 0.48 * z)],
            (0, 0, top),
            "granite",
            segments=14,
        )
    else:
        for k in range(22 if variant == 0 else 9):
            a = 2 * np.pi * k / (22 if variant == 0 else 9) + rng.normal(0, 0.05)
            r = 0.45 * radii[int(a / 6.2832 * 32) % 32]
            s = 0.05 * x * float(rng.uniform(0.7, 1.2))
            boulder(
                b,
                (r * x * np.cos(a), r * y * np.sin(a), 0.5 * z),
                (s, s, min(0.25 * z, 0.8 * s)),
                shade("granite", float(rng.uniform(0.8, 1.2))),
                rng,
            )
        a = 2.2 + 0.1 * np.arange(12) + 2.6 * (np.arange(12) % 2)
        spots = np.column_stack([0.4 * x * np.cos(a), 0.4 * y * np.sin(a), np.full(12, 0.45 * z)])
        reeds(b, spots, 0.55 * z, 0.012 * x, rng)
    _lilies(b, 0.7 * x, 0.7 * y, top, 0.035 * x, (7, 4, 4)[variant], rng)
    for k in range(2 if variant == 2 else 0):
        with b.frame((0.1 * x * k, (0.12 - 0.16 * k) * y, top), (0, 0, 60 * k), 0.06 * x):
            b.ball((0.5, 0.28, 0.26), (0, 0, 0.12), ("#8a6a4a", "#d8d4cc")[k], segments=8, rings=5)
            b.ball(0.17, (0.45, 0, 0.52), ("#3f6f4a", "#8a6a4a")[k], segments=8, rings=5)
            b.rod((0.38, 0, 0.2), (0.44, 0, 0.5), 0.1, ("#3f6f4a", "#8a6a4a")[k], 6)
            b.box((0.2, 0.12, 0.06), (0.66, 0, 0.47), "orange")
    names = ("garden pond with stones and lilies", "round basin with a fountain", "wild pond with ducks")
    return fitted_as(b.build(names[variant]), "pond", size)


@recipe("lake", 2, hulls=4, name="waters.lake")
def lake(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A wide water with a shore of sand or grass, trees on it, an islet and a rowing boat."""
    size, b = size_of("lake", variant), MeshBuilder(roughness=0.2)
    x, y, z = size
    radii = blob(rng, 40, 0.16)
    shore: Color = ("#9aa860", "#d8c493")[variant]
    b.add(
        dome_patch((x, y, 0.4 * z), radii, [(1, 0), (0.96, 0.6), (0.88, 1.0), (0.6, 1.0)], 0.0, rng),
        shore,
        crease_deg=50,
    )
    water = ripples(("#3f7f9a", "#4a93a8")[variant], rng, 128, 0.0, 0.5)
    b.add(
        dome_patch((0.88 * x, 0.88 * y, 0.44 * z), radii, [(1, 0), (1.0, 1.0), (0.5, 1.0)], 0.0, rng),
        image=water,
        crease_deg=60,
    )
    leaves = small_leaves("leaf", rng)
    for k in range(22):
        a = 2 * np.pi * k / 22 + rng.normal(0, 0.08)
        r = 0.47 * radii[int(a / 6.2832 * 40) % 40]
        s = 0.018 * x * float(rng.uniform(0.7, 1.2))
        leafy(b, (r * x * np.cos(a), r * y * np.sin(a), 0.62 * z), (s, s, 0.34 * z), leaves, rng, 7, 4)
    b.add(
        dome_patch((0.14 * x, 0.12 * y, 0.2 * z), blob(rng, 14), [(1, 0), (0.6, 0.9)], 0.0, rng),
        "#8fa058",
        (0.12 * x, 0.1 * y, 0.42 * z),
    )
    leafy(b, (0.12 * x, 0.1 * y, 0.75 * z), (0.03 * x, 0.03 * x, 0.24 * z), leaves, rng, 7, 4)
    k = 0.03 * x
    hull = [
        (-k, 0.0),
        (-0.7 * k, 0.35 * k),
        (0.5 * k, 0.35 * k),
        (1.1 * k, 0.0),
        (0.5 * k, -0.35 * k),
        (-0.7 * k, -0.35 * k),
    ]
    b.extrude(hull, 0.14 * z, (-0.12 * x, -0.1 * y, 0.43 * z), "dark red", (0, 0, 35))
    b.extrude(
        [(0.8 * u, 0.7 * v) for u, v in hull], 0.02 * z, (-0.12 * x, -0.1 * y, 0.565 * z), "light wood", (0, 0, 35)
    )
    jetty = (0.30 * x, -0.2 * y, 0.5 * z)
    b.box((0.16 * x, 0.02 * y, 0.06 * z), jetty, "wood")
    for k in range(4):
        b.cylinder(
            0.004 * x, 0.2 * z, (jetty[0] - 0.07 * x + 0.045 * x * k, jetty[1], 0.4 * z), "dark wood", segments=5
        )
    return fitted_as(b.build(("lake with a green shore", "lake with a sandy shore")[variant]), "lake", size)


@recipe("canal", 3, hulls=6, name="waters.canal")
def canal(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Water between quay walls with bollards and rails; grass banks; a narrow boat on it."""
    size, b = size_of("canal", variant), MeshBuilder(roughness=0.3)
    x, y, z = size
    b.box((x, 0.98 * y, 0.3 * z), (0, 0, 0), "#6b6454")
    water = ripples(("#4f7468", "#5a8088", "#4a6f7a")[variant], rng, 96, 0.0, 0.5)
    half, level = 0.34 * y, 0.45 * z
    b.box((x, 2.02 * half, level), (0, 0, 0), "#5a6f68", skins={"+z": water})
    for side in (-1, 1):
        edge = 0.5 * y - half
        b.box((x, edge, 0.62 * z), (0, side * (half + edge / 2), 0), ("#a39a8a", "#7f8a58", "brick")[variant])
        with b.frame((0, side * (half + 0.12 * edge), 0)):
            kerb(b, x, 0.0, 0.24 * edge, 0.68 * z, "sandstone")
        for k in range(max(3, round(x / 5))):
            px = (k + 0.5) * x / max(3, round(x / 5)) - x / 2
            b.lathe(
                [(0.14, 0), (0.09, 0.05), (0.09, 0.2 * z), (0.14, 0.25 * z)],
                (px, side * (half + 0.3 * edge), 0.66 * z),
                "cast iron",
                segments=8,
            )
        if variant != 1:
            for h in (0.17, 0.32):
                b.rod(
                    (-x / 2, side * 0.48 * y, (0.64 + h) * z),
                    (x / 2, side * 0.48 * y, (0.64 + h) * z),
                    0.035,
                    "black",
                    5,
                )
            for k in range(9):
                b.rod(
                    ((k / 8 - 0.5) * x * 0.99, side * 0.48 * y, 0.6 * z),
                    ((k / 8 - 0.5) * x * 0.99, side * 0.48 * y, 0.98 * z),
                    0.035,
                    "black",
                    5,
                )
    with b.frame((-0.1 * x, 0.16 * y, level)):  # a narrow boat
        w, run = 0.13 * y, 0.2 * x
        hull = [(-run, -w), (0.8 * run, -w), (run, 0), (0.8 * run, w), (-run, w)]
        b.extrude(hull, 0.22 * z, (0, 0, -0.04 * z), ("dark blue", "dark red", "dark green")[variant])
        b.box(
            (1.3 * run, 1.5 * w, 0.26 * z),
            (-0.1 * run, 0, 0.16 * z),
            ("signal red", "dark green", "cream")[variant],
            taper=(0.98, 0.85),
        )
        for k in range(4):
            b.box((0.16 * run, 1.56 * w, 0.1 * z), ((0.3 * k - 0.6) * run, 0, 0.24 * z), "light blue")
    names = (
        "canal between stone quays with a boat",
        "canal between green banks with a boat",
        "canal between brick quays with a boat",
    )
    return fitted_as(b.build(names[variant]), "canal", size)


@recipe("sea", 2, hulls=2, name="waters.sea")
def sea(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A square of waves: long swell with foaming crests, or a calm green sea running up a beach."""
    size, b = size_of("sea", variant), MeshBuilder(roughness=0.15)
    x, y, z = size
    n = 25
    u, v = np.meshgrid(np.linspace(-0.5, 0.5, n), np.linspace(-0.5, 0.5, n), indexing="ij")
    swell = (
        np.sin(6.283 * (3.2 * u + 0.5 * v))
        + 0.5 * np.sin(6.283 * (5.1 * u - 1.4 * v) + 1.0)
        + 0.3 * np.sin(6.283 * (2 * u + 4 * v))
    )
    swell = (swell - swell.min()) / np.ptp(swell)
    share = 0.6 if variant == 0 else 0.3
    if variant == 1:
        swell = swell * np.clip((0.4 - u) / 0.5, 0.05, 1)
    height = z * (1 - share + share * swell)
    grid = np.stack([u * x, v * y, height], -1)
    water = ripples(("#1f5f80", "#3f9aa0")[variant], rng, 128, 0.9, 0.7)
    if variant == 1:
        water = water.copy()
        sand = np.array([222, 200, 150])
        for row in range(128):  # the image's rows run along -x: the first are the shore
            edge = 12 + 3 * np.sin(np.arange(128) / 9.0)
            water[row] = np.where(
                (row < edge)[:, None], sand, np.where((row < edge + 5)[:, None], [248, 250, 250], water[row])
            )
    b.sheet(grid[:, ::-1], image=water)
    rim = [
        [(grid[k, j, 0], grid[k, j, 1], z0) for z0 in (0.0, grid[k, j, 2])]
        for k, j in [(k, 0) for k in range(n)]
        + [(n - 1, j) for j in range(1, n)]
        + [(k, n - 1) for k in range(n - 2, -1, -1)]
        + [(0, j) for j in range(n - 2, -1, -1)]
    ]
    b.sheet(np.array(rim).transpose(1, 0, 2), "#1f4f66" if variant == 0 else "#3f8a90")
    b.quad([(x / 2, y / 2, 0), (x / 2, -y / 2, 0), (-x / 2, -y / 2, 0), (-x / 2, y / 2, 0)], "#16384a")
    return fitted_as(b.build(("sea with foaming waves", "shallow green sea at a beach")[variant]), "sea", size)


@recipe("dam", 3, hulls=6, name="waters.dam")
def dam(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A gravity wall with spillways and a road along its crest; an earth dam in grass; an old stone weir dam."""
    size, b = size_of("dam", variant), MeshBuilder(roughness=0.85)
    x, y, z = size
    color: Color = ("concrete", "#7f9a55", "#9a9080")[variant]
    crest, back = 0.22 * x, -0.46 * x
    outline = [(back, 0), (0.48 * x, 0), (back + crest, 0.9 * z), (back, 0.9 * z)]
    b.profile(outline, y, color=color)
    b.box((crest * 1.2, y, 0.03 * z), (back + crest / 2, 0, 0.9 * z), "dark concrete")
    for s in (-0.5, 0.55):
        b.box((0.02 * x, y, 0.05 * z), (back + crest * (0.5 + s), 0, 0.92 * z), shade(color, 0.85))
    bays = (5, 1, 4)[variant]
    slope = np.degrees(np.arctan2(0.9 * z, 0.48 * x - back - crest))
    for k in range(bays):
        y0 = (k - (bays - 1) / 2) * 0.14 * y
        start, end = np.array([back + crest + 0.02 * x, y0, 0.82 * z]), np.array([0.49 * x, y0, 0.02 * z])
        b.beam(tuple(start), tuple(end), 0.09 * y, 0.02 * z, "#dcecf2" if variant != 1 else "concrete")
        for s in (-1, 1):
            b.beam(
                (start[0], y0 + s * 0.055 * y, start[2] + 0.03 * z),
                (end[0], y0 + s * 0.055 * y, end[2] + 0.03 * z),
                0.014 * y,
                0.07 * z,
                shade(color, 0.9),
            )
            b.box((crest, 0.014 * y, 0.14 * z), (back + crest / 2, y0 + s * 0.055 * y, 0.86 * z), shade(color, 0.9))
        b.box((0.05 * x, 0.12 * y, 0.03 * z), (0.46 * x, y0, 0), "white")
    b.box((0.07 * x, y, 0.02 * z), (0.46 * x, 0, 0), "water")
    b.box((0.05 * x, y * 0.98, 0.78 * z), (back - 0.02 * x, 0, 0), "water")
    for s in (-1, 1):
        m.block(
            b,
            (crest, 0.05 * y, 0.1 * z),
            (back + crest / 2, s * 0.4 * y, 0.9 * z),
            m.painted_front((4, 3), (2, 1), ("plaster", "white"), ("single", "dark grey"), rng, 32),
            "#7a4034",
        )
    names = ("concrete gravity dam with five spillways", "grassed earth dam", "stone dam with four spillways")
    return fitted_as(b.build(names[variant], {"slope_deg": round(float(slope), 1)}), "dam", size)


def _falls(
    b: MeshBuilder, size: Size, wide: float, steps: tuple[tuple[float, float], ...], rng: np.random.Generator
) -> None:
    """Sheets of water over lips at steps = (x, z) shares of the size, lowest first, with foam where they land."""
    x, _, z = size
    fall = ripples("#b9d8e4", rng, 64, 0.6, 1.0).transpose(1, 0, 2)[:, ::-1]
    for k, (px, top) in enumerate(steps):
        bottom = 0.07 if k == 0 else steps[0][1]
        # The sheet of water bends over the lip and falls free of the rock.
        path = [
            (px - 0.22, top),
            (px - 0.02, top),
            (px + 0.06, top - 0.04),
            (px + 0.1, top - 0.16),
            (px + 0.12, bottom),
        ]
        grid = np.array(
            [
                [(u * x, s * wide / 2 * (1 + 0.12 * (top - v)), v * z) for s in (-1, -0.33, 0.33, 1)]
                for u, v in path[::-1]
            ]
        )
        b.sheet(grid, image=np.ascontiguousarray(fall), both_sides=True)
        for j in range(5):
            b.ball(
                (0.05 * x, 0.1 * wide, 0.03 * z),
                ((px + 0.14) * x, (j - 2) * wide / 4, bottom * z),
                "white",
                segments=7,
                rings=4,
            )


@recipe("waterfall", 3, hulls=8, name="waters.waterfall")
def waterfall(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Water over a step of rock into a pool: one broad fall, two steps, or a thin long fall."""
    size, b = size_of("waterfall", variant), MeshBuilder(roughness=0.5)
    x, y, z = size
    stone: Color = ("#7d766c", "#8a7a66", "#6a6f6c")[variant]
    wide = (0.36, 0.42, 0.2)[variant] * y
    steps = ((0.02, 0.9),) if variant != 1 else ((0.16, 0.5), (-0.14, 0.9))
    for k in range(24):
        y0 = ((k % 9) - 4) * 0.115 * y
        level = k // 9
        px = (-0.36 + 0.14 * level + (0.12 if abs(y0) > wide / 2 else 0.0)) * x
        tall = (
            (0.92 - 0.26 * level - (0.1 if variant != 1 else 0.14 * level)) * z * (1.0 if abs(y0) > wide / 2 else 0.86)
        )
        boulder(
            b,
            (px, y0, 0.34 * tall),
            (0.17 * x, 0.1 * y, 0.62 * tall),
            shade(stone, float(rng.uniform(0.78, 1.15))),
            rng,
        )
    b.box((0.5 * x, 0.9 * y, 0.7 * z), (-0.22 * x, 0, 0), shade(stone, 0.88), taper=(0.8, 0.9))
    _falls(b, size, wide, steps, rng)
    pool = ripples("#5f9aa8", rng, 64, 0.3, 0.6)
    b.add(
        dome_patch((0.62 * x, 0.9 * y, 0.06 * z), blob(rng, 22, 0.1), [(1, 0), (1, 1.0), (0.5, 1.0)], 0.0, rng),
        image=pool,
        at=(0.2 * x, 0, 0),
        crease_deg=60,
    )
    for k in range(11):
        a = -1.9 + 3.8 * k / 10
        s = 0.06 * y * float(rng.uniform(0.6, 1.1))
        boulder(
            b,
            (0.2 * x + 0.3 * x * np.cos(a), 0.44 * y * np.sin(a), 0.02 * z),
            (s, s, 0.7 * s),
            shade(stone, float(rng.uniform(0.8, 1.2))),
            rng,
        )
    leaves = small_leaves("dark leaf", rng)
    for s in (-1, 1):
        for k in range(3):
            leafy(
                b,
                ((0.1 - 0.2 * k) * x, s * 0.42 * y, (0.2 + 0.3 * k) * z),
                (0.09 * x, 0.08 * y, 0.09 * z),
                leaves,
                rng,
                7,
                4,
            )
    names = ("broad waterfall into a pool", "waterfall in two steps", "thin high waterfall")
    return fitted_as(b.build(names[variant]), "waterfall", size)
