"""Small machines of kitchens: kettles, coffee machines, toasters, mixers, induction plates. Fronts along +x."""

import numpy as np

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, rgb, shade
from ....meshes.recipe import recipe
from ...shared.outlines import curve, desk_panel, level, pairs, rounded, section
from ...shared.sizes import varied


@recipe("kettle", 3, name="kitchen_machines.kettle")
def kettle(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Steel electric jug on its base, enamelled stove kettle with a hoop handle, tall plastic jug; spout along +x."""
    b = MeshBuilder(roughness=0.3, metallic=0.2)
    style = ("electric jug", "enamelled hob", "plastic jug")[variant]
    if style == "enamelled hob":
        profile = curve([(0.085, 0.0), (0.095, 0.02), (0.088, 0.08), (0.06, 0.125), (0.045, 0.135)], 3)
        b.lathe(pairs(profile), color="red", segments=22)
        b.lathe([(0.045, 0.134), (0.03, 0.148), (0.0, 0.152)], color="dark red", segments=18)
        b.ball(0.013, (0, 0, 0.162), "black", segments=10, rings=6)
        b.tube([(0.06, 0, 0.06), (0.1, 0, 0.09), (0.13, 0, 0.135)], [0.022, 0.017, 0.011], "red", sides=10)
        hoop = [(0.05, 0, 0.125), (0.06, 0, 0.19), (0.0, 0, 0.225), (-0.06, 0, 0.19), (-0.05, 0, 0.125)]
        b.tube(curve(hoop, 4), 0.005, "aluminium", sides=6)
        b.tube(curve(hoop[1:4], 4), 0.011, "black", sides=8)
    else:
        steel = style == "electric jug"
        body: Color = "aluminium" if steel else "white"
        b.lathe([(0.08, 0), (0.082, 0.012), (0.07, 0.022)], color="black", segments=22)
        shape = [(0.075, 0.024), (0.078, 0.05), (0.066, 0.16), (0.058, 0.2)]
        b.lathe(shape if steel else [(0.072, 0.024), (0.07, 0.12), (0.064, 0.24)], color=body, segments=22)
        top = 0.2 if steel else 0.24
        b.lathe([(0.057, top), (0.05, top + 0.012), (0.0, top + 0.016)], color="black", segments=20)
        b.ball((0.014, 0.014, 0.01), (0, 0, top + 0.018), "black", segments=8, rings=5)
        spout = [
            (0.045, -0.028, top - 0.05),
            (0.045, 0.028, top - 0.05),
            (0.05, 0.03, top),
            (0.05, -0.03, top),
            (0.09, 0.008, top + 0.002),
            (0.09, -0.008, top + 0.002),
            (0.06, 0.0, top - 0.05),
        ]
        b.convex(spout, body)
        arch = [(-0.055, 0, top), (-0.09, 0, top + 0.005), (-0.115, 0, top - 0.04), (-0.11, 0, 0.1), (-0.07, 0, 0.06)]
        b.tube(curve(arch, 4), 0.012, "black", sides=8)
        b.box((0.03, 0.02, 0.008), (-0.1, 0, top + 0.004), "signal red", turn_deg=(0, -12, 0), bevel=0.002)
        if not steel:
            b.box((0.006, 0.022, 0.13), (0.0, 0.068, 0.08), "light blue", turn_deg=(0, 0, 0))
    size = ((0.225, 0.165, 0.23), (0.25, 0.19, 0.225), (0.22, 0.15, 0.27))[variant]
    return varied(b, rng, size, f"a {style} kettle", style)


@recipe("toaster", 3, hulls=1, name="kitchen_machines.toaster")
def toaster(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Steel, red and rounded, white four-slice; the slices stand in their slots, the lever is at one end."""
    b = MeshBuilder(roughness=0.3, metallic=0.1)
    style = ("steel", "red rounded", "four-slice")[variant]
    body: Color = ("aluminium", "red", "white")[variant]
    power = (4.5, 3.0, 4.5)[variant]
    rows = ((0.02, 0.078, 0.135), (0.04, 0.084, 0.14), (0.15, 0.084, 0.14), (0.172, 0.074, 0.13), (0.176, 0.06, 0.115))
    b.loft([level(z, x, y, count=20, power=power) for z, x, y in rows], body)
    b.box((0.14, 0.24, 0.022), color="black", bevel=0.006)
    slots = (
        ((-0.028, 0.0), (0.028, 0.0)) if variant < 2 else tuple((x, y) for x in (-0.032, 0.032) for y in (-0.06, 0.06))
    )
    bread = 0.1 if variant == 2 else 0.17
    for x, y in slots:
        b.box((0.03, bread + 0.02, 0.003), (x, y, 0.1755), "black")
        crust = [
            (-bread / 2, 0),
            (bread / 2, 0),
            (bread / 2, 0.04),
            (bread * 0.4, 0.055),
            (-bread * 0.4, 0.055),
            (-bread / 2, 0.04),
        ]
        b.extrude([(v, w * 0.8) for v, w in crust], 0.014, (x - 0.007, y, 0.172), "#b9814a", (90, 0, 90))
    b.box((0.014, 0.004, 0.1), (0, 0.14, 0.05), "black")
    b.box((0.035, 0.03, 0.016), (0, 0.15, 0.13), "black", bevel=0.004)
    b.cylinder(0.014, 0.014, (0.04, 0.138, 0.06), "black", (-90, 0, 0), segments=12)
    b.box((0.003, 0.12, 0.03), (0.084, 0, 0.08), shade(body, 0.8))
    size = ((0.175, 0.29, 0.2), (0.19, 0.3, 0.21), (0.26, 0.36, 0.2))[variant]
    return varied(b, rng, size, f"a {style} toaster", style)


@recipe("coffee machine", 3, name="kitchen_machines.coffee_machine")
def coffee_machine(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Espresso machine with a filter handle, filter machine with its jug, two-group machine of a bar."""
    b = MeshBuilder(roughness=0.3)
    style = ("espresso", "filter", "two-group bar")[variant]
    if style == "filter":
        b.box((0.24, 0.19, 0.03), color="black", bevel=0.008)
        b.box((0.08, 0.19, 0.3), (-0.08, 0, 0.03), "black", bevel=0.01)
        b.box((0.24, 0.19, 0.1), (0, 0, 0.25), "black", bevel=0.014)
        b.box((0.004, 0.05, 0.14), (-0.06, 0.097, 0.08), "light blue", turn_deg=(0, 0, 90))
        b.lathe([(0.06, 0.0), (0.078, 0.03), (0.075, 0.09), (0.05, 0.13)], (0.035, 0, 0.035), "#3a2416", segments=20)
        b.lathe([(0.05, 0.13), (0.058, 0.15), (0.0, 0.155)], (0.035, 0, 0.035), "black", segments=20)
        b.tube(curve([(0.09, 0, 0.16), (0.15, 0, 0.165), (0.15, 0, 0.08), (0.1, 0, 0.07)], 3), 0.01, "black", sides=6)
        b.lathe([(0.03, -0.03), (0.06, 0.0)], (0.035, 0, 0.245), "black", segments=16)
        b.box((0.004, 0.03, 0.02), (0.121, -0.06, 0.29), "signal red")
    else:
        width = 0.27 if style == "espresso" else 0.62
        body: Color = "aluminium" if style == "espresso" else "dark red"
        b.box((0.32, width, 0.06), (0, 0, 0.01), body, bevel=0.008)
        b.box((0.13, width, 0.32), (-0.095, 0, 0.06), body, bevel=0.008)
        b.box((0.28, width, 0.11), (-0.02, 0, 0.27), body, bevel=0.012)
        b.box((0.16, width * 0.9, 0.008), (0.065, 0, 0.068), "black")
        for k in range(8):
            b.box((0.005, width * 0.86, 0.003), (0.0 + 0.018 * k, 0, 0.076), "light grey")
        for y in (0.0,) if style == "espresso" else (-0.15, 0.15):
            b.cylinder(0.034, 0.035, (0.045, y, 0.24), "galvanised", segments=16)
            b.cylinder(0.037, 0.028, (0.045, y, 0.214), "dark grey", segments=16)
            b.tube([(0.07, y, 0.228), (0.11, y, 0.222), (0.2, y, 0.21)], [0.008, 0.013, 0.015], "black", sides=8)
            b.rod((0.045, y, 0.19), (0.045, y, 0.215), 0.008, "galvanised", sides=6)
            b.lathe([(0.02, 0.0), (0.032, 0.02), (0.036, 0.05)], (0.045, y, 0.08), "white", segments=14)
            b.cylinder(0.032, 0.004, (0.045, y, 0.127), "#4a2c1a", segments=14)
            b.ring(0.014, 0.004, (0.045, y + 0.045, 0.105), "white", (90, 90, 0), segments=10, sides=5)
        b.tube(
            [(0.08, -width * 0.43, 0.28), (0.11, -width * 0.45, 0.2), (0.1, -width * 0.44, 0.1)], 0.006, "galvanised"
        )
        b.cylinder(0.028, 0.008, (0.119, width * 0.3, 0.325), "white", (0, 90, 0), segments=14)
        for k in range(3):
            b.cylinder(0.012, 0.012, (0.118, -0.09 + 0.05 * k, 0.325), "black", (0, 90, 0), segments=10)
        for k in range(int(width / 0.085)):
            b.lathe([(0.026, 0), (0.036, 0.045)], (-0.07, -width / 2 + 0.055 + 0.085 * k, 0.38), "white", segments=10)
    size = ((0.345, 0.28, 0.39), (0.3, 0.22, 0.37), (0.62, 0.61, 0.5))[variant]
    return varied(b, rng, size, f"a {style} coffee machine", style)


def _stand_mixer(b: MeshBuilder) -> None:
    """A tilting head over a bowl, the whisk between."""
    b.extrude(rounded(0.33, 0.2, 0.08), 0.03, color="teal")
    b.loft(
        [level(z, x, y, x=-0.1, count=16) for z, x, y in ((0.03, 0.055, 0.06), (0.12, 0.04, 0.05), (0.24, 0.05, 0.05))],
        "teal",
    )
    rows = (
        (-0.17, 0.02, 0.02),
        (-0.15, 0.045, 0.045),
        (-0.05, 0.058, 0.058),
        (0.09, 0.05, 0.052),
        (0.14, 0.02, 0.025),
    )
    b.loft([section(x, y, z, 0.275, 16, 2.6) for x, y, z in rows], "teal")
    b.ring(0.032, 0.006, (0.128, 0, 0.275), "aluminium", (0, 90, 0), segments=16, sides=5)
    b.cylinder(0.02, 0.04, (0.06, 0, 0.2), "aluminium", segments=12)
    b.tube(
        [(0.06, 0, 0.2), (0.085, 0, 0.17), (0.06, 0, 0.1), (0.035, 0, 0.17), (0.06, 0, 0.2)],
        0.005,
        "white",
        sides=6,
    )
    b.lathe(
        [(0.05, 0.0), (0.055, 0.01), (0.09, 0.05), (0.105, 0.12), (0.1, 0.12), (0.06, 0.03), (0.0, 0.025)],
        (0.06, 0, 0.03),
        "aluminium",
        segments=22,
    )
    b.box((0.06, 0.004, 0.008), (-0.05, 0.0585, 0.26), "aluminium")
    b.ball(0.011, (-0.08, 0.062, 0.264), "black", segments=8, rings=5)


def _hand_mixer(b: MeshBuilder) -> None:
    """A body with a bail handle above two beaters."""
    rows = ((-0.1, 0.03, 0.03), (-0.06, 0.042, 0.042), (0.05, 0.042, 0.045), (0.09, 0.025, 0.03))
    b.loft([section(x, y, z, 0.24, 14, 2.8) for x, y, z in rows], "white")
    b.tube(
        curve([(0.07, 0, 0.26), (0.07, 0, 0.32), (-0.03, 0, 0.33), (-0.11, 0, 0.3), (-0.09, 0, 0.24)], 3),
        0.015,
        "light blue",
    )
    b.box((0.03, 0.024, 0.012), (0.045, 0, 0.34), "charcoal", bevel=0.004)
    for y in (-0.028, 0.028):
        b.rod((0.045, y, 0.21), (0.045, y, 0.1), 0.005, "aluminium", sides=6)
        for turn in (0, 90):
            with b.frame((0.045, y, 0.0), (0, 0, turn + 45)):
                hoop = [
                    (0, 0, 0.11),
                    (0.024, 0, 0.09),
                    (0.024, 0, 0.02),
                    (0, 0, 0.0),
                    (-0.024, 0, 0.02),
                    (-0.024, 0, 0.09),
                ]
                b.tube([*hoop, (0, 0, 0.11)], 0.003, "aluminium", sides=4)
    b.tube(curve([(-0.1, 0, 0.23), (-0.13, 0.02, 0.15), (-0.1, 0.06, 0.1)], 3), 0.005, "black", sides=6)


@recipe("mixer", 3, name="kitchen_machines.mixer")
def mixer(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Stand mixer over its bowl, hand mixer with two beaters, jug blender; the bowl is at +x."""
    b = MeshBuilder(roughness=0.3)
    style = ("stand", "hand", "jug")[variant]
    if style == "stand":
        _stand_mixer(b)
    elif style == "hand":
        _hand_mixer(b)
    else:
        b.loft(
            [level(z, x, x, count=16, power=3.5) for z, x in ((0.0, 0.085), (0.02, 0.09), (0.1, 0.07), (0.12, 0.06))],
            "charcoal",
        )
        b.cylinder(0.022, 0.016, (0.08, 0, 0.05), "aluminium", (0, 80, 0), segments=14)
        b.lathe([(0.05, 0.0), (0.056, 0.02), (0.075, 0.2)], (0, 0, 0.12), "glass", segments=18)
        b.lathe([(0.052, 0.005), (0.059, 0.03), (0.071, 0.14)], (0, 0, 0.121), "orange", segments=18)
        b.lathe(
            [(0.077, 0.0), (0.078, 0.02), (0.04, 0.03), (0.035, 0.045), (0.0, 0.046)],
            (0, 0, 0.32),
            "black",
            segments=18,
        )
        b.tube(
            curve([(-0.06, 0, 0.3), (-0.12, 0, 0.3), (-0.12, 0, 0.18), (-0.055, 0, 0.16)], 3), 0.011, "black", sides=8
        )
        for k in range(3):
            b.box((0.004, 0.03, 0.003), (0.067 + 0.006 * k, 0.0, 0.2 + 0.03 * k), "white")
    size = ((0.345, 0.21, 0.34), (0.25, 0.145, 0.3), (0.21, 0.18, 0.42))[variant]
    return varied(b, rng, size, f"a {style} mixer", style)


@recipe("induction cooker", 2, hulls=1, name="kitchen_machines.induction_cooker")
def induction_cooker(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Portable plate with one ring; hob with four. The keys are at the front, +x."""
    b = MeshBuilder(roughness=0.15)
    style = ("one-ring", "four-ring")[variant]
    top, pen = paint.canvas((160, 144), "#16181c")
    spots = [((80, 56), 44)] if variant == 0 else [((44, 38), 28), ((116, 38), 34), ((44, 94), 34), ((116, 94), 26)]
    for (x, y), r in spots:
        for share in (1.0, 0.62):
            pen.ellipse(
                (x - r * share, y - r * share, x + r * share, y + r * share), outline=rgb("light grey"), width=2
            )
        pen.line((x - 6, y, x + 6, y), fill=rgb("light grey"), width=2)
        pen.line((x, y - 6, x, y + 6), fill=rgb("light grey"), width=2)
    paint.text(pen, "180", (62, 122, 98, 138), "light red")
    for k, x in enumerate((14, 34, 120, 140)):
        pen.ellipse((x - 6, 124, x + 6, 136), outline=rgb("white" if k else "signal red"), width=2)
    case: Color = "white" if variant == 0 else "black"
    b.box((0.33, 0.37, 0.045), (0, 0, 0.012), case, bevel=0.01)
    b.box((0.325, 0.365, 0.006), (0, 0, 0.056), "black", bevel=0.002)
    desk_panel(b, top, (0, 0, 0.0625), 0.355, 0.315)
    for x in (-0.13, 0.13):
        for y in (-0.15, 0.15):
            b.cylinder(0.018, 0.013, (x, y, 0), "charcoal", segments=10)
    for k in range(8):
        b.box((0.004, 0.014, 0.02), (0.1645, -0.12 + 0.034 * k, 0.022), "grey")
    size = ((0.34, 0.38, 0.065), (0.52, 0.58, 0.06))[variant]
    return varied(b, rng, size, f"a {style} induction cooker", style)
