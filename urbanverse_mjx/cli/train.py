"""`urbanverse train`: trains a policy and evaluates it on unseen streets."""

import dataclasses
import json
from collections.abc import Sequence

from .. import pipeline
from ..pipeline.training_run import TrainOptions
from ._options import EnvOverrides, PpoOverrides, parse


@dataclasses.dataclass(frozen=True, kw_only=True)
class TrainArgs(TrainOptions):
    """Train a policy by imitation (presets `quick`, `best`) or Brax PPO; navigation policies are evaluated on unseen
    streets.

    The last line on stdout is one JSON object: SR, CT, RC (%), DTG (m) with 95 % intervals for each agent.
    """

    env_name: str | None = None
    """Registered environment; default CocoNav."""
    preset: str | None = None
    """To navigate: quick (imitation on a laptop, the default), best (a teacher, its imitation and PPO, on a GPU and
    hundreds of streets: --bank), tune (a policy of `best` goes on by PPO in a place of your own, on a GPU: --start-from
    and --bank), cpu (PPO on a laptop), fast (PPO on a GPU), paper and urbansim_v0_1; to walk: cpu (the
    default) and fast."""
    num_timesteps: int | None = None
    """Total env-steps; default: that of the preset. Brax PPO rounds it up to whole rollouts (num_envs x unroll_length),
    equally many before each of the preset's checkpoints: with `cpu` to a multiple of 8 x 2,048 steps."""
    num_envs: int | None = None
    """Number of parallel envs; default: that of the preset."""
    seed: int | None = None
    """Seed of networks, episodes and the evaluation; default 0."""
    env_overrides: EnvOverrides = dataclasses.field(default_factory=dict)
    """JSON of flat dotted env config keys, e.g. '{"reward_config.scales.hit": -10}'."""
    ppo_overrides: PpoOverrides = dataclasses.field(default_factory=dict)
    """JSON of flat dotted PPO config keys, e.g. '{"learning_rate": 1e-3}'."""
    quiet: bool = False
    """No progress bars."""


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse train`."""
    args = parse(TrainArgs, argv, "urbanverse train")
    from ..training.record import RunRequest

    request = RunRequest(
        environment=args.env_name,
        preset=args.preset,
        env_overrides=args.env_overrides,
        ppo_overrides=args.ppo_overrides,
        num_timesteps=args.num_timesteps,
        num_envs=args.num_envs,
        seed=args.seed,
    )
    print(json.dumps(pipeline.train(request, args, args.quiet)))
    return 0
