"""A box with a camera that is driven through the box streets by the kinematic engine, which compiles fast."""

import dataclasses
from typing import Any

from tests.support.unicycle import UnicycleEngine, unicycle_robot
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.envs import NavEnv, registry
from urbanverse_mjx.evaluation.agents import BASELINES
from urbanverse_mjx.simulation.rendering.renderer import Renderer
from urbanverse_mjx.viewer.session import Machine, NamedPolicy

_BOX = """<mujoco><worldbody><body name="base" pos="0 0 0.3"><freejoint/>
<geom type="box" size="0.4 0.3 0.2" group="2" rgba="0.9 0.1 0.1 1"/>
<camera name="front" pos="0.4 0 0.1" xyaxes="0 -1 0 0 0 1" fovy="60"/></body></worldbody></mujoco>"""


def box_env(bank: SceneBank, preset: str = "cpu", overrides: dict[str, Any] | None = None) -> NavEnv:
    """`CocoNav` with the box, whose camera has 18x32 pixels."""
    looks = {"mjcf": _BOX, "root_body": "base", "camera": "front", "foot_geoms": ()}
    robot = dataclasses.replace(unicycle_robot(), **looks)
    size = {"vision_config.height": 18, "vision_config.width": 32}
    given = {"scenes": "all", **size, **(overrides or {})}
    config = registry.with_overrides(registry.get_default_config("CocoNav", preset), given)
    engine = UnicycleEngine(robot, config.ctrl_dt)
    return NavEnv(config, bank, robot, engine, Renderer(bank, robot, 18, 32, shading="matte"))


def box_machine(bank: SceneBank, policy: str = "go_to_goal") -> Machine:
    """The box, driven by a rule."""
    return Machine(box_env(bank), NamedPolicy(policy, BASELINES[policy]))
