"""Success on CraftBench against the number of training layouts, cousins and procedural streets, and the length of
scenes: writes the tables and the figure of docs/results.md from benchmarks/scores/scaling.csv.

    python -m benchmarks.campaign --out OUT --gpus 2 --rows "scaling-*" "horizon-*"
    python -m benchmarks.campaign --out OUT --add
    python -m benchmarks.scaling

The first command trains and scores the points that OUT does not have yet (equal env-steps, the final parameters), the
second writes their rows, the third fits and draws. Two learners train on the same scenes: PPO from images (preset
`fast` at 54x96), and the privileged teacher of `benchmarks.generalise` (rows `scaling-teacher-*`), which is not limited
by learning to see. All points of a kind train on scenes of one bank, chosen by name: `subset(study, size, seed)` orders
layouts, cousins and streets at random by the seed of the training and takes the first ones, so smaller subsets are part
of larger ones, and seeds differ in their streets too.

A power law, failures = a n^-b in percent, is fitted by least squares to the mean success of each size. Intervals come
from a bootstrap over seeds and scenes, the same draws for all sizes of a study. Rows that are not there are named in
the page and drawn nowhere.
"""

import csv
import hashlib
import json
import pathlib
import sys
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from benchmarks import results
from benchmarks.lib.figures import save_figure
from urbanverse_mjx.scene import library

#: Prefix of the studies of the privileged teacher.
TEACHER = "teacher-"
#: What varies -> its sizes. Layouts have five cousins each; cousins are of all 32 layouts.
VARIED = {"layouts": (1, 8, 16, 32), "cousins": (1, 2, 3, 4), "streets": (5, 40, 80, 160)}
TITLES = {"layouts": "layouts, 5 cousins each", "cousins": "cousins of 32 layouts", "streets": "procedural streets"}
#: What varies -> the set of the library whose scenes are trained on.
SETS = {"layouts": "urbanverse160", "cousins": "urbanverse160", "streets": "procedural"}


class Learner(NamedTuple):
    """title: in the tables. agent: in result.json. colour: in the figure."""

    title: str
    agent: str
    colour: str


#: Prefix of a study's name -> its learner.
LEARNERS = {
    "": Learner("PPO from images", "fast", "#2860be"),
    TEACHER: Learner("privileged teacher", "teacher", "#d64228"),
}
#: Study (a learner's prefix and what varies) -> its sizes.
SIZES = {f"{prefix}{name}": sizes for prefix in LEARNERS for name, sizes in VARIED.items()}
SEEDS = (0, 1, 2)
#: Length of the training scenes, m -> how the rows are called.
HORIZON = {100: "halves", 200: "whole scenes"}
#: Sets that both trainings of `horizon` are scored on -> their title.
TESTED = {"craftbench_halves": "CraftBench, halves", "craftbench": "CraftBench, whole scenes"}
FIGURE = results.ROOT / "docs" / "scaling.png"
MARKS = "<!-- scaling: python -m benchmarks.scaling -->", "<!-- end of scaling -->"
#: Bootstrap samples of a fit, and the largest exponent that is looked for.
DRAWS, STEEPEST = 1_000, 5.0

#: (study, size) -> set -> success rates by (seed, scene), in percent.
Rows = dict[tuple[str, int], dict[str, dict[tuple[str, str], float]]]


def learner(study: str) -> Learner:
    """Returns the learner of a study."""
    return LEARNERS[TEACHER if study.startswith(TEACHER) else ""]


def varied(study: str) -> str:
    """Returns what a study varies: a key of `VARIED`."""
    return study.removeprefix(TEACHER)


def subset(study: str, size: int, seed: int) -> list[str]:
    """Returns the ids of the scenes that a point trains on, sorted; all learners have the same."""
    rng, name = np.random.default_rng(seed), varied(study)
    ids = sorted(library.shipped_hashes(SETS[name]))
    if name == "streets":
        return sorted(ids[i] for i in rng.permutation(len(ids))[:size])
    cousins = library.scene_set(SETS[name]).cousins
    layouts = sorted({name.rsplit("_Cousin_", 1)[0] for name in ids})
    order = rng.permutation(len(layouts))
    numbers = rng.permuted(np.tile(np.arange(cousins), (len(layouts), 1)), axis=1)
    taken, count = (order[:size], cousins) if name == "layouts" else (order, size)
    return sorted(library.scene_set(SETS[name]).scene_id(layouts[i], int(k)) for i in taken for k in numbers[i, :count])


def digest(scenes: Iterable[str]) -> str:
    """Returns 12 hexadecimal digits that stand for a set of scene ids."""
    return hashlib.sha256("\n".join(sorted(scenes)).encode()).hexdigest()[:12]


def add(folder: pathlib.Path, result: pathlib.Path, study: str, size: int, seed: int) -> None:
    """Writes the rows of a result.json of `benchmarks.comparison`, or for a teacher of `benchmarks.generalise`, into
    scaling.csv, replacing those of this point.

    Raises:
      SystemExit: it trained on other scenes than those of the point.
    """
    body = json.loads(result.read_text(encoding="utf-8"))
    scores, trained_on = results.agent_in(body, learner(study).agent, result), body["trained_on"]
    if study in SIZES and trained_on != subset(study, size, seed):
        raise SystemExit(
            f"error: {result}: found a training on {len(trained_on)} scenes that are not those of {study}, {size}, "
            f"seed {seed}; needed the scenes of `scaling.subset`; move the folder away and run the row again."
        )
    about = {"study": study, "size": size, "seed": seed}
    made = {"env_steps": body["steps"], "scenes": len(trained_on), "subset": digest(trained_on)}
    rows = [
        {**about, **made, "set": name, "scene": scene, "SR": round(score["SR"], 6)}
        for name in scores
        if name in TESTED  # a teacher is driven on validation streets as well
        for scene, score in sorted(scores[name]["by_scene"].items())
    ]
    results.replace_rows(folder / "scaling.csv", about, rows)


def read(folder: pathlib.Path) -> Rows:
    """Returns the rows of scaling.csv."""
    found: Rows = {}
    with (folder / "scaling.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            point = found.setdefault((row["study"], int(row["size"])), {}).setdefault(row["set"], {})
            point[row["seed"], row["scene"]] = float(row["SR"])
    return found


class Fit(NamedTuple):
    """failures = a n^-b in percent; low, high: 95 % interval of b; r2: share of the variance of the means."""

    a: float
    b: float
    low: float
    high: float
    r2: float
    seeds: int


def power_law(sizes: np.ndarray, failures: np.ndarray) -> tuple[float, float]:
    """Returns (a, b) of a n^-b with the least squares to failures in percent; b is within +-`STEEPEST`."""
    from scipy.optimize import minimize_scalar

    def factor(b: float) -> float:
        return float(failures @ sizes**-b / (sizes ** (-2 * b)).sum())

    def error(b: float) -> float:
        return float(((failures - factor(b) * sizes**-b) ** 2).sum())

    b = float(minimize_scalar(error, bounds=(-STEEPEST, STEEPEST), method="bounded", options={"xatol": 1e-6}).x)
    return factor(b), b


def fit(points: Mapping[int, Mapping[tuple[str, str], float]]) -> Fit | None:
    """Fits the points of one study, size -> success by (seed, scene), over the seeds that all of them have.

    Returns:
      None if there are fewer than three sizes, no common seed, or no failure.
    """
    common = set.intersection(*({seed for seed, _ in values} for values in points.values())) if points else set()
    if len(points) < 3 or not common:
        return None
    sizes = np.array(sorted(points), float)
    rates = np.stack(
        [
            results.by_seed_and_scene({k: x for k, x in points[int(n)].items() if k[0] in common}, f"size {n:.0f}")
            for n in sizes
        ]
    )
    failures = 100.0 - rates
    means = failures.mean((1, 2))
    if not means.any():
        return None
    a, b = power_law(sizes, means)
    rng = np.random.default_rng(results.SEED)
    _, seeds, scenes = rates.shape
    rows, columns = rng.integers(0, seeds, (DRAWS, seeds, 1)), rng.integers(0, scenes, (DRAWS, 1, scenes))
    drawn = failures[:, rows, columns].mean((2, 3)).T
    low, high = np.percentile([power_law(sizes, x)[1] for x in drawn if x.any()], [2.5, 97.5])
    spread = ((means - means.mean()) ** 2).sum()
    r2 = 1.0 - ((means - a * sizes**-b) ** 2).sum() / spread if spread > 0 else 0.0
    return Fit(a, b, float(low), float(high), float(r2), seeds)


def absent(rows: Rows, seeds: Sequence[int] = SEEDS) -> list[str]:
    """Returns the names of the campaign's rows that are not there."""

    def has(study: str, size: int, seed: int, sets: Iterable[str]) -> bool:
        point = rows.get((study, size), {})
        return all(any(key[0] == str(seed) for key in point.get(name, {})) for name in sets)

    wanted = [
        (f"scaling-{study}-{n}-{s}", (study, n, s, ("craftbench",)))
        for study in SIZES
        for n in SIZES[study]
        for s in seeds
    ]
    wanted += [(f"horizon-{n}-{s}", ("horizon", n, s, TESTED)) for n in HORIZON for s in seeds]
    return [name for name, point in wanted if not has(*point)]


def _cell(score: results.Score) -> str:
    return f"{score.mean:.1f} [{score.low:.1f}, {score.high:.1f}]"


def _rates(rows: Rows, study: str, size: int, name: str) -> np.ndarray:
    return results.by_seed_and_scene(rows[study, size][name], f"scaling.csv: {study} {size}, {name}")


def _studies(rows: Rows) -> dict[str, dict[int, dict[tuple[str, str], float]]]:
    """Study -> size -> success on CraftBench by (seed, scene), of those that are there."""
    found = {s: {n: rows[s, n]["craftbench"] for n in SIZES[s] if (s, n) in rows} for s in SIZES}
    return {study: points for study, points in found.items() if points}


def scaling_table(rows: Rows) -> str:
    """Markdown: the points, then the fits; empty without rows."""
    studies = _studies(rows)
    if not studies:
        return ""
    lines = ["| trained on | learner | number | seeds | CraftBench |", "| --- | --- | --- | --- | --- |"]
    for study, points in studies.items():
        for n in points:
            score = results.over_seeds_and_scenes(_rates(rows, study, n, "craftbench"))
            lines.append(f"| {TITLES[varied(study)]} | {learner(study).title} | {n} | {score.seeds} | {_cell(score)} |")
    lines += ["", "| failures, % | learner | a | b | R2 | seeds |", "| --- | --- | --- | --- | --- | --- |"]
    for study, points in studies.items():
        found = fit(points)
        cells = ["no fit: fewer than three sizes with a common seed, or no failure", "", "", ""]
        if found is not None:
            b = f"{found.b:.3f} [{found.low:.3f}, {found.high:.3f}]"
            cells = [f"{found.a:.1f}", b, f"{found.r2:.2f}", str(found.seeds)]
        lines.append(f"| a n^-b, {TITLES[varied(study)]} | {learner(study).title} | {' | '.join(cells)} |")
    return "\n".join(lines)


def horizon_table(rows: Rows) -> str:
    """Markdown: success by length of the training scenes and of the tested ones; empty without rows."""
    there = [n for n in HORIZON if all(name in rows.get(("horizon", n), {}) for name in TESTED)]
    if not there:
        return ""
    lines = [f"| trained on | seeds | {' | '.join(TESTED.values())} |", "| --- | --- | --- | --- |"]
    rates = {n: [_rates(rows, "horizon", n, name) for name in TESTED] for n in there}
    for n, parts in rates.items():
        cells = [_cell(results.over_seeds_and_scenes(part)) for part in parts]
        lines.append(f"| {HORIZON[n]} ({n} m) | {len(parts[0])} | {' | '.join(cells)} |")
    if len(there) == 2:
        cells = [_cell(results.difference(whole, half)) for half, whole in zip(*rates.values(), strict=True)]
        lines.append(f"| whole scenes - halves | | {' | '.join(cells)} |")
    return "\n".join(lines)


def text(rows: Rows) -> str:
    """Markdown of the part of the page between the marks."""
    missing = absent(rows)
    parts = [scaling_table(rows), horizon_table(rows)]
    if parts[0]:
        parts.insert(0, "![Success on CraftBench against the size of the training set](scaling.png)")
    if missing:
        command = 'python -m benchmarks.campaign --out OUT --gpus 2 --rows "scaling-*" "horizon-*"'
        which = ", ".join(_patterns(missing))
        parts.append(f"Not run yet: {which}; `{command}` runs them.")
    return "\n\n".join(part for part in parts if part)


def _patterns(names: Sequence[str]) -> list[str]:
    """Names in backquotes; STUDY-* in place of all points of a study, and STUDY-SIZE-* of all seeds of one."""
    everything = absent({})
    found: list[str] = []
    for name in names:
        said = name
        for parts in (-1, -2):
            prefix = "-".join(name.split("-")[:parts]) + "-"
            if prefix.count("-") >= (2 if name.startswith("scaling") else 1) and all(
                x in names for x in everything if x.startswith(prefix)
            ):
                said = f"{prefix}*"
        if f"`{said}`" not in found:
            found.append(f"`{said}`")
    return found


def draw(rows: Rows, path: pathlib.Path) -> None:
    """Draws success against size with intervals and fits, a panel for each study that has rows.

    A figure of other rows is removed if there are none.
    """
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    studies = _studies(rows)
    if not studies:
        path.unlink(missing_ok=True)
        return
    panels = [name for name in VARIED if any(varied(study) == name for study in studies)]
    width = 3.8 * len(panels)
    figure, axes = plt.subplots(1, len(panels), figsize=(width, 3.4), sharey=True, squeeze=False, layout="constrained")
    for axis, name in zip(axes[0], panels, strict=True):
        for prefix, (title, _, colour) in LEARNERS.items():
            points = studies.get(f"{prefix}{name}", {})
            for n in points:
                score = results.over_seeds_and_scenes(_rates(rows, f"{prefix}{name}", n, "craftbench"))
                ends = [[score.mean - score.low], [score.high - score.mean]]
                axis.errorbar(n, score.mean, yerr=ends, fmt="o", color=colour, capsize=3)
            found = fit(points)
            if found is not None:
                n = np.geomspace(min(points), max(points), 100)
                law = f"{title}: $100 - {found.a:.1f}\\, n^{{{-found.b:.2f}}}$"
                axis.plot(n, 100.0 - found.a * n**-found.b, color=colour, label=law)
        if axis.get_legend_handles_labels()[0]:
            axis.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), fontsize="small", frameon=False)
        axis.set_xscale("log")
        axis.set_xticks(list(VARIED[name]), [str(n) for n in VARIED[name]])
        axis.minorticks_off()
        axis.set(xlabel=f"number of {TITLES[name]}")
        axis.grid(alpha=0.4)
    axes[0][0].set(ylabel="success on CraftBench, % (95 % interval)")
    save_figure(figure, path, dpi=110)
    plt.close(figure)


def main() -> int:
    rows = read(results.SCORES)
    page = results.with_table(results.PAGE.read_text(encoding="utf-8"), text(rows), MARKS)
    results.PAGE.write_text(page, encoding="utf-8")
    draw(rows, FIGURE)
    return 0


if __name__ == "__main__":
    sys.exit(main())
