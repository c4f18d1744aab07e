"""Configurations of the tasks beside point goals: those of a preset with a crowd and a section `task`."""

from collections.abc import Mapping
from typing import Any

from ml_collections import ConfigDict

from ..config import default_config

#: Terms of reward with which a policy learns in few steps, whatever the preset: those of the preset `fast`.
_DENSE = "fast"

#: s, time limits of `FollowRoute`, `CrossStreet`, and `Deliver` and `DropOff`.
FOLLOW_ROUTE_TIME, CROSS_STREET_TIME, DELIVER_TIME = 360.0, 60.0, 30.0


def _with_task(
    preset: str, name: str, options: Mapping[str, Any], scales: Mapping[str, float], crowd: Mapping[str, Any]
) -> ConfigDict:
    """A preset's configuration in the scenario `dynamic`, with the section `task`.

    Args:
      options: of the task.
      scales: of terms of reward, which are added to those of the preset `fast`.
      crowd: values that differ from `config.crowd` of the preset.
    """
    config = ConfigDict(default_config(preset).to_dict())
    config.scenario = "dynamic"
    # Nothing is pushed: the engine has no body slots.
    config.movable.bodies = 0
    config.crowd.update(crowd)
    config.reward_config.multiply_by_dt = False
    config.reward_config.scales = {**default_config(_DENSE).reward_config.scales, **scales}
    config.task = {"name": name, **options}
    return config


def _without_people(preset: str, name: str, options: Mapping[str, Any], scales: Mapping[str, float]) -> ConfigDict:
    """The same in the scenario `static`, in which no place ends an episode.

    Args:
      scales: as of `_with_task`; those of the same name replace the preset's.
    """
    config = ConfigDict(default_config(preset).to_dict())
    config.scenario = "static"
    config.success_radius = 0.0
    config.reward_config.multiply_by_dt = False
    config.reward_config.scales = {**default_config(_DENSE).reward_config.scales, **scales}
    config.task = {"name": name, **options}
    return config


def object_goal_config(preset: str = "paper") -> ConfigDict:
    """The configuration of `ObjectGoal` (`object_goal.ObjectGoal`) for COCO: that of a preset, with objects that stand.

    Raises:
      ValidationError: the preset is unknown.
    """
    options = {
        "path_length": (8.0, 35.0),  # m, shortest path from the start; a whole street is about 50 m long
        "success_distance": 1.0,  # m, of Batra et al. (2020)
        "stop_time": 1.0,  # s
    }
    return _without_people(preset, "object_goal", options, {"at_object": 0.1, "stopped": -5.0}).lock()


def deliver_config(preset: str = "paper") -> ConfigDict:
    """The configuration of `Deliver` (`deliver.Deliver`) for COCO with an arm: that of a preset at 10 Hz.

    Raises:
      ValidationError: the preset is unknown.
    """
    options = {
        "posts": 8,
        "height": (0.9, 1.2),  # m
        "distance": (2.0, 6.0),  # m
        "force": 5.0,  # N; at most 22.2 is allowed, see `deliver`
        "hold_time": 0.2,  # s
    }
    # The post is always near in the end.
    scales = {"near_object": 0.0, "reach": 2.0, "press": 0.2}
    return _with_arm(_without_people(preset, "deliver", options, scales), "coco_arm").lock()


def drop_off_config(preset: str = "paper") -> ConfigDict:
    """The configuration of `DropOff` (`drop_off.DropOff`) for COCO with a parcel at its arm: that of a preset at 10 Hz.

    Raises:
      ValidationError: the preset is unknown.
    """
    options = {
        "posts": 8,
        "height": (0.5, 0.85),  # m
        "distance": (2.0, 6.0),  # m
        "release_time": 0.4,  # s
        "lie_time": 0.5,  # s
    }
    # The box is always near in the end.
    scales = {"near_object": 0.0, "carry": 2.0, "open": 4.0, "spilt": -0.1, "dropped": -5.0}
    return _with_arm(_without_people(preset, "drop_off", options, scales), "coco_parcel").lock()


def _with_arm(config: ConfigDict, robot: str) -> ConfigDict:
    """The configuration for a robot with an arm."""
    del config.drive
    config.robot = robot
    # A press and a release are matters of tenths of a second.
    config.ctrl_dt = 0.1
    config.episode_length = round(DELIVER_TIME / config.ctrl_dt)
    config.randomization.latency = tuple(min(x, config.ctrl_dt) for x in config.randomization.latency)
    return config


def multi_robot_config(preset: str = "paper") -> ConfigDict:
    """The configuration of `MultiRobot` (`multi_robot.MultiRobot`) for COCO: that of a preset, with other robots in
    place of a crowd.

    Raises:
      ValidationError: the preset is unknown.
    """
    options = {
        "robots": 4,
        "route_length": (8.0, 30.0),  # m, so that several deliveries fit into the time limit
        "arrival_distance": 1.0,  # m, as the success radius of point goals
        "deliveries": 1,
    }
    scales = {"arrived": 0.0, "progress": 0.0, "approach": 1.0, "delivered": 10.0}
    config = _without_people(preset, "multi_robot", options, scales)
    config.randomization.clutter = 0
    return config.lock()


def _everywhere(share: float, config: ConfigDict) -> dict[str, float]:
    return dict.fromkeys(config.crowd.filled, share)


def social_nav_config(preset: str = "paper") -> ConfigDict:
    """The configuration of `SocialNav` (`social.SocialNav`) for COCO.

    Raises:
      ValidationError: the preset is unknown.
    """
    crowd = {
        # Twice as many people as in the other streets, most of them where the robot is.
        "slots": {"pedestrian": 22, "wheelchair": 1, "scooter": 1, "cyclist": 0, "car": 0},
        "filled": _everywhere(1.0, default_config(preset)),
        "reach": 12.0,
        "encounters": {
            "head_on": 0.9,
            "cross": 0.8,
            "obstruct": 0.6,
            "overtaken": 0.6,
            "talk": 0.6,
            "queue": 0.5,
        },
    }
    options = {
        # s, time to a collision below which there is a penalty: how far ahead people react (Karamouzas et al. 2014).
        "horizon": 3.0,
        # m/s³ at which the penalty of jerk is largest: COCO's speed that changes from 0 to 2 m/s in 0.4 s.
        "jerk_limit": 25.0,
    }
    scales = {"personal_space": -0.1, "time_to_collision": -0.1, "jerk": -0.02}
    return _with_task(preset, "social_nav", options, scales, crowd).lock()


def follow_person_config(preset: str = "paper") -> ConfigDict:
    """The configuration of `FollowPerson` (`follow.FollowPerson`) for COCO.

    Raises:
      ValidationError: the preset is unknown.
    """
    crowd = {
        # The first pedestrian is the one to follow.
        "slots": {"pedestrian": 13, "wheelchair": 1, "scooter": 0, "cyclist": 1, "car": 1},
        "filled": _everywhere(1.0, default_config(preset)),
        "reach": 20.0,
        # No script for the first two rows of a crowd, which belong to the first encounters.
        "encounters": {"head_on": 0.0, "cross": 0.0, "obstruct": 0.0, "overtaken": 0.0, "talk": 0.0, "queue": 0.0},
    }
    options = {
        "band": (1.5, 3.0),  # m between centres
        "start_distance": 2.2,  # m
        # m/s; up to the mean walking speed of Weidmann (1993), because COCO's limit of 2 m/s has to allow for catching
        # up.
        "speed": (0.8, 1.34),
        "sight": 15.0,  # m, at which a person is 12 pixels high in the paper's image
        "lost_distance": 10.0,  # m
        "lost_time": 8.0,  # s
        "success_share": 0.5,
    }
    off = {"arrived": 0.0, "progress": 0.0, "hit": -10.0, "off_traversable": -10.0}
    scales = {**off, "band": 0.05, "in_sight": 0.02, "kept": 0.05, "lost": -10.0}
    config = _with_task(preset, "follow_person", options, scales, crowd)
    config.success_radius = 0.0  # the person is no place to arrive at
    return config.lock()


def follow_route_config(preset: str = "paper") -> ConfigDict:
    """The configuration of `FollowRoute` (`route.FollowRoute`) for COCO.

    Raises:
      ValidationError: the preset is unknown.
    """
    options = {
        "length": 200.0,  # m
        "cycle": 60.0,  # s, the shortest that NACTO recommends (`signals`)
        "walk": 20.0,  # s
        "needs_crosswalk": True,  # False: streets without one as well, to train on
    }
    off = {"arrived": 10.0, "progress": 0.0, "hit": -10.0, "off_traversable": -10.0}
    # A wait of up to 40 s costs as many metres, at 1 m/s.
    scales = {**off, "route": 1.0, "violation": -40.0}
    # Fewer people, more vehicles than in the other streets.
    crowd = {"slots": {"pedestrian": 9, "wheelchair": 1, "scooter": 0, "cyclist": 1, "car": 4}}
    config = _with_task(preset, "follow_route", options, scales, crowd)
    config.goal_mode = "waypoint"
    config.goal_observation_limit = 0.0
    # Routes pass gaps with 10 cm on each side, which the distances that a teacher knows do not show.
    config.observations.clear_arcs = config.observations.privileged_map
    # 200 m at a mean of 1 m/s, and a cycle of each of some five signals.
    config.episode_length = round(FOLLOW_ROUTE_TIME / config.ctrl_dt)
    return config.lock()


def cross_street_config(preset: str = "paper") -> ConfigDict:
    """The configuration of `CrossStreet` (`cross.CrossStreet`) for COCO.

    Raises:
      ValidationError: the preset is unknown.
    """
    # Vehicles alone, half of them on each lane.
    crowd = {"slots": {"pedestrian": 0, "wheelchair": 0, "scooter": 0, "cyclist": 0, "car": 12}}
    options = {
        "flow": 400.0,  # vehicles per hour and lane
        "marked": 0.5,  # share of the crosswalks that have stripes, at which drivers give way
        "horizon": 3.0,  # s, time to a collision below which there is a penalty, as in `social_nav_config`
    }
    off = {"hit": -10.0, "off_traversable": -10.0}
    scales = {**off, "near_miss": -3.0, "stop": -1.0, "time_to_collision": -0.2}
    config = _with_task(preset, "cross_street", options, scales, crowd)
    config.episode_length = round(CROSS_STREET_TIME / config.ctrl_dt)
    return config.lock()
