"""Generates training terrain for locomotion as a scene bank: flat ground, kerbs, stairs, slopes and rough ground by
level of difficulty.

In:   a seed.
Out:  `SceneGeometry` of each kind and level; `SceneBank` of all.
When: once, before training; it needs no asset.

The ground consists of the same planar prisms as that of a street, so both engines and C MuJoCo support it. Kerbs run
straight across a scene along y, where the boxes around the prisms are tight; robots start with any heading and
therefore meet them at any angle.
"""

import dataclasses
from collections.abc import Callable, Iterator

import numpy as np

from ..datatypes import GroundRegion, SceneBank
from ..datatypes import validation as v
from . import ground, maps
from .bank import pack
from .geometry import EpisodeTable, SceneGeometry

KINDS = ("flat", "kerbs", "stairs", "slopes", "rough")
#: Levels of difficulty of each kind.
LEVELS = 10
#: m, side of a scene.
SCENE_SIDE = 20.0
#: Least and greatest height of a kerb (m), rise of a stair (m), slope, unevenness of rough ground (m), tilt of its
#: pieces.
KERB_HEIGHT, STEP_RISE = (0.03, 0.22), (0.03, 0.17)
SLOPE_GRADE = (0.08, 0.45)  # the steepest is 24 degrees; a wheelchair ramp is 0.083
ROUGH_HEIGHT, ROUGH_GRADE = (0.01, 0.07), (0.02, 0.15)
#: m; no training kerb has the height of a test kerb within `TEST_KERB_MARGIN`.
TEST_KERBS, TEST_KERB_MARGIN = (0.05, 0.08, 0.10, 0.12, 0.15, 0.18, 0.20), 0.003
#: Least height of a kerb as a share of its level's height.
MIN_KERB_SHARE = 0.7
STEP_TREAD = (0.30, 0.38)  # m, as stairs out of doors have it
KERB_SPACING, SLOPE_LENGTH, LANDING_LENGTH = (1.0, 2.5), (1.5, 3.0), (1.0, 1.6)  # m
STEPS_PER_FLIGHT = 4  # steps of a flight
ROUGH_PIECE_SIDE = (0.6, 1.2)  # m, of rough ground
#: Friction of rubber on concrete; environments scale it.
FRICTION = 0.8
_IMAGE_PERIOD = 1.0  # m, a repetition of the image

#: A strip of ground: its length along x (m), and its heights (m) at its beginning and end.
Strip = tuple[float, float, float]


@dataclasses.dataclass(frozen=True)
class _Overcast:
    """A uniform grey sky without sun; see `scene.geometry.Sky`."""

    radiance: np.ndarray = dataclasses.field(default_factory=lambda: np.full((16, 32, 3), 0.8, np.float32))
    sun_direction: np.ndarray = dataclasses.field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    sun_irradiance: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros(3))


def _at(span: tuple[float, float], difficulty: float) -> float:
    return span[0] + (span[1] - span[0]) * difficulty


def _kerb_height(rng: np.random.Generator, difficulty: float) -> float:
    """m, random height of a kerb; never a height that is reserved for tests."""
    high = _at(KERB_HEIGHT, difficulty)
    while True:
        height = rng.uniform(MIN_KERB_SHARE * high, high)
        if np.abs(height - np.array(TEST_KERBS)).min() > TEST_KERB_MARGIN:
            return float(height)


def _flat(rng: np.random.Generator, difficulty: float) -> Iterator[Strip]:
    del rng, difficulty
    yield SCENE_SIDE, 0.0, 0.0


def _kerbs(rng: np.random.Generator, difficulty: float) -> Iterator[Strip]:
    climbed: list[float] = []
    while True:
        height = sum(climbed)
        yield rng.uniform(*KERB_SPACING), height, height
        # Steps up from the street, then down or up again; every edge is a kerb of random height.
        if not climbed or (len(climbed) == 1 and rng.random() < 0.3):
            climbed.append(_kerb_height(rng, difficulty))
        else:
            climbed.pop()


def _stairs(rng: np.random.Generator, difficulty: float) -> Iterator[Strip]:
    rise, height = _at(STEP_RISE, difficulty), 0.0
    while True:
        yield rng.uniform(*LANDING_LENGTH), height, height
        sign, tread = (1.0 if height == 0.0 else -1.0), rng.uniform(*STEP_TREAD)
        for step in range(STEPS_PER_FLIGHT):
            height += sign * rise
            if step < STEPS_PER_FLIGHT - 1:
                yield tread, height, height
        height = max(round(height, 6), 0.0)


def _slopes(rng: np.random.Generator, difficulty: float) -> Iterator[Strip]:
    slope = _at(SLOPE_GRADE, difficulty)
    while True:
        yield rng.uniform(*LANDING_LENGTH), 0.0, 0.0
        length = rng.uniform(*SLOPE_LENGTH)
        yield length, 0.0, slope * length
        yield rng.uniform(*LANDING_LENGTH), slope * length, slope * length
        yield length, slope * length, 0.0


_STRIPS: dict[str, Callable[[np.random.Generator, float], Iterator[Strip]]] = {
    "flat": _flat,
    "kerbs": _kerbs,
    "stairs": _stairs,
    "slopes": _slopes,
}


def _rectangle(
    number: int, low: tuple[float, float], high: tuple[float, float], slope: tuple[float, float], height: float
) -> GroundRegion:
    """The rectangle low..high (m in x, y) with the top height + slope · ((x, y) - low)."""
    polygon = (low, (high[0], low[1]), high, (low[0], high[1]))
    offset = height - slope[0] * low[0] - slope[1] * low[1]
    return GroundRegion(f"piece_{number}", "sidewalk", polygon, (*slope, offset))


def strips_regions(strips: Iterator[Strip], side: float = SCENE_SIDE) -> list[GroundRegion]:
    """Regions of a square of `side` m about the origin that is filled with strips along x."""
    regions: list[GroundRegion] = []
    x, half = -0.5 * side, 0.5 * side
    while x < half - 1e-6:
        length, begin, end = next(strips)
        last = x + length if x + length < half - 0.2 else half
        slope = (end - begin) / length
        regions.append(_rectangle(len(regions), (x, -half), (last, half), (slope, 0.0), begin))
        x = last
    return regions


def _rough_regions(rng: np.random.Generator, difficulty: float) -> list[GroundRegion]:
    """Pieces like unevenly laid slabs, each with a random height and tilt."""
    half, unevenness, tilt = 0.5 * SCENE_SIDE, _at(ROUGH_HEIGHT, difficulty), _at(ROUGH_GRADE, difficulty)
    rows, columns = round(SCENE_SIDE / ROUGH_PIECE_SIDE[0]), round(SCENE_SIDE / ROUGH_PIECE_SIDE[1])
    xs, ys = (np.linspace(-half, half, n + 1).tolist() for n in (rows, columns))
    regions: list[GroundRegion] = []
    for i in range(rows):
        for j in range(columns):
            sx, sy = rng.uniform(-tilt, tilt, 2).tolist()
            # The piece is tilted about its centre; the height is that of its lower corner.
            height = rng.uniform(0.0, unevenness) - 0.5 * (sx * ROUGH_PIECE_SIDE[0] + sy * ROUGH_PIECE_SIDE[1])
            corners = (xs[i], ys[j]), (xs[i + 1], ys[j + 1])
            regions.append(_rectangle(len(regions), *corners, (sx, sy), height))
    return regions


def terrain_regions(kind: str, level: int, seed: int = 0) -> list[GroundRegion]:
    """The ground of one scene.

    Raises:
      ValidationError: the kind or level does not exist.
    """
    v.choice(kind, "terrain kind", KINDS)
    v.integer(level, "terrain level", 0, LEVELS - 1)
    rng = np.random.default_rng([seed, KINDS.index(kind), level])
    difficulty = level / (LEVELS - 1)
    if kind == "rough":
        return _rough_regions(rng, difficulty)
    return strips_regions(_STRIPS[kind](rng, difficulty))


def _image() -> np.ndarray:
    """(32, 32, 3) u8, a grey checkerboard, which makes the robot's motion visible."""
    board = (np.indices((32, 32)) // 16).sum(0) % 2
    return np.where(board[..., None], 150, 125).astype(np.uint8) * np.ones(3, np.uint8)


def region_scene(name: str, regions: list[GroundRegion], friction: float = FRICTION) -> SceneGeometry:
    """A scene that has only ground; its single episode leads 1 m along x from the centre."""
    prisms, scene_map = ground.ground_prisms(regions), maps.ground_map(regions)
    visuals = [ground.region_mesh(r, _image(), _IMAGE_PERIOD, 0.9) for r in regions]
    i, j = scene_map.grid.cell(np.zeros(2))
    start = np.array([[0.0, 0.0, scene_map.height[i, j], 0.0]])
    goal, no, none = start[:, :3] + np.array([1.0, 0.0, 0.0]), np.zeros(1, bool), np.zeros(0, np.int32)
    return SceneGeometry(
        scene_id=name,
        object_ids=(),
        object_categories=(),
        object_position=np.zeros((0, 3)),
        object_quaternion=np.zeros((0, 4)),
        object_mesh=none,
        object_mass=np.zeros(0),
        object_friction=np.zeros(0),
        object_movable=np.zeros(0, bool),
        hulls=tuple(p.corners for p in prisms),
        inst_hull=none,
        inst_object=none,
        prism_hull=np.arange(len(prisms), dtype=np.int32),
        prism_position=np.stack([p.position for p in prisms]),
        prism_kind=np.array([ground.kind_index(regions[p.region]) for p in prisms], np.int32),
        prism_friction=np.full(len(prisms), friction),
        prism_region=np.array([p.region for p in prisms], np.int32),
        prism_material_friction=np.full(len(prisms), friction),
        region_ids=tuple(r.id for r in regions),
        region_kind=np.array([ground.kind_index(r) for r in regions], np.int32),
        region_mesh=np.arange(len(regions), dtype=np.int32),
        region_position=np.stack([p for p, _ in visuals]),
        meshes=tuple(m for _, m in visuals),
        sky="overcast",
        sky_yaw=0.0,
        map=scene_map,
        episodes=EpisodeTable(start, goal, goal[:, None], np.ones(1, np.int32), np.ones(1), ~no, no, np.full(1, -1.0)),
    )


def pack_regions(scenes: list[SceneGeometry]) -> SceneBank:
    """Packs scenes that `region_scene` made into a bank."""
    return pack(scenes, ["train"] * len(scenes), {"overcast": _Overcast()})


def terrain_bank(seed: int = 0, levels: int = LEVELS) -> SceneBank:
    """Makes the bank for locomotion training: the first `levels` levels of all kinds, with scene ids
    "<kind>-<level>"."""
    v.integer(levels, "terrain levels", 1, LEVELS)
    names = [(kind, level) for kind in KINDS for level in range(levels)]
    return pack_regions([region_scene(f"{k}-{n}", terrain_regions(k, n, seed)) for k, n in names])
