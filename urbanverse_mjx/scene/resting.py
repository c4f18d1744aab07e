"""Makes movable objects stable as free bodies, so that nothing in `scene.xml` moves when it is simulated.

Supports that end above the ground and hulls that overlap by a centimetre make an object move when it is released. Such
an object is placed where it comes to rest; one that leaves its place or does not come to rest stays fixed.
"""

import dataclasses

import numpy as np

from .geometry import SceneGeometry
from .mjcf import TIMESTEP
from .stability import SHIFT, TILT, free_motion

SECONDS = 5.0
#: m and rad, largest movement of a free object within `SECONDS`. The documented limit is 1 cm and 1 degree; the margin
#: covers rounding differences between this simulation, which omits distant objects, and the whole scene.
STILL_SHIFT, STILL_TILT = 0.008, np.radians(0.8)
#: Number of times at which positions are checked: every step, because an object may hop and return.
_INSTANTS = round(SECONDS / TIMESTEP)


@dataclasses.dataclass(frozen=True)
class RestingScene:
    """A scene whose movable objects are at rest as free bodies.

    Attributes:
      geometry: scene in which only objects at rest are movable, and laid objects are where they come to rest; for
        writing MJCF (maps and episodes are unchanged).
      laid: ids of the objects that were moved to where they come to rest.
      unstable: ids of the objects that do not come to rest and are fixed.
    """

    geometry: SceneGeometry
    laid: tuple[str, ...]
    unstable: tuple[str, ...]


def resting(scene: SceneGeometry) -> RestingScene:
    """Moves or fixes movable objects until all free ones stay within 1 cm and 1 degree for five seconds.

    An object that moves by less than the threshold of `stability.displacements` is placed once where it comes to rest;
    one that moves again, or farther, is fixed at its original pose. C MuJoCo runs at the step of the scene's file.
    """
    row = {name: k for k, name in enumerate(scene.object_ids)}
    position, quaternion = scene.object_position.copy(), scene.object_quaternion.copy()
    laid, unstable = np.zeros((2, len(row)), bool)
    while True:
        free = scene.object_movable & ~unstable
        now = dataclasses.replace(
            scene, object_movable=free, object_position=position.copy(), object_quaternion=quaternion.copy()
        )
        motion = free_motion(now, SECONDS, TIMESTEP, _INSTANTS)
        moves = np.flatnonzero((motion.shift > STILL_SHIFT) | (motion.tilt > STILL_TILT))
        if not len(moves):
            break
        rows = np.array([row[motion.ids[k]] for k in moves])
        leaves = laid[rows] | (motion.shift[moves] > SHIFT) | (motion.tilt[moves] > TILT)
        if leaves.any():  # alone: what they fall upon may stay without them
            gone = rows[leaves]
            unstable[gone] = True
            position[gone], quaternion[gone] = scene.object_position[gone], scene.object_quaternion[gone]
        else:
            laid[rows] = True
            position[rows], quaternion[rows] = motion.position[moves], motion.quaternion[moves]
    return RestingScene(now, _names(scene, laid & ~unstable), _names(scene, unstable))


def _names(scene: SceneGeometry, rows: np.ndarray) -> tuple[str, ...]:
    return tuple(name for name, there in zip(scene.object_ids, rows, strict=True) if there)
