"""`urbanverse export-policy`: exports a trained policy without its critic."""

import dataclasses
import json
import pathlib
from collections.abc import Sequence
from typing import Annotated

import tyro

from ._options import parse


@dataclasses.dataclass(frozen=True)
class ExportArgs:
    """Write the newest policy of a run without its critic, for inference; prints one JSON line."""

    run: Annotated[pathlib.Path, tyro.conf.Positional]
    """Run or policy folder."""
    out: pathlib.Path
    """Folder to write; new or empty."""


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse export-policy`."""
    args = parse(ExportArgs, argv, "urbanverse export-policy")
    from ..training.policy import PolicySpec, export_actor

    folder = export_actor(args.run, args.out)
    size = sum(f.stat().st_size for f in folder.rglob("*") if f.is_file())
    print(json.dumps({"policy": str(folder), "steps": PolicySpec.load(folder).steps, "bytes": size}))
    return 0
