"""Gymnasium environments: importing this package registers all of them as `urbanverse/NAME-v0`.

    import gymnasium
    import urbanverse_mjx.gym

    envs = gymnasium.make_vec("urbanverse/CocoNav-v0", num_envs=16, preset="cpu")

Gymnasium 1.x loads no plugins by itself; `gymnasium.make("urbanverse_mjx.gym:urbanverse/CocoNav-v0")` also imports the
package.
"""

try:
    import gymnasium  # noqa: F401
except ImportError as error:
    raise ImportError(
        "urbanverse_mjx.gym: found no Gymnasium, needed 1.1 or newer; install it with "
        "`pip install 'urbanverse_mjx[gymnasium]'`."
    ) from error

from .registration import env_id, register_all
from .single import UrbanEnv
from .vector import UrbanVectorEnv

__all__ = ["UrbanEnv", "UrbanVectorEnv", "env_id"]

register_all()
