"""Writes the table and the figure of all policies on CraftBench and AutoBench from the rows in `benchmarks/scores`.

    python -m benchmarks.results
    python -m benchmarks.results --add runs/student/result.json --agent student --policy student --robot COCO --seed 0
    python -m benchmarks.results --add runs/teacher/result.json --agent teacher --arm training_streets both --seed 0
    python -m benchmarks.results --add runs/craftbench_v2-planner --robot COCO

The second command first adds the rows of an agent in a result.json of `benchmarks.generalise` or
`benchmarks.comparison`, replacing those of the same policy, robot and seed. `by_scene.csv` has a row per policy,
training seed and scene; `totals.csv` policies whose scenes are not kept, with the standard error over scenes. The
third command adds to the table of a comparison (`COMPARISONS`): policies that differ in one part of their training
alone, also scored on validation streets. The last one adds a run of `urbanverse benchmark` (contact ends) to the
comparison of the benchmarks' versions, in place of that of the same policy, robot and protocol. Writes the tables
between the marks in docs/results.md, and docs/results.png. Intervals come from a bootstrap that samples seeds (if
there are several) and scenes.
"""

import argparse
import collections
import csv
import json
import pathlib
import sys
from typing import Any, NamedTuple

import numpy as np

from benchmarks.lib.figures import save_figure
from urbanverse_mjx.datatypes import BenchmarkReport

ROOT = pathlib.Path(__file__).parents[1]
SCORES = ROOT / "benchmarks" / "scores"
PAGE, FIGURE = ROOT / "docs" / "results.md", ROOT / "docs" / "results.png"
MARKS = "<!-- table: python -m benchmarks.results -->", "<!-- end of table -->"
BENCHMARKS = {"craftbench": "CraftBench", "autobench": "AutoBench"}
#: Number of bootstrap samples, and their seed.
DRAWS, SEED = 10_000, 0
#: Standard errors from the mean to the end of a 95 % interval.
NORMAL = 1.96
#: Heads of the columns that compare the benchmarks' versions.
VERSIONS = {
    "craftbench": "CraftBench 1",
    "craftbench_v2": "CraftBench 2",
    "autobench": "AutoBench 1",
    "autobench_v2": "AutoBench 2",
}


class Comparison(NamedTuple):
    """Policies (arms) that differ in one part of their training alone.

    Attributes:
      title: head of the arms' column.
      sets: name in result.json -> head of its column; those whose rows are kept.
      reference: the arm that others are compared with.
      rows: patterns of the campaign's rows.
    """

    title: str
    sets: dict[str, str]
    reference: str
    rows: str


#: Held-out scenes of the training sets, and the composed validation streets.
VALIDATION = {
    "validation_procedural": "procedural, held out",
    "validation_places": "places, held out",
    "validation_composed": "composed",
}
#: The same without places, on which the rows of benchmarks.imitation do not train.
_PROCEDURAL = {name: title for name, title in VALIDATION.items() if name != "validation_places"}
#: Sets on which teachers of different training streets are compared.
_STREETS = {"validation_composed": "composed"} | BENCHMARKS
#: The same without AutoBench, whose episodes are more than those of the other two.
_FEWER_STREETS = {name: title for name, title in _STREETS.items() if name != "autobench"}
#: Name of the table in benchmarks/scores, and of its marks in docs/results.md -> what it compares.
COMPARISONS = {
    "training_streets": Comparison("trained on", _STREETS, "144 procedural", "streets-*"),
    "long_training_streets": Comparison("trained on", _STREETS, "144 procedural", "long-streets-*"),
    "teacher_arms": Comparison("teacher", VALIDATION, "as it is", "teacher-arm-*"),
    "student_arms": Comparison("student", VALIDATION, "as it is", "student-arm-*"),
    "image_streets": Comparison("trained on cousins distilled from", _FEWER_STREETS, "exact inputs", "image-streets-*"),
    "imitation": Comparison("policy", _PROCEDURAL, "PPO alone", "imitation-*"),
}


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


def read_arms(folder: pathlib.Path, name: str) -> dict[str, dict[str, np.ndarray]]:
    """Returns arm -> set -> success rates (seeds, scenes) of a comparison, in percent."""
    rates: dict[tuple[str, str], dict[tuple[str, str], float]] = collections.defaultdict(dict)
    with (folder / f"{name}.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            rates[row["arm"], row["set"]][row["seed"], row["scene"]] = float(row["SR"])
    found: dict[str, dict[str, np.ndarray]] = collections.defaultdict(dict)
    for (arm, kept), values in rates.items():
        found[arm][kept] = by_seed_and_scene(values, f"{name}.csv: {arm}, {kept}")
    return dict(found)


def arm_table(comparison: Comparison, rates: dict[str, dict[str, np.ndarray]]) -> str:
    """Markdown: the mean over seeds for each arm, and the differences from the reference if that has rows."""
    if not rates:
        return f'Not run yet: `python -m benchmarks.campaign --out OUT --gpus 2 --rows "{comparison.rows}"`.'
    names = sorted(rates, key=lambda name: (name != comparison.reference, name))
    rows = [(name, {k: over_seeds_and_scenes(rates[name][k]) for k in comparison.sets}) for name in names]
    if names[0] == comparison.reference:
        rows += [
            (f"{name} - {names[0]}", {k: difference(rates[name][k], rates[names[0]][k]) for k in comparison.sets})
            for name in names[1:]
        ]
    head = [comparison.title, "seeds", *comparison.sets.values()]
    lines = [f"| {' | '.join(head)} |", f"|{' --- |' * len(head)}"]
    for name, scores in rows:
        cells = [f"{s.mean:.1f} [{s.low:.1f}, {s.high:.1f}]" for s in scores.values()]
        lines.append(f"| {name} | {next(iter(scores.values())).seeds} | {' | '.join(cells)} |")
    return "\n".join(lines)


def read_versions(folder: pathlib.Path) -> dict[tuple[str, str, str], dict[str, Score]]:
    """Returns (policy, robot, protocol) -> benchmark of `VERSIONS` -> score."""
    rates: dict[tuple[str, str, str], dict[str, list[float]]] = collections.defaultdict(dict)
    with (folder / "versions.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            key = row["policy"], row["robot"], row["protocol"]
            rates[key].setdefault(row["benchmark"], []).append(float(row["SR"]))
    return {k: {n: over_seeds_and_scenes(np.array([r])) for n, r in found.items()} for k, found in rates.items()}


def version_table(scores: dict[tuple[str, str, str], dict[str, Score]]) -> str:
    """Markdown: a row per policy, robot and protocol, a column per benchmark; "-" where it was not
    driven."""
    if not scores:
        return "Not run yet: `urbanverse benchmark craftbench_v2 --policy P --protocol full --contact ends`."
    names = [name for name in VERSIONS if any(name in found for found in scores.values())]
    head = ["policy", "robot", "protocol", *(VERSIONS[name] for name in names)]
    lines = [f"| {' | '.join(head)} |", f"|{' --- |' * len(head)}"]
    for key, found in sorted(scores.items()):
        shown = (found.get(name) for name in names)
        cells = [f"{s.mean:.1f} [{s.low:.1f}, {s.high:.1f}]" if s else "-" for s in shown]
        lines.append(f"| {' | '.join((*key, *cells))} |")
    return "\n".join(lines)


def arm_marks(name: str) -> tuple[str, str]:
    """Marks of a comparison's table in docs/results.md."""
    return f"<!-- table of {name}: python -m benchmarks.results -->", f"<!-- end of {name} -->"


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
    save_figure(figure, path, dpi=110)
    plt.close(figure)


def agent_in(body: dict[str, Any], agent: str, result: pathlib.Path) -> dict[str, Any]:
    """Returns the scores of an agent by set, from what is written in a result.json."""
    if agent not in body:
        known = sorted(name for name, value in body.items() if isinstance(value, dict))
        raise SystemExit(f"error: {result}: found no agent {agent!r}, needed one of {known}.")
    return body[agent]


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
    body = json.loads(result.read_text(encoding="utf-8"))
    scores = agent_in(body, agent, result)
    about = {"policy": policy, "robot": robot, "seed": seed}
    rows = [
        {**about, "env_steps": body.get("steps", ""), "benchmark": benchmark, "scene": scene}
        | {k: round(score[k], 6) for k in ("SR", "RC", "hit_episodes")}
        for benchmark in BENCHMARKS
        for scene, score in sorted(scores[benchmark]["by_scene"].items())
    ]
    replace_rows(folder / "by_scene.csv", about, rows)


def add_arm(folder: pathlib.Path, result: pathlib.Path, agent: str, name: str, arm: str, seed: int) -> None:
    """Writes an agent's rows of result.json into the table of a comparison, replacing those of this arm and seed."""
    scores = agent_in(json.loads(result.read_text(encoding="utf-8")), agent, result)
    about = {"arm": arm, "seed": seed}
    rows = [
        {**about, "set": kept, "scene": scene, "SR": round(score["SR"], 6)}
        for kept in COMPARISONS[name].sets
        for scene, score in sorted(scores[kept]["by_scene"].items())
    ]
    replace_rows(folder / f"{name}.csv", about, rows)


def add_version(folder: pathlib.Path, run: pathlib.Path, robot: str) -> None:
    """Writes the rows of a run of `urbanverse benchmark` into versions.csv, a row per scene.

    They replace those of the same policy, robot, protocol and benchmark.

    Args:
      run: folder of the run, with `ends/report.json`.

    Raises:
      SystemExit: it has no such report, or one of another benchmark.
    """
    path = run / "ends" / "report.json"
    if not path.is_file():
        raise SystemExit(f"error: {run}: found no ends/report.json, needed a run of `urbanverse benchmark`.")
    report = BenchmarkReport.load(path)
    ((policy, scores),) = report.summary.items()
    about = {
        "policy": policy,
        "robot": robot,
        "protocol": report.record["protocol"],
        "benchmark": report.record["benchmark"],
    }
    if about["benchmark"] not in VERSIONS:
        raise SystemExit(f"error: {run}: found benchmark {about['benchmark']!r}, needed one of {list(VERSIONS)}.")
    number = collections.Counter(episode.scene for episode in report.episodes)
    rows = [
        {**about, "scene": scene, "episodes": number[scene]}
        | {k: round(score[k], 6) for k in ("SR", "RC", "hit_episodes")}
        for scene, score in sorted(scores["by_scene"].items())
    ]
    replace_rows(folder / "versions.csv", about, rows)


def main() -> int:
    cli = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    cli.add_argument("--add", type=pathlib.Path, help="result.json, or folder of `urbanverse benchmark`, to add")
    cli.add_argument("--agent", default="student", help="its key there")
    cli.add_argument("--policy", help="name in the table; default: that of the agent")
    cli.add_argument("--robot", default="COCO")
    cli.add_argument(
        "--arm", nargs=2, metavar=("COMPARISON", "ARM"), help=f"adds to one of {', '.join(COMPARISONS)} instead"
    )
    cli.add_argument("--seed", type=int, default=0)
    args = cli.parse_args()
    if args.arm is not None and args.arm[0] not in COMPARISONS:
        cli.error(f"--arm: found {args.arm[0]!r}, needed one of {', '.join(COMPARISONS)}.")
    if args.add is not None and args.arm is not None:
        add_arm(SCORES, args.add, args.agent, args.arm[0], args.arm[1], args.seed)
    elif args.add is not None and args.add.is_dir():
        add_version(SCORES, args.add, args.robot)
    elif args.add is not None:
        add(SCORES, args.add, args.agent, args.policy or args.agent, args.robot, args.seed)
    scores = read(SCORES)
    page = with_table(PAGE.read_text(encoding="utf-8"), table(scores))
    for name, comparison in COMPARISONS.items():
        page = with_table(page, arm_table(comparison, read_arms(SCORES, name)), arm_marks(name))
    page = with_table(page, version_table(read_versions(SCORES)), arm_marks("versions"))
    PAGE.write_text(page, encoding="utf-8")
    draw(scores, FIGURE)
    return 0


if __name__ == "__main__":
    sys.exit(main())
