"""Streets of the scene library as training streets of the perception model.

Their objects are those of the layouts, without the shapes that are held out for the test streets, and with people on
the pavements: in the library those move, and are no part of a layout.
"""

import dataclasses
import math
import pathlib
from collections.abc import Sequence

import numpy as np
import shapely

from benchmarks.bank import coarser, map_stride
from urbanverse_mjx.assets import AssetIndex, load_index
from urbanverse_mjx.assets.meshes.instances import KEY
from urbanverse_mjx.datatypes import AssetRecord, PlacedGround, PlacedObject, SceneLayout, ValidationError
from urbanverse_mjx.materialisation.cousins import index_of
from urbanverse_mjx.scene import library
from urbanverse_mjx.scene.compiler import AssetSource, scene_geometry
from urbanverse_mjx.scene.geometry import EpisodeTable, SceneGeometry

#: Free distance (m) from an added object's middle to that of any other object, besides half of their sizes.
_APART = 0.4
_TRIES = 30
MAP_CELL = 0.25  # m; the map only gives camera positions

#: Added objects: kinds of ground, leaves, and the range of their number per 100 m of street.
PEOPLE = (
    ("sidewalk", "crosswalk", "ground"),
    (
        "pedestrian adult|pedestrian adult|pedestrian adult|pedestrian adult|pedestrian child|elderly person|jogger|"
        "delivery worker|police officer|construction worker|dog|stroller|wheelchair user|scooter|delivery robot|"
        "electric scooter rider|cyclist"
    ),
    (14, 30),
)
TRAFFIC = (
    ("road",),
    "sedan|suv|van|hatchback car|bus|truck|taxi|cyclist|cyclist|motorcycle rider|motorcycle rider|pickup truck",
    (3, 8),
)


def folders(name: str, count: int) -> list[pathlib.Path]:
    """Folders of `count` scenes of a set of the library, evenly spread over its scenes for training.

    Raises:
      ValidationError: the set has not been built, or has fewer.
    """
    root = library.folder(name) / library.SCENES
    known = library.scene_set(name)
    built = sorted(path for path in root.glob("*") if (path / "layout.json").is_file())
    found = [path for path in built if known.split_of(path.name) == "train"]
    if len(found) < count:
        raise ValidationError(
            f"--library: found {len(found)} training scenes of {name!r} in {root}, needed {count}; "
            f"build them with `urbanverse scene library {name}`."
        )
    return [found[k * len(found) // count] for k in range(count)]


def make(folder: pathlib.Path, kept: AssetIndex, source: AssetSource) -> tuple[SceneGeometry, str, str]:
    """A library street as geometry without collision hulls, with its name and content hash.

    Args:
      kept: the training split's records; objects of other base shapes of the package are left out.
      source: makes meshes and hulls.
    """
    layout = SceneLayout.load(folder / "layout.json")
    index = index_of(layout)
    held_out = {r.uid for r in load_index().records} - {_base(r) for r in kept.records}
    records = {r.uid: r for r in index.records}
    objects = [o for o in layout.objects if _base(records[o.asset_uid]) not in held_out]
    rng = np.random.default_rng(int(layout.content_hash()[:15], 16))
    added, used = _added(layout.ground, objects, records, kept, rng)
    layout = dataclasses.replace(layout, objects=(*objects, *added))
    geometry = scene_geometry(layout, AssetIndex([*index.records, *used]), source)
    scene_map = coarser(geometry.map, map_stride(MAP_CELL))
    geometry = dataclasses.replace(geometry, map=scene_map, episodes=_episode(layout.ground))
    return geometry, layout.id, layout.content_hash()


def _base(record: AssetRecord) -> str:
    return str(record.params[KEY]["base"]) if KEY in record.params else record.uid


def _added(
    ground: Sequence[PlacedGround],
    objects: Sequence[PlacedObject],
    records: dict[str, AssetRecord],
    kept: AssetIndex,
    rng: np.random.Generator,
) -> tuple[list[PlacedObject], list[AssetRecord]]:
    """People and vehicles at random free places, and their records."""
    taken = [(*o.position[:2], max(records[o.asset_uid].extent_xyz[:2]) / 2) for o in objects]
    everything = shapely.union_all([shapely.Polygon(g.polygon) for g in ground])
    x0, y0, x1, y1 = everything.bounds
    share = max(x1 - x0, y1 - y0) / 100.0
    out: list[PlacedObject] = []
    used: dict[str, AssetRecord] = {}
    for kinds, leaves, (low, high) in (PEOPLE, TRAFFIC):
        regions = [g for g in ground if g.kind in kinds]
        if not regions:
            continue
        names = [leaf for leaf in leaves.split("|") if kept.by_leaf(leaf)]
        for _ in range(int(rng.integers(low, high + 1) * share)):
            options = kept.by_leaf(str(rng.choice(names)))
            record = options[int(rng.integers(len(options)))]
            place = _free_place(regions, taken, max(record.extent_xyz[:2]) / 2, rng)
            if place is not None:
                taken.append((place[0], place[1], max(record.extent_xyz[:2]) / 2))
                used[record.uid] = record
                out.append(_object(record, len(out), place, float(rng.uniform(-math.pi, math.pi))))
    return out, [r for uid, r in used.items() if uid not in records]


def _free_place(
    regions: Sequence[PlacedGround],
    taken: Sequence[tuple[float, ...]],
    radius: float,
    rng: np.random.Generator,
) -> tuple[float, float, float] | None:
    """A point of the regions, at the height of the ground, away from all that is taken; None if none was found."""
    shapes = [shapely.Polygon(g.polygon) for g in regions]
    areas = np.array([s.area for s in shapes])
    others = np.array(taken).reshape(-1, 3)
    for _ in range(_TRIES):
        k = int(rng.choice(len(shapes), p=areas / areas.sum()))
        x0, y0, x1, y1 = shapes[k].bounds
        x, y = rng.uniform(x0, x1), rng.uniform(y0, y1)
        if not shapely.contains_xy(shapes[k], x, y):
            continue
        if (np.hypot(others[:, 0] - x, others[:, 1] - y) < others[:, 2] + radius + _APART).any():
            continue
        a, b, c = regions[k].plane
        return round(x, 3), round(y, 3), round(a * x + b * y + c, 4)
    return None


def _object(record: AssetRecord, number: int, place: tuple[float, float, float], yaw: float) -> PlacedObject:
    return PlacedObject(
        id=f"added_{number:03d}",
        label=record.leaf,
        category=record.leaf,
        asset_uid=record.uid,
        position=place,
        yaw=round(yaw, 3),
        scale=(1.0, 1.0, 1.0),
        mass=record.mass,
        friction=record.friction_coefficient,
        movable=False,
    )


def _episode(ground: Sequence[PlacedGround]) -> EpisodeTable:
    """One episode between two points of a region, because a bank needs one for every scene."""
    region = max(ground, key=lambda g: shapely.Polygon(g.polygon).area)
    ends = [shapely.Polygon(region.polygon).representative_point(), shapely.Polygon(region.polygon).centroid]
    (x0, y0), (x1, y1) = [(p.x, p.y) for p in ends]
    x1 += 1.0
    a, b, c = region.plane
    start, goal = np.array([[x0, y0, a * x0 + b * y0 + c, 0.0]]), np.array([[x1, y1, a * x1 + b * y1 + c]])
    length = np.hypot(x1 - x0, y1 - y0)
    no = np.zeros(1, bool)
    return EpisodeTable(start, goal, goal[None], np.ones(1, np.int32), np.array([length]), no, no, np.array([-1.0]))
