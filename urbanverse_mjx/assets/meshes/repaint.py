"""Gives the painted parts of a mesh other colours: the body of a car, the upper and lower clothes of a person."""

import dataclasses
from collections.abc import Sequence

import numpy as np

from urbanverse_mjx.datatypes import AssetMesh, AssetRecord

from . import palette
from .atlas import CELL
from .instances import KEY, pixels

#: Instead of a colour: the colours that the recipe gave, without an instance's tint.
OWN = "own"
#: Colours of what is not painted.
_BARE = frozenset(
    palette.NAMED[name]
    for name in (
        *("skin light", "skin medium", "skin dark", "glass", "dark glass", "lamp", "rubber", "aluminium", "galvanised"),
        *("mirror", "dark grey", "amber", "light red"),
    )
)
#: Share of the surface from which on a colour is a part of its own rather than a detail.
_LEAST = 0.1
#: Distance (0-255) within which a colour is a lighter or darker shade of another.
_SHADE = 10.0
#: Brightness over that of the part below which a grey is another material: the underside of a car has 0.55.
_DARKEST = 0.45


def untinted(record: AssetRecord) -> AssetRecord:
    """The record of the same shape and size in the colours of its recipe."""
    if KEY not in record.params:
        return record
    return dataclasses.replace(record, params={**record.params, KEY: {**record.params[KEY], "tint": [0.0, 1.0, 1.0]}})


def repainted(mesh: AssetMesh, colors: Sequence[str]) -> AssetMesh:
    """The mesh with its largest painted parts in other colours; shades of a part keep their relative brightness.

    Args:
      colors: "#rrggbb" of the largest part, then of the next one; those without a part are not used.
    """
    if not colors:
        return mesh
    corners = mesh.uv[mesh.faces]
    flat = (corners == corners[:, :1]).all((1, 2))
    if not flat.any():
        return mesh
    a, b, c = (mesh.vertices[mesh.faces[:, k]].astype(np.float64) for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    places, which = np.unique(pixels(mesh.texture, corners[flat, 0]), axis=0, return_inverse=True)
    share = np.bincount(which.ravel(), area[flat], len(places)) / area.sum()
    old = mesh.texture[places[:, 0], places[:, 1]].astype(np.float64)
    bare = np.array([tuple(int(x) for x in color) in _BARE for color in old])
    texture, left = mesh.texture.copy(), ~bare
    for color in colors:
        parts = np.flatnonzero(left & (share >= _LEAST))
        if not len(parts):
            break
        main = old[parts[int(share[parts].argmax())]]
        brightness = old @ main / max(float(main @ main), 1.0)
        shades = left & (np.linalg.norm(old - brightness[:, None] * main, axis=1) < _SHADE)
        shades &= (brightness > _DARKEST) & (brightness < 1.25)
        left &= ~shades
        for place, factor in zip(places[shades], brightness[shades], strict=True):
            top, start = place // CELL * CELL
            paint = np.clip(np.array(palette.rgb(color)) * min(float(factor), 1.0), 0, 255)
            texture[top : top + CELL, start : start + CELL] = np.round(paint)
    return dataclasses.replace(mesh, texture=texture)
