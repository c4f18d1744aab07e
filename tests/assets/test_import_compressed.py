"""Compressed glTF files (Draco, meshopt), numbers in short form, and transforms of textures."""

import importlib.util
import itertools
import pathlib
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import trimesh
from trimesh.exchange import gltf

from tests.assets.gltf_tree import CORNERS, FACES, Tree
from tests.assets.mesh_files import mesh_of
from urbanverse_mjx.assets.importing import run
from urbanverse_mjx.assets.importing.reading import Source, read_source
from urbanverse_mjx.assets.importing.screening import DECODERS, MESHOPT_NAMES, RefusedFileError
from urbanverse_mjx.assets.meshes.glb import TO_GLTF
from urbanverse_mjx.cli.main import main

UV = np.array([[0, 0], [2, 0], [0, 3], [2, 3]], "<f4")
PIXEL = (
    "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP4z8AAAAMBAQDJ/pLvAAAAAElFTkSuQmCC"
)
#: extension -> what gltfpack 1.3 wrote (`-c` and `-cz`) for the positions, texture coordinates and triangles of a
#: tetrahedron with CORNERS and UV. One step of positions is 1 / 16383, one of coordinates 2 / 4095 and 3 / 4095.
OFFICIAL = {
    "EXT_meshopt_compression": (
        "a00106000000010f0000007e7d0118000000013c0000007e7d010100000001030000007e" + 34 * "00",
        "a00104000000010c0000001e0119000000013f0000001e1d1e" + 32 * "00",
        "e1f0101301007687566778a9866589689801690000",
    ),
    "KHR_meshopt_compression": (
        "a1ffaf0000010200007e7d00010200007e7d00000000010000007e" + 24 * "00",
        "a1ff0000010000001e0000010201001e1d1e" + 24 * "00",
        "e1f0201102007687566778a9866589689801690000",
    ),
}


def painted(tree: Tree, uv: int, **texture: Any) -> Tree:
    """The tree with texture coordinates by the accessor `uv` and an image of one pixel."""
    tree.primitive["attributes"]["TEXCOORD_0"] = uv
    tree.primitive["material"] = 0
    tree.body["images"], tree.body["textures"] = [{"uri": PIXEL}], [{"source": 0}]
    tree.body["materials"] = [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, **texture}}}]
    return tree


def transform(**numbers: Any) -> dict[str, Any]:
    return {"extensions": {"KHR_texture_transform": numbers}}


def compress(tree: Tree, name: str, encode: Callable[[int, bytes], dict[str, Any]]) -> Tree:
    """Moves each view to a buffer without data, and stores `encode(k, its bytes)`: a stream and what describes it."""
    streams = b""
    for k, view in enumerate(tree.body["bufferViews"]):
        raw = tree.binary[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]
        how = encode(k, raw)
        stream = how.pop("stream")
        view["buffer"], view["byteLength"] = 1, how["count"] * how["byteStride"]
        view["extensions"] = {name: {"buffer": 0, "byteOffset": len(streams), "byteLength": len(stream), **how}}
        streams += stream + b"\0" * (-len(stream) % 4)
    tree.further = [{"byteLength": len(tree.binary) + 64, "extensions": {name: {"fallback": True}}}]
    tree.binary = streams
    tree.body["extensionsRequired"] = [name, "KHR_mesh_quantization"]
    return tree


def read(tree: Tree, path: pathlib.Path) -> Source:
    return read_source(tree.write(path), path.parent)


def corners(source: Source) -> np.ndarray:
    """(F, 3, 5) positions and texture coordinates of the corners of all triangles."""
    rows = []
    for part in source.parts:
        assert part.uv is not None
        rows.append(np.concatenate([part.vertices, part.uv], 1)[part.faces])
    return np.concatenate(rows)


def difference(found: np.ndarray, wanted: np.ndarray) -> float:
    """The largest one of equal triangles, each of which may begin at another corner."""
    assert found.shape == wanted.shape
    turned = [np.abs(np.roll(found, k, 1) - wanted).max((1, 2)) for k in range(3)]
    return float(np.min(turned, 0).max())


# Numbers in short form and transforms, which need no further package -------------------------------------------------


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
@pytest.mark.parametrize(("dtype", "component"), [(np.uint8, 5121), (np.int16, 5122), (np.uint16, 5123)])
@pytest.mark.parametrize("normalized", [True, False])
def test_coordinates_as_integers(
    suffix: str, dtype: Any, component: int, normalized: bool, tmp_path: pathlib.Path
) -> None:
    tree = Tree()
    short = np.zeros((4, 4), dtype)  # rows are multiples of four bytes
    short[:, :3] = CORNERS * 100
    if np.dtype(dtype).kind == "i":
        short[0] = np.iinfo(dtype).min  # normalized, it is -1, as its successor is
    k = tree.add(short, component, "VEC3", normalized=normalized)
    tree.body["bufferViews"][-1]["byteStride"] = short.strides[0]
    tree.primitive["attributes"]["POSITION"] = k
    tree.body["extensionsRequired"] = ["KHR_mesh_quantization"]
    wanted = short[:, :3].astype(float)
    if normalized:
        wanted = np.maximum(wanted / np.iinfo(dtype).max, -1)
    np.testing.assert_allclose(read(tree, tmp_path / f"a{suffix}").vertices, wanted, rtol=1e-6)


def test_an_image_is_moved_turned_and_scaled(tmp_path: pathlib.Path) -> None:
    """The extension's own example: the lower left quarter, turned; from the upper left corner downwards."""
    uv = np.array([[0, 0], [1, 0], [0, 1], [1, 1]])
    tree = Tree()
    tree = painted(tree, tree.add(255 * uv.astype(np.uint8), 5121, "VEC2", normalized=True))
    texture = transform(offset=[0, 1], rotation=np.pi / 2, scale=[0.5, 0.5])
    tree = painted(tree, tree.primitive["attributes"]["TEXCOORD_0"], **texture)
    tree.body["extensionsRequired"] = ["KHR_texture_transform"]
    found = read(tree, tmp_path / "a.glb").parts[0].uv
    assert found is not None
    found = found * [1, -1] + [0, 1]
    np.testing.assert_allclose(found, [[0, 1], [0, 0.5], [0.5, 1], [0.5, 0.5]], atol=1e-6)


def test_two_parts_with_the_same_coordinates_have_their_own_transforms(tmp_path: pathlib.Path) -> None:
    tree = Tree()
    second = tree.add(UV / 8, 5126, "VEC2")
    tree = painted(tree, tree.add(UV / 4, 5126, "VEC2"), **transform(scale=[2, 4]))
    tree.primitive["attributes"]["TEXCOORD_1"] = second
    primitives = tree.body["meshes"][0]["primitives"]
    primitives += [{**tree.primitive, "material": k, "attributes": dict(tree.primitive["attributes"])} for k in (1, 2)]
    for texture in ({"texCoord": 1}, transform(texCoord=1, offset=[0.5, 0])):
        tree.body["materials"].append({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, **texture}}})
    parts = read(tree, tmp_path / "a.gltf").parts
    wanted = [UV / 4 * [2, 4], UV / 8, UV / 8 + [0.5, 0]]
    for part, uv in zip(parts, wanted, strict=True):
        assert part.uv is not None
        np.testing.assert_allclose(part.uv, uv * [1, -1] + [0, 1], atol=1e-6)


# Compression ---------------------------------------------------------------------------------------------------------


def official(name: str) -> Tree:
    """gltfpack's streams in a tree with its scales."""
    tree = Tree()
    k = tree.add(np.zeros((4, 4), np.uint16), 5123, "VEC3")
    tree.primitive["attributes"]["POSITION"] = k
    tree.body["bufferViews"][k]["byteStride"] = 8
    scale = [65535 / 4095 * 2, 65535 / 4095 * 3]
    uv = tree.add(np.zeros((4, 2), np.uint16), 5123, "VEC2", normalized=True)
    tree = painted(tree, uv, **transform(scale=scale))
    tree.body["bufferViews"][uv]["byteStride"] = 4
    tree.primitive["indices"] = tree.add(np.zeros(12, np.uint16), 5123, "SCALAR")
    tree.body["nodes"][0]["scale"] = [1 / 16383] * 3
    rows = {k: (4, 8, "ATTRIBUTES"), uv: (4, 4, "ATTRIBUTES"), uv + 1: (12, 2, "TRIANGLES")}
    streams = dict(zip(rows, OFFICIAL[name], strict=True))
    # The tree's first accessors, of floats, are no longer used; they go.
    for key in ("accessors", "bufferViews"):
        tree.body[key] = tree.body[key][2:]
    for row in tree.body["accessors"]:
        row["bufferView"] -= 2
    tree.primitive["attributes"] = {key: value - 2 for key, value in tree.primitive["attributes"].items()}
    tree.primitive["indices"] -= 2

    def stored(at: int, raw: bytes) -> dict[str, Any]:
        count, width, mode = rows[at + 2]
        assert count * width == len(raw)
        return {"stream": bytes.fromhex(streams[at + 2]), "count": count, "byteStride": width, "mode": mode}

    return compress(tree, name, stored)


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
@pytest.mark.parametrize("name", MESHOPT_NAMES)
def test_meshopt_of_its_authors_encoder(name: str, suffix: str, tmp_path: pathlib.Path) -> None:
    pytest.importorskip("meshopt")
    plain = Tree()
    plain = painted(plain, plain.add(UV, 5126, "VEC2"))
    wanted = corners(read(plain, tmp_path / "plain.glb"))
    found = corners(read(official(name), tmp_path / f"a{suffix}"))
    orders = itertools.permutations(range(4))  # gltfpack sorts triangles
    assert min(difference(found[list(order)], wanted) for order in orders) < 1e-6


def test_meshopt_gives_a_whole_asset_back(tmp_path: pathlib.Path) -> None:
    """Filtered positions (15 bits of mantissa), 32-bit triangles, and 16-bit indices as a plain sequence."""
    meshopt = pytest.importorskip("meshopt")
    _, mesh = mesh_of("fire hydrant")
    tree = Tree()
    attributes = tree.primitive["attributes"]
    attributes["POSITION"] = tree.add((mesh.vertices @ TO_GLTF.T).astype("<f4"), 5126, "VEC3")
    tree = painted(tree, tree.add(mesh.uv.astype("<f4"), 5126, "VEC2"))
    tree.primitive["indices"] = tree.add(mesh.faces.astype("<u4").ravel(), 5125, "SCALAR")
    second = {**tree.primitive, "indices": tree.add(mesh.faces[::-1].astype("<u2").ravel(), 5123, "SCALAR")}
    tree.body["meshes"][0]["primitives"].append(second)
    wanted = corners(read(tree, tmp_path / "plain.glb"))
    position, triangle, sequence = attributes["POSITION"], tree.primitive["indices"], second["indices"]

    # accessor -> (type, numbers in a row, mode); 0 and 1 are the tree's own, which nothing uses any more.
    rows = {
        0: ("<f4", 3, "ATTRIBUTES"),
        1: ("<u4", 1, "ATTRIBUTES"),
        position: ("<f4", 3, "ATTRIBUTES"),
        attributes["TEXCOORD_0"]: ("<f4", 2, "ATTRIBUTES"),
        triangle: ("<u4", 1, "TRIANGLES"),
        sequence: ("<u2", 1, "INDICES"),
    }

    def encode(k: int, raw: bytes) -> dict[str, Any]:
        dtype, width, mode = rows[k]
        values = np.frombuffer(raw, dtype).reshape(-1, width)
        how = {"count": len(values), "byteStride": values.strides[0], "mode": mode}
        if k == position:
            values, how["filter"] = meshopt.encode_filter_exp(values, 15, "Separate"), "EXPONENTIAL"
        return {"stream": meshopt.encode_gltf_buffer(values, mode), **how}

    found = corners(read(compress(tree, MESHOPT_NAMES[0], encode), tmp_path / "a.glb"))
    assert len(found) == 2 * len(mesh.faces)
    assert 0 < difference(found, wanted) < 1e-4  # one step of the mantissa is 6e-5 of 1 m


@pytest.mark.parametrize("name", sorted(DECODERS))
def test_a_missing_decoder_is_named(name: str, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda module: None)
    tree = Tree()
    tree.body["extensionsRequired"] = [name]
    with pytest.raises(RefusedFileError, match=f"'{name}'; run `pip install {DECODERS[name]}`, or write it without"):
        read(tree, tmp_path / "a.glb")


def test_optional_compression_needs_no_decoder(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda module: None)
    tree = Tree()
    tree.body["extensionsUsed"] = [MESHOPT_NAMES[0]]
    for view in tree.body["bufferViews"]:
        view["extensions"] = {MESHOPT_NAMES[0]: {"buffer": 7, "count": -1}}
    np.testing.assert_allclose(read(tree, tmp_path / "a.glb").vertices, CORNERS)


BROKEN: dict[str, tuple[dict[str, Any], str]] = {
    "stream": ({"byteLength": 5}, "is damaged"),
    "range": ({"byteLength": 10**6}, "byteLength 1000000"),
    "buffer": ({"buffer": 2}, "buffer 2"),
    "placeholder": ({"buffer": 1}, "in a buffer without data"),
    "count": ({"count": 5}, "5 rows of 8 bytes.* in 32 bytes"),
    "size": ({"count": 2**40}, "count 1099511627776"),
    "mode": ({"mode": "POINTS"}, "mode 'POINTS'"),
    "filter": ({"filter": "NORMALS"}, "filter 'NORMALS'"),
    "filter's rows": ({"filter": "COLOR", "byteStride": 16, "count": 2}, "2 rows of 16 bytes"),
    "indices' rows": ({"mode": "INDICES"}, "mode 'INDICES'"),
}


@pytest.mark.parametrize("what", BROKEN)
def test_broken_compression_is_one_sentence(what: str, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if what == "stream":
        pytest.importorskip("meshopt")
    else:  # refused before a decoder sees them
        monkeypatch.setattr(importlib.util, "find_spec", lambda module: object())
    change, needle = BROKEN[what]
    tree = official(MESHOPT_NAMES[0])
    tree.body["bufferViews"][0]["extensions"][MESHOPT_NAMES[0]] |= change
    with pytest.raises(RefusedFileError, match=needle):
        read(tree, tmp_path / "a.glb")


def test_a_view_without_data_is_refused(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda module: object())
    tree = official(MESHOPT_NAMES[0])
    del tree.body["bufferViews"][1]["extensions"]
    with pytest.raises(RefusedFileError, match="buffer view 1 in a buffer without data"):
        read(tree, tmp_path / "a.glb")


def test_draco_is_read_where_its_decoder_is_installed(tmp_path: pathlib.Path) -> None:
    pytest.importorskip("DracoPy")
    body = gltf.export_glb(trimesh.Scene(trimesh.Trimesh(CORNERS, FACES, process=False)), extension_draco=True)
    assert b"KHR_draco_mesh_compression" in body
    (tmp_path / "a.glb").write_bytes(body)
    source = read_source(tmp_path / "a.glb", tmp_path)
    np.testing.assert_allclose(sorted(map(tuple, source.vertices)), sorted(map(tuple, CORNERS)), atol=1e-3)
    assert len(source.faces) == 4


def test_a_refused_file_is_tried_again_once_its_decoder_is_there(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path / "cache"))
    tree = Tree()
    tree.body["extensionsRequired"] = ["KHR_draco_mesh_compression"]
    path = tree.write(tmp_path / "cone.glb")
    journal = tmp_path / "cache" / "assets" / "imported" / "journal.jsonl"
    for installed, lines in ((), 1), ((), 1), (("DracoPy",), 2):
        monkeypatch.setattr(run, "decoders", lambda installed=installed: installed)
        assert main(["assets", "import", str(path), "--licence", "CC0-1.0", "--no-pictures"]) == 2
        assert len(journal.read_text(encoding="utf-8").splitlines()) == lines
