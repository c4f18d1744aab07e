"""Draws the committed images anew: `python -m tests.simulation.rendering.make_golden`; inspect them."""

import imageio.v3 as iio
import jax
import numpy as np

from tests.support.box_bank import box_bank
from urbanverse_mjx.robots.coco import make_coco

from . import render_cases as cases
from .test_renderer import GOLDEN


def main() -> None:
    bank, robot = box_bank(8, seed=0), make_coco()
    places = cases.make_places(bank, robot, 8)
    GOLDEN.mkdir(exist_ok=True)
    for shading in ("matte", "pbr"):
        for name, options in ((shading, {"shadows": True}), (f"{shading}_baked", {"light": "baked"})):
            renderer = cases.make_renderer(bank, robot, shading=shading, **options)
            rgb = np.asarray(jax.vmap(renderer)(*places.inputs)["rgb"])
            iio.imwrite(GOLDEN / f"{name}.png", rgb.reshape(-1, cases.WIDTH, 3))


if __name__ == "__main__":
    main()
