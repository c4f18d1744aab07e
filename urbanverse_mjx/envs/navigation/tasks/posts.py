"""Posts with a doorbell: adds them to a bank's scenes as hulls, contact surfaces and meshes.

In:   a bank, places of posts.
Out:  the bank with the posts.
When: once per bank, on the host.

A post is an object with one hull, so that touching it is a hit. The button is a cap on its front. It stands in the bank
as a ground prism, the kind of surface that a robot's feet may touch and no other part of it: the fingertip of an arm is
one of `RobotSpec.foot_geoms`, so all engines report the force with which it presses (`Contacts.foot_force`) and count
any other contact with the cap as a hit, as they do for wheels and the ground. A button that moves would need bodies
with joints of their own, which no engine has beside the robot; a force on a fixed cap is what all of them compute.
"""

import dataclasses
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ....datatypes import SceneBank
from ....datatypes.ground import GROUND_KINDS
from ....geometry import rotations

#: m: half a side and height of a post, and how far its front cap reaches before it.
HALF_SIDE, HEIGHT, DEPTH = 0.06, 1.35, 0.02
#: m, radius of the cap. The Access Board's manual on controls (ADAAG) recommends push plates of 3 inches.
CAP_RADIUS = 0.04
#: Corners of the cap's outline, and headings of posts, whose caps share hulls.
CORNERS, HEADINGS = 12, 16
CATEGORY = "doorbell"
FRICTION = 0.6
#: Colours (sRGB) of post and cap.
_POST_COLOUR, _CAP_COLOUR = (70, 78, 92), (226, 60, 40)
#: Pixels along the side of a colour in the texture, so that no neighbour's colour bleeds into it.
_SIDE = 4


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


class _Hull(NamedTuple):
    """A convex prism: corners (n, 3), outward triangles (f, 3), planes (f, 4), of which those of a face are equal."""

    corners: np.ndarray
    triangles: np.ndarray
    planes: np.ndarray


def _prism(ring: np.ndarray, low: float, high: float) -> _Hull:
    """The prism over a convex ring (n, 2) counter-clockwise from z = low to high."""
    n = len(ring)
    corners = np.concatenate([np.column_stack([ring, np.full(n, z)]) for z in (low, high)])
    fan = np.array([(0, k, k + 1) for k in range(1, n - 1)])
    triangles, planes = [fan[:, ::-1], fan + n], [np.tile([0.0, 0.0, -1.0, -low], (n - 2, 1))]
    planes.append(np.tile([0.0, 0.0, 1.0, high], (n - 2, 1)))
    for k in range(n):
        j = (k + 1) % n
        triangles.append(np.array([(k, j, j + n), (k, j + n, k + n)]))
        along = ring[j] - ring[k]
        normal = np.array([along[1], -along[0], 0.0]) / np.hypot(*along)
        planes.append(np.tile([*normal, normal[:2] @ ring[k]], (2, 1)))
    return _Hull(corners, np.concatenate(triangles), np.concatenate(planes))


def _post_hull() -> _Hull:
    square = HALF_SIDE * np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    return _prism(square, 0.0, HEIGHT)


def _cap_hull(yaw: float) -> _Hull:
    """The cap of a button that faces `yaw`, from its middle at the post's front."""
    angle = 2.0 * np.pi * (np.arange(CORNERS) + 0.5) / CORNERS
    lying = _prism(CAP_RADIUS * np.stack([np.cos(angle), np.sin(angle)], -1), 0.0, DEPTH)
    # Its axis z becomes the heading: columns are where x, y and z of the prism point to.
    c, s = np.cos(yaw), np.sin(yaw)
    turn = np.array([[-s, 0.0, c], [c, 0.0, s], [0.0, 1.0, 0.0]])
    planes = np.column_stack([lying.planes[:, :3] @ turn.T, lying.planes[:, 3]])
    return _Hull(lying.corners @ turn.T, lying.triangles, planes)


def with_posts(bank: SceneBank, posts: Mapping[int, Sequence[Post]]) -> SceneBank:
    """The bank with posts in some scenes.

    Args:
      posts: of each scene, by its row of the bank; at least one.

    The buttons are listed in `meta["buttons"]`: for each scene a list of x, y, z (m) of the middle of a button's
    surface, and the yaw (rad) in which it faces. A post is an object named "doorbell_<number>".
    """
    most, scenes = max(map(len, posts.values())), bank.num_scenes
    hulls = [_post_hull(), *(_cap_hull(2.0 * np.pi * h / HEADINGS) for h in range(HEADINGS))]
    first = bank.slot_mesh.shape[1]
    hull, owner, cap = (np.full((scenes, most), -1, np.int32) for _ in range(3))
    foot, front, yaw = np.zeros((scenes, most, 3)), np.zeros((scenes, most, 3)), np.zeros((scenes, most))
    for z, own in posts.items():
        for k, post in enumerate(own):
            hull[z, k], owner[z, k], cap[z, k] = bank.num_hulls, first + k, bank.num_hulls + 1 + post.heading
            foot[z, k], front[z, k], yaw[z, k] = post.place, post.at(HALF_SIDE), post.yaw
    turn = rotations.from_yaw(yaw.ravel()).reshape(scenes, most, 4)
    categories = [*bank.meta["categories"]] + [CATEGORY] * (CATEGORY not in bank.meta["categories"])
    exists = np.concatenate([hull, hull], 1) >= 0
    meshes = np.repeat(bank.num_meshes + np.arange(2), most)
    names = [[f"{CATEGORY}_{k}" if k < len(posts.get(z, ())) else "" for k in range(most)] for z in range(scenes)]
    ids = [
        [*x, *[""] * (first - len(x)), *y, *[""] * most] for x, y in zip(bank.meta["object_ids"], names, strict=True)
    ]
    buttons = [[[*post.at(HALF_SIDE + DEPTH).tolist(), post.yaw] for post in posts.get(z, ())] for z in range(scenes)]
    added = {
        **_hull_rows(bank, hulls),
        **_seen(bank),
        "inst_hull": hull,
        "inst_object": owner,
        "inst_position": foot,
        "inst_rotation": rotations.matrix_f64(turn),
        "inst_friction": np.full((scenes, most), FRICTION),
        "prism_hull": cap,
        "prism_position": front,
        "prism_friction": np.full((scenes, most), FRICTION),
        "prism_material_friction": np.full((scenes, most), FRICTION),
        "prism_kind": np.full((scenes, most), GROUND_KINDS.index("sidewalk")),
        "slot_mesh": np.where(exists, meshes, -1),
        "slot_position": np.concatenate([foot, front], 1),
        "slot_quaternion": np.concatenate([turn, turn], 1),
        "slot_category": np.where(exists, categories.index(CATEGORY), -1),
        "slot_movable": np.zeros((scenes, 2 * most)),
        "slot_mass": np.zeros((scenes, 2 * most)),
    }
    by_scene = ("inst_", "prism_", "slot_")
    arrays = {}
    for name, rows in added.items():
        array = getattr(bank, name)
        arrays[name] = np.concatenate([array, np.asarray(rows, array.dtype)], int(name.startswith(by_scene)))
    where = foot[..., :2], hull >= 0
    return dataclasses.replace(
        bank,
        **arrays,
        hull_grid=_listed(bank, "hull_grid", *where, bank.inst_hull.shape[1]),
        prism_grid=_listed(bank, "prism_grid", *where, bank.prism_hull.shape[1]),
        meta={**bank.meta, "categories": categories, "object_ids": ids, "buttons": buttons},
    )


def _hull_rows(bank: SceneBank, hulls: Sequence[_Hull]) -> dict[str, np.ndarray]:
    """Rows of the bank's hull table."""
    corners, faces = bank.hull_vertices.shape[1], bank.hull_triangles.shape[1]

    def padded(rows: np.ndarray, number: int) -> np.ndarray:
        return np.concatenate([rows, np.repeat(rows[:1], number - len(rows), axis=0)])

    low, high = (np.array([getattr(h.corners, end)(0) for h in hulls]) for end in ("min", "max"))
    return {
        "hull_vertices": np.stack([padded(h.corners, corners) for h in hulls]),
        "hull_num_vertices": np.array([len(h.corners) for h in hulls]),
        "hull_triangles": np.stack([padded(h.triangles, faces) for h in hulls]),
        "hull_num_triangles": np.array([len(h.triangles) for h in hulls]),
        "hull_planes": np.stack([padded(h.planes, faces) for h in hulls]),
        "hull_box": np.stack([0.5 * (low + high), 0.5 * (high - low)], 1),
    }


def _seen(bank: SceneBank) -> dict[str, np.ndarray]:
    """Rows of the bank's visual data: meshes of a post and of a cap that faces along x from its middle at the front,
    with one texture of both colours."""
    lying, upright = _cap_hull(0.0), _post_hull()
    corners, faces, uv = [], [], []
    for k, hull in enumerate((upright, lying)):
        # Corners of their own for each triangle, so that edges stay sharp.
        corners.append(hull.corners[hull.triangles].reshape(-1, 3))
        faces.append(np.arange(3 * len(hull.triangles)).reshape(-1, 3))
        uv.append(np.tile([(k + 0.5) / 2.0, 0.5], (3 * len(hull.triangles), 1)))
    image = np.repeat(np.array([_POST_COLOUR, _CAP_COLOUR], np.uint8), _SIDE, 0)[None].repeat(_SIDE, 0)
    return {
        "mesh_vertices": np.concatenate(corners),
        "mesh_uv": np.concatenate(uv),
        "mesh_faces": np.concatenate(faces),
        "mesh_vertex_start": len(bank.mesh_vertices) + np.cumsum([len(x) for x in corners]),
        "mesh_face_start": len(bank.mesh_faces) + np.cumsum([len(x) for x in faces]),
        "mesh_material": np.full(2, len(bank.material_texture)),
        "material_texture": np.array([len(bank.texture_shape)]),
        "material_rgba": np.ones((1, 4)),
        "material_roughness": np.array([0.5]),
        "material_metallic": np.array([0.0]),
        "texture_data": image.ravel(),
        "texture_start": np.array([len(bank.texture_data) + image.size]),
        "texture_shape": np.array([image.shape]),
    }


def _listed(bank: SceneBank, name: str, places: np.ndarray, exists: np.ndarray, first: int) -> np.ndarray:
    """The grid `name` (Z, X, Y, L) with instance `first` + k of post k in all cells from a point of which it is within
    the grids' reach.

    Args:
      places: (Z, P, 2) m. exists: (Z, P) bool.
    """
    grid, side = getattr(bank, name), float(bank.grid_cell)
    scenes, x, y, _ = grid.shape
    reach = float(bank.meta["grid_reach"]) + np.hypot(HALF_SIDE + DEPTH, HALF_SIDE + DEPTH)
    low = np.stack(np.meshgrid(np.arange(x), np.arange(y), indexing="ij"), -1) * side
    # (Z, X, Y, P) m from each cell to each post.
    away = (places - bank.grid_origin[:, None])[:, None, None] - low[None, :, :, None]
    apart = np.linalg.norm(np.maximum(np.maximum(-away, away - side), 0.0), axis=-1)
    near = (apart <= reach) & exists[:, None, None]
    more = np.where(near, first + np.arange(places.shape[1]), -1).astype(grid.dtype)
    both = np.concatenate([grid, more], -1)
    # A list ends with its first -1.
    both = np.take_along_axis(both, np.argsort(both < 0, axis=-1, kind="stable"), -1)
    return both[..., : max(int((both >= 0).sum(-1).max()), 1)].reshape(scenes, x, y, -1)
