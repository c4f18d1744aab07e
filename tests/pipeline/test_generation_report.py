"""The report of a run: its data are those of the recording, the graph and the cousins; the page works in a browser."""

import dataclasses
import io
import json
import pathlib
import shutil
from typing import Any

import mujoco
import numpy as np
import pytest
from PIL import Image

from tests.support import drawn_street
from tests.support.browser import browser
from urbanverse_mjx.assets.previews import thumbnails as asset_thumbnails
from urbanverse_mjx.capture import FilmOptions, PathOptions, film_scene, true_graph, walk
from urbanverse_mjx.datatypes import GraphObject, GroundRegion, Recording, SceneBank, SceneGraph
from urbanverse_mjx.datatypes.validation import write_atomically
from urbanverse_mjx.materialisation import index_of, materialise_cousins
from urbanverse_mjx.pipeline.generation import compiling
from urbanverse_mjx.pipeline.generation.records import record_of
from urbanverse_mjx.pipeline.generation.report import films, thumbnails, write_report
from urbanverse_mjx.pipeline.generation.report.cameras import MAX_FRAMES, shots_of
from urbanverse_mjx.pipeline.generation.report.left_out import left_out
from urbanverse_mjx.pipeline.generation.sources import Input

FRAMES, WIDTH, HEIGHT = 6, 160, 90
#: The frame without a pose.
LOST = 4


@pytest.fixture(scope="module")
def run(small_bank: SceneBank, tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """A run's folder before its report: a box street filmed in one of the bank's scenes, its graph, and cousins.

    The bank is that of the box streets, not of the cousins: scene 0 is what was filmed, so film and cousin 0 are equal.
    """
    folder = tmp_path_factory.mktemp("report") / "run"
    path = walk(small_bank, 0, PathOptions(frames=FRAMES, rate=0.5))
    options = FilmOptions(width=WIDTH, height=HEIGHT, samples=films.SAMPLES)
    recording = film_scene(small_bank, 0, folder / "recording", path, options)
    frames = list(recording.frames)
    frames[LOST] = dataclasses.replace(frames[LOST], T_world_camera=None)
    dataclasses.replace(recording, frames=tuple(frames)).save()
    graph = _graph(true_graph(small_bank, 0, path))
    (folder / "graph").mkdir()
    graph.save(folder / "graph" / "graph.json")
    evidence = [{"id": obj.id, "views": 3, "first": 0, "last": FRAMES - 1} for obj in graph.objects]
    removed = [{"id": "house_9", "label": "house", "reason": "another building covers it"}]
    body = {"objects": evidence, "left_out": 2, "removed": removed, "implausible": []}
    (folder / "graph" / "evidence.json").write_text(json.dumps(body))
    (folder / "frames").mkdir()
    (folder / "frames" / "frames.json").write_text(json.dumps({"dropped": [[0.5, "dark"], [1.0, "dark"]]}))
    cousins = materialise_cousins(graph, small_bank.num_scenes)
    for k, cousin in enumerate(cousins):
        place = folder / "cousins" / str(k)
        place.mkdir(parents=True)
        compiling.save_layout(place, cousin.layout, index_of(cousin.layout))
        check = {"id": cousin.layout.id, "movable": 1, "hulls": 2, "goals_m": [10.0, 30.0], "kept_fixed": []}
        (place / compiling.CHECK).write_text(json.dumps(check))
    (folder / "materialisation.json").write_text(json.dumps(record_of(graph, cousins)))
    small_bank.save(folder / "bank.npz")
    return folder


def _graph(graph: SceneGraph) -> SceneGraph:
    """A graph of which eight objects are kept, with labels that the catalogue has, one that it has not, and one that
    would end the page's data."""
    labels = ["trash bin", "bench", "traffic cone", "bollard", "trash bin", "bench", "qqq zzz", "bin </script><b>"]
    objects = [dataclasses.replace(o, label=n) for o, n in zip(graph.objects[::5], labels, strict=True)]
    path = np.delete(np.array(graph.camera_path), LOST, 0)
    return dataclasses.replace(graph, objects=tuple(objects), camera_path=tuple(map(tuple, path.tolist())))


def draw_textures(patch: pytest.MonkeyPatch, folder: pathlib.Path) -> None:
    """An own cache of thumbnails, whose drawing needs OpenGL: an asset's texture stands for it."""

    def draw(mesh: Any, path: pathlib.Path) -> pathlib.Path:
        image = Image.fromarray(np.resize(mesh.texture, (160, 160, 3)))
        return write_atomically(path, lambda p: image.save(p, "PNG"))

    patch.setattr(asset_thumbnails, "folder", lambda: folder / "thumbnails")
    patch.setattr(asset_thumbnails, "draw", draw)


def page_of(
    run: pathlib.Path, tmp_path: pathlib.Path, with_images: bool = True, recorded: bool = True, name: str = "scratch"
) -> str:
    (tmp_path / name).mkdir()
    given = Input("recording" if recorded else "graph", run, "key")
    where = run / "recording" if recorded else None
    return write_report(run, tmp_path / name, given, where, with_images, {"frames": 1.5}, lambda done, total: None)


def data_of(page: str) -> dict[str, Any]:
    return json.loads(page.partition('type="application/json">')[2].partition("</script>")[0])


def text_of(page: str) -> str:
    """The page without its data and script."""
    return page.partition('<script id="data"')[0]


# Cameras and films ----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> tuple[Recording, SceneGraph]:
    """A drawn street with its true graph."""
    objects, poses = drawn_street.street_objects(), drawn_street.walk(8)
    recording = drawn_street.record(tmp_path_factory.mktemp("drawn"), objects, poses)
    path = tuple((float(x), float(y), float(z), float(np.arctan2(r[1], r[0]))) for r, (x, y, z) in _ahead(poses))
    ground = GroundRegion("road", "road", ((0.0, -4.0), (60.0, -4.0), (60.0, 4.0), (0.0, 4.0)), (0.0, 0.0, 0.0))
    return recording, SceneGraph("drawn", recording.source, tuple(objects), (ground,), camera_path=path)


def _ahead(poses: np.ndarray) -> Any:
    """The direction (3,) in which each camera looks, and its place (3,)."""
    return zip(poses[:, :3, 2], poses[:, :3, 3], strict=True)


def test_boxes_of_the_graph_lie_on_what_the_frames_show(
    drawn: tuple[Recording, SceneGraph], tmp_path: pathlib.Path
) -> None:
    """An error of an axis, of the focal length or of the pixels' origin moves a box off its detection."""
    recording, graph = drawn
    shots = shots_of(graph, recording)
    assert shots.camera == recording.camera
    filmed = films.film_recording(recording, shots, {}, tmp_path)
    compared = 0
    for shot, seen in zip(shots.shots, filmed.seen, strict=True):
        for found in seen:
            boxes = [_projected(obj, shot.pose, recording) for obj in graph.objects if obj.label == found.label]
            # Objects behind others and at the image's border show a part of their box.
            compared += any(np.abs(np.subtract(box, found.box)).max() < 1.5 for box in boxes if box is not None)
    assert compared >= 10


def _projected(obj: GraphObject, pose: Any, recording: Recording) -> np.ndarray | None:
    c, s = np.cos(obj.yaw), np.sin(obj.yaw)
    signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
    points = (signs * np.array(obj.size) / 2) @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + obj.center
    local = (points - pose[:3, 3]) @ pose[:3, :3]
    if local[:, 2].min() < 0.3:
        return None
    u = recording.camera.fx * local[:, 0] / local[:, 2] + recording.camera.cx
    w = recording.camera.fy * local[:, 1] / local[:, 2] + recording.camera.cy
    return np.array([u.min(), w.min(), u.max(), w.max()])


def test_cameras_follow_the_poses_that_distillation_corrected(drawn: tuple[Recording, SceneGraph]) -> None:
    """The recording's poses are 2 m and 0.3 rad off, the graph's trajectory is right."""
    recording, graph = drawn
    c, s = np.cos(0.3), np.sin(0.3)
    off = np.array([[c, -s, 0, 2.0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    frames = tuple(
        dataclasses.replace(f, T_world_camera=tuple(map(tuple, (off @ pose).tolist())))
        for f, pose in zip(recording.frames, recording.poses(), strict=True)
    )
    shots = shots_of(graph, dataclasses.replace(recording, frames=frames))
    for shot, pose in zip(shots.shots, recording.poses(), strict=True):
        assert shot.pose is not None
        np.testing.assert_allclose(shot.pose, pose, atol=1e-6)


def test_a_graph_without_a_recording_is_seen_along_its_trajectory(drawn: tuple[Recording, SceneGraph]) -> None:
    _, graph = drawn
    shots = shots_of(graph, None).shots
    assert len(shots) == len(graph.camera_path)
    for shot, (x, y, z, yaw) in zip(shots, graph.camera_path, strict=True):
        assert shot.pose is not None
        np.testing.assert_allclose(shot.pose[:3, 3], [x, y, z])
        np.testing.assert_allclose(np.arctan2(shot.pose[1, 2], shot.pose[0, 2]), yaw)
        np.testing.assert_allclose(shot.pose[:3, :3] @ shot.pose[:3, :3].T, np.eye(3), atol=1e-12)
        assert shot.pose[2, 1] < -0.9  # y is down
        assert np.linalg.det(shot.pose[:3, :3]) > 0
    bare = shots_of(dataclasses.replace(graph, camera_path=()), None)
    assert bare.shots == ()
    assert "no trajectory" in bare.missing


def test_long_recordings_and_many_cousins_stay_within_bounds(drawn: tuple[Recording, SceneGraph]) -> None:
    recording, graph = drawn
    count = 3 * MAX_FRAMES
    frames = tuple(dataclasses.replace(recording.frames[0], time_s=float(k)) for k in range(count))
    graph = dataclasses.replace(graph, camera_path=graph.camera_path[:1] * count)
    shots = shots_of(graph, dataclasses.replace(recording, frames=frames))
    assert len(shots.shots) == MAX_FRAMES
    assert [shots.shots[0].number, shots.shots[-1].number] == [0, count - 1]
    assert len(films.rendered_rows(shots, 1)) == MAX_FRAMES
    for cousins in (4, 64):
        rows = films.rendered_rows(shots, cousins)
        assert len(rows) == max(films.COUSIN_IMAGES // cousins, films.LEAST_IMAGES)
        assert [rows[0], rows[-1]] == [0, MAX_FRAMES - 1]
    wrong = shots_of(dataclasses.replace(graph, camera_path=graph.camera_path[:5]), recording)
    assert "5 places" in wrong.missing
    assert films.rendered_rows(wrong, 1) == []


# The page's data ------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def page(run: pathlib.Path, tmp_path_factory: pytest.TempPathFactory) -> str:
    with pytest.MonkeyPatch.context() as patch:
        folder = tmp_path_factory.mktemp("page")
        draw_textures(patch, folder)
        return page_of(run, folder)


@pytest.mark.extended
def test_the_page_holds_what_the_run_found(page: str, run: pathlib.Path) -> None:
    body = data_of(page)
    recording, graph = Recording.load(run / "recording"), SceneGraph.load(run / "graph" / "graph.json")
    record = json.loads((run / "materialisation.json").read_text())
    assert [f["number"] for f in body["frames"]] == list(range(FRAMES))
    assert [f["place"] is None for f in body["frames"]] == [k == LOST for k in range(FRAMES)]
    assert set(body["films"]) == {"frames", "frames with masks and ground"}
    assert body["films"]["frames"]["rows"] == list(range(FRAMES))
    for k, row in enumerate(body["seen"]):
        masks = recording.masks(k)
        assert masks is not None
        assert len(row) == len(recording.frames[k].detections)
        for i, (left, top, right, bottom, label, score) in enumerate(row):
            rows, columns = np.nonzero(masks == i)
            assert [left, top, right, bottom] == [columns.min(), rows.min(), columns.max() + 1, rows.max() + 1]
            assert (label, score) == (recording.frames[k].detections[i].label, recording.frames[k].detections[i].score)
    assert [o["id"] for o in body["objects"]] == [o.id for o in graph.objects]
    assert [c["film"]["rows"] for c in body["cousins"]] == [[k for k in range(FRAMES) if k != LOST]] * 3
    for obj in body["objects"]:
        for k, chosen in enumerate(obj["chosen"]):
            match = record["matches"][obj["id"]][k]
            assert (chosen is None) == (match is None)
            assert chosen is None or chosen["uid"] == match["uid"]
            assert chosen is None or chosen["uid"] in body["assets"]
            assert (obj["left_out"][k] is None) == (match is not None)
    unknown = next(o for o in body["objects"] if o["label"] == "qqq zzz")
    assert all("no leaf of the ontology" in reason for reason in unknown["left_out"])


def test_what_was_left_out_is_told_with_its_reason(page: str, run: pathlib.Path) -> None:
    record = json.loads((run / "materialisation.json").read_text())
    entries = left_out(run, Recording.load(run / "recording"), record)
    assert [(e.what, e.where) for e in entries[:4]] == [
        ("2 frames at 0.5, 1.0 s", "frames"),
        (f"1 of {FRAMES} frames", "poses"),
        ("2 objects", "graph"),
        ("house_9 (house)", "graph"),
    ]
    assert entries[0].reason == "too dark"
    unknown = next(e for e in entries if "qqq zzz" in e.what)
    assert unknown.where == "all cousins"
    once = {"cousins": [{"left_out": []}, {"left_out": [{"id": "a", "label": "b", "reason": "c"}]}]}
    assert left_out(run / "none", None, once)[0].where == "cousin 1"
    shown = text_of(page)
    for text in ("2 frames at 0.5, 1.0 s", "another building covers it", "no leaf of the ontology is called anything"):
        assert text in shown


def test_names_cannot_end_the_data_or_add_markup(page: str) -> None:
    assert "</script><b>" not in page
    assert any(o["label"] == "bin </script><b>" for o in data_of(page)["objects"])


# What is missing or damaged -------------------------------------------------------------------------------------------


def test_a_graph_has_no_film(run: pathlib.Path, tmp_path: pathlib.Path) -> None:
    page = page_of(run, tmp_path, with_images=False, recorded=False)
    body = data_of(page)
    assert body["films"] == {}
    assert "The source is a scene graph, so there is no film" in text_of(page)
    assert "not asked for" in text_of(page)
    assert [c["film"] for c in body["cousins"]] == [None] * 3
    assert body["assets"] == {}


def test_damaged_parts_are_sentences(
    run: pathlib.Path, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An image, the evidence, the list of frames and the bank are cut off; the rest of the page is as before."""
    draw_textures(monkeypatch, tmp_path)
    other = tmp_path / "run"
    shutil.copytree(run, other)
    recording = Recording.load(other / "recording")
    for path in (
        other / "recording" / recording.frames[2].rgb,
        other / "graph" / "evidence.json",
        other / "frames" / "frames.json",
        other / "bank.npz",
    ):
        path.write_bytes(path.read_bytes()[:30])
    page = page_of(other, tmp_path)
    shown, body = text_of(page), data_of(page)
    assert f"{recording.frames[2].rgb}: found an unreadable image" in shown
    # The depth of all frames, the cousins' films, the evidence in the table, and the list.
    assert shown.count("This part is missing:") == 4
    assert len(body["films"]["frames"]["rows"]) == FRAMES
    assert body["seen"][2] == []
    assert any(body["seen"])
    assert [o["views"] for o in body["objects"]] == [None] * 8
    assert [c["film"] for c in body["cousins"]] == [None] * 3


def test_without_opengl_assets_have_no_thumbnails(
    run: pathlib.Path, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def draw(mesh: Any, path: pathlib.Path) -> None:
        raise mujoco.FatalError("gladLoadGL error\nat line 3")

    records = compiling.load_assets(run / "cousins" / "0").records
    monkeypatch.setattr(asset_thumbnails, "folder", lambda: tmp_path)
    monkeypatch.setattr(asset_thumbnails, "draw", draw)
    found = thumbnails.of_assets(records)
    assert found.of == {}
    assert f"{len(records)} of {len(records)} assets have no thumbnail: MuJoCo found no OpenGL" in found.missing
    assert "(gladLoadGL error)" in found.missing
    draw_textures(monkeypatch, tmp_path)
    monkeypatch.setattr(thumbnails, "MAX_DRAWN", 2)
    some = thumbnails.of_assets(records)
    assert list(some.of) == [r.uid for r in records[:2]]
    assert f"{len(records) - 2} of {len(records)} assets have no thumbnail" in some.missing
    monkeypatch.setattr(thumbnails, "MAX_DRAWN", 100)
    assert thumbnails.of_assets(records).missing == ""


# In a browser ---------------------------------------------------------------------------------------------------------


@pytest.mark.extended
def test_film_and_cousin_are_scrubbed_together(page: str, tmp_path: pathlib.Path) -> None:
    """Cousin 0 is the filmed scene itself, so both panels show the same at every moment, and other moments another."""
    (tmp_path / "report.html").write_text(page, encoding="utf-8")
    with browser() as chromium:
        tab = chromium.new_page(viewport={"width": 1200, "height": 900})
        errors: list[str] = []
        tab.on("pageerror", lambda error: errors.append(str(error)))
        tab.goto((tmp_path / "report.html").as_uri())
        _shows(tab, 0)
        tab.uncheck("#boxes")
        shown = {}
        for step in (0, 2, 3):
            _drag(tab, step)
            left, right = (_panel(tab, side) for side in ("left", "right"))
            assert np.abs(left - right).mean() < 2.0, step
            shown[step] = left
        assert min(np.abs(shown[0] - shown[2]).mean(), np.abs(shown[2] - shown[3]).mean()) > 4.0
        _drag(tab, LOST)
        assert "Frame 4 has no pose" in tab.text_content("#right .view p")
        assert tab.locator("#camera").is_hidden()
        tab.locator("body").press("ArrowLeft")
        _shows(tab, 3)
        assert tab.text_content("#right .view p") == ""
        tab.check("#boxes")
        assert tab.locator("#left rect.box").count() == len(data_of(page)["seen"][3])
        tab.uncheck("#boxes")
        tab.click("#play")
        _shows(tab, 5)
        tab.click("#play")
        assert tab.text_content("#play") == "Play"
        tab.select_option("#film", "frames with masks and ground")
        _drag(tab, 3)
        assert np.abs(_panel(tab, "left") - shown[3]).mean() > 4.0
        tab.select_option("#cousin", "2")
        _drag(tab, 3)
        assert np.abs(_panel(tab, "right") - shown[3]).mean() > 4.0
        assert errors == []


@pytest.mark.extended
def test_table_map_and_panels_choose_one_object(page: str, run: pathlib.Path, tmp_path: pathlib.Path) -> None:
    (tmp_path / "report.html").write_text(page, encoding="utf-8")
    graph = SceneGraph.load(run / "graph" / "graph.json")
    with browser() as chromium:
        tab = chromium.new_page(viewport={"width": 1200, "height": 900})
        tab.goto((tmp_path / "report.html").as_uri())
        _shows(tab, 0)
        rows = tab.locator("#objects tbody tr")
        assert rows.count() == len(graph.objects)
        tab.fill("#find", "trash bin")
        assert rows.count() == 2
        assert tab.text_content("#count") == "2 of 8 objects."
        rows.first.click()
        name = rows.first.get_attribute("data-id")
        assert tab.locator("#map .chosen").get_attribute("data-id") == name
        assert tab.locator("#left .wire").count() == tab.locator("#right .wire").count() == 1
        tab.fill("#find", "")
        other = graph.objects[1].id
        tab.locator(f'#map [data-id="{other}"] rect').click(force=True)
        assert tab.locator("#objects tr.chosen").get_attribute("data-id") == other
        tab.locator("#objects th", has_text="object").click()
        assert rows.first.get_attribute("data-id") == min(o.id for o in graph.objects)
        assert "left out because no leaf of the ontology" in tab.text_content("#objects tbody")
        assert tab.locator("#depth").is_hidden()
        tab.check("#depth_shown")
        assert tab.locator("#depth").is_visible()


def _shows(tab: Any, step: int) -> None:
    tab.wait_for_function(f"document.body.dataset.step === '{step}'", timeout=60_000)


def _drag(tab: Any, step: int) -> None:
    tab.eval_on_selector("#slider", f"x => {{ x.value = {step}; x.dispatchEvent(new Event('input')); }}")
    _shows(tab, step)
    tab.wait_for_timeout(100)


def _panel(tab: Any, side: str) -> np.ndarray:
    """(H, W, 3) of a video on the page."""
    return np.asarray(Image.open(io.BytesIO(tab.locator(f"#{side} .view").screenshot())).convert("RGB")).astype(int)
