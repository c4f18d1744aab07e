"""Images of regional fronts: windows, roller shutters, lattices, tiles, corrugated sheets, signs."""

import numpy as np
from PIL import Image, ImageDraw

from ....meshes import paint
from ....meshes.palette import Color, mix, rgb, shade
from ...shared import facade_images as images
from . import words

Size = tuple[int, int]
#: Trade -> what its window shows (`facade_images.shop_window`).
GOODS = {
    "cafe": "tables", "food": "breads", "general": "boxes", "wear": "clothes", "health": "bottles", "hair": "salon",
    "stay": "tables", "bank": "tables",
}  # fmt: skip


def pane(style: str, frame: Color, rng: np.random.Generator, size: Size = (36, 54)) -> Image.Image:
    """A window: a style of `facade_images.window`, or "french", "sliding", "louvres", "jalousie" or "lattice"."""
    drawn = {"french": _french, "sliding": _sliding, "louvres": _louvres, "jalousie": _jalousie, "lattice": _lattice}
    if style in drawn:
        return drawn[style](frame, rng, size)
    return images.window(style, frame, rng, size)


def _glass(size: Size, frame: Color, rng: np.random.Generator) -> tuple[Image.Image, ImageDraw.ImageDraw, int, int]:
    w, h = paint.smooth(size)
    image, pen = paint.canvas((w, h), frame)
    tone = mix("dark glass", "light blue", float(rng.uniform(0.05, 0.35)))
    for k in range(24):
        pen.rectangle((0, h * k / 24, w, h * (k + 1) / 24), fill=mix(tone, "light blue", 0.4 * (1 - k / 24)))
    return image, pen, w, h


def _french(frame: Color, rng: np.random.Generator, size: Size) -> Image.Image:
    """Two tall leaves of four panes, with pale curtains at times."""
    image, pen, w, h = _glass(size, frame, rng)
    if rng.random() < 0.6:
        for side in (0, 1):
            points = [(0, 0), (w * 0.42, 0), (w * 0.3, h * 0.6), (w * 0.26, h), (0, h)]
            pen.polygon([(w - x if side else x, y) for x, y in points], fill=rgb("off white"))
    bar = max(4, int(0.045 * w))
    for k in range(5):
        pen.rectangle((0, h * k / 4 - bar / 2, w, h * k / 4 + bar / 2), fill=rgb(frame))
    pen.rectangle((0, h * 0.84, w, h), fill=rgb(frame))
    for x, wide in ((0, 2.4), (w / 2, 2.2), (w, 2.4)):
        pen.rectangle((x - bar * wide / 2, 0, x + bar * wide / 2, h), fill=rgb(frame))
    return paint.shrunk(image, size)


def _sliding(frame: Color, rng: np.random.Generator, size: Size) -> Image.Image:
    """Two sliding panes, one often of frosted glass or with a blind."""
    image, pen, w, h = _glass(size, frame, rng)
    if rng.random() < 0.65:
        side = int(rng.integers(2)) * w / 2
        pen.rectangle((side, 0, side + w / 2, h), fill=mix("white", "light blue", 0.25))
    bar = max(4, int(0.06 * w))
    pen.rectangle((w / 2 - bar / 2, 0, w / 2 + bar / 2, h), fill=rgb(frame))
    pen.rectangle((0, 0, w - 1, h - 1), outline=rgb(frame), width=bar)
    return paint.shrunk(image, size)


def _louvres(frame: Color, rng: np.random.Generator, size: Size) -> Image.Image:
    """Blades of glass in two wings."""
    image, pen, w, h = _glass(size, frame, rng)
    for k in range(9):
        y = h * (k + 0.5) / 9
        pen.rectangle((0, y, w, y + h / 30), fill=mix("light blue", "white", 0.45))
        pen.rectangle((0, y + h / 30, w, y + h / 18), fill=rgb("black"))
    bar = max(4, int(0.07 * w))
    pen.rectangle((w / 2 - bar / 2, 0, w / 2 + bar / 2, h), fill=rgb(frame))
    pen.rectangle((0, 0, w - 1, h - 1), outline=rgb(frame), width=bar)
    return paint.shrunk(image, size)


def _jalousie(frame: Color, rng: np.random.Generator, size: Size) -> Image.Image:
    """Closed louvred shutters in two leaves."""
    w, h = paint.smooth(size)
    image, pen = paint.canvas((w, h), frame)
    for k in range(22):
        y = h * (0.04 + 0.92 * k / 22)
        pen.rectangle((w * 0.06, y, w * 0.94, y + h * 0.018), fill=shade(frame, 0.62))
    for x in (0.0, 0.5, 1.0):
        pen.rectangle((w * x - w * 0.05, 0, w * x + w * 0.05, h), fill=shade(frame, 0.92))
    pen.rectangle((0, h * 0.5 - 6, w, h * 0.5 + 6), fill=shade(frame, 0.92))
    pen.line((w / 2, 0, w / 2, h), fill=shade(frame, 0.5), width=3)
    return paint.shrunk(image, size)


def _lattice(frame: Color, rng: np.random.Generator, size: Size) -> Image.Image:
    """Upright wooden bars before a dim or lit interior."""
    w, h = paint.smooth(size)
    image, pen = paint.canvas((w, h), mix("black", "lamp", 0.25 if rng.random() < 0.5 else 0.08))
    count = max(6, round(size[0] / 3.2))
    for k in range(count):
        x = w * (k + 0.2) / count
        pen.rectangle((x, 0, x + 0.52 * w / count, h), fill=shade(frame, 0.85 + 0.25 * float(rng.random())))
    for y in (0.0, 0.32, 0.94):
        pen.rectangle((0, h * y, w, h * (y + 0.05)), fill=shade(frame, 0.8))
    return paint.shrunk(image, size)


def roller(color: Color, rng: np.random.Generator, size: Size = (64, 56)) -> Image.Image:
    """A closed roller shutter, dirty at the foot."""
    w, h = paint.smooth(size)
    image, pen = paint.canvas((w, h), color)
    for k in range(18):
        y = h * k / 18
        pen.rectangle((0, y, w, y + h / 50), fill=shade(color, 0.7))
        pen.rectangle((0, y + h / 50, w, y + h / 30), fill=mix(color, "white", 0.25))
    pen.rectangle((0, h * 0.95, w, h), fill=shade(color, 0.55))
    for _ in range(5):
        x, y = float(rng.random()) * w, h * (0.3 + 0.6 * float(rng.random()))
        pen.ellipse((x, y, x + w / 9, y + h / 16), fill=mix(color, "soil", 0.3))
    return paint.shrunk(image, size)


def tiled(kind: str, color: Color, size: Size, courses: int, ribs: int) -> np.ndarray:
    """(h, w, 3) uint8 of a roof: "tiles" with round ribs and courses, or "sheet" with ribs alone and rust."""
    w, h = size
    y, x = np.mgrid[0:h, 0:w]
    wave = 0.5 + 0.5 * np.sin(2 * np.pi * x * ribs / w)
    tone = 0.72 + 0.36 * wave
    rng = np.random.default_rng(7)
    if kind == "tiles":
        course = (y * courses / h) % 1.0
        tone = tone * (0.74 + 0.3 * course)
        cell = rng.normal(1.0, 0.07, (courses + 1, ribs + 1))
        tone = tone * cell[np.minimum((y * courses // h), courses), np.minimum(x * ribs // w, ribs)]
    base = np.array(rgb(color), float) * np.ones((h, w, 1))
    if kind == "sheet":
        blot = np.kron(rng.random((-(-h // 6), -(-w // 8))), np.ones((6, 8)))[:h, :w]
        rust = np.clip((blot - 0.72) * 2.4, 0, 0.8)[..., None]
        base = base * (1 - rust) + np.array(rgb("rust"), float) * rust
    return np.clip(base * tone[..., None], 0, 255).astype(np.uint8)


def cladding(kind: str, size_m: tuple[float, float], color: Color, rng: np.random.Generator) -> Image.Image:
    """A wall of `facade_images.wall`, or "corrugated" (upright ribs), "tiles" (small tiles) or "stained" plaster."""
    if kind in ("corrugated", "tiles", "stained"):
        image = images.wall("plaster", size_m, color, rng)
        pixels = np.asarray(image, float)
        height, width = pixels.shape[:2]
        scale = width / size_m[0]
        y, x = np.mgrid[0:height, 0:width]
        if kind == "corrugated":
            tone = 0.9 + 0.14 * np.sin(2 * np.pi * x / max(4.0, 0.22 * scale))
        elif kind == "tiles":
            step = max(4, round(0.16 * scale))
            tone = np.where((x % step == 0) | (y % (step // 2) == 0), 0.9, 1.0)
            tone = tone * rng.normal(1.0, 0.03, (height // step + 1, width // step + 1))[y // step, x // step]
        else:
            drip = np.convolve(rng.normal(0, 1, width), np.ones(7) / 7, "same")[x]
            fall = np.clip(1.2 - y / (0.45 * height), 0, 1) + 0.5 * (y > 0.86 * height)
            coarse = Image.fromarray((rng.random((max(2, height // 14), max(2, width // 14))) * 255).astype(np.uint8))
            blot = np.asarray(coarse.resize((width, height), Image.Resampling.BICUBIC), float) / 255
            tone = 1.0 - 0.2 * np.clip(drip + 0.2, 0, 1) * fall - 0.22 * np.clip(blot - 0.55, 0, 1)
        return Image.fromarray(np.clip(pixels * tone[..., None], 0, 255).astype(np.uint8))
    return images.wall(kind, size_m, color, rng)


def sign(
    language: str, entry: str, back: Color, ink: Color, size: Size, upright: bool = False, border: Color | None = None
) -> Image.Image:
    """A sign with an entry of `words.toml`, as large as it fits; two lines stand above each other."""
    image, pen = paint.canvas(size, back)
    if border is not None:
        pen.rectangle((1, 1, size[0] - 2, size[1] - 2), outline=rgb(border), width=max(1, size[1] // 16))
    lines = words.lines(entry)
    if upright:
        lines = lines[-1:]  # the line in the local script
    side_by_side = len(lines) == 2 and size[0] > 5.5 * size[1]
    for k, line in enumerate(lines):
        ink_mask = words.mask(language, line, upright)
        share = 1.0 / len(lines)
        w, h = (size[0] * share, float(size[1])) if side_by_side else (float(size[0]), size[1] * share)
        scale = min(0.9 * w / ink_mask.width, (0.92 if upright else 0.72) * h / ink_mask.height)
        fitted = ink_mask.resize(
            (max(1, round(ink_mask.width * scale)), max(1, round(ink_mask.height * scale))), Image.Resampling.LANCZOS
        )
        left, top = (k * w, 0.0) if side_by_side else (0.0, k * h)
        at = (round(left + (w - fitted.width) / 2), round(top + (h - fitted.height) / 2))
        image.paste(rgb(ink), at, fitted)
    return image


def shop(trade: str, frame: Color, rng: np.random.Generator, size: Size, warm: bool = True) -> Image.Image:
    """A shop window of a trade."""
    return images.shop_window(GOODS[trade], frame, rng, size, warm)


def machine_front() -> Image.Image:
    """The fan of an air conditioner's outdoor unit."""
    image, pen = paint.canvas((96, 64), "off white")
    pen.ellipse((8, 4, 64, 60), fill=rgb("dark grey"))
    for k in range(4):
        pen.ellipse((12 + 6 * k, 8 + 6 * k, 60 - 6 * k, 56 - 6 * k), outline=rgb("light grey"), width=2)
    pen.rectangle((74, 8, 88, 56), fill=rgb("light grey"))
    return paint.shrunk(image, (24, 16))
