"""Bus shelters and telephone booths; open or glazed side at +x."""

import numpy as np
from PIL import Image

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, rgb, shade
from ...meshes.recipe import Physics, recipe
from .cabinets import poster

SHELTER = Physics(
    ("steel", "glass"),
    700.0,
    (350.0, 1400.0),
    0.5,
    False,
    "a glazed steel shelter weighs 400-1,200 kg and is bolted to footings",
)


def glazing(width: int, height: int, columns: int, rows: int, frame: Color, pane: Color = "glass") -> Image.Image:
    """Glass panes in a frame, with a slanting sheen."""
    image, draw = paint.canvas((width, height), frame)
    light = rgb(shade(pane, 1.18))
    for c in range(columns):
        for r in range(rows):
            x0, x1 = c * width / columns + 2, (c + 1) * width / columns - 3
            y0, y1 = r * height / rows + 2, (r + 1) * height / rows - 3
            draw.rectangle((x0, y0, x1, y1), fill=rgb(pane))
            w = x1 - x0
            draw.polygon([(x0 + 0.5 * w, y0), (x0 + 0.75 * w, y0), (x0 + 0.3 * w, y1), (x0 + 0.05 * w, y1)], fill=light)
    return image


def glass_wall(
    b: MeshBuilder,
    start: tuple[float, float],
    end: tuple[float, float],
    z: tuple[float, float],
    frame: Color,
    columns: int,
) -> None:
    """A glazed screen between two ground points, visible from both sides."""
    (x0, y0), (x1, y1) = start, end
    length = float(np.hypot(x1 - x0, y1 - y0))
    yaw = float(np.degrees(np.arctan2(y1 - y0, x1 - x0))) - 90
    image = glazing(columns * 32, 64, columns, 1, frame)
    with b.frame(((x0 + x1) / 2, (y0 + y1) / 2, z[0]), (0, 0, yaw)):
        b.box((0.03, length, z[1] - z[0]), color=frame, skins={"+x": image, "-x": image})


@recipe("bus shelter", 3, SHELTER, hulls=10, name="shelters.bus_shelter")
def bus_shelter(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Flat roof with poster end, vaulted roof, heritage hipped roof; open to +x, bench inside."""
    b = MeshBuilder(roughness=0.4)
    style = ("flat", "vaulted", "heritage")[variant % 3]
    frame = ("charcoal", "galvanised", "dark green")[variant % 3]
    w, d, h = float(rng.uniform(3.2, 4.2)), float(rng.uniform(1.3, 1.5)), 2.35
    back, front = -d / 2, d / 2
    for y in (-w / 2, 0.0, w / 2):
        b.box((0.08, 0.08, h), (back, y, 0), frame)
    for y in (-w / 2, w / 2):
        b.box((0.07, 0.07, h), (front - 0.25, y, 0), frame)
    for y0, y1 in ((-w / 2, 0.0), (0.0, w / 2)):
        glass_wall(b, (back, y0 + 0.04), (back, y1 - 0.04), (0.2, h - 0.15), frame, 2)
    glass_wall(b, (back + 0.05, w / 2), (front - 0.3, w / 2), (0.2, h - 0.15), frame, 1)
    if style == "heritage":
        glass_wall(b, (back + 0.05, -w / 2), (front - 0.3, -w / 2), (0.2, h - 0.15), frame, 1)
    else:
        advert = poster(80, 120, rng, variant)
        x = (back + front - 0.25) / 2
        b.box((d - 0.3, 0.14, 1.9), (x, -w / 2, 0.2), frame, skins={"-y": advert, "+y": advert})
    if style == "flat":
        b.box((d + 0.35, w + 0.3, 0.1), (0.1, 0, h), frame, bevel=0.02)
        image, draw = paint.canvas((96, 16), "signal blue")
        paint.text(draw, "BUS  Centre - Station", (4, 2, 92, 14), "white")
        b.box((0.03, 1.6, 0.22), (front + 0.26, 0, h - 0.02), "signal blue", skins={"+x": image})
    elif style == "vaulted":
        t = np.linspace(0, 1, 9)
        arc = [(back - 0.15 + (d + 0.4) * s, h + 0.32 * np.sin(np.pi * s) ** 0.8) for s in t]
        b.profile(arc + [(x, z - 0.05) for x, z in reversed(arc)], w + 0.25, color="light blue")
        b.beam((back, -w / 2, h), (back, w / 2, h), 0.06, 0.1, frame)
        b.beam((front - 0.25, -w / 2, h), (front - 0.25, w / 2, h), 0.06, 0.1, frame)
    else:
        b.box((d + 0.3, w + 0.3, 0.12), (0, 0, h), frame)
        x, y = (d + 0.3) / 2, (w + 0.3) / 2
        ridge = [(0.0, s * (y - x), 0.5) for s in (-1, 1)]
        b.convex([(sx * x, sy * y, 0.0) for sx in (-1, 1) for sy in (-1, 1)] + ridge, "terracotta", at=(0, 0, h + 0.12))
    b.box((0.36, w * 0.6, 0.05), (back + 0.25, 0.2, 0.43), "wood")
    for y in (-w * 0.2 + 0.2, w * 0.2 + 0.2):
        b.box((0.08, 0.06, 0.43), (back + 0.25, y, 0), frame)
    timetable, draw = paint.canvas((40, 56), "white")
    paint.text(draw, "42", (6, 4, 34, 18), "signal blue", bold=0.04)
    for k in range(7):
        draw.line((6, 24 + 4 * k, 34, 24 + 4 * k), fill=(90, 90, 90))
    b.panel(timetable, (back + 0.02, w * 0.38, 1.5), 0.4, 0.56)
    return b.build(f"a {style}-roofed bus shelter {w:.1f} m long", {"style": style, "width": round(w, 3)})


BOOTH = Physics(
    ("steel", "glass"),
    330.0,
    (120.0, 750.0),
    0.5,
    False,
    "cast-iron boxes weigh 700 kg, aluminium booths 150-300 kg; bolted down",
)


@recipe("telephone booth", 3, BOOTH, hulls=2, name="shelters.telephone_booth")
def telephone_booth(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Red domed box, blue-grey aluminium booth, open hooded payphone; door at +x."""
    b = MeshBuilder(roughness=0.45)
    style = ("red box", "aluminium", "hooded payphone")[variant % 3]
    if style == "hooded payphone":
        b.box((0.16, 0.3, 1.1), color="charcoal")
        b.box((0.3, 0.5, 0.03), color="dark grey")
        outline = [(-0.22, 1.05), (0.05, 1.05), (0.34, 1.35), (0.34, 2.0), (-0.22, 2.0)]
        for y in (-0.36, 0.36):
            b.profile(outline, 0.04, (0, y, 0), "signal blue")
        b.box((0.05, 0.7, 0.95), (-0.2, 0, 1.05), "signal blue")
        image, draw = paint.canvas((96, 24), "signal blue")
        paint.text(draw, "PHONE", (6, 3, 90, 21), "white", bold=0.04)
        b.box((0.58, 0.76, 0.2), (0.06, 0, 1.98), "signal blue", bevel=0.02, skins={"+x": image})
        b.box((0.14, 0.3, 0.5), (-0.12, 0, 1.2), "galvanised", bevel=0.01)
        b.box((0.05, 0.05, 0.24), (-0.04, -0.1, 1.36), "black", bevel=0.015)
        for k in range(9):
            b.box((0.01, 0.03, 0.03), (-0.048, 0.03 + 0.045 * (k % 3), 1.36 + 0.05 * (k // 3)), "black")
        return b.build("an open hooded payphone", {"style": style})
    red = style == "red box"
    color = "signal red" if red else "galvanised"
    s, h = (0.9, 2.15) if red else (0.92, 2.1)
    panes = glazing(48, 104, 3, 8, color) if red else glazing(48, 104, 1, 2, color)
    b.box((s + 0.04, s + 0.04, 0.12), color="black" if red else "dark grey")
    b.box((s * 0.92, s * 0.92, h - 0.1), (0, 0, 0.1), color)
    for face, at in (("+x", (1, 0)), ("+y", (0, 1)), ("-y", (0, -1))):
        b.panel(panes, (at[0] * s * 0.463, at[1] * s * 0.463, 0.1 + (h - 0.35) / 2 + 0.06), s * 0.72, h - 0.5, face)
    for x in (-1, 1):
        for y in (-1, 1):
            b.box((0.1, 0.1, h - 0.1), (x * (s / 2 - 0.05), y * (s / 2 - 0.05), 0.1), color)
    image, draw = paint.canvas((80, 20), "cream" if red else "signal blue")
    paint.text(draw, "TELEPHONE", (4, 3, 76, 17), "black" if red else "white", bold=0.02)
    b.box((s, s, 0.26), (0, 0, h), color)
    for face, at in (("+x", (1, 0)), ("+y", (0, 1)), ("-y", (0, -1))):
        b.panel(image, (at[0] * (s / 2 + 0.004), at[1] * (s / 2 + 0.004), h + 0.13), s * 0.7, 0.16, face)
    if red:
        b.lathe(
            [(s * 0.68, 0), (s * 0.6, 0.1), (s * 0.35, 0.17), (0, 0.2)],
            (0, 0, h + 0.26),
            color,
            (0, 0, 45),
            segments=4,
            crease_deg=20,
        )
    else:
        b.box((s + 0.06, s + 0.06, 0.06), (0, 0, h + 0.26), "dark grey", bevel=0.015)
    return b.build(f"a {style} telephone booth", {"style": style})
