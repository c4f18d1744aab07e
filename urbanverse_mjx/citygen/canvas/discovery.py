"""Finds hand-made scenes: one module per scene in a package, each with an `ID` and a `build() -> Canvas`."""

import argparse
import importlib
import pathlib
import pkgutil
import re
import sys
from collections.abc import Callable, Iterable, Mapping

from ...datatypes import SceneGraph
from ...datatypes import validation as v
from .canvas import Canvas
from .graph_file import write

Builders = Mapping[str, Callable[[], Canvas]]


def builders(package: str, path: Iterable[str], letter: str) -> dict[str, Callable[[], Canvas]]:
    """Returns scene id to builder for the modules of a package whose names begin with a letter and two digits."""
    names = sorted(m.name for m in pkgutil.iter_modules(path) if re.match(rf"{letter}\d\d_", m.name))
    modules = [importlib.import_module(f"{package}.{name}") for name in names]
    return {module.ID: module.build for module in modules}


def build(known: Builders, scene_id: str) -> SceneGraph:
    """Returns the graph of one scene of a set.

    Raises:
      ValidationError: the set has no scene of this id.
    """
    v.choice(scene_id, "scene id", known)
    return known[scene_id]().graph()


def check(known: Builders, description: str | None) -> int:
    """Runs the command of a set: writes the faults of its scenes to stderr and, with `--out`, their graphs to files.

    Returns:
      the exit code: 1 where a scene has a fault.
    """
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--out", type=pathlib.Path, help="folder for <id>/graph.json; nothing is written without it")
    parser.add_argument("--only", nargs="*", default=[""], help="beginnings of the ids wanted, 03 for example")
    args = parser.parse_args()
    wrong = 0
    for scene_id in [s for s in known if s.startswith(tuple(args.only))]:
        canvas = known[scene_id]()
        for problem in canvas.problems():
            sys.stderr.write(f"{scene_id}: {problem}\n")
            wrong += 1
        graph = canvas.graph()
        if args.out:
            write(graph, args.out / scene_id / "graph.json")
        sys.stdout.write(f"{scene_id}: {len(graph.objects)} objects, {len(graph.ground)} regions\n")
    return 1 if wrong else 0
