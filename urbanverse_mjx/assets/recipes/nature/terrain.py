"""Patches of ground and water: mud, sand, rocks, reeds, puddles, ponds, lakes, sea, canals, dams and waterfalls."""

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, mix, rgb, shade
from ...meshes.recipe import recipe
from ...meshes.shapes import Shape, merged
from ..shared.sizes import fitted_as, size_of
from .foliage import leafy, lump, small_leaves

Point3 = tuple[float, float, float]


def blob(rng: np.random.Generator, corners: int = 28, rough: float = 0.14) -> np.ndarray:
    """(corners,) radii about 1 of a smooth irregular outline: a few low waves of random phase."""
    a = np.arange(corners) * 2 * np.pi / corners
    waves = sum(rng.normal(0, rough / k) * np.cos(k * a + rng.random() * 6.28) for k in (2, 3, 4, 5))
    return 1.0 + np.clip(waves, -0.35, 0.35)


def dome_patch(
    size: Point3, radii: np.ndarray, profile: list[tuple[float, float]], noise: float, rng: np.random.Generator
) -> Shape:
    """A closed patch: rings at shares (r, z) of the outline from its rim to its middle, jittered by `noise` of z."""
    n = len(radii)
    a = np.arange(n) * 2 * np.pi / n
    edge = np.stack([np.cos(a) * radii * size[0] / 2, np.sin(a) * radii * size[1] / 2], 1)
    rings = [np.column_stack([edge * profile[0][0], np.zeros(n)])]
    for r, z in profile:
        lift = np.clip(z + rng.normal(0, noise, n) * (0.0 if z == 0 else 1.0), 0.0, 1.0)
        rings.append(np.column_stack([edge * r, lift * size[2]]))
    points = np.concatenate([*rings, [[0, 0, 0], [0, 0, profile[-1][1] * size[2]]]])
    faces = []
    for k in range(len(rings) - 1):
        for i in range(n):
            j = (i + 1) % n
            faces += [(k * n + i, k * n + j, (k + 1) * n + j), (k * n + i, (k + 1) * n + j, (k + 1) * n + i)]
    low, top, last = len(points) - 2, len(points) - 1, (len(rings) - 1) * n
    for i in range(n):
        j = (i + 1) % n
        faces += [(low, j, i), (top, last + i, last + j)]
    uv = points[:, :2] / (2.0 * np.abs(points[:, :2]).max(0)) + 0.5
    return Shape(points, np.array(faces), uv)


def ripples(
    color: Color, rng: np.random.Generator, size: int = 96, foam: float = 0.0, glint: float = 1.0
) -> np.ndarray:
    """(size, size, 3): water with crests of light; `foam` in [0, 1] adds white caps."""
    y, x = np.mgrid[0:size, 0:size] / size
    level = np.zeros((size, size))
    for _ in range(9):
        a, f = rng.random() * 0.9 - 0.45, rng.uniform(4, 16)
        level += np.sin(6.28 * f * (x * np.sin(a) + y * np.cos(a)) + rng.random() * 6.28) / 9
    base, sky = np.array(rgb(color), float), np.array(rgb(mix(color, "white", 0.65)), float)
    image = base + (sky - base) * np.clip(0.35 + 1.2 * level * glint, 0, 1)[..., None]
    if foam > 0:
        caps = np.clip((level - 0.42) * 6, 0, 1) * foam
        image = image + (np.array([250.0, 252.0, 252.0]) - image) * caps[..., None]
    return np.clip(image, 0, 255).astype(np.uint8)


def boulder(b: MeshBuilder, at: Point3, radii: Point3, color: Color, rng: np.random.Generator) -> None:
    """An angular stone half sunk in the ground."""
    shape = lump(radii, rng, 7, 5, 0.16)
    flat = Shape(np.maximum(shape.vertices, [-np.inf, -np.inf, -0.4 * radii[2]]), shape.faces)
    b.add(flat, color, at, crease_deg=12.0)


def reeds(b: MeshBuilder, spots: np.ndarray, height: float, blade: float, rng: np.random.Generator) -> None:
    """Clumps of three leaning leaves `blade` m wide at their foot on (n, 3) spots; almost half are bulrushes."""
    leaves: list[list[Shape]] = [[], [], []]
    for spot in spots:
        tall = height * float(rng.uniform(0.8, 1.0))
        for k in range(3):
            foot = spot + [*rng.normal(0, blade, 2), 0.0]
            tip = foot + [*rng.normal(0, 0.3, 2) * tall, tall * rng.uniform(0.75, 1.0)]
            rim = foot + blade * np.array([(-1.0, -0.3, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)])
            leaves[k].append(Shape(np.vstack([rim, tip]), np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)])))
        if rng.random() < 0.45:
            x, y, z = (float(v) for v in spot)
            b.rod((x, y, z), (x, y, z + tall), 0.12 * blade, "#7f9444", 4)
            b.cylinder(0.5 * blade, 0.22 * tall, (x, y, z + 0.75 * tall), "#5a3a22", segments=6)
    for k, green in enumerate(("#6f8f3c", "#557a34", "#8fa04a")):
        b.add(merged(leaves[k]), green)


@recipe("mud patch", 3, name="terrain.mud_patch")
def mud_patch(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Wet earth with puddles, footprints or the ruts of a wheel."""
    size, b = size_of("mud patch", variant), MeshBuilder(roughness=0.35)
    color: Color = ("#5b4230", "#6b5138", "#4a382c")[variant]
    image = paint.speckled((128, 128), color, rng, 9.0, 3)
    pen = paint.ImageDraw.Draw(image)
    for _ in range(9):
        px, py, r = *(rng.random(2) * 96 + 16), rng.uniform(4, 11)
        pen.ellipse((px - r, py - 0.6 * r, px + r, py + 0.6 * r), fill=mix(color, "#a9bac2", 0.55))
    if variant == 1:
        for k in range(7):
            x0, y0 = 20 + 13 * k, 58 + 12 * (k % 2)
            pen.ellipse((x0, y0, x0 + 10, y0 + 5), fill=shade(color, 0.55))
            pen.ellipse((x0 - 4, y0, x0 - 1, y0 + 5), fill=shade(color, 0.55))
    elif variant == 2:
        for y0 in (46, 78):
            for k in range(26):
                pen.line((5 * k, y0, 5 * k + 3, y0 + 8), fill=shade(color, 0.5), width=2)
    patch = dome_patch(
        size, blob(rng, 30, 0.2), [(1, 0), (0.93, 0.5), (0.8, 0.75), (0.55, 0.85), (0.3, 0.95)], 0.09, rng
    )
    b.add(patch, image=image, crease_deg=60)
    for _ in range(8):
        a, r = rng.random() * 6.28, rng.uniform(0.25, 0.8)
        at = (r * np.cos(a) * size[0] / 2, r * np.sin(a) * size[1] / 2, 0.6 * size[2])
        b.add(lump((0.04 * size[0], 0.04 * size[0], 0.3 * size[2]), rng, 6, 4), shade(color, 1.15), at)
    names = ("mud with puddles", "mud with footprints", "mud with a wheel's ruts")
    return fitted_as(b.build(names[variant]), "mud patch", size)


@recipe("sand patch", 3, name="terrain.sand_patch")
def sand_patch(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A flat dome of sand: rippled by wind, heaped, or with a bucket and a spade."""
    size, b = size_of("sand patch", variant), MeshBuilder(roughness=0.95)
    color: Color = ("#dcc48c", "#cfae74", "#e3d2a4")[variant]
    image = paint.speckled((128, 128), color, rng, 10.0, 1)
    pen = paint.ImageDraw.Draw(image)
    for k in range(0 if variant == 1 else 14):
        wave = [(x, 9 * k + 4 + 3 * np.sin(x / 9 + k)) for x in range(0, 129, 6)]
        pen.line(wave, fill=shade(color, 0.86), width=2)
    profile = [(1, 0), (0.86, 0.2), (0.62, 0.5), (0.4, 0.78), (0.2, 0.95)]
    b.add(dome_patch(size, blob(rng, 30, 0.12), profile, 0.04, rng), image=image, crease_deg=60)
    k = size[2]
    if variant == 2:
        b.cylinder(
            0.35 * k, 0.9 * k, (0.2 * size[0], 0.12 * size[1], 0.45 * k), "signal red", top_radius=0.5 * k, segments=12
        )
        b.rod(
            (0.1 * size[0], -0.14 * size[1], 0.6 * k),
            (0.28 * size[0], -0.2 * size[1], 1.0 * k),
            0.06 * k,
            "signal blue",
            6,
        )
        b.box((0.7 * k, 0.5 * k, 0.08 * k), (0.07 * size[0], -0.13 * size[1], 0.6 * k), "signal blue", (0, -12, -20))
    else:
        for _ in range(10):
            a, r = rng.random() * 6.28, rng.uniform(0.2, 0.7)
            at = (r * np.cos(a) * size[0] / 2, r * np.sin(a) * size[1] / 2, 0.55 * k * (1.2 - r))
            b.add(lump((0.02 * size[0], 0.018 * size[0], 0.12 * k), rng, 6, 4), shade(color, 0.8), at)
    names = ("rippled sand", "heap of builder's sand", "play sand with a bucket and spade")
    return fitted_as(b.build(names[variant]), "sand patch", size)


@recipe("rocky field", 3, hulls=10, name="terrain.rocky_field")
def rocky_field(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Outcrop and loose stones in thin grass, on red earth, or in moss."""
    size, b = size_of("rocky field", variant), MeshBuilder(roughness=0.95)
    x, y, z = size
    ground, stone = (("#7f8a52", "granite"), ("#a0674a", "#b5805a"), ("#6a7a48", "#8b9284"))[variant]
    image = paint.speckled((96, 96), ground, rng, 12.0, 2)
    b.add(
        dome_patch((x, y, 0.14 * z), blob(rng), [(1, 0), (0.9, 0.6), (0.5, 1.0)], 0.1, rng),
        image=image,
        crease_deg=60,
    )
    for k in range(24):
        r = 0.9 * np.sqrt((k + 0.3) / 24)
        a = 2.4 * k
        side = (0.11 * rng.uniform(0.35, 1.0) * (1.5 - r)) * min(x, y)
        tall = min(0.9 * side, 0.5 * z)
        boulder(
            b,
            (0.46 * x * r * np.cos(a), 0.46 * y * r * np.sin(a), 0.1 * z),
            (side, side * rng.uniform(0.7, 1.2), tall),
            shade(stone, float(rng.uniform(0.82, 1.15))),
            rng,
        )
    for k in range(3):
        at = ((0.08 * k - 0.1) * x, (0.1 * k - 0.08) * y, 0.3 * z)
        boulder(b, at, (0.14 * x, 0.15 * y, (0.72, 0.5, 0.6)[k] * z), shade(stone, 0.9 + 0.08 * k), rng)
    tufts = small_leaves(("#8fa04a", "#a8944a", "#5f8a3c")[variant], rng)
    for k in range(7):
        a = 0.9 * k + 0.4
        leafy(
            b,
            (0.36 * x * np.cos(a), 0.36 * y * np.sin(a), 0.2 * z),
            (0.05 * x, 0.05 * x, 0.14 * z),
            tufts,
            rng,
            6,
            4,
            0.25,
        )
    names = ("grey rocks in thin grass", "red rocks on bare earth", "mossy rocks")
    return fitted_as(b.build(names[variant]), "rocky field", size)


@recipe("wetland area", 3, name="terrain.wetland_area")
def wetland_area(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Shallow water with reeds and bulrushes, islets of grass and lily pads."""
    size, b = size_of("wetland area", variant), MeshBuilder(roughness=0.4)
    x, y, z = size
    water = ripples(("#5f7a6a", "#6b7f5a", "#58747f")[variant], rng, 96, 0.0, 0.6)
    level = 0.16 * z
    b.box((x, y, level), (0, 0, 0), "#5b4a34", skins={"+z": water})
    for k in range(5):
        a = 1.26 * k + variant
        at = (0.3 * x * np.cos(a), 0.3 * y * np.sin(a), 0.9 * level)
        islet = dome_patch(
            (0.24 * x, 0.22 * y, 0.12 * z), blob(rng, 12, 0.15), [(1, 0), (0.7, 0.8), (0.3, 1)], 0.0, rng
        )
        b.add(islet, "#6a7f3f", at)
        count = (10, 11, 8)[variant]
        spots = np.column_stack(
            [rng.normal(at[0], 0.05 * x, count), rng.normal(at[1], 0.05 * y, count), np.full(count, level)]
        )
        reeds(b, spots, 0.84 * z, 0.013 * x, rng)
    for _ in range(10):
        at = (float(rng.uniform(-0.45, 0.45)) * x, float(rng.uniform(-0.45, 0.45)) * y, level)
        b.cylinder(0.025 * x, 0.015 * z, at, "#4f8a4a", segments=9)
    names = ("wetland with reeds and lily pads", "marsh full of reeds", "wetland with islets")
    return fitted_as(b.build(names[variant]), "wetland area", size)
