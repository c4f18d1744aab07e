"""Free bodies that rest: `scene.xml` with movable objects is stepped by whoever loads it, so nothing in it may creep.

Stands that end in the air and hulls that overlap by a centimetre make an object settle when it is let go. It is laid
where it comes to rest; one that leaves its place, or does not come to rest, stays fixed.
"""

import dataclasses

import numpy as np

from .geometry import SceneGeometry
from .mjcf import TIMESTEP
from .stability import SHIFT, TILT, free_motion

SECONDS = 5.0
#: m and rad by which a free object may move within `SECONDS`; the promise of the file is 1 cm and 1 degree, and the
#: trial without distant objects rounds otherwise than the whole scene.
STILL_SHIFT, STILL_TILT = 0.008, np.radians(0.8)
#: Instants at which the trial looks, every step: an object may hop and come back.
_INSTANTS = round(SECONDS / TIMESTEP)


@dataclasses.dataclass(frozen=True)
class RestingScene:
    """A scene whose movable objects rest as free bodies.

    Attributes:
      geometry: with those objects alone movable that rest, and the laid ones where they come to rest; for writing MJCF
        (maps and episodes are as they were).
      laid: ids of the objects that were laid where they come to rest.
      unstable: of those that do not and are fixed.
    """

    geometry: SceneGeometry
    laid: tuple[str, ...]
    unstable: tuple[str, ...]


def resting(scene: SceneGeometry) -> RestingScene:
    """Lays or fixes movable objects until all that are free stay within 1 cm and 1 degree for five seconds.

    An object that settles by less than what `stability.displacements` calls leaving its place is laid once; one that
    moves again, or farther, is fixed where the scene has it. C MuJoCo runs at the step of the scene's file.
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
