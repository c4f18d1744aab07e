"""Rows of the comparison with other engines: kept in benchmarks/scores, written as table and figure."""

import argparse
import csv
import pathlib
import sys
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from benchmarks import results
from benchmarks.lib import report, tables
from benchmarks.lib.figures import save_figure
from benchmarks.lib.peers.plan import KEY, PEERS, PLAN, Case, key_of, same_process

TABLE = "peers.csv"
PAGE, FIGURE = results.ROOT / "docs" / "performance.md", results.ROOT / "docs" / "peers.png"
MARKS = "<!-- peers: python -m benchmarks.peers --page -->", "<!-- end of peers -->"
#: Placeholder for the baseline of this device if --compare or --save-baseline has no file.
OWN = pathlib.Path()
#: Columns of the kept rows after those that name the case.
FIGURES = (
    "env_steps_per_s",
    "env_steps_per_s_spread",
    "compile_s",
    "gpu_mib",
    "hulls",
    "steps",
    "repeats",
    "ended_share",
    "driven_m",
    "lost_share",
    "does",
    "error",
)
COLUMNS = ("device", "cores", *KEY, *FIGURES)


def machine() -> dict[str, Any]:
    """Device, cores and versions; the device by nvidia-smi, so that asking takes no memory of it."""
    import subprocess

    command = ["nvidia-smi", "--query-gpu=name", "--format=csv,noheader"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=20)
        device = done.stdout.splitlines()[0].strip()
    except (OSError, subprocess.SubprocessError, IndexError):
        device = "cpu"
    return {"device": device, "cores": report.cores(), "versions": report.versions()}


def brief(row: Mapping[str, Any]) -> str:
    """Returns one line on a row."""
    name = f"{row['peer']}, {row['num_envs']} envs, {row['streets']} streets, images {row['pixels']}"
    if row.get("error"):
        return f"{name}: {row['error']}"
    return f"{name}: {row['env_steps_per_s']:,.0f} env-steps/s, compiled in {row['compile_s']:.1f} s"


def save_image(folder: pathlib.Path, case: Case, pixels: np.ndarray) -> None:
    """Writes an image (height, width, 3 or 4) uint8 as PNG."""
    from PIL import Image

    folder.mkdir(parents=True, exist_ok=True)
    name = f"{case.peer}-{case.num_envs}-{case.streets}-{case.pixels}.png"
    Image.fromarray(np.ascontiguousarray(pixels[..., :3])).save(folder / name)


def add(rows: Sequence[Mapping[str, Any]], folder: pathlib.Path = results.SCORES) -> int:
    """Keeps rows in peers.csv, in place of those of the same case and device; returns their number."""
    for row in rows:
        about = {**{name: row[name] for name in KEY}, "device": row["machine"]["device"]}
        kept = {name: "" if row.get(name) is None else row[name] for name in FIGURES}
        cores = row["machine"]["cores"]
        results.replace_rows(folder / TABLE, about, [{"cores": cores, **about, **kept}])
    return len(rows)


def read(folder: pathlib.Path = results.SCORES) -> list[dict[str, str]]:
    """Returns the kept rows."""
    with (folder / TABLE).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def text(rows: Sequence[Mapping[str, str]]) -> str:
    """Markdown of the part of the page between the marks: a table of each device and size of images."""
    if not rows:
        return "Not run yet: `python -m benchmarks.peers --bank BANK --scenes SCENES --rows ROWS` measures it."
    parts = ["![Env-steps per second against the number of envs, ours and other engines](peers.png)"]
    for device, cores in dict.fromkeys((row["device"], row["cores"]) for row in rows):
        mine = [row for row in rows if (row["device"], row["cores"]) == (device, cores)]
        for pixels in sorted({row["pixels"] for row in mine}, key=_area):
            some = [row for row in mine if row["pixels"] == pixels]
            what = "no images" if pixels == "none" else f"images of {pixels}"
            parts.append(f"{device}, {cores} cores, {what}, env-steps/s (spread of the repeats):")
            parts.append(_table(some))
    failed = [row for row in rows if row["error"]]
    if failed:
        parts.append("No figure: " + "; ".join(f"{_title(row)}: {_one_line(row['error'])}" for row in failed) + ".")
    missing = absent(rows)
    if missing:
        parts.append(f"Not run yet: {'; '.join(missing)}.")
    return "\n\n".join(parts)


def absent(rows: Sequence[Mapping[str, str]]) -> list[str]:
    """Returns the cases of the plan that have no row on any device, a phrase for all numbers of envs of an engine."""
    done = {key_of(row) for row in rows}
    groups = same_process(case for case in PLAN if case.key not in done)
    found = []
    for group in groups:
        about = group[0].to_json()
        counts = " and ".join(f"{case.num_envs:,}" for case in group)
        found.append(f"{_setting({k: str(x) for k, x in about.items()})} ({counts} envs)")
    return found


def _table(rows: Sequence[Mapping[str, str]]) -> str:
    """Engines down, envs across, with a line for each number of streets."""
    counts = sorted({int(row["num_envs"]) for row in rows})
    head = [
        "engine",
        "streets at once",
        "hulls a street",
        *(f"{n:,} envs" for n in counts),
        "compiled in",
        "GPU memory",
    ]
    lines = []
    for peer, engine in PEERS.items():
        for streets in sorted({int(row["streets"]) for row in rows if row["peer"] == peer}):
            own = {int(r["num_envs"]): r for r in rows if r["peer"] == peer and int(r["streets"]) == streets}
            hulls = {row["hulls"] for row in own.values() if row["hulls"]}
            compiled = [float(row["compile_s"]) for row in own.values() if row["compile_s"]]
            memory = [float(row["gpu_mib"]) for row in own.values() if row["gpu_mib"]]
            cells = [engine.title, str(streets), f"{int(max(hulls, key=int)):,}" if hulls else ""]
            cells += [_rate(own[n]) if n in own else "" for n in counts]
            cells.append(f"{max(compiled):.0f} s" if compiled else "")
            cells.append(f"{max(memory) / 1024:.1f} GiB" if memory else "")
            lines.append(cells)
    return tables.markdown(head, lines)


def _rate(row: Mapping[str, str]) -> str:
    if row["error"]:
        return "none"
    return f"{float(row['env_steps_per_s']):,.0f} ({100 * float(row['env_steps_per_s_spread']):.0f} %)"


def _title(row: Mapping[str, str]) -> str:
    return f"{_setting(row)}, {int(row['num_envs']):,} envs"


def _setting(row: Mapping[str, str]) -> str:
    what = "no images" if row["pixels"] == "none" else row["pixels"]
    streets = "" if row["streets"] == "1" else f"{row['streets']} streets, "
    return f"{PEERS[row['peer']].title}, {streets}{what}"


def _one_line(message: str) -> str:
    return " ".join(message.replace("|", "/").split()).rstrip(".")


def _area(pixels: str) -> int:
    """Orders sizes by their number of pixels, none first."""
    return 0 if pixels == "none" else int(np.prod([int(part) for part in pixels.split("x")]))


def draw(rows: Sequence[Mapping[str, str]], path: pathlib.Path) -> None:
    """Draws env-steps/s against envs, a panel for each size of images; the figure is removed without rows.

    Of several devices the one with the most rows is drawn.
    """
    rows = [row for row in rows if not row["error"]]
    if not rows:
        path.unlink(missing_ok=True)
        return
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    devices = [row["device"] for row in rows]
    rows = [row for row in rows if row["device"] == max(devices, key=devices.count)]
    panels = sorted({row["pixels"] for row in rows}, key=_area)
    figure, axes = plt.subplots(
        1, len(panels), figsize=(3.6 * len(panels), 3.6), sharey=True, squeeze=False, layout="constrained"
    )
    ticks = sorted({int(row["num_envs"]) for row in rows})
    for axis, pixels in zip(axes[0], panels, strict=True):
        for peer, engine in PEERS.items():
            for streets in sorted({int(row["streets"]) for row in rows}):
                points = sorted(
                    (int(row["num_envs"]), float(row["env_steps_per_s"]))
                    for row in rows
                    if (row["peer"], row["pixels"], int(row["streets"])) == (peer, pixels, streets)
                )
                if points:
                    label = engine.title.replace("`", "") + (f", {streets} streets" if streets > 1 else "")
                    line = "-" if streets == 1 else ":"
                    marker = "o" if streets == 1 else "s"
                    style = {"color": engine.colour, "linestyle": line, "marker": marker, "markersize": 4}
                    axis.plot(*zip(*points, strict=True), label=label, **style)
        axis.set(title="no images" if pixels == "none" else pixels.replace("x", " x "), xlabel="envs")
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.set_xticks(ticks, [f"{n:,}" for n in ticks])
        axis.minorticks_off()
        axis.set_xlim(0.7 * ticks[0], 1.4 * ticks[-1])
        axis.grid(alpha=0.4)
    axes[0][0].set(ylabel="env-steps/s")
    known: dict[str, Any] = {}
    for axis in axes[0]:
        for handle, label in zip(*axis.get_legend_handles_labels(), strict=True):
            known.setdefault(label, handle)
    columns = min(len(known), 2 * len(panels))
    figure.legend(known.values(), known.keys(), loc="outside lower center", ncols=columns, fontsize="small")
    save_figure(figure, path, dpi=100)
    plt.close(figure)


def write_page() -> None:
    """Writes the table in docs/performance.md, and docs/peers.png."""
    rows = read()
    page = results.with_table(PAGE.read_text(encoding="utf-8"), text(rows), MARKS)
    PAGE.write_text(page, encoding="utf-8")
    draw(rows, FIGURE)


def _comparable(row: Mapping[str, Any]) -> dict[str, Any]:
    """A row with the names by which `report` tells configurations apart."""
    peer, count, streets, pixels = key_of(row)
    return {**row, "rival": peer, "num_envs": count, "scenes": streets, "pixels": pixels}


def judge(rows: Sequence[Mapping[str, Any]], args: argparse.Namespace) -> int:
    """Keeps a baseline and compares with one, where asked for; returns the exit status."""
    comparable = [_comparable(row) for row in rows]

    def file(path: pathlib.Path) -> pathlib.Path:
        own = report.own_baseline(comparable)
        return own.with_name(f"peers-{own.name}") if path == OWN else path

    if args.save_baseline is not None:
        report.save_baseline(comparable, file(args.save_baseline))
    slower = False
    if args.compare is not None:
        for one in report.compare(comparable, file(args.compare), args.tolerance):
            verdict, slower = ("SLOWER", True) if one["slower"] else ("ok", slower)
            print(f"{verdict} {one['ratio']:.3f} of the baseline: {one['what']}, {one['now']}", file=sys.stderr)
    return 1 if slower else 0
