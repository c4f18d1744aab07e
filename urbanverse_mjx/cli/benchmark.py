"""`urbanverse benchmark NAME`: evaluates a policy on a frozen benchmark."""

import dataclasses
import pathlib
import sys
from collections.abc import Sequence
from typing import Annotated

import tyro

from .. import pipeline
from ..pipeline.benchmarking import BenchmarkOptions
from ._options import EnvOverrides, parse


@dataclasses.dataclass(frozen=True, kw_only=True)
class BenchmarkArgs(BenchmarkOptions):
    """Score a policy on a frozen benchmark: prints the table and writes report.md, results and images to a folder."""

    name: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="NAME|PATH")]
    """autobench, craftbench, autobench_v2, craftbench_v2, shipped, validation, or a file made by `python -m
    benchmarks.freeze`."""
    bank: pathlib.Path | None = None
    """Scene bank; default: the one that `urbanverse scene library` (shipped: `urbanverse scene bank`) built."""
    env_overrides: EnvOverrides = dataclasses.field(default_factory=dict)
    """JSON of flat dotted env config keys, e.g. '{"robot": "/robots/tug", "sim_dt": 0.005}'."""
    out: pathlib.Path | None = None
    """Output folder; default: runs/NAME-POLICY."""
    quiet: bool = False
    """No progress bars, and no line about the report."""


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse benchmark`."""
    args = parse(BenchmarkArgs, argv, "urbanverse benchmark")
    done = pipeline.benchmark(args.name, args.out, args, args.bank, args.quiet)
    sys.stdout.write(done.page)
    if not args.quiet:
        print(f"report: {done.folder / 'report.md'}", file=sys.stderr)
    return 0
