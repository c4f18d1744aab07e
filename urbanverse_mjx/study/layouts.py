"""Two-sample tests of layout statistics: what can be said about cousins and their sources without people.

Objects of a street are described by numbers (`STATISTICS`). Sets of streets are compared by the largest difference of
their distribution functions (Kolmogorov-Smirnov) of each number, and of categories by total variation. Objects of one
street are not independent, so that significance is of permutations of whole streets.
"""

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import shapely
from scipy.spatial import cKDTree

from ..assets.categories import ontology
from ..datatypes import SceneGraph, SceneLayout
from ..datatypes import validation as v

#: Name -> what it is, in its unit.
STATISTICS = {
    "spacing_m": "distance of an object's centre to the nearest other one",
    "kerb_m": "distance of an object's centre to the nearest border of a road",
    "length_m": "longer side of an object's ground",
    "height_m": "height of an object",
    "turn_rad": "angle between an object's heading and the nearest road border, 0 to pi / 2",
    "density_per_100m2": "objects per 100 square metres of ground, one number a street",
}
_SEED = 0


@dataclasses.dataclass(frozen=True)
class StreetLayout:
    """What is known of a street's layout.

    Attributes:
      id: of the street; source: of the graph that it was made from, by which sets are paired.
      values: statistic -> (n,).
      categories: middle category of the ontology -> number of objects.
    """

    id: str
    source: str
    values: dict[str, np.ndarray]
    categories: dict[str, int]


def layout_of_graph(graph: SceneGraph) -> StreetLayout:
    """The layout of a scene graph."""
    rows = [(o.label, o.center[0], o.center[1], o.yaw, o.size[0], o.size[1], o.size[2]) for o in graph.objects]
    return _street(graph.id, graph.id, rows, [(g.kind, g.polygon) for g in graph.ground])


def layout_of_scene(layout: SceneLayout, extents: Mapping[str, Sequence[float]]) -> StreetLayout:
    """The layout of a cousin.

    Args:
      extents: asset uid -> (3,) m, unscaled size of the asset along its axes.
    """
    rows = []
    for o in layout.objects:
        size = [float(a) * b for a, b in zip(extents[o.asset_uid], o.scale, strict=True)]
        rows.append((o.category, o.position[0], o.position[1], o.yaw, *size))
    return _street(layout.id, layout.graph_id, rows, [(g.kind, g.polygon) for g in layout.ground])


def _street(name: str, source: str, rows: Sequence[tuple[Any, ...]], ground: Sequence[tuple[str, Any]]) -> StreetLayout:
    xy = np.array([row[1:3] for row in rows], float).reshape(-1, 2)
    yaw, sides = np.array([row[3] for row in rows], float), np.array([row[4:7] for row in rows], float).reshape(-1, 3)
    every = [shapely.Polygon(polygon).buffer(0) for _, polygon in ground]
    roads = [p for p, (kind, _) in zip(every, ground, strict=True) if kind in ("road", "crosswalk")]
    area = shapely.union_all(every).area
    values = {
        "length_m": sides[:, :2].max(1, initial=0.0),
        "height_m": sides[:, 2],
        "density_per_100m2": np.array([100.0 * len(rows) / area]) if area > 0 else np.zeros(0),
        "spacing_m": cKDTree(xy).query(xy, 2)[0][:, 1] if len(xy) > 1 else np.zeros(0),
        "kerb_m": np.zeros(0),
        "turn_rad": np.zeros(0),
    }
    if roads and len(rows):
        away, angle = _to_border(shapely.union_all(roads).boundary, xy)
        turn = np.abs(np.mod(yaw - angle + np.pi / 2, np.pi) - np.pi / 2)
        values |= {"kerb_m": away, "turn_rad": turn}
    known = ontology.categories()
    middles = [known[leaf][1] if leaf in known else "other" for leaf, *_ in rows]
    return StreetLayout(name, source, values, {m: middles.count(m) for m in sorted(set(middles))})


def _to_border(border: Any, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distances (n,) m of points to a border and its direction (n,) rad at the nearest places."""
    ends = []
    for line in shapely.get_parts(border):
        corners = shapely.get_coordinates(line)
        ends.append(np.concatenate([corners[:-1], corners[1:]], 1))
    legs = np.concatenate(ends)
    legs = legs[np.linalg.norm(legs[:, 2:] - legs[:, :2], axis=1) > 1e-6]
    a, along = legs[:, :2], legs[:, 2:] - legs[:, :2]
    share = np.clip(((points[:, None] - a) * along).sum(-1) / (along**2).sum(-1), 0.0, 1.0)
    away = np.linalg.norm(points[:, None] - a - share[..., None] * along, axis=-1)
    nearest = away.argmin(1)
    return away.min(1), np.arctan2(along[nearest, 1], along[nearest, 0])


def ks_distance(a: np.ndarray, b: np.ndarray) -> float:
    """Largest difference of the distribution functions of two samples, 0 to 1."""
    if not len(a) or not len(b):
        return 0.0
    a, b = np.sort(a), np.sort(b)
    grid = np.concatenate([a, b])
    return float(np.abs(np.searchsorted(a, grid, "right") / len(a) - np.searchsorted(b, grid, "right") / len(b)).max())


def category_distance(a: Sequence[StreetLayout], b: Sequence[StreetLayout]) -> float:
    """Total variation of the shares of categories, 0 to 1."""
    names = sorted({name for street in (*a, *b) for name in street.categories})
    shares = []
    for streets in (a, b):
        counts = np.array([sum(s.categories.get(name, 0) for s in streets) for name in names], float)
        shares.append(counts / max(counts.sum(), 1.0))
    return float(0.5 * np.abs(shares[0] - shares[1]).sum())


def distance(name: str, a: Sequence[StreetLayout], b: Sequence[StreetLayout]) -> float:
    """Distance of two sets of streets by one statistic, or by "categories"."""
    if name == "categories":
        return category_distance(a, b)
    pooled = [np.concatenate([s.values[name] for s in streets]) for streets in (a, b)]
    return ks_distance(*pooled)


def compare(
    a: Sequence[StreetLayout],
    b: Sequence[StreetLayout],
    paired: bool,
    permutations: int = 999,
    progress: Callable[[str], None] = lambda _: None,
) -> dict[str, dict[str, float]]:
    """Compares two sets of streets.

    Args:
      a: one set; b: the other one.
      paired: whether streets of one source are exchanged within their pairs (cousins and their sources), of which each
        side then has one of each source; else streets are exchanged freely.
      permutations: of streets, for the p-values.
      progress: called with each statistic.

    Returns:
      statistic -> "distance" (0 to 1), "p" (that an exchange of streets gives one as large), "p_holm" (adjusted for all
      statistics by Holm 1979), "expected" (the median under exchanges: what equal sets of this size would show), and of
      numbers the "median_a", "median_b".

    Raises:
      ValidationError: a set is empty, or the sources of pairs differ.
    """
    if not a or not b:
        raise v.fail("layouts", f"{len(a)} and {len(b)} streets", "some of both", "name folders that hold scenes")
    if paired and sorted(s.source for s in a) != sorted(s.source for s in b):
        other = sorted({s.source for s in a} ^ {s.source for s in b})
        raise v.fail(
            "layouts", f"streets without a partner: {', '.join(other)[:200] or 'several of one source'}", "pairs"
        )
    if paired:
        a, b = sorted(a, key=lambda s: s.source), sorted(b, key=lambda s: s.source)
    found = {}
    for name in (*STATISTICS, "categories"):
        rng = np.random.default_rng(_SEED)
        own = distance(name, a, b)
        exchanged = [distance(name, *_exchange(a, b, paired, rng)) for _ in range(permutations)]
        p = (1 + sum(x >= own - 1e-12 for x in exchanged)) / (1 + permutations)
        found[name] = {"distance": round(own, 4), "p": round(p, 4), "expected": round(float(np.median(exchanged)), 4)}
        if name != "categories":
            medians = [np.concatenate([s.values[name] for s in streets]) for streets in (a, b)]
            found[name] |= {
                f"median_{k}": round(float(np.median(x)), 3) for k, x in zip("ab", medians, strict=True) if len(x)
            }
        progress(name)
    for name, p in holm({name: row["p"] for name, row in found.items()}).items():
        found[name]["p_holm"] = round(p, 4)
    return found


def _exchange(
    a: Sequence[StreetLayout], b: Sequence[StreetLayout], paired: bool, rng: np.random.Generator
) -> tuple[list[StreetLayout], list[StreetLayout]]:
    if paired:
        swap = rng.random(len(a)) < 0.5
        pairs = [(y, x) if s else (x, y) for x, y, s in zip(a, b, swap, strict=True)]
        return [x for x, _ in pairs], [y for _, y in pairs]
    both = [*a, *b]
    order = rng.permutation(len(both))
    return [both[k] for k in order[: len(a)]], [both[k] for k in order[len(a) :]]


def holm(p: Mapping[str, float]) -> dict[str, float]:
    """Holm's step-down adjustment of p-values."""
    found, least = {}, 0.0
    for rank, name in enumerate(sorted(p, key=lambda n: p[n])):
        least = max(least, min((len(p) - rank) * p[name], 1.0))
        found[name] = least
    return found
