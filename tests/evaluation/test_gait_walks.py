"""Recorded walks of robots in C MuJoCo whose motion is known: in free flight, on the back, on the ground."""

import functools
from typing import Any

import mujoco
import numpy as np
import pytest

from tests.support.gaits import make_gait
from urbanverse_mjx.datatypes import RobotSpec
from urbanverse_mjx.evaluation.gait_walks import MIN_UPRIGHT, Walk, walk
from urbanverse_mjx.robots import make_go2
from urbanverse_mjx.scene.mjcf import scene_spec
from urbanverse_mjx.scene.terrain import region_scene, terrain_regions
from urbanverse_mjx.simulation.parity.c_mujoco import reference_model

STEP, STEPS, G = 0.02, 10, 9.81


@functools.cache
def street() -> tuple[RobotSpec, mujoco.MjModel]:
    robot = make_go2()
    return robot, reference_model(scene_spec(region_scene("flat-0", terrain_regions("flat", 0))), robot)


def pose(height: float, yaw: float = 0.0, roll: float = 0.0) -> np.ndarray:
    robot, model = street()
    del robot
    qpos = model.qpos0.copy()
    qpos[2], qpos[7:] = height, make_gait(seed=1).stand
    turn, lean = np.zeros(4), np.zeros(4)
    mujoco.mju_axisAngle2Quat(turn, np.array([0.0, 0.0, 1.0]), yaw)
    mujoco.mju_axisAngle2Quat(lean, np.array([1.0, 0.0, 0.0]), roll)
    mujoco.mju_mulQuat(qpos[3:7], turn, lean)
    return qpos


def walked(*poses: np.ndarray, **arguments: Any) -> Walk:
    robot, model = street()
    number = len(poses)

    def command(places: np.ndarray, yaws: np.ndarray, time: float) -> np.ndarray:
        assert places.shape == (number, 3)
        return np.stack([np.full(number, time), yaws, places[:, 2]], -1)

    limits = np.full(12, 30.0)
    zero = np.zeros(number, int)
    return walk([model], zero, robot, make_gait(seed=1), np.stack(poses), command, STEPS, limits, **arguments)


def test_a_robot_in_the_air_falls_freely_and_is_kicked_in_the_world_frame() -> None:
    kick = np.array([[0.0, 0.0], [0.6, 0.8]])
    found = walked(pose(5.0), pose(5.0, yaw=np.pi / 2), kicks={4: kick})
    time = STEP * np.arange(1, STEPS + 1)
    # The legs move, and with them the trunk by centimetres.
    np.testing.assert_allclose(found.position[0, :, 2], 5.0 - G * time**2 / 2, atol=0.02)
    np.testing.assert_allclose(found.yaw[1], np.pi / 2, atol=0.1)
    before, after = found.velocity[1, 3, :2], found.velocity[1, 4, :2]
    np.testing.assert_allclose(after - before, [0.8, -0.6], atol=0.15, err_msg="ahead and to the left")
    assert np.abs(found.velocity[0, :, :2]).max() < 0.3
    assert not found.fell.any()
    assert not found.touch.any()
    assert np.isnan(found.slip).all(), "no foot is on the ground"
    np.testing.assert_allclose(found.command[0, :, 0], time - STEP, atol=1e-9)
    np.testing.assert_allclose(found.command[0, 0], [0.0, 0.0, 5.0], atol=1e-6)


def test_a_robot_that_leans_far_has_fallen_wherever_it_is_and_its_record_ends() -> None:
    angle = np.arccos(MIN_UPRIGHT)
    found = walked(pose(5.0, roll=angle - 0.2), pose(5.0, roll=angle + 0.2), pose(5.0, roll=np.pi))
    assert found.fell.tolist() == [False, True, True]
    assert np.isfinite(found.position[0]).all()
    assert np.isfinite(found.position[1:, 0]).all()
    assert np.isnan(found.position[1:, 1:]).all()
    assert not found.touch.any(), "they are in the air"


def test_a_trunk_on_the_ground_has_fallen_and_a_standing_robot_has_not() -> None:
    robot, _ = street()
    low = pose(0.08)
    low[7:] = np.tile([0.0, 1.4, -2.7], 4)  # folded legs
    found = walked(pose(robot.spawn_height + 0.005), low)
    assert found.fell.tolist() == [False, True]
    assert not found.touch[0].any()
    assert (found.slip[0, 2:] < 0.5).all()
    # It is carried by twelve motors, none of which is near its limit or at rest.
    assert (found.torque[0, 2:] > 0.02).all()
    assert (found.torque[0] < 1.0).all()
    assert (found.power[0] >= 0.0).all()
    assert found.touch[1].any(), "parts other than feet"


def test_joints_outside_their_range_and_fast_ones_are_measured() -> None:
    _, model = street()
    bent, joint = pose(5.0), 2
    low, high = model.jnt_range[1 + joint]
    bent[7 + joint] = high + 0.9
    other = pose(5.0)
    other[7 + joint] = low - 0.9
    found = walked(bent, other, pose(5.0))
    assert 0.03 < found.beyond[0, 0] < 0.9
    assert 0.03 < found.beyond[1, 0] < 0.9
    assert found.beyond[2, 0] == pytest.approx(0.0, abs=1e-9)
    # The limit drives it back, faster than the gait moves its joints.
    assert found.speed[0, 0] > found.speed[2, 0]


def test_a_walk_that_is_stopped_stays_where_it_is_and_has_not_fallen() -> None:
    found = walked(pose(5.0), pose(5.0), finish=lambda places, time: np.array([False, time > 0.05]))
    assert np.isfinite(found.position[0]).all()
    stopped = np.isnan(found.position[1, :, 0])
    np.testing.assert_array_equal(stopped, STEP * np.arange(STEPS) > 0.05)
    assert not found.fell.any()
