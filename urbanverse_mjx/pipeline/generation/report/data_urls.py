"""Images and videos as texts inside a page, which then needs no other file."""

import base64
import io
from typing import Any

import numpy as np
from PIL import Image

_QUALITY = 85


def of_bytes(body: bytes, kind: str) -> str:
    """A data address; kind: MIME type."""
    return f"data:{kind};base64,{base64.b64encode(body).decode()}"


def jpeg(image: np.ndarray | Image.Image, longest: int | None = None) -> str:
    """A JPEG's data address of (H, W, 3) uint8; longest: pixels of its longer side, None for its own."""
    return of_bytes(_encoded(image, longest, "JPEG", quality=_QUALITY, optimize=True), "image/jpeg")


def png(image: np.ndarray) -> str:
    """A PNG's data address of (H, W, 4) uint8."""
    return of_bytes(_encoded(image, None, "PNG", optimize=True), "image/png")


def _encoded(image: np.ndarray | Image.Image, longest: int | None, form: str, **options: Any) -> bytes:
    shown = Image.fromarray(image) if isinstance(image, np.ndarray) else image
    if longest is not None:
        shown = shown.copy()
        shown.thumbnail((longest, longest))
    body = io.BytesIO()
    shown.save(body, form, **options)
    return body.getvalue()
