"""Builds a seeded benchmark bank of long streets with random objects and many hulls per object.

    python -m benchmarks.bank --layouts 16 --objects 200-300 --hulls 6-10 --seed 0 --out bank16.npz

Streets are 200 m long, with kerbs, ramps at four crosswalks, house fronts, vehicles, furniture and people, materials
and skies. Meshes and hulls are the shipped index's; a hull is cut in halves until an object has as many as asked for,
so the solid stays the same. Episodes are planned over the free pavement; unlike those of the shipped streets they are
not driven once. `--hulls-per-scene` thins the collision set out (whole objects lose their hulls, images and episodes
stay), which is how cost over the number of hulls is measured; benchmarks.throughput can do that to a bank as it loads.
It prints one JSON line. The same options give the same content hash.
"""

import argparse
import dataclasses
import functools
import json
import pathlib
import sys
import time
from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks.lib import banks, cutting, streets
from urbanverse_mjx.assets import AssetIndex, load_hulls, load_index
from urbanverse_mjx.assets.appearances.skies import build_sky
from urbanverse_mjx.assets.meshes.agents import agent_appearances
from urbanverse_mjx.assets.records.index import build_mesh
from urbanverse_mjx.datatypes import AssetRecord, HullSet, SceneBank, SceneLayout, ValidationError
from urbanverse_mjx.datatypes.hashing import content_hash
from urbanverse_mjx.materialisation.choice import pick
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.scene.bank import pack, with_agents
from urbanverse_mjx.scene.compiler import AssetSource, scene_geometry
from urbanverse_mjx.scene.drive import Drive
from urbanverse_mjx.scene.episodes import EpisodeRules, build_episodes
from urbanverse_mjx.scene.geometry import SceneGeometry, SceneMap
from urbanverse_mjx.scene.maps import RESOLUTION
from urbanverse_mjx.scene.planner import RobotSize, free_space, path_length

#: As many goals as 256 rows need with 28 starts each; more cost a field over 200 m each.
GOALS = 14


@dataclasses.dataclass(frozen=True)
class Options:
    """Parameters of a bank; ranges include both ends. `first`: number of the first street, which is the same street in
    every bank of a seed."""

    layouts: int = 16
    first: int = 0
    objects: tuple[int, int] = (200, 300)
    hulls: tuple[int, int] = (6, 10)
    hulls_per_scene: int | None = None
    map_cell: float = 0.1
    seed: int = 0


class CutHulls:
    """Hulls of records, each cut into a random number of pieces."""

    def __init__(self, low: int, high: int, seed: int) -> None:
        self._range, self._seed = (low, high), seed
        self._found: dict[str, HullSet] = {}

    def __call__(self, record: AssetRecord) -> HullSet:
        if record.uid not in self._found:
            low, high = self._range
            number = low + pick(high - low + 1, "benchmark hulls", self._seed, record.uid)
            self._found[record.uid] = HullSet(cutting.cut(load_hulls(record).hulls, number))
        return self._found[record.uid]


def map_stride(cell: float) -> int:
    """Returns how many of a compiled scene's map cells one cell of `cell` m spans.

    Raises:
      ValidationError: `cell` is not a multiple of the map's cell size.
    """
    stride = round(cell / RESOLUTION)
    if stride < 1 or abs(stride * RESOLUTION - cell) > 1e-6:
        raise ValidationError(f"--map-cell: found {cell:g} m, needed a multiple of {RESOLUTION:g} m.")
    return stride


def coarser(scene_map: SceneMap, stride: int) -> SceneMap:
    """Returns every `stride`-th cell of a map, the middle one of each block."""
    middle = slice(stride // 2, None, stride)
    # Copies: a view would keep the fine map alive.
    fields = {name: getattr(scene_map, name)[middle, middle].copy() for name in ("height", "kind", "clearance")}
    return SceneMap(scene_map.origin, stride * scene_map.resolution, **fields)


def build_scene(layout: SceneLayout, number: int, index: AssetIndex, source: AssetSource, stride: int) -> SceneGeometry:
    """Layout `number` as geometry with its episodes and every `stride`-th cell of its map."""
    geometry = scene_geometry(layout, index, source)
    robot = make_coco()
    size = RobotSize(height=robot.planner_height)
    space = free_space(geometry.map, size)

    def undriven(_: np.ndarray, paths: Sequence[np.ndarray]) -> list[Drive]:
        return [Drive(path_length(p) / robot.max_speed, "") for p in paths]

    episodes = build_episodes(space, size, number, undriven, EpisodeRules(goals=GOALS))
    return dataclasses.replace(geometry, episodes=episodes, map=coarser(geometry.map, stride))


def build(options: Options, progress: Any = None) -> SceneBank:
    """The bank.

    Args:
      progress: called with (layouts done, layouts in all).

    Raises:
      ValidationError: numbers that fit no street.
    """
    stride = map_stride(options.map_cell)
    index = load_index()
    source = AssetSource(build_mesh, CutHulls(*options.hulls, options.seed))
    # All layouts come first, so that invalid options fail before minutes of work.
    numbers = range(options.first, options.first + options.layouts)
    layouts = [streets.make_layout(options.seed, i, index, options.objects) for i in numbers]
    hashes = {layout.id: layout.content_hash() for layout in layouts}
    scenes = []
    for number, layout in zip(numbers, layouts, strict=True):
        scenes.append(build_scene(layout, number, index, source, stride))
        if progress is not None:
            progress(len(scenes), options.layouts)
    chosen = dataclasses.asdict(options)
    if options.first == 0:
        del chosen["first"]  # keeps the hashes of banks made before this option existed
    hashes["bank"] = content_hash({"options": chosen, "layouts": hashes})
    skies = {name: build_sky(name) for name in sorted({s.sky for s in scenes})}
    bank = with_agents(pack(scenes, ["train"] * len(scenes), skies, hashes), agent_appearances())
    if options.hulls_per_scene is not None:
        bank = banks.with_hulls(bank, options.hulls_per_scene, options.seed)
    return bank


def summary(bank: SceneBank) -> dict[str, Any]:
    """Contents of the bank."""
    hulls = (bank.inst_hull >= 0).sum(1)
    objects = [len(set(row[row >= 0])) for row in bank.inst_object]
    ground = np.array([name.startswith("ground:") for name in bank.meta["categories"]])
    seen = ((bank.slot_mesh >= 0) & ~ground[bank.slot_category]).sum(1)
    return {
        "layouts": bank.num_scenes,
        "objects": [int(seen.min()), int(seen.max())],
        "objects_with_hulls": [min(objects), max(objects)],
        "hulls": [int(hulls.min()), int(hulls.max())],
        "hull_table": bank.num_hulls,
        "meshes": bank.num_meshes,
        "textures": len(bank.texture_shape),
        "skies": len(bank.meta["skies"]),
        "episodes": int(bank.num_episodes.min()),
        "hulls_near_a_cell": int((bank.hull_grid >= 0).sum(-1).max()),
        "array_mib": round(sum(a.nbytes for a in bank.arrays().values()) / 2**20, 1),
        "hash": bank.meta["hashes"]["bank"],
    }


def _range(text: str) -> tuple[int, int]:
    low, _, high = text.partition("-")
    try:
        pair = int(low), int(high or low)
    except ValueError:
        raise argparse.ArgumentTypeError(f"found {text!r}, needed a number or LOW-HIGH such as 200-300") from None
    if not 1 <= pair[0] <= pair[1]:
        raise argparse.ArgumentTypeError(f"found {text!r}, needed 1 <= LOW <= HIGH")
    return pair


def parse(argv: list[str] | None) -> argparse.Namespace:
    defaults = Options()
    parser = argparse.ArgumentParser(prog="python -m benchmarks.bank", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--layouts", type=int, default=defaults.layouts, help="streets (16 or 160)")
    parser.add_argument("--first", type=int, default=defaults.first, help="number of the first one")
    parser.add_argument("--objects", type=_range, default=defaults.objects, help="objects a street, LOW-HIGH")
    parser.add_argument("--hulls", type=_range, default=defaults.hulls, help="hulls an object, LOW-HIGH (at most 16)")
    parser.add_argument("--hulls-per-scene", type=int, help="keep at most so many hulls a street (50 to 2000)")
    parser.add_argument("--map-cell", type=float, default=defaults.map_cell, help="m, a multiple of 0.05")
    parser.add_argument("--seed", type=int, default=defaults.seed)
    parser.add_argument("--out", type=pathlib.Path, required=True, help="bank file to write")
    parser.add_argument("--quiet", action="store_true", help="no progress on stderr")
    arguments = parser.parse_args(argv)
    if arguments.layouts < 1 or arguments.seed < 0 or arguments.first < 0:
        parser.error("--layouts must be at least 1, --first and --seed at least 0")
    return arguments


def _say(begin: float, done: int, total: int) -> None:
    print(f"\r{done}/{total} streets, {time.monotonic() - begin:.0f} s", end="", file=sys.stderr, flush=True)


def main(argv: list[str] | None = None) -> int:
    arguments = parse(argv)
    names = [f.name for f in dataclasses.fields(Options)]
    options = Options(**{name: getattr(arguments, name) for name in names})
    begin = time.monotonic()
    try:
        bank = build(options, None if arguments.quiet else functools.partial(_say, begin))
        bank.save(arguments.out)
    except ValidationError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    if not arguments.quiet:
        print(file=sys.stderr)
    size = arguments.out.stat().st_size
    figures = {"mib": round(size / 2**20, 2), "seconds": round(time.monotonic() - begin, 1)}
    print(json.dumps({"bank": str(arguments.out), **summary(bank), **figures}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
