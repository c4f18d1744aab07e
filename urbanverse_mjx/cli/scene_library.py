"""`urbanverse scene library`: builds the sets of the scene library into the cache."""

import dataclasses
import json
import sys
from typing import Annotated

import tyro

from .. import pipeline
from ..pipeline.library.sets import LibraryOptions
from ..scene import library


@dataclasses.dataclass(frozen=True, kw_only=True)
class LibraryArgs(LibraryOptions):
    """Build sets of scenes into the cache: cousins, compiled scenes, one bank each; prints one JSON line per set.

    Continues an interrupted build. Exit status 1 if a layout failed or a scene's hash differs from the committed one.
    """

    sets: Annotated[tuple[str, ...], tyro.conf.Positional] = ()
    """Names from scenes/library.json; none: all."""
    quiet: bool = False
    """No progress bars."""


def main(args: LibraryArgs) -> int:
    """Runs `urbanverse scene library`."""
    names = args.sets or tuple(library.sets())
    for name in names:
        library.scene_set(name)
    return max(_build(name, args) for name in names)


def _build(name: str, args: LibraryArgs) -> int:
    built = pipeline.build_library(name, args, args.quiet)
    for layout, reason in built.failed.items():
        sys.stderr.write(f"{layout}: {reason}\n")
    for scene in built.other_hash:
        sys.stderr.write(f"{scene}: other content than committed in scenes/{name}/{library.HASHES}\n")
    print(json.dumps({**built.summary, "failed": list(built.failed), "other_hash": list(built.other_hash)}))
    return 0 if built.ok else 1
