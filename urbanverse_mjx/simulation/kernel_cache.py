"""Warp's folder of compiled kernels: what is damaged there is renamed, so that Warp compiles it anew.

Warp loads what it finds. A file that was cut off ends every later program with a traceback, a changed bit crashes it.
Checksums of the files are kept in this package's own cache; a file without one is trusted and gets one.
"""

import contextlib
import hashlib
import pathlib
import sys

from .. import settings
from ..datatypes import ValidationError
from ..datatypes import validation as v

#: Ends of the names of the files that Warp loads; the sources beside them are for people.
_LOADED = (".o", ".cubin", ".ptx", ".hsaco", ".meta")


def checksums_path() -> pathlib.Path:
    """The file of the cache with the checksums."""
    return settings.cache_dir("kernels", "checksums.json")


def check_kernels(cache: pathlib.Path) -> None:
    """Renames each damaged module in `cache` to NAME.bad, with one line on standard error, and notes new files.

    Args:
      cache: Warp's folder for this version of it, with a folder for each module.
    """
    known = _known()
    found: dict[str, str] = {}
    for module in _modules(cache):
        try:
            digests = {path: _digest(path) for path in sorted(module.iterdir()) if path.name.endswith(_LOADED)}
        except OSError:  # another process is at it
            continue
        bad = [path for path, digest in digests.items() if not digest or known.get(str(path), digest) != digest]
        if bad:
            _discard(module, bad[0])
        else:
            found |= {str(path): digest for path, digest in digests.items()}
    # Warp compiled what is missing now anew, with other bytes perhaps: its old checksum is forgotten.
    elsewhere = {path: digest for path, digest in known.items() if not path.startswith(f"{cache}/")}
    if elsewhere | found != known:
        with contextlib.suppress(OSError):
            v.write_json(checksums_path(), elsewhere | found)


def _known() -> dict[str, str]:
    """Path -> checksum. Without the file, or with one that cannot be read, nothing is known."""
    with contextlib.suppress(ValidationError, OSError):
        body = v.read_json(checksums_path(), "checksums of kernels")
        if isinstance(body, dict):
            return body
    return {}


def _modules(cache: pathlib.Path) -> list[pathlib.Path]:
    """Folders of finished modules; Warp builds each in a folder whose name goes on, and renames it."""
    with contextlib.suppress(OSError):
        return [path for path in sorted(cache.glob("wp_*")) if path.is_dir() and (path / f"{path.name}.meta").exists()]
    return []


def _digest(path: pathlib.Path) -> str:
    """The SHA-256 of a file; empty for an empty one, as a power failure leaves it."""
    body = path.read_bytes()
    return hashlib.sha256(body).hexdigest() if body else ""


def _discard(module: pathlib.Path, bad: pathlib.Path) -> None:
    with contextlib.suppress(OSError):
        kept = v.set_aside(module)
        sys.stderr.write(
            f"{bad}: found other bytes than were compiled; its folder is kept as {kept.name}, compiling it anew\n"
        )
