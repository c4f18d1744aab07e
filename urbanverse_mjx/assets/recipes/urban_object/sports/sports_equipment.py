"""Equipment of sports grounds and gardens: outdoor machines, trampolines, hurdles, table-tennis tables."""

import numpy as np
from PIL import Image

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, rgb
from ....meshes.recipe import recipe
from ...shared.sizes import varied


@recipe("trampoline", 3, name="sports_things.trampoline")
def trampoline(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Garden trampoline with a net on poles, one without, small one of a gym."""
    b = MeshBuilder(roughness=0.7)
    style = ("netted", "low", "mini")[variant]
    pad: Color = ("blue", "green", "black")[variant]
    r, h = ((1.4, 0.7), (1.4, 0.75), (0.48, 0.24))[variant]
    tube = 0.03 if variant < 2 else 0.016
    b.cylinder(r * 0.8, 0.012, (0, 0, h - 0.012), "charcoal", segments=28)
    b.lathe([(r * 0.8, h - 0.01), (r, h - 0.02), (r, h + 0.012), (r * 0.8, h + 0.015)], color=pad, segments=28)
    b.ring(r * 0.985, tube, (0, 0, h - 0.03), "galvanised", segments=28, sides=5)
    for k in range(4 if variant < 2 else 6):
        a = 2 * np.pi * k / (4 if variant < 2 else 6) + 0.4
        if variant == 2:
            x, y = 0.92 * r * np.cos(a), 0.92 * r * np.sin(a)
            b.rod((x, y, 0), (x, y, h - 0.03), tube, "galvanised", sides=6)
            b.cylinder(0.028, 0.03, (x, y, 0), "black", segments=8)
            continue
        c, d = a - 0.32, a + 0.32
        foot = [
            (0.97 * r * np.cos(t), 0.97 * r * np.sin(t), z)
            for t, z in ((c, h - 0.03), (c, 0.03), (d, 0.03), (d, h - 0.03))
        ]
        b.tube(foot, tube, "galvanised", sides=6)
    if style == "netted":
        for k in range(8):
            a = 2 * np.pi * k / 8 + 0.08
            x, y = np.cos(a), np.sin(a)
            b.tube(
                [
                    (1.02 * r * x, 1.02 * r * y, h - 0.3),
                    (1.02 * r * x, 1.02 * r * y, 1.42),
                    (0.92 * r * x, 0.92 * r * y, 1.5),
                ],
                0.024,
                pad,
                sides=6,
            )
        b.ring(0.92 * r, 0.012, (0, 0, 1.48), "charcoal", segments=28, sides=4)
        # The net is modelled by its cords, so that it is see-through and objects pass.
        for z in np.linspace(h + 0.1, 1.36, 5):
            b.ring(0.93 * r, 0.004, (0, 0, z), "dark grey", segments=28, sides=3)
        for k in range(32):
            a = 2 * np.pi * k / 32
            x, y = 0.93 * r * np.cos(a), 0.93 * r * np.sin(a)
            b.rod((x, y, h), (x, y, 1.48), 0.004, "dark grey", sides=3)
    else:
        b.panel(_star(), (0, 0, h + 0.001), r * 0.7, r * 0.7, "+z")
    size = ((2.9, 2.9, 1.55), (3.6, 3.6, 0.9), (1.0, 1.0, 0.25))[variant]
    return varied(b, rng, size, f"a {style} trampoline", style, jitter=0.002)


def _star() -> Image.Image:
    image, pen = paint.canvas((64, 64), "charcoal")
    points = [
        (32 + r * np.sin(k * np.pi / 5), 32 - r * np.cos(k * np.pi / 5)) for k in range(10) for r in ((28, 11)[k % 2],)
    ]
    pen.polygon(points, fill=rgb("white"))
    return image


def _air_walker(b: MeshBuilder, post: Color) -> None:
    """Two swinging footboards between two posts, a bar to hold on to."""
    for s in (-1, 1):
        b.rod((0, 0.36 * s, 0), (0, 0.36 * s, 1.1), 0.045, post, sides=12)
        b.cylinder(0.1, 0.02, (0, 0.36 * s, 0), "dark grey", segments=14)
        swing = 0.32 * s
        b.beam((0, 0.24 * s, 1.0), (swing, 0.24 * s, 0.16), 0.05, 0.05, "signal yellow")
        b.box((0.42, 0.15, 0.04), (swing + 0.04, 0.22 * s, 0.12), "black", bevel=0.01)
        b.cylinder(0.05, 0.14, (0, 0.31 * s + 0.07, 1.0), "signal yellow", (90, 0, 0), segments=12)
    b.rod((0, -0.36, 1.0), (0, 0.36, 1.0), 0.035, "signal yellow", sides=10)
    bar = [
        (0, -0.36, 1.08),
        (0.24, -0.36, 1.42),
        (0.3, -0.2, 1.46),
        (0.3, 0.2, 1.46),
        (0.24, 0.36, 1.42),
        (0, 0.36, 1.08),
    ]
    b.tube(bar, 0.026, post, sides=8)
    for s in (-1, 1):
        b.rod((0.3, 0.06 * s, 1.46), (0.3, 0.2 * s, 1.46), 0.031, "black", sides=8)
    b.box((1.3, 0.8, 0.012), color="dark concrete")


def _chest_press(b: MeshBuilder, post: Color) -> None:
    """A seat behind a post with two levers and a sign of how to use them."""
    b.rod((0, 0, 0), (0, 0, 1.75), 0.057, post, sides=14)
    b.ball(0.062, (0, 0, 1.75), post, segments=12, rings=6)
    b.cylinder(0.16, 0.02, (0, 0, 0), "dark grey", segments=16)
    b.rod((0, 0, 0.42), (-0.5, 0, 0.42), 0.035, post, sides=10)
    b.box((0.36, 0.38, 0.04), (-0.55, 0, 0.44), "signal yellow", bevel=0.015)
    b.box((0.04, 0.36, 0.4), (-0.34, 0, 0.56), "signal yellow", bevel=0.015, turn_deg=(0, 8, 0))
    b.rod((0, 0, 0.8), (-0.34, 0, 0.76), 0.03, post, sides=8)
    for s in (-1, 1):
        b.tube(
            [(0, 0.06 * s, 1.55), (-0.12, 0.3 * s, 1.5), (-0.2, 0.36 * s, 1.1), (-0.36, 0.36 * s, 0.95)],
            0.026,
            "signal yellow",
            sides=8,
        )
        b.rod((-0.36, 0.36 * s, 0.95), (-0.48, 0.36 * s, 0.9), 0.03, "black", sides=8)
    sign, pen = paint.canvas((48, 60), "white")
    paint.text(pen, "PRESS", (4, 3, 44, 15), "signal blue", 0.03)
    pen.ellipse((20, 18, 28, 26), fill=rgb("signal blue"))
    for stroke in ((24, 26, 24, 42), (24, 42, 36, 42), (36, 42, 36, 56), (24, 30, 38, 30), (18, 24, 18, 44)):
        pen.line(stroke, fill=rgb("signal blue"), width=3)
    b.box((0.02, 0.3, 0.38), (0.06, 0, 1.15), post)
    b.panel(sign, (0.0725, 0, 1.34), 0.27, 0.34)


def _exercise_bicycle(b: MeshBuilder, post: Color) -> None:
    """A flywheel, saddle, pedals and handlebar on two feet."""
    b.beam((-0.5, 0, 0.05), (0.5, 0, 0.05), 0.08, 0.07, post)
    for x in (-0.5, 0.5):
        b.beam((x, -0.28, 0.03), (x, 0.28, 0.03), 0.08, 0.06, "black")
    b.cylinder(0.24, 0.06, (0.34, 0.03, 0.34), "signal red", (90, 0, 0), segments=26)
    b.ring(0.225, 0.022, (0.34, 0, 0.34), "aluminium", (90, 0, 0), segments=24, sides=5)
    b.beam((-0.3, 0, 0.08), (-0.18, 0, 0.8), 0.06, 0.06, post)
    b.beam((0.4, 0, 0.08), (0.24, 0, 1.05), 0.06, 0.06, post)
    b.beam((0.3, 0, 0.3), (-0.2, 0, 0.3), 0.06, 0.08, post)
    b.convex(
        [
            (-0.36, 0.11, 0.84),
            (-0.36, -0.11, 0.84),
            (-0.02, 0.02, 0.84),
            (-0.02, -0.02, 0.84),
            (-0.36, 0.08, 0.9),
            (-0.36, -0.08, 0.9),
            (-0.02, 0, 0.88),
        ],
        "black",
    )
    b.rod((-0.17, 0, 0.78), (-0.2, 0, 0.86), 0.02, "aluminium")
    b.tube(
        [(0.02, -0.2, 1.12), (0.2, -0.2, 1.1), (0.24, 0, 1.06), (0.2, 0.2, 1.1), (0.02, 0.2, 1.12)],
        0.018,
        "black",
        sides=6,
    )
    b.box((0.04, 0.18, 0.12), (0.27, 0, 1.1), "charcoal", bevel=0.01, turn_deg=(0, -20, 0))
    b.cylinder(0.09, 0.02, (0.0, -0.04, 0.3), "aluminium", (90, 0, 0), segments=16)
    for s in (-1, 1):
        b.beam((0.0, 0.07 * s, 0.3), (0.12 * s, 0.09 * s, 0.2 if s > 0 else 0.4), 0.02, 0.03, "aluminium")
        b.box((0.1, 0.09, 0.025), (0.12 * s, 0.14 * s, 0.19 if s > 0 else 0.39), "black", bevel=0.006)


@recipe("fitness equipments", 3, name="sports_things.fitness_equipments")
def fitness_equipments(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Outdoor air walker, outdoor chest press with a seat, exercise bicycle."""
    b = MeshBuilder(roughness=0.5)
    style = ("air walker", "chest press", "exercise bicycle")[variant]
    post: Color = ("signal blue", "green", "charcoal")[variant]
    if style == "air walker":
        _air_walker(b, post)
    elif style == "chest press":
        _chest_press(b, post)
    else:
        _exercise_bicycle(b, post)
    size = ((1.35, 0.8, 1.5), (1.15, 0.8, 1.8), (1.2, 0.56, 1.22))[variant]
    return varied(b, rng, size, f"a fitness machine: {style}", style)


@recipe("hurdle", 2, name="sports_things.hurdle")
def hurdle(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Athletics hurdle with a striped bar on an L foot, low yellow training hurdle; runners come from -x."""
    b = MeshBuilder(roughness=0.45)
    style = ("athletics", "low training")[variant]
    steel: Color = ("aluminium", "signal yellow")[variant]
    for s in (-1, 1):
        y = 0.5 * s
        b.tube(
            [(-0.3, y, 0.025), (0.3, y, 0.025), (0.34, y, 0.04), (0.34, y, 0.75), (0.34, y, 0.95)],
            0.022,
            steel,
            sides=8,
        )
        b.rod((0.34, y, 0.45), (0.34, y, 0.72), 0.028, "charcoal", sides=8)
        b.box((0.14, 0.05, 0.05), (-0.26, y, 0.0), "black", bevel=0.008)
        b.box((0.05, 0.05, 0.03), (0.3, y, 0.0), "black", bevel=0.006)
        for z in (0.55, 0.62):
            b.cylinder(0.008, 0.06, (0.34, y + 0.03, z), "grey", (90, 0, 0), segments=6)
    b.rod((0.34, -0.5, 0.42), (0.34, 0.5, 0.42), 0.018, steel, sides=8)
    b.rod((-0.28, -0.5, 0.03), (-0.28, 0.5, 0.03), 0.016, steel, sides=8)
    stripes = paint.stripes((160, 12), ["white", "black"] if variant == 0 else ["signal yellow", "black"], 8)
    b.box((0.024, 1.19, 0.07), (0.36, 0, 0.92), "white", skins={"+x": stripes, "-x": stripes})
    size = ((0.68, 1.19, 0.99), (0.45, 1.05, 0.5))[variant]
    return varied(b, rng, size, f"an {style} hurdle" if variant == 0 else f"a {style} hurdle", style, jitter=0.003)


@recipe("table-tennis table", 3, name="sports_things.table_tennis_table")
def table_tennis_table(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Blue table on wheeled legs with its net, green concrete table of a park, grey weatherproof one on steel bows."""
    b = MeshBuilder(roughness=0.6)
    style = ("blue indoor", "concrete park", "grey weatherproof")[variant]
    top: Color = ("blue", "dark green", "dark grey")[variant]
    thick = (0.03, 0.09, 0.04)[variant]
    z = 0.76 - thick
    for s in (-1, 1):
        b.box((1.52, 1.36, thick), (0, 0.685 * s, z), ("blue", "dark concrete", "galvanised")[variant], bevel=0.004)
    white: Color = "white"
    b.box((1.5, 2.71, 0.002), (0, 0, 0.76), top)
    for x in (-0.745, 0.745, 0.0):
        b.box((0.02 if x else 0.006, 2.73, 0.003), (x, 0, 0.7605), white)
    for y in (-1.355, 1.355):
        b.box((1.5, 0.02, 0.003), (0, y, 0.7605), white)
    net, pen = paint.canvas((128, 12), "charcoal" if variant == 0 else "galvanised")
    for x in range(2, 128, 4):
        pen.line((x, 2, x, 12), fill=rgb("dark grey") if variant == 0 else rgb("charcoal"))
    pen.rectangle((0, 0, 128, 1), fill=rgb("white"))
    b.box((1.7 if variant == 0 else 1.56, 0.008, 0.152), (0, 0, 0.763), "charcoal", skins={"+y": net, "-y": net})
    for s in (-1, 1):
        b.box((0.03, 0.05, 0.17), (s * (0.83 if variant == 0 else 0.77), 0, 0.75), "black", bevel=0.004)
        if variant == 0:
            b.box((0.08, 0.05, 0.03), (s * 0.8, 0, 0.735), "black")
    if style == "blue indoor":
        _wheeled_legs(b)
    elif style == "grey weatherproof":
        _steel_bows(b)
    else:
        _concrete_legs(b)
    size = ((1.53, 2.74, 0.755), (1.524, 2.745, 0.9), (1.52, 2.73, 0.92))[variant]
    return varied(b, rng, size, f"a {style} table for table tennis", style, jitter=0.0)


def _wheeled_legs(b: MeshBuilder) -> None:
    """Eight legs on wheels."""
    for y in (-1.15, -0.2, 0.2, 1.15):
        for x in (-0.6, 0.6):
            b.box((0.045, 0.045, 0.7), (x, y, 0.04), "charcoal")
            b.cylinder(0.04, 0.03, (x, y + 0.015, 0.04), "black", (90, 0, 0), segments=12)
        b.box((1.2, 0.04, 0.05), (0, y, 0.6), "charcoal")
    for x in (-0.6, 0.6):
        b.box((0.03, 2.3, 0.06), (x, 0, 0.67), "charcoal")


def _steel_bows(b: MeshBuilder) -> None:
    """Two bent tubes with stretchers."""
    for y in (-0.95, 0.95):
        bow = [(-0.62, y, 0.0), (-0.6, y * 0.75, 0.7), (0.6, y * 0.75, 0.7), (0.62, y, 0.0)]
        b.tube(bow, 0.035, "orange", sides=8)
        b.rod((-0.61, y * 0.9, 0.3), (0.61, y * 0.9, 0.3), 0.02, "orange", sides=6)
    b.rod((0, -0.7, 0.69), (0, 0.7, 0.69), 0.03, "charcoal", sides=6)


def _concrete_legs(b: MeshBuilder) -> None:
    """Two blocks."""
    for y in (-0.8, 0.8):
        b.box((1.1, 0.24, 0.68), (0, y, 0), "concrete", bevel=0.02, taper=(1.15, 1.0))
