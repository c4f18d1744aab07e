"""Pieces of roads: carriageway, pavement, cycleway, crossing, roundabout, railway track; their length lies along x."""

import numpy as np
from PIL import Image, ImageDraw

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, rgb, shade
from ...meshes.recipe import recipe
from ..shared.sizes import fitted_as, size_of

Pen = ImageDraw.ImageDraw


class Surface:
    """A painted ground seen from above; metres with the origin in the middle, x along the image's height."""

    def __init__(self, length: float, width: float, color: Color, rng: np.random.Generator, pixels: int = 250) -> None:
        self.length, self.width = length, width
        self.scale = pixels / max(length, width)
        size = (max(8, round(width * self.scale)), max(8, round(length * self.scale)))
        self.image: Image.Image = paint.speckled(size, color, rng, 7.0, 1)
        self.pen = ImageDraw.Draw(self.image)

    def at(self, x: float, y: float) -> tuple[float, float]:
        return (self.width / 2 - y) * self.scale, (self.length / 2 - x) * self.scale

    def bar(self, x: float, y: float, along: float, across: float, color: Color = "white") -> None:
        """A filled rectangle centred on (x, y)."""
        left, top = self.at(x + along / 2, y + across / 2)
        right, bottom = self.at(x - along / 2, y - across / 2)
        self.pen.rectangle((left, top, max(right - 1, left), max(bottom - 1, top)), fill=rgb(color))

    def dashes(self, y: float, dash: float, gap: float, across: float, color: Color = "white") -> None:
        for x in np.arange(-self.length / 2 + dash / 2, self.length / 2, dash + gap):
            self.bar(float(x), y, dash, across, color)

    def shape(self, points: list[tuple[float, float]], color: Color = "white") -> None:
        self.pen.polygon([self.at(x, y) for x, y in points], fill=rgb(color))

    def ring(self, x: float, y: float, radius: float, width: float, color: Color = "white") -> None:
        (a, b), (c, d) = self.at(x + radius, y + radius), self.at(x - radius, y - radius)
        self.pen.ellipse((a, b, c, d), outline=rgb(color), width=max(1, round(width * self.scale)))

    def disc(self, x: float, y: float, radius: float, color: Color) -> None:
        (a, b), (c, d) = self.at(x + radius, y + radius), self.at(x - radius, y - radius)
        self.pen.ellipse((a, b, c, d), fill=rgb(color))

    def lay(self, b: MeshBuilder, z: float) -> None:
        """The image as the ground at height z."""
        half, w = self.length / 2, self.width / 2
        corners = [(-half, w, z), (-half, -w, z), (half, -w, z), (half, w, z)]
        b.quad(corners, image=self.image)


def _arrow(s: Surface, x: float, y: float, sense: float) -> None:
    s.bar(x - sense * 0.4, y, 1.8, 0.16)
    s.shape([(x + sense * 1.5, y), (x + sense * 0.4, y + 0.38), (x + sense * 0.4, y - 0.38)])


def _bicycle_sign(s: Surface, x: float, y: float) -> None:
    for dx in (-0.42, 0.42):
        s.ring(x, y + dx, 0.34, 0.07)
    tubes = (((0.0, -0.42), (0.5, -0.2)), ((0.5, -0.2), (0.5, 0.25)), ((0.5, 0.25), (0.0, 0.42)))
    more = (((0.0, -0.42), (0.0, 0.05)), ((0.0, 0.05), (0.5, 0.25)), ((0.0, 0.05), (0.62, -0.24)))
    for (xa, ya), (xb, yb) in tubes + more:
        ends = (*s.at(x + xa, y + ya), *s.at(x + xb, y + yb))
        s.pen.line(ends, fill=rgb("white"), width=max(1, round(0.08 * s.scale)))


def kerb(b: MeshBuilder, length: float, y: float, width: float, height: float, color: Color = "granite") -> None:
    """Kerb stones about a metre long end to end along x."""
    count = max(2, round(length / 1.0))
    step = length / count
    for k in range(count):
        tone = shade(color, (1.0, 1.06, 0.95)[k % 3])
        b.box((step - 0.012, width, height), ((k + 0.5) * step - length / 2, y, 0), tone)


@recipe("road", 3, name="ways.road")
def road(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Two lanes with a dashed middle line; a one-way street between kerbs; a dual carriageway with a planted strip."""
    size, b = size_of("road", variant), MeshBuilder(roughness=0.9)
    x, y, z = size
    deep = 0.72 * z
    s = Surface(x, y * (0.96 if variant != 1 else 0.9), ("asphalt", "#55565a", "#4c4d50")[variant], rng)
    b.box((x, y * (1.0 if variant == 0 else 0.99), 0.5 * deep), (0, 0, 0), "#8c8478")  # gravel base
    b.box((x, s.width, 0.5 * deep), (0, 0, 0.5 * deep), "asphalt")
    if variant == 0:
        s.dashes(0.0, 1.5, 1.5, 0.14)
        for side in (-1, 1):
            s.bar(0, side * (s.width / 2 - 0.3), x, 0.12)
            for k in range(8):  # reflecting studs stand a little out of the asphalt
                b.box(
                    (0.12, 0.1, z - deep),
                    ((k + 0.5) * x / 8 - x / 2, side * (s.width / 2 - 0.12), deep),
                    "signal yellow",
                )
    elif variant == 1:
        for k in (-0.28, 0.22):
            _arrow(s, k * x, 0.0, 1.0)
        s.bar(0, -s.width / 2 + 0.25, x, 0.12, "signal yellow")
        s.bar(0, -s.width / 2 + 0.5, x, 0.12, "signal yellow")
        for side in (-1, 1):
            kerb(b, x, side * (y / 2 - 0.025 * y), 0.05 * y, z)
        b.box((0.5, 0.35, 0.01), (0.1 * x, -s.width / 2 + 0.25, deep), "cast iron")
    else:
        strip = 0.14 * y
        kerb(b, x, 0.42 * strip, 0.16 * strip, z)
        kerb(b, x, -0.42 * strip, 0.16 * strip, z)
        b.box((x, 0.7 * strip, 0.94 * z), (0, 0, 0), "grass")
        for side in (-1, 1):
            s.dashes(side * 0.27 * y, 2.0, 2.0, 0.16)
            s.bar(0, side * (s.width / 2 - 0.3), x, 0.15)
            for k in (-0.3, 0.3):
                _arrow(s, k * x, side * 0.16 * y, side)
    s.lay(b, deep + 0.003)
    names = (
        "two-lane road with a dashed middle line",
        "one-way street between kerbs",
        "dual carriageway with a green strip",
    )
    return fitted_as(b.build(names[variant]), "road", size)


@recipe("cycleway", 3, name="ways.cycleway")
def cycleway(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Red or green asphalt with bicycles painted on it, or a two-way path with a dashed line between edgings."""
    size, b = size_of("cycleway", variant), MeshBuilder(roughness=0.9)
    x, y, z = size
    color: Color = ("#a2483a", "asphalt", "#3f7a52")[variant]
    s = Surface(x, 0.92 * y, color, rng)
    b.box((x, 0.93 * y, 0.85 * z), (0, 0, 0), shade(color, 0.8))
    kerb(b, x, 0.48 * y, 0.04 * y, z, "concrete")
    kerb(b, x, -0.48 * y, 0.04 * y, z, "concrete")
    if variant != 2:
        s.dashes(0.0, 0.9, 0.9, 0.09)
    for side in (-1, 1):
        s.bar(0, side * (s.width / 2 - 0.12), x, 0.08)
    spots = ((0.22, -0.25), (-0.22, 0.25)) if variant != 2 else ((0.3, 0.0), (-0.2, 0.0))
    for k, across in spots:
        _bicycle_sign(s, k * x, across * y)
        _arrow(s, k * x + 2.3 * (1 if across <= 0 else -1), across * y, 1.0 if across <= 0 else -1.0)
    s.lay(b, 0.85 * z + 0.003)
    names = ("red two-way cycleway", "asphalt cycleway with a dashed line", "green cycle lane")
    return fitted_as(b.build(names[variant]), "cycleway", size)


@recipe("sidewalk", 3, name="ways.sidewalk")
def sidewalk(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Square slabs, herringbone bricks or large granite flags along a kerb."""
    size, b = size_of("sidewalk", variant), MeshBuilder(roughness=0.9)
    x, y, z = size
    color: Color = ("#b3b0a8", "#a8604a", "#a5a39c")[variant]
    s = Surface(x, 0.91 * y, color, rng, 240)
    joint = shade(color, 0.62)
    if variant == 1:
        w, long = 0.2, 0.4
        for row in range(int(s.length / w) + 2):
            for col in range(int(s.width / long) + 2):
                tone = shade(color, float(rng.uniform(0.85, 1.12)))
                at = (-s.length / 2 + row * w, -s.width / 2 + (col + 0.5 * (row % 2)) * long)
                s.bar(*at, w - 0.03, long - 0.03, tone)
    else:
        step = (0.5, 1.0)[variant // 2]
        for row in range(int(s.length / step) + 2):
            for col in range(int(s.width / step) + 2):
                tone = shade(color, float(rng.uniform(0.9, 1.08)))
                at = (-s.length / 2 + (row + 0.5) * step, -s.width / 2 + (col + 0.5) * step)
                s.bar(*at, step, step, joint)
                s.bar(*at, step - 0.04, step - 0.04, tone)
        if variant == 0:  # guiding strip for the blind
            s.bar(0, 0.18 * y, x, 0.3, "white")
            s.dashes(0.18 * y + 0.07, 0.2, 0.06, 0.05, "grey")
            s.dashes(0.18 * y - 0.07, 0.2, 0.06, 0.05, "grey")
    b.box((x, 0.92 * y, 0.96 * z), (0, 0.04 * y, 0), shade(color, 0.75))
    kerb(b, x, -0.46 * y, 0.08 * y, z)
    with b.frame((0, 0.04 * y, 0)):
        s.lay(b, 0.965 * z)
    names = ("pavement of square slabs with a guiding strip", "brick pavement", "pavement of granite flags")
    return fitted_as(b.build(names[variant]), "sidewalk", size)


@recipe("pedestrian crosswalk", 3, name="ways.pedestrian_crosswalk")
def pedestrian_crosswalk(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Zebra bars, plain, between stop lines, or on a raised red table; one walks along y."""
    size, b = size_of("pedestrian crosswalk", variant), MeshBuilder(roughness=0.85)
    x, y, z = size
    ground: Color = ("asphalt", "#595a5e", "#9c4a3c")[variant]
    b.box((x, y, 0.5 * z), (0, 0, 0), ground)
    deep = (0.86, 0.6, 0.8)[variant] * x
    count = max(5, round(y / 1.0))
    for k in range(count):
        at = (0, (k + 0.5) * y / count - y / 2, 0.5 * z)
        b.box((deep, 0.5 * y / count, 0.5 * z), at, "white", bevel=0.2 * z)
    if variant == 1:
        for side in (-1, 1):
            b.box((0.09 * x, 0.47 * y, 0.5 * z), (side * 0.45 * x, -side * 0.245 * y, 0.5 * z), "white")
    if variant == 2:
        for side in (-1, 1):  # sharks' teeth up the ramps
            for k in range(8):
                y0 = (k + 0.5) * y / 8 - y / 2
                tooth = [(side * 0.5 * x, y0 - 0.04 * y), (side * 0.5 * x, y0 + 0.04 * y), (side * 0.42 * x, y0)]
                b.extrude(tooth, 0.4 * z, (0, 0, 0.5 * z), "white")
    names = ("zebra crossing", "zebra crossing between stop lines", "raised red zebra crossing")
    return fitted_as(b.build(names[variant]), "pedestrian crosswalk", size)


@recipe("roundabout", 3, hulls=6, name="ways.roundabout")
def roundabout(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A ring road about a planted island with the stubs of three or four arms."""
    size, b = size_of("roundabout", variant), MeshBuilder(roughness=0.9)
    d, z = size[0], size[2]
    low, r = 0.16 * z, 0.43 * d
    s = Surface(d, d, "grass", rng, 300)
    arms = (4, 4, 3)[variant]
    lane = 0.11 * d
    for k in range(arms):
        a = 2 * np.pi * k / arms
        out, across = np.array([np.cos(a), np.sin(a)]), np.array([-np.sin(a), np.cos(a)])
        points = [out * 0.2 * d + across * lane, out * 0.75 * d + across * lane, out * 0.75 * d - across * lane,
                  out * 0.2 * d - across * lane]  # fmt: skip
        s.shape([(float(p[0]), float(p[1])) for p in points], "asphalt")
    s.disc(0, 0, r, "asphalt")
    for k in range(arms):
        a = 2 * np.pi * k / arms
        out, across = np.array([np.cos(a), np.sin(a)]), np.array([-np.sin(a), np.cos(a)])
        for j in range(5):  # give-way dashes on the approach, a splitter island
            p = out * 0.435 * d + across * lane * (0.15 + 0.19 * j)
            s.disc(float(p[0]), float(p[1]), 0.006 * d, "white")
        tip = [out * 0.4 * d, out * 0.5 * d + across * 0.014 * d, out * 0.5 * d - across * 0.014 * d]
        s.shape([(float(p[0]), float(p[1])) for p in tip], "white")
    s.ring(0, 0, r, 0.006 * d)
    for k in range(24):
        a = 2 * np.pi * k / 24
        s.disc(0.31 * d * np.cos(a), 0.31 * d * np.sin(a), 0.007 * d, "white")
    b.box((d, d, low), (0, 0, 0), "dark concrete")
    s.lay(b, low + 0.004)
    isle = 0.19 * d
    b.lathe([(isle * 1.2, 0), (isle * 1.2, 0.1 * z), (isle, 0.12 * z)], (0, 0, low), "#b08a78", segments=28)
    b.lathe([(isle, 0), (isle, 0.3 * z), (0.93 * isle, 0.34 * z), (0.0, 0.46 * z)], (0, 0, low), "grass", segments=28)
    top = low + 0.4 * z
    if variant == 0:
        for k in range(9):
            a = 2.4 * k
            at = (0.5 * isle * np.cos(a), 0.5 * isle * np.sin(a), top)
            b.ball((0.13 * isle, 0.13 * isle, 0.4 * z), at, ("dark leaf", "red", "yellow")[k % 3], segments=8, rings=5)
    elif variant == 1:
        b.lathe([(0.3 * isle, 0), (0.3 * isle, 0.2 * z), (0.1 * isle, 0.25 * z), (0.05 * isle, 0.55 * z)], (0, 0, top),
                "granite", segments=14)  # fmt: skip
    else:
        for k in range(5):
            a = 1.26 * k
            b.ball((0.2 * isle, 0.16 * isle, 0.4 * z), (0.5 * isle * np.cos(a), 0.5 * isle * np.sin(a), top), "granite",
                   segments=7, rings=4)  # fmt: skip
    chevrons = paint.stripes((48, 12), ["signal blue", "white"], 8, 0.12)
    for k in range(arms):
        with b.frame((0, 0, 0), (0, 0, 360 / arms * k)):
            b.box((0.05, 0.16 * d, 0.3 * z), (0.95 * isle, 0, low + 0.3 * z), "white", skins={"+x": chevrons})
    names = ("roundabout with a flower bed", "roundabout with a monument", "three-armed roundabout with boulders")
    return fitted_as(b.build(names[variant]), "roundabout", size)


@recipe("railway track", 3, name="ways.railway_track")
def railway_track(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Two rails on sleepers in ballast: wood, concrete, or tram rails sunk in paving."""
    size, b = size_of("railway track", variant), MeshBuilder(roughness=0.8)
    x, y, z = size
    half = 0.7175 * (y / 2.6)  # half the gauge of 1.435 m, with the sleepers' scale
    if variant == 2:
        b.box((x, y, 0.88 * z), (0, 0, 0), "#8c8880")
        s = Surface(x, y, "#9a958b", rng, 240)
        for row in range(int(x / 0.35)):
            s.bar(-x / 2 + row * 0.35, 0, 0.03, y, "#6c6860")
        for col in range(int(y / 0.45) + 1):
            s.bar(0, -y / 2 + col * 0.45, x, 0.03, "#6c6860")
        for side in (-1, 1):
            s.bar(0, side * (half - 0.09), x, 0.09, "black")
        s.lay(b, 0.885 * z)
        low = 0.8 * z
    else:
        with b.frame((0, 0, 0), (0, 0, 90)):
            b.profile([(-y / 2, 0), (y / 2, 0), (0.42 * y, 0.46 * z), (-0.42 * y, 0.46 * z)], x, color="#77706a")
        for _ in range(60):
            at = ((rng.random() - 0.5) * x * 0.97, (rng.random() - 0.5) * y * 0.8, 0.46 * z)
            b.box(
                (0.16, 0.13, 0.1 * z),
                at,
                shade("#77706a", float(rng.uniform(0.7, 1.25))),
                (0, 0, float(rng.random() * 90)),
            )
        count = max(4, round(x / 0.62))
        for k in range(count):
            at = ((k + 0.5) * x / count - x / 2, 0, 0.42 * z)
            b.box((0.25, 0.96 * y, 0.24 * z), at, ("dark wood", "concrete")[variant])
        low = 0.66 * z
    for side in (-1, 1):
        section = [
            (-0.07, 0),
            (0.07, 0),
            (0.015, 0.15),
            (0.035, 0.6),
            (0.035, 1),
            (-0.035, 1),
            (-0.035, 0.6),
            (-0.015, 0.15),
        ]
        with b.frame((0, side * half, low), (0, 0, 90)):
            b.profile([(u, v * (z - low)) for u, v in section], x, color="rust" if variant == 0 else "dark grey")
        b.box((x, 0.05, 0.01 * z), (0, side * half, z - 0.01 * z), "galvanised")
    names = ("railway track on wooden sleepers", "railway track on concrete sleepers", "tram track in paving")
    return fitted_as(b.build(names[variant]), "railway track", size)
