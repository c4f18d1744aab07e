"""The named conditions of materials: appearance, description and effect on friction."""

import dataclasses
from collections.abc import Callable

from ...categories.materials import material
from . import bases
from . import conditions as c
from .bases import Colour
from .board import Board
from .surface import Surface

_AUTUMN_COLOURS: tuple[Colour, ...] = ((0.62, 0.42, 0.14), (0.50, 0.30, 0.13), (0.66, 0.55, 0.20), (0.42, 0.29, 0.17))
_LATE_AUTUMN_COLOURS: tuple[Colour, ...] = ((0.40, 0.28, 0.17), (0.34, 0.24, 0.16), (0.48, 0.35, 0.20))


@dataclasses.dataclass(frozen=True)
class Condition:
    """Attributes:
    group: the word searched for: "dry", "wet", "snowy", "cracked" ...
    words: end of the description.
    apply: paints it; the family tells asphalt from units.
    friction: (dry friction) -> friction.
    reason: why.
    """

    group: str
    words: str
    apply: Callable[[Surface, Board, str], Surface]
    friction: Callable[[float], float] = lambda dry: dry
    reason: str = "as the dry material of assets_index/materials.csv"


# Rubber on wet pavement keeps some 0.7 of its dry friction at walking speed (textbooks on skidding: 0.7-0.8 dry,
# 0.45-0.6 wet); water standing takes a little more.
_WET_FRICTION, _STANDING_WATER_FRICTION = 0.72, 0.65
_WET_REASON = "0.72 of dry: wet pavement has 0.5 where dry has 0.7 (judged)"


def _snow(share: float) -> Callable[[float], float]:
    return lambda dry: share * material("snow").friction + (1 - share) * _WET_FRICTION * dry


def _painted(paint: Colour, wear: float = 0.12, wet: bool = False) -> Callable[[Surface, Board, str], Surface]:
    def apply(surface: Surface, board: Board, family: str) -> Surface:
        surface = c.painted(surface, board, paint, wear)
        return c.wet(surface, board, 0.9) if wet else surface

    return apply


def _patched(surface: Surface, board: Board, family: str) -> Surface:
    if family in ("concrete", "slabs"):
        return c.patched(surface, board, bases.cast_concrete(board, (0.55, 0.55, 0.53), "float"), 2, False)
    return c.patched(surface, board, bases.asphalt(board, 0.30, 0.008, 0.2), 2)


def _trenched(surface: Surface, board: Board, family: str) -> Surface:
    return c.patched(surface, board, bases.asphalt(board, 0.40, 0.010, 0.4), 1)


def _cracked(surface: Surface, board: Board, family: str) -> Surface:
    return c.worn(c.cracked(surface, board, 5 if family == "asphalt" else 3), board, 0.4)


def _leaves(surface: Surface, board: Board, family: str) -> Surface:
    return c.leaf_strewn(surface, board, 24.0, _AUTUMN_COLOURS, 0.085)


def _wet_leaves(surface: Surface, board: Board, family: str) -> Surface:
    return c.wet(c.leaf_strewn(surface, board, 45.0, _LATE_AUTUMN_COLOURS, 0.075), board, 0.7)


def _muddy(surface: Surface, board: Board, family: str) -> Surface:
    return c.puddled(surface, board, 0.30)


CONDITIONS: dict[str, Condition] = {
    "dry": Condition("dry", "dry and clean", lambda s, b, f: s),
    "worn": Condition("worn", "worn by traffic and feet", lambda s, b, f: c.worn(s, b, 1.0), lambda dry: 0.95 * dry,
                      "0.95 of dry: polished tops (judged)"),
    "cracked": Condition("cracked", "with cracks", _cracked),
    "alligatored": Condition("cracked", "with a net of fatigue cracks", lambda s, b, f: c.alligatored(s, b, 0.45)),
    "patched": Condition("patched", "with repair patches", _patched),
    "trenched": Condition("patched", "with a filled trench", _trenched),
    "sealed": Condition("patched", "with cracks sealed in bitumen", lambda s, b, f: c.sealed(s, b, 3),
                        lambda dry: 0.97 * dry, "0.97 of dry: a few smooth bands (judged)"),
    "stained": Condition("worn", "with stains and old chewing gum", lambda s, b, f: c.stained(s, b, 1.0),
                         lambda dry: 0.95 * dry, "0.95 of dry: some oil and grime (judged)"),
    "tracked": Condition("worn", "with polished wheel paths", lambda s, b, f: c.tracked(s, b), lambda dry: 0.95 * dry,
                         "0.95 of dry: polished wheel paths (judged)"),
    "mossy": Condition("overgrown", "with moss and weeds in the gaps", lambda s, b, f: c.mossy(s, b, 0.75),
                       lambda dry: 0.85 * dry, "0.85 of dry: moss is slippery (judged)"),
    "wet": Condition("wet", "wet after rain", lambda s, b, f: c.wet(s, b), lambda dry: _WET_FRICTION * dry,
                     _WET_REASON),
    "puddled": Condition("wet", "wet with puddles", lambda s, b, f: c.puddled(s, b),
                         lambda dry: _STANDING_WATER_FRICTION * dry,
                         "0.65 of dry: as wet, and water stands in part of it (judged)"),
    "muddy": Condition("wet", "muddy with puddles", _muddy, lambda dry: material("mud").friction,
                       "mud of assets_index/materials.csv"),
    "snow": Condition("snowy", "half under trodden snow", lambda s, b, f: c.snowy(s, b, 0.6, 0.10), _snow(0.6),
                      "60 % snow, the rest wet"),
    "snow_thin": Condition("snowy", "with a thin broken layer of snow", lambda s, b, f: c.snowy(s, b, 0.35),
                           _snow(0.35),
                           "35 % snow, the rest wet"),
    "snow_deep": Condition("snowy", "under fresh snow, hardly showing", lambda s, b, f: c.snowy(s, b, 0.93),
                           _snow(0.93), "93 % snow, the rest wet"),
    "snow_tracks": Condition("snowy", "snowed over with dark wheel tracks",
                             lambda s, b, f: c.snowy(s, b, 0.66, 0.35, True), _snow(0.66), "66 % snow, the rest wet"),
    "icy": Condition("icy", "with frozen patches", lambda s, b, f: c.icy(s, b, 0.45),
                     lambda dry: 0.45 * material("ice").friction + 0.55 * _WET_FRICTION * dry,
                     "45 % ice, the rest wet"),
    "leaves": Condition("leaf-strewn", "strewn with autumn leaves", _leaves, lambda dry: 0.85 * dry,
                        "0.85 of dry: leaves slide on the ground (judged)"),
    "wet_leaves": Condition("leaf-strewn", "wet and littered with brown leaves", _wet_leaves,
                            lambda dry: 0.6 * dry, "0.6 of dry: wet leaves slide on wet ground (judged)"),
    "sanded": Condition("sandy", "dusted with blown sand", lambda s, b, f: c.sanded(s, b), lambda dry: 0.85 * dry,
                        "0.85 of dry: loose grains roll (judged)"),
    "painted_green": Condition("painted", "hardly worn", _painted((0.23, 0.47, 0.33)), lambda dry: 0.9 * dry,
                               "0.9 of dry: paint closes the pores (judged)"),
    "painted_green_wet": Condition("painted", "wet after rain", _painted((0.23, 0.47, 0.33), 0.2, True),
                                   lambda dry: 0.9 * _WET_FRICTION * dry,
                                   "0.9 of dry for the paint, 0.72 for the water (judged)"),
    "painted_red": Condition("painted", "hardly worn", _painted((0.60, 0.27, 0.23)), lambda dry: 0.9 * dry,
                             "0.9 of dry: paint closes the pores (judged)"),
    "painted_red_worn": Condition("painted", "half worn off", _painted((0.58, 0.29, 0.25), 0.45),
                                  lambda dry: 0.95 * dry,
                                  "0.95 of dry: half of the paint is left (judged)"),
    "painted_blue": Condition("painted", "hardly worn", _painted((0.24, 0.40, 0.58), 0.15), lambda dry: 0.9 * dry,
                              "0.9 of dry: paint closes the pores (judged)"),
    "painted_ochre": Condition("painted", "a little worn", _painted((0.72, 0.56, 0.27), 0.22), lambda dry: 0.92 * dry,
                               "0.92 of dry: paint closes most pores (judged)"),
}  # fmt: skip
