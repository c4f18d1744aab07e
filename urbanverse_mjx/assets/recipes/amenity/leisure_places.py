"""Large sights beside a street: museums, arts centres, aquariums, castles, mills. The entrance is at +x."""

import numpy as np
from PIL import Image

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, rgb, shade
from ...meshes.recipe import recipe
from ...meshes.shapes import Point3
from ..shared.facade_images import door, sign, wall, window
from ..shared.outlines import arc, pairs
from ..shared.sizes import made
from .shelters import glazing

SIDES = ("+x", "-x", "+y", "-y")


def windowed(
    kind: str,
    color: Color,
    size_m: tuple[float, float],
    columns: int,
    rows: int,
    style: str,
    rng: np.random.Generator,
    pixels: int = 176,
) -> Image.Image:
    """A wall of size_m metres with a grid of windows."""
    image = wall(kind, size_m, color, rng, pixels)
    w, h = image.size
    pane = window(style, "white", rng, (max(6, int(w / columns * 0.42)), max(9, int(h / rows * 0.5))))
    for r in range(rows):
        for c in range(columns):
            image.paste(
                pane, (int((c + 0.5) * w / columns - pane.width / 2), int((r + 0.5) * h / rows - pane.height / 2))
            )
    return image


def block(
    b: MeshBuilder, size: Point3, at: Point3, color: Color, image: Image.Image, roof: Color = "dark grey"
) -> None:
    """A building's body with the same image on all four walls and a parapet."""
    b.box(size, at, color, skins=dict.fromkeys(SIDES, image))
    b.box((size[0] + 0.5, size[1] + 0.5, 0.45), (at[0], at[1], at[2] + size[2]), shade(color, 1.06), bevel=0.1)
    b.box((size[0] - 0.5, size[1] - 0.5, 0.1), (at[0], at[1], at[2] + size[2] + 0.45), roof)


def portico(
    b: MeshBuilder, x: float, width: float, low: float, high: float, columns: int, stone: Color, words: str
) -> None:
    """Columns under an architrave with a name and a pediment, standing on steps; its back is at x."""
    depth = 4.0
    for k in range(6):
        reach = depth + 0.5 * (6 - k)
        b.box((reach, width + 1.5, low / 6), (x + reach / 2, 0, k * low / 6), shade(stone, 0.9))
    for k in range(columns):
        y = (k - (columns - 1) / 2) * (width - 1.4) / (columns - 1)
        b.lathe(
            [(0.75, 0), (0.75, 0.3), (0.6, 0.5), (0.5, high - low - 0.9), (0.72, high - low - 0.4), (0.72, high - low)],
            (x + depth - 0.9, y, low),
            stone,
            segments=12,
        )
    b.box(
        (depth, width, 1.5), (x + depth / 2, 0, high), stone, skins={"+x": sign(words, stone, "dark wood", (176, 14))}
    )
    b.box((depth + 0.6, width + 0.8, 0.35), (x + depth / 2, 0, high + 1.5), shade(stone, 1.05))
    gable = [(-width / 2 - 0.4, 0), (width / 2 + 0.4, 0), (0, width * 0.16)]
    b.extrude(gable, depth + 0.4, (x - 0.2, 0, high + 1.85), stone, turn_deg=(90, 0, 90))
    b.extrude(
        [(p * 0.8, q * 0.72 + 0.25) for p, q in gable],
        0.1,
        (x + depth + 0.18, 0, high + 1.85),
        shade(stone, 0.8),
        turn_deg=(90, 0, 90),
    )


@recipe("museum", 3, name="leisure_places.museum")
def museum(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A temple front with banners, one with a dome, a modern white box museum on pillars."""
    b = MeshBuilder(roughness=0.8)
    if variant % 3 == 2:
        return _modern_museum(b, rng)
    stone, words = (("sandstone", "NATIONAL MUSEUM"), ("light grey", "MUSEUM OF HISTORY"))[variant % 3]
    image = windowed("ashlar", stone, (44, 11), 9, 2, "grid", rng)
    block(b, (24, 46, 11), (-2, 0, 0.4), stone, image)
    b.box((25, 47, 1.6), (-2, 0, 0), shade(stone, 0.85), bevel=0.1)
    portico(b, 10.0, 17, 1.8, 9.2, 8, stone, words)
    b.panel(door("dark wood", "double", (40, 64)), (10.12, 0, 4.4), 3.4, 5.2)
    for s, ink in ((-1, "signal red"), (1, "signal blue")):
        b.box(
            (0.15, 2.4, 7.4),
            (10.3, s * 12.5, 2.4),
            ink,
            skins={"+x": sign("ART\nOF\nROME" if s > 0 else "GOLD", ink, "white", (32, 96))},
        )
    if variant % 3 == 1:
        b.cylinder(6.0, 3.0, (-2, 0, 11.3), stone, segments=20)
        b.lathe([(6.3, 14.2), (6.1, 15.6), (5.0, 18.0), (3.0, 19.6), (0.8, 20.3)], (-2, 0, 0), "verdigris", segments=20)
        b.lathe([(0.8, 20.3), (0.8, 21.4), (0, 22.4)], (-2, 0, 0), "gold", segments=12)
        return made(b, "a museum with a dome", (34, 50, 21.0), 0.8, style="dome")
    b.box((14, 22, 3.2), (-4, 0, 11.4), stone, skins=dict.fromkeys(SIDES, glazing(128, 16, 12, 1, "off white")))
    b.convex(
        [(-4 + sx * 7.4, sy * 11.4, 14.6) for sx in (-1, 1) for sy in (-1, 1)] + [(-4, sy * 8, 16.0) for sy in (-1, 1)],
        "verdigris",
    )
    return made(b, "a museum with a temple front", (32, 48, 16), 0.8, style="temple")


def _modern_museum(b: MeshBuilder, rng: np.random.Generator) -> BuiltAsset:
    """A white box on a glazed ground floor and pillars, with rings of red steel before it."""
    b.box((26, 40, 0.4), color="concrete")
    for x in (-9, 9):
        for y in np.linspace(-16, 16, 6):
            b.cylinder(0.5, 4.6, (x, float(y), 0.3), "light grey", segments=12)
    b.box((16, 28, 4.4), (-1, 0, 0.3), "dark glass", skins=dict.fromkeys(SIDES, glazing(160, 28, 10, 1, "charcoal")))
    image = wall("panel", (38, 7), "white", rng, 176)
    b.box((24, 38, 7.5), (0, 0, 4.8), "white", skins=dict.fromkeys(SIDES, image))
    b.box((15, 22, 2.6), (-2, 4, 12.3), "light grey", skins=dict.fromkeys(SIDES, glazing(96, 12, 12, 1, "white")))
    b.panel(sign("MUSEUM OF ART", "white", "black", (176, 20)), (12.1, -4, 9.6), 20, 2.3)
    b.panel(sign("MODERN\nNOW", "signal red", "white", (48, 80)), (12.1, 14, 8.5), 3.6, 6.0)
    for k in range(3):
        with b.frame((12.8, 9 - 0.4 * k, 0.4), (20 * k, 35 * k, 0)):
            b.ring(1.6 + 0.3 * k, 0.22, (0, 0, 1.9), "signal red", (90, 0, 30 * k), 20, 6)
    return made(b, "a modern museum", (28, 42, 15.0), 0.8, style="modern")


@recipe("arts center", 3, name="leisure_places.arts_center")
def arts_center(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Shifted coloured cubes about a glass foyer, a hall with a sail roof, a brick hall with a tall sign."""
    b = MeshBuilder(roughness=0.7)
    if variant % 3 == 0:
        b.box((21, 27, 0.3), color="concrete")
        for size, at, color in (
            ((11, 12, 8.4), (-3, -6.5, 0.3), "#b2493c"),
            ((9, 9, 5.6), (-2.0, 8.6, 0.3), "charcoal"),
            ((13, 10, 4.2), (-1, 2.5, 5.0), "off white"),
        ):
            b.box(
                size,
                at,
                color,
                turn_deg=(0, 0, -4 if color == "off white" else 3),
                skins=dict.fromkeys(SIDES, wall("panel", (size[1], size[2]), color, rng, 72)),
            )
        b.box(
            (12, 8, 5.0), (2.5, 2.6, 0.3), "dark glass", skins=dict.fromkeys(SIDES, glazing(80, 48, 6, 3, "charcoal"))
        )
        b.panel(sign("ARTS CENTRE", "off white", "black", (144, 26)), (5.72, 2.1, 7.2), 8.5, 1.6, -4.0)
        b.panel(sign("DANCE", "#b2493c", "white", (48, 96)), (2.75, -8.2, 4.4), 3.0, 6.0, 3.0)
        for k in range(4):
            b.tube(
                [(8.2, -7 + 1.4 * k, 0.3), (8.4, -7 + 1.4 * k, 2.4 + 0.5 * k), (8.9, -6.6 + 1.4 * k, 3.0 + 0.6 * k)],
                0.16,
                ("signal yellow", "teal", "orange", "purple")[k],
            )
        return made(b, "an arts centre of shifted cubes", (22, 28, 10.0), 0.75, style="cubes")
    if variant % 3 == 1:
        b.box((22, 32, 0.4), color="sandstone")
        b.box((14, 26, 6.0), (-2, 0, 0.4), "dark glass", skins=dict.fromkeys(SIDES, glazing(160, 40, 13, 3, "white")))
        for k in range(4):
            y, reach = -11.5 + 7.2 * k, 1.0 - 0.12 * abs(k - 1.4)
            rows = []
            for s in np.linspace(0, 1, 7):
                half = 3.9 * (1 - s**2.2) + 0.1
                rows.append(
                    [
                        (
                            -9 + 19 * s * reach - 9 * s**2 * 0.3,
                            y + v * half,
                            5.8 + 8.0 * reach * np.sin(np.pi * (0.28 + 0.55 * s)) * (1 - 0.35 * abs(v) ** 2),
                        )
                        for v in np.linspace(-1, 1, 7)
                    ]
                )
            b.sheet(np.array(rows), "white", both_sides=True)
        b.panel(sign("ARTS & MUSIC", "signal blue", "white", (128, 18)), (5.03, 0, 5.4), 12, 1.4)
        for k in range(5):
            b.box((1.0, 12, 0.2), (6.5 + 0.8 * k, 0, 0.4 - 0.08 * k), "sandstone", bevel=0.02)
        return made(b, "an arts centre under sails", (24, 34, 13), 0.7, style="sails")
    image = windowed("brick", "#8d5541", (24, 8), 6, 2, "grid", rng)
    b.box((17, 24, 8.5), (-1.5, 0, 0), "brick", skins=dict.fromkeys(SIDES, image))
    for k in range(4):
        y = -9 + 6 * k
        b.convex([(x, y + v, z) for x in (-10, 7) for v, z in ((-3, 8.5), (3, 8.5), (-3, 11.0))], "dark grey")
    b.box(
        (3.0, 12, 4.4),
        (8.3, 2, 0),
        "dark glass",
        skins={"+x": glazing(96, 36, 8, 2, "charcoal"), "+y": glazing(24, 36, 2, 2, "charcoal")},
    )
    b.box(
        (2.2, 2.2, 13.5),
        (8.0, -8, 0),
        "signal yellow",
        skins={"+x": sign("A\nR\nT\nS", "signal yellow", "black", (32, 128))},
    )
    b.lathe([(1.3, 0), (0.8, 11.6), (1.0, 12.0), (1.0, 12.6), (0.7, 12.6)], (-7.5, 8.5, 0), "brick", segments=16)
    b.panel(sign("FACTORY OF ARTS", "charcoal", "signal yellow", (144, 18)), (9.82, 2, 3.9), 10, 1.1)
    return made(b, "an arts centre in a brick factory", (19.5, 24.5, 13.5), 0.8, style="factory")


def _shoal(rng: np.random.Generator) -> Image.Image:
    """A wall painting of many fishes."""
    mural, draw = paint.canvas((352, 132), "#1f7fae")
    for k in range(14):
        x, y, r = (float(v) for v in rng.uniform((24, 20, 10), (328, 112, 26)))
        ink = rgb(("orange", "signal yellow", "white", "pink", "lime", "light blue")[k % 6])
        draw.ellipse((x - r, y - r * 0.55, x + r, y + r * 0.55), fill=ink)
        draw.polygon([(x - r * 0.8, y), (x - r * 1.6, y - r * 0.55), (x - r * 1.6, y + r * 0.55)], fill=ink)
        draw.ellipse((x + r * 0.5, y - r * 0.25, x + r * 0.7, y - r * 0.05), fill=(10, 10, 10))
    return paint.shrunk(mural, (176, 66))


@recipe("aquarium", 3, name="leisure_places.aquarium")
def aquarium(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A wave-roofed building with a fish mural and a leaping dolphin, a round tank building, a wedge with a shark."""
    b = MeshBuilder(roughness=0.5)
    mural = _shoal(rng)
    d, w, h = ((32, 45, 13), (30, 34, 16), (26, 40, 14))[variant % 3]
    b.box((d, w, 0.4), color="concrete")
    if variant % 3 == 1:
        b.cylinder(12.5, 9.5, (-1.5, 0, 0.3), "light blue", segments=28)
        t = np.radians(np.linspace(-80, 80, 15))
        b.sheet(
            np.array([[(-1.5 + 12.6 * np.cos(a), 12.6 * np.sin(a), z) for a in t] for z in (3.6, 9.2)]), image=mural
        )
        b.lathe([(14.0, 9.6), (14.2, 10.2), (7, 12.6), (6.5, 14.4), (0, 16)], (-1.5, 0, 0), "white", segments=28)
        b.box(
            (5, 10, 3.4),
            (11, 0, 0.3),
            "dark glass",
            skins=dict.fromkeys(("+x", "+y", "-y"), glazing(96, 32, 6, 1, "white")),
        )
    else:
        back = -d / 2 + 2
        top = 9.0
        b.box(
            (d - 8, w - 6, top - 0.4),
            (-2, 0, 0.4),
            "#d8e4e8",
            skins={s: mural if s in ("+x", "-y") else wall("panel", (w, 9), "#d8e4e8", rng, 96) for s in SIDES},
        )
        if variant % 3 == 0:
            y = np.linspace(-w / 2 + 1, w / 2 - 1, 25)
            z = top + 1.4 + 1.5 * np.sin(y / w * 4 * np.pi)
            ribbon = [*zip(y, z, strict=True), *zip(y[::-1], z[::-1] - 1.2, strict=True)]
            b.extrude(ribbon, d - 3, (back - 1, 0, 0), "#3f9cc0", turn_deg=(90, 0, 90))
        else:
            b.convex(
                [
                    (x, y, z)
                    for y in (-w / 2 + 2, w / 2 - 2)
                    for x, z in ((back, top), (d / 2 - 2, top), (d / 2 - 1, top + 0.8), (back, top + 4.6))
                ],
                "#2b5f86",
            )
        b.box(
            (4, 14, 4.2),
            (d / 2 - 5, 0, 0.4),
            "dark glass",
            skins=dict.fromkeys(("+x", "+y", "-y"), glazing(128, 40, 8, 1, "white")),
        )
    x = d / 2 - 2.9 if variant % 3 != 1 else 13.6
    b.box(
        (0.4, 13, 2.0),
        (x, 0, 4.5 if variant % 3 != 1 else 3.7),
        "dark blue",
        skins={"+x": sign("AQUARIUM", "dark blue", "white", (144, 24))},
    )
    with b.frame((d / 2 - 2.2, w * 0.32, 0.4), (0, 0, -55), 1.5):
        b.box((1.6, 1.6, 0.5), color="granite")
        curve = [(-1.5, 0, 0.4), (-1.1, 0, 1.5), (-0.3, 0, 2.3), (0.6, 0, 2.5), (1.3, 0, 2.1), (1.75, 0, 1.65)]
        b.tube(curve, [0.08, 0.25, 0.45, 0.42, 0.25, 0.08], "dark grey" if variant % 3 == 2 else "#5d86a0", sides=10)
        b.convex(
            [(-0.2, y, z) for y in (-0.05, 0.05) for z in (2.6,)]
            + [(0.5, y, 2.8) for y in (-0.05, 0.05)]
            + [(-0.2, 0, 3.3)],
            "#4c728a",
        )
        b.convex([(-1.45, 0, 0.5), (-1.5, -0.8, 0.2), (-1.5, 0.8, 0.2), (-1.7, 0, 0.35), (-1.4, 0, 0.3)], "#4c728a")
        for s in (-1, 1):
            b.convex([(0.4, s * 0.3, 2.2), (0.8, s * 0.3, 2.1), (0.3, s * 0.95, 1.6), (0.45, s * 0.35, 2.1)], "#4c728a")
    return made(b, "an aquarium", (d, w, h), 0.75, style=("wave", "round", "wedge")[variant % 3])


def battlements(
    b: MeshBuilder,
    start: tuple[float, float],
    end: tuple[float, float],
    z: float,
    color: Color,
    count: int,
    thick: float = 1.0,
) -> None:
    """Merlons along a wall top."""
    for k in range(count):
        s = (k + 0.5) / count
        x, y = start[0] + (end[0] - start[0]) * s, start[1] + (end[1] - start[1]) * s
        yaw = float(np.degrees(np.arctan2(end[1] - start[1], end[0] - start[0])))
        length = float(np.hypot(end[0] - start[0], end[1] - start[1])) / count * 0.55
        b.box((length, thick, 1.1), (x, y, z), color, turn_deg=(0, 0, yaw))


@recipe("castle", 3, name="leisure_places.castle")
def castle(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A moatless fortress with round towers, a fairy-tale one with pointed roofs, a square keep in a curtain wall."""
    b = MeshBuilder(roughness=0.9)
    stone, roof, (d, w, h) = (
        ("granite", None, (36, 48, 24)),
        ("off white", "signal blue", (32, 40, 38)),
        ("sandstone", None, (30, 36, 20)),
    )[variant % 3]
    image = wall("ashlar", (20, 9), stone, rng, 128)
    hx, hy, low = d / 2 - 4, w / 2 - 4, 8.5
    for sx in (-1, 1):
        b.box((2, 2 * hy, low), (sx * hx, 0, 0), stone, skins={"+x": image, "-x": image})
        battlements(b, (sx * hx + sx * 0.5, -hy), (sx * hx + sx * 0.5, hy), low, stone, 14)
    for sy in (-1, 1):
        b.box((2 * hx, 2, low), (0, sy * hy, 0), stone, skins={"+y": image, "-y": image})
        battlements(b, (-hx, sy * hy + sy * 0.5), (hx, sy * hy + sy * 0.5), low, stone, 10)
        for sx in (-1, 1):
            _tower(
                b,
                (sx * hx, sy * hy),
                3.5,
                12.5 + 2.0 * (sx < 0),
                stone,
                roof if roof else ("terracotta" if variant % 3 == 0 and sy > 0 else None),
                square=variant % 3 == 2,
            )
    b.box((6, 10, 11), (hx, 0, 0), stone, skins={"+x": wall("ashlar", (10, 11), stone, rng, 64)})
    battlements(b, (hx + 2.5, -5), (hx + 2.5, 5), 11, stone, 5)
    arch = [(-1.9, 0), (1.9, 0), *pairs(arc(1.9, 0, 180, 9, (0, 3.4)))]
    b.extrude(arch, 0.3, (hx + 2.9, 0, 0), "dark wood", turn_deg=(90, 0, 90))
    for y in (-1.0, 0, 1.0):
        b.box((0.1, 0.15, 4.6), (hx + 3.2, y, 0.2), "black")
    keep = (9, 11, 17) if variant % 3 != 1 else (9, 12, 15)
    b.box(
        keep,
        (-4, 0, 0),
        stone,
        skins=dict.fromkeys(SIDES, windowed("ashlar", stone, (11, 17), 3, 4, "single", rng, 72)),
    )
    if roof:
        b.convex(
            [(-4 + sx * 5, sy * 6.5, keep[2]) for sx in (-1, 1) for sy in (-1, 1)]
            + [(-4, s * 4, keep[2] + 7) for s in (-1, 1)],
            roof,
        )
        for y, tall in ((-6, 24), (6, 20)):
            _tower(b, (-8, y), 2.3, tall, stone, roof)
    else:
        for sx in (-1, 1):
            battlements(b, (-4 + sx * 4, -5.5), (-4 + sx * 4, 5.5), keep[2], stone, 5)
            battlements(b, (-8.5, sx * 5), (0.5, sx * 5), keep[2], stone, 4)
        b.rod((-4, 0, keep[2]), (-4, 0, keep[2] + 6), 0.12, "dark wood")
        b.box((0.08, 3.0, 1.8), (-4, 1.55, keep[2] + 4.1), "signal red")
    return made(b, f"a castle of {stone}", (d, w, h), 0.5, stone=stone)


def _tower(
    b: MeshBuilder,
    at: tuple[float, float],
    radius: float,
    top: float,
    stone: Color,
    roof: Color | None,
    square: bool = False,
) -> None:
    """A round or square tower with a parapet or a pointed roof."""
    n = 4 if square else 14
    r = radius * (1.25 if square else 1.0)
    with b.frame((at[0], at[1], 0), (0, 0, 45 if square else 0)):
        b.lathe(
            [(r * 1.05, 0), (r, 2), (r, top - 1.6), (r * 1.15, top - 0.8), (r * 1.15, top)], color=stone, segments=n
        )
        if roof:
            b.lathe([(r * 1.3, top), (r * 0.1, top + r * 2.6), (0, top + r * 2.9)], color=roof, segments=n)
        else:
            for k in range(8):
                a = 360 / 8 * k + 22.5
                with b.frame((0, 0, 0), (0, 0, a)):
                    b.box((0.9, 1.3, 1.1), (r * (1.08 if not square else 0.82), 0, top), stone)
    for k in range(3):
        b.box((0.2, 0.5, 1.6), (at[0] + radius * 0.98 * np.sign(at[0] or 1), at[1], top * (0.3 + 0.2 * k)), "black")
