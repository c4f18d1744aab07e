"""`urbanverse scene library`: builds the sets of the scene library into the cache."""

import dataclasses
import json
import sys
from typing import Annotated, Any

import tyro

from .. import settings
from ..datatypes import validation as v
from ..scene import library


@dataclasses.dataclass(frozen=True)
class LibraryArgs:
    """Build sets of scenes into the cache: cousins, compiled scenes, one bank each; prints one JSON line per set.

    Goes on where it stopped. Exit status 1 where a layout failed, a scene's hash is not the committed one, or more
    hulls come within a robot's reach than the physics model has slots for.
    """

    sets: Annotated[tuple[str, ...], tyro.conf.Positional] = ()
    """Names from scenes/library.json; none: all."""
    workers: int | None = None
    """Processes; default: the cores this process may use."""
    only: str = ""
    """Only layouts with this in their id; then no bank is packed."""
    bank: bool = True
    """Pack the set's bank."""
    write_hashes: bool = False
    """Write the scenes' hashes into scenes/<set>/hashes.json instead of comparing them."""
    quiet: bool = False


def main(args: LibraryArgs) -> int:
    """Runs `urbanverse scene library`."""
    names = args.sets or tuple(library.sets())
    for name in names:
        library.scene_set(name)
    if args.workers is not None:
        v.integer(args.workers, "--workers", 1, 1024)
    return max(_build(name, args) for name in names)


def _build(name: str, args: LibraryArgs) -> int:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    from ..pipeline.library.building import build_set, pack_set, write_hashes

    columns = (TextColumn("{task.description:<16}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), disable=args.quiet) as bars:
        task = bars.add_task(name, total=None)

        def report(done: int, total: int, said: str) -> None:
            bars.update(task, completed=done, total=total)
            bars.console.print(said, highlight=False, markup=False) if args.quiet is False else None

        records, failures = build_set(name, args.workers or settings.num_threads(), args.only, report)
    for failure in failures:
        sys.stderr.write(f"{failure.layout}: {failure.reason}\n")
    known = library.shipped_hashes(name)
    other = [
        scene
        for scene, r in records.items()
        if (known.get(scene, {}) | r["hashes"]) != (r["hashes"] | known.get(scene, {}))
    ]
    if args.write_hashes:
        write_hashes(name, records)
        other = []
    for scene in other:
        sys.stderr.write(f"{scene}: other content than committed in scenes/{name}/{library.HASHES}\n")
    summary: dict[str, Any] = _summary(name, records)
    if args.bank and records and not args.only:
        most = pack_set(name, records)
        summary |= {"bank": str(library.bank_path(name)), "most_hulls_in_reach": max(most.values())}
        summary["slot_overflow"] = {scene: n for scene, n in most.items() if n > library.SLOTS}
        for scene, n in summary["slot_overflow"].items():
            sys.stderr.write(f"{scene}: {n} hulls within a robot's reach, more than the {library.SLOTS} slots\n")
    report_file = library.folder(name) / "report.json"
    v.write_json(report_file, {**summary, "scenes": records, "failed": [dataclasses.asdict(f) for f in failures]})
    print(json.dumps({**summary, "failed": [f.layout for f in failures], "other_hash": other}))
    return 1 if failures or other or summary.get("slot_overflow") else 0


def _summary(name: str, records: dict[str, dict[str, Any]]) -> dict[str, Any]:
    rows = list(records.values())
    objects = sum(r["objects"] for r in rows)
    let_go, moved = sum(r["let_go"] for r in rows), sum(len(r["moved_when_let_go"]) for r in rows)
    return {
        "set": name,
        "built": len(rows),
        "objects": objects,
        "hulls": sum(r["hulls"] for r in rows),
        "episodes_least": min((r["episodes"] for r in rows), default=0),
        "left_out": sum(len(r["left_out"]) for r in rows),
        "let_go": let_go,
        "still_percent_of_let_go": round(100 * (1 - moved / max(let_go, 1)), 1),
        "still_percent_of_all": round(100 * (1 - moved / max(objects, 1)), 1),
        "processor_s": round(sum(r["processor_s"] for r in rows)),
    }
