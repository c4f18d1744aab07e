"""The page of an episode in a real browser: every control does what it says, and pixels are those of the frame."""

import dataclasses
import json
import pathlib
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from tests.support.browser import browser
from tests.support.recorded import DEPTH, FEATURES, FRONT, HEIGHT, RATE, WIDTH, episode, level, write_dataset
from urbanverse_mjx.cli import main as cli
from urbanverse_mjx.datasets import DatasetWriter, Feature, dataset_page
from urbanverse_mjx.datasets.annotations import Annotation, SeenObject
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.geometry import rotations

LENGTHS = (4, 6)
SEEN = SeenObject(
    3,
    "b",
    "bin </script>",
    (4, 5, 20, 25),
    9,
    1.0,
    (1.0, 1.0, 1.0),
    (4.0, 1.0, 0.5),
    (1.0, 0, 0, 0),
    (0.0, 0, 4.0),
    (1.0, 0, 0, 0),
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """Two episodes in one file, with poses along a bend and an object in every frame of the second."""
    path = tmp_path_factory.mktemp("page") / "demos"
    features = {**FEATURES, "pose": Feature("float32", (7,)), "observation.environment_state": Feature("float32", (2,))}
    with DatasetWriter(path, features, RATE, "box", {}) as writer:
        for number, length in enumerate(LENGTHS):
            plain, yaw = episode(number, length), np.linspace(0.0, 1.0, length)
            position = np.column_stack([np.sin(yaw), 1 - np.cos(yaw), np.zeros(length)])
            more = {
                "pose": np.column_stack([position, rotations.from_yaw(yaw)]),
                "observation.environment_state": np.tile([2.0, 1.0], (length, 1)),
            }
            seen = [Annotation(f"caption {k}", (SEEN,)) for k in range(length)]
            writer.add(dataclasses.replace(plain, columns={**plain.columns, **more}, annotations=seen))
    return path


def data_of(page: str) -> dict[str, Any]:
    return json.loads(page.partition('type="application/json">')[2].partition("</script>")[0])


def test_the_page_holds_the_rows_of_its_episode(folder: pathlib.Path) -> None:
    body = data_of(dataset_page(folder, 1))
    assert (body["length"], body["rate"], body["height"], body["width"]) == (6, RATE, HEIGHT, WIDTH)
    assert set(body["images"]) == {FRONT, DEPTH}
    assert all(len(images) == 6 for images in body["images"].values())
    np.testing.assert_allclose(body["numbers"]["action"], episode(1, 6).columns["action"], atol=1e-4)
    assert body["captions"] == [f"caption {k}" for k in range(6)]
    assert body["objects"][0][0] == {"box": [4, 5, 20, 25], "category": "bin </script>", "place": [4.0, 1.0]}
    x, y, yaw = body["path"][3]
    np.testing.assert_allclose([x, y], [np.sin(yaw), 1 - np.cos(yaw)], atol=1e-3)
    c, s = np.cos(yaw), np.sin(yaw)
    np.testing.assert_allclose(body["goal"][3], [x + 2 * c - s, y + 2 * s + c], atol=2e-3)
    with pytest.raises(ValidationError, match="--episode: found 2, needed 0 to 1"):
        dataset_page(folder, 2)


def test_numbers_that_a_page_cannot_hold_are_one_sentence(tmp_path: pathlib.Path) -> None:
    (path,) = (write_dataset(tmp_path / "new", 1) / "data").glob("*/*.parquet")
    table = pq.read_table(path)
    at = table.column_names.index("next.reward")
    pq.write_table(table.set_column(at, table.field(at), pa.array([np.nan] * len(table), pa.float32())), path)
    with pytest.raises(ValidationError, match="reward: found a number that is not finite"):
        dataset_page(tmp_path / "new")


@pytest.mark.extended
def test_every_control_works_in_a_browser(
    folder: pathlib.Path, tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "page.html"
    assert cli.main(["dataset", "view", str(folder), "--episode", "1", "--out", str(out), "--no-open"]) == 0
    assert json.loads(capsys.readouterr().out) == {"page": str(out)}
    with browser() as chromium:
        page = chromium.new_page()
        errors: list[str] = []
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.goto(out.as_uri())
        _shows(page, 0)
        assert page.text_content("#caption") == "caption 0"
        assert _pixel(page, WIDTH * 2 - 6, HEIGHT * 2 - 6) == pytest.approx([level(1, 0)] * 3, abs=8)
        _drag(page, 5)
        assert "frame 5 of 6, 1.0 s" in page.text_content("#clock")
        assert _pixel(page, WIDTH * 2 - 6, HEIGHT * 2 - 6) == pytest.approx([level(1, 5)] * 3, abs=8)
        page.keyboard.press("Tab")
        page.locator("body").press("ArrowLeft")
        _shows(page, 4)
        red, green, blue = _pixel(page, 8, 30)
        assert green > 150 > max(red, blue)
        page.uncheck("#boxes")
        page.wait_for_function(
            "document.getElementById('frame').getContext('2d').getImageData(8, 30, 1, 1).data[0] > 30"
        )
        page.select_option("#image", DEPTH)
        page.wait_for_function(
            "(() => { const d = document.getElementById('frame').getContext('2d').getImageData(60, 30, 1, 1).data;"
            "return Math.max(d[0], d[1], d[2]) - Math.min(d[0], d[1], d[2]) > 60; })()"
        )
        page.click("#play")
        page.wait_for_function("document.body.dataset.step === '1'")
        page.click("#play")
        assert page.text_content("#play") == "Play"
        assert page.locator("#numbers tr").count() == len(data_of(out.read_text())["numbers"])
        assert page.locator("#bars i").count() == 2
        assert errors == []


def _shows(page: Any, step: int) -> None:
    page.wait_for_function(f"document.body.dataset.step === '{step}'")


def _drag(page: Any, step: int) -> None:
    page.eval_on_selector("#slider", f"x => {{ x.value = {step}; x.dispatchEvent(new Event('input')); }}")
    _shows(page, step)


def _pixel(page: Any, x: int, y: int) -> list[int]:
    code = (
        f"Array.from(document.getElementById('frame').getContext('2d').getImageData({x}, {y}, 1, 1).data).slice(0, 3)"
    )
    return page.evaluate(code)
