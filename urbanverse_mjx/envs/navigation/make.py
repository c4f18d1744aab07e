"""Makes the navigation environment from a config (robot, engine, renderer, environment) for wheeled or legged
robots."""

from collections.abc import Callable
from typing import Any

import jax.numpy as jnp
import mujoco
from ml_collections import ConfigDict

from ...datatypes import AgentShapes, PlacedBank, Renderer, RobotSpec, SceneBank, Simulator, ValidationError
from ..robot import make_robot
from .dynamic import slot_appearances, slot_kinds, slot_shapes
from .env import NavEnv
from .fleet import ROBOT, fleet_middle, fleet_shapes, fleet_size
from .movables import body_sizes
from .scenarios import bank_for, check_places, scenario_of
from .tasks import task_class

#: Function (config, bank, robot, shapes of moving agents, sizes of body slots) -> engine.
EngineMaker = Callable[[ConfigDict, SceneBank, RobotSpec, AgentShapes | None, dict[str, int] | None], Simulator]


def make_wheeled_env(config: ConfigDict, bank: SceneBank) -> NavEnv:
    """Makes a `NavEnv` of a wheeled robot with the engine and renderer of its config.

    Raises:
      ValidationError: time steps do not divide or are too long for the robot, or the robot has legs.
    """
    return _make(config, bank, wheeled_engine)


def make_walking_env(config: ConfigDict, bank: SceneBank) -> NavEnv:
    """Makes a `NavEnv` of a legged robot, whose gait follows body velocities; see `make_wheeled_env`.

    Raises:
      ValidationError: see `make_wheeled_env`; or the config has moving agents or joint actions, or scenes come and go.
    """
    if isinstance(bank, PlacedBank):
        raise ValidationError(
            "config.schedule.places: found it for a robot that a gait moves, needed 0; take a robot on wheels, or keep "
            "all scenes on the device."
        )
    if config.action_mode == "joint":
        raise ValidationError(
            "config.action_mode: found 'joint' for a robot with a gait, needed 'waypoint' or 'velocity'."
        )
    return _make(config, bank, walking_engine)


def wheeled_engine(
    config: ConfigDict,
    bank: SceneBank,
    robot: RobotSpec,
    agents: AgentShapes | None,
    movable: dict[str, int] | None,
) -> Simulator:
    """Makes the engine of a config.

    Raises:
      ValidationError: the robot does not take wheel commands.
    """
    from ...simulation.collision_slots.body_slots import Sizes
    from ...simulation.engines import make_engine

    commands, motors = robot.command(jnp.zeros(2)).shape[0], mujoco.MjModel.from_xml_string(robot.mjcf).nu
    if commands != motors:
        raise ValidationError(
            f"config.robot: found {robot.name!r}, which walks by a gait, needed a robot on wheels; take Go2Nav with "
            "robot and gait overridden."
        )
    sizes = None if movable is None else Sizes(**movable)
    return make_engine(bank, robot, control_dt=config.ctrl_dt, agents=agents, movable=sizes, **_options(config))


def walking_engine(
    config: ConfigDict,
    bank: SceneBank,
    robot: RobotSpec,
    agents: AgentShapes | None,
    movable: dict[str, int] | None,
) -> Simulator:
    """Makes the engine of a config, which runs the gait at its own rate.

    Raises:
      ValidationError: there are moving agents, which no engine supports for a robot with a gait.
    """
    from ...robots import gait_of
    from ...simulation.engines import make_engine
    from ...simulation.gait_engine import GaitEngine

    if agents is not None or movable is not None:
        raise ValidationError(
            "config.scenario: found 'dynamic' or clutter for a robot with a gait, needed 'clean' or 'static' without."
        )
    gait = gait_of(robot, config.gait or None)
    engine = make_engine(bank, robot, control_dt=gait.control_dt, **_options(config))
    return GaitEngine(engine, robot, gait, config.ctrl_dt)


def _options(config: ConfigDict) -> dict[str, Any]:
    # Policies from before there was a choice were trained on uniform ground.
    friction = config.get("friction", "uniform")
    return {"impl": config.impl, "physics_dt": config.sim_dt, "num_slots": config.num_slots, "friction": friction}


def _make(config: ConfigDict, bank: SceneBank, make_engine: EngineMaker) -> NavEnv:
    if isinstance(bank, PlacedBank):
        check_places(config)
    scenario = scenario_of(config)
    bank = bank_for(scenario, bank)
    kinds = slot_kinds(config.crowd) if scenario == "dynamic" else ()
    robot, size = make_robot(config), fleet_size(config)
    if abs(config.ctrl_dt / config.sim_dt - round(config.ctrl_dt / config.sim_dt)) > 1e-6:
        raise ValidationError(
            f"config.ctrl_dt: found {config.ctrl_dt} s with sim_dt {config.sim_dt} s, needed a whole number of steps."
        )
    if config.sim_dt > robot.physics_timestep + 1e-9:
        raise ValidationError(
            f"config.sim_dt: found {config.sim_dt:g} s, needed at most the {robot.physics_timestep:g} s that the MJCF "
            f"of {robot.name!r} asks for; override sim_dt."
        )
    movable = body_sizes(config)
    shapes = slot_shapes(kinds) if kinds else None
    if size:
        from ...simulation.rendering.robot_appearance import with_robot_appearance

        kinds, shapes = (ROBOT,) * (size - 1), fleet_shapes(robot, size)
        bank = with_robot_appearance(bank, robot, ROBOT, fleet_middle(robot))
    bank = task_class(config).furnished(config, bank, robot)
    engine = make_engine(config, bank, robot, shapes, movable)
    bodies = 0 if movable is None else movable["bodies"]
    return NavEnv(config, bank, robot, engine, _renderer(config, bank, robot, kinds, bodies))


def _renderer(
    config: ConfigDict, bank: SceneBank, robot: RobotSpec, kinds: tuple[str, ...], bodies: int
) -> Renderer | None:
    """Makes the renderer of a config; kinds: kinds of the agents; bodies: number of objects that may be moved."""
    if not config.vision:
        return None
    from ...simulation.rendering import renderer

    view = config.vision_config
    return renderer.Renderer(
        bank,
        robot,
        view.height,
        view.width,
        outputs=("rgb", "depth") if view.depth else ("rgb",),
        sky=view.sky,
        shadows=view.shadows,
        shading=view.shading,
        appearance=config.randomization.appearance,
        agents=slot_appearances(kinds, bank),
        bodies=bodies,
        # Policies from before there was baked light see what they were trained with.
        light=view.get("light", "direct"),
    )
