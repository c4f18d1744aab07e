"""Builds, joins and caches banks of compiled scenes."""

import contextlib
import dataclasses
import fnmatch
import os
import pathlib
from collections.abc import Callable, Iterator, Sequence

from .. import settings
from ..datatypes import BankShards, BankShardsWriter, SceneBank, array_file
from ..datatypes import validation as v
from ..process_pool import results_as_completed
from ..progress import Progress
from ..work_folder import work_folder
from .scenes import compile_graph

#: Scenes that are in memory at once where a folder is written.
_SCENES_TOGETHER = 16


def build_bank(
    graphs: Sequence[str | os.PathLike[str]],
    splits: Sequence[str],
    seed: int = 0,
    quiet: bool = False,
    cousins: int = 1,
    imported: bool = False,
) -> SceneBank:
    """Compiles the graphs, `cousins` of each, in parallel processes and packs them.

    Args:
      graphs: graph.json files.
      splits: the split of each, "train" or "test".
      seed: seed of the choice among equally good assets, materials and skies, and of the episodes.
      quiet: whether to show no progress bar on standard error.
      cousins: number of digital cousins of each graph, which have the same positions, but other assets, materials and
        skies.
      imported: whether to use the assets that the user imported too.

    Raises:
      ValidationError: a graph cannot be compiled; the message names it.
    """
    from ..scene import pack_bank

    with _compiled(graphs, seed, quiet, cousins, imported) as folders:
        return pack_bank(folders, [split for split in splits for _ in range(cousins)])


def build_shards(
    out: str | os.PathLike[str],
    graphs: Sequence[str | os.PathLike[str]],
    splits: Sequence[str],
    seed: int = 0,
    quiet: bool = False,
    cousins: int = 1,
    imported: bool = False,
) -> BankShardsWriter:
    """Like `build_bank`, but writes a folder (`datatypes.bank_shards`), of whose scenes few are in memory at once.

    Args:
      out: the folder; its name ends in .bank.

    Returns:
      the writer, which knows the scenes and counts.

    Raises:
      ValidationError: a graph cannot be compiled; the message names it; or the folder holds other files.
    """
    with BankShardsWriter(out) as writer, _compiled(graphs, seed, quiet, cousins, imported) as folders:
        for bank in packed_parts(folders, [split for split in splits for _ in range(cousins)]):
            writer.add(bank.arrays(), bank.meta)
    return writer


def packed_parts(folders: Sequence[pathlib.Path], splits: Sequence[str]) -> Iterator[SceneBank]:
    """Banks of compiled scenes, of some at a time, so that few are in memory; see `scene.packing.pack_bank`."""
    from ..scene import pack_bank

    for first in range(0, len(folders), _SCENES_TOGETHER):
        part = slice(first, first + _SCENES_TOGETHER)
        yield pack_bank(folders[part], splits[part])


@contextlib.contextmanager
def _compiled(
    graphs: Sequence[str | os.PathLike[str]], seed: int, quiet: bool, cousins: int, imported: bool
) -> Iterator[list[pathlib.Path]]:
    """Folders of the compiled scenes of graphs, cousins one after the other, which are removed at the end."""
    from ..assets.records.store import ensure_store

    ensure_store()
    wanted = [(pathlib.Path(graph), cousin) for graph in graphs for cousin in range(cousins)]
    with (
        work_folder("urbanverse-scenes-") as work,
        Progress(quiet) as progress,
    ):
        report = progress.task("compiling scenes", len(wanted))
        folders = [work / str(i) for i in range(len(wanted))]
        tasks = [
            (graph, cousin, folder, seed, imported) for (graph, cousin), folder in zip(wanted, folders, strict=True)
        ]
        for done, _ in enumerate(results_as_completed(_compile_job, tasks, settings.num_threads()), 1):
            report(done)
        yield folders


def _compile_job(graph: pathlib.Path, cousin: int, out: pathlib.Path, seed: int, imported: bool = False) -> None:
    try:
        compile_graph(graph, out, seed, cousin, imported=imported)
    except v.ValidationError as error:
        raise v.ValidationError(f"{graph}: {error}") from error


def shipped_scenes() -> tuple[list[pathlib.Path], list[str]]:
    """Graphs and splits of the shipped streets, train first.

    Raises:
      ValidationError: `splits.json` does not hold lists of scenes.
    """
    root = settings.scene_root()
    table = v.mapping(v.read_json(root / "splits.json", "split table"), "splits.json", ("train", "test"))
    rows = [
        (root / v.text(name, f"splits.json {split}") / "graph.json", split) for split in table for name in table[split]
    ]
    return [path for path, _ in rows], [split for _, split in rows]


def ensure_default_bank(quiet: bool = False) -> SceneBank:
    """Loads the bank of the environments; builds that of the shipped streets into the cache if it is missing or
    outdated.

    Raises:
      ValidationError: `URBANVERSE_BANK` names a file that is not a bank.
    """
    chosen = settings.chosen_bank_path()
    if chosen is not None:
        return SceneBank.load(chosen)
    return cached_bank(settings.shipped_bank_path(), lambda: build_bank(*shipped_scenes(), quiet=quiet))


def chosen_bank(path: str | os.PathLike[str] | None, quiet: bool = False) -> SceneBank:
    """Loads the bank of a file, or `ensure_default_bank` without a path.

    Raises:
      ValidationError: the file does not exist or is not a bank.
    """
    return ensure_default_bank(quiet) if path is None else SceneBank.load(path)


def ensure_terrain_bank() -> SceneBank:
    """Loads the bank of training terrain for locomotion; builds it into the cache if it is missing or outdated."""
    return cached_bank(settings.terrain_bank_path(), build_terrain_bank)


def build_terrain_bank(seed: int = 0, levels: int = 10) -> SceneBank:
    """Builds the bank of training terrain for locomotion: kerbs, stairs, slopes and rough ground, `levels` of each
    kind."""
    from ..scene.terrain import terrain_bank

    return terrain_bank(seed, levels)


def cached_bank(path: pathlib.Path, build: Callable[[], SceneBank]) -> SceneBank:
    """Loads a bank of the cache; builds it if it is missing, damaged, or does not match the key in its name.

    A damaged or wrong file is renamed and kept, with a line on standard error.

    Args:
      path: path by `settings`, whose name contains the key that the bank also stores.
      build: function that builds the bank.
    """
    key = settings.bank_key(path)
    if path.is_file():
        reason = f"{path}: found other scenes than those in its name"
        try:
            bank = SceneBank.load(path)
            if bank.key == key and bank.knows_materials:
                return bank
            if bank.key == key:
                reason = f"{path}: found a bank without the friction of its ground's materials"
        except v.ValidationError as error:
            reason = str(error)
        array_file.discard(path, reason)
    bank = build()
    bank = dataclasses.replace(bank, meta={**bank.meta, "key": key})
    bank.save(path)
    return bank


def join_banks(banks: Sequence[str | os.PathLike[str]], splits: Sequence[str] = ()) -> SceneBank:
    """Joins bank files to one bank with all their scenes, each in its original split.

    Scenes that the scene library holds out are in the split "validation", also from banks that were packed before.

    Args:
      banks: files; a scene may occur in only one of them.
      splits: NAME=PATTERN assigns the scenes whose ids match a shell pattern to the split NAME.

    Raises:
      ValidationError: see `datatypes.bank_join.join`; or a pattern matches no scene.
    """
    from ..datatypes.bank_join import join
    from ..scene import library

    bank = join([SceneBank.load(path) for path in banks])
    bank = _with_splits(bank, [*(f"validation={scene}" for scene in library.held_out(bank.scene_ids)), *splits])
    if not bank.agents["kind"]:
        # Banks from before there were any.
        from ..assets.meshes.agents import agent_appearances
        from ..scene.bank import with_agents

        bank = with_agents(bank, agent_appearances())
    return bank


def join_shards(
    banks: Sequence[str | os.PathLike[str]], out: str | os.PathLike[str], splits: Sequence[str] = ()
) -> BankShardsWriter:
    """Like `join_banks`, but writes a folder (`datatypes.bank_shards`), with one of the banks in memory at a time.

    Args:
      out: the folder; its name ends in .bank.

    Returns:
      the writer, which knows the scenes and counts.

    Raises:
      ValidationError: see `join_banks`; or the folder is one of the banks, or holds other files.
    """
    from ..datatypes.bank_join import coarse_map
    from ..scene import library

    if not banks:
        raise v.fail("join", "no bank", "at least one")
    for path in banks:
        if pathlib.Path(path).resolve() == pathlib.Path(out).resolve():
            raise v.fail(str(out), "one of the banks that are joined", "a folder of its own", "take another name")
    resolution = max(_resolution(path) for path in banks)
    with BankShardsWriter(out) as writer:
        has_agents = False
        for bank in _in_parts(banks):
            writer.add(coarse_map(bank, resolution), bank.meta)
            has_agents |= bool(bank.agents["kind"])
        if not has_agents:
            raise v.fail(str(out), "no bank with appearances of agents", "one that has them", "build a bank again")
        held_out = [f"validation={scene}" for scene in library.held_out(writer.scene_ids)]
        writer.splits = _splits(writer.scene_ids, writer.splits, [*held_out, *splits])
    return writer


def _resolution(path: str | os.PathLike[str]) -> float:
    """m, side of the cells of a bank's maps."""
    if os.path.isdir(path):
        return BankShards(path).resolution
    if not os.path.isfile(path):
        return float(SceneBank.load(path).map_resolution)  # its error
    found = array_file.load(path, "a whole scene bank", "build it again, or copy it again", ("map_resolution",))
    return float(found.get("map_resolution", 0.0))


def _in_parts(banks: Sequence[str | os.PathLike[str]]) -> Iterator[SceneBank]:
    """The scenes of banks, of files all at once, of folders some at a time."""
    for path in banks:
        if not os.path.isdir(path):
            yield SceneBank.load(path)
            continue
        shards = BankShards(path)
        for first in range(0, shards.num_scenes, _SCENES_TOGETHER):
            yield SceneBank.take(shards, range(first, min(first + _SCENES_TOGETHER, shards.num_scenes)))


def _with_splits(bank: SceneBank, wanted: Sequence[str]) -> SceneBank:
    splits = _splits(bank.scene_ids, bank.meta["splits"], wanted)
    return dataclasses.replace(bank, meta={**bank.meta, "splits": splits})


def _splits(scene_ids: Sequence[str], splits: Sequence[str], wanted: Sequence[str]) -> list[str]:
    """The splits of scenes where some have other ones: NAME=PATTERN for ids."""
    splits = list(splits)
    for text in wanted:
        name, equals, pattern = text.partition("=")
        rows = [i for i, scene in enumerate(scene_ids) if fnmatch.fnmatchcase(scene, pattern)]
        if not (name and equals and rows):
            raise v.ValidationError(f"--split: found {text!r}, needed NAME=PATTERN that fits some scene of the banks.")
        for i in rows:
            splits[i] = name
    return splits
