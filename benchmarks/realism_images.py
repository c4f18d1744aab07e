"""The image part of `benchmarks.realism`: statistics of rendered images beside those of photographs of streets.

    python -m benchmarks.realism_images --out FILE.md NAME=BANK.npz NAME=FOLDER ...
    python -m benchmarks.realism_images --reference FOLDER --named TEXT

A family is a bank, of which `--places` places a scene are rendered along its routes, or a folder of images. For every
statistic (`lib/image_statistics.py`) the table has the 10, 50 and 90 % quantiles of the reference photographs
(`image_reference.json`), the family's median, the share of its images within the reference's 10 to 90 % range, and
a gap where the median lies outside. `PUBLISHED` are figures of further data sets. --reference computes the quantiles of
a folder of photographs and writes them; the photographs themselves are not part of this repository.
"""

import argparse
import json
import math
import pathlib
import sys
from collections.abc import Iterator, Sequence

import numpy as np
from PIL import Image

from benchmarks.lib.image_statistics import STATISTICS, statistics
from benchmarks.lib.tables import markdown
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.datatypes.validation import read_json, write_json
from urbanverse_mjx.simulation.rendering.cameras import look_at
from urbanverse_mjx.simulation.rendering.renderer import Renderer

REFERENCE = pathlib.Path(__file__).parent / "image_reference.json"
#: Pixels and vertical angle (rad) of rendered images, and the camera's height (m) above the route.
HEIGHT, WIDTH, FOVY, CAMERA_HEIGHT = 360, 480, 0.85, 1.4
QUANTILES = (0.1, 0.5, 0.9)
SUFFIXES = (".png", ".jpg", ".jpeg")
#: Statistic -> (value, data set, address): means over data sets, where no quantiles of images are published. Brightness
#: and contrast are the Rec. 709 means of the channels' means and standard deviations with which networks are fed;
#: looked up on 2026-11-26.
PUBLISHED: dict[str, tuple[tuple[float, str, str], ...]] = {
    "slope": (
        (
            1.2,
            "135 photographs (0.8 to 1.5), Tolhurst et al. 1992",
            "http://de.evo-art.org/index.php?title=Amplitude_spectra_of_natural_images",
        ),
    ),
    "brightness": (
        (0.314, "Cityscapes", "github.com/Lightning-Universe/lightning-bolts pl_bolts/datamodules"),
        (0.450, "Mapillary Vistas", "github.com/mapillary/inplace_abn scripts/test_vistas_single_gpu.py"),
        (0.423, "CamVid", "github.com/veraz00/Efficient_Uncertainty_Estimation_for_Semantic_Segmentation_in_Videos"),
        (0.366, "CULane", "github.com/XiaomuWang/excellent_code_homework"),
    ),
    "contrast": (
        (0.189, "Cityscapes", "github.com/Lightning-Universe/lightning-bolts pl_bolts/datamodules"),
        (0.265, "Mapillary Vistas", "github.com/mapillary/inplace_abn scripts/test_vistas_single_gpu.py"),
        (0.283, "CamVid", "github.com/veraz00/Efficient_Uncertainty_Estimation_for_Semantic_Segmentation_in_Videos"),
        (0.290, "CULane", "github.com/XiaomuWang/excellent_code_homework"),
    ),
    "red_green": (
        (-0.038, "Cityscapes", "github.com/Lightning-Universe/lightning-bolts pl_bolts/datamodules"),
        (-0.040, "Mapillary Vistas", "github.com/mapillary/inplace_abn scripts/test_vistas_single_gpu.py"),
        (-0.013, "CamVid", "github.com/veraz00/Efficient_Uncertainty_Estimation_for_Semantic_Segmentation_in_Videos"),
        (-0.006, "CULane", "github.com/XiaomuWang/excellent_code_homework"),
    ),
    "blue_green": (
        (-0.041, "Cityscapes", "github.com/Lightning-Universe/lightning-bolts pl_bolts/datamodules"),
        (0.012, "Mapillary Vistas", "github.com/mapillary/inplace_abn scripts/test_vistas_single_gpu.py"),
        (0.008, "CamVid", "github.com/veraz00/Efficient_Uncertainty_Estimation_for_Semantic_Segmentation_in_Videos"),
        (0.001, "CULane", "github.com/XiaomuWang/excellent_code_homework"),
    ),
}


def rendered(bank: SceneBank, places: int, light: str) -> Iterator[np.ndarray]:
    """Images (h, w, 3) uint8 of all scenes of a bank, at places along its episodes, looking along the route.

    Args:
      places: per scene.
      light: `direct` or `baked`.
    """
    renderer = Renderer(bank, None, HEIGHT, WIDTH, shading="pbr", samples=2, light=light)
    for number in range(len(bank.scene_ids)):
        rng = np.random.default_rng(number)
        for row in rng.integers(0, bank.episode_start.shape[1], places):
            x, y, z, yaw = np.asarray(bank.episode_start[number, row], float)
            at = np.array([x, y, z + CAMERA_HEIGHT])
            ahead = at + 5.0 * np.array([math.cos(yaw), math.sin(yaw), 0.0])
            yield np.asarray(renderer.view(number, at, look_at(at, ahead), FOVY)["rgb"])


def images_of(path: pathlib.Path, places: int, light: str) -> Iterator[np.ndarray]:
    """Images (h, w, 3) uint8 of a folder, or rendered from a bank.

    Raises:
      ValidationError: a folder without images, or a file that is no bank.
    """
    if path.is_dir():
        files = sorted(f for f in path.rglob("*") if f.suffix.lower() in SUFFIXES)
        if not files:
            raise ValidationError(f"{path}: found no image, needed {', '.join(SUFFIXES)}; name another folder.")
        for file in files:
            yield np.asarray(Image.open(file).convert("RGB"))
        return
    yield from rendered(SceneBank.load(path), places, light)


def table(images: Iterator[np.ndarray]) -> dict[str, np.ndarray]:
    """Statistic -> (n,) values of all images."""
    rows = [statistics(image) for image in images]
    return {key: np.array([row[key] for row in rows]) for key in STATISTICS}


def quantiles(values: dict[str, np.ndarray]) -> dict[str, list[float]]:
    """Statistic -> its 10, 50 and 90 % quantiles."""
    return {key: [round(float(q), 4) for q in np.quantile(x, QUANTILES)] for key, x in values.items()}


def compared(values: dict[str, np.ndarray], reference: dict[str, list[float]]) -> dict[str, dict[str, float]]:
    """Statistic -> median, share of images within the reference's range, and gap of the median (0 within it)."""
    found = {}
    for key, x in values.items():
        low, _, high = reference[key]
        median = float(np.median(x))
        found[key] = {
            "median": round(median, 4),
            "within": round(float(((x >= low) & (x <= high)).mean()), 4),
            "gap": round(min(median - low, 0.0) + max(median - high, 0.0), 4),
        }
    return found


def families_of(texts: Sequence[str]) -> dict[str, pathlib.Path]:
    """Parses NAME=PATH ...

    Raises:
      ValidationError: an argument has another form, or there is no such file or folder.
    """
    found = {}
    for text in texts:
        name, equals, path = text.partition("=")
        if not (name and equals and pathlib.Path(path).exists()):
            raise ValidationError(f"family: found {text!r}, needed NAME=PATH with a bank or folder that exists.")
        found[name] = pathlib.Path(path)
    return found


def written(families: dict[str, dict[str, dict[str, float]]], reference: dict[str, list[float]]) -> str:
    """The table in Markdown."""
    head = ["statistic", "photographs (10, 50, 90 %)", *families, "other data sets"]
    rows = []
    for key, name in STATISTICS.items():
        low, middle, high = reference[key]
        cells = []
        for found in families.values():
            gap = found[key]["gap"]
            outside = f", gap {gap:+.3g}" if gap else ""
            cells.append(f"{found[key]['median']:.3g} ({100 * found[key]['within']:.0f} %{outside})")
        others = "; ".join(f"{value:.3g} {title}" for value, title, _ in PUBLISHED.get(key, ()))
        rows.append([name, f"{low:.3g}, {middle:.3g}, {high:.3g}", *cells, others])
    return markdown(head, rows)


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.realism_images", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("families", nargs="*", help="NAME=PATH: a bank, or a folder of images")
    parser.add_argument("--places", type=int, default=6, help="images of a scene")
    parser.add_argument("--light", default="baked", choices=("direct", "baked"))
    parser.add_argument("--out", type=pathlib.Path, help="table to write, .json beside it")
    parser.add_argument("--reference", type=pathlib.Path, help="folder of photographs whose quantiles are written")
    parser.add_argument("--named", default="", help="their source, written beside the quantiles")
    arguments = parser.parse_args(argv)
    try:
        if arguments.reference:
            values = table(images_of(arguments.reference, 0, ""))
            count = len(next(iter(values.values())))
            body = {"source": arguments.named, "images": count, "quantiles": quantiles(values)}
            write_json(REFERENCE, body)
            print(json.dumps(body))
            return 0
        reference = read_json(REFERENCE, "quantiles of photographs")["quantiles"]
        found = {
            name: compared(table(images_of(path, arguments.places, arguments.light)), reference)
            for name, path in families_of(arguments.families).items()
        }
    except ValidationError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    text = written(found, reference)
    if arguments.out:
        arguments.out.write_text(text + "\n", encoding="utf-8")
        write_json(arguments.out.with_suffix(".json"), found)
    print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
