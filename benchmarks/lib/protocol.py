"""Common part of the benchmark scripts: `urbanverse benchmark` with a given name."""

import os
import pathlib
import subprocess
import sys

import urbanverse_mjx

ROOT = pathlib.Path(urbanverse_mjx.__file__).resolve().parents[1]


def run(name: str) -> int:
    """Runs the command with the arguments of this process, independent of the current folder."""
    path = os.pathsep.join([str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
    command = [sys.executable, "-m", "urbanverse_mjx.cli.main", "benchmark", name, *sys.argv[1:]]
    return subprocess.call(command, env={**os.environ, "PYTHONPATH": path})
