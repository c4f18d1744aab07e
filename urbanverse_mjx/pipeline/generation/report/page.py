"""`report.html`: the page that a user opens after `urbanverse gen`. It needs no server and no other file."""

import colorsys
import dataclasses
import html
import json
import pathlib
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ....datatypes import Recording, SceneBank, SceneGraph, ValidationError
from ....datatypes import validation as v
from ....viz.images import Studio
from .. import compiling
from ..sources import Input
from . import data_urls, films, from_above, thumbnails
from .cameras import Shot, Shots, shots_of
from .left_out import counted, left_out

#: Pixels of a cousin's image from above, and elevation of its camera (rad).
ABOVE_SIZE, ELEVATION = (1000, 460), np.radians(78.0)
#: Step of the hue from one label to the next.
_GOLDEN = 0.381966
_NO_IMAGES = "Images of the cousins and their assets were not asked for (--no-pictures)."

Progress = Callable[[int, int], None]


@dataclasses.dataclass
class _Run:
    """What the page is made of.

    Attributes:
      folder: of the run. scratch: for temporary files.
      record, checks: contents of materialisation.json, and of each cousin's check.json.
      notes: part of the page -> sentences about what it lacks.
    """

    folder: pathlib.Path
    scratch: pathlib.Path
    graph: SceneGraph
    recording: Recording | None
    record: Mapping[str, Any]
    checks: Sequence[Mapping[str, Any]]
    notes: dict[str, list[str]]

    def attempt[T](self, part: str, make: Callable[[], T], otherwise: T) -> T:
        """Makes a part of the page; a damaged file becomes a sentence on the page and not the end of the run."""
        try:
            return make()
        except (ValidationError, OSError, KeyError, TypeError) as error:
            said = str(error) if isinstance(error, ValidationError | OSError) else f"a record without {error}"
            self.note(part, f"This part is missing: {said}")
            return otherwise

    def note(self, part: str, sentence: str) -> None:
        """Adds a sentence to a part of the page; an empty one adds nothing."""
        if sentence:
            self.notes.setdefault(part, []).append(sentence)


def write_report(
    run: pathlib.Path,
    scratch: pathlib.Path,
    given: Input,
    recorded: pathlib.Path | None,
    with_images: bool,
    seconds: Mapping[str, float],
    progress: Progress,
) -> str:
    """The page as HTML.

    Args:
      run: folder of the run, after all earlier stages.
      scratch: folder for temporary files.
      given: source of the run.
      recorded: folder of the recording; None for a graph.
      with_images: whether cousins and assets are rendered.
      seconds: duration of each stage.
      progress: called with (images done, images in all).

    Raises:
      ValidationError: the graph or the records of the cousins are damaged. What else is missing is said on the page.
    """
    record = v.read_json(run / "materialisation.json", "record of cousins")
    folders = [run / "cousins" / str(k) for k in range(len(record["cousins"]))]
    checks = [v.read_json(folder / compiling.CHECK, "check of a cousin") for folder in folders]
    graph = SceneGraph.load(run / "graph" / "graph.json")
    made = _Run(run, scratch, graph, None, record, checks, {})
    if recorded is None:
        made.note("film", "The source is a scene graph, so there is no film to compare with.")
    else:
        made.recording = made.attempt("film", lambda: Recording.load(recorded), None)
    colours = colours_of(_labels(graph, made.recording))
    shots = shots_of(graph, made.recording)
    made.note("cousin", shots.missing)
    body = {
        "frames": _frames(shots),
        "lens": dataclasses.asdict(shots.camera),
        "colours": colours,
        **_film(made, shots, colours),
        **_cousins(made, shots, with_images, progress),
        **_objects(made, with_images),
    }
    return _filled(
        title=html.escape(graph.id),
        facts=_facts(graph, given, record, seconds),
        map=_map(made, colours),
        legend=_legend(graph, colours),
        left=made.attempt("left", lambda: _left(made), ""),
        checks=_placement(record, checks),
        appearances=made.attempt("appearances", lambda: _appearances(record, with_images), ""),
        **{f"{part}_notes": _sentences(made, part) for part in _PARTS},
        # "</script>" in a name would end the data.
        data=json.dumps(body, ensure_ascii=False).replace("<", "\\u003c"),
    )


_PARTS = ("film", "cousin", "map", "objects", "left", "appearances")


def colours_of(labels: Sequence[str]) -> dict[str, str]:
    """A CSS colour (#rrggbb) for each label; neighbours in the list differ most."""
    colours = {}
    for k, label in enumerate(labels):
        rgb = colorsys.hsv_to_rgb(k * _GOLDEN % 1.0, (0.8, 0.55)[k % 2], (0.8, 0.95)[k // 2 % 2])
        colours[label] = "#" + "".join(f"{round(255 * c):02x}" for c in rgb)
    return colours


def _labels(graph: SceneGraph, recording: Recording | None) -> list[str]:
    seen = () if recording is None else (d.label for frame in recording.frames for d in frame.detections)
    return sorted({*seen, *(obj.label for obj in graph.objects)})


def _filled(**parts: str) -> str:
    template = (pathlib.Path(__file__).parent / "page.html").read_text(encoding="utf-8")
    # In one pass, so that no text of a part is taken for the name of another.
    return re.sub(r"__([A-Z_]+?)__", lambda found: parts[found[1].lower()], template)


def _sentences(made: _Run, part: str) -> str:
    return "".join(f'<p class="note">{html.escape(sentence)}</p>' for sentence in made.notes.get(part, ()))


# Data of the script ---------------------------------------------------------------------------------------------------


def _frames(shots: Shots) -> list[dict[str, Any]]:
    return [{"number": s.number, "time": round(s.time_s, 2), **_camera(s)} for s in shots.shots]


def _camera(shot: Shot) -> dict[str, Any]:
    """Place (x, y, yaw) and the 12 numbers of T_camera_world by rows, or None."""
    if shot.pose is None:
        return {"place": None, "matrix": None}
    turn = shot.pose[:3, :3].T
    matrix = np.column_stack([turn, -turn @ shot.pose[:3, 3]])
    ahead = shot.pose[:3, 2]
    place = [*shot.pose[:2, 3], np.arctan2(ahead[1], ahead[0])]
    return {"place": np.round(place, 4).tolist(), "matrix": np.round(matrix, 5).ravel().tolist()}


def _film(made: _Run, shots: Shots, colours: dict[str, str]) -> dict[str, Any]:
    recording = made.recording
    filmed = None
    if recording is not None:
        filmed = made.attempt("film", lambda: films.film_recording(recording, shots, colours, made.scratch), None)
    if recording is None or filmed is None:
        return {"films": {}, "seen": []}
    for sentence in filmed.damaged[:5]:
        made.note("film", sentence)
    made.note("film", f"{len(filmed.damaged) - 5} more frames cannot be read." if len(filmed.damaged) > 5 else "")
    posed, shown = len(recording.registered), len(shots.shots)
    less = f"; {shown} of them are shown" if shown < len(recording) else ""
    made.note("film", f"{counted(len(recording), 'frame')}, {posed} with a pose{less}.")
    if filmed.masked is None:
        made.note("film", "The recording has no masks, so there are no detections to show.")
    shown_films = {"frames": filmed.frames, "frames with masks and ground": filmed.masked}
    seen = [
        [[*(round(x, 1) for x in found.box), found.label, round(found.score, 3)] for found in row]
        for row in filmed.seen
    ]
    return {"films": {name: _video(film) for name, film in shown_films.items() if film is not None}, "seen": seen}


def _rounded(found: films.Seen) -> list[Any]:
    return [*(round(x, 1) for x in found.box), found.label, round(found.score, 3)]


def _video(film: films.Film) -> dict[str, Any]:
    return {"mp4": data_urls.of_bytes(film.mp4, "video/mp4"), "rows": film.rows}


def _cousins(made: _Run, shots: Shots, with_images: bool, progress: Progress) -> dict[str, Any]:
    names = [cousin["id"] for cousin in made.record["cousins"]]
    if not with_images:
        made.note("cousin", _NO_IMAGES)
    filmed = None
    if with_images:
        filmed = made.attempt("cousin", lambda: _rendered(made, shots, progress), None)
    cousins = []
    for k, name in enumerate(names):
        cousin: dict[str, Any] = {"id": name, "film": None, "above": None}
        if filmed is not None:
            cousin |= {"above": filmed[1][k], "film": _video(filmed[0][k]) if filmed[0] else None}
        cousins.append(cousin)
    posed = sum(shot.pose is not None for shot in shots.shots)
    if filmed is not None and filmed[0] and len(filmed[0][0].rows) < posed:
        count = len(filmed[0][0].rows)
        made.note("cousin", f"{count} of {posed} frames are rendered for each cousin; the nearest of them is shown.")
    return {"cousins": cousins, "rate": films.RATE}


def _rendered(made: _Run, shots: Shots, progress: Progress) -> tuple[list[films.Film], list[str]]:
    """Films of the cousins (none without a pose), and their images from above."""
    bank = SceneBank.load(made.folder / "bank.npz")
    total = bank.num_scenes * (1 + len(films.rendered_rows(shots, bank.num_scenes)))
    studio = Studio(bank, *ABOVE_SIZE, samples=films.SAMPLES)
    above = []
    for scene in range(bank.num_scenes):
        above.append(data_urls.jpeg(studio.birdseye(scene, ELEVATION)))
        progress(scene + 1, total)
    return films.film_cousins(bank, shots, made.scratch, lambda done, _: progress(bank.num_scenes + done, total)), above


def _objects(made: _Run, with_images: bool) -> dict[str, Any]:
    graph, record = made.graph, made.record
    evidence = made.attempt("objects", lambda: _evidence(made.folder / "graph" / "evidence.json"), {})
    crops = thumbnails.of_crops(made.folder / "graph" / "crops" / "objects", [obj.id for obj in graph.objects])
    assets = thumbnails.Thumbnails({})
    if with_images:
        assets = made.attempt("objects", lambda: _assets(made), assets)
    for sentence in (crops.missing, assets.missing, "" if with_images else _NO_IMAGES):
        made.note("objects", sentence)
    rows = []
    for obj in graph.objects:
        seen = evidence.get(obj.id, {})
        rows.append(
            {
                "id": obj.id,
                "label": obj.label,
                "score": round(obj.score, 3),
                "yaw": obj.yaw,
                "center": obj.center,
                "size": obj.size,
                "crop": crops.of.get(obj.id),
                **{name: seen.get(name) for name in ("views", "first", "last")},
                "chosen": [_chosen(match) for match in record["matches"].get(obj.id, ())],
                "left_out": [_reason(cousin, obj.id) for cousin in record["cousins"]],
            }
        )
    return {"objects": rows, "assets": dict(assets.of)}


def _evidence(path: pathlib.Path) -> dict[str, Mapping[str, Any]]:
    if not path.is_file():
        return {}
    return {entry["id"]: entry for entry in v.read_json(path, "evidence of a graph")["objects"]}


def _assets(made: _Run) -> thumbnails.Thumbnails:
    matches = made.record["matches"].values()
    cousins = range(len(made.record["cousins"]))
    stored = [compiling.load_assets(made.folder / "cousins" / str(k)).records for k in cousins]
    uids = [[found[k]["uid"] for found in matches if found[k]] for k in cousins]
    records = thumbnails.unique_records([{r.uid: r for r in records} for records in stored], uids)
    return thumbnails.of_assets(records)


def _chosen(match: Mapping[str, Any] | None) -> dict[str, Any] | None:
    return None if match is None else {name: match[name] for name in ("uid", "distortion", "look")}


def _reason(cousin: Mapping[str, Any], name: str) -> str | None:
    return next((gone["reason"] for gone in cousin["left_out"] if gone["id"] == name), None)


# Parts without script -------------------------------------------------------------------------------------------------


def _facts(graph: SceneGraph, given: Input, record: Mapping[str, Any], seconds: Mapping[str, float]) -> str:
    source = graph.source
    placed = ", ".join(str(cousin["placed"]) for cousin in record["cousins"])
    stages = [(name, s) for name, s in seconds.items() if "/" not in name]
    rows = {
        "source": f"{given.kind} {given.path.name}",
        "recorded in": f"{source.city}, {source.country}; licence {source.licence}",
        "graph": f"{counted(len(graph.objects), 'object')}, {counted(len(graph.ground), 'piece')} of ground",
        "cousins": f"{len(record['cousins'])}, with {placed} objects placed",
        "time": f"{sum(s for _, s in stages):.0f} s: " + ", ".join(f"{name} {s:.1f}" for name, s in stages),
    }
    return _table([], [(name, html.escape(text)) for name, text in rows.items()])


def _map(made: _Run, colours: dict[str, str]) -> str:
    image = None
    if made.recording is not None:
        recording = made.recording
        image = made.attempt(
            "map", lambda: data_urls.png(from_above.seen_from_above(recording, from_above.extent(made.graph))), None
        )
    return from_above.svg(made.graph, colours, image)


def _legend(graph: SceneGraph, colours: Mapping[str, str]) -> str:
    labels = sorted({obj.label for obj in graph.objects})
    return "".join(f'<span><i style="background:{colours[n]}"></i>{html.escape(n)}</span>' for n in labels)


def _left(made: _Run) -> str:
    entries = left_out(made.folder, made.recording, made.record)
    if not entries:
        return "<p>Nothing: every frame has a pose, and every object of the graph is placed in every cousin.</p>"
    rows = [(html.escape(e.what), html.escape(e.reason), html.escape(e.where)) for e in entries]
    return _table(("what", "why", "where"), rows)


def _placement(record: Mapping[str, Any], checks: Sequence[Mapping[str, Any]]) -> str:
    columns = ("cousin", "placed", "left out", "moved (most, m)", "still overlapping", "movable", "hulls", "at rest")
    rows = []
    for cousin, check in zip(record["cousins"], checks, strict=True):
        low, high = check["goals_m"]
        rest = f"all stay for 2 s; goals {low:g} to {high:g} m away"
        if check["kept_fixed"]:
            rest += f"; kept fixed, because they would fall: {', '.join(map(html.escape, check['kept_fixed']))}"
        most = max((m for _, m in cousin["moved"]), default=0.0)
        pairs = "; ".join(" and ".join(map(html.escape, p)) for p in cousin["unresolved"]) or "none"
        numbers = (cousin["placed"], len(cousin["left_out"]), f"{len(cousin['moved'])} ({most:.2f})", pairs)
        rows.append((html.escape(cousin["id"]), *numbers, check["movable"], check["hulls"], rest))
    raised = record["raised"]
    note = (
        f"Kerbs were put under {', '.join(map(html.escape, raised))}." if raised else "The graph's own kerbs were kept."
    )
    return f'<p class="small">{note}</p>{_table(columns, rows)}'


def _appearances(record: Mapping[str, Any], with_images: bool) -> str:
    uids = [appearance["uid"] for piece in record["ground"] for appearance in piece["materials"]]
    uids += [appearance["uid"] for appearance in record["skies"]]
    images = thumbnails.of_appearances(uids).of if with_images else {}
    rows = []
    for piece in record["ground"]:
        regions = (
            f"{html.escape(piece['kind'])}<br><span class='small'>{counted(len(piece['regions']), 'region')}</span>"
        )
        rows.append((regions, *(_appearance(appearance, images) for appearance in piece["materials"])))
    rows.append(("sky", *(_appearance(appearance, images) for appearance in record["skies"])))
    return _table(("", *(f"cousin {k}" for k in range(len(record["skies"])))), rows)


def _appearance(appearance: Mapping[str, Any], images: Mapping[str, str]) -> str:
    distance = "not seen" if appearance["distance"] is None else f"distance {appearance['distance']:.3f}"
    uid = appearance["uid"]
    image = f'<img class="thumb" src="{images[uid]}" alt="">' if uid in images else ""
    return f"{image}<span class='small'>{html.escape(uid)}<br>{distance}</span>"


def _table(columns: Sequence[str], rows: Sequence[Sequence[Any]]) -> str:
    head = "<tr>" + "".join(f"<th>{c}</th>" for c in columns) + "</tr>" if columns else ""
    lines = "".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table>{head}{lines}</table>"
