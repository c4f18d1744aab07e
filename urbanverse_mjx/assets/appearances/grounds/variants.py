"""A variant is one dry surface with its size in metres; conditions turn it into several materials."""

import dataclasses
from collections.abc import Callable

from . import bases, layouts
from .bases import Colour, Matter
from .board import Board
from .layouts import Laid
from .surface import Surface


@dataclasses.dataclass(frozen=True)
class Variant:
    """Attributes:
    name: unique within its kind.
    family: "asphalt", "concrete", "slabs", "brick", "blocks", "stone", "setts", "tiles", "tactile", "gravel", "wood".
    matter: row of `assets_index/materials.csv`.
    colour: one word.
    tile_m: side of the tile.
    words: description of the dry surface.
    make: paints it.
    conditions: names of `weathering.CONDITIONS`, one material each.
    unit_m: (along u, along v) spacing of the units from joint to joint, or None.
    """

    name: str
    family: str
    matter: str
    colour: str
    tile_m: float
    words: str
    make: Callable[[Board], Surface]
    conditions: tuple[str, ...]
    unit_m: tuple[float, float] | None = None


def cast(
    name: str, colour: str, words: str, conditions: str, family: str, matter: str, tile_m: float,
    make: Callable[[Board], Surface], unit_m: tuple[float, float] | None = None,
) -> Variant:  # fmt: skip
    return Variant(name, family, matter, colour, tile_m, words, make, tuple(conditions.split()), unit_m)


def in_courses(
    name: str, family: str, matter: str, colour: str, words: str, conditions: str,
    unit_m: tuple[float, float], count: tuple[int, int], of: Matter, shift: float = 0.5, radius: float = 0.003,
    bend: float = 0.0, choice: Callable[[Board, Laid], object] | None = None,
) -> Variant:  # fmt: skip
    """Units of `unit_m` metres in `count` = (columns, rows); both must fill the same tile.

    Raises:
      ValueError: they do not.
    """
    tile_m = unit_m[0] * count[0]
    if abs(tile_m - unit_m[1] * count[1]) > 1e-6:
        raise ValueError(f"{name}: found a tile of {tile_m} m by {unit_m[1] * count[1]} m, needed a square.")

    def make(board: Board) -> Surface:
        pattern = layouts.courses(board, *count, shift=shift, radius=radius, bend=bend)
        return bases.laid(board, pattern, of, None if choice is None else choice(board, pattern))  # pyright: ignore[reportArgumentType]

    return Variant(name, family, matter, colour, round(tile_m, 6), words, make, tuple(conditions.split()), unit_m)


def in_herringbone(
    name: str, family: str, matter: str, colour: str, words: str, conditions: str, width_m: float, cells: int,
    of: Matter
) -> Variant:  # fmt: skip
    """Units 2:1 of `width_m` in herringbone, `cells` (a multiple of 4) widths to the tile."""

    def make(board: Board) -> Surface:
        return bases.laid(board, layouts.herringbone(board, cells, 0.003), of)

    unit = (round(2 * width_m, 6), width_m)
    return Variant(
        name, family, matter, colour, round(width_m * cells, 6), words, make, tuple(conditions.split()), unit
    )


def in_basket(
    name: str, family: str, matter: str, colour: str, words: str, conditions: str, width_m: float, squares: int,
    of: Matter
) -> Variant:  # fmt: skip
    def make(board: Board) -> Surface:
        return bases.laid(board, layouts.basket(board, squares, 0.003), of)

    unit, tile_m = (round(2 * width_m, 6), width_m), round(2 * width_m * squares, 6)
    return Variant(name, family, matter, colour, tile_m, words, make, tuple(conditions.split()), unit)


def brick(*colours: Colour, spread: float = 0.10, joint: Colour = (0.45, 0.41, 0.36), joint_m: float = 0.006) -> Matter:
    return Matter(
        colours, spread=spread, hue=0.02, mottling=0.05, speckle=0.045, joint_m=joint_m, joint=joint,
        joint_depth=0.005, chamfer_m=0.005, uneven_m=0.0009, roughness=0.82,
    )  # fmt: skip


def slab(*colours: Colour, spread: float = 0.05, joint: Colour = (0.36, 0.35, 0.33), joint_m: float = 0.006) -> Matter:
    return Matter(
        colours, spread=spread, hue=0.008, mottling=0.035, speckle=0.035, joint_m=joint_m, joint=joint,
        joint_depth=0.005, chamfer_m=0.005, uneven_m=0.0009, roughness=0.82,
    )  # fmt: skip


def block(*colours: Colour, spread: float = 0.06, joint: Colour = (0.42, 0.40, 0.36)) -> Matter:
    """Precast concrete blocks: bevelled rims."""
    return Matter(
        colours, spread=spread, hue=0.008, mottling=0.03, speckle=0.06, joint_m=0.004, joint=joint,
        joint_depth=0.006, chamfer_m=0.010, uneven_m=0.0007, roughness=0.84,
    )  # fmt: skip


def stone(
    *colours: Colour, speckle: float = 0.05, joint: Colour = (0.40, 0.38, 0.35), joint_m: float = 0.005,
    roughness: float = 0.65, spread: float = 0.06, mottling: float = 0.06, hue: float = 0.012,
) -> Matter:  # fmt: skip
    """Sawn natural stone."""
    return Matter(
        colours, spread=spread, hue=hue, mottling=mottling, speckle=speckle, joint_m=joint_m, joint=joint,
        joint_depth=0.003, chamfer_m=0.003, uneven_m=0.0006, roughness=roughness,
    )  # fmt: skip


def sett(
    *colours: Colour, joint_m: float = 0.012, dome: float = 0.005, joint: Colour = (0.31, 0.29, 0.26),
    spread: float = 0.10, weights: tuple[float, ...] = (),
) -> Matter:  # fmt: skip
    """Hewn stone with sunken joints and rounded heads."""
    return Matter(
        colours, weights, spread=spread, hue=0.015, mottling=0.06, speckle=0.11, speckle_m=0.007, joint_m=joint_m,
        joint=joint, joint_depth=0.009, chamfer_m=0.012, dome_m=dome, uneven_m=0.0018, roughness=0.75,
    )  # fmt: skip
