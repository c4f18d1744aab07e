"""Emergency equipment: extinguishers, defibrillators, alarms, first-aid kits."""

import numpy as np
from PIL import Image

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, rgb, shade
from ...meshes.recipe import recipe
from ..shared.facade_images import sign
from ..shared.forms import soft
from ..shared.sizes import made


def cross(back: Color, ink: Color) -> Image.Image:
    """A cross of equal arms."""
    image, draw = paint.canvas((40, 40), back)
    draw.rectangle((15, 5, 24, 34), fill=rgb(ink))
    draw.rectangle((5, 15, 34, 24), fill=rgb(ink))
    return image


def _heart() -> Image.Image:
    image, draw = paint.canvas((160, 160), "green")
    draw.ellipse((24, 34, 84, 94), fill=rgb("white"))
    draw.ellipse((76, 34, 136, 94), fill=rgb("white"))
    draw.polygon([(30, 80), (130, 80), (80, 142)], fill=rgb("white"))
    draw.polygon([(88, 48), (62, 88), (80, 88), (70, 122), (100, 80), (82, 80)], fill=rgb("green"))
    return paint.shrunk(image, (40, 40))


@recipe("fire extinguisher", 3, name="first_aid.fire_extinguisher")
def fire_extinguisher(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Powder with hose, carbon dioxide with a black horn, a stout foam one; the label at +x."""
    b = MeshBuilder(roughness=0.35)
    r, h, band = ((0.075, 0.41, "off white"), (0.055, 0.5, "black"), (0.09, 0.44, "cream"))[variant % 3]
    b.lathe(
        [(r * 0.9, 0), (r * 0.94, 0.015), (r, 0.02), (r, h * 0.86), (r * 0.85, h * 0.95), (r * 0.35, h)],
        color="signal red",
        segments=26,
    )
    b.lathe([(r * 1.0, 0.0), (r * 1.03, 0.01), (r, 0.03)], color="black", segments=26)
    b.cylinder(0.02, 0.04, (0, 0, h - 0.005), "brass", segments=14)
    top = h + 0.03
    b.box((0.15, 0.022, 0.014), (-0.02, 0, top), "black", turn_deg=(0, 10, 0), bevel=0.004)
    b.box((0.14, 0.022, 0.012), (-0.03, 0, top + 0.035), "black", turn_deg=(0, 22, 0), bevel=0.004)
    b.ring(0.014, 0.003, (-0.005, 0.028, top + 0.02), "signal yellow", (90, 0, 0), 12, 5)
    b.cylinder(0.018, 0.012, (0.02, 0.012, top - 0.01), "white", turn_deg=(-90, 0, 0), segments=14)
    if variant % 3 == 1:
        b.tube([(0.02, 0, top), (r + 0.02, 0.02, top - 0.02), (r + 0.05, 0.03, h * 0.75)], 0.01, "black")
        b.lathe([(0.045, 0), (0.02, 0.2), (0.012, 0.24)], (r + 0.052, 0.03, h * 0.3), "black", segments=16)
    else:
        hose = [
            (0, -0.01, top),
            (0.01, -r * 0.9, top - 0.01),
            (0.02, -r - 0.03, h * 0.8),
            (0.02, -r - 0.02, h * 0.45),
            (0.02, -r - 0.014, h * 0.3),
        ]
        b.tube(hose, 0.009, "black", sides=10)
        b.lathe([(0.013, 0), (0.009, 0.07)], (0.02, -r - 0.013, h * 0.22), "black", segments=10)
    label, draw = paint.canvas((192, 160), band if variant % 3 != 1 else "off white")
    draw.rectangle((0, 0, 192, 34), fill=rgb("signal red" if variant % 3 != 1 else "black"))
    paint.text(draw, ("POWDER", "CO2", "FOAM")[variant % 3], (20, 4, 172, 30), "white", bold=0.04)
    for k in range(3):
        draw.rectangle((20, 52 + 34 * k, 52, 78 + 34 * k), fill=rgb("signal red"))
        draw.line((64, 60 + 34 * k, 172, 60 + 34 * k), fill=(60, 60, 60), width=5)
        draw.line((64, 70 + 34 * k, 150, 70 + 34 * k), fill=(60, 60, 60), width=4)
    a = np.radians(np.linspace(-62, 62, 11))
    rows = [[(r * 1.008 * np.cos(t), r * 1.008 * np.sin(t), z) for t in a] for z in (h * 0.3, h * 0.72)]
    b.sheet(np.array(rows), image=paint.shrunk(label, (72, 60)))
    size = ((0.19, 0.15, 0.52), (0.24, None, 0.62), (None, 0.21, 0.54))[variant % 3]
    size = ((0.15, 0.19, 0.52), (0.17, 0.14, 0.62), (0.19, 0.23, 0.55))[variant % 3]
    return made(b, ("a powder", "a carbon dioxide", "a foam")[variant % 3] + " fire extinguisher", size)


@recipe("defibrillator (aed)", 3, name="first_aid.defibrillator")
def defibrillator(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A portable unit with handle and shock button, a flat one with its lid, a white wall cabinet; the face at +x."""
    b = MeshBuilder(roughness=0.45)
    if variant % 3 == 2:
        b.box((0.17, 0.38, 0.38), color="white", bevel=0.012)
        b.box((0.02, 0.32, 0.3), (0.08, 0, 0.03), "dark glass", bevel=0.006)
        b.panel(_heart(), (0.092, 0, 0.17), 0.16, 0.16)
        b.panel(sign("AED", "green", "white", (64, 18)), (0.092, 0, 0.3), 0.28, 0.06)
        b.box((0.03, 0.02, 0.1), (0.092, 0.13, 0.13), "light grey", bevel=0.005)
        b.lathe([(0.04, 0), (0.04, 0.02), (0, 0.035)], (0, 0, 0.38), "signal red", segments=16)
        return made(b, "a defibrillator in its wall cabinet", (0.2, 0.4, 0.42), style="cabinet")
    color, edge = (("signal yellow", "charcoal"), ("light grey", "green"))[variant % 3]
    soft(b, (0.12, 0.29, 0.24), (0, 0, 0), color, plan=5, side=6, rings=10)
    soft(b, (0.126, 0.27, 0.04), (0, 0, 0), edge, plan=5, side=4)
    b.tube([(0, -0.1, 0.2), (0, -0.09, 0.265), (0, 0.09, 0.265), (0, 0.1, 0.2)], 0.016, edge, sides=10)
    b.box((0.02, 0.2, 0.15), (0.052, 0, 0.05), edge, bevel=0.008)
    b.panel(_heart(), (0.064, -0.04, 0.14), 0.09, 0.09)
    b.cylinder(0.026, 0.012, (0.058, 0.055, 0.12), "orange", turn_deg=(0, 90, 0), segments=18)
    b.cylinder(0.014, 0.012, (0.058, 0.055, 0.172), "light green", turn_deg=(0, 90, 0), segments=14)
    b.panel(sign("AED", edge, "white", (48, 16)), (0.064, -0.04, 0.075), 0.1, 0.034)
    return made(b, "a portable defibrillator", ((0.13, 0.3, 0.28), (0.1, 0.26, 0.25))[variant % 3], style="portable")


@recipe("fire alarm box", 3, name="first_aid.fire_alarm_box")
def fire_alarm_box(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A break-glass call point, an American pull station, a cast street box with a gabled top; the face at +x."""
    b = MeshBuilder(roughness=0.4)
    if variant % 3 == 0:
        b.box((0.06, 0.12, 0.14), color="signal red", bevel=0.008)
        b.box((0.012, 0.085, 0.085), (0.03, 0, 0.018), "white", bevel=0.003)
        image, draw = paint.canvas((40, 40), "white")
        draw.ellipse((13, 13, 27, 27), fill=(10, 10, 10))
        for y, pts in ((20, [(3, 14), (3, 26), (11, 20)]), (20, [(37, 14), (37, 26), (29, 20)])):
            draw.polygon(pts, fill=(10, 10, 10))
            draw.line((2, y, 38, y), fill=(120, 120, 120))
        b.panel(image, (0.037, 0, 0.06), 0.08, 0.08)
        b.panel(sign("FIRE", "signal red", "white", (48, 14)), (0.031, 0, 0.12), 0.085, 0.026)
        for y in (-0.05, 0.05):
            for z in (0.01, 0.13):
                b.cylinder(0.004, 0.004, (0.029, y, z), "dark grey", turn_deg=(0, 90, 0), segments=10)
        return made(b, "a break-glass fire alarm", (0.07, 0.12, 0.14), style="call point")
    if variant % 3 == 1:
        b.box((0.06, 0.09, 0.13), color="signal red", bevel=0.006)
        b.panel(sign("FIRE", "signal red", "white", (48, 20)), (0.031, 0, 0.105), 0.075, 0.032)
        b.panel(sign("PULL\nDOWN", "signal red", "white", (40, 24)), (0.031, 0, 0.028), 0.06, 0.034)
        b.tube(
            [(0.028, -0.03, 0.08), (0.05, -0.03, 0.062), (0.05, 0.03, 0.062), (0.028, 0.03, 0.08)],
            0.008,
            "white",
            sides=10,
        )
        b.box((0.012, 0.07, 0.03), (0.034, 0, 0.05), "white", bevel=0.004)
        b.cylinder(0.006, 0.008, (0.028, 0.033, 0.118), "aluminium", turn_deg=(0, 90, 0), segments=12)
        return made(b, "a pull station", (0.065, 0.095, 0.135), style="pull station")
    outline = [(-0.13, 0), (0.13, 0), (0.13, 0.26), (0.0, 0.36), (-0.13, 0.26)]
    b.extrude(outline, 0.16, (-0.08, 0, 0.02), "signal red", turn_deg=(90, 0, 90))
    b.box((0.18, 0.3, 0.03), color="dark red", bevel=0.006)
    for s in (-1, 1):
        b.beam((0, s * 0.15, 0.27), (0, 0, 0.395), 0.19, 0.02, "dark red")
    b.box((0.02, 0.2, 0.2), (0.08, 0, 0.06), "white", bevel=0.006)
    b.panel(sign("FIRE\nALARM", "white", "signal red", (56, 36)), (0.092, 0, 0.2), 0.17, 0.1)
    b.ring(0.035, 0.008, (0.1, 0, 0.1), "brass", (0, 90, 0), 18, 6)
    return made(b, "a cast-iron street fire alarm", (0.2, 0.3, 0.4), style="street box")


@recipe("first-aid kit", 3, name="first_aid.first_aid_kit")
def first_aid_kit(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A red soft bag, a white metal case, a green wall box; the cross at +x."""
    b = MeshBuilder(roughness=0.7)
    color, ink = (("signal red", "white"), ("white", "green"), ("green", "white"))[variant % 3]
    d, w, h = ((0.11, 0.26, 0.165), (0.1, 0.34, 0.24), (0.13, 0.4, 0.28))[variant % 3]
    if variant % 3 == 0:
        soft(b, (d, w, h), (0, 0, 0), color, plan=6, side=6, rings=10)
        b.box((d + 0.006, w + 0.002, 0.008), (0, 0, h * 0.66), "charcoal")
        b.box((0.015, 0.012, 0.03), (d / 2, 0.06, h * 0.62), "charcoal")
    else:
        b.box((d, w, h), color=color, bevel=0.015)
        b.box((d + 0.004, w + 0.004, 0.008), (0, 0, h * 0.5), shade(color, 0.6))
        for y in (-w * 0.3, w * 0.3):
            b.box((0.014, 0.04, 0.04), (d / 2, y, h * 0.5 - 0.02), "aluminium", bevel=0.004)
    b.panel(cross(color, ink), (d / 2 + 0.002, 0, h * (0.4 if variant % 3 == 0 else 0.5)), h * 0.52, h * 0.52)
    b.tube(
        [(0, -0.05, h - 0.005), (0, -0.045, h + 0.025), (0, 0.045, h + 0.025), (0, 0.05, h - 0.005)],
        0.009,
        "charcoal",
        sides=8,
    )
    return made(
        b, f"a {color} first-aid kit", ((0.12, 0.26, 0.185), (0.11, 0.34, 0.27), (0.14, 0.4, 0.31))[variant % 3]
    )


@recipe("smoke alarm", 2, name="first_aid.smoke_alarm")
def smoke_alarm(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A round puck with slots and a test button, a domed one with a ring of vents; drawn face up."""
    b = MeshBuilder(roughness=0.5)
    domed = variant % 2 == 1
    b.lathe([(0.055, 0), (0.055, 0.01), (0.05, 0.012)], color="light grey" if domed else "off white", segments=28)
    b.lathe(
        [(0.05, 0.01), (0.052, 0.02), (0.045 if domed else 0.05, 0.036), (0.025 if domed else 0.044, 0.043)],
        color="cream" if domed else "white",
        segments=28,
    )
    for k in range(16):
        with b.frame(turn_deg=(0, 0, 22.5 * k)):
            b.box((0.004, 0.011, 0.012), (0.05, 0, 0.019), "dark grey")
    for k in range(3):
        b.ring(0.014 + 0.007 * k, 0.0012, (-0.012, 0, 0.0432), "light grey", segments=16, sides=4)
    b.cylinder(0.009, 0.004, (0.026, 0, 0.042 if not domed else 0.04), "light grey", segments=16)
    b.cylinder(0.0025, 0.004, (0.026, 0.018, 0.0415 if not domed else 0.039), "light red", segments=8)
    return made(b, "a smoke alarm", ((0.11, 0.11, 0.045), (0.125, 0.125, 0.055))[variant % 2], domed=domed)
