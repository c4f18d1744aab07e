"""`python -m urbanverse_mjx.citygen.validation`: faults of the validation streets; `--out` writes graphs."""

import sys

from ..craft.discovery import check
from . import BUILDERS

if __name__ == "__main__":
    sys.exit(check(BUILDERS, __doc__))
