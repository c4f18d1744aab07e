"""A building block seen from the street: walls with real openings, reveals, sills, cornices, shop fronts,
awnings and roofs.
"""

import dataclasses
from collections.abc import Sequence

import numpy as np
import shapely

from ...meshes.mesh_builder import BuiltAsset, ImageLike, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import Physics
from ...meshes.shapes import Shape
from ..shared.sizes import hull_volume

#: kg per m^3 of a town building's outer volume (masonry walls and floors: 200-350).
BUILDING_DENSITY = 250.0


BUILDING = Physics(
    ("brick", "concrete", "glass"),
    BUILDING_DENSITY,
    (10_000.0, 10_000_000.0),
    0.8,
    False,
    "masonry with floors weighs 0.2-0.35 t per m^3 enclosed and stands on foundations; rough walls rub at about 0.8",
)


def finish(builder: MeshBuilder, description: str, params: dict, mass: float, fill: float) -> BuiltAsset:
    """The asset with its mass, and as its volume a share of its convex hull (its skin is open, so it encloses none)."""
    built = builder.build(description, params, mass=mass)
    return dataclasses.replace(built, volume=hull_volume(built) * fill)


class Facade:
    """A block `width` (y) by `depth` (x) by `height`, front at x = depth / 2; openings are cut by `walls`."""

    def __init__(self, builder: MeshBuilder, width: float, depth: float, height: float, trim: Color) -> None:
        self.builder, self.width, self.depth, self.height, self.trim = builder, width, depth, height, trim
        self.front = depth / 2
        self._openings: list[tuple[shapely.Polygon, float, ImageLike]] = []

    def opening(
        self,
        y: float,
        z: float,
        width: float,
        height: float,
        image: ImageLike,
        recess: float = 0.14,
        sill: bool = True,
        lintel: Color | None = None,
    ) -> None:
        """A hole whose lower middle is at (y, z), with reveals and an image at its back (cut by `walls`)."""
        z1, x = z + height, self.front
        self._openings.append((shapely.box(y - width / 2, z, y + width / 2, z1), recess, image))
        if sill:
            self.builder.box((recess + 0.10, width + 0.16, 0.07), (x - recess / 2 + 0.05, y, z - 0.07), self.trim)
        if lintel is not None:
            self.builder.box((0.05, width + 0.24, 0.16), (x + 0.02, y, z1 + 0.02), lintel)

    def walls(self, image: ImageLike, ground: Color | None = None, ground_height: float = 0.0) -> None:
        """Front with its holes, sides, back, floor and ceiling: one closed skin, so that its hull is plainly the block.

        Below `ground_height` the front is plain. Every seam has the same corners on both its sides.
        """
        with self.builder.solid():
            self._skin(image, ground, ground_height)

    def _skin(self, image: ImageLike, ground: Color | None, ground_height: float) -> None:
        width, height, depth = self.width, self.height, self.depth
        holes = shapely.union_all([hole for hole, _, _ in self._openings])
        upper = shapely.box(-width / 2, ground_height, width / 2, height).difference(holes)
        self._front(upper, image=image)
        if ground_height > 0:
            self._front(shapely.box(-width / 2, 0, width / 2, ground_height).difference(holes), color=ground)
        for hole, recess, pane in self._openings:
            self._recess(hole.bounds, recess, pane, ground_height)
        u = min(1.0, depth / width)
        levels = [0.0, ground_height, height] if ground_height > 0 else [0.0, height]
        for sign in (1.0, -1.0):
            # The far edge is straight, the one at the front has a corner where the plain part ends.
            near = [(self.front, z) for z in levels]
            corners = [(-self.front, 0.0), (-self.front, height), *reversed(near)]
            vertices = np.array([(x, sign * width / 2, z) for x, z in corners])
            uv = np.array([((self.front - sign * x) / depth * u, z / height) for x, z in corners])
            fan = np.array([(1, k, k + 1) for k in range(2, len(corners) - 1)] + [(1, len(corners) - 1, 0)])
            self.builder.add(Shape(vertices, fan if sign > 0 else fan[:, ::-1], uv), image=image)
        self.builder.panel(image, (-self.front, 0, height / 2), width, height, "-x")
        ring = np.array([(1, -1), (1, 1), (-1, 1), (-1, -1)]) * [depth / 2, width / 2]
        self.builder.quad(np.column_stack([ring, np.full(4, height)]), "dark concrete")
        self.builder.quad(np.column_stack([ring, np.zeros(4)])[::-1], "dark concrete")

    def _recess(self, bounds: tuple[float, ...], recess: float, image: ImageLike, ground_height: float) -> None:
        """Reveals and pane of one opening; its sides have a corner where the plain part of the front ends."""
        y0, z0, y1, z1 = bounds
        x, back = self.front, self.front - recess
        middle = [ground_height] if z0 < ground_height < z1 else []
        rim = [(y0, z0), (y1, z0), *((y1, z) for z in middle), (y1, z1), (y0, z1), *((y0, z) for z in middle)]
        for (ya, za), (yb, zb) in zip(rim, rim[1:] + rim[:1], strict=True):
            corners = [(x, ya, za), (x, yb, zb), (back, yb, zb), (back, ya, za)]
            self.builder.quad(corners, shade(self.trim, 0.8))
        shape = Shape(
            np.array([(back, y, z) for y, z in rim]), np.array([(0, k, k + 1) for k in range(1, len(rim) - 1)])
        )
        uv = np.array([((y - y0) / (y1 - y0), (z - z0) / (z1 - z0)) for y, z in rim])
        self.builder.add(dataclasses.replace(shape, uv=uv), image=image)

    def _front(self, area: shapely.Geometry, color: Color | None = None, image: ImageLike | None = None) -> None:
        triangles = [t for part in shapely.get_parts(area) for t in shapely.constrained_delaunay_triangles(part).geoms]
        flat = np.array([shapely.geometry.polygon.orient(t).exterior.coords[:3] for t in triangles])[..., :2].reshape(
            -1, 2
        )
        _, first, inverse = np.unique(np.round(flat, 5), axis=0, return_index=True, return_inverse=True)
        points = flat[first]
        vertices = np.column_stack([np.full(len(points), self.front), points])
        uv = np.clip(np.column_stack([points[:, 0] / self.width + 0.5, points[:, 1] / self.height]), 0.0, 1.0)
        self.builder.add(Shape(vertices, inverse.reshape(-1, 3), uv), color, image=image)

    # What stands out ------------------------------------------------------------------------------------------------

    def course(self, z: float, height: float, out: float, color: Color | None = None, around: bool = False) -> None:
        """A string course or cornice of one step; `around` carries it along the sides."""
        back = self.depth + 2 * out if around else 0.12 + out
        x = 0.0 if around else self.front + out - back / 2
        self.builder.box((back, self.width + 2 * out, height), (x, 0, z), color or self.trim)

    def cornice(self, z: float, out: float = 0.28) -> None:
        """Three steps below the roof."""
        for k, share in enumerate((0.35, 0.65, 1.0)):
            self.course(z + 0.12 * k, 0.12, out * share)

    def pilaster(self, y: float, z0: float, z1: float, width: float = 0.35, color: Color | None = None) -> None:
        self.builder.box((0.10, width, z1 - z0), (self.front + 0.05, y, z0), color or self.trim)

    def fascia(self, y: float, z: float, width: float, height: float, image: ImageLike, color: Color) -> None:
        """A sign board along the front."""
        self.builder.box((0.12, width, height), (self.front + 0.06, y, z), color, skins={"+x": image})

    def awning(self, y: float, z: float, width: float, reach: float, image: ImageLike, drop: float = 0.55) -> None:
        """A sloping cloth from height z with a valance, both sides to be seen, cheeks open."""
        x0, x1 = self.front + 0.02, self.front + reach
        low = z - drop
        half = width / 2
        cloth = np.array([[(x1, y - half, low), (x1, y + half, low)], [(x0, y - half, z), (x0, y + half, z)]])
        self.builder.sheet(cloth, image=image, both_sides=True)
        hang = np.array(
            [[(x1, y - half, low - 0.22), (x1, y + half, low - 0.22)], [(x1, y - half, low), (x1, y + half, low)]]
        )
        self.builder.sheet(hang, image=image, both_sides=True)
        for side in (-half, half):
            self.builder.rod((x0, y + side * 0.98, low), (x1, y + side * 0.98, low), 0.015, "dark grey", sides=4)

    def blade_sign(self, y: float, z: float, image: ImageLike, size: float = 0.7, color: Color = "black") -> None:
        """A square sign that stands out from the wall, readable from both ends of the street."""
        x = self.front + 0.12 + size / 2
        self.builder.box((size, 0.08, size), (x, y, z), color, skins={"+y": image, "-y": image})
        self.builder.rod((self.front, y, z + size * 0.8), (x, y, z + size * 0.8), 0.02, "black", sides=5)

    def balcony(
        self, y: float, z: float, width: float, reach: float = 0.9, color: Color = "black", slab: Color | None = None
    ) -> None:
        """A slab with a railing of bars."""
        x = self.front + reach / 2
        self.builder.box((reach, width, 0.14), (x, y, z - 0.14), slab or self.trim)
        rail = [
            (self.front, y - width / 2 + 0.04, z + 0.95),
            (self.front + reach - 0.04, y - width / 2 + 0.04, z + 0.95),
            (self.front + reach - 0.04, y + width / 2 - 0.04, z + 0.95),
            (self.front, y + width / 2 - 0.04, z + 0.95),
        ]
        self.builder.tube(rail, 0.025, color, sides=4)
        for k in np.linspace(-1, 1, max(4, int(width / 0.28))):
            py = y + k * (width / 2 - 0.04)
            self.builder.beam(
                (self.front + reach - 0.04, py, z), (self.front + reach - 0.04, py, z + 0.95), 0.018, 0.018, color
            )
        for side in (-1.0, 1.0):
            for f in (0.35, 0.7):
                py = y + side * (width / 2 - 0.04)
                self.builder.beam(
                    (self.front + reach * f, py, z), (self.front + reach * f, py, z + 0.95), 0.018, 0.018, color
                )

    # Roofs ----------------------------------------------------------------------------------------------------

    def flat_roof(self, parapet: float = 0.5) -> None:
        w, d, h = self.width, self.depth, self.height
        t, sunk = 0.22, 0.01  # sunk a little, so that no edge coincides with one of the walls
        for x in (-d / 2 + t / 2 + sunk, d / 2 - t / 2 - sunk):
            self.builder.box((t, w - 4 * sunk, parapet + sunk), (x, 0, h - sunk), self.trim)
        for y in (-w / 2 + t / 2 + sunk, w / 2 - t / 2 - sunk):
            self.builder.box((d - 2 * t - 4 * sunk, t, parapet), (0, y, h - sunk), self.trim)

    def gable_roof(
        self, rise: float, color: Color, overhang: float = 0.35, along: bool = True, wall: Color | None = None
    ) -> None:
        """A pitched roof; its ridge runs `along` the street, or towards it with the gable in front."""
        h = self.height
        half, run = (self.depth / 2, self.width / 2) if along else (self.width / 2, self.depth / 2)
        e, t = overhang, 0.14
        slope = rise / half
        low = h - e * slope
        section = [
            (-half - e, low),
            (0, h + rise),
            (half + e, low),
            (half + e, low + t),
            (0, h + rise + t),
            (-half - e, low + t),
        ]
        turn = 0.0 if along else 90.0
        with self.builder.frame((0, 0, 0), (0, 0, turn)):
            self.builder.profile(section, 2 * (run + e * 0.5), color=color)
            for sign in (1.0, -1.0):
                triangle = [(-half, h + 0.002), (half, h + 0.002), (0.0, h + rise)]
                self.builder.profile(triangle, 0.1, (0, sign * (run - 0.05), 0), wall or self.trim)

    def mansard(
        self, rise: float, color: Color, dormers: Sequence[float], image: ImageLike, inset: float = 0.8
    ) -> None:
        """A steep roof with dormers (y of their middles) and a flat top."""
        w, d, h = self.width, self.depth, self.height
        self.builder.box(
            (d + 0.02, w + 0.02, rise), (0, 0, h - 0.01), color, taper=((d - 2 * inset) / d, (w - 0.4) / w)
        )
        for y in dormers:
            x = d / 2 - 0.12
            self.builder.box((inset, 1.15, rise * 0.72), (x - inset / 2, y, h + 0.1), self.trim, skins={"+x": image})
            self.builder.box(
                (inset + 0.15, 1.35, 0.10), (x - inset / 2 + 0.05, y, h + 0.1 + rise * 0.72), shade(color, 0.8)
            )

    def chimney(self, x: float, y: float, top: float, color: Color = "brick") -> None:
        self.builder.box((0.5, 0.8, top - self.height + 0.8), (x, y, self.height - 0.8), color)
        self.builder.box((0.62, 0.92, 0.1), (x, y, top), "dark concrete")
        for k in (-0.2, 0.2):
            self.builder.cylinder(0.1, 0.3, (x, y + k, top + 0.1), "terracotta", segments=8)


def finish_block(f: Facade, description: str, params: dict, density: float = BUILDING_DENSITY) -> BuiltAsset:
    return finish(f.builder, description, params, f.width * f.depth * f.height * density, 0.9)


def bays_over(count: int, width: float) -> list[float]:
    """Middles of `count` equal bays over a width, m."""
    return [(k - (count - 1) / 2) * width / count for k in range(count)]


def stoop(f: Facade, y: float, width: float, steps: int, color: Color = "granite") -> float:
    """Steps up to a door; returns the height of its threshold."""
    for k in range(steps):
        reach = 0.3 * (steps - k)
        f.builder.box((reach, width, 0.17), (f.front + reach / 2, y, 0.17 * k), color)
    return 0.17 * steps
