"""Driving by hand in a real browser: keys, a gamepad, and a browser that falls silent or leaves."""

import io
import json
import pathlib
import threading
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from PIL import Image
from websockets.sync.client import connect

from tests.support.box_machine import box_machine
from tests.support.driven_page import DrivenPage, driven_page, speeds, wait
from urbanverse_mjx.datatypes import SceneBank

pytestmark = pytest.mark.slow
#: A gamepad as the browser's interface describes it; `window.pad` is set by the test.
_GAMEPAD = """
window.pad = null;
const button = (pressed) => ({pressed, touched: pressed, value: +pressed});
const gamepad = () => ({
  id: "Pad (STANDARD)", index: 1, connected: true, mapping: "standard", timestamp: performance.now(),
  axes: window.pad.axes, buttons: window.pad.buttons.map(button),
});
navigator.getGamepads = () => [null, window.pad && gamepad()];
"""


@pytest.fixture(scope="module")
def driven(small_bank: SceneBank) -> Iterator[DrivenPage]:
    """A page with a gamepad that is simulated."""
    with driven_page(box_machine(small_bank), 1.5, _GAMEPAD, (1200, 800)) as found:
        yield found


@pytest.fixture(autouse=True)
def begun_again(driven: DrivenPage) -> None:
    page, tab = driven[0], driven[3]
    before = page.session
    tab.frame_locator("#viser").get_by_role("button", name="Begin again").click()
    wait(lambda: page.session is not before)
    begun = threading.Event()
    page._orders.put(begun.set)
    wait(begun.is_set)


#: The page before the first step, each pixel the mean of 4 x 4 of the browser's.
STORED = pathlib.Path(__file__).with_name("view_page.png")
_BLOCK = 4
#: Share of pixels that may be other than in the stored image: borders around keys in another font, and smoothing.
_MAX_OTHER = 0.005


def screenshot(tab: Any) -> np.ndarray:
    """(200, 300, 3) of the page, without what viser says of the browser, nor a button that the mouse points at.

    Letters are transparent: another machine's fonts break lines elsewhere.
    """
    tab.mouse.move(400, 790)
    inner = next(frame for frame in tab.frames if "/viser" in frame.url)
    inner.add_style_tag(content=".mantine-Notifications-root { display: none !important; }")
    for frame in (tab.main_frame, inner):
        frame.add_style_tag(content="* { color: transparent !important; }")
    whole = Image.open(io.BytesIO(tab.screenshot(timeout=120_000))).convert("RGB")
    return np.asarray(whole.reduce(_BLOCK)).astype(int)


def other(image: np.ndarray, stored: np.ndarray) -> float:
    """Share of the pixels whose colour differs by more than a tenth of the range."""
    return float((np.abs(image - stored).max(-1) > 25).mean())


def test_the_page_looks_as_it_was_stored(driven: DrivenPage, tmp_path: pathlib.Path) -> None:
    """Where it is meant to look otherwise, the image that the failure names replaces the stored one."""
    page, _, _, tab = driven
    stored = np.asarray(Image.open(STORED).convert("RGB")).astype(int)
    end, image = time.monotonic() + 60.0, screenshot(tab)
    while other(image, stored) > _MAX_OTHER and time.monotonic() < end:  # until the street is drawn
        image = screenshot(tab)
    found = tmp_path / STORED.name
    Image.fromarray(image.astype(np.uint8)).save(found)
    share = other(image, stored)
    assert share <= _MAX_OTHER, f"{100 * share:.1f} % of the pixels are others; look at {found}"
    # A robot that is missing is more than that.
    for body in page.stage._robots[0].bodies.values():
        body.visible = False
    wait(lambda: other(screenshot(tab), stored) > 1.5 * _MAX_OTHER)


def test_keys_take_over_drive_stop_and_give_back(driven: DrivenPage) -> None:
    page, teleop, _, tab = driven
    tab.frame_locator("#viser").get_by_role("button", name="Play").click()
    wait(lambda: len(page.session) > 3)
    assert not page.session.by_hand(3).any()
    # The focus is in viser's frame since the click.
    tab.keyboard.down("w")
    tab.keyboard.down("a")
    wait(lambda: page.session.frames[-1].by_hand[0] and abs(speeds(page)[-1, 1] - 1.0) < 1e-3)
    assert speeds(page)[-1, 0] == pytest.approx(2.0, abs=0.02)
    tab.get_by_text("you drive").wait_for(timeout=60_000)
    tab.keyboard.up("a")
    tab.keyboard.up("w")
    wait(lambda: bool(speeds(page)[-1, 0] < 1e-6))
    assert page.session.frames[-1].by_hand[0]
    wait(lambda: not page.session.frames[-1].by_hand[0])
    assert not teleop.held
    tab.get_by_text("go_to_goal drives").wait_for(timeout=60_000)
    tab.keyboard.press("t")
    wait(lambda: bool(page.session.frames[-1].by_hand[0]))
    assert speeds(page)[-1, 0] < 1e-6
    tab.keyboard.press("t")
    wait(lambda: not page.session.frames[-1].by_hand[0])
    wait(lambda: page.state["interventions"] == 2)
    by_hand = page.session.by_hand(len(page.session) - 1)
    assert page.state["seconds"] == pytest.approx(by_hand.sum() * 0.2, abs=0.21)
    latency = teleop.latency
    assert latency is not None
    # A control step and its computation; from the browser's clock to this one's.
    assert 0.0 < latency < 5.0
    tab.get_by_text("2 interventions").wait_for(timeout=60_000)


def test_a_key_that_was_forgotten_with_the_focus_drives_when_it_repeats(
    driven: DrivenPage,
) -> None:
    page, teleop, _, tab = driven
    tab.keyboard.down("w")
    wait(lambda: teleop.held and len(page.session) > 2)
    tab.evaluate("document.hasFocus = () => false; window.dispatchEvent(new Event('blur'))")
    wait(lambda: not teleop.held)
    tab.evaluate("delete document.hasFocus")
    tab.keyboard.down("w")  # it is still held: the browser reports a repetition
    wait(lambda: teleop.held)
    tab.keyboard.up("w")


def test_it_is_shown_and_driven_in_a_frame_of_another_page_as_in_a_notebook(driven: DrivenPage) -> None:
    """`IPython.display.IFrame` writes such a frame into a page of another origin."""
    page, teleop, front, tab = driven
    steps = len(page.session)
    address = front.address.replace("127.0.0.1", "localhost")
    other_page = tab.context.browser.new_page()
    try:
        other_page.set_content(f'<h1>a notebook</h1><iframe width="900" height="600" src="{address}"></iframe>')
        frame = other_page.frame_locator("iframe").first
        frame.frame_locator("#viser").get_by_role("button", name="Play").wait_for(timeout=120_000)
        frame.locator("#bar").click()
        other_page.keyboard.down("w")
        wait(lambda: teleop.held and len(page.session) > steps + 2)
        frame.get_by_text("you drive").wait_for(timeout=60_000)
        other_page.keyboard.up("w")
        wait(lambda: not teleop.held)
    finally:
        other_page.close()


def test_letters_in_a_text_field_are_letters(driven: DrivenPage) -> None:
    teleop, tab = driven[1], driven[3]
    frame = tab.frame_locator("#viser")
    field = frame.locator("label", has_text="or a file").locator("xpath=ancestor::div[.//input][1]//input")
    field.click()
    tab.keyboard.type("wasd")
    assert field.input_value() == "wasd"
    time.sleep(0.5)
    assert not teleop.held
    field.fill("")
    field.press("Tab")


def test_keys_drive_after_a_click_on_a_checkbox_or_a_choice_from_a_list(driven: DrivenPage) -> None:
    """Both keep the focus and take no letters; an open list takes them for its search."""
    page, teleop, _, tab = driven
    frame = tab.frame_locator("#viser")
    view = frame.get_by_role("combobox", name="view", exact=True)

    def drives(key: str) -> None:
        tab.keyboard.down(key)
        wait(lambda: teleop.held)
        tab.keyboard.up(key)
        wait(lambda: not teleop.held)

    for shown in (True, False):
        frame.get_by_label("hulls", exact=True).click()
        wait(lambda shown=shown: page._layers["hulls"].value is shown)
        drives("w")
    for name in ("from above", "behind the robot"):
        view.click()
        frame.get_by_role("option", name=name, exact=True).wait_for(timeout=60_000)
        tab.keyboard.press("w")
        time.sleep(0.5)
        assert not teleop.held
        view.fill(name)
        frame.get_by_role("option", name=name, exact=True).click()
        wait(lambda name=name: page._view.value == name)
        frame.get_by_role("option").first.wait_for(state="hidden", timeout=60_000)
        drives("w")
        assert view.input_value() == name
    # An arrow opens the list.
    tab.keyboard.press("ArrowDown")
    frame.get_by_role("option", name="free", exact=True).wait_for(timeout=60_000)
    assert not teleop.held
    tab.keyboard.press("Escape")


def test_a_gamepad_takes_over_by_its_button_and_drives_by_its_stick(driven: DrivenPage) -> None:
    page, teleop, _, tab = driven

    def hold(x: float, y: float, button: bool = False) -> None:
        tab.evaluate("pad => { window.pad = pad; }", {"axes": [x, y, 0, 0], "buttons": [button, False]})

    hold(0.0, -1.0)
    tab.get_by_text("Pad: left stick drives").wait_for(timeout=60_000)
    time.sleep(0.3)
    assert not teleop.held
    hold(0.0, -1.0, button=True)
    wait(lambda: len(page.session) > 1 and bool(speeds(page)[-1, 0] > 1.9))
    hold(0.6, -0.05)
    wait(lambda: bool(speeds(page)[-1, 1] < -0.1))
    # To the right, at the share beyond the dead zone; the drift ahead is within it.
    assert speeds(page)[-1] == pytest.approx([0.0, -(0.6 - 0.15) / 0.85], abs=0.03)
    hold(0.0, 0.0, button=True)
    wait(lambda: not teleop.held)
    hold(0.0, 0.0)
    tab.evaluate("window.pad = null")


def test_a_browser_that_falls_silent_stops_the_robot(driven: DrivenPage) -> None:
    """Its connection stays open; the tab that shows the page drives nothing."""
    page, teleop, front, _ = driven
    held = json.dumps({"keys": ["KeyW"], "axes": [], "buttons": []})
    with connect(front.address.replace("http", "ws") + "/drive", proxy=None) as socket:
        wait(lambda: socket.send(held) is None and len(page.session) >= 4, 30.0)
        last, driven_steps = time.monotonic(), len(page.session)
        wait(lambda: bool(speeds(page)[-1, 0] < 1e-6))
        # A step of 0.2 s that has begun ends, and another may begin within 0.1 s.
        assert (speeds(page)[driven_steps - 1 :, 0] > 1e-6).sum() <= 2
        assert teleop.held
        wait(lambda: not teleop.held)
        assert time.monotonic() - last > 1.4


def test_a_browser_that_leaves_stops_the_robot_and_the_drive_goes_on_when_it_is_back(
    driven: DrivenPage,
) -> None:
    page, teleop, front, tab = driven
    tab.keyboard.down("ArrowUp")
    wait(lambda: len(page.session) > 3)
    tab.goto("about:blank")
    before = len(page.session)
    wait(lambda: not teleop.held)
    steps = len(page.session)
    assert (speeds(page)[before - 1 :, 0] > 1e-6).sum() <= 2
    time.sleep(1.0)
    assert len(page.session) == steps
    tab.goto(front.address)
    tab.frame_locator("#viser").get_by_role("button", name="Begin again").wait_for(timeout=120_000)
    tab.keyboard.down("ArrowUp")
    wait(lambda: len(page.session) > steps)
    tab.keyboard.up("ArrowUp")
