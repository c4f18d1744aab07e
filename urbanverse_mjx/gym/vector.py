"""`UrbanVectorEnv`: many environments with Gymnasium's vector interface, each in its own scene."""

import pathlib
from collections.abc import Mapping, Sequence
from typing import Any

import gymnasium
import jax
import jax.numpy as jnp
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from ml_collections import ConfigDict

from ..datatypes import SceneBank, ValidationError
from .arrays import exporter, to_jax
from .batch import Transition, keys_of, load_batch, seeds_of, with_masks
from .rendering import BatchRenderer


class UrbanVectorEnv(VectorEnv[dict[str, Any], Any, Any]):
    """`num_envs` instances of a registered environment, stepped by one compiled call.

        envs = gymnasium.make_vec("urbanverse/CocoNav-v0", num_envs=16, preset="cpu", output="torch")

    Args:
      name: of `envs.registry`; `gymnasium.make_vec` fills it in.
      num_envs: number of envs.
      preset, config_overrides: see `registry.load`.
      bank: a scene bank or its file; None: the environment's default bank.
      observations: names of the policy's observations; None: all except those that begin with "privileged".
      output: "numpy", "torch" or "jax": array type of observations, rewards and info. With "torch" they share JAX's
        memory. Actions may have any of the three types.
      autoreset_mode: a `gymnasium.vector.AutoresetMode`. NEXT_STEP returns the last observation of an episode and
        begins the next episode in the following step, whose action and reward are ignored; it renders one image per
        step. SAME_STEP begins the next episode immediately: `info["final_obs"]` and `info["final_info"]` belong to the
        step itself, and images are rendered twice in steps that end an episode. With DISABLED, call
        `reset(options={"reset_mask": mask})`.
      final_obs: whether SAME_STEP returns the last observations. With NumPy they are, as in Gymnasium, an object array
        of one dict for each env that ended, else None; with the outputs "torch" and "jax" they are a dict of (num_envs,
        ...) in every step.
      render_mode: None, or "rgb_array": `render` returns one image (height, width, 3) for each env.
      height, width, camera: of these images, see `StagedBase.render`.

    Raises:
      ValidationError: see `load_batch` and `exporter`; the autoreset or render mode is unknown, or `num_envs` is 0.
    """

    def __init__(
        self,
        name: str,
        num_envs: int = 1,
        *,
        preset: str | None = None,
        config_overrides: Mapping[str, Any] | None = None,
        bank: SceneBank | str | pathlib.Path | None = None,
        observations: Sequence[str] | None = None,
        output: str = "numpy",
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        final_obs: bool = True,
        render_mode: str | None = None,
        height: int = 240,
        width: int = 320,
        camera: str | None = None,
    ) -> None:
        if num_envs < 1:
            raise ValidationError(f"num_envs: found {num_envs}, needed at least one.")
        modes = [mode.value for mode in AutoresetMode]
        if not isinstance(autoreset_mode, AutoresetMode) and autoreset_mode not in modes:
            raise ValidationError(f"autoreset_mode: found {autoreset_mode!r}, needed one of {', '.join(modes)}.")
        self._export = exporter(output)
        self._batch = load_batch(name, preset, config_overrides, bank, observations)
        self._renderer = BatchRenderer(self._batch.env, render_mode, height, width, camera)
        self._mode, self.output = AutoresetMode(autoreset_mode), output
        self._final_obs = final_obs
        self.num_envs, self.num_actions, self.render_mode = num_envs, self._batch.env.action_size, render_mode
        self.metadata = {**self._renderer.metadata, "autoreset_mode": self._mode}
        self.single_observation_space = self._batch.observation_space
        self.single_action_space = self._batch.action_space
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._carried: Any = None
        self._over: Any = jnp.zeros(num_envs, bool)
        self._everywhere = np.ones(num_envs, bool)

    @property
    def config(self) -> ConfigDict:
        """Returns the environment's config."""
        return self._batch.env.config

    def reset(
        self, *, seed: int | Sequence[int] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Returns the first observations and info of new episodes.

        Args:
          seed: one for each env, or the first of `num_envs` consecutive seeds; a seed gives the same scene, start and
            goal in every batch. None continues the random stream.
          options: "reset_mask", (num_envs,) bool: only these envs begin a new episode.
        """
        super().reset(seed=seed if isinstance(seed, int) else None)
        keys = keys_of(seeds_of(seed, self.num_envs, lambda: self.np_random))
        mask = self._reset_mask(options or {})
        new = self._batch.begin(keys)
        if self._carried is None or mask.all():
            self._carried, self._obs, info = new
        else:
            chosen = jnp.asarray(mask)
            self._carried, self._obs = self._batch.merge(chosen, new[:2], (self._carried, self._obs))
            info = new[2]
        self._over = self._over & ~jnp.asarray(mask)
        return self._export(self._obs), with_masks(self._export(info), mask)

    def step(self, actions: Any) -> tuple[dict[str, Any], Any, Any, Any, dict[str, Any]]:
        """Steps every env; returns observations, rewards, terminations, truncations and info (see the class)."""
        if self._carried is None:
            raise gymnasium.error.ResetNeeded("step: found no episode, needed `reset` first.")
        action = to_jax(actions)
        if action.shape != self.action_space.shape:
            raise ValidationError(f"actions: found shape {action.shape}, needed {self.action_space.shape}.")
        if self._mode is AutoresetMode.NEXT_STEP:
            after = self._batch.step_or_begin(self._carried, self._over, action)
        elif self._mode is AutoresetMode.SAME_STEP:
            after = self._batch.step_and_begin(self._carried, action, final_obs=self._final_obs)
        elif bool(self._over.any()):
            ended = np.flatnonzero(self._over).tolist()
            raise gymnasium.error.ResetNeeded(
                f"step: found that {ended} ended, needed `reset_mask` to begin them anew."
            )
        else:
            after = self._batch.step(self._carried, action)
        self._carried, self._obs = after.carried, after.obs
        self._over = after.terminated | after.truncated
        outputs = after.obs, after.reward, after.terminated, after.truncated
        obs, reward, terminated, truncated = self._export(outputs)
        return obs, reward, terminated, truncated, self._info_of(after)

    def render(self) -> tuple[np.ndarray, ...] | None:
        """Returns an image for each env of the state of the last observations."""
        return self._renderer(self._carried, self.num_envs)

    def _info_of(self, after: Transition[Any]) -> dict[str, Any]:
        info = with_masks(self._export(after.info), self._everywhere)
        if self._mode is not AutoresetMode.SAME_STEP:
            return info
        if self.output != "numpy":
            final = {"final_info": after.final_info, "_final_info": self._over}
            if after.final_obs is not None:
                final |= {"final_obs": after.final_obs, "_final_obs": self._over}
            return info | self._export(final)
        over = np.array(self._over)
        if not over.any():
            return info
        info |= {"final_info": with_masks(self._export(after.final_info), over), "_final_info": over}
        if after.final_obs is not None:
            last, rows = self._export(after.final_obs), np.full(self.num_envs, None, object)
            for i in np.flatnonzero(over):
                rows[i] = {name: x[i] for name, x in last.items()}
            info |= {"final_obs": rows, "_final_obs": over}
        return info

    def _reset_mask(self, options: dict[str, Any]) -> np.ndarray:
        if options.get("reset_mask") is None:
            return self._everywhere
        mask = np.asarray(jax.device_get(to_jax(options["reset_mask"]))) > 0
        if mask.shape != (self.num_envs,) or not mask.any():
            raise ValidationError(
                f"options['reset_mask']: found {mask.sum()} of {mask.shape}, needed ({self.num_envs},) with a True."
            )
        return mask
