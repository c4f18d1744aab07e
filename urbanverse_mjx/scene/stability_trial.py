"""Measures the stability of a whole scene: all objects that are not fixed in reality are free bodies for two seconds.

Fixed objects are those that are held (`assets.categories.priors.is_held`; houses also because the ground ends a few
metres behind their fronts), and those that hang.
"""

import dataclasses

import numpy as np

from ..assets.categories.priors import is_held
from ..geometry import rotations
from ..geometry.grids import cell_of
from .geometry import SceneGeometry
from .stability import Displacement, displacements

#: m; an object hangs if its lowest point is higher than this above the ground.
MIN_HANGING_HEIGHT = 0.3
#: m and rad below which an object counts as still.
SHIFT, TILT = 0.05, np.radians(5.0)


@dataclasses.dataclass(frozen=True)
class StabilityTrial:
    """Number of free objects, ids of those that hang, and of those that moved, the farthest first."""

    standing: int
    hanging: tuple[str, ...]
    moved: tuple[Displacement, ...]


def let_go(scene: SceneGeometry) -> StabilityTrial:
    """Releases all objects that are not fixed and simulates them; takes some seconds for 300 objects."""
    hangs = hanging(scene)
    loose = ~hangs & ~np.array([is_held(leaf) for leaf in scene.object_categories], bool)
    free = dataclasses.replace(scene, object_movable=loose)
    moved = tuple(m for m in displacements(free, shift=SHIFT, tilt=TILT))
    names = tuple(name for name, up in zip(scene.object_ids, hangs, strict=True) if up)
    return StabilityTrial(int(loose.sum()), names, moved)


def hanging(scene: SceneGeometry) -> np.ndarray:
    """(n,) bool, objects whose lowest point is above the ground and above the tops of other objects there."""
    rotation = rotations.matrix(scene.object_quaternion)
    low = np.full(len(scene.object_ids), np.inf)
    for hull, obj in zip(scene.inst_hull, scene.inst_object, strict=True):
        corners = scene.hulls[hull] @ rotation[obj].T + scene.object_position[obj]
        low[obj] = min(low[obj], float(corners[:, 2].min()))
    ground = scene.map.height
    cells = cell_of(scene.object_position[:, :2], scene.map.origin, scene.map.resolution)
    inside = ((cells >= 0) & (cells < ground.shape)).all(1)
    floor = np.full(len(low), np.nan)
    floor[inside] = ground[tuple(cells[inside].T)]
    # Houses stand beyond the ground, so their own lowest point is used as ground height.
    floor = np.where(np.isfinite(floor), floor, np.where(np.isfinite(low), np.minimum(low, MIN_HANGING_HEIGHT), 0.0))
    return np.isfinite(low) & (low > floor + MIN_HANGING_HEIGHT)
