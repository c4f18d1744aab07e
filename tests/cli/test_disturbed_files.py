"""Files and folders that vanish or refuse to be written at any moment of a command, and a clock that goes backwards."""

import errno
import json
import os
import pathlib
import shutil
import subprocess
import sys
import time

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from tests.cli.test_scene_compile import _good
from tests.support.disturbed import REFUSALS
from urbanverse_mjx.assets.records.store import ensure_store
from urbanverse_mjx.cli import compilation_cache
from urbanverse_mjx.datatypes import array_file
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.pipeline.errors import refusal
from urbanverse_mjx.pipeline.generation.run_folder import RunFolder
from urbanverse_mjx.training.run_folder import new_run
from urbanverse_mjx.work_folder import OWNER, work_folder

EXPORT = ("assets", "export", "--uid", "bollard/posts-bollard/000", "--form", "obj", "--out", "{run}/out")


def runs(folder: pathlib.Path, kind: str, *words: str) -> list[dict]:
    """The runs of a command, each with another access disturbed; the first one undisturbed."""
    (folder / "cache" / "assets").mkdir(parents=True)
    shutil.copy(ensure_store(), folder / "cache" / "assets")
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-m", "tests.support.disturbed", str(folder), kind, *words],
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    )
    return [json.loads(line) for line in done.stdout.splitlines()]


def check_deleted(found: list[dict]) -> None:
    whole = found[0]
    assert whole["status"] == 0
    assert len(whole["seen"]) >= 5
    assert len(found) == len(whole["seen"]) + 2
    for run in found:
        assert (run["status"], run["left"]) == (0, whole["left"]), run
        assert "Traceback" not in run["said"]


@pytest.mark.skipif(not hasattr(os, "fork"), reason="runs are forked")
def test_a_command_outlives_its_cache_at_every_moment(tmp_path: pathlib.Path) -> None:
    check_deleted(runs(tmp_path, "deleted", *EXPORT))


@pytest.mark.slow
def test_a_compiled_street_outlives_its_cache_at_every_moment(tmp_path: pathlib.Path) -> None:
    (tmp_path / "graph.json").write_text(json.dumps(_good()))
    check_deleted(runs(tmp_path, "deleted", "scene", "compile", str(tmp_path / "graph.json"), "--out", "{run}/street"))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="runs are forked")
@pytest.mark.parametrize("kind", ["refused:8", pytest.param("refused", marks=pytest.mark.slow)])
def test_a_write_that_is_refused_is_one_sentence_and_leaves_no_half(kind: str, tmp_path: pathlib.Path) -> None:
    """A full disk, a read-only file system, a quota and a folder of someone else, in turn."""
    found = runs(tmp_path, kind, *EXPORT)
    assert len(found) >= 1 + 2 * len(REFUSALS)
    whole, statuses = found[0]["left"], set()
    for run in found[:-1]:
        statuses.add(run["status"])
        assert run["status"] in (0, 2), run
        if run["status"]:
            assert run["said"].startswith("error: "), run
            assert run["said"].count("\n") == 1, run
            assert set(run["left"]) <= set(whole), run
        elif run["number"] < 10**6:
            # In the cache a file may be missing; writing is tried by another name where a folder is there already.
            assert run["left"] == whole, run
    assert statuses == {0, 2}


def test_a_folder_that_is_removed_while_a_file_is_written_is_one_sentence(tmp_path: pathlib.Path) -> None:
    """Removed before the content, by a library that gives its errors no file name, between, and before the rename."""
    place = tmp_path / "cache" / "a"
    table = pa.table({"a": [1]})

    def remove() -> None:
        shutil.rmtree(tmp_path / "cache")

    writers = {
        "parquet": lambda p: (remove(), pq.write_table(table, p)),
        "array": lambda p: (remove(), np.save(p, np.zeros(3))),
        "content": lambda p: (p.write_text("a"), remove()),
        "file": lambda p: (p.write_text("a"), p.unlink()),
    }
    for name, write in writers.items():
        with pytest.raises(FileNotFoundError) as caught:
            v.write_atomically(place / name, write)
        said = f"{place / name}: it was removed while it was being written; run the command again."
        assert refusal(caught.value) == said
        assert [p for p in tmp_path.rglob("*") if p.is_file()] == []
    with pytest.raises(FileNotFoundError, match="elsewhere"):
        v.write_atomically(place / "b", lambda p: (tmp_path / "elsewhere").read_text())
    array_file.save_cached(place / "c.npz", {"a": np.zeros(3)})
    assert array_file.load_cached(place / "c.npz", "a test's", ("a",)) is not None


def test_a_cached_file_that_vanishes_between_two_looks_is_built_anew(
    tmp_path: pathlib.Path, monkeypatch, capsys
) -> None:
    monkeypatch.setattr(pathlib.Path, "is_file", lambda _: True)
    assert array_file.load_cached(tmp_path / "gone.npz", "a test's", ("a",)) is None
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert said.endswith("building it anew\n")


# A clock that goes backwards -----------------------------------------------------------------------------------------


@pytest.fixture
def backwards(monkeypatch: pytest.MonkeyPatch):
    """Each reading of the wall clock is a day before the one before, and a century before the files' times."""
    now = [time.time() - 100 * 365 * 86_400.0]

    def clock() -> float:
        now[0] -= 86_400.0
        return now[0]

    monkeypatch.setattr(time, "time", clock)


def test_what_another_process_writes_is_left_alone_when_the_clock_goes_backwards(tmp_path, backwards) -> None:
    half = tmp_path / ".bank-urbanverse-abcd1234.npz"
    half.write_text("half")
    v._sweep_parts.cache_clear()
    v.write_atomically(tmp_path / "a.txt", lambda p: p.write_text("new"))
    assert {p.name for p in tmp_path.iterdir()} == {half.name, "a.txt"}
    entry = tmp_path / "jax" / "jit_f-0123-cache"
    entry.parent.mkdir()
    entry.write_bytes(b"")
    assert compilation_cache._changed(entry.parent) == [], "it may still be written"
    with work_folder("urbanverse-test-", tmp_path) as one, work_folder("urbanverse-test-", tmp_path) as two:
        assert (one / OWNER).exists()
        assert (two / OWNER).exists()


def test_runs_of_one_name_are_apart_and_stages_stay_done_when_the_clock_goes_backwards(tmp_path, backwards) -> None:
    with new_run(tmp_path, "CocoNav-20260101-000000") as first, new_run(tmp_path, "CocoNav-20260101-000000") as second:
        assert first != second
        (first / "a").write_text("mine")
        (second / "a").write_text("mine")
    with RunFolder.open(tmp_path / "gen", "s") as run:
        with run.replacing("part") as folder:
            (folder / "a").write_text("old")
        run.finish("one", "key", 1.0)
    for path in (tmp_path / "gen").rglob("*"):
        os.utime(path, (4e9, 4e9))
    with RunFolder.open(tmp_path / "gen", "s") as run:
        assert run.done("one", "key", "part")
        assert not run.done("one", "other key", "part")


def test_an_error_of_a_library_without_a_file_name_is_one_sentence(tmp_path: pathlib.Path) -> None:
    with pytest.raises(FileNotFoundError) as caught:
        pq.write_table(pa.table({"a": [1]}), tmp_path / "missing" / "a.parquet")
    assert (caught.value.filename, caught.value.errno) == (None, errno.ENOENT)
    said = refusal(caught.value)
    assert said is not None
    assert str(tmp_path / "missing" / "a.parquet") in said
