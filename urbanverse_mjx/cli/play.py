"""`urbanverse play`: one agent over a few episodes, as a video. Needs no checkpoint with zero, random or go_to_goal."""

import dataclasses
import json
import pathlib
from collections.abc import Sequence

import tyro

from ..datatypes import NounError


@dataclasses.dataclass(frozen=True)
class PlayArgs:
    """Drive episodes and write them as an mp4; prints one JSON line with how they ended."""

    agent: str = "go_to_goal"
    """zero, random, go_to_goal, or trained (needs --policy)."""
    policy: pathlib.Path | None = None
    """Policy or run folder for --agent trained."""
    env_name: str = "CocoNav"
    preset: str = "cpu"
    scenes: str = "test"
    num_episodes: int = 2
    seed: int = 0
    out: pathlib.Path = pathlib.Path("rollout.mp4")


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse play`."""
    args = tyro.cli(PlayArgs, args=list(argv), prog="urbanverse play")
    from ..envs import registry
    from ..envs.randomization import OFF
    from ..evaluation import BASELINES, Rollout, fixed_episodes
    from ..viz.video import write_rollout_video
    from .scene import ensure_default_bank

    overrides = {"preset": args.preset, "scenes": args.scenes}
    if args.agent == "trained":
        from ml_collections import ConfigDict

        from ..training.policy import load_policy

        if args.policy is None:
            raise NounError("--policy: found nothing, needed a policy or run folder for --agent trained.")
        agent, spec = load_policy(args.policy)
        config = registry.with_overrides(ConfigDict(spec.env_config), {"scenes": args.scenes, "randomization": OFF})
        env = registry.load(spec.environment, config=config, bank=ensure_default_bank())
    elif args.agent in BASELINES:
        agent = BASELINES[args.agent]
        # Baselines do not look, so nothing is rendered while they drive.
        env = registry.load(args.env_name, config_overrides={**overrides, "vision": False}, bank=ensure_default_bank())
    else:
        raise NounError(f"--agent: found {args.agent!r}, needed trained, {', '.join(BASELINES)}.")
    episodes = fixed_episodes(env, args.num_episodes, args.seed)
    results, poses = Rollout(env).run({args.agent: agent}, episodes)
    write_rollout_video(
        args.out,
        env.bank,
        env.robot,
        poses,
        columns=list(range(len(episodes))),
        scenes=[int(s) for s in episodes.scenes],
        goals=[env.bank.episode_goal[s, e] for s, e in zip(episodes.scenes, episodes.episodes, strict=True)],
        frames_per_second=round(1 / env.dt),
    )
    print(json.dumps({"video": str(args.out), "results": [r.to_json() for r in results]}))
    return 0
