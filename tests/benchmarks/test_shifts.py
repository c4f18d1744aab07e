"""Every shift of benchmarks.transfer against another program or a statistic: OpenCV's lenses, sRGB, random walks."""

import math

import cv2
import numpy as np
import pytest

from benchmarks.lib import shifts as s
from urbanverse_mjx.datatypes import ValidationError

FOVY = math.radians(90.96)
SIZE = 54, 96


def _matrix(focal: float) -> np.ndarray:
    # OpenCV counts from the middle of the first pixel.
    return np.array([[focal, 0.0, SIZE[1] / 2 - 0.5], [0.0, focal, SIZE[0] / 2 - 0.5], [0.0, 0.0, 1.0]])


def _pixels() -> np.ndarray:
    return np.stack(np.meshgrid(np.arange(SIZE[1]), np.arange(SIZE[0])), -1).reshape(-1, 1, 2).astype(np.float64)


def test_distortion_is_that_of_opencv() -> None:
    focal = SIZE[0] / (2 * math.tan(FOVY / 2))
    rays = s.brown_rays(*SIZE, FOVY, s.BROWN)
    points, nothing = rays.reshape(-1, 1, 3), np.zeros(3)
    seen, _ = cv2.projectPoints(points, nothing, nothing, _matrix(focal), np.array(s.BROWN))
    np.testing.assert_allclose(seen, _pixels(), atol=1e-3)
    # The lens is worth testing: its corners are pixels away from a pinhole's.
    straight, _ = cv2.projectPoints(points, nothing, nothing, _matrix(focal), np.zeros(4))
    assert np.abs(straight - seen).max() > 5.0


def test_a_lens_that_folds_back_is_refused() -> None:
    with pytest.raises(ValidationError, match="folds back"):
        s.brown_rays(*SIZE, FOVY, (-0.4, 0.0, 0.0, 0.0))


def test_fisheye_is_that_of_opencv_and_sees_its_field_of_view() -> None:
    rays = s.fisheye_rays(*SIZE, FOVY)
    ahead = rays[..., 2] > 0.02  # OpenCV's model is for points in front of the camera
    assert 0.9 < ahead.mean() <= 1.0
    points = rays[ahead].reshape(-1, 1, 3)
    seen, _ = cv2.fisheye.projectPoints(points, np.zeros(3), np.zeros(3), _matrix(SIZE[0] / FOVY), np.zeros(4))
    np.testing.assert_allclose(seen, _pixels()[ahead.ravel()], atol=1e-6)
    top, bottom = (math.atan2(-r[1], r[2]) for r in (rays[0, 47], rays[-1, 47]))
    assert top - bottom == pytest.approx(FOVY * 53 / 54, rel=1e-3)


def _panorama(rays: np.ndarray) -> np.ndarray:
    """(..., 3) u8, a smooth frame of all directions without symmetry."""
    x, y, z = np.moveaxis(rays, -1, 0)
    waves = np.stack([np.sin(5 * x + 2 * y), np.cos(4 * y - 3 * z + x), np.sin(3 * z + 4 * x * y)], -1)
    return np.round(127.5 + 120 * waves).astype(np.uint8)


@pytest.mark.parametrize(
    "rays",
    [s.fisheye_rays(*SIZE, FOVY), s.brown_rays(*SIZE, FOVY, s.BROWN), s.pinhole_rays(*SIZE, math.radians(40.0))],
    ids=["fisheye", "brown", "pinhole"],
)
def test_a_lens_shows_each_direction_where_it_lies(rays: np.ndarray) -> None:
    lens = s.Lens(rays)
    frames = []
    for view in lens.views:
        x, y, z = np.moveaxis(s.pinhole_rays(view.height, view.width, view.fovy), -1, 0)
        c, sin = math.cos(view.yaw), math.sin(view.yaw)
        # A camera turned to the left sees at its middle what lies to the left: x is to the right.
        frames.append(_panorama(np.stack([c * x - sin * z, y, sin * x + c * z], -1)))
    off = np.abs(lens.image(frames).astype(int) - _panorama(rays).astype(int))
    assert np.percentile(off, 99) <= 2
    assert off.max() <= 6
    assert len(lens.views) == (1 if rays[0, 0, 2] > 0.5 else 2)


def test_exposure_doubles_light_and_not_the_encoded_number() -> None:
    image = np.full((4, 4, 3), 128, np.uint8)
    rng = np.random.default_rng(0)
    # sRGB 128 is 0.2159 of white; twice that is 0.4317, which is encoded as 175.6 (IEC 61966-2-1).
    assert (s.exposed(image, 1.0, 0.0, rng) == 176).all()
    assert (s.exposed(image, 3.0, 0.0, rng) == 255).all()
    assert (s.exposed(image, -1.0, 0.0, rng) == 92).all()
    noisy = s.exposed(np.full((200, 200, 3), 128, np.uint8), 0.0, 0.02, rng).astype(float)
    assert noisy.mean() == pytest.approx(128.0, abs=0.1)
    assert noisy.std() == pytest.approx(0.02 * 255, rel=0.03)


def test_lost_images_come_in_bursts_and_the_last_one_stays() -> None:
    drop, burst = 0.1, s.BURST
    line = s.Dropouts(drop, np.random.default_rng(3))
    lost, last = [], -1
    for k in range(40_000):
        gone = line.lost()
        seen = line.seen(None if gone else np.array(k))
        last = last if gone else k
        assert int(seen) == last
        lost.append(gone)
    flags = np.array(lost)
    assert not flags[0]
    # A chain of two states: lost after delivered with `drop`, lost after lost with `BURST`.
    assert flags.mean() == pytest.approx(drop / (drop + 1 - burst), abs=0.01)
    starts = (flags[1:] & ~flags[:-1]).sum()
    assert flags.sum() / starts == pytest.approx(1 / (1 - burst), rel=0.05)
    clean = s.Dropouts(0.0, np.random.default_rng(3))
    clean.seen(np.array(1))
    assert not any(clean.lost() for _ in range(100))


def _walk(odometry: s.Odometry, poses: np.ndarray) -> np.ndarray:
    for pose in poses:
        odometry.update(pose)
    return odometry.pose


def _curve(metres: float) -> np.ndarray:
    """Poses every 2 cm along a curve whose heading swings."""
    along = np.arange(0.0, metres + 1e-9, 0.02)
    yaw = 0.8 * np.sin(along / 6.0)
    places = np.cumsum(np.stack([np.cos(yaw), np.sin(yaw)], -1) * 0.02, 0)
    return np.concatenate([places, yaw[:, None]], -1)


def test_odometry_without_errors_is_the_truth_and_its_scale_is_that_of_distances() -> None:
    poses = _curve(30.0)
    rng = np.random.default_rng(0)
    np.testing.assert_allclose(_walk(s.Odometry(poses[0], 1.0, 0.0, 0.0, rng), poses), poses[-1], atol=1e-9)
    longer = _walk(s.Odometry(poses[0], 1.03, 0.0, 0.0, rng), poses)
    np.testing.assert_allclose(longer[:2] - poses[0, :2], 1.03 * (poses[-1, :2] - poses[0, :2]), atol=1e-9)


@pytest.mark.extended
def test_odometry_turns_by_its_bias_and_wanders_by_its_walk() -> None:
    straight = np.stack([np.arange(0.0, 25.01, 0.02), np.zeros(1251), np.zeros(1251)], -1)
    rng = np.random.default_rng(1)
    biased = _walk(s.Odometry(straight[0], 1.0, 0.01, 0.0, rng), straight)
    assert biased[2] == pytest.approx(0.25, abs=1e-9)
    # An arc of 25 m with a curvature of 0.01 / m.
    np.testing.assert_allclose(biased[:2], [100 * math.sin(0.25), 100 * (1 - math.cos(0.25))], atol=0.01)
    ends = [_walk(s.Odometry(straight[0], 1.0, 0.0, 0.02, rng), straight)[2] for _ in range(400)]
    assert np.mean(ends) == pytest.approx(0.0, abs=0.02)
    assert np.std(ends) == pytest.approx(0.02 * math.sqrt(25.0), rel=0.1)


def test_a_delay_line_gives_the_same_sequence_later() -> None:
    line, given, found = s.DelayLine(0.15, -1), {}, {}
    for tick in range(500):
        time = tick * 0.02
        if tick % 10 == 0:
            line.give(time, tick)
            given[round(time, 9)] = tick
        found[round(time, 9)] = line.at(time)
    for time, value in found.items():
        due = [v for t, v in given.items() if t + 0.15 <= time + 1e-9]
        assert value == (due[-1] if due else -1)


def test_draws_are_within_their_ranges_and_independent_of_one_another() -> None:
    drawn = [s.ALL.draw((7, k)) for k in range(400)]
    assert drawn == [s.ALL.draw((7, k)) for k in range(400)]
    for name in ("latency", "exposure", "grip", "battery"):
        values, (low, high) = np.array([getattr(c, name) for c in drawn]), getattr(s.ALL, name)
        assert low <= values.min() < values.max() <= high
        assert values.mean() == pytest.approx((low + high) / 2, abs=0.1 * (high - low))
    tilt = np.array([math.acos(-c.gravity[2]) for c in drawn])
    assert 0.0 <= tilt.min() < 0.02
    assert 0.05 < tilt.max() <= s.ALL.slope[1] + 1e-9
    azimuth = np.array([math.atan2(c.gravity[1], c.gravity[0]) for c in drawn])
    # As many down as up the street, and no link with the tilt.
    assert abs(np.cos(azimuth).mean()) < 0.1
    assert abs(np.corrcoef(tilt, np.cos(azimuth))[0, 1]) < 0.15
    assert np.std([c.scale for c in drawn]) == pytest.approx(s.ALL.drift, rel=0.1)
    np.testing.assert_allclose([np.linalg.norm(c.gravity) for c in drawn], 1.0, atol=1e-12)
    alone = s.Shifts(latency=s.ALL.latency)
    assert [alone.draw((7, k)).latency for k in range(9)] == [c.latency for c in drawn[:9]]


def test_no_shift_is_none_and_every_row_shifts_something() -> None:
    calm = s.Shifts().draw((1, 2))
    assert (calm.latency, calm.exposure, calm.grip, calm.battery, calm.scale, calm.turn) == (
        0.0,
        0.0,
        1.0,
        1.0,
        1.0,
        0.0,
    )
    assert calm.gravity == (0.0, 0.0, -1.0)
    assert [name for name, shifts in s.ALONE.items() if shifts == s.Shifts()] == ["none"]


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"latency": (0.3, 0.1)}, r"latency\[1\]"),
        ({"latency": 0.1}, "two numbers"),
        ({"grip": (0.0, 1.0)}, r"grip\[0\]"),
        ({"dropped": 1.0}, "dropped"),
        ({"fisheye": True, "distortion": 1.0}, "one lens"),
        ({"exposure": (float("nan"), 1.0)}, "exposure"),
    ],
)
def test_impossible_shifts_are_refused(fields: dict[str, object], said: str) -> None:
    with pytest.raises(ValidationError, match=said):
        s.Shifts(**fields)  # type: ignore[arg-type]
