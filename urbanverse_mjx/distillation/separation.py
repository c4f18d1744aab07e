"""Separates buildings that stand in one another, and moves or removes what stands inside them.

The depth of a building is hardly ever seen and completed from known sizes, and its front carries the error of its
depth. Overlapping boxes are therefore cut on the side that removes least, hidden sides first.
"""

import dataclasses
import itertools
from collections.abc import Callable, Mapping, Sequence

import numpy as np
import shapely
import shapely.ops
from shapely.geometry.base import BaseGeometry

from ..datatypes import GraphObject
from ..geometry.polygons import rectangle


@dataclasses.dataclass(frozen=True)
class SeparationOptions:
    """Limits of the separation.

    Chosen manually; docs/decisions/generation.md has their effect on committed graphs.

    Attributes:
      tolerance: m, penetration of two footprints that is left; assets fill boxes to some centimetres.
      same_share: two buildings that share more than this of the smaller footprint are one building, found twice.
      min_kept: least share of its length that a side keeps; otherwise the building with less evidence is removed.
      side_cost, front_cost: cost of cutting a building beside, and at the side that faces the camera's path, relative
        to its back.
      max_move: m, largest movement of an object out of a building.
    """

    tolerance: float = 0.05
    same_share: float = 0.5
    min_kept: float = 0.5
    side_cost: float = 2.0
    front_cost: float = 4.0
    max_move: float = 1.0


_OPTIONS = SeparationOptions()


@dataclasses.dataclass(frozen=True)
class Removed:
    """An object that was removed, and the reason, a clause that follows "removed because"."""

    id: str
    label: str
    reason: str


@dataclasses.dataclass(frozen=True)
class Separation:
    """Objects whose buildings do not overlap, in their order; the removed ones; and (id, m) of cuts and movements."""

    objects: tuple[GraphObject, ...]
    removed: tuple[Removed, ...]
    cut: tuple[tuple[str, float], ...]
    moved: tuple[tuple[str, float], ...]


def separate(
    objects: Sequence[GraphObject],
    is_building: Callable[[str], bool],
    hangs: Callable[[str], bool],
    path: np.ndarray,
    evidence: Mapping[str, float] | None = None,
) -> Separation:
    """Separates the buildings among objects, and clears their insides.

    Args:
      objects: of a graph, with unique ids.
      is_building, hangs: of a label; what hangs (signs, awnings) may be on a wall.
      path: (n, 2) m, the camera's path; may be empty.
      evidence: id -> weight that decides which of two buildings stays; default: their scores.
    """
    weight = {obj.id: obj.score for obj in objects} if evidence is None else evidence
    buildings = {obj.id: obj for obj in objects if is_building(obj.label)}
    others = [obj for obj in objects if obj.id not in buildings]
    removed, cut = _without_overlap(buildings, weight, path)
    stay, moved, inside = _outside(others, list(buildings.values()), hangs)
    while evidence is not None and (refuted := _refuted(buildings, stay, others, hangs, evidence)) is not None:
        removed[refuted] = "of the objects inside it there is more evidence"
        del buildings[refuted]
        cut.pop(refuted, None)
        stay, moved, inside = _outside(others, list(buildings.values()), hangs)
    found = {**buildings, **stay}
    gone = {**removed, **inside}
    return Separation(
        tuple(found[obj.id] for obj in objects if obj.id in found),
        tuple(Removed(obj.id, obj.label, gone[obj.id]) for obj in objects if obj.id in gone),
        tuple((name, round(length, 3)) for name, length in cut.items()),
        tuple((name, round(length, 3)) for name, length in moved.items()),
    )


def footprint(obj: GraphObject) -> shapely.Polygon:
    """The box of an object from above."""
    return rectangle(*obj.size[:2], obj.yaw, *obj.center[:2])


def penetration(a: GraphObject, b: GraphObject) -> float:
    """m, the shortest horizontal movement that separates two boxes; 0 if they are apart or above one another.

    By the separating axis theorem only the normals of the sides are tested.
    """
    if abs(a.center[2] - b.center[2]) >= (a.size[2] + b.size[2]) / 2:
        return 0.0
    if np.hypot(*np.subtract(a.center[:2], b.center[:2])) >= (np.hypot(*a.size[:2]) + np.hypot(*b.size[:2])) / 2:
        return 0.0  # the circles around them are apart: most pairs of a long street
    corners = [shapely.get_coordinates(footprint(obj))[:-1] for obj in (a, b)]
    depth = np.inf
    for angle in (a.yaw, a.yaw + np.pi / 2, b.yaw, b.yaw + np.pi / 2):
        on_a, on_b = (points @ [np.cos(angle), np.sin(angle)] for points in corners)
        depth = min(depth, on_a.max() - on_b.min(), on_b.max() - on_a.min())
    return max(float(depth), 0.0)


def _without_overlap(
    buildings: dict[str, GraphObject], weight: Mapping[str, float], path: np.ndarray
) -> tuple[dict[str, str], dict[str, float]]:
    """Cuts and removes `buildings` in place until none penetrates another, the deepest pair first.

    Returns:
      id -> reason of those that were removed; id -> m by which the others were cut.
    """
    first = dict(buildings)
    removed: dict[str, str] = {}
    cut: dict[str, float] = {}
    depth = {pair: penetration(*(buildings[name] for name in pair)) for pair in itertools.combinations(buildings, 2)}
    while True:
        pair = max(depth, key=lambda names: depth[names], default=None)
        if pair is None or depth[pair] <= _OPTIONS.tolerance:
            return removed, cut
        one, other = (buildings[name] for name in pair)
        shared = footprint(one).intersection(footprint(other))
        same = shared.area > _OPTIONS.same_share * min(footprint(one).area, footprint(other).area)
        trimmed = None if same else _trimmed(one, other, shared, first, path)
        if trimmed is None:
            # A wrong building, such as one front of two houses, usually covers several others.
            covered = {
                name: sum(value > _OPTIONS.tolerance for names, value in depth.items() if name in names)
                for name in pair
            }
            weak, strong = sorted(pair, key=lambda name: (weight[name] / covered[name], name))
            removed[weak] = (
                f"it shares its ground with {strong!r} ({buildings[strong].label}), of which there is more evidence"
            )
            del buildings[weak]
            depth = {names: value for names, value in depth.items() if weak not in names}
            cut.pop(weak, None)
            continue
        changed, length = trimmed
        buildings[changed.id] = changed
        cut[changed.id] = cut.get(changed.id, 0.0) + length
        depth |= {
            names: penetration(*(buildings[name] for name in names)) for names in depth if changed.id in names
        }  # fmt: skip


def _trimmed(
    one: GraphObject,
    other: GraphObject,
    shared: BaseGeometry,
    first: Mapping[str, GraphObject],
    path: np.ndarray,
) -> tuple[GraphObject, float] | None:
    """The building of two that is cut at least cost, after the cut, and the length (m) that it loses; None if either
    would lose too much of a side."""
    best: tuple[float, GraphObject, float] | None = None
    for obj in (one, other):
        axes = np.array([[np.cos(obj.yaw), np.sin(obj.yaw)], [-np.sin(obj.yaw), np.cos(obj.yaw)]])
        local = (shapely.get_coordinates(shared) - obj.center[:2]) @ axes.T
        half = np.array(obj.size[:2]) / 2
        for axis, sign in itertools.product((0, 1), (-1.0, 1.0)):
            # The side moves inwards to the nearest point of the shared area.
            lost = float(half[axis] - (sign * local[:, axis]).min())
            left = obj.size[axis] - lost
            if left < _OPTIONS.min_kept * first[obj.id].size[axis]:
                continue
            cost = lost / obj.size[axis] * footprint(obj).area * _side_cost(obj, sign * axes[axis], path)
            if best is None or cost < best[0]:
                size = list(obj.size)
                size[axis] = round(left, 4)
                x, y = np.array(obj.center[:2]) - sign * axes[axis] * lost / 2
                center = (round(float(x), 4), round(float(y), 4), obj.center[2])
                best = cost, dataclasses.replace(obj, size=tuple(size), center=center), lost
    return None if best is None else best[1:]


def _side_cost(obj: GraphObject, normal: np.ndarray, path: np.ndarray) -> float:
    """Cost of cutting a side with an outward normal (2,), relative to the back."""
    if not len(path):
        return 1.0
    towards = path - obj.center[:2]
    towards = towards[(towards**2).sum(1).argmin()]
    cosine = float(normal @ towards) / max(float(np.linalg.norm(towards)), 1e-9)
    # More than 45° off the direction of the path, a side is beside or behind.
    if cosine > np.sqrt(0.5):
        return _OPTIONS.front_cost
    return _OPTIONS.side_cost if cosine > -np.sqrt(0.5) else 1.0


def _refuted(
    buildings: Mapping[str, GraphObject],
    stay: Mapping[str, GraphObject],
    others: Sequence[GraphObject],
    hangs: Callable[[str], bool],
    evidence: Mapping[str, float],
) -> str | None:
    """The building of which there is least evidence compared with all objects too far inside it, if it is less than
    theirs: a building that several views of different ones make up stands on the road, among what is there."""
    lost = [obj for obj in others if obj.id not in stay]
    excess = {
        name: sum(evidence[other] for other in _outside(lost, [building], hangs)[2]) / max(evidence[name], 1e-9)
        for name, building in buildings.items()
    }
    worst = max(excess, key=lambda name: (excess[name], name), default=None)
    return worst if worst is not None and excess[worst] > 1.0 else None


def _outside(
    objects: Sequence[GraphObject], buildings: Sequence[GraphObject], hangs: Callable[[str], bool]
) -> tuple[dict[str, GraphObject], dict[str, float], dict[str, str]]:
    """Moves objects whose middle is inside a building to just outside it.

    Returns:
      objects that stay; m of the movements; reasons of those that are removed, because they are too far inside.
    """
    outlines = [footprint(building) for building in buildings]
    tree = shapely.STRtree(outlines)
    solid = shapely.union_all(outlines)
    stay: dict[str, GraphObject] = {}
    moved: dict[str, float] = {}
    gone: dict[str, str] = {}
    for obj in objects:
        middle = shapely.Point(obj.center[:2])
        hits = [int(k) for k in tree.query(middle, predicate="within")]
        hits = [k for k in hits if _beside(obj, buildings[k])]
        if not hits or hangs(obj.label):
            stay[obj.id] = obj
            continue
        # The stem of a tree or post, not its crown or arm, has to be outside.
        inner = solid.buffer(min(0.5 * min(obj.size[:2]), 0.3), join_style="mitre")
        target = shapely.ops.nearest_points(inner.boundary, middle)[0]
        length = float(target.distance(middle))
        if length > _OPTIONS.max_move:
            gone[obj.id] = f"it stands {length:.1f} m inside {buildings[hits[0]].id!r} ({buildings[hits[0]].label})"
            continue
        stay[obj.id] = dataclasses.replace(obj, center=(round(target.x, 4), round(target.y, 4), obj.center[2]))
        moved[obj.id] = length
    return stay, moved, gone


def _beside(obj: GraphObject, building: GraphObject) -> bool:
    """Whether the lower end of an object is below a building's roof."""
    return obj.center[2] - obj.size[2] / 2 < building.center[2] + building.size[2] / 2
