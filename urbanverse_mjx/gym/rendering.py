"""Rendering for `render_mode="rgb_array"`."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ..datatypes import ValidationError
from ..envs import StagedBase, State

RENDER_MODES = ("rgb_array",)


class BatchRenderer:
    """Renders an image of each env of a batch.

    Args:
      env: the environment.
      mode: None or "rgb_array".
      height, width: pixels.
      camera: see `StagedBase.render`.

    Raises:
      ValidationError: the mode is unknown.
    """

    def __init__(self, env: StagedBase[Any], mode: str | None, height: int, width: int, camera: str | None) -> None:
        if mode is not None and mode not in RENDER_MODES:
            raise ValidationError(f"render_mode: found {mode!r}, needed None or one of {', '.join(RENDER_MODES)}.")
        self._env, self._mode, self._shape = env, mode, (height, width, camera)
        self.metadata = {"render_modes": list(RENDER_MODES), "render_fps": round(1.0 / env.dt)}

    def __call__(self, carried: Any, number: int) -> tuple[np.ndarray, ...] | None:
        """Returns (height, width, 3) uint8 for each of the envs in `carried`, or None without a mode."""
        if self._mode is None or carried is None:
            return None
        zero = jnp.float32(0.0)
        states = [State(jax.tree.map(lambda x, i=i: x[i], carried), {}, zero, zero, {}, {}) for i in range(number)]
        # One call per env, because the following camera takes a list of states as one drive.
        return tuple(np.asarray(self._env.render(state, *self._shape)) for state in states)
