"""`urbanverse scene ...`: graph -> layout -> compiled scene -> bank; banks joined; terrain to walk on."""

import concurrent.futures
import dataclasses
import fnmatch
import json
import multiprocessing
import pathlib
import sys
import tempfile
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Annotated

import numpy as np
import tyro

from .. import settings
from ..datatypes import SceneBank, SceneGraph
from ..datatypes import validation as v
from . import scene_gallery, scene_library, scene_routes

if TYPE_CHECKING:
    from ..materialisation import Materialisation
    from ..scene import CompiledScene, Driver


@dataclasses.dataclass(frozen=True)
class CompileArgs:
    """Compile a scene graph to a folder whose scene.xml stock MuJoCo loads; prints one JSON line."""

    graph: Annotated[pathlib.Path, tyro.conf.Positional]
    """graph.json."""
    out: pathlib.Path
    """Folder to write; an older compiled scene there is replaced once the new one is whole."""
    seed: int = 0
    """Chooses among equally good assets, materials and skies, and the episodes."""
    cousin: int = 0
    """Number of the digital cousin."""
    half: int = 0
    """1 or 2: that half of the street alone, cut across its middle; 0: all of it."""
    skip_unknown: bool = False
    """Leave out objects whose label no asset is known for, and list them, instead of refusing the graph."""


@dataclasses.dataclass(frozen=True)
class BankArgs:
    """Compile scene graphs and pack them into one bank file; prints one JSON line."""

    graphs: Annotated[tuple[pathlib.Path, ...], tyro.conf.Positional] = ()
    """graph.json files; none: the shipped streets, re-used where nothing changed."""
    out: pathlib.Path | None = None
    """Bank file; default: in the cache, named by what it is made of. Environments load the shipped streets' bank, or
    the one that the variable URBANVERSE_BANK names."""
    seed: int = 0
    """Chooses among equally good assets, materials and skies, and the episodes."""
    split: str = "train"
    """Split of the graphs given by name, "train" or "test"; shipped streets have their own (scenes/splits.json)."""
    cousins: int = 1
    """Digital cousins of each graph given by name: the same places, other assets, materials and sky."""
    quiet: bool = False


@dataclasses.dataclass(frozen=True)
class JoinArgs:
    """Join bank files into one with all their scenes, each in its old split; prints one JSON line."""

    banks: Annotated[tuple[pathlib.Path, ...], tyro.conf.Positional]
    """Bank files; no scene may stand in two of them."""
    out: pathlib.Path
    """Bank file to write."""
    split: tuple[str, ...] = ()
    """NAME=PATTERN puts the scenes whose ids fit a shell pattern into a split of that name: "held_out=bench_*_15?"."""


@dataclasses.dataclass(frozen=True)
class TerrainArgs:
    """Build the terrain that robots learn to walk on (kerbs, stairs, slopes, rough ground); prints one JSON line."""

    out: pathlib.Path | None = None
    """Bank file; default: in the cache, where environments find the one with the default seed and levels."""
    seed: int = 0
    levels: int = 10
    """Levels of difficulty of each kind."""


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse scene ...`."""
    args = tyro.extras.subcommand_cli_from_dict(
        {
            "compile": CompileArgs,
            "bank": BankArgs,
            "join": JoinArgs,
            "terrain": TerrainArgs,
            "routes": scene_routes.RoutesArgs,
            "gallery": scene_gallery.GalleryArgs,
            "library": scene_library.LibraryArgs,
        },
        args=list(argv),
        prog="urbanverse scene",
    )
    if isinstance(args, TerrainArgs):
        return _terrain(args)
    if isinstance(args, scene_routes.RoutesArgs):
        return scene_routes.main(args)
    if isinstance(args, scene_gallery.GalleryArgs):
        return scene_gallery.main(args)
    if isinstance(args, scene_library.LibraryArgs):
        return scene_library.main(args)
    if isinstance(args, CompileArgs):
        return _compile(args)
    return _join(args) if isinstance(args, JoinArgs) else _bank(args)


def _compile(args: CompileArgs) -> int:
    materialised, compiled = compile_graph(args.graph, args.out, args.seed, args.cousin, args.skip_unknown, args.half)
    for name, label in materialised.skipped:
        sys.stderr.write(f"left out {name!r}: no asset for the label {label!r}\n")
    print(json.dumps({"folder": str(args.out), "id": compiled.layout.id, **compiled.metadata["counts"]}))
    return 0


def compile_graph(
    graph: pathlib.Path, out: pathlib.Path, seed: int = 0, cousin: int = 0, skip_unknown: bool = False, half: int = 0
) -> "tuple[Materialisation, CompiledScene]":
    """Reads, materialises and compiles one graph or (1, 2) a half of it; COCO with the differential drive drives it.

    Raises:
      NounError: whatever is wrong with the graph; then nothing is written.
    """
    from ..scene.compiler import check_out_dir, compile_scene
    from ..scene.ground import check_regions

    v.choice(str(half), "--half", ("0", "1", "2"))
    check_out_dir(out)
    scene = SceneGraph.load(graph)
    check_regions(scene.ground)
    from ..assets import load_index
    from ..materialisation import materialise

    index = load_index()
    materialised = materialise(scene, index, seed, cousin, skip_unknown)
    return materialised, compile_scene(materialised.layout, index, out, make_driver(), place=scene.source)


def make_driver() -> "Driver":
    """COCO behind its own waypoint controller, as numpy in and out."""
    import jax
    import jax.numpy as jnp

    from ..robots import make_coco
    from ..scene.drive import CONTROL_PERIOD, Driver

    robot = make_coco()
    batch = jax.jit(jax.vmap(lambda w: robot.command(jnp.stack(robot.waypoint_to_velocity(w, CONTROL_PERIOD)))))
    cpu = jax.devices("cpu")[0]

    def command(waypoints: np.ndarray) -> np.ndarray:
        with jax.default_device(cpu):
            return np.asarray(batch(waypoints))

    return Driver(robot, command)


def _bank(args: BankArgs) -> int:
    if args.graphs:
        v.choice(args.split, "--split", ("train", "test"))
        v.integer(args.cousins, "--cousins", 1)
        graphs, splits, cousins = list(args.graphs), [args.split] * len(args.graphs), args.cousins
    elif args.seed == 0 and args.out is None:
        return _say_bank(settings.default_bank_path(), ensure_default_bank(args.quiet))
    else:
        graphs, splits = shipped_scenes()
        cousins = 1
    return _keep_bank(
        args.out,
        settings.user_bank_path(graphs, splits, args.seed, cousins),
        lambda: build_bank(graphs, splits, args.seed, args.quiet, cousins),
    )


def _terrain(args: TerrainArgs) -> int:
    from ..scene.terrain import terrain_bank

    path = settings.terrain_bank_path(args.seed, args.levels)
    return _keep_bank(args.out, path, lambda: terrain_bank(args.seed, args.levels))


def _keep_bank(out: pathlib.Path | None, path: pathlib.Path, build: Callable[[], SceneBank]) -> int:
    """Builds a bank into the file that the user named, or finds or builds the one in the cache."""
    if out is None:
        return _say_bank(path, cached_bank(path, build))
    bank = build()
    bank.save(out)
    return _say_bank(out, bank)


def _join(args: JoinArgs) -> int:
    from ..datatypes.bank_join import join

    bank = _with_splits(join([SceneBank.load(path) for path in args.banks]), args.split)
    if not bank.agents["kind"]:
        # Banks from before there were any.
        from ..assets.agents import agent_looks
        from ..scene.bank import with_agents

        bank = with_agents(bank, agent_looks())
    bank.save(args.out)
    return _say_bank(args.out, bank)


def _with_splits(bank: SceneBank, wanted: Sequence[str]) -> SceneBank:
    splits = list(bank.meta["splits"])
    for text in wanted:
        name, equals, pattern = text.partition("=")
        rows = [i for i, scene in enumerate(bank.scene_ids) if fnmatch.fnmatchcase(scene, pattern)]
        if not (name and equals and rows):
            raise v.NounError(f"--split: found {text!r}, needed NAME=PATTERN that fits some scene of the banks.")
        for i in rows:
            splits[i] = name
    return dataclasses.replace(bank, meta={**bank.meta, "splits": splits})


def _say_bank(path: pathlib.Path, bank: SceneBank) -> int:
    print(json.dumps({"bank": str(path), "scenes": list(bank.scene_ids), "hulls": bank.num_hulls}))
    return 0


def shipped_scenes() -> tuple[list[pathlib.Path], list[str]]:
    """Graphs and splits of the shipped streets, train first.

    Raises:
      NounError: `splits.json` names something else than lists of scenes.
    """
    root = settings.scene_root()
    table = v.mapping(v.read_json(root / "splits.json", "split table"), "splits.json", ("train", "test"))
    rows = [
        (root / v.text(name, f"splits.json {split}") / "graph.json", split) for split in table for name in table[split]
    ]
    return [path for path, _ in rows], [split for _, split in rows]


def ensure_default_bank(quiet: bool = False) -> SceneBank:
    """The bank that environments load; the shipped streets' is built into the cache where it is missing or wrong.

    Raises:
      NounError: `URBANVERSE_BANK` names a file that is no bank.
    """
    chosen = settings.chosen_bank_path()
    if chosen is not None:
        return SceneBank.load(chosen)
    return cached_bank(settings.shipped_bank_path(), lambda: build_bank(*shipped_scenes(), quiet=quiet))


def ensure_terrain_bank() -> SceneBank:
    """The terrain that robots learn to walk on, built into the cache where it is missing or wrong."""
    from ..scene.terrain import terrain_bank

    return cached_bank(settings.terrain_bank_path(), terrain_bank)


def cached_bank(path: pathlib.Path, build: Callable[[], SceneBank]) -> SceneBank:
    """The bank of a file in the cache; built where there is none, or one of something else than its name says.

    A wrong file is renamed and stays beside the new one.

    Args:
      path: as `settings` names banks: with the key, which the bank holds too.
      build: makes the bank.
    """
    key = settings.bank_key(path)
    if path.is_file():
        bank = SceneBank.load(path)
        if bank.key == key:
            return bank
        kept = v.set_aside(path)
        print(f"{path}: found other scenes than its name says; kept as {kept.name}, building it anew", file=sys.stderr)
    bank = build()
    bank = dataclasses.replace(bank, meta={**bank.meta, "key": key})
    bank.save(path)
    return bank


def build_bank(
    graphs: Sequence[pathlib.Path], splits: Sequence[str], seed: int = 0, quiet: bool = False, cousins: int = 1
) -> SceneBank:
    """Compiles the graphs, `cousins` of each, in parallel processes and packs them.

    Raises:
      NounError: a graph that cannot be compiled; the message names it.
    """
    from rich.console import Console
    from rich.progress import Progress

    from ..scene import pack_bank

    # Not forked: JAX and MuJoCo may already run threads here.
    context = multiprocessing.get_context("spawn")
    wanted = [(graph, cousin) for graph in graphs for cousin in range(cousins)]
    workers = max(1, min(settings.num_threads(), len(wanted)))
    with (
        tempfile.TemporaryDirectory(prefix="urbanverse-scenes-") as work,
        Progress(console=Console(stderr=True), disable=quiet) as progress,
        concurrent.futures.ProcessPoolExecutor(workers, mp_context=context) as pool,
    ):
        task = progress.add_task("compiling scenes", total=len(wanted))
        folders = [pathlib.Path(work) / str(i) for i in range(len(wanted))]
        jobs = [pool.submit(_compile_job, *w, f, seed) for w, f in zip(wanted, folders, strict=True)]
        for job in concurrent.futures.as_completed(jobs):
            if job.exception() is not None:
                pool.shutdown(wait=False, cancel_futures=True)
            job.result()
            progress.advance(task)
        return pack_bank(folders, [split for split in splits for _ in range(cousins)])


def _compile_job(graph: pathlib.Path, cousin: int, out: pathlib.Path, seed: int) -> None:
    try:
        compile_graph(graph, out, seed, cousin)
    except v.NounError as error:
        raise v.NounError(f"{graph}: {error}") from error
