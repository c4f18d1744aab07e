"""`Canvas`: builder of a hand-made scene on ground of any outline.

Ground comes first (later pieces are cut out of earlier ones), then objects are placed by coordinates or along an `Edge`
(a kerb, a wall, a path). Nothing is filled automatically: every object is one call or one row of a table. `problems`
lists faults of the composition; `graph` makes the scene graph.
"""

import dataclasses
import itertools
import math
from collections.abc import Iterable, Sequence

import shapely

from ...assets.appearances import appearance_search
from ...assets.appearances.ground_materials import build_material
from ...datatypes import GraphObject, GroundRegion, SceneGraph, Source, ValidationError
from ...datatypes.ground import PAINT_KINDS
from .. import catalogue
from ..section import RAMP_HALF_WIDTH, RAMP_LENGTH
from ..stage import JOINT, Stage
from . import faults, ground_layers, object_sizes
from .ground_layers import Corner, Layer

CAMERA_HEIGHT = 1.6  # m, height of the camera path over the ground

#: Label, metres along an edge, metres from it, facing, and optionally the variant (row of the label's sizes). Facing is
#: "street" (towards the edge), "wall" (away from it), "+" or "-" (along it), or degrees counter-clockwise from the
#: edge's own direction.
Placement = tuple[str, float, float, str | float] | tuple[str, float, float, str | float, int]
#: As `Placement`, without the metres from the edge.
Leaning = tuple[str, float, str | float] | tuple[str, float, str | float, int]


@dataclasses.dataclass(frozen=True)
class Edge:
    """A straight line to place objects along.

    Attributes:
      start: (x, y) m, where s = 0.
      degrees: direction in which s grows, counter-clockwise from +x.
      side: +1 where objects along the edge are to its left, -1 to its right.
      sign: -1 where distances count in the opposite direction, towards the street: see `back` and `road`.
    """

    start: Corner
    degrees: float
    side: int
    sign: int = 1

    def back(self, width: float) -> "Edge":
        """Returns the far side of a pavement of the given width; distances count from there towards this edge."""
        return dataclasses.replace(self, start=self.at(0.0, width), sign=-self.sign)

    def road(self) -> "Edge":
        """Returns the same edge with distances counted towards the street."""
        return dataclasses.replace(self, sign=-self.sign)

    def at(self, s: float, d: float) -> Corner:
        """Returns the position (x, y) m, s metres along the edge and d metres from it."""
        angle = math.radians(self.degrees)
        c, n = math.cos(angle), math.sin(angle)
        d *= self.side * self.sign
        return self.start[0] + s * c - d * n, self.start[1] + s * n + d * c

    def facing(self, facing: str | float) -> float:
        """Returns a facing in degrees counter-clockwise from +x.

        Raises:
          ValidationError: an unknown word.
        """
        turns = {"street": -90.0 * self.side, "wall": 90.0 * self.side, "+": 0.0, "-": 180.0}
        if isinstance(facing, str):
            if facing not in turns:
                raise ValidationError(f'facing: found {facing!r}, needed "street", "wall", "+", "-" or degrees.')
            return self.degrees + turns[facing]
        return self.degrees + facing


def edge(start: Corner, end: Corner, side: int) -> Edge:
    """Returns the edge from one point to another; `side` is +1 for objects to its left, -1 to its right."""
    return Edge(start, math.degrees(math.atan2(end[1] - start[1], end[0] - start[0])), side)


def edges(points: Sequence[Corner], offset: float, side: int) -> list[Edge]:
    """Returns an edge beside each segment of a polyline, `offset` metres to its left (side +1) or right (-1),
    mitred."""
    line = shapely.LineString(points).offset_curve(side * offset, join_style="mitre", mitre_limit=10.0)
    corners = [(round(x, 3), round(y, 3)) for x, y in line.coords]
    return [edge(a, b, side) for a, b in itertools.pairwise(corners)]


class Canvas(Stage):
    """Collects the ground and the objects of one scene."""

    source = Source(video="hand", licence="Apache-2.0", city="none", country="none")

    def __init__(self, scene_id: str, seed: int = 0) -> None:
        super().__init__(scene_id, seed, object_sizes.SIZES)
        self._layers: list[Layer] = []
        self._paint: list[Layer] = []
        self._cuts: list[ground_layers.Cut] = []
        self._worn: list[tuple[str | Corner, str]] = []
        self._sky: str | None = None
        #: (x, y) m, the walk through the scene: a robot must be able to get from the first to the last point.
        self.trajectory: list[Corner] = []

    # Ground. All of it must be laid before the first object.

    def ground(self, name: str, kind: str, corners: Iterable[Corner], z: float = 0.0) -> None:
        """Adds a level piece of ground; earlier ground under it is cut away."""
        self._lay(Layer(name, kind, ground_layers.outline(corners), ground_layers.level(z)))

    def slope(
        self, name: str, kind: str, corners: Iterable[Corner], points: Sequence[tuple[float, float, float]]
    ) -> None:
        """Adds a tilted piece of ground whose top goes through three points (x, y, z)."""
        self._lay(Layer(name, kind, ground_layers.outline(corners), ground_layers.plane_through(points)))

    def ramp(
        self,
        name: str,
        foot: Corner,
        degrees: float,
        half_width: float = RAMP_HALF_WIDTH,
        run: float = RAMP_LENGTH,
        flare: float = 1.0,
        parted: bool = True,
    ) -> None:
        """Adds a dropped kerb; see `ground_layers.dropped_kerb`. `parted`: whether the pavement behind it is cut beside
        it, which saves prisms for a straight strip and wastes them at a corner."""
        pieces, cuts = ground_layers.dropped_kerb(self._layers, name, foot, degrees, half_width, run, flare)
        self._cuts += cuts if parted else []
        for layer in pieces:
            self._lay(layer)

    def cut(self, start: Corner, end: Corner, name: str | None = None) -> None:
        """Splits all ground, or the visible part of one piece, along a line; see `ground_layers.Cut`."""
        self._cuts.append(ground_layers.Cut(name, start, end))

    def stairs(self, name: str, foot: Corner, degrees: float, width: float, count: int) -> None:
        """Adds `count` treads up from the ground before `foot`; see `ground_layers.stairs`."""
        for layer in ground_layers.stairs(self._layers, name, foot, degrees, width, count):
            self._lay(layer)

    def paint(self, name: str, corners: Iterable[Corner]) -> None:
        """Adds a painted mark on a level piece of ground; robots on the pavement may not drive on it."""
        ring = ground_layers.outline(corners)
        spot = ring.representative_point()
        height = ground_layers.top_at(self._layers, spot.x, spot.y)
        self._paint.append(Layer(name, "road_marking", ring, ground_layers.level(height)))

    def dashes(self, name: str, start: Corner, end: Corner, dash: float = 3.0, gap: float = 4.5) -> None:
        """Adds a dashed painted line, 12 cm wide."""
        line = edge(start, end, 1)
        number, s = 0, 0.0
        while s + dash <= math.dist(start, end) + 1e-9:
            self.paint(f"{name}_{number}", ground_layers.strip([line.at(s, 0.0), line.at(s + dash, 0.0)], 0.12))
            number, s = number + 1, s + dash + gap

    def _lay(self, layer: Layer) -> None:
        if self.regions:
            raise ValidationError(
                f"ground {layer.name!r}: found objects on the ground already; lay all ground before them."
            )
        self._layers.append(layer)

    def lay_ground(self) -> None:
        """Converts the layers to regions. Placing the first object calls it too."""
        if not self.regions:
            self.lay(ground_layers.tiles(self._layers, self._cuts))
            self.lay(
                GroundRegion(p.name, p.kind, tuple((x, y) for x, y in p.outline.exterior.coords[:-1]), p.plane)
                for p in self._paint
            )

    # Appearance.

    def wear(self, where: str | Corner, material: str) -> None:
        """Sets the material of the piece of ground at (x, y), or of all ground of a kind: a uid of
        `assets.appearances.grounds` or an id of `assets.appearances.ground_materials`. Touching sidewalks share one
        material; every other kind has one material per scene."""
        self._worn.append((where, material))

    def sky(self, uid: str) -> None:
        """Sets the sky, a uid of `assets.appearances.sky_maps`."""
        self._sky = uid

    # Objects.

    def put(
        self,
        label: str,
        x: float,
        y: float,
        degrees: float = 0.0,
        variant: int | None = None,
        size: catalogue.Size | None = None,
        above: float = 0.0,
    ) -> GraphObject:
        """Places one object.

        Args:
          x, y: m, position of its stem, or of its middle where it has none.
          degrees: heading, counter-clockwise from +x.
          variant: row of the label's sizes.
          size: m (along, across, up) instead of one of them.
          above: m over the ground; from 0.3 m on the object hangs or stands on another object.
        """
        self.lay_ground()
        if variant is not None:
            if not 0 <= variant < len(self.sizes[label]):
                raise ValidationError(
                    f"{label}: found variant {variant}, needed one of 0 to {len(self.sizes[label]) - 1}."
                )
            size = self.sizes[label][variant]
        return self.add(self.make(label, x, y, degrees, size, above))

    def along(self, line: Edge, placements: Iterable[Placement]) -> None:
        """Places a table of objects along an edge."""
        for label, s, d, facing, *variant in placements:
            self.put(label, *line.at(s, d), line.facing(facing), variant[0] if variant else None)

    def against(self, line: Edge, placements: Iterable[Leaning], gap: float = 0.06) -> None:
        """Places a table of objects whose nearer sides are `gap` metres from an edge: at a wall, along a kerb."""
        for label, s, facing, *variant in placements:
            degrees = line.facing(facing)
            along, across, _ = self.sizes[label][variant[0]] if variant else self.next_size(label)
            turn = math.radians(degrees - line.degrees)
            reach = (abs(along * math.sin(turn)) + abs(across * math.cos(turn))) / 2
            self.put(label, *line.at(s, gap + reach), degrees, variant[0] if variant else None)

    def row(
        self,
        label: str,
        line: Edge,
        at: Iterable[float],
        d: float,
        facing: str | float = "street",
        variant: int | None = None,
    ) -> None:
        """Places the same object at several positions along an edge: bollards, lamps, posts."""
        for s in at:
            self.put(label, *line.at(s, d), line.facing(facing), variant)

    def trees(self, line: Edge, at: Iterable[float], d: float, growth: str = "street") -> None:
        """Places trees of one growth form along an edge, each rotated for variety."""
        for s in at:
            self.put("tree", *line.at(s, d), self.uniform(-180.0, 180.0), size=catalogue.TREES[growth])

    def houses(self, line: Edge, labels: Sequence[str], s0: float, s1: float, d: float) -> None:
        """Places house fronts without gaps from s0 to s1, d metres from the edge, facing it."""
        s = s0
        for label, (depth, width, height) in zip(labels, self.frontages(labels, s1 - s0), strict=True):
            box = (depth, round(width - JOINT, 3), height)
            self.put(label, *line.at(s + width / 2, d + depth / 2), line.facing("street"), size=box)
            s += width

    def problems(self, clear_width: float = faults.CLEARANCE) -> list[str]:
        """Returns the faults of the composition, one sentence each; see `faults`."""
        self.lay_ground()
        return faults.problems(self, self.trajectory, clear_width)

    # The scene graph.

    def graph(self) -> SceneGraph:
        self.lay_ground()
        sky = None if self._sky is None else sky_descriptor(self._sky)
        return SceneGraph(
            self.scene_id, self.source, tuple(self.objects), self._dressed(), sky, tuple(self._camera_path())
        )

    def _dressed(self) -> tuple[GroundRegion, ...]:
        """Returns the regions; those with a chosen material carry its descriptor.

        Raises:
          ValidationError: a material was set for ground that does not exist.
        """
        regions = list(self.regions)
        for where, material in self._worn:
            hit = [k for k, r in enumerate(self.regions) if _is_at(r, where)]
            if not hit:
                raise ValidationError(f"wear: found no ground at {where!r}; needed a kind or a place of this scene.")
            regions[hit[0]] = dataclasses.replace(regions[hit[0]], descriptor=_ground_descriptor(material))
        return tuple(regions)

    def _camera_path(self) -> list[tuple[float, float, float, float]]:
        """Returns the trajectory at eye level, a point every 5 m, yaw along it."""
        path = []
        for a, b in itertools.pairwise(self.trajectory):
            steps = max(1, round(math.dist(a, b) / 5.0))
            yaw = round(math.atan2(b[1] - a[1], b[0] - a[0]), 3)
            for i in range(steps):
                x, y = (a[k] + (b[k] - a[k]) * i / steps for k in (0, 1))
                path.append((round(x, 3), round(y, 3), round(self.ground_height(x, y) + CAMERA_HEIGHT, 3), yaw))
        return path


def _is_at(region: GroundRegion, where: str | Corner) -> bool:
    if isinstance(where, str):
        return region.kind == where
    return region.kind not in PAINT_KINDS and shapely.Polygon(region.polygon).intersects(shapely.Point(where))


def _ground_descriptor(material: str) -> tuple[int, ...]:
    if "/" in material:
        return appearance_search.ground_descriptor(
            appearance_search.StoredSheet("ground_thumbnails.jpg").load([material])[0]
        )
    return appearance_search.ground_descriptor(build_material(material).texture)


def sky_descriptor(uid: str) -> tuple[int, ...]:
    """The descriptor of a sky, a uid of `assets.appearances.sky_maps`."""
    # Skies are ranked by the part that a street camera sees: the lower half of the upper half.
    image = appearance_search.StoredSheet("sky_thumbnails.jpg").load([uid])[0]
    half = image.shape[0] // 2
    return appearance_search.sky_descriptor(image[half // 2 : half])
