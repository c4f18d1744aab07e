"""Measures the time from a recording to five compiled cousins, over the number of frames."""

import dataclasses
import pathlib
import resource
import time

from urbanverse_mjx.datatypes import Recording
from urbanverse_mjx.pipeline import GenerationOptions, generate
from urbanverse_mjx.work_folder import work_folder

FRAMES = (10, 40, 80, 180, 720)
#: The steps of `urbanverse gen` for a recording, up to MJCF, USD and the bank, without the report's images.
_STAGES = ("graph", "cousins", "scenes", "bank")
_OPTIONS = GenerationOptions(cousins=5, pictures=False)


def scaling(recording: Recording, frames: tuple[int, ...] = FRAMES) -> list[dict[str, float]]:
    """Returns the seconds per stage for the first n frames of a recording, with growing n, on the cores of this
    process.

    A run with ten frames comes first, unmeasured, to fill the cache of base meshes. `seconds` is the sum of the stages,
    `processor_s` counts this process and its workers, with the report.
    """
    table = []
    with work_folder("urbanverse-scaling-") as work:
        counts = [n for n in frames if n <= len(recording)]
        for k, count in enumerate([min(FRAMES[0], len(recording)), *counts]):
            folder = pathlib.Path(work) / str(k)
            part = _first(recording, count, folder / "recording")
            before, wall = _processor(), time.perf_counter()
            made = generate(part, folder / "run", _OPTIONS)
            row = {"frames": count, "nodes": made["nodes"], "placed": min(made["placed"])}
            row |= {f"{name}_s": round(made["seconds"][name], 1) for name in _STAGES}
            row["seconds"] = round(sum(made["seconds"][name] for name in _STAGES), 1)
            row |= {
                "with_report_s": round(time.perf_counter() - wall, 1),
                "processor_s": round(_processor() - before, 1),
            }
            row["seconds_per_frame"] = round(row["seconds"] / count, 2)
            table.append(row)
    return table[1:]


def _first(recording: Recording, count: int, folder: pathlib.Path) -> pathlib.Path:
    """Writes the first frames of a recording as a new recording with linked images."""
    folder.mkdir(parents=True)
    for part in recording.folder.iterdir():
        if part.is_dir():
            (folder / part.name).symlink_to(part.absolute(), target_is_directory=True)
    dataclasses.replace(recording, frames=recording.frames[:count], folder=folder).save()
    return folder


def _processor() -> float:
    """s of this process and of those that it waited for."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime
