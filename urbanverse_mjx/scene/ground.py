"""Converts each ground region to convex collision prisms and a visual mesh."""

import dataclasses
from collections.abc import Sequence
from typing import Protocol

import numpy as np
import shapely

from ..datatypes import AssetMesh
from ..datatypes import validation as v
from ..datatypes.ground import KIND_INDEX, PAINT_KINDS, TRAVERSABLE_KINDS
from ..geometry.polygons import MAX_OVERLAP
from .polygons import convex_parts, triangulate

#: Largest number of corners of a prism's ring; two rings make 16 vertices.
MAX_RING = 8
#: Prisms end this far (m) below the scene's lowest ground, so that no kerb is open underneath.
THICKNESS = 0.3
#: Paint is drawn this high (m) above its surface.
PAINT_LIFT = 0.003
#: m; frames of regions lie on this raster, a power of two that float32 represents exactly, so that seams stay level.
_FRAME_RASTER = 1 / 64
#: m, distance within which a road borders on a crosswalk, and length of the shortest border that determines the
#: direction of traffic.
_MIN_BORDER = 0.05


class Region(Protocol):
    """The common fields of a `GroundRegion` and a `PlacedGround`."""

    @property
    def id(self) -> str: ...
    @property
    def kind(self) -> str: ...
    @property
    def polygon(self) -> tuple[tuple[float, float], ...]: ...
    @property
    def plane(self) -> tuple[float, float, float]: ...


@dataclasses.dataclass(frozen=True)
class Prism:
    """A convex piece of ground.

    Attributes:
      region: number of its region.
      position: (3,) m, origin of its frame (without rotation).
      corners: (2n, 3) float32 in that frame: the top ring, then the bottom ring.
    """

    region: int
    position: np.ndarray
    corners: np.ndarray


def check_regions(regions: Sequence[Region]) -> None:
    """Raises an error if non-paint regions overlap or there is no ground to stand on.

    Raises:
      ValidationError: two regions overlap, or there is no ground.
    """
    solid = [r for r in regions if r.kind not in PAINT_KINDS]
    if not solid:
        raise v.fail("ground", "paint alone", "at least one region that carries weight", "add a sidewalk or a road")
    shapes = [shapely.Polygon(r.polygon) for r in solid]
    for a, b in shapely.STRtree(shapes).query(shapes, predicate="intersects").T:
        area = shapes[a].intersection(shapes[b]).area if a < b else 0.0
        if area > MAX_OVERLAP:
            raise v.fail(
                f"ground {solid[a].id!r}",
                f"{area:.3g} m² shared with {solid[b].id!r}",
                "regions that do not overlap",
                "cut one of them or make it a road_marking",
            )


def check_drivable(regions: Sequence[Region], radius: float, length: float) -> None:
    """Checks that a robot could drive a route on the bare ground. Objects only take away room, so no scene that can be
    compiled is refused.

    Args:
      radius: m, half of the width that the robot needs.
      length: m, straight distance from the start to the goal of the shortest useful route.

    Raises:
      ValidationError: no connected traversable area holds such a route.
    """
    walkable = [shapely.Polygon(r.polygon) for r in regions if r.kind in TRAVERSABLE_KINDS]
    joined = shapely.union_all(walkable).buffer(_MIN_BORDER).buffer(-_MIN_BORDER - radius)
    longest = max((_diagonal(part) for part in shapely.get_parts(joined)), default=0.0)
    if longest < length:
        kinds = ", ".join(TRAVERSABLE_KINDS)
        found = f"{sum(shape.area for shape in walkable):.3g} m² of {kinds}, with room for {longest:.3g} m of driving"
        needed = f"a connected area with {length:g} m for a robot {2 * radius:g} m wide"
        raise v.fail("ground", found, needed, "film more of the pavement, or add or widen sidewalks in graph.json")


def _diagonal(shape: shapely.geometry.base.BaseGeometry) -> float:
    """m, diagonal of the bounding box."""
    if shape.is_empty:
        return 0.0
    low_x, low_y, high_x, high_y = shape.bounds
    return float(np.hypot(high_x - low_x, high_y - low_y))


def plane_height(plane: Sequence[float], xy: np.ndarray) -> np.ndarray:
    """Height (m) of z = a x + b y + c at points (..., 2)."""
    return xy @ np.asarray(plane[:2]) + plane[2]


def _frame(region: Region) -> np.ndarray:
    ring = np.asarray(region.polygon)
    middle = np.append((ring.min(0) + ring.max(0)) / 2, plane_height(region.plane, ring).min())
    return np.round(middle / _FRAME_RASTER) * _FRAME_RASTER


def _lowest(region: Region) -> float:
    return float(plane_height(region.plane, np.asarray(region.polygon)).min())


def ground_prisms(regions: Sequence[Region]) -> list[Prism]:
    """A small number of convex prisms whose tops cover every non-paint region exactly and lie in its plane."""
    solid = [(i, r) for i, r in enumerate(regions) if r.kind not in PAINT_KINDS]
    bottom = min(_lowest(r) for _, r in solid) - THICKNESS
    prisms = []
    for number, region in solid:
        position = _frame(region)
        for ring in convex_parts(np.asarray(region.polygon), MAX_RING):
            top = np.column_stack([ring, plane_height(region.plane, ring)])
            base = np.column_stack([ring, np.full(len(ring), bottom)])
            prisms.append(Prism(number, position, (np.concatenate([top, base]) - position).astype(np.float32)))
    return prisms


def traffic_turn(region: Region, regions: Sequence[Region]) -> float:
    """rad in (-pi/2, pi/2], direction of the traffic over a crosswalk: perpendicular to its borders with the roads.

    0 for other kinds, or if no road is near. Borders are weighted by length, regardless of their orientation (doubled
    angles).
    """
    if region.kind != "crosswalk":
        return 0.0
    roads = shapely.union_all([shapely.Polygon(r.polygon) for r in regions if r.kind == "road"])
    roads = roads.buffer(_MIN_BORDER)
    ring = np.asarray(region.polygon)
    edges = np.roll(ring, -1, 0) - ring
    lengths = np.array(
        [shapely.LineString([a, a + e]).intersection(roads).length for a, e in zip(ring, edges, strict=True)]
    )
    across = np.arctan2(-edges[:, 0], edges[:, 1])
    mean = (lengths * np.exp(2j * across)).sum()
    return float(np.round(np.angle(mean) / 2, 6)) if abs(mean) > _MIN_BORDER else 0.0


def region_mesh(
    region: Region, texture: np.ndarray, tile: float, roughness: float, metallic: float = 0.0, turn: float = 0.0
) -> tuple[np.ndarray, AssetMesh]:
    """Visual mesh of a region, and the position of its frame.

    The top is textured in world coordinates with `tile` metres per repetition and u at `turn` rad from +x. Kinds other
    than paint get a skirt down to `THICKNESS` below their lowest point, which is visible as the face of kerbs.

    Returns:
      (3,) m position without rotation, and the mesh in that frame.
    """
    paint = region.kind in PAINT_KINDS
    position, ring = _frame(region), np.asarray(region.polygon)
    top = np.column_stack([ring, plane_height(region.plane, ring) + (PAINT_LIFT if paint else 0.0)])
    on_tile = ring @ _turned(turn) / tile if turn else ring / tile
    vertices, uv, faces = [top], [on_tile], [triangulate(ring)]
    if paint:
        faces.append(faces[0][:, ::-1])  # a mesh has at least four faces; paint is never visible from below
    else:
        sides = _skirt(top, _lowest(region) - THICKNESS, tile, len(ring))
        vertices, uv, faces = ([a, b] for a, b in zip((top, on_tile, faces[0]), sides, strict=True))
    coordinates = np.concatenate(uv)
    return position, AssetMesh(
        vertices=np.concatenate(vertices) - position,
        faces=np.concatenate(faces),
        uv=coordinates - np.floor(coordinates.min(0)),
        texture=texture,
        roughness=roughness,
        metallic=metallic,
    )


def _turned(angle: float) -> np.ndarray:
    """(2, 2) matrix that transforms row vectors to axes rotated by `angle`."""
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def _skirt(top: np.ndarray, bottom: float, tile: float, first: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Vertices, uv and faces of the vertical sides below a ring, numbered from `first`; sides do not share vertices."""
    after = np.roll(top, -1, 0)
    low, low_after = top.copy(), after.copy()
    low[:, 2] = low_after[:, 2] = bottom
    vertices = np.stack([top, low, low_after, after], 1)
    arc_length = np.concatenate([[0.0], np.cumsum(np.linalg.norm((after - top)[:, :2], axis=1))])
    along = np.stack([arc_length[:-1], arc_length[:-1], arc_length[1:], arc_length[1:]], 1) / tile
    uv = np.stack([along, vertices[..., 2] / tile], -1)
    quad = first + 4 * np.arange(len(top))[:, None]
    faces = np.concatenate([quad + np.array([0, 1, 2]), quad + np.array([0, 2, 3])])
    return vertices.reshape(-1, 3), uv.reshape(-1, 2), faces


def kind_index(region: Region) -> int:
    return KIND_INDEX[region.kind]
