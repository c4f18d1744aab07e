"""Buildings that are not shops: flats, houses, offices, garages."""

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import shade
from ...meshes.recipe import recipe
from ..nature.foliage import leaf_image, leafy, potted_bush
from ..shared import facade_images as images
from .facade import BUILDING, Facade, bays_over, finish_block, stoop


@recipe("apartment building", 4, BUILDING, hulls=8, name="buildings.apartment_building")
def apartment_building(variant: int, rng: np.random.Generator) -> BuiltAsset:
    kind, color, trim, width, floors, style = (
        ("plaster", "#d8c08f", "off white", 11.0, 5, "casement"),
        ("brick", "#8f4a38", "sandstone", 12.0, 5, "sash"),
        ("panel", "#c3c8c6", "light grey", 14.0, 5, "single"),
        ("ashlar", "#cfc4ae", "off white", 10.0, 4, "grid"),
    )[variant]
    storey, depth = 3.0, 7.5
    height = 0.9 + floors * storey + 0.3
    f = Facade(MeshBuilder(roughness=0.88), width, depth, height, trim)
    panes = [images.window(style, "white" if variant != 1 else "off white", rng) for _ in range(3)]
    bays = bays_over(4 if width < 13 else 5, width - 0.8)
    entrance = bays[1] if variant % 2 else bays[2]
    for level in range(floors):
        z = 0.9 + level * storey
        for y in bays:
            pane = panes[int(rng.integers(3))]
            if level == 0 and y == entrance:
                continue
            balcony = (
                variant in (0, 2) and level > 0 and (y in (bays[0], bays[-1]) if variant == 0 else y in bays[1:-1:2])
            )
            if balcony:
                f.opening(y, z + 0.05, 1.3, 2.2, images.window("casement", "white", rng), sill=False)
                f.balcony(y, z, 2.1, 0.85, "black" if variant == 0 else "dark grey")
            else:
                f.opening(y, z + 0.75, 1.2, 1.6, pane, lintel=trim if variant == 1 else None)
    threshold = stoop(f, entrance, 1.7, 3)
    f.opening(
        entrance,
        threshold,
        1.15,
        2.35,
        images.door("#5d3a24" if variant != 2 else "charcoal", "panel"),
        0.3,
        sill=False,
    )
    f.builder.box((0.9, 1.9, 0.12), (f.front + 0.45, entrance, threshold + 2.5), trim)
    f.course(0.62, 0.14, 0.06, shade(trim, 0.85))
    f.walls(images.wall(kind, (width, height), color, rng), shade(color, 0.72), 0.65)
    if variant == 3:
        f.cornice(height - 0.36)
        f.mansard(2.2, "#4d5560", bays_over(3, width - 1), panes[0])
        f.chimney(-1.5, width / 3, height + 2.8)
    else:
        f.cornice(height - 0.36, 0.25 if variant != 2 else 0.08)
        f.flat_roof(0.6)
        f.builder.box((2.4, 2.6, 2.0), (-1.2, -width / 5, height), shade(color, 0.8))
    names = (
        "A five-storey block of flats with balconies",
        "A brick apartment building with a stoop",
        "A concrete-panel apartment block",
        "A stone apartment house with a mansard roof",
    )
    return finish_block(f, names[variant], {"wall": kind, "floors": floors})


@recipe("house", 4, BUILDING, hulls=8, name="buildings.house")
def house(variant: int, rng: np.random.Generator) -> BuiltAsset:
    kind, color, trim, roof, width, along = (
        ("plaster", "#e6dcc4", "white", "#8e4431", 8.5, True),
        ("boards", "#7f9aa8", "white", "#50555c", 8.0, False),
        ("brick", "#93523f", "white", "#4a4440", 6.6, True),
        ("plaster", "#b5553c", "off white", "#5d5550", 7.5, False),
    )[variant]
    height, depth = (5.4, 5.3, 5.8, 5.2)[variant], 7.0
    f = Facade(MeshBuilder(roughness=0.88), width, depth, height, trim)
    panes = [images.window(("grid", "sash", "sash", "casement")[variant], trim, rng) for _ in range(2)]
    bays = bays_over(3, width - 0.6)
    door_bay = (1, 0, 2, 1)[variant]
    for level in range(2):
        for k, y in enumerate(bays):
            if level == 0 and k == door_bay:
                continue
            f.opening(
                y,
                0.95 + 2.75 * level,
                1.15,
                1.35,
                panes[int(rng.integers(2))],
                0.1,
                lintel=trim if variant == 2 else None,
            )
            if variant in (0, 3):  # shutters
                for side in (-1, 1):
                    f.builder.box(
                        (0.05, 0.42, 1.35),
                        (f.front + 0.03, y + side * 0.82, 0.95 + 2.75 * level),
                        ("dark green", "off white")[variant == 3],
                    )
    y = bays[door_bay]
    threshold = stoop(f, y, 1.5, 2)
    f.opening(
        y,
        threshold,
        1.0,
        2.15,
        images.door(("dark green", "red", "dark blue", "dark wood")[variant]),
        0.15,
        sill=False,
    )
    if variant == 1:  # a porch over the whole front
        f.builder.box((1.5, width - 0.04, 0.14), (f.front + 0.76, 0, 2.75), shade(roof, 0.9))
        for py in np.linspace(-width / 2 + 0.15, width / 2 - 0.15, 4):
            f.builder.box((0.14, 0.14, 2.75), (f.front + 1.35, py, 0), "white")
        f.builder.box((1.5, width - 0.04, 0.16), (f.front + 0.76, 0, 0), "grey wood")
    else:
        with f.builder.frame((f.front + 0.45, y, threshold + 2.35)):
            f.builder.profile([(-0.5, 0), (0.5, 0), (-0.5, 0.45)], 1.7, color=roof)
    f.walls(images.wall(kind, (width, height), color, rng), shade(color, 0.7), 0.35)
    f.gable_roof((2.2, 3.0, 2.0, 2.6)[variant], roof, along=along, wall=color)
    if not along:
        pane = panes[0]
        f.builder.panel(pane, (f.front + 0.02, 0, height + 0.85), 0.95, 1.1)
        f.builder.box((0.1, 1.15, 0.07), (f.front + 0.04, 0, height + 0.24), trim)
    f.chimney(-1.2, width / 4, height + (2.6 if along else 2.4))
    leaves = leaf_image("leaf", rng)
    for side in (-1, 1):
        leafy(f.builder, (f.front + 0.45, side * (width / 2 - 0.7), 0.35), (0.42, 0.6, 0.45), leaves, rng, 8, 5)
    names = (
        "A cream house with green shutters and a red roof",
        "A blue wooden house with a porch",
        "A brick terraced house",
        "A red plastered gabled house",
    )
    return finish_block(f, names[variant], {"wall": kind, "roof": str(roof)})


@recipe("office building", 3, BUILDING, hulls=6, name="buildings.office_building")
def office_building(variant: int, rng: np.random.Generator) -> BuiltAsset:
    wall, color, trim, width, floors = (
        ("panel", "#8f99a3", "aluminium", 14.0, 5),
        ("panel", "#4d5560", "charcoal", 12.0, 5),
        ("plaster", "#d6d2c8", "off white", 13.0, 4),
    )[variant]
    storey, depth = 3.1, 8.0
    height = 4.2 + (floors - 1) * storey - 0.3
    f = Facade(MeshBuilder(roughness=0.5), width, depth, height, trim)
    glass = [images.window("office", trim, rng, (48, 40), lit=k == 2) for k in range(4)]
    bays = bays_over((7, 5, 6)[variant], width - 0.5)
    step = bays[1] - bays[0]
    for level in range(1, floors):
        for y in bays:
            share = (0.92, 0.80, 0.66)[variant]
            tall = (2.2, 2.0, 1.7)[variant]
            f.opening(
                y,
                4.2 + (level - 1) * storey,
                step * share,
                tall,
                glass[int(rng.integers(4))],
                (0.08, 0.30, 0.2)[variant],
                sill=variant == 2,
            )
        if variant != 2:
            f.course(4.2 + (level - 1) * storey - 0.5, 0.22, 0.06)
    if variant == 1:
        for k in range(len(bays) + 1):
            f.pilaster(-width / 2 + 0.25 + k * step, 3.2, height, 0.28)
    for k, y in enumerate(bays):
        middle = k == len(bays) // 2
        if middle:
            f.opening(y, 0.03, min(step * 0.95, 2.2), 2.6, images.door(trim, "double", (48, 56)), 0.6, sill=False)
        else:
            f.opening(y, 0.35, step * 0.88, 2.5, glass[3], 0.12, sill=False)
    name = ("NORTHBANK HOUSE", "DATAWORKS", "OFFICE CENTRE 12")[variant]
    y = bays[len(bays) // 2]
    f.builder.box((1.5, 4.4, 0.2), (f.front + 0.75, y, 2.85), "charcoal")
    f.fascia(y, 3.08, 4.4, 0.5, images.sign(name, "charcoal", "white", (176, 20)), "charcoal")
    f.walls(images.wall(wall, (width, height), color, rng), shade(color, 0.6), 3.1)
    f.flat_roof(0.8 if variant == 1 else 0.5)
    for k, y in enumerate((-width / 4, 0.3, width / 4)):
        f.builder.box((1.6, 1.8, 1.0 + 0.2 * k), (-1.5, y, height), "galvanised", bevel=0.05)
    for side in (-1, 1):
        potted_bush(f.builder, (f.front + 0.5, bays[len(bays) // 2] + side * 1.6, 0), 0.5, "charcoal", rng)
    names = ("A glass-fronted office building", "A dark office building with fins", "A rendered office building")
    return finish_block(f, names[variant], {"wall": wall, "floors": floors, "name": name})


@recipe("garage", 3, BUILDING, hulls=6, name="buildings.garage")
def garage(variant: int, rng: np.random.Generator) -> BuiltAsset:
    kind, color, doors, width = (
        ("plaster", "#cfc6b4", 1, 6.0),
        ("brick", "#94553f", 2, 7.2),
        ("panel", "#a9b0b3", 3, 9.6),
    )[variant]
    height, depth = (3.0, 3.1, 3.4)[variant], 6.0
    f = Facade(MeshBuilder(roughness=0.85), width, depth, height, "light grey")
    paint = ("white", "dark green", "signal blue")[variant]
    for k, y in enumerate(bays_over(doors, width - (0.6 if doors > 1 else 1.8))):
        image, pen = images.paint.canvas((192, 160), paint)
        for row in range(8):
            pen.rectangle((0, 20 * row, 192, 20 * row + 3), fill=shade(paint, 0.72))
        if variant != 2:
            for x in range(4):
                pen.rectangle((12 + 46 * x, 26, 42 + 46 * x, 38), fill=images.rgb("dark glass"))
        pen.rectangle((86, 134, 106, 140), fill=images.rgb("black"))
        f.opening(y - (0.7 if doors == 1 else 0), 0.02, 2.6, 2.3, images.paint.shrunk(image, (72, 60)), 0.2, sill=False)
        if doors > 1:
            number = images.sign(str(k + 1), "white", "black", (16, 16))
            f.builder.panel(number, (f.front + 0.02, y, 2.62), 0.3, 0.3)
    if doors == 1:
        f.opening(2.1, 0.02, 0.9, 2.05, images.door("grey", "panel", (24, 52)), 0.12, sill=False)
    f.builder.box((0.62, width - 0.02, 0.03), (f.front + 0.3, 0, 0), "dark concrete")
    f.walls(images.wall(kind, (width, height), color, rng))
    if variant == 0:
        f.gable_roof(1.5, "#6b4038", along=False, wall=color)
    else:
        f.course(height - 0.2, 0.2, 0.12, around=True)
        f.flat_roof(0.18)
    if variant == 2:
        f.fascia(
            0,
            height - 0.1,
            5.0,
            0.6,
            images.sign("GARAGE & PARKING", "signal blue", "white", (176, 22)),
            "signal blue",
        )
    names = ("A garage with one door and a gable", "A double brick garage", "A row of three garages")
    return finish_block(f, names[variant], {"doors": doors})
