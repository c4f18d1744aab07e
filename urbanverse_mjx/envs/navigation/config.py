"""Configurations of the navigation task: `default_config(preset)` returns a new, locked `ConfigDict`.

Sources: the paper's appendix "Details of Training and Evaluation Setup" and "Details of Policy Learning"; for
`urbansim_v0_1` the released code, see the table in docs/decisions/presets.md.
"""

from typing import Any

from ml_collections import ConfigDict

from ...datatypes import validation as v
from ...robots import catalogue, legged
from .draws import OFF


def _paper() -> ConfigDict:
    return ConfigDict(
        {
            "preset": "paper",
            "robot": "coco",
            "drive": "differential",
            "ctrl_dt": 0.2,  # 5 Hz
            "sim_dt": 0.01,
            "episode_length": 300,  # 60 s at 5 Hz
            "action_repeat": 1,
            "impl": "auto",
            "num_slots": 16,
            # That of the ground's materials and of the robot, whichever is less (docs/decisions/friction.md).
            "friction": "materials",
            "scenes": "train",
            # The paper uses 16 scenes for 100 episodes; here all scenes can be used at once at no cost
            # (docs/decisions/presets.md).
            "schedule": {
                "resident_scenes": 0,  # 0 = all
                "episodes_per_swap": 100,
                "start_distance": 0.0,  # m, 0 = no curriculum
                "ramp_steps": 0,  # control steps of an env
                "learnable": 0.0,  # share of training episodes drawn by p (1 - p)
                # Scenes of a folder that are on the device at a time while a training runs (`places.ScenePlaces`), 0 =
                # all, and env-steps from the coming of one scene to that of the next, 0 = all come once.
                "places": 0,
                "exchange_steps": 0,
                "seed": 0,
            },
            # The paper names textures, friction and mass without ranges; these ranges are chosen here.
            "randomization": {
                "friction_scale": (0.7, 1.3),
                "mass_scale": (0.8, 1.25),
                "appearance": 0.2,
                "camera_position": 0.0,
                "camera_angle": 0.0,
                "camera_fovy": 0.0,
                "clutter": 0,
                "starts": 0.0,
                "wet": 0.0,
                "latency": (0.0, 0.0),
                "exposure": 0.0,
                "white_balance": 0.0,
                "blur": 0.0,
                "pixel_noise": 0.0,
            },
            # clean, static or dynamic, the scenario types of UrbanSim (see scenarios.py); `crowd` applies to dynamic
            # only.
            "scenario": "static",
            "crowd": _crowd(),
            # Objects that can be pushed, for dynamic only: number of an env, number that move at once (with three, COCO
            # stays within the 32 velocities that MuJoCo Warp solves fastest), and largest number of hulls of each.
            "movable": {"bodies": 8, "awake": 3, "hulls": 4},
            "action_mode": "waypoint",
            "goal_mode": "final",
            "goal_observation_limit": 0.0,  # m, 0 = no limit
            "success_radius": 1.0,  # m, from the authors' code; the paper says "within a distance tolerance"
            "success_after_step": 0,
            "terminate_on_hit": True,
            "terminate_off_traversable": True,
            "vision": True,
            "vision_config": {
                "height": 135,
                "width": 240,
                "depth": False,
                "sky": True,
                "shadows": False,
                "shading": "pbr",
                "light": "baked",
            },
            # Additional observations for a policy, a teacher or an auxiliary loss (`NavEnv`).
            "observations": {"proprio": False, "privileged_map": False, "clear_arcs": False, "robot": False},
            "reward_config": {
                "multiply_by_dt": False,
                "scales": {
                    "arrived": 2000.0,
                    "hit": -200.0,
                    "off_traversable": 0.0,
                    "position": 10.0,
                    "position_fine": 50.0,
                    "velocity_cosine": 10.0,
                    "velocity_dot": 0.0,
                    "progress": 0.0,
                    "near_object": 0.0,
                },
            },
        }
    )


def _crowd() -> dict[str, Any]:
    """Moving agents of the scenario `dynamic`, with the sizes for which throughput is reported."""
    return {
        # Agent slots of an env by kind; 16 in all around the robot.
        "slots": {"pedestrian": 11, "wheelchair": 1, "scooter": 1, "cyclist": 1, "car": 2},
        # Share of the slots in use by scene family (prefix of the id): shopping streets have more people than
        # residential ones.
        "filled": {
            "default": 0.75,
            "commercial": 1.0,
            "tourist": 1.0,
            "park": 0.8,
            "construction": 0.6,
            "residential": 0.5,
        },
        # m around the robot within which agents are placed, about the range at which a person is visible at 135 rows
        # (crowds/spawning.py).
        "reach": 30.0,
        # Share of the avoidance that people expect of the robot: 0 = only people avoid, 1 = as between people.
        "yielding": 0.5,
        # Probability of each encounter near the route in an episode (encounters.py).
        "encounters": {
            "head_on": 0.5,
            "cross": 0.4,
            "obstruct": 0.4,
            "overtaken": 0.3,
            "talk": 0.4,
            "queue": 0.3,
        },
    }


def _urbansim_v0_1() -> ConfigDict:
    config = _paper()
    config.preset = "urbansim_v0_1"
    config.friction = "uniform"  # its ground has 1.0 everywhere
    config.randomization = OFF
    config.drive = "ackermann"
    config.ctrl_dt = 0.1  # dt 0.005 s, decimation 20
    config.sim_dt = 0.005
    config.goal_observation_limit = 5.0
    config.success_after_step = 10
    config.terminate_off_traversable = False
    config.vision_config.depth = True
    config.reward_config.multiply_by_dt = True  # Isaac Lab multiplies every term by the step
    config.reward_config.scales.velocity_cosine = 0.0
    config.reward_config.scales.velocity_dot = 10.0
    config.reward_config.scales.progress = 20.0
    return config


def _dense_rewards() -> ConfigDict:
    """Reward weights that need fewer training steps than the paper's: progress, and penalties for failures."""
    return ConfigDict(
        {
            "arrived": 10.0,
            "hit": -5.0,
            "off_traversable": -5.0,
            "position": 0.0,
            "position_fine": 0.0,
            "velocity_cosine": 0.0,
            "velocity_dot": 0.0,
            "progress": 1.0,
            "near_object": -0.15,
        }
    )


def _fast() -> ConfigDict:
    """The paper's task and image for thousands of envs on a GPU, with other reward weights and simpler lighting."""
    config = _paper()
    config.preset = "fast"
    config.vision_config.shading = "matte"
    config.reward_config.scales = _dense_rewards()
    return config


def _best() -> ConfigDict:
    """Like `fast` with a smaller image, proprioception, the shading of `paper`, and imperfect sensors and motion; the
    map of distances is for the teacher, the critic and an auxiliary loss (`training.teacher_student`)."""
    config = _fast()
    config.preset = "best"
    config.vision_config.height, config.vision_config.width = 54, 96
    config.vision_config.shading = "pbr"
    # Without them the policy does not survive another camera (docs/results.md, "Transfer").
    config.randomization.update(
        friction_scale=(0.4, 1.3),
        latency=(0.0, 0.2),
        appearance=0.3,
        camera_position=0.03,
        camera_angle=3.0,
        camera_fovy=0.1,
        exposure=1.2,
        white_balance=0.2,
        blur=1.0,
        pixel_noise=0.05,
    )
    config.observations.proprio = config.observations.privileged_map = True
    return config


def _tune() -> ConfigDict:
    """The task of `best`, in which its policies go on by PPO in all scenes of a bank of one place
    (`training.tuning`)."""
    config = _best()
    config.preset = "tune"
    config.scenes = "all"
    return config


def _cpu() -> ConfigDict:
    """The paper's task for a CPU, with a smaller image and other reward weights."""
    config = _paper()
    config.preset = "cpu"
    config.vision_config.height, config.vision_config.width = 27, 48
    config.randomization = OFF
    config.vision_config.shading = "matte"  # no highlights; renders 1.5 times as fast on a CPU
    config.reward_config.scales = _dense_rewards()
    return config


def _quick() -> ConfigDict:
    """Like `cpu` with a larger image, for imitation learning: the policy also uses proprioception and predicts a map of
    distances."""
    config = _cpu()
    config.preset = "quick"
    config.vision_config.height, config.vision_config.width = 36, 64
    config.observations.proprio = config.observations.privileged_map = True
    return config


_MAKERS = {
    "paper": _paper,
    "urbansim_v0_1": _urbansim_v0_1,
    "fast": _fast,
    "best": _best,
    "tune": _tune,
    "cpu": _cpu,
    "quick": _quick,
}
PRESETS = tuple(_MAKERS)


def go2_nav_config(preset: str = "paper") -> ConfigDict:
    """COCO's task of a preset for the Go2 with the same camera.

    Raises:
      ValidationError: the preset is unknown.
    """
    config = ConfigDict(default_config(preset).to_dict())
    del config.drive
    config.robot = "go2"
    config.gait = ""  # a file of `urbanverse export-gait`; "" = the one that ships with the package
    config.menagerie = ""  # folder unitree_go2 of mujoco_menagerie; "" = the built-in model
    config.sim_dt = 0.005  # as in the training of the gait
    return config.lock()


def legged_nav_config(robot: str, preset: str = "paper") -> ConfigDict:
    """COCO's task of a preset for a robot of `robots.legged`, which walks by its gait or drives on its wheels.

    Raises:
      ValidationError: the preset or the robot is unknown.
    """
    config = _config_of_row(robot, preset, by_gait=legged.row(robot).drive == "gait")
    with config.unlocked():
        config.sim_dt = legged.PHYSICS_TIMESTEP
    return config.lock()


def catalogue_config(robot: str, preset: str = "paper") -> ConfigDict:
    """COCO's task of a preset for a robot of `robots.catalogue`.

    Raises:
      ValidationError: the preset or the robot is unknown.
    """
    return _config_of_row(robot, preset, by_gait=catalogue.row(robot).drive == "balance")


def _config_of_row(robot: str, preset: str, *, by_gait: bool) -> ConfigDict:
    """The Go2's task for a robot that a gait moves, else COCO's, each without what is of its own robot alone."""
    config = go2_nav_config(preset) if by_gait else ConfigDict(default_config(preset).to_dict())
    with config.unlocked():
        del config["menagerie" if by_gait else "drive"]
        config.robot = robot
    return config.lock()


def default_config(preset: str = "paper") -> ConfigDict:
    """A fresh configuration.

    Raises:
      ValidationError: the preset is unknown.
    """
    v.choice(preset, "preset", PRESETS)
    return _MAKERS[preset]().lock()
