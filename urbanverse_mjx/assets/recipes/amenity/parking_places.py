"""Where vehicles stand or are borrowed: bicycle stands and hire, repair posts, containers, parking bays, platforms."""

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, rgb, shade
from ...meshes.recipe import Physics, recipe
from ..shared.sizes import fitted
from ..vehicle.motorbikes import Motorbike, motorbike
from .transit_places import flat_car


def hire_bicycle(b: MeshBuilder, at: tuple[float, float], color: Color, lean: float = 0.0) -> None:
    """A hire bicycle in few triangles, along x, its front wheel at the dock."""
    with b.frame((at[0], at[1], 0.0), (lean, 0, 0)):
        for x in (-0.53, 0.53):
            b.ring(0.30, 0.025, (x, 0, 0.325), "rubber", (90, 0, 0), segments=12, sides=4)
            b.cylinder(0.05, 0.06, (x, 0.03, 0.325), "grey", (90, 0, 0), segments=6)
        b.tube([(0.40, 0, 0.80), (0.15, 0, 0.42), (-0.10, 0, 0.34), (-0.53, 0, 0.33)], 0.035, color, sides=5)
        b.rod((-0.10, 0, 0.34), (-0.24, 0, 0.85), 0.022, color, sides=5)
        b.rod((0.36, 0, 1.0), (0.53, 0, 0.33), 0.022, color, sides=5)
        b.rod((0.34, -0.28, 1.02), (0.34, 0.28, 1.02), 0.018, "black", sides=5)
        b.box((0.24, 0.17, 0.06), (-0.26, 0, 0.86), "black", bevel=0.02)
        b.box((0.60, 0.10, 0.20), (-0.58, 0, 0.58), color)
        b.box((0.26, 0.34, 0.18), (0.60, 0, 0.76), "charcoal", taper=(1.1, 1.1))


def terminal(b: MeshBuilder, at: tuple[float, float], color: Color, name: str) -> None:
    """The post where one pays: a screen, a map above it."""
    x, y = at
    b.box((0.32, 0.62, 1.42), (x, y, 0.0), color, bevel=0.03)
    image, pen = paint.canvas((128, 288), color)
    paint.text(pen, name, (6, 8, 122, 44), "white", 0.04)
    pen.rectangle((10, 54, 118, 160), fill=rgb("#e6ead8"))
    for k, line in enumerate(((10, 80, 118, 120), (40, 54, 70, 160), (10, 140, 118, 100))):
        pen.line(line, fill=rgb(("amber", "signal blue", "grey")[k]), width=5)
    pen.rectangle((18, 176, 110, 236), fill=rgb("black"))
    pen.rectangle((24, 182, 104, 230), fill=rgb("light blue"))
    b.panel(np.asarray(paint.shrunk(image, (43, 96))), (x + 0.162, y, 0.72), 0.58, 1.3, "+x")


@recipe("bicycle rental", 3, name="parking_places.bicycle_rental")
def bicycle_rental(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.6)
    color, name = (("signal red", "CITY BIKE"), ("#1f8a5a", "VELO GO"), ("signal blue", "BIKE SHARE"))[variant]
    docks, taken = ((9, (0, 1, 3, 4, 6, 8)), (5, (0, 2, 3)), (13, (1, 2, 4, 7, 8, 11)))[variant]
    pitch = 0.72
    width = docks * pitch + 1.3
    b.box((0.5, width, 0.05), (0.72, 0, 0), "galvanised")
    for k in range(docks):
        y = -width / 2 + 0.4 + pitch * k
        b.box((0.22, 0.20, 0.72), (0.78, y, 0.05), "charcoal", taper=(0.7, 0.8), bevel=0.02)
        b.box((0.02, 0.10, 0.08), (0.67, y, 0.62), "light green" if k not in taken else color)
        if k in taken:
            hire_bicycle(b, (0.02, y), color)
    terminal(b, (0.78, width / 2 - 0.4), color, name)
    names = ("A red city bicycle hire rack", "A small green bicycle hire station", "A long blue bike share rack")
    size = ((1.9, 7.5, 1.45), (1.9, 4.9, 1.45), (1.95, 10.4, 1.5))[variant]
    return fitted(b.build(names[variant], {"docks": docks}), size)


@recipe("bicycle repair station", 3, name="parking_places.bicycle_repair_station")
def bicycle_repair_station(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.5)
    color = ("signal blue", "#2f8f52", "safety orange")[variant]
    wide = (0.24, 0.26, 0.34)[variant]
    b.box((0.30, wide + 0.12, 0.015), (0, 0, 0), "dark grey")
    b.box((0.16, wide, 1.36), (0, 0, 0.015), color, bevel=0.03)
    b.box((0.18, wide + 0.02, 0.06), (0, 0, 1.33), shade(color, 0.7), bevel=0.02)
    image, pen = paint.canvas((96, 288), color)
    ink = rgb("white")
    for x in (28, 68):  # a bicycle and a spanner, in white
        pen.ellipse((x - 18, 40, x + 18, 76), outline=ink, width=4)
    pen.line((28, 58, 42, 30, 62, 30, 68, 58), fill=ink, width=4)
    pen.line((42, 30, 52, 58, 28, 58), fill=ink, width=4)
    paint.text(pen, "REPAIR", (8, 90, 88, 116), "white", 0.04)
    pen.rectangle((14, 130, 82, 200), fill=rgb("white"))
    for k in range(5):
        pen.line((20, 140 + 12 * k, 76, 140 + 12 * k), fill=rgb("grey"), width=3)
    b.panel(np.asarray(paint.shrunk(image, (32, 96))), (0.083, 0, 0.72), wide * 0.92, 1.2, "+x")
    for side in (-1, 1):  # the arms that a bicycle's saddle hangs on
        b.rod((0.02, side * wide * 0.3, 1.18), (0.20, side * wide * 0.3, 1.24), 0.022, "black", sides=7)
    for k in range(5):  # tools on cables
        y = -wide * 0.38 + wide * 0.19 * k
        b.rod((0.11, y, 0.98), (0.115, y, 0.78), 0.004, "aluminium", sides=4)
        b.box((0.02, 0.022, 0.12), (0.115, y, 0.66), ("signal red", "black", "signal yellow", "aluminium", "black")[k])
    b.cylinder(0.035, 0.75, (-0.02, wide / 2 + 0.04, 0.02), "black", segments=10)  # the pump and its hose
    b.rod((-0.02, wide / 2 + 0.04, 0.75), (-0.02, wide / 2 + 0.04, 0.98), 0.012, "aluminium", sides=6)
    b.rod((-0.02, wide / 2 - 0.03, 0.98), (-0.02, wide / 2 + 0.10, 0.98), 0.018, "black", sides=6)
    b.tube(
        [
            (0.0, wide / 2 + 0.06, 0.1),
            (0.12, wide / 2 + 0.08, 0.25),
            (0.10, wide / 2 + 0.05, 0.7),
            (0.06, wide / 2, 0.8),
        ],
        0.012,
        "black",
        sides=5,
    )
    names = (
        "A blue bicycle repair post with tools and a pump",
        "A green repair post",
        "An orange bicycle service station",
    )
    size = ((0.32, 0.40, 1.40), (0.34, 0.42, 1.50), (0.36, 0.52, 1.30))[variant]
    return fitted(b.build(names[variant], {"color": str(color)}), size)


def corrugated(color: Color, words: str, ink: Color, ribs: int) -> np.ndarray:
    image, pen = paint.canvas((512, 200), color)
    for k in range(ribs):
        x = 512 * k / ribs
        pen.rectangle((x, 0, x + 256 / ribs, 200), fill=rgb(shade(color, 0.80)))
    if words:
        paint.text(pen, words, (90, 60, 422, 140), ink, 0.04)
    return np.asarray(paint.shrunk(image, (192, 75)))


@recipe("container", 4, name="parking_places.container")
def container(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.6)
    color, words, length = (
        ("#2f5d8f", "OCEAN LINE", 6.06),
        ("#a8442c", "", 12.19),
        ("#3f7a4c", "EVERGO", 6.06),
        ("#c9a23a", "CITY STORE", 3.0),
    )[variant]
    width, high = 2.438, (2.591, 2.896, 2.591, 2.4)[variant]
    side = corrugated(color, words, "white", round(length / 0.28))
    b.box((length - 0.06, width - 0.06, high - 0.06), (0, 0, 0.03), color, skins={"+y": side, "-y": side, "-x": side})
    edge = shade(color, 0.85)
    for x in (-1, 1):
        for y in (-1, 1):
            b.box((0.14, 0.14, high), (x * (length / 2 - 0.07), y * (width / 2 - 0.07), 0), edge)
            for z in (0.0, high - 0.12):  # the castings by which it is lifted
                b.box((0.18, 0.165, 0.12), (x * (length / 2 - 0.09), y * (width / 2 - 0.0825), z), "charcoal")
    for y in (-1, 1):
        for z in (0.0, high - 0.12):
            b.box((length - 0.2, 0.10, 0.12), (0, y * (width / 2 - 0.05), z), edge)
    x = length / 2 - 0.02  # doors look along +x
    for y in (-1, 1):
        b.box((0.04, width / 2 - 0.13, high - 0.28), (x, y * (width / 4 - 0.03), 0.14), color)
        for dy in (0.32, 0.78):
            b.rod((x + 0.035, y * dy, 0.1), (x + 0.035, y * dy, high - 0.1), 0.018, "galvanised", sides=6)
            b.box((0.03, 0.26, 0.04), (x + 0.05, y * (dy - 0.08), 1.05), "galvanised")
    image, pen = paint.canvas((128, 64), color)
    paint.text(pen, "OLGU 204 118 7", (4, 4, 124, 28), "white", 0.03)
    paint.text(pen, "MAX GROSS 30480 KG", (4, 36, 124, 58), "white", 0.02)
    b.panel(np.asarray(paint.shrunk(image, (64, 32))), (x + 0.024, 0.58, high - 0.5), 0.9, 0.42, "+x")
    names = (
        "A blue twenty-foot container",
        "A rust-red forty-foot container",
        "A green container",
        "A yellow storage container",
    )
    return fitted(b.build(names[variant], {"length": length}), (length, width, high))


def bay(b: MeshBuilder, at: tuple[float, float], size: tuple[float, float], lines: Color = "white") -> None:
    """A marked bay: `size` = (along x, along y), its far end closed by a line."""
    x, y = at
    for side in (-1, 1):
        b.box((size[0], 0.10, 0.008), (x, y + side * size[1] / 2, 0.0), lines)
    b.box((0.10, size[1], 0.008), (x - size[0] / 2, y, 0.0), lines)


@recipe("motorcycle parking", 3, name="parking_places.motorcycle_parking")
def motorcycle_parking(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.7)
    width = (4.5, 6.0, 3.2)[variant]
    b.box((2.3, width, 0.06), (0, 0, -0.06), "asphalt")
    count = round(width / 1.1)
    for k in range(count):
        bay(b, (0.0, -width / 2 + (k + 0.5) * width / count), (2.1, width / count - 0.06))
    b.tube(
        [
            (-1.02, -width / 2 + 0.3, 0.0),
            (-1.02, -width / 2 + 0.3, 0.55),
            (-1.02, width / 2 - 0.3, 0.55),
            (-1.02, width / 2 - 0.3, 0.0),
        ],
        0.03,
        "galvanised",
        sides=7,
    )
    y = width / 2 - 0.12
    b.cylinder(0.03, 0.92, (-1.05, y, 0.0), "galvanised", segments=8)
    image, pen = paint.canvas((96, 144), "signal blue")
    paint.text(pen, "P", (20, 8, 76, 76), "white", 0.06)
    for x in (28, 68):
        pen.ellipse((x - 14, 104, x + 14, 132), outline=rgb("white"), width=5)
    pen.polygon([(26, 106), (42, 90), (62, 92), (72, 86), (68, 100), (60, 114), (40, 116)], fill=rgb("white"))
    b.panel(np.asarray(paint.shrunk(image, (32, 48))), (-1.015, y, 0.70), 0.30, 0.42, "+x", back="grey")
    if variant != 0:  # one stands there
        with b.frame((-0.02, -width / 2 + 0.5 * width / count, 0.0), (0, 0, 180)):
            motorbike(
                b, Motorbike("cruiser", ("", "dark red", "teal")[variant], "black", 0.72, 0.98, (0.30, 0.30), 1.34)
            )
    names = (
        "An empty row of motorcycle bays",
        "Motorcycle bays with a red machine",
        "A small motorcycle bay with one machine",
    )
    size = ((2.3, 4.5, 0.92), (2.3, 6.0, 0), (2.3, 3.2, 0))[variant]
    return fitted(b.build(names[variant], {"bays": count}), size)


@recipe("parking", 3, name="parking_places.parking")
def parking(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.8)
    colors = ("white", "signal red", "#5b7fa6", "grey", "black", "#b9b9b4")
    if variant == 2:  # a storeyed garage, open at its sides
        for k in range(4):
            b.box((18.0, 32.0, 0.35), (0, 0, 2.75 * k), "concrete")
            if k:
                for x in (-8.95, 8.95):
                    b.box((0.12, 32.0, 0.9), (x, 0, 2.75 * k), "light grey")
                for y in (-15.95, 15.95):
                    b.box((18.0, 0.12, 0.9), (0, y, 2.75 * k), "light grey")
            for j in range(6 if k < 3 else 0):
                for x in (-8.6, 0, 8.6):
                    b.box((0.45, 0.45, 2.5), (x, -15.0 + 6 * j, 2.75 * k + 0.3), "dark concrete")
        b.box((4.5, 4.0, 11.5), (-6.5, 13.5, 0), "signal blue")
        b.panel(paint.lettering("P", "signal blue", "white", (32, 32)), (-4.24, 13.5, 9.3), 3.2, 3.2, "+x")
        for k in range(4):
            flat_car(b, (6.5, -12.0 + 5.0 * k), 0, colors[k])
        b.panel(paint.lettering("PARKING", "light grey", "signal blue", (96, 16)), (9.02, 0, 3.2), 6.0, 0.8, "+x")
        return fitted(b.build("A concrete parking garage of four decks", {"decks": 4}), (18.0, 32.0, 11.5))
    width, rows = ((26.0, 2), (15.0, 1))[variant]
    depth = (17.0, 8.0)[variant]
    b.box((depth, width, 0.10), (0, 0, -0.10), "asphalt")
    count = int(width / 2.6)
    for row in range(rows):
        x = -depth / 2 + 2.6 if row == 0 else depth / 2 - 2.6
        for k in range(count):
            y = (k - (count - 1) / 2) * 2.55
            with b.frame((0, 0, 0), (0, 0, 0 if row == 0 else 180)):
                bay(b, (-abs(x), y), (5.0, 2.5))
            if rng.uniform() < 0.45:
                flat_car(b, (x, y), 0 if row else 180, colors[int(rng.integers(6))])
    y = width / 2 - 0.35
    b.cylinder(0.05, 2.9, (depth / 2 - 0.4, y, 0), "galvanised", segments=8)
    b.panel(
        paint.lettering("P", "signal blue", "white", (32, 32)), (depth / 2 - 0.34, y, 2.5), 0.7, 0.7, "+x", back="grey"
    )
    b.box((0.35, 0.4, 1.5), (depth / 2 - 0.4, y - 1.3, 0), "signal blue", bevel=0.03)
    names = ("A car park with two rows of bays", "A row of parking bays")
    return fitted(b.build(names[variant], {"bays": rows * count}), ((17.0, 26.0, 3.0), (8.0, 15.0, 2.9))[variant])


@recipe("platform", 3, name="parking_places.platform")
def platform(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.7)
    width, depth, high = ((26.0, 3.4, 0.76), (30.0, 3.2, 0.30), (40.0, 5.0, 0.55))[variant]
    b.box((depth, width, high - 0.06), (0, 0, 0), "concrete")
    b.box((depth + 0.06, width, 0.06), (0, 0, high - 0.06), "dark concrete")
    edge = depth / 2 - 0.2
    for row in range(6):  # the tactile strip, and the line one stands behind
        at = (edge - 0.45, -width / 2 + (row + 0.5) * width / 6, high)
        b.box((0.35, width / 6 - 0.05, 0.006), at, "signal yellow")
    b.box((0.14, width, 0.006), (edge + 0.06, 0, high), "white")
    if variant == 0:
        return fitted(b.build("A railway platform with a yellow safety line", {"height": high}), (depth, width, 0.77))
    sign = paint.lettering("CENTRAL", "signal blue", "white", (96, 20))
    for y in (-width * 0.3, width * 0.3):
        for dy in (-0.9, 0.9):
            b.cylinder(0.04, 2.6, (-depth * 0.35, y + dy, high), "grey", segments=7)
        b.box((0.06, 2.2, 0.45), (-depth * 0.35, y, high + 2.1), "signal blue", skins={"+x": sign, "-x": sign})
        b.box((0.45, 1.8, 0.06), (-depth * 0.35, y, high + 0.42), "wood")
        b.box((0.35, 1.6, 0.42), (-depth * 0.35, y, high), "charcoal")
    for y in (-4.0, 0.0, 4.0):
        b.cylinder(0.09, 2.7, (-depth * 0.25, y, high), "charcoal", segments=8)
    b.box(
        (depth * 0.7, 11.0, 0.15), (-depth * 0.1, 0, high + 2.7), "charcoal" if variant == 1 else "dark red", (0, 4, 0)
    )
    if variant == 1:
        for side in (-1, 1):  # ramps at both ends of a tram stop
            b.convex(
                [(x, side * (width / 2 + d), z) for x in (-1.5, 1.5) for d, z in ((0, 0), (0, high), (2.5, 0))],
                "concrete",
            )
        return fitted(b.build("A low tram platform with a shelter and signs", {"height": high}), (3.2, 35.0, 3.2))
    return fitted(b.build("A station platform with a roof and signs", {"height": high}), (5.0, 40.0, 3.5))


RACK = Physics(
    ("steel",), 2500.0, (12.0, 90.0), 0.5, False, "a Sheffield stand of 50 mm tube weighs 12 kg; cast into the pavement"
)


@recipe("bicycle parking", 3, RACK, hulls=5, name="barriers.bicycle_parking")
def bicycle_parking(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Sheffield hoops, a wave rack, wheel-holder row; bicycles enter along x."""
    b = MeshBuilder(roughness=0.35, metallic=0.3)
    style = ("hoops", "wave", "wheel holders")[variant % 3]
    if style == "hoops":
        count = int(rng.integers(2, 4))
        for k in range(count):
            y = 0.8 * (k - (count - 1) / 2)
            hoop = [
                (-0.38, y, 0),
                (-0.38, y, 0.62),
                (-0.3, y, 0.74),
                (-0.18, y, 0.78),
                (0.18, y, 0.78),
                (0.3, y, 0.74),
                (0.38, y, 0.62),
                (0.38, y, 0),
            ]
            b.tube(hoop, 0.025, "galvanised")
            for x in (-0.38, 0.38):
                b.cylinder(0.07, 0.012, (x, y, 0), "grey", segments=12)
        text = f"{count} bicycle hoops"
    elif style == "wave":
        t = np.linspace(0, 1, 41)
        w = 1.8
        path = [(0.0, w * (s - 0.5), 0.48 - 0.38 * np.cos(2 * np.pi * 3 * s) if 0 < s < 1 else 0.0) for s in t]
        b.tube(path, 0.03, "charcoal")
        for y in (-w / 2, w / 2):
            b.cylinder(0.08, 0.012, (0, y, 0), "charcoal", segments=12)
        text = "a wave bicycle rack"
    else:
        for x in (-0.2, 0.2):
            b.box((0.05, 1.8, 0.05), (x, 0, 0), "galvanised")
        for k in range(5):
            for side in (-0.04, 0.04):
                y = -0.72 + 0.36 * k + side
                loop = [
                    (0.2, y, 0.04),
                    (0.22, y, 0.3),
                    (0.1, y, 0.48),
                    (-0.1, y, 0.48),
                    (-0.2, y, 0.3),
                    (-0.2, y, 0.04),
                ]
                b.tube(loop, 0.01, "galvanised", sides=6)
        text = "a bicycle rack of five wheel holders"
    return b.build(text, {"style": style})
