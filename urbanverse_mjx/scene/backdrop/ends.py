"""Windows on the side walls of houses at the ends of rows, which have none of their own."""

import math
from collections.abc import Sequence

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from ...assets.appearances import noise
from ...assets.recipes.building.regional.styles import Form
from ..roads.drawing import CELL, Drawn, drawn_mesh
from . import images
from .houses import House

#: m before a side wall that no other house takes where it has windows.
FREE = (0.4, 1.0, 1.6)
#: m²: smaller walls have none. m: of wall around an opening, and between bays.
LEAST_WALL, MARGIN, SPACING = 12.0, 0.35, 2.6
#: m by which surrounds stand out: with edges below `NEAR` m, where one sees them, without above.
OUT, FLAT, NEAR = 0.05, 0.02, 4.5
#: Windows of a scene's image, along each side.
PER_SIDE = 8
#: Kind as which openings and fronts are labelled.
KIND = "building"


def side_wall(house: House, side: int) -> tuple[float, BaseGeometry]:
    """The plane y (m, asset frame) of a house's wall at +y (side 1) or -y (-1), and the wall in it as (x, z)."""
    corners = house.mesh.vertices.astype(np.float64)[house.mesh.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(normal, axis=1)
    faces = (side * normal[:, 1] > 0.999 * area) & (area > 1e-6)
    if not faces.any():
        return 0.0, shapely.Polygon()
    level = np.round(corners[faces, 0, 1] * 50).astype(int)
    levels, which = np.unique(level, return_inverse=True)
    wall = levels[int(np.bincount(which, area[faces]).argmax())]
    triangles = corners[faces][level == wall][:, :, [0, 2]]
    shape = shapely.union_all(np.asarray(shapely.polygons(triangles)), grid_size=1e-4)
    return float(corners[faces][level == wall][0, 0, 1]), shape


def openings_of(house: House, side: int, others: Sequence[House]) -> tuple[float, list[tuple[float, float]]]:
    """The plane of a side wall, m, and (x, z) of the lower middles of its windows in the asset frame.

    Args:
      others: houses that may stand before the wall; where one does within `FREE` m, the wall stays closed.
    """
    y, wall = side_wall(house, side)
    form = house.look
    if form is None or wall.area < LEAST_WALL:
        return y, []
    width, height = window_size(form, house.scale[2])
    inner = wall.buffer(-MARGIN, join_style="mitre")
    low_x, _, high_x, high_z = wall.bounds
    span = high_x - low_x - 2 * MARGIN
    count = max(1, round(span / SPACING))
    sz = house.scale[2]
    near = shapely.union_all([h.footprint for h in others if h is not house]) if len(others) > 1 else shapely.Point()
    c, s = math.cos(house.yaw), math.sin(house.yaw)
    found = []
    for k in range(count):
        x = low_x + MARGIN + span * (k + 0.5) / count
        before = [(x + across, y + side * out) for out in FREE for across in (-width / 2, width / 2)]
        points = [
            shapely.Point(house.position[0] + c * a - s * b, house.position[1] + s * a + c * b) for a, b in before
        ]
        if any(near.contains(p) for p in points):
            continue
        level = 0
        while True:
            floor = (form.ground_height + (level - 1) * form.storey if level else 0.55) * sz
            z = floor + max(form.sill, 0.45) * sz
            if z + height > high_z:
                break
            if inner.covers(shapely.box(x - width / 2, z, x + width / 2, z + height)):
                found.append((x, z))
            level += 1
    return y, found


def window_size(form: Form, stretch: float) -> tuple[float, float]:
    """Width and height of the windows in the side wall of a form's house whose height is stretched, m."""
    width, height = form.window_size
    return min(width, 1.2), min(height, 1.7) * stretch


def openings(houses: Sequence[House], seed: str) -> list[Drawn]:
    """Draws windows on the free side walls of houses, in squares of `CELL` m.

    Args:
      houses: all of a scene.
      seed: decides the curtains.
    """
    looks: list[tuple[Form, int]] = []
    parts: dict[tuple[int, int], list[np.ndarray]] = {}
    tree = shapely.STRtree([h.footprint for h in houses])
    for house in houses:
        others = [houses[i] for i in tree.query(house.footprint.buffer(3.0))]
        for side in (1, -1):
            y, found = openings_of(house, side, others)
            if not found or house.look is None:
                continue
            look = (house.look, house.dressing)
            if look not in looks and len(looks) < PER_SIDE**2:
                looks.append(look)
            row = looks.index(look) if look in looks else 0
            rows = np.concatenate([_window(house, side, y, at, row) for at in found])
            i, j = np.floor(house.position[:2] / (2 * CELL)).astype(int).tolist()
            parts.setdefault((i, j), []).append(rows)
    if not parts:
        return []
    rng = noise.generator(f"ends/{seed}")
    texture = np.full((PER_SIDE * images.WINDOW, PER_SIDE * images.WINDOW, 3), 128, np.uint8)
    for k, (form, dressing) in enumerate(looks):
        i, j = (part * images.WINDOW for part in divmod(k, PER_SIDE))
        texture[i : i + images.WINDOW, j : j + images.WINDOW] = images.window(form, dressing, rng)
    drawn = []
    for cell, found in sorted(parts.items()):
        rows = np.concatenate(found)
        drawn.append(drawn_mesh(f"drawn/windows/{cell}".replace(" ", ""), KIND, rows[:, :3], rows[:, 3:], texture, 0.5))
    return drawn


def _window(house: House, side: int, y: float, at: tuple[float, float], look: int) -> np.ndarray:
    """(n, 5) corners and texture coordinates of the triangles of a window that stands a little out of the wall."""
    assert house.look is not None
    width, height = window_size(house.look, house.scale[2])
    edge = images.SURROUND * 1.25
    w, z0, z1 = width / 2 + edge, at[1] - edge, at[1] + height + edge
    # Seen from outside, +x lies on the left of a wall at +y.
    left, right = at[0] + side * w, at[0] - side * w
    edged = at[1] < NEAR
    near, far = y, y + side * (OUT if edged else FLAT)
    row, column = divmod(look, PER_SIDE)
    u0, v1, step = column / PER_SIDE, 1.0 - row / PER_SIDE, 1.0 / PER_SIDE
    u1, v0 = u0 + step, v1 - step
    rim = (u0 + 0.04 * step, v0 + 0.04 * step)  # the colour of the surround
    face = [(left, far, z0, u0, v0), (right, far, z0, u1, v0), (right, far, z1, u1, v1), (left, far, z1, u0, v1)]
    quads = [face]
    ring = [(left, z0), (right, z0), (right, z1), (left, z1)]
    for (xa, za), (xb, zb) in zip(ring, ring[1:] + ring[:1], strict=True) if edged else ():
        quads.append([(xa, near, za, *rim), (xb, near, zb, *rim), (xb, far, zb, *rim), (xa, far, za, *rim)])
    rows = np.array(quads)[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 5)
    c, s = math.cos(house.yaw), math.sin(house.yaw)
    x, across = rows[:, 0].copy(), rows[:, 1].copy()
    rows[:, 0] = house.position[0] + c * x - s * across
    rows[:, 1] = house.position[1] + s * x + c * across
    rows[:, 2] += house.position[2]
    return rows
