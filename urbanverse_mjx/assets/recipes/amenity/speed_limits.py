"""Speed limit signs: the red-rimmed disc of the Vienna Convention, a zone board, and a plate with words."""

import numpy as np
from PIL import Image

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, rgb
from ...meshes.recipe import recipe
from ..shared.sizes import fitted
from .signs import PX, SCALE, disc, done, face, ngon, rectangle

#: km/h -> (width of the plate, height of its upper edge) of the first variant, m: the leaf's medians.
SIZES = {
    10: (0.56, 2.30),
    20: (0.58, 2.40),
    35: (0.61, 2.50),
    40: (0.62, 2.60),
    50: (0.64, 2.60),
    60: (0.66, 2.65),
    100: (0.78, 2.80),
}


def sign_post(b: MeshBuilder, height: float, low: float, high: float, kind: str = "round", depth: float = 0.09) -> None:
    """A tube without a base plate, and the two clamps that hold a plate from low to high; `depth` over all, m."""
    if kind == "round":
        b.cylinder(0.03, height, (-0.034, 0, 0), "galvanised", segments=12)
    elif kind == "square":
        b.box((0.06, 0.06, height), (-0.034, 0, 0), "aluminium")
    else:
        b.box((0.07, 0.09, height), (-0.039, 0, 0), "grey wood", bevel=0.008)
    for share in (0.25, 0.75):
        b.box((depth - 0.004, 0.08, 0.03), (-depth / 2 + 0.004, 0, low + share * (high - low)), "dark grey")


def limit_disc(words: str, ground: Color = "signal red") -> Image.Image:
    """A white disc with a red rim and a number; `ground` lies outside the disc."""
    n = PX * SCALE
    image, draw = face(ground)
    disc(draw, n, 1.0 if ground == "signal red" else 0.92, "signal red")
    disc(draw, n, 0.76 if ground == "signal red" else 0.70, "white")
    half = 0.30 if ground == "signal red" else 0.27
    paint.text(draw, words, (n * (0.5 - half), n * 0.3, n * (0.5 + half), n * 0.7), "black", 0.04)
    return done(image)


def _zone(words: str) -> Image.Image:
    image, draw = face("white", PX, PX * 4 // 3)
    n = PX * SCALE
    draw.rectangle((6, 6, n - 6, n * 4 // 3 - 6), outline=rgb("black"), width=6)
    small = limit_disc(words, "white").resize((n * 9 // 10, n * 9 // 10), Image.Resampling.LANCZOS)
    image.paste(small, (n // 20, n // 24))
    paint.text(draw, "ZONE", (n * 0.14, n * 0.99, n * 0.86, n * 1.25), "black", 0.04)
    return done(image)


def _words(words: str) -> Image.Image:
    image, draw = face("white", PX, PX * 5 // 4)
    w, h = image.size
    draw.rounded_rectangle((8, 8, w - 8, h - 8), 24, outline=rgb("black"), width=10)
    paint.text(draw, "MAXIMUM", (w * 0.1, h * 0.07, w * 0.9, h * 0.22), "black", 0.03)
    paint.text(draw, words, (w * 0.1, h * 0.27, w * 0.9, h * 0.76), "black", 0.05)
    paint.text(draw, "km/h", (w * 0.25, h * 0.79, w * 0.75, h * 0.93), "black", 0.03)
    return done(image)


def _speed_limit(limit: int, variant: int) -> BuiltAsset:
    width, height = SIZES[limit]
    b = MeshBuilder(roughness=0.45)
    words = str(limit)
    depth = 0.08 if limit <= 20 else 0.10 if limit == 100 else 0.09
    low_road = limit <= 20
    if variant == 0:
        sign_post(b, height - 0.03, height - width, height, "round", depth)
        b.plate(ngon(32, width / 2), 0.006, (0, 0, height - width / 2), limit_disc(words))
        kind = "disc"
    elif variant == 1 and limit < 100:
        width, height = width * 0.92, height * 1.06
        tall = width * 4 / 3
        sign_post(b, height, height - tall, height, "square", depth)
        b.plate(rectangle(width, tall), 0.006, (0, 0, height - tall / 2), _zone(words))
        kind = "zone board"
    elif variant == 1:
        width, height = width * 1.12, height * 1.08
        sign_post(b, height, height - width, height, "square", depth)
        b.plate(rectangle(width, width), 0.006, (0, 0, height - width / 2), limit_disc(words, "signal yellow"))
        kind = "disc on a yellow board"
    else:
        width, height = width * 0.88, height * (0.84 if low_road else 0.92)
        tall = width * 5 / 4
        sign_post(b, height, height - tall, height, "wooden" if low_road else "square", depth)
        b.plate(rectangle(width, tall), 0.006, (0, 0, height - tall / 2), _words(words))
        kind = "worded plate"
    built = b.build(f"A {limit} km/h speed limit sign, {kind} on a post", {"limit": limit, "plate": kind})
    return fitted(built, (0, width, height))


def _register(limit: int) -> None:
    @recipe(f"speed limit sign {limit} km", 3, name=f"speed_limits.speed_limit_{limit}")
    def speed_limit(variant: int, rng: np.random.Generator) -> BuiltAsset:
        return _speed_limit(limit, variant)


for _limit in SIZES:
    _register(_limit)
