"""Small streets of boxes, wedges and cylinders, built by the real packing core."""

import dataclasses

import numpy as np

from urbanverse_mjx.datatypes import AssetMesh, GroundRegion, SceneBank
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.scene import ground, maps
from urbanverse_mjx.scene.bank import pack
from urbanverse_mjx.scene.geometry import EpisodeTable, SceneGeometry
from urbanverse_mjx.scene.hulls import convex_part

LENGTH, HALF_WIDTH, KERB_Y, KERB = 60.0, 8.0, 4.0, 0.15
#: Of the materials: below, between and above the robots' own.
_FRICTION = {"road": 0.65, "crosswalk": 0.35, "sidewalk": 0.75}


@dataclasses.dataclass(frozen=True)
class PlainSky:
    radiance: np.ndarray
    sun_direction: np.ndarray
    sun_irradiance: np.ndarray


def box_skies() -> dict[str, PlainSky]:
    """A clear sky with a sun and a grey one without."""
    rows = np.linspace(0, 1, 32)[:, None, None]
    clear = np.where(rows < 0.5, 0.3 + 0.8 * rows, 0.15) * np.array([0.6, 0.8, 1.0]) * np.ones((1, 64, 1))
    grey = np.where(rows < 0.5, 0.8, 0.15) * np.ones((1, 64, 3))
    sun = np.array([0.4, -0.3, 0.866])
    return {
        "clear": PlainSky(clear.astype(np.float32), sun / np.linalg.norm(sun), np.array([2.5, 2.4, 2.2])),
        "grey": PlainSky(grey.astype(np.float32), np.array([0.0, 0.0, 1.0]), np.zeros(3)),
    }


def street_regions() -> list[GroundRegion]:
    """Flat road, a crossing with ramps at x 28-32, sidewalks in several pieces, one seam askew."""
    regions = []

    def add(name: str, kind: str, polygon: list[tuple[float, float]], plane: tuple[float, float, float]) -> None:
        regions.append(GroundRegion(name, kind, tuple(polygon), plane))

    def box(x0: float, y0: float, x1: float, y1: float) -> list[tuple[float, float]]:
        return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]

    add("road_west", "road", box(0, -KERB_Y, 28, KERB_Y), (0.0, 0.0, 0.0))
    add("crossing", "crosswalk", box(28, -KERB_Y, 32, KERB_Y), (0.0, 0.0, 0.0))
    add("road_east", "road", box(32, -KERB_Y, LENGTH, KERB_Y), (0.0, 0.0, 0.0))
    ramp = 1.5
    for side, sign in (("left", 1.0), ("right", -1.0)):
        k, r, w = sign * KERB_Y, sign * (KERB_Y + ramp), sign * HALF_WIDTH
        add(f"walk_{side}_a", "sidewalk", [(0, k), (9.5, k), (10.5, w), (0, w)], (0.0, 0.0, KERB))
        hook = [(9.5, k), (28, k), (28, r), (32, r), (32, w), (10.5, w)]
        add(f"walk_{side}_b", "sidewalk", hook, (0.0, 0.0, KERB))
        add(f"ramp_{side}", "sidewalk", box(28, k, 32, r), (0.0, sign * KERB / ramp, -KERB / ramp * KERB_Y))
        add(f"walk_{side}_c", "sidewalk", box(32, k, 45, w), (0.0, 0.0, KERB))
        add(f"walk_{side}_d", "sidewalk", box(45, k, LENGTH, w), (0.0, 0.0, KERB))
    return regions


def _solid(rng: np.random.Generator) -> tuple[str, np.ndarray]:
    """A box, wedge or cylinder, origin at the centre of its footprint."""
    size = rng.uniform([0.15, 0.15, 0.2], [1.6, 1.2, 2.0])
    kind = ("box", "wedge", "cylinder")[rng.integers(3)]
    if kind == "cylinder":
        angle = np.arange(12) * np.pi / 6
        ring = np.column_stack([np.cos(angle), np.sin(angle)]) / 2
    else:
        ring = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
    top = ring * ([0.3, 1.0] if kind == "wedge" else [1.0, 1.0])
    unit = np.concatenate([np.column_stack([ring, np.zeros(len(ring))]), np.column_stack([top, np.ones(len(ring))])])
    return kind, (unit * size).astype(np.float32)


def _checks(colour: np.ndarray, size: int = 32) -> np.ndarray:
    board = (np.indices((size, size)) // 8).sum(0) % 2
    return np.where(board[..., None], colour, colour * 0.6).astype(np.uint8)


def _mesh(corners: np.ndarray, rng: np.random.Generator) -> AssetMesh:
    """The solid's own triangles, flat shaded, checks of 0.25 m."""
    part = convex_part(corners)
    vertices = part.corners[part.triangles].reshape(-1, 3)
    normals = np.repeat(part.planes[:, :3], 3, 0)
    axis = np.abs(normals).argmax(1)
    uv = np.stack(
        [np.where(axis == 0, vertices[:, 1], vertices[:, 0]), np.where(axis == 2, vertices[:, 1], vertices[:, 2])]
    )
    texture = _checks(rng.uniform(40, 250, 3))
    return AssetMesh(vertices, np.arange(len(vertices)).reshape(-1, 3), uv.T / 0.25 / 4, texture, 0.8, 0.0)


_GROUND_COLOUR = {"road": (70, 70, 75), "crosswalk": (190, 190, 190), "sidewalk": (150, 140, 130)}


def ragged_regions(number: int, seed: int = 0) -> list[GroundRegion]:
    """Ground as videos give it: at x 22-27 the pavements beside a road are crooked pieces, some 25 cm wide."""
    rng, regions = np.random.default_rng([seed, number]), []
    step, road = 0.25, [(0.0, -KERB_Y), (LENGTH, -KERB_Y), (LENGTH, KERB_Y), (0.0, KERB_Y)]
    regions.append(GroundRegion("road", "road", tuple(road), (0.0, 0.0, 0.0)))
    x, y = np.arange(22.0, 27.0 + step / 2, step), KERB_Y + np.arange(0.0, 4.0 + step / 2, 2 * step)
    for side in (-1.0, 1.0):
        for end, (x0, x1) in {"west": (0.0, 22.0), "east": (27.0, LENGTH)}.items():
            ring = [(x0, side * KERB_Y), (x1, side * KERB_Y), (x1, side * HALF_WIDTH), (x0, side * HALF_WIDTH)]
            regions.append(GroundRegion(f"{end}_{side:+.0f}", "sidewalk", tuple(ring[:: int(side)]), (0.0, 0.0, KERB)))
        corners = np.stack(np.meshgrid(x, side * y, indexing="ij"), -1)
        corners[1:-1, 1:-1] += rng.uniform(-0.08, 0.08, corners[1:-1, 1:-1].shape)
        for i, j in np.ndindex(len(x) - 1, len(y) - 1):
            ring = corners[[i, i + 1, i + 1, i], [j, j, j + 1, j + 1]][:: int(side)]
            regions.append(
                GroundRegion(f"piece_{side:+.0f}_{i}_{j}", "sidewalk", tuple(map(tuple, ring)), (0.0, 0.0, KERB))
            )
    return regions


def box_scene(
    number: int, seed: int = 0, num_objects: int = 40, regions: list[GroundRegion] | None = None
) -> SceneGeometry:
    """One street on `street_regions` or others; `number` and `seed` select the objects and their places."""
    rng = np.random.default_rng([seed, number])
    regions = regions or street_regions()
    solids = [_solid(rng) for _ in range(num_objects)]
    x = np.sort(rng.uniform(1.0, LENGTH - 1.0, num_objects))
    y = rng.uniform(KERB_Y + 0.4, HALF_WIDTH - 0.4, num_objects) * rng.choice([-1, 1], num_objects)
    y = np.where(rng.random(num_objects) < 0.2, rng.uniform(-3.5, 3.5, num_objects), y)
    scene_map = maps.ground_map(regions)
    i, j = np.floor((np.column_stack([x, y]) - scene_map.origin) / scene_map.resolution).astype(int).T
    z = scene_map.height[i, j]
    yaw = rng.uniform(-np.pi, np.pi, num_objects)
    prisms = ground.ground_prisms(regions)
    visuals = [
        ground.region_mesh(r, _checks(np.array(_GROUND_COLOUR[r.kind]) * np.array([1.0, 0.97, 0.95])), 2.0, 0.9)
        for r in regions
    ]
    return SceneGeometry(
        scene_id=f"box_{seed}_{number}",
        object_ids=tuple(f"object_{k}" for k in range(num_objects)),
        object_categories=tuple(kind for kind, _ in solids),
        object_position=np.column_stack([x, y, z]),
        object_quaternion=rotations.from_yaw(yaw),
        object_mesh=np.arange(num_objects, dtype=np.int32),
        object_mass=rng.uniform(5.0, 200.0, num_objects),
        object_friction=rng.uniform(0.5, 1.0, num_objects),
        object_movable=rng.random(num_objects) < 0.5,
        hulls=(*(c for _, c in solids), *(p.corners for p in prisms)),
        inst_hull=np.arange(num_objects, dtype=np.int32),
        inst_object=np.arange(num_objects, dtype=np.int32),
        prism_hull=num_objects + np.arange(len(prisms), dtype=np.int32),
        prism_position=np.stack([p.position for p in prisms]),
        prism_kind=np.array([ground.kind_index(regions[p.region]) for p in prisms], np.int32),
        prism_friction=np.full(len(prisms), 1.0),
        prism_region=np.array([p.region for p in prisms], np.int32),
        prism_material_friction=np.array([_FRICTION[regions[p.region].kind] for p in prisms]),
        region_ids=tuple(r.id for r in regions),
        region_kind=np.array([ground.kind_index(r) for r in regions], np.int32),
        region_mesh=num_objects + np.arange(len(regions), dtype=np.int32),
        region_position=np.stack([p for p, _ in visuals]),
        meshes=(*(_mesh(c, rng) for _, c in solids), *(m for _, m in visuals)),
        sky=("clear", "grey")[number % 2],
        sky_yaw=float(rng.uniform(-np.pi, np.pi)),
        map=scene_map,
        episodes=_episodes(rng, np.column_stack([x, y])),
    )


def _episodes(rng: np.random.Generator, objects: np.ndarray, rows: int = 32) -> EpisodeTable:
    """Straight drives of 10-26 m along a sidewalk; starts and goals keep 1.4 m from every object's centre."""
    starts, goals = [], []
    while len(starts) < rows:
        y = rng.choice([-1, 1]) * 6.5
        x = rng.uniform(1.0, LENGTH - 1.0)
        goal = x + rng.choice([-1, 1]) * rng.uniform(10.0, 26.0)
        ends = np.array([[x, y], [goal, y]])
        apart = np.linalg.norm(ends[:, None] - objects[None], axis=-1).min() if len(objects) else np.inf
        if 1.0 <= goal <= LENGTH - 1.0 and apart > 1.4:
            starts.append([x, y, KERB, 0.0 if goal > x else np.pi])
            goals.append([goal, y, KERB])
    start, goal = np.array(starts), np.array(goals)
    length = np.linalg.norm(goal - start[:, :3], axis=1)
    number = np.ceil(length / 5.0).astype(np.int32)
    steps = np.minimum(5.0 * np.arange(1, number.max() + 1)[None], length[:, None]) / length[:, None]
    waypoints = start[:, None, :3] + steps[..., None] * (goal - start[:, :3])[:, None]
    no = np.zeros(rows, bool)
    return EpisodeTable(start, goal, waypoints, number, length, no, no, np.full(rows, -1.0))


def box_scenes(num_scenes: int, seed: int = 0, num_objects: int = 40) -> list[SceneGeometry]:
    return [box_scene(i, seed, num_objects) for i in range(num_scenes)]


def box_bank(num_scenes: int, seed: int = 0, num_objects: int = 40) -> SceneBank:
    """Bank of `box_scenes`; the last scene is of the test split where there are several."""
    scenes = box_scenes(num_scenes, seed, num_objects)
    splits = ["train"] * max(num_scenes - 1, 1) + ["test"] * (num_scenes > 1)
    return pack(scenes, splits, box_skies())
