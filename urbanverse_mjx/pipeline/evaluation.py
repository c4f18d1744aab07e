"""Evaluates a policy and its baselines over fixed episodes on unseen streets."""

import dataclasses
import pathlib
from collections.abc import Mapping, Sequence
from typing import Any

from ml_collections import ConfigDict

from ..datatypes import EpisodeResult, SceneBank
from ..envs import NavEnv, registry
from ..envs.navigation.draws import OFF
from ..envs.navigation.scenarios import scenario_of
from ..evaluation import (
    BASELINES,
    Agent,
    Rollout,
    Trajectory,
    blank_image,
    fixed_episodes,
    go_to_goal,
    make_report,
    write_report,
)
from ..evaluation.agents import Privileged, Recurrent
from ..evaluation.rollouts import EpisodeSet
from ..progress import COMPILING, Progress
from .rollout_video import random_draw, write_episodes

#: Number of episodes in the video of an evaluation.
NUM_SHOWN = 3


def evaluation_config(environment: str, trained: Mapping[str, Any], scenes: Any, dynamic: bool) -> ConfigDict:
    """The config of a policy's training without randomisation; with people if `dynamic`.

    Configs of older policies have no crowd and get that of their preset.
    """
    values = dict(trained)
    if dynamic:
        fresh = registry.get_default_config(environment, values["preset"]).to_dict()
        values = {**values, "scenario": "dynamic", "crowd": values.get("crowd", fresh["crowd"])}
    return registry.with_overrides(ConfigDict(values), {"scenes": scenes, "randomization": OFF})


@dataclasses.dataclass(frozen=True)
class _Entrants:
    """The policies of an evaluation and their environments.

    Attributes:
      name: name of the evaluated policy.
      environment: registered name of the environment.
      env: environment, with a renderer if any policy needs images.
      groups: environments with their agents by name, which are simulated together.
      record: origin of the policy.
    """

    name: str
    environment: str
    env: NavEnv
    groups: Sequence[tuple[NavEnv, Mapping[str, Agent | Privileged | Recurrent]]]
    record: Mapping[str, Any]


#: Names of scripted policies.
SCRIPTED = (*BASELINES, "planner")


def _scripted(
    name: str,
    bank: SceneBank,
    scenes: Any,
    dynamic: bool,
    environment: str,
    preset: str,
    overrides: Mapping[str, Any],
) -> _Entrants:
    """A scripted policy without a renderer."""
    from ..evaluation.task_agents import planner_of

    values = registry.get_default_config(environment, preset).to_dict()
    config = evaluation_config(environment, values, scenes, dynamic)
    config = registry.with_overrides(config, {**overrides, "vision": False})
    env = registry.load_nav_env(environment, config, bank)
    policy = planner_of(env) if name == "planner" else BASELINES[name]
    privileged = isinstance(policy, Privileged)
    return _Entrants(name, environment, env, [(env, {name: policy})], {"policy": name, "privileged": privileged})


def _trained(
    policy: pathlib.Path,
    bank: SceneBank,
    scenes: Any,
    dynamic: bool,
    environment: str | None,
    overrides: Mapping[str, Any],
) -> _Entrants:
    """A trained policy and its baselines."""
    from ..training.policy import load_policy, untrained_policy

    act, spec = load_policy(policy)
    environment = environment or spec.environment
    trained = ConfigDict(spec.env_config)
    if environment != spec.environment:
        trained = registry.same_task(trained, environment)
    config = evaluation_config(environment, trained.to_dict(), scenes, dynamic)
    config = registry.with_overrides(config, overrides)
    env = registry.load_nav_env(environment, config, bank)
    # Without a renderer, for policies without images.
    blind = NavEnv(env.config, env.bank, env.robot, env.engine, None)
    images = {name: shape for name, shape in spec.observations.items() if name.startswith("pixels/")}
    unseeing = {"go_to_goal": go_to_goal, "trained_blank_image": blank_image(act, images)}
    record = {"policy": str(policy), "privileged": False, "steps": spec.steps, "versions": spec.versions}
    return _Entrants(
        "trained",
        environment,
        env,
        [(env, {"untrained": untrained_policy(spec), "trained": act}), (blind, unseeing)],
        record,
    )


def _drive(
    groups: Sequence[tuple[NavEnv, Mapping[str, Agent | Privileged | Recurrent]]], episodes: EpisodeSet, quiet: bool
) -> tuple[list[EpisodeResult], dict[str, tuple[Trajectory, int]]]:
    """Runs all agents on the same episodes.

    Returns:
      the results, and by the agent's name the poses of its batch and the column of its first episode.
    """
    results, trajectories = [], {}
    for env, policies in groups:
        with Progress(quiet) as progress:
            name, number = f"evaluating {', '.join(policies)}", len(episodes) * len(policies)
            report = progress.task(name, number, unit="episodes", note=COMPILING)
            part, poses = Rollout(env).run(policies, episodes, lambda ended, _, report=report: report(ended, note=""))
        results += part
        trajectories.update({name: (poses, i * len(episodes)) for i, name in enumerate(policies)})
    return results, trajectories


def evaluate_policy(
    policy: str | pathlib.Path,
    bank: SceneBank,
    folder: pathlib.Path,
    num_episodes: int,
    seed: int,
    video: bool,
    quiet: bool,
    scenes: Any = "test",
    dynamic: bool = False,
    environment: str | None = None,
    preset: str = "paper",
    env_overrides: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """Runs all agents on the same episodes, writes report and video, and returns agent -> metrics.

    A trained policy is compared with three baselines: `untrained` (the same networks with initial parameters),
    `go_to_goal` (straight to the goal, without images) and `trained_blank_image` (the trained policy with black
    images).

    Args:
      policy: a policy folder, or one of `SCRIPTED`.
      video: whether to write a video of `NUM_SHOWN` episodes, drawn at random with `seed`.
      dynamic: whether there are moving people and objects.
      environment: environment whose robot is driven; None for that of the policy's training, CocoNav for scripted
        policies.
      preset: preset of the environment, for scripted policies.
      env_overrides: flat dotted keys of the environment's config that override those of the policy or preset.
    """
    overrides = dict(env_overrides or {})
    if str(policy) in SCRIPTED:
        entrants = _scripted(str(policy), bank, scenes, dynamic, environment or "CocoNav", preset, overrides)
    else:
        entrants = _trained(pathlib.Path(policy), bank, scenes, dynamic, environment, overrides)
    env = entrants.env
    # The episodes do not depend on the policy.
    episodes = fixed_episodes(env, num_episodes, seed)
    results, trajectories = _drive(entrants.groups, episodes, quiet)
    record = {
        **entrants.record,
        "environment": entrants.environment,
        "preset": env.config.preset,
        "scenario": scenario_of(env.config),
        "scenes": ", ".join(bank.scene_ids[i] for i in env.scenes),
        "seed": seed,
        **({"overrides": overrides} if overrides else {}),
        "hashes": bank.meta.get("hashes", {}),
    }
    where = " on unseen streets" if scenes == "test" else ""
    report = make_report(f"{entrants.environment}: {num_episodes} fixed episodes{where}", results, record)
    write_report(report, folder)
    if video:
        own = [r for r in results if r.agent == entrants.name]
        poses, first = trajectories[entrants.name]
        shown = random_draw(range(num_episodes), NUM_SHOWN, seed)
        with Progress(quiet) as progress:
            report_drawn = progress.task("drawing", len(shown), unit="episodes")
            path = folder / "rollout.mp4"
            write_episodes(path, env, episodes, own, poses, shown, first, on_progress=report_drawn)
    return dict(report.summary)
