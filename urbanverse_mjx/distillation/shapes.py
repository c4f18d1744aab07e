"""Estimates an object's heading by fitting its points to the known shapes of its label.

The sides of a box do not distinguish a pedestrian's front from the side, nor the length of a rounded object from its
width; known shapes of the label do. Points are fitted to every known shape under every heading by a shift (iterative
closest points without rotation; Besl and McKay 1992). The misfit is the mean of the truncated distances.
"""

import dataclasses

import numpy as np
import scipy.spatial

from ..datatypes import LabelPrior
from ..geometry import rotations

#: rad: coarse search over the full turn, and fine search around the best coarse heading.
_COARSE_HEADINGS, _FINE_HEADINGS = np.radians(np.arange(0.0, 360.0, 20.0)), np.radians(np.arange(-15.0, 15.1, 5.0))


@dataclasses.dataclass(frozen=True)
class ShapeOptions:
    """Options for fitting points to known shapes.

    Chosen manually; `benchmarks.fidelity` measures their effect (docs/decisions/generation.md).

    Attributes:
      points: approximate number of an object's points that are fitted.
      shifts: iterations of the shift.
      scale_limits: least and greatest ratio of an object's height to a known one's.
      max_distance: limit of a point's distance, as a share of the object's height.
    """

    points: int = 120
    shifts: int = 3
    scale_limits: tuple[float, float] = (0.75, 1.33)
    max_distance: float = 0.15


_OPTIONS = ShapeOptions()


@dataclasses.dataclass(frozen=True)
class Laid:
    """Misfit of points to known shapes: yaw (h,) rad, misfit (h,) as a share of the height."""

    yaw: np.ndarray
    misfit: np.ndarray

    def at(self, yaw: float) -> float:
        """The misfit of the heading nearest to one."""
        return float(self.misfit[np.argmin(np.abs(np.angle(np.exp(1j * (self.yaw - yaw)))))])

    @property
    def best(self) -> float:
        """rad."""
        return float(self.yaw[np.argmin(self.misfit)])


def lay(points: np.ndarray, prior: LabelPrior, also: np.ndarray) -> Laid:
    """Fits points to the known shapes of a label at all headings.

    Args:
      points: (p, 3) m, world.
      prior: a prior that has shapes.
      also: (k,) rad, additional headings to try.
    """
    first = lay_at(points, prior, np.concatenate([_COARSE_HEADINGS, also]))
    best = first.yaw[np.argsort(first.misfit, kind="stable")[:2]]
    finer = lay_at(points, prior, np.concatenate([yaw + _FINE_HEADINGS for yaw in best]))
    return Laid(np.concatenate([first.yaw, finer.yaw]), np.concatenate([first.misfit, finer.misfit]))


def lay_at(points: np.ndarray, prior: LabelPrior, yaw: np.ndarray) -> Laid:
    """Fits points to the known shapes of a label at given headings; args as in `lay`, yaw (k,) rad."""
    points = points[:: max(1, len(points) // _OPTIONS.points)]
    low, high = np.quantile(points, (0.01, 0.99), axis=0)
    height = max(float(high[2] - low[2]), 0.05)
    points = points - [*((low + high) / 2)[:2], low[2]]
    trees = []
    for shape, extent in zip(prior.shapes, prior.extents, strict=True):
        scale = float(np.clip(height / extent[2], *_OPTIONS.scale_limits))
        trees.append(scipy.spatial.cKDTree(scale * (shape - [0.0, 0.0, shape[:, 2].min()])))
    return Laid(yaw, np.array([min(_misfit(points, tree, y, height) for tree in trees) for y in yaw]))


def _misfit(points: np.ndarray, tree: scipy.spatial.cKDTree, yaw: float, height: float) -> float:
    local = points @ rotations.about_z(-yaw).T
    # The centre of the visible part differs from that of the object.
    local[:, :2] += (tree.maxes + tree.mins)[:2] / 2 - (local.max(0) + local.min(0))[:2] / 2
    distance = np.zeros(len(local))
    for _ in range(_OPTIONS.shifts):
        distance, nearest = tree.query(local, distance_upper_bound=_OPTIONS.max_distance * height)
        found = nearest < tree.n
        if found.any():
            local[:, :2] += (tree.data[nearest[found]] - local[found])[:, :2].mean(0)
    return float(np.minimum(distance, _OPTIONS.max_distance * height).mean() / height)
