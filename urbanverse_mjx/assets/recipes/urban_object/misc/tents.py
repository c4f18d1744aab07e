"""Canopies and tents. The open side is at +x."""

import numpy as np

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, shade
from ....meshes.recipe import recipe
from ...shared.outlines import arc
from ...shared.sizes import made


def _pyramid(b: MeshBuilder, half: float, low: float, high: float, color: Color, second: Color | None) -> None:
    """A tented roof of four sides with a valance, seen from both sides."""
    corners = [(half, -half), (half, half), (-half, half), (-half, -half)]
    for k in range(4):
        (x0, y0), (x1, y1) = corners[k], corners[(k + 1) % 4]
        cloth = color if second is None or k % 2 == 0 else second
        rows = []
        for s in np.linspace(0, 1, 5):
            # The slope hangs a little, as cloth does.
            z = low + (high - low) * (s - 0.12 * np.sin(np.pi * s))
            rows.append(
                [(x0 * (1 - s) + e, y0 * (1 - s) + f, z) for e, f in ((0, 0),)] + [(x1 * (1 - s), y1 * (1 - s), z)]
            )
        b.sheet(np.array(rows), cloth, both_sides=True)
        teeth = np.linspace(0, 1, 13)
        upper = [(x0 + (x1 - x0) * t, y0 + (y1 - y0) * t, low) for t in teeth]
        lower = [(x, y, low - (0.2 if i % 2 else 0.28)) for i, (x, y, _) in enumerate(upper)]
        b.sheet(np.array([lower, upper]), shade(cloth, 0.92), both_sides=True)


@recipe("canopy", 3, name="tents.canopy")
def canopy(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A folding gazebo, a wooden pergola with cloth, a striped market canopy."""
    b = MeshBuilder(roughness=0.85)
    if variant % 3 == 1:
        for x in (-1.4, 1.4):
            for y in (-1.9, 1.9):
                b.box((0.14, 0.14, 2.3), (x, y, 0), "wood", bevel=0.012)
            b.box((0.1, 4.4, 0.18), (x, 0, 2.3), "wood", bevel=0.01)
        for y in np.linspace(-1.9, 1.9, 8):
            b.box((3.4, 0.06, 0.15), (0, float(y), 2.48), "wood", bevel=0.008)
        x = np.linspace(-1.5, 1.5, 15)
        z = 2.42 - 0.1 * np.abs(np.sin(3 * np.pi * (x + 1.5) / 3))
        b.sheet(
            np.array([[(a, s * 1.75, c) for a, c in zip(x, z, strict=True)] for s in (-1, 1)]), "cream", both_sides=True
        )
        return made(b, "a wooden pergola with cloth", (3.4, 4.4, 2.65), 0.6, style="pergola")
    cloth, second, half, low, high = (
        ("signal blue", None, 1.48, 2.05, 2.72),
        ("dark red", "off white", 1.9, 2.2, 3.3),
    )[variant // 2]
    for x in (-1, 1):
        for y in (-1, 1):
            post = (x * (half - 0.05), y * (half - 0.05))
            b.box((0.045, 0.045, low), (*post, 0.01), "light grey")
            b.box((0.14, 0.14, 0.012), (*post, 0), "charcoal")
    for k in range(4):
        with b.frame(turn_deg=(0, 0, 90 * k)):
            x = half - 0.05
            for s in (-1, 0):
                y0, y1 = (s * x, (s + 1) * x)
                b.rod((x, y0, low - 0.4), (x, y1, low - 0.05), 0.012, "light grey", sides=5)
                b.rod((x, y0, low - 0.05), (x, y1, low - 0.4), 0.012, "light grey", sides=5)
            b.rod((x, -x, low - 0.02), (0, 0, high - 0.06), 0.014, "light grey", sides=5)
    _pyramid(b, half, low, high, cloth, second)
    return made(b, f"a {cloth} canopy on four posts", (2 * half + 0.04, 2 * half - 0.06, high), 0.7, style="gazebo")


@recipe("tent", 3, name="tents.tent")
def tent(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A walled family tent, a ridge tent, a dome tent; the door at +x."""
    b = MeshBuilder(roughness=0.9)
    if variant % 3 == 0:
        return _family_tent(b)
    if variant % 3 == 1:
        return _ridge_tent(b)
    angles = np.linspace(0, np.pi / 2, 7)
    profile = [(1.1 * float(np.cos(a)) ** 0.85, 1.2 * float(np.sin(a))) for a in angles]
    for k, color in enumerate(("signal red", "light grey")):
        with b.frame(turn_deg=(0, 0, 30 * k)):
            b.lathe(
                [(r * (1 - 0.02 * k), z * (1 - 0.03 * k)) for r, z in profile], color=color, segments=6, crease_deg=20
            )
    for k in range(2):
        b.tube(
            [(1.13 * x, 0, 1.22 * z) for x, z in arc(1.0, 0, 180, 13)]
            if k == 0
            else [(0, 1.13 * x, 1.22 * z) for x, z in arc(1.0, 0, 180, 13)],
            0.014,
            "charcoal",
            sides=6,
        )
    door = [(0.0, 0.3), (0.0, -0.3), (0.55, -0.22), (0.55, 0.22)]
    b.convex(
        [(0.98 - 0.24 * z, y, z + 0.04) for z, y in door] + [(0.95 - 0.35 * 0.75, 0, 0.75)] + [(0.8, 0, 0.3)], "black"
    )
    b.convex(
        [(1.0, y, 0.03) for y in (-0.5, 0.5)]
        + [(1.55, y, 0.0) for y in (-0.4, 0.4)]
        + [(0.75, y, 0.78) for y in (-0.35, 0.35)]
        + [(1.5, y, 0.04) for y in (-0.4, 0.4)],
        "dark red",
    )
    return made(b, "a dome tent", (2.6, 2.2, 1.25), style="dome")


def _family_tent(b: MeshBuilder) -> BuiltAsset:
    """Walls, a pitched fly sheet, windows and flaps rolled aside."""
    # Vault along x: walls, then a pitched roof; the door's flaps are rolled aside.
    half, length = 1.3, 3.0
    section = [(-half, 0), (-half * 0.96, 1.45), (0, 2.1), (half * 0.96, 1.45), (half, 0)]
    rows = [[(x, y, z) for y, z in reversed(section)] for x in (-length / 2, -0.75, 0, 0.75, length / 2)]
    cloth = "dark green"
    b.loft([np.array(r) for r in rows], "orange")
    rows = [[(x, y * 1.06, z + 0.03) for y, z in section[1:4]] for x in (length / 2 + 0.1, -length / 2 - 0.1)]
    b.sheet(np.array(rows), cloth, both_sides=True)
    b.convex(
        [(1.503, y, z) for y, z in ((-0.45, 0.02), (0.45, 0.02), (0.4, 1.5), (-0.4, 1.5))] + [(1.5, 0, 1.72)],
        "black",
    )
    for side in (-1, 1):
        b.tube([(1.53, side * 0.5, 0.02), (1.53, side * 0.45, 1.5)], 0.07, "beige")
        for x in (-1.5, 0, 1.5):
            b.rod((x, side * half, 1.42), (x, side * (half + 0.07), 0.02), 0.008, "off white", sides=5)
        b.panel(
            paint.stripes((24, 12), ("light grey", "dark glass"), 3),
            (0, side * 1.3, 0.95),
            0.9,
            0.55,
            "+y" if side > 0 else "-y",
            back="dark glass",
        )
    for x in (-1.5, 1.5):
        b.rod((x, 0, 0), (x, 0, 2.12), 0.018, "aluminium", sides=8)
    return made(b, "a family tent", (3.2, 2.75, 2.1), style="family")


def _ridge_tent(b: MeshBuilder) -> BuiltAsset:
    """Two poles, guy ropes to pegs, a door of two flaps."""
    half, length = 0.75, 2.1
    rows = [
        np.array([(x, -half, 0), (x, half, 0), (x, 0.02, 1.15), (x, -0.02, 1.15)]) for x in (-length / 2, length / 2)
    ]
    b.loft(rows, "#8a8a52")
    b.convex(
        [(length / 2 + 0.004, y, z) for y, z in ((-0.22, 0), (0.22, 0), (0, 0.95))] + [(length / 2, 0, 0.3)],
        "black",
    )
    for side in (-1, 1):
        b.convex(
            [
                (length / 2 + s, side * y, z)
                for y, z, s in ((0.2, 0, 0.02), (0.46, 0, 0.09), (0.05, 0.95, 0.02), (0.3, 0.5, 0.08))
            ],
            shade("#8a8a52", 0.8),
        )
        x = side * (length / 2 + 0.02)
        b.rod((x, 0, 0), (x, 0, 1.2), 0.016, "wood", sides=8)
        b.rod((x, 0, 1.17), (x + side * 0.5, 0, 0), 0.006, "off white", sides=5)
        for k in (-0.8, 0, 0.8):
            b.rod((k, side * half * 0.6, 0.48), (k, side * (half + 0.3), 0), 0.006, "off white", sides=5)
            b.box((0.03, 0.03, 0.1), (k, side * (half + 0.3), 0), "light wood", taper=(0.5, 0.5))
    return made(b, "a ridge tent", (3.1, 2.15, 1.2), style="ridge")
