"""COCO's arm: what it is made of, and its kinematics against MuJoCo's."""

import dataclasses

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from urbanverse_mjx.datatypes import Arm, ValidationError
from urbanverse_mjx.robots import make_coco, make_coco_arm
from urbanverse_mjx.robots.arm_body import Part, joined
from urbanverse_mjx.robots.arm_reach import ArmReach
from urbanverse_mjx.robots.start import start

ROBOT = make_coco_arm()
MODEL = mujoco.MjModel.from_xml_string(ROBOT.mjcf)


def test_it_is_coco_with_the_arms_links() -> None:
    """Masses of vx300.urdf.xacro: foot, shoulder, upper arm, forearm, wrist, and the five parts of the hand."""
    coco = mujoco.MjModel.from_xml_string(make_coco().mjcf)
    hand = 0.097666 + 0.008009 + 0.150986 + 2 * 0.034796
    arm = 0.969034 + 0.798614 + 0.792592 + 0.544659 + 0.115395 + hand
    assert MODEL.body_mass.sum() - coco.body_mass.sum() == pytest.approx(arm, abs=1e-6)
    assert MODEL.nv == coco.nv + 5 <= 32
    assert [MODEL.joint(name).range.tolist() for name in ("shoulder", "elbow")] == [
        pytest.approx(np.radians([-106.0, 72.0]), abs=1e-5),
        pytest.approx(np.radians([-101.0, 92.0]), abs=1e-5),
    ]


def test_parts_are_joined_by_the_theorem_of_parallel_axes() -> None:
    """Two points of 1 and 3 kg, 4 m apart: the middle at 3 m, and m1 m2 / (m1 + m2) d^2 = 12 kg m^2 across."""
    one, other = Part(1.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)), Part(3.0, (4.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    whole, inertia = joined((one, other))
    assert whole == Part(4.0, (3.0, 0.0, 0.0), (0.0, 12.0, 12.0))
    np.testing.assert_allclose(inertia, np.diag([0.0, 12.0, 12.0]))


def test_it_drives_on_its_wheels_and_keeps_the_arm_folded_within_its_base() -> None:
    data = mujoco.MjData(MODEL)
    mujoco.mj_resetDataKeyframe(MODEL, data, 0)
    mujoco.mj_kinematics(MODEL, data)
    tip = data.geom_xpos[MODEL.geom("fingertip").id]
    assert abs(tip[0]) + 0.012 < 0.36
    assert tip[2] > 0.6
    command = np.asarray(ROBOT.command(np.array([5.0, 0.2])))
    np.testing.assert_allclose(command[4:], ROBOT.arm.folded if ROBOT.arm else (), atol=1e-6)
    fast = np.asarray(ROBOT.command(np.array([ROBOT.max_speed, 0.2])))
    np.testing.assert_array_equal(command, fast, "faster than it drives")
    assert start(ROBOT) is None, "no wheel drive of a description"


def test_kinematics_and_torques_are_those_of_mujoco() -> None:
    reach, data, rng = ArmReach(ROBOT), mujoco.MjData(MODEL), np.random.default_rng(0)
    tip, jacobian = MODEL.geom("fingertip"), np.zeros((3, MODEL.nv))
    for _ in range(4):
        angles = rng.uniform(reach.low, reach.high)
        mujoco.mj_resetDataKeyframe(MODEL, data, 0)
        data.qpos[:3], data.qpos[reach.addresses] = 0.0, angles
        mujoco.mj_forward(MODEL, data)
        mujoco.mj_jac(MODEL, data, jacobian, None, data.geom_xpos[tip.id], tip.bodyid[0])
        pose = reach.pose(jnp.asarray(angles, jnp.float32))
        np.testing.assert_allclose(pose.tip, data.geom_xpos[tip.id], atol=1e-5)
        np.testing.assert_allclose(pose.jacobian(), jacobian[:, reach.speeds], atol=1e-5)
        np.testing.assert_allclose(reach.holding(pose), data.qfrc_bias[reach.speeds], atol=1e-4)
        force = np.array([3.0, -4.0, 5.0], np.float32)
        more = reach.holding(pose, force) - reach.holding(pose)
        np.testing.assert_allclose(more, jacobian[:, reach.speeds].T @ force, atol=1e-4)


def test_it_reaches_all_buttons_from_where_it_stands() -> None:
    """Buttons of 0.9 to 1.2 m, 0.6 to 0.7 m before the robot's origin and up to 0.1 m beside, with a level hand."""
    reach = ArmReach(ROBOT)
    solve = jax.jit(jax.vmap(reach.solve, (None, 0, 0)))
    grid = np.meshgrid([0.6, 0.65, 0.7], [-0.1, 0.0, 0.1], [0.9, 1.05, 1.2], indexing="ij")
    places = np.stack(grid, -1).reshape(-1, 3) - (0.012, 0.0, ROBOT.spawn_height)
    level = places - (0.2, 0.0, 0.0)
    level[:, 2] = 0.0
    level /= np.linalg.norm(level, axis=1, keepdims=True)
    found, left = solve(jnp.array([0.0, -0.3, 0.0, 0.3, 0.0]), *(jnp.asarray(x, jnp.float32) for x in (places, level)))
    assert float(left.max()) < 1e-3
    hand = jax.vmap(lambda q: reach.pose(q).hand)(found)
    assert float((hand * level).sum(-1).min()) > 0.999
    _, far = reach.solve(jnp.zeros(5), jnp.array([2.0, 0.0, 0.5]), jnp.array([1.0, 0.0, 0.0]))
    assert float(far) > 0.5, "out of reach, and said so"


def test_a_wrong_arm_is_refused_in_a_sentence() -> None:
    with pytest.raises(ValidationError, match="robot 'coco_differential': found no arm"):
        ArmReach(make_coco())
    with pytest.raises(ValidationError, match=r"arm: found \(2, 1, 2\) joints, actuators and angles"):
        Arm(("a", "b"), (0,), (0.0, 0.0), "tip", 1.0)
    with pytest.raises(ValidationError, match=r"arm.tip: found 'hand', needed one of its foot_geoms"):
        dataclasses.replace(ROBOT, arm=Arm(("a",), (0,), (0.0,), "hand", 1.0))
