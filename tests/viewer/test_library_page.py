"""The library's page in a real browser: tabs, search, assets that turn, and scenes that open."""

import io
import json
import time
import urllib.error
import urllib.request
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import pytest
from PIL import Image

from tests.support.browser import browser
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.pipeline.view_library import ViewLibrary, three_js
from urbanverse_mjx.viewer.front import Front
from urbanverse_mjx.viewer.gltf import Part, Surface, glb
from urbanverse_mjx.viewer.teleop import Teleop

CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
FACES = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4]]
    + [[1, 5, 7], [1, 7, 3]]
)
COLOURS = {"red": (0.8, 0.02, 0.02, 1.0), "blue": (0.02, 0.05, 0.8, 1.0)}


class Shelf:
    """A library of two boxes, twice as long as wide, and 26 in all."""

    def __init__(self) -> None:
        self.asked: list[tuple[str, dict[str, str]]] = []

    def answer(self, path: str, query: Mapping[str, str]) -> tuple[str, bytes]:
        self.asked.append((path, dict(query)))
        if path == "":
            return ViewLibrary(None, print).answer("", {})  # type: ignore[arg-type]
        if path == "three.js":
            return "text/javascript", three_js()
        if path == "mesh":
            size = CORNERS * [4.0, 1.0, 2.0]
            return "model/gltf-binary", glb([Part(size, FACES, Surface(COLOURS[query["uid"].split("/")[0]]))])
        if path in ("scene", "look"):
            file = io.BytesIO()
            Image.new("RGB", (64, 40), (20, 160, 60)).save(file, "JPEG")
            return "image/jpeg", file.getvalue()
        return "application/json", json.dumps(getattr(self, f"_{path}")(query)).encode()

    def _scenes(self, _: Mapping[str, str]) -> Any:
        return [{"name": "park", "cousins": 64}, {"name": "<b>alley</b>", "cousins": 1}]

    def _open(self, query: Mapping[str, str]) -> Any:
        return {"opening": query["scene"]}

    def _words(self, _: Mapping[str, str]) -> Any:
        return {"class": ["furniture"], "material": ["oak"], "colour": ["red", "blue"]}

    def _looks(self, _: Mapping[str, str]) -> Any:
        return [{"uid": "dawn", "description": "a pale dawn"}]

    def _assets(self, query: Mapping[str, str]) -> Any:
        if query.get("query") == "zork":
            raise ValidationError("label: found 'zork', needed a word.")
        names = [query["colour"]] if "colour" in query else [*COLOURS]
        start = int(query["start"])
        uids = [f"{name}/{k}" for k in range(13) for name in names][start : start + 24]
        fields = {"made of": "oak", "movable": "yes"}
        rows = [
            {"uid": uid, "class": "box", "description": uid, "size": [4.0, 1.0, 2.0], "mass": 3.0, "fields": fields}
            for uid in uids
        ]
        return {"count": 13 * len(names), "of": 26, "best": "query" in query, "rows": rows}


@pytest.fixture(scope="module")
def shelf() -> Shelf:
    return Shelf()


@pytest.fixture(scope="module")
def served(shelf: Shelf) -> Iterator[tuple[Any, str]]:
    """A browser's tab and the page's address."""
    front = Front("127.0.0.1", 0, 1, Teleop())
    front.library = shelf.answer
    try:
        with browser() as chromium:
            tab = chromium.new_page(viewport={"width": 900, "height": 700})
            tab.set_default_timeout(60_000)
            errors: list[str] = []
            tab.on("pageerror", lambda error: errors.append(str(error)))
            yield tab, f"{front.address}/library"
            assert errors == []
    finally:
        front.stop()


@pytest.fixture
def tab(served: tuple[Any, str]) -> Any:
    """The tab with the page opened anew, whatever another test did in it."""
    tab, address = served
    tab.goto(address)
    return tab


def loaded(tab: Any, count: int) -> None:
    tab.wait_for_function(f"Number(document.body.dataset.loaded) === {count}")


def shown(tab: Any, card: int = 0) -> np.ndarray:
    """(H, W, 3) of a card's asset, after another frame."""
    drawn = "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"
    tab.evaluate(drawn)
    box = tab.locator(".turn").nth(card).bounding_box()
    image = tab.screenshot(clip=box, timeout=120_000)
    return np.asarray(Image.open(io.BytesIO(image)).convert("RGB")).astype(int)


def width_of(image: np.ndarray) -> int:
    """px, of what is not the page's ground."""
    columns = np.flatnonzero((np.ptp(image, axis=2) > 60).any(0))
    return int(np.ptp(columns))


@pytest.mark.extended
def test_scenes_have_images_and_names_as_text(tab: Any) -> None:
    tab.wait_for_function("[...document.images].filter((x) => x.naturalWidth === 64).length === 2")
    assert tab.locator("h2").all_text_contents() == ["park", "<b>alley</b>"]
    assert tab.locator("#find").is_hidden()


@pytest.mark.extended
def test_a_page_that_was_opened_before_there_is_a_library_leads_to_it(tab: Any, shelf: Shelf) -> None:
    front = Front("127.0.0.1", 0, 1, Teleop())
    try:
        tab.goto(front.address)
        tab.get_by_text("loading").wait_for()
        link = tab.get_by_role("link", name="Library")
        time.sleep(0.5)  # states have come
        assert not link.is_visible()
        with pytest.raises(urllib.error.HTTPError, match="404"):
            urllib.request.urlopen(f"{front.address}/library")
        front.library = shelf.answer
        link.click()
        tab.wait_for_url("**/library")
        tab.get_by_text("2 scenes.").wait_for()
    finally:
        tab.goto("about:blank")
        front.stop()


def test_a_page_that_waits_says_so(tab: Any) -> None:
    """In place of what it said of the tab before."""
    tab.get_by_text("2 scenes.").wait_for()
    answers: list[Any] = []
    tab.route("**/library/looks**", lambda route: answers.append(route))
    tab.click("nav >> text=Grounds")
    tab.wait_for_function("document.getElementById('said').textContent === 'Loading …'")
    while not answers:
        tab.wait_for_timeout(50)
    answers[0].continue_()
    tab.get_by_text("1 grounds.").wait_for()
    tab.unroute("**/library/looks**")


@pytest.mark.extended
def test_assets_turn_and_are_turned_by_hand(tab: Any) -> None:
    tab.click("nav >> text=Assets")
    loaded(tab, 24)
    assert "One of each of 26 kinds" in tab.text_content("#said")
    red, blue = shown(tab, 0), shown(tab, 1)
    middle = np.s_[80:100, 80:100]
    assert (red[middle].mean((0, 1)).argmax(), blue[middle].mean((0, 1)).argmax()) == (0, 2)
    before = tab.evaluate("items[0].yaw")
    tab.wait_for_function(f"items[0].yaw > {before} + 0.05")
    box = tab.locator(".turn").first.bounding_box()
    tab.mouse.move(box["x"] + 20, box["y"] + 60)
    tab.mouse.down()
    held = tab.evaluate("items[0].yaw")
    tab.mouse.move(box["x"] + 120, box["y"] + 60)
    tab.mouse.up()
    assert tab.evaluate("items[0].yaw") == pytest.approx(held + 1.0, abs=0.02)
    # Across the view its long side is seen, along it the narrow one.
    tab.evaluate("items[0].yaw = 0")
    long = width_of(shown(tab))
    tab.evaluate("items[0].yaw = Math.PI / 2")
    assert width_of(shown(tab)) < 0.6 * long
    assert tab.evaluate("items[0].yaw") == pytest.approx(np.pi / 2)  # it turns no more by itself


@pytest.mark.extended
def test_the_search_asks_for_what_is_chosen(tab: Any, shelf: Shelf) -> None:
    tab.click("nav >> text=Assets")
    loaded(tab, 24)
    tab.fill("#query", "a crate")
    tab.select_option("#colour", "blue")
    tab.fill("#low", "0.5")
    tab.click("text=Search")
    loaded(tab, 13)
    assert shelf.asked[-14][1] == {"start": "0", "query": "a crate", "colour": "blue", "low": "0.5"}
    assert "The nearest 13 of 26 assets" in tab.text_content("#said")
    assert tab.locator("#more").is_hidden()
    tab.locator("h2").first.click()
    assert tab.locator("article.large td").all_text_contents() == ["made of", "oak", "movable", "yes"]
    tab.fill("#query", "zork")
    tab.click("text=Search")
    tab.get_by_text("label: found 'zork', needed a word.").wait_for()
    tab.fill("#query", "")
    tab.fill("#low", "")
    tab.select_option("#colour", "")
    tab.click("text=Search")
    loaded(tab, 24)
    tab.click("#more")
    loaded(tab, 26)
    assert tab.locator("#more").is_hidden()


def test_skies_and_grounds_are_images(tab: Any, shelf: Shelf) -> None:
    tab.click("nav >> text=Skies")
    tab.get_by_text("a pale dawn").wait_for()
    assert ("looks", {"kind": "sky"}) in shelf.asked
    tab.click("nav >> text=Grounds")
    # The answer for the kind that is chosen at first says the same.
    with tab.expect_response(lambda response: "kind=road" in response.url):
        tab.select_option("#kind", "road")
    tab.wait_for_function("document.querySelector('#said').textContent === '1 grounds.'")
    assert ("looks", {"kind": "road"}) in shelf.asked


@pytest.mark.extended
def test_a_scene_opens_in_the_viewer(tab: Any, shelf: Shelf) -> None:
    tab.click("nav >> text=Scenes")
    tab.locator("article", has_text="park").get_by_role("button", name="Open").click()
    tab.wait_for_function("location.pathname === '/'")
    assert shelf.asked[-1] == ("open", {"scene": "park"})
    assert tab.locator("footer a").get_attribute("href") == "library"
