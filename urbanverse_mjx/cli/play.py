"""`urbanverse play`: one agent over a few episodes, as a video. Needs no checkpoint with zero, random or go_to_goal."""

import dataclasses
import json
import pathlib
from collections.abc import Sequence
from typing import TYPE_CHECKING

import tyro

from ..datatypes import NounError
from ..datatypes import validation as v

if TYPE_CHECKING:
    from ml_collections import ConfigDict

    from ..evaluation.agents import Agent


@dataclasses.dataclass(frozen=True)
class PlayArgs:
    """Drive episodes and write them as an mp4; prints one JSON line with how they ended."""

    agent: str = "go_to_goal"
    """zero, random, go_to_goal, or trained (needs --policy)."""
    policy: pathlib.Path | None = None
    """Policy or run folder for --agent trained."""
    env_name: str | None = None
    """Whose robot is driven; default: the policy's own, else CocoNav."""
    preset: str = "cpu"
    """Of the environment, where no policy brings its own."""
    scenes: str = "test"
    num_episodes: int = 2
    """Episodes that are driven; all are in the video but for --only-successes and --shown."""
    only_successes: bool = False
    """Leave out of the video what did not end at its goal."""
    shown: int | None = None
    """At most so many episodes in the video, the first ones."""
    seed: int = 0
    fps: float | None = None
    """Pictures a second, a multiple of the control rate, at which the agent still decides; default: that rate."""
    size: tuple[int, int] = (180, 320)
    """Height and width of each of the two pictures."""
    samples: int = 1
    """Rays a pixel along each side."""
    quality: float = 7.0
    """Of the video, 0 to 10."""
    out: pathlib.Path = pathlib.Path("rollout.mp4")


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse play`."""
    args = tyro.cli(PlayArgs, args=list(argv), prog="urbanverse play")
    from ..envs import registry
    from ..evaluation import Rollout, fixed_episodes
    from ..pipeline import ensure_default_bank
    from ..viz.video import write_rollout_video

    if args.shown is not None:
        v.integer(args.shown, "--shown", 1)
    agent, name, config = _chosen(args)
    hold = _steps_held(args.fps, config.ctrl_dt)
    finer = {"ctrl_dt": config.ctrl_dt / hold}
    finer |= {k: config[k] * hold for k in ("episode_length", "success_after_step")}
    env = registry.load(name, config=registry.with_overrides(config, finer), bank=ensure_default_bank())
    episodes = fixed_episodes(env, args.num_episodes, args.seed)
    results, poses = Rollout(env, hold=hold).run({args.agent: agent}, episodes)
    shown = [i for i, r in enumerate(results) if r.success or not args.only_successes]
    if not shown:
        raise NounError(f"--only-successes: found none among {len(results)} episodes, needed one; drive more.")
    shown = shown[: args.shown]
    write_rollout_video(
        args.out,
        env.bank,
        env.robot,
        poses,
        columns=shown,
        scenes=[int(episodes.scenes[i]) for i in shown],
        goals=[env.bank.episode_goal[episodes.scenes[i], episodes.episodes[i]] for i in shown],
        frames_per_second=round(1 / env.dt),
        size=args.size,
        samples=args.samples,
        quality=args.quality,
    )
    print(json.dumps({"video": str(args.out), "results": [r.to_json() for r in results]}))
    return 0


def _chosen(args: PlayArgs) -> tuple["Agent", str, "ConfigDict"]:
    """The agent, the environment and its config."""
    from ..envs import registry
    from ..envs.randomization import OFF
    from ..evaluation import BASELINES

    if args.agent in BASELINES:
        # Baselines do not look, so nothing is rendered while they drive.
        name = args.env_name or "CocoNav"
        config = registry.get_default_config(name, args.preset)
        return BASELINES[args.agent], name, registry.with_overrides(config, {"scenes": args.scenes, "vision": False})
    if args.agent != "trained":
        raise NounError(f"--agent: found {args.agent!r}, needed trained, {', '.join(BASELINES)}.")
    if args.policy is None:
        raise NounError("--policy: found nothing, needed a policy or run folder for --agent trained.")
    from ml_collections import ConfigDict

    from ..training.policy import load_policy

    agent, spec = load_policy(args.policy)
    name, config = args.env_name or spec.environment, ConfigDict(spec.env_config)
    if name != spec.environment:
        config = registry.same_task(config, name)
    return agent, name, registry.with_overrides(config, {"scenes": args.scenes, "randomization": OFF})


def _steps_held(fps: float | None, control_period: float) -> int:
    """How many pictures one control step is.

    Raises:
      NounError: no whole number.
    """
    if fps is None:
        return 1
    steps = fps * control_period
    if steps < 0.5 or abs(steps - round(steps)) > 1e-6:
        raise v.fail("--fps", f"{fps:g}", f"a whole multiple of the control rate {1 / control_period:g}")
    return round(steps)
