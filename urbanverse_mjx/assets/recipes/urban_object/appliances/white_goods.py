"""Large household machines: refrigerators, washing machines, cookers, coolers. Their doors look along +x."""

import numpy as np
from PIL import Image, ImageDraw

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, rgb, shade
from ....meshes.recipe import recipe
from ...shared.outlines import ellipse, level
from ...shared.sizes import varied


def bar_handle(b: MeshBuilder, x: float, start: tuple[float, float], end: tuple[float, float], color: Color) -> None:
    """A round bar in front of a door at `x`, from (y, z) to (y, z), on two short stays."""
    a, c = np.array([x + 0.035, *start]), np.array([x + 0.035, *end])
    b.rod(a, c, 0.011, color, sides=8)
    for p in (a + 0.1 * (c - a), c - 0.1 * (c - a)):
        b.rod(p - [0.04, 0, 0], p, 0.008, color, sides=6)


def knobs(b: MeshBuilder, x: float, ys: list[float], z: float, radius: float, color: Color) -> None:
    """Turning knobs on a front at `x`, with a white mark each."""
    for y in ys:
        b.cylinder(radius, 0.022, (x, y, z), color, (0, 90, 0), top_radius=radius * 0.8, segments=12)
        b.box((0.003, 0.004, radius), (x + 0.0225, y, z), "white")


@recipe("refrigerator", 3, hulls=1, name="white_goods.refrigerator")
def refrigerator(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """White fridge-freezer, steel American doors with a dispenser, round-shouldered red one."""
    b = MeshBuilder(roughness=0.35)
    style = ("fridge-freezer", "American", "round-shouldered")[variant]
    if style == "fridge-freezer":
        b.box((0.54, 0.6, 1.6), (-0.03, 0, 0.05), "off white", bevel=0.01)
        b.box((0.5, 0.56, 0.05), (-0.03, 0, 0), "charcoal")
        for z, h in ((0.06, 0.58), (0.655, 0.99)):
            b.box((0.06, 0.6, h), (0.275, 0, z), "white", bevel=0.014)
        bar_handle(b, 0.3, (0.24, 0.34), (0.24, 0.6), "light grey")
        bar_handle(b, 0.3, (0.24, 0.7), (0.24, 1.1), "light grey")
        b.box((0.004, 0.09, 0.018), (0.306, -0.18, 1.55), "dark blue")
    elif style == "American":
        b.box((0.6, 0.9, 1.74), (-0.03, 0, 0.04), "dark grey", bevel=0.01)
        b.box((0.55, 0.84, 0.04), (-0.03, 0, 0), "black")
        for y, w in ((-0.255, 0.38), (0.195, 0.5)):
            b.box((0.07, w, 1.72), (0.31, y, 0.05), "aluminium", bevel=0.016)
        for y in (-0.105, -0.02):
            bar_handle(b, 0.345, (y, 0.55), (y, 1.45), "galvanised")
        b.box((0.008, 0.24, 0.4), (0.346, -0.26, 0.95), "black", bevel=0.003)
        b.box((0.01, 0.18, 0.22), (0.348, -0.26, 0.97), "dark glass")
        b.box((0.02, 0.05, 0.05), (0.35, -0.26, 1.15), "light grey")
        b.box((0.004, 0.12, 0.05), (0.35, -0.26, 1.27), "light blue")
    else:
        steps = np.radians(np.linspace(0, 90, 6))
        side = [(0.3 - 0.1 + 0.1 * np.sin(a), 1.36 + 0.12 * np.cos(a)) for a in steps]
        rim = [(-0.26, 0.06), (0.24, 0.06)]
        b.profile([*rim, (0.24, 1.44), (0.2, 1.48), (-0.26, 1.48)], 0.64, color="dark red")
        b.profile([(0.25, 0.08), (0.3, 0.1), *reversed(side), (0.2, 1.44)], 0.66, color="red")
        bar_handle(b, 0.29, (0.25, 0.95), (0.25, 1.15), "aluminium")
        b.box((0.01, 0.3, 0.05), (0.298, -0.08, 1.28), "aluminium", bevel=0.004)
        for x in (-0.2, 0.2):
            for y in (-0.26, 0.26):
                b.cylinder(0.025, 0.07, (x, y, 0), "aluminium", top_radius=0.035, segments=10)
    size = ((0.63, 0.64, 1.65), (0.74, 0.92, 1.78), (0.66, 0.68, 1.42))[variant]
    return varied(b, rng, size, f"a {style} refrigerator", style)


def porthole(b: MeshBuilder, x: float, z: float, radius: float, rim: Color) -> None:
    """The round door of a washing machine, hinged at the left."""
    b.cylinder(radius, 0.02, (x, 0, z), shade(rim, 0.9), (0, 90, 0), segments=24)
    b.ring(radius * 0.84, radius * 0.14, (x + 0.025, 0, z), rim, (0, 90, 0), segments=24, sides=6)
    b.ball((0.05, radius * 0.72, radius * 0.72), (x + 0.01, 0, z), "dark glass", segments=16, rings=8)
    b.box((0.03, 0.03, 0.09), (x + 0.03, radius * 0.86, z - 0.045), "dark grey", bevel=0.006)


@recipe("washing machine", 3, hulls=1, name="white_goods.washing_machine")
def washing_machine(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """White front loader, top loader with a console, dark front loader with a large door."""
    b = MeshBuilder(roughness=0.4)
    style = ("front-loading", "top-loading", "dark front-loading")[variant]
    body, panel = (("white", "off white"), ("white", "light grey"), ("charcoal", "black"))[variant]
    if style == "top-loading":
        b.box((0.58, 0.66, 0.86), (0, 0, 0.04), body, bevel=0.012)
        b.box((0.5, 0.6, 0.04), color="charcoal")
        b.box((0.42, 0.54, 0.02), (0.04, 0, 0.9), "light grey", bevel=0.008)
        b.box((0.34, 0.44, 0.008), (0.05, 0, 0.92), "dark glass", bevel=0.003)
        b.profile([(-0.29, 0.9), (-0.15, 0.9), (-0.2, 1.08), (-0.29, 1.08)], 0.66, color=panel)
        with b.frame((-0.172, 0, 0.985), (0, -15, 0)):
            knobs(b, 0, [-0.22, -0.08, 0.2], 0.0, 0.035, "charcoal")
            b.box((0.004, 0.12, 0.05), (0.002, 0.06, -0.025), "dark glass")
    else:
        b.box((0.55, 0.6, 0.8), (-0.02, 0, 0.05), body, bevel=0.012)
        b.box((0.5, 0.56, 0.05), color="charcoal")
        b.box((0.012, 0.59, 0.115), (0.255, 0, 0.725), panel, bevel=0.004)
        b.box((0.016, 0.19, 0.085), (0.256, -0.19, 0.74), shade(body, 0.94), bevel=0.004)
        knobs(b, 0.26, [0.0], 0.78, 0.035, "light grey")
        b.box((0.006, 0.13, 0.045), (0.26, 0.14, 0.76), "dark glass")
        b.box((0.006, 0.03, 0.02), (0.26, 0.25, 0.772), "light green" if variant else "grey")
        porthole(b, 0.255, 0.41, 0.2 if variant == 0 else 0.235, "light grey" if variant == 0 else "galvanised")
        b.box((0.006, 0.14, 0.09), (0.254, 0.2, 0.08), shade(body, 0.92))
    size = ((0.58, 0.6, 0.85), (0.62, 0.67, 1.05), (0.64, 0.66, 0.9))[variant]
    return varied(b, rng, size, f"a {style} washing machine", style)


@recipe("dishwasher", 2, hulls=1, name="white_goods.dishwasher")
def dishwasher(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Steel machine with its door ajar on the crockery, compact white one for a worktop."""
    b = MeshBuilder(roughness=0.35)
    style = ("ajar steel", "worktop")[variant]
    color: Color = ("aluminium", "white")[variant]
    b.box((0.5, 0.6, 0.1), (-0.05, 0, 0), "charcoal")
    for y in (-0.29, 0.29):
        b.box((0.5, 0.02, 0.74), (-0.05, y, 0.1), "light grey")
    b.box((0.02, 0.58, 0.74), (-0.29, 0, 0.1), "grey")
    b.box((0.52, 0.6, 0.04), (-0.05, 0, 0.81), "light grey" if variant else "dark grey", bevel=0.006)
    _crockery(b)
    with b.frame((0.2, 0, 0.1), (0, 17, 0)):
        b.box((0.035, 0.595, 0.7), (0, 0, 0), color, bevel=0.008)
        b.box((0.006, 0.59, 0.09), (0.018, 0, 0.6), "charcoal" if variant == 0 else "light grey")
        b.box((0.004, 0.08, 0.035), (0.021, 0.2, 0.63), "dark glass")
        for k in range(5):
            b.cylinder(0.009, 0.006, (0.019, -0.22 + 0.05 * k, 0.645), "aluminium", (0, 90, 0), segments=8)
        bar_handle(b, 0.02, (-0.2, 0.55), (0.2, 0.55), "galvanised")
    size = ((0.575, 0.6, 0.845), (0.55, 0.56, 0.5))[variant]
    return varied(b, rng, size, f"a {style} dishwasher", style)


def _crockery(b: MeshBuilder) -> None:
    """Plates on edge in the upper rack, seen over the open door."""
    b.box((0.42, 0.54, 0.012), (-0.05, 0, 0.5), "grey")
    for k in range(8):
        ink = ("white", "light blue", "white", "cream")[k % 4]
        b.cylinder(0.11, 0.012, (-0.02, -0.23 + 0.065 * k, 0.63), ink, (90, 12, 0), segments=12)


@recipe("oven", 3, hulls=1, name="white_goods.oven")
def oven(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """White cooker with four hotplates, built-in steel oven, wide range with gas burners."""
    b = MeshBuilder(roughness=0.4)
    style = ("electric cooker", "built-in oven", "gas range")[variant]
    body = ("white", "aluminium", "dark red")[variant]
    width, height = ((0.6, 0.78), (0.6, 0.6), (0.9, 0.84))[variant]
    b.box((0.54, width, height - 0.06), (-0.02, 0, 0.06), body, bevel=0.006)
    b.box((0.5, width - 0.04, 0.06), (-0.03, 0, 0), "charcoal")
    doors = [0.0] if variant < 2 else [-width / 4, width / 4]
    door = width / len(doors) - 0.03
    top = height - 0.14
    for y in doors:
        b.box((0.03, door, top - 0.16), (0.26, y, 0.14), shade(body, 0.95) if variant != 1 else "charcoal", bevel=0.006)
        b.box((0.004, door * 0.72, (top - 0.16) * 0.5), (0.275, y, 0.2), "dark glass")
        bar_handle(b, 0.275, (y - door * 0.4, top - 0.05), (y + door * 0.4, top - 0.05), "galvanised")
    knobs(b, 0.25, list(np.linspace(-0.42, 0.42, 6) * width), height - 0.065, 0.022, "charcoal")
    b.box((0.006, 0.1, 0.04), (0.252, 0, height - 0.085), "dark glass")
    if variant != 1:
        b.box((0.56, width, 0.025), (-0.01, 0, height), "charcoal" if variant else "light grey", bevel=0.006)
        spots = [(x, y) for x in (-0.14, 0.12) for y in (-0.27 * width, 0.27 * width)]
        for k, (x, y) in enumerate(spots + ([(0.0, 0.0)] if variant == 2 else [])):
            r = (0.095, 0.075)[k % 2]
            b.cylinder(r, 0.012, (x, y, height + 0.024), "black", segments=16)
            if variant == 2:
                for turn in (0, 90):
                    b.box((2.4 * r, 0.012, 0.02), (x, y, height + 0.03), "cast iron", (0, 0, turn))
            else:
                b.ring(r * 0.5, 0.004, (x, y, height + 0.036), "grey", segments=16, sides=4)
    size = ((0.6, 0.6, 0.82), (0.58, 0.6, 0.6), (0.66, 0.9, 0.92))[variant]
    return varied(b, rng, size, f"a {style}", style)


def _keypad(size: tuple[int, int], color: Color, clock: str) -> Image.Image:
    image, draw = paint.canvas(size, color)
    draw.rectangle((4, 5, size[0] - 5, 20), fill=(12, 16, 14))
    paint.text(draw, clock, (5, 6, size[0] - 6, 19), "light green")
    for k in range(12):
        x, y = 5 + 11 * (k % 3), 27 + 10 * (k // 3)
        draw.rectangle((x, y, x + 8, y + 7), fill=rgb(shade(color, 1.9)))
    draw.rectangle((5, 70, 22, 78), fill=rgb("red"))
    draw.rectangle((25, 70, 36, 78), fill=rgb("green"))
    return image


@recipe("microwave", 3, hulls=1, name="white_goods.microwave")
def microwave(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """White with keypad, steel with a bar handle, retro with two dials."""
    b = MeshBuilder(roughness=0.35)
    style = ("white", "steel", "retro")[variant]
    body: Color = ("white", "aluminium", "teal")[variant]
    b.box((0.36, 0.49, 0.27), (-0.01, 0, 0.012), body, bevel=0.012)
    for x in (-0.14, 0.13):
        for y in (-0.2, 0.2):
            b.cylinder(0.014, 0.014, (x, y, 0), "black", segments=8)
    b.box((0.022, 0.37, 0.255), (0.178, -0.055, 0.02), shade(body, 0.96), bevel=0.006)
    window, pen = paint.canvas((64, 44), (26, 28, 32))
    for x in range(2, 64, 4):
        for y in range(2, 44, 4):
            pen.point((x, y), (70, 74, 80))
    pen.ellipse((12, 28, 52, 40), outline=(86, 92, 100))
    b.panel(window, (0.1905, -0.07, 0.147), 0.27, 0.19)
    if style == "retro":
        knobs(b, 0.17, [0.19], 0.2, 0.032, "cream")
        knobs(b, 0.17, [0.19], 0.1, 0.032, "cream")
        bar_handle(b, 0.186, (0.105, 0.06), (0.105, 0.23), "aluminium")
    else:
        b.panel(_keypad((42, 84), "charcoal", "12:30"), (0.1715, 0.187, 0.147), 0.105, 0.235)
        b.box((0.01, 0.1, 0.24), (0.1655, 0.187, 0.027), "charcoal")
        if style == "steel":
            bar_handle(b, 0.186, (0.11, 0.06), (0.11, 0.23), "galvanised")
        else:
            b.box((0.03, 0.022, 0.2), (0.19, 0.11, 0.05), "light grey", bevel=0.008)
    size = ((0.38, 0.49, 0.285), (0.44, 0.55, 0.32), (0.35, 0.45, 0.26))[variant]
    return varied(b, rng, size, f"a {style} microwave oven", style)


@recipe("water cooler", 3, hulls=1, name="white_goods.water_cooler")
def water_cooler(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Dispenser with its bottle upside down on top (white; steel and black), black one without a bottle."""
    b = MeshBuilder(roughness=0.3)
    style = ("bottled", "plumbed", "steel bottled")[variant]
    body: Color = ("white", "charcoal", "aluminium")[variant]
    b.box((0.32, 0.31, 0.9), color=body, bevel=0.02)
    b.box((0.012, 0.25, 0.26), (0.156, 0, 0.56), "dark grey" if variant != 1 else "black", bevel=0.003)
    for y, ink in ((-0.06, "blue"), (0.06, "signal red")):
        b.box((0.07, 0.03, 0.03), (0.19, y, 0.765), "off white", bevel=0.008)
        b.cylinder(0.012, 0.04, (0.215, y, 0.73), "off white", segments=8)
        b.box((0.03, 0.034, 0.02), (0.2, y, 0.794), ink, bevel=0.005)
    b.box((0.08, 0.22, 0.03), (0.19, 0, 0.55), "black", bevel=0.006)
    b.box((0.004, 0.24, 0.36), (0.161, 0, 0.08), shade(body, 0.93))
    if style == "plumbed":
        b.box((0.006, 0.16, 0.05), (0.16, 0, 0.835), "light blue")
        b.box((0.3, 0.29, 0.02), (0, 0, 0.9), "dark grey", bevel=0.006)
    else:
        b.cylinder(0.13, 0.03, (0, 0, 0.89), shade(body, 0.85), segments=18)
        shape = [(0.03, 0.0), (0.04, 0.03), (0.12, 0.09), (0.135, 0.13), (0.128, 0.2), (0.135, 0.22), (0.128, 0.29)]
        b.lathe(
            [*shape, (0.135, 0.31), (0.13, 0.37), (0.11, 0.39), (0.0, 0.39)], (0, 0, 0.9), "light blue", segments=20
        )
    size = ((0.335, 0.32, 1.15), (0.35, 0.32, 1.02), (0.38, 0.33, 1.36))[variant]
    return varied(b, rng, size, f"a {style} water cooler", style)


def _ice(size: tuple[int, int], rng: np.random.Generator) -> Image.Image:
    image, draw = paint.canvas(size, (96, 140, 168))
    for _ in range(70):
        x, y, s = int(rng.integers(size[0])), int(rng.integers(size[1])), int(rng.integers(6, 11))
        ink = shade("white", float(rng.uniform(0.82, 1.05)))
        draw.polygon(
            [(x, y), (x + s, y + 2), (x + s - 2, y + s), (x - 2, y + s - 2)], fill=ink, outline=(140, 180, 204)
        )
    return image


def _snowflake(draw: ImageDraw.ImageDraw, centre: tuple[float, float], radius: float, ink: Color) -> None:
    for k in range(6):
        tip = ellipse(radius, radius, 6, centre)[k]
        draw.line((*centre, *tip), fill=rgb(ink), width=2)
        mid = ellipse(radius * 0.6, radius * 0.6, 6, centre)[k]
        for end in ellipse(radius * 0.35, radius * 0.35, 6, mid)[k - 1 : k + 2 : 2]:
            draw.line((*mid, *end), fill=rgb(ink), width=1)


@recipe("ice maker", 2, hulls=1, name="white_goods.ice_maker")
def ice_maker(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Steel bar machine with a window on its ice; tall head on a bin with a slanting door."""
    b = MeshBuilder(roughness=0.3)
    style = ("bar", "bin")[variant]
    badge, pen = paint.canvas((72, 28), "blue")
    _snowflake(pen, (14, 14), 11, "white")
    paint.text(pen, "ICE", (30, 4, 68, 24), "white", 0.05)
    if style == "bar":
        b.box((0.42, 0.4, 0.57), (0, 0, 0.05), "aluminium", bevel=0.008)
        b.panel(_ice((64, 40), rng), (0.216, 0, 0.44), 0.32, 0.17)
        b.box((0.016, 0.35, 0.2), (0.206, 0, 0.34), "dark grey")
        b.box((0.03, 0.2, 0.025), (0.21, 0, 0.31), "charcoal", bevel=0.006)
        for k in range(7):
            b.box((0.006, 0.3, 0.008), (0.211, 0, 0.1 + 0.018 * k), "charcoal")
        b.panel(badge, (0.2125, 0, 0.58), 0.18, 0.06)
        feet = 0.17
    else:
        b.profile([(-0.38, 0.12), (0.3, 0.12), (0.38, 0.5), (0.18, 0.98), (-0.38, 0.98)], 0.72, color="aluminium")
        b.box((0.56, 0.72, 0.68), (-0.1, 0, 0.99), "light grey", bevel=0.01)
        with b.frame((0.285, 0, 0.73), (0, -22.6, 0)):
            b.box((0.03, 0.6, 0.44), (0, 0, -0.22), "light grey", bevel=0.008)
            b.box((0.03, 0.3, 0.03), (0.03, 0, -0.17), "charcoal", bevel=0.006)
            b.panel(_ice((64, 34), rng), (0.017, 0, 0.05), 0.46, 0.24)
        b.panel(badge, (0.182, 0, 1.5), 0.36, 0.14)
        for k in range(8):
            b.box((0.006, 0.5, 0.012), (0.182, 0, 1.08 + 0.03 * k), "charcoal")
        feet = 0.3
    for x in (-feet, feet * 0.8):
        for y in (-feet * 0.9, feet * 0.9):
            b.cylinder(0.02, 0.13, (x, y, 0), "dark grey", segments=8)
    size = ((0.46, 0.4, 0.62), (0.78, 0.73, 1.7))[variant]
    return varied(b, rng, size, f"a {style} ice maker", style)


@recipe("rice cooker", 2, hulls=1, name="white_goods.rice_cooker")
def rice_cooker(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Domed pot with a glass lid and one lever; rounded box with a keypad and a carrying handle."""
    b = MeshBuilder(roughness=0.4)
    style = ("glass-lidded", "domed")[variant]
    if style == "glass-lidded":
        b.lathe([(0.1, 0.0), (0.125, 0.02), (0.13, 0.15), (0.122, 0.165)], color="white", segments=22)
        b.lathe([(0.12, 0.165), (0.115, 0.18), (0.06, 0.205), (0.0, 0.21)], color="glass", segments=22)
        b.ring(0.12, 0.006, (0, 0, 0.167), "aluminium", segments=22, sides=5)
        b.cylinder(0.018, 0.028, (0, 0, 0.205), "black", top_radius=0.024, segments=12)
        for side in (-1, 1):
            b.box((0.06, 0.03, 0.02), (0, side * 0.14, 0.11), "black", bevel=0.006)
        b.box((0.012, 0.07, 0.09), (0.126, 0, 0.02), "off white", bevel=0.004)
        b.box((0.02, 0.035, 0.015), (0.136, 0, 0.03), "black")
        b.cylinder(0.007, 0.008, (0.13, -0.012, 0.085), "signal red", (0, 90, 0), segments=8)
        b.cylinder(0.007, 0.008, (0.13, 0.012, 0.085), "amber", (0, 90, 0), segments=8)
    else:
        rows = ((0.0, 0.13, 0.11), (0.02, 0.15, 0.125), (0.14, 0.155, 0.13), (0.2, 0.13, 0.11), (0.225, 0.06, 0.06))
        b.loft([level(z, x, y, power=3.0, count=20) for z, x, y in rows], "dark red")
        b.loft(
            [level(z, x, y, power=3.0, count=20) for z, x, y in ((0.135, 0.158, 0.132), (0.145, 0.158, 0.132))], "black"
        )
        b.box((0.03, 0.12, 0.07), (0.138, 0, 0.045), "charcoal", bevel=0.008)
        b.box((0.004, 0.06, 0.025), (0.154, 0, 0.082), "light green")
        for k in range(4):
            b.box((0.004, 0.018, 0.012), (0.154, -0.042 + 0.028 * k, 0.057), "light grey")
        b.box((0.05, 0.03, 0.03), (0.12, 0, 0.185), "aluminium", bevel=0.006)
        arch = [(0.0, 0.132 * s, z) for s, z in ((-1, 0.15), (-0.9, 0.235), (0.9, 0.235), (1, 0.15))]
        b.tube(arch, 0.009, "black", sides=6)
    size = ((0.27, 0.255, 0.24), (0.33, 0.28, 0.26))[variant]
    return varied(b, rng, size, f"a {style} rice cooker", style)
