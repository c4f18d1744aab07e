"""`MeshBuilder`: collects painted parts into one `AssetMesh` with one texture.

Frame: +x front, +y left, z up, metres. Upright solids (box, cylinder, lathe, extrusion) stand on `at`, the centre of
their base; round ones (ball, ring) are centred on it. `turn_deg` = (about x, about y, about z) in degrees, applied in
that order about `at`.
"""

import contextlib
import dataclasses
import itertools
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from PIL import Image
from scipy.spatial.transform import Rotation

from urbanverse_mjx.datatypes import AssetMesh

from . import palette, shapes
from .atlas import pack
from .palette import Color
from .panels import NORMALS, face_size, panel_corners
from .shapes import Point2, Point3, Points3, Shape

ImageLike = np.ndarray | Image.Image
ZERO = (0.0, 0.0, 0.0)
CREASE_DEG = 40.0


@dataclasses.dataclass(frozen=True)
class BuiltAsset:
    """The result of a recipe.

    Attributes:
      mesh: the painted mesh, footprint centred, bottom at z = 0.
      description: one sentence without its full stop.
      params: of this variant, recorded in the index (JSON values).
      volume: m^3 enclosed by the closed parts (overlaps counted twice).
      mass: kg, or None to use volume times the recipe's bulk density.
      part_faces: number of faces of each part (or solid), in the order of the mesh's faces.
    """

    mesh: AssetMesh
    description: str
    params: dict[str, Any]
    volume: float
    mass: float | None = None
    part_faces: tuple[int, ...] = ()

    def scaled(self, scale: np.ndarray) -> "BuiltAsset":
        """The asset with its axes scaled by (3,) factors; a given mass is kept."""
        mesh = dataclasses.replace(self.mesh, vertices=self.mesh.vertices * scale)
        return dataclasses.replace(self, mesh=mesh, volume=self.volume * float(np.prod(scale)))

    def box_scale(self, size: Sequence[float | None] | np.ndarray) -> np.ndarray:
        """(3,) factors that scale the box to size (x, y, z), m; for an axis of None or 0, the mean of the others."""
        scale = np.array([side or 0.0 for side in size]) / np.maximum(self.mesh.extent.astype(float), 1e-9)
        return np.where(scale > 0, scale, scale[scale > 0].mean())

    def to_box(self, size: Sequence[float | None] | np.ndarray) -> "BuiltAsset":
        """The asset scaled so that its box is size (x, y, z), m, by `box_scale`."""
        return self.scaled(self.box_scale(size))


@dataclasses.dataclass(frozen=True)
class _Part:
    shape: Shape
    color: tuple[int, int, int] | None
    image: int | None
    crease_deg: float
    solid: int


def affine(at: Point3 = ZERO, turn_deg: Point3 = ZERO, scale: Point3 | float = 1.0) -> np.ndarray:
    """(4, 4) matrix that scales, then rotates about x, y, z, then translates to `at`."""
    matrix = np.eye(4)
    turn = Rotation.from_euler("xyz", turn_deg, degrees=True).as_matrix()
    matrix[:3, :3] = turn * np.broadcast_to(np.asarray(scale, float), 3)
    matrix[:3, 3] = at
    return matrix


class MeshBuilder:
    """Collects parts; `build` makes the asset. `roughness` and `metallic` apply to the whole mesh."""

    def __init__(self, roughness: float = 0.8, metallic: float = 0.0) -> None:
        self._roughness, self._metallic = roughness, metallic
        self._parts: list[_Part] = []
        self._images: list[np.ndarray] = []
        self._frame = np.eye(4)
        self._solid, self._in_solid = 0, False

    @contextlib.contextmanager
    def solid(self) -> Iterator["MeshBuilder"]:
        """Context in which added parts form one solid of several colours for the convex decomposition."""
        self._in_solid = True
        try:
            yield self
        finally:
            self._in_solid = False
            self._solid += 1

    @contextlib.contextmanager
    def frame(self, at: Point3 = ZERO, turn_deg: Point3 = ZERO, scale: Point3 | float = 1.0) -> Iterator["MeshBuilder"]:
        """Context in which parts are placed in this frame (frames nest; a negative scale mirrors)."""
        outer = self._frame
        self._frame = shapes.product(outer, affine(at, turn_deg, scale))
        try:
            yield self
        finally:
            self._frame = outer

    def add(
        self,
        shape: Shape,
        color: Color | None = None,
        at: Point3 = ZERO,
        turn_deg: Point3 = ZERO,
        scale: Point3 | float = 1.0,
        image: ImageLike | None = None,
        crease_deg: float = CREASE_DEG,
    ) -> None:
        """Adds any shape, in one colour, or with an image if the shape has UV coordinates.

        Edges that bend more than `crease_deg` are shaded sharp, others smoothly.
        """
        if (color is None) == (image is None):
            raise ValueError("part: found both or neither of color and image, needed exactly one.")
        if image is not None and shape.uv is None:
            raise ValueError("part: found an image on a shape without UV, needed a panel, quad, sheet or box skin.")
        placed = shape.transformed(shapes.product(self._frame, affine(at, turn_deg, scale)))
        paint = None if color is None else palette.rgb(color)
        number = None if image is None else self._image(image)
        self._parts.append(_Part(placed, paint, number, crease_deg, self._solid))
        self._solid += 0 if self._in_solid else 1

    def _image(self, image: ImageLike) -> int:
        pixels = np.asarray(image.convert("RGB") if isinstance(image, Image.Image) else image, np.uint8)
        for i, known in enumerate(self._images):
            if known.shape == pixels.shape and np.array_equal(known, pixels):
                return i
        self._images.append(pixels)
        return len(self._images) - 1

    # Solids -----------------------------------------------------------------------------------------------------------

    def box(
        self,
        size: Point3,
        at: Point3 = ZERO,
        color: Color = "grey",
        turn_deg: Point3 = ZERO,
        bevel: float = 0.0,
        taper: Point2 = (1.0, 1.0),
        centered: bool = False,
        skins: Mapping[str, ImageLike] | None = None,
    ) -> None:
        """A box standing on `at` (or centred on it); `skins` lays images on faces, e.g. {"+x": shop_front}."""
        lift = affine((0, 0, -size[2] / 2 if centered else 0.0))
        with self.frame(at, turn_deg):
            self.add(shapes.box(size, bevel, taper).transformed(lift), color, crease_deg=20.0)
            centre = np.array([0.0, 0.0, 0.0 if centered else size[2] / 2])
            for face, image in (skins or {}).items():
                normal = np.array(NORMALS[face], float)
                across, up = face_size(size, face)
                # 2 mm in front of the face, to avoid z-fighting.
                self.panel(image, centre + normal * (np.abs(normal) @ np.asarray(size) / 2 + 0.002), across, up, face)

    def cylinder(
        self,
        radius: float,
        height: float,
        at: Point3 = ZERO,
        color: Color = "grey",
        turn_deg: Point3 = ZERO,
        top_radius: float | None = None,
        segments: int = 16,
    ) -> None:
        """An upright cylinder, cone (`top_radius=0`) or frustum standing on `at`."""
        self.add(
            shapes.frustum(radius, radius if top_radius is None else top_radius, height, segments), color, at, turn_deg
        )

    def cone(self, radius: float, height: float, at: Point3 = ZERO, color: Color = "grey", segments: int = 16) -> None:
        self.add(shapes.frustum(radius, 0.0, height, segments), color, at)

    def ball(
        self,
        radii: Point3 | float,
        at: Point3 = ZERO,
        color: Color = "grey",
        turn_deg: Point3 = ZERO,
        segments: int = 14,
        rings: int = 8,
    ) -> None:
        """A sphere or ellipsoid centred on `at`."""
        self.add(shapes.ellipsoid(radii, segments, rings), color, at, turn_deg)

    def capsule(
        self,
        radius: float,
        length: float,
        at: Point3 = ZERO,
        color: Color = "grey",
        turn_deg: Point3 = ZERO,
        segments: int = 12,
    ) -> None:
        self.add(shapes.capsule(radius, length, segments), color, at, turn_deg)

    def ring(
        self,
        radius: float,
        thickness: float,
        at: Point3 = ZERO,
        color: Color = "grey",
        turn_deg: Point3 = ZERO,
        segments: int = 24,
        sides: int = 8,
    ) -> None:
        """A torus about the local z, centred on `at`; `thickness` is the tube's radius."""
        self.add(shapes.torus(radius, thickness, segments, sides), color, at, turn_deg)

    def lathe(
        self,
        profile: Sequence[Point2],
        at: Point3 = ZERO,
        color: Color = "grey",
        turn_deg: Point3 = ZERO,
        segments: int = 16,
        crease_deg: float = CREASE_DEG,
    ) -> None:
        """(radius, z) points from bottom to top, revolved about the local z."""
        self.add(shapes.lathe(profile, segments), color, at, turn_deg, crease_deg=crease_deg)

    def extrude(
        self,
        outline: Sequence[Point2],
        height: float,
        at: Point3 = ZERO,
        color: Color = "grey",
        turn_deg: Point3 = ZERO,
        holes: Sequence[Sequence[Point2]] = (),
        crease_deg: float = CREASE_DEG,
    ) -> None:
        """A polygon in local xy raised along local z; it may be concave and have holes."""
        self.add(shapes.extrusion(outline, height, holes), color, at, turn_deg, crease_deg=crease_deg)

    def profile(self, outline_xz: Sequence[Point2], width: float, at: Point3 = ZERO, color: Color = "grey") -> None:
        """A side view drawn in (x, z), `width` wide across y, centred on `at`."""
        solid = shapes.extrusion([(x, z) for x, z in outline_xz], width)
        # Local (x, y, z) = (x, up, across), rotated so that up is z, then centred across.
        self.add(solid.transformed(affine((0, width / 2, 0), (90, 0, 0))), color, at)

    def tube(
        self,
        path: Points3,
        radius: float | Sequence[float],
        color: Color = "grey",
        sides: int = 8,
        closed: bool = False,
        at: Point3 = ZERO,
    ) -> None:
        """A round pipe along a polyline; one radius or one per point."""
        self.add(shapes.tube(path, radius, sides, closed), color, at, crease_deg=50.0)

    def rod(self, start: Point3, end: Point3, radius: float, color: Color = "grey", sides: int = 8) -> None:
        """A straight round bar between two points."""
        self.tube([start, end], radius, color, sides)

    def beam(
        self, start: Point3, end: Point3, width: float, depth: float, color: Color = "grey", bevel: float = 0.0
    ) -> None:
        """A straight bar of rectangular section; `width` is the horizontal side across the bar, `depth` the other
        one."""
        a, b = np.asarray(start, float), np.asarray(end, float)
        axis = b - a
        length = shapes.length(axis)
        axis /= length
        reference = np.array([0.0, 0.0, 1.0]) if abs(axis[2]) < 0.999 else np.array([1.0, 0.0, 0.0])
        level = np.cross(reference, axis)
        level /= shapes.length(level)
        matrix = np.eye(4)
        matrix[:3, :3] = np.stack([np.cross(level, axis), level, axis], 1)
        matrix[:3, 3] = a
        self.add(shapes.box((depth, width, length), bevel).transformed(matrix), color, crease_deg=20.0)

    def loft(
        self, sections: Sequence[np.ndarray], color: Color = "grey", at: Point3 = ZERO, crease_deg: float = CREASE_DEG
    ) -> None:
        """A skin through cross sections (see `shapes.loft`), closed by caps."""
        self.add(shapes.loft(sections), color, at, crease_deg=crease_deg)

    def convex(self, points: Points3, color: Color = "grey", at: Point3 = ZERO) -> None:
        """The convex hull of points."""
        self.add(shapes.convex(points), color, at, crease_deg=25.0)

    # Surfaces ---------------------------------------------------------------------------------------------------------

    def panel(
        self,
        image: ImageLike,
        at: Point3,
        width: float,
        height: float,
        facing: str | float = "+x",
        back: Color | None = None,
        tilt_deg: float = 0.0,
    ) -> None:
        """A flat image centred on `at`, upright as seen from outside.

        Args:
          facing: "+x", "-x", "+y", "-y", "+z", "-z", or a yaw in degrees.
          back: colour of the other side; without it, the panel is invisible from behind.
          tilt_deg: leans the top backwards.
        """
        corners = panel_corners(np.asarray(at, float), width, height, facing, tilt_deg)
        self.add(shapes.quad(corners), image=image)
        if back is not None:
            normal = np.cross(corners[1] - corners[0], corners[3] - corners[0])
            self.add(shapes.quad(corners - 0.001 * normal / shapes.length(normal)).flipped(), back)

    def plate(
        self,
        outline: Sequence[Point2],
        thickness: float,
        at: Point3,
        image: ImageLike,
        color: Color = "aluminium",
        both_faces: bool = False,
    ) -> None:
        """A convex plate whose front (+x) shows an image over its box, e.g. a traffic sign.

        Args:
          outline: (right, up) points as seen from the front, m, about `at`, counter-clockwise.
          color: of the rim and the back.
          both_faces: whether the back shows the image too.
        """
        corners = np.asarray(outline, float)
        rows = [np.column_stack([np.full(len(corners), x), corners]) for x in (-thickness / 2, thickness / 2)]
        self.add(shapes.loft(rows), color, at)
        face = shapes.fan(rows[1] + np.array([0.001, 0.0, 0.0]))
        self.add(face, at=at, image=image)
        if both_faces:
            self.add(face, at=at, turn_deg=(0, 0, 180), image=image)

    def quad(
        self, corners: Points3, color: Color | None = None, image: ImageLike | None = None, both_sides: bool = False
    ) -> None:
        """Four corners: lower left, lower right, upper right, upper left, seen from the visible side."""
        self.sheet(np.asarray(corners, float)[[0, 1, 3, 2]].reshape(2, 2, 3), color, image, both_sides)

    def sheet(
        self,
        grid: np.ndarray,
        color: Color | None = None,
        image: ImageLike | None = None,
        both_sides: bool = False,
        lettered: bool = False,
    ) -> None:
        """A curved surface through (rows, columns, 3) points; see `shapes.sheet`.

        Args:
          both_sides: whether the back is visible too; it shows the image as seen through the sheet, like a flag's.
          lettered: the back shows the image itself, so that its text is not mirrored.
        """
        surface = shapes.sheet(grid)
        self.add(surface, color, image=image)
        if both_sides:
            back = surface.flipped()
            if lettered:
                back = shapes.Shape(back.vertices, back.faces, np.array([1.0, 0.0]) + back.uv * np.array([-1.0, 1.0]))
            self.add(back, color, image=image)

    # The result -------------------------------------------------------------------------------------------------------

    @property
    def bounds(self) -> np.ndarray:
        """(2, 3) least and greatest corner of the parts added so far, m."""
        points = np.concatenate([p.shape.vertices for p in self._parts])
        return np.stack([points.min(0), points.max(0)])

    def build(
        self,
        description: str,
        params: Mapping[str, Any] | None = None,
        mass: float | None = None,
        recenter: bool = True,
    ) -> BuiltAsset:
        """Packs the texture, splits vertices at creases, centres the footprint and puts the bottom on z = 0."""
        colors = sorted({p.color for p in self._parts if p.color is not None})
        packed = pack(colors, self._images)
        uvs = []
        for part in self._parts:
            if part.color is not None:
                cell = packed.cells[colors.index(part.color)]
                uvs.append(np.broadcast_to(cell, (len(part.shape.vertices), 2)))
            elif part.image is not None and part.shape.uv is not None:
                u0, v0, u1, v1 = packed.rectangles[part.image]
                uvs.append(np.array([u0, v0]) + part.shape.uv * np.array([u1 - u0, v1 - v0]))
        # All parts are processed at once for speed; no edge connects two parts.
        whole = shapes.joined([p.shape for p in self._parts], uvs)
        sizes = [len(p.shape.faces) for p in self._parts]
        split = shapes.split_at_creases(whole, np.repeat([p.crease_deg for p in self._parts], sizes), sizes)
        assert split.uv is not None, "`joined` gives texture coordinates"
        points = split.vertices
        if recenter:
            low, high = points.min(0), points.max(0)
            points = points - np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])
        mesh = AssetMesh(points, split.faces, split.uv, packed.texture, self._roughness, self._metallic)
        volume = sum(shapes.volume(p.shape) for p in self._parts)
        solids = itertools.groupby(self._parts, key=lambda part: part.solid)
        part_faces = tuple(sum(len(part.shape.faces) for part in group) for _, group in solids)
        return BuiltAsset(mesh, description, dict(params or {}), volume, mass, part_faces)
