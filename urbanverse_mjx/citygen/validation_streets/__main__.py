"""`python -m urbanverse_mjx.citygen.validation_streets`: lists faults of these scenes; `--out` writes their graphs."""

import sys

from ..canvas.discovery import check
from . import BUILDERS

if __name__ == "__main__":
    sys.exit(check(BUILDERS, __doc__))
