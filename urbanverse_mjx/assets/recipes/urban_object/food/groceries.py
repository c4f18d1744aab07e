"""Groceries over a counter: sausages, steaks, cheese, eggs, packed snacks. Long ones along x."""

import itertools

import numpy as np

from ....meshes import paint, shapes
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, rgb, shade
from ....meshes.recipe import recipe
from ...shared.forms import bead, painted, pillow, stadium
from ...shared.sizes import varied_cm
from ...shared.skins import skin


@recipe("sausage", 3, name="groceries.sausage")
def sausage(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A grilled one with cuts, a chain of three, a salami with its net."""
    b = MeshBuilder(roughness=0.45)
    style = ("grilled", "chain", "salami")[variant % 3]
    if style == "salami":
        body = pillow((30, 6, 5.8), 0.5, 0.9, 24, 10)
        image = skin(rng, ["#7a3428", "#8e4232", "#7a3428"], noise=14, flecks=("#e6d8c8", 160))
        b.add(painted(body, 0), image=image)
        for x in range(-12, 13, 4):
            b.ring(2.98, 0.12, (x, 0, 2.9), "#efe6d2", turn_deg=(0, 90, 0), segments=16, sides=3)
        b.tube([(14.6, 0, 2.9), (16, 0.4, 3.6), (17.5, -0.4, 4.2), (16, -0.8, 3.4)], 0.2, "#efe6d2", sides=4)
    else:
        count, long = (1, 18.0) if style == "grilled" else (3, 11.0)
        color: Color = "#a4502a" if style == "grilled" else "#b8604a"
        for k in range(count):
            with b.frame(((k - (count - 1) / 2) * (long + 0.4), 0, 0)):
                s = np.linspace(-1, 1, 13)
                path = np.column_stack([s * long / 2, 1.2 * s**2 * (-1) ** k, np.full(13, 1.7)])
                radii = (1.7 * (1 - np.abs(s) ** 5 * 0.92)).tolist()
                b.add(
                    painted(bead(path, radii, 12), 0),
                    image=skin(rng, [shade(color, 0.85), color, shade(color, 0.9)], noise=9),
                    crease_deg=80,
                )
                for n in range(4 if style == "grilled" else 0):
                    b.box((0.5, 2.4, 0.3), (-5.2 + 3.5 * n, 0.3, 3.22), "#e0a878", turn_deg=(0, 0, 32), bevel=0.1)
            if k:
                b.ball(
                    (0.7, 0.5, 0.5),
                    ((k - (count - 1) / 2) * (long + 0.4) - long / 2 - 0.2, 0, 1.7),
                    "#d8b8a0",
                    segments=7,
                    rings=5,
                )
    size = ((18, 4.2, 3.4), (34, 5.4, 3.4), (28, 6.2, 6.2))[variant % 3]
    return varied_cm(b, f"sausage: {style}", size, rng, {"style": style})


@recipe("steak", 2, name="groceries.steak")
def steak(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A raw ribeye with its marbling and rim of fat, a grilled T-bone with its bars."""
    b = MeshBuilder(roughness=0.55)
    style = ("raw ribeye", "grilled T-bone")[variant % 2]
    a = np.linspace(0, 2 * np.pi, 37)[:-1]
    r = 1 + 0.16 * np.cos(a) + 0.14 * np.sin(2 * a + 0.6) + 0.05 * np.cos(3 * a)
    outline = np.column_stack([9 * r * np.cos(a), 5.6 * r * np.sin(a)])
    meat, fat = (("#b0343a", "#f0dccc"), ("#6b3a22", "#c9a070"))[variant % 2]
    heights = (0.0, 0.4, 2.0, 2.4)
    rows = [
        np.column_stack([outline * k, np.full(36, z)]) for k, z in zip((0.96, 1.0, 1.0, 0.96), heights, strict=True)
    ]
    b.loft(rows, meat, crease_deg=60)
    # The fat lies along one long side, as a cushion that bulges out of the meat.
    edge = range(18, 36)
    for low, high in itertools.pairwise(edge):
        ends = [
            (outline[k, 0] * f, outline[k, 1] * f, z)
            for k in (low, high)
            for f, z in ((0.86, 0.1), (1.05, 0.4), (1.05, 2.1), (0.86, 2.5))
        ]
        b.convex(ends, fat)
    for k in range(12 if variant % 2 == 0 else 0):
        x, y = float(rng.uniform(-5.5, 6.5)), float(rng.uniform(-3, 3))
        t = np.linspace(-1, 1, 5)
        b.tube(
            np.column_stack([x + 1.6 * t, y + 0.5 * np.sin(3 * t + k), np.full(5, 2.42)]),
            [0.04, 0.14, 0.18, 0.12, 0.04],
            "#f0d2c6",
            sides=4,
        )
    if variant % 2:
        for k in range(5):
            b.box((0.7, 8.0 - 1.6 * abs(k - 2), 0.12), (-5.4 + 2.4 * k, 0, 2.36), "#24140c", turn_deg=(0, 0, 25))
        b.extrude(
            [(-7.5, -0.5), (3, -0.6), (3, -3.6), (4.2, -3.6), (4.2, 3.4), (3, 3.4), (3, 0.6), (-7.5, 0.5)],
            0.5,
            (0, 0.4, 2.1),
            "#eee2cc",
        )
    size = ((19, 12.5, 3.0), (23, 15, 3.4))[variant % 2]
    return varied_cm(b, f"a {style} steak", size, rng, {"style": style})


@recipe("cheese", 3, name="groceries.cheese")
def cheese(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A wedge with holes, a round soft cheese cut open, a red-waxed ball-like wheel."""
    b = MeshBuilder(roughness=0.6)
    style = ("wedge", "soft round", "waxed wheel")[variant % 3]
    if style == "wedge":
        outline = [(8, 0), (-5, -5), (-5.9, -2.5), (-6.2, 0), (-5.9, 2.5), (-5, 5)]
        b.extrude(outline, 6, color="#f2c84a")
        b.extrude([(-4.7, -5.05), (-6.0, -2.5), (-6.3, 0), (-6.0, 2.5), (-4.7, 5.05), (-4.6, 0)], 6.1, color="#d08a2c")
        side = np.array([13, 5.0]) / np.hypot(13, 5.0)
        normal = np.array([side[1], -side[0]])
        for sgn in (-1, 1):
            for along, z, r in ((3, 4.4, 0.9), (6, 2.0, 1.2), (9.4, 4.0, 0.7), (10.5, 1.6, 0.8), (1.8, 1.6, 0.5)):
                x, y = 8 - along * side[0], sgn * along * side[1]
                yaw = float(np.degrees(np.arctan2(-normal[1] * sgn, normal[0])))
                b.cylinder(r, 0.06, (x, y, z), "#c9952c", turn_deg=(0, 90, yaw), segments=14)
        for x, y, r in ((-2, 1.4, 0.9), (1.8, -0.4, 0.6), (-3.2, -2.2, 0.7), (4, 0.6, 0.4)):
            b.cylinder(r, 0.05, (x, y, 6.0), "#c9952c", segments=14)
    else:
        color, inner = (("#f1ead8", "#f0d890"), ("#b82a22", "#f2c04a"))[variant % 3 - 1]
        mouth = np.radians(np.linspace(30, 330, 28))
        outline = [(0.0, 0.0), *((10 * np.cos(a), 10 * np.sin(a)) for a in mouth)]
        height = 5 if style == "soft round" else 8
        b.extrude([(x * 0.985, y * 0.985) for x, y in outline], height - 0.6, (0, 0, 0.3), inner)
        for z in (0, height - 0.4):
            b.extrude([(x * 0.97, y * 0.97) for x, y in outline], 0.4, (0, 0, z), color)
        rind = ((9.7, 0.0), (10.0, 0.7), (10.0, height - 0.7), (9.7, height))
        rows = [np.column_stack([r * np.cos(mouth), r * np.sin(mouth), np.full(28, z)]) for r, z in rind]
        b.sheet(np.array(rows), color)
        b.extrude([(0, 0), (9.2, -2.4), (9.6, 0), (9.2, 2.4)], height - 0.5, (2.6, 0, 0.2), inner)
    size = ((13.3, 10, 6.0), (14, 12.5, 4.2), (24, 22, 9.5))[variant % 3]
    return varied_cm(b, f"cheese: a {style}", size, rng, {"style": style})


@recipe("egg", 3, name="groceries.egg")
def egg(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Lying: brown, white, speckled."""
    b = MeshBuilder(roughness=0.6)
    color: Color = ("#c98f66", "#f2ede2", "#d8cdb4")[variant % 3]
    t = np.linspace(0, np.pi, 18)
    profile = [(2.2 * np.sin(k) * (1 + 0.17 * np.cos(k)), 2.85 * (1 - np.cos(k))) for k in t]
    body = shapes.lathe([(max(r, 0.0), z) for r, z in profile], 24)
    x, y, z = body.vertices.T
    flecks = (("#a8704a", 40), None, ("#6a4a34", 240))[variant % 3]
    lying = shapes.Shape(np.column_stack([z, y, 2.2 - x]), body.faces)
    b.add(painted(lying), image=skin(rng, [color, shade(color, 1.04)], noise=3, flecks=flecks), crease_deg=80)
    size = ((5.7, 4.4, 4.4), (6.1, 4.5, 4.5), (5.3, 4.15, 4.15))[variant % 3]
    return varied_cm(b, f"a {('brown', 'white', 'speckled')[variant % 3]} egg", size, rng, {"color": str(color)})


def wrapper(words: str, color: Color, ink: Color, size: tuple[int, int]) -> np.ndarray:
    """A printed wrapper: words on a slanting stripe."""
    image, draw = paint.canvas((size[0] * 2, size[1] * 2), color)
    w, h = image.size
    draw.polygon([(0, h * 0.7), (w, h * 0.2), (w, h * 0.75), (0, h)], fill=rgb(shade(color, 0.7)))
    paint.text(draw, words, (w * 0.1, h * 0.25, w * 0.9, h * 0.7), ink, bold=0.06)
    return np.asarray(paint.shrunk(image, size))


@recipe("snacks", 3, name="groceries.snacks")
def snacks(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A chocolate bar in its wrapper, a bag of crisps, a box of biscuits."""
    b = MeshBuilder(roughness=0.35)
    style = ("biscuit box", "bag of crisps", "chocolate bar")[variant % 3]
    if style == "biscuit box":
        front = wrapper("CRUNCH", "#d8a12c", "white", (96, 40))
        b.box(
            (16, 10, 7.5),
            color="#d8a12c",
            skins={
                "+z": np.rot90(wrapper("CRUNCH", "#d8a12c", "white", (64, 96)), 1),
                "+y": front,
                "-y": front,
                "+x": wrapper("12", "#b8741c", "white", (48, 36)),
            },
        )
        for k, x in enumerate((3.2, -1.6)):
            b.cylinder(2.6, 0.4, (x, 2.0 - 3.2 * k, 7.55), "#c98a44", segments=16)
    elif style == "bag of crisps":
        bag = pillow((6, 17, 24), 0.8, 0.55, 20, 12)
        b.add(bag, "#c8281e")
        b.box((0.4, 16.5, 2.2), (0, 0, 22.8), "#e8b83a")
        b.box((0.4, 16.5, 2.0), (0, 0, -0.8), "#e8b83a")
        b.panel(wrapper("CHIPS", "#c8281e", "#f6e060", (64, 48)), (3.08, 0, 13.4), 9, 6.5)
        b.panel(wrapper("CHIPS", "#c8281e", "#f6e060", (64, 48)), (-3.08, 0, 13.4), 9, 6.5, "-x")
        for k, (y, z) in enumerate(((-2.4, 7.4), (1.8, 6.4))):
            b.add(pillow((0.5, 4.2, 3.2), 0.8, 0.9, 12, 6), "#eec45a", (2.7, y, z), turn_deg=(25 * k, 6, 0))
    else:
        b.extrude(stadium(13, 3.4, 0.5), 1.4, color="#5a2a78")
        for x in (-7.2, 7.2):
            b.box((1.6, 3.6, 0.25), (x, 0, 0.55), "#caa0d8")
        b.panel(np.rot90(wrapper("CHOCO", "#5a2a78", "#f6d860", (96, 24)), 1), (0, 0, 1.45), 3.2, 12, "+z")
    size = ((16, 10, 7.5), (6, 17, 25), (14.5, 3.6, 2.1))[variant % 3]
    return varied_cm(b, f"snacks: a {style}", size, rng, {"style": style})
