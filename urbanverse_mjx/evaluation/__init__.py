"""Seeded rollouts of agents over fixed episodes, their metrics with intervals, and reports."""

from .agents import BASELINES, Agent, blank_image, go_to_goal
from .metrics import summarise
from .report import make_report, to_markdown, write_report
from .rollouts import EpisodeSet, Rollout, Trajectory, fixed_episodes, result_counts

__all__ = [
    "BASELINES",
    "Agent",
    "EpisodeSet",
    "Rollout",
    "Trajectory",
    "blank_image",
    "fixed_episodes",
    "go_to_goal",
    "make_report",
    "result_counts",
    "summarise",
    "to_markdown",
    "write_report",
]
