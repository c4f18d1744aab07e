"""Checksums of a policy's files in its `policy.json`, so that truncated or modified policies are not used."""

import hashlib
import json
import pathlib
import zlib
from collections.abc import Mapping
from typing import Any

from ..datatypes import validation as v

FILE = "policy.json"
#: Fields of `policy.json` that this module adds: path within the folder -> CRC-32 of that file, and the SHA-256 of all
#: other fields. Older policies have the SHA-256 of each file, which takes twice as long, or neither field, and are then
#: loaded without this check.
SEAL = ("files", "checksum")
#: Hexadecimal digits of a CRC-32.
_DIGITS = 8
_NEEDED = "the bytes that were written; take another checkpoint, or copy the policy again from where it is whole"


def sealed(body: Mapping[str, Any], folder: pathlib.Path) -> dict[str, Any]:
    """Adds the fields of `SEAL`; flushes the folder's files to disk first."""
    entries = [path for path in sorted(folder.rglob("*")) if path != folder / FILE]
    files = [path for path in entries if path.is_file()]
    for path in (*entries, folder):
        v.sync(path)
    digests = {path.relative_to(folder).as_posix(): _digest(path) for path in files}
    full = json.loads(json.dumps({**body, "files": digests}))
    return {**full, "checksum": _checksum(full)}


def check(path: pathlib.Path) -> None:
    """Checks that the files of a policy are unchanged.

    Args:
      path: path of its `policy.json`.

    Raises:
      ValidationError: a file is missing, truncated or changed.
    """
    body = v.read_json(path, "policy")
    if not isinstance(body, dict) or not set(SEAL) & set(body):
        return  # an older policy without checksums, or not a policy, for which the reader has a better error
    files = body.get("files")
    if not isinstance(files, dict) or body.get("checksum") != _checksum(body):
        raise v.fail(str(path), "content that does not match its checksum", _NEEDED)
    for name, digest in files.items():
        file = path.parent / name
        if not file.is_file():
            raise v.fail(str(file), "no such file", _NEEDED)
        if _digest(file, sha256=len(str(digest)) > _DIGITS) != digest:
            raise v.fail(str(file), "content that does not match its checksum", _NEEDED)


def content_sha256(folder: pathlib.Path) -> str:
    """SHA-256 of the content of a policy folder: of its `policy.json`, which has a checksum of every other file, or of
    all files of an older policy without checksums.

    Args:
      folder: the policy folder itself.
    """
    own = folder / FILE
    digest, body = hashlib.sha256(own.read_bytes()), v.read_json(own, "policy")
    if not isinstance(body, dict) or not set(SEAL) & set(body):
        for path in sorted(path for path in folder.rglob("*") if path.is_file() and path != own):
            digest.update(f"\0{path.relative_to(folder).as_posix()}\0{_digest(path, sha256=True)}".encode())
    return digest.hexdigest()


def _checksum(body: Mapping[str, Any]) -> str:
    """Checksum over all other fields in JSON, sorted by name."""
    rest = {name: value for name, value in body.items() if name != "checksum"}
    return hashlib.sha256(json.dumps(rest, sort_keys=True).encode()).hexdigest()


def _digest(path: pathlib.Path, sha256: bool = False) -> str:
    body = path.read_bytes()
    return hashlib.sha256(body).hexdigest() if sha256 else f"{zlib.crc32(body):0{_DIGITS}x}"
