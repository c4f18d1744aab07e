"""The notebooks run from top to bottom, and are stored without outputs.

The tests that are not slow run the quick start, in box streets and without its training; the slow ones run all of all.
"""

import json
import pathlib
import subprocess
import sys
from typing import Any

import pytest

from urbanverse_mjx.datatypes import SceneBank

NOTEBOOKS = sorted((pathlib.Path(__file__).parents[2] / "docs" / "notebooks").glob("*.ipynb"))
#: Notebook -> what its code cells print or show, each somewhere in the named one.
SHOWN = {
    "own_street": {1: "bollard_street_cousin1", 2: "image/png", 3: "'SR'"},
    "quick_start": {0: "park_edge", 1: "moved (m)", 2: "image/png", 3: "1024 steps"},
    "scores": {3: "| go_to_goal |", 4: "image/png"},
}


def cells_of(path: pathlib.Path) -> list[dict[str, Any]]:
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return [cell for cell in cells if cell["cell_type"] == "code"]


def run(path: pathlib.Path, folder: pathlib.Path, leave_out: str | None = None) -> list[str]:
    """Runs a copy of a notebook in a folder by nbmake; returns what each code cell printed and showed.

    Args:
      leave_out: cells that hold this are not run.
    """
    body = json.loads(path.read_text(encoding="utf-8"))
    for cell in body["cells"]:
        if leave_out is not None and leave_out in "".join(cell["source"]):
            cell["metadata"]["tags"] = ["skip-execution"]
    copy = folder / path.name
    copy.write_text(json.dumps(body), encoding="utf-8")
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--nbmake", "--overwrite"]
    command += ["--nbmake-timeout=1800", f"--rootdir={folder}", str(copy)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=folder)
    assert done.returncode == 0, done.stdout[-6000:] + done.stderr[-2000:]
    return [json.dumps(cell["outputs"]) for cell in cells_of(copy)]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_kept_without_outputs(path: pathlib.Path) -> None:
    assert path.stem in SHOWN, "a notebook that no test runs"
    for cell in cells_of(path):
        assert (cell["outputs"], cell["execution_count"]) == ([], None), f"{path.name}: clear all outputs"


@pytest.mark.extended
def test_the_quick_start_drives(tmp_path: pathlib.Path, small_bank: SceneBank) -> None:
    small_bank.save(tmp_path / "streets.npz")
    (path,) = [path for path in NOTEBOOKS if path.stem == "quick_start"]
    streets, moved, image, training = run(path, tmp_path, leave_out="pipeline.train(")
    assert small_bank.scene_ids[0] in streets
    assert "moved (m)" in moved
    assert "image/png" in image
    assert training == "[]"


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path: pathlib.Path, tmp_path: pathlib.Path) -> None:
    shown = run(path, tmp_path)
    for cell, text in SHOWN[path.stem].items():
        assert text in shown[cell]
