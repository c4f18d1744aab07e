"""Folders of frames: what their lists name is complete, also after the process is killed."""

import json
import os
import pathlib
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from urbanverse_mjx.datasets import coco, kitti
from urbanverse_mjx.datasets.annotations import Annotation, SeenObject
from urbanverse_mjx.datasets.frame_files import ORIGIN, FrameEpisode, FrameFolder, Rig
from urbanverse_mjx.datasets.mcap_files import McapWriter
from urbanverse_mjx.datatypes import ValidationError

RIG = Rig(8, 12, (10.0, 10.0), (6.0, 4.0), 5, (0.0, 0.0, 0.5), ["box"])
WRITERS = {"coco": coco.CocoWriter, "kitti": kitti.KittiWriter, "mcap": McapWriter}


def episode(length: int = 3) -> FrameEpisode:
    """Frames that show one box; contents of images do not matter here."""
    still = (1.0, 0.0, 0.0, 0.0)
    seen = SeenObject(
        3, "b", "box", (1, 2, 5, 6), 16, 1.0, (1.0, 1.0, 1.0), (4.0, 0.0, 0.5), still, (0.0, 0.0, 4.0), still
    )
    pose = np.tile([0.0, 0.0, 0.2, 1.0, 0.0, 0.0, 0.0], (length, 1))
    camera = np.tile([0.0, 0.0, 0.7, 0.5, -0.5, 0.5, -0.5], (length, 1))
    runs = [10, 4, 4, 4, 4, 4, 4, 4, 58]
    return FrameEpisode(
        [b"image"] * length,
        {"pose": pose, "pose.camera": camera, "action": np.zeros((length, 2))},
        [Annotation("a box", (seen,), (runs,))] * length,
        [np.ones((4, 3), np.float32)] * length,
        {"scene": "s", "result": "goal"},
    )


def complete(folder: pathlib.Path, form: str) -> int:
    """How many frames the folder's lists name; each has all its files."""
    if form == "coco":
        body = json.loads((folder / coco.INSTANCES).read_text())
        assert {a["image_id"] for a in body["annotations"]} == {i["id"] for i in body["images"]}
        assert all((folder / "images" / i["file_name"]).read_bytes() == b"image" for i in body["images"])
        return len(body["images"])
    if form == "kitti":
        names = (folder / kitti.IMAGE_SET).read_text().split()
        for name in names:
            assert len((folder / f"training/velodyne/{name}.bin").read_bytes()) == 4 * 4 * 4
            assert (folder / f"training/label_2/{name}.txt").read_text().count("\n") == 1
            assert (folder / f"training/calib/{name}.txt").read_text().count("\n") == 7
        return len(names)
    reader = pytest.importorskip("mcap.reader")
    frames = 0
    for path in sorted(folder.glob("*.mcap")):
        with path.open("rb") as stream:
            frames += sum(1 for _ in reader.make_reader(stream).iter_messages(topics=["/pose"]))
    return frames


@pytest.mark.parametrize("form", WRITERS)
def test_all_frames_are_listed_at_the_end(form: str, tmp_path: pathlib.Path) -> None:
    if form == "mcap":
        pytest.importorskip("foxglove_schemas_protobuf")
        pytest.importorskip("mcap_protobuf")
    with WRITERS[form](tmp_path / "new", RIG, {"policy": "none"}) as writer:
        for length in (3, 1, 2):
            writer.add(episode(length))
    assert complete(tmp_path / "new", form) == writer.num_frames == 6
    assert json.loads((tmp_path / "new" / ORIGIN).read_text()) == {"policy": "none"}
    assert not (tmp_path / "new/.unfinished").exists()
    with pytest.raises(ValidationError, match="not empty"):
        WRITERS[form](tmp_path / "new", RIG, {})


@pytest.mark.parametrize("form", ["coco", "kitti"])
def test_an_interrupt_within_an_episode_leaves_it_out(
    form: str, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ctrl-C between two files of the third episode, while the list still names the first one only."""
    folder, placed = tmp_path / "new", FrameFolder._place

    def place(self: FrameFolder, name: str, body: bytes) -> None:
        if self.num_episodes == 2 and name == sorted(self.files(episode()))[1]:
            raise KeyboardInterrupt
        placed(self, name, body)

    def add_three() -> None:
        with WRITERS[form](folder, RIG, {}) as writer:
            for _ in range(3):
                writer.add(episode())

    monkeypatch.setattr(FrameFolder, "_place", place)
    with pytest.raises(KeyboardInterrupt):
        add_three()
    assert complete(folder, form) == 6


def test_a_folder_without_episodes_goes_away(tmp_path: pathlib.Path) -> None:
    with FrameFolder(tmp_path / "new", RIG, {}):
        pass
    assert not (tmp_path / "new").exists()


_ENDLESS = """
import pathlib, sys
from tests.datasets.test_frame_files import RIG, WRITERS, episode
with WRITERS[sys.argv[1]](pathlib.Path(sys.argv[2]), RIG, {}) as writer:
    while True:
        writer.add(episode())
        print(writer.num_episodes, flush=True)
"""


@pytest.mark.slow
@pytest.mark.parametrize("form", WRITERS)
def test_a_killed_recording_is_complete_up_to_its_last_listed_episode(form: str, tmp_path: pathlib.Path) -> None:
    """Killed at a moment of its own in each of three tries."""
    if form == "mcap":
        pytest.importorskip("foxglove_schemas_protobuf")
        pytest.importorskip("mcap_protobuf")
    for wait in (1.3, 1.71, 2.24):
        folder = tmp_path / str(wait)
        command = [sys.executable, "-c", _ENDLESS, form, str(folder)]
        with subprocess.Popen(command, stdout=subprocess.PIPE, env={**os.environ}) as process:
            assert process.stdout is not None
            process.stdout.readline()
            time.sleep(wait)
            process.send_signal(signal.SIGKILL)
            added = int(process.stdout.read().split()[-1])
        frames = complete(folder, form)
        assert frames % 3 == 0
        assert 0 < frames <= 3 * (added + 1)
        if form == "mcap":
            assert frames >= 3 * added
