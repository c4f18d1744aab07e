"""A parcel at the hand of an arm in all engines against C MuJoCo: held, released, and in a parcel box; and released
against a body that was never held."""

import functools
from typing import Any

import jax
import mujoco
import numpy as np
import pytest

from tests.support.foot_drives import Run, in_c_mujoco, in_engine
from tests.support.parcel_boxes import BOXES, box_spec, box_street
from urbanverse_mjx.robots import make_coco_parcel
from urbanverse_mjx.robots.arm_reach import ArmReach
from urbanverse_mjx.simulation.engines import with_timestep
from urbanverse_mjx.simulation.parity import c_mujoco

CONTROL_DT, STEPS = 0.1, 42
#: The control step from which on the parcel is free.
RELEASE = 28
#: Drops: into the middle of a box, into one aslant while the hand moves, onto the rim of a third; then a drive with a
#: moving arm that holds on, and one that lets go on the road. Which box, m from its near side, m to the left, rad, m
#: from the box's middle to the drop, towards the robot.
PLACES = ((0, 0.65, 0.0, 0.0, 0.0), (1, 0.62, 0.05, 0.15, 0.0), (2, 0.65, 0.0, 0.0, 0.19))
DRIVES = 2
ENGINES = (pytest.param("jax", marks=pytest.mark.slow), "warp", "warp-fused")


@functools.cache
def planned() -> tuple[Any, np.ndarray, np.ndarray]:
    """The robot, starts (N, nq) and commands (T, N, nu)."""
    robot = make_coco_parcel()
    assert robot.parcel is not None
    assert robot.arm is not None
    model, reach = mujoco.MjModel.from_xml_string(robot.mjcf), ArmReach(robot, robot.parcel.ahead)
    solve = jax.jit(reach.solve)
    number = len(PLACES) + DRIVES
    qpos = np.tile(model.key_qpos[0].astype(np.float32), (number, 1))
    ctrl = np.tile(np.asarray(robot.command(np.zeros(2)), np.float32), (STEPS, number, 1))
    for i, (which, away, left, turn, out) in enumerate(PLACES):
        box = BOXES[which]
        facing = np.array([np.cos(box.yaw), np.sin(box.yaw), 0.0])
        aside = np.array([-facing[1], facing[0], 0.0])
        yaw = box.yaw + np.pi + turn
        qpos[i, :2] = (box.at(0.2 + away) + left * aside)[:2]
        qpos[i, 2], qpos[i, 3], qpos[i, 6] = 0.15 + robot.spawn_height, np.cos(yaw / 2), np.sin(yaw / 2)
        into = np.array([[np.cos(yaw), np.sin(yaw), 0.0], [-np.sin(yaw), np.cos(yaw), 0.0], [0.0, 0.0, 1.0]])
        place = into @ (box.at(out) + [0.0, 0.0, 0.15] - qpos[i, :3])
        low, _ = solve(
            np.array([0.0, -0.3, 0.0, 0.3, 0.0], np.float32), place.astype(np.float32), np.array([1.0, 0.0, 0.0])
        )
        held = reach.holding(reach.pose(low), np.array([0.0, 0.0, 0.5 * 9.81]))
        ctrl[:, i, 4:9] = np.clip(low + held / reach.gain, reach.low, reach.high)
        # By way of a pose above all boxes.
        share = np.minimum(np.arange(STEPS) / 12, 1.0)[:, None]
        raised = np.array(robot.arm.folded) * (1 - share) + np.array([0.0, -0.3, 0.0, 0.3, 0.0]) * share
        ctrl[:16, i, 4:9] = raised[:16]
    ctrl[RELEASE:, 1, 4:9] += np.array([0.2, -0.1, 0.1, -0.3, 0.6], np.float32)
    # Bends on the road while the arm moves through the air.
    qpos[-2:, :3] = [(6.0, 0.0, robot.spawn_height), (20.0, 0.0, robot.spawn_height)]
    swing = np.sin(np.arange(STEPS)[:, None] * CONTROL_DT * np.array([1.5, 2.0, 1.7, 2.3, 3.0]))
    for i in (-2, -1):
        ctrl[:, i, :4] = np.asarray(robot.command(np.array([0.8, 0.3])))[:4]
        ctrl[:, i, 4:9] = np.array([0.0, -0.5, 0.3, 0.2, 0.0]) + 0.5 * swing
    ctrl[RELEASE:, [0, 1, 2, -1], 9:] = 0.0
    return robot, qpos, ctrl


@functools.cache
def expected() -> Run:
    """The drives in C MuJoCo, with the parcel's poses and the forces on its spheres."""
    robot, start, ctrl = planned()
    return in_c_mujoco(box_spec(), robot, start, ctrl, CONTROL_DT, robot.parcel.spheres, robot.parcel.body)


@functools.cache
def found(impl: str) -> Run:
    """The drives in an engine."""
    robot, start, ctrl = planned()
    return in_engine(impl, box_street(), robot, start, ctrl, CONTROL_DT, robot.parcel.spheres, robot.parcel.body)


def apart(timestep: float, drives: tuple[int, ...], steps: int) -> np.ndarray:
    """(len(drives), steps) m in C MuJoCo between the parcel after its release and a body of its own with a free joint,
    which begins with the pose and the velocity of the parcel at the hand."""
    robot, start, ctrl = planned()
    model = c_mujoco.reference_model(box_spec(), with_timestep(robot, timestep))
    parcel, substeps = model.body("robot/parcel").id, round(CONTROL_DT / timestep)
    scene = box_spec()
    body = scene.worldbody.add_body(name="free", mass=0.5, inertia=[0.5 * 0.12**2 / 6] * 3, ipos=[0.0] * 3)
    body.explicitinertial = True
    body.add_freejoint()
    for k in range(8):
        at = [0.03 if k >> i & 1 else -0.03 for i in range(3)]
        size, friction = [0.03, 0.0, 0.0], [0.6, 0.005, 0.0001]
        sphere = mujoco.mjtGeom.mjGEOM_SPHERE
        body.add_geom(type=sphere, pos=at, size=size, friction=friction, contype=0, conaffinity=1)
    scene.option.timestep, scene.option.cone = timestep, model.opt.cone
    alone = scene.compile()
    assert alone.body_mass[-1] == model.body_mass[parcel]
    np.testing.assert_allclose(alone.body_inertia[-1], model.body_inertia[parcel], rtol=1e-5)
    free, data, speed = mujoco.MjData(alone), mujoco.MjData(model), np.zeros(6)
    out = np.zeros((len(drives), steps))
    for row, i in enumerate(drives):
        mujoco.mj_resetData(model, data)
        mujoco.mj_resetData(alone, free)
        data.qpos[:] = start[i]
        for step in range(RELEASE + steps):
            data.ctrl[:] = ctrl[step, i]
            if step == RELEASE:
                mujoco.mj_forward(model, data)
                mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_BODY, parcel, speed, 0)
                free.qpos[:3], free.qpos[3:] = data.xpos[parcel], data.xquat[parcel]
                free.qvel[:3], free.qvel[3:] = speed[3:], data.xmat[parcel].reshape(3, 3).T @ speed[:3]
            for _ in range(substeps):
                mujoco.mj_step(model, data)
                if step >= RELEASE:
                    mujoco.mj_step(alone, free)
            if step >= RELEASE:
                mujoco.mj_kinematics(model, data)
                out[row, step - RELEASE] = np.linalg.norm(free.qpos[:3] - data.xpos[parcel])
    return out


@pytest.mark.extended
def test_a_released_parcel_is_a_free_body() -> None:
    """Released by a hand that stands, it falls into the box and lies there within 1 mm of a body that was never held.
    Beside a hand that swings and drives, coordinates turn with it: Euler's steps of 10 ms are 3 cm apart after a fall
    of 1 m, and those of 1 ms a tenth of that, so that it is an error of the integration, not of the joints."""
    assert apart(0.01, (0,), 14).max() < 1e-3
    coarse, fine = (apart(timestep, (1, len(PLACES) + DRIVES - 1), 4) for timestep in (0.01, 0.001))
    assert coarse.max() < 0.04
    assert (fine.max(1) < 0.15 * coarse.max(1)).all()


@pytest.mark.extended
def test_the_servos_hold_it_and_their_release_drops_it() -> None:
    """In C MuJoCo: within 1 cm and 0.1 rad of its place at the hand while held, also in a swinging arm, as long as it
    touches nothing; and what is released in the middle of a box lies in it, on its floor, with its weight."""
    robot, _, ctrl = planned()
    run = expected()
    held = (ctrl[:, :, 9:].min(-1) > 0.0) & (np.cumsum(run.force, 0) == 0.0)
    assert held.sum() > 0.6 * held.size
    assert np.abs(run.qpos[..., -7:-4])[held].max() < 0.01
    assert 2.0 * np.linalg.norm(run.qpos[..., -3:], axis=-1)[held].max() < 0.1
    assert robot.parcel.half_side == pytest.approx(0.06)
    for i in (0, 1):
        floor = BOXES[i].at(0.0) - [0.0, 0.0, 0.25]
        assert np.linalg.norm((run.place[-1, i] - floor)[:2]) < 0.1
        assert run.place[-1, i, 2] - floor[2] == pytest.approx(0.06, abs=2e-3)
    np.testing.assert_allclose(run.force[-1, :2], 0.5 * 9.81, rtol=1e-3)
    assert run.place[-1, -1, 2] < 0.15, "on the road"


@pytest.mark.parametrize("impl", ENGINES)
def test_a_parcel_is_held_and_falls_as_in_c_mujoco(impl: str) -> None:
    """Its place to 0.1 mm and its direction to 1 mrad until it touches something, and in the box for good; the arm's
    joints to 0.1 mrad."""
    run, reference = found(impl), expected()
    free = np.cumsum(reference.force, 0) == 0.0
    free[:, :2] = True
    assert free.sum() > 0.8 * free.size
    away = np.linalg.norm(run.place - reference.place, axis=-1)
    assert away[free].max() < 1e-4
    turned = 1.0 - np.abs((run.turn * reference.turn).sum(-1))
    assert turned[free].max() < 0.5 * (0.5 * 1e-3) ** 2 + 1e-6
    np.testing.assert_allclose(run.qpos[..., 11:16], reference.qpos[..., 11:16], atol=1e-4)


@pytest.mark.parametrize("impl", ENGINES)
def test_a_parcel_touches_boxes_and_ground_as_in_c_mujoco_and_hits_nothing(impl: str) -> None:
    """The force of every control step in a box to 0.05 N; what it does on a rim or the road, where it tumbles, to 1 cm
    for a second after its release and to 5 cm at the end; and no touch is a hit, in any engine."""
    run, reference = found(impl), expected()
    np.testing.assert_array_equal((run.force > 0.0).argmax(0), (reference.force > 0.0).argmax(0))
    np.testing.assert_allclose(run.force[:, :2], reference.force[:, :2], atol=0.05)
    away = np.linalg.norm(run.place - reference.place, axis=-1)
    assert away[: RELEASE + 11].max() < 0.01
    assert away.max() < 0.05
    assert not run.hit.any()
    assert not reference.hit.any()
