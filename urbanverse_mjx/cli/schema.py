"""`urbanverse schema`: the JSON Schema of a file format."""

import dataclasses
import json
from collections.abc import Sequence
from typing import Annotated, Literal

import tyro

from ..datatypes.json_schema import SCHEMAS


@dataclasses.dataclass(frozen=True)
class SchemaArgs:
    """Print the JSON Schema (draft 2020-12) of a scene graph or a layout, for editors and validators."""

    format: Annotated[Literal["graph", "layout"], tyro.conf.Positional]
    """graph: graph.json; layout: layout.json."""


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse schema`."""
    args = tyro.cli(SchemaArgs, args=list(argv), prog="urbanverse schema")
    print(json.dumps(SCHEMAS[args.format](), indent=1, ensure_ascii=False))
    return 0
