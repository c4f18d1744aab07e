"""Sound and image devices: radios, record and CD players, loudspeakers, telephones, megaphones, cameras."""

import numpy as np

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, rgb, shade
from ....meshes.recipe import recipe
from ...shared.outlines import curve, desk_panel, level, rounded
from ...shared.sizes import varied


def loudspeaker(b: MeshBuilder, at: tuple[float, float, float], radius: float, cone: Color = "charcoal") -> None:
    """A round membrane in its ring, looking along +x."""
    b.cylinder(radius, 0.006, at, "black", (0, 90, 0), segments=14)
    with b.frame((at[0] + 0.004, at[1], at[2]), (0, 90, 0)):
        b.ring(radius * 0.86, radius * 0.12, (0, 0, 0), "dark grey", segments=16, sides=4)
        b.lathe([(radius * 0.78, 0.0), (radius * 0.76, 0.005), (radius * 0.3, 0.003)], color=cone, segments=14)
        b.ball((radius * 0.3, radius * 0.3, radius * 0.18), (0, 0, 0.003), "grey", segments=8, rings=4)


@recipe("stereo sound system", 3, name="sound_machines.stereo_sound_system")
def stereo_sound_system(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Components between two boxes, one tall floor loudspeaker, a portable boom box."""
    b = MeshBuilder(roughness=0.5)
    style = ("component set", "floor loudspeaker", "boom box")[variant]
    if style == "component set":
        for y in (-0.175, 0.175):
            b.box((0.28, 0.145, 0.44), (0, y, 0), "wood", bevel=0.006)
            b.box((0.006, 0.13, 0.42), (0.14, y, 0.01), "black")
            loudspeaker(b, (0.143, y, 0.13), 0.056, "amber")
            loudspeaker(b, (0.143, y, 0.27), 0.04)
            b.ball(0.018, (0.146, y, 0.37), "light grey", segments=10, rings=5)
        for k, z in enumerate((0.0, 0.11, 0.22, 0.33)):
            b.box((0.28, 0.195, 0.106), (0, 0, z), "aluminium", bevel=0.004)
            b.box((0.004, 0.11, 0.035), (0.141, -0.025, z + 0.055), "black")
            b.box(
                (0.005, 0.08, 0.012), (0.142, -0.025, z + 0.068), ("light green", "amber", "light blue", "light red")[k]
            )
            b.cylinder(0.026 if k == 3 else 0.012, 0.02, (0.14, 0.064, z + 0.06), "grey", (0, 90, 0), segments=14)
            for j in range(5):
                b.box((0.006, 0.016, 0.008), (0.141, -0.07 + 0.028 * j, z + 0.02), "charcoal")
    elif style == "floor loudspeaker":
        b.box((0.32, 0.25, 1.0), (0, 0, 0.03), "dark wood", bevel=0.012)
        b.box((0.36, 0.3, 0.03), color="black", bevel=0.006)
        b.box((0.008, 0.23, 0.97), (0.16, 0, 0.045), "black", bevel=0.003)
        for z, r in ((0.2, 0.1), (0.44, 0.1), (0.68, 0.075), (0.85, 0.035)):
            loudspeaker(b, (0.165, 0, z), r, "amber" if r > 0.04 else "charcoal")
    else:
        b.box((0.16, 0.62, 0.32), color="charcoal", bevel=0.016)
        for y in (-0.2, 0.2):
            loudspeaker(b, (0.08, y, 0.13), 0.1)
            b.ring(0.105, 0.008, (0.083, y, 0.13), "aluminium", (0, 90, 0), segments=20, sides=5)
        b.box((0.01, 0.16, 0.1), (0.08, 0, 0.06), "aluminium", bevel=0.003)
        b.box((0.004, 0.12, 0.06), (0.086, 0, 0.08), "dark glass")
        for y in (-0.028, 0.028):
            b.cylinder(0.014, 0.004, (0.086, y, 0.11), "white", (0, 90, 0), segments=10)
        b.box((0.006, 0.5, 0.045), (0.08, 0, 0.255), "light grey")
        b.box((0.004, 0.005, 0.04), (0.085, 0.08, 0.258), "signal red")
        b.tube([(0, -0.25, 0.3), (0, -0.25, 0.4), (0, 0.25, 0.4), (0, 0.25, 0.3)], 0.012, "aluminium", sides=8)
        for k in range(6):
            b.box((0.03, 0.03, 0.012), (0.04, -0.1 + 0.04 * k, 0.32), "light grey")
        b.rod((-0.06, 0.25, 0.3), (-0.08, -0.05, 0.55), 0.004, "aluminium", sides=5)
    size = ((0.32, 0.5, 0.46), (0.34, 0.36, 1.05), (0.18, 0.6, 0.42))[variant]
    return varied(b, rng, size, f"a stereo sound system, {style}", style)


@recipe("radio receiver", 3, hulls=1, name="sound_machines.radio_receiver")
def radio_receiver(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Portable set with handle and aerial, wooden set with cloth and a dial, small red one."""
    b = MeshBuilder(roughness=0.5)
    style = ("portable", "wooden", "pocket")[variant]
    scale, pen = paint.canvas((96, 28), "lamp" if variant == 1 else "off white")
    for k in range(15):
        pen.line((6 + 6 * k, 4, 6 + 6 * k, 10 + 4 * (k % 2)), fill=(40, 40, 40))
    paint.text(pen, "88  92  96  100  104  108", (4, 16, 92, 26), "black")
    pen.line((58, 2, 58, 26), fill=rgb("signal red"), width=2)
    if style == "wooden":
        arch = [
            (-0.2, 0.0),
            (0.2, 0.0),
            *[(0.2 * np.cos(a), 0.16 + 0.14 * np.sin(a)) for a in np.linspace(0, np.pi, 13)],
        ]
        b.extrude(arch, 0.2, (-0.1, 0, 0.015), "wood", (90, 0, 90))
        inner = [(0.12 * np.cos(a), 0.19 + 0.1 * np.sin(a)) for a in np.linspace(0, np.pi, 9)]
        b.extrude([*inner, (-0.12, 0.14), (0.12, 0.14)][::-1], 0.006, (0.1, 0, 0.012), "beige", (90, 0, 90))
        for y in (-0.06, 0.0, 0.06):
            b.box((0.012, 0.014, 0.12), (0.104, y, 0.155), "dark wood")
        b.panel(scale, (0.102, 0, 0.115), 0.2, 0.05)
        ys, z, radius, ink = (-0.13, 0.0, 0.13), 0.055, 0.022, "dark wood"
        b.box((0.21, 0.42, 0.02), color="dark wood", bevel=0.006)
    else:
        body: Color = "charcoal" if style == "portable" else "signal red"
        b.box((0.1, 0.27, 0.145), color=body, bevel=0.014)
        loudspeaker(b, (0.05, -0.066, 0.07), 0.052, "dark grey")
        b.ring(0.056, 0.004, (0.052, -0.066, 0.07), "aluminium", (0, 90, 0), segments=20, sides=4)
        b.panel(scale, (0.0515, 0.06, 0.105), 0.115, 0.036)
        b.rod((-0.03, 0.12, 0.14), (-0.03, 0.22, 0.3), 0.0022, "aluminium", sides=5)
        b.ball(0.005, (-0.03, 0.22, 0.3), "aluminium", segments=6, rings=4)
        if style == "portable":
            b.tube([(0, -0.12, 0.12), (0, -0.12, 0.18), (0, 0.1, 0.18), (0, 0.1, 0.12)], 0.007, "black", sides=6)
        ys, z, radius, ink = (0.03, 0.09), 0.045, 0.02, "aluminium"
    for y in ys:
        b.cylinder(
            radius, 0.016, (0.1 if variant == 1 else 0.05, y, z), ink, (0, 90, 0), top_radius=radius * 0.85, segments=14
        )
        b.box((0.002, 0.003, radius * 0.8), (0.1165 if variant == 1 else 0.0665, y, z), "white")
    size = ((0.12, 0.27, 0.175), (0.2, 0.4, 0.3), (0.07, 0.19, 0.13))[variant]
    return varied(b, rng, size, f"a {style} radio receiver", style)


@recipe("record player", 3, name="sound_machines.record_player")
def record_player(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Wooden deck, black deck with its lid up, suitcase player; the tone arm is at the right."""
    b = MeshBuilder(roughness=0.4)
    style = ("wooden", "lidded", "suitcase")[variant]
    body: Color = ("wood", "black", "teal")[variant]
    b.box((0.35, 0.43, 0.07), (0, 0, 0.022), body, bevel=0.008)
    b.box((0.34, 0.42, 0.006), (0, 0, 0.09), "charcoal" if variant == 0 else "dark grey", bevel=0.002)
    for x in (-0.13, 0.13):
        for y in (-0.17, 0.17):
            b.cylinder(0.022, 0.024, (x, y, 0), "black", segments=10)
    b.cylinder(0.153, 0.012, (0.005, -0.04, 0.096), "aluminium", segments=32)
    record, pen = paint.canvas((128, 128), "#141416")
    for r in range(26, 62, 3):
        pen.ellipse((64 - r, 64 - r, 64 + r, 64 + r), outline=(44, 44, 48))
    pen.ellipse((42, 42, 86, 86), fill=rgb(("signal red", "amber", "signal yellow")[variant]))
    pen.ellipse((61, 61, 67, 67), fill=(230, 230, 230))
    paint.text(pen, "SIDE A", (46, 68, 82, 80), "black")
    b.cylinder(0.15, 0.004, (0.005, -0.04, 0.108), "#141416", segments=32)
    desk_panel(b, record, (0.005, -0.04, 0.1125), 0.207, 0.207)
    b.cylinder(0.004, 0.018, (0.005, -0.04, 0.11), "aluminium", segments=8)
    b.cylinder(0.028, 0.02, (-0.11, 0.16, 0.096), "grey", segments=14)
    b.cylinder(0.012, 0.035, (-0.11, 0.16, 0.1), "aluminium", segments=10)
    b.tube(
        [(-0.15, 0.17, 0.134), (-0.11, 0.16, 0.134), (0.03, 0.11, 0.13), (0.07, 0.065, 0.124)],
        0.004,
        "aluminium",
        sides=6,
    )
    b.cylinder(0.013, 0.03, (-0.17, 0.172, 0.134), "grey", (0, 90, -16), segments=10)
    b.box((0.04, 0.018, 0.01), (0.078, 0.056, 0.117), "black", turn_deg=(0, 0, -40), bevel=0.002)
    for x in (0.09, 0.13):
        b.cylinder(0.014, 0.012, (x, 0.18, 0.096), "aluminium", segments=12)
    if variant > 0:
        with b.frame((-0.172, 0, 0.092), (0, -18, 0)):
            b.box((0.012 if variant == 1 else 0.05, 0.43, 0.3), color="glass" if variant == 1 else body, bevel=0.005)
            if variant == 2:
                b.box((0.004, 0.38, 0.25), (0.026, 0, 0.025), "cream")
    if variant == 2:
        for y in (-0.15, 0.15):
            b.box((0.005, 0.09, 0.04), (0.176, y, 0.035), "charcoal")
        b.tube(
            [(0.175, -0.06, 0.06), (0.2, -0.05, 0.06), (0.2, 0.05, 0.06), (0.175, 0.06, 0.06)], 0.006, "brown", sides=6
        )
    size = ((0.352, 0.42, 0.14), (0.4, 0.44, 0.35), (0.38, 0.39, 0.33))[variant]
    return varied(b, rng, size, f"a {style} record player", style)


@recipe("cd player", 2, hulls=1, name="sound_machines.cd_player")
def cd_player(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Hi-fi deck with its tray out and a disc on it; round portable one with its lid open."""
    b = MeshBuilder(roughness=0.3)
    style = ("hi-fi", "portable")[variant]
    disc, pen = paint.canvas((64, 64), "aluminium")
    for k, ink in enumerate(("pink", "light blue", "lime", "light blue", "white", "pink", "amber", "light blue")):
        pen.pieslice((2, 2, 62, 62), 45 * k, 45 * k + 16, fill=rgb(ink))
    pen.ellipse((22, 22, 42, 42), fill=(215, 218, 222))
    pen.ellipse((28, 28, 36, 36), fill=(30, 30, 32))
    if style == "hi-fi":
        b.box((0.2, 0.43, 0.085), (-0.05, 0, 0.014), "black", bevel=0.004)
        b.box((0.012, 0.43, 0.09), (0.05, 0, 0.012), "charcoal", bevel=0.003)
        for x in (-0.12, 0.02):
            for y in (-0.17, 0.17):
                b.cylinder(0.02, 0.016, (x, y, 0), "aluminium", segments=12)
        b.box((0.12, 0.14, 0.014), (0.09, -0.06, 0.052), "dark grey", bevel=0.003)
        b.cylinder(0.059, 0.003, (0.095, -0.06, 0.066), "aluminium", segments=28)
        desk_panel(b, disc, (0.095, -0.06, 0.0695), 0.082, 0.082)
        b.box((0.004, 0.13, 0.03), (0.057, 0.1, 0.062), "dark glass")
        screen, draw = paint.canvas((48, 14), "#0c1416")
        paint.text(draw, "CD 03 12:47", (2, 1, 46, 13), "light green")
        b.panel(screen, (0.0595, 0.1, 0.077), 0.12, 0.026)
        for k in range(6):
            b.box((0.008, 0.018, 0.009), (0.056, -0.01 + 0.028 * k, 0.033), "light grey")
        b.cylinder(0.018, 0.014, (0.056, 0.185, 0.04), "aluminium", (0, 90, 0), segments=14)
        b.box((0.006, 0.02, 0.02), (0.056, -0.19, 0.045), "signal red")
    else:
        b.cylinder(0.07, 0.022, color="aluminium", segments=32)
        b.cylinder(0.064, 0.003, (0, 0, 0.022), "charcoal", segments=32)
        b.cylinder(0.06, 0.003, (0, 0, 0.026), "aluminium", segments=28)
        desk_panel(b, disc, (0, 0, 0.0295), 0.084, 0.084)
        b.cylinder(0.009, 0.008, (0, 0, 0.028), "black", segments=12)
        with b.frame((-0.066, 0, 0.026), (0, -65, 0)):
            b.cylinder(0.068, 0.006, (0.068, 0, 0), "light blue", segments=32)
            b.cylinder(0.045, 0.002, (0.068, 0, -0.002), "dark glass", segments=24)
        for k in range(3):
            b.box((0.012, 0.014, 0.006), (0.066, -0.02 + 0.02 * k, 0.02), "black", bevel=0.002)
    size = ((0.265, 0.4, 0.102), (0.142, 0.15, 0.14))[variant]
    return varied(b, rng, size, f"a {style} CD player with a disc", style)


@recipe("camera", 3, hulls=1, name="sound_machines.camera")
def camera(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Black single-lens reflex, silver rangefinder with leather, instant camera; the lens looks along +x."""
    b = MeshBuilder(roughness=0.4)
    style = ("reflex", "rangefinder", "instant")[variant]
    if style == "instant":
        b.profile(
            [(-0.05, 0), (0.06, 0), (0.06, 0.03), (0.03, 0.045), (0.03, 0.1), (-0.02, 0.11), (-0.05, 0.06)],
            0.11,
            color="off white",
        )
        b.box((0.003, 0.11, 0.018), (0.0605, 0, 0.008), "black")
        for k, ink in enumerate(("signal red", "orange", "signal yellow", "green", "blue")):
            b.box((0.033, 0.006, 0.002), (0.045, -0.014 + 0.007 * k, 0.0375), ink, (0, 26.6, 0))
        radius, z, y0 = 0.028, 0.072, 0.0
        b.box((0.006, 0.04, 0.02), (0.03, -0.03, 0.085), "lamp")
        b.box((0.006, 0.02, 0.016), (0.03, 0.038, 0.083), "dark glass")
        b.cylinder(0.007, 0.006, (0.03, 0.042, 0.055), "signal red", (0, 90, 0), segments=10)
        depth, at = 0.018, 0.03
    else:
        skin, metal = ("black", "charcoal") if style == "reflex" else ("brown", "aluminium")
        b.extrude(rounded(0.036, 0.128, 0.012), 0.045, (0, 0, 0.012), skin)
        b.extrude(rounded(0.036, 0.128, 0.012), 0.012, color=metal)
        b.extrude(rounded(0.036, 0.128, 0.012), 0.016, (0, 0, 0.057), metal)
        radius, z, y0, at = 0.031, 0.038, 0.004, 0.018
        depth = 0.05 if style == "reflex" else 0.03
        if style == "reflex":
            b.convex(
                [
                    (x, y * s, h)
                    for s in (-1, 1)
                    for x, y, h in (
                        (-0.02, 0.026, 0.072),
                        (0.02, 0.026, 0.072),
                        (-0.016, 0.014, 0.095),
                        (0.016, 0.012, 0.092),
                    )
                ],
                "charcoal",
            )
            b.box((0.022, 0.03, 0.066), (0.016, -0.05, 0.002), "black", bevel=0.008)
            b.box((0.014, 0.016, 0.004), (0, 0, 0.0945), "aluminium")
        else:
            for y, w in ((0.0, 0.016), (-0.045, 0.022), (0.035, 0.01)):
                b.box((0.003, w, 0.01), (0.018, y, 0.06), "dark glass")
            b.cylinder(0.011, 0.01, (0, 0.045, 0.073), "aluminium", segments=14)
        b.cylinder(0.006, 0.008, (0.006, -0.05, 0.072), "signal red" if variant == 1 else "aluminium", segments=10)
        b.cylinder(0.012, 0.008, (0, 0.045 if variant == 0 else -0.03, 0.072), "grey", segments=14)
    with b.frame((at, y0, z), (0, 90, 0)):
        ring: Color = "aluminium" if style == "rangefinder" else "black"
        b.lathe(
            [(radius, 0), (radius, depth * 0.5), (radius * 0.92, depth * 0.55), (radius * 0.92, depth)],
            color=ring,
            segments=24,
        )
        b.ring(radius * 0.93, 0.0022, (0, 0, depth * 0.3), "grey", segments=20, sides=4)
        b.ring(radius * 0.84, radius * 0.12, (0, 0, depth), ring, segments=24, sides=5)
        b.ball((radius * 0.72, radius * 0.72, radius * 0.26), (0, 0, depth * 0.96), "#26324a", segments=16, rings=6)
        b.ball(
            (radius * 0.2, radius * 0.14, 0.002),
            (-radius * 0.25, radius * 0.2, depth * 0.96 + radius * 0.22),
            "white",
            segments=8,
            rings=4,
        )
    size = ((0.077, 0.129, 0.093), (0.062, 0.135, 0.082), (0.108, 0.116, 0.1))[variant]
    return varied(b, rng, size, f"a {style} camera", style)


@recipe("corded phone", 3, name="sound_machines.corded_phone")
def corded_phone(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Red dial telephone, office telephone with keys, black dial one; the caller sits at +x."""
    b = MeshBuilder(roughness=0.3)
    style = ("red dial", "office", "black dial")[variant]
    body: Color = ("red", "light grey", "black")[variant]
    if style == "office":
        b.profile([(-0.1, 0), (0.1, 0), (0.1, 0.02), (-0.06, 0.075), (-0.1, 0.075)], 0.17, color=body)
        with b.frame((0.02, 0, 0.048), (0, 19, 0)):
            for k in range(12):
                b.box(
                    (0.014, 0.018, 0.006),
                    (-0.01 + 0.022 * (k // 3), 0.026 * (k % 3 - 1) + 0.025, 0),
                    "white",
                    bevel=0.001,
                )
            b.box((0.03, 0.09, 0.004), (-0.048, 0.025, 0), "#7c9a78")
        along, high, y0 = 0.0, 0.082, -0.055
    else:
        rows = ((0.0, 0.1, 0.085), (0.02, 0.098, 0.083), (0.07, 0.06, 0.05), (0.08, 0.055, 0.045))
        b.loft([level(z, x, y, x=-0.3 * z, power=4, count=20) for z, x, y in rows], body)
        dial, pen = paint.canvas((80, 80), "white")
        for k in range(10):
            a = np.radians(30 - 30 * k)
            x, y = 40 + 28 * np.cos(a), 40 - 28 * np.sin(a)
            paint.text(pen, str((k + 1) % 10), (x - 7, y - 8, x + 7, y + 8), "black")
        with b.frame((0.062, 0, 0.046), (0, 51, 0)):
            b.cylinder(0.045, 0.01, (0, 0, 0), "white", segments=24)
            desk_panel(b, dial, (0, 0, 0.0105), 0.062, 0.062)
            b.ring(0.041, 0.005, (0, 0, 0.012), "aluminium", segments=20, sides=4)
            b.cylinder(0.014, 0.014, (0, 0, 0.003), "aluminium", segments=14)
        for y in (-0.045, 0.045):
            b.box((0.04, 0.018, 0.025), (-0.025, y, 0.078), body, bevel=0.005)
        along, high, y0 = -0.025, 0.11, 0.0
    turn = 0 if style != "office" else 90
    with b.frame((along, y0, high), (0, 0, turn)):
        b.tube(
            curve([(0, -0.085, 0.0), (0, -0.05, 0.018), (0, 0.05, 0.018), (0, 0.085, 0.0)], 3),
            0.0125,
            shade(body, 0.9),
            sides=8,
        )
        for y in (-0.085, 0.085):
            b.cylinder(0.028, 0.02, (0, y, -0.014), shade(body, 0.9), top_radius=0.022, segments=14)
    coil = [(0.06 - 0.002 * k + 0.006 * np.cos(2.1 * k), 0.105 + 0.008 * np.sin(2.1 * k), 0.01) for k in range(36)]
    b.tube(coil, 0.0025, "black", sides=4)
    size = ((0.205, 0.19, 0.102), (0.22, 0.19, 0.1), (0.215, 0.2, 0.14))[variant]
    return varied(b, rng, size, f"a {style} telephone", style)


@recipe("megaphone", 3, name="sound_machines.megaphone")
def megaphone(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Horn along +x with a pistol grip below and a strap: white and red, grey and blue, yellow."""
    b = MeshBuilder(roughness=0.4)
    style = ("red and white", "grey and blue", "yellow")[variant]
    horn, trim = (("white", "signal red"), ("light grey", "signal blue"), ("signal yellow", "charcoal"))[variant]
    z = 0.15
    with b.frame((-0.08, 0, z), (0, 90, 0)):
        b.lathe(
            [
                (0.032, 0.0),
                (0.036, 0.04),
                (0.05, 0.12),
                (0.074, 0.2),
                (0.1, 0.24),
                (0.092, 0.24),
                (0.04, 0.11),
                (0.0, 0.1),
            ],
            color=horn,
            segments=26,
        )
        b.ring(0.1, 0.006, (0, 0, 0.24), trim, segments=26, sides=6)
        b.lathe([(0.03, 0.1), (0.026, 0.18), (0.0, 0.19)], color=shade(horn, 0.8), segments=14)
        b.lathe([(0.03, -0.07), (0.044, -0.065), (0.044, -0.005), (0.034, 0.002)], color=trim, segments=18)
        b.ring(0.026, 0.006, (0, 0, -0.072), "black", segments=14, sides=5)
    b.beam((-0.01, 0, 0.12), (-0.03, 0, 0.0), 0.032, 0.038, trim, bevel=0.008)
    b.box((0.02, 0.016, 0.03), (0.01, 0, 0.07), "black", turn_deg=(0, 8, 0), bevel=0.004)
    b.tube(
        curve([(-0.12, 0.04, z), (-0.1, 0.1, z - 0.06), (-0.02, 0.09, 0.03), (0.04, 0.05, z - 0.02)], 4),
        0.004,
        "black",
        sides=5,
    )
    size = ((0.34, 0.212, 0.235), (0.26, 0.165, 0.19), (0.42, 0.255, 0.29))[variant]
    return varied(b, rng, size, f"a {style} megaphone", style)
