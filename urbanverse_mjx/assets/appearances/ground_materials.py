"""Ground materials: seamless 256x256 textures with a known size in metres.

UV on the ground is in metres divided by `tile_size_m`, u along the driving direction (+x of a scene unless the
compiler turns it), v to its left. So crosswalk stripes, which run along the driving direction, are rows of constant v.
"""

import dataclasses
import functools
from collections.abc import Callable

import numpy as np

from ...datatypes import validation as v
from . import ground_patterns as p
from . import grounds, noise
from .ground_patterns import SIZE


@dataclasses.dataclass(frozen=True)
class GroundMaterial:
    """The appearance of a piece of ground.

    Attributes:
      id, description: for search and matching.
      kind: one of `ground.GROUND_KINDS` except "none".
      texture: (256, 256, 3) uint8 sRGB, wraps around in both directions.
      tile_size_m: m covered by one tile.
      roughness: in [0, 1].
    """

    id: str
    description: str
    kind: str
    texture: np.ndarray
    tile_size_m: float
    roughness: float


_Recipe = Callable[[np.random.Generator], np.ndarray]
#: id: (kind, tile size in m, roughness, description, recipe)
_MATERIALS: dict[str, tuple[str, float, float, str, _Recipe]] = {}


def _material(
    material_id: str, kind: str, tile_size_m: float, roughness: float, description: str
) -> Callable[[_Recipe], _Recipe]:
    def register(recipe: _Recipe) -> _Recipe:
        _MATERIALS[material_id] = (kind, tile_size_m, roughness, description, recipe)
        return recipe

    return register


# Road surfaces. Albedo: new asphalt 0.05, worn 0.12-0.18, concrete 0.25-0.4 (linear); the numbers below are sRGB.


@_material("asphalt_new", "road", 3.0, 0.85, "fresh dark asphalt")
def _(rng: np.random.Generator) -> np.ndarray:
    return p.asphalt(rng, 0.24, 0.06, 0.05)


@_material("asphalt_old", "road", 4.0, 0.9, "old grey asphalt with fine cracks")
def _(rng: np.random.Generator) -> np.ndarray:
    image = p.asphalt(rng, 0.43, 0.10, 0.06)
    return p.mix(image, (0.22, 0.22, 0.22), p.crack(rng, 5, 0.7) * 0.8)


@_material("asphalt_patched", "road", 10.0, 0.9, "worn asphalt with darker repair patches and tar joints")
def _(rng: np.random.Generator) -> np.ndarray:
    image = p.asphalt(rng, 0.38, 0.08, 0.05)
    patch = p.asphalt(rng, 0.31, 0.06, 0.04)
    y, x = np.mgrid[0:SIZE, 0:SIZE]
    edge = noise.periodic_noise(rng, SIZE, 2.0, 4.0) * 1.5
    for left, top, width, height in ((30, 40, 70, 34), (160, 150, 30, 62)):
        inside = np.minimum.reduce([x - left, left + width - x, y - top, top + height - y]) + edge
        image = p.mix(image, patch, np.clip(inside, 0, 1))
        image = p.mix(image, (0.12, 0.12, 0.12), np.clip(1.2 - np.abs(inside), 0, 1) * 0.6)
    return p.mix(image, (0.22, 0.22, 0.22), p.crack(rng, 3, 0.6) * 0.7)


@_material("asphalt_light", "road", 3.5, 0.9, "light coarse asphalt with pale chippings")
def _(rng: np.random.Generator) -> np.ndarray:
    return p.asphalt(rng, 0.50, 0.28, 0.04, (1.02, 1.0, 0.96))


@_material("asphalt_wet", "road", 4.0, 0.35, "damp dark asphalt after rain")
def _(rng: np.random.Generator) -> np.ndarray:
    image = p.asphalt(rng, 0.20, 0.05, 0.10, (0.97, 1.0, 1.06))
    puddle = noise.periodic_noise(rng, SIZE, 3.4, 2.0)
    return p.mix(image, image * 0.72, np.clip((puddle - 0.6) * 2, 0, 1))


@_material("concrete_road", "road", 5.0, 0.85, "pale concrete slabs with sealed joints")
def _(rng: np.random.Generator) -> np.ndarray:
    image = p.slabs(rng, 1, 1, (0.60, 0.585, 0.55), 0.0, (0.2, 0.2, 0.2), 2.0, 0.0, 0.05)
    return p.mix(image, (0.42, 0.41, 0.39), p.crack(rng, 1, 0.7) * 0.6)


@_material("cobble_grey", "road", 2.0, 0.8, "grey granite cobblestones")
def _(rng: np.random.Generator) -> np.ndarray:
    return p.paved(rng, p.setts(rng, 16, 12, 1.8), (0.47, 0.46, 0.45), 0.16, (0.6, 0.06), (0.24, 0.22, 0.2), 0.9)


@_material("brick_road", "road", 2.0, 0.85, "red clinker bricks laid across the road")
def _(rng: np.random.Generator) -> np.ndarray:
    return p.paved(rng, p.bricks(rng, 10, 20, 1.3), (0.50, 0.30, 0.24), 0.16, (0.8, 0.06), (0.33, 0.28, 0.25), 0.9)


# Sidewalks.


@_material("slabs_grey", "sidewalk", 2.0, 0.85, "grey rectangular paving slabs in running bond")
def _(rng: np.random.Generator) -> np.ndarray:
    return p.slabs(rng, 4, 2, (0.62, 0.61, 0.59), 0.06)


@_material("slabs_warm", "sidewalk", 2.4, 0.8, "large beige sandstone slabs")
def _(rng: np.random.Generator) -> np.ndarray:
    return p.slabs(rng, 3, 2, (0.72, 0.65, 0.54), 0.08, (0.42, 0.37, 0.3), 1.4, 0.37)


@_material("concrete_squares", "sidewalk", 3.0, 0.85, "broomed concrete in squares of a metre and a half")
def _(rng: np.random.Generator) -> np.ndarray:
    image = p.slabs(rng, 2, 2, (0.66, 0.655, 0.63), 0.025, (0.38, 0.37, 0.35), 1.8, 0.0, 0.06)
    return p.mix(image, (0.45, 0.44, 0.42), p.crack(rng, 1, 0.6) * 0.5)


@_material("concrete_tiles_small", "sidewalk", 1.6, 0.85, "small square concrete tiles")
def _(rng: np.random.Generator) -> np.ndarray:
    return p.slabs(rng, 4, 4, (0.58, 0.585, 0.58), 0.09, (0.3, 0.3, 0.29), 1.6, 0.0)


@_material("brick_herringbone", "sidewalk", 1.6, 0.85, "red bricks in herringbone")
def _(rng: np.random.Generator) -> np.ndarray:
    return p.paved(rng, p.herringbone(rng, 16, 1.1), (0.60, 0.36, 0.29), 0.14, (0.8, 0.05), (0.62, 0.56, 0.48), 0.75)


@_material("herringbone_grey", "sidewalk", 1.6, 0.85, "grey concrete blocks in herringbone")
def _(rng: np.random.Generator) -> np.ndarray:
    return p.paved(rng, p.herringbone(rng, 16, 1.0), (0.56, 0.55, 0.54), 0.11, (0.8, 0.05), (0.3, 0.29, 0.28), 0.8)


@_material("brick_running", "sidewalk", 1.8, 0.85, "brown bricks in running bond")
def _(rng: np.random.Generator) -> np.ndarray:
    return p.paved(rng, p.bricks(rng, 16, 8, 1.2), (0.52, 0.40, 0.33), 0.17, (0.8, 0.05), (0.35, 0.32, 0.29), 0.85)


@_material("granite_setts", "sidewalk", 1.5, 0.8, "small granite setts in wavy courses")
def _(rng: np.random.Generator) -> np.ndarray:
    return p.paved(rng, p.setts(rng, 16, 16, 1.8), (0.60, 0.585, 0.57), 0.15, (0.4, 0.07), (0.36, 0.34, 0.31), 0.9)


@_material("mosaic_two_tone", "sidewalk", 2.4, 0.75, "white limestone mosaic with dark basalt waves")
def _(rng: np.random.Generator) -> np.ndarray:
    joint, value, _ = p.stones(rng, 420, 1.5)
    y, x = np.mgrid[0:SIZE, 0:SIZE] / SIZE
    wave = np.sin(2 * np.pi * (2 * y + 0.22 * np.sin(2 * np.pi * x))) > 0.35
    image = p.mix(p.tone((0.80, 0.78, 0.73), value * 0.06), p.tone((0.28, 0.28, 0.29), value * 0.1), wave * 1.0)
    return p.mix(image, (0.45, 0.43, 0.4), joint * 0.7)


@_material("flagstones", "sidewalk", 3.0, 0.8, "irregular flagstones")
def _(rng: np.random.Generator) -> np.ndarray:
    joint, value, _ = p.stones(rng, 26, 3.0)
    image = p.tone((0.57, 0.55, 0.51), value * 0.13, noise.periodic_noise(rng, SIZE, 1.6, 3.0) * 0.05)
    return p.mix(image, (0.33, 0.31, 0.28), joint * 0.85)


@_material("tactile_yellow", "sidewalk", 2.4, 0.8, "grey slabs with a strip of yellow tactile paving")
def _(rng: np.random.Generator) -> np.ndarray:
    image = p.slabs(rng, 8, 8, (0.60, 0.60, 0.59), 0.05, (0.33, 0.33, 0.32), 1.4, 0.0)
    y, x = np.mgrid[0:SIZE, 0:SIZE] + 0.5
    strip = p.slabs(rng, 8, 8, (0.86, 0.68, 0.16), 0.04, (0.5, 0.4, 0.12), 1.4, 0.0)
    dome = np.hypot((x % 8.0) - 4.0, (y % 8.0) - 4.0)
    strip = strip * (1.0 + 0.16 * np.clip(2.6 - dome, 0, 1) - 0.2 * np.clip(1.2 - np.abs(dome - 3.2), 0, 1))[..., None]
    return p.mix(image, strip, ((y >= 96) & (y < 128)) * 1.0)


@_material("asphalt_walk", "sidewalk", 3.0, 0.9, "fine smooth asphalt footway")
def _(rng: np.random.Generator) -> np.ndarray:
    return p.asphalt(rng, 0.36, 0.03, 0.05)


@_material("terracotta_checks", "sidewalk", 1.6, 0.8, "reddish square terracotta tiles, diagonal checks")
def _(rng: np.random.Generator) -> np.ndarray:
    y, x = np.mgrid[0:SIZE, 0:SIZE] / SIZE
    a, b = (x + y) * 4, (x - y) * 4
    dark = (np.floor(a) + np.floor(b)) % 2 == 0
    gap = np.minimum(p.to_nearest(a % 1.0), p.to_nearest(b % 1.0)) * SIZE / 4 / np.sqrt(2)
    image = p.mix(p.tone((0.68, 0.44, 0.33)), p.tone((0.58, 0.36, 0.28)), dark * 1.0)
    dirt = noise.periodic_noise(rng, SIZE, 0.8) * 0.04 + noise.periodic_noise(rng, SIZE, 2.4, 2.0) * 0.04
    image = image * (1 + dirt)[..., None]
    return p.mix(image, (0.4, 0.3, 0.25), np.clip(1.7 - gap, 0, 1) * 0.8)


# Crosswalks: stripes half a metre wide (Vienna Convention's range 0.4-0.6 m).


@_material("zebra_new", "crosswalk", 2.0, 0.8, "fresh white zebra stripes on dark asphalt")
def _(rng: np.random.Generator) -> np.ndarray:
    return p.zebra(rng, p.asphalt(rng, 0.26, 0.06, 0.04), (0.93, 0.93, 0.91), 0.02, 2)


@_material("zebra_worn", "crosswalk", 2.0, 0.85, "worn white zebra stripes on grey asphalt")
def _(rng: np.random.Generator) -> np.ndarray:
    return p.zebra(rng, p.asphalt(rng, 0.40, 0.09, 0.05), (0.86, 0.86, 0.84), 0.3, 2)


@_material("zebra_yellow", "crosswalk", 2.0, 0.8, "yellow zebra stripes on asphalt")
def _(rng: np.random.Generator) -> np.ndarray:
    return p.zebra(rng, p.asphalt(rng, 0.33, 0.07, 0.05), (0.88, 0.70, 0.20), 0.1, 2)


@_material("zebra_red", "crosswalk", 2.0, 0.85, "white stripes on a red-painted crossing")
def _(rng: np.random.Generator) -> np.ndarray:
    return p.zebra(rng, p.asphalt(rng, 0.5, 0.0, 0.05, (1.0, 0.46, 0.38)), (0.92, 0.92, 0.9), 0.06, 2)


# Other ground.


@_material("grass", "ground", 3.0, 1.0, "mown green grass")
def _(rng: np.random.Generator) -> np.ndarray:
    blades = noise.periodic_noise(rng, SIZE, 0.5) * 0.16
    image = p.tone((0.30, 0.43, 0.17), blades, noise.periodic_noise(rng, SIZE, 2.0, 3.0) * 0.10)
    return p.mix(image, (0.52, 0.52, 0.26), np.clip(noise.periodic_noise(rng, SIZE, 2.0, 3.0) - 0.8, 0, 1) * 0.5)


@_material("grass_dry", "ground", 3.0, 1.0, "dry yellowish grass with bare spots")
def _(rng: np.random.Generator) -> np.ndarray:
    image = p.tone((0.53, 0.50, 0.27), noise.periodic_noise(rng, SIZE, 0.5) * 0.15)
    bare = noise.periodic_noise(rng, SIZE, 2.2, 2.0)
    return p.mix(image, (0.47, 0.38, 0.27), np.clip(bare - 0.4, 0, 1) * 0.8)


@_material("gravel", "ground", 1.5, 1.0, "pale gravel")
def _(rng: np.random.Generator) -> np.ndarray:
    joint, value, dome = p.stones(rng, 700, 1.4)
    image = p.tone((0.60, 0.57, 0.52), value * 0.22, dome * 0.15 - 0.1)
    return p.mix(image, (0.30, 0.28, 0.25), joint * 0.7)


@_material("earth", "ground", 2.5, 1.0, "bare brown earth with pebbles")
def _(rng: np.random.Generator) -> np.ndarray:
    image = p.tone((0.43, 0.33, 0.24), noise.periodic_noise(rng, SIZE, 1.4) * 0.12)
    return p.mix(image, (0.60, 0.54, 0.46), p.speckle(rng, 0.03, 1.1) * 0.7)


@_material("plaza_tiles", "ground", 4.0, 0.6, "large polished plaza tiles in two greys")
def _(rng: np.random.Generator) -> np.ndarray:
    image = p.slabs(rng, 4, 4, (0.70, 0.69, 0.67), 0.03, (0.35, 0.35, 0.34), 1.0, 0.0, 0.03)
    y, x = np.mgrid[0:SIZE, 0:SIZE] // 64
    return image * np.where((x + y) % 2 == 0, 1.0, 0.8)[..., None]


# Paint.


@_material("paint_white", "road_marking", 1.0, 0.7, "white road paint")
def _(rng: np.random.Generator) -> np.ndarray:
    image = p.tone((0.90, 0.90, 0.88), noise.periodic_noise(rng, SIZE, 0.6) * 0.03)
    return p.mix(image, (0.5, 0.5, 0.5), np.clip(noise.periodic_noise(rng, SIZE, 1.0, 3.0) - 1.4, 0, 1))


@_material("paint_yellow", "road_marking", 1.0, 0.7, "yellow road paint")
def _(rng: np.random.Generator) -> np.ndarray:
    image = p.tone((0.88, 0.69, 0.17), noise.periodic_noise(rng, SIZE, 0.6) * 0.03)
    return p.mix(image, (0.45, 0.40, 0.28), np.clip(noise.periodic_noise(rng, SIZE, 1.0, 3.0) - 1.4, 0, 1))


def material_ids(kind: str) -> tuple[str, ...]:
    """Ids of the materials of a ground kind, in a fixed order.

    Raises:
      ValidationError: `kind` has no materials.
    """
    v.choice(kind, "ground kind", dict.fromkeys(entry[0] for entry in _MATERIALS.values()))
    return tuple(i for i, entry in _MATERIALS.items() if entry[0] == kind)


def _from_maps(uid: str) -> GroundMaterial:
    """A material of the large collection at the size that scenes use: its colour and its mean roughness."""
    maps = grounds.paint_ground(uid)
    finer = maps.albedo.shape[0] // SIZE
    texture = maps.albedo.reshape(SIZE, finer, SIZE, finer, 3).mean((1, 3))
    record, roughness = maps.record, float(maps.roughness.mean()) / 255.0
    return GroundMaterial(
        uid, record.description, record.kind, np.round(texture).astype(np.uint8), record.tile_size_m, roughness
    )


@functools.cache
def build_material(material_id: str) -> GroundMaterial:
    """Paints a material (about 0.1 s); the same id gives the same pixels.

    Args:
      material_id: one of `material_ids`, or the uid ("road/...", "sidewalk/...") of one of the 288 of `grounds`.

    Raises:
      ValidationError: no such material.
    """
    if material_id.startswith(("road/", "sidewalk/")):
        return _from_maps(material_id)
    v.choice(material_id, "ground material", _MATERIALS)
    kind, tile_size_m, roughness, description, recipe = _MATERIALS[material_id]
    image = recipe(noise.generator(f"ground/{material_id}"))
    texture = np.round(np.clip(image, 0.0, 1.0) * 255).astype(np.uint8)
    return GroundMaterial(material_id, description, kind, texture, tile_size_m, roughness)
