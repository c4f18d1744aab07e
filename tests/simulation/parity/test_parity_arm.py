"""An arm on a robot in all engines against C MuJoCo: its motion in the air, the force of a press on a doorbell, and
what counts as a hit beside it."""

import functools
from typing import Any

import jax
import mujoco
import numpy as np
import pytest

from tests.support.doorbells import POSTS, bell_spec, bell_street
from tests.support.foot_drives import Run, in_c_mujoco, in_engine
from urbanverse_mjx.robots import make_coco_arm
from urbanverse_mjx.robots.arm_reach import ArmReach

CONTROL_DT, STEPS = 0.1, 34
#: The control step in which the arm begins to press, and the force (N) that its servos are told.
PRESS, FORCE = 24, 12.0
#: Drives: a press straight ahead, one aslant from beside, one on a lower button, the post beside a button, and a drive
#: with a moving arm. m from the button, m to the left, rad, m above the button.
PLACES = ((0, 0.62, 0.0, 0.0, 0.0), (1, 0.60, 0.08, 0.2, 0.0), (2, 0.66, -0.05, -0.1, 0.0), (0, 0.62, 0.0, 0.0, 0.1))
ENGINES = (pytest.param("jax", marks=pytest.mark.slow), "warp", "warp-fused")


@functools.cache
def planned() -> tuple[Any, np.ndarray, np.ndarray]:
    """The robot, starts (N, nq) and commands (T, N, nu): to a point 6 cm before the button, then against it."""
    robot = make_coco_arm()
    model, reach = mujoco.MjModel.from_xml_string(robot.mjcf), ArmReach(robot)
    solve = jax.jit(reach.solve)
    number = len(PLACES) + 1
    qpos = np.tile(model.key_qpos[0].astype(np.float32), (number, 1))
    ctrl = np.tile(np.asarray(robot.command(np.zeros(2)), np.float32), (STEPS, number, 1))
    for i, (which, away, left, turn, above) in enumerate(PLACES):
        post = POSTS[which]
        face, facing = post.at(0.08), np.array([np.cos(post.yaw), np.sin(post.yaw), 0.0])
        aside = np.array([-facing[1], facing[0], 0.0])
        yaw = post.yaw + np.pi + turn
        qpos[i, :2] = (face + away * facing + left * aside)[:2]
        qpos[i, 2], qpos[i, 3], qpos[i, 6] = 0.15 + robot.spawn_height, np.cos(yaw / 2), np.sin(yaw / 2)
        into = np.array([[np.cos(yaw), np.sin(yaw), 0.0], [-np.sin(yaw), np.cos(yaw), 0.0], [0.0, 0.0, 1.0]])
        low = np.array([0.0, -0.3, 0.0, 0.3, 0.0], np.float32)
        for step in range(STEPS):
            # The post's front is behind that of the cap.
            out = 0.06 if step < PRESS else -0.02 if above else 0.0
            place = into @ (face + (out + 0.012) * facing + [0.0, 0.0, above] - qpos[i, :3])
            ahead = into @ -facing
            low, _ = solve(low, place.astype(np.float32), ahead.astype(np.float32))
            push = FORCE * ahead if step >= PRESS else np.zeros(3)
            held = reach.holding(reach.pose(low), push.astype(np.float32))
            ctrl[step, i, 4:] = np.clip(low + held / reach.gain, reach.low, reach.high)
    # Drives a bend on the road while the arm moves through the air.
    qpos[-1, :3] = 6.0, 0.0, robot.spawn_height
    wheels = np.asarray(robot.command(np.array([0.8, 0.3])))[:4]
    swing = np.sin(np.arange(STEPS)[:, None] * CONTROL_DT * np.array([1.5, 2.0, 1.7, 2.3, 3.0]))
    ctrl[:, -1, :4], ctrl[:, -1, 4:] = wheels, np.array([0.0, -0.5, 0.3, 0.2, 0.0]) + 0.5 * swing
    return robot, qpos, ctrl


@functools.cache
def expected() -> Run:
    """The drives in C MuJoCo, with the force on the fingertip."""
    robot, start, ctrl = planned()
    return in_c_mujoco(bell_spec(), robot, start, ctrl, CONTROL_DT, (robot.arm.tip,), robot.root_body)


@functools.cache
def found(impl: str) -> Run:
    """The drives in an engine."""
    robot, start, ctrl = planned()
    return in_engine(impl, bell_street(), robot, start, ctrl, CONTROL_DT, (robot.arm.tip,), robot.root_body)


@pytest.mark.extended
def test_c_mujoco_presses_with_the_force_that_the_servos_are_told() -> None:
    """Three presses hold the button, the fourth meets the post, and the last touches nothing."""
    run = expected()
    assert (run.force[:PRESS] == 0.0).all()
    # In the step of greatest force: the speed servos of the wheels give way, and the commands do not follow.
    np.testing.assert_allclose(run.force[:, :3].max(0), FORCE, rtol=0.4)
    assert not run.hit[:, [0, 1, 2, 4]].any()
    assert run.hit[PRESS:, 3].any()
    assert not run.hit[:PRESS, 3].any()


@pytest.mark.parametrize("impl", ENGINES)
def test_the_arm_moves_in_the_air_as_in_c_mujoco(impl: str) -> None:
    """All joints of the arm to 1 mrad and the robot's body to 1 mm, until the fingertip touches something."""
    run, reference = found(impl), expected()
    np.testing.assert_allclose(run.qpos[:PRESS, :, :3], reference.qpos[:PRESS, :, :3], atol=1e-3)
    np.testing.assert_allclose(run.qpos[:PRESS, :, -5:], reference.qpos[:PRESS, :, -5:], atol=1e-3)
    np.testing.assert_allclose(run.qpos[:, -1, -5:], reference.qpos[:, -1, -5:], atol=1e-3)
    assert np.ptp(reference.qpos[..., -5:], axis=0).max(0).min() > 0.3, "every joint of the arm moves somewhere"


@pytest.mark.parametrize("impl", ENGINES)
def test_a_press_is_that_of_c_mujoco(impl: str) -> None:
    """The same control step of the first touch, the force of each step to half a newton, joints to 5 mrad."""
    run, reference = found(impl), expected()
    found_first, first = ((x.force[:, :3] > 0.0).argmax(0) for x in (run, reference))
    np.testing.assert_array_equal(found_first, first)
    np.testing.assert_allclose(run.force[:, :3], reference.force[:, :3], atol=0.5)
    np.testing.assert_allclose(run.qpos[:, :3, -5:], reference.qpos[:, :3, -5:], atol=5e-3)
    np.testing.assert_allclose(run.qpos[:, :3, :3], reference.qpos[:, :3, :3], atol=2e-3)


@pytest.mark.parametrize("impl", ENGINES)
def test_only_the_cap_may_be_touched_and_only_by_the_fingertip(impl: str) -> None:
    """A fingertip beside the cap hits the post in the same control step as in C MuJoCo; a press is no hit."""
    run, reference = found(impl), expected()
    np.testing.assert_array_equal(run.hit.any(0), reference.hit.any(0))
    np.testing.assert_array_equal(run.hit[:, 3].argmax(), reference.hit[:, 3].argmax())
