"""`load_demonstrations`: the rows and images of a recorded dataset, and the datasets that it refuses."""

import json
import pathlib
import types
from typing import Any

import cv2
import numpy as np
import pyarrow.parquet as pq
import pytest

from tests.pipeline.test_recording import OPTIONS, SIZE, STEPS, drawn_env, use
from tests.support.recorded import write_dataset
from urbanverse_mjx import pipeline
from urbanverse_mjx.cli import main as cli
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.pipeline.demonstrations import load_demonstrations, other_looks
from urbanverse_mjx.training.networks import PIXELS


@pytest.fixture(scope="module")
def recorded(small_bank: SceneBank, tmp_path_factory: pytest.TempPathFactory) -> tuple[pathlib.Path, Any]:
    """A dataset of three episodes, and what the loader reads of the environment that it is for."""
    env = drawn_env(small_bank, {"episode_length": STEPS})
    with pytest.MonkeyPatch.context() as patch:
        use(env, patch)
        folder = tmp_path_factory.mktemp("demonstrations") / "new"
        pipeline.record(folder, type(OPTIONS)(**{**vars(OPTIONS), "num_episodes": 3, "sensors": ()}))
    return folder, env


def wanting(env: Any, height: int = SIZE[0], width: int = SIZE[1], **changes: Any) -> Any:
    sizes = {PIXELS: (height, width, 3), "goal": (2,), "proprio": (5,)}
    about = {"observation_size": sizes, "action_size": 2, "dt": env.dt, "robot": env.robot, "config": env.config}
    return types.SimpleNamespace(**{**about, **changes})


@pytest.mark.extended
def test_steps_and_images_are_those_of_the_dataset(recorded: tuple[pathlib.Path, Any]) -> None:
    folder, env = recorded
    data = load_demonstrations(folder, wanting(env))
    rows = pq.read_table(folder / "data/chunk-000/file-000.parquet").to_pydict()
    np.testing.assert_array_equal(data.obs["proprio"], np.array(rows["observation.state"], np.float32))
    np.testing.assert_array_equal(data.obs["goal"], np.array(rows["observation.environment_state"], np.float32))
    np.testing.assert_array_equal(data.action, np.array(rows["action"], np.float32))
    np.testing.assert_array_equal(np.flatnonzero(data.begins), [0, STEPS, 2 * STEPS])
    video = cv2.VideoCapture(str(next(folder.glob("videos/**/*.mp4"))))
    frames = np.stack([video.read()[1][:, :, ::-1] for _ in range(3 * STEPS)])
    assert np.abs(data.obs[PIXELS].astype(int) - frames).max() <= 3, "two decoders of colours"
    half = load_demonstrations(folder, wanting(env, SIZE[0] // 2, SIZE[1] // 2))
    means = frames.reshape(len(frames), SIZE[0] // 2, 2, SIZE[1] // 2, 2, 3).mean((2, 4))
    assert np.abs(half.obs[PIXELS] - means).mean() < 3.0
    first = load_demonstrations(folder, wanting(env), 2)
    np.testing.assert_array_equal(first.obs[PIXELS], data.obs[PIXELS][: 2 * STEPS])
    np.testing.assert_array_equal(first.action, data.action[: 2 * STEPS])
    with pytest.raises(ValidationError, match="found 3 episodes, needed at least 4; record more"):
        load_demonstrations(folder, wanting(env), 4)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"action_size": 12}, "feature action: found .2., needed one of 12 values"),
        ({"dt": 0.1}, "fps: found 5, needed 10; record with the same --preset"),
        ({"height": 12, "width": 40}, "images: found 24x32, needed the proportions of 12x40; record with --size 12x40"),
        ({"robot": types.SimpleNamespace(name="go2")}, "robot_type: found 'coco_differential', needed 'go2'"),
    ],
)
def test_a_dataset_of_another_task_is_refused(
    recorded: tuple[pathlib.Path, Any], changes: dict[str, Any], said: str
) -> None:
    with pytest.raises(ValidationError, match=said):
        load_demonstrations(recorded[0], wanting(recorded[1], **changes))


def test_other_meanings_of_actions_and_goals_are_refused(
    recorded: tuple[pathlib.Path, Any], tmp_path: pathlib.Path
) -> None:
    folder, env = recorded
    other = env.config.copy_and_resolve_references().unlock()
    other.goal_mode = "waypoint"
    with pytest.raises(ValidationError, match=r"goal_mode: found 'final', needed 'waypoint'; record with the same"):
        load_demonstrations(folder, wanting(env, config=other))
    assert json.loads((folder / "meta/urbanverse.json").read_text())["environment_config"]["goal_mode"] == "final"
    with pytest.raises(ValidationError, match=r"feature observation.state: found .3., needed one of 5 values"):
        load_demonstrations(write_dataset(tmp_path / "other"), wanting(env))


def test_images_that_were_drawn_otherwise_are_said_and_others_are_not(
    recorded: tuple[pathlib.Path, Any], tmp_path: pathlib.Path
) -> None:
    """As those of `record`, whose default is the preset paper, for the preset quick."""
    folder, env = recorded
    assert other_looks(folder, wanting(env)) == ""
    assert other_looks(write_dataset(tmp_path / "other"), wanting(env)) == ""
    drawn = env.config.vision_config.shading
    other = env.config.copy_and_resolve_references().unlock()
    other.preset, other.vision_config.shading = "quick", "flat"
    said = other_looks(folder, wanting(env, config=other))
    assert f"drawn with shading '{drawn}' (--preset {env.config.preset})" in said
    assert "will see shading 'flat'; record with --preset quick" in said
    assert "light" not in said
    assert "shadows" not in said
    origin = json.loads((folder / "meta/urbanverse.json").read_text())
    del origin["environment_config"]["vision_config"]["light"]
    silent = tmp_path / "silent"
    (silent / "meta").mkdir(parents=True)
    (silent / "meta/urbanverse.json").write_text(json.dumps(origin))
    other.vision_config.light = "another"
    assert "will see shading 'flat', light 'another';" in other_looks(folder, wanting(env, config=other))
    assert "light" not in other_looks(silent, wanting(env, config=other))


def test_the_command_refuses_presets_without_a_student(tmp_path: pathlib.Path, capsys: Any) -> None:
    for more, said in (
        (["--preset", "cpu"], "needed one that trains by imitation: quick or best"),
        (["--resume", str(tmp_path)], "--demonstrations: found it together with --resume"),
    ):
        assert cli.main(["train", "--demonstrations", str(tmp_path), "--logdir", str(tmp_path / "runs"), *more]) == 2
        assert said in " ".join(capsys.readouterr().err.split())
    assert not (tmp_path / "runs").exists()
