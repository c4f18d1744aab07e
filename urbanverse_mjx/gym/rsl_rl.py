"""`RslRlVecEnv`: vector env for the runners of rsl_rl (5 or newer). Requires `rsl-rl-lib` and PyTorch."""

from typing import Any

import torch  # pyright: ignore[reportMissingImports]
from gymnasium.vector import AutoresetMode, VectorEnv
from rsl_rl.env import VecEnv  # pyright: ignore[reportMissingImports]
from tensordict import TensorDict  # pyright: ignore[reportMissingImports]

from ..datatypes import ValidationError
from .vector import UrbanVectorEnv


class RslRlVecEnv(VecEnv):
    """Vector env of rsl_rl: episodes restart automatically, and time-outs are reported separately.

    Each observation is a group of the same name. Images of (height, width, 3) uint8 become (3, height, width) f32 in
    [0, 1]; all other observations share JAX's memory.

    Args:
      envs: of `gymnasium.make_vec(..., output="torch", autoreset_mode="SameStep", final_obs=False)`.
      seed: of the first episodes, see `UrbanVectorEnv.reset`.

    Raises:
      ValidationError: `envs` is of another class, or has another output or autoreset mode.
    """

    def __init__(self, envs: VectorEnv[Any, Any, Any], seed: int = 0) -> None:
        inner = envs.unwrapped
        if not isinstance(inner, UrbanVectorEnv) or inner.output != "torch":
            raise ValidationError(
                f'envs: found {envs}, needed a vector of this package with output="torch"; see gymnasium.make_vec.'
            )
        if envs.metadata["autoreset_mode"] is not AutoresetMode.SAME_STEP:
            raise ValidationError(
                f'autoreset_mode: found {envs.metadata["autoreset_mode"].value}, needed "SameStep", as rsl_rl expects.'
            )
        self._envs, self.cfg = envs, inner.config.to_dict()
        self.num_envs, self.num_actions = inner.num_envs, inner.num_actions
        self.max_episode_length = int(inner.config.episode_length)
        obs, info = envs.reset(seed=seed)
        self._obs, self._steps = self._grouped(obs), info["steps"]
        self.device = info["steps"].device

    @property
    def episode_length_buf(self) -> torch.Tensor:
        """Returns the steps (num_envs,) i32 of the running episodes."""
        return self._steps.to(torch.int32)

    @episode_length_buf.setter
    def episode_length_buf(self, value: torch.Tensor) -> None:
        raise ValidationError(
            "episode_length_buf: found new lengths, needed none, because the simulation counts the steps; "
            "call learn(..., init_at_random_ep_len=False)."
        )

    def get_observations(self) -> TensorDict:
        """Returns the observations of the last call of `step`, or the first ones."""
        return self._obs

    def step(self, actions: torch.Tensor) -> tuple[TensorDict, torch.Tensor, torch.Tensor, dict[str, Any]]:
        """Runs one control step; returns observations, rewards (num_envs,) f32, dones (num_envs,) bool and extras.

        The extras are "time_outs", (num_envs,) bool, and "log": the share of successes and the mean route completion of
        the episodes that ended with this step, if the environment measures them.
        """
        obs, reward, terminated, truncated, info = self._envs.step(actions)
        self._obs, self._steps = self._grouped(obs), info["steps"]
        ended = terminated | truncated
        extras: dict[str, Any] = {"time_outs": truncated}
        if bool(ended.any()):
            final = info["final_info"]
            logged = (name for name in ("success", "route_completion") if name in final)
            extras["log"] = {f"/{name}": final[name][ended].mean() for name in logged}
        return self._obs, reward, ended, extras

    def _grouped(self, obs: dict[str, torch.Tensor]) -> TensorDict:
        groups = {name: _channels_first(x) if x.dtype == torch.uint8 and x.ndim == 4 else x for name, x in obs.items()}
        return TensorDict(groups, batch_size=[self.num_envs])


def _channels_first(images: torch.Tensor) -> torch.Tensor:
    return images.permute(0, 3, 1, 2).float() / 255.0
