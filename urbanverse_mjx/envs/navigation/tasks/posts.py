"""Posts with a doorbell: adds them to a bank's scenes as hulls, contact surfaces and meshes.

In:   a bank, places of posts.
Out:  the bank with the posts.
When: once per bank, on the host.

The button is a cap on the front of a post and a contact surface (`furniture`), so all engines report the force with
which a fingertip presses it. A button that moves would need bodies with joints of their own, which no engine has beside
the robot; a force on a fixed cap is what all of them compute.
"""

import dataclasses
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ....datatypes import SceneBank
from .furniture import Hull, Kind, Piece, prism, with_furniture

#: m: half a side and height of a post, and how far its front cap reaches before it.
HALF_SIDE, HEIGHT, DEPTH = 0.06, 1.35, 0.02
#: m, radius of the cap. The Access Board's manual on controls (ADAAG) recommends push plates of 3 inches.
CAP_RADIUS = 0.04
#: Corners of the cap's outline, and headings of posts, whose caps share hulls.
CORNERS, HEADINGS = 12, 16
CATEGORY = "doorbell"
#: Colours (sRGB) of post and cap.
_POST_COLOUR, _CAP_COLOUR = (70, 78, 92), (226, 60, 40)


class Post(NamedTuple):
    """A post.

    Attributes:
      place: x, y, z (m) of the middle of its foot.
      heading: direction in which its button faces, a number of 2 pi / `HEADINGS` rad.
      button: m, height of the button's middle above the foot.
    """

    place: tuple[float, float, float]
    heading: int
    button: float

    @property
    def yaw(self) -> float:
        """rad, direction in which the button faces."""
        return 2.0 * np.pi * self.heading / HEADINGS

    def at(self, out: float) -> np.ndarray:
        """(3,) m, the point that is `out` m before the post's axis at the height of its button."""
        x, y, z = self.place
        return np.array([x + out * np.cos(self.yaw), y + out * np.sin(self.yaw), z + self.button])


def _post_hull() -> Hull:
    square = HALF_SIDE * np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    return prism(square, 0.0, HEIGHT)


def _cap_hull(yaw: float) -> Hull:
    """The cap of a button that faces `yaw`, from its middle at the post's front."""
    angle = 2.0 * np.pi * (np.arange(CORNERS) + 0.5) / CORNERS
    lying = prism(CAP_RADIUS * np.stack([np.cos(angle), np.sin(angle)], -1), 0.0, DEPTH)
    # Its axis z becomes the heading: columns are where x, y and z of the prism point to.
    c, s = np.cos(yaw), np.sin(yaw)
    turn = np.array([[-s, 0.0, c], [c, 0.0, s], [0.0, 1.0, 0.0]])
    planes = np.column_stack([lying.planes[:, :3] @ turn.T, lying.planes[:, 3]])
    return Hull(lying.corners @ turn.T, lying.triangles, planes)


def with_posts(bank: SceneBank, posts: Mapping[int, Sequence[Post]]) -> SceneBank:
    """The bank with posts in some scenes.

    Args:
      posts: of each scene, by its row of the bank; at least one.

    The buttons are listed in `meta["buttons"]`: for each scene a list of x, y, z (m) of the middle of a button's
    surface, and the yaw (rad) in which it faces. A post is an object named "doorbell_<number>".
    """
    upright, lying = _post_hull(), _cap_hull(0.0)
    kind = Kind(
        CATEGORY,
        upright,
        [_cap_hull(2.0 * np.pi * h / HEADINGS) for h in range(HEADINGS)],
        [hull.corners[hull.triangles] for hull in (upright, lying)],
        (_POST_COLOUR, _CAP_COLOUR),
        np.hypot(HALF_SIDE + DEPTH, HALF_SIDE + DEPTH),
    )

    def piece(post: Post) -> Piece:
        foot, front = np.array(post.place), post.at(HALF_SIDE)
        return Piece(foot, post.yaw, ((post.heading, front),), (foot, front))

    found = with_furniture(bank, kind, {z: [piece(post) for post in own] for z, own in posts.items()})
    buttons = [
        [[*post.at(HALF_SIDE + DEPTH).tolist(), post.yaw] for post in posts.get(z, ())] for z in range(bank.num_scenes)
    ]
    return dataclasses.replace(found, meta={**found.meta, "buttons": buttons})
