"""Episodes driven by hand become the dataset that `record` writes, with a column that says who drove."""

import dataclasses
import pathlib
import socket
import threading
import time
from collections.abc import Callable
from typing import Any, Literal

import numpy as np
import pytest

from tests.pipeline.test_recording import drawn_env, table_of, use
from tests.support.browser import browser
from tests.support.heard_progress import noted
from urbanverse_mjx import pipeline
from urbanverse_mjx.cli import main as cli
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs import NavEnv
from urbanverse_mjx.evaluation.agents import BASELINES
from urbanverse_mjx.pipeline import machines
from urbanverse_mjx.pipeline.recording import record
from urbanverse_mjx.pipeline.recording.encoding import EpisodeWriting
from urbanverse_mjx.progress import Progress
from urbanverse_mjx.viewer.front import served
from urbanverse_mjx.viewer.record_page import RecordPage
from urbanverse_mjx.viewer.session import Machine, NamedPolicy, Session
from urbanverse_mjx.viewer.teleop import Command, Teleop

STEPS = 8
OPTIONS = pipeline.RecordOptions(
    policy="go_to_goal", num_episodes=3, scenes="all", size=(18, 32), port=0, open=False, quiet=True
)
BY_HAND = dataclasses.replace(OPTIONS, teleop=True)


@pytest.fixture(scope="module")
def env(small_bank: SceneBank) -> NavEnv:
    return drawn_env(small_bank, {"episode_length": STEPS})


@pytest.fixture(autouse=True)
def kinematic(env: NavEnv, monkeypatch: pytest.MonkeyPatch) -> None:
    use(env, monkeypatch)


def driven_by(person: Callable[[Session, int], dict[int, np.ndarray]], monkeypatch: pytest.MonkeyPatch) -> None:
    """Lets a function drive in place of somebody at the page; it gives the actions by hand of a step."""

    def drive(page: RecordPage, make: Callable[[], Session], *_: Any) -> Session:
        session = make()
        page.begin(session)
        while not session.over:
            session.step(person(session, len(session) - 1))
        return session

    monkeypatch.setattr(RecordPage, "drive", drive)


@pytest.mark.extended
def test_where_nobody_takes_over_it_is_the_dataset_of_the_policy(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    driven_by(lambda *_: {}, monkeypatch)
    notes: list[tuple[str, str | None]] = []
    with monkeypatch.context() as patch:
        patch.setattr(Progress, "task", noted(notes))
        by_hand = pipeline.record(tmp_path / "hand", BY_HAND, lambda _: notes.append(("opened", None)))
    expected = [("recording", "preparing the page"), ("recording", "drive in the page"), ("opened", None)]
    assert [note for note in notes if note in expected] == expected
    alone = pipeline.record(tmp_path / "alone", OPTIONS)
    assert {k: by_hand[k] for k in ("episodes", "frames", "results")} == {
        k: alone[k] for k in ("episodes", "frames", "results")
    }
    rows, wanted = table_of(tmp_path / "hand"), table_of(tmp_path / "alone")
    assert set(rows) - set(wanted) == {"intervention"}
    assert not any(rows["intervention"])
    for name, column in wanted.items():
        np.testing.assert_allclose(np.array(rows[name], float), np.array(column, float), atol=1e-4, err_msg=name)
    assert pipeline.check_dataset(tmp_path / "hand").problems == ()


@pytest.mark.extended
def test_steps_of_a_person_are_marked_and_their_actions_are_those_of_the_person(
    env: NavEnv, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def person(session: Session, step: int) -> dict[int, np.ndarray]:
        return {0: session.machine.action_of(Command(0.5, 1.0))} if step in (1, 2, 5) else {}

    driven_by(person, monkeypatch)
    ready: list[str] = []
    pipeline.record(tmp_path / "new", BY_HAND, ready.append)
    assert len(ready) == 1
    assert ready[0].startswith("http://127.0.0.1:")
    rows = table_of(tmp_path / "new")
    pattern = np.isin(np.arange(STEPS), (1, 2, 5))
    assert rows["intervention"] == pattern.tolist() * 3
    goal, action = np.array(rows["observation.environment_state"]), np.array(rows["action"])
    straight = goal / np.linalg.norm(goal, axis=1, keepdims=True)
    marked = np.array(rows["intervention"])
    np.testing.assert_allclose(action[~marked], straight[~marked], atol=1e-5)
    # Half of 2 m/s and 1 rad/s, over a horizon of 0.5 s.
    np.testing.assert_allclose(action[marked], np.tile([0.5, 0.5 * np.tan(0.5)], (9, 1)), atol=1e-5)
    import pyarrow.parquet as pq

    episodes = pq.read_table(tmp_path / "new/meta/episodes/chunk-000/file-000.parquet").to_pydict()
    assert episodes["interventions"] == [2, 2, 2]


@pytest.mark.extended
def test_ctrl_c_ends_a_recording_which_is_complete_up_to_its_last_episode(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As *End the recording* does: it is the normal end of a page. It comes while the third episode is driven."""
    begun = []

    def person(session: Session, step: int) -> dict[int, np.ndarray]:
        begun.append(step)
        if begun.count(0) == 3 and step == 4:
            raise KeyboardInterrupt
        return {}

    driven_by(person, monkeypatch)
    said = pipeline.record(tmp_path / "new", BY_HAND)
    assert (said["episodes"], said["frames"]) == (2, 2 * STEPS)
    found = pipeline.check_dataset(tmp_path / "new")
    assert (found.problems, found.episodes, found.frames) == ((), 2, 2 * STEPS)


@pytest.mark.extended
def test_ctrl_c_while_an_episode_is_written_is_an_interruption(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The second episode was driven to its end and is not known to be written."""
    driven_by(lambda *_: {}, monkeypatch)
    wait, waited = EpisodeWriting.wait, []

    def interrupted(writing: EpisodeWriting) -> None:
        waited.append(writing)
        if len(waited) == 2:
            raise KeyboardInterrupt
        wait(writing)

    monkeypatch.setattr(EpisodeWriting, "wait", interrupted)
    with pytest.raises(KeyboardInterrupt):
        pipeline.record(tmp_path / "new", BY_HAND)
    found = pipeline.check_dataset(tmp_path / "new")
    assert (found.problems, found.episodes) == ((), 2)


def test_a_recording_without_an_episode_leaves_no_folder(tmp_path: pathlib.Path) -> None:
    with pytest.raises(ValidationError, match="--teleop: found 0 driven episodes"):
        pipeline.record(tmp_path / "new", BY_HAND, until=lambda: True)
    assert not (tmp_path / "new").exists()


def test_the_terminal_says_at_once_that_the_page_is_loaded(
    capsys: pytest.CaptureFixture[str], tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    said = []

    def load(*_: object) -> None:
        said.append(capsys.readouterr().err)
        raise ValidationError("loaded.")

    monkeypatch.setattr(record, "_prepared", load)
    for options in (dataclasses.replace(BY_HAND, quiet=False), BY_HAND, dataclasses.replace(OPTIONS, quiet=False)):
        with pytest.raises(ValidationError, match="loaded"):
            pipeline.record(tmp_path / "new", options)
    assert said == ["loading the streets and the robot; the page opens after it\n", "", ""]


def test_wrong_input_is_one_sentence_before_anything_is_loaded(
    capsys: pytest.CaptureFixture[str], tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(machines, "load_machine", None)

    def refused(*argv: str) -> str:
        assert cli.main(["record", "--out", str(tmp_path / "new"), "--teleop", "--no-open", *argv]) == 2
        said = capsys.readouterr()
        assert (said.out, said.err.count("\n")) == ("", 1)
        assert not (tmp_path / "new").exists()
        return said.err

    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        assert f"--port: found {port} on 127.0.0.1 taken" in refused("--port", str(port))
    assert "--give-back-after: found -1.0" in refused("--give-back-after", "-1")


@pytest.mark.parametrize("clicked", ["end", "again"])
def test_a_click_during_the_last_step_is_not_lost(
    env: NavEnv, clicked: Literal["end", "again"], monkeypatch: pytest.MonkeyPatch
) -> None:
    machine = Machine(env, NamedPolicy("go_to_goal", BASELINES["go_to_goal"]))
    begun: list[Session] = []

    def make() -> Session:
        begun.append(Session(machine, 0, [0]))
        return begun[-1]

    teleop = Teleop()
    with served("127.0.0.1", 0, teleop) as (server, _):
        page = RecordPage(server, teleop)
        page._view.value = "free"  # no browser's camera is moved
        monkeypatch.setattr(server, "get_clients", lambda: {0: None})

        def tick(*_: object) -> None:
            page.session.step({})
            if page.session.over and len(begun) == 1:
                page._orders.put(lambda: page._want(clicked))

        monkeypatch.setattr(page, "_tick", tick)
        page.playing = True
        done = page.drive(make, "", lambda: False)
        assert done is begun[-1]
        assert len(begun) == {"end": 1, "again": 2}[clicked]
        following = page.drive(make, "", lambda: False)
    assert (following is None) == (clicked == "end")


def leave_and_come_back(tab: Any, dataset: pathlib.Path) -> None:
    """In the middle of the second episode, which loses nothing: the recording waits for a browser."""
    address = tab.url
    tab.goto("about:blank")
    time.sleep(2.0)
    assert pipeline.check_dataset(dataset).episodes == 1
    tab.goto(address)
    tab.frame_locator("#viser").get_by_role("button", name="Play").wait_for(timeout=120_000)


@pytest.mark.slow
def test_a_person_at_a_browser_records_an_episode_discards_one_and_ends(
    small_bank: SceneBank, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # So long that the second episode does not end by itself before a slow browser has clicked.
    steps = 24
    use(drawn_env(small_bank, {"episode_length": steps}), monkeypatch)
    said: list[dict[str, Any]] = []
    ready: list[str] = []
    options = dataclasses.replace(BY_HAND, policy=None, give_back_after=1.0)
    thread = threading.Thread(
        target=lambda: said.append(pipeline.record(tmp_path / "new", options, ready.append)), daemon=True
    )
    thread.start()

    def wait(until: Callable[[], bool]) -> None:
        end = time.monotonic() + 180.0
        while not until():
            assert thread.is_alive()
            assert time.monotonic() < end
            time.sleep(0.05)

    wait(lambda: bool(ready))
    with browser() as chromium:
        tab = chromium.new_page(viewport={"width": 1200, "height": 800})
        tab.goto(ready[0])
        buttons = tab.frame_locator("#viser")
        buttons.get_by_role("button", name="Play").wait_for(timeout=120_000)
        tab.get_by_text("episode 1 of 3").wait_for(timeout=120_000)
        # Nobody drives: no time passes.
        time.sleep(1.0)
        tab.keyboard.down("w")
        tab.get_by_text("episode 2 of 3").wait_for(timeout=180_000)
        tab.keyboard.up("w")
        written = pipeline.check_dataset(tmp_path / "new")
        assert (written.problems, written.episodes) == ((), 1)
        # After a second without a key nobody drives and the episode waits.
        tab.keyboard.press("a")
        tab.get_by_text("1 intervention,").wait_for(timeout=120_000)
        leave_and_come_back(tab, tmp_path / "new")
        tab.get_by_text("1 intervention,").wait_for(timeout=120_000)
        assert thread.is_alive()
        buttons.get_by_role("button", name="Discard and begin again").click(timeout=120_000)
        tab.get_by_text("0 interventions").wait_for(timeout=120_000)
        buttons.get_by_role("button", name="End the recording").click(timeout=120_000)
        thread.join(60.0)
        # The page does not blame the connection for it.
        tab.get_by_text("the recording has ended").first.wait_for(timeout=60_000)
        time.sleep(1.0)
        assert tab.locator("#who").text_content() == "the recording has ended"
    assert not thread.is_alive()
    assert (said[0]["episodes"], said[0]["results"]) == (1, {"timeout": 1})
    rows = table_of(tmp_path / "new")
    assert len(rows["intervention"]) == steps
    assert all(rows["intervention"])
    # Straight ahead at 2 m/s, or standing while the browser is too slow to say what is held.
    action, place = np.array(rows["action"]), np.array(rows["pose"])[:, :2]
    ahead = action[:, 0] > 0.5
    np.testing.assert_allclose(action, np.where(ahead[:, None], [1.0, 0.0], 0.0), atol=0.01)
    assert ahead.any()
    moved = np.linalg.norm(np.diff(place, axis=0), axis=1)
    np.testing.assert_allclose(moved, np.where(ahead[:-1], 0.4, 0.0), atol=0.02)
