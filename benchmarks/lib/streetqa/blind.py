"""Answers from the words of questions alone: what a model reaches without looking at the image."""

import collections
from collections.abc import Callable, Mapping, Sequence
from typing import Any

#: Strength of the prior in counted questions: rarely seen subjects have the answers of their template.
_PRIOR = 4.0


class Blind:
    """The most frequent answers of a train part.

    Args:
      docs: questions of the train part.
      by_subject: whether answers depend on what a question is about ("a bench"), or on its template alone.
    """

    def __init__(self, docs: Sequence[Mapping[str, Any]], by_subject: bool = True) -> None:
        self._by_subject = by_subject
        self._template: dict[str, collections.Counter[str]] = collections.defaultdict(collections.Counter)
        self._subject: dict[tuple[str, str], collections.Counter[str]] = collections.defaultdict(collections.Counter)
        for doc in docs:
            answer = self._answer(doc)
            self._template[doc["template"]][answer] += 1
            self._subject[doc["template"], doc["subject"]][answer] += 1

    @staticmethod
    def _answer(doc: Mapping[str, Any], option: str | None = None) -> str:
        """An answer in words that different questions share: for "a or b", whether the first or the second."""
        text = doc["answer"] if option is None else option
        if doc["template"] == "nearer":
            return "first" if doc["question"].find(text + " or ") >= 0 else "second"
        return text

    def weight(self, doc: Mapping[str, Any], option: str) -> float:
        """How much the words of a question speak for an option."""
        answer, template = self._answer(doc, option), self._template[doc["template"]]
        share = template[answer] / max(sum(template.values()), 1)
        if not self._by_subject:
            return share
        own = self._subject[doc["template"], doc["subject"]]
        return (own[answer] + _PRIOR * share) / (sum(own.values()) + _PRIOR)

    def choose(self, doc: Mapping[str, Any]) -> str:
        """Letter of the most likely option; of equal ones the first."""
        weights = [self.weight(doc, option) for option in doc["options"]]
        return "ABCD"[weights.index(max(weights))]

    def say(self, doc: Mapping[str, Any]) -> str:
        """The most likely answer in words; a distance is the middle of the most likely range."""
        known = list(self._template[doc["template"]]) or [""]
        if doc["template"] == "nearer":
            first, _, second = doc["question"].partition(", ")[2].rstrip("?").partition(" or ")
            return max((first, second), key=lambda text: self.weight(doc, text))
        best = max(known, key=lambda text: self.weight(doc, text))
        if doc["template"] == "distance" and " to " in best:
            low, high = (float(x) for x in best.removesuffix(" m").split(" to "))
            return f"{(low * high) ** 0.5:.1f} m"
        return best


def answers(docs: Sequence[Mapping[str, Any]], form: str, blind: Blind) -> dict[str, str]:
    """Question id -> answer."""
    answer: Callable[[Mapping[str, Any]], str] = blind.choose if form == "mc" else blind.say
    return {doc["question_id"]: answer(doc) for doc in docs}
