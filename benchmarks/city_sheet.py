"""Draws streets of the library as they are and with the look of their region, side by side.

    urbanverse scene compile scenes/urbanverse160/LAYOUT/graph.json.gz --out FOLDER [--regional]
    python -m benchmarks.city_sheet --before before.npz --after after.npz --out docs/cities.jpg
    python -m benchmarks.city_sheet --set craftbench_v2 --before V1.npz --after V2.npz --light direct,baked

Both banks (`scene.pack_bank` of the folders) hold the same layouts in the same order. The camera stands on the
trajectory of each layout's graph, as the set `--set` has it, at the height of the one that filmed it, or at `--heights`
above the pavement. With `--repeat` the processor time of all images after over that before, interleaved, is printed as
one JSON line.
"""

import argparse
import json
import pathlib
import statistics
import sys
import time

import numpy as np
from PIL import Image

from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.pipeline.library.building import graph_of
from urbanverse_mjx.scene import library
from urbanverse_mjx.simulation.rendering.cameras import look_at
from urbanverse_mjx.simulation.rendering.renderer import Renderer

#: Pixels of an image, rad, and m from the camera to the point it looks at, that much higher per m.
HEIGHT, WIDTH, FOVY, AHEAD, RISE = 300, 400, 1.15, 5.0, 0.12
#: m along the trajectory that give its direction.
STRETCH = 9.0


def seen(
    layout: str, place: float, aside_deg: float, z: float | None = None, name: str = "urbanverse160"
) -> tuple[np.ndarray, np.ndarray]:
    """Position (3,) and rotation (4,) of a camera at a share of a layout's trajectory, turned aside from it.

    Args:
      z: m, its height; default: the trajectory's, from where it looks up a little.
      name: set of the library to which the layout belongs.
    """
    path = np.array(graph_of(library.scene_set(name), layout).camera_path)
    here = int(len(path) * place)
    driven = np.cumsum(np.linalg.norm(np.diff(path[here:, :2], axis=0), axis=1))
    there = here + 1 + int(np.searchsorted(driven, STRETCH))
    along = path[min(there, len(path) - 1), :2] - path[here, :2]
    yaw = np.arctan2(along[1], along[0]) + np.radians(aside_deg)
    at = np.array([*path[here, :2], np.median(path[:, 2]) if z is None else z])
    return at, look_at(at, at + AHEAD * np.array([np.cos(yaw), np.sin(yaw), RISE if z is None else -RISE / 2]))


def _cost(renderers: list[Renderer], views: list[tuple[int, np.ndarray, np.ndarray]], repeat: int) -> float:
    """Median over `repeat` rounds of the processor time of all views, after over before."""
    ratios = []
    for _ in range(repeat):
        spent = []
        for renderer in renderers:
            begin = time.process_time()
            for number, at, turn in views:
                np.asarray(renderer.view(number, at, turn, FOVY)["rgb"])
            spent.append(time.process_time() - begin)
        ratios.append(spent[1] / spent[0])
    return statistics.median(ratios)


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.city_sheet", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--set", default="urbanverse160", help="set of the library with these layouts")
    parser.add_argument("--before", type=pathlib.Path, required=True, help="bank with the former look")
    parser.add_argument("--after", type=pathlib.Path, required=True, help="bank with the new look")
    parser.add_argument("--place", type=float, default=0.675, help="share of the trajectory")
    parser.add_argument("--aside", type=float, default=20.0, help="degrees to the left of the trajectory")
    parser.add_argument("--heights", default="", help="m above the pavement, with commas")
    parser.add_argument("--repeat", type=int, default=0, help="rounds of the comparison of processor time")
    parser.add_argument("--light", default="direct", help="direct or baked, or both with a comma: before,after")
    parser.add_argument("--quality", type=int, default=80, help="of the JPEG file")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    arguments = parser.parse_args(argv)
    banks = [SceneBank.load(path) for path in (arguments.before, arguments.after)]
    lights = (arguments.light.split(",") * 2)[:2]
    renderers = [
        Renderer(bank, None, HEIGHT, WIDTH, shading="pbr", samples=2, light=light)
        for bank, light in zip(banks, lights, strict=True)
    ]
    heights = [float(h) for h in arguments.heights.split(",")] if arguments.heights else [None]
    views = []
    for number, scene in enumerate(banks[0].scene_ids):
        ground = float(np.median(banks[0].episode_start[number, :, 2]))
        for height in heights:
            z = None if height is None else ground + height
            views.append(
                (number, *seen(scene.split("_Cousin_")[0], arguments.place, arguments.aside, z, arguments.set))
            )
    columns = [[np.asarray(r.view(n, at, turn, FOVY)["rgb"]) for n, at, turn in views] for r in renderers]
    pairs = [np.concatenate(pair, 1) for pair in zip(*columns, strict=True)]
    rows = [np.concatenate(pairs[k : k + 2], 1) for k in range(0, len(pairs) - len(pairs) % 2, 2)]
    if arguments.repeat:
        print(json.dumps({"processor_time_ratio": round(_cost(renderers, views, arguments.repeat), 3)}))
    Image.fromarray(np.concatenate(rows)).save(arguments.out, quality=arguments.quality)
    return 0


if __name__ == "__main__":
    sys.exit(main())
