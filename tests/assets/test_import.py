"""Import of mesh files: 20 good ones are imported unchanged, broken and hostile ones are refused without harm."""

import json
import os
import pathlib
import shutil
import time

import numpy as np
import pytest

from tests.assets import mesh_files
from urbanverse_mjx.assets import build_mesh, full_index, imported_index, load_hulls, load_index
from urbanverse_mjx.assets.importing import run
from urbanverse_mjx.assets.importing.containment import CRASHED, MEMORY, TIME, Bounds, contained
from urbanverse_mjx.assets.importing.corruption import CORRUPTIONS
from urbanverse_mjx.assets.importing.run import Entry, Options, import_folder
from urbanverse_mjx.datatypes import ValidationError

QUICK = Options(pictures=False)


def quiet(done: int, of: int, entry: Entry) -> None:
    pass


@pytest.fixture(scope="module")
def street(tmp_path_factory: pytest.TempPathFactory):
    """20 good files and more than 20 broken ones, imported; (folder, cache, wanted, entries by file name)."""
    folder, cache = tmp_path_factory.mktemp("files"), tmp_path_factory.mktemp("cache")
    patch = pytest.MonkeyPatch()
    patch.setenv("URBANVERSE_CACHE", str(cache))
    good = mesh_files.write_good(folder)
    bad = mesh_files.write_corrupt(folder) | mesh_files.write_hostile(folder)
    start = time.perf_counter()
    entries = {e.file: e for e in import_folder(folder, QUICK, quiet)}
    print(f"{len(entries)} files in {time.perf_counter() - start:.1f} s")
    yield folder, cache, good, bad, entries
    patch.undo()


@pytest.mark.extended
def test_every_good_file_is_imported(street) -> None:
    _, _, good, _, entries = street
    assert len(good) >= 20
    refused = {name: (entries[name].reason, entries[name].why) for name in good if not entries[name].uid}
    assert refused == {}


def test_every_broken_file_is_named(street) -> None:
    _, _, good, bad, entries = street
    assert len(bad) >= 20
    assert set(CORRUPTIONS) <= set(bad.values())
    assert {name: entries[name].reason for name in bad} == bad
    assert all(entries[name].why for name in bad)
    assert set(entries) == set(good) | set(bad)


def test_an_imported_asset_is_the_one_it_was(street) -> None:
    """Leaf, box, frame and hulls against the record that the file was made from."""
    _, _, good, _, entries = street
    index = imported_index()
    for name, record in good.items():
        mine = index.get(entries[name].uid)
        assert mine.leaf == record.leaf, name
        assert mine.extent_xyz == pytest.approx(record.extent_xyz, rel=0.02 if "x5" not in name else 0.15), name
        mesh, hulls = build_mesh(mine), load_hulls(mine).hulls
        assert mesh.extent == pytest.approx(mine.extent_xyz, abs=1e-3)
        assert mesh.vertices[:, 2].min() == pytest.approx(0.0, abs=1e-5)
        assert np.abs((mesh.vertices.max(0) + mesh.vertices.min(0))[:2]).max() < 1e-4
        assert len(hulls) <= 16
        assert 0.2 < mine.mass / record.mass < 5, (name, mine.mass, record.mass)
        assert mine.required_force == pytest.approx(mine.friction_coefficient * mine.mass * 9.81, rel=0.01, abs=0.1)
        assert mine.licence == mesh_files.LICENCE
        assert name in mine.provenance


def test_what_was_fixed_is_said(street) -> None:
    _, _, good, _, entries = street
    said = {name: e.findings[0] for name, e in entries.items() if e.uid and e.findings}
    assert set(said) == {name for name in good if " x" in name}
    assert all(name == "non-uniform scale" and fixed for name, _, fixed in said.values())
    texts = " ".join(evidence for _, evidence, _ in said.values())
    assert all(unit in texts for unit in ("centimetres", "millimetres", "inches", "in no unit"))


def test_the_index_opens_beside_the_packaged_one(street) -> None:
    _, cache, good, _, entries = street
    index = full_index()
    assert len(index.records) == len(load_index().records) + len({entries[n].uid for n in good})
    assert any("imported" in r.uid for r in index.by_leaf("bench"))
    again = load_index(cache / "assets" / "imported" / "index.parquet")
    assert again.records == imported_index().records
    import pyarrow.parquet as pq

    from urbanverse_mjx.assets.records.catalogue import SCHEMA

    table = pq.read_table(cache / "assets" / "imported" / "catalogue.parquet")
    assert table.schema.names == SCHEMA.names
    assert table.num_rows == len(again.records)
    assert min(table["mass"].to_pylist()) > 0


def test_hostile_files_hurt_nothing(street) -> None:
    folder, cache, _, _, _ = street
    root = cache / "assets" / "imported"
    assert not (root / "staging").exists() or not list((root / "staging").iterdir())
    assert not [p for p in folder.parent.iterdir() if "secret" in p.name]
    names = {p.name for p in root.iterdir()}
    assert names <= {
        "objects",
        "journal.jsonl",
        "report.json",
        "index.parquet",
        "catalogue.parquet",
        ".lock",
        "staging",
    }


def test_the_report_says_it_all(street) -> None:
    _, cache, good, bad, entries = street
    report = json.loads((cache / "assets" / "imported" / "report.json").read_text(encoding="utf-8"))
    assert (report["files"], report["imported"], report["rejected"]) == (len(entries), len(good), len(bad))
    assert sum(report["rejected_for"].values()) == len(bad)
    assert {row["file"]: row["reason"] for row in report["refusals"]} == bad


def test_a_second_import_reads_the_journal(street, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Only files that the journal lost are imported again: a truncated line, a removed asset."""
    folder, cache, _, _, entries = street
    # Other tests read what is there.
    cache = shutil.copytree(cache, tmp_path / "cache")
    monkeypatch.setenv("URBANVERSE_CACHE", str(cache))
    root = cache / "assets" / "imported"
    made = []
    monkeypatch.setattr(
        run, "_import_file", lambda *args: made.append(args[4]) or Entry(args[4], args[5], None, "x", "y")
    )
    again = {e.file: e for e in import_folder(folder, QUICK, quiet)}
    assert made == []
    assert again == entries
    journal = (root / "journal.jsonl").read_text(encoding="utf-8")
    lost = json.loads(journal.splitlines()[-1])["file"]
    (root / "journal.jsonl").write_text(journal[:-40], encoding="utf-8")
    import_folder(folder, QUICK, quiet)
    assert made == [lost]
    assert json.loads((root / "journal.jsonl").read_text(encoding="utf-8").splitlines()[-1])["file"] == lost
    (root / "journal.jsonl").write_text(journal, encoding="utf-8")
    import_folder(folder, Options(pictures=False, licence="MIT"), quiet)
    assert len(made) == 1 + len(entries), "another licence is another import"
    (root / "journal.jsonl").write_text(journal, encoding="utf-8")


@pytest.fixture
def store(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> pathlib.Path:
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path / "cache"))
    (tmp_path / "files").mkdir()
    return tmp_path / "files"


def test_an_exported_asset_comes_back_with_its_annotation(store: pathlib.Path) -> None:
    """OBJ with its official JSON: mass, friction and description are the annotation's, and images are drawn."""
    from urbanverse_mjx.assets.exporting.export import export_asset

    record = load_index().by_leaf("trash bin")[0]
    export_asset(record, store, "obj")
    (entry,) = import_folder(store, Options(jobs=1), quiet)
    assert entry.uid, entry
    mine = imported_index().get(entry.uid)
    for name in ("category", "mass", "friction_coefficient", "movable", "description", "materials", "licence"):
        assert getattr(mine, name) == getattr(record, name), name
    assert mine.extent_xyz == pytest.approx(record.extent_xyz, abs=1e-3)
    home = pathlib.Path(os.environ["URBANVERSE_CACHE"]) / "assets" / "imported" / mine.params["path"]
    views = sorted(home.parent.glob("view_*.png"))
    assert len(views) == 4 or any("no images" in note for note in entry.notes)


def _stuck() -> None:
    while True:
        pass


def _crash() -> None:
    os.abort()


def _hungry() -> int:
    return len(bytearray(3 * 2**30))


def test_a_contained_function_cannot_take_the_others_with_it() -> None:
    start = time.perf_counter()
    assert contained(_crash).reason == CRASHED
    assert contained(_stuck, bounds=Bounds(seconds=1.0)).reason == TIME
    assert contained(_hungry, bounds=Bounds(memory=2**30)).reason == MEMORY
    assert contained(os.getpid).value != os.getpid()
    assert time.perf_counter() - start < 60


def test_a_folder_without_meshes_and_a_busy_store_are_refused(store: pathlib.Path) -> None:
    with pytest.raises(ValidationError, match="no file ending in"):
        import_folder(store, QUICK, quiet)
    with pytest.raises(ValidationError, match="no such folder"):
        import_folder(store / "nowhere", QUICK, quiet)


def test_a_changed_mesh_is_not_taken_for_the_imported_one(street) -> None:
    _, cache, _, _, entries = street
    record = imported_index().get(entries["a\\nrock.glb"].uid)
    path = cache / "assets" / "imported" / record.params["path"]
    body = path.read_bytes()
    path.write_bytes(body + b" ")
    from urbanverse_mjx.assets.records import user_store

    user_store._read.cache_clear()
    with pytest.raises(ValidationError, match="changed"):
        build_mesh(record)
    path.write_bytes(body)
    outside = type(record)(**{**vars(record), "params": {"path": "../../../etc/passwd", "sha256": "0"}})
    with pytest.raises(ValidationError, match="inside"):
        build_mesh(outside)
