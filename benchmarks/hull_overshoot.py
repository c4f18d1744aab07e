"""Measures how far collision hulls stand out of what they enclose, where a robot can touch them, by rays from outside.

    python -m benchmarks.hull_overshoot [--close [close-2]] [--leaf retail] [--regional] [--out FILE.csv]

Every base shape (with --regional, every size of the regional buildings) is measured as
`urbanverse_mjx.assets.collision.overshoot` says; with --close, its closer hulls (of a revision), where it has some.
Points of the surface outside all hulls are measured too: the largest distance below `LOW`, foot plates aside.

Columns of the file: uid, leaf, rest (of the leaf's prior), rays that meet a hull first or together with the mesh, the
share of them over `LIMIT`, and the largest overshoot (m) with its place (m, in the asset's frame), number of hulls, and
the largest distance (m) of a point of the surface below `LOW` from the hulls, or 0.
"""

import argparse
import collections
import csv
import pathlib
import sys
import time
from collections.abc import Sequence

import numpy as np
import trimesh
from scipy.spatial import ConvexHull

from benchmarks.lib.tables import markdown
from urbanverse_mjx.assets import load_hulls, load_index
from urbanverse_mjx.assets.categories.priors import prior
from urbanverse_mjx.assets.collision.decompose import OPTIONS
from urbanverse_mjx.assets.collision.overshoot import LIMIT, Overshoot, overshoot
from urbanverse_mjx.assets.recipes.building.regional.styles import DRESSINGS
from urbanverse_mjx.assets.records.index import build_mesh
from urbanverse_mjx.assets.records.regional import load_regional
from urbanverse_mjx.datatypes import AssetMesh, AssetRecord
from urbanverse_mjx.datatypes.scene_layout import HULL_KINDS
from urbanverse_mjx.progress import Progress

#: m, height below which points outside all hulls count.
LOW = 2.0


def measure(record: AssetRecord, kind: str = "") -> tuple[Overshoot, int, float]:
    """The overshoot of a record's hulls, their number, and what they miss; `kind`: see `load_hulls`."""
    mesh, hulls = build_mesh(record), load_hulls(record, kind).hulls
    return overshoot(mesh.vertices, mesh.faces, hulls), len(hulls), missed(mesh, hulls)


def missed(mesh: AssetMesh, hulls: Sequence[np.ndarray]) -> float:
    """m, largest distance from the hulls of 1,500 points of the surface below `LOW` and above foot plates."""
    surface = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    points = np.asarray(trimesh.sample.sample_surface(surface, 1500, seed=0)[0])
    points = points[(points[:, 2] < LOW) & (points[:, 2] > OPTIONS.foot_plate + 1e-3)]
    gap = np.full(len(points), np.inf)
    for hull in hulls:
        planes = ConvexHull(hull).equations
        gap = np.minimum(gap, (points @ planes[:, :3].T + planes[:, 3]).max(1))
    return max(float(gap.max(initial=0.0)), 0.0)


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.hull_overshoot", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--leaf", help="only this leaf")
    parser.add_argument("--regional", action="store_true", help="regional buildings instead of the catalogue's shapes")
    parser.add_argument(
        "--close",
        nargs="?",
        const="close",
        default="",
        choices=HULL_KINDS[1:],
        help="measure closer hulls of this kind",
    )
    parser.add_argument("--out", type=pathlib.Path, help="CSV with a row per shape")
    arguments = parser.parse_args(argv)
    records = load_regional().records if arguments.regional else load_index().records
    if arguments.regional:  # dressings share their geometry
        records = tuple(r for r in records if r.params["variant"] % DRESSINGS == 0)
    records = tuple(r for r in records if arguments.leaf in (None, r.leaf))
    if not records:
        print(f"found no shape of the leaf {arguments.leaf!r}, needed one", file=sys.stderr)
        return 2
    rows, begin = [], time.perf_counter()
    with Progress() as progress:
        report, done = progress.task("overshoot", len(records)), 0
        for record in records:
            rows.append((record, prior(record.leaf).rest, *measure(record, arguments.close)))
            done += 1
            report(done)
    seconds = (time.perf_counter() - begin) / len(records)
    if arguments.out:
        with arguments.out.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(("uid", "leaf", "rest", "rays", "over", "worst", "x", "y", "z", "hulls", "missed"))
            for record, rest, found, hulls, outside in rows:
                share, place = found.over / max(found.rays, 1), (f"{c:.3f}" for c in found.place)
                shape = (record.uid, record.leaf, rest)
                over = (found.rays, f"{share:.4f}", f"{found.worst:.4f}", *place)
                writer.writerow((*shape, *over, hulls, f"{outside:.4f}"))
    print(f"{len(records)} shapes, {seconds:.2f} s each")
    print(summary([(r.leaf, rest, f) for r, rest, f, *_ in rows]))
    number, outside = sum(n for *_, n, _ in rows), [m for *_, m in rows]
    beyond = sum(m > 0.06 for m in outside)
    print(f"\n{number} hulls; {beyond} shapes miss more than 6 cm below {LOW} m, at most {max(outside):.3f} m")
    return 0


def summary(rows: Sequence[tuple[str, str, Overshoot]]) -> str:
    """Two tables in Markdown: by how objects rest, and the leaves with the largest overshoot."""
    groups = collections.defaultdict(list)
    leaves = collections.defaultdict(list)
    for leaf, rest, found in rows:
        if found.rays:
            groups[rest].append(found.worst)
            leaves[leaf].append(found)
    head = ["rest", "shapes met below 1.2 m", "over 5 cm", "over 10 cm", "over 20 cm", "largest (m)"]
    body = [
        [rest, str(len(x)), *(str(sum(w > limit for w in x)) for limit in (LIMIT, 0.1, 0.2)), f"{max(x):.2f}"]
        for rest, x in sorted(groups.items())
    ]
    worst = sorted(leaves.items(), key=lambda item: -max(f.worst for f in item[1]))[:25]
    table = [
        [
            leaf,
            str(len(x)),
            str(sum(f.worst > LIMIT for f in x)),
            f"{max(f.worst for f in x):.2f}",
            f"{100 * sum(f.over for f in x) / sum(f.rays for f in x):.1f} %",
        ]
        for leaf, x in worst
    ]
    second = markdown(["leaf", "shapes", "over 5 cm", "largest (m)", "rays over 5 cm"], table)
    return "\n\n".join((markdown(head, body), second))


if __name__ == "__main__":
    sys.exit(main())
