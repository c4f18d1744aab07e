"""Imports the files of a folder in parallel processes, with a journal from which an import can be resumed."""

import concurrent.futures
import contextlib
import dataclasses
import fcntl
import hashlib
import json
import os
import pathlib
import shutil
import stat
import threading
from collections.abc import Callable, Iterator
from typing import Any, TextIO

import pyarrow as pa
import pyarrow.parquet as pq

from urbanverse_mjx import versions
from urbanverse_mjx.datatypes import AssetRecord, ValidationError
from urbanverse_mjx.datatypes.validation import write_atomically, write_json
from urbanverse_mjx.settings import VisionEndpoint, imported_assets

from ..records.catalogue import SCHEMA
from ..records.index import AssetIndex, save_index
from ..records.user_store import CATALOGUE, INDEX
from . import vision
from .annotation import catalogue_row
from .containment import FAILURES, Bounds, Outcome, check_workers, contained
from .screening import LIMITS, SUFFIXES, decoders
from .work import (
    ANNOTATION,
    MESH,
    OBJECTS,
    PREVIEW,
    RECORD,
    Made,
    Task,
    draw,
    make_asset,
    view_name,
    write_preview,
)

JOURNAL, REPORT = "journal.jsonl", "report.json"


@dataclasses.dataclass(frozen=True)
class Options:
    """Options of an import.

    Attributes:
      licence: of files that state none; without it they are refused.
      leaf: leaf of the ontology for all files; None to use their annotations or names.
      jobs: processes at once.
      again: whether to import files again that the journal lists as done.
      pictures: whether to draw four views of each asset.
      endpoint: vision model for files without an annotation; None to use only the priors.
      bounds: limits of each process.
    """

    licence: str | None = None
    leaf: str | None = None
    jobs: int = 2
    again: bool = False
    pictures: bool = True
    endpoint: VisionEndpoint | None = None
    bounds: Bounds = dataclasses.field(default_factory=Bounds)


@dataclasses.dataclass(frozen=True)
class Entry:
    """One line of the journal: the result of a file.

    Attributes:
      file: path below the imported folder.
      key: hash of content, annotation and options.
      uid: uid of the asset, or None if the file was rejected for `reason` (a keyword) and `why` (a sentence).
      findings: (name, evidence, fixed) of each corruption.
      notes: changes and omissions.
    """

    file: str
    key: str
    uid: str | None
    reason: str = ""
    why: str = ""
    findings: tuple[tuple[str, str, bool], ...] = ()
    notes: tuple[str, ...] = ()


def import_folder(
    folder: str | os.PathLike[str], options: Options = Options(), progress: Callable[[int, int, Entry], object] = print
) -> list[Entry]:
    """Imports every mesh file (`SUFFIXES`) below a folder, or one file, into the user's store; returns an entry for
    each, by name.

    Writes the index, the catalogue and the report at the end, even if the import is interrupted.

    Args:
      progress: called with (files done, files in all, entry) as each file ends.

    Raises:
      ValidationError: the folder does not exist or has no mesh file, another import is running, or no process can be
        started.
    """
    folder, root = pathlib.Path(folder).absolute(), imported_assets()
    files = list(mesh_files(folder))
    folder = folder if folder.is_dir() else folder.parent
    if not files:
        raise ValidationError(f"{folder}: found no file ending in {', '.join(SUFFIXES)}, needed at least one.")
    check_workers()
    root.mkdir(parents=True, exist_ok=True)
    with _alone(root), (root / JOURNAL).open("a", encoding="utf-8") as journal:
        shutil.rmtree(root / "staging", ignore_errors=True)
        if journal.tell() and not (root / JOURNAL).read_bytes().endswith(b"\n"):
            journal.write("\n")  # the last line was cut off; the next one must begin on a new line
        done = {} if options.again else _resumable(root)
        try:
            entries = _run(files, folder, root, options, done, journal, progress)
        finally:
            _write_tables(root)
        write_json(root / REPORT, report(entries))
    return entries


def mesh_files(folder: pathlib.Path) -> Iterator[pathlib.Path]:
    """The mesh files below a folder, by name, or the one file; links to folders are not followed."""
    if folder.is_file() and folder.suffix.lower() in SUFFIXES:
        yield folder
        return
    if not folder.is_dir():
        raise ValidationError(
            f"{folder}: found no such folder, needed one with mesh files, or a file ending in {', '.join(SUFFIXES)}."
        )
    for place, folders, names in os.walk(folder):
        folders.sort()
        yield from (pathlib.Path(place, n) for n in sorted(names) if pathlib.Path(n).suffix.lower() in SUFFIXES)


def report(entries: list[Entry]) -> dict[str, Any]:
    """Counts, imported files, and rejected files with the reason, as JSON."""
    good = [e for e in entries if e.uid]
    bad = [e for e in entries if not e.uid]
    reasons = {reason: sum(e.reason == reason for e in bad) for reason in sorted({e.reason for e in bad})}
    return {
        "files": len(entries),
        "imported": len(good),
        "rejected": len(bad),
        "rejected_for": reasons,
        "assets": [{"file": e.file, "uid": e.uid, "fixed": _fixed(e), "notes": list(e.notes)} for e in good],
        "refusals": [
            {"file": e.file, "reason": e.reason, "why": e.why, "all": [f"{n}: {w}" for n, w, _ in e.findings]}
            for e in bad
        ],
    }


def _fixed(entry: Entry) -> list[str]:
    return [f"{name}: {evidence}" for name, evidence, fixed in entry.findings if fixed]


@contextlib.contextmanager
def _alone(root: pathlib.Path) -> Iterator[None]:
    with (root / ".lock").open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise ValidationError(
                f"{root}: found another import at work on it, needed it alone; wait for its end."
            ) from error
        yield


def _resumable(root: pathlib.Path) -> dict[str, Entry]:
    """key -> entry of the journal. Lines that are cut off or whose asset is missing are ignored, as are failures that
    the machine may have caused."""
    found: dict[str, Entry] = {}
    for line in (root / JOURNAL).read_text(encoding="utf-8", errors="replace").splitlines():
        try:
            row = json.loads(line)
            entry = Entry(**{**row, "findings": tuple(map(tuple, row["findings"])), "notes": tuple(row["notes"])})
        except (ValueError, TypeError, KeyError):
            continue
        if entry.reason not in FAILURES and (entry.uid is None or (_home(root, entry.key) / RECORD).is_file()):
            found[entry.key] = entry
    return found


def _run(
    files: list[pathlib.Path],
    folder: pathlib.Path,
    root: pathlib.Path,
    options: Options,
    done: dict[str, Entry],
    journal: TextIO,
    progress: Callable[[int, int, Entry], object],
) -> list[Entry]:
    writing = threading.Lock()
    entries: list[Entry] = []

    def one(path: pathlib.Path) -> None:
        name = printable(path.relative_to(folder).as_posix())
        key, sha256 = _key(path, name, options)
        known = done.get(key)
        entry = (
            dataclasses.replace(known, file=name)
            if known
            else _import_file(path, folder, root, options, name, key, sha256)
        )
        with writing:
            if not known:
                # Lines are written at once, so that the journal never lists a file that is not done.
                journal.write(json.dumps(dataclasses.asdict(entry)) + "\n")
                journal.flush()
            entries.append(entry)
            progress(len(entries), len(files), entry)

    with concurrent.futures.ThreadPoolExecutor(max(options.jobs, 1)) as pool:
        futures = [pool.submit(one, path) for path in files]
        try:
            for future in concurrent.futures.as_completed(futures):
                future.result()
        finally:
            pool.shutdown(wait=True, cancel_futures=True)
    return sorted(entries, key=lambda e: e.file)


def printable(name: str) -> str:
    """A file's name with characters escaped that terminals, XML or JSON readers cannot handle."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape", "surrogatepass").decode() for c in name)


def _key(path: pathlib.Path, name: str, options: Options) -> tuple[str, str]:
    """(key of a file and of all inputs of its import, SHA-256 of the file)."""
    digest, content = hashlib.sha256(), hashlib.sha256()
    with contextlib.suppress(OSError):
        status = path.stat()
        if stat.S_ISREG(status.st_mode) and status.st_size <= LIMITS.file_bytes:
            with path.open("rb") as file:
                content = hashlib.file_digest(file, "sha256")
        else:
            content.update(f"{status.st_mode} {status.st_size}".encode())
        beside = [path.with_suffix(".json")]
        # Formats other than GLB refer to materials, buffers and images in other files, whose changes are detected by
        # their times.
        if path.suffix.lower() != ".glb":
            beside = sorted(p for p in path.parent.iterdir() if p.is_file())
        for other in beside:
            if other.is_file():
                digest.update(
                    f"{other.name} {other.stat().st_size} {other.stat().st_mtime_ns}\n".encode("utf-8", "replace")
                )
    model = options.endpoint.model if options.endpoint else ""
    # Journals of other versions are not resumed; a refusal names a decoder, which may have been installed since.
    code = json.dumps([versions.of("imports"), decoders()])
    digest.update(
        f"{code} {content.hexdigest()} {options.licence} {options.leaf} {model} {name}".encode("utf-8", "replace")
    )
    return digest.hexdigest()[:32], content.hexdigest()


def _home(root: pathlib.Path, key: str) -> pathlib.Path:
    return root / OBJECTS / key


def _import_file(
    path: pathlib.Path, folder: pathlib.Path, root: pathlib.Path, options: Options, name: str, key: str, sha256: str
) -> Entry:
    staging = root / "staging" / key
    task = Task(path, folder, staging, name, sha256, options.licence, options.leaf)
    notes: list[str] = []
    try:
        if options.endpoint and not path.with_suffix(".json").is_file():
            task, outcome = _with_annotation(task, options, notes)
            if outcome.reason:
                return Entry(name, key, None, outcome.reason, outcome.sentence, notes=tuple(notes))
        outcome = contained(make_asset, task, bounds=options.bounds)
        if outcome.reason:
            return Entry(name, key, None, outcome.reason, outcome.sentence, notes=tuple(notes))
        made: Made = outcome.value
        findings = tuple((f.name, f.evidence, f.fixed) for f in made.findings)
        notes += made.notes
        if made.uid is None:
            first = next(f for f in made.findings if not f.fixed)
            return Entry(name, key, None, first.name, first.evidence, findings, tuple(notes))
        if options.pictures:
            drawn = contained(draw, staging, MESH, bounds=options.bounds)
            notes += [drawn.sentence] if drawn.reason else []
        (staging / PREVIEW).unlink(missing_ok=True)
        home = _home(root, key)
        home.parent.mkdir(parents=True, exist_ok=True)
        shutil.rmtree(home, ignore_errors=True)
        staging.replace(home)
        return Entry(name, key, made.uid, findings=findings, notes=tuple(notes))
    finally:
        shutil.rmtree(staging, ignore_errors=True)


def _with_annotation(task: Task, options: Options, notes: list[str]) -> tuple[Task, Outcome]:
    """The task with the vision endpoint's annotation; unchanged without a usable answer, so that the priors apply."""
    assert options.endpoint is not None
    outcome = contained(write_preview, task, bounds=options.bounds)
    if outcome.reason:
        return task, outcome
    drawn = contained(draw, task.staging, PREVIEW, bounds=options.bounds)
    if drawn.reason:
        notes.append(f"annotated from the priors: {drawn.sentence}")
        return task, Outcome()
    views = [(task.staging / view_name(k)).read_bytes() for k in range(4)]
    try:
        seen, complaints = vision.annotate(options.endpoint, views, task.path.name)
    except vision.VisionError as error:
        notes.append(f"annotated from the priors: {error}")
        return task, Outcome()
    notes += [f"left out of the endpoint's answer: {text}" for text in complaints]
    return dataclasses.replace(task, seen=seen), Outcome()


def _write_tables(root: pathlib.Path) -> None:
    """Writes the index and the catalogue of the existing assets; of two with the same uid, the first is used."""
    records: dict[str, AssetRecord] = {}
    rows: dict[str, dict[str, Any]] = {}
    for path in sorted((root / OBJECTS).glob(f"*/{RECORD}")):
        body = json.loads(path.read_text(encoding="utf-8"))
        record = AssetRecord.from_json(body, path.parent.name)
        if record.uid not in records:
            whole = json.loads(path.with_name(ANNOTATION).read_text(encoding="utf-8"))
            records[record.uid] = record
            rows[record.uid] = catalogue_row(record, whole) | {"params": json.dumps(record.params, sort_keys=True)}
    save_index(AssetIndex(records.values()), root / INDEX)
    table = pa.Table.from_pylist([rows[uid] for uid in sorted(rows)], SCHEMA)
    write_atomically(root / CATALOGUE, lambda p: pq.write_table(table, p, compression="zstd"))
