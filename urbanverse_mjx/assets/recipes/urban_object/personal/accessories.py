"""Accessories: hats, helmets, gloves, shoes, umbrellas, glasses, watches, jewelry. Front or toes at +x."""

import numpy as np

from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, shade
from ....meshes.recipe import recipe
from ....meshes.shapes import Shape
from ...shared.forms import painted, pillow
from ...shared.outlines import arc
from ...shared.sizes import varied_cm
from ...shared.skins import label, weave


def dome(size: tuple[float, float, float], share: float = 0.5, power: float = 0.9) -> Shape:
    """The upper `share` of a rounded block with base (x, y), `size[2]` high, standing on z = 0."""
    body = pillow((size[0], size[1], size[2] / share), power, power, 20, 14)
    lifted = np.maximum(body.vertices[:, 2] - size[2] / share * (1 - share), 0.0)
    return Shape(np.column_stack([body.vertices[:, :2], lifted]), body.faces)


@recipe("hat", 3, name="accessories.hat")
def hat(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A felt fedora, a baseball cap, a wide straw sun hat."""
    b = MeshBuilder(roughness=0.95)
    style = ("fedora", "baseball cap", "straw sun hat")[variant % 3]
    if style == "baseball cap":
        b.add(dome((19, 16, 12)), "dark blue", (0, 0, 0.6))
        x, y = arc(1.0, -90, 90, 13).T
        brim = [(4 + 12 * px, 7.6 * py) for px, py in zip(x, y, strict=True)]
        rows = brim + [(4 + 5.2 * px, 7.6 * py) for px, py in zip(x[::-1][1:-1], y[::-1][1:-1], strict=True)]
        b.extrude(rows, 0.7, (0, 0, 0.9), "dark red", turn_deg=(0, 6, 0))
        b.ball((0.9, 0.9, 0.6), (0, 0, 12.6), "dark red", segments=10, rings=6)
        for yaw in range(0, 180, 60):
            x, z = arc(1.0, 0, 180, 13).T
            seam = [
                (9.55 * px * np.cos(np.radians(yaw)), 8.1 * px * np.sin(np.radians(yaw)), 0.7 + 12.05 * pz)
                for px, pz in zip(x, z, strict=True)
            ]
            b.tube(seam, 0.18, shade("dark blue", 0.6), sides=4)
        for reach, color in ((2.3, "white"), (1.6, "dark red"), (0.8, "white")):
            b.ball((0.9 - 0.12 * reach, reach, reach), (8.7, 0, 6.0), color, turn_deg=(0, -21, 0), segments=16, rings=6)
    else:
        wide, deep = (26, 29) if style == "fedora" else (40, 42)
        woven = weave("#dcbc7c", "#c49f5c", 64, 2)
        brim = pillow((deep, wide, 1.1), 1.0, 0.3, 28, 4)
        radius = np.linalg.norm(brim.vertices[:, :2] / [deep / 2, wide / 2], axis=1)
        brim.vertices[:, 2] += (2.2 if style == "fedora" else -1.8) * radius**3 * np.abs(
            np.sin(np.arctan2(brim.vertices[:, 1], brim.vertices[:, 0]))
        ) + (0 if style == "fedora" else 1.8)
        crown = pillow((19, 16, 22), 0.95, 0.6, 24, 14)
        crown.vertices[:, 2] = np.maximum(crown.vertices[:, 2] - 11, 0)
        if style == "fedora":
            dent = np.exp(-((crown.vertices[:, 1] / 2.6) ** 2)) * (crown.vertices[:, 2] > 7)
            crown.vertices[:, 2] -= 2.4 * dent
            crown.vertices[:, 1] *= 1 - 0.22 * (crown.vertices[:, 0] > 3) * (crown.vertices[:, 2] > 6)
            b.add(brim, "#6b5a49")
            b.add(crown, "#6b5a49", (0, 0, 0.4), scale=(1, 1, 1.1))
            band: Color = "black"
        else:
            b.add(painted(brim), image=woven)
            b.add(painted(crown), image=woven, at=(0, 0, 1.8), scale=(1, 1, 0.95))
            band = "#b0413e"
        b.add(pillow((19.6, 16.6, 3.4), 0.95, 0.15, 24, 4), band, (0, 0, 1.0 if style == "fedora" else 2.4))
    size = ((29, 26, 13.5), (26, 19, 13), (41, 38, 12))[variant % 3]
    return varied_cm(b, f"a {style}", size, rng, {"style": style})


@recipe("helmet", 3, name="accessories.helmet")
def helmet(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Motorcycle full-face with its visor, bicycle with vents, hard hat of a building site."""
    b = MeshBuilder(roughness=0.3)
    style = ("full-face", "bicycle", "hard hat")[variant % 3]
    if style == "full-face":
        shell = pillow((27, 23, 23), 0.9, 0.85, 24, 14)
        b.add(shell, "#b3202a")
        b.add(pillow((15, 18, 8.5), 0.8, 0.6, 20, 8), "#b3202a", (7.4, 0, 1.2))
        x, y = (1.0 * arc(1.0, -74, 74, 13)).T
        rows = [
            [(13.8 * k * px, 11.7 * k * py, z) for px, py in zip(x, y, strict=True)]
            for z, k in ((9.8, 1.04), (12.0, 1.05), (14.2, 1.035), (16.2, 0.99))
        ]
        b.sheet(np.array(rows), "#20262e")
        b.tube(rows[0], 0.5, "black", sides=5)
        b.tube(rows[-1], 0.5, "black", sides=5)
        for side in (-1, 1):
            b.cylinder(1.9, 0.7, (1.6, side * 11.2, 11.5), "black", turn_deg=(-90 * side, 0, 0), segments=12)
        x, z = arc(1.0, 25, 165, 13).T
        for y in (-2.2, 2.2):
            b.tube([(13.5 * px, y, 11.6 + 11.4 * pz) for px, pz in zip(x, z, strict=True)], 0.6, "white", sides=5)
        b.add(pillow((20, 17, 2), 0.9, 0.4, 20, 4), "black", (-1, 0, -0.4))
    elif style == "bicycle":
        b.add(dome((28, 20.5, 13), power=0.95), "#e8e6df", (0, 0, 2))
        b.add(pillow((27.6, 20.4, 3), 0.95, 0.3, 24, 4), "charcoal", (0, 0, 1))
        for k, y in enumerate((-6.4, -3.2, 0, 3.2, 6.4)):
            x, z = arc(1.0, 20, 155, 15).T
            reach = np.sqrt(1 - (y / 10.25) ** 2)
            path = [(14.1 * reach * px, y, 2 + 13.1 * reach * pz) for px, pz in zip(x, z, strict=True)]
            wide = 1.15 - 0.15 * abs(k - 2)
            b.tube(path, [0.3, *([wide] * 13), 0.3], "black", sides=5)
        for side in (-1, 1):
            b.tube([(6, side * 9.6, 3), (1.5, side * 8, -3), (0, side * 2.2, -5.2)], 0.5, "black", sides=5)
            b.tube([(-6, side * 9.4, 3), (1.5, side * 8, -3)], 0.5, "black", sides=5)
        b.box((2, 5, 1.2), (0, 0, -5.8), "charcoal", bevel=0.3)
    else:
        b.add(dome((25, 20.5, 15), power=0.9), "signal yellow", (0, 0, 1))
        b.add(pillow((27, 22.5, 1.4), 0.95, 0.4, 24, 4), "signal yellow")
        b.add(pillow((13, 17, 1.2), 0.9, 0.4, 20, 4), "signal yellow", (9.4, 0, 0.1), turn_deg=(0, 5, 0))
        x, z = arc(1.0, 12, 168, 13).T
        for y, reach in ((-3, 0.97), (0, 1.02), (3, 0.97)):
            b.tube(
                [(12.4 * reach * px, y, 1 + 15 * reach * pz) for px, pz in zip(x, z, strict=True)],
                0.8,
                "signal yellow",
                sides=6,
            )
        b.panel(label("SITE", "white", "black", (24, 16)), (13.2, 0, 6.2), 6, 4, tilt_deg=14)
    size = ((28.5, 23.5, 22), (29, 21, 19), (30, 23, 16.5))[variant % 3]
    return varied_cm(b, f"a {style} helmet", size, rng, {"style": style})


@recipe("gloves", 3, name="accessories.gloves")
def gloves(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A pair lying flat, fingers to the front: leather, knitted mittens, padded work gloves."""
    b = MeshBuilder(roughness=0.9)
    style = ("leather", "knitted mittens", "work")[variant % 3]
    color: Color = ("#5f3a22", "#3d6f8e", "#d8b13c")[variant % 3]
    cuff: Color = ("#3d2415", "#e9e4d4", "#27436b")[variant % 3]
    for side in (-1, 1):
        with b.frame((0, side * 7.2, 0), (0, 0, side * 4), (1, side, 1)):
            b.add(pillow((11, 9, 4.2), 0.6, 0.7, 20, 8), color, (1, 0, 0.1))
            b.add(pillow((8, 8.6, 4.0), 0.35, 0.6, 20, 6), cuff, (-7.6, 0, 0.2))
            if style == "knitted mittens":
                b.add(pillow((15, 9.6, 4.0), 0.75, 0.7, 20, 8), color, (6.2, 0.4, 0.1))
                for x in (-1, 3, 7):
                    b.add(pillow((1.4, 9.9, 4.4), 0.5, 0.7, 14, 6), "#e9e4d4", (x, 0.2, 0.0))
            else:
                for k, (y, reach) in enumerate(((-3.3, 6.2), (-1.1, 7.6), (1.1, 8.2), (3.3, 7.2))):
                    b.capsule(1.25, reach + 4, (3.2, y, 1.7), color, turn_deg=(0, 90, 5 * (k - 1.5)), segments=8)
                    if style == "work":
                        b.ball((1.6, 1.2, 0.7), (7, y * 1.25, 2.8), cuff, segments=8, rings=5)
            b.tube([(-1.5, -3.4, 1.9), (2.2, -6.0, 1.9), (5.0, -6.6, 1.8)], [1.6, 1.5, 1.2], color, sides=8)
            b.ball(1.2, (5.2, -6.6, 1.8), color, segments=8, rings=6)
            if style == "leather":
                for y in (-1.5, 0, 1.5):
                    b.tube([(-1.5, y, 4.1), (3.5, y * 1.2, 4.2)], 0.2, cuff, sides=4)
    size = ((25, 14, 4.5), (26, 21, 5), (24, 24, 5.5))[variant % 3]
    return varied_cm(b, f"a pair of {style} gloves", size, rng, {"style": style})


def shoe(b: MeshBuilder, upper: Color, sole: Color, style: str) -> None:
    """One left shoe 28 long, toes to +x: sole, upper, opening, laces; the boot with its shaft."""
    outline = [
        (-14, 0),
        (-13, -2.8),
        (-9, -3.6),
        (-2, -3.3),
        (5, -4.4),
        (10.5, -4.2),
        (13.4, -2),
        (14, 0.6),
        (12.6, 3),
        (8, 4.3),
        (1, 4),
        (-6, 3.8),
        (-12, 3),
        (-13.6, 1.4),
    ]
    b.extrude(outline, 1.8 if style != "oxford" else 1.1, color=sole)
    if style == "oxford":
        b.add(pillow((8, 7, 2), 0.6, 0.2, 16, 4), sole, (-9.8, 0.2, -1.2))
    plan = np.array(outline) * [0.97, 0.95]
    low = 1.6 if style != "oxford" else 1.0
    top = np.interp(plan[:, 0], [-14, -6, 0, 4, 9, 14], [8.2, 7.0, 8.0, 6.8, 4.8, 2.6]) + low - 1.5
    rows = [np.column_stack([plan, np.full(len(plan), low)])]
    for share, narrow in ((0.45, 1.0), (0.8, 0.82), (1.0, 0.5)):
        pinch = np.column_stack([plan[:, 0] * (0.985 if share < 1 else 0.96), plan[:, 1] * narrow])
        rows.append(np.column_stack([pinch, low + (top - low) * share]))
    b.loft(rows, upper, crease_deg=70)
    if style == "boot":
        b.add(pillow((13, 8.2, 22), 0.75, 0.25, 18, 6), upper, (-6.6, 0, 4))
        b.add(pillow((11, 6.4, 1), 0.75, 0.3, 18, 4), "black", (-6.6, 0, 25.4))
        b.add(pillow((13.6, 8.8, 2.6), 0.75, 0.4, 18, 4), shade(upper, 0.7), (-6.6, 0, 23.4))
    else:
        b.add(pillow((10.5, 4.6, 1.2), 0.8, 0.4, 16, 4), "charcoal", (-6.8, 0, 6.6 + low - 1.5))
    for k in range(4 if style != "boot" else 5):
        x, z = (-0.4 + 2.4 * k, 7.6 - 0.75 * k + low - 1.5) if style != "boot" else (0.3 + 0.25 * k, 20 - 3.2 * k)
        b.rod((x, -1.9, z), (x + 0.8, 1.9, z), 0.3, "white" if style == "sneaker" else "beige", sides=5)
    if style == "sneaker":
        for side in (-1, 1):
            b.tube(
                [(-5, side * 3.75, 3.4), (0, side * 3.7, 4.4), (3, side * 3.8, 6.2)], [0.2, 0.45, 0.2], "white", sides=5
            )
        b.box((0.8, 3, 3.4), (-13.2, 0, 4.6), "white", bevel=0.3)


@recipe("shoes", 3, name="accessories.shoes")
def shoes(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A pair of sneakers, of laced leather shoes, of boots; toes to the front."""
    b = MeshBuilder(roughness=0.6)
    style = ("sneaker", "oxford", "boot")[variant % 3]
    upper: Color = ("#c33a35", "#3b2216", "#9a6a35")[variant % 3]
    sole: Color = ("white", "black", "#3a2a20")[variant % 3]
    for side in (-1, 1):
        with b.frame((0.8 * side, side * 5.8, 0), (0, 0, 4 * side), (1, side, 1)):
            shoe(b, upper, sole, style)
    size = ((28.5, 21, 12.4), (29.5, 19.5, 10.5), (30, 21.5, 27))[variant % 3]
    return varied_cm(b, f"a pair of {style}s", size, rng, {"style": style})


@recipe("umbrella", 3, name="accessories.umbrella")
def umbrella(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Open umbrellas: a black one with a crook, one in rainbow panels, one lying on its rim to dry."""
    b = MeshBuilder(roughness=0.8)
    style = ("black crook", "rainbow", "drying")[variant % 3]
    colors: tuple[Color, ...] = (
        ("black", "#2b2b2f"),
        ("red", "orange", "yellow", "green", "blue", "purple"),
        ("#2e5b8f", "#ecebe4"),
    )[variant % 3]
    n, r, h = (8, 50.0, 82.0) if style != "rainbow" else (12, 52.0, 78.0)
    with b.frame(turn_deg=(0, 0 if style != "drying" else 62, 0)):
        steps = np.linspace(0.02, 1, 6)
        rise = h - 24 * steps**2.1
        for k in range(n):
            a = 2 * np.pi * (k + np.array([0, 0.5, 1])) / n
            rows = []
            for s, z in zip(steps[::-1], rise[::-1], strict=True):
                sag = np.array([1.0, 0.955, 1.0]) * r * s
                rows.append(np.stack([sag * np.cos(a), sag * np.sin(a), np.full(3, z) - [0, 1.2 * s, 0]], 1))
            b.sheet(np.array(rows), colors[k % len(colors)], both_sides=True)
            c, s = np.cos(a[0]), np.sin(a[0])
            b.tube(
                [(r * t * c, r * t * s, z - 0.5) for t, z in zip(steps[::2], rise[::2], strict=True)],
                0.3,
                "grey",
                sides=4,
            )
            b.rod((0, 0, h - 30), (0.5 * r * c, 0.5 * r * s, h - 6.4), 0.3, "grey", sides=4)
        b.cylinder(0.7, h, (0, 0, 4), "grey" if variant else "dark wood", segments=8)
        b.cylinder(0.5, 6, (0, 0, h), "light grey", segments=8)
        if style == "rainbow":
            b.capsule(2.0, 13, (0, 0, -2), "black", segments=10)
        else:
            hook = arc(4.0, 180, 360, 9)
            b.tube([(0, 0, 12), *((x + 4, 0, 1 + z) for x, z in hook)], 1.4, "wood", sides=8)
    size = ((98, 98, 82), (108, 108, 84), (88, 96, 92))[variant % 3]
    return varied_cm(b, f"an open {style} umbrella", size, rng, {"style": style})
