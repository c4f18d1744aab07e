"""Rollout videos: directions of the cameras, playable files."""

import pathlib
import warnings
from typing import Any

import imageio.v2 as imageio
import jax
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from urbanverse_mjx.datatypes import OUTCOMES, ValidationError
from urbanverse_mjx.simulation.rendering.cameras import following_cameras, look_at
from urbanverse_mjx.viz.video import CAPTIONS, caption, write_video


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
