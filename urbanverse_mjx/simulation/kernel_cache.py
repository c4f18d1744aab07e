"""Checks Warp's cache of compiled kernels and renames damaged files, so that Warp compiles them again.

Warp loads these files without a check, and truncated or corrupted files cause errors or crashes. Checksums of the files
are stored in this package's cache; a file without one is trusted and gets one.
"""

import contextlib
import pathlib
import sys

from .. import settings
from ..datatypes import validation as v
from ..datatypes.checksums import changed_groups

#: Suffixes of the files that Warp loads; the sources beside them are not loaded.
_LOADED = (".o", ".cubin", ".ptx", ".hsaco", ".meta")


def checksums_path() -> pathlib.Path:
    """The file of the cache with the checksums."""
    return settings.cache_dir("kernels", "checksums.json")


def check_kernels(cache: pathlib.Path) -> None:
    """Renames each damaged module in `cache` to NAME.bad, with one line on standard error, and notes new files.

    Args:
      cache: Warp's folder for this version of it, with a folder for each module.
    """
    modules = {module: _loaded(module) for module in _modules(cache)}
    for module, bad in changed_groups(cache, modules, checksums_path()).items():
        with contextlib.suppress(OSError):
            kept = v.set_aside(module)
            sys.stderr.write(
                f"{bad}: found other bytes than were compiled; its folder is kept as {kept.name}, compiling it anew\n"
            )


def _modules(cache: pathlib.Path) -> list[pathlib.Path]:
    """Folders of finished modules; Warp builds each in a folder with a longer name, and renames it."""
    with contextlib.suppress(OSError):
        return [path for path in sorted(cache.glob("wp_*")) if path.is_dir() and (path / f"{path.name}.meta").exists()]
    return []


def _loaded(module: pathlib.Path) -> list[pathlib.Path]:
    with contextlib.suppress(OSError):
        return [path for path in sorted(module.iterdir()) if path.name.endswith(_LOADED)]
    return []
