"""Renders captures of the city blocks of UrbanVerse-160 and AutoBench and distils them with UrbanVerse-Gen.

    python -m benchmarks.library_captures --out DIR [--set autobench] [--only Tokyo] [--workers 16]

writes DIR/<set>/<layout>/graph.json.gz (what `scenes/` holds) and DIR/scores/<set>/<layout>.json: the graph's fidelity
to the true scene, as in `benchmarks.fidelity`, and DIR/sheets/<layout>.jpg: 12 frames. Layouts with a graph and scores
are skipped, so a stopped run continues. One process a layout at a time, on the CPU; some 1.5 GB each. Prints one JSON
line.
"""

import argparse
import json
import os
import pathlib
import sys
import time
from typing import Any

import numpy as np
from PIL import Image

from benchmarks.lib import fidelity_scores as scores
from urbanverse_mjx import settings
from urbanverse_mjx.citygen import city_blocks
from urbanverse_mjx.citygen.city_blocks.block import LENGTH
from urbanverse_mjx.datatypes import Recording, SceneGraph, ValidationError
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.process_pool import results_as_completed
from urbanverse_mjx.work_folder import work_folder


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.library_captures", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--set", choices=sorted(city_blocks.PROFILES), action="append", help="default: all")
    parser.add_argument("--only", default="", help="layouts with this in their id")
    parser.add_argument("--workers", type=int, default=settings.num_threads())
    parser.add_argument("--length", type=float, default=LENGTH, help="m of street; shorter ones to try it out")
    parser.add_argument("--keep", action="store_true", help="keep the recordings in DIR/recordings")
    arguments = parser.parse_args(argv)
    jobs = [
        (name, layout, arguments.out, arguments.keep, arguments.length)
        for name in arguments.set or sorted(city_blocks.PROFILES)
        for layout in city_blocks.layouts(name)
        if arguments.only in layout and not all(p.is_file() for p in _files(arguments.out, name, layout))
    ]
    begin, failed = time.monotonic(), {}
    # Every process renders on one core, because threads of several processes would compete. JAX and Warp stay on the
    # CPU.
    os.environ |= {"OMP_NUM_THREADS": "1", "URBANVERSE_THREADS": "1", "JAX_PLATFORMS": "cpu"}
    for number, (task, (figures, error)) in enumerate(results_as_completed(_film, jobs, arguments.workers), 1):
        layout = jobs[task][1]
        if error:
            failed[layout] = error
        said = error or json.dumps(figures)
        print(f"{number}/{len(jobs)} {time.monotonic() - begin:.0f} s {layout}: {said}", file=sys.stderr, flush=True)
    print(json.dumps({"filmed": len(jobs) - len(failed), "failed": failed, "seconds": round(time.monotonic() - begin)}))
    return 1 if failed else 0


def _files(out: pathlib.Path, name: str, layout: str) -> tuple[pathlib.Path, pathlib.Path]:
    return out / name / layout / "graph.json.gz", out / "scores" / name / f"{layout}.json"


def _film(name: str, layout: str, out: pathlib.Path, keep: bool, length: float) -> tuple[dict[str, Any], str]:
    """Returns the figures of one layout, or the reason why it cannot be captured."""
    try:
        return _figures(name, layout, out, keep, length), ""
    except ValidationError as error:
        return {}, str(error)


def _figures(name: str, layout: str, out: pathlib.Path, keep: bool, length: float) -> dict[str, Any]:
    """Processes one layout in this process: writes its graph and its scores."""
    from urbanverse_mjx.capture.ground_truth import object_id, object_slots
    from urbanverse_mjx.pipeline.library.captures import film

    graph_file, score_file = _files(out, name, layout)
    begin, processor = time.monotonic(), time.process_time()
    with work_folder("urbanverse-capture-") as work:
        folder = out / "recordings" / layout if keep else pathlib.Path(work)
        made = film(city_blocks.layouts(name)[layout], city_blocks.SEEDS[name], layout, folder, length)
        ground_truth = SceneGraph.load(folder / "truth.json").objects
        seen = scores.seen_objects(made.recording, ground_truth)
        _sheet(made.recording, out / "sheets" / f"{layout}.jpg")
    ids = {t.id for t in seen}
    turnable = {}
    for slot in object_slots(made.bank, 0):
        mesh = made.bank.slot_mesh[0, slot]
        rows = slice(made.bank.mesh_vertex_start[mesh], made.bank.mesh_vertex_start[mesh + 1])
        turnable[object_id(made.bank, 0, slot)] = scores.is_turnable(made.bank.mesh_vertices[rows, :2])
    row = scores.table_row(
        [scores.score(made.graph.objects, seen, [t for t in ground_truth if t.id not in ids], turnable)]
    )
    figures = {
        **row,
        "frames": len(made.recording),
        "things_in_block": len(ground_truth),
        "objects": len(made.graph.objects),
        "regions": len(made.graph.ground),
        "processor_s": round(time.process_time() - processor, 1),
        "wall_s": round(time.monotonic() - begin, 1),
    }
    made.graph.save(graph_file)
    v.write_json(score_file, figures)
    return {**figures, "kB": round(graph_file.stat().st_size / 1e3, 1)}


def _sheet(recording: Recording, path: pathlib.Path) -> None:
    """Writes an image of twelve frames of a capture, four in a row."""
    frames = [recording.rgb(int(i)) for i in np.linspace(1, len(recording) - 2, 12)]
    rows = [np.concatenate(frames[k : k + 4], axis=1) for k in range(0, 12, 4)]
    image = Image.fromarray(np.concatenate(rows))
    v.write_atomically(path, lambda p: image.save(p, "JPEG", quality=85))


if __name__ == "__main__":
    sys.exit(main())
