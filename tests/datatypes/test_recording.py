"""A recording comes back from its folder as it was written, and a broken one is refused in one sentence."""

import dataclasses
import json
import pathlib
from typing import Any

import numpy as np
import pytest
from PIL import Image

from urbanverse_mjx.datatypes import Camera, Detection, Recording, RecordingWriter, Source, ValidationError

SOURCE = Source("synthetic", "CC0-1.0", "Bern", "Switzerland")
CAMERA = Camera(6, 4, 5.0, 5.0, 3.0, 2.0)


def write(folder: pathlib.Path, frames: int = 3) -> Recording:
    random = np.random.default_rng(7)
    writer = RecordingWriter(folder, "walk", SOURCE, CAMERA)
    for i in range(frames):
        pose = np.eye(4)
        pose[:3, 3] = i, 0.5, 1.6
        masks = np.full((4, 6), -1)
        masks[1:3, 2:4] = 0
        surfaces = np.zeros((4, 6), np.uint8)
        surfaces[0], surfaces[3] = 255, 4
        rgb, depth = random.integers(0, 256, (4, 6, 3), np.uint8), random.uniform(0.5, 300.0, (4, 6))
        depth[0] = 0.0
        writer.add(float(i), rgb, depth, masks, surfaces, None if i == 1 else pose, (Detection("bench", 0.8, "t1"),))
    return writer.close()


def test_what_is_written_comes_back(tmp_path: pathlib.Path) -> None:
    made = write(tmp_path / "r")
    back = Recording.load(tmp_path / "r")
    assert back == made
    assert back.registered.tolist() == [0, 2]
    assert back.poses()[1, 0, 3] == 2.0
    random = np.random.default_rng(7)
    for i in range(3):
        rgb, depth = random.integers(0, 256, (4, 6, 3), np.uint8), random.uniform(0.5, 300.0, (4, 6))
        depth[0] = 0.0
        assert (back.rgb(i) == rgb).all()
        read = back.depth(i)
        assert read is not None
        assert np.abs(read - depth).max() <= back.depth_unit_m / 2 + 1e-4
        masks, surfaces = back.masks(i), back.surfaces(i)
        assert masks is not None
        assert surfaces is not None
        assert (masks >= 0).sum() == 4
        assert surfaces[0, 0] == 255
        assert surfaces[3, 5] == 4


def test_rays_go_through_the_centres_of_pixels() -> None:
    rays = Camera(4, 2, 2.0, 2.0, 2.0, 1.0).rays()
    np.testing.assert_allclose(rays[0, 0], [-0.75, -0.25, 1.0])
    camera = Camera.from_fov(8, 6, np.pi / 2)
    assert camera.fy == pytest.approx(3.0)


def spoil(folder: pathlib.Path, *path: Any, value: Any) -> None:
    body = json.loads((folder / "recording.json").read_text())
    place = body
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    (folder / "recording.json").write_text(json.dumps(body))


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (("frames", 0, "T_world_camera", 3), float("nan"), "finite"),
        (("frames", 0, "T_world_camera", 0), 2.0, "a rotation and a shift"),
        (("frames", 1, "time_s"), 0.0, "times that grow"),
        (("frames", 1, "rgb"), "../elsewhere.png", "inside the recording"),
        (("frames", 1, "depth"), "depth/missing.png", "no such file"),
        (("frames", 0, "detections", 0, "score"), 1.5, "at most 1"),
        (("camera", "fx"), 0.0, "greater than 0"),
        (("frames",), [], "at least 1"),
        (("schema",), "urbanverse.recording/9", "one of"),
    ],
)
def test_a_spoiled_file_is_refused(tmp_path: pathlib.Path, path: tuple, value: Any, message: str) -> None:
    write(tmp_path)
    spoil(tmp_path, *path, value=value)
    with pytest.raises(ValidationError, match=message):
        Recording.load(tmp_path)


def test_spoiled_images_are_refused_when_read(tmp_path: pathlib.Path) -> None:
    recording = write(tmp_path)
    Image.fromarray(np.full((4, 6), 9, np.uint16)).save(tmp_path / "masks/000000.png")
    with pytest.raises(ValidationError, match="detection 9"):
        recording.masks(0)
    Image.fromarray(np.full((4, 6), 77, np.uint8)).save(tmp_path / "surfaces/000000.png")
    with pytest.raises(ValidationError, match="the value 77"):
        recording.surfaces(0)
    Image.fromarray(np.zeros((5, 6), np.uint16)).save(tmp_path / "depth/000000.png")
    with pytest.raises(ValidationError, match="6x5 pixels"):
        recording.depth(0)
    body = (tmp_path / "rgb/000000.png").read_bytes()
    (tmp_path / "rgb/000000.png").write_bytes(body[: len(body) // 2])
    with pytest.raises(ValidationError, match="unreadable"):
        recording.rgb(0)
    (tmp_path / "masks/000001.png").write_bytes(b"not an image")
    with pytest.raises(ValidationError, match="unreadable"):
        recording.masks(1)


def test_an_interrupted_writer_leaves_no_recording(tmp_path: pathlib.Path) -> None:
    write(tmp_path)
    writer = RecordingWriter(tmp_path, "walk", SOURCE, CAMERA)
    writer.add(0.0, np.zeros((4, 6, 3), np.uint8))
    with pytest.raises(ValidationError, match="no such file"):
        Recording.load(tmp_path)
    with pytest.raises(ValidationError, match="rows of 6 pixels"):
        writer.add(1.0, np.zeros((4, 7, 3), np.uint8))


def test_pictures_that_are_of_no_recording_are_never_removed(tmp_path: pathlib.Path) -> None:
    (tmp_path / "rgb").mkdir()
    (tmp_path / "rgb" / "holiday.jpg").write_text("mine")
    with pytest.raises(ValidationError, match="files that are not of a recording"):
        RecordingWriter(tmp_path, "walk", SOURCE, CAMERA)
    assert [p.name for p in tmp_path.rglob("*")] == ["rgb", "holiday.jpg"]


def test_a_recording_takes_the_place_of_a_whole_and_of_an_interrupted_one(tmp_path: pathlib.Path) -> None:
    write(tmp_path, frames=3)
    RecordingWriter(tmp_path, "walk", SOURCE, CAMERA).add(0.0, np.zeros((4, 6, 3), np.uint8))
    write(tmp_path, frames=2)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["depth", "masks", "recording.json", "rgb", "surfaces"]
    assert len(list((tmp_path / "rgb").iterdir())) == 2


def test_a_recording_in_the_place_of_another_removes_images_of_recordings_alone(tmp_path: pathlib.Path) -> None:
    write(tmp_path, frames=3)
    for name in ("rgb/holiday.jpg", "depth/000001.txt", "notes.md", "rgb/raw/000000.png"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("mine")
    write(tmp_path, frames=1)
    assert sorted(p.name for p in (tmp_path / "rgb").iterdir()) == ["000000.png", "holiday.jpg", "raw"]
    for name in ("rgb/holiday.jpg", "depth/000001.txt", "notes.md", "rgb/raw/000000.png"):
        assert (tmp_path / name).read_text() == "mine"


def test_a_folder_that_cannot_be_written_is_one_sentence(tmp_path: pathlib.Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(ValidationError, match="cannot be written"):
        RecordingWriter(tmp_path / "file" / "r", "walk", SOURCE, CAMERA)


def test_beliefs_come_back_and_take_no_room_where_there_are_none(tmp_path: pathlib.Path) -> None:
    plain = write(tmp_path / "plain")
    assert "beliefs" not in (tmp_path / "plain" / "recording.json").read_text()
    torn = Detection("house", 0.8, None, (("bakery", 0.5), ("pharmacy", 0.3)))
    frames = tuple(dataclasses.replace(f, detections=(torn,)) for f in plain.frames)
    dataclasses.replace(plain, frames=frames).save()
    assert Recording.load(tmp_path / "plain").frames[2].detections == (torn,)


@pytest.mark.parametrize(
    ("beliefs", "message"),
    [
        ((("bakery", 0.7), ("cafe", 0.4)), "add up to 1.1"),
        ((("bakery", 0.5), ("bakery", 0.4)), "bakery"),
        ((("bakery", 0.0),), "beliefs.bakery"),
    ],
)
def test_impossible_beliefs_are_refused(beliefs: tuple[tuple[str, float], ...], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        Detection("house", 0.8, None, beliefs)
    with pytest.raises(ValidationError, match="an object of labels"):
        Detection.from_json({"label": "a", "score": 1.0, "track": None, "beliefs": [["a", 1.0]]}, "d")
