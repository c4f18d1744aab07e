"""Dolls, stuffed toys and water guns. Faces look along +x."""

import numpy as np
from PIL import Image

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, mix, rgb, shade
from ....meshes.recipe import recipe
from ...shared.outlines import curve, level, pairs
from ...shared.sizes import varied


def _eyes(b: MeshBuilder, x: float, z: float, apart: float, radius: float, color: Color = "black") -> None:
    for s in (-1, 1):
        b.ball((radius * 0.6, radius, radius * 1.15), (x, s * apart, z), color, segments=6, rings=4)
        b.ball(
            radius * 0.32, (x + radius * 0.5, s * apart + radius * 0.3, z + radius * 0.45), "white", segments=5, rings=4
        )


def _checks(size: tuple[int, int], ground: Color, ink: Color) -> Image.Image:
    image, pen = paint.canvas(size, ground)
    for x in range(0, size[0], 8):
        for y in range(0, size[1], 8):
            for across, mark in (((x, y, x + 3, y + 7), 0.5), ((x, y, x + 7, y + 3), 0.5)):
                pen.rectangle(across, fill=mix(ground, ink, mark))
            pen.rectangle((x, y, x + 3, y + 3), fill=rgb(ink))
    return image


def _rag_body(b: MeshBuilder, skin: Color, hair: Color, dress: Color, head: float, z: float) -> None:
    """Plaits, soft limbs in striped stockings, a dress under an apron; the head is at z."""
    for s in (-1, 1):
        for k in range(4):
            b.ball(
                (0.014, 0.015, 0.017),
                (-0.005, s * (head + 0.008 + 0.002 * k), z - 0.02 - 0.024 * k),
                hair,
                segments=8,
                rings=5,
            )
        b.ball((0.012, 0.014, 0.008), (-0.005, s * (head + 0.012), z - 0.1), "signal red", segments=6, rings=4)
        b.tube(
            curve([(0, 0.035 * s, 0.215), (0.01, 0.075 * s, 0.18), (0.02, 0.082 * s, 0.12)], 3),
            0.014,
            "white",
            sides=7,
        )
        b.ball(0.015, (0.022, 0.084 * s, 0.11), skin, segments=8, rings=5)
        b.rod((0, 0.025 * s, 0.02), (0, 0.025 * s, 0.11), 0.017, "white", sides=8)
        for stripe in (0.05, 0.08):
            b.cylinder(0.0178, 0.012, (0, 0.025 * s, stripe), "signal red", segments=10)
        b.ball((0.028, 0.019, 0.017), (0.012, 0.026 * s, 0.017), "black", segments=8, rings=5)
    b.loft(
        [
            level(h, x, y)
            for h, x, y in ((0.085, 0.07, 0.085), (0.17, 0.036, 0.042), (0.225, 0.026, 0.04), (0.24, 0.012, 0.02))
        ],
        dress,
    )
    apron = [
        [(0.004 + 0.0705 * np.cos(a) * r, 0.0855 * np.sin(a) * r, h) for a in (-0.7, -0.35, 0, 0.35, 0.7)]
        for h, r in ((0.09, 1.0), (0.15, 0.66), (0.175, 0.55))
    ]
    b.sheet(np.array(apron), image=_checks((48, 32), "white", "signal red"))


def _fashion_body(b: MeshBuilder, skin: Color, hair: Color, dress: Color, z: float) -> None:
    """Slim limbs in a long dress, hair down the back; the head is at z."""
    for s in (-1, 1):
        b.tube(
            curve([(0, 0.028 * s, 0.255), (0.0, 0.048 * s, 0.2), (0.02, 0.052 * s, 0.15)], 3),
            [0.008, 0.0075, 0.007, 0.0065, 0.006, 0.0055, 0.007],
            skin,
            sides=7,
        )
        b.rod((0.0, 0.012 * s, 0.0), (0, 0.012 * s, 0.05), 0.007, skin, sides=6)
        b.box((0.03, 0.012, 0.008), (0.006, 0.012 * s, 0.0), "signal red", bevel=0.003)
    b.rod((0, 0, 0.25), (0, 0, 0.28), 0.008, skin, sides=8)
    rows = (
        (0.02, 0.06, 0.07),
        (0.06, 0.052, 0.06),
        (0.14, 0.026, 0.03),
        (0.185, 0.016, 0.02),
        (0.225, 0.022, 0.03),
        (0.262, 0.014, 0.026),
    )
    b.loft([level(h, x, y, count=14) for h, x, y in rows], dress)
    b.loft([level(h, x, y, count=14) for h, x, y in ((0.183, 0.018, 0.022), (0.192, 0.0185, 0.0225))], "white")
    b.tube(
        curve([(-0.02, 0, z + 0.02), (-0.035, 0, z - 0.02), (-0.03, 0, z - 0.08)], 3),
        [0.02, 0.024, 0.024, 0.023, 0.02, 0.017, 0.01],
        hair,
        sides=8,
    )
    b.ring(0.024, 0.003, (0.0, 0, z + 0.024), "gold", (0, 12, 0), segments=14, sides=4)


def _baby_body(b: MeshBuilder, skin: Color, dress: Color, head: float, z: float) -> None:
    """Round limbs out of a romper, a dummy in the mouth; the head is at z."""
    b.ball((0.052, 0.06, 0.075), (0, 0, 0.135), dress, segments=12, rings=6)
    b.ball((0.016, 0.026, 0.024), (0.048, 0, 0.15), "white", segments=10, rings=5)
    for s in (-1, 1):
        b.tube(
            curve([(0, 0.045 * s, 0.18), (0.02, 0.085 * s, 0.165), (0.055, 0.092 * s, 0.18)], 3),
            0.016,
            dress,
            sides=8,
        )
        b.ball(0.018, (0.06, 0.093 * s, 0.183), skin, segments=6, rings=4)
        b.tube(
            curve([(0, 0.03 * s, 0.09), (0.03, 0.045 * s, 0.04), (0.03, 0.045 * s, 0.015)], 3),
            [0.024, 0.024, 0.022, 0.021, 0.019, 0.018, 0.017],
            skin,
            sides=8,
        )
        b.ball((0.027, 0.019, 0.016), (0.04, 0.045 * s, 0.014), skin, segments=8, rings=5)
    b.lathe(
        [(0.006, 0.0), (0.012, 0.003), (0.012, 0.006), (0.005, 0.009)],
        (head * 0.92, 0, z - head * 0.42),
        "signal blue",
        (0, 90, 0),
        segments=10,
    )


@recipe("doll", 3, name="toys.doll")
def doll(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Rag doll with plaits and a checked apron, fashion doll in a long dress, baby doll in a romper."""
    b = MeshBuilder(roughness=0.6)
    style = ("rag", "fashion", "baby")[variant]
    skin, hair, dress = (
        ("skin light", "#8c3a1e", "signal blue"),
        ("skin medium", "#2a1a14", "pink"),
        ("skin light", "amber", "light blue"),
    )[variant]
    head = (0.052, 0.03, 0.058)[variant]
    neck = (0.232, 0.27, 0.21)[variant]
    z = neck + head * 0.9
    b.ball((head * 0.95, head, head * 1.02), (0, 0, z), skin, segments=12, rings=6)
    b.ball((head * 1.0, head * 1.07, head * 1.02), (-head * 0.14, 0, z + head * 0.13), hair, segments=12, rings=6)
    _eyes(b, head * 0.88, z + head * 0.08, head * 0.36, head * 0.13)
    b.ball((head * 0.1, head * 0.2, head * 0.07), (head * 0.9, 0, z - head * 0.42), "signal red", segments=8, rings=4)
    for s in (-1, 1):
        b.ball(
            (head * 0.08, head * 0.15, head * 0.12),
            (head * 0.82, s * head * 0.5, z - head * 0.25),
            "pink",
            segments=8,
            rings=4,
        )
    if style == "rag":
        _rag_body(b, skin, hair, dress, head, z)
    elif style == "fashion":
        _fashion_body(b, skin, hair, dress, z)
    else:
        _baby_body(b, skin, dress, head, z)
    size = ((0.1, 0.165, 0.33), (0.095, 0.125, 0.3), (0.13, 0.21, 0.4))[variant]
    return varied(b, rng, size, f"a {style} doll", style)


@recipe("stuffed toy", 3, name="toys.stuffed_toy")
def stuffed_toy(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Sitting teddy bear with a bow, rabbit with long ears, panda; fur in two tones."""
    b = MeshBuilder(roughness=0.95)
    style = ("teddy bear", "rabbit", "panda")[variant]
    fur, light, limb = (
        ("#a56a35", "#d8ac74", "#a56a35"),
        ("light grey", "white", "light grey"),
        ("white", "white", "#26262a"),
    )[variant]
    b.ball((0.075, 0.08, 0.09), (0, 0, 0.095), fur, segments=12, rings=6)
    b.ball((0.03, 0.055, 0.065), (0.05, 0, 0.095), light, segments=8, rings=5)
    z = 0.222
    b.ball((0.066, 0.074, 0.066), (0.005, 0, z), fur, segments=12, rings=6)
    b.ball((0.03, 0.036, 0.028), (0.06, 0, z - 0.018), light, segments=10, rings=6)
    b.ball((0.01, 0.014, 0.01), (0.088, 0, z - 0.006), "black" if variant != 1 else "pink", segments=6, rings=4)
    b.tube([(0.085, -0.013, z - 0.024), (0.09, 0, z - 0.031), (0.085, 0.013, z - 0.024)], 0.0022, "black", sides=4)
    if style == "panda":
        for s in (-1, 1):
            b.ball((0.014, 0.019, 0.024), (0.057, 0.03 * s, z + 0.014), limb, (25 * s, 0, 0), segments=8, rings=5)
    _eyes(b, 0.064 if variant != 2 else 0.069, z + 0.016, 0.028, 0.0085)
    for s in (-1, 1):
        if style == "rabbit":
            b.ball((0.014, 0.02, 0.065), (-0.005, 0.035 * s, z + 0.105), fur, (-9 * s, 0, 0), segments=6, rings=4)
            b.ball((0.006, 0.012, 0.05), (0.006, 0.036 * s, z + 0.105), "pink", (-9 * s, 0, 0), segments=6, rings=4)
        else:
            b.ball((0.015, 0.028, 0.028), (0.0, 0.056 * s, z + 0.052), limb, segments=8, rings=5)
            b.ball(
                (0.008, 0.018, 0.018),
                (0.011, 0.056 * s, z + 0.052),
                light if variant == 0 else limb,
                segments=7,
                rings=6,
            )
        arm = curve([(0.015, 0.068 * s, 0.15), (0.05, 0.1 * s, 0.105), (0.08, 0.085 * s, 0.075)], 3)
        b.tube(arm, [0.026, 0.028, 0.028, 0.028, 0.028, 0.026, 0.02], limb, sides=6)
        leg = curve([(0.03, 0.05 * s, 0.035), (0.08, 0.072 * s, 0.034), (0.125, 0.082 * s, 0.036)], 3)
        b.tube(leg, [0.03, 0.033, 0.034, 0.034, 0.034, 0.033, 0.03], limb, sides=6)
        b.ball((0.014, 0.032, 0.036), (0.128, 0.083 * s, 0.038), light if variant != 2 else limb, segments=8, rings=5)
    if style == "teddy bear":
        for s in (-1, 1):
            b.convex(
                [
                    (0.06, 0, 0.172),
                    (0.072, 0, 0.172),
                    (0.066, 0.048 * s, 0.192),
                    (0.066, 0.048 * s, 0.15),
                    (0.058, 0.04 * s, 0.17),
                ],
                "signal red",
            )
        b.ball((0.012, 0.012, 0.012), (0.07, 0, 0.171), "dark red", segments=6, rings=4)
        b.ring(0.055, 0.008, (0.005, 0, 0.172), "signal red", segments=12, sides=4)
    elif style == "rabbit":
        b.ball(0.03, (-0.08, 0, 0.04), "white", segments=8, rings=5)
    size = ((0.19, 0.23, 0.3), (0.2, 0.22, 0.4), (0.3, 0.34, 0.45))[variant]
    return varied(b, rng, size, f"a stuffed {style}", style)


@recipe("water gun", 3, name="toys.water_gun")
def water_gun(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Pump-action gun with its tank on top, clear green pistol, large one with a pack of two tanks; mouth at +x."""
    b = MeshBuilder(roughness=0.25)
    style = ("pump-action", "pistol", "twin-tank")[variant]
    body, tank, accent = (
        ("safety orange", "light blue", "signal yellow"),
        ("lime", "light green", "orange"),
        ("signal blue", "light red", "signal yellow"),
    )[variant]
    z = 0.12
    long = 0.1 if style == "pistol" else 0.2
    b.profile(
        [(-0.12, z - 0.03), (0.08, z - 0.03), (0.1, z - 0.015), (0.1, z + 0.02), (-0.1, z + 0.025), (-0.13, z + 0.01)],
        0.045,
        color=body,
    )
    grip = [(-0.1, z - 0.02), (-0.05, z - 0.02), (-0.06, 0.06), (-0.075, 0.0), (-0.125, 0.0), (-0.11, 0.05)]
    b.profile(pairs(curve(grip, 2, closed=True)), 0.036, color=body)
    guard = curve([(-0.05, 0, z - 0.03), (-0.03, 0, 0.05), (0.01, 0, 0.05), (0.02, 0, z - 0.03)], 3)
    b.tube(guard, 0.006, body, sides=6)
    b.box((0.012, 0.012, 0.03), (-0.025, 0, z - 0.06), accent, bevel=0.003)
    with b.frame((0.09, 0, z + 0.003), (0, 90, 0)):
        b.lathe(
            [
                (0.018, 0.0),
                (0.013, 0.02),
                (0.012, long - 0.03),
                (0.02, long - 0.028),
                (0.02, long - 0.008),
                (0.012, long),
            ],
            color=accent,
            segments=14,
        )
        b.cylinder(0.004, 0.002, (0, 0, long), "black", segments=8)
    if style == "pistol":
        b.ball((0.06, 0.03, 0.03), (-0.02, 0, z + 0.035), tank, segments=14, rings=8)
        b.cylinder(0.011, 0.016, (-0.09, 0, z + 0.02), accent, segments=12)
    else:
        for y in (0.0,) if variant == 0 else (-0.03, 0.03):
            with b.frame((-0.11, y, z + 0.065), (0, 90, 0)):
                b.lathe(
                    [(0.012, 0.0), (0.034, 0.015), (0.038, 0.05), (0.038, 0.13), (0.03, 0.16), (0.01, 0.17)],
                    color=tank,
                    segments=16,
                )
                b.cylinder(0.014, 0.018, (0, 0, -0.016), accent, segments=12)
            b.box((0.03, 0.02, 0.03), (-0.03, y, z + 0.015), body)
        b.rod((0.09, 0, z - 0.024), (0.24, 0, z - 0.024), 0.008, "white", sides=8)
        b.cylinder(0.021, 0.075, (0.13, 0, z - 0.024), accent, (0, 90, 0), segments=12)
        for k in range(4):
            b.ring(
                0.021, 0.003, (0.145 + 0.016 * k, 0, z - 0.024), shade(accent, 0.8), (0, 90, 0), segments=12, sides=4
            )
        b.rod((0.23, 0, z - 0.024), (0.25, 0, z + 0.003), 0.009, body, sides=6)
    size = ((0.36, 0.085, 0.205), (0.22, 0.062, 0.16), (0.5, 0.14, 0.24))[variant]
    return varied(b, rng, size, f"a {style} water gun", style)
