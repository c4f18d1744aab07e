"""Builds the training and test streets of the perception model, for rendering only, without collision hulls.

    python -m benchmarks.perception_streets --split train --layouts 256 --processes 16 --out perception_train.npz
    python -m benchmarks.perception_streets --split test --layouts 20 --out perception_test.npz

The two splits share no layout, no asset (the last variant of every leaf that has three or more is the test's), no sky
and, where a kind of ground has four materials or more, no material of it. The training streets also contain their
variants in further sizes, proportions and paints, as in the catalogue. Streets are shorter than the benchmark's and
more varied, with parks, front yards, lane markings, junctions, and all objects of the shipped streets. With `--kin`,
half of the objects of the training streets are of other leaves of the same group of the network's classes (a concrete
mixer for a truck), so that a class has more shapes; the frequencies of the classes stay. Prints one JSON line. The same
options give the same content hash, whatever the number of processes; with `--within` the streets that are made in that
time are kept.
"""

import argparse
import contextlib
import dataclasses
import functools
import itertools
import json
import pathlib
import sys
import time
from collections.abc import Generator, Sequence
from typing import Any

import numpy as np
import PIL.Image

from benchmarks.bank import coarser, map_stride
from benchmarks.lib import perception_library, shape_variation, streets
from urbanverse_mjx.assets import AssetIndex, load_index
from urbanverse_mjx.assets.appearances.ground_materials import material_ids
from urbanverse_mjx.assets.appearances.skies import build_sky, sky_ids
from urbanverse_mjx.assets.categories.ontology import category_of
from urbanverse_mjx.assets.meshes.instances import KEY, instance_params, place
from urbanverse_mjx.assets.meshes.tints import tints
from urbanverse_mjx.assets.records.index import build_mesh
from urbanverse_mjx.citygen import section
from urbanverse_mjx.datatypes import (
    AssetMesh,
    AssetRecord,
    GroundRegion,
    HullSet,
    SceneBank,
    SceneLayout,
    ValidationError,
)
from urbanverse_mjx.datatypes.hashing import content_hash
from urbanverse_mjx.distillation.perception_model.classes import HOUSE, class_of_leaf, groups
from urbanverse_mjx.process_pool import worker_pool
from urbanverse_mjx.scene.bank import pack
from urbanverse_mjx.scene.compiler import AssetSource, scene_geometry
from urbanverse_mjx.scene.geometry import EpisodeTable, SceneGeometry

SPLITS = ("train", "test")
#: One sky of each family: low sun, overcast, and clouds with sun.
TEST_SKIES = ("golden_hour", "overcast_grey", "partly_cloudy")
#: Layouts of the splits come from different seeds.
SEEDS = {"train": 11, "test": 12}
LENGTH = 70.0  # m; farther objects are a few pixels high from a camera at 1.5 m
#: Range of the number of objects, houses included; training streets are denser for more labels per image.
OBJECTS = {"train": (90, 140), "test": (70, 120)}
#: Number of instances added to the training variants of each leaf.
INSTANCES = 24
_ENDS: tuple[section.End, section.End] = ("court", "junction")
MAX_TEXTURE = 256
#: Share of the leaves of a training street that are replaced by `_kin`.
KIN_SHARE = 0.5
#: Share of the training instances that are deformed, and share of those that are made of two shapes.
DEFORMED, JOINED = 0.5, 0.45
MAP_CELL = 0.25  # m; the map only gives camera positions

HOUSES = (*streets.HOUSES, "school", "garage", "library", "post office", "bistro", "shoe store", "ice cream shop")
_MORE = {
    "kerb": (
        "traffic barricade|jersey barrier|fence|traffic light|utility pole|traffic sign|"
        "do not enter sign|speed limit sign 30 km|road work detour ahead sign|caution sign|bus shelter|sunshade|"
        "street light|lamppost|trash bin|dumpster|flower|street clock|water point|parcel locker|bench|garbage bag"
    ),
    "wall": (
        "kiosk|street food stall|telephone booth|sunshade|fountain|fence|flower|dumpster|bench|table|atm|"
        "cabinet or shelf|beach chair|bulletin board|information point|stone block|bicycle|barbecue grill|awning"
    ),
    "walk": (
        "cat|bird|construction worker|doctor|firefighter|gardener|maintenance worker|security guard|"
        "traffic controller|roller skater|wheelchair user|electric scooter rider|robot dog|humanoid robot|segway|"
        "pedestrian adult|pedestrian adult|pedestrian adult|pedestrian child"
    ),
    "road": (
        "bus|food truck|tricycle|car|coupe car|sports car|electric car|convertible car|ambulance|garbage truck|"
        "motorcycle|motorcycle rider|school bus|fire truck|camper|sedan|hatchback car|suv|van"
    ),
}


def of_split(split: str, index: AssetIndex, kin: bool = False) -> AssetIndex:
    """Returns the records of a split; the last variant of every leaf with three or more belongs to the test split.

    Leaves with fewer are in both, so that the test's streets hold the same kinds of objects. In training every leaf
    of the streets has `INSTANCES` of its variants besides; `kin`: the streets have leaves of `_kin`, too.
    """
    kept: list[AssetRecord] = []
    shown = shown_leaves()
    if kin:
        shown |= {leaf for name in shown for leaf in _kin(name)}
    for leaf in index.leaves:
        records = index.by_leaf(leaf)
        if len(records) >= 3:
            records = records[-1:] if split == "test" else records[:-1]
        kept += records
        if split == "train" and leaf in shown:
            kept += _instances(leaf, records)
    return AssetIndex(kept)


def _instances(leaf: str, bases: tuple[AssetRecord, ...]) -> list[AssetRecord]:
    """Other sizes, proportions and paints of base shapes, drawn as `assets.records.catalogue` draws its records."""
    uids = [f"{leaf.replace(' ', '-')}/eye/{k:02d}" for k in range(INSTANCES)]
    drawn = place(leaf, uids, np.array([r.extent_xyz for r in bases]))
    records = []
    for uid, base, extent, scale, tint in zip(uids, drawn.base, drawn.extent, drawn.scale, tints(uids), strict=True):
        shape = bases[base]
        params = instance_params(int(shape.params["variant"]), shape.uid, scale.tolist(), tint.tolist())
        records.append(dataclasses.replace(shape, uid=uid, extent_xyz=tuple(extent.tolist()), params=params))
    return records


def shown_leaves() -> frozenset[str]:
    """Returns all leaves that occur in a street of either split."""
    objects = (*HOUSES, *itertools.chain(*_leaves().values()))
    return frozenset(objects)


def _leaves() -> dict[str, tuple[str, ...]]:
    """Labels for each band."""
    return {band: (*names, *_MORE[band].split("|")) for band, names in streets.Stock().leaves.items()}


@functools.cache
def _kin(leaf: str) -> tuple[str, ...]:
    """The other leaves of a leaf's group that have shapes and are in no street of either split."""
    group = next((leaves for leaves in groups().values() if leaf in leaves), ())
    known, shown = frozenset(load_index().leaves), shown_leaves()
    return tuple(name for name in group if name in known and name not in shown)


def stock(split: str, kin: int | None = None) -> streets.Stock:
    """Objects of the streets of a split; `kin`: of the street of that number, where half of the leaves are replaced by
    one of their `_kin`."""
    skies = tuple(s for s in sky_ids() if (s in TEST_SKIES) == (split == "test"))
    rng = np.random.default_rng([SEEDS[split], 3, kin or 0])

    def drawn(leaf: str) -> str:
        others = _kin(leaf) if kin is not None else ()
        return str(rng.choice(others)) if others and rng.random() < KIN_SHARE else leaf

    houses, leaves = HOUSES, _leaves()
    houses, *bands = (tuple(drawn(leaf) for leaf in names) for names in (houses, *leaves.values()))
    by_band = dict(zip(leaves, bands, strict=True))
    return streets.Stock(houses, by_band, variants=INSTANCES + 8, skies=skies)


def materials_of(split: str, kind: str) -> tuple[str, ...]:
    """Ground materials of a split: the last quarter of a kind with four or more is the test's."""
    names = tuple(material_ids(kind))
    if len(names) < 4:
        return names
    held = len(names) // 4
    return names[-held:] if split == "test" else names[:-held]


def make_ground(split: str, number: int) -> streets.Ground:
    """Returns the ground of street `number`, with random parks, yards, junctions and markings."""
    rng = np.random.default_rng([SEEDS[split], 1, number])
    carriageway = float(rng.choice([6.0, 7.0, 8.0, 9.0]))
    left, right = (float(w) for w in rng.choice([5.0, 5.5, 6.0, 6.5], 2))
    crosswalks = tuple(round(float(x), 1) for x in (rng.uniform(0.12, 0.35), rng.uniform(0.6, 0.85)) * np.array(LENGTH))
    parks = [float(rng.choice([0.0, 0.0, 3.0, 6.0])) for _ in range(2)]
    start, end = _ENDS[int(rng.integers(2))], _ENDS[int(rng.integers(2))]
    street = section.StreetSection(
        LENGTH, carriageway, left, right, crosswalks, start, end, *parks, yards=bool(rng.random() < 0.4)
    )
    regions = (*section.ground_regions(street), *_paint(street, rng))
    kinds = sorted({r.kind for r in regions})
    return streets.Ground(street, regions, {k: str(rng.choice(materials_of(split, k))) for k in kinds})


def _paint(street: section.StreetSection, rng: np.random.Generator) -> list[GroundRegion]:
    """A broken middle line and edge lines, each in half of the streets, between the crosswalks."""
    middle, edges = rng.random(2) < 0.5
    out: list[GroundRegion] = []
    margin = section.CROSSWALK_HALF_WIDTH + 1.0
    stops = [-margin + 0.5, *street.crosswalks, street.length + margin - 0.5]
    for i, (a, b) in enumerate(itertools.pairwise(stops)):
        if middle:
            out += section.dashes(f"middle_{i}", a + margin, b - margin, 0.0)
        if edges:
            for name, y in (("left", street.half - 0.4), ("right", 0.4 - street.half)):
                out.append(section.line(f"{name}_edge_{i}", a + margin, b - margin, y - 0.06, y + 0.06))
    return out


def _point_hull(_: AssetRecord) -> HullSet:
    """Returns a tetrahedron of a millimetre, because these streets are never simulated and hulls make up most of a
    bank."""
    return HullSet((np.concatenate([np.zeros((1, 3)), np.eye(3)]).astype(np.float32) * 1e-3,))


def _train_mesh(record: AssetRecord, kin: bool = False) -> AssetMesh:
    """The mesh of a record with a texture of moderate size. A share of the instances are deformed, and a share of those
    have the upper part of another training shape of their leaf, or of their class where the leaf has one alone."""
    mesh = _with_small_texture(build_mesh(record))
    if KEY not in record.params:
        return mesh
    rng = shape_variation.seeded(record)
    if rng.random() >= DEFORMED:
        return mesh
    if class_of_leaf(record.leaf) == HOUSE:
        return shape_variation.deformed(mesh, rng, shape_variation.STRAIGHT)
    others = _others(record.leaf, str(record.params[KEY]["base"]), kin)
    if others and rng.random() < JOINED:
        other = _with_small_texture(build_mesh(others[int(rng.integers(len(others)))]))
        mesh = shape_variation.joined(mesh, other, float(rng.uniform(0.3, 0.75)))
    rolls = category_of(record.leaf)[0] == "vehicle"
    return shape_variation.deformed(mesh, rng, shape_variation.ROLLING if rolls else shape_variation.FREE)


@functools.cache
def _others(leaf: str, base: str, kin: bool) -> tuple[AssetRecord, ...]:
    """Training instances of a leaf with other base shapes; without any, those of the leaves of its class."""

    def found(leaves: tuple[str, ...]) -> tuple[AssetRecord, ...]:
        records = [r for name in leaves for r in _records("train", kin).by_leaf(name) if KEY in r.params]
        return tuple(r for r in records if r.params[KEY]["base"] != base)

    group = next((leaves for leaves in groups().values() if leaf in leaves), ())
    return found((leaf,)) or found(group)


def _with_small_texture(mesh: AssetMesh) -> AssetMesh:
    """Halves textures of more than `MAX_TEXTURE` pixels a side, because images are 512 pixels wide."""
    texture = mesh.texture
    if max(texture.shape[:2]) <= MAX_TEXTURE or min(texture.shape[:2]) < 2:
        return mesh
    image = PIL.Image.fromarray(texture)
    return dataclasses.replace(mesh, texture=np.asarray(image.reduce(2)))


def source(split: str, kin: bool = False) -> AssetSource:
    """Makes the meshes of a split; those of training instances are deformed."""
    return AssetSource(functools.partial(_train_mesh, kin=kin) if split == "train" else build_mesh, _point_hull)


def make_street(split: str, number: int, index: AssetIndex, kin: bool = False) -> tuple[SceneLayout, SceneGeometry]:
    """Street `number` of a split, as a layout and as arrays; `index` holds the split's records."""
    objects = stock(split, number if kin else None)
    layout = streets.make_layout(SEEDS[split], number, index, OBJECTS[split], objects, make_ground(split, number))
    geometry = scene_geometry(layout, index, source(split, kin))
    walk = _walk(make_ground(split, number).section)
    return layout, dataclasses.replace(geometry, map=coarser(geometry.map, map_stride(MAP_CELL)), episodes=walk)


def _walk(street: section.StreetSection) -> EpisodeTable:
    """Returns one episode along the middle of the left pavement, because a bank needs one for every scene."""
    y, z = street.half + street.left / 2.0, section.KERB_HEIGHT
    start, goal = np.array([[1.0, y, z, 0.0]]), np.array([[street.length - 1.0, y, z]])
    length = goal[0, 0] - start[0, 0]
    x = np.minimum(start[0, 0] + 5.0 * np.arange(1, int(np.ceil(length / 5.0)) + 1), goal[0, 0])
    points = np.column_stack([x, np.full((len(x), 2), (y, z))])[None]
    no = np.zeros(1, bool)
    return EpisodeTable(start, goal, points, np.array([len(x)], np.int32), np.array([length]), no, no, np.array([-1.0]))


def build(
    split: str,
    layouts: int,
    progress: Any = None,
    processes: int = 1,
    first: int = 0,
    folders: Sequence[pathlib.Path] = (),
    kin: bool = False,
    within: float | None = None,
) -> SceneBank:
    """Returns the bank of a split's streets from `first` on, and then those of the library's `folders`; `progress` is
    called with (streets done, total). After `within` s no further street is waited for."""
    begin = time.monotonic()
    scenes, hashes, total = [], {}, layouts + len(folders)
    with contextlib.closing(_made(split, [*range(first, first + layouts), *folders], processes, kin)) as streets_made:
        for geometry, name, content in streets_made:
            scenes.append(geometry)
            hashes[name] = content
            if progress is not None:
                progress(len(scenes), total)
            if within is not None and time.monotonic() - begin > within:
                break
    hashes["bank"] = content_hash({"split": split, "layouts": dict(hashes)})
    skies = {name: build_sky(name) for name in sorted({s.sky for s in scenes})}
    return pack(scenes, [split] * len(scenes), skies, hashes)


def _made(
    split: str, streets_of: Sequence[int | pathlib.Path], processes: int, kin: bool = False
) -> Generator[tuple[SceneGeometry, str, str]]:
    """Streets in their order, each with its name and content hash."""
    make = functools.partial(_make, split, kin)
    if processes == 1:
        yield from map(make, streets_of)
        return
    with worker_pool(processes) as pool:
        try:
            yield from pool.map(make, streets_of)
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


def _make(split: str, kin: bool, street: int | pathlib.Path) -> tuple[SceneGeometry, str, str]:
    if isinstance(street, pathlib.Path):
        return perception_library.make(street, _records(split), source(split))
    layout, geometry = make_street(split, street, _records(split, kin), kin)
    return geometry, layout.id, layout.content_hash()


@functools.cache
def _records(split: str, kin: bool = False) -> AssetIndex:
    return of_split(split, load_index(), kin)


def _folders(wanted: str) -> list[pathlib.Path]:
    """Folders of the library's streets, by the option's text."""
    out: list[pathlib.Path] = []
    for part in filter(None, wanted.split(",")):
        name, _, count = part.partition(":")
        if not count.isdigit() or int(count) < 1:
            raise ValidationError(f"--library: found {part!r}, needed SET:COUNT; for example places:24.")
        out += perception_library.folders(name, int(count))
    return out


def _say(begin: float, done: int, total: int) -> None:
    print(f"\r{done}/{total} streets, {time.monotonic() - begin:.0f} s", end="", file=sys.stderr, flush=True)


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.perception_streets", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--split", choices=SPLITS, required=True)
    parser.add_argument("--layouts", type=int, required=True, help="streets")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="bank file to write")
    parser.add_argument("--first", type=int, default=0, help="number of the first street")
    parser.add_argument("--processes", type=int, default=1, help="streets made at a time")
    more = "SET:COUNT,...: streets of the scene library to add, as built in the cache; for training alone"
    parser.add_argument("--library", default="", metavar="SETS", help=more)
    parser.add_argument("--kin", action="store_true", help="more leaves for each class; for training alone")
    within = "keep what is made after so much time, which is no exact bound: a street more may be waited for"
    parser.add_argument("--within", type=float, metavar="SECONDS", help=within)
    arguments = parser.parse_args(argv)
    if arguments.library and arguments.split != "train":
        parser.error("--library needs --split train: its streets contain shapes of both splits")
    if arguments.kin and arguments.split != "train":
        parser.error("--kin needs --split train: the test streets stay as they are")
    if min(arguments.layouts, arguments.processes) < 1 or arguments.first < 0:
        parser.error("--layouts and --processes must be at least 1, --first at least 0")
    begin = time.monotonic()
    try:
        say = functools.partial(_say, begin)
        bank = build(
            arguments.split,
            arguments.layouts,
            say,
            arguments.processes,
            arguments.first,
            _folders(arguments.library),
            arguments.kin,
            arguments.within,
        )
        bank.save(arguments.out)
    except ValidationError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    print(file=sys.stderr)
    figures = {
        "bank": str(arguments.out),
        "split": arguments.split,
        "layouts": bank.num_scenes,
        "categories": len(bank.meta["categories"]),
        "meshes": bank.num_meshes,
        "skies": bank.meta["skies"],
        "hash": bank.meta["hashes"]["bank"],
        "mib": round(arguments.out.stat().st_size / 2**20, 2),
        "seconds": round(time.monotonic() - begin, 1),
    }
    print(json.dumps(figures))
    return 0


if __name__ == "__main__":
    sys.exit(main())
