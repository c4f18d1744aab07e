"""Files of every format that a user hands over, cut off, changed and made to hurt: read, or refused in one sentence.

The corpus is made here: sound files, and what becomes of each by all that `spoiled` does.
"""

import gzip
import json
import pathlib
import re
import time
from collections.abc import Callable, Iterator

import numpy as np
import pytest

from tests.datatypes.test_corruptions import GRAPH, LAYOUT
from tests.support.box_bank import box_bank
from tests.training.test_policy_files import spec
from urbanverse_mjx.assets.collision.hulls import HullStore
from urbanverse_mjx.assets.meshes import base_shapes
from urbanverse_mjx.assets.records import index
from urbanverse_mjx.datatypes import Camera, Recording, RecordingWriter, SceneBank, SceneGraph, SceneLayout, Source
from urbanverse_mjx.evaluation.frozen import Protocol
from urbanverse_mjx.pipeline.errors import refusal
from urbanverse_mjx.robots import load as load_robot
from urbanverse_mjx.robots.gait import Gait
from urbanverse_mjx.robots.go2 import load_gait
from urbanverse_mjx.scene.exchange_routes import load_annotations
from urbanverse_mjx.settings import asset_root, protocol_root
from urbanverse_mjx.training.policy import PolicySpec
from urbanverse_mjx.training.record import RunRecord

WHEELCHAIR = pathlib.Path(load_gait.__code__.co_filename).parent / "wheelchair"
#: s of the processor for one file: longer counts as a hang.
LONGEST = 10.0
ROUTES = {"format": 1, "scene": "s", "routes": [{"id": "r1", "start": [0, 0], "goal": [9, 0], "via": [[4, 1]]}]}
RECORD = {"environment": "CocoNav", "env": {"a": 1}, "ppo": {"num_timesteps": 9}, "segments": [{"from_steps": 0}]}

#: Name of the file -> how it is read.
READERS: dict[str, Callable[[pathlib.Path], object]] = {
    "graph.json": SceneGraph.load,
    "graph.json.gz": SceneGraph.load,
    "layout.json": SceneLayout.load,
    "protocol.json": Protocol.load,
    "recording.json": lambda path: Recording.load(path.parent),
    "policy.json": lambda path: PolicySpec.load(path.parent),
    "config.json": lambda path: RunRecord.load(path.parent),
    "routes.json": load_annotations,
    "robot.json": lambda path: load_robot(path.parent),
    "gait.npz": Gait.load,
    "hulls.npz": HullStore.load,
    "bank.npz": SceneBank.load,
    "streets.bank/index.npz": lambda path: SceneBank.load(path.parent),
    "index.parquet": lambda path: index._load_cached.__wrapped__(path),
    "shapes.parquet": lambda path: base_shapes._load_cached.__wrapped__(path),
}


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """A folder with a sound file of each format."""
    folder = tmp_path_factory.mktemp("sound")
    (folder / "graph.json.gz").write_bytes(gzip.compress(json.dumps(GRAPH).encode()))
    for name, body in (("graph", GRAPH), ("layout", LAYOUT), ("routes", ROUTES), ("config", RECORD)):
        (folder / f"{name}.json").write_text(json.dumps(body))
    (folder / "protocol.json").write_bytes((protocol_root() / "shipped.json").read_bytes())
    writer = RecordingWriter(
        folder, "walk", Source("hand", "CC0-1.0", "none", "none"), Camera(6, 4, 5.0, 5.0, 3.0, 2.0)
    )
    writer.add(0.0, np.zeros((4, 6, 3), np.uint8))
    writer.close()
    spec(100).save(folder)
    for name in ("robot.json", "wheelchair.xml"):
        (folder / name).write_bytes((WHEELCHAIR / name).read_bytes())
    load_gait().save(folder / "gait.npz")
    corners = np.random.default_rng(0).integers(0, 1000, (8, 3), dtype=np.int32)
    HullStore({"ab" * 16: (corners,)}).save(folder / "hulls.npz")
    for name in ("bank.npz", "streets.bank"):
        box_bank(1, seed=0, num_objects=4).save(folder / name)
    for name in ("index.parquet", "shapes.parquet"):
        (folder / name).write_bytes((asset_root() / name).read_bytes())
    return folder


def spoiled(name: str, body: bytes) -> Iterator[tuple[str, bytes]]:
    """The outcome for a file."""
    rng = np.random.default_rng(0)
    for share in (0.0, 0.01, 0.5, 0.9, 0.999):
        yield f"cut at {share}", body[: int(share * len(body))]
    # Many of a table's bits go unnoticed, and reading one takes half a second.
    for k in range(3 if name.endswith(".parquet") else 12):
        flipped = bytearray(body)
        flipped[int(rng.integers(len(body)))] ^= 1 << int(rng.integers(8))
        yield f"bit {k}", bytes(flipped)
    yield "zeros", bytes(len(body))
    yield "noise", rng.bytes(len(body))
    yield "goes on", body + rng.bytes(100)
    yield "another format", b"\x89PNG\r\n\x1a\n" + body
    if name.endswith(".json"):
        yield from ((f"spoiled {k}", new) for k, new in enumerate(_spoiled_json(body)))


def _spoiled_json(body: bytes) -> Iterator[bytes]:
    """Invalid JSON, JSON of another type, and JSON that is expensive to read."""
    yield from (
        b"null",
        b"[]",
        b"{}",
        b'"a"',
        b"1e999",
        b"\xff\xfe{\0}\0",
        b"[" * 200_000,
        b'{"a":' * 100_000,
        b"9" * 50_000,
    )
    yield b"{" + b",".join(b'"k%d":0' % k for k in range(200_000)) + b',"k0":0}'  # a repeat after many fields
    yield b"\xef\xbb\xbf" + body
    yield body.replace(b"{", b'{"schema": 1, ', 1)
    text = body.decode()
    numbers = re.search(r"(?<=[\s:\[])-?\d+(\.\d+)?(?=[,\s\]}])", text)
    assert numbers is not None
    for new in ("NaN", "-Infinity", "1e400", "9" * 5000, "1e-320", "null", '"9"', "[]", "true"):
        yield (text[: numbers.start()] + new + text[numbers.end() :]).encode()
    for new in (r"\ud800", r"\u0000", r"\uffff", "../" * 50, "x" * 10**6):
        yield re.sub(r'(: ?")[^"]*(")', lambda found, new=new: f"{found[1]}{new}{found[2]}", text, count=1).encode()


@pytest.mark.parametrize("name", READERS)
def test_a_hostile_file_is_read_or_refused_in_one_sentence(name: str, sound: pathlib.Path) -> None:
    path, read = sound / name, READERS[name]
    body = path.read_bytes()
    read(path)
    wrong = []
    try:
        for what, new in spoiled(name, body):
            path.write_bytes(new)
            begin = time.process_time()
            try:
                read(path)
            except Exception as error:
                sentence = refusal(error)
                if sentence is None or len(sentence) > 1000:
                    wrong.append(f"{what}: {type(error).__name__}: {str(error)[:100]}")
            if time.process_time() - begin > LONGEST:
                wrong.append(f"{what}: took {time.process_time() - begin:.0f} s")
    finally:
        path.write_bytes(body)
    assert not wrong, "\n".join(wrong)


def test_the_corpus_holds_hundreds_of_files(sound: pathlib.Path) -> None:
    count = sum(len(list(spoiled(name, (sound / name).read_bytes()))) for name in READERS)
    assert count >= 200
