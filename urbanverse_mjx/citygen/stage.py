"""`Stage`: ground, objects and object placement, shared by procedural and hand-made streets."""

import math
import random
from collections.abc import Iterable, Mapping, Sequence

import shapely
import shapely.ops

from ..datatypes import GraphObject, GroundRegion, Source
from ..datatypes.ground import PAINT_KINDS, height_at
from . import catalogue, clearance

JOINT = 0.01  # m between two house fronts, so that rounding to millimetres never makes them overlap


class Stage:
    """Collects the regions and objects of one scene.

    Args:
      scene_id: id of the graph to be.
      seed: seed of the stage's random stream.
      sizes: available sizes of each label, (along, across, up) m.
    """

    #: No part of the scene was filmed.
    source = Source(video="synthetic", licence="Apache-2.0", city="none", country="none")

    def __init__(
        self, scene_id: str, seed: int, sizes: Mapping[str, tuple[catalogue.Size, ...]] = catalogue.SIZES
    ) -> None:
        self.scene_id = scene_id
        self.sizes = sizes
        self.regions: list[GroundRegion] = []
        self.objects: list[GraphObject] = []
        self._planes: list[tuple[shapely.Polygon, tuple[float, float, float]]] = []
        self._random = random.Random(seed)
        self._counts: dict[str, int] = {}

    def uniform(self, low: float, high: float) -> float:
        """Returns a number from the stage's seeded stream; only `random()` is stable over Python versions."""
        return low + (high - low) * self._random.random()

    def lay(self, regions: Iterable[GroundRegion]) -> None:
        """Adds regions of ground or paint."""
        regions = list(regions)
        self.regions.extend(regions)
        self._planes += [(shapely.Polygon(r.polygon), r.plane) for r in regions if r.kind not in PAINT_KINDS]
        for ring, _ in self._planes:
            shapely.prepare(ring)

    def on_ground(self, shape: shapely.Geometry) -> bool:
        """Returns whether any part of a shape is over solid ground."""
        return any(ring.intersects(shape) for ring, _ in self._planes)

    def ground_height(self, x: float, y: float) -> float:
        """Returns z (m) of the ground's top at a point: the highest where regions meet, the nearest region's beyond the
        edge."""
        point = shapely.Point(x, y)
        heights = [height_at(plane, x, y) for ring, plane in self._planes if ring.intersects(point)]
        if heights:
            return max(heights)
        ring, plane = min(self._planes, key=lambda entry: entry[0].distance(point))
        near = shapely.ops.nearest_points(ring, point)[0]
        return height_at(plane, near.x, near.y)

    def _number(self, label: str) -> int:
        return self._counts.get(label, 0)

    def next_size(self, label: str) -> catalogue.Size:
        """Returns the size for the next object of a label."""
        sizes = self.sizes[label]
        return sizes[self._number(label) % len(sizes)]

    def make(
        self,
        label: str,
        x: float,
        y: float,
        degrees: float,
        size: catalogue.Size | None = None,
        above: float = 0.0,
    ) -> GraphObject:
        """Returns an object for `add` with its stem, or its middle where it has none, `above` (m) the ground at (x,
        y)."""
        along, across, up = size or self.next_size(label)
        z = self.ground_height(x, y) + above + up / 2
        stem = catalogue.STEMS.get(label)
        if stem:
            ahead, angle = stem.offset * along / 2, math.radians(degrees)
            x, y = x - ahead * math.cos(angle), y - ahead * math.sin(angle)
        name = f"{label.replace(' ', '_')}_{self._number(label):02d}"
        center = (round(x, 3), round(y, 3), round(z, 4))
        return GraphObject(name, label, center, (along, across, up), clearance.heading(degrees))

    def add(self, obj: GraphObject) -> GraphObject:
        self._counts[obj.label] = self._number(obj.label) + 1
        self.objects.append(obj)
        return obj

    def frontages(self, labels: Sequence[str], length: float) -> list[catalogue.Size]:
        """Returns depth, frontage and height (m) of each house, with the frontages stretched to fill a length
        together."""
        counts: dict[str, int] = {}
        sizes = []
        for label in labels:
            options = self.sizes[label]
            sizes.append(options[(self._number(label) + counts.get(label, 0)) % len(options)])
            counts[label] = counts.get(label, 0) + 1
        stretch = length / sum(size[1] for size in sizes)
        return [(depth, width * stretch, height) for depth, width, height in sizes]
