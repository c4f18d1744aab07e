"""Long missions: 300-400 m over joined blocks with crossings and people, driven by the loop of `urbanverse deploy`.

    python -m benchmarks.missions --out OUT                                  # 50 missions with COCO and 50 with the Go2
    python -m benchmarks.missions --out OUT --policy runs/mine --missions 0 1 2
    python -m benchmarks.missions --out OUT --blocks 1 --block 40 --missions 0     # a short one, to try it out
    python -m benchmarks.missions --out OUT --policy coco_best --film 7      # writes OUT/mission_07.mp4 as well
    python -m benchmarks.missions --out OUT --seconds 1200                   # what can be driven in 20 minutes
    python -m benchmarks.missions --out OUT --add
    python -m benchmarks.missions --page

A simulation, not the paper's mission of 337 m in a real street. A mission's number gives its street (of 10), the side
where it begins, its direction and its people, so it can be driven again. Waypoints lie every 10 m along the shortest
route, the robot knows the next one, and the controller of `urbanverse deploy` drives it (`lib.mission_drive`) in
C MuJoCo. A scripted supervisor takes over when the robot is stuck, about to touch something or somebody or to leave the
pavement, or has touched something, drives a few metres along the route and hands back: an intervention. A mission fails
by a fall, if the supervisor gives up, or after 25 minutes.

POLICY and robot as in `benchmarks.transfer`. Streets are compiled into OUT/streets once; the missions of a street and a
robot are a task of one process, and finished ones are kept in OUT/missions, so that a stopped run continues, also on
another machine to which that folder was copied. A machine without what compiling needs drives OUT/streets of another
one by `--scenes`. OUT/result.json and the last line of stdout have the rates; `--add` writes the missions of the
default policies into benchmarks/scores/missions.csv, and `--page` the table in docs/results.md, as `make results` does.
"""

import argparse
import csv
import functools
import json
import math
import os
import pathlib
import sys
import time
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from benchmarks import results, transfer
from benchmarks.lib import mission_streets as streets
from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.evaluation.metrics import wilson_interval
from urbanverse_mjx.process_pool import results_as_completed

DRIVERS = (("coco_best", "coco"), ("go2_best", "go2"))
MARKS = "<!-- missions: python -m benchmarks.missions --page -->", "<!-- end of missions -->"
#: Share of the crowd's slots that are filled.
FILLED = 0.7
FPS = 10.0
#: Number of missions below which there is no bootstrap over them: arrivals then have Wilson's interval.
FEW = 8
_CAUSES = ("stuck", "near object", "near person", "leaving the pavement", "contact")
COLUMNS = ("policy", "robot", "blocks", "block", "mission", "end", "metres", "seconds", "waypoints", "of", "supervised")


def build_street(number: int, size: streets.Size, folder: pathlib.Path) -> str:
    """Compiles a street into a folder, if it is not there; returns why not, or ""."""
    return transfer.compile_graph(streets.street(number, size).graph(), folder)


@functools.lru_cache(1)
def _street(folder: pathlib.Path, robot: str, size: Any, vision: str) -> tuple[Any, Any, Any]:
    """World, surroundings and people of a compiled street."""
    from benchmarks.lib import shifts
    from benchmarks.lib.mission_drive import People, Surroundings
    from benchmarks.lib.street_world import World, make_robot
    from urbanverse_mjx.scene import pack_bank

    spec = make_robot(robot)[0]
    people = People(pack_bank([folder], ["test"]), spec, FILLED)
    agents = {"agents": people.shapes, "appearances": people.appearances}
    world = World.load(folder, robot, shifts.Shifts(), size, json.loads(vision), **agents)
    return world, Surroundings(world.geometry.map, spec.planner_height), people


def drive(
    tested: transfer.TestedPolicy,
    number: int,
    size: streets.Size,
    folder: pathlib.Path,
    file: pathlib.Path,
    film: bool,
    until: float = math.inf,
) -> bool:
    """Drives a mission in this process and writes what became of it; with a film of the same name, if asked.

    Args:
      until: s of `time.time`, after which it does not begin.

    Returns:
      whether it was driven.
    """
    if time.time() >= until:
        return False
    from benchmarks.lib.mission_drive import Track, contract_of, drive_mission

    task = transfer.load_task(tested)
    world, near, people = _street(folder, tested.robot, task.size, json.dumps(dict(task.vision)))
    policy, track = task.agent, Track() if film else None
    contract = contract_of(policy.record, policy.observations, world.robot, tested.source)
    done = drive_mission(world, near, streets.mission(number, size), policy, contract, people, track)
    if track is not None:
        _film(track, folder, world, people, done, file.with_suffix(".mp4"))
    v.write_json(file, done)
    return True


def drive_street(missions: Sequence[tuple[Any, ...]]) -> list[bool]:
    """Drives missions of one street and robot in this process, which loads and compiles for them once.

    Args:
      missions: arguments of `drive`.

    Returns:
      whether each was driven.
    """
    return [drive(*mission) for mission in missions]


def _film(
    track: Any, folder: pathlib.Path, world: Any, people: Any, done: Mapping[str, Any], path: pathlib.Path
) -> None:
    from urbanverse_mjx.datatypes import AgentMotion
    from urbanverse_mjx.evaluation.rollouts import Trajectory
    from urbanverse_mjx.scene import pack_bank
    from urbanverse_mjx.viz.video import write_rollout_video

    fields: list[Any] = [np.stack(field)[:, None] for field in zip(*track.people, strict=True)]
    poses = np.stack(track.xpos)[:, None], np.stack(track.xquat)[:, None]
    trajectory = Trajectory(*poses, np.ones((len(track.xpos), 1), bool), AgentMotion(*fields))
    outcome = {"arrived": "goal", "fall": "fall"}.get(done["end"], "timeout")
    bank = pack_bank([folder], ["test"])
    goal = np.array([*track.xpos[-1][1][:2], 0.0])
    write_rollout_video(
        path, bank, world.robot, trajectory, [0], [0], [goal], [outcome], FPS, people.appearances
    )  # fmt: skip


def mission_file(out: pathlib.Path, tested: transfer.TestedPolicy, size: streets.Size, number: int) -> pathlib.Path:
    """Where a mission's outcome is kept."""
    name = f"{tested.name}-{tested.robot}"
    return out / "missions" / name / f"{size.blocks}x{size.block:g}" / f"mission_{number:02d}.json"


def summary(missions: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Rates over missions, with 95 % intervals from a bootstrap over missions."""
    taken = np.array([sum(m["interventions"].values()) for m in missions], float)
    km = np.array([m["metres"] for m in missions]) / 1e3
    arrived = np.array([m["end"] == "arrived" for m in missions], float)
    at = np.random.default_rng(results.SEED).integers(0, len(missions), (results.DRAWS, len(missions)))

    def with_interval(top: np.ndarray, under: np.ndarray) -> list[float]:
        low, high = np.percentile(top[at].sum(1) / np.maximum(under[at].sum(1), 1e-9), [2.5, 97.5])
        return [round(float(x), 3) for x in (top.sum() / max(under.sum(), 1e-9), low, high)]

    causes = {c: sum(m["interventions"][c] for m in missions) for c in missions[0]["interventions"]}
    return {
        "missions": len(missions),
        "km": round(float(km.sum()), 3),
        "arrived": with_interval(100.0 * arrived, np.ones_like(arrived)),
        "interventions_per_km": with_interval(taken, km),
        "causes": causes,
        "minutes": round(float(np.mean([m["seconds"] for m in missions])) / 60.0, 2),
        "supervised_percent": round(
            100.0 * sum(m["supervised"] for m in missions) / sum(m["seconds"] for m in missions), 2
        ),
    }


def read_missions(out: pathlib.Path, tested: transfer.TestedPolicy, size: streets.Size) -> list[dict[str, Any]]:
    """Outcomes of a policy's missions that are there."""
    folder = mission_file(out, tested, size, 0).parent
    return [v.read_json(file, "mission") for file in sorted(folder.glob("mission_*.json"))]


def add(out: pathlib.Path, folder: pathlib.Path = results.SCORES, size: streets.Size | None = None) -> int:
    """Writes the missions of the default policies that are there into missions.csv, which keeps the others; returns
    their number."""
    size, count = size or streets.Size(), 0
    for name, robot in DRIVERS:
        missions = read_missions(out, transfer.TestedPolicy(name, "", robot), size)
        about = {"policy": name, "robot": robot, "blocks": size.blocks, "block": f"{size.block:g}"}
        rows = [
            {**about, **{k: m[k] for k in COLUMNS[4:]}, **{c: m["interventions"][c] for c in _CAUSES}} for m in missions
        ]
        for row in rows:
            results.replace_rows(folder / "missions.csv", {**about, "mission": row["mission"]}, [row])
        count += len(rows)
    return count


# Page.


def page_text(folder: pathlib.Path = results.SCORES) -> str:
    """Markdown of the part of the page between the marks."""
    found: dict[tuple[str, str, str], list[dict[str, Any]]] = {}
    with (folder / "missions.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            body = {k: float(row[k]) for k in ("metres", "seconds", "supervised")}
            body |= {"end": row["end"], "interventions": {c: int(row[c]) for c in _CAUSES}}
            size = f"{row['blocks']} x {row['block']} m"
            found.setdefault((row["policy"], row["robot"], size), []).append(body)
    lines = []
    for (policy, robot, size), missions in found.items():
        said = summary(missions)
        rate = "{:.1f} [{:.1f}, {:.1f}]".format(*said["interventions_per_km"])
        arrived = "{:.0f} [{:.0f}, {:.0f}]".format(*said["arrived"])
        if len(missions) < FEW:
            good = sum(m["end"] == "arrived" for m in missions)
            low, high = wilson_interval(good, len(missions))
            arrived = f"{said['arrived'][0]:.0f} [{100 * low:.0f}, {100 * high:.0f}]"
            rate = f"{said['interventions_per_km'][0]:.1f}"
        causes = " / ".join(str(x) for x in said["causes"].values())
        title = {"coco": "COCO", "go2": "Go2"}[robot]
        cells = [policy, title, size, str(said["missions"]), f"{said['km']:.2f}", arrived, rate, causes]
        lines.append(f"| {' | '.join([*cells, f'{said["minutes"]:.1f}', f'{said["supervised_percent"]:.1f}'])} |")
    head = ["policy", "robot", "blocks", "missions", "km", "arrived, %", "interventions per km"]
    head += [" / ".join(_CAUSES), "minutes", "time supervised, %"]
    parts = ["\n".join([f"| {' | '.join(head)} |", f"|{' --- |' * len(head)}", *lines])] if lines else []
    full = streets.Size()
    wanted = f"{full.blocks} x {full.block:g} m"
    driven = {(name, r): len(found.get((name, r, wanted), ())) for name, r in DRIVERS}
    absent = [f"{total() - n} of {name} ({r})" for (name, r), n in driven.items() if n < total()]
    if absent:
        parts.append(
            f"Not run yet, of {total()} missions: {', '.join(absent)}; `python -m benchmarks.missions --out OUT` runs "
            "what is missing."
        )
    return "\n\n".join(parts)


def total() -> int:
    """Number of missions."""
    return streets.STREETS * streets.EACH


def write_page() -> None:
    """Writes the table in docs/results.md."""
    page = results.with_table(results.PAGE.read_text(encoding="utf-8"), page_text(), MARKS)
    results.PAGE.write_text(page, encoding="utf-8")


# Command line.


def arguments(argv: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line; argv: that of this process by default."""
    cli = argparse.ArgumentParser(
        prog="python -m benchmarks.missions",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    cli.add_argument("--out", type=pathlib.Path)
    cli.add_argument("--policy", help="default: coco_best on COCO, go2_best on the Go2")
    cli.add_argument("--robot", choices=sorted(transfer.ROBOTS.values()))
    cli.add_argument("--missions", nargs="+", type=int, default=list(range(total())), metavar="NUMBER")
    cli.add_argument("--blocks", type=int, default=streets.Size().blocks, help="of a street")
    cli.add_argument("--block", type=float, default=streets.BLOCK, help="m of a block")
    cli.add_argument("--film", nargs="+", type=int, default=[], metavar="NUMBER", help="missions to film")
    cli.add_argument("--scenes", type=pathlib.Path, metavar="FOLDER", help="of compiled streets; default: OUT/streets")
    cli.add_argument("--workers", type=int, default=settings.num_threads(), help="processes")
    cli.add_argument(
        "--seconds", type=float, default=math.inf, help="begin no mission after this time; default: no end"
    )
    cli.add_argument("--add", action="store_true", help="write the missions that are there into benchmarks/scores")
    cli.add_argument("--page", action="store_true", help="write the table of docs/results.md")
    args = cli.parse_args(argv)
    if args.out is None and not args.page:
        cli.error("--out: needed a folder, or --page")
    return args


def _main(args: argparse.Namespace) -> int:
    if args.page:
        write_page()
        return 0
    args.out = args.out.absolute()
    v.integer(args.workers, "--workers", 1)
    if args.seconds != math.inf:
        v.number(args.seconds, "--seconds", 0.0)
    until = time.time() + args.seconds
    v.integer(args.blocks, "--blocks", 1, 8)
    size = streets.Size(args.blocks, v.number(args.block, "--block", 30.0, 200.0))
    if args.add:
        print(json.dumps({"missions": add(args.out, size=size)}))
        return 0
    for number in (*args.missions, *args.film):
        v.integer(number, "--missions", 0, total() - 1)
    named = [(args.policy, args.robot)] if args.policy is not None else DRIVERS
    tested_policies = [transfer.find_policy(policy, robot, args.out) for policy, robot in named]
    numbers = sorted({*args.missions, *args.film} if args.missions else args.film)
    folders = _build(numbers, size, args)
    tasks: dict[tuple[int, int], list[tuple[Any, ...]]] = {}
    for policy, tested in enumerate(tested_policies):
        for number in numbers:
            file, film, street = (
                mission_file(args.out, tested, size, number),
                number in args.film,
                number % streets.STREETS,
            )
            if not file.is_file() or (film and not file.with_suffix(".mp4").is_file()):
                of_street = tasks.setdefault((policy, street), [])
                of_street.append((tested, number, size, folders[street], file, film, until))
    together = [(of_street,) for of_street in tasks.values()]
    total_number, done = sum(len(x) for x in tasks.values()), 0
    for task, driven in results_as_completed(drive_street, together, args.workers):
        for (tested, _, _, _, file, _, _), it_was in zip(together[task][0], driven, strict=True):
            done += it_was
            if it_was:
                said = json.dumps(v.read_json(file, "mission"))
                print(f"{done}/{total_number} {tested.name}: {said}", file=sys.stderr, flush=True)
    done_by = {f"{d.name} ({d.robot})": read_missions(args.out, d, size) for d in tested_policies}
    found = {name: summary(done) for name, done in done_by.items() if done}
    v.write_json(args.out / "result.json", found)
    print(json.dumps(found))
    return 0


def _build(numbers: Sequence[int], size: streets.Size, args: argparse.Namespace) -> dict[int, pathlib.Path]:
    """Folder of each street that is needed; compiles what is not there, unless `--scenes` names the folder of all."""
    wanted = sorted({number % streets.STREETS for number in numbers})
    names = {number: streets.street_id(number, size) for number in wanted}
    if args.scenes is not None:
        from urbanverse_mjx.scene.folders import scene_folders

        there = {folder.name: folder for folder in scene_folders([args.scenes])}
        for name in names.values():
            v.choice(name, f"--scenes {args.scenes}", tuple(there))
        return {number: there[name] for number, name in names.items()}
    from urbanverse_mjx.assets.records.store import ensure_store

    ensure_store()
    folders = {number: args.out / "streets" / name for number, name in names.items()}
    tasks = [(number, size, folder) for number, folder in folders.items()]
    for done, (task, reason) in enumerate(results_as_completed(build_street, tasks, args.workers), 1):
        if reason:
            raise ValidationError(f"street {wanted[task]}: {reason}")
        print(f"{done}/{len(tasks)} streets", file=sys.stderr, flush=True)
    return folders


def main(argv: Sequence[str] | None = None) -> int:
    """Runs the command."""
    args = arguments(argv)
    # Every process computes on one core.
    os.environ |= {"OMP_NUM_THREADS": "1", "URBANVERSE_THREADS": "1", "JAX_PLATFORMS": "cpu"}
    settings.use_compilation_cache()
    try:
        return _main(args)
    except ValidationError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
