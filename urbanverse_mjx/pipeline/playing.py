"""Runs one agent on some episodes and writes a video."""

import dataclasses
import os
import pathlib
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ..datatypes import ValidationError
from ..datatypes import validation as v

if TYPE_CHECKING:
    from ml_collections import ConfigDict

    from ..envs import NavEnv
    from ..evaluation.agents import Agent, Privileged
    from ..evaluation.rollouts import EpisodeSet


@dataclasses.dataclass(frozen=True)
class PlayOptions:
    """Policy, scenes and contents of the video."""

    policy: str | os.PathLike[str] | None = None
    """zero, random, go_to_goal, planner (with full knowledge of the scene), or a policy or run folder; default:
    go_to_goal."""
    agent: str | None = None
    """Former option: another place for the names of --policy, and trained for a folder there."""
    env_name: str | None = None
    """Environment whose robot is driven; default: that of the policy, else CocoNav."""
    preset: str = "cpu"
    """Preset of the environment, for scripted policies; trained ones bring theirs. The default has the smallest
    image."""
    bank: pathlib.Path | None = None
    """Scene bank; default: that of the shipped streets, or the one that URBANVERSE_BANK names."""
    env_overrides: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    """Flat dotted keys of the environment's config, such as the robot."""
    dynamic: bool = False
    """With moving people and vehicles."""
    scenes: str = "test"
    """train, test, validation, all, or scene ids separated by commas."""
    num_episodes: int = 2
    """Number of episodes; all are in the video except with --only-successes and --shown."""
    only_successes: bool = False
    """Leave episodes that did not reach their goal out of the video."""
    prefer_successes: bool = False
    """Leave them out where at least one reached it."""
    shown: int | None = None
    """Largest number of episodes in the video, drawn at random with --seed."""
    last: float | None = None
    """s at the end of each episode that are in the video; default: all."""
    azimuth: float = 0.0
    """Degrees by which the camera behind the robot is turned around it, counterclockwise seen from above."""
    nearness: float = 1.0
    """Share of that camera's usual distance from the robot."""
    seed: int = 0
    """Draws the episodes, and what is random in them."""
    fps: float | None = None
    """Images per second, a multiple of the control rate, at which the agent still acts; default: the control rate."""
    size: tuple[int, int] = (180, 320)
    """Height and width of each of the two images."""
    samples: int = 1
    """Rays per pixel along each side."""
    quality: float = 7.0
    """Quality of the video, 0 to 10."""
    encoder: str = "medium"
    """Effort for small files: ultrafast, fast, medium, slow or veryslow, the presets of x264."""
    html: pathlib.Path | None = None
    """Also write the first episode of the video as one interactive HTML file; not with --fps."""
    quiet: bool = False
    """No progress bars."""


def play(out: str | os.PathLike[str], options: PlayOptions | None = None) -> dict[str, Any]:
    """Runs episodes and writes them as an mp4. Scripted agents need no checkpoint.

    Returns:
      video: the file; results: an `EpisodeResult` of every episode, as JSON.

    Raises:
      ValidationError: the agent, policy or scene does not exist, there is no episode to show, or a page is combined
        with another frame rate.
    """
    from ..envs import registry
    from ..evaluation import Rollout, fixed_episodes
    from ..evaluation.task_agents import planner_of
    from ..progress import COMPILING, Progress
    from ..viz.video import ENCODER_PRESETS
    from .banks import chosen_bank
    from .rollout_video import random_draw, write_episodes

    options = options or PlayOptions()
    if options.shown is not None:
        v.integer(options.shown, "--shown", 1)
    if options.last is not None and not options.last > 0.0:
        raise v.fail("--last", f"{options.last:g}", "s greater than 0", "leave it out for whole episodes")
    if not 0.2 <= options.nearness <= 5.0:
        raise v.fail("--nearness", f"{options.nearness:g}", "0.2 to 5")
    v.choice(options.encoder, "--encoder", ENCODER_PRESETS)
    who = _named(options)
    agent, name, config = _chosen(who, options)
    config = registry.with_overrides(config, options.env_overrides)
    hold = _steps_held(options.fps, config.ctrl_dt, _finest_step(config))
    if options.html is not None and hold > 1:
        raise v.fail("--html", f"--fps {options.fps:g} beside it", "the control rate", "leave one of them out")
    finer = {"ctrl_dt": config.ctrl_dt / hold}
    finer |= {k: config[k] * hold for k in ("episode_length", "success_after_step")}
    env = registry.load_nav_env(name, registry.with_overrides(config, finer), chosen_bank(options.bank))
    if agent is None:
        agent = planner_of(env)
    episodes = fixed_episodes(env, options.num_episodes, options.seed)
    with Progress(options.quiet) as progress:
        report = progress.task("driving", len(episodes), unit="episodes", note=COMPILING)
        results, poses = Rollout(env, hold=hold).run({who: agent}, episodes, lambda ended, _: report(ended, note=""))
    shown = _to_show([bool(r.success) for r in results], options)
    shown = random_draw(shown, options.shown, options.seed)
    style = {
        name: getattr(options, name)
        for name in ("size", "samples", "quality", "encoder", "last", "azimuth", "nearness")
    }
    with Progress(options.quiet) as progress:
        report = progress.task("drawing", len(shown), unit="episodes")
        write_episodes(pathlib.Path(out), env, episodes, results, poses, shown, on_progress=report, **style)
    if options.html is not None:
        _write_html(options.html, env, who, agent, episodes, shown[0])
    return {"video": str(out), "results": [r.to_json() for r in results]}


def _to_show(reached: Sequence[bool], options: PlayOptions) -> list[int]:
    """The numbers of the episodes that may be in the video; reached: whether each reached its goal.

    Raises:
      ValidationError: only successes are asked for, and there is none.
    """
    at_goal = [i for i, reached_it in enumerate(reached) if reached_it]
    if options.only_successes:
        if not at_goal:
            raise ValidationError(
                f"--only-successes: found none among {v.counted(len(reached), 'episodes')}, needed one; drive more."
            )
        return at_goal
    return at_goal if options.prefer_successes and at_goal else list(range(len(reached)))


def _write_html(path: pathlib.Path, env: "NavEnv", name: str, agent: Any, episodes: "EpisodeSet", shown: int) -> None:
    """Runs one of the episodes again with the same random draws and writes it as a page."""
    from ..viewer.recording import html_recording
    from ..viewer.session import Machine, NamedPolicy, Session
    from ..viewer.street import StreetMeshes

    scene, row = int(episodes.scenes[shown]), int(episodes.episodes[shown])
    session = Session(Machine(env, NamedPolicy(name, agent)), scene, [row], keys=episodes.keys()[shown : shown + 1])
    while not session.over:
        session.step()
    page = html_recording(session, StreetMeshes(env.bank, scene))
    v.write_atomically(path, lambda temporary: temporary.write_text(page, encoding="utf-8"))


def _named(options: PlayOptions) -> str:
    """The name of the agent: a scripted one, or trained.

    Raises:
      ValidationError: --agent and --policy name two agents, or --agent names none.
    """
    from ..evaluation import BASELINES

    scripted, policy = (*BASELINES, "planner"), None if options.policy is None else os.fspath(options.policy)
    named = "trained" if policy is not None and policy not in scripted else policy
    if options.agent not in (None, "trained", *scripted):
        raise ValidationError(f"--agent: found {options.agent!r}, needed trained, {', '.join(scripted)}.")
    if None not in (named, options.agent) and named != options.agent:
        raise ValidationError(f"--policy: found {policy!r} beside --agent {options.agent}, needed one of them.")
    return named or options.agent or "go_to_goal"


def _chosen(who: str, options: PlayOptions) -> tuple["Agent | Privileged | None", str, "ConfigDict"]:
    """Makes the agent (None for the planner, which needs the environment), the environment and its config.

    Raises:
      ValidationError: the agent or policy does not exist, or the environment is not a navigation task.
    """
    from ..envs import registry
    from ..evaluation import BASELINES
    from .evaluation import evaluation_config

    if who != "trained":
        name = options.env_name or "CocoNav"
        config = registry.get_default_config(name, options.preset)
        if "goal_mode" not in config:
            raise ValidationError(
                f"--env-name: found {name!r}, whose robot has no goal to drive to, needed a navigation environment "
                "such as CocoNav or Go2Nav."
            )
        # Scripted agents need no images, so they run without a renderer.
        config = registry.with_overrides(config, {"scenes": options.scenes, "vision": False})
        if options.dynamic:
            config = registry.with_overrides(config, {"scenario": "dynamic"})
        return BASELINES.get(who), name, config
    if options.policy is None:
        raise ValidationError("--policy: found nothing, needed a policy or run folder for --agent trained.")
    path = pathlib.Path(options.policy).expanduser()
    if path.suffix == ".onnx":
        raise ValidationError(
            f"--policy: found {str(path)!r}, needed a policy or run folder; ONNX files are driven by "
            "`urbanverse view`, `record` and `benchmark`."
        )
    if not path.is_dir():
        known = ", ".join((*BASELINES, "planner"))
        raise ValidationError(f"--policy: found {str(path)!r}, needed one of {known}, or a policy or run folder.")
    from ml_collections import ConfigDict

    from ..training.policy import load_policy

    agent, spec = load_policy(path)
    name, config = options.env_name or spec.environment, ConfigDict(spec.env_config)
    if name != spec.environment:
        config = registry.same_task(config, name)
    return agent, name, evaluation_config(name, config.to_dict(), options.scenes, options.dynamic)


def _finest_step(config: "ConfigDict") -> float:
    """s, what control steps of a config are whole multiples of: the gait's own step, or the simulation's."""
    if "gait" not in config:
        return config.sim_dt
    from ..envs.robot import make_robot
    from ..robots import gait_of

    return gait_of(make_robot(config), config.gait or None).control_dt


def _steps_held(fps: float | None, control_period: float, finest: float) -> int:
    """Number of images per control step.

    Args:
      control_period: s of a control step.
      finest: s, of which the time between two images is a whole multiple.

    Raises:
      ValidationError: the number, or this multiple, is not an integer.
    """
    if fps is None:
        return 1
    parts = round(control_period / finest)
    possible = [n for n in range(1, parts + 1) if parts % n == 0]
    for n in possible:
        if abs(fps * control_period - n) < 1e-6:
            return n
    rates = ", ".join(f"{n / control_period:g}" for n in possible)
    raise v.fail("--fps", f"{fps:g}", f"one of {rates}, whose images are whole steps of the simulation apart")
