"""`urbanverse schema`: the JSON Schema of a file format."""

import dataclasses
import json
from collections.abc import Sequence
from typing import Annotated, Literal

import tyro

from ..datatypes.json_schema import SCHEMAS
from ..deployment.messages import SCHEMAS as MESSAGES
from ._options import parse


@dataclasses.dataclass(frozen=True)
class SchemaArgs:
    """Print the JSON Schema (draft 2020-12) of a scene graph, a layout or a message, for editors and validators."""

    format: Annotated[Literal["graph", "layout", "odometry", "image", "command"], tyro.conf.Positional]
    """graph: graph.json; layout: layout.json; odometry, image, command: headers of messages between `deploy` and a
    robot."""


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse schema`."""
    args = parse(SchemaArgs, argv, "urbanverse schema")
    schema = MESSAGES[args.format] if args.format in MESSAGES else SCHEMAS[args.format]()
    print(json.dumps(schema, indent=1, ensure_ascii=False))
    return 0
