"""Tall objects along the kerb: street lights, lampposts, traffic lights, utility poles."""

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import rgb
from ...meshes.recipe import Physics, recipe

POLE = Physics(
    ("steel", "aluminium"),
    1400.0,
    (40.0, 260.0),
    0.5,
    False,
    "a 6-9 m tapered steel column weighs 60-200 kg; footed a metre deep",
)


def column(b: MeshBuilder, height: float, bottom: float, top: float, color: str) -> None:
    """A tapered tube with a base plate, an access door and a collar."""
    b.cylinder(bottom * 2.0, 0.03, color="dark grey", segments=14)
    b.cylinder(bottom * 1.35, 0.9, color=color, segments=14)
    b.cylinder(bottom, height, color=color, top_radius=top, segments=14)
    b.box((0.01, bottom * 1.3, 0.36), (bottom * 1.33, 0, 0.4), "dark grey")


def cobra_head(b: MeshBuilder, color: str) -> None:
    """A flat LED head reaching along +x from the origin."""
    sections = []
    for x, w, low, high in (
        (0.0, 0.05, -0.03, 0.03),
        (0.12, 0.12, -0.04, 0.05),
        (0.5, 0.15, -0.045, 0.05),
        (0.68, 0.1, -0.03, 0.01),
    ):
        sections.append(np.array([(x, -w, low), (x, w, low), (x, w * 0.7, high), (x, -w * 0.7, high)]))
    b.loft(sections, color)
    b.box((0.42, 0.22, 0.02), (0.37, 0, -0.058), "lamp")


@recipe("street light", 4, POLE, hulls=3, name="lights.street_light")
def street_light(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Curved single arm, double arm, straight LED arm, mast with a wooden pole; arms reach over the road along +x."""
    b = MeshBuilder(roughness=0.45)
    style = ("curved arm", "double arm", "straight arm", "conical post-top")[variant % 4]
    color = ("galvanised", "light grey", "charcoal", "dark green")[variant % 4]
    h = float(rng.uniform(6.2, 8.4)) if style != "conical post-top" else float(rng.uniform(4.6, 5.2))
    column(b, h, 0.085, 0.045, color)
    if style in ("curved arm", "double arm"):
        reach = float(rng.uniform(1.4, 2.0)) if style == "curved arm" else 1.1
        for side in (1,) if style == "curved arm" else (1, -1):
            with b.frame(scale=(side, 1, 1)):
                t = np.linspace(0, 1, 7)
                arc = [
                    (reach * (1 - np.cos(a * np.pi / 2)) ** 0.8, 0, h + 0.9 * np.sin(a * np.pi / 2) - 0.05) for a in t
                ]
                b.tube(arc, [0.045 - 0.015 * a for a in t], color)
                with b.frame(arc[-1], (0, -4, 0)):
                    cobra_head(b, color)
    elif style == "straight arm":
        b.beam((-0.06, 0, h - 0.1), (1.5, 0, h + 0.05), 0.07, 0.07, color)
        b.box((0.72, 0.3, 0.06), (1.6, 0, h + 0.02), color, bevel=0.02)
        b.box((0.62, 0.24, 0.02), (1.6, 0, h + 0.005), "lamp")
    else:
        b.lathe([(0.05, h), (0.12, h + 0.03), (0.16, h + 0.05)], color=color)
        b.lathe([(0.13, h + 0.05), (0.23, h + 0.42)], color="lamp", segments=18)
        b.lathe([(0.3, h + 0.42), (0.29, h + 0.46), (0.12, h + 0.56), (0, h + 0.6)], color=color, segments=18)
    return b.build(f"a {style} street light {h:.1f} m high", {"style": style})


def lantern(b: MeshBuilder, z: float, color: str, size: float = 1.0) -> None:
    """A four-sided heritage lantern standing on height z."""
    s = size
    b.cylinder(0.05 * s, 0.08 * s, (0, 0, z), color, segments=10)
    with b.frame((0, 0, z + 0.08 * s), (0, 0, 45)):
        b.box((0.2 * s, 0.2 * s, 0.36 * s), color="lamp", taper=(1.6, 1.6))
        for x in (-1, 1):
            for y in (-1, 1):
                low, high = 0.1 * s, 0.16 * s
                b.beam((x * low, y * low, 0), (x * high, y * high, 0.36 * s), 0.02 * s, 0.02 * s, color)
        b.box((0.38 * s, 0.38 * s, 0.03 * s), (0, 0, 0.36 * s), color)
        b.box((0.34 * s, 0.34 * s, 0.16 * s), (0, 0, 0.39 * s), color, taper=(0.25, 0.25))
    b.ball(0.035 * s, (0, 0, z + 0.66 * s), color, segments=8, rings=6)


@recipe("lamppost", 4, POLE, hulls=3, name="lights.lamppost")
def lamppost(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Heritage lantern, globe, twin globes, modern bollard-like column."""
    b = MeshBuilder(roughness=0.45)
    style = ("lantern", "globe", "twin lantern", "modern column")[variant % 4]
    color = ("black", "dark green", "black", "charcoal")[variant % 4]
    h = float(rng.uniform(2.9, 3.5))
    if style != "modern column":
        b.lathe(
            [(0.2, 0), (0.2, 0.1), (0.16, 0.14), (0.14, 0.5), (0.09, 0.6), (0.1, 0.66), (0.065, 0.7)],
            color=color,
            segments=12,
        )
        b.cylinder(0.06, h - 0.65, (0, 0, 0.65), color, top_radius=0.042, segments=12)
        b.ring(0.06, 0.02, (0, 0, h * 0.55), color, segments=14, sides=6)
    if style == "lantern":
        b.beam((0, -0.32, h - 0.25), (0, 0.32, h - 0.25), 0.035, 0.035, color)
        lantern(b, h, color)
    elif style == "globe":
        b.lathe([(0.05, h), (0.1, h + 0.04), (0.09, h + 0.08)], color=color)
        b.ball(0.21, (0, 0, h + 0.26), "lamp", segments=18, rings=12)
        b.cone(0.05, 0.1, (0, 0, h + 0.46), color)
    elif style == "twin lantern":
        for y in (-1, 1):
            arm = [(0, 0, h - 0.35), (0, y * 0.2, h - 0.12), (0, y * 0.42, h - 0.18), (0, y * 0.45, h)]
            b.tube(arm, 0.022, color, sides=6)
            with b.frame((0, y * 0.45, 0)):
                lantern(b, h - 0.02, color, 0.85)
        b.cone(0.045, 0.25, (0, 0, h), "gold")
    else:
        b.cylinder(0.16, 0.03, color="dark grey")
        b.cylinder(0.085, h, color=color, segments=18)
        b.cylinder(0.08, 0.55, (0, 0, h), "lamp", segments=18)
        b.cylinder(0.09, 0.1, (0, 0, h + 0.55), color, segments=18)
    return b.build(f"a {style} lamppost", {"style": style})


def signal_head(b: MeshBuilder, lit: int, body: str, lights: tuple[str, ...] = ("red", "amber", "green")) -> None:
    """Lamps in a box centred on the origin, facing +x; lamp `lit` shines."""
    bright = {"red": "light red", "amber": "amber", "green": "light green"}
    dim = {"red": (70, 16, 16), "amber": (80, 58, 14), "green": (14, 58, 30)}
    n, pitch = len(lights), 0.3
    b.box((0.16, 0.32, pitch * n + 0.05), (0, 0, -(pitch * n + 0.05) / 2), body, bevel=0.02)
    b.box((0.01, 0.5, pitch * n + 0.2), (-0.05, 0, -(pitch * n + 0.2) / 2), "black")
    for k, name in enumerate(lights):
        z = pitch * ((n - 1) / 2 - k)
        b.cylinder(
            0.105, 0.03, (0.075, 0, z), bright[name] if k == lit else dim[name], turn_deg=(0, 90, 0), segments=18
        )
        visor = [(0.13 * np.cos(a), 0.13 * np.sin(a)) for a in np.linspace(-0.5, np.pi + 0.5, 11)]
        grid = np.array([[(x, y, z + v) for y, v in visor] for x in (0.08, 0.26)])
        b.sheet(grid, "black", both_sides=True)


def walker_head(b: MeshBuilder, walk: bool) -> None:
    """A pedestrian signal facing +x, centred on the origin."""
    image, draw = paint.canvas((32, 64), "black")
    for top, color, on in ((2, "light red", not walk), (34, "light green", walk)):
        ink = rgb(color) if on else (46, 46, 46)
        draw.ellipse((13, top, 19, top + 6), fill=ink)
        draw.rectangle((12, top + 7, 20, top + 18), fill=ink)
        legs = (top + 28, 12, 18) if top == 2 else (top + 28, 9, 21)
        draw.line((14, top + 18, legs[1] + 1, legs[0]), fill=ink, width=4)
        draw.line((18, top + 18, legs[2], legs[0]), fill=ink, width=4)
    b.box((0.14, 0.26, 0.5), (0, 0, -0.25), "charcoal", bevel=0.015)
    b.panel(image, (0.073, 0, 0), 0.2, 0.42)


@recipe("traffic light", 4, POLE, hulls=6, name="lights.traffic_light")
def traffic_light(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Post-mounted, mast arm over the road, pedestrian signal, post with two heads."""
    b = MeshBuilder(roughness=0.5)
    style = ("post", "mast arm", "pedestrian", "yellow post")[variant % 4]
    color = ("charcoal", "galvanised", "dark grey", "galvanised")[variant % 4]
    body = "signal yellow" if style == "yellow post" else "black"
    lit = int(rng.integers(3))
    if style == "mast arm":
        column(b, 5.8, 0.11, 0.08, color)
        b.tube([(0, 0, 5.5), (0, 2.2, 5.75), (0, 4.4, 5.85)], [0.075, 0.06, 0.045], color)
        for y in (2.4, 4.1):
            with b.frame((0.14, y, 5.65)):
                signal_head(b, lit, body)
        with b.frame((0.2, 0, 2.9)):
            signal_head(b, lit, body)
    elif style == "pedestrian":
        b.cylinder(0.055, 2.6, color=color, segments=14)
        b.cylinder(0.12, 0.03, color="dark grey", segments=14)
        with b.frame((0.12, 0, 2.35)):
            walker_head(b, bool(lit % 2))
        b.box((0.09, 0.11, 0.18), (0.08, 0, 1.0), "signal yellow", bevel=0.01)
        b.cylinder(0.03, 0.015, (0.125, 0, 1.08), "red", turn_deg=(0, 90, 0), segments=12)
    else:
        h = float(rng.uniform(3.1, 3.5))
        b.cylinder(0.06, h, color=color, segments=14)
        b.cylinder(0.13, 0.03, color="dark grey", segments=14)
        b.ball(0.065, (0, 0, h), color, segments=12, rings=6)
        with b.frame((0.15, 0, h - 0.55)):
            signal_head(b, lit, body)
        with b.frame((0, 0.14, 2.0), (0, 0, 90)):
            walker_head(b, lit == 0)
        b.box((0.09, 0.11, 0.18), (0.08, 0, 1.0), "signal yellow", bevel=0.01)
    return b.build(f"a {style} traffic light showing {('red', 'amber', 'green')[lit]}", {"style": style, "lit": lit})


TIMBER = Physics(
    ("wood", "concrete"),
    700.0,
    (180.0, 900.0),
    0.6,
    False,
    "pine poles of 8-10 m weigh 200-400 kg, concrete ones twice that; set 1.5 m deep",
)


@recipe("utility pole", 3, TIMBER, hulls=4, name="lights.utility_pole")
def utility_pole(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Wooden pole with crossarm, with transformer, and a concrete pole; crossarms lie along y."""
    b = MeshBuilder(roughness=0.9)
    style = ("wooden", "transformer", "concrete")[variant % 3]
    color = "dark concrete" if style == "concrete" else ("bark", "brown")[variant % 2]
    h = float(rng.uniform(8.0, 9.5))
    b.cylinder(0.16, h, color=color, top_radius=0.11, segments=14)
    arms = (h - 0.4,) if style != "concrete" else (h - 0.3, h - 1.0)
    for z in arms:
        b.box((0.1, 2.2, 0.12), (0.14, 0, z), "grey wood" if style != "concrete" else "dark grey")
        for y in (-1.0, -0.55, 0.55, 1.0):
            b.lathe(
                [(0.03, 0), (0.055, 0.05), (0.035, 0.08), (0.05, 0.13), (0, 0.17)],
                (0.14, y, z + 0.12),
                "brown",
                segments=8,
            )
        for y in (-0.7, 0.7):
            b.beam((0.12, 0, z - 0.6), (0.12, y, z), 0.04, 0.02, "galvanised")
    if style == "transformer":
        b.cylinder(0.28, 0.8, (0.45, 0, h - 2.3), "light grey", segments=18)
        b.cylinder(0.3, 0.04, (0.45, 0, h - 1.5), "grey", segments=18)
        b.box((0.3, 0.12, 0.1), (0.2, 0, h - 2.0), "dark grey")
        for y in (-0.12, 0.12):
            b.cylinder(0.03, 0.2, (0.45, y, h - 1.47), "brown", segments=8)
    for k in range(6):
        side = 1 if k % 2 else -1
        b.rod((0, side * 0.12, 2.6 + 0.5 * k), (0, side * 0.28, 2.6 + 0.5 * k), 0.012, "galvanised", sides=5)
    b.box((0.02, 0.12, 0.2), (0.15, 0, 1.9), "signal yellow")
    b.rod((0, 0.14, 0.0), (0, 0.12, 3.0), 0.025, "dark grey", sides=6)
    return b.build(f"a {style} utility pole {h:.1f} m high", {"style": style})
