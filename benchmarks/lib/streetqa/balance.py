"""Chooses questions so that their words alone tell as little as possible about their answers, and draws options."""

import collections
import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np

from .templates import MOST_OPTIONS, Candidate

LETTERS = "ABCD"
#: Answers of which fewer questions are left, per split, are not asked for.
LEAST_PER_ANSWER = 6
#: Largest share that one text has among those asked for, and most questions of a template and view with one answer.
_TEXT_SHARE = 0.06
_MOST_PER_VIEW = 3


@dataclasses.dataclass(frozen=True)
class Question:
    """A question of a data set.

    Attributes:
      id: unique; view, scene, split, template, subject, text, number, facts: see `Candidate`.
      answer: in words, one of `options`; letter: of that option.
    """

    id: str
    view: str
    scene: str
    split: str
    template: str
    subject: str
    text: str
    options: tuple[str, ...]
    answer: str
    number: float | None
    facts: dict[str, Any]

    @property
    def letter(self) -> str:
        return LETTERS[self.options.index(self.answer)]


def choose(found: Sequence[Candidate], wanted: int, seed: int) -> list[Question]:
    """At most `wanted` questions of one split, with templates and, within each, answers as equal as there are.

    For each subject of a template, no answer is more frequent than the next one; what is only ever answered in one way
    is not asked. Within a template, answers are then taken in turn. Options other than the answer are drawn from the
    template's answers by their frequency, so that a rare one is not rarely right where it is offered.

    Args:
      found: of one split.
      wanted: number of questions.
      seed: of all draws.
    """
    rng = np.random.default_rng([seed, 77])
    found = [found[k] for k in rng.permutation(len(found))]
    by_template: dict[str, list[Candidate]] = collections.defaultdict(list)
    for candidate in found:
        by_template[candidate.template].append(candidate)
    pools = {name: _in_turn(_even(rows)) for name, rows in sorted(by_template.items())}
    quota = _quotas({name: len(rows) for name, rows in pools.items()}, wanted)
    chosen = [(name, rows[: quota[name]]) for name, rows in pools.items()]
    questions = []
    for name, rows in chosen:
        frequency = collections.Counter(row.answer for row in rows)
        for row in rows:
            pool = row.pool if name == "nearer" else sorted(frequency)
            options = _options(row.answer, pool, frequency, rng)
            number = f"{row.split}-{name}-{len(questions):05d}"
            questions.append(
                Question(
                    number,
                    row.view,
                    row.scene,
                    row.split,
                    name,
                    row.subject,
                    row.question,
                    options,
                    row.answer,
                    row.number,
                    row.facts,
                )
            )
    return questions


def _even(rows: Sequence[Candidate]) -> list[Candidate]:
    """Rows of which, for each subject, no answer is more frequent than the second most frequent one; of each view, at
    most `_MOST_PER_VIEW` with the same answer."""
    per_view: collections.Counter[tuple[str, str]] = collections.Counter()
    kept = []
    for row in rows:
        per_view[row.view, _answer_class(row)] += 1
        if per_view[row.view, _answer_class(row)] <= _MOST_PER_VIEW:
            kept.append(row)
    counts: dict[str, collections.Counter[str]] = collections.defaultdict(collections.Counter)
    for row in kept:
        counts[_subject(row)][_answer_class(row)] += 1
    caps = {s: sorted(count.values())[-2] if len(count) > 1 else 0 for s, count in counts.items()}
    used: collections.Counter[tuple[str, str]] = collections.Counter()
    even = []
    for row in kept:
        key = _subject(row), _answer_class(row)
        used[key] += 1
        if used[key] <= caps[key[0]]:
            even.append(row)
    return even


def _subject(row: Candidate) -> str:
    """By what answers are balanced: pairs of objects are too many, and their order is drawn."""
    return row.template if row.template in ("side", "nearer") else row.subject


def _in_turn(rows: Sequence[Candidate]) -> list[Candidate]:
    """Rows reordered so that answers take turns; an answer ends when the rarest of the common ones does."""
    by_answer: dict[str, list[Candidate]] = collections.defaultdict(list)
    for row in rows:
        by_answer[_answer_class(row)].append(row)
    if rows and rows[0].template == "text":
        most = max(LEAST_PER_ANSWER, int(_TEXT_SHARE * len(rows)))
        by_answer = collections.defaultdict(list, {a: r[:most] for a, r in by_answer.items()})
    else:
        by_answer = collections.defaultdict(list, {a: r for a, r in by_answer.items() if len(r) >= LEAST_PER_ANSWER})
        sizes = sorted((len(r) for r in by_answer.values()), reverse=True)
        # Where all answers are options, they must be equally frequent; else at most as many as of the median one.
        most = 0 if not sizes else sizes[-1] if len(sizes) <= MOST_OPTIONS else sizes[len(sizes) // 2]
        by_answer = collections.defaultdict(list, {a: r[:most] for a, r in by_answer.items()})
    return [r[k] for k in range(len(rows)) for _, r in sorted(by_answer.items()) if k < len(r)]


def _answer_class(row: Candidate) -> str:
    """The answer, or for "a or b" which of both is right."""
    return str(row.pool.index(row.answer)) if row.template == "nearer" else row.answer


def _quotas(sizes: dict[str, int], wanted: int) -> dict[str, int]:
    """How many of each template: equal numbers, and what small ones lack goes to the others."""
    quota, left = dict.fromkeys(sizes, 0), wanted
    while left and any(quota[name] < size for name, size in sizes.items()):
        open_ = [name for name, size in sizes.items() if quota[name] < size]
        each = max(left // len(open_), 1)
        for name in open_:
            more = min(each, sizes[name] - quota[name], left)
            quota[name], left = quota[name] + more, left - more
    return quota


def _options(
    answer: str, pool: Sequence[str], frequency: collections.Counter[str], rng: np.random.Generator
) -> tuple[str, ...]:
    others = [other for other in pool if other != answer]
    weight = np.array([max(frequency[other], 1) for other in others], float)
    number = min(len(others), MOST_OPTIONS - 1)
    drawn = rng.choice(len(others), number, replace=False, p=weight / weight.sum())
    options = [answer, *(others[k] for k in drawn)]
    return tuple(options[k] for k in rng.permutation(len(options)))
