"""Detects changes of files that other programs write, by checksums in a record file."""

import contextlib
import hashlib
import pathlib
from collections.abc import Collection, Mapping, Sequence

from . import validation as v


def changed_groups(
    folder: pathlib.Path,
    groups: Mapping[pathlib.Path, Sequence[pathlib.Path]],
    record: pathlib.Path,
    unchecked: Collection[pathlib.Path] = (),
) -> dict[pathlib.Path, pathlib.Path]:
    """Groups of files below a folder with a file that is empty or changed since it was first seen.

    A new file is trusted and recorded; missing files, and those of a changed group, are removed from the record, since
    their replacements may differ.

    Args:
      groups: name of a group -> its files.
      record: JSON file with the checksums; if it cannot be read or written, no checksum is known.
      unchecked: files whose checksums are kept for another time.

    Returns:
      group -> its first such file.
    """
    known, found = _known(record), {}
    kept = set(map(str, unchecked))
    noted = {path: digest for path, digest in known.items() if path in kept or not path.startswith(f"{folder}/")}
    for group, files in groups.items():
        try:
            digests = {path: _digest(path) for path in files}
        except OSError:  # another process is at it
            continue
        bad = [path for path, digest in digests.items() if not digest or known.get(str(path), digest) != digest]
        if bad:
            found[group] = bad[0]
        else:
            noted |= {str(path): digest for path, digest in digests.items()}
    if noted != known:
        with contextlib.suppress(OSError):
            v.write_json(record, noted)
    return found


def _known(record: pathlib.Path) -> dict[str, str]:
    with contextlib.suppress(v.ValidationError, OSError):
        body = v.read_json(record, "checksums")
        if isinstance(body, dict):
            return body
    return {}


def _digest(path: pathlib.Path) -> str:
    """The SHA-256 of a file; empty for an empty one, as a power failure leaves it."""
    body = path.read_bytes()
    return hashlib.sha256(body).hexdigest() if body else ""
