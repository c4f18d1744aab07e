"""Writes episodes of a rollout as a video with their results."""

import pathlib
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..datatypes import EpisodeResult
from ..envs import NavEnv
from ..evaluation import Trajectory
from ..evaluation.rollouts import EpisodeSet


def random_draw(numbers: Sequence[int], count: int | None, seed: int) -> list[int]:
    """Draws `count` of the numbers at random, in their order; returns all of them if there are fewer."""
    if count is None or count >= len(numbers):
        return list(numbers)
    return sorted(int(n) for n in np.random.default_rng(seed).choice(numbers, count, replace=False))


def write_episodes(
    path: pathlib.Path,
    env: NavEnv,
    episodes: EpisodeSet,
    results: Sequence[EpisodeResult],
    trajectory: Trajectory,
    shown: Sequence[int],
    first_column: int = 0,
    **style: Any,
) -> None:
    """Writes some episodes of one agent as an mp4, in real time.

    Args:
      results: results of all episodes, in their order.
      shown: indices of the episodes to write.
      first_column: column of episode 0 in the trajectory.
      style: size, samples, quality, encoder, last, azimuth, nearness and on_progress of
        `viz.video.write_rollout_video`.
    """
    from ..envs.navigation.dynamic import slot_appearances
    from ..viz.video import write_rollout_video

    bank, shown_values = env.bank, trajectory.shown or {}

    def note(column: int, step: int) -> str:
        values = {name: float(x[step, column]) for name, x in shown_values.items()}
        return env.task.note(values) if values else ""

    write_rollout_video(
        path,
        bank,
        env.robot,
        trajectory,
        columns=[first_column + i for i in shown],
        scenes=[int(episodes.scenes[i]) for i in shown],
        goals=[
            bank.episode_goal[episodes.scenes[i], episodes.episodes[i]]
            if trajectory.goals is None
            else trajectory.goals[:, first_column + i]
            for i in shown
        ],
        outcomes=[results[i].outcome for i in shown],
        frames_per_second=round(1 / env.dt),
        appearances=slot_appearances(env.dynamic.kinds, bank) if env.dynamic is not None else (),
        goal_names=[env.task.goal_name(int(episodes.scenes[i]), int(episodes.episodes[i])) for i in shown],
        note=note,
        **style,
    )
