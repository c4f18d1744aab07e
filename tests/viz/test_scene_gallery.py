"""The page of scenes: the folders it accepts, its text, and the images it draws again."""

import json
import pathlib

import pytest

from urbanverse_mjx.datatypes import BenchmarkReport, EpisodeResult, ValidationError
from urbanverse_mjx.scene.folders import scene_folders
from urbanverse_mjx.viz.scene_gallery import make_card, with_difficulty, write_page

STATISTICS = {
    "objects": 3,
    "houses": 1,
    "categories": {"bench": 2, "cafe": 1},
    "ground_area_m2": {"road": 100.0, "sidewalk": 50.5},
    "kerbs": {"length_m": 40.0, "height_m": 0.15},
    "spacing_m": {"p10": 1.0, "p50": 2.0, "p90": 3.0},
    "pavement": {
        "length_m": 20.0,
        "width_under": {"2": 0.1, "3": 0.5},
        "width_m": {"p10": 3.0, "p50": 4.0, "p90": 5.0},
        "clear_width_m": {"p10": 0.5, "p50": 2.25, "p90": 4.0},
        "narrower_than": {"robot": 0.125, "ada": 0.2, "prowag": 0.25},
    },
}


def _scene(folder: pathlib.Path, name: str, layout: str = "a") -> pathlib.Path:
    folder.mkdir(parents=True)
    body = {
        "schema": "urbanverse.compiled_scene/1",
        "id": name,
        "version": "1",
        "hashes": {"layout": layout},
        "city": "Cairo <Egypt>",
        "country": "Egypt",
        "source": "synthetic tour",
        "sky": "dusk",
        "route_length_m": 123.4,
        "counts": {"episodes": 512},
        "statistics": STATISTICS,
    }
    (folder / "metadata.json").write_text(json.dumps(body))
    return folder


def _draw(calls: list[str]):
    def draw(folder: pathlib.Path, out: pathlib.Path) -> dict[str, str]:
        calls.append(folder.name)
        out.mkdir(parents=True, exist_ok=True)
        (out / f"{folder.name}.jpg").write_bytes(b"picture")
        return {"above": f"{folder.name}.jpg"}

    return draw


def _episode(scene: str, result: str, agent: str = "planner") -> EpisodeResult:
    return EpisodeResult(agent, scene, 0, 0, result, 10, 2.0, 1.0, 0.0, 0.0, 10.0, 10.0, 0)


def test_scenes_are_found_in_folders_of_folders(tmp_path: pathlib.Path) -> None:
    for name in ("b", "a"):
        _scene(tmp_path / "set" / "scenes" / name, name)
    (tmp_path / "set" / "other").mkdir()
    (tmp_path / "set" / "other" / "metadata.json").write_text('{"schema": "something else"}')
    assert [f.name for f in scene_folders([tmp_path / "set"])] == ["a", "b"]
    assert [f.name for f in scene_folders([tmp_path / "set" / "scenes" / "b"])] == ["b"]
    with pytest.raises(ValidationError, match="no compiled scene"):
        scene_folders([tmp_path / "set" / "other"])
    _scene(tmp_path / "again", "a")
    with pytest.raises(ValidationError, match="another scene"):
        scene_folders([tmp_path])


def test_pictures_are_drawn_where_the_scene_changed(tmp_path: pathlib.Path) -> None:
    calls: list[str] = []
    folder = _scene(tmp_path / "a", "a")
    card = make_card(folder, tmp_path / "page", _draw(calls))
    assert card.images == {"above": "pictures/a.jpg"}
    assert make_card(folder, tmp_path / "page", _draw(calls)) == card
    assert calls == ["a"]
    (tmp_path / "page" / "pictures" / "a.jpg").unlink()
    make_card(folder, tmp_path / "page", _draw(calls))
    body = json.loads((folder / "metadata.json").read_text())
    (folder / "metadata.json").write_text(json.dumps({**body, "hashes": {"layout": "b"}}))
    make_card(folder, tmp_path / "page", _draw(calls))
    (tmp_path / "page" / "pictures" / "a.json").write_text("half a fi")
    make_card(folder, tmp_path / "page", _draw(calls))
    assert calls == ["a"] * 4


def test_the_page_tells_the_numbers_and_escapes_names(tmp_path: pathlib.Path) -> None:
    cards = [make_card(_scene(tmp_path / n, n), tmp_path / "page", _draw([])) for n in ("a", "b")]
    report = BenchmarkReport(
        "x", {}, (_episode("a", "goal"), _episode("a", "hit"), _episode("b", "goal", "zero")), {"k": 1}
    )
    cards = with_difficulty(cards, report)
    assert [c.difficulty for c in cards] == [0.5, None]
    text = write_page(cards, tmp_path / "page", "Sce<nes").read_text()
    assert "Sce&lt;nes" in text
    assert "Cairo &lt;Egypt&gt;" in text
    assert "<Egypt>" not in text
    assert text.count("<article") == 2
    for part in (
        "123 m",
        "12.5 %",
        "<dd>2.2 m</dd>",
        "40 m, 15 cm",
        "planner fails 50 %",
        "not driven",
        "2 bench, 1 cafe",
    ):
        assert part in text
    assert 'data-difficulty="0.5"' in text
    assert 'data-difficulty=""' in text
    assert 'src="pictures/a.jpg"' in text
    with pytest.raises(ValidationError, match="planner, zero"):
        with_difficulty(cards, report, "nobody")
