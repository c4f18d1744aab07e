"""Draws images for signs, screens, doors and posters with Pillow and its built-in typeface."""

import contextlib
import contextvars
from collections.abc import Callable, Iterator, Sequence

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from .palette import Color, rgb

Size = tuple[int, int]
#: Text -> its lines as masks (255 = ink), another text, or None to write it as it is.
Translator = Callable[[str], "list[Image.Image] | str | None"]
_TRANSLATOR: contextvars.ContextVar[Translator | None] = contextvars.ContextVar("translator", default=None)


def canvas(size: Size, color: Color) -> tuple[Image.Image, ImageDraw.ImageDraw]:
    """An image of (width, height) pixels in one colour, and its drawing context."""
    image = Image.new("RGB", size, rgb(color))
    return image, ImageDraw.Draw(image)


def text(
    draw: ImageDraw.ImageDraw,
    words: str,
    box: tuple[float, float, float, float],
    color: Color,
    bold: float = 0.0,
    limit: int = 400,
) -> None:
    """Writes words centred in box = (left, top, right, bottom), as large as they fit.

    `bold` thickens the strokes by a share of the size; `limit` is the largest size in pixels. Within `translating`, the
    words may be others.
    """
    translator = _TRANSLATOR.get()
    found = translator(words) if translator else None
    if isinstance(found, list):
        _write_masks(draw, found, box, color)
        return
    words = found or words
    left, top, right, bottom = box
    low, high = 4, limit
    while low < high:
        size = (low + high + 1) // 2
        x0, y0, x1, y1 = _extent(draw, words, size, bold)
        fits = x1 - x0 <= right - left and y1 - y0 <= bottom - top
        low, high = (size, high) if fits else (low, size - 1)
    x0, y0, x1, y1 = _extent(draw, words, low, bold)
    at = ((left + right - x0 - x1) / 2, (top + bottom - y0 - y1) / 2)
    fill, stroke = rgb(color), round(low * bold)
    font = ImageFont.load_default(low)
    draw.multiline_text(at, words, fill=fill, font=font, stroke_width=stroke, stroke_fill=fill, align="center")


@contextlib.contextmanager
def translating(translator: Translator) -> Iterator[None]:
    """Within the context, `text` writes what the translator returns."""
    token = _TRANSLATOR.set(translator)
    try:
        yield
    finally:
        _TRANSLATOR.reset(token)


def _write_masks(
    draw: ImageDraw.ImageDraw, lines: Sequence[Image.Image], box: tuple[float, float, float, float], color: Color
) -> None:
    """Writes lines of one height below each other, centred in the box, as large as they fit."""
    left, top, right, bottom = box
    high = (bottom - top) / len(lines)
    scale = min(
        (right - left) / max(line.width for line in lines), (0.8 if len(lines) > 1 else 1.0) * high / lines[0].height
    )
    for k, line in enumerate(lines):
        size = (max(1, round(line.width * scale)), max(1, round(line.height * scale)))
        fitted = line.resize(size, Image.Resampling.LANCZOS)
        at = (round((left + right - size[0]) / 2), round(top + high * k + (high - size[1]) / 2))
        draw.bitmap(at, fitted, fill=rgb(color))


def _extent(draw: ImageDraw.ImageDraw, words: str, size: int, bold: float) -> tuple[float, float, float, float]:
    font = ImageFont.load_default(size)
    return draw.multiline_textbbox((0, 0), words, font=font, stroke_width=round(size * bold), align="center")


def smooth(size: Size, scale: int = 4) -> Size:
    """Size at which to draw before `shrunk`, for clean edges."""
    return size[0] * scale, size[1] * scale


def shrunk(image: Image.Image, size: Size) -> Image.Image:
    """The image resampled to its final size."""
    return image.resize(size, Image.Resampling.LANCZOS)


def speckled(size: Size, color: Color, rng: np.random.Generator, amount: float = 10.0, grain: int = 2) -> Image.Image:
    """Stone-like noise about a colour: `amount` = standard deviation (0-255), `grain` = pixels a fleck."""
    width, height = size
    coarse = rng.normal(0.0, amount, (-(-height // grain), -(-width // grain), 1))
    noise = np.kron(coarse, np.ones((grain, grain, 1)))[:height, :width]
    return Image.fromarray(np.clip(np.array(rgb(color)) + noise, 0, 255).astype(np.uint8), "RGB")


def stripes(size: Size, colors: Sequence[Color], count: int, slant: float = 0.0) -> Image.Image:
    """`count` stripes across the width in alternating colours; `slant` shifts their top by that share of the height."""
    width, height = size
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    phase = (x + slant * (height - y)) / width * count
    table = np.array([rgb(c) for c in colors], np.uint8)
    return Image.fromarray(table[np.floor(phase).astype(int) % len(colors)], "RGB")


def lettering(words: str, back: Color, ink: Color, size: tuple[int, int] = (96, 16), bold: float = 0.03) -> np.ndarray:
    """(h, w, 3) uint8 image of words on a plain background, of size = (w, h) pixels."""
    width, height = big = smooth(size, 3)
    image, pen = canvas(big, back)
    text(pen, words, (width * 0.04, height * 0.12, width * 0.96, height * 0.88), ink, bold)
    return np.asarray(shrunk(image, size))
