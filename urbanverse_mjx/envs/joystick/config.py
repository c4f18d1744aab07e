"""Configurations of the locomotion task: `joystick_config(preset)` returns a new, locked `ConfigDict`.

docs/decisions/go2.md lists the public task from which each number of the Go2's task is taken, and the differences.
Other robots have its task with their own sizes (`legged_joystick_config`).
"""

from typing import Any

from ml_collections import ConfigDict

from ...datatypes import ValidationError
from ...datatypes import validation as v
from ...robots import legged

JOYSTICK_PRESETS = ("fast", "cpu")


def _randomization() -> dict[str, Any]:
    """Randomised parameters of robots, and pushes."""
    return {
        "friction_scale": (0.5, 1.5),
        "mass_scale": (0.9, 1.15),
        "strength": (0.9, 1.1),
        "joint_bias": 0.015,  # rad
        "delay_share": 0.5,
        "push_speed": 0.8,  # m/s
        "push_turn": 0.5,  # rad/s
        "push_every": 6.0,  # s, mean
    }


def _rewards() -> dict[str, Any]:
    """Weights of the terms of `terms`, and their targets."""
    return {
        "tracking_width": 0.25,  # (m/s)² and (rad/s)²
        "foot_clearance": 0.10,  # m
        "trunk_height": 0.30,  # m
        "motor_speed": (30.1, 30.1, 15.7),  # rad/s, urdf
        "scales": {
            "track_linear": 1.5,
            "track_angular": 0.75,
            "vertical_speed": -1.0,
            "roll_pitch_rate": -0.05,
            "tilt": -0.5,
            "trunk_height": -5.0,
            "torque": -1e-4,
            "acceleration": -2.5e-7,
            "action_rate": -0.05,
            "pose": 0.3,
            "stand_still": -0.5,
            "joint_limits": -5.0,
            "joint_speed": -0.5,
            "foot_clearance": -2.0,
            "foot_slip": -0.1,
            "air_time": 2.0,
            "touch": -1.0,
            "fall": -100.0,
        },
    }


def _fast() -> ConfigDict:
    return ConfigDict(
        {
            "preset": "fast",
            "robot": "go2",
            "menagerie": "",  # folder unitree_go2 of mujoco_menagerie; "" = the built-in model
            "ctrl_dt": 0.02,  # 50 Hz
            "sim_dt": 0.005,
            "episode_length": 500,  # 10 s instead of the usual 20 s, so that levels rise sooner
            "action_repeat": 1,
            "impl": "auto",
            "engine": {"num_prism_slots": 8, "num_contacts": 12, "iterations": 6, "line_steps": 8},
            # rad, deviation of hip, thigh and calf from the standing pose for an action of 1.
            "action_scale": (0.4, 1.0, 1.0),
            "history": 5,  # control steps in the policy's observation
            "terrain": {
                # Shares of episodes; kinds that the bank does not have are left out.
                "shares": {"flat": 0.2, "kerbs": 0.4, "stairs": 0.1, "slopes": 0.15, "rough": 0.15},
                "first_levels": 5,  # an env's first level of each kind is below this
                "start_range": 3.0,  # m, largest distance of starts from the centre of a scene
                "promote": 0.75,  # share of the commanded path that was covered
                "demote": 0.4,
            },
            "command": {
                "linear_x": (-1.0, 1.0),  # m/s
                "linear_y": (-0.5, 0.5),
                "angular": (-1.0, 1.0),  # rad/s
                "stand_share": 0.1,
                "forward_share": 0.4,
                "forward_speed": (0.4, 1.0),  # m/s
                "forward_angular": (-0.3, 0.3),
                "hold": (3.0, 8.0),  # s
            },
            "noise": {
                "scale": 1.0,
                "angular_velocity": 0.2,  # rad/s
                "gravity": 0.05,
                "joint_position": 0.01,  # rad
                "joint_velocity": 1.5,  # rad/s
            },
            "randomization": _randomization(),
            "reward_config": _rewards(),
        }
    )


def _cpu() -> ConfigDict:
    """The robot on flat ground without disturbances, for a CPU with two cores."""
    config = _fast()
    config.preset = "cpu"
    config.terrain.shares = {"flat": 1.0, "kerbs": 0.0, "stairs": 0.0, "slopes": 0.0, "rough": 0.0}
    config.randomization = {
        "friction_scale": (1.0, 1.0),
        "mass_scale": (1.0, 1.0),
        "strength": (1.0, 1.0),
        "joint_bias": 0.0,
        "delay_share": 0.0,
        "push_speed": 0.0,
        "push_turn": 0.0,
        "push_every": 6.0,
    }
    config.episode_length = 250  # 5 s
    return config


def joystick_config(preset: str = "fast") -> ConfigDict:
    """Returns a new configuration.

    Raises:
      ValidationError: the preset is unknown.
    """
    makers = {"fast": _fast, "cpu": _cpu}
    v.choice(preset, "preset", JOYSTICK_PRESETS)
    return makers[preset]().lock()


#: kg m, mass times height in the standing pose of the Go2: torques of another robot grow like its own.
_GO2_SIZE = 15.2 * 0.33
#: Terms of a robot on two legs that differ from the Go2's: upright, high, with one foot in the air at a time. Tilt,
#: height: unitree_rl_gym's G1; single_stance: isaaclab's feet_air_time_positive_biped, 0.75 on level ground.
_BIPED_SCALES = {"tilt": -1.0, "trunk_height": -10.0, "air_time": 0.0, "single_stance": 0.75, "touch": -0.5}
#: Steps and kerbs are for robots with four legs; a blind humanoid meets low ones, slopes and slabs.
_BIPED_SHARES = {"flat": 0.45, "kerbs": 0.15, "stairs": 0.05, "slopes": 0.15, "rough": 0.2}


def legged_joystick_config(robot: str, preset: str = "fast") -> ConfigDict:
    """The Go2's task of a preset for another robot of `robots.legged`: its own joints, heights, commands and torques.

    Raises:
      ValidationError: the preset or the robot is unknown, or the robot does not walk.
    """
    row = legged.row(robot)
    if row.walk is None:
        raise ValidationError(f"robot {robot!r}: found no `walk` in its row, needed a robot that learns a gait.")
    config, walk, links = joystick_config(preset).unlock(), row.walk, row.links
    config.robot = robot
    del config.menagerie
    config.action_scale = tuple(link.scale for link in links)
    config.lowest = walk.lowest
    top = row.max_speed
    config.command.update(
        {
            "linear_x": walk.forward,
            "linear_y": walk.aside,
            "angular": walk.turn,
            "forward_speed": (0.4 * top, top),
            "forward_angular": (0.3 * walk.turn[0], 0.3 * walk.turn[1]),
        }
    )
    rewards = config.reward_config
    rewards.foot_clearance, rewards.trunk_height = walk.clearance, walk.height
    rewards.motor_speed = tuple(link.speed for link in links)
    rewards.pose_weights = tuple(link.pose for link in links)
    rewards.scales.torque *= (_GO2_SIZE / (row.mass * row.spawn)) ** 2
    if len(row.legs) == 2:
        rewards.scales = ConfigDict({**rewards.scales.to_dict(), **_BIPED_SCALES})
        if preset != "cpu":
            config.terrain.shares = ConfigDict(_BIPED_SHARES)
        # Both soles of four spheres each, and knees and hands of one that falls.
        config.engine.num_contacts = 16
    return config.lock()
