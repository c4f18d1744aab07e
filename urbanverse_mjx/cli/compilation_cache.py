"""Handles damaged files of JAX's compilation cache.

JAX detects a truncated file and compiles its program again, but does not replace the file, so every later process would
compile again, with a warning. It detects corrupted bits only in files compressed with zlib; files compressed with zstd
have no checksum, so this module keeps one.
"""

import contextlib
import itertools
import pathlib
import re
import sys
import time
import warnings
import zlib
from typing import Any

from .. import settings

_READING = re.compile(r"Error reading persistent compilation cache entry for '(?P<name>[^']+)'")
_ZSTD = b"\x28\xb5\x2f\xfd"  # begins its files (RFC 8878, section 3.1.1)
_ENTRY = "-cache"  # ends the names of JAX's files
_LAST_USE = "-atime"  # ends those with the time of an entry's last use: 8 bytes, little endian, ns
#: Bytes that are compared when a command starts: of the programs used last, so that a large cache costs no time.
_COMPARED = 2**27
_COMPLETE_AFTER = 60.0  # s after which a file is complete; JAX writes it in place


def replace_damaged_entries(folder: pathlib.Path) -> None:
    """Renames files of the compilation cache that changed since they were first seen (among the 128 MiB used last), and
    from now on those that JAX cannot read, so that newly compiled ones replace them.

    Writes one line per file on standard error in place of JAX's warning.

    Args:
      folder: folder of the cache.
    """
    for path in _changed(folder):
        _set_aside(path)
    show = warnings.showwarning

    def showwarning(message: Any, *args: Any, **named: Any) -> None:
        found = _READING.match(str(message))
        kept = [_set_aside(path) for path in _unreadable(folder, found["name"])] if found else []
        if not any(kept):
            show(message, *args, **named)

    warnings.showwarning = showwarning


def _changed(folder: pathlib.Path) -> list[pathlib.Path]:
    from ..datatypes.checksums import changed_groups

    with contextlib.suppress(OSError):
        entries = [p for p in folder.glob(f"*{_ENTRY}") if time.time() - p.stat().st_mtime > _COMPLETE_AFTER]
        entries.sort(key=_last_use, reverse=True)
        total = itertools.accumulate(path.stat().st_size for path in entries)
        number = sum(size <= _COMPARED for size in total)
        record = settings.cache_dir("kernels", "jax.json")
        groups = {path: [path] for path in sorted(entries[:number])}
        return list(changed_groups(folder, groups, record, entries[number:]))
    return []


def _last_use(entry: pathlib.Path) -> int:
    """When a file of the cache was last used, ns; when it was written, if that is not known."""
    with contextlib.suppress(OSError):
        return int.from_bytes(entry.with_name(entry.name.removesuffix(_ENTRY) + _LAST_USE).read_bytes(), "little")
    return entry.stat().st_mtime_ns


def _unreadable(folder: pathlib.Path, program: str) -> list[pathlib.Path]:
    """The files of programs with a name that cannot be decompressed."""
    return [path for path in sorted(folder.glob(f"{program}-*{_ENTRY}")) if not _is_whole(path)]


def _set_aside(path: pathlib.Path) -> bool:
    from ..datatypes import validation as v

    with contextlib.suppress(OSError):
        kept = v.set_aside(path)
        sys.stderr.write(f"{path}: found a damaged file, kept as {kept.name}, compiling it anew\n")
        return True
    return False


def _is_whole(path: pathlib.Path) -> bool:
    """Whether a file can be decompressed: with zstd (of Python 3.14 or a package) or zlib, like in JAX."""
    try:
        body = path.read_bytes()
        if not body.startswith(_ZSTD):
            zlib.decompress(body)
        elif sys.version_info >= (3, 14):
            from compression import zstd

            zstd.decompress(body)
        else:
            import zstandard

            zstandard.ZstdDecompressor().decompress(body)
    except Exception:  # of three libraries
        return False
    return True
