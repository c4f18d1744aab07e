"""A damaged file of JAX's compilation cache is replaced; JAX alone compiles, and warns, in every later process."""

import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).parents[2]
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


def test_a_damaged_file_is_renamed_and_replaced(tmp_path: pathlib.Path) -> None:
    folder = tmp_path / "jax"
    environment = {k: x for k, x in os.environ.items() if not k.startswith("JAX_")}
    environment |= {"PYTHONPATH": str(ROOT), "URBANVERSE_CACHE": str(tmp_path)}
    environment |= {"JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0", "JAX_PLATFORMS": "cpu"}

    def run() -> tuple[str, str]:
        done = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True, env=environment, cwd=ROOT)
        return done.stdout, done.stderr

    assert run() == ("6.0\n", "")
    (entry,) = folder.glob("jit_three_times-*-cache")
    whole = entry.read_bytes()
    entry.write_bytes(whole[:-20])
    other = entry.with_name(f"jit_three_times-{'0' * 64}-cache")
    other.write_bytes(whole)
    said = f"{entry}: found a damaged file, kept as {entry.name}.bad, compiling it anew\n"
    assert run() == ("6.0\n", said)
    assert entry.with_name(f"{entry.name}.bad").read_bytes() == whole[:-20]
    assert other.read_bytes() == whole, "whole files of another program of the same name stay"
    assert len(entry.read_bytes()) > len(whole) - 20, "what was compiled anew is kept"
