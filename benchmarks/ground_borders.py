"""Measures how straight and accurate the borders of distilled ground are, for committed graphs and regenerated ones.

    python -m benchmarks.ground_borders [--set autobench] [--only Kyoto] [--graphs DIR] [--before DIR]
        [--pictures DIR]

The ground of every committed graph is rasterised again and processed by `distillation.ground_regions`, like that of a
new recording; cells within `HIDES` m of an object count as hidden, because a graph does not record visibility. With
--graphs, graphs of `benchmarks.library_captures` (DIR/<set>/<layout>/graph.json.gz) are measured instead, beside the
committed ones; --before is a folder like `scenes/` with former graphs to use for the committed ones. The reference is
the filmed block. Ground under houses counts for neither.

Columns: regions, corners, prisms; holes (m^2); kerbs of 15 m and more: metres off the line that fits them best (95 %),
share within 5 cm of it, and the distance of that line from the true kerb; intersection over union for each kind.
"""

import argparse
import dataclasses
import itertools
import pathlib
import sys

import matplotlib as mpl
import numpy as np
import shapely
from matplotlib import pyplot as plt
from shapely.geometry.base import BaseGeometry

from benchmarks.lib.tables import markdown
from urbanverse_mjx.assets.records.index import load_index
from urbanverse_mjx.assets.selection.label_priors import LabelPriors
from urbanverse_mjx.citygen import city_blocks
from urbanverse_mjx.datatypes import KIND_INDEX, GraphObject, GroundRegion, SceneGraph
from urbanverse_mjx.datatypes.ground import PAINT_KINDS
from urbanverse_mjx.distillation import ground, ground_regions
from urbanverse_mjx.distillation.ground_completion import completed
from urbanverse_mjx.geometry.polygons import rectangle
from urbanverse_mjx.scene.ground import check_regions, ground_prisms

SCENES = pathlib.Path(__file__).parents[1] / "scenes"
KINDS = ("road", "crosswalk", "sidewalk", "ground")
#: m round an object that count as hidden by it; m of a kerb that is measured, and to both sides of it.
HIDES, LONG, ASIDE = 0.5, 15.0, 1.5
#: m: below houses ground counts so far, as deep as it is carried on there.
UNDER = 0.5


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.ground_borders", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--set", choices=sorted(city_blocks.PROFILES), default="urbanverse160")
    parser.add_argument("--only", default="", help="layouts with this in their id")
    parser.add_argument("--graphs", type=pathlib.Path, help="measure these instead of cleaning the committed ones")
    parser.add_argument(
        "--before", type=pathlib.Path, default=SCENES, help="graphs to compare with: DIR/<set>/<layout>"
    )
    parser.add_argument("--pictures", type=pathlib.Path, help="folder for PNGs: reference, before, after")
    arguments = parser.parse_args(argv)
    layouts = {n: p for n, p in city_blocks.layouts(arguments.set).items() if arguments.only in n}
    if arguments.graphs:
        layouts = {n: p for n, p in layouts.items() if _file(arguments.graphs, arguments.set, n).is_file()}
    if not layouts:
        print(f"found no layout of {arguments.set} with {arguments.only!r} in its id, needed one", file=sys.stderr)
        return 2
    priors = LabelPriors(load_index())
    rows: dict[str, list[dict[str, float]]] = {"true": [], "before": [], "after": []}
    for name, profile in layouts.items():
        true = city_blocks.block(profile, city_blocks.SEEDS[arguments.set], name)
        before = SceneGraph.load(_file(arguments.before, arguments.set, name))
        after = (
            SceneGraph.load(_file(arguments.graphs, arguments.set, name))
            if arguments.graphs
            else cleaned(before, priors)
        )
        graphs = {"true": true, "before": before, "after": after}
        for key, graph in graphs.items():
            rows[key].append(measure(graph, true, priors))
        print(name, *(f"{k} {_words(rows[k][-1])}" for k in ("before", "after")), sep="\n  ", flush=True)
        if arguments.pictures:
            draw(graphs, arguments.pictures / f"{name}.png")
    head = list(rows["true"][0])
    head = [c for c in head if any(np.isfinite(r[c]) for r in rows["after"])]
    means = {key: [float(np.nanmean([r[c] for r in found])) for c in head] for key, found in rows.items()}
    print(f"\nMeans of {len(layouts)} streets:\n")
    print(markdown(["", *head], [[key, *(f"{x:.4g}" for x in values)] for key, values in means.items()]))
    return 0


def _file(folder: pathlib.Path, of_set: str, layout: str) -> pathlib.Path:
    return folder / of_set / layout / "graph.json.gz"


def _words(row: dict[str, float]) -> str:
    return ", ".join(f"{k} {x:.4g}" for k, x in row.items())


def cleaned(graph: SceneGraph, priors: LabelPriors) -> SceneGraph:
    """Returns the graph with regenerated ground."""
    hidden = shapely.union_all([_box(o).buffer(HIDES) for o in graph.objects if not priors(o.label).faces_road])
    seen = _cells(graph.ground, hidden)
    regions = ground_regions.regions(completed(seen, _houses(graph, priors)))
    check_regions(regions)
    return dataclasses.replace(graph, ground=regions)


def _box(obj: GraphObject) -> shapely.Polygon:
    return rectangle(obj.size[0], obj.size[1], obj.yaw, obj.center[0], obj.center[1])


def _houses(graph: SceneGraph, priors: LabelPriors) -> list[shapely.Polygon]:
    return [_box(o) for o in graph.objects if priors(o.label).faces_road]


def _cells(regions: tuple[GroundRegion, ...], hidden: BaseGeometry) -> ground.GroundMap:
    solid = [r for r in regions if r.kind not in PAINT_KINDS]
    polygons = [shapely.Polygon(r.polygon) for r in solid]
    low, high = np.array(shapely.total_bounds(polygons)).reshape(2, 2)
    origin = np.floor(low / ground.CELL - 1) * ground.CELL
    shape = tuple(np.ceil((high - origin) / ground.CELL).astype(int) + 1)
    middles = origin + (np.argwhere(np.ones(shape, bool)) + 0.5) * ground.CELL
    cell, region = shapely.STRtree(polygons).query(shapely.points(middles), predicate="intersects")
    kind, height, count = np.zeros(len(middles), np.uint8), np.full(len(middles), np.nan), np.zeros(len(middles), int)
    planes = np.array([r.plane for r in solid])[region]
    kind[cell] = np.array([KIND_INDEX[r.kind] for r in solid])[region]
    height[cell] = (planes[:, :2] * middles[cell]).sum(1) + planes[:, 2]
    shapely.prepare(hidden)
    count[cell] = ~shapely.contains_xy(hidden, *middles[cell].T)
    return ground.GroundMap(origin, kind.reshape(shape), height.reshape(shape), count.reshape(shape))


def measure(graph: SceneGraph, true: SceneGraph, priors: LabelPriors) -> dict[str, float]:
    """Returns one row of the table."""
    solid = [r for r in graph.ground if r.kind not in PAINT_KINDS]
    found, reference = _by_kind(graph), _by_kind(true)
    whole = shapely.union_all(list(found.values())).buffer(0.03, join_style="mitre").buffer(-0.03, join_style="mitre")
    holes = [shapely.Polygon(ring) for part in shapely.get_parts(whole) for ring in part.interiors]
    off, shift = _straightness(found, reference)
    below = shapely.union_all(_houses(true, priors)).buffer(-UNDER)
    row = {
        "regions": float(len(solid)),
        "corners": float(sum(len(r.polygon) for r in solid)),
        "prisms": float(len(ground_prisms(solid))),
        "holes": sum(h.area for h in holes),
        "off 95 %": float(np.percentile(off, 95)),
        "within 5 cm": float((off < 0.05).mean()),
        "shift": shift,
    }
    for kind in KINDS:
        a, b = (shapely.difference(x[kind], below, grid_size=1e-3) for x in (found, reference))
        union = a.union(b, grid_size=1e-3).area
        row[f"IoU {kind}"] = a.intersection(b, grid_size=1e-3).area / union if union else np.nan
    return row


def _by_kind(graph: SceneGraph) -> dict[str, BaseGeometry]:
    return {
        kind: shapely.union_all([shapely.Polygon(r.polygon) for r in graph.ground if r.kind == kind], grid_size=1e-3)
        for kind in KINDS
    }


def _kerb(kinds: dict[str, BaseGeometry]) -> BaseGeometry:
    """Returns the borders between the road and walkable ground."""
    return kinds["road"].boundary.intersection(shapely.union_all([kinds["sidewalk"], kinds["ground"]]).buffer(0.05))


def _straightness(found: dict[str, BaseGeometry], reference: dict[str, BaseGeometry]) -> tuple[np.ndarray, float]:
    """Returns (m) the distances of points on found kerbs from the best line along each long true kerb, and of that line
    from the true kerb."""
    parts = [p for p in shapely.get_parts(_kerb(found)) if p.length > 0.1]
    points = np.concatenate([shapely.get_coordinates(p.segmentize(0.05)) for p in parts])
    off, shifts = [], []
    for part in shapely.get_parts(shapely.line_merge(_kerb(reference))):
        corners = shapely.get_coordinates(part.simplify(0.02))
        for a, b in itertools.pairwise(corners):
            length = float(np.linalg.norm(b - a))
            along = (b - a) / length
            x, y = (points - a) @ along, (points - a) @ [-along[1], along[0]]
            near = (x > 2.0) & (x < length - 2.0) & (np.abs(y) < ASIDE)
            if length < LONG or near.sum() < LONG:
                continue
            line = _middle_line(x[near], y[near])
            off.append(np.abs(y[near] - np.polyval(line, x[near])))
            shifts.append(abs(float(np.polyval(line, length / 2))))
    return np.concatenate(off), float(np.mean(shifts))


def _middle_line(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Fits the line with the least sum of absolute errors, by iteratively reweighted least squares."""
    weight, line = np.ones(len(x)), np.zeros(2)
    for _ in range(10):
        line = np.polyfit(x, y, 1, w=weight)
        weight = 1.0 / np.sqrt(np.maximum(np.abs(y - np.polyval(line, x)), 0.01))
    return line


def draw(graphs: dict[str, SceneGraph], file: pathlib.Path) -> None:
    """Draws ground and boxes from above, one graph under the other."""
    mpl.use("Agg")
    colours = {"road": "#777777", "crosswalk": "#dddddd", "sidewalk": "#d9b38c", "ground": "#8fbf6f"}
    figure, axes = plt.subplots(len(graphs), 1, figsize=(30, 7 * len(graphs)), sharex=True, sharey=True)
    for axis, (title, graph) in zip(axes, graphs.items(), strict=True):
        for region in graph.ground:
            if region.kind in colours:
                axis.fill(*np.array(region.polygon).T, fc=colours[region.kind], ec="black", lw=0.5)
        for obj in graph.objects:
            axis.fill(
                *np.array(_box(obj).exterior.coords).T, fill=False, ec="blue" if obj.size[2] > 4 else "red", lw=0.4
            )
        axis.set_aspect("equal")
        axis.set_title(title)
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.tight_layout()
    figure.savefig(file, dpi=70)
    plt.close(figure)


if __name__ == "__main__":
    sys.exit(main())
