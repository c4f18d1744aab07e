"""COCO with a parcel at its arm's hand: what it is made of, and the arm's kinematics with it."""

import dataclasses

import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from urbanverse_mjx.datatypes import Parcel, ValidationError
from urbanverse_mjx.robots import make_coco_arm, make_coco_parcel
from urbanverse_mjx.robots.arm_reach import ArmReach
from urbanverse_mjx.robots.coco_parcel import AHEAD, HALF_SIDE, MASS

ROBOT, ARM = make_coco_parcel(), make_coco_arm()
MODEL = mujoco.MjModel.from_xml_string(ROBOT.mjcf)
PARCEL = ROBOT.parcel or Parcel("none", (), (), 1.0, 0.0)


def test_it_is_coco_with_an_arm_and_a_carton_of_12_cm() -> None:
    """Its mass and that of a homogeneous cube's moments of inertia, and no more than a gram besides."""
    arm = mujoco.MjModel.from_xml_string(ARM.mjcf)
    assert MODEL.body_mass.sum() - arm.body_mass.sum() == pytest.approx(MASS, abs=1e-3)
    body = MODEL.body(PARCEL.body)
    np.testing.assert_allclose(body.inertia, MASS * 0.12**2 / 6.0, rtol=1e-6)
    assert MODEL.nv == arm.nv + 6 <= 32
    assert MODEL.nq == arm.nq + 7
    np.testing.assert_array_equal(MODEL.key_qpos[0], [*arm.key_qpos[0], 0, 0, 0, 1, 0, 0, 0])
    assert ROBOT.foot_geoms == (*ARM.foot_geoms, *PARCEL.spheres)
    assert ROBOT.circumradius == pytest.approx(ARM.circumradius + 0.12)


def test_its_spheres_fill_its_corners() -> None:
    """Each touches three faces and its three neighbours."""
    places = np.array([MODEL.geom(name).pos for name in PARCEL.spheres])
    radii = np.array([MODEL.geom(name).size[0] for name in PARCEL.spheres])
    np.testing.assert_allclose(np.abs(places) + radii[:, None], HALF_SIDE)
    apart = np.linalg.norm(places[:, None] - places[None], axis=-1) - radii[:, None] - radii[None]
    assert ((np.abs(apart) < 1e-9).sum(1) == 3).all()


def test_a_command_drives_the_base_and_holds_the_parcel() -> None:
    command = np.asarray(ROBOT.command(np.array([0.5, 0.2])))
    assert len(command) == MODEL.nu == len(set(PARCEL.actuators)) + len(np.asarray(ARM.command(np.zeros(2))))
    np.testing.assert_array_equal(command[list(PARCEL.actuators)], 1.0)
    np.testing.assert_allclose(command[: PARCEL.actuators[0]], ARM.command(np.array([0.5, 0.2])))


def test_a_held_parcel_is_pulled_back_and_a_released_one_is_not() -> None:
    """The forces of the six servos at a displaced parcel, against stiffness times displacement of each axis."""
    data = mujoco.MjData(MODEL)
    mujoco.mj_resetDataKeyframe(MODEL, data, 0)
    turn = np.array([0.02, -0.05, 0.03])
    data.qpos[-7:-4] = 0.01, -0.02, 0.03
    mujoco.mju_axisAngle2Quat(data.qpos[-4:], turn / np.linalg.norm(turn), np.linalg.norm(turn))
    for held in (1.0, 0.0):
        data.ctrl[list(PARCEL.actuators)] = held
        mujoco.mj_forward(MODEL, data)
        expected = -held * 60.0**2 * np.append(MASS * data.qpos[-7:-4], MASS * 0.12**2 / 6.0 * turn)
        np.testing.assert_allclose(data.qfrc_actuator[-6:], expected, rtol=1e-5, atol=1e-9)


def test_the_arms_kinematics_reach_to_the_parcel() -> None:
    """Place and carried weight at the parcel's middle, against MuJoCo's; the direction is that of the hand."""
    reach, data = ArmReach(ROBOT, PARCEL.ahead), mujoco.MjData(MODEL)
    mujoco.mj_resetDataKeyframe(MODEL, data, 0)
    data.qpos[:3], data.qpos[reach.addresses] = 0.0, (0.4, -0.5, 0.3, 0.7, 0.2)
    mujoco.mj_forward(MODEL, data)
    pose = reach.pose(jnp.asarray(data.qpos[reach.addresses], jnp.float32))
    np.testing.assert_allclose(pose.tip, data.xpos[MODEL.body(PARCEL.body).id], atol=1e-5)
    np.testing.assert_allclose(
        pose.tip - ArmReach(ROBOT).pose(data.qpos[reach.addresses]).tip, AHEAD * pose.hand, atol=1e-5
    )
    lifted = reach.holding(pose, np.array([0.0, 0.0, 9.81 * MASS], np.float32))
    np.testing.assert_allclose(lifted, data.qfrc_bias[reach.speeds], atol=1e-3)


def test_a_wrong_parcel_is_refused_in_a_sentence() -> None:
    with pytest.raises(ValidationError, match=r"parcel.half_side: found 0.0, needed a number greater than 0"):
        Parcel("parcel", (), (), 0.0, 0.1)
    with pytest.raises(ValidationError, match=r"parcel.spheres: found 'corner', needed names of its foot_geoms"):
        dataclasses.replace(ROBOT, parcel=Parcel("parcel", ("corner",), (), 0.1, 0.1))
