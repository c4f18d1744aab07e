"""Measures the throughput of the whole environment step, of its parts, of training, and of other simulators.

    python -m benchmarks.throughput --impl jax --num-envs 64 --pixels 36x64 --json

prints one JSON line: env-steps/s with auto-reset and one frame a step, as in PPO; the seconds of a step for physics,
refit and render, and resets, each run alone over the same states, and the remainder; compile seconds; peak memory; and
the physics alone at the most expensive positions of the bank (robots driven into the nearest object), with its cost as
a ratio to the same robot on the same ground without hull slots. Every figure is the median over the repeats; `*_spread`
is (slowest - fastest) / median. Without --json the same is printed one figure a line.

Options that take a comma list are measured in every combination; --grid FILE lists combinations explicitly (a JSON list
of objects with fields of `benchmarks.lib.cases.Case`):

    python -m benchmarks.throughput --bank bank160.npz --preset paper --num-envs 1024,4096 --pixels 135x240,36x64 \\
        --scenes 16,160 --measure step,parts,learn --baselines mjx,warp,c --append rows.jsonl --isolate --json
    python -m benchmarks.throughput --bank bank160.npz --grid benchmarks/grids/gpu.json --isolate --append rows.jsonl

Each row is appended to --append's file immediately. A configuration that fails (for example out of memory) becomes a
row with "error", and the next one is measured. With --isolate each runs in its own process, so that memory peaks are
separate and a crash affects no other. --compare BASELINE exits with 1 if a rate is slower than the baseline by more
than --tolerance, or a row failed. Measures: step, parts, refit (what a frame costs before its pixels), active (the most
expensive physics), policy (inference, and rollouts with it), learn (the whole PPO training of the preset).
"""

import argparse
import functools
import gc
import json
import pathlib
import subprocess
import sys
import time
import traceback
from collections.abc import Iterator, Sequence
from typing import Any

import jax
import numpy as np
import psutil

from benchmarks.lib import banks, baselines, memory, report
from benchmarks.lib import measure as measurements
from benchmarks.lib.cases import MEASURES, Case, product, read_grid
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.datatypes.validation import write_atomically
from urbanverse_mjx.envs import registry
from urbanverse_mjx.simulation.engines import IMPLS

#: Options that take a comma list, and the type of their values; their names are fields of `Case`.
AXES = {"impl": str, "num_envs": int, "pixels": str, "scenes": int, "hulls": int, "substeps": int, "preset": str}
#: Placeholder for the baseline of this device kind if --compare or --save-baseline has no file.
_OWN = pathlib.Path()


def parse(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.throughput", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    add = parser.add_argument
    add("--env", default="CocoNav")
    add("--preset", default="cpu", help="comma list")
    add("--impl", default="auto", help=f"comma list of {', '.join(IMPLS)}")
    add("--num-envs", default="64", help="comma list")
    add("--pixels", default="36x64", metavar="HxW", help="comma list of height and width of the frame, or none")
    add("--bank", type=pathlib.Path, help="a bank file (default: the shipped streets)")
    add("--scenes", help="comma list: keep the bank's first so many scenes")
    add("--hulls", help="comma list: keep at most so many hulls a scene")
    add("--substeps", help="comma list: physics steps a control step")
    add("--num-slots", type=int, help="hulls streamed to a robot")
    add("--shading", help="of the renderer")
    add("--shadows", action=argparse.BooleanOptionalAction)
    add("--sky", action=argparse.BooleanOptionalAction)
    add("--set", action="append", default=[], metavar="KEY=JSON", help="an env config override, again and again")
    add("--ppo-set", action="append", default=[], metavar="KEY=JSON", help="a training config override")
    add("--measure", default="step,parts,active", help=f"comma list of {', '.join(MEASURES)}")
    add("--learn", action="store_true", help="the same as adding learn to --measure")
    add(
        "--baselines",
        "--rivals",
        dest="rivals",
        default="",
        help=f"comma list of {', '.join(baselines.BASELINES)}, measured beside each configuration",
    )
    add("--steps", type=int, default=20, help="control steps in one timed run")
    add("--repeats", type=int, default=5, help="timed runs")
    add("--iterations", type=int, default=4, help="PPO iterations of the measure learn")
    add("--seed", type=int, default=0)
    add("--grid", type=pathlib.Path, help="JSON file of configurations; fields left out are as the options say")
    add("--isolate", action="store_true", help="each configuration in a process of its own")
    add("--case-timeout", type=float, default=540.0, help="s that such a process may take")
    add("--append", type=pathlib.Path, help="JSON Lines file that each row is added to at once")
    add("--markdown", type=pathlib.Path, help="file for a table of all rows")
    add("--proof", type=pathlib.Path, help="PNG with a frame of each of the first 64 envs")
    own = {"type": pathlib.Path, "nargs": "?", "const": _OWN, "metavar": "FILE"}
    add("--compare", **own, help="compare with a baseline (default file: benchmarks/baselines/<device>.json)")
    add("--tolerance", type=float, default=report.TOLERANCE, help="share by which a rate may be below the baseline's")
    add("--save-baseline", **own, help="keep the rates as a baseline (the same default)")
    add("--json", action="store_true", help="print one JSON line a row")
    return parser.parse_args(argv)


def _list(text: str, kind: Any, option: str) -> list[Any]:
    try:
        return [kind(part) for part in text.split(",") if part]
    except ValueError:
        raise ValidationError(
            f"--{option.replace('_', '-')}: found {text!r}, needed a comma list of numbers."
        ) from None


def _settings(pairs: Sequence[str], option: str) -> dict[str, Any]:
    found = {}
    for pair in pairs:
        key, separator, value = pair.partition("=")
        try:
            found[key] = json.loads(value) if separator else None
        except json.JSONDecodeError:
            found[key] = value
        if not separator or not key:
            raise ValidationError(f"--{option}: found {pair!r}, needed KEY=JSON such as vision_config.samples=2.")
    return found


def cases_of(arguments: argparse.Namespace) -> list[Case]:
    """Returns all configurations of the options.

    Raises:
      ValidationError: a value is invalid.
    """
    measure = _list(arguments.measure, str, "measure") + ["learn"] * arguments.learn
    same = ("env", "num_slots", "shading", "shadows", "sky", "steps", "repeats", "iterations", "seed")
    base = Case(
        **{name: getattr(arguments, name) for name in same},
        bank=str(arguments.bank) if arguments.bank else None,
        overrides=_settings(arguments.set, "set"),
        ppo=_settings(arguments.ppo_set, "ppo-set"),
        measure=tuple(dict.fromkeys(measure)),
        rivals=tuple(_list(arguments.rivals, str, "rivals")),
    )
    axes = {n: _list(t, kind, n) for n, kind in AXES.items() if (t := getattr(arguments, n)) is not None}
    cases = product(base, axes)
    if arguments.grid:
        cases = [case for one in cases for case in read_grid(arguments.grid, one)]
    for case in cases:
        for name, known in ((case.impl, IMPLS), *((r, tuple(baselines.BASELINES)) for r in case.rivals)):
            if name not in known:
                raise ValidationError(f"configuration: found {name!r}, needed one of {', '.join(known)}.")
    return cases


@functools.lru_cache(maxsize=2)
def _load_bank(path: str | None) -> SceneBank:
    # Scenes are compiled only if no bank is given, because a GPU machine may lack CoACD and trimesh.
    if path:
        return SceneBank.load(path)
    from urbanverse_mjx.pipeline import ensure_default_bank

    return ensure_default_bank(quiet=True)


def load_env(case: Case) -> Any:
    """Returns the environment of a case over its bank, reduced to the case's scenes."""
    bank = _load_bank(case.bank)
    if case.scenes is not None:
        bank = banks.first_scenes(bank, case.scenes)
    if case.hulls is not None:
        bank = banks.with_hulls(bank, case.hulls)
    control = registry.get_default_config(case.env, case.preset).ctrl_dt
    return registry.load(case.env, config_overrides=case.config_overrides(control), bank=bank)


def rows_of(case: Case, proof: pathlib.Path | None = None) -> Iterator[dict[str, Any]]:
    """Measures a case and then its baselines, one row each; a failure becomes a row with "error"."""
    row = {**report.planned(case), "machine": report.machine()}
    env = None
    try:
        begin = time.perf_counter()
        env = load_env(case)
        row = {**report.describe(env, case), "load_s": time.perf_counter() - begin, "machine": row["machine"]}
        for found in _figures(env, case, proof):
            row |= found
    except ValidationError as error:
        row["error"] = str(error)
    except Exception as error:  # out of memory, a driver's failure: the next configuration may still work
        row["error"] = f"{type(error).__name__}: {error}".strip()[:500]
        traceback.print_exc()
    yield report.rounded({**row, "memory": memory.report()})
    for name in case.rivals if env is not None else ():
        same = {k: row[k] for k in ("num_envs", "pixels", "physics_steps_per_env_step", "bank", "machine", "steps")}
        yield report.rounded({"scenes": 1, **same, **_baseline_row(name, env, case), "memory": memory.report()})


def _figures(env: Any, case: Case, proof: pathlib.Path | None) -> Iterator[dict[str, Any]]:
    """Yields the case's measurements one by one, so that those before a failure are kept."""
    wanted = set(case.measure)
    if wanted - {"learn"}:
        run = measurements.start(env, case)
        yield {"compile_s": run.compile_s}
        if wanted & {"step", "parts", "refit"}:
            figures, whole = measurements.step(run)
            since = time.time() - psutil.Process().create_time()
            yield {**figures, "seconds_since_start": since}
            if proof is not None and "pixels/front" in run.state.obs:
                report.proof_sheet(np.asarray(run.state.obs["pixels/front"][: report.PROOF]), proof)
            if "parts" in wanted:
                split = measurements.parts(run, whole)
                # The parts of a step stay at the top level, as in earlier files.
                top = ("seconds_per_step", "seconds_per_step_spread", "share")
                yield {name: split.pop(name) for name in top} | {"parts": split}
            if "refit" in wanted and env.renderer is not None:
                yield {"refit": measurements.refit(run)}
        if "active" in wanted:
            yield {"physics_active": measurements.active(run)}
        if "policy" in wanted:
            yield {"policy": measurements.policy(run)}
    if "learn" in wanted:
        yield {"learn": measurements.learn(case, env)}


def _baseline_row(name: str, env: Any, case: Case) -> dict[str, Any]:
    try:
        return baselines.measure(name, env, case)
    except Exception as error:
        traceback.print_exc()
        return {"rival": name, "error": f"{type(error).__name__}: {error}".strip()[:500]}


def isolated(case: Case, proof: pathlib.Path | None, timeout: float) -> Iterator[dict[str, Any]]:
    """Yields the rows of a case, measured in a separate process."""
    command = [sys.executable, "-m", "benchmarks.throughput", "--grid", "/dev/stdin", "--json"]
    command += ["--proof", str(proof)] if proof else []
    try:
        done = subprocess.run(
            command,
            input=json.dumps([case.to_json()]),
            stdout=subprocess.PIPE,
            text=True,
            timeout=timeout,
            check=False,
        )
        text, status = done.stdout, done.returncode
        # A configuration that failed with an exception has reported it in its row.
        how = "" if status in (0, 1, 2) else f"the process ended with status {status}; see its messages above"
    except subprocess.TimeoutExpired as error:
        text = error.stdout.decode() if isinstance(error.stdout, bytes) else error.stdout or ""
        how = f"no end within {timeout:g} s"
    lines = [line for line in text.splitlines() if line.startswith("{")]
    yield from (json.loads(line) for line in lines)
    if how or not lines:
        # This process must not use the device, which belongs to the next process.
        yield {**report.planned(case), "error": how or "no row"}


def measure_all(arguments: argparse.Namespace, cases: Sequence[Case]) -> list[dict[str, Any]]:
    """Returns the rows of all cases, each written immediately."""
    rows = []
    for number, case in enumerate(cases):
        proof = arguments.proof
        if proof is not None and len(cases) > 1:
            proof = proof.with_name(f"{proof.stem}-{number}{proof.suffix}")
        found = isolated(case, proof, arguments.case_timeout) if arguments.isolate else rows_of(case, proof)
        for row in found:
            rows.append(row)
            if arguments.append:
                with arguments.append.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(row) + "\n")
            _show(row, arguments.json)
        if number + 1 < len(cases):  # the next one shall find an empty device
            gc.collect()
            jax.clear_caches()
    return rows


def _show(row: dict[str, Any], as_json: bool) -> None:
    if as_json:
        print(json.dumps(row), flush=True)
        return
    for name, value in row.items():
        print(f"{name}: {json.dumps(value)}", flush=True)


def _baseline(path: pathlib.Path, rows: Sequence[dict[str, Any]]) -> pathlib.Path:
    return report.own_baseline(rows) if path == _OWN else path


def _judge(arguments: argparse.Namespace, rows: Sequence[dict[str, Any]]) -> int:
    """Writes table, baseline and comparison; returns the exit status."""
    if arguments.markdown:
        table = report.markdown(rows)
        write_atomically(arguments.markdown, lambda temporary: temporary.write_text(table, encoding="utf-8"))
    if arguments.save_baseline is not None:
        report.save_baseline(rows, _baseline(arguments.save_baseline, rows))
    failed = [row["error"] for row in rows if row.get("error")]
    for error in failed:
        print(f"error: {error}", file=sys.stderr)
    if len(failed) == len(rows):
        return 2
    slower = []
    if arguments.compare is not None:
        found = report.compare(rows, _baseline(arguments.compare, rows), arguments.tolerance)
        slower = [one for one in found if one["slower"]]
        for one in found:
            verdict = "SLOWER" if one["slower"] else "ok"
            print(f"{verdict} {one['ratio']:.3f} of the baseline: {one['rate']} of {one['what']}", file=sys.stderr)
    return 1 if slower or failed else 0


def main(argv: list[str] | None = None) -> int:
    arguments = parse(argv)
    try:
        cases = cases_of(arguments)
        return _judge(arguments, measure_all(arguments, cases))
    except ValidationError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
