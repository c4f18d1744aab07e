"""Access control: gates, boom gates, turnstiles, toll booths."""

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, rgb, shade
from ...meshes.recipe import recipe
from ..shared.sizes import fitted


def _leaf(b: MeshBuilder, y0: float, y1: float, height: float, kind: str, color: Color) -> None:
    """One leaf of a gate between y0 and y1: "bars", "wrought" (bars with points under an arch) or "boards"."""
    middle, width = (y0 + y1) / 2, abs(y1 - y0)
    for y in (y0, y1):
        b.box((0.06, 0.06, height - 0.1), (0, y + (0.03 if y == min(y0, y1) else -0.03), 0.08), color)
    for z in (0.12, height * 0.5 if kind != "wrought" else 0.45, height - 0.12):
        b.box((0.05, width, 0.06), (0, middle, z), color)
    if kind == "boards":
        count = max(round(width / 0.16), 3)
        for k in range(count):
            y = min(y0, y1) + (k + 0.5) * width / count
            b.box((0.03, width / count - 0.02, height - 0.12), (0.035, y, 0.06), shade(color, 0.94 + 0.04 * (k % 3)))
        low, high = (min(y0, y1) + 0.1, 0.2), (max(y0, y1) - 0.1, height - 0.2)
        b.beam((-0.03, low[0], low[1]), (-0.03, high[0], high[1]), 0.08, 0.03, shade(color, 0.8))
        return
    count = max(round(width / 0.13), 4)
    for k in range(1, count):
        share = k / count
        y = y0 + (y1 - y0) * share
        top = height - 0.1
        if kind == "wrought":  # the bars rise towards the gate's middle (y1)
            top += 0.22 * share
            b.convex([(dx, y + dy, top) for dx in (-0.02, 0.02) for dy in (-0.02, 0.02)] + [(0, y, top + 0.12)], "gold")
        b.rod((0, y, 0.12), (0, y, top), 0.012, color, sides=5)
    if kind == "wrought":
        for k in range(2):
            b.ring(
                width * 0.16, 0.012, (0.0, middle + (k - 0.5) * width * 0.45, height * 0.66), color, (0, 90, 0), 14, 4
            )


@recipe("gate", 4, name="access_barriers.gate")
def gate(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.6)
    kind, color, width, height = (
        ("bars", "charcoal", 2.6, 1.7),
        ("wrought", "black", 3.6, 2.0),
        ("boards", "wood", 1.2, 1.5),
        ("bars", "galvanised", 4.6, 1.25),
    )[variant]
    half = width / 2
    post = 0.12 if variant != 1 else 0.32
    for side in (-1, 1):
        y = side * (half - post / 2)
        if variant == 1:  # brick piers with stone caps
            b.box((0.32, 0.32, height), (0, y, 0), "brick")
            b.box((0.40, 0.40, 0.08), (0, y, height), "sandstone", taper=(0.8, 0.8))
            b.ball(0.13, (0, y, height + 0.2), "sandstone", segments=10, rings=7)
        else:
            b.box((0.12, 0.12, height), (0, y, 0), color if variant != 2 else "dark wood", bevel=0.01)
            b.box((0.15, 0.15, 0.04), (0, y, height), shade(color, 0.8), taper=(0.6, 0.6))
    inner = half - post - 0.03
    if variant == 2:
        _leaf(b, -inner, inner, height, kind, color)
    else:
        for side in (-1, 1):
            _leaf(b, side * inner, side * 0.02, height, kind, color)
    hand = 0.06 if variant != 2 else inner - 0.12
    for side in (-1, 1):
        b.rod((side * 0.03, hand, 0.95), (side * 0.09, hand, 0.95), 0.012, "brass", sides=5)
        b.box((0.02, 0.13, 0.025), (side * 0.08, hand - 0.05, 0.94), "brass")
    if variant == 3:
        b.box(
            (0.01, 0.6, 0.4),
            (0.05, 0.9, 0.5),
            "white",
            skins={"+x": paint.lettering("KEEP\nCLEAR", "white", "signal red", (48, 32))},
        )
    names = (
        "A two-leaved steel gate",
        "A wrought iron gate between piers",
        "A wooden garden gate",
        "A wide field gate of steel",
    )
    size = ((0.16, 2.6, 1.75), (0.40, 3.7, 2.35), (0.16, 1.2, 1.55), (0.17, 4.6, 1.3))[variant]
    return fitted(b.build(names[variant], {"kind": kind}), size)


@recipe("lift gate", 3, name="access_barriers.lift_gate")
def lift_gate(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A boom barrier; its boom lies along y."""
    b = MeshBuilder(roughness=0.5)
    color, first, second = (
        ("safety orange", "white", "signal red"),
        ("light grey", "white", "signal red"),
        ("signal yellow", "signal yellow", "black"),
    )[variant]
    boom = (3.7, 4.6, 3.0)[variant]
    y0 = -boom / 2 - 0.25
    b.box((0.30, 0.34, 1.0), (0, y0, 0.03), color, bevel=0.03)
    b.box((0.36, 0.42, 0.03), (0, y0, 0), "dark grey")
    b.box((0.32, 0.36, 0.06), (0, y0, 1.03), shade(color, 0.7), taper=(0.8, 0.8))
    b.box((0.02, 0.22, 0.5), (0.15, y0, 0.25), shade(color, 0.8))
    count = round(boom / 0.42)
    for k in range(count):
        b.box((0.06, boom / count, 0.10), (0.03, y0 + (k + 0.5) * boom / count + 0.1, 0.88), (first, second)[k % 2])
    b.box((0.10, 0.34, 0.22), (0.03, y0 - 0.15, 0.82), "charcoal")
    for k in range(3):
        b.box((0.02, 0.06, 0.05), (0.07, y0 + boom * (0.3 + 0.25 * k), 0.905), "light red")
    end = y0 + boom + 0.06
    if variant != 2:
        b.box((0.08, 0.08, 0.86), (0.03, end, 0), "galvanised")
        b.box((0.10, 0.16, 0.06), (0.03, end, 0.82), "dark grey")
    if variant == 1:  # a skirt of thin rods hangs from the boom
        for k in range(18):
            y = y0 + 0.35 + k * (boom - 0.5) / 17
            b.rod((0.03, y, 0.88), (0.03, y, 0.2), 0.010, "aluminium", sides=4)
        b.rod((0.03, y0 + 0.35, 0.2), (0.03, y0 + boom - 0.15, 0.2), 0.012, "aluminium", sides=4)
    image, pen = paint.canvas((128, 128), color)
    pen.ellipse((10, 10, 118, 118), fill=rgb("signal red"))
    pen.rectangle((28, 52, 100, 76), fill=rgb("white"))
    b.panel(np.asarray(paint.shrunk(image, (32, 32))), (0.153, y0, 0.80), 0.26, 0.26, "+x")
    b.cylinder(0.05, 0.08, (0, y0, 1.09), "amber", segments=10)
    names = (
        "A boom gate with an orange cabinet",
        "A boom barrier with a hanging skirt",
        "A yellow and black boom gate",
    )
    size = ((0.36, 4.2, 1.15), (0.36, 5.1, 1.18), (0.38, 3.5, 1.08))[variant]
    return fitted(b.build(names[variant], {"boom": boom}), size)


@recipe("full-height turnstile", 3, name="access_barriers.full_height_turnstile")
def full_height_turnstile(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A rotor of arms in a cage; one walks through along x."""
    b = MeshBuilder(roughness=0.4, metallic=0.2)
    color: Color = ("galvanised", "signal blue", "charcoal")[variant]
    width, depth, high = 1.65, 1.45, 2.3
    levels = np.linspace(0.25, 2.0, 9)
    hub = np.array([0.0, 0.18, 0.0])
    b.rod((0, hub[1], 0.03), (0, hub[1], high - 0.15), 0.05, color, sides=10)
    for z in levels:
        for k in range(3):
            a = np.radians(20 + 120 * k)
            b.rod((0, hub[1], z), (0.62 * np.cos(a), hub[1] + 0.62 * np.sin(a), z), 0.019, color, sides=5)
    # The comb on one side, a curved cage round the rotor on the other.
    for z in levels + 0.1:
        b.rod((0.0, -width / 2 + 0.05, z), (0.0, -0.46, z), 0.019, color, sides=5)
    b.box((0.10, 0.10, high), (0, -width / 2 + 0.05, 0), color)
    for a in np.radians(np.linspace(25, 155, 7)):
        x, y = 0.70 * np.cos(a), hub[1] + 0.66 * np.sin(a)
        b.rod((x, y, 0.03), (x, y, high - 0.15), 0.018, color, sides=5)
    for z in (0.06, 1.1, high - 0.2):
        arc = [(0.70 * np.cos(a), hub[1] + 0.66 * np.sin(a), z) for a in np.radians(np.linspace(20, 160, 8))]
        b.tube(arc, 0.022, color, sides=5)
    for side in (-1, 1):
        b.box((0.10, 0.10, high), (side * 0.66, -width / 2 + 0.05, 0), color)
        b.box((0.10, 0.10, high), (side * 0.66, width / 2 - 0.4, 0), color)
    b.box((depth, width, 0.16), (0, 0, high - 0.16), color, bevel=0.02)
    b.box((depth, width, 0.03), (0, 0, 0), "dark grey")
    for side in (-1, 1):  # card readers and arrow lamps
        b.box((0.08, 0.14, 0.22), (side * 0.70, -width / 2 + 0.10, 1.05), "black", bevel=0.01)
        b.box((0.01, 0.10, 0.10), (side * 0.745, -width / 2 + 0.10, 1.13), "light green" if side > 0 else "light red")
    names = ("A galvanised full-height turnstile", "A blue full-height turnstile", "A dark full-height turnstile")
    size = ((1.45, 1.65, 2.3), (1.40, 1.55, 2.25), (1.6, 1.9, 2.4))[variant]
    return fitted(b.build(names[variant], {"color": str(color)}), size)


@recipe("toll booth", 3, name="access_barriers.toll_booth")
def toll_booth(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.5)
    color = ("signal blue", "#2f8f52", "safety orange")[variant]
    b.box((1.6, 2.4, 0.18), (0, 0, 0), "concrete", bevel=0.04)
    b.box((1.15, 1.75, 0.95), (0, 0, 0.18), color, bevel=0.02)
    b.box((1.08, 1.68, 1.1), (0, 0, 1.13), "dark glass")
    b.box((0.95, 1.5, 0.02), (0, 0, 1.14), "black")
    for x in (-0.55, 0.55):
        for y in (-0.84, 0, 0.84):
            b.box((0.07, 0.07, 1.1), (x, y, 1.13), "white")
    b.box((1.5, 2.1, 0.26), (0, 0, 2.2), color, bevel=0.03)
    for side, facing in ((1, "+x"), (-1, "-x")):
        b.panel(paint.lettering("TOLL", color, "white", (64, 20)), (side * 0.753, 0, 2.335), 1.2, 0.23, facing)
    b.box((0.30, 0.5, 0.05), (0.65, 0.4, 1.13), "aluminium")  # the shelf at the window
    b.box((0.03, 0.62, 0.9), (0.56, 0.42, 1.18), "glass")
    b.box((0.65, 0.03, 1.75), (-0.1, -0.885, 0.2), shade(color, 0.7))
    image, pen = paint.canvas((96, 96), "black")
    pen.line((48, 16, 48, 60), fill=rgb("light green"), width=14)
    pen.polygon([(20, 52), (76, 52), (48, 84)], fill=rgb("light green"))
    b.box((0.06, 0.45, 0.4), (0.0, 0, 2.46), "black", skins={"+x": np.asarray(paint.shrunk(image, (32, 32)))})
    for side in (-1, 1):
        b.cylinder(0.10, 0.85, (0.68, side * 1.05, 0.18), "signal yellow", segments=10)
        b.cylinder(0.102, 0.2, (0.68, side * 1.05, 0.5), "black", segments=10)
    if variant != 0:  # the boom across the lane
        b.box((0.22, 0.2, 0.9), (-0.66, 1.0, 0.18), "signal yellow")
        for k in range(5):
            b.box((0.05, 0.3, 0.08), (-0.66, 1.25 + 0.3 * k, 0.92), ("signal red", "white")[k % 2])
    names = ("A blue toll booth", "A green toll booth with its boom", "An orange toll booth with its boom")
    size = ((1.7, 2.45, 2.8), (1.7, 3.8, 2.9), (1.8, 3.4, 3.0))[variant]
    return fitted(b.build(names[variant], {"color": str(color)}), size)
