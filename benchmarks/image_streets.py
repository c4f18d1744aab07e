"""Distils streets of UrbanVerse-160 from images alone, beside the same film with exact poses, depth and masks.

    python -m benchmarks.image_streets --out DIR                         # ten streets, on the processor alone
    python -m benchmarks.image_streets --out DIR --streets NAME --length 60 --cousins 1 --episodes 16
    python -m benchmarks.image_streets --out DIR --page                  # the table of what is there

The 42 graphs of the scene library were distilled with exact poses, depth and masks. What does perception cost? Each
block is made as for the library and filmed once along its trajectory, two frames a second, 480 x 270, as in a video of
which `urbanverse gen` takes two frames a second. Two graphs are distilled from the film: `exact` reads its depth, masks
and poses, `images` its images alone (COLMAP's poses, the shipped network). Each is scored against the block
(`benchmarks.fidelity`: Cat, Dist, Ori, mAP25), becomes cousins as by `urbanverse gen`, and the planner, which knows the
whole scene, drives in them. Once all streets are done, DIR/<arm>/bank.npz holds the cousins of all streets of an arm:
`python -m benchmarks.campaign --rows "image-streets-*"` trains teachers on them that differ in nothing else.

DIR/streets/<street> keeps every stage, so that a stopped run continues; a street that fails (no poses, no ground) is
named with its reason in DIR/streets/<street>/<arm>/failed.txt and left out of both banks. Remove that file to try
again.
"""

import argparse
import json
import os
import pathlib
import sys
import time
from typing import Any

import numpy as np

from benchmarks.lib import fidelity_scores as scores
from benchmarks.lib import fidelity_store, tables
from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import Recording, SceneBank, SceneGraph, ValidationError
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.datatypes.bank_join import join
from urbanverse_mjx.datatypes.recording import FILE
from urbanverse_mjx.work_folder import replacing_folder

SET, ARMS = "urbanverse160", ("exact", "images")
#: Number of streets, spread evenly over the set's.
STREETS = 10
#: Number of cousins of a street.
COUSINS = 5
#: Frames per second, m between frames (a walk of 1.4 m/s), and pixels of the film.
RATE, STEP, SIZE = 2.0, 0.7, (480, 270)
BANK, DONE, FAILED, BANKS = "bank.npz", "done.json", "failed.txt", "banks.json"
_COLUMNS = ("cat_percent", "dist_m", "ori_deg", "map25", "recall_percent", "precision_percent", "trajectory_m")


def streets() -> list[str]:
    """Names of the streets by default."""
    from urbanverse_mjx.citygen import city_blocks

    names = sorted(city_blocks.layouts(SET))
    return [names[k] for k in np.linspace(0, len(names) - 1, STREETS).round().astype(int)]


def camera_path(places: np.ndarray) -> Any:
    """The path (n, 4) of a block's camera (x, y, z in m, yaw in rad) as a film: a step of `STEP`, swaying
    and turning as the camera of `urbanverse capture`.

    Where the path turns faster than that, as that of a vehicle at the end of a block, the camera is slower: between
    frames without a common view no pose can be found.

    Returns:
      `capture.CameraPath`.
    """
    from urbanverse_mjx.capture import CameraPath
    from urbanverse_mjx.capture.path import PathOptions, camera_poses

    camera = PathOptions()
    heading = np.unwrap(places[:, 3])
    moved = np.linalg.norm(np.diff(places[:, :2], axis=0), axis=1)
    turn_s = np.abs(np.diff(heading)) / np.pi * camera.turn_time
    along = np.r_[0.0, np.cumsum(np.maximum(moved, turn_s * RATE * STEP))]
    at = np.arange(0.0, along[-1], STEP)
    x, y, z, yaw = (np.interp(at, along, column) for column in (*places[:, :3].T, heading))
    time_s = np.arange(len(at)) / RATE
    yaw = yaw + camera.sway * np.sin(2 * np.pi * time_s / camera.sway_period)
    return CameraPath(time_s, camera_poses(np.stack([x, y, z], -1), yaw, camera.pitch))


def film(street: str, work: pathlib.Path, length: float) -> Any:
    """Films a street, or reads its film; returns a `fidelity_captures.Capture`."""
    from benchmarks.lib.fidelity_captures import with_ground_truth
    from urbanverse_mjx.capture import FilmOptions, film_scene
    from urbanverse_mjx.capture.ground_truth import object_id, object_slots
    from urbanverse_mjx.citygen import city_blocks
    from urbanverse_mjx.pipeline.library.captures import compiled_block

    if not (work / "film" / FILE).is_file():
        bank, places = compiled_block(city_blocks.layouts(SET)[street], city_blocks.SEEDS[SET], street, length)
        turnable = {}
        for slot in object_slots(bank, 0):
            mesh = bank.slot_mesh[0, slot]
            rows = slice(bank.mesh_vertex_start[mesh], bank.mesh_vertex_start[mesh + 1])
            turnable[object_id(bank, 0, slot)] = scores.is_turnable(bank.mesh_vertices[rows, :2])
        with replacing_folder(work / "film") as fresh:
            film_scene(bank, 0, fresh, camera_path(places), FilmOptions(width=SIZE[0], height=SIZE[1]))
            v.write_json(fresh / "turnable.json", turnable)
    recording = Recording.load(work / "film")
    ground_truth = SceneGraph.load(work / "film" / "truth.json").objects
    turnable = v.read_json(work / "film" / "turnable.json", "objects with a heading")
    return with_ground_truth(recording, ground_truth, turnable, street)


def seen(arm: str, filmed: Any, work: pathlib.Path) -> Recording:
    """What an arm distils: the film itself, or what is perceived in its images."""
    from benchmarks.lib.fidelity_captures import RECORDED, from_images
    from urbanverse_mjx.citygen.city_blocks.block import CAMERA_HEIGHT

    if arm == "exact":
        return filmed.recording
    if not (work / "perceived" / RECORDED / FILE).is_file():
        with replacing_folder(work / "perceived") as fresh:
            from_images(filmed, fresh, CAMERA_HEIGHT)
    return Recording.load(work / "perceived" / RECORDED)


def graph_of(arm: str, filmed: Any, work: pathlib.Path) -> tuple[pathlib.Path, fidelity_store.Row]:
    """Distils an arm's graph and scores it, unless both are there."""
    from benchmarks.fidelity import judge, without_tracks
    from urbanverse_mjx.assets.records.index import load_index
    from urbanverse_mjx.assets.selection.label_priors import LabelPriors
    from urbanverse_mjx.distillation import DistilOptions, distil
    from urbanverse_mjx.pipeline.generation.distilling import DESCRIBE

    graph, file = work / arm / "graph.json", work / arm / "scores.json"
    if not (graph.is_file() and file.is_file()):
        (work / arm).mkdir(parents=True, exist_ok=True)
        recording, priors = without_tracks(seen(arm, filmed, work)), LabelPriors(load_index())
        row = judge(recording, filmed, priors, DistilOptions())
        fidelity_store.save(file, {arm: row})
        distil(recording, priors, describe=DESCRIBE).graph.save(graph)
    return graph, fidelity_store.load(file)[arm]


def driven(arm: str, graph: pathlib.Path, work: pathlib.Path, args: argparse.Namespace) -> dict[str, Any]:
    """Makes the cousins of an arm's graph and drives the planner in them; returns the run's summary and its success."""
    from benchmarks.street_tuning import generate
    from urbanverse_mjx.pipeline.evaluation import evaluate_policy

    run = generate(graph, work / arm / "run", args.cousins, args.workers, False)
    bank = SceneBank.load(work / arm / "run" / BANK)
    found = evaluate_policy("planner", bank, work / arm / "planner", args.episodes, 0, False, True, scenes="all")
    (success,) = (value["SR"]["mean"] for value in found.values())
    return {"objects": run["nodes"], "cousins": bank.num_scenes, "episodes": args.episodes, "planner_percent": success}


def street_done(street: str, args: argparse.Namespace) -> dict[str, Any]:
    """Works on one street; returns arm -> its figures, or the reason why it has none."""
    work = args.out / "streets" / street
    done = work / DONE
    if done.is_file():
        return v.read_json(done, "street")
    filmed = film(street, work, args.length)
    figures: dict[str, Any] = {}
    for arm in ARMS:
        failed = work / arm / FAILED
        if failed.is_file():
            figures[arm] = {"failed": failed.read_text(encoding="utf-8").strip()}
            continue
        begin = time.monotonic()
        try:
            graph, (score, more) = graph_of(arm, filmed, work)
            found = {**scores.table_row([score]), **more, **driven(arm, graph, work, args)}
        except ValidationError as error:
            failed.parent.mkdir(parents=True, exist_ok=True)
            failed.write_text(f"{error}\n", encoding="utf-8")
            figures[arm] = {"failed": str(error)}
        else:
            figures[arm] = {**found, "wall_s": round(time.monotonic() - begin, 1)}
        print(f"{street}, {arm}: {json.dumps(figures[arm])}", file=sys.stderr, flush=True)
    v.write_json(done, figures)
    return figures


def join_banks(args: argparse.Namespace, found: dict[str, dict[str, Any]]) -> list[str]:
    """Writes the bank of each arm, of the streets that have cousins in both, and banks.json; returns their names."""
    both = [street for street, arms in found.items() if not any("failed" in row for row in arms.values())]
    for arm in ARMS if both else ():
        banks = [SceneBank.load(args.out / "streets" / street / arm / "run" / BANK) for street in both]
        (args.out / arm).mkdir(parents=True, exist_ok=True)
        join(banks).save(args.out / arm / BANK)
    if both:
        v.write_json(args.out / BANKS, {"streets": both, "cousins": args.cousins, "length": args.length})
    return both


def page_text(out: pathlib.Path) -> str:
    """Markdown: both arms over the streets that have them, then street by street."""
    files = sorted((out / "streets").glob(f"*/{DONE}"))
    found = {path.parent.name: v.read_json(path, "street") for path in files}
    whole = [street for street, arms in found.items() if not any("failed" in row for row in arms.values())]
    lines = []
    for arm in ARMS if whole else ():
        rows = [fidelity_store.load(out / "streets" / street / arm / "scores.json")[arm] for street in whole]
        pooled = scores.table_row([score for score, _ in rows])
        means = {k: float(np.mean([found[s][arm][k] for s in whole])) for k in ("trajectory_m", "planner_percent")}
        lines.append([f"all {len(whole)}", arm, *_cells({**pooled, **means})])
    for street, arms in found.items():
        for arm in ARMS:
            row = arms[arm]
            lines.append([street, arm, *((row["failed"],) if "failed" in row else _cells(row))])
    if not lines:
        return "Not run yet: `python -m benchmarks.image_streets --out DIR`."
    return tables.markdown(["street", "input", *_COLUMNS, "planner SR %"], [_wide(line) for line in lines])


def _cells(row: dict[str, Any]) -> list[str]:
    return ["-" if row.get(k) is None else f"{row[k]:.3g}" for k in (*_COLUMNS, "planner_percent")]


def _wide(line: list[str]) -> list[str]:
    return line + [""] * (len(_COLUMNS) + 3 - len(line))


def arguments(argv: list[str] | None = None) -> argparse.Namespace:
    """The command line; argv: that of this process by default."""
    from urbanverse_mjx.citygen.city_blocks.block import LENGTH

    cli = argparse.ArgumentParser(prog="python -m benchmarks.image_streets", description=__doc__)
    cli.formatter_class = argparse.RawDescriptionHelpFormatter
    cli.add_argument("--out", type=pathlib.Path, required=True)
    cli.add_argument("--streets", nargs="+", metavar="STREET", help=f"layouts of {SET}; default: {STREETS} of them")
    cli.add_argument("--length", type=float, default=LENGTH, help="m of street; shorter ones to try it out")
    cli.add_argument("--cousins", type=int, default=COUSINS)
    cli.add_argument("--episodes", type=int, default=64, help="of the planner in the cousins of a street")
    cli.add_argument("--workers", type=int, default=settings.num_threads(), help="processes that compile")
    cli.add_argument("--page", action="store_true", help="print the table of what is there, and run nothing")
    return cli.parse_args(argv)


def main(argv: list[str] | None = None) -> int:
    args = arguments(argv)
    args.out = args.out.absolute()
    if args.page:
        print(page_text(args.out))
        return 0
    os.environ |= {"OMP_NUM_THREADS": "1", "JAX_PLATFORMS": "cpu"}
    settings.use_compilation_cache()
    try:
        from urbanverse_mjx.citygen import city_blocks

        for street in args.streets or ():
            v.choice(street, "--streets", sorted(city_blocks.layouts(SET)))
        for name in ("cousins", "episodes", "workers"):
            v.integer(getattr(args, name), f"--{name}", 1)
        found = {street: street_done(street, args) for street in args.streets or streets()}
        both = join_banks(args, found)
    except ValidationError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    failed = {street: arms for street, arms in found.items() if street not in both}
    print(json.dumps({"streets": both, "failed": failed}))
    return 0 if both else 1


if __name__ == "__main__":
    sys.exit(main())
