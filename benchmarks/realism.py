"""`python -m benchmarks.realism --out FILE.png NAME=FOLDER ...`: compares families of compiled scenes with real
streets.

Objects, categories, spacing, pavement widths, their free parts, trees and kerbs of every scene, from the scenes' own
`metadata.json`; differences between cousins, layouts and procedural scenes, from their layouts. One figure, and a JSON
file with the same numbers. `PUBLISHED` holds figures of real streets with their addresses.
"""

import argparse
import collections
import dataclasses
import json
import pathlib
import sys
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy.spatial.distance import pdist, squareform

from benchmarks.lib import realism_figure as figure
from urbanverse_mjx.datatypes import SceneLayout, ValidationError
from urbanverse_mjx.datatypes.validation import read_json, write_json
from urbanverse_mjx.scene.folders import scene_folders


@dataclasses.dataclass(frozen=True)
class Published:
    """Published figures of one measure for real streets: a range or values, the source, and a description."""

    low: float
    high: float
    what: str
    address: str


#: Taken from public pages on 2026-11-22. No source was found for the other measures (objects per 100 m, categories,
#: spacing, and the share of blocked pavement).
PUBLISHED: dict[str, tuple[Published, ...]] = {
    "under_2_m": (
        Published(
            0.34,
            0.34,
            "pavements of Great Britain (Esri UK, Ordnance Survey)",
            "https://www.localgov.co.uk/Majority-of-pavements-are-too-narrow-for-social-distancing-analysis-reveals/50570",
        ),
        Published(
            0.38,
            0.38,
            "sidewalks of Vienna",
            "https://kurier.at/chronik/wien/abstand-wegen-coronavirus-viele-wiener-gehsteige-sind-zu-schmal/400797920",
        ),
    ),
    "under_3_m": (
        Published(
            0.70,
            0.70,
            "pavements of Great Britain (Esri UK, Ordnance Survey)",
            "https://www.localgov.co.uk/Majority-of-pavements-are-too-narrow-for-social-distancing-analysis-reveals/50570",
        ),
    ),
    # A spacing of 25 to 40 feet is 8.2 to 13.1 trees per 100 m of fully planted kerb.
    "trees": (
        Published(
            8.2, 13.1, "Los Angeles' spacing rule", "https://bss.lacity.org/UrbanForestry/StreetTree/TreeSpacing.htm"
        ),
    ),
    "kerb_m": (
        Published(0.04, 0.21, "CraftBench's own kerbs", "https://github.com/VAIL-UCLA/UrbanVerse (navbench/docs)"),
        Published(0.10, 0.15, "4 to 6 inches, U.S.", "https://ofstandard.com/general/standard-dimensions-of-curb"),
    ),
}
#: Measure -> title of its panel. Each is one number per scene.
MEASURES = {
    "objects": "objects on 100 m of pavement, houses apart",
    "categories": "categories in a scene",
    "spacing": "m to the nearest object (median)",
    "trees": "trees on 100 m of pavement",
    "kerb_m": "height of kerbs, m (median)",
    "under_2_m": "share of pavement under 2 m wide",
    "under_3_m": "share of pavement under 3 m wide",
    "blocked": "share that leaves under 0.70 m (robot)",
    "under_prowag": "share that leaves under 1.22 m (PROWAG)",
}
#: Largest number of scenes per family for diversity, because the number of pairs grows quadratically.
MOST = 400


def measures(metadata: Mapping[str, Any]) -> dict[str, float]:
    """Returns the numbers of one scene, by `MEASURES`."""
    s = metadata["statistics"]
    pavement = s["pavement"]
    hundreds = max(pavement["length_m"], 1.0) / 100.0
    return {
        "objects": (s["objects"] - s["houses"]) / hundreds,
        "categories": float(len(s["categories"])),
        "spacing": s["spacing_m"].get("p50", float("nan")),
        "trees": sum(n for name, n in s["categories"].items() if name in ("tree", "palm tree")) / hundreds,
        "kerb_m": s["kerbs"]["height_m"],
        "under_2_m": pavement["width_under"]["2"],
        "under_3_m": pavement["width_under"]["3"],
        "blocked": pavement["narrower_than"]["robot"],
        "under_prowag": pavement["narrower_than"]["prowag"],
    }


def diversity(layouts: Sequence[SceneLayout]) -> dict[str, float]:
    """Returns the diversity of scenes: the mean Bray-Curtis distance of their counts (0 equal, 1 disjoint).

    Returns:
      `cousin_assets`, `cousin_objects`: between cousins of one graph, by asset and by category; `layout_assets`,
      `layout_objects`: between first cousins of different graphs. Left out where there are no such pairs.
    """
    found: dict[str, float] = {}
    layouts = sorted(layouts, key=lambda x: (x.graph_id, x.cousin))[:MOST]
    graphs = np.array([x.graph_id for x in layouts])
    first = np.array([i == 0 or graphs[i] != graphs[i - 1] for i in range(len(graphs))])
    for name, key in (("assets", "asset_uid"), ("objects", "category")):
        counts = _counts([[getattr(o, key) for o in x.objects] for x in layouts])
        apart = squareform(pdist(counts, "braycurtis")) if len(layouts) > 1 else np.zeros((1, 1))
        same = (graphs[:, None] == graphs) & ~np.eye(len(graphs), dtype=bool)
        others = (graphs[:, None] != graphs) & first[:, None] & first
        for kind, pairs in (("cousin", same), ("layout", others)):
            if pairs.any():
                found[f"{kind}_{name}"] = round(float(apart[pairs].mean()), 4)
    return found


def _counts(bags: Sequence[Sequence[str]]) -> np.ndarray:
    """Returns (n, k), how often each name occurs in each bag."""
    number = {name: i for i, name in enumerate(sorted({name for bag in bags for name in bag}))}
    table = np.zeros((len(bags), max(1, len(number))))
    for row, bag in zip(table, bags, strict=True):
        for name, count in collections.Counter(bag).items():
            row[number[name]] = count
    return table


def measure(families: Mapping[str, Sequence[pathlib.Path]]) -> dict[str, Any]:
    """Returns all data of the figure, by family."""
    measured = {}
    for name, folders in families.items():
        scenes = [measures(read_json(f / "metadata.json", "scene's metadata")) for f in folders]
        layouts = [SceneLayout.load(f / "layout.json") for f in folders]
        measured[name] = {
            "scenes": len(folders),
            "layouts": len({x.graph_id for x in layouts}),
            "values": {key: [round(s[key], 4) for s in scenes] for key in MEASURES},
            "median": {key: round(float(np.nanmedian([s[key] for s in scenes])), 4) for key in MEASURES},
            "diversity": diversity(layouts),
        }
    published = {key: [dataclasses.asdict(p) for p in rows] for key, rows in PUBLISHED.items()}
    return {"families": measured, "published": published, "no_page_gave": [k for k in MEASURES if k not in PUBLISHED]}


def families_of(texts: Sequence[str]) -> dict[str, list[pathlib.Path]]:
    """Parses NAME=FOLDER ... as names and compiled scenes.

    Raises:
      ValidationError: an argument has another form, or a folder contains no scene.
    """
    found: dict[str, list[pathlib.Path]] = {}
    for text in texts:
        name, equals, folder = text.partition("=")
        if not (name and equals and folder):
            raise ValidationError(
                f"family: found {text!r}, needed NAME=FOLDER, such as shipped=streets/; name the family."
            )
        found[name] = scene_folders([pathlib.Path(folder)])
    return found


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("families", nargs="+", help="NAME=FOLDER: compiled scenes, or folders of them")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="image to write, .json beside it")
    args = parser.parse_args(argv)
    try:
        measured = measure(families_of(args.families))
    except ValidationError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    write_json(args.out.with_suffix(".json"), measured)
    figure.draw(measured, MEASURES, args.out)
    print(json.dumps({"figure": str(args.out), **{name: f["median"] for name, f in measured["families"].items()}}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
