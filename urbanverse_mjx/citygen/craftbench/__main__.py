"""`python -m urbanverse_mjx.citygen.craftbench`: lists faults of CraftBench's scenes; `--out` writes their graphs."""

import sys

from ..canvas.discovery import check
from . import BUILDERS

if __name__ == "__main__":
    sys.exit(check(BUILDERS, __doc__))
