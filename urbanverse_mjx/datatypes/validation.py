"""Validation functions whose errors are one sentence: where, what was found, what was needed, what to try.

Every datatype validates itself when it is made, so one that exists is a valid one. The functions here
return the checked value in its canonical Python type and raise `ValidationError` otherwise.
"""

import collections
import contextlib
import difflib
import errno
import functools
import gzip
import json
import math
import os
import pathlib
import re
import tempfile
import time
import zlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

MAX_FILE_BYTES = 64 * 2**20
#: Part of the names of temporary files during writing.
_PART = "-urbanverse-"
MAX_TEXT = 2_000  # characters: the longest address a browser takes
#: Characters that XML 1.0 forbids, section 2.2, and tabs and line ends.
_FORBIDDEN = re.compile("[\x00-\x1f\ud800-\udfff\ufffe\uffff]")


class ValidationError(ValueError):
    """A datatype (scene graph, layout, ...) that cannot be used; the message is one clear sentence."""


def fail(where: str, found: str, needed: str, hint: str = "") -> ValidationError:
    """Returns the error (to raise) that states the place, what was found, what was needed and what to try."""
    tail = f"; {hint}" if hint else ""
    return ValidationError(f"{where}: found {found}, needed {needed}{tail}{'' if tail.endswith('?') else '.'}")


def did_you_mean(name: str, known: Iterable[str], number: int = 1, cutoff: float = 0.5) -> str:
    """A hint for `fail`: "did you mean 'a' or 'b'?", or "" if no known name is like the given one.

    Args:
      number: most names that are offered.
      cutoff: least similarity, 0 to 1, of `difflib.get_close_matches`.
    """
    near = difflib.get_close_matches(name, list(known), number, cutoff)
    return f"did you mean {' or '.join(map(repr, near))}?" if near else ""


def show(value: Any, limit: int = 60) -> str:
    """A short printable form of any value."""
    text = repr(value)
    return text if len(text) <= limit else text[: limit - 1] + "…"


def counted(number: float, unit: str, total: float | None = None) -> str:
    """Returns an amount with its unit: "1 scene", "1,024 scenes", "0/1 scene".

    Args:
      unit: in the plural, with a final s that the singular lacks; empty for none.
      total: the amount is so much of it.
    """
    digits = f"{number:,.0f}" if total is None else f"{number:,.0f}/{total:,.0f}"
    name = unit.removesuffix("s") if (number if total is None else total) == 1 else unit
    return f"{digits} {name}" if name else digits


def text(value: Any, where: str, allow_empty: bool = False) -> str:
    if not isinstance(value, str):
        raise fail(where, show(value), "a text")
    if not value and not allow_empty:
        raise fail(where, "an empty text", "a text of at least one character")
    if len(value) > MAX_TEXT:
        raise fail(where, f"a text of {len(value)} characters", f"at most {MAX_TEXT}")
    if _FORBIDDEN.search(value):
        raise fail(where, show(value), "a text without control characters", "XML and file names cannot hold them")
    return value


def identifier(value: Any, where: str) -> str:
    """Checks the name of a scene, which is also the name of a folder."""
    text(value, where)
    if not all((c.isascii() and c.isalnum()) or c in "_-" for c in value):
        raise fail(where, show(value), "ASCII letters, digits, '_' and '-' only")
    return value


def choice(value: Any, where: str, allowed: Iterable[str]) -> str:
    allowed = tuple(allowed)
    if not isinstance(value, str) or value not in allowed:
        hint = did_you_mean(value, allowed) if isinstance(value, str) and len(allowed) > 1 else ""
        raise fail(where, show(value), "one of " + ", ".join(allowed), hint)
    return value


def boolean(value: Any, where: str) -> bool:
    if not isinstance(value, bool):
        raise fail(where, show(value), "true or false")
    return value


def integer(value: Any, where: str, minimum: int | None = None, maximum: int | None = None) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise fail(where, show(value), "a whole number")
    return int(_bounded(value, where, minimum, maximum, None))


def number(
    value: Any,
    where: str,
    minimum: float | None = None,
    maximum: float | None = None,
    above: float | None = None,
) -> float:
    """Checks for a finite number with minimum <= value <= maximum and value > above, for the given limits."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise fail(where, show(value), "a finite number")
    try:
        finite = math.isfinite(value)
    except OverflowError:
        finite = False
    if not finite:
        raise fail(where, show(value), "a finite number", "remove the NaN or infinity where the file was written")
    return float(_bounded(value, where, minimum, maximum, above))


def _bounded(value: float, where: str, minimum: float | None, maximum: float | None, above: float | None) -> float:
    if above is not None and not value > above:
        raise fail(where, show(value), f"a number greater than {above:g}")
    if minimum is not None and value < minimum:
        raise fail(where, show(value), f"a number of at least {minimum:g}")
    if maximum is not None and value > maximum:
        raise fail(where, show(value), f"a number of at most {maximum:g}")
    return value


def vector(value: Any, where: str, length: int, **bounds: Any) -> tuple[float, ...]:
    if not isinstance(value, Sequence) or isinstance(value, (str, bytes)) or len(value) != length:
        raise fail(where, show(value), f"a list of {length} numbers")
    return tuple(number(v, f"{where}[{i}]", **bounds) for i, v in enumerate(value))


def items(value: Any, where: str, minimum: int = 0, maximum: int | None = None) -> Sequence[Any]:
    if not isinstance(value, Sequence) or isinstance(value, (str, bytes)):
        raise fail(where, show(value), "a list")
    if len(value) < minimum:
        raise fail(where, f"{len(value)} entries", f"at least {minimum}")
    if maximum is not None and len(value) > maximum:
        raise fail(where, f"{len(value)} entries", f"at most {maximum}", "split the scene or drop entries")
    return value


def instances(value: Any, where: str, kind: type, minimum: int = 0, maximum: int | None = None) -> tuple[Any, ...]:
    """A tuple of instances of one kind."""
    entries = tuple(items(value, where, minimum, maximum))
    for i, entry in enumerate(entries):
        if not isinstance(entry, kind):
            raise fail(f"{where}[{i}]", show(entry), f"a {kind.__name__}")
    return entries


def named(value: Any, where: str, kind: str) -> str:
    """Name of an entry in errors: its id if it has one, otherwise its index in the list."""
    name = value.get("id") if isinstance(value, Mapping) else None
    return f"{kind} {name!r}" if isinstance(name, str) and 0 < len(name) <= 60 else where


def unique(names: Iterable[str], where: str) -> None:
    seen: set[str] = set()
    for name in names:
        if name in seen:
            raise fail(where, f"the id {name!r} twice", "every id once", "rename one of them")
        seen.add(name)


def mapping(
    value: Any, where: str, required: Iterable[str], optional: Iterable[str] = (), hint: str = ""
) -> Mapping[str, Any]:
    """A JSON object with all required keys and no unknown key."""
    if not isinstance(value, Mapping):
        raise fail(where, show(value), "a JSON object")
    required, optional = tuple(required), tuple(optional)
    for key in required:
        if key not in value:
            raise fail(f"{where}.{key}", "nothing (the field is missing)", "a value", hint or f"add {key!r}")
    for key in value:
        if key not in required and key not in optional:
            known = ", ".join((*required, *optional))
            raise fail(f"{where}.{key}", "an unknown field", f"only {known}", "remove it or fix its spelling")
    return value


def read_json(path: str | os.PathLike[str], kind: str) -> Any:
    """Reads a JSON file; every failure is a `ValidationError` naming the file."""
    path = pathlib.Path(path)
    if not path.is_file():
        raise fail(str(path), "no such file", f"a {kind} file", "check the path")
    if path.stat().st_size > MAX_FILE_BYTES:
        raise fail(str(path), f"{path.stat().st_size} bytes", f"a {kind} file of at most {MAX_FILE_BYTES} bytes")
    try:
        return json.loads(_text(path), object_pairs_hook=_without_repeats)
    except ValidationError as error:
        raise ValidationError(f"{path}: {error}") from error
    except OSError as error:
        raise fail(str(path), f"a file that cannot be read ({error.strerror})", f"a {kind} file") from error
    except (ValueError, RecursionError) as error:
        raise fail(str(path), f"something that is not JSON ({error})", f"a {kind} written as JSON") from error


def parse_json(body: bytes, where: str) -> dict[str, Any]:
    """Parses a JSON object in UTF-8 text that is part of another file.

    Raises:
      ValidationError: the text is not a JSON object.
    """
    try:
        value = json.loads(body.decode("utf-8"))
    except (ValueError, RecursionError) as error:
        raise fail(where, f"something that is not JSON ({error})", "a JSON object") from error
    if not isinstance(value, dict):
        raise fail(where, show(value), "a JSON object")
    return value


def _text(path: pathlib.Path) -> str:
    """A file's text; files that end in .gz are decompressed up to the same size limit."""
    if path.suffix != ".gz":
        return path.read_text(encoding="utf-8")
    with gzip.open(path) as file:
        try:
            body = file.read(MAX_FILE_BYTES + 1)
        except (EOFError, zlib.error, gzip.BadGzipFile) as error:
            raise ValueError(f"broken gzip: {error}") from error
    if len(body) > MAX_FILE_BYTES:
        raise ValueError(f"more than {MAX_FILE_BYTES} bytes when unpacked")
    return body.decode("utf-8")


def _without_repeats(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A JSON object without repeated keys, of which the first values would silently be lost."""
    body = dict(pairs)
    if len(body) != len(pairs):
        twice = next(key for key, count in collections.Counter(key for key, _ in pairs).items() if count > 1)
        raise fail(f"field {show(twice)}", "the same field twice in one object", "every field once", "remove one")
    return body


def write_atomically(path: str | os.PathLike[str], write: Callable[[pathlib.Path], Any]) -> pathlib.Path:
    """Calls `write(temporary_path)` beside `path`, then renames the file, so that readers never see partial content.

    Content and name are flushed to disk in this order before the function returns, so that a power failure leaves the
    old or the new file. Partly written files of killed processes in the folder are removed after a day.

    Raises:
      FileNotFoundError: someone removed the folder, or the file in it, during the call; `filename` is `path`.
    """
    path = pathlib.Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    _sweep_parts(path.parent.absolute())
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.stem}{_PART}", suffix=path.suffix)
    os.close(handle)
    temporary = pathlib.Path(name)
    try:
        write(temporary)
        temporary.chmod(0o644)
        sync(temporary)
        temporary.replace(path)
        sync(path.parent)
    except FileNotFoundError as error:
        if temporary.exists():
            raise
        removed = "it was removed while it was being written; run the command again"
        raise FileNotFoundError(errno.ENOENT, removed, os.fspath(path)) from error
    finally:
        temporary.unlink(missing_ok=True)
    return path


@functools.cache  # once per folder, because listing a large one takes as long as writing a small file
def _sweep_parts(folder: pathlib.Path) -> None:
    """Removes temporary files of `write_atomically` in a folder that are older than a day."""
    for path in folder.glob(f".*{_PART}*"):
        with contextlib.suppress(OSError):
            if (
                re.fullmatch(rf"\..*{_PART}\w{{8}}(\.\w+)?", path.name)
                and time.time() - path.stat().st_mtime > 86_400.0
            ):
                path.unlink()


def sync(path: pathlib.Path) -> None:
    """Flushes a file's content, or a folder's entries, to disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    except OSError as error:
        # File systems without this operation for folders (some network ones) raise these; other errors mean a failing
        # disk.
        if error.errno not in (errno.EINVAL, errno.ENOTSUP):
            raise
    finally:
        os.close(handle)


def set_aside(path: str | os.PathLike[str]) -> pathlib.Path:
    """Renames an invalid file to NAME.bad, or NAME.bad-2 and so on, and returns its new path."""
    path = pathlib.Path(path)
    kept, number = path.with_name(f"{path.name}.bad"), 1
    while kept.exists():
        number += 1
        kept = path.with_name(f"{path.name}.bad-{number}")
    path.rename(kept)
    return kept


def write_json(path: str | os.PathLike[str], value: Any) -> pathlib.Path:
    """Writes JSON; for names that end in .gz, compact and compressed with reproducible bytes."""
    if pathlib.Path(path).suffix == ".gz":
        dense = json.dumps(value, ensure_ascii=False, allow_nan=False, separators=(",", ":")).encode("utf-8")
        packed = gzip.compress(dense, 9, mtime=0)
        return write_atomically(path, lambda temporary: temporary.write_bytes(packed))
    body = json.dumps(value, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    return write_atomically(path, lambda temporary: temporary.write_text(body, encoding="utf-8"))
