"""`urbanverse dataset`: prints statistics of a recorded dataset, checks its consistency, and shows its episodes."""

import dataclasses
import json
import pathlib
import sys
import webbrowser
from collections.abc import Sequence
from typing import Annotated

import tyro

from .. import pipeline
from ..datasets import DatasetSummary
from ..datatypes import validation as v
from ._options import parse


@dataclasses.dataclass(frozen=True)
class StatsArgs:
    """Print the contents of a dataset: episodes, frames, scenes, results, and the range of every number."""

    folder: Annotated[str, tyro.conf.Positional]
    """A LeRobotDataset v3."""
    json: bool = False
    """Print one JSON line instead."""


@dataclasses.dataclass(frozen=True)
class CheckArgs:
    """Check a dataset's counts, rows, times, numbers and videos against its metadata; exit status 1 if one is wrong.
    Changes no file."""

    folder: Annotated[str, tyro.conf.Positional]
    """A LeRobotDataset v3."""


@dataclasses.dataclass(frozen=True)
class ViewArgs:
    """Write one episode of a dataset as a page of its own, with images, numbers, boxes and the driven path, and open
    it in the browser."""

    folder: Annotated[str, tyro.conf.Positional]
    """A LeRobotDataset v3."""
    episode: int = 0
    """Which, from 0 on."""
    out: pathlib.Path | None = None
    """The page; default: FOLDER-episode-N.html in the current folder. An existing file is replaced."""
    open: bool = True
    """Open the page."""


_Command = (
    Annotated[StatsArgs, tyro.conf.subcommand("stats")]
    | Annotated[CheckArgs, tyro.conf.subcommand("check")]
    | Annotated[ViewArgs, tyro.conf.subcommand("view")]
)


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse dataset`."""
    args = parse(_Command, argv, "urbanverse dataset")  # type: ignore[arg-type]
    if isinstance(args, ViewArgs):
        return _view(args)
    return _stats(args) if isinstance(args, StatsArgs) else _check(args)


def _stats(args: StatsArgs) -> int:
    found = pipeline.summarise_dataset(args.folder)
    print(json.dumps(dataclasses.asdict(found)) if args.json else _text(found))
    return 0


def _view(args: ViewArgs) -> int:
    page = pipeline.dataset_page(args.folder, args.episode)
    name = f"{pathlib.Path(args.folder).resolve().name}-episode-{args.episode}.html"
    path = (args.out or pathlib.Path(name)).resolve()
    v.write_atomically(path, lambda temporary: temporary.write_text(page, encoding="utf-8"))
    print(json.dumps({"page": str(path)}))
    if args.open:
        webbrowser.open(path.as_uri())
    return 0


def _text(found: DatasetSummary) -> str:
    lines = [
        f"{found.folder}: {v.counted(found.episodes, 'episodes')}, {v.counted(found.frames, 'frames')} at "
        f"{found.frames_per_second} Hz "
        f"({found.hours:.2f} h), {found.megabytes:.1f} MB, robot {found.robot}",
    ]
    lines += [f"task: {task}" for task in found.tasks]
    if found.length:
        lines.append("frames an episode: " + ", ".join(f"{name} {n:g}" for name, n in found.length.items()))
    for title, counts in (("ended", found.results), ("scene", found.scenes)):
        lines += [f"{title} {name}: {count}" for name, count in counts.items()]
    lines.append(f"{'feature':<46}{'min':>11}{'mean':>11}{'max':>11}{'std':>11}")
    for name, body in found.features.items():
        numbers = list(zip(*(body.get(key, []) for key in ("min", "mean", "max", "std")), strict=True))
        parts = body.get("names") or [str(i) for i in range(len(numbers))]
        for part, row in zip(parts, numbers, strict=False):
            label = name if len(numbers) == 1 else f"{name} {part}"
            lines.append(f"{label:<46}" + "".join(f"{x:>11.4g}" for x in row))
    return "\n".join(lines)


def _check(args: CheckArgs) -> int:
    found = pipeline.check_dataset(args.folder)
    for line in (*found.problems, *(f"note: {note}" for note in found.notes)):
        print(line, file=sys.stderr)
    print(json.dumps({"dataset": args.folder, "sound": not found.problems, **dataclasses.asdict(found)}))
    return 1 if found.problems else 0
