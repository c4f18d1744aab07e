"""Writes a scene graph as a line-oriented file."""

import json
import os
import pathlib

from ...datatypes import SceneGraph
from ...datatypes import validation as v


def write(graph: SceneGraph, path: str | os.PathLike[str]) -> pathlib.Path:
    """Writes a graph with one line per object and region: a third of the size, with readable diffs."""
    body = graph.to_json()
    lines = []
    for key, value in body.items():
        if key in ("objects", "ground"):
            rows = ",\n".join(json.dumps(row, separators=(",", ":"), ensure_ascii=False) for row in value)
            lines.append(f'"{key}":[\n{rows}\n]')
        else:
            lines.append(f'"{key}":{json.dumps(value, separators=(",", ":"), ensure_ascii=False)}')
    text = "{" + ",\n".join(lines) + "}\n"
    return v.write_atomically(path, lambda temporary: temporary.write_text(text, encoding="utf-8"))
