"""Measures how long policies take for one action of one robot on one core.

    python -m benchmarks.policy_latency benchmarks/policies/* --json

A policy or run folder is exported first, as `urbanverse export-onnx` does; an ONNX file is taken as it is. The process
is pinned to one core, onnxruntime uses one thread, and the observations are random. A time holds what the policy's
process of `urbanverse deploy` computes for an action, without messages between processes.
"""

import argparse
import json
import os
import pathlib
import platform
import sys
import time
from typing import Any

import numpy as np

from urbanverse_mjx.deployment.policy_process import load
from urbanverse_mjx.policies.onnx_agent import IMAGE
from urbanverse_mjx.work_folder import work_folder


def parse(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.policy_latency", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("policies", nargs="+", type=pathlib.Path)
    parser.add_argument("--actions", type=int, default=1000, help="number of timed actions")
    parser.add_argument("--json", action="store_true", help="one JSON line for each policy instead of a table")
    return parser.parse_args(argv)


def measure(path: pathlib.Path, actions: int, seed: int = 0) -> dict[str, Any]:
    """Median, 99th percentile and minimum (ms) of the time of one action; path: an ONNX file."""
    agent, contract = load(path)
    rng = np.random.default_rng(seed)
    inputs: dict[str, np.ndarray] = {
        "goal": 10.0 * rng.normal(size=(1, 2)).astype(np.float32),
        "proprio": rng.normal(size=(1, 5)).astype(np.float32),
    }
    if contract.size is not None:
        inputs[IMAGE] = rng.integers(0, 256, (1, *contract.size, 3), np.uint8)
    times = np.empty(actions)
    for n in range(-20, actions):
        began = time.perf_counter()
        agent({name: inputs[name] for name in contract.observations})
        if n >= 0:
            times[n] = 1e3 * (time.perf_counter() - began)
    size = None if contract.size is None else list(contract.size)
    values = {"median": np.median(times), "p99": np.percentile(times, 99), "minimum": times.min()}
    return {"image": size, **{k: round(float(x), 3) for k, x in values.items()}, "actions": actions}


def _cpu() -> str:
    lines = pathlib.Path("/proc/cpuinfo").read_text().splitlines() if pathlib.Path("/proc/cpuinfo").is_file() else []
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), platform.machine())


def main(argv: list[str] | None = None) -> int:
    args = parse(argv)
    rows = []
    with work_folder("latency-") as folder:
        files = []
        for path in args.policies:
            file = path
            if path.is_dir():
                from urbanverse_mjx.training.export_onnx import export_onnx

                file = folder / f"{path.name}.onnx"
                export_onnx(path, file)
            files.append((path.name, file))
        if hasattr(os, "sched_setaffinity"):
            os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
        for name, file in files:
            rows.append(
                {"policy": name, **measure(file, args.actions), "cpu": _cpu(), "load": round(os.getloadavg()[0], 1)}
            )
    if args.json:
        print("\n".join(map(json.dumps, rows)))
        return 0
    print("| policy | image | median ms | p99 ms |\n|---|---|---|---|")
    for row in rows:
        image = "none" if row["image"] is None else "x".join(map(str, row["image"]))
        print(f"| {row['policy']} | {image} | {row['median']:.2f} | {row['p99']:.2f} |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
