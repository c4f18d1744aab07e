"""Evaluates a gait in C MuJoCo, not in the engine it was trained in.

    python -m benchmarks.go2_gait --json

evaluates the shipped gait of the Go2 (or `--gait`, a gait file; `--robot`, of another robot with legs) with random
commands on level ground (velocity error, falls, cost of transport, foot slip, torque, speed and joint limits), full
speed ahead, kicks, kerbs up and down by height, ramps. One JSON line holds the results and which goals are met; the
exit status is 1 if one is not.

Without `--json` it prints two tables: the results with the goals, and with published figures (`lib.gait_published`).
`--show FILE` prints them for an earlier JSON line. The whole benchmark is 47,000 s of walking, half an hour of one
processor core.
"""

import argparse
import json
import os
import pathlib
import sys
import time
from collections.abc import Mapping
from typing import Any

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.process_pool import worker_pool
from urbanverse_mjx.robots import gait_of, legged, load

from .lib.gait_published import goals_table, published_table
from .lib.gait_trials import KERBS, SLOPES, Judge, judge_flat, judge_kerbs, judge_pushes, judge_ramps, judge_straight

#: Goals of a gait as upper or lower limits: kerbs up and down, every ramp of a street (1:8).
AT_MOST = {"error_linear_m_s": 0.1, "error_angular_rad_s": 0.15, "falls_percent": 1.0}
KERB_GOALS = {0.12: 90.0, 0.15: 70.0}
PUSH_GOAL, RAMP_GOAL = 95.0, 100.0


def parse(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.go2_gait", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    walkers = [name for name in legged.NAMES if legged.row(name).drive == "gait"]
    parser.add_argument("--robot", choices=walkers, default="go2")
    parser.add_argument("--gait", type=pathlib.Path, help="gait file (default: the shipped one)")
    parser.add_argument("--episodes", type=int, default=1000, help="on level ground")
    parser.add_argument("--trials", type=int, default=100, help="of each kerb, ramp, and half of the kicks")
    parser.add_argument("--seconds", type=float, default=20.0, help="of an episode on level ground")
    parser.add_argument("--kerbs", type=float, nargs="*", default=KERBS, help="heights, m")
    parser.add_argument("--slopes", type=float, nargs="*", default=SLOPES)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--processes", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--json", action="store_true", help="print one JSON line in place of the tables")
    parser.add_argument(
        "--show", type=pathlib.Path, metavar="FILE", help="walk nothing, print the tables of a JSON line"
    )
    arguments = parser.parse_args(argv)
    if min(arguments.episodes, arguments.trials, arguments.processes) < 1 or arguments.seconds < 2.0:
        parser.error("--episodes, --trials and --processes must be at least 1, --seconds at least 2")
    return arguments


def judge_all(arguments: argparse.Namespace) -> dict[str, Any]:
    """Runs all trials of a gait."""
    robot = load(arguments.robot)
    gait = gait_of(robot, arguments.gait)
    if arguments.processes == 1:
        return _judge(arguments, Judge(robot, gait))
    with worker_pool(arguments.processes) as pool:
        return _judge(arguments, Judge(robot, gait, pool))


def _judge(arguments: argparse.Namespace, judge: Judge) -> dict[str, Any]:
    begin = time.monotonic()
    name = arguments.gait.name if arguments.gait else "the shipped gait"
    found: dict[str, Any] = {"gait": name, "meta": judge.gait.meta, "seed": arguments.seed}
    found["flat"] = judge_flat(judge, arguments.episodes, arguments.seconds, arguments.seed)
    _say("level ground", found["flat"])
    found["straight"] = judge_straight(judge, arguments.trials, arguments.seed)
    _say("straight ahead", found["straight"])
    found["pushes"] = judge_pushes(judge, 2 * arguments.trials, arguments.seed)
    _say("kicks", found["pushes"])
    found["kerbs"] = []
    for row in judge_kerbs(judge, arguments.trials, arguments.seed, arguments.kerbs):
        found["kerbs"].append(row)
        _say("kerb", row)
    found["ramps"] = []
    for row in judge_ramps(judge, arguments.trials, arguments.seed, arguments.slopes):
        found["ramps"].append(row)
        _say("ramp", row)
    found["goals"] = goals(found)
    found["wall_seconds"] = round(time.monotonic() - begin, 1)
    return found


def goals(found: dict[str, Any]) -> dict[str, bool]:
    """Returns whether each tested goal is met."""
    flat = found["flat"]
    reached = {name: flat[name] is not None and flat[name] <= limit for name, limit in AT_MOST.items()}
    reached["kicks_survived"] = found["pushes"]["survived_percent"] >= PUSH_GOAL
    for row in found["kerbs"]:
        if row["height_m"] in KERB_GOALS:
            name = f"kerb_{row['height_m']:g}_{row['way']}"
            reached[name] = row["passed_percent"] >= KERB_GOALS[row["height_m"]]
    for row in found["ramps"]:
        reached[f"ramp_{row['slope']:g}"] = row["passed_percent"] >= RAMP_GOAL
    return reached


def tables(found: Mapping[str, Any]) -> str:
    """Markdown: the results with the goals, and with published figures."""
    return f"{goals_table(found, AT_MOST, KERB_GOALS, PUSH_GOAL, RAMP_GOAL)}\n\n{published_table(found)}"


def _earlier(path: pathlib.Path) -> Mapping[str, Any]:
    """Reads the results of an earlier run."""
    parts = ("gait", "meta", "seed", "flat", "straight", "pushes", "kerbs", "ramps", "goals", "wall_seconds")
    return v.mapping(v.read_json(path, "what the judge found"), str(path), parts)


def _say(what: str, row: dict[str, Any]) -> None:
    text = ", ".join(f"{k} {v:.3g}" if isinstance(v, float) else f"{k} {v}" for k, v in row.items())
    print(f"{what}: {text}", file=sys.stderr, flush=True)


def main(argv: list[str] | None = None) -> int:
    arguments = parse(argv)
    try:
        found = _earlier(arguments.show) if arguments.show else judge_all(arguments)
    except ValidationError as error:
        print(error, file=sys.stderr)
        return 2
    print(json.dumps(found) if arguments.json else tables(found))
    return 0 if all(found["goals"].values()) else 1


if __name__ == "__main__":
    sys.exit(main())
