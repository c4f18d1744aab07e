"""Advertising boards; the poster looks along +x."""

import numpy as np

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.recipe import Physics, recipe
from ...amenity.cabinets import poster

BOARD = Physics(
    ("wood", "aluminium"),
    200.0,
    (6.0, 180.0),
    0.5,
    True,
    "pavement A-boards weigh 6-20 kg; a poster totem is bolted down but light to model",
)


@recipe("advertising board", 4, BOARD, hulls=2, name="cabinets.advertising_board")
def advertising_board(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Chalk sandwich board, white A-board, poster column, illuminated poster totem; faces +x."""
    b = MeshBuilder(roughness=0.6)
    style = ("chalk sandwich board", "sandwich board", "poster column", "poster totem")[variant % 4]
    if "sandwich" in style:
        h, w = float(rng.uniform(0.95, 1.1)), float(rng.uniform(0.58, 0.66))
        if style.startswith("chalk"):
            image, draw = paint.canvas((72, 120), (38, 42, 40))
            paint.text(draw, "TODAY", (10, 6, 62, 28), "white", bold=0.03)
            for k, words in enumerate(("Soup 5", "Pasta 9", "Pie 4", "Coffee 3")):
                paint.text(
                    draw, words, (10, 34 + 20 * k, 62, 50 + 20 * k), ("signal yellow", "pink", "light blue", "lime")[k]
                )
        else:
            image = poster(72, 120, rng, variant)
        frame_color = "wood" if style.startswith("chalk") else "white"
        spread = 0.24
        lean = float(np.degrees(np.arctan2(spread, h)))
        for yaw in (0, 180):
            with b.frame(turn_deg=(0, 0, yaw)):
                with b.frame((spread, 0, 0), (0, -lean, 0)):
                    b.box((0.03, w, h), (-0.012, 0, 0.0), frame_color, skins={})
                    b.panel(image, (0.006, 0, h * 0.54), w * 0.86, h * 0.82)
    elif style == "poster column":
        r, h = 0.6, float(rng.uniform(2.7, 3.1))
        b.cylinder(r + 0.06, 0.3, color="dark concrete", segments=24)
        b.cylinder(r, h - 0.5, (0, 0, 0.28), "off white", segments=24)
        b.lathe(
            [(r + 0.12, h - 0.25), (r + 0.12, h - 0.15), (r * 0.6, h + 0.1), (0, h + 0.25)],
            color="dark green",
            segments=24,
        )
        for k in range(4):
            angles = np.radians(90 * k + np.linspace(-36, 36, 7))
            rows = [[((r + 0.008) * np.cos(a), (r + 0.008) * np.sin(a), z) for a in angles] for z in (0.7, 2.1)]
            b.sheet(np.array(rows), image=poster(72, 120, rng, k))
    else:
        h, w = float(rng.uniform(2.4, 2.7)), 1.25
        b.box((0.2, w * 0.8, 0.35), color="charcoal")
        b.box((0.22, w, h - 0.35), (0, 0, 0.35), "charcoal", bevel=0.02)
        images = poster(96, 144, rng, 2), poster(96, 144, rng, 1)
        for facing, x, drawn in (("+x", 0.114, images[0]), ("-x", -0.114, images[1])):
            b.panel(drawn, (x, 0, 0.35 + (h - 0.35) / 2), w - 0.14, h - 0.5, facing)
    return b.build(f"a {style}", {"style": style})
