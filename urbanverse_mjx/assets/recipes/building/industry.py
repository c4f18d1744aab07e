"""Warehouses, factories and tanks."""

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import recipe
from ..shared import facade_images as images
from ..shared.sizes import fitted_as, size_of
from . import masonry as m
from .services import roller_door


@recipe("warehouse", 3, hulls=6, name="industry.warehouse")
def warehouse(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A long hall of ribbed sheet with loading docks; an old brick store; a big box in two colours."""
    size, b = size_of("warehouse", variant), MeshBuilder(roughness=0.7)
    x, y, z = size
    wall: Color = ("#9aa7b0", "#94553f", "#e4e6e4")[variant]
    high = (0.9, 0.72, 0.96)[variant] * z
    if variant == 1:
        face = m.painted_front(
            (y, high), (round(y / 4), 3), ("brick", wall), ("arch", "off white"), rng, 180, (0.4, 0.5)
        )
    else:
        face = np.asarray(paint.stripes((180, 40), [wall, shade(wall, 0.88)], 90))
    m.block(b, (0.88 * x, 0.98 * y, high), (-0.05 * x, 0, 0), face, "dark grey")
    if variant == 1:
        for k in range(4):
            with b.frame((-0.05 * x, (k - 1.5) * 0.245 * y, high)):
                b.profile([(-0.44 * x, 0), (0.44 * x, 0), (0, 0.28 * z)], 0.24 * y, color="#6b4038")
    else:
        b.box((0.9 * x, y, 0.04 * z), (-0.05 * x, 0, high), ("signal blue", "", "signal red")[variant])
        b.box((0.885 * x, 0.985 * y, 0.14 * z), (-0.05 * x, 0, 0.74 * high), ("signal blue", "", "signal red")[variant])
    front, docks = 0.39 * x, max(4, round(y / 6))
    gate = roller_door(("light grey", "dark green", "white")[variant], glazed=False)
    for k in range(docks):
        at = (front, (k - (docks - 1) / 2) * 0.88 * y / docks, 0.12 * z)
        b.box((0.3, 0.62 * y / docks, 0.42 * z), at, "charcoal")
        b.panel(gate, (front + 0.17, at[1], 0.31 * z), 0.5 * y / docks, 0.36 * z)
        for s in (-1, 1):
            b.box((0.5, 0.3, 0.1 * z), (front + 0.3, at[1] + s * 0.28 * y / docks, 0.02 * z), "signal yellow")
    b.box((0.1 * x, 0.92 * y, 0.1 * z), (front + 0.05 * x, 0, 0), "concrete")
    m.board(
        b,
        ("LOGISTICS", "STORAGE No. 7", "WAREHOUSE")[variant],
        (front + 0.02, 0, 0.6 * high),
        0.4 * y,
        0.13 * z,
        ("signal blue", "cream", "signal red")[variant],
        ("white", "black", "white")[variant],
    )
    names = (
        "sheet-metal warehouse with loading docks",
        "brick warehouse with four gables",
        "white logistics warehouse",
    )
    return fitted_as(b.build(names[variant]), "warehouse", size)


@recipe("factory building", 3, hulls=10, name="industry.factory_building")
def factory_building(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A saw-tooth roof with glass to the north and chimneys above."""
    size, b = size_of("factory building", variant), MeshBuilder(roughness=0.85)
    x, y, z = size
    wall: m.Wall = (("brick", "#8f4a38"), ("panel", "#a9b0b3"), ("plaster", "#cfc2a4"))[variant]
    low, teeth = (0.36, 0.4, 0.38)[variant] * z, (6, 5, 7)[variant]
    face = m.painted_front((0.96 * y, low), (round(y / 4), 1), wall, ("grid", "dark grey"), rng, 200, (0.66, 0.55))
    m.block(b, (0.86 * x, 0.96 * y, low), (0, 0, 0), face, "dark concrete")
    step = 0.96 * y / teeth
    glass = m.painted_front(
        (0.84 * x, 0.2 * z), (10, 1), ("plaster", "dark grey"), ("single", "dark grey"), rng, 100, (0.9, 0.9)
    )
    for k in range(teeth):
        y0 = -0.48 * y + k * step
        with b.frame((0, 0, low), (0, 0, 90)):
            b.profile([(y0, 0), (y0 + step, 0), (y0 + step, 0.22 * z)], 0.86 * x, color=shade(wall[1], 0.9))
        b.panel(glass, (0, y0 + step + 0.01, low + 0.11 * z), 0.84 * x, 0.2 * z, "+y")
        b.beam((0, y0, low + 0.02), (0, y0 + step, low + 0.23 * z), 0.87 * x, 0.25, "#6b6e70")
    for k in range((1, 3, 2)[variant]):
        at = (-0.2 * x, (-0.3 + 0.14 * k) * y, 0.0)
        r = 0.022 * y
        if variant == 1:
            b.cylinder(r, 0.99 * z - 0.06 * z * k, at, "galvanised", segments=12)
        else:
            b.cylinder(1.4 * r, z, at, wall[1] if variant == 0 else "brick", top_radius=r, segments=12)
            b.cylinder(1.25 * r, 0.03 * z, (at[0], at[1], 0.96 * z), "white", segments=12)
    b.panel(roller_door("dark green"), (0.435 * x, 0.3 * y, 0.14 * z), 0.1 * y, 0.28 * z)
    m.board(
        b,
        ("IRON WORKS", "FACTORY 3", "MACHINE WORKS")[variant],
        (0.43 * x, -0.1 * y, 0.29 * z),
        0.34 * y,
        0.07 * z,
        "cream",
        "black",
    )
    b.cylinder(0.04 * y, 0.3 * z, (0.47 * x, -0.42 * y, 0), "galvanised", segments=12)
    names = (
        "brick factory with a saw-tooth roof and chimney",
        "sheet-metal factory with three flues",
        "old factory with two chimneys",
    )
    return fitted_as(b.build(names[variant]), "factory building", size)


@recipe("storage tank", 3, hulls=4, name="industry.storage_tank")
def storage_tank(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """An upright steel tank with a spiral stair; a tank on legs; a broad oil tank with a flat cone."""
    size, b = size_of("storage tank", variant), MeshBuilder(roughness=0.5)
    d, z = size[0], size[2]
    r, color = 0.46 * d, ("off white", "galvanised", "#8fa59a")[variant]
    foot = 0.24 * z if variant == 1 else 0.03 * z
    if variant == 1:
        for k in range(4):
            a = np.pi / 4 + k * np.pi / 2
            b.cylinder(0.05 * d, 0.36 * z, (0.86 * r * np.cos(a), 0.86 * r * np.sin(a), 0), "dark grey", segments=8)
        b.lathe([(0.1 * r, 0), (r, 0.12 * z)], (0, 0, 0.12 * z), color, segments=20)
    else:
        b.cylinder(0.5 * d, foot, (0, 0, 0), "concrete", segments=20)
    high = 0.84 * z - foot
    b.cylinder(r, high, (0, 0, foot), color, segments=24)
    for k in range(4):
        b.cylinder(1.012 * r, 0.012 * z, (0, 0, foot + high * (k + 0.6) / 4), shade(color, 0.8), segments=24)
    b.lathe(
        [(r, 0), (0.6 * r, 0.06 * z), (0.1 * r, 0.09 * z), (0.0, 0.09 * z)],
        (0, 0, foot + high),
        shade(color, 0.92),
        segments=24,
    )
    b.ring(0.98 * r, 0.012 * d, (0, 0, foot + high + 0.09 * z), "signal yellow", segments=20, sides=4)
    for k in range(10):
        a = 2 * np.pi * k / 10
        at = (0.98 * r * np.cos(a), 0.98 * r * np.sin(a))
        b.rod((*at, foot + high), (*at, foot + high + 0.09 * z), 0.008 * d, "signal yellow", 4)
    count = 16
    for k in range(count):
        a = -0.9 + 2.2 * k / count
        at = (1.03 * r * np.cos(a), 1.03 * r * np.sin(a), 0.04 * z + (foot + high - 0.06 * z) * k / count)
        b.box((0.08 * d, 0.1 * d, 0.015 * z), at, "dark grey", (0, 0, np.degrees(a)))
    words = images.sign(("WATER", "SILO 2", "OIL")[variant], color, "signal blue", (72, 24))
    with b.frame((0, 0, 0), (0, 0, -16)):
        b.box((0.02 * d, 0.4 * d, 0.14 * z), (r, 0, foot + 0.5 * high), color, skins={"+x": words})
    b.tube(
        [(r, -0.2 * d, 0.12 * z), (0.49 * d, -0.2 * d, 0.12 * z), (0.492 * d, -0.2 * d, 0.06 * z)],
        0.025 * d,
        "signal red",
        6,
    )
    names = ("white storage tank with a stair", "steel tank on legs", "broad oil tank")
    return fitted_as(b.build(names[variant]), "storage tank", size)
