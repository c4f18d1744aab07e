"""Appliances that heat, cool or move air: air conditioners, radiators, hoods, fans, dryers. Fronts look along +x."""

import numpy as np

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, rgb
from ....meshes.recipe import recipe
from ...shared.outlines import curve, ellipse, level, pairs
from ...shared.sizes import varied


def fan_grille(b: MeshBuilder, at: tuple[float, float, float], radius: float, guard: Color, blade: Color) -> None:
    """A fan looking along +x behind a guard of rings and spokes."""
    x, y, z = at
    b.cylinder(radius * 0.16, 0.03, (x - 0.01, y, z), guard, (0, 90, 0), segments=12)
    for k in range(4):
        with b.frame(at, (90 * k + 20, 0, 0)):
            outline = [(0.1, -0.1), (0.5, -0.28), (0.92, -0.16), (0.9, 0.2), (0.5, 0.16), (0.1, 0.1)]
            b.extrude([(u * radius, v * radius) for u, v in outline], 0.006, (-0.012, 0, 0), blade, (62, 0, 90))
    for share in (1.0, 0.75, 0.5, 0.28):
        b.ring(radius * share, 0.006, (x + 0.02, y, z), guard, (0, 90, 0), segments=20, sides=4)
    for p in ellipse(radius, radius, 10):
        b.rod((x + 0.02, y, z), (x + 0.02, y + p[0], z + p[1]), 0.004, guard, sides=4)


@recipe("air conditioner", 3, hulls=1, name="climate.air_conditioner")
def air_conditioner(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Outdoor unit with its fan, indoor wall unit with louvres, window unit."""
    b = MeshBuilder(roughness=0.5)
    style = ("outdoor unit", "indoor wall unit", "window unit")[variant]
    if style == "outdoor unit":
        b.box((0.27, 0.8, 0.5), (-0.005, 0, 0.04), "off white", bevel=0.01)
        b.box((0.3, 0.82, 0.02), (-0.005, 0, 0.535), "white", bevel=0.006)
        b.cylinder(0.225, 0.008, (0.126, -0.13, 0.29), "charcoal", (0, 90, 0), segments=28)
        fan_grille(b, (0.145, -0.13, 0.29), 0.222, "light grey", "dark grey")
        for k in range(6):
            b.box((0.006, 0.2, 0.012), (0.131, 0.25, 0.12 + 0.03 * k), "light grey")
        b.box((0.006, 0.12, 0.03), (0.131, 0.27, 0.44), "blue")
        b.box((0.09, 0.03, 0.14), (-0.06, 0.41, 0.09), "white", bevel=0.006)
        b.tube([(-0.06, 0.42, 0.14), (-0.06, 0.45, 0.1), (-0.1, 0.45, 0.04)], 0.012, "black", sides=6)
        for y in (-0.28, 0.28):
            b.box((0.3, 0.05, 0.04), (0, y, 0), "galvanised")
    elif style == "indoor wall unit":
        side = [(-0.1, 0.0), (0.03, 0.0), (0.075, 0.05), (0.09, 0.12), (0.09, 0.24), (0.06, 0.28), (-0.1, 0.28)]
        b.profile(side, 0.8, color="white")
        b.profile([(0.028, -0.002), (0.076, 0.048), (0.072, 0.052), (0.024, 0.004)], 0.66, color="charcoal")
        with b.frame((0.058, 0, 0.018), (0, -38, 0)):
            b.box((0.012, 0.65, 0.052), (0.006, 0, -0.012), "light grey", bevel=0.002)
        for k in range(9):
            b.box((0.12, 0.006, 0.004), (-0.02, -0.32 + 0.08 * k, 0.279), "grey")
        b.box((0.003, 0.76, 0.004), (0.091, 0, 0.1), "light grey")
        b.box((0.003, 0.06, 0.022), (0.091, 0.33, 0.13), "light green")
    else:
        b.box((0.4, 0.6, 0.39), (-0.02, 0, 0), "grey", bevel=0.008)
        b.box((0.05, 0.64, 0.42), (0.19, 0, -0.015), "cream", bevel=0.012)
        for k in range(9):
            b.box((0.012, 0.38, 0.014), (0.218, -0.1, 0.05 + 0.036 * k), "beige", turn_deg=(0, 25, 0))
        b.box((0.006, 0.4, 0.34), (0.213, -0.1, 0.025), "dark grey")
        b.box((0.006, 0.14, 0.3), (0.214, 0.22, 0.04), "brown")
        for z in (0.12, 0.24):
            b.cylinder(0.035, 0.02, (0.216, 0.22, z), "cream", (0, 90, 0), segments=14)
            b.box((0.004, 0.006, 0.035), (0.237, 0.22, z), "brown")
    size = ((0.3, 0.83, 0.56), (0.21, 0.9, 0.29), (0.41, 0.64, 0.42))[variant]
    return varied(b, rng, size, f"the {style} of an air conditioner", style)


@recipe("radiator", 3, hulls=1, name="climate.radiator")
def radiator(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Ribbed steel panel, cast-iron columns, ladder for towels; each with its valve."""
    b = MeshBuilder(roughness=0.45)
    style = ("panel", "cast-iron column", "towel ladder")[variant]
    if style == "panel":
        ribs, width = 18, 0.92
        step = width / ribs
        front = []
        for k in range(ribs):
            y = -width / 2 + k * step
            front += [(0.028, y), (0.046, y + 0.25 * step), (0.046, y + 0.55 * step), (0.028, y + 0.8 * step)]
        b.extrude([(-0.046, -width / 2), *front, (0.028, width / 2), (-0.046, width / 2)], 0.56, (0, 0, 0.02), "white")
        b.box((0.09, width + 0.01, 0.02), (0, 0, 0.575), "off white", bevel=0.004)
        for k in range(14):
            b.box((0.06, 0.03, 0.004), (0, -0.41 + 0.063 * k, 0.594), "grey")
    elif style == "cast-iron column":
        for k in range(9):
            y = -0.32 + 0.08 * k
            for x in (-0.06, 0.0, 0.06):
                b.cylinder(0.026, 0.64, (x, y, 0.07), "dark red", segments=7)
            for z in (0.09, 0.68):
                b.box((0.17, 0.066, 0.06), (0, y, z), "dark red", bevel=0.02, centered=True)
        for y in (-0.32, 0.32):
            for x in (-0.06, 0.06):
                b.cylinder(0.022, 0.09, (x, y, 0), "dark red", top_radius=0.03, segments=8)
    else:
        for y in (-0.23, 0.23):
            b.capsule(0.02, 1.05, (0, y, 0.03), "aluminium", segments=10)
        for k in [0, 1, 2, 3, 4, 6, 7, 8, 9, 11, 12, 13]:
            z = 0.1 + 0.07 * k
            b.tube(
                [(0.0, -0.23, z), (0.022, -0.12, z), (0.03, 0, z), (0.022, 0.12, z), (0, 0.23, z)], 0.012, "aluminium"
            )
    y = (0.475, 0.375, 0.23)[variant]
    b.cylinder(0.014, 0.05, (0, y, 0.05), "white", (-90, 0, 0), segments=8)
    b.cylinder(0.022, 0.07, (0, y + 0.04, 0.035), "off white", segments=10)
    b.rod((0, y + 0.04, 0.0), (0, y + 0.04, 0.05), 0.009, "bronze", sides=6)
    size = ((0.11, 0.97, 0.6), (0.2, 0.86, 0.75), (0.075, 0.52, 1.06))[variant]
    return varied(b, rng, size, f"a {style} radiator", style)


@recipe("range hood", 2, name="climate.range_hood")
def range_hood(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Steel canopy under a chimney; slanting black glass under a chimney."""
    b = MeshBuilder(roughness=0.3)
    style = ("canopy", "slanting glass")[variant]
    if style == "canopy":
        b.box((0.48, 0.75, 0.05), (0, 0, 0.02), "aluminium", bevel=0.004)
        b.box((0.48, 0.75, 0.17), (0, 0, 0.07), "galvanised", taper=(0.5, 0.36))
        b.box((0.24, 0.27, 0.38), (0, 0, 0.24), "aluminium", bevel=0.004)
        for y in (-0.17, 0.17):
            b.box((0.36, 0.3, 0.02), (0, y, 0.0), "dark grey")
            for k in range(6):
                b.box((0.34, 0.01, 0.006), (0, y - 0.11 + 0.044 * k, -0.003), "light grey")
        front = 0.24
    else:
        side = [(-0.2, 0.0), (0.02, 0.0), (0.2, 0.3), (0.2, 0.34), (-0.2, 0.34)]
        b.profile(side, 0.62, color="galvanised")
        with b.frame((0.115, 0, 0.16), (0, 31, 0)):
            b.box((0.015, 0.78, 0.44), (0.0, 0, -0.2), "black", bevel=0.004)
            b.box((0.004, 0.5, 0.012), (0.009, 0, -0.02), "light grey")
        b.box((0.22, 0.28, 0.5), (-0.08, 0, 0.34), "galvanised", bevel=0.004)
        front = 0.21
    for k in range(5):
        b.cylinder(
            0.009,
            0.006,
            (front, -0.06 + 0.03 * k, 0.045 if variant == 0 else 0.325),
            "charcoal",
            (0, 90, 0),
            segments=8,
        )
    size = ((0.48, 0.75, 0.62), (0.46, 0.88, 0.95))[variant]
    return varied(b, rng, size, f"a range hood with a {style}", style)


@recipe("electric fan", 3, name="climate.electric_fan")
def electric_fan(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Table fan, pedestal fan, box fan; each blows along +x."""
    b = MeshBuilder(roughness=0.4)
    style = ("table", "pedestal", "box")[variant]
    blade: Color = ("light blue", "charcoal", "white")[variant]
    if style == "box":
        for y in (-0.25, 0.25):
            b.box((0.12, 0.03, 0.53), (0, y, 0.03), "off white", bevel=0.006)
        for z in (0.03, 0.53):
            b.box((0.12, 0.53, 0.03), (0, 0, z), "off white", bevel=0.006)
        fan_grille(b, (0.03, 0, 0.3), 0.235, "grey", blade)
        for k in range(-4, 5):
            b.rod((0.055, 0.05 * k, 0.05), (0.055, 0.05 * k, 0.55), 0.004, "light grey", sides=4)
        b.cylinder(0.03, 0.03, (0.06, 0.2, 0.53), "charcoal", (0, 90, 0), segments=12)
        for y in (-0.2, 0.2):
            b.box((0.2, 0.04, 0.03), (0, y, 0), "grey", bevel=0.006)
    else:
        hub, radius = (0.34, 0.19) if style == "table" else (1.1, 0.22)
        b.lathe([(0.15, 0), (0.15, 0.02), (0.05, 0.045), (0.03, 0.07)], color="charcoal", segments=24)
        b.cylinder(0.016, hub - 0.08, (0, 0, 0.06), "aluminium" if style == "pedestal" else "charcoal", segments=10)
        b.box((0.06, 0.05, 0.09), (0.0, 0, hub - 0.1), "charcoal", bevel=0.01)
        b.loft([np.roll(level(0, r, r, count=12), 1, 0)[:, [2, 0, 1]] + [x, 0, hub] for x, r in _MOTOR], "charcoal")
        fan_grille(b, (0.09, 0, hub), radius, "light grey", blade)
        for p in ellipse(radius, radius, 12):
            path = curve([(0.11, p[0], p[1]), (0.08, p[0] * 1.01, p[1] * 1.01), (0.03, p[0] * 0.5, p[1] * 0.5)], 2)
            b.tube(path + [0, 0, hub], 0.0035, "light grey", sides=4)
        b.ring(radius * 1.01, 0.008, (0.085, 0, hub), "grey", (0, 90, 0), segments=24, sides=4)
        for k in range(3):
            b.box((0.016, 0.022, 0.012), (0.1, -0.04 + 0.04 * k, 0.03), ("light grey", "light grey", "signal red")[k])
    size = ((0.3, 0.4, 0.53), (0.44, 0.48, 1.32), (0.2, 0.55, 0.56))[variant]
    return varied(b, rng, size, f"a {style} fan", style)


_MOTOR = ((-0.1, 0.02), (-0.08, 0.05), (0.0, 0.06), (0.05, 0.05), (0.06, 0.02))


@recipe("hair drier", 2, name="climate.hair_drier")
def hair_drier(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Barrel and handle with a nozzle along +x; folding one in another colour."""
    b = MeshBuilder(roughness=0.35)
    style = ("salon", "travel")[variant]
    color: Color = ("charcoal", "pink")[variant]
    z = 0.18
    barrel = [(0.026, 0.0), (0.038, 0.01), (0.042, 0.05), (0.036, 0.11), (0.03, 0.15)]
    b.lathe(barrel, (-0.07, 0, z), color, (0, 90, 0), segments=18)
    b.ring(0.032, 0.007, (-0.072, 0, z), "aluminium", (0, 90, 0), segments=18, sides=5)
    b.cylinder(0.027, 0.006, (-0.076, 0, z), "black", (0, 90, 0), segments=16)
    b.loft([_oval(x, y, h, z) for x, y, h in ((0.075, 0.03, 0.03), (0.1, 0.026, 0.026), (0.15, 0.042, 0.01))], "black")
    side = [(-0.048, 0.17), (-0.01, 0.17), (-0.005, 0.11), (-0.012, 0.02), (-0.04, 0.02), (-0.052, 0.11)]
    b.profile(pairs(curve(side, 3, closed=True)), 0.034, color=color)
    b.box((0.008, 0.014, 0.03), (-0.004, 0, 0.1), "light grey" if variant else "signal red", bevel=0.002)
    b.box((0.008, 0.014, 0.02), (-0.006, 0, 0.07), "light grey", bevel=0.002)
    b.ring(0.01, 0.003, (-0.028, 0, 0.014), "black", (90, 0, 0), segments=10, sides=4)
    b.tube(
        curve([(-0.026, 0, 0.02), (-0.026, 0.0, 0.005), (-0.05, 0.02, 0.004), (-0.075, 0.03, 0.004)], 3), 0.004, "black"
    )
    size = ((0.23, 0.088, 0.22), (0.19, 0.078, 0.17))[variant]
    return varied(b, rng, size, f"a {style} hair drier", style)


def _oval(x: float, half_y: float, half_z: float, z: float) -> np.ndarray:
    return np.array([(x, half_y * np.cos(a), z + half_z * np.sin(a)) for a in np.arange(14) * (2 * np.pi / 14)])


@recipe("hand dryer", 2, hulls=1, name="climate.hand_dryer")
def hand_dryer(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Wall box with a nozzle below and the sign of drying hands; tall one that hands dip into."""
    b = MeshBuilder(roughness=0.35)
    style = ("warm-air", "blade")[variant]
    sign, pen = paint.canvas((48, 48), "white" if variant == 0 else "charcoal")
    ink = rgb("blue")
    for x in (16, 24, 32):
        pen.line([(x, 4), (x - 3, 9), (x + 3, 14), (x, 19)], fill=rgb("signal red"), width=2)
    pen.polygon([(6, 36), (14, 28), (26, 30), (42, 24), (44, 29), (30, 40), (10, 44)], fill=ink)
    if style == "warm-air":
        rows = ((0.0, 0.08, 0.11), (0.03, 0.095, 0.13), (0.2, 0.095, 0.135), (0.27, 0.075, 0.12), (0.3, 0.03, 0.08))
        b.loft([level(z, x, y, count=20, power=3.5) for z, x, y in rows], "off white")
        b.box((0.05, 0.27, 0.28), (-0.072, 0, 0.005), "light grey", bevel=0.012)
        b.lathe([(0.03, 0), (0.035, 0.03), (0.03, 0.05)], (0.05, 0, -0.03), "aluminium", segments=14)
        b.panel(sign, (0.0965, 0, 0.13), 0.11, 0.11)
    else:
        outer = [(-0.12, 0.12), (-0.1, 0.03), (0.02, 0.0), (0.11, 0.08), (0.13, 0.56), (0.1, 0.6), (0.06, 0.58)]
        slot = [(0.05, 0.3), (0.0, 0.26), (-0.04, 0.31), (-0.05, 0.66), (-0.12, 0.68)]
        b.profile([*outer, *slot], 0.3, color="aluminium")
        b.profile([(0.057, 0.57), (0.063, 0.57), (0.053, 0.3), (0.047, 0.3)], 0.28, color="amber")
        b.panel(sign, (0.128, 0, 0.4), 0.12, 0.12, tilt_deg=-2.4)
        for k in range(6):
            b.box((0.004, 0.2, 0.006), (0.116, 0, 0.12 + 0.018 * k), "charcoal")
    size = ((0.19, 0.27, 0.3), (0.25, 0.3, 0.68))[variant]
    return varied(b, rng, size, f"a {style} hand dryer", style)
