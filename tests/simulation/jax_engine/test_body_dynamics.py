"""Free bodies of the JAX engine against those of C MuJoCo: mass, acceleration, and a step of their motion."""

import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.simulation.collision_slots.body_slots import Awake
from urbanverse_mjx.simulation.jax_engine import body_dynamics

BODIES = """
<mujoco>
  <option timestep="0.004"/>
  <worldbody>
    <body><freejoint/><inertial pos="0 0 0" mass="12" fullinertia="0.9 0.5 0.7 0.1 -0.05 0.2"/></body>
    <body><freejoint/><inertial pos="0 0 0" mass="3" fullinertia="0.02 0.05 0.04 0 0.01 -0.005"/></body>
  </worldbody>
</mujoco>
"""


@pytest.fixture
def tumbling() -> tuple[mujoco.MjModel, mujoco.MjData, Awake, body_dynamics.Matter]:
    model = mujoco.MjModel.from_xml_string(BODIES)
    data = mujoco.MjData(model)
    rng = np.random.default_rng(4)
    for w in range(2):
        turn = rng.normal(size=4)
        data.qpos[7 * w : 7 * w + 7] = [*rng.uniform(-2.0, 2.0, 3), *(turn / np.linalg.norm(turn))]
        data.qvel[6 * w : 6 * w + 6] = [*rng.uniform(-1.0, 1.0, 3), *rng.uniform(-6.0, 6.0, 3)]
    mujoco.mj_forward(model, data)
    qpos, qvel = data.qpos.reshape(2, 7).copy(), data.qvel.reshape(2, 6).copy()
    axes = data.xmat[1:].reshape(2, 3, 3)
    spin = np.einsum("wij,wj->wi", axes, qvel[:, 3:])  # C MuJoCo's are in the frame of the body
    own = np.array([rotations.matrix(q) for q in model.body_iquat[1:]])
    moments = np.einsum("wij,wj,wkj->wik", own, model.body_inertia[1:], own)
    none = jnp.zeros((2, 1))
    made = [jnp.asarray(x, jnp.float32) for x in (qpos[:, :3], qpos[:, 3:], qvel[:, :3], spin)]
    awake = Awake(jnp.arange(2), jnp.arange(2), made[0], made[1], made[2], made[3], jnp.zeros((2, 6)))
    mass = jnp.asarray(model.body_mass[1:], jnp.float32)
    matter = body_dynamics.Matter(mass, jnp.asarray(moments, jnp.float32), none[:, 0], none, none, none)
    return model, data, awake, matter


def world(data: mujoco.MjData, columns: np.ndarray) -> np.ndarray:
    """(2, 6), velocities or accelerations (12,) of C MuJoCo with their turns in the frame of the world."""
    rows = columns.reshape(2, 6).copy()
    rows[:, 3:] = np.einsum("wij,wj->wi", data.xmat[1:].reshape(2, 3, 3), rows[:, 3:])
    return rows


def test_accelerations_are_those_of_c_mujoco(
    tumbling: tuple[mujoco.MjModel, mujoco.MjData, Awake, body_dynamics.Matter],
) -> None:
    _, data, awake, matter = tumbling
    found = body_dynamics.free_acceleration(awake, matter).reshape(2, 6)
    np.testing.assert_allclose(found, world(data, data.qacc), rtol=1e-4, atol=1e-3)
    np.testing.assert_allclose(body_dynamics.velocities(awake).reshape(2, 6), world(data, data.qvel), atol=1e-5)
    assert np.abs(np.asarray(found)[:, 3:]).max() > 3.0
    empty = body_dynamics.free_acceleration(awake._replace(row=jnp.array([0, -1])), matter).reshape(2, 6)
    np.testing.assert_allclose(empty[:, 2], [-9.81, 0.0], atol=1e-5)


def test_masses_are_those_of_c_mujoco(
    tumbling: tuple[mujoco.MjModel, mujoco.MjData, Awake, body_dynamics.Matter],
) -> None:
    model, data, awake, matter = tumbling
    whole = np.zeros((12, 12))
    for column, unit in zip(whole, np.identity(12), strict=True):
        mujoco.mj_mulM(model, data, column, unit)
    turn = np.zeros((12, 12))
    for w, axes in enumerate(data.xmat[1:].reshape(2, 3, 3)):
        turn[6 * w : 6 * w + 3, 6 * w : 6 * w + 3], turn[6 * w + 3 : 6 * w + 6, 6 * w + 3 : 6 * w + 6] = (
            np.identity(3),
            axes,
        )
    robot = jnp.array([[5.0, 1.0], [1.0, 4.0]])
    found = np.asarray(body_dynamics.joint_mass(robot, awake, matter))
    np.testing.assert_allclose(found[:2, :2], robot)
    np.testing.assert_allclose(found[2:, 2:], turn @ whole @ turn.T, rtol=1e-4, atol=1e-5)
    assert not found[:2, 2:].any()
    assert not found[2:, :2].any()


def test_steps_are_those_of_c_mujoco(
    tumbling: tuple[mujoco.MjModel, mujoco.MjData, Awake, body_dynamics.Matter],
) -> None:
    model, data, awake, matter = tumbling
    for _ in range(5):
        mujoco.mj_step(model, data)
        acceleration = body_dynamics.free_acceleration(awake, matter)
        awake = body_dynamics.moved(awake, acceleration, model.opt.timestep)
        np.testing.assert_allclose(awake.warm.reshape(-1), acceleration)
    mujoco.mj_kinematics(model, data)
    qpos = data.qpos.reshape(2, 7)
    np.testing.assert_allclose(awake.place, qpos[:, :3], atol=1e-4)
    np.testing.assert_allclose(np.abs((np.asarray(awake.quaternion) * qpos[:, 3:]).sum(1)), 1.0, atol=1e-6)
    turned = [rotations.matrix(np.asarray(q, float)) for q in awake.quaternion]
    np.testing.assert_allclose(turned, data.xmat[1:].reshape(2, 3, 3), atol=2e-3)
    np.testing.assert_allclose(awake.velocity, world(data, data.qvel)[:, :3], atol=1e-4)
    np.testing.assert_allclose(awake.spin, world(data, data.qvel)[:, 3:], rtol=1e-3, atol=1e-2)


def test_contacts_of_the_robot_push_the_body_whose_hull_they_touch_and_no_other(
    tumbling: tuple[mujoco.MjModel, mujoco.MjData, Awake, body_dynamics.Matter],
) -> None:
    """Velocities of points of the bodies against C MuJoCo's; other slots and none belong to no body."""
    model, data, awake, matter = tumbling
    hulls = 3
    matter = matter._replace(hull=jnp.zeros((2, hulls), jnp.int32))
    slots = np.arange(-1, 9)
    rng = np.random.default_rng(2)
    points, axes = rng.uniform(-2.0, 2.0, (len(slots), 3)), np.tile(np.identity(3), (len(slots), 1, 1))
    effect = body_dynamics.pushed(jnp.asarray(slots), awake, matter)
    columns = np.asarray(effect.columns(jnp.asarray(axes, jnp.float32), jnp.asarray(points, jnp.float32)))
    weight = np.asarray(effect.weight())
    for k, slot in enumerate(slots):
        expected, inverse = np.zeros((3, 12)), 0.0
        if 0 <= slot < 2 * hulls:
            body = slot // hulls
            place, turn = np.zeros((3, 12)), np.zeros((3, 12))
            mujoco.mj_jac(model, data, place, turn, points[k], body + 1)
            # From the frame of the body to that of the world, as the engine has spins.
            place[:, 6 * body + 3 : 6 * body + 6] @= data.xmat[body + 1].reshape(3, 3).T
            expected, inverse = place, 1.0 / float(model.body_mass[body + 1])
        np.testing.assert_allclose(columns[k], expected, atol=1e-4)
        assert weight[k] == pytest.approx(inverse, rel=1e-5)
