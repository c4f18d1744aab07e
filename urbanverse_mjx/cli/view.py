"""`urbanverse view`: shows streets, robots and policies in a web page."""

import dataclasses
import sys
import threading
from collections.abc import Sequence
from typing import Annotated

import tyro

from .. import pipeline
from ..pipeline.viewing import ViewOptions
from ._options import Crowded, EnvOverrides, parse


@dataclasses.dataclass(frozen=True, kw_only=True)
class ViewArgs(ViewOptions):
    """Shows a street in a web page with a policy driving in it; Ctrl-C ends it, with exit status 0."""

    scene: Annotated[str | None, tyro.conf.Positional, tyro.conf.arg(metavar="[NAME|PATH]")] = None
    """A shipped street, a scene of the built library, a graph.json, a compiled scene's folder or a bank (.npz,
    .bank)."""
    people: Crowded = False
    """With moving people and vehicles."""
    env_overrides: EnvOverrides = dataclasses.field(default_factory=dict)
    """JSON of flat dotted env config keys, e.g. '{"robot": "/robots/tug", "sim_dt": 0.005}'."""


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse view`."""
    args = parse(ViewArgs, argv, "urbanverse view")
    pipeline.view(args.scene, args, lambda address: print(f"open {address}", file=sys.stderr, flush=True))
    # Imported by now, with all that the page needed.
    from ..viewer.drive_page import COMPILE

    compiles = any(thread.name == COMPILE for thread in threading.enumerate())
    until = "; the process ends with the compilation that is under way" if compiles else ""
    print(f"stopped; the page is closed{until}", file=sys.stderr)
    return 0
