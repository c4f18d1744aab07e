"""Ground height at any point of a scene, from the bank's prisms; used by critics, rewards and initial poses.

It is not an observation of a blind policy.
"""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int, UInt16

from ..datatypes import SceneBank, ValidationError
from ..geometry.grids import Grid, cell_of

#: m, default side of a cell; the position of a kerb's edge is accurate to half of it.
CELL = 0.05
#: m, unit of the stored heights, which are relative to the lowest ground of the scene.
UNIT = 0.001
_VERTICAL_TOLERANCE = 1e-6


def _paint(heights: np.ndarray, planes: np.ndarray, low: np.ndarray, high: np.ndarray, grid: Grid) -> None:
    """Raises the cells of heights (X, Y) in a prism's box low..high (2,) to its top; planes (F, 4)."""
    window = grid.window(low, high)
    points = np.stack(np.meshgrid(*grid.axes(window), indexing="ij"), -1)
    rest = planes[:, 3] - points @ planes[:, :2].T
    up = planes[:, 2] > _VERTICAL_TOLERANCE
    side = np.abs(planes[:, 2]) <= _VERTICAL_TOLERANCE
    top = (rest[..., up] / planes[up, 2]).min(-1)
    inside = (rest[..., side] >= -1e-6).all(-1)
    part = heights[window]
    np.copyto(part, np.maximum(part, top), where=inside)


def build_heights(
    bank: SceneBank, cell: float = CELL
) -> tuple[UInt16[np.ndarray, "Z X Y"], Float[np.ndarray, " Z"], Float[np.ndarray, "Z 2"]]:
    """Computes the height of the ground at the centre of each cell.

    Args:
      cell: m, side of a cell.

    Returns:
      (Z, X, Y) u16 in `UNIT` above the scene's lowest ground, 0 in cells without ground; (Z,) f32 m, height of that
      lowest ground; (Z, 2) f32 m, lower corner of cell (0, 0).

    Raises:
      ValidationError: the heights of a scene differ by more than 65 m.
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
    rows, columns = (int(x) for x in np.ceil(size / cell))
    stored, lowest = np.zeros((bank.num_scenes, rows, columns), np.uint16), np.zeros(bank.num_scenes)
    for z, (hulls, positions, lows, highs) in enumerate(corners):
        heights = np.full((rows, columns), -np.inf)
        grid = Grid(origins[z], cell, (rows, columns))
        for hull, position, low, high in zip(hulls, positions, lows, highs, strict=True):
            planes = bank.hull_planes[hull].astype(np.float64)
            planes[:, 3] += planes[:, :3] @ position
            _paint(heights, planes, low[:2], high[:2], grid)
        known = np.isfinite(heights)
        lowest[z] = heights[known].min()
        above = np.rint(np.where(known, heights - lowest[z], 0.0) / UNIT)
        if above.max() > np.iinfo(np.uint16).max:
            raise ValidationError(
                f"{bank.scene_ids[z]}: found ground that rises by {above.max() * UNIT:.0f} m, needed 65 m or less."
            )
        stored[z] = above
    return stored, lowest.astype(np.float32), origins.astype(np.float32)


class GroundHeights:
    """The ground height in all scenes of a bank, accurate to half a millimetre at the cells' centres.

    Args:
      bank: the scenes.
      cell: m, side of a cell.

    Attributes:
      low, high: (Z, 2) m, the corners of each scene's ground.
    """

    def __init__(self, bank: SceneBank, cell: float = CELL) -> None:
        heights, lowest, low = build_heights(bank, cell)
        self._heights, self._lowest, self.low, self._cell = (
            jnp.asarray(heights),
            jnp.asarray(lowest),
            jnp.asarray(low),
            cell,
        )
        boxes = bank.prism_position + bank.hull_box[bank.prism_hull, 0] + bank.hull_box[bank.prism_hull, 1]
        self.high = jnp.asarray(np.where(bank.prism_hull[..., None] >= 0, boxes, -np.inf).max(1)[:, :2])

    def __call__(self, scene: Int[Array, ""], p_xy: Float[Array, "*n 2"]) -> Float[Array, "*n"]:
        """(...) m, height under points (..., 2) m of a scene () i32; that of the border for points outside."""
        cell = cell_of(p_xy, self.low[scene], self._cell, self._heights.shape[1:])
        return self._lowest[scene] + UNIT * self._heights[scene, cell[..., 0], cell[..., 1]].astype(jnp.float32)
