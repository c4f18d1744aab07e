"""How high the ground is anywhere in a scene, from the bank's prisms: for critics, rewards and first poses.

It is not an observation of a blind policy.
"""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from ..datatypes import SceneBank
from ..geometry.grids import Grid, cell_of

#: m, side of a cell; a kerb's edge is known to half of it.
CELL = 0.05
_VERTICAL_TOLERANCE = 1e-6


def _paint(heights: np.ndarray, planes: np.ndarray, low: np.ndarray, high: np.ndarray, origin: np.ndarray) -> None:
    """Raises the cells of heights (X, Y) in a prism's box low..high (2,) to its top; planes (F, 4)."""
    grid = Grid(origin, CELL, heights.shape)
    window = grid.window(low, high)
    points = np.stack(np.meshgrid(*grid.axes(window), indexing="ij"), -1)
    rest = planes[:, 3] - points @ planes[:, :2].T
    up = planes[:, 2] > _VERTICAL_TOLERANCE
    side = np.abs(planes[:, 2]) <= _VERTICAL_TOLERANCE
    top = (rest[..., up] / planes[up, 2]).min(-1)
    inside = (rest[..., side] >= -1e-6).all(-1)
    part = heights[window]
    np.copyto(part, np.maximum(part, top), where=inside)


def build_heights(bank: SceneBank) -> tuple[Float[np.ndarray, "Z X Y"], Float[np.ndarray, "Z 2"]]:
    """(Z, X, Y) f32 m of the ground's top at each cell's centre, and (Z, 2) m, where cell (0, 0) begins.

    Beside the ground it is as high as the scene's lowest ground.
    """
    boxes = bank.hull_box.astype(np.float64)
    corners = []
    for z in range(bank.num_scenes):
        there = bank.prism_hull[z] >= 0
        hull, position = bank.prism_hull[z, there], bank.prism_position[z, there].astype(np.float64)
        middle, half = boxes[hull, 0] + position, boxes[hull, 1]
        corners.append((hull, position, middle - half, middle + half))
    origins = np.array([low.min(0)[:2] for _, _, low, _ in corners])
    size = np.max([high.max(0)[:2] - low.min(0)[:2] for _, _, low, high in corners], 0)
    heights = np.full((bank.num_scenes, *np.ceil(size / CELL).astype(int)), -np.inf)
    for z, (hulls, positions, lows, highs) in enumerate(corners):
        for hull, position, low, high in zip(hulls, positions, lows, highs, strict=True):
            planes = bank.hull_planes[hull].astype(np.float64)
            planes[:, 3] += planes[:, :3] @ position
            _paint(heights[z], planes, low[:2], high[:2], origins[z])
        known = np.isfinite(heights[z])
        heights[z][~known] = heights[z][known].min()
    return heights.astype(np.float32), origins.astype(np.float32)


class GroundHeights:
    """The ground's height in all scenes of a bank.

    Attributes:
      low, high: (Z, 2) m, the corners of each scene's ground.
    """

    def __init__(self, bank: SceneBank) -> None:
        heights, low = build_heights(bank)
        self._heights, self.low = jnp.asarray(heights), jnp.asarray(low)
        boxes = bank.prism_position + bank.hull_box[bank.prism_hull, 0] + bank.hull_box[bank.prism_hull, 1]
        self.high = jnp.asarray(np.where(bank.prism_hull[..., None] >= 0, boxes, -np.inf).max(1)[:, :2])

    def __call__(self, scene: Int[Array, ""], p_xy: Float[Array, "*n 2"]) -> Float[Array, "*n"]:
        """(...) m under points (..., 2) m of a scene () i32; at the rim for points outside."""
        cell = cell_of(p_xy, self.low[scene], CELL, self._heights.shape[1:])
        return self._heights[scene, cell[..., 0], cell[..., 1]]
