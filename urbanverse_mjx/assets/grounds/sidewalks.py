"""The dry surfaces of the 190 sidewalk materials. Unit sizes are the trade's: 200 x 100 mm pavers, 300 to 900 mm flags,
100 mm setts, 50 mm mosaic cubes, 203 x 102 mm (8 x 4 inch) North American bricks."""

from . import bases
from . import pavements as p
from .variants import Variant, block, brick, cast, in_basket, in_courses, in_herringbone, sett, slab, stone

_FINE = (0.36, 0.36, 0.37)

_CONCRETE: tuple[Variant, ...] = (
    cast("concrete_pale", "pale grey", "pale broomed concrete in squares of a metre and a half",
         "dry worn cracked patched stained wet puddled snow_thin leaves", "concrete", "concrete", 3.0,
         p.squares((0.68, 0.67, 0.64), "broom"), (1.5, 1.5)),
    cast("concrete_grey", "grey", "floated grey concrete in squares of a metre and a quarter",
         "dry worn cracked stained wet snow icy", "concrete", "concrete", 2.5,
         p.squares((0.57, 0.565, 0.55), "float"), (1.25, 1.25)),
    cast("concrete_warm", "beige", "smooth warm concrete in squares of a metre and a half", "dry cracked wet sanded",
         "concrete", "concrete", 3.0, p.squares((0.66, 0.61, 0.54), "smooth"), (1.5, 1.5)),
    cast("concrete_exposed", "beige", "exposed-aggregate concrete in squares of a metre and a quarter",
         "dry worn wet leaves mossy", "concrete", "concrete", 2.5, p.squares((0.60, 0.56, 0.50), "exposed"), (1.25, 1.25)),
    cast("concrete_ochre", "yellow", "ochre-tinted broomed concrete in squares of a metre", "dry cracked wet", "concrete",
         "concrete", 2.0, p.squares((0.68, 0.57, 0.40), "broom"), (1.0, 1.0)),
)  # fmt: skip

_FLAGS: tuple[Variant, ...] = (
    in_courses("flags_grey", "slabs", "concrete", "grey", "grey concrete flags of 600 by 400 mm in running bond",
               "dry worn cracked stained wet snow leaves mossy", (0.6, 0.4), (4, 6),
               slab((0.61, 0.605, 0.59), (0.57, 0.57, 0.56))),
    in_courses("flags_square", "slabs", "concrete", "grey", "square grey concrete flags of 400 mm in straight rows",
               "dry worn cracked stained wet puddled snow_thin", (0.4, 0.4), (6, 6), slab((0.60, 0.60, 0.59)), 0.0),
    in_courses("flags_small", "slabs", "concrete", "grey", "small square concrete flags of 300 mm",
               "dry cracked mossy wet snow leaves", (0.3, 0.3), (7, 7), slab((0.58, 0.58, 0.57), spread=0.09), 0.0),
    in_courses("flags_buff", "slabs", "concrete", "beige", "buff concrete flags of 600 by 300 mm in running bond",
               "dry worn stained wet leaves", (0.6, 0.3), (4, 8), slab((0.72, 0.65, 0.54), (0.69, 0.62, 0.52))),
    in_courses("flags_charcoal", "slabs", "concrete", "dark grey", "charcoal concrete flags of 450 mm, staggered",
               "dry worn wet puddled snow", (0.45, 0.45), (6, 6), slab((0.36, 0.36, 0.37), joint=(0.24, 0.24, 0.24))),
    in_courses("flags_rose", "slabs", "concrete", "red", "rose concrete flags of 400 mm in straight rows", "dry worn wet",
               (0.4, 0.4), (6, 6), slab((0.64, 0.50, 0.45)), 0.0),
    in_courses("flags_white", "slabs", "concrete", "white", "near-white concrete flags of 600 mm, staggered",
               "dry stained wet icy", (0.6, 0.6), (4, 4), slab((0.78, 0.775, 0.755), spread=0.03)),
    in_courses("flags_large", "slabs", "concrete", "grey", "large concrete flags of 900 by 600 mm in running bond",
               "dry cracked stained wet puddled snow_deep", (0.9, 0.6), (4, 6), slab((0.63, 0.62, 0.60), spread=0.06)),
    in_courses("flags_checks", "slabs", "concrete", "grey", "concrete flags of 400 mm in checks of two greys",
               "dry worn wet", (0.4, 0.4), (6, 6), slab((0.66, 0.655, 0.64), (0.47, 0.47, 0.47), spread=0.03), 0.0,
               choice=p.checks),
    in_courses("flags_red_checks", "slabs", "concrete", "red", "concrete flags of 300 mm in checks of red and buff",
               "dry worn wet", (0.3, 0.3), (8, 8), slab((0.60, 0.38, 0.32), (0.70, 0.62, 0.50), spread=0.04), 0.0,
               choice=p.checks),
    cast("flags_mixed", "grey", "concrete flags of mixed lengths in courses of 400 mm", "dry worn wet snow_thin leaves",
         "slabs", "concrete", 2.4, p.coursed(6, 0.6, 0.35, slab((0.60, 0.59, 0.57), (0.54, 0.54, 0.53), (0.65, 0.63, 0.60)))),
)  # fmt: skip

_BRICKS: tuple[Variant, ...] = (
    in_courses("brick_red_running", "brick", "brick", "red", "red bricks in running bond",
               "dry worn mossy wet snow leaves", (0.2, 0.1), (8, 16),
               brick((0.59, 0.35, 0.28), (0.54, 0.31, 0.25), (0.63, 0.40, 0.31))),
    in_herringbone("brick_red_herringbone", "brick", "brick", "red", "red bricks in herringbone",
                   "dry worn mossy stained wet snow leaves", 0.1, 16,
                   brick((0.60, 0.36, 0.29), (0.55, 0.31, 0.25), (0.50, 0.29, 0.24))),
    in_basket("brick_red_basket", "brick", "brick", "red", "red bricks in basket weave", "dry worn mossy wet", 0.1016, 8,
              brick((0.56, 0.32, 0.26), (0.61, 0.37, 0.30))),
    in_courses("brick_brown_running", "brick", "brick", "brown", "brown bricks in running bond", "dry worn wet leaves",
               (0.21, 0.105), (8, 16), brick((0.50, 0.39, 0.32), (0.45, 0.35, 0.30), (0.55, 0.43, 0.34))),
    in_herringbone("brick_brown_herringbone", "brick", "brick", "brown", "brown bricks in herringbone",
                   "dry worn mossy wet", 0.105, 16, brick((0.47, 0.36, 0.30), (0.52, 0.40, 0.32))),
    in_herringbone("brick_buff_herringbone", "brick", "brick", "yellow", "yellow bricks in herringbone",
                   "dry worn wet leaves", 0.1, 16, brick((0.71, 0.60, 0.43), (0.67, 0.55, 0.39), (0.74, 0.64, 0.48))),
    in_courses("brick_charcoal", "brick", "brick", "dark grey", "blue-black engineering bricks in running bond",
               "dry worn wet snow_thin", (0.2, 0.1), (8, 16), brick((0.31, 0.30, 0.32), (0.36, 0.33, 0.34), (0.27, 0.27, 0.29))),
    in_courses("brick_mixed", "brick", "brick", "red brown", "old bricks of many reds and browns in running bond",
               "dry mossy wet cracked", (0.2, 0.1), (9, 18),
               brick((0.58, 0.34, 0.28), (0.44, 0.30, 0.26), (0.63, 0.46, 0.36), (0.36, 0.28, 0.27), spread=0.14)),
    in_courses("brick_stack", "brick", "brick", "red", "red bricks in straight stacks", "dry worn wet", (0.203, 0.1015),
               (8, 16), brick((0.57, 0.33, 0.27), (0.53, 0.30, 0.25)), 0.0),
)  # fmt: skip

_BLOCKS: tuple[Variant, ...] = (
    in_herringbone("blocks_grey", "blocks", "concrete", "grey", "grey concrete blocks in herringbone",
                   "dry worn stained mossy wet snow", 0.1, 16, block((0.55, 0.545, 0.53), (0.51, 0.51, 0.50))),
    in_courses("blocks_running", "blocks", "concrete", "grey", "grey concrete blocks in running bond",
               "dry worn wet leaves", (0.2, 0.1), (8, 16), block((0.58, 0.575, 0.56))),
    in_courses("blocks_autumn", "blocks", "concrete", "brown", "concrete blocks in autumn tones of 240 by 160 mm",
               "dry worn wet", (0.24, 0.16), (8, 12),
               block((0.56, 0.44, 0.36), (0.62, 0.54, 0.42), (0.44, 0.36, 0.32))),
    cast("blocks_hexagon", "grey", "hexagonal concrete blocks", "dry worn mossy wet snow_thin", "blocks", "concrete", 2.1,
         p.hexagons(7, 8, block((0.60, 0.59, 0.57))), (0.3, 0.2625)),
    cast("blocks_hexagon_colours", "red", "hexagonal blocks in grey, rose and ochre", "dry worn wet", "blocks", "concrete",
         2.1, p.hexagons(7, 8, block((0.58, 0.57, 0.55), (0.61, 0.45, 0.40), (0.68, 0.57, 0.41))), (0.3, 0.2625)),
)  # fmt: skip

_STONES: tuple[Variant, ...] = (
    in_courses("granite_light", "stone", "stone", "pale grey", "light granite slabs of 600 by 300 mm", "dry stained wet snow",
               (0.6, 0.3), (4, 8), stone((0.69, 0.685, 0.67), (0.65, 0.645, 0.64), speckle=0.11), 0.5),
    cast("granite_courses", "grey", "grey granite slabs of free lengths in courses", "dry worn wet puddled", "stone",
         "stone", 2.4, p.coursed(6, 0.7, 0.4, stone((0.55, 0.55, 0.55), (0.50, 0.50, 0.51), speckle=0.12), 0.2)),
    in_courses("granite_dark", "stone", "stone", "dark grey", "dark granite slabs of 400 mm in straight rows", "dry wet icy",
               (0.4, 0.4), (5, 5), stone((0.35, 0.35, 0.36), speckle=0.13, joint=(0.25, 0.25, 0.25)), 0.0),
    cast("sandstone", "beige", "riven sandstone flags in uneven courses", "dry worn mossy wet leaves", "stone",
         "limestone", 2.8, p.coursed(6, 0.65, 0.4,
         stone((0.70, 0.62, 0.49), (0.65, 0.56, 0.44), (0.73, 0.67, 0.56), mottling=0.10, hue=0.03, roughness=0.85, joint_m=0.010),
         0.3, 0.003)),
    in_courses("limestone_polished", "stone", "marble", "white", "polished pale limestone of 600 mm", "dry wet stained",
               (0.6, 0.6), (4, 4), stone((0.80, 0.76, 0.68), (0.77, 0.73, 0.65), speckle=0.02, joint_m=0.003, roughness=0.35,
               mottling=0.05), 0.0),
    cast("slate", "blue grey", "blue-grey slate flags in uneven courses", "dry wet mossy", "stone", "stone", 2.4,
         p.coursed(6, 0.55, 0.45, stone((0.37, 0.40, 0.43), (0.33, 0.35, 0.38), (0.42, 0.42, 0.42), mottling=0.10, hue=0.03,
         roughness=0.7, joint_m=0.009), 0.3, 0.003)),
    cast("crazy_paving", "grey brown", "irregular flagstones", "dry mossy wet leaves", "stone", "stone", 3.0,
         p.irregular(7, stone((0.57, 0.55, 0.51), (0.60, 0.53, 0.44), (0.50, 0.50, 0.49), mottling=0.10, joint_m=0.022,
         spread=0.10, roughness=0.85), 0.85, 0.015)),
)  # fmt: skip

_SMALL: tuple[Variant, ...] = (
    cast("setts_small", "grey", "small granite setts in courses", "dry worn mossy wet snow leaves", "setts", "stone", 1.5,
         p.coursed(15, 0.105, 0.15, sett((0.60, 0.585, 0.57), (0.53, 0.525, 0.52), (0.63, 0.59, 0.54)), 0.06, 0.003, 0.015)),
    cast("setts_bows", "grey", "small granite setts in segmental arcs", "dry mossy wet snow_thin", "setts", "stone", 2.4,
         p.bows(2, 24, 12, sett((0.52, 0.515, 0.51), (0.46, 0.46, 0.46), (0.57, 0.54, 0.50)))),
    cast("calcada_waves", "white", "white limestone mosaic with dark waves", "dry worn wet", "setts", "limestone", 2.4,
         p.calcada("waves")),
    cast("calcada_net", "white", "white limestone mosaic with a dark net", "dry wet", "setts", "limestone", 2.4,
         p.calcada("net")),
    cast("calcada_stars", "white", "white limestone mosaic with dark stars", "dry wet", "setts", "limestone", 2.4,
         p.calcada("stars")),
    cast("pebbles", "brown", "river pebbles set in mortar", "dry wet", "setts", "stone", 1.2,
         p.irregular(24, sett((0.55, 0.51, 0.45), (0.44, 0.43, 0.41), (0.63, 0.58, 0.51), (0.40, 0.36, 0.32), joint_m=0.010,
         dome=0.008, joint=(0.52, 0.49, 0.44)), 0.8, 0.004)),
)  # fmt: skip

_TILES: tuple[Variant, ...] = (
    in_courses("terracotta", "tiles", "terracotta", "red", "square terracotta tiles of 200 mm", "dry worn wet", (0.2, 0.2),
               (8, 8), brick((0.68, 0.44, 0.33), (0.63, 0.40, 0.30), (0.71, 0.48, 0.37), spread=0.08), 0.0),
    in_courses("tiles_black_white", "tiles", "ceramic", "white", "black and white tiles of 300 mm in checks", "dry worn wet",
               (0.3, 0.3), (8, 8), stone((0.80, 0.79, 0.76), (0.22, 0.22, 0.23), roughness=0.45, speckle=0.02), 0.0,
               choice=p.checks),
    cast("panot_flower", "grey", "pressed cement tiles of 200 mm with a flower", "dry worn wet leaves", "tiles", "concrete",
         1.6, p.panot((0.60, 0.585, 0.56), "flower"), (0.2, 0.2)),
    cast("panot_squares", "red", "pressed red cement tiles of 200 mm with nine squares", "dry worn wet", "tiles", "concrete",
         1.6, p.panot((0.58, 0.38, 0.33), "bars"), (0.2, 0.2)),
    cast("tactile_domes_yellow", "yellow", "grey slabs with a strip of yellow warning domes", "dry worn wet", "tactile",
         "concrete", 2.4, p.tactile(slab((0.60, 0.60, 0.59)), (0.85, 0.67, 0.17), "domes", (2, 4)), (0.4, 0.4)),
    cast("tactile_domes_red", "red", "buff slabs with red warning domes", "dry wet", "tactile", "concrete", 2.4,
         p.tactile(slab((0.70, 0.64, 0.54)), (0.60, 0.30, 0.25), "domes", (3, 6)), (0.4, 0.4)),
    cast("tactile_bars_yellow", "yellow", "grey slabs with a yellow guiding strip of bars", "dry worn wet", "tactile",
         "concrete", 2.4, p.tactile(slab((0.58, 0.58, 0.57)), (0.85, 0.68, 0.20), "bars", (3, 4)), (0.4, 0.4)),
)  # fmt: skip

_SOFT: tuple[Variant, ...] = (
    cast("asphalt_fine", "dark grey", "fine dark asphalt footway", "dry cracked patched wet puddled leaves", "asphalt",
         "asphalt", 3.0, lambda board: bases.asphalt(board, 0.33, 0.005, 0.25, contrast=0.2)),
    cast("asphalt_grey", "grey", "old grey asphalt footway", "dry cracked mossy wet snow", "asphalt", "asphalt", 3.0,
         lambda board: bases.asphalt(board, 0.46, 0.006, 0.5, contrast=0.26, stain=0.08)),
    cast("asphalt_red", "red", "red asphalt footway", "dry wet", "asphalt", "asphalt", 3.0,
         lambda board: bases.asphalt(board, 0.42, 0.006, 0.4, (1.30, 0.85, 0.75), 0.2)),
    cast("resin_bound", "beige", "resin-bound gravel", "dry wet", "gravel", "gravel", 1.2,
         p.resin_bound(((0.72, 0.62, 0.46), (0.62, 0.50, 0.36), (0.80, 0.73, 0.60), (0.50, 0.42, 0.34)), 0.012)),
    cast("hoggin", "yellow", "bound sandy gravel of park walks", "dry puddled leaves", "gravel", "gravel", 3.0,
         lambda board: bases.beaten_earth(board, (0.72, 0.61, 0.45), 0.10)),
    cast("boardwalk", "brown", "timber boardwalk", "dry wet leaves", "wood", "wood", 1.68, p.planks((0.54, 0.47, 0.40)),
         (0.14, 1.68)),
)  # fmt: skip

SIDEWALKS: tuple[Variant, ...] = (*_CONCRETE, *_FLAGS, *_BRICKS, *_BLOCKS, *_STONES, *_SMALL, *_TILES, *_SOFT)
