"""Medicine and stretchers."""

import numpy as np

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import rgb
from ....meshes.recipe import recipe
from ...shared.forms import soft
from ...shared.sizes import made


@recipe("medicine", 2, name="first_aid.medicine")
def medicine(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A folding box with a blister pack of tablets, an amber jar with a white cap and label."""
    b = MeshBuilder(roughness=0.5)
    if variant % 2 == 0:
        image, draw = paint.canvas((192, 144), "white")
        draw.rectangle((0, 96, 192, 144), fill=rgb("signal blue"))
        paint.text(draw, "RELIEF", (12, 14, 180, 60), "signal blue", bold=0.04)
        paint.text(draw, "20 tablets", (12, 104, 130, 134), "white")
        b.box((0.022, 0.068, 0.058), color="white", skins={"+x": paint.shrunk(image, (72, 54))})
        with b.frame((0.022, 0, 0.001), (0, -14, 4)):
            b.box((0.002, 0.06, 0.04), color="aluminium")
            for k in range(8):
                b.ball(
                    (0.003, 0.005, 0.005),
                    (0.0015, -0.021 + 0.014 * (k % 4), 0.011 + 0.018 * (k // 4)),
                    "signal red",
                    segments=8,
                    rings=4,
                )
        return made(b, "a box of tablets", (0.045, 0.07, 0.06), form="tablets")
    b.lathe([(0.02, 0), (0.022, 0.003), (0.022, 0.05), (0.016, 0.058)], color="#b5651d", segments=22)
    b.lathe([(0.019, 0.056), (0.019, 0.07), (0.018, 0.072)], color="white", segments=22)
    image, draw = paint.canvas((160, 80), "white")
    paint.text(draw, "Rx", (50, 6, 110, 44), "signal red", bold=0.04)
    for y in (52, 62, 70):
        draw.line((40, y, 120, y), fill=(80, 80, 80), width=3)
    a = np.radians(np.linspace(-100, 100, 13))
    b.sheet(
        np.array([[(0.0223 * np.cos(t), 0.0223 * np.sin(t), z) for t in a] for z in (0.01, 0.045)]),
        image=paint.shrunk(image, (80, 40)),
    )
    return made(b, "a jar of pills", (0.046, 0.046, 0.08), form="jar")


@recipe("stretcher", 3, name="first_aid.stretcher")
def stretcher(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """An ambulance stretcher on scissors and castors, a hospital trolley, a cloth between two poles; head +x."""
    b = MeshBuilder(roughness=0.5)
    if variant % 3 == 2:
        for side in (-1, 1):
            b.rod((-1.0, side * 0.24, 0.12), (1.0, side * 0.24, 0.12), 0.018, "light wood", sides=10)
            for x in (-0.95, 0.95):
                b.cylinder(0.022, 0.12, (x - 0.06, side * 0.24, 0.12), "black", turn_deg=(0, 90, 0), segments=10)
            for x in (-0.55, 0.55):
                b.box((0.05, 0.04, 0.1), (x, side * 0.24, 0.0), "charcoal", bevel=0.008)
        u = np.linspace(-0.24, 0.24, 9)
        b.sheet(
            np.array([[(x, -v, 0.12 - 0.05 * (1 - (v / 0.24) ** 2)) for v in u] for x in (-0.8, 0.8)]),
            "safety orange",
            both_sides=True,
        )
        for x in (-0.55, 0.55):
            b.rod((x, -0.24, 0.09), (x, 0.24, 0.09), 0.01, "aluminium", sides=6)
        return made(b, "a stretcher of cloth between poles", (2.05, 0.55, 0.16), 0.5, style="carried")
    pad, top = (("signal yellow", 0.62), ("signal blue", 0.75))[variant % 3]
    for side in (-1, 1):
        b.rod((-0.97, side * 0.24, top), (0.97, side * 0.24, top), 0.016, "aluminium", sides=8)
        b.tube(
            [
                (-0.35, side * 0.26, top),
                (-0.33, side * 0.27, top + 0.22),
                (0.25, side * 0.27, top + 0.22),
                (0.27, side * 0.26, top),
            ],
            0.011,
            "aluminium",
            sides=6,
        )
        for s in (-1, 1):
            b.rod(
                (s * 0.7, side * 0.22, 0.12),
                (-s * (0.55 if variant % 3 == 0 else -0.62), side * 0.22, top),
                0.015,
                "aluminium",
                sides=8,
            )
            b.rod((s * 0.7, -0.22, 0.13), (s * 0.7, 0.22, 0.13), 0.014, "aluminium", sides=6)
            b.cylinder(0.07, 0.03, (s * 0.7, side * 0.22 + 0.015, 0.07), "rubber", turn_deg=(90, 0, 0), segments=16)
            b.box((0.04, 0.045, 0.06), (s * 0.7, side * 0.22, 0.08), "charcoal")
    b.rod((-0.7, 0, 0.14), (0.7, 0, 0.14), 0.012, "aluminium", sides=6)
    for s in (-1, 1):
        b.tube(
            [(s * 0.95, -0.24, top), (s * 0.99, -0.15, top), (s * 0.99, 0.15, top), (s * 0.95, 0.24, top)],
            0.016,
            "signal red",
            sides=8,
        )
    soft(b, (1.25, 0.48, 0.09), (-0.3, 0, top), pad, plan=12)
    with b.frame((0.32, 0, top), (0, -30, 0)):
        soft(b, (0.62, 0.48, 0.09), (0.3, 0, 0.0), pad, plan=10)
        soft(b, (0.28, 0.4, 0.09), (0.44, 0, 0.08), "white", plan=5, side=2.5)
    for x in (-0.6, -0.05):
        b.box((0.06, 0.5, 0.012), (x, 0, top + 0.085), "charcoal")
        b.box((0.05, 0.05, 0.02), (x, 0, top + 0.09), "signal red")
    return made(b, "an ambulance stretcher", ((1.98, 0.58, 0.88), (2.05, 0.66, 1.05))[variant % 3], style="wheeled")
