"""How faithful the graphs are that are distilled from recordings: the paper's table on streets whose truth is known.

    python -m benchmarks.fidelity --banks bank16.npz --scenes 10 --frames 180 --json

films tours through the streets of banks (default: the six shipped ones), distils each and scores the graph against the
true one. Alignment: SE(3) on the trajectory, no scale. Matching: Hungarian on the distance of centres, 5 m gate,
whatever the label. Columns, over matches: Cat, share of right labels; Dist, m between centres; Ori, degrees between
headings modulo half a turn (depth and masks do not tell front from back; front_percent says how often the sign is
right, too), of things whose footprint has a heading; Scale, m^3 between volumes, and mAP25 (mean over labels of the
average precision at a 3D IoU of 0.25), of things under 50 m^3. The paper's Ast is not measured. Recall and precision
over things. A true thing counts as seen where it covers 0.15 % of some frame; finding one that was hardly seen is
neither right nor wrong.

Rows: perfect inputs; the protocol's errors (`_injection`), each thing from its view of median size alone and fused;
and one row for every folder given with --recordings (a perception's recordings of the same tours:
NAME/<scene>/recording.json). Tracks are never used.
`--scaling` times 10 to 720 frames of one tour instead.
"""

import argparse
import dataclasses
import functools
import json
import pathlib
import sys
import tempfile
import time
from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks import _fidelity_scores as scores
from benchmarks._injection import inject
from urbanverse_mjx.assets.index import load_index
from urbanverse_mjx.assets.label_priors import LabelPriors
from urbanverse_mjx.capture import PathOptions, TourOptions, tour
from urbanverse_mjx.capture.truth import object_id, object_slots
from urbanverse_mjx.cli.scene import ensure_default_bank
from urbanverse_mjx.datatypes import NounError, Recording, SceneBank, SceneGraph
from urbanverse_mjx.distillation import DistilOptions, distil

#: The paper's table (45 sequences of KITTI-360, MASt3R and YoWorldSAM2); other streets, shown without a claim.
PAPER = {"cat_percent": 93.1, "dist_m": 1.4, "ori_deg": 19.8, "scale_m3": 0.8, "map25": 28.2}
SINGLE = DistilOptions(single_view=True, depth_scale=False, close_loops=False, place=False)
SCALING = (10, 40, 80, 180, 720)
_COLUMNS = ("cat_percent", "dist_m", "ori_deg", "scale_m3", "map25", "recall_percent", "precision_percent")


@dataclasses.dataclass(frozen=True)
class Tour:
    """A filmed street: its perfect recording, the true things seen and hardly seen, and which have a heading."""

    recording: Recording
    seen: list
    unseen: list
    turnable: dict[str, bool]


def film(bank: SceneBank, scene: int, folder: pathlib.Path, frames: int, size: tuple[int, int]) -> Tour:
    """One tour; a folder that holds it already is read."""
    folder = folder / bank.scene_ids[scene]
    if (folder / "recording.json").is_file() and len(Recording.load(folder)) == frames:
        recording = Recording.load(folder)
    else:
        options = TourOptions(width=size[0], height=size[1], rgb=False)
        recording = tour(bank, scene, folder, PathOptions(frames=frames), options)
    truth = SceneGraph.load(folder / "truth.json").objects
    seen = scores.seen_things(recording, truth)
    ids = {t.id for t in seen}
    turnable = {}
    for slot in object_slots(bank, scene):
        mesh = bank.slot_mesh[scene, slot]
        corners = bank.mesh_vertices[bank.mesh_vertex_start[mesh] : bank.mesh_vertex_start[mesh + 1], :2]
        turnable[object_id(bank, scene, slot)] = scores.is_turnable(corners)
    return Tour(recording, seen, [t for t in truth if t.id not in ids], turnable)


def without_tracks(recording: Recording) -> Recording:
    """The recording as a detector without a tracker would give it."""
    frames = tuple(
        dataclasses.replace(f, detections=tuple(dataclasses.replace(d, track=None) for d in f.detections))
        for f in recording.frames
    )
    return dataclasses.replace(recording, frames=frames)


def judge(given: Recording, filmed: Tour, priors: LabelPriors, options: DistilOptions) -> tuple[scores.Scores, dict]:
    """Distils a recording of a tour and scores it; figures of the trajectory beside."""
    begin = time.perf_counter()
    made = distil(without_tracks(given), priors, options=options)
    seconds = time.perf_counter() - begin
    times = {f.time_s: f.pose for f in filmed.recording.frames}
    pairs = [(made.poses[i], times.get(given.frames[n].time_s)) for i, n in enumerate(given.registered)]
    kept = [(a, b) for a, b in pairs if b is not None]
    if len(kept) < 2:
        raise NounError(f"recording {given.id!r}: found {len(kept)} registered frames of the tour, needed at least 2.")
    found, true = (np.array(p) for p in zip(*kept, strict=True))
    T = scores.alignment(found, true)
    error = np.linalg.norm((T @ found)[:, :3, 3] - true[:, :3, 3], axis=1)
    result = scores.score(scores.moved(made.graph.objects, T), filmed.seen, filmed.unseen, filmed.turnable)
    figures = {
        "seconds": seconds,
        "registered": len(given.registered) / len(given),
        "trajectory_m": float(error.mean()),
    }
    return result, figures


def rows(tours: Sequence[Tour], priors: LabelPriors, others: Sequence[pathlib.Path], seed: int) -> list[dict[str, Any]]:
    """The table."""
    plans: list[tuple[str, DistilOptions, Any]] = [
        ("perfect inputs", DistilOptions(), lambda t, _: t.recording),
        ("injected errors, single view", SINGLE, _noisy(seed)),
        ("injected errors, fused", DistilOptions(), _noisy(seed)),
    ]
    for folder in others:
        plans.append((folder.name, DistilOptions(), functools.partial(_given, folder)))
    table = []
    for name, options, recording_of in plans:
        judged = []
        for filmed in tours:
            with tempfile.TemporaryDirectory(prefix="urbanverse-fidelity-") as work:
                judged.append(judge(recording_of(filmed, pathlib.Path(work)), filmed, priors, options))
            print(f"{name}: {filmed.recording.id} {judged[-1][1]['seconds']:.1f} s", file=sys.stderr)
        figures = {k: round(float(np.mean([f[k] for _, f in judged])), 3) for k in judged[0][1]}
        table.append({"row": name, **scores.table_row([s for s, _ in judged]), **figures})
    return table


def _given(folder: pathlib.Path, filmed: Tour, _: pathlib.Path) -> Recording:
    return Recording.load(folder / filmed.recording.id)


def _noisy(seed: int) -> Any:
    return lambda t, work: inject(t.recording, work, seed + sum(map(ord, t.recording.id)))


def scaling(filmed: Tour, priors: LabelPriors) -> list[dict[str, float]]:
    """Seconds to distil the first n frames of a tour; processor time hardly counts other work on the machine."""
    table = []
    for frames in SCALING:
        if frames > len(filmed.recording):
            continue
        part = dataclasses.replace(without_tracks(filmed.recording), frames=filmed.recording.frames[:frames])
        wall, processor = time.perf_counter(), time.process_time()
        made = distil(part, priors)
        took = time.process_time() - processor
        table.append(
            {
                "frames": frames,
                "views": made.views,
                "objects": len(made.graph.objects),
                "processor_s": round(took, 2),
                "wall_s": round(time.perf_counter() - wall, 2),
                "ms_per_frame": round(1000 * took / frames, 1),
            }
        )
    return table


def parse(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fidelity", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--banks", type=pathlib.Path, nargs="*", default=[], help="banks; default: the shipped streets")
    parser.add_argument("--shipped", action="store_true", help="the shipped streets beside --banks")
    parser.add_argument("--scenes", type=int, default=10, help="at most so many streets of each bank")
    parser.add_argument("--frames", type=int, default=180, help="of each tour, one a second")
    parser.add_argument("--size", type=int, nargs=2, default=(384, 216), metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--tours", type=pathlib.Path, help="keeps the filmed tours, and reads those that are there")
    parser.add_argument("--recordings", type=pathlib.Path, nargs="*", default=[], help="more rows, see above")
    parser.add_argument("--seed", type=int, default=0, help="of the injected errors")
    parser.add_argument("--scaling", action="store_true", help="time 10 to 720 frames of the first street")
    parser.add_argument("--json", action="store_true", help="print one JSON line instead of a table")
    return parser.parse_args(argv)


def main(argv: list[str] | None = None) -> int:
    arguments = parse(argv)
    try:
        banks = [SceneBank.load(path) for path in arguments.banks]
        if arguments.shipped or not banks:
            banks.insert(0, ensure_default_bank(quiet=True))
        priors = LabelPriors(load_index())
        with tempfile.TemporaryDirectory(prefix="urbanverse-tours-") as work:
            folder = arguments.tours or pathlib.Path(work)
            frames = max(SCALING) if arguments.scaling else arguments.frames
            places = [(b, z) for b in banks for z in range(min(b.num_scenes, arguments.scenes))]
            if arguments.scaling:
                places = places[:1]
            tours = [film(b, z, folder, frames, tuple(arguments.size)) for b, z in places]
            if arguments.scaling:
                result: dict[str, Any] = {"scaling": scaling(tours[0], priors), "scene": tours[0].recording.id}
            else:
                table = rows(tours, priors, arguments.recordings, arguments.seed)
                names = [t.recording.id for t in tours]
                result = {"rows": table, "paper": PAPER, "scenes": names, "frames": frames}
    except NounError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    print(json.dumps(result) if arguments.json else _text(result))
    return 0


def _text(result: dict[str, Any]) -> str:
    if "scaling" in result:
        return "\n".join(", ".join(f"{k} {v}" for k, v in row.items()) for row in result["scaling"])
    lines = [f"{'':32}" + "".join(f"{name:>16}" for name in _COLUMNS)]
    for row in [*result["rows"], {"row": "the paper, on KITTI-360", **result["paper"]}]:
        cells = ["-" if row.get(c) is None else f"{row[c]}" for c in _COLUMNS]
        lines.append(f"{row['row']:32}" + "".join(f"{c:>16}" for c in cells))
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
