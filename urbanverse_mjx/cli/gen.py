"""`urbanverse gen`: digital cousins of a video; `urbanverse gen batch`: of many."""

import dataclasses
import json
import pathlib
from collections.abc import Sequence
from typing import Annotated, Literal

import tyro

from .. import pipeline


@dataclasses.dataclass(frozen=True)
class GenArgs:
    """Make compiled digital cousins of a video; continues an earlier run; prints one JSON line."""

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
    """Render images of the cousins for the report."""
    workers: int | None = None
    """Processes that compile; default: the cores this process may use."""
    rate: float = 2.0
    """Frames taken of a video per second; of a folder's images, how many were taken in a second."""
    camera_height: float = 1.5
    """Height (m) of the camera above the ground that is walked on: it gives the scale of a video."""
    blur: str | None = None
    """Detector of faces and number plates, which are blurred before a frame is stored: "haar", or "module:function" of
    your own; none: frames stay here."""
    perception: Literal["eye", "foundation"] = "eye"
    """Perception model: "eye", the built-in network, or "foundation": OWLv2, SAM 2, Mask2Former and a depth model."""
    models: pathlib.Path | None = None
    """Folder of the foundation models' weights (owlv2, sam2, mask2former, depth); default: from the hub."""
    licence: str = "unknown"
    """Of the video, for the records; as city and country."""
    city: str = "unknown"
    country: str = "unknown"
    quiet: bool = False


@dataclasses.dataclass(frozen=True)
class ImportArgs:
    """Turn another project's recording into one of ours, for `urbanverse gen`; prints one JSON line."""

    source: Annotated[pathlib.Path, tyro.conf.Positional]
    """KITTI-360's root, or a folder that UrbanVerse-Gen's authors' distillation wrote."""
    out: pathlib.Path
    """Folder of the recording."""
    format: Literal["kitti360", "urbanverse"]
    """Of the source."""
    sequence: str = "2013_05_28_drive_0000_sync"
    """KITTI-360: which drive."""
    first: int = 0
    """KITTI-360: first frame; last: last frame; step: every so many frames."""
    last: int = 10_000_000
    step: int = 1
    depth: Literal["auto", "scan", "boxes"] = "auto"
    """KITTI-360: from the laser's scans, or from the annotated boxes and the road."""
    rate: float = 1.0
    """urbanverse: frames per second."""
    perception: Literal["eye", "foundation"] = "eye"
    """urbanverse: perception model, see `urbanverse gen`."""
    models: pathlib.Path | None = None
    """urbanverse: folder of the foundation models' weights."""
    quiet: bool = False


@dataclasses.dataclass(frozen=True)
class BatchArgs:
    """Make cousins of many sources; a source that fails never stops the rest; prints one JSON line.

    Exit status 1 where any source failed finally.
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
    """Render images of the cousins for the reports."""
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
    if words[:1] == ["import"]:
        return _import(tyro.cli(ImportArgs, args=words[1:], prog="urbanverse gen import"))
    return _gen(tyro.cli(GenArgs, args=words, prog="urbanverse gen"))


def _gen(args: GenArgs) -> int:
    video = pipeline.VideoOptions(
        args.rate,
        args.camera_height,
        args.blur,
        args.licence,
        args.city,
        args.country,
        args.perception,
        None if args.models is None else str(args.models),
    )
    options = pipeline.GenerationOptions(
        args.cousins, args.seed, args.kerb, args.usd, args.pictures, args.workers, video
    )
    print(json.dumps(pipeline.generate(args.source, args.out, options, args.quiet)))
    return 0


def _import(args: ImportArgs) -> int:
    from ..distillation.readers import Kitti360Options
    from ..progress import Progress

    with Progress(args.quiet) as progress:
        report = progress.task("recording")
        if args.format == "kitti360":
            options = Kitti360Options(args.sequence, args.first, args.last, args.step, args.depth)
            recording = pipeline.import_kitti360(args.source, args.out, options, report)
        else:
            models = None if args.models is None else str(args.models)
            video = pipeline.VideoOptions(rate=args.rate, perception=args.perception, models=models)
            recording = pipeline.import_authors_tree(args.source, args.out, video, report)
    print(json.dumps({"recording": str(args.out), "id": recording.id, "frames": len(recording)}))
    return 0


def _batch(args: BatchArgs) -> int:
    # A source's own cousins are compiled one after another: the sources share the cores.
    video = pipeline.VideoOptions(args.rate, args.camera_height, args.blur)
    options = pipeline.GenerationOptions(
        args.cousins, args.seed, usd=args.usd, pictures=args.pictures, workers=1, video=video
    )
    done = pipeline.run_batch(args.sources, args.out, options, args.executor, args.workers, args.retries, args.quiet)
    print(json.dumps(done))
    return 1 if done["failed"] else 0
