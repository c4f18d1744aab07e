"""What the perception model sees under hard conditions, on rendered test streets with known truth.

    python -m benchmarks.perception_conditions --out conditions.csv
    python -m benchmarks.perception_conditions --weights perception.npz --streets 20 --frames 128 --out conditions.csv
    python -m benchmarks.perception_conditions --second-opinion nanodet --out opinion.csv

The streets are those of `perception_streets --split test`: no layout, no asset of leaves with three variants and no sky
was in training. Rows: all frames as they are; low light, the same frames at dusk and at night; distant objects, those
whose true distance is above `DISTANT`, beside the near ones; clutter, frames with `CLUTTER` objects or more, beside
the others; complex terrain, the same frames with the street on a slope, a pavement of steps on its left and the camera
at the same height over the ground. Frames have simulated camera faults, as in `train_perception`.

An object is found if a detected object of its class with a score of 0.5 or more covers it with a mask IoU above 0.5.
Intervals are 95 % bootstrap intervals over streets. Writes a CSV file and prints it as Markdown.
"""

import argparse
import csv
import dataclasses
import functools
import pathlib
import sys
from collections.abc import Callable, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from benchmarks import perception_streets
from benchmarks.bank import coarser, map_stride
from benchmarks.lib import hard_streets
from benchmarks.lib.resampling import with_interval
from benchmarks.lib.tables import markdown
from urbanverse_mjx.assets import load_index
from urbanverse_mjx.assets.appearances.skies import build_sky
from urbanverse_mjx.datatypes import SceneBank, SceneLayout, ValidationError
from urbanverse_mjx.datatypes.hashing import content_hash
from urbanverse_mjx.distillation.perception.published import fusion, groups
from urbanverse_mjx.distillation.perception.published.opinion import DETECTORS
from urbanverse_mjx.distillation.perception_model import classes, network, scales, score, weights
from urbanverse_mjx.distillation.perception_model.augment import augment
from urbanverse_mjx.distillation.perception_model.decode import Decoded
from urbanverse_mjx.distillation.perception_model.inference import MIN_SCORE
from urbanverse_mjx.distillation.perception_model.views import Views
from urbanverse_mjx.scene.bank import pack
from urbanverse_mjx.scene.compiler import scene_geometry

DISTANT = 30.0  # m
CLUTTER = 15  # objects of 25 pixels or more in a frame
#: What was found in an image (H, W, 3) u8 -> what is judged.
Change = Callable[[Decoded, np.ndarray], Decoded]
DAY = "all frames, by day, flat"
COLUMNS: tuple[str, ...] = (
    "condition",
    "frames",
    "objects",
    "recall",
    "recall_low",
    "recall_high",
    "precision",
    "precision_low",
    "precision_high",
    "recall_without_houses",
)


@dataclasses.dataclass(frozen=True)
class JudgedObject:
    """One true object or false detection: the street it is on, number of its frame, distance (m), class, whether it is
    true, whether it was found, and the true objects in its frame."""

    street: int
    frame: int
    distance: float
    kind: int
    true: bool
    found: bool
    around: int


def layouts(streets: int) -> list[SceneLayout]:
    """The test streets."""
    records = perception_streets.of_split("test", load_index())
    return [perception_streets.make_street("test", k, records)[0] for k in range(streets)]


def bank_of(condition: str, flat: Sequence[SceneLayout]) -> SceneBank:
    """The bank of the streets under a condition: "plain", "steep" or one of `hard_streets.SKIES`."""
    records = perception_streets.of_split("test", load_index())
    scenes = []
    for number, street in enumerate(flat):
        section = perception_streets.make_ground("test", number).section
        layout = street
        if condition in hard_streets.SKIES:
            layout = hard_streets.under_sky(street, condition, number)
        elif condition == "steep":
            layout = hard_streets.steep(street, section.half, records)
        geometry = scene_geometry(layout, records, perception_streets.source("test"))
        walk = perception_streets._walk(section)
        plan = coarser(geometry.map, map_stride(perception_streets.MAP_CELL))
        scenes.append(dataclasses.replace(geometry, map=plan, episodes=walk))
    skies = {name: build_sky(name) for name in sorted({s.sky for s in scenes})}
    hashes = {"bank": content_hash({"condition": condition, "streets": [s.content_hash() for s in flat]})}
    return pack(scenes, ["test"] * len(scenes), skies, hashes)


def raised(views: Views, flat: Views) -> Views:
    """The views of sloping streets with the camera positions of the flat ones, raised with the ground."""
    places = np.array(flat.places)
    for z in range(len(places)):
        half = perception_streets.make_ground("test", z).section.half
        x, y = places[z, ..., 0], places[z, ..., 1]
        places[z, ..., 2] += np.vectorize(functools.partial(hard_streets.rise, half=half))(x, y)
    return dataclasses.replace(views, places=jnp.asarray(places), weights=flat.weights)


def judged(
    seen: Decoded, kinds: np.ndarray, owner: np.ndarray, distance: np.ndarray, at: tuple[int, int]
) -> list[JudgedObject]:
    """True objects and false detections of a frame, by the rules of `score`.

    Args:
      kinds, owner: (h, w) true class and object, -1 = none.
      distance: (h, w) m along the camera's axis.
      at: street and number of the frame.
    """
    true, inverse, sizes = np.unique(owner, return_inverse=True, return_counts=True)
    inverse = inverse.reshape(owner.shape)
    kind_of = np.zeros(len(true), int)
    kind_of[inverse] = kinds
    asked = (true >= 0) & (sizes >= score.MIN_PIXELS) & (kind_of > classes.FIRST_OBJECT)
    counts = np.zeros((len(true), len(seen.objects)), int)
    inside = seen.masks >= 0
    np.add.at(counts, (inverse[inside], seen.masks[inside]), 1)
    areas = np.bincount(seen.masks[inside], minlength=len(seen.objects))
    iou = counts / np.maximum(sizes[:, None] + areas - counts, 1)
    predicted = np.array([x.kind for x in seen.objects], int)
    hit = (iou > score.MIN_IOU) & (kind_of[:, None] == predicted)
    around = int(asked.sum())

    def far(mask: np.ndarray) -> float:
        return float(np.median(distance[mask]))

    out = [
        JudgedObject(*at, far(inverse == row), int(kind_of[row]), True, bool(hit[row].any()), around)
        for row in np.flatnonzero(asked)
    ]
    excused = (counts[(true >= 0) & ~asked].sum(0) > 0.5 * areas) | (areas < score.MIN_PIXELS)
    for column in np.flatnonzero(~hit[asked].any(0) & ~excused):
        out.append(JudgedObject(*at, far(seen.masks == column), int(predicted[column]), False, False, around))
    return out


def look(
    variables: Any,
    views: Views,
    frames: int,
    batch: int,
    seed: int,
    changes: Sequence[Change] = (lambda found, rgb: found,),
) -> list[tuple[list[JudgedObject], int]]:
    """Results of seeded frames for each change of what was found, and the number of frames; without blocked ones."""
    model = weights.network(jnp.float32, network.blocks_of(variables))
    apply = jax.jit(lambda images: model.apply(variables, images, train=False))
    draw = jax.jit(lambda keys: (*views(keys, dye=False), *_pose(views, keys)))
    fault = jax.jit(jax.vmap(augment))
    out: list[list[JudgedObject]] = [[] for _ in changes]
    drawn = 0
    for start in range(0, frames, batch):
        keys = jax.random.split(jax.random.fold_in(jax.random.key(seed), start), batch)
        images, wanted, counts, scene, focal = draw(keys)
        shown = fault(keys, images)
        outputs = scales.outputs(apply, shown)
        for i in np.flatnonzero(np.asarray(counts)):
            fine, coarse = jax.tree.map(lambda x, i=i: np.asarray(x[i]), outputs)
            found = scales.decoded(fine, coarse, network.CANONICAL_FOCAL)
            rgb = np.round(np.clip(np.asarray(shown[i]), 0.0, 1.0) * 255.0).astype(np.uint8)
            # Targets of depth are those of the canonical camera.
            metres = (
                network.DEPTH_UNIT * np.exp(np.asarray(wanted.log_depth[i])) * float(focal[i]) / network.CANONICAL_FOCAL
            )
            kinds, owner = np.asarray(wanted.classes[i]), np.asarray(wanted.owner[i])
            at = (int(scene[i]), start + int(i))
            for change, rows in zip(changes, out, strict=True):
                rows += judged(change(found, rgb).surer(MIN_SCORE), kinds, owner, metres, at)
            drawn += 1
    return [(rows, drawn) for rows in out]


def _pose(views: Views, keys: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Scene and focal length (pixels) of each frame."""
    scene, _, _, fovy, _ = jax.vmap(views._pose)(keys)
    return scene, views.renderer.settings.height / (2.0 * jnp.tan(fovy / 2.0))


def row(name: str, chosen: Sequence[JudgedObject], streets: int, frames: int) -> dict[str, Any]:
    """Recall and precision with intervals over streets."""

    def of(test: Callable[[JudgedObject], bool]) -> np.ndarray:
        return np.bincount([x.street for x in chosen if test(x)], minlength=streets)

    there, found, false = of(lambda x: x.true), of(lambda x: x.found), of(lambda x: not x.true)
    recall, precision = with_interval(found, there), with_interval(found, found + false)
    small = [x for x in chosen if x.true and x.kind != classes.HOUSE]
    others = round(sum(x.found for x in small) / len(small), 3) if small else None
    values = (name, frames, int(there.sum()), *_three(recall), *_three(precision), others)
    return dict(zip(COLUMNS, values, strict=True))


def _three(share: list[float] | None) -> list[float | None]:
    return [*(share or []), None, None, None][:3]


def rows_of(seen: dict[str, tuple[list[JudgedObject], int]], streets: int) -> list[dict[str, Any]]:
    """A row for each condition and for what it is compared with."""
    plain, frames = seen["plain"]

    def part(name: str, test: Callable[[JudgedObject], bool]) -> dict[str, Any]:
        chosen = [x for x in plain if test(x)]
        return row(name, chosen, streets, len({x.frame for x in chosen}))

    return [
        row(DAY, plain, streets, frames),
        row("low light: dusk", seen["dusk"][0], streets, seen["dusk"][1]),
        row("low light: night", seen["night"][0], streets, seen["night"][1]),
        part(f"objects up to {DISTANT:g} m", lambda x: x.distance <= DISTANT),
        part(f"distant objects: above {DISTANT:g} m", lambda x: x.distance > DISTANT),
        part(f"frames of fewer than {CLUTTER} objects", lambda x: x.around < CLUTTER),
        part(f"clutter: frames of {CLUTTER} objects or more", lambda x: x.around >= CLUTTER),
        row("complex terrain: slope of 12 % and steps", seen["steep"][0], streets, seen["steep"][1]),
    ]


def with_detector(name: str) -> Change:
    """Fuses the boxes of a published detector.

    Raises:
      ValidationError: its weights were not fetched.
    """
    detector = DETECTORS[name]()
    return lambda found, rgb: fusion.fuse(found, groups.to_groups(detector(rgb)), rgb.shape[:2])


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.perception_conditions", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--weights", type=pathlib.Path, help="default: the shipped ones")
    parser.add_argument("--streets", type=int, default=20)
    parser.add_argument("--frames", type=int, default=128)
    parser.add_argument("--batch", type=int, default=4)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--second-opinion", choices=sorted(DETECTORS), help="compare frames by day with and without it")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="CSV file to write")
    arguments = parser.parse_args(argv)
    if min(arguments.streets, arguments.frames, arguments.batch) < 1:
        parser.error("--streets, --frames and --batch must be at least 1")
    try:
        variables, _ = weights.load(arguments.weights)
        flat = layouts(arguments.streets)
        seen: dict[str, tuple[list[JudgedObject], int]] = {}
        numbers = (arguments.frames, arguments.batch, arguments.seed)
        if arguments.second_opinion is not None:
            changes = (lambda found, rgb: found, with_detector(arguments.second_opinion))
            views = Views.of(bank_of("plain", flat), *network.SIZE, appearance=0.0)
            both = look(variables, views, *numbers, changes)
            names = (DAY, f"{DAY}, with {arguments.second_opinion}")
            return _write(
                arguments.out, [row(n, b, arguments.streets, k) for n, (b, k) in zip(names, both, strict=True)]
            )
        level = None
        for condition in ("plain", "dusk", "night", "steep"):
            views = Views.of(bank_of(condition, flat), *network.SIZE, appearance=0.0)
            level = level or views
            views = raised(views, level) if condition == "steep" else views
            seen[condition] = look(variables, views, *numbers)[0]
            sys.stderr.write(f"{condition}: {seen[condition][1]} frames\n")
    except ValidationError as error:
        sys.stderr.write(f"error: {error}\n")
        return 2
    return _write(arguments.out, rows_of(seen, arguments.streets))


def _write(path: pathlib.Path, rows: list[dict[str, Any]]) -> int:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    sys.stdout.write(markdown(list(COLUMNS), [["-" if x is None else str(x) for x in r.values()] for r in rows]) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
