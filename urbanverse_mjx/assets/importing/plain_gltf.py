"""Rewrites a glTF file as the plain GLB that trimesh reads: compressed views, short numbers, transforms of textures.

trimesh does not decode meshopt's compression (EXT_meshopt_compression and its successor, KHR_meshopt_compression). It
takes integers for coordinates without normalizing them (texture coordinates of core glTF, all coordinates of
KHR_mesh_quantization), and ignores KHR_texture_transform and all sets of texture coordinates but the first.
"""

import base64
import copy
import importlib
import json
import pathlib
import struct
import urllib.parse
from typing import Any

import numpy as np

from .screening import (
    ELEMENTS,
    MESHOPT_MODULE,
    MESHOPT_NAMES,
    TEXTURE_TRANSFORM,
    RefusedFileError,
    compressed,
    inside,
    needs_meshopt,
)

_FLOAT = 5126
_TYPES = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, _FLOAT: np.float32}


def is_plain(tree: dict[str, Any]) -> bool:
    """Whether trimesh reads the geometry of a screened tree as the file means it."""
    if needs_meshopt(tree):
        return False
    accessors = tree.get("accessors", [])
    for primitive in _primitives(tree):
        if any(accessors[k]["componentType"] != _FLOAT for k in _coordinates(primitive).values()):
            return False
        if _texture_transform(tree, primitive) is not None:
            return False
    return True


def plain_glb(tree: dict[str, Any], path: pathlib.Path, folder: pathlib.Path) -> tuple[dict[str, Any], bytes]:
    """The tree of a screened file and the bytes of a GLB file with the same content in one uncompressed buffer.

    Args:
      tree: what `screen` returned for the file.
      path: a GLB or glTF file; `folder`, the imported folder, must contain the files that its buffers name.

    Raises:
      RefusedFileError: compressed data are damaged, or numbers in short form are sparse.
    """
    tree = copy.deepcopy(tree)
    views = _views(tree, path, folder)
    floats: dict[tuple[Any, ...], int] = {}
    for primitive in _primitives(tree):
        transform = _texture_transform(tree, primitive)
        attributes = primitive["attributes"]
        if transform is not None:
            source = attributes.get(f"TEXCOORD_{transform[0]}")
            for name in [name for name in attributes if name.startswith("TEXCOORD_")]:
                del attributes[name]
            if source is not None:
                attributes["TEXCOORD_0"] = source
        for name, k in _coordinates(primitive).items():
            matrix = transform[1] if transform is not None and name == "TEXCOORD_0" else None
            accessor = tree["accessors"][k]
            if "bufferView" not in accessor or (accessor["componentType"] == _FLOAT and matrix is None):
                continue
            key = (k, None if matrix is None else matrix.tobytes())
            if key not in floats:
                floats[key] = _add(tree, views, _transformed(_values(tree, views, accessor), matrix))
            attributes[name] = floats[key]
    for material in tree.get("materials", []):
        _base_texture(material).get("extensions", {}).pop(TEXTURE_TRANSFORM, None)
        _base_texture(material).pop("texCoord", None)
    tree.pop("extensionsRequired", None)
    return tree, _glb(tree, views)


def _primitives(tree: dict[str, Any]) -> list[dict[str, Any]]:
    return [primitive for mesh in tree.get("meshes", []) for primitive in mesh["primitives"]]


def _coordinates(primitive: dict[str, Any]) -> dict[str, int]:
    """Attributes that are read as floating-point numbers, and their accessors."""
    names = ("POSITION", "NORMAL", "TEXCOORD_")
    return {name: k for name, k in primitive["attributes"].items() if name.startswith(names)}


def _base_texture(material: dict[str, Any]) -> dict[str, Any]:
    surface = material.get("pbrMetallicRoughness")
    texture = surface.get("baseColorTexture") if isinstance(surface, dict) else None
    return texture if isinstance(texture, dict) else {}


def _texture_transform(tree: dict[str, Any], primitive: dict[str, Any]) -> tuple[int, np.ndarray] | None:
    """(set of texture coordinates, (2, 3) matrix on (u, v, 1)) of the base colour's image; None for set 0 unchanged.

    The matrix is translation times rotation times scale (KHR_texture_transform, "Overview").
    """
    materials = tree.get("materials", [])
    index = primitive.get("material")
    if not isinstance(index, int) or not 0 <= index < len(materials):
        return None
    texture = _base_texture(materials[index])
    extensions = texture.get("extensions")
    extension = extensions.get(TEXTURE_TRANSFORM) if isinstance(extensions, dict) else None
    extension = extension if isinstance(extension, dict) else {}
    try:
        chosen = int(extension.get("texCoord", texture.get("texCoord", 0)))
        turn = float(extension.get("rotation", 0.0))
        (tu, tv), (su, sv) = (
            [float(x) for x in extension.get(k, d)] for k, d in (("offset", (0, 0)), ("scale", (1, 1)))
        )
    except (TypeError, ValueError) as error:
        raise RefusedFileError("malformed", f"has a {TEXTURE_TRANSFORM} whose numbers cannot be read") from error
    c, s = np.cos(turn), np.sin(turn)
    matrix = np.array([[c * su, s * sv, tu], [-s * su, c * sv, tv]])
    if not np.isfinite(matrix).all():
        raise RefusedFileError("not finite", f"has a {TEXTURE_TRANSFORM} that is no finite numbers")
    return None if chosen == 0 and (matrix == [[1, 0, 0], [0, 1, 0]]).all() else (chosen, matrix)


def _transformed(values: np.ndarray, matrix: np.ndarray | None) -> np.ndarray:
    return values if matrix is None else values[:, :2] @ matrix[:, :2].T + matrix[:, 2]


def _views(tree: dict[str, Any], path: pathlib.Path, folder: pathlib.Path) -> list[bytes]:
    """The uncompressed bytes of each buffer view."""
    held: dict[int, bytes] = {}

    def buffer(k: int) -> bytes:
        if k not in held:
            held[k] = _buffer(tree["buffers"][k].get("uri"), path, folder)
        return held[k]

    views = []
    required = needs_meshopt(tree)
    for k, view in enumerate(tree.get("bufferViews", [])):
        extension = compressed(view) if required else None
        source = view if extension is None else extension
        start = source.get("byteOffset", 0)
        raw = buffer(source["buffer"])[start : start + source["byteLength"]]
        if extension is not None:
            raw = _decoded(raw, extension, k)
            for name in MESHOPT_NAMES:
                view["extensions"].pop(name, None)
        views.append(raw)
    return views


def _buffer(uri: str | None, path: pathlib.Path, folder: pathlib.Path) -> bytes:
    if uri is None:
        body = path.read_bytes()
        length = struct.unpack("<I", body[12:16])[0]
        return body[28 + length :]
    if uri.startswith("data:"):
        kind, _, text = uri.partition(",")
        return base64.b64decode(text) if kind.endswith(";base64") else urllib.parse.unquote_to_bytes(text)
    return inside(folder, path.parent, urllib.parse.unquote(uri)).read_bytes()


def _decoded(raw: bytes, extension: dict[str, Any], k: int) -> bytes:
    count, stride = extension["count"], extension["byteStride"]
    if not count:
        return b""
    decoder = importlib.import_module(MESHOPT_MODULE)
    try:
        rows = decoder.decode_gltf_buffer(raw, count, stride, extension["mode"], extension.get("filter", "NONE"))
    except (RuntimeError, ValueError) as error:
        raise RefusedFileError("malformed", f"has a compressed buffer view {k} that is damaged") from error
    return np.ascontiguousarray(rows).tobytes()


def _values(tree: dict[str, Any], views: list[bytes], accessor: dict[str, Any]) -> np.ndarray:
    """(N, K) float64 of an accessor; normalized integers as shares (glTF 2.0, section 3.11)."""
    if "sparse" in accessor:
        raise RefusedFileError(
            "unsupported",
            "has sparse coordinates in short form or under a transform; export it without sparse accessors",
        )
    dtype, width = np.dtype(_TYPES[accessor["componentType"]]), ELEMENTS[accessor["type"]]
    view, start = accessor["bufferView"], accessor.get("byteOffset", 0)
    stride = tree["bufferViews"][view].get("byteStride", 0) or width * dtype.itemsize
    found = np.ndarray((accessor["count"], width), dtype, views[view], start, (stride, dtype.itemsize))
    values = found.astype(np.float64)
    if accessor.get("normalized") and dtype.kind in "iu":
        values = np.maximum(values / np.iinfo(dtype).max, -1.0)
    return values


def _add(tree: dict[str, Any], views: list[bytes], values: np.ndarray) -> int:
    """Adds an accessor of float32 for `values` (N, K); returns its number."""
    tree["bufferViews"].append({})
    views.append(values.astype("<f4").tobytes())
    kind = f"VEC{values.shape[1]}"
    tree["accessors"].append(
        {"bufferView": len(views) - 1, "componentType": _FLOAT, "type": kind, "count": len(values)}
    )
    return len(tree["accessors"]) - 1


def _glb(tree: dict[str, Any], views: list[bytes]) -> bytes:
    """GLB 2.0: 12 bytes of header, then the JSON and the binary chunk, each a multiple of four bytes long."""
    binary = bytearray()
    for view, raw in zip(tree.get("bufferViews", []), views, strict=True):
        view |= {"buffer": 0, "byteOffset": len(binary), "byteLength": len(raw)}
        binary += raw + b"\0" * (-len(raw) % 4)
    tree["buffers"] = [{"byteLength": len(binary)}]
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sIII4s", b"glTF", 2, 28 + len(text) + len(binary), len(text), b"JSON")
    return head + text + struct.pack("<I4s", len(binary), b"BIN\0") + bytes(binary)
