"""Every tutorial from its own text: its files are written, its Python runs, its commands are ones that can be given."""

import pathlib
import re
import shlex
from typing import Any

import mujoco
import numpy as np
import pytest

from urbanverse_mjx import pipeline
from urbanverse_mjx.cli import main
from urbanverse_mjx.datatypes import SceneBank, SceneGraph, SceneLayout
from urbanverse_mjx.envs.robot import make_robot
from urbanverse_mjx.scene import compiler
from urbanverse_mjx.scene.drive import Drive
from urbanverse_mjx.training.config import batch_shape
from urbanverse_mjx.training.policy import PolicySpec, latest_policy
from urbanverse_mjx.training.record import RunRequest, configs_of

ROOT = pathlib.Path(__file__).parents[2]
TUTORIALS = sorted((ROOT / "docs" / "tutorials").glob("*.md"))
#: Their Python is run by a test of their own, below.
APART = ("own_scene",)
every_tutorial = pytest.mark.parametrize("path", TUTORIALS, ids=lambda p: p.stem)
#: Folder of the reader's files in the tutorials, replaced by a folder of the test.
FOLDER = "/robots"
#: A block that a line ending in its file's name in backquotes introduces, and any other.
FILE_BLOCK = re.compile(r"`([\w./-]+)`:\n\n```\w+\n(.*?)^```", re.MULTILINE | re.DOTALL)


def written(path: pathlib.Path, folder: pathlib.Path) -> str:
    """Writes the files that a tutorial gives, each folder of `FOLDER` alike; returns its text about `folder`."""
    text = path.read_text(encoding="utf-8")
    robots = [folder / name for name in set(re.findall(rf"{FOLDER}/(\w+)\"", text))]
    for place in robots or [folder]:
        for name, body in FILE_BLOCK.findall(text):
            file = place / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(body, encoding="utf-8")
    return text.replace(FOLDER, str(folder))


def blocks(text: str, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("path", [p for p in TUTORIALS if p.stem not in APART], ids=lambda p: p.stem)
def test_the_python_of_a_tutorial_runs(
    path: pathlib.Path, tmp_path: pathlib.Path, small_bank: SceneBank, monkeypatch: pytest.MonkeyPatch
) -> None:
    bank = tmp_path / "bank.npz"
    small_bank.save(bank)
    monkeypatch.setenv("URBANVERSE_BANK", str(bank))
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    space: dict[str, object] = {}
    for block in blocks(written(path, tmp_path), "python"):
        exec(compile(block, str(path), "exec"), space)


@every_tutorial
def test_the_trainings_of_a_tutorial_are_ones_that_can_be_given(
    path: pathlib.Path, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    given: list[RunRequest] = []
    monkeypatch.setattr(pipeline, "train", lambda request, *_: given.append(request) or {})
    for block in blocks(written(path, tmp_path), "sh"):
        for line in block.splitlines():
            program, command, *words = shlex.split(line)
            if (program, command) != ("urbanverse", "train"):
                continue  # test_site asks the command whether it has these options
            assert main.main(["train", *words]) == 0
            _, config, ppo = configs_of(given[-1])
            make_robot(config)
            if "minibatch" in ppo:
                batch_shape(ppo)
            if "--start-from" in words:
                PolicySpec.load(latest_policy(ROOT / words[words.index("--start-from") + 1]))
    assert given or path.stem in ("benchmark", "deploy")
    capsys.readouterr()


@pytest.mark.extended
def test_the_streets_of_the_tutorial_compile(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = written(ROOT / "docs" / "tutorials" / "own_scene.md", tmp_path)
    monkeypatch.chdir(tmp_path)
    short, surrounded = blocks(text, "python")
    assert len([line for line in short.splitlines() if line and not line.startswith(("from", "import"))]) <= 10
    exec(compile(short, "own_scene.md", "exec"), {})
    # The robot has driven every episode of the first street, which took most of the time.
    monkeypatch.setattr(compiler, "drive_all", lambda *given: [Drive(1.0, "")] * len(given[-1]))
    exec(compile(surrounded, "own_scene.md", "exec"), {})
    (named,) = re.findall(r'own_ground_descriptor\("(.*?)"\)', surrounded)
    layout = SceneLayout.load(tmp_path / "asphalt_street" / "layout.json")
    assert {g.id: g.material for g in layout.ground}["road"] == named
    (command,) = re.findall(r"^urbanverse (scene compile .*)$", text, flags=re.MULTILINE)
    assert main.main(shlex.split(command)) == 0
    for name in ("my_street", "asphalt_street", "kiosk_row"):
        model = mujoco.MjModel.from_xml_path(str(tmp_path / name / "scene.xml"))
        names = {model.body(i).name for i in range(model.nbody)} | {model.geom(i).name for i in range(model.ngeom)}
        for obj in SceneGraph.load(tmp_path / f"{name}.json").objects:
            assert any(obj.id in name for name in names), obj.id


def test_the_policy_of_the_tutorial_drives_to_the_goal(tmp_path: pathlib.Path) -> None:
    (body,) = [
        body for name, body in FILE_BLOCK.findall(written(ROOT / "docs" / "tutorials" / "benchmark.md", tmp_path))
    ]
    space: dict[str, Any] = {}
    exec(compile(body, "my_policy.py", "exec"), space)
    actions = space["Towards"]()({"goal": np.array([[5.0, 0.0], [0.0, 2.0], [-3.0, 4.0]])})
    np.testing.assert_allclose(actions, [[1, 0], [0, 1], [0, 0.8]], atol=1e-12)


@pytest.mark.extended
def test_the_messages_of_a_tutorial_are_those_of_the_code() -> None:
    """The words of each message between its `...`, and `found` and `needed`, stand in one file of the package."""
    text = (ROOT / "docs" / "tutorials" / "own_video.md").read_text(encoding="utf-8")
    table = text.split("| message | cause | remedy |")[1].split("\n\n")[0]
    messages = [m for line in table.splitlines()[2:] for m in re.findall(r"`([^`]+)`", line.split("|")[1])]
    assert len(messages) > 6
    package = (ROOT / "urbanverse_mjx").rglob("*.py")
    # Parts of one message stand in several literals where values come between.
    code = [re.sub(r"\{[^}]*\}|[\"'\s]+(?:f[\"'])?", " ", path.read_text(encoding="utf-8")) for path in package]
    for message in messages:
        words = [re.sub(r"[\s,]+", " ", part).strip() for part in re.split(r"\.\.\.|found|needed", message)]
        assert any(all(word in re.sub(r"[\s,]+", " ", file) for word in words) for file in code), message
