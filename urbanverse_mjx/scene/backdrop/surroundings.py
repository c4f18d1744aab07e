"""The ground behind the houses of a scene and beyond its ends, and rows of fronts that close the view."""

import itertools
from collections.abc import Callable, Sequence

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from ...assets.appearances import noise
from ...assets.appearances.ground_materials import build_material
from ...assets.recipes.building.regional.styles import Form
from ...datatypes import PlacedGround
from ..ground import plane_height
from ..roads.drawing import LEAST_ROUGHNESS, Drawn, cells, drawn_mesh, triangles
from . import images
from .ends import KIND
from .houses import House, looks_of

#: m from the ground and the houses of a scene to the fronts around it; gaps up to twice `CLOSED` m are passed by.
REACH, CLOSED = 9.0, 8.0
#: m: mean width of a front, and its least; depth of the block behind it.
WIDTH, LEAST_WIDTH, DEPTH = 9.0, 3.0, 5.0
#: m by which the ground around a scene lies below its border and reaches under it.
SUNK, UNDER = 0.03, 0.12
#: m, side of the squares in which fronts and ground are cut.
CELL = 36.0
#: m, shortest and longest end of a road that goes on; longer ones are its sides.
MOUTH = (2.0, 13.0)
#: rad, turn that parts the end of a road from its sides.
CORNER = 0.4
#: Fronts of a scene's image along its sides.
ACROSS, DOWN = 4, 2


def surround(
    regions: Sequence[PlacedGround], houses: Sequence[House], place: tuple[str, str], seed: str
) -> list[Drawn]:
    """Draws the ground around a scene and fronts of the place's tradition along its edge, each once per square of
    `CELL` m.

    Args:
      regions: the ground of the scene.
      houses: its houses.
      place: (city, country).
      seed: decides which fronts stand where.
    """
    laid = [(r, shapely.Polygon(r.polygon)) for r in regions]
    ground = shapely.union_all([shape for _, shape in laid], grid_size=1e-3)
    built = shapely.union_all([h.footprint for h in houses]) if houses else shapely.Polygon()
    edge = outline(ground, built)
    height = floor_of(laid)
    rng = noise.generator(f"surroundings/{seed}")
    return [*_ground(laid, ground, edge, height), *_fronts(edge, height, houses, place, rng)]


def outline(ground: BaseGeometry, built: BaseGeometry) -> BaseGeometry:
    """The line on which the fronts stand, as polygons around everything."""
    whole = ground.union(built)
    wide = whole.buffer(REACH + CLOSED, quad_segs=2).buffer(-CLOSED, quad_segs=2)
    parts = [shapely.Polygon(p.exterior) for p in shapely.get_parts(wide)]
    return shapely.union_all(parts).simplify(2.0).buffer(0)


def floor_of(laid: Sequence[tuple[PlacedGround, shapely.Polygon]]) -> Callable[[np.ndarray], np.ndarray]:
    """Function that returns the height, m, of the nearest ground's border (n,) for points (n, 2)."""
    tree = shapely.STRtree([shape for _, shape in laid])

    def height(points: np.ndarray) -> np.ndarray:
        found = np.empty(len(points))
        numbers = np.asarray(tree.nearest(np.asarray(shapely.points(points)))).tolist()
        for k, (point, number) in enumerate(zip(points, numbers, strict=True)):
            region, shape = laid[number]
            near = shapely.get_coordinates(shapely.shortest_line(shape, shapely.Point(point)))[0]
            found[k] = plane_height(region.plane, near)
        return found

    return height


def _ground(
    laid: Sequence[tuple[PlacedGround, shapely.Polygon]],
    ground: BaseGeometry,
    edge: BaseGeometry,
    height: Callable[[np.ndarray], np.ndarray],
) -> list[Drawn]:
    """The ground between a scene and the fronts around it: its roads go on, the rest is as most of its border."""
    free = edge.buffer(1.0).difference(ground.buffer(-UNDER).simplify(0.05))
    rim = ground.boundary
    shares: dict[tuple[str, str], float] = {}
    mouths = []
    for region, shape in laid:
        shared = shape.exterior.intersection(rim.buffer(0.02))
        if region.kind == "road":
            mouths += [(line, region.material) for line in _lines(shared)]
        elif region.kind in ("sidewalk", "ground"):
            key = (region.kind, region.material)
            shares[key] = shares.get(key, 0.0) + shared.length
    pieces: list[tuple[str, str, BaseGeometry]] = []
    for line, material in mouths:
        piece = line.buffer(REACH + 3.0, cap_style="flat").intersection(free)
        free = free.difference(piece)
        pieces.append(("road", material, piece))
    if shares:
        kind, material = max(sorted(shares), key=lambda key: shares[key])
        pieces.append((kind, material, free))
    found = []
    for number, (kind, material, piece) in enumerate(pieces):
        look = build_material(material)
        for cell, part in cells(piece, CELL):
            corners = triangles(part.simplify(0.02))
            if not len(corners):
                continue
            flat = corners.reshape(-1, 2)
            points = np.column_stack([flat, height(flat) - SUNK])
            name = f"drawn/around/{number}/{cell}".replace(" ", "")
            rough = max(look.roughness, LEAST_ROUGHNESS)
            found.append(drawn_mesh(name, kind, points, flat / look.tile_size_m, look.texture, rough))
    return found


def _lines(shape: BaseGeometry) -> list[shapely.LineString]:
    """The straight ends of a road among the pieces of its border."""
    lines = [p for p in shapely.get_parts(shape) if isinstance(p, shapely.LineString)]
    merged = shapely.line_merge(shapely.multilinestrings(lines)) if lines else shapely.LineString()
    ends = []
    for line in shapely.get_parts(merged):
        points = shapely.get_coordinates(line.simplify(0.1))
        steps = np.diff(points, axis=0)
        turns = np.abs(np.angle(np.exp(1j * np.diff(np.arctan2(steps[:, 1], steps[:, 0])))))
        bounds = [0, *(np.flatnonzero(turns > CORNER) + 1), len(points) - 1]
        for first, last in itertools.pairwise(bounds):
            if MOUTH[0] < np.linalg.norm(points[last] - points[first]) < MOUTH[1]:
                ends.append(shapely.LineString([points[first], points[last]]))
    return ends


# Fronts ---------------------------------------------------------------------------------------------------------------


def _fronts(
    edge: BaseGeometry,
    height: Callable[[np.ndarray], np.ndarray],
    houses: Sequence[House],
    place: tuple[str, str],
    rng: np.random.Generator,
) -> list[Drawn]:
    forms, language = looks_of(place)
    sizes = [(form, size, k) for form in forms for k, size in enumerate(form.sizes)]
    usual = _usual_height(houses)
    tall = [abs(np.log(images.height_of(f, int(s[1])) / usual)) for f, s, _ in sizes]
    near = [sizes[i] for i in np.argsort(tall, kind="stable")[: max(4, len(sizes) // 2)]]
    picked = [near[i] for i in rng.permutation(len(near))[: ACROSS * DOWN]]
    side = images.FRONT
    texture = np.full((DOWN * side, ACROSS * side, 3), 128, np.uint8)
    for k, (form, size, dressing) in enumerate(picked):
        i, j = (side * part for part in divmod(k, ACROSS))
        texture[i : i + side, j : j + side] = images.front(form, size, dressing, language, rng)
    parts: dict[tuple[int, int], list[np.ndarray]] = {}
    last = -1
    for part in shapely.get_parts(edge):
        ring = shapely.get_coordinates(shapely.geometry.polygon.orient(part).exterior)
        for start, end in itertools.pairwise(ring):
            length = float(np.linalg.norm(end - start))
            count = max(1, round(length / WIDTH)) if length > LEAST_WIDTH else 1
            for k in range(count):
                number = int(rng.integers(len(picked)))
                number = (number + 1) % len(picked) if number == last else number
                last = number
                a, b = (start + (end - start) * (k + step) / count for step in (0, 1))
                form, size, _ = picked[number]
                stretch = float(rng.uniform(0.88, 1.1))
                rows = _front(a, b, float(height(np.array([a, b])).min()), form, size, number, stretch)
                i, j = np.floor((a + b) / 2 / CELL).astype(int).tolist()
                parts.setdefault((i, j), []).append(rows)
    found = []
    for cell, rows in sorted(parts.items()):
        rows = np.concatenate(rows)
        name = f"drawn/fronts/{cell}".replace(" ", "")
        found.append(drawn_mesh(name, KIND, rows[:, :3], rows[:, 3:], texture, 0.85))
    return found


def _usual_height(houses: Sequence[House]) -> float:
    """m, median height of the houses; two storeys without any."""
    return float(np.median([h.mesh.vertices[:, 2].max() for h in houses])) if houses else 6.0


def _front(
    a: np.ndarray, b: np.ndarray, z: float, form: Form, size: tuple[float, int], number: int, stretch: float
) -> np.ndarray:
    """(3n, 5) corners and texture coordinates of a block whose front from a to b faces to the left of that direction.

    Args:
      z: m, of the ground; stretch: of its height; number: of its image.
    """
    step = (b - a) / max(float(np.linalg.norm(b - a)), 1e-9)
    out = np.array([step[1], -step[0]]) * DEPTH
    low, high = z - 0.3, z + images.height_of(form, int(size[1])) * stretch
    rise = min(form.rise, 2.5) if form.roof in images.PITCHED else 0.0
    row, column = divmod(number, ACROSS)
    u0, u1 = column / ACROSS, (column + 1) / ACROSS
    v0 = 1.0 - (row + 1) / DOWN
    eaves = v0 + (1.0 - images.ROOF / images.FRONT) / DOWN
    v1 = v0 + 1.0 / DOWN - 0.01
    wall = (u0 + 0.004, u0 + 0.012)  # beside the windows
    quads = [
        [(*b, low, u0, v0), (*a, low, u1, v0), (*a, high, u1, eaves), (*b, high, u0, eaves)],
        _side(a, a + out, low, high, wall, (v0, eaves)),
        _side(b + out, b, low, high, wall, (v0, eaves)),
    ]
    if rise:
        ridge_a, ridge_b, top = a + out / 2, b + out / 2, high + rise
        quads.append(
            [
                (*b, high, u0, eaves + 0.01),
                (*a, high, u1, eaves + 0.01),
                (*ridge_a, top, u1, v1),
                (*ridge_b, top, u0, v1),
            ]
        )
        for near, far, ridge in ((a, a + out, ridge_a), (b + out, b, ridge_b)):
            tip = (*ridge, top, wall[1], eaves)
            quads.append([(*near, high, wall[0], eaves), (*far, high, wall[1], eaves), tip, tip])
    rows = np.array(quads, np.float64)
    split = rows[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3, 5)
    flat = np.linalg.norm(np.cross(split[:, 1, :3] - split[:, 0, :3], split[:, 2, :3] - split[:, 0, :3]), axis=1) < 1e-6
    return split[~flat].reshape(-1, 5)


def _side(
    near: np.ndarray, far: np.ndarray, low: float, high: float, u: tuple[float, float], v: tuple[float, float]
) -> list[tuple[float, ...]]:
    """A side wall from its left to its right edge, seen from outside."""
    return [(*near, low, u[0], v[0]), (*far, low, u[1], v[0]), (*far, high, u[1], v[1]), (*near, high, u[0], v[1])]
