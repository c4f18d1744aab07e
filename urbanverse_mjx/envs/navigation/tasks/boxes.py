"""Parcel boxes: adds boxes on a foot, open at the top, to a bank's scenes.

In:   a bank, places of boxes.
Out:  the bank with the boxes.
When: once per bank, on the host.

The foot is an object, so that touching it is a hit. The box on it is of contact surfaces (`furniture`), a floor and
four walls, which a parcel may touch as it may touch the ground.
"""

import dataclasses
from collections.abc import Mapping, Sequence

import numpy as np

from ....datatypes import SceneBank
from .furniture import Kind, Piece, prism, with_furniture
from .posts import HEADINGS, Post

#: m: half an outer side of the box, thickness of its walls, of its floor, and from its rim to the top of the floor.
HALF_SIDE, WALL, FLOOR, DEPTH = 0.2, 0.03, 0.06, 0.25
INNER = HALF_SIDE - WALL
#: m: half a side of the foot, and its height, of which a part is below the ground.
FOOT, FOOT_HEIGHT = 0.17, 1.0
CATEGORY = "parcel_box"
#: Colours (sRGB) of foot and box.
_FOOT_COLOUR, _BOX_COLOUR = (70, 78, 92), (38, 104, 178)
#: A box that is turned by a quarter is the same, so headings share hulls.
_TURNS = HEADINGS // 4


def _ring(half: tuple[float, float], yaw: float = 0.0) -> np.ndarray:
    """(4, 2) m, a rectangle about the origin, counter-clockwise."""
    x, y = half
    corners = np.array([(-x, -y), (x, -y), (x, y), (-x, y)])
    return corners @ np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])


def _walls() -> list[tuple[tuple[float, float], tuple[float, float]]]:
    """Half sides and middles (m) of the walls in the box's frame: front and back over its width, two between them."""
    middle = HALF_SIDE - 0.5 * WALL
    across, along = (0.5 * WALL, HALF_SIDE), (INNER, 0.5 * WALL)
    return [(across, (middle, 0.0)), (across, (-middle, 0.0)), (along, (0.0, middle)), (along, (0.0, -middle))]


def with_boxes(bank: SceneBank, boxes: Mapping[int, Sequence[Post]]) -> SceneBank:
    """The bank with boxes in some scenes.

    Args:
      boxes: of each scene, by its row of the bank; at least one. The height is that of the rim.

    They are listed in `meta["boxes"]`: for each scene a list of x, y, z (m) of the middle between the rims, and the yaw
    (rad) of the side before which the robot stands. A box is an object named "parcel_box_<number>".
    """
    turns = 2.0 * np.pi * np.arange(_TURNS) / HEADINGS
    shapes = [((HALF_SIDE, HALF_SIDE), -DEPTH - FLOOR, -DEPTH), *((half, -DEPTH, 0.0) for half, _ in _walls())]
    surfaces = [prism(_ring(half, yaw), low, high) for yaw in turns for half, low, high in shapes]
    foot = prism(_ring((FOOT, FOOT)), -DEPTH - FLOOR - FOOT_HEIGHT, -DEPTH - FLOOR)
    middles = [(0.0, 0.0), *(middle for _, middle in _walls())]
    seen = []
    for (half, low, high), middle in zip(shapes, middles, strict=True):
        hull = prism(_ring(half), low, high)
        seen.append((hull.corners + [*middle, 0.0])[hull.triangles])
    radius = float(np.hypot(HALF_SIDE, HALF_SIDE))
    meshes = [foot.corners[foot.triangles], np.concatenate(seen)]
    kind = Kind(CATEGORY, foot, surfaces, meshes, (_FOOT_COLOUR, _BOX_COLOUR), radius)

    def piece(box: Post) -> Piece:
        rim, turn = box.at(0.0), box.heading % _TURNS
        c, s = np.cos(turns[turn]), np.sin(turns[turn])
        places = [rim + [c * x - s * y, s * x + c * y, 0.0] for x, y in middles]
        first = turn * len(shapes)
        return Piece(rim, box.yaw, tuple((first + k, place) for k, place in enumerate(places)), (rim, rim))

    found = with_furniture(bank, kind, {z: [piece(box) for box in own] for z, own in boxes.items()})
    told = [[[*box.at(0.0).tolist(), box.yaw] for box in boxes.get(z, ())] for z in range(bank.num_scenes)]
    return dataclasses.replace(found, meta={**found.meta, "boxes": told})
