"""The navigation task: begin, advance, observe; its terms, presets, wrapper, registry and check."""

from .checks import EnvCheckError, check_env
from .config import PRESETS, default_config
from .navigation import NavEnv
from .types import NavState, Result, State
from .wrappers import AutoResetEnv, wrap_for_training

__all__ = [
    "PRESETS",
    "AutoResetEnv",
    "EnvCheckError",
    "NavEnv",
    "NavState",
    "Result",
    "State",
    "check_env",
    "default_config",
    "wrap_for_training",
]
