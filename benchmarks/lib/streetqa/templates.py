"""Templates of questions: every question of a view whose answer is certain."""

import dataclasses
import itertools
import zlib
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from . import walkable
from .facts import NEARER, Facts, Seen
from .signs import Signs
from .words import article, words

YES_NO = ("yes", "no")
COUNTS = ("1", "2", "3", "4", "5", "6")
#: m, borders of the ranges that distances are asked by; and the share from a border within which none is asked.
RANGES, RANGE_MARGIN = (2.0, 3.2, 5.0, 8.0, 13.0, 21.0), 0.06
RANGE_NAMES = tuple(f"{a:g} to {b:g} m" for a, b in itertools.pairwise(RANGES))
GROUNDS = {"sidewalk": "the pavement", "road": "the road", "crosswalk": "a crosswalk"}
#: Pixels that must lie between two objects of which one is left of the other.
APART = 15
MOST_OPTIONS = 4


@dataclasses.dataclass(frozen=True)
class Candidate:
    """A question that could be asked.

    Attributes:
      view: name of its view; scene, split: of the view.
      template: name; subject: what it is about, by which answers are balanced as well.
      question: without options; answer: one of the options.
      pool: answers from which options are drawn; all of them if there are at most four.
      number: of a measured answer, m; else None.
      facts: what the answer follows from, for checks: "slots" and ids of "objects", and the like.
    """

    view: str
    scene: str
    split: str
    template: str
    subject: str
    question: str
    answer: str
    pool: tuple[str, ...]
    number: float | None = None
    facts: dict[str, Any] = dataclasses.field(default_factory=dict)


type Found = Iterator[tuple[str, str, str, Sequence[str], float | None, dict[str, Any]]]


def _exists(facts: Facts, signs: Signs) -> Found:
    for word in words().values():
        clear, _ = facts.of_word(word)
        absent = not any(s.leaf in word.leaves | word.doubtful for s in facts.seen)
        if clear or absent:
            question = f"Is there {article(word.name)} in this image?"
            yield word.name, question, "yes" if clear else "no", YES_NO, None, {"leaves": sorted(word.leaves)}


def _count(facts: Facts, signs: Signs) -> Found:
    for word in words().values():
        clear, certain = facts.of_word(word)
        if certain and 1 <= len(clear) <= len(COUNTS):
            question = f"How many {word.plural} can be seen in this image?"
            slots = [s.slot for s in clear]
            yield word.name, question, str(len(clear)), COUNTS, None, {"leaves": sorted(word.leaves), "slots": slots}


def _colour(facts: Facts, signs: Signs) -> Found:
    coloured = {
        f"{the} {word.name}": word for word in words().values() if word.coloured for the in ("the", "the nearest")
    }
    for phrase, seen in facts.named.items():
        word = coloured.get(phrase)
        name = facts.colour(seen) if word is not None and seen.pixels >= 300 else None
        if word is not None and name is not None:
            question = f"What is the main colour of {phrase}?"
            yield word.name, question, name, ("any colour",), None, {"slots": [seen.slot]}


def _pairs(facts: Facts) -> Iterator[tuple[str, Seen, str, Seen]]:
    names = sorted(facts.named)
    for k, a in enumerate(names):
        for b in names[k + 1 :]:
            yield a, facts.named[a], b, facts.named[b]


def _side(facts: Facts, signs: Signs) -> Found:
    for a, first, b, second in _pairs(facts):
        left, right = first.box[3] + APART < second.box[1], second.box[3] + APART < first.box[1]
        if left or right:
            # The order of both is drawn, so that the first one is as often left as right.
            if _coin(facts, a, b):
                a, b, first, second, left = b, a, second, first, right
            question = f"Is {a} to the left or to the right of {b} in this image?"
            answer, slots = "left" if left else "right", [first.slot, second.slot]
            yield f"{a}/{b}", question, answer, ("left", "right"), None, {"slots": slots}


def _nearer(facts: Facts, signs: Signs) -> Found:
    for a, first, b, second in _pairs(facts):
        if max(first.distance, second.distance) >= NEARER * min(first.distance, second.distance):
            if _coin(facts, b, a):
                a, b, first, second = b, a, second, first
            question = f"Which is nearer to the camera, {a} or {b}?"
            answer, slots = a if first.distance < second.distance else b, [first.slot, second.slot]
            yield "/".join(sorted((a, b))), question, answer, (a, b), None, {"slots": slots}


def _coin(facts: Facts, *text: str) -> bool:
    return bool(zlib.crc32("/".join((facts.view.name, *text)).encode()) >> 7 & 1)


def _distance(facts: Facts, signs: Signs) -> Found:
    for phrase, seen in facts.named.items():
        k = int(np.searchsorted(RANGES, seen.distance)) - 1
        if not 0 <= k < len(RANGE_NAMES):
            continue
        low, high = RANGES[k] * (1 + RANGE_MARGIN), RANGES[k + 1] * (1 - RANGE_MARGIN)
        if low <= seen.distance <= high:
            question = f"How far is the nearest visible point of {phrase} from the camera, in metres?"
            slots = {"slots": [seen.slot]}
            yield phrase, question, RANGE_NAMES[k], RANGE_NAMES, round(seen.distance, 2), slots


def _stands_on(facts: Facts, signs: Signs) -> Found:
    for phrase, seen in facts.named.items():
        kind = facts.ground_under(seen)
        if kind in GROUNDS:
            question = f"What does {phrase} stand on?"
            slots = {"slots": [seen.slot]}
            yield (
                phrase.removeprefix("the nearest ").removeprefix("the "),
                question,
                GROUNDS[kind],
                tuple(GROUNDS.values()),
                None,
                slots,
            )


def _reach(facts: Facts, signs: Signs) -> Found:
    for phrase, seen in facts.named.items():
        answer = walkable.reachable(facts, seen)
        if answer is not None and 2.5 < seen.distance < 30.0:
            question = (
                "A delivery robot 0.8 m wide starts at the camera. It may use pavements, crosswalks and paths, and "
                f"mount their kerbs, but never the road. Can it drive up to {phrase}?"
            )
            subject = phrase.removeprefix("the nearest ").removeprefix("the ")
            yield subject, question, "yes" if answer else "no", YES_NO, None, {"slots": [seen.slot]}


def _priority(facts: Facts, signs: Signs) -> Found:
    for words_, degrees in walkable.STRETCHES.items():
        answer = walkable.yields_to_vehicles(facts, degrees)
        if answer is None:
            continue
        question = (
            f"A person walks {walkable.AHEAD:g} m from the camera, {words_}. On pavements, paths and marked crosswalks "
            "people on foot have right of way; on the road elsewhere they must give way to vehicles. Must this person "
            "give way to vehicles?"
        )
        yield words_, question, "yes" if answer else "no", YES_NO, None, {"degrees": degrees}


def _free(facts: Facts, signs: Signs) -> Found:
    for degrees in walkable.TURNS:
        for length in walkable.LENGTHS:
            answer = walkable.free_direction(facts, degrees, length)
            if answer is not None:
                question = (
                    "A robot 0.8 m wide starts at the camera and must stay on pavements, crosswalks and paths without "
                    f"touching anything. Which way is free for the next {length} m: {degrees} degrees to the left, "
                    f"straight ahead, or {degrees} degrees to the right?"
                )
                numbers = {"degrees": degrees, "length": length}
                yield f"{degrees}/{length}", question, answer, ("left", "straight ahead", "right"), None, numbers


def _text(facts: Facts, signs: Signs) -> Found:
    texts = signs.in_view(facts)
    third = facts.view.slots.shape[1] / 3
    for k, name in enumerate(("left", "middle", "right")):
        here = [t for t in texts if k * third <= t.column < (k + 1) * third]
        if len(here) == 1 and here[0].legible:
            question = f"Which words can be read in the {name} third of this image?"
            yield "text", question, here[0].words, ("any text",), None, {"slots": [here[0].slot]}


TEMPLATES: dict[str, Callable[[Facts, Signs], Found]] = {
    "exists": _exists,
    "count": _count,
    "colour": _colour,
    "side": _side,
    "nearer": _nearer,
    "distance": _distance,
    "stands_on": _stands_on,
    "reach": _reach,
    "right_of_way": _priority,
    "free_direction": _free,
    "text": _text,
}


def candidates(facts: Facts, signs: Signs) -> Iterator[Candidate]:
    """Every question of a view whose answer is certain, in a fixed order."""
    view, ids = facts.view, facts.bank.meta["object_ids"][facts.scene]
    for template, ask in TEMPLATES.items():
        for subject, question, answer, pool, number, evidence in ask(facts, signs):
            if "slots" in evidence:
                evidence = {**evidence, "objects": [ids[slot] for slot in evidence["slots"]]}
            yield Candidate(
                view.name, view.scene, view.split, template, subject, question, answer, tuple(pool), number, evidence
            )
