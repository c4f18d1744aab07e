"""Checksums of a policy's files, kept in its `policy.json`: a policy that was cut off or changed is never driven."""

import hashlib
import json
import pathlib
from collections.abc import Mapping
from typing import Any

from ..datatypes import validation as v

FILE = "policy.json"
#: Fields of `policy.json` that this module adds: path within the folder -> SHA-256 of that file, and the SHA-256 of
#: all other fields. Policies from before they were written have neither, and load unchecked.
SEAL = ("files", "checksum")
_NEEDED = "the bytes that were written; take another checkpoint, or copy the policy again from where it is whole"


def sealed(body: Mapping[str, Any], folder: pathlib.Path) -> dict[str, Any]:
    """The fields with `SEAL`; when this returns the folder's files are on the disk."""
    entries = [path for path in sorted(folder.rglob("*")) if path != folder / FILE]
    files = [path for path in entries if path.is_file()]
    for path in (*entries, folder):
        v.sync(path)
    digests = {path.relative_to(folder).as_posix(): _digest(path) for path in files}
    full = json.loads(json.dumps({**body, "files": digests}))
    return {**full, "checksum": _checksum(full)}


def check(path: pathlib.Path) -> None:
    """Whether a policy is as it was written.

    Args:
      path: its `policy.json`.

    Raises:
      ValidationError: a file is missing, cut off or changed.
    """
    body = v.read_json(path, "policy")
    if not isinstance(body, dict) or not set(SEAL) & set(body):
        return  # from before there were checksums, or no policy, for which its reader gives the better error
    files = body.get("files")
    if not isinstance(files, dict) or body.get("checksum") != _checksum(body):
        raise v.fail(str(path), "content that does not match its checksum", _NEEDED)
    for name, digest in files.items():
        file = path.parent / name
        if not file.is_file():
            raise v.fail(str(file), "no such file", _NEEDED)
        if _digest(file) != digest:
            raise v.fail(str(file), "content that does not match its checksum", _NEEDED)


def _checksum(body: Mapping[str, Any]) -> str:
    """Over all fields but itself, as JSON reads them back, in order of their names."""
    rest = {name: value for name, value in body.items() if name != "checksum"}
    return hashlib.sha256(json.dumps(rest, sort_keys=True).encode()).hexdigest()


def _digest(path: pathlib.Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
