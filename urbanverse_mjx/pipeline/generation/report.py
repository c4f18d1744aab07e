"""`report.html`: detected objects, chosen assets and built scenes of a run, with images."""

import colorsys
import hashlib
import html
import json
import pathlib
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from PIL import Image

from ...datatypes import Recording, SceneBank, SceneGraph
from . import report_images, report_map
from .sources import Input

#: Largest number of matches with images; the others are in materialisation.json.
MATCH_ROWS = 16
FOLDER = "report"
_STYLE = """
body{font:15px/1.45 system-ui,sans-serif;margin:0 auto;max-width:1500px;padding:1.2em;color:#22262b;background:#fafaf8}
h1{font-size:1.7em;margin:.2em 0}h2{margin:1.6em 0 .4em;border-bottom:1px solid #d5d3cc;padding-bottom:.15em}
table{border-collapse:collapse}td,th{padding:.2em .7em;text-align:left;vertical-align:top;border-top:1px solid #e4e2dc}
th{font-weight:600}figure{margin:0}figcaption{font-size:.85em;color:#5b616a}.row{display:grid;gap:.5em}
img{width:100%;display:block;border-radius:3px}.thumb{width:110px}.map{width:100%;background:#eceae4;border-radius:3px}
.small{font-size:.85em;color:#5b616a}code{font-size:.9em}.legend span{display:inline-block;margin-right:.9em}
.legend i{display:inline-block;width:.8em;height:.8em;margin-right:.3em;border-radius:2px}.scroll{overflow-x:auto}
"""


def write_report(
    run: pathlib.Path,
    folder: pathlib.Path,
    given: Input,
    recorded: pathlib.Path | None,
    with_images: bool,
    seconds: Mapping[str, float],
    progress: Callable[[int, int], None],
) -> str:
    """Draws the report's images into a folder (later `report/`) and returns the HTML page.

    Args:
      run: folder of the run, after all earlier stages.
      given: source of the run.
      recorded: folder of the recording.
      seconds: duration of each stage.
      progress: called with (images done, images in all).
    """
    graph = SceneGraph.load(run / "graph" / "graph.json")
    record = json.loads((run / "materialisation.json").read_text(encoding="utf-8"))
    checks = [
        json.loads((run / "cousins" / str(k) / "check.json").read_text(encoding="utf-8"))
        for k in range(len(record["cousins"]))
    ]
    colours = {label: colour_of(label) for label in sorted({o.label for o in graph.objects})}
    recording = None if recorded is None else Recording.load(recorded)
    parts = [_head(graph, given, seconds)]
    if recording is not None:
        parts.append(_frames(recording, colours, folder))
    parts.append(_above(graph, recording, colours, folder))
    if with_images:
        bank = SceneBank.load(run / "bank.npz")
        images = report_images.cousin_images(bank, graph, folder, progress)
        parts.append(_cousins(images, graph, recording, folder))
    parts += [_checks(record, checks), _appearances(record, folder)]
    parts += [_matches(run, record, folder, with_images), _left_out(record)]
    body = "\n".join(parts)
    title = html.escape(graph.id)
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{title}</title><style>{_STYLE}</style>'
        f"<body>{body}</body></html>\n"
    )


def colour_of(label: str) -> str:
    """Colour of a label, the same in all images and runs."""
    hue = int.from_bytes(hashlib.sha256(label.encode()).digest()[:2], "big") / 65536
    return "#" + "".join(f"{round(255 * c):02x}" for c in colorsys.hsv_to_rgb(hue, 0.75, 0.85))


def _head(graph: SceneGraph, given: Input, seconds: Mapping[str, float]) -> str:
    source = graph.source
    rows = {
        "source": f"{given.kind} {given.path.name}",
        "tour": f"{source.video}; {source.city}, {source.country}; {source.licence}",
        "graph": f"{len(graph.objects)} objects, {len(graph.ground)} pieces of ground",
        "seconds": ", ".join(f"{name} {s:.1f}" for name, s in seconds.items() if "/" not in name),
    }
    return f"<h1>{html.escape(graph.id)}</h1>" + _table([], [(k, html.escape(x)) for k, x in rows.items()])


def _frames(recording: Recording, colours: dict[str, str], folder: pathlib.Path) -> str:
    names = report_images.masked_frames(recording, colours, folder)
    shown = len(recording.registered)
    note = f'<p class="small">{len(recording)} frames, {shown} with a pose; instances in their labels\' colours.</p>'
    return f"<h2>Frames and masks</h2>{note}{_row([_image(n) for n in names], 2)}"


def _above(graph: SceneGraph, recording: Recording | None, colours: dict[str, str], folder: pathlib.Path) -> str:
    parts = ["<h2>Scene graph from above</h2>"]
    if recording is not None:
        seen = report_map.seen_from_above(recording, report_map.extent(graph))
        Image.fromarray(seen, "RGBA").save(folder / "from_above.png", optimize=True)
        parts.append(
            '<p class="small">Reconstruction: what the depth of all frames shows, boxes of the graph over it.</p>'
        )
        parts.append(report_map.svg(graph, colours, f"{FOLDER}/from_above.png"))
    parts.append('<p class="small">Graph: ground, boxes with a tick along the heading, the trajectory in red.</p>')
    parts.append(report_map.svg(graph, colours))
    entries = "".join(f'<span><i style="background:{c}"></i>{html.escape(n)}</span>' for n, c in colours.items())
    return "\n".join([*parts, f'<p class="legend small">{entries}</p>'])


def _cousins(
    images: Sequence[tuple[str, list[str]]], graph: SceneGraph, recording: Recording | None, folder: pathlib.Path
) -> str:
    parts = ["<h2>Cousins side by side</h2>"]
    parts.append(_row([_figure(_image(top), f"cousin {k}") for k, (top, _) in enumerate(images)], 2))
    for view, row in enumerate(report_images.viewpoint_rows(graph) if graph.camera_path else []):
        cells = [_figure(_image(names[view]), f"cousin {k}") for k, (_, names) in enumerate(images)]
        if recording is not None and row < len(recording.registered):
            number = int(recording.registered[row])
            name = report_images.save_jpeg(recording.rgb(number), folder / f"tour_{number:06d}.jpg")
            cells.insert(0, _figure(_image(name), f"the capture, frame {number}"))
        parts.append(f"<h3>Place {view + 1} of the capture</h3>{_row(cells, 3)}")
    return "\n".join(parts)


def _checks(record: Mapping[str, Any], checks: Sequence[Mapping[str, Any]]) -> str:
    columns = ("cousin", "placed", "left out", "moved (most, m)", "still overlapping", "movable", "hulls", "at rest")
    rows = []
    for cousin, check in zip(record["cousins"], checks, strict=True):
        rest = "all stay for 2 s"
        low, high = check["goals_m"]
        rest += f"; goals {low:g} to {high:g} m away"
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
    return f'<h2>Placement and rest</h2><p class="small">{note}</p>{_table(columns, rows)}'


def _appearances(record: Mapping[str, Any], folder: pathlib.Path) -> str:
    uids = [appearance["uid"] for piece in record["ground"] for appearance in piece["materials"]]
    files = report_images.appearance_thumbnails([*uids, *(appearance["uid"] for appearance in record["skies"])], folder)
    rows = []
    for piece in record["ground"]:
        regions = f"{piece['kind']}<br><span class='small'>{len(piece['regions'])} regions</span>"
        rows.append((regions, *(_appearance(appearance, files) for appearance in piece["materials"])))
    rows.append(("sky", *(_appearance(appearance, files) for appearance in record["skies"])))
    columns = ("", *(f"cousin {k}" for k in range(len(record["skies"]))))
    return f"<h2>Ground and sky</h2>{_table(columns, rows)}"


def _appearance(appearance: Mapping[str, Any], files: Mapping[str, str]) -> str:
    distance = "not seen" if appearance["distance"] is None else f"distance {appearance['distance']:.3f}"
    image = _image(files[appearance["uid"]], "thumb") if appearance["uid"] in files else ""
    return f"{image}<span class='small'>{html.escape(appearance['uid'])}<br>{distance}</span>"


def _matches(run: pathlib.Path, record: Mapping[str, Any], folder: pathlib.Path, with_images: bool) -> str:
    # One object per distinct match, because series share theirs.
    shown = {}
    for name, found in record["matches"].items():
        if all(found):
            shown.setdefault(tuple(m["uid"] for m in found), name)
    chosen = list(shown.values())[:: max(1, len(shown) // MATCH_ROWS)][:MATCH_ROWS]
    uids = [m["uid"] for name in chosen for m in record["matches"][name]]
    files = report_images.asset_thumbnails(uids, folder) if with_images else {}
    rows = []
    for name in chosen:
        crop = run / "graph" / "crops" / "objects" / f"{name}_0.png"
        cropped = ""
        if crop.is_file():
            Image.open(crop).save(folder / f"crop_{name}.png")
            cropped = _image(f"crop_{name}.png", "thumb")
        cells = [f"{cropped}{html.escape(name)}"]
        for match in record["matches"][name]:
            appearance = "" if match["look"] is None else f", look {match['look']:.2f}"
            thumbnail = _image(files[match["uid"]], "thumb") if match["uid"] in files else ""
            text = f"{html.escape(match['uid'])}<br>distortion {match['distortion']:.2f}{appearance}"
            cells.append(f"{thumbnail}<span class='small'>{text}</span>")
        rows.append(cells)
    columns = ("object", *(f"cousin {k}" for k in range(len(record["cousins"]))))
    note = f"{len(rows)} of {len(shown)} different matches; all of them in <code>materialisation.json</code>."
    return f"<h2>Matches</h2><p class='small'>{note}</p><div class='scroll'>{_table(columns, rows)}</div>"


def _left_out(record: Mapping[str, Any]) -> str:
    reasons: dict[tuple[str, str, str], list[int]] = {}
    for k, cousin in enumerate(record["cousins"]):
        for gone in cousin["left_out"]:
            reasons.setdefault((gone["id"], gone["label"], gone["reason"]), []).append(k)
    if not reasons:
        return "<h2>Left out</h2><p>None: every node of the graph is placed in every cousin.</p>"
    rows = [(*map(html.escape, key), ", ".join(map(str, ks))) for key, ks in reasons.items()]
    return f"<h2>Left out</h2>{_table(('node', 'label', 'because', 'in cousins'), rows)}"


def _table(columns: Sequence[str], rows: Sequence[Sequence[Any]]) -> str:
    head = "<tr>" + "".join(f"<th>{c}</th>" for c in columns) + "</tr>" if columns else ""
    lines = "".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table>{head}{lines}</table>"


def _row(cells: Sequence[str], columns: int) -> str:
    return f'<div class="row" style="grid-template-columns:repeat({columns},1fr)">{"".join(cells)}</div>'


def _figure(content: str, caption: str) -> str:
    return f"<figure>{content}<figcaption>{html.escape(caption)}</figcaption></figure>"


def _image(name: str, kind: str = "") -> str:
    return f'<img class="{kind}" src="{FOLDER}/{html.escape(name)}" alt="">'
