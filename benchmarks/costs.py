"""What generation and annotation take: processor seconds, memory, and money.

    urbanverse gen FILM --out RUN --cousins 1 --workers 1
    python -m benchmarks.costs --run RUN                  # stages of that run, from its run.json
    python -m benchmarks.costs --library urbanverse160    # scenes an hour, from the report of a set of the library
    python -m benchmarks.costs --annotate 5               # imports exported assets with the priors of their categories
    python -m benchmarks.costs --batch local ray --workers 2   # cousins of the six shipped graphs, by executor
    python -m benchmarks.costs --page                     # docs/costs.md

Processor time counts, because it does not depend on what else a machine does. Scenes an hour on 2 cores are two
processor hours by the mean of a set, whose scenes are compiled in a process per core; those on 16 cores are an estimate
from the same mean. `--batch` takes the clock's time, too, of five cousins of each shipped graph by the executors in
turn: it says what an executor costs, and scenes an hour only of a machine that does nothing else. Money for an endpoint
is an estimate too: tokens by the rule of thumb of `urbanverse gen` (an image of 768 pixels counts for at most 765, four
letters for one) at the prices of `PRICES`, which stand for any.

Results are kept in benchmarks/scores/costs.csv.
"""

import argparse
import contextlib
import os
import pathlib
import statistics
import sys
import threading
import time
from collections.abc import Sequence
from typing import Any

import psutil

from benchmarks.lib import tables
from benchmarks.results import with_table
from benchmarks.robots import keep, kept
from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.work_folder import work_folder

ROOT = pathlib.Path(__file__).parents[1]
SCORES, PAGE = ROOT / "benchmarks/scores/costs.csv", ROOT / "docs/costs.md"
MARKS = "<!-- costs: python -m benchmarks.costs --page -->", "<!-- end of costs -->"
#: Dollars for a million tokens sent and answered, and for an hour of a processor core: round numbers to scale by.
PRICES = {"sent": 1.0, "answered": 4.0, "core_hour": 0.05}
#: Tokens of the answer about an asset, with all fields, and of a list of categories: typical, not measured.
ANSWERS = {"asset": 500, "listing": 150}
#: Frames of a film whose listing is estimated: 60 s at two a second.
FRAMES = 120
STAGES = ("frames", "recording", "graph", "cousins", "scenes/0", "bank", "report")


def run_costs(folder: pathlib.Path) -> dict[str, Any]:
    """Stages of a run of `urbanverse gen`, with the number of its frames.

    Raises:
      ValidationError: there is no run, or it is from before processor time was recorded.
    """
    path = folder / "run.json"
    if not path.is_file():
        raise v.fail(str(folder), "no run.json", "the folder of a run of `urbanverse gen`")
    stages = {name: x for name, x in v.read_json(path, "run's record")["stages"].items() if name in STAGES}
    if not any("processor_s" in stage for stage in stages.values()):
        raise v.fail(str(path), "no processor time", "a run of this version", "run `urbanverse gen` again")
    recording = folder / "recording/recording.json"
    frames = len(list((folder / "frames").glob("*.png")) or list((folder / "frames").glob("*.jpg")))
    return {
        "frames": frames,
        "perceived": recording.is_file(),
        "stages": {
            name: {"processor_s": stages[name]["processor_s"], "memory_mb": stages[name].get("memory_mb")}
            for name in STAGES
            if "processor_s" in stages.get(name, {})
        },
    }


def library_costs(name: str) -> dict[str, Any]:
    """Processor seconds of the scenes of a set of the library, as its records have them."""
    folder = settings.cache_dir("library", name, "records")
    records = [v.read_json(path, "record") for path in sorted(folder.glob("*.json"))]
    if not records:
        raise v.fail(f"library {name!r}", f"no records in {folder}", f"`urbanverse scene library {name}`")
    spent = [float(record["processor_s"]) for record in records]
    mean = statistics.fmean(spent)
    return {
        "scenes": len(spent),
        "objects": round(statistics.fmean(record["objects"] for record in records)),
        "processor_s": round(mean, 2),
        "most_s": round(max(spent), 2),
        "scenes_an_hour_2_cores": round(2 * 3600 / mean),
        "scenes_an_hour_16_cores_estimated": round(16 * 3600 / mean),
    }


def annotation_costs(count: int) -> dict[str, Any]:
    """Processor seconds of an import with annotation by priors: assets of the index, exported and imported again."""
    from urbanverse_mjx.assets.exporting.export import export_asset
    from urbanverse_mjx.assets.importing.run import Options, import_folder
    from urbanverse_mjx.assets.records.index import full_index

    records = full_index().records
    chosen = [records[k * len(records) // count] for k in range(count)]
    with work_folder("urbanverse-costs-") as folder:
        files = pathlib.Path(folder) / "files"
        for record in chosen:
            export_asset(record, files, "glb")
        for annotation in files.glob("*.json"):
            annotation.unlink()
        before = os.environ.get("URBANVERSE_CACHE")
        os.environ["URBANVERSE_CACHE"] = str(pathlib.Path(folder) / "cache")
        try:
            with _Watched() as watched:
                entries = import_folder(files, Options("CC0-1.0", chosen[0].leaf, 1), lambda *_: None)
        finally:
            os.environ.pop("URBANVERSE_CACHE")
            if before is not None:
                os.environ["URBANVERSE_CACHE"] = before
    done = sum(entry.uid is not None for entry in entries)
    return {"assets": len(entries), "imported": done, "processor_s": round(watched.seconds / max(len(entries), 1), 2)}


def batch_costs(executor: str, workers: int, cousins: int = 5) -> dict[str, Any]:
    """Seconds of the clock and of processors for cousins of the shipped graphs by `urbanverse gen batch`.

    Raises:
      ValidationError: a source failed, or the executor is not installed.
    """
    from urbanverse_mjx.pipeline.generation.batch import run_batch
    from urbanverse_mjx.pipeline.generation.stages import GenerationOptions

    graphs = sorted(settings.scene_root().glob("*/graph.json"))
    with work_folder("urbanverse-costs-") as folder:
        names = pathlib.Path(folder) / "sources.txt"
        names.write_text("".join(f"{path}\n" for path in graphs), encoding="utf-8")
        options = GenerationOptions(cousins=cousins, usd=False, pictures=False)
        begin = time.monotonic()
        with _Watched() as watched:
            found = run_batch(names, pathlib.Path(folder) / "out", options, executor, workers, retries=0)
        seconds = time.monotonic() - begin
        if found["failed"]:
            raise ValidationError(f"--batch {executor}: found {found['failed']}, needed cousins of all shipped graphs.")
    scenes = len(graphs) * cousins
    return {
        "executor": executor,
        "workers": workers,
        "scenes": scenes,
        "seconds": round(seconds, 1),
        "processor_s": round(watched.seconds / scenes, 2),
        "scenes_an_hour": round(3600 * scenes / seconds),
    }


class _Watched:
    """Processor seconds of this process and of all below it, looked at ten times a second; steps of an import run in
    processes that a server of the standard library forks, whose times no parent gets."""

    def __init__(self) -> None:
        self.seconds = 0.0
        self._spent: dict[tuple[int, float], float] = {}
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._look, daemon=True)

    def __enter__(self) -> "_Watched":
        self._begin = time.process_time()
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        self._thread.join()
        self.seconds = time.process_time() - self._begin + sum(self._spent.values())

    def _look(self) -> None:
        while not self._over.wait(0.1):
            for child in psutil.Process().children(recursive=True):
                with contextlib.suppress(psutil.Error):
                    spent = child.cpu_times()
                    self._spent[child.pid, child.create_time()] = spent.user + spent.system


def endpoint_costs() -> dict[str, dict[str, float]]:
    """Tokens and dollars of an endpoint, estimated: of a film's list of categories, and of an asset's annotation."""
    from urbanverse_mjx.assets.categories import ontology
    from urbanverse_mjx.assets.importing import vision
    from urbanverse_mjx.pipeline.generation import listing

    images = FRAMES // listing.EVERY
    requests = -(-images // listing.PER_REQUEST)
    leaves = ", ".join(ontology.categories())
    # Of a size that is none of the listing's, by the same rule: four views of at most 768 pixels.
    asked = {
        "listing": (images, requests * len(listing.ASK.format(leaves=leaves)), requests * ANSWERS["listing"]),
        "asset": (4, len(vision.PROMPT.format(name='""', leaves=leaves)), ANSWERS["asset"]),
    }
    return {
        name: {
            "sent": sent,
            "answered": answered,
            "dollars": round((sent * PRICES["sent"] + answered * PRICES["answered"]) / 1e6, 4),
        }
        for name, (images, letters, answered) in asked.items()
        for sent in [images * listing.TOKENS_PER_IMAGE + letters // listing.LETTERS_PER_TOKEN]
    }


def page_text(path: pathlib.Path = SCORES) -> str:
    """Markdown of the tables."""
    found, parts = kept(path), []
    cents = PRICES["core_hour"] / 3600.0 * 100.0
    for name, row in found.items():
        if "run" in row:
            run = row["run"]
            lines = [
                f"`{name}`, {run['frames']} frames:",
                "",
                "| stage | processor, s | a frame | largest memory, MB | cents |",
                "| --- | --- | --- | --- | --- |",
            ]
            for stage in [stage for stage in STAGES if stage in run["stages"]]:
                taken = run["stages"][stage]
                spent, memory = taken["processor_s"], taken["memory_mb"]
                each = f"{spent / run['frames']:.2f}" if run["frames"] and stage in STAGES[:3] else ""
                cells = [stage.replace("scenes/0", "scene"), f"{spent:.1f}", each, f"{memory or 0:.0f}"]
                lines.append(f"| {' | '.join([*cells, f'{spent * cents:.3f}'])} |")
            whole = sum(taken["processor_s"] for taken in run["stages"].values())
            lines.append(f"| all | {whole:.1f} | | | {whole * cents:.3f} |")
            parts.append("\n".join(lines))
    sets = {name: row["library"] for name, row in found.items() if "library" in row}
    if sets:
        head = ["set", "scenes", "objects a scene", "processor a scene, s", "most, s", "scenes an hour, 2 cores"]
        head += ["16 cores (estimated)", "cents a scene"]
        fields = ("scenes", "objects", "processor_s", "most_s")
        fields += ("scenes_an_hour_2_cores", "scenes_an_hour_16_cores_estimated")
        rows = [
            [name, *(str(one[field]) for field in fields), f"{one['processor_s'] * cents:.3f}"]
            for name, one in sets.items()
        ]
        parts.append(tables.markdown(head, rows))
    batches = [row["batch"] for row in found.values() if "batch" in row]
    if batches:
        head = ["executor", "sources at a time", "scenes", "s", "scenes an hour", "processor a scene, s"]
        fields = ("executor", "workers", "scenes", "seconds", "scenes_an_hour", "processor_s")
        parts.append(tables.markdown(head, [[str(one[field]) for field in fields] for one in batches]))
    lines = ["| what | processor, s | tokens sent | answered | dollars |", "| --- | --- | --- | --- | --- |"]
    for row in found.values():
        if "annotation" in row:
            one = row["annotation"]
            text = f"an asset by priors, with four views and hulls ({one['imported']} of {one['assets']} imported)"
            lines.append(f"| {text} | {one['processor_s']} | 0 | 0 | {one['processor_s'] * cents / 100:.5f} |")
    for name, one in endpoint_costs().items():
        text = f"list of categories of {FRAMES} frames" if name == "listing" else "an asset by an endpoint, besides"
        tokens = f"{one['sent']:.0f} | {one['answered']:.0f}"
        lines.append(f"| {text} (estimated) | | {tokens} | {one['dollars']:.4f} |")
    return "\n\n".join([*parts, "\n".join(lines)])


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.costs", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--run", type=pathlib.Path, help="folder of a run of `urbanverse gen`")
    parser.add_argument("--name", default="film", help="name of that run in the table")
    parser.add_argument("--library", nargs="+", default=(), help="sets of the scene library")
    parser.add_argument("--annotate", type=int, default=0, help="number of assets to import")
    parser.add_argument("--batch", nargs="+", default=(), metavar="EXECUTOR", help="local or ray, measured in turn")
    parser.add_argument("--workers", type=int, default=2, help="sources of a batch at a time")
    parser.add_argument("--page", action="store_true")
    arguments = parser.parse_args(argv)
    if arguments.annotate < 0:
        parser.error("--annotate must not be negative")
    if arguments.run is not None:
        keep(arguments.name, "run", run_costs(arguments.run), SCORES)
    for name in arguments.library:
        keep(name, "library", library_costs(name), SCORES)
    if arguments.annotate:
        keep("assets", "annotation", annotation_costs(arguments.annotate), SCORES)
    for executor in arguments.batch:
        row = batch_costs(executor, arguments.workers)
        print(row, file=sys.stderr)
        keep(f"{executor}, {arguments.workers}", "batch", row, SCORES)
    if arguments.page:
        PAGE.write_text(with_table(PAGE.read_text(encoding="utf-8"), page_text(), MARKS), encoding="utf-8")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except ValidationError as error:
        sys.exit(str(error))
