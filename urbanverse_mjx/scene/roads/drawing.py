"""Visual meshes of what lies on the ground of a scene: see `draw_roads`."""

import dataclasses
import functools
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from ...assets.appearances import noise
from ...assets.appearances.ground_materials import build_material
from ...datatypes import AssetMesh, PlacedGround
from ..ground import plane_height
from . import images
from .markings import GUTTER, Mark, Parked, Roads, find_roads, marks
from .rules import RoadRules

#: m, side of the squares in which meshes are cut: a ray enters the trees of all meshes whose boxes it meets, and would
#: meet those of nearly all meshes if they lay along the whole street.
CELL = 12.0
Cell = tuple[int, int]
#: m above the ground: what was laid earlier lies lower.
LIFTS = {
    "track": 0.001, "seam": 0.0015, "patch": 0.002, "pale patch": 0.002, "gutter": 0.0025, "kerb": 0.003,
    "tactile": 0.003, "cover": 0.003, "bed": 0.002, "steel": 0.0055, "groove": 0.0055,
}  # fmt: skip
PAINT_LIFT = 0.004
#: Ground is at least this rough: a smoother one mirrors the sky's few pixels as bands and discs.
LEAST_ROUGHNESS = 0.65
#: Paint on the material of the road: sRGB colour and the share by which it covers; worn paint lets the road through.
PAINTS: dict[str, tuple[tuple[float, float, float], float]] = {
    "white": ((0.86, 0.86, 0.84), 1.0),
    "yellow": ((0.84, 0.62, 0.14), 1.0),
    "blue": ((0.16, 0.36, 0.66), 1.0),
    "track": ((0.16, 0.16, 0.16), 0.13),
    "patch": ((0.15, 0.15, 0.155), 0.5),
    "pale patch": ((0.52, 0.52, 0.51), 0.35),
    "seam": ((0.08, 0.08, 0.08), 0.75),
    "bed": ((0.60, 0.59, 0.57), 0.85),
    "steel": ((0.52, 0.51, 0.50), 1.0),
    "groove": ((0.07, 0.07, 0.07), 1.0),
}
#: Paints that wear off.
_WORN = ("white", "yellow", "blue")
#: Words in the id of a material: roads that carry paint, and those whose paint snow or mud hides.
_CARRY, _HIDDEN = ("asphalt", "concrete", "lane_"), ("snow", "icy", "mud")
#: m, width of kerb stones and of paving for the blind, and heights below which a border has no kerb face.
_KERB, _TACTILE, _FLUSH = 0.15, 0.6, 0.02
#: m between covers in the road, and between gullies along a kerb; their sizes.
_COVERS, _GULLIES, _COVER, _GULLY = 24.0, 18.0, 0.32, (0.42, 0.30)


@dataclasses.dataclass(frozen=True)
class Drawn:
    """A visual mesh on the ground.

    Attributes:
      id: unique in the scene.
      kind: kind of ground as which it is labelled, or "building".
      position: (3,) m, origin of its frame (without rotation).
      mesh: in that frame.
    """

    id: str
    kind: str
    position: np.ndarray
    mesh: AssetMesh


def crosswalk_materials(regions: Sequence[PlacedGround]) -> dict[str, str]:
    """Id of each crosswalk -> material of the nearest road, on which its bars are drawn."""
    roads = [r for r in regions if r.kind == "road"]
    if not roads:
        return {}
    shapes = [shapely.Polygon(r.polygon) for r in roads]
    found = {}
    for region in regions:
        if region.kind == "crosswalk":
            shape = shapely.Polygon(region.polygon).buffer(0.1)
            shared = [shape.intersection(s).area - 1e-6 * shape.distance(s) for s in shapes]
            found[region.id] = roads[int(np.argmax(shared))].material
    return found


def draw_roads(
    regions: Sequence[PlacedGround],
    crossings: Mapping[str, str],
    parked: Sequence[Parked],
    rules: RoadRules,
    seed: str,
) -> list[Drawn]:
    """Draws markings, kerb stones, gutters, covers, patches and rails.

    Args:
      regions: the ground of a scene.
      crossings: material of the road by the id of a crosswalk, see `crosswalk_materials`.
      parked: its vehicles.
      rules: of its country.
      seed: decides where covers and patches are.

    Returns:
      meshes millimetres above the ground, and kerb faces between road and pavement. In each square of `CELL` m there is
      one per kind of ground, and paint and material or image, with one texture.
    """
    roads, rng = find_roads(regions), noise.generator(f"roads/{seed}")
    if roads.carriageway.is_empty:
        return []
    carriers = [(r, crossings.get(r.id, r.material)) for r in regions if r.kind in ("road", "crosswalk")]
    drawn = _painted(carriers, marks(roads, rules, parked, rng), rules)
    pads = _Pads()
    _borders(pads, regions, roads, rules, rng)
    _covers(pads, carriers, roads, rng)
    return [*drawn, *pads.drawn()]


# On the road's material -----------------------------------------------------------------------------------------------


def _painted(carriers: Sequence[tuple[PlacedGround, str]], found: Sequence[Mark], rules: RoadRules) -> list[Drawn]:
    groups: dict[tuple[str, str, str, Cell], list[np.ndarray]] = {}
    shapes = np.array([m.shape.simplify(0.004) for m in found], dtype=object)
    for region, material in carriers:
        if any(word in material for word in _HIDDEN):
            continue
        for cell, piece in cells(shapely.Polygon(region.polygon)):
            for mark, shape in zip(found, shapely.intersection(shapes, piece), strict=True):
                if shape.is_empty or not _carries(mark, material):
                    continue
                corners = triangles(shape)
                if len(corners):
                    z = plane_height(region.plane, corners) + LIFTS.get(mark.paint, PAINT_LIFT)
                    groups.setdefault((mark.paint, mark.kind, material, cell), []).append(np.dstack([corners, z]))
    drawn = []
    for (paint, kind, material, cell), parts in sorted(groups.items(), key=lambda item: item[0]):
        ground = build_material(material)
        corners = np.concatenate(parts).reshape(-1, 3)
        texture, roughness = _coat(material, paint, rules.wear)
        name = _name(paint, kind, material, cell)
        drawn.append(drawn_mesh(name, kind, corners, corners[:, :2] / ground.tile_size_m, texture, roughness))
    return drawn


def cells(piece: BaseGeometry, side: float = CELL) -> Iterator[tuple[Cell, BaseGeometry]]:
    """The parts of a geometry in squares of `side` m, with the numbers of each square."""
    if piece.is_empty:
        return
    x0, y0, x1, y1 = np.floor(np.array(piece.bounds) / side).astype(int)
    for i in range(x0, x1 + 1):
        for j in range(y0, y1 + 1):
            part = piece.intersection(shapely.box(i * side, j * side, (i + 1) * side, (j + 1) * side))
            if part.area > 1e-4:
                yield (i, j), part


def _name(*parts: object) -> str:
    return "/".join(["drawn", *(str(part).replace(" ", "") for part in parts)])


def _carries(mark: Mark, material: str) -> bool:
    """Setts, bricks and earth carry no lines, only the bars of crosswalks and rails."""
    smooth = any(word in material for word in _CARRY)
    return smooth or mark.kind == "crosswalk" or mark.paint in ("steel", "groove")


def triangles(shape: BaseGeometry) -> np.ndarray:
    """(n, 3, 2) counter-clockwise triangles of the polygons of a geometry."""
    polygons = [p for p in shapely.get_parts(shape) if isinstance(p, shapely.Polygon) and p.area > 1e-4]
    found = [t for p in polygons for t in shapely.get_parts(shapely.constrained_delaunay_triangles(p))]
    if not found:
        return np.zeros((0, 3, 2))
    corners = np.array([shapely.get_coordinates(t)[:3] for t in found])
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    turned = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] < 0
    corners[turned] = corners[turned][:, ::-1]
    return corners


@functools.lru_cache(maxsize=8)
def _coat(material: str, paint: str, wear: float) -> tuple[np.ndarray, float]:
    """Texture and roughness of a paint on a material; the material shows where paint is worn off."""
    ground = build_material(material)
    colour, cover = PAINTS[paint]
    base = ground.texture.astype(np.float64) / 255.0
    light = base.mean(-1)
    grain = 1.0 + 0.35 * np.clip(light / max(float(light.mean()), 1e-3) - 1.0, -0.5, 0.5)
    share = np.full(light.shape, cover)
    if paint in _WORN:
        rng = noise.generator(f"wear/{ground.id}/{paint}")
        blotch = noise.periodic_noise(rng, len(light), 1.7, 2.0) + 0.5 * noise.periodic_noise(rng, len(light), 0.6)
        gone = np.quantile(blotch, min(0.75 * wear, 0.75))
        share = np.clip(0.5 + (blotch - gone) / 0.5, 0.12, 1.0 - 0.25 * wear)
    mixed = base * (1 - share)[..., None] + np.asarray(colour) * (grain * share)[..., None]
    texture = np.round(np.clip(mixed, 0.0, 1.0) * 255).astype(np.uint8)
    return texture, 0.4 if paint == "steel" else max(ground.roughness, LEAST_ROUGHNESS)


def drawn_mesh(
    name: str, kind: str, corners: np.ndarray, uv: np.ndarray, texture: np.ndarray, roughness: float
) -> Drawn:
    """A mesh of triangles (3n, 3) without shared corners; its frame lies on the ground's raster."""
    position = np.round(np.append((corners.min(0) + corners.max(0))[:2] / 2, corners[:, 2].min()) * 64) / 64
    repeat = -(-4 // (len(corners) // 3))  # a mesh has at least four faces
    if repeat > 1:
        corners, uv = np.tile(corners, (repeat, 1)), np.tile(uv, (repeat, 1))
    faces = np.arange(len(corners)).reshape(-1, 3)
    uv = uv - np.floor(uv.min(0))
    mesh = AssetMesh(corners - position, faces, uv, texture, roughness=roughness, metallic=0.0)
    return Drawn(name, kind, position, mesh)


# Kerbs, gutters, covers -----------------------------------------------------------------------------------------------


class _Pads:
    """Quads with images of their own, collected by image."""

    def __init__(self) -> None:
        self._parts: dict[tuple[str, str, Cell], list[np.ndarray]] = {}

    def add(self, image: str, kind: str, corners: np.ndarray, uv: np.ndarray) -> None:
        """Adds a quad: corners (4, 3) counter-clockwise seen from outside, uv (4, 2)."""
        order = [0, 1, 2, 0, 2, 3]
        i, j = np.floor(corners[:, :2].mean(0) / CELL).astype(int).tolist()
        self._parts.setdefault((image, kind, (i, j)), []).append(np.concatenate([corners, uv], 1)[order])

    def drawn(self) -> list[Drawn]:
        found = []
        for (image, kind, cell), parts in sorted(self._parts.items(), key=lambda item: item[0]):
            rows = np.concatenate(parts)
            name = _name(image, kind, cell)
            texture, roughness = images.paint_image(image)
            found.append(drawn_mesh(name, kind, rows[:, :3], rows[:, 3:], texture, roughness))
        return found


def _borders(
    pads: _Pads, regions: Sequence[PlacedGround], roads: Roads, rules: RoadRules, rng: np.random.Generator
) -> None:
    """Kerb stones, gutters, gullies and paving for the blind along the borders of the carriageway."""
    near = roads.carriageway.buffer(0.04)
    solid = [r for r in regions if r.kind in ("road", "crosswalk")]
    tree = shapely.STRtree([shapely.Polygon(r.polygon) for r in solid])
    crossings = shapely.union_all([c.shape for c in roads.crossings]).buffer(0.1) if roads.crossings else None
    for region in regions:
        if region.kind not in ("sidewalk", "ground"):
            continue
        ring = shapely.Polygon(region.polygon)
        shared = ring.exterior.intersection(near)
        if shared.length < 0.3:
            continue
        for line in _lines_of(shapely.segmentize(shared, CELL / 2)):
            along = np.cumsum(np.concatenate([[0.0], np.linalg.norm(np.diff(line, axis=0), axis=1)]))
            next_gully = along[0] + rng.uniform(2.0, _GULLIES)
            for a, b, s0, s1 in zip(line[:-1], line[1:], along[:-1], along[1:], strict=True):
                if s1 - s0 < 0.05:
                    continue
                # The ring runs counter-clockwise, so the region lies to the left of its border.
                step = (b - a) / (s1 - s0)
                inward = np.array([-step[1], step[0]])
                road = solid[int(tree.nearest(shapely.Point((a + b) / 2 - 0.05 * inward)))]
                _kerb(pads, region, road, (a, b), (s0, s1), inward, rules)
                flush = abs(_z(region, (a + b) / 2) - _z(road, (a + b) / 2)) < _FLUSH
                if rules.gutter != "none" and road.kind == "road" and not flush:
                    _flat(pads, f"{rules.gutter} gutter", "road", road, (b, a), (s1, s0), -inward, GUTTER, "gutter")
                    while next_gully < s1:
                        if next_gully > s0 + 0.3:
                            _gully(pads, road, a + step * (next_gully - s0), step, -inward)
                        next_gully += _GULLIES
                if rules.tactile and flush and crossings is not None:
                    if crossings.distance(shapely.Point((a + b) / 2)) < 0.2 and s1 - s0 > 0.4:
                        _flat(
                            pads, f"{rules.tactile} tactile", region.kind, region, (a, b), (s0, s1), inward,
                            _TACTILE, "tactile", start=_KERB,
                        )  # fmt: skip


def _lines_of(shape: BaseGeometry) -> list[np.ndarray]:
    """(n, 2) polylines of at least 0.2 m; those that touch are joined."""
    lines = [p for p in shapely.get_parts(shape) if isinstance(p, shapely.LineString)]
    merged = shapely.line_merge(shapely.multilinestrings(lines), directed=True) if lines else shapely.LineString()
    return [shapely.get_coordinates(p) for p in shapely.get_parts(merged) if p.length > 0.2]


def _z(region: PlacedGround, xy: np.ndarray) -> float:
    return float(plane_height(region.plane, xy))


def _flat(
    pads: _Pads, image: str, kind: str, region: PlacedGround, ends: tuple[np.ndarray, np.ndarray],
    spans: tuple[float, float], inward: np.ndarray, width: float, lift: str, start: float = 0.0,
) -> None:  # fmt: skip
    """A strip of a region along its border a -> b, from `start` to start + width m to its left."""
    a, b = ends
    flat = np.stack(
        [a + start * inward, b + start * inward, b + (start + width) * inward, a + (start + width) * inward]
    )
    corners = np.column_stack([flat, plane_height(region.plane, flat) + LIFTS[lift]])
    length = images.LENGTHS[image]
    u = np.array([spans[0], spans[1], spans[1], spans[0]]) / length
    v = np.array([0.0, 0.0, width, width]) / images.WIDTHS.get(image, width)
    pads.add(image, kind, corners, np.stack([u, v], -1))


def _kerb(
    pads: _Pads, region: PlacedGround, road: PlacedGround, ends: tuple[np.ndarray, np.ndarray],
    spans: tuple[float, float], inward: np.ndarray, rules: RoadRules,
) -> None:  # fmt: skip
    """The top of the stones, and their face down to the road."""
    image = f"{rules.kerb} kerb"
    _flat(pads, image, region.kind, region, ends, spans, inward, _KERB, "kerb")
    a, b = (e - 0.004 * inward for e in ends)
    top = [_z(region, e) + LIFTS["kerb"] for e in ends]
    low = [_z(road, e) for e in ends]
    if max(t - z for t, z in zip(top, low, strict=True)) < _FLUSH:
        return
    corners = np.array([[*a, low[0]], [*b, low[1]], [*b, top[1]], [*a, top[0]]])
    u = np.array([spans[0], spans[1], spans[1], spans[0]]) / images.LENGTHS[image]
    pads.add(image, region.kind, corners, np.stack([u, [0, 0, 1, 1]], -1))


def _gully(pads: _Pads, road: PlacedGround, at: np.ndarray, step: np.ndarray, inward: np.ndarray) -> None:
    long, wide = _GULLY
    flat = np.array([at, at - step * long, at - step * long + inward * wide, at + inward * wide])
    corners = np.column_stack([flat, plane_height(road.plane, flat) + LIFTS["cover"]])
    pads.add("gully", "road", corners, np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]))


def _covers(pads: _Pads, carriers: Sequence[tuple[PlacedGround, str]], roads: Roads, rng: np.random.Generator) -> None:
    """Covers of manholes in the middle of the lanes."""
    shapes = [shapely.Polygon(r.polygon) for r, _ in carriers if r.kind == "road"]
    pieces = [r for r, _ in carriers if r.kind == "road"]
    for axis in roads.axes:
        for s in np.arange(rng.uniform(4.0, 12.0), axis.length - 3.0, _COVERS):
            at = axis.points(s + rng.uniform(-4.0, 4.0), float(rng.choice((-0.5, 0.5))) * axis.half_at(s))
            inside = [
                r for r, shape in zip(pieces, shapes, strict=True) if shape.buffer(-0.6).contains(shapely.Point(at))
            ]
            if inside:
                disc = [(_COVER * np.cos(t), _COVER * np.sin(t)) for t in np.arange(8) * np.pi / 4]
                for k in (0, 2, 4):  # an octagon of three quads
                    quad = np.array([disc[0], disc[k + 1], disc[k + 2], disc[(k + 3) % 8]])
                    flat = at + quad
                    corners = np.column_stack([flat, plane_height(inside[0].plane, flat) + LIFTS["cover"]])
                    pads.add("cover", "road", corners, 0.5 + quad / (2 * _COVER))
