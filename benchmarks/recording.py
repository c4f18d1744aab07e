"""Measures how many frames a second `urbanverse record` writes, and each of its parts alone.

    python -m benchmarks.recording --cases 135x240@512,54x96@512 --num-episodes 512,1536
    python -m benchmarks.recording --with depth,segmentation,boxes --formats lerobot,coco --append rows.jsonl
    python -m benchmarks.recording --once --cases 135x240@1024 --num-episodes 8192  # compiles once

Each case is recorded with both numbers of episodes, once to fill the caches of compiled programs and then once each;
`frames_per_s` is the difference of the frames by that of the seconds, so that compiling and loading are in neither.
Of the parts each runs alone over the episodes of the smaller number, compiled before: driving, drawing, encoding in as
many threads as there are cores, and writing; `bound_frames_per_s` is the rate of the slowest, which the whole, whose
parts run at the same time, does not exceed where they share no core; `..._processor_ms` are a part's processor time for
a frame, of all threads together, which other processes change less.

With `--once` each case is a single recording of `--num-episodes`: `frames_per_s` is that of the frames on disk between
two writes of its files, the first with a tenth of the frames and the last; `cores` is the processor time in it, in
processors, of the threads that draw, drive ("ahead"), encode and write, of all others, and of ffmpeg.

Each result is one JSON line, printed and appended to `--append`; a case that fails is a line with "error", and the next
one follows.
"""

import argparse
import collections
import concurrent.futures
import contextlib
import dataclasses
import itertools
import json
import os
import pathlib
import re
import resource
import shutil
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from typing import Any

import jax

from urbanverse_mjx import pipeline
from urbanverse_mjx.datasets import DatasetWriter
from urbanverse_mjx.datasets.features import INFO_PATH
from urbanverse_mjx.pipeline.recording import record
from urbanverse_mjx.pipeline.recording.cameras import Drawn
from urbanverse_mjx.pipeline.recording.driving import BatchDrive, Driven, drawn_episodes
from urbanverse_mjx.pipeline.recording.encoding import Filmed
from urbanverse_mjx.pipeline.recording.formats import frame_episode, open_writer
from urbanverse_mjx.settings import num_threads
from urbanverse_mjx.work_folder import work_folder

#: Bytes of drawn frames that are kept for timing the encoder.
_KEPT = 2**30
#: s between two looks at what is on disk.
_LOOK_EVERY = 0.02


def parse(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.recording", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    add = parser.add_argument
    add("--cases", default="135x240@32", metavar="HxW@N,...", help="size of the images and number of envs")
    add("--formats", default="lerobot", help="comma list")
    add("--with", dest="sensors", default="", help="comma list of sensors, as in urbanverse record")
    add("--num-episodes", default="64,192", metavar="A,B", help="of the two recordings that are compared")
    add("--once", action="store_true", help="one recording a case, of a dataset as LeRobot has it")
    add("--policy", default="random")
    add("--preset", default="paper")
    add("--scenes", default="all")
    add("--bank", type=pathlib.Path, help="scene bank (default: that of the shipped streets)")
    add("--disk", type=pathlib.Path, help="folder in which datasets are written and removed (default: the system's)")
    add("--append", type=pathlib.Path, help="file to which each result is appended as a line")
    return parser.parse_args(argv)


def cases(args: argparse.Namespace) -> Iterator[tuple[int, pipeline.RecordOptions]]:
    """(larger number of episodes, options with the smaller one) of each case."""
    numbers = [int(word) for word in args.num_episodes.split(",")]
    if args.once:
        numbers = [numbers[-1], numbers[-1] + 1]
        if args.formats.split(",") != ["lerobot"]:
            raise SystemExit(
                f"--once: found --formats {args.formats}, needed lerobot, which counts its frames on disk."
            )
    if len(numbers) != 2 or not 0 < numbers[0] < numbers[1]:
        raise SystemExit(f"--num-episodes: found {args.num_episodes}, needed two numbers, the second the larger.")
    few, many = numbers
    for case, form in itertools.product(args.cases.split(","), args.formats.split(",")):
        size, _, envs = case.partition("@")
        height, width = (int(word) for word in size.split("x"))
        if few < int(envs):
            # Fewer envs drive then, and the larger number compiles a program of its own.
            raise SystemExit(f"--num-episodes: found {few}, needed at least the {envs} envs of {case}.")
        yield (
            many,
            pipeline.RecordOptions(
                policy=args.policy,
                num_episodes=few,
                format=form,
                preset=args.preset,
                bank=args.bank,
                scenes=args.scenes,
                num_envs=int(envs),
                size=(height, width),
                sensors=tuple(name for name in args.sensors.split(",") if name),
                quiet=True,
            ),
        )


def whole(options: pipeline.RecordOptions, many: int, disk: pathlib.Path) -> dict[str, Any]:
    """Rate of the command."""
    found, size = [], 0
    for count in (options.num_episodes, options.num_episodes, many):
        folder = disk / "dataset"
        found.append(pipeline.record(folder, dataclasses.replace(options, num_episodes=count)))
        size = sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
        shutil.rmtree(folder)
    _, few, all_ = found
    frames, seconds = all_["frames"] - few["frames"], all_["seconds"] - few["seconds"]
    return {
        "frames": all_["frames"],
        "seconds": all_["seconds"],
        "frames_per_s": round(frames / seconds, 1),
        "kilobytes_per_frame": round(size / all_["frames"] / 1e3, 2),
    }


def once(options: pipeline.RecordOptions, disk: pathlib.Path) -> dict[str, Any]:
    """Rate of a single recording, from its files while it is written.

    Raises:
      RuntimeError: it was written at once.
    """
    folder, ended = disk / "dataset", threading.Event()
    #: s, frames on disk, and processor time so far by thread, whenever there were more frames.
    seen: list[tuple[float, int, dict[str, float]]] = []

    def watch() -> None:
        path, busy = folder / INFO_PATH, ThreadTimes()
        while not ended.wait(_LOOK_EVERY):
            with contextlib.suppress(FileNotFoundError):
                count = json.loads(path.read_text(encoding="utf-8"))["total_frames"]
                if count and (not seen or count > seen[-1][1]):
                    seen.append((time.perf_counter(), count, busy()))

    watching = threading.Thread(target=watch, name="watch", daemon=True)
    watching.start()
    try:
        said = pipeline.record(folder, options)
    finally:
        ended.set()
        watching.join()
    size = sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
    shutil.rmtree(folder)
    first = next(row for row in seen if 10 * row[1] >= said["frames"])
    last = seen[-1]
    if last is first:
        raise RuntimeError(f"found {said['frames']} frames that were written at once, needed more --num-episodes.")
    seconds = last[0] - first[0]
    return {
        "frames": said["frames"],
        "seconds": said["seconds"],
        "counted_frames": last[1] - first[1],
        "counted_seconds": round(seconds, 2),
        "frames_per_s": round((last[1] - first[1]) / seconds, 1),
        "kilobytes_per_frame": round(size / said["frames"] / 1e3, 2),
        "cores": {name: round((busy - first[2].get(name, 0.0)) / seconds, 2) for name, busy in last[2].items()},
        "results": said["results"],
    }


class ThreadTimes:
    """Processor time of this process's threads by their names without numbers; "other": those that Python did not
    start, such as JAX's; "ffmpeg": children that have ended. Of a thread that has ended the last call counts."""

    def __init__(self) -> None:
        self._found: dict[threading.Thread, float] = {}

    def __call__(self) -> dict[str, float]:
        """s so far."""
        ticks = os.sysconf("SC_CLK_TCK")
        for thread in threading.enumerate():
            with contextlib.suppress(OSError):  # it has ended
                stat = pathlib.Path(f"/proc/self/task/{thread.native_id}/stat").read_text(encoding="utf-8")
                user, system = stat.rpartition(")")[2].split()[11:13]
                self._found[thread] = (int(user) + int(system)) / ticks
        found: dict[str, float] = collections.defaultdict(float)
        for thread, seconds in self._found.items():
            found[re.split(r"[-_]?\d", thread.name)[0]] += seconds
        children = resource.getrusage(resource.RUSAGE_CHILDREN)
        found["ffmpeg"] = children.ru_utime + children.ru_stime
        found["other"] = processor_seconds() - sum(found.values())
        return dict(found)


def parts(options: pipeline.RecordOptions, disk: pathlib.Path) -> dict[str, Any]:
    """Rates of the parts, frames/s."""
    sensors = record._checked(options)
    env, machine, scenes, features = record._prepared(options, sensors)
    episodes = drawn_episodes(env.bank, scenes, options.num_episodes, options.seed)
    drive, readings = BatchDrive(machine), record._readings(env, sensors)
    camera, encode = record._filming(env, options, sensors)
    rates: dict[str, Any] = {}
    processor: dict[str, float] = {}

    def timed[Item](part: str, work: Callable[[], list[Item]], length: Callable[[Item], int]) -> list[Item]:
        begin, before = time.perf_counter(), processor_seconds()
        found = work()
        seconds, busy = time.perf_counter() - begin, processor_seconds() - before
        count = sum(length(item) for item in found)
        rates[f"{part}_frames_per_s"] = round(count / seconds, 1)
        processor[f"{part}_processor_ms"] = round(1e3 * busy / count, 2)
        return found

    def driven() -> list[Driven]:
        return [episode for group in drive.run(episodes, options.num_envs) for episode in group]

    def drawn(own: list[Driven]) -> list[tuple[Driven, Drawn]]:
        found, size = [], 0
        for episode, images in camera.draw([own]):
            size += sum(part.nbytes for parts in images.values() for part in parts)
            # Of the others only the length counts.
            found.append((episode, images if size <= _KEPT or not found else {}))
        return found

    def encoded(own: list[tuple[Driven, Drawn]]) -> list[Filmed]:
        with concurrent.futures.ThreadPoolExecutor(num_threads()) as pool:
            return list(pool.map(lambda pair: encode(*pair), own))

    def written(own: list[Filmed]) -> list[Filmed]:
        origin = record._origin(options, machine, scenes, sensors)
        folder, form = disk / "dataset", options.format
        with open_writer(folder, form, options.size, options.lidar, features, env, origin, resume=False) as out:
            for filmed in own:
                columns, metadata = record._columns(env, readings, filmed.driven)
                if isinstance(out, DatasetWriter):
                    out.add(record._episode(filmed, columns, metadata))
                else:
                    out.add(frame_episode(filmed, columns, metadata))
        shutil.rmtree(disk / "dataset")
        return own

    # Compiles both programs.
    list(camera.draw([driven()[:1]]))
    steps = timed("drive", driven, frames)
    images = timed("draw", lambda: drawn(steps), lambda pair: frames(pair[0]))
    kept = [pair for pair in images if pair[1]]
    filmed = timed("encode", lambda: encoded(kept), lambda item: frames(item.driven))
    timed("write", lambda: written(filmed), lambda item: frames(item.driven))
    rates["bound_frames_per_s"] = min(rates.values())
    return {**rates, **processor}


def processor_seconds() -> float:
    """s of processor time of this process with its threads, and of its children that have ended (ffmpeg)."""
    own, children = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(use.ru_utime + use.ru_stime for use in (own, children))


def frames(episode: Driven) -> int:
    """Number of steps, and of images, of an episode."""
    return len(episode.steps.running)


def measured(options: pipeline.RecordOptions, many: int, disk: pathlib.Path, single: bool) -> dict[str, Any]:
    """The row of a case; single: one recording, else as many as `whole` makes."""
    device = jax.devices()[0]
    row: dict[str, Any] = {
        "size": "x".join(map(str, options.size)),
        "num_envs": options.num_envs,
        "num_episodes": options.num_episodes if single else [options.num_episodes, many],
        "format": options.format,
        "sensors": list(options.sensors),
        "policy": options.policy,
        "preset": options.preset,
        "device": device.device_kind,
        "cores": num_threads(),
        "load": round(os.getloadavg()[0], 2),
    }
    try:
        found = once(options, disk) if single else {**parts(options, disk), **whole(options, many, disk)}
        return {**row, **found}
    except Exception as error:
        traceback.print_exc()
        return {**row, "error": f"{type(error).__name__}: {error}"}


def main(argv: list[str] | None = None) -> int:
    """Measures every case; exit status 1 if one fails."""
    args = parse(argv)
    failed = False
    with work_folder("urbanverse-recording-", args.disk) as disk:
        for number, (many, options) in enumerate(cases(args)):
            row = measured(options, many, disk / str(number), args.once)
            failed |= "error" in row
            print(json.dumps(row), flush=True)
            if args.append:
                with args.append.open("a", encoding="utf-8") as out:
                    out.write(json.dumps(row) + "\n")
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
