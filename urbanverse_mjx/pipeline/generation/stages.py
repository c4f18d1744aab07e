"""The stages of a run, in order, each resumable: frames, recording, graph, cousins, scenes, bank, report."""

import dataclasses
import json
import os
import pathlib
import shutil
from typing import Any

from ... import settings
from ...datatypes import Recording, SceneGraph
from ...datatypes import validation as v
from ...process_pool import results_as_completed
from ...progress import Progress
from ...work_folder import work_folder
from . import compiling
from .checks import check_cousins, check_graph, check_ground, leave_out_implausible
from .embeddings import check_packages, load_embeddings
from .run_folder import Clock, RunFolder, key_of
from .sources import Input, recognise
from .video_options import VideoOptions

FRAMES, RECORDING, GRAPH, COUSINS, REPORT = "frames", "recording", "graph", "cousins", "report"
MATERIALISATION, BANK = "materialisation.json", "bank.npz"


@dataclasses.dataclass(frozen=True)
class GenerationOptions:
    """Options of a run.

    Attributes:
      cousins: number of cousins, 1 to 64.
      seed: seed of the choice among equal fits.
      kerb: m, height of sidewalks whose step to the road the source does not show.
      usd: whether to write each scene as USD too.
      pictures: whether the report has rendered images.
      workers: number of compiling processes; None for one per core.
      retrieval: how assets are chosen: "built-in", by words and descriptors, or "neural", by CLIP and DINOv2.
      video: metadata of a video or folder of frames, and options of its perception.
    """

    cousins: int = 5
    seed: int = 0
    kerb: float = 0.15
    usd: bool = True
    pictures: bool = True
    workers: int | None = None
    video: VideoOptions = dataclasses.field(default_factory=VideoOptions)
    retrieval: str = "built-in"


def check_options(options: GenerationOptions) -> None:
    """Refuses numbers that no run can have, before anything is written.

    Raises:
      ValidationError: one is out of its range.
    """
    v.integer(options.cousins, "--cousins", 1, 64)
    v.integer(options.seed, "--seed", 0)
    v.number(options.kerb, "--kerb", 0.0, 1.0)
    v.number(options.video.rate, "--rate", above=0.0, maximum=1000.0)
    v.number(options.video.camera_height, "--camera-height", above=0.0, maximum=1000.0)
    if options.workers is not None:
        v.integer(options.workers, "--workers", 1, 1024)


def generate(
    source: str | os.PathLike[str],
    out: str | os.PathLike[str],
    options: GenerationOptions | None = None,
    quiet: bool = True,
) -> dict[str, Any]:
    """Makes compiled cousins of a source in a folder, or continues an earlier run in it.

    Args:
      source: graph.json, a recording's folder, a folder of frames, a video, or a photograph.
      out: the run's folder: `frames/`, `recording/`, `graph/`, `cousins/<k>/{layout.json, scene/, usd/, check.json}`,
        `bank.npz`, `report.html`, `run.json`.

    Returns:
      id, folder, number of objects in the graph and in each cousin, seconds by stage.

    Raises:
      ValidationError: the source or the folder is invalid; no partly written file is left.
    """
    options = options or GenerationOptions()
    check_options(options)
    check_packages(options.retrieval)
    if options.video.second_opinion is not None:
        from .predictors import make_predictor

        make_predictor(options.video)  # missing weights are said before frames are taken
    given = recognise(os.fspath(source))
    with RunFolder.open(out, str(given.path)) as run, Progress(quiet) as progress:
        recording, key = _recording(run, progress, options.video, given)
        graph_key = _graph(run, progress, given, recording, key)
        cousins_key = _cousins(run, progress, options, graph_key)
        scenes_key = _scenes(run, progress, options, cousins_key)
        bank_key = _bank(run, progress, options, scenes_key)
        _report(run, progress, options, given, recording, bank_key)
        return _summary(run, options)


def _recording(
    run: RunFolder, progress: Progress, video: VideoOptions, given: Input
) -> tuple[pathlib.Path | None, str]:
    """Stages `frames/` and `recording/`; returns the folder of the recording (None for a graph), and its key."""
    if given.kind in ("graph", "recording"):
        return (given.path if given.kind == "recording" else None), given.key
    key = key_of(
        "perception",
        stage="frames",
        kind=given.kind,
        source=given.key,
        rate=video.rate,
        blur=video.blur,
        allow_truncated=video.allow_truncated,
    )
    report = progress.task("frames")
    if not run.done(FRAMES, key, FRAMES):
        from .perceiving import photograph_to, sample_to

        clock = Clock()
        with run.replacing(FRAMES) as folder:
            if given.kind == "photograph":
                photograph_to(given.path, folder, video)
            else:
                sample_to(given.path, folder, video, report)
        run.finish(FRAMES, key, clock.seconds, **clock.resources)
    report(1, 1)
    key = key_of("perception", stage="recording", before=key, tour=dataclasses.asdict(video))
    report = progress.task("recording")
    if not run.done(RECORDING, key, f"{RECORDING}/recording.json"):
        from .perceiving import perceive_photograph_to, perceive_to

        clock = Clock()
        with run.replacing(RECORDING) as folder:
            if given.kind == "photograph":
                perceive_photograph_to(run.path / FRAMES, folder, given.path, video)
            else:
                perceive_to(run.path / FRAMES, folder, given.path, video, report)
        run.finish(RECORDING, key, clock.seconds, **clock.resources)
    report(1, 1)
    return run.path / RECORDING, key


def _graph(run: RunFolder, progress: Progress, given: Input, recording: pathlib.Path | None, before: str) -> str:
    """Stage `graph/`: graph.json, and for a recording its evidence and crops."""
    key = key_of("distillation", stage="graph", kind=given.kind, source=before, assets=settings.assets_digest())
    report = progress.task("graph")
    if not run.done(GRAPH, key, f"{GRAPH}/graph.json"):
        clock = Clock()
        with run.replacing(GRAPH) as folder:
            if recording is None:
                check_graph(SceneGraph.load(given.path))
                shutil.copyfile(given.path, folder / "graph.json")
            else:
                from .distilling import distil_to

                graph = distil_to(Recording.load(recording), folder, report)
                check_ground(graph)
                leave_out_implausible(folder, graph)
        run.finish(GRAPH, key, clock.seconds, **clock.resources)
    report(1, 1)
    return key


def _cousins(run: RunFolder, progress: Progress, options: GenerationOptions, before: str) -> str:
    """Stage of `cousins/<k>/layout.json` and `materialisation.json`."""
    wanted: dict[str, Any] = {"cousins": options.cousins, "seed": options.seed, "kerb": options.kerb}
    if options.retrieval != "built-in":
        wanted |= {"retrieval": options.retrieval, "models": options.video.models}
    key = key_of("cousins", stage="cousins", before=before, assets=settings.assets_digest(), **wanted)
    report = progress.task("cousins", options.cousins)
    folders = [f"{COUSINS}/{k}/{compiling.LAYOUT}" for k in range(options.cousins)]
    if not run.done(COUSINS, key, MATERIALISATION, *folders):
        from ...materialisation import index_of, materialise_cousins
        from .records import record_of

        clock = Clock()
        graph = SceneGraph.load(run.path / GRAPH / "graph.json")
        crops = run.path / GRAPH / "crops" / "objects"
        embeddings = load_embeddings(options.retrieval, options.video.models, graph, crops)
        made = materialise_cousins(graph, options.cousins, options.seed, options.kerb, embeddings=embeddings)
        check_cousins(graph, made)
        with run.replacing(COUSINS, f"*/{compiling.CHECK}") as folder:
            for k, cousin in enumerate(made):
                (folder / str(k)).mkdir()
                compiling.save_layout(folder / str(k), cousin.layout, index_of(cousin.layout))
                report(k + 1, options.cousins)
        v.write_json(run.path / MATERIALISATION, record_of(graph, made))
        run.finish(COUSINS, key, clock.seconds, **clock.resources)
    report(options.cousins, options.cousins)
    return key


def _scenes(run: RunFolder, progress: Progress, options: GenerationOptions, before: str) -> str:
    """Stages of `cousins/<k>/scene/`, `usd/` and `check.json`; each cousin is a stage, compiled in parallel
    processes."""
    key = key_of("scenes", stage="scenes", before=before, usd=options.usd)
    report = progress.task("scenes", options.cousins)
    clock = Clock()
    missing = [
        k
        for k in range(options.cousins)
        if not run.done(f"scenes/{k}", key, f"{COUSINS}/{k}/{compiling.SCENE}", f"{COUSINS}/{k}/{compiling.CHECK}")
    ]
    report(options.cousins - len(missing), options.cousins)
    if missing:
        _compile_all(run, missing, options, key, report)
        run.finish("scenes", key, clock.seconds)
    return key


def _compile_all(run: RunFolder, missing: list[int], options: GenerationOptions, key: str, report: Any) -> None:
    tasks = [(run.path / COUSINS / str(k), options.usd) for k in missing]
    checks = results_as_completed(compiling.compile_cousin, tasks, options.workers or settings.num_threads())
    for number, (task, check) in enumerate(checks, 1):
        taken = {name: check[name] for name in ("processor_s", "memory_mb") if name in check}
        run.finish(f"scenes/{missing[task]}", key, check["seconds"], **taken)
        report(options.cousins - len(missing) + number, options.cousins)


def _bank(run: RunFolder, progress: Progress, options: GenerationOptions, before: str) -> str:
    """Stage of `bank.npz` with all cousins for `urbanverse evaluate` and `train`."""
    key = key_of("bank", stage="bank", before=before)
    report = progress.task("bank")
    if not run.done("bank", key, BANK):
        from ...scene import pack_bank

        clock = Clock()
        folders = [run.path / COUSINS / str(k) / compiling.SCENE for k in range(options.cousins)]
        pack_bank(folders, ["test"] * len(folders)).save(run.path / BANK)
        run.finish("bank", key, clock.seconds, **clock.resources)
    report(1, 1)
    return key


def _report(
    run: RunFolder,
    progress: Progress,
    options: GenerationOptions,
    given: Input,
    recording: pathlib.Path | None,
    before: str,
) -> None:
    """Stage of `report.html`."""
    key = key_of("report", stage="report", before=before, pictures=options.pictures)
    report = progress.task("report")
    if not run.done(REPORT, key, "report.html"):
        from .report import write_report

        clock = Clock()
        with work_folder("urbanverse-report-") as scratch:
            html = write_report(run.path, scratch, given, recording, options.pictures, run.seconds, report)
        # Reports were once a page with a folder of images.
        shutil.rmtree(run.path / REPORT, ignore_errors=True)
        v.write_atomically(run.path / "report.html", lambda p: p.write_text(html, encoding="utf-8"))
        run.finish(REPORT, key, clock.seconds, **clock.resources)
    report(1, 1)


def _summary(run: RunFolder, options: GenerationOptions) -> dict[str, Any]:
    record = json.loads((run.path / MATERIALISATION).read_text(encoding="utf-8"))
    checks = [
        json.loads((run.path / COUSINS / str(k) / compiling.CHECK).read_text(encoding="utf-8"))
        for k in range(options.cousins)
    ]
    return {
        "id": record["graph"]["id"],
        "folder": str(run.path),
        "nodes": record["graph"]["objects"],
        "placed": [c["objects"] for c in checks],
        "left_out": [len(c["left_out"]) for c in record["cousins"]],
        "kept_fixed": [len(c["kept_fixed"]) for c in checks],
        "seconds": {name: s for name, s in run.seconds.items() if "/" not in name},
        "report": str(run.path / "report.html"),
    }
