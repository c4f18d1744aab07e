"""Garbage bags, storage boxes and parcels."""

import numpy as np

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import shade
from ....meshes.recipe import Physics, recipe

BAG = Physics(("plastic",), 110.0, (3.0, 16.0), 0.6, True, "a full household bag of 40-100 l weighs 4-15 kg")


@recipe("garbage bag", 4, BAG, hulls=3, name="waste.garbage_bag")
def garbage_bag(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """One bag, or a heap of two or three, knotted at the top."""
    b = MeshBuilder(roughness=0.35)
    count, color = ((1, "black"), (3, "black"), (2, "light blue"), (1, "light grey"))[variant % 4]
    places = [(0.0, 0.0), (0.38, 0.24), (0.05, 0.46)][:count]
    for x, y in places:
        r, h = rng.uniform(0.23, 0.29), rng.uniform(0.42, 0.55)
        rows = []
        for z, s in (
            (0.0, 0.7),
            (0.05, 0.95),
            (0.4, 1.0),
            (0.65, 0.85),
            (0.82, 0.5),
            (0.9, 0.16),
            (0.94, 0.1),
            (1.0, 0.2),
        ):
            angle = np.arange(12) * np.pi / 6
            wobble = 1 + rng.uniform(-0.09, 0.09, 12) * (s > 0.3)
            rows.append(
                np.column_stack(
                    [x + r * s * wobble * np.cos(angle), y + r * s * wobble * np.sin(angle), np.full(12, h * z)]
                )
            )
        b.loft(rows, shade(color, float(rng.uniform(0.9, 1.15))), crease_deg=28.0)
        b.cylinder(0.03, 0.03, (x, y, h * 0.9), "red" if color == "light grey" else shade(color, 1.5), segments=8)
    return b.build(f"{count} {color} garbage bag{'s' if count > 1 else ''}", {"count": count, "color": color})


CRATE = Physics(
    ("wood", "plastic"), 160.0, (1.5, 40.0), 0.5, True, "empty crates weigh 1.5-12 kg; grit boxes are heavier"
)


@recipe("storage box", 4, CRATE, hulls=2, name="waste.storage_box")
def storage_box(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Wooden crate, stacked plastic crates, steel-cornered chest, yellow grit box."""
    b = MeshBuilder(roughness=0.75)
    style = ("wooden crate", "plastic crates", "chest", "grit box")[variant % 4]
    if style == "wooden crate":
        _wooden_crate(b, rng)
    elif style == "plastic crates":
        _plastic_crates(b, rng)
    elif style == "chest":
        _chest(b)
    else:
        _grit_box(b)
    return b.build(f"a {style}", {"style": style})


def _wooden_crate(b: MeshBuilder, rng: np.random.Generator) -> None:
    """Slats around a box, on battens."""
    x, y, z = (float(v) for v in rng.uniform((0.4, 0.55, 0.35), (0.5, 0.7, 0.45)))
    b.box((x - 0.03, y - 0.03, z - 0.02), color="dark wood")
    for k in range(3):
        at = z * (k + 0.5) / 3
        for s in (-1, 1):
            b.box((0.018, y, z / 3 - 0.02), (s * (x / 2 - 0.009), 0, at), "light wood", centered=True)
            b.box((x, 0.018, z / 3 - 0.02), (0, s * (y / 2 - 0.009), at), "light wood", centered=True)
    for sx in (-1, 1):
        for sy in (-1, 1):
            b.box((0.05, 0.05, z), (sx * (x / 2 - 0.02), sy * (y / 2 - 0.02), 0), "wood")
    for k in range(4):
        b.box((x / 4 - 0.015, y, 0.02), (-x / 2 + x * (k + 0.5) / 4, 0, z - 0.015), "light wood")


def _plastic_crates(b: MeshBuilder, rng: np.random.Generator) -> None:
    """Two or three crates, one on the other."""
    for k, color in enumerate(("red", "blue", "signal yellow")[: int(rng.integers(2, 4))]):
        with b.frame((0, 0, 0.3 * k), (0, 0, float(rng.uniform(-6, 6)))):
            b.box((0.36, 0.5, 0.28), color=color, taper=(1.04, 1.03))
            b.box((0.4, 0.54, 0.03), (0, 0, 0.265), shade(color, 0.85))
            for z in (0.06, 0.13):
                b.box((0.381, 0.4, 0.03), (0, 0, z), shade(color, 0.6))
                b.box((0.3, 0.521, 0.03), (0, 0, z), shade(color, 0.6))
            b.box((0.405, 0.12, 0.035), (0, 0, 0.2), "black")


def _chest(b: MeshBuilder) -> None:
    """A chest with a lid and two locks."""
    b.box((0.5, 0.9, 0.42), color="dark green", bevel=0.015)
    b.box((0.53, 0.93, 0.1), (0, 0, 0.4), shade("dark green", 1.25), bevel=0.02)
    for y in (-0.3, 0.3):
        b.box((0.02, 0.06, 0.12), (0.26, y, 0.34), "galvanised")
    for y in (-0.43, 0.43):
        b.box((0.52, 0.05, 0.06), (0, y, 0.0), "black")


def _grit_box(b: MeshBuilder) -> None:
    """A lettered box under a sloping lid."""
    b.box((0.55, 0.9, 0.5), color="signal yellow", taper=(1.1, 1.08), bevel=0.02)
    roof = [(-0.34, 0), (0.34, 0), (0.32, 0.08), (-0.25, 0.2), (-0.34, 0.18)]
    b.profile(roof, 1.02, (0, 0, 0.5), "signal yellow")
    image, draw = paint.canvas((64, 32), "signal yellow")
    paint.text(draw, "GRIT", (4, 3, 60, 29), "black", bold=0.05)
    b.panel(image, (0.295, 0, 0.28), 0.4, 0.2, tilt_deg=-3)


PARCEL = Physics(("cardboard",), 140.0, (0.5, 25.0), 0.5, True, "cardboard parcels of 5-100 l weigh 0.5-20 kg")


@recipe("parcels", 4, PARCEL, hulls=3, name="waste.parcels")
def parcels(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """One box or a small stack, taped and labelled."""
    b = MeshBuilder(roughness=0.9)
    label, draw = paint.canvas((40, 28), "white")
    draw.rectangle((3, 3, 22, 5), fill=(60, 60, 60))
    draw.rectangle((3, 8, 18, 10), fill=(120, 120, 120))
    for k in range(14):
        draw.rectangle((4 + 2 * k + (k % 3), 15, 4 + 2 * k + (k % 3) + k % 2, 24), fill=(20, 20, 20))
    count = (1, 2, 3, 4)[variant % 4]
    level, top = 0.0, (0.6, 0.7)
    for k in range(count):
        size = rng.uniform((0.26, 0.34, 0.18), (0.42, 0.5, 0.36)) * (1.15 if k == 0 else 0.95)
        beside = k == 3
        place = (0.05, top[1] / 2 + size[1] / 2 + 0.06, 0.0) if beside else (0.0, 0.0, level)
        color = shade("cardboard", float(rng.uniform(0.85, 1.12)))
        with b.frame(place, (0, 0, float(rng.uniform(-12, 12)))):
            b.box(size, color=color)
            b.box((0.05, size[1] + 0.004, size[2] + 0.002), color="beige")
            b.panel(label, (size[0] / 2 + 0.003, size[1] * 0.12, size[2] * 0.55), 0.14, 0.1)
        if not beside:
            level, top = level + float(size[2]), (float(size[0]), float(size[1]))
            if k == 0:
                top = (float(size[0]), float(size[1]) * 1.1)
    return b.build(f"{count} cardboard parcel{'s' if count > 1 else ''}", {"count": count})
