"""The dry surfaces of the 98 road materials.

Greys of asphalt follow measured albedo (new 0.05, worn 0.12-0.18 linear: sRGB 0.25 to 0.46), concrete 0.25-0.4.
Stones of wearing courses are 8-11 mm, of surface dressing 10-14 mm (EN 13108-1 and EN 12271, from memory).
"""

import dataclasses

import numpy as np

from . import bases, layouts
from .board import Board, mix
from .surface import Surface
from .variants import Variant, brick, cast, in_courses, in_herringbone, sett


def _asphalt(
    name: str,
    colour: str,
    words: str,
    conditions: str,
    tile_m: float = 4.0,
    **surface_of: float | tuple[float, float, float],
) -> Variant:
    def make(board: Board) -> Surface:
        return bases.asphalt(board, **surface_of)  # pyright: ignore[reportArgumentType]

    return cast(name, colour, words, conditions, "asphalt", "asphalt", tile_m, make)


def _concrete_lane(name: str, colour: str, words: str, conditions: str, rgb: bases.Colour, finish: str) -> Variant:
    """A cast slab of 4.5 m with sawn and sealed joints (usual spacing of plain jointed pavements: 4-5 m)."""

    def make(board: Board) -> Surface:
        ground = bases.cast_concrete(board, rgb, finish, 0.06)
        pattern = layouts.courses(board, 1, 1, 0.0)
        seal = np.clip((0.010 - pattern.edge) / board.pixel + 0.5, 0.0, 1.0)
        colour = mix(ground.colour, (0.17, 0.17, 0.17), seal * 0.9)
        stain = np.exp(-pattern.edge / 0.05) * 0.10
        colour = colour * (1.0 - stain)[..., None]
        return dataclasses.replace(ground, colour=colour, height=ground.height - 0.004 * seal, joint=seal)

    return cast(name, colour, words, conditions, "concrete", "concrete", 4.5, make, (4.5, 4.5))


def _setts(board: Board) -> Surface:
    return bases.laid(board, layouts.random_courses(board, 18, 0.13, 0.22, 0.02, 0.004, 0.08), _GRANITE)


def _arcs(board: Board) -> Surface:
    return bases.laid(board, layouts.arcs(board, 2, 28, 12, 0.22, 0.018, 0.003), _BASALT)


def _block(board: Board) -> Surface:
    return bases.laid(board, layouts.random_courses(board, 12, 0.24, 0.18, 0.025, 0.004, 0.06), _WARM)


def _round(board: Board) -> Surface:
    return bases.laid(board, layouts.cells(board, 17, 17, 0.75, bend=0.006, bend_scale=0.1), _FIELD)


def _gravel(board: Board) -> Surface:
    return bases.loose_stone(
        board, ((0.58, 0.56, 0.53), (0.50, 0.49, 0.47), (0.64, 0.60, 0.54), (0.45, 0.43, 0.41)), 0.028,
        (0.50, 0.47, 0.42), 0.45,
    )  # fmt: skip


_GRANITE = sett((0.55, 0.54, 0.53), (0.48, 0.48, 0.48), (0.58, 0.55, 0.52))
_BASALT = sett((0.37, 0.37, 0.39), (0.32, 0.32, 0.34), (0.42, 0.41, 0.41))
_WARM = sett((0.58, 0.50, 0.45), (0.53, 0.47, 0.44), (0.50, 0.50, 0.50), joint_m=0.016)
_FIELD = sett((0.52, 0.50, 0.47), (0.45, 0.43, 0.41), (0.57, 0.52, 0.45), joint_m=0.022, dome=0.014, spread=0.13)

ROADS: tuple[Variant, ...] = (
    _asphalt("asphalt_new", "black", "fresh dark asphalt, fine stones under bitumen",
             "dry wet puddled snow_tracks leaves tracked trenched", grey=0.26, chip_m=0.008, exposed=0.12,
             contrast=0.2),
    _asphalt("asphalt_used", "grey", "asphalt in use, stones just showing",
             "dry cracked patched sealed tracked stained wet puddled snow_tracks icy leaves sanded",
             grey=0.37, exposed=0.35, contrast=0.28),
    _asphalt("asphalt_old", "grey", "old grey asphalt, stones worn bare",
             "dry cracked alligatored patched sealed stained wet puddled snow_tracks snow_thin sanded",
             grey=0.44, exposed=0.5, contrast=0.3, stain=0.08),
    _asphalt("asphalt_bleached", "pale grey", "pale asphalt bleached by the sun",
             "dry cracked alligatored patched sealed sanded wet", grey=0.54, exposed=0.55, tint=(1.03, 1.0, 0.95)),
    _asphalt("asphalt_coarse", "grey", "coarse asphalt with stones of 16 mm",
             "dry cracked tracked wet snow_tracks", 3.0, grey=0.41, chip_m=0.016, exposed=0.45, contrast=0.36),
    _asphalt("asphalt_chippings", "beige", "surface dressing of pale chippings", "dry tracked sanded wet", 3.0,
             grey=0.52, chip_m=0.013, exposed=0.75, contrast=0.34, tint=(1.05, 1.0, 0.91)),
    _asphalt("asphalt_open", "dark grey", "open-pored drainage asphalt", "dry wet", 3.0,
             grey=0.32, chip_m=0.012, exposed=0.4, contrast=0.4),
    _asphalt("asphalt_red", "red", "asphalt of reddish stone", "dry worn wet", grey=0.42, exposed=0.5,
             tint=(1.25, 0.92, 0.85)),
    _asphalt("asphalt_brown", "brown", "brownish country asphalt", "dry cracked sanded mossy", grey=0.42,
             exposed=0.5, tint=(1.06, 1.0, 0.92), stain=0.10),
    _asphalt("lane_green", "green", "bicycle lane in green paint on asphalt", "painted_green painted_green_wet",
             grey=0.38),
    _asphalt("lane_red", "red", "bicycle lane in red paint on asphalt", "painted_red painted_red_worn", grey=0.40),
    _asphalt("lane_blue", "blue", "bicycle lane in blue paint on asphalt", "painted_blue", grey=0.40),
    _asphalt("lane_ochre", "yellow", "bus lane in ochre paint on asphalt", "painted_ochre", grey=0.40),
    _concrete_lane("concrete_pale", "pale grey", "pale concrete road slabs with sealed joints",
                   "dry cracked patched stained wet puddled snow_tracks", (0.66, 0.65, 0.61), "float"),
    _concrete_lane("concrete_broomed", "grey", "broomed grey concrete road slabs",
                   "dry cracked wet sanded", (0.58, 0.575, 0.56), "broom"),
    _concrete_lane("concrete_exposed", "beige", "exposed-aggregate concrete road",
                   "dry wet", (0.58, 0.54, 0.48), "exposed"),
    cast("setts_granite", "grey", "grey granite setts in courses", "dry worn mossy wet puddled snow leaves", "setts",
         "stone", 2.34, _setts),
    cast("setts_arcs", "dark grey", "dark basalt setts in segmental arcs", "dry wet mossy", "setts", "stone", 2.8,
         _arcs),
    cast("setts_blocks", "brown", "large warm granite blocks", "dry wet", "setts", "stone", 2.4, _block),
    cast("cobbles_round", "grey brown", "round field cobbles", "dry wet mossy", "setts", "stone", 2.2, _round),
    in_courses("clinker_running", "brick", "brick", "red", "red clinker bricks in running bond", "dry worn wet",
               (0.2, 0.1), (10, 20), brick((0.50, 0.30, 0.24), (0.44, 0.27, 0.23), (0.54, 0.34, 0.26))),
    in_herringbone("clinker_herringbone", "brick", "brick", "brown", "brown clinker bricks in herringbone", "dry wet",
                   0.1, 20, brick((0.43, 0.33, 0.28), (0.38, 0.29, 0.26), (0.48, 0.36, 0.29))),
    cast("gravel", "grey", "gravel road of crushed stone", "dry puddled", "gravel", "gravel", 2.0, _gravel),
    cast("earth", "brown", "beaten earth road with small stones", "dry muddy", "gravel", "soil", 3.0,
         lambda board: bases.beaten_earth(board, (0.50, 0.41, 0.31), 0.05)),
)  # fmt: skip
