"""Every tutorial from its own text: its files are written, its Python runs, its commands are ones that train takes."""

import pathlib
import re
import shlex

import pytest

from urbanverse_mjx import pipeline
from urbanverse_mjx.cli import train
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.envs.robot import make_robot
from urbanverse_mjx.training.policy import PolicySpec, latest_policy
from urbanverse_mjx.training.record import RunRequest, configs_of

ROOT = pathlib.Path(__file__).parents[2]
TUTORIALS = sorted((ROOT / "docs" / "tutorials").glob("*.md"))
every_tutorial = pytest.mark.parametrize("path", TUTORIALS, ids=lambda p: p.stem)
#: Where the tutorials say that the reader's files lie: a folder of the test stands in for it.
FOLDER = "/robots"
#: A block that a line ending in its file's name in backquotes introduces, and any other.
FILE_BLOCK = re.compile(r"`([\w./-]+)`:\n\n```\w+\n(.*?)^```", re.MULTILINE | re.DOTALL)


def written(path: pathlib.Path, folder: pathlib.Path) -> str:
    """Writes the files that a tutorial gives, each folder of `FOLDER` alike; returns its text about `folder`."""
    text = path.read_text(encoding="utf-8")
    for robot in set(re.findall(rf"{FOLDER}/(\w+)\"", text)):
        for name, body in FILE_BLOCK.findall(text):
            file = folder / robot / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(body, encoding="utf-8")
    return text.replace(FOLDER, str(folder))


def blocks(text: str, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)


@every_tutorial
def test_the_python_of_a_tutorial_runs(
    path: pathlib.Path, tmp_path: pathlib.Path, small_bank: SceneBank, monkeypatch: pytest.MonkeyPatch
) -> None:
    bank = tmp_path / "bank.npz"
    small_bank.save(bank)
    monkeypatch.setenv("URBANVERSE_BANK", str(bank))
    code = blocks(written(path, tmp_path), "python")
    assert code
    space: dict[str, object] = {}
    for block in code:
        exec(compile(block, str(path), "exec"), space)


@every_tutorial
def test_the_commands_of_a_tutorial_are_ones_that_can_be_given(
    path: pathlib.Path, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    given: list[RunRequest] = []
    monkeypatch.setattr(pipeline, "train", lambda request, *_: given.append(request) or {})
    lines = "".join(blocks(written(path, tmp_path), "sh")).splitlines()
    for line in lines:
        program, command, *words = shlex.split(line)
        assert (program, command) == ("urbanverse", "train"), "a command that this test does not know how to try"
        assert train.main(words) == 0
        _, config, _ = configs_of(given[-1])
        make_robot(config)
        if "--start-from" in words:
            PolicySpec.load(latest_policy(ROOT / words[words.index("--start-from") + 1]))
    assert len(given) == len(lines) > 0
    capsys.readouterr()
