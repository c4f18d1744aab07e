"""Objects of one hull each on the sidewalk of a box street."""

import dataclasses

import numpy as np

from urbanverse_mjx.scene.geometry import SceneGeometry

from .box_bank import box_scene

CUBE = np.array([[x, y, z] for x in (-0.2, 0.2) for y in (-0.2, 0.2) for z in (0.0, 0.4)], np.float32)
#: A post as high as a door on a foot of two centimetres, leaning, without support.
LEANING = CUBE * np.array([0.05, 0.05, 5.0], np.float32) + np.where(CUBE[:, 2:] > 0, [[0.3, 0, 0]], 0).astype(
    np.float32
)


def scene_of(*hulls: np.ndarray, movable: bool = True) -> SceneGeometry:
    """Objects a metre apart on the sidewalk of a box street."""
    count, none = len(hulls), box_scene(0)
    walk = np.flatnonzero(none.prism_kind == 4)[0]
    corner = (none.hulls[none.prism_hull[walk]] + none.prism_position[walk]).mean(0)
    top = (none.hulls[none.prism_hull[walk]] + none.prism_position[walk])[:, 2].max()
    position = np.array([[corner[0] + k, corner[1], top] for k in range(count)])
    return dataclasses.replace(
        none,
        object_ids=tuple(f"thing_{k}" for k in range(count)),
        object_categories=("box",) * count,
        object_position=position,
        object_quaternion=np.tile([1.0, 0, 0, 0], (count, 1)),
        object_mesh=np.zeros(count, np.int32),
        object_mass=np.full(count, 10.0),
        object_friction=np.full(count, 0.7),
        object_movable=np.full(count, movable),
        hulls=(*none.hulls, *hulls),
        inst_hull=len(none.hulls) + np.arange(count, dtype=np.int32),
        inst_object=np.arange(count, dtype=np.int32),
    )
