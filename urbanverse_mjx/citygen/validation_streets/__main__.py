"""`python -m urbanverse_mjx.citygen.validation_streets`: faults of the validation streets; `--out` writes graphs."""

import sys

from ..canvas.discovery import check
from . import BUILDERS

if __name__ == "__main__":
    sys.exit(check(BUILDERS, __doc__))
