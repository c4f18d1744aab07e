"""Draws an image that compares cost and appearance of each style of the renderer.

    python -m benchmarks.render_sheet --results render_1.jsonl --out docs/renderer_looks.jpg

renders the same positions once in every style, with the costs measured by `benchmarks.render --out` beside them.
"""

import argparse
import dataclasses
import json
import pathlib
import sys
from typing import Any

import jax
import numpy as np
from PIL import Image, ImageDraw

from benchmarks import render
from urbanverse_mjx.datatypes import RobotSpec, SceneBank
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.simulation.rendering.renderer import Renderer

#: (height, width, shading, style) of the rows.
ROWS = (
    (135, 240, "pbr", "shadows"),
    (135, 240, "pbr", "plain"),
    (135, 240, "matte", "shadows"),
    (135, 240, "matte", "plain"),
    (135, 240, "pbr", "four-rays"),
    (135, 240, "pbr", "no-textures"),
    (135, 240, "pbr", "no-sky"),
    (36, 64, "pbr", "shadows"),
    (36, 64, "pbr", "plain"),
)
SHOWN = (135, 240)
#: Pixels of the margins left of the images and above them.
LABEL, TITLE = 190, 36


def costs(results: pathlib.Path | None) -> dict[str, dict[str, Any]]:
    """Returns measured lines by "HEIGHTxWIDTH shading style", and the machine under "title".

    The first line of each is used, which precedes lines of other block sizes.
    """
    found: dict[str, dict[str, Any]] = {}
    for line in results.read_text().splitlines() if results else []:
        entry = json.loads(line)
        if "device" in entry:
            found["title"] = entry
        if "frames_per_s" in entry:
            size, shading, style = entry["case"].split(" ")
            entry["envs"] = int(size.split("@")[1])
            found.setdefault(f"{size.split('@')[0]} {shading} {style}", entry)
    return found


def frames(bank: SceneBank, robot: RobotSpec, row: tuple[int, int, str, str], places: tuple) -> np.ndarray:
    """Returns (n, 135, 240, 3) u8: each position in one style; smaller images are enlarged."""
    height, width, shading, style = row
    options = dict(render.STYLES[style])
    if not options.pop("textures", True):
        bank = dataclasses.replace(bank, material_texture=np.full_like(bank.material_texture, -1))
    renderer = Renderer(bank, robot, height, width, shading=shading, **options)
    rgb = np.asarray(jax.vmap(renderer)(*places)["rgb"])
    return np.stack(
        [np.asarray(Image.fromarray(x).resize((SHOWN[1], SHOWN[0]), Image.Resampling.NEAREST)) for x in rgb]
    )


def sheet(
    bank: SceneBank, robot: RobotSpec, number: int, seed: int, measured: dict[str, dict[str, float]]
) -> Image.Image:
    places = render.random_places(bank, robot, number, seed)
    height, width = SHOWN
    image = Image.new("RGB", (LABEL + number * (width + 4), TITLE + len(ROWS) * (height + 4)), (255, 255, 255))
    draw = ImageDraw.Draw(image)
    if "title" in measured:
        title = measured["title"]
        text = "{device}, {scenes} streets of {objects_per_scene:.0f} objects and {triangles_per_scene:,.0f} triangles"
        draw.text((8, 8), text.format(**title), fill=(0, 0, 0), font_size=16)
    for i, row in enumerate(ROWS):
        y = TITLE + i * (height + 4)
        text = f"{row[0]}x{row[1]}  {row[2]}\n{row[3]}"
        entry = measured.get(f"{row[0]}x{row[1]} {row[2]} {row[3]}")
        if entry:
            text += f"\n\n{entry['frames_per_s']:,.0f} frames/s\n{entry['envs']:,} envs"
        draw.multiline_text((8, y + 30), text, fill=(0, 0, 0), font_size=16, spacing=4)
        for j, frame in enumerate(frames(bank, robot, row, places)):
            image.paste(Image.fromarray(frame), (LABEL + j * (width + 4), y))
    return image


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.render_sheet", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--bank", type=pathlib.Path, help="a bank file (default: the shipped streets)")
    parser.add_argument("--results", type=pathlib.Path, help="JSON lines of benchmarks.render")
    parser.add_argument("--places", type=int, default=4)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    arguments = parser.parse_args(argv)
    bank = render.load_bank(arguments.bank)
    image = sheet(bank, make_coco(), arguments.places, arguments.seed, costs(arguments.results))
    image.save(arguments.out, quality=82)
    return 0


if __name__ == "__main__":
    sys.exit(main())
