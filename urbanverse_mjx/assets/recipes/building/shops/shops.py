"""Shops, cafes and the like: a narrow town building with a shop front below and flats above."""

import numpy as np

from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import shade
from ....meshes.recipe import recipe
from ...nature.foliage import potted_bush
from ...shared import facade_images as images
from ..facade import BUILDING, BUILDING_DENSITY, Facade, finish
from .shop_styles import SHOPS, Shop


def _blade(words: str, shop: Shop) -> np.ndarray:
    image, pen = images.paint.canvas((128, 128), "white" if words in ("cross", "pole") else shop.back)
    if words == "cross":
        pen.rectangle((46, 12, 82, 116), fill=images.rgb("green"))
        pen.rectangle((12, 46, 116, 82), fill=images.rgb("green"))
    elif words == "pole":
        for k in range(-2, 6):
            color = ("signal red", "signal blue")[k % 2]
            pen.polygon([(0, 32 * k), (128, 32 * k - 70), (128, 32 * k - 54), (0, 32 * k + 16)], fill=images.rgb(color))
    else:
        images.paint.text(pen, words, (10, 34, 118, 94), shop.ink, 0.03)
    return np.asarray(images.paint.shrunk(image, (32, 32)))


def _ground_floor(f: Facade, shop: Shop, height: float, rng: np.random.Generator, mirror: float) -> None:
    """Door to one side, window over the rest, stall riser, pilasters, fascia."""
    w = f.width
    double = w >= 9.0
    door_width = 1.9 if double else 1.05
    door_y = mirror * (w / 2 - 0.75 - door_width / 2)
    f.opening(
        door_y,
        0.04,
        door_width,
        2.45,
        images.door(shop.base, "double" if double else "glass", (48 if double else 28, 60)),
        0.45,
        sill=False,
    )
    span = w - 1.5 - door_width - 0.35
    middle = -mirror * (w / 2 - 0.55 - span / 2)
    count = 1 if span < 6.5 else 2
    image = images.shop_window(shop.goods, shade(shop.base, 0.85), rng, warm=shop.goods not in ("boxes", "posters"))
    for k in range(count):
        one = span / count
        f.opening(middle + (k - (count - 1) / 2) * one, 0.62, one - 0.12, 2.0, image, 0.16)
    for y in (-w / 2 + 0.22, w / 2 - 0.22):
        f.pilaster(y, 0, height - 0.75, 0.36, shade(shop.base, 0.9))
    f.builder.box((0.35, door_width + 0.3, 0.05), (f.front + 0.1, door_y, 0), "granite")
    lettering = images.sign(shop.name, shop.back, shop.ink, (224, max(18, round(224 * 0.62 / w))), shop.ink)
    f.fascia(0, height - 0.78, w - 0.1, 0.62, lettering, shop.back)
    f.course(height - 0.14, 0.14, 0.18)


def _outside(f: Facade, shop: Shop, mirror: float, rng: np.random.Generator) -> None:
    """What the shop keeps by its wall, flat enough that the pavement stays free."""
    x, side = f.front + 0.32, -mirror
    if shop.outside == "plants":
        for k in range(3):
            potted_bush(
                f.builder, (x, side * (f.width / 2 - 0.6 - 1.1 * k), 0), 0.42, ("terracotta", "charcoal")[k % 2], rng
            )
    elif shop.outside == "tables":
        for k in range(2):
            y = side * (f.width / 2 - 1.0 - 1.7 * k)
            f.builder.cylinder(0.3, 0.03, (x + 0.05, y, 0.72), "light wood", segments=12)
            f.builder.cylinder(0.03, 0.72, (x + 0.05, y, 0), "black", segments=6)
            f.builder.cylinder(0.2, 0.02, (x + 0.05, y, 0), "black", segments=10)
            for dy in (-0.55, 0.55):
                f.builder.box((0.36, 0.36, 0.04), (x, y + dy, 0.44), "dark wood")
                f.builder.box((0.34, 0.04, 0.42), (x, y + dy + (0.18 if dy > 0 else -0.18), 0.46), "dark wood")
                for a in (-0.15, 0.15):
                    for b in (-0.15, 0.15):
                        f.builder.beam((x + a, y + dy + b, 0), (x + a, y + dy + b, 0.45), 0.03, 0.03, "black")
    elif shop.outside == "crates":
        for k in range(4):
            y = side * (f.width / 2 - 0.55 - 0.62 * k)
            f.builder.box((0.5, 0.56, 0.55), (x, y, 0), "wood")
            for j in range(6):
                color = ("red", "orange", "lime", "yellow")[k]
                f.builder.ball(
                    (0.09, 0.09, 0.08),
                    (x - 0.14 + 0.14 * (j % 3), y + (-0.13 if j < 3 else 0.13), 0.57),
                    color,
                    segments=6,
                    rings=4,
                )


def _upper_floors(f: Facade, shop: Shop, base: float, storey: float, rng: np.random.Generator) -> None:
    count = max(2, int((f.width - 0.8) / 2.1))
    panes = [images.window(shop.window, shop.trim if shop.window != "office" else "aluminium", rng) for _ in range(3)]
    for level in range(shop.floors):
        z = base + level * storey + 0.85
        for k in range(count):
            y = (k - (count - 1) / 2) * (f.width - 0.7) / count
            lintel = shop.trim if shop.wall[0] == "brick" else None
            f.opening(y, z, 1.15, 1.65, panes[int(rng.integers(3))], lintel=lintel)
        if level < shop.floors - 1 and shop.wall[0] != "brick":
            f.course(base + (level + 1) * storey + 0.1, 0.12, 0.07)


def build_shop(shop: Shop, leaf: str, variant: int, rng: np.random.Generator) -> BuiltAsset:
    """The building of one shop."""
    base, storey = (3.7, 3.1) if shop.floors else (4.6, 3.1)
    height = base + shop.floors * storey + 0.35
    depth = float(rng.uniform(5.0, 7.0))
    builder = MeshBuilder(roughness=0.85)
    f = Facade(builder, shop.width, depth, height, shop.trim)
    mirror = (1.0, -1.0)[variant % 2]
    _ground_floor(f, shop, 3.7, rng, mirror)
    _upper_floors(f, shop, base, storey, rng)
    f.walls(images.wall(shop.wall[0], (shop.width, height), shop.wall[1], rng), shop.base, 3.55)
    if shop.awning:
        cloth = images.awning(shop.awning[0], shop.awning[1] if len(shop.awning) > 1 else None)
        f.awning(0, 2.95, shop.width - 0.8, 1.15, cloth, 0.45)
    if shop.blade is not None:
        f.blade_sign(mirror * (shop.width / 2 - 0.5), 4.05 if shop.floors else 2.2, _blade(shop.blade, shop), 0.65)
    _outside(f, shop, mirror, rng)
    if shop.roof == "mansard":
        f.cornice(height - 0.36)
        n = max(2, int(shop.width / 3))
        dormers = [(k - (n - 1) / 2) * shop.width / n for k in range(n)]
        f.mansard(2.0, "#4d5560", dormers, images.window("casement", shop.trim, rng, (24, 30)))
        f.chimney(-depth / 4, shop.width / 3, height + 2.6)
    elif shop.roof == "gable":
        f.gable_roof(min(2.4, depth * 0.35), "#7a4034" if shop.wall[0] == "brick" else "#5a4a44", wall=shop.wall[1])
        f.chimney(-depth / 5, shop.width / 3, height + 2.2)
    else:
        f.cornice(height - 0.30, 0.22)
        f.flat_roof(0.45)
        builder.box((0.9, 1.2, 0.8), (-depth / 5, shop.width / 5, height), "galvanised", bevel=0.04)
    description = f"A {shop.floors + 1}-storey building with a {leaf} named {shop.name} on the ground floor"
    params = {"name": shop.name, "wall": shop.wall[0], "floors": shop.floors, "roof": shop.roof}
    return finish(builder, description, params, shop.width * depth * height * BUILDING_DENSITY, 0.9)


def _register(leaf: str) -> None:
    @recipe(leaf, 3, BUILDING, hulls=8, name="shops.shop")
    def shop(variant: int, rng: np.random.Generator) -> BuiltAsset:
        return build_shop(SHOPS[leaf][variant], leaf, variant, rng)


for _leaf in SHOPS:
    _register(_leaf)
