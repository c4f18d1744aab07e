"""`python -m urbanverse_mjx.citygen.craft`: says what is wrong in CraftBench's scenes; `--out` writes their graphs."""

import sys

from . import BUILDERS
from .discovery import check

if __name__ == "__main__":
    sys.exit(check(BUILDERS, __doc__))
