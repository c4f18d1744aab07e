"""`urbanverse gen` on broken sources: one sentence, exit status 2, and no partly written file."""

import json
import pathlib
import struct
import zlib
from collections.abc import Callable

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image

from urbanverse_mjx.cli.main import main
from urbanverse_mjx.datatypes import GROUND_KINDS, Camera, Detection, RecordingWriter, Source

GRAPH = pathlib.Path(__file__).parents[2] / "scenes" / "residential_bins" / "graph.json"


def _video(path: pathlib.Path, frames: list[np.ndarray]) -> pathlib.Path:
    """Writes an mp4 of (180, 320, 3) u8 images, ten a second."""
    writer = imageio_ffmpeg.write_frames(str(path), (320, 180), fps=10, macro_block_size=2)
    writer.send(None)
    for frame in frames:
        writer.send(np.ascontiguousarray(frame))
    writer.close()
    return path


def _recording(folder: pathlib.Path) -> pathlib.Path:
    """A recording of three frames with one object on a sidewalk."""
    camera = Camera(64, 36, 40.0, 40.0, 32.0, 18.0)
    writer = RecordingWriter(folder, "walk", Source("hand", "Apache-2.0", "none", "none"), camera)
    masks, surfaces = np.full((36, 64), -1), np.zeros((36, 64), np.uint8)
    masks[10:20, 20:30], surfaces[25:] = 0, GROUND_KINDS.index("sidewalk")
    for k in range(3):
        pose = np.array([[0, 0, 1, k], [-1, 0, 0, 0], [0, -1, 0, 1.5], [0, 0, 0, 1]], float)
        black = np.zeros((36, 64, 3), np.uint8)
        writer.add(float(k), black, np.full((36, 64), 4.0), masks, surfaces, pose, [Detection("bench")])
    return writer.close().folder


def _huge_image() -> bytes:
    """A PNG of a few bytes with a header of 50,000 x 50,000 pixels."""

    def chunk(kind: bytes, body: bytes) -> bytes:
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    header = struct.pack(">IIBBBBB", 50_000, 50_000, 8, 2, 0, 0, 0)
    packed = zlib.compress(bytes(1000))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", packed) + chunk(b"IEND", b"")


def _edit(recording: pathlib.Path, change: Callable[[dict], object]) -> pathlib.Path:
    body = json.loads((recording / "recording.json").read_text())
    change(body)
    (recording / "recording.json").write_text(json.dumps(body))
    return recording


def _graph(kind: str, path: pathlib.Path) -> pathlib.Path:
    """A graph that is valid as a file and not as a street."""
    body = json.loads(GRAPH.read_text())
    car = next(entry for entry in body["objects"] if entry["label"] == "sedan")
    if kind == "huge car graph":
        car["size"] = [2000.0, 800.0, 600.0]
    elif kind == "distant car graph":
        car["center"][0] = 90_000.0
    elif kind == "meaningless graph":
        for entry in body["objects"]:
            entry["label"] = "zqxv"
    elif kind == "narrow graph":
        body["objects"] = [car]
        body["ground"] = [region for region in body["ground"] if region["kind"] == "road"]
    elif kind == "doubled ground graph":
        body["ground"].append({**body["ground"][0], "id": "again"})
    path.write_text(json.dumps(body))
    return path


TEXTURE = np.random.default_rng(0).integers(0, 255, (180, 320, 3)).astype(np.uint8)


def _broken(kind: str, folder: pathlib.Path) -> pathlib.Path:
    """A source that is invalid only in its contents."""
    source = folder / "source.mp4"
    if kind == "not a video":
        source.write_text("this is not a video")
        return source
    if kind == "pictures of 2.5 gigapixels":
        source = folder / "pictures"
        source.mkdir()
        for k in range(3):
            (source / f"{k}.png").write_bytes(_huge_image())
        return source
    if kind.endswith("video"):
        return _video(source, [TEXTURE] if kind == "one-frame video" else [np.zeros_like(TEXTURE)] * 20)
    recording = _recording(folder / "recording")
    if kind == "mask of 2.5 gigapixels":
        (recording / "masks" / "000001.png").write_bytes(_huge_image())
    elif kind == "corrupt mask":
        mask = recording / "masks" / "000001.png"
        mask.write_bytes(mask.read_bytes()[:50])
    elif kind == "mask of nothing":
        Image.fromarray(np.full((36, 64), 7, np.uint16)).save(recording / "masks" / "000001.png")
    elif kind == "NaN pose":
        _edit(recording, lambda body: body["frames"][1]["T_world_camera"].__setitem__(3, float("nan")))
    elif kind == "no frame":
        _edit(recording, lambda body: body.update(frames=[]))
    elif kind == "no pose":
        _edit(recording, lambda body: [frame.update(T_world_camera=None) for frame in body["frames"]])
    return recording


@pytest.mark.parametrize(
    ("kind", "word"),
    [
        ("not a video", "no image"),
        ("one-frame video", "at least two"),
        ("black video", "dark"),
        ("pictures of 2.5 gigapixels", "0.png"),
        ("mask of 2.5 gigapixels", "000001.png"),
        ("corrupt mask", "000001.png"),
        ("mask of nothing", "000001.png"),
        ("NaN pose", "NaN"),
        ("no frame", "frames"),
        ("no pose", "no frame with a pose"),
    ],
)
def test_broken_content_is_one_sentence_and_leaves_nothing(
    kind: str, word: str, tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = _broken(kind, tmp_path)
    assert main(["gen", str(source), "--out", str(tmp_path / "out"), "--quiet"]) == 2
    said = capsys.readouterr().err
    assert said.startswith("error: ")
    assert said.count("\n") == 1
    assert word in said
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("kind", "word"),
    [
        ("huge car graph", "found a size of 2,000 x 800 x 600 m, needed at most"),
        ("distant car graph", "from all ground"),
        ("doubled ground graph", "shared with"),
    ],
)
def test_graphs_that_cannot_be_of_a_street_leave_nothing(
    kind: str, word: str, tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = _graph(kind, tmp_path / "graph.json")
    for command in (["gen", str(source), "--quiet"], ["scene", "compile", str(source)]):
        assert main([*command, "--out", str(tmp_path / "out")]) == 2
        assert word in capsys.readouterr().err
        assert not (tmp_path / "out").exists()


def test_an_image_called_a_film_is_named(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = tmp_path / "source.mp4"
    Image.fromarray(TEXTURE).save(source, format="PNG")
    assert main(["gen", str(source), "--out", str(tmp_path / "out"), "--quiet"]) == 2
    assert "source.mp4: found a single PNG image" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("kind", "word"),
    [("meaningless graph", "found no place for any of"), ("narrow graph", "needed a connected area with 4 m")],
)
def test_cousins_that_cannot_be_compiled_are_not_written(
    kind: str, word: str, tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Found only once assets are chosen and hidden ground is filled; the graph's stage is whole by then."""
    source = _graph(kind, tmp_path / "graph.json")
    assert main(["gen", str(source), "--out", str(tmp_path / "out"), "--quiet"]) == 2
    assert word in capsys.readouterr().err
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == [".lock", "graph", "run.json"]


def test_no_way_to_write_is_one_sentence(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "file").write_text("mine")
    assert main(["gen", str(GRAPH), "--out", str(tmp_path / "file" / "out"), "--quiet"]) == 2
    said = capsys.readouterr().err
    assert "no way to write there" in said
    assert said.count("\n") == 1
    assert (tmp_path / "file").read_text() == "mine"


@pytest.mark.parametrize("broken", ["missing", "empty folder", "empty file", "broken graph", "broken recording"])
def test_broken_sources_are_one_sentence_and_leave_nothing(
    broken: str, tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = tmp_path / ("given.json" if "graph" in broken else "given")
    if "folder" in broken or "recording" in broken:
        source.mkdir()
    elif broken != "missing":
        source.write_bytes(b"" if broken == "empty file" else b"{not json")
    if "recording" in broken:
        (source / "recording.json").write_text("{}")
    assert main(["gen", str(source), "--out", str(tmp_path / "out"), "--quiet"]) == 2
    said = capsys.readouterr().err
    assert said.startswith("error: ")
    assert said.count("\n") == 1
    assert not (tmp_path / "out").exists()
