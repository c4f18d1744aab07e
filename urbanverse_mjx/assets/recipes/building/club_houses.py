"""Fitness, sports and community centres."""

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, rgb, shade
from ...meshes.recipe import recipe
from ..nature.foliage import leafy, small_leaves
from ..shared.sizes import fitted_as, size_of
from . import masonry as m
from .civic_halls import wing
from .shops import icons
from .shops.icons import ICONS, Ink


def mural(kinds: tuple[str, ...], back: Color, ink: Color, size: tuple[int, int]) -> np.ndarray:
    """Pictograms in a row on one colour."""
    w, h = paint.smooth(size, 3)
    image, pen = paint.canvas((w, h), back)
    step = w / len(kinds)
    side = 0.8 * min(step, h)
    for k, kind in enumerate(kinds):
        ICONS[kind](Ink(pen, (k + 0.5) * step - side / 2, (h - side) / 2, side), ink)
    return np.asarray(paint.shrunk(image, size))


@recipe("fitness center", 3, hulls=6, name="club_houses.fitness_center")
def fitness_center(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A glazed hall with people training behind the panes and a giant dumb-bell on its roof."""
    size, b = size_of("fitness center", variant), MeshBuilder(roughness=0.5)
    x, y, z = size
    body, accent = (("charcoal", "lime"), ("#c9ced0", "signal red"), ("dark blue", "orange"))[variant]
    high = 0.78 * z
    b.box((0.88 * x, y, high), (-0.05 * x, 0, 0), body)
    w, h = paint.smooth((190, 46), 3)
    image, pen = paint.canvas((w, h), "#cfe0e6")
    pen.rectangle((0, 0.8 * h, w, h), fill=rgb("dark grey"))
    for k in range(9):  # runners on their machines
        px, color = (k + 0.5) * w / 9, ("signal red", "signal blue", "lime", "orange")[k % 4]
        pen.ellipse(
            (px - 0.06 * h, 0.16 * h, px + 0.06 * h, 0.3 * h),
            fill=rgb(("skin light", "skin dark", "skin medium")[k % 3]),
        )
        pen.line((px, 0.3 * h, px - 6, 0.55 * h), fill=rgb(color), width=22)
        pen.line((px - 4, 0.54 * h, px + 20, 0.66 * h, px + 10, 0.82 * h), fill=rgb("charcoal"), width=12)
        pen.line((px - 6, 0.54 * h, px - 16, 0.68 * h, px - 36, 0.7 * h), fill=rgb("charcoal"), width=12)
        pen.line((px, 0.36 * h, px + 22, 0.46 * h), fill=rgb("skin light"), width=9)
        pen.line((px - 40, 0.84 * h, px + 40, 0.84 * h, px + 52, 0.44 * h), fill=rgb("black"), width=8)
    for k in range(10):
        pen.line((w * k / 9, 0, w * k / 9, h), fill=rgb("aluminium"), width=6)
    glass = paint.shrunk(image, (190, 46))
    front = 0.39 * x
    b.panel(glass, (front + 0.03, 0, 0.24 * z), 0.96 * y, 0.4 * z)
    b.box((0.06 * x, 1.0 * y, 0.03 * z), (front + 0.03 * x, 0, 0.45 * z), accent)
    m.board(
        b,
        ("FITNESS CENTER", "GYM 24/7", "IRON GYM")[variant],
        (front, -0.1 * y, 0.51 * z),
        0.6 * y,
        0.22 * z,
        body,
        accent,
    )
    b.panel(
        icons.drawn("dumbbell", 48, accent, shade(body, 1.2)), (front + 0.05, 0.36 * y, 0.62 * z), 0.24 * z, 0.24 * z
    )
    m.gate(b, (front + 0.05, 0.3 * y, 0), 0.1 * y, 0.36 * z, "charcoal")
    at, r = 0.86 * z, 0.09 * z
    b.rod((0.2 * x, -0.28 * y, at), (0.2 * x, 0.28 * y, at), 0.02 * z, "aluminium", 8)
    for s in (-1, 1):
        for k, share in enumerate((1.5, 1.2, 0.8)):
            b.cylinder(
                r * share,
                0.022 * y,
                (0.2 * x, s * (0.2 + 0.03 * k) * y + 0.011 * y, at),
                accent if k % 2 else "black",
                (90, 0, 0),
                segments=16,
            )
        b.box((0.1 * x, 0.04 * y, at - high), (0.2 * x, s * 0.1 * y, high), "dark grey")
    names = ("dark fitness centre with a dumb-bell", "grey gym with a dumb-bell", "blue gym with a dumb-bell")
    return fitted_as(b.build(names[variant]), "fitness center", size)


@recipe("sports center", 3, hulls=6, name="club_houses.sports_center")
def sports_center(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A great hall under an arched, a flat or a pitched roof, with sports painted on its front."""
    size, b = size_of("sports center", variant), MeshBuilder(roughness=0.7)
    x, y, z = size
    body, accent = (("#e4e6e4", "signal blue"), ("#b56a50", "dark green"), ("#d0d6da", "signal red"))[variant]
    low = 0.56 * z
    ribs = np.asarray(paint.stripes((160, 30), [body, shade(body, 0.93)], 60))
    b.box((0.8 * x, 0.98 * y, low), (-0.08 * x, 0, 0), body, skins=dict.fromkeys(("+x", "-x", "+y", "-y"), ribs))
    if variant == 0:
        arc = [(0.42 * x * np.cos(t) - 0.08 * x, low + 0.44 * z * np.sin(t)) for t in np.linspace(0, np.pi, 11)]
        b.profile(arc, y, color=accent)
        for k in range(7):
            b.tube([(px, (k / 6 - 0.5) * 0.99 * y, pz) for px, pz in arc], 0.01 * z, "white", 4)
    elif variant == 1:
        with b.frame((-0.08 * x, 0, low)):
            b.profile([(-0.43 * x, 0), (0.43 * x, 0), (0, 0.44 * z)], 1.01 * y, color="#5f5a58")
    else:
        for k in range(3):
            b.box(
                (0.8 * x, 0.32 * y, 0.3 * z), (-0.08 * x, (k - 1) * 0.327 * y, low), ("#b8c2c8", accent, "#b8c2c8")[k]
            )
            b.box((0.81 * x, 0.33 * y, 0.02 * z), (-0.08 * x, (k - 1) * 0.327 * y, low + 0.3 * z), "white")
    front = 0.32 * x
    b.panel(
        mural(("ball", "dumbbell", "bike"), accent, "white", (150, 44)),
        (front + 0.04, -0.22 * y, 0.34 * z),
        0.44 * y,
        0.32 * z,
    )
    m.board(b, "SPORTS CENTER", (front, 0.2 * y, 0.36 * z), 0.4 * y, 0.14 * z, accent, "white")
    b.box((0.16 * x, 0.34 * y, 0.3 * z), (0.38 * x, 0.2 * y, 0), "light blue")
    b.box((0.18 * x, 0.38 * y, 0.03 * z), (0.39 * x, 0.2 * y, 0.3 * z), accent)
    m.gate(b, (0.462 * x, 0.2 * y, 0), 0.12 * y, 0.26 * z, "aluminium")
    b.ball(0.12 * z, (0.42 * x, -0.3 * y, 0.12 * z), "orange", segments=14, rings=8)
    for turn in (0, 90):
        b.ring(0.121 * z, 0.005 * z, (0.42 * x, -0.3 * y, 0.12 * z), "black", (90, 0, turn), segments=20, sides=4)
    names = ("sports hall with a blue arched roof", "brick sports hall", "sports centre of three halls")
    return fitted_as(b.build(names[variant]), "sports center", size)


@recipe("community center", 3, hulls=8, name="club_houses.community_center")
def community_center(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A hall with a gabled porch, notice boards, benches and a painted wall of people holding hands."""
    size, b = size_of("community center", variant), MeshBuilder(roughness=0.85)
    x, y, z = size
    wall: m.Wall = (("plaster", "#e8d9b5"), ("brick", "#9c5b45"), ("boards", "#8fa5a0"))[variant]
    accent: Color = ("orange", "dark green", "signal blue")[variant]
    high = 0.62 * z
    wing(
        b,
        (0.74 * x, 0.96 * y, high),
        (-0.1 * x, 0, 0),
        wall,
        2 if variant != 2 else 1,
        ("grid", "white"),
        rng,
        3.2,
        (0.5, 0.5),
    )
    if variant == 2:
        b.box((0.8 * x, y, 0.06 * z), (-0.1 * x, 0, high), accent)
    else:
        m.hip_roof(b, (0.8 * x, 1.0 * y, 0.36 * z), (-0.1 * x, 0, high), ("#8a4a34", "#4d5560")[variant], 0.7)
    front = 0.27 * x
    b.box((0.18 * x, 0.34 * y, 0.5 * z), (front + 0.07 * x, 0, 0), "off white")
    m.pediment(b, front + 0.17 * x, 0.3 * x, 0.4 * y, 0.5 * z, 0.22 * z, accent)
    m.gate(b, (front + 0.16 * x, 0, 0), 0.12 * y, 0.32 * z, "teal")
    m.board(b, "COMMUNITY CENTER", (front + 0.165 * x, 0, 0.36 * z), 0.33 * y, 0.13 * z, accent, "white")
    w, h = paint.smooth((120, 44), 3)
    image, pen = paint.canvas((w, h), "light blue")
    pen.rectangle((0, 0.8 * h, w, h), fill=rgb("grass"))
    for k in range(7):
        px, color = (k + 0.5) * w / 7, ("red", "yellow", "purple", "orange", "teal", "pink", "blue")[k]
        pen.ellipse(
            (px - 12, 0.2 * h, px + 12, 0.2 * h + 26), fill=rgb(("skin light", "skin dark", "skin medium")[k % 3])
        )
        pen.polygon([(px, 0.4 * h), (px + 22, 0.88 * h), (px - 22, 0.88 * h)], fill=rgb(color))
        pen.line((px - w / 14, 0.62 * h, px, 0.48 * h, px + w / 14, 0.62 * h), fill=rgb(color), width=9)
    b.panel(paint.shrunk(image, (120, 44)), (front + 0.03, -0.34 * y, 0.3 * z), 0.26 * y, 0.34 * z)
    for k in range(2):
        at = (0.4 * x, (0.26 + 0.12 * k) * y, 0.0)
        b.box((0.05, 0.09 * y, 0.16 * z), (at[0], at[1], 0.14 * z), "white")
        b.box((0.08, 0.1 * y, 0.18 * z), (at[0] - 0.05, at[1], 0.13 * z), "wood")
        b.box((0.1, 0.1, 0.14 * z), at, "wood")
        b.box((0.4, 0.1 * y, 0.07 * z), (at[0] + 0.8, at[1], 0), "wood")
    leaves = small_leaves("leaf", rng)
    for s in (-0.46, 0.2, 0.46):
        leafy(b, (front + 0.05 * x, s * y, 0.08 * z), (0.05 * x, 0.05 * x, 0.1 * z), leaves, rng, 8, 5)
    names = ("cream community centre with a porch", "brick community centre", "wooden community centre")
    return fitted_as(b.build(names[variant]), "community center", size)
