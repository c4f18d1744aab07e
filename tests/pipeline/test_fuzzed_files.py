"""Files of every format with random edits, drawn by hypothesis: read, or refused in one sentence, within seconds."""

import copy
import gzip
import json
import pathlib
import time
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.pipeline.test_hostile_files import LONGEST, READERS, sound
from tests.support.robot_policy import robot_policy
from urbanverse_mjx.assets import build_mesh, load_index
from urbanverse_mjx.assets.importing.containment import Bounds, contained
from urbanverse_mjx.assets.importing.reading import read_source
from urbanverse_mjx.assets.meshes.glb import glb_bytes
from urbanverse_mjx.datatypes import Recording
from urbanverse_mjx.deployment.log import LogWriter, read_log
from urbanverse_mjx.evaluation.onnx_policy import load_onnx
from urbanverse_mjx.pipeline.errors import refusal
from urbanverse_mjx.robots import load as load_robot

__all__ = ["sound"]  # a fixture

#: Name of the file -> how it is read, of formats that are not in `READERS`: frames, robots, meshes, networks, logs.
MORE: dict[str, Callable[[pathlib.Path], object]] = {
    "rgb/000000.png": lambda path: Recording.load(path.parents[1]).rgb(0),
    "wheelchair.xml": lambda path: load_robot(path.parent),
    "policy.onnx": load_onnx,
    "cone.glb": lambda path: imported(path),
    "deploy.log": lambda path: list(read_log(path)),
}
#: Reading one takes a large part of a second.
DEAR = {"index.parquet", "shapes.parquet", "cone.glb", "policy.onnx"}

VALUES = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**70), 2**70) | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)
#: Of a file's bytes: what happens, where (share of the file), how many are concerned, and new ones.
EDITS = st.lists(
    st.tuples(
        st.sampled_from(("replace", "insert", "delete", "repeat")),
        st.floats(0.0, 1.0, exclude_max=True),
        st.integers(1, 2000),
        st.binary(max_size=12),
    ),
    min_size=1,
    max_size=3,
)
#: Of a JSON tree: what happens, to which of its nodes (share of them), and a new value.
TREE_EDITS = st.lists(
    st.tuples(
        st.sampled_from(("replace", "drop", "repeat", "rename")),
        st.floats(0.0, 1.0, exclude_max=True),
        VALUES,
    ),
    min_size=1,
    max_size=3,
)


def imported(path: pathlib.Path) -> object:
    """As `assets import` reads a mesh: in a process with limits, whose end is a sentence too."""
    outcome = contained(read_source, path, path.parent, bounds=Bounds(seconds=LONGEST))
    assert outcome.value is not None or (outcome.reason and outcome.sentence)
    return outcome.value


def edited(body: bytes, edits: list[tuple[str, float, int, bytes]]) -> bytes:
    for kind, share, length, new in edits:
        at = int(share * len(body))
        after = at + (0 if kind in ("insert", "repeat") else length if kind == "delete" else len(new))
        body = body[:at] + (body[at : at + length] * 2 if kind == "repeat" else new * (kind != "delete")) + body[after:]
    return body


def edited_tree(tree: Any, edits: list[tuple[str, float, Any]]) -> Any:
    tree = copy.deepcopy(tree)
    for kind, share, value in edits:
        places: list[tuple[Any, Any]] = []
        rest = [tree]
        while rest:
            node = rest.pop()
            keys = list(node) if isinstance(node, dict) else list(range(len(node))) if isinstance(node, list) else []
            places += [(node, key) for key in keys]
            rest += [node[key] for key in keys]
        if not places:
            return value
        node, key = places[int(share * len(places))]
        if kind == "drop":
            del node[key]
        elif kind == "repeat" and isinstance(node, list):
            node.insert(key, node[key])
        elif kind == "rename" and isinstance(node, dict):
            node[str(value)] = node.pop(key)
        else:
            node[key] = value
    return tree


def problem(read: Callable[[pathlib.Path], object], path: pathlib.Path) -> str:
    """What is wrong with how a file is read; "" where it is read, or refused in one sentence, in time."""
    begin = time.process_time()
    try:
        read(path)
    except Exception as error:
        said = refusal(error)
        if said is None or len(said) > 1000 or "\n" in said:
            return f"{type(error).__name__}: {str(error)[:200]}"
    seconds = time.process_time() - begin
    return f"took {seconds:.0f} s" if seconds > LONGEST else ""


@pytest.fixture(scope="module")
def files(sound: pathlib.Path) -> pathlib.Path:
    """The folder of sound files, with those that `MORE` reads."""
    robot_policy(sound / "policy.onnx")
    record = load_index().by_leaf("traffic cone")[0]
    (sound / "cone.glb").write_bytes(glb_bytes(build_mesh(record), None, "CC0-1.0"))
    writer = LogWriter(sound / "deploy.log")
    for k in range(20):
        writer.add({"event": "message", "t_ns": k, "sizes": [3]}, b"abc")
    writer.close()
    for name, read in {**READERS, **MORE}.items():
        assert problem(read, sound / name) == "", name
        read(sound / name)
    return sound


def fuzzed(path: pathlib.Path, read: Callable[[pathlib.Path], object], number: int, strategy: Any, make: Any) -> None:
    body = path.read_bytes()

    @settings(
        max_examples=number,
        deadline=None,
        database=None,
        derandomize=number < 100,
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
    )
    @given(edits=strategy)
    def check(edits: Any) -> None:
        path.write_bytes(make(body, edits))
        assert problem(read, path) == ""

    try:
        check()
    finally:
        path.write_bytes(body)


@pytest.mark.parametrize("number", [8, pytest.param(1000, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", [*READERS, *MORE])
def test_any_edited_bytes_are_read_or_refused(name: str, number: int, files: pathlib.Path) -> None:
    number = max(number // 8, 1) if name in DEAR else number
    fuzzed(files / name, {**READERS, **MORE}[name], number, EDITS, edited)


@pytest.mark.parametrize("number", [12, pytest.param(2000, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", [name for name in READERS if ".json" in name])
def test_any_edited_tree_is_read_or_refused(name: str, number: int, files: pathlib.Path) -> None:
    def make(body: bytes, edits: Any) -> bytes:
        packed = name.endswith(".gz")
        text = json.dumps(edited_tree(json.loads(gzip.decompress(body) if packed else body), edits)).encode()
        return gzip.compress(text, 1) if packed else text

    fuzzed(files / name, READERS[name], number, TREE_EDITS, make)
