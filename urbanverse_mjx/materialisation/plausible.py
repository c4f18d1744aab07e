"""Refuses graphs that cannot be of a street: lengths in another unit, positions from wrong poses, objects of which none
finds a place."""

import collections
from collections.abc import Sequence

import shapely
from shapely.geometry.base import BaseGeometry

from ..assets.categories.ontology import UnknownLabelError
from ..assets.categories.priors import prior
from ..assets.categories.semantics import rank_leaves
from ..datatypes import GraphObject, SceneGraph
from ..datatypes import validation as v
from .choice import FRONTS
from .cousins import Cousin
from .shortlists import GROUND_LEAVES, MIN_SCORE

#: Largest ratio of an object's longest side to that of the largest known object of its leaf. Graphs of the scene sets
#: have at most 1.3.
MAX_SIZE_RATIO = 4.0
#: m, longest front or fence, whose lengths are not those of one object: 200 m are two city blocks.
MAX_FRONT = 200.0
#: m, largest distance of an object from all ground. Cameras see objects up to 60 m away (`DistilOptions.max_range`).
MAX_DISTANCE = 200.0
#: m, largest extent of the ground: its map has cells of 5 cm, 400 million of them on 1 km².
MAX_EXTENT = 1_000.0


def check_plausible(graph: SceneGraph) -> None:
    """Checks the sizes and positions of a graph's objects, and the extent of its ground. Labels without a leaf are not
    checked.

    Raises:
      ValidationError: an object is several times larger than any known one of its kind, or far from all ground, or the
        ground is too large; the message names the object.
    """
    check_extent(graph)
    for error in implausible_objects(graph).values():
        raise error


def check_extent(graph: SceneGraph) -> None:
    """Checks the extent of a graph's ground.

    Raises:
      ValidationError: it is larger than `MAX_EXTENT`.
    """
    low_x, low_y, high_x, high_y = _union(graph).bounds
    extent = max(high_x - low_x, high_y - low_y)
    if extent > MAX_EXTENT:
        raise v.fail(
            "ground",
            f"an extent of {_metres(extent)}",
            f"at most {_metres(MAX_EXTENT)}",
            "check that lengths are in metres, or cut the street into parts",
        )


def implausible_objects(graph: SceneGraph) -> dict[str, v.ValidationError]:
    """Id -> what is wrong with it, of the objects that `check_plausible` refuses."""
    ground = _union(graph)
    limits = {label: _longest(label) for label in {obj.label for obj in graph.objects}}
    found = {obj.id: _problem(obj, limits[obj.label], ground) for obj in graph.objects}
    return {name: error for name, error in found.items() if error is not None}


def check_placed(graph: SceneGraph, cousins: Sequence[Cousin]) -> None:
    """Checks that at least one object of a graph that has objects is placed in every cousin.

    Raises:
      ValidationError: every object is left out of a cousin; the message gives the most frequent reason.
    """
    for cousin in cousins:
        if graph.objects and not cousin.layout.objects:
            reason, count = collections.Counter(entry.reason for entry in cousin.left_out).most_common(1)[0]
            raise v.fail(
                f"scene graph {graph.id!r}",
                f"no place for any of {v.counted(len(graph.objects), 'objects')} ({count} because {reason})",
                "at least one that can be placed",
                "correct labels and positions in graph.json, or film another part of the street",
            )


def _longest(label: str) -> tuple[str, float] | None:
    """Leaf and largest plausible side (m) of a label's objects; None for labels without a leaf, which are left out."""
    try:
        leaf, score = rank_leaves(label, 1)[0]
    except UnknownLabelError:
        return None
    if leaf in GROUND_LEAVES or score < MIN_SCORE:
        return None
    row = prior(leaf)
    known = max(row.length[2], row.width[2], row.height[2])
    return leaf, max(MAX_FRONT if leaf in FRONTS else 0.0, MAX_SIZE_RATIO * known)


def _problem(obj: GraphObject, limit: tuple[str, float] | None, ground: BaseGeometry) -> v.ValidationError | None:
    name = f"object {obj.id!r} ({obj.label})"
    if limit is not None and max(obj.size) > limit[1]:
        size = " x ".join(f"{side:,.3g}" if side < 1000 else f"{side:,.0f}" for side in obj.size)
        needed = f"at most {_metres(limit[1])} for a {limit[0]}"
        return v.fail(name, f"a size of {size} m", needed, "check the unit and the camera height, or remove it")
    away = ground.distance(shapely.Point(obj.center[:2]))
    if away > MAX_DISTANCE:
        found, needed = f"a place {_metres(away)} from all ground", f"at most {_metres(MAX_DISTANCE)}"
        return v.fail(name, found, needed, "remove it, or check the poses of the source")
    return None


def _union(graph: SceneGraph) -> BaseGeometry:
    return shapely.union_all([shapely.Polygon(region.polygon) for region in graph.ground])


def _metres(length: float) -> str:
    return f"{length / 1000:,.3g} km" if length >= 1000 else f"{length:.3g} m"
