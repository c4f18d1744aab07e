"""Renders one image per layout of a set of the library, for a judge who has to tell which city each one shows.

    python -m benchmarks.blind_judge --out FOLDER [--set urbanverse160] [--seed 0]
    python -m benchmarks.blind_judge --out FOLDER --answers FILE.json

The first command writes FOLDER/images/street_NN.png in random order and FOLDER/cities.txt, which are what the judge
gets (copied to where nothing else is), FOLDER/sheet.jpg with all images in the order of their names, and
FOLDER/key.json, which the judge must not see. Of each layout's cousins, the one with the brightest sky is shown, from
the place along the filmed trajectory, 1.6 m above the pavement, where buildings, sky and ground share the image
best; so the images are good views, not average ones. The set must be built and have the regional look.

The second compares answers, {"street_01.png": "City", ...}, with the key and prints one JSON line: how many are right,
of how many images, the 95 % Wilson interval (which takes answers as independent; those of a judge who uses each city
once are not quite), the confused pairs [shown, answered], images without an answer, and cities named more than once.
"""

import argparse
import collections
import json
import math
import pathlib
import random
import sys
import unicodedata
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from PIL import Image

from urbanverse_mjx.assets.appearances import skies
from urbanverse_mjx.assets.categories import ontology
from urbanverse_mjx.datatypes import SceneGraph, SceneLayout, ValidationError
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.evaluation.metrics import wilson_interval
from urbanverse_mjx.scene import library, pack_bank
from urbanverse_mjx.simulation.rendering.cameras import look_at
from urbanverse_mjx.simulation.rendering.renderer import Renderer

IMAGES, CITIES, KEY, SHEET = "images", "cities.txt", "key.json", "sheet.jpg"
#: Pixels of an image and of the images by which its camera is chosen; vertical angle, rad.
HEIGHT, WIDTH, SMALL_HEIGHT, SMALL_WIDTH, FOVY = 420, 640, 63, 96, 1.0
#: m: a camera above the pavement, how far ahead it looks, and how much higher.
CAMERA_HEIGHT, AHEAD, RISE = 1.6, 5.0, 0.4
#: Candidates: shares of the trajectory, and degrees to the left of it.
PLACES, ASIDE = np.linspace(0.12, 0.85, 9), (-45.0, -28.0, 28.0, 45.0)
#: Lowest and highest good shares of buildings, sky and ground in an image.
GOOD_SHARES = ((0.3, 0.55), (0.06, 0.3), (0.2, 0.4))
#: Least sine of the sun's height, as skies are exposed: walls face a low sun.
LOW_SUN = 0.35
#: Pixels of an image of the sheet, and how many are in a row.
TILE, ROW = (266, 175), 6


def white_level(sky: skies.Sky) -> float:
    """Luminance of a white diffuse surface in the open under a sky, in the unit of its radiance."""
    polar = (np.arange(skies.HEIGHT // 2) + 0.5) / skies.HEIGHT * np.pi
    edges = np.cos(np.arange(skies.HEIGHT // 2 + 1) / skies.HEIGHT * np.pi)
    weights = np.cos(polar) * (edges[:-1] - edges[1:]) * 2 * np.pi / skies.WIDTH
    upper = np.asarray(sky.radiance[: skies.HEIGHT // 2], np.float64).sum(1)
    sun = sky.sun_irradiance * max(float(sky.sun_direction[2]), LOW_SUN)
    return float((weights @ upper + sun) @ skies.LUMINANCE) / math.pi


def brightest_cousin(scenes: library.SceneSet, layout: str) -> tuple[pathlib.Path, SceneLayout]:
    """Folder and layout of the cousin with the brightest sky; of equal ones the first.

    Raises:
      ValidationError: a cousin is not built, or has no regional look.
    """
    root = library.folder(scenes.name) / library.SCENES
    folders = [root / scenes.scene_id(layout, k) for k in range(scenes.cousins)]
    missing = [folder.name for folder in folders if not (folder / "layout.json").is_file()]
    if missing:
        raise v.fail(
            f"set {scenes.name!r}",
            f"no scene {missing[0]} in the cache",
            f"all {scenes.cousins} of {layout}",
            f"run `urbanverse scene library {scenes.name}`",
        )
    cousins = [SceneLayout.load(folder / "layout.json") for folder in folders]
    if any(cousin.place is None for cousin in cousins):
        raise v.fail(
            f"layout {layout}", "no city", "scenes with the regional look", "name a set with it, such as urbanverse160"
        )
    best = max(range(len(cousins)), key=lambda k: white_level(skies.build_sky(cousins[k].sky)))
    return folders[best], cousins[best]


def cameras(path: np.ndarray, pavement: float) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Candidates: positions (3,), m, and rotations (4,) wxyz of cameras along a trajectory.

    Args:
      path: (n, 3) m, positions of the camera that filmed the street.
      pavement: m, height of the ground.
    """
    for share in PLACES:
        here = int(len(path) * share)
        along = path[min(here + 4, len(path) - 1), :2] - path[max(here - 4, 0), :2]
        at = np.array([*path[here, :2], pavement + CAMERA_HEIGHT])
        for aside in ASIDE:
            yaw = math.atan2(along[1], along[0]) + math.radians(aside)
            yield at, look_at(at, at + np.array([AHEAD * math.cos(yaw), AHEAD * math.sin(yaw), RISE]))


def composition(image: Mapping[str, np.ndarray], buildings: Sequence[int], grounds: Sequence[int]) -> float:
    """How well buildings, sky and ground share an image; higher is better.

    Several buildings count for it; shares outside `GOOD_SHARES`, one other object that fills the image, and objects
    within 2 m count against it.

    Args:
      image: "category" and "object" (h, w) rows, -1 for the sky, and "depth" (h, w) m.
      buildings, grounds: rows of these categories.
    """
    category, objects, depth = image["category"], image["object"], image["depth"]
    building, ground, sky = np.isin(category, buildings), np.isin(category, grounds), objects == -1
    shares = zip((building.mean(), sky.mean(), ground.mean()), GOOD_SHARES, strict=True)
    outside = sum(max(low - share, 0.0, share - high) for share, (low, high) in shares)
    other = np.unique(objects[~building & ~ground & ~sky], return_counts=True)[1].max(initial=0) / objects.size
    near = ((depth > 0) & (depth < 2.0) & ~ground).mean()
    visible = (np.unique(objects[building], return_counts=True)[1] > 0.015 * objects.size).sum()
    return float(0.06 * min(visible, 6) - 2.0 * outside - 1.5 * max(other - 0.12, 0.0) - 2.0 * near)


def views(folders: Sequence[pathlib.Path], paths: Sequence[np.ndarray]) -> Iterator[np.ndarray]:
    """The best view (420, 640, 3) uint8 of each compiled scene along its trajectory (n, 3)."""
    bank = pack_bank(folders, ["train"] * len(folders))
    names = bank.meta["categories"]
    top = {leaf: row[0] for leaf, row in ontology.categories().items()}
    buildings = [k for k, name in enumerate(names) if top.get(name) == "building"]
    grounds = [k for k, name in enumerate(names) if name.startswith("ground:")]
    small = Renderer(bank, None, SMALL_HEIGHT, SMALL_WIDTH, ("category", "object", "depth"), shading="matte")
    large = Renderer(bank, None, HEIGHT, WIDTH, shading="pbr", samples=2, light="baked")
    for number, path in enumerate(paths):
        candidates = list(cameras(path, float(np.median(bank.episode_start[number, :, 2]))))
        scores = []
        for at, turn in candidates:
            image = {name: np.asarray(x) for name, x in small.view(number, at, turn, FOVY).items()}
            scores.append(composition(image, buildings, grounds))
        yield np.asarray(large.view(number, *candidates[int(np.argmax(scores))], FOVY)["rgb"])


def file_names(count: int, seed: int) -> list[str]:
    """Names of the images of `count` layouts, in the layouts' order; the seed draws their numbers."""
    order = list(range(count))
    random.Random(seed).shuffle(order)
    return [f"street_{number + 1:02d}.png" for number in order]


def trajectory(path: pathlib.Path) -> np.ndarray:
    """(n, 3) m, positions of the camera that filmed a graph.

    Raises:
      ValidationError: the graph has none, or is damaged.
    """
    positions = np.array(SceneGraph.load(path).camera_path, float).reshape(-1, 4)[:, :3]
    if len(positions) < 2:
        raise v.fail(str(path), f"a trajectory of {len(positions)} positions", "at least two", "use a graph of a video")
    return positions


def render(name: str, seed: int, out: pathlib.Path, only: str = "") -> dict[str, dict[str, str]]:
    """Writes the images, cities, sheet and key of a set.

    Args:
      only: layouts with this in their id.

    Returns:
      the key: file of an image -> its layout, city, country, cousin and sky.

    Raises:
      ValidationError: no such set, or it is not built or has no regional look.
    """
    scenes = library.scene_set(name)
    graphs = {layout: path for layout, path in scenes.graphs().items() if only in layout}
    if not graphs:
        raise v.fail(
            f"set {name!r}", f"no graph of a video with {only!r} in its id", "some", "name another set or text"
        )
    shown = {layout: brightest_cousin(scenes, layout) for layout in graphs}
    paths = [trajectory(path) for path in graphs.values()]
    (out / IMAGES).mkdir(parents=True, exist_ok=True)
    images = views([folder for folder, _ in shown.values()], paths)
    key, by_file = {}, {}
    files = file_names(len(shown), seed)
    for file, (layout, (folder, cousin)), image in zip(files, shown.items(), images, strict=True):
        city, country = cousin.place or ("", "")
        key[file] = {"layout": layout, "city": city, "country": country, "cousin": folder.name, "sky": cousin.sky}
        by_file[file] = Image.fromarray(image)
        print(f"{len(key)}/{len(shown)} {layout}", file=sys.stderr, flush=True)
    # Written in the order of their names, so that times of files say nothing about layouts.
    for old in (out / IMAGES).glob("street_*.png"):
        old.unlink()
    key = dict(sorted(key.items()))
    for file in key:
        by_file[file].save(out / IMAGES / file)
    _sheet([by_file[file] for file in key]).save(out / SHEET, quality=85)
    cities = sorted({label(row) for row in key.values()})
    (out / CITIES).write_text("\n".join(cities) + "\n", encoding="utf-8")
    v.write_json(out / KEY, key)
    return key


def _sheet(images: Sequence[Image.Image]) -> Image.Image:
    """All images, reduced, in rows."""
    sheet = Image.new("RGB", (TILE[0] * min(ROW, len(images)), TILE[1] * math.ceil(len(images) / ROW)))
    for k, image in enumerate(images):
        sheet.paste(image.resize(TILE, Image.Resampling.LANCZOS), (TILE[0] * (k % ROW), TILE[1] * (k // ROW)))
    return sheet


def label(row: Mapping[str, str]) -> str:
    """City (Country), as in `cities.txt`."""
    return f"{row['city']} ({row['country']})"


def _plain(text: str) -> str:
    """A city's letters without accents, spaces, capitals and the country in parentheses."""
    plain = unicodedata.normalize("NFKD", text.partition("(")[0]).casefold()
    return "".join(letter for letter in plain if letter.isalnum())


def compared(answers: Mapping[str, Any], key: Mapping[str, Mapping[str, str]]) -> dict[str, Any]:
    """Compares answers with a key.

    Args:
      answers: file of an image -> city, with or without "(Country)". Accents, spaces and capitals do not count. An
        image without an answer counts as wrong; a city may be named more than once.
      key: file -> "city" and "country".

    Returns:
      "right", "of", "interval" (95 %, Wilson), "confused" [shown, answered] cities, "unanswered" files, and "repeated"
      cities.

    Raises:
      ValidationError: an answer for an image, or with a city, that the key does not have.
    """
    cities = {_plain(row["city"]): label(row) for row in key.values()}
    said = {}
    for file, answer in answers.items():
        v.choice(file, "answers: image", tuple(key))
        text = v.text(answer, f"answers: {file}")
        if _plain(text) not in cities:
            raise v.fail(f"answers: {file}", repr(text), f"one of the {len(cities)} cities", f"see {CITIES}")
        said[file] = cities[_plain(text)]
    right = sum(said.get(file) == label(row) for file, row in key.items())
    low, high = wilson_interval(right, len(key))
    return {
        "right": right,
        "of": len(key),
        "interval": [round(low, 3), round(high, 3)],
        "confused": [[label(row), said[f]] for f, row in key.items() if f in said and said[f] != label(row)],
        "unanswered": [file for file in key if file not in said],
        "repeated": sorted(city for city, count in collections.Counter(said.values()).items() if count > 1),
    }


def _read(path: pathlib.Path, kind: str) -> dict[str, Any]:
    rows = v.read_json(path, kind)
    if not isinstance(rows, dict) or not rows:
        raise v.fail(str(path), v.show(rows), "a JSON object with a row per image")
    return rows


def _read_key(path: pathlib.Path) -> dict[str, dict[str, str]]:
    rows = _read(path, "blind test's key")
    for file, row in rows.items():
        fields = v.mapping(row, f"{path}: {file}", ("layout", "city", "country", "cousin", "sky"))
        for name, text in fields.items():
            v.text(text, f"{path}: {file}: {name}")
    return rows


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.blind_judge", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--out", type=pathlib.Path, required=True, help="folder of the images and the key")
    parser.add_argument("--set", default="urbanverse160", help="set of the library, with the regional look")
    parser.add_argument("--only", default="", help="layouts with this in their id")
    parser.add_argument("--seed", type=int, default=0, help="of the images' order")
    parser.add_argument("--answers", type=pathlib.Path, help="answers to compare with the key in the folder")
    arguments = parser.parse_args(argv)
    try:
        if arguments.answers:
            answers = _read(arguments.answers, "judge's answers")
            print(json.dumps(compared(answers, _read_key(arguments.out / KEY)), ensure_ascii=False))
        else:
            key = render(arguments.set, arguments.seed, arguments.out, arguments.only)
            print(json.dumps({"images": len(key), "out": str(arguments.out)}))
    except ValidationError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"error: {error.filename}: {error.strerror}; needed a folder to write to; name another.", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
