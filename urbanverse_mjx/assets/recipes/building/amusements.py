"""Cinemas, casinos, malls, car stores and other large houses of trade and pleasure."""

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, mix, rgb, shade
from ...meshes.recipe import recipe
from ..shared import facade_images as images
from ..shared.sizes import fitted_as, size_of
from . import masonry as m
from .civic_halls import wing
from .services import roller_door
from .shops import icons
from .shops.icons import ICONS, Ink

Point3 = tuple[float, float, float]


def poster(kind: str, color: Color, size: tuple[int, int] = (32, 46)) -> np.ndarray:
    """A framed poster with a pictogram over lines of writing."""
    w, h = paint.smooth(size, 4)
    image, pen = paint.canvas((w, h), color)
    ICONS[kind](Ink(pen, 0.1 * w, 0.1 * w, 0.8 * w), "white")
    for k in range(3):
        pen.rectangle((0.15 * w, h * (0.72 + 0.08 * k), w * (0.85 - 0.1 * k), h * (0.75 + 0.08 * k)), fill=rgb("white"))
    pen.rectangle((0, 0, w - 1, h - 1), outline=rgb("gold"), width=w // 24)
    return np.asarray(paint.shrunk(image, size))


def bulbs(words: str, back: Color, ink: Color, size: tuple[int, int]) -> np.ndarray:
    """Lettering in a border of light bulbs."""
    w, h = paint.smooth(size, 3)
    image, pen = paint.canvas((w, h), back)
    step = h / 7
    for k in range(int(w / step)):
        for y in (0.5 * step, h - 0.5 * step):
            pen.ellipse(((k + 0.2) * step, y - 0.3 * step, (k + 0.8) * step, y + 0.3 * step), fill=rgb("lamp"))
    paint.text(pen, words, (1.2 * step, 1.3 * step, w - 1.2 * step, h - 1.3 * step), ink, 0.04)
    return np.asarray(paint.shrunk(image, size))


def hoarding(b: MeshBuilder, at: Point3, size: tuple[float, float], face: np.ndarray, color: Color) -> None:
    """A thick board facing +x with an image, its lower middle at `at`."""
    b.box((0.3, *size), at, color, skins={"+x": face})


@recipe("cinema", 3, hulls=8, name="amusements.cinema")
def cinema(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A windowless hall behind a lit canopy with the programme, an upright sign and a row of film posters."""
    size, b = size_of("cinema", variant), MeshBuilder(roughness=0.7)
    x, y, z = size
    wall: Color = ("#c9b38a", "#7a3a34", "#5b626b")[variant]
    accent: Color = ("dark red", "gold", "signal blue")[variant]
    high = 0.76 * z
    kind = ("plaster", "brick", "panel")[variant]
    face = images.wall(kind, (y, high), wall, rng, 120)
    m.block(b, (0.86 * x, y, high), (-0.07 * x, 0, 0), face, "dark concrete")
    m.cornice(b, (0.86 * x, y, high), (-0.07 * x, 0, 0), shade(wall, 1.1), 0.02 * y)
    front = 0.36 * x
    for k in range(5 if variant != 2 else 0):  # the stepped crest of an image palace
        w = (0.5 - 0.09 * k) * y
        b.box((0.06 * x, w, 0.06 * z), (front, 0, high - 0.1 * z + 0.055 * z * k), mix(accent, wall, 0.15 * k))
    tall = 0.16 * z
    b.box((0.13 * x, 0.7 * y, tall), (front + 0.065 * x, 0, 0.26 * z), "white")
    hoarding(
        b,
        (front + 0.13 * x, 0, 0.26 * z),
        (0.7 * y, tall),
        bulbs(("GRAND CINEMA", "PALACE", "MULTIPLEX 8")[variant], accent, "white", (200, 40)),
        accent,
    )
    programme, pen = paint.canvas((256, 48), "white")
    paint.text(pen, "NOW SHOWING: THE LAST TRAIN", (8, 8, 248, 40), "black", 0.02)
    b.panel(paint.shrunk(programme, (170, 20)), (front + 0.145 * x, 0, 0.245 * z), 0.7 * y, 0.05 * z)
    for k in range(4):
        for s in (-1, 1):
            film = poster(
                ("hero", "heart", "plane", "skull")[k], ("dark blue", "dark red", "teal", "black")[(k + variant) % 4]
            )
            b.panel(film, (front + 0.04, s * (0.14 + 0.09 * k) * y, 0.12 * z), 0.075 * y, 0.16 * z)
    for k in (-1, 0, 1):
        m.gate(b, (front, 0.07 * y * k, 0), 0.055 * y, 0.19 * z, "charcoal")
    upright = np.asarray(paint.canvas((10, 10), accent)[0])
    image, pen = paint.canvas((96, 360), accent)
    for k, letter in enumerate("CINEMA"):
        paint.text(pen, letter, (20, 8 + 58 * k, 76, 60 + 58 * k), "lamp", 0.04)
    upright = np.asarray(paint.shrunk(image, (32, 120)))
    side = 0.36 * y
    b.box((0.07 * x, 0.5, 0.5 * z), (front + 0.04 * x, side, 0.46 * z), accent, skins={"+y": upright, "-y": upright})
    b.box((0.1, 0.12 * y, 0.44 * z), (front, -side, 0.48 * z), accent, skins={"+x": upright})
    clap = icons.drawn("clapper", 48, "white", mix(accent, "black", 0.4))
    b.panel(clap, (front + 0.03, 0, 0.6 * z), 0.2 * z, 0.2 * z)
    names = ("cinema palace with a lit canopy", "brick picture palace", "modern multiplex")
    return fitted_as(b.build(names[variant]), "cinema", size)


@recipe("casino", 3, hulls=8, name="amusements.casino")
def casino(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A hall with a front of bulbs, giant dice and cards, a gilded entrance."""
    size, b = size_of("casino", variant), MeshBuilder(roughness=0.5)
    x, y, z = size
    wall, accent = (("#5b1f4a", "gold"), ("#e9dcc0", "dark red"), ("#202a4a", "#ff4fd8"))[variant]
    high = 0.66 * z
    face = np.asarray(paint.stripes((120, 40), [wall, shade(wall, 1.18)], 30))
    m.block(b, (0.8 * x, y, high), (-0.1 * x, 0, 0), face, "dark concrete")
    b.box((0.82 * x, 1.01 * y, 0.04 * z), (-0.1 * x, 0, high), accent)
    front = 0.3 * x
    sign = bulbs(
        ("GOLDEN CASINO", "CASINO ROYAL", "LUCKY 7 CASINO")[variant],
        "signal red" if variant != 1 else "dark green",
        "signal yellow",
        (220, 50),
    )
    hoarding(b, (front + 0.1 * x, 0, 0.58 * z), (0.64 * y, 0.22 * z), sign, accent)
    b.box((0.2 * x, 0.5 * y, 0.06 * z), (front + 0.1 * x, 0, 0.34 * z), accent)
    m.columns(
        b,
        front + 0.18 * x,
        list(np.linspace(-0.23, 0.23, 6) * y),
        0,
        0.34 * z,
        0.012 * y,
        accent if variant == 0 else "marble",
    )
    for k in (-1, 0, 1):
        m.gate(b, (front, 0.1 * y * k, 0), 0.08 * y, 0.26 * z, "gold")
    b.panel(icons.drawn("slots", 64, "white", wall), (front + 0.06, 0.4 * y, 0.3 * z), 0.4 * z, 0.4 * z)
    b.panel(icons.drawn("ace", 64, "white", wall), (front + 0.06, -0.4 * y, 0.3 * z), 0.4 * z, 0.4 * z)
    die = icons.drawn("dice", 48, "white", "white")
    side = 0.2 * z
    for k, (dy, turn) in enumerate(((-0.06, 18), (0.06, -24))):
        with b.frame((front - 0.04 * x, dy * y, 0.8 * z - 0.001 * k), (0, 0, turn)):
            b.box((side, side, side), (0, 0, 0), "white", skins={"+x": die, "-x": die, "+y": die, "-y": die, "+z": die})
    if variant == 1:
        m.dome(b, (-0.15 * x, 0, high), 0.13 * y, "verdigris", 0.8)
    names = ("purple casino with a sign of bulbs", "domed casino", "blue casino with neon signs")
    return fitted_as(b.build(names[variant]), "casino", size)


@recipe("department store", 3, hulls=8, name="amusements.department_store")
def department_store(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Four storeys of large windows over a row of show windows, corner tower with a globe, banners."""
    size, b = size_of("department store", variant), MeshBuilder(roughness=0.75)
    x, y, z = size
    wall: m.Wall = (("ashlar", "#d9cdb2"), ("panel", "#b9c2c9"), ("brick", "#8f4a38"))[variant]
    accent: Color = ("dark green", "signal red", "dark blue")[variant]
    low, high = 0.22 * z, 0.84 * z
    wing(
        b,
        (0.94 * x, 0.98 * y, high - low),
        (-0.02 * x, 0, low),
        wall,
        4,
        (("arch", "white"), ("ribbon", "charcoal"), ("grid", "white"))[variant],
        rng,
        5.0,
        (0.72, 0.7),
    )
    b.box((0.94 * x, 0.98 * y, low), (-0.02 * x, 0, 0), accent)
    show = [images.shop_window(goods, accent, rng, (88, 40)) for goods in ("clothes", "bottles")]
    front, count = 0.45 * x, 8
    for k in range(count):
        y0 = (k - (count - 1) / 2) * 0.96 * y / count
        if k in (3, 4):
            m.gate(b, (front + 0.03, y0, 0), 0.6 * y / count, 0.72 * low, "charcoal")
        else:
            b.panel(show[k % 2], (front + 0.04, y0, 0.46 * low), 0.84 * y / count, 0.7 * low)
    b.box((0.05 * x, 0.98 * y, 0.02 * z), (front + 0.02 * x, 0, 0.88 * low), accent)
    for k in range(count):
        with b.frame((front + 0.02 * x, (k - (count - 1) / 2) * 0.96 * y / count, 0.78 * low), (0, 0, 90)):
            b.profile([(-0.42 * y / count, 0), (0.42 * y / count, 0), (0.0, 0.18 * low)], 0.06 * x, color=accent)
    name = ("HARTMANN'S", "GALERIA", "MARLOWE & SONS")[variant]
    hoarding(
        b,
        (front + 0.01 * x, 0, 0.68 * z),
        (0.56 * y, 0.18 * z),
        np.asarray(images.sign(name, accent, "gold", (200, 34))),
        accent,
    )
    for s in (-1, 1):
        banner = np.asarray(images.sign("SALE", "signal red", "white", (24, 56)))
        b.panel(banner, (front + 0.03, s * 0.36 * y, 0.5 * z), 0.05 * y, 0.4 * z)
    r = 0.07 * y
    b.cylinder(r, 0.12 * z, (0.3 * x, -0.38 * y, high), wall[1], segments=12)
    m.dome(b, (0.3 * x, -0.38 * y, high + 0.12 * z), 1.06 * r, "verdigris", 0.5)
    for k in range(4):
        m.flag(b, (front - 0.03 * x, (k - 1.5) * 0.16 * y, high), 0.16 * z, (accent, "white"))
    names = ("stone department store", "modern department store", "brick department store")
    return fitted_as(b.build(names[variant], {"name": name}), "department store", size)


@recipe("shopping mall", 2, hulls=8, name="amusements.shopping_mall")
def shopping_mall(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Broad boxes round a glass vault, with the names of many shops on the front."""
    size, b = size_of("shopping mall", variant), MeshBuilder(roughness=0.6)
    x, y, z = size
    color: Color = ("#d8d2c4", "#c2cad0")[variant]
    face = np.asarray(paint.stripes((160, 24), [color, shade(color, 0.94)], 40))
    for s in (-1, 1):
        m.block(b, (0.84 * x, 0.42 * y, 0.66 * z), (-0.06 * x, s * 0.29 * y, 0), face, "light grey")
        b.box((0.86 * x, 0.425 * y, 0.03 * z), (-0.06 * x, s * 0.29 * y, 0.66 * z), ("orange", "signal blue")[variant])
    glass = m.painted_front((0.2 * y, 0.8 * z), (8, 5), ("panel", "white"), ("ribbon", "white"), rng, 80, (0.9, 0.9))
    b.box((0.96 * x, 0.18 * y, 0.72 * z), (0, 0, 0), "white", skins={"+x": glass, "-x": glass})
    a = np.linspace(0, np.pi, 9)
    arc = [(0.1 * y * np.cos(t), 0.26 * z * np.sin(t)) for t in a]
    with b.frame((0, 0, 0.72 * z), (0, 0, 90)):
        b.profile(arc, 0.96 * x, color="#a9cbd8")
    for k in range(9):
        px = (k / 8 - 0.5) * 0.96 * x
        b.tube([(px, 1.01 * u, 0.72 * z + 1.02 * v) for u, v in arc], 0.012 * z, "white", 4)
    name = ("CITY MALL", "PLAZA")[variant]
    hoarding(
        b,
        (0.49 * x, 0, 0.48 * z),
        (0.17 * y, 0.2 * z),
        np.asarray(images.sign(name, ("signal red", "dark blue")[variant], "white", (140, 40))),
        "black",
    )
    m.gate(b, (0.482 * x, 0, 0), 0.1 * y, 0.24 * z, "aluminium")
    shops = (
        ("FASHION", "black", "white"),
        ("SPORTS", "signal blue", "white"),
        ("TOYS", "signal yellow", "signal red"),
        ("CINEMA", "dark red", "gold"),
        ("FOOD COURT", "orange", "white"),
        ("BOOKS", "dark green", "white"),
    )
    show = images.shop_window("clothes", "charcoal", rng, (90, 30))
    for k, (words, back, ink) in enumerate(shops):
        side, j = (1, -1)[k % 2], k // 2
        y0 = side * (0.16 + 0.13 * j) * y
        m.board(b, words, (0.36 * x, y0, (0.4 + 0.08 * (j % 2)) * z), 0.11 * y, 0.12 * z, back, ink)
        b.panel(show, (0.365 * x, y0, 0.15 * z), 0.12 * y, 0.24 * z)
    for k in range(6):  # flags and trees along the forecourt
        m.flag(
            b,
            (0.47 * x, (0.16 + 0.055 * k) * y * (1, -1)[k % 2], 0),
            0.5 * z,
            ("signal red", "signal yellow", "signal blue"),
        )
    return fitted_as(b.build(f"shopping mall named {name} with a glass vault", {"name": name}), "shopping mall", size)


def display_car(b: MeshBuilder, at: Point3, k: float, color: Color, turn: float = 0.0) -> None:
    """A car of 4.4 m times k, nose along +x."""
    with b.frame(at, (0, 0, turn), k):
        b.box((4.3, 1.75, 0.62), (0, 0, 0.28), color, bevel=0.12)
        b.box((2.3, 1.55, 0.55), (-0.2, 0, 0.86), "dark glass", taper=(0.62, 0.82))
        b.box((1.35, 1.24, 0.06), (-0.2, 0, 1.38), color)
        for px in (-1.35, 1.35):
            for s in (-1, 1):
                b.cylinder(0.33, 0.22, (px, s * 0.8 + 0.11, 0.33), "black", (90, 0, 0), segments=10)
        for s in (-1, 1):
            b.box((0.06, 0.35, 0.14), (2.14, s * 0.6, 0.62), "lamp")


@recipe("car store", 3, hulls=8, name="amusements.car_store")
def car_store(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A glass hall with cars behind the panes and before the door, flags and a name on the roof's edge."""
    size, b = size_of("car store", variant), MeshBuilder(roughness=0.4)
    x, y, z = size
    accent: Color = ("signal blue", "signal red", "charcoal")[variant]
    high = 0.8 * z
    w, h = paint.smooth((200, 48), 3)
    image, pen = paint.canvas((w, h), "#e8eef0")
    pen.rectangle((0, 0, w, 0.55 * h), fill=rgb("#c4dbe6"))
    for k in range(5):
        ICONS["car"](
            Ink(pen, w * (0.02 + 0.2 * k), h - 0.13 * w, 0.17 * w),
            ("signal red", "signal blue", "charcoal", "orange", "teal")[(k + variant) % 5],
        )
    for k in range(11):
        pen.line((w * k / 10, 0, w * k / 10, h), fill=rgb("aluminium"), width=6)
    glass = np.asarray(paint.shrunk(image, (200, 48)))
    b.box((0.6 * x, y, high), (-0.18 * x, 0, 0), "light grey", skins={"+x": glass, "+y": glass, "-y": glass})
    b.box((0.72 * x, 1.04 * y, 0.12 * z), (-0.14 * x, 0, high), accent)
    lettering = np.asarray(images.sign(("AUTOHAUS", "CAR CENTER", "MOTORS")[variant], accent, "white", (200, 22)))
    b.panel(lettering, (0.225 * x, 0, high + 0.06 * z), 0.8 * y, 0.11 * z)
    m.gate(b, (0.125 * x, 0, 0), 0.09 * y, 0.4 * z, "charcoal")
    k = 0.26 * x / 4.4
    for j, y0 in enumerate((-0.36, -0.2, 0.2, 0.36)):
        display_car(
            b,
            (0.33 * x, y0 * y, 0.03 * z),
            k,
            ("signal red", "white", "signal blue", "orange")[(j + variant) % 4],
            0 if variant else 12,
        )
    b.box((0.36 * x, y, 0.03 * z), (0.32 * x, 0, 0), "dark concrete")
    for j in range(4):
        m.flag(b, (0.48 * x, (j - 1.5) * 0.24 * y, 0.03 * z), 0.9 * z, (accent, "white"))
    names = ("car showroom with blue sign", "car centre with red sign", "dark car showroom")
    return fitted_as(b.build(names[variant]), "car store", size)


def tyre_stack(b: MeshBuilder, at: Point3, count: int) -> None:
    for k in range(count):
        b.ring(0.24, 0.11, (at[0], at[1], at[2] + 0.11 + 0.21 * k), "rubber", segments=12, sides=6)


@recipe("auto repair shop", 3, hulls=8, name="amusements.auto_repair_shop")
def auto_repair_shop(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Bays with roller doors, one open on a lifted car; stacks of tyres; an office; a sign with a wrench."""
    size, b = size_of("auto repair shop", variant), MeshBuilder(roughness=0.75)
    x, y, z = size
    wall: m.Wall = (("panel", "#c4cacc"), ("brick", "#8f5a48"), ("plaster", "#e3dcc8"))[variant]
    accent: Color = ("signal blue", "signal red", "signal yellow")[variant]
    high = 0.86 * z
    face = images.wall(wall[0], (y, high), wall[1], rng, 140)
    m.block(b, (0.82 * x, y, high), (-0.08 * x, 0, 0), face, "dark concrete")
    b.box((0.84 * x, 1.01 * y, 0.06 * z), (-0.08 * x, 0, high), accent)
    front, bays = 0.33 * x, (3, 2, 4)[variant]
    step = 0.74 * y / bays
    for k in range(bays):
        y0 = -0.5 * y + 0.02 * y + (k + 0.5) * step
        b.box((0.2, 0.86 * step, 0.62 * z), (front - 0.04, y0, 0), "charcoal")
        if k == 0:  # open: a car on the lift inside
            image, pen = paint.canvas((192, 192), "#3a4046")
            pen.rectangle((0, 150, 192, 192), fill=rgb("dark concrete"))
            for px in (52, 132):
                pen.rectangle((px, 20, px + 10, 160), fill=rgb("signal yellow"))
            ICONS["car"](Ink(pen, 20, 20, 152), "signal red")
            pen.rectangle((20, 128, 172, 136), fill=rgb("signal yellow"))
            b.panel(paint.shrunk(image, (64, 64)), (front + 0.08, y0, 0.3 * z), 0.8 * step, 0.6 * z)
        else:
            b.panel(
                roller_door(("white", "light grey", "signal blue")[variant]),
                (front + 0.08, y0, 0.3 * z),
                0.8 * step,
                0.6 * z,
            )
    office = 0.37 * y
    m.gate(b, (front + 0.02, office + 0.06 * y, 0), 0.06 * y, 0.5 * z, "charcoal")
    b.panel(
        images.window("single", "white", rng, (48, 36)),
        (front + 0.03, office - 0.05 * y, 0.32 * z),
        0.12 * y,
        0.3 * z,
    )
    name = ("AUTO REPAIR", "GARAGE & TYRES", "CAR SERVICE")[variant]
    m.board(
        b, name, (front + 0.02, -0.1 * y, 0.66 * z), 0.62 * y, 0.18 * z, accent, "white" if variant != 2 else "black"
    )
    side = 0.3 * z
    b.box(
        (0.15, side, side),
        (front + 0.06, office, 0.66 * z),
        accent,
        skins={"+x": icons.drawn("wrench", 48, "white", shade(accent, 0.7))},
    )
    for k in range(4):
        tyre_stack(b, (0.44 * x, (0.14 + 0.06 * k) * y, 0), (4, 3, 5, 2)[k])
    display_car(b, (0.36 * x, -0.2 * y, 0), 0.26 * x / 4.4, ("green", "orange", "light blue")[variant])
    names = ("car repair shop of three bays", "brick garage with tyres", "car service of four bays")
    return fitted_as(b.build(names[variant], {"bays": bays}), "auto repair shop", size)
