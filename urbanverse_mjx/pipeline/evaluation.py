"""A policy and its comparisons over fixed episodes on unseen streets."""

import pathlib
from collections.abc import Mapping
from typing import Any

from ml_collections import ConfigDict
from rich.console import Console
from rich.progress import Progress, TaskID

from ..datatypes import EpisodeResult, SceneBank
from ..envs import NavEnv, registry
from ..envs.navigation.draws import OFF
from ..envs.navigation.living import slot_looks
from ..envs.navigation.scenarios import scenario_of
from ..evaluation import Agent, Rollout, blank_image, fixed_episodes, go_to_goal, make_report, write_report
from ..evaluation.rollouts import EpisodeSet


def evaluation_config(environment: str, trained: Mapping[str, Any], scenes: Any, dynamic: bool) -> ConfigDict:
    """The config a policy was trained with, everything as the bank describes it; with people where `dynamic`.

    Policies from before there were people know nothing of a crowd: they meet that of their preset.
    """
    values = dict(trained)
    if dynamic:
        fresh = registry.get_default_config(environment, values["preset"]).to_dict()
        values = {**values, "scenario": "dynamic", "crowd": values.get("crowd", fresh["crowd"])}
    return registry.with_overrides(ConfigDict(values), {"scenes": scenes, "randomization": OFF})


def _drive(
    seeing: NavEnv, agents: Mapping[str, Agent], unseeing: Mapping[str, Agent], episodes: EpisodeSet, quiet: bool
) -> tuple[list[EpisodeResult], dict[str, Any]]:
    """Drives the same episodes by agents that look and by others that do not.

    Returns:
      the results, and the poses of each agent's batch by the agent's name.
    """
    # Without a renderer: nothing is drawn for those who do not look.
    blind = NavEnv(seeing.config, seeing.bank, seeing.robot, seeing.engine, None)
    results, trajectories = [], {}
    for env, drivers in ((seeing, agents), (blind, unseeing)):
        with Progress(console=Console(stderr=True), disable=quiet) as bar:
            task = bar.add_task(f"evaluating {', '.join(drivers)}", total=len(episodes) * len(drivers))

            def show(ended: int, _: int, bar: Progress = bar, task: TaskID = task) -> None:
                bar.update(task, completed=ended)

            part, poses = Rollout(env).run(drivers, episodes, show)
        results += part
        trajectories.update(dict.fromkeys(drivers, poses))
    return results, trajectories


def evaluate_policy(
    policy: pathlib.Path,
    bank: SceneBank,
    folder: pathlib.Path,
    num_episodes: int,
    seed: int,
    video: bool,
    quiet: bool,
    scenes: Any = "test",
    dynamic: bool = False,
    environment: str | None = None,
) -> dict[str, Any]:
    """Drives the same episodes by four agents, writes report and video, returns agent -> metrics.

    Agents: `untrained` (the same networks before training), `trained`, `go_to_goal` (straight ahead, sees nothing)
    and `trained_blank_image` (the trained policy with its camera covered).

    Args:
      dynamic: the streets are full of people.
      environment: whose robot is driven; None = the one that the policy was trained with.
    """
    from ..training.policy import load_policy, untrained_policy

    act, spec = load_policy(policy)
    untrained = untrained_policy(spec)
    environment = environment or spec.environment
    trained = ConfigDict(spec.env_config)
    if environment != spec.environment:
        trained = registry.same_task(trained, environment)
    # The same episodes for every policy, however it was trained.
    config = evaluation_config(environment, trained.to_dict(), scenes, dynamic)
    seeing = registry.load(environment, config=config, bank=bank)
    episodes = fixed_episodes(seeing, num_episodes, seed)
    agents = {"untrained": untrained, "trained": act}
    pictures = {name: shape for name, shape in spec.observations.items() if name.startswith("pixels/")}
    unseeing = {"go_to_goal": go_to_goal, "trained_blank_image": blank_image(act, pictures)}
    results, trajectories = _drive(seeing, agents, unseeing, episodes, quiet)
    record = {
        "policy": str(policy),
        "environment": environment,
        "steps": spec.steps,
        "preset": config.preset,
        "scenario": scenario_of(config),
        "scenes": ", ".join(bank.scene_ids[i] for i in seeing.scenes),
        "seed": seed,
        "hashes": bank.meta.get("hashes", {}),
        "versions": spec.versions,
    }
    report = make_report(f"{environment}: {num_episodes} fixed episodes on unseen streets", results, record)
    write_report(report, folder)
    if video:
        from ..viz.video import write_rollout_video

        chosen = [i for i, r in enumerate(r for r in results if r.agent == "trained") if r.success] or [0]
        write_rollout_video(
            folder / "rollout.mp4",
            bank,
            seeing.robot,
            trajectories["trained"],
            # `trained` is the second agent of its batch.
            columns=[num_episodes + i for i in chosen[:3]],
            scenes=[int(episodes.scenes[i]) for i in chosen[:3]],
            goals=[bank.episode_goal[episodes.scenes[i], episodes.episodes[i]] for i in chosen[:3]],
            frames_per_second=round(1 / seeing.dt),
            looks=slot_looks(seeing.living.kinds, bank) if seeing.living is not None else (),
        )
    return dict(report.summary)
