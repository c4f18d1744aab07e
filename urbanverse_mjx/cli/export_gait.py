"""`urbanverse export-gait`: exports a trained locomotion policy as one small file."""

import dataclasses
import json
import pathlib
from collections.abc import Sequence
from typing import Annotated

import tyro

from ._options import json_object, parse


@dataclasses.dataclass(frozen=True)
class ExportGaitArgs:
    """Write the actor of a run's newest policy as a gait file; prints one JSON line."""

    run: Annotated[pathlib.Path, tyro.conf.Positional]
    """Run or policy folder of a locomotion task."""
    out: pathlib.Path
    """File to write, .npz."""
    meta: str = "{}"
    """JSON object of metadata to store in the file, e.g. '{"wall_seconds": 500}'."""


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse export-gait`."""
    args = parse(ExportGaitArgs, argv, "urbanverse export-gait")
    from ..training.export_gait import export_gait

    gait = export_gait(args.run, json_object(args.meta, "--meta"))
    gait.save(args.out)
    print(json.dumps({"gait": str(args.out), "steps": gait.meta["steps"], "bytes": args.out.stat().st_size}))
    return 0
