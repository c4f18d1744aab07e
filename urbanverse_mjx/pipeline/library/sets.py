"""Builds a set of the scene library, compares it with its committed hashes, and packs it."""

import dataclasses
from typing import Any

from ... import settings
from ...datatypes import validation as v
from ...progress import Progress
from ...scene import library
from .building import build_set, pack_set, write_hashes


@dataclasses.dataclass(frozen=True)
class LibraryOptions:
    """The part of a set to build."""

    workers: int | None = None
    """Processes; default: the cores this process may use."""
    only: str = ""
    """Only layouts whose id contains this; no bank is packed then."""
    bank: bool = True
    """Pack the set's bank."""
    shards: bool = False
    """Write the bank as a folder of shards, bank.bank, in place of the file bank.npz: with few scenes in memory at
    once, and read scene by scene."""
    write_hashes: bool = False
    """Write the scenes' hashes into scenes/<set>/hashes.json instead of comparing them."""


@dataclasses.dataclass(frozen=True)
class LibraryBuild:
    """The result of building a set.

    Attributes:
      summary: counts over the scenes; if a bank was packed, also its file and the largest numbers of hulls and ground
        prisms within reach of a robot, for which engines need slots.
      failed: layout -> reason why it could not be built.
      other_hash: scenes with other content than committed.
    """

    summary: dict[str, Any]
    failed: dict[str, str]
    other_hash: tuple[str, ...]

    @property
    def ok(self) -> bool:
        """Whether every layout was built and has its committed hash."""
        return not (self.failed or self.other_hash)


def build_library(name: str, options: LibraryOptions | None = None, quiet: bool = True) -> LibraryBuild:
    """Builds a set of scenes into the cache: cousins, compiled scenes, one bank. An interrupted build continues.

    Args:
      name: name of a set in scenes/library.json.
      quiet: whether to show no progress bar on standard error.

    Raises:
      ValidationError: the set does not exist, or no layout matches `only`.
    """
    options = options or LibraryOptions()
    library.scene_set(name)
    if options.workers is not None:
        v.integer(options.workers, "--workers", 1, 1024)
    with Progress(quiet) as progress:
        task = progress.task(name, unit="layouts")

        def report(done: int, total: int, said: str) -> None:
            task(done, total)
            if not quiet:
                progress.print(said)

        records, failures = build_set(name, options.workers or settings.num_threads(), options.only, report)
    known = library.shipped_hashes(name)
    other = [
        scene
        for scene, r in records.items()
        if (known.get(scene, {}) | r["hashes"]) != (r["hashes"] | known.get(scene, {}))
    ]
    if options.write_hashes:
        write_hashes(name, records)
        other = []
    summary = _summary(name, records)
    if options.bank and records and not options.only:
        most = pack_set(name, records, options.shards)
        summary["bank"] = str(library.bank_path(name))
        summary |= {f"most_{kind}_in_reach": max(n[kind] for n in most.values()) for kind in ("hulls", "prisms")}
        records = {scene: {**record, "in_reach": most[scene]} for scene, record in records.items()}
    failed = [dataclasses.asdict(f) for f in failures]
    v.write_json(library.folder(name) / "report.json", {**summary, "scenes": records, "failed": failed})
    return LibraryBuild(summary, {f.layout: f.reason for f in failures}, tuple(other))


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
