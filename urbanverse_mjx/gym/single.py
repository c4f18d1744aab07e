"""`UrbanEnv`: a single environment with the Gymnasium interface."""

import pathlib
from collections.abc import Mapping, Sequence
from typing import Any

import gymnasium
import jax
import numpy as np

from ..datatypes import SceneBank
from .arrays import exporter, to_jax
from .batch import keys_of, load_batch
from .rendering import RENDER_MODES, BatchRenderer


class UrbanEnv(gymnasium.Env[dict[str, Any], Any]):
    """One instance of a registered environment. To step many in one call use `UrbanVectorEnv`.

        env = gymnasium.make("urbanverse/CocoNav-v0", preset="cpu", render_mode="rgb_array")

    For arguments and errors see `UrbanVectorEnv`. The reward is a float; `terminated` and `truncated` are bool.
    """

    metadata = {"render_modes": list(RENDER_MODES), "render_fps": 5}  # noqa: RUF012

    def __init__(
        self,
        name: str,
        *,
        preset: str | None = None,
        config_overrides: Mapping[str, Any] | None = None,
        bank: SceneBank | str | pathlib.Path | None = None,
        observations: Sequence[str] | None = None,
        output: str = "numpy",
        render_mode: str | None = None,
        height: int = 240,
        width: int = 320,
        camera: str | None = None,
    ) -> None:
        self._export = exporter(output)
        self._batch = load_batch(name, preset, config_overrides, bank, observations)
        self._renderer = BatchRenderer(self._batch.env, render_mode, height, width, camera)
        self.render_mode = render_mode
        self.metadata = self._renderer.metadata
        self.observation_space = self._batch.observation_space
        self.action_space = self._batch.action_space
        self._carried: Any = None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Returns the first observation and info of a new episode; a seed gives the same episode as in a vector."""
        super().reset(seed=seed)
        keys = keys_of([int(self.np_random.integers(2**32)) if seed is None else seed])
        self._carried, obs, info = self._batch.begin(keys)
        return self._exported(obs), _numbers(info)

    def step(self, action: Any) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        """Runs one control step; the episode is truncated at its time limit."""
        if self._carried is None:
            raise gymnasium.error.ResetNeeded("step: found no episode, needed `reset` first.")
        after = self._batch.step(self._carried, to_jax(action)[None])
        self._carried = after.carried
        reward, terminated, truncated, info = jax.device_get(
            (after.reward, after.terminated, after.truncated, after.info)
        )
        return self._exported(after.obs), float(reward[0]), bool(terminated[0]), bool(truncated[0]), _numbers(info)

    def render(self) -> Any:
        """Returns an image (height, width, 3) uint8 of the state of the last observation, or None without a mode."""
        images = self._renderer(self._carried, 1)
        return None if images is None else images[0]

    def _exported(self, obs: dict[str, jax.Array]) -> dict[str, Any]:
        return self._export({name: x[0] for name, x in obs.items()})


def _numbers(info: dict[str, Any]) -> dict[str, float | int]:
    return {name: np.asarray(x)[0].item() for name, x in info.items()}
