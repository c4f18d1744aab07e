"""Tools of yards and building sites: ladders, shovels, forks, toolboxes, crutches, and machines with a motor."""

import numpy as np

from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, shade
from ....meshes.recipe import recipe
from ...shared.outlines import curve, ellipse, pairs, section
from ...shared.sizes import varied
from ...vehicle.wheels import rim_image, wheel


@recipe("ladder", 3, name="yard_tools.ladder")
def ladder(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Aluminium step ladder, timber double ladder, single rung ladder; climbers come from +x."""
    b = MeshBuilder(roughness=0.5)
    style = ("step ladder", "timber double ladder", "rung ladder")[variant]
    if style == "rung ladder":
        for y in (-0.19, 0.19):
            b.box((0.07, 0.028, 3.3), (0, y, 0.03), "aluminium")
            b.box((0.085, 0.04, 0.06), (0, y, 0.0), "black", bevel=0.008)
        for k in range(11):
            b.rod((0, -0.19, 0.28 + 0.28 * k), (0, 0.19, 0.28 + 0.28 * k), 0.016, "light grey", sides=8)
    else:
        timber = style == "timber double ladder"
        rail: Color = "light wood" if timber else "aluminium"
        top, spread = 2.0, 0.36
        for s in (-1, 1):
            for side in (-1, 1):
                y = s * (0.22 if side > 0 else 0.19)
                b.beam((side * spread, y * 1.18, 0.0), (side * 0.05, y * 0.86, top), 0.032, 0.055, rail)
                if not timber:
                    b.box((0.07, 0.05, 0.05), (side * spread, y * 1.18, 0), "black", bevel=0.008)
            b.rod((0.2, s * 0.2, 0.95), (-0.2, s * 0.19, 0.95), 0.006, "grey", sides=5)
        for k in range(7):
            share = (k + 0.8) / 7.6
            x, width = spread + (0.05 - spread) * share, 2 * 0.22 * (1.18 + (0.86 - 1.18) * share)
            b.box((0.09, width, 0.025), (x - 0.01, 0, top * share), rail if timber else "light grey")
            if timber or k in (1, 3, 5):
                b.box((0.03 if not timber else 0.06, width * 0.88, 0.02), (-x, 0, top * share), rail)
        b.box((0.22, 0.42, 0.05), (0, 0, top - 0.02), "orange" if not timber else "dark wood", bevel=0.01)
        if not timber:
            b.tube(
                [(-0.05, -0.2, top), (-0.06, -0.2, 2.4), (-0.06, 0.2, 2.4), (-0.05, 0.2, top)],
                0.014,
                "aluminium",
                sides=6,
            )
    size = ((0.51, 0.49, 2.2), (0.95, 0.55, 1.8), (0.075, 0.42, 3.3))[variant]
    return varied(b, rng, size, f"a {style}", style)


@recipe("shovel", 3, name="yard_tools.shovel")
def shovel(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Round-point shovel with a T grip, square yellow snow shovel, spade with a D grip; standing on the blade."""
    b = MeshBuilder(roughness=0.6)
    style = ("round-point shovel", "snow shovel", "spade")[variant]
    wide, tall = ((0.115, 0.3), (0.16, 0.32), (0.09, 0.28))[variant]
    steel: Color = ("dark grey", "signal yellow", "galvanised")[variant]
    rows = []
    for share in np.linspace(0, 1, 8):
        half = wide * min(1.0, 0.12 + 1.6 * share) if variant == 0 else wide * (0.97 + 0.03 * share)
        if share > 0.85:
            half *= 0.75
        y = np.linspace(-1, 1, 7)
        hollow = 0.035 * (y**2) + 0.07 * (1 - share) ** 2
        rows.append(np.stack([hollow, half * y, np.full(7, tall * share)], 1))
    grid = np.array(rows)
    front, back = grid, grid - [0.004, 0, 0]
    for side, points in ((1, front), (-1, back[:, ::-1])):
        b.sheet(points, steel if side > 0 else shade(steel, 0.85))
    b.lathe(
        [(0.012, 0.0), (0.021, 0.05), (0.021, 0.2), (0.018, 0.22)],
        (0.002, 0, tall - 0.08),
        shade(steel, 0.9),
        segments=10,
    )
    top = 1.28 if variant < 2 else 1.0
    b.tube([(0.002, 0, tall), (0.002, 0, tall + 0.4), (0.004, 0, top - 0.1)], 0.0165, "wood", sides=8)
    if style == "spade":
        b.tube([(0.004, 0, top - 0.12), (0.004, 0.05, top - 0.03), (0.004, 0.055, top)], 0.01, "wood", sides=6)
        b.tube([(0.004, 0, top - 0.12), (0.004, -0.05, top - 0.03), (0.004, -0.055, top)], 0.01, "wood", sides=6)
    b.rod((0.004, -0.065, top), (0.004, 0.065, top), 0.017, "black" if variant else "dark wood", sides=8)
    b.rod((0.004, 0, top - 0.12), (0.004, 0, top), 0.0166 if variant != 2 else 0.006, "wood", sides=8)
    size = ((0.15, 0.235, 1.35), (0.16, 0.33, 1.3), (0.12, 0.19, 1.0))[variant]
    return varied(b, rng, size, f"a {style}", style)


@recipe("pitchfork", 2, name="yard_tools.pitchfork")
def pitchfork(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Hay fork of four curved tines, digging fork with a D grip; standing on the tines."""
    b = MeshBuilder(roughness=0.6)
    style = ("hay fork", "digging fork")[variant]
    count, wide, tall = ((4, 0.1, 0.34), (4, 0.09, 0.3))[variant]
    bow = 0.06 if variant == 0 else 0.02
    for k in range(count):
        y = wide * (2 * k / (count - 1) - 1)
        path = curve(
            [
                (0, y * 0.25, tall),
                (0.0, y * 0.85, tall - 0.02),
                (-bow * 0.6, y, tall * 0.6),
                (-bow * 0.3, y, tall * 0.25),
                (bow, y, 0.0),
            ],
            3,
        )
        radii = np.linspace(0.007, 0.0065, len(path)) if variant == 0 else np.full(len(path), 0.009)
        radii[-2:] = 0.005, 0.0015
        b.tube(path, radii.tolist(), "charcoal", sides=6)
    b.lathe([(0.01, 0.0), (0.019, 0.04), (0.019, 0.16)], (0, 0, tall - 0.02), "charcoal", segments=10)
    top = 1.48 if variant == 0 else 1.02
    b.tube([(0, 0, tall + 0.05), (0.004, 0, 0.9 * top / 1.48), (0, 0, top)], 0.0165, "light wood", sides=8)
    if variant == 1:
        for s in (-1, 1):
            b.tube(
                [(0, 0, top - 0.05), (0, 0.05 * s, top + 0.04), (0, 0.055 * s, top + 0.1)], 0.01, "light wood", sides=6
            )
        b.rod((0, -0.065, top + 0.1), (0, 0.065, top + 0.1), 0.016, "black", sides=8)
    size = ((0.155, 0.235, 1.45), (0.1, 0.2, 1.05))[variant]
    return varied(b, rng, size, f"a {style}", style)


@recipe("toolbox", 3, name="yard_tools.toolbox")
def toolbox(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Red steel box with an arched handle, black and yellow plastic one, open wooden tray with tools."""
    b = MeshBuilder(roughness=0.5)
    style = ("red steel", "black and yellow plastic", "wooden tray")[variant]
    if style == "wooden tray":
        b.box((0.2, 0.46, 0.02), color="light wood")
        for x in (-0.1, 0.1):
            b.box((0.016, 0.46, 0.1), (x, 0, 0), "wood")
        for y in (-0.23, 0.23):
            b.extrude(
                [(-0.108, 0), (0.108, 0), (0.108, 0.1), (0.03, 0.25), (-0.03, 0.25), (-0.108, 0.1)],
                0.018,
                (0, y + 0.009, 0),
                "wood",
                (90, 0, 0),
            )
        b.rod((0, -0.24, 0.22), (0, 0.24, 0.22), 0.014, "dark wood", sides=8)
        b.beam((-0.05, -0.17, 0.06), (-0.05, 0.1, 0.12), 0.02, 0.02, "light wood")
        b.box((0.03, 0.09, 0.03), (-0.05, 0.12, 0.11), "dark grey", turn_deg=(0, 0, 90), bevel=0.005)
        for k, ink in enumerate(("signal red", "signal yellow", "blue")):
            b.rod((0.05, -0.16 + 0.1 * k, 0.03), (0.07, -0.13 + 0.1 * k, 0.16), 0.013, ink, sides=8)
    else:
        steel = style == "red steel"
        body, lid, metal = ("signal red", "signal red", "aluminium") if steel else ("black", "signal yellow", "black")
        b.box((0.22, 0.46, 0.14), color=body, bevel=0.008)
        if steel:
            b.profile(
                [(-0.115, 0.14), (0.115, 0.14), (0.115, 0.16), (0.05, 0.205), (-0.05, 0.205), (-0.115, 0.16)],
                0.465,
                color=shade(lid, 0.9),
            )
        else:
            b.box((0.235, 0.475, 0.07), (0, 0, 0.14), lid, bevel=0.012)
            b.box((0.16, 0.3, 0.012), (0, 0, 0.205), "black", bevel=0.004)
            b.box((0.006, 0.46, 0.03), (0.112, 0, 0.05), "charcoal")
        for y in (-0.14, 0.14):
            b.box((0.014, 0.05, 0.07), (0.115, y, 0.105), metal, bevel=0.004)
        base = 0.2
        b.tube(
            [(0, -0.12, base), (0, -0.11, base + 0.05), (0, 0.11, base + 0.05), (0, 0.12, base)],
            0.01,
            "black" if not steel else "aluminium",
            sides=6,
        )
        b.rod((0, -0.07, base + 0.05), (0, 0.07, base + 0.05), 0.014, "black", sides=8)
    size = ((0.235, 0.47, 0.25), (0.27, 0.56, 0.28), (0.22, 0.46, 0.27))[variant]
    return varied(b, rng, size, f"a {style} toolbox", style)


@recipe("crutch", 3, name="yard_tools.crutch")
def crutch(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Forearm crutch with cuff and grip, wooden and aluminium underarm crutches; standing."""
    b = MeshBuilder(roughness=0.5)
    style = ("forearm", "wooden underarm", "aluminium underarm")[variant]
    stick, cushion = (("light grey", "charcoal"), ("light wood", "grey"), ("aluminium", "black"))[variant]
    if style == "forearm":
        b.cylinder(0.02, 0.05, (0, 0, 0), "black", top_radius=0.014, segments=12)
        b.rod((0, 0, 0.04), (0, 0, 0.5), 0.009, "light grey", sides=10)
        b.rod((0, 0, 0.36), (0, 0, 0.86), 0.012, "blue", sides=10)
        for k in range(6):
            b.cylinder(0.004, 0.003, (0.008, 0, 0.12 + 0.04 * k), "charcoal", (0, 90, 0), segments=6)
        b.rod((0, 0, 0.84), (-0.035, 0, 1.08), 0.011, "blue", sides=10)
        b.tube(
            curve([(-0.01, 0, 0.85), (0.06, 0, 0.865), (0.125, 0, 0.858)], 4),
            [0.014] * 3 + [0.017] * 4 + [0.016, 0.014],
            "charcoal",
            sides=10,
        )
        arc = np.radians(np.linspace(50, 310, 11))
        low = np.stack([0.01 + 0.045 * np.cos(arc), 0.045 * np.sin(arc), np.full(11, 1.06)], 1)
        for inside in (0, 1):
            grid = np.stack([low, low + [-0.012, 0, 0.09]]) * ([0.95, 0.95, 1] if inside else [1, 1, 1])
            b.sheet(grid, "blue", both_sides=True)
    else:
        for s in (-1, 1):
            path = [(0.015 * s, 0, 0.4), (0.03 * s, 0, 0.5), (0.085 * s, 0, 0.85), (0.1 * s, 0, 1.24)]
            b.tube(curve(path, 3), 0.0115, stick, sides=8)
        b.rod((0, 0, 0.05), (0, 0, 0.62), 0.014, stick, sides=10)
        b.cylinder(0.023, 0.06, (0, 0, 0), "black", top_radius=0.016, segments=12)
        b.rod((-0.085, 0, 0.86), (0.085, 0, 0.86), 0.0165, cushion if variant == 2 else "wood", sides=10)
        pad = [(-0.13, 0, 1.235), (-0.07, 0, 1.25), (0, 0, 1.243), (0.07, 0, 1.25), (0.13, 0, 1.235)]
        b.tube(curve(pad, 3), 0.026, cushion, sides=8)
        for z in (0.44, 0.6):
            b.cylinder(0.005, 0.05, (0, 0.025, z), "aluminium", (90, 0, 0), segments=8)
    size = ((0.2, 0.088, 1.12), (0.27, 0.055, 1.28), (0.24, 0.06, 1.4))[variant]
    return varied(b, rng, size, f"an {style} crutch" if variant == 2 else f"a {style} crutch", style)


@recipe("lawn mower", 3, name="yard_tools.lawn_mower")
def lawn_mower(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Petrol mower with a grass bag, electric one, hand mower with a reel; it drives along +x."""
    b = MeshBuilder(roughness=0.5)
    style = ("petrol", "electric", "reel")[variant]
    body: Color = ("signal red", "green", "orange")[variant]
    rim = rim_image("cap", "light grey", 32)
    if style == "reel":
        for s in (-1, 1):
            wheel(b, (0.42, 0.24 * s, 0.13), 0.13, 0.045, rim, s, 0.7, 16)
        for k in range(5):
            a0 = np.linspace(0, 1.4, 6) + 2 * np.pi * k / 5
            ys = np.linspace(-0.2, 0.2, 6)
            blade = np.stack([np.stack([0.42 + r * np.cos(a0), ys, 0.13 + r * np.sin(a0)], 1) for r in (0.085, 0.105)])
            b.sheet(blade, "galvanised", both_sides=True)
        b.rod((0.42, -0.22, 0.13), (0.42, 0.22, 0.13), 0.012, "dark grey", sides=8)
        b.rod((0.28, -0.23, 0.05), (0.28, 0.23, 0.05), 0.03, "wood", sides=10)
        b.box((0.06, 0.44, 0.03), (0.36, 0, 0.25), body, bevel=0.006)
    else:
        for x, r in ((0.44, 0.095), (-0.06, 0.11)):
            for s in (-1, 1):
                wheel(b, (x, 0.235 * s, r), r, 0.05, rim, s, 0.68, 14)
        sections = [
            section(x, y, h, 0.15, 16, 4.0)
            for x, y, h in ((-0.17, 0.19, 0.06), (-0.1, 0.22, 0.08), (0.44, 0.23, 0.075), (0.56, 0.18, 0.04))
        ]
        b.loft(sections, body)
        if style == "petrol":
            b.box((0.26, 0.24, 0.09), (0.2, 0, 0.2), "charcoal", bevel=0.03)
            b.cylinder(0.09, 0.06, (0.2, 0, 0.28), "black", segments=18)
            b.cylinder(0.05, 0.015, (0.2, 0, 0.34), "light grey", segments=14)
            b.box((0.1, 0.08, 0.08), (0.32, 0.1, 0.22), "aluminium", bevel=0.01)
            b.cylinder(0.03, 0.03, (0.08, 0.08, 0.28), "black", segments=12)
        else:
            b.box((0.32, 0.26, 0.12), (0.2, 0, 0.2), "charcoal", bevel=0.04)
            b.box((0.12, 0.12, 0.06), (0.24, 0, 0.3), shade(body, 0.8), bevel=0.015)
        b.box((0.42, 0.38, 0.28), (-0.4, 0, 0.12), "black", taper=(0.85, 0.9), bevel=0.05)
    hold, low = (-0.8, 1.02), (0.3, 0.16) if style == "reel" else (-0.1, 0.2)
    for s in (-1, 1):
        b.tube(
            [
                (low[0], 0.2 * s, low[1]),
                (-0.34, 0.2 * s, 0.58 if style != "reel" else 0.62),
                (hold[0] + 0.1, 0.19 * s, 0.97),
                (hold[0], 0.16 * s, hold[1]),
            ],
            0.013,
            "charcoal" if style != "reel" else "wood",
            sides=6,
        )
    b.rod((hold[0], -0.17, hold[1]), (hold[0], 0.17, hold[1]), 0.018, "black", sides=8)
    if style != "reel":
        b.tube(
            [(-0.6, -0.19, 0.82), (-0.72, -0.15, 1.02), (-0.72, 0.15, 1.02), (-0.6, 0.19, 0.82)], 0.007, body, sides=5
        )
    size = ((1.42, 0.5, 1.02), (1.3, 0.46, 1.05), (1.25, 0.52, 1.1))[variant]
    return varied(b, rng, size, f"a {style} lawn mower", style)


@recipe("chainsaw", 3, name="yard_tools.chainsaw")
def chainsaw(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Orange petrol saw, green electric saw, yellow one with a long bar; the bar points along +x."""
    b = MeshBuilder(roughness=0.45)
    style = ("orange petrol", "green electric", "yellow long-barred")[variant]
    body: Color = ("safety orange", "green", "signal yellow")[variant]
    bar = (0.4, 0.36, 0.52)[variant]
    b.box((0.26, 0.17, 0.12), (-0.05, 0, 0.03), "charcoal", bevel=0.02)
    b.convex(
        [
            (x, y, z)
            for y in (-0.08, 0.08)
            for x, z in ((-0.19, 0.06), (0.07, 0.06), (0.09, 0.12), (0.04, 0.2), (-0.12, 0.21), (-0.2, 0.16))
        ],
        body,
    )
    outline = [*ellipse(0.028, 0.033, 8, (0.08 + bar - 0.028, 0), -90, 90), (0.06, 0.033), (0.06, -0.033)]
    b.extrude([(x, z + 0.1) for x, z in outline], 0.006, (0, -0.057, 0), "light grey", (90, 0, 0))
    chain = [*ellipse(0.034, 0.039, 9, (0.08 + bar - 0.03, 0), -90, 90), (0.06, 0.039), (0.06, -0.039)]
    loop = np.array([(x, -0.06, z + 0.1) for x, z in chain])
    b.tube(loop, 0.0055, "charcoal", sides=4, closed=True)
    for k in range(int(bar / 0.03)):
        for s in (-1, 1):
            b.box((0.01, 0.008, 0.01), (0.1 + 0.03 * k, -0.06, 0.1 + s * 0.043), "grey", centered=True)
    b.tube(
        curve([(0.06, -0.08, 0.16), (0.06, -0.07, 0.25), (0.05, 0.0, 0.27), (0.045, 0.08, 0.25), (0.03, 0.1, 0.1)], 3),
        0.0115,
        "black",
        sides=7,
    )
    b.convex(
        [(x, y, z) for x, z in ((0.1, 0.17), (0.112, 0.17), (0.14, 0.27), (0.13, 0.27)) for y in (-0.07, 0.05)], "black"
    )
    rear = curve([(-0.17, 0, 0.17), (-0.27, 0, 0.2), (-0.35, 0, 0.17), (-0.35, 0, 0.05), (-0.19, 0, 0.045)], 3)
    b.tube(rear, 0.016, "black", sides=8)
    b.box((0.03, 0.014, 0.03), (-0.26, 0, 0.16), body, bevel=0.004)
    for k in range(5):
        b.box((0.05, 0.004, 0.006), (-0.08, 0.0815, 0.09 + 0.016 * k), "black")
    b.cylinder(0.02, 0.016, (-0.02, 0.08, 0.07), "black", (-90, 0, 0), segments=12)
    size = ((0.8, 0.245, 0.27), (0.74, 0.22, 0.25), (0.95, 0.26, 0.29))[variant]
    return varied(b, rng, size, f"an {style} chainsaw" if variant == 0 else f"a {style} chainsaw", style)


@recipe("electric drill", 3, name="yard_tools.electric_drill")
def electric_drill(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Yellow drill driver on its battery, blue one, grey corded drill; the bit points along +x."""
    b = MeshBuilder(roughness=0.45)
    style = ("yellow cordless", "blue cordless", "corded hammer")[variant]
    body: Color = ("signal yellow", "teal", "light grey")[variant]
    z = 0.18
    rows = ((-0.085, 0.02), (-0.08, 0.032), (0.02, 0.034), (0.045, 0.028))
    with b.frame((0, 0, z), (0, 90, 0)):
        b.lathe([(r, x) for x, r in rows], color=body, segments=16)
        b.lathe([(0.027, 0.045), (0.024, 0.055), (0.022, 0.075), (0.012, 0.095)], color="black", segments=14)
        b.cylinder(0.0045, 0.06, (0, 0, 0.09), "grey", top_radius=0.003, segments=8)
        b.ring(0.031, 0.004, (0, 0, 0.03), "charcoal", segments=16, sides=4)
    grip = curve(
        [(-0.04, 0.17), (0.0, 0.16), (-0.012, 0.09), (-0.022, 0.03), (-0.075, 0.03), (-0.062, 0.1), (-0.06, 0.15)],
        3,
        closed=True,
    )
    b.profile(pairs(grip), 0.04, color=body)
    b.profile(
        [(x * 0.98 - 0.014, v) for x, v in ((-0.01, 0.14), (-0.02, 0.06), (-0.03, 0.06), (-0.02, 0.14))],
        0.042,
        color="black",
    )
    b.box((0.014, 0.018, 0.034), (0.004, 0, 0.115), "black", turn_deg=(0, 10, 0), bevel=0.004)
    for k in range(4):
        b.box((0.03, 0.069, 0.004), (-0.055, 0, 0.165 + 0.009 * k), "black")
    if variant < 2:
        b.box((0.115, 0.072, 0.025), (-0.035, 0, 0.022), body, bevel=0.008)
        b.box((0.12, 0.076, 0.03), (-0.035, 0, 0), "black", bevel=0.008)
    else:
        b.rod((0.03, 0, z), (0.03, 0, 0.06), 0.014, "black", sides=10)
        b.tube(
            curve([(-0.05, 0, 0.035), (-0.055, 0, 0.01), (-0.08, 0.02, 0.004), (-0.14, 0.04, 0.004)], 3),
            0.0045,
            "black",
            sides=6,
        )
    size = ((0.225, 0.078, 0.215), (0.2, 0.074, 0.23), (0.32, 0.085, 0.22))[variant]
    return varied(b, rng, size, f"a {style} drill", style)


@recipe("grinder", 2, name="yard_tools.grinder")
def grinder(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Blue angle grinder, large red one; the disc lies below the head at +x under its guard."""
    b = MeshBuilder(roughness=0.45)
    style = ("blue angle", "large red angle")[variant]
    body: Color = ("blue", "signal red")[variant]
    rows = ((-0.16, 0.02), (-0.15, 0.028), (-0.06, 0.027), (-0.04, 0.034), (0.05, 0.034), (0.06, 0.026))
    with b.frame((0, 0, 0.06), (0, 90, 0)):
        b.lathe([(r, x) for x, r in rows], color=body, segments=16)
        b.cylinder(0.0285, 0.07, (0, 0, -0.14), "black", segments=16)
    b.box((0.07, 0.06, 0.062), (0.09, 0, 0.03), "aluminium", bevel=0.014)
    b.cylinder(0.024, 0.03, (0.095, 0, 0.012), "galvanised", segments=14)
    r = 0.0625
    b.cylinder(r, 0.004, (0.095, 0, 0.006), "#4a3a34", segments=26)
    b.cylinder(0.025, 0.003, (0.095, 0, 0.003), "signal yellow", segments=16)
    b.cylinder(0.01, 0.008, (0.095, 0, 0.0), "dark grey", segments=8)
    guard = [*ellipse(r + 0.008, r + 0.008, 12, (0.095, 0), 75, 285)]
    b.extrude(guard, 0.02, (0, 0, 0.009), "dark grey")
    b.tube(
        [(0.09, 0.03, 0.06), (0.09, 0.055, 0.06), (0.09, 0.065, 0.06), (0.09, 0.15, 0.062)],
        [0.009, 0.009, 0.015, 0.016],
        "black",
        sides=8,
    )
    b.box((0.05, 0.02, 0.008), (0.0, 0, 0.092), "black", bevel=0.003)
    for k in range(5):
        b.box((0.004, 0.07, 0.02), (0.005 + 0.009 * k, 0, 0.05), "black")
    b.tube(
        curve([(-0.155, 0, 0.06), (-0.185, 0, 0.055), (-0.19, 0.01, 0.02), (-0.17, 0.03, 0.006)], 3),
        0.004,
        "black",
        sides=6,
    )
    size = ((0.3, 0.135, 0.13), (0.46, 0.22, 0.16))[variant]
    return varied(b, rng, size, f"a {style} grinder", style)
