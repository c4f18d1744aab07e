"""The navigation and locomotion environments: stages (begin, advance, observe), reward terms, presets, training
wrapper, registry and checks."""

from .checks import EnvCheckError, check_env
from .joystick import JoystickEnv
from .joystick.config import JOYSTICK_PRESETS, joystick_config
from .navigation import NavEnv
from .navigation.config import PRESETS, default_config
from .staged import StagedBase
from .types import NavState, Result, State
from .wrappers import AutoResetEnv, wrap_for_training

__all__ = [
    "JOYSTICK_PRESETS",
    "PRESETS",
    "AutoResetEnv",
    "EnvCheckError",
    "JoystickEnv",
    "NavEnv",
    "NavState",
    "Result",
    "StagedBase",
    "State",
    "check_env",
    "default_config",
    "joystick_config",
    "wrap_for_training",
]
