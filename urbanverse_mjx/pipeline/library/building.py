"""Compiles the cousins of the layouts of a set and packs all its scenes into one bank; resumes interrupted builds."""

import dataclasses
import pathlib
import shutil
import time
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

from ... import settings, versions
from ...datatypes import BankShardsWriter, SceneGraph
from ...datatypes import validation as v
from ...process_pool import results_as_completed
from ...scene import library
from ..banks import packed_parts
from ..generation.run_folder import key_of

if TYPE_CHECKING:
    from ...materialisation import Cousin

#: Rows of the episode tables.
ROWS = 512
#: Fields of the record of a scene; a record with other fields is of another version, and its scene is built again.
RECORD_FIELDS = (
    "key", "id", "hashes", "objects", "hulls", "prisms", "regions", "episodes", "goals", "left_out", "overlapping",
    "kept_fixed", "let_go", "hanging", "moved_when_let_go", "processor_s", "wall_s",
)  # fmt: skip
#: Further fields of scenes with the regional look: the meshes drawn on roads.
REGIONAL_FIELDS = ("drawn",)


@dataclasses.dataclass(frozen=True)
class Failure:
    """A layout that could not be built, and the reason."""

    layout: str
    reason: str


def _makers(scenes: library.SceneSet) -> dict[str, Callable[[], SceneGraph]]:
    """Source of the graph of each layout of a set: a file, or the generator of the set."""
    if scenes.builder in ("procedural", "places"):
        from ...citygen import procedural_places, procedural_streets

        made = {"procedural": procedural_streets, "places": procedural_places}[scenes.builder]
        names = {f"{scenes.builder}_{k:03d}": k for k in range(made.COUNT)}
        return {name: lambda k=k, name=name: dataclasses.replace(made.build(k), id=name) for name, k in names.items()}
    if scenes.builder == "craft":
        from ...citygen import craftbench

        return {name: lambda name=name: craftbench.build(name, scenes.regional) for name in craftbench.BUILDERS}
    if scenes.builder == "validation":
        from ...citygen import validation_streets

        builders = validation_streets.BUILDERS
        return {name: lambda name=name: validation_streets.build(name, scenes.regional) for name in builders}
    return {name: lambda path=path: SceneGraph.load(path) for name, path in scenes.graphs().items()}


def layouts_of(scenes: library.SceneSet) -> list[str]:
    """Ids of a set's layouts.

    Raises:
      ValidationError: the set has no graph.
    """
    found = list(_makers(scenes))
    if not found:
        raise v.fail(
            f"scenes/{scenes.name}", "no graph", "a folder with a graph per layout", "see `scenes/library.json`"
        )
    return found


def graph_of(scenes: library.SceneSet, layout: str) -> SceneGraph:
    """The graph of a layout, from its file or its generator.

    Raises:
      ValidationError: the set has no layout of this id, its file is damaged, or the set has the regional look and its
        city has none.
    """
    from ...materialisation import check_city

    makers = _makers(scenes)
    graph = makers[v.choice(layout, f"layout of {scenes.name}", tuple(makers))]()
    if scenes.regional:
        check_city(graph)
    return graph


def cousins_of(scenes: library.SceneSet, layout: str) -> Iterator["Cousin"]:
    """The cousins of a layout, under the set's scene ids."""
    from ...materialisation import localise, materialise_cousins

    graph = graph_of(scenes, layout)
    found = materialise_cousins(graph, scenes.cousins, scenes.seed, hulls=scenes.hulls, standing=scenes.standing)
    for k, made in enumerate(found):
        cousin = localise(made, graph, exchange=scenes.exchange, standing=scenes.standing) if scenes.regional else made
        named = dataclasses.replace(cousin.layout, id=scenes.scene_id(layout, k))
        yield dataclasses.replace(cousin, layout=named)


def build_layout(name: str, layout: str) -> list[dict[str, Any]]:
    """Compiles the missing scenes of a layout in this process, because its cousins share meshes and hulls.

    Returns:
      the record of each scene.

    Raises:
      ValidationError: a scene cannot be compiled; earlier ones are kept.
    """
    from ...assets.collision.hulls import close_hash
    from ...assets.records.regional import regional_hash
    from ...assets.records.store import inputs_key

    scenes = library.scene_set(name)
    graph = graph_of(scenes, layout)
    wanted: dict[str, Any] = {"cousins": scenes.cousins, "seed": scenes.seed}
    if scenes.regional:
        wanted["regional"] = regional_hash()
        wanted["look"] = versions.of("look")
    if scenes.exchange:
        wanted["exchange"] = True
    if scenes.hulls:
        wanted["hulls"] = [scenes.hulls, close_hash(scenes.hulls)]
    if scenes.standing:
        wanted["standing"] = True
    key = key_of("library", graph=graph.content_hash(), assets=inputs_key(), **wanted)
    ids = [scenes.scene_id(layout, k) for k in range(scenes.cousins)]
    done = [_record(name, scene, key) for scene in ids]
    if not all(done):
        for k, cousin in enumerate(cousins_of(scenes, layout)):
            done[k] = done[k] or _compile(name, cousin, graph, key)
    return [record for record in done if record]


def _paths(name: str, scene: str) -> tuple[pathlib.Path, pathlib.Path]:
    root = library.folder(name)
    return root / library.SCENES / scene, root / library.RECORDS / f"{scene}.json"


def _record(name: str, scene: str, key: str) -> dict[str, Any] | None:
    """A scene's record, if it has the current fields and key, and its folder is complete; otherwise None."""
    folder, path = _paths(name, scene)
    if not (path.is_file() and (folder / "metadata.json").is_file()):
        return None
    record = v.read_json(path, "record of a scene")
    try:
        v.mapping(record, path.name, RECORD_FIELDS, REGIONAL_FIELDS)
    except v.ValidationError:
        return None
    return record if record["key"] == key else None


def _compile(name: str, cousin: "Cousin", graph: SceneGraph, key: str) -> dict[str, Any]:
    from ...materialisation import index_of
    from ...scene.episodes import EpisodeRules
    from ...scene.stability_trial import let_go
    from ..scenes import compile_layout

    folder, path = _paths(name, cousin.layout.id)
    begin, processor = time.monotonic(), time.process_time()
    try:
        compiled = compile_layout(
            cousin.layout,
            index_of(cousin.layout),
            folder,
            EpisodeRules(rows=ROWS),
            freeze_unstable=True,
            place=graph.source,
        )
    except v.ValidationError as error:
        raise v.ValidationError(f"{cousin.layout.id}: {error}") from error
    trial = let_go(compiled.geometry)
    both = zip(sorted(cousin.layout.objects, key=_id), sorted(compiled.layout.objects, key=_id), strict=True)
    record = {
        "key": key,
        "id": cousin.layout.id,
        "hashes": {
            "graph": graph.content_hash(),
            "layout": cousin.layout.content_hash(),
            "scene": compiled.metadata["hashes"]["layout"],
        },
        **compiled.metadata["counts"],
        "left_out": [entry.id for entry in cousin.left_out],
        "overlapping": [list(pair) for pair in cousin.unresolved],
        "kept_fixed": [a.id for a, b in both if a.movable != b.movable],
        "let_go": trial.standing,
        "hanging": len(trial.hanging),
        "moved_when_let_go": [m.id for m in trial.moved],
        "processor_s": round(time.process_time() - processor, 2),
        "wall_s": round(time.monotonic() - begin, 2),
    }
    v.write_json(path, v.mapping(record, path.name, RECORD_FIELDS, REGIONAL_FIELDS))
    return record


def _id(placed: Any) -> str:
    return placed.id


def build_set(
    name: str,
    workers: int,
    only: str = "",
    progress: Callable[[int, int, str], None] = lambda done, total, said: None,
) -> tuple[dict[str, dict[str, Any]], list[Failure]]:
    """Compiles a set in one process per core, with a layout per task.

    Args:
      only: substring of the ids of the layouts to build.
      progress: called with (layouts done, total, description).

    Returns:
      record of every scene by id, in the set's order, and the layouts that failed.
    """
    from ...assets.records.store import ensure_store

    scenes = library.scene_set(name)
    wanted = [layout for layout in layouts_of(scenes) if only in layout]
    if not wanted:
        raise v.fail("--only", v.show(only), f"a part of a layout's id of {name}", "leave it out")
    records: dict[str, dict[str, Any]] = {}
    failures = []
    ensure_store()
    built = results_as_completed(_built, [(name, layout) for layout in wanted], workers)
    for number, (task, result) in enumerate(built, 1):
        if isinstance(result, Failure):
            failures.append(result)
            said = f"{result.layout}: {result.reason}"
        else:
            records |= {record["id"]: record for record in result}
            said = wanted[task]
        progress(number, len(wanted), said)
    order = [scenes.scene_id(layout, k) for layout in wanted for k in range(scenes.cousins)]
    return {scene: records[scene] for scene in order if scene in records}, failures


def _built(name: str, layout: str) -> list[dict[str, Any]] | Failure:
    """Like `build_layout`, but returns failures instead of raising them."""
    try:
        return build_layout(name, layout)
    except v.ValidationError as error:
        return Failure(layout, str(error))


def pack_set(name: str, records: dict[str, dict[str, Any]], shards: bool = False) -> dict[str, dict[str, int]]:
    """Packs the scenes of a set into its bank, in place of an older one; returns `library.most_in_reach` of each scene.

    Args:
      shards: whether the bank is a folder of shards, of whose scenes few are in memory at once.
    """
    from ...scene import pack_bank

    scenes, home = library.scene_set(name), library.folder(name)
    folders, splits = [_paths(name, scene)[0] for scene in records], [scenes.split_of(scene) for scene in records]
    most: dict[str, dict[str, int]] = {}
    if shards:
        with BankShardsWriter(home / library.SHARDS) as writer:
            for bank in packed_parts(folders, splits):
                most |= {scene: library.most_in_reach(bank, z) for z, scene in enumerate(bank.scene_ids)}
                writer.add(bank.arrays(), bank.meta)
        (home / library.BANK).unlink(missing_ok=True)
        return most
    bank = pack_bank(folders, splits)
    most = {scene: library.most_in_reach(bank, z) for z, scene in enumerate(bank.scene_ids)}
    bank.save(home / library.BANK)
    shutil.rmtree(home / library.SHARDS, ignore_errors=True)
    return most


def write_hashes(name: str, records: dict[str, dict[str, Any]]) -> pathlib.Path:
    """Writes the hashes of the scenes beside the set's graphs, to be committed; hashes of other scenes are kept."""
    path = settings.scene_root() / name / library.HASHES
    known = library.shipped_hashes(name)
    known |= {scene: known.get(scene, {}) | record["hashes"] for scene, record in records.items()}
    return v.write_json(path, dict(sorted(known.items())))
