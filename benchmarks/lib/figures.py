"""Figures of the documentation."""

import io
import pathlib
from typing import Any

from PIL import Image

from urbanverse_mjx.datatypes import validation as v

#: Colours of a stored figure: those of lines and text with their blends into the background.
COLOURS = 128


def save_figure(figure: Any, path: pathlib.Path, dpi: int) -> None:
    """Writes a figure of Matplotlib as PNG with a palette, which takes half the bytes of one in full colour."""
    body = io.BytesIO()
    figure.savefig(body, dpi=dpi, format="png")
    with Image.open(body) as drawn:
        image = drawn.convert("RGB").quantize(COLOURS, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    v.write_atomically(path, lambda p: image.save(p, "PNG", optimize=True))
