"""A small glTF file, written with its tree and buffer under the test's control."""

import json
import pathlib
import struct
from typing import Any

import numpy as np

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


class Tree:
    """A glTF file of one triangle mesh with its buffer in a data URI."""

    def __init__(self) -> None:
        self.body: dict[str, Any] = {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {}}]}],
            "accessors": [],
            "bufferViews": [],
        }
        self.binary = b""
        #: Buffers that follow the one with data.
        self.further: list[dict[str, Any]] = []
        self.primitive["attributes"]["POSITION"] = self.add(CORNERS, 5126, "VEC3")
        self.primitive["indices"] = self.add(FACES.astype(np.uint16).ravel(), 5123, "SCALAR")

    @property
    def primitive(self) -> dict[str, Any]:
        return self.body["meshes"][0]["primitives"][0]

    def add(self, values: np.ndarray, component: int, kind: str, **more: Any) -> int:
        raw = values.tobytes()
        view = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(raw)}
        self.body["bufferViews"].append(view)
        self.binary += raw + b"\0" * (-len(raw) % 4)
        count = len(self.body["accessors"])
        row = {"bufferView": count, "componentType": component, "type": kind, "count": len(values), **more}
        self.body["accessors"].append(row)
        return count

    def write(self, path: pathlib.Path) -> pathlib.Path:
        if path.suffix == ".glb":
            self.body["buffers"] = [{"byteLength": len(self.binary)}, *self.further]
            text = json.dumps(self.body).encode()
            text += b" " * (-len(text) % 4)
            head = struct.pack("<4sIII4s", b"glTF", 2, 28 + len(text) + len(self.binary), len(text), b"JSON")
            path.write_bytes(head + text + struct.pack("<I4s", len(self.binary), b"BIN\0") + self.binary)
        else:
            (path.parent / "my buffer.bin").write_bytes(self.binary)
            self.body["buffers"] = [{"byteLength": len(self.binary), "uri": "my%20buffer.bin"}, *self.further]
            path.write_text(json.dumps(self.body))
        return path
