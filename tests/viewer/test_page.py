"""The page in a real browser: it opens, its buttons work, and closing a browser does not stop the viewer."""

import errno
import io
import pathlib
import re
import threading
import time
import types
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from PIL import Image

from tests.support.box_machine import box_machine
from tests.support.browser import browser
from tests.support.onnx_bytes import linear_policy
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.evaluation import fixed_episodes
from urbanverse_mjx.evaluation.onnx_policy import load_onnx
from urbanverse_mjx.pipeline.playing import _write_html
from urbanverse_mjx.viewer.page import Page
from urbanverse_mjx.viewer.recording import html_recording, start_server
from urbanverse_mjx.viewer.session import Machine, NamedPolicy, Session
from urbanverse_mjx.viewer.street import StreetMeshes
from urbanverse_mjx.viewer.teleop import Inputs


@pytest.fixture(scope="module")
def machine(small_bank: SceneBank) -> Machine:
    return box_machine(small_bank)


class Streets:
    """The box streets, driven by one machine."""

    policies = ("go_to_goal",)

    def __init__(self, machine: Machine) -> None:
        self.machine, self.opened = machine, []

    @property
    def scenes(self) -> tuple[str, ...]:
        return self.machine.env.bank.scene_ids

    def cousins(self, scene: str) -> int:
        return 3

    def open(self, scene: str, cousin: int, policy: str, people: bool) -> tuple[Machine, int]:
        if policy.endswith(".onnx"):
            return self.driven_by(pathlib.Path(policy)), self.scenes.index(scene)
        if policy not in self.policies:
            if policy == "full/disk":
                raise OSError(errno.ENOSPC, "No space left on device", policy)
            raise ValidationError(f"--policy: found {policy!r}, needed go_to_goal.")
        self.opened.append((scene, cousin, policy, people))
        return self.machine, self.scenes.index(scene)

    def driven_by(self, path: pathlib.Path) -> Machine:
        """The same box, driven by an ONNX file."""
        return Machine(self.machine.env, NamedPolicy(path.name, load_onnx(path), outside=True))


@pytest.fixture(scope="module")
def served(machine: Machine) -> Iterator[tuple[Page, Streets, str]]:
    """A page that runs in a thread."""
    server = start_server("127.0.0.1", 0)
    streets = Streets(machine)
    page = Page(server, streets, streets.scenes[0], "go_to_goal", robots=2)
    thread = threading.Thread(target=page.run, daemon=True)
    thread.start()
    yield page, streets, f"http://127.0.0.1:{server.get_port()}"
    page.stop()
    thread.join(10.0)
    server.stop()
    assert not thread.is_alive()


def wait(until: Callable[[], bool], seconds: float = 120.0) -> None:
    end = time.monotonic() + seconds
    while not until():
        assert time.monotonic() < end
        time.sleep(0.05)


def enter(field: Any, text: str, arrived: Callable[[], bool]) -> None:
    """Types into a field until the server has it.

    A value that the server gave the field before may reach the browser after what is typed. The field then shows it,
    and the same text typed again is no change.
    """
    field.fill(text)
    field.press("Enter")
    end = time.monotonic() + 120.0
    while not arrived():
        assert time.monotonic() < end
        pressed = time.monotonic()
        while not arrived() and time.monotonic() < pressed + 5.0:
            time.sleep(0.05)
        if not arrived():
            field.fill(f"{text}0")
            field.fill(text)
            field.press("Enter")


@pytest.fixture(scope="module")
def tab(served: tuple[Page, Streets, str]) -> Iterator[Any]:
    with browser() as chromium:
        tab = chromium.new_page(viewport={"width": 900, "height": 700})
        tab.goto(served[2])
        tab.get_by_role("button", name="Play").wait_for(timeout=120_000)
        yield tab


def screenshot(tab: Any) -> np.ndarray:
    """(H, W, 3) of the page left of the panel."""
    return np.asarray(Image.open(io.BytesIO(tab.screenshot(timeout=120_000))).convert("RGB"))[:, :560].astype(int)


def test_it_shows_a_street(tab: Any) -> None:
    """Ground, sky and objects: more than two colours, each over much of the image."""

    def colours() -> int:
        coarse = screenshot(tab)[200:] // 32
        _, counts = np.unique(coarse.reshape(-1, 3), axis=0, return_counts=True)
        return int((counts > 0.02 * counts.sum()).sum())

    wait(lambda: colours() >= 4)


@pytest.mark.extended
def test_step_play_pause_and_scrub(tab: Any, served: tuple[Page, Streets, str]) -> None:
    page, session = served[0], served[0].session
    tab.get_by_role("button", name="Begin again").click()
    wait(lambda: page.session is not session)
    before = screenshot(tab)
    tab.get_by_role("button", name="Step").click()
    wait(lambda: page.index == 1)
    tab.get_by_role("button", name="Play").click()
    wait(lambda: page.index >= 6)
    tab.get_by_role("button", name="Pause").click()
    wait(lambda: not page.playing)
    assert page.index == len(page.session) - 1
    # The camera went with the robot.
    wait(lambda: bool(np.abs(screenshot(tab) - before).mean() > 2.0))
    tab.get_by_role("textbox").first.fill("2")
    tab.get_by_role("textbox").first.press("Enter")
    wait(lambda: page.index == 2)
    driven = len(page.session)
    tab.get_by_role("button", name="Step").click()
    wait(lambda: page.index == 3)
    assert len(page.session) == driven  # the recorded drive is shown again


@pytest.mark.extended
def test_a_held_key_drives_in_the_next_street_and_one_without_effect_is_named(
    tab: Any, served: tuple[Page, Streets, str]
) -> None:
    page, streets, _ = served
    tab.get_by_role("button", name="Begin again").click()  # so that a browser is connected
    before = page.session
    wait(lambda: page.session is not before or page.index == 0)

    def hold(until: Callable[[], Any], *names: str, age: float | None = None) -> None:
        inputs = Inputs(frozenset(names), age=age)
        wait(lambda: page._teleop.receive(9, inputs, time.monotonic()) or bool(until()))

    hold(lambda: page.state["interventions"] and page.state["latency"], "KeyW", age=0.0)
    before = page.session
    page.open_scene(streets.scenes[1])
    hold(lambda: page.session is not before and len(page.session) > 3, "KeyW")
    assert page.session.scene == 1
    assert page.session.by_hand(3).all()
    assert page.state["latency"] is None  # that of the last street is none of this one
    hold(lambda: page.state["note"] == "release the key and press it again to take over", "KeyW", "KeyT")
    assert page.state["mode"] == "policy"
    hold(lambda: page.state["note"] != "release the key and press it again to take over")
    page._teleop.leave(9)
    page.open_scene(streets.scenes[0])
    wait(lambda: page.session.scene == 0 and not page.playing)


def test_the_page_says_that_it_opens_a_street(
    served: tuple[Page, Streets, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Opening takes long, and meanwhile nothing else is answered."""
    page, streets, _ = served
    said: list[str] = []
    opened = streets.open

    def open_slowly(*asked: Any) -> Any:
        said.append(page.state["who"])
        return opened(*asked)

    monkeypatch.setattr(streets, "open", open_slowly)
    session = page.session
    page.open_scene(streets.scenes[0])
    wait(lambda: page.session is not session and page.state["who"] == "paused")
    assert said == [f"opening {streets.scenes[0]}"]


def test_a_full_disk_is_said_on_the_page_which_goes_on(served: tuple[Page, Streets, str]) -> None:
    page = served[0]
    session = page.session
    page._path.value = "full/disk"
    page._orders.put(page._open)
    wait(lambda: page._status.content == "**full/disk: No space left on device.**")
    assert page.session is session
    page._path.value = ""
    page.open_scene(served[1].scenes[0])
    wait(lambda: page.session is not session)


@pytest.mark.extended
def test_a_wrong_policy_is_said_on_the_page(tab: Any, served: tuple[Page, Streets, str]) -> None:
    page = served[0]
    session = page.session
    field = tab.locator("label", has_text="or a file").locator("xpath=ancestor::div[.//input][1]//input")
    enter(field, "no/such/policy", lambda: page._path.value == "no/such/policy")
    tab.get_by_role("button", name="Open").click()
    tab.get_by_text("--policy: found 'no/such/policy', needed go_to_goal.").wait_for(timeout=120_000)
    assert page.session is session
    enter(field, "", lambda: page._path.value == "")
    tab.get_by_role("button", name="Open").click()
    wait(lambda: page.session is not session)
    assert served[1].opened[-1] == (served[1].scenes[0], 0, "go_to_goal", False)
    assert page.session.rows == (0, 1)


@pytest.mark.extended
def test_an_onnx_file_drives_on_the_page(tab: Any, served: tuple[Page, Streets, str], tmp_path: pathlib.Path) -> None:
    """As it does without a page, and not as the rule of the page before it."""
    page, streets, _ = served
    path = tmp_path / "turn.onnx"
    path.write_bytes(linear_policy(np.array([[0.5, 0.1], [0.0, -1.0]])))
    session = page.session
    field = tab.locator("label", has_text="or a file").locator("xpath=ancestor::div[.//input][1]//input")
    enter(field, str(path), lambda: page._path.value == str(path))
    tab.get_by_role("button", name="Open").click()
    wait(lambda: page.session is not session)
    tab.get_by_role("button", name="Play").click()
    wait(lambda: len(page.session) > 5)
    page._orders.put(page._pause)
    wait(lambda: not page.playing)

    def driven(machine: Machine) -> np.ndarray:
        alone = Session(machine, page.session.scene, page.session.rows)
        for _ in range(5):
            alone.step()
        return np.stack([np.asarray(frame.nav.sim.qpos) for frame in alone.frames])

    found = np.stack([np.asarray(frame.nav.sim.qpos) for frame in page.session.frames[:6]])
    np.testing.assert_allclose(found, driven(streets.driven_by(path)), atol=1e-5)
    assert np.abs(found - driven(streets.machine))[..., :2].max() > 0.2
    session = page.session
    enter(field, "", lambda: page._path.value == "")
    tab.get_by_role("button", name="Open").click()
    wait(lambda: page.session is not session)


@pytest.mark.extended
def test_cousins_are_numbered_as_by_the_commands(tab: Any, served: tuple[Page, Streets, str]) -> None:
    """From 0; a larger number than there are takes the last one."""
    page, streets = served[0], served[1]
    field = tab.get_by_label("cousin", exact=True)
    assert field.input_value() == "0"
    for entered, opened in (("1", 1), ("63", 2), ("0", 0)):
        session = page.session
        enter(field, entered, lambda entered=entered: page._cousin.value == int(entered))
        tab.get_by_role("button", name="Open").click()
        wait(lambda session=session: page.session is not session)
        assert streets.opened[-1][1] == opened


def test_a_scene_is_opened_from_elsewhere(tab: Any, served: tuple[Page, Streets, str]) -> None:
    """As the library's page does: from a thread of its own, while the page runs."""
    page, streets, _ = served
    session = page.session
    page.open_scene(streets.scenes[1])
    wait(lambda: page.session is not session)
    assert streets.opened[-1] == (streets.scenes[1], 0, "go_to_goal", False)
    assert page.session.scene == 1
    page.open_scene(streets.scenes[0])
    wait(lambda: page.session.scene == 0)


def camera_of(page: Page) -> np.ndarray:
    """(3,) m, where the browser's camera is."""
    (client,) = page._server.get_clients().values()
    return np.asarray(client.camera.position)


@pytest.mark.extended
def test_views_and_speeds_are_what_they_say(tab: Any, served: tuple[Page, Streets, str]) -> None:
    page = served[0]
    session = page.session
    tab.get_by_role("button", name="Begin again").click()
    wait(lambda: page.session is not session)

    def choose(control: str, option: str) -> None:
        tab.get_by_role("combobox", name=control, exact=True).click()
        tab.get_by_role("option", name=option, exact=True).click()

    def above() -> float:
        return float(camera_of(page)[2] - np.asarray(page.session.frames[0].nav.sim.xpos)[page._robot(), 1, 2])

    choose("view", "from above")
    wait(lambda: above() > 25.0)
    choose("view", "behind the robot")
    wait(lambda: above() < 3.0)
    choose("view", "free")
    wait(lambda: page._view.value == "free")
    was, index = camera_of(page), page.index
    tab.get_by_role("button", name="Step").click()
    wait(lambda: page.index == index + 1)
    np.testing.assert_allclose(camera_of(page), was, atol=1e-6)
    choose("view", "behind the robot")
    wait(lambda: page._view.value == "behind the robot")
    for speed in ("2x", "4x", "as fast as possible"):
        session = page.session
        tab.get_by_role("button", name="Begin again").click()
        wait(lambda session=session: page.session is not session)
        choose("speed", speed)
        wait(lambda speed=speed: page._speed.value == speed)
        start, first = time.monotonic(), len(page.session)
        tab.get_by_role("button", name="Play").click()
        wait(lambda first=first: len(page.session) >= first + 8 or page.session.over)
        page._orders.put(page._pause)  # not by its button, which goes when the episode ends
        wait(lambda: not page.playing)
        if speed != "as fast as possible":
            # A page that was late may catch up half a second.
            simulated, passed = (len(page.session) - first) * page.session.machine.env.dt, time.monotonic() - start
            assert simulated <= int(speed[0]) * (passed + 0.5)


@pytest.mark.extended
def test_every_other_control_changes_what_it_names(tab: Any, served: tuple[Page, Streets, str]) -> None:
    page, streets, _ = served
    session = page.session
    tab.get_by_role("button", name="Begin again").click()
    wait(lambda: page.session is not session)

    shown = tab.get_by_label("shown", exact=True)
    for visible in (False, True):
        shown.evaluate("box => box.click()")
        wait(lambda visible=visible: page._image.visible == visible)
    after = tab.get_by_label("give back after", exact=True)
    after.fill("7")
    after.press("Enter")
    wait(lambda: page._teleop.give_back_after == 7.0)

    def enter(slider: str, number: int) -> None:
        """Into the field beside a slider, which has its name in a paragraph before it."""
        row = tab.locator("p", has_text=re.compile(f"^{slider}$")).locator("xpath=ancestor::div[.//input][1]")
        field = row.get_by_role("textbox")
        field.fill(str(number))
        field.press("Enter")

    was = camera_of(page)
    enter("robot shown", 2)
    wait(lambda: page._robot() == 1 and bool(np.linalg.norm(camera_of(page) - was) > 0.5))
    enter("episode", 1)
    wait(lambda: page.session.rows == (1, 2))
    enter("robots", 1)
    tab.get_by_label("people", exact=True).first.evaluate("box => box.click()")
    wait(lambda: page._people.value and page._robots.value == 1)
    session = page.session
    tab.get_by_role("button", name="Open").click()
    wait(lambda: page.session is not session)
    assert streets.opened[-1] == (streets.scenes[0], 0, "go_to_goal", True)
    assert (page.session.num_robots, page._robot(), page._which.disabled) == (1, 0, True)


@pytest.mark.extended
def test_layers_are_switched(tab: Any, served: tuple[Page, Streets, str]) -> None:
    page = served[0]
    for layer, node in page.stage._robots[0].lines.items():
        box = tab.get_by_label(layer, exact=True)
        was = node.visible
        box.evaluate("box => box.click()")
        wait(lambda node=node, was=was: node.visible != was)
        box.evaluate("box => box.click()")
        wait(lambda node=node, was=was: node.visible == was)


@pytest.mark.extended
def test_the_layer_of_people_hides_those_that_are_there(
    tab: Any, served: tuple[Page, Streets, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """One is there and stands where the step has it, another is not; not the checkbox of *Choose*."""
    page = served[0]
    chosen = page._people.value
    nodes = [page._server.scene.add_frame(f"/crowd/{i}", visible=False) for i in range(2)]
    moves = types.SimpleNamespace(present=[True, False], heading=[np.pi / 2, 0.0], position=[[1.0, 2.0, 0.0]] * 2)
    monkeypatch.setattr(page.session, "agents", lambda index: moves, raising=False)
    monkeypatch.setattr(page.stage, "_agents", nodes)
    page._orders.put(lambda: page._go(page.index))
    wait(lambda: nodes[0].visible)
    np.testing.assert_allclose(nodes[0].position, [1.0, 2.0, 0.0])
    np.testing.assert_allclose(nodes[0].wxyz, [np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)])
    box = tab.get_by_label("people", exact=True).last
    for shown in (False, True):
        box.evaluate("box => box.click()")
        wait(lambda shown=shown: nodes[0].visible == shown)
        assert not nodes[1].visible
    assert page._people.value == chosen


@pytest.mark.extended
def test_the_recording_is_a_page_of_its_own(
    tab: Any, served: tuple[Page, Streets, str], tmp_path: pathlib.Path
) -> None:
    tab.get_by_role("button", name="Begin again").click()
    for k in range(3):
        tab.get_by_role("button", name="Step").click()
        wait(lambda k=k: served[0].index == k + 1)
    with tab.expect_download(timeout=120_000) as download:
        tab.get_by_role("button", name="Save the drive as a page").click()
    saved = tmp_path / "drive.html"
    download.value.save_as(saved)
    assert download.value.suggested_filename == f"{served[1].scenes[0]}_go_to_goal.html"
    with_no_server = tab.context.browser.new_page(viewport={"width": 900, "height": 700})
    with_no_server.goto(saved.as_uri())
    wait(lambda: bool(screenshot(with_no_server).std() > 20.0))
    with_no_server.close()


@pytest.mark.extended
def test_a_browser_that_leaves_stops_the_drive_and_nothing_else(served: tuple[Page, Streets, str], tab: Any) -> None:
    page = served[0]
    session = page.session
    page._speed.value = "1x"
    page._orders.put(page._pause)
    page._orders.put(page._begin)
    wait(lambda: page.session is not session)
    page._orders.put(page._toggle)
    wait(lambda: page.playing and page.index >= 2)
    tab.goto("about:blank")
    time.sleep(1.0)
    stopped = len(page.session)
    time.sleep(1.0)
    assert len(page.session) == stopped
    tab.goto(served[2])
    wait(lambda: len(page.session) > stopped)


def test_a_recording_holds_every_frame(machine: Machine) -> None:
    session = Session(machine, 0, [0, 1])
    street = StreetMeshes(machine.env.bank, 0)
    still = len(html_recording(session, street))
    for _ in range(5):
        session.step()
    assert len(html_recording(session, street)) > still


@pytest.mark.extended
def test_play_writes_an_episode_as_a_page_that_needs_no_server(
    machine: Machine, tab: Any, tmp_path: pathlib.Path
) -> None:
    """All its frames; the episode is that of the number."""
    episodes = fixed_episodes(machine.env, 2, 0)
    path = tmp_path / "episode.html"
    _write_html(path, machine.env, "go_to_goal", machine.policy.agent, episodes, 1)
    session = Session(machine, int(episodes.scenes[1]), [int(episodes.episodes[1])], keys=episodes.keys()[1:])
    while not session.over:
        session.step()
    wanted = html_recording(session, StreetMeshes(machine.env.bank, session.scene))
    assert len(path.read_text(encoding="utf-8")) == pytest.approx(len(wanted), rel=1e-3)
    with_no_server = tab.context.browser.new_page(viewport={"width": 900, "height": 700})
    with_no_server.goto(path.as_uri())
    wait(lambda: bool(screenshot(with_no_server).std() > 20.0))
    with_no_server.close()


@pytest.mark.extended
def test_a_taken_port_is_refused() -> None:
    server = start_server("127.0.0.1", 0)
    try:
        with pytest.raises(ValidationError, match=f"--port: found {server.get_port()} on 127.0.0.1 taken"):
            start_server("127.0.0.1", server.get_port())
    finally:
        server.stop()
