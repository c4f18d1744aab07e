"""`materialise_cousins`: makes k layouts from a scene graph with the catalogue of 102,444 assets.

All cousins keep the graph's positions, boxes, headings and affordances. They differ in assets (and thereby in masses
and friction), ground materials and skies. Steps that do not depend on the cousin are done once.
"""

import dataclasses
import functools
import math
import re
from collections.abc import Callable, Mapping, Sequence

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from .. import versions
from ..assets import AssetIndex, hull_loader, nearest_leaves
from ..assets.categories.ontology import category_of
from ..assets.categories.priors import prior
from ..assets.categories.semantics import TextEmbedder
from ..assets.collision import lying
from ..assets.records import regional as regional_records
from ..assets.records.store import catalogue_hash, recorded_content
from ..assets.selection.matching import Matcher
from ..assets.selection.search import ObjectLibrary, library
from ..datatypes import (
    AssetRecord,
    GraphObject,
    HullSet,
    PlacedObject,
    SceneGraph,
    SceneLayout,
    ValidationError,
)
from ..datatypes import validation as v
from . import choice, clearance, clearing, ground_inpainting, kerbs, overlap, shortlists, standing, surroundings
from .shortlists import BUILT_IN, Candidate, Embeddings, LeftOut
from .steady import Steady

#: Part of the hashes of layouts.
VERSION = f"cousins {versions.CODE['cousins'].version}"
#: Largest number of cousins of a graph, that of the authors' release for one video.
MAX_COUSINS = 64
#: Pattern of `Source.video` in composed graphs, whose trajectory is a plan and was not filmed. Captures of generated
#: blocks have "synthetic tour of ...".
COMPOSED = re.compile(r"hand$|synthetic$|procedural\b")


@dataclasses.dataclass(frozen=True)
class Cousin:
    """A layout and the decisions that led to it.

    Attributes:
      layout: the placed objects.
      left_out: omitted nodes with the reason.
      moved: (object id, m) of objects moved to resolve a penetration.
      unresolved: pairs of ids of fixed objects that still penetrate.
      chosen: object id -> the asset and the quality of its fit.
      raised: ids of ground regions that got a kerb.
      materials: the pieces of ground with the materials of all cousins.
      sky: sky of this cousin.
    """

    layout: SceneLayout
    left_out: tuple[LeftOut, ...]
    moved: tuple[tuple[str, float], ...]
    unresolved: tuple[tuple[str, str], ...]
    chosen: dict[str, Candidate]
    raised: tuple[str, ...]
    materials: tuple[surroundings.Ground, ...]
    sky: surroundings.RankedAppearance


def materialise_cousins(
    graph: SceneGraph,
    count: int = 5,
    seed: int = 0,
    kerb: float = kerbs.KERB,
    objects: ObjectLibrary | None = None,
    hulls_of: Callable[[AssetRecord], HullSet] | None = None,
    embeddings: Embeddings = BUILT_IN,
    hulls: str = "",
    standing: bool = False,
) -> list[Cousin]:
    """Makes the first `count` cousins of a graph. The result is deterministic, and a larger count only appends layouts.

    Args:
      graph: graph of the scene; its descriptors, if any, select the appearance (see `describe`).
      count: number of cousins, 1 to `MAX_COUSINS`.
      seed: seed of the choice among equal fits.
      kerb: m, height of sidewalks whose step to the road the graph does not show; 0 leaves them level.
      objects: the catalogue; default: the packaged one.
      hulls_of: function that returns the collision hulls of a record; default: those that `hulls` names.
      embeddings: neural embeddings of labels and crops; by default assets are chosen by letters, words and
        descriptors.
      hulls: "close" or "close-2" for closer collision hulls, see `SceneLayout.hulls`.
      standing: whether loose objects have assets that stand on their hulls, or lie (see `steady`).

    Raises:
      ValidationError: seed, count or kerb is out of range.
    """
    v.integer(count, "cousins", 1, MAX_COUSINS)
    return _materialise(graph, range(count), seed, kerb, objects, hulls_of, embeddings, hulls, standing)


def materialise_cousin(
    graph: SceneGraph,
    cousin: int = 0,
    seed: int = 0,
    kerb: float = kerbs.KERB,
    objects: ObjectLibrary | None = None,
    hulls_of: Callable[[AssetRecord], HullSet] | None = None,
    hulls: str = "",
    standing: bool = False,
) -> Cousin:
    """Makes one cousin of a graph, identical to that of `materialise_cousins`.

    Args:
      cousin: number of the cousin, from 0. For the other arguments see `materialise_cousins`.

    Raises:
      ValidationError: cousin, seed or kerb is out of range.
    """
    v.integer(cousin, "cousin", 0, MAX_COUSINS - 1)
    made = _materialise(graph, (cousin,), seed, kerb, objects, hulls_of, hulls=hulls, standing=standing)
    return made[0]


def check_labels(graph: SceneGraph, objects: ObjectLibrary | None = None) -> None:
    """Checks that there is an asset for every object of a graph; `materialise_cousins` leaves out objects without one.

    Raises:
      ValidationError: an object has no asset; the message names the first one, the reason, and the three nearest
        leaves.
    """
    _, unknown = _leaves(graph.objects, _matcher(objects or library()))
    if unknown:
        first = unknown[0]
        nearest = ", ".join(repr(leaf) for leaf in nearest_leaves(first.label))
        raise v.fail(
            f"object {first.id!r}.label",
            f"{v.show(first.label)} ({first.reason})",
            f"a label that an asset is known for, such as the nearest {nearest}",
            "correct the label, or leave such objects out with --skip-unknown",
        )


def _materialise(
    graph: SceneGraph,
    numbers: Sequence[int],
    seed: int,
    kerb: float,
    objects: ObjectLibrary | None,
    hulls_of: Callable[[AssetRecord], HullSet] | None,
    embeddings: Embeddings = BUILT_IN,
    hulls: str = "",
    standing: bool = False,
) -> list[Cousin]:
    """Makes cousins by number; steps that do not depend on the cousin are done once."""
    count = numbers[-1] + 1
    v.integer(seed, "seed", 0)
    v.number(kerb, "kerb", 0.0, 1.0)
    objects = objects or library()
    hulls_of = hulls_of or hull_loader(hulls)
    raised: tuple[str, ...] = ()
    flat = graph
    if kerb:
        flat, raised = kerbs.raise_sidewalks(graph, kerb)
    leaves, nowhere = _leaves(flat.objects, _matcher(objects), embeddings.text)
    nowhere += clearing.found_twice([obj for obj in flat.objects if obj.label in leaves])
    gone = {entry.id for entry in nowhere}
    if not COMPOSED.match(graph.source.video):
        flat = ground_inpainting.fill(flat, leaves)
    strip = _trajectory_strip(flat)
    known = [_cut_back(obj, leaves, strip) for obj in flat.objects if obj.id not in gone]
    support = overlap.Support.of(flat.ground)
    steady = Steady(hulls_of, support) if standing else None
    drawn: dict[str, list[Candidate]] = {}
    others: dict[str, list[Candidate]] = {}
    for series in shortlists.in_series(known, leaves):
        found = shortlists.shortlist(series, _matcher(objects), objects, embeddings)
        draw = functools.partial(shortlists.one_each, count=count, seed=seed, key=f"{graph.id}/{series.key}")
        one_each = draw(found)
        for obj in series.graph_objects:
            drawn[obj.id] = steady.choose(obj, one_each, found, draw) if steady else one_each
            others[obj.id] = found
    pieces = tuple(surroundings.grounds(flat, count, seed))
    skies = surroundings.skies(flat, count, seed)
    hashes = {"assets": _catalogue_hash(objects), "materialiser": VERSION}
    graph_objects = {obj.id: obj for obj in known}
    floors = [_floor_of(obj, support) for obj in known]
    cousins = []
    for k in numbers:
        chosen = {obj.id: drawn[obj.id][k] for obj in known}
        bodies, away = _without_obstructing(_stand(known, chosen, support, flat, hulls_of), strip, floors)
        cleared = clearing.clear(bodies, support, graph_objects)
        if cleared.crowded:
            chosen |= _slimmer(cleared.crowded, bodies, others, graph_objects, flat, hulls_of, steady)
            bodies, away = _without_obstructing(_stand(known, chosen, support, flat, hulls_of), strip, floors)
            cleared = clearing.clear(bodies, support, graph_objects)
        layout = SceneLayout(
            **surroundings.identity(graph, k, seed),
            objects=cleared.placed,
            ground=surroundings.placed_ground(flat, pieces, k),
            sky=skies[k].uid,
            hashes=hashes,
            hulls=hulls,
        )
        left_out = (*nowhere, *away, *cleared.left_out)
        used = {p.id: chosen[p.id] for p in cleared.placed}
        cousins.append(Cousin(layout, left_out, cleared.moved, cleared.unresolved, used, raised, pieces, skies[k]))
    return cousins


def index_of(layout: SceneLayout, objects: ObjectLibrary | None = None) -> AssetIndex:
    """Index of the catalogue's records that a layout uses, for its compilation.

    Raises:
      ValidationError: the layout uses an asset that the catalogue does not contain.
    """
    uids = sorted({placed.asset_uid for placed in layout.objects})
    regional = [uid for uid in uids if regional_records.MARK in uid]
    laid = [uid for uid in uids if lying.is_lying(uid)]
    upright = sorted({lying.upright_uid(uid) for uid in uids} - set(regional))
    own = {record.uid: record for record in (objects or library()).records(upright)}
    found = [own[uid] for uid in uids if uid in own]
    return AssetIndex(
        (*found, *lying.records_of(laid, own), *(regional_records.records_of(regional) if regional else ()))
    )


@functools.cache
def trees_of() -> tuple[AssetRecord, ...]:
    """The catalogue's records of trees."""
    objects = library()
    return tuple(objects.records([uid for uid in objects.get_uids_all() if uid.startswith("tree/")]))


@functools.lru_cache(maxsize=1)
def _matcher(objects: ObjectLibrary) -> Matcher:
    return Matcher(objects)


@functools.lru_cache(maxsize=1)
def _catalogue_hash(objects: ObjectLibrary) -> str:
    return recorded_content(objects.table) or catalogue_hash(objects.table)


def _leaves(
    graph_objects: Sequence[GraphObject], matcher: Matcher, text: TextEmbedder | None = None
) -> tuple[dict[str, str], list[LeftOut]]:
    """Maps labels to leaves; also returns the objects whose label has none."""
    leaves: dict[str, str] = {}
    reasons: dict[str, str] = {}
    for label in dict.fromkeys(obj.label for obj in graph_objects):
        try:
            leaves[label] = shortlists.leaf_for(label, matcher, text)
        except ValidationError as error:
            reasons[label] = str(error)
    return leaves, [LeftOut(t.id, t.label, reasons[t.label]) for t in graph_objects if t.label in reasons]


def _stand(
    graph_objects: Sequence[GraphObject],
    chosen: dict[str, Candidate],
    support: overlap.Support,
    graph: SceneGraph,
    hulls_of: Callable[[AssetRecord], HullSet],
) -> list[overlap.Body]:
    """Places the asset of every object: objects on the ground first, then those on top of them."""
    path = _trajectory(graph)
    bodies: dict[str, overlap.Body] = {}
    tops: list[standing.Top] = []
    for obj in sorted(graph_objects, key=lambda t: (t.center[2] - t.size[2] / 2, t.id)):
        candidate = chosen[obj.id]
        place = standing.place_on_support(obj, candidate.match.leaf, support, tops)
        placed = _placed(obj, candidate, place, path)
        bodies[obj.id] = overlap.Body(placed, candidate.record, overlap.prisms_of(placed, hulls_of(candidate.record)))
        if prior(candidate.match.leaf).support_surface:
            tops.append(_top(bodies[obj.id]))
    return [bodies[obj.id] for obj in graph_objects]


def _trajectory_strip(graph: SceneGraph) -> BaseGeometry:
    """The strip of the camera's path; empty for composed graphs, whose trajectory no camera followed."""
    filmed = () if COMPOSED.match(graph.source.video) else graph.camera_path
    return clearance.walked(np.array(filmed).reshape(-1, 4))


def _cut_back(obj: GraphObject, leaves: Mapping[str, str], strip: BaseGeometry) -> GraphObject:
    return clearance.cut_back(obj, strip) if category_of(leaves[obj.label])[0] == "building" else obj


def _floor_of(obj: GraphObject, support: overlap.Support) -> float:
    """m, height of the ground that an object stands on or hangs above."""
    bottom = obj.center[2] - obj.size[2] / 2
    return max(support.under(obj) or support.near(obj, standing.GROUND_DISTANCE), default=bottom)


def _without_obstructing(
    bodies: Sequence[overlap.Body], strip: BaseGeometry, floors: Sequence[float]
) -> tuple[list[overlap.Body], list[LeftOut]]:
    """Splits objects into those off and those on the camera's path."""
    gone = set(clearance.obstructing(bodies, strip, floors))
    reason = "the camera went through where it would stand"
    left_out = [LeftOut(bodies[k].placed.id, bodies[k].placed.label, reason) for k in sorted(gone)]
    return [body for k, body in enumerate(bodies) if k not in gone], left_out


def _slimmer(
    crowded: Sequence[str],
    bodies: Sequence[overlap.Body],
    others: Mapping[str, Sequence[Candidate]],
    graph_objects: Mapping[str, GraphObject],
    graph: SceneGraph,
    hulls_of: Callable[[AssetRecord], HullSet],
    steady: Steady | None,
) -> dict[str, Candidate]:
    """Finds other assets of the shortlist for objects without a free position, or that block another, so that there is
    no contact: a tree with a higher crown, a shorter car."""
    now = {body.placed.id: body for body in bodies}
    found: dict[str, Candidate] = {}
    for name in crowded:
        standing_now = now[name]
        for candidate in others[name]:
            if steady and not steady.serves(graph_objects[name], candidate):
                continue
            place = standing.Placement(standing_now.placed.position[2], graph_objects[name].size[2])
            placed = _placed(graph_objects[name], candidate, place, _trajectory(graph))
            body = overlap.Body(placed, candidate.record, overlap.prisms_of(placed, hulls_of(candidate.record)))
            if all(overlap.penetration(body, other) == 0.0 for other in now.values() if other is not standing_now):
                found[name], now[name] = candidate, body
                break
    return found


def _trajectory(graph: SceneGraph) -> np.ndarray:
    """(n, 2) m, the trajectory in the ground plane."""
    return np.array([p[:2] for p in graph.camera_path]).reshape(-1, 2)


def _top(body: overlap.Body) -> standing.Top:
    outline = shapely.MultiPoint(np.concatenate([p.corners for p in body.prisms])).convex_hull
    return standing.Top(body.placed.id, outline, max(p.high for p in body.prisms))


def _placed(obj: GraphObject, candidate: Candidate, place: standing.Placement, path: np.ndarray) -> PlacedObject:
    record = candidate.record
    # The box of a lying asset is its own; that of the graph's object is upright.
    height = record.height if lying.is_lying(record.uid) else place.height
    scale = choice.scale_to((*candidate.box[:2], height), record)
    yaw = obj.yaw
    if candidate.match.yaw:
        # The box does not determine which of the two quarter turns shows the front. The front is assumed to face the
        # trajectory, because captures show more fronts than backs.
        yaw += _turn_to(path, obj)
    return PlacedObject(
        id=obj.id,
        label=obj.label,
        category=record.leaf,
        asset_uid=record.uid,
        position=(obj.center[0], obj.center[1], round(place.z, 4)),
        yaw=round(math.remainder(yaw, math.tau), 4),
        scale=scale,
        mass=round(max(record.mass * math.prod(scale), 1e-3), 3),
        friction=record.friction_coefficient,
        movable=record.movable,
    )


def _turn_to(path: np.ndarray, obj: GraphObject) -> float:
    """pi / 2 or -pi / 2, whichever turns the front towards the nearest point of the trajectory (n, 2)."""
    if not len(path):
        return math.pi / 2
    away = path - obj.center[:2]
    x, y = away[(away**2).sum(1).argmin()]
    left = -math.sin(obj.yaw) * x + math.cos(obj.yaw) * y
    return math.copysign(math.pi / 2, left)
