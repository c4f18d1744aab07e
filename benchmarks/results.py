"""Writes the table and the figure of all policies on CraftBench and AutoBench from the rows in `benchmarks/scores`.

    python -m benchmarks.results
    python -m benchmarks.results --add runs/student/result.json --agent student --policy student --robot COCO --seed 0

The second command first adds the rows of an agent in a result.json of `benchmarks.generalise` or
`benchmarks.comparison`, replacing those of the same policy, robot and seed. `by_scene.csv` has a row per policy,
training seed and scene; `totals.csv` policies whose scenes are not kept, with the standard error over scenes. Writes
the table between the marks in docs/results.md, and docs/results.png. Intervals come from a bootstrap that samples seeds
(if there are several) and scenes.
"""

import argparse
import collections
import csv
import json
import pathlib
import sys
from typing import NamedTuple

import numpy as np

ROOT = pathlib.Path(__file__).parents[1]
SCORES = ROOT / "benchmarks" / "scores"
PAGE, FIGURE = ROOT / "docs" / "results.md", ROOT / "docs" / "results.png"
MARKS = "<!-- table: python -m benchmarks.results -->", "<!-- end of table -->"
BENCHMARKS = {"craftbench": "CraftBench", "autobench": "AutoBench"}
#: Number of bootstrap samples, and their seed.
DRAWS, SEED = 10_000, 0
#: Standard errors from the mean to the end of a 95 % interval.
NORMAL = 1.96


class Score(NamedTuple):
    """Success rate, %, with its 95 % interval; seeds: number of training seeds, 0 for untrained policies."""

    mean: float
    low: float
    high: float
    seeds: int


def over_seeds_and_scenes(rates: np.ndarray) -> Score:
    """Returns the mean of (seeds, scenes) rates in percent, all over the same number of episodes."""
    seeds, scenes = rates.shape
    rng = np.random.default_rng(SEED)
    rows = rng.integers(0, seeds, (DRAWS, seeds, 1))
    columns = rng.integers(0, scenes, (DRAWS, 1, scenes))
    low, high = np.percentile(rates[rows, columns].mean((1, 2)), [2.5, 97.5])
    return Score(float(rates.mean()), float(low), float(high), seeds)


def read(folder: pathlib.Path) -> dict[tuple[str, str], dict[str, Score]]:
    """Returns (policy, robot) -> benchmark -> score, sorted by the score on CraftBench."""
    found: dict[tuple[str, str], dict[str, Score]] = collections.defaultdict(dict)
    with (folder / "totals.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            mean, part = float(row["SR"]), NORMAL * float(row["se"])
            score = Score(mean, max(mean - part, 0.0), min(mean + part, 100.0), 0)
            found[row["policy"], row["robot"]][row["benchmark"]] = score
    rates: dict[tuple[str, str, str], dict[tuple[str, str], float]] = collections.defaultdict(dict)
    with (folder / "by_scene.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            key = row["policy"], row["robot"], row["benchmark"]
            rates[key][row["seed"], row["scene"]] = float(row["SR"])
    for (policy, robot, benchmark), values in rates.items():
        seeds, scenes = (sorted({key[i] for key in values}) for i in (0, 1))
        missing = [(seed, scene) for seed in seeds for scene in scenes if (seed, scene) not in values]
        if missing:
            raise SystemExit(
                f"error: by_scene.csv: {policy}, {benchmark}: found no row for seed and scene {missing[0]}."
            )
        table = np.array([[values[seed, scene] for scene in scenes] for seed in seeds])
        found[policy, robot][benchmark] = over_seeds_and_scenes(table)
    return dict(sorted(found.items(), key=lambda item: item[1]["craftbench"].mean))


def table(scores: dict[tuple[str, str], dict[str, Score]]) -> str:
    """Markdown."""
    lines = ["| policy | robot | seeds | CraftBench | AutoBench |", "| --- | --- | --- | --- | --- |"]
    for (policy, robot), found in scores.items():
        cells = [f"{s.mean:.1f} [{s.low:.1f}, {s.high:.1f}]" for s in (found[name] for name in BENCHMARKS)]
        lines.append(f"| {policy} | {robot} | {found['craftbench'].seeds or '-'} | {' | '.join(cells)} |")
    return "\n".join(lines)


def with_table(page: str, text: str) -> str:
    """Returns a page with the table between the marks replaced."""
    before, rest = page.split(MARKS[0])
    return f"{before}{MARKS[0]}\n{text}\n{MARKS[1]}{rest.split(MARKS[1])[1]}"


def draw(scores: dict[tuple[str, str], dict[str, Score]], path: pathlib.Path) -> None:
    """Draws points with intervals, a panel for each benchmark."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    labels = [f"{policy} ({robot})" for policy, robot in scores]
    figure, axes = plt.subplots(1, 2, figsize=(10, 0.8 + 0.34 * len(scores)), sharey=True, layout="constrained")
    colours = {"COCO": "#2860be", "Go2": "#d64228"}
    for axis, (name, title) in zip(axes, BENCHMARKS.items(), strict=True):
        for y, ((_, robot), found) in enumerate(scores.items()):
            score = found[name]
            ends = [[score.mean - score.low], [score.high - score.mean]]
            axis.errorbar(score.mean, y, xerr=ends, fmt="o", color=colours[robot], capsize=3)
        axis.set(title=title, xlabel="success rate, % (95 % interval)", xlim=(-3, 103))
        axis.set_yticks(range(len(labels)), labels)
        axis.grid(axis="x", alpha=0.4)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def add(folder: pathlib.Path, result: pathlib.Path, agent: str, policy: str, robot: str, seed: int) -> None:
    """Writes an agent's rows of result.json into by_scene.csv, replacing those of this policy, robot and seed."""
    body = json.loads(result.read_text(encoding="utf-8"))
    if agent not in body:
        raise SystemExit(f"error: {result}: found no agent {agent!r}, needed one of {sorted(set(body) - {'steps'})}.")
    path = folder / "by_scene.csv"
    with path.open(encoding="utf-8", newline="") as file:
        reader = csv.DictReader(file)
        key, columns = (policy, robot, str(seed)), list(reader.fieldnames or ())
        rows = [row for row in reader if (row["policy"], row["robot"], row["seed"]) != key]
    for benchmark in BENCHMARKS:
        for scene, score in sorted(body[agent][benchmark]["by_scene"].items()):
            values = {k: round(score[k], 6) for k in ("SR", "RC", "hit_episodes")}
            about = {"policy": policy, "robot": robot, "seed": seed, "env_steps": body.get("steps", "")}
            rows.append({**about, "benchmark": benchmark, "scene": scene, **values})
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def main() -> int:
    cli = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    cli.add_argument("--add", type=pathlib.Path, help="result.json whose rows are added")
    cli.add_argument("--agent", default="student", help="its key there")
    cli.add_argument("--policy", help="name in the table; default: that of the agent")
    cli.add_argument("--robot", default="COCO")
    cli.add_argument("--seed", type=int, default=0)
    args = cli.parse_args()
    if args.add is not None:
        add(SCORES, args.add, args.agent, args.policy or args.agent, args.robot, args.seed)
    scores = read(SCORES)
    PAGE.write_text(with_table(PAGE.read_text(encoding="utf-8"), table(scores)), encoding="utf-8")
    draw(scores, FIGURE)
    return 0


if __name__ == "__main__":
    sys.exit(main())
