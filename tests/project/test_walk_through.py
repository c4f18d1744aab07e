"""The tutorial from driving by hand to a policy, command by command, in small streets; a program holds the keys."""

import json
import pathlib
import re
import shlex
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from urbanverse_mjx import pipeline
from urbanverse_mjx.cli import main as cli
from urbanverse_mjx.datatypes import RESULTS, SceneBank
from urbanverse_mjx.viewer.record_page import RecordPage
from urbanverse_mjx.viewer.session import Session
from urbanverse_mjx.viewer.teleop import Command

PAGE = pathlib.Path(__file__).parents[2] / "docs/tutorials/teleop_to_policy.md"
#: Numbers of the tutorial, and those of the test.
SMALLER = {
    "record": {"--num-episodes": "2"},
    "train": {"--num-episodes": "2", "--num-timesteps": "1024"},
    "dataset": {"--episode": "1"},
}
#: Steps of an episode by hand, and the result that ends it.
STEPS, TIMEOUT = 6, RESULTS.index("timeout") + 1


def commands() -> list[list[str]]:
    """The words of each command of the page after the program's name, in their order."""
    blocks = re.findall(r"^```sh\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    found = [shlex.split(line) for block in blocks for line in block.splitlines()]
    assert all(words[0] == "urbanverse" for words in found)
    return [words[1:] for words in found]


def smaller(words: list[str]) -> list[str]:
    """A command with the test's numbers, and with patterns of file names replaced as a shell does."""
    found = []
    for before, word in zip([""] + words, words, strict=False):
        word = SMALLER.get(words[0], {}).get(before, word)
        found += [str(p) for p in pathlib.Path().glob(word)] or [word] if "*" in word else [word]
    quiet = {"record": ["--quiet", "--no-open", "--port", "0"], "train": ["--quiet", "--no-video"]}
    return found + quiet.get(words[0], ["--no-open"] if words[:2] == ["dataset", "view"] else [])


def at_the_keys(page: RecordPage, make: Callable[[], Session], *_: Any) -> Session:
    """Drives ahead in a bend in place of a person, who then lets the policy drive two steps."""
    session = make()
    page.begin(session)
    for step in range(STEPS):
        session.step({0: session.machine.action_of(Command(0.6, 0.2))} if step < STEPS - 2 else {})
        if session.over:
            break
    # As at the time limit.
    frame = session.frames[-1]
    session.frames[-1] = frame._replace(nav=frame.nav._replace(result=np.full_like(frame.nav.result, TIMEOUT)))
    return session


@pytest.mark.slow
def test_every_command_of_the_walk_through_works(
    small_bank: SceneBank, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    small_bank.save(tmp_path / "bank.npz")
    monkeypatch.setenv("URBANVERSE_BANK", str(tmp_path / "bank.npz"))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(RecordPage, "drive", at_the_keys)
    opened: list[tuple[str | None, str]] = []
    monkeypatch.setattr(pipeline, "view", lambda scene, options, _: opened.append((scene, options.policy)))
    last: dict[str, Any] = {}
    for words in commands():
        assert cli.main(smaller(words)) == 0, shlex.join(words)
        said = capsys.readouterr().out
        if words[0] == "record" or words[:2] == ["dataset", "check"]:
            last = json.loads(said)
        if words[0] == "record":
            assert (last["episodes"], last["frames"]) == (2, 2 * STEPS)
        if words[:2] == ["dataset", "check"]:
            assert last["sound"] is True
    assert (tmp_path / "by_hand-episode-1.html").stat().st_size > 10_000
    (run,) = (tmp_path / "runs").glob("CocoNav-*-by_hand")
    assert opened == [("park_edge", "planner"), ("commercial_bike_lane", "zero"), ("park_edge", f"runs/{run.name}")]
    # The corrected dataset was driven by the trained policy where nobody held a key.
    assert json.loads((tmp_path / "runs/corrected/meta/urbanverse.json").read_text())["policy"] == f"runs/{run.name}"
