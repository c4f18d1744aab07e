"""Traffic and direction signs: a painted plate on a post, face towards +x."""

import numpy as np
from PIL import Image, ImageDraw

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, rgb
from ...meshes.recipe import Physics, recipe

SIGN = Physics(
    ("aluminium", "steel"),
    1500.0,
    (8.0, 40.0),
    0.5,
    False,
    "2-3 mm aluminium plate on a 60 mm steel tube of 2-4 kg/m, footed in the pavement",
)
PORTABLE = Physics(
    ("steel", "plastic"),
    900.0,
    (8.0, 25.0),
    0.6,
    True,
    "portable roadworks sign: folding steel frame, weighed with a sandbag",
)
PX = 96  # pixels across a sign face
SCALE = 4  # drawn larger, then shrunk, for clean edges
RED, BLUE = "signal red", "signal blue"


def ngon(sides: int, radius: float, phase_deg: float = 0.0) -> list[tuple[float, float]]:
    """Corners (right, up) of a regular polygon, counter-clockwise."""
    angles = np.radians(phase_deg) + np.arange(sides) * 2 * np.pi / sides
    return [(float(radius * np.cos(a)), float(radius * np.sin(a))) for a in angles]


def rectangle(width: float, height: float) -> list[tuple[float, float]]:
    w, h = width / 2, height / 2
    return [(-w, -h), (w, -h), (w, h), (-w, h)]


def face(color: Color, width: int = PX, height: int = PX) -> tuple[Image.Image, ImageDraw.ImageDraw]:
    return paint.canvas(paint.smooth((width, height), SCALE), color)


def done(image: Image.Image) -> Image.Image:
    return paint.shrunk(image, (image.width // SCALE, image.height // SCALE))


def disc(draw: ImageDraw.ImageDraw, size: int, share: float, color: Color) -> None:
    """A filled circle in the middle of a square image; `share` of its width."""
    edge = size * (1 - share) / 2
    draw.ellipse((edge, edge, size - edge, size - edge), fill=rgb(color))


def post(b: MeshBuilder, height: float, kind: str) -> None:
    """A round steel tube, a square one with holes, or a wooden post; its front touches the plane x = 0."""
    if kind == "round":
        b.cylinder(0.03, height, (-0.03, 0, 0), "galvanised", segments=12)
        b.cylinder(0.075, 0.015, (-0.03, 0, 0), "dark grey", segments=12)
        b.cylinder(0.031, 0.02, (-0.03, 0, height), "black", segments=12)
    elif kind == "square":
        b.box((0.05, 0.05, height), (-0.026, 0, 0), "galvanised")
        for k in range(int(height / 0.22)):
            b.box((0.002, 0.016, 0.016), (0.0, 0, 0.15 + 0.22 * k), "charcoal")
    else:
        b.box((0.09, 0.09, height), (-0.046, 0, 0), "grey wood", bevel=0.008)


def stop_face() -> Image.Image:
    image, draw = face(RED)
    n = PX * SCALE
    draw.polygon([(n * (0.5 + 0.5 * x), n * (0.5 + 0.5 * y)) for x, y in ngon(8, 1.08, 22.5)], fill=rgb("white"))
    draw.polygon([(n * (0.5 + 0.5 * x), n * (0.5 + 0.5 * y)) for x, y in ngon(8, 1.0, 22.5)], fill=rgb(RED))
    paint.text(draw, "STOP", (n * 0.1, n * 0.3, n * 0.9, n * 0.7), "white", bold=0.045)
    return done(image)


@recipe("stop sign", 3, SIGN, hulls=3, name="signs.stop_sign")
def stop_sign(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Red octagon with white rim; round, square and wooden posts; the third with an all-way plate."""
    b = MeshBuilder(roughness=0.45)
    kind = ("round", "square", "wooden")[variant % 3]
    side = float(rng.uniform(0.6, 0.75))
    low = float(rng.uniform(1.9, 2.15))
    post(b, low + side * 0.9, kind)
    # An octagon of width `side` across flats: its corners lie at side / 2 / cos(22.5 deg).
    b.plate(ngon(8, side / 2 / np.cos(np.pi / 8), 22.5), 0.006, (0.006, 0, low + side / 2), stop_face())
    if kind == "wooden":
        image, draw = face(RED, 96, 32)
        paint.text(draw, "ALL WAY", (20, 24, 364, 104), "white", bold=0.04)
        b.plate(rectangle(0.45, 0.15), 0.005, (0.006, 0, low - 0.1), done(image))
    return b.build(f"a stop sign on a {kind} post", {"post": kind, "side": round(side, 3)})


def round_sign(
    variant: int, rng: np.random.Generator, image: Image.Image, name: str, side: float | None = None
) -> BuiltAsset:
    b = MeshBuilder(roughness=0.45)
    kind = ("round", "square", "round", "wooden")[variant % 4]
    side = side or float(rng.uniform(0.5, 0.65))
    low = float(rng.uniform(2.0, 2.25))
    post(b, low + side * 0.95, kind)
    b.plate(ngon(28, side / 2), 0.006, (0.006, 0, low + side / 2), image)
    return b.build(f"{name} on a {kind} post", {"post": kind, "side": round(side, 3)})


@recipe("no parking sign", 3, SIGN, hulls=3, name="signs.no_parking_sign")
def no_parking_sign(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Blue disc, red rim and bar (Vienna convention), or the North American white plate."""
    n = PX * SCALE
    if variant % 3 != 1:
        image, draw = face(RED)
        disc(draw, n, 1.02, RED)
        disc(draw, n, 0.8, BLUE)
        bars = (45,) if variant % 3 == 0 else (45, 135)
        for angle in bars:
            dx, dy = 0.41 * n * np.cos(np.radians(angle)), 0.41 * n * np.sin(np.radians(angle))
            draw.line((n / 2 - dx, n / 2 - dy, n / 2 + dx, n / 2 + dy), fill=rgb(RED), width=n // 10)
        return round_sign(variant, rng, done(image), "a no parking sign")
    image, draw = face("white", 64, 96)
    draw.rectangle((8, 8, 248, 376), outline=rgb(RED), width=10)
    paint.text(draw, "P", (70, 40, 186, 190), "black", bold=0.05)
    draw.ellipse((48, 24, 208, 184 + 20), outline=rgb(RED), width=18)
    draw.line((76, 50, 182, 178), fill=rgb(RED), width=18)
    paint.text(draw, "NO\nPARKING\nANY TIME", (24, 216, 232, 364), RED, bold=0.03)
    b = MeshBuilder(roughness=0.45)
    post(b, 2.45, "square")
    b.plate(rectangle(0.32, 0.48), 0.004, (0.006, 0, 2.18), done(image))
    return b.build("a no parking plate on a square post", {"post": "square", "side": 0.32})


@recipe("do not enter sign", 3, SIGN, hulls=3, name="signs.do_not_enter_sign")
def do_not_enter_sign(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Red disc with a white bar; the second on a white square with its words."""
    n = PX * SCALE
    image, draw = face("white" if variant % 3 == 1 else RED)
    disc(draw, n, 1.0 if variant % 3 != 1 else 0.94, RED)
    draw.rectangle((n * 0.15, n * 0.42, n * 0.85, n * 0.58), fill=rgb("white"))
    if variant % 3 != 1:
        return round_sign(variant, rng, done(image), "a do not enter sign")
    paint.text(draw, "DO NOT", (n * 0.25, n * 0.2, n * 0.75, n * 0.36), "white", bold=0.03)
    paint.text(draw, "ENTER", (n * 0.25, n * 0.64, n * 0.75, n * 0.8), "white", bold=0.03)
    b = MeshBuilder(roughness=0.45)
    post(b, 2.75, "square")
    b.plate(rectangle(0.7, 0.7), 0.004, (0.006, 0, 2.38), done(image))
    return b.build("a do not enter sign on a square post", {"post": "square", "side": 0.7})


@recipe("speed limit sign 30 km", 3, SIGN, hulls=3, name="signs.speed_limit_30")
def speed_limit_30(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """White disc with red rim and 30; the second one is a zone plate."""
    n = PX * SCALE
    zone = variant % 3 == 1
    image, draw = face("white" if zone else RED)
    top = 0.04 * n if zone else 0.0
    size = 0.7 * n if zone else n
    left = (n - size) / 2
    draw.ellipse((left, top, left + size, top + size), fill=rgb(RED))
    rim = 0.11 * size
    draw.ellipse((left + rim, top + rim, left + size - rim, top + size - rim), fill=rgb("white"))
    box = (left + 0.2 * size, top + 0.27 * size, left + 0.8 * size, top + 0.73 * size)
    paint.text(draw, "30", box, "black", bold=0.04)
    if not zone:
        return round_sign(variant, rng, done(image), "a 30 km/h speed limit sign")
    paint.text(draw, "ZONE", (0.15 * n, 0.78 * n, 0.85 * n, 0.94 * n), "black", bold=0.04)
    b = MeshBuilder(roughness=0.45)
    post(b, 2.7, "round")
    b.plate(rectangle(0.6, 0.6), 0.004, (0.006, 0, 2.38), done(image))
    return b.build("a 30 km/h zone sign on a round post", {"post": "round", "side": 0.6})


STREETS = ("ELM ST", "RUE DU PONT", "PARKWEG", "MARKT PL")
PLACES = ("CENTRE", "STATION", "MUSEUM", "HARBOUR", "CASTLE", "PARK", "ZOO", "LIBRARY")


def arrow_plate(words: str, color: Color, ink: Color) -> Image.Image:
    image, draw = face(color, 112, 28)
    w, h = image.size
    draw.rectangle((8, 8, w - 8, h - 8), outline=rgb(ink), width=5)
    paint.text(draw, words, (24, 26, w - 110, h - 26), ink, bold=0.02)
    y = h / 2
    draw.line((w - 96, y, w - 40, y), fill=rgb(ink), width=12)
    draw.polygon([(w - 24, y), (w - 60, y - 30), (w - 60, y + 30)], fill=rgb(ink))
    return done(image)


@recipe("directional sign", 4, SIGN, hulls=6, name="signs.directional_sign")
def directional_sign(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Fingerpost, street names at a corner, a large lane guide, a heritage fingerpost."""
    b = MeshBuilder(roughness=0.5)
    style = ("fingerpost", "street names", "guide", "heritage")[variant % 4]
    if style in ("fingerpost", "heritage"):
        color, ink = (("signal blue", "white"), ("brown", "cream"))[style == "heritage"]
        b.cylinder(0.04, 2.9, color="charcoal" if style == "heritage" else "galvanised", segments=14)
        b.ball(0.06, (0, 0, 2.92), "gold" if style == "heritage" else "galvanised")
        for k, yaw in enumerate((90.0, 90.0, -60.0) if style == "fingerpost" else (70.0, -90.0, -80.0)):
            words = PLACES[int(rng.integers(len(PLACES)))]
            with b.frame((0, 0, 2.7 - 0.24 * k), (0, 0, yaw)):
                # The arm points along its own +x; both of its faces carry the words.
                b.box((0.85, 0.025, 0.2), (0.48, 0, -0.1), color)
                drawn = arrow_plate(words, color, ink)
                b.panel(drawn, (0.48, -0.014, 0), 0.85, 0.2, "-y")
                b.panel(plain(words, color, ink), (0.48, 0.014, 0), 0.85, 0.2, "+y")
    elif style == "street names":
        b.cylinder(0.032, 3.0, color="dark green", segments=12)
        b.ball(0.045, (0, 0, 3.02), "dark green")
        for k, yaw in enumerate((0.0, 90.0)):
            drawn = plain(STREETS[int(rng.integers(len(STREETS)))], "green", "white")
            with b.frame((0, 0, 2.86 - 0.22 * k), (0, 0, yaw)):
                b.box((0.012, 0.8, 0.19), (0, 0, -0.095), "green", skins={"+x": drawn, "-x": drawn})
    else:
        for y in (-0.75, 0.75):
            b.box((0.1, 0.1, 3.4), (-0.08, y, 0), "galvanised")
        image, draw = face("signal blue", 192, 108)
        draw.rounded_rectangle((12, 12, 756, 420), 24, outline=rgb("white"), width=8)
        for k, words in enumerate(("CENTRE", "STATION")):
            paint.text(draw, words, (180, 50 + 180 * k, 700, 200 + 180 * k), "white", bold=0.02)
            y = 125 + 180 * k
            draw.line((110, y + 50, 110, y - 20), fill=rgb("white"), width=18)
            draw.polygon([(110, y - 60), (70, y - 10), (150, y - 10)], fill=rgb("white"))
        b.plate(rectangle(2.1, 1.2), 0.02, (-0.01, 0, 2.9), done(image), "galvanised")
    return b.build(f"a {style} direction sign", {"style": style})


def plain(words: str, color: Color, ink: Color) -> Image.Image:
    image, draw = face(color, 112, 28)
    w, h = image.size
    draw.rectangle((8, 8, w - 8, h - 8), outline=rgb(ink), width=5)
    paint.text(draw, words, (24, 26, w - 24, h - 26), ink, bold=0.02)
    return done(image)


@recipe("road work detour ahead sign", 3, PORTABLE, hulls=4, name="signs.road_work_detour")
def road_work_detour(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Orange diamond on a spring stand, orange board on legs, yellow diversion board."""
    b = MeshBuilder(roughness=0.55)
    style = ("diamond", "board", "diversion")[variant % 3]
    n = PX * SCALE
    if style == "diamond":
        image, draw = face("safety orange")
        draw.polygon([(n / 2, 14), (n - 14, n / 2), (n / 2, n - 14), (14, n / 2)], outline=rgb("black"), width=8)
        paint.text(draw, "ROAD\nWORK\nAHEAD", (n * 0.24, n * 0.27, n * 0.76, n * 0.73), "black", bold=0.03)
        for y, x in ((-0.45, 0.35), (0.45, 0.35), (-0.45, -0.35), (0.45, -0.35)):
            b.beam((0, 0, 0.26), (x, y, 0.02), 0.04, 0.025, "charcoal")
        b.cylinder(0.03, 0.36, (0, 0, 0.2), "dark grey", segments=10)
        b.box((0.02, 0.04, 1.5), (-0.012, 0, 0.42), "charcoal")
        b.plate(ngon(4, 0.62), 0.006, (0.008, 0, 1.14), done(image), "safety orange")
    elif style == "board":
        image, draw = face("safety orange", 128, 96)
        draw.rounded_rectangle((12, 12, 500, 372), 20, outline=rgb("black"), width=8)
        paint.text(draw, "DETOUR\nAHEAD", (60, 50, 452, 250), "black", bold=0.04)
        draw.line((120, 310, 360, 310), fill=rgb("black"), width=24)
        draw.polygon([(430, 310), (350, 265), (350, 355)], fill=rgb("black"))
        for y in (-0.42, 0.42):
            b.beam((0, y, 0.0), (0, y, 1.6), 0.05, 0.03, "galvanised")
            b.beam((-0.4, y, 0.02), (0.4, y, 0.02), 0.05, 0.04, "galvanised")
            b.ball((0.16, 0.1, 0.06), (-0.24, y, 0.09), "beige")
        b.plate(rectangle(1.1, 0.82), 0.008, (0.022, 0, 1.2), done(image), "safety orange")
        for y in (-0.42, 0.42):
            b.cylinder(0.06, 0.04, (-0.02, y, 1.68), "amber", turn_deg=(0, 90, 0))
            b.box((0.05, 0.06, 0.08), (0, y, 1.6), "charcoal")
    else:
        image, draw = face("signal yellow", 112, 80)
        draw.rectangle((10, 10, 438, 310), outline=rgb("black"), width=8)
        paint.text(draw, "ROAD AHEAD\nCLOSED", (40, 30, 408, 180), "black", bold=0.03)
        paint.text(draw, "DETOUR", (40, 200, 250, 280), "black", bold=0.05)
        draw.line((270, 240, 360, 240), fill=rgb("black"), width=20)
        draw.polygon([(420, 240), (350, 200), (350, 280)], fill=rgb("black"))
        b.plate(rectangle(1.05, 0.75), 0.02, (0.0, 0, 0.62), done(image), "charcoal")
        for y in (-0.51, 0.51):
            b.beam((0.0, y, 1.0), (0.06, y, 0.0), 0.04, 0.03, "charcoal")
            b.beam((-0.02, y, 0.95), (-0.5, y, 0.0), 0.04, 0.03, "charcoal")
        b.beam((-0.28, -0.45, 0.43), (-0.28, 0.45, 0.43), 0.03, 0.03, "charcoal")
    return b.build(f"a {style} detour sign for road works", {"style": style})
