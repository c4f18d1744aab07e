"""Writes a `BenchmarkReport` as Markdown and CSV."""

import csv
import pathlib
from collections.abc import Mapping, Sequence

from ..datatypes import HIT_GROUND, RESULTS, BenchmarkReport, EpisodeResult
from ..datatypes import validation as v
from .metrics import summarise
from .rollouts import result_counts

_INTERVALS = (
    "Means with 95 % intervals of a bootstrap that draws scenes, then episodes; none over one scene. "
    "SR, CT, RC, SPL in %, DTG in m."
)


def make_report(title: str, results: Sequence[EpisodeResult], record: dict[str, object]) -> BenchmarkReport:
    """Summarises episodes by agent, in order of first appearance."""
    agents = list(dict.fromkeys(r.agent for r in results))
    summary = {a: summarise([r for r in results if r.agent == a]) for a in agents}
    return BenchmarkReport(title, summary, tuple(results), record)


def _cell(entry: dict[str, float | None] | None) -> str:
    if entry is None:
        return "-"
    if entry["low"] is None:
        return f"{entry['mean']:g}"
    return f"{entry['mean']:g} [{entry['low']:g}, {entry['high']:g}]"


def to_markdown(report: BenchmarkReport) -> str:
    """Formats the tables: all scenes, results of episodes, and each scene."""
    lines = [f"# {report.title}", "", _INTERVALS, ""]
    metrics = ("SR", "CT", "RC", "DTG", "hit_episodes", "SPL")
    # Point goals have nobody to lose, no stop elsewhere and nothing to drop.
    others = ("lost", "stopped", "dropped")
    ends = [r for r in RESULTS if r not in others or any(e.result == r for e in report.episodes)]
    lines += ["| agent | " + " | ".join(metrics) + " | episodes | scenes |", "|---" * (len(metrics) + 3) + "|"]
    for agent, values in report.summary.items():
        cells = " | ".join(_cell(values[m]) for m in metrics)
        lines.append(f"| {agent} | {cells} | {values['n']} | {values['scenes']} |")
    lines += _task_table(report)
    lines += _people_table(report)
    lines += [
        "",
        "How the episodes ended:",
        "",
        "| agent | " + " | ".join(ends) + " |",
        "|---" * (len(ends) + 1) + "|",
    ]
    for agent in report.summary:
        counts = result_counts([e for e in report.episodes if e.agent == agent])
        lines.append(f"| {agent} | " + " | ".join(str(counts[r]) for r in ends) + " |")
    ground = {a: sum(e.outcome == HIT_GROUND for e in report.episodes if e.agent == a) for a in report.summary}
    if any(ground.values()):
        counted = ", ".join(f"{agent} {count}" for agent, count in ground.items() if count)
        lines += ["", f"A `hit` of the ground alone, by a part of the robot other than a foot: {counted}."]
    lines += [
        "",
        "By scene (SR / RC in %):",
        "",
        "| scene | " + " | ".join(report.summary) + " |",
        "|---" * (len(report.summary) + 1) + "|",
    ]
    for scene in dict.fromkeys(e.scene for e in report.episodes):
        cells = []
        for agent in report.summary:
            s = summarise([e for e in report.episodes if e.agent == agent and e.scene == scene])
            cells.append(f"{s['SR']['mean']:g} / {s['RC']['mean']:g}")  # type: ignore[index]
        lines.append(f"| {scene} | " + " | ".join(cells) + " |")
    lines += ["", "Made by:", ""]
    lines += [f"* {key}: {value}" for key, value in report.record.items()]
    return "\n".join(lines) + "\n"


def _task_table(report: BenchmarkReport) -> list[str]:
    """Lines about the scores of a task; none for point goals."""
    names = list(dict.fromkeys(name for e in report.episodes for name in e.task_scores or ()))
    if not names:
        return []
    lines = ["", "Scores of the task, means over episodes:", ""]
    lines += ["| agent | " + " | ".join(names) + " |", "|---" * (len(names) + 1) + "|"]
    for agent, values in report.summary.items():
        lines.append(f"| {agent} | " + " | ".join(_cell(values.get(f"task/{m}")) for m in names) + " |")
    return lines


def _people_table(report: BenchmarkReport) -> list[str]:
    """Lines about people; none for scenarios without people."""
    metrics = ("agent_hits", "people_distance", "IT", "speed_near_people")
    if not all("people_distance" in values for values in report.summary.values()):
        return []
    lines = ["", "People: episodes that ended by touching one in %, least distance in m, time within 0.45 m in %,"]
    lines += ["speed within 1.2 m in m/s:", "", "| agent | " + " | ".join(metrics) + " |", "|---" * 5 + "|"]
    for agent, values in report.summary.items():
        lines.append(f"| {agent} | " + " | ".join(_cell(values[m]) for m in metrics) + " |")
    return lines


def write_report(report: BenchmarkReport, folder: pathlib.Path) -> None:
    """Writes report.json, report.md and episodes.csv."""
    folder.mkdir(parents=True, exist_ok=True)
    report.save(folder / "report.json")
    v.write_atomically(folder / "report.md", lambda p: p.write_text(to_markdown(report), encoding="utf-8"))
    write_csv(folder / "episodes.csv", [e.to_row() for e in report.episodes])


def write_csv(path: pathlib.Path, rows: Sequence[Mapping[str, object]]) -> None:
    """Writes rows with the same keys as a table."""

    def write(temporary: pathlib.Path) -> None:
        with temporary.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, list(rows[0]))
            writer.writeheader()
            writer.writerows(rows)

    v.write_atomically(path, write)
