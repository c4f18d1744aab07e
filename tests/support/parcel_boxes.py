"""Streets with parcel boxes for tests: a bank, and the same boxes in C MuJoCo."""

import mujoco
import numpy as np

from tests.support.box_bank import box_bank, box_scenes
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.envs.navigation.tasks.boxes import with_boxes
from urbanverse_mjx.envs.navigation.tasks.posts import Post
from urbanverse_mjx.scene.mjcf import scene_spec

#: Of the street of `box_street`: facing along x, aslant, and across; heights of the rim.
BOXES = (Post((12.0, 6.0, 0.15), 0, 0.7), Post((24.0, 6.2, 0.15), 6, 0.8), Post((40.0, -6.0, 0.15), 12, 0.6))


def box_street() -> SceneBank:
    """One street of boxes with `BOXES`."""
    return with_boxes(box_bank(1, num_objects=2), {0: BOXES})


def box_spec() -> mujoco.MjSpec:
    """The same street in MJCF, whose parcel boxes are MuJoCo's own boxes: 40 cm wide, walls of 3 cm, 25 cm deep, a
    floor of 6 cm on a foot 34 cm wide."""
    (scene,) = box_scenes(1, num_objects=2)
    spec = scene_spec(scene)
    for number, box in enumerate(BOXES):
        turn = [np.cos(box.yaw / 2), 0.0, 0.0, np.sin(box.yaw / 2)]
        place = np.array(box.place) + [0.0, 0.0, box.button]
        body = spec.worldbody.add_body(name=f"parcel_box_{number}", pos=place, quat=turn)
        common = {"friction": [0.6, 0.005, 0.0001], "contype": 1, "conaffinity": 1}
        parts = {
            f"parcel_box_{number}/hull_0": ((0.17, 0.17, 0.5), (0.0, 0.0, -0.81)),
            f"ground/box_{number}/floor": ((0.2, 0.2, 0.03), (0.0, 0.0, -0.28)),
            f"ground/box_{number}/front": ((0.015, 0.2, 0.125), (0.185, 0.0, -0.125)),
            f"ground/box_{number}/back": ((0.015, 0.2, 0.125), (-0.185, 0.0, -0.125)),
            f"ground/box_{number}/left": ((0.17, 0.015, 0.125), (0.0, 0.185, -0.125)),
            f"ground/box_{number}/right": ((0.17, 0.015, 0.125), (0.0, -0.185, -0.125)),
        }
        for name, (size, pos) in parts.items():
            body.add_geom(name=name, type=mujoco.mjtGeom.mjGEOM_BOX, size=size, pos=pos, **common)
    return spec
