"""Drives the robots of both tables: on wheels on level ground and in engines against C MuJoCo, all by the planner in
streets.

    python -m benchmarks.robots --drive                        # straight, brake, arc, turn: in C MuJoCo
    python -m benchmarks.robots --parity warp jax              # engines against C MuJoCo in box streets
    python -m benchmarks.robots --planner --episodes 32        # the planner on validation streets
    python -m benchmarks.robots --planner --robots husky mir
    python -m benchmarks.robots --sheet --page                 # docs/robots.jpg and the tables of docs/robots.md

Results are kept in benchmarks/scores/robots.csv, a row for each robot and what was measured; a later run of the same
replaces it. `--planner` needs the scenes of `urbanverse scene library validation`. A run of one robot prints one JSON
line.
"""

import argparse
import csv
import json
import pathlib
import sys
from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks.lib import robot_drives
from benchmarks.results import replace_rows, with_table
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.robots import catalogue, legged

ROOT = pathlib.Path(__file__).parents[1]
SCORES, PAGE, SHEET = ROOT / "benchmarks/scores/robots.csv", ROOT / "docs/robots.md", ROOT / "docs/robots.jpg"
MARKS = "<!-- robots: python -m benchmarks.robots --page -->", "<!-- end of robots -->"
LEGGED = "<!-- legged: python -m benchmarks.robots --page -->", "<!-- end of legged -->"
MEASURED = "<!-- measured: python -m benchmarks.robots --page -->", "<!-- end of measured -->"
COLUMNS = ("robot", "what", "figures")
#: Robots that are no rows of the catalogue, for `--planner`: environment and overrides of its config.
OTHERS: dict[str, tuple[str, dict[str, Any]]] = {
    "coco": ("CocoNav", {}),
    "coco_ackermann": ("CocoNav", {"drive": "ackermann"}),
    "wheelchair": ("CocoNav", {"robot": "wheelchair"}),
    # Those with legs whose gaits are shipped.
    **{
        name: (catalogue.environment_name(name), {})
        for name in legged.NAMES
        if legged.row(name).drive == "gait" and legged.gait_path(name).is_file()
    },
}


def planner_success(name: str, episodes: int, impl: str) -> dict[str, Any]:
    """Figures of the planner with a robot on validation streets: contact ends an episode, 60 s."""
    from urbanverse_mjx.envs import registry
    from urbanverse_mjx.evaluation.metrics import wilson_interval
    from urbanverse_mjx.evaluation.planner import Planner
    from urbanverse_mjx.evaluation.rollouts import Rollout, fixed_episodes
    from urbanverse_mjx.pipeline.benchmarking import benchmark_bank

    environment, overrides = OTHERS.get(name, ("", {}))
    environment = environment or catalogue.environment_name(name)
    same = {"preset": "paper", "vision": False, "scenes": "all", "impl": impl}
    config = registry.with_overrides(registry.get_default_config(environment), {**same, **overrides})
    from urbanverse_mjx.envs.navigation.draws import OFF

    with config.unlocked():
        config.randomization = OFF
    env = registry.load_nav_env(environment, config, benchmark_bank("validation"))
    chosen = fixed_episodes(env, episodes)
    results, _ = Rollout(env).run({"planner": Planner(env)}, chosen)
    ends = [result.result for result in results]
    won = ends.count("goal")
    return {
        "episodes": len(results),
        "success": round(won / len(results), 4),
        "interval": [round(x, 3) for x in wilson_interval(won, len(results))],
        "ends": {end: ends.count(end) for end in sorted(set(ends))},
        "route_completion": round(float(np.mean([result.route_completion for result in results])), 4),
        "slot_overflow": int(max(result.slot_overflow for result in results)),
    }


def keep(name: str, what: str, figures: dict[str, Any], path: pathlib.Path = SCORES) -> None:
    """Writes a robot's figures into the table, in place of earlier ones of the same."""
    if not path.exists():
        path.write_text(",".join(COLUMNS) + "\n", encoding="utf-8")
    about = {"robot": name, "what": what}
    replace_rows(path, about, [{**about, "figures": json.dumps(figures, sort_keys=True)}])
    print(json.dumps({**about, **figures}), flush=True)


def kept(path: pathlib.Path = SCORES) -> dict[str, dict[str, dict[str, Any]]]:
    """Figures by robot and what was measured."""
    found: dict[str, dict[str, dict[str, Any]]] = {}
    if path.exists():
        with path.open(encoding="utf-8", newline="") as file:
            for row in csv.DictReader(file):
                found.setdefault(row["robot"], {})[row["what"]] = json.loads(row["figures"])
    return found


# Page.


def robots_text() -> str:
    """Markdown of the robots of the catalogue, with their sources."""
    head = ["`robot`", "environment", "what it is", "length x width x height, m", "mass, kg", "top speed, m/s"]
    head += ["turning radius, m"]
    lines = [f"| {' | '.join(head)} |", f"|{' --- |' * len(head)}"]
    notes = ["", "Sources, and what is typical of the class because no public source that could be read gives it:", ""]
    for name in catalogue.NAMES:
        row = catalogue.row(name)
        radius = robot_drives.turning_radius(name)
        speed = f"{row.top_speed:g}" + ("" if row.top_speed == row.max_speed else f" ({row.max_speed:g})")
        size = " x ".join(f"{x:.2f}" for x in row.size)
        cells = [f"`{name}`", f"`{catalogue.environment_name(name)}`", f"{row.title}: {row.kind}", size]
        lines.append(
            f"| {' | '.join([*cells, f'{row.mass:g}', speed, f'{radius:.2f}' if radius else 'on the spot'])} |"
        )
        notes.append(f"* `{name}`: {row.source}. Typical: {row.typical}.")
    return "\n".join([*lines, *notes])


def legged_text() -> str:
    """Markdown of the robots with legs, with their sources."""
    head = ["`robot`", "environments", "what it is", "length x width x height, m", "mass, kg", "joints"]
    head += ["stands at, m", "commands, m/s and rad/s"]
    lines = [f"| {' | '.join(head)} |", f"|{' --- |' * len(head)}"]
    notes = ["", "Sources, and what no public source that could be read gives:", ""]
    for name in legged.NAMES:
        row = legged.row(name)
        walks, ships = row.drive == "gait", legged.gait_path(name).is_file()
        environments = [legged.joystick_name(name)] * walks
        environments += [catalogue.environment_name(name)] * (ships or not walks)
        size = " x ".join(f"{x:.2f}" for x in row.size)
        cells = [f"`{name}`", ", ".join(f"`{x}`" for x in environments), f"{row.title}: {row.kind}", size]
        joints = str(len(row.joint_names)) + ("" if walks else f" held, {len(row.legs)} wheels")
        cells += [f"{row.mass:.1f}", joints, f"{row.spawn:.2f}", f"{row.max_speed:g}, {row.max_yaw_rate:g}"]
        lines.append(f"| {' | '.join(cells)} |")
        notes.append(f"* `{name}`: {row.source}. Typical: {row.typical}.")
    return "\n".join([*lines, *notes])


def measured_text(path: pathlib.Path = SCORES) -> str:
    """Markdown of what was measured."""
    found = kept(path)
    head = ["robot", "speed, m/s", "brakes in, m", "yaw rate by command", "turning radius, m (kinematic)"]
    head += ["warp, mm", "jax, mm", "planner's success", "ends"]
    lines = [f"| {' | '.join(head)} |", f"|{' --- |' * len(head)}"]
    for name in (*OTHERS, *robot_drives.DRIVEN):
        row = found.get(name, {})
        drive, planned = row.get("drive"), row.get("planner")
        cells = [f"`{name}`"]
        if drive:
            low, high = drive["yaw_ratio"]
            tight = drive["turning_radius"]
            cells += [f"{drive['speed']:.2f}", f"{drive['brake_distance']:.2f}", f"{low:.2f}-{high:.2f}"]
            cells += [f"{tight[0]:.2f} ({tight[1]:.2f})" if tight else "on the spot"]
        else:
            cells += ["", "", "", ""]
        for impl in ("warp", "jax"):
            one = row.get(f"parity_{impl}")
            cells.append(f"{one['before_contact_max_mm']:.2f}" if one else "")
        if planned:
            low, high = planned["interval"]
            cells.append(f"{100 * planned['success']:.0f} % [{100 * low:.0f}, {100 * high:.0f}]")
            cells.append(", ".join(f"{count} {end}" for end, count in planned["ends"].items()))
        else:
            cells += ["", ""]
        if row:
            lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def write_page() -> None:
    """Writes the tables of docs/robots.md."""
    page = with_table(PAGE.read_text(encoding="utf-8"), robots_text(), MARKS)
    page = with_table(page, legged_text(), LEGGED)
    PAGE.write_text(with_table(page, measured_text(), MEASURED), encoding="utf-8")


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.robots", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--robots", nargs="+", default=None, help="names; default: all that apply")
    parser.add_argument("--drive", action="store_true")
    parser.add_argument("--parity", nargs="+", choices=("warp", "jax"), default=())
    parser.add_argument("--planner", action="store_true")
    parser.add_argument("--episodes", type=int, default=32, help="of the planner with each robot")
    parser.add_argument(
        "--impl", choices=("auto", "jax", "warp"), default="auto", help="engine of the planner's streets"
    )
    parser.add_argument("--sheet", action="store_true")
    parser.add_argument("--page", action="store_true")
    arguments = parser.parse_args(argv)
    unknown = set(arguments.robots or ()) - {*robot_drives.DRIVEN, *OTHERS}
    if unknown:
        found, known = ", ".join(sorted(unknown)), ", ".join((*OTHERS, *robot_drives.DRIVEN))
        raise ValidationError(f"--robots: found {found}, needed {known}.")
    if arguments.episodes < 1:
        parser.error("--episodes must be positive")
    rows = [name for name in arguments.robots or robot_drives.DRIVEN if name in robot_drives.DRIVEN]
    for name in rows if arguments.drive else ():
        keep(name, "drive", robot_drives.drive_figures(name))
    for impl in arguments.parity:
        for name in rows:
            keep(name, f"parity_{impl}", robot_drives.parity_figures(name, impl))
    for name in (arguments.robots or (*OTHERS, *robot_drives.DRIVEN)) if arguments.planner else ():
        keep(name, "planner", planner_success(name, arguments.episodes, arguments.impl))
    if arguments.sheet:
        robot_drives.write_sheet(SHEET)
    if arguments.page:
        write_page()
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except ValidationError as error:
        sys.exit(str(error))
