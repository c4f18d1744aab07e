"""A trajectory that bends a little with every step is straightened by the directions in which its objects are seen."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from urbanverse_mjx.distillation import bearings
from urbanverse_mjx.distillation.depth_scale import DepthScale
from urbanverse_mjx.distillation.lifting import NUM_POINTS, Views

#: T_world_camera of a level camera with its view along +x: its z ahead, its y down.
LEVEL = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
NOISE = 0.04


def walk(turn: float, drift: float = 0.0, noise: float = NOISE) -> tuple[Views, np.ndarray, np.ndarray, np.ndarray]:
    """Sixty posts along a straight path of 100 m, seen by a camera whose odometry turns by `turn` rad and is `drift`
    too long with every metre. Returns views, what each shows, and the given and the true poses."""
    rng = np.random.default_rng(5)
    posts = np.c_[rng.uniform(0, 110, 60), rng.choice([-1, 1], 60) * rng.uniform(3, 8, 60), rng.uniform(0.2, 2, 60)]
    true = np.tile(np.eye(4), (81, 1, 1))
    true[:, :3, :3] = LEVEL
    true[:, 0, 3], true[:, 2, 3] = np.linspace(0, 100, 81), 1.5
    given, angle = true.copy(), 0.0
    for i in range(1, len(true)):
        angle += turn * 1.25
        R = Rotation.from_euler("z", angle).as_matrix()
        given[i, :3, 3] = given[i - 1, :3, 3] + (1 + drift) * R @ (true[i, :3, 3] - true[i - 1, :3, 3])
        given[i, :3, :3] = R @ LEVEL
    frame, obj, points = [], [], []
    for f in range(len(true)):
        local = (posts - true[f, :3, 3]) @ true[f, :3, :3]
        for k in np.flatnonzero((local[:, 2] > 2) & (local[:, 2] < 25) & (np.abs(local[:, 0]) < 0.9 * local[:, 2])):
            # A post is a disc of 0.3 m that faces the camera, at a distance that is off.
            disc = local[k] + np.c_[rng.uniform(-0.15, 0.15, (NUM_POINTS, 2)), np.zeros(NUM_POINTS)]
            frame.append(f)
            obj.append(k)
            points.append(disc * (1 + rng.normal(0, noise)))
    n = len(frame)
    views = Views(
        labels=("post",),
        frame=np.array(frame, np.int32),
        label=np.zeros(n, np.int32),
        score=np.ones(n, np.float32),
        track=np.full(n, -1, np.int32),
        points=np.array(points, np.float32),
        pixels=np.full(n, 50, np.int32),
        clipped=np.zeros((n, 4), bool),
        origin=np.zeros((n, 2), np.int32),
    )
    return views, np.array(obj, np.int32), given, true


def apart(poses: np.ndarray, true: np.ndarray) -> np.ndarray:
    """(m,) m between camera places; the first pose is the same in both."""
    return np.linalg.norm((poses - true)[:, :2, 3], axis=1)


@pytest.mark.parametrize("turn", [np.radians(0.03), np.radians(-0.05)])
def test_a_bent_way_is_straightened(turn: float) -> None:
    views, obj, given, true = walk(turn)
    adjusted = bearings.adjust(views, obj, given, DepthScale(np.ones(len(given)), NOISE))
    assert adjusted is not None
    assert apart(given, true)[-1] > 2.0
    assert apart(adjusted, true)[-1] < 0.3 * apart(given, true)[-1]


def test_a_way_too_long_shrinks_to_what_depth_says() -> None:
    views, obj, given, _ = walk(np.radians(0.03), drift=0.02)
    adjusted = bearings.adjust(views, obj, given, DepthScale(np.ones(len(given)), NOISE))
    assert adjusted is not None
    length = np.linalg.norm(np.diff(adjusted[:, :2, 3], axis=0), axis=1).sum()
    assert abs(length - 100.0) < 1.0  # 102 m were given


def test_some_wrong_sightings_are_outvoted() -> None:
    views, obj, given, true = walk(np.radians(0.04))
    wrong = obj.copy()
    rng = np.random.default_rng(6)
    mixed = rng.random(len(obj)) < 0.05
    wrong[mixed] = rng.integers(0, 60, int(mixed.sum()))
    adjusted = bearings.adjust(views, wrong, given, DepthScale(np.ones(len(given)), NOISE))
    assert adjusted is not None
    assert apart(adjusted, true)[-1] < 0.3 * apart(given, true)[-1]


def test_poses_that_are_right_stay() -> None:
    views, obj, given, _ = walk(0.0)
    assert bearings.adjust(views, obj, given, DepthScale(np.ones(len(given)), NOISE)) is None


@pytest.mark.parametrize("noise", [0.06, 0.12])
def test_directions_tell_how_far_depth_is_off(noise: float) -> None:
    views, obj, given, _ = walk(0.0, noise=noise)
    error = bearings.depth_error(views, obj, given, np.ones(len(given)))
    assert 0.8 * noise < error / bearings._OPTIONS.depth_share < 1.3 * noise


def test_right_depth_is_not_called_wrong() -> None:
    views, obj, given, _ = walk(0.0, noise=0.001)
    assert bearings.depth_error(views, obj, given, np.ones(len(given))) == 0.0
    few = np.where(obj < 3, obj, np.arange(len(obj), dtype=np.int32) + 3)
    assert bearings.depth_error(views, few, given, np.ones(len(given))) == 0.0


def test_few_objects_say_nothing() -> None:
    views, obj, given, _ = walk(np.radians(0.05))
    few = np.where(obj < 5, obj, np.arange(len(obj), dtype=np.int32) + 5)
    assert bearings.adjust(views, few, given, DepthScale(np.ones(len(given)), NOISE)) is None


def test_slopes_are_those_of_finite_differences() -> None:
    views, obj, given, _ = walk(np.radians(0.03))
    seen = bearings.measure(views, given, np.ones(len(given)))
    problem = bearings._Problem(seen, np.unique(obj, return_inverse=True)[1], given, NOISE)
    rng = np.random.default_rng(1)
    objects, correction = problem._start(), rng.normal(0, 0.05, (problem.at.shape[1], 4))
    misfit, slope, bend = problem._linear(objects, correction)
    step, move = 1e-5 * rng.normal(size=objects.shape), 1e-5 * rng.normal(size=correction.shape)
    after = problem._linear(objects + step, correction + move)[0]
    predicted = np.einsum("nri,ni->nr", slope, step[problem.which]) + np.einsum(
        "nri,ni->nr", bend, problem.blend @ move
    )
    np.testing.assert_allclose(after - misfit, predicted, atol=1e-6)
