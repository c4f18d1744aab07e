"""The page of a study in a real browser: consent, order, sides, catch trials, videos, and the file of answers."""

import json
import pathlib
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from PIL import Image

from tests.support.browser import browser
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.study import Material, StudyPlan, analyse, plan_study, read_answers, write_page
from urbanverse_mjx.viz.video import write_video

COLOURS = {"u": (30, 90, 200), "p": (200, 60, 40), "s": (90, 90, 90)}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """A study of four pairs, two videos and a fidelity trial, with catch trials."""
    folder = tmp_path_factory.mktemp("study") / "streets"
    (folder / "media").mkdir(parents=True)
    names = {"urbanverse": "u", "procedural": "p"}
    rows = {g: [Material(f"{g}_{k}", g, f"{n}{k}.jpg") for k in range(4)] for g, n in names.items()}
    videos = [Material(f"{g}_9", g, f"{n}9.mp4") for g, n in names.items()]
    plans = [(Material("source", "source", "s0.jpg"), Material("urbanverse_0", "urbanverse", "u0.jpg"))]
    plan = plan_study(rows, videos, plans, pairs=4, catches=1)
    for name in plan.key:
        path, colour = folder / "media" / name, COLOURS[name[0]]
        if name.endswith(".jpg"):
            Image.new("RGB", (160, 100), colour).save(path)
        else:
            write_video(path, [np.full((64, 96, 3), colour, np.uint8)] * 4, 10.0)
    write_page(plan, folder, "Streets <b>&", "You </script> agree.", "Ask me.")
    return folder


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    with browser() as found:
        yield found


def plan_of(folder: pathlib.Path) -> StudyPlan:
    return StudyPlan.from_json(v.read_json(folder.parent / "streets-key.json", "key"), "key")


def opened(chromium: Any, folder: pathlib.Path, participant: str) -> Any:
    tab = chromium.new_context(accept_downloads=True, viewport={"width": 1100, "height": 760}).new_page()
    tab.set_default_timeout(60_000)
    tab.errors = []
    tab.on("pageerror", lambda error: tab.errors.append(str(error)))
    tab.goto((folder / "index.html").as_uri() + f"?participant={participant}")
    return tab


def finished(tab: Any, out: pathlib.Path) -> tuple[list[str], dict[str, list[str]]]:
    """Answers every trial: the blue street is better, blue videos are 4 and others 2. Returns the order of trials, and
    the files of each from left to right."""
    tab.get_by_label("I have read this").check()
    tab.get_by_role("button", name="Start").click()
    order, files = [], {}
    while tab.locator("#trial").is_visible():
        trial = tab.evaluate("document.body.dataset.trial")
        order.append(trial)
        shown = tab.evaluate(
            "[...document.querySelectorAll('#media img, #media video')].map((m) => m.getAttribute('src'))"
        )
        files[trial] = [name.removeprefix("media/") for name in shown]
        blue = [name.startswith("u") for name in files[trial]]
        if trial.startswith("pair"):
            answer = "equal" if blue[0] == blue[1] else "A is better" if blue[0] else "B is better"
        else:
            asked = tab.locator("#catch")
            answer = "2" if asked.is_visible() else "4" if blue[-1] else "2"
            assert asked.is_visible() == ("catch" in trial)
        for group in tab.locator("fieldset").all():
            assert tab.get_by_role("button", name="Next").is_disabled()
            group.get_by_label(answer, exact=True).check()
        if trial.startswith("rating"):
            # The button waits for the end of the video.
            tab.wait_for_function("!document.getElementById('next').disabled")
            assert tab.locator("video").first.evaluate("(m) => m.ended || Boolean(m.error)")
        tab.get_by_role("button", name="Next").click()
    with tab.expect_download() as download:
        tab.get_by_role("button", name="Save my answers").click()
    download.value.save_as(out)
    assert tab.errors == []
    return order, files


@pytest.mark.extended
def test_answers_of_two_participants_are_read_and_analysed(
    chromium: Any, folder: pathlib.Path, tmp_path: pathlib.Path
) -> None:
    plan = plan_of(folder)
    seen = {}
    for name in ("one", "two"):
        seen[name] = finished(opened(chromium, folder, name), tmp_path / f"{name}.csv")
    orders = [order for order, _ in seen.values()]
    assert all(sorted(order) == sorted(t.id for t in plan.trials) for order in orders)
    assert orders[0] != orders[1]
    answers = read_answers([tmp_path / "one.csv", tmp_path / "two.csv"], plan)
    assert len(answers) == 2 * (5 * 3 + 3 * 4 + 1)
    for a in answers:
        assert [f for f in (a.first, a.second) if f] == seen[a.participant][1][a.trial]
    found = analyse(answers, plan)
    assert found["excluded"] == {}
    assert found["pairs"]["overall_realism"]["shares"]["urbanverse"]["mean"] == 100.0
    rated = found["ratings"]["layout_realism"]["groups"]
    assert (rated["urbanverse"]["mean"], rated["procedural"]["mean"]) == (4.0, 2.0)
    assert found["fidelity"]["layout_fidelity"]["groups"]["urbanverse"]["mean"] == 4.0


@pytest.mark.extended
def test_a_participant_sees_the_same_order_again_and_sides_are_drawn(chromium: Any, folder: pathlib.Path) -> None:
    shown = {}
    for name in ("a", "a", *"bcdefgh"):
        tab = opened(chromium, folder, name)
        rows = tab.evaluate("[order.map((t) => t.id), shown]")
        assert shown.setdefault(name, rows) == rows
        tab.context.close()
    left = [files[0][0] for rows in shown.values() for files in zip(rows[1], strict=True) if len(files[0]) == 2]
    blue = [name.startswith("u") for name in left if name[0] in "up"]
    # 8 participants with 4 pairs: each side is drawn; the plan is always on the left.
    assert 0.2 < np.mean(blue) < 0.95
    assert left.count("s0.jpg") == len(shown)


def test_nothing_starts_without_consent_and_texts_are_shown_as_they_are(chromium: Any, folder: pathlib.Path) -> None:
    tab = opened(chromium, folder, "x")
    assert tab.get_by_role("button", name="Start").is_disabled()
    assert tab.locator("h1").first.inner_text() == "Streets <b>&"
    assert tab.locator("#consent").inner_text() == "You </script> agree."
    assert tab.locator("#contact").inner_text() == "Ask me."
    assert tab.errors == []


def test_the_page_does_not_tell_what_it_shows(folder: pathlib.Path) -> None:
    text = (folder / "index.html").read_text(encoding="utf-8")
    assert "procedural" not in text
    assert not any(row["scene"] in text for row in plan_of(folder).key.values())
    body = json.loads(text.split('type="application/json">')[1].split("</script>")[0].replace("<\\/", "</"))
    assert {t["id"] for t in body["trials"]} == {t.id for t in plan_of(folder).trials}


@pytest.mark.extended
def test_a_missing_image_is_named(folder: pathlib.Path, tmp_path: pathlib.Path) -> None:
    with pytest.raises(ValidationError, match=r"no file p0\.jpg"):
        write_page(plan_of(folder), tmp_path / "empty")
