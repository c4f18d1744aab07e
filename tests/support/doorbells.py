"""Streets with doorbells for tests: banks, and the same posts in C MuJoCo."""

import mujoco
import numpy as np

from tests.support.box_bank import box_bank, box_scenes
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.envs.navigation.tasks.posts import Post, with_posts
from urbanverse_mjx.scene.mjcf import scene_spec

#: Of the street of `bell_street`: facing along x, aslant, and across.
POSTS = (Post((12.0, 6.0, 0.15), 0, 1.0), Post((24.0, 6.2, 0.15), 6, 1.15), Post((40.0, -6.0, 0.15), 12, 0.92))


def bell_street() -> SceneBank:
    """One street of boxes with `POSTS`."""
    return with_posts(box_bank(1, num_objects=2), {0: POSTS})


def bell_spec() -> mujoco.MjSpec:
    """The same street in MJCF, whose posts and caps are MuJoCo's own boxes and a convex hull of 24 corners."""
    (scene,) = box_scenes(1, num_objects=2)
    spec = scene_spec(scene)
    for number, post in enumerate(POSTS):
        turn = [np.cos(post.yaw / 2), 0.0, 0.0, np.sin(post.yaw / 2)]
        body = spec.worldbody.add_body(name=f"doorbell_{number}", pos=post.place, quat=turn)
        common = {"friction": [0.6, 0.005, 0.0001], "contype": 1, "conaffinity": 1}
        size = [0.06, 0.06, 0.675]
        body.add_geom(
            name=f"doorbell_{number}/hull_0", type=mujoco.mjtGeom.mjGEOM_BOX, size=size, pos=(0, 0, 0.675), **common
        )
        angle = 2.0 * np.pi * (np.arange(12) + 0.5) / 12
        ring = 0.04 * np.stack([np.cos(angle), np.sin(angle)], -1)
        corners = np.concatenate([np.column_stack([np.full(12, x), ring]) for x in (0.06, 0.08)])
        mesh = spec.add_mesh(name=f"cap_{number}", uservert=corners.ravel())
        # Of the world's body, as the ground is, so that its name alone makes it ground for a drive's record.
        body.add_geom(
            name=f"ground/doorbell_{number}",
            type=mujoco.mjtGeom.mjGEOM_MESH,
            meshname=mesh.name,
            pos=(0, 0, post.button),
            **common,
        )
    return spec
