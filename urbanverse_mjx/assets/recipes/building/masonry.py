"""Parts of monuments and large blocks: painted fronts, halls, roofs, columns, pediments, domes, spires, flags."""

from collections.abc import Sequence

import numpy as np
from PIL import Image

from ...meshes import paint
from ...meshes.mesh_builder import ImageLike, MeshBuilder
from ...meshes.palette import Color, mix, rgb, shade
from ...meshes.shapes import Point3
from ..shared import facade_images as images

Wall = tuple[str, Color]


def painted_front(
    size_m: tuple[float, float],
    grid: tuple[int, int],
    wall: Wall,
    window: tuple[str, Color],
    rng: np.random.Generator,
    pixels: int = 200,
    fill: tuple[float, float] = (0.5, 0.55),
    band: Color | None = None,
) -> Image.Image:
    """A wall of size_m = (width, height) metres with rows of windows, for fronts too large for real openings.

    Args:
      grid: (bays, floors).
      window: style ("arch" for round-headed ones, "ribbon" for bands of glass, or one of `facade_images.window`) and
        frame.
      fill: share of its cell that a window takes, across and up.
      band: colour of a string course under every floor but the lowest.
    """
    width, height = size_m
    scale = min(pixels / width, 220.0 / height)
    w, h = max(24, round(width * scale)), max(20, round(height * scale))
    image = images.wall(wall[0], size_m, wall[1], rng, pixels).resize((w, h))
    (style, frame), (bays, floors) = window, grid
    cell = (w / bays, h / floors)
    size = (max(3, round(cell[0] * fill[0])), max(3, round(cell[1] * fill[1])))
    kind = "office" if style == "ribbon" else style
    panes = [arch_window(frame, size) if style == "arch" else images.window(kind, frame, rng, size) for _ in range(3)]
    pen = images.ImageDraw.Draw(image)
    for level in range(floors):
        top = level * cell[1]
        if band is not None and level < floors - 1:
            pen.rectangle((0, top + cell[1] - 2, w, top + cell[1]), fill=rgb(band))
        for k in range(bays):
            pane = panes[int(rng.integers(3))]
            x = (k + 0.5) * cell[0] - pane.width / 2
            image.paste(pane, (round(x), round(top + 0.5 * (cell[1] - pane.height))))
    return image


def arch_window(
    frame: Color, size: tuple[int, int], glass: Color = "dark glass", back: Color | None = None
) -> Image.Image:
    """A round-headed window; its corners show `back`."""
    w, h = size[0] * 4, size[1] * 4
    image, pen = paint.canvas((w, h), back if back is not None else shade(frame, 0.92))
    edge, r = 0.1 * w, min(w / 2, 0.6 * h)
    pen.ellipse((0, 0, w - 1, 2 * r), fill=rgb(frame))
    pen.rectangle((0, r, w - 1, h), fill=rgb(frame))
    pen.ellipse((edge, edge, w - edge, 2 * r - edge), fill=rgb(glass))
    pen.rectangle((edge, r, w - edge, h - edge), fill=rgb(glass))
    pen.rectangle((w / 2 - edge / 4, 0, w / 2 + edge / 4, h), fill=rgb(frame))
    for k in (0.4, 0.7):
        pen.rectangle((0, h * k, w, h * k + edge / 2), fill=rgb(frame))
    return paint.shrunk(image, size)


def rose_window(stone: Color, size: int = 48) -> Image.Image:
    """Round stained glass with tracery."""
    n = 4 * size
    image, pen = paint.canvas((n, n), stone)
    colors = ("signal blue", "dark red", "teal", "purple")
    pen.ellipse((0.04 * n, 0.04 * n, 0.96 * n, 0.96 * n), fill=rgb("charcoal"))
    for k in range(12):
        a = np.pi * k / 6
        for ring_, r in ((0.34, 0.095), (0.19, 0.055)):
            x, y = n * (0.5 + ring_ * np.cos(a)), n * (0.5 + ring_ * np.sin(a))
            pen.ellipse((x - r * n, y - r * n, x + r * n, y + r * n), fill=rgb(colors[k % 4]))
    pen.ellipse((0.4 * n, 0.4 * n, 0.6 * n, 0.6 * n), fill=rgb("amber"))
    pen.ellipse((0.02 * n, 0.02 * n, 0.98 * n, 0.98 * n), outline=rgb(shade(stone, 0.8)), width=n // 24)
    return paint.shrunk(image, (size, size))


def clock_face(size: int = 40, back: Color = "white") -> Image.Image:
    """A dial at ten past ten."""
    n = 4 * size
    image, pen = paint.canvas((n, n), "charcoal")
    pen.ellipse((0.04 * n, 0.04 * n, 0.96 * n, 0.96 * n), fill=rgb(back))
    for k in range(12):
        a = np.pi * k / 6
        tick = [(n * (0.5 + r * np.cos(a)), n * (0.5 + r * np.sin(a))) for r in (0.33, 0.42)]
        pen.line(tick, fill=rgb("black"), width=n // 28)
    for angle, length in ((-30, 0.36), (210, 0.25)):
        a = np.radians(angle)
        end = (n * (0.5 + length * np.cos(a)), n * (0.5 + length * np.sin(a)))
        pen.line((n / 2, n / 2, *end), fill=rgb("black"), width=n // 16)
    return paint.shrunk(image, (size, size))


def block(
    b: MeshBuilder,
    size: Point3,
    at: Point3,
    front: ImageLike,
    color: Color,
    side: ImageLike | None = None,
) -> None:
    """A box painted on its four walls; `color` shows on its roof."""
    flank = front if side is None else side
    b.box(size, at, color, skins={"+x": front, "-x": front, "+y": flank, "-y": flank})


def cornice(b: MeshBuilder, size: Point3, at: Point3, color: Color, out: float = 0.5) -> None:
    """A slab that juts out `out` m all round the top of a block of this size that stands on `at`."""
    low = 0.6 * out
    b.box((size[0] + out, size[1] + out, low), (at[0], at[1], at[2] + size[2] - low), color)
    b.box((size[0] + 2 * out, size[1] + 2 * out, low), (at[0], at[1], at[2] + size[2]), color)


def columns(
    b: MeshBuilder, x: float, ys: Sequence[float], z: float, height: float, radius: float, color: Color, sides: int = 10
) -> None:
    """Upright columns with base, entasis and capital."""
    profile = [
        (1.35 * radius, 0.0), (1.35 * radius, 0.3 * radius), (radius, 0.5 * radius), (0.82 * radius, height - radius),
        (1.35 * radius, height - 0.4 * radius), (1.35 * radius, height),
    ]  # fmt: skip
    for y in ys:
        b.lathe(profile, (x, y, z), color, segments=sides)


def pediment(
    b: MeshBuilder, x: float, depth: float, width: float, z: float, rise: float, color: Color, y: float = 0.0
) -> None:
    """A gable of `width` m facing +x whose front lies at x, with a sunk field."""
    with b.frame((x - depth / 2, y, z), (0, 0, 90)):
        b.profile([(-width / 2, 0), (width / 2, 0), (0, rise)], depth, color=color)
    inner = [(-0.38 * width, 0.1 * rise), (0.38 * width, 0.1 * rise), (0, 0.84 * rise)]
    with b.frame((x + 0.02, y, z), (0, 0, 90)):
        b.profile(inner, 0.06, color=shade(color, 0.8))


def steps(
    b: MeshBuilder, x: float, width: float, count: int, rise: float, run: float, color: Color, y: float = 0.0
) -> float:
    """Steps that climb towards -x and end at the wall plane x; returns the height of their top."""
    for k in range(count):
        reach = run * (count - k)
        b.box((reach, width, rise), (x + reach / 2, y, rise * k), color)
    return rise * count


def dome(
    b: MeshBuilder, at: Point3, radius: float, color: Color, rise: float = 1.0, tip: float = 0.0, sides: int = 20
) -> None:
    """A half ball `rise` radii high; `tip` > 0 draws it up to a point (onion domes)."""
    angles = np.linspace(0, np.pi / 2, 8 if sides > 14 else 5)
    profile = [(radius * np.cos(a), radius * rise * np.sin(a)) for a in angles]
    if tip > 0:
        height = radius * (rise + tip)
        swell = [np.cos(1.45 * t) + 0.28 * np.sin(np.pi * min(1.6 * t, 1.0)) for t in np.linspace(0, 1, 9)]
        profile = [(radius * r, height * k / 8) for k, r in enumerate(swell)]
        profile[-1] = (0.0, radius * (rise + tip))
    b.lathe([(max(r, 0.0), z) for r, z in profile], at, color, segments=sides)


def finial(b: MeshBuilder, at: Point3, height: float, kind: str, color: Color = "gold") -> None:
    """A "cross", "crescent" or "ball" on a rod, `height` m in all."""
    x, y, z = at
    r = 0.06 * height
    b.rod((x, y, z - 0.1 * height), (x, y, z + 0.6 * height), 0.6 * r, color, sides=6)
    if kind == "cross":
        b.box((r, r * 1.6, 0.8 * height), (x, y, z + 0.2 * height), color)
        b.box((r, 0.5 * height, r * 1.6), (x, y, z + 0.65 * height), color)
    elif kind == "crescent":
        b.ball(1.8 * r, (x, y, z + 0.3 * height), color, segments=8, rings=6)
        a = np.radians(np.linspace(-60, 240, 9) + 90 + 90)
        path = [(x, y + 0.22 * height * np.cos(t), z + 0.78 * height + 0.22 * height * np.sin(t)) for t in a]
        b.tube(path, [0.3 * r, r, 1.3 * r, 1.5 * r, 1.6 * r, 1.5 * r, 1.3 * r, r, 0.3 * r], color, sides=5)
    else:
        b.ball(3 * r, (x, y, z + 0.6 * height), color, segments=8, rings=6)


def hall(
    b: MeshBuilder, size: Point3, at: Point3, rise: float, wall: ImageLike, end: ImageLike, roof: Color, gable: Color
) -> None:
    """A hall whose ridge runs along x: walls of size, gables at both ends, a pitched roof with eaves."""
    length, width, height = size
    b.box(size, at, shade(gable, 0.9), skins={"+x": end, "-x": end, "+y": wall, "-y": wall})
    x, y, z = at
    half, e = width / 2, 0.05 * width
    slope = rise / half
    t = max(0.12, 0.02 * width)
    with b.frame((x, y, z + height), (0, 0, 90)):
        b.profile([(-half, 0.0), (half, 0.0), (0.0, rise)], length - 0.02, color=gable)
        section = [
            (-half - e, -e * slope + 0.02), (0, rise + 0.02), (half + e, -e * slope + 0.02),
            (half + e, -e * slope + t), (0, rise + t), (-half - e, -e * slope + t),
        ]  # fmt: skip
        b.profile(section, length + e, color=roof)


def hip_roof(b: MeshBuilder, size: Point3, at: Point3, color: Color, ridge: float = 0.5, lift: float = 0.0) -> None:
    """A roof over size = (x, y, rise) whose ridge takes a share of the longer side; `lift` curves the corners up."""
    dx, dy, rise = size
    long_y = dy >= dx
    rx, ry = (0.0, dy / 2 * ridge) if long_y else (dx / 2 * ridge, 0.0)
    steps_ = (0.0, 0.35, 0.7, 1.0) if lift > 0 else (0.0, 1.0)
    sections = []
    for t in steps_:
        share = 1 - t if lift == 0 else (1 - t) ** 1.5
        hx, hy = rx + (dx / 2 - rx) * share, ry + (dy / 2 - ry) * share
        corners = [(hx, -hy), (hx, hy), (-hx, hy), (-hx, -hy)]
        middles = [(hx, 0.0), (0.0, hy), (-hx, 0.0), (0.0, -hy)]
        ring = [p for pair in zip(corners, middles, strict=True) for p in (pair[0], pair[1])]
        up = lift * (1 - t) ** 3
        z = rise * t
        sections.append(np.array([(px, py, z + (up if k % 2 == 0 else 0.0)) for k, (px, py) in enumerate(ring)]))
    b.loft(sections, color, at, crease_deg=20)


def flag(b: MeshBuilder, at: Point3, height: float, colors: Sequence[Color]) -> None:
    """A pole with a striped flag."""
    x, y, z = at
    b.cylinder(0.012 * height, height, at, "aluminium", segments=6)
    wide, tall = 0.3 * height, 0.2 * height
    cloth = paint.stripes((24, 16), list(colors), len(colors))
    corners = [(x, y + u, z + height - v) for u, v in ((0.0, tall), (wide, tall), (wide, 0.0), (0.0, 0.0))]
    b.quad(corners, image=cloth, both_sides=True)


def board(b: MeshBuilder, words: str, at: Point3, width: float, height: float, back: Color, ink: Color) -> None:
    """A lettered board facing +x whose lower middle is at `at`."""
    pixels = min(256, max(96, round(28 * width / height)))
    lettering = images.sign(words, back, ink, (pixels, max(12, round(pixels * height / width))))
    b.box((0.15, width, height), (at[0] + 0.075, at[1], at[2]), mix(back, "black", 0.2), skins={"+x": lettering})


def gate(b: MeshBuilder, at: Point3, width: float, height: float, color: Color) -> None:
    """A door facing +x whose lower middle is at `at`, with a frame: glass in pale metal frames, else panelled wings."""
    x, y, z = at
    b.box((0.2, width * 1.16, height * 1.06), (x - 0.06, y, z), shade(color, 0.7))
    if color in ("aluminium", "charcoal", "teal", "signal blue"):
        b.panel(images.door(color, "double", (40, 56)), (x + 0.05, y, z + height / 2), width, height)
        return
    wing = np.asarray(images.door(color, "panel", (24, 56)))
    b.panel(np.hstack([wing, wing[:, ::-1]]), (x + 0.05, y, z + height / 2), width, height)
