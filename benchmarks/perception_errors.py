"""Why the perception model misses objects: recall by thickness, size and distance, and with parts of the truth.

    python -m benchmarks.perception_errors --streets perception_test.npz [--weights perception.npz]

Frames are those of `train_perception --minutes 0 --seed 0 --test-frames 64 --test-batch 4`. For objects other than
houses the table has the share found (mask IoU above 0.5, right class, score of 0.5 or more), the share found whatever
the score, the share whose mask is found whatever the class, and the share of pixels that belong to any object for the
network. The second table replaces outputs by the truth: where a part of the truth raises recall, that output limits it.
Prints Markdown.
"""

import argparse
import dataclasses
import pathlib
import sys
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from benchmarks.lib.tables import markdown
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.distillation.perception_model import classes, network, score, weights
from urbanverse_mjx.distillation.perception_model.augment import augment
from urbanverse_mjx.distillation.perception_model.decode import Decoded, decode
from urbanverse_mjx.distillation.perception_model.inference import MIN_SCORE
from urbanverse_mjx.distillation.perception_model.network import OFFSET_UNIT, Seen
from urbanverse_mjx.distillation.perception_model.targets import MIN_PIXELS
from urbanverse_mjx.distillation.perception_model.views import Views

#: Upper bounds of the groups: thickness (area over the longer side) and area in output pixels, distance in m.
THICKNESS, AREA, DISTANCE = (2.5, 4.0, 7.0, 15.0), (50, 100, 200, 500), (5.0, 10.0, 20.0, 40.0)


class Frame(NamedTuple):
    """Outputs for one image, and the truth: (h, w) classes, owner (-1 = none), depth m."""

    seen: Seen
    kinds: np.ndarray
    owner: np.ndarray
    depth: np.ndarray


@dataclasses.dataclass(frozen=True)
class Missed:
    """One true object: class, area in output pixels, thickness, distance in m; IoU of the detected object that covers
    it best, that object's class (-1 = none) and score; and the share of its pixels that are of any object."""

    kind: int
    area: int
    thickness: float
    distance: float
    iou: float
    found_kind: int
    score: float
    as_object: float


def frames_of(bank: SceneBank, path: pathlib.Path | None, frames: int, batch: int, seed: int) -> Iterator[Frame]:
    """Outputs for seeded frames of a bank that show an object."""
    variables, _ = weights.load(path)
    model = weights.network(jnp.float32, network.blocks_of(variables))
    views = Views.of(bank, *network.SIZE, appearance=0.0)
    apply = jax.jit(lambda images: model.apply(variables, images, train=False))
    draw = jax.jit(lambda keys: views(keys, dye=False))
    fault = jax.jit(jax.vmap(augment))
    for start in range(0, frames, batch):
        keys = jax.random.split(jax.random.fold_in(jax.random.key(seed + 1), start), batch)
        images, wanted, counts = draw(keys)
        outputs = apply(fault(keys, images))
        for i in np.flatnonzero(np.asarray(counts)):
            seen = jax.tree.map(lambda x, i=i: np.asarray(x[i]), outputs)
            depth = network.DEPTH_UNIT * np.exp(np.asarray(wanted.log_depth[i]))
            yield Frame(seen, np.asarray(wanted.classes[i]), np.asarray(wanted.owner[i]), depth)


def objects_of(frame: Frame, found: Decoded) -> list[Missed]:
    """All true objects of a frame that `score` asks for."""
    out = []
    as_object = frame.seen.classes.argmax(-1) >= classes.FIRST_OBJECT
    areas = np.bincount(found.masks[found.masks >= 0], minlength=len(found.objects))
    for number in np.unique(frame.owner[frame.owner >= 0]):
        mask = frame.owner == number
        area, kind = int(mask.sum()), int(frame.kinds[mask][0])
        if area < score.MIN_PIXELS or kind <= classes.FIRST_OBJECT:
            continue
        rows, columns = np.nonzero(mask)
        thickness = area / (max(np.ptp(rows), np.ptp(columns)) + 1)
        inside = found.masks[mask]
        shared = np.bincount(inside[inside >= 0], minlength=len(found.objects))
        iou = shared / np.maximum(area + areas - shared, 1)
        best = int(iou.argmax()) if len(iou) else -1
        kind_there, sure, most = -1, 0.0, 0.0
        if best >= 0 and iou[best] > 0:
            kind_there, sure, most = found.objects[best].kind, found.objects[best].score, float(iou[best])
        distance = float(np.median(frame.depth[mask]))
        out.append(Missed(kind, area, thickness, distance, most, kind_there, sure, float(as_object[mask].mean())))
    return out


def with_reference(frame: Frame) -> dict[str, Seen]:
    """The outputs with parts replaced by those of the rendered labels, by name."""
    offset, centre, has_centre = _centres(frame.owner)
    right = 8.0 * np.identity(len(classes.names()), np.float32)[frame.kinds]
    offset = np.where(has_centre[..., None], offset, frame.seen.offset)
    # Right about whether a pixel is of an object, with the network's choice among objects and among surfaces.
    is_object = (frame.kinds >= classes.FIRST_OBJECT)[..., None]
    wrong = is_object != (np.arange(len(classes.names())) >= classes.FIRST_OBJECT)
    parted = np.where(wrong, frame.seen.classes - 100.0, frame.seen.classes)
    return {
        "none": frame.seen,
        "centres": frame.seen._replace(centre=centre),
        "offsets": frame.seen._replace(offset=offset),
        "centres and offsets": frame.seen._replace(centre=centre, offset=offset),
        "centres, offsets, object or not": frame.seen._replace(classes=parted, centre=centre, offset=offset),
        "classes": frame.seen._replace(classes=right),
    }


def _centres(owner: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Offsets (h, w, 2), centre map, and where there are any."""
    offset = np.zeros((*owner.shape, 2), np.float32)
    centre = np.zeros(owner.shape, np.float32)
    for number in np.unique(owner[owner >= 0]):
        at = np.argwhere(owner == number)
        if len(at) >= MIN_PIXELS:
            middle = at.mean(0)
            offset[tuple(at.T)] = (middle - at) / OFFSET_UNIT
            centre[tuple(np.round(middle).astype(int))] = 1.0
    sizes = np.bincount(owner[owner >= 0], minlength=1)
    return offset, centre, (owner >= 0) & (sizes[np.maximum(owner, 0)] >= MIN_PIXELS)


def by_group(objects: list[Missed]) -> list[dict[str, Any]]:
    """A row per group of objects other than houses."""
    others = [x for x in objects if x.kind != classes.HOUSE]
    groups: dict[str, list[Missed]] = {"houses": [x for x in objects if x.kind == classes.HOUSE], "others": others}
    for name, bounds, unit in (("thickness", THICKNESS, "px"), ("area", AREA, "px"), ("distance", DISTANCE, "m")):
        for low, high in zip((0.0, *bounds), (*bounds, np.inf), strict=True):
            label = f"{name} {low:g} to {high:g} {unit}" if np.isfinite(high) else f"{name} from {low:g} {unit}"
            groups[label] = [x for x in others if low <= getattr(x, name) < high]
    return [_row(label, members) for label, members in groups.items() if members]


def _row(label: str, members: list[Missed]) -> dict[str, Any]:
    mask = np.array([x.iou > score.MIN_IOU for x in members])
    right = mask & np.array([x.found_kind == x.kind for x in members])
    sure = np.array([x.score >= MIN_SCORE for x in members])
    return {
        "objects": label,
        "number": len(members),
        "found": f"{(right & sure).mean():.2f}",
        "whatever the score": f"{right.mean():.2f}",
        "whatever the class": f"{mask.mean():.2f}",
        "pixels of an object": f"{np.mean([x.as_object for x in members]):.2f}",
    }


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.perception_errors", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--streets", type=pathlib.Path, required=True, help="bank of streets")
    parser.add_argument("--weights", type=pathlib.Path, help="default: the shipped ones")
    parser.add_argument("--frames", type=int, default=64)
    parser.add_argument("--batch", type=int, default=4)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args(argv)
    objects: list[Missed] = []
    counts: dict[str, score.Score] = {}
    try:
        bank = SceneBank.load(arguments.streets)
        for frame in frames_of(bank, arguments.weights, arguments.frames, arguments.batch, arguments.seed):
            for name, seen in with_reference(frame).items():
                found = decode(seen, network.CANONICAL_FOCAL)
                unknown = np.full(frame.owner.shape, -1)
                counts.setdefault(name, score.Score()).add(found, frame.kinds, frame.owner, 0.0 * frame.depth, unknown)
                if name == "none":
                    objects += objects_of(frame, found)
    except ValidationError as error:
        sys.stderr.write(f"error: {error}\n")
        return 2
    rows = [{"truth given": name, **_recalls(count)} for name, count in counts.items()]
    sys.stdout.write("\n\n".join(_table(part) for part in (by_group(objects), rows) if part) + "\n")
    return 0


def _table(rows: Sequence[dict[str, Any]]) -> str:
    return markdown(list(rows[0]), [[str(x) for x in row.values()] for row in rows])


def _recalls(count: score.Score) -> dict[str, str]:
    others = np.arange(len(count.found)) != classes.HOUSE
    there = count.found + count.missed
    return {
        "others found whatever the score": f"{count.found[others].sum() / max(there[others].sum(), 1):.2f}",
        "houses": f"{count.found[~others].sum() / max(there[~others].sum(), 1):.2f}",
    }


if __name__ == "__main__":
    sys.exit(main())
