"""Adds furniture with which a robot's arm works to a bank's scenes: hulls, contact surfaces and meshes.

In:   a bank, pieces of furniture.
Out:  the bank with them.
When: once per bank, on the host.

A piece is an object with one hull, so that touching it is a hit, and surfaces that stand in the bank as ground prisms:
what a robot's feet may touch and no other part of it. The fingertip of an arm and the spheres of a parcel are of
`RobotSpec.foot_geoms`, so all engines report the forces on them (`Contacts.foot_force`) and count any other contact
with a surface as a hit, as they do for wheels and the ground.
"""

import dataclasses
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ....datatypes import SceneBank
from ....datatypes.ground import GROUND_KINDS
from ....geometry import rotations

FRICTION = 0.6
#: Pixels along the side of a colour in the texture, so that no neighbour's colour bleeds into it.
_SIDE = 4


class Hull(NamedTuple):
    """A convex prism: corners (n, 3), outward triangles (f, 3), planes (f, 4), of which those of a face are equal."""

    corners: np.ndarray
    triangles: np.ndarray
    planes: np.ndarray


def prism(ring: np.ndarray, low: float, high: float) -> Hull:
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
    return Hull(corners, np.concatenate(triangles), np.concatenate(planes))


class Piece(NamedTuple):
    """A piece of furniture.

    Attributes:
      place: (3,) m, of its object's hull. yaw: rad, of the hull and the meshes.
      surfaces: number of a hull and its place (3,) m; its axes are the world's. As many for all pieces.
      meshes: place (3,) m of each mesh.
    """

    place: np.ndarray
    yaw: float
    surfaces: tuple[tuple[int, np.ndarray], ...]
    meshes: tuple[np.ndarray, ...]


class Kind(NamedTuple):
    """What pieces of a kind share.

    Attributes:
      category: of the objects, whose names are "<category>_<number>".
      hull: of the object. surfaces: hulls of the contact surfaces.
      meshes: (n, 3, 3) m, triangles of each mesh, the first of which is the object's. colours: sRGB of each mesh.
      radius: m of everything around the object's place.
    """

    category: str
    hull: Hull
    surfaces: Sequence[Hull]
    meshes: Sequence[np.ndarray]
    colours: Sequence[tuple[int, int, int]]
    radius: float


def with_furniture(bank: SceneBank, kind: Kind, pieces: Mapping[int, Sequence[Piece]]) -> SceneBank:
    """The bank with pieces of a kind in some scenes.

    Args:
      pieces: of each scene, by its row of the bank; at least one.
    """
    most, scenes = max(map(len, pieces.values())), bank.num_scenes
    some = next(piece for own in pieces.values() for piece in own)
    number, shown = len(some.surfaces), len(some.meshes)
    first = bank.slot_mesh.shape[1]
    hull, owner = np.full((scenes, most), -1, np.int32), np.full((scenes, most), -1, np.int32)
    surface = np.full((scenes, number, most), -1, np.int32)
    foot, yaw = np.zeros((scenes, most, 3)), np.zeros((scenes, most))
    front, mesh = np.zeros((scenes, number, most, 3)), np.zeros((scenes, shown, most, 3))
    for z, own in pieces.items():
        for k, piece in enumerate(own):
            hull[z, k], owner[z, k] = bank.num_hulls, first + k
            foot[z, k], yaw[z, k], mesh[z, :, k] = piece.place, piece.yaw, piece.meshes
            for n, (which, place) in enumerate(piece.surfaces):
                surface[z, n, k], front[z, n, k] = bank.num_hulls + 1 + which, place
    turn = rotations.from_yaw(yaw.ravel()).reshape(scenes, most, 4)
    categories = [*bank.meta["categories"]] + [kind.category] * (kind.category not in bank.meta["categories"])
    exists = np.tile(hull >= 0, (1, shown))
    meshes = np.repeat(bank.num_meshes + np.arange(shown), most)
    blank = [""] * (most * (shown - 1))
    names = [[f"{kind.category}_{k}" if k < len(pieces.get(z, ())) else "" for k in range(most)] for z in range(scenes)]
    ids = [[*x, *[""] * (first - len(x)), *y, *blank] for x, y in zip(bank.meta["object_ids"], names, strict=True)]
    flat = surface.reshape(scenes, -1)
    added = {
        **_hull_rows(bank, [kind.hull, *kind.surfaces]),
        **_seen(bank, kind),
        "inst_hull": hull,
        "inst_object": owner,
        "inst_position": foot,
        "inst_rotation": rotations.matrix_f64(turn),
        "inst_friction": np.full(hull.shape, FRICTION),
        "prism_hull": flat,
        "prism_position": front.reshape(scenes, -1, 3),
        "prism_friction": np.full(flat.shape, FRICTION),
        "prism_material_friction": np.full(flat.shape, FRICTION),
        "prism_kind": np.full(flat.shape, GROUND_KINDS.index("sidewalk")),
        "slot_mesh": np.where(exists, meshes, -1),
        "slot_position": mesh.reshape(scenes, -1, 3),
        "slot_quaternion": np.tile(turn, (1, shown, 1)),
        "slot_category": np.where(exists, categories.index(kind.category), -1),
        "slot_movable": np.zeros(exists.shape),
        "slot_mass": np.zeros(exists.shape),
    }
    by_scene = ("inst_", "prism_", "slot_")
    arrays = {}
    for name, rows in added.items():
        array = getattr(bank, name)
        arrays[name] = np.concatenate([array, np.asarray(rows, array.dtype)], int(name.startswith(by_scene)))
    places, every = foot[..., :2], np.tile(foot[..., :2], (1, number, 1))
    return dataclasses.replace(
        bank,
        **arrays,
        hull_grid=_listed(bank, "hull_grid", places, hull >= 0, bank.inst_hull.shape[1], kind.radius),
        prism_grid=_listed(bank, "prism_grid", every, flat >= 0, bank.prism_hull.shape[1], kind.radius),
        meta={**bank.meta, "categories": categories, "object_ids": ids},
    )


def _hull_rows(bank: SceneBank, hulls: Sequence[Hull]) -> dict[str, np.ndarray]:
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


def _seen(bank: SceneBank, kind: Kind) -> dict[str, np.ndarray]:
    """Rows of the bank's visual data: the meshes, with one texture of all colours. Each triangle has corners of its
    own, so that edges stay sharp."""
    corners = [triangles.reshape(-1, 3) for triangles in kind.meshes]
    number = len(corners)
    faces = [np.arange(len(x)).reshape(-1, 3) for x in corners]
    uv = [np.tile([(k + 0.5) / number, 0.5], (len(x), 1)) for k, x in enumerate(corners)]
    image = np.repeat(np.array(kind.colours, np.uint8), _SIDE, 0)[None].repeat(_SIDE, 0)
    return {
        "mesh_vertices": np.concatenate(corners),
        "mesh_uv": np.concatenate(uv),
        "mesh_faces": np.concatenate(faces),
        "mesh_vertex_start": len(bank.mesh_vertices) + np.cumsum([len(x) for x in corners]),
        "mesh_face_start": len(bank.mesh_faces) + np.cumsum([len(x) for x in faces]),
        "mesh_material": np.full(number, len(bank.material_texture)),
        "material_texture": np.array([len(bank.texture_shape)]),
        "material_rgba": np.ones((1, 4)),
        "material_roughness": np.array([0.5]),
        "material_metallic": np.array([0.0]),
        "texture_data": image.ravel(),
        "texture_start": np.array([len(bank.texture_data) + image.size]),
        "texture_shape": np.array([image.shape]),
    }


def _listed(
    bank: SceneBank, name: str, places: np.ndarray, exists: np.ndarray, first: int, radius: float
) -> np.ndarray:
    """The grid `name` (Z, X, Y, L) with instance `first` + k of the k-th new hull in all cells from a point of which it
    is within the grids' reach.

    Args:
      places: (Z, P, 2) m. exists: (Z, P) bool. radius: m, of the hulls around their places.
    """
    grid, side = getattr(bank, name), float(bank.grid_cell)
    scenes, x, y, _ = grid.shape
    reach = float(bank.meta["grid_reach"]) + radius
    low = np.stack(np.meshgrid(np.arange(x), np.arange(y), indexing="ij"), -1) * side
    # (Z, X, Y, P) m from each cell to each place.
    away = (places - bank.grid_origin[:, None])[:, None, None] - low[None, :, :, None]
    apart = np.linalg.norm(np.maximum(np.maximum(-away, away - side), 0.0), axis=-1)
    near = (apart <= reach) & exists[:, None, None]
    more = np.where(near, first + np.arange(places.shape[1]), -1).astype(grid.dtype)
    both = np.concatenate([grid, more], -1)
    # A list ends with its first -1.
    both = np.take_along_axis(both, np.argsort(both < 0, axis=-1, kind="stable"), -1)
    return both[..., : max(int((both >= 0).sum(-1).max()), 1)].reshape(scenes, x, y, -1)
