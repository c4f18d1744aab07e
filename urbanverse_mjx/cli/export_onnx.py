"""`urbanverse export-onnx`: exports a trained policy as an ONNX file."""

import dataclasses
import json
import pathlib
from collections.abc import Sequence
from typing import Annotated

import tyro

from ._options import parse


@dataclasses.dataclass(frozen=True)
class ExportOnnxArgs:
    """Write the newest policy of a run as an ONNX file that needs no JAX, compared with JAX; prints one JSON line."""

    policy: Annotated[pathlib.Path, tyro.conf.Positional]
    """Run or policy folder."""
    out: Annotated[pathlib.Path, tyro.conf.Positional]
    """File to write, .onnx."""


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse export-onnx`."""
    args = parse(ExportOnnxArgs, argv, "urbanverse export-onnx")
    from ..training.export_onnx import export_onnx

    record = export_onnx(args.policy, args.out)
    shapes = {side: {t.name: list(t.shape) for t in getattr(record, side)} for side in ("inputs", "outputs")}
    compared = {"observations": record.observations, "largest_difference": record.largest_difference}
    size = args.out.stat().st_size
    print(json.dumps({"onnx": str(args.out), "bytes": size, **shapes, "rate_hz": record.rate_hz, **compared}))
    return 0
