"""Combines the materials of a file to one texture: images side by side, plain colours as palette cells."""

import numpy as np
from PIL import Image

from ..meshes import atlas
from .reading import Part

REPEATS = 4  # an image that repeats more often over one face is replaced by its mean colour
CELLS = 48  # largest number of colours to which vertex colours are reduced
LARGEST = 256  # pixels, side of an image among several; halved until all fit


def bake(parts: tuple[Part, ...]) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """(vertices (V, 3), faces (F, 3), uv (V, 2), texture (H, W, 3) uint8) of all parts with one texture."""
    first = parts[0]
    if first.texture is not None and all(_equal_finish(p, first) for p in parts):
        starts = np.cumsum([0, *[len(p.vertices) for p in parts[:-1]]])
        faces = np.concatenate([p.faces + start for p, start in zip(parts, starts, strict=True)])
        uv = np.concatenate([p.uv for p in parts if p.uv is not None])
        return np.concatenate([p.vertices for p in parts]), faces, uv, _tinted(first, atlas.MAX_SIDE)
    side = LARGEST
    while True:
        try:
            return _pack(parts, side)
        except ValueError:
            if side < 8:  # hundreds of images are replaced by their mean colours
                return _pack(parts, 0)
            side //= 2


def _equal_finish(a: Part, b: Part) -> bool:
    same = a.texture is b.texture or (
        a.texture is not None and b.texture is not None and np.array_equal(a.texture, b.texture)
    )
    return same and a.color == b.color


def _tinted(part: Part, largest: int) -> np.ndarray:
    """The part's image times its colour, at most `largest` pixels wide and high."""
    assert part.texture is not None
    image = Image.fromarray(part.texture)
    image.thumbnail((largest, largest))
    return np.round(np.asarray(image) * (np.asarray(part.color) / 255.0)).astype(np.uint8)


def _pack(parts: tuple[Part, ...], side: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    colors: list[tuple[int, int, int]] = []
    textures: list[np.ndarray] = []
    plans = []
    for part in parts:
        vertices, faces, uv, repeats = _unwrapped(part)
        if part.texture is None or side == 0 or max(repeats) > REPEATS:
            cells, corner_cells = _cells(part)
            first = len(colors)
            colors += cells
            plans.append((*_split(part, corner_cells + first), None))
        else:
            shrunk = _tinted(part, max(side // max(repeats), 4))
            textures.append(np.tile(shrunk, (repeats[1], repeats[0], 1)))
            plans.append((vertices, faces, uv / np.array(repeats), len(textures) - 1))
    packed = atlas.pack(colors, textures)
    places = []
    for _, _, where, texture in plans:
        if texture is None:
            places.append(packed.cells[where])
        else:
            u0, v0, u1, v1 = packed.rectangles[texture]
            places.append(np.array([u0, v0]) + np.clip(where, 0, 1) * np.array([u1 - u0, v1 - v0]))
    starts = np.cumsum([0, *[len(plan[0]) for plan in plans[:-1]]])
    faces = np.concatenate([plan[1] + start for plan, start in zip(plans, starts, strict=True)])
    return np.concatenate([plan[0] for plan in plans]), faces, np.concatenate(places), packed.texture


def _unwrapped(part: Part) -> tuple[np.ndarray, np.ndarray, np.ndarray, tuple[int, int]]:
    """The part with every face moved to the first tile of its image, and the number of tiles that a face spans."""
    if part.uv is None:
        return part.vertices, part.faces, np.zeros((len(part.vertices), 2)), (1, 1)
    shift = np.floor(part.uv[part.faces].min(1) + 1e-4)  # (F, 2)
    keys = np.column_stack([part.faces.ravel(), np.repeat(shift, 3, axis=0)])
    rows, inverse = np.unique(keys, axis=0, return_inverse=True)
    index = rows[:, 0].astype(int)
    uv = part.uv[index] - rows[:, 1:]
    u, v = (max(int(np.ceil(x - 1e-3)), 1) for x in uv.max(0))
    return part.vertices[index], inverse.reshape(-1, 3), uv, (u, v)


def _cells(part: Part) -> tuple[list[tuple[int, int, int]], np.ndarray]:
    """(colours, (F,) number of the colour of each face)."""
    if part.colors is None:
        color = np.asarray(part.color)
        if part.texture is not None:
            color = color * part.texture.mean((0, 1)) / 255.0
        r, g, b = (round(float(c)) for c in color)
        return [(r, g, b)], np.zeros(len(part.faces), int)
    means = np.round(part.colors[part.faces].mean(1)).astype(np.uint8)
    reduced = Image.fromarray(means[None]).quantize(CELLS, dither=Image.Dither.NONE)
    table = np.array(reduced.getpalette(), int).reshape(-1, 3)
    used, numbers = np.unique(np.asarray(reduced)[0], return_inverse=True)
    return [tuple(int(c) for c in row) for row in table[used]], numbers  # pyright: ignore[reportReturnType]


def _split(part: Part, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(vertices, faces, cell of each vertex); a vertex between colours is duplicated."""
    keys = np.column_stack([part.faces.ravel(), np.repeat(cells, 3)])
    rows, inverse = np.unique(keys, axis=0, return_inverse=True)
    return part.vertices[rows[:, 0]], inverse.reshape(-1, 3), rows[:, 1]
