"""Evaluates a policy on CraftBench: `python benchmarks/craftbench.py --policy planner --impl auto --out DIR`; see
--help."""

import pathlib
import sys

# Allows running as a script from any folder.
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))

from benchmarks.lib.protocol import run

if __name__ == "__main__":
    sys.exit(run("craftbench"))
