"""Writes a page of scene cards, images and numbers of compiled scenes that can be searched and sorted in a browser.

The page needs no server and no other site. A file in each scene's image folder holds the hashes of the images' inputs,
so that a second run draws only changed scenes.
"""

import collections
import dataclasses
import html
import pathlib
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from .. import versions
from ..datatypes import BenchmarkReport, ValidationError
from ..datatypes import validation as v

_IMAGE_FOLDER = "pictures"
#: Images of a card, in the order they are shown.
NAMES = ("above", "eye_0", "eye_1", "map")
_STYLE = """
body{font:15px/1.4 system-ui,sans-serif;margin:0 auto;max-width:1700px;padding:1em 1.4em;color:#22262b;
background:#f6f5f1}
h1{font-size:1.5em;margin:.2em 0}p{margin:.4em 0;max-width:70em}
.bar{position:sticky;top:0;background:#f6f5f1;padding:.5em 0;z-index:1}
input,select{font:inherit;padding:.25em .5em;margin-right:.6em}
#cards{display:grid;grid-template-columns:repeat(auto-fill,minmax(520px,1fr));gap:1.2em}
article{background:#fff;border:1px solid #dedbd2;border-radius:6px;padding:.7em;overflow:hidden}
h2{font-size:1.02em;margin:0 0 .1em;overflow-wrap:anywhere}.small{font-size:.85em;color:#5b616a}
.pair{display:grid;grid-template-columns:1fr 1fr;gap:.3em;margin:.3em 0}
img{width:100%;aspect-ratio:48/25;object-fit:contain;display:block;border-radius:3px;background:#eeeeea}
dl{display:grid;grid-template-columns:repeat(3,auto 1fr);gap:.1em .6em;margin:.4em 0;font-size:.88em}
dt{color:#5b616a}dd{margin:0;font-variant-numeric:tabular-nums}
"""
_SCRIPT = """
const box=document.querySelector('#find'),order=document.querySelector('#order'),list=document.querySelector('#cards');
const cards=[...list.children],count=document.querySelector('#count');
function show(){const words=box.value.toLowerCase().split(/\\s+/).filter(Boolean);let n=0;
 for(const c of cards){const hit=words.every(w=>c.dataset.text.includes(w));c.hidden=!hit;n+=hit}
 count.textContent=n+' of '+cards.length+' scenes'}
function sort(){const k=order.value,get=c=>k=='name'?c.id:parseFloat(c.dataset[k]);
 const sign=k=='name'||k=='clear'?1:-1;
 cards.slice().sort((a,b)=>{const x=get(a),y=get(b);
  if(Number.isNaN(x)||Number.isNaN(y))return Number.isNaN(x)-Number.isNaN(y);return(x<y?-1:x>y?1:0)*sign})
  .forEach(c=>list.append(c))}
box.addEventListener('input',show);order.addEventListener('change',sort);show();
"""
_ORDERS = {
    "name": "name",
    "objects": "most objects",
    "length": "longest route",
    "clear": "narrowest pavements",
    "blocked": "most blocked",
    "difficulty": "hardest",
}


@dataclasses.dataclass(frozen=True)
class Card:
    """One scene on the page.

    Attributes:
      metadata: the compiled scene's `metadata.json`.
      images: name (`scene_cards.NAMES`) -> file below the page's folder.
      difficulty: share of the planner's episodes that failed, None without a report.
    """

    metadata: dict[str, Any]
    images: Mapping[str, str]
    difficulty: float | None = None


Draw = Callable[[pathlib.Path, pathlib.Path], dict[str, str]]


def make_card(folder: pathlib.Path, out: pathlib.Path, draw: Draw) -> Card:
    """Returns the card of a compiled scene; its images are drawn if they are missing or of another layout."""
    metadata = v.read_json(folder / "metadata.json", "scene's metadata")
    record = out / _IMAGE_FOLDER / f"{metadata['id']}.json"
    drawn_from = {
        "layout": metadata["hashes"]["layout"],
        "compiler": metadata.get("code"),
        "pictures": versions.of("cards"),
    }
    known = _known(record)
    if known.get("from") != drawn_from or not all((record.parent / n).is_file() for n in known["files"].values()):
        known = {"from": drawn_from, "files": draw(folder, record.parent)}
        v.write_json(record, known)
    return Card(metadata, {name: f"{_IMAGE_FOLDER}/{file}" for name, file in known["files"].items()})


def _known(record: pathlib.Path) -> dict[str, Any]:
    """Returns the input hashes and names of a card's images; empty without a valid file."""
    try:
        body = v.read_json(record, "card") if record.is_file() else {}
    except ValidationError:
        body = {}
    whole = isinstance(body, dict) and isinstance(body.get("files"), dict)
    return body if whole else {"files": {}}


def with_difficulty(cards: Sequence[Card], report: BenchmarkReport, agent: str = "planner") -> list[Card]:
    """Returns the cards with the share of an agent's failed episodes in each scene.

    Raises:
      ValidationError: the report holds no episode of that agent.
    """
    tries, wins = collections.Counter[str](), collections.Counter[str]()
    for episode in report.episodes:
        if episode.agent == agent:
            tries[episode.scene] += 1
            wins[episode.scene] += episode.success
    if not tries:
        agents = ", ".join(sorted({e.agent for e in report.episodes})) or "nobody"
        raise v.fail("report", f"episodes of {agents}", f"some of {agent!r}", "name another agent")
    failed = {scene: 1 - wins[scene] / n for scene, n in tries.items()}
    return [dataclasses.replace(card, difficulty=failed.get(card.metadata["id"])) for card in cards]


def write_page(cards: Sequence[Card], out: pathlib.Path, title: str) -> pathlib.Path:
    """Writes `index.html`."""
    options = "".join(f'<option value="{k}">{name}</option>' for k, name in _ORDERS.items())
    objects = sum(c.metadata["statistics"]["objects"] for c in cards)
    kinds = set().union(*(c.metadata["statistics"]["categories"] for c in cards))
    page = f"""<!doctype html><html lang="en"><meta charset="utf-8"><title>{html.escape(title)}</title>
<style>{_STYLE}</style><body><h1>{html.escape(title)}</h1>
<p class="small">{len(cards)} scenes, {objects} objects of {len(kinds)} categories. Each card: from above, twice at eye
level on its longest route, and the map with the routes of the delivery robot (objects in the way dark). Widths are of
cross-sections every half metre of pavement; blocked are those that leave less than 0.70 m.</p>
<div class="bar"><input id="find" type="search" placeholder="city, category, id" size="30">
<label>sort by <select id="order">{options}</select></label><span id="count" class="small"></span></div>
<div id="cards">{"".join(_card(c) for c in cards)}</div><script>{_SCRIPT}</script></body></html>
"""
    return v.write_atomically(out / "index.html", lambda p: p.write_text(page, encoding="utf-8"))


def _card(card: Card) -> str:
    m, s = card.metadata, card.metadata["statistics"]
    name, pavement = html.escape(m["id"]), s["pavement"]
    clear, blocked = pavement["clear_width_m"].get("p50"), pavement["narrower_than"]["robot"]
    values = {
        "objects": s["objects"],
        "length": m["route_length_m"],
        "clear": clear,
        "blocked": blocked,
        "difficulty": card.difficulty,
    }
    data = " ".join(f'data-{key}="{"" if value is None else value}"' for key, value in values.items())
    text = " ".join([m["id"], m["city"], m["country"], m["source"], m["sky"], *s["categories"]]).lower()
    by_count = sorted(s["categories"].items(), key=lambda item: (-item[1], item[0]))
    most = ", ".join(f"{n} {label}" for label, n in by_count[:8])
    where = ", ".join(x for x in (m["city"], m["country"]) if x != "none")
    images = [
        f'<a href="{html.escape(card.images[n])}"><img loading="lazy" src="{html.escape(card.images[n])}" '
        f'alt="{name}: {n}"></a>'
        for n in NAMES
        if n in card.images
    ]
    return (
        f'<article id="{name}" {data} data-text="{html.escape(text, quote=True)}"><h2>{name}</h2>'
        f'<p class="small">{html.escape(" · ".join(x for x in (where, m["source"], m["sky"]) if x))}</p>'
        f'<div class="pair">{"".join(images)}</div><dl>{_facts(m, s, card.difficulty)}</dl>'
        f'<p class="small">{html.escape(most)}</p></article>'
    )


def _facts(m: Mapping[str, Any], s: Mapping[str, Any], difficulty: float | None) -> str:
    pavement, kerbs = s["pavement"], s["kerbs"]
    rows = {
        "objects": str(s["objects"]),
        "categories": str(len(s["categories"])),
        "longest route": f"{m['route_length_m']:.0f} m",
        "ground": f"{sum(s['ground_area_m2'].values()):.0f} m²",
        "sidewalk": f"{s['ground_area_m2'].get('sidewalk', 0.0):.0f} m²",
        "kerbs": f"{kerbs['length_m']:.0f} m, {100 * kerbs['height_m']:.0f} cm",
        "pavement width": _metres(pavement["width_m"].get("p50")),
        "left clear": _metres(pavement["clear_width_m"].get("p50")),
        "blocked": f"{100 * pavement['narrower_than']['robot']:.1f} %",
        "under 1.22 m": f"{100 * pavement['narrower_than']['prowag']:.1f} %",
        "episodes": str(m["counts"]["episodes"]),
        "difficulty": "not driven" if difficulty is None else f"planner fails {100 * difficulty:.0f} %",
    }
    return "".join(f"<dt>{key}</dt><dd>{value}</dd>" for key, value in rows.items())


def _metres(value: float | None) -> str:
    return "none" if value is None else f"{value:.1f} m"
