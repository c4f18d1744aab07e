"""The image of `benchmarks.realism`: a panel per measure with a dot per scene, published values as bands."""

import pathlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from urbanverse_mjx.datatypes.validation import write_atomically

PANEL, COLUMNS, MARGIN = (470, 330), 4, 16
_PLOT = (52, 34, 14, 58)  # left, top, right, bottom of a panel's axes, pixels
_INK, _FAINT, _BAND = (34, 38, 43), (205, 203, 196), (250, 226, 180)
_COLOURS = ((40, 96, 190), (214, 66, 40), (32, 140, 90), (150, 60, 160), (200, 130, 20), (20, 150, 170))
_DIVERSITY = {
    "cousin_objects": "cousins: what",
    "cousin_assets": "cousins: which",
    "layout_objects": "layouts: what",
    "layout_assets": "layouts: which",
}
_ROWS = 4  # ticks of an axis


def draw(measured: Mapping[str, Any], names: Mapping[str, str], path: pathlib.Path) -> None:
    """Writes the figure of the results of `realism.measure`; `names`: measure -> its panel's title."""
    panels = len(names) + 2
    rows = -(-panels // COLUMNS)
    size = COLUMNS * PANEL[0] + 2 * MARGIN, rows * PANEL[1] + 2 * MARGIN
    image = Image.new("RGB", size, "white")
    pen = ImageDraw.Draw(image)
    families = measured["families"]
    for k, (key, title) in enumerate(names.items()):
        values = [families[f]["values"][key] for f in families]
        _scatter(pen, _corner(k), title, values, measured["published"].get(key, []))
    _bars(pen, _corner(len(names)), families)
    _legend(pen, _corner(len(names) + 1), measured)
    write_atomically(path, lambda temporary: image.save(temporary, "PNG", optimize=True))


def _corner(k: int) -> tuple[int, int]:
    return MARGIN + (k % COLUMNS) * PANEL[0], MARGIN + (k // COLUMNS) * PANEL[1]


def _text(pen: ImageDraw.ImageDraw, at: tuple[float, float], words: str, size: int = 13, colour: Any = _INK) -> None:
    pen.text(at, words, fill=colour, font=ImageFont.load_default(size))


def _axes(pen: ImageDraw.ImageDraw, corner: tuple[int, int], title: str, top: float) -> tuple[int, int, int, int]:
    """Draws a panel's frame and ticks from 0 to `top`; its plot's left, top, right and bottom."""
    x, y = corner
    left, up, right, down = _PLOT
    box = x + left, y + up, x + PANEL[0] - right, y + PANEL[1] - down
    _text(pen, (x + 8, y + 8), title, 15)
    for k in range(_ROWS + 1):
        value = top * k / _ROWS
        level = box[3] - (box[3] - box[1]) * k / _ROWS
        pen.line((box[0], level, box[2], level), fill=_FAINT)
        _text(pen, (x + 8, level - 8), f"{value:.3g}")
    return box


def _scatter(
    pen: ImageDraw.ImageDraw,
    corner: tuple[int, int],
    title: str,
    values: Sequence[Sequence[float]],
    published: Sequence[Mapping[str, Any]],
) -> None:
    """A column of dots per family with a line at its median; published ranges across, named below."""
    known = [np.array([v for v in family if np.isfinite(v)]) for family in values]
    highest = max([v.max(initial=0.0) for v in known] + [p["high"] for p in published])
    top = float(_round_up(max(highest * 1.05, 1e-3)))
    box = _axes(pen, corner, title, top)
    height = box[3] - box[1]
    for p in published:
        high, low = (box[3] - height * p[k] / top for k in ("high", "low"))
        pen.rectangle((box[0], high - 1, box[2], low + 1), fill=_BAND)
        pen.line((box[0], high, box[2], high), fill=(214, 150, 40), width=2)
        pen.line((box[0], low, box[2], low), fill=(214, 150, 40), width=2)
    for k, family in enumerate(known):
        middle = box[0] + (box[2] - box[0]) * (k + 0.5) / len(known)
        reach = (box[2] - box[0]) / len(known) * 0.32
        # Scenes are spread horizontally by value, so that dots do not overlap.
        spread = np.linspace(-reach, reach, len(family)) if len(family) > 1 else np.zeros(len(family))
        colour = _COLOURS[k % len(_COLOURS)]
        for dx, value in zip(spread, np.sort(family), strict=True):
            cx, cy = middle + dx, box[3] - height * value / top
            pen.ellipse((cx - 3, cy - 3, cx + 3, cy + 3), fill=colour)
        if len(family):
            level = box[3] - height * float(np.median(family)) / top
            pen.line((middle - reach - 8, level, middle + reach + 8, level), fill=_INK, width=2)
    notes = [p["what"] for p in published] or ["no page found gives it for real streets"]
    for row, note in enumerate(notes[:2]):
        _text(pen, (box[0], box[3] + 8 + 18 * row), f"{'band: ' if published else ''}{note}", 13, (150, 100, 20))


def _bars(pen: ImageDraw.ImageDraw, corner: tuple[int, int], families: Mapping[str, Any]) -> None:
    """Diversity: bars for what differs between cousins and between layouts."""
    box = _axes(pen, corner, "how much scenes differ (Bray-Curtis distance)", 1.0)
    group = (box[2] - box[0]) / len(_DIVERSITY)
    for g, (key, label) in enumerate(_DIVERSITY.items()):
        width = group * 0.8 / max(1, len(families))
        for k, family in enumerate(families.values()):
            value = family["diversity"].get(key)
            x = box[0] + g * group + group * 0.1 + k * width
            if value is not None:
                level = box[3] - (box[3] - box[1]) * value
                pen.rectangle((x, level, x + width - 2, box[3]), fill=_COLOURS[k % len(_COLOURS)])
        _text(pen, (box[0] + g * group + 4, box[3] + 8), label, 13)
    _text(pen, (box[0], box[3] + 28), "what: counts of categories; which: counts of assets", 13, (91, 97, 106))


def _legend(pen: ImageDraw.ImageDraw, corner: tuple[int, int], measured: Mapping[str, Any]) -> None:
    x, y = corner
    _text(pen, (x + 20, y + 12), "families (scenes of layouts)", 15)
    for k, (name, family) in enumerate(measured["families"].items()):
        level = y + 44 + 24 * k
        pen.ellipse((x + 22, level, x + 34, level + 12), fill=_COLOURS[k % len(_COLOURS)])
        _text(pen, (x + 44, level - 3), f"{name}: {family['scenes']} of {family['layouts']}", 15)
    level = y + 56 + 24 * len(measured["families"])
    for line in ("a dot is a scene, sorted; the line is the median", "bands: published for real streets (or kerbs)"):
        _text(pen, (x + 20, level), line, 13, (91, 97, 106))
        level += 20


def _round_up(value: float) -> float:
    """The next of 1, 1.2, 1.6, 2, 3, 4, 6, 8 times a power of ten."""
    power = 10.0 ** np.floor(np.log10(value))
    return next((m * power for m in (1, 1.2, 1.6, 2, 3, 4, 6, 8, 10) if m * power >= value - 1e-12), 10 * power)
