"""Reads and writes named arrays in a compressed `.npz` with complete integrity checks.

The archive's comment holds a CRC-32 of the whole file, which is compared in the memory from which `zipfile` then reads.
`zipfile` also keeps one of each array, of the uncompressed bytes, of which a bank has several times as many. It is
compared only in files without the comment, as NumPy writes them. NumPy trusts the shape in an array's header; here it
must match the array's size.
"""

import contextlib
import hashlib
import math
import mmap
import os
import pathlib
import sys
import zipfile
import zlib
from collections.abc import Collection, Mapping
from typing import Any, BinaryIO, cast

import numpy as np

from . import validation as v

_SUFFIX = ".npy"
_HEADERS = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}


#: Begins the archive's comment; the CRC-32 of all bytes before it follows, as hexadecimal digits.
_SEAL, _DIGITS = b"crc32 ", 8
#: Bytes that are read at once: a part of a processor's cache.
_PIECE = 2**18
#: Of zlib. A bank is written 3.6 times as fast as with NumPy's 6, and is 8 % larger; reading takes as long.
_LEVEL = 1


def key_of(told: object, arrays: Mapping[str, np.ndarray]) -> str:
    """24 hexadecimal digits that name a cached file: a hash of arrays, and of what `repr` tells of the rest."""
    digest = hashlib.sha256(repr(told).encode())
    for name, array in arrays.items():
        array = np.ascontiguousarray(array)
        digest.update(f"{name} {array.shape} {array.dtype}".encode())
        digest.update(array.data)
    return digest.hexdigest()[:24]


def save(path: str | os.PathLike[str], arrays: Mapping[str, np.ndarray]) -> pathlib.Path:
    """Writes the arrays atomically; the file name must end in .npz."""
    return v.write_atomically(path, lambda p: _write(p, arrays))


def _write(path: pathlib.Path, arrays: Mapping[str, np.ndarray]) -> None:
    """What `numpy.savez_compressed` does, which has no choice of the level."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=_LEVEL) as archive:
        for name, array in arrays.items():
            with archive.open(name + _SUFFIX, "w", force_zip64=True) as file:
                np.lib.format.write_array(file, np.asanyarray(array), allow_pickle=False)
        archive.comment = _SEAL + bytes(_DIGITS)
    with path.open("r+b") as file:
        with _mapped(file) as body:
            crc = _crc(body)
        file.seek(-_DIGITS, os.SEEK_END)
        file.write(b"%0*x" % (_DIGITS, crc))


class _Mapping(mmap.mmap):
    """A file in memory, of which `zipfile` reads what the checksum has read already."""

    def seekable(self) -> bool:  # `mmap` has it since Python 3.13
        return True


def _mapped(file: BinaryIO) -> _Mapping:
    return _Mapping(file.fileno(), 0, access=mmap.ACCESS_READ)


def _crc(body: mmap.mmap) -> int:
    """CRC-32 of a file without its last digits."""
    with memoryview(body) as view:
        return zlib.crc32(view[:-_DIGITS])


def _is_sealed(body: mmap.mmap) -> bool:
    """Whether a file has a checksum over all of it.

    Raises:
      ValueError: it does not match.
    """
    seal = body[-len(_SEAL) - _DIGITS :]
    if not seal.startswith(_SEAL):
        return False
    if seal[len(_SEAL) :] != b"%0*x" % (_DIGITS, _crc(body)):
        raise ValueError("its checksum is another one")
    return True


def load(path: str | os.PathLike[str], kind: str, hint: str, names: Collection[str] | None = None) -> dict[str, Any]:
    """Reads arrays by name.

    Args:
      kind: expected kind of file, for error messages.
      hint: advice for a damaged one.
      names: those to read, without an error for one that is missing; None for all. All of the file is checked anyway.

    Raises:
      ValidationError: the file cannot be read, is truncated, or any of its bytes changed.
    """
    return _load(path, kind, hint, names)[0]


def _load(
    path: str | os.PathLike[str], kind: str, hint: str, names: Collection[str] | None = None
) -> tuple[dict[str, Any], bool]:
    """The arrays, and whether the file has a checksum over all of it."""
    try:
        with open(path, "rb") as file, _mapped(file) as body, zipfile.ZipFile(cast(Any, body)) as archive:
            sealed = _is_sealed(body)
            entries = archive.infolist()
            if sealed:
                for entry in entries:
                    del entry.CRC  # `zipfile` computes none where there is none to compare
            found = {entry.filename.removesuffix(_SUFFIX): entry for entry in entries}
            wanted = {name: entry for name, entry in found.items() if names is None or not sealed or name in names}
            return {name: _array(archive, entry) for name, entry in wanted.items()}, sealed
    except MemoryError:
        raise
    except Exception as error:
        # A changed byte can cause many types of errors in zipfile, the decompressor or NumPy.
        raise v.fail(str(path), f"an unreadable or damaged file ({v.show(str(error), 100)})", kind, hint) from error


def _array(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> np.ndarray:
    with archive.open(entry) as file:
        shape, by_columns, dtype = _HEADERS[np.lib.format.read_magic(file)](file)
        if dtype.hasobject or math.prod(shape) * dtype.itemsize > entry.file_size:
            raise ValueError(f"{entry.filename} does not have the size that its header gives")
        array = np.empty(shape, dtype, "F" if by_columns else "C")
        left = memoryview(array.reshape(-1, order="A").view(np.uint8))
        while left and (part := file.read(min(len(left), _PIECE))):
            left[: len(part)] = part
            left = left[len(part) :]
        if left or file.read(1):
            raise ValueError(f"{entry.filename} does not have the size that its header gives")
    return array


def load_cached(path: pathlib.Path, kind: str, names: Collection[str]) -> dict[str, np.ndarray] | None:
    """Reads the arrays `names` of a cache file; None if they must be made.

    A damaged file is renamed (see `validation.set_aside`), with one line on standard error. One without a checksum over
    all of it, as older versions wrote them, gets one.
    """
    if not path.is_file():
        return None
    try:
        found, sealed = _load(path, kind, "")
        if set(found) != set(names):
            wrong = ", ".join(sorted(set(found) ^ set(names)))
            raise v.fail(str(path), f"other arrays than expected ({wrong})", kind)
    except v.ValidationError as error:
        discard(path, str(error))
        return None
    if not sealed:
        save_cached(path, found)
    return found


def discard(path: pathlib.Path, reason: str) -> None:
    """Renames an invalid cache file and reports it in one line on standard error."""
    kept = ""
    with contextlib.suppress(OSError):  # another process was faster, or the folder is read-only
        kept = f" kept as {v.set_aside(path).name},"
    sys.stderr.write(f"{reason.rstrip('.')};{kept} building it anew\n")


def save_cached(path: pathlib.Path, arrays: Mapping[str, np.ndarray]) -> None:
    """Writes arrays to the cache; failures are ignored."""
    with contextlib.suppress(OSError):
        save(path, arrays)
