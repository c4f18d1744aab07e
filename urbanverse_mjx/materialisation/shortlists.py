"""Selects assets for an object by the paper's three steps (`assets.selection.matching`), then k different ones.

Semantics, box and appearance determine a ranking. Assets with the affordances of the best one are kept, and k are drawn
for k cousins, preferring different base shapes.
"""

import dataclasses
from collections.abc import Mapping, Sequence

import numpy as np

from ..assets.categories.ontology import UnknownLabelError, category_of
from ..assets.categories.priors import prior
from ..assets.categories.semantics import TextEmbedder, rank_leaves
from ..assets.selection.matching import Match, Matcher
from ..assets.selection.neural import ImageEmbedder
from ..assets.selection.search import ObjectLibrary
from ..datatypes import AssetRecord, GraphObject, ValidationError
from . import choice
from .choice import Vector

#: Difference to the least distortion (mean |log| of a side) up to which boxes fit equally well, because scaling removes
#: it.
DISTORTION_SLACK = 0.08
#: Least reduction of the distortion for a quarter turn of an asset; for a bench of 0.65 x 1.8 m it is 0.68.
TURN_GAIN = 0.2
#: Number of matches considered.
DEPTH = 40
#: Categories whose objects are chosen individually; objects of other categories form series (lamps, bollards, chairs of
#: one cafe) and share an asset if their boxes and descriptors are similar.
SINGLES = frozenset({"street user", "vehicle", "building"})
#: Largest ratio of sides and largest mean difference of descriptors within a series.
MAX_SIDE_RATIO, MAX_DESCRIPTOR_DIFFERENCE = 1.15, 12.0
#: Leaves of the ontology that are ground, which is represented by regions and not by assets.
GROUND_LEAVES = frozenset({"road", "sidewalk"})
#: Least score of a leaf (`semantics.rank_leaves`); labels below it only share some letters with the leaf.
MIN_SCORE = 0.35


@dataclasses.dataclass(frozen=True)
class Embeddings:
    """Neural embeddings for the first and the third step, where their weights are at hand.

    Attributes:
      text: of labels; None for letters and words.
      image: of crops and thumbnails; None for the built-in descriptor alone.
      crops: object id -> (H, W, 3) uint8, the object on a plain background; objects without one keep the order of
        their descriptors.
    """

    text: TextEmbedder | None = None
    image: ImageEmbedder | None = None
    crops: Mapping[str, np.ndarray] = dataclasses.field(default_factory=dict)


#: Letters, words and descriptors, without weights.
BUILT_IN = Embeddings()


@dataclasses.dataclass(frozen=True)
class Candidate:
    """An asset for an object: the match, its record, and the box (along the heading, across, up) in the asset's
    axes."""

    match: Match
    record: AssetRecord
    box: Vector


@dataclasses.dataclass(frozen=True)
class Series:
    """Objects that share their appearance.

    Attributes:
      objects: at least one; label, box and descriptor of the first are matched.
    """

    graph_objects: tuple[GraphObject, ...]

    @property
    def key(self) -> str:
        return self.graph_objects[0].id


@dataclasses.dataclass(frozen=True)
class LeftOut:
    """A node that is left out of a layout, and the reason, a clause that follows "left out because"."""

    id: str
    label: str
    reason: str


def in_series(graph_objects: Sequence[GraphObject], leaf_of: dict[str, str]) -> list[Series]:
    """Groups objects by label, box and appearance; objects of `SINGLES` form groups of one. Each object, by id, joins
    the first group that it fits.

    Args:
      leaf_of: label -> leaf, for every label.
    """
    groups: list[list[GraphObject]] = []
    by_label: dict[str, list[list[GraphObject]]] = {}
    for obj in sorted(graph_objects, key=lambda t: t.id):
        known = by_label.setdefault(obj.label, [])
        single = category_of(leaf_of[obj.label])[0] in SINGLES
        group = None if single else next((g for g in known if _alike(g[0], obj)), None)
        if group is None:
            group = []
            known.append(group)
            groups.append(group)
        group.append(obj)
    return [Series(tuple(group)) for group in groups]


def _alike(a: GraphObject, b: GraphObject) -> bool:
    if any(max(x / y, y / x) > MAX_SIDE_RATIO for x, y in zip(a.size, b.size, strict=True)):
        return False
    if a.descriptor is None or b.descriptor is None or len(a.descriptor) != len(b.descriptor):
        return a.descriptor is b.descriptor
    return (
        sum(abs(x - y) for x, y in zip(a.descriptor, b.descriptor, strict=True)) / len(a.descriptor)
        <= MAX_DESCRIPTOR_DIFFERENCE
    )


def leaf_for(label: str, matcher: Matcher, text: TextEmbedder | None = None) -> str:
    """The leaf from which the assets for a label are taken.

    Args:
      text: embedding of labels; None for letters and words.

    Raises:
      ValidationError: no leaf matches the label, or the label denotes ground; the message states which.
    """
    try:
        nearest, score = rank_leaves(label, 1, text)[0]
    except UnknownLabelError as error:
        raise ValidationError(f"no leaf of the ontology is called anything like {label!r}") from error
    if nearest in GROUND_LEAVES:
        raise ValidationError(f"{label!r} is ground, which regions hold")
    if score < MIN_SCORE:
        raise ValidationError(f"no leaf of the ontology is called anything like {label!r}, the nearest is {nearest!r}")
    return matcher.leaves(label, text)[0]


def shortlist(
    series: Series, matcher: Matcher, objects: ObjectLibrary, embeddings: Embeddings = BUILT_IN
) -> list[Candidate]:
    """Assets that fit the label and box of a series and have the same affordances, best first, at least one."""
    obj = series.graph_objects[0]
    matches = matcher.match(
        obj.label,
        obj.size,
        obj.descriptor,
        count=DEPTH,
        text=embeddings.text,
        slack=DISTORTION_SLACK,
        turn_gain=TURN_GAIN,
    )
    if embeddings.image is not None and obj.id in embeddings.crops:
        matches = matcher.rerank(matches, embeddings.crops[obj.id], embeddings.image)
    records = objects.records([m.uid for m in matches])
    wanted = affordances(records[0])
    along, across, up = obj.size
    return [
        Candidate(m, r, (across, along, up) if m.yaw else (along, across, up))
        for m, r in zip(matches, records, strict=True)
        if affordances(r) == wanted
    ]


def affordances(record: AssetRecord) -> tuple[object, ...]:
    """Affordances and traversability of an asset."""
    row = prior(record.leaf)
    return (
        record.movable,
        row.walkable,
        row.enterable,
        row.receptacle,
        row.support_surface,
        row.traversability,
        row.affordances,
    )


def one_each(candidates: Sequence[Candidate], count: int, seed: int, key: str) -> list[Candidate]:
    """Selects a candidate for each of `count` cousins, all different as long as there are enough.

    If the appearance is known, the first cousin gets the best candidate and the others are drawn among the next ones.
    Otherwise all candidates fit equally well and are drawn at random.
    """
    known = candidates[0].match.appearance_distance is not None
    pool = _other_shapes_first(candidates)
    return choice.one_each(pool, known, count, lambda c: choice.pick(2**62, "asset", seed, key, c.match.uid))


def _other_shapes_first(candidates: Sequence[Candidate]) -> list[Candidate]:
    """Reorders candidates: first the best of each base shape, then the second of each, and so on."""
    seen: dict[str, int] = {}
    rounds = []
    for place, candidate in enumerate(candidates):
        base = candidate.match.base
        rounds.append((seen.setdefault(base, 0), place, candidate))
        seen[base] += 1
    return [candidate for _, _, candidate in sorted(rounds, key=lambda r: r[:2])]
