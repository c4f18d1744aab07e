"""Banners and windsocks. The cloth faces +x."""

import numpy as np
from PIL import Image

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, rgb, shade
from ...meshes.recipe import recipe
from ..shared.sizes import made

#: Share of the convex hull of rippled cloth that lies between its two faces; our estimate of a few shallow folds.
FOLDED = 0.4


def ripple(
    width: float, height: float, depth: float, waves: float, sag: float = 0.0, columns: int = 17, rows: int = 5
) -> np.ndarray:
    """(rows, columns, 3) points of cloth from (0, 0, 0) along +y and up, its folds `depth` deep growing along y."""
    u, v = np.meshgrid(np.linspace(0, 1, columns), np.linspace(0, 1, rows))
    swing = np.minimum(1.0, 0.25 + u) * np.sin(2 * np.pi * (waves * u + 0.12 * v))
    return np.stack([depth / 2 * swing, width * u, height * v - sag * u * u], -1)


def lettered(words: str, back: Color, ink: Color, band: Color, size: tuple[int, int]) -> Image.Image:
    """Printed cloth: words between two bands."""
    image, draw = paint.canvas(paint.smooth(size, 2), back)
    w, h = image.size
    edge = 0.09 * min(w, h)
    for top in (0, h - edge):
        draw.rectangle((0, top, w, top + edge), fill=rgb(band))
    paint.text(draw, words, (w * 0.07, h * 0.14, w * 0.93, h * 0.86), ink, bold=0.03)
    return paint.shrunk(image, size)


@recipe("banner", 3, name="flags.banner")
def banner(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Cloth with eyelets and ropes, a tall one between two rods, a wide one across a street."""
    b = MeshBuilder(roughness=0.9)
    words, back, ink, band, (w, h), image = (
        ("SUMMER\nFAIR", "off white", "red", "signal blue", (1.7, 1.3), (128, 96)),
        ("C\nI\nT\nY", "teal", "white", "signal yellow", (0.72, 2.4), (48, 160)),
        ("GRAND OPENING", "signal yellow", "dark blue", "red", (4.1, 0.95), (224, 52)),
    )[variant % 3]
    cloth = lettered(words, back, ink, band, image)
    depth = (0.028, 0.05, 0.09)[variant % 3]
    folds = ripple(w, h, depth, 2.5 + float(rng.uniform(0, 0.5)), columns=21)
    b.sheet(folds, image=cloth, both_sides=True, lettered=True)
    if variant % 3 == 1:
        for z in (0.0, h):
            b.rod((0, -0.06, z), (0, w + 0.06, z), 0.018, "aluminium", sides=10)
            for y in (-0.06, w + 0.06):
                b.ball(0.026, (0, y, z), "gold", segments=8, rings=6)
    else:
        for z in (0.0, h):
            b.rod((0, 0, z), (0, w, z), 0.008, shade(back, 0.8), sides=6)
            for side in (-1, 1):
                y = w / 2 + side * w / 2
                b.ring(0.016, 0.005, (0, y - side * 0.02, z + 0.02 - 0.04 * (z > 0)), "brass", (0, 90, 0), 10, 4)
                b.rod((0, y, z), (0, y + side * 0.06, z + (0.05 if z else -0.05)), 0.006, "beige", sides=5)
    size = ((0.03, 1.8, 1.4), (0.06, 0.84, 2.5), (0.1, 4.3, 1.05))[variant % 3]
    return made(b, f"a banner that says {' '.join(words.split())}", size, FOLDED, words=words)


@recipe("windsock", 3, name="flags.windsock")
def windsock(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A striped sleeve blown towards +x from a swivel on a mast: orange and white, red and white, plain orange."""
    b = MeshBuilder(roughness=0.8)
    inks, height, droop = (
        (("safety orange", "white"), 5.0, 8.0),
        (("signal red", "white"), 3.6, 24.0),
        (("safety orange", "safety orange"), 6.5, 40.0),
    )[variant % 3]
    b.box((0.4, 0.4, 0.05), color="concrete", bevel=0.01)
    b.cylinder(0.05, height - 0.2, color=("white", "galvanised", "signal red")[variant % 3], top_radius=0.035)
    if variant % 3 == 2:
        for k in range(3):
            b.cylinder(0.052, height * 0.12, (0, 0, height * (0.1 + 0.27 * k)), "white")
    b.rod((0, 0, height - 0.3), (0, 0, height), 0.02, "charcoal")
    with b.frame((0.08, 0, height - 0.24), (0, 90 + droop, 0)):
        b.ring(0.24, 0.012, color="charcoal", segments=20, sides=6)
        for k in range(5):
            r0, r1 = 0.24 - 0.028 * k, 0.24 - 0.028 * (k + 1)
            b.lathe([(r0, 0.27 * k), (r0 * 1.04, 0.27 * k + 0.12), (r1, 0.27 * (k + 1))], color=inks[k % 2])
        b.cylinder(0.092, 0.004, (0, 0, 1.351), "black")
    for z in (-0.1, -0.38):
        b.rod((0, 0, height + z), (0.09, 0, height - 0.24 + (0.22 if z > -0.2 else -0.22)), 0.01, "charcoal", sides=5)
    size = ((1.6, 0.5, 5.0), (1.35, 0.45, 3.6), (1.2, 0.6, 6.5))[variant % 3]
    return made(b, f"a windsock {height:.1f} m high", size, height=height)
