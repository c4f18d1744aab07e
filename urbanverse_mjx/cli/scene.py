"""`urbanverse scene ...`: compiles scene graphs, builds and joins banks, and generates training terrain."""

import dataclasses
import json
import pathlib
import sys
from collections.abc import Callable, Sequence
from typing import Annotated, Literal

import tyro

from .. import pipeline, settings
from ..datatypes import SPLITS, BankShardsWriter, SceneBank
from ..datatypes import validation as v
from ..datatypes.bank_shards import SUFFIX as SHARDS
from ..progress import Progress
from . import scene_gallery, scene_library, scene_routes
from ._options import parse_subcommand


@dataclasses.dataclass(frozen=True)
class CompileArgs:
    """Compile a scene graph to a folder whose scene.xml stock MuJoCo loads; prints one JSON line."""

    graph: Annotated[pathlib.Path, tyro.conf.Positional]
    """graph.json."""
    out: pathlib.Path
    """Output folder; an older compiled scene in it is replaced when the new one is complete."""
    seed: int = 0
    """Seed of the choice among equally good assets, materials and skies, and of the episodes."""
    cousin: int = 0
    """Number of the digital cousin, from 0, as in `urbanverse gen` and the scene library."""
    half: int = 0
    """1 or 2: only that half of the street, cut across its centre; 0: all of it."""
    skip_unknown: bool = False
    """Leave out and list objects whose label has no asset, instead of raising an error."""
    movable: bool = False
    """Write movable objects to scene.xml as free bodies at rest; by default all objects are fixed."""
    imported: bool = False
    """Also use the assets that you imported (`urbanverse assets import`)."""
    regional: bool = False
    """Give the scene the look of the graph's city or country: houses and signs, roads and their markings."""
    hulls: Literal["", "close", "close-2"] = ""
    """close: collision hulls that stand out less where a robot can touch them; close-2: the same, of more shapes;
    default: the first hulls."""


@dataclasses.dataclass(frozen=True)
class BankArgs:
    """Compile scene graphs and pack them into one bank; prints one JSON line."""

    graphs: Annotated[tuple[pathlib.Path, ...], tyro.conf.Positional] = ()
    """graph.json files; none: the shipped streets, which are re-used if nothing changed."""
    out: pathlib.Path | None = None
    """Bank file (.npz), or a folder (.bank) of which environments can read some scenes alone; default: a file in the
    cache, named by a hash of its inputs. Environments load the shipped streets' bank, or that of the variable
    URBANVERSE_BANK."""
    seed: int = 0
    """Seed of the choice among equally good assets, materials and skies, and of the episodes."""
    split: str = "train"
    """Split of the graphs given by name, train, validation or test; scenes/splits.json has that of shipped streets."""
    cousins: int = 1
    """Number of digital cousins of each given graph, with the same positions, but other assets, materials and skies."""
    imported: bool = False
    """Also use the assets that you imported; needs --out."""
    quiet: bool = False
    """No progress bars."""


@dataclasses.dataclass(frozen=True)
class JoinArgs:
    """Join bank files to one with all their scenes, each in its original split, or in "validation" if the scene library
    holds it out; prints one JSON line."""

    banks: Annotated[tuple[pathlib.Path, ...], tyro.conf.Positional]
    """Bank files or folders; a scene may occur in only one of them."""
    out: pathlib.Path
    """Bank file (.npz) to write, or a folder (.bank), which needs the memory of one bank at a time and holds equal
    meshes and textures once."""
    split: Annotated[tuple[str, ...], tyro.conf.arg(metavar="NAME=PATTERN [NAME=PATTERN ...]")] = ()
    """NAME=PATTERN assigns the scenes whose ids match a shell pattern to the split NAME: "held_out=bench_*_15?"."""


@dataclasses.dataclass(frozen=True)
class TerrainArgs:
    """Build the training terrain for locomotion (kerbs, stairs, slopes, rough ground); prints one JSON line."""

    out: pathlib.Path | None = None
    """Bank file; default: in the cache, from which environments load the one with the default seed and levels."""
    seed: int = 0
    """Of the heights and angles of the terrain."""
    levels: int = 10
    """Levels of difficulty of each kind."""


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse scene ...`."""
    args = parse_subcommand(
        {
            "compile": CompileArgs,
            "bank": BankArgs,
            "join": JoinArgs,
            "terrain": TerrainArgs,
            "routes": scene_routes.RoutesArgs,
            "gallery": scene_gallery.GalleryArgs,
            "library": scene_library.LibraryArgs,
        },
        argv,
        "urbanverse scene",
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
    with Progress() as progress:
        progress.task("compiling scenes", total=1)
        cousin, compiled = pipeline.compile_graph(
            args.graph,
            args.out,
            args.seed,
            args.cousin,
            args.skip_unknown,
            args.half,
            args.movable,
            args.imported,
            args.regional,
            args.hulls,
        )
    for gone in cousin.left_out:
        sys.stderr.write(f"left out {gone.id!r}, because {gone.reason}\n")
    if cousin.raised:
        from ..materialisation import kerbs

        sys.stderr.write(
            f"raised {', '.join(cousin.raised)} to a kerb of {100 * kerbs.KERB:.0f} cm, because no step from there to "
            f"the road is {100 * kerbs.MIN_OBSERVED_STEP:.0f} cm or more\n"
        )
    counts = compiled.metadata["counts"] | compiled.metadata["bodies"]
    print(json.dumps({"folder": str(args.out), "id": compiled.layout.id, "raised": list(cousin.raised), **counts}))
    return 0


def _bank(args: BankArgs) -> int:
    if args.imported and not (args.graphs and args.out):
        raise v.fail(
            "--imported", "no graphs or no --out", "both, because the cache holds banks of the catalogue alone"
        )
    if args.graphs:
        v.choice(args.split, "--split", SPLITS)
        v.integer(args.cousins, "--cousins", 1)
        graphs, splits, cousins = list(args.graphs), [args.split] * len(args.graphs), args.cousins
    elif args.seed == 0 and args.out is None:
        return _say_bank(settings.default_bank_path(), pipeline.ensure_default_bank(args.quiet))
    else:
        graphs, splits = pipeline.shipped_scenes()
        cousins = 1
    if args.out is not None and args.out.suffix == SHARDS:
        return _say_shards(
            args.out,
            pipeline.build_shards(args.out, graphs, splits, args.seed, args.quiet, cousins, args.imported),
        )
    return _keep_bank(
        args.out,
        settings.user_bank_path(graphs, splits, args.seed, cousins),
        lambda: pipeline.build_bank(graphs, splits, args.seed, args.quiet, cousins, args.imported),
    )


def _terrain(args: TerrainArgs) -> int:
    path = settings.terrain_bank_path(args.seed, args.levels)
    return _keep_bank(args.out, path, lambda: pipeline.build_terrain_bank(args.seed, args.levels))


def _keep_bank(out: pathlib.Path | None, path: pathlib.Path, build: Callable[[], SceneBank]) -> int:
    """Builds a bank to the given file, or loads or builds the one in the cache."""
    if out is None:
        return _say_bank(path, pipeline.cached_bank(path, build))
    bank = build()
    bank.save(out)
    return _say_bank(out, bank)


def _join(args: JoinArgs) -> int:
    if args.out.suffix == SHARDS:
        return _say_shards(args.out, pipeline.join_shards(args.banks, args.out, args.split))
    bank = pipeline.join_banks(args.banks, args.split)
    bank.save(args.out)
    return _say_bank(args.out, bank)


def _say_shards(path: pathlib.Path, written: BankShardsWriter) -> int:
    print(json.dumps({"bank": str(path), "scenes": written.scene_ids, **written.counts}))
    return 0


def _say_bank(path: pathlib.Path, bank: SceneBank) -> int:
    # Of all scenes together, as `scene compile` counts those of one; the table of shapes holds equal ones once.
    counts = {"hulls": int((bank.inst_hull >= 0).sum()), "prisms": int((bank.prism_hull >= 0).sum())}
    print(json.dumps({"bank": str(path), "scenes": list(bank.scene_ids), **counts}))
    return 0
