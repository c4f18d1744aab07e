"""Draws streets of the library with the houses of the catalogue and with those of their region, side by side.

    urbanverse scene compile scenes/urbanverse160/LAYOUT/graph.json.gz --out FOLDER [--regional]
    python -m benchmarks.city_sheet --before before.npz --after after.npz --out docs/cities.jpg

Both banks (`scene.pack_bank` of the folders) hold the same layouts in the same order. The camera stands on the
trajectory of each layout's graph at the height of the one that filmed it.
"""

import argparse
import pathlib
import sys

import numpy as np
from PIL import Image

from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import SceneBank, SceneGraph
from urbanverse_mjx.simulation.rendering.cameras import look_at
from urbanverse_mjx.simulation.rendering.renderer import Renderer

#: Pixels of an image, rad, and m from the camera to the point it looks at, that much higher per m.
HEIGHT, WIDTH, FOVY, AHEAD, RISE = 300, 400, 1.15, 5.0, 0.12


def seen(layout: str, place: float, aside_deg: float) -> tuple[np.ndarray, np.ndarray]:
    """Position (3,) and rotation (4,) of a camera at a share of a layout's trajectory, turned aside from it."""
    graph = SceneGraph.load(settings.scene_root() / "urbanverse160" / layout / "graph.json.gz")
    path = np.array(graph.camera_path)
    here = int(len(path) * place)
    along = path[min(here + 4, len(path) - 1), :2] - path[here, :2]
    yaw = np.arctan2(along[1], along[0]) + np.radians(aside_deg)
    at = np.array([*path[here, :2], np.median(path[:, 2])])
    return at, look_at(at, at + AHEAD * np.array([np.cos(yaw), np.sin(yaw), RISE]))


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.city_sheet", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--before", type=pathlib.Path, required=True, help="bank with the catalogue's houses")
    parser.add_argument("--after", type=pathlib.Path, required=True, help="bank with regional houses")
    parser.add_argument("--place", type=float, default=0.675, help="share of the trajectory")
    parser.add_argument("--aside", type=float, default=20.0, help="degrees to the left of the trajectory")
    parser.add_argument("--light", default="direct", help="direct or baked")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    arguments = parser.parse_args(argv)
    columns = []
    for path in (arguments.before, arguments.after):
        bank = SceneBank.load(path)
        renderer = Renderer(bank, None, HEIGHT, WIDTH, shading="pbr", samples=2, light=arguments.light)
        images = []
        for number, scene in enumerate(bank.scene_ids):
            at, turn = seen(scene.split("_Cousin_")[0], arguments.place, arguments.aside)
            images.append(np.asarray(renderer.view(number, at, turn, FOVY)["rgb"]))
        columns.append(images)
    pairs = [np.concatenate(pair, 1) for pair in zip(*columns, strict=True)]
    rows = [np.concatenate(pairs[k : k + 2], 1) for k in range(0, len(pairs) - len(pairs) % 2, 2)]
    Image.fromarray(np.concatenate(rows)).save(arguments.out, quality=80)
    return 0


if __name__ == "__main__":
    sys.exit(main())
