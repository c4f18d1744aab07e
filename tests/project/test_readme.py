"""The README's Python runs as it stands, and its commands exist."""

import pathlib
import re
import subprocess
import sys

import pytest

from urbanverse_mjx.cli.main import COMMANDS
from urbanverse_mjx.datatypes import SceneBank

ROOT = pathlib.Path(__file__).parents[2]
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", TEXT, flags=re.MULTILINE | re.DOTALL)


def test_the_python_example_runs_and_sees_eight_pictures(bank: SceneBank) -> None:
    del bank  # it lies in the cache, where the example looks for it
    (code,) = blocks("python")
    lines = [line for line in code.splitlines() if line.strip()]
    assert len(lines) <= 10
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    assert re.match(r"\(8, \d+, \d+, 3\) \[", done.stdout)


def test_every_command_and_target_that_the_readme_names_exists() -> None:
    for command in re.findall(r"`urbanverse ([a-z-]+)", TEXT):
        assert command in COMMANDS
    targets = set(re.findall(r"^([a-z-]+):.*## ", (ROOT / "Makefile").read_text(), flags=re.MULTILINE))
    # In code alone: "make the" in prose is no target.
    code = "\n".join([*blocks(""), *re.findall(r"`[^`\n]+`", TEXT)])
    named = set(re.findall(r"\bmake ([a-z-]+)", code))
    assert named
    assert named <= targets


def test_every_command_stands_in_the_readme() -> None:
    assert set(re.findall(r"^\| `urbanverse ([a-z-]+)`", TEXT, flags=re.MULTILINE)) == set(COMMANDS)


@pytest.mark.parametrize("link", re.findall(r"\]\(([^)#]+)\)", TEXT))
def test_links_lead_to_files_of_the_repository(link: str) -> None:
    assert (ROOT / link).is_file()
