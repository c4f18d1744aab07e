"""Rollout videos: directions of the cameras, the pole at the goal, playable files."""

import pathlib
import types
import warnings
from typing import Any

import imageio.v2 as imageio
import jax
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from urbanverse_mjx.datatypes import OUTCOMES, SceneBank, ValidationError
from urbanverse_mjx.simulation.rendering.cameras import following_cameras, look_at
from urbanverse_mjx.viz import video
from urbanverse_mjx.viz.video import CAPTIONS, caption, marked, write_rollout_video, write_video


def test_cameras_look_at_their_target_with_the_horizon_level() -> None:
    rng = np.random.default_rng(0)
    camera_position, target = rng.normal(size=(50, 3)) * 5, rng.normal(size=(50, 3)) * 5
    rotation = Rotation.from_quat(
        np.roll([look_at(e, t) for e, t in zip(camera_position, target, strict=True)], -1, axis=-1)
    )
    forward = rotation.apply([0.0, 0.0, -1.0])
    np.testing.assert_allclose(
        forward,
        (target - camera_position) / np.linalg.norm(target - camera_position, axis=-1, keepdims=True),
        atol=1e-6,
    )
    np.testing.assert_allclose(rotation.apply([1.0, 0.0, 0.0])[:, 2], 0.0, atol=1e-6)
    assert (rotation.apply([0.0, 1.0, 0.0])[:, 2] > 0).all()


def test_a_slower_encoder_writes_a_smaller_file_of_the_same_frames(tmp_path: pathlib.Path) -> None:
    """A pattern that moves, drawn anew for each frame as a rotated wave."""
    x, y = np.meshgrid(np.arange(96), np.arange(64))
    waves = [127 + 100 * np.sin(0.4 * x + 0.1 * y * np.cos(0.2 * t) + t) for t in range(12)]
    sizes, errors = {}, {}
    for encoder in ("ultrafast", "veryslow"):
        path = tmp_path / f"{encoder}.mp4"
        write_video(path, [np.repeat(w.astype(np.uint8)[..., None], 3, -1) for w in waves], 5, encoder=encoder)
        reader: Any
        with imageio.get_reader(path) as reader:
            seen = np.stack([np.asarray(frame)[..., 0] for frame in reader])
        sizes[encoder], errors[encoder] = path.stat().st_size, np.abs(seen - np.stack(waves)).mean()
    assert sizes["veryslow"] < 0.8 * sizes["ultrafast"]
    assert errors["veryslow"] < 6.0
    with pytest.raises(ValidationError, match=r"video\.encoder: found 'slowest', needed one of ultrafast"):
        write_video(tmp_path / "no.mp4", [np.zeros((64, 96, 3), np.uint8)], 5, encoder="slowest")


@pytest.mark.parametrize("rate", [5.0, 25.0])
@pytest.mark.parametrize("steps", [1, 3, 40])
def test_following_camera_stays_behind_and_above(steps: int, rate: float) -> None:
    yaw = np.linspace(0.0, 1.5, steps)
    xpos, xquat = np.zeros((steps, 2, 3)), np.zeros((steps, 2, 4))
    xpos[:, 1, 0] = np.arange(steps)
    xquat[:, 1, 0], xquat[:, 1, 3] = np.cos(yaw / 2), np.sin(yaw / 2)
    camera_position, _ = following_cameras(xpos, xquat, rate, 1.0)
    ahead = np.stack([np.cos(yaw), np.sin(yaw)], -1)
    assert (((camera_position - xpos[:, 1])[:, :2] * ahead).sum(-1) < -2.0).all()
    assert (camera_position[:, 2] > 1.0).all()
    nearer, _ = following_cameras(xpos, xquat, rate, 0.5)
    np.testing.assert_allclose(nearer - xpos[:, 1], 0.75 * (camera_position - xpos[:, 1]), atol=1e-5)


def test_mp4_round_trip(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "a.mp4"
    shades = [20, 90, 160, 230]
    write_video(path, [np.full((64, 96, 3), s, np.uint8) for s in shades], 5)
    reader: Any
    with imageio.get_reader(path) as reader:
        meta = reader.get_meta_data()
        frames = [np.asarray(f) for f in reader]
    assert meta["codec"] == "h264"
    assert meta["size"] == (96, 64)
    assert meta["fps"] == 5
    assert [abs(float(f.mean()) - s) < 6 for f, s in zip(frames, shades, strict=True)] == [True] * 4


def test_no_warning_reaches_the_user(tmp_path: pathlib.Path) -> None:
    """JAX, once it runs, warns of the fork by which imageio starts ffmpeg."""
    jax.devices()
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        write_video(tmp_path / "a.mp4", [np.zeros((64, 96, 3), np.uint8)], 5)
    assert [str(w.message) for w in said] == []


def test_odd_sizes_leave_no_file(tmp_path: pathlib.Path) -> None:
    with pytest.raises(ValidationError, match="even size"):
        write_video(tmp_path / "a.mp4", [np.zeros((63, 96, 3), np.uint8)], 5)
    assert not list(tmp_path.iterdir())


def test_the_line_over_a_frame_tells_every_outcome_apart() -> None:
    assert set(CAPTIONS) == set(OUTCOMES)
    lines = {caption("park_edge", 1.2, 3.4, outcome, 0.0) for outcome in OUTCOMES}
    assert len(lines) == len(OUTCOMES)
    assert caption("park_edge", 1.2, 3.4, "timeout", 0.8) == "park_edge    1.2 s   goal  3.4 m   ends: out of time"


def test_the_outcome_is_not_told_before_the_last_second() -> None:
    assert caption("park_edge", 1.2, 3.4, "goal", 1.0) == "park_edge    1.2 s   goal  3.4 m"
    assert caption("park_edge", 1.2, 3.4, "goal", 0.0).endswith("   ends: at the goal")


def test_the_pole_stands_at_the_pixels_of_the_goal() -> None:
    """A level camera 1 m above the ground: pixels by the tangents of the angles to the pole's ends."""
    frame, fov = np.zeros((180, 320, 3), np.uint8), 1.05
    level = look_at([0.0, 0.0, 1.0], [0.0, 5.0, 1.0])  # to +y, so +x is on the right
    focal = 90.0 / np.tan(fov / 2)
    for x in (-2.0, 0.0, 3.0):
        rows, columns = np.nonzero(
            marked(frame, np.array([x, 8.0, 0.0]), np.array([0.0, 0.0, 1.0]), level, fov)[..., 0]
        )
        assert abs(columns.mean() - (160.0 + focal * x / 8.0)) < 1.0
        assert abs(rows.max() - (90.0 + focal * 1.0 / 8.0)) <= 1.5  # the goal itself
        assert rows.min() < 90.0 - focal * 1.1 / 8.0  # the triangle stands on the pole's end at 2.1 m
    behind = marked(frame, np.array([0.0, -8.0, 0.0]), np.array([0.0, 0.0, 1.0]), level, fov)
    assert not behind.any()


@pytest.mark.parametrize("azimuth", [0.0, 60.0])
def test_the_last_seconds_are_those_of_the_whole_video(
    azimuth: float, small_bank: SceneBank, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A robot that drives along x at 1 m/s towards a goal that moves beside it, without a renderer."""
    steps, rate = 30, 5.0
    xpos, xquat = np.zeros((steps, 1, 2, 3)), np.tile([1.0, 0.0, 0.0, 0.0], (steps, 1, 2, 1))
    xpos[:, 0, 1, 0] = np.arange(steps) / rate
    goals = xpos[:, 0, 1] + [4.0, 3.0, 0.0]
    running = (np.arange(steps) < 25)[:, None]
    trajectory = types.SimpleNamespace(xpos=xpos, xquat=xquat, running=running, agents=None)
    views: list[np.ndarray] = []

    class Images:
        def __init__(self, *_: object, **__: object) -> None: ...

        def __call__(self, *_: object) -> dict[str, Any]:
            return {"rgb": jax.numpy.zeros((32, 64, 3), jax.numpy.uint8)}

        def view(self, *_: object) -> dict[str, Any]:
            return {"rgb": jax.numpy.zeros((32, 64, 3), jax.numpy.uint8), "depth": jax.numpy.zeros((32, 64))}

    def noted(frame: np.ndarray, goal: np.ndarray, camera: np.ndarray, turn: np.ndarray, _: float) -> np.ndarray:
        views.append(np.concatenate([goal, camera, Rotation.from_quat(turn, scalar_first=True).apply([0, 0, -1])]))
        return frame

    said: list[str] = []

    def line(frame: np.ndarray, text: str) -> np.ndarray:
        said.append(text)
        return frame

    for name, stand_in in (("Renderer", Images), ("marked", noted), ("_caption", line)):
        monkeypatch.setattr(video, name, stand_in)
    robot: Any = types.SimpleNamespace(planner_height=0.6)
    texts, cameras = [], []
    for last in (None, 2.0, 60.0):
        write_rollout_video(
            tmp_path / "a.mp4", small_bank, robot, trajectory, [0], [0], [goals], ["hit"], rate,
            size=(32, 64), note=lambda column, step: f"step {step}", last=last, azimuth=azimuth, nearness=0.5,
        )  # fmt: skip
        texts.append(said[:])
        cameras.append(np.array(views))
        said.clear()
        views.clear()
    assert [len(x) for x in texts] == [25, 10, 25]
    assert texts[0] == texts[2]
    assert texts[1] == texts[0][-10:]
    assert "4.8 s" in texts[1][-1]
    assert texts[1][-1].endswith("step 24   ends: hit an object")
    np.testing.assert_allclose(cameras[1], cameras[0][-10:], atol=1e-5)
    # Half as far away as usual, from behind or from the right.
    offset = cameras[0][:, 3:5] - xpos[:25, 0, 1, :2]
    usual, _ = following_cameras(xpos[:25, 0], xquat[:25, 0], rate, 0.6)
    distance = np.linalg.norm(usual[0, :2] - xpos[0, 0, 1, :2])
    wanted = -0.5 * distance * np.array([np.cos(np.radians(azimuth)), np.sin(np.radians(azimuth))])
    np.testing.assert_allclose(offset, np.tile(wanted, (25, 1)), atol=1e-4)
