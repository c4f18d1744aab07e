"""Measures the fidelity of graphs distilled from recordings: the paper's table on streets with known ground truth.

    python -m benchmarks.fidelity --banks bank16.npz --scenes 10 --frames 180 --markdown fidelity.md --json

renders captures through the streets of banks (default: the six shipped ones), distils each and scores the graph against
the true one. Alignment: SE(3) on the trajectory, no scale. Matching: Hungarian on the distance of centres, 5 m gate,
independent of labels. Columns, over matches: Cat, share of right labels; Dist, m between centres; Ori, degrees between
headings modulo half a turn (depth and masks do not distinguish front and back; front_percent is the share with the
correct sign), of objects whose footprint has a heading; Scale, m^3 between volumes, and mAP25 (mean over labels of the
average precision at a 3D IoU of 0.25), of objects under 50 m^3; height_percent and side_percent, median difference of
the height and of the footprint's longer side of those with the right label; Ast, share of matches whose chosen base
shape is the filmed one (`lib.fidelity_captures.retrieved`), if the graph has descriptors. Recall and precision are
over objects. A true object counts as visible if it covers 0.15 % of some frame; a detection of a less visible one
counts as neither right nor wrong.

Rows: perfect inputs; the protocol's errors (`lib.injection`), each object from its view of median size alone and
fused; with --rgb, from captures with images: perfect inputs with Ast, the small network on true poses and depth, and
all from the RGB alone; and one row for every folder given with --recordings (a perception's recordings of the same
captures: NAME/<scene>/recording.json). --perceived keeps the recordings that the perception model makes of the
captures with images, so that a change of the distillation alone is measured without it. --kitti360 takes recordings
that `urbanverse gen import` made, with their boxes as ground truth. Tracks are never used. One process films and
scores one street, with images or without; a row that fails on a street is reported and missing there. --results keeps
the scores, and a second call continues with the rest: empty it when the code changes. `--scaling` measures instead the
time for the first 10, 40, 80, 180 and 720 frames of one capture, or the given numbers, from the recording to five
compiled cousins (`lib.fidelity_scaling`).
"""

import argparse
import concurrent.futures
import dataclasses
import functools
import json
import multiprocessing
import os
import pathlib
import resource
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from benchmarks.lib import fidelity_scaling, fidelity_store, tables
from benchmarks.lib import fidelity_scores as scores
from benchmarks.lib.fidelity_captures import (
    RECORDED,
    Capture,
    film,
    from_images,
    imported,
    retrieved,
    seen_by_the_model,
)
from benchmarks.lib.injection import inject
from urbanverse_mjx import settings
from urbanverse_mjx.assets.records.index import load_index
from urbanverse_mjx.assets.selection.label_priors import LabelPriors
from urbanverse_mjx.datatypes import Recording, SceneBank, ValidationError
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.datatypes.recording import FILE
from urbanverse_mjx.distillation import Describe, DistilOptions, distil
from urbanverse_mjx.pipeline import ensure_default_bank
from urbanverse_mjx.pipeline.generation.distilling import DESCRIBE
from urbanverse_mjx.process_pool import worker_pool
from urbanverse_mjx.work_folder import replacing_folder, work_folder

#: The paper's table (45 sequences of KITTI-360, MASt3R and YoWorldSAM2); its streets differ, so it is shown for
#: orientation only.
PAPER = {"cat_percent": 93.1, "dist_m": 1.4, "ori_deg": 19.8, "scale_m3": 0.8, "map25": 28.2, "ast_percent": 75.1}
SINGLE = DistilOptions(single_view=True, depth_scale=False, close_loops=False, place=False)
_COLUMNS = (
    *("cat_percent", "dist_m", "ori_deg", "front_percent", "scale_m3", "height_percent", "side_percent", "map25"),
    *("ast_percent", "recall_percent", "precision_percent", "trajectory_m", "registered", "streets"),
)


def without_tracks(recording: Recording) -> Recording:
    """Returns the recording without tracks, like the output of a detector without a tracker."""
    frames = tuple(
        dataclasses.replace(f, detections=tuple(dataclasses.replace(d, track=None) for d in f.detections))
        for f in recording.frames
    )
    return dataclasses.replace(recording, frames=frames)


def judge(
    given: Recording, filmed: Capture, priors: LabelPriors, options: DistilOptions, describe: Describe | None = None
) -> tuple[scores.Scores, dict[str, float]]:
    """Distils a recording of a capture and scores it, with figures of the trajectory, and Ast where it has
    descriptors."""
    begin = time.process_time()
    made = distil(without_tracks(given), priors, describe=describe, options=options)
    figures = {"processor_s": time.process_time() - begin, "registered": len(given.registered) / len(given)}
    times = {f.time_s: f.pose for f in filmed.recording.frames}
    pairs = [(made.poses[i], times.get(given.frames[n].time_s)) for i, n in enumerate(given.registered)]
    kept = [(a, b) for a, b in pairs if b is not None]
    if len(kept) < 2:
        raise ValidationError(
            f"recording {given.id!r}: found {len(kept)} registered frames of the capture, needed at least 2."
        )
    found, true = (np.array(p) for p in zip(*kept, strict=True))
    T = scores.alignment(found, true)
    error = np.linalg.norm((T @ found)[:, :3, 3] - true[:, :3, 3], axis=1)
    figures["trajectory_m"] = float(error.mean())
    result = scores.score(scores.moved(made.graph.objects, T), filmed.seen, filmed.unseen, filmed.turnable)
    if describe is not None:
        right = retrieved(filmed, made.graph, result.pairs)
        if right is not None and len(right):
            figures["ast_percent"] = 100.0 * float(right.mean())
    return result, figures


@dataclasses.dataclass(frozen=True)
class Plan:
    """One row: its name, how objects are distilled, what makes a recording of a capture in an empty folder, and, where
    Ast is measured, descriptors of appearance."""

    row: str
    options: DistilOptions
    recording_of: Callable[[Capture, pathlib.Path], Recording]
    describe: Describe | None = None


@dataclasses.dataclass(frozen=True)
class Street:
    """One street's work, whole in one process: bank file and row, or an imported recording; which rows it has.

    captures: folder of the films. frames, size: of the capture. rgb: whether it is filmed with images, for the rows
    that use them. others: folders of recordings of the same captures. seed: of the errors. results: folder of scores.
    perceived: folder of recordings that the perception model made; None to make them anew.
    """

    bank: pathlib.Path | None
    scene: int
    recording: pathlib.Path | None
    captures: pathlib.Path
    frames: int
    size: tuple[int, int]
    rgb: bool
    others: tuple[pathlib.Path, ...]
    seed: int
    results: pathlib.Path
    perceived: pathlib.Path | None = None

    def plans(self) -> list[Plan]:
        """Its rows."""
        perfect = Plan("perfect inputs", DistilOptions(), lambda t, _: t.recording)
        if self.recording is not None:
            return [perfect]
        if self.rgb:
            return [
                dataclasses.replace(perfect, row="perfect inputs, with images", describe=DESCRIBE),
                Plan(
                    "the small network, true poses and depth",
                    DistilOptions(),
                    _kept(self.perceived, "true_poses", seen_by_the_model),
                ),
                Plan("RGB alone", DistilOptions(), _kept(self.perceived, "rgb_alone", from_images)),
            ]
        return [
            perfect,
            Plan("injected errors, single view", SINGLE, _noisy(self.seed)),
            Plan("injected errors, fused", DistilOptions(), _noisy(self.seed)),
            *(Plan(f.name, DistilOptions(), functools.partial(_given, f)) for f in self.others),
        ]


@dataclasses.dataclass(frozen=True)
class Work:
    """Results of a street: name, scores by row, failure reasons by row, peak memory in MB."""

    name: str
    rows: dict[str, fidelity_store.Row]
    failed: dict[str, str]
    peak_mb: int


def street_rows(street: Street) -> Work:
    """Renders a capture of a street, or reuses an earlier one, and scores the rows without scores."""
    priors = LabelPriors(load_index())
    if street.recording is not None:
        filmed = imported(street.recording)
    else:
        assert street.bank is not None
        filmed = film(
            SceneBank.load(street.bank), street.scene, street.captures, street.frames, street.size, street.rgb
        )
    kind = "rgb" if street.rgb else "depth"
    file = street.results / f"{filmed.scene}-{kind}-{street.frames}-{street.seed}.json"
    rows, failed = fidelity_store.load(file), {}
    for plan in street.plans():
        if plan.row in rows:
            continue
        with work_folder("urbanverse-fidelity-") as work:
            try:
                given = plan.recording_of(filmed, pathlib.Path(work))
                rows[plan.row] = judge(given, filmed, priors, plan.options, plan.describe)
            except ValidationError as error:
                failed[plan.row] = str(error)
        fidelity_store.save(file, rows)
    return Work(filmed.scene, rows, failed, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024)


def table_of(streets: Sequence[dict[str, fidelity_store.Row]]) -> list[dict[str, Any]]:
    """The rows over all streets that have them."""
    table = []
    for row in dict.fromkeys(name for street in streets for name in street):
        judged = [street[row] for street in streets if row in street]
        keys = dict.fromkeys(k for _, f in judged for k in f)
        figures = {k: round(float(np.mean([f[k] for _, f in judged if k in f])), 3) for k in keys}
        table.append({"row": row, "streets": len(judged), **scores.table_row([s for s, _ in judged]), **figures})
    return table


def _given(folder: pathlib.Path, filmed: Capture, _: pathlib.Path) -> Recording:
    return Recording.load(folder / filmed.recording.id)


def _kept(
    kept: pathlib.Path | None, row: str, make: Callable[[Capture, pathlib.Path], Recording]
) -> Callable[[Capture, pathlib.Path], Recording]:
    """Makes the recording in KEPT/<row>/<scene>/recording unless it is there."""
    if kept is None:
        return make

    def read(filmed: Capture, _: pathlib.Path) -> Recording:
        folder = kept / row / filmed.scene
        if not (folder / RECORDED / FILE).is_file():
            with replacing_folder(folder) as fresh:
                make(filmed, fresh)
        return Recording.load(folder / RECORDED)

    return read


def _noisy(seed: int) -> Callable[[Capture, pathlib.Path], Recording]:
    return lambda t, work: inject(t.recording, work, seed + sum(map(ord, t.recording.id)))


def parse(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fidelity", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--banks", type=pathlib.Path, nargs="*", default=[], help="banks; default: the shipped streets")
    parser.add_argument("--shipped", action="store_true", help="the shipped streets beside --banks")
    parser.add_argument("--scenes", type=int, default=10, help="at most so many streets of each bank")
    parser.add_argument("--frames", type=int, default=180, help="of each capture, one a second")
    parser.add_argument("--size", type=int, nargs=2, default=(384, 216), metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--rgb", type=int, default=0, help="so many streets of each bank are filmed with images, too")
    parser.add_argument("--rgb-frames", type=int, default=120, help="of these captures, two a second")
    parser.add_argument("--rgb-size", type=int, nargs=2, default=(480, 270), metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--kitti360", type=pathlib.Path, nargs="*", default=[], help="recordings that were imported")
    parser.add_argument(
        "--captures", "--tours", type=pathlib.Path, help="keeps the captures, and reads those that are there"
    )
    parser.add_argument("--recordings", type=pathlib.Path, nargs="*", default=[], help="more rows, see above")
    parser.add_argument("--perceived", type=pathlib.Path, help="keeps the perception model's recordings, see above")
    parser.add_argument("--seed", type=int, default=0, help="of the injected errors")
    parser.add_argument("--results", type=pathlib.Path, help="keeps the scores, and goes on with those that are there")
    parser.add_argument("--processes", type=int, default=1, help="streets at a time, on the CPU")
    parser.add_argument("--threads", type=int, default=1, help="of each process")
    parser.add_argument("--scaling", type=int, nargs="*", metavar="FRAMES", help="time the first street, see above")
    parser.add_argument("--markdown", type=pathlib.Path, help="write the table there, too")
    parser.add_argument("--json", action="store_true", help="print one JSON line instead of a table")
    return parser.parse_args(argv)


def streets_of(arguments: argparse.Namespace, captures: pathlib.Path) -> list[Street]:
    """Returns the work for the given arguments."""
    paths = list(arguments.banks)
    if arguments.shipped or not (paths or arguments.kitti360):
        ensure_default_bank(quiet=True)
        paths.insert(0, settings.default_bank_path())
    common = {"captures": captures, "others": tuple(arguments.recordings), "seed": arguments.seed}
    common["results"] = arguments.results or captures / "results"
    common["perceived"] = arguments.perceived
    seen = {"frames": arguments.rgb_frames, "size": tuple(arguments.rgb_size), "rgb": True}
    felt = {"frames": arguments.frames, "size": tuple(arguments.size), "rgb": False}
    work = [Street(None, 0, path, **felt, **common) for path in arguments.kitti360]
    scenes = [(path, range(min(SceneBank.load(path).num_scenes, arguments.scenes))) for path in paths]
    # Streets with images take longest, so they come first.
    work += [Street(path, z, None, **seen, **common) for path, rows in scenes for z in rows if z < arguments.rgb]
    return work + [Street(path, z, None, **felt, **common) for path, rows in scenes for z in rows]


def main(argv: list[str] | None = None) -> int:
    arguments = parse(argv)
    try:
        with work_folder("urbanverse-capture-") as work:
            folder = arguments.captures or pathlib.Path(work)
            streets = streets_of(arguments, folder)
            result = (
                _timed(streets[0], folder, arguments.scaling)
                if arguments.scaling is not None
                else _scored(streets, arguments)
            )
    except ValidationError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    if arguments.markdown is not None:
        v.write_atomically(arguments.markdown, lambda p: p.write_text(_text(result) + "\n", encoding="utf-8"))
    print(json.dumps(result) if arguments.json else _text(result))
    return 0


def _timed(street: Street, folder: pathlib.Path, frames: Sequence[int]) -> dict[str, Any]:
    if street.bank is None:
        raise ValidationError("--scaling: found an imported recording, needed a bank to film; name one.")
    counts = tuple(frames) or fidelity_scaling.FRAMES
    most = max(*fidelity_scaling.FRAMES, *counts)
    filmed = film(SceneBank.load(street.bank), street.scene, folder, most, street.size, False)
    table = fidelity_scaling.scaling(without_tracks(filmed.recording), counts)
    return {"scaling": table, "scene": filmed.scene, "cores": settings.num_threads()}


def _scored(streets: Sequence[Street], arguments: argparse.Namespace) -> dict[str, Any]:
    done: list[dict[str, fidelity_store.Row]] = []
    failed: dict[str, dict[str, str]] = {}
    peak = 0
    for work in _worked(streets, arguments.processes, arguments.threads):
        done.append(work.rows)
        peak = max(peak, work.peak_mb)
        for row, why in work.failed.items():
            failed.setdefault(row, {})[work.name] = why
        took = ", ".join(f"{k} {f['processor_s']:.1f} s" for k, (_, f) in work.rows.items())
        print(f"{work.name}: {took}; {work.peak_mb} MB; failed: {work.failed}", file=sys.stderr, flush=True)
    frames = {"frames": arguments.frames, "rgb_frames": arguments.rgb_frames if arguments.rgb else 0}
    return {"rows": table_of(done), "paper": PAPER, "failed": failed, "peak_mb_of_a_process": peak, **frames}


def _worked(streets: Sequence[Street], processes: int, threads: int) -> Iterator[Work]:
    if processes <= 1:
        yield from map(street_rows, streets)
        return
    # Libraries of the new processes read these: on many cores each would start as many threads.
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "URBANVERSE_THREADS"):
        os.environ[name] = str(threads)
    os.environ["JAX_PLATFORMS"] = "cpu"
    taken = multiprocessing.get_context("spawn").Value("i", 0)
    with worker_pool(processes, initializer=_pin_to_cores, initargs=(taken, threads)) as pool:
        for ticket in concurrent.futures.as_completed([pool.submit(street_rows, street) for street in streets]):
            yield ticket.result()


def _pin_to_cores(taken: Any, threads: int) -> None:
    """Pins this process to separate cores, because XLA starts one thread for each visible core."""
    if hasattr(os, "sched_setaffinity"):
        cores = sorted(os.sched_getaffinity(0))
        with taken.get_lock():
            first, taken.value = taken.value, taken.value + threads
        os.sched_setaffinity(0, {cores[(first + k) % len(cores)] for k in range(threads)})


def _text(result: dict[str, Any]) -> str:
    """The result as a table in Markdown."""
    if "scaling" in result:
        rows = result["scaling"]
        return tables.markdown(list(rows[0]), [[str(x) for x in row.values()] for row in rows])
    body = []
    for row in [*result["rows"], {"row": "the paper, on KITTI-360", **result["paper"]}]:
        body.append([row["row"], *("-" if row.get(c) is None else f"{row[c]}" for c in _COLUMNS)])
    return tables.markdown(["row", *_COLUMNS], body)


if __name__ == "__main__":
    sys.exit(main())
