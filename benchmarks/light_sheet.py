"""Draws streets from robot height in direct light, in baked light, and with traced shadows besides.

    python -m benchmarks.light_sheet --bank bank.npz --out docs/baked_light.webp

Each row is one place on a route of another scene, looking along the route.
"""

import argparse
import pathlib
import sys
from typing import Any

import numpy as np
from PIL import Image

from benchmarks import render
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.simulation.rendering.cameras import look_at
from urbanverse_mjx.simulation.rendering.renderer import Renderer

COLUMNS: tuple[dict[str, Any], ...] = ({}, {"light": "baked"}, {"light": "baked", "shadows": True})
#: Pixels of an image, m above the ground of the camera and of the point it looks at, rad.
HEIGHT, WIDTH, CAMERA, TARGET, FOVY = 200, 356, 0.6, 0.5, 1.1


def places(bank: SceneBank, number: int, seed: int) -> list[tuple[int, np.ndarray, np.ndarray]]:
    """Scene, position (3,) and rotation (4,) of a camera at `number` waypoints of routes, one scene after the other."""
    rng, found = np.random.default_rng(seed), []
    for i in range(number):
        scene = i % bank.num_scenes
        row = rng.integers(bank.num_episodes[scene])
        route = bank.episode_waypoints[scene, row, : bank.episode_num_waypoints[scene, row]].astype(float)
        route = np.concatenate([bank.episode_start[scene, row, None, :3], route])
        first = rng.integers(len(route) - 1)
        here, ahead = route[first] + [0.0, 0.0, CAMERA], route[first + 1] + [0.0, 0.0, TARGET]
        found.append((scene, here, look_at(here, ahead)))
    return found


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.light_sheet", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--bank", type=pathlib.Path, help="a bank file (default: the shipped streets)")
    parser.add_argument("--places", type=int, default=6)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--shading", default="pbr")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    arguments = parser.parse_args(argv)
    bank = render.load_bank(arguments.bank)
    seen = places(bank, arguments.places, arguments.seed)
    columns = []
    for options in COLUMNS:
        renderer = Renderer(bank, None, HEIGHT, WIDTH, shading=arguments.shading, samples=2, **options)
        images = [np.asarray(renderer.view(scene, here, turn, FOVY)["rgb"]) for scene, here, turn in seen]
        columns.append(np.concatenate(images))
    Image.fromarray(np.concatenate(columns, 1)).save(arguments.out, quality=80)
    return 0


if __name__ == "__main__":
    sys.exit(main())
