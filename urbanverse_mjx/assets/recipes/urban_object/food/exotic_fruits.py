"""Fruits that are not round: avocado, banana, kiwi, lemon, papaya, pineapple, watermelon. Lying ones along x."""

from collections.abc import Sequence

import numpy as np

from ....meshes import shapes
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, rgb
from ....meshes.recipe import recipe
from ....meshes.shapes import Point2, Shape
from ...shared.forms import bead, lumpy, painted, pillow, softened
from ...shared.sizes import varied_cm
from ...shared.skins import skin

AVOCADO = ((0, 0.0), (2.0, 0.5), (3.3, 2.0), (3.6, 4.0), (3.2, 6.2), (2.2, 8.2), (1.3, 9.8), (0.5, 10.4), (0, 10.5))
LEMON = ((0, 0.0), (0.6, 0.2), (1.1, 0.8), (2.3, 2.0), (2.9, 4.0), (2.4, 6.0), (1.2, 7.1), (0.8, 7.7), (0, 8.0))
PAPAYA = ((0, 0.0), (1.0, 0.4), (3.6, 3.0), (5.6, 7.5), (5.4, 12.0), (3.8, 16.5), (2.0, 19.2), (0.9, 20.0), (0, 20.0))
OVAL = ((0, 0.0), (1.3, 0.4), (2.4, 1.8), (2.65, 3.3), (2.4, 4.9), (1.3, 6.2), (0, 6.6))


def lying(profile: Sequence[Point2], segments: int = 22) -> Shape:
    """A grown body of revolution laid along x, its first point at the back, on z = 0."""
    body = shapes.lathe(softened(profile), segments)
    radius = max(r for r, _ in profile)
    x, y, z = body.vertices.T
    return Shape(np.column_stack([z, y, radius - x]), body.faces)


def cut_half(
    b: MeshBuilder,
    profile: Sequence[Point2],
    rind: Sequence[tuple[float, Color]],
    rng: np.random.Generator,
    skin_color: Color,
) -> None:
    """Half a fruit lying on its back, its cut face up: rings of (share, colour) from the rind inwards."""
    body = lying(profile)
    radius = max(r for r, _ in profile)
    flat = np.minimum(body.vertices, [np.inf, np.inf, radius])
    b.add(painted(Shape(flat, body.faces)), image=skin(rng, [skin_color], noise=8), crease_deg=60)
    outline = softened(profile, 13)
    ring = np.array([(z, r) for r, z in outline] + [(z, -r) for r, z in outline[-2:0:-1]])
    middle = np.array([ring[:, 0].mean(), 0])
    for k, (share, color) in enumerate(rind):
        cut = (middle + (ring - middle) * share).tolist()
        b.extrude([(x, y) for x, y in cut], 0.02 * radius, (0, 0, radius * (0.99 + 0.006 * k)), color)


@recipe("avocado", 3, name="exotic_fruits.avocado")
def avocado(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Dark and warty, cut in half with its stone, smooth green."""
    b = MeshBuilder(roughness=0.6)
    style = ("dark", "halved", "smooth green")[variant % 3]
    if style == "halved":
        cut_half(b, AVOCADO, ((0.97, "#8fa338"), (0.9, "#d6d36a"), (0.72, "#ece293")), rng, "#33401f")
        b.ball((1.9, 1.9, 1.9), (3.9, 0, 3.7), "#6d3f1f", segments=16, rings=10)
    else:
        body = lumpy(lying(AVOCADO, 26), 0.025, rng, 6 if style == "dark" else 1)
        colors: Sequence[Color] = (
            ["#26301c", "#333f22", "#2a351d"] if style == "dark" else ["#4e7a2c", "#6a9638", "#55822f"]
        )
        b.add(painted(body), image=skin(rng, colors, noise=12, flecks=("#5b6a38", 120)), crease_deg=70)
        b.cylinder(0.45, 0.7, (10.2, 0, 3.6), "#6b5a34", turn_deg=(0, 90, 0), segments=8)
    size = ((10.5, 7.2, 7.2), (10, 7, 6.0), (12.4, 7.4, 7.4))[variant % 3]
    return varied_cm(b, f"a {style} avocado", size, rng, {"style": style})


def finger(length: float, bend: float, fat: float = 1.9) -> tuple[np.ndarray, list[float]]:
    """Middle line in (x, z) along a bow, and radii, of one banana from stalk to tip."""
    s = np.linspace(0, 1, 13)
    angle = (s - 0.5) * bend
    line = np.column_stack([np.sin(angle), 1 - np.cos(angle)]) * length / bend
    radii = np.interp(s, [0, 0.08, 0.16, 0.3, 0.6, 0.82, 0.93, 1], [0.55, 0.5, 0.7, 0.93, 1.0, 0.85, 0.45, 0.25]) * fat
    return line, radii.tolist()


@recipe("banana", 3, name="exotic_fruits.banana")
def banana(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """One lying on its side, a bunch of five, a green one."""
    b = MeshBuilder(roughness=0.6)
    style = ("ripe", "bunch", "green")[variant % 3]
    colors: Sequence[Color] = (
        ["#6b8a2c", "#a8b83a", "#9cb03a", "#7c8f30"]
        if style == "green"
        else ["#8a8a34", "#e2bf33", "#eecb3c", "#ecc838", "#e8c236", "#5a4322"]
    )
    flecks: tuple[Color, int] | None = ("#7a5a22", 60) if style == "ripe" else None
    line, radii = finger(21, 1.35)
    if style == "bunch":
        t = np.linspace(0, 1, 13)
        arch = np.column_stack([-19 * t, 0 * t, 2.2 + 3.0 * (1 - t) + 4.6 * np.sin(np.pi * t)])
        for k in range(5):
            with b.frame((9.5, (k - 2) * 0.9, 0), (0, 0, (k - 2) * 11.0)):
                body = bead(arch * [1, 1, 1 - 0.08 * abs(k - 2)], radii, 8)
                b.add(painted(body, 0), image=skin(rng, colors[::-1], noise=4), crease_deg=80)
        b.add(pillow((3.0, 5.4, 2.6), 0.6, 0.6, 12, 6), "#6f6a2c", (9.6, 0, 4.2), turn_deg=(0, -20, 0))
    else:
        body = bead([(x, z, 1.9) for x, z in line], radii, 9)
        b.add(painted(body, 0), image=skin(rng, colors, noise=4, flecks=flecks), crease_deg=60)
        tip, end = line[0], line[-1]
        b.ball((0.65, 0.65, 0.6), (tip[0], tip[1], 1.9), "#5a4a24", segments=8, rings=5)
        b.ball((0.45, 0.45, 0.45), (end[0], end[1], 1.9), "#332414", segments=8, rings=5)
    size = ((20, 7, 4.0), (20, 16, 9.5), (22, 8, 4.2))[variant % 3]
    return varied_cm(b, f"a {style} banana" if style != "bunch" else "a bunch of bananas", size, rng, {"style": style})


@recipe("kiwi", 3, name="exotic_fruits.kiwi")
def kiwi(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Brown and furry, halved with its green star of seeds, a smooth golden one."""
    b = MeshBuilder(roughness=0.95)
    style = ("brown", "halved", "golden")[variant % 3]
    if style == "halved":
        cut_half(b, OVAL, ((0.95, "#6f9a2c"), (0.86, "#8fbb3a"), (0.42, "#b6d06a"), (0.3, "#eef0c4")), rng, "#6a5030")
        for k in range(16):
            c, s = np.cos(2 * np.pi * k / 16), np.sin(2 * np.pi * k / 16)
            b.ball(
                (0.16, 0.1, 0.05),
                (3.3 + 1.5 * c, 1.15 * s, 2.76),
                "black",
                turn_deg=(0, 0, 22.5 * k),
                segments=6,
                rings=4,
            )
    else:
        colors: Sequence[Color] = (
            ["#6a5030", "#7d6038", "#6a5030"] if style == "brown" else ["#9a7a3c", "#ac8a48", "#9a7a3c"]
        )
        body = lumpy(lying(OVAL, 24), 0.02, rng)
        b.add(painted(body), image=skin(rng, colors, noise=13, flecks=("#a88a58", 150)), crease_deg=80)
        b.cylinder(0.5, 0.25, (-0.1, 0, 2.65), "#3a2a18", turn_deg=(0, 90, 0), segments=10)
        b.cylinder(0.35, 0.3, (6.4, 0, 2.65), "#3a2a18", turn_deg=(0, 90, 0), segments=8)
    size = ((6.6, 5.3, 5.3), (6.2, 5.2, 4.3), (7.4, 5.2, 5.2))[variant % 3]
    return varied_cm(b, f"a {style} kiwi", size, rng, {"style": style})


@recipe("lemon", 3, name="exotic_fruits.lemon")
def lemon(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Yellow with its two tips, halved, a round lime-green one with a leaf."""
    b = MeshBuilder(roughness=0.5)
    style = ("yellow", "halved", "green")[variant % 3]
    if style == "halved":
        cut_half(b, LEMON, ((0.95, "#f4efcf"), (0.84, "#eadc6a")), rng, "#e8c92c")
        for k in range(8):
            a = np.pi / 4 * k + 0.2
            b.beam(
                (4 + 0.3 * np.cos(a), 0.3 * np.sin(a), 2.9),
                (4 + 2.9 * np.cos(a), 2.2 * np.sin(a), 2.9),
                0.14,
                0.2,
                "#f6f1d6",
            )
    else:
        colors: Sequence[Color] = (
            ["#dcb91e", "#eccf34", "#e4c428"] if style == "yellow" else ["#4f8a2c", "#659c36", "#55902e"]
        )
        b.add(
            painted(lumpy(lying(LEMON, 24), 0.02, rng)),
            image=skin(rng, colors, noise=5, flecks=("#cfae1c", 160)),
            crease_deg=80,
        )
        b.cylinder(0.4, 0.4, (-0.25, 0, 2.9), "#6a7a34", turn_deg=(0, 90, 0), segments=8)
        if style == "green":
            blade = pillow((4.5, 2.0, 0.25), 0.8, 0.8, 12, 4)
            b.add(blade, "leaf", (0.6, 1.2, 4.6), turn_deg=(-25, -28, 30))
    size = ((8.0, 5.8, 5.8), (8.4, 6.0, 5.0), (7.2, 5.4, 5.6))[variant % 3]
    return varied_cm(b, f"a {style} lemon", size, rng, {"style": style})


@recipe("papaya", 3, name="exotic_fruits.papaya")
def papaya(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Yellow-green, cut in half with its black seeds, a long orange one."""
    b = MeshBuilder(roughness=0.6)
    style = ("yellow-green", "halved", "long orange")[variant % 3]
    if style == "halved":
        cut_half(b, PAPAYA, ((0.97, "#e8a03c"), (0.92, "#e8742c"), (0.5, "#d85c24")), rng, "#c9a03a")
        for _ in range(34):
            a, r = rng.uniform(0, 2 * np.pi), np.sqrt(rng.uniform(0, 1))
            b.ball(0.5, (9.6 + 4.4 * r * np.cos(a), 1.7 * r * np.sin(a), 5.8), "#23241f", segments=6, rings=4)
    else:
        colors: Sequence[Color] = (
            ["#5f8a34", "#8fa33c", "#d0a83a", "#d8b040"],
            ["#d08a2c", "#e0902e", "#d8842c", "#8a8f34"],
        )[style != "yellow-green"]
        b.add(
            painted(lumpy(lying(PAPAYA, 24), 0.02, rng), 0),
            image=skin(rng, colors, noise=7, flecks=("#8a7a2c", 80)),
            crease_deg=80,
        )
        b.cylinder(1.0, 0.9, (19.6, 0, 5.6), "#6a5a34", turn_deg=(0, 90, 0), segments=10)
    size = ((20, 11.5, 11.5), (19, 11, 9.5), (32, 13.5, 13.5))[variant % 3]
    return varied_cm(b, f"a {style} papaya", size, rng, {"style": style})


@recipe("pineapple", 3, name="exotic_fruits.pineapple")
def pineapple(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Golden with a tall crown, a green one, a small baby pineapple; scales in spirals."""
    b = MeshBuilder(roughness=0.8)
    style = ("golden", "green", "baby")[variant % 3]
    tall, leaves = ((16.0, 26), (18.0, 22), (12.0, 24))[variant % 3]
    base, edge, eye = (
        ("#d09a34", "#8a6a2a", "#e6c060"),
        ("#7f9140", "#55662c", "#b0a850"),
        ("#c98a3c", "#7a6a2c", "#e0b050"),
    )[variant % 3]
    y, x = np.mgrid[:72, :48]
    cell = np.minimum(np.abs((x + y) % 12 - 6), np.abs((x - y) % 12 - 6))
    image = np.array(rgb(base), float) + np.zeros((72, 48, 1))
    image = np.where((cell > 4.4)[..., None], np.array(rgb(edge), float), image)
    centre = ((x + y) % 12 - 0) ** 2 + ((x - y) % 12 - 0) ** 2 < 9
    image = np.where(centre[..., None], np.array(rgb(eye), float), image) + rng.normal(0, 6, (72, 48, 1))
    r = 7.0 if style != "baby" else 5.4
    profile = [
        (0, 0),
        (r * 0.62, 0.1),
        (r * 0.9, tall * 0.14),
        (r, tall * 0.45),
        (r * 0.92, tall * 0.75),
        (r * 0.6, tall * 0.96),
        (0, tall),
    ]
    b.add(painted(shapes.lathe(softened(profile), 24)), image=np.clip(image, 0, 255).astype(np.uint8), crease_deg=80)
    for k in range(leaves):
        out, a = 1 - k / leaves, 2.4 * k
        reach, rise = r * (0.25 + 0.95 * out), tall * (1.0 - 0.45 * out)
        c, s = np.cos(a), np.sin(a)
        foot = np.array([0.8 * c, 0.8 * s, tall * 0.95])
        bend, tip = (
            foot + [reach * 0.55 * c, reach * 0.55 * s, rise * 0.55],
            foot + [reach * c, reach * s, rise * (1 - 0.35 * out)],
        )
        across = np.array([-s, c, 0]) * 0.95
        b.convex(
            [
                foot - across,
                foot + across,
                bend - 0.7 * across,
                bend + 0.7 * across,
                bend + [c * 0.3, s * 0.3, -0.3],
                tip,
            ],
            ("#3f6a2c", "#55803a", "#4a7432")[k % 3],
        )
    size = ((14, 14, 32), (16.5, 16.5, 37), (11.5, 11.5, 24))[variant % 3]
    return varied_cm(b, f"a {style} pineapple", size, rng, {"style": style})


def melon_skin(rng: np.random.Generator, light: Color, dark: Color) -> np.ndarray:
    """Jagged dark stripes from pole to pole."""
    y, x = np.mgrid[:64, :96]
    wobble = 3 * np.sin(y / 5.0 + rng.uniform(0, 6)) + 2 * np.sin(y / 2.3) + rng.normal(0, 1.2, (64, 96))
    stripe = ((x + wobble) % 16) < 7.5
    image = np.where(stripe[..., None], np.array(rgb(dark), float), np.array(rgb(light), float))
    return np.clip(image + rng.normal(0, 6, (64, 96, 1)), 0, 255).astype(np.uint8)


@recipe("watermelon", 3, name="exotic_fruits.watermelon")
def watermelon(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Striped oval, cut open in half, a round dark one."""
    b = MeshBuilder(roughness=0.45)
    style = ("striped", "halved", "round dark")[variant % 3]
    light, dark = (("#8fb85a", "#2c5a2c"), ("#86b052", "#2a5629"), ("#3f6f38", "#1f4524"))[variant % 3]
    oval = [(r * 4.6, z * 4.2) for r, z in OVAL]
    if style == "halved":
        body = shapes.lathe(softened([(0, 0), (5, 0.5), (9.5, 3.6), (12, 8.5), (12.6, 12.6)], 9), 28)
        b.add(painted(body), image=melon_skin(rng, light, dark))
        for radius, z, color in ((12.3, 12.6, "#e6efcf"), (11.4, 12.68, "#e8565a"), (10.6, 12.76, "#d8282f")):
            b.cylinder(radius, 0.12, (0, 0, z), color, segments=28)
        for k in range(22):
            a, r = 2.4 * k, 4.2 + 4.6 * ((k * 7) % 11) / 11
            b.ball(
                (0.75, 0.4, 0.2),
                (r * np.cos(a), r * np.sin(a), 12.95),
                "#1c1412",
                turn_deg=(0, 0, np.degrees(a)),
                segments=6,
                rings=4,
            )
    else:
        b.add(
            painted(lumpy(lying(oval, 28), 0.01, rng), 0),
            image=np.swapaxes(melon_skin(rng, light, dark), 0, 0),
            crease_deg=80,
        )
        b.tube([(27.4, 0, 12.2), (29, 0.4, 12.6), (30, 1.4, 13.2)], [0.5, 0.4, 0.5], "#7a7a3c", sides=6)
    size = ((28.5, 24, 23), (23.5, 23.5, 12.5), (25, 23.4, 24))[variant % 3]
    return varied_cm(b, f"a {style} watermelon", size, rng, {"style": style})
