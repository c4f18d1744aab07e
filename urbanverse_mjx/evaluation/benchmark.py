"""Runs a frozen protocol and summarises the results.

In:   an environment over a protocol's bank, a policy. Out:  `Outcome`: results and trajectories; tables as JSON, CSV
and Markdown. When: once per benchmark and contact rule.
"""

import dataclasses
import pathlib
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ..datatypes import BenchmarkReport, EpisodeResult
from ..datatypes import validation as v
from ..envs import NavEnv
from .agents import Agent, BatchAgent, Privileged
from .frozen import Runs
from .report import write_csv
from .rollouts import EpisodeSet, Rollout, result_counts
from .scores import SCORES, Table, by_scene, over_runs, over_scenes, rounded, scores

#: Contact rules: contact ends an episode (paper), or is counted and the episode continues.
CONTACTS = ("ends", "goes_on")
#: Columns of the tables by their titles.
_LABELS = {
    "SR": "SR %",
    "CT": "CT %",
    "RC": "RC %",
    "DTG": "DTG m",
    "hit_episodes": "episodes with contact %",
    "SPL": "SPL %",
    "failures": "failures / 100 m",
    "speed": "m/s",
    "reached": "at the goal %",
}


@dataclasses.dataclass(frozen=True)
class Outcome:
    """Results of a policy on a protocol.

    Attributes:
      results: in the order of the episodes.
      trajectories: (T, 2) m for each episode, position of the robot at every control step.
    """

    results: tuple[EpisodeResult, ...]
    trajectories: tuple[np.ndarray, ...]


def drive(
    env: NavEnv,
    name: str,
    policy: Agent | Privileged | BatchAgent,
    episodes: EpisodeSet,
    batched: bool,
    at_once: int,
    on_progress: Callable[[int, int], None] | None = None,
) -> Outcome:
    """Drives every episode once, `at_once` of them in parallel.

    Args:
      batched: whether the policy is a `BatchAgent`.
      on_progress: called with (ended, total).
    """
    at_once = min(at_once, len(episodes))
    rollout, root = Rollout(env), env.mj_model.body(env.robot.root_body).id
    results: list[EpisodeResult] = []
    trajectories: list[np.ndarray] = []
    for first in range(0, len(episodes), at_once):
        # The last batch is padded with repeated episodes, so that only one size is compiled.
        rows = np.minimum(np.arange(first, first + at_once), len(episodes) - 1)
        real = min(at_once, len(episodes) - first)

        def show(ended: int, _: int, first: int = first, real: int = real) -> None:
            if on_progress is not None:
                on_progress(first + min(ended, real), len(episodes))

        part = episodes.part(rows)
        if batched:
            found, poses = rollout.run_batch(name, policy, part, show)  # type: ignore[arg-type]
        else:
            found, poses = rollout.run({name: policy}, part, show)  # type: ignore[dict-item]
        results += found[:real]
        trajectories += [poses.xpos[poses.running[:, i], i, root, :2] for i in range(real)]
    return Outcome(tuple(results), tuple(trajectories))


def summary_of(runs: Runs, results: Sequence[EpisodeResult]) -> Table:
    """Score -> mean, standard error and, under `full`, interval."""
    if runs.kind == "paper":
        return over_runs(results, runs.episodes.episodes.tolist())
    return over_scenes(results)


def to_markdown(title: str, tables: Mapping[str, Mapping[str, Table]], by_scenes: Mapping[str, Table], how: str) -> str:
    """Formats the report of a benchmark.

    Args:
      tables: contact rule -> policy -> summary.
      by_scenes: contact rule -> scene -> scores.
      how: explanation of ±.
    """
    lines = [f"# {title}", "", how]
    for contact, rows in tables.items():
        lines += ["", _HEADINGS[contact], "", _head(["policy"], _columns(contact))]
        for policy, table in rows.items():
            cells = [_with_interval(table[s], s) for s in _columns(contact)]
            lines.append(f"| {policy} | " + " | ".join(cells) + " |")
        lines += ["", _head(["scene"], _columns(contact))]
        for scene, values in by_scenes[contact].items():
            cells = [rounded({"mean": values[s]}, s) for s in _columns(contact)]
            lines.append(f"| {scene} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


_HEADINGS = {
    "ends": "## Episodes end at contact",
    "goes_on": "## Episodes continue after contact",
}


def _columns(contact: str) -> tuple[str, ...]:
    # If contact ends an episode, episodes that reach the goal have no contact.
    return SCORES if contact == "goes_on" else tuple(s for s in SCORES if s != "reached")


def _head(first: Sequence[str], columns: Sequence[str]) -> str:
    names = [*first, *(_LABELS[s] for s in columns)]
    return "| " + " | ".join(names) + " |\n" + "|---" * len(names) + "|"


def _with_interval(table: Mapping[str, Any], name: str) -> str:
    text = rounded(table, name)
    if table.get("low") is None:
        return text
    digits = 2 if name in ("CT", "DTG", "failures", "speed") else 1
    return f"{text} [{table['low']:.{digits}f}, {table['high']:.{digits}f}]"


def write_outcome(folder: pathlib.Path, title: str, runs: Runs, outcome: Outcome, record: dict[str, Any]) -> Table:
    """Writes report.json, episodes.csv and scenes.csv of one policy and one contact rule.

    Returns:
      the summary.
    """
    results = outcome.results
    policy = results[0].agent
    summary = summary_of(runs, results)
    folder.mkdir(parents=True, exist_ok=True)
    whole = {**scores(results), "by_score": summary, "by_scene": by_scene(results), "ends": result_counts(results)}
    BenchmarkReport(title, {policy: whole}, results, record).save(folder / "report.json")
    run = {"run": 0} if runs.kind == "paper" else {}
    rows = [{**{k: int(n) for k in run}, **r.to_json()} for r, n in zip(results, runs.episodes.episodes, strict=True)]
    write_csv(folder / "episodes.csv", rows)
    write_csv(folder / "scenes.csv", [{"scene": s, **values} for s, values in by_scene(results).items()])
    return summary


def write_page(folder: pathlib.Path, text: str) -> pathlib.Path:
    """Writes report.md."""
    return v.write_atomically(folder / "report.md", lambda p: p.write_text(text, encoding="utf-8"))
