"""Lines for the person at the terminal; imports the standard library alone, so that a first line comes at once."""

import sys


def announce(text: str, quiet: bool = False) -> None:
    """Prints a line on standard error at once.

    Args:
      quiet: print nothing.
    """
    if not quiet:
        sys.stderr.write(f"{text}\n")
        sys.stderr.flush()
