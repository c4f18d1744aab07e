"""Machines and supplies of shops and offices. The user sits or stands at +x."""

import numpy as np

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, rgb, shade
from ....meshes.recipe import recipe
from ...shared.outlines import curve, desk_panel, pairs, rounded
from ...shared.sizes import varied


def _keys(
    b: MeshBuilder, rows: int, columns: int, at: tuple[float, float, float], pitch: float, inks: list[Color]
) -> None:
    """A block of keys, their rows along x and columns along y, first at the far left."""
    for r in range(rows):
        for c in range(columns):
            place = (at[0] + r * pitch, at[1] + c * pitch, at[2])
            b.box((pitch * 0.78, pitch * 0.78, pitch * 0.35), place, inks[c % len(inks)], taper=(0.85, 0.85))


@recipe("cash register", 3, name="office_machines.cash_register")
def cash_register(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Electronic till with a receipt, touch-screen till, old brass till with flags and round keys; on a drawer."""
    b = MeshBuilder(roughness=0.4)
    style = ("electronic", "touch-screen", "old brass")[variant]
    if style == "old brass":
        b.box((0.42, 0.4, 0.12), color="brass", bevel=0.006)
        b.box((0.02, 0.34, 0.08), (0.21, 0, 0.02), "bronze", bevel=0.005)
        b.profile(
            [(-0.2, 0.12), (0.2, 0.12), (0.19, 0.16), (0.02, 0.3), (-0.02, 0.4), (-0.2, 0.4)], 0.38, color="brass"
        )
        with b.frame((0.1, 0, 0.235), (0, 39, 0)):
            for r in range(4):
                for c in range(6):
                    b.cylinder(0.006, 0.03, (-0.07 + 0.045 * r, -0.14 + 0.056 * c, 0), "bronze", segments=4)
                    b.cylinder(
                        0.016,
                        0.006,
                        (-0.07 + 0.045 * r, -0.14 + 0.056 * c, 0.03),
                        "white" if c < 5 else "red",
                        segments=8,
                    )
        b.box((0.14, 0.36, 0.09), (-0.1, 0, 0.4), "bronze", bevel=0.01)
        sign, pen = paint.canvas((96, 24), "cream")
        paint.text(pen, "4  50  NO SALE", (4, 3, 92, 21), "black", 0.03)
        b.panel(sign, (-0.028, 0, 0.445), 0.3, 0.06)
        b.tube([(0.05, 0.19, 0.2), (0.05, 0.24, 0.2), (0.13, 0.24, 0.26)], 0.008, "bronze", sides=6)
        b.ball(0.02, (0.13, 0.24, 0.26), "dark wood", segments=8, rings=6)
    else:
        b.box((0.42, 0.4, 0.1), color="charcoal", bevel=0.006)
        b.box((0.012, 0.38, 0.075), (0.209, 0, 0.012), "dark grey", bevel=0.003)
        b.cylinder(0.012, 0.006, (0.214, 0, 0.05), "aluminium", (0, 90, 0), segments=10)
        if style == "electronic":
            b.profile(
                [(-0.2, 0.1), (0.2, 0.1), (0.2, 0.13), (0.0, 0.2), (-0.04, 0.24), (-0.2, 0.24)], 0.38, color="off white"
            )
            with b.frame((0.1, 0, 0.165), (0, 19.3, 0)):
                _keys(b, 5, 4, (-0.07, 0.03, 0), 0.034, ["white", "white", "white", "grey"])
                _keys(b, 5, 4, (-0.07, -0.15, 0), 0.034, ["light blue", "amber", "signal red", "green"])
            screen, pen = paint.canvas((64, 20), "#0c201c")
            paint.text(pen, "12.50", (20, 2, 62, 18), "light green")
            b.box((0.06, 0.2, 0.07), (-0.1, -0.06, 0.27), "off white", bevel=0.008)
            b.rod((-0.1, -0.06, 0.22), (-0.1, -0.06, 0.28), 0.02, "light grey")
            b.panel(screen, (-0.0685, -0.06, 0.305), 0.17, 0.045)
            b.box((0.1, 0.12, 0.03), (-0.1, 0.11, 0.235), "charcoal", bevel=0.008)
            curl = curve([(-0.09, 0.11, 0.262), (-0.08, 0.11, 0.3), (-0.05, 0.11, 0.33), (-0.01, 0.11, 0.325)], 3)
            strip = np.stack([curl + [0, -0.035, 0], curl + [0, 0.035, 0]], 1)
            b.sheet(strip, "white", both_sides=True)
        else:
            b.cylinder(0.03, 0.14, (-0.08, 0, 0.1), "charcoal", segments=14)
            with b.frame((-0.03, 0, 0.16), (0, -24, 0)):
                b.box((0.03, 0.36, 0.26), color="black", bevel=0.006)
                screen, pen = paint.canvas((108, 76), "white")
                for k in range(12):
                    x, y = 40 + 17 * (k % 4), 4 + 18 * (k // 4)
                    ink = ("amber", "light blue", "green", "pink", "orange")[k % 5]
                    pen.rectangle((x, y, x + 14, y + 15), fill=rgb(ink))
                for k in range(6):
                    pen.line((4, 8 + 8 * k, 30 - 4 * (k % 3), 8 + 8 * k), fill=(90, 90, 90))
                pen.rectangle((0, 60, 108, 76), fill=rgb("dark green"))
                paint.text(pen, "TOTAL 18.40", (4, 62, 104, 75), "white")
                b.panel(screen, (0.0165, 0, 0.13), 0.33, 0.235)
    size = ((0.42, 0.4, 0.34), (0.43, 0.41, 0.4), (0.48, 0.46, 0.52))[variant]
    return varied(b, rng, size, f"an {style} cash register" if variant != 1 else f"a {style} cash register", style)


def _paper(b: MeshBuilder, points: list[tuple[float, float, float]], width: float) -> None:
    """A sheet of paper along a side view (x, y = its middle, z)."""
    path = curve(points, 3)
    b.sheet(np.stack([path + [0, -width / 2, 0], path + [0, width / 2, 0]], 1), "white", both_sides=True)


@recipe("printer", 3, hulls=1, name="office_machines.printer")
def printer(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """White inkjet with paper behind, dark laser printer, office copier on its paper drawers."""
    b = MeshBuilder(roughness=0.45)
    style = ("inkjet", "laser", "office copier")[variant]
    if style == "office copier":
        b.box((0.52, 0.5, 0.5), (0, 0, 0.04), "light grey", bevel=0.01)
        for z in (0.06, 0.28):
            b.box((0.02, 0.46, 0.2), (0.26, 0, z), "off white", bevel=0.006)
            b.box((0.012, 0.16, 0.03), (0.272, 0, z + 0.12), "dark grey")
        b.box((0.52, 0.5, 0.1), (0, 0, 0.54), "dark grey", bevel=0.008)
        b.box((0.48, 0.44, 0.08), (-0.02, -0.02, 0.62), "black")
        _paper(b, [(-0.1, -0.03, 0.65), (0.1, -0.03, 0.66), (0.22, -0.03, 0.68)], 0.3)
        b.box((0.08, 0.06, 0.26), (-0.2, -0.22, 0.6), "light grey")
        b.box((0.08, 0.06, 0.26), (-0.2, 0.22, 0.6), "light grey")
        b.box((0.52, 0.52, 0.1), (0, 0, 0.78), "light grey", bevel=0.01)
        b.box((0.46, 0.48, 0.09), (-0.02, 0, 0.88), "off white", bevel=0.02)
        with b.frame((0.29, 0.1, 0.86), (0, -30, 0)):
            b.box((0.02, 0.24, 0.1), color="black", bevel=0.005)
            b.box((0.004, 0.14, 0.07), (0.01, -0.03, 0.015), "light blue")
            b.cylinder(0.016, 0.006, (0.01, 0.085, 0.05), "light green", (0, 90, 0), segments=10)
        for x in (-0.2, 0.2):
            for y in (-0.2, 0.2):
                b.cylinder(0.022, 0.04, (x, y, 0), "black", segments=8)
    else:
        body: Color = "white" if style == "inkjet" else "charcoal"
        b.box((0.3, 0.43, 0.13), (-0.03, 0, 0), body, bevel=0.012)
        b.box((0.28, 0.42, 0.03), (-0.03, 0, 0.13), "dark grey" if style == "inkjet" else "black", bevel=0.01)
        b.box((0.006, 0.3, 0.07), (0.118, -0.02, 0.03), "black")
        b.box((0.12, 0.26, 0.01), (0.16, -0.02, 0.02), shade(body, 0.85), bevel=0.003)
        _paper(b, [(0.09, -0.02, 0.06), (0.17, -0.02, 0.055), (0.23, -0.02, 0.035)], 0.21)
        b.box(
            (0.012, 0.1, 0.06), (0.119, 0.155, 0.05), "light blue" if style == "inkjet" else "dark glass", bevel=0.003
        )
        for k in range(3):
            b.cylinder(
                0.008,
                0.006,
                (0.12, 0.13 + 0.025 * k, 0.035),
                ("light green", "grey", "amber")[k],
                (0, 90, 0),
                segments=8,
            )
        if style == "inkjet":
            with b.frame((-0.15, 0, 0.15), (0, -22, 0)):
                b.box((0.008, 0.25, 0.1), color="light grey", bevel=0.002)
                b.box((0.006, 0.21, 0.14), (0.008, 0, 0), "white")
        else:
            b.profile([(-0.15, 0.16), (0.1, 0.16), (0.1, 0.17), (-0.02, 0.2), (-0.15, 0.21)], 0.38, color="charcoal")
            _paper(b, [(-0.1, 0, 0.205), (0.0, 0, 0.225), (0.06, 0, 0.215)], 0.21)
    size = ((0.37, 0.43, 0.24), (0.4, 0.42, 0.27), (0.56, 0.585, 1.06))[variant]
    return varied(b, rng, size, f"an {style} printer" if variant != 1 else "a laser printer", style)


@recipe("fax machine", 2, hulls=1, name="office_machines.fax_machine")
def fax_machine(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Grey machine, black machine: handset at the left, keys at the right, paper rising out of the back."""
    b = MeshBuilder(roughness=0.5)
    style = ("grey", "black")[variant]
    body: Color = ("light grey", "charcoal")[variant]
    b.profile([(-0.16, 0), (0.17, 0), (0.17, 0.04), (0.06, 0.085), (-0.16, 0.11)], 0.33, color=body)
    with b.frame((0.1, 0, 0.069), (0, 22.2, 0)):
        _keys(b, 4, 3, (-0.035, -0.02, 0), 0.022, ["white" if variant == 0 else "light grey"])
        _keys(b, 2, 1, (-0.035, 0.115, 0), 0.032, ["green"])
        b.box((0.02, 0.02, 0.006), (0.03, 0.115, 0), "signal red")
    screen, pen = paint.canvas((64, 18), "#7c9a78")
    paint.text(pen, "FAX READY", (3, 2, 61, 16), "black")
    with b.frame((0.02, 0, 0.093), (0, 8, 0)):
        desk_panel(b, screen, (0.0, 0.05, 0.0012), 0.12, 0.03)
    with b.frame((0.01, -0.115, 0.1)):
        b.tube(
            curve([(-0.09, 0, 0.012), (-0.05, 0, 0.03), (0.05, 0, 0.02), (0.09, 0, -0.012)], 3),
            0.014,
            shade(body, 0.75),
            sides=8,
        )
        for x, z in ((-0.09, 0.0), (0.09, -0.03)):
            b.cylinder(0.027, 0.02, (x, 0, z), shade(body, 0.75), top_radius=0.022, segments=12)
    _paper(b, [(-0.07, 0.03, 0.1), (-0.11, 0.03, 0.17), (-0.15, 0.03, 0.25)], 0.21)
    _paper(b, [(0.14, 0.03, 0.052), (0.19, 0.03, 0.05), (0.21, 0.03, 0.02)], 0.21)
    b.box((0.05, 0.26, 0.01), (-0.06, 0.03, 0.1), "charcoal", bevel=0.003)
    size = ((0.37, 0.33, 0.175), (0.39, 0.34, 0.24))[variant]
    return varied(b, rng, size, f"a {style} fax machine", style)


@recipe("router or modem", 3, hulls=1, name="office_machines.router_or_modem")
def router_or_modem(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Black router with two bent aerials, white one with three, upright modem with lights."""
    b = MeshBuilder(roughness=0.4)
    style = ("black", "white", "upright")[variant]
    body: Color = ("charcoal", "white", "black")[variant]
    if style == "upright":
        b.box((0.05, 0.16, 0.19), (0, 0, 0.012), body, bevel=0.012)
        b.box((0.1, 0.12, 0.014), color="charcoal", bevel=0.004)
        for k in range(6):
            b.cylinder(
                0.0045, 0.004, (0.024, 0, 0.06 + 0.02 * k), "light green" if k != 3 else "amber", (0, 90, 0), segments=8
            )
        for k in range(8):
            b.box((0.03, 0.1, 0.003), (0, 0, 0.2 + 0.0004 * k), "dark grey")
    else:
        b.box((0.14, 0.2, 0.028), (0, 0, 0.004), body, bevel=0.008, taper=(0.94, 0.96))
        for k in range(7):
            b.box((0.006, 0.1, 0.002), (-0.045 + 0.014 * k, 0, 0.0315), shade(body, 0.6))
        for k in range(5):
            b.cylinder(
                0.0035,
                0.004,
                (0.067, -0.04 + 0.02 * k, 0.017),
                "light green" if k else "light blue",
                (0, 90, 0),
                segments=8,
            )
        for x in (-0.05, 0.05):
            for y in (-0.08, 0.08):
                b.cylinder(0.008, 0.006, (x, y, 0), "black", segments=8)
        for k in range(4):
            b.box((0.006, 0.016, 0.012), (-0.069, -0.05 + 0.022 * k, 0.01), "signal yellow" if k < 3 else "blue")
        count = 2 if style == "black" else 3
        high = 0.045 if style == "black" else 0.14
        for k in range(count):
            y = 0.17 * (k / (count - 1) - 0.5)
            b.cylinder(0.008, 0.016, (-0.075, y, 0.018), body, (0, -90, 0), segments=8)
            lean = (k / (count - 1) - 0.5) * 0.03
            b.beam(
                (-0.086, y, 0.014),
                (-0.088 if high > 0.1 else -0.03, y + lean, 0.02 + high),
                0.016,
                0.008,
                body,
                bevel=0.003,
            )
    size = ((0.145, 0.2, 0.061), (0.17, 0.23, 0.17), (0.1, 0.16, 0.195))[variant]
    return varied(b, rng, size, f"a {style} network router", style)


@recipe("other electronics", 3, name="office_machines.other_electronics")
def other_electronics(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Game console with its controller, power bank with cable and charger, remote-controlled toy-like receiver."""
    b = MeshBuilder(roughness=0.4)
    style = ("game console", "remote control", "bench meter")[variant]
    if style == "game console":
        _game_console(b)
    elif style == "remote control":
        _remote_control(b)
    else:
        _bench_meter(b)
    size = ((0.162, 0.24, 0.12), (0.05, 0.19, 0.024), (0.24, 0.32, 0.22))[variant]
    return varied(b, rng, size, f"a {style}", style)


def _game_console(b: MeshBuilder) -> None:
    """A console with its controller on a cable."""
    b.box((0.11, 0.24, 0.045), (-0.03, 0, 0.004), "light grey", bevel=0.006)
    b.box((0.1, 0.16, 0.045), (-0.03, 0, 0.05), "charcoal", bevel=0.01)
    b.box((0.05, 0.1, 0.05), (-0.03, 0, 0.076), "dark grey", bevel=0.006)
    sticker, pen = paint.canvas((48, 20), "signal red")
    paint.text(pen, "JUMPER", (3, 3, 45, 17), "white", 0.05)
    b.panel(sticker, (-0.0035, 0, 0.105), 0.085, 0.034)
    for y in (-0.09, 0.09):
        b.box((0.006, 0.035, 0.015), (0.025, y, 0.016), "black")
    b.cylinder(0.004, 0.004, (0.025, 0.04, 0.03), "light red", (0, 90, 0), segments=8)
    with b.frame((0.075, 0, 0.004), (0, 0, 8)):
        b.extrude(rounded(0.055, 0.15, 0.024), 0.02, color="off white")
        for turn in (0, 90):
            b.box((0.03, 0.01, 0.006), (0, -0.045, 0.02), "black", (0, 0, turn))
        for k, ink in enumerate(("signal red", "signal yellow", "green", "blue")):
            a = np.radians(90 * k)
            b.cylinder(0.006, 0.006, (0.011 * np.cos(a), 0.045 + 0.011 * np.sin(a), 0.02), ink, segments=8)
        for y in (-0.01, 0.012):
            b.box((0.006, 0.014, 0.004), (0.012, y, 0.02), "grey")
    b.tube(curve([(0.05, 0.0, 0.012), (0.055, 0.1, 0.005), (0.03, 0.09, 0.02)], 4), 0.003, "black", sides=5)


def _remote_control(b: MeshBuilder) -> None:
    """A remote control with its keys up."""
    with b.frame((0, 0, 0.0), (0, 0, 0)):
        b.box((0.05, 0.19, 0.02), color="charcoal", bevel=0.006)
        b.cylinder(0.009, 0.004, (0.0, -0.082, 0.0195), "signal red", segments=12)
        for r in range(4):
            for c in range(3):
                b.box((0.009, 0.011, 0.003), (0.014 * (c - 1), -0.058 + 0.016 * r, 0.0195), "light grey")
        b.ring(0.014, 0.004, (0, 0.025, 0.02), "aluminium", segments=18, sides=5)
        b.cylinder(0.007, 0.004, (0, 0.025, 0.0195), "blue", segments=12)
        for k, ink in enumerate(("signal red", "green", "signal yellow", "blue")):
            b.box((0.008, 0.008, 0.003), (-0.018 + 0.012 * k, 0.06, 0.0195), ink)
        b.box((0.03, 0.006, 0.008), (0, -0.096, 0.006), "dark red")


def _bench_meter(b: MeshBuilder) -> None:
    """An oscilloscope with a handle."""
    b.box((0.2, 0.26, 0.14), (0, 0, 0.014), "beige", bevel=0.008)
    screen, pen = paint.canvas((64, 52), "#10281c")
    for k in range(1, 8):
        pen.line((8 * k, 0, 8 * k, 52), fill=(36, 74, 52))
        pen.line((0, 7 * k, 64, 7 * k), fill=(36, 74, 52))
    wave = [(x, 26 - 17 * np.sin(x / 5.1)) for x in range(0, 64, 2)]
    pen.line(wave, fill=rgb("light green"), width=2)
    b.box((0.008, 0.14, 0.115), (0.1, -0.045, 0.026), "dark grey", bevel=0.002)
    b.panel(screen, (0.1055, -0.045, 0.0835), 0.122, 0.098)
    for r in range(3):
        for c in range(2):
            b.cylinder(
                0.012 if r else 0.017,
                0.014,
                (0.1, 0.055 + 0.042 * c, 0.045 + 0.04 * r),
                "charcoal",
                (0, 90, 0),
                segments=12,
            )
    b.tube([(0, -0.13, 0.1), (0.0, -0.13, 0.18), (0, 0.13, 0.18), (0, 0.13, 0.1)], 0.007, "black", sides=6)
    for x in (-0.07, 0.07):
        for y in (-0.1, 0.1):
            b.cylinder(0.012, 0.016, (x, y, 0), "black", segments=8)


@recipe("stapler", 2, hulls=1, name="office_machines.stapler")
def stapler(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Black desk stapler, long-armed red one; its mouth is at +x."""
    b = MeshBuilder(roughness=0.4)
    style = ("black", "red long-armed")[variant]
    body: Color = ("charcoal", "signal red")[variant]
    long = 0.0 if variant == 0 else 0.1
    b.extrude(rounded(0.15 + long, 0.036, 0.012), 0.007, color="black")
    b.box((0.02, 0.014, 0.002), (0.06 + long / 2, 0, 0.007), "aluminium")
    with b.frame((-0.06 - long / 2, 0, 0.022), (0, -9, 0)):
        b.box((0.13 + long, 0.016, 0.012), (0.065 + long / 2, 0, 0.0), "aluminium")
    with b.frame((-0.06 - long / 2, 0, 0.03), (0, -12, 0)):
        length = 0.135 + long
        top = curve([(-0.012, 0.0), (-0.012, 0.014), (0.04, 0.017), (length - 0.012, 0.014), (length, 0.004)], 3)
        b.profile([*pairs(top), (length, -0.004), (0.0, -0.004)], 0.03, color=body)
        b.box((0.05, 0.0305, 0.004), (0.06, 0, 0.004), shade(body, 0.7))
    for s in (-1, 1):
        b.box((0.032, 0.003, 0.038), (-0.055 - long / 2, 0.0165 * s, 0.005), "grey", bevel=0.001)
    b.cylinder(0.004, 0.038, (-0.055 - long / 2, 0.019, 0.032), "aluminium", (90, 0, 0), segments=8)
    size = ((0.147, 0.038, 0.06), (0.27, 0.045, 0.075))[variant]
    return varied(b, rng, size, f"a {style} stapler", style)


@recipe("envelope", 3, hulls=1, name="office_machines.envelope")
def envelope(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Addressed white letter with a stamp, airmail letter with its striped rim, brown one seen from its flap."""
    b = MeshBuilder(roughness=0.9)
    style = ("white letter", "airmail letter", "brown envelope")[variant]
    paper: Color = ("white", "off white", "cardboard")[variant]
    image, pen = paint.canvas((222, 116), paper)
    if style == "brown envelope":
        for a, c in (((0, 0), (111, 66)), ((222, 0), (111, 66)), ((0, 116), (86, 52)), ((222, 116), (136, 52))):
            pen.line((*a, *c), fill=shade(paper, 0.7), width=2)
        pen.ellipse((98, 50, 124, 76), fill=rgb("dark red"))
        pen.ellipse((104, 56, 118, 70), outline=rgb("red"), width=2)
    else:
        if style == "airmail letter":
            for k in range(0, 340, 24):
                for j, ink in ((0, "signal red"), (12, "signal blue")):
                    pen.polygon([(k + j - 110, 116), (k + j - 102, 116), (k + j + 8, 0), (k + j, 0)], fill=rgb(ink))
            pen.rectangle((8, 8, 213, 107), fill=rgb(paper))
            paint.text(pen, "PAR AVION", (12, 88, 70, 102), "signal blue")
        pen.rectangle((178, 12, 208, 48), fill=rgb("light blue"), outline=rgb("blue"))
        pen.ellipse((184, 18, 202, 36), fill=rgb("signal red"))
        for r in (12, 17):
            pen.ellipse((166 - r, 30 - r, 166 + r, 30 + r), outline=(60, 60, 60))
        for k, words in enumerate(("M. ROSSI", "12 HARBOUR LANE", "4051 PORTVALE")):
            paint.text(pen, words, (84, 56 + 15 * k, 84 + 8 * len(words), 68 + 15 * k), "dark blue")
        for k in range(3):
            pen.line((14, 18 + 7 * k, 60 - 10 * k, 18 + 7 * k), fill=(110, 110, 110))
    # The flap's fold gives the back its relief; the thickness is that of a letter of two sheets.
    b.extrude(rounded(0.222, 0.115, 0.002, 2), 0.0018, (0, 0, 0.0575), paper, (90, 0, 90))
    b.extrude(
        [(-0.11, 0.0555), (0.11, 0.0555), (0.012, -0.012), (-0.012, -0.012)],
        0.0004,
        (-0.0004, 0, 0.0575),
        shade(paper, 0.94),
        (90, 0, 90),
    )
    b.panel(image, (0.002, 0, 0.0575), 0.222, 0.115)
    size = ((0.0025, 0.222, 0.115), (0.002, 0.229, 0.162), (0.006, 0.32, 0.225))[variant]
    return varied(b, rng, size, f"a {style}", style, jitter=0.004)
