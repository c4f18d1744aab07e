"""What JAX keeps of its compilations, where one of these files is damaged.

JAX compiles such a program again, but neither replaces the file nor says which it is: it would compile again, with a
warning, in every later process. Nothing but the standard library is imported before there is one.
"""

import contextlib
import pathlib
import re
import sys
import warnings
import zlib
from typing import Any

_READING = re.compile(r"Error reading persistent compilation cache entry for '(?P<name>[^']+)'")


def replace_damaged_entries(folder: pathlib.Path) -> None:
    """Renames, from now on, files of the compilation cache that JAX cannot read: what it compiles takes their place.

    One line on standard error stands in place of JAX's warning.

    Args:
      folder: of the cache.
    """
    show = warnings.showwarning

    def showwarning(message: Any, *args: Any, **named: Any) -> None:
        found = _READING.match(str(message))
        kept = _set_aside(folder, found["name"]) if found else []
        if not kept:
            show(message, *args, **named)
        for path in kept:
            sys.stderr.write(f"{path}: found a damaged file, kept as {path.name}.bad, compiling it anew\n")

    warnings.showwarning = showwarning


def _set_aside(folder: pathlib.Path, program: str) -> list[pathlib.Path]:
    """Renames the damaged files of programs of a name; returns their old paths."""
    from ..datatypes import validation as v

    kept = []
    with contextlib.suppress(OSError):
        for path in sorted(folder.glob(f"{program}-*-cache")):
            if not _is_whole(path):
                v.set_aside(path)
                kept.append(path)
    return kept


def _is_whole(path: pathlib.Path) -> bool:
    """Whether JAX can unpack a file: with the library that Python has from 3.14 on, else with zlib."""
    body = path.read_bytes()
    try:
        if sys.version_info >= (3, 14):
            from compression import zstd

            zstd.decompress(body)
        else:
            zlib.decompress(body)
    except Exception:
        return False
    return True
