"""Instances: records that share a base shape, each with a scale along each axis and a tint.

A leaf's sizes are drawn from its prior; the base shape that fits best is scaled to them within the limits of its kind:

    scale = box / box of the base,  volume = volume of the base * product of the scale.

No axis is stretched by more than the leaf's `stretch` relative to another; if a distortion would be visible (people,
signs, wheels), the axes share one scale. Only + - * / and square roots are used.
"""

import dataclasses
import functools
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from urbanverse_mjx.datatypes import AssetMesh, HullSet, ValidationError

from ..categories import ontology
from ..categories.physical import SIZE_STEP, sample_uids, uniforms
from ..categories.priors import prior
from .atlas import CELL
from .tints import is_free, is_paint, tinted

Floats = NDArray[np.float64]
LONG, SHORT, UP = range(3)
#: Largest stretch of one axis relative to another. Freely shaped objects remain plausible up to a third; food and tools
#: have a known outline; the width of vehicles is limited by the lane.
STRETCH, STRETCH_KNOWN, STRETCH_ROLLING = 1.35, 1.15, 1.12
_KNOWN_MIDDLES = frozenset(
    {
        "food",
        "fruits",
        "vegetables",
        "drinks",
        "musical instruments",
        "weapons",
        "tools",
        "toys",
        "electrical appliances",
    }
)
_KNOWN_TOPS = frozenset({"vehicle"})
_RIGID_MIDDLES = frozenset({"traffic signs", "sports equipments", "animal", "person"})
# Base shapes whose misfit is within this ratio of the best one's rank equally; the uid selects among them. Shapes that
# are never stretched differ by pose (walking, standing), so their tolerance is larger.
_MISFIT_RATIO, _RIGID_MISFIT_RATIO = 1.15, 1.6
LEAST_PAINT = 0.02  # share of the surface below which a colour is a detail that is not tinted
#: Key of `AssetRecord.params` that makes a record an instance.
KEY = "instance"


@dataclasses.dataclass(frozen=True)
class Proportion:
    """Limits of the scaling of a leaf's shapes to a box.

    Attributes:
      stretch: largest stretch of one axis relative to another.
      tied: the axes (of LONG, SHORT, UP) that share one scale.
      anchor: the leaf's largest side, which matches the drawn size exactly if axes are tied.
    """

    stretch: float
    tied: tuple[int, ...]
    anchor: int


@functools.cache
def proportion(leaf: str) -> Proportion:
    """The rule of a leaf.

    Raises:
      UnknownLabelError: no such leaf.
    """
    row = prior(leaf)
    top, middle, _ = ontology.category_of(leaf)
    anchor = int(np.argmax([row.length[1], row.width[1], row.height[1]]))
    if row.rest == "alive" or row.section in ("ball", "wheel") or row.form == "ball" or middle in _RIGID_MIDDLES:
        return Proportion(1.0, (LONG, SHORT, UP), anchor)
    if row.rest in ("rolls", "parked") and row.front == "end":
        return Proportion(STRETCH_ROLLING, (LONG, UP), anchor)  # wheels stay round seen from the side
    stretch = STRETCH_KNOWN if middle in _KNOWN_MIDDLES or top in _KNOWN_TOPS else STRETCH
    tied = {"round": (LONG, SHORT), "lying": (SHORT, UP)}.get(row.section, ())
    return Proportion(stretch, tied, anchor)


@dataclasses.dataclass(frozen=True)
class Placed:
    """Instances of a leaf's base shapes.

    Attributes:
      base: (n,) index of the base shape.
      extent: (n, 3) m, box in the asset frame.
      scale: (n, 3) box over the base's box.
    """

    base: NDArray[np.int64]
    extent: Floats
    scale: Floats


def place(leaf: str, uids: Sequence[str], extents: Floats) -> Placed:
    """Chooses base shapes and scales for records of a leaf.

    Args:
      leaf: exact leaf name.
      uids: n of them.
      extents: (b, 3) m, boxes of the leaf's base shapes, at least one.

    Raises:
      UnknownLabelError: no such leaf.
      ValidationError: no base shape.
    """
    extents = np.asarray(extents, dtype=np.float64)
    if len(extents) == 0:
        raise ValidationError(
            f"instances of {leaf!r}: found no base shape, needed at least one; write a recipe for it."
        )
    drawn = sample_uids(leaf, uids)
    wanted = np.stack([drawn.length, drawn.width, drawn.height], axis=1)
    # The base's longer horizontal side is the length, whatever the direction of its front.
    lies_across = extents[:, 1] > extents[:, 0]
    sides = np.where(lies_across[:, None], extents[:, [1, 0, 2]], extents)  # (b, 3) as LONG, SHORT, UP
    rule = proportion(leaf)
    scale = _scales(rule, wanted[:, None] / sides)  # (n, b, 3)
    miss = wanted[:, None] / (sides * scale)
    cost = np.maximum(miss, 1.0 / miss).prod(-1)
    good = cost <= (_RIGID_MISFIT_RATIO if rule.stretch == 1.0 else _MISFIT_RATIO) * cost.min(1, keepdims=True)
    draw = uniforms([f"{uid}#shape" for uid in uids])[:, 0]
    turn = np.floor(draw * good.sum(1)).astype(np.int64)  # the turn-th of the good ones
    base = (good & (good.cumsum(1) == turn[:, None] + 1)).argmax(1)
    chosen = scale[np.arange(len(uids)), base]
    chosen = np.where(lies_across[base][:, None], chosen[:, [1, 0, 2]], chosen)
    extent = np.maximum(np.floor(extents[base] * chosen / SIZE_STEP + 0.5), 1.0) * SIZE_STEP
    extent = np.floor(extent * 1e4 + 0.5) / 1e4  # the decimal nearest to it, as `physical` rounds
    return Placed(base, extent, extent / extents[base])


def _scales(rule: Proportion, ratio: Floats) -> Floats:
    """(..., 3) scales for (..., 3) ratios of drawn to base sizes, by the rule.

    With tied axes, the anchor's size is matched exactly and the other one as far as the stretch allows; with three free
    axes that would exceed the stretch, the error is distributed evenly.
    """
    ratio = ratio.copy()
    if rule.tied:
        lead = rule.anchor if rule.anchor in rule.tied else rule.tied[0]
        ratio[..., list(rule.tied)] = ratio[..., lead : lead + 1]
        anchor = ratio[..., rule.anchor : rule.anchor + 1]
        return np.clip(ratio, anchor / rule.stretch, anchor * rule.stretch)
    middle = np.sqrt(ratio.min(-1, keepdims=True) * ratio.max(-1, keepdims=True))
    slack = np.sqrt(rule.stretch)
    return np.clip(ratio, middle / slack, middle * slack)


def instance_params(variant: int, base: str, scale: Sequence[float], tint: Sequence[float]) -> dict[str, Any]:
    """The `params` of a record that is an instance of a recipe's variant."""
    inner = {"base": base, "scale": [round(float(s), 7) for s in scale], "tint": [round(float(t), 3) for t in tint]}
    return {"variant": variant, KEY: inner}


def scaled_mesh(mesh: AssetMesh, scale: Sequence[float], tint: Sequence[float] | None, leaf: str) -> AssetMesh:
    """Scales and tints a base mesh for an instance; images (faces of signs, shop fronts) keep their colours."""
    factor = np.asarray(scale, dtype=np.float64)
    texture = mesh.texture if tint is None else tinted_texture(mesh, np.asarray(tint), is_free(leaf))
    return dataclasses.replace(mesh, vertices=mesh.vertices.astype(np.float64) * factor, texture=texture)


def scaled_hulls(hulls: HullSet, scale: Sequence[float]) -> HullSet:
    """Hulls scaled along the axes, which keeps them convex."""
    factor = np.asarray(scale, dtype=np.float32)
    return HullSet(tuple(h * factor for h in hulls.hulls))


def tinted_texture(mesh: AssetMesh, tint: Floats, free: bool) -> NDArray[np.uint8]:
    """(H, W, 3) texture with tinted palette cells.

    A palette cell is the colour of triangles whose three corners share one texture point.
    """
    texture, cells = mesh.texture.copy(), palette_cells(mesh)
    shifted = np.floor(tinted(cells.colors, tint, free, cells.paint) + 0.5).astype(np.uint8)
    for (row, column), color in zip(cells.places, shifted, strict=True):
        top, left = row // CELL * CELL, column // CELL * CELL
        texture[top : top + CELL, left : left + CELL] = color
    return texture


@dataclasses.dataclass(frozen=True)
class PaletteCells:
    """The palette cells of a mesh's texture: (C, 2) row and column, (C, 3) colours, (C,) which are paint."""

    places: NDArray[np.int64]
    colors: NDArray[np.uint8]
    paint: NDArray[np.bool_]


def palette_cells(mesh: AssetMesh) -> PaletteCells:
    """The palette cells in use. Paint is a colour other than the material's own (`tints.is_paint`) on at least 2 % of
    the surface, so that a tail light or a button is not tinted."""
    corners = mesh.uv[mesh.faces]
    flat = (corners == corners[:, :1]).all((1, 2))
    if not flat.any():
        return PaletteCells(np.zeros((0, 2), np.int64), np.zeros((0, 3), np.uint8), np.zeros(0, bool))
    a, b, c = (mesh.vertices[mesh.faces[:, k]].astype(np.float64) for k in range(3))
    area = np.sqrt((np.cross(b - a, c - a) ** 2).sum(1))
    places, which = np.unique(pixels(mesh.texture, corners[flat, 0]), axis=0, return_inverse=True)
    share = np.bincount(which.ravel(), area[flat], len(places)) / area.sum()
    colors = mesh.texture[places[:, 0], places[:, 1]]
    return PaletteCells(places, colors, is_paint(colors) & (share >= LEAST_PAINT))


def pixels(texture: NDArray, uv: NDArray) -> NDArray[np.int64]:
    """(n, 2) row and column of texture points."""
    height, width = texture.shape[:2]
    column = np.clip(np.floor(uv[:, 0].astype(np.float64) * width), 0, width - 1)
    row = np.clip(np.floor((1.0 - uv[:, 1].astype(np.float64)) * height), 0, height - 1)
    return np.stack([row, column], axis=1).astype(np.int64)
