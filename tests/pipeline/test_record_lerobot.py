"""A recording is read back by the library `lerobot`, which needs torch and so lives in an environment of its own."""

import os
import pathlib
import subprocess
import sys
from typing import Any

import cv2
import numpy as np
import pytest

from tests.pipeline.test_recording import OPTIONS, SIZE, STEPS, drawn_env, table_of, use
from urbanverse_mjx import pipeline
from urbanverse_mjx.datatypes import SceneBank

#: Names a Python that has lerobot; default: the one of the tests.
PYTHON = os.environ.get("LEROBOT_PYTHON", sys.executable)
#: Writes every item that the library's dataset and a loader of it give.
_READ = """
import sys
import numpy, torch
from lerobot.datasets.lerobot_dataset import LeRobotDataset
data = LeRobotDataset("you/demos", root=sys.argv[1])
items = [data[i] for i in range(len(data))]
found = {k: numpy.stack([numpy.asarray(item[k]) for item in items]) for k in items[0]}
batch = next(iter(torch.utils.data.DataLoader(data, batch_size=len(data))))
assert torch.equal(batch["action"], torch.stack([item["action"] for item in items]))
names = {k.replace("/", "|"): x for k, x in found.items()}
numpy.savez(sys.argv[2], fps=data.fps, episodes=data.num_episodes, **names)
"""
FRONT, DEPTH, INSTANCE = (f"observation.images.{name}" for name in ("front", "depth", "instance"))


@pytest.fixture(scope="module")
def read(small_bank: SceneBank, tmp_path_factory: pytest.TempPathFactory) -> tuple[pathlib.Path, dict[str, Any]]:
    """A recording, and what the library finds in it."""
    if subprocess.run([PYTHON, "-c", "import lerobot.datasets.lerobot_dataset"], capture_output=True).returncode:
        pytest.skip("needs lerobot; LEROBOT_PYTHON names a Python that has it")
    folder = tmp_path_factory.mktemp("lerobot")
    with pytest.MonkeyPatch.context() as patch:
        use(drawn_env(small_bank, {"episode_length": STEPS}), patch)
        pipeline.record(folder / "new", OPTIONS)
    command = [PYTHON, "-c", _READ, str(folder / "new"), str(folder / "items.npz")]
    offline = {**os.environ, "HF_HUB_OFFLINE": "1", "HF_HOME": str(folder / "home")}
    done = subprocess.run(command, capture_output=True, text=True, env=offline)
    assert done.returncode == 0, done.stderr[-2000:]
    with np.load(folder / "items.npz") as found:
        return folder / "new", dict(found)


@pytest.mark.slow
def test_lerobot_reads_every_row(read: tuple[pathlib.Path, dict[str, Any]]) -> None:
    folder, found = read
    rows = table_of(folder)
    assert (int(found["fps"]), int(found["episodes"]), len(found["index"])) == (5, 5, 5 * STEPS)
    numbers = [k for k in rows if not k.startswith("observation.images.")]
    assert {"observation.state", "action", "pose", "next.success"} <= set(numbers)
    for name in numbers:
        given = np.asarray(rows[name])
        np.testing.assert_allclose(found[name].reshape(given.shape), given, atol=1e-6, err_msg=name)
    assert set(found["task"]) == {"drive to the goal over the pavement without touching anything"}


@pytest.mark.slow
def test_lerobot_shows_the_images_of_the_rows(read: tuple[pathlib.Path, dict[str, Any]]) -> None:
    folder, found = read
    rows = table_of(folder)
    (video,) = (folder / "videos").rglob("*.mp4")
    capture = cv2.VideoCapture(str(video))
    frames = [capture.read()[1][..., ::-1] for _ in range(5 * STEPS)]
    assert found[FRONT].shape == (5 * STEPS, 3, *SIZE)
    # Both decode the same pictures; only the colours' conversion to RGB is rounded otherwise.
    off = np.abs(255.0 * found[FRONT].transpose(0, 2, 3, 1) - np.stack(frames))
    assert off.mean() < 2.0
    for name in (DEPTH, INSTANCE):
        stored = np.stack(
            [np.asarray(cv2.imdecode(np.frombuffer(x["bytes"], np.uint8), cv2.IMREAD_UNCHANGED)) for x in rows[name]]
        )
        np.testing.assert_array_equal(found[name].reshape(stored.shape).astype(np.int64) % 65536, stored)
