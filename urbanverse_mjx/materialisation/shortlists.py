"""Which assets may stand for an object: three steps of the paper (`assets.selection.matching`), then k that differ.

Semantics, box and appearance give a ranking; of it the ones that could do what the best one can are kept, and k are
drawn for k cousins, other base shapes first.
"""

import dataclasses
from collections.abc import Sequence

from ..assets.categories.ontology import UnknownLabelError, category_of
from ..assets.categories.priors import prior
from ..assets.categories.semantics import rank_leaves
from ..assets.selection.matching import Match, Matcher
from ..assets.selection.search import ObjectLibrary
from ..datatypes import AssetRecord, GraphObject, ValidationError
from . import choice
from .choice import Vector

#: Distortion above the least one's (mean |log| of a side) up to which a box fits as well: scaling takes it away.
SLACK = 0.08
#: Distortion that turning an asset by a quarter must save; a bench of 0.65 x 1.8 m saves 0.68.
TURN_GAIN = 0.2
#: Number of matches considered.
DEPTH = 40
#: Categories whose objects are chosen one by one; all others come in series (lamps, bollards, chairs of one cafe) and
#: share an asset where boxes and descriptors are similar.
SINGLES = frozenset({"street user", "vehicle", "building"})
#: Sides (a factor) and descriptors (mean difference of a number) within which objects are of one series.
ALIKE_SIDE, ALIKE_DESCRIPTOR = 1.15, 12.0
#: Leaves of the ontology that are the ground itself: regions hold it, no asset stands for it.
GROUND_LEAVES = frozenset({"road", "sidewalk"})
#: Score of a leaf (`semantics.rank_leaves`) below which a label has no more than some letters in common with it.
LEAST_SCORE = 0.35


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
      objects: at least one, the first gives the label, the box and the descriptor that are matched.
    """

    graph_objects: tuple[GraphObject, ...]

    @property
    def key(self) -> str:
        return self.graph_objects[0].id


@dataclasses.dataclass(frozen=True)
class LeftOut:
    """A node that is not in a layout, and why, in words that follow "left out because"."""

    id: str
    label: str
    reason: str


def in_series(graph_objects: Sequence[GraphObject], leaf_of: dict[str, str]) -> list[Series]:
    """Objects grouped by label, box and appearance; singles alone. Each joins the first group that it fits, by id.

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
    if any(max(x / y, y / x) > ALIKE_SIDE for x, y in zip(a.size, b.size, strict=True)):
        return False
    if a.descriptor is None or b.descriptor is None or len(a.descriptor) != len(b.descriptor):
        return a.descriptor is b.descriptor
    return (
        sum(abs(x - y) for x, y in zip(a.descriptor, b.descriptor, strict=True)) / len(a.descriptor) <= ALIKE_DESCRIPTOR
    )


def leaf_for(label: str, matcher: Matcher) -> str:
    """The leaf that a label's assets come from.

    Raises:
      ValidationError: no leaf matches the label, or it means the ground itself; the message states which.
    """
    try:
        nearest, score = rank_leaves(label, 1)[0]
    except UnknownLabelError as error:
        raise ValidationError(f"no leaf of the ontology is called anything like {label!r}") from error
    if nearest in GROUND_LEAVES:
        raise ValidationError(f"{label!r} is ground, which regions hold")
    if score < LEAST_SCORE:
        raise ValidationError(f"no leaf of the ontology is called anything like {label!r}, the nearest is {nearest!r}")
    return matcher.leaves(label)[0]


def shortlist(series: Series, matcher: Matcher, objects: ObjectLibrary) -> list[Candidate]:
    """Assets for a series that fit its label and box and afford the same, best first, at least one."""
    obj = series.graph_objects[0]
    matches = matcher.match(
        obj.label, obj.size, obj.descriptor, count=DEPTH, slack=SLACK, turn_gain=TURN_GAIN
    )  # fmt: skip
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
    """`count` candidates for as many cousins, all different while there are enough.

    With appearances known the first is the best one (the nearest cousin) and the others are drawn among the next;
    without, all fit equally well and every one is drawn.
    """
    known = candidates[0].match.appearance_distance is not None
    pool = _other_shapes_first(candidates)
    return choice.one_each(pool, known, count, lambda c: choice.pick(2**62, "asset", seed, key, c.match.uid))


def _other_shapes_first(candidates: Sequence[Candidate]) -> list[Candidate]:
    """The candidates in their order, round by round: first the best of each base shape, then the second of each."""
    seen: dict[str, int] = {}
    rounds = []
    for place, candidate in enumerate(candidates):
        base = candidate.match.base
        rounds.append((seen.setdefault(base, 0), place, candidate))
        seen[base] += 1
    return [candidate for _, _, candidate in sorted(rounds, key=lambda r: r[:2])]
