"""Packs one small texture for an asset: palette cells along the top, images below."""

import dataclasses

import numpy as np

CELL = 8  # pixels; UV coordinates are at the cell's centre, which avoids bleeding
GUTTER = 2  # pixels of repeated border around an image, against bleeding under bilinear filtering
MAX_SIDE = 512


@dataclasses.dataclass(frozen=True)
class Atlas:
    """A packed texture.

    Attributes:
      texture: (H, W, 3) uint8, row 0 is the top.
      cells: (C, 2) UV of each colour's cell centre.
      rectangles: per image (u0, v0, u1, v1), lower left and upper right corner.
    """

    texture: np.ndarray
    cells: np.ndarray
    rectangles: list[tuple[float, float, float, float]]


def pack(colors: list[tuple[int, int, int]], images: list[np.ndarray]) -> Atlas:
    """Packs colours and (h, w, 3) uint8 images into the smallest power-of-two texture up to 512x512.

    Raises:
      ValueError: the images do not fit.
    """
    sides = [2**k for k in range(4, 10)]
    shapes = sorted(
        (w * h, max(w, h), w, h) for w in sides for h in sides if max(w, h) <= 4 * min(w, h) and max(w, h) <= MAX_SIDE
    )
    for _, _, width, height in shapes:
        places = _shelves(len(colors), [p.shape[:2] for p in images], width, height)
        if places is not None:
            return _paint(colors, images, places, width, height)
    sizes = ", ".join(f"{p.shape[1]}x{p.shape[0]}" for p in images)
    raise ValueError(
        f"atlas: found {len(colors)} colours and images of {sizes}, needed what fits in 512x512; draw them smaller."
    )


def _shelves(colors: int, sizes: list[tuple[int, ...]], width: int, height: int) -> list[tuple[int, int]] | None:
    """Top left pixel of each image (without its gutter), or None if they do not fit."""
    per_row = width // CELL
    top = -(-colors // per_row) * CELL
    if top > height:
        return None
    places: list[tuple[int, int]] = [(0, 0)] * len(sizes)
    x, y, shelf = 0, top, 0
    for index in sorted(range(len(sizes)), key=lambda i: (-sizes[i][0], -sizes[i][1], i)):
        h, w = sizes[index][0] + 2 * GUTTER, sizes[index][1] + 2 * GUTTER
        if x + w > width:
            x, y, shelf = 0, y + shelf, 0
        if x + w > width or y + h > height:
            return None
        places[index] = (x + GUTTER, y + GUTTER)
        x, shelf = x + w, max(shelf, h)
    return places


def _paint(
    colors: list[tuple[int, int, int]],
    images: list[np.ndarray],
    places: list[tuple[int, int]],
    width: int,
    height: int,
) -> Atlas:
    texture = np.full((height, width, 3), 128, np.uint8)
    per_row = width // CELL
    cells = np.zeros((len(colors), 2))
    for i, color in enumerate(colors):
        x, y = (i % per_row) * CELL, (i // per_row) * CELL
        texture[y : y + CELL, x : x + CELL] = color
        cells[i] = (x + CELL / 2) / width, 1 - (y + CELL / 2) / height
    rectangles = []
    for image, (x, y) in zip(images, places, strict=True):
        h, w = image.shape[:2]
        padded = np.pad(image, ((GUTTER, GUTTER), (GUTTER, GUTTER), (0, 0)), mode="edge")
        texture[y - GUTTER : y + h + GUTTER, x - GUTTER : x + w + GUTTER] = padded
        rectangles.append((x / width, 1 - (y + h) / height, (x + w) / width, 1 - y / height))
    return Atlas(texture, cells, rectangles)
