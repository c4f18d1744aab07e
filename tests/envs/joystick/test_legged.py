"""The joystick environments of robots with legs other than the Go2: their configs, feet of several spheres, a step."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.envs.joystick.test_env import small_bank
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.envs import JoystickEnv, check_env, registry
from urbanverse_mjx.envs.joystick import terms
from urbanverse_mjx.envs.joystick.config import joystick_config, legged_joystick_config
from urbanverse_mjx.envs.joystick.legs import Legs
from urbanverse_mjx.robots import legged, load

WALKERS = ("mini_cheetah", "b2", "g1")
#: Those whose gaits are shipped.
SHIPPED = ("mini_cheetah", "b2", "g1")


def load_env(name: str, **overrides: object) -> JoystickEnv:
    overrides = {"preset": "cpu", "impl": "warp-fused", "noise.scale": 0.0, **overrides}
    env = registry.load(legged.joystick_name(name), config_overrides=overrides, bank=small_bank())
    assert isinstance(env, JoystickEnv)
    return env


@pytest.mark.parametrize("name", WALKERS)
def test_the_task_is_the_go2s_with_the_robots_own_numbers(name: str) -> None:
    row, go2 = legged.row(name), joystick_config("fast").to_dict()
    config = registry.get_default_config(legged.joystick_name(name), "fast").to_dict()
    assert row.walk is not None
    assert config["robot"] == name
    assert config["action_scale"] == tuple(link.scale for link in row.links)
    assert config["reward_config"]["motor_speed"] == tuple(link.speed for link in row.links)
    assert config["reward_config"]["pose_weights"] == tuple(link.pose for link in row.links)
    assert config["lowest"] < config["reward_config"]["trunk_height"] < row.spawn
    # What standing costs in torque is of the order of the Go2's: m g times a lever that grows with the height.
    ratio = (row.mass * row.spawn / (15.2 * 0.33)) ** 2
    assert config["reward_config"]["scales"]["torque"] * ratio == pytest.approx(-1e-4)
    same = ("ctrl_dt", "sim_dt", "history", "episode_length", "noise", "randomization")
    assert {key: config[key] for key in same} == {key: go2[key] for key in same}
    biped = len(row.legs) == 2
    assert ("single_stance" in config["reward_config"]["scales"]) == biped
    assert sum(config["terrain"]["shares"].values()) == pytest.approx(1.0)


def test_a_robot_that_drives_has_no_such_task_and_one_that_walks_no_street_without_a_gait() -> None:
    with pytest.raises(ValidationError, match="needed a robot that learns a gait"):
        legged_joystick_config("go2w")
    assert "Go2WNav" in registry.ALL_ENVS
    assert "Go2WJoystick" not in registry.ALL_ENVS
    for name in WALKERS:
        street = legged.joystick_name(name).replace("Joystick", "Nav")
        assert (street in registry.ALL_ENVS) == legged.gait_path(name).is_file() == (name in SHIPPED)


def test_a_foot_of_four_spheres_is_one_foot() -> None:
    robot = load("g1")
    legs = Legs(robot, registry.get_default_config("G1Joystick").action_scale)
    assert legs.spheres.shape == (2, 4)
    assert [legs.model.body(body).name for body in legs.foot_body] == ["L_ankle_roll", "R_ankle_roll"]
    for foot, rows in zip("LR", legs.spheres, strict=True):
        assert all(robot.foot_geoms[row].startswith(f"{foot}_foot") for row in rows)
    np.testing.assert_allclose(legs.foot_place[0], (0.035, 0.0, -0.025), atol=1e-6)
    assert legs.number == 12
    np.testing.assert_allclose(legs.scale[6:], legs.scale[:6])


def test_single_stance_rewards_one_foot_in_the_air() -> None:
    config = registry.get_default_config("G1Joystick").reward_config
    stand = jnp.zeros(12)
    limits = jnp.tile(jnp.array([[-1.0, 1.0]]), (12, 1))

    def reward(contact: tuple[bool, bool], air: tuple[float, float], command: tuple[float, ...]) -> float:
        motion = terms.Motion(
            linear=jnp.zeros(3), angular=jnp.zeros(3), up=jnp.array([0.0, 0.0, 1.0]), height=jnp.float32(0.76),
            joints=stand, joint_speed=stand, joint_acceleration=stand, torque=stand, foot_height=jnp.zeros(2),
            foot_speed=jnp.zeros(2), contact=jnp.array(contact), air_time=jnp.array(air), landed=jnp.zeros(2, bool),
            touch=jnp.float32(0.0), action=stand, last_action=stand, fell=jnp.bool_(False),
            command=jnp.array(command),
        )  # fmt: skip
        return float(terms.terms(motion, config, stand, limits)["single_stance"])

    ahead = (0.5, 0.0, 0.0)
    assert reward((True, False), (0.0, 0.3), ahead) == pytest.approx(0.3)
    assert reward((True, False), (0.0, 0.9), ahead) == pytest.approx(terms.MAX_STEP_TIME)
    assert reward((False, False), (0.2, 0.3), ahead) == 0.0, "a jump"
    assert reward((True, True), (0.1, 0.0), ahead) == 0.0
    assert reward((True, False), (0.0, 0.3), (0.0, 0.0, 0.0)) == 0.0


@pytest.mark.extended
def test_a_humanoid_stands_on_its_soles_and_falls_without_a_gait() -> None:
    env = load_env("g1")
    reset, step = jax.jit(jax.vmap(env.reset)), jax.jit(jax.vmap(env.step))
    state = reset(jax.random.split(jax.random.key(0), 2))
    assert state.obs["history"].shape == (2, 5 * 45)
    forces, falls = [], []
    for _ in range(90):
        state = step(state, jnp.zeros((2, 12)))
        forces.append(np.asarray(jax.vmap(env._legs.foot_force)(state.data.sim)).sum(-1))
        falls.append(np.asarray(state.done))
    assert np.isfinite(np.asarray(state.obs["privileged"])).all()
    assert np.mean(forces[10:20]) == pytest.approx(32.107 * 9.81, rel=0.35)
    assert np.asarray(state.metrics["slot_overflow"]).max() == 0
    assert np.sum(falls, 0).min() >= 1, "40 N m/rad of the ankles alone do not hold it"


@pytest.mark.slow
@pytest.mark.parametrize("name", WALKERS)
def test_it_keeps_every_promise(name: str) -> None:
    check_env(load_env(name, preset="fast", **{"terrain.first_levels": 2, "noise.scale": 1.0}), num_envs=4, num_steps=6)
