"""Figures of results, kept in `tests/figures.txt.xz`: whatever changes a result must acknowledge it.

They do not say that a result is right, but that it is as before: of each part of it (an array, a field, an item) how
many numbers there are, their mean, their root mean square, and two sums with weights that tell places apart. A test
fails with a line for each part that is other than before. Whoever wants the change stores the new figures with
`python -m tests.support.figures`, or of some tests alone with the paths of their files; it tells what changed.
"""

import dataclasses
import enum
import lzma
import os
import pathlib
import re
import sys
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

ROOT = pathlib.Path(__file__).parents[2]
FILE = ROOT / "tests" / "figures.txt.xz"
#: Environment variable under which `check` writes in place of comparing.
STORE = "URBANVERSE_STORE_FIGURES"
#: How tests import this module.
_USE = re.compile(r"^from tests\.support(\.task_figures)? import .*\b(figures|check_task)\b", re.MULTILINE)
#: Weights of elements; their neighbours' are turned by the golden angle, so that no period of an array fits it.
_WEIGHTS = np.exp(1j * np.pi * (3.0 - np.sqrt(5.0)) * np.arange(1, 4094))
#: Arrays of at most so many elements are kept as they are.
_FEW = 6
#: Of a part whose figures are smaller, the tolerance is that of this size: rounding beside values that cancel out.
_SMALL = 0.01


def parts(found: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """(dotted name, array or text) of each part of a nested result.

    A sequence of arrays or records of one kind is one part per field, as if they were joined; what is neither number
    nor text nor holds any, such as a function or a random key, is left out.
    """
    fields = _fields(found)
    if fields is not None:
        for key, value in fields.items():
            yield from parts(value, f"{name}.{key}" if name else str(key))
    elif isinstance(found, enum.Enum):
        yield name, found.name
    elif isinstance(found, str) or found is None:
        yield name, str(found)
    elif isinstance(found, bool | int | float | np.number | np.bool_) or hasattr(found, "__array__"):
        kind = getattr(found, "dtype", np.dtype(float))
        if isinstance(kind, np.dtype) and kind.kind in "biuf":
            yield name, np.asarray(found)
    elif isinstance(found, list | tuple | set | frozenset):
        yield from _joined(sorted(found) if isinstance(found, set | frozenset) else found, name)


def _fields(found: Any) -> Mapping[Any, Any] | None:
    """The parts of a mapping or a record by their names; None of anything else."""
    if dataclasses.is_dataclass(found) and not isinstance(found, type):
        return {f.name: getattr(found, f.name) for f in dataclasses.fields(found)}
    if isinstance(found, tuple) and (names := getattr(found, "_fields", None)):
        return dict(zip(names, found, strict=True))
    return found if isinstance(found, Mapping) else None


def _joined(items: Any, name: str) -> Iterator[tuple[str, Any]]:
    columns: dict[str, list[Any]] = {}
    for item in items:
        for key, value in parts(item):
            columns.setdefault(key, []).append(value)
    for key, values in columns.items():
        where = f"{name}.{key}" if key else name
        if all(isinstance(value, str) for value in values):
            yield where, " ".join(values)
        elif not any(isinstance(value, str) for value in values):
            yield where, np.concatenate([np.ravel(value).astype(np.float64) for value in values])
            if any(np.size(value) != np.size(values[0]) for value in values):
                yield f"{where}.sizes", np.array([np.size(value) for value in values])


def figures_of(value: Any) -> list[float]:
    """Mean, root mean square, and both parts of a weighted sum over the root of the number of elements; elements that
    are not finite count as 0, and an empty array has no figures."""
    flat = np.ravel(value).astype(np.float64)
    if not len(flat):
        return []
    flat = np.where(np.isfinite(flat), flat, 0.0)
    rows = np.pad(flat, (0, -len(flat) % len(_WEIGHTS))).reshape(-1, len(_WEIGHTS))
    # The weights repeat after a prime number of elements, turned further in each row.
    sums = rows @ _WEIGHTS * np.exp(1j * np.arange(len(rows)))
    root, total = np.sqrt(len(flat)), sums.sum()
    return [
        float(flat.mean()), float(np.sqrt((flat**2).mean())), float(total.real / root), float(total.imag / root)
    ]  # fmt: skip


def lines_of(found: Any) -> dict[str, str]:
    """Name of a part -> "=" and its elements if they are few, or how many elements, how many of them are finite where
    not all are, and its figures."""
    lines = {}
    for name, value in parts(found):
        key, number = name.replace(" ", "_"), 2
        while key in lines:
            key, number = f"{name.replace(' ', '_')}#{number}", number + 1
        if not isinstance(value, str) and value.size <= _FEW:
            lines[key] = " ".join(["=", *(f"{x:.6g}" for x in np.ravel(value).astype(np.float64))])
            continue
        if isinstance(value, str):
            word = " ".join(value.split())
            lines[key] = f"text {word if len(word) < 200 else f'{len(word)} {_sum_of(word)} {word[:80]}'}".rstrip()
            continue
        finite = int(np.isfinite(value).sum()) if value.dtype.kind == "f" else value.size
        count = f"{value.size}" if finite == value.size else f"{value.size}/{finite}"
        lines[key] = " ".join([count, *(f"{x:.6g}" for x in figures_of(value))])
    return lines


def _sum_of(text: str) -> int:
    return sum((k + 1) * ord(letter) for k, letter in enumerate(text)) % 10**9


def differences(before: Mapping[str, str], now: Mapping[str, str], tolerance: float) -> list[str]:
    """A line for each part that is other than before, by more than `tolerance` times its root mean square."""
    said = []
    for name in [*before, *(name for name in now if name not in before)]:
        old, new = before.get(name), now.get(name)
        if old is None or new is None:
            said.append(f"{name}: {'new' if old is None else 'gone'}: {new if old is None else old}")
        elif old != new and not _alike(old, new, tolerance):
            said.append(f"{name}: {old}  ->  {new}")
    return said


def _alike(old: str, new: str, tolerance: float) -> bool:
    (count, *olds), (other, *news) = old.split(" "), new.split(" ")
    if count == "text" or count != other or len(olds) != len(news) or not olds:
        return False
    a, b = np.array(olds, np.float64), np.array(news, np.float64)
    same = (a == b) | (np.isnan(a) & np.isnan(b))
    both = np.concatenate([a, b])
    size = np.abs(both[np.isfinite(both)]).max(initial=0.0) if count == "=" else max(a[1], b[1])
    return bool((same | (np.abs(a - b) <= tolerance * max(size, _SMALL))).all())


def check(name: str, found: Any, tolerance: float = 1e-4) -> None:
    """Compares the figures of a result with those kept under a name.

    Args:
      found: nested mappings, sequences, records and arrays.
      tolerance: by which figures may differ, as a share of the root mean square of their part. Other processors and
        versions of XLA round otherwise, at about 1e-6 of a sum.
    """
    now = lines_of(found)
    assert now, f"{name}: no part has figures"
    if os.environ.get(STORE):
        _write(stored() | {name: now})
        return
    before = stored().get(name)
    assert before is not None, f"{FILE} has no {name}; python -m tests.support.figures writes it"
    said = differences(before, now, tolerance)
    more = [] if len(said) <= 20 else [f"and {len(said) - 20} more"]
    head = f"{name}: other than in {FILE.name}; of arrays: elements, mean, rms, and two sums that tell places apart:"
    assert not said, "\n".join([head, *said[:20], *more])


def stored() -> dict[str, dict[str, str]]:
    """Name -> lines, of all that is kept."""
    found, name, group = dict[str, dict[str, str]](), "", ""
    text = lzma.decompress(FILE.read_bytes()).decode("utf-8") if FILE.is_file() else ""
    for line in text.splitlines():
        if line.startswith("# "):
            name = line[2:]
            found[name] = {}
        elif line.startswith("["):
            group = line[1:-1]
        else:
            key, _, figures = line.partition(" ")
            found[name][f"{group}.{key}" if group else key] = figures
    return found


def _write(kept: Mapping[str, Mapping[str, str]]) -> None:
    """What names have in common before their last dot is in a line of its own."""
    text = ""
    for name, lines in sorted(kept.items()):
        text, last = f"{text}# {name}\n[]\n", ""
        for key, line in lines.items():
            group, dot, word = key.rpartition(".")
            if group != last:
                text, last = f"{text}[{group}]\n", group
            text += f"{word if dot else key} {line}\n"
    FILE.write_bytes(lzma.compress(text.encode("utf-8"), preset=9))


def main() -> int:
    """Runs the tests that compare figures, by default all of them, stores what they find, and tells what changed."""
    import pytest

    tests = (ROOT / "tests").rglob("test_*.py")
    files = sys.argv[1:] or sorted(str(f.relative_to(ROOT)) for f in tests if _USE.search(f.read_text("utf-8")))
    before = stored()
    os.environ[STORE] = "1"
    status = int(pytest.main(["-q", "-n", "0", "-k", "figures", *files]))
    for name, lines in stored().items():
        for line in differences(before.get(name, {}), lines, 0.0):
            print(f"{name}: {line}")
    return status


if __name__ == "__main__":
    sys.exit(main())
