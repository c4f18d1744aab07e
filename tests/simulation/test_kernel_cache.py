"""Damaged kernels in Warp's cache are compiled anew; Warp alone ends with a traceback, or by a signal."""

import os
import pathlib
import subprocess
import sys

import pytest

from urbanverse_mjx.simulation import kernel_cache

ROOT = pathlib.Path(__file__).parents[2]
CODE = """
import warp

@warp.kernel
def twice(x: warp.array(dtype=float)):
    x[warp.tid()] = 2.0 * x[warp.tid()]

x = warp.array([1.0, 2.0], dtype=float, device="cpu")
warp.launch(twice, 2, inputs=[x], device="cpu")
print(x.numpy().tolist())
"""


def module(cache: pathlib.Path, name: str) -> pathlib.Path:
    """A module's folder as Warp leaves it."""
    folder = cache / name
    folder.mkdir(parents=True)
    for end in ("cpp", "o", "meta"):
        (folder / f"{name}.{end}").write_text(f"{name} {end}")
    return folder


@pytest.fixture
def cache(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> pathlib.Path:
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path / "own"))
    return tmp_path / "warp"


def test_a_damaged_kernel_is_set_aside_and_compiled_anew(cache: pathlib.Path, tmp_path: pathlib.Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(f"import urbanverse_mjx.simulation\n{CODE}")
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "WARP_CACHE_PATH": str(cache)}

    def run() -> subprocess.CompletedProcess[str]:
        return subprocess.run([sys.executable, str(script)], capture_output=True, text=True, env=environment)

    assert run().stdout == "[2.0, 4.0]\n"
    (kernel,) = cache.rglob("wp_*/*.o")
    kernel_cache.check_kernels(kernel.parents[1])
    body = bytearray(kernel.read_bytes())
    body[len(body) // 3] ^= 64
    kernel.write_bytes(body)
    fixed = run()
    assert fixed.stdout == "[2.0, 4.0]\n"
    (line,) = fixed.stderr.splitlines()
    assert line.endswith(f"kept as {kernel.parent.name}.bad, compiling it anew")
    assert (kernel.parent.with_suffix(".bad") / kernel.name).read_bytes() == body
    assert kernel.read_bytes() != body


def test_what_warp_does_not_load_and_unfinished_modules_are_left(
    cache: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, half = module(cache, "wp_a"), module(cache, "wp_b")
    half.rename(cache / "wp_b_p12_t34")
    kernel_cache.check_kernels(cache)
    (folder / "wp_a.cpp").write_text("edited")
    (cache / "wp_b_p12_t34" / "wp_b.o").write_text("")
    kernel_cache.check_kernels(cache)
    assert sorted(p.name for p in cache.iterdir()) == ["wp_a", "wp_b_p12_t34"]
    assert not capsys.readouterr().err


def test_an_empty_file_is_damaged_and_a_new_compilation_may_have_other_bytes(
    cache: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Without a checksum, too: a power failure leaves such files."""
    folder = module(cache, "wp_a")
    (folder / "wp_a.o").write_text("")
    kernel_cache.check_kernels(cache)
    assert capsys.readouterr().err.count("\n") == 1
    kernel_cache.check_kernels(cache)
    (module(cache, "wp_a") / "wp_a.o").write_text("first")
    kernel_cache.check_kernels(cache)
    (folder / "wp_a.o").write_text("second")
    kernel_cache.check_kernels(cache)
    assert capsys.readouterr().err.count("\n") == 1
    (module(cache, "wp_a") / "wp_a.o").write_text("third")
    for _ in range(2):
        kernel_cache.check_kernels(cache)
    assert not capsys.readouterr().err
    assert sorted(p.name for p in cache.iterdir()) == ["wp_a", "wp_a.bad", "wp_a.bad-2"]


def test_checksums_that_cannot_be_read_or_written_stop_nothing(cache: pathlib.Path) -> None:
    module(cache, "wp_a")
    kernel_cache.checksums_path().mkdir(parents=True)
    kernel_cache.check_kernels(cache)
    kernel_cache.check_kernels(cache / "nowhere")
    assert (cache / "wp_a").is_dir()
