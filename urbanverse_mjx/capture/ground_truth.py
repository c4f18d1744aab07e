"""Computes the ground-truth graph of a bank's scene from the meshes that the renderer draws."""

import numpy as np
import shapely

from ..datatypes import GROUND_KINDS, GraphObject, GroundRegion, SceneBank, SceneGraph, Source, ValidationError
from ..geometry import rotations
from .path import CameraPath
from .street import GROUND_PREFIX, ground_tops

SOURCE = Source("synthetic", "Apache-2.0", "none", "none")
#: m, grid of the corners of true ground: triangles of single precision that share an edge overlap by micrometres, which
#: leaves spikes in their union.
_GRID = 1e-3


def object_slots(bank: SceneBank, scene: int) -> np.ndarray:
    """(n,) visual slots of a scene that hold an object, not ground."""
    ground = np.array([name.startswith(GROUND_PREFIX) for name in bank.meta["categories"]])
    return np.flatnonzero((bank.slot_mesh[scene] >= 0) & ~ground[bank.slot_category[scene]])


def object_id(bank: SceneBank, scene: int, slot: int) -> str:
    """The id of the object in a slot."""
    return bank.meta["object_ids"][scene][slot] or f"slot_{slot}"


def true_objects(bank: SceneBank, scene: int) -> tuple[GraphObject, ...]:
    """Every object with its label and the box around its mesh, aligned with the asset's +x.

    Raises:
      ValidationError: an object is not upright.
    """
    objects = []
    for slot in object_slots(bank, scene):
        mesh = bank.slot_mesh[scene, slot]
        corners = bank.mesh_vertices[bank.mesh_vertex_start[mesh] : bank.mesh_vertex_start[mesh + 1]].astype(np.float64)
        w, x, y, z = bank.slot_quaternion[scene, slot].astype(np.float64)
        if abs(x) + abs(y) > 1e-4:
            raise ValidationError(f"slot {slot}: found a leaning object, needed one that turns about z alone.")
        yaw = 2.0 * float(np.arctan2(z, w))
        low, high = corners.min(0), corners.max(0)
        middle = rotations.about_z(yaw) @ ((low + high) / 2) + bank.slot_position[scene, slot]
        objects.append(
            GraphObject(
                id=object_id(bank, scene, slot),
                label=bank.meta["categories"][bank.slot_category[scene, slot]],
                center=tuple(float(v) for v in middle),  # type: ignore[arg-type]
                size=tuple(float(v) for v in np.maximum(high - low, 1e-3)),  # type: ignore[arg-type]
                yaw=float(np.remainder(yaw + np.pi, 2 * np.pi) - np.pi),
            )
        )
    return tuple(objects)


def _regions(bank: SceneBank, scene: int) -> tuple[GroundRegion, ...]:
    regions = []
    for slot, kind, triangles in ground_tops(bank, scene):
        outline = shapely.set_precision(shapely.union_all(shapely.polygons(triangles[:, :, :2])).buffer(0), _GRID)
        corners = triangles.reshape(-1, 3)
        plane, *_ = np.linalg.lstsq(np.c_[corners[:, :2], np.ones(len(corners))], corners[:, 2], rcond=None)
        for i, part in enumerate(shapely.get_parts(outline)):
            ring = shapely.remove_repeated_points(part.exterior, 1e-4).coords[:-1]
            regions.append(GroundRegion(f"{GROUND_KINDS[kind]}_{slot}_{i}", GROUND_KINDS[kind], ring, plane.tolist()))
    return tuple(regions)


def true_graph(bank: SceneBank, scene: int, path: CameraPath | None = None, source: Source = SOURCE) -> SceneGraph:
    """The graph of everything in a scene, visible or not.

    Raises:
      ValidationError: see `true_objects`.
    """
    plan = () if path is None else tuple(tuple(float(x) for x in row) for row in path.plan())
    return SceneGraph(
        id=bank.scene_ids[scene],
        source=source,
        objects=true_objects(bank, scene),
        ground=_regions(bank, scene),
        camera_path=plan,  # type: ignore[arg-type]
    )
