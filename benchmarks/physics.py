"""Measures the physics of a control step alone: MuJoCo Warp's kernels against the fused step, on the same states.

    python -m benchmarks.physics --bank bank160.npz --num-envs 1024,4096,8192 --json

drives COCO from the bank's own start poses towards their goals, so that many robots stand at objects, and times every
engine over the same control steps, called in turn. One JSON line a number of envs holds, per engine, milliseconds of a
control step (of wall time, and of all processor cores together, which other programs disturb less), physics steps/s,
and seconds until the first step was done (compilation included), and between the engines how far apart the robots are
after the first control step and whether they report the same hits. `--launches` counts the
kernels that a physics step launches instead, by name.
"""

import argparse
import collections
import json
import pathlib
import sys
import time
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import mujoco
import numpy as np

from benchmarks.lib import report, timing
from urbanverse_mjx.datatypes import RobotSpec, SceneBank, ValidationError
from urbanverse_mjx.robots import make_coco, make_go2
from urbanverse_mjx.simulation.engines import make_engine

ROBOTS = {"coco": make_coco, "ackermann": lambda: make_coco("ackermann"), "go2": make_go2}
#: m/s forwards and rad/s that COCO is commanded, by env, in turn.
COMMANDS = ((2.0, 0.0), (1.0, 0.5), (1.5, -0.5), (0.5, 1.0), (0.0, -1.0), (2.0, 0.3))


def parse(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.physics", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--bank", type=pathlib.Path, help="a bank file (default: the shipped streets)")
    parser.add_argument("--scenes", type=int, help="its first so many scenes")
    parser.add_argument("--robot", choices=ROBOTS, default="coco")
    parser.add_argument("--impl", default="warp,warp-fused", help="comma list of engines")
    parser.add_argument("--num-envs", default="64", help="comma list")
    parser.add_argument("--control-dt", type=float, default=0.2, help="s")
    parser.add_argument("--steps", type=int, default=5, help="control steps in one timed run")
    parser.add_argument("--repeats", type=int, default=5, help="timed runs")
    parser.add_argument("--drive", type=int, default=8, help="control steps before the timing, which reach objects")
    parser.add_argument("--launches", action="store_true", help="count the kernels of a physics step")
    parser.add_argument("--json", action="store_true", help="print one JSON line a number of envs")
    return parser.parse_args(argv)


def load_bank(arguments: argparse.Namespace) -> SceneBank:
    if arguments.bank is None:
        from urbanverse_mjx.pipeline import ensure_default_bank

        bank = ensure_default_bank(quiet=True)
    else:
        bank = SceneBank.load(arguments.bank)
    if arguments.scenes is not None:
        from benchmarks.lib import banks

        bank = banks.first_scenes(bank, arguments.scenes)
    return bank


def starts(bank: SceneBank, robot: RobotSpec, number: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Scenes (n,), qpos (n, nq) at random start poses of their episodes, and commands (n, nu)."""
    rng = np.random.default_rng(seed)
    scene = np.arange(number, dtype=np.int32) % bank.num_scenes
    row = rng.integers(0, np.asarray(bank.num_episodes)[scene])
    pose = bank.episode_start[scene, row]
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    qpos = np.tile(model.key_qpos[0] if model.nkey else model.qpos0, (number, 1)).astype(np.float32)
    qpos[:, :3] = pose[:, :3]
    qpos[:, 2] += robot.spawn_height
    qpos[:, 3], qpos[:, 4:6], qpos[:, 6] = np.cos(pose[:, 3] / 2), 0.0, np.sin(pose[:, 3] / 2)
    if robot.name.startswith("coco"):
        ctrl = np.stack([np.asarray(robot.command(np.array(COMMANDS[i % len(COMMANDS)]))) for i in range(number)])
    else:
        ctrl = np.tile(qpos[0, 7:], (number, 1))
    return scene, qpos, ctrl.astype(np.float32)


def launches(engine: Any, state: Any, ctrl: Any) -> dict[str, int]:
    """Kernels launched in one physics step by name, most first; a control step of two less one of one."""
    import warp as wp

    found: list[collections.Counter[str]] = []
    count = collections.Counter[str]()
    originals = {name: getattr(wp, name) for name in ("launch", "launch_tiled")}

    def counted(original: Any) -> Any:
        def launch(kernel: Any, *args: Any, **kwargs: Any) -> Any:
            count[getattr(kernel, "key", str(kernel))] += 1
            return original(kernel, *args, **kwargs)

        return launch

    step = jax.vmap(engine.step)
    whole = engine.num_substeps
    try:
        for name, original in originals.items():
            setattr(wp, name, counted(original))
        for substeps in (1, 2):
            engine.num_substeps = substeps
            jax.block_until_ready(step(state, ctrl))
            count.clear()
            jax.block_until_ready(step(state, ctrl))
            found.append(collections.Counter(count))
    finally:
        for name, original in originals.items():
            setattr(wp, name, original)
        engine.num_substeps = whole
    return dict((found[1] - found[0]).most_common())


def time_in_turn(calls: dict[str, Callable[[], Any]], repeats: int) -> dict[str, tuple[timing.Sample, timing.Sample]]:
    """Wall and processor times of several calls in turn, each called once before."""
    for call in calls.values():
        jax.block_until_ready(call())
    seconds: dict[str, list[tuple[float, float]]] = {name: [] for name in calls}
    for _ in range(repeats):
        for name, call in calls.items():
            wall, processor = time.perf_counter(), time.process_time()
            jax.block_until_ready(call())
            seconds[name].append((time.perf_counter() - wall, time.process_time() - processor))
    columns = {name: tuple(zip(*rows, strict=True)) for name, rows in seconds.items()}
    return {name: (timing.Sample(walls), timing.Sample(own)) for name, (walls, own) in columns.items()}


def measure(arguments: argparse.Namespace, bank: SceneBank, robot: RobotSpec, number: int) -> dict[str, Any]:
    """The figures of all engines for one number of envs."""
    scene, qpos, ctrl = starts(bank, robot, number)
    row: dict[str, Any] = {"benchmark": "physics", "robot": robot.name, "num_envs": number, "scenes": bank.num_scenes}
    row |= {"machine": report.machine(), "engines": {}}
    calls, after, engines = {}, {}, []
    # A graph hides its launches.
    options: dict[str, Any] = {"graphs": False} if arguments.launches else {}
    for impl in arguments.impl.split(","):
        engine = make_engine(bank, robot, impl=impl, control_dt=arguments.control_dt, **options)
        engines.append(engine)
        state = jax.jit(jax.vmap(engine.init))(scene, qpos, jnp.zeros((number, engine.physics.model.nv)))
        if arguments.launches:
            counts = launches(engine, state, jnp.asarray(ctrl))
            row["engines"][impl] = {"launches_per_physics_step": sum(counts.values()), "by_name": counts}
            continue
        step = jax.jit(jax.vmap(engine.step))

        def run(state: Any, step: Any = step) -> Any:
            for _ in range(arguments.steps):
                state = step(state, ctrl)
            return state

        begin = time.perf_counter()
        after[impl] = jax.block_until_ready(step(state, ctrl))
        first = time.perf_counter() - begin
        print(f"{impl}, {number} envs: first step after {first:.1f} s", file=sys.stderr, flush=True)
        for _ in range(arguments.drive):
            state = step(state, ctrl)
        state = jax.block_until_ready(state)
        row["engines"][impl] = {"first_step_s": round(first, 2), "hits": float(np.mean(state.contacts.hit))}
        calls[impl] = lambda run=run, state=state: run(state)
    if arguments.launches:
        return row
    for impl, (wall, processor) in time_in_turn(calls, arguments.repeats).items():
        each = wall.median / arguments.steps
        substeps = engines[0].num_substeps
        row["engines"][impl] |= {
            "control_step_ms": round(1e3 * each, 4),
            "spread": round(wall.spread, 3),
            "processor_ms": round(1e3 * processor.median / arguments.steps, 4),
            "physics_steps_per_s": round(number * substeps / each),
        }
    first_, *others = after.items()
    for impl, state in others:
        apart = np.linalg.norm(np.asarray(state.qpos)[:, :3] - np.asarray(first_[1].qpos)[:, :3], axis=1)
        differ = np.asarray(state.contacts.hit) != np.asarray(first_[1].contacts.hit)
        times = [row["engines"][name]["control_step_ms"] for name in (first_[0], impl)]
        row[f"{impl} against {first_[0]}"] = {
            "times_as_fast": round(times[0] / times[1], 2),
            "apart_mm_max": round(1e3 * float(apart.max()), 4),
            "apart_mm_median": round(1e3 * float(np.median(apart)), 5),
            "hits_differ": int(differ.sum()),
        }
    return row


def main(argv: list[str] | None = None) -> int:
    arguments = parse(argv)
    try:
        bank, robot = load_bank(arguments), ROBOTS[arguments.robot]()
        for number in map(int, arguments.num_envs.split(",")):
            row = measure(arguments, bank, robot, number)
            print(json.dumps(row, indent=None if arguments.json else 2), flush=True)
    except ValidationError as error:
        print(f"physics: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
