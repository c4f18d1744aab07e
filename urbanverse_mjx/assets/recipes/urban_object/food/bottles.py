"""Bottles, cans, cartons and flacons: lathed or blocky vessels with caps and labels; label to the front (+x)."""

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np

from urbanverse_mjx.datatypes.toml_table import table

from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, rgb, shade
from ....meshes.recipe import recipe
from ....meshes.shapes import Point2, Point3, lathe
from ...shared.forms import painted
from ...shared.sizes import varied_cm
from ...shared.skins import label, patch


@dataclasses.dataclass(frozen=True)
class Bottle:
    """Appearance of a round bottle.

    Attributes:
      profile: (radius, z) of the body, cm.
      color: of the body.
      fill: of what shows inside above the body's own colour, from the ground to `level`.
      cap: colour, radius, height.
      paper: words, ground, ink of the label.
      band: its heights from and to.
      neck: colour and lower edge of a capsule round the neck.
    """

    profile: Sequence[Point2]
    color: Color
    cap: tuple[Color, float, float]
    paper: tuple[str, Color, Color] | None = None
    band: tuple[float, float] = (6.0, 13.0)
    arc_deg: float = 170.0
    neck: tuple[Color, float] | None = None
    fill: tuple[Color, float] | None = None


def radius_at(profile: Sequence[Point2], z: float) -> float:
    return float(np.interp(z, [p[1] for p in profile], [p[0] for p in profile]))


def tinted(color: Color, fill: tuple[Color, float] | None, top: float) -> np.ndarray:
    """A skin for glass with something in it up to a level, light on its shoulder."""
    image = np.empty((48, 16, 3))
    heights = (np.arange(48)[::-1] + 0.5) / 48 * top
    for row, z in enumerate(heights):
        image[row] = rgb(fill[0]) if fill and z < fill[1] else rgb(color)
    glint = 1.0 + 0.25 * np.exp(-(((np.arange(16) - 5) / 1.2) ** 2))
    return np.clip(image * glint[None, :, None], 0, 255).astype(np.uint8)


def round_bottle(b: MeshBuilder, it: Bottle) -> None:
    top = it.profile[-1][1]
    body = lathe([(0.0, 0.0), *it.profile, (0.0, top)], 24)
    b.add(painted(body), image=tinted(it.color, it.fill, top))
    color, radius, height = it.cap
    b.cylinder(radius, height, (0, 0, top - 0.15), color, segments=20)
    b.ring(radius_at(it.profile, top - 0.9) + 0.05, 0.16, (0, 0, top - 0.9), shade(it.color, 0.9), segments=20, sides=5)
    if it.neck:
        around = [(radius_at(it.profile, z) + 0.07, z) for z in np.linspace(it.neck[1], top + 0.05, 5)]
        b.lathe(around, color=it.neck[0], segments=20)
    if it.paper:
        words, ground, ink = it.paper
        low, high = it.band
        image = label(words, ground, ink, (64, 48), band=ink)
        patch(b, image, radius_at(it.profile, (low + high) / 2) + 0.07, low, high, it.arc_deg)


_TABLE = table(__file__)


def _kind(name: str, size: Point3, profile: str | Sequence[Point2], **row: Any) -> tuple[str, Bottle, Point3]:
    return name, Bottle(_TABLE["profiles"][profile] if isinstance(profile, str) else profile, **row), size


BOTTLES = {leaf: tuple(_kind(**row) for row in rows) for leaf, rows in _TABLE["kinds"].items()}


def register(leaf: str) -> None:
    """Registers the round bottles of a leaf without other recipes."""
    kinds = BOTTLES[leaf]

    def build(variant: int, rng: np.random.Generator) -> BuiltAsset:
        name, bottle, size = kinds[variant % len(kinds)]
        b = MeshBuilder(roughness=0.25)
        round_bottle(b, bottle)
        return varied_cm(b, f"a {name}", size, rng, {"style": name})

    recipe(leaf, len(kinds), name=f"bottles.round_{leaf.replace(' ', '_')}")(build)


for _leaf in ("bottle", "wine", "bottled water"):
    register(_leaf)


@recipe("beer", 3, name="bottles.beer")
def beer(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A bottle of lager, a can, a mug with its handle and froth."""
    b = MeshBuilder(roughness=0.25)
    if variant % 3 < 2:
        name, bottle, size = BOTTLES["beer"][variant % 3]
        round_bottle(b, bottle)
        return varied_cm(b, f"a {name}", size, rng, {"style": name})
    b.lathe([(0, 0), (4.2, 0), (4.4, 0.6), (4.4, 12.4), (0, 12.4)], color="#e0a02e", segments=20)
    for k in range(10):
        with b.frame(turn_deg=(0, 0, 36 * k)):
            b.box((0.5, 1.6, 9), (4.25, 0, 1.8), "#eab653", bevel=0.2)
    b.lathe(
        [(4.6, 11.2), (4.7, 12.5), (4.5, 13.8), (3.2, 14.9), (0, 15.3)], color="#fbf6e6", segments=20, crease_deg=70
    )
    for k, y in enumerate((-2.6, 0.2, 2.4)):
        b.ball(1.7, (0.8 * (-1) ** k, y, 14.3), "#fbf6e6", segments=10, rings=6)
    b.tube([(0, 4.2, 2), (0, 7.2, 2.6), (0, 7.8, 6), (0, 7.2, 10), (0, 4.2, 10.8)], 0.65, "#d9e4e6", sides=8)
    b.cylinder(4.5, 0.8, (0, 0, -0.6), "#d9e4e6", segments=20)
    return varied_cm(b, "a mug of beer", (9.4, 13.4, 16), rng, {"style": "mug"})
