"""Go2Joystick: the contract of all environments, rewards computed by hand, levels, effects of disturbances."""

import copy
import dataclasses
import functools
import xml.etree.ElementTree as ET
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from ml_collections import ConfigDict

from tests.support.unsound import float_leaves, spoil, unsound
from urbanverse_mjx.datatypes import GroundRegion, SceneBank, ValidationError
from urbanverse_mjx.envs import JoystickEnv, Result, State, check_env, joystick_config, registry
from urbanverse_mjx.envs.joystick import terms
from urbanverse_mjx.envs.joystick.draws import draw_body, draw_command, draw_noise, draw_push
from urbanverse_mjx.envs.joystick.legs import Legs
from urbanverse_mjx.envs.joystick.schedule import TerrainLevels
from urbanverse_mjx.robots import make_go2
from urbanverse_mjx.robots.gait import sensor_frame
from urbanverse_mjx.scene.terrain import pack_regions, region_scene, terrain_regions

Compiled = tuple[Callable[..., State[Any]], Callable[..., State[Any]]]


#: m, middle of the ground of the scenes; not 0, where a wrong factor changes nothing.
MIDDLE = (2.0, -1.5)


def moved_ground(kind: str, level: int) -> list[GroundRegion]:
    """Regions of a terrain around `MIDDLE`."""
    dx, dy = MIDDLE
    return [
        dataclasses.replace(
            r,
            polygon=tuple((x + dx, y + dy) for x, y in r.polygon),
            plane=(r.plane[0], r.plane[1], r.plane[2] - r.plane[0] * dx - r.plane[1] * dy),
        )
        for r in terrain_regions(kind, level)
    ]


@functools.cache
def small_bank() -> SceneBank:
    """Two levels of level ground and of kerbs."""
    names = [(kind, level) for kind in ("flat", "kerbs") for level in (0, 1)]
    return pack_regions([region_scene(f"{k}-{n}", moved_ground(k, n)) for k, n in names])


def load(**overrides: Any) -> JoystickEnv:
    return registry.load("Go2Joystick", config_overrides={"impl": "jax", **overrides}, bank=small_bank())


@pytest.fixture(scope="module")
def calm() -> JoystickEnv:
    """Level ground, no randomisation of the robot; in Warp, which compiles faster."""
    return load(preset="cpu", impl="warp", **{"noise.scale": 0.0})


@pytest.fixture(scope="module")
def two_calm(calm: JoystickEnv) -> Compiled:
    """Its compiled `reset` and `step` for two envs."""
    return jax.jit(jax.vmap(calm.reset)), jax.jit(jax.vmap(calm.step))


@pytest.mark.slow
def test_it_keeps_every_promise() -> None:
    check_env(load(preset="fast", **{"terrain.first_levels": 2}), num_envs=4, num_steps=6)


@pytest.mark.extended
def test_an_episode_begins_near_the_standing_pose(calm: JoystickEnv, two_calm: Compiled) -> None:
    """Joints within 0.1 rad of it, drawn evenly, and all velocities of the base within 0.3."""
    states = [two_calm[0](jax.random.split(jax.random.key(k), 2)).data.sim for k in range(12)]
    joints = np.concatenate([np.asarray(s.qpos[:, 7:]) for s in states]) - np.asarray(calm._legs.stand)
    speeds = np.concatenate([np.asarray(s.qvel) for s in states])
    assert -0.1001 < joints.min() < -0.09
    assert 0.09 < joints.max() < 0.1001
    assert abs(joints.mean()) < 0.02
    assert 0.25 < np.abs(speeds[:, :6]).max() < 0.3001
    assert (speeds[:, 6:] == 0.0).all()
    away = np.concatenate([np.asarray(s.qpos[:, :2]) for s in states]) - MIDDLE
    reach = joystick_config().terrain.start_range
    assert 0.8 * reach < np.abs(away).max() < reach + 0.01, "around the middle of the ground"


@pytest.mark.extended
def test_standing_still_earns_more_than_falling(two_calm: Compiled) -> None:
    """A robot that holds its pose lasts and stays where it is; one that lies down has fallen."""
    reset, step = two_calm
    state = reset(jax.random.split(jax.random.key(0), 2))
    # The second folds its legs: thighs back, knees bent.
    fold = jnp.tile(jnp.array([0.0, 1.0, -1.0]), 4)
    action = jnp.stack([jnp.zeros(12), fold])
    first = np.asarray(state.data.sim.xpos[:, 1])
    rewards, ended = [], np.zeros(2, bool)
    for _ in range(40):
        state = step(state, action)
        rewards.append(np.where(ended, 0.0, np.asarray(state.reward)))
        ended |= np.asarray(state.done) > 0
    assert list(ended) == [False, True]
    assert int(state.data.result[0]) == Result.RUNNING
    assert np.sum(rewards, 0)[0] > np.sum(rewards, 0)[1]
    now = np.asarray(state.data.sim.xpos[:, 1])
    assert np.linalg.norm(now[0, :2] - first[0, :2]) < 0.15
    assert 0.25 < now[0, 2] < 0.33
    # The four feet carry the robot: 15.2 kg.
    assert float(state.data.sim.contacts.foot_force[0].sum()) == pytest.approx(15.206 * 9.81, rel=0.1)


def test_an_episode_begins_at_nothing_and_counts_the_asked_distance(two_calm: Compiled) -> None:
    """A turn on the spot asks for no distance."""
    reset, step = two_calm
    state = reset(jax.random.split(jax.random.key(0), 2))
    for name in ("distance", "distance_asked", "steps", "air_time", "action", "joint_speed"):
        np.testing.assert_array_equal(np.asarray(getattr(state.data, name)), 0.0, err_msg=name)
    command = jnp.array([[0.3, -0.4, 1.0], [0.0, 0.0, 1.0]])
    given = dataclasses.replace(state, data=state.data._replace(command=command))
    after = step(given, jnp.zeros((2, 12)))
    ctrl_dt = joystick_config().ctrl_dt
    np.testing.assert_allclose(after.data.distance_asked, [0.5 * ctrl_dt, 0.0], atol=1e-6)


def test_nothing_leaves_a_step_that_is_no_number(two_calm: Compiled) -> None:
    reset, step = two_calm
    state, rng = reset(jax.random.split(jax.random.key(0), 2)), np.random.default_rng(0)
    action = jnp.zeros((2, 12)).at[0, 3].set(jnp.nan)
    for leaf in range(len(float_leaves(state.data))):
        after = step(dataclasses.replace(state, data=spoil(state.data, rng, [1], leaf)), action)
        assert unsound(after) == [], leaf
        assert after.info["result"].tolist() == [Result.RUNNING, Result.NON_FINITE], leaf


def test_what_the_policy_sees_is_the_sensor_frame(calm: JoystickEnv) -> None:
    state = jax.jit(calm.reset)(jax.random.key(3))
    sim = state.data.sim
    x = np.asarray(sim.xquat[1], np.float64)
    up = [2 * (x[1] * x[3] - x[0] * x[2]), 2 * (x[2] * x[3] + x[0] * x[1]), 1 - 2 * (x[1] ** 2 + x[2] ** 2)]
    stand = calm.mj_model.key_qpos[0, 7:]
    frame = sensor_frame(
        np, sim.qvel[3:6], -np.array(up), sim.qpos[7:] - stand, sim.qvel[6:], state.data.command, np.zeros(12)
    )
    np.testing.assert_allclose(np.asarray(state.obs["history"]).reshape(5, 45), np.tile(frame, (5, 1)), atol=1e-5)


def test_terms_by_hand() -> None:
    stand, limits = jnp.zeros(12), jnp.tile(jnp.array([-1.0, 1.0]), (12, 1))
    motion = terms.Motion(
        linear=jnp.array([0.5, 0.0, 0.1]),
        angular=jnp.array([0.2, 0.0, 0.3]),
        up=jnp.array([0.1, 0.0, 0.995]),
        height=jnp.float32(0.28),
        joints=jnp.zeros(12).at[0].set(0.97),
        joint_speed=jnp.zeros(12).at[jnp.array([4, 5])].set(15.0),
        joint_acceleration=jnp.full(12, 10.0),
        torque=jnp.full(12, 2.0),
        foot_height=jnp.array([0.0, 0.04, 0.2, 0.0]),
        foot_speed=jnp.array([0.1, 1.0, 1.0, 0.0]),
        contact=jnp.array([True, False, False, True]),
        air_time=jnp.array([0.0, 0.1, 0.1, 0.4]),
        landed=jnp.array([False, False, False, True]),
        touch=jnp.float32(0.25),
        action=jnp.full(12, 0.1),
        last_action=jnp.zeros(12),
        fell=jnp.bool_(False),
        command=jnp.array([1.0, 0.0, 0.3]),
    )
    config = joystick_config().reward_config
    found = {name: float(x) for name, x in terms.terms(motion, config, stand, limits).items()}
    assert set(found) == {*config.scales, "single_stance"}  # that of robots with two legs
    expected = {
        "track_linear": np.exp(-0.25 / 0.25),
        "track_angular": 1.0,
        "vertical_speed": 0.01,
        "roll_pitch_rate": 0.04,
        "tilt": 0.01,
        "trunk_height": 0.0004,
        "torque": 48.0,
        "acceleration": 1200.0,
        "action_rate": 0.12,
        "pose": np.exp(-(0.97**2)),
        "stand_still": 0.0,
        "joint_limits": 0.02,
        "joint_speed": 15.0 - 0.9 * 15.7,  # of the knee alone
        "foot_clearance": 0.1 * 0.1 + 0.06 * 1.0,
        "foot_slip": 0.01,
        "air_time": 0.2,
        "single_stance": 0.0,
        "touch": 0.25,
        "fall": 0.0,
    }
    for name, value in expected.items():
        assert found[name] == pytest.approx(value, rel=1e-4, abs=1e-6), name


def test_commands_are_what_the_config_says() -> None:
    config = joystick_config().command
    command, hold = jax.vmap(lambda k: draw_command(k, config))(jax.random.split(jax.random.key(0), 4000))
    command, still = np.asarray(command), np.asarray((command == 0).all(1))
    assert still.mean() == pytest.approx(0.1, abs=0.02)
    ahead = (command[:, 1] == 0) & ~still
    assert ahead.mean() == pytest.approx(0.4, abs=0.03)
    assert command[ahead, 0].min() >= 0.4
    assert (np.abs(command).max(0) <= [1.0, 0.5, 1.0]).all()
    assert (np.abs(command).max(0) > [0.98, 0.48, 0.98]).all()
    assert 3.0 <= float(hold.min()) < float(hold.max()) <= 8.0


def test_bodies_differ_by_what_the_config_says() -> None:
    config = joystick_config().randomization
    found = jax.vmap(lambda key: draw_body(key, config, 12))(jax.random.split(jax.random.key(0), 2000))
    for name in ("friction_scale", "mass_scale", "strength"):
        low, high = config[name]
        np.testing.assert_allclose(
            np.percentile(getattr(found, name), [0, 50, 100]), [low, (low + high) / 2, high], 0.03
        )
    bias = np.asarray(found.joint_bias)
    np.testing.assert_allclose([bias.min(), bias.max()], [-config.joint_bias, config.joint_bias], rtol=0.01)
    assert np.abs(bias.mean(0)).max() < 0.06 * config.joint_bias
    assert np.asarray(found.delay).mean() == pytest.approx(config.delay_share, abs=0.05)


def test_pushes_come_as_often_and_as_hard_as_asked() -> None:
    config = joystick_config().randomization
    kicks = np.asarray(jax.vmap(lambda k: draw_push(k, config, 0.02))(jax.random.split(jax.random.key(1), 60_000)))
    hit = np.abs(kicks).any(1)
    assert hit.mean() == pytest.approx(0.02 / 6.0, rel=0.2)
    speed = np.linalg.norm(kicks[hit, :2], axis=1)
    assert 0.6 < speed.max() <= 0.8
    assert (kicks[:, 2:5] == 0).all()


@pytest.mark.parametrize("scale", [0.0, 0.5, 1.0])
def test_noise_of_sensors_is_as_wide_as_asked(scale: float) -> None:
    """Uniform and apart for angular velocity, gravity, joint angles and joint speeds, in this order."""
    config = ConfigDict({"scale": scale, "angular_velocity": 0.2, "gravity": 0.05, "joint_position": 0.03})
    config.joint_velocity = 1.5
    found = np.asarray(jax.vmap(lambda k: draw_noise(k, config, 4))(jax.random.split(jax.random.key(0), 3000)))
    width = scale * np.array([0.2] * 3 + [0.05] * 3 + [0.03] * 4 + [1.5] * 4)
    assert found.shape == (3000, 14)
    assert (np.abs(np.median(found, axis=0)) <= 0.06 * width).all()
    np.testing.assert_allclose(np.abs(found).max(0), width, rtol=0.01)
    np.testing.assert_allclose(found.std(0), width / np.sqrt(3.0), rtol=0.05)
    if scale:
        assert np.abs(np.corrcoef(found.T) - np.identity(14)).max() < 0.1


def test_levels_rise_and_fall() -> None:
    levels = TerrainLevels(small_bank(), joystick_config().terrain)
    assert levels.kinds == ("flat", "kerbs")
    now = jnp.array([0, 1], jnp.int32)

    def after(kind: int, lasted: bool, distance: float, asked: float) -> list[int]:
        found = levels.after(
            jax.random.key(0), now, jnp.int32(kind), jnp.bool_(lasted), jnp.float32(distance), jnp.float32(asked)
        )
        return [int(x) for x in found]

    assert after(0, True, 4.0, 5.0) == [1, 1]
    assert after(0, True, 3.0, 5.0) == [0, 1]
    assert after(1, True, 1.0, 5.0) == [0, 0]
    assert after(1, False, 5.0, 5.0) == [0, 0]
    assert after(1, True, 1.0, 1.0) == [0, 1], "a short path says nothing"
    assert after(0, False, 0.0, 5.0) == [0, 1], "there is nothing below the first level"
    assert after(1, True, 5.0, 5.0)[1] in (0, 1), "behind the last level any may come"


def test_episodes_are_on_the_kinds_and_levels_chosen() -> None:
    levels = TerrainLevels(small_bank(), joystick_config().terrain)
    keys = jax.random.split(jax.random.key(0), 600)
    kind, scene = jax.vmap(levels.choose, (0, None))(keys, jnp.array([1, 0], jnp.int32))
    # Shares 0.2 and 0.4 of kinds that the bank has.
    assert float(jnp.mean(kind == 1)) == pytest.approx(2 / 3, abs=0.06)
    names = [small_bank().scene_ids[int(s)] for s in scene]
    assert set(names) == {"flat-1", "kerbs-0"}
    with pytest.raises(ValidationError, match="needed terrains"):
        TerrainLevels(pack_regions([region_scene("flat-1", terrain_regions("flat", 1))]), joystick_config().terrain)


def without_keyframe(model: ET.Element) -> None:
    model.remove(model.findall("keyframe")[0])


def without_the_last_servo(model: ET.Element) -> None:
    servos, key = model.findall("actuator")[0], model.findall("keyframe/key")[0]
    servos.remove(servos[-1])
    key.attrib.pop("ctrl", None)


def with_servos_in_another_order(model: ET.Element) -> None:
    servos = model.findall("actuator")[0]
    one, other = servos[0], servos[1]
    one.attrib["joint"], other.attrib["joint"] = other.attrib["joint"], one.attrib["joint"]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (without_keyframe, "12 actuators for 12 joints and 0 keyframes"),
        (without_the_last_servo, "11 actuators for 12 joints and 1 keyframes"),
        (with_servos_in_another_order, "12 actuators for 12 joints and 1 keyframes"),
    ],
)
def test_legs_without_a_servo_for_each_joint_in_order_or_a_standing_pose_are_refused(
    change: Callable[[ET.Element], None], said: str
) -> None:
    robot = copy.copy(make_go2())
    assert Legs(robot, (0.4, 1.0, 1.0)).number == 12
    model = ET.fromstring(robot.mjcf)
    change(model)
    # As a description that was checked already, whose text is now another.
    object.__setattr__(robot, "mjcf", ET.tostring(model, encoding="unicode"))
    with pytest.raises(ValidationError, match=f"found {said}, needed a position servo for each joint, in their order"):
        Legs(robot, (0.4, 1.0, 1.0))


def test_presets() -> None:
    assert registry.get_default_config("Go2Joystick").preset == "fast"
    with pytest.raises(ValidationError, match="needed one of fast, cpu"):
        registry.get_default_config("Go2Joystick", "paper")
