"""Makes the locomotion environment from a config: robot, engine, environment."""

from ml_collections import ConfigDict

from ...datatypes import SceneBank
from ..robot import make_robot
from .env import JoystickEnv


def make_joystick_env(config: ConfigDict, bank: SceneBank) -> JoystickEnv:
    """Makes a `JoystickEnv` with the engine of its config, without a renderer."""
    from ...simulation.engines import make_engine

    robot = make_robot(config)
    engine = make_engine(
        bank,
        robot,
        impl=config.impl,
        control_dt=config.ctrl_dt,
        physics_dt=config.sim_dt,
        num_slots=0,
        **config.engine,
    )
    return JoystickEnv(config, bank, robot, engine)
