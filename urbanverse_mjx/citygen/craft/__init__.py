"""CraftBench: twelve scenes composed by hand, one module `sNN_...` each with a `build() -> Canvas`.

Their ids and themes are those of the authors' release (facts/reference_systems.md b.1).
"""

import importlib
import json
import os
import pathlib
import pkgutil
import re
from collections.abc import Callable

from ...datatypes import SceneGraph
from ...datatypes import validation as v
from .canvas import Canvas

__all__ = ["BUILDERS", "Canvas", "build", "write"]


def _builders() -> dict[str, Callable[[], Canvas]]:
    """Scene id to builder, for every module of this folder that holds a scene."""
    names = sorted(m.name for m in pkgutil.iter_modules(__path__) if re.match(r"s\d\d_", m.name))
    modules = [importlib.import_module(f"{__name__}.{name}") for name in names]
    return {module.ID: module.build for module in modules}


BUILDERS = _builders()


def build(scene_id: str) -> SceneGraph:
    """The graph of one hand-made scene, the same on every machine.

    Raises:
      NounError: no scene has this id.
    """
    v.choice(scene_id, "scene id", BUILDERS)
    return BUILDERS[scene_id]().graph()


def write(graph: SceneGraph, path: str | os.PathLike[str]) -> pathlib.Path:
    """Writes a graph with one line for each object and region: a third of the bytes, and changes can be read."""
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
