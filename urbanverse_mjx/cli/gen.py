"""`urbanverse gen`: digital cousins of a tour; `urbanverse gen batch`: of many."""

import dataclasses
import json
import pathlib
from collections.abc import Sequence
from typing import Annotated, Literal

import tyro


@dataclasses.dataclass(frozen=True)
class GenArgs:
    """Make compiled digital cousins of a tour; goes on where an earlier run stopped; prints one JSON line."""

    source: Annotated[pathlib.Path, tyro.conf.Positional]
    """A video, a folder of frames, the folder of a recording (posed frames with depth and masks), or graph.json."""
    out: pathlib.Path
    """Folder of the run: graph, cousins, bank, report.html."""
    cousins: int = 5
    """How many cousins."""
    seed: int = 0
    """Chooses among assets, materials and skies that fit equally well, and the episodes."""
    kerb: float = 0.15
    """Height (m) that sidewalks get whose step to the road the source does not show; 0 leaves them."""
    usd: bool = True
    """Write every scene as USD too."""
    pictures: bool = True
    """Render pictures of the cousins for the report."""
    workers: int | None = None
    """Processes that compile; default: the cores this process may use."""
    rate: float = 2.0
    """Frames taken of a video per second; of a folder's pictures, how many were taken in a second."""
    camera_height: float = 1.5
    """Height (m) of the camera above the ground that is walked on: it gives the scale of a video."""
    blur: str | None = None
    """Detector of faces and number plates, which are blurred before a frame is stored; none: frames stay here."""
    licence: str = "unknown"
    """Of the video, for the records; as city and country."""
    city: str = "unknown"
    country: str = "unknown"
    quiet: bool = False


@dataclasses.dataclass(frozen=True)
class BatchArgs:
    """Make cousins of many sources; a source that fails never stops the rest; prints one JSON line.

    Exit status 1 where any source failed for good.
    """

    sources: Annotated[pathlib.Path, tyro.conf.Positional]
    """Text file with one source a line (relative to it); empty lines and lines from "#" on are passed over."""
    out: pathlib.Path
    """Folder with a run's folder per source and journal.jsonl."""
    executor: Literal["local", "ray"] = "local"
    """Where the work is done: processes here, or a Ray cluster (RAY_ADDRESS, else one started here)."""
    workers: int | None = None
    """Sources at a time; default: the cores of this machine, or of the cluster."""
    retries: int = 1
    """How often a source that failed is tried again."""
    cousins: int = 5
    """How many cousins of each source."""
    seed: int = 0
    """Chooses among assets, materials and skies that fit equally well, and the episodes."""
    usd: bool = True
    """Write every scene as USD too."""
    pictures: bool = False
    """Render pictures of the cousins for the reports."""
    rate: float = 2.0
    """Frames taken of a video per second."""
    camera_height: float = 1.5
    """Height (m) of the cameras above the ground that is walked on."""
    blur: str | None = None
    """Detector of faces and number plates, which are blurred before a frame is stored."""
    quiet: bool = False


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse gen ...`."""
    words = list(argv)
    if words[:1] == ["batch"]:
        return _batch(tyro.cli(BatchArgs, args=words[1:], prog="urbanverse gen batch"))
    return _gen(tyro.cli(GenArgs, args=words, prog="urbanverse gen"))


def _gen(args: GenArgs) -> int:
    from .generation import GenerationOptions, TourOptions, generate

    tour = TourOptions(args.rate, args.camera_height, args.blur, args.licence, args.city, args.country)
    options = GenerationOptions(args.cousins, args.seed, args.kerb, args.usd, args.pictures, args.workers, tour)
    print(json.dumps(generate(args.source, args.out, options, args.quiet)))
    return 0


def _batch(args: BatchArgs) -> int:
    from .generation import GenerationOptions, TourOptions
    from .generation.batch import run_batch

    # A source's own cousins are compiled one after another: the sources share the cores.
    tour = TourOptions(args.rate, args.camera_height, args.blur)
    options = GenerationOptions(args.cousins, args.seed, usd=args.usd, pictures=args.pictures, workers=1, tour=tour)
    done = run_batch(args.sources, args.out, options, args.executor, args.workers, args.retries, args.quiet)
    print(json.dumps(done))
    return 1 if done["failed"] else 0
