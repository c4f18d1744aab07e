"""What the benchmark scripts share: `urbanverse benchmark` with the name already said."""

import sys

from urbanverse_mjx.cli.main import main


def run(name: str) -> int:
    """Runs the command on the arguments of this process."""
    return main(["benchmark", name, *sys.argv[1:]])
