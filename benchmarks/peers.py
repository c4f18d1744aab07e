"""Env-steps per second beside the engines that one would pick for the same street with the same robot.

    python -m benchmarks.peers --bank craftbench/bank.npz --scenes craftbench/scenes --rows peers.jsonl --budget 200
    python -m benchmarks.peers --add peers.jsonl
    python -m benchmarks.peers --page

The first command measures the cases of `PLAN`, the most telling first (or those of --peers, --num-envs, --streets and
--pixels in every combination), each in a process of its own with a time limit, and appends a row at once. A case that
fails, runs out of memory or out of time becomes a row that says so. Cases that have a row in the file are not measured
again (--again: those with an error are). Cases are left out once --budget seconds are over; started again the command
goes on with them. With --together cases that differ in the number of envs alone share a process, which saves its start.
The second command keeps rows in benchmarks/scores/peers.csv, in place of those of the same case and device. The third
one writes the table and the figure of docs/performance.md. --save-baseline and --compare keep and compare rates as
those of `benchmarks.throughput` do.

All of them take the street's `scene.xml` as `urbanverse scene compile` writes it, and our environment the same street
of the bank. The robot (COCO), its starts, the commands' distribution, the physics step (10 ms), and their number in a
control step (20) are the same. Ours has more in the timed step: observations, rewards, hits, the map, and resets of the
episodes that end; the others begin again after a fixed number of control steps (--episode). Every figure is the median
of the repeats; the spread is (slowest - fastest) / median; compilation is what comes before the second control step.
"""

import argparse
import contextlib
import dataclasses
import json
import os
import pathlib
import queue
import signal
import subprocess
import sys
import threading
import time
import traceback
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from benchmarks.lib.peers import page
from benchmarks.lib.peers.plan import KEY, OURS, PEERS, PLAN, Case, key_of, same_process
from urbanverse_mjx.datatypes import ValidationError

#: s and m: of the preset `paper`, which our environment is measured with.
CONTROL, SUBSTEPS, PRESET = 0.2, 20, "paper"
#: Control steps of different commands, which our environment scans in one call.
STEPS = 20
#: MJX compiles a collision function for every distinct mesh; the cut street of `mjx-cut` has so many.
CUT_HULLS, CUT_PRISMS = 12, 4
#: Contacts that MJX solves, as many as our engine of JAX; without a limit every pair of geoms gets rows.
MJX_CONTACTS = 12
_TAG = '{"benchmark": "peers"'


def parse(argv: Sequence[str] | None) -> argparse.Namespace:
    """The command line; argv: that of this process by default."""
    cli = argparse.ArgumentParser(prog="python -m benchmarks.peers", description=__doc__)
    cli.formatter_class = argparse.RawDescriptionHelpFormatter
    add = cli.add_argument
    add("--bank", type=pathlib.Path, help="the bank of our environment; its first scenes are those of --scenes")
    add("--scenes", type=pathlib.Path, help="folder of compiled scenes, named as in the bank")
    add("--rows", type=pathlib.Path, help="JSON Lines file that rows are appended to, and that says what is done")
    add("--peers", help=f"comma list of {', '.join(PEERS)}; without it the cases of the plan")
    add("--num-envs", default="64", help="comma list")
    add("--streets", default="1", help="comma list of the number of streets at once")
    add("--pixels", default="none", metavar="HxW", help="comma list of height and width of the images, or none")
    add("--limit", type=float, default=180.0, help="s that a case may take, kernels that are not compiled yet included")
    add("--budget", type=float, default=float("inf"), help="s after which no further case is started")
    add("--together", action="store_true", help="one process for cases that differ in the number of envs alone")
    add("--again", action="store_true", help="measure cases again whose row is an error")
    add("--repeats", type=int, default=5, help="timed runs")
    add("--seconds", type=float, default=0.4, help="s that a timed run of a peer takes, about; 1 to 20 control steps")
    add("--episode", type=int, default=50, help="control steps after which an env of a peer begins again")
    add("--gl", default="egl", choices=("egl", "osmesa"), help="OpenGL of C MuJoCo's images")
    add("--images", type=pathlib.Path, help="folder for the first env's image of each case")
    add("--add", type=pathlib.Path, metavar="ROWS", help="keep the rows of a file in benchmarks/scores")
    add("--page", action="store_true", help="write the table and the figure of docs/performance.md")
    own = {"type": pathlib.Path, "nargs": "?", "const": page.OWN, "metavar": "FILE"}
    add("--compare", **own, help="compare rows with a baseline (default: benchmarks/baselines/peers-<device>.json)")
    add("--tolerance", type=float, default=0.15, help="share by which a rate may be below the baseline's")
    add("--save-baseline", **own, help="keep the rates of the rows as a baseline (the same default)")
    add("--worker", action="store_true", help=argparse.SUPPRESS)
    args = cli.parse_args(argv)
    if not args.page and args.add is None and None in (args.bank, args.scenes, args.rows):
        cli.error("needed --bank, --scenes and --rows, or --add, or --page")
    if args.repeats < 1 or args.episode < 1 or args.seconds <= 0.0 or args.limit <= 0.0:
        cli.error("needed --repeats and --episode of at least 1, --seconds and --limit above 0")
    return args


def cases_of(args: argparse.Namespace) -> list[Case]:
    """Returns the plan, or every combination of the options.

    Raises:
      ValidationError: a value is not valid.
    """
    if args.peers is None:
        return list(PLAN)
    lists = {}
    for name in ("num_envs", "streets"):
        text = getattr(args, name)
        try:
            lists[name] = [int(part) for part in text.split(",")]
        except ValueError:
            option = name.replace("_", "-")
            raise ValidationError(f"--{option}: found {text!r}, needed a comma list of numbers.") from None
    return [
        Case(peer, count, streets, pixels)
        for pixels in args.pixels.split(",")
        for streets in lists["streets"]
        for peer in args.peers.split(",")
        for count in lists["num_envs"]
    ]


def read_rows(path: pathlib.Path) -> list[dict[str, Any]]:
    """Returns the rows of a file, of each case the last; none if there is no file. A last line cut off in writing is
    left out.

    Raises:
      ValidationError: a line before the last one is no row.
    """
    found: dict[Any, dict[str, Any]] = {}
    lines = path.read_text(encoding="utf-8").splitlines() if path.is_file() else []
    for number, line in enumerate(lines, 1):
        try:
            row = json.loads(line)
            found[key_of(row)] = row
        except (json.JSONDecodeError, KeyError, TypeError) as error:
            if number < len(lines):
                raise ValidationError(
                    f"{path}, line {number}: found no row ({error}), needed JSON with {', '.join(KEY)}."
                ) from error
    return list(found.values())


def left(cases: Iterable[Case], rows: Iterable[dict[str, Any]], again: bool) -> list[Case]:
    """Returns the cases without a row; again: or with one of an error."""
    done = {key_of(row) for row in rows if not (again and row.get("error"))}
    return [case for case in cases if case.key not in done]


# --- one process ------------------------------------------------------------------------------------------------------


class Ours:
    """Our environment; loaded once for several numbers of envs."""

    def __init__(self, args: argparse.Namespace) -> None:
        self._args, self._loaded = args, (None, None)

    def row(self, case: Case) -> dict[str, Any]:
        from benchmarks.lib import cases, measure
        from benchmarks.throughput import load_env

        config = cases.Case(
            preset=PRESET,
            impl=OURS[case.peer],
            num_envs=case.num_envs,
            pixels=case.pixels,
            bank=str(self._args.bank),
            scenes=case.streets,
            overrides={"scenes": "all"},
            measure=("step",),
            steps=STEPS,
            repeats=self._args.repeats,
        )
        begin = time.perf_counter()
        same = dataclasses.replace(config, num_envs=1)
        if self._loaded[0] != same:
            self._loaded = same, load_env(config)
        env: Any = self._loaded[1]
        run = measure.start(env, config)
        figures, _ = measure.step(run)
        compile_s = sum(run.compile_s.values()) + figures["first_call_s"]
        hulls = ((env.bank.inst_hull >= 0).sum(1) + (env.bank.prism_hull >= 0).sum(1)).max()
        if env.n_substeps != SUBSTEPS or round(env.dt, 6) != CONTROL:
            raise ValidationError(f"preset {PRESET}: found {env.n_substeps} physics steps, needed {SUBSTEPS}.")
        self._save(case, run)
        return {
            **{name: figures[name] for name in ("env_steps_per_s", "env_steps_per_s_spread", "ended_share")},
            "compile_s": compile_s,
            "start_s": time.perf_counter() - begin,
            "steps": STEPS,
            "repeats": self._args.repeats,
            "hulls": int(hulls),
            "slots": int(env.config.num_slots),
            "slot_overflow_share": figures["slot_overflow_share"],
            "does": "a street of its own for each env; observations, rewards, hits and resets",
        }

    def _save(self, case: Case, run: Any) -> None:
        if self._args.images is not None and "pixels/front" in run.state.obs:
            import numpy as np

            page.save_image(self._args.images, case, np.asarray(run.state.obs["pixels/front"][0]))


def folders_of(args: argparse.Namespace, count: int) -> list[pathlib.Path]:
    """Returns the folders of the first scenes.

    Raises:
      ValidationError: there are not so many.
    """
    found = sorted(path.parent for path in args.scenes.glob("*/scene.xml"))[:count]
    if len(found) < count:
        raise ValidationError(f"--scenes {args.scenes}: found {len(found)} compiled scenes, needed {count}.")
    return found


def peer_row(args: argparse.Namespace, case: Case, cores: int) -> dict[str, Any]:
    """Measures an engine that is not ours."""
    from benchmarks.lib import memory
    from benchmarks.lib.peers import timed
    from benchmarks.lib.peers.street import Cut, make_drive
    from urbanverse_mjx.robots import make_coco

    robot, folders, size = make_coco(), folders_of(args, case.streets), case.size
    drive = make_drive(
        folders, robot, case.num_envs, substeps=SUBSTEPS, control=CONTROL, episode=args.episode, steps=STEPS
    )
    if case.peer == "c-mujoco":
        from benchmarks.lib.peers.c_peer import Processes, Rollout

        def make() -> timed.Peer:
            if size is None and len(folders) == 1:
                return Rollout(folders[0], robot, drive, cores)
            return Processes(folders, robot, drive, size, cores, args.gl)

    elif case.peer in ("mjx", "mjx-cut"):
        from benchmarks.lib.peers.jax_peer import stock_mjx

        cut = Cut(drive.qpos[0, :2], CUT_HULLS, CUT_PRISMS) if case.peer == "mjx-cut" else None
        if cut is not None:
            drive = dataclasses.replace(drive, qpos=drive.qpos[:1].repeat(case.num_envs, 0))

        def make() -> timed.Peer:
            return stock_mjx(folders, robot, drive, MJX_CONTACTS, cut)

    else:
        from benchmarks.lib.peers.warp_peer import MujocoWarp

        def make() -> timed.Peer:
            return MujocoWarp(folders, robot, drive, size, "mjlab" if case.peer == "mjlab" else "control")

    peer, figures = timed.timed(make, case.num_envs, args.repeats, args.seconds, STEPS)
    try:
        figures["gpu_mib_all"] = memory.device_mib()
        if args.images is not None and size is not None:
            page.save_image(args.images, case, peer.image(0).reshape(*size, 3))
    finally:
        peer.close()
    return {**figures, "ended_share": 1.0 / args.episode}


def work(args: argparse.Namespace, cases: Sequence[Case]) -> None:
    """Measures cases in this process and prints a row each."""
    from benchmarks.lib import memory, report

    before = memory.device_mib()
    ours = Ours(args)
    for case in cases:
        row: dict[str, Any] = {"benchmark": "peers", **case.to_json()}
        try:
            case.check()
            machine = page.machine()
            row |= ours.row(case) if case.peer in OURS else peer_row(args, case, machine["cores"])
            after = row.pop("gpu_mib_all", None) or memory.device_mib()
            row["gpu_mib"] = None if after is None or before is None else after - before
            row["machine"] = machine
        except ValidationError as error:
            row["error"] = str(error)
        except Exception as error:  # out of memory, no OpenGL, a driver's failure: the next case may still work
            traceback.print_exc()
            row["error"] = f"{type(error).__name__}: {error}".strip()[:300]
        print(json.dumps(report.rounded(row)), flush=True)


# --- the process that starts the others -------------------------------------------------------------------------------


def isolated(
    args: argparse.Namespace, cases: Sequence[Case], machine: dict[str, Any], over: float
) -> Iterator[dict[str, Any]]:
    """Yields a row of each case, measured in a separate process. After a case that ends the process or is out of time
    the others get a new one. Ends without further rows at the monotonic time `over`."""
    rest = list(cases)
    while rest and time.monotonic() < over:
        process = _start(args, rest)
        lines: queue.Queue[str | None] = queue.Queue()
        threading.Thread(target=_read, args=(process, lines), daemon=True).start()
        grace = 0.0
        try:
            while rest:
                row, why = _next_row(process, lines, min(args.limit, over - time.monotonic()))
                if row is None and time.monotonic() >= over:
                    return
                yield row or {"benchmark": "peers", **rest[0].to_json(), "error": why, "machine": machine}
                del rest[0]
                if row is None:
                    break
            else:
                grace = 5.0
        finally:
            _end(process, grace)


def _start(args: argparse.Namespace, cases: Sequence[Case]) -> "subprocess.Popen[str]":
    options = [
        ("--bank", args.bank),
        ("--scenes", args.scenes),
        ("--rows", args.rows),
        ("--repeats", args.repeats),
        ("--seconds", args.seconds),
        ("--episode", args.episode),
        ("--gl", args.gl),
        *([("--images", args.images)] if args.images else []),
    ]
    command = [sys.executable, "-m", "benchmarks.peers", "--worker", *(str(x) for pair in options for x in pair)]
    env = {**os.environ, "XLA_PYTHON_CLIENT_PREALLOCATE": "false"}
    if not any(case.peer in PEERS and PEERS[case.peer].uses_jax for case in cases):
        env["JAX_PLATFORMS"] = "cpu"  # the commands alone come from JAX: the GPU is left to the peer
    process = subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=env, start_new_session=True
    )
    assert process.stdin is not None
    with contextlib.suppress(BrokenPipeError), process.stdin:
        process.stdin.write(json.dumps([case.to_json() for case in cases]))
    return process


def _read(process: "subprocess.Popen[str]", lines: "queue.Queue[str | None]") -> None:
    assert process.stdout is not None
    for line in process.stdout:
        lines.put(line)
    lines.put(None)


def _next_row(
    process: "subprocess.Popen[str]", lines: "queue.Queue[str | None]", limit: float
) -> tuple[dict[str, Any] | None, str]:
    """Returns the next row, or None and why there is none."""
    deadline = time.monotonic() + limit
    while True:
        try:
            line = lines.get(timeout=max(deadline - time.monotonic(), 0.0))
        except queue.Empty:
            return None, f"no end within {limit:g} s"
        if line is None:
            return None, f"the process ended with status {process.wait()}; see its messages"
        if line.startswith(_TAG):
            return json.loads(line), ""


def _end(process: "subprocess.Popen[str]", grace: float) -> None:
    """Ends a process with those that it started; one that is done gets so many seconds to end by itself."""
    with contextlib.suppress(subprocess.TimeoutExpired):
        process.wait(grace)
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def measure_all(args: argparse.Namespace, cases: Sequence[Case]) -> list[dict[str, Any]]:
    """Measures the cases that have no row, within the budget; returns all rows of the file."""
    begin = time.monotonic()
    args.rows.parent.mkdir(parents=True, exist_ok=True)
    todo = left(cases, read_rows(args.rows), args.again)
    machine = page.machine()
    for group in same_process(todo) if args.together else [[case] for case in todo]:
        for row in isolated(args, group, machine, begin + args.budget):
            with args.rows.open("a", encoding="utf-8") as file:
                file.write(json.dumps(row) + "\n")
            print(f"{time.monotonic() - begin:6.1f} s  {page.brief(row)}", flush=True)
    rows = read_rows(args.rows)
    not_run = left(cases, rows, again=False)
    if not_run:
        print(
            f"the budget of {args.budget:g} s is over; not run: {'; '.join(x.title for x in not_run)}", file=sys.stderr
        )
    return rows


def main(argv: Sequence[str] | None = None) -> int:
    args = parse(argv)
    try:
        if args.worker:
            work(args, [Case(**one) for one in json.load(sys.stdin)])
            return 0
        if args.add is not None:
            print(f"{page.add(read_rows(args.add))} rows in {page.TABLE}")
        if args.page:
            page.write_page()
        if args.add is not None or args.page:
            return 0
        cases = cases_of(args)
        for case in cases:
            case.known()
        rows = measure_all(args, cases)
        return page.judge(rows, args)
    except ValidationError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
