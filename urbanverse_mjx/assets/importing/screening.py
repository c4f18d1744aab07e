"""Checks a mesh file's structure before any reader loads it, with little memory, and refuses dangerous files.

For glTF the checks cover lengths of chunks, buffers, views and accessors, the tree of nodes, and the referenced files;
for STL and PLY the counts in the headers. Only files that pass are given to the reader.
"""

import dataclasses
import importlib.util
import json
import pathlib
import re
import stat
import struct
import urllib.parse
from collections.abc import Iterator
from typing import Any

from urbanverse_mjx.datatypes import ValidationError

SUFFIXES = (".glb", ".gltf", ".obj", ".stl", ".ply")
# Bytes of one element by component type, and elements by kind (glTF 2.0, section 3.6.2).
COMPONENT_BYTES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
ELEMENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
#: Extension that moves, turns and scales an image over the coordinates of a texture.
TEXTURE_TRANSFORM = "KHR_texture_transform"
# Required extensions that change only the appearance, and those that are read without a further package.
READ = re.compile(rf"KHR_materials_\w+|KHR_lights_punctual|KHR_mesh_quantization|{TEXTURE_TRANSFORM}")
#: Extensions of meshopt's compression of buffer views, and the module that decodes it.
MESHOPT_NAMES, MESHOPT_MODULE = ("EXT_meshopt_compression", "KHR_meshopt_compression"), "meshopt"
#: Extension of compressed geometry -> the module that decodes it, an optional package of the same name.
DECODERS = {"KHR_draco_mesh_compression": "DracoPy", **dict.fromkeys(MESHOPT_NAMES, MESHOPT_MODULE)}
# Filters of meshopt's rows, and how many bytes a row then has (EXT_meshopt_compression, "JSON schema updates").
_ROWS = {
    "NONE": range(4, 257, 4),
    "OCTAHEDRAL": (4, 8),
    "QUATERNION": (8,),
    "EXPONENTIAL": range(4, 257, 4),
    "COLOR": (4, 8),
}
#: Bytes of a PLY number by its type (Turk, "The PLY Polygon File Format", 1994, and the sized names in use since).
PLY_BYTES = {
    **dict.fromkeys((b"char", b"uchar", b"int8", b"uint8"), 1),
    **dict.fromkeys((b"short", b"ushort", b"int16", b"uint16"), 2),
    **dict.fromkeys((b"int", b"uint", b"float", b"int32", b"uint32", b"float32"), 4),
    **dict.fromkeys((b"double", b"float64"), 8),
}


@dataclasses.dataclass(frozen=True)
class Limits:
    """Limits of an imported file. 3 million vertices are 400 times the maximum of shipped assets."""

    file_bytes: int = 512 * 2**20
    json_bytes: int = 32 * 2**20
    nodes: int = 20_000
    depth: int = 200
    primitives: int = 10_000
    vertices: int = 3_000_000
    indices: int = 18_000_000


LIMITS = Limits()


class RefusedFileError(ValidationError):
    """A file is refused; `reason` is one of a few keywords, the message is a sentence."""

    def __init__(self, reason: str, sentence: str) -> None:
        self.reason, self.sentence = reason, sentence
        super().__init__(reason, sentence)

    def __str__(self) -> str:
        return self.sentence


def inside(folder: pathlib.Path, base: pathlib.Path, name: str) -> pathlib.Path:
    """The file to which a mesh file in `base` refers, which must be in the imported folder.

    Raises:
      RefusedFileError: the reference is a URL, an absolute path, or leads out of the folder, also through a link.
    """
    if "\0" in name or re.match(r"^[A-Za-z][\w+.-]*:", name) or name.startswith(("/", "\\", "~")):
        raise RefusedFileError(
            "path trick", f"refers to the file {name[:80]!r}; needed one in its folder, by a relative path"
        )
    path = (base / name.replace("\\", "/")).resolve()
    if not path.is_relative_to(folder.resolve()):
        raise RefusedFileError(
            "path trick", f"refers to the file {name[:80]!r}, which lies outside the imported folder"
        )
    return path


def screen(path: pathlib.Path, folder: pathlib.Path, limits: Limits = LIMITS) -> dict[str, Any]:
    """Checks one file; returns its glTF tree (empty for other formats).

    Args:
      path: the file.
      folder: the imported folder, which must contain all referenced files.

    Raises:
      RefusedFileError: the file must not be read.
    """
    if not path.resolve().is_relative_to(folder.resolve()):
        raise RefusedFileError("path trick", "is a link that leads outside the imported folder")
    status = path.stat()
    if not stat.S_ISREG(status.st_mode):
        raise RefusedFileError("not a file", "is a device, pipe or socket, needed a plain file")
    if status.st_size == 0:
        raise RefusedFileError("empty", "holds 0 bytes")
    if status.st_size > limits.file_bytes:
        raise RefusedFileError("too large", f"holds {status.st_size} bytes, at most {limits.file_bytes} are read")
    if check := {".obj": _screen_obj, ".stl": _screen_stl, ".ply": _screen_ply}.get(path.suffix.lower()):
        check(path, limits)
        return {}
    text, chunk = _glb_json(path, limits) if path.suffix.lower() == ".glb" else (_head(path, limits), None)
    tree = _parse(text)
    _screen_tree(tree, path, folder, chunk, limits)
    return tree


def _head(path: pathlib.Path, limits: Limits) -> bytes:
    if path.stat().st_size > 4 * limits.json_bytes:  # buffers may stand in the text
        raise RefusedFileError("too large", f"holds {path.stat().st_size} bytes of JSON")
    return path.read_bytes()


def _glb_json(path: pathlib.Path, limits: Limits) -> tuple[bytes, int]:
    """The JSON chunk, and the bytes of the binary chunk (GLB: 12 bytes of header, 8 before each chunk)."""
    size = path.stat().st_size
    with path.open("rb") as file:
        head = file.read(20)
        if len(head) < 20:
            raise RefusedFileError("truncated", f"holds {size} bytes, a GLB file begins with 20")
        magic, version, length, json_length, kind = struct.unpack("<4sIII4s", head)
        if magic != b"glTF" or version != 2 or kind != b"JSON":
            raise RefusedFileError("malformed", "does not begin as a GLB 2.0 file does")
        if length > size or 20 + json_length > size:
            raise RefusedFileError("truncated", f"holds {size} bytes, its header gives {max(length, 20 + json_length)}")
        if json_length > limits.json_bytes:
            raise RefusedFileError("too large", f"holds {json_length} bytes of JSON")
        text, chunk = file.read(json_length), file.read(8)
        binary = struct.unpack("<I", chunk[:4])[0] if len(chunk) == 8 else 0
        if 28 + json_length + binary > size and binary:
            raise RefusedFileError("truncated", f"holds {size} bytes, its binary chunk alone needs {binary}")
    return text, binary


def _parse(text: bytes) -> dict[str, Any]:
    try:
        tree = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise RefusedFileError("malformed", f"holds no readable JSON ({str(error)[:80]})") from error
    if not isinstance(tree, dict):
        raise RefusedFileError("malformed", "holds JSON that is no object")
    return tree


def _rows(tree: dict[str, Any], name: str) -> list[dict[str, Any]]:
    rows = tree.get(name, [])
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise RefusedFileError("malformed", f"has {name} that are no list of objects")
    return rows


def _whole(row: dict[str, Any], key: str, default: int | None, below: int, what: str) -> int:
    value = row.get(key, default)
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < below:
        raise RefusedFileError("absurd numbers", f"has {what} with {key} {str(value)[:30]}, needed 0 to {below - 1}")
    return value


def decoders() -> tuple[str, ...]:
    """The optional modules for compressed geometry that are installed."""
    return tuple(name for name in sorted(set(DECODERS.values())) if importlib.util.find_spec(name) is not None)


def needs_meshopt(tree: dict[str, Any]) -> bool:
    """Whether buffer views must be decoded; where the extension is optional, the file also has them uncompressed."""
    return any(name in MESHOPT_NAMES for name in tree.get("extensionsRequired", []))


def compressed(view: dict[str, Any]) -> dict[str, Any] | None:
    """How a buffer view is compressed by meshopt; None if it is not."""
    extensions = view.get("extensions")
    found = [extensions[name] for name in MESHOPT_NAMES if name in extensions] if isinstance(extensions, dict) else []
    return found[0] if found and isinstance(found[0], dict) else None


def _screen_tree(
    tree: dict[str, Any], path: pathlib.Path, folder: pathlib.Path, chunk: int | None, limits: Limits
) -> None:
    required = tree.get("extensionsRequired", [])
    if not isinstance(required, list):
        raise RefusedFileError("malformed", "has extensionsRequired that are no list of names")
    for name in map(str, required):
        module = DECODERS.get(name)
        if module in decoders() or (module is None and READ.fullmatch(name)):
            continue
        how = "export it without"
        if module is not None:
            how = f"run `pip install {module}`, or write it without by `npx @gltf-transform/cli copy IN OUT`"
        raise RefusedFileError("unsupported", f"needs the glTF extension {name[:60]!r}; {how}")
    _screen_nodes(_rows(tree, "nodes"), limits)
    views = _screen_buffers(tree, path, folder, chunk, limits)
    counts = _screen_accessors(_rows(tree, "accessors"), views, limits)
    _screen_meshes(tree, counts, limits)
    for image in _rows(tree, "images"):
        if isinstance(image.get("uri"), str) and not image["uri"].startswith("data:"):
            inside(folder, path.parent, urllib.parse.unquote(image["uri"]))
        elif "bufferView" in image:
            _whole(image, "bufferView", None, len(views), "an image")


def _screen_nodes(nodes: list[dict[str, Any]], limits: Limits) -> None:
    """Checks the number of nodes, that each has at most one parent, and that there is no cycle or too long chain."""
    if len(nodes) > limits.nodes:
        raise RefusedFileError("too many nodes", f"has {len(nodes)} nodes, at most {limits.nodes} are read")
    parent = [-1] * len(nodes)
    for k, node in enumerate(nodes):
        children = node.get("children", [])
        if not isinstance(children, list) or len(children) > len(nodes):
            raise RefusedFileError("malformed", f"has a node {k} whose children are no list of nodes")
        for child in children:
            child = _whole({"child": child}, "child", None, len(nodes), f"a node {k}")
            if parent[child] >= 0:
                raise RefusedFileError("cyclic nodes", f"has a node {child} with two parents")
            parent[child] = k
    for k in range(len(nodes)):
        at, steps = k, 0
        while parent[at] >= 0:
            at, steps = parent[at], steps + 1
            if steps > min(limits.depth, len(nodes)):
                reason = "cyclic nodes" if steps > len(nodes) else "too many nodes"
                raise RefusedFileError(reason, f"has a chain of more than {steps - 1} nodes above node {k}")


def _screen_buffers(
    tree: dict[str, Any], path: pathlib.Path, folder: pathlib.Path, chunk: int | None, limits: Limits
) -> list[tuple[int, int]]:
    """(bytes, stride or 0) of each buffer view."""
    lengths = []
    placeholders = set()
    for k, buffer in enumerate(_rows(tree, "buffers")):
        length = _whole(buffer, "byteLength", None, limits.file_bytes + 1, f"buffer {k}")
        uri = buffer.get("uri")
        if uri is None and needs_meshopt(tree) and (k or chunk is None):
            placeholders.add(k)
            held = length
        elif uri is None:
            held = chunk or 0
        elif not isinstance(uri, str):
            raise RefusedFileError("malformed", f"has a buffer {k} whose uri is no text")
        elif uri.startswith("data:"):
            held = len(uri) * 3 // 4
        else:
            file = inside(folder, path.parent, urllib.parse.unquote(uri))
            if not file.is_file():
                raise RefusedFileError("missing file", f"refers to the file {uri[:80]!r}, which does not exist")
            held = file.stat().st_size
        if held < length:
            raise RefusedFileError("truncated", f"has a buffer {k} of {held} bytes, declared with {length}")
        lengths.append(length)
    views = []
    for k, view in enumerate(_rows(tree, "bufferViews")):
        what = f"buffer view {k}"
        buffer, size = _screen_range(view, lengths, what)
        stride = _whole(view, "byteStride", 0, 253, what)
        extension = compressed(view) if needs_meshopt(tree) else None
        if extension is not None:
            _screen_compressed(extension, lengths, placeholders, size, limits, what)
        elif buffer in placeholders:
            raise RefusedFileError("missing file", f"has a {what} in a buffer without data")
        views.append((size, stride))
    if needs_meshopt(tree) and (total := sum(size for size, _ in views)) > limits.file_bytes:
        raise RefusedFileError("too large", f"holds {total} bytes once decoded, at most {limits.file_bytes} are read")
    return views


def _screen_range(row: dict[str, Any], lengths: list[int], what: str) -> tuple[int, int]:
    """(buffer, bytes) of a range, which must lie inside its buffer."""
    buffer = _whole(row, "buffer", None, len(lengths), what)
    offset = _whole(row, "byteOffset", 0, lengths[buffer] + 1, what)
    return buffer, _whole(row, "byteLength", None, lengths[buffer] - offset + 1, what)


def _screen_compressed(
    extension: dict[str, Any], lengths: list[int], placeholders: set[int], size: int, limits: Limits, what: str
) -> None:
    """Checks meshopt's numbers of one buffer view of `size` bytes (EXT_meshopt_compression, "JSON schema updates")."""
    buffer, _ = _screen_range(extension, lengths, f"compressed {what}")
    if buffer in placeholders:
        raise RefusedFileError("missing file", f"has a compressed {what} in a buffer without data")
    stride = _whole(extension, "byteStride", None, 257, f"compressed {what}")
    count = _whole(extension, "count", None, limits.file_bytes + 1, f"compressed {what}")
    mode, filtered = extension.get("mode"), extension.get("filter", "NONE")
    if mode == "ATTRIBUTES":
        fits = stride in _ROWS.get(str(filtered), ())
    else:
        fits = mode in ("TRIANGLES", "INDICES") and filtered == "NONE" and stride in (2, 4)
        fits = fits and (mode == "INDICES" or count % 3 == 0)
    if not fits or count * stride != size:
        raise RefusedFileError(
            "absurd numbers",
            f"has a compressed {what} of {count} rows of {stride} bytes, mode {str(mode)[:20]!r} and filter "
            f"{str(filtered)[:20]!r}, in {size} bytes",
        )


def _screen_accessors(accessors: list[dict[str, Any]], views: list[tuple[int, int]], limits: Limits) -> list[int]:
    """Number of elements of each accessor, which must lie inside its view."""
    counts = []
    for k, accessor in enumerate(accessors):
        what = f"accessor {k}"
        count = _whole(accessor, "count", None, limits.indices + 1, what)
        if accessor.get("componentType") not in COMPONENT_BYTES or accessor.get("type") not in ELEMENTS:
            raise RefusedFileError("malformed", f"has {what} of no known type")
        size = COMPONENT_BYTES[accessor["componentType"]] * ELEMENTS[accessor["type"]]
        if "bufferView" in accessor:
            held, stride = views[_whole(accessor, "bufferView", None, len(views), what)]
            offset = _whole(accessor, "byteOffset", 0, held + 1, what)
            if count and offset + (stride or size) * (count - 1) + size > held:
                raise RefusedFileError("absurd numbers", f"has {what} of {count} elements in a view of {held} bytes")
        counts.append(count)
    return counts


def _screen_meshes(tree: dict[str, Any], counts: list[int], limits: Limits) -> None:
    """Checks the numbers of vertices and indices over all nodes, counted once per use."""
    shown = [0] * len(_rows(tree, "meshes"))
    for node in _rows(tree, "nodes"):
        if "mesh" in node:
            shown[_whole(node, "mesh", None, len(shown), "a node")] += 1
    vertices = indices = primitives = 0
    for times, mesh in zip(shown, _rows(tree, "meshes"), strict=True):
        for primitive in _rows(mesh, "primitives"):
            primitives += max(times, 1)
            attributes = primitive.get("attributes")
            if not isinstance(attributes, dict) or "POSITION" not in attributes:
                raise RefusedFileError("malformed", "has a mesh without positions")
            for name in attributes:
                _whole(attributes, name, None, len(counts), "a mesh")
            vertices += max(times, 1) * counts[attributes["POSITION"]]
            if "indices" in primitive:
                indices += max(times, 1) * counts[_whole(primitive, "indices", None, len(counts), "a mesh")]
    if vertices > limits.vertices or indices > limits.indices:
        raise RefusedFileError("too large", f"shows {vertices} vertices and {indices} indices")
    if primitives > limits.primitives:
        raise RefusedFileError("too large", f"shows {primitives} parts; needed at most {limits.primitives}")


def _screen_obj(path: pathlib.Path, limits: Limits) -> None:
    vertices = faces = 0
    for line in _lines(path):
        vertices += line.startswith(b"v ")
        faces += line.startswith(b"f ")
        if b"\0" in line:
            raise RefusedFileError("malformed", "holds binary data, an OBJ file is text")
    if not faces:
        raise RefusedFileError("malformed", f"holds {vertices} vertices and no face")
    if vertices > limits.vertices or 3 * faces > limits.indices:
        raise RefusedFileError("too large", f"holds {vertices} vertices and {faces} faces")


def _screen_stl(path: pathlib.Path, limits: Limits) -> None:
    size = path.stat().st_size
    with path.open("rb") as file:
        head = file.read(84)
    triangles = struct.unpack("<I", head[80:84])[0] if len(head) == 84 else 0
    if head.lstrip()[:5] == b"solid" and size != 84 + 50 * triangles:
        lines = [line.split()[:1] for line in _lines(path)]
        triangles = lines.count([b"facet"])
        if [b"endsolid"] not in lines:
            raise RefusedFileError("truncated", f"holds {triangles} triangles and no end")
    elif size < 84 + 50 * triangles or len(head) < 84:
        needs = 84 + 50 * triangles
        raise RefusedFileError("truncated", f"holds {size} bytes, needed {needs} for its {triangles} triangles")
    if not triangles:
        raise RefusedFileError("malformed", "holds no triangles")
    if 3 * triangles > limits.indices:
        raise RefusedFileError("too large", f"holds {triangles} triangles")


def _screen_ply(path: pathlib.Path, limits: Limits) -> None:
    counts: dict[bytes, int] = {}
    least: dict[bytes, int] = {}
    element, form, header = b"", b"", 0
    for line in _lines(path):
        words, header = line.split() or [b""], header + len(line)
        if header > 2**20 or words[0] == b"end_header":
            break
        if words[0] == b"format" and len(words) == 3:
            form = words[1]
        elif words[0] == b"element" and len(words) == 3 and words[2].isdigit():
            element = words[1]
            counts[element], least[element] = int(words[2]), 0
        elif words[0] == b"property" and len(words) >= 3:
            least[element] = least.get(element, 0) + PLY_BYTES.get(words[1], 0)
            if words[1] == b"list" and len(words) == 5:  # of no entry, but for faces
                entries = 3 if element == b"face" else 0
                least[element] += PLY_BYTES.get(words[2], 0) + entries * PLY_BYTES.get(words[3], 0)
    else:
        raise RefusedFileError("truncated", "has no end of its header")
    vertices, faces = counts.get(b"vertex", 0), counts.get(b"face", 0)
    if not form or not vertices:
        raise RefusedFileError("malformed", "does not begin as a PLY file does")
    if not faces:
        raise RefusedFileError("malformed", f"holds {vertices} vertices and no face; mesh the points first")
    if vertices > limits.vertices or 3 * faces > limits.indices:
        raise RefusedFileError("too large", f"holds {vertices} vertices and {faces} faces")
    # Text needs at least a digit and a separator for each number, and a binary number has at most 8 bytes.
    needed = sum(counts[k] * least[k] for k in counts) // (1 if form.startswith(b"binary") else 4)
    if path.stat().st_size - header < needed:
        held = path.stat().st_size - header
        raise RefusedFileError("truncated", f"holds {held} bytes, its header gives at least {needed}")


def _lines(path: pathlib.Path, longest: int = 2**20) -> Iterator[bytes]:
    with path.open("rb") as file:
        while line := file.readline(longest):
            if len(line) == longest:
                raise RefusedFileError("malformed", f"holds a line of more than {longest} bytes")
            yield line
