"""benchmarks.blind_judge: what is shown to the judge, what is kept from the judge, and how answers are counted."""

import dataclasses
import functools
import json
import math
import pathlib
import types
from typing import Any

import numpy as np
import pytest
from PIL import Image

from benchmarks import blind_judge as b
from tests.support.box_bank import street_regions
from tests.support.toy_assets import toy_layout
from urbanverse_mjx.assets.appearances import skies
from urbanverse_mjx.datatypes import SceneGraph, Source, ValidationError
from urbanverse_mjx.datatypes.validation import write_json
from urbanverse_mjx.evaluation.metrics import wilson_interval

CITIES = {f"Town_{k:02d}_walk_01": (f"Städt {chr(97 + k)}", "Land") for k in range(9)}
#: Trajectory of every layout: x, y, z, yaw.
PATH = np.array([(0.5 * k, 6.0, 1.4, 0.0) for k in range(100)])
KEY = {
    "street_01.png": {"city": "São Paulo", "country": "Brazil"},
    "street_02.png": {"city": "Kyoto", "country": "Japan"},
    "street_03.png": {"city": "Tokyo", "country": "Japan"},
}


def test_right_wrong_and_missing_answers_are_counted() -> None:
    found = b.compared({"street_01.png": "SaoPaulo (Brazil)", "street_02.png": "Tokyo"}, KEY)
    assert (found["right"], found["of"]) == (1, 3)
    assert found["interval"] == [round(x, 3) for x in wilson_interval(1, 3)]
    assert found["confused"] == [["Kyoto (Japan)", "Tokyo (Japan)"]]
    assert (found["unanswered"], found["repeated"]) == (["street_03.png"], [])


def test_all_right_and_the_interval_of_32_of_32() -> None:
    key = {f"street_{k:02d}.png": {"city": f"city {k}", "country": "x"} for k in range(32)}
    found = b.compared({file: row["city"].upper() for file, row in key.items()}, key)
    # With all right, Wilson's lower limit is n / (n + z²).
    assert (found["right"], found["interval"]) == (32, [round(32 / (32 + 1.959964**2), 3), 1.0])
    assert found["confused"] == found["unanswered"] == found["repeated"] == []


def test_a_city_named_twice_is_right_once_and_is_reported() -> None:
    found = b.compared(dict.fromkeys(KEY, "kyoto"), KEY)
    assert (found["right"], found["repeated"]) == (1, ["Kyoto (Japan)"])
    assert found["confused"] == [["São Paulo (Brazil)", "Kyoto (Japan)"], ["Tokyo (Japan)", "Kyoto (Japan)"]]


@pytest.mark.parametrize(
    ("answers", "said"),
    [
        ({"street_09.png": "Kyoto"}, "street_09.png"),
        ({"street_01.png": "Atlantis"}, "'Atlantis', needed one of the 3 cities"),
        ({"street_01.png": 7}, "street_01.png: found 7"),
    ],
)
def test_an_answer_that_the_key_does_not_know_is_refused(answers: dict[str, Any], said: str) -> None:
    with pytest.raises(ValidationError, match=said):
        b.compared(answers, KEY)


@pytest.fixture
def small_set(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> pathlib.Path:
    """A built set of nine layouts with two cousins, of which the second has the brighter sky in every other layout; its
    renderer paints the number of the scene, and finds a good view only at the last candidate."""
    monkeypatch.setenv("URBANVERSE_SCENE_ROOT", str(tmp_path / "scenes"))
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path / "cache"))
    write_json(tmp_path / "scenes" / "library.json", {"towns": {"cousins": 2, "split": "train", "seed": 0}})
    for number, (name, place) in enumerate(CITIES.items()):
        source = Source("hand", "Apache-2.0", "none", "none")
        graph = SceneGraph(name, source, (), tuple(street_regions()), camera_path=tuple(map(tuple, PATH.tolist())))
        graph.save(tmp_path / "scenes" / "towns" / name / "graph.json.gz")
        for cousin in range(2):
            sky = "clear_noon" if cousin == number % 2 else "overcast_grey"
            scene = f"{name}_Cousin_{cousin + 1:02d}"
            layout = dataclasses.replace(toy_layout(graph), id=scene, sky=sky, place=place)
            layout.save(tmp_path / "cache" / "library" / "towns" / "scenes" / scene / "layout.json")
    monkeypatch.setattr(b, "pack_bank", _bank)
    monkeypatch.setattr(b, "Renderer", _Renderer)
    return tmp_path


def _bank(folders: list[pathlib.Path], splits: list[str]) -> Any:
    start = np.zeros((len(folders), 4, 4))
    start[..., 2] = np.arange(len(folders))[:, None]
    names = [folder.name for folder in folders]
    return types.SimpleNamespace(meta={"categories": ["house", "ground:road"]}, episode_start=start, names=names)


@functools.cache
def _last_camera() -> tuple[np.ndarray, np.ndarray]:
    return list(b.cameras(PATH[:, :3], 0.0))[-1]


class _Renderer:
    """Red is the number in the scene's name, green its cousin, blue 255 for the last candidate."""

    def __init__(self, bank: Any, robot: None, height: int, width: int, *outputs: Any, **options: Any) -> None:
        self.bank, self.shape = bank, (height, width)

    def view(self, scene: int, at: np.ndarray, turn: np.ndarray, fovy: float) -> dict[str, np.ndarray]:
        assert at[2] == scene + b.CAMERA_HEIGHT  # above the pavement of this scene
        last = _last_camera()
        good = np.array_equal(at[:2], last[0][:2]) and np.allclose(turn, last[1], atol=1e-9)
        height, _width = self.shape
        rows = np.full(self.shape, 1)
        if good:
            rows[: height // 5], rows[height // 5 : height * 3 // 5] = -1, 0
        name = self.bank.names[scene]
        colour = int(name[5:7]), int(name[-2:]), 255 * good
        return {
            "category": rows,
            "object": rows,
            "depth": np.full(self.shape, 9.0),
            "rgb": np.full((*self.shape, 3), colour, np.uint8),
        }


def test_the_key_names_the_layout_of_every_image(small_set: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = small_set / "out"
    (out / b.IMAGES).mkdir(parents=True)
    (out / b.IMAGES / "street_77.png").write_text("of an earlier set")
    assert b.main(["--set", "towns", "--out", str(out), "--seed", "3"]) == 0
    key = json.loads((out / b.KEY).read_text(encoding="utf-8"))
    assert sorted(p.name for p in (out / b.IMAGES).iterdir()) == [f"street_{k:02d}.png" for k in range(1, 10)] == [*key]
    for file, row in key.items():
        image = np.asarray(Image.open(out / b.IMAGES / file))
        assert image.shape == (b.HEIGHT, b.WIDTH, 3)
        number, cousin, good = image[0, 0].tolist()
        assert row["layout"] == [*CITIES][number]
        assert (row["city"], row["country"]) == CITIES[row["layout"]]
        assert row["cousin"] == f"{row['layout']}_Cousin_{cousin:02d}"
        assert cousin == number % 2 + 1
        assert good == 255
    cities = (out / b.CITIES).read_text(encoding="utf-8").split("\n")
    assert cities == [*sorted(f"{city} ({country})" for city, country in CITIES.values()), ""]
    assert Image.open(out / b.SHEET).size == (6 * b.TILE[0], 2 * b.TILE[1])
    capsys.readouterr()
    answers = small_set / "answers.json"
    write_json(answers, {file: row["city"].replace("ä", "a") for file, row in key.items()})
    assert b.main(["--out", str(out), "--answers", str(answers)]) == 0
    said = json.loads(capsys.readouterr().out)
    assert (said["right"], said["of"]) == (9, 9)


def test_nothing_beside_the_images_tells_their_order(small_set: pathlib.Path) -> None:
    """Files are written in the order of their names, so their times give no layout away."""
    out = small_set / "out"
    b.render("towns", 3, out)
    written = sorted((out / b.IMAGES).iterdir(), key=lambda p: (p.stat().st_mtime_ns, p.name))
    assert [p.name for p in written] == sorted(p.name for p in written)
    assert not any(Image.open(p).info for p in written)


def test_the_order_is_random_and_the_seed_repeats_it(small_set: pathlib.Path) -> None:
    first, again, other = (
        {file: row["layout"] for file, row in b.render("towns", seed, small_set / str(k)).items()}
        for k, seed in enumerate((1, 1, 2))
    )
    assert first == again != other
    assert sorted(first.values()) == sorted(other.values()) == sorted(CITIES)
    assert list(first.values()) != sorted(CITIES) != list(other.values())
    assert all(len(set(b.file_names(count, 0))) == count for count in (1, 32, 160))


def test_a_set_that_is_not_built_is_one_sentence(small_set: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    gone = small_set / "cache" / "library" / "towns" / "scenes" / "Town_04_walk_01_Cousin_02" / "layout.json"
    gone.unlink()
    assert b.main(["--set", "towns", "--out", str(small_set / "out")]) == 2
    said = capsys.readouterr().err
    assert "Town_04_walk_01_Cousin_02" in said
    assert "urbanverse scene library towns" in said
    assert "Traceback" not in said
    assert b.main(["--set", "villages", "--out", str(small_set / "out")]) == 2
    assert "villages" in capsys.readouterr().err
    assert b.main(["--set", "towns", "--only", "nowhere", "--out", str(small_set / "out")]) == 2
    assert "'nowhere'" in capsys.readouterr().err
    assert not (small_set / "out").exists()


def test_scenes_without_a_region_and_files_that_are_missing(
    small_set: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = small_set / "cache" / "library" / "towns" / "scenes" / "Town_00_walk_01_Cousin_01" / "layout.json"
    rows = json.loads(path.read_text())
    del rows["place"]
    path.write_text(json.dumps(rows))
    assert b.main(["--set", "towns", "--out", str(small_set / "out")]) == 2
    assert "regional look" in capsys.readouterr().err
    path.unlink()
    answers = small_set / "answers.json"
    for text in (None, "[]", '{"street_01.png": "a", "street_01.png": "b"}'):
        if text:
            answers.write_text(text)
        assert b.main(["--out", str(small_set), "--answers", str(answers)]) == 2
        assert "answers.json" in capsys.readouterr().err
    answers.write_text('{"street_01.png": "Kyoto"}')
    (small_set / b.KEY).write_text('{"street_01.png": {"layout": "x"}}')
    assert b.main(["--out", str(small_set), "--answers", str(answers)]) == 2
    assert "street_01.png" in capsys.readouterr().err
    (small_set / "file").write_text("")
    assert b.main(["--set", "towns", "--only", "Town_01", "--out", str(small_set / "file" / "out")]) == 2
    assert "file" in capsys.readouterr().err


@pytest.mark.parametrize("sky_id", ["clear_noon", "overcast_bright", "winter_morning"])
def test_the_white_level_is_the_exposure_of_the_sky(sky_id: str) -> None:
    """Skies are exposed so that a white surface in the open has a known brightness (0.85, 0.9 and 0.75 of these)."""
    exposure = {"clear_noon": 0.85, "overcast_bright": 0.9, "winter_morning": 0.75}[sky_id]
    assert b.white_level(skies.build_sky(sky_id)) == pytest.approx(exposure, rel=0.03)


def _image(rows: np.ndarray, depth: float = 9.0) -> dict[str, np.ndarray]:
    return {"category": rows, "object": rows, "depth": np.full(rows.shape, depth)}


def test_composition_prefers_buildings_sky_and_ground_together() -> None:
    """Rows of categories, which are also objects: 0 and 1 buildings, 2 ground, 3 anything else, -1 the sky."""
    good = np.repeat([-1, 0, 1, 2, 2], 4)[:, None].repeat(20, 1)
    one = np.where(good == 1, 0, good)
    filled = good.copy()
    filled[4:16, 8:14] = 3
    no_sky = np.where(good == -1, 0, good)
    best = b.composition(_image(good), (0, 1), (2,))
    assert best == pytest.approx(0.12)
    assert b.composition(_image(one), (0, 1), (2,)) == pytest.approx(0.06)
    assert b.composition(_image(filled), (0, 1), (2,)) < best
    # 60 % of buildings are 5 % too many, and 6 % of sky are missing.
    assert b.composition(_image(no_sky), (0, 1), (2,)) == pytest.approx(0.12 - 2.0 * (0.05 + 0.06))
    assert b.composition(_image(good, 1.0), (0, 1), (2,)) == pytest.approx(0.12 - 2.0 * 0.6)


def test_cameras_stand_on_the_trajectory_and_look_to_both_sides_of_it() -> None:
    path = np.array([(3.0, 0.1 * k, 1.7) for k in range(200)])
    found = list(b.cameras(path, 0.15))
    assert len(found) == len(b.PLACES) * len(b.ASIDE)
    at, (w, x, y, z) = found[0]
    assert at == pytest.approx([3.0, 2.4, 0.15 + b.CAMERA_HEIGHT])
    # The view is along -z of the camera: the negated third column of its rotation. 45° right of north is north-east.
    ahead = -np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])
    assert math.degrees(math.atan2(ahead[1], ahead[0])) == pytest.approx(45.0, abs=0.01)
    assert ahead[2] / math.hypot(*ahead[:2]) == pytest.approx(b.RISE / b.AHEAD, abs=1e-4)
