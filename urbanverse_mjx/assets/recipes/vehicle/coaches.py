"""Long vehicles with rows of windows: school bus, trolleybus, tram, heritage trolley, train."""

import dataclasses

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, ImageLike, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import recipe
from ..shared.sizes import fitted
from .trucks import box_shape
from .vehicle_body import Body, BodyShape
from .wheels import number_plate, road_wheels


@dataclasses.dataclass(frozen=True)
class Coach:
    """One carriage. spans: x of windows' rows; doors: x of the middles of doors, `door_sides` as in `Body.side`;
    line: words over the windscreen; cabs: (front, rear) whether there is a windscreen at that end."""

    length: float
    height: float
    color: Color
    band: Color
    line: str
    doors: tuple[float, ...]
    door_sides: str = "r"
    pitch: float = 1.5
    belt: float = 1.42
    axles: tuple[float, ...] = ()
    wheel_radius: float = 0.47
    nose: float = 0.22
    cabs: tuple[bool, bool] = (True, False)
    low: Color | None = None


def carriage(b: MeshBuilder, c: Coach) -> Body:
    """A carriage without its wheels, centred on x = 0."""
    shape = box_shape(c.length, c.height, c.nose, c.wheel_radius, c.axles, c.belt)
    if not c.axles:  # no arches: wheels hide behind skirts
        shape = dataclasses.replace(shape, axles=(0.0,), wheel_radius=0.02, arch=0.0, sill=0.30)
    body = Body(b, shape)
    body.shell(c.color)
    f, r = c.length / 2, -c.length / 2
    x0, x1, top = r + 0.35, f - c.nose - 0.35, c.height - 0.38
    body.side_image(x0, x1, c.belt, top, panes(c.color, round((x1 - x0) / c.pitch)), lift=0.010)
    body.side([(r + 0.08, 1.16), (f - 0.06, 1.16), (f - 0.06, 1.30), (r + 0.08, 1.30)], c.band, 0.006)
    if c.low is not None:
        body.side([(r + 0.08, 0.45), (f - 0.06, 0.45), (f - 0.06, 0.90), (r + 0.08, 0.90)], c.low, 0.005)
    high = c.height - 0.50
    for x in c.doors:
        frame = [(x - 0.64, 0.36), (x + 0.64, 0.36), (x + 0.64, high), (x - 0.64, high)]
        body.side(frame, "charcoal", 0.014, c.door_sides)
        for k in (-0.31, 0.31):
            pane = [(x + k - 0.25, 0.5), (x + k + 0.25, 0.5), (x + k + 0.25, high - 0.1), (x + k - 0.25, high - 0.1)]
            body.side(pane, "glass", 0.022, c.door_sides)
    if c.cabs[0]:
        body.across(9.95, 10.98, -0.95, 0.95, "dark glass", lift=0.01)
        if c.line:
            body.across(9.35, 9.95, -0.80, 0.80, image=paint.lettering(c.line, "black", "amber", (128, 16)), lift=0.02)
        body.across(14.0, 15.0, -0.98, 0.98, "charcoal", lift=0.006)
    body.across(3.1, 4.2, -0.85, 0.85, "dark glass", lift=0.01)
    for t0, t1 in ((-0.92, -0.62), (0.62, 0.92)):
        if c.cabs[0]:
            body.across(12.9, 13.5, t0, t1, "lamp", lift=0.014)
        body.across(1.35, 2.0, t0 + 0.05, t1 - 0.05, "red", lift=0.014)
    return body


def panes(color: Color, count: int) -> np.ndarray:
    """A row of windows with the pillars between them."""
    image, pen = paint.canvas((64 * count, 48), color)
    for k in range(count):
        pen.rounded_rectangle((64 * k + 3, 2, 64 * k + 61, 46), 6, fill=paint.rgb("dark glass"))
    return np.asarray(paint.shrunk(image, (min(16 * count, 320), 12)))


def plain_module(b: MeshBuilder, c: Coach) -> float:
    """The middle part of an articulated tram, its windows and doors painted on; returns m^3."""
    length, high = c.length, c.height - 0.3
    image, pen = paint.canvas((384, 192), c.color)
    y = {z: 192 * (1 - (z - 0.3) / high) for z in (0.45, 0.90, 1.16, 1.30, c.belt, c.height - 0.38)}
    pen.rectangle((0, y[1.30], 384, y[1.16]), fill=paint.rgb(c.band))
    if c.low is not None:
        pen.rectangle((0, y[0.90], 384, y[0.45]), fill=paint.rgb(c.low))
    for k in range(4):
        pen.rounded_rectangle((96 * k + 4, y[c.height - 0.38], 96 * k + 92, y[c.belt]), 8, fill=paint.rgb("dark glass"))
    for x in (146, 194):
        pen.rectangle((x - 2, y[c.height - 0.38] - 6, x + 46, 186), fill=paint.rgb("charcoal"))
        pen.rectangle((x + 4, y[c.height - 0.38], x + 40, 176), fill=paint.rgb("glass"))
    side = np.asarray(paint.shrunk(image, (128, 64)))
    b.box((length, 2.46, high), (0, 0, 0.3), c.color, skins={"+y": side, "-y": side})
    return length * 2.46 * high


def bellows(b: MeshBuilder, x: float, height: float, width: float = 2.2) -> None:
    for k in range(5):
        size = (0.10, width - 0.10 * (k % 2), height - 0.75 - 0.05 * (k % 2))
        b.box(size, (x - 0.24 + 0.12 * k, 0, 0.42), ("charcoal", "black")[k % 2])


def pantograph(b: MeshBuilder, x: float, low: float, high: float) -> None:
    for side in (-0.35, 0.35):
        b.rod((x - 0.1, side, low), (x - 0.75, side * 0.8, (low + high) / 2), 0.025, "dark grey", sides=5)
        b.rod((x - 0.75, side * 0.8, (low + high) / 2), (x + 0.15, side * 0.5, high - 0.04), 0.02, "dark grey", sides=5)
    b.box((0.25, 1.5, 0.04), (x + 0.15, 0, high - 0.04), "black")
    b.box((0.9, 0.9, 0.08), (x - 0.2, 0, low - 0.02), "dark grey")


@recipe("tram", 3, name="coaches.tram")
def tram(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.35)
    length, modules, color, band, low = (
        (27.0, 3, "white", "signal red", "signal red"),
        (32.0, 5, "signal yellow", "charcoal", "charcoal"),
        (14.2, 1, "#c8352c", "cream", None),
    )[variant]
    each, height, belt = length / modules, 3.15, 1.32
    words = ("4 CENTRE", "11 HARBOUR", "22 CASTLE")[variant]
    volume = 0.0
    for k in range(modules):
        x = length / 2 - each * (k + 0.5)
        first, last = k == 0, k == modules - 1
        facing = 180.0 if last and modules > 1 else 0.0
        spots = (0.0,) if modules > 1 else (-5.2, 0.3, 4.6)
        spec = Coach(
            each - (0.5 if modules > 1 else 0),
            height,
            color,
            band,
            words if first or last else "",
            spots,
            "lr" if modules > 1 else "r",
            1.6,
            belt,
            nose=1.0 if modules > 1 else 0.25,
            cabs=(first or last, False),
            low=low,
        )
        with b.frame((x, 0, 0), (0, 0, facing)):
            volume += carriage(b, spec).volume if first or last else plain_module(b, spec)
        if not last:
            bellows(b, x - each / 2, height)
        b.box((each * 0.5, 1.9, 0.40), (x, 0, 0.02), "charcoal")
    for side in (-1, 1):
        b.box((length * 0.9, 0.06, 0.3), (0, side * 0.72, 0.0), "dark grey")
    b.box((length * 0.55, 1.5, 0.22), (0, 0, height), shade("light grey", 0.9), bevel=0.05)
    pantograph(b, 0.5, height + 0.22, height + 0.42 if variant < 2 else height + 0.85)
    names = ("A white and red low-floor tram of three parts", "A long yellow tram of five parts", "An old red tramcar")
    built = dataclasses.replace(b.build(names[variant], {"modules": modules}), volume=volume)
    return fitted(built, ((27.0, 2.42, 3.50), (32.0, 2.62, 3.55), (14.2, 2.3, 3.65))[variant])


@recipe("trolleybus", 3, name="coaches.trolleybus")
def trolleybus(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.4)
    length, color, band = ((12.0, "#3b8f5a", "white"), (11.0, "signal blue", "white"), (17.9, "white", "signal red"))[
        variant
    ]
    parts = 2 if variant == 2 else 1
    each = length / parts
    volume = 0.0
    for k in range(parts):
        x = length / 2 - each * (k + 0.5)
        axles = (-each * 0.26, each * 0.30) if parts == 1 else ((-0.9, 2.6), (-1.2,))[k]
        spec = Coach(
            each - (0.4 if parts > 1 else 0.0),
            3.0,
            color,
            band,
            ("16 STATION", "3 MUSEUM", "62 RING")[variant],
            ((each / 2 - 1.1, -0.4, -each / 2 + 1.5), (1.4, -2.0))[k],
            axles=axles,
            cabs=(k == 0, False),
        )
        with b.frame((x, 0, 0)):
            volume += carriage(b, spec).volume
            road_wheels(b, axles, 0.47, 1.22)
        if k == 0 and parts > 1:
            bellows(b, x - each / 2, 3.0)
    # The two poles lie back over the roof from their base to behind the tail.
    foot, tip = 0.5, -length / 2 - 0.15
    b.box((1.6, 1.0, 0.16), (foot, 0, 3.0), "dark grey", bevel=0.04)
    b.box((2.4, 1.5, 0.20), (foot + 3.2, 0, 3.0), shade(color, 0.85), bevel=0.05)
    for side in (-1, 1):
        b.rod((foot, side * 0.30, 3.20), (tip, side * 0.42, 3.42), 0.035, "black", sides=6)
        b.box((0.25, 0.07, 0.10), (tip + 0.06, side * 0.42, 3.38), "brass")
        b.rod((tip + 0.6, side * 0.42, 3.40), (-length / 2 - 0.02, side * 0.55, 1.2), 0.012, "black", sides=4)
    names = ("A green trolleybus", "A blue trolleybus", "A white and red articulated trolleybus")
    built = dataclasses.replace(b.build(names[variant], {"parts": parts}), volume=volume)
    return fitted(built, ((12.2, 2.55, 3.5), (11.2, 2.5, 3.45), (18.2, 2.55, 3.55))[variant])


_SCHOOL_LINE = (
    "-4.55 .50,-4.66 .70,-4.66 1.2,-4.64 1.75,-4.60 2.70,-4.48 2.92,-4.0 3.02,0 3.04,2.2 3.02,2.85 2.95,3.10 2.72,"
    "3.45 1.80,3.55 1.66,4.3 1.60,4.85 1.50,5.02 1.32,5.08 1.0,5.08 .70,5.02 .50"
)


@recipe("school bus", 3, name="coaches.school_bus")
def school_bus(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.4)
    stretch = (1.10, 0.86, 1.22)[variant]
    yellow = ("#f2b01e", "#f5b62a", "#eda513")[variant]
    points = [tuple(float(v) for v in pair.split()) for pair in _SCHOOL_LINE.split(",")]
    shape = BodyShape(
        upper=tuple((x, z, 0.03) for x, z in points),
        width=2.38,
        section=((0.3, 0.97), (0.7, 1.0), (1.5, 1.0), (1.8, 0.985), (2.8, 0.93), (3.1, 0.88)),
        axles=(-2.4, 3.9),
        wheel_radius=0.47,
        sill=0.45,
        belt=1.66,
        taper=(0.01, 0.16),
        taper_length=1.6,
        arch=0.07,
        rounding=0.07,
    ).stretched(stretch)
    body = Body(b, shape)
    body.shell(yellow)
    r, f = -4.64 * stretch, 5.08 * stretch
    count = round(7.6 * stretch / 0.95)
    body.side_image(r + 0.35, 2.35 * stretch, 1.70, 2.62, panes(yellow, count), lift=0.012)
    body.side(
        [(2.45 * stretch, 1.72), (3.25 * stretch, 1.72), (2.85 * stretch, 2.6), (2.45 * stretch, 2.6)],
        "dark glass",
        0.01,
    )
    for z in (0.78, 1.10, 1.50):  # the black rub rails
        body.line([(r + 0.05, z), (2.9 * stretch, z)], "black", 0.05)
    body.side_image(r + 0.9, r + 5.4, 2.70, 2.93, paint.lettering("SCHOOL BUS", yellow, "black", (128, 8)))
    body.side_image(-1.0, 2.0, 1.16, 1.42, paint.lettering("DISTRICT 12", yellow, "black", (96, 10)))
    door = [(2.45, 0.5), (3.15, 0.5), (3.15, 2.5), (2.45, 2.5)]
    body.side([(x * stretch, z) for x, z in door], "charcoal", 0.014, "r")
    for k in (0.0, 0.35):
        pane = [(2.5 + k, 0.62), (2.78 + k, 0.62), (2.78 + k, 2.4), (2.5 + k, 2.4)]
        body.side([(x * stretch, z) for x, z in pane], "glass", 0.022, "r")
    body.across(10.1, 10.95, -0.9, 0.9, "dark glass", lift=0.01)
    body.across(9.15, 9.95, -0.6, 0.6, image=paint.lettering("SCHOOL BUS", yellow, "black", (96, 16)), lift=0.02)
    body.across(4.15, 4.8, -0.6, 0.6, image=paint.lettering("SCHOOL BUS", yellow, "black", (96, 16)), lift=0.02)
    body.across(2.6, 3.9, -0.45, 0.45, "dark glass", lift=0.01)
    body.across(14.9, 16.3, -0.5, 0.5, image=paint.lettering("= = =", "black", "light grey", (48, 16)), lift=0.014)
    body.across(16.8, 18.0, -0.98, 0.98, "black", lift=0.02)
    body.across(0.0, 1.0, -0.98, 0.98, "black", lift=0.02)
    for side in (-1, 1):
        t0, t1 = sorted((side * 0.62, side * 0.92))
        body.across(15.0, 15.9, t0, t1, "lamp", lift=0.016)
        body.across(1.3, 2.0, t0, t1, "red", lift=0.014)
        for s, color in ((9.3, "light red"), (4.3, "light red")):
            body.across(s, s + 0.5, t0, t1, color, lift=0.02)
        b.tube([(f - 0.9, side * 0.9, 1.45), (f - 0.4, side * 1.1, 1.75)], 0.02, "black", sides=5)
        b.box((0.06, 0.18, 0.26), (f - 0.4, side * 1.12, 1.66), "black", bevel=0.02)
    if variant != 1:  # the stop arm, folded out on the left
        outline = [(0.24 * np.cos(a), 0.24 * np.sin(a)) for a in np.radians(22.5 + 45 * np.arange(8))]
        sign = paint.lettering("STOP", "signal red", "white", (32, 32))
        b.plate(outline, 0.01, (1.9 * stretch, 1.40, 1.35), sign, "signal red", both_faces=True)
    road_wheels(b, shape.axles, 0.47, 1.16)
    names = ("A yellow school bus with its stop arm out", "A short yellow school bus", "A long yellow school bus")
    built = body.finish(names[variant], {"length": round(9.7 * stretch, 1)})
    return fitted(built, ((10.8, 2.5, 3.1), (8.4, 2.42, 3.05), (12.2, 2.55, 3.15))[variant])


@recipe("trolley", 2, name="coaches.trolley")
def trolley(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A heritage streetcar: wooden sides, open platforms, a raised lantern roof."""
    b = MeshBuilder(roughness=0.55)
    color, trim, length = (("dark red", "cream", 9.2), ("dark green", "#e2c27a", 11.5))[variant]
    half, cabin = length / 2, length - 2.6
    b.box((cabin, 2.2, 0.95), (0, 0, 0.55), color, skins={"+y": _boards(color, trim), "-y": _boards(color, trim)})
    b.box((cabin, 2.24, 0.10), (0, 0, 1.50), trim)
    count = round(cabin / 0.85)
    for side in (-1, 1):
        b.box((cabin - 0.1, 0.02, 0.85), (0, side * 1.0, 1.58), "dark glass")
        for k in range(count + 1):
            b.box((0.10, 0.08, 0.90), (-cabin / 2 + 0.05 + k * (cabin - 0.1) / count, side * 1.06, 1.58), trim)
        for x in (-half + 0.25, half - 0.25):
            b.rod((x, side * 0.95, 0.6), (x, side * 0.95, 2.5), 0.03, "brass", sides=6)
    for end in (-1, 1):
        b.box((0.04, 1.9, 0.9), (end * cabin / 2, 0, 1.56), "dark glass")
        b.box((1.3, 2.1, 0.12), (end * (half - 0.65), 0, 0.45), "wood")
        b.box((0.10, 1.9, 0.95), (end * (half - 0.06), 0, 0.55), color, bevel=0.03)
        b.cylinder(0.14, 0.12, (end * (half - 0.02), 0, 1.05), "lamp", (0, 90 * end, 0), segments=12)
        b.box((0.06, 1.2, 0.28), (end * (half - 0.12), 0, 2.52), "black")
        image = paint.lettering("CITY LOOP", "black", "amber", (64, 16))
        b.panel(image, (end * (half - 0.085), 0, 2.66), 1.15, 0.24, "+x" if end > 0 else "-x")
        b.box((0.5, 1.5, 0.08), (end * (half + 0.05), 0, 0.22), "black")  # the lifeguard at the front of the track
    b.box((length, 2.3, 0.14), (0, 0, 2.46), trim, bevel=0.05)
    b.box((length - 0.8, 1.35, 0.32), (0, 0, 2.60), color, bevel=0.03)
    b.box((length - 0.5, 1.5, 0.10), (0, 0, 2.90), trim, bevel=0.03)
    for x in (-1.3, 1.3):
        for side in (-1, 1):
            b.cylinder(0.36, 0.10, (x, side * 0.72 + 0.05, 0.36), "cast iron", (90, 0, 0), segments=14)
        b.box((1.2, 1.7, 0.25), (x, 0, 0.30), "charcoal")
    b.rod((0.3, 0, 3.0), (-half + 0.3, 0, 3.32), 0.03, "black", sides=6)
    names = ("A dark red heritage trolley", "A green vintage streetcar")
    return fitted(b.build(names[variant], {"length": length}), ((9.4, 2.4, 3.3), (11.8, 2.45, 3.4))[variant])


def _boards(color: Color, trim: Color) -> ImageLike:
    image, pen = paint.canvas((384, 48), color)
    for x in range(0, 384, 8):
        pen.line((x, 0, x, 48), fill=shade(color, 0.8))
    pen.rectangle((6, 6, 377, 41), outline=paint.rgb(trim), width=2)
    pen.rectangle((140, 12, 244, 36), fill=paint.rgb(color))
    paint.text(pen, "No. 28", (144, 12, 240, 36), trim, 0.03)
    return np.asarray(image)


@recipe("train", 3, name="coaches.train")
def train(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.4)
    if variant == 2:
        return fitted(_locomotive(b), (18.5, 2.98, 4.2))
    color, band, length = (("#d9dcde", "signal red", 22.0), ("#2f6fa8", "white", 25.0))[variant]
    spots = (-length / 2 + 3.2, length / 2 - 4.6)
    nose = (0.9, 2.6)[variant]
    spec = Coach(length, 3.35, color, band, "RE 5 CENTRAL", spots, "lr", 1.75, 1.45, nose=nose, low=shade(color, 0.7))
    with b.frame((0, 0, 0.62), scale=(1, 1.16, 1)):
        volume = carriage(b, spec).volume * 1.16
    for x in (-length / 2 + 3.4, length / 2 - 3.6):
        b.box((2.9, 2.2, 0.32), (x, 0, 0.42), "charcoal", bevel=0.05)
        for dx in (-1.1, 1.1):
            for side in (-1, 1):
                b.cylinder(0.44, 0.13, (x + dx, side * 0.80 + 0.065, 0.44), "cast iron", (90, 0, 0), segments=14)
    b.box((length * 0.4, 2.3, 0.4), (0, 0, 0.2), "charcoal")
    for side in (-1, 1):
        b.cylinder(0.2, 0.3, (length / 2 - 0.15, side * 0.85, 0.95), "black", (0, 90, 0), segments=12)
    b.box((length * 0.3, 1.6, 0.14), (-2, 0, 3.9), "grey", bevel=0.04)
    names = ("A silver and red regional train", "A blue express railcar with a long nose")
    built = dataclasses.replace(b.build(names[variant], {"length": length}), volume=volume)
    return fitted(built, ((22.0, 2.9, 4.0), (25.0, 2.95, 4.1))[variant])


def _locomotive(b: MeshBuilder) -> BuiltAsset:
    """A steam engine with its tender."""
    green = "#1f4a34"
    b.box((11.0, 2.5, 0.30), (2.6, 0, 1.15), "black")
    for dx in (-1.7, 0.0, 1.7):
        for side in (-1, 1):
            at = (1.6 + dx, side * 0.80 + 0.08, 0.85)
            b.ring(0.78, 0.09, (at[0], side * 0.80, 0.87), "signal red", (90, 0, 0), segments=18, sides=5)
            b.cylinder(0.16, 0.2, at, "dark red", (90, 0, 0), segments=8)
            for k in range(4):
                a = k * np.pi / 4
                d = np.array([np.cos(a), 0, np.sin(a)]) * 0.76
                centre = np.array([1.6 + dx, side * 0.8, 0.87])
                b.rod(tuple(centre - d), tuple(centre + d), 0.03, "signal red", sides=4)
    for side in (-1, 1):
        b.box((3.8, 0.08, 0.14), (1.6, side * 1.0, 0.62), "aluminium")
        b.cylinder(0.34, 1.2, (5.3, side * 1.0, 0.92), green, (0, 90, 0), segments=12)
        for x in (5.4, 7.2):
            b.cylinder(0.42, 0.12, (x, side * 0.75 + 0.06, 0.42), "signal red", (90, 0, 0), segments=12)
    with b.frame((0.2, 0, 2.35), (0, 90, 0)):
        b.cylinder(0.92, 7.3, color=green, segments=18)
        b.cylinder(0.95, 0.9, (0, 0, 7.3), "black", segments=18)
        for z in (1.5, 3.2, 5.0, 6.6):
            b.cylinder(0.94, 0.08, (0, 0, z), "brass", segments=18)
    b.lathe([(0.30, 0), (0.27, 0.5), (0.42, 0.9), (0.38, 0.98)], (7.6, 0, 3.15), "black", segments=12)
    for x in (3.0, 5.2):
        b.lathe([(0.42, 0), (0.40, 0.3), (0.2, 0.55), (0.02, 0.6)], (x, 0, 3.2), "brass", segments=12)
    b.box((2.2, 2.7, 2.4), (-1.0, 0, 1.45), green)
    b.box((2.7, 2.95, 0.12), (-1.1, 0, 3.85), "black", bevel=0.05)
    for side in (-1, 1):
        b.box((1.0, 0.04, 0.75), (-0.9, side * 1.36, 2.75), "dark glass")
        b.cylinder(0.18, 0.4, (8.45, side * 0.85, 1.25), "black", (0, 90, 0), segments=10)
    b.cylinder(0.2, 0.2, (8.4, 0, 2.9), "lamp", (0, 90, 0), segments=12)
    b.box((0.2, 2.5, 0.5), (8.2, 0, 1.0), "signal red")
    b.box((5.6, 2.6, 1.5), (-5.6, 0, 1.2), green, bevel=0.05)
    heap = [(x, y, 2.7 + h) for x in (-7.6, -4.0) for y in (-0.9, 0.9) for h in (0.0,)]
    b.convex([*heap, (-6.2, 0, 3.4), (-5.0, 0.2, 3.35), (-7.0, -0.1, 3.1)], "black")
    for x in (-7.4, -5.7, -4.0):
        for side in (-1, 1):
            b.cylinder(0.5, 0.12, (x, side * 0.8 + 0.06, 0.5), "signal red", (90, 0, 0), segments=12)
    b.box((5.6, 2.0, 0.4), (-5.6, 0, 0.7), "black")
    b.panel(number_plate("1916", "black", "gold"), (-1.0, 1.375, 2.2), 0.9, 0.3, "+y")
    return b.build("A green steam locomotive with its tender", {"kind": "steam"})
