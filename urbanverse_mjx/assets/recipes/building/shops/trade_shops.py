"""Shops of one trade each: shoes, bicycles, spectacles, fish; town houses with a shop front and small pavilions."""

import numpy as np

from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, mix, shade
from ....meshes.recipe import recipe
from ...shared import facade_images as images
from ...shared.sizes import fitted_as, size_of
from ..facade import Facade
from .shop_front import Front, emblem, roof_board, wall_plaque
from .shop_outside import set_out
from .trades import TRADES

#: (kind, colour) of walls and the style of their windows; every trade takes three of them.
WALLS: tuple[tuple[str, Color, str], ...] = (
    ("plaster", "#d9c7a3", "casement"),
    ("brick", "#8f4a38", "sash"),
    ("ashlar", "#cfc4ae", "grid"),
    ("plaster", "#a9bfc2", "casement"),
    ("panel", "#b9bec1", "single"),
    ("brick", "#a8705a", "sash"),
    ("plaster", "#d7a27e", "casement"),
    ("boards", "#8fa58a", "sash"),
    ("plaster", "#e6e0d2", "grid"),
    ("brick", "#6e3d32", "single"),
)
ROOFS = ("flat", "gable", "mansard", "flat", "gable")
ROOF_HEIGHT = {"flat": 0.45, "gable": 1.9, "mansard": 1.9}  # m
EMBLEMS = ("wall", "blade", "roof")
TILES: tuple[Color, ...] = ("#7a4034", "#4d5560", "#5a4a44", "#8a5a3a")


def _storeys(single: bool, wall_height: float) -> tuple[int, float, float]:
    """(floors above the shop, height of one, height of the shop) for a wall, m."""
    floors = 0 if single or wall_height < 5.6 else max(1, round((wall_height - 3.9) / 3.0))
    if floors == 0:
        return 0, 0.0, min(wall_height - 0.35, 8.5)
    storey = min(3.2, (wall_height - 3.6) / floors)
    return floors, storey, wall_height - floors * storey - 0.3


def _upper_floors(
    f: Facade, floors: int, storey: float, ground: float, style: str, rng: np.random.Generator, clear: bool
) -> None:
    """Rows of windows; `clear` leaves the middle of the lowest row to the emblem."""
    panes = [images.window(style, f.trim, rng) for _ in range(2)]
    count = max(2, min(8, int((f.width - 0.6) / 2.0)))
    step = (f.width - 0.7) / count
    for level in range(floors):
        for k in range(count):
            y = (k - (count - 1) / 2) * step
            if clear and level == 0 and abs(y) < 1.7:
                continue
            tall = min(1.7, storey - 1.2)
            f.opening(y, ground + level * storey + 0.75, min(1.2, step * 0.6), tall, panes[int(rng.integers(2))])


def _roof(f: Facade, kind: str, tile: Color, wall: Color, pane: images.Image.Image) -> None:
    rise = ROOF_HEIGHT[kind]
    if kind == "gable":
        f.gable_roof(rise, tile, wall=wall)
        f.chimney(-f.depth / 5, f.width / 3, f.height + 1.5)
    elif kind == "mansard":
        count = max(2, min(6, int(f.width / 3)))
        f.mansard(rise, tile, [(k - (count - 1) / 2) * f.width / count for k in range(count)], pane)
    else:
        f.cornice(f.height - 0.32, 0.2)
        f.flat_roof(rise)
        side = min(1.2, 0.14 * f.width)
        f.builder.box((side, 1.3 * side, 0.8 * side), (-f.depth / 5, f.width / 5, f.height), "galvanised", bevel=0.04)


def build_trade(leaf: str, variant: int, rng: np.random.Generator) -> BuiltAsset:
    """One shop; trades differ in goods, signs, walls, roofs and in how the front is laid out."""
    trade, number = TRADES[leaf], list(TRADES).index(leaf)
    size = size_of(leaf, variant)
    wall = WALLS[(number + 3 * variant) % len(WALLS)]
    single = trade.single or size[1] > 14
    sign = "roof" if single else EMBLEMS[(number + variant) % 3]
    if size[2] < 4.6:  # too low for a board above the roof
        sign = "none"
    kind = "flat" if sign == "roof" or single else ROOFS[(number + 2 * variant) % len(ROOFS)]
    awning = trade.fronts[variant] in ("side", "middle") and (number + variant) % 2 == 0 and not single
    board = min(4.5, 0.28 * size[2]) if sign == "roof" else 0.0
    above = board + 0.5 if sign == "roof" else ROOF_HEIGHT[kind]
    floors, storey, ground = _storeys(single, size[2] - above)
    if floors == 0 and sign == "wall":
        sign = "blade"
    reach = 1.05 if awning or trade.outside else 0.35
    f = Facade(MeshBuilder(roughness=0.8), size[1] - 0.3, size[0] - reach - 0.2, size[2] - above, "off white")
    back = trade.paints[variant][0]
    Front(f, trade, variant, ground, (1.0, -1.0)[variant % 2], shade(back, 0.9)).lay()
    _upper_floors(f, floors, storey, ground, wall[2], rng, sign == "wall")
    f.walls(images.wall(wall[0], (f.width, f.height), wall[1], rng, 160), mix(back, "black", 0.15), ground - 0.1)
    if awning:
        cloth = images.awning(back, "white" if variant != 1 else None)
        f.awning(0, ground - 0.9, f.width - 0.7, 1.0, cloth, 0.42)
    if sign == "blade":
        at = 0.1 if floors else -0.95
        f.blade_sign(
            (-1.0, 1.0)[variant % 2] * (f.width / 2 - 0.4), ground + at, emblem(trade, variant), 1.25 if floors else 0.8
        )
    elif sign == "wall":
        wall_plaque(f, trade, variant, ground + (1.6 if floors else -0.2), 1.05 if floors else 0.8)
    _roof(f, kind, TILES[(number + variant) % 4], wall[1], images.window("casement", "off white", rng, (24, 30)))
    if sign == "roof":
        roof_board(f, trade, variant, board)
    if trade.outside is not None:
        set_out(f, trade.outside, (1.0, -1.0)[variant % 2], variant, rng)
    name = trade.names[variant]
    built = f.builder.build(
        f"{leaf} named {name} in a house of {floors + 1} storeys",
        {"name": name, "wall": wall[0], "floors": floors, "front": trade.fronts[variant], "roof": kind},
    )
    return fitted_as(built, leaf, size)


def _register(leaf: str) -> None:
    @recipe(leaf, 3, hulls=8, name="trade_shops.trade_shop")
    def trade_shop(variant: int, rng: np.random.Generator) -> BuiltAsset:
        return build_trade(leaf, variant, rng)


for _leaf in TRADES:
    _register(_leaf)
