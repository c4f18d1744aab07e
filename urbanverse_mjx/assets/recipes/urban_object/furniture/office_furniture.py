"""Desks, counters, drawers and filing cabinets of offices and shops; the user at +x."""

import numpy as np

from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import shade
from ....meshes.recipe import recipe
from ...shared.facade_images import sign
from ...shared.sizes import made
from .case_furniture import Carcass


@recipe("desk", 3, name="office_furniture.desk")
def desk(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A steel-framed desk with a drawer unit, an old one with two pedestals, a standing one; the user at +x."""
    b = MeshBuilder(roughness=0.5)
    (d, w, h), top = (((0.68, 1.35, 0.75), "light wood"), ((0.75, 1.5, 0.78), "dark wood"), ((0.7, 1.4, 1.1), "white"))[
        variant % 3
    ]
    b.box((d, w, 0.028), (0, 0, h - 0.028), top, bevel=0.008)
    if variant % 3 == 1:
        for s in (-1, 1):
            with b.frame((0, s * (w / 2 - 0.22), 0)):
                c = Carcass(b, d - 0.06, 0.4, h - 0.03, top, 0.05, "brass")
                c.drawers(0, 0.05, 0.38, (0.28, 0.22, 0.18), shade(top, 1.15), "knob")
        b.box((0.02, w - 0.8, 0.4), (-0.25, 0, 0.33), top)
        b.box((d * 0.55, w * 0.45, 0.006), (0.08, 0, h), "dark green", bevel=0.002)
    else:
        for s in (-1, 1):
            y = s * (w / 2 - 0.12)
            b.box((0.06, 0.09, h - 0.06), (0, y, 0.03), "charcoal", bevel=0.006)
            b.box((d - 0.06, 0.07, 0.03), (0, y, 0), "charcoal", bevel=0.006)
            b.box((d - 0.14, 0.06, 0.03), (0, y, h - 0.058), "charcoal")
        b.box((0.03, w - 0.3, 0.06), (0, 0, h - 0.09), "charcoal")
        if variant % 3 == 0:
            with b.frame((-0.02, w / 2 - 0.42, 0.0)):
                c = Carcass(b, 0.55, 0.4, 0.58, "white", 0.05)
                c.drawers(0, 0.05, 0.38, (0.24, 0.15, 0.13), "off white")
        else:
            b.box((0.01, 0.12, 0.03), (d / 2, -0.4, h - 0.05), "black", bevel=0.003)
    return made(b, "a desk" if variant % 3 < 2 else "a standing desk", (d, w, h))


@recipe("drawer", 2, name="office_furniture.drawer")
def drawer(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """One pulled-out drawer with folded cloth in it, a small box of three drawers."""
    b = MeshBuilder(roughness=0.55)
    if variant % 2 == 0:
        d, w, h = 0.4, 0.46, 0.17
        b.box((d, w - 0.04, 0.012), (0, 0, 0.015), "light wood")
        for s in (-1, 1):
            b.box((d, 0.014, h - 0.03), (0, s * (w / 2 - 0.03), 0.015), "light wood", bevel=0.003)
            b.box((d, 0.01, 0.03), (0, s * (w / 2 - 0.017), 0.06), "aluminium", bevel=0.003)
        b.box((0.014, w - 0.06, h - 0.03), (-d / 2 + 0.007, 0, 0.015), "light wood")
        b.box((0.02, w, h + 0.02), (d / 2, 0, 0), "wood", bevel=0.006)
        b.box((0.025, 0.16, 0.016), (d / 2 + 0.022, 0, h * 0.6), "charcoal", bevel=0.005)
        for k in range(3):
            b.box(
                (0.28, 0.1, 0.08 + 0.01 * k),
                (-0.01, -0.13 + 0.13 * k, 0.028),
                ("light blue", "white", "red")[k],
                bevel=0.025,
            )
        return made(b, "a drawer", (0.4, 0.46, 0.2), style="single")
    c = Carcass(b, 0.3, 0.36, 0.42, "white", 0.0, "brass")
    c.drawers(0, 0.01, 0.34, (0.13, 0.13, 0.13), "light blue", "knob")
    b.box((0.22, 0.32, 0.1), (0.12, 0, 0.285), "light wood")
    c.front(0, 0.27, 0.34, 0.13, "light blue", "knob", 0.1)
    return made(b, "a box of drawers", (0.36, 0.36, 0.42), style="box")


@recipe("filing cabinet", 3, name="office_furniture.filing_cabinet")
def filing_cabinet(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Three steel drawers with label holders, a tall one of four, a pedestal with one drawer pulled out."""
    b = MeshBuilder(roughness=0.4, metallic=0.1)
    color, (d, w, h), rows = (
        ("light grey", (0.54, 0.46, 1.02), 3),
        ("#5c6b58", (0.6, 0.46, 1.32), 4),
        ("charcoal", (0.56, 0.42, 0.62), 2),
    )[variant % 3]
    b.box((d, w, h), color=color, bevel=0.006)
    tall = (h - 0.06) / rows
    for k in range(rows):
        out = 0.3 if variant % 3 == 2 and k == rows - 1 else 0.0
        z = 0.03 + k * tall
        if out:
            b.box((out, w - 0.08, tall * 0.55), (d / 2 + out / 2, 0, z + 0.03), shade(color, 0.8))
            for i in range(7):
                b.box(
                    (0.008, w - 0.12, tall * 0.72),
                    (d / 2 + 0.03 + 0.038 * i, 0, z + 0.03),
                    ("cream", "beige", "amber")[i % 3],
                )
        x = d / 2 + out
        b.box((0.016, w - 0.03, tall - 0.015), (x + 0.008, 0, z + 0.007), shade(color, 1.1), bevel=0.005)
        b.box((0.03, 0.13, 0.02), (x + 0.028, 0, z + tall * 0.5), "aluminium", bevel=0.006)
        b.box((0.008, 0.1, 0.045), (x + 0.018, 0, z + tall * 0.68), "white", bevel=0.002)
    b.cylinder(0.011, 0.012, (d / 2, w / 2 - 0.06, h - 0.035), "aluminium", turn_deg=(0, 90, 0), segments=12)
    size = ((0.56, 0.46, 1.02), (0.62, 0.46, 1.32), (0.9, 0.42, 0.62))[variant % 3]
    return made(b, f"a filing cabinet of {rows} drawers", size, drawers=rows)


@recipe("counter", 3, name="office_furniture.counter")
def counter(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A shop counter with a till, a reception desk with a raised front, a stone-topped bar; the customer at +x."""
    b = MeshBuilder(roughness=0.45)
    front, top, (d, w, h) = (
        ("light wood", "white", (0.7, 2.3, 1.0)),
        ("#3c5a6b", "light wood", (0.8, 2.0, 1.15)),
        ("dark wood", "granite", (0.62, 3.0, 1.1)),
    )[variant % 3]
    base = h - 0.04 if variant % 3 != 1 else 0.76
    b.box((d - 0.12, w - 0.08, 0.08), (-0.02, 0, 0), "charcoal")
    b.box((d - 0.06, w - 0.04, base - 0.08), (-0.02, 0, 0.08), shade(front, 0.85))
    b.box((d, w, 0.04), (0, 0, base), top, bevel=0.012)
    planks = 7 if variant % 3 == 0 else 4
    x = d / 2 - 0.045
    for k in range(planks):
        wide = (w - 0.06) / planks
        b.box((0.02, wide - 0.012, base - 0.1), (x, (k - (planks - 1) / 2) * wide, 0.09), front, bevel=0.005)
    if variant % 3 == 0:
        with b.frame((-0.05, -w * 0.28, h)):
            b.box((0.3, 0.36, 0.12), color="charcoal", bevel=0.015)
            b.box((0.03, 0.3, 0.22), (0.0, 0, 0.14), "black", turn_deg=(0, 20, 0), bevel=0.008)
            b.box((0.16, 0.08, 0.02), (0.2, 0.26, 0.0), "dark grey", bevel=0.006)
        h += 0.3
    elif variant % 3 == 1:
        b.box((0.1, w, h - 0.05), (d / 2 - 0.03, 0, 0.02), front, bevel=0.01)
        b.box((0.24, w + 0.04, 0.045), (d / 2 - 0.08, 0, h - 0.045), top, bevel=0.01)
        b.panel(sign("RECEPTION", front, "white", (128, 22)), (d / 2 + 0.022, 0, 0.72), 1.2, 0.2)
    else:
        b.rod((d / 2 + 0.06, -w / 2, 0.2), (d / 2 + 0.06, w / 2, 0.2), 0.022, "brass")
        for y in (-w * 0.4, 0.0, w * 0.4):
            b.rod((d / 2 - 0.06, y, 0.2), (d / 2 + 0.06, y, 0.2), 0.015, "brass")
        for k in range(2):
            b.tube([(-0.1, 0.5 + 0.16 * k, h), (-0.1, 0.5 + 0.16 * k, h + 0.28)], 0.02, "brass", sides=8)
            b.cylinder(0.018, 0.12, (-0.02, 0.5 + 0.16 * k, h + 0.25), "dark wood", segments=8)
        b.rod((-0.1, 0.42, h + 0.28), (-0.1, 0.74, h + 0.28), 0.03, "brass")
    size = ((0.75, 2.3, 1.08), (0.84, 2.05, 1.15), (0.72, 3.1, 1.22))[variant % 3]
    return made(b, ("a shop counter with a till", "a reception desk", "a bar counter")[variant % 3], size)
