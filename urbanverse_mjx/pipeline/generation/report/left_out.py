"""What a run left out, from the film to the last cousin, and why."""

import collections
import dataclasses
import pathlib
from collections.abc import Mapping
from typing import Any

from ....datatypes import Recording
from ....datatypes import validation as v


@dataclasses.dataclass(frozen=True)
class LeftOut:
    """what: the objects or frames; reason: a clause; where: the stage, or the cousins by number."""

    what: str
    reason: str
    where: str


#: What the reasons of `screening.screen` mean.
_SCREENED = {
    "dark": "too dark",
    "blurred": "blurred",
    "too fast": "the camera turned too fast",
    "static": "the camera did not move",
}


def left_out(run: pathlib.Path, recording: Recording | None, record: Mapping[str, Any]) -> list[LeftOut]:
    """All that a run left out, in the order of its stages.

    Raises:
      ValidationError: a file of the run's folder is damaged.
    """
    return [*_frames(run, recording), *_detections(run / "graph" / "evidence.json"), *_objects(record)]


def _frames(run: pathlib.Path, recording: Recording | None) -> list[LeftOut]:
    found = []
    path = run / "frames" / "frames.json"
    if recording is not None and path.is_file():
        dropped = v.read_json(path, "frames")["dropped"]
        for reason, times in _grouped(dropped).items():
            shown = ", ".join(f"{t:.1f}" for t in times[:6]) + (", ..." if len(times) > 6 else "")
            what = f"{counted(len(times), 'frame')} at {shown} s"
            found.append(LeftOut(what, _SCREENED.get(reason, reason), "frames"))
    lost = 0 if recording is None else len(recording) - len(recording.registered)
    if recording is not None and lost:
        what = f"{lost} of {counted(len(recording), 'frame')}"
        found.append(LeftOut(what, "no pose was found, so they add nothing to the graph", "poses"))
    return found


def _grouped(dropped: Any) -> dict[str, list[float]]:
    groups: dict[str, list[float]] = collections.defaultdict(list)
    for time, reason in dropped:
        groups[str(reason)].append(float(time))
    return groups


def _detections(path: pathlib.Path) -> list[LeftOut]:
    """Objects that were seen and are not in the graph; a graph that was given has no evidence."""
    if not path.is_file():
        return []
    body = v.read_json(path, "evidence of a graph")
    found = []
    if body.get("left_out"):
        what = counted(body["left_out"], "object")
        found.append(LeftOut(what, "seen in too few frames, or with too little confidence", "graph"))
    found += [LeftOut(f"{e['id']} ({e['label']})", e["reason"], "graph") for e in body.get("removed", ())]
    found += [LeftOut("1 object", sentence, "graph") for sentence in body.get("implausible", ())]
    return found


def _objects(record: Mapping[str, Any]) -> list[LeftOut]:
    reasons: dict[tuple[str, str, str], list[int]] = {}
    for k, cousin in enumerate(record["cousins"]):
        for gone in cousin["left_out"]:
            reasons.setdefault((gone["id"], gone["label"], gone["reason"]), []).append(k)
    found = []
    for (name, label, reason), numbers in reasons.items():
        every = len(numbers) == len(record["cousins"])
        where = "all cousins" if every else f"cousin {', '.join(map(str, numbers))}"
        found.append(LeftOut(f"{name} ({label})", reason, where))
    return found


def counted(number: int, name: str) -> str:
    """A number with the singular or plural of a name: "1 frame", "1,200 frames"."""
    return f"{number:,} {name}{'' if number == 1 else 's'}"
