"""A datatype written and read back is the same datatype; a file is either whole or refused."""

import json
import os
import resource
import subprocess
import sys
import time

import pytest
from hypothesis import given, settings

from urbanverse_mjx.datatypes import SceneGraph, SceneLayout, ValidationError, ground
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.pipeline.errors import refusal

from . import strategies


@settings(max_examples=60, deadline=None)
@given(strategies.graphs)
def test_graph_round_trip(graph):
    back = SceneGraph.from_json(json.loads(json.dumps(graph.to_json(), allow_nan=False)))
    assert back == graph
    assert back.content_hash() == graph.content_hash()


@settings(max_examples=60, deadline=None)
@given(strategies.layouts)
def test_layout_round_trip(layout):
    back = SceneLayout.from_json(json.loads(json.dumps(layout.to_json(), allow_nan=False)))
    assert back == layout
    assert back.content_hash() == layout.content_hash()


@settings(max_examples=5, deadline=None)
@given(strategies.graphs, strategies.layouts)
def test_files_round_trip(tmp_path_factory, graph, layout):
    folder = tmp_path_factory.mktemp("datatypes")
    graph.save(folder / "graph.json")
    layout.save(folder / "deep" / "layout.json")
    assert SceneGraph.load(folder / "graph.json") == graph
    assert SceneLayout.load(folder / "deep" / "layout.json") == layout


@settings(max_examples=60, deadline=None)
@given(strategies.rings())
def test_rings_are_stored_counter_clockwise(ring):
    assert ground.polygon_area(ground.check_polygon(ring, "polygon")) > 0.0


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"not json at all", "not JSON"),
        (b"", "not JSON"),
        (b'{"schema": ', "not JSON"),
        (b"\xff\xfe\x00", "not JSON"),
        (b"[" * 200_000, "not JSON"),
        (b'{"seed": ' + b"9" * 6000 + b"}", "not JSON"),
        (b'{"id": "a", "id": "b"}', "the same field twice"),
        (b"[]", "needed a JSON object"),
        (b"null", "needed a JSON object"),
    ],
)
@pytest.mark.parametrize("datatype", [SceneGraph, SceneLayout])
def test_what_is_no_datatype_file_is_refused_in_one_sentence(tmp_path, datatype, content, said):
    path = tmp_path / "datatype.json"
    path.write_bytes(content)
    with pytest.raises(ValidationError) as caught:
        datatype.load(path)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_missing_file_and_folder_are_refused(tmp_path):
    with pytest.raises(ValidationError, match="no such file"):
        SceneGraph.load(tmp_path / "nothing.json")
    with pytest.raises(ValidationError, match="no such file"):
        SceneGraph.load(tmp_path)


def test_content_is_on_the_disk_before_its_name_and_the_name_before_the_call_returns(tmp_path, monkeypatch):
    did = []
    fsync, replace = os.fsync, os.replace

    def synced(handle):
        name = os.readlink(f"/proc/self/fd/{handle}")
        did.append(("sync", name, os.path.getsize(name)))
        fsync(handle)

    def replaced(source, target, **options):
        did.append(("rename", str(source), str(target)))
        replace(source, target, **options)

    monkeypatch.setattr(os, "fsync", synced)
    monkeypatch.setattr(os, "replace", replaced)
    path = v.write_atomically(tmp_path / "a.txt", lambda p: p.write_text("12345"))
    (first, temporary, size), rename, (last, folder, _) = did
    assert (first, size, last, folder) == ("sync", 5, "sync", str(tmp_path))
    assert rename == ("rename", temporary, str(path))


def test_a_file_that_may_grow_no_further_leaves_the_old_one(tmp_path):
    """As a full disk does: the system refuses to write on."""
    path = tmp_path / "graph.json"
    v.write_json(path, {"whole": True})
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, hard))
    try:
        with pytest.raises(OSError, match="File too large") as caught:
            v.write_json(path, ["x" * 1000] * 1000)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert "ulimit -f" in (refusal(caught.value) or "")
    assert os.listdir(tmp_path) == ["graph.json"]
    assert json.loads(path.read_text()) == {"whole": True}


def test_a_repeated_field_among_many_is_found_at_once(tmp_path):
    path, many = tmp_path / "graph.json", 100_000
    path.write_text("{" + ",".join(f'"{k}":0' for k in range(many)) + f',"{many - 1}":1}}')
    begin = time.process_time()
    with pytest.raises(ValidationError, match=f"'{many - 1}': found the same field twice"):
        v.read_json(path, "graph")
    assert time.process_time() - begin < 5.0, "comparing every field with every other takes minutes"


def test_a_failed_write_leaves_the_old_file_and_no_litter(tmp_path):
    path = tmp_path / "graph.json"
    v.write_json(path, {"whole": True})
    with pytest.raises(ValueError, match="JSON compliant"):
        v.write_json(path, {"broken": float("nan")})

    def fails(temporary):
        temporary.write_text("half")
        raise OSError("disk full")

    with pytest.raises(OSError, match="disk full"):
        v.write_atomically(path, fails)
    assert os.listdir(tmp_path) == ["graph.json"]
    assert json.loads(path.read_text()) == {"whole": True}


def test_what_a_killed_process_left_half_written_goes_after_a_day(tmp_path):
    code = (
        "import os, pathlib, sys; from urbanverse_mjx.datatypes import validation as v\n"
        "v.write_atomically(pathlib.Path(sys.argv[1]), lambda p: (p.write_text('half'), os.kill(os.getpid(), 9)))"
    )
    for name in ("bank-0.npz", "report"):
        subprocess.run([sys.executable, "-c", code, str(tmp_path / name)], check=False)
    halves = list(tmp_path.iterdir())
    assert len(halves) == 2
    (tmp_path / ".notes-urbanverse-mine").write_text("mine")
    (tmp_path / ".bank-0-abcd1234.npz").write_text("mine")
    old = time.time() - 90_000
    for path in tmp_path.iterdir():
        os.utime(path, (old, old) if path != halves[1] else None)
    v._sweep_parts.cache_clear()
    v.write_atomically(tmp_path / "a.txt", lambda p: p.write_text("new"))
    left = {path.name for path in tmp_path.iterdir()}
    assert left == {"a.txt", ".notes-urbanverse-mine", ".bank-0-abcd1234.npz", halves[1].name}
