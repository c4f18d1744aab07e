"""Trains for hours in one process and checks that its memory, open files and compiled programs stay as they are.

    python -m benchmarks.soak                   # two hours on the CPU
    python -m benchmarks.soak --gpu             # nine minutes on a GPU, preset `fast`
    python -m benchmarks.soak --seconds 1800

The training is `urbanverse train` in a process of its own, which is asked to end (as by Ctrl-C) when the time is over.
The first quarter, and all before the second checkpoint, does not count: programs compile, allocators fill. After it
resident memory (on a GPU also the peak of what this process has there) may grow by 1 % at most, no program may be
compiled, and no more files may be open. Other programs may use the same GPU. Prints a log line per tenth and the
verdict on stderr, and a JSON line; exits with 1 if a check fails.
"""

import argparse
import json
import os
import pathlib
import resource
import shlex
import signal
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from benchmarks.lib.memory import device_mib
from benchmarks.lib.watched_training import CHECKPOINTS
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.work_folder import work_folder

#: More steps than any run makes.
STEPS = 1_000_000_000
#: Seconds by default, steps between two checkpoints, and options of `urbanverse train`.
CPU: tuple[float, int, tuple[str, ...]] = (7200.0, 8_192, ())
GPU: tuple[float, int, tuple[str, ...]] = (540.0, 131_072, ("--preset", "fast"))
#: On a GPU JAX takes memory as it needs it: by default it takes most of it at once, and leaves none to other programs.
#: The processor is named too, because callbacks of compiled programs need it.
_ON_GPU = {"JAX_PLATFORMS": "cuda,cpu", "XLA_PYTHON_CLIENT_PREALLOCATE": "false", "CUDA_VISIBLE_DEVICES": "0"}
_ON_CPU = {"JAX_PLATFORMS": "cpu", "CUDA_VISIBLE_DEVICES": ""}
#: Share of the time that does not count, and by how much memory may change (share).
WARM_UP, TOLERANCE = 0.25, 0.01
#: What JAX writes to stderr for each program that it compiles or reads from its cache.
_COMPILED = b"Finished XLA compilation of"

#: Of one moment: s since the start, MiB of memory, files, compiled programs, peak MiB on the device, checkpoints.
Sample = tuple[float, float, int, int, float, int]


def main(argv: Sequence[str] | None = None) -> int:
    cli = argparse.ArgumentParser(prog="python -m benchmarks.soak", description=__doc__)
    cli.formatter_class = argparse.RawDescriptionHelpFormatter
    cli.add_argument("--seconds", type=float, help="default: 7200, with --gpu 540")
    cli.add_argument("--gpu", action="store_true", help="train on the first GPU")
    cli.add_argument("--options", type=shlex.split, default=[], help="further ones of `urbanverse train`")
    args = cli.parse_args(argv)
    try:
        result = soak(args.seconds, args.options, gpu=args.gpu)
    except ValidationError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    print(verdict(result), file=sys.stderr)
    print(json.dumps(result))
    return 0 if result["ok"] else 1


def verdict(result: Mapping[str, Any]) -> str:
    """A sentence of what `judged` found."""
    device = f", of the device {result['device_growth_percent']:+g} %" if result["device_mib"] else ""
    return (
        f"{'ok' if result['ok'] else 'FAILED'}: in {result['minutes']:g} min memory changed by "
        f"{result['memory_growth_percent']:+g} %{device} (at most {100.0 * TOLERANCE:g} % more is allowed), "
        f"{result['compiled_after']} programs were compiled and {max(result['more_files'], 0)} more files were open "
        "(0 allowed)"
    )


def soak(
    seconds: float | None = None, options: Sequence[str] = (), every: float = 2.0, gpu: bool = False
) -> dict[str, Any]:
    """Trains for a time (s); see `judged` for the result.

    Args:
      seconds: None for that of `CPU` or `GPU`.
      options: further ones of `urbanverse train`.
      every: s between two samples.

    Raises:
      ValidationError: there is no GPU, its memory is not known, or the training ends by itself.
    """
    default, checkpoint_every, preset = GPU if gpu else CPU
    if gpu and device_mib() is None:
        raise ValidationError("soak: found no GPU (nvidia-smi), needed one for --gpu; leave it out to use the CPU.")
    with work_folder("urbanverse-soak-") as folder:
        log = folder / "stderr.txt"
        device = folder / "device_mib.txt"
        command = [sys.executable, "-m", "benchmarks.lib.watched_training", str(device)]
        command += ["--logdir", str(folder), "--quiet"]
        command += ["--num-timesteps", str(STEPS), "--num-episodes", "0", "--no-video", *preset]
        command += ["--ppo-overrides", json.dumps({"num_checkpoints": STEPS // checkpoint_every}), *options]
        with log.open("wb") as file:
            environment = {**os.environ, "JAX_LOG_COMPILES": "1", **(_ON_GPU if gpu else _ON_CPU)}
            process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=file, env=environment)
        try:
            samples = _samples(process, log, device, default if seconds is None else seconds, every)
        finally:
            process.send_signal(signal.SIGINT)
            try:
                process.wait(60.0)
            except subprocess.TimeoutExpired:
                process.kill()
        steps = [int(path.parent.name) for path in folder.glob(CHECKPOINTS)]
        result = {"checkpoints": len(steps), "steps": max(steps, default=0), **judged(samples)}
        if gpu and result["device_mib"] <= 0.0:
            raise ValidationError("soak: found no memory in use on the GPU, needed some; does JAX train on it?")
        return result


def _samples(
    process: "subprocess.Popen[bytes]", log: pathlib.Path, device: pathlib.Path, seconds: float, every: float
) -> list[Sample]:
    samples: list[Sample] = []
    begin, tenth = time.monotonic(), 0
    while (now := time.monotonic() - begin) < seconds:
        if process.poll() is not None:
            said = log.read_text(errors="replace").strip().splitlines()[-1:]
            raise ValidationError(f"soak: found that the training ended with status {process.returncode}: {said}.")
        memory, files = _memory_and_files(process.pid)
        on_device = float(device.read_text(encoding="ascii")) if device.is_file() else 0.0
        checkpoints = len(list(log.parent.glob(CHECKPOINTS)))
        samples.append((now, memory, files, log.read_bytes().count(_COMPILED), on_device, checkpoints))
        if now * 10 // seconds > tenth:
            tenth = int(now * 10 // seconds)
            print(
                f"{now / 60.0:6.1f} min  {memory:,.1f} MiB  {on_device:,.1f} MiB on the device  {files} files  "
                f"{samples[-1][3]} compiled  {checkpoints} checkpoints",
                file=sys.stderr,
                flush=True,
            )
        time.sleep(every)
    return samples


def _memory_and_files(pid: int) -> tuple[float, int]:
    """Resident memory of a process, MiB, and how many files it has open."""
    proc = pathlib.Path("/proc") / str(pid)
    pages = int((proc / "statm").read_text(encoding="ascii").split()[1])
    return pages * resource.getpagesize() / 2**20, len(os.listdir(proc / "fd"))


def judged(samples: Sequence[Sample]) -> dict[str, Any]:
    """What changed after the warm-up, and whether it is `ok`.

    Memory is compared between the medians of the first and the last tenth, files between the smallest numbers of the
    first and second half, since a checkpoint opens some while it is written; `slope_mib_per_hour` is that of a line
    through all samples.
    """
    found = np.array([s for s in samples if s[0] >= WARM_UP * samples[-1][0] and s[5] >= 2])
    if len(found) < 10:
        raise ValidationError(
            f"soak: found {samples[-1][5]} checkpoints in {samples[-1][0]:.0f} s, needed three or more; take more time."
        )
    tenth, half = len(found) // 10, len(found) // 2
    first, last = np.median(found[:tenth], axis=0), np.median(found[-tenth:], axis=0)
    slope = np.polyfit(found[:, 0] / 3600.0, found[:, 1], 1)[0]
    growth = (last[1] - first[1]) / first[1]
    on_device = (last[4] - first[4]) / first[4] if first[4] else 0.0
    files = int(found[half:, 2].min() - found[:half, 2].min())
    compiled = int(found[-1, 3] - found[0, 3])
    return {
        "minutes": round(samples[-1][0] / 60.0, 1),
        "memory_mib": round(float(first[1]), 1),
        "memory_growth_percent": round(100.0 * float(growth), 2),
        "slope_mib_per_hour": round(float(slope), 1),
        "device_mib": round(float(first[4]), 1),
        "device_growth_percent": round(100.0 * float(on_device), 2),
        "files": int(found[0, 2]),
        "more_files": files,
        "compiled_before": int(found[0, 3]),
        "compiled_after": compiled,
        "ok": bool(growth <= TOLERANCE and on_device <= TOLERANCE and files <= 0 and compiled == 0),
    }


if __name__ == "__main__":
    sys.exit(main())
