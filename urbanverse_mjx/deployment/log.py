"""The log of a run of `urbanverse deploy`: every event and every decision, in order.

A file is `MAGIC` and then records: the length of the body (4 bytes, little endian), its CRC-32 (4 bytes), and the body:
the length of a JSON object (4 bytes), the object, and bytes that it describes. A process that is killed leaves a file
that ends within a record; everything before it can be read.

| event | fields | bytes |
| --- | --- | --- |
| `begin` | policy, sha256, goals, limits, session, versions | |
| `message` | t_ns, sizes | the parts of the message as they arrived |
| `answer` | t_ns, number, shape (null: no action) | the action, float32 |
| `lost` | t_ns, what | |
| `lapse` | t_ns | |
| `stop` | reason | |
| `request` | number, begin, sha256 of its inputs (null: none) | |
| `command` | | header of the command |

The last two are what the controller decided after the event before them.
"""

import hashlib
import json
import pathlib
import queue
import struct
import threading
import zlib
from collections.abc import Iterator
from typing import Any

import numpy as np

from ..datatypes import ValidationError
from .contract import Inputs
from .controller import Command, Output

MAGIC = b"urbanverse deploy 1\n"
_HEAD = struct.Struct("<II")
_SIZE = struct.Struct("<I")
_MAX_BODY = 2**28  # bytes of a body


def record_of(output: Output) -> tuple[dict[str, Any], bytes]:
    """The record of a decision."""
    if isinstance(output, Command):
        return {"event": "command"}, output.parts()[1]
    return {
        "event": "request",
        "number": output.number,
        "begin": output.begin,
        "sha256": None if output.inputs is None else digest_of(output.inputs),
    }, b""


def digest_of(inputs: Inputs) -> str:
    """SHA-256 of a request's inputs: names, types, shapes and bytes."""
    found = hashlib.sha256()
    for name in sorted(inputs):
        value = np.ascontiguousarray(inputs[name])
        found.update(f"{name} {value.dtype.str} {value.shape}\n".encode())
        found.update(value.tobytes())
    return found.hexdigest()


class LogWriter:
    """Writes records in a thread, so that a slow disk does not hold up the loop.

    Args:
      path: a file that does not exist yet; None to write nothing.

    Raises:
      ValidationError: the file exists.
    """

    def __init__(self, path: pathlib.Path | None) -> None:
        self._queue: queue.SimpleQueue[bytes | None] = queue.SimpleQueue()
        self._error: OSError | None = None
        self._thread = None
        if path is None:
            return
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            self._file = path.open("xb", buffering=0)
        except FileExistsError as error:
            raise ValidationError(f"--log: found {path}, needed a new file; choose another name.") from error
        self._file.write(MAGIC)
        self._thread = threading.Thread(target=self._write, name="deploy-log", daemon=True)
        self._thread.start()

    def add(self, fields: dict[str, Any], blob: bytes = b"") -> None:
        """Adds a record.

        Raises:
          OSError: an earlier record could not be written.
        """
        if self._error is not None:
            raise self._error
        if self._thread is not None:
            text = json.dumps(fields, separators=(",", ":")).encode()
            body = _SIZE.pack(len(text)) + text + blob
            self._queue.put(_HEAD.pack(len(body), zlib.crc32(body)) + body)

    def add_outputs(self, outputs: list[Output]) -> None:
        """Adds the records of decisions."""
        if self._thread is not None:
            for output in outputs:
                self.add(*record_of(output))

    def _write(self) -> None:
        while (body := self._queue.get()) is not None:
            try:
                if self._error is None:
                    self._write_whole(body)
            except OSError as error:
                self._error = error

    def _write_whole(self, body: bytes) -> None:
        view = memoryview(body)
        while view:
            view = view[self._file.write(view) :]

    def close(self) -> None:
        """Waits until everything is written.

        Raises:
          OSError: a record could not be written.
        """
        if self._thread is None:
            return
        self._queue.put(None)
        self._thread.join()
        self._thread = None
        self._file.close()
        if self._error is not None:
            raise self._error


def read_log(path: pathlib.Path) -> Iterator[tuple[dict[str, Any], bytes]]:
    """Yields the records of a log up to the first that is incomplete.

    Raises:
      ValidationError: the file is not a log, or a complete record is damaged.
    """
    if not path.is_file():
        raise ValidationError(f"{path}: found no such file, needed a log of `urbanverse deploy --log`.")
    with path.open("rb") as file:
        if file.read(len(MAGIC)) != MAGIC:
            raise ValidationError(f"{path}: found another file, needed a log of `urbanverse deploy --log`.")
        while len(head := file.read(_HEAD.size)) == _HEAD.size:
            where = file.tell() - _HEAD.size
            length, checksum = _HEAD.unpack(head)
            body = file.read(length) if length <= _MAX_BODY else b""
            if length <= _MAX_BODY and len(body) < length:
                return
            if length > _MAX_BODY or zlib.crc32(body) != checksum:
                raise ValidationError(
                    f"{path}: found a damaged record at byte {where}, needed the file as it was written."
                )
            size = _SIZE.unpack_from(body)[0]
            yield json.loads(body[_SIZE.size : _SIZE.size + size]), body[_SIZE.size + size :]
