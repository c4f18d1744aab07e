"""Places of transport: filling station, car wash, car hire, bus station, ferry terminal, parking, platforms."""

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, rgb, shade
from ...meshes.recipe import recipe
from ..shared.sizes import fitted


def glass_front(width: int, height: int, columns: int, frame: Color, door: bool = True) -> np.ndarray:
    """A glazed front of `columns` panes with a door in the middle."""
    image, pen = paint.canvas((width, height), frame)
    step = width / columns
    for k in range(columns):
        x = step * k
        pen.rectangle((x + 4, 6, x + step - 4, height - 6), fill=rgb("glass"))
        pen.line((x + 6, height * 0.75, x + step * 0.6, 8), fill=rgb("#a9c4d0"), width=5)
    if door:
        x = step * (columns // 2)
        pen.rectangle((x, height * 0.14, x + step, height), fill=rgb(shade(frame, 0.6)))
        for k in (0.05, 0.53):
            pen.rectangle((x + step * k, height * 0.2, x + step * (k + 0.42), height - 4), fill=rgb("dark glass"))
    return np.asarray(paint.shrunk(image, (width // 3, height // 3)))


def pump(b: MeshBuilder, at: tuple[float, float, float], color: Color) -> None:
    """A fuel dispenser that faces +x and -x, its hoses at the sides."""
    x, y, z = at
    b.box((0.55, 0.95, 1.75), (x, y, z), color, bevel=0.04)
    b.box((0.57, 0.97, 0.25), (x, y, z + 1.75), "white", bevel=0.03)
    image, pen = paint.canvas((96, 128), "white")
    pen.rectangle((12, 12, 84, 52), fill=rgb("black"))
    paint.text(pen, "48.20", (16, 14, 80, 32), "light green")
    paint.text(pen, "1.799", (16, 33, 80, 50), "light green")
    for k, ink in enumerate(("green", "black", "signal blue")):
        pen.rectangle((14 + 24 * k, 64, 34 + 24 * k, 84), fill=rgb(ink))
    face = np.asarray(paint.shrunk(image, (32, 43)))
    for sign, facing in ((1, "+x"), (-1, "-x")):
        b.panel(face, (x + sign * 0.283, y, z + 1.25), 0.7, 0.9, facing)
        for side in (-1, 1):
            b.box((0.10, 0.10, 0.26), (x + sign * 0.20, y + side * 0.52, z + 0.95), "black")
            hose = [
                (x + sign * 0.2, y + side * 0.55, z + 1.0),
                (x + sign * 0.34, y + side * 0.62, z + 0.35),
                (x + sign * 0.1, y + side * 0.52, z + 1.6),
            ]
            b.tube(hose, 0.025, "black", sides=5)


def price_pylon(b: MeshBuilder, at: tuple[float, float, float], height: float, name: str, color: Color) -> None:
    x, y, z = at
    b.box((0.35, 1.5, height), (x, y, z), color, bevel=0.03)
    image, pen = paint.canvas((192, 384), color)
    paint.text(pen, name, (12, 12, 180, 84), "white", 0.04)
    for k, (label, price) in enumerate((("95", "1.799"), ("98", "1.889"), ("D", "1.699"))):
        pen.rectangle((14, 104 + 90 * k, 178, 180 + 90 * k), fill=rgb("black"))
        paint.text(pen, label, (20, 116 + 90 * k, 66, 168 + 90 * k), "white")
        paint.text(pen, price, (76, 116 + 90 * k, 172, 168 + 90 * k), "amber")
    face = np.asarray(paint.shrunk(image, (64, 128)))
    for sign, facing in ((1, "+x"), (-1, "-x")):
        b.panel(face, (x + sign * 0.18, y, z + height * 0.58), 1.4, height * 0.78, facing)


@recipe("gas station", 3, name="transit_places.gas_station")
def gas_station(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.6)
    color, name, islands = (("signal red", "FUEL", 2), ("#1f7a45", "ECO OIL", 3), ("#1b4f9c", "PETROL", 1))[variant]
    width = (18.0, 24.0, 11.0)[variant]
    b.box((12.0, width, 0.14), (0, 0, 0), "concrete")
    shop = width * 0.55
    b.box((4.0, shop, 3.4), (-3.9, 0, 0.14), "off white")
    b.panel(glass_front(480, 120, 8, "grey"), (-1.885, 0, 1.65), shop * 0.92, 2.8, "+x")
    b.box((0.5, shop + 0.2, 0.7), (-1.95, 0, 3.2), color)
    b.panel(paint.lettering("SHOP  24h", color, "white", (96, 16)), (-1.69, 0, 3.55), shop * 0.5, 0.6, "+x")
    low = 4.55
    b.box((6.6, width * 0.92, 0.9), (2.3, 0, low), color, bevel=0.04)
    b.box((6.64, width * 0.922, 0.28), (2.3, 0, low + 0.2), "white")
    words = paint.lettering(name, color, "white", (96, 20))
    for sign, facing in ((1, "+x"), (-1, "-x")):
        b.panel(words, (2.3 + sign * 3.33, 0, low + 0.45), 4.0, 0.8, facing)
    for sign, facing in ((1, "+y"), (-1, "-y")):
        b.panel(words, (2.3, sign * (width * 0.461 + 0.012), low + 0.45), 3.6, 0.75, facing)
    for k in range(islands):
        y = (k - (islands - 1) / 2) * width * 0.92 / (islands + 0.2)
        b.box((4.6, 1.3, 0.18), (2.3, y, 0.14), "light grey", bevel=0.05)
        for x in (0.9, 3.7):
            b.box((0.4, 0.4, low - 0.1), (x, y, 0.2), "white")
            pump(b, (x + (0.75 if x < 2 else -0.75), y, 0.32), color)
        b.box((0.3, 0.12, 0.5), (4.5, y, 0.32), "signal yellow", bevel=0.03)
    price_pylon(b, (5.2, width / 2 - 1.0, 0.14), 5.0, name, color)
    names = ("A filling station with a red canopy", "A large green filling station", "A small blue petrol station")
    size = ((12.0, 18.0, 5.5), (13.0, 24.0, 5.6), (11.0, 12.0, 5.3))[variant]
    return fitted(b.build(names[variant], {"islands": islands}), size)


@recipe("car wash", 3, name="transit_places.car_wash")
def car_wash(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.6)
    color, bays = (("#1f6fb5", 1), ("signal red", 3), ("#2a8f7a", 1))[variant]
    length, width, high = ((12.0, 5.6, 4.0), (7.5, 14.0, 3.7), (9.5, 5.2, 3.9))[variant]
    each = width / bays
    b.box((length, width, 0.10), (0, 0, 0), "dark concrete")
    for k in range(bays + 1):  # walls between which cars drive through along x
        y = -width / 2 + k * each + (0.12 if k == 0 else -0.12 if k == bays else 0)
        b.box((length, 0.24, high - 0.6), (0, y, 0.1), "off white")
    if bays == 1:
        for side, facing in ((1, "+y"), (-1, "-y")):
            b.panel(
                glass_front(480, 100, 8, "off white", False),
                (0, side * (width / 2 + 0.004), 1.9),
                length * 0.85,
                1.8,
                facing,
            )
    b.box((length, width, 0.7), (0, 0, high - 0.6), color, bevel=0.03)
    words = paint.lettering("CAR WASH", color, "white", (96, 16))
    for side, facing in ((1, "+x"), (-1, "-x")):
        b.panel(words, (side * (length / 2 + 0.006), 0, high - 0.25), min(width * 0.8, 5.0), 0.6, facing)
    for side, facing in ((1, "+y"), (-1, "-y")):
        b.panel(words, (0, side * (width / 2 + 0.006), high - 0.25), 5.0, 0.6, facing)
    for k in range(bays):
        y = -width / 2 + (k + 0.5) * each
        if variant != 1:
            # Brushes: two upright and one lying, on a gantry just inside the entrance.
            for x in (length / 2 - 1.2, -length / 2 + 2.2):
                for side in (-1, 1):
                    b.cylinder(
                        0.50,
                        2.4,
                        (x, y + side * (each / 2 - 0.85), 0.15),
                        ("signal blue", "signal red")[side > 0],
                        segments=12,
                    )
                    b.box((0.5, 0.25, high - 0.8), (x - 0.7, y + side * (each / 2 - 0.4), 0.1), "signal yellow")
                b.cylinder(
                    0.42,
                    each - 1.3,
                    (x - 0.7, y + each / 2 - 0.65, high - 1.25),
                    "signal blue",
                    (90, 0, 0),
                    segments=12,
                )
        else:  # self-service lances
            b.rod((0, y, high - 0.7), (0, y + 1.2, high - 0.9), 0.04, "aluminium", sides=6)
            b.tube(
                [(0, y + 1.2, high - 0.9), (0.1, y + 1.5, 1.6), (0.3, y + each / 2 - 0.3, 1.1)], 0.03, "black", sides=5
            )
            b.box((0.4, 0.25, 1.1), (length / 2 - 0.8, y + each / 2 - 0.4, 0.5), "signal yellow", bevel=0.03)
        for x in (length / 2 - 0.03,):
            b.box((0.06, 0.24, high - 0.7), (x, y - each / 2 + 0.14, 0.1), "signal yellow")
    b.box((0.25, 0.6, 1.5), (length / 2 + 0.0, width / 2 - 0.55, 0.1), color, bevel=0.03)
    names = ("A blue roll-over car wash", "A red self-service car wash of three bays", "A green car wash tunnel")
    size = ((12.0, 6.0, 4.4), (14.0, 9.0, 4.0), (10.0, 5.5, 4.3))[variant]
    if variant == 1:
        size = (7.6, 13.5, 4.0)
    return fitted(b.build(names[variant], {"bays": bays}), size)


def flat_car(b: MeshBuilder, at: tuple[float, float], yaw: float, color: Color) -> None:
    """A car in few triangles, for lots seen as a whole."""
    with b.frame((at[0], at[1], 0.10), (0, 0, yaw)):
        b.profile([(-2.1, 0.25), (2.1, 0.25), (2.15, 0.65), (1.1, 0.85), (-2.05, 0.9)], 1.7, (0, 0, 0), color)
        b.profile([(-1.7, 0.88), (0.95, 0.86), (0.3, 1.35), (-1.2, 1.38)], 1.5, (0, 0, 0), "dark glass")
        b.box((1.4, 1.35, 0.04), (-0.45, 0, 1.37), color)
        for x in (-1.3, 1.3):
            for side in (-1, 1):
                b.cylinder(0.30, 0.2, (x, side * 0.76 + 0.10, 0.30), "rubber", (90, 0, 0), segments=10)


@recipe("car rental", 3, name="transit_places.car_rental")
def car_rental(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.6)
    color, ink, name = (
        ("#f2c417", "black", "RENT A CAR"),
        ("#1e8a4c", "white", "GO RENTAL"),
        ("signal red", "white", "CAR HIRE"),
    )[variant]
    width, depth = ((15.0, 10.0), (19.0, 12.0), (10.5, 8.0))[variant]
    b.box((depth, width, 0.10), (0, 0, 0), "asphalt")
    office = depth * 0.45
    x = -depth / 2 + office / 2
    b.box((office, width * 0.96, 3.6), (x, 0, 0.1), "white")
    front = x + office / 2
    b.panel(glass_front(600, 120, 9, "charcoal"), (front + 0.006, 0, 1.6), width * 0.90, 2.8, "+x")
    b.box((0.6, width, 1.1), (front - 0.1, 0, 3.3), color)
    b.panel(paint.lettering(name, color, ink, (128, 16)), (front + 0.207, 0, 3.85), width * 0.6, 0.85, "+x")
    for side, facing in ((1, "+y"), (-1, "-y")):
        b.panel(
            paint.lettering(name, "white", "black", (96, 16)),
            (x, side * (width * 0.48 + 0.006), 2.4),
            office * 0.8,
            0.7,
            facing,
        )
    count = int(width / 2.9)
    for k in range(count):
        y = (k - (count - 1) / 2) * 2.8
        b.box((4.6, 0.10, 0.012), (depth / 2 - 2.4, y - 1.4, 0.10), "white")
        if k != 1:
            flat_car(b, (depth / 2 - 2.45, y), 0, ("white", "signal red", "#5b7fa6", "grey", color, "black")[k % 6])
    b.box((0.2, 0.2, 4.0), (depth / 2 - 0.4, width / 2 - 0.5, 0.1), "grey")
    b.box(
        (0.2, 1.0, 1.0),
        (depth / 2 - 0.4, width / 2 - 0.5, 3.7),
        color,
        skins={"+x": paint.lettering("RENT", color, ink, (32, 32))},
    )
    names = ("A car hire office in yellow with its lot", "A large green car rental", "A small red car hire office")
    size = ((10.0, 15.0, 4.7), (12.5, 19.0, 4.9), (8.2, 11.0, 4.5))[variant]
    return fitted(b.build(names[variant], {"name": name}), size)


@recipe("bus station", 2, name="transit_places.bus_station")
def bus_station(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.6)
    color, bays = (("signal blue", 4), ("dark red", 6))[variant]
    width, depth = ((42.0, 16.0), (60.0, 20.0))[variant]
    b.box((depth, width, 0.15), (0, 0, 0), "asphalt")
    hall = width * 0.3
    b.box((depth * 0.55, hall, 4.6), (-depth * 0.2, -width / 2 + hall / 2, 0.15), "off white")
    b.panel(glass_front(600, 160, 8, "charcoal"), (depth * 0.076, -width / 2 + hall / 2, 2.1), hall * 0.9, 3.6, "+x")
    b.box((0.5, hall, 0.9), (depth * 0.08, -width / 2 + hall / 2, 4.2), color)
    b.panel(
        paint.lettering("BUS STATION", color, "white", (128, 16)),
        (depth * 0.08 + 0.256, -width / 2 + hall / 2, 4.65),
        hall * 0.8,
        0.8,
        "+x",
    )
    b.cylinder(1.0, 0.2, (depth * 0.09, -width / 2 + 1.6, 5.6), "white", (0, 90, 0), segments=20)
    b.box((0.3, 0.12, 0.75), (depth * 0.09 + 0.1, -width / 2 + 1.6, 5.6), "black")
    b.box((0.3, 0.5, 0.12), (depth * 0.09 + 0.1, -width / 2 + 1.8, 5.6), "black")
    span = width - hall - 2.0
    for k in range(bays):
        y = -width / 2 + hall + 1.5 + (k + 0.5) * span / bays
        b.box((depth * 0.8, 2.0, 0.18), (0, y, 0.15), "concrete")
        for s in (-1, 1):
            b.box((depth * 0.84, 2.7, 0.12), (0, y + s * 1.3, 4.55), color, (s * 10, 0, 0))
        for x in (-depth * 0.3, 0, depth * 0.3):
            b.cylinder(0.14, 4.3, (x, y, 0.3), "light grey", segments=8)
        b.box(
            (0.3, 1.2, 0.9),
            (depth * 0.38, y, 3.4),
            "black",
            skins={"+x": paint.lettering("ABCDEFG"[k], "signal yellow", "black", (32, 24))},
        )
        for x in (-2.0, 3.0):
            b.box((1.8, 0.45, 0.08), (x, y, 0.75), "wood")
            b.box((1.6, 0.08, 0.45), (x, y, 0.33), "charcoal")
        if k % 2 == 0:
            _bus_block(b, (0.5, y + 2.6 if k + 1 < bays else y - 2.6), ("signal red", "#3f7fae", "white")[k // 2 % 3])
    names = ("A bus station with four platforms", "A large bus station with six platforms")
    return fitted(b.build(names[variant], {"platforms": bays}), ((16.0, 42.0, 6.6), (20.0, 62.0, 7.0))[variant])


def _bus_block(b: MeshBuilder, at: tuple[float, float], color: Color) -> None:
    """A bus in few triangles, its windows painted on."""
    image, pen = paint.canvas((384, 96), color)
    for k in range(8):
        pen.rectangle((10 + 47 * k, 14, 50 + 47 * k, 52), fill=rgb("dark glass"))
    side = np.asarray(paint.shrunk(image, (128, 32)))
    front = np.asarray(paint.shrunk(image.crop((8, 0, 56, 96)), (24, 32)))
    b.box((10.0, 2.5, 2.6), (at[0], at[1], 0.45), color, skins={"+y": side, "-y": side, "+x": front, "-x": front})
    for x in (-3.0, 3.0):
        for s in (-1, 1):
            b.cylinder(0.45, 0.25, (at[0] + x, at[1] + s * 1.13 + 0.125, 0.6), "rubber", (90, 0, 0), segments=10)


@recipe("ferry terminal", 2, name="transit_places.ferry_terminal")
def ferry_terminal(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.6)
    color = ("signal blue", "teal")[variant]
    width = (36.0, 30.0)[variant]
    b.box((20.0, width, 1.2), (0, 0, 0), "concrete")
    b.box((9.0, width * 0.75, 5.0), (-4.5, 0, 1.2), "white")
    b.panel(glass_front(600, 150, 10, "charcoal"), (0.006, 0, 3.2), width * 0.7, 3.8, "+x")
    roof = [(-10.0, 6.0), (0.5, 6.4), (3.5, 7.9), (3.6, 8.1), (0.3, 6.9), (-10.0, 6.4)]
    b.profile(roof, width * 0.82, (0, 0, 0), color)
    b.panel(paint.lettering("FERRY TERMINAL", "white", color, (160, 16)), (0.03, 0, 5.75), width * 0.5, 0.9, "+x")
    for y in (-width * 0.3, 0, width * 0.3):
        b.cylinder(0.18, 6.2, (2.8, y, 1.2), "light grey", segments=8)
    # The gangway, a pontoon with its piles, mooring bollards, a mast with a light.
    b.box((5.0, width * 0.5, 0.9), (11.0, 0, 0.0), "dark grey")
    b.box((5.2, 2.4, 0.14), (9.2, 4.0, 1.25), "galvanised", (0, 7, 0))
    for side in (-1, 1):
        b.beam((6.8, 4.0 + side * 1.2, 2.2), (11.6, 4.0 + side * 1.2, 1.7), 0.08, 0.08, "white")
        for x in (8.8, 13.2):
            b.cylinder(0.35, 3.2, (x, side * width * 0.24, 0), "bark", segments=10)
    for k in range(6):
        b.lathe(
            [(0.22, 0), (0.16, 0.35), (0.3, 0.45), (0.25, 0.6)],
            (9.3, -width / 2 + 2 + k * (width - 4) / 5, 1.2),
            "black",
            segments=10,
        )
    b.box((2.2, 2.2, 7.5), (-6.5, width * 0.30, 1.2), "white")
    b.box((2.6, 2.6, 0.4), (-6.5, width * 0.30, 8.4), color)
    clock, pen = paint.canvas((96, 96), color)
    pen.ellipse((6, 6, 90, 90), fill=rgb("white"), outline=rgb("black"), width=4)
    pen.line((48, 48, 48, 18), fill=rgb("black"), width=6)
    pen.line((48, 48, 70, 58), fill=rgb("black"), width=6)
    b.panel(np.asarray(paint.shrunk(clock, (32, 32))), (-5.39, width * 0.30, 7.4), 1.6, 1.6, "+x")
    names = ("A white ferry terminal with a blue roof on a quay", "A ferry terminal with a teal roof and a pontoon")
    return fitted(b.build(names[variant], {"width": width}), ((20.5, 36.0, 9.0), (20.0, 30.0, 8.4))[variant])
