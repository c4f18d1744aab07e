"""Writes the table and the figure of all policies on CraftBench and AutoBench from the rows in `benchmarks/scores`.

    python -m benchmarks.results
    python -m benchmarks.results --add runs/student/result.json --agent student --policy student --robot COCO --seed 0
    python -m benchmarks.results --add runs/teacher/result.json --agent teacher --streets procedural --seed 0

The second command first adds the rows of an agent in a result.json of `benchmarks.generalise` or
`benchmarks.comparison`, replacing those of the same policy, robot and seed. `by_scene.csv` has a row per policy,
training seed and scene; `totals.csv` policies whose scenes are not kept, with the standard error over scenes. The
third command adds to `training_streets.csv`, which has teachers that differ in the streets they trained on alone, and
also scores the composed validation streets. Writes the tables between the marks in docs/results.md, and
docs/results.png. Intervals come from a bootstrap that samples seeds (if there are several) and scenes.
"""

import argparse
import collections
import csv
import json
import pathlib
import sys
from typing import Any, NamedTuple

import numpy as np

ROOT = pathlib.Path(__file__).parents[1]
SCORES = ROOT / "benchmarks" / "scores"
PAGE, FIGURE = ROOT / "docs" / "results.md", ROOT / "docs" / "results.png"
MARKS = "<!-- table: python -m benchmarks.results -->", "<!-- end of table -->"
STREET_MARKS = "<!-- table of training streets: python -m benchmarks.results -->", "<!-- end of training streets -->"
BENCHMARKS = {"craftbench": "CraftBench", "autobench": "AutoBench"}
#: Sets that teachers on other training streets are compared on; the first decides.
COMPARED = {"validation_composed": "composed"} | BENCHMARKS
#: The training streets that others are compared with.
REFERENCE = "144 procedural"
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


def by_seed_and_scene(values: dict[tuple[str, str], float], where: str) -> np.ndarray:
    """Returns values by (seed, scene) as an array (seeds, scenes), in alphabetical order; exits if one is missing."""
    seeds, scenes = (sorted({key[i] for key in values}) for i in (0, 1))
    missing = [(seed, scene) for seed in seeds for scene in scenes if (seed, scene) not in values]
    if missing:
        raise SystemExit(f"error: {where}: found no row for seed and scene {missing[0]}.")
    return np.array([[values[seed, scene] for scene in scenes] for seed in seeds])


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
        table = by_seed_and_scene(values, f"by_scene.csv: {policy}, {benchmark}")
        found[policy, robot][benchmark] = over_seeds_and_scenes(table)
    return dict(sorted(found.items(), key=lambda item: item[1]["craftbench"].mean))


def table(scores: dict[tuple[str, str], dict[str, Score]]) -> str:
    """Markdown."""
    lines = ["| policy | robot | seeds | CraftBench | AutoBench |", "| --- | --- | --- | --- | --- |"]
    for (policy, robot), found in scores.items():
        cells = [f"{s.mean:.1f} [{s.low:.1f}, {s.high:.1f}]" for s in (found[name] for name in BENCHMARKS)]
        lines.append(f"| {policy} | {robot} | {found['craftbench'].seeds or '-'} | {' | '.join(cells)} |")
    return "\n".join(lines)


def difference(a: np.ndarray, b: np.ndarray) -> Score:
    """Returns the mean of a - b with its interval; both (seeds, scenes) rates of the same scenes, other seeds."""
    rng = np.random.default_rng(SEED)
    columns = rng.integers(0, a.shape[1], (DRAWS, 1, a.shape[1]))
    drawn = [x[rng.integers(0, len(x), (DRAWS, len(x), 1)), columns].mean((1, 2)) for x in (a, b)]
    low, high = np.percentile(drawn[0] - drawn[1], [2.5, 97.5])
    return Score(float(a.mean() - b.mean()), float(low), float(high), len(a))


def read_streets(folder: pathlib.Path) -> dict[str, dict[str, np.ndarray]]:
    """Returns training streets -> compared set -> success rates (seeds, scenes), in percent."""
    rates: dict[tuple[str, str], dict[tuple[str, str], float]] = collections.defaultdict(dict)
    with (folder / "training_streets.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            rates[row["streets"], row["set"]][row["seed"], row["scene"]] = float(row["SR"])
    found: dict[str, dict[str, np.ndarray]] = collections.defaultdict(dict)
    for (streets, name), values in rates.items():
        found[streets][name] = by_seed_and_scene(values, f"training_streets.csv: {streets}, {name}")
    return dict(found)


def street_table(rates: dict[str, dict[str, np.ndarray]]) -> str:
    """Markdown: the mean over seeds for each set of streets, and the differences from the reference."""
    names = sorted(rates, key=lambda name: (name != REFERENCE, name))
    rows = [(name, {k: over_seeds_and_scenes(rates[name][k]) for k in COMPARED}) for name in names]
    rows += [
        (f"{name} - {names[0]}", {k: difference(rates[name][k], rates[names[0]][k]) for k in COMPARED})
        for name in names[1:]
    ]
    head = ["trained on", "seeds", *COMPARED.values()]
    lines = [f"| {' | '.join(head)} |", f"|{' --- |' * len(head)}"]
    for name, scores in rows:
        cells = [f"{s.mean:.1f} [{s.low:.1f}, {s.high:.1f}]" for s in scores.values()]
        lines.append(f"| {name} | {scores['craftbench'].seeds} | {' | '.join(cells)} |")
    return "\n".join(lines)


def with_table(page: str, text: str, marks: tuple[str, str] = MARKS) -> str:
    """Returns a page with the table between the marks replaced."""
    before, rest = page.split(marks[0])
    return f"{before}{marks[0]}\n{text}\n{marks[1]}{rest.split(marks[1])[1]}"


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


def agent_in(result: pathlib.Path, agent: str) -> tuple[dict[str, Any], Any]:
    """Returns the scores of an agent in a result.json by set, and its env-steps if they are there."""
    body = json.loads(result.read_text(encoding="utf-8"))
    if agent not in body:
        known = sorted(name for name, value in body.items() if isinstance(value, dict))
        raise SystemExit(f"error: {result}: found no agent {agent!r}, needed one of {known}.")
    return body[agent], body.get("steps", "")


def replace_rows(path: pathlib.Path, about: dict[str, Any], rows: list[dict[str, Any]]) -> None:
    """Writes rows into a table in place of those with the same values `about` them."""
    with path.open(encoding="utf-8", newline="") as file:
        reader = csv.DictReader(file)
        columns = list(reader.fieldnames or ())
        others = [row for row in reader if any(row[k] != str(x) for k, x in about.items())]
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(others + rows)


def add(folder: pathlib.Path, result: pathlib.Path, agent: str, policy: str, robot: str, seed: int) -> None:
    """Writes an agent's rows of result.json into by_scene.csv, replacing those of this policy, robot and seed."""
    scores, steps = agent_in(result, agent)
    about = {"policy": policy, "robot": robot, "seed": seed}
    rows = [
        {**about, "env_steps": steps, "benchmark": benchmark, "scene": scene}
        | {k: round(score[k], 6) for k in ("SR", "RC", "hit_episodes")}
        for benchmark in BENCHMARKS
        for scene, score in sorted(scores[benchmark]["by_scene"].items())
    ]
    replace_rows(folder / "by_scene.csv", about, rows)


def add_streets(folder: pathlib.Path, result: pathlib.Path, agent: str, streets: str, seed: int) -> None:
    """Writes an agent's rows of result.json into training_streets.csv, replacing those of these streets and seed."""
    scores, _ = agent_in(result, agent)
    about = {"streets": streets, "seed": seed}
    rows = [
        {**about, "set": name, "scene": scene, "SR": round(score["SR"], 6)}
        for name in COMPARED
        for scene, score in sorted(scores[name]["by_scene"].items())
    ]
    replace_rows(folder / "training_streets.csv", about, rows)


def main() -> int:
    cli = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    cli.add_argument("--add", type=pathlib.Path, help="result.json whose rows are added")
    cli.add_argument("--agent", default="student", help="its key there")
    cli.add_argument("--policy", help="name in the table; default: that of the agent")
    cli.add_argument("--robot", default="COCO")
    cli.add_argument("--streets", help="what a teacher trained on: adds to training_streets.csv instead")
    cli.add_argument("--seed", type=int, default=0)
    args = cli.parse_args()
    if args.add is not None and args.streets:
        add_streets(SCORES, args.add, args.agent, args.streets, args.seed)
    elif args.add is not None:
        add(SCORES, args.add, args.agent, args.policy or args.agent, args.robot, args.seed)
    scores = read(SCORES)
    page = with_table(PAGE.read_text(encoding="utf-8"), table(scores))
    page = with_table(page, street_table(read_streets(SCORES)), STREET_MARKS)
    PAGE.write_text(page, encoding="utf-8")
    draw(scores, FIGURE)
    return 0


if __name__ == "__main__":
    sys.exit(main())
