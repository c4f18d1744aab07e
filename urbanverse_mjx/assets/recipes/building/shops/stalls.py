"""Where a street sells without a house: food trucks, food stalls, kiosks; customers stand at +x."""

import dataclasses

import numpy as np

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, rgb, shade
from ....meshes.recipe import Physics, recipe
from ...amenity.cabinets import front_page
from ...amenity.shelters import glazing
from ...shared.facade_images import awning
from ...vehicle.trucks import box_shape
from ...vehicle.vehicle_body import Body
from ...vehicle.wheels import number_plate, rim_image, wheel

_FOOD_TRUCK = Physics(
    ("steel", "glass", "rubber"), 170.0, (2200.0, 5000.0), 0.6, False, "step vans with a kitchen weigh 2.5-4.5 t"
)


@recipe("food truck", 3, _FOOD_TRUCK, hulls=6, name="trucks.food_truck")
def food_truck(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.5)
    color, accent, name, menu = (
        ("#d8423a", "cream", "TACOS", "TACO 3.50\nBURRITO 6\nNACHOS 4"),
        ("#4fa79b", "white", "ICE CREAM", "SCOOP 2\nCONE 3\nSHAKE 5"),
        ("#e8c24a", "charcoal", "BURGERS", "BURGER 7\nFRIES 3\nCOLA 2"),
    )[variant]
    length = 6.2
    shape = box_shape(length, 2.75, 0.55, 0.37, (-1.75, 1.95), 1.45)
    body = Body(b, dataclasses.replace(shape, width=2.1, sill=0.32))
    body.shell(color)
    f, r = length / 2, -length / 2
    body.across(9.98, 10.98, -0.93, 0.93, "dark glass", lift=0.01)
    body.glasshouse([], (f - 1.75, f - 0.55), frame=0.14, top=2.35)
    body.side([(r + 0.05, 0.62), (f - 0.06, 0.62), (f - 0.06, 0.86), (r + 0.05, 0.86)], accent, 0.006)
    for side in (-1, 1):
        t0, t1 = sorted((side * 0.62, side * 0.92))
        body.across(12.5, 13.2, t0, t1, "lamp", lift=0.014)
        body.across(1.1, 1.6, t0, t1, "red", lift=0.014)
        b.box((0.10, 0.10, 0.28), (f - 0.65, side * 1.16, 1.55), "black", bevel=0.02)
    body.across(
        11.9, 12.6, -0.5, 0.5, image=paint.lettering("= = =", "black", "light grey", (48, 12), bold=0.02), lift=0.014
    )
    body.across(14.0, 15.0, -0.98, 0.98, "charcoal", lift=0.006)
    body.across(14.1, 14.55, -0.16, 0.16, image=number_plate("FT 2026"), lift=0.02)
    body.across(2.1, 4.0, -0.4, 0.4, shade(color, 0.85), lift=0.008)
    # The serving hatch on the right: a dark opening with a lit kitchen, a counter, a raised flap as an awning.
    x0, x1, low, high, y = -2.05, 0.75, 1.15, 2.15, -1.045
    kitchen, pen = paint.canvas((192, 80), "#5a4a38")
    for k in range(8):
        pen.rectangle((10 + 22 * k, 12, 24 + 22 * k, 30), fill=rgb(("red", "amber", "lime", "light grey")[k % 4]))
    pen.ellipse((86, 22, 108, 46), fill=rgb("skin medium"))
    pen.rectangle((78, 46, 116, 80), fill=rgb("white"))
    pen.rectangle((80, 14, 114, 26), fill=rgb("white"))
    pen.rectangle((10, 34, 182, 37), fill=rgb("light wood"))
    b.panel(paint.shrunk(kitchen, (96, 40)), ((x0 + x1) / 2, y - 0.012, (low + high) / 2), x1 - x0, high - low, "-y")
    b.box((x1 - x0 + 0.1, 0.34, 0.04), ((x0 + x1) / 2, y - 0.17, low - 0.04), "aluminium")
    for x in (x0, x1):
        b.box((0.06, 0.05, high - low + 0.06), (x, y - 0.01, low - 0.03), "aluminium")
    cloth = awning(accent, color, (96, 16), 14)
    flap = np.array(
        [
            [(x0 - 0.1, y - 0.95, high + 0.12), (x1 + 0.1, y - 0.95, high + 0.12)],
            [(x0 - 0.1, y, high + 0.35), (x1 + 0.1, y, high + 0.35)],
        ]
    )
    b.sheet(flap, image=cloth, both_sides=True)
    hang = np.array(
        [
            [(x0 - 0.1, y - 0.95, high - 0.06), (x1 + 0.1, y - 0.95, high - 0.06)],
            [(x0 - 0.1, y - 0.95, high + 0.12), (x1 + 0.1, y - 0.95, high + 0.12)],
        ]
    )
    b.sheet(hang, image=cloth, both_sides=True)
    for x in (x0, x1):
        b.rod((x, y, low + 0.6), (x, y - 0.92, high + 0.1), 0.012, "aluminium", sides=5)
    sign = paint.lettering(name, accent, shade(color, 0.7), (128, 24), bold=0.02)
    b.box((2.6, 0.10, 0.5), (-0.65, -0.85, 2.76), accent, skins={"-y": sign})
    body.side_image(-2.2, 0.6, 1.25, 1.78, sign, lift=0.008)
    lines = menu.split("\n")
    board, pen = paint.canvas((96, 112), "#23302a")
    for k, text in enumerate(lines):
        paint.text(pen, text, (8, 10 + 32 * k, 88, 36 + 32 * k), "white")
    b.panel(paint.shrunk(board, (32, 38)), (1.15, y - 0.02, 1.55), 0.55, 0.66, "-y")
    b.cylinder(0.14, 0.35, (-1.6, 0.3, 2.74), "galvanised", segments=10)
    b.cylinder(0.22, 0.08, (-1.6, 0.3, 3.06), "galvanised", segments=10)
    rim = rim_image("steel")
    for x in shape.axles:
        for side in (-1.0, 1.0):
            wheel(b, (x, side * 0.90, 0.37), 0.37, 0.24, rim, side)
    names = ("A red taco truck with its hatch open", "A turquoise ice cream truck", "A yellow burger truck")
    return body.finish(names[variant], {"name": name})


KIOSK = Physics(
    ("wood", "steel"),
    110.0,
    (500.0, 3500.0),
    0.6,
    False,
    "prefabricated kiosks weigh 0.6-3 t and stand on levelling feet",
)


@recipe("kiosk", 4, KIOSK, hulls=8, name="shelters.kiosk")
def kiosk(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Hexagonal heritage newspaper kiosk, flat-roofed snack kiosk, timber hut, modern glazed cube; hatch at +x."""
    b = MeshBuilder(roughness=0.65)
    style = ("heritage", "snack", "timber hut", "modern")[variant % 4]
    color = ("dark green", "red", "wood", "charcoal")[variant % 4]
    if style == "heritage":
        r, h = 1.35, 2.5
        b.cylinder(r, 0.3, color="dark concrete", segments=8, turn_deg=(0, 0, 22.5))
        b.cylinder(r * 0.95, h - 0.3, (0, 0, 0.3), color, segments=8, turn_deg=(0, 0, 22.5))
        side = 2 * r * 0.95 * np.sin(np.pi / 8)
        flat = r * 0.95 * np.cos(np.pi / 8)
        for k in (-2, -1, 0, 1, 2):
            drawn = (
                front_page(48, 48, rng, ("NEWS", "SPORT", "CITY")[k % 3])
                if k
                else glazing(48, 48, 2, 1, "dark green", "dark glass")
            )
            yaw = 45.0 * k
            at = (flat + 0.01) * np.array([np.cos(np.radians(yaw)), np.sin(np.radians(yaw)), 0.0])
            b.panel(drawn, at + np.array([0, 0, 1.55]), side * 0.82, 1.0, yaw)
        b.box((0.4, 1.0, 0.05), (flat + 0.1, 0, 1.0), "dark wood")
        b.lathe(
            [(r + 0.35, h), (r + 0.3, h + 0.12), (0.5, h + 0.5), (0.5, h + 0.7)],
            color=shade(color, 1.2),
            segments=8,
            turn_deg=(0, 0, 22.5),
        )
        b.lathe([(0.58, h + 0.7), (0.3, h + 1.0), (0, h + 1.2)], color="verdigris", segments=8, turn_deg=(0, 0, 22.5))
        sign, draw = paint.canvas((96, 20), color)
        paint.text(draw, "KIOSK", (4, 2, 92, 18), "gold", bold=0.03)
        b.panel(sign, (r + 0.31, 0, h - 0.12), 1.2, 0.25, back=color)
        return b.build("a heritage octagonal newspaper kiosk", {"style": style})
    w, d, h = (float(v) for v in rng.uniform((2.4, 1.8, 2.35), (3.2, 2.2, 2.6)))
    title = {"snack": "SNACKS", "timber hut": "MARKT", "modern": "NEWS + COFFEE"}[style]
    image, draw = paint.canvas((128, 104), color)
    draw.rectangle((12, 22, 116, 66), fill=rgb("dark glass"))
    for k in range(9):
        tall = int(rng.uniform(8, 22))
        ink = rgb(("signal yellow", "red", "green", "white", "orange")[int(rng.integers(5))])
        draw.rectangle((16 + 11 * k, 66 - tall, 24 + 11 * k, 65), fill=ink)
    if style == "timber hut":
        for y in range(70, 104, 8):
            draw.line((0, y, 128, y), fill=rgb(shade(color, 0.7)), width=2)
    b.box(
        (d, w, h),
        color=color,
        skins={"+x": image, "-y": glazing(64, 64, 2, 1, color, "dark glass")} if style == "modern" else {"+x": image},
    )
    b.box((0.35, w * 0.86, 0.05), (d / 2 + 0.15, 0, h * 0.36), "light wood")
    if style == "timber hut":
        b.profile([(-d / 2 - 0.25, h), (d / 2 + 0.5, h), (0, h + 0.7)], w + 0.4, color="brick")
    else:
        b.box((d + 0.6, w + 0.3, 0.14), (0.15, 0, h), "white" if style == "snack" else "aluminium", bevel=0.02)
        rows = [[(d / 2, y, h - 0.1) for y in (w / 2, -w / 2)], [(d / 2 + 0.8, y, h - 0.5) for y in (w / 2, -w / 2)]]
        awning = (
            paint.stripes((128, 16), (color, "white"), 14) if style == "snack" else paint.canvas((16, 16), "teal")[0]
        )
        b.sheet(np.array(rows), image=awning, both_sides=True)
    sign, draw = paint.canvas((128, 24), "cream" if style != "modern" else "white")
    paint.text(draw, title, (6, 3, 122, 21), "dark red", bold=0.03)
    z = h + (0.28 if style != "timber hut" else -0.22)
    b.box(
        (0.06, w * 0.7, 0.34),
        (d / 2 + (0.3 if style != "timber hut" else 0.04), 0, z),
        "cream",
        centered=True,
        skins={"+x": sign},
    )
    return b.build(f"a {style} kiosk", {"style": style})


STALL = Physics(
    ("steel", "fabric", "wood"),
    120.0,
    (60.0, 320.0),
    0.5,
    False,
    "hot-dog carts weigh 80-200 kg with stock, braked wheels",
)


def striped_canopy(b: MeshBuilder, x: float, y: float, z: float, rise: float, color: Color, count: int = 8) -> None:
    """A ridged cloth roof of half sizes x, y with its eaves at z, striped, with a scalloped edge."""
    image = paint.stripes((96, 24), (color, "white"), count)
    for side in (1, -1):
        slope = np.array(
            [[(side * x, -side * y, z), (side * x, side * y, z)], [(0, -side * y, z + rise), (0, side * y, z + rise)]]
        )
        b.sheet(slope, image=image, both_sides=True)
        drop = np.array(
            [
                [(side * x, -side * y, z - 0.18), (side * x, side * y, z - 0.18)],
                [(side * x, -side * y, z), (side * x, side * y, z)],
            ]
        )
        b.sheet(drop, image=image, both_sides=True)
        b.sheet(
            np.array([[(x, side * y, z), (-x, side * y, z)], [(0, side * y, z + rise), (0, side * y, z + rise)]]),
            color,
            both_sides=True,
        )


def _cart(b: MeshBuilder, style: str) -> None:
    """A two-wheeled cart under a parasol."""
    color, words = (("signal red", "HOT DOGS"), ("pink", "ICE CREAM"))[style == "ice cream cart"]
    image, draw = paint.canvas((96, 48), color)
    paint.text(draw, words, (8, 10, 88, 38), "white", bold=0.04)
    b.box((0.75, 1.5, 0.65), (0, 0, 0.3), color, bevel=0.03, skins={"+x": image, "-x": image})
    b.box((0.9, 1.65, 0.05), (0, 0, 0.95), "aluminium", bevel=0.01)
    if style == "hot dog cart":
        b.box((0.5, 0.6, 0.2), (0, 0.35, 1.0), "galvanised", bevel=0.02)
        for k in range(3):
            b.cylinder(
                0.035,
                0.22,
                (0.2, -0.5 + 0.11 * k, 1.0),
                ("red", "signal yellow", "green")[k],
                top_radius=0.015,
                segments=10,
            )
    else:
        for k in range(4):
            b.ball(0.1, (0.1, -0.45 + 0.3 * k, 1.03), ("pink", "cream", "brown", "lime")[k], segments=10, rings=6)
    for y in (-0.8, 0.8):
        with b.frame((0.05, y, 0.28), (90, 0, 0)):
            b.ring(0.26, 0.03, color="rubber", segments=20, sides=6)
            for k in range(4):
                a = np.pi * k / 4
                b.rod(
                    (-0.26 * np.cos(a), -0.26 * np.sin(a), 0),
                    (0.26 * np.cos(a), 0.26 * np.sin(a), 0),
                    0.01,
                    "aluminium",
                    sides=4,
                )
    b.tube(
        [(-0.35, -0.6, 0.85), (-0.75, -0.55, 0.95), (-0.75, 0.55, 0.95), (-0.35, 0.6, 0.85)],
        0.02,
        "aluminium",
        sides=6,
    )
    b.rod((0, -0.1, 0.95), (0, -0.1, 2.35), 0.022, "aluminium")
    for k in range(8):
        a, c = 2 * np.pi * k / 8, 2 * np.pi * (k + 1) / 8
        p, q = ((1.1 * np.cos(t), 1.1 * np.sin(t) - 0.1, 1.98) for t in (a, c))
        b.sheet(np.array([[p, q], [(0, -0.1, 2.4)] * 2]), color if k % 2 else "cream", both_sides=True)


def _stall(b: MeshBuilder, style: str, rng: np.random.Generator) -> None:
    """A counter under a ridged canopy on four posts."""
    color = "green" if style == "fruit stall" else "signal blue"
    w = float(rng.uniform(2.1, 2.5))
    for x in (-0.85, 0.85):
        for y in (-w / 2, w / 2):
            b.rod((x, y, 0), (x, y, 2.15), 0.022, "galvanised")
    striped_canopy(b, 1.05, w / 2 + 0.15, 2.15, 0.5, color, 10)
    b.box((0.9, w - 0.1, 0.06), (0.15, 0, 0.8), "wood")
    skirt = (
        paint.stripes((64, 32), (color, "white"), 10)
        if style == "fruit stall"
        else paint.canvas((96, 32), "signal yellow")[0]
    )
    if style == "taco stand":
        skirt, draw = paint.canvas((96, 32), "signal yellow")
        paint.text(draw, "TACOS", (6, 4, 90, 28), "signal red", bold=0.05)
    b.box((0.85, w - 0.15, 0.7), (0.14, 0, 0.1), shade("wood", 0.8), skins={"+x": skirt})
    if style == "fruit stall":
        inks = ("red", "orange", "lime", "signal yellow", "purple", "green")
        for row in range(2):
            for k in range(5):
                y = -w / 2 + 0.3 + k * (w - 0.6) / 4
                with b.frame((0.36 - 0.42 * row, y, 0.88 + 0.12 * row), (0, 15, 0)):
                    b.box((0.36, 0.38, 0.1), color="light wood")
                    ink = inks[int(rng.integers(6))]
                    for i in range(3):
                        for j in range(3):
                            b.ball(0.06, (-0.11 + 0.11 * i, -0.12 + 0.12 * j, 0.12), ink, segments=6, rings=4)
    else:
        b.box((0.5, 0.8, 0.12), (0, -0.4, 0.86), "charcoal")
        b.cylinder(0.05, 0.5, (0, 0.5, 0.86), "aluminium", segments=10)
        b.lathe([(0.08, 0), (0.17, 0.25), (0.12, 0.42), (0.02, 0.45)], (0, 0.5, 0.92), "brown", segments=14)


@recipe("street food stall", 4, STALL, hulls=8, name="canopies.street_food_stall")
def street_food_stall(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Hot-dog cart with parasol, market stall with fruit, taco stand with canopy, ice-cream cart; customers at +x."""
    b = MeshBuilder(roughness=0.6)
    style = ("hot dog cart", "fruit stall", "taco stand", "ice cream cart")[variant % 4]
    if style in ("hot dog cart", "ice cream cart"):
        _cart(b, style)
    else:
        _stall(b, style, rng)
    return b.build(f"a {style}", {"style": style})
