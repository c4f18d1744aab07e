"""Completes ground that no camera saw: holes, and the strip between the observed ground and the house fronts."""

import dataclasses
import itertools
from collections.abc import Sequence

import numpy as np
import scipy.ndimage
import shapely

from ..datatypes import KIND_INDEX
from ..geometry.grids import Grid, cell_of
from ..geometry.polygons import filled
from .ground import CELL, DRIVEN, WALKED, GroundMap


@dataclasses.dataclass(frozen=True)
class CompletionOptions:
    """Limits of the completion.

    Set by hand on blocks whose ground is known (docs/decisions/generation.md).

    Attributes:
      front_distance: m, largest gap between a wall and the ground in front of it that is filled.
      under_fronts: m by which ground extends below a house, the uncertainty of the house's position.
      walkable: m; a strip at least this wide becomes pavement if there is pavement within twice `front_distance`; a
        narrower one takes the kind of its neighbour.
      gap: m; narrower gaps between strips are closed.
      notch: m; narrower notches in the outline are closed, because a parked bus hides the pavement up to the front.
      across: a hole is filled with carriageway up to this ratio of its distances from carriageway and from pavement; in
        the middle of a hole as wide as the road the pavements are nearer than the ends of the road.
      stub: m; narrower protrusions are cut off, because they were seen through a gap between objects.
      max_hole: m^2; larger holes are courtyards or unobserved areas and stay open.
      house_share: largest share of a hole that houses may cover.
      max_islet: m^2; smaller holes are always closed.
    """

    front_distance: float = 5.0
    under_fronts: float = 0.5
    walkable: float = 1.0
    gap: float = 3.0
    notch: float = 8.0
    across: float = 2.0
    stub: float = 1.0
    max_hole: float = 100.0
    house_share: float = 0.2
    max_islet: float = 3.0


_OPTIONS = CompletionOptions()


def completed(seen: GroundMap, houses: Sequence[shapely.Polygon]) -> GroundMap:
    """Adds unobserved ground to the grid: holes, and the strip from the outermost ground to the fronts behind it.

    Args:
      seen: the result of `ground_map`.
      houses: footprints, m. Ground extends `under_fronts` m below them, the uncertainty of their position.
    """
    rim = round(_OPTIONS.front_distance / CELL) + 2
    origin, kind = seen.origin - rim * CELL, np.pad(seen.kind, rim)
    height = np.pad(seen.height, rim, constant_values=np.nan)
    known = kind > 0
    inside = np.zeros(kind.shape, bool)
    for house in houses:
        inside |= _within(house, origin, kind.shape)
    strip, wide = _before_fronts(known, houses, origin)
    strip = scipy.ndimage.binary_closing(known | strip, _disk(_OPTIONS.notch / 2)) if strip.any() else known
    strip &= known | ~scipy.ndimage.binary_erosion(inside, _disk(_OPTIONS.under_fronts))
    wide = scipy.ndimage.binary_closing(wide, _disk(_OPTIONS.gap / 2))
    use = known | strip
    # Ground seen through a gap between objects forms a stub.
    holes = _holes(known, inside) | _holes(use, inside)
    use = scipy.ndimage.binary_opening(use | holes, _disk(_OPTIONS.stub / 2))
    walked, driven = (np.isin(kind, [KIND_INDEX[k] for k in kinds]) for kinds in (WALKED, DRIVEN))
    source = np.stack(scipy.ndimage.distance_transform_edt(~known, return_indices=True)[1])
    if walked.any():
        away, nearest = scipy.ndimage.distance_transform_edt(~walked, return_indices=True)
        # A gap between a wall and the carriageway is pavement if there is pavement nearby.
        source = np.where(wide & ~known & (away * CELL <= 2 * _OPTIONS.front_distance), nearest, source)
        if driven.any():
            off, nearest = scipy.ndimage.distance_transform_edt(~driven, return_indices=True)
            source = np.where(holes & ~wide & (off <= _OPTIONS.across * away), nearest, source)
    kind = np.where(use, kind[tuple(source)], 0).astype(np.uint8)
    height = np.where(use, height[tuple(source)], np.nan)
    return GroundMap(origin, kind, height, np.where(known, np.pad(seen.count, rim), 0))


def _disk(radius: float) -> np.ndarray:
    cells = np.arange(-round(radius / CELL), round(radius / CELL) + 1)
    return cells[:, None] ** 2 + cells**2 <= (radius / CELL) ** 2


def _within(area: shapely.Polygon, origin: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    i, j = filled(Grid(origin, CELL, (shape[0], shape[1])), np.array(area.exterior.coords[:-1]))
    inside = np.zeros(shape, bool)
    inside[i, j] = True
    return inside


def _before_fronts(
    known: np.ndarray, houses: Sequence[shapely.Polygon], origin: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """(X, Y) bool, cells between walls and the first ground in front of them; and those where this strip is `walkable`
    wide."""
    strip, wide = np.zeros((2, *known.shape), bool)
    steps = np.arange(-_OPTIONS.under_fronts, _OPTIONS.front_distance, CELL / 2)
    for house in houses:
        ring = np.array(shapely.geometry.polygon.orient(house).exterior.coords)
        for a, b in itertools.pairwise(ring):
            length = float(np.linalg.norm(b - a))
            out = np.array([b[1] - a[1], a[0] - b[0]]) / max(length, 1e-9)
            wall = a + np.linspace(0.0, 1.0, int(2 * length / CELL) + 2)[:, None] * (b - a)
            cells = cell_of(wall[:, None] + steps[:, None] * out, origin, CELL)
            inside = ((cells >= 0) & (cells < known.shape)).all(-1)
            i, j = np.moveaxis(np.where(inside[..., None], cells, 0), -1, 0)
            met = np.maximum.accumulate(known[i, j] & inside & (steps >= 0.0), axis=1)
            before = inside & ~met & met[:, -1:]
            strip[i[before], j[before]] = True
            before &= (~met).sum(1, keepdims=True) * CELL / 2 >= _OPTIONS.walkable + _OPTIONS.under_fronts
            wide[i[before], j[before]] = True
    return strip, wide


def _holes(known: np.ndarray, houses: np.ndarray) -> np.ndarray:
    """(X, Y) bool, holes enclosed by known cells that are at most `max_hole` large and do not belong to a house."""
    numbers, _ = scipy.ndimage.label(~known)
    size = np.bincount(numbers.ravel())
    rim = np.unique(np.r_[numbers[0], numbers[-1], numbers[:, 0], numbers[:, -1]])
    fine = (size * CELL**2 <= _OPTIONS.max_hole) & (
        np.bincount(numbers.ravel(), houses.ravel()) <= _OPTIONS.house_share * size
    )
    fine |= size * CELL**2 <= _OPTIONS.max_islet
    fine[rim] = False
    fine[0] = False
    return fine[numbers]
