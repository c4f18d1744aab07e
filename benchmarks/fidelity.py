"""How faithful the graphs are that are distilled from recordings: the paper's table on streets whose truth is known.

    python -m benchmarks.fidelity --banks bank16.npz --scenes 10 --frames 180 --json

films tours through the streets of banks (default: the six shipped ones), distils each and scores the graph against the
true one. Alignment: SE(3) on the trajectory, no scale. Matching: Hungarian on the distance of centres, 5 m gate,
whatever the label. Columns, over matches: Cat, share of right labels; Dist, m between centres; Ori, degrees between
headings modulo half a turn (depth and masks do not tell front from back; front_percent says how often the sign is
right, too), of things whose footprint has a heading; Scale, m^3 between volumes, and mAP25 (mean over labels of the
average precision at a 3D IoU of 0.25), of things under 50 m^3; Ast, share of matches that get the very base shape back
that was filmed (`_fidelity_tours.retrieved`), where looks are described. Recall and precision over things. A true thing
counts as seen where it covers 0.15 % of some frame; finding one that was hardly seen is neither right nor wrong.

Rows: perfect inputs; the protocol's errors (`_injection`), each thing from its view of median size alone and fused;
with --rgb, from tours with pictures: perfect inputs with Ast, the small network on true poses and depth, and all from
the RGB alone; and one row for every folder given with --recordings (a perception's recordings of the same tours:
NAME/<scene>/recording.json). --kitti360 takes recordings that `urbanverse gen import` made, with their boxes as truth.
Tracks are never used.
`--scaling` times 10 to 720 frames of one tour instead.
"""

import argparse
import concurrent.futures
import dataclasses
import functools
import json
import multiprocessing
import pathlib
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from benchmarks import _fidelity_scores as scores
from benchmarks._fidelity_tours import Tour, film, from_pictures, imported, retrieved, seen_by_the_eye
from benchmarks._injection import inject
from urbanverse_mjx import settings
from urbanverse_mjx.assets.index import load_index
from urbanverse_mjx.assets.label_priors import LabelPriors
from urbanverse_mjx.cli.generation.distilling import DESCRIBE
from urbanverse_mjx.cli.scene import ensure_default_bank
from urbanverse_mjx.datatypes import NounError, Recording, SceneBank
from urbanverse_mjx.distillation import Describe, DistilOptions, distil

#: The paper's table (45 sequences of KITTI-360, MASt3R and YoWorldSAM2); other streets, shown without a claim.
PAPER = {"cat_percent": 93.1, "dist_m": 1.4, "ori_deg": 19.8, "scale_m3": 0.8, "map25": 28.2, "ast_percent": 75.1}
SINGLE = DistilOptions(single_view=True, depth_scale=False, close_loops=False, place=False)
SCALING = (10, 40, 80, 180, 720)
_COLUMNS = (
    *("cat_percent", "dist_m", "ori_deg", "scale_m3", "map25", "ast_percent", "recall_percent", "precision_percent"),
    *("trajectory_m", "registered"),
)


def without_tracks(recording: Recording) -> Recording:
    """The recording as a detector without a tracker would give it."""
    frames = tuple(
        dataclasses.replace(f, detections=tuple(dataclasses.replace(d, track=None) for d in f.detections))
        for f in recording.frames
    )
    return dataclasses.replace(recording, frames=frames)


def judge(
    given: Recording, filmed: Tour, priors: LabelPriors, options: DistilOptions, describe: Describe | None = None
) -> tuple[scores.Scores, dict[str, float]]:
    """Distils a recording of a tour and scores it; figures of the trajectory beside, and Ast where looks are
    described."""
    begin = time.process_time()
    made = distil(without_tracks(given), priors, describe=describe, options=options)
    figures = {"processor_s": time.process_time() - begin, "registered": len(given.registered) / len(given)}
    times = {f.time_s: f.pose for f in filmed.recording.frames}
    pairs = [(made.poses[i], times.get(given.frames[n].time_s)) for i, n in enumerate(given.registered)]
    kept = [(a, b) for a, b in pairs if b is not None]
    if len(kept) < 2:
        raise NounError(f"recording {given.id!r}: found {len(kept)} registered frames of the tour, needed at least 2.")
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
    """One row: its name, how things are distilled, and what makes a recording of a tour in an empty folder."""

    row: str
    options: DistilOptions
    recording_of: Callable[[Tour, pathlib.Path], Recording]


@dataclasses.dataclass(frozen=True)
class Street:
    """One street's work, whole in one process: bank file and row, or an imported recording; which rows it has.

    tours: folder of the films. frames, size: of the tour without pictures; rgb_frames, rgb_size: with them, 0 = none.
    others: folders of recordings of the same tours. seed: of the errors. assets: whether Ast is measured.
    """

    bank: pathlib.Path | None
    scene: int
    recording: pathlib.Path | None
    tours: pathlib.Path
    frames: int
    size: tuple[int, int]
    rgb_frames: int
    rgb_size: tuple[int, int]
    others: tuple[pathlib.Path, ...]
    seed: int
    assets: bool


def street_rows(street: Street) -> tuple[str, dict[str, tuple[scores.Scores, dict[str, float]]]]:
    """Name of a street, and row -> what it scored."""
    priors = LabelPriors(load_index())
    geometry = [
        Plan("perfect inputs", DistilOptions(), lambda t, _: t.recording),
        Plan("injected errors, single view", SINGLE, _noisy(street.seed)),
        Plan("injected errors, fused", DistilOptions(), _noisy(street.seed)),
    ]
    geometry += [Plan(f.name, DistilOptions(), functools.partial(_given, f)) for f in street.others]
    seeing = [
        Plan("the small network, true poses and depth", DistilOptions(), seen_by_the_eye),
        Plan("RGB alone", DistilOptions(), from_pictures),
    ]
    found = {}
    if street.recording is not None:
        given = imported(street.recording)
        name = given.scene
        found["perfect inputs"] = judge(given.recording, given, priors, DistilOptions())
    else:
        assert street.bank is not None
        bank = SceneBank.load(street.bank)
        name = bank.scene_ids[street.scene]
        films = [(geometry, street.frames, street.size, False)]
        if street.rgb_frames:
            films.append((seeing, street.rgb_frames, street.rgb_size, True))
        for plans, frames, size, rgb in films:
            filmed = film(bank, street.scene, street.tours, frames, size, rgb)
            if rgb and street.assets:
                key = "perfect inputs, with pictures"
                found[key] = judge(filmed.recording, filmed, priors, DistilOptions(), DESCRIBE)
            for plan in plans:
                with tempfile.TemporaryDirectory(prefix="urbanverse-fidelity-") as work:
                    given = plan.recording_of(filmed, pathlib.Path(work))
                    found[plan.row] = judge(given, filmed, priors, plan.options)
    return name, found


def table_of(streets: Sequence[dict[str, tuple[scores.Scores, dict[str, float]]]]) -> list[dict[str, Any]]:
    """The rows over all streets that have them."""
    table = []
    for row in dict.fromkeys(name for street in streets for name in street):
        judged = [street[row] for street in streets if row in street]
        keys = dict.fromkeys(k for _, f in judged for k in f)
        figures = {k: round(float(np.mean([f[k] for _, f in judged if k in f])), 3) for k in keys}
        table.append({"row": row, "streets": len(judged), **scores.table_row([s for s, _ in judged]), **figures})
    return table


def _given(folder: pathlib.Path, filmed: Tour, _: pathlib.Path) -> Recording:
    return Recording.load(folder / filmed.recording.id)


def _noisy(seed: int) -> Callable[[Tour, pathlib.Path], Recording]:
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
    parser.add_argument("--rgb", type=int, default=0, help="so many streets of each bank are filmed with pictures, too")
    parser.add_argument("--rgb-frames", type=int, default=120, help="of these tours, two a second")
    parser.add_argument("--rgb-size", type=int, nargs=2, default=(480, 270), metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--kitti360", type=pathlib.Path, nargs="*", default=[], help="recordings that were imported")
    parser.add_argument("--tours", type=pathlib.Path, help="keeps the filmed tours, and reads those that are there")
    parser.add_argument("--recordings", type=pathlib.Path, nargs="*", default=[], help="more rows, see above")
    parser.add_argument("--seed", type=int, default=0, help="of the injected errors")
    parser.add_argument("--processes", type=int, default=1, help="streets at a time")
    parser.add_argument("--scaling", action="store_true", help="time 10 to 720 frames of the first street")
    parser.add_argument("--json", action="store_true", help="print one JSON line instead of a table")
    return parser.parse_args(argv)


def streets_of(arguments: argparse.Namespace, tours: pathlib.Path) -> list[Street]:
    """The work that the arguments ask for."""
    paths = list(arguments.banks)
    if arguments.shipped or not (paths or arguments.kitti360):
        ensure_default_bank(quiet=True)
        paths.insert(0, settings.default_bank_path())
    common = {
        "tours": tours,
        "frames": arguments.frames,
        "size": tuple(arguments.size),
        "rgb_size": tuple(arguments.rgb_size),
        "others": tuple(arguments.recordings),
        "seed": arguments.seed,
        "assets": True,
    }
    work = [Street(None, 0, path, rgb_frames=0, **common) for path in arguments.kitti360]
    for path in paths:
        for z in range(min(SceneBank.load(path).num_scenes, arguments.scenes)):
            work.append(Street(path, z, None, rgb_frames=arguments.rgb_frames * (z < arguments.rgb), **common))
    return work


def main(argv: list[str] | None = None) -> int:
    arguments = parse(argv)
    try:
        with tempfile.TemporaryDirectory(prefix="urbanverse-tours-") as work:
            folder = arguments.tours or pathlib.Path(work)
            streets = streets_of(arguments, folder)
            if arguments.scaling:
                first = streets[0]
                if first.bank is None:
                    raise NounError("--scaling: found an imported recording, needed a bank to film; name one.")
                filmed = film(SceneBank.load(first.bank), first.scene, folder, max(SCALING), first.size, False)
                result: dict[str, Any] = {"scaling": scaling(filmed, LabelPriors(load_index())), "scene": filmed.scene}
            else:
                done = {}
                for name, rows in _worked(streets, arguments.processes):
                    done[name] = rows
                    took = ", ".join(f"{k} {f['processor_s']:.1f} s" for k, (_, f) in rows.items())
                    print(f"{name}: {took}", file=sys.stderr, flush=True)
                frames = {"frames": arguments.frames, "rgb_frames": arguments.rgb_frames if arguments.rgb else 0}
                result = {"rows": table_of(list(done.values())), "paper": PAPER, "scenes": list(done), **frames}
    except NounError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    print(json.dumps(result) if arguments.json else _text(result))
    return 0


def _worked(streets: Sequence[Street], processes: int) -> Iterator[tuple[str, dict]]:
    if processes <= 1:
        yield from map(street_rows, streets)
        return
    context = multiprocessing.get_context("spawn")
    with concurrent.futures.ProcessPoolExecutor(processes, mp_context=context) as pool:
        yield from pool.map(street_rows, streets)


def _text(result: dict[str, Any]) -> str:
    if "scaling" in result:
        return "\n".join(", ".join(f"{k} {v}" for k, v in row.items()) for row in result["scaling"])
    lines = [f"{'':42}" + "".join(f"{name:>18}" for name in _COLUMNS)]
    for row in [*result["rows"], {"row": "the paper, on KITTI-360", **result["paper"]}]:
        cells = ["-" if row.get(c) is None else f"{row[c]}" for c in _COLUMNS]
        lines.append(f"{row['row']:42}" + "".join(f"{c:>18}" for c in cells))
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
