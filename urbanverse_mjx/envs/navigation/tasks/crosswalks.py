"""The crosswalks of scenes as rectangles: which one a point is on, and how far others are.

In:   maps of a bank's scenes. Out: `Crosswalks`, a table on the device. When: the table once per bank, on the host;
look-ups every control step, inside jit, per env.
"""

import dataclasses
from collections.abc import Callable, Sequence
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, UInt8
from scipy import ndimage

from ....crowds.crossings import Crossings, crossing_at
from ....datatypes import KIND_INDEX, SceneBank

#: m², smaller pieces are remains of drawing.
MIN_AREA = 4.0
#: Number of directions in a quarter turn among which the smallest rectangle is found.
_DIRECTIONS = 90


@dataclasses.dataclass(frozen=True)
class Rectangle:
    """One crosswalk on the host.

    Attributes:
      centre: (2,) m.
      axis: (2,) unit vector along its longer side.
      half: (2,) m, half its sizes along that side and across.
    """

    centre: np.ndarray
    axis: np.ndarray
    half: np.ndarray

    def holds(self, points: np.ndarray, margin: float = 0.0) -> np.ndarray:
        """(...) bool, which points (..., 2) m are on it or within a margin (m) of each side."""
        away = points - self.centre
        along = away @ self.axis
        across = away[..., 1] * self.axis[0] - away[..., 0] * self.axis[1]
        return (np.abs(along) <= self.half[0] + margin) & (np.abs(across) <= self.half[1] + margin)


def rectangles(bank: SceneBank, scene: int) -> list[Rectangle]:
    """The smallest rectangles around the crosswalks of a scene, in the order of `scipy.ndimage.label`."""
    side, origin = float(bank.map_resolution), np.asarray(bank.map_origin[scene], np.float64)
    label, count = ndimage.label(bank.map_kind[scene] == KIND_INDEX["crosswalk"], np.ones((3, 3)))
    boxes, found = ndimage.find_objects(label), []
    for number in range(1, count + 1):
        first = np.array([part.start for part in boxes[number - 1]])
        cells = np.argwhere(label[boxes[number - 1]] == number) + first
        if len(cells) * side**2 >= MIN_AREA:
            found.append(_smallest(origin + (cells + 0.5) * side, side))
    return found


def _smallest(points: np.ndarray, side: float) -> Rectangle:
    """The smallest rectangle around squares of a side (m) at points (n, 2) m."""
    angle = np.arange(_DIRECTIONS) * (0.5 * np.pi / _DIRECTIONS)
    axes = np.stack([np.cos(angle), np.sin(angle)], -1)
    across = np.stack([-axes[:, 1], axes[:, 0]], -1)
    places = [points @ axis.T for axis in (axes, across)]
    low, high = (np.stack([f(p, axis=0) for p in places], -1) for f in (np.min, np.max))
    best = int(np.argmin(np.prod(high - low + side, axis=-1).round(6)))
    middle, half = 0.5 * (low[best] + high[best]), 0.5 * (high[best] - low[best] + side)
    centre = middle[0] * axes[best] + middle[1] * across[best]
    if half[0] >= half[1]:
        return Rectangle(centre, axes[best], half)
    return Rectangle(centre, across[best], half[::-1])


class Crosswalks(NamedTuple):
    """The crosswalks of all scenes, padded to the largest number C.

    Attributes:
      centre, axis, half: (Z, C, 2), see `Rectangle`.
      exists: (Z, C) bool.
      number: (Z, C) i32, the crosswalk of `crossings.Crossings` at its place; 0 without a crowd.
    """

    centre: Float[Array, "Z C 2"]
    axis: Float[Array, "Z C 2"]
    half: Float[Array, "Z C 2"]
    exists: Bool[Array, "Z C"]
    number: Int[Array, "Z C"]

    @staticmethod
    def of(
        bank: SceneBank, scenes: Sequence[int], crossings: Crossings | None, row_of: Callable[[int], int] = int
    ) -> "Crosswalks":
        """The table of some scenes of a bank; rows of others are empty.

        Args:
          row_of: function from a scene to its row in `crossings`; the scene's number by default.
        """
        found = {z: rectangles(bank, z) for z in scenes}
        most = max([1, *map(len, found.values())])
        fields = np.zeros((3, bank.num_scenes, most, 2), np.float32)
        exists, number = np.zeros((bank.num_scenes, most), bool), np.zeros((bank.num_scenes, most), np.int32)
        for z, rows in found.items():
            for c, row in enumerate(rows):
                fields[:, z, c] = row.centre, row.axis, row.half
                exists[z, c] = True
                number[z, c] = 0 if crossings is None else _number(crossings, row_of(z), row)
        return Crosswalks(*(jnp.asarray(x) for x in (*fields, exists, number)))

    def away(self, scene: Int[Array, ""], p_xy: Float[Array, "*n 2"]) -> Float[Array, "*n C"]:
        """(..., C) m from points (..., 2) m to each crosswalk, 0 on it; infinite for rows without one."""
        beside = p_xy[..., None, :] - self.centre[scene]
        axis, half = self.axis[scene], self.half[scene]
        along = (beside * axis).sum(-1)
        across = beside[..., 1] * axis[:, 0] - beside[..., 0] * axis[:, 1]
        out = jnp.maximum(jnp.abs(jnp.stack([along, across], -1)) - half, 0.0)
        return jnp.where(self.exists[scene], jnp.sqrt((out * out).sum(-1)), jnp.inf)


def _number(crossings: Crossings, scene: int, row: Rectangle) -> int:
    """The most frequent number of the table on a crosswalk; 0 if there is none."""
    share = np.linspace(-0.8, 0.8, 9)
    left = np.array([-row.axis[1], row.axis[0]])
    a, b = (s.ravel() for s in np.meshgrid(share * row.half[0], share * row.half[1]))
    points = row.centre + a[:, None] * row.axis + b[:, None] * left
    found: UInt8[np.ndarray, " n"] = np.asarray(
        crossing_at(crossings, scene, jnp.asarray(points[:, 0], jnp.float32), jnp.asarray(points[:, 1], jnp.float32))
    )
    found = found[found > 0]
    return int(np.bincount(found).argmax()) if len(found) else 0
