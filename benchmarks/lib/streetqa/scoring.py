"""Accuracy of answers, by template, with intervals over scenes."""

import collections
from collections.abc import Mapping, Sequence
from typing import Any

from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.evaluation.metrics import drawn_counts, mean_interval, wilson_interval

from .lmms_eval_utils import right


def score(docs: Sequence[Mapping[str, Any]], answers: Mapping[str, str], form: str) -> dict[str, dict[str, Any]]:
    """Template, and "all" -> {"accuracy" %, "low", "high", "n", "unanswered"}.

    "all" is over questions; "mean" is the mean over templates. Questions without an answer count as wrong. Intervals
    (95 %) are a bootstrap that samples scenes first, at least as wide as Wilson's.

    Args:
      docs: questions. answers: by question id; form: "mc" or "free".

    Raises:
      ValidationError: no questions, or answers to others.
    """
    if not docs:
        raise v.fail("score", "no questions", "at least one", "name a split that the data set has")
    strange = sorted(set(answers) - {doc["question_id"] for doc in docs})
    if strange:
        raise v.fail("answers", f"one to {strange[0]!r}", "answers to questions of this data set and split")
    groups: dict[str, list[Mapping[str, Any]]] = collections.defaultdict(list)
    for doc in docs:
        groups[doc["template"]].append(doc)
    table = {name: _row(rows, answers, form) for name, rows in sorted(groups.items())}
    table["all"] = _row(docs, answers, form)
    mean = sum(table[name]["accuracy"] for name in groups) / len(groups)
    table["mean"] = {"accuracy": round(mean, 1), "n": len(docs), "unanswered": table["all"]["unanswered"]}
    return table


def _row(docs: Sequence[Mapping[str, Any]], answers: Mapping[str, str], form: str) -> dict[str, Any]:
    given = [answers.get(doc["question_id"]) for doc in docs]
    flags = [text is not None and right(doc, text, form) for doc, text in zip(docs, given, strict=True)]
    low, high = wilson_interval(sum(flags), len(flags))
    drawn = mean_interval([float(x) for x in flags], drawn_counts([doc["scene"] for doc in docs]))
    if drawn is not None:
        low, high = min(low, drawn[0]), max(high, drawn[1])
    return {
        "accuracy": round(100.0 * sum(flags) / len(flags), 1),
        "low": round(100.0 * low, 1),
        "high": round(100.0 * high, 1),
        "n": len(flags),
        "unanswered": sum(text is None for text in given),
    }


def chance(docs: Sequence[Mapping[str, Any]]) -> float:
    """Expected accuracy, %, of options drawn blindly."""
    return round(100.0 * sum(1.0 / len(doc["options"]) for doc in docs) / max(len(docs), 1), 1)
