"""Layouts of units (bricks, slabs, setts, stones): courses, herringbone, basket weave, hexagons, arcs, cells.

Every layout is tileable and returns for each pixel the distance to the edge of its unit and the unit's number.
"""

import dataclasses

import numpy as np

from .board import Board, Field


@dataclasses.dataclass(frozen=True)
class Laid:
    """A laid pattern.

    Attributes:
      edge: m from the pixel to the boundary of its unit (the middle of the joint).
      number: int32 unit of the pixel, below `count`.
      row, column: of the unit, for colour patterns.
      along: m along the unit's longer side from its middle.
    """

    edge: Field
    number: np.ndarray
    count: int
    row: np.ndarray
    column: np.ndarray
    along: Field


def _box(px: Field, py: Field, half_x: Field | float, half_y: Field | float, radius: float) -> Field:
    """Depth inside a box with rounded corners, m; negative outside of a rounded corner."""
    radius = min(radius, 0.45 * float(np.min(half_x)), 0.45 * float(np.min(half_y)))
    qx, qy = np.abs(px) - half_x + radius, np.abs(py) - half_y + radius
    return radius - np.hypot(np.maximum(qx, 0), np.maximum(qy, 0)) - np.minimum(np.maximum(qx, qy), 0)


def courses(
    board: Board, columns: int, rows: int, shift: float = 0.5, radius: float = 0.0, bend: float = 0.0,
    bend_scale: float = 0.3,
) -> Laid:  # fmt: skip
    """Equal units in rows; each row starts `shift` of a unit after the one before (0: a grid, 0.5: running bond)."""
    x, y = board.bent(bend, bend_scale)
    width, height = board.metres / columns, board.metres / rows
    row = np.floor(y / height).astype(np.int32)
    start = np.array([(shift * r) % 1.0 for r in range(rows)], np.float32)
    position = x / width + start[row % rows]
    column = np.floor(position).astype(np.int32)
    px, py = (position - column - 0.5) * width, y - (row + 0.5) * height
    row, column = row % rows, column % columns
    return Laid(
        _box(px, py, width / 2, height / 2, radius), row * columns + column, rows * columns, row, column, px
    )  # fmt: skip


def random_courses(
    board: Board, rows: int, mean_length: float, variation: float, radius: float = 0.0, bend: float = 0.0,
    uneven_rows: float = 0.0, bend_scale: float = 0.3,
) -> Laid:  # fmt: skip
    """Rows of units of different lengths (and, with `uneven_rows`, rows of different heights), as masons lay stone."""
    x, y = board.bent(bend, bend_scale)
    heights = 1.0 + uneven_rows * board.rng.uniform(-1, 1, rows)
    tops = np.concatenate([[0.0], np.cumsum(heights)]) / heights.sum() * board.metres
    y = y % board.metres
    row = np.clip(np.searchsorted(tops, y, side="right") - 1, 0, rows - 1).astype(np.int32)
    per_row = max(round(board.metres / mean_length), 2)
    lengths = 1.0 + variation * board.rng.uniform(-1, 1, (rows, per_row))
    cuts = np.concatenate([np.zeros((rows, 1)), np.cumsum(lengths, 1)], 1)
    cuts *= board.metres / cuts[:, -1:]
    # Rows are shifted by half a unit plus a random offset, so that joints of neighbouring rows seldom meet.
    start = (np.arange(rows) % 2 * 0.5 + board.rng.uniform(-0.15, 0.15, rows)) * mean_length
    x = (x + start[row].astype(np.float32)) % board.metres
    # All joints in one sorted array, so that one search finds the unit of every pixel.
    line = (cuts[:, :-1] + np.arange(rows)[:, None] * 2 * board.metres).ravel()
    number = np.searchsorted(line, x + row * (2 * board.metres), side="right") - 1
    number = np.clip(number, row * per_row, row * per_row + per_row - 1).astype(np.int32)
    column = number - row * per_row
    left, right = cuts[row, column], cuts[row, column + 1]
    half_x, half_y = ((right - left) / 2).astype(np.float32), ((tops[row + 1] - tops[row]) / 2).astype(np.float32)
    px = x - ((left + right) / 2).astype(np.float32)
    py = y - ((tops[row + 1] + tops[row]) / 2).astype(np.float32)
    return Laid(_box(px, py, half_x, half_y, radius), number, rows * per_row, row, column, px)


def herringbone(board: Board, cells: int, radius: float = 0.0, bend: float = 0.0) -> Laid:
    """Units twice as long as wide at right angles; `cells` (a multiple of 4) widths fit into the tile."""
    x, y = board.bent(bend, 0.3)
    cell = board.metres / cells
    gx, gy = np.floor(x / cell).astype(np.int32), np.floor(y / cell).astype(np.int32)
    # Along a row: two cells of a lying unit, then one cell each of two standing ones.
    phase = (gx - gy) % 4
    lying = phase < 2
    column = np.where(phase == 1, gx - 1, gx)
    row = np.where(phase == 2, gy - 1, gy)
    px = x - (column + np.where(lying, 1.0, 0.5).astype(np.float32)) * cell
    py = y - (row + np.where(lying, 0.5, 1.0).astype(np.float32)) * cell
    edge = np.where(lying, _box(px, py, cell, cell / 2, radius), _box(px, py, cell / 2, cell, radius))
    row, column = row % cells, column % cells
    return Laid(
        edge, (row * cells + column) + cells * cells * ~lying, 2 * cells * cells, row, column, np.where(lying, px, py)
    )  # fmt: skip


def basket(board: Board, squares: int, radius: float = 0.0, bend: float = 0.0) -> Laid:
    """Basket weave: squares of two units, lying and standing in turn; `squares` is even."""
    x, y = board.bent(bend, 0.3)
    side = board.metres / squares
    gx, gy = np.floor(x / side).astype(np.int32), np.floor(y / side).astype(np.int32)
    lying = (gx + gy) % 2 == 0
    px, py = x - (gx + 0.5) * side, y - (gy + 0.5) * side
    long, short = np.where(lying, px, py), np.where(lying, py, px)
    second = short > 0
    short = short - np.where(second, side / 4, -side / 4)
    edge = _box(long, short, side / 2, side / 4, radius)
    gx, gy = gx % squares, gy % squares
    return Laid(edge, (gy * squares + gx) * 2 + second, 2 * squares * squares, gy, gx, long)


def cells(
    board: Board, columns: int, rows: int, jitter: float, half_offset: bool = False, bend: float = 0.0,
    bend_scale: float = 0.3,
) -> Laid:  # fmt: skip
    """Every point belongs to the nearest of seeds on a (jittered) grid: irregular stones, or hexagons without jitter.

    Args:
      jitter: 0 to 1, random offset of the seeds from the grid, in cells.
      half_offset: odd rows are moved by half a cell (needs an even number of rows).
    """
    width, height = board.metres / columns, board.metres / rows
    x, y = board.bent(bend, bend_scale)
    shift = np.where(np.arange(rows) % 2 == 1, 0.5, 0.0)[:, None] if half_offset else np.zeros((rows, 1))
    seed_x = 0.5 + shift + jitter * board.rng.uniform(-0.5, 0.5, (rows, columns))
    seed_y = 0.5 + jitter * board.rng.uniform(-0.5, 0.5, (rows, columns))
    seed_x, seed_y = seed_x.astype(np.float32), seed_y.astype(np.float32)
    home_r = np.floor(y / height).astype(np.int32)
    home_c = np.floor(x / width).astype(np.int32)
    # The two nearest seeds of each pixel. Positive float32 values sort like their bit patterns, so the lowest four bits
    # encode the neighbouring cell, and two minima find both seeds.
    neighbours = [(dr, dc) for dr in (-1, 0, 1) for dc in ((-2, -1, 0, 1) if half_offset else (-1, 0, 1))]
    first = np.full(x.shape, np.iinfo(np.int32).max, np.int32)
    second = first.copy()
    for k, (dr, dc) in enumerate(neighbours):
        number = (home_r + dr) % rows * columns + (home_c + dc) % columns
        dx = (seed_x.ravel()[number] + (home_c + dc).astype(np.float32)) * np.float32(width) - x
        dy = (seed_y.ravel()[number] + (home_r + dr).astype(np.float32)) * np.float32(height) - y
        key = ((dx * dx + dy * dy).astype(np.float32).view(np.int32) & ~15) | k
        second = np.minimum(second, np.maximum(first, key))
        first = np.minimum(first, key)
    steps = np.array(neighbours, np.int32)
    found = []
    for key in (first, second):
        r, c = home_r + steps[key & 15, 0], home_c + steps[key & 15, 1]
        number = r % rows * columns + c % columns
        at_x, at_y = (seed_x.ravel()[number] + c) * width - x, (seed_y.ravel()[number] + r) * height - y
        found.append((number, at_x, at_y))
    (number, ax, ay), (_, bx, by) = found
    apart = np.maximum(np.hypot(bx - ax, by - ay), 1e-6)
    # Distance to the line halfway between the two seeds.
    edge = np.maximum((bx * bx + by * by - ax * ax - ay * ay) / (2 * apart), 0.0).astype(np.float32)
    return Laid(edge, number, rows * columns, number // columns, number % columns, -ax)


def arcs(board: Board, strips: int, rows: int, per_row: int, rise: float, radius: float, bend: float) -> Laid:
    """Segmental arcs: setts in bows side by side; each bow is `metres / strips` wide and rises by `rise` m."""
    x, y = board.bent(bend, 0.25)
    width, height, length = board.metres / strips, board.metres / rows, board.metres / strips / per_row
    strip = np.floor(x / width).astype(np.int32)
    across = x - (strip + 0.5) * width
    y = y + np.float32(rise * 4 / width**2) * across**2
    row = np.floor(y / height).astype(np.int32)
    throw = board.rng.uniform(0.0, 1.0, (rows, strips)).astype(np.float32)
    position = (across / width + 0.5) * per_row + 0.25 * np.sin(2 * np.pi * throw)[row % rows, strip % strips]
    column = np.clip(np.floor(position).astype(np.int32), 0, per_row - 1)
    left = np.where(column == 0, -0.5 * width, across - (position - column) * length)
    right = np.where(column == per_row - 1, 0.5 * width, across + (column + 1 - position) * length)
    px, py = across - (left + right) / 2, y - (row + 0.5) * height
    edge = _box(px, py, (right - left) / 2, height / 2, radius)
    row, strip = row % rows, strip % strips
    number = (row * strips + strip) * per_row + column
    return Laid(edge, number.astype(np.int32), rows * strips * per_row, row, strip * per_row + column, px)
