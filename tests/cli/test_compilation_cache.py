"""A damaged file of JAX's compilation cache is replaced; JAX alone compiles in every later process, or runs it."""

import os
import pathlib
import subprocess
import sys
import time
import warnings
import zlib

import pytest
import zstandard

from urbanverse_mjx.cli import compilation_cache

ROOT = pathlib.Path(__file__).parents[2]
OLD = time.time() - 3600.0
#: A program as a command runs it, with the folder that `main` names in the environment before anything imports JAX.
CODE = """
from urbanverse_mjx import settings
from urbanverse_mjx.cli.compilation_cache import replace_damaged_entries
replace_damaged_entries(settings.use_compilation_cache())
import jax
import jax.numpy as jnp

def three_times(x):
    return 3.0 * x

print(jax.jit(three_times)(jnp.float32(2.0)))
"""


@pytest.fixture
def folder(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> pathlib.Path:
    """An empty compilation cache."""
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path))
    (tmp_path / "jax").mkdir()
    return tmp_path / "jax"


def test_a_changed_file_is_renamed_and_replaced(folder: pathlib.Path) -> None:
    environment = {k: x for k, x in os.environ.items() if not k.startswith("JAX_")} | {"PYTHONPATH": str(ROOT)}
    environment |= {"JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0", "JAX_PLATFORMS": "cpu"}

    def run() -> tuple[str, str]:
        done = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True, env=environment, cwd=ROOT)
        return done.stdout, done.stderr

    assert run() == ("6.0\n", "")
    (entry,) = folder.glob("jit_three_times-*-cache")
    others = {path: path.read_bytes() for path in folder.glob("*-cache") if path != entry}
    for path in (entry, *others):
        os.utime(path, (OLD, OLD))
    assert compilation_cache._changed(folder) == []
    whole = bytearray(entry.read_bytes())
    whole[len(whole) // 2] ^= 4
    entry.write_bytes(whole)
    os.utime(entry, (OLD, OLD))
    said = f"{entry}: found a damaged file, kept as {entry.name}.bad, compiling it anew\n"
    assert run() == ("6.0\n", said)
    assert entry.with_name(f"{entry.name}.bad").read_bytes() == whole
    assert entry.is_file()
    assert {path: path.read_bytes() for path in others} == others


@pytest.mark.parametrize("pack", [zlib.compress, lambda body: zstandard.ZstdCompressor().compress(body)])
def test_what_jax_cannot_read_is_renamed(
    pack, folder: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    body, shown = pack(b"program" * 100), []
    (folder / "jit_f-1-cache").write_bytes(body[:-5])
    for name in ("jit_f-2-cache", "jit_g-3-cache"):
        (folder / name).write_bytes(body)
    monkeypatch.setattr(warnings, "showwarning", lambda message, *args, **named: shown.append(str(message)))
    compilation_cache.replace_damaged_entries(folder)
    for program in ("jit_f", "jit_g", "jit_h"):
        message = f"Error reading persistent compilation cache entry for '{program}': ZstdError"
        warnings.showwarning(UserWarning(message), UserWarning, "compiler.py", 1)
    assert sorted(p.name for p in folder.iterdir()) == ["jit_f-1-cache.bad", "jit_f-2-cache", "jit_g-3-cache"]
    assert capsys.readouterr().err.endswith("kept as jit_f-1-cache.bad, compiling it anew\n")
    assert [text.split("'")[1] for text in shown] == ["jit_g", "jit_h"], "what is no damage stays JAX's warning"


def test_a_file_that_is_being_written_is_not_noted(folder: pathlib.Path) -> None:
    entry = folder / "jit_f-1-cache"
    entry.write_bytes(b"half")
    assert compilation_cache._changed(folder) == []
    entry.write_bytes(b"whole")
    os.utime(entry, (OLD, OLD))
    assert compilation_cache._changed(folder) == []
    entry.write_bytes(b"other")
    os.utime(entry, (OLD, OLD))
    assert compilation_cache._changed(folder) == [entry]


def test_the_programs_used_last_are_compared_and_the_others_stay_known(
    folder: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also those whose last use JAX did not note."""
    monkeypatch.setattr(compilation_cache, "_COMPARED", 20)
    names = ("a", "b", "c")
    entries = {name: folder / f"jit_f-{name}-cache" for name in names}

    def use(name: str, at: float) -> None:
        if name == "c":
            os.utime(entries[name], (at, at))
        else:
            (folder / f"jit_f-{name}-atime").write_bytes(int(at * 1e9).to_bytes(8, "little"))

    for k, name in enumerate(names):
        entries[name].write_bytes(b"program 10")
        os.utime(entries[name], (OLD, OLD))
        use(name, OLD + k)
    assert compilation_cache._changed(folder) == []  # notes b and c
    use("a", OLD + 100.0)
    assert compilation_cache._changed(folder) == []  # and a, besides c
    entries["b"].write_bytes(b"changed ..")
    os.utime(entries["b"], (OLD, OLD))
    assert compilation_cache._changed(folder) == []
    use("b", OLD + 200.0)
    assert compilation_cache._changed(folder) == [entries["b"]]
